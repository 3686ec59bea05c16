"""What is said of parameters that were set while a node ran: from made-up records, and from a real run."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from right_workspace import right_workspace
from test_trial import build, run_of

from ros2lab import assignments
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.grading.watching.job import Job, Program
from ros2lab.trial import try_out
from ros2lab.trial.given import GivenRun
from ros2lab.trial.parameters import parameter_faults, told_of_set
from ros2lab.trial.run import _OwnJob, _set
from ros2lab.trial.seen import Seen
from ros2lab.trial.set_values import compared_words, settings_of, started_with, told

NAME, TWIST, TOPIC = "velocity_publisher", "geometry_msgs/msg/Twist", "/cmd_vel"
TIMER = "        self.timer = self.create_timer(0.1, self.timer_callback)\n"
READ = "self.get_parameter('speed').value"
CALLBACK = f"{TIMER}        self.add_on_set_parameters_callback(self.changed)\n"
KEPT = f"{CALLBACK}        self.speed = {READ}\n"
USED = "self.speed"
HEAD = "\n    def changed(self, params):\n        for p in params:\n            if p.name == 'speed':\n"
TAKES = "        return SetParametersResult(successful=True)\n"
STORES = f"{HEAD}                self.speed = p.value\n{TAKES}"
LOGS = f"{HEAD}                self.get_logger().info(str(p.value))\n{TAKES}"


def heard(value: Any = 0.5, gap: float = 0.5, log: Sequence[str] = ()) -> dict[str, Any]:
    """Return what the observer tells of 4.2 s in which the driver publishes."""
    times = [gap * number for number in range(int(4.2 / gap))]
    values = [{"linear": {"x": value}} for _ in times]
    topics = {TOPIC: {"values": values, "times": times, "count": len(times)}} if times else {}
    return {"topics": topics, "log": [["INFO", NAME, line] for line in log]}


def record(*parts: dict[str, Any], taken: bool = True, reason: str = "") -> dict[str, Any]:
    """Return what the observer tells of a run in which `speed` was set to 0.25, and back."""
    call = {"node": f"/{NAME}", "name": "speed", "taken": taken, "reason": reason}
    pairs = zip((0.25, 0.5), parts, strict=True)
    sets = [{**call, "value": value, "back": value == 0.5, **part} for value, part in pairs]
    return {"controls": [heard()] * 3, "sets": sets}


REFUSED = {"taken": False, "reason": "too slow"}
SAME = record(heard(), heard())
STARTS = {"controls": [heard(0.25)] * 3}


def said(
    root: Path, result: dict[str, Any], start: dict[str, Any] | None = None, read: Sequence[Finding] = ()
) -> tuple[list[str], list[str]]:
    """Return the codes of what is found, and what is told."""
    tried = [(one, started_with(result, start or {}) if one.is_idle else []) for one in settings_of(result)]
    settings = [replace(one, at_start=changes) for one, changes in tried]
    run = replace(run_of(NAME, TOPIC, TWIST, None), parameters={f"/{NAME}": {"speed": 0.5}})
    seen, ran = (
        Seen(Look(root), assignments.load(), [run], []),
        GivenRun(run, [], frozenset(), settings=settings),
    )
    return [f.code for f in parameter_faults(seen, ran, None, read)], [*told_of_set(seen, ran)]


def written(tmp_path: Path, init: str = TIMER, used: str = USED, method: str = "") -> Path:
    files = right_workspace().only("driver").change("driver", READ, used).change("driver", TIMER, init)
    return files.change("driver", "\n    def timer_callback", f"{method}\n    def timer_callback").write(
        tmp_path
    )


@pytest.mark.parametrize(
    ("code", "result", "wanted"),
    [
        # In vain: the callback accepts a value and keeps it nowhere, or where only the constructor reads it.
        ((KEPT, USED, LOGS), SAME, ["parameter-once"]),
        ((KEPT + "        self.step = self.speed\n", "self.step", STORES), SAME, ["parameter-once"]),
        ((KEPT, USED, STORES.replace("'speed'", "'Speed'")), SAME, ["parameter-name"]),
        ((KEPT, USED, LOGS.replace("p.name == 'speed'", "p.name")), SAME, ["parameter-once"]),
        # Something else may take it later, or it is said to be for the start.
        ((KEPT, READ, LOGS), SAME, []),
        ((KEPT, USED, STORES + "\n    def start(self):\n        self.now = self.speed\n"), SAME, []),
        ((KEPT, USED, STORES + "\n    def work(self, name):\n        return self.get_parameter(name)\n"), SAME, []),
        ((KEPT + "        self.kind = 'speed'\n", USED, LOGS + "\n    def work(self):\n        return self.get_parameter(self.kind)\n"), SAME, []),
        ((KEPT, USED, LOGS + "\n    def work(self, names):\n        return self.get_parameter(names[0])\n"), SAME, []),
        ((KEPT, USED, LOGS + "\n    def work(self):\n        return self.get_parameter('gain')\n"), SAME, ["parameter-once"]),
        ((KEPT + "        # speed: restart to change it\n", USED, LOGS), SAME, []),
        # The callback is one change behind.
        ((KEPT, USED, STORES), record(heard(), heard(0.25)), ["callback-waits"]),
        ((KEPT, USED, STORES), record(heard(), heard(gap=0.25)), ["callback-waits"]),
        ((KEPT, USED, STORES), record(heard(), heard(gap=4.0)), []),  # late once, which may be chance
        ((KEPT, USED, STORES), record(heard(0.25), heard()), []),
        ((KEPT, USED, STORES), record(REFUSED, heard(0.25)), []),
        ((KEPT, USED, STORES), record(REFUSED, {**heard(0.25), "back": False}), []),  # the next one, which ended it
        ((KEPT, USED, STORES), record(heard(), {**heard(0.25), "back": False}), []),
        ((KEPT, USED, STORES), record(heard(), REFUSED), []),
        # It refuses all, and says nothing.
        ((KEPT, USED, LOGS.replace("successful=True", "")), record({}, {}, taken=False), ["value-none"]),
        ((KEPT, USED, LOGS.replace("True", "False")), record({}, {}, taken=False), []),  # on purpose
        ((KEPT, USED, LOGS), record({}, {}, taken=False, reason="too fast"), []),
    ],
)  # fmt: skip
def test_a_callback_that_does_not_take_values_is_found(
    tmp_path: Path, code: tuple[str, str, str], result: dict[str, Any], wanted: list[str]
) -> None:
    """Where the value counts at the start, and nothing else may take it."""
    assert said(written(tmp_path, *code), result, STARTS)[0] == wanted


def test_what_reading_has_found_there_is_not_found_again(tmp_path: Path) -> None:
    """A line of the callback has its finding."""
    root = written(tmp_path, KEPT, USED, STORES)
    (path,) = root.rglob("velocity_publisher.py")
    line = path.read_text().splitlines().index("                self.speed = p.value") + 1
    known = Finding("never-read", "", f"{path.relative_to(root)}:{line}", "")
    assert said(root, SAME, STARTS)[0] == ["parameter-once"]
    assert said(root, SAME, STARTS, [known])[0] == []


@pytest.mark.parametrize(
    ("result", "start", "wanted"),
    [
        (record(heard(0.25), heard()), None, "With speed = 0.25, set while /velocity_publisher ran, linear.x = 0.25 comes on /cmd_vel instead of linear.x = 0.5."),
        (record(heard(gap=1.0), heard()), None, "With speed = 0.25, set while /velocity_publisher ran, a message comes on /cmd_vel every 1 s instead of 0.5 s."),
        (record(heard(log=["turn 1", "turn 2"]), heard()), None, "With speed = 0.25, set while /velocity_publisher ran, 'turn #' is logged."),
        (record(heard(log=["once"]), heard()), None, ""),
        (record(heard(0.25), heard(0.1)), None, ""),  # it varies by itself
        (record({}, {}, taken=False, reason="too slow"), None, "/velocity_publisher refused speed = 0.25: too slow."),
        (SAME, STARTS, "speed = 0.25, set while /velocity_publisher ran, changed nothing; if it starts with it, linear.x = 0.25 comes on /cmd_vel instead of linear.x = 0.5: it is read once, at PLACE."),
        (SAME, {"controls": [heard(0.25), heard(), heard(0.25)]}, ""),
        (SAME, {"controls": [heard(0.25)]}, ""),  # it ended
        (SAME, None, ""),
    ],
)  # fmt: skip
def test_what_came_of_it_is_told(
    tmp_path: Path, result: dict[str, Any], start: dict[str, Any] | None, wanted: str
) -> None:
    """Also that it is read once, which is no fault in itself."""
    root = written(tmp_path, f"{TIMER}        self.speed = {READ}\n")
    (path,) = root.rglob("velocity_publisher.py")
    line = next(n for n, row in enumerate(path.read_text().splitlines(), 1) if f"self.speed = {READ}" in row)
    faults, sentences = said(root, result, start)
    assert faults == []
    assert sentences == [wanted.replace("PLACE", f"{path.relative_to(root)}:{line}")] * bool(wanted)


def test_each_word_of_a_text_is_compared() -> None:
    """A number in it may count, and the rest be as before."""

    def status(first: int, mood: str) -> dict[str, Any]:
        values = [{"data": f"tick {first + number} {mood}"} for number in range(3)]
        return {"topics": {"/status": {"values": values, "times": [0.0, 1.0, 2.0], "count": 3}}, "log": []}

    result = {"controls": [status(number, "calm") for number in (1, 4, 7)]}
    assert told(started_with(result, {"controls": [status(n, "loud") for n in (1, 4, 7)]})) == (
        "word 3 of data = 'loud' comes on /status instead of word 3 of data = 'calm'"
    )
    assert started_with(result, {"controls": [status(n, "calm") for n in (2, 5, 8)]}) == []


def test_texts_are_set_that_the_code_compares_with_the_same(tmp_path: Path) -> None:
    """Without parameters there are none."""
    more = "        self.mode = 'slow'\n        if self.mode == 'slow' or self.mode == 'fast':\n            pass\n"
    words = compared_words(Look(written(tmp_path / "one", TIMER + more)))
    assert ["mode", "slow", "fast"] in [[name, *sorted(texts, reverse=True)] for name, *texts in words or ()]
    files = right_workspace().change("driver", "self.declare_parameter('speed', 0.5)", "pass")
    assert compared_words(Look(files.write(tmp_path / "two"))) is None


MORE = f"{KEPT}        self.declare_parameter('gain', 1.0)\n"


@pytest.mark.parametrize(
    ("init", "used", "method", "result", "tried"),
    [
        (KEPT, USED, LOGS, SAME, ["speed:=0.25"]),
        (MORE, USED, LOGS, SAME, ["speed:=0.25"]),  # nothing reads the other one
        (f"{MORE}        self.gain = self.get_parameter('gain').value\n", USED, LOGS, SAME, ["speed:=0.25", "gain:=0.25"]),
        (MORE.replace("self.declare", "self.gain = self.declare"), USED, LOGS, SAME, ["speed:=0.25", "gain:=0.25"]),
        (KEPT, READ, LOGS, SAME, []),
        (f"{KEPT}        # speed: restart to change it\n", USED, LOGS, SAME, []),
        (KEPT, USED, LOGS, record(heard(0.25), heard()), []),
    ],
)  # fmt: skip
def test_programs_are_started_anew_only_where_that_tells_something(
    tmp_path: Path, *, init: str, used: str, method: str, result: dict[str, Any], tried: list[str]
) -> None:
    """On the clock that was stepped, or on the real one, as when the values were set."""
    watched = list[Job]()
    observer: Any = SimpleNamespace(watch=lambda jobs, within: watched.extend(jobs if within < 20 else []))
    others = [{**one, "name": "gain"} for one in result["sets"]]
    seen = Seen(
        Look(written(tmp_path, init, used, method)),
        assignments.load(),
        [run_of(NAME, TOPIC, TWIST, None)],
        [],
    )
    for is_stepped in (True, False):
        watched.clear()
        with contextlib.ExitStack() as leases:
            job = _OwnJob(leases, [Program(NAME, [])], plan={"settings": []}, is_stepped=is_stepped)
            job.result = {**result, "sets": [*result["sets"], *others]}
            _set(observer, leases, job, seen)
        found = [word for one in watched for program in one.programs for word in program.parameters]
        assert (len(watched), found) == (len(tried) + bool(tried), tried)
        assert {one.is_stepped for one in watched} == ({is_stepped} if tried else set())


def test_a_callback_that_keeps_nothing_is_seen_in_a_real_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The node starts with the other value, too, to see that it counts."""
    imported = "from rcl_interfaces.msg import SetParametersResult\n"
    root = written(tmp_path / "wrong", KEPT, USED, LOGS)
    (path,) = root.rglob("velocity_publisher.py")
    path.write_text(imported + path.read_text())
    build(root)
    monkeypatch.setattr("ros2lab.trial.run._STARTS", math.inf)  # a busy machine takes longer
    found = try_out(root).findings
    assert [f.code for f in found if f.code.startswith("parameter")] == ["parameter-once"]
