"""Lists in messages that hold messages of another type: what is told is published without an error."""

from __future__ import annotations

import re
import traceback
from pathlib import Path
from typing import Any

import pytest
import rclpy
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

NODE = """\
import rclpy
from geometry_msgs.msg import Point, Pose, PoseArray, PoseStamped
from nav_msgs.msg import Path
from rclpy.node import Node
from std_msgs.msg import String


class CLASS(Node):
    def __init__(self):
        super().__init__('MODULE')
        self.pub = self.create_publisher(TYPE, 'plan', 10)
        self.kept = TYPE()

    def plan(self):
        msg = TYPE()
        FILL
        self.pub.publish(SENT)


def main(args=None):
    rclpy.init(args=args)
    node = CLASS()
    node.plan()
    node.destroy_node()
    rclpy.shutdown()
"""


def run(code: str, path: Path) -> str:
    """Run what publishes, and return what Python prints if it fails."""
    names: dict[str, Any] = {}
    exec(compile(code, str(path), "exec"), names)
    try:
        names["main"]()
    except (AttributeError, AssertionError):
        return traceback.format_exc()
    finally:
        rclpy.try_shutdown()
    return ""


def written(kind: str, fill: str, sent: str) -> str:
    code = NODE.replace("TYPE", kind).replace("SENT", sent)
    return code.replace("FILL", fill.replace("\n", "\n        "))


CASES = [
    ("Path", "pose = Pose()\nmsg.poses.append(pose)", "msg", "msg.poses.append(PoseStamped(pose=pose))"),
    ("Path", "for x in range(3):\n    msg.poses.append(Pose())", "msg", "msg.poses.append(PoseStamped(pose=Pose()))"),
    ("Path", "self.kept.poses.append(Pose())", "self.kept", "self.kept.poses.append(PoseStamped(pose=Pose()))"),
    ("PoseArray", "pose = PoseStamped()\nmsg.poses.append(pose)", "msg", "msg.poses.append(pose.pose)"),
    ("PoseArray", "here = Point(x=1.0)\nmsg.poses.append(here)", "msg", "msg.poses.append(Pose(position=here))"),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "fill", "sent", "fix"), CASES)
def test_an_item_of_another_type(tmp_path: Path, kind: str, fill: str, sent: str, fix: str) -> None:
    files = Files.right(NAMES[0])
    files.put("node", written(kind, fill, sent))
    root = files.write(tmp_path)
    path = root / files.path("node")
    code = path.read_text()
    (found, *_) = of_text(f"$ ros2 run shop planner\n{run(code, path)}", root)
    assert found.code == "field-type"
    assert found.fix == f"write {fix}"
    line = code.splitlines()[int(found.place.rpartition(":")[2]) - 1].strip()
    assert not run(code.replace(line, fix), path)


def test_an_item_that_cannot_become_what_is_wanted(tmp_path: Path) -> None:
    files = Files.right(NAMES[0]).put("node", written("Path", "msg.poses.append(String())", "msg"))
    root = files.write(tmp_path)
    path = root / files.path("node")
    (found, *_) = of_text(run(path.read_text(), path), root)
    assert "msg.poses holds messages of type PoseStamped" in found.cause
    assert found.fix == "make a PoseStamped for each item of msg.poses, and append that"


def test_an_import_that_is_missing_is_told(tmp_path: Path) -> None:
    code = written("Path", "msg.poses.append(Pose())", "msg").replace(", PoseStamped", "")
    files = Files.right(NAMES[0]).put("node", code)
    root = files.write(tmp_path)
    path = root / files.path("node")
    (found, *_) = of_text(run(path.read_text(), path), root)
    match = re.search(r"with `(.+)` at the top", found.fix)
    assert match is not None
    assert match[1] == "from geometry_msgs.msg import PoseStamped"


@pytest.mark.parametrize(
    "fill", ["msg.poses.append(PoseStamped())", "self.others = []\nself.others.append(Pose())"]
)
def test_items_that_are_right(tmp_path: Path, fill: str) -> None:
    """Where something else fails on the line, the items are not blamed."""
    files = Files.right(NAMES[0]).put("node", written("Path", fill, "msg"))
    root = files.write(tmp_path)
    path = root / files.path("node")
    assert not run(path.read_text(), path)
    line = 1 + path.read_text().splitlines().index("        self.pub.publish(msg)")
    text = f"Traceback (most recent call last):\n  File \"{path}\", line {line}, in plan\n    self.pub.publish(msg)\nAttributeError: 'Pose' object has no attribute 'header'\n"
    assert "Python notices only" not in "".join(found.cause for found in of_text(text, root))


def test_a_list_of_other_messages_is_not_told_to_be_copied(tmp_path: Path) -> None:
    """The same items again would be refused again."""
    fill = "poses = []\nfor x in range(3):\n    poses.append(Pose())\nmsg.poses = poses"
    files = Files.right(NAMES[0]).put("node", written("Path", fill, "msg"))
    root = files.write(tmp_path)
    path = root / files.path("node")
    (found, *_) = of_text(run(path.read_text(), path), root)
    assert "PoseStamped" in found.cause
    assert " for " not in found.fix
    assert "msg.poses." not in found.fix
