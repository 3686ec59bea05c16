"""The student edition: what is cut out, and that nothing of a student's is lost when it is delivered."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output

from ros2lab import course, edition

SOLVED = """\
def answer() -> int:
    \"\"\"Return it.\"\"\"
    ### BEGIN SOLUTION
    return 42
    ### END SOLUTION"""
STUB = """\
def answer() -> int:
    \"\"\"Return it.\"\"\"
    # Write here."""


@pytest.fixture
def shipped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder of worked notebooks that is taken for the course's: one lesson, and what is none."""
    folder = tmp_path / "shipped" / "notebooks"
    (folder / ".ipynb_checkpoints").mkdir(parents=True)
    (folder / "work" / "ros2_ws").mkdir(parents=True)
    for stray in (
        ".ipynb_checkpoints/01_one-checkpoint.ipynb",
        "01_one-Copy1.ipynb",
        "01_one (new 1).ipynb",
        "Untitled.ipynb",
        "work/01_one.ipynb",
        "work/ros2_ws/notes.txt",
        "robot.png",
    ):
        (folder / stray).touch()
    monkeypatch.setattr(course, "_HERE", folder.parent)
    release(folder, "first")
    return folder


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """Return where a student's notebooks are to lie."""
    return tmp_path / "mein Kurs ü" / "notebooks"


def worked(text: str = "text") -> Any:
    """Return a worked notebook."""
    cell = new_code_cell(SOLVED, execution_count=1, outputs=[new_output("stream", text="42")])
    return new_notebook(
        cells=[new_markdown_cell(text), cell],
        metadata={"kernelspec": {"name": "python3", "language": "python", "display_name": "Python 3"}},
    )


def release(folder: Path, text: str) -> None:
    notebook = worked(text)
    for number, cell in enumerate(notebook.cells):
        cell["id"] = f"cell-{number}"
    nbformat.write(notebook, folder / "01_one.ipynb")


def read(folder: Path, name: str = "01_one.ipynb") -> Any:
    return nbformat.read(folder / name, as_version=4)


class TestStudentEdition:
    """The notebook that a student gets."""

    def test_has_a_comment_for_a_solution_and_no_outputs(self) -> None:
        notebook = worked()
        student = edition.student_edition(notebook)
        assert [cell.source for cell in student.cells] == ["text", STUB]
        assert student.cells[1].outputs == []
        assert student.cells[1].execution_count is None
        assert notebook.cells[1].source == SOLVED, "the worked one is as it was"

    @pytest.mark.parametrize("path", course.notebooks(), ids=lambda path: path.stem)
    def test_of_each_lesson_holds_no_solution_and_all_checks(self, path: Path) -> None:
        worked = nbformat.read(path, as_version=4)
        delivered = edition.student_edition(worked)
        before, after = (
            [cell.source for cell in notebook.cells if cell.cell_type == "code"]
            for notebook in (worked, delivered)
        )
        assert "SOLUTION" not in "".join(after)
        assert "".join(before).count("BEGIN SOLUTION") == "".join(after).count(edition.STUB) > 0
        assert "".join(before).count("check.") == "".join(after).count("check.") > 0

    def test_needs_an_end_of_the_solution(self) -> None:
        notebook = new_notebook(cells=[new_code_cell("### BEGIN SOLUTION\nx = 1")])
        with pytest.raises(RuntimeError, match="no end solution"):
            edition.student_edition(notebook)


