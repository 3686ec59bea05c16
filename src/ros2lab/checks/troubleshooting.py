"""The exercises of `09_troubleshooting`, and the robots that come to its clinic."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ros2lab import course
from ros2lab.checks import CheckError, Question, exercise, graded, predict_of, questions_of, quiz_of
from ros2lab.checks.patients import HEALTHY, ILL, PATIENTS, ROBOT, Change
from ros2lab.clean_build import built_from_nothing, in_place
from ros2lab.diagnose import of_text, of_workspace
from ros2lab.diagnose.explaining.steps import go_step_by_step
from ros2lab.diagnose.finding import UNKNOWN
from ros2lab.diagnose.printed.error_text import read_error
from ros2lab.node_process import NodeProcess, last_line
from ros2lab.observed_domain import ObservedDomain
from ros2lab.workspace import Workspace

CLINIC, WARD = "~/clinic_ws", "~/ward_ws"
TWIST = "geometry_msgs/msg/Twist"
START_TIMEOUT = 30.0  # s, for a program to import ROS and speak on a busy machine
PATIENCE = 5.0  # s, for the messages of a publisher that is there
STOP_TIMEOUT = 2.0  # s
SAID_NOTHING = "it ended, and said nothing"


SILENT, SILENT_CAUSE = "jackdaw", "c"

# Of each error, the cause and the line of driver.py to which the traceback leads.
CAUSES = (
    (
        Question(
            "What is the cause of error 1, of the lark?",
            (
                "`drive` has no argument `self`",
                "there is a dot where a comma should be",
                "the period must be a whole number",
            ),
            "b",
            "`0.1.self` asks the number 0.1 for something named self: the dot should be a comma.",
            {
                "a": "the last line speaks of a float; which float is in your line?",
                "c": "a period of 0.1 s is right. Read your line character by character.",
            },
        ),
        12,
    ),
    (
        Question(
            "What is the cause of error 2, of the tern?",
            (
                "the topic has the wrong type",
                "the parameter `speed` should not be a `float`",
                "a number was published instead of a message",
            ),
            "c",
            "publish takes a message, and was given the number.",
            {
                "a": "the last line says what publish expected, and that type is the right one.",
                "b": "a float is what a speed should be; but is it what publish should get?",
            },
        ),
        17,
    ),
    (
        Question(
            "What is the cause of error 3, of the swift?",
            (
                "the value was given as a whole number",
                "the parameter was never declared",
                "the line in `driver.py` is wrong",
            ),
            "a",
            "2 is a whole number, and the parameter was declared with 0.5; write 2.0.",
            {
                "b": "the line of yours in the traceback is the one that declares it.",
                "c": "your line is right. Who gave the value?",
            },
        ),
        9,
    ),
)

WRONG_CAUSES = {
    "a": "compare the topics of both in `ros2 topic list`: how many are there?",
    "b": "`ros2 topic info /cmd_vel` names the type; is there more than one?",
    "d": "look at how fast its log lines come, and at those of the other one.",
}


@exercise
def causes(*answers: Sequence[Any]) -> str:
    """Check the cause and the place of each of the three errors that are read alone.

    Args:
        answers: of each error the letter of its cause, and the number of the line of driver.py where it was raised.

    Raises:
        CheckError: at the first that is not right.
    """
    pairs = [tuple(answer) for answer in answers if isinstance(answer, (tuple, list))]
    if len(pairs) != len(CAUSES) or len(answers) != len(CAUSES) or any(len(pair) != 2 for pair in pairs):
        raise CheckError(
            f"{len(CAUSES)} pairs of a letter and a line",
            ", ".join(map(repr, answers)) or "nothing",
            'put each pair in parentheses, such as check.causes(("a", 1), ("a", 1), ("a", 1)).',
        )
    for number, ((_, line), (_, right)) in enumerate(zip(pairs, CAUSES, strict=True), 1):
        if str(line).strip() != str(right):
            raise CheckError(
                f"the line of driver.py where error {number} was raised",
                repr(line),
                "of the lines that name driver.py, the last one is where it happened; the others led there.",
            )
    return graded([question for question, _ in CAUSES], [letter for letter, _ in pairs])


@exercise
def owl() -> str:
    """Check that `owl` can be built, and drives.

    Raises:
        CheckError: if it does not.
    """
    with _built(
        "owl", "type `python3 setup.py --name` in src/owl: it shows the first fault without colcon."
    ) as workspace:
        _check_drives(workspace, "owl")
    return "Right: the owl is built, and it drives."


@exercise
def kite() -> str:
    """Check that `kite` runs, and drives.

    Raises:
        CheckError: if it does not.
    """
    with _built("kite", "build it in a terminal, and read the first error.") as workspace:
        _check_drives(workspace, "kite")
    return "Right: the kite's timer calls again and again, and it drives."


@exercise
def crow() -> str:
    """Check that the launch file of `crow` starts it, with the speed of its parameter file.

    Raises:
        CheckError: if it does not.
    """
    expected = "`ros2 launch crow crow.launch.py` lets it drive at 0.8 m/s"
    with _built("crow", "build it in a terminal, and read the first error.") as workspace:
        program, speeds, topics = _watched(workspace, "crow", "ros2", "launch", "crow", "crow.launch.py")
    if not speeds:
        _refuse(
            expected,
            _silence(program, topics),
            "crow",
            program.output,
            "launch it in a terminal, and read the first line that is an error.",
        )
    if speeds[-1] != 0.8:
        _refuse(
            expected,
            f"it drives at {speeds[-1]:g} m/s",
            "crow",
            "",
            "0.8 is in config/speed.yaml: what in it, or in the launch file, decides which node gets it?",
        )
    return "Right: the crow's launch file is found, and so are its parameters."


@exercise
def silent_one(*answer: str) -> str:
    """Check which of the two robots that look alike the watcher does not hear, and why.

    Args:
        answer: the package's name and the letter of the cause.

    Raises:
        CheckError: if one of them is not right.
    """
    words = [str(word).strip().lower() for word in answer]
    if len(words) != 2:
        raise CheckError(
            "a package and a letter",
            f"{len(words)} answers",
            'name both, such as check.silent_one("magpie", "a").',
        )
    package, letter = words
    if package != SILENT:
        raise CheckError(
            "the robot that the watcher does not hear",
            repr(package),
            "start the watcher of patrol and one of them alone: does the watcher end?",
            "stop it, start the other one, and ask the same.",
        )
    if letter != SILENT_CAUSE:
        hint = WRONG_CAUSES.get(letter, "the letters are a, b, c, d.")
        raise CheckError(f"why {package} is not heard", repr(letter), hint)
    return "Right: it offers best effort, the watcher asks for reliable, and so they never meet."


QUIZ, PREDICTIONS = questions_of(__name__)
quiz = quiz_of(__name__, QUIZ)
predict = predict_of(__name__, PREDICTIONS)


def make_healthy_robot() -> str:
    """Make the workspace of the clinic with the package `patrol` in it.

    In the clinic and the ward, `ros2lab diagnose` says the cause first, and more when it is asked.

    Raises:
        OSError: if a file cannot be written.
    """
    return _admitted(CLINIC, {HEALTHY: ()})


def admit(*names: str) -> str:
    """Make copies of the healthy package in the clinic's workspace; those named in `ILL` have a fault.

    Raises:
        OSError: if a file cannot be written.
    """
    return _admitted(CLINIC, {name: ILL.get(name, ()) for name in names})


def make_patients() -> str:
    """Make the workspace of the exercises; a package that is there already stays as it is.

    Raises:
        OSError: if a file cannot be written.
    """
    return _admitted(WARD, PATIENTS)


def _admitted(workspace: str, robots: Mapping[str, Sequence[Change]]) -> str:
    src = course.student_path(workspace) / "src"
    go_step_by_step(src.parent)
    for name, changes in robots.items():
        if not (src / name).exists():
            _write_robot(src / name, changes)
    return f"{course.shown_path(src)}: {', '.join(robots)}"


def _write_robot(folder: Path, changes: Sequence[Change]) -> None:
    """Write a package that is called like its folder."""
    files = {
        path.replace(HEALTHY, folder.name): text.replace(HEALTHY, folder.name) for path, text in ROBOT.items()
    }
    lost = [change.file for change in changes if not change.old]
    for change in changes:
        if change.old:
            files[change.file] = files[change.file].replace(change.old, change.new)
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        if path not in lost:
            (folder / path).write_text(text, encoding="utf-8")


@contextlib.contextmanager
def _built(package: str, hint: str) -> Iterator[Workspace]:
    """Build a package of the ward from nothing, so that what an earlier build has left neither helps nor harms."""
    ward = course.student_path(WARD)
    if not (ward / "src" / package).is_dir():
        raise CheckError(
            f"a package {package} in {WARD}/src",
            "there is none",
            "the cell with make_patients() makes what is missing.",
        )
    with built_from_nothing(ward, package) as clean:
        if not clean.result.is_ok:
            error = str(clean.result.first_error)
            _refuse(f"`colcon build --packages-select {package}` succeeds", error, package, error, hint)
        yield clean.workspace


def _check_drives(workspace: Workspace, package: str) -> None:
    """Check that `ros2 run` starts a driver that publishes on /cmd_vel."""
    expected = f"`ros2 run {package} driver` runs, and /cmd_vel has a Twist with 0.5 m/s"
    command = ["ros2", "run", package, "driver", "--ros-args", "-p", "times:=0"]
    program, speeds, topics = _watched(workspace, package, *command)
    if len(speeds) < 2:
        _refuse(
            expected,
            _silence(program, topics),
            package,
            f"$ ros2 run {package} driver\n{program.output}",
            "run it in a sourced terminal: the last line first, then the first line that is yours.",
        )
    if speeds[-1] != 0.5:
        raise CheckError(
            expected,
            f"{speeds[-1]:g} m/s",
            "only the faults are to be fixed: give the driver its speed back.",
        )


def _watched(
    workspace: Workspace, package: str, *command: str
) -> tuple[NodeProcess, list[float], dict[str, list[str]]]:
    """Run a command until /cmd_vel has two Twists, or none is to be expected.

    On a busy machine a program that drives for three seconds may end before anybody has met it: one that ends
    without an error, and unheard, is run once more.

    Returns:
        The program, which has ended by now unless a Twist came; the speeds in m/s; and what it published.
    """
    program, speeds, topics = _watched_once(workspace, package, *command)
    if program.returncode or speeds or topics:
        return program, speeds, topics
    return _watched_once(workspace, package, *command)


def _watched_once(
    workspace: Workspace, package: str, *command: str
) -> tuple[NodeProcess, list[float], dict[str, list[str]]]:
    with ObservedDomain() as domain:
        log = domain.log("/cmd_vel", TWIST)
        program = domain.start(package, list(command), workspace.overlay)
        topics: dict[str, list[str]] = {}

        def is_enough() -> bool:
            topics.update(domain.published())
            return log.count >= 2 or not program.is_running

        domain.wait(lambda: is_enough() or topics, START_TIMEOUT)
        domain.wait(is_enough, PATIENCE)
        has_ended = not program.is_running
        program.stop(STOP_TIMEOUT)
    speeds = [sample.message.linear.x for sample in log.samples()]
    return program, speeds, {} if has_ended else topics


def _silence(program: NodeProcess, topics: Mapping[str, Sequence[str]]) -> str:
    """Return what a program did that published nothing on /cmd_vel."""
    if topics:
        ends = ", ".join(f"{topic} ({', '.join(types)})" for topic, types in topics.items())
        return f"it runs, and publishes on {ends}"
    # Without the name that launch puts before each line.
    error = read_error(re.sub(r"^\[[\w-]+\] ", "", program.output, flags=re.MULTILINE))
    if error.reports:
        return error.decisive
    if program.returncode:
        return last_line(program.output) or SAID_NOTHING
    said = last_line(program.output)
    return f"it ended, and said last: {said}" if said else SAID_NOTHING


def _refuse(expected: str, found: str, package: str, output: str, hint: str) -> None:
    """Refuse an answer, and hint at the likeliest cause, its place and its fix, one after the other.

    Args:
        expected: what a right answer does.
        found: what this one does.
        package: in the ward.
        output: what colcon or the program has said.
        hint: for what `ros2lab diagnose` does not know.

    Raises:
        CheckError: always.
    """
    folder = course.student_path(WARD) / "src" / package
    findings = [*of_text(output, folder), *of_workspace(folder)]
    known = next((finding for finding in findings if finding.code != UNKNOWN), None)
    steps = [hint]
    if known:
        at = f"{known.cause} It is seen at {known.place}." if known.place else known.cause
        steps = list(dict.fromkeys((known.cause, at, f"{at} To fix it: {known.fix}." if known.fix else at)))
    raise CheckError(expected, in_place(found), *steps)
