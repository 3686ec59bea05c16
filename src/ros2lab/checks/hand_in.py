"""The exercises of `10_hand_in`: what is handed in is complete, true and buildable."""

from __future__ import annotations

import difflib
import os
import re
import shutil
import tempfile
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path, PurePath
from typing import Any

from ros2lab import hand_in
from ros2lab.checks import CheckError, Question, exercise, quiz_of
from ros2lab.hand_in import (
    BUILT,
    COMMAND_TOPIC,
    COMMANDS_OF_README,
    EVIDENCE_FILE,
    LONGEST_LINE,
    PACKAGE,
    POINTS,
    PUBLISHED,
    TOPICS,
    Evidence,
    git,
)
from ros2lab.observed_domain import HIDDEN_TOPICS
from ros2lab.workspace import Workspace

TOLERANCE = 5  # points
ALIKE = 0.92  # from 0 to 1; two names that are more alike are one, misspelt
LOOKING_VERBS = ("echo", "hz", "info", "pub", "bw", "delay", "type")

# Of each practice that must hold everywhere, what is expected and hints.
PRACTICES = {
    hand_in.READABLE: ("modules that Python can read", "look at that line and the one before."),
    hand_in.LOGGED: (
        "no print where the logger belongs",
        "the logger knows the node's name, a level and a time.",
        "in a node it is self.get_logger().info(...).",
    ),
    hand_in.CAUGHT: (
        "no bare `except:`",
        "it hides every error, those that you do not expect too: which one do you expect here?",
        "its name stands in the last line of a traceback: except ValueError:",
    ),
    hand_in.DESCRIBED: (
        "a docstring for every module and class",
        "a text in triple quotes, as the first line of the file or right below `class`: what is it for?",
    ),
    hand_in.SHORT: (
        f"no line longer than {LONGEST_LINE} characters",
        "what stands in brackets may go on in the next line.",
    ),
}

QUIZ = (
    Question(
        "c",
        "What colcon makes can be made again from src/, and belongs to one machine.",
        {
            "a": "git can hold them; but would they work in another folder?",
            "b": "they are quick to copy; what is in them that only your machine has?",
        },
    ),
    Question(
        "a",
        "A reader copies the commands: one that was never tried is worse than none.",
        {
            "b": "a README is for readers; who checks its spelling?",
            "c": "how long it is does not matter: can somebody who has never seen the package start it?",
        },
    ),
    Question(
        "b",
        "The logger knows the node's name, a level and a time, and /rosout carries it to others.",
        {
            "a": "print works in a node; but who sees it, when the node was started by a launch file far away?",
            "c": "which of them is quicker is of no importance here.",
        },
    ),
)


@exercise
def evidence(collected: Evidence, rate: Any) -> str:
    """Check that the evidence shows the nodes on their topics, and that it was read.

    Args:
        collected: of `collect_evidence`.
        rate: of /cmd_vel, as somebody reads it there, in Hz.

    Raises:
        CheckError: if it does not.
    """
    if not isinstance(collected, Evidence):
        raise CheckError("what collect_evidence() returns", repr(collected), "give it the workspace.")
    expected = f"every executable of {PACKAGE} runs until the end"
    if not collected.programs:
        raise CheckError(
            expected, "there are no executables", "lesson 7: entry points in setup.py, then build."
        )
    for name, end in collected.programs.items():
        if end != "runs":
            raise CheckError(
                expected, f"{name} {end}", "run it by `ros2 run` in a terminal, and read its traceback."
            )
    missing = [topic for topic in TOPICS if topic not in collected.topics]
    if missing:
        raise CheckError(
            f"the topics {', '.join(TOPICS)}",
            f"{', '.join(collected.topics) or 'none'}",
            "compare them letter by letter with those in your nodes.",
            "the checks of lesson 7 look at each node alone.",
        )
    ends = [(topic, "publishes", [*collected.published]) for topic in PUBLISHED]
    for topic, verb, topics in [*ends, (COMMAND_TOPIC, "listens to", [*collected.subscribed])]:
        if topic not in topics:
            raise CheckError(
                f"a node that {verb} {topic}",
                "none does",
                "the topic is there, but which end of it is yours? create_publisher or create_subscription?",
            )
    silent = [topic for topic, heard in collected.published.items() if topic in TOPICS and not heard.count]
    if silent:
        raise CheckError(f"messages on {silent[0]}", "none", "what calls the function that publishes?")
    heard = collected.published.get("/cmd_vel")
    measured = heard.rate if heard and heard.rate else 0.0
    is_number = isinstance(rate, (int, float)) and not isinstance(rate, bool)
    if not is_number or abs(rate - measured) > max(0.5, 0.1 * measured):
        raise CheckError(
            f"the rate of /cmd_vel as {EVIDENCE_FILE} has it, in Hz",
            repr(rate),
            "it is in the table below the heading `Topics published`.",
            "a number without its unit, such as 5.",
        )
    return "Right: it runs, and here is the evidence."


