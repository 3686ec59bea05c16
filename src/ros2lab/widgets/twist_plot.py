"""A live plot of what drives the robot, drawn in the browser, and its still picture."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import traitlets
from geometry_msgs.msg import Twist
from matplotlib.figure import Figure

from ros2lab.recording import Recording
from ros2lab.session import LabSession
from ros2lab.topics import Sample
from ros2lab.widgets.source import source_of
from ros2lab.widgets.stored_view import PausingView, check_number, style_sheet
from ros2lab.widgets.watched import Watched, script

SHORTEST_WINDOW = 1.0  # s
LONGEST_WINDOW = 120.0  # s; so much is kept in the browser
FASTEST = 50.0  # Hz
MOST_RECORDED = 10_000  # samples of a recording, in the browser; of more they are taken evenly
# Okabe and Ito's blue and vermillion, which colour-blind people tell apart; and the dashes differ, too.
LINEAR_LINE: dict[str, Any] = {"color": "#0072B2", "linestyle": "-", "linewidth": 1.8}
ANGULAR_LINE: dict[str, Any] = {"color": "#D55E00", "linestyle": (0, (4, 1.5)), "linewidth": 1.8}


class TwistPlot(PausingView, Watched):
    """Shows linear x (m/s) and angular z (rad/s) of a `geometry_msgs/Twist` topic against time (s), live.

    Time counts from the making of the plot. Showing it in a cell stores a picture in the notebook, too.
    Of a recording, all of its time is shown, and a slider and a button move a line along it, in the browser alone.

    Args:
        source: the session where the topic is listened to, which closes the plot as it closes; or a recording,
            as `read_recording` returns it.
        topic: the topic's name.
        window: how much time is shown live, 1 to 120 s.
        rate: how often new samples are drawn live, above 0 to 50 Hz.

    Attributes:
        window: as above; a value outside is moved to the nearest that is allowed.
        paused: whether the plot stands still; the samples go on being stored.
        topic_log: what was received, with its statistics.

    Raises:
        TypeError: if an argument is of another kind.
        ValueError: if a number is out of its range, the topic's name is none, or the recording holds no Twist
            there.
        RuntimeError: if the session is closed.
    """

    _esm = script("timeline", "twist_plot")
    _css = style_sheet()

    topic = traitlets.Unicode("/cmd_vel", read_only=True).tag(sync=True)
    window = traitlets.Float(10.0).tag(sync=True)
    window_range = traitlets.List([SHORTEST_WINDOW, LONGEST_WINDOW], read_only=True).tag(sync=True)
    rate = traitlets.Float(10.0, read_only=True).tag(sync=True)
    # Of a recording: its name, its time in s, and rows of float32: s, m/s, rad/s.
    recording = traitlets.Unicode(read_only=True).tag(sync=True)
    span = traitlets.Float(None, allow_none=True, read_only=True).tag(sync=True)
    recorded = traitlets.Bytes(read_only=True).tag(sync=True)

    def __init__(
        self,
        source: LabSession | Recording,
        *,
        topic: str = "/cmd_vel",
        window: float = 10.0,
        rate: float = 10.0,
    ) -> None:
        self._source = source_of(source, "TwistPlot")
        topic = self._source.topic(topic)
        window = check_number("The window", window, SHORTEST_WINDOW, LONGEST_WINDOW, "s")
        rate = check_number("The rate", rate, 0.1, FASTEST, "Hz")
        self._redraw = self._source.redraw
        self.topic_log = self._source.log(topic, Twist)
        self._epoch = self._source.began
        self._sending = threading.Lock()
        self._sent_until = self._epoch
        self.set_trait("topic", topic)
        self.set_trait("rate", rate)
        self.set_trait("recording", self._source.name)
        self.set_trait("span", self._source.span)
        if self._source.span is not None:
            self.set_trait("recorded", self._recorded())
        super().__init__(window=window)
        self.on_msg(self._on_message)
        self._open_in(self._source.home, topic)
        self._redraw.add(self._send_new, rate, while_=self.is_watched)

    def still(self) -> Figure:
        """Draw all samples of the log with matplotlib."""
        return twist_figure(*_rows(self.topic_log.samples(), self._epoch).T, topic=self.topic)

    @property
    def description(self) -> str:
        """What is to be seen now, in words."""
        latest = self.topic_log.latest
        if latest is None:
            return f"Plot of {self.topic}: no message yet."
        linear, angular = latest.message.linear.x + 0.0, latest.message.angular.z + 0.0  # no "-0.00"
        return (
            f"Plot of {self.topic} against time, {self.topic_log.count} messages; "
            f"the last: linear x {linear:.2f} m/s, angular z {angular:.2f} rad/s."
        )

    @traitlets.validate("window")
    def _clamp_window(self, proposal: dict[str, Any]) -> float:
        return float(np.clip(proposal["value"], SHORTEST_WINDOW, LONGEST_WINDOW))

    def _on_message(self, _: object, content: Any, __: object) -> None:
        if content == {"ask": "samples"}:
            with self._sending:
                self._send_since(self._source.now() - LONGEST_WINDOW, is_whole=True)

    def _recorded(self) -> bytes:
        rows = _rows(self.topic_log.samples(), self._epoch)
        with np.errstate(over="ignore"):  # what is too large for float32 becomes infinite
            return rows[:: -(-len(rows) // MOST_RECORDED)].astype("<f4").tobytes()

    def _send_new(self) -> None:
        with self._sending:
            latest = self.topic_log.latest
            if latest is not None and latest.time > self._sent_until and not self.paused:
                self._send_since(self._sent_until)

    def _send_since(self, begin: float, *, is_whole: bool = False) -> None:
        samples = self.topic_log.samples(since=begin)
        if samples:
            self._sent_until = samples[-1].time
        message = {"is_whole": is_whole, "now": self._source.now() - self._epoch, "kept": LONGEST_WINDOW}
        self.send(message, buffers=[_rows(samples, self._epoch).tobytes()])

    def _on_watched(self) -> None:
        self._redraw.hurry(self._send_new)

    def _stop(self) -> None:
        self._redraw.remove(self._send_new)
        self.topic_log.close()

    def __repr__(self) -> str:
        return f"TwistPlot({self.topic})"


def twist_figure(
    seconds: npt.ArrayLike, linear: npt.ArrayLike, angular: npt.ArrayLike, *, topic: str = "/cmd_vel"
) -> Figure:
    """Draw linear and angular velocity against time, one above the other.

    A command holds until the next one, so the lines are steps; they are broken where nothing came.

    Args:
        seconds: times in s, shape (n,), ascending; n may be 0.
        linear: linear x in m/s, shape (n,).
        angular: angular z in rad/s, shape (n,).
        topic: named in the title.

    Raises:
        ValueError: if the three differ in shape.
    """
    columns = [np.asarray(column, dtype=float) for column in (seconds, linear, angular)]
    if len({column.shape for column in columns}) != 1 or columns[0].ndim != 1:
        raise ValueError(
            f"Times, linear and angular velocities must be three arrays of one length, not of the shapes "
            f"{', '.join(str(column.shape) for column in columns)}."
        )
    times, *velocities = _broken_at_gaps(columns)
    figure = Figure(figsize=(7.2, 3.3))
    figure.subplots_adjust(left=0.11, right=0.98, bottom=0.14, top=0.91)
    names = ("linear x (m/s)", "angular z (rad/s)")
    for axes, velocity, name, line in zip(
        figure.subplots(2, sharex=True), velocities, names, (LINEAR_LINE, ANGULAR_LINE), strict=True
    ):
        axes.step(times, velocity, where="post", **line)
        axes.set_ylabel(name)
        axes.grid(color="0.88")
        axes.spines[["top", "right"]].set_visible(False)
        axes.margins(x=0.01, y=0.1)
        if not np.any(velocity[np.isfinite(velocity)]):
            axes.set_ylim(-1, 1)
    figure.align_ylabels()
    axes.set_xlabel("time (s)")
    title = topic if len(columns[0]) else f"{topic}: no message yet"
    figure.axes[0].set_title(title, family="monospace", size="medium", parse_math=False)
    return figure


def _rows(samples: Sequence[Sample], epoch: float) -> npt.NDArray[np.float64]:
    """Return an array of shape (n, 3): time since `epoch` (s), linear x (m/s), angular z (rad/s)."""
    rows = [(time - epoch, message.linear.x, message.angular.z) for time, message, _ in samples]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)


def _broken_at_gaps(columns: list[npt.NDArray[np.float64]]) -> list[npt.NDArray[np.float64]]:
    """Put a NaN after each sample that is followed by a long silence; `twist_plot.js` draws it likewise."""
    gaps = np.diff(columns[0])
    longest = max(1.0, 4 * np.median(gaps)) if len(gaps) else 1.0
    at = np.flatnonzero(gaps > longest) + 1
    return [
        np.insert(columns[0], at, columns[0][at - 1]),
        *(np.insert(column, at, np.nan) for column in columns[1:]),
    ]
