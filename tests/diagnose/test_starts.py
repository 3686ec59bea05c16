"""The programs that a trial starts: as often as a launch file does, each with the parameters that count there."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from right_workspace import right_workspace
from test_trial import build

from ros2lab.diagnose.look import Look
from ros2lab.grading.watching.job import Program
from ros2lab.trial import try_out
from ros2lab.trial.starts import MOST_PROGRAMS, programs_of

NODE = "Node(package='my_bot', executable='velocity_publisher', parameters=[config]),"
AGAIN = NODE.replace("parameters=[config]", "MORE")


def started(more: str, folder: Path, given: str = "parameters=[config]") -> list[Program]:
    """Return what is started of a workspace whose launch file starts a node once more, with other arguments."""
    files = right_workspace().put("config/second.yaml", "/**:\n  ros__parameters: {speed: 0.5}\n")
    files.change("launch/robot.launch.py", NODE, NODE.replace("parameters=[config]", given) + more)
    root = files.write(folder)
    (root / "install/my_bot/share/ament_index/resource_index/packages").mkdir(parents=True)
    (root / "install/my_bot/share/ament_index/resource_index/packages/my_bot").touch()
    programs = root / "install/my_bot/lib/my_bot"
    programs.mkdir(parents=True)
    for name in ("status_publisher", "velocity_publisher"):
        (programs / name).touch(0o755)
    scratch = folder / "scratch"
    scratch.mkdir()
    return programs_of(Look(root, loads=True), {}, scratch)


@pytest.mark.parametrize(
    ("more", "names", "word"),
    [
        ([], [], ""),
        (["namespace='r2'"], ["r2"], "__ns:=/r2"),
        (["namespace='fleet/r2'"], ["fleet.r2"], "__ns:=/fleet/r2"),
        (["name='left'"], ["left"], "__node:=left"),
        (["parameters=[{'speed': 0.1}]"], ["2"], "--params-file"),
        (["remappings=[('/cmd_vel', '/turn')]"], ["2"], "/cmd_vel:=/turn"),
        (["namespace='a'", "namespace='b'", "namespace='a', name='c'"], ["a", "b", "c"], "__ns:=/a"),
        (["parameters=[config]"], [], ""),
        (["namespace='a'", "namespace='a'"], ["a"], "__ns:=/a"),
        (["namespace='a'", "namespace='a', parameters=[{'speed': 0.1}]"], ["a", "a 2"], "__ns:=/a"),
        (["name='a'", "namespace='a'"], ["a", "a 2"], "__node:=a"),
    ],
)
def test_an_executable_is_started_as_often_as_launch_does(
    tmp_path: Path, more: list[str], names: list[str], word: str
) -> None:
    programs = started("".join(AGAIN.replace("MORE", one) for one in more), tmp_path)
    others = [f"velocity_publisher ({name})" for name in names]
    assert [program.name for program in programs] == ["status_publisher", "velocity_publisher", *others]
    assert all(Path(program.command[0]).name == program.name for program in programs)
    assert not word or word in programs[2].command


def test_starts_of_two_packages_have_names_of_their_own(tmp_path: Path) -> None:
    """Also the first ones, where their executables have the same name."""
    started(AGAIN.replace("MORE", "namespace='r2'"), tmp_path)
    for path in [tmp_path / "src/my_bot", tmp_path / "install/my_bot"]:
        shutil.copytree(path, path.with_name("my_bot2"))
    renamed = [path for path in tmp_path.rglob("*my_bot") if "my_bot2" in str(path.parent)]
    for path in sorted(renamed, reverse=True):
        path.rename(path.with_name("my_bot2"))
    for path in (tmp_path / "src/my_bot2").rglob("*.*"):
        path.write_text(path.read_text().replace("my_bot", "my_bot2"))
    scratch = tmp_path / "more"
    scratch.mkdir()
    programs = programs_of(Look(tmp_path, loads=True), {}, scratch)
    assert [program.name for program in programs] == [
        *("status_publisher", "velocity_publisher", "status_publisher (2)", "velocity_publisher (2)"),
        *("velocity_publisher (r2)", "velocity_publisher (r2 2)"),
    ]
    assert all(Path(program.command[0]).name == program.name for program in programs)
    assert {Path(program.command[0]).resolve().parent.name for program in programs[2:4]} == {"my_bot2"}


def test_there_are_not_too_many_and_each_executable_is_among_them(tmp_path: Path) -> None:
    many = f"*[{AGAIN.replace('MORE', 'namespace=str(i)').rstrip(',')} for i in range(20)],"
    names = [program.name for program in started(many, tmp_path)]
    assert len(names) == MOST_PROGRAMS
    assert names[:2] == ["status_publisher", "velocity_publisher"]


@pytest.mark.parametrize(
    ("given", "in_order"),
    [
        ("parameters=[{'speed': 0.1}, config]", ["velocity_publisher-0", "robot"]),
        ("parameters=[config, {'speed': 0.1}]", ["robot", "velocity_publisher-1"]),
        ("parameters=[config, '/nowhere.yaml']", ["robot"]),
        ("parameters=[config, config.replace('robot', 'second')]", ["robot", "second"]),
    ],
)
def test_parameters_are_given_in_the_order_of_launch(tmp_path: Path, given: str, in_order: list[str]) -> None:
    program = started("", tmp_path, given)[1]
    files = [Path(word).stem for word in program.command if str(word).endswith(".yaml")]
    assert [name.removeprefix("my_bot-") for name in files] == in_order


def test_each_start_is_told_with_what_it_did_itself(tmp_path: Path) -> None:
    """Two robots on one topic, with the speed that comes last for each of them."""
    files = right_workspace().put(
        "config/robot.yaml", "/r2/velocity_publisher:\n  ros__parameters: {speed: 0.4}\n"
    )
    node = NODE.replace("[config]", "[{'speed': 0.2}, config]")
    files.change(
        "launch/robot.launch.py", NODE, node + node.replace("executable", "namespace='r2', executable")
    )
    root = files.only("driver").write(tmp_path)
    build(root)
    story = try_out(root).story
    told = {line.partition(" published")[0]: line for line in story if line.startswith("velocity_publisher")}
    assert [*told] == ["velocity_publisher", "velocity_publisher (r2)"]
    assert [f"linear.x = {speed}" in line for speed, line in zip((0.2, 0.4), told.values(), strict=True)] == [
        True,
        True,
    ], story
