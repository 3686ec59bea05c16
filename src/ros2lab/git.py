"""Ask git what it knows of a folder; nothing is imported for it that a grading does not need."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

PATIENCE = 30.0  # s; what is asked of a repository takes a few ms


def git(folder: Path, *words: str) -> str:
    """Return what a git command that only reads prints; nothing if it fails or does not end, or there is no git."""
    if shutil.which("git") is None or not folder.is_dir():
        return ""
    environ = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    # A repository may say that what it lacks is to be fetched, and by which program.
    environ |= {"GIT_OPTIONAL_LOCKS": "0", "GIT_ALLOW_PROTOCOL": "none"}
    try:
        done = ended(["git", *words], folder, environ, PATIENCE)
    except subprocess.TimeoutExpired:  # its settings may lie in a pipe into which nobody writes
        return ""
    return done.stdout if done.returncode == 0 else ""


def ended(
    command: Sequence[str], folder: Path, environ: Mapping[str, str], patience: float
) -> subprocess.CompletedProcess[str]:
    """Run a command of git to its end.

    Raises:
        subprocess.TimeoutExpired: if it takes more than `patience` s; what it has started has ended then, too.
    """
    with subprocess.Popen(
        command,
        cwd=folder,
        env=environ,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        start_new_session=True,
    ) as process:
        try:
            printed, said = process.communicate(timeout=patience)
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            raise
    return subprocess.CompletedProcess(command, process.returncode, printed, said)
