"""A robot on a plane that drives as its velocity commands say, drawn in the browser, and its still picture."""

from __future__ import annotations

import itertools
import math
import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import traitlets
from geometry_msgs.msg import Twist
from matplotlib.figure import Figure
from nav_msgs.msg import Odometry

from ros2lab.motion import Command, DrivenPath, Pose, driven
from ros2lab.recording import Recording
from ros2lab.session import LabSession
from ros2lab.topics import Sample
from ros2lab.widgets.source import Log, Source, source_of
from ros2lab.widgets.stored_view import StoredView, check_number, style_sheet
from ros2lab.widgets.watched import Watched, script

RATE = 20.0  # Hz
SOON = 0.01  # s after a new command, when the robot has moved by what can be seen
HOLD = 1.0  # s, after which a robot stops that is not told to go on
ROBOT_RADIUS = 0.2  # m
MOST_ROBOTS = 4
LEAST_HALF = 2.0  # m, from the middle of the picture to its edge, at least
ODOMETRY_DEPTH = 10
MOST_MOMENTS = 4000  # of a recording, evenly over its time; and as many at which a command changes
# Okabe and Ito's blue, vermillion, bluish green and reddish purple; the dashes differ, too.
ROBOTS: tuple[dict[str, Any], ...] = (
    {"color": "#0072B2", "linestyle": "-"},
    {"color": "#D55E00", "linestyle": (0, (6, 2))},
    {"color": "#009E73", "linestyle": (0, (2, 2))},
    {"color": "#CC79A7", "linestyle": (0, (8, 2, 2, 2))},
)


