"""What evidence is worth: right in many styles, single faults, pairs, and what is not there."""

from __future__ import annotations

import itertools
import json
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from typing import Any

import evidences
import pytest
from evidences import BONUS_FAULTS, FAULTS, PAIRS, STYLES, right

from ros2lab import assignments
from ros2lab.grading.evidence import NO_WORD, OTHER_TYPE, CommandSeen, Evidence, Place, Run, WrittenEnd
from ros2lab.grading.grade import Grade, Judgement
from ros2lab.grading.judging.player import lacked
from ros2lab.grading.overrides import Decision
from ros2lab.grading.questions.answer import ended, last_word
from ros2lab.grading.receiving.notes import Kind, Note
from ros2lab.grading.receiving.submission import FoundPackage
from ros2lab.grading.rubric import Rubric, load
from ros2lab.grading.sandbox.keeper import LIMITS, is_limit
from ros2lab.grading.verdict import verdict

# Faults of one part that are shown by the run of another one.
OF_TWO_PROGRAMS = ("command: moves but does not log", "command: anything moves the robot")
# With capitals in its name the one package is not the other one's twin.
TWINS_ONCE_MENDED = {"name with capitals", "package twice"}
WORDS = assignments.load().parts["command_subscriber"].commands


def judged(evidence: Evidence, rubric: Rubric, criterion: str) -> Judgement:
    return next(one for one in verdict(evidence, rubric).criteria if one.id == criterion)


@pytest.fixture(scope="module")
def rubric() -> Rubric:
    return load()


def losing(grade: Grade) -> dict[str, float]:
    return {
        name: round(one.max - one.points, 2)
        for name, one in grade.components.items()
        if name != "bonus" and one.points < one.max
    }


def lost(grade: Grade) -> list[str]:
    return [f"{one.id}: {one.reason}" for one in grade.criteria if one.points < one.max]


def test_all_of_it(rubric: Rubric) -> None:
    grade = verdict(right(), rubric)
    assert (grade.total, grade.max) == (110, 100)
    assert not lost(grade)
    assert not grade.faults
    assert grade.clock == "stepped"
    assert grade.seconds == {"unpack": 0.1, "build": 1.3, "observe": 2.0, "total": 3.4}


@pytest.mark.parametrize("style", STYLES)
def test_a_style_loses_nothing(rubric: Rubric, style: str) -> None:
    grade = verdict(STYLES[style](), rubric)
    assert losing(grade) == {}, lost(grade)
    assert grade.total - grade.components["bonus"].points == 100


def does_not_build(evidence: Evidence) -> bool:
    """Return whether the build fails, and not only for the type of the package."""
    build = evidence.build
    return build is not None and not build.is_built and not build.error.startswith(OTHER_TYPE[0])


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_costs_its_component_and_no_other(rubric: Rubric, fault: str) -> None:
    """But for a package that does not build, which costs half of the build besides."""
    component, change = FAULTS[fault]
    evidence = change(right())
    grade = verdict(evidence, rubric)
    is_unbuilt = component == "package" and does_not_build(evidence)
    components = ["workspace", component] if is_unbuilt else [component]
    assert list(losing(grade)) == components, lost(grade)
    assert {one.component for one in grade.faults} - {"bonus"} == {*components}
    assert not is_unbuilt or losing(grade)["workspace"] == 3


@pytest.mark.parametrize("fault", [*FAULTS, *BONUS_FAULTS])
def test_a_lost_point_has_a_reason_and_a_hint(rubric: Rubric, fault: str) -> None:
    _, change = (FAULTS | BONUS_FAULTS)[fault]
    for one in verdict(change(right()), rubric).criteria:
        assert "{" not in one.reason + one.hint
        assert ": ." not in one.reason
        assert one.evidence
        assert bool(one.hint) == (one.points < one.max)


@pytest.mark.parametrize("fault", BONUS_FAULTS)
def test_a_fault_of_the_bonus_costs_that(rubric: Rubric, fault: str) -> None:
    criterion, change = BONUS_FAULTS[fault]
    grade = verdict(change(right()), rubric)
    assert [one.id for one in grade.criteria if one.points < one.max] == [criterion]


@pytest.mark.parametrize(("one", "other"), PAIRS)
def test_both_of_two_faults_are_charged(rubric: Rubric, one: str, other: str) -> None:
    first, second = FAULTS[one], FAULTS[other]
    grade = verdict(second[1](first[1](right())), rubric)
    singles = [losing(verdict(change(right()), rubric)) for _, change in (first, second)]
    assert losing(grade) == singles[0] | singles[1], lost(grade)


@pytest.mark.parametrize("step", [31, pytest.param(1, marks=pytest.mark.thorough)])
def test_mending_one_of_two_faults_never_costs(rubric: Rubric, step: int) -> None:
    """Of all pairs of faults that do not meet in the same facts: neither the total nor a component becomes less.

    Of the bonus only the total tells: what launches all nodes that work launches too few once another one works.
    """
    faults = {**FAULTS, **BONUS_FAULTS}
    changes = {name: change for name, (_, change) in faults.items() if name not in OF_TWO_PROGRAMS}
    alone = {name: change(right()) for name, change in changes.items()}
    grades = {name: verdict(evidence, rubric) for name, evidence in alone.items()}
    count, dearer = 0, []
    for one, other in itertools.islice(itertools.combinations(changes, 2), 0, None, step):
        both = changes[other](alone[one])
        if both != changes[one](alone[other]) or {one, other} == TWINS_ONCE_MENDED:
            continue  # the later change has undone the earlier one, or is all that keeps them from meeting
        count += 1
        grade = verdict(both, rubric)
        dearer += [(one, other, what) for name in (one, other) for what in costs(grade, grades[name])]
    assert count > 3000 / step
    assert dearer == []


def costs(before: Grade, after: Grade) -> list[str]:
    """Return what is worth less afterwards: components, and the total."""
    components = [name for name in before.components if name != "bonus"]
    less = [name for name in components if before.components[name].points > after.components[name].points]
    return [*less, "total"] if before.total > after.total else less


def test_there_is_enough_of_everything() -> None:
    assert len(STYLES) >= 12
    assert len(FAULTS) >= 60
    assert len(PAIRS) >= 10


def test_nothing_is_worth_nothing(rubric: Rubric) -> None:
    grade = verdict(evidences.nothing(), rubric)
    assert grade.total == 0
    assert {one.points for one in grade.components.values()} == {0}


def test_an_untouched_package_gets_what_it_has_earned(rubric: Rubric) -> None:
    components = verdict(evidences.untouched(), rubric).components
    points = {name: one.points for name, one in components.items()}
    assert points.pop("workspace") == 15
    assert 0 < points.pop("package") < 12
    assert set(points.values()) == {0}


def test_loose_files_are_graded_by_what_they_do(rubric: Rubric) -> None:
    e = right()
    assert e.build
    programs = [
        replace(one, way="script", target="", fault="There is no package to which it belongs.")
        for one in e.build.executables
    ]
    build = replace(e.build, is_built=False, executables=programs, shared=[])
    e = replace(
        evidences.submission(form="files", workspace=None, package=None, packages=[])(e),
        build=build,
        files=replace(e.files, manifest={}, setup={}),
    )
    components = verdict(e, rubric).components
    assert components["workspace"].points == components["package"].points == 0
    assert all(
        components[name].points == 20 for name in (evidences.STATUS, evidences.COMMAND, evidences.VELOCITY)
    )


def test_a_node_more_on_a_nearly_right_topic_costs_nothing(rubric: Rubric) -> None:
    """Where nothing comes on it, what comes on another topic is graded as before."""
    other = evidences.runs(evidences.status_run("/talker", topic="/feedback"))(right())
    silent = evidences.status_run("/spare", "spare", topic="/robot_status", values=0)
    more = replace(other, runs=[*other.runs, silent])
    assert losing(verdict(more, rubric)) == losing(verdict(other, rubric)) != {}


@pytest.mark.parametrize("end", ["", "Traceback (most recent call last)\nValueError: no"])
def test_a_node_that_passes_messages_on_is_not_judged_by_where_they_come_from(
    rubric: Rubric, end: str
) -> None:
    """Alone it has nothing to publish; the one that is heard alone has another topic, whatever becomes of it."""
    source = evidences.velocity_run("/pilot", "pilot", topic="/wheel_speed")
    relay = evidences.velocity_run(values=[])
    dying = replace(source, ended={"pilot": end}, stalled=["/wheel_speed"]) if end else source
    apart = [evidences.status_run(), evidences.command_run(), relay]
    together = evidences.merged([*apart[:2], evidences.velocity_run(), source], "pilot", "together")
    together = replace(together, programs=["pilot", evidences.VELOCITY])
    given = right([*apart, dying, together])
    one = judged(given, rubric, "velocity_publisher.life")
    assert (one.points, one.reason) == (4, "velocity_publisher goes on until it is stopped.")


# How much is lost: more for what is worse.
@pytest.mark.parametrize(
    ("less", "more"),
    [
        ("status: 2.4 s", "status: 1.0 s"),
        ("status: 1.0 s", "status: never"),
        ("status: in ms", "status: never"),
        ("status: never", "status: crashes"),
        ("status: topic one letter away", "status: another topic"),
        ("command: no reset", "command: only start"),
        ("command: only echoes", "command: silent"),
        ("velocity: once", "velocity: never"),
        ("velocity: stamped", "velocity: type"),
        ("velocity: never", "velocity: crashes"),
        ("no rclpy", "no std_msgs, no geometry_msgs"),
        ("one entry point misspelt", "two entry points missing"),
        ("little described", "nothing described"),
    ],
)
def test_a_worse_fault_costs_more(rubric: Rubric, less: str, more: str) -> None:
    one, other = (verdict(FAULTS[name][1](right()), rubric).total for name in (less, more))
    assert one > other


def test_a_build_that_was_ended_has_shown_nothing(rubric: Rubric) -> None:
    """What only fails says what is wrong, and leaves other packages of the workspace to be built."""
    cut = "It ran longer than 60 s."
    failed = evidences.unbuilt(cut)(right())
    assert failed.build
    ended = verdict(replace(failed, build=replace(failed.build, cut=cut)), rubric)
    points = {criterion.id: criterion.points for criterion in ended.criteria}
    assert not any(points[name] for name in ("workspace.build", "package.setup", "package.executables"))
    assert ended.total <= verdict(failed, rubric).total - 3
    assert "It ran longer than 60 s." in next(
        one.reason for one in ended.criteria if one.id == "workspace.build"
    )


def test_a_reason_says_what_was_seen(rubric: Rubric) -> None:
    def reason(fault: str, criterion: str) -> str:
        return judged(FAULTS[fault][1](right()), rubric, criterion).reason

    assert "every 2.4 s" in reason("status: 2.4 s", "status_publisher.period")
    assert "/robot/staus" in reason("status: topic one letter away", "status_publisher.topic")
    assert "'rospy'" in reason("status: crashes", "status_publisher.topic")
    assert "'dance'" in reason("command: dies of an unknown one", "command_subscriber.robustness")
    assert "geometry_msgs" in reason("no std_msgs, no geometry_msgs", "package.dependencies")


def test_evidence_keys_lead_to_the_evidence(rubric: Rubric) -> None:
    grade = verdict(right(), rubric)
    by_id = {one.id: one for one in grade.criteria}
    assert by_id["status_publisher.period"].evidence == ["runs[0].quiet./robot/status"]
    assert by_id["command_subscriber.commands"].evidence[0] == "runs[1].commands[0]"


@pytest.mark.parametrize("make", [right, *(STYLES.values())])
def test_the_same_evidence_gives_the_same_grade(rubric: Rubric, make: Callable[[], Evidence]) -> None:
    one, two = (json.dumps(asdict(verdict(make(), rubric))) for _ in range(2))
    assert one == two


def test_what_varies_between_two_runs_does_not_show(rubric: Rubric) -> None:
    def graded(times: list[float], address: str) -> str:
        run = evidences.status_run(period=2.4)
        run = replace(
            run, clock="real", quiet={"/robot/status": replace(run.quiet["/robot/status"], times=times)}
        )
        crash = evidences.without(evidences.VELOCITY, f"RuntimeError: <object at {address}> is gone")
        return json.dumps(asdict(verdict(crash(evidences.runs(run)(right())), rubric)))

    assert graded([0.1, 2.51, 4.92], "0x7f12ab34") == graded([0.3, 2.69, 5.11], "0x7fffab00")


def test_a_finding_of_the_diagnosis_is_the_fault(rubric: Rubric) -> None:
    place = f"{evidences.FOLDER}/robot_controller/velocity_publisher.py:12"
    change = evidences.both(
        FAULTS["velocity: int"][1],
        evidences.finding("int-in-float", "An int was assigned.", place, "write 1.0"),
    )
    (fault,) = verdict(change(right()), rubric).faults
    assert (fault.code, fault.component, fault.place, fault.fix) == (
        "int-in-float",
        "velocity_publisher",
        place,
        "write 1.0",
    )


def test_a_finding_about_another_node_is_not_its_fault(rubric: Rubric) -> None:
    place = f"{evidences.FOLDER}/robot_controller/status_publisher.py:12"
    change = evidences.both(
        FAULTS["velocity: crashes"][1], evidences.finding("import-wrong", "It is wrong.", place, "fix it")
    )
    (fault,) = verdict(change(right()), rubric).faults
    assert (fault.code, fault.component) == ("velocity-publisher-missing", "velocity_publisher")


def test_a_finding_that_costs_nothing_is_no_fault(rubric: Rubric) -> None:
    change = evidences.finding(
        "dependency-undeclared", "launch is not declared.", "package.xml", "declare it"
    )
    assert verdict(change(right()), rubric).faults == []


def test_hostile_text_is_tamed(rubric: Rubric) -> None:
    end = "RuntimeError: \x1b[31m\u202e" + "{node}<b>" * 100
    for change in (evidences.without(evidences.STATUS, end), evidences.ended(evidences.VELOCITY, end)):
        text = json.dumps(asdict(verdict(change(right()), rubric)), ensure_ascii=False)
        assert "\x1b" not in text
        assert "\\u001b" not in text
        assert "\u202e" not in text
        assert all(len(one.reason) < 400 for one in verdict(change(right()), rubric).criteria)


def _told(run: Run, until: int, texts: Sequence[str] = evidences.SCRIPT.all, **more: Any) -> Run:
    """Return a run of a publisher that takes the commands, too; what it publishes comes after so many of them."""
    taken = evidences.command_run(run.nodes[0], run.programs[0], texts=(*texts,), log=lambda _: [])
    commands = [
        replace(one, topics=run.quiet if number < until else {}) for number, one in enumerate(taken.commands)
    ]
    return replace(run, subscribes=taken.subscribes, commands=commands, commanded=taken.commanded, **more)


AGAIN = ("reop, etsr, ptast", *evidences.SCRIPT.few)
SILENT = "lives on, but nothing comes on"


