"""A record of programs in an observed domain: what came before any command and after each, as the grader has it."""

from __future__ import annotations

import itertools
import time
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ros2lab.grading.evidence import Clock, CommandSeen, Heard, Run
from ros2lab.grading.watching.ear import KEPT, plain
from ros2lab.node_process import NodeProcess
from ros2lab.observed_domain import ObservedDomain
from ros2lab.topics import Sample, TopicLog

LOG = "rcl_interfaces/msg/Log"
LEVELS = {10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}


class _Stretch(NamedTuple):
    """A part of a run.

    Attributes:
        text: the command with which it begins; None for the first one.
        begin: when that was, in s of `time.time()`, by which messages say when they were published: one that
            comes late, or by another subscription later, belongs where it was published.
        printed: by program, how much of its output came before.
    """

    text: str | None
    begin: float
    printed: Mapping[str, int]


class RunRecord:
    """What is seen of programs, from now on.

    Args:
        domain: in which they run, and nobody else.
        programs: that run there.
        setting: of the Run, such as `alone`.
        clock: whose time they follow.

    Attributes:
        logs: what comes on each topic that is listened to; None where its type cannot be imported here.
        lines: the log.
    """

    def __init__(
        self, domain: ObservedDomain, programs: Sequence[NodeProcess], setting: str, clock: Clock = "real"
    ) -> None:
        self._domain, self._programs = domain, programs
        self._setting, self._clock = setting, clock
        self._start = time.time()
        self.logs: dict[str, TopicLog | None] = {}
        self._types: dict[str, str] = {}
        self.lines = domain.log("/rosout", LOG)
        self._stretches = [_Stretch(None, 0.0, {})]
        self._commanded = ""
        self._alive: list[bool] = []  # at the end of each stretch

    def listen(self) -> None:
        """Keep what comes on each topic that is published by now."""
        for topic, types in self._domain.published().items():
            if topic not in self.logs:
                self._types[topic] = types[0]
                try:
                    self.logs[topic] = self._domain.log(topic, types[0])
                except (ImportError, ValueError):
                    self.logs[topic] = None

    def begin(self, command: str, topic: str) -> None:
        """Take what is published from now on for what follows a command, which is said next, on a topic."""
        self.listen()
        self._commanded = topic
        self._alive.append(self._are_alive())
        printed = {program.executable: len(program.output) for program in self._programs}
        self._stretches.append(_Stretch(command, time.time(), printed))

    def ends(self) -> dict[str, str]:
        """Return the last words of each program that has ended, by its name."""
        ended = {program.executable: program for program in self._programs if not program.is_running}
        return {name: program.output.strip() or "it said nothing" for name, program in ended.items()}

    def run(self) -> Run:
        """Return what was seen until now."""
        alive = [*self._alive, self._are_alive()]
        topics, logs = self._heard(), self._logged()
        return Run(
            programs=[program.executable for program in self._programs],
            setting=self._setting,
            clock=self._clock,
            nodes=self._domain.nodes(),
            publishes=self._domain.publishers(),
            subscribes=self._domain.subscribers(),
            qos={},
            parameters={},
            quiet=topics[0],
            log=logs[0],
            commands=[
                CommandSeen(stretch.text or "", logs[number], topics[number], {}, alive[number])
                for number, stretch in enumerate(self._stretches)
                if number
            ],
            ended=self.ends(),
            stopped={},
            notes=[],
            commanded=self._commanded,
        )

    def _are_alive(self) -> bool:
        return all(program.is_running for program in self._programs)

    def _number(self, when: float) -> int:
        """Return the number of the stretch in which something was published."""
        return sum(stretch.begin <= when for stretch in self._stretches) - 1

    def _heard(self) -> list[dict[str, Heard]]:
        """Return by stretch what was received on each topic."""
        found: list[dict[str, Heard]] = [{} for _ in self._stretches]
        publishers = self._domain.publishers()
        for topic, log in self.logs.items():
            samples = sorted(log.samples() if log else [], key=lambda sample: sample.published)
            for number, group in itertools.groupby(samples, lambda sample: self._number(sample.published)):
                came = [*group]
                found[number][topic] = Heard(
                    type_name=self._types[topic],
                    node=", ".join(publishers.get(topic, ())),
                    times=[*map(self._time_of, came[:KEPT])],
                    values=[plain(sample.message) for sample in came[:KEPT]],
                    count=len(came),
                )
        return found

    def _time_of(self, sample: Sample) -> float:
        if self._clock == "stepped":
            return self._domain.simulated_at(sample.time)
        return sample.published - self._start

    def _logged(self) -> list[list[list[str]]]:
        """Return by stretch what was logged, and what was printed besides, as [level, text]."""
        found: list[list[list[str]]] = [[] for _ in self._stretches]
        known: set[str] = set()
        for sample in self.lines.samples():
            line = sample.message
            known.update(line.msg.splitlines())
            found[self._number(sample.published)].append([LEVELS.get(line.level, str(line.level)), line.msg])
        for program in self._programs:
            output, name = program.output, program.executable
            begins = [stretch.printed.get(name, 0) for stretch in self._stretches]
            for number, (begin, end) in enumerate(itertools.pairwise([*begins, len(output)])):
                printed = (line for line in output[begin:end].splitlines() if line.strip())
                found[number] += [
                    ["PRINT", line] for line in printed if line.rpartition("]: ")[2] not in known
                ]
        return found
