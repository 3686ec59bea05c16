"""What a node published during a run, as a picture: SVG for an HTML page, which gives it its colours.

The page sets the colours of the classes `axis`, `mark`, `tick`, `linear` and `angular`. Without these
everything is black, and told apart by its form.
"""

from __future__ import annotations

import itertools
import math
import statistics
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from ros2lab.grading.evidence import Heard, Run
from ros2lab.grading.reports.shown import number, visible

WIDTH, MARGIN = 480, 8  # of the picture
LEAST = 18  # width of a part of the run, however short
LABEL, TICK, PLOT, AXIS, GAP = 14, 12, 84, 16, 8  # heights
LETTER = 5.8  # width of a letter
NAME = 40  # characters of a topic
LATEST = 1e6  # s
FLAT = 1e-9  # a change of velocity that no picture shows
LANES, PLOTS = 8, 2  # of a picture


@dataclass(frozen=True)
class _Part:
    """A part of a run, from a command to the next one.

    Attributes:
        name: the command; empty for the part before any command.
        start: the time of its first message, in s. Parts without messages share the time between their
            neighbours.
        x: where it begins in the picture.
        heard: what was published, by topic.
        lines: the number of log lines.
    """

    name: str
    start: float
    x: float
    heard: Mapping[str, Heard]
    lines: int


def published_by(run: Run, node: str) -> list[str]:
    """Return the topics on which a node was heard, sorted; for an empty name, those without a known node."""
    topics = {
        topic for heard in (run.quiet, *(command.topics for command in run.commands)) for topic in heard
    }
    return sorted(
        topic
        for topic in topics
        if (node in run.publishes.get(topic, {}) if node else not any(run.publishes.get(topic, {})))
    )


def timeline(run: Run, node: str, key: str) -> Markup:
    """Draw what a node published, the commands as marks, and velocities as a plot.

    Args:
        run: the run in which it was watched.
        node: its full name; empty for topics without a known node.
        key: the prefix of the picture's ids, which must be unique in a page.

    Returns:
        An SVG element, `WIDTH` wide in its own units, with a title and a description.
    """
    parts, scale = _parts(run)
    topics = published_by(run, node)[:LANES]
    plotted = [topic for topic in topics if any(_has_velocity(part.heard.get(topic)) for part in parts)][
        :PLOTS
    ]
    drawn: list[Markup] = []
    y = float(LABEL + GAP)
    for topic in topics:
        drawn.append(_lane(parts, topic, scale, y))
        y += LABEL + TICK + GAP
    for topic in plotted:
        drawn.append(_plot(parts, topic, scale, y))
        y += LABEL + PLOT + GAP
    if len(run.nodes) == 1 and any(part.lines for part in parts):
        drawn.append(_log(parts, scale, y))
        y += LABEL + TICK + GAP
    height = y + AXIS
    return Markup(
        '<svg class="timeline" role="img" aria-labelledby="{key}-title {key}-text" viewBox="0 0 {width} {height:.0f}"'
        ' xmlns="http://www.w3.org/2000/svg"><title id="{key}-title">{title}</title>'
        '<desc id="{key}-text">{text}</desc>{marks}{drawn}</svg>'
    ).format(
        key=key,
        width=WIDTH,
        height=height,
        title=f"Timeline of {visible(node) or 'unknown nodes'}",
        text=_described(run, parts, topics, plotted),
        marks=_marks(parts, scale, y),
        drawn=Markup("").join(drawn),
    )


class _Scale:
    """Maps times to places: each part is as wide as its duration needs, and at least `LEAST`."""

    def __init__(self, starts: list[float], end: float) -> None:
        self._times = [*starts, end]
        spans = [later - earlier for earlier, later in itertools.pairwise(self._times)]
        whole, width = sum(spans), WIDTH - 2 * MARGIN
        least = min(LEAST, width / 2 / len(spans))
        rest = width - least * len(spans)
        widths = [least + (rest * span / whole if whole else rest / len(spans)) for span in spans]
        self.places = list(itertools.accumulate(widths, initial=float(MARGIN)))
        self.end = end

    def width(self, part: int) -> float:
        return self.places[part + 1] - self.places[part]

    def x(self, part: int, time: float) -> float:
        """Return the place of a time in a part."""
        start, end = self._times[part], self._times[part + 1]
        share = (time - start) / (end - start) if end > start else 0.0
        return self.places[part] + self.width(part) * min(1.0, max(0.0, share))


