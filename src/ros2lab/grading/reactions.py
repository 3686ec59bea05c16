"""What follows a command in a run, less what would follow any: pure functions over what was recorded."""

from __future__ import annotations

import functools
import itertools
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

from ros2lab.assignments import Part
from ros2lab.grading.evidence import CommandSeen, Heard, Run

_WARNINGS = frozenset(("WARN", "ERROR", "FATAL"))
_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e-?\d+)?")


Change = tuple[str, str]  # a topic or a parameter, and what it says then


def effects_of(
    part: Part,
    run: Run,
    alone: Mapping[str, Heard],
    *,
    has_own_log: bool,
    echoes: Collection[Change] = (),
) -> dict[str, str]:
    """Tell of each word whether it was `processed`, only `echoed`, or `refused` as unknown words are.

    Of words that nothing follows it tells nothing.

    Args:
        part: that takes the words.
        run: in which they were said.
        alone: what comes on each topic by itself.
        has_own_log: whether the log is the node's own.
        echoes: changes that only repeat a word, as other runs have shown.
    """
    found: dict[str, str] = {}
    by_text = {one.text: one for one in reversed(run.commands)}  # the first of each
    said = {word: templates(run, by_text[word]) for word in part.commands if word in by_text}
    known = set[str]().union(*said.values())
    unknown = _control(part, run)
    # What is said of an unknown word alone shows that the others are known.
    refuses = bool(unknown - known - said_by_itself(run))
    is_arbitrary = logs_arbitrarily(part, run)
    for word in said:
        one = by_text[word]
        own = {_template(line, word) for line in telling_lines(part, run, word)} if has_own_log else set()
        if not one.is_alive and unknown_word(part) not in by_text:
            own -= set[str].intersection(
                known, *said.values()
            )  # that it was heard, but not that it was obeyed
        elsewhere = set[str]().union(*(lines for other, lines in said.items() if other != word))
        # A line that this word shares with unknown ones, and with no other word, says that it is not known.
        is_refused = bool(unknown & (_warnings(run, one) | (own - elsewhere)))
        is_apart = not is_arbitrary and (own - unknown or (own and refuses))
        if changes(part, run, one, alone, echoes) or is_apart:
            found[word] = "processed"
        elif own:
            found[word] = "refused" if is_refused else "echoed"
    return found


def _control(part: Part, run: Run) -> set[str]:
    """Return what is said of an unknown word each time that it comes.

    It comes while the robot stands, and while it moves: what is said only one of the times tells of the robot's state.
    """
    said = _by_unknown(part, ((one.text, templates(run, one)) for one in run.commands))
    return set[str]().union(
        *(
            set.intersection(*filter(None, times))
            for text, times in said.items()
            if any(times) and (len(times) > 1 or text == unknown_word(part))
        )
    )


def _by_unknown(part: Part, seen: Iterable[tuple[str, set[Any]]]) -> dict[str, list[set[Any]]]:
    """Return by unknown word what was seen after it, each time."""
    found: dict[str, list[set[Any]]] = {}
    for text, what in seen:
        if text and text in part.unknown:
            found.setdefault(text, []).append(what)
    return found


def _warnings(run: Run, one: CommandSeen) -> set[str]:
    """Return what was said after a command as a warning."""
    return {_template(_line(run, text), one.text) for level, text in one.log if level in _WARNINGS}


def is_followed(run: Run, alone: Mapping[str, Heard], *, has_own_log: bool = True) -> bool:
    """Return whether anything at all follows a command that does not come by itself."""
    return any(
        command.parameters
        or any(changed(run, command, alone))
        or (has_own_log and lines_of(run, command) - said_by_itself(run))
        for command in run.commands
    )


def unknown_word(part: Part) -> str:
    """Return the first unknown text that is not empty."""
    return next(filter(None, part.unknown), "")


def lines_of(run: Run, one: CommandSeen) -> set[str]:
    """Return what was said after a command, without what a program prints when it dies of it."""
    return {_line(run, text) for level, text in one.log if one.is_alive or level != "PRINT"}


def telling_lines(part: Part, run: Run, word: str) -> set[str]:
    """Return the lines after a command that do not come whatever the command is.

    What came before any command, and comes after another one as well, comes by itself; but what was said once
    before, and follows no unknown word, tells of a state that a command brings back.
    """
    said = {
        one.text: lines_of(run, one)
        for one in reversed(run.commands)
        if one.text in (*part.commands, *part.unknown)
    }
    if word not in said:
        return set()
    if logs_arbitrarily(part, run):  # only the word itself tells of it
        said[word] = {line for line in said[word] if "{}" in _template(line, word)}
    common = set.intersection(*(lines for text, lines in said.items() if text)) if len(said) > 1 else set()
    others = set().union(*(lines for text, lines in said.items() if text != word))
    after_unknown = set().union(*(lines for text, lines in said.items() if text in part.unknown))
    again = {line for line, count in Counter(_line(run, text) for _, text in run.log).items() if count > 1}
    return said[word] - common - (others & again) - (after_unknown & said_by_itself(run))


