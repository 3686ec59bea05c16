"""Node classes that nothing creates, and files that no executable runs, beside those that do run."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace
from workspace_files import Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.look import Look

# The node publishes Float32 on /range; what is beside it publishes Int32 there.
IMPORTS = ("from std_msgs.msg import String\n", "from std_msgs.msg import Float32, Int32, String\n")
MAIN = "\n\ndef main(args=None):\n"
OTHER = """\


class {name}(Node):
    def __init__(self):
        super().__init__('{node}')
        self.out = self.create_publisher(Int32, '/range', 10)
        self.clock = self.create_timer(0.5, self.tell)

    def tell(self):
        self.out.publish(Int32(data=1))
"""
READER = (
    "        self.state = 'idle'\n",
    "        self.state = 'idle'\n        self.near = self.create_subscription(Float32, '/range', self.on_range, 10)\n",
)
ON_RANGE = "\n    def on_range(self, msg):\n        self.get_logger().info(str(msg.data))\n"
SENDER = (
    "        self.count = 0\n",
    "        self.count = 0\n        self.range_ = self.create_publisher(Float32, '/range', 10)\n",
)
SENT = (
    "        self.publisher_.publish(msg)\n",
    "        self.publisher_.publish(msg)\n        self.range_.publish(Float32(data=1.0))\n",
)
FILE = f"import rclpy\nfrom rclpy.node import Node\nfrom std_msgs.msg import Int32\n{OTHER.format(name='Ranges', node='ranges')}{MAIN}    rclpy.init(args=args)\n    rclpy.spin(Ranges())\n"
ENTRY = "'status_publisher = my_bot.status_publisher:main',"


def ranges(*, is_sent: bool = True) -> Files:
    """Return a workspace whose nodes use /range with Float32: one reads it, and one may send it."""
    files = (
        right_workspace().change("node", *IMPORTS).change("listener", *IMPORTS).change("listener", *READER)
    )
    files.change("listener", MAIN, f"{ON_RANGE}{MAIN}")
    return files.change("node", *SENDER).change("node", *SENT) if is_sent else files


def types_told(files: Files, folder: Path) -> bool:
    return any(found.code == "topic-type" for found in of_workspace(files.write(folder)))


def beside(files: Files, text: str, name: str = "ranges") -> Files:
    """Return the workspace with one more Python file."""
    files.texts[files.path("node").replace("status_publisher.py", f"{name}.py")] = text
    return files


def test_a_class_that_nothing_creates_publishes_nothing(tmp_path: Path) -> None:
    dead = OTHER.format(name="Old", node="old")
    assert not types_told(ranges().change("node", MAIN, f"{dead}{MAIN}"), tmp_path)


@pytest.mark.parametrize("name", ["ranges", "status_backup", "old"])
def test_a_file_that_no_executable_runs_publishes_nothing(tmp_path: Path, name: str) -> None:
    assert not types_told(beside(ranges(), FILE, name), tmp_path)


def test_a_class_that_is_created_does(tmp_path: Path) -> None:
    other = OTHER.format(name="Other", node="other")
    files = ranges().change("node", MAIN, f"{other}{MAIN}")
    files.change(
        "node", "    node = StatusPublisher()\n", "    other = Other()\n    node = StatusPublisher()\n"
    )
    assert types_told(files, tmp_path)


def test_a_class_with_a_subclass_does(tmp_path: Path) -> None:
    files = beside(ranges(), FILE).change("node", *(MAIN, f"\n\nclass Mine(Ranges):\n    pass\n{MAIN}"))
    files.change("node", "import rclpy\n", "import rclpy\nfrom my_bot.ranges import Ranges\n")
    assert types_told(files, tmp_path)


@pytest.mark.parametrize("added", [f"{ENTRY}\n            'ranges = my_bot.ranges:main',", f"{ENTRY} *more,"])
def test_a_file_that_is_run_or_may_be_does(tmp_path: Path, added: str) -> None:
    assert types_told(beside(ranges(), FILE).change("setup.py", ENTRY, added), tmp_path)


def test_the_only_publisher_is_compared_even_if_its_entry_point_is_still_missing(tmp_path: Path) -> None:
    assert types_told(beside(ranges(is_sent=False), FILE), tmp_path)


@pytest.mark.parametrize(("is_run", "told"), [(True, 1), (False, 0)])
def test_only_nodes_that_are_run_are_told_apart_by_their_names(
    tmp_path: Path, is_run: bool, told: int
) -> None:
    files = beside(right_workspace(), FILE.replace("'ranges'", "'status_publisher'"))
    if is_run:
        files.change("setup.py", ENTRY, f"{ENTRY}\n            'ranges = my_bot.ranges:main',")
    found = Look(files.write(tmp_path)).findings
    assert [finding.code for finding in found].count("name-twice") == told
