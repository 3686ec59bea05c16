"""What several programs did is shared out among them, and not at all where it cannot be told who did it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from ros2lab.grading.watching.shares import shared_out

TALK, LISTEN = "/program_0", "/program_1"


def seen() -> dict[str, Any]:
    """Return what was seen of a program that talks, and of one that takes a command and answers."""
    told = ["INFO", "ears.deep", "It was told go."]
    return {
        "nodes": ["/ears", "/mouth"],
        "enclaves": {"/ears": [LISTEN], "/mouth": [TALK]},
        "publishes": {
            "/says": {"/mouth": ["std_msgs/msg/String"]},
            "/is": {"/ears": ["std_msgs/msg/String"]},
        },
        "subscribes": {
            "/told": {"/ears": ["std_msgs/msg/String"]},
            "/is": {"/mouth": ["std_msgs/msg/String"]},
        },
        "services": {},
        "qos": {"/is": ["publisher reliable transient_local", "subscriber reliable volatile"]},
        "parameters": {"/ears": {}, "/mouth": {"period": 2.0}},
        "quiet": {"/says": {"count": 3}, "/is": {"count": 1}},
        "log": [["INFO", "mouth", "It talks."]],
        "commanded": "/told",
        "commands": [
            {
                "text": "go",
                "topics": {"/is": {"count": 1}, "/says": {"count": 2}},
                "log": [told],
                "parameters": {"/mouth:period": 1.0},
            }
        ],
        "calls": [],
        "final": {"/is": "going", "/says": "bye"},
        "notes": [],
        "twins": [],
        "stalled": [],
    }


def test_each_has_its_own_nodes_topics_and_log_lines() -> None:
    mouth, ears = shared_out(seen(), [TALK, LISTEN])
    assert (mouth["nodes"], ears["nodes"]) == (["/mouth"], ["/ears"])
    assert (mouth["quiet"], ears["quiet"]) == ({"/says": {"count": 3}}, {"/is": {"count": 1}})
    assert (mouth["log"], ears["log"]) == (seen()["log"], [])
    assert ears["commands"][0]["log"] == seen()["commands"][0]["log"]
    assert ears["commands"][0]["topics"] == {"/is": {"count": 1}}
    assert ears["commands"][0]["parameters"] == {}
    assert (mouth["qos"], ears["qos"]) == (
        {"/is": ["subscriber reliable volatile"]},
        {"/is": ["publisher reliable transient_local"]},
    )


def test_who_takes_no_command_was_told_none() -> None:
    assert shared_out(seen(), [TALK, LISTEN])[0]["commands"] == []


@pytest.mark.parametrize(
    "change",
    [
        lambda seen: seen["enclaves"].update({"/ears": [TALK]}),  # one program has no node
        lambda seen: seen["enclaves"].update({"/ears": [LISTEN, TALK]}),  # two have a node of this name
        lambda seen: seen["enclaves"].update({"/ears": ["/"]}),  # a program takes no arguments
        lambda seen: seen["publishes"]["/says"].update({"/ears": ["std_msgs/msg/String"]}),
        lambda seen: seen["publishes"].update({"/told": {"/mouth": ["std_msgs/msg/String"]}}),
        lambda seen: seen["log"].append(["INFO", "somebody", "It talks."]),
        lambda seen: seen["parameters"].pop("/ears"),  # it does not answer
        lambda seen: seen["notes"].append("A node is slow to answer: not all of the commands were tried."),
        lambda seen: seen["twins"].append("/ears"),
        lambda seen: seen["stalled"].append("/says"),
    ],
)
def test_what_is_open_is_shared_out_to_nobody(change: Callable[[dict[str, Any]], object]) -> None:
    open_one = seen()
    change(open_one)
    assert shared_out(open_one, [TALK, LISTEN]) == []


def test_of_what_was_given_up_nothing_is_shared_out() -> None:
    assert shared_out({}, [TALK, LISTEN]) == []
