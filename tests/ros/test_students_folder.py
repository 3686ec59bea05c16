"""A student's folder below another project: nothing of that project's configuration reaches into it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from xml.etree import ElementTree

import pytest

from ros2lab import course, environment

# Each of these would be noticed: an option that nobody knows, and rules that an empty file does not keep.
CONFIGURATION = {
    "pyproject.toml": "[tool.pytest.ini_options]\naddopts = '--no-such-option'\n"
    "[tool.ruff.lint]\nselect = ['D100']\n[tool.mypy]\nno_such_option = true\n",
    ".editorconfig": "root = true\n[*]\nindent_style = tab\n",
    ".gitignore": "work/\n*.py\n",
}
TEST = "def test_true():\n    assert True\n"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Return a git repository full of configuration."""
    project = tmp_path / "a project"
    project.mkdir()
    for name, text in CONFIGURATION.items():
        (project / name).write_text(text)
    subprocess.run(["git", "init", "-q"], cwd=project, check=True)
    return project


@pytest.fixture(params=["inside", pytest.param("made before", marks=pytest.mark.thorough), "a link"])
def work(request: pytest.FixtureRequest, project: Path) -> Path:
    """Return a student's folder below it: new, made by an earlier release, or a link to another project's folder."""
    work = project / "work"
    if request.param == "a link":
        (project / "elsewhere").mkdir()
        work.symlink_to("elsewhere")
    elif request.param == "made before":
        work.mkdir()
        (work / course.MARKER).touch()
    course.open_work_folder(work)
    return work


def plain_environment() -> dict[str, str]:
    """Return the environment of a terminal in which nothing but the .venv was activated."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("GIT_", "COLCON_"))}
    return environment.lab_environment(kept)


def of_the_lab(work: Path) -> dict[str, str]:
    return environment.terminal_environment(work)


def of_ones_own(_work: Path) -> dict[str, str]:
    return plain_environment()


EnvironmentOf = Callable[[Path], dict[str, str]]
TERMINALS = pytest.mark.parametrize(
    "environment_of", [of_the_lab, of_ones_own], ids=["a terminal of the lab", "a terminal of one's own"]
)
# Each of two folders and each terminal once; `make test-all` has all pairs.
_SHOWN = (("inside", of_the_lab), ("a link", of_ones_own))
PAIRS = pytest.mark.parametrize(
    ("work", "environment_of"),
    [
        pytest.param(
            folder,
            environment_of,
            id=f"{folder}-{environment_of.__name__}",
            marks=() if (folder, environment_of) in _SHOWN else pytest.mark.thorough,
        )
        for folder in ("inside", "made before", "a link")
        for environment_of in (of_the_lab, of_ones_own)
    ],
    indirect=["work"],
)


def run(folder: Path, environ: Mapping[str, str], *command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, cwd=folder, env=environ, capture_output=True, text=True, check=False)


@PAIRS
def test_colcon_tests_a_new_package(work: Path, environment_of: EnvironmentOf) -> None:
    """With pytest's defaults; in the lab a test is called what it is called in a folder that is below nothing."""
    environ = environment_of(work)
    workspace = work / "ros2_ws"
    (workspace / "src").mkdir(parents=True)
    created = run(workspace / "src", environ, "ros2", "pkg", "create", "--build-type", "ament_python", "owl")
    assert created.returncode == 0, created.stderr
    for file in (workspace / "src/owl/test").glob("test_*.py"):
        file.unlink()  # those of ROS's own linters
    (workspace / "src/owl/test/test_owl.py").write_text(TEST)
    for verb in ("build", "test"):
        finished = run(workspace, environ, "colcon", verb, "--event-handlers", "console_direct+")
        assert finished.returncode == 0, finished.stdout + finished.stderr
    counted = run(workspace, environ, "colcon", "test-result")
    assert counted.stdout.splitlines()[-1].startswith("Summary: 1 test, 0 errors, 0 failures"), counted.stdout
    [case] = ElementTree.parse(workspace / "build/owl/pytest.xml").iter("testcase")
    assert case.attrib["name"] == "test_true"
    if environment_of is of_the_lab:
        assert case.attrib["classname"] == "owl.test.test_owl"


@TERMINALS
def test_git_finds_no_repository_until_there_is_one(work: Path, environment_of: EnvironmentOf) -> None:
    environ, workspace = environment_of(work), work / "ros2_ws"
    workspace.mkdir()
    (workspace / "node.py").touch()
    before = run(workspace, environ, "git", "status", "--short")
    assert (before.returncode, before.stdout) == (128, "")
    assert before.stderr.startswith("fatal: not a git repository")
    assert run(workspace, environ, "git", "init", "-q").returncode == 0
    assert run(workspace, environ, "git", "status", "--short").stdout == "?? node.py\n"


def test_in_the_lab_git_says_what_it_says_anywhere(work: Path) -> None:
    (work / "ros2_ws").mkdir()
    said = run(work / "ros2_ws", of_the_lab(work), "git", "status").stderr
    assert said == "fatal: not a git repository (or any of the parent directories): .git\n"


def test_the_whole_folder_may_become_a_repository(work: Path) -> None:
    """Git's refusal says how, and what was made then is found from below."""
    assert "remove the file .git" in run(work, of_the_lab(work), "git", "init").stderr
    (work / ".git").unlink()
    assert run(work, of_the_lab(work), "git", "init", "-q").returncode == 0
    course.open_work_folder(work)
    (work / "ros2_ws").mkdir()
    assert run(work / "ros2_ws", of_the_lab(work), "git", "status").returncode == 0


@PAIRS
def test_linters_have_their_defaults(work: Path, environment_of: EnvironmentOf) -> None:
    """Ruff looks at the file, which the project ignores, and asks for no docstring; mypy meets no odd option."""
    (work / "owl.py").write_text("import os\n")
    checked = run(work, environment_of(work), sys.executable, "-m", "ruff", "check", "--no-cache", ".")
    assert "F401" in checked.stdout
    assert "D100" not in checked.stdout
    cache = str(work.parent / "cache")
    typed = run(
        work,
        environment_of(work),
        sys.executable,
        "-m",
        "mypy",
        "--no-color-output",
        f"--cache-dir={cache}",
        "owl.py",
    )
    assert (typed.stdout, typed.stderr) == ("Success: no issues found in 1 source file\n", "")


def test_what_the_student_configures_wins(work: Path) -> None:
    """Nearer files are taken, and none of the student's own is overwritten."""
    package = work / "ros2_ws" / "src" / "owl"
    package.mkdir(parents=True)
    (package / "setup.cfg").write_text("[tool:pytest]\npython_files = check_*.py\n")
    (package / "check_owl.py").write_text(TEST)
    tested = run(package, of_the_lab(work), sys.executable, "-m", "pytest", "-p", "no:cacheprovider")
    assert "configfile: setup.cfg" in tested.stdout
    assert "1 passed" in tested.stdout
    (work / ".ruff.toml").write_text("line-length = 40\n")
    course.open_work_folder(work)
    assert (work / ".ruff.toml").read_text() == "line-length = 40\n"
