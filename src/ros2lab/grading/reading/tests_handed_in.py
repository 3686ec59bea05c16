"""The tests that a package has of its own."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from ros2lab.diagnose.sources.interfaces import PACKAGES, is_installed
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.grading.reading.graded_package import Package
from ros2lab.grading.reading.unread import legible

_STYLE_CHECKERS = re.compile(r"\bament_(?:copyright|flake8|pep257|xmllint|mypy)\b")


def test_files(package: Package) -> list[Path]:
    """Return the Python files of a package that are called as tests are."""
    paths = (path for path in sorted(package.folder.rglob("*.py")) if path.is_file())
    return [path for path in paths if re.fullmatch(r"test_.*|.*_test|tests?", path.stem)]


def tests_of(package: Package) -> tuple[dict[str, int], dict[str, str]]:
    """Count the test functions in each test file, except those that `ros2 pkg create` writes.

    Returns:
        The counts by file; and by file, notes on those that import ROS packages that are not installed here.
    """
    found: dict[str, int] = {}
    left_out: dict[str, str] = {}
    for source in legible(package.read(path, path.stem) for path in test_files(package)):
        if _STYLE_CHECKERS.search(source.text):
            continue
        functions = (
            node for node in source.nodes if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
        )
        count = sum(node.name.startswith("test") for node in functions)
        tops = {imported.target.partition(".")[0] for imported in source.imports}
        absent = sorted(top for top in tops & PACKAGES if not is_installed(top))
        if count and absent and not _is_about(source, package):
            continue  # it cannot be run, and need not be about this package
        if count and absent:
            left_out[source.shown] = (
                f"{source.shown} was not run: {', '.join(absent)} cannot be imported here."
            )
        elif count:
            found[source.shown] = count
    return found, left_out


def _is_about(source: PythonSource, package: Package) -> bool:
    """Return whether a test imports something of a package, or names it in a text."""
    points = (package.setup.entry_points if package.setup else None) or ()
    stems = {name.rpartition(".")[2] for name in package.sources} - {"__init__"}
    names = {package.name, *(point.name for point in points), *stems}
    described = {node.value for node in source.nodes if isinstance(node, ast.Expr)}
    texts = [
        str(node.value)
        for node in source.nodes
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in described
    ]
    texts += [found.target for found in source.imports]
    return not names.isdisjoint(word for text in texts for word in re.findall(r"\w+", text))
