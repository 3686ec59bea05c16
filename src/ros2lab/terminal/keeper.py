"""Start a program on this terminal, and end it with all that came from it when the terminal closes.

A notebook's kernel holds the other end of the terminal. When the kernel ends, however it does (SIGKILL
included), Linux closes that end and sends SIGHUP here. Whatever a shell starts becomes a child of this process
once its own parent has gone (a "subreaper"), so that nohup, setsid and daemons do not escape.

Only the standard library, and few modules of it: a new terminal should be there at once.
"""

import ctypes
import os
import signal
import sys

PR_SET_CHILD_SUBREAPER = 36  # linux/prctl.h


def main() -> None:
    """Run `argv[1:]` and leave with its exit code."""
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    for number in (signal.SIGHUP, signal.SIGTERM):
        signal.signal(number, lambda *_: _end_everything())
    for number in (signal.SIGINT, signal.SIGQUIT, signal.SIGTSTP):
        signal.signal(number, signal.SIG_IGN)  # they are for the program, which has its own process group
    program = os.fork()
    if program == 0:
        for number in (signal.SIGINT, signal.SIGQUIT, signal.SIGTSTP, signal.SIGHUP, signal.SIGTERM):
            signal.signal(number, signal.SIG_DFL)
        os.execvp(sys.argv[1], sys.argv[1:])  # noqa: S606
    while True:
        pid, status = os.wait()
        if pid == program:
            _kill_descendants()
            os._exit(os.waitstatus_to_exitcode(status) & 0xFF)


def _end_everything() -> None:
    _kill_descendants()
    os._exit(128 + signal.SIGHUP)


def _kill_descendants() -> None:
    """Kill what came from here until nothing is left; what is orphaned meanwhile comes here."""
    while children := _children():
        for pid in children:
            os.kill(pid, signal.SIGKILL)  # a dead one is there until it is waited for, so this finds it
        for pid in children:
            os.waitpid(pid, 0)


def _children() -> list[int]:
    with open(f"/proc/self/task/{os.getpid()}/children", encoding="ascii") as file:  # noqa: PTH123
        return [int(pid) for pid in file.read().split()]


if __name__ == "__main__":
    main()
