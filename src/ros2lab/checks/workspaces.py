"""The exercises of `01_workspaces`."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from ros2lab import course
from ros2lab.checks import CheckError, exercise, predict_of, questions_of, quiz_of
from ros2lab.checks.programs import check_last_build, overlay_of
from ros2lab.diagnose.sources.spelling import nearest
from ros2lab.workspace import Workspace

MADE_BY_COLCON = ("build", "install", "log")
KEPT, GONE = "greeter", "old_toy"  # the packages of the exercise with the left-over one

# What is said to somebody who wrongly chose, or left out, a terminal.
TERMINALS = {
    "a": "cd changes no variable: does ROS 2 look in the folder where you are, or in AMENT_PREFIX_PATH?",
    "b": "what was sourced stays in its shell, wherever you go from there.",
    "c": "bash reads the file in a shell of its own, which then ends: what is left of its variables?",
    "d": "a build writes files; which line reads them into the terminal?",
    "e": "local_setup.bash leaves out other workspaces, but does it leave out its own?",
    "f": "a shell hands its variables on to what it starts, and that may be another shell.",
}
KNOWING = frozenset("bef")


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
    _check_folder(path, shown)
    if not (path / "src").is_dir():
        raise CheckError(
            f"{shown}/src", _listed(path), f"src is the space that you make yourself: `mkdir {shown}/src`."
        )
    _check_built(path, shown)
    check_last_build(Workspace(path))
    sourced = overlay_of(Workspace(path)).get("COLCON_PREFIX_PATH", "").split(os.pathsep)
    if not any(Path(prefix).resolve() == (path / "install").resolve() for prefix in sourced if prefix):
        raise CheckError(
            f"sourcing {shown}/install/setup.bash adds {shown}/install to COLCON_PREFIX_PATH",
            "it does not",
            f"only colcon writes this file: delete {shown}/install and build again.",
        )
    praise = "Right: you made src, and colcon made build, install and log."
    left = next((place for place in _built_beside(path) if place.startswith(f"{shown}/")), None)
    return f"{praise} Those in {left} are of another build: delete them there." if left else praise


@exercise
def knows_the_package(*letters: str) -> str:
    """Check the letters of the terminals that know the package; order and capitals do not matter.

    Args:
        letters: one a terminal.

    Raises:
        CheckError: at the first letter that is wrong or missing.
    """
    chosen = {character for character in "".join(map(str, letters)).lower() if character.isalnum()}
    if not chosen:
        raise CheckError("some letters from a to f", "none", "which of them have sourced the workspace?")
    for letter in sorted(chosen - KNOWING):
        hint = TERMINALS.get(letter, "the terminals are called a to f.")
        raise CheckError("only terminals that know greeter", repr(letter), hint)
    for letter in sorted(KNOWING - chosen):
        found = f"only {', '.join(sorted(chosen))}"
        raise CheckError("all the terminals that know greeter", found, f"one is missing: {TERMINALS[letter]}")
    return "Right: a terminal knows what it has sourced, or inherited from the shell that started it."


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
            f"colcon cannot make src again: copy the package back from ~/ros2_ws/src/{KEPT}.",
        )
    if (path / "src" / GONE).exists():
        raise CheckError(
            f"no {GONE} in {shown}/src",
            f"{shown}/src/{GONE}",
            f"delete src/{GONE}: what is in src is built again.",
        )
    _check_built(path, shown)
    check_last_build(Workspace(path))
    _check_gone(path, shown)
    if KEPT not in _known(path):
        raise CheckError(
            f"{KEPT} is known in a new terminal after `source {shown}/install/setup.bash`",
            *_why_unknown(path, shown),
        )
    return "Right: install holds what src holds, and nothing else."


QUIZ, PREDICTIONS = questions_of(__name__)
quiz = quiz_of(__name__, QUIZ)
predict = predict_of(__name__, PREDICTIONS)


def _check_folder(path: Path, shown: str) -> None:
    if path.is_dir():
        return
    if path.exists():
        raise CheckError(
            f"a folder {shown}", "a file", f"delete the file with `rm {shown}`; mkdir makes a folder."
        )
    alike = _folder_like(path)
    if alike is None:
        raise CheckError(
            f"a folder {shown}", "none", f"make it together with its src: `mkdir -p {shown}/src`."
        )
    raise CheckError(
        f"a folder {shown}",
        f"{alike}, and none of that name",
        f"give it the right name and place with `mv {alike} {shown}`, and build it there.",
    )


def _folder_like(path: Path) -> str | None:
    """Return a folder of the student's whose name is like that of a path, or which has it at another place."""
    home, put_aside = course.work_folder(), course.earlier_folder()
    places = {
        folder.name: folder
        for folder in (*home.glob("*/*"), *home.glob("*"))  # the upper ones come last, and win
        if folder.is_dir() and put_aside not in (folder, folder.parent)
    }
    name = path.name if path.name in places else nearest(path.name, places)
    return course.shown_path(places[name]) if name else None


