"""Decide which programs of a submission are watched together, alone, or with other parameters."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import PurePosixPath

from ros2lab.assignments import Assignment, Part
from ros2lab.grading.evidence import KEYBOARD, TIMED, Build, Executable, Files, Run
from ros2lab.grading.judging.by_type import may_end
from ros2lab.grading.judging.player import is_done, is_for_want, is_timers
from ros2lab.grading.receiving.submission import Submission
from ros2lab.grading.sandbox.worlds import FILES
from ros2lab.grading.senses import is_still
from ros2lab.grading.watching.clocks import otherwise
from ros2lab.grading.watching.job import UNTOLD, Job, Program
from ros2lab.grading.watching.keyboard import Search, answers
from ros2lab.grading.watching.observe import Observer
from ros2lab.grading.watching.other_values import asked, changed, doubtful

MOST_PROGRAMS = 20
MOST_LAUNCH_FILES = 3
MOST_PARAMETERS = 4  # that are changed to see the effect

# rclpy's error for a wrong type in a float field, if its checks are on.
_REFUSED = re.compile(r"AssertionError: The '\w+' field must be of type 'float'")
CAUGHT = "an AssertionError that it catches"

# It also says when a timer begins that will shut down everything, whatever runs then.
_LAUNCH = f"""
import contextlib, runpy, shutil, sys
from launch.actions import RegisterEventHandler, TimerAction
from launch.events import Shutdown

def ends(entity, context):
    condition = getattr(entity, "condition", None)
    if isinstance(entity, RegisterEventHandler) or (condition and not condition.evaluate(context)):
        return False
    inner = [entity.describe_sub_entities(), *(few for _, few in entity.describe_conditional_sub_entities())]
    below = any(ends(one, context) for several in inner for one in several)
    return below or isinstance(getattr(entity, "event", None), Shutdown)

def begin(timer, context, execute=TimerAction.execute):
    with contextlib.suppress(Exception):
        if ends(timer, context):
            print({TIMED!r}, flush=True)
    return execute(timer, context)

TimerAction.execute = begin
sys.argv[0] = shutil.which("ros2")
runpy.run_path(sys.argv[0], run_name="__main__")
"""
LAUNCH = [sys.executable, "-P", "-c", _LAUNCH, "launch"]

Show = Callable[[str], None]


def watch(
    observer: Observer, submission: Submission, facts: Files, built: Build, show: Show = lambda _step: None
) -> list[Run]:
    """Watch a submission's programs: together or alone, as launched, and with changed parameters.

    Args:
        observer: the observer of the World in which it was built.
        submission: what was handed in.
        facts: the facts of its files.
        built: the result of its build.
        show: called with what is being done.
    """
    programs = [
        Program(executable.name, executable.command, built.environ)
        for executable in worth_watching(built.executables, facts, observer.assignment)
    ]
    asking = {executable.name for executable in built.executables if KEYBOARD in executable.absent}
    launches = [*_launches(submission, facts, built)] if built.is_built else []
    if not programs and not launches:
        return []
    lacking = {one.name for one in built.executables if {*one.absent} - {KEYBOARD}}
    watching = _Watching(observer, facts, programs, launches, lacking=lacking, show=show)
    while True:
        watching.each()
        watching.again_unchecked()
        watching.at_a_keyboard(asking)
        watching.launched_and_changed()
        if watching.is_otherwise_on_the_real_clock():
            continue
        watching.changed_otherwise()
        watching.without_launch_files()
        watching.given()
        return watching.runs


def worth_watching(
    executables: Iterable[Executable], facts: Files, assignment: Assignment
) -> list[Executable]:
    """Return the programs that are watched, not too many: first those that play a part by their code."""
    able = [executable for executable in executables if executable.command]
    return sorted(able, key=lambda executable: _lack_of_parts(executable, facts, assignment))[:MOST_PROGRAMS]


def _lack_of_parts(executable: Executable, facts: Files, assignment: Assignment) -> int:
    """Return 0 for a program whose code has a part's topic, 1 for one that may play a part, 2 for any other."""
    modules = {*executable.modules, executable.stem or executable.name}
    ends = [end for end in facts.ends if end.module in modules]
    pairs = [(end, part) for end in ends for part in assignment.parts.values() if may_end(end, part)]
    return 2 - bool(pairs) - any(end.topic == part.topic for end, part in pairs)


