"""The exercises of `07_robot_controller`: the student's nodes are run, and judged by what they do."""

from __future__ import annotations

import ast
import contextlib
import importlib.metadata
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from catkin_pkg.package import InvalidPackage, parse_package

from ros2lab import course, diagnose, environment, hand_in
from ros2lab.checks import CheckError, exercise, predict_of, programs, questions_of, quiz_of
from ros2lab.checks.programs import count_tests, overlay_of
from ros2lab.checks.watched_program import (
    START_TIMEOUT,
    STRING,
    NotDrivenError,
    WatchedProgram,
    launched,
    message_numbers,
    running,
)
from ros2lab.diagnose.error_text import read_error
from ros2lab.diagnose.parameter_file import ParameterFileError, read_parameter_file
from ros2lab.hand_in import GENERATED_TESTS, LAUNCH_FILES, PACKAGE, YAML_FILES
from ros2lab.node_process import last_line
from ros2lab.observed_domain import LATCHED, ObservedDomain
from ros2lab.rhythm import has_period
from ros2lab.terminal import magic
from ros2lab.topics import TopicLog, find_type
from ros2lab.workspace import Workspace

WORKSPACE = "~/robot_project_ws"
EXECUTABLES = ("status_publisher", "command_subscriber", "velocity_publisher")
TWIST, LOG = "geometry_msgs/msg/Twist", "rcl_interfaces/msg/Log"
STATE_AFTER = {"start": "running", "stop": "stopped", "reset": "idle"}
# What is said to the node, one after the other, and the state that it must publish; None leaves it as it is.
# Each command comes in each state in which it changes something.
CONVERSATION = (
    ("start", "running"),
    ("stop", "stopped"),
    ("reset", "idle"),
    ("start", "running"),
    ("dance", None),
    ("reset", "idle"),
    ("do not start", None),
    ("start", "running"),
    ("", None),
    ("stop", "stopped"),
    ("start", "running"),
    (" STOP ", "stopped"),
)
# What each executable's node does: on which topic, in a word, and where that is seen.
TASKS = {
    "status_publisher": ("/robot/status", "publishes", ObservedDomain.published),
    "command_subscriber": ("/robot/command", "subscribes to", ObservedDomain.subscribed),
    "velocity_publisher": ("/cmd_vel", "publishes", ObservedDomain.published),
}
BACKGROUND = ("status", "commands", "velocity")  # the lesson's terminals, one for each node
STATUS_PERIOD = hand_in.ASSIGNMENT.parts["status_publisher"].period
VELOCITY_PERIOD = 0.1  # s
SPEED, TURN = 0.5, 0.2  # m/s, rad/s: velocity_in("running")
CONFIGURED_PERIOD, CONFIGURED_SPEED = 1.0, 0.4  # s, m/s: what the lesson asks of the parameter file
OTHER_SPEED = 0.75  # m/s, set while the node runs
PARAMETERS_OF_ALL = ("use_sim_time", "start_type_description_service")  # which every node has
NO_PERIODS = ("0.0", "-1.0")
REACTION = 5.0  # periods, within which a node must have taken in what it was told
STEADY_STATUSES, STEADY_VELOCITIES = 1, 4  # how many more messages must fit after the first that does
WARNING = 30  # the level of a log line
TIMER_HINT = (
    "what calls the function that publishes? create_timer does so again and again, while the node is spun."
)
# Functions of robot_state that the student's tests look at, and what a broken one returns whatever it is given.
BROKEN: dict[str, tuple[str, ...]] = {
    "state_after": ("'broken'", "None"),
    "velocity_in": ("(9.0, 9.0)", "(0.0, 0.0)"),
}


@exercise
def package() -> str:
    """Check that the workspace holds an ament_python package with the name and the dependencies that were asked for.

    Raises:
        CheckError: if it does not.
    """
    folder = _package_folder()
    shown = course.shown_path(folder)
    if not (folder / "package.xml").is_file():
        elsewhere = [
            file.parent
            for depth in ("*", "*/*", "*/*/*")
            for file in _workspace().path.glob(f"{depth}/package.xml")
        ]
        raise CheckError(
            f"a package in {shown}",
            ("no package.xml there" if folder.is_dir() else "no such folder")
            + (f"; there is a package.xml in {course.shown_path(elsewhere[0])}" if elsewhere else ""),
            "packages lie below src/: make them with `ros2 pkg create` while you are in it."
            if not folder.is_dir()
            else "`ros2 pkg create` makes it, but not where a folder of that name is: move it away by files.remove(PACKAGE).",
            f"type `cd {WORKSPACE}/src`, then `ros2 pkg create` with a build type, dependencies and the name {PACKAGE}.",
        )
    try:
        found = parse_package(str(folder), warnings=[])
    except InvalidPackage as error:
        reason = " ".join(str(error).split())
        raise CheckError("a valid package.xml", reason, "compare it with that of lesson 3.") from None
    if found.name != PACKAGE:
        raise CheckError(f"the package's name is {PACKAGE}", found.name, "look at <name> in package.xml.")
    if found.get_build_type() != "ament_python":
        raise CheckError(
            "the build type ament_python",
            found.get_build_type(),
            "it stands in <export> of package.xml, and `ros2 pkg create` has an option for it.",
        )
    needed = {dependency.name for dependency in [*found.build_depends, *found.exec_depends]}
    missing = [name for name in ("rclpy", "std_msgs", "geometry_msgs") if name not in needed]
    if missing:
        raise CheckError(
            "dependencies on rclpy, std_msgs and geometry_msgs",
            f"{', '.join(missing)} not among them",
            "what do the nodes import?",
            "a line <depend>...</depend> in package.xml for each.",
        )
    lacking = [
        name for name in ("setup.py", "setup.cfg", f"{PACKAGE}/__init__.py") if not (folder / name).is_file()
    ]
    if lacking:
        raise CheckError(
            f"the file {lacking[0]} in {shown}",
            "there is none",
            "a package made by `ros2 pkg create` has it.",
        )
    return "Right: your package has its name, its type and its dependencies."


