"""From what was handed in to `Evidence`: receive it, read it, build it, watch it, and run its own tests."""

from __future__ import annotations

import importlib.metadata
import itertools
import platform
import re
import subprocess
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path, PurePosixPath
from typing import Any

from ros2lab import __version__, assignments
from ros2lab.assignments import Assignment, Part
from ros2lab.grading import open_world, reading, readme
from ros2lab.grading.build import build
from ros2lab.grading.clean_copy import SubmissionError
from ros2lab.grading.evidence import SCHEMA, Build, Evidence, Executable, Files, Run
from ros2lab.grading.job import Job, Program
from ros2lab.grading.notes import Note
from ros2lab.grading.observe import SHOWN, Observer
from ros2lab.grading.open_world import OpenWorld
from ros2lab.grading.own_tests import OwnTests
from ros2lab.grading.players import RATE, is_done, is_timers
from ros2lab.grading.questions.parameters import setting
from ros2lab.grading.questions.publisher import is_still
from ros2lab.grading.sandbox import FILES, World
from ros2lab.grading.scratch import scratch_folder
from ros2lab.grading.submission import Submission, copied

MOST_LAUNCH_FILES = 3
MOST_PARAMETERS = 4  # that are changed to see what follows
DOUBTFUL = 1.4  # s or Hz, where the value of a timer's parameter is not known

# What rclpy says of a float field that is given something else, if it is told to check.
_REFUSED = re.compile(r"AssertionError: The '\w+' field must be of type 'float'")
CAUGHT = "an AssertionError that it catches"

Show = Callable[[str], None]


def collect(
    path: Path,
    show: Show = lambda _step: None,
    keep: Path | None = None,
    *,
    assignment: Assignment | None = None,
    has_sandbox: bool = True,
) -> Evidence:
    """Find out all that is to be known of a submission.

    Args:
        path: what was handed in: a folder, a zip or a tar.
        show: told what is being done.
        keep: a folder, made if it is not there, in which a copy of what was received stays.
        assignment: for which it was handed in; None takes the course's own.
        has_sandbox: False lets it do whatever the user who grades can.

    Returns:
        The evidence; also of something in which there is nothing to grade.

    Raises:
        SubmissionError: if nothing can be received.
        SandboxMissing: if this machine cannot run it safely.
        RuntimeError: if colcon or ROS cannot be used.
    """
    assignment = assignment or assignments.load()
    seconds: dict[str, float] = {}
    start = time.monotonic()
    with _folder(keep) as root:
        with _timed(seconds, "unpack"):
            show("unpacking")
            received = copied(path, root)
        with _world(root, has_sandbox=has_sandbox) as world:
            with _timed(seconds, "unpack"):
                show("reading")
                found = reading.read(world, received, assignment)
            submission, facts = found.submission, found.files
            built, runs, tests = None, list[Run](), dict[str, Any]()
            if submission.form != "nothing":
                # The observer starts while others work.
                with Observer(world, assignment) as observer:
                    with _timed(seconds, "build"):
                        show("building")
                        built = build(world, submission, found.plan)
                    with _timed(seconds, "observe"):
                        show("watching")
                        runs = watch(observer, submission, facts, built, show)
                        if facts.tests and submission.package:
                            show("running its tests")
                            tests = OwnTests(root, submission.package.folder, facts.tests).run(world, built)
        if built:
            commands = readme.commands(facts.readme, submission, built, runs)
            said = [built.error, *(text for run in runs for text in run.ended.values())]
            texts = [text for text in dict.fromkeys(said) if text]
            folder = submission.package.folder if submission.package else ""
            if texts:
                with _world(root, has_sandbox=has_sandbox) as untouched:  # by what has run
                    explained = reading.explained(untouched, folder, texts)
                facts = replace(facts, findings=[*facts.findings, *explained])
            facts = replace(facts, readme_commands=commands)
    seconds["total"] = time.monotonic() - start
    return Evidence(
        schema=SCHEMA,
        assignment=assignment.name,
        name=path.absolute().name,
        submission=submission,
        files=facts,
        build=built,
        runs=runs,
        tests=tests,
        seconds={name: round(value, 2) for name, value in seconds.items()},
        sandbox=_bubblewrap_version() if has_sandbox else open_world.NAME,
        versions=_versions(),
    )


