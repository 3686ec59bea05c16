"""`ros2lab demo`: the reference robot, built, driven and watched without a browser."""

from __future__ import annotations

import functools
import itertools
import statistics
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from ros2lab import course, environment
from ros2lab.rhythm import has_period

# The doctor, which is a verb of the same command, must run where none of these can be imported.
if TYPE_CHECKING:
    from rich.console import Console

    from ros2lab.assignments import Part
    from ros2lab.node_process import NodeProcess
    from ros2lab.session import LabSession
    from ros2lab.topics import TopicLog
    from ros2lab.workspace import Workspace

PICTURE = "demo_cmd_vel.png"

# Messages late by up to 0.3 s do not change the verdict (test_demo_verdicts.py).
UNCLEAR = 0.2  # s, by which gaps scatter on a machine that is too busy to tell
FEWEST_GAPS, MOST_GAPS = 4, 12

START_TIMEOUT = 20.0  # s, for processes to start and to find each other
REACTION_TIMEOUT = 10.0  # s
ENDING_TIMEOUT = 5.0  # s
POLL_PERIOD = 0.02  # s, for facts about the graph, of which rclpy sends no event
SILENCE_TIMEOUT = 10.0  # s, after which a status is not expected any more
FURTHER_TWISTS = 5  # after a reaction, to see that it lasts
FURTHER_TIMEOUT = 2.0  # s; velocities may also be published only when they change

NONSENSE = ("dance", "", "x" * 10_000)
_NO_WORDS = "an unknown, an empty and a very long word change nothing"


@functools.cache
def _part(name: str) -> Part:
    from ros2lab import assignments  # noqa: PLC0415 -- as above

    return assignments.load().parts[name]


def _status_part() -> Part:
    return _part("status_publisher")


def _command_part() -> Part:
    return _part("command_subscriber")


def _velocity_part() -> Part:
    return _part("velocity_publisher")


class Twist(NamedTuple):
    """A velocity and when it came (s): `linear` along x in m/s, `angular` about z in rad/s."""

    time: float
    linear: float
    angular: float

    @property
    def is_moving(self) -> bool:
        """Whether the robot would move."""
        return self.linear != 0.0 or self.angular != 0.0

    def __str__(self) -> str:
        return f"{self.linear + 0.0:.2f} m/s, {self.angular + 0.0:.2f} rad/s"


@dataclass(frozen=True)
class Step:
    """What was sent, and what came of it.

    Attributes:
        began: when it was sent, in s.
        twists: the velocities that came from then on, until the reaction was seen and had lasted.
        deaths: what is known of each process that ended by itself meanwhile.
    """

    began: float
    twists: tuple[Twist, ...]
    deaths: tuple[str, ...] = ()


@dataclass(frozen=True)
class Expectation:
    """Something that the assignment asks for.

    Attributes:
        text: what should happen.
        is_met: whether it did.
        seen: what was seen.
    """

    text: str
    is_met: bool
    seen: str


@dataclass(frozen=True)
class TopicRow:
    """What was heard on a topic; times in s, the rate in Hz."""

    topic: str
    type_name: str
    messages: int
    rate: float | None
    largest_gap: float | None
    last: str


@dataclass(frozen=True)
class Demonstration:
    """What a run has shown.

    Attributes:
        expectations: what should have happened, in the order of the run.
        topics: what was heard; empty if no node was started.
        twists: all velocities; times count from the start of the nodes.
    """

    expectations: tuple[Expectation, ...]
    topics: tuple[TopicRow, ...] = ()
    twists: tuple[Twist, ...] = ()

    @property
    def is_ok(self) -> bool:
        """Whether everything happened."""
        return all(expectation.is_met for expectation in self.expectations)


