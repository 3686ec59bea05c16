"""Hints followed to the letter: what a report says of a fault, done to the fault's files, and what that must earn.

A row names a fault of the corpus, the criterion that lost points, words of the hint (or of the fix of a fault that
explains the loss), and the change that is the hint, done as it is written. Then the criterion must have more points,
and no component fewer.
"""

from __future__ import annotations

from dataclasses import dataclass

from corpus.case import Case
from corpus.faults import FAULTS
from corpus.package import (
    CFG,
    COMMAND,
    LAUNCH,
    MARKER,
    MODEL,
    README,
    SETUP,
    STATUS,
    TESTS,
    VELOCITY,
    XML,
    YAML,
    M,
    P,
)
from corpus.tree import Change, drop, edit, move, put


@dataclass(frozen=True)
class Hint:
    """What a report says of a fault, and what is done about it.

    Attributes:
        case: the fault.
        criterion: that has lost points by it.
        says: a regular expression that is found in the hints and fixes of its component.
        change: of the fault's files.
    """

    case: Case
    criterion: str
    says: str
    change: Change

    @property
    def name(self) -> str:
        """As `make corpus` has it."""
        return f"hint/{self.case.name}"


def _depend(*names: str) -> Change:
    lines = "".join(f"  <depend>{name}</depend>\n" for name in names)
    return edit(XML, "  <export>", f"{lines}  <export>")


def _written(*paths: str) -> Change:
    """Write files as whoever follows the hint has them in the end: as the model has them."""
    return lambda files: files.update({path: MODEL[path] for path in paths})


def _added(path: str, text: str) -> Change:
    return lambda files: files.update({path: f"{files.get(path, '')}{text}"})


_TO_RUN = """
Build it with `colcon build` and `source install/setup.bash`, then
`ros2 run robot_controller status_publisher`, `ros2 run robot_controller command_subscriber` and
`ros2 run robot_controller velocity_publisher`.
"""
_CFG = "[develop]\nscript_dir=$base/lib/robot_controller\n[install]\ninstall_scripts=$base/lib/robot_controller\n"
_ROWS: tuple[tuple[str, str, str, Change], ...] = (
    ("workspace/package_beside_src", "workspace.layout", r"folder src in it", move("robot_controller/", P)),
    ("workspace/two_copies", "workspace.build", r"Delete one of the two", drop("src/old/")),
    (
        "workspace/colcon_ignore",
        "workspace.build",
        r"delete the file COLCON_IGNORE",
        drop(f"{P}COLCON_IGNORE"),
    ),
    (
        "workspace/built_in_src",
        "workspace.clean",
        r"Delete these folders",
        drop("src/build/", "src/install/", "src/log/"),
    ),
    ("package/xml_rclpy_undeclared", "package.dependencies", r"<depend>rclpy</depend>", _depend("rclpy")),
    (
        "package/xml_std_msgs_undeclared",
        "package.dependencies",
        r"<depend>std_msgs</depend>",
        _depend("std_msgs"),
    ),
    (
        "package/xml_all_undeclared",
        "package.dependencies",
        r"Add a <depend> for each",
        _depend("rclpy", "std_msgs", "geometry_msgs"),
    ),
    ("package/xml_todo_license", "package.description", r"Write your own instead of", _written(XML)),
    (
        "package/xml_build_type_misspelt",
        "package.manifest",
        r"<build_type>ament_python</build_type>",
        _written(XML),
    ),
    ("package/setup_missing", "package.setup", r"`ros2 pkg create", _written(SETUP)),
    ("package/setup_no_comma", "package.setup", r"comma|python3 setup\.py", _written(SETUP)),
    ("package/setup_no_packages", "package.setup", r"into the list of packages|`packages`", _written(SETUP)),
    ("package/no_init", "package.setup", r"touch \S*__init__\.py", put(f"{M}__init__.py", "")),
    (
        "package/marker_missing",
        "package.registration",
        r"touch \S*resource/robot_controller",
        put(MARKER, ""),
    ),
    ("package/cfg_missing", "package.registration", r"script_dir=\$base/lib/", put(CFG, _CFG)),
    ("package/setup_point_missing", "package.executables", r"entry point", _written(SETUP)),
    ("package/setup_points_key", "package.executables", r"'console_scripts'", _written(SETUP)),
    (
        "package/setup_point_module_misspelt",
        "package.executables",
        r"module as the file is called",
        _written(SETUP),
    ),
    (
        "status_publisher/topic_one_letter_short",
        "status_publisher.topic",
        r"Name the topic /robot/status",
        edit(STATUS, "'/robot/statu'", "'/robot/status'"),
    ),
    (
        "status_publisher/period_2_5",
        "status_publisher.period",
        r"Give create_timer 2\.0",
        edit(STATUS, "create_timer(period,", "create_timer(2.0,"),
    ),
    ("status_publisher/import_from_rclpy", "status_publisher.life", r"rclpy\.node", _written(STATUS)),
    (
        "command_subscriber/topic_plural",
        "command_subscriber.topic",
        r"topic /robot/command\b",
        _written(COMMAND),
    ),
    (
        "command_subscriber/logs_in_debug",
        "command_subscriber.log",
        r"self\.get_logger\(\)\.info",
        edit(COMMAND, "self.get_logger().debug(", "self.get_logger().info("),
    ),
    ("command_subscriber/no_reset", "command_subscriber.commands", r"follow this command", _written(COMMAND)),
    ("velocity_publisher/int_in_linear", "velocity_publisher.values", r"0\.0|float", _written(VELOCITY)),
    ("velocity_publisher/never_spins", "velocity_publisher.life", r"spin", _written(VELOCITY)),
    ("documentation/readme_missing", "documentation.readme", r"Write a README\.md", _written(README)),
    ("documentation/no_run_commands", "documentation.commands", r"ros2 run", _added(README, _TO_RUN)),
    ("bonus/launch_not_installed", "bonus.launch", r"data_files|install", _written(SETUP, LAUNCH)),
    ("bonus/yaml_other_node", "bonus.parameter_file", r"name|node", _written(YAML)),
    ("bonus/tests_missing", "bonus.tests", r"Write some in the folder test", _written(TESTS)),
)
_BY_NAME = {case.name: case for case in FAULTS}
HINTS: tuple[Hint, ...] = tuple(Hint(_BY_NAME[name], *row) for name, *row in _ROWS)
