"""A job: programs that are started and watched once, and what was seen of them, as a `Run`."""

from __future__ import annotations

import contextlib
import itertools
import math
import re
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ros2lab.diagnose.printed.ignored import without_ignored
from ros2lab.grading.code.compared import Contents
from ros2lab.grading.evidence import GIVEN, CommandSeen, Heard, Run, ServiceCall
from ros2lab.grading.reading.stand_in import SAYS_YES
from ros2lab.grading.sandbox.box import Box
from ros2lab.grading.sandbox.keeper import is_limit
from ros2lab.grading.sandbox.neighbours import Neighbours
from ros2lab.grading.senses import seen as seen_of
from ros2lab.grading.watching.keyboard import Keyboard
from ros2lab.grading.watching.shares import shared_out

OTHERWISE = "A program does something else on a stepped clock."
UNTOLD = "untold"  # the setting of programs that are told nothing of a clock
DOMAINS = itertools.cycle(
    range(1, 102)
)  # Linux assigns their ports to nothing else; each World has its own network
STOP_TIMEOUT = 10.0  # s from Ctrl-C to the end, on a busy machine
LINES, LINE = 200, 500
MOST_CAUSES = 3  # of an error, that are kept
_OF_CAUSE = ("The above exception was the direct cause", "During handling of the above exception")
# A warning of rclpy when the observer no longer waits for an answer.
_OF_RCLPY = re.compile(
    r".*/rclpy/service\.py:\d+: RuntimeWarning: failed to send response|\s+self\.__service\.service_send_response\("
)
_LOG_LINE = re.compile(r"\[(DEBUG|INFO|WARN|ERROR|FATAL)\] \[([^\]]*)\]: (.*)")


@dataclass(frozen=True)
class Program:
    """A program to start.

    Attributes:
        name: the name of the `Executable`.
        command: the command that starts it in a box.
        environ: the environment of the overlay; settings of ROS are added.
        parameters: such as `period:=1.0`, given by `--ros-args`.
        takes_arguments: whether it understands `--ros-args`; `ros2 launch` does not.
        enclave: the enclave that its nodes report, such as `/program_1`; empty if it does not matter whose
            they are.
        keys: the lines that are typed for it, if it has a keyboard.
        setting: the setting of a Run in which it is alone; if empty, its parameters, or `alone`.
        has_clock: whether it does something else on the real clock than on one that is stepped; then none is
            stepped.
    """

    name: str
    command: Sequence[str | Path]
    environ: Mapping[str, str] = field(default_factory=dict)
    parameters: Sequence[str] = ()
    takes_arguments: bool = True
    enclave: str = ""
    keys: Sequence[str] = ()
    setting: str = ""
    has_clock: bool = False

    def words(self, *, is_stepped: bool) -> list[str | Path]:
        """Return the command that starts it; its nodes follow `/clock` if that `is_stepped`."""
        given = [
            *(("--enclave", self.enclave) if self.enclave else ()),
            *(("-p", "use_sim_time:=true") if is_stepped else ()),
            *(word for parameter in self.parameters for word in ("-p", parameter)),
        ]
        return [*self.command, *(("--ros-args", *given) if given and self.takes_arguments else ())]


def on_the_real_clock(why: str) -> str:
    """Return the note that programs were watched on the real clock, with the reason as a sentence."""
    return f"It was watched on the real clock, which costs nothing: {why}"


