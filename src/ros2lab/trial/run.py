"""Runs the installed programs of a workspace in a domain of their own, watched by the grader's observer.

They are the student's own programs on the student's own machine, so they run unconfined, as with `ros2 run`.
"""

from __future__ import annotations

import contextlib
import itertools
import json
import math
import re
import socket
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from ros2lab import assignments, environment
from ros2lab.assignments import Assignment
from ros2lab.diagnose.finding import Finding, ranked
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.topic_faults import ends_of
from ros2lab.diagnose.packaging.installed import prefix_of
from ros2lab.diagnose.printed.error_text import read_error
from ros2lab.domain_lease import NoDomainError, in_turn, leased
from ros2lab.grading.code.compared import MOST_WORDS, Contents
from ros2lab.grading.evidence import GIVEN, Run
from ros2lab.grading.sandbox.box import Box, Limits
from ros2lab.grading.sandbox.open_world import OpenWorld
from ros2lab.grading.watching.job import Job, Program
from ros2lab.grading.watching.observe import SHOWN, Observer
from ros2lab.grading.watching.quiet import TOO_LITTLE
from ros2lab.scratch import scratch_folder
from ros2lab.trial.ends import UNKNOWN_WORD
from ros2lab.trial.given import GivenRun, given_faults, open_contents, told_of_given
from ros2lab.trial.held_back import with_reasons
from ros2lab.trial.moving import may_move, still_moving
from ros2lab.trial.parameters import is_to_start, parameter_faults, told_of_set
from ros2lab.trial.retold import without_retold
from ros2lab.trial.rivals import rival_faults, told_of_rivals
from ros2lab.trial.seen import Seen, seen_faults
from ros2lab.trial.set_in_vain import set_in_vain
from ros2lab.trial.set_values import compared_words, settings_of, started_with
from ros2lab.trial.spoken import Said, Sent, read_sent
from ros2lab.trial.starts import programs_of
from ros2lab.trial.story import told_of, untried
from ros2lab.trial.unmade import unmade_faults
from ros2lab.trial.witnessed import Witnessed, environ_in, is_contradicted, witnessed
from ros2lab.trial.words import own_words
from ros2lab.workspace import Workspace

_TRACEBACK = "Traceback (most recent call last)"
_CHAINED = re.compile(r"exception(?: occurred)?:\s*\Z")  # the traceback after it belongs to the one before
_BRIEF = {"is_brief": True}
_LONGER = {**_BRIEF, "has_commands": False, "keeps_clock": True, "longer": 30.0}  # s of the stepped clock
_STARTS = 10.0  # s for starts with other parameters
_SPARE = 1.0  # s to wait for a domain for what was not planned


@dataclass(frozen=True)
class Trial:
    """The result of running a workspace's nodes.

    Attributes:
        findings: what is silent or wrong, the likeliest first.
        story: what each program did, in a few sentences, and then what was not reached or never true.
        read: what reading the files has found, without what the run contradicts.
        untried: what was not tried, in a sentence; empty if nothing was run.
    """

    findings: list[Finding]
    story: list[str]
    read: Sequence[Finding] = ()
    untried: str = ""


def try_out(
    root: Path, show: Callable[[str], None] = lambda _step: None, read: Sequence[Finding] = ()
) -> Trial:
    """Run each installed program of a workspace alone, then all of them together, and once more with what they wait for.

    A program in a launch file runs with the names, remappings and parameters given there.

    Args:
        root: the workspace.
        show: called with a sentence about each step.
        read: what reading the files has found, which is not found again.

    Raises:
        WorkspaceError: if nothing was built, or its `setup.bash` cannot be sourced.
    """
    look = Look(root, loads=True)
    environment.remove_dead_shared_memory()
    with scratch_folder() as values:
        programs = programs_of(look, Workspace(root).overlay, values)
        if not programs:
            return Trial([], [_why_none(look)], read)
        show(f"running {', '.join(program.name for program in programs)}")
        seen, noted, (given, ran) = _watched(look, programs)
    environment.remove_dead_shared_memory()  # of nodes that had to be killed
    called = noted.called
    shown = [
        *seen_faults(seen),
        *rival_faults(seen),
        *(fault for run in seen.alone for fault in unmade_faults(seen, run, called)),
    ]
    shown += given_faults(seen, given) if given else ()
    shown += parameter_faults(seen, ran, given, read) if ran else ()
    shown += set_in_vain(look, {run.programs[0]: run for run in seen.alone})
    read = [
        finding
        for finding in read
        if not is_contradicted(finding, look, noted) and finding.place not in noted.told
    ]
    possible = (finding for finding in shown if (noted.ran | noted.done).isdisjoint(finding.never))
    found = [*noted.wrong, *without_retold(possible, read, look)]
    found, others, read = with_reasons(found, read, noted, seen)
    story = [
        *(" ".join((told_of(seen, run, called), *told_of_given(seen, run, given))) for run in seen.alone),
        *told_of_set(seen, ran),
        *told_of_rivals(seen),
        *["See whether this is as it should be:"] * bool(others),
        *(f"{note.cause} ({note.place})" for note in others),
    ]
    # Of a program that is started several times, each start shows the same fault.
    once = {(one.code, one.place or one.cause, one.fix): one for one in reversed(found)}
    return Trial(ranked([*once.values()][::-1]), story, read, untried(seen))


