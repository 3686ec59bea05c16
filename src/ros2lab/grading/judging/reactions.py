"""What follows a command in a run, without what would follow any: pure functions over recorded runs."""

from __future__ import annotations

import functools
import itertools
import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any

from ros2lab.assignments import Part
from ros2lab.grading.evidence import CommandSeen, Heard, Run
from ros2lab.grading.senses import is_still, is_velocity, seen, steady

_ARBITRARY = 3  # unknown words that each bring something else
LONG = 4  # letters of a word that does not stand in another one by chance
WARNINGS = frozenset(("WARN", "ERROR", "FATAL"))


Change = tuple[str, str]  # a topic or a parameter, and what it says after a command


def effects_of(
    part: Part,
    run: Run,
    alone: Mapping[str, Heard],
    *,
    has_own_log: bool,
    echoes: Collection[Change] = (),
) -> dict[str, str]:
    """Return by word whether it was `processed`, only `echoed`, or `refused` like unknown words.

    Words that nothing follows are left out.

    Args:
        part: the part that takes the words.
        run: the run in which they were sent.
        alone: by topic, what is published without commands.
        has_own_log: whether all log lines are the node's own.
        echoes: changes that only repeat a word, as other runs have shown.
    """
    found: dict[str, str] = {}
    numbers = {
        command.text: number for number, command in reversed([*enumerate(run.commands)])
    }  # the first of each
    by_text = {text: run.commands[number] for text, number in numbers.items()}
    said = {word: templates(run, by_text[word]) for word in part.commands if word in by_text}
    if not said:
        return found
    known = set[str]().union(*said.values())
    unknown = _control(part, run)
    # A line that only unknown words get shows that the node knows the others.
    refuses = bool(unknown - known - said_by_itself(run))
    is_arbitrary = logs_arbitrarily(part, run)
    telling, is_changing = telling_lines(part, run), changing(part, run, alone, echoes)
    for word, lines in said.items():
        command = by_text[word]
        own = {template(line, word) for line in telling[word]} if has_own_log else set()
        if not command.is_alive and unknown_word(part) not in by_text:
            own -= set[str].intersection(
                known, *said.values()
            )  # these lines show that it was received, but not that it was obeyed
        elsewhere = set[str]().union(*(others for other_word, others in said.items() if other_word != word))
        # A line that this word shares with unknown ones, but with no other word, says that it is unknown.
        is_refused = bool(unknown & (_warnings(run, command) | (own - elsewhere)))
        is_known = refuses and not _is_like_unknown(part, run, lines)
        is_apart = not is_arbitrary and (own - unknown or (own and is_known))
        if is_changing[numbers[word]] or is_apart:
            found[word] = "processed"
        elif own:
            found[word] = "refused" if is_refused else "echoed"
    return found


def _control(part: Part, run: Run) -> set[str]:
    """Return the log lines that follow an unknown word each time, with `{}` instead of the word."""
    return _each_time(part, run, templates)


def _each_time(part: Part, run: Run, lines: Callable[[Run, CommandSeen], set[str]]) -> set[str]:
    """Return the lines that follow an unknown word each time.

    The word is sent while the robot stands and while it moves: a line that comes only once tells of that
    state.
    """
    said = _by_unknown(part, ((command.text, lines(run, command)) for command in run.commands))
    return set[str]().union(
        *(
            set.intersection(*filter(None, times))
            for text, times in said.items()
            if any(times) and (len(times) > 1 or text == unknown_word(part))
        )
    )


def _is_like_unknown(part: Part, run: Run, lines: set[str]) -> bool:
    """Return whether an unknown word brings just the same lines each time: the node takes it for the command."""
    seen = ((command.text, templates(run, command)) for command in run.commands)
    times_by_word = _by_unknown(part, seen).values()
    return any(len(times) > 1 and all(said == lines for said in times) for times in times_by_word)


