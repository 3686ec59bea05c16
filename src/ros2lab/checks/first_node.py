"""The exercises of `04_first_node`: nodes are judged by what they publish, and when."""

from __future__ import annotations

import contextlib
import math
import os
import re
import signal
import time
from collections.abc import Iterator
from typing import Any, NamedTuple, NoReturn

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from rclpy.time import Time
from std_msgs.msg import Int32, String

from ros2lab import course
from ros2lab.checks import CheckError, Question, exercise, quiz_of
from ros2lab.checks.programs import overlay_of
from ros2lab.node_process import NodeProcess, last_line
from ros2lab.observed_domain import discovery, has_period, median_gap
from ros2lab.topics import type_name
from ros2lab.workspace import Workspace

WORKSPACE = "~/first_node_ws"
PACKAGE = "my_robot_controller"
PERIOD, SECONDS, STEP = 0.5, 5.0, 0.1  # s, of the clock that is given to the node
DRIVE_TIMEOUT = 10.0  # s, for a node to be made, and to be driven
EVERY_NODES_TOPICS = {"/parameter_events", "/rosout"}
HEAR_TIMEOUT = 15.0  # s, for two messages of a program on a busy machine

QUIZ = (
    Question(
        "c",
        "spin is what waits and calls; without it main comes to its end.",
        {
            "a": "without a timer it stayed, and was silent.",
            "b": "without a publisher there was an error.",
        },
    ),
    Question(
        "b",
        "without a timer nobody calls the function that publishes.",
        {
            "a": "without it there is no node that could be listed.",
            "c": "yours published before you listened: with which number did echo begin?",
        },
    ),
    Question(
        "a",
        "the brackets call it; a timer needs the function itself.",
        {
            "b": "for that the timer needs the function, not what it returns.",
            "c": "brackets call at once; the timer is not even made then.",
        },
    ),
    Question(
        "c",
        "a topic delivers to those who listen now.",
        {
            "a": "did any of them come while you listened?",
            "b": "the queue is for a listener that is slow, not for one that is not there.",
        },
    ),
)


class Told(NamedTuple):
    """A message that a node published, and the second on the node's own clock."""

    second: float
    topic: str
    message: Any


@exercise
def battery(node_class: Any) -> str:
    """Check that a node publishes 100, 99, ... on /battery (std_msgs/Int32) every 0.5 s of its clock.

    Args:
        node_class: derived from `rclpy.node.Node`; its `__init__` needs no argument.

    Raises:
        CheckError: if it does not.
    """
    if not (isinstance(node_class, type) and issubclass(node_class, Node)):
        raise CheckError(
            "a class derived from Node", repr(node_class), "give the name of the class, without brackets."
        )
    with _private_node(node_class) as (node, all_told):
        _drive(node)
        told = [entry for entry in all_told if entry.topic == "/battery"]
        if not told:
            raise CheckError(
                "messages on /battery", _silence(node, all_told), "a publisher says where, a timer says when."
            )
    name = type_name(type(told[0].message))
    if name != "std_msgs/msg/Int32":
        raise CheckError(
            "std_msgs/msg/Int32 on /battery", name, "the publisher's first argument is the type."
        )
    seconds = [round(entry.second, 3) for entry in told]
    periods = (median_gap([0.0, *seconds]), SECONDS / len(seconds))  # the second one if some are left out
    if not all(has_period(period, PERIOD) for period in periods):
        raise CheckError(
            "messages at 0.5, 1.0, 1.5, ... s",
            f"messages at {_listed(seconds)} s",
            "the timer's first argument is the period in seconds.",
        )
    charges = [entry.message.data for entry in told]
    if charges != [100 - n for n in range(len(charges))]:
        raise CheckError(
            "100, 99, 98, ...", _listed(charges), "publish the charge first, and then take one away."
        )
    return (
        f"Right: in five seconds of its clock it said 100, 99, and so on to {charges[-1]}, every half second."
    )


