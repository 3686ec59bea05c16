"""The nodes' log lines, live."""

from __future__ import annotations

import html
import math
import threading
import time
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import ipywidgets
import traitlets
from matplotlib.figure import Figure
from rcl_interfaces.msg import Log
from rclpy.qos import DurabilityPolicy, QoSProfile

from ros2lab.executor import NodeError
from ros2lab.session import LabSession
from ros2lab.widgets.redraw import redraw_of
from ros2lab.widgets.stored_view import StoredView, check_session, style, text_figure
from ros2lab.widgets.watched import Lookout

LEVELS = {"DEBUG": 10, "INFO": 20, "WARN": 30, "ERROR": 40, "FATAL": 50}
TOPIC = "/rosout"
QOS = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # reliable, as /rosout is
RATE = 5.0  # Hz
LONGEST_MESSAGE = 2000  # letters
LINES_IN_PICTURE = 20
PICTURE_WIDTH = 110  # letters
NOTHING = "Nothing of this level was logged yet."


@dataclass(frozen=True)
class LogLine:
    """One line of a node's log.

    Attributes:
        time: when it was written, in s of the wall clock.
        level: 10 (DEBUG) to 50 (FATAL).
        node: who wrote it.
        message: what.
        detail: further lines, such as a traceback.
    """

    time: float
    level: int
    node: str
    message: str
    detail: str = ""

    @property
    def level_name(self) -> str:
        """The level in a word."""
        return next((name for name, number in LEVELS.items() if number >= self.level), "FATAL")


