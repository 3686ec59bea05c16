"""Start a submission's programs, and have them watched: a `Run` for each, as plain data.

The programs run in boxes of a World, and so does the observer (see `observer`), which alone is believed. What it
is told and what it tells goes through a socket that no program of the submission has.
"""

from __future__ import annotations

import contextlib
import importlib.util
import itertools
import json
import os
import re
import select
import socket
import sys
import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ros2lab import assignments, environment
from ros2lab.assignments import Assignment
from ros2lab.grading.box import Box, Limits
from ros2lab.grading.evidence import GIVEN, CommandSeen, Heard, Run, ServiceCall
from ros2lab.grading.sandbox import PACKAGE, ROS_SETTINGS, World

# Jobs: each room costs a second of processor time, which only a core of its own makes up for.
AT_ONCE = min(3, len(os.sched_getaffinity(0)))
DOMAINS = itertools.cycle(
    range(1, 102)
)  # whose ports Linux does not hand out; each World has its own network
# Memory that nobody holds counts for all boxes of a World, and must not end this one before a program does.
OBSERVER_LIMITS = Limits(wall_s=1800, cpu_s=900, processes=256, memory_bytes=3_000_000_000)
# A node may log a thousand lines of the usual length in each second of the clock that is stepped.
PROGRAM_LIMITS = Limits(
    wall_s=120, cpu_s=60, memory_bytes=1_000_000_000, processes=256, output_bytes=5_000_000
)
POLL = 0.01  # s between two looks whether a program has ended
STOP_TIMEOUT = 10.0  # s from Ctrl-C to the end, on a busy machine
RUN_TIMEOUT = 110.0  # s
LONGEST_ANSWER = 100_000_000  # bytes
LINES, LINE = 200, 500


def _folders_of(*names: str) -> list[Path]:
    """Return the folders from which packages are imported, of those that are installed."""
    specs = [importlib.util.find_spec(name) for name in names]
    return [Path(spec.origin).parent.parent for spec in specs if spec and spec.origin]


# What a World has to show besides: where `ros2 launch` comes from.
SHOWN = (*_folders_of("launch", "portable_ros2"), environment.DDS_PROFILE)
# What rclpy warns of where the observer does not wait for an answer any more.
_OF_RCLPY = re.compile(
    r".*/rclpy/service\.py:\d+: RuntimeWarning: failed to send response|\s+self\.__service\.service_send_response\("
)
_LOG_LINE = re.compile(r"\[(DEBUG|INFO|WARN|ERROR|FATAL)\] \[([^\]]*)\]: (.*)")


class ObserverLost(Exception):  # noqa: N818 -- no fault of ours
    """The observer has ended, or does not answer; the message says why."""


@dataclass(frozen=True)
class Program:
    """What is started.

    Attributes:
        name: of the `Executable`.
        command: how it is started in a box.
        environ: its environment: the overlay. Settings of ROS are added.
        parameters: such as `period:=1.0`; given by `--ros-args`.
        takes_arguments: whether it understands `--ros-args`; `ros2 launch` does not.
    """

    name: str
    command: Sequence[str | Path]
    environ: Mapping[str, str] = field(default_factory=dict)
    parameters: Sequence[str] = ()
    takes_arguments: bool = True


class Observer:
    """Watches programs; a context manager.

    Each of the jobs that go on at once has a room: a World of its own, so that no program reaches what is watched for
    another one. They take half a second to start, which goes on while others work. One Observer is enough for a
    submission.

    Args:
        world: whose files the programs have, as they are when the first one is watched; made with `shown=SHOWN`.
        assignment: whose parts the programs may play; None takes the course's own.

    Attributes:
        assignment: as above.
    """

    def __init__(self, world: World, assignment: Assignment | None = None) -> None:
        self.assignment = assignment or assignments.load()
        self._world = world
        self._is_furnished = False
        self._rooms: list[_Room] = []
        try:
            for _ in range(AT_ONCE):
                self._rooms.append(_Room(world.beside(), self.assignment))
        except BaseException:
            self.close()
            raise

    def watch(self, jobs: Sequence[Job]) -> list[Run]:
        """Watch programs as jobs say, a few jobs at a time, and return a Run for each; none hears another's programs."""
        try:
            self._furnish()
        except ValueError as reason:  # what a build has left may be anything
            return [replace(job.run(), notes=[f"This could not be watched: {reason}"]) for job in jobs]
        waiting = deque(jobs)
        while waiting or any(room.job for room in self._rooms):
            for room in self._rooms:
                if waiting and not room.job:
                    room.take(waiting.popleft())
            select.select(self._rooms, [], [], POLL)
            for room in self._rooms:
                room.go_on()
        return [job.run() for job in jobs]

    def close(self) -> None:
        """End the observers and what they watch; closing it again does nothing."""
        for room in self._rooms:
            room.close()

    def __enter__(self) -> Observer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _furnish(self) -> None:
        if not self._is_furnished:
            for room in self._rooms:
                room.world.fill(self._world.folder)
            self._is_furnished = True


