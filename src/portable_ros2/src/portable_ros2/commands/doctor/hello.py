"""`ros2 doctor hello`."""

from __future__ import annotations

import argparse
import re
import socket
import struct
import sys
import time
from collections import Counter
from typing import Any

from portable_ros2 import graph
from portable_ros2.commands.topic import _topics
from portable_ros2.verb import Verb

GROUP, PORT = "225.0.0.1", 49150  # as the real one has them, so that both hear each other
GREETING = "hello, it's me "
LONGEST = 4096  # bytes


class HelloVerb(Verb):
    """Check network connectivity between multiple hosts.

    On several machines at once, each tells which others it hears: on a topic, and by multicast itself.
    """

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument(
            "-t",
            "--topic",
            default="/canyouhearme",
            help="Name of ROS topic to publish to (default: '/canyouhearme')",
        )
        for short, name, default, what in (
            ("-ep", "--emit-period", 0.1, "publish/send one message"),
            ("-pp", "--print-period", 1.0, "print summary table"),
        ):
            parser.add_argument(
                short,
                name,
                metavar="N",
                type=_topics.positive_float,
                default=default,
                help=f"Time period to {what} (default: {default}s)",
            )
        parser.add_argument("--ttl", type=_topics.positive_int, help="TTL for multicast send (default: None)")
        parser.add_argument(
            "-1",
            "--once",
            action="store_true",
            help="Publish and multicast send for one emit period then exit",
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        from std_msgs.msg import String

        name = re.sub(r"\W", "_", f"ros2doctor_{socket.gethostname()}_node", flags=re.ASCII)
        with graph.GraphNode(argparse.Namespace(), name=name) as node, _Multicast(args.ttl) as multicast:
            heard: Counter[str] = Counter()
            publisher = node.create_publisher(String, args.topic, 10)
            node.create_subscription(String, args.topic, lambda message: _note(heard, message.data), 10)
            begun = time.monotonic()
            sent = 0
            while True:
                publisher.publish(String(data=GREETING + socket.gethostname()))
                multicast.send()
                sent += 1
                _topics.spin(node, timeout=args.emit_period)
                multicast.receive()
                if args.once or time.monotonic() - begun > args.print_period:
                    _print(args, sent, heard, multicast)
                    heard.clear()
                    multicast.forget()
                    begun, sent = time.monotonic(), 0
                if args.once:
                    return


class _Multicast:
    """Sends and receives datagrams to a group of machines; where the network has no multicast, says so once."""

    def __init__(self, ttl: int | None) -> None:
        self.sent = 0
        self.heard: Counter[str] = Counter()
        self._is_told = False
        self._sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            if ttl is not None:
                self._sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, ttl)
            for option in (socket.SO_REUSEADDR, socket.SO_REUSEPORT):
                self._receiver.setsockopt(socket.SOL_SOCKET, option, 1)
            self._receiver.bind((GROUP, PORT))
            member = struct.pack("4sl", socket.inet_aton(GROUP), socket.INADDR_ANY)
            self._receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
        except OSError as error:
            self._tell(error)
        self._receiver.setblocking(False)

    def __enter__(self) -> _Multicast:
        return self

    def __exit__(self, *_: Any) -> None:
        self._sender.close()
        self._receiver.close()

    def send(self) -> None:
        """Greet the others."""
        try:
            self._sender.sendto((GREETING + socket.gethostname()).encode(), (GROUP, PORT))
        except OSError as error:
            self._tell(error)
        else:
            self.sent += 1

    def receive(self) -> None:
        """Count the greetings that have come."""
        while True:
            try:
                data = self._receiver.recv(LONGEST)
            except OSError:  # none is left
                return
            _note(self.heard, data.decode(errors="replace"))

    def forget(self) -> None:
        """Count anew."""
        self.sent = 0
        self.heard.clear()

    def _tell(self, error: OSError) -> None:
        if not self._is_told:
            print(f"Multicast does not work here: {error.strerror}", file=sys.stderr)
        self._is_told = True


def _note(heard: Counter[str], greeting: str) -> None:
    host = greeting.rsplit(maxsplit=1)[-1] if greeting.split() else ""
    if host and host != socket.gethostname():
        heard[host] += 1


def _print(args: argparse.Namespace, sent: int, heard: Counter[str], multicast: _Multicast) -> None:
    print("MULTIMACHINE COMMUNICATION SUMMARY")
    print(f"Topic: {args.topic}, Published Msg Count: {sent}")
    print("Subscribed from:")
    _print_hosts(heard, args.print_period)
    print(f"Multicast Group/Port: {GROUP}/{PORT}, Sent Msg Count: {multicast.sent}")
    print("Received from:")
    _print_hosts(multicast.heard, args.print_period)
    print("-" * 60)


def _print_hosts(heard: Counter[str], period: float) -> None:
    rows = [("Hostname", f"Msg Count /{period}s"), *heard.items()]
    for host, count in rows:
        print(f"{'':<15} {host:<20} {count:<10}")