class RobotView(StoredView, Watched):
    """Shows robots on two wheels on a plane; each drives as `geometry_msgs/Twist` commands say.

    Linear x drives forward and angular z turns left; wheels can do no more. A command holds until the next one,
    for a second at most. Where a robot is, it publishes as `nav_msgs/Odometry` on `odom`, beside its commands'
    topic. Showing the view in a cell stores a picture of the trails in the notebook, too.

    Of a recording, the view shows the whole way, and a slider and a button move the robot along it, in the browser
    alone: also in a saved notebook without its kernel.

    Args:
        source: the session where the commands are listened to, which closes the view as it closes; or a
            recording, as `read_recording` returns it.
        topic: the commands' topic, or one for each of up to four robots, such as
            `["/robin/cmd_vel", "/wren/cmd_vel"]`.
        start: where the robot begins, as (x in m, y in m, heading in rad); with several robots a list of them, or
            nothing, which puts them 1 m apart.

    Attributes:
        topic_logs: what was received, one log for each robot, with its statistics.

    Raises:
        TypeError: if an argument is of another kind.
        ValueError: if a number is out of its range, a topic's name is none, topics are doubled or too many, or
            the recording holds no commands there.
        RuntimeError: if the session is closed.
    """

    _esm = script("timeline", "robot_view")
    _css = style_sheet("robot_view")

    names = traitlets.List(traitlets.Unicode(), read_only=True).tag(sync=True)
    starts: traitlets.List[list[float]] = traitlets.List(read_only=True).tag(
        sync=True
    )  # x (m), y (m), heading (rad)
    topic = traitlets.Unicode(read_only=True).tag(sync=True)
    robot_radius = traitlets.Float(ROBOT_RADIUS, read_only=True).tag(sync=True)  # m
    # Of a recording: its name, its time in s, and for each robot rows of float32, as `_Robot.moments` makes them.
    recording = traitlets.Unicode(read_only=True).tag(sync=True)
    span = traitlets.Float(None, allow_none=True, read_only=True).tag(sync=True)
    moments: traitlets.List[bytes] = traitlets.List(traitlets.Bytes(), read_only=True).tag(sync=True)

    def __init__(
        self,
        source: LabSession | Recording,
        *,
        topic: str | Sequence[str] = "/cmd_vel",
        start: Sequence[float] | Sequence[Sequence[float]] | None = None,
    ) -> None:
        self._source = source_of(source, "RobotView")
        topics = _checked_topics(self._source, topic)
        starts = _checked_starts(start, len(topics))
        self._redraw = self._source.redraw
        self._lock = threading.Lock()
        self._robots = [
            _Robot(self._source, name, begin, self._hurry) for name, begin in zip(topics, starts, strict=True)
        ]
        self._sent: list[object] = []
        self.set_trait("topic", ", ".join(topics))
        self.set_trait("names", [robot.name for robot in self._robots])
        self.set_trait("starts", [list(begin) for begin in starts])
        self.set_trait("recording", self._source.name)
        self.set_trait("span", self._source.span)
        if self._source.span is not None:
            self.set_trait("moments", [robot.moments(self._source.span) for robot in self._robots])
        super().__init__()
        self.on_msg(self._on_message)
        self._open_in(self._source.home, self.topic)
        self._redraw.add(self._draw, RATE)

    @property
    def topic_logs(self) -> list[Log]:
        """What was received, one log for each robot."""
        return [robot.log for robot in self._robots]

    @property
    def poses(self) -> list[Pose]:
        """Where the robots are, in the order of their topics."""
        with self._lock:
            return [robot.path.pose for robot in self._robots]

    @property
    def pose(self) -> Pose:
        """Where the robot is; the first one, if there are several."""
        return self.poses[0]

    def reset(self) -> None:
        """Put the robots back to where they began, and forget their trails; those of a recording stay."""
        if self.span is not None:
            return
        with self._lock:
            for robot in self._robots:
                robot.begin_again()
            self._send_robots(is_whole=True)

    def still(self) -> Figure:
        """Draw the robots and their trails with matplotlib."""
        with self._lock:
            ways = [
                (robot.name, robot.path.start, [*robot.path.vertices, *robot.path.ahead], robot.path.pose)
                for robot in self._robots
            ]
        figure = Figure(figsize=(5.2, 4.8), layout="constrained")
        axes = figure.add_subplot(aspect="equal")
        for (name, start, vertices, pose), look in zip(ways, ROBOTS, strict=False):
            axes.plot(*np.array([*vertices, pose[:2]]).T, linewidth=1.8, label=name, zorder=3, **look)
            axes.plot(start.x, start.y, marker="+", markersize=9, color="0.4", zorder=2)
            arrow = (3, 0, math.degrees(pose.heading) - 90)
            axes.plot(*pose[:2], marker=arrow, markersize=13, color=look["color"], zorder=4)
        box = axes.dataLim
        half = max(LEAST_HALF, 0.6 * max(box.width, box.height))
        x, y = (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2
        axes.set(xlim=(x - half, x + half), ylim=(y - half, y + half))
        axes.set_xlabel("x (m)")
        axes.set_ylabel("y (m)")
        axes.grid(color="0.88")
        axes.set_axisbelow(True)
        axes.set_title(self.topic, family="monospace", size="medium", parse_math=False)
        if len(ways) > 1:
            axes.legend(loc="upper right")
        return figure

    @property
    def description(self) -> str:
        """What is to be seen now, in words."""
        return " ".join(
            f"Robot {robot.name} at {_in_words(pose)}, {_command_in_words(robot.path.command)}."
            for robot, pose in zip(self._robots, self.poses, strict=True)
        )

    def _on_message(self, _: object, content: Any, __: object) -> None:
        if content == {"ask": "trail"}:
            with self._lock:
                self._send_robots(is_whole=True)
        elif content == {"ask": "reset"}:
            self.reset()

    def _hurry(self) -> None:
        """Show soon what a new command does, and not when a turn comes."""
        self._redraw.hurry(self._draw, SOON)

    def _draw(self) -> None:
        with self._lock:
            now = self._source.now()
            for robot in self._robots:
                robot.drive(now)
            state = [robot.state for robot in self._robots]
            if state != self._sent and self.is_watched():
                self._send_robots()
        for robot in self._robots:
            robot.publish_odometry()

    def _send_robots(self, *, is_whole: bool = False) -> None:
        """Send where the robots are, and those vertices of their trails that the browser does not have."""
        self._sent = [robot.state for robot in self._robots]
        vertices = [robot.new_vertices(is_whole=is_whole) for robot in self._robots]
        ahead = [robot.path.ahead for robot in self._robots]
        message = {
            "is_whole": is_whole,
            "vertices": [len(some) for some in vertices],
            "ahead": [len(some) for some in ahead],
            "notes": [robot.note for robot in self._robots],
            "are_heard": [robot.is_heard for robot in self._robots],
        }
        states = [(*robot.path.pose, *robot.path.command[1:]) for robot in self._robots]
        parts = (states, *vertices, *ahead)
        numbers = np.concatenate([np.ravel(np.array(rows, dtype=np.float64)) for rows in parts])
        self.send(message, buffers=[numbers.tobytes()])

    def _on_watched(self) -> None:
        self._redraw.hurry(self._draw)

    def _stop(self) -> None:
        self._redraw.remove(self._draw)
        for robot in self._robots:
            robot.close()

    def __repr__(self) -> str:
        return f"RobotView({self.topic})"


class _Robot:
    """One robot: its commands, its way, and its odometry."""

    def __init__(self, source: Source, topic: str, start: Pose, on_change: Callable[[], None]) -> None:
        namespace = topic.rpartition("/")[0]
        self.name = namespace.strip("/") or "robot"
        self._on_change = on_change
        self._newest = 0.0, 0.0  # linear (m/s), angular (rad/s)
        self.log = source.log(topic, Twist, on_message=self._compare)
        self.note = ""
        self._source = source
        self._prefix = f"{namespace.strip('/')}/".lstrip("/")
        self._odometry = source.outlet(Odometry, f"{namespace}/odom", ODOMETRY_DEPTH)
        self._seen_until = source.began
        self._sent_vertices = 0
        self.path = DrivenPath(start, source.began, hold=HOLD)
        self.drive(source.now())

    @property
    def state(self) -> tuple[Any, ...]:
        """What is to be seen of it: the browser is told when it changes."""
        return self.path.pose, self.path.command[1:], self.note, self.is_heard

    @property
    def is_heard(self) -> bool:
        """Whether a command ever came."""
        return self.log.count > 0

    def _compare(self, twist: Twist) -> None:
        """Tell of a command that is another one than that before it."""
        before, self._newest = self._newest, (twist.linear.x, twist.angular.z)
        if self._newest != before:
            self._on_change()

    def drive(self, until: float) -> None:
        """Follow the commands that came since the last call, up to a time in s of the source."""
        latest = self.log.latest
        samples = (
            self.log.samples(since=self._seen_until) if latest and latest.time > self._seen_until else []
        )
        self.path.drive([_command(sample) for sample in samples], until)
        if samples:
            self._seen_until = samples[-1].time
            self.note = _note(samples[-1].message)

    def begin_again(self) -> None:
        """Go back to the start, without a trail; the last command holds on."""
        self.path = DrivenPath(self.path.start, self._source.now(), hold=HOLD, command=self.path.command)
        self._sent_vertices = 0

    def new_vertices(self, *, is_whole: bool) -> list[tuple[float, float]]:
        """Return the vertices that were not returned before, or all."""
        begin = 0 if is_whole else max(0, self._sent_vertices - self.path.dropped)
        self._sent_vertices = self.path.dropped + len(self.path.vertices)
        return self.path.vertices[begin:]

    def moments(self, span: float) -> bytes:
        """Return how it drives over the time of a recording, which is `span` s long.

        Between two moments it drives on as good as straight, so that the browser can take the middle.

        Returns:
            Rows of float32: time (s), x (m), y (m), heading (rad), linear (m/s), angular (rad/s).
        """
        commands = [_command(sample) for sample in self.log.samples()]
        moments = driven(self.path.start, commands, _moments(commands, span), hold=HOLD)
        rows = [(moment.time, *moment.pose, *moment.command[1:]) for moment in moments]
        with np.errstate(over="ignore"):  # what is too large for float32 becomes infinite
            return np.array(rows, dtype="<f4").tobytes()

    def publish_odometry(self) -> None:
        """Say where it is, if anybody listens."""
        if not self._odometry.is_wanted:
            return
        pose, command = self.path.pose, self.path.command
        message = Odometry()
        message.header.frame_id = f"{self._prefix}odom"
        message.child_frame_id = f"{self._prefix}base_link"
        message.pose.pose.position.x, message.pose.pose.position.y = pose.x, pose.y
        message.pose.pose.orientation.z = math.sin(pose.heading / 2)
        message.pose.pose.orientation.w = math.cos(pose.heading / 2)
        message.twist.twist.linear.x, message.twist.twist.angular.z = command.linear, command.angular
        self._odometry.publish(message)

    def close(self) -> None:
        """Give back the subscription and the publisher."""
        self.log.close()
        self._odometry.close()


def _command(sample: Sample) -> Command:
    return Command(sample.time, sample.message.linear.x, sample.message.angular.z)


def _moments(commands: Sequence[Command], span: float) -> list[float]:
    """Return when a robot is looked at that these commands drive: as often as a live one, and where they change."""
    changes = [later.time for earlier, later in itertools.pairwise(commands) if earlier[1:] != later[1:]]
    changes = changes[:: math.ceil(len(changes) / MOST_MOMENTS) or 1]
    even = np.linspace(0.0, span, min(math.ceil(span * RATE), MOST_MOMENTS) + 1)
    return sorted({*even.tolist(), *(command.time for command in commands[:1]), *changes})


def _checked_topics(source: Source, topic: str | Sequence[str]) -> list[str]:
    given = [topic] if isinstance(topic, str) or not isinstance(topic, Sequence) else [*topic]
    topics = [source.topic(name) for name in given]
    if not 1 <= len(topics) <= MOST_ROBOTS:
        raise ValueError(
            f"RobotView shows 1 to {MOST_ROBOTS} robots, each with a topic of its own, not {len(topics)}."
        )
    if len(set(topics)) != len(topics):
        raise ValueError(f"Each robot needs a topic of its own, and here are {', '.join(topics)}.")
    return topics


def _checked_starts(start: Any, robots: int) -> list[Pose]:
    if start is None:
        return [Pose(0.0, -1.0 * number, 0.0) for number in range(robots)]
    try:
        starts = [tuple(start)] if robots == 1 and not np.ndim(start[0]) else [tuple(pose) for pose in start]
    except (TypeError, IndexError, KeyError):
        starts = []
    if len(starts) != robots or any(len(pose) != 3 for pose in starts):
        raise TypeError(
            f"The start is (x, y, heading) in m, m and rad{', once for each robot' * (robots > 1)}, not {start!r}."
        )
    names = (("x", "m"), ("y", "m"), ("The heading", "rad"))
    return [
        Pose(
            *(
                check_number(name, value, -1000, 1000, unit)
                for value, (name, unit) in zip(pose, names, strict=True)
            )
        )
        for pose in starts
    ]


def _note(twist: Any) -> str:
    """Return what a robot on two wheels does not do of a command; nothing if it does all."""
    if not (math.isfinite(twist.linear.x) and math.isfinite(twist.angular.z)):
        return "The command is not a finite number, so it is left out."
    ignored = {
        "linear y": twist.linear.y,
        "linear z": twist.linear.z,
        "angular x": twist.angular.x,
        "angular y": twist.angular.y,
    }
    names = [name for name, value in ignored.items() if value]
    if not names:
        return ""
    return f"{' and '.join(names)}: a robot on two wheels cannot do that, and leaves it out."


def _in_words(pose: Pose) -> str:
    heading = (math.degrees(pose.heading) + 180) % 360 - 180
    return f"x {pose.x:.2f} m, y {pose.y:.2f} m, heading {heading:.0f}°"


def _command_in_words(command: Command) -> str:
    _, linear, angular = command
    if not (linear or angular):
        return "standing"
    text = f"driving at {linear:.2f} m/s"
    if angular:
        text += f", turning {'left' if angular > 0 else 'right'} at {abs(angular):.2f} rad/s"
    if linear and angular:
        text += f", on a circle of radius {abs(linear / angular):.2f} m"
    return text
