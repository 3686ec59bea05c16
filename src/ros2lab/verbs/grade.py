"""`ros2lab grade` and `ros2lab regrade`: what a submission is worth, why, and how to fix it."""

from __future__ import annotations

import os
import signal
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ros2lab import course

if TYPE_CHECKING:
    from ros2lab.assignments import Assignment
    from ros2lab.grading.evidence import Evidence
    from ros2lab.grading.grade import Grade
    from ros2lab.grading.overrides import Decision
    from ros2lab.grading.rubric import Rubric

USAGE_ERROR, NOTHING_TO_GRADE, CANNOT_GRADE = 2, 3, 4
STANDARD_OUTPUT = Path("-")
LONGEST_SENTENCE = 2000  # characters

_Json = Annotated[Path | None, typer.Option("--json", help="Write the grade as JSON; - prints it.")]
_Html = Annotated[Path | None, typer.Option("--html", help="Write a report to read in a browser.")]
_Md = Annotated[Path | None, typer.Option("--md", help="Write a report in Markdown.")]
_Gradescope = Annotated[Path | None, typer.Option("--gradescope", help="Write Gradescope's results.json.")]
_GitHub = Annotated[
    Path | None, typer.Option("--github", help="Write annotations of GitHub Actions; - prints them.")
]
_JUnit = Annotated[Path | None, typer.Option("--junit", help="Write JUnit's XML.")]
RubricFile = Annotated[
    Path | None, typer.Option("--rubric", help="A rubric of your own, instead of the course's.")
]
AssignmentFolder = Annotated[
    Path | None,
    typer.Option(
        "--assignment", help="A folder with assignment.yaml and rubric.yaml, instead of the course's."
    ),
]
_Overrides = Annotated[
    Path | None,
    typer.Option("--overrides", help="What you decide yourself: `criterion: {points, comment, by}`."),
]


def _path(text: str) -> Path:
    if not text:
        raise typer.BadParameter("This is empty; give a folder, a zip or a tar.")
    return Path(text)


class UsageError(Exception):
    """What was asked for cannot be done; the message is one sentence."""


@dataclass(frozen=True)
class _Outputs:
    """Where reports are written; None for those that are not wanted."""

    json: Path | None
    html: Path | None
    md: Path | None
    gradescope: Path | None
    github: Path | None
    junit: Path | None
    evidence: Path | None = None

    def check(self, submission: Path) -> None:
        """Refuse, before anything runs, what cannot be written, or would change what was handed in.

        Raises:
            UsageError: with the file and what to do.
        """
        wanted = [path for path in vars(self).values() if path is not None and path != STANDARD_OUTPUT]
        for path in wanted:
            folder = path.absolute().parent
            if (
                path.is_dir()
                or not folder.is_dir()
                or not os.access(path if path.exists() else folder, os.W_OK)
            ):
                raise UsageError(f"{path} cannot be written; give a file in a folder that you may write to.")
            if path.resolve().is_relative_to(submission.resolve()):
                raise UsageError(f"{path} lies in what is graded; give a file outside of it.")
        if len({path.resolve() for path in wanted}) < len(wanted):
            raise UsageError("Two reports have the same file; give each its own.")

    def write(self, grade: Grade, evidence: Evidence) -> None:
        """Write all that is wanted."""
        from ros2lab.grading.evidence_json import evidence_json  # noqa: PLC0415
        from ros2lab.grading.reports.as_json import as_json  # noqa: PLC0415
        from ros2lab.grading.reports.github import github  # noqa: PLC0415
        from ros2lab.grading.reports.gradescope import gradescope  # noqa: PLC0415
        from ros2lab.grading.reports.html import html  # noqa: PLC0415
        from ros2lab.grading.reports.junit import junit  # noqa: PLC0415
        from ros2lab.grading.reports.markdown import markdown  # noqa: PLC0415

        makers: Mapping[str, Callable[[], str]] = {
            "json": lambda: as_json(grade),
            "html": lambda: html(grade, evidence),
            "md": lambda: markdown(grade),
            "gradescope": lambda: gradescope(grade),
            "github": lambda: github(grade),
            "junit": lambda: junit(grade),
            "evidence": lambda: evidence_json(evidence),
        }
        for name, make in makers.items():
            path = vars(self)[name]
            if path == STANDARD_OUTPUT:
                print(make(), end="")
            elif path is not None:
                course.write_whole(path, make().encode())

    def show(self, grade: Grade) -> None:
        """Show a grade, unless a report is printed: what reads that would take a line of the table for one of it."""
        from rich.console import Console  # noqa: PLC0415

        from ros2lab.grading.reports.table import table  # noqa: PLC0415

        if STANDARD_OUTPUT not in vars(self).values():
            console = Console() if sys.stdout.isatty() else Console(width=100)
            console.print(table(grade))


