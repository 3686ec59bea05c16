"""What is typed as an answer to an exercise, as data: read from `answers/`, typed for real, and given to the check.

A file of `answers/` holds the exercises of one lesson:

    begin:                      # named states of the student's folder, each a list of steps; made once and copied
      packed:
        - type: mkdir -p ~/bag_ws/src
      built:                    # goes on from an earlier one
        - packed
        - type: cd ~/bag_ws; colcon build
    exercises:
      second_workspace:         # the name of the check
        begin: packed           # optional
        call: check.second_workspace("~/garden_ws")
        right:
          - answer: made in one line
            type: mkdir -p ~/garden_ws/src; cd ~/garden_ws; colcon build
        wrong:
          - answer: never built
            type: mkdir -p ~/garden_ws/src
            found: only src     # what the check says it found; a text or a list of texts
            hint: colcon build  # what its first hint says

A step is one of

    type: lines                 typed into a new bash whose home is the student's folder; they must succeed
    fail: lines                 the same, and the last of them must fail
    write: {path: text}         a file, with its folders
    edit: {path: [[old, new]]}  replaces every `old`, which must be there
    remove: [path]              a file or a folder
    run: {name: lines}          left running in a terminal of its own until the check has ended
    python: source              a cell of the notebook

An answer has any number of steps, in its own order, or a list of them under `steps`, and may have a `begin` and a
`call` of its own. `make test` types the first right answer to each exercise and the first two wrong ones, so these
stand first because their faults are of different kinds, and none that says `thorough: true`: it builds or starts
something, and its fault is that of another answer, or that nothing was done, which tests/student tries of every
exercise. `make test-all` types all.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from ros2lab import environment
from ros2lab.terminal import magic

FOLDER = Path(__file__).parent / "answers"
STEPS = ("type", "fail", "write", "edit", "remove", "run", "python")
TYPING_TIMEOUT = 300.0  # s, for colcon on a busy machine
# The first of each exercise, in each run of the tests; tests/student gives the lesson's own right answer to each.
TYPED = {"right": 0, "wrong": 2}

Step = tuple[str, Any]


@dataclass(frozen=True)
class Answer:
    """What a student may type as an answer.

    Attributes:
        lesson: the name of the lesson's checks, such as `workspaces`.
        exercise: the name of the check.
        title: what is right or wrong with the answer.
        begin: the steps that make the folder in which the exercise begins.
        steps: the answer itself.
        call: the call of the check, an expression over `check` and what the steps have defined.
        is_right: whether the check must praise it.
        expected: texts that stand in what the check expected.
        found: texts that stand in what the check found.
        hint: texts that stand in its first hint.
        is_thorough: whether only `make test-all` types it.
    """

    lesson: str
    exercise: str
    title: str
    begin: tuple[Step, ...]
    steps: tuple[Step, ...]
    call: str
    is_right: bool
    expected: tuple[str, ...]
    found: tuple[str, ...]
    hint: tuple[str, ...]
    is_thorough: bool

    def __str__(self) -> str:
        verdict = "right" if self.is_right else "wrong"
        return f"{self.lesson}.{self.exercise}: {verdict}: {self.title}"


def lessons() -> list[str]:
    """Return the names of the lessons that have answers."""
    return sorted(path.stem for path in FOLDER.glob("*.yaml"))


def answers(lesson: str) -> list[Answer]:
    """Return the answers to the exercises of a lesson.

    Raises:
        ValueError: if the file holds a key that means nothing.
    """
    text = (FOLDER / f"{lesson}.yaml").read_text(encoding="utf-8")
    content = yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    begins: dict[str, tuple[Step, ...]] = {}
    for name, entries in content.get("begin", {}).items():
        begins[name] = tuple(
            step
            for entry in entries
            for step in (begins[entry] if isinstance(entry, str) else _steps({"steps": [entry]}))
        )
    found = []
    for exercise, entry in content["exercises"].items():
        _refuse_unknown(entry, ("begin", "call", "right", "wrong"), exercise)
        for verdict in ("right", "wrong"):
            for number, row in enumerate(entry.get(verdict, ())):
                where = f"{lesson}.{exercise}: {row.get('answer')}"
                _refuse_unknown(
                    row,
                    ("answer", "begin", "steps", "call", "expected", "found", "hint", "thorough", *STEPS),
                    where,
                )
                begin = row.get("begin", entry.get("begin"))
                found.append(
                    Answer(
                        lesson,
                        exercise,
                        row["answer"],
                        begins[begin] if begin else (),
                        _steps(row),
                        row.get("call", entry.get("call", f"check.{exercise}()")),
                        verdict == "right",
                        *(_texts(row.get(key)) for key in ("expected", "found", "hint")),
                        row.get("thorough", False) or number >= TYPED[verdict],
                    )
                )
    return found


class StudentsFolder:
    """A student's folder in which answers are typed.

    Args:
        home: the folder; made anew for each state that a lesson begins with.
        kept: where those states are kept between the answers.
    """

    def __init__(self, home: Path, kept: Path) -> None:
        self.home, self.kept = home, kept
        self.names: dict[str, Any] = {}

    def begin(self, steps: Sequence[Step]) -> None:
        """Bring the folder into the state that `steps` make; what is built knows the path, which stays the same.

        It goes on from the latest state on the way that is kept.
        """
        if self.home.exists():
            shutil.rmtree(self.home)
        taken = next((count for count in range(len(steps), 0, -1) if self._state(steps[:count]).exists()), 0)
        if taken:
            shutil.copytree(self._state(steps[:taken]), self.home, symlinks=True)
        else:
            self.home.mkdir(parents=True)
        self.take(steps[taken:])
        if taken < len(steps):
            shutil.copytree(self.home, self._state(steps), symlinks=True)

    def _state(self, steps: Sequence[Step]) -> Path:
        return self.kept / hashlib.sha256(json.dumps(steps).encode()).hexdigest()[:16]

    def take(self, steps: Iterable[Step]) -> None:
        """Take steps, one after the other."""
        for kind, value in steps:
            getattr(self, f"_{kind}")(value)

    def end(self) -> None:
        """End what was left running."""
        magic.close_all()

    def _type(self, lines: str) -> None:
        finished = self._bash(lines)
        assert finished.returncode == 0, finished.stdout

    def _fail(self, lines: str) -> None:
        finished = self._bash(lines)
        assert finished.returncode != 0, finished.stdout

    def _bash(self, lines: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            ["bash", "--noprofile", "--norc", "-ec", lines],
            cwd=self.home,
            env={**environment.lab_environment(), "HOME": str(self.home)},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
            timeout=TYPING_TIMEOUT,
        )

    def _write(self, files: Mapping[str, str]) -> None:
        for name, text in files.items():
            path = self._path(name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")

    def _edit(self, files: Mapping[str, Sequence[Sequence[str]]]) -> None:
        for name, changes in files.items():
            text = self._path(name).read_text(encoding="utf-8")
            for old, new in changes:
                assert old in text, f"{old!r} is not in {name}"
                text = text.replace(old, new)
            self._path(name).write_text(text, encoding="utf-8")

    def _remove(self, names: Iterable[str]) -> None:
        for name in names:
            path = self._path(name)
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            else:
                path.unlink()

    def _run(self, programs: Mapping[str, str]) -> None:
        for name, lines in programs.items():
            magic.terminal(name).run(lines.splitlines(), timeout=TYPING_TIMEOUT, in_background=True)

    def _python(self, source: str) -> None:
        exec(compile(source, "<cell>", "exec"), self.names)

    def _path(self, name: str) -> Path:
        return self.home / os.path.normpath(name.removeprefix("~/"))


def _steps(row: Mapping[str, Any]) -> tuple[Step, ...]:
    own = [(key, value) for key, value in row.items() if key in STEPS]
    for step in row.get("steps", ()):
        _refuse_unknown(step, STEPS, str(row))
        own += step.items()
    return tuple(own)


def _texts(value: str | list[str] | None) -> tuple[str, ...]:
    return () if value is None else (value,) if isinstance(value, str) else tuple(value)


def _refuse_unknown(row: Mapping[str, Any], known: Iterable[str], where: str) -> None:
    unknown = set(row) - set(known)
    if unknown:
        raise ValueError(f"{where}: {', '.join(sorted(unknown))} means nothing here.")