def _parts(run: Run) -> tuple[list[_Part], _Scale]:
    """Return the parts of a run and the scale; a command's time follows from the messages around it."""
    rows: list[tuple[str, Mapping[str, Heard], int]] = [
        ("", run.quiet, 0),
        *((command.text, command.topics, len(command.log)) for command in run.commands),
    ]
    spans = [[time for messages in heard.values() for time in _times(messages)] for _, heard, _ in rows]
    starts: list[float] = []
    latest = 0.0
    for index, times in enumerate(spans):
        if not index or times:
            begun = max(latest, min(times)) if index else 0.0
        else:
            coming = next((later for later in range(index, len(spans)) if spans[later]), None)
            left = (max(latest, min(spans[coming])) - latest) / (coming - index + 1) if coming else 0.0
            begun = latest + left
        starts.append(begun)
        latest = max([begun, *times])
    scale = _Scale(starts, latest)
    return [
        _Part(name, start, x, heard, lines)
        for (name, heard, lines), start, x in zip(rows, starts, scale.places, strict=False)
    ], scale


def _times(heard: Heard) -> list[float]:
    return [min(time, LATEST) for time in heard.times if math.isfinite(time) and time >= 0]


def _marks(parts: list[_Part], scale: _Scale, bottom: float) -> Markup:
    """Draw the commands, numbered as in the list of commands, and the time axis."""
    drawn = []
    for index, part in enumerate(parts):
        if index:
            name = f"{index} {visible(part.name, 16)}"
            shown = name if (len(name) + 0.5) * LETTER < scale.width(index) else str(index)
            drawn.append(
                Markup(
                    '<path class="mark" d="M{0:.1f} 2V{1:.1f}"/><text class="command" x="{2:.1f}" y="11">{3}</text>'
                ).format(part.x, bottom, part.x + 2, shown)
            )
        elif scale.width(0) > 20 * LETTER:
            drawn.append(Markup('<text x="{:.1f}" y="11">no command yet</text>').format(part.x))
    drawn.append(Markup('<path class="axis" d="M{} {:.1f}H{}"/>').format(MARGIN, bottom, WIDTH - MARGIN))
    end = f"{scale.end:.1f} s"
    drawn.append(
        Markup('<text class="end" x="{}" y="{:.1f}">{}</text>').format(WIDTH - MARGIN, bottom + 12, end)
    )
    free = 0.0
    for part in parts:
        if part.name and not part.heard:
            continue  # its time is a guess
        label = f"{part.start:.1f}"
        width = (len(label) + 1) * LETTER
        if part.x >= free and part.x + width < WIDTH - MARGIN - (len(end) + 1) * LETTER:
            drawn.append(Markup('<text x="{:.1f}" y="{:.1f}">{}</text>').format(part.x, bottom + 12, label))
            free = part.x + width
    return Markup("").join(drawn)


def _lane(parts: list[_Part], topic: str, scale: _Scale, y: float) -> Markup:
    places = {
        f"{scale.x(index, time):.0f}"
        for index, part in enumerate(parts)
        if topic in part.heard
        for time in _times(part.heard[topic])
    }
    ticks = "".join(f"M{x} {y + LABEL:.0f}v{TICK}" for x in sorted(places, key=int))
    return Markup(
        '<text x="{}" y="{:.0f}">{}: {}</text><path class="axis" d="M{} {:.0f}H{}"/><path class="tick" d="{}"/>'
    ).format(
        MARGIN,
        y + LABEL - 4,
        visible(topic, NAME),
        _amount(parts, topic),
        MARGIN,
        y + LABEL + TICK,
        WIDTH - MARGIN,
        ticks,
    )


def _log(parts: list[_Part], scale: _Scale, y: float) -> Markup:
    """Write how many log lines followed each command."""
    counts = [
        Markup('<text class="count" x="{:.1f}" y="{:.0f}">{}</text>').format(
            part.x + scale.width(index) / 2, y + LABEL + TICK - 2, part.lines
        )
        for index, part in enumerate(parts)
        if index
    ]
    return Markup('<text x="{}" y="{:.0f}">log lines after each command</text>{}').format(
        MARGIN, y + LABEL - 4, Markup("").join(counts)
    )


