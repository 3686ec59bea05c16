"""Values that may be substitutions, and the types that their texts become."""

from __future__ import annotations

import collections.abc
import typing
from typing import TYPE_CHECKING, Any

from launch.substitution import Substitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

SCALARS = (bool, int, float, str)


def is_substitution(value: object) -> bool:
    """Return whether a value is a substitution, or several with texts between them."""
    if isinstance(value, Substitution):
        return True
    if isinstance(value, (str, collections.abc.Mapping)) or not isinstance(value, collections.abc.Iterable):
        return False
    items = list(value)
    return all(isinstance(item, (Substitution, str)) for item in items) and any(
        isinstance(item, Substitution) for item in items
    )


def normalize_typed_substitution(value: Any, data_type: Any) -> Any:
    """Return a value in the form that `perform_typed_substitution` takes.

    Args:
        value: a scalar, a substitution, or a list of these.
        data_type: bool, int, float, str, a list such as `list[int]`, or None for any of these.

    Raises:
        TypeError: if the value can never be of the type.
    """
    if isinstance(value, SCALARS):
        if not is_instance_of(value, data_type):
            raise TypeError(f"value='{value}' is not an instance of {data_type}")
        return value
    if is_substitution(value):
        return normalize_to_list_of_substitutions(value)
    if isinstance(value, collections.abc.Mapping) or not isinstance(value, collections.abc.Iterable):
        raise TypeError(
            "value should be either a scalar, a substitutions, or a mixed list of scalars and substitutions. "
            f"Got `value={value}` of type `{type(value)}`."
        )
    scalar, is_list = _item_type(data_type)
    if data_type is not None and not is_list:
        raise TypeError(
            "The provided value resolves to a list, though the required type is a scalar. "
            f"Got value='{value}', data_type='{data_type}'."
        )
    items = [normalize_to_list_of_substitutions(x) if is_substitution(x) else x for x in value]
    if scalar is float or {int, float} <= {type(item) for item in items}:
        items = [float(item) if type(item) is int else item for item in items]
    kinds = {type(item) for item in items} - {list}
    if len(kinds) > 1 or not kinds <= set(SCALARS) or (scalar and kinds - {scalar}):
        raise TypeError(f"Got a list that is not of type '{data_type}'. value='{value}'")
    return items


def perform_typed_substitution(context: LaunchContext, value: Any, data_type: Any) -> Any:
    """Return the value that a normalized one has while launching.

    Raises:
        ValueError: if its text is none of the type.
    """
    if isinstance(value, SCALARS):
        return value
    if value and all(isinstance(item, Substitution) for item in value):
        return coerce_to_type(perform_substitutions(context, value), data_type)
    scalar, _ = _item_type(data_type)
    result = [
        coerce_to_type(perform_substitutions(context, item), scalar) if isinstance(item, list) else item
        for item in value
    ]
    if len({type(item) for item in result}) > 1:
        raise ValueError(f"The output list is not uniform: {result}")
    return result


def coerce_to_type(value: str, data_type: Any = None, *, can_be_str: bool = False) -> Any:
    """Return the value that a text stands for.

    Args:
        value: the text.
        data_type: bool, int, float, str, a list such as `list[int]`, or None for what YAML makes of it.
        can_be_str: leave the text as it is where it is no value of the type (it may be a substitution).

    Raises:
        ValueError: if it is no value of the type.
    """
    scalar, is_list = _item_type(data_type)
    if scalar is str and not is_list:
        return value
    if scalar in (int, float) and not is_list:
        try:
            return scalar(value)
        except ValueError:
            if can_be_str:
                return value
            raise
    text = {"1": "true", "0": "false"}.get(value, value) if data_type is bool else value
    result = _from_yaml(text, can_be_str)
    if not is_instance_of(result, data_type, can_be_str=can_be_str):
        raise ValueError(
            f"Cannot convert value '{value}' to '{data_type or 'bool, int, float, str or a list'}'"
        )
    return result


def is_instance_of(value: object, data_type: Any, *, can_be_str: bool = False) -> bool:
    """Return whether a value is of a type; a list must be of one type throughout."""
    scalar, is_list = _item_type(data_type)
    if data_type is None:
        if not isinstance(value, list):
            return isinstance(value, SCALARS)
        kinds = {type(item) for item in value} - ({str} if can_be_str else set())
        return kinds <= set(SCALARS) and len(kinds) <= 1
    allowed = (scalar, str) if can_be_str else (scalar,)
    if not is_list:
        return isinstance(value, allowed)
    return isinstance(value, list) and all(isinstance(item, allowed) for item in value)


def _from_yaml(text: str, can_be_str: bool) -> Any:
    import yaml

    if not text:
        return text
    try:
        return yaml.safe_load(text)
    except yaml.YAMLError as error:
        if can_be_str:
            return text
        raise ValueError(f"Failed to convert '{text}' using yaml rules: {error}") from None


def _item_type(data_type: Any) -> tuple[Any, bool]:
    """Return the type of a scalar or of the items of a list, and whether it is a list."""
    if data_type is None:
        return None, False
    if typing.get_origin(data_type) is list:
        return typing.get_args(data_type)[0], True
    if data_type not in SCALARS:
        raise ValueError(f"Unrecognized data type: {data_type}")
    return data_type, False