@exercise
def status_publisher() -> str:
    """Check that the node publishes the state it is told as a String on /robot/status, every 2 s.

    Raises:
        CheckError: if it does not.
    """
    _judge("status_publisher", _expect_status)
    return "Right: /robot/status carries the present state as a String, every 2 s."


@exercise
def command_subscriber() -> str:
    """Check that the node logs each command, publishes the new state, and survives a word that it does not know.

    Raises:
        CheckError: if it does not.
    """
    with _running("command_subscriber") as node:
        node.expect_subscription("/robot/command", STRING)
        logged = node.domain.log("/rosout", LOG)
        state = node.log("/robot/state", STRING)
        answered: set[str] = set()
        before = "idle"
        for word, after in CONVERSATION:
            node.spins()
            state.clear()
            since = time.time()
            node.tell(command=word)
            if word:
                _expect_logged(node, logged, word, since)
            if after is None:
                _expect_unchanged(node, state, word, before)
            else:
                _expect_state(node, state, word, before, after, answered=answered)
                _expect_no_other_state(state, word, before, after)
                before = after
            node.expect_alive(f"after the command {word!r}")
            answered.add(word)
        _expect_kept(node, "stopped")
        node.expect_publisher("/robot/state", STRING)  # by now a second one would be known
    return "Right: start, stop and reset are received, logged and answered, and nonsense does no harm."


@exercise
def velocity_publisher() -> str:
    """Check that the node publishes a Twist on /cmd_vel every 0.1 s, which moves the robot only while it is running.

    Raises:
        CheckError: if it does not.
    """
    _judge("velocity_publisher", _expect_velocity)
    return "Right: /cmd_vel carries a Twist every 0.1 s: the robot drives when it should, and stands when it should."


@exercise
def executables() -> str:
    """Check that the built package has three executables, and that each of them starts its node.

    Raises:
        CheckError: if it has not, or one does not start, or starts another node.
    """
    workspace = _workspace()
    overlay = overlay_of(workspace)
    _expect_fresh()
    # A script of an earlier build stays in install/; it counts only if there is an entry point for it.
    named = _entry_points(workspace)
    paths = {script.name: script.path for script in workspace.executables(PACKAGE) if script.name in named}
    missing = [name for name in EXECUTABLES if name not in paths]
    if missing:
        raise CheckError(
            f"the executables {', '.join(EXECUTABLES)} in install/",
            f"{', '.join(sorted(paths)) or 'none'}",
            f"setup.py has no entry point named {missing[0]}: write it, and build again.",
            "three lines in console_scripts, each with a comma at its end: name = package.module:function",
        )
    with ObservedDomain() as domain:
        for count, (name, (topic, verb, ends_of)) in enumerate(TASKS.items(), 1):
            process = domain.start(name, [str(paths[name])], overlay)
            _expect_task(WatchedProgram(domain, process, workspace.path, nodes=count), topic, verb, ends_of)
        domain.wait(lambda: len(domain.nodes()) >= len(EXECUTABLES))
        if len(set(domain.nodes())) < len(EXECUTABLES):
            raise CheckError(
                "three nodes with different names",
                ", ".join(sorted(set(domain.nodes()))),
                "each node needs a name of its own: it is the argument of super().__init__().",
            )
    return "Right: three executables, three nodes."


@exercise
def on_the_air() -> str:
    """Check that three nodes publish and subscribe at this moment, in the domain of this notebook.

    Raises:
        CheckError: if they do not.
    """
    with _own_domain() as domain:
        wanted: dict[str, tuple[str, str, Callable[[], dict[str, list[str]]]]] = {
            "/robot/status": ("published", STRING, domain.published),
            "/robot/command": ("subscribed to", STRING, domain.subscribed),
            "/cmd_vel": ("published", TWIST, domain.published),
        }
        _wait_for_terminals(domain)
        domain.wait(lambda: all(kind in ends().get(topic, []) for topic, (_, kind, ends) in wanted.items()))
        for topic, (verb, kind, ends) in wanted.items():
            if kind not in ends().get(topic, []):
                terminal, words = _idle_terminal()
                raise CheckError(
                    f"{topic} [{kind}] is {verb}",
                    f"the nodes that run are {', '.join(domain.nodes()) or 'none'}{words}",
                    f"no program runs in terminal {terminal}: read what stands there, put it right, and run its cell again."
                    if terminal
                    else "three terminals, one node in each: run each of the three background cells.",
                )
        if domain.wait(
            lambda: any(domain.count_publishers(topic) > 1 for topic in hand_in.PUBLISHED), domain.late
        ):
            topic = max(hand_in.PUBLISHED, key=domain.count_publishers)
            raise CheckError(
                f"one node publishes {topic}",
                f"{domain.count_publishers(topic)} publishers; the nodes that run are {', '.join(domain.nodes())}",
                "a node runs twice: end one by terminal(NAME).interrupt(), or in the notebook that started it.",
            )
    return "Right: all three nodes are running."


