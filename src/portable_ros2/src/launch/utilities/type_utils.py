"""Values that may be substitutions, and the types that their texts become."""

from __future__ import annotations

import collections.abc
import typing
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.utilities import (
    ensure_argument_type,
    normalize_to_list_of_substitutions,
    perform_substitutions,
)

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

# The names of the real package, for those who annotate their own functions with them.
ScalarTypesTuple = (int, float, bool, str)
ListTypesTuple = (list[int], list[float], list[bool], list[str])
AllowedTypesTuple = (*ScalarTypesTuple, *ListTypesTuple)
ScalarValueType = int | float | bool | str
ListValueType = list[int] | list[float] | list[bool] | list[str]
SequenceValueType = Sequence[int] | Sequence[float] | Sequence[bool] | Sequence[str]
AllowedValueType = ScalarValueType | SequenceValueType
ScalarTypesType = type[ScalarValueType]
ListTypesType = type[ListValueType]
AllowedTypesType = ScalarTypesType | ListTypesType
SomeScalarType = SomeSubstitutionsType | ScalarValueType
SomeSequenceType = Sequence[ScalarValueType | SomeSubstitutionsType]
SomeValueType = SomeScalarType | SomeSequenceType
NormalizedScalarType = list[Substitution] | ScalarValueType
NormalizedSequenceType = list[ScalarValueType | list[Substitution]]
NormalizedValueType = NormalizedScalarType | NormalizedSequenceType
StrSomeScalarType = SomeScalarType
StrSomeSequenceType = Sequence[ScalarValueType]
StrSomeValueType = StrSomeScalarType | StrSomeSequenceType


def is_typing_list(data_type: Any) -> bool:
    """Return whether a type is a list of something, such as `list[int]`, or `typing.List`."""
    return data_type is typing.List or (  # noqa: UP006 -- as launch files may write it
        typing.get_origin(data_type) is list and bool(typing.get_args(data_type))
    )


def is_valid_scalar_type(data_type: Any) -> bool:
    """Return whether a type is int, float, bool or str."""
    return data_type in ScalarTypesTuple


def extract_type(data_type: Any) -> tuple[Any, bool]:
    """Return the type of a scalar or of the items of a list, and whether it is a list.

    Raises:
        ValueError: if it is none of int, float, bool and str, and no list of them.
    """
    is_list = is_typing_list(data_type) and bool(typing.get_args(data_type))
    scalar = typing.get_args(data_type)[0] if is_list else data_type
    if not is_valid_scalar_type(scalar):
        raise ValueError(f"Unrecognized data type: {data_type}")
    return scalar, is_list


def is_instance_of_valid_type(value: object, *, can_be_str: bool = False) -> bool:
    """Return whether a value is a scalar, or a list of scalars of one type."""
    if not isinstance(value, list):
        return isinstance(value, ScalarTypesTuple)
    kinds = {type(item) for item in value} - ({str} if can_be_str else set())
    return kinds <= set(ScalarTypesTuple) and len(kinds) <= 1


def is_instance_of(value: object, data_type: Any = None, *, can_be_str: bool = False) -> bool:
    """Return whether a value is of a type; of None, whether it is of any that there is."""
    if data_type is None:
        return is_instance_of_valid_type(value, can_be_str=can_be_str)
    scalar, is_list = extract_type(data_type)
    allowed = (scalar, str) if can_be_str else (scalar,)
    if not is_list:
        return isinstance(value, allowed)
    return isinstance(value, list) and all(isinstance(item, allowed) for item in value)


def coerce_to_type(value: str, data_type: Any = None, *, can_be_str: bool = False) -> Any:
    """Return the value that a text stands for.

    Args:
        value: the text.
        data_type: bool, int, float, str, a list such as `list[int]`, or None for what YAML makes of it.
        can_be_str: leave the text as it is where it is no value of the type (it may be a substitution).

    Raises:
        ValueError: if it is no value of the type.
        TypeError: if it is no text.
    """
    ensure_argument_type(value, str, "value", "coerce_to_type")
    scalar, is_list = (None, False) if data_type is None else extract_type(data_type)
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


def coerce_list(value: list[str], data_type: Any = None, *, can_be_str: bool = False) -> list[Any]:
    """Return the values that texts stand for, as `coerce_to_type` does.

    Raises:
        ValueError: if one is no value of the type, or if they are of several types.
        TypeError: if it is no list of texts.
    """
    ensure_argument_type(value, list, "value", "coerce_list")
    items = [coerce_to_type(item, data_type, can_be_str=can_be_str) for item in value]
    if not is_instance_of_valid_type(items, can_be_str=can_be_str):
        raise ValueError(f"Cannot convert the items of {value} to one type")
    return items


def get_typed_value(value: str | list[str], data_type: Any = None, *, can_be_str: bool = False) -> Any:
    """Return the value that a text stands for, or the list for a list of texts.

    Raises:
        ValueError: if one is no value of the type.
        TypeError: if the type is no list and the value is one, or if it is neither text nor list.
    """
    if not isinstance(value, list):
        return coerce_to_type(value, data_type, can_be_str=can_be_str)
    scalar, is_list = (None, True) if data_type is None else extract_type(data_type)
    if not is_list:
        raise TypeError(f"Cannot convert the list {value} to '{data_type}'")
    return coerce_list(value, scalar, can_be_str=can_be_str)


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
    if isinstance(value, ScalarTypesTuple):
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
    scalar, is_list = (None, True) if data_type is None else extract_type(data_type)
    if not is_list:
        raise TypeError(
            "The provided value resolves to a list, though the required type is a scalar. "
            f"Got value='{value}', data_type='{data_type}'."
        )
    items = [normalize_to_list_of_substitutions(x) if is_substitution(x) else x for x in value]
    if scalar is float or {int, float} <= {type(item) for item in items}:
        items = [float(item) if type(item) is int else item for item in items]
    kinds = {type(item) for item in items} - {list}
    if len(kinds) > 1 or not kinds <= set(ScalarTypesTuple) or (scalar and kinds - {scalar}):
        raise TypeError(f"Got a list that is not of type '{data_type}'. value='{value}'")
    return items


def is_normalized_substitution(value: object) -> bool:
    """Return whether a value is a list of substitutions and nothing else."""
    return isinstance(value, list) and bool(value) and all(isinstance(item, Substitution) for item in value)


def perform_typed_substitution(context: LaunchContext, value: Any, data_type: Any) -> Any:
    """Return the value that a normalized one has while launching.

    Raises:
        ValueError: if its text is none of the type, or a list is to become a scalar.
        TypeError: if it can never be of the type.
    """
    if isinstance(value, ScalarTypesTuple):
        if not is_instance_of(value, data_type):
            raise TypeError(f"value='{value}' is not an instance of {data_type}")
        return value
    if is_normalized_substitution(value):
        return coerce_to_type(perform_substitutions(context, value), data_type)
    if not isinstance(value, list):
        raise TypeError(f"value='{value}' is neither a scalar nor a list")
    scalar, is_list = (None, True) if data_type is None else extract_type(data_type)
    if not is_list:
        raise ValueError(f"The list {value} cannot be converted to '{data_type}'")
    result = [
        coerce_to_type(perform_substitutions(context, item), scalar)
        if is_normalized_substitution(item)
        else item
        for item in value
    ]
    if not is_instance_of(result, data_type):
        raise ValueError(f"The items of the list are not of one type, or of another type: {result}")
    return result


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
