"""The student's project of lesson 7: where it lies, and its nodes while a check runs them."""

from __future__ import annotations

import ast
import contextlib
import importlib.metadata
import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from ros2lab import course, diagnose, environment, hand_in
from ros2lab.assignments import Part
from ros2lab.assignments.lesson import load_lesson
from ros2lab.checks import CheckError
from ros2lab.checks.watched_program import (
    START_TIMEOUT,
    NotDrivenError,
    WatchedProgram,
    running,
)
from ros2lab.diagnose.printed.error_text import read_error
from ros2lab.hand_in import PACKAGE
from ros2lab.judge import case_of, lost
from ros2lab.observed_domain import ObservedDomain
from ros2lab.terminal import magic
from ros2lab.topics import TopicLog
from ros2lab.workspace import Workspace

PARTS = hand_in.ASSIGNMENT.parts
STATUS, COMMANDS, VELOCITY = PARTS.values()
LESSON = load_lesson()
TWIST, LOG = VELOCITY.type_name, "rcl_interfaces/msg/Log"
WORKSPACE = f"~/{LESSON.workspace}"
BACKGROUND = ("status", "commands", "velocity")  # the lesson's terminals, one for each node
TIMER_HINT = (
    "what calls the function that publishes? create_timer does so again and again, while the node is spun."
)


def judge_node(module: str, expect: Callable[[WatchedProgram], None], *parameters: str) -> None:
    """Judge a node on a simulated clock, and in real time if it does not follow that clock."""
    try:
        with running_node(module, *parameters, is_driven=True) as node:
            expect(node)
    except NotDrivenError:
        with running_node(module, *parameters) as node:
            expect(node)


def judge_part(part: Part, expect: Callable[[WatchedProgram], None]) -> None:
    """Judge the node of a part by what the lesson expects, and by what the grader says of what was then seen."""

    def expect_all(node: WatchedProgram) -> None:
        expect(node)
        expect_nothing_lost(node, part)

    judge_node(part.name, expect_all)


def expect_nothing_lost(node: WatchedProgram, part: Part) -> None:
    """Check that the grader has nothing to object to in what was seen of a part's node.

    A node that publishes may take the commands, too: that there is another one for them, only all nodes together tell.
    """
    run = node.record.run()
    if part.is_publisher:
        run = replace(run, subscribes={})
    for judgement in lost(case_of([run]), part.name):
        raise CheckError(judgement.title, judgement.reason.rstrip("."), judgement.hint)


@contextlib.contextmanager
def running_node(module: str, *parameters: str, is_driven: bool = False) -> Iterator[WatchedProgram]:
    """Run a module of the student's from its source."""
    _check_source(package_folder() / PACKAGE / f"{module}.py")
    with running(own_workspace().path, PACKAGE, module, *parameters, is_driven=is_driven) as node:
        yield node


def command(node: WatchedProgram, word: str) -> None:
    """Tell a node a command, as everybody does."""
    node.tell({COMMANDS.topic: word})


def tell_state_after(node: WatchedProgram, word: str) -> None:
    """Tell a node a command, and the state to which it leads, as the one that takes commands does."""
    node.tell({COMMANDS.topic: word, LESSON.state_topic: LESSON.state_after[word]})


@contextlib.contextmanager
def own_domain() -> Iterator[ObservedDomain]:
    """Observe the domain in which the notebook's terminals are."""
    environment.apply()
    with ObservedDomain(int(os.environ.get("ROS_DOMAIN_ID") or 0)) as domain:
        yield domain


def wait_for_terminals(domain: ObservedDomain) -> None:
    """Wait for the nodes of the notebook's terminals, which may have been started just now."""
    busy = sum(terminal.is_busy for terminal in magic.terminals().values())
    domain.wait_for_start(lambda: len(domain.nodes()) >= busy, START_TIMEOUT)