@exercise
def drives() -> str:
    """Check that the robot moves at this moment, in the domain of this notebook.

    Raises:
        CheckError: if it does not.
    """
    with _own_domain() as domain:
        _wait_for_terminals(domain)
        domain.wait(lambda: "/cmd_vel" in domain.published() and domain.node.count_publishers("/rosout") > 1)
        log, lines = domain.log("/cmd_vel", TWIST), domain.log("/rosout", LOG)
        if domain.wait(lambda: any(map(message_numbers, _messages(log)))):
            return "Right: the robot drives."
        if not log.count:
            raise CheckError(
                "a velocity on /cmd_vel that is not zero",
                f"nothing on /cmd_vel; the nodes that run are {', '.join(domain.nodes()) or 'none'}",
                "velocity_publisher must run: run its background cell.",
            )
        if "/robot/command" not in domain.subscribed():
            raise CheckError(
                "a node that subscribes to /robot/command",
                f"the nodes that run are {', '.join(domain.nodes())}",
                "command_subscriber must run: run its background cell, and then give the command again.",
            )
        received = [
            m.msg for m in _messages(lines) if any(word in m.msg.lower() for word in ("received", "command"))
        ]
        raise CheckError(
            "a velocity on /cmd_vel that is not zero",
            f"0 m/s; the newest log line about a command is {received[-1]!r}"
            if received
            else "0 m/s, and no log line about a command in the last seconds",
            "a command has arrived, but not start: publish the word start."
            if received
            else "publish the word start on the topic /robot/command, with the type std_msgs/msg/String.",
            'publish once: ros2 topic pub --once /robot/command std_msgs/msg/String "{data: start}"',
        )


@exercise
def parameters() -> str:
    """Check that each of the two publishers has a parameter for its period, and one of them another for its speed.

    Raises:
        CheckError: if one has not, or a default is not the value from before.
    """
    _judge("status_publisher", lambda node: _expect_parameters(node, "/robot/status", STRING, STATUS_PERIOD))
    _judge("velocity_publisher", lambda node: _expect_parameters(node, "/cmd_vel", TWIST, VELOCITY_PERIOD))
    return "Right: both periods can be set from outside, and the speed while the robot drives."


@exercise
def launch_file() -> str:
    """Check that an installed launch file starts the three nodes, and that they keep running.

    Raises:
        CheckError: if there is none, or it does not.
    """
    _expect_launched()
    return "Right: one command starts all three."


@exercise
def configuration() -> str:
    """Check that the launched nodes publish every second and drive at 0.4 m/s, by an installed parameter file.

    Raises:
        CheckError: if there is no such file, or they do not.
    """
    files = _installed(YAML_FILES, "a parameter file, such as config/robot.yaml")
    _expect_launched(lambda nodes: _expect_configured(nodes, files))
    return "Right: what the file says holds for the nodes."


@exercise
def unit_tests() -> str:
    """Check that colcon has run the student's tests since they were changed, that they pass, and that they can fail.

    Raises:
        CheckError: if not.
    """
    report = _workspace().path / "build" / PACKAGE / "pytest.xml"
    expected = "a run of `colcon test` with at least one test of yours that passed, and none that failed"
    tests = count_tests(report, except_of=GENERATED_TESTS)
    if tests is None:
        raise CheckError(
            expected,
            "no report in build/ that can be read",
            f"type `cd {WORKSPACE}`, `colcon build`, `colcon test`.",
        )
    changed = _changed_since(report)
    if changed:
        raise CheckError(
            expected,
            f"{course.shown_path(changed)} was changed after the last run",
            "run `colcon test` again.",
        )
    if tests["failed"]:
        raise CheckError(
            expected,
            f"{tests['failed']} of {tests.total()} failed: {_words_of_tests()}",
            "compare what the test expects with what the function returns; `colcon test-result --verbose` shows both.",
        )
    if not tests["passed"]:
        raise CheckError(
            expected,
            "no test of yours that was run",
            "a file test/test_...py with functions test_...(): pytest finds no others.",
        )
    for function, values in BROKEN.items():
        _expect_noticed(function, values)
    return "Right: your tests pass, and they fail when the code is wrong."


@exercise
def error_handling() -> str:
    """Check that a wrong command and a wrong period are warned about, and that nothing else is caught.

    Raises:
        CheckError: if not.
    """
    caught = hand_in.places_of_practices(_workspace(), PACKAGE).get(hand_in.CAUGHT, [])
    too_wide = [place for place in caught if place] or list(_broad_handlers())
    if too_wide:
        raise CheckError(
            "each except names the error that it expects",
            f"{too_wide[0]} catches every error",
            "a mistake of your own would be hidden there too: write except ValueError.",
        )
    with _running("command_subscriber") as node:
        node.expect_subscription("/robot/command", STRING)
        state = node.log("/robot/state", STRING)
        logged = node.domain.log("/rosout", LOG)
        started = time.time()
        node.tell(command="start")
        _expect_state(node, state, "start", "idle", "running", answered=())
        for word in ("dance", "", "   "):
            node.spins()
            state.clear()
            since = time.time()
            node.tell(command=word)
            _expect_warned(node, logged, f"the command {word!r}", since, word)
            if word == "dance":  # by now all that it logged before has come: log lines keep their order
                _expect_not_warned(logged, "start", started, since)
            _expect_unchanged(node, state, word, "running")
    for period in NO_PERIODS:
        _judge("status_publisher", _expect_default_period, f"period:={period}")
    return "Right: wrong commands and wrong values are told, and the nodes go on."


QUIZ, PREDICTIONS = questions_of(__name__)
quiz = quiz_of(__name__, QUIZ)
predict = predict_of(__name__, PREDICTIONS)


def _expect_task(
    node: WatchedProgram, topic: str, verb: str, ends_of: Callable[[ObservedDomain], Mapping[str, object]]
) -> None:
    """Check that the program that was started last is the one that its name promises."""
    name, before = node.process.executable, set(ends_of(node.domain))
    try:
        node.expect_end(topic, lambda: ends_of(node.domain))
    except LookupError:
        new = set(ends_of(node.domain)) - before
        raise CheckError(
            f"the executable {name} {verb} {topic}",
            f"it {verb} {', '.join(sorted(new)) or 'no new topic'}",
            f"look at the entry point {name} in setup.py: the module behind the = is to be that of {name}.",
        ) from None


