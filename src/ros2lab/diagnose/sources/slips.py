"""Undo a slip of typing: of all small changes after which a parser reads further, the likeliest."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

ALL = float("inf")  # stands for the line at which a parser stops that reads everything
# What a change costs, from a sign that is easily left out to what only helps by chance.
USUAL, SELDOM, RARE = 1.0, 1.6, 2.4
_MOST_READ = 6_000_000  # characters to parse in all attempts
_MOST_COST = 4.0  # a change that costs more is not what was meant
_MOST_CHECKED = 25  # of the changes that help equally, those of which it is tried whether the whole is right


@dataclass(frozen=True)
class Slip:
    """A change that may undo a slip of typing.

    Attributes:
        text: the whole text that comes of it.
        cost: how seldom that slip is made.
        why: what was wrong, as the rest of a sentence; empty if the parser says it better.
    """

    line: int
    told: str
    text: str
    cost: float = USUAL
    why: str = ""


@dataclass(frozen=True)
class Vocabulary:
    """The tags, or keys, that a kind of file may have.

    Attributes:
        tags: those that are known.
        inner: those that are known inside some of them only, by tag; those of "" begin the file.
        texts: those that hold only text.
        opened: how those begin that need attributes, by tag.
    """

    tags: Collection[str]
    inner: Mapping[str, Collection[str]] = field(default_factory=dict)
    texts: Collection[str] = ()
    opened: Mapping[str, str] = field(default_factory=dict)

    def knows(self, tag: str, above: str) -> bool:
        """Return whether a tag may be inside another."""
        return tag in self.inner.get(above, self.tags)

    @property
    def words(self) -> list[str]:
        """All tags, the likeliest first."""
        return [*dict.fromkeys([*self.tags, *(tag for tags in self.inner.values() for tag in tags)])]


class Lines:
    """The lines of a text, which slips change."""

    def __init__(self, text: str) -> None:
        self.all = text.split("\n")

    def __getitem__(self, number: int) -> str:
        return self.all[number - 1]

    def written(self, number: int, new: str, why: str = "", cost: float = USUAL) -> Slip:
        """Return the change of a line to another."""
        told = f"write `{new.strip()}`"
        was, depth = len(self[number]) - len(self[number].lstrip()), len(new) - len(new.lstrip())
        if was != depth or "\t" in self[number][:was]:
            told += f", beginning with {depth} spaces" if depth else ", at the very beginning of the line"
        return Slip(number, told, self._with(number, 1, new), cost, why)

    def added(self, number: int, new: str, why: str = "", cost: float = SELDOM) -> Slip:
        """Return the addition of a line below another."""
        told = f"add `{new.strip()}` {'below' if number else 'above'} this line"
        return Slip(max(number, 1), told, self._with(number + 1, 0, new), cost, why)

    def removed(self, number: int, cost: float = RARE) -> Slip:
        """Return the removal of a line."""
        return Slip(number, "remove this line", self._with(number, 1), cost)

    def _with(self, number: int, count: int, *new: str) -> str:
        return "\n".join([*self.all[: number - 1], *new, *self.all[number - 1 + count :]])


def likeliest(
    text: str,
    slips: Iterable[Slip],
    reach: Callable[[str], float],
    oddness: Callable[[str], float] = lambda _: 0,
    is_right: Callable[[str], bool] = lambda _: True,
) -> Slip | None:
    """Return the change after which a text is read furthest, and of several the likeliest; None if none helps.

    Args:
        text: what cannot be read, or not all of it.
        slips: what to try, the nearest to the fault first.
        reach: the parser: at which line it stops, `ALL` if it reads everything.
        oddness: how little sense a text makes, in the unit of a change's cost.
        is_right: whether a text that is read to its end is right in what its parser does not know, too.
    """
    start = reach(text)
    reached, best = start, list[Slip]()
    for slip in _some(slips, text):
        stops = reach(slip.text)
        if stops > max(reached, slip.line):
            reached, best = stops, []
        if stops == reached > max(start, slip.line):
            best.append(slip)
    costs = [(slip.cost + oddness(slip.text), slip) for slip in best]
    ranked = [slip for cost, slip in sorted(costs, key=lambda found: found[0]) if cost <= _MOST_COST]
    checked = ranked[:_MOST_CHECKED] if reached == ALL else ()
    return next((slip for slip in checked if is_right(slip.text)), next(iter(ranked), None))


def _some(slips: Iterable[Slip], text: str) -> Iterator[Slip]:
    """Yield as many changes as can be tried in a moment, the cheapest of those that come to the same text."""
    found: dict[str, Slip] = {}
    for slip in slips:
        if slip.text not in found or slip.cost < found[slip.text].cost:
            found[slip.text] = slip
    left = _MOST_READ
    for slip in found.values():
        left -= len(slip.text)
        if left < 0:
            return
        if slip.text != text:
            yield slip
