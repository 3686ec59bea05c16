"""The student edition as a student gets it: every check fails with its hint, and nothing else fails."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

from ros2lab import course, edition, environment

CELL_TIMEOUT = 120  # s


def executed(notebook: Any, work: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Run all cells of a notebook in a student's folder, also after one that failed."""
    course.open_work_folder(work)
    for name, value in environment.lab_environment().items():
        monkeypatch.setenv(name, value)
    monkeypatch.delenv("PYTEST_CURRENT_TEST", raising=False)
    monkeypatch.setenv("ROS2LAB_WORK", str(work))
    monkeypatch.setenv("JUPYTER_PATH", str(Path(__file__).parent / "jupyter"))
    client = NotebookClient(notebook, timeout=CELL_TIMEOUT, allow_errors=True, kernel_name="ros2lab")
    client.execute(cwd=str(work))
    return notebook


@pytest.mark.parametrize("path", course.notebooks(), ids=lambda path: path.stem)
def test_only_the_checks_fail_and_each_gives_a_hint(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    notebook = edition.student_edition(nbformat.read(path, as_version=4))
    checks = 0
    for cell in executed(notebook, tmp_path / "my work", monkeypatch).cells:
        if cell.cell_type != "code":
            continue
        errors = [output for output in cell.outputs if output.output_type == "error"]
        if re.search(r"^check\.", cell.source, re.MULTILINE):
            checks += 1
            assert [error.ename for error in errors] == ["CheckError"], f"{cell.source}\n{errors}"
            text = "\n".join(errors[0].traceback)
            assert re.search(r"Not yet\. Expected: .+\. Found: .+\. Hint: \w.+", text, re.DOTALL), text
        else:
            assert not errors, f"{cell.source}\n{errors}"
    assert checks
