"""`ros2lab class`: grade a whole class, judge it again, report on it, and hand the grades back."""

from __future__ import annotations

import re
import signal
import sqlite3
import statistics
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext
from datetime import datetime
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ros2lab.verbs.grade import AssignmentFolder, Ended, RubricFile, ended_by

if TYPE_CHECKING:
    from ros2lab.classroom.gradebook import Row
    from ros2lab.classroom.grading import Plan

GRADED_NOT_ALL, USAGE_ERROR, CANNOT_GRADE = 1, 2, 4
GRADES = Path("grades")

class_ = typer.Typer(
    no_args_is_help=True, help="Grade a whole class, report on it, and hand the grades back."
)

_Grades = Annotated[Path, typer.Argument(metavar="[GRADES]", help="The folder with the gradebook.")]
_By = Annotated[str, typer.Option("--by", help="Who decides; your login if nothing is said.")]


class Form(str, Enum):
    """How submissions lie in a folder."""

    auto = "auto"
    canvas = "canvas"
    moodle = "moodle"
    gradescope = "gradescope"
    nbgrader = "nbgrader"
    folder = "folder"


class Target(str, Enum):
    """To whom grades are handed."""

    canvas = "canvas"
    moodle = "moodle"
    gradescope = "gradescope"
    nbgrader = "nbgrader"
    jsonl = "jsonl"
    feedback = "feedback"


@class_.command()
def grade(
    submissions: Annotated[
        Path,
        typer.Argument(
            help="A folder with one folder, archive or git checkout for each student; what Canvas, Moodle or "
            "Gradescope gives to download, also as a zip; nbgrader's submitted; or a CSV with `name` and `path` or `git`."
        ),
    ],
    *,
    out: Annotated[Path, typer.Option("--out", help="The folder of the gradebook and the reports.")] = GRADES,
    form: Annotated[
        Form, typer.Option("--from", help="Whose names the submissions have; usually found out.")
    ] = Form.auto,
    jobs: Annotated[
        str, typer.Option("--jobs", help="How many at once: a number, or auto for what this machine bears.")
    ] = "auto",
    scheduler: Annotated[
        str,
        typer.Option(
            "--scheduler",
            metavar="ADDRESS",
            help="Grade on the workers of this scheduler of dask, such as tcp://10.0.0.5:8786, and not here.",
        ),
    ] = "",
    only: Annotated[
        list[str] | None, typer.Option("--only", help="Only this student: a name, an id or an email address.")
    ] = None,
    failed: Annotated[
        bool, typer.Option("--failed", help="Only those at which the grader has failed.")
    ] = False,
    since: Annotated[
        datetime | None, typer.Option("--since", help="Only what was written at or after this date or time.")
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would be graded and why not the rest, and do nothing.")
    ] = False,
    assignment: AssignmentFolder = None,
    rubric: RubricFile = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say only what is wrong.")] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Say what happens as lines of JSON, on standard output.")
    ] = False,
) -> None:
    """Grade a class, many submissions at once, into a gradebook.

    Each runs in its own sandbox, and is written down as soon as it has ended. Whatever interrupts this, the same
    command goes on where it was; what was graded is graded again only if the submission, the assignment or the grader
    has changed. What cannot be graded is a row with a reason.

    The exit code is 0 if all of the class was graded, 1 if the grader has failed at some of it, 2 for wrong usage, and
    4 if this machine cannot grade.
    """
    with _told_in_a_sentence(f"`ros2lab class grade` with {submissions} goes on where it was"):
        from ros2lab.classroom import discovery, gradebook, grading  # noqa: PLC0415
        from ros2lab.classroom.display import Display  # noqa: PLC0415
        from ros2lab.classroom.handed_in import ClassError, called  # noqa: PLC0415
        from ros2lab.classroom.judging import Judging, check_assignment, regrade  # noqa: PLC0415

        count = None if jobs == "auto" else int(jobs) if jobs.isdecimal() else 0
        if count == 0:
            raise ClassError(f"--jobs is a number from 1, or auto, and not {jobs!r}.")
        if quiet and as_json:
            raise ClassError("Give either --quiet or --json.")
        if not submissions.exists():
            raise ClassError(f"There is no {submissions}; give a folder, a zip or a CSV of submissions.")
        if out.resolve().is_relative_to(submissions.resolve()):
            raise ClassError(f"{out} lies in what is graded; give a folder outside of it with --out.")
        Judging.of(assignment, rubric, {})  # a mistake in them is told before anything is written
        with (
            gradebook.copied(out) if dry_run else nullcontext(out) as folder,
            gradebook.opened(folder, is_new_allowed=True) as book,
        ):
            received = folder / "received"
            received.mkdir(exist_ok=True)
            found = discovery.find(
                submissions, received, "" if form is Form.auto else form.value, _tell_what_is_no_hand_in
            )
            wanted = discovery.chosen(found, only) if only else found
            rows_found = [*grading.identified(wanted, found)]
            if since:
                rows_found = [found for found in rows_found if found[2] >= since.timestamp()]
            book.register(rows_found)
            keys = {handed.key for handed, *_ in rows_found}
            rows = [row for row in book.rows() if row.handed.key in keys]
            judging = Judging.of(assignment, rubric, book.decisions())
            check_assignment(book, judging, book.rows())
            todo = grading.plan(book, judging, rows, only_failed=failed)
            if dry_run:
                _show_plan(todo, rows, called(row.handed for row in book.rows()))
                return
            with Display(len(todo.tasks), "json" if as_json else "quiet" if quiet else "usual") as display:
                grading.carry_out(book, judging, todo, display, jobs=count, scheduler=scheduler)
            regrade(book, judging, book.rows())
            names = called(row.handed for row in book.rows())
            rows = [row for row in book.rows() if row.handed.key in keys]
        if not as_json and not quiet:
            _show_summary(rows, out)
        for row in rows:
            if row.state == "failed":
                print(f"{_shown(names[row.handed.key])}: {_shown(row.reason)}", file=sys.stderr)
    if any(row.state == "failed" for row in rows):
        raise typer.Exit(GRADED_NOT_ALL)


