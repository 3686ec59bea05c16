"""What was seen of a submission, as plain data: the only source of the rubric's points.

All of it can be written as JSON and read back without loss, so that it can be graded again without another
run. Times are in s; a run's times count from the moment its nodes were up, on the clock that it follows.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from ros2lab.diagnose.finding import Finding
from ros2lab.grading.receiving.submission import Submission
from ros2lab.grading.senses import sense

SCHEMA = 4

Clock = Literal["stepped", "real"]
Way = Literal["installed", "module", "script"]
KEYBOARD = "a keyboard"  # which nobody uses during grading
# The beginnings of what is said of a package that is built, or passed over, as one of another type.
OTHER_TYPE = ("colcon does not take it for an ament_python package", "colcon lists it as ")
NO_WORD = "colcon ended without an error, and nothing was installed."  # as the error of a build
DOCUMENTED = "documented"  # the setting of a run of a silent program with the parameters of the README
GIVEN = "given"  # the setting of a run in which programs receive what they may wait for
TIMED = "ros2lab: a timer of the launch file shuts everything down."  # in the log of a launched run


@dataclass(frozen=True)
class Place:
    """A line in a file of the submission; line 0 is the whole file."""

    file: str
    line: int = 0


@dataclass(frozen=True)
class WrittenEnd:
    """A publisher or a subscription that the code creates, whether or not that ever runs.

    Attributes:
        topic: its name, with a leading slash; empty if it is not known.
        type_name: such as `std_msgs/msg/String`; empty if it is not known.
        periods: the periods of the timers that publish on it in every call, in s.
        module: the last part of the name of the module that creates it; empty if it is not known.
        does: what running code would do with it, in the words of `deeds`; None if that is not known.
        never: what that code never does with it, although it does something.
        begins: whether code publishes with it as soon as the program runs, whatever comes or holds.
        vain: the place of the finding of `diagnose` that keeps the code from doing more with it; empty if none does.
    """

    topic: str
    type_name: str
    is_publisher: bool
    periods: list[float]
    module: str = ""
    does: list[str] | None = None
    never: list[str] = field(default_factory=list)
    begins: bool = False
    vain: str = ""


@dataclass(frozen=True)
class Files:
    """The facts in the files, without running anything.

    Attributes:
        manifest: facts of package.xml, each True or False, by their names in `files`; empty without a
            package.
        setup: the same for setup.py, setup.cfg and the marker.
        sources: how many modules, classes and functions of the Python code have a docstring or a comment, by
            kind as [described, all]; under `about`, how many of these have a word in common with the code or
            the README, and how many there are.
        sources_beside: the same for each of the other graded packages, which `sources` includes.
        readme: the README's text, shortened; empty if there is none.
        readme_names: the package's classes, functions and files that it names.
        readme_foreign: names of code in it that the submission does not have; empty if it has most of them.
        readme_commands: commands in it that name this package's executables, launch files and topics, and
            whether each is true of what was installed and seen; None if that cannot be known.
        readme_misgiven: those of them with a wrong type, parameter, option or argument.
        recordings: pictures, films and logs of the submission, some of which may show the nodes running.
        launch_files: those that start most come first; among equals, those of the package, then those of
            packages that launch it, then those in the folders around it. `Build.shared` says which are
            installed.
        launch_lacks: for each launch file that includes no other, the names that the README sets by `name:=`
            and that are not in it.
        launched_packages: the packages that each launch file names, as far as they are known.
        launched_programs: the executables that each launch file names, itself or through what it includes.
        launch_files_elsewhere: launch files of the other packages in the submission.
        parameter_files: parameter files of the same packages, each with its values by node (`/**` for all).
        parameter_file_users: for each parameter file, the launch files that name it, and the modules that
            name it and read YAML; empty if they are not known.
        hard_coded: absolute paths of files in the launch files, which exist on one machine only.
        tests: the submission's own tests: the number of test functions by file.
        tests_left_out: files of own tests that were not run because they import what is not installed here.
        findings: what `diagnose` found in the files, as [code, cause, place, fix, *about], the likeliest first.
        handlers: places that catch exceptions: `by name`, `wholesale`, or only `of an end`, as by Ctrl-C.
        compared: the short texts that the code compares something with.
        depended_on: those that it compares with values from messages, and on which something depends.
        branches: by such a text, whether its branch is plainly `mute`, or the program's `last`; see `branches`.
        idle: for each file, the lines of functions that never run and of assignments that no running code reads.
        ends: the publishers and subscriptions that the code creates.
        ends_meant: the same where its slips of typing are corrected as the findings say; empty if there are none.
        ends_left: the same without the code of which the findings say that it is in vain; empty if that changes none.
        ends_elsewhere: those that the rest of the submission may create, on unknown topics; None if not known.
        contents: the `words` and `numbers` that the code compares, by the topic's last part; under "" for any other.
        declared: the parameters that the code declares, with their defaults; None for an unknown default.
        notes: what was not looked at, and why.
        unread: the facts that are empty because our reader failed, and why it did.
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
    branches: dict[str, list[str]] = field(default_factory=dict)
    idle: dict[str, list[int]] = field(default_factory=dict)
    ends: list[WrittenEnd] = field(default_factory=list)
    ends_meant: list[WrittenEnd] = field(default_factory=list)
    ends_left: list[WrittenEnd] = field(default_factory=list)
    ends_elsewhere: list[WrittenEnd] | None = None
    contents: dict[str, dict[str, list[Any]]] = field(default_factory=dict)
    declared: dict[str, bool | float | str | None] = field(default_factory=dict)
    findings: list[list[str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    unread: dict[str, str] = field(default_factory=dict)

    def told(self) -> list[Finding]:
        """Return the findings in the form of `diagnose`."""
        return [
            Finding(code, cause, place, fix, tuple(about))
            for code, cause, place, fix, *about in self.findings
        ]


NO_ENTRY_POINT = "No entry point leads to it."  # a fault of an executable
UNBUILT = "The package was not built."
ELSEWHERE, NOWHERE = "It was installed in ", "It was not installed in "  # how others begin


@dataclass(frozen=True)
class Executable:
    """A program of the package.

    Attributes:
        name: the name of the entry point, or of the module or file if there is none.
        target: `package.module:function`; empty for a plain script.
        way: how it can be started.
        command: the command that starts it in a box, in the environment of `Build`; empty if nothing can
            start it.
        fault: a sentence that says why it cannot be started as installed; empty if it can.
        absent: the modules that it imports, directly or indirectly, and that are not installed here;
            `KEYBOARD` if it reads one.
        modules: the last parts of the names of all its modules; empty if they are not known.
        is_brief: whether its code cannot run for long: nothing spins, and no loop waits for a condition.
        never_spins: whether nothing in its code spins, so that none of its callbacks is ever called.
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
        """The full name of its module; empty for a plain script."""
        return self.target.partition(":")[0]

    @property
    def stem(self) -> str:
        """The last part of its module's name: the file without .py."""
        return self.module.rpartition(".")[2]

    @property
    def has_entry_point(self) -> bool:
        """Whether an entry point of setup.py leads to it, or is meant to."""
        return self.fault != NO_ENTRY_POINT


@dataclass(frozen=True)
class Build:
    """The result of the build.

    Attributes:
        is_built: whether the package was found as ament_python, built and installed.
        error: the first real error; empty if there is none.
        warnings: the warnings of the build.
        notes: settings in the submission that had no effect, or only on its own package.
        executables: the package's programs, including those that cannot be started as installed.
        shared: the files in `share/<package>` of each package that was built, relative to that folder.
        environ: the environment in which a box runs what was built, as after `source install/setup.bash`.
        seconds: how long the build took.
        absent: the packages that launch files name and that are neither in the submission nor installed here.
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
        values: their content by field, one for each of `times`; empty where it could not be read.
        count: how many messages came in all.
    """

    type_name: str
    node: str
    times: list[float]
    values: list[dict[str, Any]]
    count: int

    @cached_property
    def sense(self) -> str:
        """What its messages say in the end, without what changes by itself; empty if there are none."""
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
        parameters: the parameters that changed, as `/node:name`.
        is_alive: whether all programs were still running.
        anew: the nodes that were there anew, as those of another program.
    """

    text: str
    log: list[list[str]]
    topics: dict[str, Heard]
    parameters: dict[str, Any]
    is_alive: bool
    anew: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class ServiceCall:
    """A service that was called.

    Attributes:
        service: its name.
        request: its values by field.
        response: its values by field; None if none came.
        seconds: from the request to the response, or the end of the wait for it; less what any answer takes
            then.
        is_repeated: whether it repeats a request, to see whether the service goes on answering.
        is_alive: whether all programs were still running afterwards.
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
    """What was seen while one or more programs were watched.

    Attributes:
        programs: what was started, by the names of `Executable`.
        setting: `alone` (or among others, if what the program did can be told apart), `together`, `launched`,
            `documented`, `given`, or a parameter such as `period:=1.0`.
        clock: the clock that timers follow.
        nodes: full names of the nodes that appeared.
        publishes: types by topic and node.
        subscribes: types by topic and node.
        qos: reliability and durability by topic, as `publisher reliable volatile`.
        parameters: values by node, without those of `changed`.
        quiet: what was published before any command.
        commands: what followed each command, in order.
        ended: the last lines of each program that ended by itself.
        early: those of them that ended before any command was published.
        done: those of them that ended with the exit code 0, by which a program says that all went well.
        stopped: how each ended at Ctrl-C: `last` (the last message by topic), `seconds`, `traceback` (whether
            there was one), `killed` (whether that was needed), `said` (its last lines, by chance).
        notes: what was cut, and what could not be seen.
        log: what was logged or printed before any command, as [level, text].
        twins: full names that more than one node had.
        stalled: topics on which several messages came, and then no more, although there was no command.
        refused: the error that ended it or kept it from publishing at first, because something else was
            assigned to a field for floats; it was watched again without this check, as outside the lab. Empty
            if there is none.
        services: types by service and node, if the assignment asks for a service.
        calls: calls of services, in order.
        waits: what its nodes take, offer or call, and no other one brings: topics but the commands', services, actions.
        given: those of them that were given something.
        gave: the type of each of them.
        ungiven: those that could not be given, with their types.
        meanwhile: what was published while something was given; `quiet` and `commands` came after it.
        handed_on: the topics on which nothing came meanwhile but what was given.
        commanded: the topic on which the commands were published; empty if nothing receives any.
        typed: the lines that were typed for a program that reads a keyboard, in order.
        clocked: full names of the nodes that follow `/clock` although they were not told to and nobody
            publishes it.
        unfinished: which time ran out, as a clause; empty if it was watched to its end.
        changed: the programs that ran with other parameters than usual; only what follows commands counts here.
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
    waits: list[str] = field(default_factory=list)
    given: list[str] = field(default_factory=list)
    gave: dict[str, str] = field(default_factory=dict)
    ungiven: dict[str, str] = field(default_factory=dict)
    meanwhile: dict[str, Heard] = field(default_factory=dict)
    handed_on: list[str] = field(default_factory=list)
    commanded: str = ""
    typed: list[str] = field(default_factory=list)
    clocked: list[str] = field(default_factory=list)
    early: list[str] = field(default_factory=list)
    done: list[str] = field(default_factory=list)
    unfinished: str = ""
    changed: list[str] = field(default_factory=list)

    @property
    def stretches(self) -> list[dict[str, Heard]]:
        """What was published before all requests and commands, after each of them, and while something was given."""
        after = [*(call.topics for call in self.calls), *(command.topics for command in self.commands)]
        return [self.quiet, *after, *([self.meanwhile] if self.meanwhile else [])]

    @property
    def torn(self) -> dict[str, list[str]]:
        """The types of the topics that nodes use with several types; not all of these were listened to."""
        types: dict[str, set[str]] = {}
        for ends in (self.publishes, self.subscribes):
            for topic, nodes in ends.items():
                types.setdefault(topic, set()).update(*nodes.values())
        return {topic: sorted(kinds) for topic, kinds in types.items() if len(kinds) > 1}

    @property
    def unasked(self) -> set[str]:
        """The nodes that were alive and did not answer a request for their parameters: they do not spin."""
        return set() if self.ended or self.changed else {*self.nodes} - self.parameters.keys()


@dataclass(frozen=True)
class Evidence:
    """All that is known about a submission.

    Attributes:
        schema: the version of this format.
        assignment: the name of the assignment.
        name: the name of the file or folder that was handed in.
        submission: what was found in it.
        files: see `Files`.
        build: see `Build`; None if there was nothing to build.
        runs: in the order in which they were made.
        tests: the results of its own tests, and whether they notice a broken package; see `own_tests`.
        seconds: how long each part of the work took.
        sandbox: how it was confined.
        versions: the versions of the programs that graded it.
        coined: made-up commands that were sent besides the assignment's unknown ones.
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

    @property
    def unwatched(self) -> list[str]:
        """The programs that could be started and were not: there are more than are watched."""
        started = {name for run in self.runs for name in run.programs}
        able = [each.name for each in self.build.executables if each.command] if self.build else []
        return [name for name in able if name not in started] if self.runs else []
