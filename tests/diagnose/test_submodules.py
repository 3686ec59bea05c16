"""A package is imported, and a module of it is asked for that this does not import."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

ASKED = [
    ("import rclpy", "rclpy.node.Node", "write `import rclpy.node` below line 1"),
    ("import rclpy", "rclpy.executors.MultiThreadedExecutor", "write `import rclpy.executors` below line 1"),
    ("import rclpy as r", "r.qos.QoSProfile", "write `import rclpy.qos` below line 1"),
    ("import sensor_msgs", "sensor_msgs.msg.Imu", "write `import sensor_msgs.msg` below line 1"),
    ("import launch_ros", "launch_ros.actions.Node", "write `import launch_ros.actions` below line 1"),
    ("import xml", "xml.etree.ElementTree.parse", "write `import xml.etree.ElementTree` below line 1"),
    ("import os, concurrent", "concurrent.futures.Future", "write `import concurrent.futures` below line 1"),
    ("import xml.dom", "xml.sax.parse", "write `import xml.sax` below line 1"),
    ("import my_bot", "my_bot.limits.LIMIT", "write `import my_bot.limits` below line 1"),
]


def missed(root: Path, imports: str, value: str) -> str:
    """Return what Python says of a file of these two lines."""
    file = root / "src/my_bot/my_bot/asks.py"
    file.write_text(f"{imports}\nvalue = {value}\n")
    done = subprocess.run([sys.executable, str(file)], capture_output=True, text=True, check=False)
    return done.stderr


@pytest.mark.parametrize(("imports", "value", "fix"), ASKED)
def test_the_import_is_told(tmp_path: Path, imports: str, value: str, fix: str) -> None:
    root = Files.right(NAMES[1]).write(tmp_path)
    (root / "src/my_bot/my_bot/limits.py").write_text("LIMIT = 1\n")
    file = root / "src/my_bot/my_bot/asks.py"
    file.write_text(f"{imports}\nvalue = {value}\n")
    first, name = value.split(".")[:2]
    owner = imports.rpartition("import ")[2].split()[-3 if " as " in imports else -1].partition(".")[0]
    text = f"Traceback (most recent call last):\n  File \"{file}\", line 2, in <module>\n    value = {value}\nAttributeError: module '{owner}' has no attribute '{name}'\n"
    assert first
    assert of_text(text, root)[0].fix == fix
    if owner not in ("my_bot",):
        assert missed(root, f"{imports}\n{fix.split('`')[1]}", value) == ""


@pytest.mark.parametrize("value", ["rclpy.sqin", "rclpy.create_nod", "rclpy.Quaternion", "rclpy.nothing"])
def test_what_is_no_module_is_not_imported_as_one(tmp_path: Path, value: str) -> None:
    root = Files.right(NAMES[1]).write(tmp_path)
    found = of_text(missed(root, "import rclpy", value), root)
    name = value.partition(".")[2]
    assert found
    assert f"import rclpy.{name}" not in found[0].fix
    offered = found[0].fix.partition("offers")[2]
    assert offered.count(",") < 7
    assert name not in offered.replace(",", " ").split()


def test_a_file_of_the_packages_name_is_not_the_package(tmp_path: Path) -> None:
    root = Files.right(NAMES[1]).write(tmp_path)
    (root / "src/my_bot/my_bot/sensor_msgs.py").write_text("")
    found = of_text(missed(root, "import sensor_msgs", "sensor_msgs.msg.Imu"), root)
    assert all("import sensor_msgs.msg" not in one.fix for one in found)


def test_a_misspelt_module_is_imported_as_well(tmp_path: Path) -> None:
    root = Files.right(NAMES[1]).write(tmp_path)
    found = of_text(missed(root, "import rclpy", "rclpy.nod.Node"), root)[0]
    assert "write node instead of nod, with `import rclpy.node` at the top" in found.fix
