"""What is not installed where a submission is graded, or comes from elsewhere, costs nobody a point."""

from __future__ import annotations

import abc
import contextlib
import enum
import importlib
import inspect
import sys
import threading
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import evidences
import pytest

from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.grading.evidence import GIVEN, KEYBOARD, CommandSeen, Evidence, WrittenEnd
from ros2lab.grading.grade import Grade
from ros2lab.grading.reading import stand_in
from ros2lab.grading.reading.absent import named_places
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

ODOMETRY, STRING = "nav_msgs/msg/Odometry", evidences.STRING
WANT = (
    "Traceback (most recent call last):\nAttributeError: type object 'NotInstalledHere' has no attribute 'x'"
)


@pytest.fixture
def camera(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """A library that nobody has installed."""
    text = Path(stand_in.__file__).read_text(encoding="utf-8")
    (tmp_path / "camera_of_nobody.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    finders = [*sys.meta_path]
    import camera_of_nobody  # type: ignore[import-not-found]

    yield camera_of_nobody
    sys.meta_path[:] = finders
    del sys.modules["camera_of_nobody"]


def test_a_stand_in_bears_what_programs_do_with_a_library(camera: Any) -> None:
    """It is called, unpacked, computed with, compared, formatted, derived from and iterated over."""
    success, image = camera.Camera(0).read()
    height, width, _ = image.shape
    assert not success
    assert f"{3 * width + height:.2f}" == ""
    assert not width > 2
    assert -(abs(width) ** 2) / 2 % 3 is not None
    assert [*image] == []

    class Filter(camera.Filter):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__(size=3)
            self.size = 3

    assert Filter().size == 3


def test_an_error_of_a_library_can_be_raised_and_caught(camera: Any) -> None:
    """By its own name and by no other one, wherever it is found, and also if one is derived from it."""
    with pytest.raises(camera.NoBoard):
        raise camera.NoBoard("no board", code=3)
    with pytest.raises(camera.errors.NoBoard):
        raise camera.NoBoard
    board = camera.Board(0)
    with pytest.raises(board.Busy), contextlib.suppress(camera.NoBoard):
        raise board.Busy

    class Lost(camera.NoBoard):  # type: ignore[misc]
        pass

    with pytest.raises(camera.NoBoard, match=stand_in.NotInstalledHere.__name__):
        raise Lost("no board")


def test_a_class_of_a_library_is_derived_from_with_others(camera: Any) -> None:
    """Whatever metaclass and layout they have."""

    class Driver(camera.Driver, abc.ABC):  # type: ignore[misc]
        @abc.abstractmethod
        def go(self) -> None: ...

    class Board(camera.Board, dict, threading.Thread):  # type: ignore[misc]
        pass

    class Level(enum.Enum):
        LOW = camera.LOW
        HIGH = camera.HIGH

    assert isinstance(Driver(), abc.ABC)
    assert isinstance(Board(), dict)
    assert len(Level) == 2
    assert camera.parse().args.width * 2 is not None
    assert camera.plugins.register("x") is not None
    assert not isinstance(3, camera.Frame)


def test_a_stand_in_has_what_a_module_tells_of_itself(camera: Any) -> None:
    """Also under names that Python does not give to every module, and in the modules below it."""
    scope: dict[str, Any] = {}
    exec("from camera_of_nobody import *", scope)
    assert "Camera" not in scope
    from camera_of_nobody import __version__

    below = [importlib.import_module(f"camera_of_nobody.{name}") for name in ("lens", "msg")]
    for module in (camera, *below):
        major, minor, *_ = module.__version__.split(".")
        assert f"{module.__author__} {module.__version__} {major}{minor}".strip() == ""
        assert module.__file__ == module.__spec__.origin
    assert "OpenCV " + __version__ == "OpenCV "
    assert __version__ is camera.__version__
    assert inspect.getmodule(_graded) is sys.modules[__name__]  # which looks at every module
    with pytest.raises(AttributeError, match=stand_in.NotInstalledHere.__name__):
        camera.Camera.__version__  # noqa: B018


def test_an_error_of_a_stand_in_names_it(camera: Any) -> None:
    """So that the student is not blamed for it."""
    with pytest.raises(TypeError, match=stand_in.NotInstalledHere.__name__):
        "12 V".startswith(camera.unit)


def _graded(evidence: Evidence) -> Grade:
    return verdict(evidence, load())


def _needing(program: str) -> Evidence:
    """Return the evidence of a right submission of which a program imports what is not installed here."""
    right = evidences.right()
    assert right.build
    programs = [
        replace(one, absent=["arm_msgs"]) if one.name == program else one for one in right.build.executables
    ]
    return replace(right, build=replace(right.build, executables=programs))


@pytest.mark.parametrize(
    ("program", "topic", "type_name"),
    [
        (evidences.STATUS, "/robot/status", "std_msgs/msg/String"),
        (evidences.COMMAND, "/robot/command", "std_msgs/msg/String"),
        (evidences.VELOCITY, "/cmd_vel", "geometry_msgs/msg/Twist"),
    ],
)
def test_a_program_that_ends_for_want_of_a_library_is_read(program: str, topic: str, type_name: str) -> None:
    """Its topic and type stand in its code; the rest is not tried, costs nothing, and is no fault."""
    end = WrittenEnd(topic, type_name, topic != "/robot/command", [2.0], "")
    given = evidences.without(program, WANT)(evidences.files(ends=[end])(_needing(program)))
    grade = _graded(given)
    assert {grade.components[name].points for name in evidences.NODES} == {20}
    assert any("needs arm_msgs, not there where it is graded" in one.reason for one in grade.criteria)
    assert not any("NotInstalledHere" in str(one) for one in (*grade.criteria, *grade.faults, *grade.notes))


def test_a_program_that_ends_for_want_of_a_library_needs_the_topic() -> None:
    """What its code does not make is not there."""
    given = evidences.without(evidences.VELOCITY, WANT)(
        evidences.files(ends=[])(_needing(evidences.VELOCITY))
    )
    assert _graded(given).components["velocity_publisher"].points == 0


@pytest.mark.parametrize(
    ("program", "does", "points"),
    [
        (evidences.COMMAND, ["reads", "logs", "compares"], 20),
        (evidences.COMMAND, ["reads", "compares"], 16),
        (evidences.COMMAND, ["reads", "logs"], 14),
        (evidences.COMMAND, ["logs", "compares"], 1.5),
        (evidences.COMMAND, [], 1.5),
        (evidences.VELOCITY, ["publishes"], 20),
        (evidences.VELOCITY, [], 2.25),
        (evidences.STATUS, [], 2),
    ],
)
def test_an_excuse_reaches_as_far_as_the_code_shows(program: str, does: list[str], points: float) -> None:
    """What no line of the code would do, it would do nowhere; an end that nothing uses is written, and no more."""
    part = load().assignment.parts[program]
    end = WrittenEnd(part.topic, part.type_name, part.is_publisher, [], program, does)
    given = evidences.without(program, WANT)(evidences.files(ends=[end])(_needing(program)))
    assert _graded(given).components[program].points == points


@pytest.mark.parametrize(("does", "points"), [(["publishes"], 20), (None, 20), ([], 6.5)])
def test_a_node_waits_only_for_what_it_would_do_something_with(does: list[str] | None, points: float) -> None:
    """One that never publishes is silent with or without a permission."""
    silent = _silent([])
    last = replace(silent.runs[-1], quiet={}, ungiven={"/motors/permit": "motor_msgs/srv/Permit"})
    end = WrittenEnd("/cmd_vel", "geometry_msgs/msg/Twist", True, [], evidences.VELOCITY, does)
    given = evidences.files(ends=[end])(replace(silent, runs=[*silent.runs[:-1], last]))
    assert _graded(given).components["velocity_publisher"].points == points


@pytest.mark.parametrize(
    ("program", "changes", "points"),
    [
        (evidences.VELOCITY, {}, 20),
        (evidences.VELOCITY, {"never": ["repeats"]}, 16),
        (evidences.STATUS, {"never": ["repeats"]}, 13),
    ],
)
def test_what_the_code_itself_shows_is_not_excused(
    program: str, changes: dict[str, Any], points: float
) -> None:
    """That it comes only once is so with whatever it waits for."""
    part = load().assignment.parts[program]
    end = WrittenEnd(part.topic, part.type_name, True, [], program, ["publishes"], **changes)
    given = evidences.without(program, WANT)(
        evidences.files(ends=[end], parameter_files={})(_needing(program))
    )
    assert _graded(given).components[program].points == points


@pytest.mark.parametrize(
    ("code", "module", "points"),
    [
        ("name-undefined", evidences.COMMAND, 6),
        ("message-field", evidences.COMMAND, 6),
        ("message-compared", evidences.COMMAND, 6),
        ("name-undefined", evidences.STATUS, 20),
        ("dependency-undeclared", evidences.COMMAND, 20),
        ("module-missing", evidences.COMMAND, 20),
    ],
)
def test_what_fails_anywhere_is_not_excused(code: str, module: str, points: float) -> None:
    """Its library would come, and the node would end all the same; another node's fault is its own."""
    part = load().assignment.parts[evidences.COMMAND]
    end = WrittenEnd(part.topic, part.type_name, False, [], evidences.COMMAND, ["reads", "logs", "compares"])
    wrong = evidences.finding(code, "mesage is not defined.", f"src/p/p/{module}.py:9", "write message")
    needing = evidences.files(ends=[end])(_needing(evidences.COMMAND))
    grade = _graded(evidences.without(evidences.COMMAND, WANT)(wrong(needing)))
    assert grade.components[evidences.COMMAND].points == points
    lost = [one.reason for one in grade.criteria if one.points < one.max and "line 9" in one.reason]
    assert bool(lost) == (points < 20)


@pytest.mark.parametrize(("place", "points"), [("src/p/p/velocity.py:9", 7.5), ("", 20)])
def test_what_diagnose_calls_in_vain_ends_an_excuse_and_is_told(place: str, points: float) -> None:
    """If the code would publish without it; else it is no fault of what could not be tried."""
    end = WrittenEnd("/cmd_vel", "geometry_msgs/msg/Twist", True, [], evidences.VELOCITY, ["publishes"])
    left = [replace(end, does=[], vain=place)] if place else []
    cause = "`self.go` by itself does nothing."
    wrong = evidences.finding("no-effect", cause, "src/p/p/velocity.py:9", "write self.go()")
    given = wrong(evidences.files(ends=[end], ends_left=left)(_needing(evidences.VELOCITY)))
    grade = _graded(evidences.without(evidences.VELOCITY, WANT)(given))
    assert grade.components[evidences.VELOCITY].points == points
    assert [fault.cause for fault in grade.faults] == ([cause] if place else [])


@pytest.mark.parametrize(
    ("program", "changes", "points"),
    [
        (evidences.VELOCITY, {}, 20),
        (evidences.STATUS, {}, 20),
        (evidences.STATUS, {"quiet": {}}, 13),  # it only answers, and never comes by itself
        (evidences.STATUS, {"handed_on": ["/robot/status"]}, 20),
    ],
)
def test_what_comes_of_something_that_is_given_is_right(
    program: str, changes: dict[str, Any], points: float
) -> None:
    """It counts as if somebody had brought it; how often it comes by itself is seen afterwards."""
    silent, part = {
        evidences.VELOCITY: (evidences.velocity_run(values=[]), evidences.velocity_run()),
        evidences.STATUS: (evidences.status_run(values=0), evidences.status_run()),
    }[program]
    shut = evidences.runs(silent)(evidences.right())
    ends = {"/odom": {f"/{program}": [ODOMETRY]}}
    opened = replace(
        part, setting=GIVEN, given=["/odom"], gave={"/odom": ODOMETRY}, subscribes=ends, meanwhile=part.quiet
    )
    runs = [*shut.runs, replace(opened, **changes)]
    assert _graded(replace(shut, runs=runs)).components[program].points == points


_LAST = "Traceback (most recent call last):\n"


@pytest.mark.parametrize(
    ("changes", "points"),
    [
        ({"gave": {"/odom": ODOMETRY}}, 9),
        ({"gave": {"/odom": ODOMETRY}, "ended": {evidences.VELOCITY: f"{_LAST}IndexError: 9"}}, 9),
        (
            {
                "gave": {"/odom": ODOMETRY, "/robot/command": STRING},
                "ended": {evidences.VELOCITY: "ValueError: x"},
            },
            9,
        ),
        ({"gave": {"/odom": evidences.STRING}, "ended": {evidences.VELOCITY: f"{_LAST}ValueError: x"}}, 20),
        ({"gave": {"/odom": evidences.STRING}, "ended": {evidences.VELOCITY: f"{_LAST}NameError: x"}}, 9),
        ({"ungiven": {"/dock": "dock_msgs/action/Dock"}}, 20),
        ({"gave": {"/odom": ODOMETRY}, "ungiven": {"/dock": "dock_msgs/action/Dock"}}, 20),
        ({"given": [], "nodes": [], "unfinished": "others of the submission took 300 s"}, 20),
    ],
)
def test_what_was_given_is_not_waited_for(changes: dict[str, Any], points: float) -> None:
    """A node that got all that it could wait for, and did nothing, does nothing; what could not be given is left open."""
    silent = _silent(["/odom"])
    takes = {
        "/odom": {"/velocity_publisher": [ODOMETRY]},
        "/robot/command": {"/command_subscriber": [STRING]},
    }
    last = replace(silent.runs[-1], quiet={}, subscribes=takes, **changes)
    grade = _graded(replace(silent, runs=[*silent.runs[:-1], last]))
    assert grade.components["velocity_publisher"].points == points


def test_a_program_that_lacks_nothing_may_say_so() -> None:
    """What a program prints is a claim; what it imports was read."""
    given = evidences.files(ends=[WrittenEnd("/cmd_vel", "geometry_msgs/msg/Twist", True, [], "")])(
        evidences.right()
    )
    grade = _graded(evidences.without(evidences.VELOCITY, WANT)(given))
    assert grade.components["velocity_publisher"].points <= 5


def test_what_is_seen_counts_whatever_is_imported() -> None:
    """A fault that was seen is lost, though the program needs what is not installed here."""
    given = evidences.runs(evidences.status_run(period=0.1))(_needing(evidences.STATUS))
    assert _graded(given).components["status_publisher"].points < 20


def _silent(given: list[str]) -> Evidence:
    """Return the evidence of a velocity that comes only of something else, or not even then."""
    alone = replace(evidences.velocity_run(values=[]), waits=given)
    silent = evidences.runs(alone)(evidences.right())
    return replace(silent, runs=[*silent.runs, replace(evidences.velocity_run(), setting=GIVEN, given=given)])


@pytest.mark.parametrize(
    ("waits", "commanded", "given", "needed"),
    [
        (["/odom"], "", ["/odom"], "/odom"),
        (["/odom", "/enable"], "", ["/enable", "/map", "/odom"], "/enable and /odom"),
        (["/odom"], "/robot/command", ["/odom", "/robot/command"], "/odom"),
        ([], "/mode", ["/mode"], "/mode"),  # alone it was taken for the topic of the commands
        ([], "", ["/odom"], ""),  # it is another node's
        (["/odom"], "", [], ""),
    ],
)
def test_a_node_that_waits_for_what_nobody_brings_loses_some_of_its_life(
    waits: list[str], commanded: str, given: list[str], needed: str
) -> None:
    """It publishes when there is odometry, and is silent in the workspace as it was handed in."""
    alone = replace(evidences.velocity_run(values=[]), waits=waits, commanded=commanded)
    waiting = evidences.runs(alone)(evidences.right())
    grade = _graded(replace(waiting, runs=[*waiting.runs, _silent(given).runs[-1]]))
    life = next(one for one in grade.criteria if one.id == "velocity_publisher.life")
    assert grade.components["velocity_publisher"].points == (17 if needed else 20)
    assert (f"nothing comes on /cmd_vel before it is given {needed}, which" in life.reason) == bool(needed)


def test_what_cannot_be_given_is_told() -> None:
    """Nor is the end of a program that was given something a fault of its own."""
    silent, ended = _silent([]), {evidences.VELOCITY: "IndexError: list index out of range"}
    last = replace(silent.runs[-1], quiet={}, ended=ended, ungiven={"/dock": "dock_msgs/action/Dock"})
    grade = _graded(replace(silent, runs=[*silent.runs[:-1], last]))
    assert any("waits for what nobody here brings on /dock" in one.reason for one in grade.criteria)
    assert not any("IndexError" in str(one) for one in (*grade.criteria, *grade.faults, *grade.notes))


def test_a_node_that_waits_for_nothing_is_silent() -> None:
    """Nothing was there to be given, so that its silence is its own."""
    silent = _silent([])
    last = replace(silent.runs[-1], quiet={})
    assert (
        _graded(replace(silent, runs=[*silent.runs[:-1], last])).components["velocity_publisher"].points == 9
    )


def test_an_error_of_its_own_is_charged_whatever_is_imported() -> None:
    """That something else is not installed here explains no NameError."""
    given = evidences.without(evidences.VELOCITY, "Traceback:\nNameError: name 'Twits' is not defined")
    assert _graded(given(_needing(evidences.VELOCITY))).components["velocity_publisher"].points < 10


@pytest.mark.parametrize(
    ("kind", "is_answer", "changes", "points"),
    [
        (ODOMETRY, False, {}, 17),
        (ODOMETRY, True, {}, 13),
        (evidences.TWIST, False, {}, 17),
        (evidences.TWIST, True, {}, 13),  # a limiter, or one that holds some back
        (evidences.TWIST, True, {"handed_on": ["/cmd_vel"]}, 11),
        (evidences.TWIST, False, {"handed_on": ["/cmd_vel"]}, 17),
    ],
)
def test_what_is_given_to_a_node_is_not_its_own(
    kind: str, is_answer: bool, changes: dict[str, Any], points: float
) -> None:
    """A velocity for each odometry is made of it, one for each velocity of that; what comes by itself is its own."""
    silent = _silent(["/input"])
    last, takes = silent.runs[-1], {"/input": {"/velocity_publisher": [kind]}}
    last = replace(last, subscribes=takes, meanwhile=last.quiet, quiet={} if is_answer else last.quiet)
    silent = replace(silent, runs=[*silent.runs[:-1], replace(last, **changes)])
    assert _graded(silent).components["velocity_publisher"].points == points


def test_what_comes_from_a_timer_while_something_is_new_is_no_answer() -> None:
    """It stops as soon as nothing is given any more."""
    silent = _silent(["/odom"])
    last = replace(silent.runs[-1], meanwhile=silent.runs[-1].quiet, quiet={})
    timed = WrittenEnd("/cmd_vel", evidences.TWIST, True, [0.1], evidences.VELOCITY)
    silent = evidences.files(ends=[timed])(replace(silent, runs=[*silent.runs[:-1], last]))
    assert _graded(silent).components["velocity_publisher"].points == 17


@pytest.mark.parametrize(
    ("answer", "before", "points"), [("{}", 0, 8), ("I do {}", 0, 14.75), ("{}", 1, 14.75), ("{}", 3, 20)]
)
def test_a_word_that_is_said_again_is_not_a_status(answer: str, before: int, points: float) -> None:
    """It was published by whoever said it; what a node says of it, or without it, is its own."""
    silent = evidences.status_run(values=before)
    commands = [
        CommandSeen(
            word,
            [],
            {
                "/robot/status": evidences.heard(
                    evidences.STRING, "/status_publisher", [{"data": answer.format(word)}], 0.5
                )
            },
            {},
            True,
        )
        for word in ("start", "stop", "dance")
    ]
    takes = {"/words": {"/status_publisher": [evidences.STRING]}}
    run = replace(silent, subscribes=takes, commands=commands, commanded="/words")
    assert _graded(evidences.runs(run)(evidences.right())).components["status_publisher"].points == points


def _needing_two() -> Evidence:
    """Return the evidence of a right submission of which two programs end for want of a library."""
    right = _needing(evidences.STATUS)
    assert right.build
    programs = [
        replace(one, absent=["arm_msgs"]) if one.name == evidences.VELOCITY else one
        for one in right.build.executables
    ]
    ends = [
        WrittenEnd("/robot/status", evidences.STRING, True, [2.0], evidences.STATUS),
        WrittenEnd("/cmd_vel", evidences.TWIST, True, [0.1], evidences.VELOCITY),
    ]
    needing = evidences.files(ends=ends)(replace(right, build=replace(right.build, executables=programs)))
    return evidences.without(evidences.VELOCITY, WANT)(evidences.without(evidences.STATUS, WANT)(needing))


@pytest.mark.parametrize(("untried", "points"), [(None, {14, 14.5}), (1, {20}), (0, {9.25, 10})])
def test_of_several_nodes_that_could_not_be_tried_a_share_counts(
    untried: float | None, points: set[float]
) -> None:
    """One may need what is not here; of several, too little was seen. What their code shows counts whole."""
    rubric = load() if untried is None else replace(load(), untried=untried)
    grade = verdict(_needing_two(), rubric)
    assert {grade.components[name].points for name in (evidences.STATUS, evidences.VELOCITY)} == points
    assert grade.components[evidences.COMMAND].points == 20
    assert not any(one.component in evidences.NODES for one in grade.faults)


@pytest.mark.parametrize(("taker", "points"), [("/command_subscriber", 13), ("/another", 8)])
def test_a_gate_is_judged_in_one_way_whoever_waits_behind_it(taker: str, points: float) -> None:
    """One that takes commands and the same odometry as a publisher that waits for it could not be tried, either."""
    takes = {"/odom": {"/velocity_publisher": [ODOMETRY], taker: [ODOMETRY]}}
    deaf = evidences.command_run(log=lambda _: [])
    deaf = replace(deaf, subscribes=deaf.subscribes | takes)
    silent = evidences.velocity_run(values=[])
    given = evidences.right([evidences.status_run(), deaf, silent])
    last = replace(silent, setting=GIVEN, ungiven={"/odom": ODOMETRY}, subscribes=takes)
    assert _graded(replace(given, runs=[*given.runs, last])).components["command_subscriber"].points == points


def test_what_the_code_shows_comes_before_what_is_missing_here() -> None:
    """A program in which nothing spins or loops ends wherever it runs."""
    ends = [WrittenEnd("/cmd_vel", "geometry_msgs/msg/Twist", True, [], "")]
    dead = evidences.without(evidences.VELOCITY, WANT)(
        evidences.files(ends=ends)(_needing(evidences.VELOCITY))
    )
    assert dead.build is not None
    programs = [replace(one, is_brief=one.name == evidences.VELOCITY) for one in dead.build.executables]
    brief = replace(dead, build=replace(dead.build, executables=programs))
    assert _graded(dead).components["velocity_publisher"].points == 20
    assert _graded(brief).components["velocity_publisher"].points < 12


def test_a_program_that_reads_a_keyboard_is_not_tried() -> None:
    """Nobody types where it is graded; what only prints such an error, and reads no keyboard, has ended by itself."""
    ends = [WrittenEnd("/cmd_vel", "geometry_msgs/msg/Twist", True, [], "")]
    said = "Traceback (most recent call last):\ntermios.error: (25, 'Inappropriate ioctl for device')"
    ended = evidences.without(evidences.VELOCITY, said)(evidences.files(ends=ends)(evidences.right()))
    assert ended.build is not None
    programs = [
        replace(one, absent=[KEYBOARD] if one.name == evidences.VELOCITY else [])
        for one in ended.build.executables
    ]
    grade = _graded(replace(ended, build=replace(ended.build, executables=programs)))
    assert grade.components["velocity_publisher"].points == 20
    assert _graded(ended).components["velocity_publisher"].points < 5


def test_a_program_that_is_done_at_once_is_read() -> None:
    """It publishes before anybody can listen; its topic and type stand in its code, and it does not go on."""
    ends = [WrittenEnd("/cmd_vel", "geometry_msgs/msg/Twist", True, [], "")]
    ended = evidences.without(evidences.VELOCITY, "")(evidences.files(ends=ends)(evidences.right()))
    assert ended.build is not None
    programs = [replace(one, is_brief=one.name == evidences.VELOCITY) for one in ended.build.executables]
    grade = _graded(replace(ended, build=replace(ended.build, executables=programs)))
    assert grade.components["velocity_publisher"].points == 10


def test_folders_of_another_machine_are_named_by_paths() -> None:
    """Those in which files lie, and what lies in a home; a topic is none, and nothing leads upwards."""
    text = "A = '/home/ada/logs', '/data/run/x.csv', '/robot/status', '/home/../etc/x.txt', '/x.txt', 'a/b.txt', '/./.'\n"
    assert named_places([PythonSource("x", "x.py", text)]) == ["/data/run", "/home/ada/logs"]


@pytest.mark.parametrize(
    ("said", "points"),
    [
        ("ValueError: day is out of range for month", 9),
        ("struct.error: ubyte format requires 0 <= number <= 255", 9),
        (WANT, 20),
        ("", 20),
    ],
)
def test_an_error_of_its_own_where_a_stand_in_says_yes_is_charged(said: str, points: float) -> None:
    """What it lacks is no reason for it; an end for want of it is."""
    silent = evidences.runs(evidences.velocity_run(values=[]))(_needing(evidences.VELOCITY))
    ended = {evidences.VELOCITY: f"  day = f()\n{said}"} if said else {}
    last = replace(evidences.velocity_run(values=[]), setting=GIVEN, ended=ended)
    grade = _graded(replace(silent, runs=[*silent.runs, last]))
    assert grade.components[evidences.VELOCITY].points == points


def test_a_stand_in_says_yes_where_something_is_given(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What waits for a switch goes on."""
    monkeypatch.setenv(stand_in.SAYS_YES, "1")
    text = Path(stand_in.__file__).read_text(encoding="utf-8")
    (tmp_path / "switch_of_nobody.py").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    finders = [*sys.meta_path]
    import switch_of_nobody as switch  # type: ignore[import-not-found]

    told = switch.read(17)
    assert told == switch.HIGH
    assert [bool(told), told > 3, told < 3] == [True] * 3
    assert float(told) == int(told) == len(told) == len([*told]) == 1
    sys.meta_path[:] = finders
