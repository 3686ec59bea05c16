"""The robots of the clinic in lesson 9: a healthy one, and what is changed in each that is ill."""

from __future__ import annotations

from typing import NamedTuple

HEALTHY = "patrol"
# The files of a healthy package, with its name.
ROBOT = {
    "package.xml": """\
<?xml version="1.0"?>
<package format="3">
  <name>patrol</name>
  <version>0.1.0</version>
  <description>Drives a little, and watches whether it does.</description>
  <maintainer email="ada@example.org">Ada Lovelace</maintainer>
  <license>MIT</license>
  <depend>rclpy</depend>
  <depend>geometry_msgs</depend>
  <exec_depend>launch_ros</exec_depend>
  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
""",
    "setup.cfg": """\
[develop]
script_dir=$base/lib/patrol
[install]
install_scripts=$base/lib/patrol
""",
    "setup.py": """\
from glob import glob

from setuptools import find_packages, setup

setup(
    name="patrol",
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/patrol"]),
        ("share/patrol", ["package.xml"]),
        ("share/patrol/launch", glob("launch/*")),
        ("share/patrol/config", glob("config/*")),
    ],
    entry_points={"console_scripts": [
        "driver = patrol.driver:main",
        "watcher = patrol.watcher:main",
    ]},
)
""",
    "resource/patrol": "",
    "patrol/__init__.py": "",
    "patrol/driver.py": """\
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.speed = self.declare_parameter("speed", 0.5).value
        self.times = self.declare_parameter("times", 2).value
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.timer = self.create_timer(0.1, self.drive)

    def drive(self):
        twist = Twist()
        twist.linear.x = self.speed
        self.publisher.publish(twist)
        self.get_logger().info(f"I drive at {twist.linear.x:.1f} m/s.")
        self.times -= 1
        if self.times == 0:
            raise SystemExit


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Driver())
""",
    "patrol/watcher.py": """\
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Watcher(Node):
    def __init__(self):
        super().__init__("watcher")
        self.subscription = self.create_subscription(Twist, "cmd_vel", self.see, 10)
        self.get_logger().info("I watch.")

    def see(self, twist):
        self.get_logger().info(f"I see {twist.linear.x:.1f} m/s.")
        raise SystemExit


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Watcher())
""",
    "launch/patrol.launch.py": """\
from launch import LaunchDescription
from launch.substitutions import PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    config = PathJoinSubstitution([FindPackageShare("patrol"), "config", "speed.yaml"])
    driver = Node(package="patrol", executable="driver", parameters=[config], output="screen")
    return LaunchDescription([driver])
""",
    "config/speed.yaml": """\
driver:
  ros__parameters:
    speed: 0.8
""",
}


class Change(NamedTuple):
    """What is changed in a healthy package: in a file, one text for another; an empty `old` removes the file."""

    file: str
    old: str = ""
    new: str = ""


# What is wrong with the robots of the exercises, and how the two that look alike differ.
ILL = {
    "lark": (Change("lark/driver.py", "0.1, self.drive", "0.1.self.drive"),),
    "tern": (Change("tern/driver.py", "publish(twist)", "publish(self.speed)"),),
}
PATIENTS = {
    "owl": (Change("setup.py", "from glob import glob\n\n"), Change("resource/owl")),
    "kite": (
        Change("setup.py", "kite.driver:main", "kite.driver:mian"),
        Change("kite/driver.py", "self.drive)", "self.drive())"),
    ),
    "crow": (
        Change("setup.py", '        ("share/crow/launch", glob("launch/*")),\n'),
        Change("config/speed.yaml", "driver:", "drive:"),
        # It drives for long enough to be met.
        Change("crow/driver.py", '"times", 2', '"times", 30'),
    ),
    "magpie": (
        Change("magpie/driver.py", '__init__("driver")', '__init__("magpie")'),
        Change("config/speed.yaml", "driver:", "magpie:"),
    ),
    "jackdaw": (
        Change("jackdaw/driver.py", '__init__("driver")', '__init__("jackdaw")'),
        Change("config/speed.yaml", "driver:", "jackdaw:"),
        Change("jackdaw/driver.py", '"cmd_vel", 10', '"cmd_vel", qos_profile_sensor_data'),
        Change(
            "jackdaw/driver.py",
            "import Node\n",
            "import Node\nfrom rclpy.qos import qos_profile_sensor_data\n",
        ),
    ),
}
