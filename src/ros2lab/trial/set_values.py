"""What came of parameters that were set while nodes ran, as it was seen from outside."""

from __future__ import annotations

import ast
import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from ros2lab.diagnose.finding import in_a_row
from ros2lab.diagnose.look import Look
from ros2lab.grading.code.compared import compared
from ros2lab.trial.spoken import even_gap, leaves_in, spread, value_of

MOST_SHOWN, COUNTS = 2, 0.35  # changes; the share by which numbers of messages differ that are no chance
Trait = tuple[str, str]  # a topic and a field, with no field for how often; or no topic and a line of the log
Change = tuple[Trait, Any, Any]  # what was so before and after


@dataclass(frozen=True)
class Setting:
    """A parameter that was set to another value while its node ran, and back.

    Attributes:
        taken: whether both were taken; None if only one was, and `reason` is why in the node's words.
        changes: what differed from before only while it had the other value; `late` only once it had its own again.
        is_idle: whether both were taken, and all was as before.
        at_start: what differs from before if the node is started with the other value.
    """

    node: str
    name: str
    shown: str
    value: Any
    taken: bool | None
    reason: str
    changes: Sequence[Change]
    late: Sequence[Change]
    is_idle: bool
    at_start: Sequence[Change] = ()


def compared_words(look: Look) -> list[list[str]] | None:
    """Return the texts that the code compares, each group after the name of what is compared; None without parameters."""
    found: dict[str, dict[str, None]] = defaultdict(dict)
    sources = [source for package in look.packages for source in look.sources(package).sources.values()]
    for node in (node for source in sources for node in source.nodes):
        if isinstance(node, (ast.Compare, ast.Match, ast.Dict)):
            what = ast.unparse(getattr(node, "left", getattr(node, "subject", node)))
            name = re.search(r"get_parameter\('([^']+)'\)|(\w+)(?:\.value)?$", what)
            words = compared(case.pattern for case in getattr(node, "cases", ())) or compared([node])
            found[(name[1] or name[2]) if name else what] |= dict.fromkeys(words)
    is_there = any("declare_parameter" in source.text for source in sources)
    return [[name, *words] for name, words in found.items() if words] if is_there else None


def settings_of(result: Mapping[str, Any]) -> Iterator[Setting]:
    """Yield what was set, by what the observer has told."""
    for (node, name), made in groupby(result.get("sets", ()), lambda one: (one["node"], one["name"])):
        *others, back = made
        if others and back["back"]:  # not where the program ended before
            there = others[-1]
            news, olds = (_changes(result, one) if one["taken"] else {} for one in (there, back))
            changes = [one for key, one in news.items() if key not in olds and _is_sure(*one)]
            taken = there["taken"] if there["taken"] == back["taken"] else None
            late = [one for one in olds.values() if taken and not news and _is_sure(*one)]
            reason, is_idle = there["reason"] or back["reason"], bool(taken) and not (news or olds)
            value, shown = there["value"], f"{name} = {value_of(there['value'])}"
            yield Setting(node, name, shown, value, taken, reason, changes, late, is_idle)


def started_with(result: Mapping[str, Any], other: Mapping[str, Any]) -> list[Change]:
    """Return what surely differs between what the observer has told of two runs, before anything was set."""
    first, *others = (_changes(result, heard) for heard in other.get("controls") or result["controls"])
    is_whole = len(others) == len(result["controls"]) - 1
    return [
        one for key, one in first.items() if is_whole and all(key in o for o in others) and _is_sure(*one)
    ]


def _changes(result: Mapping[str, Any], heard: Mapping[str, Any]) -> dict[Trait, Change]:
    """Return what differs from all that was always the same before anything was set; first the contents of messages."""
    first, *others, now = map(_traits, (*result["controls"], heard))
    found = dict[Trait, Change]()
    for key in sorted({*first, *now}, key=lambda trait: (not trait[0], not trait[1], trait)):
        was, new = first.get(key), now.get(key)
        if _differ(was, new) and not any(_differ(was, one.get(key)) for one in others):
            found[key] = key, was, new
    return found


def _traits(heard: Mapping[str, Any]) -> dict[Trait, Any]:
    """Return what was published on each topic: how many messages, the time between them, each field's values; and the log."""
    lines = Counter(re.sub(r"[\d.]+", "#", line[-1]) for line in heard["log"])
    found: dict[Trait, Any] = {("", line): line for line, count in lines.items() if count > 1}
    for topic, part in heard["topics"].items():
        found[topic, ""] = part["count"], even_gap(part["times"], is_stepped=True)
        for name, leaves in leaves_in(part["values"]).items():
            rows = [leaf.split() if isinstance(leaf, str) else [leaf] for leaf in leaves]
            is_text = len({*map(len, rows)}) == 1 and len(rows[0]) > 1  # a number in it may change by itself
            for place, values in enumerate(zip(*rows, strict=True) if is_text else [leaves]):
                found[topic, f"word {place + 1} of {name}" if is_text else name] = frozenset(values)
    return found


def _differ(was: Any, now: Any) -> bool:
    if isinstance(was or now, tuple):  # how many messages came; one more or less is chance
        old, new = (found[0] if found else 0 for found in (was, now))
        return bool(abs(old - new) > max(1, COUNTS * max(old, new)))
    return bool(was != now if isinstance(was or now, frozenset) else (was is None) != (now is None))


def _is_sure(_trait: Trait, was: Any, now: Any) -> bool:
    """Return whether a difference is no chance, as it is where a program is late once."""
    return not isinstance(was or now, tuple) or bool(was and now and was[1] and now[1])


def told(changes: Sequence[Change]) -> str:
    """Say what differs."""
    return in_a_row([_told(*change) for change in changes[:MOST_SHOWN]])


def _told(trait: Trait, was: Any, now: Any) -> str:
    topic, name = trait
    if not topic:
        return f"{value_of(now or was)} is {'' if now else 'no longer '}logged"
    if name:
        old, new = (spread(name, sorted(found, key=str)) if found else "nothing" for found in (was, now))
        return f"{new} comes on {topic} instead of {old}"
    return f"a message comes on {topic} every {now[1]:.2g} s instead of {was[1]:.2g} s"
