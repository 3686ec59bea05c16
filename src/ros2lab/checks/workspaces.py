"""The exercises of `01_workspaces`."""

from __future__ import annotations

import os
from pathlib import Path

from ros2lab import course
from ros2lab.checks import CheckError, Question, exercise, quiz_of
from ros2lab.checks.programs import overlay_of
from ros2lab.workspace import Workspace

MADE_BY_COLCON = ("build", "install", "log")
KEPT, GONE = "greeter", "old_toy"  # the packages of the exercise with the left-over one

# What is said to somebody who wrongly chose, or left out, a terminal.
TERMINALS = {
    "a": "changing the folder changes no variable: does ROS 2 look where you are, or in AMENT_PREFIX_PATH?",
    "b": "what was sourced stays in its shell, wherever you go from there.",
    "c": "bash reads the file in a shell of its own, which then ends: what is left of its variables?",
    "d": "a build writes files; which line reads them into the terminal?",
    "e": "ask the terminal in which you sourced local_setup.bash of a workspace: is its own package missing?",
    "f": "what a shell starts inherits its variables, another shell too.",
}
KNOWING = frozenset("bef")

QUIZ = (
    Question(
        "c",
        "build, install and log are made from src at any time, and src from nothing.",
        {
            "a": "can colcon write a node again that you have deleted?",
            "b": "you have deleted some of them in this lesson, and what came back?",
        },
    ),
    Question(
        "a",
        "Each shell has variables of its own, and sourcing changes only those of the shell that sources.",
        {
            "c": "would the first terminal run the package if it were not built?",
            "b": "the file is where it was: who has read it?",
        },
    ),
    Question(
        "b",
        "setup.bash first sources the workspaces that were sourced during the build, then local_setup.bash.",
        {
            "a": "both hold for as long as the shell lives: what did the upper workspace bring along?",
            "c": "neither builds anything; both only set variables.",
        },
    ),
    Question(
        "c",
        "colcon makes the three spaces where you stand, so you stand in the workspace.",
        {
            "a": "look at the prompt of the cell that built: does its folder end with src?",
            "b": "then build, install and log would lie in the middle of everything else of yours.",
        },
    ),
)


@exercise
def second_workspace(folder: str) -> str:
    """Check that a folder is a workspace that was built: the four spaces, and a setup.bash that works.

    Args:
        folder: as the lab's terminals write it.

    Raises:
        CheckError: if it is not.
    """
    path = course.student_path(folder)
    shown = course.shown_path(path)
    if not path.is_dir():
        raise CheckError(
            f"a folder {shown}", "none", "mkdir makes a folder; with -p also those above it.", "mkdir -p."
        )
    if not (path / "src").is_dir():
        raise CheckError(f"{shown}/src", _listed(path), "which of the four spaces do you make yourself?")
    _check_built(path, shown)
    sourced = overlay_of(Workspace(path)).get("COLCON_PREFIX_PATH", "").split(os.pathsep)
    if not any(_is_same(Path(prefix), path / "install") for prefix in sourced if prefix):
        raise CheckError(
            f"{shown}/install/setup.bash adds {shown}/install to COLCON_PREFIX_PATH",
            "it does not",
            "let colcon write the file: delete install/ and build again.",
        )
    return "Right: src by you, and build, install and log by colcon."


@exercise
def knows_the_package(*letters: str) -> str:
    """Check the letters of the terminals that know the package; order and writing do not matter.

    Args:
        letters: one a terminal.

    Raises:
        CheckError: at the first terminal that is missing, or too many.
    """
    chosen = {character for character in "".join(map(str, letters)).lower() if character.isalnum()}
    if not chosen:
        raise CheckError("some letters from a to f", "none", "which of them have sourced the workspace?")
    for letter in sorted(chosen - KNOWING):
        hint = TERMINALS.get(letter, "the terminals are called a to f.")
        raise CheckError("only terminals that know greeter", repr(letter), hint)
    for letter in sorted(KNOWING - chosen):
        found = f"only {', '.join(sorted(chosen))}"
        raise CheckError("all terminals that know greeter", found, "one is missing.", TERMINALS[letter])
    return "Right: those who sourced, and who inherits from them."


@exercise
def tidy_workspace(folder: str) -> str:
    """Check that a workspace holds and installs `greeter`, and nothing of `old_toy` any more.

    Args:
        folder: as the lab's terminals write it.

    Raises:
        CheckError: if it does not.
    """
    path = course.student_path(folder)
    shown = course.shown_path(path)
    if not (path / "src" / KEPT / "package.xml").is_file():
        raise CheckError(
            f"the source of {KEPT} in {shown}/src",
            _listed(path / "src"),
            f"src is what nobody can make again: copy it back from ~/ros2_ws/src/{KEPT}.",
        )
    if (path / "src" / GONE).exists():
        raise CheckError(
            f"no {GONE} in {shown}/src",
            "it is there",
            f"the toy is to go: what holds it now that its source is gone? Not src: delete src/{GONE}.",
        )
    _check_built(path, shown)
    left = [f"{space}/{GONE}" for space in ("build", "install") if (path / space / GONE).exists()]
    known = _known(overlay_of(Workspace(path)), path)
    if left or GONE in known:
        raise CheckError(
            f"nothing of {GONE} in {shown}",
            ", ".join(left) or f"{GONE} is known after sourcing",
            "colcon build only adds: who takes away?",
            "which three folders can colcon make again?",
        )
    if KEPT not in known:
        raise CheckError(
            f"{KEPT} is known in a new terminal after `source {shown}/install/setup.bash`",
            f"known from there: {', '.join(sorted(known)) or 'nothing'}",
            "after deleting comes building.",
        )
    return "Right: what is installed is what src holds."


quiz = quiz_of(__name__, QUIZ)


def _check_built(path: Path, shown: str) -> None:
    missing = [space for space in MADE_BY_COLCON if not (path / space).is_dir()]
    if not missing and (path / "install" / "setup.bash").is_file():
        return
    if (path / "src" / "install").exists():
        raise CheckError(
            f"build, install and log in {shown}",
            f"install in {shown}/src",
            "colcon builds where you stand: leave src, build there, and remove what lies in src by mistake.",
        )
    raise CheckError(
        f"{shown} has been built: build, install and log, written by colcon",
        _listed(path) if missing else "an install without setup.bash",
        "these three are not made with mkdir.",
        f"cd {shown}, and then which command of two words?",
    )


def _known(environ: dict[str, str], path: Path) -> set[str]:
    """Return the packages below a folder that ROS 2 finds in an environment."""
    prefixes = [Path(part) for part in environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if part]
    return {
        marker.name
        for prefix in prefixes
        if prefix.resolve().is_relative_to(path.resolve())
        for marker in prefix.glob("share/ament_index/resource_index/packages/*")
    }


def _is_same(one: Path, other: Path) -> bool:
    return one.resolve() == other.resolve()


def _listed(path: Path) -> str:
    if not path.is_dir():
        return f"no {course.shown_path(path)}"
    return ", ".join(sorted(entry.name for entry in path.iterdir())) or "an empty folder"