def _plot(parts: list[_Part], topic: str, scale: _Scale, y: float) -> Markup:
    """Draw linear x and angular z over time, with a line for each part, as messages may lie between them."""
    lines = {
        name: [
            [(scale.x(index, time), value) for time, value in _velocities(part.heard.get(topic), name)]
            for index, part in enumerate(parts)
        ]
        for name in ("linear", "angular")
    }
    values = [value for runs in lines.values() for points in runs for _, value in points]
    top, low = max(0.0, *values), min(0.0, *values)
    middle = y + LABEL
    if top - low < FLAT:  # such as the tiny number that an int leaves in a float field
        top, low = 1.0, -1.0

    def place(value: float) -> float:
        return middle + PLOT * (
            1 - (value / 2 - low / 2) / (top / 2 - low / 2)
        )  # also for the largest numbers

    drawn = [
        Markup('<text x="{}" y="{:.0f}">{}</text>').format(MARGIN, y + LABEL - 4, visible(topic, 16)),
        Markup('<path class="axis" d="M{} {:.1f}H{}"/>').format(MARGIN, place(0.0), WIDTH - MARGIN),
    ]
    x = WIDTH - 262.0
    for name, label in (("linear", "linear x (m/s)"), ("angular", "angular z (rad/s)")):
        drawn.append(
            Markup('<path class="{}" d="M{:.0f} {:.0f}h18"/><text x="{:.0f}" y="{:.0f}">{}</text>').format(
                name, x, y + LABEL - 8, x + 22, y + LABEL - 4, label
            )
        )
        x += 128
        path = "".join(_path(points, place) for points in lines[name])
        drawn.append(Markup('<path class="{}" d="{}"/>').format(name, path))
    for value, where in ((top, middle + 9), (low, middle + PLOT - 2)):
        if value:
            drawn.append(
                Markup('<text class="end" x="{}" y="{:.0f}">{:.3g}</text>').format(
                    WIDTH - MARGIN, where, value
                )
            )
    return Markup("").join(drawn)


def _path(points: list[tuple[float, float]], place: Any) -> str:
    """Return an SVG path through points; of those in one column only the lowest and the highest."""
    columns: dict[int, list[float]] = {}
    for x, value in points:
        columns.setdefault(round(x), []).append(value)
    steps = [(x, y) for x, column in columns.items() for y in dict.fromkeys((min(column), max(column)))]
    if not steps:
        return ""
    line = "L".join(f"{x} {place(y):.1f}" for x, y in steps)
    return f"M{line}" if len(steps) > 1 else f"M{line}h3"


def _has_velocity(heard: Heard | None) -> bool:
    return any(True for _ in _velocities(heard, "linear")) or any(True for _ in _velocities(heard, "angular"))


def _velocities(heard: Heard | None, name: str) -> Iterator[tuple[float, float]]:
    """Yield time and value of linear x or angular z for each message with a finite number there."""
    if heard is None or not heard.type_name.startswith("geometry_msgs/msg/Twist"):
        return
    for time, message in zip(heard.times, heard.values, strict=False):
        value: Any = message
        for key in (*(["twist"] if "Stamped" in heard.type_name else []), name, "xz"[name == "angular"]):
            value = value.get(key) if isinstance(value, dict) else None
        if isinstance(value, float) and math.isfinite(value) and math.isfinite(time) and time >= 0:
            yield min(time, LATEST), value


def _amount(parts: Iterable[_Part], topic: str) -> str:
    heard = [part.heard[topic] for part in parts if topic in part.heard]
    count, kept = sum(messages.count for messages in heard), sum(len(messages.times) for messages in heard)
    shown = f", {kept} of them shown" if count > kept else ""
    return f"{count} message{'' if count == 1 else 's'}{shown}"


def _described(run: Run, parts: list[_Part], topics: list[str], plotted: list[str]) -> str:
    """Return a description of the picture in words."""
    sentences = []
    for topic in topics:
        gaps = [
            later - earlier
            for part in parts
            if topic in part.heard
            for earlier, later in itertools.pairwise(_times(part.heard[topic]))
        ]
        every = f", one every {number(statistics.median(gaps))} s (median)" if gaps else ""
        sentences.append(f"{visible(topic, NAME)}: {_amount(parts, topic)}{every}.")
    for topic in plotted:
        for name, label, unit in (("linear", "linear x", "m/s"), ("angular", "angular z", "rad/s")):
            values = [value for part in parts for _, value in _velocities(part.heard.get(topic), name)]
            if values:
                sentences.append(
                    f"{visible(topic, NAME)}, {label}: from {min(values):.3g} to {max(values):.3g} {unit}."
                )
    if not topics:
        sentences.append("Nothing was published.")
    if run.commands:
        names = ", ".join(f"{index} {visible(part.name, 16)!r}" for index, part in enumerate(parts) if index)
        sentences.append(f"Commands: {names}.")
    return " ".join(sentences)
