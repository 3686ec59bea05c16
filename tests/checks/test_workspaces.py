"""The checks of `01_workspaces`: right and wrong answers are typed into a real bash, and built by the real colcon."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from ros2lab import environment
from ros2lab.checks import CheckError, workspaces

CREATE = (
    "ros2 pkg create --build-type ament_python --license Apache-2.0 --maintainer-name Ada "
    "--maintainer-email ada@example.org"
)


def type_in(home: Path, lines: str) -> str:
    """Type lines into a new bash whose home folder this is; return what it prints."""
    environ = {**environment.lab_environment(), "HOME": str(home)}
    finished = subprocess.run(
        ["bash", "--noprofile", "--norc", "-ec", lines],
        cwd=home,
        env=environ,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, finished.stdout + finished.stderr
    return finished.stdout


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The student's folder, with a blank in its path."""
    home = tmp_path / "my work"
    home.mkdir()
    monkeypatch.setenv("ROS2LAB_WORK", str(home))
    return home


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace with two packages, as it was built before the source of one was deleted."""
    home = tmp_path_factory.mktemp("home")
    type_in(
        home,
        f"mkdir -p tidy_ws/src; cd tidy_ws/src; {CREATE} --node-name hello greeter; "
        f"{CREATE} --node-name spin old_toy; cd ..; colcon build; mv src/old_toy ..",
    )
    return home / "tidy_ws"


@pytest.fixture
def tidy(home: Path, built: Path) -> Path:
    """The student's folder with a copy of that workspace."""
    type_in(home, f"cp -r '{built}' tidy_ws")
    return home


@pytest.mark.parametrize(
    "lines",
    [
        "mkdir -p ~/garden_ws/src; cd ~/garden_ws; colcon build",
        "mkdir ~/garden_ws; cd ~/garden_ws; mkdir src; colcon build --symlink-install",
        "mkdir -p ~/garden_ws/src && cd ~/garden_ws && colcon build --merge-install",
        "mkdir -p garden_ws/src; (cd garden_ws; colcon build; colcon build)",
        f"mkdir -p ~/garden_ws/src; cd ~/garden_ws/src; {CREATE} rose; cd ..; colcon build",
    ],
)
def test_a_second_workspace(home: Path, lines: str) -> None:
    """However it was made and built, and with or without a package."""
    type_in(home, lines)
    assert workspaces.second_workspace("~/garden_ws").startswith("Right")


@pytest.mark.parametrize(
    ("lines", "found"),
    [
        ("true", "Found: none"),
        ("touch ~/garden_ws", "Found: none"),
        ("mkdir ~/garden_ws; cd ~/garden_ws; colcon build", "Found: build, install, log"),
        ("mkdir -p ~/garden_ws/source; cd ~/garden_ws; colcon build", "Found: build, install, log, source"),
        ("mkdir -p ~/garden_ws/src", "Found: src"),
        ("mkdir -p ~/garden_ws/src; cd ~/garden_ws/src; colcon build", "Found: install in ~/garden_ws/src"),
        ("mkdir -p ~/garden_ws/src; colcon build", "Found: src"),
        ("mkdir -p ~/garden_ws/{src,build,install,log}", "an install without setup.bash"),
        ("mkdir -p ~/garden_ws/{src,build,install,log}; touch ~/garden_ws/install/setup.bash", "it does not"),
        (
            "mkdir -p ~/garden_ws/src; cd ~/garden_ws; colcon build; echo 'return 1' > install/setup.bash",
            "cannot source",
        ),
    ],
)
def test_no_second_workspace(home: Path, lines: str, found: str) -> None:
    """Not made, made elsewhere, not built, built elsewhere, or not by colcon."""
    type_in(home, lines)
    with pytest.raises(CheckError) as error:
        workspaces.second_workspace("~/garden_ws")
    assert found in str(error.value)


