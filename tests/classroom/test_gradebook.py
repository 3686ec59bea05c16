"""The gradebook: one transaction for each submission, whatever happens; old ones open, foreign ones do not."""

from __future__ import annotations

import json
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest

from deadlines import DEADLINE
from ros2lab.classroom import gradebook, judging
from ros2lab.classroom.gradebook import MIGRATIONS, NAME, Gradebook, Seen, Worth, opened
from ros2lab.classroom.handed_in import ClassError, HandedIn
from ros2lab.classroom.judging import Judging
from ros2lab.grading.collect import nothing
from ros2lab.grading.evidence_json import evidence_json

ANN, BOB = HandedIn("1", "Ann", "1"), HandedIn("2", "Bob", "2")
SEEN = Seen("{}", {"a.py": "x = 1"}, "", 6.0)
REGRADE = [Path(sys.executable).with_name("ros2lab"), "class", "regrade"]
WORTH = Worth(90, 100, "{}", "rubric")


@pytest.fixture
def book(tmp_path: Path) -> Iterator[Gradebook]:
    with opened(tmp_path, is_new_allowed=True) as book:
        yield book


def states(book: Gradebook) -> dict[str, tuple[str, float | None]]:
    return {row.handed.key: (row.state, row.worth.total if row.worth else None) for row in book.rows()}


def test_what_was_recorded_is_not_graded_again_until_something_changes(book: Gradebook) -> None:
    book.register([(ANN, "d1", 0), (BOB, "d2", 0)])
    book.record("d1", "assignment", "grader", SEEN, {"1": WORTH})
    assert states(book) == {"1": ("graded", 90), "2": ("waiting", None)}
    assert book.current("assignment", "grader") == {"1"}
    assert book.current("another", "grader") == book.current("assignment", "another") == set()
    book.register([(ANN, "d1", 5)])
    assert book.current("assignment", "grader") == {"1"}
    book.register([(ANN, "d3", 6)])
    assert states(book)["1"] == ("waiting", None)
    assert book.graded_before("assignment", "grader") == {"d1": 1}


class Crashing:
    """A connection that fails at its nth statement, as a full disk does."""

    def __init__(self, connection: sqlite3.Connection, statements: int) -> None:
        self.connection, self.left = connection, statements

    def execute(self, *words: Any) -> sqlite3.Cursor:
        if self.left == 0:
            raise sqlite3.OperationalError("database or disk is full")
        self.left -= 1
        return self.connection.execute(*words)


def test_a_crash_between_any_two_statements_leaves_the_gradebook_as_it_was_or_new(tmp_path: Path) -> None:
    """The process is gone at every place of a record in turn; what another one then opens is before or after."""
    outcomes = []
    for statements in range(20):
        folder = tmp_path / str(statements)
        with opened(folder, is_new_allowed=True) as book:
            book.register([(ANN, "d", 0), (BOB, "d", 0)])
            connection = book._sql
            book._sql = Crashing(connection, statements)  # type: ignore[assignment]
            try:
                book.record("d", "assignment", "grader", SEEN, {"1": WORTH, "2": WORTH})
                is_done = True
            except sqlite3.OperationalError:
                is_done = False
            connection.close()  # without the end of the transaction, as a kill does
        with opened(folder) as again:
            graded = {("graded", 90.0)} == {*states(again).values()}
            assert graded or {*states(again).values()} == {("waiting", None)}
            assert len(again.graded_before("assignment", "grader")) == graded
            outcomes.append((is_done, graded))
    assert outcomes[0] == (False, False)
    assert outcomes[-1] == (True, True)
    assert (False, True) not in outcomes


def test_a_failure_is_a_row_with_a_reason_and_gives_no_grade(book: Gradebook) -> None:
    book.register([(ANN, "d1", 0), (HandedIn("3", "Cy", reason="It is empty."), "", 0)])
    book.fail(["1"], "The grader ended with -9.")
    (ann, cy) = book.rows()
    assert (ann.state, ann.reason, ann.worth) == ("failed", "The grader ended with -9.", None)
    assert (cy.state, cy.reason) == ("unreadable", "It is empty.")


def test_names_that_are_no_text_are_stored(book: Gradebook) -> None:
    odd = HandedIn("k\udcff", "Ä, \udcff\0=1", paths=(Path("a\udcff"),))
    book.register([(odd, "d", 0)])
    (row,) = book.rows()
    assert row.handed.paths == (Path("a\udcff"),)
    assert "\\udcff" in row.handed.name


def test_two_commands_cannot_have_it_at_once(tmp_path: Path) -> None:
    with (
        opened(tmp_path, is_new_allowed=True),
        pytest.raises(ClassError, match="Another command"),
        opened(tmp_path),
    ):
        pass


def test_without_a_gradebook_the_sentence_says_what_to_type(tmp_path: Path) -> None:
    with pytest.raises(ClassError, match="ros2lab class grade"), opened(tmp_path):
        pass


def test_a_gradebook_of_a_newer_release_is_refused(tmp_path: Path) -> None:
    with opened(tmp_path, is_new_allowed=True) as book:
        book._sql.execute(f"PRAGMA user_version = {len(MIGRATIONS) + 1}")
    with pytest.raises(ClassError, match="newer"), opened(tmp_path):
        pass


