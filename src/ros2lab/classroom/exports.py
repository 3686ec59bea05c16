"""Hand the grades back: each target is a function from the class to files, in the form that its platform takes.

A text in a CSV that a spreadsheet would take for a formula gets an apostrophe before it; numbers stay numbers.
"""

from __future__ import annotations

import csv
import io
import json
import os
import re
import shutil
import unicodedata
import warnings
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from ros2lab import course, environment
from ros2lab.classroom.gradebook import Gradebook, Row
from ros2lab.classroom.handed_in import ClassError, as_one_name, called
from ros2lab.classroom.judging import read_grade
from ros2lab.classroom.names import canvas
from ros2lab.classroom.report import file_name, is_device
from ros2lab.grading.evidence_json import read_evidence
from ros2lab.grading.grade import Grade
from ros2lab.grading.reports.gradescope import gradescope as results_json
from ros2lab.grading.reports.html import html
from ros2lab.grading.reports.markdown import markdown
from ros2lab.grading.reports.shown import disarmed, number, visible

DEFAULT_NAMES: Mapping[str, str] = {
    "canvas": "canvas.csv",
    "moodle": "moodle.csv",
    "gradescope": "gradescope",
    "nbgrader": "gradebook.db",
    "jsonl": "grades.jsonl",
    "feedback": "feedback",
}
CANVAS_COLUMNS = ("Student", "ID", "SIS User ID", "SIS Login ID", "Section")
CANVAS_POINTS = "    Points Possible"  # with the spaces by which Canvas writes it
MOODLE_MOST = "Maximum Grade"  # what is above it, Moodle leaves out
MOODLE_COLUMNS = (
    "Identifier", "Full name", "Email address", "Status", "Grade", MOODLE_MOST, "Grade can be changed",
    "Last modified (submission)", "Last modified (grade)",
)  # fmt: skip
_NAMES = (
    "Student",
    "LastName",
    "FirstName",
    "SIS Login ID",
    "Full name",
    "Email address",
)  # who it is, in words
_OTHER_IDS = (
    "SIS User ID",
    "SIS Login ID",
    "Integration ID",
    "ID number",
)  # numbers that are no platform's own
MOODLE_FEEDBACK = "Feedback comments"
PARTICIPANT = re.compile(r"\D*(\d+)\s*")  # the word before the number is in the language of the site
COLUMN = "ROS 2 week 2"
NOTEBOOK = "robot_controller"  # the grade cells of nbgrader belong to a notebook
GRADE_CELL = str.maketrans(".", "-")  # what an id of a criterion has, and nbgrader's ids do not
_NUMBER = re.compile(r"[-+]?\d+([.,]\d+)?")
_NO_FORMULA = re.compile(r"[-+]?[\d.,:/ ]*")  # Moodle writes a `-` where there is no date


@dataclass(frozen=True)
class Class:
    """What is handed back.

    Attributes:
        book: the gradebook.
        rows: of it.
        grades: by the key of the student.
        columns: what a platform has exported; None if nothing was given.
        column: the name of the grade's column.
    """

    book: Gradebook
    rows: Sequence[Row]
    grades: Mapping[str, Grade]
    columns: Path | None
    column: str

    def by_id(self) -> dict[str, Row]:
        """Return the graded rows by the student's number on the platform; without those that have none of their own."""
        graded = [row for row in self.rows if row.handed.key in self.grades]
        count = Counter(row.handed.student_id for row in graded)
        return {
            row.handed.student_id: row
            for row in graded
            if count[row.handed.student_id] == 1 and row.handed.student_id
        }


Write = Callable[[Class, Path], str]
Fill = Callable[
    ["list[str]", Row], str
]  # a cell, from the line in which it stands and the row of the gradebook


def write(target: str, book: Gradebook, path: Path, columns: Path | None, column: str) -> tuple[Path, str]:
    """Write the grades for a target, and return where, and what is to be said of it.

    Raises:
        ClassError: if the exported columns do not fit, or there is nothing to write.
        OSError: if it cannot be written.
    """
    rows = book.rows()
    grades = {row.handed.key: read_grade(row.worth.data) for row in rows if row.worth}
    if not grades:
        raise ClassError(
            "Nobody in this gradebook has a grade; begin with `ros2lab class grade SUBMISSIONS`."
        )
    if columns and target not in ("canvas", "moodle"):
        raise ClassError(f"--columns is what Canvas or Moodle has exported; {target} has no need of it.")
    return path, TARGETS[target](Class(book, rows, grades, columns, column), path)