def _expect_status(node: WatchedProgram) -> None:
    node.tell(state="idle", command="reset")
    log = node.log("/robot/status", STRING)
    told = "a message on /robot/status every 2 s"
    node.expect_period(log, STATUS_PERIOD, told, TIMER_HINT)
    for command, state in STATE_AFTER.items():
        node.tell(state=state, command=command)
        log.clear()
        if not node.wait_until(
            lambda: log.latest is not None and _tells(log.latest.message, state),  # noqa: B023
            REACTION * STATUS_PERIOD / 2,
        ):
            node.expect_alive()
            raise _wrong_status(node, log, state)
        later = _next_messages(node, log, STEADY_STATUSES, STATUS_PERIOD)
        if not all(_tells(message, state) for message in later):
            raise CheckError(
                f"the word {state} in each text on /robot/status while the state is {state}",
                f"it is in one, and the next one is {later[-1].data!r}",
                "name the present state each time that the timer calls you, also when it has not changed.",
            )
    node.expect_publisher("/robot/status", STRING)  # by now a second one would be known


def _tells(message: Any, state: str) -> bool:
    text = message.data.lower()
    return state in text and not any(other in text for other in STATE_AFTER.values() if other != state)


def _next_messages(node: WatchedProgram, log: TopicLog, count: int, period: float) -> list[Any]:
    """Return the messages that come next, `count` of them or more, or fewer if they end."""
    log.clear()
    node.wait_until(lambda: log.count >= count, (count + 1) * period)
    node.expect_alive()
    return _messages(log)


def _wrong_status(node: WatchedProgram, log: TopicLog, state: str) -> CheckError:
    expected = f"the word {state} in the text on /robot/status while the state is {state}"
    text = log.latest.message.data if log.latest else None
    found = "no message" if text is None else repr(text)
    if deaf := node.deafness("/robot/state", "/robot/command"):
        return CheckError(expected, f"{found}; {deaf[0]}", deaf[1])
    if text is None:
        return CheckError(expected, found, "the timer goes on whatever the state is: publish each time.")
    words = [word for word in STATE_AFTER.values() if word in text.lower()]
    if not text.strip():
        hint = "String(data=...) takes the text; here it is empty."
    elif not words:
        hint = "the text names the state, such as state=idle: .state of the Follower has it."
    elif len(words) > 1:
        hint = "the text names the present state, and no other."
    else:
        hint = "that is not the present state: read .state of the Follower each time that the timer calls you, not once, and name it as it is."
    return CheckError(expected, found, hint)


def _expect_velocity(node: WatchedProgram) -> None:
    node.tell(state="idle", command="reset")
    log = node.log("/cmd_vel", TWIST)
    _expect_velocity_period(node, log)
    for state, command in (
        ("idle", "reset"),
        ("running", "start"),
        ("stopped", "stop"),
        ("running", "start"),
        ("idle", "reset"),
    ):
        wanted = {"linear.x": SPEED, "angular.z": TURN} if state == "running" else {}
        node.tell(state=state, command=command)
        log.clear()
        if not node.wait_until(
            lambda: log.latest is not None and _is_twist(log.latest.message, wanted),  # noqa: B023
            REACTION * VELOCITY_PERIOD,
        ):
            node.expect_alive(f"after the state {state}")
            raise _wrong_velocity(node, log, state)
        later = _next_messages(node, log, STEADY_VELOCITIES, VELOCITY_PERIOD)
        if len(later) < STEADY_VELOCITIES:
            raise _wrong_velocity(node, log, state, is_silent=True)
        other = next((twist for twist in later if not _is_twist(twist, wanted)), None)
        if other is not None:
            raise CheckError(
                f"{_velocity(wanted)} in each Twist while the state is {state}",
                f"that in one, and then {_velocity(message_numbers(other))}",
                "publish the two numbers of velocity_in each time that the timer calls you: nothing added up, and nothing left out.",
            )
    node.expect_publisher("/cmd_vel", TWIST)  # by now a second one would be known


def _expect_velocity_period(node: WatchedProgram, log: TopicLog) -> None:
    told = "a Twist on /cmd_vel every 0.1 s, also while the robot stands"
    try:
        node.expect_period(log, VELOCITY_PERIOD, told, TIMER_HINT)
    except CheckError as error:
        node.tell(state="running", command="start")
        if log.count < 2 and node.wait_until(lambda: log.count >= 3, REACTION * VELOCITY_PERIOD):
            raise CheckError(
                told,
                "none while the robot stands; they begin when it is running",
                "publish zeros too: a robot that receives nothing cannot know whether it should stop or the program has died.",
            ) from None
        raise error


def _wrong_velocity(
    node: WatchedProgram, log: TopicLog, state: str, *, is_silent: bool = False
) -> CheckError:
    wanted = {"linear.x": SPEED, "angular.z": TURN} if state == "running" else {}
    expected = f"{_velocity(wanted)} while the state is {state}"
    found = message_numbers(log.latest.message) if log.latest else {}
    said = _velocity(found) if log.latest and not is_silent else "nothing more comes"
    if not log.latest or is_silent:
        return CheckError(
            expected, said, "the timer goes on whatever the state is: publish each time, zeros too."
        )
    if deaf := node.deafness("/robot/state", "/robot/command"):
        return CheckError(expected, f"{said}; {deaf[0]}", deaf[1])
    if sorted(found.values()) == sorted(wanted.values()):
        hint = "the first number of velocity_in belongs in linear.x, the second one in angular.z."
    elif not wanted:
        hint = f"a robot that does not stop is dangerous: velocity_in({state!r}) gives two zeros; ask it each time that the timer calls you."
    elif not found:
        hint = "hand .state of the Follower to velocity_in each time that the timer calls you."
    else:
        hint = 'the numbers are those of velocity_in("running"): hand both on as they are.'
    return CheckError(expected, said, hint)


