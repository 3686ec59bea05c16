"""Launch files in XML and YAML: tags and their attributes become actions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.lookup import lookup

if TYPE_CHECKING:
    from launch.frontend.entity import Entity as Entity
    from launch.frontend.expose import expose_action as expose_action
    from launch.frontend.expose import expose_substitution as expose_substitution
    from launch.frontend.parser import Parser as Parser
    from launch.invalid_launch_file_error import (
        InvalidFrontendLaunchFileError as InvalidFrontendLaunchFileError,
    )

_DEFINED_IN = {
    "Entity": "entity",
    "InvalidFrontendLaunchFileError": "parser",
    "Parser": "parser",
    "expose_action": "expose",
    "expose_substitution": "expose",
}
# A file in Python that exposes an action needs no parser.
__getattr__ = lookup(__name__, defined_in=_DEFINED_IN)

__all__ = [*_DEFINED_IN, "type_utils"]  # noqa: PLE0604 -- names that are imported when they are asked for
