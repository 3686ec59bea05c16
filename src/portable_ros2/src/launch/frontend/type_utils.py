"""The types that an attribute can be read as."""

from __future__ import annotations

from typing import Any

from launch.frontend.entity import Entity
from launch.utilities.type_utils import is_typing_list

_TYPES = {
    "str": str,
    "bool": bool,
    "float": float,
    "int": int,
    "list_of_str": list[str],
    "list_of_bool": list[bool],
    "list_of_float": list[float],
    "list_of_int": list[int],
    "yaml": None,
}


def check_is_list_entity(data_type: Any) -> bool:
    """Return whether `list[Entity]` is meant."""
    return is_typing_list(data_type) and issubclass(data_type.__args__[0], Entity)


def get_data_type_from_identifier(type_identifier: str) -> Any:
    """Return the type that a launch file calls by this name; None for what YAML makes of a text.

    Raises:
        ValueError: if there is none of this name.
    """
    if type_identifier not in _TYPES:
        raise ValueError(f"Got invalid type identifier '{type_identifier}'")
    return _TYPES[type_identifier]