def said_by_itself(run: Run) -> set[str]:
    """Return the lines that came before any command."""
    return {_line(run, text) for _, text in run.log}


def _line(run: Run, text: str) -> str:
    """Return a line without its numbers, and without what was typed at a keyboard meanwhile."""
    return _steady(re.sub(_any_of(frozenset(run.typed)), "…", text) if run.typed else text)


def _steady(text: str) -> str:
    """Return a text without its numbers, which change by themselves."""
    return _NUMBER.sub("#", text)


@functools.cache
def _any_of(answers: frozenset[str]) -> re.Pattern[str]:
    longest_first = sorted(answers, key=len, reverse=True)
    return re.compile(rf"(?<!\w)(?:{'|'.join(map(re.escape, longest_first))})(?!\w)")


def _template(line: str, word: str) -> str:
    return re.sub(re.escape(word), "{}", line, flags=re.IGNORECASE) if word else line


def templates(run: Run, one: CommandSeen) -> set[str]:
    """Return what was said after a command, with `{}` in the place of the command itself."""
    return {_template(line, one.text) for line in lines_of(run, one)}


def changes(
    part: Part,
    run: Run,
    one: CommandSeen,
    alone: Mapping[str, Heard],
    echoes: Collection[Change] = (),
) -> bool:
    """Return whether a topic or parameter says something else after a command than before, and than after unknown ones."""
    brought = _brought_by_unknown(part, run, alone)
    vain = _arbitrary(part, brought) | {part.topic}
    common = {*_common(part, brought), *echoes}
    return any(change not in common and change[0] not in vain for change in _brought(run, one, alone))


def echoes(part: Part, runs: Iterable[Run], alone: Mapping[str, Heard]) -> set[Change]:
    """Return the changes that repeat an unknown word each time that it comes, in some run."""
    common = (_common(part, _brought_by_unknown(part, run, alone)) for run in runs)
    return {change for found in common for change in found if "{}" in change[1]}


def _brought_by_unknown(part: Part, run: Run, alone: Mapping[str, Heard]) -> list[tuple[str, set[Change]]]:
    return [(one.text, _brought(run, one, alone)) for one in run.commands if one.text in part.unknown]


def _common(part: Part, brought: Iterable[tuple[str, set[Change]]]) -> set[Change]:
    """Return what is said each time after an unknown word; after a single one it may be the state that it has left."""
    controls = [times for times in _by_unknown(part, brought).values() if len(times) > 1]
    return set[Change]().union(*(set.intersection(*times) for times in controls))


def logs_arbitrarily(part: Part, run: Run) -> bool:
    """Return whether the log says something else of each unknown word."""
    said = [(one.text, {("", line) for line in templates(run, one)}) for one in run.commands]
    return bool(_arbitrary(part, said))


def _arbitrary(part: Part, brought: Iterable[tuple[str, set[Change]]]) -> set[str]:
    """Return what says something else of each unknown word, such as by a hash or a count: it tells no words apart.

    Args:
        part: that takes the words.
        brought: after each word, what came, as pairs of where it came and what it says.
    """
    after: dict[str, set[Change]] = {}
    for text, found in brought:
        if text in part.unknown and text:
            after.setdefault(text, set()).update(found)
    if len(after) < 2:
        return set()
    common = set.intersection(*after.values())
    # A state in which one of them was said twice shows in lines which they share.
    shared = {
        change for one, other in itertools.combinations(after.values(), 2) for change in one & other
    } - common
    places = [{place for place, _ in found - common} for found in after.values()]
    return set.intersection(*places) - {place for place, _ in shared}


def _brought(run: Run, one: CommandSeen, alone: Mapping[str, Heard]) -> set[Change]:
    """Return the topics and parameters that say something else after a command than before, and what they say."""
    values = {(name, _template(str(value), one.text)) for name, value in one.parameters.items()}
    return {*changed(run, one, alone)} | values


def changed(run: Run, one: CommandSeen, alone: Mapping[str, Heard]) -> Iterator[tuple[str, str]]:
    """Yield the topics that say something else after a command than before, and what they say."""
    before = run.commands[: next(number for number, other in enumerate(run.commands) if other is one)]
    quiet = {**alone, **run.quiet}
    for topic, heard in one.topics.items():
        earlier = [part[topic] for part in (quiet, *(c.topics for c in before)) if topic in part]
        if heard.values and _is_news(heard, earlier, quiet.get(topic)) and tells(run, topic, alone):
            yield topic, _template(sense(heard.values), one.text)


