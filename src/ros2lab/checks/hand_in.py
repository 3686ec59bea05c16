"""The exercises of `10_hand_in`: what is handed in is complete, true and buildable."""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ros2lab import hand_in
from ros2lab.checks import CheckError, Question, exercise, quiz_of
from ros2lab.hand_in import BUILT, EVIDENCE_FILE, PACKAGE, POINTS, TOPICS, Evidence
from ros2lab.workspace import Workspace

TOLERANCE = 5  # points
LOOKING_VERBS = ("echo", "hz", "info", "pub", "bw", "delay", "type")

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
    for command in ("colcon build", "install/setup.bash"):
        if command not in text:
            raise CheckError(
                f"{file.name} tells how to build and source, with {command}",
                "it does not",
                "what do you type in a new terminal before the nodes run?",
            )
    if not re.search(r"ros2 (run|launch) ", text):
        raise CheckError(
            f"{file.name} tells how to run it", "no `ros2 run` and no `ros2 launch`", "write the command."
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
    tracked = _git(workspace.path, "ls-files").splitlines()
    for name in (_readme_of(workspace).relative_to(workspace.path).as_posix(), EVIDENCE_FILE):
        if name not in tracked:
            raise CheckError(f"{name} is in git", "it is not", "use `git add`, then `git commit`.")
    changed = _git(workspace.path, "status", "--porcelain").splitlines()
    if changed:
        raise CheckError(
            "a clean tree: everything committed",
            f"{len(changed)} changed or unknown files, the first {changed[0].strip()}",
            "look at `git status`, which lists them: add and commit, or let .gitignore name them.",
        )
    return "Right: everything is committed."


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
        for name in names:
            inner = name.relative_to(root).parts if name.is_relative_to(root) else name.parts
            if (set(inner) & {"__pycache__", ".git"}) or inner[0] in BUILT:
                raise CheckError(
                    "only what you have written",
                    str(name),
                    "leave out build/, install/, log/, .git and __pycache__.",
                )
        for pattern in (r"README.*", re.escape(EVIDENCE_FILE)):
            if not any(re.fullmatch(pattern, name.name) for name in names):
                raise CheckError(
                    f"a file {pattern.split('.')[0]} in it".replace("\\", ""),
                    "none",
                    "write it first, then pack again.",
                )
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
    folders = (workspace.path, workspace.path / "src" / PACKAGE)
    files = [file for folder in folders for file in sorted(folder.glob("README*")) if file.is_file()]
    if not files:
        raise CheckError(
            "a README.md in the workspace",
            "none",
            "write it by the cell above, which ends with a line END.",
        )
    return files[0]


def _expect_true_commands(workspace: Workspace, collected: Evidence, text: str) -> None:
    installed = {(one.package, one.name) for one in workspace.executables()}
    for package, name in re.findall(r"ros2 run (\w+) ([\w.-]+)", text):
        if (package, name) not in installed:
            there = ", ".join(sorted(f"{package} {name}" for package, name in installed))
            raise CheckError("commands that are true", f"`ros2 run {package} {name}`", f"there are: {there}.")
    for package, name in re.findall(r"ros2 launch (\w+) ([\w.-]+)", text):
        share = (workspace.path / "install").glob(f"**/share/{package}/**/{name}")
        if not any(share):
            raise CheckError(
                "commands that are true",
                f"`ros2 launch {package} {name}`, and no such file is installed",
                "data_files in setup.py installs it.",
            )
    verbs = "|".join(LOOKING_VERBS)
    for topic in re.findall(rf"ros2 topic (?:{verbs})(?: -[\w-]+)* (/[\w/]+)", text):
        if topic not in collected.topics:
            raise CheckError(
                "commands that are true",
                f"a command with the topic {topic}",
                f"there were: {', '.join(collected.topics)}.",
            )


def _expect_repository(folder: Path) -> None:
    top = _git(folder, "rev-parse", "--show-toplevel").strip()
    if not top or Path(top).resolve() != folder.resolve():
        raise CheckError(
            "a git repository in the workspace",
            f"the one in {top}" if top else "none",
            "make one by `git init` in the workspace's folder.",
        )
    if not _git(folder, "rev-parse", "--verify", "--quiet", "HEAD"):
        raise CheckError("a commit", "none yet", "type `git add .`, then `git commit -m` with a message.")
    tracked = [Path(name) for name in _git(folder, "ls-files", "-z").split("\0") if name]
    built = [path for path in tracked if path.parts[0] in BUILT or "__pycache__" in path.parts]
    if built:
        raise CheckError(
            "nothing that was built is in git",
            f"{len(built)} files, the first {built[0]}",
            "take them out of git, and leave them in the folder, by `git rm -r --cached build install log`.",
            "name the three folders in .gitignore before you add.",
        )
    if not any(path.name == "package.xml" for path in tracked):
        raise CheckError("the package is in git", "no package.xml", "add it by `git add src`, then commit.")
    ignored = _git(folder, "check-ignore", *(f"{name}/x" for name in BUILT)).splitlines()
    if len(ignored) < len(BUILT):
        raise CheckError(
            ".gitignore names build/, install/ and log/",
            f"{len(ignored)} of them",
            "one name a line, in a file .gitignore beside src/.",
        )


def _git(folder: Path, *words: str) -> str:
    """Return what a git command that only reads prints; nothing if it fails."""
    environ = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *words],
            env={**environ, "GIT_OPTIONAL_LOCKS": "0"},
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
    except FileNotFoundError:
        raise CheckError(
            "the command git", "it is not installed", "Debian and Ubuntu: `sudo apt install git`."
        ) from None
    return done.stdout if done.returncode == 0 else ""
