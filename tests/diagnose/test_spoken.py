"""What is told of runs is true: in which rhythm, of which program, after which message, and whether it may still come."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from right_workspace import right_workspace
from test_trial import TWIST, build, run_of, twist
from workspace_files import Files

from ros2lab import assignments
from ros2lab.diagnose.look import Look
from ros2lab.grading.evidence import GIVEN, CommandSeen, Heard, Run
from ros2lab.trial import record, try_out
from ros2lab.trial.effects import did_given
from ros2lab.trial.given import GivenRun
from ros2lab.trial.moving import still_moving
from ros2lab.trial.rivals import rival_faults, told_of_rivals
from ros2lab.trial.seen import Seen, seen_faults
from ros2lab.trial.spoken import Said, Sent, content, rhythm, unstamped
from ros2lab.trial.story import told_of

NUMBER, BOOL = "std_msgs/msg/Float64", "std_msgs/msg/Bool"


@pytest.mark.parametrize(
    ("times", "is_stepped", "said"),
    [
        ((0.5, 1.0, 1.5, 2.0), True, ", about one every 0.5 s"),
        ((0.1, 0.2, 0.3, 0.4), True, ", one every 0.1 s or more often"),
        ((0.02, 0.42, 0.81, 1.22), False, ", about one every 0.4 s"),
        ((1.0, 2.0, 3.0), True, ", about 1 s apart"),
        ((1.0, 2.0), True, ""),
        ((1.5, 1.5, 2.0), True, ""),  # two at once
        ((1.0, 1.5, 3.0, 3.5), True, ""),  # bursts
        ((1.0, 1.1, 1.2, 4.0), False, ""),
    ],
)
def test_only_even_times_are_a_rhythm(times: Sequence[float], is_stepped: bool, said: str) -> None:
    assert rhythm(times, is_stepped=is_stepped) == said


def test_a_text_that_is_cut_is_quoted_as_one() -> None:
    assert content([{"data": "humidity 1.0 %, " * 9}]) == (
        f", with data = '{('humidity 1.0 %, ' * 9)[:57]}...'",
        False,
    )


def stamped(*seconds: int, kind: str = "") -> list[dict[str, Any]]:
    headers = [{"header": {"stamp": {"sec": s, "nanosec": 0}, "frame_id": "map"}, "x": 1.0} for s in seconds]
    return [{kind: [header]} for header in headers] if kind else headers


@pytest.mark.parametrize(
    ("values", "is_told"),
    [
        (stamped(0, 0, 0), True),
        (stamped(0, 0, 0, kind="transforms"), True),
        (stamped(0, 1, 2), False),  # the clock began at 0
        (stamped(0, 0), False),
        ([{"data": "a"}] * 3, False),
        ([{"transforms": []}] * 3, False),
        ([{"header": None}] * 3, False),
        ([{}, None, {"header": {"stamp": None}}], False),
    ],
)
def test_a_stamp_that_stays_at_its_default_is_told(values: Sequence[Any], is_told: bool) -> None:
    assert bool(unstamped(values, [])) is is_told


@pytest.mark.parametrize(
    ("seconds", "line", "is_told"),
    [
        ((0, 0, 0), "", True),
        ((0, 0, 0), "self.goal.header.frame_id = 'map'", True),
        ((1, 2, 3), "", False),
        # Set once, when the clock that begins at 0 stands there; or to 0, which tf2 takes for the latest.
        ((0, 0, 0), "self.goal.header.stamp = self.get_clock().now().to_msg()", False),
        ((0, 0, 0), "self.goal.header = self.header", False),
        ((0, 0, 0), "self.goal = PointStamped(header=Header(stamp=Time().to_msg()))", False),
        ((0, 0, 0), "self.goal.header.stamp.sec = 0", False),
    ],
)
def test_of_what_a_program_published_its_stamps_are_told(
    tmp_path: Path, seconds: Sequence[int], line: str, is_told: bool
) -> None:
    kind = "geometry_msgs/msg/PointStamped"
    heard = Heard(kind, "/status_publisher", [0.5, 1.0, 1.5], stamped(*seconds), 3)
    run = run_of("status_publisher", "/point", kind, heard)
    files = right_workspace().change(
        "node", "        self.count = 0\n", f"        self.count = 0\n        {line}\n"
    )
    seen = Seen(Look(files.write(tmp_path)), assignments.load(), [run], [])
    assert ("each with a stamp of 0" in told_of(seen, run, frozenset())) is is_told


def side(last: float, *bounds: float) -> record.Side:
    return record.Side(str(float(last)), bool(bounds), [str(float(bound)) for bound in bounds], 0)


@pytest.mark.parametrize(
    ("short", "longer", "moves"),
    [
        (side(0.2, 0, 0.2), side(0.1, -1, 1), False),  # it turns back
        (side(0.2, 0, 0.2), side(0.9, 0, 0.9), True),  # it goes on
        (side(93, 93, 100), side(40, 40, 100), True),
        (side(0.3, 0, 0.3), side(0.3, 0, 0.3), False),  # it stands
        (side(0.2, 0, 0.2), None, True),  # nobody knows
        (side(0.1, 0, 0.2), None, False),
        (side(3), None, False),
        (side(8, 0, 8), side(40, 0, 40), False),  # it has passed 5 without meeting it
    ],
)
def test_a_number_that_still_moves_may_come_to_its_limit(
    short: record.Side, longer: record.Side | None, moves: bool
) -> None:
    def noted(found: record.Side | None, held: int = 0) -> Any:
        tests = {("place",): record.Test(held, 9, 9, [found, side(5)])} if found else {}
        return SimpleNamespace(tests=tests)

    assert bool(still_moving(noted(short), noted(longer))) == moves
    assert not still_moving(noted(short, held=1), noted(longer))


def sent(*values: Any, every: float = 0.1, begin: float = 0.0) -> Sent:
    return Sent(len(values), [begin + every * number for number in range(len(values))], [*values])


def numbers(*values: float, **when: float) -> Sent:
    return sent(*({"data": value} for value in values), **when)


def workspace(root: Path, *, is_launched: bool = True) -> Look:
    files = right_workspace()
    if not is_launched:
        files.change(
            "launch/robot.launch.py", "        Node(package='my_bot', executable='status_publisher'),\n", ""
        )
    return Look(files.write(root), loads=True)


def both(look: Look, kind: str, first: Sent, second: Sent) -> Seen:
    """Return what was seen of two programs that publish on one topic."""
    names = ("status_publisher", "velocity_publisher")
    alone = [run_of(name, "/cmd_vel", kind, None) for name in names]
    ends = {"/cmd_vel": {f"/{name}": [kind] for name in names}}
    together = replace(alone[0], programs=[*names], publishes=ends, setting="together")
    said = Said({}, {name: {"/cmd_vel": found} for name, found in zip(names, (first, second), strict=True)})
    return Seen(look, assignments.load(), alone, [together], said=said)


GO, STOP = sent(*[twist(0.25)] * 9), sent(*[twist()] * 9)


@pytest.mark.parametrize(
    ("first", "second", "kind", "is_told"),
    [
        (STOP, GO, TWIST, True),
        (GO, STOP, TWIST, True),
        (sent(*[twist(0.5)] * 9), sent(*[twist(0.3, z=0.1)] * 9), TWIST, True),
        (GO, GO, TWIST, False),
        (sent(*[twist()] * 9, begin=1.0), GO, TWIST, False),  # they take turns
        (sent(*[twist()] * 2), GO, TWIST, False),  # it stops now and then
        (sent(twist(0.25), *[twist()] * 8), GO, TWIST, False),  # it may follow the other
        (numbers(*[1.0] * 9), numbers(*[2.0] * 9), NUMBER, False),  # many may tell what they measure
        (
            sent(*[{"joint_names": ["left"], "positions": [1.0]}] * 9),
            sent(*[{"joint_names": ["right"], "positions": [0.0]}] * 9),
            "trajectory_msgs/msg/JointTrajectory",
            False,
        ),
        (
            sent(*[{"joint_names": ["left"], "positions": [1.0]}] * 9),
            sent(*[{"joint_names": ["left"], "positions": [0.0]}] * 9),
            "trajectory_msgs/msg/JointTrajectory",
            True,
        ),
    ],
)
def test_two_that_command_one_topic_are_told(
    tmp_path: Path, first: Sent, second: Sent, kind: str, is_told: bool
) -> None:
    seen = both(workspace(tmp_path / "launched"), kind, first, second)
    assert [found.code for found in rival_faults(seen)] == ["commanded-by-two"] * is_told
    assert told_of_rivals(seen) == []
    seen = both(workspace(tmp_path / "apart", is_launched=False), kind, first, second)
    assert [*rival_faults(seen)] == []  # they may be alternatives
    assert len(told_of_rivals(seen)) == is_told


def test_of_two_the_one_with_nothing_to_say_is_named_first(tmp_path: Path) -> None:
    (found,) = rival_faults(both(workspace(tmp_path), TWIST, GO, STOP))
    assert found.about == ("velocity_publisher", "status_publisher")
    assert "linear.x = 0.25" in found.cause
    assert "velocity_publisher.py" in found.place


def test_what_a_program_publishes_for_another_is_told(tmp_path: Path) -> None:
    """A relay is silent only where nobody publishes what it waits for."""
    relay = replace(
        run_of("status_publisher", "/out", NUMBER, None), subscribes={"/in": {"/status_publisher": [NUMBER]}}
    )
    source = run_of(
        "velocity_publisher", "/in", NUMBER, Heard(NUMBER, "/velocity_publisher", [0.1], [{"data": 1.0}], 1)
    )
    out = Heard(NUMBER, "/status_publisher", [0.1, 0.2], [{"data": 1.0}, {"data": 2.0}], 2)
    together = replace(
        relay,
        programs=["status_publisher", "velocity_publisher"],
        publishes={**relay.publishes, **source.publishes},
        quiet={"/out": out, **source.quiet},
    )
    look = workspace(tmp_path)

    def told(*runs: Run, said: Said | None = None) -> str:
        seen = Seen(
            look, assignments.load(), [relay, source][: 2 if runs else 1], runs, said=said or Said({}, {})
        )
        return told_of(seen, relay, frozenset())

    assert "published 2 messages on /out: data 1 or 2" in told(together)
    noted = Said({}, {"status_publisher": {"/out": numbers(5.0, 5.0, 5.0)}})
    assert "published 3 messages on /out, each of them with data = 5" in told(together, said=noted)
    silent = replace(together, quiet=source.quiet)
    assert "published nothing there while" in told(silent)
    assert "published nothing there by itself while" in told()


@pytest.mark.parametrize(
    ("alone", "together", "is_told"),
    [
        ({}, {}, True),
        ({"status_publisher": {"/pile": numbers(1.0)}}, {}, False),
        ({}, {"status_publisher": {"/pile": numbers(1.0)}}, False),
        ({"status_publisher": {"/pile": Sent(0, [], [])}}, {}, True),
        ({"status_publisher": {"/other": numbers(1.0)}}, {}, True),
        ({"velocity_publisher": {"/pile": numbers(1.0)}}, {}, True),  # another program
    ],
)
def test_silent_is_what_was_neither_heard_nor_noted(
    tmp_path: Path, alone: dict[str, Any], together: dict[str, Any], *, is_told: bool
) -> None:
    """A message that was sent too early, or lost, was published all the same."""
    run = run_of("status_publisher", "/pile", NUMBER, None)
    both_run = replace(run, setting="together")
    said = Said(alone, together)
    seen = Seen(workspace(tmp_path), assignments.load(), [run], [both_run] * bool(together), said=said)
    assert [one.code for one in seen_faults(seen)] == ["publishes-nothing"] * is_told


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (numbers(*[3.0] * 9), numbers(*[3.0] * 9), "published 9 messages on /out as before, each of them with data = 3"),
        (numbers(*[3.0] * 9), numbers(3.0, 4.0), "published 2 messages on /out: data 3 or 4 (before that data = 3)"),
        (numbers(1.0, 2.0, 3.0), numbers(4.0, 5.0), "went on publishing on /out, where its values vary by themselves"),
        (
            numbers(*[3.0] * 4, every=0.5),
            numbers(*[3.0] * 9, every=0.2),
            "published 9 messages on /out as before, each of them with data = 3, now one every 0.2 s instead of 0.5 s",
        ),
        (
            numbers(1.0, 2.0, 3.0, every=0.5),
            numbers(4.0, 5.0, 6.0, every=0.49),
            "went on publishing on /out, as often as before, where its values vary by themselves",
        ),
        (None, numbers(4.0), "published 1 message on /out, with data = 4"),
        (numbers(*[3.0] * 9), None, "published nothing more on /out in 1.5 s (before: one every 0.1 s or more often)"),
        (
            numbers(*[3.0] * 9),
            numbers(*[0.0] * 5, *[3.0] * 5, *[0.0] * 5, begin=0.06),
            "published 15 messages on /out: data = 0 after data = True; data = 3 after data = False",
        ),
        (
            numbers(*[3.0] * 9),
            Sent(5, [0.56, 0.66, 0.76, 0.86, 0.96], [{"data": 3.0}] * 5),
            "published 5 messages on /out: nothing after data = True; data = 3 after data = False",
        ),
    ],
)  # fmt: skip
def test_what_changes_with_what_is_given_is_told(
    tmp_path: Path, before: Sent | None, after: Sent | None, said: str
) -> None:
    name = "status_publisher"
    heard = Heard(NUMBER, f"/{name}", [*before.times], [*before.values], before.count) if before else None
    alone = run_of(name, "/out", NUMBER, heard)
    among = replace(alone, setting=GIVEN, given=["/on"], quiet={})
    gave = [(0.0, "/on", {"data": True}), (0.5, "/on", {"data": False}), (1.0, "/on", {"data": True})]
    gave += [(1.5, "/on", {"data": True})]
    given = GivenRun(among, [], frozenset(), {name: {"/out": after}} if after else {}, gave)
    seen = Seen(workspace(tmp_path), assignments.load(), [alone], [])
    assert did_given(seen, alone, given, ["/on"], is_over=False) == [said]


@pytest.mark.parametrize(
    ("quiet", "answers", "after", "said"),
    [
        ([], [2.5, 5.0], [2.5, 7.0], "published 2 messages on /out: data 2.5 or 7"),
        ([1.0, 1.0], [2.5, 5.0], [2.5, 7.0], "published 2 messages on /out: data 2.5 or 7"),
        ([1.0, 2.0], [3.0, 4.0], [5.0, 6.0], "went on publishing on /out, where its values vary by themselves"),
        ([], [2.5, 2.5], [2.5, 2.5], "published 2 messages on /out as before, each of them with data = 2.5"),
        ([], [2.5, 2.5], [2.5, 7.0], "published 2 messages on /out: data 2.5 or 7 (before that data = 2.5)"),
        ([], [], [2.5, 7.0], "published 2 messages on /out: data 2.5 or 7"),
    ],
)  # fmt: skip
def test_what_answers_words_does_not_vary_by_itself(
    tmp_path: Path, quiet: list[float], answers: list[float], after: list[float], said: str
) -> None:
    def heard(values: list[float]) -> dict[str, Heard]:
        found = numbers(*values)
        return {"/out": Heard(NUMBER, "/n", [*found.times], [*found.values], found.count)} if values else {}

    commands = [CommandSeen("dance", [], heard(answers), {}, is_alive=True)]
    alone = replace(run_of("status_publisher", "/out", NUMBER, None), quiet=heard(quiet), commands=commands)
    among = replace(alone, setting=GIVEN, given=["/on"], quiet={}, commands=[])
    sent_then = {"status_publisher": {"/out": numbers(*after)}}
    given = GivenRun(among, [], frozenset(), sent_then, [(0.0, "/on", {"data": "a"})])
    seen = Seen(workspace(tmp_path), assignments.load(), [alone], [])
    (text,) = did_given(seen, alone, given, ["/on"], is_over=False)
    assert text.replace(", as often as before", "") == said


def test_what_was_only_heard_is_not_placed_between_what_was_given(tmp_path: Path) -> None:
    """Its times are those of the run, and a program notes its own by the clock of the machine."""
    name, after = "status_publisher", numbers(*[0.0] * 5, *[3.0] * 5, *[0.0] * 5, begin=0.06)
    heard = Heard(NUMBER, f"/{name}", [*after.times], [*after.values], after.count)
    alone = run_of(name, "/out", NUMBER, None)
    among = replace(alone, setting=GIVEN, given=["/on"], quiet={"/out": heard})
    gave = [(0.5 * step, "/on", {"data": step != 1}) for step in range(4)]
    seen = Seen(workspace(tmp_path), assignments.load(), [alone], [])
    given = GivenRun(among, [], frozenset(), {}, gave)
    assert did_given(seen, alone, given, ["/on"], is_over=False) == [
        "published 15 messages on /out: data 0 or 3"
    ]


def with_relay_and_limit() -> Files:
    """Return a workspace in which one node sums up what another counts, and tells when it has come to a limit."""
    files = right_workspace()
    files.change("node", "import String", "import Int32, String")
    files.change(
        "node",
        "        self.count = 0\n",
        "        self.count = 0\n        self.counts = self.create_publisher(Int32, '/count', 10)\n",
    )
    files.change(
        "node",
        "        self.count += 1",
        "        self.count += 1\n        self.counts.publish(Int32(data=self.count))",
    )
    files.change("listener", "import String", "import Int32, String")
    return files.change(
        "listener",
        "    def command_callback(self, msg):",
        "        self.doubles = self.create_publisher(Int32, '/double', 10)\n"
        "        self.done = self.create_publisher(String, '/done', 10)\n"
        "        self.create_subscription(Int32, '/count', self.double, 10)\n\n"
        "    def double(self, msg):\n        self.doubles.publish(Int32(data=2 * msg.data))\n"
        "        if msg.data > 30:\n            self.done.publish(String(data='thirty'))\n"
        "        if msg.data > 9000:\n            self.done.publish(String(data='all'))\n\n"
        "    def command_callback(self, msg):",
    )


def test_real_nodes_are_run_until_a_number_has_come_to_its_limit(tmp_path: Path) -> None:
    """What only comes after many messages of another node is seen; what does not come by then is not told."""
    root = with_relay_and_limit().only("node", "listener").write(tmp_path)
    build(root)
    trial = try_out(root)
    assert not trial.findings, trial
    (line,) = (line for line in trial.story if line.startswith("command_subscriber"))
    assert "on /double" in line
    assert "data = 'thirty'" in line
    assert "nothing" not in line
    assert "9000" not in " ".join(trial.story)