def _watched(look: Look, programs: Sequence[Program]) -> tuple[Seen, Witnessed, list[GivenRun | None]]:
    """Run programs alone and together, and again with what they wait for and nothing brings, and as parameters are set.

    What was noted is of all runs, but the calls, and the conditions that were never true, are of those without anything
    made up: a condition may be about what never comes.
    """
    assignment = _assignment_for(look, own_words(look))
    with (
        scratch_folder() as notes,
        scratch_folder() as more_notes,
        scratch_folder() as longer_notes,
        contextlib.ExitStack() as leases,
    ):
        noting, more = _noting(programs, notes, look), _noting(programs, more_notes, look)
        contents = open_contents(look, assignment.commanded.topic if assignment.commanded else "")
        words = compared_words(look)
        plan = {"has_commands": False, "contents": contents, "settings": words}
        with in_turn() as until:
            jobs = [_OwnJob(leases, [program], until=until) for program in noting]
            jobs += [_OwnJob(leases, noting, plan=_BRIEF, until=until)] if len(programs) > 1 else []
            setting = [] if words is None else _spare(leases, more, plan=plan, until=until)
            filled = _spare(leases, more, contents=contents, until=until) if contents else []
        jobs += filled
        with _OwnMachine(shown=SHOWN) as world, Observer(world, assignment, rooms=len(jobs)) as observer:
            runs = observer.watch([*jobs, *setting])[: len(jobs)]
            before = Seen(look, assignment, runs[: len(programs)], [])
            ran = _set(observer, leases, setting[0], before) if setting else None
            sent = [job.sent(more_notes if job.setting == GIVEN else notes) for job in jobs]
            noted = witnessed(notes, look)
            for place in _asked_again(runs[: len(programs)], sent, noted):
                # With the words that it asked for, which the text of its code does not show.
                if not (again := _spare(leases, [noting[place]])):
                    break
                jobs[place : place + 1] = again
                further = _assignment_for(look, sorted(_unsent(runs[place], noted)))
                with Observer(world, further) as other:
                    runs[place : place + 1] = other.watch(again)
                sent[place] = jobs[place].sent(notes)
                noted = witnessed(notes, look)
            moving, last = None, len(runs) - 1 - len(filled)  # of all programs
            is_open = _is_steppable(runs[last]) and may_move(noted.unreached.record)
            longer = _spare(leases, _noting(programs, longer_notes, look), plan=_LONGER) if is_open else []
            if longer:
                observer.watch(longer)
                if not runs[last].commands:
                    sent[last] = longer[0].sent(longer_notes) or sent[last]
                moving = still_moving(noted.unreached.record, witnessed(longer_notes, look).unreached.record)
        _bring(longer_notes, notes)
        ever = noted = witnessed(notes, look, moving)
        if filled or ran:
            _bring(more_notes, notes)
            ever = witnessed(notes, look, moving)
    usual = runs[: len(runs) - len(filled)]
    first = noted.unreached.record.errors  # whose values are not made up
    later = [error for error in ever.unreached.record.errors if not any(map(error.is_like, first))]
    said = _said(usual, sent, len(programs))
    seen = Seen(look, assignment, usual[: len(programs)], usual[len(programs) :], [*first, *later], said)
    still = {finding.place for finding in (*ever.never, *ever.steady)}
    never, steady = ([one for one in found if one.place in still] for found in (noted.never, noted.steady))
    fatal, when = (jobs[-1].result.get(name, []) for name in ("fatal", "when"))
    noted = replace(ever, never=never, steady=steady, called=noted.called)
    given = GivenRun(runs[-1], fatal, ever.called, sent[-1], when) if filled else None
    return seen, noted, [given, ran]


