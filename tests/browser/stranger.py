"""Print, as lines of JSON, what is published on /robot/command, /cmd_vel and /goal; knows nothing of the lab."""

import json
import time

import rclpy
from geometry_msgs.msg import PoseArray, Twist
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String


def say(kind: str, value: object) -> None:
    """Print one line."""
    print(json.dumps({"kind": kind, "value": value, "time": time.monotonic()}), flush=True)


def main() -> None:
    """Listen until Ctrl-C."""
    rclpy.init()
    node = rclpy.create_node("stranger")
    node.create_subscription(String, "/robot/command", lambda message: say("command", message.data), 10)
    node.create_subscription(
        Twist, "/cmd_vel", lambda twist: say("velocity", [twist.linear.x, twist.angular.z]), 100
    )
    node.create_subscription(
        PoseArray,
        "/goal",
        lambda goal: say("goal", [goal.header.frame_id, *(pose.position.x for pose in goal.poses)]),
        10,
    )
    say("ready", True)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
