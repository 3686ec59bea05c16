"""The commands in a README are held against what was built and seen."""

from __future__ import annotations

from dataclasses import replace

import pytest

from ros2lab.grading.evidence import Build, Executable, Files, Run
from ros2lab.grading.judging.readme import MOST_COMMANDS, commands, is_typed
from ros2lab.grading.receiving.submission import FoundPackage, Submission

PACKAGE = FoundPackage("ws/src/robot_controller", "robot_controller", "ament_python", None)
OTHER = FoundPackage("ws/src/messages", "robot_messages", "ament_python", None)
SUBMISSION = Submission("workspace", "ws", [PACKAGE, OTHER], PACKAGE, [], [])
BUILD = Build(
    is_built=True,
    error="",
    warnings=[],
    notes=[],
    executables=[
        Executable("status", "robot_controller.status:main", "installed", ["status"]),
        Executable("drive", "robot_controller.drive:main", "module", ["python3"], "It is not installed."),
        Executable("extra", "", "script", ["python3", "extra.py"]),
    ],
    shared=["launch/robot.launch.py"],
    environ={},
    seconds=1.0,
)
RUN = Run(
    programs=["status"],
    setting="alone",
    clock="stepped",
    nodes=["/status_node"],
    publishes={"/robot/status": {"/status_node": ["std_msgs/msg/String"]}},
    subscribes={"/robot/command": {"/status_node": ["std_msgs/msg/String"]}},
    qos={},
    parameters={},
    quiet={},
    commands=[],
    ended={},
    stopped={},
    notes=[],
)


@pytest.mark.parametrize(
    ("command", "is_true"),
    [
        ("ros2 run robot_controller status", True),
        ("ros2 run robot_controller status --ros-args -p period:=1.0", True),
        ("ros2 run robot_controller statsu", False),
        ("ros2 run robot_controller drive", False),
        ("ros2 run robot_control status", False),
        ("ros2 run turtlesim turtlesim_node", None),
        ("ros2 run robot_messages show", None),
        ("ros2 launch robot_controller robot.launch.py", True),
        ("ros2 launch robot_controller all.launch.py", False),
        ("ros2 launch robot_messages robot.launch.py", True),
        ("ros2 launch robot_messages all.launch.py", None),
        ("ros2 topic echo /robot/status", True),
        ("ros2 topic echo --once /robot/status", True),
        ("ros2 topic pub --once /robot/command std_msgs/msg/String \"{data: 'start'}\"", True),
        ('ros2 topic pub --once /robot/stop std_msgs/msg/String "{data: stop}"', False),
        ('ros2 topic pub -1 /temperature std_msgs/msg/Float32 "{data: 25.5}"', False),  # waits for ever
        ('ros2 topic pub -t 3 /temperature std_msgs/msg/Float32 "{data: 25.5}"', False),
        ('ros2 topic pub /temperature std_msgs/msg/Float32 "{data: 25.5}"', None),  # does not fail
        ('ros2 topic pub -r 2 /temperature std_msgs/msg/Float32 "{data: 25.5}"', None),
        ('ros2 topic pub /robot/comand std_msgs/msg/String "{data: stop}"', False),  # is misspelt
        ("ros2 topic echo /temperature", False),
        ("ros2 topic echo /robot/stauts", False),
        ("ros2 topic list", None),
        ("ros2 topic echo /rosout", True),
        ("ros2 node info /status_node", True),
        ("ros2 node info /status", False),
        ("ros2 param set /status_node period 1.0", True),
        ("colcon build", True),
        ("colcon build --symlink-install --packages-select robot_controller", True),
        ("colcon build --packages-select robot_controller --symlink-install", True),
        ("colcon build --packages-select other", False),
        ("colcon test", True),
        ("python3 extra.py", True),
        ("ros2 run robot_controller <node>", None),
        ("ros2 launch robot_controller <launch file>", None),
        ("python3 -m venv x", None),
    ],
)
@pytest.mark.parametrize("frame", ["{}", "Type `{}`.", "```bash\n$ {}\n```", "1. {}  # then look"])
def test_a_command_is_true_or_not(command: str, is_true: bool | None, frame: str) -> None:
    found = commands(frame.format(command), SUBMISSION, BUILD, [RUN])
    assert list(found.values()) == [is_true], found


