"""The exercises of `10_hand_in`: what is handed in is complete, true and buildable."""

from __future__ import annotations

import os
import re
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ros2lab import assignments, course, hand_in
from ros2lab.assessment import NOT_RUN, POINTS, Assessment, judged
from ros2lab.checks import CheckError, exercise, predict_of, questions_of, quiz_of
from ros2lab.checks.repositories import expect_nothing_built, expect_repository, in_last_commit
from ros2lab.clean_build import built_from_nothing, differing, digests, folder_apart, is_readme, listed
from ros2lab.diagnose.sources.spelling import nearest
from ros2lab.git import git
from ros2lab.hand_in import (
    COMMAND_TOPIC,
    EVIDENCE_FILE,
    PACKAGE,
    PUBLISHED,
    RUNS,
    Evidence,
)
from ros2lab.judge import case_of, lost
from ros2lab.practices import (
    CAUGHT,
    DESCRIBED,
    LICENSED,
    LOGGED,
    LONGEST_LINE,
    NAMED,
    READABLE,
    SHORT,
    places_of_practices,
)
from ros2lab.workspace import Workspace

TOLERANCE = 2  # points
TYPES = {part.topic: part.type_name for part in assignments.load().parts.values()}
AGAIN = "run the cell with collect_evidence() again: it takes a few seconds."

# Of each practice that must hold everywhere, what is expected and hints.
PRACTICES = {
    READABLE: ("modules that Python can read", "look at that line and the one before."),
    LOGGED: (
        "no print where the logger belongs",
        "the logger knows the node's name, a level and a time.",
        "in a node it is self.get_logger().info(...).",
    ),
    CAUGHT: (
        "each except names the error that it expects",
        "it hides every error, those that you do not expect too: which one do you expect here?",
        "its name stands in the last line of a traceback: except ValueError:",
    ),
    DESCRIBED: (
        "a docstring for every module and class",
        "a text in triple quotes, as the first line of the file or right below `class`: what is it for?",
    ),
    NAMED: (
        "names as in PEP 8",
        "functions and methods are written like_this, classes LikeThis.",
    ),
    SHORT: (
        f"no line longer than {LONGEST_LINE} characters",
        "what stands in brackets may go on in the next line.",
    ),
    LICENSED: (
        "license, description and maintainer in package.xml",
        "write your own instead of TODO; MIT and Apache-2.0 are common licenses.",
    ),
}


@exercise
def practices(workspace: Workspace) -> str:
    """Check the practices of a package that can be counted: logging, errors, docstrings, names, lines, license.

    Args:
        workspace: the student's.

    Raises:
        CheckError: at the first practice that does not hold everywhere, with the place.
    """
    found = places_of_practices(workspace)
    if not found:
        raise CheckError(
            f"modules in src/{PACKAGE}/{PACKAGE}", "none", "is it the workspace of your project?"
        )
    for practice, (expected, *hints) in PRACTICES.items():
        places = [place for place in found.get(practice, []) if place]
        if places:
            raise CheckError(expected, ", ".join(places), *hints)
    return "Right: your code logs, catches errors by name, says what it is, and fits on the screen."


@exercise
def evidence(collected: Evidence, rate: Any) -> str:
    """Check that the evidence shows the nodes on their topics, and that it was read.

    Args:
        collected: of `collect_evidence`.
        rate: of /cmd_vel, as somebody reads it there, in Hz.

    Raises:
        CheckError: if it does not.
    """
    _expect_current(collected)
    _expect_programs_run(collected)
    ends = [(topic, "publishes on", collected.publishers) for topic in PUBLISHED]
    for topic, verb, nodes in [*ends, (COMMAND_TOPIC, "subscribes to", collected.subscribers)]:
        _expect_end(topic, verb, nodes, collected.topics)
    for topic in PUBLISHED:
        heard = collected.published.get(topic)
        if heard is None or not heard.count:
            raise CheckError(f"messages on {topic}", "none", "what calls the function that publishes?")
    *_, velocity = PUBLISHED
    measured = collected.published[velocity].rate or 0.0
    is_number = isinstance(rate, (int, float)) and not isinstance(rate, bool)
    if not is_number or abs(rate - measured) > max(0.5, 0.1 * measured):
        raise CheckError(
            f"the rate of {velocity} as {EVIDENCE_FILE} has it, in Hz",
            repr(rate),
            "it is in the table below the heading `Topics published`; where that has a -, write 0.",
            "a number without its unit, such as 5.",
        )
    _expect_nothing_lost(collected)
    return "Right: it is built from nothing, it runs, and here is the evidence."


