"""To which command a record assigns what was logged and published."""

from __future__ import annotations

import time
from types import SimpleNamespace
from typing import Any, cast

from std_msgs.msg import String

from ros2lab.observed_domain import ObservedDomain
from ros2lab.run_record import RunRecord
from ros2lab.topics import Sample


def test_what_comes_late_belongs_to_the_command_after_which_it_was_published() -> None:
    """A subscription may get a message when the next command has already been said."""
    logged: list[Sample] = []
    states: list[Sample] = []
    record = RunRecord(observed({"/rosout": logged, "/state": states}), [], "alone")
    published = {}
    for word in ("start", "stop"):
        record.begin(word, "/robot/command")
        published[word] = time.time()
    for word, when in published.items():
        logged.append(Sample(time.monotonic(), SimpleNamespace(level=20, msg=f"Heard {word}"), when))
    for word in ("stop", "start"):  # of two publishers, the second one's may come first
        states.append(Sample(time.monotonic(), String(data=word), published[word]))
    seen = record.run().commands
    assert [command.log for command in seen] == [[["INFO", f"Heard {word}"]] for word in published]
    assert [command.topics["/state"].values for command in seen] == [[{"data": word}] for word in published]


def observed(samples: dict[str, list[Sample]]) -> ObservedDomain:
    """Return a domain in which what comes is what the test says."""

    def log(topic: str, _: str) -> Any:
        return SimpleNamespace(samples=lambda: samples[topic])

    nothing: dict[str, list[str]] = {}
    return cast(
        ObservedDomain,
        SimpleNamespace(
            log=log,
            published=lambda: {"/state": ["std_msgs/msg/String"]},
            publishers=lambda: {"/state": ["robot"]},
            subscribers=lambda: nothing,
            nodes=lambda: ["robot"],
        ),
    )