def _by_unknown(part: Part, seen: Iterable[tuple[str, set[Any]]]) -> dict[str, list[set[Any]]]:
    """Return by unknown word what was seen after it, for each time that it was sent."""
    found: dict[str, list[set[Any]]] = {}
    for text, answers in seen:
        if text and text in part.unknown:
            found.setdefault(text, []).append(answers)
    return found


def _warnings(run: Run, command: CommandSeen) -> set[str]:
    """Return the warnings and errors logged after a command."""
    return {template(_line(run, text), command.text) for level, text in command.log if level in WARNINGS}


def is_followed(run: Run, alone: Mapping[str, Heard], *, has_own_log: bool = True) -> bool:
    """Return whether anything follows a command that does not also come by itself."""
    return (
        any(command.parameters for command in run.commands)
        or any(changed(run, alone))
        or (has_own_log and any(lines_of(run, command) - said_by_itself(run) for command in run.commands))
    )


def unknown_word(part: Part) -> str:
    """Return the first unknown text that is not empty."""
    return next(filter(None, part.unknown), "")


def lines_of(run: Run, command: CommandSeen) -> set[str]:
    """Return the log lines after a command that can be seen, without what a program prints when the command ends it."""
    return {_line(run, text) for level, text in command.log if command.is_alive or level != "PRINT"} - {""}


def lines_of_unknown(part: Part, run: Run) -> set[str]:
    """Return the log lines that follow an unknown word each time."""
    return _each_time(part, run, lines_of)


def telling_lines(part: Part, run: Run) -> dict[str, set[str]]:
    """Return by command the lines after its first time that do not follow just any command.

    Lines that came before any command and follow an unknown word come by themselves; a line that came once
    before, and follows no unknown word, tells of a state that the command restores.
    """
    heard = {
        command.text: lines_of(run, command)
        for command in reversed(run.commands)
        if command.text in (*part.commands, *part.unknown)
    }
    is_arbitrary = logs_arbitrarily(part, run)
    again = {line for line, count in Counter(_line(run, text) for _, text in run.log).items() if count > 1}
    after_unknown = set().union(*(lines for text, lines in heard.items() if text in part.unknown))
    by_itself = after_unknown & said_by_itself(run)
    found = {word: set[str]() for word in part.commands}
    for word in found.keys() & heard.keys():
        said = dict(heard)
        if is_arbitrary:  # only lines with the word itself count
            said[word] = {line for line in said[word] if "{}" in template(line, word)}
        common = (
            set.intersection(*(lines for text, lines in said.items() if text)) if len(said) > 1 else set()
        )
        other_lines = set().union(*(lines for text, lines in said.items() if text != word))
        found[word] = said[word] - common - (other_lines & again) - by_itself
    return found


def said_by_itself(run: Run) -> set[str]:
    """Return the lines that were logged before any command."""
    return {_line(run, text) for _, text in run.log}


def _line(run: Run, text: str) -> str:
    """Return what can be seen of a log line, without its numbers and without what was typed at a keyboard."""
    return steady(seen(re.sub(_any_of(frozenset(run.typed)), "…", text) if run.typed else text))


@functools.cache
def _any_of(answers: frozenset[str]) -> re.Pattern[str]:
    longest_first = sorted(answers, key=len, reverse=True)
    return re.compile(rf"(?<!\w)(?:{'|'.join(map(re.escape, longest_first))})(?!\w)")


@functools.lru_cache(maxsize=4096)
def template(line: str, word: str) -> str:
    """Return a line with `{}` instead of a word, whatever its capitals.

    As a part of another word it counts only where it stands nowhere by itself, and is too long to be there by chance.
    """
    if not (text := re.escape(seen(word))):
        return line
    filled, times = _in_any_case(rf"(?<![^\W_]){text}(?![^\W_])").subn("{}", line)
    return filled if times or len(word) < LONG else _in_any_case(text).sub("{}", line)


