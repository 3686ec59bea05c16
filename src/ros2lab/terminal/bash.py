"""A real, interactive bash in a terminal of its own, driven line by line."""

from __future__ import annotations

import contextlib
import os
import secrets
import shlex
import signal
import termios
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path

import pexpect

from ros2lab import course, environment
from ros2lab.interrupts import interrupted_says
from ros2lab.process_family import keeping
from ros2lab.scratch import scratch_folder
from ros2lab.terminal.stream import Done, Event, FullScreen, Started, Stream, Unfinished

START_TIMEOUT = 30.0  # s
ENDING_TIMEOUT = 5.0  # s, for what Ctrl-C should end
GIVING_TIME = 1.0  # s, in which bash gives the terminal to a program, or takes it back
SHORT_PATIENCE = 1.0  # s, for what will not end by itself
LONGEST_LINE = 4000  # bytes; Linux hands a program at most 4095 of a line that was typed
KEPT_OUTPUT = 1_000_000  # characters
COLUMNS, ROWS = 110, 40
POLL_PERIOD = 0.25  # s, for who waits for the keyboard, which nobody announces
# So often in a row it must look so: on a busy machine bash may be at its next line before it is heard to have ended one.
POLLS = 4

_HERE = Path(__file__).parent
_GREEN, _BLUE, _PLAIN = "\x1b[1;32m", "\x1b[1;34m", "\x1b[0m"
_READ_CALL = "0"  # x86-64
_MEANINGS = {
    126: "it cannot be run: is it executable?",
    127: "there is no such command: is it spelt right, and is the workspace sourced?",
    130: "it was interrupted",
}


class TerminalError(RuntimeError):
    """A command failed, or could not be run to its end; the text says which and why.

    Attributes:
        shown: the end of what the failed cell's commands have printed; empty outside a cell.
        folder: where the terminal stood then.
    """

    shown = ""
    folder = "~"

    def _render_traceback_(self) -> list[str]:
        # IPython shows this instead of a traceback through the lab's own code.
        return [str(self)]


