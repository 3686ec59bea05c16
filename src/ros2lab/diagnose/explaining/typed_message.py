"""Messages that were typed as YAML, corrected to match their types."""

from __future__ import annotations

import ast
import contextlib
import re
from collections.abc import Mapping
from typing import Any

from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.calls import filled
from ros2lab.diagnose.sources.spelling import nearest


def as_message(word: str, fields: Mapping[str, str]) -> str:
    """Return a message as valid YAML with the fields of its type.

    Args:
        word: what was typed.
        fields: the types of its fields, such as `string` or `geometry_msgs/Vector3`.
    """
    return _nested(word, fields) or _flowing(word, fields)


def _loaded(word: str, loader: Any) -> Any:
    """Parse a word as YAML; with the BaseLoader, every scalar stays the text that was written."""
    from portable_ros2 import bounded_yaml

    return bounded_yaml.load(re.sub(r":(?=[^\s:/])", ": ", word), loader)


def read_as(word: str, fields: Mapping[str, str]) -> tuple[str, object] | None:
    """Return the text of a string field that YAML reads as another type, and that value; else None."""
    import yaml

    try:
        read, written = _loaded(word, yaml.SafeLoader), _loaded(word, yaml.BaseLoader)
    except (yaml.YAMLError, RecursionError):
        return None
    for name, value in read.items() if isinstance(read, dict) else ():
        if fields.get(str(name)) == "string" and not isinstance(value, (str, dict, list)):
            return written[name], value
    return None


def _nested(word: str, fields: Mapping[str, str]) -> str:
    """Return a message whose inner fields were written on unindented lines, as `linear:` and then `x: 0.5`.

    Empty if it was not written so.
    """
    parts: dict[str, list[str]] = {}
    inner: Mapping[str, str] = {}
    current = ""
    for name, value in re.findall(r"^ *(\w+): *(\S*)$", word, re.MULTILINE):
        below = interfaces.fields_of(fields.get(name, "").replace("/", ".msg."))
        if below and not value:
            current, inner = name, below
            parts[name] = []
        elif current and name in inner and value:
            parts[current].append(f"{name}: {value}")
        else:
            return ""
    rows = [f"{name}: {{{', '.join(values)}}}" for name, values in parts.items()]
    return f"{{{', '.join(rows)}}}" if any(parts.values()) else ""


def _field(name: str, value: Any, written: Any, fields: Mapping[str, str]) -> str:
    """Return a field as YAML that matches its type.

    Args:
        name: its name.
        value: what YAML reads it as.
        written: the text that was written.
        fields: the types of all fields.
    """
    kind = fields.get(name, "")
    if "/" in kind and not isinstance(value, dict):
        made = filled(kind.replace("/", ".msg."), ast.Constant(value))
        made = re.sub(r"(\w+)=", r"\1: ", made[made.index("(") + 1 : -1])
        return f"{name}: {{{made.replace('x: ', 'z: ', 1) if name == 'angular' else made}}}"
    if kind == "string" and not isinstance(value, str):
        return f"{name}: '{written}'"
    if isinstance(value, bool):
        return f"{name}: {str(value).lower()}"
    return f"{name}: {value}" if value is not None else f"{name}: ''"


def _quoted(word: str, fields: Mapping[str, str]) -> str:
    """Return a message with a single string field, its value in quotes; empty for any other message."""
    match = re.fullmatch(r"\s*\{?\s*(\w+):\s*([^'\"{}]*?)\s*\}?\s*", word)
    if match is None or fields.get(match[1]) != "string":
        return ""
    return f"{{{match[1]}: '{match[2]}'}}"


def _without_dots(written: Mapping[str, Any]) -> dict[str, Any]:
    """Return fields with dotted names, such as `linear.x`, as nested dictionaries."""
    found: dict[str, Any] = {}
    for name, value in written.items():
        *outer, last = str(name).split(".")
        inner = found
        for part in outer:
            inner = inner.setdefault(part, {})
        inner[last] = value
    return found


def _in_braces(written: Any) -> str:
    if not isinstance(written, dict):
        return str(written)
    return f"{{{', '.join(f'{name}: {_in_braces(value)}' for name, value in written.items())}}}"


def _flowing(word: str, fields: Mapping[str, str]) -> str:
    """Return a message on one line, in braces."""
    import yaml

    try:
        value, written = _loaded(word, yaml.SafeLoader), _loaded(word, yaml.BaseLoader)
    except (yaml.YAMLError, RecursionError):
        if whole := _quoted(word, fields):
            return whole
        closed = word + "}" * (word.count("{") - word.count("}"))
        return word if closed == word else _flowing(closed, fields)
    if isinstance(value, dict) and any("." in str(name) for name in value):
        return _in_braces(_without_dots(written))
    first = next(iter(fields))
    if not isinstance(value, dict):
        value, written = {first: value}, {first: written}
    if len(value) == 1 and not set(value) & set(fields):
        near = nearest(str(next(iter(value))), fields, 0.5) or (first if len(fields) == 1 else "")
        value = {near: next(iter(value.values()))} if near else value
        written = {near: next(iter(written.values()))} if near else written
    if any(isinstance(inner, dict) for inner in value.values()) and word.count(":") > 1:
        return re.sub(r":(?=[^\s:/])", ": ", word)
    parts = (
        _field(str(name), inner, written[str(name)] if isinstance(written, dict) else "", fields)
        for name, inner in value.items()
    )
    text = f"{{{', '.join(parts)}}}"
    is_same = _reads_alike(text, word)
    return word if is_same and ": " in word and not read_as(word, fields) else text


def _reads_alike(text: str, other_text: str) -> bool:
    """Return whether YAML reads two texts alike, as typed values or as text; True if one is invalid."""
    import yaml

    with contextlib.suppress(yaml.YAMLError):
        return any(
            _loaded(text, kind) == _loaded(other_text, kind) for kind in (yaml.SafeLoader, yaml.BaseLoader)
        )
    return True
