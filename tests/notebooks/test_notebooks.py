"""Every notebook is executed by nbval, strictly, and reads as a lesson should."""

from __future__ import annotations

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
from nbclient import NotebookClient

from ros2lab import course, edition, environment

HERE = Path(__file__).parent
NOTEBOOKS = course.notebooks()
OF_EACH = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
CELL_TIMEOUT = 120  # s


def run_nbval(path: Path, work: Path) -> subprocess.CompletedProcess[str]:
    """Execute a notebook strictly; the sanitizers beside this file are the only leniency."""
    environ = {
        **environment.lab_environment(),
        "JUPYTER_PATH": str(HERE / "jupyter"),
        "ROS2LAB_WORK": str(work),
    }
    environ.pop("PYTEST_ADDOPTS", None)
    command = [
        sys.executable,
        str(HERE / "patient_nbval.py"),
        "-q",
        "-p",
        "no:cacheprovider",
        f"--nbval-sanitize-with={HERE / 'sanitize.cfg'}",
        f"--nbval-cell-timeout={CELL_TIMEOUT}",
        str(path),
    ]
    return subprocess.run(
        command, cwd=path.parent, env=environ, capture_output=True, text=True, timeout=900, check=False
    )


def code_cells(notebook: Any) -> list[Any]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def spoil(path: Path, destination: Path) -> None:
    """Copy a notebook, with one stored text changed by one letter."""
    notebook = nbformat.read(path, as_version=4)
    for cell in code_cells(notebook):
        for output in cell.outputs:
            if output.output_type == "stream":
                output.text = output.text.replace("e", "3", 1)
                nbformat.write(notebook, destination)
                return
    raise AssertionError(f"{path.name} prints nothing that could be spoilt")


@pytest.mark.timeout(900)
@OF_EACH
def test_a_student_begins_and_the_solved_notebook_gives_the_stored_outputs(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the student edition every check fails with its hint, and nothing else fails.

    Then, in the same folders of any name, the solved one gives what is stored: a second run is like a first one.
    """
    folder, work = tmp_path / "Übung eins", tmp_path / "my work"
    folder.mkdir()
    copy = Path(shutil.copy(path, folder))
    notebook = edition.student_edition(nbformat.read(path, as_version=4))
    for cell in code_cells(executed(notebook, work, monkeypatch)):
        check_as_a_student_left_it(cell)
    finished = run_nbval(copy, work)
    assert finished.returncode == 0, finished.stdout + finished.stderr
    assert sorted(entry.name for entry in folder.iterdir()) == [path.name], (
        "a notebook writes only in the work folder"
    )


def executed(notebook: Any, work: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Run all cells of a notebook in a student's folder, also after one that failed."""
    course.open_work_folder(work)
    for name, value in environment.lab_environment().items():
        monkeypatch.setenv(name, value)
    monkeypatch.delenv("PYTEST_CURRENT_TEST", raising=False)  # with it, ipykernel captures no C code's output
    monkeypatch.setenv("ROS2LAB_WORK", str(work))
    monkeypatch.setenv("JUPYTER_PATH", str(HERE / "jupyter"))
    client = NotebookClient(notebook, timeout=CELL_TIMEOUT, allow_errors=True, kernel_name="ros2lab")
    client.execute(cwd=str(work))
    return notebook


def check_as_a_student_left_it(cell: Any) -> None:
    """Refuse a check that does not fail with a hint, and everything else that fails."""
    errors = [output for output in cell.outputs if output.output_type == "error"]
    if not re.search(r"^check\.", cell.source, re.MULTILINE):
        assert not errors, f"{cell.source}\n{errors}"
        return
    assert [error.ename for error in errors] == ["CheckError"], f"{cell.source}\n{errors}"
    text = "\n".join(errors[0].traceback)
    assert re.search(r"Not yet\. Expected: .+\. Found: .+\. Hint: \w.+", text, re.DOTALL), text


def test_a_spoilt_output_is_objected_to(tmp_path: Path) -> None:
    """One letter that differs fails the run, so a green run means something."""
    copy = tmp_path / "spoilt.ipynb"
    spoil(next(path for path in NOTEBOOKS if path.stem == "00_welcome"), copy)
    finished = run_nbval(copy, tmp_path / "work")
    assert finished.returncode == 1
    assert "Cell outputs differ" in finished.stdout


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
    lengths = [len(cell.source.splitlines()) for cell in cells if cell.cell_type == "code"]
    assert statistics.median(lengths) <= 5
    assert max(lengths) <= 25
    runs = "".join("c" if cell.cell_type == "code" else "m" for cell in cells)
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
    assert code[-2].startswith("check.quiz(")
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
        finished = subprocess.run(
            [*verb, "--help"],
            env=environment.lab_environment(),
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert finished.returncode == 0, f"{command}\n{finished.stderr}"
        missing = [
            word for word in words[len(verb) :] if word.startswith("-") and word not in finished.stdout
        ]
        assert not missing, command


def test_the_folder_holds_only_numbered_notebooks() -> None:
    """Numbers order the lessons and never move."""
    assert NOTEBOOKS, "no notebooks"
    assert all(re.fullmatch(r"\d\d_[a-z0-9_]+\.ipynb", path.name) for path in NOTEBOOKS)
    assert os.environ.get("ROS_DOMAIN_ID"), "kernels inherit the test's own domain"
