"""All programs of a workspace, run together and told each command: what a hand-in and the demonstration see."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from ros2lab import assignments
from ros2lab.assignments import Assignment, Part
from ros2lab.grading.senses import is_still
from ros2lab.grading.watching.ear import plain
from ros2lab.observed_domain import ObservedDomain
from ros2lab.run_record import RunRecord

START_TIMEOUT = 20.0  # s, for programs to start and to find each other
REACTION_TIMEOUT = 5.0  # s, for a robot to do what a command says
LASTING = 0.5  # s after that, in which it is seen whether it lasts
OBSERVED = 8.0  # s, in which a message every 2.4 s comes three times
ENOUGH = 4  # messages of each topic that has a period, after which it is known


def script(part: Part) -> tuple[str, ...]:
    """Return what is said: each command, from the state after the first one, and nonsense in two states."""
    first, *others = part.commands
    words = [first, *part.unknown]
    for number, other in enumerate(others):
        words += [other, *(part.unknown if not number else ()), first]
    return tuple(words)


class Rehearsal:
    """Programs that run together in a domain of their own.

    Args:
        domain: in which they run, and nobody else.
        commands: what starts each of them, by name.
        environ: their environment.

    Attributes:
        assignment: the course's.
        programs: by name.
        record: what is seen of them.
    """

    def __init__(
        self, domain: ObservedDomain, commands: Mapping[str, Sequence[str]], environ: Mapping[str, str]
    ) -> None:
        self.assignment: Assignment = assignments.load()
        self._domain = domain
        self.programs = {name: domain.start(name, words, environ) for name, words in commands.items()}
        domain.wait(self._is_complete, START_TIMEOUT * bool(self.programs))
        self.record = RunRecord(domain, [*self.programs.values()], "together")
        self.record.listen()

    def play(self, seconds: float = OBSERVED, tell: Callable[[str], None] = lambda _: None) -> None:
        """Watch the programs for a while, and then say each word of the script.

        Args:
            seconds: how long they are watched, at most.
            tell: takes a line of progress.
        """
        if not self.programs:
            return
        periodic = [part.topic for part in self.assignment.parts.values() if part.period]
        tell(f"Measuring the period of {', '.join(periodic)} ...")
        self._domain.wait(lambda: all(self._count(topic) >= ENOUGH for topic in periodic), seconds)
        part = self.assignment.commanded
        topic = part.topic if part else ""
        for word in script(part) if part else ():
            tell(f"Sending {word!r} ...")
            self.record.begin(word, topic)
            self._domain.say(topic, word)
            self._domain.wait(lambda: self._is_obeyed(word), REACTION_TIMEOUT)  # noqa: B023
            self._domain.wait(lambda: False, LASTING)
        self.record.listen()

    def _is_complete(self) -> bool:
        ends = {"publisher": self._domain.published(), "subscription": self._domain.subscribed()}
        parts = [part for part in self.assignment.parts.values() if part.end in ends]
        return all(part.topic in ends[part.end] for part in parts) or not any(
            program.is_running for program in self.programs.values()
        )

    def _count(self, topic: str) -> int:
        log = self.record.logs.get(topic)
        return log.count if log else 0

    def _is_obeyed(self, word: str) -> bool:
        """Return whether the robot does what a word says, if it says anything."""
        commanded = self.assignment.commanded
        effects = dict(zip(commanded.commands, commanded.effects, strict=True)) if commanded else {}
        effect = effects.get(word, "any")
        if effect == "any":
            return True
        self.record.listen()
        logs = [self.record.logs.get(part.topic) for part in moved_parts(self.assignment)]
        latest = [log.latest for log in logs if log]
        stands = all(sample is None or is_still(plain(sample.message)) for sample in latest)
        return stands is (effect == "still")


def moved_parts(assignment: Assignment) -> list[Part]:
    """Return the parts that publish how the robot moves: of whose messages the type alone tells."""
    parts = assignment.parts.values()
    return [part for part in parts if part.is_publisher and not part.period and assignment.is_only(part)]
