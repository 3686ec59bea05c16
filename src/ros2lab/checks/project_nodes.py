"""What lesson 7 expects of the two nodes that publish in a rhythm, and says where they do something else."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ros2lab.assignments import Part
from ros2lab.checks import CheckError
from ros2lab.checks.project import (
    COMMANDS,
    LESSON,
    STATUS,
    TIMER_HINT,
    TWIST,
    VELOCITY,
    messages_of,
    tell_state_after,
)
from ros2lab.checks.watched_program import (
    STRING,
    WatchedProgram,
    message_numbers,
)
from ros2lab.topics import TopicLog

REACTION = 5.0  # periods, within which a node must have taken in what it was told
STEADY_STATUSES, STEADY_VELOCITIES = 1, 4  # how many more messages must fit after the first that does


def expect_task(node: WatchedProgram, part: Part) -> None:
    """Check that the program that was started last is the one that its name promises."""
    verb, ends = (
        ("publishes", node.domain.published)
        if part.is_publisher
        else ("subscribes to", node.domain.subscribed)
    )
    before = set(ends())
    try:
        node.expect_end(part.topic, ends)
    except LookupError:
        new = set(ends()) - before
        raise CheckError(
            f"the executable {part.name} {verb} {part.topic}",
            f"it {verb} {', '.join(sorted(new)) or 'no new topic'}",
            f"look at the entry point {part.name} in setup.py: the module after the = is to be that of {part.name}.",
        ) from None


def expect_status(node: WatchedProgram) -> None:
    """Check that a node tells the present state in its period."""
    tell_state_after(node, COMMANDS.commands[-1])
    log = node.log(STATUS.topic, STRING)
    told = f"a message on {STATUS.topic} every {STATUS.period:g} s"
    node.expect_period(log, STATUS.period, told, TIMER_HINT)
    for command, state in LESSON.state_after.items():
        tell_state_after(node, command)
        log.clear()
        if not node.wait_until(
            lambda: log.latest is not None and _tells(log.latest.message, state),  # noqa: B023
            REACTION * STATUS.period / 2,
        ):
            node.expect_alive()
            raise _wrong_status(node, log, state)
        later = _next_messages(node, log, STEADY_STATUSES, STATUS.period)
        if not all(_tells(message, state) for message in later):
            raise CheckError(
                f"the word {state} in each text on {STATUS.topic} while the state is {state}",
                f"it is in one, and the next one is {later[-1].data!r}",
                "name the present state each time that the timer calls you, also when it has not changed.",
            )
    node.expect_publisher(STATUS.topic, STRING)  # by now a second one would be known


def _tells(message: Any, state: str) -> bool:
    text = message.data.lower()
    return state in text and not any(other in text for other in LESSON.state_after.values() if other != state)


def _next_messages(node: WatchedProgram, log: TopicLog, count: int, period: float) -> list[Any]:
    """Return the messages that come next, `count` of them or more, or fewer if they end."""
    log.clear()
    node.wait_until(lambda: log.count >= count, (count + 1) * period)
    node.expect_alive()
    return messages_of(log)


def _wrong_status(node: WatchedProgram, log: TopicLog, state: str) -> CheckError:
    expected = f"the word {state} in the text on {STATUS.topic} while the state is {state}"
    text = log.latest.message.data if log.latest else None
    found = "no message" if text is None else repr(text)
    if deaf := node.deafness(LESSON.state_topic, COMMANDS.topic):
        return CheckError(expected, f"{found}; {deaf[0]}", deaf[1])
    if text is None:
        return CheckError(expected, found, "the timer goes on whatever the state is: publish each time.")
    words = [word for word in LESSON.state_after.values() if word in text.lower()]
    if not text.strip():
        hint = "String(data=...) takes the text; here it is empty."
    elif not words:
        hint = f"the text names the state, such as state={LESSON.first_state}: .state of the Follower has it."
    elif len(words) > 1:
        hint = "the text names the present state, and no other."
    else:
        hint = "that is not the present state: read .state of the Follower each time that the timer calls you, not once, and name it as it is."
    return CheckError(expected, found, hint)


def expect_velocity(node: WatchedProgram) -> None:
    """Check that a node publishes the velocity of the present state in its period."""
    tell_state_after(node, COMMANDS.commands[-1])
    log = node.log(VELOCITY.topic, TWIST)
    _expect_velocity_period(node, log)
    start, stop, reset = LESSON.state_after
    for command in (reset, start, stop, start, reset):
        state = LESSON.state_after[command]
        wanted = LESSON.velocities.get(state, {})
        tell_state_after(node, command)
        log.clear()
        if not node.wait_until(
            lambda: log.latest is not None and is_twist(log.latest.message, wanted),  # noqa: B023
            REACTION * LESSON.velocity_period,
        ):
            node.expect_alive(f"after the state {state}")
            raise _wrong_velocity(node, log, state)
        later = _next_messages(node, log, STEADY_VELOCITIES, LESSON.velocity_period)
        if len(later) < STEADY_VELOCITIES:
            raise _wrong_velocity(node, log, state, is_silent=True)
        other = next((twist for twist in later if not is_twist(twist, wanted)), None)
        if other is not None:
            raise CheckError(
                f"{said_of(wanted)} in each Twist while the state is {state}",
                f"that in one, and then {said_of(message_numbers(other))}",
                "publish the two numbers of velocity_in each time that the timer calls you: nothing added up, and nothing left out.",
            )
    node.expect_publisher(VELOCITY.topic, TWIST)  # by now a second one would be known


def _expect_velocity_period(node: WatchedProgram, log: TopicLog) -> None:
    told = f"a {VELOCITY.short_type} on {VELOCITY.topic} every {LESSON.velocity_period:g} s, also while the robot stands"
    try:
        node.expect_period(log, LESSON.velocity_period, told, TIMER_HINT)
    except CheckError as error:
        tell_state_after(node, COMMANDS.commands[0])
        if log.count < 2 and node.wait_until(lambda: log.count >= 3, REACTION * LESSON.velocity_period):
            raise CheckError(
                told,
                "none while the robot stands; they begin when it is running",
                "publish zeros too: a robot that receives nothing cannot know whether it should stop or the program has died.",
            ) from None
        raise error


def _wrong_velocity(
    node: WatchedProgram, log: TopicLog, state: str, *, is_silent: bool = False
) -> CheckError:
    wanted = LESSON.velocities.get(state, {})
    expected = f"{said_of(wanted)} while the state is {state}"
    found = message_numbers(log.latest.message) if log.latest else {}
    said = said_of(found) if log.latest and not is_silent else "nothing more comes"
    if not log.latest or is_silent:
        return CheckError(
            expected, said, "the timer goes on whatever the state is: publish each time, zeros too."
        )
    if deaf := node.deafness(LESSON.state_topic, COMMANDS.topic):
        return CheckError(expected, f"{said}; {deaf[0]}", deaf[1])
    if sorted(found.values()) == sorted(wanted.values()):
        hint = "the first number of velocity_in belongs in linear.x, the second one in angular.z."
    elif not wanted:
        hint = f"a robot that does not stop is dangerous: velocity_in({state!r}) gives two zeros; ask it each time that the timer calls you."
    elif not found:
        hint = "hand .state of the Follower to velocity_in each time that the timer calls you."
    else:
        hint = 'the numbers are those of velocity_in("running"): hand both on as they are.'
    return CheckError(expected, said, hint)


def is_twist(twist: Any, wanted: Mapping[str, float]) -> bool:
    """Return whether a Twist holds these numbers, and zeros otherwise."""
    found = message_numbers(twist)
    return found.keys() == wanted.keys() and all(
        math.isclose(found[name], wanted[name], abs_tol=1e-9) for name in wanted
    )


def said_of(numbers: Mapping[str, float]) -> str:
    """Return the numbers of a Twist in words."""
    return ", ".join(f"{name} {value:g}" for name, value in numbers.items()) or "zeros"
