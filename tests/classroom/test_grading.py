"""What there is to do for a class: what is new, changed or failed; what is the same, empty or gone says so."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from ros2lab.classroom import grading, identity, one
from ros2lab.classroom.gradebook import Gradebook, Seen, opened
from ros2lab.classroom.handed_in import HandedIn
from ros2lab.classroom.judging import Judging
from ros2lab.classroom.one import _together, graded_apart
from ros2lab.grading.collect import nothing
from ros2lab.grading.evidence_json import evidence_json


@pytest.fixture
def book(tmp_path: Path) -> Iterator[Gradebook]:
    with opened(tmp_path / "grades", is_new_allowed=True) as book:
        yield book


def handed(folder: Path, key: str, text: str = "x") -> HandedIn:
    path = folder / key
    path.write_text(text)
    return HandedIn(key, key.title(), key, paths=(path,))


def test_the_same_the_empty_and_the_gone_are_rows_with_a_reason_or_a_note(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    rows = [
        handed(tmp_path, "ann"),
        handed(tmp_path, "bob"),
        HandedIn("group", "Group", paths=(tmp_path / "ann",)),
        handed(tmp_path, "empty", ""),
        HandedIn("folder", "Folder", paths=(tmp_path / "folder",)),
        HandedIn("gone", "Gone", paths=(tmp_path / "gone",)),
    ]
    found = {row.key: (row.reason, row.notes) for row, *_ in grading.identified(rows)}
    # Ann may have copied it. The group has it together with her.
    assert found["ann"] == found["group"] == ("", ("It is, byte for byte, what Bob has handed in.",))
    assert [note.partition("what ")[2] for note in found["bob"][1]] == [
        "Ann has handed in.",
        "Group has handed in.",
    ]
    assert found["empty"][0] == found["folder"][0] == grading.EMPTY
    assert "There is no" in found["gone"][0]


def test_an_unreadable_folder_is_told_apart_by_what_can_be_read(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "a/link").symlink_to("/nowhere")
    os.mkfifo(tmp_path / "a/pipe")
    first, _ = identity.submission([tmp_path / "a"])
    (tmp_path / "a/.git").mkdir()
    (tmp_path / "a/.git/FETCH_HEAD").write_text("changes with each fetch")
    assert identity.submission([tmp_path / "a"])[0] == first
    (tmp_path / "a/more").write_text("")
    assert identity.submission([tmp_path / "a"])[0] != first


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ({"src": "one"}, {"src": "two"}),  # links
        ({"src": "one", "to": "a"}, {"src": "one", "to": "b"}),
        ({"a": "b", "cd": None}, {"a": "bc", "d": None}),
    ],
    ids=["to a folder", "to nothing", "and a name"],
)
def test_no_other_submission_has_its_digest(
    tmp_path: Path, before: dict[str, str | None], after: dict[str, str | None]
) -> None:
    digests = set[str]()
    for number, links in enumerate((before, after)):
        folder = tmp_path / str(number)
        for name in ("one", "two"):
            (folder / name).mkdir(parents=True)
            (folder / name / "node.py").write_text(name)
        for name, target in links.items():
            if target is None:
                (folder / name).touch()
            else:
                (folder / name).symlink_to(target)
        digests.add(identity.submission([folder])[0])
    assert len(digests) == 2


def test_what_a_student_puts_in_the_place_of_a_file_meanwhile_is_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The folder may be the student's own, and a pipe or a link may come after the look at it."""
    monkeypatch.setattr("ros2lab.classroom.identity.stat.S_ISREG", lambda _mode: True)
    os.mkfifo(tmp_path / "pipe")
    identity.submission([tmp_path])
    (tmp_path / "link").symlink_to(__file__)
    with pytest.raises(OSError, match="symbolic links"):
        identity.submission([tmp_path])