def nothing(path: Path, note: str, assignment: Assignment | None = None) -> Evidence:
    """Return the evidence of what could not be received.

    Args:
        path: what was handed in.
        note: why it could not.
        assignment: for which it was handed in; None takes the course's own.
    """
    return Evidence(
        schema=SCHEMA,
        assignment=(assignment or assignments.load()).name,
        name=path.absolute().name,
        submission=Submission("nothing", None, [], None, [], [Note("refused", detail=note)]),
        files=Files(),
        build=None,
        runs=[],
        tests={},
        seconds={},
        sandbox="",
        versions=_versions(),
    )


def watch(
    observer: Observer, submission: Submission, facts: Files, built: Build, show: Show = lambda _step: None
) -> list[Run]:
    """Watch each program alone, what launch files start, and each timer with another parameter.

    All programs are watched together where some part of the assignment was not yet seen to work.

    Args:
        observer: in the World in which it was built.
        submission: what was handed in.
        facts: of its files.
        built: what came of the build.
        show: told what is being done.
    """
    programs = [_program(one, built) for one in built.executables if one.command]
    launches = [*_launches(submission, facts, built)] if built.is_built else []
    if not programs and not launches:
        return []
    whole = Job.shared(programs)
    together = observer.watch([whole]) if len(programs) > 1 else []
    runs = whole.shares()
    is_shared = bool(runs) and _is_complete(observer.assignment, together)
    if is_shared:
        runs += together
    else:  # what one does that the others keep from working is seen where it is alone
        show("watching each alone")
        runs = observer.watch([Job.alone(program) for program in programs])
    refused = _refused(observer.assignment, facts, runs)
    if refused:
        show("watching again what is refused in the lab")
        again = observer.watch([Job.alone(one) for one in _unchecked(programs) if one.name in refused])
        watched = {
            run.programs[0]: run
            for run in again
            if refused[run.programs[0]] != CAUGHT or not _is_mute(observer.assignment, run)
        }
        if watched:
            programs, launches = _unchecked(programs), _unchecked(launches)
            whole.result = {}
        runs = [
            replace(watched[name], refused=refused[name]) if (name := run.programs[0]) in watched else run
            for run in runs
        ]
    nodes = len({node for run in runs for node in run.nodes})
    if not is_shared and whole.result:
        runs += together
    # Where all programs are quick to answer it costs next to nothing to see them obey together.
    is_known = _is_complete(observer.assignment, runs)
    has_commands = not is_known or all(run.clock == "stepped" for run in runs)
    asked = [*_asked(observer.assignment, programs, runs)]
    tried = [one for one in _changed(programs, runs, facts) if one not in asked]
    changed = [*asked, *tried[:MOST_PARAMETERS]]
    jobs = [Job.launched(launch, nodes, has_commands=has_commands, is_brief=is_known) for launch in launches]
    if is_shared:
        jobs += [Job.shared(group, has_commands=False) for group in _groups(changed)]
    else:
        jobs += [Job.alone(program, has_commands=False) for program in changed]
    anew = [Job.together(programs)] if len(programs) > 1 and not whole.result else []
    if not is_known and not launches:
        jobs += anew  # at once: no launch file starts them
    if jobs:
        show("watching them together, and with changed parameters")
    runs += _watched(observer, jobs)
    # What a launch file starts counts only for what the executables do without it.
    parts = observer.assignment.parts.values()
    is_done_without = all(any(is_done(part, r) for r in runs if r.setting != "launched") for part in parts)
    if launches and not (is_done_without and _is_complete(observer.assignment, runs)):
        show("watching them without the launch files")
        runs += observer.watch(anew)
    return runs


