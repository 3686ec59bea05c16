"""Who plays a part, and who answers for it: what was seen comes before what cannot be started, one node for all questions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import evidences
import pytest
from evidences import COMMAND, STATUS, STRING, TWIST, VELOCITY

from ros2lab.grading.evidence import GIVEN, Evidence, Executable, Run, WrittenEnd
from ros2lab.grading.grade import Judgement
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

MISSING = "Its module cannot be imported: ModuleNotFoundError: No module named 'robot_controller.left_over'."
SYNTAX = 'Traceback (most recent call last):\n  File "x.py", line 3\nSyntaxError: invalid syntax'


def judged(evidence: Evidence) -> dict[str, Judgement]:
    """Return the criteria by their names."""
    return {criterion.id: criterion for criterion in verdict(evidence, load()).criteria}


def points(evidence: Evidence, part: str) -> float:
    """Return the points for a part."""
    return sum(one.points for name, one in judged(evidence).items() if name.startswith(f"{part}."))


def with_programs(evidence: Evidence, *programs: Executable) -> Evidence:
    """Return evidence with more executables."""
    assert evidence.build
    executables = [*evidence.build.executables, *programs]
    return replace(evidence, build=replace(evidence.build, executables=executables))


def dead(name: str, modules: Sequence[str] = ()) -> Executable:
    """Return an executable that nothing can start; without modules, its module does not exist."""
    return replace(evidences.executable(name), command=[], modules=[*modules], fault=MISSING)


# Near-misses of each part, none of which has the part's topic.
NEAR_MISSES = {
    STATUS: evidences.status_run("/my_publisher", "talker", topic="/my_topic", period=1.0),
    COMMAND: evidences.command_run("/my_subscriber", "listener", topic="/my_topic"),
    VELOCITY: evidences.velocity_run("/turtle_circle", "circle", topic="/turtle1/cmd_vel"),
}


def seen_nearly(part: str) -> Evidence:
    """Return evidence in which a part has a near-miss alone."""
    own = {
        STATUS: evidences.status_run(),
        COMMAND: evidences.command_run(),
        VELOCITY: evidences.velocity_run(),
    }
    return evidences.right([*(own | {part: NEAR_MISSES[part]}).values()])


@pytest.mark.parametrize("part", NEAR_MISSES)
@pytest.mark.parametrize("modules", [(), ("left_over",)], ids=["without a module", "with a module"])
@pytest.mark.parametrize("name", ["left_over", "named for it"])
def test_a_program_that_cannot_be_started_takes_nothing_from_what_was_seen(
    part: str, modules: tuple[str, ...], name: str
) -> None:
    given = seen_nearly(part)
    assert points(given, part) > 4
    entry = dead(part if name == "named for it" else name, modules)
    assert points(with_programs(given, entry), part) == points(given, part)


@pytest.mark.parametrize("part", NEAR_MISSES)
@pytest.mark.parametrize("nodes", [[], ["/lost"]], ids=["at its start", "with a node"])
def test_a_program_that_ends_takes_nothing_from_what_was_seen(part: str, nodes: list[str]) -> None:
    given = seen_nearly(part)
    run = Run([part], "alone", "stepped", nodes, {}, {}, {}, {}, {}, [], {part: SYNTAX}, {}, [])
    both = with_programs(replace(given, runs=[*given.runs, run]), evidences.executable(part))
    assert points(both, part) == points(given, part)


@pytest.mark.parametrize(
    ("modules", "topic", "is_named"),
    [
        (["left_over"], "/robot/status", True),
        (["left_over"], "/speed", False),
        ([], "/robot/status", False),
    ],
    ids=["it makes the node", "it makes another one", "there is no module"],
)
def test_what_cannot_be_started_is_the_reason_only_where_it_makes_the_node(
    modules: list[str], topic: str, is_named: bool
) -> None:
    """Whatever it is called."""
    runs = [evidences.command_run(), evidences.velocity_run()]
    kind = STRING if is_named else TWIST
    end = WrittenEnd(topic, kind, True, [2.0], modules[0] if modules else "status")
    given = evidences.files(ends=[end])(with_programs(evidences.right(runs), dead("status_node", modules)))
    assert ("status_node cannot be started" in judged(given)[f"{STATUS}.topic"].reason) is is_named


def waiting(part: str, *, is_given: bool) -> Evidence:
    """Return evidence of a node that waits, on the right topic, beside another node of the type on another one."""
    silent = {
        STATUS: evidences.status_run(values=0),
        VELOCITY: evidences.velocity_run(values=[]),
    }[part]
    waits = replace(silent, subscribes={"/scan": {silent.nodes[0]: ["sensor_msgs/msg/LaserScan"]}})
    other = {
        STATUS: evidences.status_run("/test", "test", topic="/robot/status_test"),
        VELOCITY: evidences.velocity_run("/turtle", "turtle", topic="/turtle1/cmd_vel"),
    }[part]
    rest = {
        STATUS: [evidences.command_run(), evidences.velocity_run()],
        VELOCITY: [evidences.status_run(), evidences.command_run()],
    }
    evidence = evidences.right([waits, other, *rest[part]])
    given = replace(waits, programs=[*waits.programs, *other.programs], setting=GIVEN)
    given = replace(given, ungiven={"/scan": "scanner_msgs/msg/Scan"})
    return replace(evidence, runs=[*evidence.runs, given]) if is_given else evidence


@pytest.mark.parametrize("part", [STATUS, VELOCITY])
def test_one_node_answers_all_questions_of_a_part(part: str) -> None:
    """What another node publishes elsewhere does not count for the one that is silent on the right topic."""
    found = judged(waiting(part, is_given=False))
    reasons = [one.reason for name, one in found.items() if name.startswith(f"{part}.")]
    assert not [reason for reason in reasons if "/turtle1" in reason or "_test" in reason]
    assert found[f"{part}.life"].points == 0
    assert sum("othing came" in reason or "othing comes" in reason for reason in reasons) > 1


@pytest.mark.parametrize("part", [STATUS, VELOCITY])
def test_what_waits_for_what_nobody_brings_costs_nothing_beside_another_node(part: str) -> None:
    assert points(waiting(part, is_given=True), part) == 20


def test_what_a_node_publishes_when_it_is_given_something_counts_beside_another_node() -> None:
    given = waiting(VELOCITY, is_given=True)
    *others, last = given.runs
    said = evidences.velocity_run().quiet
    answered = replace(given, runs=[*others, replace(last, quiet=said)])
    assert points(answered, VELOCITY) == 20
    assert judged(answered)[f"{VELOCITY}.repetition"].reason.startswith("Messages come on /cmd_vel")


def test_a_number_of_another_node_on_another_topic_is_not_held_against_a_part() -> None:
    other = evidences.velocity_run(
        "/turtle2", "turtle2", topic="/turtle2/cmd_vel", values=[evidences.twist("nan")] * 5
    )
    runs = [evidences.status_run(), evidences.command_run(), NEAR_MISSES[VELOCITY]]
    assert judged(evidences.right([*runs, other]))[f"{VELOCITY}.values"].points == 3


def driver(node: str, program: str) -> Run:
    """Return a run of a node that takes the commands and drives."""
    taken = evidences.command_run(node, program)
    return replace(
        evidences.velocity_run(node, program),
        subscribes=taken.subscribes,
        commands=taken.commands,
        commanded=taken.commanded,
    )


def targets(evidence: Evidence, by_program: dict[str, str]) -> Evidence:
    """Return evidence in which some programs run given functions."""
    assert evidence.build
    executables = [
        replace(one, target=by_program.get(one.name, one.target)) for one in evidence.build.executables
    ]
    return replace(evidence, build=replace(evidence.build, executables=executables))


@pytest.mark.parametrize(
    ("first", "second", "is_same_function", "is_one"),
    [
        ("/robot", "/robot", False, True),
        ("/robot", "/robot_copy", True, True),
        ("/commander", "/driver", False, False),
    ],
    ids=["two files", "started twice", "two nodes that do both"],
)
def test_a_class_that_is_started_twice_is_one_node(
    first: str, second: str, is_same_function: bool, is_one: bool
) -> None:
    runs = [evidences.status_run(), driver(first, "robot"), driver(second, "robot_copy")]
    given = evidences.right(runs)
    if is_same_function:
        given = targets(given, dict.fromkeys(("robot", "robot_copy"), "robot_controller.robot:main"))
    assert (judged(given)[f"{VELOCITY}.topic"].points == 2.5) is is_one


def test_a_copy_beside_nodes_for_each_part_costs_nothing() -> None:
    runs = [evidences.status_run(), evidences.command_run(), evidences.velocity_run()]
    given = evidences.right([*runs, driver("/robot", "robot"), driver("/robot", "robot_copy")])
    assert judged(given)[f"{VELOCITY}.topic"].points == 5


TOPIC = "/robot/status"
BATTERY = "Traceback (most recent call last):\nRuntimeError: battery empty"


def answering() -> Run:
    """Return a run of a command subscriber that also says a status after each command."""
    run = evidences.command_run()
    said = [
        replace(one, topics={TOPIC: evidences.heard(STRING, run.nodes[0], [{"data": "ok"}])})
        for one in run.commands
    ]
    return replace(run, commands=said, publishes={TOPIC: {run.nodes[0]: [STRING]}})


@pytest.mark.parametrize(
    ("end", "program", "points"),
    [("", STATUS, 5.0), (BATTERY, STATUS, 1.25)],
)
def test_the_program_with_the_rhythm_answers_for_the_status(end: str, program: str, points: float) -> None:
    """Another one only says something when it is told to, on the same topic."""
    status = evidences.status_run()
    status = replace(status, ended={STATUS: end} if end else {})
    evidence = evidences.right([answering(), status, evidences.velocity_run()])
    found = judged(evidence)
    assert found["status_publisher.topic"].reason == "/status_publisher publishes on /robot/status."
    assert found["status_publisher.life"].reason.startswith(program)
    assert found["status_publisher.life"].points == points


def relay(given: str, kind: str = TWIST) -> Evidence:
    """Return evidence of a velocity that comes only of what was given on a topic; a Twist is handed on."""
    silent, moving = evidences.velocity_run(values=[]), evidences.velocity_run()
    taker = replace(silent, subscribes={given: {silent.nodes[0]: [kind]}})
    gave = replace(moving, setting=GIVEN, given=[given], gave={given: kind}, meanwhile=moving.quiet, quiet={})
    gave = replace(gave, subscribes=taker.subscribes, handed_on=["/cmd_vel"] * (kind == TWIST))
    evidence = evidences.right([evidences.status_run(), evidences.command_run(), taker])
    return replace(evidence, runs=[*evidence.runs, gave])


def test_what_is_only_handed_on_is_told() -> None:
    """Its numbers are others', and it comes only in answer."""
    found, told = judged(relay("/cmd_vel_raw")), "each message is one that its node was given"
    assert told in found["velocity_publisher.values"].reason
    assert found["velocity_publisher.repetition"].points == 0
    assert "only in answer" in found["velocity_publisher.repetition"].reason
    assert told not in str([*judged(relay("/odom", "nav_msgs/msg/Odometry")).values()])


