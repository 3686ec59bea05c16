"""`ros2 service call`."""

from __future__ import annotations

import argparse
import sys
import time
from typing import Any

from portable_ros2 import messages
from portable_ros2.commands.service import _services
from portable_ros2.graph import NODE_NAME_PREFIX, GraphNode
from portable_ros2.verb import Verb

PATIENCE = 0.5  # s without the service until it is said that it is waited for
CHECK_PERIOD = 0.2  # s between two looks whether the service is still there
LOST_PERIODS = 5  # so many looks must have missed it


class CallVerb(Verb):
    """Call a service."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _services.add_service_argument(parser, "call to (e.g. '/add_two_ints')")
        kind = parser.add_argument("service_type", help="Type of the ROS service (e.g. 'std_srvs/srv/Empty')")
        kind.completer = _services.complete_type  # type: ignore[attr-defined]
        group = parser.add_mutually_exclusive_group()
        values = group.add_argument(
            "values",
            nargs="?",
            default="{}",
            help="Values to fill the service request with in YAML format (e.g. '{a: 1, b: 2}'), "
            "otherwise the service request will be published with default values",
        )
        values.completer = _services.complete_values  # type: ignore[attr-defined]
        group.add_argument("--stdin", action="store_true", help="Read values from standard input")
        parser.add_argument(
            "-r", "--rate", metavar="N", type=float, help="Repeat the call at a specific rate in Hz"
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        if args.rate is not None and not args.rate > 0:
            raise RuntimeError("rate must be greater than zero")
        service_class: Any = messages.find_service(args.service_type)
        request = service_class.Request()
        text = sys.stdin.read() if args.stdin else args.values
        if text.strip():
            messages.fill(request, messages.parse_values(text))
        with _Caller(service_class, args.service_name) as caller:
            caller.wait()
            while True:
                start = time.monotonic()
                caller.call(request)
                if args.rate is None:
                    return
                time.sleep(max(0.0, start + 1 / args.rate - time.monotonic()))


class _Caller:
    """A node with a client of one service.

    Args:
        service_class: the service's type.
        name: the service's name.

    Raises:
        RuntimeError: if the name is not valid.
    """

    def __init__(self, service_class: Any, name: str) -> None:
        from rclpy.exceptions import InvalidServiceNameException

        self.name = name
        package = service_class.__module__.partition(".")[0]
        self.node = GraphNode(
            argparse.Namespace(), name=f"{NODE_NAME_PREFIX}_requester_{package}_{service_class.__name__}"
        )
        try:
            self.client = self.node.create_client(service_class, name)
        except (ValueError, InvalidServiceNameException) as error:
            self.node.close()
            raise RuntimeError(str(error)) from error

    def __enter__(self) -> _Caller:
        return self

    def __exit__(self, *_: object) -> None:
        self.node.close()

    def wait(self) -> None:
        """Wait until the service is there, for ever if need be."""
        if not self.client.wait_for_service(PATIENCE):
            print("waiting for service to become available...")
            self.client.wait_for_service()

    def call(self, request: Any) -> None:
        """Send a request and print it and the response.

        Raises:
            RuntimeError: if the service disappears before it answers.
        """
        import rclpy

        print(f"requester: making request: {request!r}\n")
        future = self.client.call_async(request)
        missed = 0
        while not future.done():
            rclpy.spin_until_future_complete(self.node.node, future, timeout_sec=CHECK_PERIOD)
            missed = 0 if self.client.service_is_ready() else missed + 1
            if missed >= LOST_PERIODS and not future.done():
                raise RuntimeError(f"The service '{self.name}' has gone without an answer")
        if future.exception() is not None:
            raise RuntimeError(f"Exception while calling service: {future.exception()!r}")
        print(f"response:\n{future.result()!r}\n")