def demo(
    output: Annotated[
        Path | None, typer.Option(help="Where the picture goes; without it, into the student's folder.")
    ] = None,
) -> None:
    """Build the reference robot, drive it, and show what it published."""
    from rich.console import Console  # noqa: PLC0415 -- the other verbs print no colours

    folder = course.work_folder() if output is None else output
    try:
        environment.enter_ros()
        from ros2lab.workspace import Workspace  # noqa: PLC0415

        folder.mkdir(parents=True, exist_ok=True)
        with (
            tempfile.TemporaryDirectory(prefix="ros2lab-demo-") as scratch,
            Console(stderr=True).status("Copying the workspace ...") as status,
        ):
            workspace = Workspace(course.copy_reference(Path(scratch)))
            demonstration = demonstrate(workspace, tell=status.update)
        picture = draw(demonstration.twists, folder / PICTURE)
    except KeyboardInterrupt:
        typer.echo("Interrupted; everything is stopped.", err=True)
        raise typer.Exit(130) from None
    except (ImportError, OSError, RuntimeError) as error:
        reason = str(error).partition("\n")[0]
        typer.echo(f"The demonstration cannot run: {reason}\n`ros2lab doctor` may tell more.", err=True)
        raise typer.Exit(1) from None
    show(demonstration, Console())
    typer.echo(f"\nThe velocity over time is drawn in {picture}")
    raise typer.Exit(0 if demonstration.is_ok else 1)


def demonstrate(
    workspace: Workspace, *, domain_id: int | None = None, tell: Callable[[str], None] = lambda _: None
) -> Demonstration:
    """Build a workspace, run all its executables, command the robot, and judge what it does.

    Args:
        workspace: holds the robot's package.
        domain_id: the ROS domain; None takes one in which no other program of this user is.
        tell: takes a line of progress.
    """
    from ros2lab.session import LabSession  # noqa: PLC0415

    tell("Building with colcon ...")
    result = workspace.build(show=False)
    executables = [(one.package, one.name) for one in workspace.executables()]
    names = ", ".join(name for _, name in executables) or "no executable"
    is_built = result.is_ok and bool(executables)
    built = Expectation("the workspace builds", is_built, result.first_error or names)
    if not is_built:
        return Demonstration((built,))
    domain = environment.own_domain(f"demo in {workspace.path}") if domain_id is None else domain_id
    with LabSession(domain_id=domain) as session:
        run = _Run(session, tell)
        run.start(executables, workspace)
        expectations = run.drive()
        return Demonstration((built, *expectations), run.topics(), run.twists())


def show(demonstration: Demonstration, console: Console) -> None:
    """Print what was expected and what was heard."""
    from rich.table import Table  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    if demonstration.topics:
        table = Table(highlight=False)
        for name in ("topic", "type", "messages", "rate", "largest gap", "last value"):
            # In a narrow terminal a type is folded, and nothing is cut off.
            table.add_column(name, no_wrap=name in ("topic", "rate"), overflow="fold")
        for row in demonstration.topics:
            rate, gap = _quantity(row.rate, "Hz"), _quantity(row.largest_gap, "s")
            table.add_row(row.topic, row.type_name, str(row.messages), rate, gap, Text(row.last))
        console.print(table)
    ticks = ("ok", "NOT") if console.options.ascii_only else ("✓", "✗")
    grid = Table.grid(padding=(0, 2))
    for one in demonstration.expectations:
        mark = Text(ticks[0], "green") if one.is_met else Text(ticks[1], "bold red")
        grid.add_row(mark, Text(one.text), Text(one.seen))
    console.print(grid)


def draw(twists: Sequence[Twist], path: Path) -> Path:
    """Draw velocities against time into a PNG; return its path."""
    from ros2lab.widgets.twist_plot import twist_figure  # noqa: PLC0415

    seconds, linear, angular = (
        (list(column) for column in zip(*twists, strict=True)) if twists else ([], [], [])
    )
    twist_figure(seconds, linear, angular).savefig(path, dpi=150)
    return path


