"""The exercises of `02_overlays`."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ros2lab import course, environment
from ros2lab.checks import CheckError, answer_of, exercise, predict_of, questions_of, quiz_of
from ros2lab.checks.programs import check_last_build, run
from ros2lab.workspace import Workspace, WorkspaceError

PACKAGE, OTHER = "greeter", "porter"
NEW_WORDS = "version 2"  # in what the edited program prints
TEAM, MINE = "team_ws", "mine_ws"

HOLDS = {"ros": ["rclpy", "greeter"], "team": ["greeter", "porter"], "mine": ["greeter"], "empty": []}
# A package, what was sourced one after the other, and the workspace whose package runs.
RUNS: tuple[tuple[str, list[str], str | None], ...] = (
    ("greeter", ["team"], "team"),
    ("greeter", ["team", "empty"], "team"),
    ("greeter", ["ros", "team", "mine"], "mine"),
    ("greeter", ["ros", "mine", "team"], "team"),
    ("porter", ["ros", "team", "mine"], "team"),
    ("rclpy", ["ros", "team", "mine"], "ros"),
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
    "a": "what is sourced last lies on top: which of the two is that here?",
    "b": "what is sourced last lies on top, whoever it belongs to: which of the two is that here?",
    "c": "setup.bash of mine_ws has sourced team_ws before mine_ws: does sourcing team_ws again move it?",
}


@exercise
def runs_from(function: Any) -> str:
    """Check that `function` returns the workspace from which a package runs.

    Args:
        function: takes a package's name, the workspaces in the order of sourcing, and what packages each
            holds; returns a workspace, or None.

    Raises:
        CheckError: if it returns another one.
    """
    for package, sourced, right in RUNS:
        call = f"runs_from({package!r}, {sourced}, packages)"
        packages = {workspace: list(names) for workspace, names in HOLDS.items()}
        found = answer_of(function, package, list(sourced), packages, call=call)
        if found != right:
            raise CheckError(f"{call} is {right!r}", repr(found), _rule_hint(found, package, sourced, right))
    return "Right: from the top down, the first workspace that has it."


@exercise
def which_runs(answers: Mapping[str, str]) -> str:
    """Check a prediction: the workspace whose `greeter` runs in each of three terminals.

    The terminals are really opened, and the files sourced.

    Args:
        answers: a workspace for each letter, such as `"team_ws"`.

    Raises:
        CheckError: at the first letter that is missing or wrong, or if the workspaces are not as the lesson
            has built them.
    """
    if not isinstance(answers, Mapping):
        raise CheckError("a dictionary", repr(answers), 'write {"a": "...", "b": "...", "c": "..."}.')
    chosen = {str(letter).strip().lower(): _workspace(answer) for letter, answer in answers.items()}
    for workspace in (TEAM, MINE):
        _check_prepared(workspace)
    for letter, files in ORDERS.items():
        if letter not in chosen:
            raise CheckError(
                f"an answer for terminal {letter}",
                f"answers for {', '.join(sorted(chosen)) or 'none'}",
                f'there are three terminals: add a line "{letter}": "...".',
            )
        if chosen[letter] not in (TEAM, MINE):
            raise CheckError(
                f'"{TEAM}" or "{MINE}" for terminal {letter}',
                repr(answers),
                "write the name of a workspace, not that of a package.",
            )
        prefix = _found(_sourced([course.student_path(file) for file in files]), PACKAGE)
        if prefix is None or course.student_path(chosen[letter]).resolve() not in prefix.resolve().parents:
            raise CheckError(
                f"the workspace whose {PACKAGE} runs in terminal {letter}",
                repr(chosen[letter]),
                ORDER_HINTS[letter],
                f"open a new terminal and try: source ~/{files[0]}, then source ~/{files[1]}.",
            )
    return "Right: the check tried it in three new terminals."


@exercise
def accident_fixed(base: str, trial: str) -> str:
    """Check that the edited `greeter` of `base` runs where `trial` is sourced, and `porter` of `trial` as well.

    Args:
        base: the lower workspace, as the lab's terminals write it.
        trial: the upper one.

    Raises:
        CheckError: if another one runs, or none, or if the next build would hide it again.
    """
    lower, upper = Workspace(course.student_path(base)), Workspace(course.student_path(trial))
    shown = course.shown_path(upper.path)
    try:
        environ = upper.overlay
        is_still_built = PACKAGE in [package.name for package in upper.packages()]
    except WorkspaceError as error:
        raise CheckError(
            f"{shown} is a workspace that is built",
            str(error),
            f"in a new terminal source {course.shown_path(lower.path)}/install/setup.bash, then build {shown}.",
        ) from None
    for package, workspace in ((PACKAGE, lower), (OTHER, upper)):
        _check_place(environ, package, workspace.path, upper.path)
    check_last_build(lower)
    words = _words(environ, "hello")
    if NEW_WORDS not in words:
        raise CheckError(
            f"{PACKAGE} of {course.shown_path(lower.path)} prints {NEW_WORDS!r}",
            repr(words),
            _why_old(lower.path),
        )
    if is_still_built:
        raise CheckError(
            f"{shown}/src holds no {PACKAGE} that colcon builds",
            f"`colcon list` shows it, so that the next build hides {course.shown_path(lower.path)} again",
            "delete this copy from src, too, or keep colcon away from it with an empty file COLCON_IGNORE in it.",
        )
    return "Right: the copy that you edit is the one that runs."


QUIZ, PREDICTIONS = questions_of(__name__)
quiz = quiz_of(__name__, QUIZ)
predict = predict_of(__name__, PREDICTIONS)


def _rule_hint(found: Any, package: str, sourced: Sequence[str], right: str | None) -> str:
    if right is None:
        return "return None where no workspace that was sourced holds the package."
    if found is None:
        return (
            "look at every workspace that was sourced before you return None."
            if len(sourced) > 1
            else "return the workspace that holds the package: is that line reached?"
        )
    if not isinstance(found, str):
        return "return the name of one workspace."
    if found not in sourced:
        return (
            "only a workspace that was sourced counts: look through `sourced`, not through all of `packages`."
        )
    if package not in HOLDS[found]:
        return f"{found} does not hold {package}: ask `packages` before you return a workspace."
    return "what was sourced last lies on top: look through `sourced` from its end, with reversed()."


def _workspace(answer: Any) -> str:
    """Return an answer as a workspace's name: `~/team_ws/`, `Team_ws` and `team` are the same."""
    name = str(answer).strip().rstrip("/").rpartition("/")[2].lower()
    return name if name.endswith("_ws") else f"{name}_ws"