@exercise
def battery_program() -> str:
    """Check that `ros2 run my_robot_controller battery` publishes the charge on /battery.

    Raises:
        CheckError: if there is no such executable, or it says something else, or nothing.
    """
    told = _two_messages(
        "battery",
        "/battery",
        Int32,
        "is it in the file, named in setup.py, and built after that?",
        "run it in a terminal: `ros2 run my_robot_controller battery`, and look with `ros2 topic list`.",
        "the entry point is like that of my_first_node, with the other file's name.",
    )
    # The first ones may come before anybody listens.
    charges = [message.data for message in told]
    if charges[0] > 100 or charges[1] != charges[0] - 1:
        raise CheckError(
            "a charge that goes down by one", _listed(charges), "begin with 100, and take one away."
        )
    return "Right: it runs by itself, and the charge goes down."


@exercise
def own_words() -> str:
    """Check that `my_first_node` says something of the student's own, and still counts.

    Raises:
        CheckError: if it says what it said before, does not count, or says nothing.
    """
    told = _two_messages(
        "my_first_node",
        "/robot_news",
        String,
        "run it in a terminal, and read the last line of what it says.",
        "only the words between the quotes are to change.",
    )
    texts = [message.data for message in told]
    words = texts[0].rpartition("#")[0]
    if "Hello ROS2" in words or not any(map(str.isalpha, words)):
        raise CheckError(
            "words of your own, and then # and the number",
            repr(texts[0]),
            "change the line with text =, and save the file.",
        )
    if _number(texts[1]) - _number(texts[0]) != 1:
        raise CheckError(
            "# and a number that goes up by one",
            " and then ".join(map(repr, texts)),
            "keep #{self.count} at the end of the text, and the f before it.",
        )
    return "Right: the robot tells your news, and a linked file needed no build."


quiz = quiz_of(__name__, QUIZ)


class _TooLong(BaseException):
    """Raised by the alarm; not an Exception, so that a node does not catch it."""


@contextlib.contextmanager
def _private_node(node_class: type[Node]) -> Iterator[tuple[Node, list[Told]]]:
    """Make a node that nobody else hears, with a clock that stands still, and note what it publishes."""
    told: list[Told] = []
    with discovery("OFF"), _context() as context:
        with _students_faults():
            node = _watched(node_class, context, told)
        try:
            yield node, told
        finally:
            node.destroy_node()


def _watched(node_class: type[Node], context: Context, told: list[Told]) -> Node:
    class Watched(Node):
        def __init__(self, node_name: str, **options: Any) -> None:
            overrides = [
                Parameter("use_sim_time", value=True),
                *(options.pop("parameter_overrides", None) or []),
            ]
            super().__init__(node_name, **{**options, "context": context}, parameter_overrides=overrides)

        def create_publisher(self, *args: Any, **options: Any) -> Any:
            publisher = super().create_publisher(*args, **options)
            publish = publisher.publish

            def note(message: Any) -> None:
                publish(message)
                told.append(Told(self.get_clock().now().nanoseconds / 1e9, publisher.topic_name, message))

            publisher.publish = note
            return publisher

    # Between the student's class and Node in the order in which methods are looked up.
    watched: type[Node] = type(node_class.__name__, (node_class, Watched), {})
    return watched()


def _drive(node: Node) -> None:
    """Turn the hands of the node's clock, and let the node do at each step what is due."""
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    try:
        with _students_faults():
            for step in range(1, round(SECONDS / STEP) + 1):
                node.get_clock().set_ros_time_override(Time(nanoseconds=round(step * STEP * 1e9)))
                while any(timer.is_ready() for timer in node.timers):
                    executor.spin_once(timeout_sec=0)
    finally:
        executor.shutdown()


@contextlib.contextmanager
def _students_faults() -> Iterator[None]:
    """Turn what a student's node raises, or that it does not end, into a failed check."""

    def ring(*_: object) -> NoReturn:
        raise _TooLong

    handler = signal.signal(signal.SIGALRM, ring)
    before = signal.setitimer(signal.ITIMER_REAL, DRIVE_TIMEOUT)
    try:
        yield
    except _TooLong:
        raise CheckError(
            "a node that waits for its timer",
            f"after {DRIVE_TIMEOUT:g} s it still does something else",
            "no loop and no sleep in a node: the timer calls again and again.",
        ) from None
    except Exception as error:
        raise CheckError(
            "a node that can be made and run",
            f"it raised {type(error).__name__}: {error}",
            "the first line of __init__ is super().__init__ with the name; then publisher and timer.",
            "the timer takes a function without brackets, and the function takes self.",
        ) from error
    finally:
        signal.setitimer(signal.ITIMER_REAL, *before)
        signal.signal(signal.SIGALRM, handler)


