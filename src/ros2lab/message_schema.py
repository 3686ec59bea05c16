"""What a form needs to know of a message type, and how what was typed becomes a message.

The fields come from the message class; their meaning and units from the comments of its .msg file, where there is
one on this machine.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from portable_ros2 import interfaces
from portable_ros2.messages import FLOAT_MAX, fields_of, fill
from ros2lab.message_tree import type_text
from ros2lab.topics import find_type, type_name

NOW = "now"  # stands for the time of publishing
TIME_TYPE = "builtin_interfaces/Time"

_UNIT_ATOM = r"(?:radians?|rad|degrees|deg|seconds|meters|metres|pixels?|px|ms|us|ns|kg|Hz|Pa|Ah|m|s|N|V|A|C|K|T|W|J|g|%)"
_UNIT = re.compile(
    rf"[\[(](?P<unit>(?:1/)?{_UNIT_ATOM}(?:\^?-?\d|\u00b2|\u00b3)?"
    rf"(?:[*/\u00b7 ]{_UNIT_ATOM}(?:\^?-?\d|\u00b2|\u00b3)?)*)[\])]"
)
_CONSTANT = re.compile(r"(?P<type>\w+)(?:<=\d+)?\s+(?P<name>[A-Z][A-Z0-9_]*)\s*=")
_DECLARED_FIELD = re.compile(r"[\w/]+(?:<=\d+)?(?:\[[^\]]*\])?\s+(?P<name>[a-z]\w*)")


class FormError(ValueError):
    """What was typed does not make a message.

    Args:
        problems: a sentence for each field, by its path such as `pose.position.x` or `points[2].x`.
    """

    def __init__(self, problems: Mapping[str, str]) -> None:
        super().__init__(" ".join(problems.values()))
        self.problems = dict(problems)


@dataclass(frozen=True)
class _Words:
    """What a .msg file says beyond its fields.

    Attributes:
        comments: by field.
        constants: the type of each, by name.
    """

    comments: Mapping[str, str]
    constants: Mapping[str, str]


def message_schema(message_type: type) -> list[dict[str, Any]]:
    """Describe the fields of a message type as dicts and lists, for a form.

    Args:
        message_type: a message class.

    Returns:
        For each field its `name`, `type` (as in a .msg file), `kind` (message, time, array, bool, int, float or
        string), `comment` and `unit` (empty if there are none). A message has `fields`; an array `item`, `size`
        and `most` (None where they are not limited) and `default`; a whole number `low` and `high`; a string
        `most`. What is typed has a `default` and `options`, the names and values of the constants that fit.
    """
    words = _words(type_name(message_type))
    kinds = dict(fields_of(message_type))
    options = _options(message_type, kinds, words)
    message: Any = message_type()
    return [
        _field(name, kind, getattr(message, name), words.comments.get(name, ""), options.get(name, []))
        for name, kind in kinds.items()
    ]


def filled(message_type: type, values: Mapping[str, Any]) -> tuple[Any, list[Callable[[Any], None]]]:
    """Make a message of what was typed.

    Args:
        message_type: a message class.
        values: texts (and booleans) by field, nested as the message is; a field that is missing keeps its
            default. A time may be `NOW`.

    Returns:
        The message, and for each `NOW` in it a function that takes the present time and sets it.

    Raises:
        FormError: if something does not fit, with a sentence for each such field.
    """
    problems: dict[str, str] = {}
    checked: Any = _checked_message(message_type, values, "", problems)
    if problems:
        raise FormError(problems)
    message = message_type()
    return message, fill(message, checked)


def _field(name: str, kind: Any, value: Any, comment: str, options: list[tuple[str, str]]) -> dict[str, Any]:
    unit = _UNIT.search(comment)
    described = {
        "name": name,
        "type": type_text(kind),
        "comment": comment,
        "unit": unit["unit"] if unit else "",
    }
    if hasattr(kind, "value_type"):
        item = _item(kind.value_type)
        size, most = getattr(kind, "size", None), getattr(kind, "maximum_size", None)
        is_plain = item["kind"] not in ("message", "time")
        default = [_plain_default(element) for element in value] if is_plain else [None] * (size or 0)
        return {**described, "kind": "array", "item": item, "size": size, "most": most, "default": default}
    if hasattr(kind, "namespaces"):
        fields = message_schema(_class_of(kind))
        return {
            **described,
            "kind": "time" if described["type"] == TIME_TYPE else "message",
            "fields": fields,
        }
    return {**described, **_basic(kind), "default": _plain_default(value), "options": options}


def _item(kind: Any) -> dict[str, Any]:
    default = _class_of(kind)() if hasattr(kind, "namespaces") else _zero(kind)
    return _field("", kind, default, "", [])


def _basic(kind: Any) -> dict[str, Any]:
    typename = getattr(kind, "typename", "string")
    if typename == "string":
        return {"kind": "string", "most": getattr(kind, "maximum_size", None)}
    if typename == "boolean":
        return {"kind": "bool"}
    if typename in FLOAT_MAX:
        return {"kind": "float"}
    low, high = integer_range(typename)
    # As texts: a number of JavaScript has 53 bits.
    return {"kind": "int", "low": str(low), "high": str(high)}


def integer_range(typename: str) -> tuple[int, int]:
    """Return the least and the greatest value of a whole-number type such as `int8`, `octet` or `wchar`."""
    match = re.fullmatch(r"(u?)int(\d+)", typename)
    bits = int(match[2]) if match else 16 if typename == "wchar" else 8
    is_signed = match is not None and not match[1]
    return (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if is_signed else (0, 2**bits - 1)


def _zero(kind: Any) -> Any:
    kind_name = _basic(kind)["kind"]
    return {"string": "", "bool": False, "float": 0.0, "int": 0}[kind_name]


def _plain_default(value: Any) -> Any:
    if hasattr(value, "item"):  # a number of numpy's
        value = value.item()
    if isinstance(value, bool):
        return value
    if isinstance(value, bytes):
        return str(value[0])
    return str(value)


def _class_of(kind: Any) -> type:
    return find_type("/".join(kind.namespaced_name()))


# --- What a .msg file says ------------------------------------------------------------------------------------


@functools.lru_cache(maxsize=256)
def _words(name: str) -> _Words:
    """Read the comments and the types of the constants of `package/msg/Name`; none where there is no file."""
    try:
        lines = list(interfaces.definition(name))
    except (LookupError, OSError, UnicodeDecodeError):
        lines = []
    comments: dict[str, str] = {}
    constants: dict[str, str] = {}
    above: list[str] = []
    field = ""  # whose comment goes on in the next lines, further in
    first = next((n for n, line in enumerate(lines) if line.code or not line.text), 0)
    for line in lines[first:]:  # the comment with which a file begins is about the whole message
        code, comment = line.code, line.text[line.comment + 1 :].strip()
        constant, declared = _CONSTANT.match(code), _DECLARED_FIELD.match(code)
        if constant:
            constants[constant["name"]] = constant["type"]
        elif declared:
            field = declared["name"] if comment else ""
            comments[declared["name"]] = " ".join(part for part in [*above, comment] if part)
        elif field and comment and line.text[:1].isspace():
            comments[field] += f" {comment}"
            continue
        else:
            field = ""
        above = [*above, comment] if not code and comment else []
    return _Words({name: text for name, text in comments.items() if text}, constants)


def _options(message_type: type, kinds: Mapping[str, Any], words: _Words) -> dict[str, list[tuple[str, str]]]:
    """Return for each field the constants that are meant for it, as far as their names and types tell."""
    options: dict[str, list[tuple[str, str]]] = {}
    claimed: set[str] = set()
    constants = dict(_constants(message_type))

    def offer(field: str, names: list[str]) -> None:
        options[field] = [(name, _plain_default(constants[name])) for name in names]

    fitting = {
        field: [name for name in constants if _fits(constants[name], kind, words.constants.get(name))]
        for field, kind in kinds.items()
    }
    for field, names in fitting.items():
        own = [name for name in names if name.startswith(f"{field.upper()}_")]
        claimed.update(own)
        offer(field, own)
    for field, names in fitting.items():
        if not options[field]:
            offer(field, [name for name in names if name not in claimed])
    return options


def _constants(message_type: type) -> Iterator[tuple[str, Any]]:
    # rosidl keeps them in a private attribute of the metaclass.
    for name, value in vars(type(message_type)).items():
        if name.endswith("__constants"):
            yield from value.items()


def _fits(value: Any, kind: Any, declared: str | None) -> bool:
    if hasattr(kind, "value_type") or hasattr(kind, "namespaces"):
        return False
    if declared is not None:
        return {"char": "uint8"}.get(declared, declared) == type_text(kind).partition("<")[0]
    wanted: Any = {"string": str, "bool": bool, "float": float, "int": (int, bytes)}[_basic(kind)["kind"]]
    return isinstance(value, wanted) and isinstance(value, bool) == (wanted is bool)


# --- What was typed -------------------------------------------------------------------------------------------


def _checked_message(
    message_type: type, values: Any, where: str, problems: dict[str, str]
) -> dict[str, Any] | str:
    if values == NOW and where:
        return NOW
    kinds = dict(fields_of(message_type))
    if not isinstance(values, Mapping):
        problems[where] = f"{where} takes the fields {', '.join(kinds)}, not {values!r}."
        return {}
    checked = {}
    for name, value in values.items():
        field = f"{where}.{name}" if where else name
        if name not in kinds:
            problems[field] = f"{type_name(message_type)} has no field {name}; it has {', '.join(kinds)}."
            continue
        checked[name] = _checked(value, kinds[name], field, problems)
    return checked


def _checked(value: Any, kind: Any, where: str, problems: dict[str, str]) -> Any:
    if hasattr(kind, "value_type"):
        return _checked_items(value, kind, where, problems)
    if hasattr(kind, "namespaces"):
        return _checked_message(_class_of(kind), value, where, problems)
    try:
        return _typed(value, kind)
    except _RefusedError as refusal:
        problems[where] = f"{where} takes {refusal}."
        return None


def _checked_items(value: Any, kind: Any, where: str, problems: dict[str, str]) -> list[Any]:
    if not isinstance(value, list | tuple):
        problems[where] = f"{where} takes a list, not {value!r}."
        return []
    size, most = getattr(kind, "size", None), getattr(kind, "maximum_size", None)
    if size is not None and len(value) != size:
        problems[where] = f"{where} takes exactly {size} elements, not {len(value)}."
    if most is not None and len(value) > most:
        problems[where] = f"{where} takes at most {most} elements, not {len(value)}."
    return [_checked(item, kind.value_type, f"{where}[{n}]", problems) for n, item in enumerate(value)]


class _RefusedError(Exception):
    """A value does not fit; the text says what would, and what it was."""


def _typed(value: Any, kind: Any) -> Any:
    basic = _basic(kind)
    if basic["kind"] == "string":
        return _text(value, basic["most"])
    if basic["kind"] == "bool":
        if not isinstance(value, bool):
            raise _RefusedError(f"true or false, not {value!r}")
        return value
    text = str(value).strip()
    if not text or isinstance(value, bool):
        raise _RefusedError("a number; it is empty" if not text else f"a number, not {value!r}")
    return (
        _float(text, kind.typename)
        if basic["kind"] == "float"
        else _integer(text, int(basic["low"]), int(basic["high"]))
    )


def _text(value: Any, most: int | None) -> str:
    if not isinstance(value, str):
        raise _RefusedError(f"a text, not {value!r}")
    if most is not None and len(value) > most:
        raise _RefusedError(f"at most {most} characters, not {len(value)}")
    if "\0" in value:
        raise _RefusedError("a text without the character NUL, at which ROS would cut it off")
    return value


def _integer(text: str, low: int, high: int) -> int:
    is_whole = re.fullmatch(r"[+-]?[0-9]{1,30}", text) is not None
    if not is_whole or not low <= int(text) <= high:
        raise _RefusedError(f"a whole number from {low} to {high}, not {text!r}")
    return int(text)


def _float(text: str, typename: str) -> float:
    if re.fullmatch(r"[+-]?\d+,\d*", text):
        raise _RefusedError(f"a decimal point: {text.replace(',', '.')}, not {text!r}")
    try:
        number = float(text) if "_" not in text else None
    except ValueError:
        number = None
    if number is None:
        raise _RefusedError(f"a number such as 0.5, not {text!r}")
    is_named = text.lstrip("+-").lower() in ("inf", "infinity", "nan")
    if not is_named and (math.isinf(number) or abs(number) > FLOAT_MAX[typename]):
        bits = 32 if typename == "float" else 64
        raise _RefusedError(f"a number up to ±{FLOAT_MAX[typename]:.2g} (float{bits}), not {text!r}")
    return number
