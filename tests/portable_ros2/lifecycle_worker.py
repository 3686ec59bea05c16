"""A node with states, for the tests of `ros2 lifecycle`; its second activation fails.

Run as a process of its own; the line "ready" says that it is there. With the argument `silent` it never answers.
"""

from __future__ import annotations

import signal
import sys
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn


class Camera(LifecycleNode):
    """A node that can be activated once."""

    def __init__(self) -> None:
        super().__init__("camera", namespace="/ns")
        self.activations = 0

    def on_activate(self, state: Any) -> Any:
        """Become active, but only at the first time."""
        self.activations += 1
        if self.activations > 1:
            return TransitionCallbackReturn.FAILURE
        return super().on_activate(state)


def main() -> None:
    """Spin the node until it is told to end."""
    rclpy.init(args=sys.argv)
    node = Camera()
    print("ready", flush=True)
    try:
        signal.pause() if "silent" in sys.argv else rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