FACTS = Files(
    declared={"speed": 1.0},
    launch_lacks={"ws/src/robot_controller/launch/robot.launch.py": ["colour"]},
)
ASKED = replace(RUN, parameters={"/status_node": {"period": 2.0}})


@pytest.mark.parametrize(
    ("command", "is_true"),
    [
        ('ros2 topic pub --once /robot/command std_msgs/msg/String "{data: start}"', True),
        ('ros2 topic pub --once /robot/command std_msgs/String "{data: start}"', True),
        ('ros2 topic pub -r 2 /robot/command std_msgs/msg/Int32 "{data: 3}"', False),
        ("ros2 topic echo /robot/status std_msgs/msg/String", True),
        ("ros2 topic echo /robot/status geometry_msgs/msg/Twist", False),
        ("ros2 topic pub --once /robot/command <type>", True),
        ("ros2 param get /status_node period", True),
        ("ros2 param set /status_node period 1.0", True),
        ("ros2 param get /status_node use_sim_time", True),
        ("ros2 param get /status_node speed", True),
        ("ros2 param set /status_node speed_limit 3.0", False),
        ("ros2 param get --hide-type /status_node speed_limit", False),
        ("ros2 param set /status_node <name>", True),
        ("ros2 param set /status_node NAME VALUE", True),
        ("ros2 param list /status_node", True),
        ("ros2 run robot_controller status --ros-args -p period:=1.0 --log-level debug", True),
        ("ros2 run robot_controller status --ros-args -p speed:=1.0", True),
        ("ros2 run robot_controller status --ros-args -p perriod:=1.0", False),
        ("ros2 run robot_controller status --ros-args --speed 3", False),
        ("ros2 run robot_controller status --ros-args -r /a:=/b -- --speed 3", True),
        ("ros2 run robot_controller status --ros-args -r __node:=other --params-file x.yaml", True),
        ("ros2 run robot_controller status --speed 3", True),
        ("ros2 launch robot_controller robot.launch.py period:=1.0", True),
        ("ros2 launch robot_controller robot.launch.py colour:=red", False),
        ("colcon build --packages-skip robot_controller", False),
        ("colcon build --packages-skip robot_messages --symlink-install", True),
    ],
)
def test_what_a_command_gives_is_held_against_what_was_seen(command: str, is_true: bool) -> None:
    """Types, parameters, options of ROS and arguments; nothing of which the evidence does not tell."""
    assert commands(f"`{command}`", SUBMISSION, BUILD, [ASKED], FACTS) == {command: is_true}


@pytest.mark.parametrize(
    "command",
    [
        "ros2 param set /status_node speed_limit 3.0",
        "ros2 run robot_controller status --ros-args -p perriod:=1.0",
        "ros2 launch robot_controller robot.launch.py anything:=1",
    ],
)
def test_what_was_not_seen_is_not_judged(command: str) -> None:
    """A node that did not tell its parameters may have any, and so may a launch file that includes others."""
    assert commands(f"`{command}`", SUBMISSION, BUILD, [replace(RUN, parameters={})], Files()) == {
        command: True
    }


@pytest.mark.parametrize(
    "command", ["ros2 run robot_controller status", "ros2 launch robot_controller robot.launch.py"]
)
def test_other_programs_are_nobodys_business_beside_the_own_ones(command: str) -> None:
    text = f"`{command}`, then `ros2 run rqt_graph rqt_graph`, never `ros2 run robot_control status` or `ros2 run x go`"
    assert [*commands(text, SUBMISSION, BUILD, [RUN]).values()] == [True, None, False, None]


