"""Many at once: what crashes, hangs or says nothing is one row, and closing the iterator ends everything."""

from __future__ import annotations

import io
import json
import sys
import threading
from pathlib import Path

import pytest

from ros2lab.classroom import one
from ros2lab.classroom.capacity import MEMORY, PROCESSES, Gate, jobs_for
from ros2lab.classroom.display import Display
from ros2lab.classroom.gradebook import Seen
from ros2lab.classroom.one import CannotGrade
from ros2lab.classroom.side_by_side import Done, Step, Task, grade

# Instead of the grader: what it does is what the submission is called.
GRADER = """
import json, os, sys, time
name = os.path.basename(json.loads(sys.stdin.readline())["paths"][0])
print(json.dumps({"step": "building"}), flush=True)
if name == "crashes": os.kill(os.getpid(), 11)
if name == "says": sys.exit("it went wrong here")
if name == "hangs": time.sleep(600)
if name == "cannot": print(json.dumps({"cannot": "Install bubblewrap."}), flush=True)
elif name == "fails": print(json.dumps({"failed": "RuntimeError"}), flush=True)
else: print(json.dumps({"seen": {"evidence": name, "sources": {}, "problem": "", "seconds": 1}}), flush=True)
"""


@pytest.fixture(autouse=True)
def grader(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(one, "COMMAND", [sys.executable, "-c", GRADER])


def tasks(*names: str) -> list[Task]:
    return [Task(name, (Path(name),), name, (name,)) for name in names]


def test_one_that_crashes_is_a_sentence_and_the_others_are_graded() -> None:
    events = [*grade(tasks("a", "crashes", "says", "fails", "b"), 2, None)]
    results = {event.task.name: event.result for event in events if isinstance(event, Done)}
    assert isinstance(results["a"], Seen)
    assert isinstance(results["b"], Seen)
    assert results["crashes"] == "The grader ended with -11."
    assert results["says"] == "The grader ended with 1: it went wrong here."
    assert results["fails"] == "RuntimeError"
    assert {event.text for event in events if isinstance(event, Step)} == {"building"}


def test_one_that_hangs_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(one, "TOO_LONG", 0.5)
    *_, event = grade(tasks("hangs"), 1, None)
    assert isinstance(event, Done)
    assert event.result == "The grader ended with -9."


def test_a_machine_that_cannot_grade_ends_the_class(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(one, "refusal", lambda: "Install bubblewrap.")
    with pytest.raises(CannotGrade, match="bubblewrap"):
        list(grade(tasks("cannot", "hangs", "hangs"), 2, None))


def test_one_that_cannot_be_graded_where_others_can_is_a_sentence() -> None:
    results = {
        event.task.name: event.result
        for event in grade(tasks("cannot", "a"), 1, None)
        if isinstance(event, Done)
    }
    assert results["cannot"] == "Install bubblewrap."
    assert isinstance(results["a"], Seen)


def test_closing_ends_what_runs() -> None:
    events = grade(tasks("hangs", "hangs", "a"), 2, None)
    next(events)
    events.close()  # that no process is left is seen by the fixture of every test


def test_as_many_run_at_once_as_the_machine_bears() -> None:
    plenty = 10**12
    assert jobs_for(2, plenty, plenty) == 8
    assert jobs_for(16, plenty, plenty) == 64
    assert jobs_for(16, 4 * MEMORY, plenty) == 4
    assert jobs_for(16, plenty, 2 * PROCESSES) == 2
    assert jobs_for(1, 0, 0) == 1


def test_beyond_one_for_each_processor_a_grading_begins_only_where_there_is_time_to_spare() -> None:
    """What waits holds up nobody, and what works is not made slower."""
    spare, looks = [0.0], threading.Semaphore(0)

    def look() -> float:
        looks.release()
        return spare[0]

    gate = Gate(2, look)
    events = grade(tasks("hangs", "hangs", "hangs"), 3, None, gate)
    begun = [next(events) for _ in range(2)]
    for _ in range(3):
        looks.acquire()  # whichever is the third has looked, and waits
    spare[0] = 1.0
    begun.append(next(events))
    assert [type(event) for event in begun] == [Step] * 3
    assert len({id(event.task) for event in begun}) == 3
    events.close()


def test_who_waits_at_the_gate_is_let_go_at_the_end() -> None:
    events = grade(tasks("hangs", "hangs"), 2, None, Gate(1, lambda: 0.0))
    next(events)
    events.close()


def test_the_display_counts_and_tells_the_rate_and_the_time_left(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = [0.0]
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with Display(4, "usual", lambda: now[0]) as display:
        display.step("1", "Ann\x1b[2J", "building")
        now[0] = 30.0
        display.end("1", "Ann\x1b[2J", "90 of 100", {}, has_failed=False)
        said = sys.stderr.getvalue()  # type: ignore[attr-defined]
    assert said == "1/4 Ann␛[2J: 90 of 100 (30 s; 2.0 a minute, 90 s left)\n".replace(
        "90 s left", "2 min left"
    )
    with Display(1, "json", lambda: now[0]) as display:
        display.end("1", "Ann", "x", {"total": 90}, has_failed=False)
    event = json.loads(capsys.readouterr().out)
    assert (event["event"], event["name"], event["total"], event["done"]) == ("done", "Ann", 90, 1)
    with Display(1, "quiet", lambda: now[0]) as display:
        display.step("1", "Ann", "building")
        display.end("1", "Ann", "x", {}, has_failed=True)
    assert display.failed == 1
