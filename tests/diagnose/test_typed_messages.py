"""Messages typed as YAML: what does not fit their types is named, and the fix is one that ROS takes."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
import yaml
from geometry_msgs.msg import PoseStamped, Twist

from portable_ros2.messages import fill
from ros2lab.diagnose import of_text


def told(folder: Path, kind: str, word: str) -> tuple[str, str]:
    """Return what is said of a typed message, and the message of the fix."""
    said = f"$ ros2 topic pub --once /x {kind} {shlex.quote(word)}\nFailed to populate field: no\n"
    first = of_text(said, folder)[0]
    assert first.code == "typed-wrong"
    return first.cause, shlex.split(first.fix.partition("`")[2].rpartition("`")[0])[-1]


@pytest.mark.parametrize(
    ("word", "why", "x", "z"),
    [
        ("{linear: 0.4, angular: 0.1}", "linear is 0.4, but it is a message itself", 0.4, 0.1),
        ("{linear: [0.4, 0, 0]}", "linear is [0.4, 0, 0], but it is a message itself", 0.4, 0.0),
        ("{linear: {x: 0.4}, angular: 3}", "angular is 3, but it is a message itself", 0.4, 3.0),
        ("{liner: {x: 0.4}}", "The message has no field liner", 0.4, 0.0),
        ("{linear: {X: 0.4}}", "linear has no field X; its fields are x, y, z", 0.4, 0.0),
        ("{linear: {x: 0.4}, anguler: {z: 2}}", "The message has no field anguler", 0.4, 2.0),
        ("{linear.x: 0.4}", "The message must be", 0.4, 0.0),
        ("linear:", "linear is empty, but it is a message itself", 0.0, 0.0),
        ("{linear:{x:0.4}}", "The space after the colon", 0.4, 0.0),
        ("{linear: {x: 0.4}, angular: {z: 0.1}", "The message is not valid YAML", 0.4, 0.1),
        ("linear: {x: 0.4}, angular: {z: 0.1}", "The message is not valid YAML", 0.4, 0.1),
        ("{linear: {x: 0.4}, angular: {z: 0.1}}}", "The message is not valid YAML", 0.4, 0.1),
        ("{linear={x=0.4}}", "The message is not valid YAML", 0.4, 0.0),
    ],
)
def test_what_does_not_fit_a_twist(tmp_path: Path, word: str, why: str, x: float, z: float) -> None:
    cause, fixed = told(tmp_path, "geometry_msgs/msg/Twist", word)
    assert cause.startswith(why)
    fill(message := Twist(), yaml.safe_load(fixed))
    assert (message.linear.x, message.angular.z) == (x, z)


def test_what_does_not_fit_deep_in_a_message(tmp_path: Path) -> None:
    word = "{header: {frame_id: map}, pose: {position: [1, 2], orientaton: {w: 1}}}"
    cause, fixed = told(tmp_path, "geometry_msgs/msg/PoseStamped", word)
    assert cause.startswith("pose has no field orientaton; its fields are position, orientation.")
    fill(message := PoseStamped(), yaml.safe_load(fixed))
    pose = message.pose
    assert (message.header.frame_id, pose.position.y, pose.orientation.w) == ("map", 2.0, 1.0)
