"""The student edition: the worked notebooks without their solutions and outputs, and how it reaches a student.

A student's folder holds a record of what was delivered. What has not been changed since is replaced by a newer
release; what has been is the student's, and the newer one is put beside it.
"""

from __future__ import annotations

import copy
import hashlib
import itertools
import json
import os
import re
from pathlib import Path
from typing import Any, NamedTuple

from ros2lab import course

STUB = "# Write here."
RECORD = ".edition.json"
_COPY = ".~"  # before the name of what Jupyter is writing

_BEGIN = "### BEGIN SOLUTION"
_TASK = re.compile(r"^\*\*Task", re.MULTILINE)
_MARKS = re.compile(r"^[ \t]*### (?:BEGIN|END) SOLUTION\n?", re.MULTILINE)


class Delivery(NamedTuple):
    """What a delivery did, by the notebooks' names.

    Attributes:
        new: were not there.
        renewed: were there as an earlier release had delivered them.
        kept: are as they were.
        beside: have changed in the release and by the student; the new one lies beside it under another name.
    """

    new: list[str]
    renewed: list[str]
    kept: list[str]
    beside: dict[str, str]


def student_edition(notebook: Any) -> Any:
    """Return a copy of a worked notebook with a comment instead of each solution, and without outputs.

    Args:
        notebook: an nbformat 4 notebook; solutions stand between `### BEGIN SOLUTION` and `### END SOLUTION`.

    Raises:
        RuntimeError: if a solution does not end.
    """
    # Takes a second or two to import, for which only a new release waits.
    from nbconvert.preprocessors import ClearOutputPreprocessor  # noqa: PLC0415
    from nbgrader.preprocessors import ClearSolutions  # noqa: PLC0415
    from traitlets.config import Config  # noqa: PLC0415

    config = Config({"ClearSolutions": {"code_stub": {"python": STUB}, "enforce_metadata": False}})
    result, resources = ClearSolutions(config=config).preprocess(copy.deepcopy(notebook), {})
    result, _ = ClearOutputPreprocessor().preprocess(result, resources)
    return result


def solution(lesson: str, exercise: str) -> list[str]:
    """Return the cells of the worked notebook in which an exercise is solved, without the marks around the solutions.

    They belong to the task above the check; without a task, the last cell with a solution is taken. A quiz has none:
    each of its wrong answers has a hint.

    Args:
        lesson: the name of the lesson's checks, such as `workspaces`.
        exercise: the name of the check.
    """
    path = next((path for path in course.notebooks() if path.stem.partition("_")[2] == lesson), None)
    if path is None or exercise == "quiz":
        return []
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    kinds = [(cell["cell_type"], "".join(cell["source"])) for cell in cells]
    opening = f"check.{exercise}("
    check = next((at for at, (_, source) in enumerate(kinds) if source.startswith(opening)), -1)
    solved: list[str] = []
    end = check + 1
    while end and not solved:  # a check without an answer of its own rests on the one before it
        begin = next((at + 1 for at in reversed(range(end - 1)) if _is_check(*kinds[at])), 0)
        solved = _solved(kinds[begin:end])
        end = begin
    return [_MARKS.sub("", source).strip() for source in solved]


def _solved(cells: list[tuple[str, str]]) -> list[str]:
    """Return the sources with a solution from the first task on; without a task, the last one."""
    tasks = (at for at, (kind, source) in enumerate(cells) if kind == "markdown" and _TASK.search(source))
    task = next(tasks, None)
    solved = [source for kind, source in cells[task or 0 :] if kind == "code" and _BEGIN in source]
    return solved if task is not None else solved[-1:]


def _is_check(kind: str, source: str) -> bool:
    return kind == "code" and source.startswith("check.") and not source.startswith("check.predict(")


def deliver(folder: Path) -> Delivery:
    """Bring the student edition into a folder.

    Args:
        folder: where the notebooks are to lie; it need not exist.

    Raises:
        OSError: if a file cannot be written.
    """
    record = _read(folder / RECORD)
    before = json.dumps(record)
    done = Delivery([], [], [], {})
    try:
        for path in course.notebooks():
            _deliver(path, folder / path.name, record, done)
    finally:  # what was delivered before Ctrl-C is known the next time
        if json.dumps(record) != before:
            course.write_whole(folder / RECORD, (json.dumps(record, indent=1) + "\n").encode())
    return done


def restore(folder: Path) -> list[str]:
    """Return the notebooks in a folder whose saving a kill or a power cut has ended, once they are as before it.

    JupyterLab copies a notebook to a hidden file, writes it anew in its place, and removes the copy. Where the copy is
    still there, what was written is kept in `~/earlier`, unless it is whole.

    Raises:
        OSError: if a file cannot be moved.
    """
    restored = []
    for copied in sorted(folder.rglob(f"{_COPY}*.ipynb")):
        notebook = copied.with_name(copied.name.removeprefix(_COPY))
        if not _is_whole(copied):  # the kill came first
            continue
        if not _is_whole(notebook):
            if notebook.exists():
                course.keep_earlier(notebook, is_moved=True)
            course.rename_kept(copied, notebook)
            restored.append(notebook.name)
        else:
            copied.unlink()
    return restored


def _is_whole(notebook: Path) -> bool:
    kept = course.read_json(notebook)
    return isinstance(kept, dict) and "cells" in kept


def _deliver(source: Path, target: Path, record: dict[str, dict[str, str]], done: Delivery) -> None:
    """Deliver one notebook, and note that in `record` and `done`."""
    release, name = _hash(source.read_bytes()), target.name
    known = record.get(name, {})
    is_there = os.path.lexists(target)
    if target.is_symlink() or (is_there and known.get("release") == release):
        done.kept.append(name)  # a link is the student's own doing
        return
    edition = _as_bytes(source)
    if not is_there:
        done.new.append(name)
    elif target.read_bytes() == edition:
        done.kept.append(name)
    elif _hash(target.read_bytes()) == known.get("delivered"):
        done.renewed.append(name)
    else:
        target = _free_name(target)
        done.beside[name] = target.name
    course.write_whole(target, edition)
    record[name] = {"release": release, "delivered": _hash(edition)}


def _free_name(path: Path) -> Path:
    """Return a name beside `path` under which nothing lies yet."""
    names = (path.with_name(f"{path.stem} (new {number}).ipynb") for number in itertools.count(1))
    return next(name for name in names if not os.path.lexists(name))


def _as_bytes(source: Path) -> bytes:
    import nbformat  # noqa: PLC0415

    text: str = nbformat.writes(student_edition(nbformat.read(source, as_version=4)))
    return f"{text.rstrip()}\n".encode()


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _read(file: Path) -> dict[str, dict[str, str]]:
    """Return the record; an empty one where there is none, or none that can be read."""
    record = course.read_json(file)
    if not isinstance(record, dict):
        return {}
    return {name: entry for name, entry in record.items() if isinstance(entry, dict)}
