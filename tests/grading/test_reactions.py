"""Which topics tell of the commands in a run: those that the commands can reach, and on which the same word brings the same."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import evidences
import pytest

from ros2lab.grading.evidence import CommandSeen, Heard, Run
from ros2lab.grading.judging.reactions import changed, is_reached, lines_of, logs_arbitrarily, tells, template
from ros2lab.grading.rubric import load

COMMAND, CMD_VEL = "/robot/command", "/cmd_vel"
GO, STAND, TURN = 0.2, 0.0, 0.1
WORDS = ("start", "stop", "reset", "start", "dance", "start")
OBEYED = ([GO, GO], [STAND], [STAND], [GO, GO], [GO], [GO, GO])


def twists(speeds: Sequence[float]) -> Heard:
    return Heard(
        evidences.TWIST, "/velocity_publisher", [0.1 * n for n in range(len(speeds))],
        [evidences.twist(one) for one in speeds], len(speeds),
    )  # fmt: skip


def run(
    after: Sequence[Sequence[float]] = OBEYED,
    quiet: Sequence[float] = (STAND, STAND, STAND),
    hears: Mapping[str, Sequence[str]] | None = None,
    tells_on: Mapping[str, Sequence[str]] | None = None,
    programs: Sequence[str] = ("command_subscriber", "velocity_publisher"),
) -> Run:
    """Return a run in which a robot drives as it is told to.

    Args:
        after: the speeds after each word.
        quiet: those before any.
        hears: by topic, who subscribes to it besides the one that takes the commands.
        tells_on: by topic, who publishes on it besides the velocities.
        programs: that were started.
    """
    kinds = [evidences.STRING]
    subscribes = {COMMAND: ["/command_subscriber"], **(hears or {})}
    publishes = {CMD_VEL: ["/velocity_publisher"], **(tells_on or {})}
    said = [
        CommandSeen(word, [], {CMD_VEL: twists(one)} if one else {}, {}, True)
        for word, one in zip(WORDS, after, strict=False)
    ]
    return Run(
        [*programs], "together", "stepped", ["/command_subscriber", "/velocity_publisher"],
        {topic: dict.fromkeys(nodes, kinds) for topic, nodes in publishes.items()},
        {topic: dict.fromkeys(nodes, kinds) for topic, nodes in subscribes.items()},
        {}, {}, {CMD_VEL: twists(quiet)} if quiet else {}, said, {}, {}, [], commanded=COMMAND,
    )  # fmt: skip


JOINED = {
    "hears": {"/robot/state": ["/velocity_publisher"]},
    "tells_on": {"/robot/state": ["/command_subscriber"]},
}
BY_CHANCE = ([GO, STAND, GO], [STAND], [STAND, GO], [STAND], [GO], [STAND])


@pytest.mark.parametrize(
    "one",
    [
        run(),  # by a service or a file, for all that the graph shows
        run(**JOINED),  # type: ignore[arg-type]
        run(programs=("all_of_it",)),
        run(hears={COMMAND: ["/command_subscriber", "/velocity_publisher"]}),
        run(quiet=(GO, TURN, GO), **JOINED),  # type: ignore[arg-type]
        run(([TURN, GO], [STAND], [STAND], [TURN, GO], [GO], [GO]), **JOINED),  # type: ignore[arg-type]
        run(([GO], [STAND], [], [GO], [], [GO]), quiet=()),
        run(([GO], [STAND], [STAND], [GO], [STAND], [GO]), **JOINED),  # type: ignore[arg-type]
    ],
    ids=[
        "unjoined",
        "joined",
        "one_program",
        "hears_it_itself",
        "drives_before",
        "ramp",
        "event",
        "unknown_stops",
    ],
)
def test_a_robot_that_obeys_is_believed(one: Run) -> None:
    assert tells(one, CMD_VEL, {})
    assert [what for _, what in changed(one, {})[1]] == ["still"]


@pytest.mark.parametrize(
    ("one", "alone"),
    [
        (run(BY_CHANCE, quiet=(GO, STAND, TURN)), {}),
        (run(BY_CHANCE, quiet=()), {CMD_VEL: twists((GO, STAND, GO))}),
        (run(BY_CHANCE), {}),
        (run(BY_CHANCE, **JOINED), {}),  # type: ignore[arg-type]
        (run(quiet=(GO, STAND, GO), tells_on={"/robot/state": ["/command_subscriber"]}), {}),
        (run(([GO, STAND, GO], *OBEYED[1:])), {}),
        (run(([STAND], [STAND], [GO], [GO], [GO], [GO])), {}),
    ],
    ids=[
        "restless",
        "restless_alone",
        "another_each_time",
        "joined_but_by_chance",
        "not_joined",
        "changes_twice",
        "changes_once_in_all",
    ],
)
def test_chance_tells_nothing(one: Run, alone: dict[str, Heard]) -> None:
    assert not tells(one, CMD_VEL, alone)
    assert not any(changed(one, alone))


def test_a_topic_is_reached_by_way_of_others() -> None:
    chain = run(
        hears={"/a": ["/between"], "/b": ["/velocity_publisher"]},
        tells_on={"/a": ["/command_subscriber"], "/b": ["/between"]},
    )
    assert is_reached(chain, CMD_VEL)
    assert not is_reached(run(hears={"/b": ["/velocity_publisher"]}, tells_on={"/b": ["/between"]}), CMD_VEL)


def test_what_is_typed_meanwhile_is_no_reaction() -> None:
    """Other answers come up after each command: what a program says of them follows none of the commands."""
    said = [
        ("start", "1,1"),
        ("twirl", "y"),
        ("stop", "1 1"),
        ("twirl", "1,1"),
        ("reset", "y"),
        ("start", "1"),
    ]
    commands = [
        CommandSeen(word, [["WARN", f"Unknown command: {answer!r}"]], {}, {}, True) for word, answer in said
    ]
    seen = replace(run(), commands=commands, typed=["1,1", "y", "1 1", "1"])
    assert len({frozenset(lines_of(seen, one)) for one in commands}) == 1


@pytest.mark.parametrize(
    ("answers", "is_arbitrary"),
    [
        ("abcdef", True),
        ("abcdea", True),  # a hash with few values
        ("aabcde", True),
        ("aaabbb", False),  # two states
        ("aaaaaa", False),
        ("ababab", False),
    ],
)
def test_a_log_of_a_hash_says_something_else_of_most_unknown_words(answers: str, is_arbitrary: bool) -> None:
    unknown = ("saep", "srap", "rpot", "dance", "twirl", "glide")
    part = replace(load().assignment.parts["command_subscriber"], unknown=unknown)
    said = [
        CommandSeen(word, [["INFO", f"now {answer} is done"]], {}, {}, True)
        for word, answer in zip(unknown, answers, strict=True)
    ]
    assert logs_arbitrarily(part, replace(run(), commands=said)) == is_arbitrary


@pytest.mark.parametrize(
    ("line", "word", "filled"),
    [
        ('I heard: "A"', "A", 'I heard: "{}"'),
        ("unknown command", "on", "unknown command"),
        ("turning on", "on", "turning {}"),
        ("cmd_go done", "go", "cmd_{} done"),
        ("STOP, and stop!", "stop", "{}, and {}!"),
        ("starting", "start", "{}ing"),
        ("nothing", "", "nothing"),
    ],
)
def test_a_command_is_known_in_a_line_where_it_does_not_stand_by_chance(
    line: str, word: str, filled: str
) -> None:
    assert template(line, word) == filled
