"""What is said of nodes that were run: from made-up runs, and from real ones."""

from __future__ import annotations

import os
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab import assignments, environment
from ros2lab.diagnose.finding import ranked
from ros2lab.diagnose.look import Look
from ros2lab.environment import SHARED_MEMORY
from ros2lab.grading.evidence import CommandSeen, Heard, Run
from ros2lab.trial import try_out
from ros2lab.trial.seen import Seen, seen_faults

STRING, TWIST = "std_msgs/msg/String", "geometry_msgs/msg/Twist"


def twist(x: float = 0.0, z: float = 0.0, **more: float) -> dict[str, dict[str, float]]:
    return {
        "linear": {"x": x, "y": 0.0, "z": more.get("up", 0.0)},
        "angular": {"x": 0.0, "y": 0.0, "z": z},
    }


def run_of(name: str, topic: str, kind: str, heard: Heard | None) -> Run:
    return Run(
        programs=[name],
        setting="alone",
        clock="stepped",
        nodes=[f"/{name}"],
        publishes={topic: {f"/{name}": [kind]}},
        subscribes={},
        qos={},
        parameters={f"/{name}": {}},
        quiet={topic: heard} if heard else {},
        commands=[],
        ended={},
        stopped={},
        notes=[],
    )


def codes(tmp_path: Path, *runs: Run) -> list[str]:
    look = Look(right_workspace().write(tmp_path))
    seen = Seen(look, assignments.load(), runs, [])
    return [finding.code for finding in seen_faults(seen)]


def velocities(*values: dict[str, dict[str, float]], every: float = 0.1) -> Run:
    times = [every * number for number in range(len(values))]
    heard = Heard(TWIST, "/velocity_publisher", times, list(values), len(values))
    return run_of("velocity_publisher", "/cmd_vel", TWIST, heard)


@pytest.mark.parametrize(
    ("after", "dance", "is_told"),
    [
        ([0.3, 0.3], [0.0, 0.0], False),
        ([0.0, 0.0], [0.0, 0.0], True),
        ([1.0, 2.0], [0.0, 5.0], True),  # it counts on its own
        ([True, True], [False, False], False),
        ([False, False], [True, True], False),
        ([True, True], [True, True], True),
        ([{"level": 0.0, "is_open": True}] * 2, [{"level": 0.0, "is_open": False}] * 2, False),
        ([{"level": 1.0, "is_open": True}, {"level": 2.0, "is_open": True}], [{"level": 3.0, "is_open": False}], False),
        ([{"level": 1.0, "is_open": True}, {"level": 2.0, "is_open": True}], [{"level": 3.0, "is_open": True}], True),
        ([[0.5, 0.0]] * 2, [[0.0, 0.0]] * 2, False),  # in an array
        ([2.0] * 5, [2.0] * 2, False),  # it comes more often
        ([2.0] * 2, [2.0] * 5, False),
        ([2.0] * 5, [2.0] * 4, True),
    ],
)  # fmt: skip
def test_a_value_that_follows_a_word_is_an_answer(
    tmp_path: Path, after: list[object], dance: list[object], *, is_told: bool
) -> None:
    """Whatever the type of the message; a number that changes on its own is none."""

    def seen_after(word: str, values: list[object]) -> CommandSeen:
        kind = "std_msgs/msg/Float64"
        plain = [{"data": value} for value in values]
        heard = Heard(kind, "/command_subscriber", [*range(len(plain))], plain, len(plain))
        return CommandSeen(word, [], {"/fan": heard}, {}, is_alive=True)

    run = run_of("command_subscriber", "/fan", "std_msgs/msg/Float64", None)
    run = replace(
        run,
        subscribes={"/robot/command": {"/command_subscriber": [STRING]}},
        commands=[
            seen_after("dance", dance), seen_after("start", after),
            seen_after("dance", dance), seen_after("stop", dance),
        ],
    )  # fmt: skip
    told = [code for code in codes(tmp_path, run) if code == "word-unanswered"]
    assert told == ["word-unanswered"] * is_told