class _Run:
    """The robot's processes, what they publish, and what is sent to them."""

    def __init__(self, session: LabSession, tell: Callable[[str], None]) -> None:
        from rclpy.qos import QoSProfile, ReliabilityPolicy  # noqa: PLC0415
        from std_msgs.msg import String  # noqa: PLC0415

        self._session = session
        self._tell = tell
        # Hears publishers of every quality of service; it loses at most what a node says as it ends.
        self._best_effort = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._status = session.log(_status_part().topic, String, qos=self._best_effort)
        self._commands = session.log(_command_part().topic, String, qos=self._best_effort)
        self._velocity: TopicLog
        self._processes: list[NodeProcess] = []
        self._deaths: dict[str, str] = {}
        self._began = time.monotonic()

    def start(self, executables: Sequence[tuple[str, str]], workspace: Workspace) -> None:
        """Start each of the (package, executable) pairs."""
        self._tell(f"Starting {', '.join(name for _, name in executables)} ...")
        for package, name in executables:
            self._processes.append(self._session.start_process(package, name, workspace=workspace))

    def drive(self) -> list[Expectation]:
        """Send the commands, end the nodes, and say what came of it."""
        found = [self._wait_for_status(), self._wait_for_listener()]
        is_reliable = self._listen_to_driver()
        standing = self._step([], _stands, timeout=0.0)
        started = self._step(["start"], _moves)
        undisturbed = self._step(NONSENSE)
        stopped = self._step(["stop"], _stands)
        still_stopped = self._step(NONSENSE)
        restarted = self._step(["start"], _moves)
        reset = self._step(["reset"], _stands)
        period = judge_period(self._status_gaps())
        self._step(["start"], _moves)
        deaths = list(self._deaths.values())
        endings, farewell = self._end()
        return [
            *found,
            judge_standing("before the first command the robot stands still", standing, must_publish=False),
            judge_moving("start: the robot moves", started),
            judge_nonsense(f"while it moves, {_NO_WORDS}", undisturbed, stopped, should_move=True),
            judge_standing("stop: the velocity is zero and stays zero", stopped),
            judge_nonsense(f"while it stands, {_NO_WORDS}", still_stopped, restarted, should_move=False),
            judge_moving("start again: it moves again", restarted),
            judge_standing("reset: the velocity is zero and stays zero", reset),
            period,
            Expectation("every node runs until Ctrl-C", not deaths, "; ".join(deaths) or "they all did"),
            *endings,
            # Of a publisher that is not reliable, the last message may be lost through no fault of its own.
            *([judge_standing("the last velocity before the end is zero", farewell)] if is_reliable else []),
        ]

    def topics(self) -> tuple[TopicRow, ...]:
        """Return what was heard on each topic."""
        return tuple(_row(log) for log in (self._status, self._commands, self._velocity))

    def twists(self) -> tuple[Twist, ...]:
        """Return all velocities, timed from the start of the nodes."""
        return tuple(twist._replace(time=twist.time - self._began) for twist in self._twists_since(0.0))

    def _wait_for_status(self) -> Expectation:
        text = f"{_part('status_publisher').topic} is published as a text"
        self._tell(f"Waiting for {_part('status_publisher').topic} ...")
        try:
            first = self._status.wait_for(1, START_TIMEOUT)[0]
        except TimeoutError as error:
            return Expectation(text, False, str(error))
        return Expectation(text, True, f"{first.message.data[:60]!r} after {first.time - self._began:.1f} s")

    def _wait_for_listener(self) -> Expectation:
        text = f"a node listens on {_part('command_subscriber').topic}"
        try:
            self._session.wait_for_subscribers(_command_part().topic, 1, START_TIMEOUT)
        except TimeoutError as error:
            return Expectation(text, False, str(error))
        return Expectation(text, True, "it does")

    def _listen_to_driver(self) -> bool:
        """Begin to log the velocity as its publisher offers it; return whether every message will come.

        A node may also make its publisher later: whether the robot drives is seen when it is told to.
        """
        from geometry_msgs.msg import Twist as TwistMessage  # noqa: PLC0415

        deadline = time.monotonic() + START_TIMEOUT
        while not self._session.node.count_publishers(_velocity_part().topic):
            if time.monotonic() > deadline:
                self._velocity = self._session.log(
                    _velocity_part().topic, TwistMessage, qos=self._best_effort
                )
                return False
            time.sleep(POLL_PERIOD)
        offers = [
            one.qos_profile for one in self._session.node.get_publishers_info_by_topic(_velocity_part().topic)
        ]
        self._velocity = self._session.log(_velocity_part().topic, TwistMessage)
        return all(offer.reliability != self._best_effort.reliability for offer in offers)

    def _step(
        self,
        words: Sequence[str],
        reaction: Callable[[Twist], bool] = lambda _: True,
        timeout: float = REACTION_TIMEOUT,
    ) -> Step:
        """Send words, wait for the first velocity that shows the reaction, and then for a few more."""
        if words:
            self._tell(f"Sending {', '.join(repr(word[:20]) for word in words)} ...")
        began = time.monotonic() if words else self._began
        for word in words:
            self._session.publish(_command_part().topic, word)
        self._wait_for_twist(began, reaction, timeout)
        _wait_for_more(self._velocity, FURTHER_TWISTS, FURTHER_TIMEOUT)
        return Step(began, tuple(self._twists_since(began)), tuple(self._new_deaths()))

    def _wait_for_twist(self, since: float, wanted: Callable[[Twist], bool], timeout: float) -> None:
        deadline = time.monotonic() + timeout
        while time.monotonic() < deadline:
            count = self._velocity.count
            if any(wanted(twist) for twist in self._twists_since(since)):
                return
            _wait_for_more(self._velocity, count + 1 - self._velocity.count, deadline - time.monotonic())

    def _status_gaps(self) -> list[float]:
        """Return the times between statuses while no command comes, until they tell enough."""
        newest = self._status.latest
        if newest is None:
            return []
        since, gaps = newest.time, list[float]()
        while len(gaps) < FEWEST_GAPS or (is_unclear(gaps) and len(gaps) < MOST_GAPS):
            self._tell(
                f"Measuring the period of {_part('status_publisher').topic} ({len(gaps)} of {FEWEST_GAPS}) ..."
            )
            count = len(gaps)
            _wait_for_more(self._status, 1, SILENCE_TIMEOUT)
            times = [since, *(sample.time for sample in self._status.samples(since))]
            gaps = [later - earlier for earlier, later in itertools.pairwise(times)]
            if len(gaps) == count:
                break
        return gaps

    def _end(self) -> tuple[list[Expectation], Step]:
        """Press Ctrl-C for each node, the last one first: it is seen to stop by itself."""
        self._tell("Ending the nodes ...")
        began = time.monotonic()
        endings = []
        for process in reversed(self._processes):
            was_running, pressed = process.is_running, time.monotonic()
            code = process.stop(ENDING_TIMEOUT)
            seconds = time.monotonic() - pressed
            is_met = was_running and code == 0 and seconds < ENDING_TIMEOUT
            seen = f"it did, after {seconds:.1f} s" if is_met else _ending(process, was_running, seconds)
            endings.append(Expectation(f"{process.executable} ends with code 0 on Ctrl-C", is_met, seen))
        self._wait_for_twist(began, _stands, FURTHER_TIMEOUT)
        twists = tuple(self._twists_since(began))
        return endings[::-1], Step(began, twists)

    def _new_deaths(self) -> list[str]:
        new = [one for one in self._processes if not one.is_running and one.executable not in self._deaths]
        self._deaths |= {process.executable: _death(process) for process in new}
        return [self._deaths[process.executable] for process in new]

    def _twists_since(self, time_: float) -> list[Twist]:
        return [
            Twist(sample.time, sample.message.linear.x, sample.message.angular.z)
            for sample in self._velocity.samples(time_)
        ]