def test_a_gradebook_of_an_older_release_is_brought_up_to_date(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with opened(tmp_path, is_new_allowed=True) as book:
        book.register([(ANN, "d", 0)])
    newer = (*MIGRATIONS, ("ALTER TABLE submission ADD COLUMN section TEXT NOT NULL DEFAULT ''",))
    monkeypatch.setattr(gradebook, "MIGRATIONS", newer)
    with opened(tmp_path) as book:
        assert [row.handed.name for row in book.rows()] == ["Ann"]
        assert book._sql.execute("SELECT section FROM submission").fetchall() == [("",)]
        assert book._sql.execute("PRAGMA user_version").fetchone() == (len(newer),)


def test_another_programs_database_and_a_file_that_is_none_are_refused(tmp_path: Path) -> None:
    with sqlite3.connect(tmp_path / NAME) as other:
        other.execute("CREATE TABLE birds (name)")
    other.close()
    with pytest.raises(ClassError, match="another program"), opened(tmp_path):
        pass
    (tmp_path / NAME).write_bytes(b"no database" * 100)
    with pytest.raises(ClassError, match="no gradebook"), opened(tmp_path):
        pass


def test_a_decision_survives_every_regrade_and_can_be_taken_back(book: Gradebook, tmp_path: Path) -> None:
    evidence = evidence_json(nothing(tmp_path / "a.zip", "It is broken."))
    book.register([(ANN, "d", 0)])
    plain = Judging.of(None, None, {})
    book.record(
        "d",
        plain.assignment_digest,
        "grader",
        Seen(evidence, {}, "", 1),
        {"1": plain.worth(evidence, "1", "Ann")},
    )
    assert judging.regrade(book, plain, book.rows()).judged == 0
    book.decide([("1", "documentation.readme", 2.0, "It came by mail.", "I. Structor")])
    for expected in ((1, 1), (0, 0)):
        by = Judging.of(None, None, book.decisions())
        done = judging.regrade(book, by, book.rows())
        assert (done.judged, done.changed) == expected
        (row,) = book.rows()
        assert row.worth is not None
        assert row.worth.total == 2
        assert "It came by mail." in row.worth.data
    assert book.withdraw("1", "documentation.readme")
    judging.regrade(book, Judging.of(None, None, book.decisions()), book.rows())
    (row,) = book.rows()
    assert row.worth is not None
    assert row.worth.total == 0
    assert json.loads(row.worth.data)["submission"] == "Ann"
    assert judging.read_grade(row.worth.data).total == 0


def class_of(count: int, folder: Path, evidence: Callable[[str], str]) -> None:
    """Write a gradebook of so many students, graded by an older rubric, with the evidence on each."""
    by = Judging.of(None, None, {})
    with opened(folder, is_new_allowed=True) as book:
        for number in range(count):
            student = HandedIn(f"{number}", f"Student {number}", f"{number}")
            book.register([(student, student.key, 0)])
            seen = Seen(evidence(student.name), {}, "", 1)
            book.record(student.key, by.assignment_digest, "g", seen, {student.key: WORTH})


def test_a_whole_class_is_judged_again_by_several_processes_as_by_one(tmp_path: Path) -> None:
    broken = evidence_json(nothing(tmp_path / "a.zip", "It is broken."))
    unreadable = {"Student 7", "Student 47", "Student 87"}
    class_of(
        2 * judging.AT_ONCE + 3,
        tmp_path,
        lambda name: broken.replace('"schema": ', '"schema": 9') if name in unreadable else broken,
    )
    done = subprocess.run([*REGRADE, tmp_path], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert {line.partition(" keeps")[0] for line in done.stderr.splitlines()} == unreadable
    assert done.stdout == "Of 103 grades 100 were judged again, and 100 have other points now.\n"
    by = Judging.of(None, None, {})
    with opened(tmp_path) as book:
        for row in book.rows():
            if row.handed.name not in unreadable:
                assert row.worth == by.worth(book.evidence(row.grading), row.handed.key, row.handed.name)


def test_processes_that_judge_again_end_with_the_one_that_is_killed(tmp_path: Path) -> None:
    evidence = evidence_json(nothing(tmp_path / "a.zip", "It is broken."))
    class_of(20 * judging.AT_ONCE, tmp_path, lambda _name: evidence)
    command = psutil.Popen([*REGRADE, tmp_path])
    started = list[psutil.Process]()
    deadline = time.monotonic() + DEADLINE
    while len(started) < 3 and time.monotonic() < deadline:  # two judges, and who cleans up after them
        started = command.children()
    assert len(started) >= 3
    command.kill()
    command.wait(DEADLINE)
    _, left = psutil.wait_procs(started, DEADLINE)
    assert not left


def test_a_class_is_not_judged_by_another_assignment_and_loses_nothing(
    book: Gradebook, tmp_path: Path
) -> None:
    evidence = evidence_json(nothing(tmp_path / "a.zip", "It is broken."))
    by = Judging.of(None, None, {})
    for student, text in ((ANN, evidence), (BOB, evidence.replace('"schema": ', '"schema": 9'))):
        book.register([(student, student.key, 0)])
        seen = Seen(text, {}, "", 1)
        book.record(
            student.key, by.assignment_digest, "g", seen, {student.key: by.worth(evidence, student.key, "x")}
        )
    other = Judging.of(Path(__file__).parents[2] / "docs/examples/lamp", None, {})
    with pytest.raises(ClassError, match="--assignment"):
        judging.regrade(book, other, book.rows())
    book.decide([(one, "documentation.readme", 1.0, "So be it.", "me") for one in ("1", "2")])
    done = judging.regrade(book, Judging.of(None, None, book.decisions()), book.rows())
    assert (done.judged, [*done.problems]) == (1, ["Bob"])
    assert states(book) == {"1": ("graded", 1), "2": ("graded", 0)}
