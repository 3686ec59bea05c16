"""Quantities that are used as what they are not, and those that are used as what they are."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.units import unit_faults
from ros2lab.diagnose.finding import Finding

NODE = """\
import math
import time
from math import cos, sin
import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist, Quaternion, PoseStamped, Pose2D, Pose
from nav_msgs.msg import Odometry
from sensor_msgs.msg import BatteryState, Joy, NavSatFix, LaserScan, Imu, Range
from std_msgs.msg import ColorRGBA, Float64
from visualization_msgs.msg import Marker

class N(Node):
    def __init__(self):
        super().__init__('n')
        self.goal = math.pi / 2
        self.target_yaw = 1.57
        self.speed = 0.2
        self.last = None
        self.x = 0.0
        self.distance = 0.0
        self.create_subscription(Odometry, 'odom', self.on_odom, 10)
        self.create_subscription(BatteryState, 'bat', self.on_bat, 10)
        self.create_subscription(Joy, 'joy', self.on_joy, 10)
        self.create_subscription(NavSatFix, 'fix', self.on_fix, 10)
        self.create_subscription(LaserScan, 'scan', self.on_scan, 10)
        self.create_subscription(PoseStamped, 'pose', self.on_pose, 10)
    def on_odom(self, msg):
        pass  #ODOM
    def on_bat(self, msg):
        pass  #BAT
    def on_joy(self, msg):
        pass  #JOY
    def on_fix(self, msg):
        pass  #FIX
    def on_scan(self, msg):
        pass  #SCAN
    def on_pose(self, msg):
        pass  #POSE
    def helper(self, q):
        pass  #HELP
    def turn(self, yaw):
        return cos(yaw)