def test_the_terminals_are_what_bash_makes_of_them(tidy: Path) -> None:
    """The letters that the check calls right are those whose terminal knows the package."""
    terminals = {
        "a": "cd ~/tidy_ws",
        "b": "source ~/tidy_ws/install/setup.bash; cd /",
        "c": "bash ~/tidy_ws/install/setup.bash",
        "d": "cd ~/tidy_ws; colcon build > /dev/null",
        "e": "source ~/tidy_ws/install/local_setup.bash",
    }
    ask = "ros2 pkg list | grep -x greeter || true"
    known = {name for name, lines in terminals.items() if "greeter" in type_in(tidy, f"{lines}\n{ask}")}
    if "greeter" in type_in(tidy, f"source ~/tidy_ws/install/setup.bash; bash -c '{ask}'"):
        known.add("f")
    assert known == workspaces.KNOWING


@pytest.mark.parametrize(
    "right", [("b", "e", "f"), ("F", "B", "E"), ("b, e, f",), ("bef",), (["e", "f", "b"],)]
)
def test_right_terminals(home: Path, right: tuple[str, ...]) -> None:
    """In any order and writing."""
    assert workspaces.knows_the_package(*right).startswith("Right")


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ((), "Found: none"),
        (("a", "b", "e", "f"), "Found: 'a'"),
        (("b", "c", "e", "f"), "Found: 'c'"),
        (("d",), "Found: 'd'"),
        (("b", "f"), "Found: only b, f"),
        (("e",), "Found: only e"),
        (("b", "e", "f", "z"), "a to f"),
        ((2, 5, 6), "a to f"),
    ],
)
def test_wrong_terminals(home: Path, wrong: tuple[str, ...], said: str) -> None:
    """One too many, one too few, none, or no letters at all."""
    with pytest.raises(CheckError, match="Not yet") as error:
        workspaces.knows_the_package(*wrong)
    assert said in str(error.value)


@pytest.mark.parametrize(
    "lines",
    [
        "cd ~/tidy_ws; rm -r build install log; colcon build",
        "rm -r ~/tidy_ws/build/old_toy ~/tidy_ws/install/old_toy",
        "cd ~/tidy_ws; rm -rf build install; colcon build --merge-install",
        "cd ~/tidy_ws; rm -rf build/* install/*; colcon build --symlink-install",
    ],
)
def test_a_tidy_workspace(tidy: Path, lines: str) -> None:
    """All three deleted and built again, or only what was too much."""
    type_in(tidy, lines)
    assert workspaces.tidy_workspace("~/tidy_ws").startswith("Right")


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("true", "Found: build/old_toy, install/old_toy"),
        ("rm -r ~/tidy_ws", "Found: no ~/tidy_ws/src"),
        ("rm -r ~/tidy_ws/src", "copy it back"),
        ("rm -r ~/tidy_ws/src/greeter", "Found: an empty folder"),
        ("cd ~/tidy_ws; rm -r build install log", "Found: src"),
        ("rm -r ~/tidy_ws/install/old_toy", "Found: build/old_toy"),
        ("cd ~/tidy_ws; cp -r src/greeter src/old_toy; rm -r {build,install}/old_toy", "delete src/old_toy"),
        ("cd ~/tidy_ws; rm -r {build,install}/*toy install/greeter", "from there: nothing"),
        ("cd ~/tidy_ws; rm -r build install; cd src; colcon build", "Found: install in ~/tidy_ws/src"),
    ],
)
def test_no_tidy_workspace(tidy: Path, lines: str, said: str) -> None:
    """Untouched, half done, too much done, or done in the wrong folder."""
    type_in(tidy, lines)
    with pytest.raises(CheckError) as error:
        workspaces.tidy_workspace("~/tidy_ws")
    assert said in str(error.value)


def test_what_is_left_in_a_merged_install_is_noticed(tidy: Path, built: Path) -> None:
    """Without a folder of its own, the package is still known."""
    lines = "rm -r build install; colcon build --merge-install; rm -r src/old_toy build/old_toy"
    type_in(tidy, f"cd ~/tidy_ws; cp -r '{built.parent}/old_toy' src; {lines}")
    with pytest.raises(CheckError, match="old_toy is known after sourcing"):
        workspaces.tidy_workspace("~/tidy_ws")


def test_a_check_leaves_the_folder_as_it_was(tidy: Path) -> None:
    """It looks, and writes nothing but the progress."""
    before = sorted(os.walk(tidy / "tidy_ws"))
    with pytest.raises(CheckError):
        workspaces.tidy_workspace("~/tidy_ws")
    assert sorted(os.walk(tidy / "tidy_ws")) == before
