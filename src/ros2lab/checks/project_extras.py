"""What lesson 7 expects of parameters, launch files, configuration and tests, and says of what is otherwise."""

from __future__ import annotations

import ast
import math
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from ros2lab import diagnose, environment
from ros2lab.checks import CheckError, programs
from ros2lab.checks.programs import overlay_of
from ros2lab.checks.project import (
    COMMANDS,
    LESSON,
    LOG,
    PARTS,
    STATUS,
    TIMER_HINT,
    TWIST,
    VELOCITY,
    command,
    expect_fresh,
    installed,
    judge_node,
    own_workspace,
    package_folder,
    tell_state_after,
)
from ros2lab.checks.project_commands import expect_warned
from ros2lab.checks.project_nodes import REACTION, is_twist, said_of
from ros2lab.checks.watched_program import (
    STRING,
    WatchedProgram,
    launched,
    message_numbers,
)
from ros2lab.diagnose.sources.parameter_file import ParameterFileError, read_parameter_file
from ros2lab.grading.building.spoiler import SPOILERS, Spoiler
from ros2lab.grading.evidence import Build
from ros2lab.hand_in import GENERATED_TESTS, LAUNCH_FILES, PACKAGE, YAML_FILES, shared_files
from ros2lab.judge import case_of, facts_of, lost
from ros2lab.node_process import last_line
from ros2lab.rhythm import has_period, is_another
from ros2lab.scratch import scratch_folder
from ros2lab.topics import TopicLog

PARAMETERS_OF_ALL = ("use_sim_time", "start_type_description_service")  # which every node has


def expect_default_period(node: WatchedProgram) -> None:
    """Check that a node warns of a period that makes no sense, and has the usual one."""
    log = node.log(STATUS.topic, STRING)
    logged = node.domain.log("/rosout", LOG)
    node.expect_period(
        log,
        STATUS.period,
        f"with a period that makes no sense, a message on {STATUS.topic} every {STATUS.period:g} s",
        *["refuse a period of zero or less, and take the default."] * 2,
    )
    expect_warned(node, logged, "a period of zero or less")