def for_want_of_a_sister(
    topic: str, *, is_lost: bool = True, spins: bool = True, given: Run | None = None
) -> Evidence:
    """Return evidence of a velocity that takes what the command subscriber says on a topic, also as it was given that."""
    silent = evidences.velocity_run(values=[])
    taker = replace(silent, subscribes={topic: {silent.nodes[0]: [STRING]}}, waits=[topic])
    evidence = evidences.right([evidences.status_run(), evidences.command_run(), taker])
    ends = [
        WrittenEnd(topic, STRING, True, [], COMMAND),
        WrittenEnd("/cmd_vel", TWIST, True, [0.1], VELOCITY),
    ]
    evidence = evidences.files(ends=ends)(evidence)
    evidence = evidences.without(COMMAND, BATTERY)(evidence) if is_lost else evidence
    assert evidence.build
    programs = [replace(one, never_spins=not spins) for one in evidence.build.executables]
    gave = {"setting": GIVEN, "given": [topic], "gave": {topic: STRING}, "subscribes": taker.subscribes}
    runs = [*evidence.runs, *([replace(given, **gave)] if given else [])]
    return replace(evidence, build=replace(evidence.build, executables=programs), runs=runs)


@pytest.mark.parametrize(
    ("evidence", "expected"),
    [
        (for_want_of_a_sister("/robot/status"), 20),
        (for_want_of_a_sister("/accepted"), 20),
        (for_want_of_a_sister("/robot/command"), 6.5),  # its node plays that part, too
        (for_want_of_a_sister("/accepted", is_lost=False), 9),
        (for_want_of_a_sister("/accepted", spins=False), 9),
        (for_want_of_a_sister("/accepted", given=evidences.velocity_run()), 20),
        (for_want_of_a_sister("/accepted", given=evidences.velocity_run(values=[])), 9),  # its own fault
    ],
)
def test_the_end_of_one_program_is_paid_once(evidence: Evidence, expected: float) -> None:
    """What takes the messages of a program that ended is silent for want of them."""
    assert points(evidence, VELOCITY) == expected


