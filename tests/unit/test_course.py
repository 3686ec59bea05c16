"""The student's folder, and what is copied into it."""

from __future__ import annotations

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


def test_the_notebooks_are_copied_once(work: Path) -> None:
    count = len(course.notebooks())
    assert course.copy_notebooks(work) == (count, 0)
    for path in course.notebooks():
        assert (work / "notebooks" / path.name).read_bytes() == path.read_bytes()
    assert course.copy_notebooks(work) == (0, count)


def test_what_the_student_wrote_is_kept_and_what_is_missing_comes_back(work: Path) -> None:
    course.copy_notebooks(work)
    mine, lost = (work / "notebooks" / path.name for path in course.notebooks()[:2])
    mine.write_text("mine")
    lost.unlink()
    assert course.copy_notebooks(work) == (1, len(course.notebooks()) - 1)
    assert mine.read_text() == "mine"
    assert lost.exists()


def test_a_link_of_the_student_is_kept_even_if_it_leads_nowhere(work: Path) -> None:
    link = work / "notebooks" / course.notebooks()[0].name
    link.parent.mkdir()
    link.symlink_to("nowhere")
    course.copy_notebooks(work)
    assert link.is_symlink()


def test_figures_come_along_and_checkpoints_do_not(
    work: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / "shipped" / "notebooks"
    for name in ("01_one.ipynb", "figures/robot.png", ".ipynb_checkpoints/01_one-checkpoint.ipynb"):
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        (source / name).write_text(name)
    monkeypatch.setattr(course, "_HERE", source.parent)
    assert course.copy_notebooks(work) == (1, 0)
    copied = [path for path in (work / "notebooks").rglob("*") if path.is_file()]
    assert sorted(path.name for path in copied) == ["01_one.ipynb", "robot.png"]


def test_an_interrupted_copy_does_not_pass_for_a_notebook(
    work: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(_source: Path, target: Path) -> None:
        Path(target).write_text("half")
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(shutil, "copyfile", interrupted)
        with pytest.raises(KeyboardInterrupt):
            course.copy_notebooks(work)
    assert course.copy_notebooks(work) == (len(course.notebooks()), 0)


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
