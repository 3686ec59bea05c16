"""The program of lesson 4 while a check runs it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from ros2lab import course, diagnose
from ros2lab.checks import CheckError
from ros2lab.checks.built import BuiltExecutable, built_executable, hint_of
from ros2lab.checks.programs import overlay_of
from ros2lab.diagnose.finding import UNKNOWN, Finding
from ros2lab.node_process import NodeProcess, last_line
from ros2lab.observed_domain import ObservedDomain
from ros2lab.rhythm import median_gap
from ros2lab.topics import TopicLog
from ros2lab.workspace import Workspace

START_TIMEOUT = 20.0  # s, for a program to import ROS on a busy machine
END_TIMEOUT = 5.0  # s, for a program to end after Ctrl-C


WORKSPACE = "~/first_node_ws"
PACKAGE = "my_robot_controller"
PERIOD = 0.5  # s, between two messages
TYPE_HINT = "The type is the first argument of create_publisher, and the message is made of the same class."


class _Observed(NamedTuple):
    """What a program published and how it ended.

    Attributes:
        messages: in order.
        is_from_start: whether the first of them is the first that was published.
        period: the time between them in s; None if it is not regular.
        is_ended: whether Ctrl-C ended it.
        output: all that it printed.
    """

    messages: list[Any]
    is_from_start: bool
    period: float | None
    is_ended: bool
    output: str


class _Program:
    """An executable of the student's that runs in a domain of its own.

    Args:
        executable: its name.
        built: where it was installed, and what it calls.
        domain: in which it is observed.
        is_simulated: whether it is given the clock of the domain.
    """

    def __init__(
        self,
        executable: str,
        built: BuiltExecutable,
        domain: ObservedDomain,
        overlay: dict[str, str],
        is_simulated: bool,
    ) -> None:
        self.domain, self._built = domain, built
        self._command = f"`ros2 run {PACKAGE} {executable}`"
        clock = f"use_sim_time:={str(is_simulated).lower()}"
        command = [str(built.path), "--ros-args", "-p", clock]
        self.process: NodeProcess = domain.start(executable, command, overlay)

    def log(self, topic: str, wanted_type: str) -> TopicLog:
        """Listen on a topic as soon as the program publishes on it."""

        def is_there() -> bool:
            return topic in self.domain.published() or not self.process.is_running

        self.domain.wait_for_start(lambda: is_there() or bool(self.domain.nodes()), START_TIMEOUT)
        # A node that answers has been made as far as it will be; another one may be slow, or never spin.
        if not self.domain.wait(is_there) and not self.domain.all_answer():
            self.domain.wait(is_there, START_TIMEOUT)
        published = self.domain.published()
        self.expect_running()
        expected = f"{self._command} publishes on {topic}"
        if topic not in published:
            others = ", ".join(published)
            raise CheckError(
                expected,
                f"it publishes on {others or 'no topic'}",
                f"{topic_hint(topic, list(published))} What runs is {self._built.entry_point}."
                if others
                else "create_publisher in __init__ makes a publisher, with the type and the topic.",
            )
        if wanted_type not in published[topic]:
            raise CheckError(f"{wanted_type} on {topic}", ", ".join(published[topic]), TYPE_HINT)
        return self.domain.log(topic, wanted_type)

    def expect_running(self) -> None:
        if self.process.is_running:
            return
        self.process.wait()  # until all that it printed is read
        output = self.process.output
        said = last_line(output)
        expected = f"{self._command} runs until Ctrl-C"
        if "Traceback" not in output:
            raise CheckError(
                expected,
                f"it ended by itself; the last that it printed is {said!r}" if said else "it ended by itself",
                "main ends when its last line is done: rclpy.spin(node) waits there until Ctrl-C.",
            )
        raise CheckError(expected, said, _explained(output))


def observe_program(executable: str, topic: str, wanted_type: str) -> _Observed:
    """Run an executable in a domain of its own, on a clock that is driven or, if it follows none, in real time."""
    workspace = Workspace(course.student_path(WORKSPACE))
    built = built_executable(workspace, PACKAGE, executable)
    overlay = overlay_of(workspace)
    for is_simulated in (True, False):
        with ObservedDomain() as domain:
            program = _Program(executable, built, domain, overlay, is_simulated)
            log = program.log(topic, wanted_type)
            if is_simulated:
                period = domain.period(log, PERIOD)
            else:
                domain.wait(lambda: log.count >= 4 or not program.process.is_running, 8 * PERIOD)  # noqa: B023
                period = median_gap([sample.published for sample in log.samples()])
            program.expect_running()
            if period is None and is_simulated:
                continue
            if log.count < 2:
                raise CheckError(
                    f"messages on {topic}, one after the other",
                    "one message and no more" if log.count else "nothing is published on it",
                    "create_timer in __init__, with a period in seconds, calls the function that publishes "
                    "again and again.",
                )
            try:
                program.process.interrupt(END_TIMEOUT)
            except TimeoutError:
                is_ended = False
            else:
                is_ended = True
            return _Observed(
                [sample.message for sample in log.samples()],
                is_simulated,
                period,
                is_ended,
                program.process.output,
            )
    raise AssertionError("the second run returns or raises")


def check_end(observed: _Observed) -> None:
    """Check that Ctrl-C ended a program, and that it took this as a normal end."""
    if not observed.is_ended:
        raise CheckError(
            "Ctrl-C ends the program",
            f"{END_TIMEOUT:g} s after Ctrl-C it still runs",
            "main has to come to its end after Ctrl-C: catch KeyboardInterrupt only around rclpy.spin, and pass.",
        )
    if "Traceback" not in observed.output:
        return
    said = last_line(observed.output)
    raise CheckError(
        "no traceback at Ctrl-C",
        said,
        "Ctrl-C is a normal end: try, rclpy.spin(node), and then "
        "except (KeyboardInterrupt, ExternalShutdownException): pass."
        if said.startswith("KeyboardInterrupt") or "ExternalShutdownException" in said
        else "Ctrl-C has shut ROS 2 down already: rclpy.try_shutdown() does no harm then."
        if "shutdown" in said
        else _explained(observed.output),
    )


def _explained(output: str) -> str:
    """Return a hint to a traceback."""
    findings: list[Finding] = diagnose.of_text(output, course.student_path(WORKSPACE))
    known = next((finding for finding in findings if finding.code != UNKNOWN), None)
    return (
        hint_of(known)
        if known
        else "That is the last line of its traceback; above it stand the file and the line."
    )


def topic_hint(topic: str, others: Sequence[str]) -> str:
    """Return what to do about a topic on which nothing comes, though something does on others."""
    if any(other.endswith(topic) for other in others):
        return (
            f"A namespace stands before the topic: make the node without one, so that {topic} is all of it."
        )
    return f"Compare the topic with {topic}, letter by letter."
