"""What lesson 7 expects of the node that takes commands, and says where it does something else."""

from __future__ import annotations

import time
from collections.abc import Iterable

from ros2lab.checks import CheckError
from ros2lab.checks.project import COMMANDS, LESSON, LOG, command, log_lines, messages_of
from ros2lab.checks.watched_program import (
    STRING,
    WatchedProgram,
)
from ros2lab.observed_domain import LATCHED
from ros2lab.topics import TopicLog, find_type

WARNING = 30  # the level of a log line


def expect_obedience(node: WatchedProgram) -> None:
    """Check that a node logs each word, publishes the state to which a command leads, and survives all others."""
    node.expect_subscription(COMMANDS.topic, COMMANDS.type_name)
    logged = node.domain.log("/rosout", LOG)
    state = node.log(LESSON.state_topic, STRING)
    answered: set[str] = set()
    before = LESSON.first_state
    for word, after in LESSON.conversation:
        node.spins()
        state.clear()
        since = time.time()
        command(node, word)
        if word:
            _expect_logged(node, logged, word, since)
        if after is None:
            _expect_unchanged(node, state, word, before)
        else:
            _expect_state(node, state, word, before, after, answered=answered)
            _expect_no_other_state(state, word, before, after)
            before = after
        node.expect_alive(f"after the command {word!r}")
        answered.add(word)
    _expect_kept(node, before)
    node.expect_publisher(LESSON.state_topic, STRING)  # by now a second one would be known


def expect_warnings(node: WatchedProgram) -> None:
    """Check that a node warns of what is no command, and of nothing else."""
    node.expect_subscription(COMMANDS.topic, COMMANDS.type_name)
    state = node.log(LESSON.state_topic, STRING)
    logged = node.domain.log("/rosout", LOG)
    started, first = time.time(), COMMANDS.commands[0]
    command(node, first)
    _expect_state(node, state, first, LESSON.first_state, LESSON.state_after[first], answered=())
    for number, word in enumerate(LESSON.nonsense):
        node.spins()
        state.clear()
        since = time.time()
        command(node, word)
        expect_warned(node, logged, f"the command {word!r}", since, word)
        if not number:  # by now all that it logged before has come: log lines keep their order
            _expect_not_warned(logged, first, started, since)
        _expect_unchanged(node, state, word, LESSON.state_after[first])


def _expect_logged(node: WatchedProgram, logged: TopicLog, word: str, since: float) -> None:
    """Check that a log line since a time (s) holds a command."""
    wanted = word.strip().lower()
    if node.wait_until(lambda: any(wanted in line.lower() for line in log_lines(logged, since)), 0.0):
        return
    node.expect_alive(f"after the command {word!r}")
    expected = f"a log line that holds the command {word!r}"
    # Who prints it has heard it; to answer a question may take too long on a busy machine.
    is_printed = wanted in node.printed().lower()
    if not is_printed and (deaf := node.deafness(COMMANDS.topic)):
        raise CheckError(expected, f"none; {deaf[0]}", deaf[1])
    lines = log_lines(logged, since)
    if lines:
        raise CheckError(
            expected, repr(lines[-1]), "the word itself is in the message's field data: put it into the text."
        )
    if is_printed:
        raise CheckError(
            expected, "it is printed, but not logged", "self.get_logger().info(...) writes a log line."
        )
    raise CheckError(
        expected,
        "no log line",
        'log each word as it comes, also one that is no command: self.get_logger().info(f"... {message.data!r}").',
    )