def test_zeros_that_a_word_may_change_are_no_fault(tmp_path: Path) -> None:
    """Of a node that computes what it publishes, and takes words that are not known here; else they are told."""
    still = replace(
        velocities(*[twist()] * 3), subscribes={"/robot/command": {"/velocity_publisher": [STRING]}}
    )
    line = "msg.linear.x = self.get_parameter('speed').value"
    for number, (written, wanted) in enumerate(
        (
            (line, []),
            ("msg.linear.x = 0.0", ["message-empty"]),
            ("self.msg = Twist()\n        self.msg.linear.x = self.speed", ["message-empty"]),
        )
    ):
        files = right_workspace().change("driver", line, written)
        look = Look(files.write(tmp_path / str(number)))
        found = seen_faults(Seen(look, assignments.load(), [still], []))
        assert [one.code for one in found if one.code == "message-empty"] == wanted, written


@pytest.mark.parametrize(
    ("filled", "is_told"),
    [
        ("msg = Bool(data=self.read_pin())", False),
        ("msg = Bool()\n        msg.data = self.read_pin()", False),
        ("self.pressed = 17 in self.pins\n        msg = Bool(data=self.pressed)", False),
        ("self.level *= 2\n        msg = Float32()\n        msg.data = self.level", False),
        ("msg = Twist(linear=Vector3(x=math.sin(self.level)))", False),
        ("self.bad += 1\n        good, bad = 1, self.bad\n        msg = Int32(data=bad)", False),
        ("good, bad = 1, self.bad\n        msg = Int32(data=bad)", False),
        ("msg = Twist(linear=Vector3())", True),
        ("msg = Twist(linear=Vector3(x=float(self.level)))", False),
        ("msg = Bool(data=False)", True),
        ("msg = Float32(data=self.get_parameter('level').value)", False),
    ],
)
def test_zeros_with_which_a_node_fills_a_message_may_be_right(
    tmp_path: Path, filled: str, is_told: bool
) -> None:
    """Nobody presses a bumper while it is watched, and a robot may be given 0; what nothing fills stays empty."""
    files = right_workspace().change("driver", "msg = Twist()", filled)
    files.change(
        "driver",
        "        msg.linear.x = self.get_parameter('speed').value\n        msg.angular.z = 0.2\n",
        "",
    )
    look = Look(files.write(tmp_path))
    found = seen_faults(Seen(look, assignments.load(), [velocities(*[twist()] * 3)], []))
    assert [one.code for one in found] == ["message-empty"] * is_told


@pytest.mark.parametrize("period", ["20", "60.0", "500", "3000", "60000"])
def test_a_long_period_may_be_meant_in_another_unit_or_as_it_is(tmp_path: Path, period: str) -> None:
    """Whole minutes tell nothing: 3000 is fifty of them, and three seconds in milliseconds."""
    files = right_workspace().change("node", "create_timer(0.5", f"create_timer({period}")
    run = run_of("status_publisher", "/robot/report", STRING, None)
    (found,) = seen_faults(Seen(Look(files.write(tmp_path)), assignments.load(), [run], []))
    assert found.code == "publishes-nothing"
    assert f"{float(period) / 1000:g} if milliseconds were; otherwise leave it" in found.fix