class _Watching:
    """The steps of watching a submission, one after the other.

    Attributes:
        runs: the runs so far.
    """

    def __init__(
        self,
        observer: Observer,
        facts: Files,
        programs: Sequence[Program],
        launches: Sequence[Program],
        *,
        lacking: Collection[str],
        show: Show,
    ) -> None:
        self.runs: list[Run] = []
        self._observer, self._facts, self._lacking, self._show = observer, facts, lacking, show
        self._assignment = observer.assignment
        self._programs, self._launches = programs, launches
        self._together: list[Run] = []  # the run of all programs together
        self._is_shared = False  # whether that run tells what each program does
        self._ended: set[str] = set()  # the programs that ended in that run
        self._is_given_up = False  # whether that run was given up
        self._compared: set[str] = set()  # the programs that were compared on both clocks
        self._as_started: list[Run] = []  # runs on the real clock, as `ros2 run` starts programs

    def is_otherwise_on_the_real_clock(self) -> bool:
        """Find the programs that do something else on the real clock; return whether there is a new one."""
        found = {*otherwise(self.runs, self._as_started)}
        self._as_started = []
        self._programs = [
            replace(program, has_clock=program.has_clock or program.name in found)
            for program in self._programs
        ]
        return bool(found)

    def each(self) -> None:
        """Watch each program: among the others, and alone if that leaves something open."""
        self._together, self._is_shared, self._is_given_up = [], False, False
        if len(self._programs) > 1 and not any(program.has_clock for program in self._programs):
            whole = Job.shared(self._programs)
            seen = self._observer.watch([whole])
            self._together, self._ended = seen if whole.result else [], {*whole.ended}
            self._is_given_up = not whole.result
            self.runs = whole.shares()
        self._is_shared = bool(self.runs) and _is_complete(self._assignment, self._together)
        if not self._is_shared:
            self.runs = self._observer.watch([Job.alone(program) for program in self._programs])

    def again_unchecked(self) -> None:
        """Watch programs again as outside the lab, if the lab's checks have stopped them."""
        refused = _refused(self._assignment, self._facts, self.runs)
        if not refused:
            return
        self._show("watching again what is refused in the lab")
        again = self._observer.watch(
            [Job.alone(program) for program in _unchecked(self._programs) if program.name in refused]
        )
        watched = {
            run.programs[0]: replace(run, refused=refused[run.programs[0]])
            for run in again
            if refused[run.programs[0]] != CAUGHT or not _is_mute(self._assignment, run)
        }
        if watched:
            self._programs, self._launches = _unchecked(self._programs), _unchecked(self._launches)
            self._together = []
        self.runs = [watched.get(run.programs[0], run) for run in self.runs]

    def at_a_keyboard(self, asking: Collection[str]) -> None:
        """Watch again, with typed answers, each idle program that reads the keyboard.

        One that ends whatever is typed has not ended for lack of an answer.
        """
        waiting = [run.programs[0] for run in self.runs if {*run.programs} <= {*asking} and _is_idle(run)]
        if not waiting:
            return
        self._show("watching again what reads a keyboard, with answers")
        by_name = {program.name: program for program in self._programs}
        answered, last = dict[str, Run](), dict[str, Run]()
        part = self._assignment.commanded
        lines = answers(self._facts.compared, (*part.commands, *part.unknown) if part else ())
        searches = {name: Search(lines) for name in waiting}
        while asked := [name for name in waiting if name not in answered and searches[name].keys]:
            programs = [replace(by_name[name], keys=searches[name].keys) for name in asked]
            jobs = [
                Job.alone(
                    program, is_stepped=program.name not in last or last[program.name].clock == "stepped"
                )
                for program in programs
            ]
            for program, run in zip(programs, self._observer.watch(jobs), strict=True):
                name = program.name
                if run.ended:
                    searches[name].ended(run.typed)
                else:
                    # Only what was typed is kept: further answers might end it.
                    answered[name], by_name[name] = run, replace(program, keys=run.typed or program.keys)
                last[name] = run
        for name in {*waiting} - answered.keys():
            if not is_for_want(last[name].ended[name]):
                answered[name] = last[name]
        self._programs = [*by_name.values()]
        self.runs = [answered.get(run.programs[0], run) for run in self.runs]

    def launched_and_changed(self) -> None:
        """Watch launch files, programs with changed parameters, and all programs together if still needed."""
        nodes = len({node for run in self.runs for node in run.nodes})
        self.runs += self._together
        # If all programs answer quickly, watching them obey together costs next to nothing.
        is_known = _is_complete(self._assignment, self.runs)
        has_commands = not is_known or all(run.clock == "stepped" for run in self.runs)
        jobs = [
            Job.launched(launch, nodes, has_commands=has_commands, is_brief=is_known)
            for launch in self._launches
        ]
        together = list[Job]()
        if not self._launches:  # no launch file starts them together
            is_commanded = any(run.commands for run in self.runs) or self._is_torn()
            together = [Job.together(self._programs)] if is_commanded else [] if is_known else self._anew()
        wanted = [*asked(self._assignment, self._programs, self.runs)]
        tried = [
            program for program in changed(self._programs, self.runs, self._facts) if program not in wanted
        ]
        varied = [*wanted, *tried[:MOST_PARAMETERS]]
        if not self._is_shared:
            jobs += [Job.alone(program, has_commands=False) for program in varied]
        else:
            groups = _groups(varied)
            if groups and together and not wanted and all(map(_is_timed_otherwise, groups[0])):
                together = [Job.again(self._programs, groups.pop(0))]
            jobs += [Job.shared(group, has_commands=False) for group in groups]
        jobs += together
        jobs += self._to_compare()
        if jobs:
            self._show("watching them with changed parameters, and as they are launched")
        for run in _watched(self._observer, jobs):
            (self._as_started if run.setting == UNTOLD else self.runs).append(run)

    def changed_otherwise(self) -> None:
        """Watch again each program whose period did not follow its parameter.

        It may have a limit on this side of its own value; then it follows on the other side.
        """
        programs = [*doubtful(self._programs, self.runs, self._facts)]
        if programs:
            self._show("watching them with other values of their parameters")
            self.runs += self._observer.watch(
                [Job.alone(program, has_commands=False) for program in programs]
            )

    def without_launch_files(self) -> None:
        """Watch all together if something was seen only when launched.

        A launch file counts only for what the executables do without it.
        """
        is_done_without = all(
            any(is_done(part, run) for run in self.runs if run.setting != "launched")
            for part in self._assignment.parts.values()
        )
        is_open = not (is_done_without and _is_complete(self._assignment, self.runs))
        if self._launches and (is_open or self._is_torn()):
            self._show("watching them without the launch files")
            self.runs += self._observer.watch(self._anew())

    def given(self) -> None:
        """Watch all together once more, and give them what they may wait for, if any seems to wait."""
        is_open = _waited_for(self.runs) or any(program.name in self._lacking for program in self._programs)
        if self._programs and is_open and _is_waiting(self._assignment, self.runs):
            self._show("watching them with what they may wait for")
            self.runs += self._observer.watch([Job.given(self._programs, self._facts.contents)])

    def _to_compare(self) -> list[Job]:
        """Return the jobs that show on the real clock, once, what programs did on the stepped one: together or alone.

        By what code tells the two apart cannot be listed: two timers do, and so do the messages of any other node.
        """
        stepped = {
            run.programs[0] for run in self.runs if run.setting == "alone" and run.clock == "stepped"
        } - self._compared
        self._compared |= stepped
        if not stepped:
            return []
        if self._is_shared:
            return [Job.untold(self._programs)]
        return [Job.untold([program]) for program in self._programs if program.name in stepped]

    def _is_torn(self) -> bool:
        """Return whether a program ended, or lost the stepped clock, only when it ran beside the others."""
        alone = [run for run in self.runs if run.setting == "alone" and not run.ended]
        is_stepped = bool(alone) and all(run.clock == "stepped" for run in alone)
        return (self._is_given_up and is_stepped) or any(run.programs[0] in self._ended for run in alone)

    def _anew(self) -> list[Job]:
        """Return the job of all programs together, if it is still to be done; else an empty list."""
        is_due = len(self._programs) > 1 and not self._together
        return [Job.together(self._programs)] if is_due else []


