"""The exercises of `02_overlays`."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ros2lab import course, environment
from ros2lab.checks import CheckError, Question, answer_of, exercise, quiz_of
from ros2lab.checks.programs import run
from ros2lab.workspace import Workspace, WorkspaceError

PACKAGE, OTHER = "greeter", "porter"
NEW_WORDS = "version 2"  # what the edited program prints

HOLDS = {"ros": ["rclpy", "greeter"], "team": ["greeter", "porter"], "mine": ["greeter"], "empty": []}
# A package, what was sourced one after the other, and the workspace whose package runs.
RUNS: tuple[tuple[str, list[str], str | None], ...] = (
    ("greeter", ["ros", "team", "mine"], "mine"),
    ("greeter", ["ros", "mine", "team"], "team"),
    ("porter", ["ros", "team", "mine"], "team"),
    ("rclpy", ["ros", "team", "mine"], "ros"),
    ("greeter", ["team", "empty"], "team"),
    ("porter", ["ros", "mine"], None),
    ("greeter", [], None),
)

# What is sourced in each of the three terminals.
ORDERS = {
    "a": ("team_ws/install/local_setup.bash", "mine_ws/install/local_setup.bash"),
    "b": ("mine_ws/install/local_setup.bash", "team_ws/install/local_setup.bash"),
    "c": ("mine_ws/install/setup.bash", "team_ws/install/local_setup.bash"),
}
ORDER_HINTS = {
    "a": "what is sourced last lies on top.",
    "b": "what is sourced last lies on top: it is the team's terminal, and not yours, that counts here.",
    "c": "which workspace does setup.bash source first? And what does it move to source that one again?",
}

QUIZ = (
    Question(
        "a",
        "The list is searched from the top, and the first that has the package is taken.",
        {
            "b": "nothing compares dates: the edited one was the newest in the accident.",
            "c": "did `ros2 run` complain of two?",
        },
    ),
    Question(
        "c",
        "What is in the list already keeps its place; only a new terminal begins a new list.",
        {
            "a": "you have tried that: which text came?",
            "b": "a build writes files; the list belongs to the terminal.",
        },
    ),
    Question(
        "b",
        "setup.bash is written by each build, and names what was sourced in the terminal that built.",
        {
            "a": "the underlay knows nothing of what lies above it.",
            "c": "that one is for the workspace alone; who brings the others?",
        },
    ),
    Question(
        "a",
        "The path of the package that runs tells at once whether it is the one that you edit.",
        {
            "b": "if another copy runs, how often must you build this one?",
            "c": "that is long work, and the other copy would still be on top.",
        },
    ),
)


@exercise
def runs_from(function: Any) -> str:
    """Check that `function` tells from which workspace a package runs.

    Args:
        function: takes a package's name, the workspaces in the order of sourcing, and what packages each
            holds; returns a workspace, or None.

    Raises:
        CheckError: if it tells another one.
    """
    for package, sourced, right in RUNS:
        call = f"runs_from({package!r}, {sourced}, packages)"
        packages = {workspace: list(names) for workspace, names in HOLDS.items()}
        found = answer_of(function, package, list(sourced), packages, call=call)
        if found != right:
            raise CheckError(f"{call} is {right!r}", repr(found), _rule_hint(found, right))
    return "Right: from the top down, the first that has it."


@exercise
def which_runs(answers: Mapping[str, str]) -> str:
    """Check a prediction: the workspace whose `greeter` runs in each of three terminals.

    The terminals are really opened, and the files sourced.

    Args:
        answers: a workspace for each letter, such as `"team_ws"`.

    Raises:
        CheckError: at the first letter that is missing or wrong.
    """
    if not isinstance(answers, Mapping):
        raise CheckError("a dictionary", repr(answers), 'write {"a": "...", "b": "...", "c": "..."}.')
    chosen = {str(letter).strip().lower(): _workspace(answer) for letter, answer in answers.items()}
    for letter, files in ORDERS.items():
        if letter not in chosen:
            raise CheckError(
                f"an answer for terminal {letter}", f"answers for {sorted(chosen)}", "there are three."
            )
        if chosen[letter] not in ("team_ws", "mine_ws"):
            raise CheckError('"team_ws" or "mine_ws"', repr(answers), "give the name of a workspace.")
        prefix = _found(_sourced([course.student_path(file) for file in files]), PACKAGE)
        if prefix is None or course.student_path(chosen[letter]).resolve() not in prefix.resolve().parents:
            raise CheckError(
                f"the workspace whose {PACKAGE} runs in terminal {letter}",
                repr(chosen[letter]),
                f"open a new terminal and try: source ~/{files[0]}, then source ~/{files[1]}.",
                ORDER_HINTS[letter],
            )
    return "Right: it was tried in three new terminals."


@exercise
def accident_mended(base: str, trial: str) -> str:
    """Check that the edited `greeter` of `base` runs where `trial` is sourced, and `porter` of `trial` as well.

    Args:
        base: the lower workspace, as the lab's terminals write it.
        trial: the upper one.

    Raises:
        CheckError: if another one runs, or none, or if the next build would hide it again.
    """
    lower, upper = course.student_path(base), course.student_path(trial)
    try:
        environ = Workspace(upper).overlay
        is_still_built = PACKAGE in [package.name for package in Workspace(upper).packages()]
    except WorkspaceError as error:
        raise CheckError(
            f"{course.shown_path(upper)} is a workspace that is built", str(error), "source what, then build?"
        ) from None
    _check_place(environ, PACKAGE, lower)
    _check_place(environ, OTHER, upper)
    words = _words(environ, "hello")
    if NEW_WORDS not in words:
        raise CheckError(
            f"{PACKAGE} of {course.shown_path(lower)} says {NEW_WORDS!r}",
            repr(words),
            f"is {course.shown_path(lower)} built since the edit?",
        )
    if is_still_built:
        raise CheckError(
            f"{course.shown_path(upper)}/src holds no {PACKAGE} that colcon builds",
            f"it does, so that the next build hides {course.shown_path(lower)} again",
            "delete the old copy, or keep colcon away from it with an empty file COLCON_IGNORE.",
        )
    return "Right: the copy that you edit is the one that runs."


quiz = quiz_of(__name__, QUIZ)


def _rule_hint(found: Any, right: str | None) -> str:
    if right is None:
        return "None means that no workspace that was sourced holds the package."
    if found is None:
        return "the function needs a return that is reached as soon as a workspace holds the package."
    return "what was sourced last lies on top, and is looked at first: reversed() helps."


def _workspace(answer: Any) -> str:
    """Return an answer as a workspace's name: `~/team_ws/`, `Team_ws` and `team` are the same."""
    name = str(answer).strip().rstrip("/").rpartition("/")[2].lower()
    return name if name.endswith("_ws") else f"{name}_ws"


