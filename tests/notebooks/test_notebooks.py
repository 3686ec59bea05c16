"""Every notebook reads as a lesson should, and nbval runs it; tests/student goes through all of them."""

from __future__ import annotations

import functools
import os
import re
import shutil
import statistics
import subprocess
import sys
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_notebook, new_output

from deadlines import DEADLINE
from ros2lab import course, environment

ROOT = Path(__file__).parents[2]
NOTEBOOKS = course.notebooks()
OF_EACH = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


def run_nbval(*words: str | Path, folder: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """Execute notebooks as `pytest` followed by these words does where it is typed in a folder."""
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-q", *map(str, words)],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=900,
        check=False,
    )


@functools.cache
def help_text(*verb: str) -> str:
    """Return what a command says of itself, asked once for all lessons that name it."""
    finished = subprocess.run(
        [*verb, "--help"],
        env=environment.lab_environment(),
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=False,
    )
    assert finished.returncode == 0, f"{verb}\n{finished.stderr}"
    return finished.stdout


def code_cells(notebook: Any) -> list[Any]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def spoil(path: Path, destination: Path) -> None:
    """Copy a notebook up to its first stored text, which is changed by one letter."""
    notebook = nbformat.read(path, as_version=4)
    for number, cell in enumerate(notebook.cells):
        for output in cell.get("outputs", ()):
            if output.output_type == "stream":
                output.text = output.text.replace("e", "3", 1)
                notebook.cells = notebook.cells[: number + 1]
                nbformat.write(notebook, destination)
                return
    raise AssertionError(f"{path.name} prints nothing that could be spoilt")


def write_lesson(path: Path) -> None:
    """Write a lesson that prints a word, and puts a file into the student's folder."""
    work = 'import os, pathlib\nwith pathlib.Path(os.environ["ROS2LAB_WORK"], "mine").open("x"):\n    print("hello")'
    said = new_output("stream", name="stdout", text="hello\n")
    kernel = {"name": "python3", "display_name": "Python 3 (ipykernel)", "language": "python"}
    cells = [new_code_cell(work, execution_count=1, outputs=[said])]
    nbformat.write(new_notebook(cells=cells, metadata={"kernelspec": kernel}), path)


def test_a_spoilt_output_is_objected_to(tmp_path: Path) -> None:
    """One letter that differs fails the run, so a green run means something."""
    copy = tmp_path / "spoilt.ipynb"
    spoil(next(path for path in NOTEBOOKS if path.stem == "00_welcome"), copy)
    finished = run_nbval("-p", "conftest", "--nbval", copy)
    assert finished.returncode == 1
    assert "Cell outputs differ" in finished.stdout


