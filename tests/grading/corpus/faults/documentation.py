"""Faults of the README, and of what the code says about itself."""

from __future__ import annotations

import ast

from corpus.case import Case
from corpus.faults.making import both, fault
from corpus.package import README, README_TEXT, M
from corpus.tree import drop, every, put


def _readme(name: str, text: str, cause: str, about: str, *, least: float = 1, most: float = 8) -> Case:
    return fault("documentation", name, put(README, text), cause, about, least=least, most=most)


def without_words(text: str) -> str:
    """Return Python code without docstrings and comments."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if (
            isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef))
            and ast.get_docstring(node) is not None
        ):
            node.body = node.body[1:] or [ast.Pass()]
    return ast.unparse(tree) + "\n"


def with_generated_words(text: str) -> str:
    """Return Python code in which each docstring is one sentence around the name."""
    tree = ast.parse(without_words(text))
    for node in ast.walk(tree):
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            said = f"Definition of {node.name.replace('_', ' ')}."
            node.body.insert(0, ast.Expr(ast.Constant(said)))
    return ast.unparse(tree) + "\n"


_IDEAS = ("think", "hope", "wish", "doubt", "wonder", "guess", "dream", "plan", "look", "wait")
_ABOUT_NOTHING = "\n\n".join(
    f'def {idea}_{number}():\n    """{what} the robot when it has to {idea}."""\n{does}'
    for number, (what, does) in enumerate(
        (("Leave", ""), ("Keep", "    pass\n"), ("Count", "    return 3\n"), ("Ask", "    print(3)\n"))
    )
    for idea in _IDEAS
)


def _with(old: str, new: str) -> str:
    if old not in README_TEXT:
        raise ValueError(f"{old!r} is not in the README.")
    return README_TEXT.replace(old, new)


_TURTLES = """\
# turtle_painter

Draws a star with turtlesim. The node `star_painter` calls the service `/turtle1/set_pen` and publishes `/turtle1/cmd_vel`.

```bash
sudo apt install ros-jazzy-turtlesim
cd turtle_ws && colcon build && source install/setup.bash
ros2 run turtlesim turtlesim_node
ros2 run turtle_painter star_painter
ros2 topic echo /turtle1/pose
```
"""
_CPP = """\
# Robot controller in C++

Three nodes in C++ 17 for ROS 2, built by CMake.

```bash
colcon build --cmake-args -DCMAKE_BUILD_TYPE=Release
source install/setup.bash
ros2 run robot_cpp talker_node
ros2 run robot_cpp motor_driver
```

`talker_node` publishes `/robot_info`, `motor_driver` publishes `/wheel_speeds` and serves `/reset_odometry`.
"""
_OLDER = """
## How it works

`brain_node.py` holds the class `RobotBrain`, a state machine with `update_state()` and `leave_state()`.
`motor_node.py` holds `MotorDriver`, which receives `/motors/left` and `/motors/right` from `wheel_mixer.py`.
`SafetyGuard` in `safety_node.py` listens to `/bumper`, and calls `emergency_stop()` and `release_brakes()`.
`battery_node.py` publishes `/battery_level`, and `led_node.py` shows it with `show_level()` of `LedStrip`.
"""
_TEMPLATE = "# Project title\n\nTODO: describe the project.\n\n## Installation\n\nTODO\n\n## Usage\n\nTODO\n"
_RUN = README_TEXT[README_TEXT.index("## Run") : README_TEXT.index("## Nodes")]

DOCUMENTATION: tuple[Case, ...] = (
    fault(
        "documentation",
        "readme_missing",
        drop(README),
        r"README",
        "nothing says what it is and how it is run",
        least=3,
        most=8,
    ),
    _readme("readme_empty", "", r"README|empty", "nothing says what it is and how it is run", least=3),
    _readme(
        "readme_one_line",
        "# Homework 2\n",
        r"README|run|command|topic",
        "a title says nothing of the package",
        least=2,
    ),
    _readme(
        "readme_template", _TEMPLATE, r"README|TODO|run|command", "a template that nobody filled in", least=2
    ),
    _readme(
        "readme_of_turtles", _TURTLES, r"README|turtle|another|not", "it is about another package", least=2
    ),
    _readme(
        "readme_of_cpp", _CPP, r"README|robot_cpp|another|not", "it is about another implementation", least=2
    ),
    _readme(
        "readme_of_an_older_state",
        README_TEXT + _OLDER,
        r"another state|brain_node",
        "half of it is about files, classes and topics that were given up",
        least=1,
        most=2,
    ),
    _readme(
        "readme_is_a_story",
        "# My robot\n\n" + "I like robots very much, and this one is nice. " * 30,
        r"README|run|command|topic",
        "it is long, and has no command and no topic",
        least=2,
    ),
    _readme(
        "other_executables",
        _with(
            "ros2 run robot_controller status_publisher\nros2 run robot_controller command_subscriber\n"
            "ros2 run robot_controller velocity_publisher",
            "ros2 run robot_controller talker\nros2 run robot_controller listener\n"
            "ros2 run robot_controller driver",
        ),
        r"talker|listener|driver|ros2 run",
        "there are no such executables",
    ),
    _readme(
        "other_package",
        _with("ros2 run robot_controller", "ros2 run my_robot"),
        r"my_robot|ros2 run",
        "there is no such package",
    ),
    _readme(
        "other_launch_file",
        _with("robot.launch.py", "bringup.launch.py"),
        r"bringup|ros2 launch",
        "there is no such launch file",
        least=0.5,
    ),
    _readme(
        "other_topics",
        _with("/robot/status", "/status")
        .replace("/cmd_vel", "/velocity")
        .replace("/robot/command", "/orders"),
        r"/status|/velocity|/orders|topic",
        "there are no such topics",
    ),
    _readme("no_run_commands", _with(_RUN, ""), r"run|command|start", "nothing says how it is started"),
    _readme(
        "no_set_up",
        _with(README_TEXT[README_TEXT.index("## Set up") : README_TEXT.index("## Run")], ""),
        r"build|set.?up|colcon|source",
        "nothing says how it is built",
        least=0.5,
    ),
    fault(
        "documentation",
        "no_words_in_code",
        every(
            without_words, f"{M}status_publisher.py", f"{M}command_subscriber.py", f"{M}velocity_publisher.py"
        ),
        r"docstring|comment",
        "no module, class or function says what it does",
        most=6,
    ),
    fault(
        "documentation",
        "generated_words",
        every(
            with_generated_words,
            f"{M}status_publisher.py",
            f"{M}command_subscriber.py",
            f"{M}velocity_publisher.py",
        ),
        r"docstring|comment",
        "each docstring is the name in the same sentence, which says nothing of the code",
        most=3,
    ),
    fault(
        "documentation",
        "words_about_nothing",
        both(
            every(
                without_words,
                f"{M}status_publisher.py",
                f"{M}command_subscriber.py",
                f"{M}velocity_publisher.py",
            ),
            put(f"{M}more.py", _ABOUT_NOTHING),
        ),
        r"docstring|comment",
        "forty functions that nobody calls, or that do nothing, are described, and no other one",
        most=3,
    ),
    fault(
        "documentation",
        "nothing_at_all",
        both(drop(README), every(without_words, ".py")),
        r"README",
        "neither README nor docstrings nor comments",
        least=6,
        most=10,
    ),
)
