"""Which line had already shut rclpy down when another one did it again."""

from __future__ import annotations

import ast

from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.spots import Spot

_ENDS = ("rclpy.shutdown", "rclpy.try_shutdown")


def shut_by(spot: Spot, error: ErrorText) -> str:
    """Say which other line of the file shuts rclpy down; empty after Ctrl-C, or unless there is just one."""
    calls = [n for n in (spot.file.nodes) if isinstance(n, ast.Call)]
    lines = {n.lineno for n in calls if ast.unparse(n.func) in _ENDS} - {spot.line}
    if len(lines) != 1 or any("^C" in step.text for step in error.steps):
        return ""
    (line,) = lines
    function = Spot(spot.source, line).function
    where = f" (in {function.name}())" if function and function is not spot.function else ""
    return f"Line {line}{where} has already shut rclpy down, and this line does it again; this is harmless."
