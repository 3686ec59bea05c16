"""A node with parameters, services and clients, for the tests of `ros2 node`, `param` and `service`.

Run as a process of its own; the line "ready" says that it is there.
"""

from __future__ import annotations

import os
import sys
from typing import Any

import rclpy
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger


def main() -> None:
    """Spin the node until it is told to end."""
    rclpy.init(args=sys.argv)
    node = rclpy.create_node("worker", namespace="/ns")
    _declare(node)
    node.create_publisher(String, "said", 10)
    node.create_publisher(String, "_hidden", 10)
    node.create_subscription(String, "/heard", print, 10)
    node.create_client(Trigger, "/elsewhere")
    node.create_service(SetBool, "switch", _switch)
    node.create_service(Trigger, "_secret", _die)
    node.create_service(Trigger, "die", _die)
    print("ready", flush=True)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


def _declare(node: Any) -> None:
    values: dict[str, Any] = {
        "rate": 2.5,
        "count": 3,
        "is_on": True,
        "a.b": "text",
        "flags": [True, False],
        "numbers": [1, 2],
        "xs": [1.0, 2.5],
        "names": ["a", "b"],
    }
    for name, value in values.items():
        node.declare_parameter(name, value)
    limits = FloatingPointRange(from_value=0.0, to_value=2.0, step=0.5)
    described = ParameterDescriptor(description="A speed in m/s", floating_point_range=[limits])
    node.declare_parameter("speed", 1.5, described)
    steps = IntegerRange(from_value=1, to_value=9)
    node.declare_parameter("steps", 4, ParameterDescriptor(integer_range=[steps]))
    fixed = ParameterDescriptor(read_only=True, additional_constraints="always seven")
    node.declare_parameter("fixed", 7, fixed)
    node.declare_parameter("free", None, ParameterDescriptor(dynamic_typing=True))


def _switch(request: Any, response: Any) -> Any:
    response.success = request.data
    response.message = "on" if request.data else "off"
    return response


def _die(_: Any, __: Any) -> Any:
    os._exit(1)


if __name__ == "__main__":
    main()
