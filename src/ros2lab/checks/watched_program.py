"""The student's nodes while a check runs them: driven by a simulated clock, told things, and listened to."""

from __future__ import annotations

import contextlib
import itertools
import os
import re
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from rclpy.qos import QoSProfile

from ros2lab import course, diagnose, environment
from ros2lab.checks import CheckError
from ros2lab.diagnose.finding import UNKNOWN
from ros2lab.diagnose.printed.error_text import read_error
from ros2lab.node_process import NodeProcess, last_line
from ros2lab.observed_domain import SILENT_PERIODS, ObservedDomain
from ros2lab.rhythm import distance, period_of
from ros2lab.run_record import RunRecord
from ros2lab.topics import TopicLog

STRING = "std_msgs/msg/String"
START_TIMEOUT = 20.0  # s, for a program to import ROS on a busy machine
SAID_NOTHING = "it said nothing"
SPIN_HINT = "a node lives as long as something spins it: is there a spin in main, and does main wait for it to return?"
# What ROS 2's launch prints if it fails itself, before the line of a process, and when a process has ended.
LAUNCH_FAILED = re.compile(
    r"^\[ERROR\] \[launch\]: (?:Caught exception in launch \(see debug for traceback\): )?"
)
LAUNCHED_LINE = re.compile(r"^\[(?P<process>[^\]]+-\d+)\] (?P<text>.*)$")
LAUNCHED_END = re.compile(
    r"^\[(?:ERROR|INFO)\] \[(?P<process>[^\]]+-\d+)\]: process has (?:died|finished cleanly)"
)


class NotDrivenError(Exception):
    """A node does not follow the simulated clock, so it is to be watched in real time."""


class Ended(NamedTuple):
    """A program that has ended: its name, and all that it has printed."""

    name: str
    output: str


