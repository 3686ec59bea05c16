"""The exercises of `04_first_node`: nodes are judged by what they publish, and when."""

from __future__ import annotations

import contextlib
import copy
import itertools
import re
import signal
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple, NoReturn

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from rclpy.time import Time

from ros2lab import every_node
from ros2lab.checks import CheckError, exercise, predict_of, questions_of, quiz_of
from ros2lab.checks.built import hint_of
from ros2lab.checks.first_node_program import (
    PERIOD,
    TYPE_HINT,
    check_end,
    observe_program,
    topic_hint,
)
from ros2lab.diagnose.explaining.notebook import find_cause
from ros2lab.domain_lease import discovery
from ros2lab.rhythm import has_period, median_gap
from ros2lab.topics import type_name

INT32, STRING = "std_msgs/msg/Int32", "std_msgs/msg/String"
SECONDS, STEP = 5.0, 0.1  # s, of the clock that is given to the node
MOST_CALLS = 100  # of a timer without a pause, in a step of the clock
DRIVE_TIMEOUT = 10.0  # s, for a node to be made, and to be driven


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
            "a class derived from Node",
            f"the class {node_class.__name__}" if isinstance(node_class, type) else repr(node_class),
            "Derive it from Node: class Battery(Node):"
            if isinstance(node_class, type)
            else "Give the name of the class, without parentheses and without quotes.",
        )
    with _private_node(node_class) as (node, all_told):
        _drive(node)
        name = node.get_fully_qualified_name()
        told = [entry for entry in all_told if entry.topic == "/battery"]
        if not told:
            raise CheckError("messages on /battery", *_silence(node, all_told))
    found_type = type_name(type(told[0].message))
    if found_type != INT32:
        raise CheckError(f"{INT32} on /battery", found_type, TYPE_HINT)
    _check_times([round(entry.second, 3) for entry in told])
    _check_charges([entry.message.data for entry in told])
    if name != "/battery":
        raise CheckError(
            "a node named battery", f"the name {name}", "The name is the argument of super().__init__."
        )
    return (
        f"Right: in five seconds of its clock it published 100, 99, and so on to {told[-1].message.data}, "
        "every half second."
    )


@exercise
def battery_program() -> str:
    """Check that `ros2 run my_robot_controller battery` publishes the charge on /battery, and ends at Ctrl-C.

    Raises:
        CheckError: if there is no such executable, it was not built since, or it does something else.
    """
    observed = observe_program("battery", "/battery", INT32)
    _check_period(observed.period)  # first, for of those that come too fast some are lost
    _check_charges([message.data for message in observed.messages], is_from_start=observed.is_from_start)
    check_end(observed)
    return "Right: it runs by itself, the charge goes down, and Ctrl-C ends it cleanly."


@exercise
def own_words() -> str:
    """Check that `my_first_node` publishes words of the student's own twice a second, and still counts.

    Raises:
        CheckError: if it publishes what it did before, does not count, keeps its period, or publishes nothing.
    """
    observed = observe_program("my_first_node", "/robot_news", STRING)
    texts = [message.data for message in observed.messages]
    words, sign, _ = texts[0].rpartition("#")
    numbers = list(map(_number, texts))
    expected = "words of your own, and then # and a number that grows by one"
    if "{" in texts[0]:
        raise CheckError(
            expected, repr(texts[0]), "Python fills the braces only with the f before the quote."
        )
    if "Hello ROS2" in words or (sign and not any(map(str.isalpha, words))):
        hint = "The line with text = is what is published: write words of your own before the #."
        raise CheckError(expected, repr(texts[0]), hint)
    if None in numbers:
        raise CheckError(expected, repr(texts[0]), "Keep #{self.count} at the end of the text.")
    _check_period(observed.period)  # before the numbers, for of those that come too fast some are lost
    if any(later - earlier != 1 for earlier, later in itertools.pairwise(map(int, filter(None, numbers)))):
        found = " and then ".join(map(repr, texts[:2]))
        raise CheckError(expected, found, "self.count += 1 raises the counter before each message.")
    return "Right: the robot publishes your news, twice a second."


QUIZ, PREDICTIONS = questions_of(__name__)
quiz = quiz_of(__name__, QUIZ)
predict = predict_of(__name__, PREDICTIONS)

_PERIOD_HINT = "The first argument of create_timer is the period in seconds: twice a second is 0.5."


def _check_times(seconds: list[float]) -> None:
    """Check when a node that was given a clock published."""
    expected = "messages at 0.5, 1.0, 1.5, ... s"
    if len(seconds) == 1:
        when = f"at {seconds[0]} s" if seconds[0] else "when the node was made"
        hint = "A timer made with create_timer publishes again and again, until it is cancelled."
        raise CheckError(expected, f"one message, {when}", hint)
    periods = (median_gap([0.0, *seconds]), SECONDS / len(seconds))  # the second one if some are left out
    if not all(has_period(period, PERIOD) for period in periods):
        is_at_once = not any(seconds)
        hint = (
            "A function that create_timer calls publishes one message at a time."
            if is_at_once
            else _PERIOD_HINT
        )
        raise CheckError(expected, f"messages at {_listed(seconds)} s", hint)


