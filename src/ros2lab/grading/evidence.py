"""What was seen of a submission: plain data, from which alone the rubric gives points.

Everything here can be written as JSON and read back without a loss, so that a grade can be given again without
another run. Times are in s; a run's times count from the moment its nodes were up, on the clock that it follows.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from ros2lab.diagnose.finding import Finding
from ros2lab.grading.senses import sense
from ros2lab.grading.submission import Submission

SCHEMA = 3

Clock = Literal["stepped", "real"]
Way = Literal["installed", "module", "script"]
KEYBOARD = "a keyboard"  # at which nobody sits where it is graded
NO_WORD = "colcon ended without an error, and nothing was installed."  # as the error of a build
GIVEN = "given"  # the setting of a run in which programs receive what they may wait for


@dataclass(frozen=True)
class Place:
    """A line of a file of the submission; line 0 is the file as a whole."""

    file: str
    line: int = 0


@dataclass(frozen=True)
class WrittenEnd:
    """A publisher or a subscription as the code makes it, whether or not it ever runs.

    Attributes:
        topic: with a slash at its beginning; empty if it is not known.
        type_name: such as `std_msgs/msg/String`; empty if it is not known.
        periods: of the timers whose every call publishes on it, in s.
        module: the last part of the name of the module that makes it; empty if it is not known.
        does: what code that runs would do with it, as `deeds` calls it; None if that is not known.
        never: what that code is known not to do with it, though it does something.
        paces: of the timers that alone have something published on it, in s; empty if they are not known.
    """

    topic: str
    type_name: str
    is_publisher: bool
    periods: list[float]
    module: str = ""
    does: list[str] | None = None
    never: list[str] = field(default_factory=list)
    paces: list[float] = field(default_factory=list)


@dataclass(frozen=True)
class Files:
    """What stands in the files, without running anything.

    Attributes:
        manifest: facts of package.xml, each True or False, by their names in `files`; empty without a package.
        setup: the same of setup.py, setup.cfg and the marker.
        sources: how much of the Python code is described: modules, classes and functions, with a docstring or a
            comment each, by kind as [described, all].
        sources_beside: the same of each of the other packages that are graded, which `sources` has, too.
        readme: the README's text, shortened; empty if there is none.
        readme_names: classes, functions and files of the package that it names.
        readme_foreign: names of code in it that nothing handed in has; empty where most of them are there.
        readme_commands: commands in it that name this package's executables, launch files and topics, and whether
            each is true of what was installed and seen; None where that cannot be known.
        readme_misgiven: those of them that give a type, a parameter, an option or an argument that is not so.
        recordings: pictures, films and logs that were handed in, of which some may show the nodes running.
        launch_files: those that start most first; of equals launch files of the package, then of others that launch
            it, then of the folders around it. `Build.shared` tells which are installed.
        launch_lacks: by launch file that includes no other one, what the README gives by `name:=` and it does not name.
        launched_packages: the packages that each launch file names, as far as they are known.
        launched_programs: the executables that each launch file names, itself or by what it includes.
        launch_files_elsewhere: launch files of the other packages of the hand-in.
        parameter_files: parameter files of the same packages, each with its values by node (`/**` for all).
        parameter_file_users: for each parameter file, the launch files that name it, and the modules that do and read
            YAML; empty if that is not known.
        hard_coded: paths of files in the launch files that begin at the root, and lie on one machine only.
        tests: own tests, by file, with the number of test functions.
        tests_left_out: files of own tests that were not run, for they import what is not installed here.
        findings: what `diagnose` found in the files, as [code, cause, place, fix, *about], the most likely first.
        handlers: places where exceptions are caught: `by name`, `wholesale`, or only `of an end`, such as by Ctrl-C.
        compared: the short texts with which the code compares something.
        depended_on: those with which it compares what may come with a message, and by which something is done.
        idle: by file, in which lines functions begin that never run, and assignments that nothing that runs reads.
        ends: the publishers and subscriptions that the code makes.
        ends_elsewhere: what the rest of the hand-in may make besides them, of unknown topics; None if that is not known.
        simulated: the modules that say or ask whether time is simulated.
        declared: the parameters that the code declares, with their defaults; None for one that is not known.
        notes: what was not looked at, and why.
        unread: which of these facts a reader of ours has failed to read, and why; they are empty.
    """

    manifest: dict[str, bool] = field(default_factory=dict)
    setup: dict[str, bool] = field(default_factory=dict)
    sources: dict[str, list[int]] = field(default_factory=dict)
    sources_beside: dict[str, dict[str, list[int]]] = field(default_factory=dict)
    readme: str = ""
    readme_names: list[str] = field(default_factory=list)
    readme_foreign: list[str] = field(default_factory=list)
    readme_commands: dict[str, bool | None] = field(default_factory=dict)
    readme_misgiven: list[str] = field(default_factory=list)
    recordings: list[str] = field(default_factory=list)
    launch_files: list[str] = field(default_factory=list)
    launch_lacks: dict[str, list[str]] = field(default_factory=dict)
    launched_packages: dict[str, list[str]] = field(default_factory=dict)
    launched_programs: dict[str, list[str]] = field(default_factory=dict)
    launch_files_elsewhere: list[str] = field(default_factory=list)
    parameter_files: dict[str, dict[str, dict[str, Any]]] = field(default_factory=dict)
    parameter_file_users: dict[str, list[str]] = field(default_factory=dict)
    hard_coded: list[str] = field(default_factory=list)
    tests: dict[str, int] = field(default_factory=dict)
    tests_left_out: list[str] = field(default_factory=list)
    handlers: dict[str, list[Place]] = field(default_factory=dict)
    compared: list[str] = field(default_factory=list)
    depended_on: list[str] = field(default_factory=list)
    idle: dict[str, list[int]] = field(default_factory=dict)
    ends: list[WrittenEnd] = field(default_factory=list)
    ends_elsewhere: list[WrittenEnd] | None = None
    simulated: list[str] = field(default_factory=list)
    declared: dict[str, bool | float | str | None] = field(default_factory=dict)
    findings: list[list[str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    unread: dict[str, str] = field(default_factory=dict)

    def told(self) -> list[Finding]:
        """Return the findings as `diagnose` has told them."""
        return [
            Finding(code, cause, place, fix, tuple(about))
            for code, cause, place, fix, *about in self.findings
        ]


NO_ENTRY_POINT = "No entry point leads to it."  # a fault of an executable


@dataclass(frozen=True)
class Executable:
    """A program of the package.

    Attributes:
        name: of the entry point, or of the module or file where there is none.
        target: `package.module:function`; empty for a plain script.
        way: how it can be started.
        command: the words that start it in a box, in the environment of `Build`; empty if nothing can start it.
        fault: why it cannot be started as installed, in one sentence; empty if it can.
        absent: the modules that it imports, directly or not, and that are not installed here; `KEYBOARD`, if it reads
            one.
        modules: the last parts of the names of all modules that it is made of; empty if they are not known.
        is_brief: whether nothing in its code goes on: nothing spins, and no loop waits for a condition.
        never_spins: whether nothing in its code spins, so that no callback of it is ever called.
        package: the other package that it lies in; empty for the graded one.
    """

    name: str
    target: str
    way: Way
    command: list[str]
    fault: str = ""
    absent: list[str] = field(default_factory=list)
    modules: list[str] = field(default_factory=list)
    is_brief: bool = False
    never_spins: bool = False
    package: str = ""

    @property
    def module(self) -> str:
        """The whole name of its module; empty for a plain script."""
        return self.target.partition(":")[0]

    @property
    def stem(self) -> str:
        """The last part of the name of its module: its file, without .py."""
        return self.module.rpartition(".")[2]

    @property
    def has_entry_point(self) -> bool:
        """Whether an entry point of setup.py leads to it, or is meant to."""
        return self.fault != NO_ENTRY_POINT


@dataclass(frozen=True)
class Build:
    """What colcon made of it.

    Attributes:
        is_built: whether the package was found as ament_python, built and installed.
        error: the first real error; empty if there is none.
        warnings: what it warned of.
        notes: settings in the submission that had no effect, or only on its own package.
        executables: the package's programs, also those that must be started in another way than installed.
        shared: what lies in `share/<package>` of each package that was built, relative to that folder.
        environ: the variables with which a box runs what was built, as after `source install/setup.bash`.
        seconds: of the build.
        absent: the packages that launch files name and that are neither in the hand-in nor installed here.
        cut: which limit ended colcon; empty if it ended by itself.
    """

    is_built: bool
    error: str
    warnings: list[str]
    notes: list[str]
    executables: list[Executable]
    shared: list[str]
    environ: dict[str, str]
    seconds: float
    absent: list[str] = field(default_factory=list)
    cut: str = ""


@dataclass(frozen=True)
class Heard:
    """What was published on a topic during a part of a run.

    Attributes:
        type_name: such as `std_msgs/msg/String`.
        node: the full name of the node that published, as far as it is known.
        times: when messages came, at most 200.
        values: their content as plain data, as many as `times`.
        count: how many came in all.
    """

    type_name: str
    node: str
    times: list[float]
    values: list[Any]
    count: int

    @cached_property
    def sense(self) -> str:
        """What its messages say last, without what changes by itself; empty if there are none."""
        return sense(self.values) if self.values else ""

    @cached_property
    def senses(self) -> list[str]:
        """What each of its messages says by itself."""
        return [sense([value]) for value in self.values]


@dataclass(frozen=True)
class CommandSeen:
    """A command that was published, and what followed until the next one.

    Attributes:
        text: the command.
        log: log lines of the node, as [level, text].
        topics: what was published meanwhile.
        parameters: those that changed, as `/node:name`.
        is_alive: whether all programs still ran.
    """

    text: str
    log: list[list[str]]
    topics: dict[str, Heard]
    parameters: dict[str, Any]
    is_alive: bool


@dataclass(frozen=True)
class ServiceCall:
    """A service that was called.

    Attributes:
        service: its name.
        request: by field.
        response: by field; None if none came.
        seconds: from the request to the response, or how long was waited for it; less what any answer takes then.
        is_repeated: whether the requests were all made before, and this one is made to see that it goes on.
        is_alive: whether all programs still ran afterwards.
        topics: what was published from the request to the next one.
    """

    service: str
    request: dict[str, Any]
    response: dict[str, Any] | None
    seconds: float
    is_repeated: bool
    is_alive: bool
    topics: dict[str, Heard] = field(default_factory=dict)


@dataclass(frozen=True)
class Run:
    """A program, or several, while they were watched.

    Attributes:
        programs: what was started, by the names of `Executable`.
        setting: why: `alone` (also what a program did among the others, where that tells it), `together`, `launched`,
            `given`, or a parameter such as `period:=1.0`.
        clock: whose time its timers follow.
        nodes: full names of the nodes that came.
        publishes: types by topic and node.
        subscribes: types by topic and node.
        qos: reliability and durability by topic, as `publisher reliable volatile`.
        parameters: values by node, but not of `changed`.
        quiet: what was published before any command.
        commands: what followed each command, in their order.
        ended: of each program that ended by itself, what it said last.
        early: of these, the ones that did so before any command was published.
        stopped: how each ended at Ctrl-C: `last` (the last message by topic), `seconds`, `traceback` (whether there
            was one), `killed` (whether it had to be), `said` (its last lines; where Ctrl-C meets a program is chance).
        notes: what was cut, and what could not be seen.
        log: what was logged or printed before any command, as [level, text].
        twins: full names that more than one node had.
        stalled: topics on which messages came more than once, and then no more, though there was no command.
        refused: what ended it at first, or kept it from publishing, because a field for floats was given something
            else; it was then watched without this check, as outside the lab. Empty if nothing did.
        services: types by service and node, where the assignment asks for a service.
        calls: of services, in their order.
        given: topics and services on which default values were given, for nobody of the hand-in is there.
        tried: those of them on which there is nothing else to be given, in whatever way with the others.
        commanded: the topic on which the commands were published; empty if nothing takes any.
        typed: the lines that were typed for a program that reads a keyboard, in their order.
        clocked: full names of the nodes that follow `/clock` though they were not told to, and nobody publishes it.
        unfinished: for want of what time, in a clause; empty if it was watched to its end.
        changed: the programs that had other parameters than by themselves, which another Run tells of: here only what
            follows commands counts, and no rhythm of theirs.
    """

    programs: list[str]
    setting: str
    clock: Clock
    nodes: list[str]
    publishes: dict[str, dict[str, list[str]]]
    subscribes: dict[str, dict[str, list[str]]]
    qos: dict[str, list[str]]
    parameters: dict[str, dict[str, Any]]
    quiet: dict[str, Heard]
    commands: list[CommandSeen]
    ended: dict[str, str]
    stopped: dict[str, dict[str, Any]]
    notes: list[str]
    log: list[list[str]] = field(default_factory=list)
    twins: list[str] = field(default_factory=list)
    stalled: list[str] = field(default_factory=list)
    refused: str = ""
    services: dict[str, dict[str, list[str]]] = field(default_factory=dict)
    calls: list[ServiceCall] = field(default_factory=list)
    given: list[str] = field(default_factory=list)
    tried: list[str] = field(default_factory=list)
    commanded: str = ""
    typed: list[str] = field(default_factory=list)
    clocked: list[str] = field(default_factory=list)
    early: list[str] = field(default_factory=list)
    unfinished: str = ""
    changed: list[str] = field(default_factory=list)

    @property
    def stretches(self) -> list[dict[str, Heard]]:
        """What was published before any request or command, and after each."""
        after = [*(call.topics for call in self.calls), *(command.topics for command in self.commands)]
        return [self.quiet, *after]

    @property
    def unasked(self) -> set[str]:
        """The nodes that lived and did not answer what parameters they have: they do not spin."""
        return set() if self.ended or self.changed else {*self.nodes} - self.parameters.keys()


@dataclass(frozen=True)
class Evidence:
    """All that is known of a submission.

    Attributes:
        schema: the version of this form.
        assignment: the name of that for which it was handed in.
        name: of what was handed in.
        submission: what was found in it.
        files: see `Files`.
        build: see `Build`; None if there was nothing to build.
        runs: in the order in which they were made.
        tests: what its own tests say, and whether they notice a broken package; see `own_tests`.
        seconds: of each part of the work.
        sandbox: how it was confined.
        versions: of what graded.
        coined: the words that nobody knows and that were said besides the assignment's unknown ones.
    """

    schema: int
    assignment: str
    name: str
    submission: Submission
    files: Files
    build: Build | None
    runs: list[Run]
    tests: dict[str, Any]
    seconds: dict[str, float]
    sandbox: str
    versions: dict[str, str]
    coined: list[str] = field(default_factory=list)