class WatchedProgram:
    """A program of the student's that runs in a domain in which nobody else is.

    `SETTING` is that of the `Run` in which the grader sees it.

    Args:
        domain: where it runs.
        process: the program.
        is_driven: whether its nodes were started with the simulated clock.
        workspace: the student's, in which the cause of an error is looked for.
        nodes: how many nodes it starts.
    """

    SETTING = "alone"

    def __init__(
        self,
        domain: ObservedDomain,
        process: NodeProcess,
        workspace: Path,
        *,
        is_driven: bool = False,
        nodes: int = 1,
    ) -> None:
        self.domain, self.process = domain, process
        self._workspace, self._is_driven, self._nodes = workspace, is_driven, nodes
        self._spins = True
        self._printed_before = ""
        self._record: RunRecord | None = None

    @property
    def record(self) -> RunRecord:
        """What is seen of it since it was first asked for, as the grader has it."""
        if self._record is None:
            self._record = RunRecord(
                self.domain, [self.process], self.SETTING, "stepped" if self._is_driven else "real"
            )
        return self._record

    def ended(self) -> Ended | None:
        """Return what has ended though it should run; None if all is well."""
        return None if self.process.is_running else Ended(self.process.executable, self.process.output)

    def expect_alive(self, when: str = "") -> None:
        """Check that the program runs, and say its last words if it does not.

        Raises:
            CheckError: if it has ended.
        """
        ended = self.ended()
        if ended is None:
            return
        if self.process.returncode is not None:
            self.process.wait()  # until all that it has printed is read
            ended = self.ended() or ended
        words = last_words(ended.output)
        raise CheckError(
            f"{ended.name} runs until Ctrl-C",
            f"it ended{when and ' '}{when}: {words or SAID_NOTHING}",
            hint_for(ended.output, self._workspace),
        )

    def expect_publisher(self, topic: str, type_name: str) -> None:
        """Wait until the program publishes this type on a topic, once.

        Raises:
            CheckError: if it does not.
        """
        self._expect_typed_end(topic, type_name, "publishes", self.domain.published)
        count = self.domain.count_publishers(topic)
        if count > 1:
            nodes = self.domain.nodes()
            raise CheckError(
                f"one publisher on {topic}",
                f"{count} publishers, of the nodes {', '.join(nodes)}, so every subscriber receives all that they publish",
                "start each node once."
                if len(nodes) > self._nodes
                else "call create_publisher once, in __init__, and keep what it returns.",
            )

    def expect_subscription(self, topic: str, type_name: str) -> None:
        """Wait until the program subscribes to this type on a topic.

        Raises:
            CheckError: if it does not.
        """
        self._expect_typed_end(topic, type_name, "subscribes to", self.domain.subscribed)

    def log(self, topic: str, type_name: str, qos: QoSProfile | None = None) -> TopicLog:
        """Wait until the program publishes on a topic, and keep what comes from now on.

        Raises:
            CheckError: if it does not publish this type there.
        """
        self.expect_publisher(topic, type_name)
        self.record.listen()
        return self.domain.log(topic, type_name, qos)

    def tell(self, words: Mapping[str, str]) -> None:
        """Publish words by topic, of which the first is a command; the last one is kept for late nodes."""
        if self._spins and self.domain.nodes():
            self.spins()  # then all that it subscribes to is known
        if self._record:
            topic, command = next(iter(words.items()))
            self._record.begin(command, topic)
        self._printed_before = self.process.output
        for topic, word in words.items():
            self.domain.say(topic, word)
        if self._is_driven:  # what was told is taken in before the clock goes on
            self.domain.wait(lambda: self.domain.has_arrived() or self.ended())
            self.spins()

    def printed(self) -> str:
        """Return what the program has printed since it was told something the last time."""
        return self.process.output.removeprefix(self._printed_before)

    def spins(self) -> bool:
        """Return whether its nodes take what comes: somebody spins them, and no callback keeps them from it."""
        self._spins = self.domain.all_answer()
        return self._spins

    def period(self, log: TopicLog, expected: float) -> float | None:
        """Measure the time between messages, in s; None if fewer than two come.

        Raises:
            NotDrivenError: if the clock is simulated, and the messages do not follow it.
            CheckError: if the program ends.
        """
        if self._is_driven:
            period = self.domain.period(log, expected) if self.spins() else None
            self.expect_alive()
            if period is None:
                raise NotDrivenError
            return period
        # More of those that come often: a busy machine delays some.
        wanted = 3 if expected >= 1 else 30
        count, enough = -1, time.monotonic() + 2 * wanted * expected
        while count < log.count < (3 if time.monotonic() > enough else wanted):
            count = log.count
            self.domain.wait(lambda: log.count > count or self.ended(), SILENT_PERIODS * max(expected, 1.0))  # noqa: B023
        self.expect_alive()
        return period_of([sample.published for sample in log.samples()])

    def expect_period(self, log: TopicLog, expected: float, told: str, silent: str, wrong: str = "") -> None:
        """Check how often messages come.

        Args:
            log: of the topic.
            expected: in s.
            told: what is expected, in words.
            silent: the hint if none come.
            wrong: the hint if they come too often or too seldom; "" says what create_timer takes.

        Raises:
            NotDrivenError: if the clock is simulated, and the messages do not follow it.
            CheckError: if they come otherwise.
        """
        period = self.period(log, expected)
        if period is None:
            raise CheckError(told, f"{log.count or 'none'} of them", silent)
        times = [sample.published for sample in log.samples()]
        at_once = [later - earlier < expected / 20 for earlier, later in itertools.pairwise(times)]
        if not self._is_driven and sum(at_once) * 5 >= len(at_once) * 2 and not all(at_once):
            raise CheckError(
                told,
                "several at once",
                "one timer is enough, and one publish in the function that it calls.",
            )
        if distance(period, expected) != "right":
            raise CheckError(
                told,
                f"one every {period:.2g} s",
                wrong or f"the first argument of create_timer is the period in seconds, {expected:g} here.",
            )

    def wait_until(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Let time pass, really or on the simulated clock, until a condition holds; return whether it does."""
        if self._is_driven:
            begin = self.domain.simulated
            patience = self.domain.late
            for step in range(1, 11):
                if condition():
                    break
                if not self.domain.step_clock(begin + step * seconds / 10):
                    patience = self.domain.patience  # one that does not answer may be about to end
                    break
            return self.domain.wait(lambda: condition() or self.ended(), patience) and condition()
        patience = max(seconds, self.domain.patience)
        return self.domain.wait(lambda: condition() or self.ended(), patience) and condition()

    def deafness(self, *topics: str) -> tuple[str, str] | None:
        """Return why the program cannot know what was told to it on one of these topics, and what to do.

        Returns:
            None if nothing that can be seen keeps it from that.
        """
        subscribed = self.domain.subscribed()
        own = [topic for topic in topics if topic in subscribed]
        if not own:
            return (
                f"it subscribes to {', '.join(subscribed) or 'no topic'}",
                f"it learns of the state by a subscription to {topics[0]}: compare the name letter by letter.",
            )
        if STRING not in subscribed[own[0]]:
            return (
                f"it subscribes to {own[0]} [{', '.join(subscribed[own[0]])}]",
                "a subscription receives only messages of its own type, which is String here.",
            )
        if quality := self.said("incompatible QoS"):
            return quality, "a subscription must not ask for more than the publisher offers."
        # Both of its answers may be late on a busy machine: who is blamed is asked anew.
        if not (self.spins() or self.spins()):
            return (
                "the node takes no messages",
                "ROS calls one callback after the other: is there a loop or a sleep in one, or nothing that spins the node?",
            )
        return None

    def said(self, words: str) -> str:
        """Return the last line with these words that the program has printed, without its time; "" if there is none."""
        lines = [line for line in self.process.output.splitlines() if words in line]
        return re.sub(r"^.*?\]: ", "", lines[-1]) if lines else ""

    def expect_end(self, topic: str, ends: Callable[[], Mapping[str, object]]) -> None:
        """Wait until the program has what it should have on a topic.

        Args:
            topic: the topic.
            ends: returns the topics on which that is seen.

        Raises:
            LookupError: if it has not; the argument is the topics that were seen.
            CheckError: if it has ended.
        """
        seen: dict[str, object] = {}  # also what has gone, with a node that died meanwhile

        def is_over() -> bool:
            seen.update(ends())
            return topic in seen or self.ended() is not None

        self.domain.wait_for_start(
            lambda: is_over() or len(self.domain.nodes()) >= self._nodes, START_TIMEOUT
        )
        # Nodes that answer have been made as far as they will be; one may be slow, or never spin, or have another
        # one's name, which answers for it.
        if not is_over():
            names = self.domain.nodes()
            is_made = self.spins() and len(set(names)) == len(names)
            self.domain.wait(is_over, self.domain.late if is_made else self.domain.patience)
        self.expect_alive()
        if topic not in seen:
            raise LookupError(sorted(seen))

    def _expect_typed_end(
        self, topic: str, type_name: str, verb: str, ends: Callable[[], dict[str, list[str]]]
    ) -> None:
        try:
            self.expect_end(topic, ends)
        except LookupError as error:
            [seen] = error.args
            raise CheckError(
                f"{self.process.executable} {verb} {topic}",
                f"it {verb} {', '.join(seen) or 'no topic'}",
                "compare the topic letter by letter, the slash at its beginning too."
                if seen
                else f"create_{'publisher' if verb == 'publishes' else 'subscription'}, a method of Node, does that.",
            ) from None
        types = ends().get(topic, [])
        if type_name not in types:
            raise CheckError(
                f"{topic} has the type {type_name}",
                ", ".join(types) or "none any more",
                "the type is the first argument, a class that is imported from a package ending in .msg.",
            )


class WatchedLaunch(WatchedProgram):
    """A launch file of the student's; a process that it has started and that ended counts as ended."""

    SETTING = "launched"

    def ended(self) -> Ended | None:
        """Return the first process that has ended, or the launch itself."""
        output = self.process.output
        for line in output.splitlines():
            if LAUNCH_FAILED.match(line):  # then it ends what it has started
                return Ended(self.process.executable, output)
            if end := LAUNCHED_END.match(line):
                lines = map(LAUNCHED_LINE.match, output.splitlines())
                own = [match["text"] for match in lines if match and match["process"] == end["process"]]
                return Ended(end["process"].rpartition("-")[0], "\n".join(own))
        return super().ended()


@contextlib.contextmanager
def running(
    workspace: Path, package: str, module: str, *parameters: str, is_driven: bool = False
) -> Iterator[WatchedProgram]:
    """Run the function `main` of a module in the student's sources, in a process and a domain of its own.

    Args:
        workspace: the student's.
        package: the name of the package, and of its folder.
        module: of that package.
        parameters: values for its node, such as `period:=1.0`.
        is_driven: whether it is given the simulated clock.
    """
    folder = workspace / "src" / package
    given = [*parameters, f"use_sim_time:={str(is_driven).lower()}"]
    words = [word for parameter in given for word in ("-p", parameter)]
    environ = environment.lab_environment()
    paths = [str(folder), *environ.get("PYTHONPATH", "").split(os.pathsep)]
    environ |= {"PYTHONPATH": os.pathsep.join(filter(None, paths)), "PYTHONDONTWRITEBYTECODE": "1"}
    code = f"from {package}.{module} import main; main()"
    with ObservedDomain() as domain:
        process = domain.start(module, [sys.executable, "-c", code, "--ros-args", *words], environ)
        yield WatchedProgram(domain, process, workspace, is_driven=is_driven)


@contextlib.contextmanager
def launched(workspace: Path, file: Path, overlay: Mapping[str, str], nodes: int) -> Iterator[WatchedLaunch]:
    """Run a launch file in a domain of its own.

    Args:
        workspace: the student's.
        file: the launch file.
        overlay: the environment in which the workspace is sourced.
        nodes: how many it starts.
    """
    with ObservedDomain() as domain:
        process = domain.start(file.name, ["ros2", "launch", str(file)], overlay)
        yield WatchedLaunch(domain, process, workspace, nodes=nodes)


def last_words(output: str) -> str:
    """Return what a program that has ended said last: its exception, or its last line."""
    reports = read_error(output).reports
    failure = _launch_error(output)
    said = reports[-1].line if reports and not failure else last_line(failure or output)
    return said.replace(str(course.work_folder()), "~")


def hint_for(output: str, workspace: Path) -> str:
    """Return what to do about a program that has ended, by what it has printed."""
    failure = _launch_error(output)
    if not failure and not read_error(output).reports:
        return SPIN_HINT
    finding = diagnose.of_text(failure or output, workspace)[0]
    if finding.code != UNKNOWN and finding.fix:
        place = f" ({finding.place})" if finding.place else ""
        return f"{finding.cause}{place} To fix it: {finding.fix}."
    if failure:
        return "the launch file itself fails: look at what it returns, and at the place that is named."
    return f"look at {finding.place or 'the lines above it'}, where the traceback ends in your code."


def _launch_error(output: str) -> str:
    """Return why a launch file fails itself; "" if it does not."""
    lines = output.splitlines()
    for number, line in enumerate(lines):
        if failed := LAUNCH_FAILED.match(line):
            # A file that is read in several ways has failed in each; the first one is Python's.
            reasons = [
                reason.removeprefix(" - ") for reason in lines[number + 1 :] if reason.startswith(" - ")
            ]
            return reasons[0] if reasons else line[failed.end() :]
    return ""


def message_numbers(message: Any) -> dict[str, float]:
    """Return the fields of a Twist that are not zero, such as `linear.x`."""
    fields = {
        f"{half}.{axis}": getattr(getattr(message, half), axis)
        for half in ("linear", "angular")
        for axis in "xyz"
    }
    return {name: value for name, value in fields.items() if value}
