"""How well a package is written, as far as it can be counted."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from ros2lab import assignments
from ros2lab.diagnose.sources.python_source import read_text
from ros2lab.grading.reading.package_facts import own_words
from ros2lab.handlers import Handlers
from ros2lab.table import Table
from ros2lab.workspace import Workspace

PACKAGE = assignments.load().package
LONGEST_LINE = 99  # characters, as ROS 2 has it

# The practices that are an exercise, by their names in the table.
READABLE = "can be read as Python"
SHORT = f"lines up to {LONGEST_LINE} characters"
DESCRIBED = "docstrings of modules and classes"
NAMED = "names as in PEP 8"
CAUGHT = "exceptions caught by name"
LOGGED = "logger and not print"
LICENSED = "a license, a description and a maintainer"


def practices(workspace: Workspace, package: str = PACKAGE) -> Table:
    """Measure a package's modules against what is agreed among those who write Python.

    Returns:
        A row for each practice: its name, how often it holds, and the first place where it does not.
    """
    rows = []
    for practice, places in places_of_practices(workspace, package).items():
        wrong = [place for place in places if place]
        rows.append((practice, f"{len(places) - len(wrong)} of {len(places)}", wrong[0] if wrong else ""))
    return Table(("practice", "holds for", "first place where not"), rows)


def places_of_practices(workspace: Workspace, package: str = PACKAGE) -> dict[str, list[str]]:
    """Return for each practice an entry a place where it could hold: "" if it does, else `file:line`."""
    found: dict[str, list[str]] = {}
    inner = workspace.path / "src" / package / package
    for file in sorted(inner.rglob("*.py")):
        name = file.relative_to(inner).as_posix()
        text = file.read_text(encoding="utf-8-sig", errors="replace")
        try:
            tree = ast.parse(text)
        except SyntaxError as error:
            found.setdefault(READABLE, []).append(f"{name}:{error.lineno}")
            continue
        for practice, holds, line in [*_measured(tree), *_measured_lines(text)]:
            found.setdefault(practice, []).append("" if holds else f"{name}:{line}")
    if found:
        found[LICENSED] = [*_unwritten(workspace.path / "src" / package / "package.xml")]
    return found


def _measured(tree: ast.Module) -> Iterator[tuple[str, bool, int]]:
    """Yield a practice, whether it holds, and the line, for every place where it could hold."""
    handlers = Handlers(ast.walk(tree))
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield NAMED, re.fullmatch(r"[a-z_][a-z0-9_]*", node.name) is not None, node.lineno
            yield "type hints", _is_annotated(node), node.lineno
        if isinstance(node, ast.ClassDef):
            yield (
                NAMED,
                re.fullmatch(r"_?[A-Z][A-Za-z0-9]*", node.name) is not None,
                node.lineno,
            )
        if isinstance(node, ast.ClassDef) or (isinstance(node, ast.Module) and node.body):
            yield DESCRIBED, ast.get_docstring(node) is not None, getattr(node, "lineno", 1)
        if isinstance(node, ast.ExceptHandler):
            yield CAUGHT, handlers.is_by_name(node), node.lineno
        if isinstance(node, ast.Call):
            is_print = isinstance(node.func, ast.Name) and node.func.id == "print"
            # One that says where it prints is not in the logger's place.
            if is_print and not any(keyword.arg == "file" for keyword in node.keywords):
                yield LOGGED, False, node.lineno
            elif getattr(node.func, "attr", "") in ("debug", "info", "warning", "warn", "error", "fatal"):
                yield LOGGED, True, node.lineno


def _measured_lines(text: str) -> Iterator[tuple[str, bool, int]]:
    for number, line in enumerate(text.splitlines(), 1):
        yield SHORT, len(line) <= LONGEST_LINE, number


def _unwritten(manifest: Path) -> Iterator[str]:
    """Yield of description, license and maintainer an entry each: "" if it is written, else where it is not."""
    if not manifest.is_file():
        yield f"{manifest.name} cannot be read"
        return
    for tag, is_written in own_words(read_text(manifest)).items():
        yield "" if is_written else f"{manifest.name}: <{tag}>"


def _is_annotated(function: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    given = [argument for argument in arguments if argument.arg not in ("self", "cls")]
    return function.returns is not None and all(argument.annotation is not None for argument in given)
