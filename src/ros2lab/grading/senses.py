"""What messages say, as plain data, without what changes by itself."""

from __future__ import annotations

import functools
import re
import unicodedata
from collections.abc import Sequence
from typing import Any

_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e-?\d+)?")

_SHAPELESS = frozenset(("FILLER", "BLANK"))  # in the names of letters and symbols that leave a space


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


def is_seen(text: str) -> bool:
    """Return whether anything of a text can be seen: a letter, a digit, a sign or a symbol that has a shape."""
    return any(
        unicodedata.category(character)[0] in "LNPS"
        and not _SHAPELESS & {*unicodedata.name(character, "").split()}
        for character in text
    )


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