class NodeLog(StoredView, ipywidgets.VBox):
    """Shows what the nodes log to `/rosout`, and what their callbacks raise, the newest last.

    What nodes logged shortly before is shown, too. Times count from the first line.

    Args:
        session: where is listened; closing it closes the log.
        level: the least level that is shown: DEBUG, INFO, WARN, ERROR or FATAL.
        capacity: how many lines are kept.

    Attributes:
        level: as above.

    Raises:
        TypeError: if an argument is of another kind.
        ValueError: if there is no such level, or the capacity is less than 1.
        RuntimeError: if the session is closed.
    """

    level = traitlets.Enum(list(LEVELS), "INFO")

    def __init__(self, session: LabSession, *, level: str = "INFO", capacity: int = 1000) -> None:
        check_session(session, "NodeLog")
        if level not in LEVELS:
            raise ValueError(f"The level must be one of {', '.join(LEVELS)}, not {level!r}.")
        if isinstance(capacity, bool) or not isinstance(capacity, int):
            raise TypeError(f"The capacity is a whole number of lines, not {capacity!r}.")
        if capacity < 1:
            raise ValueError(f"The capacity must be at least 1 line, not {capacity}.")
        self._redraw = redraw_of(session)
        self._lock = threading.Lock()
        self._logged: deque[LogLine] = deque(maxlen=capacity)
        # By node and traceback: a timer that raises does so ten times a second.
        self._raised: dict[tuple[str, str], LogLine] = {}
        self._errors: list[NodeError] = []
        self._begin = math.inf  # s of the wall clock
        self._is_changed = True
        self._wall_clock = time.time() - time.monotonic()
        self._build(level)
        self._subscription = session.node.create_subscription(Log, TOPIC, self._store, QOS)
        self._open_in(session, TOPIC)
        self._draw()
        self._redraw.add(self._draw, RATE, while_=self._lookout.is_watched)

    @property
    def lines(self) -> list[LogLine]:
        """The lines of at least the level, oldest first."""
        least = LEVELS[self.level]
        return [line for line in self._all_lines() if line.level >= least]

    def still(self) -> Figure:
        """Draw the newest lines with matplotlib."""
        rows = [_as_text(line, self._begin) for line in self.lines[-LINES_IN_PICTURE:]]
        return text_figure(f"Log {TOPIC} from {self.level} on", rows or [NOTHING])

    @property
    def description(self) -> str:
        """What is to be seen now, in words."""
        lines = self.lines
        newest = (
            f" The newest, {lines[-1].level_name} of {lines[-1].node}: {lines[-1].message}" if lines else ""
        )
        return f"Log of the nodes from level {self.level} on, {len(lines)} lines.{newest}"

    def _build(self, level: str) -> None:
        levels = ipywidgets.Dropdown(options=list(LEVELS), value=level, description="from level")
        traitlets.link((levels, "value"), (self, "level"))
        self._table = ipywidgets.HTML()
        scroller = ipywidgets.Box([self._table], tabbable=True)
        scroller.add_class("ros2lab-scroller")
        title = ipywidgets.HTML(f'<span class="ros2lab-title">Log</span> <code>{TOPIC}</code>')
        head = ipywidgets.HBox([title, levels])
        head.add_class("ros2lab-head")
        self._lookout = Lookout()
        super().__init__([head, scroller, style(), self._lookout])
        self.add_class("ros2lab-card")
        self.add_class("ros2lab-node-log")

    def _store(self, message: Any, info: dict[str, int]) -> None:
        # The stamp in the message may be simulated time.
        written = info["source_timestamp"] * 1e-9
        line = LogLine(written, message.level, message.name, message.msg[:LONGEST_MESSAGE])
        with self._lock:
            self._begin = min(self._begin, written)
            self._logged.append(line)
            self._is_changed = True

    def _all_lines(self) -> list[LogLine]:
        self._look_for_errors()
        with self._lock:
            lines = [*self._logged, *self._raised.values()]
        return sorted(lines, key=lambda line: line.time)

    @traitlets.observe("level")
    def _on_level(self, _: object) -> None:
        self._is_changed = True

    def _draw(self) -> None:
        self._look_for_errors()  # which may change it
        if self._is_changed:
            self._is_changed = False
            self._table.value = _as_table(self.lines, self._begin)

    def _look_for_errors(self) -> None:
        errors = [*self.session.errors, *self._redraw.errors]
        if errors == self._errors:
            return
        self._errors = errors
        with self._lock:
            self._begin = min(self._begin, *(error.time + self._wall_clock for error in errors))
            self._raised = {
                (error.node_name, error.traceback): LogLine(
                    error.time + self._wall_clock,
                    LEVELS["ERROR"],
                    error.node_name,
                    error.headline,
                    error.traceback,
                )
                for error in errors
            }
            self._is_changed = True

    def _stop(self) -> None:
        self._redraw.remove(self._draw)
        self.session.node.destroy_subscription(self._subscription)

    def __repr__(self) -> str:
        return "NodeLog()"


def _as_table(lines: Iterable[LogLine], begin: float) -> str:
    rows = "".join(_as_row(line, begin) for line in lines)
    if not rows:
        return f'<div class="ros2lab-note">{NOTHING}</div>'
    return (
        '<table class="ros2lab-log" aria-label="Log lines, the newest last"><thead><tr><th scope="col">time (s)</th>'
        '<th scope="col">level</th><th scope="col">node</th><th scope="col">message</th></tr></thead>'
        f"<tbody>{rows}</tbody></table>"
    )


def _as_row(line: LogLine, begin: float) -> str:
    detail = f"<pre>{html.escape(line.detail)}</pre>" if line.detail else ""
    return (
        f'<tr class="ros2lab-{line.level_name.lower()}"><td>{line.time - begin:.3f}</td>'
        f"<td>{line.level_name}</td><td>{html.escape(line.node)}</td>"
        f"<td>{html.escape(line.message)}{detail}</td></tr>"
    )


def _as_text(line: LogLine, begin: float) -> str:
    message = " ".join(line.message.split())
    text = f"{line.time - begin:9.3f}  {line.level_name:<5}  {line.node}  {message}"
    return text if len(text) <= PICTURE_WIDTH else f"{text[: PICTURE_WIDTH - 1]}…"
