"""The action that runs a process."""

from __future__ import annotations

import asyncio
import os
import signal
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import launch.logging
from launch.action import Action
from launch.condition import Condition
from launch.conditions import evaluate_condition_expression
from launch.descriptions import Executable
from launch.event import Event
from launch.event_handler import BaseEventHandler, Handled
from launch.events import Shutdown
from launch.events.process import (
    ProcessExited,
    ProcessStarted,
    ProcessStderr,
    ProcessStdout,
    ProcessTargetedEvent,
    SignalProcess,
)
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.on_event import OnActionEventBase, OnShutdown
from launch.some_entities_type import SomeEntitiesType
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitutions import LaunchConfiguration
from launch.utilities import (
    normalize_to_list_of_entities,
    normalize_to_list_of_substitutions,
    perform_substitutions,
)
from launch.utilities.type_utils import normalize_typed_substitution, perform_typed_substitution

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.process import Process


class ExecuteLocal(Action):
    """Runs a program on this machine; the launch lasts as long as the process.

    Args:
        process_description: the program, its arguments and its surroundings.
        shell: let a shell understand the command.
        sigterm_timeout: seconds from the SIGINT of a shutdown to SIGTERM.
        sigkill_timeout: seconds from there to SIGKILL.
        emulate_tty: let it write to a terminal, so that it shows colours and each line at once.
        output: where to its output goes, see `launch.logging.get_output_loggers`.
        output_format: how a line is shown.
        cached_output: keep the output for `get_stdout` and `get_stderr`.
        log_cmd: show the command before it is run.
        on_exit: what is done at its end.
        respawn: start it again when it ends.
        respawn_delay: seconds before it is started again.
        respawn_max_retries: how often it is started again; without limit if negative.
        condition: when it is run.
    """

    def __init__(
        self,
        *,
        process_description: Executable,
        shell: bool = False,
        sigterm_timeout: SomeSubstitutionsType | None = None,
        sigkill_timeout: SomeSubstitutionsType | None = None,
        emulate_tty: bool = False,
        output: SomeSubstitutionsType | Mapping[str, Any] = "log",
        output_format: str = "[{this.process_description.final_name}] {line}",
        cached_output: bool = False,
        log_cmd: bool = False,
        on_exit: SomeEntitiesType | Callable[[Any, LaunchContext], Handled] | None = None,
        respawn: bool | SomeSubstitutionsType = False,
        respawn_delay: float | None = None,
        respawn_max_retries: int = -1,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.process_description = process_description
        self.shell = shell
        self.emulate_tty = emulate_tty
        self.sigterm_timeout = _timeout("sigterm_timeout", sigterm_timeout)
        self.sigkill_timeout = _timeout("sigkill_timeout", sigkill_timeout)
        output = os.environ.get("OVERRIDE_LAUNCH_PROCESS_OUTPUT", output)
        self.output = output if isinstance(output, Mapping) else normalize_to_list_of_substitutions(output)
        self._output_format = output_format
        self._cached = {1: "", 2: ""} if cached_output else None
        self._logs_cmd = log_cmd
        self._on_exit = on_exit
        self._respawn = normalize_typed_substitution(respawn, bool)
        self._respawn_delay = respawn_delay
        self._respawns_left = respawn_max_retries

        self.process_details: dict[str, Any] | None = None
        self._process: Process | None = None
        self._completed: asyncio.Future[None] | None = None
        self._is_ending: asyncio.Future[None] | None = None
        self._partial = {1: b"", 2: b""}
        self._return_code: int | None = None

    @property
    def return_code(self) -> int | None:
        """The exit code, negative for a signal; None as long as it runs."""
        return self._return_code

    def get_stdout(self) -> str:
        """Return what it has written to its standard output, if this is kept."""
        return self._kept(1)

    def get_stderr(self) -> str:
        """Return what it has written to its standard error, if this is kept."""
        return self._kept(2)

    def get_asyncio_future(self) -> asyncio.Future[None] | None:
        """Return what ends with the process."""
        return self._completed

    def get_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """Return what is done at its end, as far as it is known."""
        known = self._on_exit is not None and not callable(self._on_exit)
        return normalize_to_list_of_entities(self._on_exit) if known else []  # type: ignore[arg-type]

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity] | None:
        """Run it.

        Raises:
            RuntimeError: if it was run before.
        """
        if self.process_details is not None:
            raise RuntimeError(
                f"ExecuteLocal action '{self.process_description.final_name}': executed more than once: {self.describe()}"
            )
        self.prepare(context)
        if context.is_shutdown:
            return None
        loop = context.asyncio_loop or asyncio.get_running_loop()
        self._completed = loop.create_future()
        self._is_ending = loop.create_future()
        for handler in self._handlers():
            context.register_event_handler(handler)
        context.add_completion_future(loop.create_task(self._run(context)))
        return None

    def prepare(self, context: LaunchContext) -> None:
        """Find out what is known now; later, the launch configurations may be others."""
        program = self.process_description
        program.prepare(context, self)
        self.process_details = {
            "action": self,
            "name": program.final_name,
            "cmd": program.final_cmd,
            "cwd": program.final_cwd,
            "env": program.final_env,
        }
        self._respawns = perform_typed_substitution(context, self._respawn, bool)
        self._sigterm_text = perform_substitutions(context, self.sigterm_timeout)
        self._sigkill_text = perform_substitutions(context, self.sigkill_timeout)
        self._uses_tty = self.emulate_tty
        if "emulate_tty" in context.launch_configurations:
            text = context.launch_configurations["emulate_tty"]
            self._uses_tty = evaluate_condition_expression(context, normalize_to_list_of_substitutions(text))
        output = (
            self.output if isinstance(self.output, Mapping) else perform_substitutions(context, self.output)
        )
        self._logger = launch.logging.get_logger(program.final_name)
        self._output_loggers = launch.logging.get_output_loggers(str(program.final_name), output)

    def _handlers(self) -> list[BaseEventHandler]:
        handlers = [_OnTargetedEvent(self), OnShutdown(on_shutdown=self._on_shutdown)]
        if self._on_exit is not None:
            handlers.append(
                OnActionEventBase(
                    action_matcher=self,
                    on_event=self._on_exit,
                    target_event_cls=ProcessExited,
                    target_action_cls=ExecuteLocal,
                )
            )
        return handlers

    async def _run(self, context: LaunchContext) -> None:
        """Run it again and again, as it is to be."""
        assert self._completed is not None
        assert self._is_ending is not None
        while not self._is_ending.done() and not context.is_shutdown:
            has_run = await self._run_once(context)
            if not has_run or not self._respawns or self._respawns_left == 0:
                break
            self._respawns_left -= 1
            if self._respawn_delay:
                await asyncio.wait([self._is_ending], timeout=self._respawn_delay)
        self._completed.set_result(None)

    async def _run_once(self, context: LaunchContext) -> bool:
        """Run it; return False if it cannot be started."""
        from launch.process import Process

        details = self.process_details
        assert details is not None
        command = " ".join(part for part in details["cmd"] if part.strip())
        if self._logs_cmd:
            self._logger.info(f"process details: cmd='{command}', cwd='{details['cwd']}', custom_env?=True")
        try:
            process = Process(
                asyncio.get_running_loop(),
                details["cmd"],
                lambda source, data: self._on_output(context, source, data),
                cwd=details["cwd"],
                env=details["env"],
                shell=self.shell,
                emulate_tty=self._uses_tty,
                # Each process gets SIGINT once: from the terminal, or else from here.
                own_group=context.noninteractive,
            )
        except OSError as error:
            self._logger.error(f"exception occurred while executing process: {error}")
            return False
        self._process = process
        details["pid"] = process.pid
        self._logger.info(f"process started with pid [{process.pid}]")
        context.emit_event_sync(ProcessStarted(**details))
        self._return_code = await process.exited
        self._process = None
        self._flush()
        if self._return_code == 0:
            self._logger.info(f"process has finished cleanly [pid {process.pid}]")
        else:
            self._logger.error(
                f"process has died [pid {process.pid}, exit code {self._return_code}, cmd '{command}']."
            )
        context.emit_event_sync(ProcessExited(returncode=self._return_code, **details))
        return True

    def _on_output(self, context: LaunchContext, source: int, data: bytes) -> None:
        *lines, self._partial[source] = (self._partial[source] + data).split(b"\n")
        for line in lines:
            self._show(source, line)
        if self._cached is not None:
            self._cached[source] += data.decode(errors="replace")
        kind = ProcessStdout if source == 1 else ProcessStderr
        context.emit_event_sync(kind(text=data, **(self.process_details or {})))

    def _show(self, source: int, line: bytes) -> None:
        text = line.removesuffix(b"\r").decode(errors="replace")
        self._output_loggers[source - 1].info("%s", self._output_format.format(line=text, this=self))

    def _flush(self) -> None:
        for source, line in self._partial.items():
            if line:
                self._show(source, line)
            self._partial[source] = b""

    def _kept(self, source: int) -> str:
        if self._cached is None:
            raise RuntimeError(
                f"cached output must be true to be able to get the output of '{self.process_description.final_name}'"
            )
        return self._cached[source]

    def _on_shutdown(self, event: Shutdown, context: LaunchContext) -> None:
        # After Ctrl-C the terminal has sent SIGINT to the process, too.
        self.end(context, send_sigint=not event.due_to_sigint or context.noninteractive)

    def end(self, context: LaunchContext, *, send_sigint: bool) -> None:
        """Let the process end, and never start it again."""
        if self._is_ending is None or self._is_ending.done():
            return
        self._is_ending.set_result(None)
        if self._process is not None:
            ladder = asyncio.get_running_loop().create_task(self._escalate(self._process, send_sigint))
            context.add_completion_future(ladder)

    async def _escalate(self, process: Process, send_sigint: bool) -> None:
        """Send stronger and stronger signals until the process ends."""
        if send_sigint:
            self.send_signal(signal.SIGINT)
        sigterm_after, sigkill_after = float(self._sigterm_text), float(self._sigkill_text)
        await asyncio.wait([process.exited], timeout=sigterm_after)
        if process.exited.done():
            return
        self._tell_escalation(self._sigterm_text, "SIGINT", "SIGTERM")
        self.send_signal(signal.SIGTERM)
        await asyncio.wait([process.exited], timeout=sigkill_after)
        if process.exited.done():
            return
        self._tell_escalation(str(sigterm_after + sigkill_after), "SIGTERM", "SIGKILL")
        self.send_signal(signal.SIGKILL)

    def _tell_escalation(self, seconds: str, sent: str, sending: str) -> None:
        self._logger.error(
            f"process[{self.process_description.final_name}] failed to terminate '{seconds}' seconds "
            f"after receiving '{sent}', escalating to '{sending}'"
        )

    def send_signal(self, number: signal.Signals) -> None:
        """Send a signal to the process, if it runs."""
        if self._process is not None:
            self._logger.info(
                f"sending signal '{number.name}' to process[{self.process_description.final_name}]"
            )
            self._process.send_signal(number)


class _OnTargetedEvent(BaseEventHandler):
    """Answers what is to be done to one process."""

    def __init__(self, action: ExecuteLocal) -> None:
        super().__init__(
            matcher=lambda event: isinstance(event, ProcessTargetedEvent) and event.process_matcher(action)
        )
        self._action = action

    def handle(self, event: Event, context: LaunchContext) -> Handled:
        """Send the signal, or let the process end."""
        super().handle(event, context)
        if isinstance(event, SignalProcess):
            self._action.send_signal(signal.Signals[event.signal_name])
        else:
            self._action.end(context, send_sigint=True)
        return None


def _timeout(name: str, given: SomeSubstitutionsType | None) -> list[Any]:
    return normalize_to_list_of_substitutions(
        LaunchConfiguration(name, default="5") if given is None else given
    )