@exercise
def repository(workspace: Workspace) -> str:
    """Check that the workspace is a git repository with a commit, in which nothing that is built is kept.

    Args:
        workspace: the student's.

    Raises:
        CheckError: if it is not.
    """
    _expect_repository(workspace.path)
    return "Right: your sources are in git, and what colcon makes is not."


@exercise
def readme(workspace: Workspace, collected: Evidence) -> str:
    """Check that README names the package's nodes and topics, and that its commands are true.

    Args:
        workspace: the student's, built.
        collected: what was seen when its package ran.

    Raises:
        CheckError: if something is missing or not true.
    """
    file = _readme_of(workspace)
    text = file.read_text(encoding="utf-8", errors="replace")
    for kind, names in (("executable", sorted(collected.programs)), ("topic", TOPICS)):
        for name in names:
            if name not in text:
                raise CheckError(
                    f"{file.name} names the {kind} {name}",
                    "it does not",
                    f"a list of all {kind}s tells a reader what there is.",
                )
    for command, pattern in COMMANDS_OF_README.items():
        if not re.search(pattern, text):
            raise CheckError(
                f"{file.name} tells how to build, source and run, with {command}",
                "it does not",
                "what do you type in a new terminal until the nodes run?",
            )
    _expect_true_commands(workspace, collected, text)
    return "Right: your README says what there is, and what it says is true."


@exercise
def committed(workspace: Workspace) -> str:
    """Check that README and evidence are committed, and nothing is left uncommitted.

    Args:
        workspace: the student's.

    Raises:
        CheckError: if they are not.
    """
    _expect_repository(workspace.path)
    tracked = git(workspace.path, "ls-files", "-z").split("\0")
    for name in (_readme_of(workspace).relative_to(workspace.path).as_posix(), EVIDENCE_FILE):
        if name not in tracked:
            raise CheckError(f"{name} is in git", "it is not", "use `git add`, then `git commit`.")
    changed = git(workspace.path, "status", "--porcelain").splitlines()
    if changed:
        raise CheckError(
            "a clean tree: everything committed",
            f"{len(changed)} changed or unknown files, the first {changed[0].strip()}",
            "look at `git status`, which lists them: add and commit, or let .gitignore name them.",
        )
    return "Right: everything is committed."


@exercise
def practices(workspace: Workspace) -> str:
    """Check that the package logs, catches errors by name, describes its modules and classes, and has short lines.

    Args:
        workspace: the student's.

    Raises:
        CheckError: at the first practice that does not hold everywhere, with the place.
    """
    found = hand_in.places_of_practices(workspace)
    if not found:
        raise CheckError(
            f"modules in src/{PACKAGE}/{PACKAGE}", "none", "is it the workspace of your project?"
        )
    for practice, (expected, *hints) in PRACTICES.items():
        places = [place for place in found.get(practice, []) if place]
        if places:
            more = f" and {len(places) - 1} more" if len(places) > 1 else ""
            raise CheckError(expected, f"{places[0]}{more}", *hints)
    return "Right: your code logs, catches errors by name, says what it is, and fits on the screen."