def grade(
    path: Annotated[
        Path | None,
        typer.Argument(
            parser=_path, metavar="PATH", help="What was handed in: a folder, a git checkout, a zip or a tar."
        ),
    ] = None,
    *,
    json: _Json = None,
    html: _Html = None,
    md: _Md = None,
    gradescope: _Gradescope = None,
    github: _GitHub = None,
    junit: _JUnit = None,
    assignment: AssignmentFolder = None,
    rubric: RubricFile = None,
    overrides: _Overrides = None,
    evidence: Annotated[
        Path | None, typer.Option("--evidence", help="Write what was seen, for `ros2lab regrade`.")
    ] = None,
    keep: Annotated[
        bool, typer.Option("--keep", help="Keep the unpacked copy, and say where it is.")
    ] = False,
    own: Annotated[
        bool,
        typer.Option("--self", help="Grade your own project's workspace, the one here or in your folder."),
    ] = False,
    unsafe: Annotated[
        bool,
        typer.Option(
            "--unsafe-no-sandbox", help="Run it with all that you may do yourself. Only for your own work!"
        ),
    ] = False,
) -> None:
    """Build a submission, watch what it does, and say what it is worth, why, and how to fix it.

    It runs in a sandbox (bubblewrap): it cannot reach your files, your network, or the next submission. The exit
    code is 0 if it was graded, whatever the score; 2 for wrong usage, 3 if there is nothing to grade, and 4 if this
    machine cannot grade.
    """
    outputs = _Outputs(json, html, md, gradescope, github, junit, evidence)
    with told_in_a_sentence():
        if own == (path is not None):
            raise UsageError("Give either what to grade, or --self for your own workspace.")
        submission = path or _own_workspace()
        if not os.path.lexists(submission):
            raise UsageError(f"There is no {submission}; give a folder, a zip or a tar.")
        outputs.check(submission)
        judge = Judge.of(assignment, rubric, overrides)
        kept = Path(tempfile.mkdtemp(prefix="ros2lab-kept-")) if keep else None
        seen, problem = collected(submission, judge.assignment, kept, has_sandbox=not unsafe)
        if own:
            seen = replace(seen, submission=seen.submission.worked_in())
        result = judge.grade(seen)
        outputs.write(result, seen)
        outputs.show(result)
        if kept:
            print(f"The unpacked copy is in {kept}.", file=sys.stderr)
    if problem:
        _tell(problem)
        raise typer.Exit(NOTHING_TO_GRADE)


def regrade(
    evidence: Annotated[Path, typer.Argument(help="What `ros2lab grade --evidence` has written.")],
    *,
    json: _Json = None,
    html: _Html = None,
    md: _Md = None,
    gradescope: _Gradescope = None,
    github: _GitHub = None,
    junit: _JUnit = None,
    assignment: AssignmentFolder = None,
    rubric: RubricFile = None,
    overrides: _Overrides = None,
) -> None:
    """Grade again what was seen before, without another run: with another rubric, or with your decisions."""
    from ros2lab.grading.evidence_json import EvidenceError, read_evidence  # noqa: PLC0415

    outputs = _Outputs(json, html, md, gradescope, github, junit)
    with told_in_a_sentence():
        outputs.check(evidence)
        try:
            seen = read_evidence(evidence.read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError) as error:
            raise UsageError(f"{evidence} cannot be read ({error}); give a file of --evidence.") from None
        except EvidenceError as error:
            raise UsageError(f"{evidence}: {error}") from None
        result = Judge.of(assignment, rubric, overrides).grade(seen)
        outputs.write(result, seen)
        outputs.show(result)