def _is_twist(twist: Any, wanted: Mapping[str, float]) -> bool:
    found = message_numbers(twist)
    return found.keys() == wanted.keys() and all(
        math.isclose(found[name], wanted[name], abs_tol=1e-9) for name in wanted
    )


def _velocity(numbers: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {value:g}" for name, value in numbers.items()) or "zeros"


def _expect_logged(node: WatchedProgram, logged: TopicLog, word: str, since: float) -> None:
    wanted = word.strip().lower()
    if node.wait_until(lambda: any(wanted in line.lower() for line in _lines(logged, since)), 0.0):
        return
    node.expect_alive(f"after the command {word!r}")
    expected = f"a log line that holds the command {word!r}"
    if deaf := node.deafness("/robot/command"):
        raise CheckError(expected, f"none; {deaf[0]}", deaf[1])
    lines = _lines(logged, since)
    if lines:
        raise CheckError(
            expected, repr(lines[-1]), "the word itself is in the message's field data: put it into the text."
        )
    if wanted in node.process.output.lower():
        raise CheckError(
            expected, "it is printed, but not logged", "self.get_logger().info(...) writes a log line."
        )
    raise CheckError(
        expected,
        "no log line",
        'log each word as it comes, also one that is no command: self.get_logger().info(f"... {message.data!r}").',
    )


def _expect_state(
    node: WatchedProgram, state: TopicLog, word: str, before: str, after: str, *, answered: Iterable[str]
) -> None:
    if node.wait_until(lambda: any(message.data == after for message in _messages(state)), 0.0):
        return
    node.expect_alive(f"after the command {word!r}")
    expected = f"{after!r} on /robot/state after the command {word!r}"
    found = ", ".join(repr(message.data) for message in _messages(state)[-3:])
    if found:
        raise CheckError(expected, found, f"state_after({word!r}) gives {after!r}: publish what it returns.")
    if deaf := node.deafness("/robot/command"):
        raise CheckError(expected, f"nothing; {deaf[0]}", deaf[1])
    if word in answered:
        raise CheckError(
            expected,
            f"nothing in the state {before!r}, though the first {word!r} was answered",
            "what has changed since then? Look at the variables that your function sets.",
        )
    if word != word.strip().lower():
        raise CheckError(
            expected,
            "nothing",
            "capitals, and blanks around the word, do not matter: state_after in robot_state.py takes them away, and compares what is left.",
        )
    raise CheckError(
        expected, "nothing", f"publish the state in the function that receives the command, also for {word}."
    )


def _expect_no_other_state(state: TopicLog, word: str, before: str, after: str) -> None:
    """Check that a command led from one state to the next, and nowhere in between."""
    published = [message.data for message in _messages(state)]
    change = published.index(after)
    others = [data for data in published[:change] if data != before]
    others += [data for data in published[change:] if data != after]
    if others:
        raise CheckError(
            f"nothing but {after!r} on /robot/state after the command {word!r}",
            f"{others[0]!r} as well",
            "publish once for each command: the state that state_after gives, and no other.",
        )


def _expect_unchanged(node: WatchedProgram, state: TopicLog, word: str, before: str) -> None:
    """Wait until the program has received a word that is no command; the state must stay as it was before."""
    if not node.spins():
        node.domain.wait(lambda: node.ended() is not None)

    def others() -> list[str]:
        return [message.data for message in _messages(state) if message.data != before]

    if node.domain.wait(lambda: others() or node.ended(), node.domain.late):
        node.expect_alive(f"after the command {word!r}")
        raise CheckError(
            f"the state stays as it is after {word!r}, which is no command",
            f"{others()[0]!r} on /robot/state",
            "publish only what is a state: state_after gives None for every other word.",
        )
    node.expect_alive(f"after the command {word!r}")


def _expect_kept(node: WatchedProgram, state: str) -> None:
    """Check that a subscription that is made only now, as a node that starts late makes it, gets the state."""
    late = TopicLog(node.domain.node, "/robot/state", find_type(STRING), qos=LATCHED)
    if node.wait_until(lambda: any(message.data == state for message in _messages(late)), 0.0):
        return
    raise CheckError(
        f"a node that starts now receives the state {state!r}",
        node.said("incompatible QoS")
        or ", ".join(repr(message.data) for message in _messages(late))
        or "nothing",
        "state_topic.LATCHED is the third argument of create_publisher: then the last state is kept for late-joining nodes.",
    )


def _expect_warned(
    node: WatchedProgram, logged: TopicLog, what: str, since: float = 0.0, word: str = ""
) -> None:
    if node.wait_until(lambda: bool(_lines(logged, since, WARNING)), 0.0):
        line = _lines(logged, since, WARNING)[-1]
        if word.strip() in line:
            return
        raise CheckError(
            f"a warning that names {what}",
            f"{line!r}",
            "put the word into the text: {message.data!r} shows it in quotes, so that blanks are seen.",
        )
    node.expect_alive(f"after {what}")
    lines = _lines(logged, since)
    raise CheckError(
        f"a warning in the log about {what}",
        f"the log line {lines[-1]!r}, which is no warning" if lines else "no log line",
        "self.get_logger().warning(...) in the except writes one.",
    )


def _expect_not_warned(logged: TopicLog, word: str, begin: float, end: float) -> None:
    """Check that a word brought no warning between two times (s); a warning after the second one must have come."""
    later = _lines(logged, end, WARNING)
    if warnings := _lines(logged, begin, WARNING)[: -len(later)]:
        raise CheckError(
            f"no warning about the command {word!r}",
            repr(warnings[-1]),
            "warn only of a word that is no command.",
        )


def _expect_default_period(node: WatchedProgram) -> None:
    log = node.log("/robot/status", STRING)
    logged = node.domain.log("/rosout", LOG)
    node.expect_period(
        log,
        STATUS_PERIOD,
        "with a period that makes no sense, a message on /robot/status every 2 s",
        *["refuse a period of zero or less, and take the default."] * 2,
    )
    _expect_warned(node, logged, "a period of zero or less")


def _expect_parameters(node: WatchedProgram, topic: str, kind: str, period: float) -> None:
    """Check the defaults of a node, and that one of its numbers changes its period."""
    module = node.process.executable
    log = node.log(topic, kind)
    node.expect_period(
        log, period, f"without any setting, a message on {topic} every {period:g} s", TIMER_HINT
    )
    values = {
        name: value
        for own in node.domain.nodes()
        for name, value in node.domain.parameters(own).items()
        if name not in PARAMETERS_OF_ALL
    }
    numbers = {
        name: value // 2 if isinstance(value, int) else value / 2
        for name, value in values.items()
        if isinstance(value, (int, float)) and not isinstance(value, bool) and value > 0
    }
    # Half the value is half the period, or twice as long if it is a rate. The likeliest comes first.
    likely = sorted(numbers, key=lambda name: abs(math.log(values[name] / period)))
    effective, ended = None, ""
    for name in filter(numbers.get, likely):
        setting = f"{name}:={numbers[name]}"
        try:
            changed = _period_with(setting, module, topic, kind, period)
        except CheckError as error:  # also for a value that the node refuses
            ended = f"; with {setting}: {error.found}"
            continue
        if abs(math.log2(changed / period)) > 0.5:  # nearer to half or twice as long
            effective = name
            break
    if effective is None:
        raise CheckError(
            f"a parameter of {module} for the time between its messages",
            f"{', '.join(likely)}: none of them changes the period{ended}"
            if likely
            else f"its parameters with a number: none; all: {', '.join(values) or 'none'}",
            "its value goes into create_timer: the declaration alone changes nothing."
            if likely
            else 'self.declare_parameter("period", 2.0).value declares it, and is its value.',
        )
    if isinstance(values[effective], int) and values[effective] == period:
        raise CheckError(
            f"{effective} of {module} can be a part of a second, such as 1.5",
            f"its default is the integer {values[effective]}, and a parameter keeps the type of its default",
            f"declare it with {period:.1f}.",
        )
    if kind == TWIST:
        _expect_speed(node, log, values)


def _expect_speed(node: WatchedProgram, log: TopicLog, values: Mapping[str, Any]) -> None:
    expected = (
        f"linear.x {OTHER_SPEED:g} after linear_speed was set to {OTHER_SPEED:g} while the robot drives"
    )
    if "linear_speed" not in values:
        raise CheckError(
            "a parameter linear_speed of velocity_publisher",
            ", ".join(values) or "no parameter of its own",
            'self.declare_parameter("linear_speed", 0.5) in __init__ declares it.',
        )
    node.tell(state="running", command="start")
    is_set = all(node.domain.set_parameter(name, "linear_speed", OTHER_SPEED) for name in node.domain.nodes())
    log.clear()
    wanted = {"linear.x": OTHER_SPEED, "angular.z": TURN}
    if not node.wait_until(
        lambda: log.latest is not None and _is_twist(log.latest.message, wanted), REACTION * VELOCITY_PERIOD
    ):
        node.expect_alive("after linear_speed was set")
        found = _velocity(message_numbers(log.latest.message)) if log.latest else "nothing"
        raise CheckError(
            expected,
            found if is_set else f"{found}; the node refused the value",
            'ask for the value each time that the timer calls you: self.get_parameter("linear_speed").value.',
        )


def _period_with(setting: str, module: str, topic: str, kind: str, default: float) -> float:
    """Return the period (s) of a node with a parameter set, such as `period:=1.0`; without it, it is about `default`.

    Raises:
        CheckError: if the node ends, or publishes less than twice.
    """
    found: list[float] = []

    def measure(node: WatchedProgram) -> None:
        log = node.log(topic, kind)
        period = node.period(log, default)
        if period is None:
            raise CheckError(f"messages on {topic}", f"{log.count or 'none'} of them", TIMER_HINT)
        found.append(period)

    _judge(module, measure, setting)
    return found[-1]


def _expect_launched(judge: Callable[[WatchedProgram], None] = lambda _: None) -> None:
    """Check that one of the installed launch files starts the three nodes, and that they are as `judge` wants them."""
    workspace = _workspace()
    overlay = overlay_of(workspace)
    files = _installed(LAUNCH_FILES, "a launch file, such as launch/robot.launch.py")
    _expect_fresh()

    def expect(file: Path) -> None:
        with launched(workspace.path, file, overlay, len(EXECUTABLES)) as nodes:
            nodes.expect_publisher("/robot/status", STRING)
            nodes.expect_publisher("/cmd_vel", TWIST)
            nodes.expect_subscription("/robot/command", STRING)
            _expect_at_work(nodes)
            nodes.domain.wait(lambda: len(nodes.domain.nodes()) >= len(EXECUTABLES))
            names = nodes.domain.nodes()
            if len(set(names)) < len(names):
                raise CheckError(
                    "launched nodes with different names",
                    ", ".join(names),
                    f"name=... in {file.name} gives a node another name: leave it out, or give each node its own.",
                )
            judge(nodes)

    # The one that names the most of the nodes is the likeliest, and a start takes seconds.
    errors = []
    for file in sorted(files, key=_named_executables, reverse=True):
        try:
            return expect(file)
        except CheckError as error:
            errors.append(error)
    raise errors[0]


def _expect_at_work(nodes: WatchedProgram) -> None:
    """Wait for the first message of each publisher: what dies when it begins to work has then died."""
    logs = [nodes.log(topic, kind) for topic, kind in (("/robot/status", STRING), ("/cmd_vel", TWIST))]
    nodes.wait_until(lambda: all(log.count for log in logs), 2 * STATUS_PERIOD)
    for log in logs:
        log.close()
    nodes.expect_alive()


def _named_executables(file: Path) -> int:
    text = file.read_text(encoding="utf-8", errors="replace")
    return sum(name in text for name in EXECUTABLES)


def _expect_configured(nodes: WatchedProgram, files: Iterable[Path]) -> None:
    status, velocity = nodes.log("/robot/status", STRING), nodes.log("/cmd_vel", TWIST)
    period = nodes.period(status, CONFIGURED_PERIOD)
    if not has_period(period, CONFIGURED_PERIOD):
        found = f"one every {period:.2g} s" if period else f"{status.count or 'none'} of them"
        expected = "a message on /robot/status every second, once it is launched"
        raise CheckError(expected, *_why_not_configured(found, CONFIGURED_PERIOD, files))
    nodes.tell(command="start")
    if not nodes.wait_until(
        lambda: bool(
            velocity.latest and message_numbers(velocity.latest.message).get("linear.x") == CONFIGURED_SPEED
        ),
        0.0,
    ):
        found = _velocity(message_numbers(velocity.latest.message)) if velocity.latest else "nothing"
        expected = "linear.x 0.4 on /cmd_vel after start, once it is launched"
        raise CheckError(expected, *_why_not_configured(found, CONFIGURED_SPEED, files))
    if not any(CONFIGURED_SPEED in _values_in(file) for file in files):
        raise CheckError(
            "the speed of 0.4 m/s stands in the parameter file",
            f"it is set, but not by {', '.join(file.name for file in files)}",
            "take it out of the launch file, and write it into the parameter file.",
        )


def _why_not_configured(found: str, wanted: float, files: Iterable[Path]) -> tuple[str, str]:
    """Return what was found, with what the files hold, and what to do."""
    for finding in diagnose.of_workspace(_workspace().path):
        if finding.code in (
            "parameter-file-node",
            "parameter-name",
            "parameter-type",
            "parameter-file-syntax",
        ):
            return f"{found}. {finding.cause.rstrip('.')}", f"{finding.fix} ({finding.place})."
    values = sorted({value for file in files for value in _values_in(file)})
    names = ", ".join(file.name for file in files)
    if wanted not in values:
        said = ", ".join(f"{value:g}" for value in values) or "no number"
        return (
            f"{found}; {names} holds {said}",
            f"write {wanted} for it into the file, below ros__parameters.",
        )
    return (
        f"{found}, though {names} holds {wanted}",
        "the file's value does not reach the node: the launch file hands the file on with parameters=[config], for each node.",
    )


def _values_in(file: Path) -> set[float]:
    """Return the numbers that a parameter file sets."""
    try:
        content = read_parameter_file(file.read_text(encoding="utf-8", errors="replace"))
    except ParameterFileError:
        return set()

    def numbers(value: Any) -> Iterator[float]:
        if isinstance(value, dict):
            for inner in value.values():
                yield from numbers(inner)
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            yield float(value)

    return set(numbers(content))


def _expect_noticed(function: str, values: Iterable[str]) -> None:
    """Check that the student's tests fail when a function of robot_state is broken in one of these ways."""
    with tempfile.TemporaryDirectory() as scratch:
        copy = Path(shutil.copytree(_package_folder(), Path(scratch, PACKAGE), symlinks=False))
        module = copy / PACKAGE / "robot_state.py"
        sound = module.read_text(encoding="utf-8") if module.is_file() else ""
        for value in values:
            module.write_text(f"{sound}\n\ndef {function}(*_, **__):\n    return {value}\n", encoding="utf-8")
            finished = _run_tests(copy)
            if finished.returncode != 0:
                return
    raise CheckError(
        f"a test that fails when {function} is wrong",
        f"the check made {function} return {value} for everything, and pytest still says: {last_line(finished.stdout)}",
        f"call {function} in a test, and compare what it returns by assert ... == ...",
    )


def _run_tests(package: Path) -> subprocess.CompletedProcess[str]:
    """Run the student's own tests of a package's folder."""
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "--tb=line",
        "--color=no",
        "-p",
        "no:cacheprovider",
        "test",
    ]
    command += [f"--ignore=test/{name}.py" for name in GENERATED_TESTS]
    environ = {**environment.lab_environment(), "COLUMNS": "300"}
    path = os.pathsep.join(filter(None, [str(package), environ.get("PYTHONPATH", "")]))
    return programs.run(
        command,
        "pytest",
        folder=package,
        environ={
            **environ,
            "PYTHONPATH": path,
            "PYTHONDONTWRITEBYTECODE": "1",
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",  # the lab's own plugins are slow to import
        },
    )


