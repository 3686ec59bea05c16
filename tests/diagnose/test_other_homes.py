"""A class that one module is asked for, after a dot, and another has: as for an import of it."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

NAME = NAMES[1]


def told(folder: Path, imports: str, use: str) -> list[tuple[str, str]]:
    files = Files.right(NAME).change("PACKAGE/MODULE.py", "import rclpy\n", f"import rclpy\n{imports}\n")
    files.change("node", "self.count += 1", f"self.count += 1\n        self.made = {use}")
    return [
        (finding.cause, finding.fix)
        for finding in of_workspace(files.write(folder))
        if finding.code in ("argument-type", "attribute-missing", "import-wrong")
    ]


@pytest.mark.parametrize(
    ("imports", "use", "home", "fix"),
    [
        (
            "import geometry_msgs.msg",
            "geometry_msgs.msg.LaserScan",
            "sensor_msgs.msg",
            "write sensor_msgs.msg.LaserScan instead of geometry_msgs.msg.LaserScan, with `import sensor_msgs.msg` at the top",
        ),
        (
            "import std_msgs.msg as std\nimport geometry_msgs.msg as geometry",
            "std.Twist()",
            "geometry_msgs.msg",
            "write `geometry.Twist()` instead of `std.Twist()`",
        ),
        (
            "import std_msgs.msg\nimport geometry_msgs.msg",
            "std_msgs.msg.Twist()",
            "geometry_msgs.msg",
            "write geometry_msgs.msg.Twist instead of std_msgs.msg.Twist",
        ),
        (
            "from std_msgs import msg as kinds",
            "kinds.Twist()",
            "geometry_msgs.msg",
            "write geometry_msgs.msg.Twist instead of kinds.Twist, with `import geometry_msgs.msg` at the top",
        ),
        (
            "import rclpy.parameter",
            "rclpy.parameter.SetParametersResult(successful=True)",
            "rcl_interfaces.msg",
            "write rcl_interfaces.msg.SetParametersResult instead of rclpy.parameter.SetParametersResult, with `import rcl_interfaces.msg` at the top",
        ),
        (
            "import rclpy.node",
            "rclpy.node.Time",
            "rclpy.time",
            "write rclpy.time.Time instead of rclpy.node.Time, with `import rclpy.time` at the top",
        ),
        (
            "import rclpy.qos",
            "rclpy.qos.MultiThreadedExecutor()",
            "rclpy.executors",
            "write rclpy.executors.MultiThreadedExecutor instead of rclpy.qos.MultiThreadedExecutor, with `import rclpy.executors` at the top",
        ),
        ("import os\nimport time", "os.sleep(1)", "time", "write `time.sleep(1)` instead of `os.sleep(1)`"),
    ],
)
def test_a_class_is_told_where_it_is(tmp_path: Path, imports: str, use: str, home: str, fix: str) -> None:
    ((cause, said),) = told(tmp_path, imports, use)
    assert f"it is in {home}." in cause
    assert said == fix


@pytest.mark.parametrize(
    ("imports", "use", "fix"),
    [
        ("import base64", "base64.decodestring(b'x')", "write decodebytes instead of"),
        ("import base64", "base64.encodestring(b'x')", "write encodebytes instead of"),
        ("import time", "time.clock()", "remove clock here, or write what time has for it"),
        ("import random", "random.range(1, 5)", "write randrange instead of"),
        ("import string", "string.atoi('3')", "remove atoi here, or write what string has for it"),
        ("from time import clock", "clock()", "remove clock here, with what uses it on line 21, or write what time has for it"),
        ("from base64 import decodestring", "decodestring(b'x')", "remove decodestring here, with what uses it on line 21, or write what base64 has for it"),
        ("import random, math", "random.sqrt(2)", "write `math.sqrt(2)` instead of"),
        ("import math\nfrom os import sleep\nimport time", "sleep(1)", "write `from time import sleep`"),
        ("import collections", "collections.Enum('Kind', 'a')", "write enum.Enum instead of"),
    ],
)  # fmt: skip
def test_the_same_name_elsewhere_need_not_be_what_is_meant(
    tmp_path: Path, imports: str, use: str, fix: str
) -> None:
    ((_, said),) = told(tmp_path, imports, use)
    assert said.startswith(fix)


@pytest.mark.parametrize(
    ("imports", "use"),
    [
        ("import geometry_msgs.msg", "geometry_msgs.msg.Twist()"),
        ("import rclpy.qos", "rclpy.qos.QoSProfile(depth=1)"),
        ("import rclpy.time", "rclpy.time.Time()"),
        ("import os", "os.environ"),
        ("import geometry_msgs.msg as geometry", "geometry.TwistStamped()"),
    ],
)
def test_what_a_module_has_is_right(tmp_path: Path, imports: str, use: str) -> None:
    assert told(tmp_path, imports, use) == []


def test_another_spelling_in_the_same_module_comes_first(tmp_path: Path) -> None:
    ((cause, _),) = told(tmp_path, "import geometry_msgs.msg", "geometry_msgs.msg.twist()")
    assert "Did you mean Twist?" in cause


def in_except(folder: Path, caught: str) -> str:
    files = Files.right(NAME).change("PACKAGE/MODULE.py", "import rclpy\n", "import rclpy\nimport json\n")
    made = f"self.count += 1\n        try:\n            self.made = 1\n        except {caught}:\n            self.made = 0"
    files.change("node", "self.count += 1", made)
    return next(f.cause for f in of_workspace(files.write(folder)) if f.code == "attribute-missing")


@pytest.mark.parametrize(
    ("caught", "cause"),
    [
        ("rclpy.ROSException", "rclpy has no ROSException in ROS 2 Jazzy."),  # rclpy.exceptions is a module
        ("json.JSONDecodeErorr", "json has no JSONDecodeErorr. Did you mean JSONDecodeError?"),
        ("json.Dump", "json has no Dump."),
    ],
)
def test_only_an_exception_is_offered_to_be_caught(tmp_path: Path, caught: str, cause: str) -> None:
    assert in_except(tmp_path, caught) == cause


@pytest.mark.parametrize(
    ("imports", "use", "cause", "fix"),
    [
        ("from rclpy.type_support import FeedbackMessage", "FeedbackMessage", "FeedbackMessage is not in rclpy.type_support of ROS 2 Jazzy.", "remove FeedbackMessage here, with what uses it on line 21, or write what rclpy.type_support has for it"),
        ("from rclpy.action import ActionClient", "ActionClient(self, int, 'a').configure_introspection(1, 2, 3)", "ActionClient has no configure_introspection in ROS 2 Jazzy", "remove configure_introspection here, or write what ActionClient has for it"),
        ("from rclpy.qos import qos_profile_sensor_dat", "print(qos_profile_sensor_dat)", "qos_profile_sensor_dat is not in rclpy.qos. Did you mean qos_profile_sensor_data?", "write `from rclpy.qos import qos_profile_sensor_data`"),
        ("from rclpy.type_support import check_for_typesupport", "check_for_typesupport(int)", "check_for_typesupport is not in rclpy.type_support. Did you mean check_for_type_support?", "write `from rclpy.type_support import check_for_type_support`"),
        ("import rclpy", "self.create_publishr(int, 'a', 10)", "Did you mean create_publisher?", "write self.create_publisher, or define self.create_publishr in __init__"),
    ],
)  # fmt: skip
def test_a_name_of_another_release_is_like_none(
    tmp_path: Path, imports: str, use: str, cause: str, fix: str
) -> None:
    ((said, way),) = told(tmp_path, imports, use)
    assert cause in said
    assert way.startswith(fix)


@pytest.mark.parametrize(
    ("caught", "fix"),
    [
        ("json.JSONDecoder", "write Exception, or the error that is meant, instead of JSONDecoder"),
        ("json.JSONDecodeError", ""),
        ("OSError", ""),
    ],
)
def test_what_is_caught_is_an_exception(tmp_path: Path, caught: str, fix: str) -> None:
    use = f"0\n        try:\n            json.loads('')\n        except {caught}:\n            raise"
    found = [way for _, way in told(tmp_path, "import json", use)]
    assert found == [fix] * bool(fix)


def test_what_a_module_imports_from_another_package_is_not_meant(tmp_path: Path) -> None:
    assert told(tmp_path, "import math", "rclpy.Lists") == [
        ("rclpy has no Lists in ROS 2 Jazzy.", "remove Lists here, or write what rclpy has for it")
    ]
