"""The exercises of `01_workspaces`."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from ros2lab import course
from ros2lab.checks import CheckError, Prediction, Question, exercise, predict_of, quiz_of
from ros2lab.checks.programs import check_last_build, overlay_of
from ros2lab.diagnose.spelling import nearest
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

QUIZ = (
    Question(
        "Which spaces may be deleted at any time?",
        ("all four", "none of them", "all but `src`"),
        "c",
        "colcon makes build, install and log from src at any time; nothing makes src again.",
        {
            "a": "can colcon write a program again that you have deleted?",
            "b": "you deleted some of them in this lesson: what did the next build do?",
        },
    ),
    Question(
        (
            "In terminal 1 `ros2 run greeter hello` works; in a new terminal it says `Package 'greeter'"
            " not found`. Why?"
        ),
        (
            "The new terminal has not sourced the workspace.",
            "The new terminal is in the wrong folder.",
            "The package is not built.",
        ),
        "a",
        "Each shell has variables of its own, and sourcing changes only those of the shell that sources.",
        {
            "c": "would the first terminal run the package if it were not built?",
            "b": "ROS 2 does not look at the folder in which you are: where does it look?",
        },
    ),
    Question(
        "What does `setup.bash` do that `local_setup.bash` does not?",
        (
            "It also holds in terminals that are opened later.",
            "It also sources what was sourced when the workspace was built.",
            "It builds what has changed.",
        ),
        "b",
        "setup.bash first sources the workspaces that were sourced during the build, then local_setup.bash.",
        {
            "a": "both hold until the shell ends: what did setup.bash of upper_ws bring along?",
            "c": "neither builds anything: both only set variables.",
        },
    ),
    Question(
        "Where are you when you type `colcon build`?",
        ("in `src`", "in the home folder", "in the workspace"),
        "c",
        "colcon makes the three spaces in the folder where you are, so be in the workspace.",
        {
            "a": "look at the prompt of a cell that built: does its folder end with src?",
            "b": "then build, install and log would be in the middle of all your other folders.",
        },
    ),
)

PREDICTIONS = {
    "empty_build": Prediction(
        "There is no package yet. Is that an error? And what will there be beside `src` afterwards?",
        (
            "it is an error, and nothing is made",
            "no error, and nothing is made",
            "no error, and there will be `build`, `install` and `log`",
        ),
        "c",
        (
            "It is no error: colcon had nothing to build, and has made the folders `build`, `install` "
            "and `log` for the packages to come."
        ),
    ),
    "where_is_greeter": Prediction(
        "Which of the four spaces will have a folder `greeter`?",
        ("all four", "`src`, `build` and `install`", "only `install`", "`src` and `install`"),
        "b",
        "Three of them: `src`, `build` and `install`. (`log` has one folder for each build.)",
    ),
    "not_sourced": Prediction(
        "The package is built, and the terminal is in its workspace. Does the program run?",
        (
            "yes: it is built",
            "yes: the terminal is in the right folder",
            "no: ROS 2 does not find the package",
        ),
        "c",
        "It does not: ROS 2 does not find the package.",
    ),
    "ros_distro": Prediction(
        "What does `ROS_DISTRO` hold in this terminal?",
        ("nothing", "`jazzy`", "the path of `~/ros2_ws`"),
        "a",
        "Nothing: your workspace does not set it, and there is no installed ROS 2 that does.",
    ),
    "second_terminal": Prediction(
        "The workspace is built, and terminal 1 has sourced it. Does terminal `two` know the package?",
        ("yes: the package is built", "no: it has sourced nothing", "yes: terminal 1 has told it"),
        "b",
        "No. Variables belong to one shell, and this is a new one, which has read nothing.",
    ),
    "local_setup": Prediction(
        (
            "What will be in the list of a new terminal that sources `local_setup.bash` of `upper_ws`? "
            "And after it sources `setup.bash`?"
        ),
        (
            "`upper_ws`, both times",
            "nothing at first, and then `greeter` of `~/ros2_ws`",
            "`greeter` of `~/ros2_ws`, both times",
            "nothing, both times",
        ),
        "b",
        (
            "First nothing, for `local_setup.bash` is about this workspace alone. Then the package of "
            "another workspace."
        ),
    ),
    "bashrc_new_terminal": Prediction(
        "Does terminal `three`, which does not exist yet, know the package?",
        (
            "yes: its bash reads `.bashrc` when it starts",
            "no: nobody has sourced anything in it",
            "only in the folder `~/ros2_ws`",
        ),
        "a",
        (
            "It does: its bash read the line when it started. A terminal that was open before would not"
            " know of the line."
        ),
    ),
    "bashrc_removed": Prediction(
        "Does a new terminal, `four`, know the package? And does terminal `three` still know it?",
        (
            "both know it",
            "neither knows it",
            "`three` knows it, `four` does not",
            "`four` knows it, `three` does not",
        ),
        "c",
        (
            "The new one does not. Terminal `three` still does: it read the line long ago, and keeps "
            "its variables."
        ),
    ),
    "bring_back": Prediction(
        "What does it take to get the others back?",
        ("a build", "nothing can bring them back", "a new package"),
        "a",
        "One build, and all is as before.",
    ),
    "source_removed": Prediction(
        "`old_toy` has no source any more. Does it run?",
        ("no: without its source nothing runs", "no: the build has noticed", "yes: from `install`"),
        "c",
        "It runs, from `install`.",
    ),
}


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