def _sourced(files: Sequence[Path]) -> dict[str, str]:
    """Return the environment of a new bash that has sourced files one after the other."""
    for file in files:
        if not file.is_file():
            raise CheckError(
                f"a file {course.shown_path(file)}",
                "none",
                "run the cells above that build ~/team_ws and ~/mine_ws.",
            )
    lines = 'while [ $# -gt 0 ]; do source "$1"; shift; done >&2; env -0'
    finished = run(["bash", "--noprofile", "--norc", "-c", lines, "bash", *files], "a new terminal")
    return environment.parse_environment(finished.stdout.encode())


def _found(environ: Mapping[str, str], package: str) -> Path | None:
    """Return the first prefix that holds a package."""
    prefixes = [Path(part) for part in environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if part]
    marker = Path("share", "ament_index", "resource_index", "packages", package)
    return next((prefix for prefix in prefixes if (prefix / marker).is_file()), None)


def _check_place(environ: Mapping[str, str], package: str, workspace: Path) -> None:
    prefix = _found(environ, package)
    if prefix is None:
        raise CheckError(
            f"{package} is known after sourcing ~/trial_ws/install/setup.bash",
            "it is not",
            "what does setup.bash remember, and was it sourced in the terminal that built?",
            "source ~/base_ws/install/setup.bash in a new terminal, and build ~/trial_ws there.",
        )
    if workspace.resolve() not in prefix.resolve().parents:
        raise CheckError(
            f"{package} runs from {course.shown_path(workspace)}",
            f"it runs from {course.shown_path(prefix)}",
            "where does ros2 pkg prefix find it, what lies there, and who put it there?",
            "what is deleted from src stays in install: a package has a folder in build and install, too.",
        )


def _words(environ: Mapping[str, str], program: str) -> str:
    """Return what a program of the package prints."""
    file = Path(_found(environ, PACKAGE) or "", "lib", PACKAGE, program)
    finished = run([file], f"{PACKAGE}'s {program}", environ=environ)
    return (finished.stdout + finished.stderr).strip()
