"""A status of no word is none, and an executable that leaves its topic to another program does not have its node."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import evidences
import pytest

from ros2lab.grading.evidence import Run
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

STATUS = "/robot/status"


def lost(runs: Sequence[Run]) -> set[str]:
    """Return what costs points of the status and the executables."""
    criteria = verdict(evidences.right([*runs]), load()).criteria
    about = ("status_publisher.", "package.executables")
    return {c.id for c in criteria if c.points < c.max and c.id.startswith(about)}


def with_status(run: Run) -> Run:
    """Return a run whose program publishes the status besides."""
    also = evidences.status_run(program=run.programs[0])
    return replace(
        run,
        nodes=[*run.nodes, *also.nodes],
        publishes={**run.publishes, **also.publishes},
        quiet={**run.quiet, **also.quiet},
    )


@pytest.mark.parametrize(
    ("texts", "is_right"),
    [
        (["", "", ""], False),
        (["", "", "moving"], True),
        (["idle", "idle", ""], True),
        (["。", "。", "。"], True),
        (["0", "0", "0"], True),
        (["?", "?", "?"], True),
        (["🤖", "🤖", "🤖"], True),
        (["\u200b", "\u200b\u200b", "\u200b"], False),
        (["\n", "\r\n", "\t"], False),
        (["\x1b", "\x00", "\x07"], False),
        (["\x1b[8m", "\x1b[0m", "\x1b[2J"], False),
        (["\x1b[8mwell\x1b[0m", "\x1b[0;8mwell", "\x1b[8mwell"], False),
        (["\x1b[38;5;8mwell", "\x1b[38;5;8mwell", "\x1b[38;5;8mwell"], True),
        (["\x1b[1mwell", "\x1b[1mwell", "\x1b[1mwell"], True),
        (["\u00a0", "\u3000", " "], False),
        (["\u202e", "\ufeff", "\U000e0041"], False),
        (["\u3164", "\u2800", "\u115f"], False),
        (["\u0301", "\ufe0f", "\ue000"], False),
        (["\u200b", "\u200bwell", "\u200b"], True),
    ],
)
def test_a_text_that_is_always_empty_is_no_status(texts: list[str], is_right: bool) -> None:
    heard = evidences.heard(evidences.STRING, "/status_publisher", [{"data": text} for text in texts])
    status = replace(evidences.status_run(), quiet={STATUS: heard})
    assert lost([status, evidences.command_run(), evidences.velocity_run()]) == (
        set() if is_right else {"status_publisher.period"}
    )


def test_a_publisher_that_is_only_advertised_is_no_node_where_the_driver_publishes() -> None:
    silent = evidences.status_run(values=0)
    runs = [silent, evidences.command_run(), with_status(evidences.velocity_run())]
    assert "package.executables" in lost(runs)


@pytest.mark.parametrize(
    "runs",
    [
        [evidences.status_run(), evidences.command_run(), with_status(evidences.velocity_run())],
        [evidences.status_run(values=0), evidences.command_run(), evidences.velocity_run()],
        [evidences.status_run("/teller", "teller"), evidences.command_run(), evidences.velocity_run()],
    ],
    ids=["both publish", "a relay that is silent alone", "another name"],
)
def test_other_ways_to_publish_the_status_cost_no_executable(runs: list[Run]) -> None:
    assert "package.executables" not in lost(runs)
