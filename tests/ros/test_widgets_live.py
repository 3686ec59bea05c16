"""The widgets at a real session, with real nodes."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import pytest
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from deadlines import DEADLINE
from ros2lab.session import LabSession
from ros2lab.widgets import CommandPanel, NodeLog, TwistPlot
from ros2lab.widgets.redraw import THREAD_NAME, redraw_of

KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
NOT_KEPT = QoSProfile(depth=1)


class Robot(Node):
    """Answers each command with a state of the same name."""

    state_qos = KEPT

    def __init__(self) -> None:
        super().__init__("robot")
        self._states = self.create_publisher(String, "/robot/state", self.state_qos)
        self.create_subscription(String, "/robot/command", self._on_command, 10)
        self._states.publish(String(data="idle"))

    def _on_command(self, message: String) -> None:
        self.get_logger().info(f"got {message.data}")
        self._states.publish(String(data=f"did {message.data}"))
        if message.data == "fail":
            raise ValueError("cannot do that")


class ForgetfulRobot(Robot):
    """Publishes its state as a beginner does: who comes late does not hear it."""

    state_qos = NOT_KEPT


def eventually(widget: Any, name: str, is_right: Callable[[Any], bool]) -> None:
    """Wait until a widget's trait is right."""
    is_there = threading.Event()

    def check(_: object = None) -> None:
        if is_right(getattr(widget, name)):
            is_there.set()

    widget.observe(check, name)
    check()
    assert is_there.wait(DEADLINE), f"{name} is {getattr(widget, name)!r}"
    widget.unobserve(check, name)


def test_the_panel_follows_the_robot_as_it_comes_answers_and_goes(session: LabSession) -> None:
    panel = CommandPanel(session)
    start = panel._buttons[0]
    assert start.disabled
    assert "Nobody listens on /robot/command" in panel._note.value
    session.run(Robot)
    eventually(start, "disabled", lambda is_disabled: not is_disabled)
    eventually(panel, "state", lambda state: state == "idle")
    start.click()
    eventually(panel, "state", lambda state: state == "did start")
    eventually(panel._answer, "value", lambda value: "did start" in value)
    session.stop("robot")
    eventually(start, "disabled", bool)
    eventually(panel, "state", lambda state: state is None)


def test_the_panel_learns_the_state_of_a_robot_that_was_there_before(session: LabSession) -> None:
    session.run(Robot)
    session.wait_for_subscribers("/robot/command")
    panel = CommandPanel(session)
    eventually(panel, "state", lambda state: state == "idle")


def test_the_panel_hears_a_robot_that_keeps_nothing_and_nobody_is_warned(session: LabSession) -> None:
    log = NodeLog(session)
    session.run(ForgetfulRobot)
    panel = CommandPanel(session)
    is_heard = threading.Event()
    panel.observe(lambda _: is_heard.set(), "state")
    deadline = time.monotonic() + DEADLINE
    # What such a robot says before it has met the panel is lost, so it is told more than once.
    while not is_heard.wait(0.05):
        assert time.monotonic() < deadline
        panel.send_command("start")
    assert panel.state == "did start"
    eventually(log._table, "value", lambda table: "got start" in table)
    assert [line for line in log.lines if line.level > 20] == []


@pytest.mark.parametrize("reliability", [ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.RELIABLE])
@pytest.mark.parametrize("durability", [DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL])
def test_the_plot_hears_publishers_of_every_quality_of_service(
    session: LabSession, reliability: ReliabilityPolicy, durability: DurabilityPolicy
) -> None:
    plot = TwistPlot(session)
    qos = QoSProfile(depth=10, reliability=reliability, durability=durability)

    class Driver(Node):
        def __init__(self) -> None:
            super().__init__("driver")
            self._publisher = self.create_publisher(Twist, "/cmd_vel", qos)
            self.create_timer(0.01, self._drive)

        def _drive(self) -> None:
            message = Twist()
            message.linear.x = 0.5
            self._publisher.publish(message)

    session.run(Driver)
    plot.topic_log.wait_for(5, DEADLINE)
    assert plot.topic_log.latest.message.linear.x == 0.5


def test_a_log_of_the_notebook_leaves_the_plot_its_own(session: LabSession) -> None:
    plot = TwistPlot(session)
    log = session.log("/cmd_vel", Twist)
    session.publish("/cmd_vel", Twist())
    log.wait_for(1, DEADLINE)
    plot.topic_log.wait_for(1, DEADLINE)


def test_new_samples_reach_the_browser_by_themselves(
    session: LabSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    plot = TwistPlot(session)
    is_sent = threading.Event()
    monkeypatch.setattr(plot, "send", lambda *_, **__: is_sent.set())
    session.publish("/cmd_vel", Twist())
    assert is_sent.wait(DEADLINE)


def test_the_log_shows_what_was_said_before_it_came_and_what_is_said_now(session: LabSession) -> None:
    session.run(Robot)
    session.publish("/robot/command", "early")
    session.log("/robot/state", String).wait_until(lambda state: state.data == "did early", DEADLINE)
    log = NodeLog(session)
    eventually(log._table, "value", lambda table: "got early" in table)
    session.publish("/robot/command", "late")
    eventually(log._table, "value", lambda table: "got late" in table)
    early, late = (line for line in log.lines if line.message.startswith("got"))
    assert (early.level_name, early.node, early.message) == ("INFO", "robot", "got early")
    assert early.time < late.time


def test_the_log_shows_a_callbacks_exception_with_its_traceback(session: LabSession) -> None:
    log = NodeLog(session, level="ERROR")
    session.run(Robot)
    session.publish("/robot/command", "fail")
    eventually(log._table, "value", lambda table: "cannot do that" in table)
    (line,) = log.lines
    assert line.node == "robot"
    assert 'raise ValueError("cannot do that")' in line.detail


def test_making_a_widget_again_doubles_no_subscription_and_no_thread(session: LabSession) -> None:
    def make() -> int:
        CommandPanel(session)
        TwistPlot(session)
        NodeLog(session)
        return len(list(session.node.subscriptions))

    first = make()
    assert [make() for _ in range(5)] == [first] * 5
    assert [thread.name for thread in threading.enumerate()].count(THREAD_NAME) == 1


def test_closing_the_session_closes_widgets_that_are_busy(session: LabSession) -> None:
    session.run(Robot)
    widgets = [CommandPanel(session), TwistPlot(session), NodeLog(session)]
    redraw = redraw_of(session)
    eventually(widgets[0], "state", lambda state: state == "idle")
    session.close()
    assert all(widget.is_closed for widget in widgets)
    assert redraw.is_closed
    assert redraw.errors == ()
    assert THREAD_NAME not in [thread.name for thread in threading.enumerate()]
