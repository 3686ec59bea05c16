"""The checks of `02_overlays`: right and wrong answers, on workspaces that the real colcon has stacked."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from ros2lab import environment
from ros2lab.checks import CheckError, overlays

CREATE = (
    "ros2 pkg create --build-type ament_python --license Apache-2.0 --maintainer-name Ada "
    "--maintainer-email ada@example.org"
)
# What the notebook does before its exercises.
PREPARE = f"""
mkdir -p ~/team_ws/src ~/mine_ws/src ~/base_ws/src ~/trial_ws/src
cd ~/team_ws/src
{CREATE} --node-name hello greeter
{CREATE} --node-name carry porter
cp -r greeter ~/mine_ws/src
cp -r greeter ~/base_ws/src
cp -r greeter porter ~/trial_ws/src
sed -i 's/Hi/version 2/' ~/base_ws/src/greeter/greeter/hello.py
(cd ~/team_ws; colcon build; source install/setup.bash; cd ~/mine_ws; colcon build)
(cd ~/base_ws; colcon build; source install/setup.bash; cd ~/trial_ws; colcon build)
"""
DELETE = "cd ~/trial_ws; rm -r {src,build,install}/greeter"

Packages = dict[str, list[str]]


def type_in(home: Path, lines: str) -> None:
    """Type lines into a new bash whose home folder this is."""
    finished = subprocess.run(
        ["bash", "--noprofile", "--norc", "-ec", lines],
        cwd=home,
        env={**environment.lab_environment(), "HOME": str(home)},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, finished.stdout + finished.stderr


@pytest.fixture
def empty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The student's folder, with a blank in its path."""
    home = tmp_path / "my work"
    home.mkdir()
    monkeypatch.setenv("ROS2LAB_WORK", str(home))
    return home


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the workspaces of the lesson."""
    folder = tmp_path_factory.mktemp("prepared")
    type_in(folder, PREPARE)
    return folder


@pytest.fixture
def home(empty: Path, prepared: Path) -> Path:
    """The student's folder with those workspaces; what setup.bash remembers is moved with them."""
    type_in(empty, f"cp -r '{prepared}'/*_ws .; sed -i 's|{prepared}|{empty}|' */install/setup.*sh")
    return empty


def from_the_end(package: str, sourced: list[str], packages: Packages) -> str | None:
    for workspace in sourced[::-1]:
        if package in packages[workspace]:
            return workspace
    return None


def with_a_comprehension(package: str, sourced: list[str], packages: Packages) -> str | None:
    holders = [workspace for workspace in sourced if package in packages.get(workspace, [])]
    return holders[-1] if holders else None


def with_an_overwritten_variable(package: str, sourced: list[str], packages: Packages) -> str | None:
    found = None
    for workspace in sourced:
        if packages[workspace].count(package):
            found = workspace
    return found


def with_pop(package: str, sourced: list[str], packages: Packages) -> str | None:
    while sourced:
        workspace = sourced.pop()
        if package in packages[workspace]:
            return workspace
    return None


@pytest.mark.parametrize(
    "right", [from_the_end, with_a_comprehension, with_an_overwritten_variable, with_pop]
)
def test_a_right_rule(empty: Path, right: Callable[..., Any]) -> None:
    """Any way of finding it counts, also one that uses up its arguments."""
    assert overlays.runs_from(right).startswith("Right")


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda package, sourced, packages: None, "needs a return"),
        (lambda package, sourced, packages: sourced[0], "reversed"),
        (lambda package, sourced, packages: sourced[-1] if sourced else None, "reversed"),
        (lambda package, sourced, packages: "mine", "reversed"),
        (
            lambda package, sourced, packages: next(n for n in reversed(sourced) if package in packages[n]),
            "Stop",
        ),
        (lambda package, sourced, packages: with_pop(package, sourced, packages) or "", "None means"),
        (lambda package, sourced, packages: [n for n in sourced if package in packages[n]], "reversed"),
        (lambda package, sourced, packages: with_pop(package, list(packages), packages), "reversed"),
        (lambda package: package, "TypeError"),
        ("mine", "a function"),
        (None, "a function"),
    ],
)
def test_a_wrong_rule(empty: Path, wrong: Any, said: str) -> None:
    """From the bottom, always the top, everything that was built, an exception, no function."""
    with pytest.raises(CheckError) as error:
        overlays.runs_from(wrong)
    assert said in str(error.value)


