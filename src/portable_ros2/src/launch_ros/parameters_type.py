"""The types in which parameters may be given, for those who annotate their own functions with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from launch.some_substitutions_type import SomeSubstitutionsType, SomeSubstitutionsType_types_tuple
from launch.substitution import Substitution
from launch_ros.parameter_descriptions import Parameter, ParameterFile
from launch_ros.parameter_descriptions import ParameterValue as ParameterValueDescription
from launch_ros.parameters import SCALARS

Scalar = bool | int | float | str
EvaluatedParameterValue = Scalar | bytes | Sequence[bool] | Sequence[int] | Sequence[float] | Sequence[str]
EvaluatedParameters = Sequence[Path | Parameter | dict[str, EvaluatedParameterValue]]
SomeParameterFile = SomeSubstitutionsType | Path | ParameterFile
SomeParameterName = Sequence[Substitution | str]
SomeParameterValue = (
    ParameterValueDescription
    | SomeSubstitutionsType
    | Sequence[SomeSubstitutionsType]
    | EvaluatedParameterValue
)
SomeParameterValue_types_tuple = (*SomeSubstitutionsType_types_tuple, *SCALARS, bytes)
SomeParametersDict = Mapping[SomeParameterName, Any]
SomeParameters = Sequence[SomeParameterFile | Parameter | SomeParametersDict]
ParameterName = Sequence[Substitution]
ParameterValue = (
    Sequence[Substitution]
    | Sequence[Sequence[Substitution]]
    | EvaluatedParameterValue
    | ParameterValueDescription
)
ParametersDict = dict[ParameterName, ParameterValue]
Parameters = Sequence[ParameterFile | ParametersDict | Parameter]