@class_.command()
def regrade(
    grades: _Grades = GRADES,
    *,
    overrides: Annotated[
        Path | None,
        typer.Option(
            "--overrides", help="A CSV with student, criterion, points, comment and by; the decisions stay."
        ),
    ] = None,
    assignment: AssignmentFolder = None,
    rubric: RubricFile = None,
) -> None:
    """Judge the whole class again from what was seen, without a run: by another rubric, or with your decisions.

    What was decided before, by hand or from a CSV, stays and counts.
    """
    with _told_in_a_sentence("the gradebook is as it was, or new"):
        from ros2lab.classroom import display, gradebook, judging  # noqa: PLC0415

        with gradebook.opened(grades) as book:
            by = judging.Judging.of(assignment, rubric, book.decisions())
            if overrides:
                from ros2lab.classroom.decisions import read  # noqa: PLC0415

                book.decide(read(overrides, book.rows(), by.rubric))
                by = judging.Judging.of(assignment, rubric, book.decisions())
            rows = book.rows()
            with display.bar("judging again") as show:
                done = judging.regrade(book, by, rows, show)
    graded = sum(row.worth is not None for row in rows)
    for name, problem in done.problems.items():
        print(f"{_shown(name)} keeps the grade that was given before: {_shown(problem)}", file=sys.stderr)
    print(f"Of {graded} grades {done.judged} were judged again, and {done.changed} have other points now.")
    if done.problems:
        raise typer.Exit(GRADED_NOT_ALL)


