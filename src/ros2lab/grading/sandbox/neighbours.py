"""Show a program the other programs of its run in its list of processes, as a student's machine would.

Each program has processes of its own, so that it cannot reach those of another. It is shown processes instead
that have the others' commands and only wait: those of programs that were started before it are there when it
starts, the rest once it is told to show them.
"""

from __future__ import annotations

import marshal
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ros2lab.grading.sandbox.keeper import FOLDER_OF_WAITING

Command = Sequence[str | Path]

_VARIABLE = "NEIGHBOURS"
# Becomes the program once the processes of those before it are there. Another process waits for the end of
# its standard input and shows the rest; none is a child of the program. The commands come in the environment,
# which nobody can read.
_STARTER = f"""
import _signal, marshal, os, sys
own, before, after = marshal.loads(bytes.fromhex(os.environ.pop("{_VARIABLE}")))
def show(commands):
    environ = {{"PYTHONPATH": "{FOLDER_OF_WAITING}", "PYTHONHOME": sys.base_prefix}}
    running, nobody = os.pipe()  # closed when a process becomes what it is to be
    for words in commands:
        if not os.fork():
            os.execve(sys.executable, words, environ)
    os.close(nobody)
    os.read(running, 1)
nothing = os.open(os.devnull, os.O_RDWR)
if not os.fork():
    _signal.signal(_signal.SIGINT, _signal.SIG_IGN)
    for number in (1, 2):
        os.dup2(nothing, number)
    show(before)
    if not os.fork():
        os.read(0, 1)
        show(after)
    os._exit(0)
os.wait()
os.dup2(nothing, 0)
os.environ.pop("LC_CTYPE", None)  # Python has set it
os.execv("/usr/bin/env", ["env", *own])
"""


@dataclass(frozen=True)
class Neighbours:
    """The commands of the other programs of a run.

    Attributes:
        before: the commands of those that were started before.
        after: the commands of the others.
    """

    before: Sequence[Command]
    after: Sequence[Command]

    def starting(self, command: Command) -> tuple[Command, dict[str, str]]:
        """Return the command that starts a program among them, and the environment variable that it needs."""
        lists = [
            [*map(str, command)],
            *([_shown(neighbour) for neighbour in some] for some in (self.before, self.after)),
        ]
        return [sys.executable, "-I", "-S", "-c", _STARTER], {_VARIABLE: marshal.dumps(lists).hex()}


def _shown(command: Command) -> list[str]:
    """Return the words of a command that Python starts with: it would refuse the options of another program."""
    program, *words = map(str, command)
    return [program, *(words if program == sys.executable else ())]
