"""Grade many submissions at once, and tell what happens to each as it happens."""

from __future__ import annotations

import queue
import subprocess
import threading
from collections.abc import Generator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

from ros2lab.classroom import one
from ros2lab.classroom.capacity import Gate
from ros2lab.classroom.gradebook import Seen
from ros2lab.classroom.one import CannotGrade, GradingFailed, graded_apart


@dataclass(frozen=True)
class Task:
    """What is graded once.

    Attributes:
        digest: of it.
        paths: a folder, an archive, or loose files.
        name: under which it is shown.
        students: the keys of all who have handed it in.
    """

    digest: str
    paths: tuple[Path, ...]
    name: str
    students: tuple[str, ...]


@dataclass(frozen=True)
class Step:
    """What is being done with a task."""

    task: Task
    text: str


@dataclass(frozen=True)
class Done:
    """The end of a task: what was seen, or a sentence that says why the grader has failed."""

    task: Task
    result: Seen | str


def grade(
    tasks: Sequence[Task], jobs: int, assignment: Path | None, gate: Gate | None = None
) -> Generator[Step | Done, None, None]:
    """Grade tasks, each in a process of its own, and yield what happens; all of them end when the iterator is closed.

    Args:
        tasks: in the order in which they are begun.
        jobs: how many at once.
        assignment: the folder of what was asked for; None for the course's own.
        gate: which each passes before it begins; None if all of `jobs` may begin at once.

    Raises:
        CannotGrade: if this machine cannot grade any of them.
    """
    events: queue.SimpleQueue[Step | Done | CannotGrade] = queue.SimpleQueue()
    running = _Running()

    def work(task: Task) -> None:
        with gate.passed(lambda: running.is_over) if gate else nullcontext():
            if not running.is_over:
                grade_one(task)

    def grade_one(task: Task) -> None:
        try:
            seen = graded_apart(
                task.paths,
                assignment,
                lambda text: events.put(Step(task, text)),
                running.add,
                is_alone=min(jobs, len(tasks)) == 1,
            )
        except CannotGrade as error:
            # What one submission brings about, such as that memory runs short, keeps no other one from its grade.
            events.put(error if one.refusal() else Done(task, str(error)))
        except GradingFailed as error:
            events.put(Done(task, str(error)))
        except Exception as error:
            events.put(Done(task, f"The grader could not be started: {error}."))
        else:
            events.put(Done(task, seen))

    with ThreadPoolExecutor(jobs, thread_name_prefix="grading") as pool:
        try:
            for task in tasks:
                pool.submit(work, task)
            left = len(tasks)
            while left:
                event = events.get()
                if isinstance(event, CannotGrade):
                    raise event
                left -= isinstance(event, Done)
                yield event
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            running.end()


class _Running:
    """The processes that grade, so that all of them can be ended."""

    def __init__(self) -> None:
        self.is_over = False
        self._lock = threading.Lock()
        self._processes: list[subprocess.Popen[str]] = []

    def add(self, process: subprocess.Popen[str]) -> None:
        with self._lock:
            self._processes = [running for running in self._processes if running.poll() is None] + [process]
            if self.is_over:
                process.kill()

    def end(self) -> None:
        with self._lock:
            self.is_over = True
            for process in self._processes:
                process.kill()
