"""A node that looks at the graph: who is there, and which topics and services."""

from __future__ import annotations

import argparse
import contextlib
import math
import os
import signal
import sys
import time
from collections.abc import Iterable, Iterator
from types import FrameType, TracebackType
from typing import Any, NamedTuple, NoReturn

from portable_ros2 import participants

DEFAULT_SPIN_TIME = 0.5  # s
PATIENCE = 10  # so many times the spin time is waited for what is known to be missing
NODE_NAME_PREFIX = "_ros2cli"
POLL_PERIOD = 0.02  # s
ASK_PERIOD = 0.1  # s between two questions to participants that have not been heard
SLOW_TIME = 4.0  # so many times the spin time is waited without news for what is known to be missing
PARTICIPANT_TOPIC = "ros_discovery_info"  # each participant with ROS nodes writes and reads it
NODE_TOPICS = ("/parameter_events", "/rosout")  # each node writes at least one of them
UNKNOWN_NODE = "_NODE_NAME_UNKNOWN_"
LONGEST_WAKING = (
    2.0  # s that rclpy's thread may take, on a busy machine, to shut the context down after a signal
)
ID_LENGTH = 16  # bytes of an endpoint's id


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


class Terminated(SystemExit):
    """SIGTERM has come; the code is its number."""


class GraphNode:
    """A node that knows the whole graph once the `with` block begins; unknown names are rclpy's `Node`'s.

    Args:
        args: what the options of `add_arguments` have become; what is missing has its default.
        name: the node's name; the default marks it as the tool's own.

    Raises:
        RuntimeError: if the name is none that a node can have, or the domain's id none.
    """

    def __init__(self, args: argparse.Namespace, *, name: str | None = None) -> None:
        import rclpy
        from rclpy.parameter import Parameter

        _check_domain()
        name = name or f"{NODE_NAME_PREFIX}_{os.getpid()}"
        _check_name(name)
        # rclpy wakes who waits before it shuts the context down: who looks in between would wait for ever.
        self._on_sigterm = signal.signal(signal.SIGTERM, _exit)
        if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
            # So a script starts what runs in its background. rclpy ends at SIGINT all the same; so does the rest.
            signal.signal(signal.SIGINT, signal.default_int_handler)
        rclpy.init(args=[])
        try:
            with (
                _head_start(),
                contextlib.closing(Discovery(getattr(args, "spin_time", DEFAULT_SPIN_TIME))) as discovery,
            ):
                self.node = rclpy.create_node(
                    name,
                    start_parameter_services=False,
                    parameter_overrides=[
                        Parameter("use_sim_time", value=getattr(args, "use_sim_time", False)),
                        Parameter("start_type_description_service", value=False),  # it would import numpy
                    ],
                    automatically_declare_parameters_from_overrides=True,
                )
                discovery.wait(self.node)
        except BaseException as error:
            with _interrupted(error):
                self._shut_down()
            raise

    def __getattr__(self, name: str) -> Any:
        if name == "node":  # it could not be created
            raise AttributeError(name)
        return getattr(self.node, name)

    def __enter__(self) -> GraphNode:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        with _interrupted(value):
            self.close()

    def close(self) -> None:
        """Destroy the node and its context."""
        self.node.destroy_node()
        self._shut_down()

    def _shut_down(self) -> None:
        sys.modules["rclpy"].try_shutdown()
        signal.signal(signal.SIGTERM, self._on_sigterm)


