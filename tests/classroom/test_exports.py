"""What is handed back: the columns of the platforms, and names that are harmless."""

from __future__ import annotations

import csv
import json
import unicodedata
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from ros2lab.classroom import exports
from ros2lab.classroom.gradebook import Gradebook, Seen, opened
from ros2lab.classroom.handed_in import ClassError, HandedIn
from ros2lab.classroom.judging import Judging
from ros2lab.grading.collect import nothing
from ros2lab.grading.evidence_json import evidence_json

NAMES = ['Müller, Jörg "JM"', "=cmd|' /C calc'!A0", "-2+3", "<img src=x onerror=alert(1)>", "張 偉"]
CODES = "a\u202eb\x9b31m"  # of a terminal, in what the platform has called the third one


@pytest.fixture
def book(tmp_path: Path) -> Iterator[Gradebook]:
    """A class with no points but those that were decided, one for the first, two for the second, and so on."""
    evidence = evidence_json(nothing(tmp_path / "a.zip", "It is <b>broken</b>."))
    with opened(tmp_path / "grades", is_new_allowed=True) as book:
        rows = [
            HandedIn(str(n), name, str(n), label=f"{CODES if n == 2 else name}_{n}_assignsubmission_file_")
            for n, name in enumerate(NAMES)
        ]
        book.register([(row, f"d{row.key}", 0) for row in rows])
        book.decide([(row.key, "workspace.layout", float(row.key), "So be it.", "me") for row in rows])
        by = Judging.of(None, None, book.decisions())
        for row in rows:
            worth = by.worth(evidence, row.key, row.name)
            book.record(f"d{row.key}", by.assignment_digest, "g", Seen(evidence, {}, "", 1), {row.key: worth})
        yield book


