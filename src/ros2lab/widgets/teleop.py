"""Drives a robot with keys and pointer, for as long as somebody holds on."""

from __future__ import annotations

import math
import threading
import time
from pathlib import Path
from typing import Any

import anywidget
import traitlets
from geometry_msgs.msg import Twist
from matplotlib.figure import Figure
from rclpy.duration import Duration
from rclpy.qos import QoSProfile

from ros2lab.session import LabSession
from ros2lab.topics import one_type_a_topic, type_name
from ros2lab.widgets.redraw import Redraw, redraw_of
from ros2lab.widgets.stored_view import (
    StoredView,
    check_number,
    check_session,
    resolved,
    style_sheet,
    text_figure,
)

RATE = 10.0  # Hz at which is published while somebody holds on
WATCH_RATE = 20.0  # Hz at which is looked whether somebody still does
MOST_SILENCE = 0.4  # s without a heartbeat; with the watch it is never more than 0.45 s until the robot stops
MOST_HESITATION = 2.0  # s from the beginning of a hold to its first velocity, while nothing moves yet
LOOK_RATE = 2.0  # Hz
ACKNOWLEDGE_TIMEOUT = 0.5  # s, for the last zero
FASTEST_LINEAR = 10.0  # m/s
FASTEST_ANGULAR = 20.0  # rad/s
THREAD_NAME = "ros2lab-teleop"


