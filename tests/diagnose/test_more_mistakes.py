"""What `make mistakes` measures: a sample of it, and how an answer is judged."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import pytest
from mistake_judging import commands_in, judged, outcome
from more_cases import CASES, VERDICTS
from right_workspace import right_workspace

from ros2lab.diagnose import of_workspace

OWN = Path(__file__).resolve().parents[2]
NAMED = {case.name: case for case in CASES}
SAMPLE = (
    "A05-select-typo",
)  # what is told is typed and seen; the words are judged below, of answers made by hand
MORE = ("C52-create-subscriber", "B07-py-in-entry", "B21-tag")


@pytest.mark.parametrize(
    "name", [*SAMPLE, *(pytest.param(name, marks=pytest.mark.thorough) for name in MORE)]
)
def test_what_is_said_of_a_mistake_is_no_worse_than_it_was(name: str) -> None:
    """Made, asked about and set right for real."""
    case = NAMED[name]
    found = outcome(case, [OWN])
    assert not found.problem, found.text + found.after
    (answer,) = found.answers.values()
    assert VERDICTS.index(answer.verdict) <= VERDICTS.index(case.verdict), answer


def test_the_cases_are_eighty_and_begin_with_a_right_workspace(tmp_path: Path) -> None:
    """Each has a name of its own, and each changes what is there."""
    assert of_workspace(right_workspace().write(tmp_path)) == []
    assert len(NAMED) == len(CASES) == 80
    assert {case.verdict for case in CASES} <= set(VERDICTS)
    for case in CASES:
        assert case.files()
        for pattern in (case.seen, case.cause, case.advice, case.vague, case.wrong, case.well):
            re.compile(pattern)


SETUP = "src/my_bot/setup.py:32"
RIGHT = {
    "code": "entry-point-module",
    "cause": "The entry point names my_bot.status_publisher.py.",
    "place": SETUP,
    "fix": "write my_bot.status_publisher:main",
}


@pytest.mark.parametrize(
    ("changed", "verdict"),
    [
        ({}, "right"),
        ({"place": ""}, "insufficient"),
        ({"place": "install/my_bot/lib/my_bot/status_publisher:25"}, "insufficient"),
        ({"fix": "look at it again"}, "insufficient"),
        ({"fix": ""}, "insufficient"),
        ({"fix": "touch the_module"}, "insufficient"),
        ({"cause": "The workspace is not sourced."}, "wrong"),
    ],
)
def test_an_answer_is_judged_by_its_cause_its_place_and_its_fix(
    changed: dict[str, str], verdict: str
) -> None:
    def in_vain(commands: Sequence[str]) -> bool:
        return False

    assert judged(NAMED["B07-py-in-entry"], {**RIGHT, **changed}, in_vain).verdict == verdict


@pytest.mark.parametrize(
    ("cause", "fix", "verdict"),
    [
        ("Launch says: {seen}", "write executable= instead of node_executable=", "vague"),
        ("Launch says: {seen}. Node needs executable", "write executable=", "right"),
    ],
)
def test_what_was_seen_is_no_cause_and_no_advice_if_it_is_said_again(
    cause: str, fix: str, verdict: str
) -> None:
    """The word that a right answer holds may stand in what Python has printed."""
    seen = "TypeError: Node.__init__() missing 1 required keyword-only argument: 'executable'"
    finding = {
        "code": "passed-on",
        "cause": cause.format(seen=seen),
        "place": "src/my_bot/launch/robot.launch.py:11",
        "fix": fix,
    }
    case = NAMED["D04-node-executable"]
    assert judged(case, finding, lambda commands: False, seen).verdict == verdict


@pytest.mark.parametrize(
    ("fix", "commands"),
    [
        (
            "colcon build --packages-select my_bot, then source install/setup.bash",
            ["colcon build --packages-select my_bot", "source install/setup.bash"],
        ),
        (
            "rm -r src/build, then cd /ws, run colcon build there, and source install/setup.bash",
            ["rm -r src/build", "cd /ws", "colcon build", "source install/setup.bash"],
        ),
        ("type `ros2 launch my_bot robot.launch.py`", ["ros2 launch my_bot robot.launch.py"]),
        ("touch src/my_bot/resource/my_bot", ["touch src/my_bot/resource/my_bot"]),
        ("write QoSProfile(depth=10)", []),
        ("compare it with the file's name; then colcon build", []),
        ("rm -rf /", []),
        ("rm -rf ../other", []),
    ],
)
def test_the_commands_of_a_fix_are_typed(fix: str, commands: list[str]) -> None:
    assert commands_in(fix) == commands
