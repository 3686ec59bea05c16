"""Turn a submission into `Evidence`: receive it, read it, build it, watch it, and run its own tests."""

from __future__ import annotations

import importlib.metadata
import platform
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from ros2lab import __version__, assignments
from ros2lab.assignments import Assignment
from ros2lab.grading.building.build import build
from ros2lab.grading.building.own_tests import OwnTests
from ros2lab.grading.evidence import GIVEN, SCHEMA, Evidence, Files, Run
from ros2lab.grading.judging import readme
from ros2lab.grading.judging.player import is_for_want
from ros2lab.grading.reading import boxed
from ros2lab.grading.receiving.clean_copy import SubmissionError
from ros2lab.grading.receiving.notes import Note
from ros2lab.grading.receiving.submission import Submission, copied
from ros2lab.grading.sandbox import open_world
from ros2lab.grading.sandbox.open_world import OpenWorld
from ros2lab.grading.sandbox.worlds import World
from ros2lab.grading.watching.observe import QUEUE, SHOWN, Observer
from ros2lab.grading.watching.rounds import Show, watch
from ros2lab.scratch import scratch_folder


def collect(
    path: Path,
    show: Show = lambda _step: None,
    keep: Path | None = None,
    *,
    assignment: Assignment | None = None,
    has_sandbox: bool = True,
    is_alone: bool = True,
) -> Evidence:
    """Collect all evidence on a submission.

    Args:
        path: the submission: a folder, a zip or a tar.
        show: called with a word for each step.
        keep: a folder in which a copy of what was received stays; it is made if it does not exist.
        assignment: the submission's assignment; None takes the course's own.
        has_sandbox: False lets the submission do whatever the grading user can.
        is_alone: whether no other submission is graded at the same time on this machine.

    Returns:
        The evidence, even if there is nothing to grade.

    Raises:
        SubmissionError: if the submission cannot be received.
        SandboxMissing: if this machine cannot run it safely.
        RuntimeError: if colcon or ROS cannot be used.
    """
    assignment = assignment or assignments.load()
    seconds: dict[str, float] = {}
    start = time.monotonic()
    with _folder(keep) as root:
        with _timed(seconds, "unpack"):
            show("unpacking")
            received = copied(path, root)
        with _world(root, has_sandbox=has_sandbox) as world:
            with _timed(seconds, "unpack"):
                show("reading")
                found = boxed.read(world, received, assignment)
            submission, facts = found.submission, found.files
            built, runs, tests, coined = None, list[Run](), dict[str, Any](), list[str]()
            if submission.form != "nothing":
                # The observer starts in the background.
                told = repr((facts.readme, facts.sources, facts.ends, facts.compared))
                asked = assignment.with_own_words([*facts.depended_on, *facts.compared]).with_coined_words(
                    told, facts.compared
                )
                coined = _coined(asked, assignment)
                with Observer(world, asked, queue=1 if is_alone else QUEUE) as observer:
                    with _timed(seconds, "build"):
                        show("building")
                        built = build(world, submission, found.plan)
                    with _timed(seconds, "observe"):
                        show("watching")
                        runs = watch(observer, submission, facts, built, show)
                        if facts.tests and submission.package:
                            show("running its tests")
                            own = OwnTests(root, submission.package.folder, facts.tests, facts.idle)
                            tests = own.run(world, built)
        if built:
            commands = readme.commands(facts.readme, submission, built, runs, facts)
            ends = [text for run in runs if run.setting != GIVEN for text in run.ended.values()]
            said = [built.error, *ends]
            texts = [text for text in dict.fromkeys(said) if text and not is_for_want(text)]
            if texts:
                with _world(root, has_sandbox=has_sandbox) as untouched:  # by the programs that ran
                    findings, meant = boxed.explained(untouched, found, assignment, texts)
                facts = replace(facts, findings=findings, ends_meant=meant)
            wrong = readme.misgiven(commands, runs, facts)
            facts = replace(facts, readme_commands=commands, readme_misgiven=wrong)
    seconds["total"] = time.monotonic() - start
    return Evidence(
        schema=SCHEMA,
        assignment=assignment.name,
        name=path.absolute().name,
        submission=submission,
        files=facts,
        build=built,
        runs=runs,
        tests=tests,
        seconds={name: round(value, 2) for name, value in seconds.items()},
        sandbox=_bubblewrap_version() if has_sandbox else open_world.NAME,
        versions=_versions(),
        coined=coined,
    )


def _coined(asked: Assignment, assignment: Assignment) -> list[str]:
    """Return the unknown commands that are sent besides the assignment's own."""
    own = assignment.commanded
    return (
        [word for word in asked.commanded.unknown if own and word not in own.unknown]
        if asked.commanded
        else []
    )


def nothing(path: Path, note: str, assignment: Assignment | None = None) -> Evidence:
    """Return the evidence on a submission that could not be received.

    Args:
        path: the submission.
        note: why it could not be received.
        assignment: the submission's assignment; None takes the course's own.
    """
    return Evidence(
        schema=SCHEMA,
        assignment=(assignment or assignments.load()).name,
        name=path.absolute().name,
        submission=Submission("nothing", None, [], None, [], [Note("refused", detail=note)]),
        files=Files(),
        build=None,
        runs=[],
        tests={},
        seconds={},
        sandbox="",
        versions=_versions(),
    )


@contextmanager
def _folder(keep: Path | None) -> Iterator[Path]:
    if keep is not None:
        keep.mkdir(parents=True, exist_ok=True)
        yield keep
        return
    with scratch_folder() as scratch:
        yield scratch


def _world(root: Path, *, has_sandbox: bool) -> World:
    make = World if has_sandbox else OpenWorld
    try:
        return make(root, shown=SHOWN)
    except ValueError as error:
        raise SubmissionError(str(error)) from None


@contextmanager
def _timed(seconds: dict[str, float], name: str) -> Iterator[None]:
    start = time.monotonic()
    yield
    seconds[name] = seconds.get(name, 0.0) + time.monotonic() - start


def _bubblewrap_version() -> str:
    said = subprocess.run(["bwrap", "--version"], capture_output=True, text=True, check=False).stdout
    return said.strip() or "none"


def _versions() -> dict[str, str]:
    found = {"ros2lab": __version__, "python": platform.python_version()}
    for name in ("colcon-core", "ros-rclpy"):
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:  # as with an installed ROS
            continue
    return found
