"""`ros2lab demo`: the reference robot, built, driven and watched without a browser."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from ros2lab import course, environment
from ros2lab.node_process import last_line
from ros2lab.rhythm import period_of
from ros2lab.scratch import scratch_folder

# The doctor, which is a verb of the same command, must run where none of these can be imported.
if TYPE_CHECKING:
    from rich.console import Console

    from ros2lab.grading.evidence import Heard, Run
    from ros2lab.node_process import NodeProcess
    from ros2lab.observed_domain import ObservedDomain
    from ros2lab.rehearsal import Rehearsal
    from ros2lab.topics import Sample, TopicLog
    from ros2lab.workspace import Workspace

PICTURE = "demo_cmd_vel.png"

ENDING_TIMEOUT = 5.0  # s
FAREWELL_TIMEOUT = 1.0  # s, for what a node says as it ends


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
    """What was received on a topic; times in s, the rate in Hz."""

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
        topics: what was received; empty if no node was started.
        twists: all velocities; times count from the first one.
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
            scratch_folder() as scratch,
            Console(stderr=True).status("Copying the workspace ...") as status,
        ):
            workspace = Workspace(course.copy_reference(scratch))
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
        domain_id: the ROS domain; None takes one in which nobody else is.
        tell: takes a line of progress.
    """
    from ros2lab.observed_domain import ObservedDomain  # noqa: PLC0415
    from ros2lab.rehearsal import Rehearsal  # noqa: PLC0415

    tell("Building with colcon ...")
    result = workspace.build(show=False)
    executables = workspace.executables()
    names = ", ".join(executable.name for executable in executables) or "no executable"
    is_built = result.is_ok and bool(executables)
    built = Expectation("the workspace builds", is_built, result.first_error or names)
    if not is_built:
        return Demonstration((built,))
    tell(f"Starting {names} ...")
    commands = {
        executable.name: ["ros2", "run", executable.package, executable.name] for executable in executables
    }
    with ObservedDomain(domain_id) as domain:
        rehearsal = Rehearsal(domain, commands, workspace.overlay)
        rehearsal.play(tell=tell)
        run = rehearsal.record.run()
        endings = _end(domain, rehearsal, tell)
        return Demonstration(
            (built, *judge_parts(run), *judge_driving(run), *judge_lives(run), *endings),
            _topics(rehearsal),
            _twists(rehearsal),
        )


def show(demonstration: Demonstration, console: Console) -> None:
    """Print what was expected and what was received."""
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
    for expectation in demonstration.expectations:
        mark = Text(ticks[0], "green") if expectation.is_met else Text(ticks[1], "bold red")
        grid.add_row(mark, Text(expectation.text), Text(expectation.seen))
    console.print(grid)


def draw(twists: Sequence[Twist], path: Path) -> Path:
    """Draw velocities against time into a PNG; return its path."""
    from ros2lab.widgets.twist_plot import twist_figure  # noqa: PLC0415

    seconds, linear, angular = (
        (list(column) for column in zip(*twists, strict=True)) if twists else ([], [], [])
    )
    twist_figure(seconds, linear, angular).savefig(path, dpi=150)
    return path


def judge_parts(run: Run) -> list[Expectation]:
    """Judge each part of the assignment as the grader does."""
    from ros2lab.judge import case_of, judged  # noqa: PLC0415

    case = case_of([run])
    return [
        Expectation(f"{name}: {judgement.title}", judgement.points == judgement.max, judgement.reason)
        for name in case.assignment.parts
        for judgement in judged(case, name)
    ]


def judge_driving(run: Run) -> Iterator[Expectation]:
    """Judge whether the robot does what the assignment says of each command, every time, and nothing at nonsense."""
    from ros2lab import assignments  # noqa: PLC0415
    from ros2lab.rehearsal import moved_parts  # noqa: PLC0415

    assignment = assignments.load()
    (topic,) = (part.topic for part in moved_parts(assignment))
    part = assignment.commanded
    effects = dict(zip(part.commands, part.effects, strict=True)) if part else {}
    moves = _moves(run.quiet.get(topic))
    yield Expectation("before the first command the robot stands still", not any(moves), _motion(moves))
    should_move = False
    for command in run.commands:
        moves = _moves(command.topics.get(topic))
        if command.text in effects:
            has_changed = should_move is not (effects[command.text] == "moving")
            should_move = effects[command.text] == "moving"
            text = (
                f"{command.text}: the robot {'moves' if should_move else 'comes to a stand, and stays there'}"
            )
            yield Expectation(text, is_obeyed(moves, should_move, must_publish=has_changed), _motion(moves))
        else:
            text = f"{command.text!r} while it {'moves' if should_move else 'stands'}: it goes on so"
            # Who publishes only changes, and publishes nothing, has changed nothing.
            yield Expectation(text, not moves or any(moves[-3:]) is should_move, _motion(moves))


