"""The real installer on a copy of the project, and a real wheel. Needs the internet, as installing does."""

from __future__ import annotations

import hashlib
import os
import shutil
import signal
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import ros2lab
from deadlines import DEADLINE
from ros2lab import course

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[2]
NOT_COPIED = (
    ".git",
    ".venv",
    "work",
    "build",
    "install",
    "log",
    "dist",
    "*.egg-info",
    ".*_cache",
    "__pycache__",
)

# Prints how many files of the environment have these contents, before the grader's sandbox and in it.
LOOKS_FOR = """
import subprocess
import sys

from ros2lab.grading.sandbox.worlds import World

COUNT = '''
import hashlib, pathlib, sys
files = (path for path in pathlib.Path(sys.prefix).rglob("*") if path.is_file())
print(sum(hashlib.sha256(path.read_bytes()).hexdigest() in sys.argv[1:] for path in files))
'''
command = [sys.executable, "-I", "-c", COUNT, *sys.argv[1:]]
print(subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip())
with World(None) as world:
    print(world.run(command).output.strip())
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A fresh copy of the project in a folder with spaces and foreign letters."""
    project = tmp_path / "mein Kurs ü"
    shutil.copytree(ROOT, project, symlinks=True, ignore=shutil.ignore_patterns(*NOT_COPIED))
    return project


@pytest.mark.thorough  # an installation that nothing interrupts is made for tests/student
def test_an_interrupted_installation_is_finished_by_the_next_one(project: Path) -> None:
    """Ctrl-C in the middle, then again, and a third time, when there is nothing to do."""
    command = [sys.executable, str(project / "tools" / "bootstrap.py"), "student", "--this-python"]
    first = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    assert first.stderr is not None
    for line in first.stderr:
        if line.startswith("Installing the packages"):
            first.send_signal(signal.SIGINT)
            break
    _, said = first.communicate(timeout=DEADLINE)
    assert first.returncode == 130
    assert said == "Interrupted: nothing is broken, the same command goes on from here.\n"

    second = subprocess.run(command, capture_output=True, text=True, check=False)
    assert second.returncode == 0, second.stderr
    assert "with pip" not in second.stderr  # uv takes the locks as they are
    environ = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    answer = subprocess.run(
        [str(project / ".venv" / "bin" / "ros2lab"), "--version"],
        capture_output=True,
        text=True,
        check=True,
        env=environ,
        cwd="/",
    )
    assert answer.stdout.startswith("ros2lab ")
    packages = {
        path.name.split("-")[0] for path in (project / ".venv").glob("lib/*/site-packages/*.dist-info")
    }
    assert {"jupyterlab", "ros_rclpy", "pip", "uv"} <= packages
    assert not {"playwright", "nbval", "ruff"} & packages

    # A plain shell that activates it has what the lab's own have.
    bare = {name: value for name, value in environ.items() if not name.startswith("ROS_")}
    lines = 'source "$1"; echo "$ROS_AUTOMATIC_DISCOVERY_RANGE"; complete -p ros2; ros2 --version'
    activated = subprocess.run(
        ["bash", "--norc", "-c", lines, "bash", str(project / ".venv" / "bin" / "activate")],
        capture_output=True,
        text=True,
        check=True,
        env=bare,
    )
    assert activated.stderr == ""
    reach, completion, version = activated.stdout.splitlines()
    assert (reach, completion.split()[-1]) == ("LOCALHOST", "ros2")
    assert version.startswith("portable_ros2 ")

    before = _times(project / ".venv")
    third = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (third.returncode, third.stdout, third.stderr) == (0, "", "")
    assert _times(project / ".venv") == before


def test_a_wheel_holds_the_course_itself_and_not_its_links(project: Path, tmp_path: Path) -> None:
    expected = {
        "ros2lab/course/__init__.py",
        *_names(project, "notebooks", "ros2lab/course/notebooks"),
        *_names(project, "robot_project_ws", "ros2lab/course/robot_project_ws"),
        *_names(project, "robot_controller", "ros2lab/course/robot_project_ws/src/robot_controller"),
    }
    for product in (
        "robot_project_ws/build/robot_controller/x.py",
        "robot_project_ws/install/x.py",
        "robot_project_ws/log/x.txt",
        "robot_controller/robot_controller.egg-info/x.txt",
        "robot_controller/robot_controller/__pycache__/x.pyc",
        "notebooks/.ipynb_checkpoints/x.ipynb",
        "notebooks/00_welcome-Copy1.ipynb",
        "notebooks/Untitled.ipynb",
        "notebooks/work/01_mine.ipynb",
        "notebooks/picture.png",
    ):
        (project / product).parent.mkdir(parents=True, exist_ok=True)
        (project / product).touch()

    [wheel] = _wheels(tmp_path, project)
    names = zipfile.ZipFile(wheel).namelist()
    assert {name for name in names if name.startswith("ros2lab/course/")} == expected
    extension = "ros2lab/side_bar/labextensions/ros2lab-progress"
    assert {f"{extension}/{name}" for name in ("package.json", "progress.js", "progress.css")} <= {*names}
    assert "ros2lab/widgets/kernel_end.js" in names


