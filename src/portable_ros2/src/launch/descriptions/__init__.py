"""What an action runs."""

from __future__ import annotations

import itertools
import re
import shlex
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from launch.lookup import lookup
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions

if TYPE_CHECKING:
    from launch.action import Action
    from launch.launch_context import LaunchContext

__getattr__ = lookup(__name__)

__all__ = ["Executable"]

_numbers = itertools.count(1)
Variables = list[tuple[list[Substitution], list[Substitution]]]


class Executable:
    """A program with its arguments and the surroundings in which it runs.

    Args:
        cmd: the program and its arguments.
        prefix: what stands before the program; the launch configuration `launch-prefix` if None.
        name: how it is called in the output; the program's name if None.
        cwd: the folder it runs in.
        env: its environment variables; those of the launch if None.
        additional_env: more of them.
        arguments: more arguments.

    Attributes:
        final_name: its name with a number, known once it was prepared, as all that follow.
        final_cmd: the program and its arguments as texts.
        final_cwd: the folder it runs in.
        final_env: all its environment variables.
    """

    def __init__(
        self,
        *,
        cmd: Iterable[SomeSubstitutionsType],
        prefix: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        cwd: SomeSubstitutionsType | None = None,
        env: Mapping[Any, SomeSubstitutionsType] | None = None,
        additional_env: Mapping[Any, SomeSubstitutionsType] | None = None,
        arguments: Iterable[SomeSubstitutionsType] | None = None,
    ) -> None:
        self.arguments = None if arguments is None else list(arguments)
        self.cmd = [normalize_to_list_of_substitutions(part) for part in [*cmd, *(self.arguments or [])]]
        self.prefix = None if prefix is None else normalize_to_list_of_substitutions(prefix)
        self.name = None if name is None else normalize_to_list_of_substitutions(name)
        self.cwd = None if cwd is None else normalize_to_list_of_substitutions(cwd)
        self.env = None if env is None else _normalized(env)
        self.additional_env = None if additional_env is None else _normalized(additional_env)
        self.final_name: str | None = None
        self.final_cmd: list[str] = []
        self.final_cwd: str | None = None
        self.final_env: dict[str, str] = {}

    def prepare(self, context: LaunchContext, action: Action | None) -> None:  # noqa: ARG002 -- as the real one has it
        """Find out what is known now; later, the launch configurations may be others."""
        cmd = [perform_substitutions(context, part) for part in self.cmd]
        self.final_cmd = [*self._performed_prefix(context, cmd), *cmd]
        name = (
            Path(self.final_cmd[0]).name if self.name is None else perform_substitutions(context, self.name)
        )
        self.final_name = f"{name}-{next(_numbers)}"
        self.final_cwd = None if self.cwd is None else perform_substitutions(context, self.cwd)
        env = dict(context.environment) if self.env is None else _performed(context, self.env)
        self.final_env = {**env, **_performed(context, self.additional_env or [])}

    def _performed_prefix(self, context: LaunchContext, cmd: list[str]) -> list[str]:
        if self.prefix is not None:
            return shlex.split(perform_substitutions(context, self.prefix))
        pattern = context.launch_configurations.get("launch-prefix-filter", "")
        if re.match(pattern, Path(cmd[0]).name) is None:
            return []
        return shlex.split(context.launch_configurations.get("launch-prefix", ""))


def _normalized(variables: Mapping[Any, SomeSubstitutionsType]) -> Variables:
    return [
        (normalize_to_list_of_substitutions(name), normalize_to_list_of_substitutions(value))
        for name, value in variables.items()
    ]


def _performed(context: LaunchContext, variables: Variables) -> dict[str, str]:
    return {
        perform_substitutions(context, name): perform_substitutions(context, value)
        for name, value in variables
    }
