"""Commands whose modules are imported once: each is a process of its own, forked from one that has imported them.

To start Python and to import what a command needs takes nine tenths of its time. All else is as in a process that is
started: its arguments, folder, environment, streams, exit code and end. A test that asks how a command starts, or that
talks to it while it runs, starts it itself.
"""

from __future__ import annotations

import gc
import importlib
import json
import os
import pkgutil
import select
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

# What Python, its libraries and ROS read when they are loaded: where one of these differs, a process is started.
READ_AT_START = ("PYTHON", "LD_", "LC_", "LANG", "RMW_", "ROS_PYTHON_", "_ROS_WHEELS_")
LARGEST_REQUEST = 1 << 20  # bytes


class WarmCommand:
    """A command of the project that is run many times.

    Args:
        command: the words that start it.
        entry: what it calls, as `module:function`.
        packages: whose modules are imported before, with all that are below them.
    """

    def __init__(self, command: Sequence[str], entry: str, *packages: str) -> None:
        self._command = command
        self._served = [command[-1], entry, *packages]
        self._connection: socket.socket | None = None
        self._settings: dict[str, str] = {}

    def run(
        self, *words: str, cwd: Path, environ: Mapping[str, str], text: str, timeout: float
    ) -> subprocess.CompletedProcess[str]:
        """Run the command to its end, and return what `subprocess.run` does.

        Args:
            words: its arguments.
            cwd: its folder.
            environ: its environment.
            text: what it reads.
            timeout: in s; then it is killed.

        Raises:
            TimeoutError: if it did not end in time.
        """
        if self._connection is None:
            self._begin(environ)
        assert self._connection is not None
        if _read_at_start(environ) != self._settings:
            return subprocess.run(
                [*self._command, *words],
                cwd=cwd,
                env=environ,
                input=text,
                capture_output=True,
                text=True,
                timeout=timeout,
                check=False,
            )
        with (
            tempfile.TemporaryFile("w+") as given,
            tempfile.TemporaryFile() as out,
            tempfile.TemporaryFile() as err,
        ):
            given.write(text)
            given.seek(0)
            request = json.dumps([words, str(cwd), dict(environ)]).encode()
            self._connection.settimeout(timeout)
            socket.send_fds(self._connection, [request], [given.fileno(), out.fileno(), err.fileno()])
            try:
                code = int(self._connection.recv(64))
            except TimeoutError:
                self.close()  # which ends the command
                raise
            said = []
            for file in (out, err):
                file.seek(0)
                said.append(file.read().decode().replace("\r\n", "\n"))
        return subprocess.CompletedProcess([*self._command, *words], code, *said)

    def close(self) -> None:
        """End the process that is forked; a further run begins another one."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def _begin(self, environ: Mapping[str, str]) -> None:
        """Start the process that is forked; it is nobody's child, so that no test has left it behind."""
        self._settings = _read_at_start(environ)
        # Where Python is forked, it may have no other threads, such as those of numpy's OpenBLAS.
        own = {**environ, "OPENBLAS_NUM_THREADS": "1"}
        self._connection, its_end = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, LARGEST_REQUEST)
        with its_end:
            subprocess.run(
                [sys.executable, __file__, str(its_end.fileno()), *self._served],
                env=own,
                pass_fds=[its_end.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                check=True,
            )


def _read_at_start(environ: Mapping[str, str]) -> dict[str, str]:
    return {name: value for name, value in environ.items() if name.startswith(READ_AT_START)}


def _serve(connection: socket.socket, path: str) -> None:
    """Fork for each request; return in the command that is asked for."""
    while True:
        request, passed, _, _ = socket.recv_fds(connection, LARGEST_REQUEST, 3)
        if not request:
            os._exit(0)
        command = os.fork()
        if command == 0:
            connection.close()
            words, folder, environ = json.loads(request)
            for number, descriptor in enumerate(passed):
                os.dup2(descriptor, number)
            os.chdir(folder)
            os.environ.clear()
            os.environ.update(environ)
            sys.argv = [path, *words]
            return
        for descriptor in passed:
            os.close(descriptor)
        end = os.pidfd_open(command)
        if connection.fileno() in select.select([end, connection.fileno()], [], [])[0]:
            os.kill(command, signal.SIGKILL)  # who has asked has gone
        os.close(end)
        code = os.waitstatus_to_exitcode(os.waitpid(command, 0)[1])
        try:
            connection.send(str(code).encode())
        except BrokenPipeError:
            os._exit(0)


def _import_all(name: str) -> None:
    package = importlib.import_module(name)
    for module in pkgutil.walk_packages(getattr(package, "__path__", ()), f"{name}."):
        importlib.import_module(module.name)


def _main(number: str, path: str, entry: str, *packages: str) -> None:
    for package in packages:
        _import_all(package)
    module, _, function = entry.partition(":")
    main = getattr(importlib.import_module(module), function)
    gc.collect()
    gc.freeze()  # else the first collection in each process would copy all memory
    if os.fork():
        os._exit(0)
    _serve(socket.socket(fileno=int(number)), path)
    sys.exit(main())


if __name__ == "__main__":
    _main(*sys.argv[1:])
