"""A live picture of the ROS graph, drawn in the browser, and its still picture."""

from __future__ import annotations

import dataclasses
import threading
import time
from collections.abc import Mapping
from itertools import zip_longest
from typing import Any

import traitlets
from matplotlib.figure import Figure
from rclpy.qos import QoSProfile, ReliabilityPolicy

from ros2lab.diagnose.nodes.graph import EXPECTED_TOPICS
from ros2lab.diagnose.nodes.ros_graph import Graph, Observation, graph_of, observe
from ros2lab.session import LabSession
from ros2lab.topics import QUEUE_DEPTH, TopicLog, find_type
from ros2lab.widgets.graph_figure import graph_figure
from ros2lab.widgets.graph_layout import DIRECTIONS, Layout, lay_out
from ros2lab.widgets.graph_scene import Scene, scene_of
from ros2lab.widgets.redraw import redraw_of
from ros2lab.widgets.stored_view import StoredView, check_session, style_sheet
from ros2lab.widgets.watched import Watched, script

LOOK_RATE = 2.0  # Hz, of looking at the graph, of which rclpy sends no event
RATE_SPAN = 10.0  # s, over which a topic's rate is measured
ASKED_FOR = 5.0  # s, after which a rate is no longer measured unless the browser asks again
FEWEST_SAMPLES = 2  # that have a rate


class GraphView(StoredView, Watched):
    """Shows the nodes and topics that the session's node sees and who talks to whom, live, and what does not fit.

    Type, rate and quality of service are shown where the mouse or the keyboard is; a rate is measured only there
    and only then. Showing it in a cell stores a picture in the notebook, too.

    Args:
        session: whose node looks; closing it closes the view.
        services: whether services are shown from the beginning.
        everything: whether what every node has is shown from the beginning: /rosout, /parameter_events, the
            services of parameters, and what is hidden by an underscore.

    Attributes:
        services: as above; may be changed.
        everything: as above; may be changed.
        graph: the facts that are drawn.

    Raises:
        TypeError: if an argument is of another kind.
        RuntimeError: if the session is closed.
    """

    _esm = script("graph_view")
    _css = style_sheet("graph_view")

    services = traitlets.Bool(False).tag(sync=True)
    everything = traitlets.Bool(False).tag(sync=True)
    scene = traitlets.Dict(read_only=True).tag(sync=True)
    rates = traitlets.Dict(read_only=True).tag(sync=True)

    def __init__(self, session: LabSession, *, services: bool = False, everything: bool = False) -> None:
        check_session(session, "GraphView")
        for name, value in (("services", services), ("everything", everything)):
            if not isinstance(value, bool):
                raise TypeError(f"{name} is True or False, not {value!r}.")
        self._redraw = redraw_of(session)
        self._node = session.node
        self._looking = threading.RLock()
        self._seen: tuple[Observation, bool] | None = None
        self._measured: dict[str, _Measurement] = {}
        self._layouts: list[Layout] = []
        self.graph = Graph()
        self._scene: Scene = scene_of(self.graph)
        super().__init__(services=services, everything=everything)
        self._look()
        self.observe(self._look, ("services", "everything"))
        self.on_msg(self._on_message)
        self._open_in(session, "")
        self._redraw.add(self._look, LOOK_RATE, while_=self.is_watched)

    def still(self) -> Figure:
        """Draw the graph with matplotlib, and write what does not fit below it."""
        if self._is_open:
            self._look()
        return graph_figure(self._scene, self._layouts)

    @property
    def description(self) -> str:
        """What is to be seen now, in words."""
        return self._scene.description

    def _look(self, _: object = None) -> None:
        """Look at the graph, and draw it again if it is another one."""
        with self._looking:
            self._measure()
            everything = self.everything
            seen = self._without_own(observe(self._node, services=self.services, everything=everything))
            if (seen, everything) != self._seen:
                self._seen = (seen, everything)
                self.graph = graph_of(seen, everything=everything, expected_topics=EXPECTED_TOPICS)
                self._draw()

    def _draw(self) -> None:
        self._scene = scene_of(self.graph)
        sizes = {box.id: box.size for box in self._scene.boxes}
        self._layouts = [
            lay_out(sizes, self._scene.links, direction, before)
            for direction, before in zip_longest(DIRECTIONS, self._layouts)
        ]
        self.set_trait("scene", sent(self._scene, self._layouts))

    def _without_own(self, seen: Observation) -> Observation:
        """Leave out the subscriptions that measure rates: they are there only because somebody looks."""
        ends = list(seen.ends)
        own = str(self._node.get_fully_qualified_name())
        for topic in self._measured:
            mine = (
                number
                for number, end in enumerate(ends)
                if (end.node, end.topic, end.is_publisher) == (own, topic, False)
                and end.qos.reliability == ReliabilityPolicy.BEST_EFFORT
            )
            number = next(mine, None)
            if number is not None:
                del ends[number]
        return dataclasses.replace(seen, ends=tuple(ends))

    def _on_message(self, _: object, content: Any, __: object) -> None:
        """Measure the rates that the browser asks for; it asks again as long as it shows them."""
        topics = content.get("measure") if isinstance(content, dict) else None
        if isinstance(topics, list) and all(isinstance(topic, str) for topic in topics) and self._is_open:
            with self._looking:
                until = time.monotonic() + ASKED_FOR
                published = {topic.name: topic.publishers for topic in self.graph.topics}
                for topic in topics:
                    if topic in self._measured:
                        self._measured[topic].until = until
                    elif published.get(topic):
                        self._measured[topic] = _Measurement(
                            self._node, topic, published[topic][0].type, until
                        )
                for topic in set(self._measured) - set(topics):
                    self._measured.pop(topic).close()
                self._measure()

    def _measure(self) -> None:
        """Show the rates, and end what nobody asks for any more."""
        now = time.monotonic()
        for topic, measurement in list(self._measured.items()):
            if measurement.until < now:
                self._measured.pop(topic).close()
        rates = {topic: measurement.words(now) for topic, measurement in self._measured.items()}
        if rates != self.rates:
            self.set_trait("rates", rates)

    def _on_watched(self) -> None:
        """Look again, or measure nothing any more: no page is left that would say so."""
        if self.watchers:
            self._redraw.hurry(self._look)
            return
        with self._looking:
            for topic in list(self._measured):
                self._measured.pop(topic).close()

    def _stop(self) -> None:
        self._redraw.remove(self._look)
        with self._looking:
            for measurement in self._measured.values():
                measurement.close()
            self._measured.clear()
            self._look()  # the last picture shows what there is at the end

    def __repr__(self) -> str:
        return "GraphView()"