def expect_parameters(node: WatchedProgram, topic: str, kind: str, period: float) -> None:
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
        if is_another(changed, period):
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
    speed = LESSON.speed_parameter
    field = next(iter(next(iter(LESSON.velocities.values()))))
    expected = f"{field} {LESSON.other_speed:g} after {speed} was set to {LESSON.other_speed:g} while the robot drives"
    if LESSON.speed_parameter not in values:
        raise CheckError(
            f"a parameter {LESSON.speed_parameter} of {VELOCITY.name}",
            ", ".join(values) or "no parameter of its own",
            f'self.declare_parameter("{LESSON.speed_parameter}", 0.5) in __init__ declares it.',
        )
    tell_state_after(node, COMMANDS.commands[0])
    is_set = all(
        node.domain.set_parameter(name, LESSON.speed_parameter, LESSON.other_speed)
        for name in node.domain.nodes()
    )
    log.clear()
    (numbers,) = LESSON.velocities.values()
    wanted = {**numbers, next(iter(numbers)): LESSON.other_speed}
    if not node.wait_until(
        lambda: log.latest is not None and is_twist(log.latest.message, wanted),
        REACTION * LESSON.velocity_period,
    ):
        node.expect_alive(f"after {speed} was set")
        found = said_of(message_numbers(log.latest.message)) if log.latest else "nothing"
        raise CheckError(
            expected,
            found if is_set else f"{found}; the node refused the value",
            f'ask for the value each time that the timer calls you: self.get_parameter("{LESSON.speed_parameter}").value.',
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

    judge_node(module, measure, setting)
    return found[-1]


def expect_launched(criterion: str, judge: Callable[[WatchedProgram], None] = lambda _: None) -> None:
    """Check that one of the installed launch files starts the three nodes.

    Args:
        criterion: of the rubric, to which the grader, too, must have nothing to object.
        judge: checks the nodes.

    Raises:
        CheckError: if none does, or the nodes are not as they should be.
    """
    workspace = own_workspace()
    overlay = overlay_of(workspace)
    files = installed(LAUNCH_FILES, "a launch file, such as launch/robot.launch.py")
    expect_fresh()

    def expect(file: Path) -> None:
        with launched(workspace.path, file, overlay, len(tuple(PARTS))) as nodes:
            nodes.expect_publisher(STATUS.topic, STRING)
            nodes.expect_publisher(VELOCITY.topic, TWIST)
            nodes.expect_subscription(COMMANDS.topic, STRING)
            _expect_at_work(nodes)
            nodes.domain.wait(lambda: len(nodes.domain.nodes()) >= len(tuple(PARTS)))
            names = nodes.domain.nodes()
            if len(set(names)) < len(names):
                raise CheckError(
                    "launched nodes with different names",
                    ", ".join(names),
                    f"name=... in {file.name} gives a node another name: leave it out, or give each node its own.",
                )
            judge(nodes)
            _expect_graded(nodes, criterion)

    # The one that names the most of the nodes is the likeliest, and a start takes seconds.
    errors = []
    for file in sorted(files, key=_named_executables, reverse=True):
        try:
            return expect(file)
        except CheckError as error:
            errors.append(error)
    raise errors[0]


def _expect_graded(nodes: WatchedProgram, criterion: str) -> None:
    """Check that the grader has nothing to object to in what was launched."""
    submission, facts = facts_of(own_workspace().path)
    parameters = {name: nodes.domain.parameters(name) for name in nodes.domain.nodes()}
    run = replace(nodes.record.run(), parameters=parameters)
    files = shared_files(own_workspace(), PACKAGE, *LAUNCH_FILES, *YAML_FILES)
    build = Build(True, "", [], [], [], [file.name for file in files], {}, 0.0)
    # That the nodes do their work without a launch file, too, was seen in the exercises before.
    case = case_of([replace(run, setting="together"), run], facts, build, submission)
    for judgement in lost(case, "bonus"):
        if judgement.id == criterion:
            raise CheckError(judgement.title, judgement.reason.rstrip("."), judgement.hint)


def _expect_at_work(nodes: WatchedProgram) -> None:
    """Wait for the first message of each publisher: what dies when it begins to work has then died."""
    logs = [nodes.log(topic, kind) for topic, kind in ((STATUS.topic, STRING), (VELOCITY.topic, TWIST))]
    nodes.wait_until(lambda: all(log.count for log in logs), 2 * STATUS.period)
    for log in logs:
        log.close()
    nodes.expect_alive()


def _named_executables(file: Path) -> int:
    text = file.read_text(encoding="utf-8", errors="replace")
    return sum(name in text for name in tuple(PARTS))


def expect_configured(nodes: WatchedProgram, files: Iterable[Path]) -> None:
    """Check that launched nodes have the period and the speed of the parameter file."""
    status, velocity = nodes.log(STATUS.topic, STRING), nodes.log(VELOCITY.topic, TWIST)
    period = nodes.period(status, LESSON.configured_period)
    if not has_period(period, LESSON.configured_period):
        found = f"one every {period:.2g} s" if period else f"{status.count or 'none'} of them"
        expected = f"a message on {STATUS.topic} every {LESSON.configured_period:g} s, once it is launched"
        raise CheckError(expected, *_why_not_configured(found, LESSON.configured_period, files))
    command(nodes, COMMANDS.commands[0])
    if not nodes.wait_until(
        lambda: bool(
            velocity.latest
            and message_numbers(velocity.latest.message).get("linear.x") == LESSON.configured_speed
        ),
        0.0,
    ):
        found = said_of(message_numbers(velocity.latest.message)) if velocity.latest else "nothing"
        expected = f"linear.x {LESSON.configured_speed:g} on {VELOCITY.topic} after {COMMANDS.commands[0]}, once it is launched"
        raise CheckError(expected, *_why_not_configured(found, LESSON.configured_speed, files))
    if not any(LESSON.configured_speed in _values_in(file) for file in files):
        raise CheckError(
            f"the speed of {LESSON.configured_speed:g} m/s stands in the parameter file",
            f"it is set, but not by {', '.join(file.name for file in files)}",
            "take it out of the launch file, and write it into the parameter file.",
        )


def _why_not_configured(found: str, wanted: float, files: Iterable[Path]) -> tuple[str, str]:
    """Return what was found, with what the files hold, and what to do."""
    for finding in diagnose.of_workspace(own_workspace().path):
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


def expect_noticed(function: str) -> None:
    """Check that the student's tests fail when a function of robot_state is broken as the grader breaks packages."""
    with scratch_folder() as scratch:
        copy = Path(shutil.copytree(package_folder(), scratch / PACKAGE, symlinks=False))
        module = copy / PACKAGE / "robot_state.py"
        sound = module.read_text(encoding="utf-8") if module.is_file() else ""
        for spoil in SPOILERS.values():
            module.write_text(_with_spoilt(sound, function, spoil), encoding="utf-8")
            finished = _run_tests(copy)
            if finished.returncode != 0:
                return
    raise CheckError(
        f"a test that fails when {function} is wrong",
        f"the check broke {function} in {len(SPOILERS)} ways, and pytest still says: {last_line(finished.stdout)}",
        f"call {function} in a test, and compare what it returns by assert ... == ...",
    )


def _with_spoilt(source: str, function: str, spoil: Spoiler) -> str:
    """Return a module in which one of its functions is broken; one that is made in another way does nothing."""
    tree = ast.parse(source)
    own = [node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == function]
    spoil(ast.Module([*own], []), (), {})
    otherwise = "" if own else f"\n\ndef {function}(*_, **__):\n    return None\n"
    return ast.unparse(tree) + otherwise


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


def words_of_tests() -> str:
    """Return what pytest says of the student's own tests that fail."""
    lines = _run_tests(package_folder()).stdout.splitlines()
    failed = [line for line in lines if line.startswith(("FAILED", "ERROR"))]
    return failed[0] if failed else "run `colcon test-result --verbose` to see which"


def changed_since(report: Path) -> Path | None:
    """Return a file of the package's code or tests that is newer than a report of its tests; None if there is none."""
    sources = [file for name in (PACKAGE, "test") for file in (package_folder() / name).rglob("*.py")]
    newer = (file for file in sorted(sources) if file.stat().st_mtime > report.stat().st_mtime)
    return next(newer, None)