def is_obeyed(moves: Sequence[bool], should_move: bool, *, must_publish: bool) -> bool:
    """Return whether velocities show what a command asks for.

    Args:
        moves: whether the robot moves by each velocity that came after the command.
        should_move: what is asked for.
        must_publish: whether it was otherwise before, so that something has to come, after what was under way.
    """
    if not must_publish and not moves:
        return True
    if should_move:
        return any(moves)
    return False in moves and not any(moves[moves.index(False) :])


def judge_lives(run: Run) -> Iterator[Expectation]:
    """Judge whether every program runs until it is stopped."""
    deaths = [f"{name} ended by itself: {last_line(said)}" for name, said in run.ended.items()]
    yield Expectation("every node runs until Ctrl-C", not deaths, "; ".join(deaths) or "they all did")


def _moves(heard: Heard | None) -> list[bool]:
    from ros2lab.grading.senses import is_still  # noqa: PLC0415

    return [not is_still(value) for value in heard.values] if heard else []


def _motion(moves: Sequence[bool]) -> str:
    if not moves:
        return "nothing came"
    return f"{len(moves)} velocities came, {sum(moves) or 'none'} of them not zero"


def _end(domain: ObservedDomain, rehearsal: Rehearsal, tell: Callable[[str], None]) -> Iterator[Expectation]:
    """Press Ctrl-C for each node, the last one first: it is seen to stop by itself."""
    from rclpy.qos import ReliabilityPolicy  # noqa: PLC0415

    tell("Ending the nodes ...")
    log = _velocities(rehearsal)
    infos = domain.node.get_publishers_info_by_topic(log.topic) if log else []
    offers = [info.qos_profile for info in infos]
    is_reliable = bool(offers) and all(offer.reliability == ReliabilityPolicy.RELIABLE for offer in offers)
    endings = []
    for process in reversed(rehearsal.programs.values()):
        was_running, pressed = process.is_running, time.monotonic()
        code = process.stop(ENDING_TIMEOUT)
        seconds = time.monotonic() - pressed
        is_met = was_running and code == 0 and seconds < ENDING_TIMEOUT
        seen = f"it did, after {seconds:.1f} s" if is_met else _ending(process, was_running, seconds)
        endings.append(Expectation(f"{process.executable} ends with code 0 on Ctrl-C", is_met, seen))
    yield from endings[::-1]
    if is_reliable and log:  # of one that is not, the last message may be lost through no fault of its own
        domain.wait(lambda: log.latest and not _twist(log.latest).is_moving, FAREWELL_TIMEOUT)
        last = _twist(log.latest) if log.latest else None
        yield Expectation(
            "the last velocity before the end is zero", not (last and last.is_moving), str(last)
        )


def _ending(process: NodeProcess, was_running: bool, seconds: float) -> str:
    when = f"after {seconds:.1f} s" if was_running else "by itself"
    said = last_line(process.output)
    return f"it ended {when} with code {process.returncode}{said and ': '}{said}"


def _topics(rehearsal: Rehearsal) -> tuple[TopicRow, ...]:
    """Return what was received, or said, on the topic of each part."""
    rows = []
    for part in rehearsal.assignment.parts.values():
        log = rehearsal.record.logs.get(part.topic)
        if log:
            times = [sample.published for sample in log.samples()]
            period, gaps = period_of(times), [later - earlier for earlier, later in itertools.pairwise(times)]
            rate, last = 1.0 / period if period else None, log.latest
            last_value = _brief(last.message if last else None)
            rows.append(
                TopicRow(part.topic, log.type_name, log.count, rate, max(gaps, default=None), last_value)
            )
        elif not part.is_publisher:
            said = [command.text for command in rehearsal.record.run().commands]
            rows.append(TopicRow(part.topic, part.type_name, len(said), None, None, repr(said[-1])))
    return tuple(rows)


def _twists(rehearsal: Rehearsal) -> tuple[Twist, ...]:
    """Return all velocities, timed from the first one."""
    log = _velocities(rehearsal)
    twists = [*map(_twist, log.samples())] if log else []
    return tuple(twist._replace(time=twist.time - twists[0].time) for twist in twists)


def _velocities(rehearsal: Rehearsal) -> TopicLog | None:
    """Return what came on the topic of the velocities; None if nothing of the right type is published there."""
    from ros2lab.rehearsal import moved_parts  # noqa: PLC0415

    (part,) = moved_parts(rehearsal.assignment)
    log = rehearsal.record.logs.get(part.topic)
    return log if log and log.type_name == part.type_name else None


def _twist(sample: Sample) -> Twist:
    return Twist(sample.time, sample.message.linear.x, sample.message.angular.z)


def _brief(message: Any) -> str:
    if message is None:
        return "-"
    if hasattr(message, "linear"):
        return str(Twist(0.0, message.linear.x, message.angular.z))
    text = str(getattr(message, "data", message))
    return repr(text if len(text) <= 60 else f"{text[:59]}…")


def _quantity(value: float | None, unit: str) -> str:
    return "-" if value is None else f"{value:.2f} {unit}"