SAVING = """
import os, signal, sys
from jupyter_server.services.contents.fileio import atomic_writing
with atomic_writing(sys.argv[1]) as file:
    file.write(sys.argv[2])
    file.flush()
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.parametrize(
    "written",
    [
        '{"cells": [',
        '{"cells": ["new"]}',
        *(pytest.param(text, marks=pytest.mark.thorough) for text in ("", "5")),
    ],
)
def test_a_notebook_whose_saving_was_killed_is_whole_again(
    written: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As Jupyter saves it: the text before is in a hidden file, in which nobody would look."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path / "work"))
    notebooks = tmp_path / "work/notebooks"
    notebooks.mkdir(parents=True)
    notebook, before = notebooks / "mine.ipynb", '{"cells": ["before"]}'
    notebook.write_text(before)
    subprocess.run([sys.executable, "-c", SAVING, str(notebook), written], check=False)
    assert notebook.read_text() == written
    is_whole = written.endswith("}")
    assert edition.restore(notebooks) == ([] if is_whole else ["mine.ipynb"])
    assert notebook.read_text() == (written if is_whole else before)
    assert [path.read_text() for path in tmp_path.glob("work/earlier/*")] == ([] if is_whole else [written])
    assert [*notebooks.iterdir()] == [notebook]
    assert edition.restore(notebooks) == []


class TestDelivery:
    """What happens to a student's folder."""

    def test_brings_what_is_missing_once(self, shipped: Path, mine: Path) -> None:
        assert edition.deliver(mine) == (["01_one.ipynb"], [], [], {})
        assert read(mine).cells[1].source == STUB
        assert {path.name for path in mine.iterdir()} == {"01_one.ipynb", edition.RECORD}
        before = (mine / "01_one.ipynb").stat().st_mtime_ns
        assert edition.deliver(mine) == ([], [], ["01_one.ipynb"], {})
        assert (mine / "01_one.ipynb").stat().st_mtime_ns == before

    def test_keeps_what_the_student_wrote(self, shipped: Path, mine: Path) -> None:
        edition.deliver(mine)
        (mine / "01_one.ipynb").write_text("mine")
        assert edition.deliver(mine).kept == ["01_one.ipynb"]
        assert (mine / "01_one.ipynb").read_text() == "mine"

    def test_brings_back_what_was_deleted(self, shipped: Path, mine: Path) -> None:
        edition.deliver(mine)
        (mine / "01_one.ipynb").unlink()
        assert edition.deliver(mine).new == ["01_one.ipynb"]
        assert (mine / "01_one.ipynb").exists()

    def test_renews_what_nobody_has_changed(self, shipped: Path, mine: Path) -> None:
        edition.deliver(mine)
        release(shipped, "second")
        assert edition.deliver(mine).renewed == ["01_one.ipynb"]
        assert read(mine).cells[0].source == "second"

    def test_puts_a_newer_release_beside_the_students_own(self, shipped: Path, mine: Path) -> None:
        edition.deliver(mine)
        (mine / "01_one.ipynb").write_text("mine")
        for number, text in enumerate(("second", "third"), 1):
            release(shipped, text)
            beside = f"01_one (new {number}).ipynb"
            assert edition.deliver(mine).beside == {"01_one.ipynb": beside}
            assert read(mine, beside).cells[0].source == text
            assert edition.deliver(mine).kept == ["01_one.ipynb"], "it is said once"
        assert (mine / "01_one.ipynb").read_text() == "mine"

    def test_without_its_record_takes_everything_for_the_students(self, shipped: Path, mine: Path) -> None:
        edition.deliver(mine)
        (mine / edition.RECORD).write_text("nonsense")
        (mine / "01_one.ipynb").write_text("mine")
        assert list(edition.deliver(mine).beside) == ["01_one.ipynb"]
        assert (mine / "01_one.ipynb").read_text() == "mine"

    def test_knows_what_an_interrupted_delivery_has_brought(
        self, shipped: Path, mine: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Ctrl-C during the first start makes no second copies at the next one."""

        def interrupted(*_: Any) -> None:
            delivered(*_)
            raise KeyboardInterrupt

        delivered = edition._deliver
        with monkeypatch.context() as patch:
            patch.setattr(edition, "_deliver", interrupted)
            with pytest.raises(KeyboardInterrupt):
                edition.deliver(mine)
        assert edition.deliver(mine) == ([], [], ["01_one.ipynb"], {})
        (mine / edition.RECORD).unlink()
        assert edition.deliver(mine) == ([], [], ["01_one.ipynb"], {})

    def test_leaves_a_link_even_if_it_leads_nowhere(self, shipped: Path, mine: Path) -> None:
        mine.mkdir(parents=True)
        (mine / "01_one.ipynb").symlink_to("nowhere")
        for text in ("first", "second"):
            release(shipped, text)
            assert edition.deliver(mine).kept == ["01_one.ipynb"]
        assert (mine / "01_one.ipynb").is_symlink()
