"""The exercises of `07_robot_controller`: the student's nodes are run, and judged by what they do."""

from __future__ import annotations

import ast
import contextlib
import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import yaml
from catkin_pkg.package import InvalidPackage, parse_package

from ros2lab import course, environment, hand_in
from ros2lab.checks import CheckError, Question, exercise, quiz_of
from ros2lab.checks.programs import count_tests, overlay_of
from ros2lab.hand_in import GENERATED_TESTS, LAUNCH_FILES, PACKAGE, YAML_FILES
from ros2lab.node_process import NodeProcess, last_line
from ros2lab.observed_domain import ObservedDomain, has_period, median_gap
from ros2lab.topics import TopicLog
from ros2lab.workspace import Workspace

WORKSPACE = "~/robot_project_ws"
EXECUTABLES = ("status_publisher", "command_subscriber", "velocity_publisher")
STRING, TWIST, LOG = "std_msgs/msg/String", "geometry_msgs/msg/Twist", "rcl_interfaces/msg/Log"
WORDS = {"start": "running", "stop": "stopped", "reset": "idle"}
START_TIMEOUT = 20.0  # s, for a program to import ROS on a busy machine
MOMENT = 0.3  # s, for a message that is on its way
SAID_NOTHING = "it said nothing"
SMALLEST = 1e-300  # what an integer in a float field becomes is smaller

QUIZ = (
    Question(
        "a",
        "Names are all that connects nodes, modules and launch files: two that differ by a letter never meet.",
        {
            "b": "ROS 2 starts a node whatever its class is called.",
            "c": "a name costs nothing; what does another program know of yours?",
        },
    ),
    Question(
        "b",
        "The last state is kept for a node that starts late, or is started again.",
        {
            "a": "how fast a message comes does not depend on it.",
            "c": "look at what happens to a node that starts after the state was published.",
        },
    ),
    Question(
        "c",
        "A callback that sleeps or loops keeps the executor from everything else.",
        {
            "a": "the timer is not the one that sleeps: who calls both callbacks?",
            "b": "a message is kept for a while, but who is to take it?",
        },
    ),
    Question(
        "a",
        "colcon installs what setup.py names, and nothing else.",
        {
            "b": "`source` only sets variables; what puts files into `install/`?",
            "c": "`--symlink-install` links what would be copied, and that is decided elsewhere.",
        },
    ),
)


