"""Start a program, and end it with all that came from it.

Whatever a program starts becomes a child of this process once its own parent has gone (a "subreaper"), so that nohup,
setsid and daemons do not escape. All of it ends with the program, and at SIGHUP: a terminal's, whose other end is
closed when a notebook's kernel ends, however it does (SIGKILL included), or that of a parent that has ended.
SIGINT and SIGTERM are the program's, which has a process group of its own.

Only the standard library, and few modules of it: a new terminal should be there at once.
"""

import contextlib
import ctypes
import os
import resource
import signal
import sys

PR_SET_CHILD_SUBREAPER = 36  # linux/prctl.h
ENDING, PASSED_ON, IGNORED = signal.SIGHUP, (signal.SIGINT, signal.SIGTERM), (signal.SIGQUIT, signal.SIGTSTP)
OF_PYTHON = (signal.SIGPIPE, signal.SIGXFSZ)  # which Python ignores, and would have ignored
NOT_FOUND = 127  # as a shell has it


def main() -> None:
    """Run `argv[1:]` and end as it does.

    Signals are waited for and have no handlers: SIGHUP comes once for each thread of a parent that is killed, and a
    handler would be interrupted by the next.
    """
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    awaited = (ENDING, *PASSED_ON, signal.SIGCHLD)
    signal.pthread_sigmask(signal.SIG_BLOCK, (*awaited, *IGNORED))
    program = os.fork()
    if program == 0:
        _become_the_program((*awaited, *IGNORED, *OF_PYTHON))
    _take_apart(program)
    while True:
        number = signal.sigwaitinfo(awaited).si_signo
        if number == ENDING:
            _kill_descendants()
            _end_as(-signal.SIGKILL)
        elif number == signal.SIGCHLD:
            _end_with(program)
        else:
            _pass_on(number, program)


def _become_the_program(signals: tuple[int, ...]) -> None:
    _take_apart(0)
    for number in signals:
        signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, signals)
    try:
        os.execvp(sys.argv[1], sys.argv[1:])  # noqa: S606
    except OSError as error:
        sys.stderr.write(f"{sys.argv[1]} cannot be started: {error.strerror}\n")
        sys.stderr.flush()
        os._exit(NOT_FOUND)


def _take_apart(program: int) -> None:
    """Give the program a process group; on a terminal that is the shell's to do. Whoever of the two is first does it."""
    if not os.isatty(0):
        with contextlib.suppress(OSError):
            os.setpgid(program, program)


def _pass_on(number: int, program: int) -> None:
    with contextlib.suppress(OSError):
        os.killpg(program, number)


def _end_with(program: int) -> None:
    """Wait for the children that have ended; end if the program is among them."""
    with contextlib.suppress(ChildProcessError):
        while (ended := os.waitpid(-1, os.WNOHANG))[0] != 0:
            if ended[0] == program:
                _kill_descendants()
                _end_as(os.waitstatus_to_exitcode(ended[1]))


def _end_as(code: int) -> None:
    """End with an exit code, or by the signal that is its negative."""
    if code < 0:
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if -code not in (signal.SIGKILL, signal.SIGSTOP):
            signal.signal(-code, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, (-code,))
        os.kill(os.getpid(), -code)
    os._exit(code & 0xFF)


def _kill_descendants() -> None:
    """Kill what came from here until nothing is left; what is orphaned meanwhile comes here."""
    others: set[int] = set()  # somebody else's by now, as by sudo
    while True:
        children = [pid for pid in _children() if pid not in others]
        for pid in children:
            try:
                os.kill(pid, signal.SIGKILL)  # a dead one is there until it is waited for, so this finds it
            except PermissionError:
                others.add(pid)
            else:
                os.waitpid(pid, 0)
        if not children and (others or not _has_children()):
            return


def _children() -> list[int]:
    """Return the children's numbers; while some end, others may be missing (proc_pid_children(5))."""
    file = os.open(f"/proc/self/task/{os.getpid()}/children", os.O_RDONLY)
    try:
        numbers = b""
        while part := os.read(file, 65536):
            numbers += part
    finally:
        os.close(file)
    return [int(pid) for pid in numbers.split()]


def _has_children() -> bool:
    try:
        os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:
        return False
    return True


if __name__ == "__main__":
    main()