@pytest.mark.parametrize(
    ("run", "life"),
    [
        (_told(evidences.status_run(), 0), f"{SILENT} /robot/status any more after 'start' was said."),
        (_told(evidences.status_run(), 4), f"{SILENT} /robot/status any more after 'dance' was said."),
        (_told(evidences.status_run(), 1, AGAIN), f"{SILENT} /robot/status any more after 'start' was said."),
        (_told(evidences.status_run(), 99), ""),
        (_told(evidences.status_run(), len(evidences.SCRIPT.all) - 2), ""),  # two words are soon said
        (_told(evidences.status_run(), 4, ("start", "stop", "reset", "START", "hush", "start", "start")), ""),
        (_told(evidences.status_run(), 0, clock="real"), ""),
        (_told(evidences.status_run(), 0, unfinished="the time ran out"), ""),
        (_told(evidences.velocity_run(), 0, AGAIN), f"{SILENT} /cmd_vel any more after 'reop, etsr, ptast' was said."),
        (_told(evidences.velocity_run(), 1, ("start", "dance", "stop", "reset", "start")), f"{SILENT} /cmd_vel any more after 'dance' was said."),
        (_told(evidences.velocity_run(), 1), ""),  # it stops when it is told to
        (_told(evidences.velocity_run(), 3), ""),  # it may wait for a reset
        (_told(evidences.velocity_run(), 99), ""),
        (_told(evidences.velocity_run(values=[evidences.twist(0.1)]), 0, AGAIN), ""),  # it came once
    ],
)  # fmt: skip
def test_a_word_silences_no_publisher_for_good(rubric: Rubric, run: Run, life: str) -> None:
    (program,) = run.programs
    criterion = judged(evidences.runs(run)(right()), rubric, f"{program}.life")
    assert criterion.reason == (f"{program} {life}" if life else f"{program} goes on until it is stopped.")
    assert criterion.points == (criterion.max / 4 if life else criterion.max)


@pytest.mark.parametrize("setting", ["alone", "together"])
def test_a_word_that_ends_a_publisher_ends_its_life(rubric: Rubric, setting: str) -> None:
    """Whether it is a program of its own that takes the commands, too, or is seen to only beside the others."""
    run = _told(evidences.velocity_run(), 99, evidences.SCRIPT.all[:4], setting=setting)
    commands = [replace(one, is_alive=one is not run.commands[-1]) for one in run.commands]
    dead = replace(run, commands=commands, ended={evidences.VELOCITY: "KeyError: 'START'"}, stopped={})
    given = [evidences.status_run(), evidences.command_run(), evidences.velocity_run(), dead]
    grade = verdict(evidences.right(given if setting == "together" else [*given[:2], dead]), rubric)
    assert {one.id: one.points for one in grade.criteria if one.points < one.max and "life" in one.id} == {
        "velocity_publisher.life": 1
    }


def test_all_in_one_process_that_dies_of_a_command_is_charged_once(rubric: Rubric) -> None:
    e = evidences.one_process()
    (run, *others) = e.runs
    commands = [replace(one, is_alive=one.text != "dance") for one in run.commands[:5]]
    dead = replace(run, commands=commands, ended={"robot": "KeyError: 'dance'"})
    assert list(losing(verdict(replace(e, runs=[dead, *others]), rubric))) == ["command_subscriber"]


@pytest.mark.parametrize(
    ("word", "points"),
    [
        ("start", {"commands": 3, "robustness": 0}),
        ("stop", {"robustness": 0}),
        ("reset", {"robustness": 0}),
    ],
)
def test_what_could_not_be_tried_after_an_end_is_not_charged(
    rubric: Rubric, word: str, points: dict[str, float]
) -> None:
    """The node ends itself once it has said what it does; nothing tells whether it knows start from other words."""
    (run,) = (run for run in right().runs if run.programs == [evidences.COMMAND] and run.setting == "alone")
    texts = [one.text for one in run.commands]
    run = evidences.command_run(
        log=lambda text: [f"Received: {text}", *([f"now {text}ed"] if text != "start" else [])]
    )
    until = [replace(one, is_alive=one.text != word) for one in run.commands[: texts.index(word) + 1]]
    dead = replace(run, commands=until, ended={evidences.COMMAND: "SystemExit"}, stopped={})
    lost = {
        one.id.partition(".")[2]: one.points
        for one in verdict(evidences.runs(dead)(right()), rubric).criteria
        if one.component == "command_subscriber" and one.points < one.max
    }
    assert lost == points


@pytest.mark.parametrize(
    ("name", "period", "level"),
    [
        ("aralik", 4.0, 2),
        ("aralik", 2.0, 0),
        ("aralik", 2.9, 0),  # by chance, for the value is twice what it was
        ("speed", 2.0, 0),
        ("publish_rate", 2.0, 0),
        ("publish_rate", 1.0, 2),
    ],
)
def test_a_period_may_have_any_name(rubric: Rubric, name: str, period: float, level: float) -> None:
    e = right()
    runs = [
        replace(run, parameters={"/status_publisher": {name: 2.0}})
        if run.programs == [evidences.STATUS]
        else run
        for run in e.runs
        if ":=" not in run.setting
    ]
    changed = replace(evidences.status_run(period=period), setting=f"{name}:=4.0")
    grade = verdict(replace(e, runs=[*runs, changed]), rubric)
    (one,) = (one for one in grade.criteria if one.id == "bonus.parameters")
    assert one.points == level
    assert ("No parameter" in one.reason) == (not level and name != "publish_rate")


def test_a_node_that_dies_is_not_the_fault_of_what_launches_it(rubric: Rubric) -> None:
    """It is gone before it is seen, and so are its parameters."""
    e = evidences.ended(evidences.VELOCITY, "AssertionError: The 'x' field must be of type 'float'.")(right())
    e = replace(e, files=replace(e.files, parameter_files={"robot.yaml": {"/velocity_publisher": {"period": 0.1}, "/status_publisher": {"period": 2.0}}}))  # fmt: skip
    status, command = (run for run in e.runs if run.setting == "alone" and not run.ended)
    launched = evidences.launched([status, command])
    e = replace(e, runs=[launched if run.setting == "launched" else run for run in e.runs])
    grade = verdict(e, rubric)
    assert {one.component for one in grade.faults} == {"velocity_publisher"}


@pytest.mark.parametrize("count", [0, 2])
def test_a_launch_file_that_starts_too_few_costs_no_parameter_file(rubric: Rubric, count: int) -> None:
    """What a parameter file says of the others fits them as they are alone."""
    e = right()
    alone = [run for run in e.runs if run.setting == "alone"]
    few = replace(evidences.launched(alone[:count] or alone), **({} if count else {"nodes": [], "publishes": {}, "subscribes": {}, "parameters": {}, "quiet": {}, "commands": []}))  # fmt: skip
    e = replace(e, runs=[few if run.setting == "launched" else run for run in e.runs])
    nodes = {f"/{name}": {"period": 2.0} for name in (evidences.STATUS, evidences.VELOCITY)}
    e = replace(e, files=replace(e.files, parameter_files=dict.fromkeys(e.files.parameter_files, nodes)))
    lost = {one.id for one in verdict(e, rubric).criteria if one.points < one.max}
    assert lost == {"bonus.launch"}


@pytest.mark.parametrize(
    ("speed", "points"),
    [
        ({"start": 0.0, "stop": 0.5, "reset": 0.0}, 3),
        ({"start": 0.0, "stop": 0.5}, 3),
        ({"start": 0.5, "stop": 0.0}, 6),
        ({"start": 0.5, "stop": 0.5, "reset": 0.0}, 6),  # what stop does is not told here
        ({"start": 0.5}, 6),
    ],
)
def test_start_and_stop_that_are_exchanged(rubric: Rubric, speed: dict[str, float], points: float) -> None:
    """What the robot does tells it, whatever the log says."""
    run = evidences.moving(evidences.command_run(log=evidences.log_by_word), speed)
    together = evidences.merged([evidences.status_run(), run, evidences.velocity_run()], "all", "together")
    criterion = judged(evidences.runs(together)(right()), rubric, "command_subscriber.commands")
    assert criterion.points == points


def test_a_status_that_is_late_is_no_answer(rubric: Rubric) -> None:
    """On the real clock the first one may come after the first command; what it says alone is known."""
    status = evidences.status_run()
    deaf = evidences.command_run(log=lambda _: [])
    together = evidences.launched([status, deaf])
    late = [
        replace(one, topics={"/robot/status": evidences.heard(evidences.STRING, "/status_publisher", [{"data": "well"}])})
        for one in together.commands
    ]  # fmt: skip
    e = evidences.runs(deaf)(right())
    e = replace(
        e,
        runs=[
            replace(together, quiet={}, commands=late) if run.setting == "launched" else run for run in e.runs
        ],
    )
    criterion = judged(e, rubric, "command_subscriber.commands")
    assert criterion.points == 0


def test_what_a_test_says_is_given_without_what_is_chance(rubric: Rubric) -> None:
    change = evidences.tests(
        failed=1, error="FAILED test/test_it.py::test_it - assert <object at 0x7fa77ac285e0>"
    )
    reason = judged(change(right()), rubric, "bonus.tests").reason
    assert reason == "The tests do not pass. “FAILED test/test_it.py::test_it - assert <object at …>”"


def test_an_error_has_the_place_in_the_submission(rubric: Rubric) -> None:
    end = (
        'File "/opt/rclpy/executors.py", line 9, in spin\n'
        'File "/submission/ws/install/pk/lib/python3.12/site-packages/pk/drive.py", line 20, in tick\n'
        'File "/opt/rclpy/publisher.py", line 5, in publish\nValueError: no\n'
    )
    grade = verdict(evidences.ended(evidences.VELOCITY, end)(right()), rubric)
    assert [fault.place for fault in grade.faults if "ValueError" in fault.cause] == [
        "robot_project_ws/src/robot_controller/pk/drive.py:20"
    ]


@pytest.mark.parametrize(
    ("answered", "command"),
    [
        (9, "very many commands"),
        (7, "an empty command"),
        (6, "an empty command"),
        (3, "the words 'START', 'dance', 'twirl', ''"),
        (2, "the command 'stop'"),
        (1, "the command 'start'"),
    ],
)
def test_a_node_is_deaf_after_what_it_answered_last(rubric: Rubric, answered: int, command: str) -> None:
    run = evidences.command_run()
    heard = [one if number < answered else replace(one, log=[]) for number, one in enumerate(run.commands)]
    criterion = judged(
        evidences.runs(replace(run, commands=heard))(right()), rubric, "command_subscriber.robustness"
    )
    assert criterion.points == criterion.max / 2
    assert (
        criterion.reason
        == f"command_subscriber answered at first, and not any more when it had taken {command}."
    )


def test_a_node_that_is_caught_in_a_loop_is_deaf_though_it_speaks(rubric: Rubric) -> None:
    run = evidences.command_run(
        log=lambda text: ["Driving", f"Heard {text}"] if text == "start" else ["Driving"]
    )
    first, *others = run.commands
    caught = [replace(one, log=[["INFO", "Driving"]]) for one in others]
    criterion = judged(
        evidences.runs(replace(run, commands=[first, *caught]))(right()),
        rubric,
        "command_subscriber.robustness",
    )
    assert (
        criterion.reason
        == "command_subscriber answered at first, and not any more when it had taken the command 'start'."
    )


def test_a_ramp_that_ends_by_itself_is_no_answer(rubric: Rubric) -> None:
    refusing = evidences.command_run(log=lambda text: [f"received {text}, which is not a command"])
    ramp = [evidences.twist(0.4 + number / 100) for number in range(10)]
    drive = evidences.velocity_run(values=ramp)
    given = evidences.runs(refusing, drive)(right())
    together = evidences.launched([evidences.status_run(), refusing, drive])
    speeds = {"start": ramp[:3], "stop": ramp[3:6], "reset": [evidences.twist(0.5)] * 3}
    obeyed = [
        replace(
            one, topics={"/cmd_vel": evidences.heard(evidences.TWIST, "/velocity_publisher", values, 0.1)}
        )
        for one in together.commands
        for values in [speeds.get(one.text, speeds["reset"])]
    ]
    together = replace(together, commands=obeyed)
    given = replace(given, runs=[together if run.setting == "launched" else run for run in given.runs])
    assert "an unknown one just the same" in judged(given, rubric, "command_subscriber.commands").reason


def test_a_node_that_shows_nothing_is_believed_if_its_code_tells_the_words_apart(rubric: Rubric) -> None:
    echoing = evidences.runs(evidences.command_run(log=evidences.echo))(right())
    for words, points in (("start", "stop", "reset"), 6), (("start", "stop"), 3), (("start",), 1.5), ((), 0):
        one = judged(
            evidences.files(depended_on=[*words, "x"])(echoing), rubric, "command_subscriber.commands"
        )
        assert one.points == points, one.reason
    deaf = evidences.runs(evidences.command_run(log=lambda _: []))(right())
    one = judged(
        evidences.files(depended_on=["start", "stop", "reset"])(deaf), rubric, "command_subscriber.commands"
    )
    assert one.points == 0


STATES = {"start": "running", "stop": "stopped", "reset": "idle"}


def with_state(says: Callable[[str, str], list[tuple[str, str]]]) -> Run:
    """Return a run of a node that says, with levels, something of each word and of the state it is in then."""
    run, state, commands = evidences.command_run(), "idle", []
    for one in run.commands:
        state = STATES.get(one.text, state)
        commands.append(replace(one, log=[[*line] for line in says(one.text, state)]))
    return replace(run, commands=commands)


def heard(text: str, *more: tuple[str, str]) -> list[tuple[str, str]]:
    return [("INFO", f"Received {text}"), *more]


@pytest.mark.parametrize(
    ("says", "compared", "points"),
    [
        # An unknown word comes while the robot stands, and while it moves: what is said both times is no reaction.
        (lambda text, state: heard(text, ("INFO", f"State is {state}")), [], 6),
        (lambda text, state: [("INFO", f"Received {text}, running: {state == 'running'}")], [], 6),
        (lambda text, _: heard(text, *[("INFO", "Non connu")] * (text not in ("start", "stop"))), WORDS, 3),
        # Nothing that can be seen tells the words apart: then the code is believed, unless all are warned of.
        (lambda text, _: heard(text), WORDS, 6),
        (lambda text, _: heard(text), WORDS[:2], 3),
        (lambda text, _: heard(text), [], 0),
        (lambda text, _: heard(text, ("WARN", "Non connu")), WORDS, 0),
        (lambda text, _: [("WARN", f"Pas {text}")], WORDS, 0),
    ],
)
def test_what_follows_a_word_counts_less_what_follows_an_unknown_one(
    rubric: Rubric, says: Callable[[str, str], list[tuple[str, str]]], compared: Sequence[str], points: float
) -> None:
    """No word of a log is understood, in whatever language."""
    seen = evidences.files(depended_on=list(compared))(evidences.runs(with_state(says))(right()))
    one = judged(seen, rubric, "command_subscriber.commands")
    assert one.points == points, one.reason


def arbitrary(kind: str, word: Callable[[int, str], str]) -> Run:
    """Return a run in which a line, a topic or a parameter says something else of each word."""
    run, commands = evidences.command_run(log=lambda _: []), []
    for number, one in enumerate(run.commands):
        text = word(number, one.text)
        told = evidences.heard(evidences.STRING, "/command_subscriber", [text])
        commands.append(
            {
                "log": replace(one, log=[["INFO", text]]),
                "topic": replace(one, topics={"/answer": told}),
                "velocity": replace(
                    one,
                    topics={
                        "/cmd_vel": evidences.heard(
                            evidences.TWIST, "/command_subscriber", [evidences.twist(float(ord(text[0])))] * 3
                        )
                    },
                ),
                "parameter": replace(one, parameters={"/command_subscriber:answer": text}),
            }[kind]
        )
    return replace(run, commands=commands)


@pytest.mark.parametrize("kind", ["log", "topic", "velocity", "parameter"])
@pytest.mark.parametrize(
    "word",
    [lambda _, text: chr(97 + sum(map(ord, text)) % 25), lambda number, _: chr(97 + number)],
    ids=["hash", "count"],
)
def test_what_is_another_after_whatever_comes_tells_no_words_apart(
    rubric: Rubric, kind: str, word: Callable[[int, str], str]
) -> None:
    seen = evidences.runs(arbitrary(kind, word))(right())
    seen = replace(seen, runs=[run for run in seen.runs if run.setting == "alone"])
    one = judged(seen, rubric, "command_subscriber.commands")
    assert one.points == 0, one.reason
    if kind == "log":
        one = judged(seen, rubric, "command_subscriber.log")
        assert one.points <= one.max / 2, one.reason