def _groups(programs: Iterable[Program]) -> list[list[Program]]:
    """Return programs in groups, in each of which none is twice."""
    groups: list[list[Program]] = []
    for program in programs:
        free = (group for group in groups if all(other.name != program.name for other in group))
        group = next(free, None)
        if group is None:
            groups.append(group := [])
        group.append(program)
    return groups


def _watched(observer: Observer, jobs: Sequence[Job]) -> list[Run]:
    """Watch as jobs say, and the programs of a shared one each alone, where it cannot be told what each does."""
    runs, open_ones = list[Run](), list[Program]()
    for job, run in zip(jobs, observer.watch(jobs), strict=True):
        shares = job.shares()
        runs += shares or ([] if job.is_shared else [run])
        open_ones += job.programs if job.is_shared and not shares else []
    return runs + observer.watch([Job.alone(program, has_commands=False) for program in open_ones])


@contextmanager
def _folder(keep: Path | None) -> Iterator[Path]:
    if keep is not None:
        keep.mkdir(parents=True, exist_ok=True)
        yield keep
        return
    with scratch_folder() as scratch:
        yield scratch


def _world(root: Path, *, has_sandbox: bool) -> World:
    make = World if has_sandbox else OpenWorld
    try:
        return make(root, shown=SHOWN)
    except ValueError as error:
        raise SubmissionError(str(error)) from None


@contextmanager
def _timed(seconds: dict[str, float], name: str) -> Iterator[None]:
    start = time.monotonic()
    yield
    seconds[name] = seconds.get(name, 0.0) + time.monotonic() - start


def _program(executable: Executable, built: Build) -> Program:
    return Program(executable.name, executable.command, built.environ)


def _refused(assignment: Assignment, facts: Files, runs: Sequence[Run]) -> dict[str, str]:
    """Return by program what the lab's check of fields has ended it with, or what has kept it from publishing."""
    ended = {name: said for run in runs for name, said in run.ended.items() if _REFUSED.search(said)}
    may_catch = bool(facts.handlers.get("wholesale"))
    return {run.programs[0]: CAUGHT for run in runs if may_catch and _is_mute(assignment, run)} | ended


def _is_mute(assignment: Assignment, run: Run) -> bool:
    """Return whether a program publishes what no other part has the type of, and none came."""
    types = {
        part.type_name for part in assignment.parts.values() if part.is_publisher and assignment.is_only(part)
    }
    topics = {
        topic for topic, nodes in run.publishes.items() if any(types & {*kinds} for kinds in nodes.values())
    }
    heard = {*run.quiet, *(topic for command in run.commands for topic in command.topics)}
    return bool(topics) and not topics & heard


def _unchecked(programs: Iterable[Program]) -> list[Program]:
    """Return programs as they are outside the lab, where a float field takes an int, and makes 5e-324 of it."""
    return [replace(one, environ={**one.environ, "ROS_PYTHON_CHECK_FIELDS": "0"}) for one in programs]


def _launches(submission: Submission, facts: Files, built: Build) -> Iterator[Program]:
    """Yield `ros2 launch` for each launch file, as installed, or by its path if it was not installed."""
    for path in facts.launch_files[:MOST_LAUNCH_FILES]:
        name, owner = PurePosixPath(path).name, _owner(submission, path)
        is_installed = owner and any(PurePosixPath(shared).name == name for shared in built.shared)
        words = [owner, name] if is_installed else [f"{FILES}/{path}"]
        yield Program(name, ["ros2", "launch", *words], built.environ)


def _owner(submission: Submission, path: str) -> str:
    """Return the name of the package in which a file lies; empty if it lies in none."""
    owners = [one for one in submission.packages if PurePosixPath(one.folder) in PurePosixPath(path).parents]
    return max(owners, key=lambda one: len(one.folder)).name or "" if owners else ""


