"""What each program of a run published, as it noted itself, and what is said of that."""

from __future__ import annotations

import ast
import contextlib
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ros2lab.grading.evidence import Heard
from ros2lab.grading.watching.quiet import STEP
from ros2lab.rhythm import between
from ros2lab.trial.contents import leaves_of
from ros2lab.trial.sender import ENDING

if TYPE_CHECKING:
    from ros2lab.diagnose.sources.python_source import PythonSource

MOST_SHOWN, LONGEST = 3, 60  # fields and values; letters
_NO_TIME = {"sec": 0, "nanosec": 0}
LEAST_EVEN, UNEVEN = 3, 0.4  # messages of a rhythm; what its gaps may differ by, as a share of their mean


@dataclass(frozen=True)
class Sent:
    """What a program published on a topic: how many messages, and of the first and last ones when, and what."""

    count: int
    times: Sequence[float]
    values: Sequence[Any]

    @classmethod
    def of_heard(cls, stretches: Iterable[Heard]) -> Sent:
        """Return what was heard of a program that noted nothing itself."""
        heard = [*stretches]
        times, values = (
            [*chain.from_iterable(found)] for found in zip(*((h.times, h.values) for h in heard), strict=True)
        )
        return cls(sum(stretch.count for stretch in heard), times, values)


def read_sent(folder: Path, domain: str, until: float) -> dict[str, dict[str, Sent]]:
    """Return by program and topic what the programs in a domain noted, up to a time."""
    found: dict[str, dict[str, Sent]] = {}
    for file in sorted((folder / "noted").glob(f"*{ENDING}"), key=lambda path: path.stat().st_mtime):
        told: Mapping[str, Any] = {}
        with contextlib.suppress(OSError, ValueError):  # of a program that was killed while it wrote
            told = json.loads(file.read_text(encoding="utf-8"))
        if told.get("domain") == domain:
            found[Path(told["program"]).name] = {
                topic: _until(until, *sent) for topic, sent in told["sent"].items()
            }
    return found


def _until(end: float, count: int, messages: Sequence[Sequence[Any]]) -> Sent:
    """Return what was published before the program was ended, which may send a last message then."""
    kept = [(when, value) for when, value in messages if when < end]
    return Sent(count - len(messages) + len(kept), [when for when, _ in kept], [value for _, value in kept])


def even_gap(times: Sequence[float], *, is_stepped: bool) -> float:
    """Return the mean time between messages; 0 if they were few, or came at no even times."""
    gaps = between(times)
    if len(times) < LEAST_EVEN or min(gaps) <= 0:
        return 0.0
    mean = sum(gaps) / len(gaps)
    # The clock steps from message to message: a time between two is off by up to a step.
    is_even = max(gaps) - min(gaps) <= max(UNEVEN * mean, 1.05 * STEP if is_stepped else 0.0)
    return mean if is_even else 0.0


def rhythm(times: Sequence[float], *, is_stepped: bool) -> str:
    """Say in which rhythm messages came; empty if there is none."""
    gap = even_gap(times, is_stepped=is_stepped)
    if gap and len(times) == LEAST_EVEN:
        return f", about {gap:.2g} s apart"
    if gap and is_stepped and gap <= 1.05 * STEP:
        return f", one every {STEP} s or more often"
    return f", about one every {gap:.2g} s" if gap else ""


def leaves_in(values: Iterable[Any]) -> dict[str, list[Any]]:
    """Return the different values of each field of some messages."""
    found: dict[str, dict[Any, None]] = {}
    for name, leaf in chain.from_iterable(map(leaves_of, values)):
        found.setdefault(name, {})[leaf] = None
    return {name: [*leaves] for name, leaves in found.items()}