@exercise
def self_assessment(claims: Mapping[str, int], facts: Mapping[str, Mapping[str, bool]]) -> str:
    """Check that somebody claims points for every part, and about those that were measured.

    Args:
        claims: points by the name of the part.
        facts: of `measure`.

    Raises:
        CheckError: if a part is missing, or a claim is out of range or far from what was measured.
    """
    if not isinstance(claims, Mapping):
        raise CheckError("points by part, in braces", repr(claims), '{"workspace": 15, ...}')
    for part, most in POINTS.items():
        claim = claims.get(part)
        if isinstance(claim, bool) or not isinstance(claim, (int, float)) or not 0 <= claim <= most:
            raise CheckError(
                f"points for {part!r}, from 0 to {most}",
                repr(claim),
                "the parts are those of the table above.",
            )
        measured = hand_in.measured_points(part, facts)
        if abs(claim - measured) > TOLERANCE:
            missing = [fact for fact, holds in facts[part].items() if not holds]
            raise CheckError(
                f"a claim for {part!r} that fits what was measured, {measured} of {most}",
                f"{claim}",
                f"it was not seen that {missing[0]}: mend it and measure again, or claim less."
                if missing
                else "everything was seen: claim what is yours.",
            )
    unknown = set(claims) - set(POINTS)
    if unknown:
        raise CheckError(
            f"the parts {', '.join(POINTS)}", f"also {', '.join(map(repr, sorted(unknown)))}", "take it out."
        )
    return "Right: you know what your work is worth."


@exercise
def archive(path: Any) -> str:
    """Check that an archive holds a package with README and evidence, nothing built, and builds where it is unpacked.

    Args:
        path: of the archive.

    Raises:
        CheckError: if it does not.
    """
    if not isinstance(path, (str, os.PathLike)) or not zipfile.is_zipfile(path):
        raise CheckError(
            "the path of a zip file", repr(path), "pack() returns it.", "pack(workspace) packs it."
        )
    if re.search(r"\s", Path(path).name):
        raise CheckError(
            "a name without blanks", repr(Path(path).name), "many programs stumble over a blank."
        )
    with zipfile.ZipFile(path) as zipped:
        names = [Path(name) for name in zipped.namelist() if not name.endswith("/")]
        manifests = [name for name in names if name.name == "package.xml" and "src" in name.parts]
        if not manifests:
            raise CheckError(
                "src/ with a package in it", "no package.xml below src/", "pack the workspace's folder."
            )
        root = next(part for part in manifests[0].parents if part.name == "src").parent
        _expect_nothing_built(
            (name.relative_to(root) if name.is_relative_to(root) else name for name in names),
            "only what you have written",
            "leave out build/, install/, log/, .git and __pycache__.",
        )
        for wanted, is_wanted in (("README", hand_in.is_readme), (EVIDENCE_FILE, EVIDENCE_FILE.__eq__)):
            if not any(is_wanted(name.name) for name in names):
                raise CheckError(f"a file {wanted} in it", "none", "write it first, then pack again.")
        with tempfile.TemporaryDirectory() as folder:
            zipped.extractall(folder)
            result = Workspace(Path(folder, root)).build(show=False)
    if not result.is_ok:
        raise CheckError(
            "it builds where it is unpacked",
            str(result.first_error),
            "a file is missing that is there on your machine: is it below src/?",
        )
    return (
        "Right: it holds your sources, README and evidence, nothing built, and it builds in another folder."
    )


quiz = quiz_of(__name__, QUIZ)


def _readme_of(workspace: Workspace) -> Path:
    file = hand_in.find_readme(workspace)
    if file is None:
        raise CheckError(
            "a README.md in the workspace",
            "none",
            "write it by the cell above, which ends with a line END.",
        )
    return file


