"""What changed in what a program publishes when it was given something: what it published before and after."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

from ros2lab.every_node import HIDDEN_TOPICS, OF_MANAGED
from ros2lab.grading.evidence import Run
from ros2lab.grading.watching.quiet import STEP
from ros2lab.trial.spoken import MOST_SHOWN, Sent, content, counted, even_gap, is_number, leaves_in, spread
from ros2lab.trial.story import own_ends, pace_of, sent_by

if TYPE_CHECKING:
    from ros2lab.trial.given import GivenRun
    from ros2lab.trial.seen import Seen

AT_ONCE = 0.05  # s after which a program has taken what it was given
LEAST = 2  # messages that are no chance
OTHER = 1.6  # times, of a period that has changed
MOST_VALUES = 4  # that are given, of which each is told
_Given = Sequence[tuple[float, str, Any]]  # when what was given, each with the topic or service


def did_given(seen: Seen, run: Run, given: GivenRun, taken: Sequence[str], *, is_over: bool) -> list[str]:
    """Say of each topic of a program what it published on it when it was given something, and what before.

    Args:
        seen: all other runs.
        run: the run of this program alone.
        given: the run in which it was given something.
        taken: the topics and services on which it was.
        is_over: whether it ended then, so that it may have published nothing for that reason.
    """
    before, noted, texts = sent_by(seen, run), given.sent.get(run.programs[0], {}), list[str]()
    after = {**_heard_then(run, given), **noted}
    for topic in own_ends(run, given.run.publishes, run.publishes):
        if topic in HIDDEN_TOPICS or topic.endswith(OF_MANAGED):
            continue
        was, now = before.get(topic), after.get(topic)
        if now is not None and now.count:
            pace = _pace(pace_of(seen, run, topic)[0], now)
            when = given.when if topic in noted else ()  # what was heard is on the clock of the run
            own = run.quiet[topic].values if topic in run.quiet else ()
            varies = any(len(leaves) > 1 for leaves in leaves_in(own).values())
            texts.append(_change(topic, was, now, when, taken, pace=pace, varies=varies))
        elif not is_over:
            texts.append(_more_nothing(seen, run, topic, was, given))
    # First what changed.
    return sorted(filter(None, texts), key=lambda text: " as before" in text or text.startswith("went on"))


def _heard_then(run: Run, given: GivenRun) -> Mapping[str, Sent]:
    """Return what was heard on topics on which only the nodes of a program publish, when it was given something."""
    own, among = {*run.nodes}, given.run
    return {
        t: Sent.of_heard([found])
        for t, found in among.quiet.items()
        if own.issuperset(among.publishes.get(t, ()))
    }


def _more_nothing(seen: Seen, run: Run, topic: str, was: Sent | None, given: GivenRun) -> str:
    """Return what is said of a topic on which nothing was published."""
    gap, pace = pace_of(seen, run, topic)
    seconds = given.when[-1][0] - given.when[0][0] if given.when else 0.0
    if was is None:
        return f"still published nothing on {topic}"
    if 0 < gap < seconds / 2:
        return f"published nothing more on {topic} in {seconds:.1f} s (before: {pace.removeprefix(', ')})"
    return f"published nothing on {topic} in that short time, which may be chance"


def _pace(gap: float, now: Sent) -> str:
    """Say whether messages came more or less often than before, if both are known; `gap` is the time between those before."""
    new = even_gap(now.times, is_stepped=False)
    if not new or gap <= 2 * STEP:  # the clock is stepped no finer
        return ""
    if max(new / gap, gap / new) < OTHER:
        return ", as often as before"
    return f", now one every {new:.2g} s instead of {gap:.2g} s"


def _change(
    topic: str,
    was: Sent | None,
    now: Sent,
    given: _Given,
    taken: Sequence[str],
    *,
    pace: str,
    varies: bool,
) -> str:
    """Return what is said of a topic on which something was published, where it may vary before anything is sent."""
    many, text = f"published {counted(now.count)} on {topic}", content(now.values)[0]
    if parts := [*_by_given(was, now, given, taken)]:
        return f"{many}: {'; '.join(parts)}"
    if was is None:
        return f"{many}{text}"
    before, after = leaves_in(was.values), leaves_in(now.values)
    changed = [
        name
        for name, leaves in after.items()
        if not {*leaves} <= {*before.get(name, ())}
        and not (len(before.get(name, ())) > 1 and all(map(is_number, leaves)))
    ]
    if changed:
        names = changed[:MOST_SHOWN]
        new, old = (
            ", ".join(spread(name, found[name]) for name in names if name in found)
            for found in (after, before)
        )
        return f"{many}: {new} (before that {old or 'nothing of it'})"
    if varies:
        return f"went on publishing on {topic}{pace}, where its values vary by themselves"
    # What varied only after something was sent does not tell what is as before.
    is_fixed = all(len(leaves) == 1 for leaves in before.values())
    return f"{many} as before{text}{pace}" if is_fixed else f"{many}{text}{pace}"


def _by_given(was: Sent | None, now: Sent, given: _Given, taken: Sequence[str]) -> list[str]:
    """Return what a program published after each value that it was given on a topic or service, if that depends on it."""
    before = leaves_in(was.values if was else ())
    for name in taken:
        steps = [(when, leaves_in([value])) for when, topic, value in given if topic == name]
        if any(len(leaves) != 1 for _, leaves in steps):
            continue
        texts = [(when, spread(*next(iter(leaves.items())))) for when, leaves in steps]
        values = [*dict.fromkeys(text for _, text in texts)]
        found = [_after(text, texts, now) for text in values] if 1 < len(values) <= MOST_VALUES else []
        differing = _differing(found)
        is_own = any(len(before.get(field, ())) > 1 for field in differing)  # it also varies by itself
        if differing and not is_own and all(span.is_enough(found) for span in found):
            where = f" on {name}" if len(taken) > 1 else ""
            return [
                f"{span.told(differing)} after {text}{where}"
                for text, span in zip(values, found, strict=True)
            ]
    return []


def _differing(found: Sequence[_Span]) -> list[str]:
    """Return the fields that differ from one value given to another; none if one of them varied after the same value."""
    fields = {field for span in found for field in span.fields}
    differing = sorted(field for field in fields if len({str(span.fields.get(field)) for span in found}) > 1)
    is_clear = all(len(span.fields.get(field, [None])) == 1 for span in found for field in differing)
    return differing if is_clear else []


@dataclass(frozen=True)
class _Span:
    """What was published in all the time after one value and before another: by field, how often, and in how many s."""

    fields: Mapping[str, Sequence[Any]]
    count: int
    seconds: float

    def is_enough(self, found: Sequence[_Span]) -> bool:
        """Return whether it is no chance: several messages came, or none in a time in which others bring several."""
        rate = max((span.count / span.seconds for span in found if span.seconds), default=0.0)
        return self.count >= LEAST or (not self.count and self.seconds * rate > 2 * LEAST)

    def told(self, names: Sequence[str]) -> str:
        """Say what some fields held."""
        told = (spread(name, self.fields[name]) for name in names[:MOST_SHOWN] if name in self.fields)
        return ", ".join(told) or "nothing"


def _after(text: str, steps: Sequence[tuple[float, str]], now: Sent) -> _Span:
    """Return what was published after a value was given and before another was.

    What came at once may be older, and is left out if more came later.
    """
    later, first, seconds = list[Any](), list[Any](), 0.0
    for (begin, given), (end, _) in zip_longest(steps, steps[1:], fillvalue=(now.times[-1], "")):
        if given == text:
            seconds += max(0.0, end - begin - AT_ONCE)
            for when, value in zip(now.times, now.values, strict=False):
                if begin < when <= end:
                    (later if when > begin + AT_ONCE else first).append(value)
    return _Span(leaves_in(later or first), len(later or first), seconds)
