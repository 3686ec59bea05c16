"""Launch files in XML and YAML: tags and their attributes become actions."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from launch.frontend.entity import Entity as Entity
    from launch.frontend.expose import expose_action as expose_action
    from launch.frontend.expose import expose_substitution as expose_substitution
    from launch.frontend.parser import InvalidFrontendLaunchFileError as InvalidFrontendLaunchFileError
    from launch.frontend.parser import Parser as Parser

_DEFINED_IN = {
    "Entity": "entity",
    "InvalidFrontendLaunchFileError": "parser",
    "Parser": "parser",
    "expose_action": "expose",
    "expose_substitution": "expose",
}
_MODULES = {"parse_substitution", "type_utils"}


def __getattr__(name: str) -> Any:
    """Import what is asked for: a file in Python that exposes an action needs no parser."""
    if name in _MODULES:
        return importlib.import_module(f"launch.frontend.{name}")
    if name in _DEFINED_IN:
        return getattr(importlib.import_module(f"launch.frontend.{_DEFINED_IN[name]}"), name)
    raise AttributeError(f"module 'launch.frontend' has no attribute '{name}'")


__all__ = [*_DEFINED_IN, "type_utils"]  # noqa: PLE0604 -- names that are imported when they are asked for
