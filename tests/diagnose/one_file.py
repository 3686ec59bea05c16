"""One Python file of a test: as a rule reads it, and what it prints."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import read_source


def sources_of(text: str, folder: Path, name: str = "node") -> NodeSources:
    """Write a file, which Python can read, and return it as rules take it."""
    ast.parse(text)
    path = folder / f"{name}.py"
    path.write_text(text, encoding="utf-8")
    return NodeSources({f"pk.{name}": read_source(path, f"pk.{name}", path.name)})


def printed_by(*words: str | Path, environ: Mapping[str, str] | None = None, typed: str = "") -> str:
    """Run Python, and return all that it prints.

    Args:
        words: after `python3`.
        environ: its variables; None takes those of the test.
        typed: what it finds at its keyboard.
    """
    # What is compiled is kept for files of a size and a second: a test mends one within that.
    return subprocess.run(
        [sys.executable, "-B", *words],
        env=environ,
        input=typed,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=60,
        check=False,
    ).stdout