@exercise
def repository(workspace: Workspace) -> str:
    """Check that the workspace is a git repository with a commit of the sources, and of nothing that is built.

    Args:
        workspace: the student's.

    Raises:
        CheckError: if it is not.
    """
    expect_repository(workspace.path)
    return "Right: your sources are in git, and what colcon makes is not."


@exercise
def readme(workspace: Workspace, collected: Evidence) -> str:
    """Check that README names the package's nodes and topics, and that its commands are true, as the grader does.

    Args:
        workspace: the student's.
        collected: what was seen when its package ran.

    Raises:
        CheckError: if something is missing or not true.
    """
    _expect_current(collected)
    if collected.file.parent != workspace.path:
        raise CheckError(
            f"evidence of {course.shown_path(workspace.path)}",
            f"that of {course.shown_path(collected.file.parent)}",
            "give the workspace from which the evidence was collected.",
        )
    file = _readme_of(workspace)
    there = [f"ros2 run {PACKAGE} {name}" for name in collected.programs]
    there += [f"ros2 launch {PACKAGE} {Path(name).name}" for name in collected.shared if "launch" in name]
    hints = {
        "documentation.readme": "say in your own words what it is, how to start it, and what one will see.",
        "documentation.commands": f"try each command that it names; there are: {', '.join(there)}; "
        f"and the topics {', '.join(collected.topics)}.",
        "documentation.interface": "a table of nodes, topics and types tells a reader what there is.",
    }
    for judgement in judged(workspace, collected, "documentation"):
        if judgement.points < judgement.max and judgement.id in hints:
            raise CheckError(judgement.title, judgement.reason.rstrip("."), hints[judgement.id])
    text = file.read_text(encoding="utf-8", errors="replace")
    for words, pattern, hint in (
        (
            "source install/setup.bash",
            r"install/(local_)?setup\.\w*sh",
            "what must be typed in a new terminal before `ros2 run`?",
        ),
        (EVIDENCE_FILE, EVIDENCE_FILE, "a reader wants to see what it looks like when it runs: link to it."),
    ):
        if not re.search(pattern, text):
            raise CheckError(f"{file.name} mentions {words}", "it does not", hint)
    return "Right: your README says what there is, and what it says is true."


@exercise
def committed(workspace: Workspace) -> str:
    """Check that README and current evidence are committed, and nothing is left uncommitted.

    Args:
        workspace: the student's.

    Raises:
        CheckError: if they are not.
    """
    expect_repository(workspace.path)
    tracked = in_last_commit(workspace.path)
    for name in (_readme_of(workspace).relative_to(workspace.path).as_posix(), EVIDENCE_FILE):
        if name not in tracked:
            raise CheckError(
                f"{name} is in the last commit",
                "it is not",
                f"type `git add {name}`, then `git commit -m` with a message.",
            )
    changed = git(workspace.path, "status", "--porcelain").splitlines()
    if changed:
        raise CheckError(
            "a clean tree: everything committed",
            f"{len(changed)} changed or unknown file{'s' * (len(changed) > 1)}, the first: {changed[0].strip()}",
            "look at `git status`, which lists them: add and commit, or let .gitignore name them.",
        )
    _expect_evidence_of(workspace.path)
    return "Right: everything is committed, and the evidence is that of these sources."


