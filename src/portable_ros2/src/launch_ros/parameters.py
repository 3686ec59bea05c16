"""The parameters of a node, from the forms in which a launch file gives them to those that a node takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from launch.substitution import Substitution
from launch.substitutions import TextSubstitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions
from launch.utilities.type_utils import is_substitution
from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

SCALARS = (bool, int, float, str)
Name = tuple[Substitution, ...]
# A value, substitutions that make its text, or items that are each one of the two.
Normalized = ParameterFile | Parameter | dict[Name, Any]
Evaluated = Path | dict[str, Any] | tuple[str, Any]


def normalize_parameters(parameters: Any) -> tuple[Normalized, ...]:
    """Return files, dictionaries without dictionaries in them, and single parameters.

    Raises:
        TypeError: if this is no list of parameters, or if one can never have a value.
    """
    if isinstance(parameters, str) or not isinstance(parameters, Sequence):
        raise TypeError(
            f"Expected 'parameters' to be a list of files and dictionaries, but got '{parameters}' "
            f"of type '{type(parameters)}'"
        )
    return tuple(_normalized(given) for given in parameters)


def normalize_parameter_dict(parameters: Any, prefix: Sequence[Substitution] = ()) -> dict[Name, Any]:
    """Return values by names; names in a dictionary in the dictionary get its name and a dot before them.

    Raises:
        TypeError: if a name is none, or if one can never have a value.
    """
    if not isinstance(parameters, Mapping):
        raise TypeError(f"Expected a dictionary of parameters, but got '{parameters}'")
    normalized: dict[Name, Any] = {}
    for given, value in parameters.items():
        name = (*prefix, *normalize_to_list_of_substitutions(given))
        if isinstance(value, Mapping):
            normalized.update(normalize_parameter_dict(value, (*name, TextSubstitution(text="."))))
        else:
            normalized[name] = _normalized_value(value)
    return normalized


def evaluate_parameters(
    context: LaunchContext, parameters: Sequence[Normalized]
) -> tuple[Evaluated | Parameter, ...]:
    """Return files and dictionaries without substitutions; single parameters are left as they are."""
    return tuple(
        given
        if isinstance(given, Parameter)
        else given.evaluate(context)
        if isinstance(given, ParameterFile)
        else evaluate_parameter_dict(context, given)
        for given in parameters
    )


def evaluate_parameter_dict(context: LaunchContext, parameters: Mapping[Name, Any]) -> dict[str, Any]:
    """Return values by names, without substitutions.

    Raises:
        TypeError: if a value is of no type that a parameter has.
    """
    evaluated: dict[str, Any] = {}
    for substitutions, value in parameters.items():
        name = perform_substitutions(context, substitutions)
        evaluated[name] = _evaluated(context, name, value)
    return evaluated


def _normalized(given: Any) -> Normalized:
    if isinstance(given, Mapping):
        return normalize_parameter_dict(given)
    return given if isinstance(given, (Parameter, ParameterFile)) else ParameterFile(given)


def _normalized_value(value: Any) -> Any:
    if isinstance(value, (ParameterValue, *SCALARS, bytes)):
        return value
    if is_substitution(value):
        return tuple(normalize_to_list_of_substitutions(value))
    if not isinstance(value, Sequence):
        raise TypeError(f"Unexpected type for parameter value {value!r}")
    if {type(item) for item in value} == {int, float}:
        return tuple(float(item) for item in value)
    return tuple(
        item if isinstance(item, SCALARS) else tuple(normalize_to_list_of_substitutions(item))
        for item in value
    )


def _evaluated(context: LaunchContext, name: str, value: Any) -> Any:
    if isinstance(value, ParameterValue):
        return value.evaluate(context)
    if not isinstance(value, tuple):
        return value
    if is_substitution(value):
        text = perform_substitutions(context, value)
        return _checked(name, _from_yaml(name, text) if text else "")
    return _checked(
        name,
        tuple(
            _from_yaml(name, perform_substitutions(context, item)) if isinstance(item, tuple) else item
            for item in value
        ),
    )


def _from_yaml(name: str, text: str) -> Any:
    import yaml

    try:
        return yaml.safe_load(text)
    except yaml.YAMLError:
        raise TypeError(
            f"Unable to parse the value of parameter {name} as yaml. If the parameter is meant to be a string, "
            "try wrapping it in launch_ros.parameter_descriptions.ParameterValue(value, value_type=str)"
        ) from None


def _checked(name: str, value: Any) -> Any:
    """Return a value that a parameter may have; a list as a tuple."""
    if isinstance(value, (*SCALARS, bytes)):
        return value
    if not isinstance(value, (list, tuple)):
        raise TypeError(
            "Allowed value types are bytes, bool, int, float, str, Sequence[bool], Sequence[int], "
            f'Sequence[float], Sequence[str]. Got {type(value).__name__} for "{name}". If the parameter is meant to be a '
            "string, try wrapping it in launch_ros.parameter_descriptions.ParameterValue(value, value_type=str)"
        )
    if not value or type(value[0]) not in SCALARS or len({type(item) for item in value}) > 1:
        raise TypeError(
            "Expected a non-empty sequence, with items of uniform type. Allowed sequence item types are "
            f'bool, int, float, str. Got inconsistent input for "{name}"'
        )
    return tuple(value)