def test_what_is_said_all_the_time_is_no_answer_to_capitals(rubric: Rubric) -> None:
    lines = [("INFO", f"Robot {words}") for words in ("starts to move", "has come to a stop", "was reset")]
    run = replace(with_state(lambda *_: lines), log=[[*line] for line in lines * 2])
    assert judged(evidences.runs(run)(right()), rubric, "command_subscriber.commands").points == 0


@pytest.mark.parametrize(("level", "said"), [("PRINT", "A printed line"), ("INFO", "A line in the log")])
def test_what_is_printed_is_not_called_logged(rubric: Rubric, level: str, said: str) -> None:
    seen = evidences.runs(evidences.command_run(level=level))(right())
    one = judged(seen, rubric, "command_subscriber.log")
    assert (one.points, one.reason) == (one.max, f"{said} tells of each command.")


def test_words_that_are_only_spelt_otherwise_count_as_capitals_do(rubric: Rubric) -> None:
    spelt = [word.capitalize() for word in WORDS]
    run = with_state(lambda text, _: heard(text if text in spelt else "no command"))
    own = [replace(run.commands[0], text=word, log=[["INFO", f"{word}: done"]]) for word in spelt]
    seen = evidences.files(compared=spelt)(
        evidences.runs(replace(run, commands=[*run.commands, *own]))(right())
    )
    one = judged(seen, rubric, "command_subscriber.commands")
    assert one.points == one.max / 2, one.reason
    assert "the node obeys Reset, Start and Stop" in one.reason


@pytest.mark.parametrize("kind", ["topic", "velocity", "parameter", "log"])
def test_what_is_another_after_the_commands_alone_tells_them_apart(rubric: Rubric, kind: str) -> None:
    answers = {"start": "a", "stop": "b", "reset": "c"}
    seen = evidences.runs(arbitrary(kind, lambda _, text: answers.get(text, "d")))(right())
    seen = replace(seen, runs=[run for run in seen.runs if run.setting == "alone"])
    one = judged(seen, rubric, "command_subscriber.commands")
    assert one.points == one.max, one.reason


def test_a_line_may_have_a_mark_of_its_own_if_it_names_the_word(rubric: Rubric) -> None:
    marks = iter("abcdefghijklmnop")
    run = with_state(lambda text, _: [("INFO", f"request {next(marks) * 4}: {text}")])
    seen = evidences.files(depended_on=list(WORDS))(evidences.runs(run)(right()))
    for criterion in ("commands", "log"):
        one = judged(seen, rubric, f"command_subscriber.{criterion}")
        assert one.points == one.max, one.reason


@pytest.mark.parametrize("code", ["message-compared", "literal-comparison"])
def test_a_comparison_in_vain_is_not_believed(rubric: Rubric, code: str) -> None:
    seen = evidences.files(depended_on=list(WORDS))(
        evidences.runs(with_state(lambda text, _: heard(text)))(right())
    )
    vain = evidences.finding(code, "It is never equal.", "", "")(seen)
    assert judged(vain, rubric, "command_subscriber.commands").points == 0


def test_topics_are_to_be_right_in_one_way_of_starting(rubric: Rubric) -> None:
    """Here a namespace in the launch file fixes two topics, and spoils the third."""
    alone = [
        evidences.status_run(topic="/status"),
        evidences.command_run(topic="/command"),
        evidences.velocity_run(),
    ]
    launched = evidences.launched(
        [
            evidences.status_run("/robot/status_publisher"),
            evidences.command_run("/robot/command_subscriber"),
            evidences.velocity_run("/robot/velocity_publisher", topic="/robot/cmd_vel"),
        ]
    )
    given = replace(right(), runs=[*alone, launched])
    reasons = {
        one.id: (one.points, one.reason)
        for one in verdict(given, rubric).criteria
        if one.id.endswith(".topic")
    }
    assert reasons == {
        "status_publisher.topic": (5, "/robot/status_publisher publishes on /robot/status."),
        "command_subscriber.topic": (4, "/robot/command_subscriber subscribes to /robot/command."),
        "velocity_publisher.topic": (
            2.5,
            "/robot/velocity_publisher publishes on /robot/cmd_vel, not /cmd_vel.",
        ),
    }


def test_a_misspelt_module_is_the_reason_why_a_node_is_not_started(rubric: Rubric) -> None:
    cause = "The entry point x names the module robot_controller.vel, but there is no such file. Did you mean robot_controller.velocity_publisher?"
    about = ("x", "robot_controller.velocity_publisher")
    given = evidences.finding("entry-point-module", cause, "setup.py:27", "fix it", *about)(
        evidences.misplaced(evidences.VELOCITY)(right())
    )
    one = judged(given, rubric, "package.executables")
    assert one.reason == f"`ros2 run` does not start velocity_publisher: {cause}"


@pytest.mark.parametrize(
    ("is_installed", "end", "points"),
    [(False, "", 1), (False, evidences.CRASH, 1), (True, evidences.CRASH, 3)],
)
def test_a_program_that_nothing_starts_is_missed_though_it_ends_at_once(
    rubric: Rubric, is_installed: bool, end: str, points: float
) -> None:
    """That its node ends counts at the node, and does not make up for an entry point that is not there."""
    given = right() if is_installed else evidences.misplaced(evidences.VELOCITY)(right())
    given = evidences.without(evidences.VELOCITY, end)(given) if end else given
    assert judged(given, rubric, "package.executables").points == points


def test_a_module_that_cannot_be_imported_is_no_fault_of_its_entry_point(rubric: Rubric) -> None:
    given = evidences.without(evidences.VELOCITY, evidences.CRASH)(right())
    assert given.build is not None
    why = "Its module cannot be imported: ModuleNotFoundError: No module named 'rospy' (velocity_publisher.py, line 2)."
    programs = [
        replace(program, way="module", fault=why) if program.name == evidences.VELOCITY else program
        for program in given.build.executables
    ]
    given = replace(given, build=replace(given.build, executables=programs))
    criterion = judged(given, rubric, "package.executables")
    assert criterion.points == criterion.max


@pytest.mark.parametrize("count", [2, 3, 4])
def test_that_nothing_is_installed_is_not_said_where_something_is(rubric: Rubric, count: int) -> None:
    """However many entry points lead to files that lie elsewhere, the others are started."""
    given = right()
    assert given.build is not None
    names = [f"node_{number}" for number in range(count)]
    broken = [replace(evidences.executable(name), command=[], fault="It is not there.") for name in names]
    given = replace(given, build=replace(given.build, executables=[*given.build.executables, *broken]))
    causes = [
        f"The entry point {name} names the module a.{name}, whose file is a/{name}.py; there is a/b/{name}.py instead."
        for name in names
    ]
    found = [
        ["entry-point-module", cause, "setup.py:27", "fix it", name, f"a/b/{name}.py"]
        for name, cause in zip(names, causes, strict=True)
    ]
    one = judged(evidences.files(findings=found)(given), rubric, "package.executables")
    assert one.points == 0
    assert one.reason.startswith(f"`ros2 run` does not start {names[0]}")


def test_a_program_whose_file_was_run_is_no_reason_why_no_node_was_seen(rubric: Rubric) -> None:
    """Its entry point leads nowhere; what it does was seen all the same, and plays no part."""
    runs = [run for run in right().runs if run.setting == "alone" and run.programs != [evidences.COMMAND]]
    given = replace(right(), runs=runs)
    assert given.build is not None
    lost = replace(
        evidences.executable("command_user"), command=[], modules=["command_user"], fault="It is not there."
    )
    taken = WrittenEnd("/robot/command", evidences.STRING, False, [], "command_user")
    given = evidences.files(ends=[taken])(given)
    run = replace(evidences.executable("command_user.py"), target=lost.target, way="module")
    for programs, is_named in (([lost], True), ([lost, run], False)):
        executables = [*given.build.executables, *programs]
        executables = [one for one in executables if evidences.COMMAND not in one.name]
        again = replace(given, build=replace(given.build, executables=executables))
        reason = judged(again, rubric, "command_subscriber.topic").reason
        assert ("command_user cannot be started" in reason) is is_named


@pytest.mark.parametrize(("is_alive", "points"), [(True, 1), (False, 3)])
def test_an_executable_named_for_a_part_that_another_program_plays_costs_points(
    rubric: Rubric, is_alive: bool, points: float
) -> None:
    """Where it runs until Ctrl-C without a node; what ends by itself, or was not watched, tells nothing."""
    both = replace(evidences.velocity_run(), programs=[evidences.STATUS])
    stopped = {evidences.VELOCITY: {"last": {}}} if is_alive else {}
    asleep = replace(both, programs=[evidences.VELOCITY], nodes=[], publishes={}, quiet={}, stopped=stopped)
    given = right([evidences.status_run(), evidences.command_run(), both, asleep])
    one = judged(given, rubric, "package.executables")
    assert one.points == points
    assert ("No node comes up in velocity_publisher" in one.reason) == (points == 1)


@pytest.mark.parametrize("between", [0.01, 0.15, 0.4])
def test_statuses_that_double_are_told_whenever_the_second_one_came(rubric: Rubric, between: float) -> None:
    run = replace(evidences.status_run(), clock="real")
    run.quiet["/robot/status"].times[:] = [2.0, 4.0, 4.0 + between]
    given = replace(right(), runs=[run, evidences.command_run(), evidences.velocity_run()])
    place = f"{evidences.FOLDER}/robot_controller/status_publisher.py:12"
    found = evidences.finding("timer-in-callback", "One more timer begins.", place, "fix it")(given)
    assert judged(found, rubric, "status_publisher.period").reason.startswith("More and more messages")
    assert not judged(given, rubric, "status_publisher.period").reason.startswith("More")


def test_what_is_there_counts_up_to_a_quarter_though_its_node_never_comes(rubric: Rubric) -> None:
    ends = [
        WrittenEnd("/robot/status", evidences.STRING, True, [2.0]),
        WrittenEnd("/robot/command", evidences.STRING, False, []),
        WrittenEnd("/cmd_vel", evidences.STRING, True, []),
    ]
    nothing_seen = replace(right(), runs=[])
    written = evidences.files(ends=ends, depended_on=["start", "stop", "reset"])(nothing_seen)
    points = {name: part.points for name, part in verdict(written, rubric).components.items()}
    assert points["status_publisher"] == 3.75
    assert points["command_subscriber"] == 3.0
    assert points["velocity_publisher"] == 1.25  # the type is wrong, and no timer publishes it
    reasons = [one.reason for one in verdict(written, rubric).criteria if one.component == "status_publisher"]
    assert reasons[2].endswith("the code makes a timer of 2.0 s for it.")
    for far in ([], [0.5]):
        ends[0] = replace(ends[0], periods=far)
        assert judged(evidences.files(ends=ends)(nothing_seen), rubric, "status_publisher.period").points == 0
    assert {
        part.points
        for name, part in verdict(nothing_seen, rubric).components.items()
        if name in evidences.NODES
    } == {0}


@pytest.mark.parametrize(("count", "share"), [(1, 1.0), (2, 0.5)])
def test_what_there_was_no_time_to_watch_costs_nothing_in_one_node_where_it_is_plainly_written(
    count: int, share: float, rubric: Rubric
) -> None:
    """It is the submission that took the time: in several nodes half of it counts, until the instructor decides."""
    late = [
        replace(run, nodes=[], publishes={}, subscribes={}, quiet={}, commands=[]) for run in right().runs
    ]
    late = [replace(run, unfinished="others of the submission took 300 s") for run in late]
    ends = [
        WrittenEnd("/robot/status", evidences.STRING, True, [2.0]),
        WrittenEnd("/robot/command", evidences.STRING, False, []),
    ]
    found = verdict(replace(evidences.files(ends=ends[:count])(right()), runs=late), rubric)
    points = {one.id: one.points for one in found.criteria}
    assert points["status_publisher.topic"] == 5 * share
    assert points["status_publisher.period"] == 7 * share
    assert points["command_subscriber.type"] == (count - 1) * share * 2
    assert found.components["velocity_publisher"].points == 0  # nothing of it is written
    assert any("300 s" in note for note in found.notes)


@pytest.mark.parametrize(
    ("has_ended", "late", "points"),
    [(True, "", 1.25), (True, "launched", 1.25), (False, "launched", 1.25), (False, "alone launched", 5)],
)
def test_a_launch_file_without_an_end_excuses_no_program_that_was_seen_to_its_own(
    has_ended: bool, late: str, points: float, rubric: Rubric
) -> None:
    """Nor one that was watched alone, and brought no node."""
    runs = [
        replace(
            run,
            nodes=[],
            publishes={},
            subscribes={},
            quiet={},
            commands=[],
            ended=dict.fromkeys(run.programs, "code:") if has_ended and run.setting == "alone" else {},
            unfinished="it was not seen to its end within 40 s" if run.setting in late.split() else "",
        )
        for run in right().runs
    ]
    ends = [WrittenEnd("/robot/status", evidences.STRING, True, [2.0])]
    given = replace(evidences.files(ends=ends)(right()), runs=runs)
    assert judged(given, rubric, "status_publisher.topic").points == points


def test_what_was_watched_to_no_end_is_lost_only_where_more_was_seen_of_it(rubric: Rubric) -> None:
    given = right()
    mute = [replace(run, quiet={}, commands=[]) for run in given.runs if run.setting == "alone"]
    late = [
        replace(run, unfinished="it was not seen to its end within 40 s")
        for run in mute
        if "/robot/status" in run.publishes
    ]
    for runs, points in ((mute, 0), (late, 5), ([*mute, *late], 0)):
        assert judged(replace(given, runs=runs), rubric, "status_publisher.life").points == points


def test_tests_for_which_there_was_no_time_cost_nothing(rubric: Rubric) -> None:
    late = evidences.tests(is_noticed=True, is_unfinished=True)(right())
    assert judged(late, rubric, "bonus.tests").points == 2
    assert "not tried" in judged(late, rubric, "bonus.tests").reason


def test_tests_that_were_not_run_are_not_said_to_fail(rubric: Rubric) -> None:
    error = "The files cannot be copied into the sandbox: File name too long."
    found = judged(evidences.tests(passed=0, error=error, is_untried=True)(right()), rubric, "bonus.tests")
    assert found.points == 0
    assert "could not be run" in found.reason
    assert "do not pass" not in found.reason


@pytest.mark.parametrize(
    ("of_part", "besides", "points"),
    [
        ((("/cmd_vel", [1.0] * 10),), ("/turtle1/cmd_vel", [math.inf] * 10), 20),
        ((("/cmd_vel", [1.0]),), ("/turtle1/cmd_vel", [1.0] * 10), 17),
        ((("/robot1/cmd_vel", [1.0] * 10),), ("/robot2/cmd_vel", [math.inf] * 10), 17.5),
        ((("/robot2/cmd_vel", []),), ("/robot1/cmd_vel", [1.0] * 10), 17.5),
    ],
    ids=["another one is wrong", "another one is right", "no one is right", "one is silent"],
)
def test_a_node_is_judged_by_the_topic_that_is_most_likely_the_one(
    rubric: Rubric,
    of_part: Sequence[tuple[str, list[float]]],
    besides: tuple[str, list[float]],
    points: float,
) -> None:
    """It may publish the same on several, such as for a simulator; what comes on those is no fault and no deed."""
    runs = [
        evidences.velocity_run(topic=topic, values=[*map(evidences.twist, values)])
        for topic, values in (*of_part, besides)
    ]
    both = replace(
        runs[0], publishes=runs[0].publishes | runs[1].publishes, quiet=runs[0].quiet | runs[1].quiet
    )
    grade = verdict(evidences.runs(both)(right()), rubric)
    assert grade.components["velocity_publisher"].points == points
    judged_by = besides[0] if not of_part[0][1] else of_part[0][0]
    assert any(f"was judged by {judged_by}, and not by" in note for note in grade.notes)