class Terminal:
    """A bash that stays open: folder, variables, functions, jobs and what was sourced hold from run to run.

    Its home folder is the student's folder: `~/ros2_ws` is there, and nothing of the user's own is touched.

    Args:
        name: how it is called in prompts and messages.

    Raises:
        TerminalError: if bash does not start.
    """

    def __init__(self, name: str = "1") -> None:
        self.name = name
        self.folder = "~"
        self.is_open = True
        self.last_code: int | None = None
        word = secrets.token_hex(8)
        self._stream = Stream(word)
        self._texts: deque[str] = deque()
        self._length = 0  # characters kept
        # Counted in all characters ever shown: the end, what `show` was given, the last line that was typed.
        self._end = self._position = self._typed = 0
        self._state: Event | None = None
        self._changed = threading.Condition()
        home = course.work_folder()
        course.open_work_folder(home)
        keeper, *words = keeping(
            ["bash", "--noprofile", "--noediting", "--rcfile", str(_HERE / "bashrc.bash"), "-i"]
        )
        self._bash = pexpect.spawn(
            keeper,
            words,
            cwd=str(home),
            env={**_environment(home), "ROS2LAB_WORD": word},
            dimensions=(ROWS, COLUMNS),
            echo=False,
        )
        self._bash.delaybeforesend = None  # each line would wait 50 ms; here bash is known to be ready
        self._reader = threading.Thread(target=self._read, name=f"ros2lab-terminal-{name}", daemon=True)
        self._reader.start()
        with self._changed:
            self._changed.wait_for(lambda: isinstance(self._state, Done) or not self.is_open, START_TIMEOUT)
        if not isinstance(self._state, Done):
            said = self.read().strip()
            self.close()
            raise TerminalError(
                f"bash does not start here: {said or 'it says nothing'}; run `ros2lab doctor`."
            )

    @property
    def is_busy(self) -> bool:
        """Whether a command runs in its foreground."""
        return self.is_open and not isinstance(self._state, Done)

    def run(
        self,
        lines: Sequence[str],
        show: Callable[[str], object] = lambda _: None,
        *,
        timeout: float | None = None,
        goes_on: bool = False,
        in_background: bool = False,
    ) -> list[int]:
        """Type lines, each when bash is ready for it, and wait for what they do.

        Args:
            lines: what is typed.
            show: is given the prompts, the lines and what they print, as it comes.
            timeout: the longest time for all of it, in s; None waits for ever.
            goes_on: whether the lines after a command that failed are typed, too.
            in_background: whether the last line is left running.

        Returns:
            The exit code of each command that has ended.

        Raises:
            TerminalError: if a command fails (unless `goes_on`), is not complete, waits for the keyboard or does
                not end in time; or if the terminal is busy or closed. Unless it is closed, it is ready again.
            KeyboardInterrupt: after the command that this has interrupted has ended.
        """
        self._check_ready(lines)
        deadline = time.monotonic() + (float("inf") if timeout is None else timeout)
        # What is left running is a command, and a comment below it is none.
        typed = (line.strip() and not (in_background and line.lstrip().startswith("#")) for line in lines)
        last = max((number for number, is_typed in enumerate(typed) if is_typed), default=-1)
        codes: list[int] = []
        command = ""
        for number, line in enumerate(lines[: last + 1]):
            if not line.strip() and isinstance(self._state, Done):
                continue
            command = self._type(line, command, show)
            if in_background and number == last:
                self._wait(lambda: self._state is not None, show, deadline)
                break
            self._wait_for_end(command, show, deadline)
            if isinstance(self._state, Unfinished):
                continue
            if not self.is_open:
                self._check_ended(number == last)
                break
            if command.lstrip().startswith("#"):
                continue  # the code is still that of the command before it
            codes.append(self.last_code or 0)
            if self.last_code and not goes_on:
                raise _failure(command, self.last_code, not_typed=last - number)
        if isinstance(self._state, Unfinished) and not in_background:
            self.interrupt()
            raise TerminalError(
                f"The cell ends in the middle of a command, `{_brief(command)}`: a quote, a bracket or a "
                "here-document is not closed."
            )
        return codes

    def read(self) -> str:
        """Return what it has shown: the newest million characters."""
        with self._changed:
            return "".join(self._texts)

    def environ(self) -> dict[str, str]:
        """Return the variables that its shell hands on to what it starts.

        Raises:
            TerminalError: if it is busy or closed.
        """
        with scratch_folder() as scratch:
            file = scratch / "environment"
            self.run([f"env -0 >| {shlex.quote(str(file))}"])
            entries = os.fsdecode(file.read_bytes()).split("\0")
        return dict(entry.split("=", 1) for entry in entries if "=" in entry)

    def wait_for(self, text: str, timeout: float = 30.0) -> None:
        """Wait until what was typed last has printed a text.

        Raises:
            TerminalError: if it has not within `timeout` seconds, or the command in its foreground ends before.
        """
        with interrupted_says(f"the command in terminal {self.name} goes on."), self._changed:
            self._changed.wait_for(lambda: text in self._since(self._typed) or not self.is_busy, timeout)
            printed = self._since(self._typed)
        if text not in printed:
            end = f"after {timeout:g} s" if self.is_busy else "and its command has ended"
            raise TerminalError(
                f"Terminal {self.name} has not shown {text!r} {end}. Its last words: {_last(printed)}"
            )

    def interrupt(self, patience: float = ENDING_TIMEOUT) -> None:
        """End the command in its foreground, as Ctrl-C does, and after `patience` (s) harder."""
        if not self.is_busy:
            return
        if not self._interrupt_program():
            self._bash.sendintr()
        if not self._wait_until_ready(patience):
            with contextlib.suppress(OSError):
                os.killpg(os.tcgetpgrp(self._bash.child_fd), signal.SIGKILL)
            if not self._wait_until_ready(ENDING_TIMEOUT):
                self.close()

    def close(self) -> None:
        """End bash and everything that came from it. Closing twice does no harm."""
        if not self._bash.closed and self._bash.isalive():
            os.kill(self._bash.pid, signal.SIGHUP)  # the keeper ends the others
        self._reader.join(ENDING_TIMEOUT)
        if not self._bash.closed:
            self._bash.close(force=True)

    def _type(self, line: str, command: str, show: Callable[[str], object]) -> str:
        """Type a line; return the command of which it is a part, as far as it is known."""
        continues = isinstance(self._state, Unfinished)
        prompt = "> " if continues else f"{_GREEN}{self.name}{_PLAIN}:{_BLUE}{self.folder}{_PLAIN}$ "
        shown = f"{prompt}{line}\n"
        with self._changed:
            self._state = None
            self._keep(shown)
            self._position = self._typed = self._end
        show(shown)
        self._bash.sendline(line)
        return f"{command}\n{line}" if continues else line

    def _wait_for_end(self, command: str, show: Callable[[str], object], deadline: float) -> None:
        try:
            reason = self._wait(
                lambda: isinstance(self._state, (Done, Unfinished, FullScreen)), show, deadline
            )
            if isinstance(self._state, FullScreen):
                reason = "takes the whole screen, which a notebook cannot give"
        except KeyboardInterrupt:
            self.interrupt()
            show(self._new_text())
            raise
        if reason:
            self.interrupt(SHORT_PATIENCE)
            show(self._new_text())
            raise TerminalError(f"`{_brief(command)}` {reason}; it was interrupted.")

    def _wait(self, is_over: Callable[[], bool], show: Callable[[str], object], deadline: float) -> str:
        """Show what comes until it is over; return why that is not to be waited for, empty if it is over."""
        times_waiting = 0
        while True:
            with self._changed:
                # An interrupt of the notebook is only noticed between two waits.
                self._changed.wait_for(
                    lambda: is_over() or not self.is_open or self._end > self._position, POLL_PERIOD
                )
                finished = is_over() or not self.is_open
                text = self._new_text()
            if text:
                show(text)
                times_waiting = 0
            if finished:
                return ""
            if time.monotonic() > deadline:
                return "did not end in time"
            times_waiting = times_waiting + 1 if not text and self._waits_for_keyboard() else 0
            if times_waiting == POLLS:
                return "waits for the keyboard, and what is typed into a notebook does not reach it"

    def _waits_for_keyboard(self) -> bool:
        """Return whether what runs in the foreground reads what nobody will type."""
        if not isinstance(self._state, Started):
            return False
        with contextlib.suppress(OSError, termios.error):
            if not termios.tcgetattr(self._bash.child_fd)[3] & termios.ICANON:
                return True  # an editor of lines, or of the whole screen
            group = os.tcgetpgrp(self._bash.child_fd)
            return any(_reads_terminal(task) for pid in _members(group) for task in _tasks(pid))
        return False

    def _interrupt_program(self) -> bool:
        """Send SIGINT to the program that has the terminal; False if bash itself is what runs.

        As the terminal's Ctrl-C it would come to bash if the program ended just then, and bash, already at the next
        line, would lose the letter that it has read.
        """
        deadline = time.monotonic() + GIVING_TIME
        with contextlib.suppress(OSError):
            bash = _child(self._bash.pid)
            while self.is_busy and not isinstance(self._state, Unfinished) and time.monotonic() < deadline:
                group = os.tcgetpgrp(self._bash.child_fd)
                with contextlib.suppress(ProcessLookupError):  # it has just ended
                    if group != bash:
                        os.killpg(group, signal.SIGINT)
                        return True
                time.sleep(0.005)
        return not self.is_busy

    def _wait_until_ready(self, patience: float) -> bool:
        with self._changed:
            return self._changed.wait_for(lambda: isinstance(self._state, Done) or not self.is_open, patience)

    def _check_ready(self, lines: Sequence[str]) -> None:
        if not self.is_open:
            raise TerminalError(f"Terminal {self.name} is closed.")
        if self.is_busy:
            raise TerminalError(
                f"Terminal {self.name} is busy with a command; end it with terminal({self.name!r}).interrupt(), "
                "or use another terminal."
            )
        for number, line in enumerate(lines, 1):
            if len(line.encode()) > LONGEST_LINE:
                raise TerminalError(f"Line {number} has more than {LONGEST_LINE} bytes; put it into a file.")

    def _check_ended(self, was_last: bool) -> None:
        self._bash.wait()
        killer = self._bash.signalstatus
        code = self._bash.exitstatus if killer is None else 128 + killer
        if code or not was_last:
            raise TerminalError(
                f"The shell of terminal {self.name} has ended (exit code {code})"
                + ("" if was_last else ", and the lines after that were not typed")
                + "; the next cell gets a new one."
            )

    def _new_text(self) -> str:
        """Return what was shown since this was asked last."""
        with self._changed:
            new = self._since(self._position)
            self._position = self._end
        return new

    def _since(self, position: int) -> str:
        text = "".join(self._texts)
        return text[max(0, len(text) - (self._end - position)) :]

    def _read(self) -> None:
        while True:
            try:
                data = os.read(self._bash.child_fd, 65536)
            except OSError:
                data = b""
            with self._changed:
                for event in self._stream.feed(data):
                    if isinstance(event, str):
                        self._keep(event)
                        continue
                    self._state = event
                    if isinstance(event, Done):
                        self.last_code, self.folder = event.code, event.folder
                self.is_open = bool(data)
                self._changed.notify_all()
            if not data:
                return

    def _keep(self, text: str) -> None:
        self._texts.append(text)
        self._length += len(text)
        self._end += len(text)
        while self._length - len(self._texts[0]) >= KEPT_OUTPUT:
            self._length -= len(self._texts.popleft())

    def __repr__(self) -> str:
        if not self.is_open:
            return f"Terminal({self.name}, ended)"
        return f"Terminal({self.name}, {'busy' if self.is_busy else 'ready'} in {self.folder})"