# --- tables -----------------------------------------------------------------------------------------------


def _canvas(graded: Class, path: Path) -> str:
    """Write the gradebook's CSV that Canvas imports: five columns that name a student, and the assignment's."""
    most = max(grade.max for grade in graded.grades.values())
    if graded.columns is None:
        column = graded.column or COLUMN
        table = [
            [*CANVAS_COLUMNS, column],
            [CANVAS_POINTS, "", "", "", "", number(most)],
            *(
                [row.handed.name, row.handed.student_id, "", "", "", _points(graded, row)]
                for row in graded.rows
                if row.handed.key in graded.grades
            ),
        ]
        return _written(path, table)
    table, form = _exported(graded.columns, ("ID",))
    place = _assignments_column(table[0], graded)
    filled = _fill(table, "ID", graded.by_id(), {place: lambda _line, row: _points(graded, row)})
    return _written(path, table, form) + _unfilled(graded, filled)


def _assignments_column(header: Sequence[str], graded: Class) -> int:
    """Return the place of the assignment's column in what Canvas has exported: `Name (number)`."""
    candidates = [name for name in header if re.search(r"\(\d+\)\s*$", name)]
    wanted = [name for name in header if name == graded.column or name.startswith(f"{graded.column} (")]
    named = wanted if graded.column else candidates
    if len(named) != 1:
        listed = ", ".join(candidates) or "none"
        raise ClassError(f"Say with --column in which column the grade is; there are {listed}.")
    return header.index(named[0])


def _moodle(graded: Class, path: Path) -> str:
    """Write the offline grading worksheet that Moodle imports; it knows students by their Identifier."""
    by_id = graded.by_id()
    if graded.columns is None:
        most = number(max(grade.max for grade in graded.grades.values()))
        table = [[*MOODLE_COLUMNS, MOODLE_FEEDBACK]]
        table += [
            [f"Participant {key}", row.handed.name, row.handed.email, "", "", most, "Yes", "", "", ""]
            for key, row in by_id.items()
        ]
        form = _Form()
    else:
        table, form = _exported(graded.columns, ("Identifier", "Grade"))
    header, cut, names = table[0], list[str](), called(row.handed for row in graded.rows)

    def points(line: list[str], row: Row) -> str:
        total = graded.grades[row.handed.key].total
        most = _number_in(dict(zip(header, line, strict=False)).get(MOODLE_MOST, ""))
        if most is None or total <= most:
            return number(total)
        cut.append(names[row.handed.key])
        return number(most)

    fillers: dict[int, Fill] = {header.index("Grade"): points}
    if MOODLE_FEEDBACK in header:
        fillers[header.index(MOODLE_FEEDBACK)] = lambda _line, row: _comment(graded.grades[row.handed.key])
    filled = _fill(table, "Identifier", by_id, fillers)
    said = _written(path, table, form)
    if cut:
        said += f"; {len(cut)} have the most that Moodle takes, and more points than that: {_listed(cut)}"
    return said + _unfilled(graded, filled)


def _number_in(cell: str) -> float | None:
    """Return the number that a cell holds, with a point or a comma; None if it holds none."""
    return float(cell.replace(",", ".")) if _NUMBER.fullmatch(cell) else None


def _fill(
    table: Sequence[list[str]], identifier: str, by_id: Mapping[str, Row], fillers: Mapping[int, Fill]
) -> set[str]:
    """Fill the grades into what a platform has exported, and return the ids of those who are in it.

    A number names nobody who is called otherwise, or whose line has it as a number of another kind: a list of the students
    may have the numbers of a university, and a file may be last year's.

    Args:
        table: the header, and a line for each student.
        identifier: the column with the platform's own number.
        by_id: the rows of the gradebook.
        fillers: what is written, by the place of its column.
    """
    header, filled = table[0], set[str]()
    lines = [dict(zip(header, line, strict=False)) for line in table[1:]]
    others = Counter(number for line in lines for number in {line.get(name) for name in _OTHER_IDS})
    for line, cells in zip(table[1:], lines, strict=True):
        match = PARTICIPANT.fullmatch(cells.get(identifier, ""))
        row = by_id.get(match[1]) if match else None
        if row is None or match is None:
            continue
        is_its_own = identifier == "ID" and canvas(Path(f"{row.handed.label}_file")) is not None
        is_of_others = others[match[1]] > (match[1] in (cells.get(name) for name in _OTHER_IDS))
        if not is_its_own and (is_of_others or not _agree(row, cells)):
            continue
        filled.add(match[1])
        line.extend([""] * (max(fillers) + 1 - len(line)))
        for column, value in fillers.items():
            line[column] = value(line, row)
    return filled