class Teleop(StoredView, anywidget.AnyWidget):
    """Drives a robot: arrow keys or WASD while the widget has the focus, or the pointer on its round pad.

    It has a dead-man switch. A `geometry_msgs/Twist` is published at 10 Hz only while a key or the pointer is
    held. A zero follows at once when it is let go, when the focus or the page goes, and within half a second
    when the browser is not heard from any more; then nothing, so that others may drive.

    Args:
        session: where is published; closing it stops the robot and closes the widget.
        topic: the topic's name.
        linear_speed: forwards and backwards at the most, 0 to 10 m/s.
        angular_speed: turning at the most, 0 to 20 rad/s.

    Attributes:
        linear: linear x that was published last, in m/s; 0 while nothing is held.
        angular: angular z that was published last, in rad/s; 0 while nothing is held.
        listeners: how many nodes listen to the topic.

    Raises:
        TypeError: if an argument is of another kind.
        ValueError: if a number is out of its range, the topic's name is none, or a node of this kernel uses the
            topic with another type.
        RuntimeError: if the session is closed.
    """

    _esm = Path(__file__).with_name("teleop.js")
    _css = style_sheet("teleop")

    topic = traitlets.Unicode("/cmd_vel", read_only=True).tag(sync=True)
    linear_speed = traitlets.Float(0.5, read_only=True).tag(sync=True)
    angular_speed = traitlets.Float(1.0, read_only=True).tag(sync=True)
    linear = traitlets.Float(0.0, read_only=True).tag(sync=True)
    angular = traitlets.Float(0.0, read_only=True).tag(sync=True)
    listeners = traitlets.Int(0, read_only=True).tag(sync=True)

    def __init__(
        self,
        session: LabSession,
        *,
        topic: str = "/cmd_vel",
        linear_speed: float = 0.5,
        angular_speed: float = 1.0,
    ) -> None:
        check_session(session, "Teleop")
        topic = resolved(session, topic)
        linear_speed = check_number("The linear speed", linear_speed, 0.0, FASTEST_LINEAR, "m/s")
        angular_speed = check_number("The angular speed", angular_speed, 0.0, FASTEST_ANGULAR, "rad/s")
        self._redraw = redraw_of(session)
        self._node = session.node
        # Not transient-local: a robot that starts later must not get an old velocity.
        with one_type_a_topic(self._node, topic, type_name(Twist)):
            self._publisher = self._node.create_publisher(Twist, topic, QoSProfile(depth=10))
        self._holding = threading.RLock()
        self._hold: str | None = None  # the browser's name of what is held now
        self._heard = -math.inf
        self._wanted: tuple[float, float] | None = None  # None until the browser has said it
        self._is_driving = False  # whether a zero is owed
        self.set_trait("topic", topic)
        self.set_trait("linear_speed", linear_speed)
        self.set_trait("angular_speed", angular_speed)
        super().__init__()
        self.on_msg(self._on_message)
        # A thread of its own: a dead-man switch does not wait until another widget has drawn.
        self._clock = Redraw(THREAD_NAME)
        self._open_in(session, topic)
        self._look_around()
        self._redraw.add(self._look_around, LOOK_RATE)
        self._clock.add(self._watch, WATCH_RATE)
        self._clock.add(self._drive, RATE)

    @property
    def is_held(self) -> bool:
        """Whether a key or the pointer is held, and Twists are published."""
        return self._is_driving

    def stop(self) -> None:
        """Publish zero if the robot is being driven; to go on, keys and pointer must be let go first."""
        with self._holding:
            self._end_hold("stopped by the notebook")

    def still(self) -> Figure:
        """Draw the velocities with matplotlib."""
        lines = [f"linear x   {_fixed(self.linear)} m/s", f"angular z  {_fixed(self.angular)} rad/s"]
        return text_figure(f"Drive {self.topic}", lines)

    @property
    def description(self) -> str:
        """What is to be seen now, in words."""
        state = "driving" if self.is_held else "nothing is held"
        return (
            f"Keys and pad that drive {self.topic}, {state}: "
            f"linear x {_fixed(self.linear)} m/s, angular z {_fixed(self.angular)} rad/s."
        )

    # The browser asks for a hold when a key goes down, and drives once it was granted. Velocities that waited while
    # the kernel was busy belong to a hold that has ended meanwhile, and are ignored: nothing moves late.

    def _on_message(self, _: object, content: Any, __: object) -> None:
        hold = content.get("hold")
        with self._holding:
            if self.is_closed or not isinstance(hold, str):
                return
            if content.get("do") == "begin":
                self._begin_hold(hold)
            elif hold == self._hold and content.get("do") == "end":
                self._end_hold("")
            elif hold == self._hold and content.get("do") == "drive":
                self._heard = time.monotonic()
                self._want(content.get("linear"), content.get("angular"))

    def _begin_hold(self, hold: str) -> None:
        self._end_hold("another page or key drives now")
        self._hold, self._heard, self._wanted = hold, time.monotonic(), None
        self.send({"hold": hold, "is_granted": True})

    def _want(self, linear: object, angular: object) -> None:
        """Take over what is wanted, as fractions of the greatest speeds; the first is published at once."""
        if not (isinstance(linear, int | float) and isinstance(angular, int | float)):
            return
        self._wanted = _fraction(linear) * self.linear_speed, _fraction(angular) * self.angular_speed
        if not self._is_driving:
            self._is_driving = True
            self._publish(*self._wanted)

    def _drive(self) -> None:
        with self._holding:
            if self._is_driving and self._wanted is not None:
                self._publish(*self._wanted)

    def _watch(self) -> None:
        with self._holding:
            most = MOST_SILENCE if self._is_driving else MOST_HESITATION
            if self._hold is not None and time.monotonic() - self._heard > most:
                self._end_hold("the kernel did not hear from the browser in time")

    def _end_hold(self, reason: str) -> None:
        """Stop the robot if it was driven, and tell the browser why, unless it knows."""
        hold, self._hold, self._wanted = self._hold, None, None
        if self._is_driving:
            self._is_driving = False
            self._publish(0.0, 0.0)
        if hold is not None and reason:
            self.send({"hold": hold, "is_granted": False, "reason": reason})

    def _publish(self, linear: float, angular: float) -> None:
        message: Any = Twist()
        message.linear.x, message.angular.z = linear, angular
        self._publisher.publish(message)
        self.set_trait("linear", linear)
        self.set_trait("angular", angular)

    def _look_around(self) -> None:
        self.set_trait("listeners", self.session.subscribers(self.topic))

    def _stop(self) -> None:
        with self._holding:
            was_driving = self._is_driving
            self._end_hold("the widget was closed")
        self._clock.close()
        self._redraw.remove(self._look_around)
        if was_driving:
            self._publisher.wait_for_all_acked(Duration(seconds=ACKNOWLEDGE_TIMEOUT))
        self._node.destroy_publisher(self._publisher)

    def __repr__(self) -> str:
        return f"Teleop({self.topic})"


def _fraction(value: float) -> float:
    return min(1.0, max(-1.0, float(value))) if math.isfinite(value) else 0.0


def _fixed(value: float) -> str:
    return f"{value + 0.0:.2f}"  # no "-0.00"