def test_what_is_certainly_wrong_is_told_where_it_costs_nothing(rubric: Rubric) -> None:
    place = f"{evidences.FOLDER}/robot_controller/command_subscriber.py:12"
    for code, faults in (("comparison-unused", [(evidences.COMMAND, place)]), ("endless-loop", [])):
        grade = verdict(evidences.finding(code, "It is wrong.", place, "fix it")(right()), rubric)
        assert grade.total == 110
        assert [(fault.component, fault.place) for fault in grade.faults] == faults


def test_a_finding_in_the_only_program_is_told_of_the_nodes_that_it_lacks(rubric: Rubric) -> None:
    given = replace(
        right([evidences.status_run(program="main")]), runs=[evidences.status_run(program="main")]
    )
    place = f"{evidences.FOLDER}/robot_controller/main.py:17"
    grade = verdict(evidences.finding("spin-missing", "It is not reached.", place, "fix it")(given), rubric)
    assert {fault.component for fault in grade.faults if fault.code == "spin-missing"} == {evidences.COMMAND}


OF_VECTOR, OF_TWIST, OF_STRING = "geometry_msgs.msg.Vector3", "geometry_msgs.msg.Twist", "std_msgs.msg.String"
APART = {evidences.STATUS: ["status"], evidences.COMMAND: ["command"], evidences.VELOCITY: ["drive"]}
# Which modules make the nodes, which ones each program has, where a finding lies, what it is about, and whose it is.
WHOSE: dict[str, tuple[dict[str, str], dict[str, list[str]], str, str, str]] = {
    "a module for each node": (
        {"/robot/status": "status", "/robot/command": "command", "/cmd_vel": "drive"},
        APART, "drive", OF_VECTOR, evidences.VELOCITY,
    ),
    "a module for all nodes": (
        dict.fromkeys(("/robot/status", "/robot/command", "/cmd_vel"), "nodes"),
        {name: ["nodes"] for name in APART}, "nodes", OF_VECTOR, evidences.VELOCITY,
    ),
    "a module for all nodes, of a message": (
        dict.fromkeys(("/robot/status", "/robot/command", "/cmd_vel"), "nodes"),
        {name: ["nodes"] for name in APART}, "nodes", OF_TWIST, evidences.VELOCITY,
    ),
    "a module for all nodes, of a text": (
        dict.fromkeys(("/robot/status", "/robot/command", "/cmd_vel"), "nodes"),
        {name: ["nodes"] for name in APART}, "nodes", OF_STRING, evidences.STATUS,
    ),
    "programs that import all": (
        {"/robot/status": "status", "/robot/command": "command", "/cmd_vel": "drive"},
        {name: ["main", "status", "command", "drive"] for name in APART}, "drive", OF_STRING, evidences.VELOCITY,
    ),
    "a module beside the node's": (
        {"/robot/status": "status", "/robot/command": "command", "/cmd_vel": "drive"},
        APART | {evidences.VELOCITY: ["drive", "steps"]}, "steps", OF_STRING, evidences.VELOCITY,
    ),
    "a module of two programs": (
        {"/robot/status": "status", "/robot/command": "command", "/cmd_vel": "drive"},
        APART | {evidences.VELOCITY: ["drive", "made"], evidences.STATUS: ["status", "made"]},
        "made", OF_VECTOR, evidences.VELOCITY,
    ),
    "a class below the module of another": (
        {"/robot/status": "status", "/robot/command": "command", "/cmd_vel": "status"},
        APART | {evidences.VELOCITY: ["velocity_publisher", "status"]}, "status", OF_VECTOR, evidences.VELOCITY,
    ),
    "a module that nobody knows": ({}, {}, "made", OF_VECTOR, evidences.VELOCITY),
}  # fmt: skip


@pytest.mark.parametrize("name", WHOSE)
def test_a_finding_is_the_nodes_that_its_module_makes(rubric: Rubric, name: str) -> None:
    """However much more another node lost."""
    makers, modules, module, about, owner = WHOSE[name]
    lost = evidences.runs(evidences.status_run(values=0))(right())
    lost = evidences.runs(evidences.velocity_run(values=[evidences.twist(0.5)]))(lost)
    types = dict.fromkeys(("/robot/status", "/robot/command"), evidences.STRING) | {
        "/cmd_vel": evidences.TWIST
    }
    ends = [
        WrittenEnd(topic, types[topic], topic != "/robot/command", [], where)
        for topic, where in makers.items()
    ]
    assert lost.build
    programs = [replace(one, modules=modules.get(one.name, [])) for one in lost.build.executables]
    given = replace(evidences.files(ends=ends)(lost), build=replace(lost.build, executables=programs))
    grade = verdict(given, rubric)
    points = {part: grade.components[part].points for part in evidences.NODES}
    assert points[evidences.STATUS] < points[evidences.VELOCITY] < 20
    place = f"{evidences.FOLDER}/robot_controller/{module}.py:12"
    faults = verdict(
        evidences.finding("field-type", "It is wrong.", place, "fix it", about)(given), rubric
    ).faults
    assert [fault.component for fault in faults if fault.place == place] == [owner]


def test_a_module_of_several_programs_is_no_name_of_a_node(rubric: Rubric) -> None:
    given = right()
    assert given.build
    programs = [replace(one, target=f"robot_controller.nodes:{one.name}") for one in given.build.executables]
    readme = (
        "The nodes publish on /robot/status and /cmd_vel, and hear /robot/command. Run each of the nodes."
    )
    shared = replace(given, build=replace(given.build, executables=programs))
    one = judged(evidences.files(readme=readme)(shared), rubric, "documentation.interface")
    assert (one.points, "node /status_publisher" in one.reason) == (1, True)


def test_tests_that_cannot_be_run_are_not_said_to_be_missing(rubric: Rubric) -> None:
    given = evidences.files(tests={}, tests_left_out=["test/test_launch.py"])(replace(right(), tests={}))
    one = judged(given, rubric, "bonus.tests")
    assert (one.points, one.reason) == (
        1,
        "Its tests need what is not installed here and were not run, so what they find is not known: test/test_launch.py.",
    )


NAMES = (evidences.STATUS, evidences.COMMAND, evidences.VELOCITY)


def launching(given: Evidence, **changes: object) -> Evidence:
    """Return evidence with one launched run: that of the right nodes, changed."""
    run = next(run for run in right().runs if run.setting == "launched")
    others = [run for run in given.runs if run.setting != "launched"]
    return replace(given, runs=[*others, replace(run, **changes)])


def test_another_program_that_a_launch_file_starts_plays_for_no_executable(rubric: Rubric) -> None:
    """The executables end without a word, or are nodes that do nothing."""
    for quiet in (evidences.without, lambda name: evidences.ended(name, "")):
        empty = right()
        for name in NAMES:
            empty = quiet(name)(empty)
        empty = replace(
            empty,
            runs=[
                replace(run, quiet={}, commands=[], publishes={}, subscribes={})
                for run in empty.runs
                if run.setting == "alone"
            ],
        )
        played, left = (
            {one.id: one.points for one in verdict(given, rubric).criteria}
            for given in (launching(empty), empty)
        )
        # Of a parameter file it is only said that it could not be tried.
        assert played == left | {"bonus.parameter_file": played["bonus.parameter_file"]}


@pytest.mark.parametrize("how", ["finished cleanly", "died"])
def test_a_launch_file_whose_programs_end_at_once_starts_nothing(rubric: Rubric, how: str) -> None:
    given = right()
    for name in NAMES:
        given = evidences.ended(name, "")(given)
    said = "\n".join(f"[INFO] [{name}-1]: process has {how} [pid 3]" for name in NAMES)
    given = launching(given, ended={"robot.launch.py": said}, commands=[])
    assert judged(given, rubric, "bonus.launch").points == 0


def test_a_launch_file_of_programs_that_finish_is_not_one_of_programs_that_crash(rubric: Rubric) -> None:
    given = right()
    for name in NAMES:
        given = evidences.without(name)(given)
    said = "\n".join(f"[INFO] [{name}-1]: process has finished cleanly [pid 3]" for name in NAMES)
    given = launching(
        given, ended={"robot.launch.py": said}, nodes=[], publishes={}, subscribes={}, commands=[], quiet={}
    )
    assert judged(given, rubric, "bonus.launch").points == 0


def test_a_launch_file_that_gives_a_topic_another_name_is_told_so(rubric: Rubric) -> None:
    """The node is there: to add it once more would help nobody."""
    alone = [evidences.status_run(), evidences.command_run(), evidences.velocity_run()]
    for node in ("/status_publisher", "/shop/status_publisher"):
        renamed = replace(evidences.status_run(node, topic="/report"), quiet={})
        moved = evidences.launched([renamed, *alone[1:]])
        one = judged(replace(right(), runs=[*alone, moved]), rubric, "bonus.launch")
        assert one.points == 1
        assert one.reason == "robot.launch.py starts all nodes, but nothing is on /robot/status then."
        assert "remapping" in one.hint


def test_a_program_under_anothers_name_is_not_that_one(rubric: Rubric) -> None:
    alone = [evidences.status_run(), evidences.command_run(), evidences.velocity_run()]
    again = [evidences.status_run(node) for node in ("/command_subscriber", "/velocity_publisher")]
    thrice = evidences.launched([alone[0], *again])
    one = judged(replace(right(), runs=[*alone, thrice]), rubric, "bonus.launch")
    assert one.points == 1
    assert one.reason == "robot.launch.py does not start all nodes; not seen: /robot/command and /cmd_vel."


def test_a_launch_file_is_judged_by_the_nodes_that_there_are(rubric: Rubric) -> None:
    """Where no node plays a part, it is to start each; where some do, those that do not are told by their names."""
    other = {"topic": "/scan_rate", "kind": "std_msgs/msg/Float32"}
    alone = [
        evidences.status_run(f"/{name}", name, **(other | {"topic": f"/{name}/x"})) for name in NAMES[:2]
    ]
    given = replace(right(), runs=alone)
    both = evidences.launched(alone)
    all_started = judged(replace(given, runs=[*alone, both]), rubric, "bonus.launch")
    assert all_started.points == 2
    one = judged(replace(given, runs=[*alone, evidences.launched(alone[:1])]), rubric, "bonus.launch")
    assert (one.points, "starts /status_publisher, of which none plays a part" in one.reason) == (0, True)


def test_a_node_with_words_of_its_own_has_a_quarter(rubric: Rubric) -> None:
    """They were sent, too, for its code compares with them; nothing follows those that were asked for."""
    texts = (*evidences.SCRIPT.all[:7], "go", "halt", *evidences.SCRIPT.all[7:])

    def log(text: str) -> list[str]:
        return [f"Now I {text}"] if text in ("go", "halt") else [f"Unknown command: {text}"]

    given = evidences.runs(evidences.command_run(log=log, texts=texts))(right())
    one = judged(given, rubric, "command_subscriber.commands")
    assert (one.points, "follows go and halt" in one.reason) == (1.5, True)


@pytest.mark.parametrize("words", [("start", "stop", "go"), ("start", "go", "halt")])
def test_two_words_of_a_nodes_own_count_as_one_that_was_asked_for(
    rubric: Rubric, words: Sequence[str]
) -> None:
    """One beside two of the three adds nothing, two beside one do; that the log tells of each is right for either kind."""
    texts = (*evidences.SCRIPT.all[:7], "go", "halt", *evidences.SCRIPT.all[7:])

    def log(text: str) -> list[str]:
        return [f"Now I {text}"] if text in words else ["What?"]

    given = evidences.runs(evidences.command_run(log=log, texts=texts))(right())
    criterion = judged(given, rubric, "command_subscriber.commands")
    assert (criterion.points, "reset, but something does follow go" in criterion.reason) == (3, True)
    criterion = judged(given, rubric, "command_subscriber.log")
    assert criterion.points == 4
    assert f"each word that the node knows: {words[0]}, {words[1]} and {words[2]}." in criterion.reason


@pytest.mark.parametrize(("log", "points"), [(evidences.echo, 3.5), (evidences.log_by_word, 17), (None, 0)])
def test_a_subscriber_on_another_topic_has_what_it_does(
    rubric: Rubric, log: Callable[[str], list[str]] | None, points: float
) -> None:
    """Nothing in a name tells of commands; that something follows them does, and a node that does nothing has no part."""
    run = evidences.command_run("/listener", "listener", topic="/chatter", log=log or (lambda _text: []))
    others = [run for run in right().runs if run.setting == "alone" and run.programs != [evidences.COMMAND]]
    given = evidences.files(compared=[])(replace(right(), runs=[*others, run]))
    assert given.build is not None
    programs = [evidences.executable(name) for name in (evidences.STATUS, "listener", evidences.VELOCITY)]
    given = replace(given, build=replace(given.build, executables=programs))
    grade = verdict(given, rubric)
    assert grade.components["command_subscriber"].points == points
    assert any("commands were published on /chatter" in note for note in grade.notes)


@pytest.mark.parametrize(
    ("topic", "kind", "period", "points"),
    [
        ("/topic", evidences.STRING, 2.0, 16.25),  # its period tells that it is meant
        ("/topic", evidences.STRING, 0.5, 4.25),  # neither does a word of its topic
        ("/plan", evidences.STRING, 0.1, 4.25),
        ("/robot_news", evidences.STRING, 0.5, 4.25),  # as little as a word that is about every part
        ("/robot/estado", evidences.STRING, 0.5, 8.5),
        ("/stats", evidences.STRING, 0.5, 8.5),
        ("/robot/status", "std_msgs/msg/Int32", 2.0, 14.5),  # what nobody can take counts half
        ("/robot/status", evidences.STRING, 0.5, 14.75),
        ("/robot_status", evidences.STRING, 0.5, 9.75),  # half of a topic is no more than a word
        ("/status", evidences.STRING, 2.5, 16.5 - 2.5),  # a period that is close tells of it
    ],
)
def test_what_any_node_does_counts_half_where_little_tells_that_it_is_meant(
    rubric: Rubric, topic: str, kind: str, period: float, points: float
) -> None:
    """So a tutorial's node that was handed in as it is has less than half of a part, or less than a quarter."""
    run = evidences.status_run(topic=topic, kind=kind, period=period)
    others = [run for run in right().runs if run.setting == "alone" and run.programs != [evidences.STATUS]]
    given = replace(right(), runs=[*others, run])
    grade = verdict(given, rubric)
    life = next(one for one in grade.criteria if one.id == "status_publisher.life")
    assert grade.components["status_publisher"].points == points
    is_doubted = points in (4.25, 8.5, 14.5, 9.75)
    why = "its topic is not" if kind == evidences.STRING else "has another type than std_msgs/msg/String"
    assert (
        f"because {why}" in life.reason.replace("the node that is meant for /robot/status ", "")
    ) == is_doubted
    assert bool(life.hint) == is_doubted
    assert verdict(given, replace(rubric, doubted=1)).components["status_publisher"].points >= points


@pytest.mark.parametrize(
    ("topic", "log", "points"),
    [
        ("/command", evidences.echo, 8),  # the words of a tutorial's listener, under half of a name
        ("/command", evidences.log_by_word, 18),
        # What has the line of unknown words is not told apart, which is charged once.
        ("/command", lambda text: [f"I go: {text}" if text == "start" else "What?"], 13.5),
        ("/robot/command", evidences.echo, 14),
    ],
)
def test_an_echo_on_half_of_a_topic_counts_half(
    rubric: Rubric, topic: str, log: Callable[[str], list[str]], points: float
) -> None:
    run = evidences.command_run(topic=topic, log=log)
    others = [run for run in right().runs if run.setting == "alone" and run.programs != [evidences.COMMAND]]
    given = evidences.files(compared=[], depended_on=[])(replace(right(), runs=[*others, run]))
    assert verdict(given, rubric).components["command_subscriber"].points == points


