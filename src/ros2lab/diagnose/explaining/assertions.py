"""Explains failed tests: unequal values, a function that returns nothing, a node made before init."""

from __future__ import annotations

import ast
import contextlib
import math
import re
from pathlib import Path, PurePath
from xml.etree import ElementTree

from ros2lab.diagnose.code.result_faults import return_in_place
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText, Frame, own_frames
from ros2lab.diagnose.printed.spots import place_of, spot_at
from ros2lab.diagnose.sources.python_source import (
    PythonSource,
    last_name,
    read_text,
    returns_value,
)
from ros2lab.diagnose.sources.static_value import evaluate, expression

_MOST_OF_TESTS = 20_000  # characters of the test results
_NEAR = 1e-6  # relative; enough for 32-bit floats and for sums of 64-bit ones
# For two long values pytest shows only the element in which they differ.
_FAILED = re.compile(
    r"^E +(?:(?:AssertionError: )?assert (?P<left>.+?) == (?P<right>.+)|At index \d+ diff: (?P<one>.+?) != (?P<other>.+))$",
    re.MULTILINE,
)
# It comes after the lines of code, or before them.
_PLACE = re.compile(r"^(\S+\.py):(\d+): (?:AssertionError|in )", re.MULTILINE)


def results_of_tests(error: ErrorText, root: Path) -> str:
    """Return what pytest wrote about failed tests into the files that a text names; empty if nothing."""
    texts = []
    for name in re.findall(r"^(build/[\w-]+/pytest\.xml):", error.text, re.MULTILINE):
        with contextlib.suppress(OSError, ElementTree.ParseError):
            # expat itself stops where entities would become too much.
            for node in ElementTree.fromstring(read_text(root / name)).iter():  # noqa: S314
                if node.tag in ("error", "failure") and node.text:
                    texts.append(node.text)
    return "\n".join(texts)[-_MOST_OF_TESTS:]


def of_assertion(error: ErrorText, look: Look) -> Finding | None:
    """Say why two values are not equal; None if no assertion explains it."""
    for match in _FAILED.finditer(error.text):
        places = _PLACE.findall(error.text[: match.end()])[-1:] or _PLACE.findall(error.text[match.end() :])
        file, line = places[0] if places else ("", "")
        place = place_of([Frame(file, int(line or 0))], look)
        spot = spot_at(place, look)
        test = next((n.test for n in spot.nodes if isinstance(n, ast.Assert)), None)
        if not isinstance(test, ast.Compare):
            continue
        shown = [match["left"] or match["one"], match["right"] or match["other"]]
        left, right = map(_literal, shown)
        if left != right and _is_near(left, right):
            cause = f"{shown[0]} and {shown[1]} differ only by rounding: floats are binary, so most decimal fractions, and sums of them, are not exact."
            texts = ast.unparse(test.left), ast.unparse(test.comparators[0])
            fix = f"write `assert {texts[0]} == pytest.approx({texts[1]})`, with `import pytest` at the top"
            return Finding("never-equal", cause, place, fix)
        if left is None and shown[0].startswith("None") and (found := _returns_nothing(test.left, look)):
            source, function = found
            cause = f"{function.name}() returns nothing, so the test gets None from it."
            fix = return_in_place(function) or f"write a return at the end of {function.name}()"
            return Finding("value-none", cause, source.at(function), fix)
        if match["left"] and isinstance(test.left, ast.Call):
            cause = f"`{ast.unparse(test.left)}` returns {shown[0]}, but this test expects {shown[1]}."
            fix = (
                f"fix {ast.unparse(test.left.func)}() if {shown[1]} is right; otherwise write {shown[0]} here"
            )
            return Finding("test-failed", cause, place, fix)
    return None


def of_test_without_init(error: ErrorText, look: Look) -> Finding | None:
    """Say that a test makes a node before rclpy.init(); None for any other error."""
    report = error.report
    outer = own_frames(report.frames)[-1:] if report else []
    if report is None or "init" not in report.message or not outer or not is_test(outer[0].file):
        return None
    if report.kind != "NotInitializedException" and "rclpy.init" not in report.message:
        return None
    cause = "This test makes a node before rclpy.init() is called."
    fix = "write rclpy.init() above this line, and rclpy.shutdown() at the end of the test, with `import rclpy` at the top"
    return Finding("rclpy-init-missing", cause, place_of(outer, look), fix)


def is_test(file: str) -> bool:
    """Return whether pytest collects tests from a file of this name."""
    name = PurePath(file).name
    return name.startswith("test_") or name.endswith("_test.py")


def _is_near(left: object, right: object) -> bool:
    """Return whether two values are nearly equal: numbers, or lists or dictionaries of them."""
    match left, right:
        case ((int() | float()), (int() | float())):
            return math.isclose(left, right, rel_tol=_NEAR)
        case [*left_items], [*right_items]:
            return len(left_items) == len(right_items) and all(map(_is_near, left_items, right_items))
        case dict(), dict():
            return left.keys() == right.keys() and all(_is_near(left[key], right[key]) for key in left)
    return left == right


def _literal(text: str) -> object:
    written = expression(text)
    return evaluate(written, {}, {}) if written else None


def _returns_nothing(tested: ast.expr, look: Look) -> tuple[PythonSource, ast.FunctionDef] | None:
    """Return the function that a test calls, with its source, if it returns no value; else None."""
    name = last_name(tested.func) if isinstance(tested, ast.Call) else ""
    for package in look.packages:
        for source in package.sources.values():
            for node in source.nodes:
                if isinstance(node, ast.FunctionDef) and node.name == name and not returns_value(node):
                    return source, node
    return None