@exercise
def self_assessment(claims: Mapping[str, int], assessment: Assessment) -> str:
    """Check that somebody claims points for every part, and about those that the grader gives.

    Args:
        claims: points by the name of the part.
        assessment: of `assess`.

    Raises:
        CheckError: if a part is missing, or a claim is out of range or far from what the grader gives.
    """
    if not isinstance(claims, Mapping):
        raise CheckError("points by part, in braces", repr(claims), 'write {"workspace": 15, ...}')
    unknown = [part for part in claims if part not in POINTS]
    missing = [part for part in POINTS if part not in claims]
    if unknown:
        named, meant = ", ".join(map(repr, unknown)), nearest(str(unknown[0]), missing)
        raise CheckError(
            f"the parts {', '.join(POINTS)}",
            f"{named}, and not {', '.join(missing)}" if missing else f"also {named}",
            f"the part is called {meant!r}." if meant else f"there is no part {unknown[0]!r}: take it out.",
        )
    for part, most in POINTS.items():
        claim = claims.get(part)
        if isinstance(claim, bool) or not isinstance(claim, (int, float)) or not 0 <= claim <= most:
            raise CheckError(
                f"points for {part!r}, from 0 to {most:g}",
                "none" if claim is None else repr(claim),
                "the parts, and the most that each is worth, are in the table above.",
            )
    if not isinstance(assessment, Assessment):
        raise CheckError("what assess() returns", repr(assessment), "give it the workspace and the evidence.")
    if assessment.outdated:
        raise CheckError(
            "an assessment of what is there now",
            f"{listed(assessment.outdated)} changed since",
            "run the cell with assess() again.",
        )
    for part in POINTS:
        _expect_claim(part, claims[part], assessment)
    if assessment.why_not_run:
        return (
            f"Right, as far as is known: what the table calls {NOT_RUN!r} was not compared. "
            f"{assessment.why_not_run}"
        )
    return "Right: you know what your work is worth."


@exercise
def archive(path: Any, workspace: Workspace) -> str:
    """Check that an archive holds the sources as they are, README and evidence, nothing built, and builds from nothing.

    Args:
        path: of the archive.
        workspace: what was packed.

    Raises:
        CheckError: if it does not.
    """
    if not isinstance(path, (str, os.PathLike)) or not zipfile.is_zipfile(path):
        raise CheckError(
            "the path of a zip file", repr(path), "pack() returns it.", "pack(workspace) packs it."
        )
    if re.search(r"\s", Path(path).name):
        raise CheckError(
            "a name without spaces", repr(Path(path).name), "many programs stumble over a space."
        )
    with zipfile.ZipFile(path) as zipped, folder_apart() as folder:
        root = Path(folder, _root_in([Path(name) for name in zipped.namelist() if not name.endswith("/")]))
        zipped.extractall(folder)
        changed = differing(digests(root), digests(workspace.path))
        if changed:
            raise CheckError(
                "the sources as they are now",
                f"{listed(changed)} {'differ' if len(changed) > 1 else 'differs'}",
                "it was packed before the last change, or from another folder: pack again.",
            )
        _expect_evidence_of(root)
        with built_from_nothing(root) as clean:
            if not clean.result.is_ok:
                raise CheckError(
                    "it builds where it is unpacked",
                    str(clean.result.first_error),
                    "a file is missing that is there on your machine: is it below src/?",
                )
    return (
        "Right: it holds your sources, README and evidence, nothing built, and it builds in another folder."
    )


QUIZ, PREDICTIONS = questions_of(__name__)
quiz = quiz_of(__name__, QUIZ)
predict = predict_of(__name__, PREDICTIONS)


