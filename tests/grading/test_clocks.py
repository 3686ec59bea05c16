"""A node that waits for a simulated clock is silent wherever nobody brings one, and so it is watched."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import evidences
import pytest

from ros2lab.grading.evidence import Build, CommandSeen, Executable, Files, Heard, Run
from ros2lab.grading.receiving.submission import Submission
from ros2lab.grading.rubric import load
from ros2lab.grading.sandbox.worlds import FILES, World, underlay
from ros2lab.grading.verdict import verdict
from ros2lab.grading.watching.clocks import otherwise
from ros2lab.grading.watching.observe import SHOWN, Observer
from ros2lab.grading.watching.rounds import watch

PROGRAM = """
import rclpy
from rclpy.parameter import Parameter
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("{name}"{given})
publisher = node.create_publisher(String, "/{name}", 10)
node.create_timer(0.5, lambda: publisher.publish(String(data="well")))
{more}
rclpy.spin(node)
"""
SILENT = {
    "overridden": (", parameter_overrides=[Parameter('use_sim_time', value=True)]", ""),
    "set_later": ("", "node.set_parameters([Parameter('use_sim_time', value=True)])"),
}
HEARD = {
    "plain": ("", ""),
    "asks": ("", "node.get_parameter('use_sim_time').value"),
    "refuses": ("", "node.set_parameters([Parameter('use_sim_time', value=False)])"),
}
HIDDEN = {"hidden": (", parameter_overrides=[Parameter('use_' + 'sim_time', value=True)]", "")}
# What tells a program that its clock is stepped: the value, a topic, the words of its command, or two clocks.
KNOWING = {
    "value": "node.get_clock().now().nanoseconds < 10**18",
    "topic": "node.count_publishers('/clo' + 'ck')",
    "words": "len(__import__('sys').argv) > 3",
    "two": "abs(node.get_clock().now().nanoseconds / 1e9 - __import__('time').time()) > 9",
}
TELLING = {
    name: ("", f"(timer,) = node.timers\nnode.create_timer(0.1, lambda: ({known}) or timer.cancel())")
    for name, known in KNOWING.items()
}
TELLING["ticks"] = (
    "",
    "(timer,) = node.timers\nticks = iter(range(60))\nnode.create_timer(0.01, lambda: next(ticks, None) is None and timer.cancel())",
)  # a clock that is stepped lets a quick timer fire once at each step
LAUNCH = f"""
import sys
from launch import LaunchDescription
from launch.actions import ExecuteProcess
def generate_launch_description():
    names = ["hidden", "plain"]
    return LaunchDescription([ExecuteProcess(cmd=[sys.executable, f"{FILES}/{{name}}.py"]) for name in names])