@functools.lru_cache
def _in_any_case(pattern: str) -> re.Pattern[str]:
    return re.compile(pattern, re.IGNORECASE)


def templates(run: Run, command: CommandSeen) -> set[str]:
    """Return the log lines after a command, with `{}` instead of the command itself."""
    return {template(line, command.text) for line in lines_of(run, command)}


def changing(part: Part, run: Run, alone: Mapping[str, Heard], echoes: Collection[Change] = ()) -> list[bool]:
    """Return for each command whether it changed a topic or parameter in a way that unknown words do not."""
    brought = _brought(run, alone)
    unknown = _by_unknown(part, zip((command.text for command in run.commands), brought, strict=True))
    vain = _arbitrary(unknown) | {part.topic}
    common = {*_common(unknown), *echoes}
    return [any(change not in common and change[0] not in vain for change in changes) for changes in brought]


def echoes(part: Part, runs: Iterable[Run], alone: Mapping[str, Heard]) -> set[Change]:
    """Return the changes that repeat an unknown word each time that it is sent, in any of the runs."""
    brought = (
        zip((command.text for command in run.commands), _brought(run, alone), strict=True) for run in runs
    )
    common = (_common(_by_unknown(part, changes)) for changes in brought)
    return {change for found in common for change in found if "{}" in change[1]}


def _common(brought: Mapping[str, list[set[Change]]]) -> set[Change]:
    """Return the changes after an unknown word each time; after a single time it may be an old state."""
    controls = [times for times in brought.values() if len(times) > 1]
    return set[Change]().union(*(set.intersection(*times) for times in controls))


def logs_arbitrarily(part: Part, run: Run) -> bool:
    """Return whether the log says something different for each unknown word."""
    unknown = (command for command in run.commands if command.text in part.unknown)
    said = ((command.text, {("", line) for line in templates(run, command)}) for command in unknown)
    return bool(_arbitrary(_by_unknown(part, said)))


def _arbitrary(brought: Mapping[str, Iterable[set[Change]]]) -> set[str]:
    """Return the places that say something different for each unknown word, or for most, such as a hash or a count.

    Args:
        brought: by unknown word, the changes after it, for each time.
    """
    after = [set[Change]().union(*times) for times in brought.values()]
    if len(after) < 2:
        return set()
    common = set.intersection(*after)
    # If two of the words were sent in the same state, that shows in changes which both share.
    shared = {
        change for first, second in itertools.combinations(after, 2) for change in first & second
    } - common
    places = [{place for place, _ in found - common} for found in after]
    # A hash with few values brings the same by chance; what is a word's own shows it all the same.
    own = Counter(place for found in after for place in {place for place, _ in found - common - shared})
    often = {place for place, count in own.items() if count >= _ARBITRARY}
    return (set.intersection(*places) - {place for place, _ in shared}) | often


def _brought(run: Run, alone: Mapping[str, Heard]) -> list[set[Change]]:
    """Return for each command the topics and parameters that changed after it, and what they say then."""
    return [
        {
            *changes,
            *((name, template(str(value), command.text)) for name, value in command.parameters.items()),
        }
        for command, changes in zip(run.commands, changed(run, alone), strict=True)
    ]


def changed(run: Run, alone: Mapping[str, Heard]) -> list[list[Change]]:
    """Return for each command the topics that changed after it, and what they say then."""
    quiet = {**alone, **run.quiet}
    is_telling = functools.cache(lambda topic: tells(run, topic, alone))
    last, found = dict(quiet), list[list[Change]]()
    for command in run.commands:
        found.append(
            [
                (topic, template(heard.sense, command.text))
                for topic, heard in command.topics.items()
                if heard.values and _is_news(heard, last.get(topic), quiet.get(topic)) and is_telling(topic)
            ]
        )
        last |= command.topics
    return found


