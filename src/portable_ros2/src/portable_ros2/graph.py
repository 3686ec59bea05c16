"""A node that looks at the graph: who is there, and which topics and services."""

from __future__ import annotations

import argparse
import os
import sys
import time
from types import TracebackType
from typing import Any

DEFAULT_SPIN_TIME = 0.5  # s
NODE_NAME_PREFIX = "_ros2cli"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that every command has which looks at the graph."""
    parser.add_argument(
        "--spin-time",
        type=float,
        default=DEFAULT_SPIN_TIME,
        help="Spin time in seconds to wait for discovery (only applies when not using an already running daemon)",
    )
    parser.add_argument("-s", "--use-sim-time", action="store_true", help="Enable ROS simulation time")
    parser.add_argument(
        "--no-daemon", action="store_true", help="Do not spawn nor use an already running daemon"
    )


class GraphNode:
    """A node that knows the whole graph once the `with` block begins; unknown names are rclpy's `Node`'s.

    Args:
        args: what the options of `add_arguments` have become; what is missing has its default.
        name: the node's name; the default marks it as the tool's own.
    """

    def __init__(self, args: argparse.Namespace, *, name: str | None = None) -> None:
        import rclpy
        from rclpy.parameter import Parameter

        rclpy.init(args=[])
        self.node = rclpy.create_node(
            name or f"{NODE_NAME_PREFIX}_{os.getpid()}",
            start_parameter_services=False,
            parameter_overrides=[Parameter("use_sim_time", value=getattr(args, "use_sim_time", False))],
            automatically_declare_parameters_from_overrides=True,
        )
        self._wait_for_discovery(getattr(args, "spin_time", DEFAULT_SPIN_TIME))

    def _wait_for_discovery(self, timeout: float) -> None:
        time.sleep(timeout)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.node, name)

    def __enter__(self) -> GraphNode:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Destroy the node and its context."""
        rclpy = sys.modules["rclpy"]
        self.node.destroy_node()
        rclpy.try_shutdown()
