"""The exercises of `07_robot_controller`: the student's nodes are run, and judged by what they do."""

from __future__ import annotations

from collections.abc import Callable

from catkin_pkg.package import InvalidPackage, parse_package

from ros2lab import course, hand_in
from ros2lab.checks import CheckError, exercise, predict_of, questions_of, quiz_of
from ros2lab.checks.programs import count_tests, overlay_of
from ros2lab.checks.project import (
    COMMANDS,
    LESSON,
    LOG,
    PARTS,
    STATUS,
    TWIST,
    VELOCITY,
    WORKSPACE,
    entry_points,
    expect_fresh,
    expect_nothing_lost,
    idle_terminal,
    installed,
    judge_node,
    judge_part,
    messages_of,
    own_domain,
    own_workspace,
    package_folder,
    running_node,
    wait_for_terminals,
)
from ros2lab.checks.project_commands import expect_obedience, expect_warnings
from ros2lab.checks.project_extras import (
    changed_since,
    expect_configured,
    expect_default_period,
    expect_launched,
    expect_noticed,
    expect_parameters,
    words_of_tests,
)
from ros2lab.checks.project_nodes import expect_status, expect_task, expect_velocity
from ros2lab.checks.watched_program import (
    STRING,
    WatchedProgram,
    message_numbers,
)
from ros2lab.hand_in import GENERATED_TESTS, PACKAGE, YAML_FILES
from ros2lab.judge import case_of, facts_of, lost
from ros2lab.manifest_words import NOT_TAKEN, fault_of
from ros2lab.observed_domain import ObservedDomain
from ros2lab.package_faults import text_of
from ros2lab.practices import CAUGHT, places_of_practices

MANIFEST = ("package.manifest", "package.dependencies")  # what the grader asks of package.xml


