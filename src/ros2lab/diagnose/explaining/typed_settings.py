"""What a command, or a launch file by a substitution, sets for a program that cannot take it."""

from __future__ import annotations

import ast
import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_file import Launched, LaunchFile
from ros2lab.diagnose.launching.misplaced_values import value_of
from ros2lab.diagnose.launching.parameter_names import given_in_vain
from ros2lab.diagnose.launching.remapped_names import unknown_names
from ros2lab.diagnose.launching.started_faults import started_in
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.printed.transcript import words_in


def with_settings(typed: Sequence[Finding], error: ErrorText, look: Look) -> list[Finding]:
    """Return what is wrong with the commands of a text, with what they set in vain: that first of which a later one uses the new name."""
    used, others = list[Finding](), list[Finding]()
    for number, step in enumerate(error.steps if look else ()):
        after = " ".join(later.command for later in error.steps[number + 1 :])
        for node in _run(words_in(step.command.rstrip("& "))):
            is_used = any(str(new) in after for _, new in node.remappings)
            (used if is_used else others).extend(_of(node, look))
    return [*used, *typed, *others]


def _of(node: Launched, look: Look) -> Iterator[Finding]:
    """Yield what a program is given by a command, and cannot take."""
    file = LaunchFile("", (node,), is_typed=True)
    for finding in (
        *unknown_names(file, started_in(file, look.with_sources)),
        *given_in_vain(file, look.with_sources),
    ):
        yield replace(finding, code="typed-wrong", place="")


def _run(words: Sequence[str]) -> Iterator[Launched]:
    """Yield the program that a command runs with settings, as a launch file would start it."""
    match words:
        case ["ros2", "run", package, program, *rest] if "--ros-args" in rest:
            pairs = [*pairwise(rest)]
            rules = [v.split(":=", 1) for o, v in pairs if o in ("-r", "--remap") and ":=" in v]
            given = {old: new for old, new in rules if old.startswith("__")}
            moved = tuple((old, new) for old, new in rules if not old.startswith("__"))
            set_ = [v.split(":=", 1) for o, v in pairs if o in ("-p", "--param") and ":=" in v]
            values = {name: value_of(value) for name, value in set_ if ":" not in name}
            name, space = given.get("__node") or given.get("__name"), given.get("__ns", "")
            yield Launched(package, program, name, (), moved, "", space, given=(values,))


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