class _Measurement:
    """A subscription for as long as somebody wants to know a topic's rate; `until` is in s of monotonic time."""

    def __init__(self, node: Any, topic: str, type_name: str, until: float) -> None:
        self.until = until
        self._begin = time.monotonic()
        self._log: TopicLog | None = None
        self._refusal = ""
        # Best effort receives from publishers of every quality of service.
        qos = QoSProfile(depth=QUEUE_DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
        try:
            self._log = TopicLog(node, topic, find_type(type_name), qos=qos)
        except ValueError as error:
            self._refusal = f"rate not measured: {error}"

    def words(self, now: float) -> str:
        """Say the rate, or why there is none."""
        if self._log is None:
            return self._refusal
        samples = self._log.samples(since=now - RATE_SPAN)
        if len(samples) >= FEWEST_SAMPLES:
            # By when they were published: regular also where the kernel had to wait for the processor.
            span = samples[-1].published - samples[0].published
            return f"{(len(samples) - 1) / span:.1f} Hz" if span > 0 else "more than can be measured"
        waited = min(now - self._begin, RATE_SPAN)
        if self._log.count == 0:
            return "measuring …" if waited < 3 else f"no message for {waited:.0f} s"
        return "measuring …" if waited < RATE_SPAN else f"less than one message in {RATE_SPAN / 2:g} s"

    def close(self) -> None:
        """Unsubscribe."""
        if self._log is not None:
            self._log.close()


def sent(scene: Scene, layouts: list[Layout]) -> Mapping[str, Any]:
    """Return what the browser draws, as plain data for JSON."""
    return {
        **dataclasses.asdict(scene),
        "layouts": [
            {
                **dataclasses.asdict(layout),
                "middles": {link: layout.middle(link) for link in layout.curves},
            }
            for layout in layouts
        ],
    }