def _words_of_tests() -> str:
    """Return what pytest says of the student's own tests that fail."""
    lines = _run_tests(_package_folder()).stdout.splitlines()
    failed = [line for line in lines if line.startswith(("FAILED", "ERROR"))]
    return failed[0] if failed else "run `colcon test-result --verbose` to see which"


def _changed_since(report: Path) -> Path | None:
    """Return a file of the package's code or tests that is newer than a report of its tests; None if there is none."""
    sources = [file for name in (PACKAGE, "test") for file in (_package_folder() / name).rglob("*.py")]
    newer = (file for file in sorted(sources) if file.stat().st_mtime > report.stat().st_mtime)
    return next(newer, None)


def _broad_handlers() -> Iterator[str]:
    """Yield where the package catches `Exception`, and so every error."""
    inner = _package_folder() / PACKAGE
    for file in sorted(inner.rglob("*.py")):
        with contextlib.suppress(SyntaxError, UnicodeDecodeError):
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                if not isinstance(node, ast.ExceptHandler):
                    continue
                named = node.type.elts if isinstance(node.type, ast.Tuple) else [node.type]
                if {name.id for name in named if isinstance(name, ast.Name)} & {"Exception", "BaseException"}:
                    yield f"{file.relative_to(inner)}:{node.lineno}"


