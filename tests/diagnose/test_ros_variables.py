"""ROS's own variables with values that ROS refuses: what real tools print, and what is to be typed then."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest

from ros2lab.diagnose import of_text

START = [sys.executable, "-c", "import rclpy; rclpy.init()"]
ALONE = "type `unset {}` in this terminal, and remove the line that sets it from ~/.bashrc"
REFUSED = [
    ("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp", "asks for the middleware rmw_cyclonedds_cpp, which is not installed here"),
    ("ROS_DOMAIN_ID", "abc", "a whole number from 0 to 101"),
    ("RCUTILS_LOGGING_USE_STDOUT", "yes", "valid values are 0 (use stderr) or 1 (use stdout)"),
    ("RCUTILS_COLORIZED_OUTPUT", "true", "valid values are 0"),
    ("ROS_AUTOMATIC_DISCOVERY_RANGE", "lan", "is set to lan, which ROS refuses"),
]  # fmt: skip


def shown(command: str, name: str, value: str) -> str:
    """Return what ROS prints if a variable has a value."""
    environment = {key: text for key, text in os.environ.items() if not key.startswith(("ROS_", "RMW_"))}
    done = subprocess.run(
        START, env={**environment, name: value}, capture_output=True, text=True, check=False
    )
    return f"$ {command}\n{done.stdout}{done.stderr}"


@pytest.mark.parametrize(("name", "value", "cause"), REFUSED)
def test_a_value_that_ros_refuses(name: str, value: str, cause: str) -> None:
    """Wherever it was set: before the command, in the terminal, or where nobody sees it."""
    for typed, fix in (
        (f"{name}={value} ros2 run shop seller", "type `ros2 run shop seller`"),
        (f"export {name}={value} && ros2 run shop seller", f"type `unset {name}`"),
        ("ros2 run shop seller", ALONE.format(name)),
    ):
        (found,) = of_text(shown(typed, name, value), None)
        assert found.code == "typed-wrong"
        assert cause in found.cause
        assert found.fix == fix


def test_a_middleware_that_is_misspelt() -> None:
    typed = "export RMW_IMPLEMENTATION='rmw_fastrtp_cpp'; ros2 topic list"
    (found,) = of_text(shown(typed, "RMW_IMPLEMENTATION", "rmw_fastrtp_cpp"), None)
    right = re.search(r"RMW_IMPLEMENTATION=(\w+)", found.fix)
    assert right is not None
    assert found.fix == "type `export RMW_IMPLEMENTATION=rmw_fastrtps_cpp; ros2 topic list`"
    assert "identifier" not in shown(typed, "RMW_IMPLEMENTATION", right[1])


def test_a_middleware_whose_library_is_not_there() -> None:
    said = "[ERROR] [rcl]: Error getting RMW implementation identifier / RMW implementation not installed (expected identifier of 'rmw_cyclonedds_cpp'), with error message 'failed to load shared library 'librmw_cyclonedds_cpp.so' due to dlopen error: librmw_cyclonedds_cpp.so: cannot open shared object file: No such file or directory, at ./src/shared_library.c:99', exiting with 1."
    (found,) = of_text(f"$ ros2 topic list\n{said}\n", None)
    assert found.fix == ALONE.format("RMW_IMPLEMENTATION")


@pytest.mark.parametrize(
    "text",
    [
        "$ ROS_LOCALHOST_ONLY=1 ros2 run shop seller\n[WARN] [1.1] [rcl]: ROS_LOCALHOST_ONLY is deprecated but still honored if it is enabled.\n[INFO] [2.1] [seller]: open\n",
        "$ RMW_IMPLEMENTATION=rmw_fastrtps_cpp ros2 run shop seller\n[INFO] [2.1] [seller]: open\n",
        f"{shown('ros2 topic list', *REFUSED[0][:2])}$ unset RMW_IMPLEMENTATION\n$ ros2 topic list\n/rosout\n",
    ],
)
def test_a_value_that_is_right_or_was_corrected(text: str) -> None:
    assert not [found for found in of_text(text, None) if "variable" in found.cause]
