"""What messages say, as plain data, without what changes by itself."""

from __future__ import annotations

import functools
import re
import unicodedata
from collections.abc import Sequence
from typing import Any

_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e-?\d+)?")

# Codes that move the cursor, colour text or rename the window (ECMA-48), or change the direction of writing; and
# text that they conceal.
_TERMINAL = re.compile(
    "(?:\x1b\\[|\x9b)(?:(?![34]8;)\\d*;)*8m[^\x1b\x9b\n]*"
    "|(?:\x1b\\[|\x9b)[0-?]*[ -/]*[@-~]?"
    "|(?:\x1b[\\]PX^_]|[\x90\x98\x9d-\x9f])[^\x07\x1b\x9c\n]*(?:\x07|\x1b\\\\|\x9c)?"
    "|\x1b[ -/]*[0-~]?"
    "|[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]"
)
_SHAPELESS = frozenset(("FILLER", "BLANK", "VARIATION", "JOINER"))  # in the names of signs that show nothing


@functools.lru_cache(maxsize=4096)
def steady(text: str) -> str:
    """Return a text without its numbers, which change by themselves."""
    return _NUMBER.sub("#", text)


def sense(values: Sequence[Any]) -> str:
    """Return what the last of some messages says, without what changes by itself."""
    last = values[-1]
    if not is_velocity(last):
        return steady(str(last))
    if is_still(last):
        return "still"
    is_steady = len(values) > 1 and values[-2] == last
    return str(last) if is_steady or len(values) == 1 else "varying"


def is_velocity(value: Any) -> bool:
    """Return whether a message is a velocity, or holds one."""
    return isinstance(value, dict) and ("linear" in value or "linear" in str(value))


def is_still(value: Any) -> bool:
    """Return whether all numbers of a message are zero."""
    if isinstance(value, dict):
        return all(is_still(inner) for key, inner in value.items() if key != "header")
    return not (_is_number(value) and float(value))


@functools.lru_cache(maxsize=4096)
def seen(text: str) -> str:
    """Return what can be seen of a text, with one space between words; empty without any sign that has a shape."""
    kept = text
    if not (text.isascii() and text.isprintable()):
        plain = unicodedata.normalize("NFC", without_codes(text))
        kept = "".join(sign for sign in plain if sign.isspace() or _has_shape(sign))
        kept = kept if any(unicodedata.category(sign)[0] in "LNPS" for sign in kept) else ""
    return " ".join(kept.split())


def _has_shape(sign: str) -> bool:
    """Return whether a letter, a mark, a digit or a symbol leaves more than a space."""
    is_sign = unicodedata.category(sign)[0] in "LMNPS"
    return is_sign and not _SHAPELESS & {*unicodedata.name(sign, "").split()}


def without_codes(text: str) -> str:
    """Return a text without what a terminal takes for codes and does not show."""
    return _TERMINAL.sub("", text)


def numbers_in(value: Any, name: str = "") -> list[tuple[str, float]]:
    """Return the numbers in a message with their fields."""
    if isinstance(value, dict):
        return [
            found
            for key, inner in value.items()
            if key != "header"
            for found in numbers_in(inner, f"{name}.{key}" if name else key)
        ]
    return [(name, float(value))] if _is_number(value) else []


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) or value in ("nan", "inf", "-inf")