def _agree(row: Row, cells: Mapping[str, str]) -> bool:
    """Return whether somebody's names and those in a line have a word in common, or either has none."""
    own, others = _words(row.handed.name, row.handed.email), _words(*(cells.get(name, "") for name in _NAMES))
    return not (own and others) or not own.isdisjoint(others)


def _words(*names: str) -> set[str]:
    """Return the words of names and of addresses before the `@`, without initials and accents."""
    text = unicodedata.normalize("NFKD", " ".join(name.partition("@")[0] for name in names).casefold())
    words = re.findall(r"[^\W\d_]+", "".join(sign for sign in text if not unicodedata.combining(sign)))
    return {word for word in words if len(word) > 1 or not word.isascii()}


def _unfilled(graded: Class, filled: set[str]) -> str:
    """Say whose grades are not in a file, in which the rows with some ids are."""
    own = graded.by_id()
    written = [own[key] for key in filled]
    names = called(row.handed for row in graded.rows)
    missing = [
        names[row.handed.key]
        for row in graded.rows
        if row.handed.key in graded.grades and not any(row is known for known in written)
    ]
    if not missing:
        return ""
    return (
        f"; {len(missing)} are not in it, for no line has a number that is theirs alone, and a word of their name beside it: "
        f"{_listed(missing)}"
    )


def _listed(names: Sequence[str]) -> str:
    return ", ".join(map(visible, names[:5])) + (", …" if len(names) > 5 else "")


@dataclass(frozen=True)
class _Form:
    """How a platform has written a CSV: its separator, and the mark of UTF-8 with which it began, if any."""

    separator: str = ","
    mark: str = ""


def _exported(path: Path, needed: Sequence[str]) -> tuple[list[list[str]], _Form]:
    """Return the table that a platform has exported, and its form; where a comma is decimal, a semicolon separates."""
    try:
        text = path.read_text(encoding="utf-8")
        mark = "\ufeff" if text.startswith("\ufeff") else ""
        for form in (_Form(separator, mark) for separator in ",;\t"):
            lines = io.StringIO(text.removeprefix(mark), newline="")
            table = [*csv.reader(lines, delimiter=form.separator)]
            if table and {*needed} <= {*table[0]}:
                return table, form
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ClassError(f"{path} cannot be read ({error}); export it again.") from None
    raise ClassError(f"{path} has no column {' and '.join(needed)}; export it again, in English.")


def _written(path: Path, table: Sequence[Sequence[str]], form: _Form | None = None) -> str:
    form = form or _Form()
    text = io.StringIO(newline="")
    lines = ([_harmless(cell) for cell in line] for line in table)
    csv.writer(text, delimiter=form.separator).writerows(lines)
    course.write_whole(path, (form.mark + text.getvalue()).encode())
    return f"{len(table) - 1} lines"


def _harmless(cell: str) -> str:
    return cell if _NO_FORMULA.fullmatch(cell) else disarmed(visible(cell, 50_000, keeps_lines=True))


def _points(graded: Class, row: Row) -> str:
    return number(graded.grades[row.handed.key].total)


def _comment(grade: Grade) -> str:
    """Return a grade as a comment in HTML, as which Moodle reads it: what was lost, and why."""
    lines = [f"{number(grade.total)} of {number(grade.max)} points."]
    lines += [
        f"{number(criterion.points)} of {number(criterion.max)}: {visible(criterion.title)}. {visible(criterion.reason)}"
        + (f" Hint: {visible(criterion.hint)}" if criterion.hint else "")
        for criterion in grade.criteria
        if criterion.points < criterion.max and (criterion.component != "bonus")
    ]
    return "<br>\n".join(escape(line, quote=False) for line in lines)


# --- files ------------------------------------------------------------------------------------------------


def _gradescope(graded: Class, path: Path) -> str:
    """Write a results.json for each submission, in a folder that is called as Gradescope calls it."""
    folders = _folders(graded.rows)
    for row in graded.rows:
        if grade := graded.grades.get(row.handed.key):
            text = results_json(grade)
            course.write_whole(path / folders[row.handed.key] / "results.json", text.encode())
    return f"{len(graded.grades)} results.json"