class Discovery:
    """Waits until the graph is known, by evidence and not for a guessed time.

    The kernel tells where participants of this machine listen. Each is asked; who answers that it belongs to
    ROS is waited for until its nodes are known by name. Who does not answer is stopped or no participant and
    has the spin time. Other machines' participants can only be asked all together: they have half of the spin
    time to answer, unless the discovery range excludes them.

    Args:
        spin_time: seconds; after it, whoever shows no sign of life is not waited for.
    """

    def __init__(self, spin_time: float) -> None:
        from rclpy.utilities import get_default_context

        self.spin_time = spin_time
        self.start = self.asked = time.monotonic()
        self.domain: int = get_default_context().get_domain_id()
        self.inquiry = self._inquiry()
        self.least = 0.0  # s that it takes at least
        if self.inquiry is None:
            self.least = spin_time
        elif _reaches_out():
            self.least = spin_time / 2
        self._ask()

    def wait(self, node: Any) -> None:
        """Return when the graph is known, or what is missing has had its time."""
        before: Heard | None = None
        changed = self.start
        while (now := time.monotonic()) < self.start + PATIENCE * self.spin_time:
            heard = Heard.by(node)
            if heard != before:
                before, changed = heard, now
            if now - self.start >= self.least and now - changed >= self._quiet_time(node, heard):
                return
            if now >= self.asked + ASK_PERIOD:
                self._ask()
            time.sleep(POLL_PERIOD)

    def close(self) -> None:
        """Ask no more."""
        if self.inquiry:
            self.inquiry.close()

    def _inquiry(self) -> participants.Inquiry | None:
        if _is_unusual():
            return None
        inodes = participants.sockets()
        own = next((listener for listener in self._listeners() if listener.inode in inodes), None)
        return own and participants.Inquiry(self.domain, own, reaches_out=_reaches_out())

    def _quiet_time(self, node: Any, heard: Heard) -> float:
        """Return for how many seconds there must be no news until it is sure that there will be none."""
        if self.inquiry is None:
            return 0.0
        self.inquiry.listen()
        present = {listener.port: listener for listener in self._listeners()}
        alive = {who for who, port in self.inquiry.participants.items() if port is None or port in present}
        if heard.has_unnamed or not alive <= heard.participants:
            return math.inf  # who has answered, or has nodes, will be heard
        needed = 0.0
        if silent := [present[port] for port in present.keys() - self.inquiry.answered]:
            needed = math.inf if any(map(_is_slow, silent)) else 1.0
        if not heard.is_consistent or not all(map(self.inquiry.has_told, alive)):
            return max(needed, SLOW_TIME) * self.spin_time
        announced = {
            endpoint for endpoint in self.inquiry.endpoints if endpoint[: participants.PREFIX_LENGTH] in alive
        }
        if announced - known_endpoints(node, heard.topics):
            return max(needed, SLOW_TIME) * self.spin_time
        return needed * self.spin_time

    def _ask(self) -> None:
        self.asked = time.monotonic()
        if self.inquiry:
            self.inquiry.ask(self._listeners())

    def _listeners(self) -> list[participants.Listener]:
        return participants.listeners(self.domain) or []


class Heard(NamedTuple):
    """What a node has heard of the graph at a moment.

    Args:
        participants: whose writer and reader of `ros_discovery_info` are known.
        is_consistent: whether every participant has been heard of in all ways, and has a node.
        has_unnamed: whether there are nodes whose names have not been heard.
        topics: with their types, as DDS names them.
        nodes: their names.
    """

    participants: set[bytes]
    is_consistent: bool
    has_unnamed: bool
    topics: list[tuple[str, list[str]]]
    nodes: list[str]

    @classmethod
    def by(cls, node: Any) -> Heard:
        """Return what a node has heard."""
        writers = node.get_publishers_info_by_topic(PARTICIPANT_TOPIC, no_mangle=True)
        readers = node.get_subscriptions_info_by_topic(PARTICIPANT_TOPIC, no_mangle=True)
        infos = [info for topic in NODE_TOPICS for info in node.get_publishers_info_by_topic(topic)]
        named = [info for info in infos if info.node_name != UNKNOWN_NODE]
        everyone = set(map(_participant, [*writers, *readers, *infos]))
        is_consistent = all(set(map(_participant, some)) == everyone for some in (writers, readers, named))
        heard = set(map(_participant, writers)) & set(map(_participant, readers))
        topics = node.get_topic_names_and_types(no_demangle=True)
        return cls(heard, is_consistent, len(named) < len(infos), topics, node.get_node_names())