def _expect_true_commands(workspace: Workspace, collected: Evidence, text: str) -> None:
    """Check the commands on packages of this workspace; nobody here knows what other packages hold."""
    own = {package.name for package in workspace.packages()}
    installed = {(one.package, one.name) for one in workspace.executables()}
    commands = re.findall(r"ros2 +(run|launch) +(\w[\w-]*) +(\w(?:[\w.-]*\w)?)", text)
    for verb, package, name in commands:
        command = f"`ros2 {verb} {package} {name}`"
        if package not in own and _near(package, own):
            raise CheckError(
                "commands that are true", command, f"the package is called {_near(package, own)}."
            )
        if package in own and verb == "run" and (package, name) not in installed:
            there = ", ".join(sorted(f"{package} {name}" for package, name in installed))
            raise CheckError("commands that are true", command, f"there are: {there}.")
        if package in own and verb == "launch" and not hand_in.shared_files(workspace, package, name):
            raise CheckError(
                "commands that are true",
                f"{command}, and no such file is installed",
                "data_files in setup.py installs it.",
            )
    is_alone = own.issuperset(package for _, package, _ in commands)
    verbs = "|".join(LOOKING_VERBS)
    for topic in re.findall(rf"ros2 +topic +(?:{verbs})(?: +-[\w-]+)* +(/[\w/]*\w)", text):
        is_known = topic in collected.topics or topic in HIDDEN_TOPICS or "/_" in topic
        if not is_known and (is_alone or _near(topic, collected.topics)):
            raise CheckError(
                "commands that are true",
                f"a command with the topic {topic}",
                f"there were: {', '.join(collected.topics)}.",
            )


def _near(name: str, names: Iterable[str]) -> str:
    """Return the one of the names that is meant by a misspelt one; nothing if none is."""
    by_lower = {one.lower(): one for one in names}
    found = difflib.get_close_matches(name.lower(), by_lower, n=1, cutoff=ALIKE)
    return by_lower[found[0]] if found else ""


def _expect_nothing_built(paths: Iterable[PurePath], expected: str, *hints: str) -> None:
    built = hand_in.products(paths)
    misplaced = [path for path in built if path.parts[0] not in BUILT and set(BUILT).intersection(path.parts)]
    if misplaced:
        raise CheckError(
            expected,
            f"{len(misplaced)} files, the first {misplaced[0]}: colcon was run in the wrong folder",
            "colcon builds where you stand: remove what it has made there, and build where src/ is.",
            *hints,
        )
    if built:
        raise CheckError(expected, f"{len(built)} files, the first {built[0]}", *hints)


def _expect_repository(folder: Path) -> None:
    if shutil.which("git") is None:
        raise CheckError(
            "the command git", "it is not installed", "Debian and Ubuntu: `sudo apt install git`."
        )
    top = git(folder, "rev-parse", "--show-toplevel").strip()
    if not top or Path(top).resolve() != folder.resolve():
        raise CheckError(
            "a git repository in the workspace",
            f"the one in {top}" if top else "none",
            "make one by `git init` in the workspace's folder.",
        )
    if not git(folder, "rev-parse", "--verify", "--quiet", "HEAD"):
        raise CheckError("a commit", "none yet", "type `git add .`, then `git commit -m` with a message.")
    tracked = [PurePath(name) for name in git(folder, "ls-files", "-z").split("\0") if name]
    _expect_nothing_built(
        tracked,
        "nothing that was built is in git",
        "take them out of git, and leave them in the folder, by `git rm -r --cached build install log`.",
        "name the three folders in .gitignore before you add.",
    )
    if not any(path.name == "package.xml" for path in tracked):
        raise CheckError("the package is in git", "no package.xml", "add it by `git add src`, then commit.")
    ignored = hand_in.ignored(folder)
    if len(ignored) < len(BUILT):
        raise CheckError(
            ".gitignore names build/, install/ and log/",
            f"{len(ignored)} of them",
            "one name a line, in a file .gitignore beside src/.",
        )