def _expect_state(
    node: WatchedProgram, state: TopicLog, word: str, before: str, after: str, *, answered: Iterable[str]
) -> None:
    """Check that a command leads from one state to another one, which is published."""
    if node.wait_until(lambda: any(message.data == after for message in messages_of(state)), 0.0):
        return
    node.expect_alive(f"after the command {word!r}")
    expected = f"{after!r} on {LESSON.state_topic} after the command {word!r}"
    found = ", ".join(repr(message.data) for message in messages_of(state)[-3:])
    if found:
        raise CheckError(expected, found, f"state_after({word!r}) gives {after!r}: publish what it returns.")
    if deaf := node.deafness(COMMANDS.topic):
        raise CheckError(expected, f"nothing; {deaf[0]}", deaf[1])
    if word in answered:
        raise CheckError(
            expected,
            f"nothing in the state {before!r}, though the first {word!r} was answered",
            "what has changed since then? Look at the variables that your function sets.",
        )
    if word != word.strip().lower():
        raise CheckError(
            expected,
            "nothing",
            "capitals, and spaces around the word, do not matter: state_after in robot_state.py takes them away, and compares what is left.",
        )
    raise CheckError(
        expected, "nothing", f"publish the state in the function that receives the command, also for {word}."
    )


def _expect_no_other_state(state: TopicLog, word: str, before: str, after: str) -> None:
    """Check that a command led from one state to the next, and nowhere in between."""
    published = [message.data for message in messages_of(state)]
    change = published.index(after)
    others = [data for data in published[:change] if data != before]
    others += [data for data in published[change:] if data != after]
    if others:
        raise CheckError(
            f"nothing but {after!r} on {LESSON.state_topic} after the command {word!r}",
            f"{others[0]!r} as well",
            "publish once for each command: the state that state_after gives, and no other.",
        )


def _expect_unchanged(node: WatchedProgram, state: TopicLog, word: str, before: str) -> None:
    """Wait until the program has received a word that is no command; the state must stay as it was before."""
    if not node.spins():
        node.domain.wait(lambda: node.ended() is not None)

    def others() -> list[str]:
        return [message.data for message in messages_of(state) if message.data != before]

    if node.domain.wait(lambda: others() or node.ended(), node.domain.late):
        node.expect_alive(f"after the command {word!r}")
        raise CheckError(
            f"the state stays as it is after {word!r}, which is no command",
            f"{others()[0]!r} on {LESSON.state_topic}",
            "publish only what is a state: state_after gives None for every other word.",
        )
    node.expect_alive(f"after the command {word!r}")


def _expect_kept(node: WatchedProgram, state: str) -> None:
    """Check that a subscription that is made only now, as a node that starts late makes it, gets the state."""
    late = TopicLog(node.domain.node, LESSON.state_topic, find_type(STRING), qos=LATCHED)
    if node.wait_until(lambda: any(message.data == state for message in messages_of(late)), 0.0):
        return
    raise CheckError(
        f"a node that starts now receives the state {state!r}",
        node.said("incompatible QoS")
        or ", ".join(repr(message.data) for message in messages_of(late))
        or "nothing",
        "state_topic.LATCHED is the third argument of create_publisher: then the last state is kept for late-joining nodes.",
    )


def expect_warned(
    node: WatchedProgram, logged: TopicLog, what: str, since: float = 0.0, word: str = ""
) -> None:
    """Check that a warning since a time (s) names what is wrong."""
    if node.wait_until(lambda: bool(log_lines(logged, since, WARNING)), 0.0):
        line = log_lines(logged, since, WARNING)[-1]
        if word.strip() in line:
            return
        raise CheckError(
            f"a warning that names {what}",
            f"{line!r}",
            "put the word into the text: {message.data!r} shows it in quotes, so that spaces are seen.",
        )
    node.expect_alive(f"after {what}")
    lines = log_lines(logged, since)
    raise CheckError(
        f"a warning in the log about {what}",
        f"the log line {lines[-1]!r}, which is no warning" if lines else "no log line",
        "self.get_logger().warning(...) in the except writes one.",
    )


def _expect_not_warned(logged: TopicLog, word: str, begin: float, end: float) -> None:
    """Check that a word brought no warning between two times (s); a warning after the second one must have come."""
    later = log_lines(logged, end, WARNING)
    if warnings := log_lines(logged, begin, WARNING)[: -len(later)]:
        raise CheckError(
            f"no warning about the command {word!r}",
            repr(warnings[-1]),
            "warn only of a word that is no command.",
        )