@pytest.mark.parametrize(
    ("command", "is_true"),
    [
        ("ros2 run my_package status", False),
        ("ros2 run my_package status.py", False),
        ("ros2 run x drive", False),
        ("ros2 run robot_control status.py", False),
        ("ros2 run robot_control go", False),
        ("ros2 run robot-controller go", False),
        ("ros2 run demo_nodes_py status", None),
        ("ros2 run turtlesim turtle_teleop_key", None),
        ("ros2 run teleop_twist_keyboard teleop_twist_keyboard", None),
        ("ros2 run robot_bringup go", None),
        ("ros2 launch turtle_bot all.launch.py", None),
        ("ros2 launch my_package robot.launch.py", False),
        ("ros2 run robot_messages status.py", None),
    ],
)
def test_whose_program_a_command_starts_its_package_tells_or_its_name(
    command: str, is_true: bool | None
) -> None:
    """A package that is nowhere is meant as the own one if the program, with or without .py, or most of its name is."""
    assert commands(f"`{command}`", SUBMISSION, BUILD, [RUN]) == {command: is_true}


@pytest.mark.parametrize("is_known", [True, False])
def test_which_launch_files_a_package_beside_it_has_is_known(is_known: bool) -> None:
    facts = Files(
        manifest={"is_there": True}, launch_files_elsewhere=["ws/src/messages/launch/show.launch.py"]
    )
    text = "`ros2 launch robot_messages show.launch.py` `ros2 launch robot_messages all.launch.py`"
    found = commands(text, SUBMISSION, BUILD, [RUN], facts if is_known else None)
    assert [*found.values()] == [None, False if is_known else None]


@pytest.mark.parametrize("tool", ["turtlesim turtlesim_node", "rqt_graph rqt_graph"])
def test_an_own_topic_without_its_namespace_is_not_that_of_a_tool(tool: str) -> None:
    text = f"`ros2 run {tool}`, `ros2 topic pub /command std_msgs/msg/String`"
    assert [*commands(text, SUBMISSION, BUILD, [RUN]).values()] == [None, False]


@pytest.mark.parametrize(
    ("topic", "is_true"), [("/turtle1/pose", None), ("/robot/status", True), ("/robot/stauts", False)]
)
def test_a_topic_of_another_program_is_nobodys_business(topic: str, is_true: bool | None) -> None:
    own = f"`ros2 run robot_controller status`, `ros2 topic echo {topic}`"
    judged = commands(f"{own}, `ros2 run turtlesim turtlesim_node`", SUBMISSION, BUILD, [RUN])
    assert judged[f"ros2 topic echo {topic}"] is is_true
    assert commands(own, SUBMISSION, BUILD, [RUN])[f"ros2 topic echo {topic}"] is bool(is_true)


@pytest.mark.parametrize(
    ("text", "is_true"),
    [
        ("Start ros2 run robot_controller status, then look.", True),
        ("**ros2 run robot_controller status**", True),
        ("<code>ros2 run robot_controller status</code>", True),
        ("(ros2 launch robot_controller robot.launch.py)", True),
        ("`ros2 run <package> <executable>`", None),
        ("`ros2 run robot_controller [node_name]`", None),
        ("`ros2 run robot_controller {node}`", None),
        ("`ros2 run robot_controller NODE_NAME`", None),
        ("`ros2 run robot_controller ...`", None),
        ("Type ros2 run robot_controller statsu, and wait.", False),
    ],
)
def test_a_command_is_read_without_the_sentence_around_it(text: str, is_true: bool | None) -> None:
    assert [*commands(text, SUBMISSION, BUILD, [RUN]).values()] == [is_true]


def test_a_launch_file_that_breaks_off_is_no_command_that_works() -> None:
    command = "ros2 launch robot_controller robot.launch.py"
    broken = replace(RUN, setting="launched", ended={"robot.launch.py": "[ERROR] [launch]: no such thing"})
    assert commands(command, SUBMISSION, BUILD, [RUN, broken]) == {command: False}


def test_what_is_not_built_cannot_be_built_by_following_it() -> None:
    broken = Build(False, "SyntaxError", [], [], [], [], {}, 1.0)
    assert commands("`colcon build`", SUBMISSION, broken, []) == {"colcon build": False}


def test_a_readme_of_many_commands_is_read_to_an_end() -> None:
    text = "\n".join(f"ros2 run robot_controller node_{number}" for number in range(10_000))
    assert len(commands(text, SUBMISSION, BUILD, [RUN])) == MOST_COMMANDS