@pytest.mark.parametrize(
    ("value", "is_told"),
    [
        ({}, False),  # std_msgs/Empty, and any type without fields
        ({"inner": {}, "others": [{}, {}]}, False),
        ({"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}}, False),
        ({"data": None}, False),  # bytes, which are not looked at
        ({"data": ""}, True),
        ({"data": []}, True),
        ({"inner": {}, "data": 0.0}, True),
    ],
)
def test_only_what_can_be_filled_is_empty(tmp_path: Path, value: object, is_told: bool) -> None:
    """A type without fields has nothing to fill, also within another one."""
    heard = Heard("my_msgs/msg/Own", "/status_publisher", [0.0, 1.0, 2.0], [value] * 3, 3)
    run = run_of("status_publisher", "/tick", heard.type_name, heard)
    assert codes(tmp_path, run) == ["message-empty"] * is_told


def test_what_is_silent_empty_or_impossible_is_told(tmp_path: Path) -> None:
    """Each by its code; a robot that drives is none of these."""
    good = velocities(*[twist(0.5, 0.2)] * 3)
    assert codes(tmp_path / "good", good) == []
    assert codes(tmp_path / "a", run_of("status_publisher", "/robot/report", STRING, None)) == [
        "publishes-nothing"
    ]
    assert (
        codes(tmp_path / "b", velocities(*[twist()] * 3)) == []
    )  # it is filled with a parameter, which may be 0
    assert codes(tmp_path / "c", velocities(*[twist(0.5, 90.0)] * 3)) == ["speed-implausible"]
    assert codes(tmp_path / "d", velocities(*[twist(0.5, up=1.0)] * 3)) == ["axis"]
    assert codes(tmp_path / "e", velocities(*[twist(5e-324)] * 3)) == ["int-in-float"]
    assert codes(tmp_path / "f", velocities(*[twist(0.5)] * 3, every=10.0)) == ["period"]
    assert codes(tmp_path / "g", replace(good, parameters={})) == ["not-spinning"]
    silent = run_of("status_publisher", "/robot/report", STRING, None)
    assert codes(tmp_path / "k", replace(silent, twins=["/status_publisher"])) == ["name-twice"]
    assert codes(tmp_path / "l", replace(silent, parameters={})) == ["not-spinning"]
    helped = replace(good, nodes=[*good.nodes, "/helper"])
    assert codes(tmp_path / "h", helped) == []  # it only waits for answers
    assert codes(tmp_path / "i", replace(helped, subscribes={"/x": {"/helper": [STRING]}})) == [
        "not-spinning"
    ]
    managed = run_of("managed", "/managed/transition_event", "lifecycle_msgs/msg/TransitionEvent", None)
    assert codes(tmp_path / "j", managed) == []


@pytest.mark.parametrize(
    ("topic", "is_told"),
    [
        ("/cmd_vel", True),
        ("/left/cmd_vel", True),
        ("/wheel/cmd", False),
        ("/pan_tilt/velocity", False),
        ("/delta_twist_cmds", False),
        ("/cmd_vel/arm", False),
    ],
)
def test_only_of_a_robot_on_the_ground_an_axis_is_odd(tmp_path: Path, topic: str, *, is_told: bool) -> None:
    """A wheel may turn about any axis, and a lift goes up; a speed is told wherever it is."""
    heard = velocities(*[twist(90.0, up=0.4)] * 3).quiet["/cmd_vel"]
    run = run_of("velocity_publisher", topic, TWIST, heard)
    assert codes(tmp_path, run) == [*["axis"] * is_told, "speed-implausible"]


@pytest.mark.parametrize("axis", ["linear.y", "linear.z", "angular.x", "angular.y"])
def test_an_axis_of_no_robot_on_the_ground_is_told_last_and_may_be_right(tmp_path: Path, axis: str) -> None:
    """What moves may be a lift, a wheel or a ship: the fix is for a robot on the ground."""
    half, _, letter = axis.partition(".")
    value = twist()
    value[half][letter] = 0.3
    fast = twist(90.0)
    look = Look(right_workspace().write(tmp_path))
    seen = Seen(look, assignments.load(), [velocities(value, value), velocities(fast, fast)], [])
    *_, first, last = ranked(seen_faults(seen))
    assert (first.code, last.code) == ("speed-implausible", "axis")
    assert f"{axis} is 0.3" in last.cause
    assert "cannot" not in last.cause
    assert "for a robot on the ground" in last.fix
    assert "leave it" in last.fix


def test_a_word_that_changes_nothing_is_told(tmp_path: Path) -> None:
    """What follows a word is compared with what followed a word that nobody knows, just before."""

    def answered(*texts: tuple[str, str]) -> Run:
        commands = [CommandSeen(word, [["INFO", said]], {}, {}, True) for word, said in texts]
        run = run_of("command_subscriber", "/none", STRING, None)
        return replace(
            run,
            publishes={},
            subscribes={"/robot/command": {"/command_subscriber": [STRING]}},
            commands=commands,
        )

    alive = answered(("dance", "State: idle"), ("start", "State: running"))
    dead = answered(("dance", "State: idle"), ("start", "State: idle"))
    assert codes(tmp_path / "alive", alive) == []
    assert codes(tmp_path / "dead", dead) == ["word-unanswered"]


def test_what_a_word_changes_is_looked_for_in_all_nodes_and_states(tmp_path: Path) -> None:
    """One node keeps its state and logs it, another one drives and logs nothing; no word is dead in both."""
    stays, drives = twist(), twist(0.5)

    def driven(*seen: tuple[str, dict[str, dict[str, float]]]) -> Run:
        commands = [
            CommandSeen(word, [], {"/cmd_vel": Heard(TWIST, "/v", [0.0, 0.1], [value] * 2, 2)}, {}, True)
            for word, value in seen
        ]
        run = run_of("velocity_publisher", "/cmd_vel", TWIST, None)
        return replace(run, subscribes={"/robot/command": {"/v": [STRING]}}, commands=commands)

    def said(*seen: tuple[str, dict[str, dict[str, float]]]) -> list[str]:
        files = right_workspace().change(
            "listener", "== 'start'", "== 'start' or msg.data == 'stop' or msg.data == 'reset'"
        )
        root = tmp_path / str(len(list(tmp_path.iterdir())))
        return [
            finding.code
            for finding in seen_faults(Seen(Look(files.write(root)), assignments.load(), [driven(*seen)], []))
        ]

    begin = ("dance", stays), ("reset", stays), ("dance", stays), ("start", drives), ("dance", drives)
    end = ("dance", stays), ("start", drives), ("dance", drives), ("reset", stays)
    assert said(*begin, ("stop", stays), *end) == []
    assert said(*begin, ("stop", drives), ("dance", drives), ("reset", stays)) == ["word-unanswered"]
    # What stop is meant to do any other word does, too.
    assert said(("dance", stays), ("start", drives), ("dance", stays), ("stop", stays)) == []


READS = "        if msg.data == 'start':\n"
ZERO = "        if msg.data == 'zero':\n            self.count = 0\n"


@pytest.mark.parametrize(
    ("code", "second", "is_told", "is_refutable"),
    [
        (ZERO, "a", True, True),  # if what it leads to ran, it was so already
        (ZERO, "b", True, False),
        (ZERO.replace("self.count", "count"), "a", True, False),
        (ZERO.replace("self.count = 0", "self.undo()"), "a", True, True),
        ("        {'zero': self.undo}.get(msg.data, print)()\n", "a", True, True),
        ("        match msg.data:\n            case 'zero' | 'null':\n                self.count = 0\n", "a", True, True),
        (ZERO.replace("self.count = 0", "if self.count:\n                self.count = 0"), "a", False, False),
        (ZERO.replace("'zero':", "'zero' and self.count:"), "a", False, False),
        ("        match msg.data.split():\n            case ['unlock', 'zero']:\n                pass\n", "a", False, False),
        ("        match (self.count, msg.data):\n            case 2, 'zero':\n                pass\n", "a", False, False),
        ("        words = msg.data.split()\n        if words[1] == 'zero':\n            pass\n", "a", False, False),
        ("        key, _, value = msg.data.partition(':')\n        if value == 'zero':\n            pass\n", "a", False, False),
        ("        for word in msg.data.split():\n            if word == 'zero':\n                pass\n", "a", False, False),
        ("        word = msg.data\n        word = word.strip().lower()\n        if word == 'zero':\n            pass\n", "a", True, False),
    ],
)  # fmt: skip
def test_a_word_may_lead_to_the_state_in_which_it_was_sent(
    tmp_path: Path, code: str, second: str, *, is_told: bool, is_refutable: bool
) -> None:
    """It is no fault if it did what it is for, and nothing is known of what is only a part of a text."""
    words = [
        ("dance", "a"),
        ("start", "b"),
        ("dance", "a"),
        ("zero", "a"),
        ("dance", second),
        ("zero", second),
    ]
    commands = [CommandSeen(word, [["INFO", said]], {}, {}, True) for word, said in words]
    run = run_of("command_subscriber", "/none", STRING, None)
    listens = {"/robot/command": {"/command_subscriber": [STRING]}}
    run = replace(run, publishes={}, subscribes=listens, commands=commands)
    files = right_workspace().change("listener", READS, f"{code}{READS}")
    files.change(
        "listener",
        "    def command_callback",
        "    def undo(self):\n        print(self.count)\n\n    def command_callback",
    )
    found = [*seen_faults(Seen(Look(files.write(tmp_path)), assignments.load(), [run], []))]
    assert [one.code for one in found] == ["word-unanswered"] * is_told
    assert [bool(one.never) for one in found] == [is_refutable] * is_told


@pytest.mark.parametrize(
    ("started", "topic", "is_told"),
    [
        ("", "pulse", False),  # it may be started in the namespace, too
        ("", "/pulse", True),
        ("Node(package='my_bot', executable='command_subscriber'),", "pulse", True),
    ],
)
def test_a_node_that_only_the_run_puts_beside_a_namespace(
    tmp_path: Path, started: str, topic: str, is_told: bool
) -> None:
    """What no launch file starts was meant to be elsewhere; what one file starts is as it says."""
    files = right_workspace()
    files.change("node", "'/robot/report'", "'pulse'").change("listener", "'/robot/command'", f"'{topic}'")
    launch = "launch/robot.launch.py"
    files.change(launch, "executable='status_publisher'", "executable='status_publisher', namespace='bed1'")
    files.change(launch, "Node(package='my_bot', executable='command_subscriber'),", started)
    talker = replace(
        run_of("status_publisher", "/bed1/pulse", STRING, None), nodes=["/bed1/status_publisher"]
    )
    talker.publishes["/bed1/pulse"] = {"/bed1/status_publisher": [STRING]}
    listener = replace(
        run_of("command_subscriber", "/none", STRING, None),
        publishes={},
        subscribes={"/pulse": {"/command_subscriber": [STRING]}},
    )
    together = replace(
        talker,
        programs=["status_publisher", "command_subscriber"],
        nodes=[*talker.nodes, *listener.nodes],
        subscribes=listener.subscribes,
    )
    look = Look(files.write(tmp_path), loads=True)
    found = seen_faults(Seen(look, assignments.load(), [talker, listener], [together]))
    assert [one.code for one in found if one.code == "topic-near-miss"] == ["topic-near-miss"] * is_told


@pytest.mark.parametrize(
    ("rate", "period", "gap", "fix"),
    [
        (4, "1 // rate", 0.001, "write `1 / rate` instead of `1 // rate`"),
        (4, "int(1 / rate)", 0.001, "write `1 / rate` instead of `int(1 / rate)`"),
        (4, "self.given.value // 1000", 0.001, "write `self.given.value / 1000` instead of `self.given.value // 1000`"),
        (0, "rate", 0.001, "in seconds"),
        (100, "rate / 1000 / 1000", 0.001, "in seconds"),
        (4, "float(input())", 0.001, "in seconds"),  # not known, but far too fast
        (200, "1 / rate", 0.005, ""),
        (1000, "1 / rate", 0.001, ""),
        (4, "float(input())", 0.005, ""),
    ],
)  # fmt: skip
def test_a_timer_without_a_pause_is_told(
    tmp_path: Path, rate: int, period: str, gap: float, fix: str
) -> None:
    """With the line that makes it, and why its period is 0 with the parameters of the run; a quick one is right."""
    made = (
        f"self.given = self.declare_parameter('rate', 4)\n        rate = self.given.value\n"
        f"        period = {period}\n        self.timer = self.create_timer(period, "
    )
    look = Look(
        right_workspace().change("node", "self.timer = self.create_timer(0.5, ", made).write(tmp_path)
    )
    times = [gap * number for number in range(200)]
    heard = Heard(STRING, "/status_publisher", times, [{"data": "on"}] * 200, 500)
    run = run_of("status_publisher", "/robot/report", STRING, heard)
    run = replace(run, clock="real", parameters={"/status_publisher": {"rate": rate}})
    found = [*seen_faults(Seen(look, assignments.load(), [run], []))]
    assert [one.code for one in found] == ["period"] * bool(fix)
    for one in found:
        assert fix in one.fix
        assert "status_publisher.py:14" in one.place


_MADE = "        self.count = 0\n"


@pytest.mark.parametrize(
    ("more", "parameters", "is_told"),
    [
        ("", {}, True),
        ("self.create_service(Trigger, 'go', self.go)", {}, False),
        ("self.client = self.create_client(Trigger, 'go')", {}, False),
        ("self.word = input()", {}, False),
        ("self.lines = sys.stdin", {}, False),
        ("self.add_post_set_parameters_callback(self.timer_callback)", {}, False),
        ("self.add_on_set_parameters_callback(self.check)", {}, True),  # it publishes nothing
        ("", {"enabled": False}, False),
        ("", {"enabled": True, "use_sim_time": False}, True),
    ],
)
def test_a_publisher_may_wait_for_more_than_topics(
    tmp_path: Path, more: str, parameters: dict[str, bool], is_told: bool
) -> None:
    """For a service, the keyboard, or a parameter: nobody gives it any of these while it is watched."""
    files = right_workspace().change("node", _MADE, f"{_MADE}        {more}\n" if more else _MADE)
    look = Look(files.write(tmp_path))
    run = run_of("status_publisher", "/robot/report", STRING, None)
    run = replace(run, parameters={"/status_publisher": parameters})
    found = seen_faults(Seen(look, assignments.load(), [run], []))
    assert [one.code for one in found] == ["publishes-nothing"] * is_told


_PUBLISHES = "        self.publisher_.publish(msg)\n"


@pytest.mark.parametrize(
    ("old", "new", "is_told"),
    [
        ("", "", True),
        (_PUBLISHES, "        self.send(msg)\n\n    def send(self, msg):\n" + _PUBLISHES, True),
        ("        msg = String()", "        if self.count > 3:\n            return\n        msg = String()", False),
        (_PUBLISHES, f"        if self.count < 3:\n    {_PUBLISHES}", False),
        ("        msg = String()", "        if random.random() < 0.1:\n            return\n        msg = String()", False),
        (_PUBLISHES, f"{_PUBLISHES}        if self.count == 3:\n            self.timer.cancel()\n", False),
    ],
)  # fmt: skip
def test_messages_that_come_no_more_are_told_where_nothing_may_hold_them_back(
    tmp_path: Path, old: str, new: str, is_told: bool
) -> None:
    """A pause, and an end, may be meant: only a timer that publishes each time has to go on."""
    look = Look(right_workspace().change("node", old, new).write(tmp_path))
    heard = Heard(STRING, "/status_publisher", [0.5, 1.0, 1.5], [{"data": "on"}] * 3, 3)
    run = run_of("status_publisher", "/robot/report", STRING, heard)
    found = seen_faults(Seen(look, assignments.load(), [replace(run, stalled=["/robot/report"])], []))
    assert [one.code for one in found] == ["period"] * is_told


FAILED = "Traceback (most recent call last):\nValueError: could not convert string to float: 'dance'"


@pytest.mark.parametrize(
    ("said", "among_others", "is_told"),
    [
        (FAILED, FAILED, True),
        (FAILED, "", True),  # among the others it is watched for a shorter time
        ("[ERROR] [status_publisher]: there is no lamp", "", False),
        ("usage: status_publisher [-h] file\nstatus_publisher: error: the following arguments are required: file", None, False),
        ("no device on /dev/ttyUSB0", None, False),
    ],
)  # fmt: skip
def test_only_an_exception_is_told_of_a_program_that_ends(
    tmp_path: Path, said: str, among_others: str | None, is_told: bool
) -> None:
    """What it says itself when it ends, it means."""
    run = replace(run_of("status_publisher", "/robot/report", STRING, None), ended={"status_publisher": said})
    ended = {"status_publisher": among_others} if among_others else {}
    together = [] if among_others is None else [replace(run, setting="together", ended=ended)]
    look = Look(right_workspace().write(tmp_path))
    found = [*seen_faults(Seen(look, assignments.load(), [run], together))]
    assert bool(found) is is_told, found


def test_a_program_that_asks_a_service_may_fail_where_it_is_alone(tmp_path: Path) -> None:
    """But not among the nodes that it asks."""
    made = f"{_MADE}        self.client = self.create_client(Trigger, 'go')\n"
    look = Look(right_workspace().change("node", _MADE, made).write(tmp_path))
    alone = run_of("status_publisher", "/robot/report", STRING, None)
    alone = replace(alone, ended={"status_publisher": FAILED})

    def is_told(**ended: str) -> bool:
        together = replace(alone, setting="together", ended=ended)
        return any(seen_faults(Seen(look, assignments.load(), [alone], [together])))

    assert not is_told()
    assert not is_told(status_publisher="[INFO] [status_publisher]: done")
    assert is_told(status_publisher=FAILED)


@pytest.mark.parametrize(
    ("word", "is_fed", "before", "is_told"),
    [
        ("dance", True, [], False),
        ("dance", False, [], True),  # anybody may type it
        ("start", True, [], True),  # the workspace's own word
        ("dance", True, [["ERROR", FAILED.splitlines()[0]]], True),  # among the others it fails without it
    ],
)
def test_a_word_that_no_node_sends_may_end_a_program(
    tmp_path: Path, word: str, is_fed: bool, before: list[list[str]], is_told: bool
) -> None:
    """Where a node of the workspace speaks on the topic, and says only what the other one can read."""
    files = right_workspace().change("node", "f'Robot is running: {self.count}'", "'start'")
    command = CommandSeen(word, [["ERROR", FAILED.splitlines()[0]]], {}, {}, is_alive=False)
    run = replace(
        run_of("command_subscriber", "/none", STRING, None),
        publishes={},
        subscribes={"/robot/command": {"/command_subscriber": [STRING]}},
        commanded="/robot/command",
        commands=[command],
        ended={"command_subscriber": FAILED},
    )
    topic = "/robot/command" if is_fed else "/robot/report"
    heard = Heard(STRING, "/status_publisher", [0.0, 0.5, 1.0], [{"data": "start"}] * 3, 3)
    speaker = run_of("status_publisher", topic, STRING, heard)
    together = replace(run, setting="together", log=before, commands=[] if before else [command])
    look = Look(files.write(tmp_path))
    found = [*seen_faults(Seen(look, assignments.load(), [run, speaker], [together]))]
    assert [one.code for one in found if one.code != "topic-near-miss"] == ["python-error"] * is_told, found


def build(root: Path) -> None:
    command = ["colcon", "build"]
    subprocess.run(command, cwd=root, env=environment.lab_environment(), check=True, capture_output=True)


def test_real_nodes_are_run_and_watched(tmp_path: Path) -> None:
    """A node that drives in degrees, beside two that are right."""
    root = right_workspace().change("driver", "angular.z = 0.2", "angular.z = 90.0").write(tmp_path)
    build(root)
    # As Fast DDS leaves it of a process that was killed: nobody holds the lock.
    dead = [SHARED_MEMORY / f"fastrtps_{os.getpid():016x}{end}" for end in ("", "_el")]
    for path in dead:
        path.touch()
    trial = try_out(root)
    assert not any(path.exists() for path in dead)
    assert [finding.code for finding in trial.findings] == ["speed-implausible"]
    assert "velocity_publisher.py:17" in trial.findings[0].place
    assert any("published" in line for line in trial.story)


def test_nodes_are_run_as_their_launch_file_starts_them(tmp_path: Path) -> None:
    """A namespace that keeps two nodes apart, and a speed that only the launch file gives."""
    files = right_workspace()
    files.change("driver", "'/cmd_vel'", "'cmd_vel'")
    files.change(
        "listener",
        "from std_msgs.msg import String",
        "from geometry_msgs.msg import Twist\nfrom std_msgs.msg import String",
    )
    files.change(
        "listener",
        "        self.state = 'idle'\n",
        "        self.state = 'idle'\n        self.create_subscription(Twist, 'cmd_vel', lambda msg: None, 10)\n",
    )
    files.change(
        "launch/robot.launch.py",
        "parameters=[config]",
        "namespace='base', parameters=[config, {'speed': 30.0}]",
    )
    root = files.only("listener", "driver").write(tmp_path)
    build(root)
    assert [finding.code for finding in try_out(root).findings] == ["topic-near-miss", "speed-implausible"]
