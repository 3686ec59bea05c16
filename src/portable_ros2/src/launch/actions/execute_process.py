"""The action that runs a process, in one call."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from launch.actions.execute_local import ExecuteLocal
from launch.descriptions import Executable
from launch.some_substitutions_type import SomeSubstitutionsType


class ExecuteProcess(ExecuteLocal):
    """Runs a process; the launch lasts as long as the process.

    Args:
        cmd: the program and its arguments.
        prefix: what stands before the program; the launch configuration `launch-prefix` if None.
        name: how it is called in the output; the program's name if None.
        cwd: the folder it runs in.
        env: its environment variables; those of the launch if None.
        additional_env: more of them.
        local_arguments: see `ExecuteLocal`.
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
        **local_arguments: Any,
    ) -> None:
        program = Executable(
            cmd=cmd, prefix=prefix, name=name, cwd=cwd, env=env, additional_env=additional_env
        )
        super().__init__(process_description=program, **local_arguments)

    @property
    def name(self) -> Any:
        """The name in the output, or the substitutions that make it."""
        return self.process_description.final_name or self.process_description.name

    @property
    def cmd(self) -> list[Any]:
        """The program and its arguments, as texts once they are known."""
        return self.process_description.final_cmd or self.process_description.cmd

    @property
    def cwd(self) -> Any:
        """The folder it runs in, as a text once it is known."""
        return self.process_description.final_cwd or self.process_description.cwd

    @property
    def env(self) -> Any:
        """All its environment variables once they are known, else those that are given instead of the launch's."""
        return self.process_description.final_env or self.process_description.env

    @property
    def additional_env(self) -> Any:
        """The environment variables that are given besides."""
        return self.process_description.additional_env
