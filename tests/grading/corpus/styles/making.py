"""How a style is made: the model without what is done for the bonus, and with other nodes."""

from __future__ import annotations

from collections.abc import Mapping

from corpus.case import Case, Loss
from corpus.package import LAUNCH, LAUNCH_TEXT, MODEL, README, README_TEXT, P
from corpus.tree import Change, Content, Files, as_folder, drop, made, put

LAUNCHED = frozenset(("launch",))
PLAIN_LAUNCH = (
    LAUNCH_TEXT[: LAUNCH_TEXT.index("import os")].replace(" with the values of config/robot.yaml", "")
    + """\
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    \"\"\"Return what is to be started.\"\"\"
    return LaunchDescription([
        Node(package='robot_controller', executable='status_publisher'),
        Node(package='robot_controller', executable='command_subscriber'),
        Node(package='robot_controller', executable='velocity_publisher'),
    ])
"""
)
PLAIN_README = README_TEXT[: README_TEXT.index("The commands are")].replace(", at 10 Hz", "") + (
    "The commands are `start`, `stop` and `reset`.\n"
)
PLAIN: Files = made(
    MODEL, drop(f"{P}test/", f"{P}config/"), put(LAUNCH, PLAIN_LAUNCH), put(README, PLAIN_README)
)


def style(
    name: str,
    about: str,
    *changes: Change,
    base: Mapping[str, Content] = PLAIN,
    earns: frozenset[str] = LAUNCHED,
    lacks: frozenset[str] = frozenset(("parameter_file", "tests")),
    loses: Mapping[str, Loss] | None = None,
) -> Case:
    """Return a legitimate way to solve the assignment, handed in as a folder."""
    files = made(base, *changes)
    return Case(f"style/{name}", about, as_folder(files), loses or {}, earns=earns, lacks=lacks)