def _set(observer: Observer, leases: contextlib.ExitStack, job: _OwnJob, seen: Seen) -> GivenRun:
    """Return what came of the parameters that a job has set; where nothing did, also what they do at the start."""
    found, nodes = [*settings_of(job.result)], {run.programs[0]: run.nodes for run in seen.alone}
    plan, tried = {**job.plan, "settings": None, "keeps_clock": True}, dict[int, _OwnJob]()
    start = partial(_spare, leases, plan=plan, is_stepped=job.is_stepped)
    again = start(job.programs)  # shows what differs from start to start
    for number, one in enumerate(found):
        own = [f"{one.name}:={json.dumps(one.value)}"]
        programs = [replace(p, parameters=own) if nodes[p.name] == [one.node] else p for p in job.programs]
        is_worth = bool(again) and programs != job.programs and is_to_start(seen, one)
        for further in start(programs) if is_worth else ():
            tried[number] = further
    observer.watch([*again, *tried.values()] if tried else [], within=_STARTS)
    for number, other in tried.items():
        if again[0].result and other.result and not (again[0].ended or other.ended):
            chance = {change[0] for change in started_with(job.result, again[0].result)}
            changes = [one for one in started_with(job.result, other.result) if one[0] not in chance]
            found[number] = replace(found[number], at_start=changes)
    return GivenRun(job.run(), job.result.get("fatal", []), frozenset(), settings=found)


def _said(runs: Sequence[Run], sent: Sequence[Mapping[str, Any]], count: int) -> Said:
    """Return what programs published by their own notes: of the first `count` runs alone, then of all together."""
    names = [run.programs[0] for run in runs[:count]]
    alone = {name: found.get(name, {}) for name, found in zip(names, sent, strict=False)}
    return Said(alone, sent[count] if count > 1 else {})


def _asked_again(runs: Sequence[Run], sent: Sequence[Mapping[str, Any]], noted: Witnessed) -> list[int]:
    """Return which programs published nothing on a topic, and compared what they were sent with other words."""
    return [
        place
        for place, run in enumerate(runs)
        if run.commands
        and _unsent(run, noted)
        and not {*run.publishes} <= {*sent[place].get(run.programs[0], ())}
    ]


def _unsent(run: Run, noted: Witnessed) -> set[str]:
    """Return the words that something asked for where it was given one that means nothing, and that were not sent."""
    return noted.unreached.record.asked_beside(UNKNOWN_WORD) - {command.text for command in run.commands}


def _is_steppable(run: Run) -> bool:
    """Return whether the clock of a run can be stepped further: programs follow it, as far as that was seen."""
    is_open = any(TOO_LITTLE in note for note in run.notes)
    return (run.clock == "stepped" or is_open) and not run.ended


def _bring(folder: Path, notes: Path) -> None:
    """Put the notes of further runs beside those of others."""
    for path in (folder / "noted").glob("*.json"):
        path.rename(notes / "noted" / path.name)


def _noting(programs: Sequence[Program], folder: Path, look: Look) -> list[Program]:
    """Return the programs such that they note in a folder what their code does."""
    noting = environ_in(folder, look.root, programs[0].environ)
    return [replace(program, environ={**program.environ, **noting}) for program in programs]


def _why_none(look: Look) -> str:
    """Say why no program of a workspace can be run."""
    are_built = bool(look.packages) and all(prefix_of(look.root, package.name) for package in look.packages)
    if are_built and not any(package.setup and package.setup.entry_points for package in look.packages):
        return (
            "No package in this workspace has installed a program, and only installed programs are run here."
        )
    return "No package in this workspace has installed a program; build the workspace, then run this again."


