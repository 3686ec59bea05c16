"""What colcon did is read from the record of the extension, and nothing that only looks like it."""

from __future__ import annotations

import json

import pytest

from ros2lab.colcon_record import FoundPackage, Message, Record, read_record

FOUND = {"name": "talk", "path": "src/it's", "type": "ros.ament_python"}
ENTRIES: list[dict[str, object]] = [
    {"event": "begun", "time": 7.0},
    {"event": "found", "time": 7.1, "packages": [FOUND]},
    {"event": "logged", "time": 7.2, "is_error": False, "text": "a path\n  is gone"},
    {"event": "executing", "time": 7.3},
    {"event": "unselected", "time": 7.3, "job": "other"},
    {"event": "queued", "time": 7.3, "job": "talk"},
    {"event": "queued", "time": 7.3, "job": "listen"},
    {"event": "started", "time": 7.5, "job": "talk"},
    {"event": "stderr", "time": 7.6, "job": "talk", "text": "error: can't copy 'résource/talk'\n"},
    {"event": "stderr", "time": 7.7, "job": "talk", "text": "two\nlines\n"},
    {"event": "ended", "time": 9.0, "job": "talk", "code": 1},
]
TEXT = "".join(f"{json.dumps(entry)}\n" for entry in ENTRIES)


def test_a_run() -> None:
    """What became of each package, when, and what it wrote."""
    record = read_record(TEXT)
    assert (record.is_begun, record.is_executing) == (True, True)
    assert record.packages == [FoundPackage("talk", "src/it's", "ros.ament_python")]
    assert record.messages == [Message(False, "a path\n  is gone")]
    assert list(record.jobs) == ["other", "talk", "listen"]
    talk = record.jobs["talk"]
    assert (talk.returncode, talk.seconds, talk.has_failed) == (1, 1.5, True)
    assert talk.errors == ["error: can't copy 'résource/talk'", "two", "lines"]
    assert (record.jobs["listen"].started, record.jobs["listen"].returncode) == (None, None)
    assert not record.jobs["other"].is_selected


def test_a_record_that_is_cut_off() -> None:
    """A record that ends in the middle of a line, as after a kill, still tells what it holds."""
    record = read_record(TEXT[:-20])
    assert record.jobs["talk"].started == 7.5
    assert record.jobs["talk"].returncode is None
    assert record.jobs["talk"].seconds == 0.0
    assert read_record("") == Record()


@pytest.mark.parametrize(
    "line",
    [
        "100 of 100 points",
        "[1.0] (pk) JobEnded: {'rc': 0}",
        "null",
        "[" * 100_000,
        "1" * 100_000,
        '{"event": ["ended"]}',
        '{"event": "found"}',
        '{"event": "found", "packages": {"name": "pk"}}',
        '{"event": "ended", "job": "pk", "time": 1.0, "code": null}',
        '{"event": "ended", "job": ["pk"], "time": 1.0, "code": 0}',
        '{"event": "ended", "job": "pk", "time": "1.0", "code": 0}',
        '{"event": "stderr", "job": "pk", "text": 5}',
        '{"event": "logged", "is_error": "yes", "text": "x"}',
        "\x00\udc80",
    ],
)
def test_what_has_not_the_form_of_a_record_says_nothing(line: str) -> None:
    assert read_record(line) == Record()
    assert read_record(f"{line}\n{TEXT}") == read_record(TEXT)


def test_packages_of_another_form_are_left_out() -> None:
    entry = {"event": "found", "packages": [None, {"name": "pk"}, {**FOUND, "path": 3}, FOUND]}
    assert read_record(json.dumps(entry)).packages == [FoundPackage("talk", "src/it's", "ros.ament_python")]


def test_times_without_a_value_do_no_harm() -> None:
    lines = [
        '{"event": "started", "job": "pk", "time": NaN}',
        '{"event": "ended", "job": "pk", "time": Infinity, "code": 0}',
    ]
    assert read_record("\n".join(lines)).jobs["pk"].seconds == 0.0
