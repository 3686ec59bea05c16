"""Evidence made by hand: right ones in many styles, and each with one fault; no program has run for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from ros2lab import assignments
from ros2lab.grading.evidence import (
    OTHER_TYPE,
    SCHEMA,
    Build,
    CommandSeen,
    Evidence,
    Executable,
    Files,
    Heard,
    Place,
    Run,
)
from ros2lab.grading.receiving.notes import Note
from ros2lab.grading.receiving.submission import FoundPackage, Submission
from ros2lab.grading.watching.script import Script

SCRIPT = Script(assignments.load().commanded)
STRING, TWIST = "std_msgs/msg/String", "geometry_msgs/msg/Twist"
STATUS, COMMAND, VELOCITY = "status_publisher", "command_subscriber", "velocity_publisher"
NODES = (STATUS, COMMAND, VELOCITY)
FOLDER = "robot_project_ws/src/robot_controller"
PACKAGE = FoundPackage(FOLDER, "robot_controller", "ament_python", None)
README = """# robot_controller
Three nodes: status_publisher tells on /robot/status how the robot is, command_subscriber obeys /robot/command, and
velocity_publisher drives it on /cmd_vel. Build with `colcon build`, then `source install/setup.bash` and
`ros2 run robot_controller status_publisher`, or all by `ros2 launch robot_controller robot.launch.py`.
"""
MANIFEST = [
    "is_there",
    "is_valid",
    "is_ament_python",
    "dependencies_exist",
    "declares_all_imports",
    "declares_rclpy",
    "declares_std_msgs",
    "declares_geometry_msgs",
    "description_is_written",
    "license_is_written",
    "maintainer_is_written",
]
SETUP = [
    "is_there",
    "is_valid",
    "installs_modules",
    "marker_is_installed",
    "data_files_exist",
    "scripts_go_to_lib",
    "cfg_has_no_dashes",
    "has_entry_points",
    "entry_points_lead_to_functions",
    "name_agrees",
    "marker_exists",
    "manifest_is_installed",
    "is_described",
]

Change = Callable[[Evidence], Evidence]
Reaction = Callable[[str], list[str]]


def twist(x: Any, z: float = 0.0) -> dict[str, Any]:
    zeros = {"y": 0.0, "z": 0.0}
    return {"linear": {"x": x, **zeros}, "angular": {"x": 0.0, "y": 0.0, "z": z}}


def heard(kind: str, node: str, values: list[Any], period: float = 2.0, start: float = 0.0) -> Heard:
    times = [start + period * (number + 1) for number in range(len(values))]
    return Heard(kind, node, times, values, len(values))


def status_run(
    node: str = "/status_publisher",
    program: str = STATUS,
    *,
    topic: str = "/robot/status",
    kind: str = STRING,
    period: float = 2.0,
    values: int = 3,
) -> Run:
    text: Any = {"data": "well"}
    quiet = {topic: heard(kind, node, [text] * values, period)} if values else {}
    return Run(
        [program], "alone", "stepped", [node], {topic: {node: [kind]}}, {}, {}, {node: {"period": 2.0}},
        quiet, [], {}, {program: {"last": {}}}, [],
    )  # fmt: skip


def log_by_word(text: str) -> list[str]:
    word = text.strip().lower()
    if word in ("start", "stop", "reset"):
        return [f"Received {text}: robot {word}s"]
    return [f"Unknown command: {text}"]


def echo(text: str) -> list[str]:
    return [f"I heard: {text}"]


def command_run(
    node: str = "/command_subscriber",
    program: str = COMMAND,
    *,
    topic: str = "/robot/command",
    kind: str = STRING,
    log: Reaction = log_by_word,
    texts: tuple[str, ...] = SCRIPT.all,
    level: str = "INFO",
    setting: str = "alone",
) -> Run:
    commands = [
        CommandSeen(text, [[level, line] for line in ([] if len(text) > 10 else log(text))], {}, {}, True)
        for text in texts
    ]
    return Run(
        [program], setting, "stepped", [node], {}, {topic: {node: [kind]}}, {}, {}, {}, commands, {},
        {program: {"last": {}}}, [], commanded=topic,
    )  # fmt: skip


def velocity_run(
    node: str = "/velocity_publisher",
    program: str = VELOCITY,
    *,
    topic: str = "/cmd_vel",
    kind: str = TWIST,
    values: list[Any] | None = None,
) -> Run:
    said = [twist(0.5)] * 10 if values is None else values
    quiet = {topic: heard(kind, node, said, 0.1)} if said else {}
    return Run(
        [program], "alone", "stepped", [node], {topic: {node: [kind]}}, {}, {}, {node: {"period": 0.1}},
        quiet, [], {}, {program: {"last": {}}}, [],
    )  # fmt: skip


def merged(runs: list[Run], program: str, setting: str = "alone") -> Run:
    """Return one run of all the nodes of several."""
    commands, commanded = next(((run.commands, run.commanded) for run in runs if run.commands), ([], ""))

    def joined(name: str) -> dict[str, Any]:
        return {key: value for run in runs for key, value in getattr(run, name).items()}

    by_time = {topic: heard for topic, heard in joined("quiet").items() if heard.type_name == STRING}
    commands = [replace(one, topics=by_time | one.topics) for one in commands]  # it goes on
    return Run(
        [program], setting, "stepped", [node for run in runs for node in run.nodes], joined("publishes"),
        joined("subscribes"), {}, joined("parameters"), joined("quiet"), commands, {}, {program: {"last": {}}}, [],
        commanded=commanded,
    )  # fmt: skip


def moving(
    run: Run,
    speed: Mapping[str, float],
    topic: str = "/cmd_vel",
    node: str = "/velocity_publisher",
    count: int = 3,
) -> Run:
    """Return a run in which the robot has these speeds after the commands, and the one before after others."""
    now, commands = 0.0, []
    for one in run.commands:
        now = speed.get(one.text, now)
        topics = {topic: heard(TWIST, node, [twist(now)] * count, 0.1)} if count else {}
        commands.append(replace(one, topics=one.topics | topics))
    return replace(run, commands=commands, publishes={**run.publishes, topic: {node: [TWIST]}})


def launched(runs: list[Run]) -> Run:
    run = replace(merged(runs, "robot.launch.py", "launched"), clock="real")
    few = [one for one in run.commands if one.text in SCRIPT.few]
    # There is no START before an unknown command here, after which the robot would move.
    standing = next((one.topics for one in few if one.text == "reset"), {})
    return replace(
        run, commands=[replace(one, topics=standing) if one.text == "dance" else one for one in few]
    )


def executable(name: str, module: str = "") -> Executable:
    return Executable(name, f"robot_controller.{module or name}:main", "installed", [f"/lib/{name}"])


def _held(run: Run, node: str) -> float:
    """Return the period that a node has as a parameter, in s."""
    return float(run.parameters.get(node, {}).get("period", 1.0))


def right(runs: list[Run] | None = None, readme: str = README) -> Evidence:
    """Return the evidence of a submission without a fault and with all of the bonus, or with other runs."""
    alone = [status_run(), command_run(), velocity_run()] if runs is None else runs
    programs = dict.fromkeys(name for run in alone if run.setting == "alone" for name in run.programs)
    changed = [
        replace(run, setting="period:=1.0", quiet={t: replace(h, times=[time / _held(run, h.node) for time in h.times]) for t, h in run.quiet.items()})
        for run in alone
        if run.setting == "alone" and run.quiet and any("period" in values for values in run.parameters.values())
    ]  # fmt: skip
    only_alone = [run for run in alone if run.setting == "alone"]
    return Evidence(
        schema=SCHEMA,
        assignment="week2",
        name="ada",
        submission=Submission("workspace", "robot_project_ws", [PACKAGE], PACKAGE, [], []),
        files=Files(
            manifest=dict.fromkeys(MANIFEST, True),
            setup=dict.fromkeys(SETUP, True),
            sources={"modules": [3, 3], "classes": [3, 3], "functions": [6, 8]},
            readme=readme,
            readme_commands={
                "colcon build": True,
                "ros2 run robot_controller status_publisher": True,
                "ros2 launch robot_controller robot.launch.py": True,
            },
            launch_files=[f"{FOLDER}/launch/robot.launch.py"],
            parameter_files={f"{FOLDER}/config/robot.yaml": {"/**": {"period": 2.0}}},
            parameter_file_users={f"{FOLDER}/config/robot.yaml": [f"{FOLDER}/launch/robot.launch.py"]},
            tests={f"{FOLDER}/test/test_nodes.py": 4},
            handlers={
                "by name": [Place(f"{FOLDER}/robot_controller/status_publisher.py", 20)],
                "wholesale": [],
            },
        ),
        build=Build(
            True,
            "",
            [],
            [],
            [executable(name) for name in programs],
            ["launch/robot.launch.py", "config/robot.yaml"],
            {},
            1.3,
        ),
        runs=[*alone, launched(only_alone), *changed],
        tests={"passed": 4, "failed": 0, "skipped": 0, "error": "", "is_noticed": True},
        seconds={"unpack": 0.1, "build": 1.3, "observe": 2.0, "total": 3.4},
        sandbox="bubblewrap 0.8.0",
        versions={"ros2lab": "0.1.0"},
    )


# --- changes ----------------------------------------------------------------------------------------------


def facts(of: str, *names: str) -> Change:
    """Make facts of `manifest` or `setup` false."""
    return lambda e: replace(
        e, files=replace(e.files, **{of: {**getattr(e.files, of), **dict.fromkeys(names, False)}})
    )


def files(**changes: Any) -> Change:
    return lambda e: replace(e, files=replace(e.files, **changes))


def submission(**changes: Any) -> Change:
    return lambda e: replace(e, submission=replace(e.submission, **changes))


def tests(**changes: Any) -> Change:
    return lambda e: replace(e, tests={**e.tests, **changes})


def runs(*others: Run) -> Change:
    """Replace the run of a program by another one, in the launched run as well."""

    def change(e: Evidence) -> Evidence:
        by_program = {run.programs[0]: run for run in e.runs if run.setting == "alone"}
        by_program |= {run.programs[0]: run for run in others}
        again = right([*by_program.values()], e.files.readme)
        return replace(e, runs=again.runs)

    return change


def without(program: str, end: str = "") -> Change:
    """Let a program end at its start."""

    def change(e: Evidence) -> Evidence:
        dead = Run([program], "alone", "stepped", [], {}, {}, {}, {}, {}, [], {program: end}, {}, [])
        return runs(dead)(e)

    return change


def ended(program: str, end: str, at: str | None = None) -> Change:
    """Let a program die: by itself, or of a command."""

    def change(e: Evidence) -> Evidence:
        run = next(run for run in e.runs if run.programs == [program] and run.setting == "alone")
        commands, is_alive = [], True
        for one in run.commands if at is not None else []:
            is_alive &= one.text != at
            commands.append(one if is_alive else replace(one, is_alive=False, log=[]))
            if not is_alive:
                break
        return runs(replace(run, ended={program: end}, stopped={}, commands=commands))(e)

    return change


def unbuilt(error: str) -> Change:
    """Let the build fail, and the programs run as modules; nothing can be launched."""

    def change(e: Evidence) -> Evidence:
        assert e.build
        programs = [
            replace(one, way="module", command=["python3"], fault="The package was not built.")
            for one in e.build.executables
        ]
        build = replace(e.build, is_built=False, error=error, executables=programs, shared=[])
        commands = dict.fromkeys(e.files.readme_commands, False)
        again = replace(e, build=build, files=replace(e.files, readme_commands=commands))
        return replace(again, runs=[run for run in e.runs if run.setting != "launched"])

    return change


def by_colcon(what: str) -> Change:
    """Let colcon install what setup.py does not, which it says."""

    def change(e: Evidence) -> Evidence:
        assert e.build
        said = f"Package 'robot_controller' doesn't explicitly install {what} (colcon-ros currently does it)"
        return replace(e, build=replace(e.build, warnings=[*e.build.warnings, said]))

    return change


def misplaced(*names: str, fault: str = "No entry point leads to it.") -> Change:
    """Let programs run as modules only."""

    def change(e: Evidence) -> Evidence:
        assert e.build
        programs = [
            replace(one, way="module", fault=fault) if one.name in names else one
            for one in e.build.executables
        ]
        kept = [run for run in e.runs if run.setting != "launched"]
        return replace(e, build=replace(e.build, executables=programs), runs=kept)

    return change


def finding(code: str, cause: str, place: str, fix: str, *about: str) -> Change:
    return lambda e: replace(
        e, files=replace(e.files, findings=[*e.files.findings, [code, cause, place, fix, *about]])
    )


def both(*changes: Change) -> Change:
    def change(e: Evidence) -> Evidence:
        for one in changes:
            e = one(e)
        return e

    return change


def nothing() -> Evidence:
    empty = Submission("nothing", None, [], None, [], [])
    return Evidence(SCHEMA, "week2", "x", empty, Files(), None, [], {}, {}, "bubblewrap", {})


def untouched() -> Evidence:
    """Return the evidence of what `ros2 pkg create` makes, in a workspace."""
    e = right()
    assert e.build
    manifest = {**e.files.manifest, **dict.fromkeys(MANIFEST[3:], False), "dependencies_exist": True, "declares_all_imports": True, "maintainer_is_written": True}  # fmt: skip
    setup = {**e.files.setup, "has_entry_points": False, "is_described": False}
    sources = {"modules": [3, 3], "classes": [0, 0], "functions": [0, 3]}
    return replace(
        e,
        files=Files(manifest=manifest, setup=setup, sources=sources),
        build=replace(e.build, executables=[], shared=[]),
        runs=[],
        tests={},
    )


# --- styles -----------------------------------------------------------------------------------------------


def one_process() -> Evidence:
    log = moving(command_run("/command", "robot"), {"start": 0.5, "START": 0.5, "stop": 0.0, "reset": 0.0})
    return right(
        [
            merged(
                [
                    status_run("/status", "robot"),
                    log,
                    velocity_run(program="robot", values=[twist(0.0)] * 10),
                ],
                "robot",
            )
        ]
    )


def on_change() -> Evidence:
    """One program with two nodes, which publishes velocities only on a change, and logs in German."""
    words = {"start": ["Roboter fährt"], "stop": ["Roboter hält"], "reset": ["Alles auf Anfang"]}
    run = command_run(log=lambda text: words.get(text.lower(), []))
    run = moving(run, {"start": 0.5, "stop": 0.0}, node="/velocity_publisher", count=1)
    return right([status_run(), replace(run, parameters={"/command_subscriber": {}})])


def needs_others() -> Evidence:
    """The velocity comes only when all run together."""
    silent = replace(velocity_run(values=[]), parameters={"/velocity_publisher": {}})
    all_ = merged([status_run(), command_run(texts=SCRIPT.few), silent], STATUS, "together")
    all_ = moving(all_, {"start": 0.5, "stop": 0.0, "reset": 0.0})
    return right([status_run(), command_run(), silent, replace(all_, programs=[STATUS, COMMAND, VELOCITY])])


def by_launch() -> Evidence:
    """Only the launch file gives the namespace."""
    e = right([status_run(topic="/status"), command_run(topic="/command"), velocity_run()])
    return replace(
        e,
        runs=[
            run
            if run.setting != "launched"
            else launched([status_run(values=1), command_run(), velocity_run()])
            for run in e.runs
        ],
    )


def real_clock() -> Evidence:
    slow = status_run()
    slow = replace(
        slow,
        clock="real",
        quiet={"/robot/status": replace(slow.quiet["/robot/status"], times=[0.31, 2.33, 4.34])},
    )
    return right([slow, command_run(), velocity_run()])


def zero_until_start() -> Evidence:
    drive = moving(
        command_run(), {"start": 0.5, "START": 0.5, "stop": 0.0, "reset": 0.0}, node="/velocity_publisher"
    )
    drive = replace(drive, quiet={"/cmd_vel": heard(TWIST, "/velocity_publisher", [twist(0.0)] * 5, 0.1)})
    velocity = replace(
        velocity_run(values=[twist(0.0)] * 10),
        subscribes={"/robot/command": {"/velocity_publisher": [STRING]}},
    )
    return right([status_run(), command_run(), replace(velocity, commands=drive.commands)])


def repeats_for_one_that_obeys(before: float) -> Evidence:
    """The command subscriber repeats every word; the velocity publisher, with a speed before any, obeys by itself."""
    hearing = command_run(node="/velocity_publisher", program=VELOCITY, log=lambda _: [])
    obeying = moving(hearing, {"start": 0.5, "START": 0.5, "stop": 0.0, "reset": 0.0})
    quiet = velocity_run(values=[twist(before)] * 10).quiet
    return right([status_run(), command_run(log=echo), replace(obeying, quiet=quiet)])


def states_told() -> Evidence:
    """The state is told at the start as well, in the words that stop and reset have."""
    words = {
        "start": ["Robot is running"],
        "stop": ["Robot is stopped"],
        "reset": ["Robot is stopped", "Reset"],
    }
    run = command_run(log=lambda text: words.get(text.lower(), []), level="PRINT")
    return right([status_run(), replace(run, log=[["PRINT", "Robot is stopped"]]), velocity_run()])


def pauses_by_itself() -> Evidence:
    """The robot drives and pauses whatever is said to it."""
    drive = moving(
        command_run(), {"start": 0.5, "stop": 0.0, "dance": 0.5, "": 0.0}, node="/velocity_publisher"
    )
    velocity = velocity_run(values=[twist(speed) for speed in (0.0, 0.5, 0.5, 0.0, 0.0, 0.5)])
    both = merged([drive, velocity], "robot")
    return right([status_run(), replace(both, commands=drive.commands)])


def turns_with_a_rate() -> Evidence:
    """Beside the period of its timer a node has a turn rate, which is none."""
    e = right()
    turn = replace(velocity_run(), setting="turn_rate:=1.0")
    period = replace(turn, setting="period:=0.2", quiet={"/cmd_vel": heard(TWIST, "/velocity_publisher", [twist(0.5)] * 5, 0.2)})  # fmt: skip
    return replace(e, runs=[*(run for run in e.runs if run.programs != [VELOCITY] or ":=" not in run.setting), period, turn])  # fmt: skip


def turned(change: Change) -> Callable[[], Evidence]:
    return lambda: change(right())


STYLES: dict[str, Callable[[], Evidence]] = {
    "three nodes": right,
    "one process with three nodes": one_process,
    "only on a change, logs in German": on_change,
    "nodes that need one another": needs_others,
    "namespace by the launch file": by_launch,
    "sleep loop on the real clock": real_clock,
    "zero until start, and two nodes hear commands": zero_until_start,
    "one repeats, another one obeys": lambda: repeats_for_one_that_obeys(0.0),
    "one repeats, another one drives and obeys": lambda: repeats_for_one_that_obeys(0.5),
    "two statuses at a time": turned(
        runs(replace(status_run(), quiet={"/robot/status": Heard(STRING, "/status_publisher", [2.0, 2.0, 4.0, 4.0, 6.0, 6.0], [{"data": "well"}] * 6, 6)}))
    ),
    "any names": lambda: right(
        [status_run("/heart", "beat"), command_run("/ears", "ears"), velocity_run("/legs", "legs")],
        README + "The programs are beat, ears and legs; the nodes heart, ears and legs.",
    ),
    "sinusoidal velocity": turned(runs(velocity_run(values=[twist(number / 10) for number in range(10)]))),
    "prints": turned(runs(command_run(level="PRINT"))),
    "same line first, then its own": turned(
        runs(command_run(log=lambda t: [f"I heard [{t}]", *([f"state is {t}ed"] if t.lower() in ("start", "stop", "reset") else [])]))
    ),
    "JSON status and a rate that is a little off": turned(runs(status_run(period=2.15))),
    "README in German": lambda: right(
        None, README.replace("Build with", "Gebaut wird mit").replace("tells on", "sagt auf")
    ),
    "README with a word for each node": turned(
        files(
            readme=README.replace("run robot_controller status_publisher", "run robot_controller <node>").replace("launch robot", "start robot"),
            readme_commands={"colcon build": True, "ros2 run robot_controller <node>": None},
        )
    ),
    "each word is logged, and an unknown one refused": turned(
        runs(command_run(log=lambda t: [*echo(t), *([] if t.lower() in ("start", "stop", "reset") else [f"Unknown: {t}"])]))
    ),
    "an unknown word is refused in any words": turned(
        runs(command_run(log=lambda t: [*echo(t), *([] if t.lower() in ("start", "stop", "reset") else ["Geçersiz komut"])]))
    ),
    "what it is not any more": turned(
        runs(command_run(log=lambda t: {"start": ["not stopped any more"], "stop": ["no longer running"], "reset": ["reset"]}.get(t.lower(), [])))
    ),
    "the state at the start is that after stop": states_told,
    "it drives and pauses by itself": pauses_by_itself,
    "a turn rate beside a period": turns_with_a_rate,
    "small case only": turned(
        runs(command_run(log=lambda t: [f"Befehl {t}"] if t in ("start", "stop", "reset") else []))
    ),
}  # fmt: skip


# --- single faults: the component that loses, and what is changed -----------------------------------------


def dead_at(program: str, text: str) -> Change:
    return ended(program, f"Traceback (most recent call last):\nKeyError: '{text}'", text)


TWIN = replace(PACKAGE, folder="robot_project_ws/src/old/robot_controller")
ROUND = ("idle", "moving", "charging", "idle")
CRASH = "Traceback (most recent call last):\nModuleNotFoundError: No module named 'rospy'"
DIES = "Traceback (most recent call last):\nRuntimeError: gone"

FAULTS: dict[str, tuple[str, Change]] = {
    "package alone": ("workspace", submission(form="package", workspace=None)),
    "package twice": ("workspace", submission(packages=[PACKAGE, TWIN])),
    "COLCON_IGNORE around it": (
        "workspace",
        submission(notes=[Note("ignored by colcon", ["robot_project_ws/src"])]),
    ),
    "package in a package": (
        "workspace",
        submission(notes=[Note("in another package", [FOLDER])]),
    ),
    "built inside src": (
        "workspace",
        submission(notes=[Note("by a build", ["robot_project_ws/src/build", "robot_project_ws/src/log"])]),
    ),
    "built inside the package": ("workspace", submission(notes=[Note("by a build", [f"{FOLDER}/install"])])),
    "name with capitals": ("workspace", submission(package=replace(PACKAGE, name="Robot_Controller"))),
    "package.xml is missing": (
        "package",
        both(files(manifest={"is_there": False}), unbuilt("colcon finds no package robot_controller.")),
    ),
    "package.xml is not valid": ("package", both(facts("manifest", "is_valid"), unbuilt(f"{OTHER_TYPE[0]}: not valid"))),
    "build type": ("package", both(facts("manifest", "is_ament_python"), unbuilt("colcon lists it as ros.catkin"))),
    "dependency that does not exist": ("package", facts("manifest", "dependencies_exist")),
    "other import not declared": ("package", facts("manifest", "declares_all_imports")),
    "no rclpy": ("package", facts("manifest", "declares_rclpy")),
    "no std_msgs, no geometry_msgs": ("package", facts("manifest", "declares_std_msgs", "declares_geometry_msgs")),
    "no dependency": ("package", facts("manifest", *(name for name in MANIFEST if name.startswith("declares_")))),
    "no license": ("package", facts("manifest", "license_is_written")),
    "nothing written": ("package", facts("manifest", *(name for name in MANIFEST if name.endswith("_written")))),
    "TODO in setup.py": ("package", facts("setup", "is_described")),
    "setup.py is missing": ("package", both(files(setup={"is_there": False}), unbuilt("no setup.py"))),
    "setup.py does not parse": ("package", both(facts("setup", "is_valid"), unbuilt("SyntaxError"))),
    "setup.py fails": ("package", unbuilt("ZeroDivisionError: division by zero (setup.py, line 3)")),
    "other name in setup.py": ("package", facts("setup", "name_agrees")),
    "modules not installed": ("package", facts("setup", "installs_modules")),
    "data file missing": ("package", both(facts("setup", "data_files_exist"), unbuilt("can't copy"))),
    "marker missing": ("package", both(facts("setup", "marker_exists"), unbuilt("can't copy 'resource/...'"))),
    "marker not installed": ("package", by_colcon("a marker in the package index")),
    "package.xml not installed": ("package", by_colcon("the 'package.xml' file")),
    "setup.cfg with dashes": ("package", facts("setup", "cfg_has_no_dashes")),
    "no setup.cfg": (
        "package",
        both(
            facts("setup", "scripts_go_to_lib"),
            misplaced(STATUS, COMMAND, VELOCITY, fault="It was installed in bin, where `ros2 run` does not look."),
        ),
    ),
    "no entry points": ("package", both(facts("setup", "has_entry_points"), misplaced(STATUS, COMMAND, VELOCITY))),
    "comma between entry points": (
        "package",
        both(facts("setup", "entry_points_lead_to_functions"), unbuilt("distutils.core.setup() was never called")),
    ),
    "one entry point misspelt": (
        "package",
        both(facts("setup", "entry_points_lead_to_functions"), misplaced(STATUS)),
    ),
    "two entry points missing": ("package", misplaced(COMMAND, VELOCITY)),
    "status: crashes": ("status_publisher", without(STATUS, CRASH)),
    "status: topic one letter away": ("status_publisher", runs(status_run(topic="/robot/staus"))),
    "status: topic /status": ("status_publisher", runs(status_run(topic="/status"))),
    "status: in a namespace": ("status_publisher", runs(status_run(topic="/anna/robot/status"))),
    "status: another topic": ("status_publisher", runs(status_run(topic="/robot_health"))),
    "status: type": ("status_publisher", runs(status_run(kind="std_msgs/msg/Int32"))),
    "status: 1.0 s": ("status_publisher", runs(status_run(period=1.0))),
    "status: 2.4 s": ("status_publisher", runs(status_run(period=2.4))),
    "status: 5 s": ("status_publisher", runs(status_run(period=5.0, values=2))),
    "status: in ms": ("status_publisher", runs(status_run(period=0.002, values=100))),
    "status: by turns after 3 s and 1 s": (
        "status_publisher",
        runs(replace(status_run(), quiet={"/robot/status": replace(status_run().quiet["/robot/status"], times=[1.0, 4.0, 5.0])})),
    ),
    "status: once": ("status_publisher", runs(status_run(values=1))),
    "status: never": ("status_publisher", runs(status_run(values=0))),
    "status: dies": ("status_publisher", ended(STATUS, DIES)),
    "status: stops": ("status_publisher", runs(replace(status_run(), stalled=["/robot/status"]))),
    "status: ends": ("status_publisher", ended(STATUS, "that was all")),
    "command: crashes": ("command_subscriber", without(COMMAND, CRASH)),
    "command: topic one letter away": ("command_subscriber", runs(command_run(topic="/robot/comand"))),
    "command: topic /command": ("command_subscriber", runs(command_run(topic="/command"))),
    "command: another topic": ("command_subscriber", runs(command_run(topic="/orders"))),
    "command: type": ("command_subscriber", runs(command_run(kind="std_msgs/msg/Int32", texts=()))),
    "command: only echoes": ("command_subscriber", runs(command_run(log=echo))),
    "command: only start": ("command_subscriber", runs(command_run(log=lambda t: ["go"] if t == "start" else []))),
    "command: no reset": (
        "command_subscriber",
        runs(command_run(log=lambda t: log_by_word(t) if t != "reset" else ["Unknown command: reset"])),
    ),
    "command: reset is refused, with an echo": (
        "command_subscriber",
        runs(command_run(log=lambda t: [*echo(t), *(["fine " + t] if t in ("start", "stop") else [f"Unknown: {t}"])])),
    ),
    "command: the status goes round by itself": (
        "command_subscriber",
        runs(
            replace(status_run(), quiet={"/robot/status": heard(STRING, "/status_publisher", [{"data": text} for text in ROUND], 2.0)}),
            replace(
                command_run(log=lambda t: []),
                commands=[
                    replace(one, topics={"/robot/status": heard(STRING, "/status_publisher", [{"data": ROUND[number % 3]}])})
                    for number, one in enumerate(command_run(log=lambda t: []).commands)
                ],
            ),
        ),
    ),
    "command: wrong case": ("command_subscriber", runs(command_run(log=lambda t: ["go"] if t == "START" else [f"Unknown: {t}"]))),
    "command: silent": ("command_subscriber", runs(command_run(log=lambda t: []))),
    "command: the same line for all": ("command_subscriber", runs(command_run(log=lambda t: ["Command received"]))),
    "command: moves but does not log": (
        "command_subscriber",
        runs(moving(command_run(log=lambda t: []), {"start": 0.5, "stop": 0.0, "reset": 0.1, "START": 0.5})),
    ),
    "command: dies of an unknown one": ("command_subscriber", dead_at(COMMAND, "dance")),
    "command: dies of an empty one": ("command_subscriber", dead_at(COMMAND, "")),
    "command: dies of the flood": ("command_subscriber", dead_at(COMMAND, SCRIPT.flood)),
    "command: dies of start": ("command_subscriber", dead_at(COMMAND, "start")),
    "command: ends": ("command_subscriber", ended(COMMAND, "bye")),
    "command: anything moves the robot": (
        "command_subscriber",
        runs(moving(command_run(), {"start": 0.5, "stop": 0.0, "reset": 0.0, "START": 0.0, "dance": 0.5})),
    ),
    "velocity: crashes": ("velocity_publisher", without(VELOCITY, CRASH)),
    "velocity: topic one letter away": ("velocity_publisher", runs(velocity_run(topic="/cmd_vels"))),
    "velocity: in a namespace": ("velocity_publisher", runs(velocity_run(topic="/turtle1/cmd_vel"))),
    "velocity: another topic": ("velocity_publisher", runs(velocity_run(topic="/wheels"))),
    "velocity: stamped": ("velocity_publisher", runs(velocity_run(kind="geometry_msgs/msg/TwistStamped"))),
    "velocity: type": (
        "velocity_publisher",
        runs(velocity_run(kind="geometry_msgs/msg/Vector3", values=[{"x": 1.0, "y": 0.0, "z": 0.0}] * 5)),
    ),
    "velocity: int": ("velocity_publisher", runs(velocity_run(values=[twist(4.94e-324)] * 5))),
    "velocity: nan": ("velocity_publisher", runs(velocity_run(values=[{"linear": {"x": "nan"}, "angular": {"z": 0.0}}] * 5))),
    "velocity: once": ("velocity_publisher", runs(velocity_run(values=[twist(0.5)]))),
    "velocity: never": ("velocity_publisher", runs(velocity_run(values=[]))),
    "velocity: dies": ("velocity_publisher", ended(VELOCITY, DIES)),
    "velocity: stops": ("velocity_publisher", runs(replace(velocity_run(), stalled=["/cmd_vel"]))),
    "velocity: ends": ("velocity_publisher", ended(VELOCITY, "")),
    "no README": ("documentation", files(readme="", readme_commands={})),
    "README is a headline": ("documentation", files(readme="# robot_controller", readme_commands={})),
    "README of another package": (
        "documentation",
        files(
            readme="# Turtle dance\n" + "It draws with turtlesim. " * 20 + "`ros2 run turtles dance` `ros2 run turtles draw`",
            readme_commands={"ros2 run turtles dance": False, "ros2 run turtles draw": False},
        ),
    ),
    "README that builds another package": (
        "documentation",
        files(readme_commands={"colcon build --packages-select turtles": False, "ros2 run robot_controller status_publisher": True}),
    ),
    "README with one wrong command": (
        "documentation",
        files(readme_commands={"colcon build": True, "ros2 run robot_controller status_publisher": True, "ros2 run robot_controller go": False}),
    ),
    "README in which words stand for commands": (
        "documentation",
        files(readme="This is robot_controller. Use colcon and ros2 run. " + README.split("Build", maxsplit=1)[0], readme_commands={}),
    ),
    **{
        f"README in which {package} stands for the package": (
            "documentation",
            files(
                readme=README.replace("run robot_controller", f"run {package}").replace("launch robot", "start robot"),
                readme_commands={"colcon build": True, f"ros2 run {package} status_publisher": is_true},
            ),
        )
        for package, is_true in (("<package name>", None), ("<package_name>", None), ("PACKAGE", None), ("your_package", False), ("[pkg]", None))
    },
    "README in which a word stands for what is built": (
        "documentation",
        files(
            readme=README.replace("colcon build", "it").replace("source install/setup.bash", "it"),
            readme_commands={"colcon build --packages-select <pkg>": None, "ros2 run robot_controller status_publisher": True},
        ),
    ),
    "README in which a word stands for nodes that it does not name": (
        "documentation",
        files(
            readme="A controller of a robot. " * 9 + "`colcon build`, then `ros2 run robot_controller <node>`, on /robot/status, /robot/command and /cmd_vel.",
            readme_commands={"colcon build": True, "ros2 run robot_controller <node>": None},
        ),
    ),
    "README does not say how to build": (
        "documentation",
        files(readme=README.replace("colcon build", "it").replace("source install/setup.bash", "it"), readme_commands={"ros2 run robot_controller status_publisher": True}),
    ),
    "README without topics": ("documentation", files(readme=README.replace("/cmd_vel", "its motors"))),
    "nothing described": ("documentation", files(sources={"modules": [0, 3], "classes": [0, 3], "functions": [0, 8]})),
    "little described": ("documentation", files(sources={"modules": [3, 3], "classes": [1, 3], "functions": [0, 8]})),
}  # fmt: skip

BONUS_FAULTS: dict[str, tuple[str, Change]] = {
    "no launch file": ("bonus.launch", files(launch_files=[])),
    "launch file is not installed": ("bonus.launch", lambda e: replace(e, build=replace(e.build, shared=["config/robot.yaml"]))),  # type: ignore[type-var]
    "launch file starts two": (
        "bonus.launch",
        lambda e: replace(e, runs=[launched([status_run(), command_run()]) if run.setting == "launched" else run for run in e.runs]),
    ),
    "launch file starts nothing": (
        "bonus.launch",
        lambda e: replace(e, runs=[replace(run, publishes={}, subscribes={}) if run.setting == "launched" else run for run in e.runs]),
    ),
    "no parameters": ("bonus.parameters", lambda e: replace(e, runs=[run for run in e.runs if ":=" not in run.setting])),
    "a parameter without effect": (
        "bonus.parameters",
        lambda e: replace(e, runs=[*e.runs[:-1], replace(velocity_run(), setting="period:=1.0")]),
    ),
    "no parameter file": ("bonus.parameter_file", files(parameter_files={})),
    "parameter file for another node": ("bonus.parameter_file", files(parameter_files={"a.yaml": {"/nobody": {"period": 2.0}}})),
    "parameter file with another name": ("bonus.parameter_file", files(parameter_files={"a.yaml": {"/**": {"perod": 2.0}}})),
    "parameter file that nothing loads": (
        "bonus.parameter_file",
        files(parameter_file_users={f"{FOLDER}/config/robot.yaml": []}),
    ),
    "parameter file of its own kind": (
        "bonus.parameter_file",
        files(parameter_files={"a.yaml": {}}, parameter_file_users={"a.yaml": [f"{FOLDER}/robot_controller/robot.py"]}),
    ),
    "built folders at the top": (
        "workspace.clean",
        submission(notes=[Note("by a build", ["robot_project_ws/build", "robot_project_ws/install"])]),
    ),
    "compiled modules": (
        "workspace.clean",
        submission(notes=[Note("by a tool", ["robot_project_ws/src/robot_controller/robot_controller/__pycache__"])]),
    ),
    "only Ctrl-C is caught": (
        "bonus.errors",
        files(handlers={"by name": [], "wholesale": [], "of an end": [Place("a.py", 3)]}),
    ),
    "nothing is caught": ("bonus.errors", files(handlers={"by name": [], "wholesale": []})),
    "caught wholesale": ("bonus.errors", files(handlers={"by name": [], "wholesale": [Place("a.py", 3)]})),
    "no tests": ("bonus.tests", files(tests={})),
    "tests that fail": ("bonus.tests", tests(passed=3, failed=1)),
    "tests that see nothing": ("bonus.tests", tests(is_noticed=False)),
    "tests that were not tried on a broken node": ("bonus.tests", tests(is_noticed=None)),
}  # fmt: skip

PAIRS: tuple[tuple[str, str], ...] = (
    ("setup.py does not parse", "status: 1.0 s"),
    ("setup.py does not parse", "velocity: crashes"),
    ("setup.py fails", "command: only echoes"),
    ("marker missing", "no README"),
    ("package alone", "package.xml is not valid"),
    ("package alone", "velocity: int"),
    ("no rclpy", "command: dies of an unknown one"),
    ("built inside src", "status: type"),
    ("status: never", "README without topics"),
    ("command: silent", "velocity: once"),
    ("status: topic one letter away", "velocity: topic one letter away"),
    ("no setup.cfg", "nothing described"),
)
