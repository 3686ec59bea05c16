"""What the code promises of a node, and what of it was there while it ran: managed nodes, and branches."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest
from right_workspace import right_workspace
from test_trial import STRING, build, run_of
from workspace_files import Files

from ros2lab import assignments
from ros2lab.diagnose.look import Look
from ros2lab.grading.evidence import Heard, Run
from ros2lab.trial import try_out
from ros2lab.trial.seen import Seen
from ros2lab.trial.unmade import unmade_faults, unmade_notes

MANAGED = """\
import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String


class StatusPublisher(LifecycleNode):
    def __init__(self):
        super().__init__('status_publisher')
        self.count = 0

    def on_configure(self, state):
        MAKES
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self.timer = self.create_timer(0.5, self.tick)
        return super().on_activate(state)

    def tick(self, msg=None):
        self.pub.publish(String(data='on'))


def main(args=None):
    rclpy.init(args=args)
    node = StatusPublisher()
    BRINGS
    rclpy.spin(node)
"""
PUBLISHES = "self.pub = self.create_lifecycle_publisher(String, 'report', 10)"
BOTH = "node.trigger_configure()\n    node.trigger_activate()"
LAUNCHED = """\
from launch import LaunchDescription
from launch_ros.actions import LifecycleNode
IMPORTS


def generate_launch_description():
    status = LifecycleNode(package='robot_controller', executable='status_publisher', name='status_publisher', namespace=''MORE)
    return LaunchDescription([status, BRINGS])
