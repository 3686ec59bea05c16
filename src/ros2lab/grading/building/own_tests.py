"""Run a submission's own tests as `colcon test` does, and again with its nodes broken on purpose.

Tests that pass whatever the nodes do test nothing. So two copies of the package are broken, each in its own
way: in one no function does anything, in the other every text and number is changed. Only the compiled code
is broken: the sources are the same in all copies, so a test that reads them notices nothing. Each copy has a
World of its own, at the package's own path, and is made from the received files, not from what its build has
left.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import socket
import sys
import time
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any

from ros2lab.grading.building import spoiler
from ros2lab.grading.evidence import Build
from ros2lab.grading.reading.build_plan import workspace_of
from ros2lab.grading.reading.graded_package import written_modules
from ros2lab.grading.sandbox.box import Limits
from ros2lab.grading.sandbox.worlds import FILES, World

LIMITS = Limits(wall_s=90, cpu_s=60, memory_bytes=1_500_000_000)
TESTING_TIMEOUT = 180.0  # s for all trials of a submission
PATIENCE = 10.0  # s more than the longest test before, for a test that waits in vain on a broken copy
SPOILING = Limits(wall_s=60, cpu_s=20, memory_bytes=1_000_000_000)
KINDS = ("passed", "failed", "skipped")
LONGEST_ANSWER = 10_000  # bytes

# Runs pytest, and writes its counts to the socket on standard input, with the indices of the files, the
# quickest first, and how many files there are up to the one with the first failure. It starts in Python's
# isolated mode, so that a pytest.py or a sitecustomize.py of the submission does not shadow the real one. A
# test that takes longer than the first argument, in s, ends it without an answer; 0 means no limit.
_RUNNER = """
import collections, json, os, signal, sys, time
answer = os.dup(0)
os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
import pytest
sys.path[:0] = filter(None, os.environ['PYTHONPATH'].split(':'))
class Counter:
    def __init__(self):
        self.counts = {'passed': 0, 'failed': 0, 'skipped': 0, 'longest': 0.0}
        self.files = collections.Counter()
        self.failed = set()
    def pytest_runtest_logstart(self):
        signal.setitimer(signal.ITIMER_REAL, float(sys.argv[1]))
        self.begin = time.monotonic()
    def pytest_runtest_logfinish(self, nodeid):
        seconds = time.monotonic() - self.begin
        self.counts['longest'] = max(self.counts['longest'], seconds)
        self.files[nodeid.partition('::')[0]] += seconds
    def pytest_runtest_logreport(self, report):
        if not hasattr(report, 'wasxfail') and (report.when == 'call' or not report.passed):
            self.count(report)
    def pytest_collectreport(self, report):
        if not report.passed:
            self.count(report)
    def count(self, report):
        self.counts[report.outcome] += 1
        if report.failed:
            self.failed.add(report.nodeid.partition('::')[0])
