"""What the robot view sends to the browser, and what it says, at a session without ROS."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Twist
from stand_in_session import StandInSession

from ros2lab.widgets import RobotView, robot_view


@pytest.fixture
def session() -> Iterator[StandInSession]:
    session = StandInSession()
    yield session
    session.close()


class Browser:
    """Keeps what it is sent, as `robot_view.js` does."""

    def __init__(self, view: RobotView, monkeypatch: pytest.MonkeyPatch) -> None:
        self.robots = len(view.names)
        self.trails: list[list[tuple[float, float]]] = [[] for _ in range(self.robots)]
        self.ahead: list[list[tuple[float, float]]] = [[] for _ in range(self.robots)]
        self.states = np.zeros((self.robots, 5))
        self.messages: list[dict[str, Any]] = []
        monkeypatch.setattr(view, "send", self.receive)

    def receive(self, message: dict[str, Any], buffers: list[bytes]) -> None:
        self.messages.append(message)
        numbers = np.frombuffer(buffers[0])
        self.states = numbers[: 5 * self.robots].reshape(-1, 5)
        pairs = iter(numbers[5 * self.robots :].reshape(-1, 2).tolist())
        for trail, count in zip(self.trails, message["vertices"], strict=True):
            if message["is_whole"]:
                trail.clear()
            trail += [tuple(next(pairs)) for _ in range(count)]
        self.ahead = [[tuple(next(pairs)) for _ in range(count)] for count in message["ahead"]]
        assert next(pairs, None) is None


class Clock:
    """The time that the view and its logs see; the redraw thread has the real one."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = time.monotonic()
        monkeypatch.setattr(time, "monotonic", lambda: self.now)


def twist(linear: float, angular: float = 0.0, sideways: float = 0.0) -> Twist:
    message = Twist()
    message.linear.x, message.angular.z, message.linear.y = linear, angular, sideways
    return message


def drive(session: StandInSession, view: RobotView, clock: Clock, message: Twist, seconds: float) -> None:
    """Send a command ten times a second, and let the view look twenty times."""
    topic = view.topic_logs[0].topic
    for number in range(round(20 * seconds)):
        if number % 2 == 0:
            session.node.receive(topic, message)
        clock.now += 0.05
        view._draw()


@pytest.fixture
def still(session: StandInSession, monkeypatch: pytest.MonkeyPatch) -> tuple[RobotView, Browser, Clock]:
    """A view that looks only when it is told to, its browser, and its clock."""
    monkeypatch.setattr(robot_view, "RATE", 1e-3)
    view = RobotView(session)
    view._redraw.remove(view._draw)
    return view, Browser(view, monkeypatch), Clock(monkeypatch)


def test_the_robot_drives_on_the_circle_that_it_is_told(
    session: StandInSession, still: tuple[RobotView, Browser, Clock]
) -> None:
    view, browser, clock = still
    drive(session, view, clock, twist(0.5, 0.2), 5 * math.pi)
    assert view.pose.x == pytest.approx(0, abs=0.03)
    assert view.pose.y == pytest.approx(5, abs=0.03)
    assert browser.states[0] == pytest.approx([*view.pose, 0.5, 0.2])
    x, y = np.array(browser.trails[0]).T
    np.testing.assert_allclose(np.hypot(x, y - 2.5), 2.5, atol=0.03)
    assert "on a circle of radius 2.50 m" in view.description


def test_a_command_that_is_stored_after_a_look_counts_from_when_it_came(
    session: StandInSession, still: tuple[RobotView, Browser, Clock]
) -> None:
    view, browser, clock = still
    drive(session, view, clock, twist(0.5, 1.0), 1.0)
    looked = clock.now + 0.05
    clock.now = looked
    view._draw()
    clock.now = looked - 0.03  # it came then, and the thread that stores it had to wait
    session.node.receive("/cmd_vel", twist(0.0))
    clock.now = looked + 0.05
    view._draw()
    assert view.pose.heading == pytest.approx(1.02)
    assert browser.ahead == [[]]
    x, y = np.array(browser.trails[0]).T
    np.testing.assert_allclose(np.hypot(x, y - 0.5), 0.5)
    assert browser.trails[0][-1] == pytest.approx(view.pose[:2]), "nothing is left of what was driven too far"