@dataclass(frozen=True)
class Judge:
    """By what is graded: an assignment, its rubric, and what an instructor has decided."""

    rubric: Rubric
    decisions: Mapping[str, Decision]

    @classmethod
    def of(cls, assignment: Path | None, rubric: Path | None, overrides: Path | None) -> Judge:
        """Read what was given, and the course's own for what was not.

        Raises:
            UsageError: if one of them cannot be used.
        """
        from ros2lab import assignments  # noqa: PLC0415
        from ros2lab.grading import rubric as rubrics  # noqa: PLC0415
        from ros2lab.grading.overrides import OverridesError, read  # noqa: PLC0415

        try:
            asked = assignments.load(assignment)
            chosen = rubrics.load(rubric or (assignment / "rubric.yaml" if assignment else None), asked)
            return cls(chosen, read(overrides, chosen) if overrides else {})
        except (assignments.AssignmentError, rubrics.RubricError, OverridesError) as error:
            raise UsageError(str(error)) from None

    @property
    def assignment(self) -> Assignment:
        """What was asked for."""
        return self.rubric.assignment

    def grade(self, evidence: Evidence) -> Grade:
        """Grade what was seen.

        Raises:
            UsageError: if it was seen for another assignment.
        """
        from ros2lab.grading.verdict import verdict  # noqa: PLC0415

        if evidence.assignment != self.assignment.name:
            raise UsageError(
                f"This was handed in for {evidence.assignment!r}, not for {self.assignment.name!r}; give the folder of "
                "that assignment with --assignment."
            )
        return verdict(evidence, self.rubric, self.decisions)


def collected(
    submission: Path, assignment: Assignment, kept: Path | None, *, has_sandbox: bool, name: str = ""
) -> tuple[Evidence, str]:
    """Return what was seen, and a sentence if there was nothing to grade; a name stands before the progress."""
    from rich.console import Console  # noqa: PLC0415

    from ros2lab.grading.collect import collect, nothing  # noqa: PLC0415
    from ros2lab.grading.receiving.clean_copy import SubmissionError  # noqa: PLC0415
    from ros2lab.grading.sandbox.compiled import compile_modules  # noqa: PLC0415

    console = Console(stderr=True)
    with console.status("reading") as status:

        def show(step: str) -> None:
            status.update(f"{name}: {step}" if name else step)

        compile_modules()
        try:
            evidence = collect(submission, show, kept, assignment=assignment, has_sandbox=has_sandbox)
        except SubmissionError as error:
            return nothing(submission, str(error), assignment), str(error)
    if evidence.submission.form == "nothing":
        return (
            evidence,
            f"There is nothing to grade in {submission}: no ROS 2 package, and no file that starts a node.",
        )
    return evidence, ""


def _own_workspace() -> Path:
    """Return the student's workspace: the one that holds this folder, else the one in the student's folder.

    Raises:
        UsageError: if there is none.
    """
    from ros2lab.assignments.lesson import load_lesson  # noqa: PLC0415

    name, here = load_lesson().workspace, Path.cwd()
    for folder in (here, *here.parents):
        if folder.name == name:
            return folder
    found = course.work_folder() / name
    if found.is_dir():
        return found
    raise UsageError(f"There is no {name} here or in {course.work_folder()}; go to your workspace.")


class Ended(BaseException):
    """A signal asks for the end."""


def _end(number: int, _frame: object) -> None:
    signal.signal(number, signal.SIG_IGN)  # what is cleaned up now is cleaned up whole
    raise Ended(number)


@contextmanager
def ended_by(*numbers: int) -> Iterator[None]:
    """Let each of some signals that is not ignored end what runs inside."""
    heard = [number for number in numbers if signal.getsignal(number) != signal.SIG_IGN]
    handlers = {number: signal.signal(number, _end) for number in heard}
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)


@contextmanager
def told_in_a_sentence() -> Iterator[None]:
    """End the command with a sentence and its exit code, where it cannot go on; also where a signal ends it."""
    try:
        with ended_by(signal.SIGTERM, signal.SIGHUP):
            from ros2lab.grading.sandbox.box import SandboxMissing  # noqa: PLC0415

            try:
                yield
            except (SandboxMissing, RuntimeError) as error:
                code, text = CANNOT_GRADE, str(error)
            else:
                return
    except UsageError as error:
        code, text = USAGE_ERROR, str(error)
    except (KeyboardInterrupt, Ended) as error:
        number = error.args[0] if isinstance(error, Ended) else signal.SIGINT
        code, text = 128 + number, "Interrupted: everything was ended, and nothing was written."
    except OSError as error:
        code, text = CANNOT_GRADE, f"This cannot be graded here: {error}."
    except Exception as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        code = CANNOT_GRADE
        text = (
            f"The grader itself has failed, which is no fault of the submission: {type(error).__name__}: {error} "
            f"({Path(place.filename).name}, line {place.lineno}). Please report it."
        )
    _tell(text)
    raise typer.Exit(code)


def _tell(sentence: str) -> None:
    """Print a sentence that may name files as a submission calls them."""
    from ros2lab.grading.reports.shown import visible  # noqa: PLC0415

    print(visible(sentence, LONGEST_SENTENCE), file=sys.stderr)
