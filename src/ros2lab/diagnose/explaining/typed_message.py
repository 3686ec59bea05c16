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
    """Return a message as valid YAML with the fields of its type, such as `string` or `geometry_msgs/Vector3`."""
    return _nested(word, fields) or _flowing(word, fields)


def _loaded(word: str, loader: Any) -> Any:
    """Parse a word as YAML; with the BaseLoader, every scalar stays the text that was written."""
    from portable_ros2 import bounded_yaml

    return bounded_yaml.load(re.sub(r":(?=[^\s:/])", ": ", word), loader)


def _read(word: str) -> tuple[Any, Any] | None:
    """Return a word as YAML reads it, and with each scalar as the text that was written; None if it is invalid."""
    import yaml

    try:
        return _loaded(word, yaml.SafeLoader), _loaded(word, yaml.BaseLoader)
    except (yaml.YAMLError, RecursionError):
        return None


def read_as(word: str, fields: Mapping[str, str]) -> tuple[str, object] | None:
    """Return the text of a string field that YAML reads as another type, and that value; else None."""
    read, written = _read(word) or ({}, {})
    for name, value in read.items() if isinstance(read, dict) else ():
        if fields.get(str(name)) == "string" and not isinstance(value, (str, dict, list)):
            return written[name], value
    return None


def misfit(word: str, fields: Mapping[str, str]) -> str:
    """Say why a text is no message: no YAML, a field that its type lacks, or a value in place of a message; else empty."""
    read = _read(word)
    if read is None:
        return "The message is not valid YAML: on one line, its fields stand in braces, with commas between them, and a string with other signs in quotes."
    return _misfit("The message", read[0], fields) if isinstance(read[0], dict) else ""


def _misfit(owner: str, read: Mapping[Any, Any], fields: Mapping[str, str]) -> str:
    given = {str(name): value for name, value in read.items()}
    strange = [name for name in given if name.partition(".")[0] not in fields]
    if strange:
        return f"{owner} has no field {' or '.join(strange)}; its fields are {', '.join(fields)}."
    for name, value in given.items():
        inner = interfaces.fields_of(fields.get(name, "").replace("/", ".msg."))
        if not inner:
            continue
        if not isinstance(value, dict):
            is_what = "is empty" if value is None else f"is {value!r}"
            return f"{name} {is_what}, but it is a message itself, with the fields {', '.join(inner)}."
        if deeper := _misfit(name, value, inner):
            return deeper
    return ""


def _nested(word: str, fields: Mapping[str, str]) -> str:
    """Return a message whose inner fields were written on lines without an indent, as `x: 0.5`; empty for others."""
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
    """Return a field as YAML that matches its type."""
    kind = fields.get(name, "")
    inner = interfaces.fields_of(kind.replace("/", ".msg."))
    if inner and isinstance(value, list) and len(value) <= len(inner):
        value, written = dict(zip(inner, value, strict=False)), dict(zip(inner, written, strict=False))
    if inner and value is None:
        value, written = {next(iter(inner)): 0.0}, {}
    if inner and isinstance(value, dict):
        return f"{name}: {_fields(value, written, inner)}"
    if "/" in kind and not isinstance(value, (dict, list)):
        made = filled(kind.replace("/", ".msg."), ast.Constant(value))
        made = re.sub(r"(\w+)=", r"\1: ", made[made.index("(") + 1 : -1])
        return f"{name}: {{{made.replace('x: ', 'z: ', 1) if name == 'angular' else made}}}"
    if kind == "string" and not isinstance(value, str):
        return f"{name}: '{written}'"
    if isinstance(value, bool):
        return f"{name}: {str(value).lower()}"
    return f"{name}: {_in_braces(written or value)}" if value is not None else f"{name}: ''"


def _fields(value: Mapping[Any, Any], written: Any, fields: Mapping[str, str]) -> str:
    """Return the fields of a message as YAML in braces; each that its type does not have as the one it resembles."""
    texts = written if isinstance(written, dict) else {}
    parts = []
    for name, inner in ((str(name), inner) for name, inner in value.items()):
        free = [field for field in fields if field not in value]
        meant = nearest(name, free, 0.5) or (free[0] if len(fields) == len(free) == 1 else name)
        parts.append(_field(name if name in fields else meant, inner, texts.get(name, ""), fields))
    return f"{{{', '.join(parts)}}}"


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
    if isinstance(written, list):
        return f"[{', '.join(map(_in_braces, written))}]"
    if not isinstance(written, dict):
        return str(written)
    return f"{{{', '.join(f'{name}: {_in_braces(value)}' for name, value in written.items())}}}"


def _flowing(word: str, fields: Mapping[str, str]) -> str:
    """Return a message on one line, in braces."""
    both = _read(word)
    if both is None:
        if whole := _quoted(word, fields):
            return whole
        open_ = word.count("{") - word.count("}")
        closed = word[:open_] if open_ < 0 else word + "}" * open_
        spaced = re.sub(r"\s*=\s*", ": ", closed.replace("\t", " "))
        tried = (closed, f"{{{closed}}}", spaced, f"{{{spaced}}}")
        better = next((text for text in tried if isinstance((_read(text) or word)[0], dict)), "")
        return _flowing(better, fields) if better else word
    value, written = both
    if isinstance(value, dict) and any("." in str(name) for name in value):
        return _in_braces(_without_dots(written))
    first = next(iter(fields))
    if not isinstance(value, dict):
        value, written = {first: value}, {first: written}
    text = _fields(value, written, fields)
    is_same = _reads_alike(text, word) and _is_spaced(word)
    return word if is_same and ": " in word and not read_as(word, fields) else text


def _is_spaced(word: str) -> bool:
    """Return whether YAML itself reads a text as it is read here, with a space after each colon."""
    import yaml

    from portable_ros2 import bounded_yaml

    with contextlib.suppress(yaml.YAMLError):
        return bool(bounded_yaml.load(word, yaml.SafeLoader) == _loaded(word, yaml.SafeLoader))
    return False


def _reads_alike(text: str, other_text: str) -> bool:
    """Return whether YAML reads two texts alike, as typed values or as text; True if one is invalid."""
    both, others = _read(text), _read(other_text)
    return both is None or others is None or both[0] == others[0] or both[1] == others[1]
