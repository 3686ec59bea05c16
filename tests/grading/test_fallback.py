"""Commands after which a node also does what it does for unknown words: told, and not praised."""

from __future__ import annotations

from dataclasses import replace

import evidences
import pytest

from ros2lab.grading.evidence import CommandSeen
from ros2lab.grading.grade import Grade
from ros2lab.grading.judging.told_again import taken_for_unknown
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

KNOWN = ("start", "stop", "reset")


def last_else(text: str) -> list[str]:
    """Answer as `if`, `if`, `if`, `else` does."""
    own = [f"Robot: {text}"] if text in KNOWN else []
    return [*own, *([] if text == "reset" else [f"unknown command: {text}"])]


def no_return(text: str) -> list[str]:
    return [
        *([f"Robot: {text}"] if text in ("start", "stop") else []),
        *(["What?"] if text != "reset" else ["Back"]),
    ]


def received_first(text: str) -> list[str]:
    return [f"Received {text}", *([f"Robot: {text}"] if text in KNOWN else [f"unknown: {text}"])]


def received_unless_reset(text: str) -> list[str]:
    """Say that it came, but for what is handled before; nothing else follows an unknown word."""
    return (
        ["Back to the beginning"]
        if text == "reset"
        else [f"Received {text}", *([f"Robot: {text}"] if text in KNOWN else [])]
    )


def closed_alike(text: str) -> list[str]:
    return [f"Robot: {text}" if text in KNOWN else "nothing to do", "Done."]


def always_closed(text: str) -> list[str]:
    """End each answer in the same way; nothing else follows an unknown word."""
    return [*([f"Robot: {text}"] if text in KNOWN else []), "Done."]


MIXED = {"the last else": (last_else, ["start", "stop"]), "no return": (no_return, ["start", "stop"])}
APART = (received_first, received_unless_reset, closed_alike, always_closed, evidences.log_by_word)


def _graded(log: evidences.Reaction, level: str = "INFO") -> Grade:
    run = evidences.command_run(log=log, level=level)
    return verdict(evidences.runs(run)(evidences.right()), load())


def _told(grade: Grade) -> list[str]:
    return [fault.cause for fault in grade.faults if fault.code == "command-subscriber-commands-mixed"]


@pytest.mark.parametrize("how", MIXED)
def test_a_command_that_is_also_taken_for_unknown_is_told(how: str) -> None:
    """It costs nothing: each command has an answer of its own."""
    log, words = MIXED[how]
    grade = _graded(log)
    (cause,) = _told(grade)
    assert f"after {' and '.join(words)} comes also what follows an unknown word" in cause
    criterion = next(found for found in grade.criteria if found.id == "command_subscriber.commands")
    assert criterion.points == criterion.max
    assert criterion.reason == cause
    fault = next(found for found in grade.faults if found.cause == cause)
    assert "elif" in fault.fix
    assert fault.place == "/command_subscriber"


@pytest.mark.parametrize("log", APART)
def test_what_ends_or_begins_each_answer_is_no_sign_of_it(log: evidences.Reaction) -> None:
    assert _told(_graded(log)) == []


@pytest.mark.parametrize("is_told", [True, False])
def test_a_warning_before_the_answer_is_one_too(is_told: bool) -> None:
    """As where the last `else` warns, and then the state is logged: each command's own line comes after it."""
    part, states = load().assignment.commanded, {"start": "RUNNING", "stop": "STOPPED", "reset": "IDLE"}
    assert part is not None
    run, state, commands = evidences.command_run(), "OFF", []
    for seen in run.commands:
        state = states.get(seen.text, state)
        is_warned = seen.text != "reset" if is_told else seen.text not in states
        warning = [["WARN", f"Unknown command {seen.text}"]] if is_warned else []
        log = [*warning, ["INFO", f"State is now {state}"]] if len(seen.text) < 10 else []
        commands.append(CommandSeen(seen.text, log, {}, {}, True))
    run = replace(run, commands=commands)
    assert [*taken_for_unknown(part, run)] == (["start", "stop"] if is_told else [])
    grade = verdict(evidences.runs(run)(evidences.right()), load())
    assert grade.components["command_subscriber"].points == 20
    assert len(_told(grade)) == is_told


def test_a_warning_after_every_command_is_one() -> None:
    """As where a dictionary's answer is logged, and then the fallback in each case."""
    part = load().assignment.commanded
    assert part is not None

    def answer(text: str) -> list[list[str]]:
        own = [["INFO", f"Robot: {text}"]] if text in KNOWN else []
        return [*own, ["WARN", f"{text} is not known"]]

    run = evidences.command_run()
    commands = [CommandSeen(seen.text, answer(seen.text), {}, {}, True) for seen in run.commands]
    run = replace(run, commands=commands)
    assert [*taken_for_unknown(part, run)] == [*KNOWN]