def _is_news(heard: Heard, earlier: Sequence[Heard], quiet: Heard | None) -> bool:
    """Return whether a topic says something else than the last time, and nothing that it says by turns without a command.

    Args:
        heard: what it says now.
        earlier: what it said before, the last at the end; never empty if `quiet` is there.
        quiet: what it says while no command comes.
    """
    told = sense(heard.values)
    before_it = sense(earlier[-1].values) if earlier and earlier[-1].values else ""
    # A ramp ends by itself.
    is_ramp = quiet is not None and bool(quiet.values) and sense(quiet.values) == "varying"
    is_other = before_it != told and not (is_ramp and before_it and "still" not in (before_it, told))
    is_stream = quiet is not None or heard.count > 1 or (not is_other and earlier[-1].count > 1)
    return (is_other or not is_stream) and not (quiet is not None and told in _by_turns(quiet))


def tells(run: Run, topic: str, alone: Mapping[str, Heard]) -> bool:
    """Return whether what a topic says tells of the commands in a run: the same word brings the same, and nothing else does.

    Where no graph shows that nodes hear each other, they may still meet by a service or a file; then only what is
    steady by itself tells, and where words are said again, what the same word was seen to bring more than once.
    """
    left = _left_by(run, topic)
    is_said_once = len({one.text for one in run.commands}) == len(run.commands)
    is_told_twice = is_said_once or any(len(states) > 1 for states in left.values())
    is_from_there = is_reached(run, topic) or (is_told_twice and not _is_restless(run, topic, alone))
    return is_from_there and all(len({*states}) == 1 for states in left.values())


def is_reached(run: Run, topic: str) -> bool:
    """Return whether a topic is published by a node that takes the commands of a run, or by one that hears such a node.

    Those of one program may meet anywhere.
    """
    topics, nodes = {run.commanded}, set[str]()
    if len(run.programs) == 1 or not run.subscribes.get(run.commanded):
        return True
    while hearing := {node for one in topics for node in run.subscribes.get(one, ())} - nodes:
        nodes |= hearing
        topics |= {one for one, ends in run.publishes.items() if not nodes.isdisjoint(ends)}
    return not nodes.isdisjoint(run.publishes.get(topic, ()))


def _is_restless(run: Run, topic: str, alone: Mapping[str, Heard]) -> bool:
    """Return whether what a topic says changes by itself: before any command, or more than once after one."""
    quiet = [part[topic] for part in (alone, run.quiet) if topic in part]
    later = [one.topics[topic] for one in run.commands if topic in one.topics]
    changes = [turns([sense([value]) for value in heard.values]) for heard in (*quiet, *later)]
    return any(changes[: len(quiet)]) or any(count > 1 for count in changes[len(quiet) :])


def _left_by(run: Run, topic: str) -> dict[str, list[str]]:
    """Return how each word that changed what a topic says left it, whenever it was said from then on.

    A velocity is only asked whether it is one. What changes nothing leaves it in one state or another.
    """
    after: dict[str, list[str]] = {}
    before = run.quiet.get(topic)
    state = _state(before.values) if before and before.values else ""
    for one in run.commands:
        heard = one.topics.get(topic)
        if heard and heard.values:
            previous, state = state, _state(heard.values)
            if state != previous:
                after.setdefault(one.text, []).append(state)
            elif one.text in after:
                after[one.text].append(state)
    return after


def _state(values: list[Any]) -> str:
    """Return what messages say last, of a velocity only whether it is one."""
    said = sense(values)
    return (
        said
        if said == "still" or not isinstance(values[-1], dict) or "linear" not in str(values[-1])
        else "moving"
    )


def _by_turns(quiet: Heard) -> set[str]:
    """Return what a topic says by turns before any command; nothing of one that changes once, or is a velocity."""
    senses = [sense([value]) for value in quiet.values]
    return {*senses} if turns(senses) > 1 and "still" not in senses else set()


def turns(values: Sequence[object]) -> int:
    """Return how many values differ from the one before them."""
    return sum(one != other for one, other in itertools.pairwise(values))


def sense(values: list[Any]) -> str:
    """Return what messages say last, without what changes by itself."""
    last = values[-1]
    if not isinstance(last, dict) or "linear" not in str(last):
        return _steady(str(last))
    if is_still(last):
        return "still"
    is_steady = len(values) > 1 and values[-2] == last
    return str(last) if is_steady or len(values) == 1 else "varying"


def stands(heard: Heard | None) -> bool | None:
    """Return whether a robot stands by its last velocity; None if there is none."""
    return is_still(heard.values[-1]) if heard and heard.values else None


def is_still(value: Any) -> bool:
    """Return whether all numbers of a message, as plain data, are zero."""
    if isinstance(value, dict):
        return all(is_still(inner) for key, inner in value.items() if key != "header")
    return not (_is_number(value) and float(value))


def numbers_in(value: Any, name: str = "") -> Iterator[tuple[str, float]]:
    """Yield the numbers in a message, as plain data, with their fields."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if key != "header":
                yield from numbers_in(inner, f"{name}.{key}".lstrip("."))
    elif _is_number(value):
        yield name, float(value)


def _is_number(value: Any) -> bool:
    is_plain = isinstance(value, (int, float)) and not isinstance(value, bool)
    return is_plain or value in ("nan", "inf", "-inf")
