"""The student's folder, and what is copied into it."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Any

import pytest

from ros2lab import course


@pytest.fixture
def work(tmp_path: Path) -> Path:
    """A student's folder that has just been made."""
    work = tmp_path / "mein Kurs ü"
    course.open_work_folder(work)
    return work


def test_the_notebooks_come_in_the_order_of_their_numbers() -> None:
    names = [path.name for path in course.notebooks()]
    assert names == sorted(names)
    assert "00_welcome.ipynb" in names


def test_the_work_folder_is_what_the_environment_says(tmp_path: Path) -> None:
    assert course.work_folder({"ROS2LAB_WORK": "/elsewhere"}, tmp_path) == Path("/elsewhere")
    assert course.work_folder({"ROS2LAB_WORK": "mine"}, tmp_path) == tmp_path / "mine"
    assert course.work_folder({"ROS2LAB_WORK": "~/mine"}, tmp_path) == Path.home() / "mine"


def test_the_work_folder_is_found_from_anywhere_in_it(work: Path) -> None:
    deep = work / "robot_project_ws" / "src"
    deep.mkdir(parents=True)
    assert course.work_folder({}, deep) == work
    assert course.work_folder({}, work) == work


def test_the_work_folder_is_called_work_where_there_is_none_yet(tmp_path: Path) -> None:
    assert course.work_folder({}, tmp_path) == tmp_path / "work"


def test_nothing_is_written_among_the_courses_own_notebooks() -> None:
    """Where another Jupyter opens one of them, the kernel's folder is theirs, as they are linked or as they are."""
    root = Path(__file__).parents[2]
    for place in (root / "notebooks", root / "src/ros2lab/course/notebooks", root / "notebooks" / "below"):
        assert course.work_folder({}, place) == root / "work"


def test_the_reference_is_copied_once_and_stands_on_its_own(work: Path) -> None:
    copy = course.copy_reference(work)
    assert copy == work / "robot_project_ws"
    package = copy / "src" / "robot_controller"
    assert (package / "package.xml").is_file()
    assert not [path for path in copy.rglob("*") if path.is_symlink()]
    (package / "package.xml").write_text("mine")
    assert course.copy_reference(work) == copy
    assert (package / "package.xml").read_text() == "mine"


def test_an_interrupted_copy_of_the_reference_leaves_nothing(
    work: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    before = sorted(work.iterdir())
    with monkeypatch.context() as patch:
        patch.setattr(shutil, "copystat", interrupted)
        with pytest.raises(KeyboardInterrupt):
            course.copy_reference(work)
    assert sorted(work.iterdir()) == before


def test_the_reference_is_copied_without_what_was_built_in_it(
    work: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "shipped" / "robot_project_ws"
    for name in ("src/pk/package.xml", "build/x", "install/x", "log/x", "src/pk/__pycache__/x.pyc"):
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        (source / name).touch()
    monkeypatch.setattr(course, "_HERE", source.parent)
    copied = [path for path in course.copy_reference(work).rglob("*") if path.is_file()]
    assert [path.name for path in copied] == ["package.xml"]


def test_a_terminals_path_is_in_the_students_folder(work: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS2LAB_WORK", str(work))
    assert course.student_path("~/ros2_ws/src") == work / "ros2_ws" / "src"
    assert course.student_path("ros2_ws") == work / "ros2_ws"
    assert course.student_path("~") == work
    assert course.student_path("/opt/ros/jazzy") == Path("/opt/ros/jazzy")
    assert course.shown_path(work / "ros2_ws") == "~/ros2_ws"
    assert course.shown_path(work) == "~"
    assert course.shown_path(Path("/opt/ros")) == "/opt/ros"


def test_starting_over_keeps_what_was_there(
    work: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROS2LAB_WORK", str(work))
    said = set()
    for number in range(3):
        course.start_over("~/ros2_ws")
        said.add(capsys.readouterr().out)
        assert not (work / "ros2_ws").exists()
        (work / "ros2_ws").mkdir()
        (work / "ros2_ws" / "mine.txt").write_text(str(number))
    assert len(said) == 1, "a run after the first prints the same"
    kept = {path.name: (path / "mine.txt").read_text() for path in (work / "earlier").iterdir()}
    assert kept == {"ros2_ws-1": "0", "ros2_ws-2": "1"}


def test_a_link_that_somebody_has_put_in_a_shared_folder_leads_no_writer_to_another_file(
    tmp_path: Path,
) -> None:
    theirs, file = tmp_path / "kept.txt", tmp_path / "shared" / "file.txt"
    theirs.write_bytes(b"kept")
    file.parent.mkdir()
    for link in file, file.with_name(f".file.txt.{os.getpid()}.part"):
        link.symlink_to(theirs)
    course.write_whole(file, b"new")
    assert (theirs.read_bytes(), file.read_bytes(), file.is_symlink()) == (b"kept", b"new", False)


def test_what_is_open_already_is_written_to_and_stays_what_it_is(tmp_path: Path) -> None:
    """As /dev/stdout is, which root would replace by a file."""
    reading, writing = os.pipe()
    with os.fdopen(reading, "rb") as pipe, (tmp_path / "file.txt").open("w+b") as file:
        course.write_whole(Path(f"/proc/self/fd/{writing}"), b"a report")
        course.write_whole(Path(f"/dev/fd/{file.fileno()}"), b"another")
        os.close(writing)
        assert (pipe.read(), file.read()) == (b"a report", b"another")


def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(_handle: int) -> None:
        raise KeyboardInterrupt

    file = tmp_path / "new folder" / "file.txt"
    course.write_whole(file, b"before")
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", interrupted)
        with pytest.raises(KeyboardInterrupt):
            course.write_whole(file, b"after")
    assert file.read_bytes() == b"before"