def _is_complete(assignment: Assignment, runs: Sequence[Run]) -> bool:
    """Return whether every part of the assignment was seen to work in some run."""
    return all(any(_is_at_work(part, run) for run in runs) for part in assignment.parts.values())


def _is_at_work(part: Part, run: Run) -> bool:
    """Return whether a part was seen to work in a run: so often that its period can be told, or so that it moves."""
    if part.end == "service":
        return any(call.service == part.topic and call.response is not None for call in run.calls)
    if not part.is_publisher:
        return any(command.log or command.topics for command in run.commands)
    stretches = [
        run.quiet,
        *(call.topics for call in run.calls),
        *(command.topics for command in run.commands),
    ]
    if part.when:
        return any(part.topic in topics for topics in stretches)
    if part.period:
        return sum(topics[part.topic].count for topics in stretches if part.topic in topics) > 1
    heard = (heard for topics in stretches for heard in topics.values() if heard.type_name == part.type_name)
    return any(not is_still(value) for one in heard for value in one.values)


def _changed(programs: Sequence[Program], runs: Sequence[Run], facts: Files) -> Iterator[Program]:
    """Yield programs with another value for a parameter that seems to be a timer's; if none does, for any number.

    A program that does not spin does not answer what parameters it has; those that the code declares are tried on it.
    """
    by_name = {program.name: program for program in programs}
    numbers = {
        (run.programs[0], name): number
        for run in runs
        if run.setting == "alone"
        for values in run.parameters.values()
        for name, value in values.items()
        if (number := _positive(value))
    }
    timers = {key: value for key, value in numbers.items() if is_timers(key[1])}
    answered = {name for _, name in numbers}
    timers |= {
        (run.programs[0], name): _positive(value) or DOUBTFUL
        for run in runs
        for name, value in facts.declared.items()
        if run.unasked and is_timers(name) and name not in answered
    }
    for (program, name), value in (timers or numbers).items():
        yield replace(
            by_name[program], parameters=[f"{name}:={_other(value, is_rate=bool(RATE.search(name)))}"]
        )


def _asked(assignment: Assignment, programs: Sequence[Program], runs: Sequence[Run]) -> Iterator[Program]:
    """Yield programs with another value for each parameter that the assignment asks for.

    Where it is to change messages, they are also started with the value that it has: what differs then, too, is chance.
    """
    by_name = {program.name: program for program in programs}
    wanted = [parameter for part in assignment.parts.values() for parameter in part.parameters]
    for run, parameter in itertools.product(runs, wanted):
        if run.setting != "alone" or run.programs[0] not in by_name:
            continue
        program = by_name[run.programs[0]]
        held = [values[parameter.name] for values in run.parameters.values() if parameter.name in values]
        if held or run.unasked:
            yield replace(program, parameters=[setting(parameter.name, parameter.value, held[:1])])
        if held and parameter.changes == "message":
            yield replace(program, parameters=[setting(parameter.name, held[0])])


def _positive(value: Any) -> float:
    """Return a number that is above zero, as it is; 0 for anything else."""
    return value if isinstance(value, (int, float)) and not isinstance(value, bool) and value > 0 else 0


def _other(value: float, *, is_rate: bool) -> float:
    """Return a value with which a timer fires half as often, or twice as often if that would take long to see."""
    is_slow = value <= 1 if is_rate else value >= 1
    if is_slow == is_rate:
        return value * 2
    if isinstance(value, int):
        return value // 2 or 2
    return value / 2


def _bubblewrap_version() -> str:
    said = subprocess.run(["bwrap", "--version"], capture_output=True, text=True, check=False).stdout
    return said.strip() or "none"


def _versions() -> dict[str, str]:
    found = {"ros2lab": __version__, "python": platform.python_version()}
    for name in ("colcon-core", "ros-rclpy"):
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:  # of an installed ROS
            continue
    return found
