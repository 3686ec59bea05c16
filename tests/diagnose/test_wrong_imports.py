"""Imports of names that are not there: the fix is a statement that imports what was meant."""

import ast
from pathlib import Path

import pytest

from ros2lab.diagnose.code.wrong_imports import wrong_imports
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.python_source import PythonSource

LAUNCH = "from launch import LaunchDescription\n"


def found(text: str, *, is_sure: bool = False, **own: set[str]) -> list[Finding]:
    source = PythonSource("pk.talk", "src/pk/pk/talk.py", text, path=Path("/ws/src/pk/pk/talk.py"))
    known = {name.replace("__", "."): names for name, names in own.items()}
    return [*wrong_imports(source, known, is_sure=is_sure)]


@pytest.mark.parametrize(
    ("text", "fix"),
    [
        ("from std_msgs.msg import Strings\nS = Strings()\n", "write `from std_msgs.msg import String`, and String instead of Strings on line 2"),
        ("from geometry_msgs.msg import (\n    Twist,\n    LaserScan,\n)\n", "write `from geometry_msgs.msg import Twist` and `from sensor_msgs.msg import LaserScan`, one below the other, instead of line 1"),
        ("from rclpy import Node\n", "write `from rclpy.node import Node`"),
        ("from rclpy.nodes import Node as N\n", "write `from rclpy.node import Node as N`"),
        ("from math import PI, sin\n", "write `from math import pi, sin`"),
        ("from os import path, Path\n", "write `from os import path` and `from pathlib import Path`, one below the other, instead of line 1"),
        ("from collections import Iterable\n", "write `from collections.abc import Iterable`"),
        ("from std_msgs.srv import Trigger\n", "write `from std_srvs.srv import Trigger`"),
        ("from setuptools import find_package, setup\nsetup(packages=find_package())\n", "write `from setuptools import find_packages, setup`, and find_packages instead of find_package on line 2"),
        ("import rclpy.executor\nX = rclpy.executor.Executor\n", "write `import rclpy.executors`, and rclpy.executors instead of rclpy.executor on line 2"),
        ("from rclpy import node\nclass A(node):\n    pass\n", "write `from rclpy.node import Node`, and Node instead of node where it is used"),
        ("from std_msgs.msg import Int32, Int33\n", "write `from std_msgs.msg import Int32`: nothing here uses Int33"),
        ("from std_msgs.msg import Int32\nfrom std_msgs.msg import Int33\nI = Int33()\n", "remove Int33 here, with what uses it on line 3, or write what std_msgs.msg has for it"),
        ("from rclpy.qos import QoSProfile, QoSProfil\nQ = QoSProfil(depth=1)\n", "write `from rclpy.qos import QoSProfile`, and QoSProfile instead of QoSProfil on line 2"),
        (f"{LAUNCH}from launch_ros import Node\n", "write `from launch_ros.actions import Node`"),
        (f"{LAUNCH}from launch.substitutions import Node\n", "write `from launch_ros.actions import Node`"),
        (f"{LAUNCH}from launch_ros.action import Node\n", "write `from launch_ros.actions import Node`"),
        (f"{LAUNCH}from launch.event_handlers.on_process_started import OnProcessStart\n", "write `from launch.event_handlers import OnProcessStart`"),
        (f"{LAUNCH}from launch.substitution import LaunchConfiguration\n", "write `from launch.substitutions import LaunchConfiguration`"),
    ],
)  # fmt: skip
def test_the_fix_imports_what_was_meant(text: str, fix: str) -> None:
    """Of several names, those that are right stay; the new statement can be read by Python."""
    (finding,) = found(text)
    assert (finding.code, finding.fix) == ("import-wrong", fix)
    for number, written in enumerate(finding.fix.split("`")):
        if number % 2:
            ast.parse(written)


def test_a_name_of_the_workspaces_own_module() -> None:
    """A module of the workspace is known by what its file binds."""
    (finding,) = found("from .maths import clampp\n", pk__maths={"clamp"})
    assert finding.fix == "write `from .maths import clamp`"


def test_a_misspelt_module_of_python_is_told_only_if_the_import_failed() -> None:
    """Another computer may have a library of that name."""
    text = "from dataclass import dataclass\n"
    assert not found(text)
    assert found(text, is_sure=True)[0].fix == "write `from dataclasses import dataclass`"
    assert not found("from pynput import keyboard\n", is_sure=True)


@pytest.mark.parametrize(
    "text",
    [
        "from rclpy import node, spin\nnode.Node\n",
        "import rclpy.node as n\nimport os.path\nfrom os import path\n",
        "try:\n    from math import PI\nexcept ImportError:\n    PI = 3.14\n",
        "from pk.maths import clampp\n",
        "from numpy import nothing\n",
        "from std_msgs.msg import *\nfrom rclpy.executors import ExternalShutdownException\n",
        f"{LAUNCH}from launch.actions import DeclareLaunchArgument, ExecuteProcess, GroupAction, OpaqueFunction\n",
        "from launch_ros.parameter_descriptions import ParameterValue\nfrom launch.event_handlers import OnProcessExit\n",
        f"{LAUNCH}from launch.event_handlers.on_process_start import OnProcessStart\n",
        f"{LAUNCH}from launch.actions.execute_process import ExecuteProcess\nimport launch.events.matchers\n",
        f"{LAUNCH}from launch_ros.actions.node import Node\nfrom launch.substitutions.launch_configuration import LaunchConfiguration\n",
        "from collections import abc, OrderedDict\nfrom concurrent import futures\nfrom importlib import resources\n",
        "from setuptools import Command, find_namespace_packages, setup\n",
        "from rclpy.parameter import Parameter, parameter_value_to_python\nfrom rclpy import logging\n",
        "from rclpy import clock\nclock = clock.Clock()\n",
    ],
)
def test_right_imports_are_left_alone(text: str) -> None:
    """Submodules, guarded imports, and libraries whose names are not known here."""
    assert not found(text)