def _jsonl(graded: Class, path: Path) -> str:
    lines = [
        json.dumps(
            {
                "student": row.handed.key,
                "name": row.handed.name,
                "student_id": row.handed.student_id,
                "email": row.handed.email,
                "attempt": row.handed.attempt,
                "is_late": row.handed.is_late,
                "state": row.state,
                "reason": row.reason or row.problem,
                "notes": row.handed.notes,
                "grade": json.loads(row.worth.data) if row.worth else None,
            }
        )
        for row in graded.rows
    ]
    course.write_whole(path, ("\n".join(lines) + "\n").encode())
    return f"{len(lines)} lines"


def _feedback(graded: Class, path: Path) -> str:
    """Write a folder for each student, called as the platform has called the submission."""
    folders = _folders(graded.rows)
    for row in graded.rows:
        grade = graded.grades.get(row.handed.key)
        if grade is None:
            continue
        folder = path / folders[row.handed.key]
        evidence = read_evidence(graded.book.evidence(row.grading))
        course.write_whole(folder / "feedback.md", markdown(grade).encode())
        course.write_whole(folder / "report.html", html(grade, evidence).encode())
    return f"{len(graded.grades)} folders, each with feedback.md and report.html"


def _folders(rows: Sequence[Row]) -> dict[str, str]:
    """Return the name of each student's folder, by key: the platform's, where every system takes it for one of its own."""
    own = {row.handed.key: file_name(row) for row in rows}
    count = Counter(map(as_one_name, [*own.values(), *(row.handed.label for row in rows)]))
    return {
        key: row.handed.label
        if _is_folder(row.handed.label) and count[as_one_name(row.handed.label)] == 1
        else own[key]
        for row in rows
        for key in [row.handed.key]
    }


def _is_folder(label: str) -> bool:
    """Return whether any system can have a folder of this name, and no terminal or spreadsheet takes it for more."""
    is_short = 0 < len(label.encode(errors="replace")) < 200
    # Windows drops points and spaces at the end, and has devices under some names, with whatever stands after a point.
    is_kept = label.strip(" ").rstrip(". ") == label and not is_device(label)
    is_harmless = not re.search(r"[/\\<>:\"|?*`$]", label) and disarmed(visible(label)) == label
    return is_short and is_kept and is_harmless


def _nbgrader(graded: Class, path: Path) -> str:
    """Write nbgrader's gradebook: each criterion is a grade cell, and an instructor's decision a manual score."""
    from nbgrader.api import Gradebook as Nbgrader  # noqa: PLC0415 -- SQLAlchemy is slow to load

    os.environ["PATH"] = environment.lab_environment()["PATH"]  # nbgrader runs alembic
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.name}.part")
    part.unlink(missing_ok=True)
    if path.exists():
        shutil.copyfile(path, part)  # other assignments stay
    assignment = graded.column or "week2"
    with warnings.catch_warnings(), Nbgrader(f"sqlite:///{part.absolute()}") as theirs:
        warnings.simplefilter("ignore")  # of SQLAlchemy, about nbgrader's own code
        theirs.update_or_create_assignment(assignment)
        theirs.update_or_create_notebook(NOTEBOOK, assignment)
        first = next(iter(graded.grades.values()))
        for criterion in first.criteria:
            most = 0 if criterion.component == "bonus" else criterion.max
            cell = criterion.id.translate(GRADE_CELL)
            theirs.update_or_create_grade_cell(cell, NOTEBOOK, assignment, max_score=most, cell_type="code")
        for row in graded.rows:
            if grade := graded.grades.get(row.handed.key):
                _give_in_nbgrader(theirs, assignment, row, grade)
    part.replace(path)
    return f"{len(graded.grades)} submissions for {assignment}"


def _give_in_nbgrader(theirs: object, assignment: str, row: Row, grade: Grade) -> None:
    student = row.handed.student_id or row.handed.key
    last_name = visible(row.handed.name)
    theirs.update_or_create_student(student, last_name=last_name, email=row.handed.email or None)  # type: ignore[attr-defined]
    theirs.update_or_create_submission(assignment, student)  # type: ignore[attr-defined]
    for criterion in grade.criteria:
        cell = criterion.id.translate(GRADE_CELL)
        given = theirs.find_grade(cell, NOTEBOOK, assignment, student)  # type: ignore[attr-defined]
        decided = criterion.override
        given.auto_score = decided.machine if decided else criterion.points
        given.manual_score = decided.points if decided else None
        given.needs_manual_grade = False
    theirs.db.commit()  # type: ignore[attr-defined]


TARGETS: Mapping[str, Write] = {
    "canvas": _canvas,
    "moodle": _moodle,
    "gradescope": _gradescope,
    "nbgrader": _nbgrader,
    "jsonl": _jsonl,
    "feedback": _feedback,
}
