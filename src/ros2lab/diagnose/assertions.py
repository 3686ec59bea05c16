"""What pytest shows of an assertion that failed: two numbers that are nearly one, and a function that returns nothing."""

from __future__ import annotations

import ast
import contextlib
import math
import re

from ros2lab.diagnose.error_text import ErrorText
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.python_source import own_nodes
from ros2lab.diagnose.spots import spot_at
from ros2lab.diagnose.static_value import evaluate

_NEAR = 1e-6  # of 32-bit floats, and of what 64-bit ones add up to
# Of two long values pytest shows only in which element they differ.
_FAILED = re.compile(
    r"^E +(?:(?:AssertionError: )?assert (?P<left>.+?) == (?P<right>.+)|At index \d+ diff: (?P<one>.+?) != (?P<other>.+))$",
    re.MULTILINE,
)
# Behind the lines of code, or before them.
_PLACE = re.compile(r"^(\S+\.py):(\d+): (?:AssertionError|in )", re.MULTILINE)


def of_assertion(error: ErrorText, look: Look) -> Finding | None:
    """Say why two values are not equal; None if their assertion does not tell."""
    for match in _FAILED.finditer(error.text):
        places = _PLACE.findall(error.text[: match.end()])[-1:] or _PLACE.findall(error.text[match.end() :])
        file, line = places[0] if places else ("", "")
        place = _place(file, line, look)
        spot = spot_at(place, look)
        test = next((n.test for n in spot.nodes if isinstance(n, ast.Assert)), None)
        if not isinstance(test, ast.Compare):
            continue
        shown = [match["left"] or match["one"], match["right"] or match["other"]]
        left, right = map(_literal, shown)
        if left != right and _is_near(left, right):
            cause = f"{shown[0]} and {shown[1]} differ only as floats do, which are rounded: a Float32 has 7 digits, and sums have their last one wrong."
            texts = ast.unparse(test.left), ast.unparse(test.comparators[0])
            fix = f"write `assert {texts[0]} == pytest.approx({texts[1]})`, with `import pytest` at the top"
            return Finding("never-equal", cause, place, fix)
        if left is None and shown[0].startswith("None") and (found := _returns_nothing(test.left, look)):
            name, where = found
            cause = f"{name}() returns nothing, so what the test gets of it is None."
            return Finding("value-none", cause, where, f"write a return at the end of {name}()")
    return None


def _place(file: str, line: str, look: Look) -> str:
    """Return a place of a package's test, whose file is named from the package on."""
    for package in look.packages:
        if (package.folder / file).is_file():
            return f"{package.shown(file)}:{line}"
    return f"{file}:{line}"


def _is_near(left: object, right: object) -> bool:
    """Return whether two values are nearly equal numbers, or lists or dictionaries of such."""
    match left, right:
        case ((int() | float()), (int() | float())):
            return math.isclose(left, right, rel_tol=_NEAR)
        case [*left_items], [*right_items]:
            return len(left_items) == len(right_items) and all(map(_is_near, left_items, right_items))
        case dict(), dict():
            return left.keys() == right.keys() and all(_is_near(left[key], right[key]) for key in left)
    return left == right


def _literal(text: str) -> object:
    with contextlib.suppress(ValueError, SyntaxError):
        return evaluate(ast.parse(text, mode="eval").body, {}, {})
    return None


def _returns_nothing(tested: ast.expr, look: Look) -> tuple[str, str] | None:
    """Return a function of the workspace that a test calls and that has no return, with its place."""
    name = (
        getattr(tested.func, "attr", getattr(tested.func, "id", "")) if isinstance(tested, ast.Call) else ""
    )
    for package in look.packages:
        for source in package.sources.values():
            for node in source.nodes:
                if isinstance(node, ast.FunctionDef) and node.name == name:
                    given = [n for n in own_nodes(node) if isinstance(n, (ast.Return, ast.Yield))]
                    if not any(n.value for n in given):
                        return name, source.at(node)
    return None