@pytest.mark.parametrize("name", ["ros2lab", "portable_ros2"])
def test_a_distribution_is_the_same_whoever_builds_it_where_and_when(
    name: str, project: Path, tmp_path: Path
) -> None:
    """Its archives are, byte for byte, the wheel from a sdist, too; it has the licence, types and one version."""
    elsewhere = tmp_path / "build" / "project"  # which git would ignore inside of a project
    shutil.copytree(project, elsewhere, symlinks=True)
    for path in elsewhere.rglob("*"):
        if not path.is_symlink():
            path.chmod(path.stat().st_mode & 0o700)
            os.utime(path, (0, 0))
    place = "." if name == "ros2lab" else f"src/{name}"
    wheel, sdist = _built(tmp_path / "here", project / place, "--wheel", "--sdist")
    through_sdist = _built(tmp_path / "there", elsewhere / place, umask=0o077)
    for one, other in zip((wheel, sdist), through_sdist, strict=True):
        assert one.read_bytes() == other.read_bytes(), one.name
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    assert f"{name}/py.typed" in names
    assert f"{name}-{ros2lab.__version__}.dist-info/licenses/LICENSE" in names


@pytest.mark.thorough  # that the solution in a wheel is out of reach is asked in grading/test_wheel.py, too
def test_without_a_checkout_the_wheels_bring_all_that_the_course_needs(project: Path, tmp_path: Path) -> None:
    """As `pip install "ros2lab[ros]"` would, in a new environment: a robot is built and driven in an empty home.

    The worked lessons and the solution that come along are out of reach for a program that is graded.
    """
    wheels, place, home = tmp_path / "wheels", tmp_path / "env", tmp_path / "home"
    _wheels(wheels, project, project / "src" / "portable_ros2")
    home.mkdir()
    uv = str(Path(sys.executable).with_name("uv"))
    subprocess.run([uv, "venv", "--quiet", "--python", sys.executable, str(place)], check=True)
    install = [uv, "pip", "install", "--quiet", "--find-links", str(wheels), "ros2lab[ros]"]
    locks = [
        part for name in ("student", "ros") for part in ("--constraints", str(ROOT / f"locks/{name}.txt"))
    ]
    subprocess.run([*install, *locks, "--python", str(place)], check=True)
    environ = {"HOME": str(home), "PATH": os.defpath}
    commands = place / "bin"
    version = subprocess.run(
        [commands / "ros2", "--version"], capture_output=True, text=True, check=True, env=environ
    )
    assert version.stdout.startswith("portable_ros2 ")
    demo = subprocess.run(
        [commands / "ros2lab", "demo"], capture_output=True, text=True, check=False, env=environ, cwd=home
    )
    assert (demo.returncode, demo.stderr) == (0, ""), demo.stdout + demo.stderr
    assert (home / "work" / "demo_cmd_vel.png").is_file()
    solutions = [
        hashlib.sha256(path.read_bytes()).hexdigest()
        for path in (ROOT / "robot_controller/robot_controller/velocity.py", *course.notebooks())
    ]
    looking = subprocess.run(
        [commands / "python", "-c", LOOKS_FOR, *solutions],
        capture_output=True,
        text=True,
        check=False,
        env=environ,
        cwd=home,
    )
    assert looking.stdout.split() == [str(len(solutions)), "0"], looking.stdout + looking.stderr


def _wheels(folder: Path, *projects: Path) -> list[Path]:
    """Build the projects' wheels into a folder, and return them."""
    options = ["--no-deps", "--no-build-isolation", "--quiet", "--wheel-dir", str(folder)]
    subprocess.run([sys.executable, "-m", "pip", "wheel", *options, *map(str, projects)], check=True)
    return [*folder.glob("*.whl")]


def _built(folder: Path, project: Path, *kinds: str, umask: int = -1) -> list[Path]:
    """Build a wheel and an sdist, the wheel from the sdist where no kinds are named, and return them in this order."""
    command = [str(Path(sys.executable).with_name("uv")), "build", "--quiet", "--no-build-isolation", *kinds]
    options = ["--python", sys.executable, "--out-dir", str(folder), str(project)]
    subprocess.run([*command, *options], check=True, umask=umask)
    return sorted(path for path in folder.iterdir() if path.suffix in (".gz", ".whl"))


def _names(project: Path, folder: str, place: str) -> set[str]:
    """Return where the files of a folder of the project, hidden ones apart, belong in a wheel."""
    paths = (path.relative_to(project / folder) for path in (project / folder).rglob("*") if path.is_file())
    return {f"{place}/{path}" for path in paths if not any(part.startswith(".") for part in path.parts)}


def _times(folder: Path) -> dict[str, int]:
    return {str(path): path.lstat().st_mtime_ns for path in folder.rglob("*")}