@exercise
def package() -> str:
    """Check that the workspace holds an ament_python package with the name and the dependencies that were asked for.

    Raises:
        CheckError: if it does not.
    """
    folder = _package_folder()
    shown = course.shown_path(folder)
    if not (folder / "package.xml").is_file():
        raise CheckError(
            f"a package in {shown}",
            "no package.xml there" if folder.is_dir() else "no such folder",
            "packages lie below src/: make them with `ros2 pkg create` while you are in it.",
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
    needed = {one.name for one in [*found.build_depends, *found.exec_depends]}
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
    """Check that the node publishes a String on /robot/status every 2 s.

    Raises:
        CheckError: if it does not.
    """
    with _running("status_publisher", "use_sim_time:=true") as run:
        log = run.hear("/robot/status", STRING)
        period = run.domain.period(log, 2.0)
        run.expect_alive()
    if period is None:  # it follows another clock than ROS's, which cannot be driven
        with _running("status_publisher") as run:
            log = run.hear("/robot/status", STRING)
            period = run.real_period(log, 2.0)
    expected = "a message on /robot/status every 2 s"
    if period is None:
        raise CheckError(
            expected,
            f"{log.count} of them in 10 s",
            "what calls the function that publishes? A timer does so again and again.",
            "create_timer takes the period in seconds, and the function without parentheses.",
        )
    if not has_period(period, 2.0):
        raise CheckError(
            expected, f"one every {period:.2g} s", "the first argument of create_timer is in seconds."
        )
    if not any(sample.message.data.strip() for sample in log.samples()):
        raise CheckError("a text that tells something", "empty texts", "String(data=...) takes the text.")
    return "Right: /robot/status carries a String every 2 s."


@exercise
def command_subscriber() -> str:
    """Check that the node logs each command, publishes the new state, and survives a word that it does not know.

    Raises:
        CheckError: if it does not.
    """
    with _running("command_subscriber") as run:
        run.expect_end("/robot/command", STRING, "subscribes to", run.domain.subscribed)
        logged = run.domain.log("/rosout", LOG)
        state = run.hear("/robot/state", STRING)
        for word in [*WORDS, "start", "dance", "stop"]:
            logged.clear()
            state.clear()
            run.domain.say("/robot/command", word)
            if word in WORDS:
                _expect_logged(run, logged, word)
                _expect_state(run, state, word)
            else:
                _expect_ignored(run, state)
            run.expect_alive(f"after the command {word!r}")
    return "Right: start, stop and reset are heard, logged and answered, and nonsense does no harm."


@exercise
def velocity_publisher() -> str:
    """Check that the node publishes Twists on /cmd_vel that move the robot while it is running, and only then.

    Raises:
        CheckError: if it does not.
    """
    for is_simulated in (True, False):
        with _running("velocity_publisher", f"use_sim_time:={str(is_simulated).lower()}") as run:
            run.tell("running", "start")
            log = run.hear("/cmd_vel", TWIST)
            run.tell("running", "start")
            is_moving = run.advance(lambda: sum(map(_is_moving, _twists(log))) >= 3, is_simulated)  # noqa: B023
            twists = _twists(log)
            run.tell("stopped", "stop")
            log.clear()
            is_standing = is_moving and run.advance(
                lambda: bool(_twists(log)) and not _is_moving(_twists(log)[-1]),  # noqa: B023
                is_simulated,
            )
            run.expect_alive()
            # A node that falls silent when it is told to stop does what it should, too.
            is_standing = is_standing or not _twists(log)
        if is_moving and is_standing:
            return (
                "Right: /cmd_vel carries Twists: the robot drives when it should, and stands when it should."
            )
    if len(twists) < 3:
        raise CheckError(
            "a Twist on /cmd_vel again and again",
            f"{len(twists)} of them in {run.domain.patience:.2g} s",
            "what calls the function that publishes? A timer does so again and again.",
        )
    if not is_moving:
        raise CheckError(
            "a velocity that is not zero while the state is running",
            _velocity(twists[-1]),
            "the node was told `running` on /robot/state: does it listen there?",
            "print the state in your function with get_logger().info, and run the check again.",
        )
    raise CheckError(
        "zero after the state `stopped`",
        _velocity(_twists(log)[-1]),
        "a robot that does not stop is dangerous: what does your function give for another state than running?",
    )


@exercise
def executables() -> str:
    """Check that the built package has three executables, and that each of them starts a node.

    Raises:
        CheckError: if it has not, or one does not start.
    """
    workspace = Workspace(course.student_path(WORKSPACE))
    overlay = overlay_of(workspace)
    paths = {one.name: one.path for one in workspace.executables(PACKAGE)}
    missing = [name for name in EXECUTABLES if name not in paths]
    if missing:
        raise CheckError(
            f"the executables {', '.join(EXECUTABLES)} in install/",
            f"{', '.join(sorted(paths)) or 'none'}",
            "an entry point in setup.py makes one; then build again.",
            "three lines in console_scripts, each with a comma at its end: name = package.module:function",
        )
    with ObservedDomain() as domain:
        programs = {name: domain.start(name, [str(paths[name])], overlay) for name in EXECUTABLES}
        domain.wait(
            lambda: len(domain.nodes()) >= 3 or not all(one.is_running for one in programs.values()),
            START_TIMEOUT,
        )
        for name, program in programs.items():
            if not program.is_running:
                said = last_line(program.output)
                raise CheckError(f"{name} runs until Ctrl-C", said or SAID_NOTHING, _hint_for(said))
        count = len(domain.nodes())
        if count < 3:
            raise CheckError(
                "three nodes", f"{count}: {', '.join(domain.nodes())}", "each needs a name of its own."
            )
    return "Right: three executables, three nodes."


@exercise
def on_the_air() -> str:
    """Check that three nodes publish and listen at this moment, in the domain of this notebook.

    Raises:
        CheckError: if they do not.
    """
    with _own_domain() as domain:
        wanted: dict[str, tuple[str, Callable[[], dict[str, list[str]]]]] = {
            "/robot/status": (STRING, domain.published),
            "/robot/command": (STRING, domain.subscribed),
            "/cmd_vel": (TWIST, domain.published),
        }
        domain.wait(lambda: all(kind in ends().get(topic, []) for topic, (kind, ends) in wanted.items()), 5.0)
        for topic, (kind, ends) in wanted.items():
            if kind not in ends().get(topic, []):
                raise CheckError(
                    f"a running node with {topic} [{kind}]",
                    f"the nodes {', '.join(domain.nodes()) or 'none'}",
                    "three terminals, one node in each: are all of the three background cells running?",
                    "read what a terminal has printed: terminal('status').read()",
                )
    return "Right: all three are on the air."


@exercise
def drives() -> str:
    """Check that the robot moves at this moment, in the domain of this notebook.

    Raises:
        CheckError: if it does not.
    """
    with _own_domain() as domain:
        domain.wait(lambda: "/cmd_vel" in domain.published(), 5.0)
        log = domain.log("/cmd_vel", TWIST)
        if not domain.wait(lambda: any(map(_is_moving, _twists(log)))):
            twists = _twists(log)
            raise CheckError(
                "a velocity on /cmd_vel that is not zero",
                _velocity(twists[-1]) if twists else "nothing on /cmd_vel",
                "the word is `start`, and the topic /robot/command.",
                'publish once: ros2 topic pub --once /robot/command std_msgs/msg/String "{data: start}"',
            )
    return "Right: the robot drives."


@exercise
def parameters() -> str:
    """Check that each of the two publishers has a parameter that changes its period.

    Raises:
        CheckError: if one has not.
    """
    for module, topic, kind, period in (
        ("status_publisher", "/robot/status", STRING, 2.0),
        ("velocity_publisher", "/cmd_vel", TWIST, 0.1),
    ):
        with _running(module) as run:
            run.expect_end(topic, kind, "publishes", run.domain.published)
            run.domain.wait(run.domain.nodes)
            values = {k: v for name in run.domain.nodes() for k, v in run.domain.parameters(name).items()}
        numbers = {
            name: value // 2 if isinstance(value, int) else value / 2
            for name, value in values.items()
            if isinstance(value, (int, float)) and not isinstance(value, bool) and value > 0
        }
        # Half the value is half the period, or twice as long if it is a rate.
        if not any(
            _has_period(module, topic, kind, f"{name}:={half}", period)
            for name, half in numbers.items()
            if half
        ):
            raise CheckError(
                f"a parameter of {module} for the time between its messages",
                f"these numbers among its parameters: {', '.join(numbers) or 'none'}; none changes the period",
                "declare_parameter gives it a name and a default; its value goes into create_timer.",
                'self.declare_parameter("period", 2.0).value is the value.',
            )
    return "Right: both periods can be set from outside."


@exercise
def launch_file() -> str:
    """Check that an installed launch file starts the three nodes.

    Raises:
        CheckError: if there is none, or it does not.
    """
    _expect_launched()
    return "Right: one command starts all three."


@exercise
def configuration() -> str:
    """Check that the launched nodes have the values of an installed parameter file.

    Raises:
        CheckError: if there is no such file, or they have other values.
    """
    values = _parameter_files()
    _expect_launched(lambda run: _expect_one(lambda file: _expect_values(run, file, values[file]), values))
    return "Right: what the file says holds for the nodes."


@exercise
def unit_tests() -> str:
    """Check that colcon has run at least one test of the student's since the tests were changed, and none failed.

    Raises:
        CheckError: if not.
    """
    report = course.student_path(WORKSPACE) / "build" / PACKAGE / "pytest.xml"
    expected = "a run of `colcon test` with at least one test that passed, and none that failed"
    tests = count_tests(report, except_of=GENERATED_TESTS)
    if tests is None:
        raise CheckError(
            expected,
            "no report in build/ that can be read",
            f"type `cd {WORKSPACE}`, `colcon build`, `colcon test`.",
        )
    if tests["failed"]:
        raise CheckError(
            expected,
            f"{tests['failed']} of {tests.total()} failed",
            "which, and why? `colcon test-result --verbose` shows it.",
        )
    if not tests["passed"]:
        raise CheckError(
            expected,
            "no test of yours that was run",
            "a file test/test_...py with functions test_...(): pytest finds no others.",
        )
    files = (_package_folder() / "test").rglob("*.py")
    if any(file.stat().st_mtime > report.stat().st_mtime for file in files):
        raise CheckError(expected, "tests that were changed since", "run `colcon test` again.")
    return "Right: your tests pass."


quiz = quiz_of(__name__, QUIZ)


class _Run:
    """A program of the student's in a domain, which starts so many nodes, and what is expected of it."""

    def __init__(self, domain: ObservedDomain, program: NodeProcess, nodes: int = 1) -> None:
        self.domain = domain
        self.program = program
        self._nodes = nodes
        self._simulated = 0.0

    def expect_alive(self, when: str = "") -> None:
        if not self.program.is_running:
            said = last_line(self.program.output)
            raise CheckError(
                f"{self.program.executable} runs until Ctrl-C",
                f"it ended {when}: {said or SAID_NOTHING}".replace(" :", ":"),
                _hint_for(said),
            )

    def expect_end(
        self, topic: str, type_name: str, verb: str, ends: Callable[[], dict[str, list[str]]]
    ) -> None:
        """Wait until the program has a topic of this type."""
        seen: dict[str, list[str]] = {}  # also what has gone, with a node that died meanwhile

        def is_over() -> bool:
            seen.update(ends())
            return topic in seen or not self.program.is_running

        self.domain.wait_for_start(
            lambda: is_over() or len(self.domain.nodes()) >= self._nodes, START_TIMEOUT
        )
        # A node that answers has been made as far as it will be; another one may be slow, or never spin.
        if not self.domain.wait(is_over) and not self.domain.all_answer():
            self.domain.wait(is_over, START_TIMEOUT)
        self.expect_alive()
        if topic not in seen:
            raise CheckError(
                f"{self.program.executable} {verb} {topic}",
                f"it {verb} {', '.join(seen) or 'no topic'}",
                "compare the topic letter by letter, the slash at its beginning too."
                if seen
                else "which method of Node makes it? Week 2's first node has an example.",
            )
        if type_name not in seen[topic]:
            raise CheckError(
                f"{topic} has the type {type_name}",
                ", ".join(seen[topic]),
                "it is the first argument, a class that is imported from a package ending in .msg.",
            )

    def tell(self, state: str, command: str) -> None:
        """Tell the program a state and a command, to whichever it listens; the last ones are kept for it."""
        if self.domain.nodes():
            self.domain.all_answer()  # then all that it listens to is known
        self.domain.say("/robot/state", state)
        self.domain.say("/robot/command", command)

    def hear(self, topic: str, type_name: str) -> TopicLog:
        self.expect_end(topic, type_name, "publishes", self.domain.published)
        return self.domain.log(topic, type_name)

    def real_period(self, log: TopicLog, expected: float) -> float | None:
        """Return the median time between messages in s, over at most five periods; None if fewer than two came."""
        self.domain.wait(lambda: log.count >= 3 or not self.program.is_running, 5 * expected)
        self.expect_alive()
        return median_gap([sample.time for sample in log.samples()])

    def advance(self, condition: Callable[[], bool], is_simulated: bool) -> bool:
        """Let time pass until the condition holds: 0.1 s by 0.1 s on the simulated clock, or really."""
        if not is_simulated:
            return self.domain.wait(lambda: condition() or not self.program.is_running) and condition()
        for _ in range(30):
            self._simulated += 0.1
            if not self.domain.step_clock(self._simulated):
                return False
            if condition():
                return True
        return False


@contextlib.contextmanager
def _running(module: str, *parameters: str) -> Iterator[_Run]:
    """Run a module of the student's from its source, in a process and a domain of its own."""
    _check_source(_package_folder() / PACKAGE / f"{module}.py")
    code = f"from {PACKAGE}.{module} import main; main()"
    settings = [word for parameter in parameters for word in ("-p", parameter)]
    environ = environment.lab_environment()
    paths = [str(_package_folder()), *environ.get("PYTHONPATH", "").split(os.pathsep)]
    environ |= {"PYTHONPATH": os.pathsep.join(filter(None, paths)), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-c", code, *(["--ros-args", *settings] if settings else [])]
    with ObservedDomain() as domain:
        yield _Run(domain, domain.start(module, command, environ))


def _expect_launched(judge: Callable[[_Run], None] = lambda _: None) -> None:
    """Check that one of the installed launch files starts the three nodes, and that they are as `judge` wants them."""
    files = _installed(LAUNCH_FILES, "a launch file, such as launch/robot.launch.py")
    overlay = overlay_of(Workspace(course.student_path(WORKSPACE)))

    def expect(file: Path) -> None:
        with ObservedDomain() as domain:
            program = domain.start(file.name, ["ros2", "launch", str(file)], overlay)
            run = _Run(domain, program, nodes=len(EXECUTABLES))
            run.expect_end("/robot/status", STRING, "publishes", domain.published)
            run.expect_end("/cmd_vel", TWIST, "publishes", domain.published)
            run.expect_end("/robot/command", STRING, "subscribes to", domain.subscribed)
            judge(run)

    # The one that names the most of the nodes is the likeliest, and a start takes seconds.
    _expect_one(expect, sorted(files, key=_named_executables, reverse=True))


def _named_executables(file: Path) -> int:
    text = file.read_text(encoding="utf-8", errors="replace")
    return sum(name in text for name in EXECUTABLES)


def _expect_one(expect: Callable[[Path], None], files: Iterable[Path]) -> None:
    """Check that one of the files is as expected; CheckError with what is wrong with the first one."""
    errors = []
    for file in files:
        try:
            expect(file)
        except CheckError as error:
            errors.append(error)
        else:
            return
    raise errors[0]


@contextlib.contextmanager
def _own_domain() -> Iterator[ObservedDomain]:
    """Observe the domain in which the notebook's terminals are."""
    environment.apply()
    with ObservedDomain(int(os.environ.get("ROS_DOMAIN_ID") or 0)) as domain:
        yield domain


def _package_folder() -> Path:
    return course.student_path(WORKSPACE) / "src" / PACKAGE


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
    for part in ast.walk(node):
        if isinstance(part, (ast.FunctionDef, ast.ClassDef)):
            yield part.name
        elif isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store):
            yield part.id
        elif isinstance(part, ast.alias):
            yield part.asname or part.name


def _installed(patterns: Iterable[str], what: str) -> list[Path]:
    """Return the package's installed files of this kind, at least one."""
    workspace = Workspace(course.student_path(WORKSPACE))
    files = hand_in.shared_files(workspace, PACKAGE, *patterns)
    if files:
        return files
    sources = sorted(file for pattern in patterns for file in _package_folder().rglob(pattern))
    raise CheckError(
        f"{what}, installed in share/{PACKAGE}",
        f"only {sources[0].relative_to(_package_folder())} in src/" if sources else "none",
        "data_files in setup.py names what is installed; then build again."
        if sources
        else "make the file first.",
        f"a line of data_files is a pair: (folder below install, list of files), such as ('share/{PACKAGE}/launch', [...]).",
    )


def _parameter_files() -> dict[Path, list[_Setting]]:
    """Return what is set in each installed parameter file, at least one; other YAML files are left out."""
    found: dict[Path, list[_Setting]] = {}
    errors = []
    for file in _installed(YAML_FILES, "a parameter file, such as config/robot.yaml"):
        try:
            found[file] = _settings_in(file)
        except CheckError as error:
            errors.append(error)
    if not found:
        raise errors[0]
    return found


class _Setting(NamedTuple):
    """A line of a parameter file.

    Args:
        nodes: the full name of the node, in which `/*` is any one name and `/**` any number of them.
        parameter: its name, with dots where it is nested.
        value: as YAML has it.
    """

    nodes: str
    parameter: str
    value: Any

    def is_for(self, node: str) -> bool:
        """Tell whether it is for the node of this full name."""
        pattern = re.escape(self.nodes).replace(r"/\*\*", r"(/\w+)*").replace(r"/\*", r"/\w+")
        return re.fullmatch(pattern, node) is not None


def _settings_in(file: Path) -> list[_Setting]:
    """Return what a parameter file sets."""
    expected = f"{file.name} with node, ros__parameters, and names with values below each other"
    try:
        content = yaml.safe_load(file.read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise CheckError(
            expected, " ".join(str(error).split()), "blanks, not tabs, and the same number of them."
        ) from None
    found = [
        _Setting(node, parameter, value)
        for node, parameters in _by_node(content)
        for parameter, value in _flat(parameters)
    ]
    if not found:
        raise CheckError(
            expected,
            repr(content),
            "ros__parameters has two underlines in its middle, and is indented below the node.",
        )
    return found


def _by_node(content: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the full name of each node, which may be nested below its namespaces, and its parameters."""
    for key, below in content.items() if isinstance(content, dict) else ():
        if key == "ros__parameters" and name:
            yield name, below
        else:
            yield from _by_node(below, f"{name}/{str(key).strip('/')}")


def _flat(parameters: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield names and values; `a: {b: 1}` is a.b."""
    for key, value in parameters.items() if isinstance(parameters, dict) else ():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _expect_values(run: _Run, file: Path, settings: list[_Setting]) -> None:
    """Check that the nodes that run have the values of a parameter file."""
    run.domain.wait(lambda: len(run.domain.nodes()) >= len(EXECUTABLES))
    nodes = {node: run.domain.parameters(node) for node in run.domain.nodes()}
    for setting in settings:
        own = {node: values for node, values in nodes.items() if setting.is_for(node)}
        if not own:
            raise CheckError(
                f"{file.name} names running nodes",
                f"{setting.nodes}, where {', '.join(nodes)} run",
                "the first word is the node's name, as `ros2 node list` shows it.",
            )
        name = setting.parameter
        held = {node: values[name] for node, values in own.items() if name in values}
        # What is set for all nodes may be set for one of them again.
        wrong = [
            value
            for node, value in held.items()
            if not any(
                one.parameter == name and one.is_for(node) and _is_same(value, one.value) for one in settings
            )
        ]
        if wrong or not held:
            raise CheckError(
                f"{name} of {setting.nodes} is {setting.value}, as in {file.name}",
                str(wrong[0]) if wrong else "no such parameter",
                "a launch file hands the file on with parameters=[...].",
                "was it built again after the file was changed?",
            )


def _is_same(found: Any, value: Any) -> bool:
    """Tell whether a parameter has the value of a YAML file, a whole number being no float."""
    if isinstance(found, list) and isinstance(value, list):
        return len(found) == len(value) and all(map(_is_same, found, value))
    if isinstance(found, float) and isinstance(value, str):  # 1e-3, which only ROS takes for a number
        with contextlib.suppress(ValueError):
            return found == float(value)
    return type(found) is type(value) and bool(found == value)


def _has_period(module: str, topic: str, kind: str, parameter: str, default: float) -> bool:
    """Tell whether a node with this parameter has half or twice its default period (s)."""
    for is_simulated in (True, False):
        with _running(module, f"use_sim_time:={str(is_simulated).lower()}", parameter) as run:
            run.tell("running", "start")
            try:
                log = run.hear(topic, kind)
                run.tell("running", "start")
                period = run.domain.period(log, default) if is_simulated else run.real_period(log, default)
            except CheckError:  # a value that the node refuses
                return False
        if period is not None:
            return any(has_period(period, wanted) for wanted in (default / 2, 2 * default))
    return False


def _expect_logged(run: _Run, logged: TopicLog, word: str) -> None:
    def lines() -> list[str]:
        return [sample.message.msg for sample in logged.samples()]

    if run.domain.wait(lambda: any(word in line.lower() for line in lines()) or not run.program.is_running):
        run.expect_alive(f"after the command {word!r}")
        return
    is_printed = word in run.program.output.lower()
    raise CheckError(
        f"a log line that tells of the command {word!r}",
        "it is printed, but not logged" if is_printed else repr(lines()[-1]) if lines() else "no log line",
        "self.get_logger().info(...) writes a log line."
        if is_printed
        else "the text of the message is in its field data.",
    )


def _expect_state(run: _Run, state: TopicLog, word: str) -> None:
    if run.domain.wait(lambda: any(s.message.data == WORDS[word] for s in state.samples())):
        return
    found = ", ".join(repr(sample.message.data) for sample in state.samples()[-3:])
    raise CheckError(
        f"{WORDS[word]!r} on /robot/state after {word!r}",
        found or "nothing",
        "state_after() gives the word; publish it as String(data=...).",
    )


def _expect_ignored(run: _Run, state: TopicLog) -> None:
    """Wait until the program has had a word that is no command; the robot is running, and must stay so."""
    if not run.domain.all_answer():
        run.domain.wait(lambda: not run.program.is_running)

    def others() -> list[str]:
        return [sample.message.data for sample in state.samples() if sample.message.data != "running"]

    if run.domain.wait(others, MOMENT):
        raise CheckError(
            "the state stays as it is at a word that is no command",
            f"{others()[0]!r} on /robot/state",
            "state_after() tells whether a word is a command.",
        )


def _twists(log: TopicLog) -> list[Any]:
    return [sample.message for sample in log.samples()]


def _is_moving(twist: Any) -> bool:
    parts = (getattr(half, axis) for half in (twist.linear, twist.angular) for axis in "xyz")
    return any(abs(part) > SMALLEST for part in parts)


def _velocity(twist: Any) -> str:
    return f"{twist.linear.x:g} m/s forward, {twist.angular.z:g} rad/s to the left"


def _hint_for(said: str) -> str:
    if not said or said.startswith("["):
        return (
            "a node lives as long as something spins it: is there a spin in main, and is main not left early?"
        )
    return "that is the last line of its traceback: it names the error."