"""
EMITTED = "EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(status), transition_id=Transition.TRANSITION_{}))"
BY_HAND = "Then type `ros2 lifecycle set /status_publisher configure`, and `... activate`.\n"
NO_TOPICS = replace(run_of("status_publisher", "/x", STRING, None), publishes={})


def managed(makes: str = PUBLISHES, brings: str = "pass") -> Files:
    code = MANAGED.replace("MAKES", makes).replace("BRINGS", brings)
    files = right_workspace().remove("launch/robot.launch.py")
    return files.put("node", code)


def seen_of(root: Path, run: Run, *called: str) -> tuple[Seen, frozenset]:  # type: ignore[type-arg]
    """Return what was seen of a workspace in which these methods were called."""
    look = Look(root)
    sources = [s for package in look.packages for s in look.sources(package).sources.values()]
    (source,) = [s for s in sources if s.name.endswith(".status_publisher")]
    lines = [
        n
        for n, line in enumerate(source.text.splitlines(), 1)
        if (found := re.match(r" *def (\w+)", line)) and found[1] in ("main", "__init__", *called)
    ]
    return Seen(look, assignments.load(), [run], []), frozenset((source, line) for line in lines)


def told(files: Files, root: Path, run: Run = NO_TOPICS, *called: str) -> list[str]:
    seen, functions = seen_of(files.write(root), run, *called)
    return [
        f"{finding.code}: {finding.cause} {finding.place} {finding.fix}"
        for finding in unmade_faults(seen, run, functions)
    ]


@pytest.mark.parametrize(
    ("makes", "made"),
    [
        (PUBLISHES, "so its publisher and its timer are never made"),
        ("self.create_subscription(String, 'in', self.tick, 10)", "so its subscription and its timer are never made"),
        ("self.create_service(Trigger, 'in', self.tick)", "so its service and its timer are never made"),
        ("self.ready = True", "so its timer is never made"),
    ],
)  # fmt: skip
def test_a_managed_node_that_nothing_brings_up_is_told(tmp_path: Path, makes: str, made: str) -> None:
    (found,) = told(managed(makes), tmp_path)
    assert "stays unconfigured: nothing calls on_configure() and on_activate()" in found
    assert made in found
    assert (
        "`node.trigger_configure()` and `node.trigger_activate()` above line 27, `rclpy.spin(node)`" in found
    )


def test_a_node_that_is_only_configured_is_told(tmp_path: Path) -> None:
    run = run_of("status_publisher", "/report", STRING, None)
    (found,) = told(managed(brings="node.trigger_configure()"), tmp_path, run, "on_configure")
    assert "stays inactive: nothing calls on_activate(), so its timer is never made" in found
    assert "write `node.trigger_activate()` above line 27" in found


def test_a_node_without_a_name_gets_one(tmp_path: Path) -> None:
    files = managed()
    files.change("node", "    rclpy.spin(node)", "    rclpy.spin(StatusPublisher())")
    (found,) = told(files.change("node", "    node = StatusPublisher()\n", ""), tmp_path)
    steps = "`node = StatusPublisher()`, `node.trigger_configure()`, `node.trigger_activate()` and `rclpy.spin(node)`"
    assert f"write {steps} instead of line 26" in found


@pytest.mark.parametrize(
    ("brings", "more", "is_told"),
    [
        ("status", "", True),  # launch's LifecycleNode alone brings nothing up
        (EMITTED.format("CONFIGURE"), "", True),
        (f"{EMITTED.format('CONFIGURE')}, {EMITTED.format('ACTIVATE')}", "", False),
        ("status", ", autostart=True", False),
        ("Node(package='nav2_lifecycle_manager', executable='lifecycle_manager')", "", False),
    ],
)
def test_what_a_launch_file_brings_up_is_right(tmp_path: Path, brings: str, more: str, is_told: bool) -> None:
    imports = "from launch_ros.events.lifecycle import ChangeState\nfrom launch_ros.actions import Node"
    text = LAUNCHED.replace("IMPORTS", imports).replace("BRINGS", brings).replace("MORE", more)
    assert bool(told(managed().put("launch/status.launch.py", text), tmp_path)) == is_told


def test_a_program_that_brings_itself_up_is_right(tmp_path: Path) -> None:
    heard = Heard(STRING, "/status_publisher", [0.0, 0.5, 1.0], [{"data": "on"}] * 3, 3)
    run = run_of("status_publisher", "/report", STRING, heard)
    assert told(managed(brings=BOTH), tmp_path, run, "on_configure", "on_activate", "tick") == []


def test_a_node_that_is_brought_up_by_hand_is_only_noted(tmp_path: Path) -> None:
    root = managed().put("README.md", BY_HAND).write(tmp_path)
    seen, called = seen_of(root, NO_TOPICS)
    assert [*unmade_faults(seen, NO_TOPICS, called)] == []
    (note,) = unmade_notes(seen, NO_TOPICS, called)
    assert "waits to be configured" in note


MAKES = "        self.publisher_ = self.create_publisher(String, '/robot/report', 10)\n"
TIMER = "        self.timer = self.create_timer(0.5, self.timer_callback)\n"


@pytest.mark.parametrize(
    ("test", "parameters", "wanted"),
    [
        ("self.get_parameter('talks').value", {"talks": False}, "my_bot status_publisher --ros-args -p talks:=true"),
        ("not self.is_quiet", {"quiet": True}, "-p quiet:=false"),
        ("self.get_parameter('mode').value == 'loud'", {"mode": "mute"}, "-p mode:=loud"),
        ("len(sys.argv) > 5", {}, "write `print(len(sys.argv) > 5)` above line"),
    ],
)  # fmt: skip
def test_what_a_condition_keeps_from_being_made_is_told_with_it(
    tmp_path: Path, test: str, parameters: dict[str, object], wanted: str
) -> None:
    files = right_workspace().change("node", TIMER, "")
    asked = "        self.is_quiet = self.declare_parameter('quiet', True).value\n"
    files.change("node", MAKES, f"{asked}        if {test}:\n    {MAKES}    {TIMER}")
    run = replace(NO_TOPICS, parameters={"/status_publisher": parameters})
    (found,) = told(files, tmp_path, run)
    assert (
        "neither published nor subscribed to anything: its publisher on /robot/report is made only if"
        in found
    )
    assert wanted in found


def test_what_is_switched_off_among_others_is_only_noted(tmp_path: Path) -> None:
    more = "        if self.get_parameter('debug').value:\n            self.more = self.create_publisher(String, 'debug', 10)\n"
    root = right_workspace().change("node", TIMER, TIMER + more).write(tmp_path)
    run = run_of("status_publisher", "/robot/report", STRING, None)
    run = replace(run, parameters={"/status_publisher": {"debug": False}})
    seen, called = seen_of(root, run)
    assert [*unmade_faults(seen, run, called)] == []
    (note,) = unmade_notes(seen, run, called)
    assert note.endswith(
        "is made only if `self.get_parameter('debug').value` is true, and the parameter debug is False"
    )


def test_a_real_managed_node_publishes_after_the_fix(tmp_path: Path) -> None:
    root = managed().only("node").write(tmp_path)
    build(root)
    (found,) = [f for f in try_out(root).findings if f.code == "never-activated"]
    steps = re.findall(r"`(node\.\w+\(\))`", found.fix)
    (path,) = root.glob("src/*/*/status_publisher.py")
    path.write_text(
        path.read_text().replace("    pass\n", f"    {chr(10).join(steps)}\n".replace("\nn", "\n    n"))
    )
    build(root)
    trial = try_out(root)
    assert "never-activated" not in [f.code for f in trial.findings]
    assert any("on /report" in said for said in trial.story)