def test_who_only_drives_after_a_command_on_another_topic_obeys_it(rubric: Rubric) -> None:
    """A velocity that comes all the time, and is another one after a command, tells of it without a line in the log."""
    run = evidences.command_run("/robot", evidences.VELOCITY, topic="/orders", log=lambda _text: [])
    run = evidences.moving(run, {"start": 0.5, "stop": 0.0, "reset": 0.0}, node="/robot")
    still = evidences.heard(evidences.TWIST, "/robot", [evidences.twist(0.0)] * 10, 0.1)
    run = replace(run, quiet={"/cmd_vel": still})
    given = evidences.files(compared=["start"])(replace(right(), runs=[evidences.status_run(), run]))
    assert judged(given, rubric, "command_subscriber.commands").points >= 1.5


def test_who_ends_at_a_text_on_a_topic_of_its_own_is_not_charged(rubric: Rubric) -> None:
    """Where a program subscribes to no commands, they are tried on another topic; what was to come there is not known."""
    text = CommandSeen("start", [], {}, {}, is_alive=False)
    run = replace(
        evidences.status_run(),
        subscribes={"/settings": {"/status_publisher": [evidences.STRING]}},
        commands=[text],
        commanded="/settings",
        ended={evidences.STATUS: evidences.DIES},
    )
    given = evidences.runs(run)(right())
    assert judged(given, rubric, "status_publisher.life").points == 5
    assert any(
        "ended with “RuntimeError: gone” after 'start' was" in note for note in verdict(given, rubric).notes
    )
    given = evidences.runs(replace(run, commands=[]))(right())
    assert judged(given, rubric, "status_publisher.life").points < 5


@pytest.mark.parametrize(("alone", "how"), [([], "by itself"), (["start"], "after 'start' was")])
def test_what_ends_by_itself_is_not_said_to_end_of_a_command_for_others(
    rubric: Rubric, alone: list[str], how: str
) -> None:
    """All programs get the commands together; one that has none when it is alone may have ended by then."""
    dead = [CommandSeen("start", [], {}, {}, is_alive=False)]
    ended = {evidences.STATUS: evidences.DIES}
    first = replace(evidences.status_run(), ended=ended, commands=dead if alone else [])
    both = evidences.merged([evidences.status_run(), evidences.command_run()], evidences.STATUS, "together")
    both = replace(both, programs=[evidences.STATUS, evidences.COMMAND], ended=ended, commands=dead)
    notes = verdict(replace(right(), runs=[first, evidences.command_run(), both]), rubric).notes
    assert [note for note in notes if f"{evidences.STATUS}, together: it ended" in note and how in note]


@pytest.mark.parametrize(
    ("packages", "points", "says"),
    [
        (["turtlesim"], 0, "no node at all was seen"),
        (["robot_controller", "turtlesim"], 2, "robot.launch.py needs turtlesim, not installed here"),
        (["robot_controller"], 0, "no node at all was seen"),
    ],
)
def test_a_launch_file_is_excused_for_what_it_needs_itself(
    rubric: Rubric, packages: list[str], points: float, says: str
) -> None:
    """Another one may need what is not here; and one that starts nothing of the work is none for it."""
    given = launching(
        right(), ended={"robot.launch.py": ""}, nodes=[], publishes={}, subscribes={}, commands=[], quiet={}
    )
    assert given.build is not None
    given = replace(given, build=replace(given.build, absent=["turtlesim"]))
    path = f"{'very_' * 20}long/robot.launch.py"
    named = evidences.files(launch_files=[path], launched_packages={path: packages})
    criterion = judged(named(given), rubric, "bonus.launch")
    assert (criterion.points, says in criterion.reason) == (points, True), criterion.reason


@pytest.mark.parametrize(
    ("module", "packages", "points"),
    [
        ("xacro", ["robot_controller"], 2),
        ("xacro", ["turtlesim"], 0),  # it starts nothing of the work
        ("launch_rso", ["robot_controller"], 0),
        ("robot_controler", ["robot_controller"], 0),
        ("robot_controller", ["robot_controller"], 0),
    ],
)
def test_a_launch_file_is_excused_for_a_module_that_is_not_installed_here(
    rubric: Rubric, module: str, packages: list[str], points: float
) -> None:
    said = f"Caught multiple exceptions when trying to load file:\n - ModuleNotFoundError: No module named '{module}'"
    given = launching(
        right(), ended={"robot.launch.py": said}, nodes=[], publishes={}, subscribes={}, commands=[], quiet={}
    )
    named = evidences.files(
        launch_files=["launch/robot.launch.py"], launched_packages={"launch/robot.launch.py": packages}
    )
    criterion = judged(named(given), rubric, "bonus.launch")
    assert criterion.points == points, criterion.reason


@pytest.mark.parametrize(
    ("missing", "points"),
    [
        ("robot_description", 2),  # handed in, and not built here
        ("robot_controller", 0),  # its own
        ("robot_nowhere", 0),
    ],
)
def test_a_launch_file_is_excused_for_a_package_of_the_hand_in_that_is_not_built_here(
    rubric: Rubric, missing: str, points: float
) -> None:
    said = (
        "[ERROR] [launch]: Caught exception in launch (see debug for traceback): Caught multiple exceptions when trying to load file of format [py]:\n"
        f" - PackageNotFoundError: \"package '{missing}' not found, searching: ['/opt/ros']\""
    )
    given = launching(
        right(), ended={"robot.launch.py": said}, nodes=[], publishes={}, subscribes={}, commands=[], quiet={}
    )
    beside = replace(evidences.PACKAGE, name="robot_description", build_type="ament_cmake")
    path = "launch/robot.launch.py"
    change = evidences.both(
        evidences.submission(packages=[evidences.PACKAGE, beside]),
        evidences.files(launch_files=[path], launched_packages={path: ["robot_controller", missing]}),
    )
    criterion = judged(change(given), rubric, "bonus.launch")
    assert (criterion.points, f"package '{missing}' not found" in criterion.reason) == (points, not points)


def test_what_follows_a_word_on_another_topic_is_no_answer_to_a_command(rubric: Rubric) -> None:
    """Where the command topic takes another type, words were said where another node takes the status."""
    deaf = evidences.command_run(kind=evidences.TWIST)
    run = replace(
        deaf,
        subscribes=deaf.subscribes | {"/robot/status": {"/panel": [evidences.STRING]}},
        commanded="/robot/status",
    )
    given = evidences.runs(run)(right())
    got = {
        name: judged(given, rubric, f"command_subscriber.{name}")
        for name in ("commands", "log", "robustness")
    }
    assert {name: one.points for name, one in got.items()} == {"commands": 0, "log": 0, "robustness": 1}
    assert all("takes geometry_msgs/msg/Twist" in got[name].reason for name in ("commands", "log"))


@pytest.mark.parametrize(
    ("said", "findings", "points"),
    [
        ("PackageNotFoundError: \"package 'turtlesim' not found\"", [], 2),
        (
            "FileNotFoundError: [Errno 2] No such file or directory: 'share/robot_controller/urdf/robot.urdf'",
            [],
            0,
        ),
        ("", [["launch-executable", "It starts x.py.", "launch/robot.launch.py:24", "write x"]], 0),
        ("", [["launch-executable", "It starts x.py.", "launch/other.launch.py:24", "write x"]], 2),
    ],
)
def test_a_launch_file_is_not_excused_for_its_own_fault(
    rubric: Rubric, said: str, findings: list[list[str]], points: float
) -> None:
    given = launching(
        right(), ended={"robot.launch.py": said}, nodes=[], publishes={}, subscribes={}, commands=[], quiet={}
    )
    assert given.build is not None
    given = replace(given, build=replace(given.build, absent=["turtlesim"]))
    path = "launch/robot.launch.py"
    packages = {path: ["robot_controller", "turtlesim"]}
    named = evidences.files(launch_files=[path], launched_packages=packages, findings=findings)
    assert judged(named(given), rubric, "bonus.launch").points == points


def test_a_launch_file_that_starts_all_there_is_is_not_told_to_start_more(rubric: Rubric) -> None:
    run = evidences.status_run()
    given = replace(right(), runs=[run, evidences.launched([run])])
    criterion = judged(given, rubric, "bonus.launch")
    assert (criterion.points, "starts all that there is" in criterion.reason) == (1, True), criterion.reason


def test_what_is_not_known_of_a_package_is_not_said(rubric: Rubric) -> None:
    """Of a package.xml that cannot be read there is no name, and no tool knows what it declares."""
    broken = replace(evidences.PACKAGE, name=None, error="package.xml is not valid: no element found.")
    given = evidences.both(
        evidences.submission(packages=[broken], package=broken), evidences.facts("manifest", "is_valid")
    )(right())
    grade = verdict(given, rubric)
    assert judged(given, rubric, "package.dependencies").points == 2
    assert "cannot be read" in judged(given, rubric, "workspace.name").reason
    assert not any(re.search(r"  |called ,|see ,| :", each.reason) for each in grade.criteria)


@pytest.mark.parametrize(
    ("kind", "why"),
    [("ignored by colcon", "an AMENT_IGNORE lies in"), ("in another package", "lies in another package")],
)
def test_why_colcon_does_not_see_a_package_is_said(rubric: Rubric, kind: Kind, why: str) -> None:
    given = evidences.submission(notes=[Note(kind, [evidences.FOLDER])])(right())
    assert why in judged(given, rubric, "workspace.build").reason


def test_what_a_build_leaves_at_work_is_not_handed_in() -> None:
    """It is noted of a hand-in; one's own workspace has it beside src, and none among the sources."""
    notes = [
        Note("by a build", ["ws/build"]),
        Note("by a build", ["ws/src/p/build"]),
        Note("by a tool", ["x"]),
    ]
    given = replace(right().submission, workspace="ws", notes=notes)
    assert given.worked_in().notes == notes[1:2]


def test_a_launch_file_of_another_package_is_named(rubric: Rubric) -> None:
    """That there is none would be untrue."""
    given = evidences.files(
        launch_files=[], launch_files_elsewhere=["src/robot_description/launch/show.launch.py"]
    )
    assert (
        "show.launch.py of another package starts no node of this one"
        in judged(given(right()), rubric, "bonus.launch").reason
    )


def test_a_readme_that_misspells_the_package_is_about_this_one(rubric: Rubric) -> None:
    names = (evidences.STATUS, f"{evidences.COMMAND}.py", evidences.VELOCITY)
    wrong = {f"ros2 run robot_control {name}": False for name in names}
    readme = evidences.README.replace("robot_controller", "robot_control")
    given = evidences.files(readme=readme, readme_commands={**wrong, "colcon build": True})(right())
    points = [
        judged(given, rubric, f"documentation.{id_}").points for id_ in ("readme", "commands", "interface")
    ]
    assert points == [2, 0, 2]


@pytest.mark.parametrize(
    ("command", "points"),
    [
        ("turtlesim turtlesim_node", 1.5),
        ("PACKAGE NODE", 1.5),
        ("<package>", 1.5),
        ("my_robot status_publisher", 3),
    ],
)
def test_a_readme_that_starts_only_what_is_not_handed_in_does_not_say_how_to_run(
    rubric: Rubric, command: str, points: float
) -> None:
    """Nobody knows whether its commands are true; those with a node of the package may be, and not one that nobody can type."""
    readme = f"{evidences.README.partition('`ros2')[0]}`ros2 run {command}`."
    commands = {"colcon build": True, f"ros2 run {command}": None}
    given = evidences.files(readme=readme, readme_commands=commands)(right())
    assert judged(given, rubric, "documentation.commands").points == points


@pytest.mark.parametrize(
    ("more", "command", "points"),
    [
        ("", "ros2 run robot_controller <node>", 0),
        ("", "ros2 launch robot_controller <launch file>", 0),
        ("", "ros2 run robot_controller status_publisher", 2),
        ("", "ros2 topic pub --once /robot/command std_msgs/msg/String '{data: start}'", 2),
        ("It publishes on /robot/status.", "ros2 run robot_controller <node>", 2),
        ("The robot controller has three nodes.", "ros2 run robot_controller [node]", 2),
    ],
)
def test_a_command_that_its_reader_must_complete_shows_not_what_a_readme_is_about(
    rubric: Rubric, more: str, command: str, points: float
) -> None:
    """As in a template: one paragraph of the description goes here."""
    text = f"# Project Title\n\nOne paragraph of the description goes here, with all that there is to say. {'It tells what it is for. ' * 4}{more}\n\n```\n{command}\n```\n"
    given = evidences.files(readme=text, readme_commands={command: None}, readme_names=[])(right())
    assert judged(given, rubric, "documentation.readme").points == points


def test_what_was_written_is_not_denied_where_nothing_runs(rubric: Rubric) -> None:
    """It earns nothing, for what it describes is not there."""
    sources = {"modules": [3, 3], "classes": [3, 3], "functions": [6, 6]}
    written = evidences.files(readme=evidences.README, sources=sources)(evidences.untouched())
    empty = evidences.files(readme="", sources={"functions": [0, 6]})(written)
    for criterion in ("readme", "commands", "code"):
        said = [judged(given, rubric, f"documentation.{criterion}") for given in (written, empty)]
        assert [one.points for one in said] == [0, 0]
        assert said[0].reason.startswith("Nothing that runs in ROS 2 was handed in")
        assert said[1].reason.startswith(("There is no README", "No module, class or function"))


def test_commands_for_what_was_not_handed_in_are_named(rubric: Rubric) -> None:
    """A README of loose files may say at length how to run a package that is not there."""
    command = "ros2 run robot status"
    given = evidences.submission(form="files", workspace=None, package=None, packages=[])(right())
    given = evidences.files(readme=f"Type `{command}`.", readme_commands={command: None})(given)
    one = judged(given, rubric, "documentation.commands")
    assert (one.points, one.reason) == (
        0,
        f"These commands of the README are not true of what was handed in: {command}.",
    )


def test_a_command_that_needs_what_is_not_installed_here_was_not_tried(rubric: Rubric) -> None:
    command = "ros2 launch robot_controller robot.launch.py"
    path = right().files.launch_files[0]
    for absent, told in (
        (["ros_gz_sim"], "not tried, for robot.launch.py needs ros_gz_sim"),
        ([], "counts elsewhere"),
    ):
        given = evidences.files(
            readme_commands={command: False, "colcon build": True},
            launched_packages={path: ["robot_controller", "ros_gz_sim"]},
        )(right())
        assert given.build
        given = replace(given, build=replace(given.build, absent=absent))
        one = judged(given, rubric, "documentation.commands")
        assert one.points == 3
        assert told in one.reason


def test_a_readme_tells_of_what_there_is(rubric: Rubric) -> None:
    """A part of which nothing was written is charged once; one whose node was not seen is to be described."""
    readme = evidences.README.replace("/cmd_vel", "its motors").replace(evidences.VELOCITY, "one more")
    lost = evidences.files(readme=readme)(evidences.without(evidences.VELOCITY)(right()))
    ends = [WrittenEnd("/robot/status", evidences.STRING, True, [2.0])]
    twist = WrittenEnd("/cmd_vel", "geometry_msgs/msg/Twist", True, [0.1])
    for written, points in ((ends, 2), ([*ends, twist], 1)):
        given = evidences.files(ends=written)(lost)
        assert judged(given, rubric, "documentation.interface").points == points


SOMEWHERE = [WrittenEnd("", "", is_publisher=False, periods=[])]
BROKEN = [["node-syntax", "It is no Python.", "robot_controller/talks.py:3", "close it"]]