class _WithNumbers(typer.core.TyperCommand):
    """A verb to which a number below zero is a number, and no option."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        ctx.ignore_unknown_options = any(re.fullmatch(r"-[\d.]+", word) for word in args)
        return super().parse_args(ctx, args)


@class_.command(cls=_WithNumbers)
def override(
    student: Annotated[str, typer.Argument(help="A name, an id or an email address.")],
    criterion: Annotated[str, typer.Argument(help="Such as documentation.readme; a report names them.")],
    points: Annotated[float | None, typer.Argument(help="What it is worth; nothing with --withdraw.")] = None,
    *,
    grades: Annotated[Path, typer.Option("--grades", help="The folder with the gradebook.")] = GRADES,
    comment: Annotated[str, typer.Option("--comment", help="Why; it stands in the report.")] = "",
    by: _By = "",
    withdraw: Annotated[
        bool, typer.Option("--withdraw", help="Let the machine's points count again.")
    ] = False,
    assignment: AssignmentFolder = None,
    rubric: RubricFile = None,
) -> None:
    """Decide yourself what a criterion of one student is worth. The decision survives every regrade."""
    with _told_in_a_sentence("nothing was decided"):
        from ros2lab.classroom import decisions, gradebook, judging  # noqa: PLC0415
        from ros2lab.classroom.handed_in import ClassError  # noqa: PLC0415

        if withdraw != (points is None):
            raise ClassError("Give either the points, or --withdraw.")
        with gradebook.opened(grades) as book:
            by_what = judging.Judging.of(assignment, rubric, book.decisions())
            row = decisions.row_of(student, book.rows())
            if points is None:
                if not book.withdraw(row.handed.key, criterion):
                    raise ClassError(f"Nothing was decided about {criterion} of {row.handed.name}.")
            else:
                decided = (row.handed.key, criterion, points, comment, by or _login())
                book.decide([decisions.checked(decided, by_what.rubric)])
            by_what = judging.Judging.of(assignment, rubric, book.decisions())
            judging.regrade(book, by_what, [row])
            (row,) = [found for found in book.rows() if found.handed.key == row.handed.key]
    total = f"{row.worth.total:g} of {row.worth.max:g} points" if row.worth else "no grade"
    key = "" if row.handed.key == row.handed.name else f" ({_shown(row.handed.key)})"
    print(f"{_shown(row.handed.name)}{key} has {total} now.")


@class_.command()
def report(
    grades: _Grades = GRADES,
    *,
    out: Annotated[
        Path | None,
        typer.Option("--out", help="The HTML file; class.html in the gradebook's folder if nothing is said."),
    ] = None,
    template: Annotated[
        list[Path] | None,
        typer.Option(
            "--template", help="A folder or file that all were given: likeness to it does not count."
        ),
    ] = None,
    assignment: AssignmentFolder = None,
    rubric: RubricFile = None,
) -> None:
    """Write one page about the class: points, losses, what needs a look, and who has handed in the same.

    Beside it lies a report for each student. Nothing leaves this machine, and the page asks for nothing.
    """
    with _told_in_a_sentence("some reports may be as they were"):
        from ros2lab.classroom import gradebook  # noqa: PLC0415
        from ros2lab.classroom.judging import Judging  # noqa: PLC0415
        from ros2lab.classroom.report import write  # noqa: PLC0415

        with gradebook.opened(grades) as book:
            judging = Judging.of(assignment, rubric, book.decisions())
            path = write(book, judging, out or grades / "class.html", template or [])
    print(f"The report is {path}; open it in a browser.")


@class_.command()
def export(
    target: Annotated[Target, typer.Argument(help="To whom.")],
    grades: _Grades = GRADES,
    *,
    out: Annotated[Path | None, typer.Option("--out", help="The file or folder that is written.")] = None,
    columns: Annotated[
        Path | None,
        typer.Option("--columns", help="What Canvas or Moodle has exported: its rows and columns are kept."),
    ] = None,
    column: Annotated[
        str, typer.Option("--column", help="The name of the grade's column, such as `Week 2 (4711)`.")
    ] = "",
) -> None:
    """Write the grades as Canvas, Moodle, Gradescope or nbgrader take them, as lines of JSON, or as feedback.

    feedback is a folder for each student, called as the platform has called the submission, with a comment in
    Markdown and the report.
    """
    with _told_in_a_sentence("what was being written is as it was"):
        from ros2lab.classroom import exports, gradebook  # noqa: PLC0415

        with gradebook.opened(grades) as book:
            path, said = exports.write(
                target.value, book, out or grades / exports.DEFAULT_NAMES[target.value], columns, column
            )
    print(f"{path} is written: {said}.")


def _tell_what_is_no_hand_in(names: list[str]) -> None:
    more = f" and {len(names) - 20} more" if len(names) > 20 else ""
    if names:
        print(f"Not taken for hand-ins: {_shown(', '.join(names[:20]))}{more}.", file=sys.stderr)


def _show_plan(todo: Plan, rows: list[Row], names: Mapping[str, str]) -> None:
    graded = [names[key] for task in todo.tasks for key in task.students]
    for name in graded:
        print(f"{_shown(name)} would be graded.")
    for row in rows:
        if row.state == "unreadable":
            print(f"{_shown(names[row.handed.key])} cannot be graded: {_shown(row.reason)}")
    print(
        f"{len(graded)} would be graded, {len(todo.again)} only judged again, and with {len(todo.done)} there is "
        "nothing to do. Nothing was changed."
    )


def _show_summary(rows: list[Row], out: Path) -> None:
    totals = [row.worth.total for row in rows if row.worth]
    states = {state: sum(row.state == state for row in rows) for state in ("failed", "unreadable", "waiting")}
    others = ", ".join(f"{count} {state}" for state, count in states.items() if count)
    middle = f", the median is {statistics.median(totals):g}" if totals else ""
    print(f"{len(totals)} of {len(rows)} are graded{f' ({others})' if others else ''}{middle}.")
    print(f"Next: ros2lab class report {out}")


def _shown(text: str) -> str:
    from ros2lab.grading.reports.shown import visible  # noqa: PLC0415

    return visible(text)


def _login() -> str:
    import getpass  # noqa: PLC0415

    return getpass.getuser()


@contextmanager
def _told_in_a_sentence(how_to_go_on: str) -> Iterator[None]:
    """End the command with a sentence and its exit code, where it cannot go on; also where a signal ends it."""
    try:
        with ended_by(signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            from ros2lab.classroom.handed_in import ClassError  # noqa: PLC0415
            from ros2lab.classroom.one import CannotGrade  # noqa: PLC0415

            try:
                yield
            except ClassError as error:
                code, text = USAGE_ERROR, str(error)
            except CannotGrade as error:
                code, text = CANNOT_GRADE, str(error)
            else:
                return
    except Ended as error:
        code, text = 128 + error.args[0], f"Interrupted, and everything was ended; {how_to_go_on}."
    except (OSError, sqlite3.Error) as error:
        code, text = CANNOT_GRADE, f"This cannot be done here: {error}; {how_to_go_on}."
    print(text, file=sys.stderr)
    raise typer.Exit(code)