@pytest.mark.parametrize(
    "right",
    [
        {"a": "mine_ws", "b": "team_ws", "c": "mine_ws"},
        {"c": "~/mine_ws", "b": "~/team_ws/", "a": "~/mine_ws"},
        {"A": "mine", "B": "team", "C": "Mine "},
    ],
)
def test_a_right_prediction(home: Path, right: dict[str, str]) -> None:
    """In any order and writing."""
    assert overlays.which_runs(right).startswith("Right")


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({}, "an answer for terminal a"),
        ({"a": "mine_ws", "b": "team_ws"}, "an answer for terminal c"),
        ({"a": "team_ws", "b": "team_ws", "c": "mine_ws"}, "runs in terminal a"),
        ({"a": "mine_ws", "b": "mine_ws", "c": "mine_ws"}, "runs in terminal b"),
        ({"a": "mine_ws", "b": "team_ws", "c": "team_ws"}, "runs in terminal c"),
        ({"a": "greeter", "b": "team_ws", "c": "mine_ws"}, "the name of a workspace"),
        ({"a": None, "b": None, "c": None}, "the name of a workspace"),
        ("mine_ws", "a dictionary"),
        (None, "a dictionary"),
    ],
)
def test_a_wrong_prediction(home: Path, wrong: Any, said: str) -> None:
    """Wrong in one terminal, incomplete, not a workspace, not a dictionary."""
    with pytest.raises(CheckError) as error:
        overlays.which_runs(wrong)
    assert said in str(error.value)


def test_a_prediction_needs_the_workspaces(empty: Path) -> None:
    """The hint tells which cells make them."""
    with pytest.raises(CheckError, match="run the cells above"):
        overlays.which_runs({"a": "mine_ws", "b": "team_ws", "c": "mine_ws"})


def test_a_prediction_is_held_against_what_happens(home: Path) -> None:
    """Where setup.bash has forgotten the team's workspace, another answer is right."""
    type_in(home, "cp mine_ws/install/local_setup.bash mine_ws/install/setup.bash")
    assert overlays.which_runs({"a": "mine_ws", "b": "team_ws", "c": "team_ws"}).startswith("Right")


@pytest.mark.parametrize(
    "lines",
    [
        DELETE,
        "cd ~/trial_ws; touch src/greeter/COLCON_IGNORE; rm -r {build,install}/greeter",
        "cd ~/trial_ws; mv src/greeter ~/old; rm -r install/greeter",
        "source ~/base_ws/install/setup.bash; cd ~/trial_ws; rm -r src/greeter build install; colcon build",
    ],
)
def test_a_mended_accident(home: Path, lines: str) -> None:
    """Deleted, ignored, moved away, or all built again."""
    type_in(home, lines)
    assert overlays.accident_mended("~/base_ws", "~/trial_ws").startswith("Right")


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("true", "runs from ~/trial_ws/install/greeter"),
        ("rm -r ~/trial_ws/src/greeter", "runs from ~/trial_ws/install/greeter"),
        ("rm -r ~/trial_ws/{build,install}/greeter", "hides ~/base_ws again"),
        ("rm -r ~/trial_ws", "build the workspace first"),
        ("rm -r ~/trial_ws/{build,install,log,src/greeter}", "build the workspace first"),
        (f"{DELETE}; rm -r install/porter", "porter is known"),
        (f"{DELETE}; rm -r ~/base_ws/install/greeter", "greeter is known"),
        (f"{DELETE}; cp install/local_setup.bash install/setup.bash", "greeter is known"),
        (
            f"{DELETE}; sed -i 's/version 2/Hi/' ~/base_ws/install/greeter/lib/python*/*/greeter/hello.py",
            "since the edit",
        ),
        (
            "cp ~/base_ws/src/greeter/greeter/hello.py ~/trial_ws/src/greeter/greeter/; cd ~/trial_ws; colcon build",
            "runs from ~/trial_ws/install/greeter",
        ),
    ],
)
def test_an_accident_that_is_not_mended(home: Path, lines: str, said: str) -> None:
    """Untouched, half done, too much done, the chain lost, or both copies edited."""
    type_in(home, lines)
    with pytest.raises(CheckError) as error:
        overlays.accident_mended("~/base_ws", "~/trial_ws")
    assert said in str(error.value)