INT32, TELLS = "std_msgs/msg/Int32", "/robot/command takes a std_msgs/Int32: 1 is start, 2 stop, 3 reset."


def by_number(readme: str, does: list[str], topic: str = "/robot/command") -> Evidence:
    """Return evidence of a command subscriber that takes numbers."""
    run = replace(evidences.command_run(kind=INT32, topic=topic, texts=()), commanded="")
    evidence = evidences.right([evidences.status_run(), run, evidences.velocity_run()], readme)
    end = WrittenEnd(topic, INT32, False, [], COMMAND, does=does)
    return evidences.files(ends=[end])(evidence)


@pytest.mark.parametrize(
    ("readme", "does", "expected"),
    [
        (TELLS, ["reads", "compares", "logs"], 4 + 3 + 1 + 1),
        (TELLS, ["reads", "logs"], 4 + 0 + 1 + 1),
        (TELLS, [], 2 + 0 + 0 + 1),
        (evidences.README, ["reads", "compares", "logs"], 4 + 0 + 0 + 1),
    ],
)
def test_documented_commands_of_another_type_count_half(
    readme: str, does: list[str], expected: float
) -> None:
    """They cannot be said here, and the README and the code tell of them."""
    found = by_number(readme, does)
    assert points(found, COMMAND) == expected
    assert "Keep the node spinning" not in str(judged(found))
