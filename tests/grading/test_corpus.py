"""Submissions of the corpus get what they must: each style its full marks, each fault its cost and no other.

Here are some of each class, for all of them take more than an hour: `make corpus` grades those.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import evidences
import pytest
from corpus import CASES, HINTS
from corpus.case import Case
from corpus.graded import WORKSPACE, Outcome, disappointments, graded
from corpus.hints import Hint
from corpus.tree import as_folder, made

from ros2lab.grading.grade import Grade
from ros2lab.grading.judging import readme
from ros2lab.grading.reading.files import look
from ros2lab.grading.receiving.submission import receive
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

NAMED = {case.name: case for case in CASES}
FAULT = "command_subscriber/dies_on_empty"
# What no other case here asks of the grader.
SAMPLE = {
    "form/spread_over_packages": "the nodes are looked for in more than one package",
    "style/one_process": "a node is known by what it does, and not by its program",
    "style/waiting_loop": "a loop of the student's own is as regular as a timer",
    "style/needs_what_is_elsewhere": "what is waited for is given, and only so much comes by itself; what is not installed costs nothing",
    "extreme/package_as_created": "a build without a fault earns no points for nodes that are not there",
    "extreme/broken_zip": "there is a refusal in place of a grade",
    "workspace/two_copies": "colcon refuses the workspace, and the package in it is graded all the same",
    "package/xml_build_type_misspelt": "colcon succeeds and has built nothing",
    "status_publisher/irregular": "only the times of the messages show it",
    FAULT: "only a command that nobody expects shows it",
    "velocity_publisher/int_when_it_is_made": "a program dies before its node is there, and is told why",
    "velocity_publisher/ends_beside_another": "each program sees which others run",
    "style/one_of_a_kind": "no program sees itself twice",
    "bonus/tests_swallow": "the student's tests are run on a program that was spoilt",
    "pair/topic_behind_setup": "behind a fault that stops the build a second one is found",
    "hostile/setup_writes_everywhere": "harm is done while it is built",
    "hostile/environment_hook": "harm is done while it is sourced and run",
    "lamp/components_over_modules": "another assignment, with a service, rightly done",
    "lamp/dies_of_a_request": "another assignment, with a service, with a fault",
    "documentation/other_topics": "what the README says is compared with what was seen",
}
# What is particular about each of them is asked of one room by a test of that room; it is graded here all the same.
LONG = (
    "command_subscriber/dies_on_empty",
    "form/spread_over_packages",
    "style/waiting_loop",
    "style/needs_what_is_elsewhere",
    "extreme/package_as_created",
    "workspace/two_copies",
    "status_publisher/irregular",
    "velocity_publisher/int_when_it_is_made",
    "velocity_publisher/ends_beside_another",
    "style/one_of_a_kind",
    "bonus/tests_swallow",
    "pair/topic_behind_setup",
    "hostile/setup_writes_everywhere",
    "lamp/components_over_modules",
    "lamp/dies_of_a_request",
    "documentation/other_topics",
)


@pytest.fixture(scope="module")
def outcome(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Outcome]:
    """Return a function that grades a case, once for all tests of this process."""
    outcomes: dict[str, Outcome] = {}

    def outcome(name: str) -> Outcome:
        if name not in outcomes:
            outcomes[name] = graded(NAMED[name], tmp_path_factory.mktemp("corpus"))
        return outcomes[name]

    return outcome


# Those about files alone: a run would tell no more of them.
OF_FILES = [hint for hint in HINTS if hint.criterion.startswith(("workspace", "package", "documentation"))]
OF_EACH = {hint.criterion: hint for hint in OF_FILES}


@pytest.mark.parametrize(
    "hint",
    [
        pytest.param(
            hint, marks=() if hint is OF_EACH[hint.criterion] else pytest.mark.thorough, id=hint.name
        )
        for hint in OF_FILES
        if hint.criterion != "package.executables"
    ],
)
def test_a_hint_about_files_keeps_what_it_promises(hint: Hint, tmp_path: Path) -> None:
    """What it is about has more points, and no component fewer; all that runs is taken to be right."""
    before = hint.case.make(tmp_path / "before", {})
    files = {str(path.relative_to(before)): path.read_text() for path in before.rglob("*") if path.is_file()}
    after = as_folder(made(files, hint.change), WORKSPACE)(tmp_path / "after", {})
    grades = [_of_files(path, tmp_path / f"received {path.parent.name}") for path in (before, after)]
    assert [*disappointments(hint, *grades)] == []


def _of_files(path: Path, root: Path) -> Grade:
    root.mkdir()
    submission = receive(path, root)
    right = evidences.right()
    facts = look(root, submission)
    assert right.build is not None
    commands = readme.commands(facts.readme, submission, right.build, right.runs)
    evidence = replace(right, files=replace(facts, readme_commands=commands), submission=submission)
    if not (facts.setup.get("scripts_go_to_lib") and facts.setup.get("marker_exists")):
        # What such a package installs is not what a right one does: its files alone tell.
        evidence = replace(evidence, build=replace(right.build, is_built=False))
    return verdict(evidence, load())


@pytest.mark.long
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.thorough if name in LONG else ()) for name in SAMPLE]
)
def test_it_gets_what_it_must(name: str, outcome: Callable[[str], Outcome]) -> None:
    assert outcome(name).problems == []


@pytest.mark.thorough
def test_a_wrong_expectation_is_objected_to(outcome: Callable[[str], Outcome]) -> None:
    """So a right outcome means something: here a fault is graded as if it were a style."""
    fault = NAMED[FAULT]
    grade = outcome(FAULT).grade
    assert grade is not None
    as_style = Case(fault.name, fault.about, fault.make)
    assert any("must lose none" in problem for problem in as_style.problems(grade))


def test_each_class_of_the_corpus_is_sampled() -> None:
    """A class is what stands before the slash."""
    classes, sampled = ({name.partition("/")[0] for name in names} for names in (NAMED, SAMPLE))
    assert sampled == classes
