"""Actions about arguments, launch configurations and environment variables."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import launch.logging
from launch.action import Action
from launch.condition import Condition
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions
from launch.utilities.type_utils import normalize_typed_substitution, perform_typed_substitution

if TYPE_CHECKING:
    from launch.actions.flow import IncludeLaunchDescription
    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import Arguments


class DeclareLaunchArgument(Action):
    """An argument of the launch description; its value is a launch configuration of the same name."""

    def __init__(
        self,
        name: str,
        *,
        default_value: SomeSubstitutionsType | None = None,
        description: str | None = None,
        choices: Sequence[str] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.name = name
        self.choices = choices
        self.description = _description(description, choices)
        self.default_value = (
            None if default_value is None else normalize_to_list_of_substitutions(default_value)
        )
        self._conditionally_included = False
        self._logger = launch.logging.get_logger("launch.actions.declare_launch_argument")
        if choices is not None and len(choices) == 0:
            self._fail("Provided choices arg is empty. Use None to ignore the choice list.")
        if choices is not None and isinstance(default_value, str) and default_value not in choices:
            self._fail(f'Provided default_value "{default_value}" is not in provided choices "{choices}".')

    def execute(self, context: LaunchContext) -> None:
        """Check the value, or set it to the default.

        Raises:
            RuntimeError: if there is no value and no default, or if it is not one of the choices.
        """
        if self.name not in context.launch_configurations:
            if self.default_value is None:
                self._logger.error(
                    f'Required launch argument "{self.name}" (description: "{self.description}") '
                    "was not provided"
                )
                raise RuntimeError(f'Required launch argument "{self.name}" was not provided.')
            context.launch_configurations[self.name] = perform_substitutions(context, self.default_value)
        value = context.launch_configurations[self.name]
        if self.choices is not None and value not in self.choices:
            self._fail(
                f'Argument "{self.name}" provided value "{value}" is not valid. '
                f"Valid options are: {self.choices}"
            )

    def _find_arguments(
        self, found: Arguments, includes: list[IncludeLaunchDescription], *, conditional: bool
    ) -> bool:
        if self.name not in found:
            self._conditionally_included = conditional or self.condition is not None
            found[self.name] = (self, includes)
        return True

    def _fail(self, text: str) -> None:
        self._logger.error(text)
        raise RuntimeError(text)


def _description(description: str | None, choices: Sequence[str] | None) -> str:
    if choices is None:
        return "no description given" if description is None else description
    if description is None:
        return f"One of: {choices}"
    return f"{description.removesuffix('.')}. Valid choices are: {choices}"


class _Set(Action):
    _variables: ClassVar[str]  # the attribute of the context in which they are

    def __init__(
        self, name: SomeSubstitutionsType, value: SomeSubstitutionsType, *, condition: Condition | None = None
    ) -> None:
        super().__init__(condition=condition)
        self.name = normalize_to_list_of_substitutions(name)
        self.value = normalize_to_list_of_substitutions(value)

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        name = perform_substitutions(context, self.name)
        getattr(context, self._variables)[name] = perform_substitutions(context, self.value)


class _Unset(Action):
    _variables: ClassVar[str]

    def __init__(self, name: SomeSubstitutionsType, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.name = normalize_to_list_of_substitutions(name)

    def execute(self, context: LaunchContext) -> None:
        """Forget it, if it is there."""
        getattr(context, self._variables).pop(perform_substitutions(context, self.name), None)


class SetLaunchConfiguration(_Set):
    """Sets a launch configuration."""

    _variables = "launch_configurations"


class UnsetLaunchConfiguration(_Unset):
    """Forgets a launch configuration."""

    _variables = "launch_configurations"


class PushLaunchConfigurations(Action):
    """Remembers the launch configurations."""

    def execute(self, context: LaunchContext) -> None:
        """Remember them."""
        context._push_launch_configurations()


class PopLaunchConfigurations(Action):
    """Brings back the launch configurations that were remembered last."""

    def execute(self, context: LaunchContext) -> None:
        """Bring them back."""
        context._pop_launch_configurations()


class ResetLaunchConfigurations(Action):
    """Forgets all launch configurations but those that are given here."""

    def __init__(
        self,
        launch_configurations: Mapping[Any, SomeSubstitutionsType] | None = None,
        *,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self._kept = dict(launch_configurations or {})

    def execute(self, context: LaunchContext) -> None:
        """Forget the others."""
        kept = {
            perform_substitutions(context, normalize_to_list_of_substitutions(name)): _performed(
                context, value
            )
            for name, value in self._kept.items()
        }
        context.launch_configurations.clear()
        context.launch_configurations.update(kept)

    def _find_arguments(self, *_: object, conditional: bool) -> bool:  # noqa: ARG002
        return False


def _performed(context: LaunchContext, value: Any) -> Any:
    """Return the text of substitutions; other values, such as the parameters of all nodes, as they are."""
    is_text = isinstance(value, (str, Path, Substitution))
    if is_text or any(isinstance(item, Substitution) for item in value):
        return perform_substitutions(context, normalize_to_list_of_substitutions(value))
    return value


class SetEnvironmentVariable(_Set):
    """Sets an environment variable for what is started from now on."""

    _variables = "environment"


class UnsetEnvironmentVariable(_Unset):
    """Removes an environment variable for what is started from now on."""

    _variables = "environment"


class AppendEnvironmentVariable(Action):
    """Adds to the end (or the beginning) of an environment variable, or sets it."""

    def __init__(
        self,
        name: SomeSubstitutionsType,
        value: SomeSubstitutionsType,
        prepend: bool | SomeSubstitutionsType = False,
        separator: SomeSubstitutionsType = os.pathsep,
        *,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.name = normalize_to_list_of_substitutions(name)
        self.value = normalize_to_list_of_substitutions(value)
        self.prepend = normalize_typed_substitution(prepend, bool)
        self.separator = normalize_to_list_of_substitutions(separator)

    def execute(self, context: LaunchContext) -> None:
        """Add it."""
        name = perform_substitutions(context, self.name)
        parts = [context.environment[name]] if name in context.environment else []
        new = perform_substitutions(context, self.value)
        parts.insert(0 if perform_typed_substitution(context, self.prepend, bool) else len(parts), new)
        context.environment[name] = perform_substitutions(context, self.separator).join(parts)


class PushEnvironment(Action):
    """Remembers the environment variables."""

    def execute(self, context: LaunchContext) -> None:
        """Remember them."""
        context._push_environment()


class PopEnvironment(Action):
    """Brings back the environment variables that were remembered last."""

    def execute(self, context: LaunchContext) -> None:
        """Bring them back."""
        context._pop_environment()


class ResetEnvironment(Action):
    """Brings back the environment variables that launching began with."""

    def execute(self, context: LaunchContext) -> None:
        """Bring them back."""
        context._reset_environment()
