"""One submission of a class, from paths to what was seen of it, in a process of its own.

`seen` is the one place in which the judge is asked. `graded_apart` runs it in another process, so that a crash, a hang
or a leak of one grading is one row of the class; this process ends when the one that started it does.
"""

from __future__ import annotations

import ast
import contextlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path, PurePosixPath
from typing import Any

from ros2lab import environment
from ros2lab.classroom.gradebook import Seen

MOST_SOURCE = 1_000_000  # bytes of Python that are kept
NO_PYTHON = (SyntaxError, ValueError, RecursionError, MemoryError)
COMMAND = [sys.executable, "-m", "ros2lab.classroom.one"]
TOO_LONG = 3600.0  # s; each part of a grading has limits of its own, which come to less (26 min were reached)

Show = Callable[[str], None]


class GradingFailed(Exception):  # noqa: N818 -- no fault of the submission's
    """The grader has failed at one submission; the message is one sentence."""


class CannotGrade(Exception):  # noqa: N818
    """This machine cannot grade any submission; the message is one sentence."""


def refusal() -> str:
    """Return why this machine can grade no submission at all, in a sentence; empty if it can grade."""
    from ros2lab.grading.sandbox.box import SandboxMissing  # noqa: PLC0415
    from ros2lab.grading.sandbox.worlds import World  # noqa: PLC0415

    try:
        with World() as world:
            world.run(["true"])
    except SandboxMissing as error:
        return str(error)
    return ""


def seen(
    paths: Sequence[Path],
    assignment: Path | None,
    show: Show,
    *,
    has_sandbox: bool = True,
    is_alone: bool = True,
) -> Seen:
    """Return what is seen of a submission.

    Args:
        paths: a folder, an archive, or loose files.
        assignment: the folder of what was asked for; None for the course's own.
        show: told what is being done.
        has_sandbox: False lets it do whatever the user who grades can.
        is_alone: whether no other submission is graded at the same time on this machine.

    Raises:
        SandboxMissing: if this machine cannot run it safely.
        RuntimeError: if colcon or ROS cannot be used.
    """
    from ros2lab import assignments  # noqa: PLC0415 -- only the process that grades needs the judge
    from ros2lab.classroom.discovery import project_in  # noqa: PLC0415
    from ros2lab.grading.collect import collect, nothing  # noqa: PLC0415
    from ros2lab.grading.evidence_json import evidence_json  # noqa: PLC0415
    from ros2lab.grading.receiving.clean_copy import SubmissionError  # noqa: PLC0415
    from ros2lab.scratch import scratch_folder  # noqa: PLC0415

    start = time.monotonic()
    asked = assignments.load(assignment)
    problem, sources = "", dict[str, str]()
    with scratch_folder() as scratch:
        path = _together(paths, scratch / "handed_in")
        copy = scratch / "copy"
        try:
            evidence = collect(path, show, copy, assignment=asked, has_sandbox=has_sandbox, is_alone=is_alone)
        except SubmissionError as error:
            problem = str(error)
            evidence = nothing(path, problem, asked)
        else:
            found = evidence.submission
            if path in map(project_in, path.parents[:2]):  # handed in with all in which its student works
                evidence = replace(evidence, submission=found.worked_in())
            if found.form == "nothing":
                problem = "There is no ROS 2 package in it, and no file that starts a node."
            sources = _sources(copy, [package.folder for package in found.packages], found.node_files)
    return Seen(evidence_json(evidence), sources, problem, time.monotonic() - start)


def _together(paths: Sequence[Path], folder: Path) -> Path:
    """Return what was handed in as one path; loose files are put into a folder."""
    if len(paths) == 1:
        return paths[0]
    folder.mkdir()
    for path in paths:
        shutil.copyfile(path, folder / path.name, follow_symlinks=False)
    return folder


def _sources(root: Path, packages: Sequence[str], files: Sequence[str]) -> dict[str, str]:
    """Return the Python files that were handed in, without those that every package has.

    What is Python is one, whatever it is called, and so is a text in one that is Python: they may be run.
    """
    from ros2lab.diagnose.sources.file_texts import decoded  # noqa: PLC0415
    from ros2lab.grading.reading.build_plan import WORKSPACE  # noqa: PLC0415

    found, budgets = dict[str, str](), {True: MOST_SOURCE, False: MOST_SOURCE}
    in_packages = [path for folder in packages for path in sorted((root / folder).rglob("*"))]
    for path in [*in_packages, *(root / file for file in files)]:
        name, is_called_so = str(path.relative_to(root)), path.suffix == ".py"
        is_ours = any(part.startswith(WORKSPACE) for part in PurePosixPath(name).parts)
        if is_ours or path.name in ("setup.py", "__init__.py") or path.is_symlink() or not path.is_file():
            continue
        with path.open("rb") as file:
            text = decoded(file.read(budgets[is_called_so]), path.with_suffix(".py"))
        budgets[is_called_so] -= len(text)
        texts = [*texts_of_code(text)]
        if is_called_so and text not in texts:
            texts = [text]
        for number, code in enumerate(texts):
            shown = name.encode(errors="backslashreplace").decode()
            found[f"{shown}, text {number}" if number else shown] = code
    return found


