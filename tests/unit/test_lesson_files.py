"""The small changes that lessons make to a student's files."""

from __future__ import annotations

from pathlib import Path

import pytest

from ros2lab import course, files
from ros2lab.files import FileError

TEXT = "name = 'greeter'\nversion = '0.0.0'\nlicence = 'MIT'\n"


@pytest.fixture
def setup(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file of the student's."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    file = tmp_path / "ws" / "setup.py"
    file.parent.mkdir()
    file.write_text(TEXT)
    file.chmod(0o755)
    return file


def test_a_replacement_is_shown_and_keeps_the_rights(setup: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files.replace("~/ws/setup.py", "'0.0.0'", "'1.0.0'")
    assert setup.read_text() == TEXT.replace("0.0.0", "1.0.0")
    assert setup.stat().st_mode & 0o777 == 0o755
    assert "-version = '0.0.0'\n+version = '1.0.0'\n" in capsys.readouterr().out


@pytest.mark.parametrize(("old", "said"), [("'2.0'", "0 times"), ("'", "6 times")])
def test_a_text_that_does_not_stand_there_once_changes_nothing(setup: Path, old: str, said: str) -> None:
    with pytest.raises(FileError, match=said):
        files.replace("~/ws/setup.py", old, "x")
    assert setup.read_text() == TEXT


def test_a_change_that_was_made_before_is_told(setup: Path) -> None:
    files.replace("~/ws/setup.py", "'0.0.0'", "'1.0.0'")
    with pytest.raises(
        FileError, match=r"0 times, but .*1\.0\.0.* stands there: was this change made before"
    ):
        files.replace("~/ws/setup.py", "'0.0.0'", "'1.0.0'")


@pytest.mark.parametrize("new", ["author = 'Ada'", "author = 'Ada'\n", "\nauthor = 'Ada'\nyear = 2026\n"])
@pytest.mark.parametrize("between", ["", "# what came later\n"])
def test_lines_are_not_inserted_twice(setup: Path, new: str, between: str) -> None:
    files.insert_after("~/ws/setup.py", "version", new)
    if between:
        files.insert_after("~/ws/setup.py", "version", between)
    before = setup.read_text()
    with pytest.raises(FileError, match=r"already.*was this change made before"):
        files.insert_after("~/ws/setup.py", "version", new)
    assert setup.read_text() == before


def test_lines_of_which_the_file_holds_only_a_part_are_inserted(setup: Path) -> None:
    files.insert_after("~/ws/setup.py", "licence", "name = 'greet'")
    assert setup.read_text() == TEXT + "name = 'greet'\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("verson = '0.0.0'", r"\"version = '0\.0\.0'\" comes nearest"),
        ("def main():", r"files\.show\('~/ws/setup\.py'\)"),
    ],
)
def test_what_a_text_that_is_not_there_is_to_be_compared_with(setup: Path, text: str, said: str) -> None:
    with pytest.raises(FileError, match=said):
        files.replace("~/ws/setup.py", text, "x")
    with pytest.raises(FileError, match=said):
        files.insert_after("~/ws/setup.py", text, "x")


def test_lines_are_inserted_and_removed(setup: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files.insert_after("~/ws/setup.py", "version", "author = 'Ada'")
    assert setup.read_text().splitlines()[2] == "author = 'Ada'"
    files.remove_lines("~/ws/setup.py", "author")
    assert setup.read_text() == TEXT
    assert capsys.readouterr().out.count("author = 'Ada'") == 2


def test_what_is_written_beside_keeps_what_was_there(setup: Path) -> None:
    copy = setup.with_name("copy.py")
    copy.write_text("mine\n")
    files.remove_lines("~/ws/setup.py", "version", to="~/ws/copy.py")
    assert setup.read_text() == TEXT
    assert copy.read_text() == "name = 'greeter'\nlicence = 'MIT'\n"
    assert [path.read_text() for path in course.earlier_folder().iterdir()] == ["mine\n"]


def test_what_is_removed_is_kept(setup: Path) -> None:
    files.remove("~/ws/setup.py")
    assert not setup.exists()
    assert [path.read_text() for path in course.earlier_folder().iterdir()] == [TEXT]


def test_lines_around_a_text_are_shown(setup: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files.show("~/ws/setup.py", around="version", lines=0)
    assert capsys.readouterr().out == "version = '0.0.0'\n"


@pytest.mark.parametrize("name", ["~/ws/nothing.py", "~/ws"])
def test_a_file_that_is_not_there_is_named(setup: Path, name: str) -> None:
    with pytest.raises(FileError, match=name):
        files.show(name)
    with pytest.raises(FileError, match="No line"):
        files.remove_lines("~/ws/setup.py", "no such text")