def _is_timed_otherwise(program: Program) -> bool:
    """Return whether a program has changed parameters for timers only, which do not affect reactions."""
    return all(is_timers(parameter.partition(":=")[0]) for parameter in program.parameters)


def _groups(programs: Iterable[Program]) -> list[list[Program]]:
    """Return programs in groups, none of which has the same program twice."""
    groups: list[list[Program]] = []
    for program in programs:
        free = (group for group in groups if all(member.name != program.name for member in group))
        group = next(free, None)
        if group is None:
            groups.append(group := [])
        group.append(program)
    return groups


def _watched(observer: Observer, jobs: Sequence[Job]) -> list[Run]:
    """Run jobs; run the programs of a shared job apart if it does not tell what each of them does."""
    runs, again = list[Run](), list[Job]()
    for job, run in zip(jobs, observer.watch(jobs), strict=True):
        shares = job.shares()
        is_open = job.is_shared and not shares
        again += job.apart() if is_open else []
        runs += [*shares, *([] if is_open or (job.is_shared and not job.is_again) else [run])]
    return runs + observer.watch(again)


def _is_idle(run: Run) -> bool:
    """Return whether a program was not seen to publish anything or to react to any command."""
    return not run.quiet and not any(
        command.log or command.topics or command.parameters for command in run.commands
    )


