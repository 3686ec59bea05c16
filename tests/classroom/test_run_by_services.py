"""The bundles' scripts, run as Gradescope and GitHub Actions run them, in a folder instead of the service's own."""

from __future__ import annotations

import json
import shutil
import subprocess
import zipfile
from pathlib import Path

import nbformat
import pytest
import yaml
from nbformat import v4

from ros2lab import bundles, course, environment

ROOT = Path(environment.__file__).parents[2]


def run(script: str, folder: Path, **environ: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["bash", "-e", "-o", "pipefail", "-c", script],  # as GitHub's runner does
        cwd=folder,
        env={**environment.lab_environment(), **environ},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


@pytest.mark.parametrize("submission", ["nothing", pytest.param("reference", marks=pytest.mark.thorough)])
def test_gradescope_gets_its_results_from_the_autograder(tmp_path: Path, submission: str) -> None:
    """The zip's own script grades a submission, or one in which there is nothing; either has its results.json.

    One that was there before is no result of a run that fails.
    """
    bundles.gradescope(tmp_path / "autograder.zip", None)
    with zipfile.ZipFile(tmp_path / "autograder.zip") as archive:
        script = archive.read("run_autograder").decode()
    (tmp_path / "source").mkdir()
    (tmp_path / "source/ros2lab").symlink_to(ROOT)  # where setup.sh has installed it
    (tmp_path / "results").mkdir()
    script = script.replace("cd /autograder", f"cd '{tmp_path}'")
    (tmp_path / "submission").mkdir()
    (tmp_path / "submission/node.py").write_text("import rclpy\n")
    (tmp_path / "results/results.json").write_text('{"score": 100}')
    (tmp_path / "bin").mkdir()
    for name in ("bash", "rm"):
        (tmp_path / "bin" / name).symlink_to(f"/bin/{name}")
    failed = run(script, tmp_path, PATH=str(tmp_path / "bin"))
    assert failed.returncode != 0
    assert "bubblewrap is not installed" in failed.stderr
    assert not (tmp_path / "results/results.json").exists()
    shutil.rmtree(tmp_path / "submission")
    if submission == "reference":
        course.copy_reference(tmp_path, "submission", has_tests=False)
    else:
        (tmp_path / "submission").mkdir()
    done = run(script, tmp_path)
    assert done.returncode == 0, done.stderr
    results = json.loads((tmp_path / "results/results.json").read_text())
    assert all(test["name"] for test in results["tests"])
    assert results["score"] > 90 if submission == "reference" else results["score"] == 0


@pytest.mark.thorough  # it builds three times
def test_the_workflow_grades_builds_and_runs_notebooks_in_a_students_repository(tmp_path: Path) -> None:
    """Its steps after the installation, in their order; the summary has the grade, and a fault stands at its line."""
    repository = course.copy_reference(tmp_path, "repository", has_tests=False)
    node = repository / "src/robot_controller/robot_controller/velocity_publisher.py"
    node.write_text(node.read_text().replace("self.create_timer(", "self.create_tmier("))
    tests = repository / "src/robot_controller/test"
    tests.mkdir()
    (tests / "test_own.py").write_text("def test_own():\n    assert True\n")
    bundles.github(repository / ".github/workflows/ros2lab.yml", "https://example.org/lab.git", "3.12")
    workflow = yaml.safe_load((repository / ".github/workflows/ros2lab.yml").read_text())
    steps = {step.get("name"): step for step in workflow["jobs"]["grade"]["steps"]}
    summary = tmp_path / "summary.md"
    graded = run(steps["Grade"]["run"], repository, GITHUB_STEP_SUMMARY=str(summary))
    assert graded.returncode == 0, graded.stderr
    assert "points**" in summary.read_text()
    assert "robot_controller/velocity_publisher.py,line=" in graded.stdout
    built = run(steps["Build and test"]["run"], repository)
    assert built.returncode == 0, built.stdout + built.stderr
    (tests / "test_own.py").write_text("def test_own():\n    assert False\n")
    failed = run(steps["Build and test"]["run"], repository)
    assert failed.returncode == 1
    assert "test_own" in failed.stdout
    notebook = v4.new_notebook(
        cells=[v4.new_code_cell("from robot_controller import status_publisher")],
        metadata={"kernelspec": {"name": "python3", "display_name": "Python 3"}},
    )
    nbformat.write(notebook, repository / "try.ipynb")
    run_again = run(steps["Run the notebooks"]["run"], repository)
    assert run_again.returncode == 0, run_again.stdout
    assert "1 passed" in run_again.stdout
