"""When an action is executed."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from typing import TYPE_CHECKING

from launch.condition import Condition
from launch.lookup import lookup
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

__getattr__ = lookup(__name__)

_TRUTHS = {"true": True, "1": True, "false": False, "0": False}


class InvalidConditionExpressionError(ValueError):
    """A text is neither true nor false."""


def evaluate_condition_expression(context: LaunchContext, expression: Iterable[Substitution]) -> bool:
    """Return whether substitutions make `true` or `1`, in any case and with any space around.

    Raises:
        InvalidConditionExpressionError: if they make neither this nor `false` nor `0`.
    """
    expression = list(expression)
    text = perform_substitutions(context, expression).strip().lower()
    if text in _TRUTHS:
        return _TRUTHS[text]
    raise InvalidConditionExpressionError(
        f"invalid condition expression, expected one of [{', '.join(_TRUTHS)}] but got '{text}', "
        f"expanded from '{' + '.join(sub.describe() for sub in expression)}'"
    )


class IfCondition(Condition):
    """Holds if an expression is true."""

    def __init__(self, predicate_expression: SomeSubstitutionsType) -> None:
        expression = normalize_to_list_of_substitutions(predicate_expression)
        super().__init__(predicate=lambda context: evaluate_condition_expression(context, expression))


class UnlessCondition(IfCondition):
    """Holds if an expression is false."""

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether it holds."""
        return not super().evaluate(context)


class LaunchConfigurationEquals(Condition):
    """Holds if a launch configuration has a value, or is not there for the value None."""

    def __init__(self, launch_configuration_name: str, expected_value: SomeSubstitutionsType | None) -> None:
        warnings.warn(
            "The 'LaunchConfigurationEquals' and 'LaunchConfigurationNotEquals' conditions are deprecated: "
            "use IfCondition(EqualsSubstitution(LaunchConfiguration(...), ...)).",
            UserWarning,
            stacklevel=2,
        )
        self._name = launch_configuration_name
        self._expected = (
            None if expected_value is None else normalize_to_list_of_substitutions(expected_value)
        )
        super().__init__(predicate=self._is_equal)

    def _is_equal(self, context: LaunchContext) -> bool:
        expected = None if self._expected is None else perform_substitutions(context, self._expected)
        return bool(context.launch_configurations.get(self._name) == expected)


class LaunchConfigurationNotEquals(LaunchConfigurationEquals):
    """Holds if a launch configuration has another value, or is there for the value None."""

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether it holds."""
        return not super().evaluate(context)
