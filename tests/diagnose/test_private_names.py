"""Names that begin with `~`: they are read with the name of their node, or nothing is said of them."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

_LISTENS = "        self.subscription"


def near_misses(files: Files, root: Path) -> list[str]:
    return [one.cause for one in of_workspace(files.write(root)) if one.code == "topic-near-miss"]


def private(topic: str = "~/cmd_vel") -> Files:
    return Files.right(NAMES[0]).change("driver", "'/cmd_vel'", f"'{topic}'")


def listening(files: Files, topic: str) -> Files:
    files.change("listener", "import rclpy\n", "import rclpy\nfrom geometry_msgs.msg import Twist\n")
    line = f"        self.create_subscription(Twist, '{topic}', print, 10)\n"
    return files.change("listener", _LISTENS, line + _LISTENS)


@pytest.mark.parametrize("topic", ["~/cmd_vel", "~/comand", "~"])
def test_a_private_name_is_no_misspelt_name_of_the_course(tmp_path: Path, topic: str) -> None:
    """It begins with its node's name, so nobody else's was meant."""
    assert near_misses(private(topic), tmp_path) == []


def test_a_private_name_meets_its_whole_name(tmp_path: Path) -> None:
    """`~/wheels` of velocity_publisher is /velocity_publisher/wheels; one that is nearly that is told."""
    right = listening(private("~/wheels"), "/velocity_publisher/wheels")
    assert near_misses(right, tmp_path / "right") == []
    wrong = listening(private("~/wheels"), "/velocity_publisher/wheel")
    causes = near_misses(wrong, tmp_path / "wrong")
    assert causes
    assert all("'velocity_publisher/wheels'" in cause for cause in causes)


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("driver", "super().__init__('DRIVER')", "super().__init__(sys.argv[1])"),
        ("driver", "super().__init__('DRIVER')", "super().__init__('DRIVER', namespace='base')"),
        ("launch/robot.launch.py", "executable='DRIVER'", "executable='DRIVER', name='base'"),
    ],
)
def test_of_a_name_that_is_given_elsewhere_nothing_is_said(
    tmp_path: Path, name: str, old: str, new: str
) -> None:
    """Neither of the node that is not known, nor of one that a launch file calls otherwise."""
    files = listening(private("~/wheels"), "/velocity_publisher/wheel").change(name, old, new)
    assert near_misses(files, tmp_path) == []


def test_a_private_service_is_asked_by_its_whole_name(tmp_path: Path) -> None:
    """As a topic is; the name as it is written may look like another one."""
    files = Files.right(NAMES[0])
    for name, line in (
        ("driver", "self.create_service(Trigger, '~/reset', print)"),
        ("listener", "self.client = self.create_client(Trigger, '/b/reset')"),
    ):
        files.change(name, "import rclpy\n", "import rclpy\nfrom std_srvs.srv import Trigger\n")
        files.change(name, "        self.", f"        {line}\n        self.")
    files.change("driver", "super().__init__('DRIVER')", "super().__init__('b')")
    assert near_misses(files, tmp_path) == []


def test_two_names_that_one_node_uses_are_two_topics(tmp_path: Path) -> None:
    """Such as `tx` and `rx`: who wrote both means both."""
    both = listening(private("/arduino_tx"), "/arduino_rx")
    assert near_misses(both, tmp_path / "two nodes")
    one = Files.right(NAMES[0]).change("driver", "'/cmd_vel'", "'/arduino_tx'")
    heard = "        self.create_subscription(Twist, '/arduino_rx', print, 10)\n"
    one.change("driver", "        self.timer", f"{heard}        self.timer")
    assert near_misses(one, tmp_path / "one node") == []