@pytest.mark.parametrize(
    ("elsewhere", "findings", "unread", "points"),
    [
        ([], [], {}, 1),
        ([], BROKEN, {}, 2),
        ([], [], {"ends": "It is nested too deeply."}, 2),
        (SOMEWHERE, [], {}, 2),
        (None, [], {}, 2),
    ],
    ids=["no code makes any", "no Python", "not read", "not followed", "not asked"],
)
def test_a_readme_names_no_topic_that_no_code_makes(
    rubric: Rubric,
    elsewhere: list[WrittenEnd] | None,
    findings: list[list[str]],
    unread: dict[str, str],
    points: float,
) -> None:
    """A program that only prints its topic's name has none; one whose code could not be read may have."""
    names = (evidences.STATUS, evidences.COMMAND, evidences.VELOCITY)
    ended = evidences.both(*(evidences.without(name) for name in names))(right())
    ended = replace(ended, runs=[run for run in ended.runs if run.setting == "alone"])
    given = evidences.files(ends=[], ends_elsewhere=elsewhere, findings=findings, unread=unread)(ended)
    one = judged(given, rubric, "documentation.interface")
    assert (one.points, "that was seen" in one.reason) == (points, points == 1), one.reason


def test_a_command_of_a_package_that_is_not_graded_is_named_as_untried(rubric: Rubric) -> None:
    given = right()
    other = replace(given.submission.packages[0], folder="src/other", name="other")
    given = replace(given, submission=replace(given.submission, packages=[*given.submission.packages, other]))
    commands = given.files.readme_commands | {"ros2 run other demo": None}
    one = judged(evidences.files(readme_commands=commands)(given), rubric, "documentation.commands")
    assert one.points == 3
    assert one.reason.endswith("; not tried, for what they start is not graded: ros2 run other demo.")


@pytest.mark.parametrize(("died", "points"), [((evidences.STATUS, evidences.COMMAND), 2), ((), 0)])
def test_a_launch_file_of_nodes_that_all_end_is_not_charged(
    rubric: Rubric, died: tuple[str, ...], points: float
) -> None:
    given = right()
    for name in (evidences.STATUS, evidences.COMMAND, evidences.VELOCITY):
        given = evidences.without(name, evidences.CRASH)(given)
    said = "\n".join(f"[ERROR] [{name}-1]: process has died [pid 3, exit code 1]." for name in died)
    launched = evidences.launched([run for run in given.runs if run.setting == "alone"])
    launched = replace(launched, ended={"robot.launch.py": said}, nodes=[])
    given = replace(given, runs=[*(run for run in given.runs if run.setting != "launched"), launched])
    assert judged(given, rubric, "bonus.launch").points == points
    hints = {one.hint for one in verdict(given, rubric).criteria if one.component == evidences.STATUS}
    assert hints == {"Fix first why the node was not seen."}


@pytest.mark.parametrize(("effect", "points"), [(2.0, 2), (1.0, 0)])
def test_a_parameter_of_a_node_that_does_not_spin_is_seen_by_its_effect(
    rubric: Rubric, effect: float, points: float
) -> None:
    mute = [replace(run, parameters={}) for run in (evidences.status_run(), evidences.velocity_run())]
    given = right([*mute, evidences.command_run()])
    changed = [
        replace(
            run,
            setting="period:=0.7",
            quiet={
                topic: replace(
                    heard, times=[time / (effect if run is mute[0] else 1) for time in heard.times]
                )
                for topic, heard in run.quiet.items()
            },
        )
        for run in mute
    ]
    assert judged(replace(given, runs=[*given.runs, *changed]), rubric, "bonus.parameters").points == points


@pytest.mark.parametrize(("name", "points"), [("period", 2), ("perod", 0)])
def test_a_parameter_file_for_nodes_that_do_not_spin_is_held_against_the_code(
    rubric: Rubric, name: str, points: float
) -> None:
    mute = [replace(run, parameters={}) for run in (evidences.status_run(), evidences.velocity_run())]
    path = f"{evidences.FOLDER}/config/robot.yaml"
    given = evidences.files(
        parameter_files={path: {"/status_publisher": {name: 2.0}}}, declared={"period": None}
    )(right([*mute, evidences.command_run()]))
    assert judged(given, rubric, "bonus.parameter_file").points == points


def test_what_fails_in_a_readme_for_another_fault_is_not_said_to_be_true(rubric: Rubric) -> None:
    command = "ros2 run robot_controller velocity_publisher"
    given = evidences.files(readme_commands={command: False, "colcon build": True})(right())
    one = judged(given, rubric, "documentation.commands")
    assert one.points == one.max
    assert one.reason.endswith(f"fails for a fault that counts elsewhere: {command}.")


@pytest.mark.parametrize(("is_installed", "points"), [(False, 3), (True, 0)])
def test_a_script_has_its_ending_where_nothing_installs_it_under_another_name(
    rubric: Rubric, is_installed: bool, points: float
) -> None:
    given = right() if is_installed else evidences.misplaced(evidences.VELOCITY)(right())
    commands = {"ros2 run robot_controller velocity_publisher.py": False, "colcon build": True}
    given = evidences.files(readme_commands=commands)(given)
    assert judged(given, rubric, "documentation.commands").points == points


@pytest.mark.parametrize(("folder", "points"), [("src/robot_controller", 1), ("src/robot", 0)])
def test_a_name_in_which_two_files_differ_is_charged_once(rubric: Rubric, folder: str, points: float) -> None:
    package = replace(evidences.PACKAGE, folder=folder, name="robot_control")
    given = evidences.facts("setup", "name_agrees")(evidences.submission(package=package)(right()))
    assert judged(given, rubric, "workspace.name").points == points
    assert judged(evidences.submission(package=package)(right()), rubric, "workspace.name").points == 0


@pytest.mark.parametrize(
    ("program", "topic", "ends", "note"),
    [
        (
            evidences.COMMAND,
            "/robot/command",
            ["subscriber reliable transient_local"],
            "/command_subscriber hears only publishers that are transient local, too, on /robot/command.",
        ),
        (
            evidences.STATUS,
            "/robot/status",
            ["publisher best_effort volatile", "subscriber reliable volatile"],
            "/status_publisher is not heard by subscriptions that are reliable, on /robot/status.",
        ),
        (
            evidences.VELOCITY,
            "/cmd_vel",
            ["publisher best_effort volatile", "publisher reliable volatile"],
            "",
        ),
        (evidences.COMMAND, "/robot/command", ["subscriber best_effort volatile"], ""),
    ],
)
def test_a_note_tells_of_an_unusual_qos(
    rubric: Rubric, program: str, topic: str, ends: list[str], note: str
) -> None:
    given = right()
    run = next(run for run in given.runs if run.programs == [program] and run.setting == "alone")
    run.qos[topic] = ends
    told = [one for one in verdict(given, rubric).notes if one.endswith(f"on {topic}.")]
    assert told == ([note] if note else [])


def test_a_note_names_what_no_code_of_the_hand_in_makes(rubric: Rubric) -> None:
    """The program of its node may be nothing but a command or a demo node of the system."""
    ends = [
        WrittenEnd("/robot/status", evidences.STRING, True, []),
        WrittenEnd("/robot/command", evidences.STRING, False, []),
    ]
    notes = verdict(evidences.files(ends=ends)(right()), rubric).notes
    assert [note for note in notes if "the code" in note] == [
        "Reading did not find the code that makes what /velocity_publisher has on /cmd_vel: look at its program, and "
        "at what that starts."
    ]


@pytest.mark.parametrize(
    ("elsewhere", "points"),
    [
        ([], 0),
        ([WrittenEnd("", "", False, [])], 0),  # which makes subscriptions
        ([WrittenEnd("", "", True, [])], 20),
        ([WrittenEnd("/speed", "geometry_msgs/msg/TwistStamped", True, [])], 20),
        (None, 20),  # of which nothing is known
    ],
)
def test_a_node_that_nothing_in_the_hand_in_makes_is_not_its_own(
    rubric: Rubric, elsewhere: list[WrittenEnd] | None, points: float
) -> None:
    """It costs its part, and no other; code that is not followed may make it."""
    ends = [
        WrittenEnd("/robot/status", evidences.STRING, True, []),
        WrittenEnd("/robot/command", evidences.STRING, False, []),
    ]
    grade = verdict(evidences.files(ends=ends, ends_elsewhere=elsewhere)(right()), rubric)
    assert grade.components["velocity_publisher"].points == points
    assert grade.components["status_publisher"].points == 20
    assert grade.components["command_subscriber"].points == 20
    if not points:
        said = next(one for one in grade.criteria if one.id == "velocity_publisher.topic")
        assert "except /velocity_publisher, which no code that was handed in makes" in said.reason
        assert "/cmd_vel" in said.hint


def test_a_note_names_what_may_be_evidence_of_running(rubric: Rubric) -> None:
    notes = verdict(evidences.files(recordings=["docs/run.png"])(right()), rubric).notes
    assert "Evidence of running is left to the instructor: docs/run.png." in notes
    assert any(
        "no picture, film or log was handed in, and no link" in note
        for note in verdict(right(), rubric).notes
    )
    printed = evidences.files(readme="```\n[INFO] [1.2] [status_publisher]: on\n```")(right())
    assert any("the README shows" in note for note in verdict(printed, rubric).notes)


@pytest.mark.parametrize(
    ("readme", "points"),
    [
        ("Do colcon build, then source, then run the nodes.", 1),
        ("It draws with turtlesim, and it draws well. " * 10, 0),
        (evidences.README, 2),
    ],
)
def test_a_short_readme_is_no_other_packages(rubric: Rubric, readme: str, points: float) -> None:
    evidence = evidences.files(readme=readme, readme_commands={})(right())
    assert judged(evidence, rubric, "documentation.readme").points == points


@pytest.mark.parametrize("values", [[evidences.twist(0.0)] * 10, [evidences.twist(5e-324)] * 10])
def test_an_int_in_a_twist_costs_the_numbers_alone(rubric: Rubric, values: list[object]) -> None:
    """As outside the lab, where it does not end the node."""
    said = "Traceback\nAssertionError: The 'x' field must be of type 'float'"
    run = replace(evidences.velocity_run(values=values), refused=said)
    grade = verdict(evidences.runs(run)(right()), rubric)
    lost = [one for one in grade.criteria if one.points < one.max]
    assert [(one.id, one.points) for one in lost] == [("velocity_publisher.values", 0)]


@pytest.mark.parametrize(
    ("end", "why"),
    [
        ("[INFO] [robot]: engines off", "no error; it said last: “engines off”"),
        ("", "no word of why"),
        ("Killed\n[DEBUG] [robot]: engines off", "“Killed”"),
        ("[ERROR] [robot]: no engine", "“[ERROR] [robot]: no engine”"),
        (
            "[ERROR] [launch]: Caught exception in launch (see debug for traceback): no such thing\n"
            "[ERROR] [robot-1]: process has died [pid 4, exit code -2].",
            "“no such thing”",
        ),
        ("[INFO] [robot]: Error: it is far\nValueError: far", "“ValueError: far”"),
    ],
)
def test_what_went_well_is_no_reason_for_an_end(end: str, why: str) -> None:
    assert last_word(end) == why


def test_a_node_to_which_every_other_word_is_start_is_not_deaf(rubric: Rubric) -> None:
    said = {"stop": ["Robot stopped"], "reset": ["Robot reset"]}
    run = evidences.command_run(log=lambda text: said.get(text, ["Robot started"]))
    criterion = judged(evidences.runs(run)(right()), rubric, "command_subscriber.robustness")
    assert "does not answer" not in criterion.reason


@pytest.mark.parametrize(
    ("moves_after", "is_charged"),
    [
        ({"start": 0.5}, False),
        ({"dance": 0.5}, False),  # only then, after the start that was to move it: the machine is busy
        ({"stop": 0.0, "twirl": 0.5}, True),
        ({"start": 0.5, "stop": 0.0, "twirl": 0.5}, True),
        ({"reset": 0.0, "twirl": 0.5}, True),
    ],
)
def test_a_robot_that_moves_late_does_not_move_after_an_unknown_word(
    rubric: Rubric, moves_after: dict[str, float], is_charged: bool
) -> None:
    run = evidences.command_run(texts=("start", "dance", "stop", "reset", "twirl"))
    seen = evidences.moving(run, moves_after)
    silent = {text for text in ("start", "dance", "stop", "reset", "twirl") if text not in moves_after}
    commands = [replace(one, topics={}) if one.text in silent else one for one in seen.commands]
    robot = replace(seen, commands=commands, setting="launched", clock="real", programs=["robot.launch.py"])
    criterion = judged(evidences.runs(run, robot)(right()), rubric, "command_subscriber.robustness")
    assert ("starts to move" in criterion.reason) is is_charged


def test_a_node_that_plays_two_parts_costs_half_of_a_topic(rubric: Rubric) -> None:
    """Three nodes were asked for; it is the later part that has none of its own."""
    status, command, velocity = (
        evidences.status_run(),
        evidences.command_run(),
        evidences.velocity_run("/status_publisher", evidences.STATUS),
    )
    one = replace(
        status, publishes=status.publishes | velocity.publishes, quiet=status.quiet | velocity.quiet
    )
    grade = verdict(right([one, command]), rubric)
    assert [
        (one.id, one.max - one.points) for one in grade.criteria if "plays another part" in one.reason
    ] == [("velocity_publisher.topic", 2.5)]
    assert grade.components["status_publisher"].points == 20


def whole(node: str, program: str) -> Run:
    """Return a run of a node that plays all parts."""
    nodes = (evidences.status_run, evidences.command_run, evidences.velocity_run)
    return replace(evidences.merged([run(node, program) for run in nodes], program), nodes=[node])


@pytest.mark.parametrize(
    "nodes", [("/robot",) * 3, ("/status_publisher", "/command_subscriber", "/velocity_publisher")]
)
def test_one_node_that_three_programs_start_is_one(rubric: Rubric, nodes: tuple[str, ...]) -> None:
    programs = (evidences.STATUS, evidences.COMMAND, evidences.VELOCITY)
    grade = verdict(right([whole(*names) for names in zip(nodes, programs, strict=True)]), rubric)
    assert [
        (one.id, one.max - one.points) for one in grade.criteria if "plays another part" in one.reason
    ] == [("command_subscriber.topic", 2.0), ("velocity_publisher.topic", 2.5)]


def test_who_has_three_nodes_may_have_more(rubric: Rubric) -> None:
    more = [whole("/robot", "robot"), whole("/robot", "robot_2")]
    grade = verdict(right([*right().runs[:3], *more]), rubric)
    assert not [one.id for one in grade.criteria if "plays another part" in one.reason]


def test_a_node_that_sends_commands_is_told_to_listen(rubric: Rubric) -> None:
    run = evidences.command_run()
    sender = replace(run, publishes=run.subscribes, subscribes={}, commands=[])
    (one,) = (
        one
        for one in verdict(evidences.runs(sender)(right()), rubric).criteria
        if one.id == "command_subscriber.topic"
    )
    assert one.points == 0
    assert "/command_subscriber publishes on it, where a subscription is needed" in one.reason


def test_three_nodes_of_one_name_play_three_parts(rubric: Rubric) -> None:
    runs = [evidences.status_run("/node"), evidences.command_run("/node"), evidences.velocity_run("/node")]
    assert not any("plays another part" in one.reason for one in verdict(right(runs), rubric).criteria)


def test_what_could_not_be_tried_is_no_fault_of_its_own(rubric: Rubric) -> None:
    grade = verdict(FAULTS["setup.py does not parse"][1](right()), rubric)
    assert {one.component for one in grade.faults} == {"package", "workspace"}
    assert "could not be tried" in next(one.reason for one in grade.criteria if one.id == "bonus.launch")


def test_what_the_command_node_says_of_itself_is_no_status(rubric: Rubric) -> None:
    state = evidences.heard(evidences.STRING, "/command_subscriber", [{"data": "idle"}] * 9, 0.1)
    run = evidences.command_run()
    run = replace(
        run,
        publishes={"/robot/state": {"/command_subscriber": [evidences.STRING]}},
        quiet={"/robot/state": state},
    )
    e = evidences.both(evidences.without(evidences.STATUS, evidences.CRASH), evidences.runs(run))(right())
    assert losing(verdict(e, rubric)) == {"status_publisher": 20}