def _is_news(heard: Heard, last: Heard | None, quiet: Heard | None) -> bool:
    """Return whether a topic says something new, and not what it says by turns without a command.

    Args:
        heard: what it says now.
        last: what it said before; not None if `quiet` is not.
        quiet: what it said before any command.
    """
    told, before_it = heard.sense, last.sense if last else ""
    # A ramp ends by itself.
    is_ramp = quiet is not None and quiet.sense == "varying"
    is_other = before_it != told and not (is_ramp and before_it and "still" not in (before_it, told))
    is_stream = quiet is not None or heard.count > 1 or (not is_other and last is not None and last.count > 1)
    return (is_other or not is_stream) and not (quiet is not None and told in _by_turns(quiet))


def tells(run: Run, topic: str, alone: Mapping[str, Heard]) -> bool:
    """Return whether a topic depends on the commands of a run: the same word always brings the same message.

    Nodes that the graph does not connect may still share a service or a file. Then the topic must be steady
    by itself, and if words were repeated, some word must have brought the same more than once.
    """
    left = _left_by(run, topic)
    is_said_once = len({command.text for command in run.commands}) == len(run.commands)
    is_told_twice = is_said_once or any(len(states) > 1 for states in left.values())
    is_from_there = is_reached(run, topic) or (is_told_twice and not _is_restless(run, topic, alone))
    return is_from_there and all(len({*states}) == 1 for states in left.values())


def is_reached(run: Run, topic: str) -> bool:
    """Return whether a node that takes a run's commands, or one that hears such a node, publishes a topic.

    True for a single program, whose nodes may share anything.
    """
    topics, nodes = {run.commanded}, set[str]()
    if len(run.programs) == 1 or not run.subscribes.get(run.commanded):
        return True
    while hearing := {node for known_topic in topics for node in run.subscribes.get(known_topic, ())} - nodes:
        nodes |= hearing
        topics |= {published for published, ends in run.publishes.items() if not nodes.isdisjoint(ends)}
    return not nodes.isdisjoint(run.publishes.get(topic, ()))


def _is_restless(run: Run, topic: str, alone: Mapping[str, Heard]) -> bool:
    """Return whether a topic changes by itself: before any command, or more than once after one."""
    quiet = [part[topic] for part in (alone, run.quiet) if topic in part]
    later = [command.topics[topic] for command in run.commands if topic in command.topics]
    changes = [turns(heard.senses) for heard in (*quiet, *later)]
    return any(changes[: len(quiet)]) or any(count > 1 for count in changes[len(quiet) :])


def _left_by(run: Run, topic: str) -> dict[str, list[str]]:
    """Return by word the states in which it left a topic, from the first time that it changed the topic.

    All velocities but standing still count as one state. Words that never change the topic are left out.
    """
    after: dict[str, list[str]] = {}
    before = run.quiet.get(topic)
    state = _state(before) if before and before.values else ""
    for command in run.commands:
        heard = command.topics.get(topic)
        if heard and heard.values:
            previous, state = state, _state(heard)
            if state != previous:
                after.setdefault(command.text, []).append(state)
            elif command.text in after:
                after[command.text].append(state)
    return after


def _state(heard: Heard) -> str:
    """Return what the last message says; `moving` for any velocity but standing still."""
    is_moving = heard.sense != "still" and is_velocity(heard.values[-1])
    return "moving" if is_moving else heard.sense


def _by_turns(quiet: Heard) -> set[str]:
    """Return what a topic says by turns before any command; empty if it changes once, or stands still."""
    senses = quiet.senses
    return {*senses} if turns(senses) > 1 and "still" not in senses else set()


def turns(values: Sequence[object]) -> int:
    """Return how many values differ from their predecessor."""
    return sum(before != after for before, after in itertools.pairwise(values))


def stands(heard: Heard | None) -> bool | None:
    """Return whether a robot stands still, by its last velocity; None if there is none."""
    return is_still(heard.values[-1]) if heard and heard.values else None