class _Room:
    """A World in which an observer watches the programs of one job at a time.

    Args:
        world: the room's own.
        assignment: whose parts the programs may play.

    Attributes:
        world: as above.
        job: that goes on; None if there is none.
    """

    def __init__(self, world: World, assignment: Assignment) -> None:
        self.world = world
        self.job: Job | None = None
        self._assignment = assignment
        self._numbers = itertools.count(1)
        self._start()

    def fileno(self) -> int:
        """Return what can be read when the observer has said something."""
        return self._socket.fileno()

    def take(self, job: Job) -> None:
        """Begin to watch as a job says."""
        self.job = job
        with self._losing():
            self._begin(job)

    def go_on(self) -> None:
        """Do what the observer asks for, and what is due by now."""
        with self._losing():
            for message in self._messages():
                if self.job and message["run"] == self.job.number:
                    self._obey(self.job, message)
            if self.job:
                self._watch_over(self.job)

    def close(self) -> None:
        """End the observer, and all else in the room."""
        self._socket.close()
        self.world.close()

    @contextlib.contextmanager
    def _losing(self) -> Iterator[None]:
        """Where the observer is lost meanwhile, end the job, and go on with another observer."""
        try:
            yield
        except ObserverLost as reason:
            if self.job:
                self._finish(self.job, {"notes": [f"This could not be watched to its end: {reason}"]})
            self._socket.close()
            self._box.kill()
            self._start()

    def _finish(self, job: Job, result: dict[str, Any]) -> None:
        job.result = result
        job.kill()
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
                    "ros2lab.grading.observer",
                    json.dumps(self._assignment.plain()),
                ],
                files="none",
                environ=_settings({"PYTHONPATH": str(PACKAGE.parent)}),
                stdin=its_socket.fileno(),
                shown=[PACKAGE],
                limits=OBSERVER_LIMITS,
            )

    def _begin(self, job: Job) -> None:
        job.begin(next(self._numbers))
        self._tell(job, domain=job.domain, is_stepped=job.is_stepped, **job.plan)

    def _begin_on_the_real_clock(self, job: Job, why: str) -> None:
        job.kill()
        job.is_stepped = False
        job.notes.append(f"It was watched on the real clock, which costs nothing: {why}")
        self._begin(job)

    def _obey(self, job: Job, message: dict[str, Any]) -> None:
        """Do what the observer asks for."""
        do = message["do"]
        if do == "start":
            for program in job.programs:
                job.boxes[program.name] = self.world.start(
                    _command(program, is_stepped=job.is_stepped),
                    environ=_settings({**program.environ, "ROS_DOMAIN_ID": str(job.domain)}),
                    limits=PROGRAM_LIMITS,
                )
            job.alive = len(job.boxes)
        elif do == "mark":
            if not self._box.wait_for(message["line"], STOP_TIMEOUT):
                raise ObserverLost("it does not print what it says")
            if message["number"]:
                job.marks[message["number"]] = {name: len(box.output) for name, box in job.boxes.items()}
            job.look()
            self._tell(job, alive=job.alive, go=True, printed=job.has_printed())
        elif do == "interrupt":
            job.interrupt()
        elif do == "real":
            job.parameters = message["parameters"]
            self._begin_on_the_real_clock(job, message["why"])
        elif job.is_stepped and any("--ros-args" in said for said in job.ended.values()):
            self._begin_on_the_real_clock(job, "A program does not take --ros-args.")
        else:
            failed = {"notes": [f"The observer failed: {message.get('why')}."]}
            self._finish(job, message if do == "result" else failed)

    def _watch_over(self, job: Job) -> None:
        """Tell the observer of programs that have ended, and end those that do not."""
        if job.look():
            self._tell(job, alive=job.alive)
        if job.interrupted_at and not job.is_released:
            if time.monotonic() - job.interrupted_at > STOP_TIMEOUT:
                job.kill()
            if not job.alive:
                job.is_released = True
                self._tell(job, go=True)
        if time.monotonic() - job.since > RUN_TIMEOUT and job.alive and not job.interrupted_at:
            why = f"It was not seen to its end within {RUN_TIMEOUT:g} s."
            if job.is_stepped:
                self._begin_on_the_real_clock(job, why)
            else:
                job.kill()
                job.notes.append(why)

    def _tell(self, job: Job, **message: Any) -> None:
        try:
            self._socket.sendall(json.dumps({"run": job.number, **message}).encode() + b"\n")
        except OSError:
            raise ObserverLost(self._last_word()) from None

    def _messages(self) -> Iterator[dict[str, Any]]:
        """Give what the observer has said."""
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