def content(values: Sequence[Any]) -> tuple[str, bool]:
    """Describe what messages hold: what varies in them, else what is set in each; and whether anything varies."""
    found = leaves_in(values)
    varied = [spread(name, leaves) for name, leaves in found.items() if len(leaves) > 1]
    if varied:
        more = ", ..." * (len(varied) > MOST_SHOWN)
        return f": {', '.join(varied[:MOST_SHOWN])}{more}", True
    held = {name: leaf for name, (leaf, *_) in found.items() if leaf or len(found) == 1}
    each = "each of them " if len(values) > 1 else ""
    if not found:
        return "", False
    return f", {each}with {fields_of(held)}" if held else f", {each}zero, false or empty", False


def unstamped(values: Sequence[Any], sources: Iterable[PythonSource]) -> str:
    """Say of messages with headers that the stamp of each is 0, its default; empty if they are few, or if code sets it."""
    stamps = [*chain.from_iterable(map(_stamps, values))]
    is_told = len(values) >= LEAST_EVEN and stamps and all(stamp == _NO_TIME for stamp in stamps)
    is_set = is_told and any(_is_of_stamp(node) for source in sources for node in source.nodes)
    return ", each with a stamp of 0" if is_told and not is_set else ""


def _is_of_stamp(node: ast.AST) -> bool:
    """Return whether code names the stamp of a message, or gives it a header."""
    is_named = isinstance(node, ast.Attribute) and node.attr == "stamp"
    is_given = isinstance(node, ast.keyword) and node.arg in ("stamp", "header")
    return (
        is_named
        or is_given
        or (isinstance(node, ast.Attribute) and node.attr == "header" and isinstance(node.ctx, ast.Store))
    )


def _stamps(value: Any) -> Iterator[Any]:
    """Yield the stamps in the header of a message, or in those of the messages that it lists."""
    if isinstance(value, dict) and isinstance(value.get("header"), dict):
        yield value["header"].get("stamp")
    elif isinstance(value, dict):
        listed = (inner for inner in value.values() if isinstance(inner, list))
        yield from chain.from_iterable(map(_stamps, chain.from_iterable(listed)))


def counted(count: int, what: str = "message") -> str:
    """Return a number with what it counts."""
    return f"{count} {what}{'s' * (count != 1)}"


def is_number(leaf: Any) -> bool:
    """Return whether a value is a number."""
    return isinstance(leaf, (int, float)) and not isinstance(leaf, bool)


def spread(name: str, leaves: Sequence[Any]) -> str:
    """Show the values of a field."""
    if len(leaves) == 1:
        return f"{name} = {value_of(leaves[0])}"
    if all(map(is_number, leaves)):
        if len(leaves) < MOST_SHOWN:
            return f"{name} {' or '.join(map(value_of, leaves))}"
        return f"{name} from {min(leaves):.3g} to {max(leaves):.3g}"
    more = " and others" * (len(leaves) > MOST_SHOWN)
    return f"{name} {', '.join(map(value_of, leaves[:MOST_SHOWN]))}{more}"


def fields_of(message: Any) -> str:
    """Show the first fields of a message, a request or a response."""
    leaves = [f"{name} = {value_of(leaf)}" for name, leaf in leaves_of(message)]
    return ", ".join(leaves[:MOST_SHOWN]) + ", ..." * (len(leaves) > MOST_SHOWN) or "without fields"


def value_of(leaf: Any) -> str:
    """Show a value; a text in quotes that are closed, with dots in them where it is cut."""
    if isinstance(leaf, str):
        return repr(leaf if len(leaf) <= LONGEST else f"{leaf[: LONGEST - 3]}...")
    if isinstance(leaf, bool) or not isinstance(leaf, (int, float)):
        return repr(leaf)[:LONGEST]
    return f"{leaf:.4g}"


@dataclass(frozen=True)
class Said:
    """What each program published, by its name and the topic: alone, and in the run of all together."""

    alone: Mapping[str, Mapping[str, Sent]]
    together: Mapping[str, Mapping[str, Sent]]


NOTHING = Said({}, {})