@exercise
def package() -> str:
    """Check that the workspace holds an ament_python package with the name and the dependencies that were asked for.

    Raises:
        CheckError: if it does not.
    """
    folder = package_folder()
    shown = course.shown_path(folder)
    if not (folder / "package.xml").is_file():
        elsewhere = [
            file.parent
            for depth in ("*", "*/*", "*/*/*")
            for file in own_workspace().path.glob(f"{depth}/package.xml")
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
    except (InvalidPackage, *NOT_TAKEN) as error:
        reason = fault_of(error, text_of(folder / "package.xml"))
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
    wanted = hand_in.ASSIGNMENT.dependencies
    missing = [name for name in wanted if name not in needed]
    if missing:
        raise CheckError(
            f"dependencies on {', '.join(wanted)}",
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
    submission, facts = facts_of(own_workspace().path)
    for judgement in lost(case_of([], facts, submission=submission), "package"):
        if judgement.id in MANIFEST:
            raise CheckError(judgement.title, judgement.reason.rstrip("."), judgement.hint)
    return "Right: your package has its name, its type and its dependencies."


@exercise
def status_publisher() -> str:
    """Check that the node publishes the state it is told, as a String and as often as the assignment says.

    Raises:
        CheckError: if it does not.
    """
    judge_part(STATUS, expect_status)
    return f"Right: {STATUS.topic} carries the present state as a String, every {STATUS.period:g} s."


@exercise
def command_subscriber() -> str:
    """Check that the node logs each command, publishes the new state, and survives a word that it does not know.

    Raises:
        CheckError: if it does not.
    """
    with running_node(COMMANDS.name) as node:
        expect_obedience(node)
        expect_nothing_lost(node, COMMANDS)
    return f"Right: {', '.join(COMMANDS.commands[:-1])} and {COMMANDS.commands[-1]} are received, logged and answered, and nonsense does no harm."


@exercise
def velocity_publisher() -> str:
    """Check that the node publishes a Twist in its rhythm, which moves the robot only while it is running.

    Raises:
        CheckError: if it does not.
    """
    judge_part(VELOCITY, expect_velocity)
    return f"Right: {VELOCITY.topic} carries a Twist every {LESSON.velocity_period:g} s: the robot drives when it should, and stands when it should."


@exercise
def executables() -> str:
    """Check that the built package has three executables, and that each of them starts its node.

    Raises:
        CheckError: if it has not, or one does not start, or starts another node.
    """
    workspace = own_workspace()
    overlay = overlay_of(workspace)
    expect_fresh()
    # A script of an earlier build stays in install/; it counts only if there is an entry point for it.
    named = entry_points(workspace)
    paths = {script.name: script.path for script in workspace.executables(PACKAGE) if script.name in named}
    missing = [name for name in PARTS if name not in paths]
    if missing:
        raise CheckError(
            f"the executables {', '.join(PARTS)} in install/",
            f"{', '.join(sorted(paths)) or 'none'}",
            f"setup.py has no entry point named {missing[0]}: write it, and build again.",
            "three lines in console_scripts, each with a comma at its end: name = package.module:function",
        )
    with ObservedDomain() as domain:
        for count, part in enumerate(PARTS.values(), 1):
            process = domain.start(part.name, [str(paths[part.name])], overlay)
            expect_task(WatchedProgram(domain, process, workspace.path, nodes=count), part)
        domain.wait(lambda: len(domain.nodes()) >= len(PARTS))
        if len(set(domain.nodes())) < len(PARTS):
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
    with own_domain() as domain:
        wanted: dict[str, tuple[str, str, Callable[[], dict[str, list[str]]]]] = {
            STATUS.topic: ("published", STRING, domain.published),
            COMMANDS.topic: ("subscribed to", STRING, domain.subscribed),
            VELOCITY.topic: ("published", TWIST, domain.published),
        }
        wait_for_terminals(domain)
        domain.wait(lambda: all(kind in ends().get(topic, []) for topic, (_, kind, ends) in wanted.items()))
        for topic, (verb, kind, ends) in wanted.items():
            if kind not in ends().get(topic, []):
                terminal, words = idle_terminal()
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
    with own_domain() as domain:
        wait_for_terminals(domain)
        domain.wait(
            lambda: VELOCITY.topic in domain.published() and domain.node.count_publishers("/rosout") > 1
        )
        log, lines = domain.log(VELOCITY.topic, TWIST), domain.log("/rosout", LOG)
        if domain.wait(lambda: any(map(message_numbers, messages_of(log)))):
            return "Right: the robot drives."
        if not log.count:
            raise CheckError(
                f"a velocity on {VELOCITY.topic} that is not zero",
                f"nothing on {VELOCITY.topic}; the nodes that run are {', '.join(domain.nodes()) or 'none'}",
                f"{VELOCITY.name} must run: run its background cell.",
            )
        if COMMANDS.topic not in domain.subscribed():
            raise CheckError(
                f"a node that subscribes to {COMMANDS.topic}",
                f"the nodes that run are {', '.join(domain.nodes())}",
                f"{COMMANDS.name} must run: run its background cell, and then give the command again.",
            )
        received = [
            m.msg
            for m in messages_of(lines)
            if any(word in m.msg.lower() for word in ("received", "command"))
        ]
        word = COMMANDS.commands[0]
        raise CheckError(
            f"a velocity on {VELOCITY.topic} that is not zero",
            f"0 m/s; the newest log line about a command is {received[-1]!r}"
            if received
            else "0 m/s, and no log line about a command in the last seconds",
            f"a command has arrived, but not {word}: publish the word {word}."
            if received
            else f"publish the word {word} on the topic {COMMANDS.topic}, with the type {STRING}.",
            f'publish once: ros2 topic pub --once {COMMANDS.topic} {STRING} "{{data: {word}}}"',
        )


@exercise
def parameters() -> str:
    """Check that each of the two publishers has a parameter for its period, and one of them another for its speed.

    Raises:
        CheckError: if one has not, or a default is not the value from before.
    """
    judge_node(STATUS.name, lambda node: expect_parameters(node, STATUS.topic, STRING, STATUS.period))
    judge_node(
        VELOCITY.name,
        lambda node: expect_parameters(node, VELOCITY.topic, TWIST, LESSON.velocity_period),
    )
    return "Right: both periods can be set from outside, and the speed while the robot drives."


@exercise
def launch_file() -> str:
    """Check that an installed launch file starts the three nodes, and that they keep running.

    Raises:
        CheckError: if there is none, or it does not.
    """
    expect_launched("bonus.launch")
    return "Right: one command starts all three."


@exercise
def configuration() -> str:
    """Check that the launched nodes publish every second and drive at 0.4 m/s, by an installed parameter file.

    Raises:
        CheckError: if there is no such file, or they do not.
    """
    files = installed(YAML_FILES, "a parameter file, such as config/robot.yaml")
    expect_launched("bonus.parameter_file", lambda nodes: expect_configured(nodes, files))
    return "Right: what the file says holds for the nodes."


@exercise
def unit_tests() -> str:
    """Check that colcon has run the student's tests since they were changed, that they pass, and that they can fail.

    Raises:
        CheckError: if not.
    """
    report = own_workspace().path / "build" / PACKAGE / "pytest.xml"
    expected = "a run of `colcon test` with at least one test of yours that passed, and none that failed"
    tests = count_tests(report, except_of=GENERATED_TESTS)
    if tests is None:
        raise CheckError(
            expected,
            "no report in build/ that can be read",
            f"type `cd {WORKSPACE}`, `colcon build`, `colcon test`.",
        )
    changed = changed_since(report)
    if changed:
        raise CheckError(
            expected,
            f"{course.shown_path(changed)} was changed after the last run",
            "run `colcon test` again.",
        )
    if tests["failed"]:
        raise CheckError(
            expected,
            f"{tests['failed']} of {tests.total()} failed: {words_of_tests()}",
            "compare what the test expects with what the function returns; `colcon test-result --verbose` shows both.",
        )
    if not tests["passed"]:
        raise CheckError(
            expected,
            "no test of yours that was run",
            "a file test/test_...py with functions test_...(): pytest finds no others.",
        )
    for function in LESSON.functions:
        expect_noticed(function)
    return "Right: your tests pass, and they fail when the code is wrong."


@exercise
def error_handling() -> str:
    """Check that a wrong command and a wrong period are warned about, and that nothing else is caught.

    Raises:
        CheckError: if not.
    """
    caught = places_of_practices(own_workspace()).get(CAUGHT, [])
    too_wide = [place for place in caught if place]
    if too_wide:
        raise CheckError(
            "each except names the error that it expects",
            f"{too_wide[0]} catches every error",
            "a mistake of your own would be hidden there too: write except ValueError.",
        )
    with running_node(COMMANDS.name) as node:
        expect_warnings(node)
    for period in LESSON.refused_periods:
        judge_node(STATUS.name, expect_default_period, f"period:={period}")
    return "Right: wrong commands and wrong values are told, and the nodes go on."


QUIZ, PREDICTIONS = questions_of(__name__)
quiz = quiz_of(__name__, QUIZ)
predict = predict_of(__name__, PREDICTIONS)