def test_a_message_without_sense_is_borne(rubric: Rubric) -> None:
    for values in ([None], ["inf"], [[1, "x"]], [{"linear": None}], []):
        run = evidences.velocity_run(values=values * 3)
        assert verdict(evidences.runs(run)(right()), rubric).total < 110


# --- overrides --------------------------------------------------------------------------------------------


def test_an_instructor_has_the_last_word(rubric: Rubric) -> None:
    e = FAULTS["status: never"][1](right())
    before = verdict(e, rubric)
    after = verdict(e, rubric, {"status_publisher.period": Decision(6.5, "It works on my robot.", "Ada")})
    one = next(one for one in after.criteria if one.id == "status_publisher.period")
    assert after.total == before.total + 6.5
    assert one.points == 6.5
    assert one.override is not None
    assert (one.override.machine, one.override.by) == (0, "Ada")
    assert after.components["status_publisher"].points == before.components["status_publisher"].points + 6.5
    assert after.faults == before.faults


def test_a_decision_about_nothing_is_refused(rubric: Rubric) -> None:
    with pytest.raises(ValueError, match="no criterion status"):
        verdict(right(), rubric, {"status": Decision(1, "so", "Ada")})


SPOKEN = {"start": ["Robot is OK, message 3"], "stop": [], "reset": [], "dance": ["Robot is OK, message 7"]}


@pytest.mark.parametrize(
    ("lines", "before", "is_right"),
    [
        # What another node says every other second falls now after this command and now after that one.
        (SPOKEN, ["Robot is OK, message 1"], False),
        # What is said at the start may be the answer to a command, too.
        (
            {
                "start": ["state: running"],
                "stop": ["state: stopped"],
                "reset": ["state: idle"],
                "dance": ["no"],
            },
            ["state: idle"],
            True,
        ),
    ],
)
def test_what_is_said_by_itself_is_no_answer_to_a_command(
    rubric: Rubric, lines: dict[str, list[str]], before: list[str], is_right: bool
) -> None:
    evidence = right()
    runs = [
        replace(
            run,
            log=[["INFO", line] for line in before],
            commands=[
                replace(one, log=[["INFO", line] for line in lines.get(one.text.lower(), [])], topics={})
                for one in run.commands
            ],
        )
        for run in evidence.runs
    ]
    criteria = {one.id: one for one in verdict(replace(evidence, runs=runs), rubric).criteria}
    for name in ("commands", "log"):
        one = criteria[f"command_subscriber.{name}"]
        assert (one.points == one.max) == is_right, one.reason
        assert is_right or not one.points, one.reason


@pytest.mark.parametrize("was_seen", [False, True])
def test_a_parameter_file_of_another_type_is_told_by_the_runs_without_it(
    rubric: Rubric, was_seen: bool
) -> None:
    """The node that does not take it ends at once when it is launched; alone and together it has another type."""
    e = right()
    alone = [run for run in e.runs if run.setting != "launched"]
    pair = evidences.merged([evidences.status_run(), evidences.command_run()], evidences.STATUS, "together")
    some = evidences.launched([evidences.command_run(), evidences.velocity_run()])
    if was_seen:
        some = replace(some, publishes=some.publishes | evidences.status_run().publishes)
    e = evidences.files(parameter_files={"config/robot.yaml": {"/status_publisher": {"period": "two"}}})(
        replace(e, runs=[*alone, some, pair])
    )
    e = evidences.files(parameter_file_users={"config/robot.yaml": ["launch/robot.launch.py"]})(e)
    (found,) = [one for one in verdict(e, rubric).criteria if one.id == "bonus.parameter_file"]
    assert found.points == 0
    assert "another type" in found.reason


@pytest.mark.parametrize(
    ("topic", "compared", "points"),
    [
        ("/robot_status", (), 0),  # nearly that of another part
        ("/news", (), 0),  # whoever drives may listen to anything
        ("/news", WORDS[:1], 0.5),  # that its topic tells nothing counts, too
        ("/cmds", (), 1),
    ],
)
def test_a_text_is_received_for_a_part_only_if_more_than_its_type_tells_so(
    rubric: Rubric, topic: str, compared: Sequence[str], points: float
) -> None:
    run = evidences.command_run("/subscriber_node", "listener", topic=topic, log=evidences.echo)
    run = replace(run, publishes={"/cmd_vel": {"/subscriber_node": [evidences.TWIST]}})
    seen = evidences.files(compared=list(compared))(evidences.runs(run)(right()))
    alone = [one for one in seen.runs if one.setting == "alone" and one.programs != [evidences.COMMAND]]
    seen = replace(seen, runs=alone)
    assert judged(seen, rubric, "command_subscriber.topic").points == points


@pytest.mark.parametrize(
    ("ends", "is_blamed"),
    [
        ([], True),
        ([WrittenEnd("/scan", "sensor_msgs/msg/LaserScan", False, [], "scanner")], False),
        ([WrittenEnd("/robot_status", evidences.STRING, True, [], "scanner")], True),
    ],
)
def test_a_program_is_the_reason_for_a_part_only_if_it_may_have_it(
    rubric: Rubric, ends: list[WrittenEnd], is_blamed: bool
) -> None:
    def renamed(run: Run) -> Run:
        is_it = run.programs == [evidences.STATUS]
        return replace(run, programs=["scanner"], ended={"scanner": "OSError: no port"}) if is_it else run

    seen = evidences.without(evidences.STATUS)(right())
    assert seen.build
    programs = [
        replace(one, name="scanner", target="robot_controller.scanner:main")
        if one.name == evidences.STATUS
        else one
        for one in seen.build.executables
    ]
    seen = replace(
        evidences.files(ends=ends)(seen),
        build=replace(seen.build, executables=programs),
        runs=[renamed(run) for run in seen.runs if run.setting == "alone"],
    )
    assert ("scanner" in judged(seen, rubric, "status_publisher.topic").reason) == is_blamed


@pytest.mark.parametrize(
    ("readme", "commands", "reason"),
    [
        ("", {}, "No README names any topic or node."),
        (
            "The node /square drives a turtle on /turtle1/cmd_vel. " * 5,
            {"ros2 run turtle_draw square": None, "ros2 run turtle_draw circle": None},
            "No README about this package names any topic or node.",
        ),
        (
            f"{evidences.README} Then draw.",
            {"ros2 run turtle_draw square": False, "ros2 run turtle_draw circle": False},
            "No README about this package names any topic or node.",
        ),
        (
            "Three nodes for homework. " * 9,
            {},
            "No README names /robot/status, the node /status_publisher, /robot/command",
        ),
    ],
    ids=["none", "of another package", "with commands of another", "of no package"],
)
def test_a_readme_is_not_said_to_name_nothing_if_it_names_what_another_has(
    rubric: Rubric, readme: str, commands: dict[str, bool | None], reason: str
) -> None:
    given = evidences.files(readme=readme, readme_commands=commands)(right())
    one = judged(given, rubric, "documentation.interface")
    assert one.points == 0
    assert one.reason.startswith(reason)


def test_a_package_of_which_nothing_is_built_is_not_said_to_be_none(rubric: Rubric) -> None:
    """The handed-in folder is itself the package; then it is no use to say that there is none."""
    given = evidences.submission(
        form="package", workspace=None, package=replace(evidences.PACKAGE, folder=".")
    )(right())
    given = evidences.files(manifest={"is_there": False}, setup={"is_there": True})(given)
    said = [judged(given, rubric, f"workspace.{what}") for what in ("layout", "build")]
    assert [one.points for one in said] == [3, 0]
    assert said[0].reason.startswith("What was handed in, a setup.py without a package.xml")
    assert "There is no package that" not in said[1].reason
    assert "the package that was handed in: it has no package.xml" in said[1].reason
    nothing = evidences.submission(form="files", package=None, packages=[])(given)
    assert judged(nothing, rubric, "workspace.build").reason == "There is no package that colcon could build."


def test_a_readme_that_names_what_is_in_the_code_is_about_it(rubric: Rubric) -> None:
    text = "`StatusTeller` tells how it goes. " * 9
    general = evidences.files(readme=text, readme_commands={})(right())
    assert "names nothing of this one" in judged(general, rubric, "documentation.readme").reason
    named = evidences.files(readme_names=["StatusTeller"])(general)
    assert judged(named, rubric, "documentation.readme").points == 2


def test_a_parameter_file_that_lies_on_one_machine_is_told_so(rubric: Rubric) -> None:
    e = evidences.files(
        parameter_files={"config/a.yaml": {"/nobody": {"period": 2.0}}},
        hard_coded=["/home/anna/ws/config/a.yaml"],
    )(right())
    assert "/home/anna/ws/config/a.yaml" in judged(e, rubric, "bonus.parameter_file").reason


@pytest.mark.parametrize(
    ("said", "what"),
    [
        (
            "serial.serialutil.SerialException: [Errno 2] could not open port /dev/ttyUSB0: No such file",
            "a device",
        ),
        (
            "FileNotFoundError: [Errno 2] No such file or directory: '/sys/class/thermal/thermal_zone0/temp'",
            "a device",
        ),
        ("PermissionError: [Errno 13] Permission denied: '/dev/i2c-1'", "a device"),
        ("socket.gaierror: [Errno -3] Temporary failure in name resolution", "a network"),
        ("ConnectionRefusedError: [Errno 111] Connection refused", "a network"),
        ("OSError: [Errno 101] Network is unreachable", "a network"),
        ("_tkinter.TclError: no display name and no $DISPLAY environment variable", "a display"),
        ("qt.qpa.xcb: could not connect to display", "a display"),
        ("FileNotFoundError: [Errno 2] No such file or directory: 'config/robot.yaml'", ""),
        ("FileNotFoundError: [Errno 2] No such file or directory: '/home/ada/dev/sys/robot.yaml'", ""),
        ("AttributeError: 'Node' object has no attribute 'create_publihser'", ""),
        ("opened /dev/ttyUSB0 and connected to the display", ""),
        ("ValueError: the command 'dance' is not known", ""),
        ("KeyError: 'there is no display'", ""),
        ("socket.gaierror: [Errno -2] Name or service not known", "a network"),
    ],
)
def test_what_a_machine_lacks_is_known_by_the_error(said: str, what: str) -> None:
    said = f'Traceback (most recent call last):\n  File "n.py", line 3, in main\n    open(port)\n{said}\n'
    assert lacked(said) == ([what] if what else [])


@pytest.mark.parametrize("number", ["nan", "inf", "-inf", 5e-324])
@pytest.mark.parametrize("setting", ["alone", "together", "launched"])
def test_a_number_that_nothing_can_use_is_seen_whenever_it_comes(
    rubric: Rubric, setting: str, number: object
) -> None:
    """Not only before any command, nor only in the program by itself."""
    evidence = right(
        [
            evidences.status_run(),
            evidences.command_run(),
            evidences.velocity_run(),
            evidences.merged(
                [evidences.command_run(texts=evidences.SCRIPT.few), evidences.velocity_run()],
                "velocity_publisher",
                "together",
            ),
        ]
    )
    odd = evidences.heard(
        evidences.TWIST, "/velocity_publisher", [evidences.twist(0.0), evidences.twist(number)], 0.1
    )

    def changed(run: Run) -> Run:
        if run.setting != setting or "/cmd_vel" not in run.publishes:
            return run
        commands = run.commands or evidences.command_run(texts=("stop",)).commands
        return replace(
            run,
            commands=[
                replace(one, topics={"/cmd_vel": odd} if one.text == "stop" else one.topics)
                for one in commands
            ],
        )

    assert judged(evidence, rubric, "velocity_publisher.values").points == 3
    evidence = replace(evidence, runs=[changed(run) for run in evidence.runs])
    criterion = judged(evidence, rubric, "velocity_publisher.values")
    assert criterion.points == 0
    assert criterion.reason.startswith("linear.x is ")
    assert "commands[" in criterion.evidence[0]


TOPICS = ("status_publisher.topic", "command_subscriber.topic", "velocity_publisher.topic")


def by_launch_files(*launched: list[Run], alone: tuple[str, str] = ("/status", "/drive/cmd_vel")) -> Evidence:
    """Return the evidence of nodes that by themselves have other topics, and of what launch files make of them."""
    status, velocity = alone
    evidence = right(
        [
            evidences.status_run(topic=status),
            evidences.command_run(),
            evidences.velocity_run(topic=velocity),
        ]
    )
    runs = [run for run in evidence.runs if run.setting != "launched"]
    runs += [
        replace(evidences.launched(parts), programs=[f"{number}.launch.py"])
        for number, parts in enumerate(launched)
    ]
    return replace(evidence, runs=runs)


STATUS_RIGHT, VELOCITY_RIGHT = evidences.status_run(), evidences.velocity_run()
STATUS_OFF, VELOCITY_OFF = (
    evidences.status_run(topic="/status"),
    evidences.velocity_run(topic="/drive/cmd_vel"),
)
TAKES = evidences.command_run()
# What each launch file starts, and what the three topics are worth.
IN_ONE_WAY = {
    "one launch file": ([[STATUS_RIGHT, TAKES, VELOCITY_RIGHT]], 14),
    "a launch file of two, and a program beside it": ([[STATUS_RIGHT, VELOCITY_RIGHT]], 14),
    "a launch file for each node": ([[STATUS_RIGHT], [TAKES], [VELOCITY_RIGHT]], 14),
    "a right one and a wrong one": (
        [[STATUS_OFF, TAKES, VELOCITY_OFF], [STATUS_RIGHT, TAKES, VELOCITY_RIGHT]],
        14,
    ),
}
IN_NO_WAY = {
    "each right for one": [[STATUS_RIGHT, TAKES, VELOCITY_OFF], [STATUS_OFF, TAKES, VELOCITY_RIGHT]],
    "one of them does not start the other": [[STATUS_RIGHT, TAKES], [STATUS_OFF, TAKES, VELOCITY_RIGHT]],
    "two that share a node": [[STATUS_RIGHT, TAKES], [TAKES, VELOCITY_RIGHT]],
}


@pytest.mark.parametrize("name", IN_ONE_WAY)
def test_topics_that_are_right_in_one_way_of_starting_are_right(rubric: Rubric, name: str) -> None:
    launched, points = IN_ONE_WAY[name]
    evidence = by_launch_files(*launched)
    assert sum(judged(evidence, rubric, topic).points for topic in TOPICS) == points


@pytest.mark.parametrize("name", IN_NO_WAY)
def test_topics_that_are_right_in_several_ways_of_starting_only_are_not_put_together(
    rubric: Rubric, name: str
) -> None:
    """One of them has its topic, and the other one does not, whatever the launch files are."""
    evidence = by_launch_files(*IN_NO_WAY[name])
    criteria = [judged(evidence, rubric, topic) for topic in TOPICS]
    lost = [one for one in criteria if one.points < one.max]
    assert len(lost) == 1, [one.reason for one in criteria]
    assert lost[0].points <= lost[0].max / 2
    assert "not /" in lost[0].reason or "another way of starting" in lost[0].reason


