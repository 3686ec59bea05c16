"""A small right workspace as texts, which a test can break and write to a disk."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Names:
    """What the names are in one variation."""

    package: str = "robot_controller"
    module: str = "status_publisher"
    listener: str = "command_subscriber"
    driver: str = "velocity_publisher"
    class_name: str = "StatusPublisher"
    callback: str = "timer_callback"
    publisher: str = "publisher_"
    topic: str = "/robot/status"


NAMES = (
    Names(),
    Names("my_bot", "talker", "ears", "wheels", "Talker", "tick", "pub", "robot/status"),
    Names(
        "team7_robot",
        "state_node",
        "cmd_node",
        "drive_node",
        "StateNode",
        "on_timer",
        "_status_out",
        "/robot/status",
    ),
)

NODE = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class CLASS(Node):
    def __init__(self):
        super().__init__('MODULE')
        self.declare_parameter('period', 2.0)
        self.PUBLISHER = self.create_publisher(String, 'TOPIC', 10)
        self.timer = self.create_timer(self.get_parameter('period').value, self.CALLBACK)
        self.count = 0

    def CALLBACK(self):
        msg = String()
        msg.data = f'running {self.count}'
        self.PUBLISHER.publish(msg)
        self.get_logger().info(msg.data)
        self.count += 1


def main(args=None):
    rclpy.init(args=args)
    node = CLASS()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
"""

LISTENER = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):
    def __init__(self):
        super().__init__('LISTENER')
        self.subscription = self.create_subscription(String, '/robot/command', self.on_command, 10)

    def on_command(self, msg):
        self.get_logger().info('Received: "%s"' % msg.data)


def main(args=None):
    rclpy.init(args=args)
    node = Listener()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()
"""

DRIVER = """\
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Driver(Node):
    def __init__(self):
        super().__init__('DRIVER')
        self.speed = 0.5
        self.publisher_ = self.create_publisher(Twist, '/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.drive)

    def drive(self):
        msg = Twist()
        msg.linear.x = 1.0
        msg.angular.z = 0.2
        self.publisher_.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    node = Driver()
    rclpy.spin(node)
    rclpy.shutdown()
"""

SETUP = """\
import os
from glob import glob
from setuptools import find_packages, setup

package_name = 'PACKAGE'

setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        (os.path.join('share', package_name, 'launch'), glob('launch/*.launch.py')),
        (os.path.join('share', package_name, 'config'), glob('config/*.yaml')),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer='anna',
    maintainer_email='anna@example.org',
    description='Three nodes',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'MODULE = PACKAGE.MODULE:main',
            'LISTENER = PACKAGE.LISTENER:main',
            'DRIVER = PACKAGE.DRIVER:main',
        ],
    },
)
"""

CFG = "[develop]\nscript_dir=$base/lib/PACKAGE\n[install]\ninstall_scripts=$base/lib/PACKAGE\n"

MANIFEST = """\
<?xml version="1.0"?>
<package format="3">
  <name>PACKAGE</name>
  <version>0.1.0</version>
  <description>Three nodes</description>
  <maintainer email="anna@example.org">anna</maintainer>
  <license>Apache-2.0</license>
  <depend>rclpy</depend>
  <depend>std_msgs</depend>
  <depend>geometry_msgs</depend>
  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
"""

LAUNCH = """\
import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    config = os.path.join(get_package_share_directory('PACKAGE'), 'config', 'robot.yaml')
    return LaunchDescription([
        Node(package='PACKAGE', executable='MODULE', parameters=[config]),
        Node(package='PACKAGE', executable='LISTENER'),
        Node(package='PACKAGE', executable='DRIVER'),
    ])
"""

LAUNCH_YAML = """\
launch:
  - arg:
      name: robot
      default: anna
  - node:
      pkg: PACKAGE
      exec: MODULE
      param:
        - from: $(find-pkg-share PACKAGE)/config/robot.yaml
  - group:
      - push_ros_namespace:
          namespace: $(var robot)
      - node:
          pkg: PACKAGE
          exec: LISTENER
      - node:
          pkg: PACKAGE
          exec: DRIVER
          remap:
            - from: /cmd_vel
              to: wheels
