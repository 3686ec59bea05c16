"""What a grade costs: time, processor time and memory, beside nbgrader's and what cannot be saved."""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import nbformat
from row import Quantity, Row

from ros2lab import course, environment
from ros2lab.classroom import gradebook
from ros2lab.classroom.gradebook import Seen, Worth
from ros2lab.classroom.handed_in import HandedIn
from ros2lab.classroom.judging import Judging
from ros2lab.grading import rubric
from ros2lab.grading.collect import collect
from ros2lab.grading.evidence_json import evidence_json
from ros2lab.grading.sandbox.compiled import compile_modules
from ros2lab.grading.sandbox.worlds import World
from ros2lab.grading.verdict import verdict

BONUS = ("launch", "config", "test")  # folders of the reference that the assignment does not ask for
NODES = ("status_publisher", "command_subscriber", "velocity_publisher")
SLEEPING = """
import time
import rclpy
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node("status")
    publisher = node.create_publisher(String, "/robot/status", 10)
    try:
        while rclpy.ok():
            publisher.publish(String(data="fine"))
            time.sleep(2.0)
    except KeyboardInterrupt:
        pass
"""
# Starts a node as a program of its own does, and ends.
ONE_NODE = "import rclpy; rclpy.init(); rclpy.create_node('floor'); rclpy.shutdown()"
REGRADED = 1000


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Grade the reference, as it is asked for and with all that the bonus is given for."""
    times = 1 if is_quick else 5
    compile_modules()  # as `ros2lab grade` does
    with tempfile.TemporaryDirectory(prefix="ros2lab-figures-") as name:
        folder = Path(name)
        whole = course.copy_reference(folder / "whole")
        model = course.copy_reference(folder / "model")
        take_away_the_bonus(model / "src/robot_controller")
        sleeping = Path(shutil.copytree(model, folder / "sleeping"))
        (sleeping / "src/robot_controller/robot_controller/status_publisher.py").write_text(SLEEPING)
        peer = [autograde(folder / f"course_{number}") for number in range(times)]
        advance(0.1)
        floor = [_floor(model, folder / f"floor_{number}") for number in range(times)]
        advance(0.2)
        took, used = _graded(model, times)
        advance(0.5)
        slow, _ = _graded(sleeping, 1 if is_quick else 3)
        advance(0.7)
        full, _ = _graded(whole, 1)
        tested = _tested(whole)
        advance(0.9)
        evidence = evidence_json(collect(model))
        regraded = _regraded(evidence, folder / "class")
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6
    return [
        Row(
            "a grade of three nodes, without the bonus",
            Quantity.of_samples(took, "s"),
            "nbgrader autograde of a notebook with two cells",
            Quantity.of_samples(peer, "s"),
            {"value": 4.0},
        ),
        Row(
            "processor time of that grade",
            Quantity.of_samples(used, "s"),
            "plain `colcon build`, and three nodes that start and end",
            Quantity.of_samples(floor, "s"),
            {"value": 3.0},
            "of the whole machine, which must do nothing else",
        ),
        Row("a grade where the status comes from a loop that sleeps", Quantity.of_samples(slow, "s")),
        Row("a grade of the reference with launch file, parameters and its tests", Quantity(full[0], "s")),
        Row(
            "the reference's own tests, as `colcon test` runs them",
            Quantity(tested, "s"),
            limits={"value": 12.0},
            note="171, of nodes, processes and functions",
        ),
        _sandbox(10 if is_quick else 50),
        regraded,
        Row("memory of the grader", Quantity(memory, "MB"), note="the most that it held; without the boxes"),
    ]


def take_away_the_bonus(package: Path) -> None:
    """Leave of a copy of the reference what the assignment asks for."""
    for part in BONUS:
        shutil.rmtree(package / part)
    setup = package / "setup.py"
    lines = setup.read_text(encoding="utf-8").splitlines(keepends=True)
    kept = [line for line in lines if "launch/" not in line and "config/" not in line]
    setup.write_text("".join(kept), encoding="utf-8")


def _graded(submission: Path, times: int) -> tuple[list[float], list[float]]:
    """Return the time and the processor time of some grades, in s."""
    took, used = [], []
    chosen = rubric.load()
    for _ in range(times):
        with _clocks(took, used):
            verdict(collect(submission), chosen)
    return took, used


def _floor(workspace: Path, copy: Path) -> float:
    """Return the processor time of what a grade cannot do without, in s."""
    shutil.copytree(workspace, copy)
    used: list[float] = []
    environ = environment.lab_environment()
    with _clocks([], used):
        subprocess.run(["colcon", "build"], cwd=copy, env=environ, capture_output=True, check=True)
        for _ in NODES:
            subprocess.run([sys.executable, "-c", ONE_NODE], env=environ, check=True)
    return used[0]


def autograde(folder: Path, students: int = 1) -> float:
    """Return how long nbgrader takes for so many submissions of two cells, in s."""
    notebook = nbformat.v4.new_notebook()
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    for cell_id, source, is_grade in (("answer", "x = 1", False), ("check", "assert x == 1", True)):
        cell = nbformat.v4.new_code_cell(source)
        cell.metadata["nbgrader"] = {
            "grade": is_grade,
            "solution": not is_grade,
            "locked": is_grade,
            "grade_id": cell_id,
            "points": 1,
            "schema_version": 3,
            "task": False,
        }
        notebook.cells.append(cell)
    for part in ("source", *(f"submitted/student{number}" for number in range(students))):
        (folder / part / "week2").mkdir(parents=True)
        nbformat.write(notebook, folder / part / "week2/robot.ipynb")
    environ = environment.lab_environment()  # in which nbgrader finds its database's tool
    for verb in ("generate_assignment", "autograde"):
        begin = time.perf_counter()
        subprocess.run(
            [sys.executable, "-m", "nbgrader", verb, "week2"],
            cwd=folder,
            env=environ,
            capture_output=True,
            check=True,
        )
    return time.perf_counter() - begin


def _tested(workspace: Path) -> float:
    """Return how long `colcon test` takes in a workspace, in s.

    Raises:
        subprocess.CalledProcessError: if a test fails.
    """
    environ = environment.lab_environment()
    took: list[float] = []
    for command in (["colcon", "build"], ["colcon", "test", "--return-code-on-test-failure"]):
        with _clocks(took, []):
            subprocess.run(command, cwd=workspace, env=environ, capture_output=True, check=True)
    return took[-1]


def _sandbox(times: int) -> Row:
    """Return what a sandbox adds to a program that does nothing."""
    boxed, plain = [], []
    for _ in range(times):
        with _clocks(boxed, []), World() as world:
            world.run(["true"])
        with _clocks(plain, []):
            subprocess.run(["true"], check=True)
    return Row(
        "a World with one box, in which `true` runs",
        Quantity.of_samples([1e3 * seconds for seconds in boxed], "ms"),
        "`true`",
        Quantity.of_samples([1e3 * seconds for seconds in plain], "ms"),
    )


def _regraded(evidence: str, folder: Path) -> Row:
    """Return how long a class is judged again by another rubric, in s."""
    by = Judging.of(None, None, {})
    with gradebook.opened(folder, is_new_allowed=True) as book:
        for number in range(REGRADED):
            student = HandedIn(f"{number}", f"Student {number}", f"{number}")
            book.register([(student, student.key, 0)])
            worths = {student.key: Worth(0, 0, "{}", "")}
            book.record(student.key, by.assignment_digest, "", Seen(evidence, {}, "", 0.0), worths)
    took: list[float] = []
    with _clocks(took, []):
        command = [Path(sys.executable).with_name("ros2lab"), "class", "regrade", folder]
        subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
    return Row(f"a class of {REGRADED} judged again", Quantity(took[0], "s"), limits={"value": 10.0})


@contextmanager
def _clocks(took: list[float], used: list[float]) -> Iterator[None]:
    """Append the time and the machine's processor time of what is done, in s."""
    begin, busy = time.perf_counter(), _busy()
    yield
    took.append(time.perf_counter() - begin)
    used.append(_busy() - busy)


def _busy() -> float:
    """Return for how long the processors have worked, in s; what runs in namespaces of its own is in it, too."""
    user, nice, system = map(int, Path("/proc/stat").read_text(encoding="ascii").split()[1:4])
    return (user + nice + system) / os.sysconf("SC_CLK_TCK")