def test_a_period_counts_in_the_way_in_which_the_topics_are_right(rubric: Rubric) -> None:
    """A launch file that gives the right period to another topic brings nothing."""
    slow = evidences.status_run(topic="/status", period=5.0)
    slow_right = evidences.status_run(period=5.0)
    fast_off = evidences.status_run(topic="/robot/state_of_it", period=2.0)
    evidence = by_launch_files([slow_right, TAKES, VELOCITY_RIGHT], [fast_off, TAKES, VELOCITY_RIGHT])
    runs = [
        replace(run, publishes=slow.publishes, quiet=slow.quiet)
        if run.programs == ["status_publisher"] and run.setting == "alone"
        else run
        for run in evidence.runs
    ]
    evidence = replace(evidence, runs=runs)
    assert judged(evidence, rubric, "status_publisher.topic").points == 5
    assert judged(evidence, rubric, "status_publisher.period").points < 7
    # Of two in which the topics are right, the one with the right period is meant.
    right_fast = by_launch_files([slow_right, TAKES, VELOCITY_RIGHT], [STATUS_RIGHT, TAKES, VELOCITY_RIGHT])
    right_fast = replace(
        right_fast, runs=[*runs[:3], *(r for r in right_fast.runs if r.setting == "launched")]
    )
    assert judged(right_fast, rubric, "status_publisher.period").points == 7


# The name of a parameter, its value; values that were tried, each with the period that came; what that is worth.
FOLLOWED: dict[str, tuple[str, object, list[tuple[object, float]], float]] = {
    "a period": ("period", 2.0, [(1.0, 1.0)], 2),
    "a period, whole": ("timer_period", 2, [(1, 1.0)], 2),
    "milliseconds": ("period_ms", 2000, [(1000, 1.0)], 2),
    "a rate": ("publish_rate", 0.5, [(1.0, 1.0)], 2),
    "a rate per minute": ("per_minute_freq", 30.0, [(15.0, 4.0)], 2),
    "a period and some work": ("period", 1.7, [(0.85, 1.1)], 2),
    "ticks of a faster timer": ("interval", 2.0, [(1.0, 1.2)], 2),
    "a least period": ("period", 2.0, [(1.0, 1.5), (4.0, 4.0)], 2),
    "a most period": ("period", 2.0, [(4.0, 3.0), (1.0, 1.0)], 2),
    "a least period that it has": ("period", 2.0, [(1.0, 2.0), (4.0, 4.0)], 2),
    "one other period": ("period", 2.0, [(1.0, 0.8), (4.0, 0.8)], 0),
    "one other period, seen once": ("period", 2.0, [(1.0, 0.8)], 0),
    "one other period, by chance the right one": ("period", 2.0, [(1.0, 1.0), (4.0, 1.0)], 0),
    "one slow period": ("period", 2.0, [(1.0, 7.0), (4.0, 7.0)], 0),
    "some other period between": ("period", 2.0, [(1.0, 1.4), (4.0, 1.4)], 0),
    "the right and the wrong way": ("period", 2.0, [(1.0, 1.0), (4.0, 0.5)], 0),
    "no other period": ("period", 2.0, [(1.0, 2.0)], 0),
}


@pytest.mark.parametrize("name", FOLLOWED)
def test_a_period_follows_its_parameter(rubric: Rubric, name: str) -> None:
    """Any other change may be one period for whatever is not the default."""
    parameter, own, tries, points = FOLLOWED[name]
    e = right()
    runs = [
        replace(run, parameters={"/status_publisher": {parameter: own}})
        if run.programs == [evidences.STATUS]
        else run
        for run in e.runs
        if ":=" not in run.setting
    ]
    runs += [
        replace(evidences.status_run(period=period), setting=f"{parameter}:={value}")
        for value, period in tries
    ]
    assert judged(replace(e, runs=runs), rubric, "bonus.parameters").points == points


def test_a_rhythm_that_was_asked_for_is_nobodys_own(rubric: Rubric) -> None:
    """Where a program has another period while all obey together, that is by chance the right one."""
    e = right()
    status = evidences.status_run(period=4.0)
    others = [run for run in e.runs if run.programs != [evidences.STATUS] and run.setting == "alone"]
    obey = evidences.merged([*others, evidences.status_run(period=2.0)], "", "together")
    obey = replace(obey, programs=[*evidences.NODES], parameters={})
    alone, own, given = (
        judged(replace(e, runs=[status, *others, *more]), rubric, "status_publisher.period").points
        for more in ([], [obey], [replace(obey, changed=[evidences.STATUS])])
    )
    assert given == alone < own


MEMORY = LIMITS["memory"].format(1000)


@pytest.mark.parametrize("limit", LIMITS)
def test_what_a_limit_has_ended_did_not_end_by_itself(rubric: Rubric, limit: str) -> None:
    said = LIMITS[limit].format(7)
    grade = verdict(evidences.ended(evidences.STATUS, said)(right()), rubric)
    told = [one.reason for one in grade.criteria if "limit" in one.reason] + [*grade.notes]
    assert any(f"ended at a limit: {said[0].lower()}{said[1:]}" in text for text in told)
    assert not any("by itself with" in text for text in told)
    (life,) = (one for one in grade.criteria if one.id == "status_publisher.life")
    assert (life.points, "Spin" in life.hint) == (1.25, False)


@pytest.mark.parametrize(
    "said", ["It failed.", f"{MEMORY}\nBye", f"Error: {MEMORY}", "It used more than enough"]
)
def test_what_a_program_says_of_itself_is_no_limit(said: str) -> None:
    assert not is_limit(said)
    assert ended(said).startswith("by itself with ")


LAUNCHED = "[INFO] [launch]: Default logging verbosity is set to INFO\n"
ASKED = "[INFO] [{0}]: sending signal 'SIGINT' to process[{0}]\n"
CLEAN = "[INFO] [{0}]: process has finished cleanly [pid 7]\n"
DIED = "[ERROR] [{0}]: process has died [pid 7, exit code {1}, cmd '/x/{0} --ros-args'].\n"
INTERRUPTED = "[{0}] KeyboardInterrupt\n"
EXTERNAL = "[{0}] rclpy.executors.ExternalShutdownException\n"
CAUGHT = "[ERROR] [launch]: Caught exception in launch (see debug for traceback): no such package\n"
# What `ros2 launch` said last, whether it has itself ended all, and else why it ended.
SHUT_DOWN: dict[str, tuple[str, bool, str]] = {
    "all by SIGINT": (INTERRUPTED.format("a-1") + DIED.format("b-2", -2) + DIED.format("a-1", -2), True, ""),
    "all end well": (ASKED.format("a-1") + ASKED.format("b-2") + CLEAN.format("a-1"), True, ""),
    "they do not catch it": (EXTERNAL.format("a-1") + DIED.format("a-1", 1), True, ""),
    "asked, and died of it": (ASKED.format("a-1") + DIED.format("a-1", 1), True, ""),
    "one has died before": (
        DIED.format("a-1", 1) + ASKED.format("b-2") + DIED.format("b-2", -2),
        False,
        "[ERROR] [a-1]: process has died",
    ),
    "a fault of the launch file": (CAUGHT + DIED.format("a-1", -2), False, "no such package"),
    "they end by themselves": (LAUNCHED + CLEAN.format("a-1"), False, ""),
    "killed": (DIED.format("a-1", -9), False, "[ERROR] [a-1]: process has died"),
}


@pytest.mark.parametrize("name", SHUT_DOWN)
def test_a_launch_file_that_ends_its_nodes_itself_is_told_so(rubric: Rubric, name: str) -> None:
    """Not to look for executables that are not there, nor what its nodes said when they were asked to end."""
    said, is_own, why = SHUT_DOWN[name]
    e = right()
    runs = [
        replace(
            run, nodes=[], publishes={}, subscribes={}, quiet={}, commands=[], ended={run.programs[0]: said}
        )
        if run.setting == "launched"
        else run
        for run in e.runs
    ]
    grade = verdict(replace(e, runs=runs), rubric)
    (criterion,) = (one for one in grade.criteria if one.id == "bonus.launch")
    assert criterion.points == 0
    assert ("shuts everything down by itself" in criterion.reason) is is_own
    assert ("executable" in criterion.hint) is not is_own
    assert any("it shut down all that it had started" in note for note in grade.notes) is is_own
    assert why in criterion.reason


def test_a_build_that_says_nothing_has_no_first_error_to_be_fixed(rubric: Rubric) -> None:
    criterion = judged(evidences.unbuilt(NO_WORD)(right()), rubric, "package.setup")
    assert criterion.points == 0
    assert "without an error" in criterion.reason
    assert "first error" not in criterion.hint
    other = judged(evidences.unbuilt("SyntaxError: x")(right()), rubric, "package.setup")
    assert "first error" in other.hint


@pytest.mark.parametrize(
    ("change", "points"),
    [
        (lambda e: e, 2),
        (evidences.without(evidences.STATUS, "TypeError: no"), 0),
        (evidences.without(evidences.STATUS), 0),
        (evidences.without(evidences.STATUS, "motor.NotInstalledHere: no board"), 2),
        (evidences.without(evidences.VELOCITY, "TypeError: no"), 2),
    ],
)
def test_only_what_a_program_at_work_catches_counts(
    rubric: Rubric, change: evidences.Change, points: float
) -> None:
    """A program of which no node was seen catches nothing; what waits for hardware would."""
    e = evidences.right()
    assert e.build
    programs = [replace(one, modules=[one.name]) for one in e.build.executables]
    places = {"by name": [Place("robot_controller/status_publisher.py", 3)]}
    e = evidences.files(handlers=places)(replace(e, build=replace(e.build, executables=programs)))
    assert judged(change(e), rubric, "bonus.errors").points == points


def test_a_parameter_file_for_no_node_at_all_earns_nothing(rubric: Rubric) -> None:
    """As a launch file does; where one of the nodes is lost, that counts there."""
    e = evidences.right()
    assert judged(e, rubric, "bonus.parameter_file").points == 2
    nothing = evidences.both(*(evidences.without(name) for name in evidences.NODES))(e)
    nothing = replace(nothing, runs=[run for run in nothing.runs if not run.nodes])
    found = judged(nothing, rubric, "bonus.parameter_file")
    assert (found.points, "no node at all was seen" in found.reason) == (0, True)
    unbuilt = evidences.unbuilt("SyntaxError")(nothing)
    found = judged(replace(unbuilt, runs=[]), rubric, "bonus.parameter_file")
    assert (found.points, "was not built" in found.reason) == (0, True)


@pytest.mark.parametrize(
    ("command", "is_excused"),
    [
        ("ros2 topic echo /robot/status geometry_msgs/msg/Twist", False),
        ("ros2 topic echo /robot/status std_msgs/msg/String", True),
        ("ros2 param set /status_publisher speed_limit 3.0", False),
        ("ros2 run robot_controller status_publisher --ros-args --speed 3", False),
    ],
)
def test_what_a_command_gives_is_the_readmes_own(rubric: Rubric, command: str, is_excused: bool) -> None:
    """Whatever else is wrong: only a type that the assignment asks for is a node's fault."""
    e = evidences.right()
    commands = {**e.files.readme_commands, command: False}
    given = evidences.files(readme_commands=commands, readme_misgiven=[command])(e)
    assert (judged(given, rubric, "documentation.commands").points == 3) is is_excused


def test_all_that_package_xml_does_not_declare_is_named(rubric: Rubric) -> None:
    """Also what the assignment did not ask for; it costs nothing more."""
    change = evidences.facts(
        "manifest", "declares_all_imports", "declares_geometry_msgs", "declares_sensor_msgs"
    )
    criterion = judged(change(right()), rubric, "package.dependencies")
    assert criterion.points == 2
    assert criterion.reason == "package.xml does not declare geometry_msgs and sensor_msgs."


@pytest.mark.parametrize(("is_declared", "points"), [(True, 3), (False, 2)])
def test_what_was_seen_at_run_time_is_to_be_declared(
    rubric: Rubric, is_declared: bool, points: float
) -> None:
    """A type that came by no import that can be read, such as by importlib."""
    whole = right()
    manifest = {k: v for k, v in whole.files.manifest.items() if k != "declares_std_msgs"}
    given = replace(whole, files=replace(whole.files, manifest=manifest | {"has_std_msgs": is_declared}))
    alone = replace(given, submission=replace(given.submission, packages=given.submission.packages[:1]))
    assert judged(alone, rubric, "package.dependencies").points == points


TUTORIAL = FoundPackage("robot_project_ws/src/my_package", "my_package", "ament_python", None)


def beside(given: Evidence, ends: Sequence[WrittenEnd] = (), *others: Run) -> Evidence:
    """Return evidence with another package, which is described by nobody, has a fault, and cannot all be started."""
    assert given.build
    programs = [
        replace(evidences.executable("talker"), package="my_package", modules=["talker"]),
        replace(
            evidences.executable("broken"),
            package="my_package",
            modules=["broken"],
            way="module",
            fault="No entry point leads to it.",
        ),
    ]
    crashed = Run(
        ["broken"], "alone", "stepped", [], {}, {}, {}, {}, {}, [], {"broken": evidences.CRASH}, {}, []
    )
    place = f"{TUTORIAL.folder}/my_package/talker.py:3"
    counts = {"modules": [0, 9], "functions": [0, 20]}
    files = replace(
        given.files,
        findings=[["dependency-undeclared", "std_msgs is not declared.", place, "declare it"]],
        sources={**given.files.sources, "modules": [3, 12], "functions": [6, 28]},
        sources_beside={"my_package": counts},
        ends=[*ends],
    )
    return replace(
        given,
        submission=replace(given.submission, also=[TUTORIAL], packages=[evidences.PACKAGE, TUTORIAL]),
        files=files,
        build=replace(given.build, executables=[*given.build.executables, *programs]),
        runs=[*given.runs, crashed, *others],
    )


def test_what_is_left_of_a_tutorial_is_not_blamed_on_the_package(rubric: Rubric) -> None:
    """Neither its faults, nor that it is not described, nor that what it has cannot be started or ends."""
    lost = evidences.facts("manifest", "declares_std_msgs")(right())
    lost = replace(lost, runs=[run for run in lost.runs if evidences.COMMAND not in run.programs])
    chatter = evidences.status_run("/talker", "talker", topic="/chatter", values=0)
    alone, given = verdict(lost, rubric), verdict(beside(lost, [], chatter), rubric)
    assert {one.id: one.points for one in given.criteria} == {one.id: one.points for one in alone.criteria}
    assert not [fault for fault in given.faults if "broken" in fault.cause or "my_package" in fault.place]
    assert any(note.startswith("Not graded") and "my_package" in note for note in given.notes)


@pytest.mark.parametrize("is_seen", [True, False])
def test_a_package_that_has_a_part_of_the_work_counts(rubric: Rubric, is_seen: bool) -> None:
    """Also where its node is not seen, and its code plainly makes it."""
    lost = replace(right(), runs=[run for run in right().runs if run.programs == [evidences.STATUS]])
    ends = [WrittenEnd("/cmd_vel", evidences.TWIST, True, [0.1], "broken")]
    drives = [evidences.velocity_run("/talker", "talker")] if is_seen else []
    given = verdict(beside(lost, ends, *drives), rubric)
    assert (given.components["velocity_publisher"].points > 15) == is_seen
    assert any(note.startswith("Part of the work") and "my_package" in note for note in given.notes)
    code = next(one for one in given.criteria if one.id == "documentation.code")
    assert code.points < code.max


@pytest.mark.parametrize(("count", "level"), [(1, "now and then"), (2, "every 2.3 s")])
def test_what_comes_once_behind_each_command_has_no_rhythm_of_its_own(
    rubric: Rubric, count: int, level: str
) -> None:
    """That is the rhythm in which the commands were said."""
    run = evidences.command_run()
    topics = [
        {
            "/robot/status": evidences.heard(
                evidences.STRING, "/command_subscriber", [{"data": "free"}] * count, 2.3, 4.6 * n
            )
        }
        for n in range(len(run.commands))
    ]
    answering = replace(
        run,
        publishes={"/robot/status": {"/command_subscriber": [evidences.STRING]}},
        commands=[replace(one, topics=heard) for one, heard in zip(run.commands, topics, strict=True)],
    )
    one = judged(right([answering]), rubric, "status_publisher.period")
    assert level in one.reason