def _check_charges(charges: Sequence[int], *, is_from_start: bool = True) -> None:
    """Check that the charge begins with 100, or later if the first ones were missed, and goes down by one."""
    steps = {later - earlier for earlier, later in itertools.pairwise(charges)}
    if steps == {-1} and (charges[0] == 100 or (charges[0] < 100 and not is_from_start)):
        return
    if steps == {0}:
        hint = "Nothing changes the charge: take one away after each message, with self.charge -= 1."
    elif steps == {1}:
        hint = "-= takes away and += adds: the charge goes down."
    elif steps != {-1}:
        hint = "Each charge is one less than the one before: self.charge -= 1, once for each message."
    elif charges[0] == 99:
        hint = "Publish the charge first, and take one away afterwards."
    else:
        hint = "Begin with 100, a full battery."
    raise CheckError("100, 99, 98, ...", _listed(charges), hint)


def _check_period(period: float | None) -> None:
    if period is not None and has_period(period, PERIOD):
        return
    if period is None:
        found, hint = "messages at no regular time", _PERIOD_HINT
    else:
        found = f"one message every {period:.2g} s"
        hint = (
            "There is no pause between the messages: let a timer call."
            if period < PERIOD / 20
            else _PERIOD_HINT
        )
    raise CheckError("a message every 0.5 s", found, hint)


class _TooLong(BaseException):
    """Raised by the alarm; not an Exception, so that a node does not catch it."""


@contextlib.contextmanager
def _private_node(node_class: type[Node]) -> Iterator[tuple[Node, list[Told]]]:
    """Make a node that nobody else receives, with a clock that stands still, and note what it publishes."""
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
                second = self.get_clock().now().nanoseconds / 1e9
                told.append(
                    Told(second, publisher.topic_name, copy.deepcopy(message))
                )  # it may be used again

            publisher.publish = note
            return publisher

    Watched.__init__.__qualname__ = Node.__init__.__qualname__  # which Python names in its errors
    # Between the student's class and Node in the order in which methods are looked up.
    watched: type[Node] = type(node_class.__name__, (node_class, Watched), {})
    return watched()


def _drive(node: Node) -> None:
    """Move the node's clock on, and let the node do at each step what is due."""
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    try:
        with _students_faults():
            for step in range(1, round(SECONDS / STEP) + 1):
                node.get_clock().set_ros_time_override(Time(nanoseconds=round(step * STEP * 1e9)))
                for _ in range(MOST_CALLS):
                    if not any(timer.is_ready() for timer in node.timers):
                        break
                    executor.spin_once(timeout_sec=0)
                else:  # a timer that is always due
                    return
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
            "There is no loop and no sleep in a node: the timer calls again and again.",
        ) from None
    except (Exception, SystemExit) as error:
        cause = find_cause(error)
        raise CheckError(
            "a node that can be made and run",
            f"it raised {type(error).__name__}: {' '.join(str(error).split())}",
            hint_of(cause)
            if cause
            else "Run the cell that tries it, and read the last line of the traceback.",
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


def _silence(node: Node, told: list[Told]) -> tuple[str, str]:
    """Return what a node does that publishes nothing on the topic that was asked for, and a hint."""
    others = sorted({entry.topic for entry in told} - every_node.TOPICS)
    topics = sorted({publisher.topic_name for publisher in node.publishers} - every_node.TOPICS)
    periods = [timer.timer_period_ns / 1e9 for timer in node.timers]
    if others:
        return f"messages on {_listed(others)}", topic_hint("/battery", others)
    if not topics:
        return "no publisher", "create_publisher in __init__ makes one, with the type and the topic."
    publisher = f"a publisher on {_listed(topics)}"
    if not periods:
        return (
            f"{publisher} and no timer",
            "create_timer in __init__ makes one, with the period and the function.",
        )
    if min(periods) > SECONDS:
        return (
            f"{publisher}, and a timer that waits for {min(periods):g} s",
            "The period is in seconds, not in milliseconds.",
        )
    return (
        f"{publisher}, and nothing published by a timer of {min(periods):g} s",
        "Its function has to call publish(...) of the publisher, with the message in the parentheses.",
    )


def _listed(values: Sequence[Any]) -> str:
    return ", ".join([*map(str, values[:4]), *(["..."] if len(values) > 4 else [])])


def _number(text: str) -> int | None:
    """Return the number after the last # of a text; None if there is none."""
    match = re.search(r"#\s*(\d+)\s*$", text)
    return int(match[1]) if match else None
