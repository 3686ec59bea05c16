"""Run a case as at home: in a bash, with its process group interrupted as a terminal does it."""

from __future__ import annotations

import contextlib
import os
import pty
import re
import signal
import subprocess
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import BinaryIO

from against_ros2cli_case import Case, Run

GRACE = 12.0  # s: the launch of a process that ignores SIGINT takes ten until SIGKILL
_FILE_BYTES = 20000
_POLL = 0.02  # s


def run(case: Case, folder: Path, environ: Mapping[str, str]) -> Run:
    """Run the command of a case in `folder`."""
    with contextlib.ExitStack() as stack:
        outputs: list[_Output] = []
        if case.is_terminal:
            leader, follower = pty.openpty()
            process = _start(case, folder, environ, follower, follower)
            os.close(follower)
            outputs.append(stack.enter_context(_Output(os.fdopen(leader, "rb", buffering=0))))
        else:
            process = _start(case, folder, environ, subprocess.PIPE, subprocess.PIPE)
            assert process.stdout is not None
            assert process.stderr is not None
            outputs += [stack.enter_context(_Output(stream)) for stream in (process.stdout, process.stderr)]
        try:
            ended, seconds = _wait(case, process, outputs)
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            code = process.wait()
    texts = [output.text for output in outputs] + [""] * (2 - len(outputs))
    return Run(texts[0], texts[1], _files(folder), code, round(seconds, 3), ended)


class _Output:
    """Collects what comes out of a stream in a thread of its own."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._parts: list[bytes] = []
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    @property
    def text(self) -> str:
        """What came so far."""
        return b"".join(self._parts).decode(errors="replace").replace("\r\n", "\n")

    def _read(self) -> None:
        with contextlib.suppress(OSError):  # a terminal whose other side has gone
            while part := os.read(self._stream.fileno(), 65536):
                self._parts.append(part)

    def __enter__(self) -> _Output:
        return self

    def __exit__(self, *_: object) -> None:
        self._thread.join(GRACE)
        self._stream.close()


def _start(
    case: Case, folder: Path, environ: Mapping[str, str], stdout: int, stderr: int
) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        ["bash", "-c", case.command],
        cwd=folder,
        env=environ,
        stdin=subprocess.DEVNULL,
        stdout=stdout,
        stderr=stderr,
        start_new_session=True,
    )


def _wait(case: Case, process: subprocess.Popen[bytes], outputs: list[_Output]) -> tuple[str, float]:
    """Wait for the end; return how it came, and the seconds until it or until the pattern was seen."""
    start = time.monotonic()
    while process.poll() is None:
        passed = time.monotonic() - start
        if case.until and any(re.search(case.until, output.text) for output in outputs):
            return _interrupt(process, "interrupted"), passed
        if passed > case.seconds:
            return _interrupt(process, "late"), passed
        time.sleep(_POLL)
    return "itself", time.monotonic() - start


def _interrupt(process: subprocess.Popen[bytes], ended: str) -> str:
    """Press Ctrl-C, and see whether that is enough."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGINT)
    try:
        process.wait(GRACE)
    except subprocess.TimeoutExpired:
        return "killed"
    return ended


def _files(folder: Path) -> str:
    """Return the names, the modes and the text of the files that a command has left."""
    parts = []
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder)
        if path.is_dir():
            parts.append(f"{name}/")
        else:
            text = path.read_bytes()[:_FILE_BYTES].decode(errors="replace")
            parts.append(f"{name} {path.stat().st_mode:o}\n{text}")
    return "\n".join(parts)
