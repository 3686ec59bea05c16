"""A message as a tree of fields with texts, as a reader wants to see it: long arrays and texts are cut short."""

from __future__ import annotations

import datetime
import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from portable_ros2.messages import fields_of

MOST_ITEMS = 20  # of an array
MOST_BRANCHES = 1000  # of a tree
LONGEST_TEXT = 120  # letters of a string
LONGEST_SUMMARY = 56  # letters of a folded message
FIRST_NUMBERS = 4  # of an array, in its summary
FIRST_BYTES = 12
FIRST_DATED_SECOND = 1_000_000_000  # of 2001; what is earlier is taken for simulated time

_NAMES = {"boolean": "bool", "double": "float64", "float": "float32", "octet": "byte"}


@dataclass(frozen=True)
class Branch:
    """A field and what is below it.

    Attributes:
        name: of the field, `[3]` for an element of an array, empty for the message itself.
        type: as a .msg file has it, such as `float64[36]`.
        text: the value; a summary if there are children.
        children: the fields of a message, or the first elements of an array.
        left_out: how many further elements there are.
    """

    name: str
    type: str
    text: str
    children: tuple[Branch, ...] = ()
    left_out: int = 0

    def plain(self) -> dict[str, Any]:
        """Return the tree as dicts and lists, for the browser."""
        children = [child.plain() for child in self.children]
        below = {"children": children, "left_out": self.left_out} if children or self.left_out else {}
        return {"name": self.name, "type": self.type, "text": self.text, **below}

    def lines(self, depth: int = 0) -> Iterator[str]:
        """Yield the tree as indented lines of text, without its own name."""
        for child in self.children:
            yield f"{'  ' * depth}{child.name}: {child.text}".rstrip()
            if not child.type.endswith("]"):
                yield from child.lines(depth + 1)


def message_tree(message: Any) -> Branch:
    """Return a message as a tree.

    Args:
        message: a ROS message; it is not changed.

    Returns:
        The tree, of at most `MOST_BRANCHES` fields and elements.
    """
    return _Grower(MOST_BRANCHES).message(message, "", type_text_of(message))


def type_text_of(message: Any) -> str:
    """Return the type of a message or message class as a .msg file has it, such as `geometry_msgs/Twist`."""
    message_type = message if isinstance(message, type) else type(message)
    return f"{message_type.__module__.split('.')[0]}/{message_type.__name__}"


def type_text(kind: Any) -> str:
    """Return a type of `rosidl_parser.definition` as a .msg file has it, such as `float64[36]`."""
    if hasattr(kind, "value_type"):
        size, most = getattr(kind, "size", None), getattr(kind, "maximum_size", None)
        bound = str(size) if size is not None else f"<={most}" if most is not None else ""
        return f"{type_text(kind.value_type)}[{bound}]"
    if hasattr(kind, "namespaces"):
        return f"{kind.namespaces[0]}/{kind.name}"
    typename = getattr(kind, "typename", None)
    if typename is not None:
        return _NAMES.get(typename, str(typename))
    most = getattr(kind, "maximum_size", None)
    name = "wstring" if type(kind).__name__.endswith("WString") else "string"
    return name if most is None else f"{name}<={most}"


class _Grower:
    """Grows a tree up to a number of branches."""

    def __init__(self, most: int) -> None:
        self._left = most

    def message(self, message: Any, name: str, type_name: str) -> Branch:
        children = tuple(
            self._branch(getattr(message, field), kind, field) for field, kind in fields_of(message)
        )
        text = _TEXTS[type_name](message) if type_name in _TEXTS else _summary(children)
        return Branch(name, type_name, text, children)

    def _branch(self, value: Any, kind: Any, name: str) -> Branch:
        self._left -= 1
        if hasattr(kind, "value_type"):
            return self._array(value, kind, name)
        if hasattr(kind, "namespaces"):
            return self.message(value, name, type_text(kind))
        return Branch(name, type_text(kind), _value_text(value, kind))

    def _array(self, value: Any, kind: Any, name: str) -> Branch:
        shown = max(0, min(len(value), MOST_ITEMS, self._left))
        items = value[:shown]
        items = items.tolist() if hasattr(items, "tolist") else items
        children = tuple(self._branch(item, kind.value_type, f"[{n}]") for n, item in enumerate(items))
        return Branch(name, type_text(kind), _array_text(value, kind), children, len(value) - shown)


def _array_text(value: Any, kind: Any) -> str:
    if type_text(kind.value_type) in ("uint8", "byte"):
        return _bytes_text(value)
    count = f"{len(value)} element{'' if len(value) == 1 else 's'}"
    if not len(value) or hasattr(kind.value_type, "namespaces"):
        return count
    first = [_value_text(item, kind.value_type) for item in value[:FIRST_NUMBERS]]
    return f"{count}: {_cut(', '.join(first), LONGEST_SUMMARY)}{', …' * (len(value) > FIRST_NUMBERS)}"


def _bytes_text(value: Any) -> str:
    count = f"{len(value)} byte{'' if len(value) == 1 else 's'}"
    first = [item if isinstance(item, bytes) else bytes([item]) for item in value[:FIRST_BYTES]]
    return f"{count}: {b''.join(first).hex(' ')}{' …' * (len(value) > FIRST_BYTES)}" if first else count


def _value_text(value: Any, kind: Any) -> str:
    typename = getattr(kind, "typename", "string")
    if typename == "string":
        return json.dumps(_cut(value, LONGEST_TEXT), ensure_ascii=False)
    if typename == "boolean":
        return "true" if value else "false"
    if typename == "octet":
        return f"0x{value.hex()}"
    if typename in ("float", "double"):
        return f"{value:.7g}" if typename == "float" else f"{value:.10g}"
    return str(value)


def _summary(children: tuple[Branch, ...]) -> str:
    """Return the plain values of a message in one line; of nested ones only their own summaries."""
    parts = [f"{child.name} {child.text}" for child in children if child.text]
    return _cut("  ".join(parts), LONGEST_SUMMARY) if not any(c.children for c in children) else ""


def _time_text(message: Any) -> str:
    if message.sec < FIRST_DATED_SECOND:
        return _duration_text(message)
    moment = datetime.datetime.fromtimestamp(message.sec).astimezone()
    return f"{moment:%Y-%m-%d %H:%M:%S}.{message.nanosec // 1_000_000:03d}"


def _duration_text(message: Any) -> str:
    nanoseconds = message.sec * 1_000_000_000 + message.nanosec
    whole, rest = divmod(abs(nanoseconds), 1_000_000_000)
    decimals = f"{rest:09d}".rstrip("0")
    return f"{'-' * (nanoseconds < 0)}{whole}{'.' * bool(decimals)}{decimals} s"


_TEXTS = {"builtin_interfaces/Time": _time_text, "builtin_interfaces/Duration": _duration_text}


def _cut(text: str, longest: int) -> str:
    return text if len(text) <= longest else f"{text[: longest - 1]}…"
