"""The nodes that run while commands are compared: `python against_ros2cli_nodes.py WORLD`.

They say one line when they are there, and end with their standard input.
`talkers` publish fixed messages, offer services and have parameters of every type; `twins` are two nodes of
one name. What arrives at /heard and /heard_twist is written into the file that HEARD names.
"""

from __future__ import annotations

import os
import sys
import threading
from pathlib import Path
from typing import Any

import rclpy
from geometry_msgs.msg import PoseStamped, Twist
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Bool, Float64MultiArray, Int32, String, UInt8MultiArray
from std_srvs.srv import Empty, SetBool, Trigger

PERIOD = 0.1  # s
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
BEST_EFFORT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)


class Talker(Node):
    """Publishes the same messages ten times a second, and has parameters and services."""

    def __init__(self) -> None:
        super().__init__("talker")
        self._declare()
        twist = Twist()
        twist.linear.x, twist.angular.z = 0.5, -1.0
        array = Float64MultiArray(data=[float(number) for number in range(200)])
        messages: dict[str, tuple[Any, Any]] = {
            "chatter": (String(data="hello"), 10),
            "number": (Int32(data=7), 10),
            "flag": (Bool(data=True), 10),
            "twist": (twist, 10),
            "array": (array, 10),
            "bytes": (UInt8MultiArray(data=list(range(5))), 10),
            "long_text": (String(data="x" * 300), 10),
            "quick": (String(data="hello"), BEST_EFFORT),
            "_hidden": (String(data="hidden"), 10),
        }
        self._publishers_of = [
            (self.create_publisher(type(message), topic, quality), message)
            for topic, (message, quality) in messages.items()
        ]
        self._pose = self.create_publisher(PoseStamped, "pose", 10)
        self._latched = self.create_publisher(String, "latched", LATCHED)
        self._latched.publish(String(data="kept"))
        self.create_publisher(String, "silent", 10)
        self.create_service(SetBool, "switch", _switch)
        self.create_service(Trigger, "trigger", _trigger)
        self.create_service(Empty, "nothing", lambda _, response: response)
        self.create_timer(PERIOD, self._publish)
        self.add_on_set_parameters_callback(_refuse)

    def _declare(self) -> None:
        self.declare_parameter("a_bool", True, ParameterDescriptor(description="Whether it is on"))
        self.declare_parameter(
            "an_int",
            3,
            ParameterDescriptor(
                description="From 0 to 10",
                integer_range=[IntegerRange(from_value=0, to_value=10, step=1)],
            ),
        )
        self.declare_parameter(
            "a_double",
            0.5,
            ParameterDescriptor(
                description="Metres a second",
                additional_constraints="not too quick",
                floating_point_range=[FloatingPointRange(from_value=0.0, to_value=1.0, step=0.0)],
            ),
        )
        self.declare_parameter("a_string", "text")
        self.declare_parameter("bools", [True, False])
        self.declare_parameter("ints", [1, 2, 3])
        self.declare_parameter("doubles", [0.5, 1.5])
        self.declare_parameter("strings", ["a", "b c"])
        self.declare_parameter("group.inner", 1)
        self.declare_parameter("group.deeper.inner", "x")
        self.declare_parameter("fixed", 1, ParameterDescriptor(read_only=True))
        self.declare_parameter("any", None, ParameterDescriptor(dynamic_typing=True))

    def _publish(self) -> None:
        for publisher, message in self._publishers_of:
            publisher.publish(message)
        pose = PoseStamped()
        pose.header.stamp = self.get_clock().now().to_msg()
        pose.header.frame_id = "map"
        pose.pose.orientation.w = 1.0
        self._pose.publish(pose)


class Listener(Node):
    """Writes down what it hears."""

    def __init__(self) -> None:
        super().__init__("listener", namespace="/deep/space")
        self._file = Path(os.environ["HEARD"])
        self.create_subscription(String, "/heard", self._write, 10)
        self.create_subscription(Twist, "/heard_twist", self._write, 10)
        self.create_subscription(Int32, "/chatter_of_another_type", self._write, 10)

    def _write(self, message: Any) -> None:
        with self._file.open("a", encoding="utf-8") as file:
            file.write(f"{message}\n")


class Mixed(Node):
    """Publishes /mixed with one of two types: no process may publish both."""

    def __init__(self, kind: type, context: Context) -> None:
        name = f"_mixed_{kind.__name__.lower()}"
        super().__init__(name, context=context, start_parameter_services=False)
        self.create_publisher(kind, "/mixed", 10)


def _switch(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
    response.success, response.message = request.data, "on" if request.data else "off"
    return response


def _trigger(_: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
    response.success, response.message = True, "done"
    return response


def _refuse(parameters: list[Any]) -> SetParametersResult:
    is_refused = any(parameter.name == "a_string" and parameter.value == "bad" for parameter in parameters)
    return SetParametersResult(successful=not is_refused, reason="bad is not good" if is_refused else "")


def main(arguments: list[str]) -> None:
    """Run the nodes of a world until the standard input ends."""
    (world,) = arguments
    rclpy.init()
    other = Context()  # another participant
    other.init()
    kinds: list[Node] = []
    if world == "talkers":
        kinds = [Talker(), Listener(), Mixed(String, rclpy.get_default_context()), Mixed(Int32, other)]
    elif world == "twins":
        kinds = [Node("twin"), Node("twin")]
    executor = SingleThreadedExecutor()
    for node in kinds:
        if node.context is not other:
            executor.add_node(node)
    threading.Thread(target=_wait_for_the_end, daemon=True).start()
    print("ready", flush=True)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        for node in kinds:
            node.destroy_node()
        other.try_shutdown()
        rclpy.try_shutdown()


def _wait_for_the_end() -> None:
    sys.stdin.read()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main(sys.argv[1:])