def _assignment_for(look: Look, words: Sequence[str]) -> Assignment:
    """Return the course's assignment, with the workspace's own command topic, and its words or else those of the course."""
    course = assignments.load()
    commanded = course.commanded
    if commanded is None:
        return course
    topics, own = _listened_to(look), words[:MOST_WORDS]
    topic = commanded.topic if commanded.topic in topics or not topics else next(iter(topics))
    # An unknown word comes before each word, for comparison. The words are sent forward and backward, because
    # a word changes nothing in the state that it leads to.
    sent = dict.fromkeys([*own, *(commanded.commands if topic == commanded.topic else ())]) or dict.fromkeys(
        commanded.commands
    )
    commands = tuple(
        itertools.chain.from_iterable((UNKNOWN_WORD, word) for word in [*sent, *[*sent][-2::-1]])
    )
    changed = replace(commanded, topic=topic, commands=commands, effects=(), unknown=())
    return replace(course, parts={**course.parts, commanded.name: changed})


def _listened_to(look: Look) -> dict[str, None]:
    """Return the String topics to which the workspace's nodes subscribe, in the order of the sources."""
    launched = {end.place: name for node in look.launched.values() for end, _, name in node.ends}
    found = dict[str, None]()
    for package in look.packages:
        for end in ends_of(look.sources(package)):
            if not end.is_publisher and end.type == "std_msgs.msg.String":
                found.setdefault(launched.get(end.place) or f"/{end.topic}")
    return found


class _OwnMachine(OpenWorld):
    """A world whose programs can reach each other, but no other machine."""

    def start(
        self,
        command: Sequence[str | Path],
        *,
        environ: Mapping[str, str] | None = None,
        limits: Limits | None = None,
        **more: Any,
    ) -> Box:
        own = {**(environ or {}), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_STATIC_PEERS": ""}
        own.pop("FASTDDS_BUILTIN_TRANSPORTS", None)
        # Linux counts all processes of the user.
        limits = replace(limits or self.limits, processes=1_000_000)
        return super().start(command, environ=own, limits=limits, **more)


class _OwnJob(Job):
    """A job in a domain that nobody else on this machine has."""

    def __init__(
        self,
        leases: contextlib.ExitStack,
        programs: Sequence[Program],
        *,
        plan: Mapping[str, Any] | None = None,
        contents: Contents | None = None,
        is_stepped: bool = True,
        until: float = 0.0,
    ) -> None:
        self._lease = leases.enter_context(contextlib.closing(socket.socket(socket.AF_UNIX)))
        self._own = leased(self._lease, until)
        if contents is None:
            setting = "together" if len(programs) > 1 else "alone"
            super().__init__(programs, setting, is_stepped=is_stepped)
            self.plan |= plan or {}
        else:
            super().__init__(programs, GIVEN, has_commands=False, is_stepped=False, contents=contents)

    def begin(self, number: int) -> None:
        super().begin(number)
        self.domain = self._own

    def sent(self, folder: Path) -> dict[str, dict[str, Sent]]:
        """Return what its programs published by their own notes, by name and topic."""
        return read_sent(folder, str(self.domain), self.interrupted_at or math.inf)

    def run(self) -> Run:
        """Return what was seen, with the complete last output of programs that ended or were stopped."""
        run = super().run()
        ended = {name: self._whole(name, last) for name, last in run.ended.items()}
        stopped = {
            name: {**how, "said": self.boxes[name].output[self.said[name] :]}
            for name, how in run.stopped.items()
        }
        return replace(run, ended=ended, stopped=stopped)

    def _whole(self, name: str, last: str) -> str:
        """Return the last output of a program, from the beginning of its traceback."""
        box = self.boxes[name]
        if box.cut is not None or not read_error(last).reports:
            return last
        printed = box.output.strip()
        begin = printed.rfind(_TRACEBACK)
        while begin > 0 and _CHAINED.search(printed, 0, begin):
            begin = printed.rfind(_TRACEBACK, 0, begin)
        return printed[max(begin, 0) :]


def _spare(
    leases: contextlib.ExitStack, programs: Sequence[Program], until: float = 0.0, **more: Any
) -> list[_OwnJob]:
    """Return a job that tells more of programs which are watched anyway; none if no domain is free for it by then."""
    try:
        return [_OwnJob(leases, programs, until=until or time.monotonic() + _SPARE, **more)]
    except NoDomainError:
        return []