"""


def _watched(folder: Path, programs: dict[str, tuple[str, str]], facts: Files) -> list[Run]:
    """Watch programs, and the launch files that there are."""
    for name, (given, more) in programs.items():
        (folder / f"{name}.py").write_text(PROGRAM.format(name=name, given=given, more=more))
    (folder / "all.launch.py").write_text(LAUNCH)
    found = [
        Executable(name, "", "script", [sys.executable, f"{FILES}/{name}.py"], modules=[name])
        for name in programs
    ]
    built = Build(bool(facts.launch_files), "", [], [], found, [], underlay(), 0.0)
    with World(folder, shown=SHOWN) as world, Observer(world, rooms=3, seconds=math.inf) as observer:
        return watch(observer, Submission("files", None, [], None, [], []), facts, built)


RUN_TOGETHER = pytest.mark.long(together=True)  # all programs of a fixture are watched once


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Run]:
    """Programs that say by themselves which clock they follow, or ask for it; each alone."""
    seen = _watched(tmp_path_factory.mktemp("programs"), SILENT | HEARD, Files())
    return {run.programs[0]: run for run in seen if run.setting == "alone"}


@RUN_TOGETHER
@pytest.mark.parametrize("name", SILENT)
def test_a_node_that_follows_a_clock_of_nobody_is_silent(runs: dict[str, Run], name: str) -> None:
    """As it is with `ros2 run`; the clock that is stepped would bring it to life."""
    run = runs[name]
    assert (run.clock, run.quiet, run.clocked) == ("real", {}, [f"/{name}"])


@RUN_TOGETHER
@pytest.mark.parametrize("name", HEARD)
def test_a_node_that_follows_the_systems_clock_is_heard(runs: dict[str, Run], name: str) -> None:
    """Also if its code names the parameter, or refuses to follow another one."""
    run = runs[name]
    assert (run.clock, run.clocked) == ("real" if name == "refuses" else "stepped", [])
    assert run.quiet[f"/{name}"].count > 2


def test_a_clock_of_which_only_a_launch_file_tells_is_seen(tmp_path: Path) -> None:
    """However the code writes it: what is launched is not told to follow the clock, and one of them does."""
    seen = _watched(tmp_path, HIDDEN | {"plain": HEARD["plain"]}, Files(launch_files=["all.launch.py"]))
    runs = {run.programs[0]: run for run in seen}
    assert runs["all.launch.py"].clocked == ["/hidden"]
    assert not any("/hidden" in run.quiet for run in seen)
    assert (runs["plain"].clock, runs["plain"].quiet["/plain"].count > 2) == ("stepped", True)


@pytest.fixture(scope="module")
def telling(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Run]:
    """Programs that are right only where a clock is stepped, by whatever they know of it; each alone."""
    seen = _watched(tmp_path_factory.mktemp("telling"), TELLING | {"plain": HEARD["plain"]}, Files())
    return {run.programs[0]: run for run in seen if run.setting == "alone"}


@RUN_TOGETHER
@pytest.mark.parametrize("name", TELLING)
def test_a_node_that_is_right_only_on_a_stepped_clock_is_watched_on_the_real_one(
    telling: dict[str, Run], name: str
) -> None:
    """Beside it, a node that does the same on both clocks is watched on the stepped one."""
    heard = telling[name].quiet.get(f"/{name}")
    assert (telling[name].clock, telling["plain"].clock) == ("real", "stepped")
    assert heard is None or heard.count < 2


DRIVEN = evidences.heard(evidences.TWIST, "/velocity_publisher", [evidences.twist(0.5)] * 3, 0.1)
STANDING = evidences.heard(evidences.TWIST, "/velocity_publisher", [evidences.twist(0.0)] * 3, 0.1)


def _status(period: float, *texts: str) -> Run:
    values = [{"data": text} for text in texts or ("well, 1", "well, 2", "well, 3")]
    heard = evidences.heard(evidences.STRING, "/status_publisher", values, period)
    return evidences.replace(evidences.status_run(), quiet={"/robot/status": heard} if period else {})


def _driver(after: Heard) -> Run:
    own = evidences.replace(evidences.velocity_run(), quiet={"/cmd_vel": STANDING})
    return evidences.replace(own, commands=[CommandSeen("start", [], {"/cmd_vel": after}, {}, True)])


def _obeying(*lines: str) -> Run:
    log = [["INFO", line] for line in lines]
    return evidences.replace(evidences.command_run(), commands=[CommandSeen("start", log, {}, {}, True)])


@pytest.mark.parametrize(
    ("stepped", "real", "is_otherwise"),
    [
        (_status(2.0), _status(2.05), False),
        (_status(2.0), _status(2.0, "well, 7", "well, 8"), False),  # nobody waits for the third
        (_status(5.0), _status(0.0), False),  # nobody waits so long
        (_status(0.1), _status(0.11), False),
        (_status(2.0), _status(4.0), True),
        (_status(2.0), _status(1.0), True),
        (_status(2.0), _status(0.0), True),
        (_status(2.0), _status(4.0, "well"), True),
        (_status(2.0), _status(2.0, "no", "nothing", "none"), True),
        (_driver(DRIVEN), _driver(DRIVEN), False),
        (_driver(DRIVEN), _driver(STANDING), True),
        (_driver(STANDING), _driver(DRIVEN), False),
        (_obeying("Received start 1"), _obeying("Received start 5", "Publishing 6"), False),
        (_obeying(), _obeying("Received start"), False),
        (_obeying("Received start"), _obeying("Publishing 6"), True),
        (_obeying("Received start"), _obeying(), True),
    ],
)  # fmt: skip
def test_what_was_seen_on_the_stepped_clock_must_be_seen_on_the_real_one(
    stepped: Run, real: Run, is_otherwise: bool
) -> None:
    real = evidences.replace(real, clock="real", setting="untold")
    assert [*otherwise([stepped], [real])] == (stepped.programs if is_otherwise else [])


def test_what_a_program_says_among_others_is_compared_with_what_it_says_among_them() -> None:
    """What it says alone tells then nothing of it: the driver moves for what another program passes on."""
    alone = evidences.replace(_driver(STANDING), commands=[])
    both = ["command_subscriber", evidences.VELOCITY]
    together = evidences.replace(_driver(DRIVEN), setting="together", programs=both)
    for after, found in ((DRIVEN, []), (STANDING, [evidences.VELOCITY])):
        real = evidences.replace(_driver(after), setting="untold", clock="real", programs=both)
        assert [*otherwise([alone, together], [real])] == found


def test_a_program_that_ends_only_on_the_real_clock_is_otherwise() -> None:
    real = evidences.replace(_status(2.0), clock="real", ended={evidences.STATUS: "Traceback"})
    assert [*otherwise([_status(2.0)], [real])] == [evidences.STATUS]
    assert [*otherwise([evidences.replace(_status(2.0), clock="real")], [real])] == []  # as it was seen to do


def test_that_a_node_waits_for_a_clock_is_noted_once() -> None:
    """For whoever reads why nothing came."""
    right = evidences.right()
    note = "The timers of /status_publisher never fire: use_sim_time is set, and nobody publishes /clock."
    clocked = [evidences.replace(run, clocked=["/status_publisher"]) for run in right.runs]
    assert verdict(evidences.replace(right, runs=clocked), load()).notes.count(note) == 1
