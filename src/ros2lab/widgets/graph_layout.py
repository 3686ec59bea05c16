"""Where the parts of a graph are drawn: Graphviz's `dot` puts them in layers, and routes the arrows."""

from __future__ import annotations

import dataclasses
import math
import threading
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias, get_args

Direction: TypeAlias = Literal["LR", "TB"]  # from left to right, from top to bottom
DIRECTIONS: tuple[Direction, ...] = get_args(Direction)

GAP = 16.0  # px, between boxes of one layer
LAYER_GAP = 38.0  # px, between layers
MARGIN = 6.0  # px, around everything
_POINTS_PER_INCH = 72.0  # dot takes sizes in inches and gives positions in points; a point is a pixel here

_dot = threading.Lock()  # Graphviz is not made for threads


class Point(NamedTuple):
    """A place in px, from the left and from the top."""

    x: float
    y: float


class Link(NamedTuple):
    """An arrow to be drawn.

    Attributes:
        name: of its own.
        source: name of a box.
        target: name of a box.
        has_badge: whether something is written at its middle, which needs room.
    """

    name: str
    source: str
    target: str
    has_badge: bool = False


@dataclass(frozen=True)
class Layout:
    """Where everything is, in px.

    Attributes:
        direction: in which the arrows point.
        width: of the whole picture.
        height: of the whole picture.
        boxes: the centre of each box.
        curves: of each arrow the control points of its cubic Bézier curves, 3n + 1, and then its tip.
    """

    direction: Direction
    width: float
    height: float
    boxes: Mapping[str, Point]
    curves: Mapping[str, tuple[Point, ...]]

    def middle(self, link: str) -> Point:
        """Return the point in the middle of an arrow's curves."""
        *points, _ = self.curves[link]
        count = (len(points) - 1) // 3
        start = 3 * ((count - 1) // 2)
        if count % 2 == 0:
            return points[start + 3]
        a, b, c, d = points[start : start + 4]
        return Point((a.x + 3 * b.x + 3 * c.x + d.x) / 8, (a.y + 3 * b.y + 3 * c.y + d.y) / 8)


def lay_out(
    sizes: Mapping[str, tuple[float, float]],
    links: Iterable[Link],
    direction: Direction = "LR",
    before: Layout | None = None,
) -> Layout:
    """Place boxes in layers, so that arrows point one way and few of them cross.

    Args:
        sizes: width and height of each box in px, by name.
        links: the arrows.
        direction: in which they point.
        before: the last layout; what was there keeps its order, as far as the arrows allow it.

    Returns:
        The same for the same arguments.
    """
    if not sizes:
        return Layout(direction, 0, 0, {}, {})
    links = sorted(links)
    layout = _dot_layout(sizes, links, direction, _in_order(sizes, direction, before))
    return min(layout, _mirrored(layout), key=lambda candidate: _moved(candidate, before))


def _in_order(sizes: Mapping[str, object], direction: Direction, before: Layout | None) -> list[str]:
    """Sort names by where they were, across the arrows, and new ones last: dot begins with this order."""
    known = before.boxes if before is not None else {}
    across = 1 if direction == "LR" else 0
    return sorted(
        sizes, key=lambda name: (name not in known, known[name][across] if name in known else 0, name)
    )


def _mirrored(layout: Layout) -> Layout:
    """Exchange left and right, or top and bottom, and keep the direction of the arrows."""

    def mirrored(point: Point) -> Point:
        x, y = point
        return Point(x, layout.height - y) if layout.direction == "LR" else Point(layout.width - x, y)

    return dataclasses.replace(
        layout,
        boxes={name: mirrored(point) for name, point in layout.boxes.items()},
        curves={name: tuple(map(mirrored, points)) for name, points in layout.curves.items()},
    )


def _moved(layout: Layout, before: Layout | None) -> float:
    """Return how far the boxes have moved in all, in px."""
    known = before.boxes if before is not None else {}
    return sum(math.dist(point, known[name]) for name, point in layout.boxes.items() if name in known)


def _dot_layout(
    sizes: Mapping[str, tuple[float, float]], links: list[Link], direction: Direction, order: list[str]
) -> Layout:
    import pygraphviz  # loading Graphviz takes a moment, which only those wait for who draw a graph

    graph = pygraphviz.AGraph(directed=True, strict=False)
    graph.graph_attr.update(
        rankdir=direction,
        nodesep=str(GAP / _POINTS_PER_INCH),
        ranksep=str(LAYER_GAP / _POINTS_PER_INCH),
        pack=str(GAP + 6),
        # Unconnected parts side by side, or one below the other, in the order of `sortv`.
        packmode="array_u" if direction == "LR" else "array_u1",
    )
    graph.node_attr.update(shape="box", fixedsize="true", label="")
    graph.edge_attr.update(arrowsize="0.7")
    keys = {name: f"b{number}" for number, name in enumerate(order)}
    for number, name in enumerate(order):
        width, height = sizes[name]
        graph.add_node(
            keys[name], width=width / _POINTS_PER_INCH, height=height / _POINTS_PER_INCH, sortv=number + 1
        )
    for number, link in enumerate(links):
        layers = 2 if link.has_badge and direction == "LR" else 1
        graph.add_edge(keys[link.source], keys[link.target], key=f"e{number}", minlen=layers)
    with _dot:
        graph.layout("dot")
    left, bottom, right, top = map(float, graph.graph_attr["bb"].split(","))

    def point(text: str) -> Point:
        x, y = map(float, text.split(","))
        return Point(round(x - left + MARGIN, 1), round(top - y + MARGIN, 1))

    curves = {}
    for number, link in enumerate(links):
        edge = graph.get_edge(keys[link.source], keys[link.target], key=f"e{number}")
        tip, *points = edge.attr["pos"].removeprefix("e,").split()
        curves[link.name] = (*map(point, points), point(tip))
    boxes = {name: point(graph.get_node(keys[name]).attr["pos"]) for name in sizes}
    return Layout(direction, right - left + 2 * MARGIN, top - bottom + 2 * MARGIN, boxes, curves)
