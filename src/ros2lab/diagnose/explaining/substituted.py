"""Parameters that a launch file sets by substitutions, whose type YAML tells by their value."""

from __future__ import annotations

import ast
import contextlib

from ros2lab.diagnose.printed.spots import Spot

_PYTHONS = {"STRING": str, "DOUBLE": float, "INTEGER": int}


def substituted(name: str, value: str, wanted: str, spot: Spot) -> str:
    """Say how to give a parameter another type where a line of a launch file sets it by substitutions; else empty."""
    kind = _PYTHONS.get(wanted)
    with contextlib.suppress(ValueError):
        kind = kind if kind and str(kind(value)) else None
        if kind and "<param" in spot.text and "$(" in spot.text:
            return f'write type="{kind.__name__}" in this <param>, too: without it, YAML tells the type by the value'
        for given in (node for node in spot.whole if isinstance(node, ast.Dict)):
            for key, made in zip(given.keys, given.values, strict=True):
                if kind and getattr(key, "value", "") == name and _is_substitution(made, spot):
                    new = f"{key and ast.unparse(key)}: ParameterValue({ast.unparse(made)}, value_type={kind.__name__})"
                    return f"write `{new}`, with `from launch_ros.parameter_descriptions import ParameterValue` at the top: without it, YAML tells the type by the value"
    return ""


def _is_substitution(made: ast.expr, spot: Spot) -> bool:
    """Return whether launch makes a value: a substitution, or a list with one."""
    kept = spot.file.written(made)
    parts = kept.elts if isinstance(kept, (ast.List, ast.Tuple)) else [kept]
    calls = [part.func for part in map(spot.file.written, parts) if isinstance(part, ast.Call)]
    names = [spot.file.resolve(called) or "" for called in calls]
    return any(name.startswith("launch") and not name.endswith(".ParameterValue") for name in names)
