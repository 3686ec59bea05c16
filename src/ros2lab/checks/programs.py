"""How the checks run a student's programs to their end, and read what they leave."""

from __future__ import annotations

import contextlib
import os
import resource
import signal
import subprocess
import tempfile
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from ros2lab import course, environment
from ros2lab.checks import CheckError
from ros2lab.workspace import Workspace, WorkspaceError

RUN_TIMEOUT = 30.0  # s, for a program that prints a line and ends
LARGEST_OUTPUT = 10_000_000  # bytes, so that a loop that prints does not fill the disk


def run(
    command: Sequence[str | Path],
    name: str,
    *,
    folder: Path | None = None,
    environ: Mapping[str, str] | None = None,
) -> subprocess.CompletedProcess[str]:
    """Run a command to its end, and end what it leaves running.

    Args:
        command: its words.
        name: what it is called to the student.
        folder: where it runs; None is here.
        environ: its environment; None is that of a terminal of the lab.

    Raises:
        CheckError: if it cannot be started, or does not end within `RUN_TIMEOUT`.
    """
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        try:
            process = subprocess.Popen(
                command,
                cwd=folder,
                env=environment.lab_environment() if environ is None else environ,
                stdin=subprocess.DEVNULL,
                # Files, for a pipe would stay open for as long as a child that is left behind.
                stdout=output,
                stderr=errors,
                start_new_session=True,
            )
        except OSError as error:
            raise CheckError(
                f"{name} can be started", str(error.strerror), "was it built, and is it there?"
            ) from error
        try:
            with contextlib.suppress(ProcessLookupError):
                resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (LARGEST_OUTPUT, LARGEST_OUTPUT))
            process.wait(RUN_TIMEOUT)
        except subprocess.TimeoutExpired:
            raise CheckError(
                f"{name} ends", f"after {RUN_TIMEOUT:g} s it still runs", "which loop in it has no end?"
            ) from None
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        texts = []
        for file in (output, errors):
            file.seek(0)
            texts.append(file.read().decode(errors="replace"))
    return subprocess.CompletedProcess(command, process.returncode, *texts)


def overlay_of(workspace: Workspace) -> dict[str, str]:
    """Return the environment of a terminal that has sourced a workspace.

    Raises:
        CheckError: if it is not built, or cannot be sourced.
    """
    try:
        return workspace.overlay
    except WorkspaceError as error:
        shown = course.shown_path(workspace.path)
        raise CheckError(
            f"{shown} is built", str(error), f"type `cd {shown}`, then `colcon build`."
        ) from error


def count_tests(report: Path, *, except_of: Collection[str] = ()) -> Counter[str] | None:
    """Count the tests in a report of pytest: `passed`, `failed` and `skipped`.

    Args:
        report: the `pytest.xml` that `colcon test` leaves in `build/<package>`.
        except_of: the modules whose tests do not count.

    Returns:
        None if there is no report, or it cannot be read.
    """
    try:
        cases = list(ET.parse(report).iter("testcase"))  # noqa: S314 -- the student's own pytest wrote it
    except (OSError, ET.ParseError):
        return None
    return Counter(
        "failed"
        if case.find("failure") is not None or case.find("error") is not None
        else "passed"
        if case.find("skipped") is None
        else "skipped"
        for case in cases
        if case.get("classname", "").rpartition(".")[2] not in except_of
    )