def judge_moving(text: str, step: Step) -> Expectation:
    """Judge a command that sets the robot in motion."""
    first = next((twist for twist in step.twists if twist.is_moving), None)
    if first is None:
        return Expectation(text, False, _nothing(step, "but zero"))
    return Expectation(text, True, f"{first} after {first.time - step.began:.2f} s")


def judge_standing(text: str, step: Step, *, must_publish: bool = True) -> Expectation:
    """Judge that the robot comes to a stand, and that it stays.

    Args:
        text: what is expected.
        step: what was sent and what came.
        must_publish: whether it moved before, so that a zero has to come, after what was under way; if not,
            silence is right and any motion is wrong.
    """
    zeros = [number for number, twist in enumerate(step.twists) if not twist.is_moving]
    if must_publish and not zeros:
        return Expectation(text, False, _nothing(step, "of zero"))
    first = zeros[0] if must_publish else 0
    moving = next((twist for twist in step.twists[first:] if twist.is_moving), None)
    if moving:
        return Expectation(text, False, f"it moves: {moving}")
    if not must_publish:
        return Expectation(text, True, "it does")
    return Expectation(text, True, f"zero after {step.twists[first].time - step.began:.2f} s")


def judge_nonsense(text: str, step: Step, following: Step, *, should_move: bool) -> Expectation:
    """Judge that words which are no command changed nothing, and ended no node.

    Args:
        text: what is expected.
        step: what was sent and what came.
        following: the step after it, in which the end of a node may have been noticed.
        should_move: whether the robot moved before.
    """
    has_obeyed = any(twist.is_moving != should_move for twist in following.twists)
    deaths = [*step.deaths, *(following.deaths if not has_obeyed else ())]
    if deaths:
        return Expectation(text, False, "; ".join(deaths))
    newest = step.twists[-3:]
    # Who publishes only changes, and publishes nothing, has changed nothing.
    is_moving = any(twist.is_moving for twist in newest) if newest else should_move
    if is_moving != should_move:
        changed = "it stopped" if should_move else f"it moves: {newest[-1]}"
        return Expectation(text, False, "; ".join([changed, *following.deaths]))
    return Expectation(text, True, "it goes on" if should_move else "it stands")