def _check_built(path: Path, shown: str) -> None:
    missing = [space for space in MADE_BY_COLCON if not (path / space).is_dir()]
    if not missing and (path / "install" / "setup.bash").is_file():
        return
    elsewhere = next(_built_beside(path), None)
    if elsewhere is not None:
        raise CheckError(
            f"build, install and log in {shown}",
            f"{elsewhere}/install, and in {shown} only {_listed(path)}",
            f"colcon builds where the terminal is: `cd {shown}`, build there, and delete build, install and log "
            f"from {elsewhere}.",
        )
    if missing:
        raise CheckError(
            f"build, install and log in {shown}",
            _listed(path),
            f"type `cd {shown}`, and then `colcon build`.",
        )
    raise CheckError(
        f"{shown}/install/setup.bash, which colcon writes",
        "an install without setup.bash",
        "build, install and log are not made with mkdir: delete them, and type `colcon build`.",
    )


def _built_beside(path: Path) -> Iterator[str]:
    """Find where something was built above a workspace, or in its src."""
    above = [folder for folder in path.parents if folder.is_relative_to(course.work_folder())]
    for folder in (path / "src", *sorted(path.glob("src/*")), *above):
        if (folder / "install" / ".colcon_install_layout").is_file():
            yield course.shown_path(folder)


def _check_gone(path: Path, shown: str) -> None:
    left = [f"{space}/{GONE}" for space in ("build", "install") if (path / space / GONE).exists()]
    if left:
        raise CheckError(
            f"nothing of {GONE} in {shown}",
            ", ".join(left),
            f"colcon build only adds: delete {' and '.join(left)}, or all that colcon has made, and build again.",
        )
    if GONE in _known(path):
        raise CheckError(
            f"nothing of {GONE} in {shown}",
            f"{GONE} is known after sourcing",
            "packages share the folders of a merged install: delete build, install and log, and build again.",
        )


def _known(path: Path) -> set[str]:
    """Return the packages of a workspace that a new terminal knows after sourcing it."""
    listed = overlay_of(Workspace(path)).get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return {
        marker.name
        for prefix in map(Path, filter(None, listed))
        if prefix.resolve().is_relative_to(path.resolve())
        for marker in prefix.glob("share/ament_index/resource_index/packages/*")
    }


def _why_unknown(path: Path, shown: str) -> tuple[str, str]:
    """Return what is seen of a package whose source is there but which is not known, and a hint."""
    source = path / "src" / KEPT
    if (source / "COLCON_IGNORE").exists():
        hidden = f"{shown}/src/{KEPT}/COLCON_IGNORE"
        return hidden, f"colcon leaves such a folder out: delete {hidden}, and build again."
    return (
        f"in {shown}/install: {_listed(path / 'install')}",
        f"{KEPT} is not installed there: `cd {shown}`, and then `colcon build`.",
    )


def _listed(path: Path) -> str:
    if not path.is_dir():
        return f"no {course.shown_path(path)}"
    names = sorted(entry.name for entry in path.iterdir() if not entry.name.startswith("."))
    return ", ".join(names) or "an empty folder"