class Job:
    """Programs to watch once: a Run in the making.

    Args:
        programs: the programs to start; they receive each other's messages.
        setting: the setting of the Run.
        has_commands: whether commands are published.
        is_stepped: whether the programs follow a stepped clock.
        is_brief: whether it is already known what they do alone.
        contents: what their code compares, by topic, if they are given what they may wait for; else None.
        nodes: how many nodes to wait for; 0 if each program has at least one.
        is_shared: whether to tell apart what each program does. If that cannot be done, because a program has
            ended or does not follow the clock, the job is given up.
        is_again: whether the commands are sent again, while some of the programs have other parameters.
    """

    def __init__(
        self,
        programs: Sequence[Program],
        setting: str,
        *,
        has_commands: bool = True,
        is_stepped: bool = True,
        is_brief: bool = False,
        contents: Contents | None = None,
        nodes: int = 0,
        is_shared: bool = False,
        is_again: bool = False,
    ) -> None:
        self.programs = [
            replace(program, enclave=f"/program_{number}") if is_shared else program
            for number, program in enumerate(programs)
        ]
        self.setting = setting
        self.is_stepped = is_stepped and not any(program.has_clock for program in programs)
        self.is_shared = is_shared
        self.is_again = is_again
        self.plan = {
            "programs": len(programs),
            "enclaves": [program.enclave for program in self.programs if is_shared],
            "nodes": nodes,
            "has_commands": has_commands,
            "is_brief": is_brief,
            "is_again": is_again,
            "contents": contents,
            "has_keys": any(program.keys for program in self.programs),
        }
        is_told = is_stepped and not self.is_stepped
        self.notes = [on_the_real_clock(OTHERWISE)] if is_told else list[str]()
        self.seconds = math.inf  # that it may take on one clock
        self.unfinished = ""
        # What was seen before it was watched on the real clock.
        self.parameters: dict[str, dict[str, Any]] = {}
        self.result: dict[str, Any] = {}
        self.begin(0)

    @classmethod
    def alone(cls, program: Program, *, has_commands: bool = True, is_stepped: bool = True) -> Job:
        """Watch a program by itself; the setting is `alone`, or its parameters."""
        return cls([program], _setting(program), has_commands=has_commands, is_stepped=is_stepped)

    @classmethod
    def untold(cls, programs: Sequence[Program]) -> Job:
        """Watch programs together as `ros2 run` starts them, on the real clock, and say few commands."""
        return cls(programs, UNTOLD, is_stepped=False, is_again=True)

    @classmethod
    def together(cls, programs: Sequence[Program]) -> Job:
        """Watch programs together, briefly: what each does alone is known."""
        return cls(programs, "together", is_brief=True)

    @classmethod
    def given(cls, programs: Sequence[Program], contents: Contents) -> Job:
        """Watch programs together, on the real clock: while they are given what they may wait for, and then on commands."""
        willing = [replace(one, environ={**one.environ, SAYS_YES: "1"}) for one in programs]
        return cls(willing, GIVEN, is_stepped=False, contents=contents)

    @classmethod
    def shared(cls, programs: Sequence[Program], *, has_commands: bool = True) -> Job:
        """Watch programs together, so that `shares` can tell what each of them does."""
        return cls(programs, "together", has_commands=has_commands, is_shared=True)

    @classmethod
    def again(cls, programs: Sequence[Program], changed: Sequence[Program]) -> Job:
        """Watch programs together, some of them with other parameters, and send the commands again.

        It shows what each of these does, as `shared` would, and what all of them do, as `together` would.
        """
        others = {
            (program.name, *program.command): program for program in changed
        }  # two programs may have the same name
        programs = [others.get((program.name, *program.command), program) for program in programs]
        return cls(programs, "together", is_shared=True, is_again=True)

    def apart(self) -> list[Job]:
        """Return the separate jobs that show what a shared job without commands is meant to show."""
        changed = [program for program in self.programs if program.parameters or not self.is_again]
        jobs = [Job.alone(program, has_commands=False) for program in changed]
        plain = [replace(program, parameters=()) for program in self.programs]
        return [*jobs, *([Job.together(plain)] if self.is_again else [])]

    @classmethod
    def launched(
        cls, program: Program, nodes: int, *, has_commands: bool = True, is_brief: bool = False
    ) -> Job:
        """Watch what a launch command, such as `ros2 launch`, starts, on the real clock."""
        launch = replace(program, takes_arguments=False)
        return cls(
            [launch], "launched", has_commands=has_commands, is_stepped=False, is_brief=is_brief, nodes=nodes
        )

    def begin(self, number: int) -> None:
        """Forget what was seen before."""
        self.number = number
        self.domain = next(DOMAINS)
        self.alive = 0
        self.since = time.monotonic()
        self.interrupted_at = 0.0
        self.is_released = False
        self.killed: set[str] = set()  # by the grader, not ended by themselves
        self.boxes: dict[str, Box] = {}
        self.keyboards: list[Keyboard] = []
        self.marks: dict[int, dict[str, int]] = {}
        self.ended: dict[str, str] = {}
        self.early: set[str] = set()  # those that ended before any command
        self.done: set[str] = set()  # those that ended without an error
        self.stopped: dict[str, dict[str, Any]] = {}
        self.said: dict[str, int] = {}  # how much each had printed at Ctrl-C

    def keyboard(self, program: Program) -> int | None:
        """Return the file descriptor that a program reads its keys from; None if it has no keyboard."""
        if not program.keys:
            return None
        self.keyboards.append(Keyboard(program.keys))
        return self.keyboards[-1].stdin

    def neighbours(self, number: int) -> Neighbours | None:
        """Return the neighbours of a program, by its number; None if it is alone, or has a keyboard."""
        if len(self.programs) == 1 or self.programs[number].keys:
            return None
        commands = [program.command for program in self.programs]
        return Neighbours(commands[:number], commands[number + 1 :])

    def show_neighbours(self) -> None:
        """Show each program all others in its list of processes."""
        for box in self.boxes.values():
            box.show_neighbours()

    def type(self) -> None:
        """Type a line at each keyboard whose last line was read."""
        for keyboard in self.keyboards:
            keyboard.type()

    def look(self) -> bool:
        """Note which programs have ended; return whether one has ended since the last look."""
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
                self.done |= {name} if box.code == 0 and not box.cut else set()
                if not self.marks:
                    self.early.add(name)
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
        for keyboard in self.keyboards:
            keyboard.close()

    def run(self) -> Run:
        """Return what was seen as a `Run`."""
        run = self._run(self.result, [program.name for program in self.programs], self.setting)
        if not self.is_again:
            return run
        changed = {program.enclave: program.name for program in self.programs if program.parameters}
        homes = self.result.get("enclaves", {})
        own = {
            node: values
            for node, values in run.parameters.items()
            if changed.keys().isdisjoint(homes.get(node, ()))
        }
        return replace(run, parameters=own, changed=sorted(changed.values()))

    def shares(self) -> list[Run]:
        """Return what each program did, as if it had been alone; empty if that cannot be told."""
        is_open = self.ended or self.notes or self.unfinished or not self.result
        if not self.is_shared or not self.is_stepped or is_open:
            return []
        shares = shared_out(self.result, [program.enclave for program in self.programs])
        runs = [
            (program, self._run(seen, [program.name], _setting(program)))
            for seen, program in zip(shares, self.programs, strict=bool(shares))
        ]
        if self.is_again:
            return [replace(run, commands=[], calls=[]) for program, run in runs if program.parameters]
        return [run for _, run in runs]

    def _run(self, seen: Mapping[str, Any], names: Sequence[str], setting: str) -> Run:
        """Return what was seen of the programs with some names."""
        return Run(
            programs=list(names),
            setting=setting,
            clock="stepped" if self.is_stepped else "real",
            nodes=seen.get("nodes", []),
            publishes=seen.get("publishes", {}),
            subscribes=seen.get("subscribes", {}),
            qos=seen.get("qos", {}),
            parameters=self._parameters(seen.get("parameters", {})),
            quiet=_heard(seen.get("quiet", {})),
            commands=[self._command(command, names) for command in seen.get("commands", [])],
            ended={
                name: last for name, last in self.ended.items() if name in names and name not in self.killed
            },
            early=sorted(self.early.intersection(names) - self.killed),
            done=sorted(self.done.intersection(names) - self.killed),
            stopped={
                name: {**how, "last": seen.get("final", {})}
                for name, how in self.stopped.items()
                if name in names
            },
            notes=[*self.notes, *seen.get("notes", [])],
            log=self._log(seen.get("log", []), 1, names),
            twins=seen.get("twins", []),
            stalled=seen.get("stalled", []),
            services=seen.get("services", {}),
            waits=seen.get("waits", []),
            given=seen.get("given", []),
            gave=seen.get("gave", {}),
            ungiven=seen.get("ungiven", {}),
            meanwhile=_heard(seen.get("meanwhile", {})),
            handed_on=seen.get("handed_on", []),
            commanded=seen.get("commanded", ""),
            clocked=seen.get("clocked", []),
            unfinished=self.unfinished,
            typed=[line for keyboard in self.keyboards for line in keyboard.typed],
            calls=[
                ServiceCall(**{**call, "topics": _heard(call["topics"])}) for call in seen.get("calls", [])
            ],
        )

    def _parameters(self, seen: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
        """Return the parameters by node; one that sleeps may have answered only while the clock stood."""
        before = {name: values for name, values in self.parameters.items() if not seen.get(name)}
        return dict(sorted({**seen, **before}.items()))

    def _command(self, seen: Mapping[str, Any], names: Sequence[str]) -> CommandSeen:
        return CommandSeen(
            text=seen["text"],
            log=self._log(seen["log"], seen["mark"], names),
            topics=_heard(seen["topics"]),
            parameters=seen["parameters"],
            is_alive=seen["alive"] == len(self.programs),
            anew=seen.get("anew", []),
        )

    def _log(self, lines: Sequence[Sequence[str]], mark: int, names: Sequence[str]) -> list[list[str]]:
        """Return log lines, and other lines that programs printed before a mark."""
        known = {(level, name, seen_of(text)) for level, name, whole in lines for text in whole.splitlines()}
        log = [[level, text[:LINE]] for level, _, text in lines]
        log += [["PRINT", line] for line in self._printed(mark, names) if not _is_known(line, known)]
        if len(log) > LINES:  # repeated lines leave room for the rest
            log = [[level, text] for level, text in dict.fromkeys((level, text) for level, text in log)]
        return log[:LINES]

    def _printed(self, mark: int, names: Sequence[str]) -> list[str]:
        """Return the lines that programs printed between the previous mark and this one."""
        before, after = self.marks.get(mark - 1, {}), self.marks.get(mark, {})
        return [
            line[:LINE]
            for name in names
            if name in self.boxes
            for line in _whole_lines(self.boxes[name].output, before.get(name, 0), after.get(name, 0))
            if line.strip() and not _OF_RCLPY.match(line)
        ]


def _setting(program: Program) -> str:
    return program.setting or " ".join(program.parameters) or "alone"


def _whole_lines(output: str, begin: int, end: int) -> list[str]:
    """Return the lines of a part of an output; a line that goes on after it belongs to the next part."""
    begin = output.rfind("\n", 0, begin) + 1
    if end < len(output):
        end = output.rfind("\n", 0, end) + 1
    return output[begin:end].splitlines()


def _is_known(line: str, known: set[tuple[str, str, str]]) -> bool:
    """Return whether a printed line is a log line that was received."""
    match = _LOG_LINE.search(line)  # what a program asks at a keyboard may stand before it
    level, name, text = match.groups() if match else ("", "", line)
    return (level, name, seen_of(text)) in known or any(seen_of(line) == said for *_, said in known)


def _heard(topics: dict[str, Any]) -> dict[str, Heard]:
    return {topic: Heard(**heard) for topic, heard in topics.items()}


def _last_lines(text: str) -> str:
    """Return the end of an output, with the causes of an error in it that stand above; never as a limit's own sentence."""
    lines = [line[:LINE] for line in without_ignored(text.strip().splitlines())]
    first = max(0, len(lines) - 10)
    is_error = any(line.startswith('  File "') for line in lines[first:])
    links = [number for number, line in enumerate(lines) if is_error and line.startswith(_OF_CAUSE)]
    above = {n for link in links[-MOST_CAUSES:] for n in range(max(0, link - 6), min(link + 1, first))}
    said = "\n".join(lines[number] for number in (*sorted(above), *range(first, len(lines))))
    return f"It said: {said}" if is_limit(said) else said