def test_nothing_is_sent_while_nothing_changes(
    session: StandInSession, still: tuple[RobotView, Browser, Clock]
) -> None:
    view, browser, clock = still
    drive(session, view, clock, twist(0.0), 1.0)
    sent = len(browser.messages)
    drive(session, view, clock, twist(0.0), 5.0)
    assert len(browser.messages) == sent
    assert browser.messages[-1]["are_heard"] == [True]


def test_a_page_that_is_loaded_gets_the_whole_trail(
    session: StandInSession, still: tuple[RobotView, Browser, Clock], monkeypatch: pytest.MonkeyPatch
) -> None:
    view, browser, clock = still
    drive(session, view, clock, twist(0.5, 0.5), 3.0)
    later = Browser(view, monkeypatch)
    view._handle_custom_msg({"ask": "trail"}, [])
    assert later.trails == browser.trails
    assert len(later.trails[0]) > 5


def test_reset_puts_the_robot_back_and_forgets_its_trail(
    session: StandInSession, still: tuple[RobotView, Browser, Clock]
) -> None:
    view, browser, clock = still
    drive(session, view, clock, twist(0.5), 2.0)
    view._handle_custom_msg({"ask": "reset"}, [])
    assert view.pose == (0, 0, 0)
    assert browser.trails == [[(0, 0)]]
    drive(session, view, clock, twist(0.5), 1.0)
    assert view.pose.x == pytest.approx(0.5), "it drives on"


@pytest.mark.parametrize(
    ("message", "says"),
    [
        (twist(0.5, sideways=0.3), "linear y: a robot on two wheels cannot do that"),
        (twist(math.nan), "not a finite number"),
        (twist(0.5, 0.1), ""),
    ],
)
def test_what_wheels_cannot_do_is_told(
    session: StandInSession, still: tuple[RobotView, Browser, Clock], message: Twist, says: str
) -> None:
    view, browser, clock = still
    drive(session, view, clock, message, 0.5)
    assert says in browser.messages[-1]["notes"][0]
    assert bool(says) == bool(browser.messages[-1]["notes"][0])
    assert view.pose.y == pytest.approx(0, abs=0.1)


def test_several_robots_begin_apart_and_are_named_by_their_namespace(session: StandInSession) -> None:
    view = RobotView(session, topic=["/robin/cmd_vel", "/wren/cmd_vel"])
    assert view.names == ["robin", "wren"]
    assert view.starts == [[0, 0, 0], [0, -1, 0]]
    assert repr(view) == "RobotView(/robin/cmd_vel, /wren/cmd_vel)"
    assert "robin" in view.description
    assert "wren" in view.description


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        ({"topic": 3}, TypeError, "A topic is a text"),
        ({"topic": []}, ValueError, "1 to 4 robots"),
        (
            {"topic": ["/a", "/b", "/c", "/d", "/e"]},
            ValueError,
            "1 to 4 robots, each with a topic of its own, not 5",
        ),
        ({"topic": ["/a", "/a"]}, ValueError, "Each robot needs a topic of its own"),
        ({"start": (1, 2)}, TypeError, "The start is (x, y, heading)"),
        ({"start": "here"}, TypeError, "The start is (x, y, heading)"),
        ({"start": (1, 2, "north")}, TypeError, "The heading is a number in rad"),
        ({"start": (1e9, 2, 0)}, ValueError, "x must be from -1000 to 1000 m"),
        ({"topic": ["/a", "/b"], "start": (1, 2, 3)}, TypeError, "once for each robot"),
    ],
)
def test_bad_arguments_are_refused_with_one_sentence(
    session: StandInSession, arguments: dict[str, Any], error: type[Exception], says: str
) -> None:
    with pytest.raises(error) as caught:
        RobotView(session, **arguments)
    assert says in str(caught.value)