def _judge(module: str, expect: Callable[[WatchedProgram], None], *parameters: str) -> None:
    """Judge a node on a simulated clock, and in real time if it does not follow that clock."""
    try:
        with _running(module, *parameters, is_driven=True) as node:
            expect(node)
    except NotDrivenError:
        with _running(module, *parameters) as node:
            expect(node)


@contextlib.contextmanager
def _running(module: str, *parameters: str, is_driven: bool = False) -> Iterator[WatchedProgram]:
    """Run a module of the student's from its source."""
    _check_source(_package_folder() / PACKAGE / f"{module}.py")
    with running(_workspace().path, PACKAGE, module, *parameters, is_driven=is_driven) as node:
        yield node


@contextlib.contextmanager
def _own_domain() -> Iterator[ObservedDomain]:
    """Observe the domain in which the notebook's terminals are."""
    environment.apply()
    with ObservedDomain(int(os.environ.get("ROS_DOMAIN_ID") or 0)) as domain:
        yield domain


def _wait_for_terminals(domain: ObservedDomain) -> None:
    """Wait for the nodes of the notebook's terminals, which may have been started just now."""
    busy = sum(terminal.is_busy for terminal in magic.terminals().values())
    domain.wait_for_start(lambda: len(domain.nodes()) >= busy, START_TIMEOUT)


