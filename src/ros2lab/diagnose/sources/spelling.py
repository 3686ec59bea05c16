"""How alike two names are."""

from __future__ import annotations

import difflib
import functools
import re
import unicodedata
from collections.abc import Iterable


def nearest(name: object, known: Iterable[object], cutoff: float = 0.7) -> str | None:
    """Return the known name that is most like `name`, None if none is; one with the same letters before any other.

    What is no text, as a key in a file may be, is like no name.
    """
    if not isinstance(name, str):
        return None
    names = {one for one in known if isinstance(one, str)}
    same = [one for one in names if one != name and _letters(one) == _letters(name)]
    if same:
        return min(same, key=lambda one: (one.startswith("_"), one))
    close = difflib.get_close_matches(name, sorted(names - {name}), n=1, cutoff=cutoff)
    return close[0] if close else None


def with_article(noun: str) -> str:
    """Return a noun with `a` or `an` before it, such as `an Odometry`, but `a UInt8`."""
    return f"{'an' if noun[:1] in tuple('AEIOaeio') else 'a'} {noun}"


def did_you_mean(name: object, known: Iterable[object]) -> str:
    """Return a sentence, or nothing, to put after another one."""
    close = nearest(name, known)
    return f" Did you mean {close}?" if close else ""


def is_near_miss(name: object, wanted: object) -> bool:
    """Return whether `name` looks like `wanted` written wrongly, and not like another name.

    One letter too few, too many or wrong, two that changed places, other case, other separators, or a number
    after it: `comand`, `cmd-vel`, `cmd_vel2`. `state` is no near miss of `status`, nor is what is no text.
    """
    return isinstance(name, str) and isinstance(wanted, str) and _is_near_miss(name, wanted)


def is_near_topic(topic: str, wanted: str) -> bool:
    """Return whether a topic is likely to be meant for another one."""
    return is_near_miss(topic, wanted) or topic.endswith(wanted) or topic == f"/{wanted.rpartition('/')[2]}"


@functools.lru_cache(maxsize=10_000)  # the same names come in each submission of a class
def _is_near_miss(name: str, wanted: str) -> bool:
    if name == wanted:
        return False
    if _letters(name) == _letters(wanted):
        return True
    if len(wanted) < 5:
        return False
    return re.sub(r"_?\d+$", "", name) == wanted or _is_one_edit(name.lower(), wanted.lower())


def _letters(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())


def _is_one_edit(one: str, other: str) -> bool:
    if len(one) > len(other):
        one, other = other, one
    if len(other) - len(one) > 1:
        return False
    start = next((n for n, pair in enumerate(zip(one, other, strict=False)) if pair[0] != pair[1]), len(one))
    rest, other_rest = one[start:], other[start:]
    if len(one) < len(other):
        return rest == other_rest[1:]
    swapped = len(rest) > 1 and rest[:2] == other_rest[1::-1]
    return rest[1:] == other_rest[1:] or (swapped and rest[2:] == other_rest[2:])


def plain_signs(text: str) -> str:
    """Return a text with the signs of a keyboard instead of those of a web page or a text program."""
    signs = {"\u2018": "'", "\u2019": "'", "\u201c": '"', "\u201d": '"', "\u201e": '"', "\u00b4": "'"}
    signs |= {"\u2013": "-", "\u2014": "-", "\u2212": "-", "\u200b": "", "\ufeff": ""}
    # Letters with an accent stay; what only looks like a sign of Python's becomes that sign.
    return "".join(
        signs.get(letter, letter if letter.isalpha() else unicodedata.normalize("NFKC", letter))
        for letter in text
    )
