"""Finds message contents that are hardly intended: only zeros, odd axes, implausible speeds."""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.python_source import last_name
from ros2lab.grading.evidence import Run

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen

FASTEST, QUICKEST_TURN = 5.0, 2 * math.pi  # m/s and rad/s: more than any small robot can do
VELOCITIES = ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped")
# Movements that a robot on the ground does not make; which robot it is, is not known.
_ODD_AXES = {
    "linear.z": "it moves up or down",
    "angular.x": "it rolls, onto its left or right side",
    "angular.y": "it pitches, its front up or down",
    "linear.y": "it moves left or right without turning",
}
_TINIEST = 1e-300  # a smaller float has the bytes of an int


def content_faults(seen: Seen, run: Run) -> Iterator[Finding]:
    """Yield published contents that are hardly intended: only zeros, odd axes, implausible speeds."""
    for topic, stretches in seen.heard(run).items():
        place, values = (
            seen.place(topic),
            [value for heard in stretches for value in heard.values if value is not None],
        )
        numbers = [dict(numbers_of(value)) for value in values]
        found = [
            (name, number) for named_numbers in numbers for name, number in named_numbers.items() if number
        ]
        tiny = next((name for name, number in found if abs(number) < _TINIEST), None)
        if tiny:
            yield Finding(
                "int-in-float",
                f"On {topic}, {tiny} is almost but not quite 0: an int was put into a field that holds a float.",
                place,
                f"write 1.0 instead of 1 where {tiny} is set",
            )
        elif _are_blank(values) and seen.is_free(run):
            if any(map(_is_computed, seen.ends(topic, is_publisher=True))):
                continue  # it is filled, and what would change the value, or whether it is to be zero, is not known
            yield Finding(
                "message-empty",
                f"Each of the {len(values)} messages on {topic} holds only zeros or nothing, even after every command: the published message is not the one that was filled, or nothing fills it.",
                place,
                "fill the fields of the same object that is passed to publish(msg), in the callback that publishes it; if only zeros are intended, leave it",
            )
        elif stretches[0].type_name in VELOCITIES:
            yield from _velocity(seen, topic, dict(sorted(found, key=lambda pair: abs(pair[1]))))


def _are_blank(values: Sequence[Any]) -> bool:
    """Return whether messages have fields and all of them are known and empty or zero."""
    leaves = [leaf for value in values for leaf in _leaves(value)]
    return (
        bool(leaves) and not any(leaf is None or leaf for leaf in leaves) and not any(map(has_text, values))
    )


def _leaves(value: Any) -> Iterator[Any]:
    """Yield the leaf values of a message, without headers; an empty list is a leaf."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _leaves(inner) if key != "header" else ()
    elif isinstance(value, list) and value:
        for inner in value:
            yield from _leaves(inner)
    else:
        yield value


def _is_computed(end: Any) -> bool:
    """Return whether a class fills the messages that it publishes with anything but constants and empty messages."""
    read = (node for value in _given(end) for node in ast.walk(value))
    return any(
        isinstance(node, (ast.Name, ast.Attribute)) and not last_name(node)[:1].isupper() for node in read
    )


def _bound(node: ast.AST) -> Iterator[tuple[ast.expr, ast.expr]]:
    """Yield the targets of an assignment, each with its value."""
    match node:
        case ast.Assign(targets=[ast.Tuple(elts=targets)], value=ast.Tuple(elts=values)):
            yield from zip(targets, values, strict=False)
        case ast.Assign(targets=targets, value=value):
            yield from ((target, value) for target in targets)


def _given(end: Any) -> list[ast.expr]:
    """Return the expressions with which a class fills the messages that it publishes."""
    nodes = [*ast.walk(end.creation.owner.definition)] if end.creation.owner else []
    called = [node for node in nodes if isinstance(node, ast.Call)]
    sent = [call.args[0] for call in called if getattr(call.func, "attr", "") == "publish" and call.args]
    names = {ast.unparse(message) for message in sent}
    pairs = [pair for node in nodes if isinstance(node, ast.Assign) for pair in _bound(node)]
    made = [value for target, value in pairs if ast.unparse(target) in names]
    messages = [expression for expression in [*sent, *made] if isinstance(expression, ast.Call)]
    values = [
        value for message in messages for value in [*message.args, *(word.value for word in message.keywords)]
    ]
    return values + [value for target, value in pairs if not names.isdisjoint(_holders(target))]


def _holders(target: ast.expr) -> Iterator[str]:
    """Yield the objects that contain a field: `msg.linear` and `msg` for `msg.linear.x`."""
    while isinstance(target, ast.Attribute):
        target = target.value
        yield ast.unparse(target)


def _velocity(seen: Seen, topic: str, most: dict[str, float]) -> Iterator[Finding]:
    short = {name.removeprefix("twist."): number for name, number in most.items()}
    # The topics of the course tell that it is a robot on the ground: any other thing may turn and move in any way.
    is_of_course = topic.rpartition("/")[2] in {name.rpartition("/")[2] for name in seen.assignment.topics}
    # A robot that can drive sideways also drives forward.
    odd = [
        name
        for name in _ODD_AXES
        if is_of_course and name in short and (name != "linear.y" or "linear.x" not in short)
    ]
    for name in odd[:1]:
        right = "angular.z, which turns it," if name.startswith("angular") else "linear.x, which drives it,"
        yield Finding(
            "axis",
            f"On {topic}, {name} is {short[name]:g}: {_ODD_AXES[name]}.",
            seen.filled(topic, name),
            f"for a robot on the ground, write {right} instead of {name}; if it really moves like that, leave it",
        )
    for name, limit, unit, other_units in (
        ("linear.x", FASTEST, "m/s", "km/h, cm/s or mm/s"),
        ("angular.z", QUICKEST_TURN, "rad/s", "degrees"),
    ):
        if abs(short.get(name, 0.0)) > limit:
            fix = (
                "write math.radians(...) around the degrees"
                if unit == "rad/s"
                else "convert it: km/h / 3.6 is m/s"
            )
            yield Finding(
                "speed-implausible",
                f"On {topic}, {name} is {short[name]:g} {unit}, which is too much for a small robot; is it in {other_units}?",
                seen.filled(topic, name),
                fix,
            )


def numbers_of(value: Any) -> Iterator[tuple[str, float]]:
    """Yield the numbers of a message with their names, such as `linear.x`; headers are left out."""
    yield from ((name, float(leaf)) for name, leaf in leaves_of(value) if type(leaf) in (int, float))


def leaves_of(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the known values of a message with their names; headers are left out."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if key != "header":
                yield from leaves_of(inner, f"{name}.{key}".lstrip("."))
    elif isinstance(value, list):
        for number, inner in enumerate(value):
            yield from leaves_of(inner, f"{name}[{number}]")
    elif value is not None:
        yield name, value


def has_text(value: Any) -> bool:
    """Return whether a message, as plain data, contains a string that is not empty."""
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return bool(value) if isinstance(value, str) else any(map(has_text, inner))