def _environment(home: Path) -> dict[str, str]:
    return {
        **environment.terminal_environment(home),
        "TERM": "xterm-256color",
        # A pager would wait for a key.
        "PAGER": "cat",
        "GIT_PAGER": "cat",
        # Tracebacks and helps look the same on every Python: 3.13 and later would colour them.
        "PYTHON_COLORS": "0",
        # colcon: its status line and the window's title are for eyes, not for a page.
        "COLCON_EXTENSION_BLOCKLIST": "colcon_core.event_handler.status:colcon_core.event_handler.terminal_title",
    }


def _failure(command: str, code: int, not_typed: int) -> TerminalError:
    meaning = _MEANINGS.get(code, "")
    if not meaning and 128 < code <= 128 + 64:
        with contextlib.suppress(ValueError):
            meaning = f"{signal.Signals(code - 128).name} ended it"
    left = f" {not_typed} more line{'s' * (not_typed > 1)} of the cell not typed." if not_typed else ""
    return TerminalError(
        f"`{_brief(command)}` failed with exit code {code}{f': {meaning}' if meaning else ''}.".replace(
            "?.", "?"
        )
        + left
    )


def _brief(command: str) -> str:
    first = command.partition("\n")[0].strip()
    return first if len(first) <= 60 and first == command.strip() else f"{first[:60]} …"


def _last(text: str) -> str:
    return " ".join(text.split())[-200:] or "none"


def _child(pid: int) -> int:
    """Return the first child of a process; 0 if it has none."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii").split()
    return int(children[0]) if children else 0


def _members(group: int) -> list[int]:
    """Return the processes of a process group."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if os.getpgid(int(folder.name)) == group:
                found.append(int(folder.name))
    return found


def _tasks(pid: int) -> list[Path]:
    """Return a process's threads, as folders of /proc."""
    with contextlib.suppress(OSError):
        return list(Path(f"/proc/{pid}/task").iterdir())
    return []


def _reads_terminal(task: Path) -> bool:
    """Return whether a thread is in the middle of reading from a terminal."""
    with contextlib.suppress(OSError, ValueError):
        call, descriptor, *_ = (task / "syscall").read_text().split()
        file = (task / "fd" / str(int(descriptor, 16))).readlink()
        # Where /dev/pts is mounted anew, as in a container, the program's end of a terminal is there, too: ptmx.
        return call == _READ_CALL and file.parent == Path("/dev/pts") and file.name != "ptmx"
    return False