def known_endpoints(node: Any, topics: Iterable[tuple[str, object]]) -> set[bytes]:
    """Return the ids of the writers and readers that a node knows, as `Inquiry.endpoints` does."""
    return {
        bytes(info.endpoint_gid)[:ID_LENGTH]
        for name, _ in topics
        for ends in (node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic)
        for info in ends(name, no_mangle=True)
    }


def _participant(info: Any) -> bytes:
    """Return the id of the participant to which an endpoint belongs."""
    return bytes(info.endpoint_gid)[: participants.PREFIX_LENGTH]


def _is_slow(listener: participants.Listener) -> bool:
    """Return whether a participant has had no time to read what was sent to it, and is about to have it."""
    return not listener.is_read and participants.is_running(listener)


def _exit(number: int, _: FrameType | None) -> NoReturn:
    """End the program with a signal's number as its exit code, as the real command does."""
    raise Terminated(number)


def let_wake(error: BaseException | None) -> None:
    """Wait after a signal until rclpy has woken all who wait, and shut the context down.

    A thread of rclpy does so, without a lock. It crashes if what they wait on is destroyed meanwhile.
    """
    from rclpy.utilities import get_default_context

    if isinstance(error, (KeyboardInterrupt, Terminated)):
        deadline = time.monotonic() + LONGEST_WAKING
        while get_default_context().ok() and time.monotonic() < deadline:
            time.sleep(0.001)


@contextlib.contextmanager
def _interrupted(error: BaseException | None) -> Iterator[None]:
    """Clean up after an error; one that follows from Ctrl-C becomes a KeyboardInterrupt.

    rclpy shuts the context down at once. Whoever uses it before Python tells of the signal, or while a
    destructor swallows that, gets an error of its own instead.
    """
    from rclpy.utilities import get_default_context

    is_interrupted = isinstance(error, Exception) and not get_default_context().ok()
    let_wake(error)
    yield
    if is_interrupted:
        raise KeyboardInterrupt from error


@contextlib.contextmanager
def _head_start() -> Iterator[None]:
    """Let DDS begin to listen: making a complete node takes so long that others can answer meanwhile.

    All nodes of a context have one participant, which lives as long as one of them.
    """
    from rclpy.impl.implementation_singleton import rclpy_implementation
    from rclpy.utilities import get_default_context

    context = get_default_context()
    name = f"{NODE_NAME_PREFIX}_{os.getpid()}_start"  # not that of the other: rmw takes nodes by their names
    with context.handle:
        first = rclpy_implementation.Node(name, "", context.handle, None, False, False)
        try:
            yield
        finally:
            first.destroy_when_not_in_use()


def _check_name(name: str) -> None:
    """Raise a RuntimeError if a node cannot have a name; its text shows where."""
    from rclpy.exceptions import InvalidNodeNameException
    from rclpy.validate_node_name import validate_node_name

    try:
        validate_node_name(name)
    except InvalidNodeNameException as error:
        raise RuntimeError(str(error)) from error


def _check_domain() -> None:
    """Raise a RuntimeError if the domain's id is not one: DDS would say so in a way that nobody understands."""
    domain = os.environ.get("ROS_DOMAIN_ID") or "0"
    if not domain.isdecimal() or int(domain) > participants.LAST_DOMAIN:
        raise RuntimeError(f"ROS_DOMAIN_ID={domain} is not a number from 0 to {participants.LAST_DOMAIN}")


def _reaches_out() -> bool:
    """Return whether participants of other machines can be heard."""
    only_here = os.environ.get("ROS_LOCALHOST_ONLY") == "1"
    discovery_range = "LOCALHOST" if only_here else os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    return discovery_range.upper() not in ("LOCALHOST", "OFF") or bool(os.environ.get("ROS_STATIC_PEERS"))


def _is_unusual() -> bool:
    """Return whether discovery works in another way, of which there is no evidence."""
    from rclpy.utilities import get_rmw_implementation_identifier

    return (
        "fastrtps" not in get_rmw_implementation_identifier()
        or "ROS_DISCOVERY_SERVER" in os.environ
        or os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper() == "OFF"
    )
