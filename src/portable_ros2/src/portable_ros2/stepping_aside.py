"""Whether a real `ros2` and a real `launch` are there: then these are used, and never ours in their place.

The command: the first other program named `ros2` on PATH.
The libraries: ours stand in a folder of their own, which an installation as a link puts at the very end of
the path on which Python looks for modules, so whatever other `launch` there is comes first.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from collections.abc import Mapping
from pathlib import Path

_HERE = Path(__file__).resolve().parent


def real_command(
    environ: Mapping[str, str] = os.environ, ours: str | Path = sys.argv[0] or "ros2"
) -> Path | None:
    """Return the first program named `ros2` on PATH that is not ours, None if there is none.

    Args:
        environ: where PATH is read.
        ours: the program that runs now.
    """
    own_folders = {Path(ours).resolve().parent, Path(sys.prefix, "bin").resolve()}
    for part in environ.get("PATH", "").split(os.pathsep):
        path = Path(part or ".", "ros2")
        if path.parent.resolve() not in own_folders and path.is_file() and os.access(path, os.X_OK):
            return path
    return None


def has_real_launch(name: str = "launch") -> bool:
    """Tell whether `import launch` (or another name) takes a module that is not ours."""
    spec = importlib.util.find_spec(name)
    return (
        spec is not None
        and spec.origin is not None
        and _HERE.parent not in Path(spec.origin).resolve().parents
    )