"""

LAUNCH_XML = """\
<?xml version="1.0"?>
<launch>
  <arg name="robot" default="anna"/>
  <node pkg="PACKAGE" exec="MODULE">
    <param from="$(find-pkg-share PACKAGE)/config/robot.yaml"/>
  </node>
  <group>
    <push_ros_namespace namespace="$(var robot)"/>
    <node pkg="PACKAGE" exec="LISTENER"/>
    <node pkg="PACKAGE" exec="DRIVER">
      <remap from="/cmd_vel" to="wheels"/>
    </node>
  </group>
</launch>
"""

YAML = "MODULE:\n  ros__parameters:\n    period: 2.0\n"


@dataclass
class Files:
    """The files of a workspace, by their paths below it."""

    names: Names
    texts: dict[str, str] = field(default_factory=dict)

    @classmethod
    def right(cls, names: Names) -> Files:
        """Return a workspace in which nothing is wrong."""
        files = cls(names)
        inner = names.package
        for path, text in {
            "package.xml": MANIFEST,
            "setup.py": SETUP,
            "setup.cfg": CFG,
            f"resource/{inner}": "",
            f"{inner}/__init__.py": "",
            f"{inner}/{names.module}.py": NODE,
            f"{inner}/{names.listener}.py": LISTENER,
            f"{inner}/{names.driver}.py": DRIVER,
            "launch/robot.launch.py": LAUNCH,
            "config/robot.yaml": YAML,
        }.items():
            files.texts[files.path(path)] = files.filled(text)
        return files

    def path(self, name: str) -> str:
        """Return where a file of the package lies; `node`, `listener` and `driver` stand for the modules."""
        inner = {"node": self.names.module, "listener": self.names.listener, "driver": self.names.driver}
        if name in inner:
            name = f"{self.names.package}/{inner[name]}.py"
        return f"src/{self.names.package}/{self.filled(name)}"

    def filled(self, text: str) -> str:
        """Put the names into a text."""
        names = self.names
        for word, name in (
            ("PACKAGE", names.package), ("MODULE", names.module), ("LISTENER", names.listener),
            ("DRIVER", names.driver), ("CLASS", names.class_name), ("CALLBACK", names.callback),
            ("PUBLISHER", names.publisher), ("TOPIC", names.topic),
        ):  # fmt: skip
            text = text.replace(word, name)
        return text

    def change(self, name: str, old: str, new: str) -> Files:
        """Replace what a file says; what is replaced must be there."""
        old, new, path = self.filled(old), self.filled(new), self.path(name)
        assert old in self.texts[path], (old, path)
        self.texts[path] = self.texts[path].replace(old, new, 1)
        return self

    def put(self, name: str, text: str) -> Files:
        """Write a file of the package."""
        self.texts[self.path(name)] = self.filled(text)
        return self

    def remove(self, name: str) -> Files:
        """Take a file of the package away."""
        del self.texts[self.path(name)]
        return self

    def only(self, *kept: str) -> Files:
        """Take the other nodes away, with their executables: each program that is run takes seconds."""
        names = self.names
        for name, module in (("node", names.module), ("listener", names.listener), ("driver", names.driver)):
            if name not in kept:
                self.remove(name)
                for path in {self.path("setup.py"), self.path("launch/robot.launch.py")} & self.texts.keys():
                    lines = self.texts[path].splitlines(keepends=True)
                    self.texts[path] = "".join(line for line in lines if f"'{module}" not in line)
        return self

    def launch_by(self, name: str) -> Files:
        """Start the nodes by a launch file in YAML or in XML, as its name ends, instead of the one in Python."""
        self.remove("launch/robot.launch.py").put(name, LAUNCH_XML if name.endswith("xml") else LAUNCH_YAML)
        return self.change("setup.py", "launch/*.launch.py", "launch/*")

    def write(self, root: Path) -> Path:
        """Write everything to a folder, and return it."""
        (root / "src").mkdir(parents=True, exist_ok=True)
        for path, text in self.texts.items():
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text(text)
        return root