def _idle_terminal() -> tuple[str, str]:
    """Return the name and the last words of a background terminal in which nothing runs any more, if there is one."""
    for name, terminal in magic.terminals().items():
        if name in BACKGROUND and not terminal.is_busy:
            lines = [line for line in read_error(terminal.read()).text.splitlines() if line.strip()]
            said = [line.strip() for line in lines if not line.startswith(f"{name}:")]
            return repr(name), f"; terminal {name!r} says: {said[-1] if said else 'nothing'}"
    return "", ""


def _workspace() -> Workspace:
    return Workspace(course.student_path(WORKSPACE))


def _package_folder() -> Path:
    return course.student_path(WORKSPACE) / "src" / PACKAGE


def _messages(log: TopicLog) -> list[Any]:
    return [sample.message for sample in log.samples()]


def _lines(logged: TopicLog, since: float, level: int = 0) -> list[str]:
    """Return the log lines of a level or above since a time (s); older ones may come late."""
    return [
        message.msg
        for message in _messages(logged)
        if message.level >= level and message.stamp.sec + message.stamp.nanosec * 1e-9 >= since
    ]


def _entry_points(workspace: Workspace) -> set[str]:
    """Return the names of the entry points that the package has as it was built last."""
    folders = [*workspace.path.glob("install/**/site-packages"), workspace.path / "build" / PACKAGE]
    for folder in folders:  # with links, the second one
        for distribution in importlib.metadata.distributions(path=[str(folder)]):
            if distribution.name.replace("-", "_") == PACKAGE:
                return {point.name for point in distribution.entry_points.select(group="console_scripts")}
    return set()


def _is_left_out(file: Path) -> bool:
    """Return whether setup.py installs a file of the package nowhere."""
    findings = diagnose.of_workspace(_workspace().path)
    return any(one.code == "not-in-data-files" and file.name in one.cause for one in findings)


def _expect_fresh() -> None:
    """Check that what is installed is what stands in src now."""
    for finding in diagnose.of_workspace(_workspace().path):
        if finding.code in ("install-stale", "not-built"):
            raise CheckError(
                f"{WORKSPACE} is built as it is now", finding.cause.rstrip("."), f"type {finding.fix}."
            )


def _check_source(file: Path) -> None:
    shown = course.shown_path(file)
    if not file.is_file():
        raise CheckError(f"the file {shown}", "there is none", "run the cell that begins with %%editor.")
    try:
        tree = ast.parse(file.read_text(encoding="utf-8"))
    except (SyntaxError, UnicodeDecodeError) as error:
        where = f"line {error.lineno}: {error.msg}" if isinstance(error, SyntaxError) else str(error)
        raise CheckError(
            f"{shown} is Python",
            where,
            "look at that line and the one before: a bracket, a colon, the indentation?",
        ) from None
    names = {name for node in tree.body for name in _names_bound(node)}
    if "main" not in names:
        raise CheckError(
            f"{shown} has a function main",
            "none",
            "it makes the node and spins it; the entry point calls it.",
        )


def _names_bound(node: ast.stmt) -> Iterator[str]:
    for inner in ast.walk(node):
        if isinstance(inner, (ast.FunctionDef, ast.ClassDef)):
            yield inner.name
        elif isinstance(inner, ast.Name) and isinstance(inner.ctx, ast.Store):
            yield inner.id
        elif isinstance(inner, ast.alias):
            yield inner.asname or inner.name


def _installed(patterns: Iterable[str], what: str) -> list[Path]:
    """Return the package's installed files of this kind, at least one."""
    files = hand_in.shared_files(_workspace(), PACKAGE, *patterns)
    if files:
        return files
    sources = sorted(file for pattern in patterns for file in _package_folder().rglob(pattern))
    raise CheckError(
        f"{what}, installed in share/{PACKAGE}",
        f"only {sources[0].relative_to(_package_folder())} in src/" if sources else "none",
        "it was not built since: type `colcon build`."
        if sources and not _is_left_out(sources[0])
        else "data_files in setup.py names what is installed; then build again."
        if sources
        else "make the file first.",
        f"a line of data_files is a pair: (folder below install, list of files), such as ('share/{PACKAGE}/launch', [...]).",
    )