counter, files = Counter(), sys.argv[2:]
pytest.main(['-qx', '-p', 'no:cacheprovider', '--tb=no', '-c', os.devnull, '--rootdir=.', *files], [counter])
order = sorted(range(len(files)), key=lambda number: counter.files[files[number]])
failing = next((number for number, file in enumerate(files, 1) if file in counter.failed), len(files))
sys.stdout.flush()
os.write(answer, json.dumps({**counter.counts, 'order': order, 'failing': failing}).encode())
os._exit(0)
"""


class OwnTests:
    """The tests of a package.

    Args:
        root: the folder with the submission as received; nothing in it has run.
        folder: the package's folder below the root.
        files: the test files below the root.
        idle: by module, the first lines of code that no program uses: breaking it breaks no node.
    """

    def __init__(
        self, root: Path, folder: str, files: Iterable[str], idle: Mapping[str, Collection[int]] | None = None
    ) -> None:
        self._root = root
        self._until = math.inf
        self._folder = folder
        self._idle = idle or {}
        self._files = [str(PurePosixPath(path).relative_to(folder)) for path in files]

    def run(self, world: World, built: Build) -> dict[str, Any]:
        """Run the tests on the package and, if they pass, on the broken copies.

        The package itself also runs rewritten code that does the same as its own: a test that fails because
        of that compares what code looks like, not what it does.

        Args:
            world: the World in which the package was built; no box runs in it any more.
            built: the package's build.

        Returns:
            Counts: `passed`, `failed`, `skipped`; `error`: the first failure, or the last line of output if
                nothing
            could be counted. If all tests passed, also `is_noticed`: whether a test fails, or never ends, on
            a broken copy and then passes again on the whole one, so that it does not depend on timing; and
            `is_unfinished`: whether the time was too short for that. If no test could be run, `is_untried`.
        """
        self._until = time.monotonic() + TESTING_TIMEOUT
        try:
            trial = self._try(world, built, self._files, 0.0, spoiler.HARMLESS)
            result = trial.counts
            if result["passed"] and not result["failed"]:
                patience = trial.longest + PATIENCE

                broken = (self._try(world, built, trial.files, patience, kind) for kind in spoiler.SPOILERS)
                noticed = next(
                    (each for each in broken if each.has_failed or not each.counts["passed"]), None
                )
                # What ran before the failure is run again, too, but nothing after it.
                result["is_noticed"] = (
                    noticed is not None
                    and not self._try(
                        world, built, trial.files[: noticed.failing], patience, spoiler.HARMLESS
                    ).has_failed
                )
                result["is_unfinished"] = time.monotonic() > self._until
        except ValueError as reason:  # a build may leave anything behind
            return {**dict.fromkeys(KINDS, 0), "error": str(reason), "is_untried": True}
        return result

    def _try(self, world: World, built: Build, files: Sequence[str], patience: float, kind: str) -> _Trial:
        """Run the tests in a new World."""
        with world.beside() as copy:
            copy.fill(self._root)
            copy.fill(world.folder, only=workspace_of(self._root))
            modules = written_modules(self._root / self._folder)
            names = [str(path.relative_to(self._root)) for path in modules]
            _spoil(copy, {name: [*self._idle.get(name, ())] for name in names}, kind)
            left = max(0.0, self._until - time.monotonic())
            limits = replace(LIMITS, wall_s=min(left, LIMITS.wall_s))
            return _run(copy, f"{FILES}/{self._folder}", files, built.environ, patience, limits=limits)


@dataclass(frozen=True)
class _Trial:
    """The result of one run of the tests.

    Attributes:
        counts: as `OwnTests.run` returns them.
        longest: how long the longest test took, in s; 0 if the number cannot be true.
        files: the test files, the quickest first, so that those that wait in vain come last.
        failing: how many files were given up to the one with the first failure; all if that is not known.
    """

    counts: dict[str, Any]
    longest: float
    files: Sequence[str]
    failing: int

    @property
    def has_failed(self) -> bool:
        """Whether a test has failed, or nothing could be counted."""
        return bool(self.counts["failed"]) or not any(self.counts[kind] for kind in KINDS)


def _spoil(world: World, files: Mapping[str, Sequence[int]], kind: str) -> None:
    """Change the compiled modules of a package, in a World in which nothing has run."""
    given = os.memfd_create("modules")
    try:
        os.write(given, json.dumps({f"{FILES}/{file}": idle for file, idle in files.items()}).encode())
        os.lseek(given, 0, os.SEEK_SET)
        command = [sys.executable, "-I", "-S", "-B", spoiler.__file__, kind]
        shown = [Path(spoiler.__file__)]
        world.start(command, files="write", stdin=given, shown=shown, limits=SPOILING).wait()
    finally:
        os.close(given)


def _run(
    world: World,
    folder: str,
    files: Sequence[str],
    environ: Mapping[str, str],
    patience: float,
    *,
    limits: Limits,
) -> _Trial:
    """Run the tests in these files."""
    paths = [folder, f"{folder}/src", environ.get("PYTHONPATH", "")]
    ours, its = socket.socketpair()
    with ours:
        with its:
            box = world.start(
                [sys.executable, "-I", "-B", "-c", _RUNNER, str(patience), *files],
                environ={
                    **environ,
                    "PYTHONPATH": ":".join(filter(None, paths)),
                    "PYTHONDONTWRITEBYTECODE": "1",
                    "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",  # the lab's own plugins are slow to import
                },
                cwd=folder,
                stdin=its.fileno(),
                limits=limits,
            )
        box.wait()
        counts, longest, order, failing = dict.fromkeys(KINDS, 0), 0.0, list[int](), len(files)
        with contextlib.suppress(
            ValueError, TypeError, LookupError, ArithmeticError, RecursionError, OSError
        ):
            said = json.loads(ours.recv(LONGEST_ANSWER, socket.MSG_DONTWAIT))
            counts, longest = {kind: int(said[kind]) for kind in KINDS}, float(said["longest"])
            order = [*map(int, said["order"])]
            failing = int(said["failing"])
    lines = box.output.strip().splitlines() or ["it said nothing"]
    error = "" if any(counts.values()) else box.cut or lines[-1]
    if counts["failed"]:
        error = next((line for line in lines if line.startswith(("FAILED ", "ERROR "))), lines[-1])
    return _Trial(
        {**counts, "error": error[:300]},
        longest if 0 < longest < LIMITS.wall_s else 0.0,
        [files[number] for number in order] if sorted(order) == [*range(len(files))] else files,
        failing if 0 < failing <= len(files) else len(files),
    )