@contextlib.contextmanager
def _context() -> Iterator[Context]:
    """Make a context beside that of the notebook's session."""
    context = Context()
    rclpy.init(
        args=["--ros-args", "--disable-stdout-logs"],
        context=context,
        signal_handler_options=SignalHandlerOptions.NO,
    )
    try:
        yield context
    finally:
        context.try_shutdown()


def _silence(node: Node, told: list[Told]) -> str:
    """Return what a node does that says nothing on the topic that was asked for."""
    others = sorted({entry.topic for entry in told} - EVERY_NODES_TOPICS)
    topics = sorted({publisher.topic_name for publisher in node.publishers} - EVERY_NODES_TOPICS)
    if others:
        return f"messages on {_listed(others)}"
    if not topics:
        return "no publisher"
    return f"a publisher on {_listed(topics)}, {'silent' if list(node.timers) else 'and no timer'}"


def _listed(values: list[Any]) -> str:
    return ", ".join([*map(str, values[:4]), *(["..."] if len(values) > 4 else [])])


def _number(text: str) -> float:
    """Return the number after the last # of a text; nan if there is none."""
    match = re.search(r"#\s*(\d+)\s*$", text)
    return int(match[1]) if match else math.nan


def _two_messages(executable: str, topic: str, message_type: type, *hints: str) -> list[Any]:
    """Start an executable as `ros2 run` does, and return the first two messages heard from it on a topic."""
    expected = f"`ros2 run {PACKAGE} {executable}` publishes on {topic}"
    workspace = Workspace(course.student_path(WORKSPACE))
    if executable not in [known.name for known in workspace.executables(PACKAGE)]:
        raise CheckError(expected, f"no executable {executable} in install/{PACKAGE}/lib/{PACKAGE}", *hints)
    environ = overlay_of(workspace)
    # A name that nobody else has: the student's own node may be running.
    remapped = f"/check_{os.getpid()}{topic}"
    command = ["ros2", "run", PACKAGE, executable, "--ros-args", "-r", f"{topic}:={remapped}"]
    types: set[str] = set()
    with _listener(remapped, message_type) as (executor, heard):
        process = NodeProcess(PACKAGE, executable, command, environ)
        try:
            deadline = time.monotonic() + HEAR_TIMEOUT
            while not (len(heard) > 1 or types) and process.is_running and time.monotonic() < deadline:
                executor.spin_once(timeout_sec=0.1)
                found = executor.get_nodes()[0].get_publishers_info_by_topic(remapped)
                types = {info.topic_type for info in found} - {type_name(message_type)}
            if not process.is_running:
                process.wait()  # until all that it said is read
            said = process.output  # before it tells of its interruption
        finally:
            process.stop()
    if len(heard) > 1:
        return heard[:2]
    raise CheckError(expected, _instead(said, types, bool(heard)), *hints)


@contextlib.contextmanager
def _listener(topic: str, message_type: type) -> Iterator[tuple[SingleThreadedExecutor, list[Any]]]:
    heard: list[Any] = []
    with _context() as context:
        node = Node("ros2lab_check", context=context, start_parameter_services=False)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        try:
            node.create_subscription(message_type, topic, heard.append, 10)
            yield executor, heard
        finally:
            executor.shutdown()
            node.destroy_node()


def _instead(output: str, types: set[str], is_heard: bool) -> str:
    """Return what a program did that was not heard."""
    if types:
        return f"a publisher of the type {', '.join(sorted(types))}"
    told = "one message and no more" if is_heard else "nothing on it"
    said = last_line(output)
    return f"{told}; its last line is {said!r}" if said else f"{told}, and no output"
