"""Ask git what it knows of a folder; nothing is imported for it that a grading does not need."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

PATIENCE = 30.0  # s; what is asked of a repository takes a few ms


def git(folder: Path, *words: str) -> str:
    """Return what a git command that only reads prints; nothing if it fails or does not end, or there is no git."""
    if shutil.which("git") is None:
        return ""
    environ = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *words],
            # A repository may say that what it lacks is to be fetched, and by which program.
            env={**environ, "GIT_OPTIONAL_LOCKS": "0", "GIT_ALLOW_PROTOCOL": "none"},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=PATIENCE,
            check=False,
        )
    except subprocess.TimeoutExpired:  # its settings may lie in a pipe into which nobody writes
        return ""
    return done.stdout if done.returncode == 0 else ""