def _expect_current(collected: Any) -> None:
    """Check that something is evidence of what could be built, and of the sources as they are."""
    if not isinstance(collected, Evidence):
        raise CheckError("what collect_evidence() returns", repr(collected), "give it the workspace.")
    if collected.outdated:
        raise CheckError(
            "evidence of the sources as they are now",
            f"{listed(collected.outdated)} changed since it was collected",
            AGAIN,
        )
    if collected.fault:
        raise CheckError(
            "what is in src/ builds from nothing",
            collected.fault,
            "your own install/ may hold what an earlier build has left: fix this error, and collect again.",
            "remove build/, install/ and log/, and run `colcon build`: then you see the same error.",
        )


def _expect_programs_run(collected: Evidence) -> None:
    expected = f"every executable of {PACKAGE} runs until the end"
    if not collected.programs:
        raise CheckError(
            expected,
            "the build from nothing has installed no executable",
            "name them in setup.py, under console_scripts, and look at setup.cfg.",
        )
    for name, end in collected.programs.items():
        if end != RUNS:
            raise CheckError(
                expected, f"{name} {end}", f"type `ros2 run {PACKAGE} {name}`, and read its last line."
            )


def _expect_nothing_lost(collected: Evidence) -> None:
    """Check that the grader has nothing to object to in what the nodes did."""
    case = case_of([collected.run] if collected.run else [])
    for part in hand_in.ASSIGNMENT.parts:
        for judgement in lost(case, part):
            raise CheckError(judgement.title, judgement.reason.rstrip("."), judgement.hint)


def _expect_end(topic: str, verb: str, nodes: Mapping[str, Mapping[str, Any]], seen: list[str]) -> None:
    expected = f"a node that {verb} {topic}, with the type {TYPES[topic]}"
    if topic not in nodes:
        raise CheckError(
            expected,
            f"none does; the topics are {', '.join(seen) or 'none'}",
            "the topic is there: which end of it is yours, create_publisher or create_subscription?"
            if topic in seen
            else "compare the names letter by letter with those in your nodes.",
        )
    types = sorted({name for of_node in nodes[topic].values() for name in of_node})
    if TYPES[topic] not in types:
        raise CheckError(expected, ", ".join(types), "which message do you import, and give to the topic?")


def _expect_claim(part: str, claim: float, assessment: Assessment) -> None:
    points = assessment.points(part)
    if points is None or abs(claim - points) <= TOLERANCE:
        return
    lost = assessment.lost(part)
    hint = (
        f"{lost[0].reason} {lost[0].hint} Or claim less."
        if claim > points and lost
        else "the grader has found nothing more to object to: claim what is yours."
    )
    raise CheckError(
        f"a claim for {part!r} that fits what the grader gives, {points:g} of {POINTS[part]:g}",
        f"{claim:g}",
        hint,
    )


def _expect_evidence_of(root: Path) -> None:
    fault = hand_in.evidence_fault(root)
    if fault:
        raise CheckError(f"{EVIDENCE_FILE} of these sources", fault, AGAIN)


def _root_in(names: list[Path]) -> Path:
    """Return the workspace's folder in an archive of these files."""
    manifests = [name for name in names if name.name == "package.xml" and "src" in name.parts]
    if not manifests:
        raise CheckError(
            "src/ with a package in it", "no package.xml below src/", "pack the workspace's folder."
        )
    root = next(part for part in manifests[0].parents if part.name == "src").parent
    expect_nothing_built(
        (name.relative_to(root) if name.is_relative_to(root) else name for name in names),
        "only what you have written",
        "leave out build/, install/, log/, .git and __pycache__.",
    )
    for wanted, is_wanted in (("README", is_readme), (EVIDENCE_FILE, EVIDENCE_FILE.__eq__)):
        if not any(is_wanted(name.name) for name in names):
            raise CheckError(f"a file {wanted} in it", "none", f"write {wanted} first, then pack again.")
    return root


def _readme_of(workspace: Workspace) -> Path:
    file = hand_in.find_readme(workspace)
    if file is None:
        raise CheckError("a README.md in the workspace", "none", "write one beside src/.")
    return file