"""


def told(place: str, lines: str, returned: str, folder: Path) -> list[Finding]:
    text = NODE.replace(f"pass  #{place}", lines).replace("pass  #HELP", returned)
    return [*unit_faults(sources_of(text, folder, "node"))]


@pytest.mark.parametrize(
    ("place", "lines", "returned"),
    [
        ('ODOM', 'self.a = msg.pose.pose.orientation.z\n        if self.a > 1.57: pass', 'pass'),
        ('ODOM', 'q = msg.pose.pose.orientation\n        err = self.goal - q.z', 'pass'),
        ('ODOM', 'print(math.degrees(msg.pose.pose.orientation.z))', 'pass'),
        ('ODOM', 'theta = math.asin(msg.pose.pose.orientation.z)', 'pass'),
        ('ODOM', 'self.heading = msg.pose.pose.orientation.w * 180 / math.pi', 'pass'),
        ('ODOM', 'self.turn(msg.pose.pose.orientation.z)', 'pass'),
        ('ODOM', 'o = Odometry(); o.pose.pose.orientation.z = math.pi / 2', 'pass'),
        ('ODOM', 'o = Odometry(); o.pose.pose.orientation.z += 0.1', 'pass'),
        ('ODOM', 'm = Marker(); m.pose.orientation.z = 1.57', 'pass'),
        ('ODOM', 'self.h = self.helper(msg.pose.pose.orientation)\n        if self.h < self.goal: pass', 'return q.z'),
        ('POSE', 't = msg.header.stamp\n        dt = t.sec - self.last.sec\n        self.distance += self.speed * dt', 'pass'),
        ('POSE', 't = msg.header.stamp\n        if t.nanosec * 1e-9 - self.last.nanosec * 1e-9 > 0.5: pass', 'pass'),
        ('POSE', 'a = self.get_clock().now().seconds_nanoseconds()[1]\n        d = (a - self.last_ns) / 1e9\n        self.last_ns = a', 'pass'),
        ('POSE', 'self.x = math.sin(90)', 'pass'),
        ('POSE', 'yaw_deg = 45.0\n        self.x = self.x + math.cos(yaw_deg)', 'pass'),
        ('POSE', 'a = math.degrees(math.atan2(1.0, self.x))\n        if a > math.pi / 2: pass', 'pass'),
        ('POSE', 'a = math.atan2(1.0, self.x)\n        if a > 90: pass', 'pass'),
        ('POSE', 'c = Twist(); c.angular.z = math.degrees(self.x)', 'pass'),
        ('POSE', 'p = Pose2D(); p.theta = 90.0', 'pass'),
        ('SCAN', 's = LaserScan(); s.angle_min = -180.0', 'pass'),
        ('SCAN', 'a = math.radians(msg.angle_min)', 'pass'),
        ('BAT', 'if msg.percentage < 20.0: pass', 'pass'),
        ('BAT', 'b = BatteryState(); b.percentage = 85.0', 'pass'),
        ('BAT', 'print(f"{msg.percentage:.0f} %")', 'pass'),
        ('JOY', 'if msg.axes[1] > 100: pass', 'pass'),
        ('FIX', 'x = math.cos(msg.latitude)', 'pass'),
        ('FIX', 'c = ColorRGBA(r=255.0, g=0.0, b=0.0, a=1.0)', 'pass'),
        ('POSE', 'self.create_timer(0.1, self.x); wait_ms = 500; time.sleep(wait_ms)', 'pass'),
        ('POSE', 'elapsed_ms = (self.get_clock().now() - self.last).nanoseconds / 1e9', 'pass'),
    ],
)  # fmt: skip
def test_what_is_taken_for_another_quantity(tmp_path: Path, place: str, lines: str, returned: str) -> None:
    assert len(told(place, lines, returned, tmp_path)) == 1


@pytest.mark.parametrize(
    ("place", "lines", "returned"),
    [
        ('ODOM', 'yaw = 2 * math.asin(msg.pose.pose.orientation.z)\n        if yaw > self.goal: pass', 'pass'),
        ('ODOM', 'q = msg.pose.pose.orientation\n        yaw = 2 * math.atan2(q.z, q.w)\n        if yaw > self.goal: print(math.degrees(yaw))', 'pass'),
        ('ODOM', 'q = msg.pose.pose.orientation\n        yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y ** 2 + q.z ** 2))\n        err = self.goal - yaw', 'pass'),
        ('ODOM', 'q = msg.pose.pose.orientation\n        n = math.sqrt(q.x**2 + q.y**2 + q.z**2 + q.w**2)\n        q.z /= n\n        p = Pose(); p.orientation.z = q.z', 'pass'),
        ('ODOM', 'if msg.pose.pose.orientation.z > 0.7: pass', 'pass'),
        ('ODOM', 'theta = math.acos(msg.pose.pose.orientation.w)\n        self.x = 2 * theta', 'pass'),
        ('ODOM', 'half_yaw = math.asin(msg.pose.pose.orientation.z)\n        yaw = 2 * half_yaw', 'pass'),
        ('ODOM', 'self.h = self.helper(msg.pose.pose.orientation)\n        if self.h < self.goal: pass', 'return 2 * math.atan2(q.z, q.w)'),
        ('ODOM', 'o = Odometry(); o.pose.pose.orientation.z = math.sin(self.x / 2); o.pose.pose.orientation.w = 1.0', 'pass'),
        ('ODOM', 'c = Twist(); c.angular.z = -0.5 * msg.pose.pose.orientation.z', 'pass'),
        ('ODOM', 'err = self.goal_q.z - msg.pose.pose.orientation.z\n        if abs(err) < 0.01: pass', 'pass'),
        ('ODOM', 'z, w = msg.pose.pose.orientation.z, msg.pose.pose.orientation.w\n        yaw = math.atan2(2*z*w, 1-2*z*z)', 'pass'),
        ('POSE', 't = msg.header.stamp\n        dt = (t.sec - self.last.sec) + (t.nanosec - self.last.nanosec) * 1e-9\n        self.distance += self.speed * dt', 'pass'),
        ('POSE', 'import random; random.seed(msg.header.stamp.nanosec)', 'pass'),
        ('POSE', 'print(msg.header.stamp.nanosec)\n        if msg.header.stamp.nanosec > 500000000: pass', 'pass'),
        ('POSE', 'dt = (msg.header.stamp.nanosec - self.last.nanosec) / 1e9\n        if dt < 0: dt += 1.0', 'pass'),
        ('POSE', 'if msg.header.stamp.sec - self.last.sec > 5: pass', 'pass'),
        ('POSE', 'd_sec = msg.header.stamp.sec - self.last.sec\n        d_n = msg.header.stamp.nanosec - self.last.nanosec\n        self.x = d_sec + d_n / 1e9', 'pass'),
        ('POSE', 'self.x = math.sin(math.radians(90))', 'pass'),
        ('POSE', 'yaw_deg = math.degrees(self.x)\n        if yaw_deg > 90: pass', 'pass'),
        ('POSE', 'a = math.atan2(1.0, self.x)\n        while a > math.pi: a -= 2 * math.pi\n        if a > 2 * math.pi: pass', 'pass'),
        ('POSE', 'c = Twist(); c.angular.z = math.radians(45); c.angular.z = 0.02 * math.degrees(self.x)', 'pass'),
        ('SCAN', 'a = msg.angle_min + 3 * msg.angle_increment\n        self.x = 2.0 * math.cos(a)', 'pass'),
        ('SCAN', 'i = int((math.radians(90) - msg.angle_min) / msg.angle_increment)', 'pass'),
        ('BAT', 'if msg.percentage * 100 < 20.0: pass', 'pass'),
        ('BAT', 'print(f"{msg.percentage * 100:.0f} %")\n        print(f"{msg.percentage:.0%}%")', 'pass'),
        ('BAT', 'if msg.percentage < 0.2: pass', 'pass'),
        ('JOY', 'if msg.axes[1] > 0.5: pass', 'pass'),
        ('FIX', 'x = math.cos(math.radians(msg.latitude))', 'pass'),
        ('FIX', 'c = ColorRGBA(r=255.0 / 255, g=0.0, b=0.0, a=1.0); c.r = 1.0', 'pass'),
        ('POSE', 'if yaw_of(msg) > 90: pass\n        theta = math.radians(90)\n        self.x = cos(theta)', 'pass'),
        ('POSE', 'angle = 30\n        self.x = math.cos(angle * math.pi / 180)\n        b = math.radians(angle)', 'pass'),
        ('POSE', 'roll, pitch, yaw = 1.0, 2.0, 3.0\n        q = Quaternion(z=sin(yaw / 2), w=cos(yaw / 2))', 'pass'),
        ("ODOM", "rotation = math.radians(self.x)\n        self.low = math.cos(rotation)", "pass"),
        ("BAT", "out = BatteryState(); out.percentage = float(len(self.name))\n        if msg.percentage < 20.0: pass", "pass"),
        ("HELP", "q = math.radians(q)", "pass"),
        ("HELP", "pass", "q = math.radians(q)\n    def all(self):\n        self.helper(90.0)"),
        ("POSE", "angle = 90\n        angle = math.radians(angle)\n        c = Twist(); c.angular.z = angle", "pass"),
        ("POSE", "self.a = 90.0\n        self.a = math.radians(self.a)\n        self.low = cos(self.a)", "pass"),
        ("POSE", "self.sec = 5\n        self.x += self.speed * (self.sec - 1)", "pass"),
        ("POSE", "if msg.header.stamp.nanosec != self.last.nanosec: pass", "pass"),
        ("POSE", "a = math.atan2(1.0, 2.0); a += 2 * math.pi * len(self.name)\n        if a > 90: pass", "pass"),
    ],
)  # fmt: skip
def test_what_is_taken_for_what_it_is(tmp_path: Path, place: str, lines: str, returned: str) -> None:
    assert told(place, lines, returned, tmp_path) == []


def test_fields_of_own_classes_are_no_fields_of_messages(tmp_path: Path) -> None:
    own = "\n\nclass Lap:\n    sec: float\n    orientation: Euler\n"
    for line in (
        "self.x += self.speed * (self.two.sec - self.one.sec)",
        "if self.robot.orientation.z > 90.0: pass",
    ):
        text = NODE.replace("pass  #POSE", line)
        folders = [tmp_path / f"{len(line)}{name}" for name in "ab"]
        for folder in folders:
            folder.mkdir()
        assert [*unit_faults(sources_of(text, folders[0], "node"))]
        assert [*unit_faults(sources_of(text + own, folders[1], "node"))] == []


@pytest.mark.parametrize(
    ("place", "lines", "fix"),
    [
        ("POSE", "dt = (msg.header.stamp.nanosec - self.last.nanosec) / 1e9", "write ((msg.header.stamp.sec - self.last.sec) * 1e9 + (msg.header.stamp.nanosec - self.last.nanosec)) instead of"),
        ("POSE", "dt = msg.header.stamp.sec - self.last.sec; self.x += self.speed * dt", "+ (msg.header.stamp.nanosec - self.last.nanosec) / 1e9)"),
        ("POSE", "c = Twist(); c.angular.z = math.degrees(self.x)", "write self.x instead of math.degrees(self.x)"),
        ("SCAN", "a = math.radians(msg.angle_min)", "write msg.angle_min instead of math.radians(msg.angle_min)"),
        ("BAT", "if msg.percentage < 20.0: pass", "write 0.2 instead of 20.0"),
        ("FIX", "c = ColorRGBA(r=51.0, g=0.0, b=0.0, a=1.0)", "write 0.2 instead of 51.0"),
        ("POSE", "self.x = math.sin(90)", "write math.radians(90) instead of 90"),
    ],
)  # fmt: skip
def test_what_to_write_instead(tmp_path: Path, place: str, lines: str, fix: str) -> None:
    (found,) = told(place, lines, "pass", tmp_path)
    assert fix in found.fix
