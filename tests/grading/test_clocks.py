"""A node that waits for a simulated clock is silent wherever nobody brings one, and so it is watched."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import evidences
import pytest

from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.grading.build import underlay
from ros2lab.grading.evidence import Build, Executable, Files, Run
from ros2lab.grading.files import _simulated
from ros2lab.grading.observe import SHOWN, Observer
from ros2lab.grading.rubric import load
from ros2lab.grading.sandbox import FILES, World
from ros2lab.grading.submission import Submission
from ros2lab.grading.verdict import verdict
from ros2lab.grading.watching import watch

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


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Run]:
    """Programs that say by themselves which clock they follow, or ask for it; each alone."""
    named = Files(simulated=[*SILENT, "asks", "refuses"])
    seen = _watched(tmp_path_factory.mktemp("programs"), SILENT | HEARD, named)
    return {run.programs[0]: run for run in seen if run.setting == "alone"}


@pytest.mark.parametrize("name", SILENT)
def test_a_node_that_follows_a_clock_of_nobody_is_silent(runs: dict[str, Run], name: str) -> None:
    """As it is with `ros2 run`; the clock that is stepped would bring it to life."""
    run = runs[name]
    assert (run.clock, run.quiet, run.clocked) == ("real", {}, [f"/{name}"])


@pytest.mark.parametrize("name", HEARD)
def test_a_node_that_follows_the_systems_clock_is_heard(runs: dict[str, Run], name: str) -> None:
    """Also if its code names the parameter: whoever asks which clock there is may do something else on one that is stepped."""
    run = runs[name]
    assert (run.clock, run.clocked) == ("stepped" if name == "plain" else "real", [])
    assert run.quiet[f"/{name}"].count > 2


def test_a_clock_of_which_only_a_launch_file_tells_is_seen(tmp_path: Path) -> None:
    """However the code writes it: what is launched is not told to follow the clock, and one of them does."""
    seen = _watched(tmp_path, HIDDEN | {"plain": HEARD["plain"]}, Files(launch_files=["all.launch.py"]))
    runs = {run.programs[0]: run for run in seen}
    assert runs["all.launch.py"].clocked == ["/hidden"]
    assert not any("/hidden" in run.quiet for run in seen)
    assert (runs["plain"].clock, runs["plain"].quiet["/plain"].count > 2) == ("stepped", True)


def test_code_that_names_a_clock_is_found() -> None:
    sources = [PythonSource(f"pkg.{name}", f"{name}.py", text) for name, text in {
        "a": "x = Parameter('use_sim_time', value=True)", "b": "x = 'time'", "c": "if clock.ros_time_is_active: pass"
    }.items()]  # fmt: skip
    assert _simulated(sources) == ["a", "c"]


def test_that_a_node_waits_for_a_clock_is_noted_once() -> None:
    """For whoever reads why nothing came."""
    right = evidences.right()
    note = "The timers of /status_publisher never fire: use_sim_time is set, and nobody publishes /clock."
    clocked = [evidences.replace(run, clocked=["/status_publisher"]) for run in right.runs]
    assert verdict(evidences.replace(right, runs=clocked), load()).notes.count(note) == 1
