"""The still picture of a ROS graph, drawn with matplotlib as the browser draws the live one."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, PathPatch, Polygon
from matplotlib.path import Path

from ros2lab.widgets.graph_layout import Layout, Point
from ros2lab.widgets.graph_scene import Arrow, Box, Scene

WIDEST = 760.0  # px; a graph that is wider from left to right is drawn from top to bottom
NARROWEST = 420.0  # px, so that the sentences below the graph have room
PX_PER_INCH = 96.0
LINE = 16.0  # px, of a line of text
POINTS_PER_PX = 72 / PX_PER_INCH
LETTER = 6.2  # px, of the sentences
CORNER = 10.0  # px, of a topic's hexagon

# Okabe and Ito's colours, each with a dash of its own, as in widgets.css.
FAULT_COLOURS = {"type": "#D55E00", "qos": "#CC79A7", "name": "#E69F00", "twice": "#56B4E9"}
FAULT_DASHES = {"type": (0, (6, 3)), "qos": (0, (1.5, 1.5)), "name": (0, (3, 2, 1, 2)), "twice": "-"}
INK, FAINT, PAPER = "#222222", "#666666", "#FFFFFF"
FILLS = {"node": "#E3EEF6", "topic": "#F4F4F4", "service": "#FFFFFF"}


def graph_figure(scene: Scene, layouts: Sequence[Layout]) -> Figure:
    """Draw a scene in the first of the layouts that is not too wide, or the last; sentences go below."""
    layout = next((layout for layout in layouts if layout.width <= WIDEST), layouts[-1])
    width = max(layout.width, NARROWEST)
    lines = _lines(scene, round(width / LETTER))
    drawn = max(layout.height, LINE)
    height = drawn + LINE * (len(lines) + 1)
    figure = Figure(figsize=(width / PX_PER_INCH, height / PX_PER_INCH), facecolor=PAPER)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set(xlim=(0, width), ylim=(height, 0))  # as in the browser, y goes down
    axes.axis("off")
    for arrow in scene.arrows:
        _draw_arrow(axes, arrow, layout)
    for box in scene.boxes:
        _draw_box(axes, box, layout.boxes[box.id])
    for arrow in scene.arrows:
        _draw_badge(axes, arrow.fault, arrow.badge, layout.middle(arrow.id))
    for number, (text, is_fault) in enumerate(lines):
        _write(axes, Point(8, drawn + LINE * (number + 0.7)), text, INK if is_fault else FAINT, ha="left")
    return figure


def _lines(scene: Scene, columns: int) -> list[tuple[str, bool]]:
    """Wrap the sentences; True marks those of faults."""
    texts = [(f"! {said.text}", True) for said in scene.faults] + [(note, False) for note in scene.notes]
    if not scene.boxes:
        texts.append(("No node is seen.", False))
    return [(line, is_fault) for text, is_fault in texts for line in textwrap.wrap(text, columns)]


def _draw_arrow(axes: Axes, arrow: Arrow, layout: Layout) -> None:
    *points, tip = layout.curves[arrow.id]
    style: dict[str, Any] = {
        "edgecolor": FAULT_COLOURS.get(arrow.fault, FAINT),
        "linestyle": FAULT_DASHES.get(arrow.fault, "-"),
        "linewidth": 1.6 if arrow.fault else 1.0,
    }
    codes = [Path.MOVETO, *[Path.CURVE4] * (len(points) - 1)]
    if arrow.kind == "link":
        points, codes = [*points, tip], [*codes, Path.LINETO]
    axes.add_patch(PathPatch(Path(points, codes), facecolor="none", **style))
    if arrow.kind != "link":
        axes.add_patch(Polygon(arrow_head(points[-1], tip), color=style["edgecolor"], linewidth=0))


def arrow_head(base: Point, tip: Point, half_width: float = 3.5) -> list[Point]:
    """Return the corners of an arrow's head."""
    along = (tip.x - base.x, tip.y - base.y)
    length = max((along[0] ** 2 + along[1] ** 2) ** 0.5, 1e-6)
    side = (-along[1] / length * half_width, along[0] / length * half_width)
    return [Point(base.x + side[0], base.y + side[1]), tip, Point(base.x - side[0], base.y - side[1])]


def _draw_box(axes: Axes, box: Box, at: Point) -> None:
    style: dict[str, Any] = {
        "facecolor": FILLS[box.kind],
        "edgecolor": FAULT_COLOURS.get(box.fault, FAINT),
        "linestyle": FAULT_DASHES.get(box.fault, (0, (3, 3)) if box.note else "-"),
        "linewidth": 1.6 if box.fault else 1.0,
    }
    left, top, (width, height) = at.x - box.width / 2, at.y - box.height / 2, box.size
    if box.kind == "topic":
        right, bottom = left + width, top + height
        corners = [
            (left, at.y),
            (left + CORNER, top),
            (right - CORNER, top),
            (right, at.y),
            (right - CORNER, bottom),
            (left + CORNER, bottom),
        ]
        axes.add_patch(Polygon(corners, **style))
    else:
        radius = 6 if box.kind == "node" else height / 2
        boxstyle = f"round,pad=0,rounding_size={radius}"
        axes.add_patch(FancyBboxPatch((left, top), width, height, boxstyle=boxstyle, **style))
    _write(
        axes, Point(at.x, at.y - (7 if box.note else 0)), box.label, INK, size=12, family="DejaVu Sans Mono"
    )
    if box.note:
        _write(axes, Point(at.x, at.y + 8), box.note, FAINT, size=10.5)
    _draw_badge(axes, box.fault, box.badge, Point(left + width - 4, top - 2))


def _draw_badge(axes: Axes, fault: str, badge: str, at: Point) -> None:
    if badge:
        pill = {"boxstyle": "round,pad=0.35", "facecolor": FAULT_COLOURS[fault], "linewidth": 0}
        _write(axes, at, badge, "#000000", size=9.5, weight="bold", bbox=pill)


def _write(axes: Axes, at: Point, text: str, colour: str, size: float = 11, **style: Any) -> None:
    placed = {"ha": "center", "va": "center", **style}
    axes.text(*at, text, color=colour, size=size * POINTS_PER_PX, parse_math=False, **placed)