@pytest.mark.long
def test_nbval_is_typed_at_the_top_of_the_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Strictly, twice, and laxly; only lessons are run, and nothing is written among them."""
    (tmp_path / "notebooks" / "work").mkdir(parents=True)
    (tmp_path / "tests").symlink_to(ROOT / "tests")
    for name in ("conftest.py", "pyproject.toml"):
        shutil.copy(ROOT / name, tmp_path / name)
    write_lesson(tmp_path / "notebooks" / "00_welcome.ipynb")
    for stray in ("00_welcome-Copy1.ipynb", "test_mine.py", "work/test_mine.py", "work/01_mine.ipynb"):
        (tmp_path / "notebooks" / stray).write_text("This is none.")
    before = {path: path.read_bytes() for path in (tmp_path / "notebooks").rglob("*") if path.is_file()}
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path / "a student's own"))
    for option in ("--nbval", "--nbval", "--nbval-lax"):
        finished = run_nbval(option, "notebooks", folder=tmp_path)
        assert finished.returncode == 0, finished.stdout + finished.stderr
    after = {path: path.read_bytes() for path in (tmp_path / "notebooks").rglob("*") if path.is_file()}
    assert after == before
    assert not (tmp_path / "a student's own").exists()


@OF_EACH
def test_every_code_cell_was_executed_in_order(path: Path) -> None:
    """A notebook is published as one run left it: a cell without a number was never tried."""
    counts = [cell.execution_count for cell in code_cells(nbformat.read(path, as_version=4))]
    assert counts == list(range(1, len(counts) + 1))


@OF_EACH
def test_no_widget_is_stored_without_its_kernel(path: Path) -> None:
    """A reader without a kernel sees pictures, and each has a text."""
    for cell in code_cells(nbformat.read(path, as_version=4)):
        for output in cell.outputs:
            assert output.output_type != "error", output
            if output.output_type == "stream":
                assert output.name == "stdout", output.text
            data = output.get("data", {})
            assert "application/vnd.jupyter.widget-view+json" not in data
            if "image/png" in data:
                assert output.metadata["image/png"]["alt"]


@OF_EACH
def test_cells_are_short_and_told_about(path: Path) -> None:
    """Median of at most 5 lines, 25 at most, and prose between cells, except stub, trial and check."""
    cells = nbformat.read(path, as_version=4).cells
    code = [
        cell for cell in cells if cell.cell_type == "code" and not cell.source.startswith("check.predict(")
    ]
    lengths = [len(cell.source.splitlines()) for cell in code]
    assert statistics.median(lengths) <= 5
    assert max(lengths) <= 25
    # A prediction asks about the cell below it, as prose does.
    runs = "".join("c" if cell in code else "m" for cell in cells)
    assert {len(run) for run in runs.split("m") if run} <= {1, 3}, "code cells without prose between"


@OF_EACH
def test_a_lesson_begins_and_ends_as_a_lesson(path: Path) -> None:
    """Title, objectives, time and prerequisites first; quiz, progress, further work and a link that exists last."""
    cells = nbformat.read(path, as_version=4).cells
    first, last = cells[0].source, cells[-1].source
    assert first.startswith("# ")
    assert 1 <= len(re.findall(r"^\d\. ", first, flags=re.MULTILINE)) <= 5
    assert re.search(r"\*\*Time:\*\* \d+ minutes", first)
    assert "**Before:**" in first
    assert "**Go further:**" in last
    assert "**Next:**" in last or path == NOTEBOOKS[-1]
    code = [cell.source for cell in cells if cell.cell_type == "code"]
    assert code[-2] == "check.quiz()"
    assert code[-1].startswith("Progress(")
    for cell in cells:
        for target in re.findall(r"\]\(([^)#:]+\.ipynb)\)", cell.source):
            assert (path.parent / target).is_file(), f"{path.name} links to {target}"


@OF_EACH
def test_the_commands_in_the_prose_exist(path: Path) -> None:
    """What is in code cells is run; here it is asked whether the verbs and options that the prose names are there."""
    cells = nbformat.read(path, as_version=4).cells
    prose = "\n".join(cell.source for cell in cells if cell.cell_type == "markdown")
    quoted = [block or word for block, word in re.findall(r"```\w*\n(.*?)```|`([^`\n]+)`", prose, re.DOTALL)]
    commands = re.findall(r"^(?:ros2|ros2lab|colcon) [a-z][^\n#&]*", "\n".join(quoted), re.MULTILINE)
    for command in sorted(set(commands)):
        words = command.partition(" --ros-args")[0].split()
        has_subverb = words[0] == "ros2" and words[1] not in ("run", "launch")
        verb = words[: 3 if has_subverb else 2]
        shown = help_text(*verb)
        missing = [word for word in words[len(verb) :] if word.startswith("-") and word not in shown]
        assert not missing, command


def test_the_folder_holds_only_numbered_notebooks() -> None:
    """Numbers order the lessons and never move."""
    assert NOTEBOOKS, "no notebooks"
    assert all(re.fullmatch(r"\d\d_[a-z0-9_]+\.ipynb", path.name) for path in NOTEBOOKS)
    assert os.environ.get("ROS_DOMAIN_ID"), "kernels inherit the test's own domain"