class Job:
    """What is to be watched once: a Run in the making.

    Args:
        programs: that are started; they hear one another.
        setting: of the Run.
        has_commands: whether commands are published.
        is_stepped: whether the programs are to follow a clock that is stepped.
        is_brief: whether it is known already what they do alone.
        is_given: whether they receive what they may wait for, in default values.
        nodes: how many to wait for; 0 if each program has one at least.
    """

    def __init__(
        self,
        programs: Sequence[Program],
        setting: str,
        *,
        has_commands: bool = True,
        is_stepped: bool = True,
        is_brief: bool = False,
        is_given: bool = False,
        nodes: int = 0,
    ) -> None:
        self.programs = list(programs)
        self.setting = setting
        self.is_stepped = is_stepped
        self.plan = {
            "programs": len(programs),
            "nodes": nodes,
            "has_commands": has_commands,
            "is_brief": is_brief,
            "is_given": is_given,
        }
        self.notes: list[str] = []
        # What was seen before it was watched on the real clock.
        self.parameters: dict[str, dict[str, Any]] = {}
        self.result: dict[str, Any] = {}
        self.begin(0)

    @classmethod
    def alone(cls, program: Program, *, has_commands: bool = True) -> Job:
        """Watch a program by itself; the setting is `alone`, or its parameters."""
        return cls([program], " ".join(program.parameters) or "alone", has_commands=has_commands)

    @classmethod
    def together(cls, programs: Sequence[Program]) -> Job:
        """Watch programs that hear one another, briefly: what each does alone is known."""
        return cls(programs, "together", is_brief=True)

    @classmethod
    def given(cls, programs: Sequence[Program]) -> Job:
        """Watch programs together, on the real clock, while they are given what they may wait for."""
        return cls(programs, GIVEN, is_stepped=False, is_brief=True, is_given=True)

    @classmethod
    def launched(
        cls, program: Program, nodes: int, *, has_commands: bool = True, is_brief: bool = False
    ) -> Job:
        """Watch what a launch command starts, such as `ros2 launch`, on the real clock."""
        one = replace(program, takes_arguments=False)
        return cls(
            [one], "launched", has_commands=has_commands, is_stepped=False, is_brief=is_brief, nodes=nodes
        )

    def begin(self, number: int) -> None:
        """Forget what was seen before."""
        self.number = number
        self.domain = next(DOMAINS)
        self.alive = 0
        self.since = time.monotonic()
        self.interrupted_at = 0.0
        self.is_released = False
        self.killed: set[str] = set()  # by the grader, which is no end of their own
        self.boxes: dict[str, Box] = {}
        self.marks: dict[int, dict[str, int]] = {}
        self.ended: dict[str, str] = {}
        self.stopped: dict[str, dict[str, Any]] = {}
        self.said: dict[str, int] = {}  # how much each had printed at Ctrl-C

    def look(self) -> bool:
        """See which programs run; whether one has ended since the last look."""
        for name, box in self.boxes.items():
            if box.code is None or name in self.ended or name in self.stopped:
                continue
            if self.interrupted_at:
                tail = box.output[self.said[name] :]
                self.stopped[name] = {
                    "seconds": round(time.monotonic() - self.interrupted_at, 2),
                    "traceback": "Traceback (most recent call last)" in tail,
                    "killed": box.cut is not None or time.monotonic() - self.interrupted_at > STOP_TIMEOUT,
                    "said": _last_lines(tail),
                }
            else:
                self.ended[name] = box.cut or _last_lines(box.output)
        before, self.alive = self.alive, len(self.boxes) - len(self.ended) - len(self.stopped)
        return self.alive != before

    def has_printed(self) -> bool:
        """Return whether a program has printed something since the last mark."""
        before = self.marks.get(len(self.marks), {})
        return any(len(box.output) > before.get(name, 0) for name, box in self.boxes.items())

    def interrupt(self) -> None:
        """Send Ctrl-C to all programs."""
        self.look()
        self.interrupted_at = time.monotonic()
        for name, box in self.boxes.items():
            self.said[name] = len(box.output)
            box.interrupt()

    def kill(self) -> None:
        """End all programs at once."""
        self.killed |= {name for name, box in self.boxes.items() if box.code is None}
        for box in self.boxes.values():
            box.kill()
        for box in self.boxes.values():
            with contextlib.suppress(TimeoutError):
                box.wait(STOP_TIMEOUT)

    def run(self) -> Run:
        """Return what was seen."""
        seen = self.result
        finals = seen.get("final", {})
        for name in self.stopped:
            self.stopped[name]["last"] = finals
        return Run(
            programs=[program.name for program in self.programs],
            setting=self.setting,
            clock="stepped" if self.is_stepped else "real",
            nodes=seen.get("nodes", []),
            publishes=seen.get("publishes", {}),
            subscribes=seen.get("subscribes", {}),
            qos=seen.get("qos", {}),
            parameters=self._parameters(seen.get("parameters", {})),
            quiet=_heard(seen.get("quiet", {})),
            commands=[self._command(command) for command in seen.get("commands", [])],
            ended={name: last for name, last in self.ended.items() if name not in self.killed},
            stopped=self.stopped,
            notes=[*self.notes, *seen.get("notes", [])],
            log=self._log(seen.get("log", []), 1),
            twins=seen.get("twins", []),
            stalled=seen.get("stalled", []),
            services=seen.get("services", {}),
            given=seen.get("given", []),
            calls=[
                ServiceCall(**{**call, "topics": _heard(call["topics"])}) for call in seen.get("calls", [])
            ],
        )

    def _parameters(self, seen: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
        """Return the parameters by node; a node that sleeps may not answer now as it did while the clock stood."""
        before = {name: values for name, values in self.parameters.items() if not seen.get(name)}
        return dict(sorted({**seen, **before}.items()))

    def _command(self, seen: dict[str, Any]) -> CommandSeen:
        return CommandSeen(
            text=seen["text"],
            log=self._log(seen["log"], seen["mark"]),
            topics=_heard(seen["topics"]),
            parameters=seen["parameters"],
            is_alive=seen["alive"] == len(self.programs),
        )

    def _log(self, lines: Sequence[Sequence[str]], mark: int) -> list[list[str]]:
        """Return log lines, and what was printed besides up to a mark."""
        known = {(level, name, text) for level, name, whole in lines for text in whole.splitlines()}
        log = [[level, text[:LINE]] for level, _, text in lines]
        log += [["PRINT", line] for line in self._printed(mark) if not _is_known(line, known)]
        return log[:LINES]

    def _printed(self, mark: int) -> list[str]:
        """Return the lines that the programs have printed between the mark before and this one."""
        before, after = self.marks.get(mark - 1, {}), self.marks.get(mark, {})
        return [
            line[:LINE]
            for name, box in self.boxes.items()
            for line in box.output[before.get(name, 0) : after.get(name, 0)].splitlines()
            if line.strip() and not _OF_RCLPY.match(line)
        ]


def _is_known(line: str, known: set[tuple[str, str, str]]) -> bool:
    """Return whether a printed line is a log line that was heard."""
    match = _LOG_LINE.fullmatch(line)
    return (match.groups() if match else ("", "", line)) in known or any(line == text for *_, text in known)


def _heard(topics: dict[str, Any]) -> dict[str, Heard]:
    return {topic: Heard(**heard) for topic, heard in topics.items()}


def _last_lines(text: str) -> str:
    return "\n".join(line[:LINE] for line in text.strip().splitlines()[-10:])


def _command(program: Program, *, is_stepped: bool) -> list[str | Path]:
    parameters = [*(["use_sim_time:=true"] if is_stepped else []), *program.parameters]
    if not program.takes_arguments or not parameters:
        return list(program.command)
    words = [word for parameter in parameters for word in ("-p", parameter)]
    return [*program.command, "--ros-args", *words]


def _settings(environ: Mapping[str, str]) -> dict[str, str]:
    """Return the environment of a box with ROS in it."""
    return {**environment.lab_settings({}), "PYTHONUNBUFFERED": "1", **environ, **ROS_SETTINGS}