def table(path: Path) -> list[list[str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return [*csv.reader(file)]


def test_canvas_gets_its_five_columns_and_harmless_names(book: Gradebook, tmp_path: Path) -> None:
    exports.write("canvas", book, tmp_path / "out.csv", None, "Week 2 (77)")
    header, possible, *rows = table(tmp_path / "out.csv")
    assert header == ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", "Week 2 (77)"]
    assert (possible[0].strip(), possible[-1]) == ("Points Possible", "100")
    by_id = {row[1]: row for row in rows}
    assert by_id["0"][0] == 'Müller, Jörg "JM"'
    assert by_id["1"][0].startswith("'=")
    assert by_id["4"][0] == "張 偉"
    assert {key: row[-1] for key, row in by_id.items()} == {str(n): str(n) for n in range(5)}


def test_what_canvas_has_exported_is_kept_and_filled(book: Gradebook, tmp_path: Path) -> None:
    given = tmp_path / "given.csv"
    given.write_text(
        "\ufeffStudent,ID,SIS User ID,SIS Login ID,Section,Week 1 (5),Week 2 (77),Final Score\r\n"
        "    Points Possible,,,,,10,100,(read only)\r\n"
        '"Müller, Jörg",0,s0,jm,A,-3,,1\r\n'
        '"Nobody, Here",99,s9,no,A,4,17,1\r\n',
        encoding="utf-8",
        newline="",
    )
    with pytest.raises(ClassError, match=r"Week 1 \(5\), Week 2 \(77\)"):
        exports.write("canvas", book, tmp_path / "out.csv", given, "")
    _, said = exports.write("canvas", book, tmp_path / "out.csv", given, "Week 2")
    assert "4 are not in it" in said
    data = (tmp_path / "out.csv").read_text(encoding="utf-8")
    assert data.startswith("\ufeffStudent,")
    _, possible, jm, nobody = table(tmp_path / "out.csv")
    assert possible == ["    Points Possible", "", "", "", "", "10", "100", "(read only)"]
    assert jm == ["Müller, Jörg", "0", "s0", "jm", "A", "-3", "0", "1"]
    assert nobody == ["Nobody, Here", "99", "s9", "no", "A", "4", "17", "1"]


def test_moodle_knows_students_by_its_identifier_in_any_language(book: Gradebook, tmp_path: Path) -> None:
    given = tmp_path / "given.csv"
    given.write_text(
        "Identifier,Full name,Status,Grade,Maximum Grade,Last modified (grade),Feedback comments\n"
        "Teilnehmer/in3,Img Src,Submitted,,100.00,-,\nParticipant 4,偉 張,Submitted,,100.00,-,\nParticipant 44,Z,,,,-,\n"
    )
    exports.write("moodle", book, tmp_path / "out.csv", given, "")
    _, third, fourth, other = table(tmp_path / "out.csv")
    assert (third[3], fourth[3], other[3]) == ("3", "4", "")
    assert third[5] == "-"
    assert third[6].startswith("3 of 100 points.")
    exports.write("moodle", book, tmp_path / "new.csv", None, "")
    header, first, *_ = table(tmp_path / "new.csv")
    assert header[0] == "Identifier"
    assert {"Grade", "Last modified (grade)", "Feedback comments"} <= {*header}
    assert first[0].startswith("Participant ")


def test_moodle_takes_no_more_than_its_maximum_and_the_rest_is_told(book: Gradebook, tmp_path: Path) -> None:
    """Moodle leaves a grade out that is above it, so that who has earned the bonus would have nothing."""
    given = tmp_path / "given.csv"
    given.write_text(
        "Identifier;Grade;Maximum Grade;Last modified (grade)\n"
        "Participant 2;;2,50;-\nParticipant 3;;2,50;-\nParticipant 4\n"
    )
    _, said = exports.write("moodle", book, tmp_path / "out.csv", given, "")
    lines = (tmp_path / "out.csv").read_text().splitlines()
    assert lines[1:] == ["Participant 2;2;2,50;-", "Participant 3;2.5;2,50;-", "Participant 4;4"]
    assert "1 have the most that Moodle takes" in said
    assert "<img" in said


def test_a_comma_that_is_decimal_and_a_semicolon_that_separates_are_kept(
    book: Gradebook, tmp_path: Path
) -> None:
    given = tmp_path / "given.csv"
    given.write_text("LastName;FirstName;ID;Section;Week 1 (5);Week 2 (77)\nMüller;Jörg;0;A;-3,5;\n")
    exports.write("canvas", book, tmp_path / "out.csv", given, "Week 2")
    assert (tmp_path / "out.csv").read_text().splitlines()[1] == "Müller;Jörg;0;A;-3,5;0"
    given.write_text("Student;Section\nX;A\n")
    with pytest.raises(ClassError, match="has no column ID"):
        exports.write("canvas", book, tmp_path / "out.csv", given, "Week 2")


def test_no_grade_is_written_for_another_student(book: Gradebook, tmp_path: Path) -> None:
    """Who has no number of a platform's, or the same as somebody else, is told of instead."""
    handed = [row.handed for row in book.rows()]
    numbers = ("", "", "7", "7", "4")
    book.register(
        [
            (replace(one, student_id=number), f"d{one.key}", 0)
            for one, number in zip(handed, numbers, strict=True)
        ]
    )
    _, said = exports.write("moodle", book, tmp_path / "out.csv", None, "")
    assert [row[0] for row in table(tmp_path / "out.csv")] == ["Identifier", "Participant 4"]
    assert "4 are not in it" in said


CANVAS = "Student,ID,SIS User ID,SIS Login ID,Section,Week 2 (7)\n"
MOODLE = "Identifier,Full name,Email address,Grade\n"


@pytest.mark.parametrize(
    ("line", "label", "is_written"),
    [
        (f'{CANVAS}"Stone, Éva",601,s1,es,A,', "601", True),
        (f'{CANVAS}"Other, Frank",601,s1,fo,A,', "601", False),
        (f'{CANVAS}"Other, Frank",601,s1,eva.s,A,', "601", True),
        (f'{CANVAS}"Other, E.",601,s1,601,A,', "601", False),
        (f'{CANVAS}"Stone, Tim",601,s1,ts,A,\n"Stone, Eva",903,601,es,A,', "601", False),
        (f'{CANVAS}"Stone, Eva",601,601,601,A,', "601", True),
        (f'{CANVAS}"Stone, Eva",903,601,es,A,', "601", False),
        (f'{CANVAS}"The Racers",601,s1,r,A,\n"Stone, Eva",903,601,es,A,', "racers_601_88123", True),
        (f"{MOODLE}Participant 601,Eva M. Stone,x@a.org,", "601", True),
        (f"{MOODLE}Participant 601,Tom Twelve,tom@a.org,", "601", False),
        (f"{MOODLE}Participant 601,Tom Twelve,tom@a.org,", "Éva Stone_601_assignsubmission_file_", False),
        (f"{MOODLE}Participant 601,,,", "601", True),
    ],
    ids=[
        "a name", "another name", "a login", "an initial", "in another column of another line", "in two of one line",
        "of another kind", "a group of Canvas itself", "Moodle", "another one in Moodle", "last year's", "no names",
    ],
)  # fmt: skip
def test_a_number_is_nobodys_who_is_called_otherwise(
    book: Gradebook, tmp_path: Path, line: str, label: str, is_written: bool
) -> None:
    """The number may be the university's, or last year's; the platform knows its own one."""
    last = book.rows()[-1].handed
    book.register([(replace(last, student_id="601", name="Eva Stone", label=label), f"d{last.key}", 0)])
    given = tmp_path / "given.csv"
    given.write_text(f"{line}\n", encoding="utf-8")
    platform, column = ("canvas", "Week 2") if line.startswith(CANVAS) else ("moodle", "")
    _, said = exports.write(platform, book, tmp_path / "out.csv", given, column)
    assert [row[-1] for row in table(tmp_path / "out.csv")[1:]] == ["4" if is_written else "", ""][
        : line.count("\n")
    ]
    assert ("Eva Stone" in said) is not is_written


def test_feedback_lies_in_folders_that_are_called_as_the_platform_calls_them(
    book: Gradebook, tmp_path: Path
) -> None:
    exports.write("feedback", book, tmp_path / "feedback", None, "")
    folders = {path.name for path in (tmp_path / "feedback").iterdir()}
    assert len(folders) == len(NAMES)
    assert "張 偉_4_assignsubmission_file_" in folders
    assert all(name.isprintable() for name in folders)
    assert not any("<" in name or name.startswith(("=", "-")) for name in folders)
    for folder in (tmp_path / "feedback").iterdir():
        assert {path.name for path in folder.iterdir()} == {"feedback.md", "report.html"}
        assert "<img" not in (folder / "report.html").read_text()


def test_a_line_of_json_holds_all_of_a_student(book: Gradebook, tmp_path: Path) -> None:
    exports.write("jsonl", book, tmp_path / "out.jsonl", None, "")
    lines = [json.loads(line) for line in (tmp_path / "out.jsonl").read_text().splitlines()]
    assert {line["name"] for line in lines} == {*NAMES}
    assert {line["student_id"]: line["grade"]["total"] for line in lines} == {str(n): n for n in range(5)}


def test_gradescope_gets_a_results_json_for_each(book: Gradebook, tmp_path: Path) -> None:
    exports.write("gradescope", book, tmp_path / "out", None, "")
    scores = sorted(
        json.loads(path.read_text())["score"] for path in (tmp_path / "out").rglob("results.json")
    )
    assert scores == [0, 1, 2, 3, 4]


@pytest.mark.thorough
def test_nbgraders_gradebook_holds_each_criterion_and_what_was_decided(
    book: Gradebook, tmp_path: Path
) -> None:
    from nbgrader.api import Gradebook as Nbgrader

    for _ in range(2):  # a second export changes nothing
        exports.write("nbgrader", book, tmp_path / "gradebook.db", None, "")
    with Nbgrader(f"sqlite:///{tmp_path / 'gradebook.db'}") as theirs:
        given = theirs.assignment_submissions("week2")
        assert {one.student.id: one.score for one in given} == {str(n): n for n in range(5)}
        assert {one.max_score for one in given} == {100}
        cell = theirs.find_grade("workspace-layout", "robot_controller", "week2", "3")
        assert (cell.auto_score, cell.manual_score) == (0, 3)


def test_an_empty_gradebook_is_not_exported(tmp_path: Path) -> None:
    with (
        opened(tmp_path, is_new_allowed=True) as book,
        pytest.raises(ClassError, match="ros2lab class grade"),
    ):
        exports.write("canvas", book, tmp_path / "out.csv", None, "")


# What a student, or a platform, has called submissions.
LABELS = ["ada", "Ada", "ADA", "Zo\u00eb", "Zoe\u0308", "bo.", "bo", "bo ", "CON", "nul.txt", "com1", "lpt9.tar.gz", "console"]  # fmt: skip
KEPT = {"bo", "console"}


def test_folders_are_safe_and_told_apart_on_every_system(book: Gradebook, tmp_path: Path) -> None:
    """Windows and macOS take names for one that Linux tells apart, and Windows has no file of some."""
    rows = [replace(book.rows()[0].handed, key=label, name=label, label=label) for label in LABELS]
    # Somebody is called as the folder that somebody else would have instead.
    substitute = exports.file_name(replace(book.rows()[0], handed=rows[0]))
    rows.append(replace(rows[0], key="x", name="x", label=substitute.upper()))
    book.register([(row, f"e{row.key}", 0) for row in rows])
    evidence = evidence_json(nothing(tmp_path / "a.zip", "It is broken."))
    by = Judging.of(None, None, book.decisions())
    for row in rows:
        worth = by.worth(evidence, row.key, row.name)
        book.record(f"e{row.key}", by.assignment_digest, "g", Seen(evidence, {}, "", 1), {row.key: worth})
    for target in ("feedback", "gradescope"):
        exports.write(target, book, tmp_path / target, None, "")
        folders = [path.name for path in (tmp_path / target).iterdir()]
        alike = {unicodedata.normalize("NFC", unicodedata.normalize("NFC", f).casefold()) for f in folders}
        assert len(alike) == len(folders) == len(NAMES) + len(rows)
        assert {*folders} & {*LABELS} == KEPT
        for folder in folders:
            assert not folder.endswith((".", " "))
            assert folder.partition(".")[0].casefold() not in ("con", "nul", "com1", "lpt9")
