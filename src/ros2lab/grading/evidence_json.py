"""Evidence as JSON, and back without loss.

JSON has only finite numbers: others are written as `{"$float": "nan"}`. Python refuses to write integers with
thousands of digits: they are written as `{"$int": "0x..."}`. A name that begins with `$` gets a second `$`.
"""

from __future__ import annotations

import dataclasses
import functools
import json
import math
import types
import typing
from collections.abc import Mapping
from typing import Any, cast

from ros2lab.grading.evidence import SCHEMA, Evidence

_FLOAT, _INT = "$float", "$int"
_LONGEST_INT = 2000  # bits
_WORDS = {
    str: "a text",
    int: "a whole number",
    float: "a number",
    bool: "true or false",
    list: "a list",
    dict: "an object",
    type(None): "null",
}


_GONE = frozenset(("paces", "tried"))  # fields of older evidence that nothing asks for any more


class EvidenceError(Exception):
    """A text that is no evidence, or not of this version; the message says where, and what to do."""


def evidence_json(evidence: Evidence) -> str:
    """Return evidence as JSON: ASCII only, so that nothing in it acts on a terminal.

    Raises:
        TypeError: if it holds a value that JSON cannot hold, such as a date; the message names the place.
    """
    return json.dumps(plain(evidence, ""), allow_nan=False) + "\n"


def read_evidence(text: str) -> Evidence:
    """Read what `evidence_json` wrote.

    Raises:
        EvidenceError: if it is no evidence, or has another schema.
    """
    try:
        data = json.loads(text, object_hook=restored if '"$' in text else None)
    except (ValueError, RecursionError, TypeError) as error:
        raise EvidenceError(f"This is no evidence, for it is not JSON ({error}); grade again.") from None
    if not isinstance(data, dict) or not isinstance(data.get("schema"), int):
        raise EvidenceError(
            "This is no evidence, for it does not say its schema; give a file of `ros2lab grade --evidence`."
        )
    if data["schema"] != SCHEMA:
        age = "newer" if data["schema"] > SCHEMA else "older"
        raise EvidenceError(
            f"This evidence is {age} than this ros2lab (schema {data['schema']}, not {SCHEMA}); grade again."
        )
    return cast("Evidence", typed(data, Evidence, ""))


def plain(value: Any, path: str) -> Any:
    """Return a value in the evidence as plain data that strict JSON can hold.

    Args:
        value: the value, such as a dataclass with everything in it.
        path: its place in the evidence, for messages.

    Raises:
        TypeError: as for `evidence_json`.
    """
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {
            name: plain(getattr(value, name), f"{path}.{name}" if path else name)
            for name in _fields(type(value))
        }
    if isinstance(value, dict):
        for name in value:
            if not isinstance(name, str):
                raise TypeError(
                    f"Evidence cannot be written: a name in {path or 'it'} is no text but {name!r}."
                )
        return {
            f"${name}" if name.startswith("$") else name: plain(inner, f"{path}.{name}" if path else name)
            for name, inner in value.items()
        }
    if isinstance(value, list):
        return [plain(item, f"{path}[{index}]") for index, item in enumerate(value)]
    if isinstance(value, float) and not math.isfinite(value):
        return {_FLOAT: str(value)}
    if isinstance(value, int) and value.bit_length() > _LONGEST_INT:
        return {_INT: hex(value)}
    if value is None or isinstance(value, (str, int, float)):
        return value
    raise TypeError(f"Evidence cannot be written: JSON has no {type(value).__name__}, as at {path}.")


def restored(data: dict[str, Any]) -> Any:
    """Undo `plain` for a JSON object."""
    if not any(name.startswith("$") for name in data):
        return data
    if data.keys() == {_FLOAT}:
        return float(data[_FLOAT])
    if data.keys() == {_INT}:
        return int(data[_INT], 16)
    return {name[1:] if name.startswith("$") else name: value for name, value in data.items()}


def typed(data: Any, wanted: Any, path: str) -> Any:
    """Return plain data, as `plain` made it and `restored` read it, as the wanted type.

    Raises:
        EvidenceError: if the data do not fit.
    """
    origin, parts = _shape(wanted)
    if origin is Evidence:
        return _read_fields(data, wanted, path)
    if origin is typing.Literal:
        if data not in parts:
            raise _unfit(path, " or ".join(parts), data)
    elif origin in (types.UnionType, typing.Union):  # of a type and None, or of plain types
        kinds = [part for part in parts if part is not type(None)]
        if len(kinds) == 1:
            return None if data is None else typed(data, kinds[0], path)
        if not any(_is_a(data, part) for part in parts):
            raise _unfit(path, " or ".join(_WORDS[part] for part in parts), data)
    elif origin is list:
        _check(data, list, path)
        if parts[0] is not Any and set(map(type, data)) - {
            parts[0]
        }:  # long lists of texts and numbers at once
            return [typed(item, parts[0], f"{path}[{index}]") for index, item in enumerate(data)]
    elif origin is dict:
        _check(data, dict, path)
        if parts[1] is not Any:
            return {name: typed(inner, parts[1], f"{path}.{name}") for name, inner in data.items()}
    elif origin is not Any:
        _check(data, wanted, path)
    return data


@functools.cache
def _shape(wanted: Any) -> tuple[Any, tuple[Any, ...]]:
    """Return a type's origin (`Any` for Any, `Evidence` for any dataclass) and its arguments."""
    if wanted is Any:
        return Any, ()
    if dataclasses.is_dataclass(wanted):
        return Evidence, ()
    return typing.get_origin(wanted), typing.get_args(wanted)


def _read_fields(data: Any, wanted: Any, path: str) -> Any:
    _check(data, dict, path)
    fields = _fields(wanted)
    values = {}
    for name, (kind, is_needed) in fields.items():
        if name in data:
            values[name] = typed(data[name], kind, f"{path}.{name}" if path else name)
        elif is_needed:
            raise EvidenceError(f"This evidence does not fit: {_at(path)} has no {name}; grade again.")
    for name in data:
        if name not in fields and name not in _GONE:
            raise EvidenceError(
                f"This evidence does not fit: {_at(path)} has {ascii(name)[:100]}, which is not known; grade again."
            )
    return wanted(**values)


@functools.cache
def _fields(wanted: Any) -> Mapping[str, tuple[Any, bool]]:
    """Return by field of a dataclass its type, and whether it is required."""
    hints = typing.get_type_hints(wanted)
    return {
        field.name: (
            hints[field.name],
            field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING,
        )
        for field in dataclasses.fields(wanted)
    }


def _check(data: Any, kind: type, path: str) -> None:
    if not _is_a(data, kind):
        raise _unfit(path, _WORDS[kind], data)


def _is_a(data: Any, kind: type) -> bool:
    return type(data) is kind or (kind is float and type(data) is int)  # in JSON a float may look like an int


def _unfit(path: str, wanted: str, data: Any) -> EvidenceError:
    return EvidenceError(
        f"This evidence does not fit: {_at(path)} must be {wanted}, and is {_WORDS[type(data)]}; grade again."
    )


def _at(path: str) -> str:
    return ascii(path)[1:-1][:300] or "the whole"
