"""Start a submission's programs and have an observer watch them; each yields a `Run`, as plain data.

The programs and the observer (see `observer`) run in boxes of a World. Only the observer is trusted: it talks
to the grader through a socket that no program of the submission has.
"""

from __future__ import annotations

import contextlib
import importlib.util
import itertools
import json
import math
import os
import select
import socket
import sys
import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ros2lab import assignments, environment
from ros2lab.assignments import Assignment
from ros2lab.grading.evidence import Run
from ros2lab.grading.sandbox.box import Limits
from ros2lab.grading.sandbox.bubblewrap import PACKAGE
from ros2lab.grading.sandbox.worlds import ROS_SETTINGS, World
from ros2lab.grading.watching.job import STOP_TIMEOUT, Job, on_the_real_clock

# Jobs watched at once: each room costs a second of processor time, which pays off only on a core of its own.
AT_ONCE = min(3, len(os.sched_getaffinity(0)))
QUEUE = 3  # jobs per room, where other submissions keep the other cores busy
# Memory that no process owns counts for every box of a World, and must not end this one before a program's.
OBSERVER_LIMITS = Limits(wall_s=1800, cpu_s=900, processes=256, memory_bytes=3_000_000_000)
# A node may log a thousand lines of the usual length in each second of the stepped clock.
PROGRAM_LIMITS = Limits(
    wall_s=120, cpu_s=60, memory_bytes=1_000_000_000, processes=256, output_bytes=5_000_000
)
POLL = 0.03  # s between two checks whether a program has ended
RUN_TIMEOUT, LEAST_TIMEOUT = 110.0, 40.0  # s that a job gets on one clock: at most, and at least
OBSERVER_TIMEOUT = 180.0  # s from a job's start to its result, whatever keeps the observer busy
WATCHING_TIMEOUT = 300.0  # s for all jobs of a submission
AT_A_TIME = 2 / 3  # share of the remaining time for the jobs of one `watch` call
LONGEST_ANSWER = 100_000_000  # bytes


def _folders_of(*names: str) -> list[Path]:
    """Return the folders from which these packages are imported, for those that are installed."""
    specs = [importlib.util.find_spec(name) for name in names]
    return [Path(spec.origin).parent.parent for spec in specs if spec and spec.origin]


# What a World must show in addition: where `ros2 launch` comes from.
SHOWN = (*_folders_of("launch", "portable_ros2"), environment.DDS_PROFILE)


class ObserverLost(Exception):  # noqa: N818 -- no fault of ours
    """The observer has ended or does not answer; the message says why."""


class Observer:
    """Watches programs; a context manager.

    Each job has a room while it runs: a World of its own, so that no program reaches those of another job. A
    room takes half a second to start; the first one starts while other work goes on. One Observer is enough
    for a submission.

    Args:
        world: the World with the programs' files, copied when the first job starts; made with `shown=SHOWN`.
        assignment: the assignment whose parts the programs may play; None takes the course's own.
        rooms: how many rooms to make at once, if that many jobs are known to come.
        queue: how many jobs wait for a room before another one is made.
        seconds: the time for all jobs; a job that has started by then still finishes.

    Attributes:
        assignment: as above.
    """

    def __init__(
        self,
        world: World,
        assignment: Assignment | None = None,
        *,
        rooms: int = 1,
        queue: int = 1,
        seconds: float = WATCHING_TIMEOUT,
    ) -> None:
        self.assignment = assignment or assignments.load()
        self._world = world
        self._queue = queue
        self._rooms: list[_Room] = []
        self._seconds = self._seconds_left = seconds
        try:
            self._make_rooms(rooms)
        except BaseException:
            self.close()
            raise

    def watch(self, jobs: Sequence[Job], *, within: float = math.inf) -> list[Run]:
        """Run the jobs, a few at a time, and return a Run for each; no job hears another's programs.

        The Run of a job that could not be watched has a note that says so; a job for which no time was left
        is unfinished. Each job has a share of the time, so that a slow one leaves some for the others. None is
        started after so many seconds as they all should end `within`, nor takes twice as many.
        """
        try:
            self._furnish(len(jobs))
        except ValueError as reason:  # a build may leave anything behind
            return [replace(job.run(), notes=[f"This could not be watched: {reason}"]) for job in jobs]
        waiting = deque(jobs)
        start = time.monotonic()
        while waiting or any(room.job for room in self._rooms):
            spent = time.monotonic() - start
            if spent > min(self._seconds_left, within):
                for job in waiting:
                    job.unfinished = f"others of the submission took {self._seconds:g} s"
                waiting.clear()
            for room in self._rooms:
                if waiting and not room.job:
                    left = AT_A_TIME * self._seconds_left - spent
                    share = left / max(1.0, len(waiting) / len(self._rooms)) / 2  # for each of the two clocks
                    room.take(waiting.popleft(), min(RUN_TIMEOUT, 2 * within, max(LEAST_TIMEOUT, share)))
            select.select(self._rooms, [], [], POLL)
            for room in self._rooms:
                room.go_on()
        self._seconds_left -= time.monotonic() - start
        return [job.run() for job in jobs]

    def close(self) -> None:
        """End the observers and what they watch; closing twice does nothing."""
        for room in self._rooms:
            room.close()

    def __enter__(self) -> Observer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _furnish(self, count: int) -> None:
        """Make enough rooms for `count` jobs, and copy the files into each."""
        self._make_rooms(math.ceil(count / self._queue))
        for room in self._rooms:
            if not room.is_furnished:
                room.world.fill(self._world.folder)
                room.is_furnished = True

    def _make_rooms(self, count: int) -> None:
        while len(self._rooms) < min(count, AT_ONCE):
            self._rooms.append(_Room(self._world.beside(), self.assignment))