def idle_terminal() -> tuple[str, str]:
    """Return the name and the last words of a background terminal in which nothing runs any more, if there is one."""
    for name, terminal in magic.terminals().items():
        if name in BACKGROUND and not terminal.is_busy:
            lines = [line for line in read_error(terminal.read()).text.splitlines() if line.strip()]
            said = [line.strip() for line in lines if not line.startswith(f"{name}:")]
            return repr(name), f"; terminal {name!r} says: {said[-1] if said else 'nothing'}"
    return "", ""


def own_workspace() -> Workspace:
    """Return the workspace of the project."""
    return Workspace(course.student_path(WORKSPACE))


def package_folder() -> Path:
    """Return the folder of the package in it."""
    return course.student_path(WORKSPACE) / "src" / PACKAGE


def messages_of(log: TopicLog) -> list[Any]:
    """Return the messages that a log holds, the oldest first."""
    return [sample.message for sample in log.samples()]


def log_lines(logged: TopicLog, since: float, level: int = 0) -> list[str]:
    """Return the log lines of a level or above since a time (s); older ones may come late."""
    return [
        message.msg
        for message in messages_of(logged)
        if message.level >= level and message.stamp.sec + message.stamp.nanosec * 1e-9 >= since
    ]


def entry_points(workspace: Workspace) -> set[str]:
    """Return the names of the entry points that the package has as it was built last."""
    folders = [*workspace.path.glob("install/**/site-packages"), workspace.path / "build" / PACKAGE]
    for folder in folders:  # with links, the second one
        for distribution in importlib.metadata.distributions(path=[str(folder)]):
            if distribution.name.replace("-", "_") == PACKAGE:
                return {point.name for point in distribution.entry_points.select(group="console_scripts")}
    return set()


def _is_left_out(file: Path) -> bool:
    """Return whether setup.py installs a file of the package nowhere."""
    findings = diagnose.of_workspace(own_workspace().path)
    return any(finding.code == "not-in-data-files" and file.name in finding.about for finding in findings)


def expect_fresh() -> None:
    """Check that what is installed is what stands in src now."""
    for finding in diagnose.of_workspace(own_workspace().path):
        if finding.code in ("install-stale", "not-built"):
            raise CheckError(
                f"{WORKSPACE} is built as it is now", finding.cause.rstrip("."), f"type {finding.fix}."
            )


def _check_source(file: Path) -> None:
    shown = course.shown_path(file)
    if not file.is_file():
        raise CheckError(f"the file {shown}", "there is none", "run the cell that begins with %%editor.")
    try:
        tree = ast.parse(file.read_text(encoding="utf-8"))
    except (SyntaxError, UnicodeDecodeError) as error:
        where = f"line {error.lineno}: {error.msg}" if isinstance(error, SyntaxError) else str(error)
        raise CheckError(
            f"{shown} is Python",
            where,
            "look at that line and the one before: a bracket, a colon, the indentation?",
        ) from None
    names = {name for node in tree.body for name in _names_bound(node)}
    if "main" not in names:
        raise CheckError(
            f"{shown} has a function main",
            "none",
            "it makes the node and spins it; the entry point calls it.",
        )


def _names_bound(node: ast.stmt) -> Iterator[str]:
    for inner in ast.walk(node):
        if isinstance(inner, (ast.FunctionDef, ast.ClassDef)):
            yield inner.name
        elif isinstance(inner, ast.Name) and isinstance(inner.ctx, ast.Store):
            yield inner.id
        elif isinstance(inner, ast.alias):
            yield inner.asname or inner.name


def installed(patterns: Iterable[str], what: str) -> list[Path]:
    """Return the package's installed files of this kind, at least one."""
    files = hand_in.shared_files(own_workspace(), PACKAGE, *patterns)
    if files:
        return files
    sources = sorted(file for pattern in patterns for file in package_folder().rglob(pattern))
    raise CheckError(
        f"{what}, installed in share/{PACKAGE}",
        f"only {sources[0].relative_to(package_folder())} in src/" if sources else "none",
        "it was not built since: type `colcon build`."
        if sources and not _is_left_out(sources[0])
        else "data_files in setup.py names what is installed; then build again."
        if sources
        else "make the file first.",
        f"a line of data_files is a pair: (folder below install, list of files), such as ('share/{PACKAGE}/launch', [...]).",
    )
