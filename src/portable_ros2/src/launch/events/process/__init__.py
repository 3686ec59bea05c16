"""What happens to processes."""

from __future__ import annotations

import signal
from collections.abc import Callable
from typing import TYPE_CHECKING

from launch.event import Event
from launch.events import matches_action
from launch.lookup import lookup

if TYPE_CHECKING:
    from launch.actions import ExecuteLocal

__getattr__ = lookup(__name__)

Matcher = Callable[["ExecuteLocal"], bool]


class RunningProcessEvent(Event):
    """Something about a process."""

    name = "launch.events.process.RunningProcessEvent"

    def __init__(
        self,
        *,
        action: ExecuteLocal,
        name: str,
        cmd: list[str],
        cwd: str | None,
        env: dict[str, str] | None,
        pid: int,
    ) -> None:
        self.action = action
        self.process_name = name
        self.cmd = cmd
        self.cwd = cwd
        self.env = env
        self.pid = pid

    @property
    def execute_process_action(self) -> ExecuteLocal:
        """The action, under its other name."""
        return self.action


class ProcessStarted(RunningProcessEvent):
    """A process has started."""

    name = "launch.events.process.ProcessStarted"


class ProcessExited(RunningProcessEvent):
    """A process has ended; `returncode` is negative if a signal ended it."""

    name = "launch.events.process.ProcessExited"

    def __init__(self, *, returncode: int, **details: object) -> None:
        super().__init__(**details)  # type: ignore[arg-type]
        self.returncode = returncode


class ProcessIO(RunningProcessEvent):
    """A process has written something."""

    name = "launch.events.process.ProcessIO"

    def __init__(self, *, text: bytes, fd: int, **details: object) -> None:
        super().__init__(**details)  # type: ignore[arg-type]
        self.text = text
        self.from_stdin = fd == 0
        self.from_stdout = fd == 1
        self.from_stderr = fd == 2


class ProcessStdin(ProcessIO):
    """Something was written to a process's standard input."""

    name = "launch.events.process.ProcessStdin"

    def __init__(self, *, text: bytes, **details: object) -> None:
        super().__init__(text=text, fd=0, **details)


class ProcessStdout(ProcessIO):
    """A process has written to its standard output."""

    name = "launch.events.process.ProcessStdout"

    def __init__(self, *, text: bytes, **details: object) -> None:
        super().__init__(text=text, fd=1, **details)


class ProcessStderr(ProcessIO):
    """A process has written to its standard error."""

    name = "launch.events.process.ProcessStderr"

    def __init__(self, *, text: bytes, **details: object) -> None:
        super().__init__(text=text, fd=2, **details)


class ProcessTargetedEvent(Event):
    """Something that is to be done to the processes that match."""

    name = "launch.events.process.ProcessTargetedEvent"

    def __init__(self, *, process_matcher: Matcher) -> None:
        self.process_matcher = process_matcher


class ShutdownProcess(ProcessTargetedEvent):
    """Processes are to end."""

    name = "launch.events.process.ShutdownProcess"


class SignalProcess(ProcessTargetedEvent):
    """Processes are to get a signal."""

    name = "launch.events.process.SignalProcess"

    def __init__(self, *, signal_number: str | signal.Signals, process_matcher: Matcher) -> None:
        super().__init__(process_matcher=process_matcher)
        self.signal = signal_number

    @property
    def signal_name(self) -> str:
        """The name, such as SIGINT."""
        return self.signal if isinstance(self.signal, str) else self.signal.name


def matches_name(name: str) -> Matcher:
    """Return a function that tells whether a process has a name."""
    return lambda action: (action.process_details or {}).get("name") == name


def matches_pid(pid: int) -> Matcher:
    """Return a function that tells whether a process has a number."""
    return lambda action: (action.process_details or {}).get("pid") == pid


def matches_executable(executable: str) -> Matcher:
    """Return a function that tells whether a process runs a program."""
    return lambda action: (action.process_details or {}).get("cmd", [None])[0] == executable


__all__ = [
    "ProcessExited",
    "ProcessIO",
    "ProcessStarted",
    "ProcessStderr",
    "ProcessStdin",
    "ProcessStdout",
    "ProcessTargetedEvent",
    "RunningProcessEvent",
    "ShutdownProcess",
    "SignalProcess",
    "matches_action",
    "matches_executable",
    "matches_name",
    "matches_pid",
]
