"""Run a submission's own tests, as `colcon test` does, and again with its nodes broken on purpose.

Tests that pass whatever the nodes do test nothing. So each of two copies of the package is broken in another way:
in one no function does anything, in the other every text and number is another one.
"""

from __future__ import annotations

import ast
import contextlib
import re
import shutil
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path, PurePosixPath
from typing import Any

from ros2lab.grading.evidence import Build
from ros2lab.grading.files import written_modules
from ros2lab.grading.sandbox import FILES, Limits, World

BROKEN = "broken"  # the folder of the broken copies, in the workspace that is built
LIMITS = Limits(wall_s=90, cpu_s=60, memory_bytes=1_500_000_000)
PATIENCE = 10.0  # s that tests may take longer on a broken copy, where they wait for what does not come
LARGEST = 1_000_000  # bytes of a module that is broken

_SUMMARY = re.compile(r"\d+ (?:passed|failed|skipped|errors?)\b.* in [\d.]+s")
_COUNT = re.compile(r"(\d+) (passed|failed|skipped|errors?)\b")
_ENTRANCES = ("main",)  # what only starts a node is not what tests are about


class OwnTests:
    """The tests of a package.

    Args:
        folder: of the package, below what was received.
        files: the tests, below what was received.
    """

    def __init__(self, folder: str, files: Iterable[str]) -> None:
        self._folder = folder
        self._files = [str(PurePosixPath(path).relative_to(folder)) for path in files]
        self._copies: list[str] = []

    def prepare(self, root: Path, workspace: str) -> None:
        """Put broken copies of the package into the workspace, before anything of it has run.

        Args:
            root: of a World in which no box has had its files.
            workspace: the folder below it in which the package is built.
        """
        broken = root / workspace / BROKEN
        broken.mkdir()
        (broken / "COLCON_IGNORE").touch()
        for name, spoil in _SPOILERS.items():
            shutil.copytree(
                root / self._folder,
                broken / name,
                symlinks=True,
                ignore=lambda folder, _: [workspace] if Path(folder) == root else [],
            )
            for path in written_modules(broken / name):
                if path.stat().st_size > LARGEST:
                    continue
                # What no parser can read stays as it is: it is broken enough.
                with contextlib.suppress(SyntaxError, ValueError, RecursionError, MemoryError):
                    path.write_text(ast.unparse(spoil(ast.parse(path.read_bytes()))), encoding="utf-8")
            self._copies.append(f"{FILES}/{workspace}/{BROKEN}/{name}")

    def run(self, world: World, built: Build) -> dict[str, Any]:
        """Run the tests on the package as it is and, if they pass, on the broken copies.

        Args:
            world: in which the copies were made, and the package was built.
            built: the package's build.

        Returns:
            Counts: `passed`, `failed`, `skipped`; `error`: the first failure, or what was said last if nothing could be counted;
            `is_noticed`: whether a test fails, or never ends, on a broken copy; only where all had passed before.
        """
        result, seconds = _run(world, f"{FILES}/{self._folder}", self._files, built.environ, LIMITS)
        if result["passed"] and not result["failed"]:
            limits = replace(LIMITS, wall_s=seconds + PATIENCE)
            trials = (_run(world, copy, self._files, built.environ, limits)[0] for copy in self._copies)
            result["is_noticed"] = any(not spoilt["passed"] or spoilt["failed"] for spoilt in trials)
        return result


def _run(
    world: World, folder: str, tests: Iterable[str], environ: Mapping[str, str], limits: Limits
) -> tuple[dict[str, Any], float]:
    """Run tests; return what they counted, and how long they took, in s."""
    paths = [folder, f"{folder}/src", environ.get("PYTHONPATH", "")]
    box = world.run(
        [sys.executable, "-m", "pytest", "-qx", "-p", "no:cacheprovider", "--tb=no", *tests],
        environ={
            **environ,
            "PYTHONPATH": ":".join(filter(None, paths)),
            "PYTHONDONTWRITEBYTECODE": "1",
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",  # the lab's own plugins are slow to import
        },
        cwd=folder,
        limits=limits,
    )
    lines = box.output.strip().splitlines() or ["it said nothing"]
    # What ends after pytest, such as a thread, may have the last word.
    summary = next(filter(_SUMMARY.search, reversed(lines)), lines[-1])
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    for number, kind in _COUNT.findall(summary):
        counts["failed" if kind.startswith("error") else kind] += int(number)
    error = "" if any(counts.values()) else box.cut or summary
    if counts["failed"]:
        error = next((line for line in lines if line.startswith(("FAILED ", "ERROR "))), summary)
    return {**counts, "error": error[:300]}, box.seconds


def _empty(tree: ast.Module) -> ast.Module:
    """Take away what the functions do, except the makers of objects and what starts a node."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            is_special = node.name.startswith("__") or node.name in _ENTRANCES
            is_generator = any(isinstance(inner, (ast.Yield, ast.YieldFrom)) for inner in ast.walk(node))
            if not is_special and not is_generator:
                node.body = [ast.Return(ast.Constant(None))]
    return ast.fix_missing_locations(tree)


class _Change(ast.NodeTransformer):
    """Change every text and number, except docstrings and what asks whether a file is run as a program."""

    def visit_Constant(self, node: ast.Constant) -> ast.Constant:
        value = node.value
        if isinstance(value, str) and value != "__main__":
            return ast.copy_location(ast.Constant(f"{value}x"), node)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return ast.copy_location(ast.Constant(value + 1), node)
        return node

    def visit_Expr(self, node: ast.Expr) -> ast.Expr:
        return node if isinstance(node.value, ast.Constant) else self.generic_visit(node)  # type: ignore[return-value]

    def visit_JoinedStr(self, node: ast.JoinedStr) -> ast.JoinedStr:
        return node


def _change(tree: ast.Module) -> ast.Module:
    _Change().visit(tree)
    return ast.fix_missing_locations(tree)


_SPOILERS: Mapping[str, Callable[[ast.Module], ast.Module]] = {"empty": _empty, "changed": _change}
