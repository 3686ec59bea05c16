"""The parameters of a node, from the forms in which a launch file gives them to those that a node takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from launch.substitution import Substitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions
from launch.utilities.type_utils import is_substitution
from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

SCALARS = (bool, int, float, str)
Evaluated = Path | dict[str, Any] | tuple[str, Any]


def check_parameters(parameters: Any) -> None:
    """Raise TypeError if this is no list of parameters."""
    if isinstance(parameters, str) or not isinstance(parameters, Sequence):
        raise TypeError(
            f"Expected 'parameters' to be a list of files and dictionaries, but got '{parameters}' "
            f"of type '{type(parameters)}'"
        )


def evaluate_parameters(context: LaunchContext, parameters: Sequence[Any]) -> list[Evaluated]:
    """Return files, dictionaries and single parameters without substitutions."""
    evaluated: list[Evaluated] = []
    for given in parameters:
        if isinstance(given, Mapping):
            evaluated.append(evaluate_parameter_dict(context, given))
        elif isinstance(given, (Parameter, ParameterFile)):
            evaluated.append(given.evaluate(context))
        else:
            evaluated.append(ParameterFile(given).evaluate(context))
    return evaluated


def evaluate_parameter_dict(
    context: LaunchContext, parameters: Mapping[Any, Any], prefix: str = ""
) -> dict[str, Any]:
    """Return values by names; names in a dictionary in the dictionary get its name and a dot before them."""
    evaluated: dict[str, Any] = {}
    for given, value in parameters.items():
        name = prefix + perform_substitutions(context, normalize_to_list_of_substitutions(given))
        if isinstance(value, Mapping):
            evaluated.update(evaluate_parameter_dict(context, value, f"{name}."))
        else:
            evaluated[name] = _evaluated(context, name, value)
    return evaluated


def _evaluated(context: LaunchContext, name: str, value: Any) -> Any:
    if isinstance(value, ParameterValue):
        return value.evaluate(context)
    if isinstance(value, (*SCALARS, bytes)):
        return value
    if is_substitution(value):
        text = perform_substitutions(context, normalize_to_list_of_substitutions(value))
        return _checked(name, _from_yaml(name, text) if text else "")
    if isinstance(value, Sequence):
        return _checked(name, _evaluated_list(context, name, value))
    raise TypeError(f"Unexpected type for parameter value {value!r}")


def _evaluated_list(context: LaunchContext, name: str, value: Sequence[Any]) -> list[Any]:
    """Return the items: as they are if all are of one type, else as YAML understands their texts."""
    kinds = {type(item) for item in value}
    if kinds == {int, float}:
        return [float(item) for item in value]
    if len(kinds) <= 1 and kinds <= set(SCALARS):
        return list(value)
    return [_from_yaml(name, _text(context, item)) for item in value]


def _text(context: LaunchContext, item: Any) -> str:
    if isinstance(item, (str, Sequence, Substitution)):
        return perform_substitutions(context, normalize_to_list_of_substitutions(item))
    return str(item)


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
    if isinstance(value, (*SCALARS, bytes)):
        return value
    if not isinstance(value, list):
        raise TypeError(
            "Allowed value types are bytes, bool, int, float, str, Sequence[bool], Sequence[int], "
            f'Sequence[float], Sequence[str]. Got {type(value)} for "{name}". If the parameter is meant to be a '
            "string, try wrapping it in launch_ros.parameter_descriptions.ParameterValue(value, value_type=str)"
        )
    if not value or type(value[0]) not in SCALARS or len({type(item) for item in value}) > 1:
        raise TypeError(
            "Expected a non-empty sequence, with items of uniform type. Allowed sequence item types are "
            f'bool, int, float, str. Got inconsistent input for "{name}"'
        )
    return value