def judge_period(gaps: Sequence[float]) -> Expectation:
    """Judge the status's period by the median of the gaps (s): one late message changes it little."""
    text = f"{_part('status_publisher').topic} comes every {_part('status_publisher').period:g} s"
    if len(gaps) < FEWEST_GAPS:
        return Expectation(text, False, "too few came to measure a period")
    is_met = _is_right_period(gaps)
    return Expectation(text, is_met, f"periods {', '.join(f'{gap:.2f}' for gap in gaps)} s")


def is_unclear(gaps: Sequence[float]) -> bool:
    """Return whether gaps (s) look wrong but scatter as on a machine that is too busy to tell."""
    return not _is_right_period(gaps) and max(gaps) - min(gaps) > UNCLEAR


def _is_right_period(gaps: Sequence[float]) -> bool:
    return has_period(statistics.median(gaps), _status_part().period)


def _moves(twist: Twist) -> bool:
    return twist.is_moving


def _stands(twist: Twist) -> bool:
    return not twist.is_moving


def _nothing(step: Step, what: str) -> str:
    came = (
        f"{len(step.twists)} came, none {what}"
        if step.twists
        else f"nothing came on {_part('velocity_publisher').topic}"
    )
    return "; ".join([came, *step.deaths])


def _said(process: NodeProcess) -> list[str]:
    """Return the lines that a node has printed, without those of `ros2 run`."""
    return [line for line in process.output.strip().splitlines() if not line.startswith("[ros2run]")]


def _death(process: NodeProcess) -> str:
    said = _said(process)
    last = f": {said[-1]}" if said else ""
    return f"{process.executable} ended by itself with code {process.returncode}{last}"


def _ending(process: NodeProcess, was_running: bool, seconds: float) -> str:
    if not was_running:
        return _death(process)
    said = _said(process)
    last = f": {said[-1]}" if said else ""
    return f"it ended with code {process.returncode} after {seconds:.1f} s{last}"


def _wait_for_more(log: TopicLog, n: int, timeout: float) -> None:
    """Wait until `n` more messages have come, or the time is up."""
    try:
        log.wait_for(log.count + n, max(0.0, timeout))
    except TimeoutError:
        return


def _row(log: TopicLog) -> TopicRow:
    now = log.statistics()
    return TopicRow(log.topic, log.type_name, now.count, now.rate, now.largest_gap, _brief(now.last))


def _brief(message: Any) -> str:
    if message is None:
        return "-"
    if hasattr(message, "data"):
        return repr(message.data if len(message.data) <= 60 else f"{message.data[:59]}…")
    return str(Twist(0.0, message.linear.x, message.angular.z))


def _quantity(value: float | None, unit: str) -> str:
    return "-" if value is None else f"{value:.2f} {unit}"