def _check_prepared(workspace: str) -> None:
    """Check that a workspace is there with its `greeter`, so that no prediction is blamed for what is missing."""
    install = course.student_path(workspace) / "install"
    if not (install / "setup.bash").is_file():
        raise CheckError(
            f"~/{workspace} is built",
            f"no ~/{workspace}/install/setup.bash",
            f"run the cells above that build ~/{workspace}.",
        )
    if not _installed(install, PACKAGE):
        raise CheckError(
            f"a {PACKAGE} in ~/{workspace}",
            f"none in ~/{workspace}/install",
            f"build ~/{workspace} once more, as above.",
        )


def _installed(install: Path, package: str) -> bool:
    """Return whether a package is installed here, in a folder of its own or in a merged one."""
    return any(_holds(prefix, package) for prefix in (install, install / package))


def _holds(prefix: Path, package: str) -> bool:
    return (prefix / "share" / "ament_index" / "resource_index" / "packages" / package).is_file()


def _sourced(files: Sequence[Path]) -> dict[str, str]:
    """Return the environment of a new bash that has sourced files one after the other."""
    lines = 'while [ $# -gt 0 ]; do source "$1"; shift; done >&2; env -0'
    finished = run(["bash", "--noprofile", "--norc", "-c", lines, "bash", *files], "a new terminal")
    return environment.parse_environment(finished.stdout.encode())


def _found(environ: Mapping[str, str], package: str) -> Path | None:
    """Return the first prefix that holds a package."""
    prefixes = [Path(part) for part in environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if part]
    return next((prefix for prefix in prefixes if _holds(prefix, package)), None)


def _check_place(environ: Mapping[str, str], package: str, workspace: Path, sourced: Path) -> None:
    """Check that a package is found in a workspace by a terminal that has sourced another one, or the same."""
    prefix, where, top = _found(environ, package), course.shown_path(workspace), course.shown_path(sourced)
    if prefix is None:
        expected = f"{package} is known after `source {top}/install/setup.bash`"
        if not _installed(workspace / "install", package):
            raise CheckError(
                expected, f"no {package} in {where}/install", f"build {where} again, which must hold it."
            )
        raise CheckError(
            expected,
            f"{package} is in {where}/install, and this setup.bash does not source {where}",
            f"it sources what was sourced in the terminal that built {top}: open a new terminal, source "
            f"{where}/install/setup.bash there, and build {top}.",
        )
    if workspace.resolve() in prefix.resolve().parents:
        return
    copies = [
        f"{space}/{package}" for space in ("src", "build", "install") if (sourced / space / package).exists()
    ]
    raise CheckError(
        f"{package} runs from {where}",
        f"it runs from {course.shown_path(prefix)}",
        f"delete {', '.join(copies)} of {top}: this copy hides the one that you edit."
        if sourced.resolve() in prefix.resolve().parents and copies
        else f"build {top} in a new terminal that has sourced {where}/install/setup.bash and nothing else.",
    )


def _why_old(workspace: Path) -> str:
    """Return a hint for an edited package that prints the old words: whether it was built since."""
    source, shown = workspace / "src" / PACKAGE, course.shown_path(workspace)
    edited = max((file.stat().st_mtime for file in source.rglob("*.py")), default=0.0)
    built = workspace / "build" / PACKAGE / "colcon_build.rc"
    if built.is_file() and edited > built.stat().st_mtime:
        return f"build {shown}: its src/{PACKAGE} has changed since its last build."
    return f"run the cell again that edits hello.py, and build: {shown} is built from its src as that is now."


def _words(environ: Mapping[str, str], program: str) -> str:
    """Return what a program of the package prints."""
    file = Path(_found(environ, PACKAGE) or "", "lib", PACKAGE, program)
    finished = run([file], f"{PACKAGE}'s {program}", environ=environ)
    return (finished.stdout + finished.stderr).strip()
