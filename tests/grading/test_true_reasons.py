"""A reason says what was seen in the run, and of what is there no more than that it is there."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from typing import Any

import evidences
import pytest
from evidences import COMMAND, NODES, SCRIPT, STATUS, STRING, TWIST, VELOCITY

from ros2lab.grading.building import programs
from ros2lab.grading.evidence import ELSEWHERE, CommandSeen, Evidence, Run, WrittenEnd
from ros2lab.grading.grade import Judgement
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict
from ros2lab.grading.watching import OWN_CLOCK

ELSEWHERE_THAN = f"{ELSEWHERE}lib/first_robot, where `ros2 run` does not look."


def judged(evidence: Evidence, criterion: str) -> Judgement:
    return next(one for one in verdict(evidence, load()).criteria if one.id == criterion)


def given(*changes: evidences.Change) -> Evidence:
    return evidences.both(*changes)(evidences.right())


@pytest.mark.parametrize(
    ("texts", "notes", "said"),
    [
        (SCRIPT.all, [], "known, unknown, empty and very many commands."),
        (
            (*SCRIPT.words, "dance", "dance"),
            ["A node is slow to answer: not all of the commands were tried."],
            "known and unknown commands; not sent were empty and very many ones, for it is slow to answer.",
        ),
        (
            tuple(text for text in SCRIPT.all if text != SCRIPT.flood),
            [],
            "known, unknown and empty commands; not sent were very many ones.",
        ),
        (
            tuple(text for text in SCRIPT.all if text),
            [],
            "known, unknown and very many commands; not sent were empty ones.",
        ),
    ],
)
def test_what_a_node_lives_through_is_what_was_sent_to_it(
    texts: tuple[str, ...], notes: list[str], said: str
) -> None:
    run = replace(evidences.command_run(texts=texts), notes=notes)
    one = judged(given(evidences.runs(run)), f"{COMMAND}.robustness")
    assert (one.points, one.reason) == (4, f"command_subscriber lives on after {said}")


@pytest.mark.parametrize(
    ("log", "points"),
    [
        (evidences.echo, 4),
        (lambda text: [f"It has {len(text)} letters"], 4),
        (lambda _text: ["A command came"], 4),
        (lambda _text: [], 2),
    ],
)
def test_what_is_only_repeated_is_charged_once(log: evidences.Reaction, points: float) -> None:
    evidence = given(
        evidences.runs(evidences.command_run(log=log)), evidences.files(compared=[], depended_on=[])
    )
    assert judged(evidence, f"{COMMAND}.commands").points == 0
    one = judged(evidence, f"{COMMAND}.robustness")
    assert one.points == points
    assert not one.hint.startswith("Spin")


@pytest.mark.parametrize("topic", ["/robot/status", "/robot_status", "/cmd_vel"])
@pytest.mark.parametrize(("log", "is_meant"), [(evidences.echo, False), (evidences.log_by_word, True)])
def test_who_only_repeats_what_another_part_says_takes_no_commands(
    topic: str, log: evidences.Reaction, is_meant: bool
) -> None:
    run = evidences.command_run("/monitor", "monitor", topic=topic, log=log)
    others = [evidences.status_run(), evidences.velocity_run()]
    evidence = evidences.files(compared=[])(evidences.right([*others, run]))
    assert (judged(evidence, f"{COMMAND}.type").points > 0) is is_meant


def written(does: list[str] | None) -> evidences.Change:
    ends = [
        WrittenEnd("/robot/status", STRING, True, [2.0], STATUS, ["publishes"]),
        WrittenEnd("/robot/command", STRING, False, [], COMMAND, ["reads", "logs", "compares"]),
        WrittenEnd("/cmd_vel", TWIST, True, [], VELOCITY, does),
    ]
    return evidences.files(ends=ends)


@pytest.mark.parametrize(
    ("does", "points", "said"),
    [
        ([], 2.5, "has a publisher for /cmd_vel, and no line of the code that runs publishes there."),
        (["publishes"], 5, "has a publisher for /cmd_vel."),
        (None, 5, "has a publisher for /cmd_vel."),
    ],
)
def test_a_publisher_that_is_only_made_publishes_nothing(
    does: list[str] | None, points: float, said: str
) -> None:
    evidence = given(written(does), evidences.runs(evidences.velocity_run(values=[])))
    one = judged(evidence, f"{VELOCITY}.topic")
    assert (one.points, one.reason) == (points, f"/velocity_publisher {said}")


@pytest.mark.parametrize("does", [[], None, ["publishes"]])
def test_a_publisher_that_was_heard_publishes_whatever_its_code_says(does: list[str] | None) -> None:
    one = judged(given(written(does)), f"{VELOCITY}.topic")
    assert (one.points, one.reason) == (5, "/velocity_publisher publishes on /cmd_vel.")


def test_what_was_seen_outside_the_lab_is_told_so() -> None:
    end = "AssertionError: The 'x' field must be of type 'float'"
    evidence = given(evidences.runs(replace(evidences.velocity_run(), refused=end)))
    for name in ("repetition", "life"):
        one = judged(evidence, f"{VELOCITY}.{name}")
        assert one.reason.endswith(" outside the lab, which refuses its numbers.")
        assert one.points == one.max
    one = judged(evidence, f"{VELOCITY}.values")
    assert one.points == 0
    assert one.reason.startswith(f"The lab refuses what is assigned to a float field: “{end}”.")
    assert "outside the lab" not in judged(evidence, f"{STATUS}.life").reason


def with_velocity(after: dict[str, int], before: int) -> Run:
    """Return a run of a velocity publisher with so many messages before all commands, and after each."""

    def came(count: int, start: float) -> dict[str, Any]:
        values = [evidences.twist(0.5 + start)] * count
        return (
            {"/cmd_vel": evidences.heard(TWIST, "/velocity_publisher", values, 0.5, start)} if count else {}
        )

    commands = [
        CommandSeen(text, [], came(count, 20.0 + 5 * number), {}, True)
        for number, (text, count) in enumerate(after.items())
    ]
    return replace(evidences.velocity_run(values=[]), quiet=came(before, 0.0), commands=commands)


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (5, {}, "again and again."),
        (5, {"start": 0, "stop": 0}, "again and again."),
        (0, {"start": 4, "stop": 4}, "again and again."),
        (0, {"start": 1, "stop": 1, "reset": 1}, "none in between."),
        (1, {"start": 1, "stop": 0, "reset": 1}, "none in between."),
        (0, {"a, b, c": 3, "start": 1}, "none in between."),
    ],
)
def test_how_messages_come_is_said(before: int, after: dict[str, int], said: str) -> None:
    runs = [evidences.status_run(), evidences.command_run(), with_velocity(after, before)]
    one = judged(evidences.right(runs), f"{VELOCITY}.repetition")
    assert (one.points, one.reason.endswith(said)) == (4, True), one.reason


def test_a_program_that_cannot_be_imported_is_not_said_to_be_found() -> None:
    evidence = evidences.right()
    assert evidence.build
    broken = replace(evidences.executable("camera"), command=[], fault="Its module cannot be imported: no.")
    build = replace(evidence.build, executables=[*evidence.build.executables, broken])
    one = judged(replace(evidence, build=build), "package.executables")
    assert one.points == 3
    assert one.reason.endswith("where `ros2 run` finds it; but these cannot be imported: camera.")


def test_entry_points_that_are_written_are_not_asked_for_again() -> None:
    """Where a comma is missing, all of them are written."""
    broken = evidences.facts("setup", "entry_points_lead_to_functions")
    one = judged(given(broken, evidences.unbuilt("no")), "package.executables")
    assert one.reason.startswith("Entry points are written, but")
    assert one.points == 0
    none = given(evidences.facts("setup", "has_entry_points"), evidences.misplaced(*evidences.NODES))
    assert judged(none, "package.executables").reason == "`ros2 run` finds no node of this package."


@pytest.mark.parametrize(
    ("never", "begins", "points", "said"),
    [
        (["repeats"], False, 2.0, "Nothing came, for the code publishes only once"),
        ([], False, 0, "There were no numbers"),
        ([], True, 2.0, "Nothing came, for the code publishes at its start and hangs"),
    ],
)
def test_what_is_published_only_once_is_charged_where_it_is_to_come_again(
    never: list[str], begins: bool, points: float, said: str
) -> None:
    """Its numbers stand in the code; nobody had the time to receive them."""
    end = WrittenEnd("/cmd_vel", TWIST, True, [], VELOCITY, ["publishes"], never, begins=begins)
    evidence = given(evidences.runs(evidences.velocity_run(values=[])), evidences.files(ends=[end]))
    one = judged(evidence, f"{VELOCITY}.values")
    assert one.points == pytest.approx(points, abs=0.01)
    assert one.reason.startswith(said)
    assert judged(evidence, f"{VELOCITY}.repetition").points == 0


def test_a_slip_of_typing_takes_nothing_from_what_the_code_plainly_has() -> None:
    """Where Python reads the line and the node ends at it, too."""
    as_is = WrittenEnd("/robot/status", STRING, True, [], STATUS, [])
    others = [run for run in evidences.right().runs if run.programs == [COMMAND] and run.setting == "alone"]
    evidence = replace(given(evidences.files(ends=[as_is])), runs=others)
    assert judged(evidence, f"{STATUS}.period").points == 0
    evidence = evidences.files(ends_meant=[replace(as_is, periods=[2.0])])(evidence)
    assert judged(evidence, f"{STATUS}.period").points == 1.75


@pytest.mark.parametrize("code", ["entry-point-spec", "entry-point-module", "entry-point-no-function"])
def test_an_entry_point_that_misses_its_module_is_not_said_to_be_missing(code: str) -> None:
    cause = "The entry point 'velocity_publisher = a.b.main' has a dot before main where a colon should be."
    finding = [code, cause, "setup.py:20", "write 'velocity_publisher = a.b:main'", VELOCITY]
    base = given(evidences.misplaced(VELOCITY), evidences.files(findings=[finding]))
    assert base.build is not None
    programs = [
        replace(one, name=f"{VELOCITY}.py", way="module", fault="No entry point leads to it.")
        if one.name == VELOCITY
        else one
        for one in base.build.executables
    ]
    runs = [
        replace(run, programs=[f"{VELOCITY}.py"]) if run.programs == [VELOCITY] else run for run in base.runs
    ]
    alone = [run for run in runs if run.setting == "alone"]
    evidence = replace(base, build=replace(base.build, executables=programs), runs=alone)
    one = judged(evidence, "package.executables")
    assert one.reason == f"`ros2 run` does not start velocity_publisher: {cause}"
    assert one.hint.startswith("Let an entry point")


def test_what_lies_in_a_node_that_goes_on_explains_no_part_that_is_missing() -> None:
    finding = ["attribute-missing", "Watcher has no method get_type.", "watcher.py:9", "write self.get_types"]
    watcher = replace(evidences.executable("watcher"), modules=["watcher"])
    run = Run(
        ["watcher"], "alone", "stepped", ["/watcher"], {}, {}, {}, {}, {}, [], {}, {"watcher": {"last": {}}}, []
    )  # fmt: skip
    base = given(evidences.files(findings=[finding], ends=[], compared=[]))
    assert base.build is not None
    base = replace(base, build=replace(base.build, executables=[*base.build.executables, watcher]))
    others = [run for run in base.runs if run.setting == "alone" and run.programs != [COMMAND]]
    for seen, told in ((run, 0), (replace(run, ended={"watcher": "AttributeError: get_type"}), 1)):
        grade = verdict(replace(base, runs=[*others, seen]), load())
        assert [fault.code for fault in grade.faults].count("attribute-missing") == told


@pytest.mark.parametrize(
    ("readme", "said"),
    [
        ("# Robot\n[INFO] [node]: well\n", "the README shows lines as a terminal prints them, and no link"),
        ("# Robot\nFilm: https://a.example/film\n", "no link was opened, such as https://a.example/film."),
        ("# Robot\nNothing.\n", "no picture, film or log was handed in, and no link was opened."),
    ],
)
def test_what_shows_that_it_ran_is_left_to_the_instructor(readme: str, said: str) -> None:
    """An output in a README may be one that is expected."""
    grade = verdict(given(evidences.files(readme=readme)), load())
    assert any(said in note for note in grade.notes)


def test_an_entry_point_without_a_function_is_said_to_name_none() -> None:
    words = json.dumps([10, "/nowhere", "json", "json:loads", "json:no"])
    said = subprocess.run(
        [sys.executable, "-c", programs._IMPORTER, words], capture_output=True, text=True, check=True
    )
    wanted = ["Its entry point names no function in json.", "", "There is no no in json."]
    assert json.loads(said.stdout) == wanted


def not_imported(*names: str) -> evidences.Change:
    """Let entry points be installed whose modules cannot be imported as installed."""
    fault = "Its module cannot be imported: No module named 'robot_controller.common'."
    return evidences.both(
        evidences.facts("setup", "installs_modules"), evidences.misplaced(*names, fault=fault)
    )


@pytest.mark.parametrize(
    ("change", "points", "said"),
    [
        (not_imported(STATUS, COMMAND, VELOCITY), 1, "but what is installed does not start: Its module cannot"),
        (evidences.facts("setup", "installs_modules"), 3, "Each program that has a node is installed where"),
        (
            evidences.both(
                evidences.facts("setup", "scripts_go_to_lib"),
                evidences.misplaced(STATUS, COMMAND, VELOCITY, fault="It was installed in bin."),
            ),
            1,
            "but nothing is installed where `ros2 run` looks",
        ),
    ],
)  # fmt: skip
def test_what_is_installed_is_not_said_to_be_missing(
    change: evidences.Change, points: float, said: str
) -> None:
    """A folder of modules that nothing installs need not be imported, and its absence counts at setup.py."""
    one = judged(given(change), "package.executables")
    assert (one.points, said in one.reason) == (points, True), one.reason


@pytest.mark.parametrize(
    ("name", "loosely"),
    [
        ("status_publisher", ""),
        ("Status Publisher", ", in another spelling the node /status_publisher"),
    ],
)
def test_a_node_that_is_named_in_words_is_said_so(name: str, loosely: str) -> None:
    readme = evidences.README.replace("status_publisher", name).replace("robot.launch.py", "it")
    one = judged(given(evidences.files(readme=readme)), "documentation.interface")
    assert (one.points, one.reason) == (2, f"The README names the topics and the nodes{loosely}.")


def _anew(*words: str, node: str = "/command_subscriber") -> Run:
    """Return a run in which a node is there anew at some words."""
    run = evidences.command_run(texts=(*SCRIPT.words, "dance", "twirl", "start", "dance", "twirl"))
    commands = [replace(one, anew=[node] if one.text in words else []) for one in run.commands]
    return replace(run, commands=commands)


@pytest.mark.parametrize(
    ("run", "points"),
    [
        (_anew("twirl"), 0),
        (_anew("dance", "twirl"), 0),
        (_anew("reset"), 4),
        (_anew("start", "dance"), 4),
        (_anew("twirl", node="/status_publisher"), 4),
    ],
    ids=["at unknown words", "at each", "as it was told to", "perhaps as it was told to", "another node"],
)
def test_a_node_that_begins_anew_at_an_unknown_word_does_not_live_on(run: Run, points: float) -> None:
    one = judged(given(evidences.runs(run)), f"{COMMAND}.robustness")
    assert one.points == points
    assert ("and began anew" in one.reason) == (not points)


def _beside(*ended: str, at: str = "dance") -> Run:
    """Return a run of all together in which some programs end at a word."""
    run = replace(evidences.command_run(texts=("seoee, sopst", *SCRIPT.few)), setting="together")
    after = [
        replace(one, is_alive=False, log=[]) if at in one.text.split(", ") else one for one in run.commands
    ]
    return replace(run, programs=[COMMAND, STATUS], commands=after, ended=dict.fromkeys(ended, "What?"))


@pytest.mark.parametrize(
    ("run", "word"),
    [
        (_beside(COMMAND), "the command 'dance'"),
        (_beside(COMMAND, at="sopst"), "the commands 'seoee, sopst'"),
        (_beside(STATUS), ""),
        (_beside(COMMAND, STATUS), ""),
    ],
    ids=["it ends", "it ends at coined words", "another one ends", "both end, for whatever reason"],
)
def test_a_node_that_a_word_ends_beside_the_others_does_not_live_on(run: Run, word: str) -> None:
    evidence = evidences.right()
    one = judged(replace(evidence, runs=[*evidence.runs, run]), f"{COMMAND}.robustness")
    assert one.points == (0 if word else 4)
    assert one.reason.startswith(f"After {word}, " if word else "command_subscriber lives on")


def test_where_messages_came_from_no_node_that_ros_shows_the_reason_says_so() -> None:
    """As with `ros2 topic pub`, also if a script that nobody can read starts it."""
    evidence = evidences.right()
    runs = [
        replace(
            run, publishes={topic: ends for topic, ends in run.publishes.items() if topic != "/robot/status"}
        )
        for run in evidence.runs
    ]
    assert evidence.build is not None
    scripts = [
        replace(one, target="", modules=[]) if one.name == STATUS else one
        for one in evidence.build.executables
    ]
    shown = replace(evidence, runs=runs, build=replace(evidence.build, executables=scripts))
    reason = judged(shown, f"{STATUS}.topic").reason
    assert reason.startswith("No node that publishes on /robot/status was seen, although messages came on it")
    assert "cannot be started" not in reason


@pytest.mark.parametrize("is_own", [False, True])
def test_nobody_publishes_the_clock_unless_the_work_does(is_own: bool) -> None:
    evidence = evidences.right()
    runs = [replace(run, clocked=["/status_publisher"]) for run in evidence.runs]
    runs[-1] = replace(runs[-1], notes=[OWN_CLOCK] if is_own else [])
    notes = verdict(replace(evidence, runs=runs), load()).notes
    assert any("nobody publishes /clock" in note for note in notes) != is_own


@pytest.mark.parametrize(
    ("change", "points", "said"),
    [
        (lambda evidence: evidence, 2, "Marker, package.xml and executables go where ROS looks for them."),
        (
            evidences.facts("setup", "marker_is_installed", "manifest_is_installed", "marker_exists"),
            2,
            "Marker, package.xml and executables go where ROS looks for them.",
        ),
        (
            evidences.both(evidences.facts("setup", "has_entry_points"), evidences.misplaced(*NODES)),
            2,
            "Marker and package.xml go where ROS looks for them.",
        ),
        (
            evidences.unbuilt("SyntaxError: invalid syntax"),
            2,
            "Marker and package.xml go where ROS looks for them.",
        ),
        (
            evidences.by_colcon("a marker in the package index"),
            1,
            "In the package setup.py installs no marker for robot_controller.",
        ),
        (
            evidences.misplaced(*NODES, fault=ELSEWHERE_THAN),
            0,
            "In the package nothing sends the executables to lib/robot_controller, as setup.cfg is to, so `ros2 run` does not find them.",
        ),
    ],
    ids=[
        "right",
        "right, though not as usual",
        "no entry points",
        "not built",
        "by colcon",
        "that of another package",
    ],
)
def test_where_things_go_is_told_of_what_was_installed(
    change: evidences.Change, points: float, said: str
) -> None:
    one = judged(given(change), "package.registration")
    assert (one.points, one.reason) == (points, said)


@pytest.mark.parametrize(
    ("lost", "broken", "points", "named"),
    [
        ([STATUS], [], 1, "status_publisher"),
        ([STATUS], ["talker"], 1, "status_publisher and talker"),
        ([STATUS, COMMAND, VELOCITY], [], 0, "status_publisher, command_subscriber and velocity_publisher"),
    ],
)
def test_all_programs_are_named_that_do_not_start(
    lost: list[str], broken: list[str], points: float, named: str
) -> None:
    """Also those of which no node is missed, which cost nothing."""
    fault = "Its module cannot be imported: SyntaxError: invalid syntax."

    def change(evidence: Evidence) -> Evidence:
        assert evidence.build
        others = [replace(evidences.executable(name), fault=fault, command=[]) for name in broken]
        build = replace(evidence.build, executables=[*evidence.build.executables, *others])
        return replace(evidence, build=build)

    one = judged(given(evidences.misplaced(*lost, fault=fault), change), "package.executables")
    assert (one.points, one.reason.partition(": ")[0]) == (points, f"`ros2 run` does not start {named}")


@pytest.mark.parametrize(("name", "points"), [(STATUS, 1), ("camera", 3)])
def test_an_entry_point_to_no_file_costs_where_a_node_is_missing(name: str, points: float) -> None:
    """To leave the file out is no better than to misname it; what no part is missed of costs nothing."""
    cause = f"The entry point {name} names the module robot_controller.{name}, but there is no such file."
    finding = ["entry-point-module", cause, "setup.py:20", f"create {name}.py", name]
    nowhere = replace(
        evidences.executable(name), command=[], modules=[], fault="Its module cannot be imported: no."
    )

    def change(evidence: Evidence) -> Evidence:
        assert evidence.build
        programs = [one for one in evidence.build.executables if one.name != name]
        runs = [run for run in evidence.runs if name not in run.programs]
        return replace(evidence, build=replace(evidence.build, executables=[*programs, nowhere]), runs=runs)

    broken = evidences.facts("setup", "entry_points_lead_to_functions")
    one = judged(given(change, broken, evidences.files(findings=[finding])), "package.executables")
    assert one.points == points
    assert (cause in one.reason) is (points == 1)


def test_each_program_is_said_not_to_start_for_its_own_reason() -> None:
    alone = [run for run in evidences.right().runs if run.setting == "alone"]
    runs = [replace(run, programs=["Status"]) if run.programs == [STATUS] else run for run in alone]
    nowhere = replace(evidences.executable(STATUS), command=[], fault="Its module cannot be imported: no.")
    other = replace(evidences.executable("Status"), way="module", fault="No entry point leads to it.")
    base = given()
    assert base.build
    programs = [nowhere, *(one for one in base.build.executables if one.name != STATUS), other]
    evidence = replace(base, build=replace(base.build, executables=programs), runs=runs)
    assert judged(evidence, "package.executables").reason == (
        "`ros2 run` does not start Status: No entry point leads to it. "
        "status_publisher: Its module cannot be imported: no."
    )


@pytest.mark.parametrize(
    ("period", "told"), [(0.05, "0.05 s"), (0.0004, "0.001 s"), (0.52, "0.5 s"), (1.04, "1.0 s")]
)
def test_a_short_time_between_messages_is_not_told_as_twice_as_long(period: float, told: str) -> None:
    one = judged(given(evidences.runs(evidences.status_run(period=period))), f"{STATUS}.period")
    assert f" {told}," in one.reason


def test_what_was_typed_is_told() -> None:
    run = replace(evidences.velocity_run(), typed=["1", "y"])
    one = judged(given(evidences.runs(run)), f"{VELOCITY}.repetition")
    assert one.reason == "Messages come on /cmd_vel again and again, while '1' and 'y' were typed."


@pytest.mark.parametrize(
    ("file", "part"), [("velocity.py", VELOCITY), ("status_node.py", STATUS), ("robot.py", STATUS)]
)
def test_a_node_of_ros_1_is_written_and_told_where_it_is_named(file: str, part: str) -> None:
    """A file that is named for no part is told once, at one that has lost."""
    names = (STATUS, COMMAND, VELOCITY)
    rospy = ["ros1-import", "rospy belongs to ROS 1.", f"robot_controller/{file}:1", "import rclpy"]

    def change(evidence: Evidence) -> Evidence:
        assert evidence.build
        return replace(evidence, build=replace(evidence.build, executables=[]), runs=[])

    found = verdict(given(evidences.files(findings=[rospy], ends=[]), change), load())
    assert [one.component for one in found.faults if one.code == "ros1-import"] == [part]
    hints = {one.component: one.hint for one in found.criteria if one.id.endswith(".topic")}
    first = {name for name in names if hints[name] == "Fix first why the node was not seen."}
    assert first == ({part} if file != "robot.py" else set())
