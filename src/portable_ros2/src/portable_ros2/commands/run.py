"""`ros2 run`."""

from __future__ import annotations

import argparse
import shlex
import signal
import subprocess
from types import FrameType

from portable_ros2 import ament_index, completion
from portable_ros2.verb import Verb


class RunCommand(Verb):
    """Run a package specific executable."""

    takes_bytes = True

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument(
            "--prefix",
            help="Command to put before the executable, in quotes if it has arguments "
            "(e.g. --prefix 'gdb -ex run --args')",
        )
        package = parser.add_argument("package_name", help="Name of the ROS package")
        package.completer = completion.packages  # type: ignore[attr-defined]
        executable = parser.add_argument("executable_name", help="Name of the executable")
        executable.completer = completion.executables  # type: ignore[attr-defined]
        parser.add_argument(
            "argv", nargs=argparse.REMAINDER, help="Pass arbitrary arguments to the executable"
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> int | str:
        try:
            paths = ament_index.executables(args.package_name)
        except ament_index.PackageNotFoundError:
            return f"Package '{args.package_name}' not found"
        found = [str(path) for path in paths if path.name == args.executable_name]
        if not found:
            return "No executable found"
        if len(found) > 1:
            return "\n- ".join(["Multiple executables found:", *found])
        try:
            prefix = shlex.split(args.prefix or "")
        except ValueError as error:
            return f"The prefix {args.prefix!r} is not a command: {error}"
        return _run([*prefix, found[0], *args.argv])


def _run(command: list[str]) -> int | str:
    """Run a command until it ends, and return its exit code; minus the number of the signal that ended it."""
    child: subprocess.Popen[bytes] | None = None
    early: list[int] = []

    def let_pass(number: int, _: FrameType | None) -> None:
        """Wait on: a terminal sends Ctrl-C to the child as well, which then decides."""

    def pass_on(number: int, _: FrameType | None) -> None:
        """Tell the child, which would be left behind by what ends only this process."""
        if child is None:
            early.append(number)
        else:
            child.send_signal(number)

    for number, handler in (
        (signal.SIGINT, let_pass),
        (signal.SIGTERM, pass_on),
        (signal.SIGHUP, pass_on),
    ):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, handler)
    try:
        child = subprocess.Popen(command)
    except OSError as error:
        return f"'{command[0]}' cannot be started: {error.strerror}: '{error.filename}'"
    for signal_number in early:
        child.send_signal(signal_number)
    code = child.wait()
    if code > 0:
        print(f"[ros2run]: Process exited with failure {code}")
    elif code < 0:
        print(f"[ros2run]: {signal.strsignal(-code)}")
    return code