@pytest.mark.parametrize(
    ("written", "seen"),
    [
        ("```\ncolcon\u00a0build\n```", "colcon build"),
        ("```\nros2 run\u202frobot_controller\u2009status\n```", "ros2 run robot_controller status"),
        ("Run `col\u200bcon buil\u00add`.", "colcon build"),
        ("    $ \uff52os\uff12\u3000run robot_controller status", "ros2 run robot_controller status"),
        ("```\ncolcon\u00a0test\n```\n\n- `ros2\u00a0topic list`", "colcon test"),
    ],
)
def test_what_only_looks_like_a_command_is_one_that_fails(written: str, seen: str) -> None:
    """As a text processor writes it: its reader sees a command, and a shell finds none when it is pasted."""
    found = commands(written, SUBMISSION, BUILD, [RUN])
    assert found[seen] is False
    assert not is_typed(seen, written)


@pytest.mark.parametrize(
    "text",
    [
        "Das\u00a0Paket: 👩\u200d🚀 \ufeff\n\n```\ncolcon build\n```",
        "\tcolcon  build",
        "`colcon build`\u00a0is it",
    ],
)
def test_signs_beside_a_command_do_not_spoil_it(text: str) -> None:
    assert commands(text, SUBMISSION, BUILD, [RUN]) == {"colcon build": True}


def test_no_command() -> None:
    assert commands("I build with colcon and run it with ros2.", SUBMISSION, BUILD, [RUN]) == {}


@pytest.mark.parametrize(
    "text",
    [
        "`colcon build` in the workspace",
        "``colcon build``",
        "Run colcon build.",
        "Run colcon build, then source it.",
        "Run colcon build in the workspace",
        "To build it, type colcon build at its top.",
        "Build: colcon build",
        "1. colcon build",
        "colcon build (at its top)",
        "$ colcon build",
        "anna@pc:~/ws$ colcon build",
        "> colcon build  in the workspace",
        "```\ncd ws\ncolcon build\n```",
        "```\ncolcon build  at its top\n```",
        "cd ws && colcon build && source install/setup.bash",
        "**colcon build**",
    ],
)
def test_what_is_typed_is_a_command_of_colcon(text: str) -> None:
    assert commands(text, SUBMISSION, BUILD, [RUN]) == {"colcon build": True}


@pytest.mark.parametrize(
    "text",
    [
        "- colcon build tool",
        "# The colcon build tool",
        "<b>colcon build tool</b>",
        "It needs the colcon build system, and colcon test results are kept.",
        "colcon build times are short.",
        "With the ros2 run command you start a node.",
        "Use ros2 run or ros2 launch to start it.",
        "It is no ros2 launch file.",
    ],
)
def test_a_sentence_about_a_tool_is_no_command(text: str) -> None:
    assert commands(text, SUBMISSION, BUILD, [RUN]) == {}


def test_a_program_of_another_package_is_started_where_it_is_typed() -> None:
    command = "ros2 run turtlesim turtlesim_node"
    for text in (command, f"- {command}", f"Type `{command}`.", f"$ {command}", f"```\n{command}\n```"):
        assert commands(text, SUBMISSION, BUILD, [RUN]) == {command: None}


@pytest.mark.parametrize(
    "command",
    [
        "rostopic pub /robot/command std_msgs/String start",
        "rosrun robot_controller status",
        "roslaunch robot_controller robot.launch",
        "catkin_make",
        "rosservice call /reset",
        "rosnode list",
        "source devel/setup.bash",
    ],
)
def test_a_command_of_ros_1_is_not_true_where_it_is_to_be_typed(command: str) -> None:
    """What a sentence says of it may be what ROS 2 has instead; rosdep is of both."""
    for text in (
        f"    {command}",
        f"$ {command}",
        f"```\n{command}\n```",
        f"```bash\ncd ws && {command}\n```",
    ):
        assert commands(text, SUBMISSION, BUILD, [RUN]) == {command: False}
    for text in (
        f"Instead of `{command}` it has another one.",
        f"{command} was of ROS 1.",
        "```\nrosdep install\n```",
    ):
        assert commands(text, SUBMISSION, BUILD, [RUN]) == {}