def texts_of_code(text: str) -> Iterator[str]:
    """Yield a text if it is Python that does something, else what of it is, and then all texts in it that are."""
    queue = [text]
    while queue:
        text = queue.pop(0)
        if (tree := parsed(text)) is None:
            # A block begins with a line that is not indented: whatever stands around it does not hide it.
            blocks = [block for block in re.split(r"\n(?=\S)", text) if "(" in block or "import" in block]
            text = "\n".join(block for block in blocks if (piece := parsed(block)) and _does_something(piece))
            tree = parsed(text) or ast.Module([], [])
        nodes = [*ast.walk(tree)]
        if _does_something(tree):
            yield text
        inner = [_text(node.value) for node in nodes if isinstance(node, ast.Constant)]
        # As the lines of a notebook's cell are.
        inner += [
            "".join(_text(each.value) for each in node.elts if isinstance(each, ast.Constant))
            for node in nodes
            if isinstance(node, ast.List)
        ]
        queue += [each for each in inner if "\n" in each.strip()]


def parsed(text: str) -> ast.Module | None:
    """Return a text as Python; None if it is none."""
    with warnings.catch_warnings(), contextlib.suppress(*NO_PYTHON):
        warnings.simplefilter("ignore")
        return ast.parse(text)
    return None


def _does_something(tree: ast.AST) -> bool:
    return any(isinstance(node, (ast.Call, ast.Import, ast.ImportFrom)) for node in ast.walk(tree))


def _text(value: object) -> str:
    """Return the text that a constant holds; empty if it is none."""
    return (
        value.decode(errors="replace")
        if isinstance(value, bytes)
        else value
        if isinstance(value, str)
        else ""
    )


def graded_apart(
    paths: Sequence[Path],
    assignment: Path | None,
    show: Show,
    started: Callable[[subprocess.Popen[str]], None] = lambda _process: None,
    *,
    is_alone: bool = True,
) -> Seen:
    """Return what is seen of a submission, by a process of its own.

    Args:
        paths: a folder, an archive, or loose files.
        assignment: the folder of what was asked for; None for the course's own.
        show: told what is being done.
        started: given the process, so that it can be ended early.
        is_alone: whether no other submission is graded at the same time on this machine.

    Raises:
        GradingFailed: if that process has failed, or was ended.
        CannotGrade: if this machine cannot grade any submission.
    """
    request = {
        "paths": [os.fsencode(path.absolute()).decode("latin-1") for path in paths],
        "assignment": str(assignment.absolute()) if assignment else None,
        "is_alone": is_alone,
    }
    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen(
            COMMAND,
            cwd=Path(__file__).parents[2],  # where modules of a submission are not taken for Python's own
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=said,
            text=True,
            env=environment.lab_environment(),
            start_new_session=True,
        )
        with process:
            timer = threading.Timer(TOO_LONG, process.kill)
            timer.start()
            try:
                started(process)
                reply = _reply(process, request, show)
            finally:
                timer.cancel()
                process.kill()
        if reply is None:
            said.seek(0)
            lines = said.read().decode(errors="replace").strip().splitlines()
            last = f": {lines[-1][:300]}" if lines else ""
            raise GradingFailed(f"The grader ended with {process.returncode}{last}.")
    if "cannot" in reply:
        raise CannotGrade(reply["cannot"])
    if "failed" in reply:
        raise GradingFailed(reply["failed"])
    return Seen(**reply["seen"])


def _reply(process: subprocess.Popen[str], request: Mapping[str, Any], show: Show) -> dict[str, Any] | None:
    """Tell a process what to grade, and return what it answers; None if it ends without an answer."""
    if process.stdin is None or process.stdout is None:
        raise ValueError("The process must have pipes.")
    with contextlib.suppress(BrokenPipeError):
        process.stdin.write(json.dumps(request) + "\n")
        process.stdin.flush()
    for line in process.stdout:
        reply: dict[str, Any] = json.loads(line)
        if "step" not in reply:
            return reply
        show(reply["step"])
    return None


def main() -> None:
    """Grade what the line on standard input names, and answer with a line of JSON; end when that stream does."""
    answers = os.fdopen(os.dup(1), "w", encoding="ascii")
    os.dup2(2, 1)  # what anything else prints is no answer
    request = json.loads(sys.stdin.readline())
    threading.Thread(target=_end_with_parent, daemon=True).start()

    def answer(**reply: Any) -> None:
        answers.write(json.dumps(reply) + "\n")
        answers.flush()

    from ros2lab.grading.sandbox.box import SandboxMissing  # noqa: PLC0415

    paths = [Path(os.fsdecode(path.encode("latin-1"))) for path in request["paths"]]
    assignment = Path(request["assignment"]) if request["assignment"] else None
    try:
        found = seen(paths, assignment, lambda step: answer(step=step), is_alone=request["is_alone"])
        answer(seen=asdict(found))
    except SandboxMissing as error:
        answer(cannot=str(error))
    except Exception as error:
        answer(failed=failure(error))


def failure(error: Exception) -> str:
    """Return what has failed: what is raised as RuntimeError, and as no kind of it, is a sentence already."""
    if type(error) is RuntimeError:
        return str(error)
    return (
        "The grader itself has failed, which is no fault of the submission: "
        f"{type(error).__name__}: {error}. Please report it."
    )


def _end_with_parent() -> None:
    sys.stdin.read()
    os._exit(1)  # what runs in the sandbox ends with this process


if __name__ == "__main__":
    main()