def _refused(assignment: Assignment, facts: Files, runs: Sequence[Run]) -> dict[str, str]:
    """Return by program the error of the lab's field checks that ended it or kept it from publishing."""
    ended = {name: said for run in runs for name, said in run.ended.items() if _REFUSED.search(said)}
    may_catch = bool(facts.handlers.get("wholesale"))
    return {run.programs[0]: CAUGHT for run in runs if may_catch and _is_mute(assignment, run)} | ended


def _is_mute(assignment: Assignment, run: Run) -> bool:
    """Return whether a program published nothing on its topics of a type that only one part has."""
    types = {
        part.type_name for part in assignment.parts.values() if part.is_publisher and assignment.is_only(part)
    }
    topics = {
        topic for topic, nodes in run.publishes.items() if any(types & {*kinds} for kinds in nodes.values())
    }
    heard = {*run.quiet, *(topic for command in run.commands for topic in command.topics)}
    return bool(topics) and not topics & heard


def _unchecked(programs: Iterable[Program]) -> list[Program]:
    """Return programs as outside the lab, where a float field takes an int and makes 5e-324 of it."""
    return [
        replace(program, environ={**program.environ, "ROS_PYTHON_CHECK_FIELDS": "0"}) for program in programs
    ]


def _launches(submission: Submission, facts: Files, built: Build) -> Iterator[Program]:
    """Yield a `ros2 launch` program for each launch file: as installed, else by its path."""
    for path in facts.launch_files[:MOST_LAUNCH_FILES]:
        name, owner = PurePosixPath(path).name, _owner(submission, path)
        is_installed = owner and any(PurePosixPath(shared).name == name for shared in built.shared)
        words = [owner, name] if is_installed else [f"{FILES}/{path}"]
        yield Program(name, [*LAUNCH, *words], built.environ)


def _owner(submission: Submission, path: str) -> str:
    """Return the name of the package in which a file lies; empty if it lies in none."""
    owners = [
        package
        for package in submission.packages
        if PurePosixPath(package.folder) in PurePosixPath(path).parents
    ]
    return max(owners, key=lambda package: len(package.folder)).name or "" if owners else ""


def _is_complete(assignment: Assignment, runs: Sequence[Run]) -> bool:
    """Return whether every part of the assignment was seen to work in some run."""
    return all(any(_is_at_work(part, run) for run in runs) for part in assignment.parts.values())


def _is_waiting(assignment: Assignment, runs: Sequence[Run]) -> bool:
    """Return whether a part was not seen to work, or is silent on its own topic: its node may wait for something."""
    parts = assignment.parts.values()
    made = {topic for run in runs for topic in run.publishes}
    silent = made.difference(*(topics for run in runs for topics in run.stretches))
    is_open = any(part.topic in silent if part.is_publisher else _is_deaf(part, runs) for part in parts)
    return is_open or not _is_complete(assignment, runs)


def _waited_for(runs: Sequence[Run]) -> set[str]:
    """Return what nodes wait for, less what others publish that go on."""
    waits = {name for run in runs for name in run.waits}
    return waits.difference(*(run.publishes for run in runs if not run.ended))


def _is_deaf(part: Part, runs: Sequence[Run]) -> bool:
    """Return whether the nodes that take the commands, and something else, never answered one when alone."""
    told = [run for run in runs if run.setting == "alone" and run.commands and part.topic == run.commanded]
    answered = any(
        command.log or command.topics or command.parameters for run in told for command in run.commands
    )
    return not answered and any(run.waits for run in told)


def _is_at_work(part: Part, run: Run) -> bool:
    """Return whether a part was seen to work in a run: often enough for a period, or with a motion."""
    if part.end == "service":
        return any(call.service == part.topic and call.response is not None for call in run.calls)
    if not part.is_publisher:
        return any(command.log or command.topics for command in run.commands)
    if part.when:
        return any(part.topic in topics for topics in run.stretches)
    if part.period:
        return sum(topics[part.topic].count for topics in run.stretches if part.topic in topics) > 1
    heard = (
        heard for topics in run.stretches for heard in topics.values() if heard.type_name == part.type_name
    )
    return any(not is_still(value) for messages in heard for value in messages.values)