class _Room:
    """A World in which an observer watches the programs of one job at a time.

    Args:
        world: the room's own World.
        assignment: the assignment whose parts the programs may play.

    Attributes:
        world: as above.
        job: the job that is being watched; None if there is none.
        is_furnished: whether the World has its copy of the files.
    """

    def __init__(self, world: World, assignment: Assignment) -> None:
        self.world = world
        self.job: Job | None = None
        self.is_furnished = False
        self._assignment = assignment
        self._numbers = itertools.count(1)
        self._start()

    def fileno(self) -> int:
        """Return the file descriptor that is readable when the observer has sent a message."""
        return self._socket.fileno()

    def take(self, job: Job, seconds: float) -> None:
        """Start a job, for at most `seconds` on each clock."""
        self.job = job
        job.seconds = seconds
        with self._losing():
            self._begin(job)

    def go_on(self) -> None:
        """Do what the observer asks for, and what is due."""
        with self._losing():
            for message in self._messages():
                if self.job and message["run"] == self.job.number:
                    self._obey(self.job, message)
            if self.job:
                self._watch_over(self.job)

    def close(self) -> None:
        """End the observer and everything else in the room."""
        self._socket.close()
        self.world.close()

    @contextlib.contextmanager
    def _losing(self) -> Iterator[None]:
        """If the observer is lost meanwhile, end the job and start another observer."""
        try:
            yield
        except ObserverLost as reason:
            if self.job:
                self._finish(self.job, {}, str(reason))
            self._socket.close()
            self._box.kill()
            self._start()

    def _finish(self, job: Job, result: dict[str, Any], fault: str = "") -> None:
        """End a job with what was seen; by a fault of the observer's own, the rest of it is untried."""
        job.result = result
        job.kill()
        if job.unfinished and not result.get("nodes"):  # on neither clock: there is nothing to come to an end
            job.unfinished = ""
            job.notes.append(f"No node of it was there within {job.seconds:.0f} s.")
        if fault:
            job.unfinished = f"the observer itself has failed ({fault.rstrip('.')})"
        self.job = None

    def _start(self) -> None:
        self._socket, its_socket = socket.socketpair()
        self._received = bytearray()
        with its_socket:
            self._box = self.world.start(
                [
                    sys.executable,
                    "-B",
                    "-m",
                    "ros2lab.grading.watching.observer",
                    json.dumps(self._assignment.plain()),
                ],
                files="none",
                environ=_settings(
                    {
                        **environment.found_libraries(),
                        "PYTHONPATH": str(PACKAGE.parent),
                        "ROS_PYTHON_CHECK_FIELDS": "0",  # what is received is of the right types
                    }
                ),
                stdin=its_socket.fileno(),
                shown=[PACKAGE],
                limits=OBSERVER_LIMITS,
            )

    def _begin(self, job: Job) -> None:
        job.begin(next(self._numbers))
        self._tell(job, domain=job.domain, is_stepped=job.is_stepped, seconds=job.seconds, **job.plan)

    def _begin_on_the_real_clock(self, job: Job, why: str) -> None:
        if job.is_shared or job.plan.get("keeps_clock"):
            self._finish(job, {})
            return
        job.kill()
        job.is_stepped = False
        job.notes.append(on_the_real_clock(why))
        self._begin(job)

    def _obey(self, job: Job, message: dict[str, Any]) -> None:
        """Do what the observer asks for."""
        do = message["do"]
        if do == "start":
            for number, program in enumerate(job.programs):
                job.boxes[program.name] = self.world.start(
                    program.words(is_stepped=job.is_stepped),
                    environ=_settings({**program.environ, "ROS_DOMAIN_ID": str(job.domain)}),
                    stdin=job.keyboard(program),
                    limits=PROGRAM_LIMITS,
                    among=str(job.number) if len(job.programs) > 1 else "",
                    neighbours=job.neighbours(number),
                )
            job.alive = len(job.boxes)
        elif do == "met":
            job.show_neighbours()
        elif do == "mark":
            if not self._box.wait_for(message["line"], STOP_TIMEOUT):
                raise ObserverLost("it does not print what it says")
            job.look()
            if message["number"]:
                job.marks[message["number"]] = {name: len(box.output) for name, box in job.boxes.items()}
            self._tell(job, alive=job.alive, go=True, printed=job.has_printed())
        elif do == "type":
            job.look()
            job.type()
        elif do == "hold":
            self._hold(job, message["enclave"])
        elif do == "interrupt":
            job.interrupt()
        elif do == "real":
            job.parameters = message["parameters"]
            self._begin_on_the_real_clock(job, message["why"])
        elif job.is_stepped and any("--ros-args" in said for said in job.ended.values()):
            self._begin_on_the_real_clock(job, "A program does not take --ros-args.")
        else:
            self._finish(job, message if do == "result" else {}, message["why"])

    def _hold(self, job: Job, enclave: str) -> None:
        """Hold all programs but that of an enclave, none if it is empty; give up the job if that fails."""
        for program in job.programs:
            box = job.boxes[program.name]
            if enclave in ("", program.enclave):
                box.release()
            elif not box.hold(STOP_TIMEOUT):
                self._finish(job, {})
                return
        self._tell(job, go=True)

    def _watch_over(self, job: Job) -> None:
        """Tell the observer which programs have ended, and kill those that do not end in time."""
        if time.monotonic() - job.since > OBSERVER_TIMEOUT:
            raise ObserverLost(f"it did not come to its end within {OBSERVER_TIMEOUT:g} s.")
        has_changed = job.look()
        if job.is_shared and job.ended:
            self._finish(job, {})
            return
        if has_changed:
            self._tell(job, alive=job.alive)
        if job.interrupted_at and not job.is_released:
            if time.monotonic() - job.interrupted_at > STOP_TIMEOUT:
                job.kill()
            if not job.alive:
                job.is_released = True
                self._tell(job, go=True)
        if time.monotonic() - job.since > job.seconds and job.alive and not job.interrupted_at:
            why = f"it was not seen to its end within {job.seconds:.0f} s"
            if job.is_stepped:
                self._begin_on_the_real_clock(job, f"{why[0].upper()}{why[1:]}.")
            else:
                job.kill()
                job.unfinished = why

    def _tell(self, job: Job, **message: Any) -> None:
        try:
            self._socket.sendall(json.dumps({"run": job.number, **message}).encode() + b"\n")
        except OSError:
            raise ObserverLost(self._last_word()) from None

    def _messages(self) -> Iterator[dict[str, Any]]:
        """Yield the messages that the observer has sent."""
        if not select.select([self._socket], [], [], 0)[0]:
            return
        try:
            part = self._socket.recv(1 << 20)
        except OSError:
            part = b""
        if not part:
            raise ObserverLost(self._last_word())
        self._received += part
        if len(self._received) > LONGEST_ANSWER:
            raise ObserverLost("it says too much.")
        if b"\n" in part:
            *lines, rest = self._received.split(b"\n")
            self._received = rest
            for line in lines:
                yield json.loads(line)

    def _last_word(self) -> str:
        with contextlib.suppress(TimeoutError):
            self._box.wait(STOP_TIMEOUT)
        return self._box.cut or (self._box.output.strip().splitlines() or ["it said nothing"])[-1]


def _settings(environ: Mapping[str, str]) -> dict[str, str]:
    """Return the environment of a box in which ROS runs."""
    return {**environment.lab_settings({}), "PYTHONUNBUFFERED": "1", **environ, **ROS_SETTINGS}
