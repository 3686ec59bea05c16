"""The state machine, as a table, and the words."""

import pytest

from robot_controller.robot_state import (
    Command,
    State,
    effect_of,
    parse_command,
    parse_state,
    quoted,
)

TABLE = [
    ("idle", "start", "running", ""),
    ("idle", "stop", "idle", "it is not running"),
    ("idle", "reset", "idle", "it is idle already"),
    ("running", "start", "running", "it is running already"),
    ("running", "stop", "stopped", ""),
    ("running", "reset", "idle", ""),
    ("stopped", "start", "running", ""),
    ("stopped", "stop", "stopped", "it has stopped already"),
    ("stopped", "reset", "idle", ""),
]


@pytest.mark.parametrize(("before", "command", "after", "reason"), TABLE)
def test_effect_of_each_command_in_each_state(
    before: str,
    command: str,
    after: str,
    reason: str,
) -> None:
    """A command leads to the state in the table, with a reason exactly if it changes nothing."""
    effect = effect_of(Command(command), State(before))
    assert (effect.before.value, effect.after.value, effect.reason) == (before, after, reason)


def test_table_is_complete() -> None:
    """Each command is listed in each state once."""
    every = {(state.value, command.value) for state in State for command in Command}
    assert {(row[0], row[1]) for row in TABLE} == every
    assert len(TABLE) == len(State) * len(Command)


def test_effect_reads_well_in_the_log() -> None:
    """An effect says the change, or why there is none."""
    assert str(effect_of(Command.START, State.IDLE)) == "idle -> running"
    assert str(effect_of(Command.STOP, State.IDLE)) == "still idle, it is not running"


@pytest.mark.parametrize("text", ["start", "START", "  Start\t\n", "sTaRt", " " * 59 + "start"])
def test_blanks_and_capitals_do_not_matter(text: str) -> None:
    """These are all the command start."""
    assert parse_command(text) is Command.START


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "is empty"),
        (" \t\n", "is empty"),
        ("jump", "'jump' is not known"),
        ("start now", "is not known"),
        ("st art", "is not known"),
        ("starts", "is not known"),
        ("start\0", "is not known"),
        ("\uff53tart", "is not known"),
        (" " * 60 + "start", r"is too long \(65 characters\)"),
        ("x" * 100_000, r"is too long \(100000 characters\)"),
    ],
)
def test_other_texts_are_refused(text: str, complaint: str) -> None:
    """A refusal says what was wrong and what is accepted, in one short line."""
    with pytest.raises(ValueError, match=complaint) as refusal:
        parse_command(text)
    sentence = str(refusal.value)
    assert sentence.endswith("accepted: start, stop, reset")
    assert len(sentence) < 200


@pytest.mark.parametrize("text", ["Idle", " idle", "", "flying"])
def test_a_state_is_exactly_one_of_its_words(text: str) -> None:
    """States come from a program and not from a person, so nothing is let through."""
    with pytest.raises(ValueError, match="accepted: idle, running, stopped"):
        parse_state(text)


@pytest.mark.parametrize("text", ["a\nb", "a\rb", "\x1b[31m", "a\0b", "\u202ecba", "\u2028"])
def test_a_quote_has_no_control_characters(text: str) -> None:
    """What somebody sends cannot break or colour the log line, nor turn its direction."""
    assert quoted(text).isprintable()


def test_a_quote_is_shortened() -> None:
    """A long text keeps its beginning and shows that there was more."""
    assert quoted("x" * 1000) == "'" + "x" * 40 + "…'"
    assert quoted("x" * 40) == "'" + "x" * 40 + "'"