def test_only_what_is_new_changed_or_failed_is_graded(book: Gradebook, tmp_path: Path) -> None:
    by, grader = Judging.of(None, None, {}), identity.grader()
    evidence = evidence_json(nothing(tmp_path / "a.zip", "It is broken."))
    people = [handed(tmp_path, name, name) for name in ("ann", "bob", "cy")] + [
        handed(tmp_path, "dora", "cy")
    ]
    book.register([*grading.identified(people)])
    rows = book.rows()
    todo = grading.plan(book, by, rows)
    assert [task.students for task in todo.tasks] == [("ann",), ("bob",), ("cy", "dora")]
    digest = rows[0].digest
    book.record(
        digest,
        by.assignment_digest,
        grader,
        Seen(evidence, {}, "", 1),
        {"ann": by.worth(evidence, "ann", "Ann")},
    )
    book.fail(["bob"], "It crashed.")
    todo = grading.plan(book, by, book.rows())
    assert [task.name for task in todo.tasks] == ["Bob", "Cy"]
    assert todo.done == ["ann"]
    assert [task.name for task in grading.plan(book, by, book.rows(), only_failed=True).tasks] == ["Bob"]
    # Handed in again, with what somebody has handed in before: judged, and not run.
    (tmp_path / "bob").write_text("ann")
    book.register([*grading.identified([people[1]])])
    assert grading.plan(book, by, book.rows()).again == {"bob": 1}


def test_another_release_of_a_tool_that_is_asked_is_another_grader(monkeypatch: pytest.MonkeyPatch) -> None:
    before = identity.grader()
    assert identity.grader.__wrapped__() == before
    monkeypatch.setattr(identity, "_release", lambda tool: f"another {tool}")
    assert identity.grader.__wrapped__() != before


def test_loose_files_are_graded_as_a_folder(tmp_path: Path) -> None:
    files = [tmp_path / "a.py", tmp_path / "b.py"]
    for file in files:
        file.write_text(file.name)
    together = _together(files, tmp_path / "together")
    assert sorted(path.name for path in together.iterdir()) == ["a.py", "b.py"]
    assert _together(files[:1], tmp_path / "other") == files[0]


def test_no_file_where_the_command_is_typed_is_taken_for_a_module(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It may be a folder of submissions, or one of them; what it holds is then a student's."""
    for name in ("contextlib", "json", "ros2lab"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("raise SystemExit('imported')\n")
    (tmp_path / "notes.txt").write_text("I have done nothing.\n")
    monkeypatch.chdir(tmp_path)
    seen = graded_apart([Path("notes.txt")], None, lambda _step: None)
    assert seen.problem


def test_what_has_failed_is_said_in_one_sentence() -> None:
    """A RuntimeError brings one; any other error is told with its kind, also one that is a kind of RuntimeError."""
    said = (
        "The grader itself has failed, which is no fault of the submission: KeyError: 'x'. Please report it."
    )
    assert one.failure(RuntimeError(said)) == said
    for error in (KeyError("x"), RecursionError("too deep")):
        told = one.failure(error)
        assert told.count("The grader itself has failed") == 1
        assert type(error).__name__ in told


@pytest.mark.parametrize("deep", [False, True])
def test_what_is_not_received_does_not_keep_a_submission_from_being_read(
    tmp_path: Path, *, deep: bool
) -> None:
    """A path that is too long is left out of the copy, and so is not read here either."""
    folder = tmp_path / "ann"
    folder.mkdir()
    (folder / "node.py").write_text("x")
    (whole, *_) = grading.identified([HandedIn("ann", "Ann", paths=(folder,))])
    here = os.open(folder, os.O_RDONLY)
    for _ in range(1200 if deep else 30):
        name = "d" if deep else "long" * 50
        os.mkdir(name, dir_fd=here)
        above, here = here, os.open(name, os.O_RDONLY, dir_fd=here)
        os.close(above)
    os.close(os.open("file", os.O_CREAT | os.O_WRONLY, dir_fd=here))
    os.close(here)
    (again, *_) = grading.identified([HandedIn("ann", "Ann", paths=(folder,))])
    assert again[0].reason == ""
    assert again[1] == whole[1]
    assert identity.submission([folder])[0] == whole[1]
    subprocess.run(["rm", "-rf", folder], check=True)
