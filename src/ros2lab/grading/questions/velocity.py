"""The node that publishes velocities: all the time, only on a change, or only after a command."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from ros2lab.grading.questions import nodes
from ros2lab.grading.questions.answer import Answer, last_word, question, shown
from ros2lab.grading.roles import VELOCITY, Case

TINY = 1e-200  # what an int becomes in a float field is 5e-324 times the int


@question("right doubled near other missing", "topic node why", nodes.CODES | nodes.TOPIC_CODES)
def velocity_topic(case: Case) -> Answer:
    """Whether a node publishes on /cmd_vel."""
    return nodes.topic(case, VELOCITY)


@question("right stamped wrong missing", "type topic", nodes.CODES | nodes.TYPE_CODES)
def velocity_type(case: Case) -> Answer:
    """Whether a velocity is a Twist."""
    return nodes.type_(case, VELOCITY)


@question("repeated once silent missing", "topic", nodes.CODES)
def velocity_comes_again(case: Case) -> Answer:
    """Whether velocities come again and again, or whenever something changes."""
    parts = case.parts[VELOCITY]
    if not parts:
        return Answer("missing", {"topic": ""}, ("runs",))
    totals = [sum(heard.count for heard in part.heard) for part in parts]
    most = max(totals)
    best = parts[totals.index(most)]
    level = "repeated" if most > 1 else "once" if most else "silent"
    keys = [best.quiet_key] if best.topic in best.run.quiet else []
    keys += [
        f"runs[{best.number}].commands[{number}].topics.{best.topic}"
        for number, command in enumerate(best.run.commands)
        if best.topic in command.topics
    ][:1]
    return Answer(level, {"topic": shown(best.topic)}, tuple(keys or [best.key]), shown(best.topic))


@question("right not_finite tiny refused no_twist silent missing", "value field", nodes.CODES)
def velocity_values(case: Case) -> Answer:
    """Whether the numbers are those of a velocity."""
    part = case.main(VELOCITY)
    seen = {"value": "", "field": ""}
    if part is None:
        return Answer("missing", seen, ("runs",))
    values = [
        (name, number) for heard in part.heard for value in heard.values for name, number in _numbers(value)
    ]
    if not part.is_heard:
        return Answer("silent", seen, (part.key,), shown(part.topic))
    level = "right" if values else "no_twist"
    for name, number in values:
        if not math.isfinite(number) or 0 < abs(number) < TINY:
            level = "tiny" if math.isfinite(number) else "not_finite"
            seen = {"value": f"{number:.3g}", "field": shown(name)}
            break
    if part.run.refused:
        level, seen["field"] = "refused", last_word(part.run.refused)
    return Answer(
        level, seen, (part.quiet_key if part.topic in part.run.quiet else part.key,), shown(part.topic)
    )


@question("lives dies ends stops silent missing", "program last", nodes.CODES)
def velocity_goes_on(case: Case) -> Answer:
    """Whether the node lives."""
    return nodes.life(case, VELOCITY)


def is_still(value: Any) -> bool:
    """Return whether a Twist, as plain data, is all zero."""
    return not any(number for _, number in _numbers(value))


def _numbers(value: Any, name: str = "") -> Iterator[tuple[str, float]]:
    """Yield the numbers in a Twist, or in what was published in its place, with their fields."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if key != "header":
                yield from _numbers(inner, f"{name}.{key}".lstrip("."))
    elif value in ("nan", "inf", "-inf") or (isinstance(value, (int, float)) and not isinstance(value, bool)):
        yield name, float(value)
