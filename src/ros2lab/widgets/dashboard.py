"""The robot, what drives it and what it says, in one view."""

from __future__ import annotations

import html
from collections.abc import Callable, Sequence
from pathlib import Path

import anywidget
import ipywidgets
import traitlets

from ros2lab.session import LabSession
from ros2lab.widget_state import ending_with_its_kernel
from ros2lab.widgets.command_panel import CommandPanel
from ros2lab.widgets.graph_view import GraphView
from ros2lab.widgets.node_log import NodeLog
from ros2lab.widgets.redraw import redraw_of
from ros2lab.widgets.robot_view import RobotView
from ros2lab.widgets.stored_view import StoredView, check_session, parts_of, style
from ros2lab.widgets.twist_plot import TwistPlot
from ros2lab.widgets.view_group import ViewGroup, check_views

GRAPH_RATE = 2.0  # Hz
# From the most important to the least, which is also the order of the keyboard and of a narrow page.
PLACES = {RobotView: "robot", CommandPanel: "panel", TwistPlot: "plot", GraphView: "graph", NodeLog: "log"}
MOST_NAMES = 6


class Dashboard(ViewGroup, ipywidgets.VBox):
    """Shows robot, command panel, velocities, graph and log in one view, which fits the width that it has.

    A line above them names the nodes that run, whoever started them. Closing the dashboard closes all of it.

    Args:
        session: where is listened and published; closing it closes the dashboard.
        views: other widgets of the session, the most important first; None makes the five above. Each
            replaces an open widget of the same kind and topic.

    Attributes:
        nodes: the full names of the nodes in the domain, sorted; without those with which the lab itself and the
            `ros2` command listen.
        views: the widgets, the most important first.

    Raises:
        TypeError: if the session is none, or one of the views is not a widget of the lab.
        ValueError: if there is no view, one is closed, or they are not of this session.
        RuntimeError: if the session is closed.
    """

    _picture_width = 11.5  # inch

    nodes = traitlets.Tuple()

    def __init__(self, session: LabSession, *, views: Sequence[StoredView] | None = None) -> None:
        check_session(session, "Dashboard")
        self._redraw = redraw_of(session)
        if views is None:
            chosen = tuple(make(session) for make in PLACES)
        else:
            chosen = check_views(views, "Dashboard")
            if chosen[0].home is not session:
                raise ValueError("Dashboard takes widgets of its own session.")
        self._note = ipywidgets.HTML()
        tiles = ipywidgets.Box(chosen)
        tiles.add_class("ros2lab-tiles")
        if views is None:
            tiles.add_class("ros2lab-five")
            for view, place in zip(chosen, PLACES.values(), strict=True):
                view.add_class(f"ros2lab-place-{place}")
        super().__init__(chosen, [self._note, tiles, style("dashboard"), _Arrival(self._send_state_again)])
        self.add_class("ros2lab-dashboard")
        self._show_note()
        self._look_around()
        self._redraw.add(self._look_around, GRAPH_RATE)

    @property
    def description(self) -> str:
        """What is to be seen now, in words."""
        return f"{self._sentence()} {super().description}"

    def _look_around(self) -> None:
        node = self.session.node
        own = node.get_name(), node.get_namespace()
        names = {found for found in node.get_node_names_and_namespaces() if found != own}
        shown = {f"{namespace.rstrip('/')}/{name}" for name, namespace in names if not name.startswith("_")}
        self.nodes = tuple(sorted(shown))

    def _sentence(self) -> str:
        domain = f"ROS domain {self.session.domain_id}"
        if not self.nodes:
            return f"{domain}: nothing runs yet. A node that is started, in a terminal or a notebook, appears by itself."
        names = ", ".join(self.nodes[:MOST_NAMES])
        others = f" and {len(self.nodes) - MOST_NAMES} more" if len(self.nodes) > MOST_NAMES else ""
        count = "1 node runs" if len(self.nodes) == 1 else f"{len(self.nodes)} nodes run"
        return f"{domain}: {count}: {names}{others}."

    @traitlets.observe("nodes")
    def _show_note(self, _: object = None) -> None:
        kind = "note" if self.nodes else "reason"
        sentence = html.escape(self._sentence())
        self._note.value = f'<div role="status" class="ros2lab-{kind}">{sentence}</div>'

    def _send_state_again(self) -> None:
        """Send the state of all parts: what changed while a page made them may have been lost there."""
        self.send_state()
        for group in (self, *self.views):
            for part in parts_of(group):
                part.send_state()

    def _stop(self) -> None:
        self._redraw.remove(self._look_around)


class _Arrival(anywidget.AnyWidget):
    """Hears from a page when all parts of a dashboard are in it.

    Args:
        answer: is called then.
    """

    _esm = ending_with_its_kernel(Path(__file__).with_name("arrival.js"))

    def __init__(self, answer: Callable[[], None]) -> None:
        super().__init__()
        self._answer = answer
        self.on_msg(self._on_message)

    def _on_message(self, *_: object) -> None:
        self._answer()
        self.send({"is_answered": True})
