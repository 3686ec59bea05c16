"""How many of a README's commands are true decides what it earns, and that one of them starts a node."""

from __future__ import annotations

import functools
import itertools

import evidences
import pytest

from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

BUILD = "colcon build"
RUNS = [
    f"ros2 run robot_controller {name}" for name in (evidences.STATUS, evidences.COMMAND, evidences.VELOCITY)
]
LAUNCH = "ros2 launch robot_controller robot.launch.py"
SAY = "ros2 topic pub --once /robot/command std_msgs/msg/String '{data: start}'"
ALL = (BUILD, *RUNS, LAUNCH, SAY)
WRONG = "ros2 run robot_controller nobody"
OPTION = f"{RUNS[0]} --ros-args -p status_period:=0.5"


@functools.cache  # one subset of commands is compared with many others
def share(true: tuple[str, ...], *false: str, misgiven: tuple[str, ...] = ()) -> float:
    """Return the share of the points for a README's commands."""
    commands = {**dict.fromkeys(true, True), **dict.fromkeys((*false, *misgiven), False)}
    change = evidences.files(readme_commands=commands, readme_misgiven=[*misgiven])
    grade = verdict(change(evidences.right()), load())
    one = next(one for one in grade.criteria if one.id == "documentation.commands")
    return one.points / one.max


@pytest.mark.parametrize(
    ("true", "false", "misgiven", "expected"),
    [
        (ALL, (), (), 1),
        (ALL, (), (OPTION,), 0.75),
        ((*ALL[:-2], SAY), ("ros2 launch robot_controller other.launch.py",), (), 0.5),
        ((BUILD, *RUNS), ("ros2 topic pub /robot/comand std_msgs/msg/String '{}'", "ros2 topic echo /x"), (), 0.5),
        (ALL[:-1], ("ros2 topic pub --once /robot/comand std_msgs/msg/String '{data: start}'",), (), 0.75),
        ((BUILD, RUNS[0]), (WRONG,), (), 0.5),
        ((BUILD,), (WRONG,), (), 0),
        ((BUILD, SAY, "colcon test", "colcon build --symlink-install"), (WRONG,), (), 0),
        ((BUILD,), tuple(run.replace("robot_controller", "py_pubsub") for run in RUNS), (), 0),
        ((), (WRONG,), (), 0),
        ((BUILD, *RUNS[:2]), ("rostopic pub /robot/command std_msgs/String start",), (), 0.5),
    ],
    ids=[
        "all true", "one option", "the launch line", "two of six", "a misspelt topic", "one of two", "the only one",
        "none that starts a node", "another package", "nothing true", "one of ROS 1",
    ],
)  # fmt: skip
def test_the_share_of_true_commands_counts(
    true: tuple[str, ...], false: tuple[str, ...], misgiven: tuple[str, ...], expected: float
) -> None:
    assert share(true, *false, misgiven=misgiven) == expected


@pytest.mark.parametrize("number", range(1, len(ALL) + 1))
def test_one_more_true_command_never_costs_and_one_more_false_one_never_earns(number: int) -> None:
    for some in itertools.combinations(ALL, number):
        for one in some:
            left = tuple(command for command in some if command != one)
            others = (WRONG, "ros2 run robot_controller no_one")
            assert share(left, *others) <= share(some, *others) <= share(some, *others[:1]) <= share(some)


@pytest.mark.parametrize("command", [BUILD, RUNS[0], LAUNCH])
def test_what_fails_for_want_of_a_package_xml_is_charged_there(command: str) -> None:
    """The name of the package stands in setup.py, too."""
    changes = [evidences.unbuilt("no"), evidences.files(manifest={"is_there": False})]
    changes += [evidences.facts("setup", "installs_modules")]
    changes += [evidences.files(readme_commands=dict.fromkeys((BUILD, RUNS[0], command), False))]
    grade = verdict(evidences.both(*changes)(evidences.right()), load())
    one = next(one for one in grade.criteria if one.id == "documentation.commands")
    assert one.points == one.max, one.reason


@pytest.mark.parametrize(
    ("true", "false", "points"),
    [
        ((BUILD,), tuple(run.replace("_publisher", "") for run in RUNS), 2),
        ((BUILD,), tuple(f"{run}.py" for run in ("ros2 run robot_controller pub", "ros2 run robot_controller sub")), 2),
        ((), ("ros2 launch robot_controller all.launch.py", "ros2 topic echo /x"), 2),
        (("colcon build --packages-select robot_controller",), ("ros2 topic echo /x", "ros2 topic echo /y"), 2),
        ((BUILD,), ("ros2 run robot-controller status", "ros2 topic echo /x"), 2),
        ((BUILD,), ("ros2 topic echo /x", "ros2 topic echo /y"), 0),
        ((BUILD,), tuple(run.replace("robot_controller", "py_pubsub").replace("_publisher", "") for run in RUNS[::2]), 0),
    ],
    ids=["other programs", "modules", "a launch file", "built by name", "dashes", "topics alone", "another package"],
)  # fmt: skip
def test_a_command_that_names_the_package_is_about_it(
    true: tuple[str, ...], false: tuple[str, ...], points: float
) -> None:
    """Whatever programs it names: that costs the commands."""
    beside = [text for text in false if "py_pubsub" in text]
    commands = {**dict.fromkeys(true, True), **dict.fromkeys(false, False), **dict.fromkeys(beside)}
    grade = verdict(evidences.files(readme_commands=commands)(evidences.right()), load())
    assert next(one for one in grade.criteria if one.id == "documentation.readme").points == points


def test_what_no_shell_takes_is_no_fault_of_the_package() -> None:
    """Where the spaces are those of a text processor, what it names is there, and the command fails all the same."""
    readme = "\n".join(f"```\n{command}\n```\n" for command in (BUILD, *RUNS))
    for text, points in ((readme, 3), (readme.replace(" ", "\u00a0"), 0)):
        failing = dict.fromkeys((BUILD, *RUNS), text == readme)
        grade = verdict(evidences.files(readme=text, readme_commands=failing)(evidences.right()), load())
        (one,) = (one for one in grade.criteria if one.id == "documentation.commands")
        assert (one.points, "look-alike" in one.reason) == (points, not points)
