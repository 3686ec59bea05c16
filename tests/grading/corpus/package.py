"""The model: what a good student hands in, file by file; every other submission is this one, changed."""

from __future__ import annotations

from corpus.tree import Files

P = "src/robot_controller/"
M = f"{P}robot_controller/"
STATUS, COMMAND, VELOCITY = (
    f"{M}status_publisher.py",
    f"{M}command_subscriber.py",
    f"{M}velocity_publisher.py",
)
XML, SETUP, CFG = f"{P}package.xml", f"{P}setup.py", f"{P}setup.cfg"
MARKER, LAUNCH, YAML = f"{P}resource/robot_controller", f"{P}launch/robot.launch.py", f"{P}config/robot.yaml"
TESTS, README = f"{P}test/test_nodes.py", "README.md"

STATUS_TEXT = """\
\"\"\"A node that reports on the robot every two seconds.\"\"\"
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


def status_text(count):
    \"\"\"Return the text of a status message.\"\"\"
    return f'Robot is OK, message {count}'


class StatusPublisher(Node):
    \"\"\"Publishes a String on /robot/status.\"\"\"

    def __init__(self):
        super().__init__('status_publisher')
        self.declare_parameter('timer_period', 2.0)
        period = self.get_parameter('timer_period').value
        if period <= 0.0:
            self.get_logger().warning(f'timer_period cannot be {period}, I take 2.0')
            period = 2.0
        self.count = 0
        self.publisher_ = self.create_publisher(String, '/robot/status', 10)
        self.timer = self.create_timer(period, self.publish_status)

    def publish_status(self):
        \"\"\"Publish the next message.\"\"\"
        self.count += 1
        msg = String()
        msg.data = status_text(self.count)
        self.publisher_.publish(msg)
        self.get_logger().info(f'Publishing: {msg.data}')


def main(args=None):
    \"\"\"Run the node until Ctrl-C.\"\"\"
    rclpy.init(args=args)
    node = StatusPublisher()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
"""

_COMMAND_HEAD = """\
\"\"\"A node that obeys the commands start, stop and reset.\"\"\"
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String

STATES = {'start': 'running', 'stop': 'stopped', 'reset': 'idle'}


def next_state(command):
    \"\"\"Return the state that a command leads to.\"\"\"
    word = command.strip().lower()
    if word not in STATES:
        raise ValueError(f'Unknown command: {command!r}')
    return STATES[word]


class CommandSubscriber(Node):
    \"\"\"Listens on /robot/command and tells the state on /robot/state.\"\"\"

    def __init__(self):
        super().__init__('command_subscriber')
        self.state = 'idle'
        self.publisher_ = self.create_publisher(String, '/robot/state', 10)
        self.subscription = self.create_subscription(
            String, '/robot/command', self.on_command, 10)

    def on_command(self, msg):
        \"\"\"Obey a command, or warn of one that is not known.\"\"\"
"""
# What the callback does.
OBEY = """\
        try:
            self.state = next_state(msg.data)
        except ValueError as error:
            self.get_logger().warning(str(error))
            return
        self.get_logger().info(f'Received {msg.data}: now {self.state}')
        self.publisher_.publish(String(data=self.state))
"""
COMMAND_TEXT = (
    _COMMAND_HEAD
    + OBEY
    + """\


def main(args=None):
    \"\"\"Run the node until Ctrl-C.\"\"\"
    rclpy.init(args=args)
    node = CommandSubscriber()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
"""
)

VELOCITY_TEXT = """\
\"\"\"A node that drives the robot while it is running.\"\"\"
import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


def velocity_for(state, speed):
    \"\"\"Return speed forward in m/s and turning in rad/s.\"\"\"
    if state == 'running':
        return speed, 0.2
    return 0.0, 0.0


class VelocityPublisher(Node):
    \"\"\"Publishes a Twist on /cmd_vel ten times a second.\"\"\"

    def __init__(self):
        super().__init__('velocity_publisher')
        self.declare_parameter('timer_period', 0.1)
        self.declare_parameter('speed', 0.5)
        self.state = 'idle'
        self.publisher_ = self.create_publisher(Twist, '/cmd_vel', 10)
        self.subscription = self.create_subscription(
            String, '/robot/state', self.on_state, 10)
        self.timer = self.create_timer(
            self.get_parameter('timer_period').value, self.publish_velocity)

    def on_state(self, msg):
        \"\"\"Remember the state of the robot.\"\"\"
        self.state = msg.data

    def publish_velocity(self):
        \"\"\"Publish how fast the robot should go now.\"\"\"
        speed = self.get_parameter('speed').value
        forward, turn = velocity_for(self.state, speed)
        msg = Twist()
        msg.linear.x = forward
        msg.angular.z = turn
        self.publisher_.publish(msg)


def main(args=None):
    \"\"\"Run the node until Ctrl-C.\"\"\"
    rclpy.init(args=args)
    node = VelocityPublisher()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
"""

XML_TEXT = """\
<?xml version="1.0"?>
<package format="3">
  <name>robot_controller</name>
  <version>0.1.0</version>
  <description>Status, commands and velocity of a small robot, homework of week two.</description>
  <maintainer email="mira.olsen@example.org">Mira Olsen</maintainer>
  <license>MIT</license>

  <depend>rclpy</depend>
  <depend>std_msgs</depend>
  <depend>geometry_msgs</depend>
  <exec_depend>ament_index_python</exec_depend>
  <exec_depend>launch</exec_depend>
  <exec_depend>launch_ros</exec_depend>
  <test_depend>python3-pytest</test_depend>

  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
"""

SETUP_TEXT = """\
from glob import glob

from setuptools import setup

package_name = 'robot_controller'

setup(
    name=package_name,
    version='0.1.0',
    packages=[package_name],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        ('share/' + package_name + '/launch', glob('launch/*.launch.py')),
        ('share/' + package_name + '/config', glob('config/*.yaml')),
    ],
    install_requires=['setuptools'],
    extras_require={'test': ['pytest']},
    zip_safe=True,
    maintainer='Mira Olsen',
    maintainer_email='mira.olsen@example.org',
    description='Status, commands and velocity of a small robot, homework of week two.',
    license='MIT',
    entry_points={
        'console_scripts': [
            'status_publisher = robot_controller.status_publisher:main',
            'command_subscriber = robot_controller.command_subscriber:main',
            'velocity_publisher = robot_controller.velocity_publisher:main',
        ],
    },
)
"""

CFG_TEXT = """\
[develop]
script_dir=$base/lib/robot_controller
[install]
install_scripts=$base/lib/robot_controller
"""

LAUNCH_TEXT = """\
\"\"\"Start the three nodes with the values of config/robot.yaml.\"\"\"
import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    \"\"\"Return what is to be started.\"\"\"
    share = get_package_share_directory('robot_controller')
    config = os.path.join(share, 'config', 'robot.yaml')
    return LaunchDescription([
        Node(package='robot_controller', executable='status_publisher', parameters=[config]),
        Node(package='robot_controller', executable='command_subscriber'),
        Node(package='robot_controller', executable='velocity_publisher', parameters=[config]),
    ])
"""

YAML_TEXT = """\
status_publisher:
  ros__parameters:
    timer_period: 1.0
velocity_publisher:
  ros__parameters:
    timer_period: 0.2
    speed: 0.3
"""

TESTS_TEXT = """\
\"\"\"Tests of the three nodes, without anybody else on the network.\"\"\"
import pytest
import rclpy
from std_msgs.msg import String

from robot_controller.command_subscriber import CommandSubscriber, next_state
from robot_controller.status_publisher import StatusPublisher, status_text
from robot_controller.velocity_publisher import VelocityPublisher, velocity_for


@pytest.fixture
def ros():
    rclpy.init()
    yield
    rclpy.shutdown()


def test_status_text():
    assert status_text(3) == 'Robot is OK, message 3'


def test_states():
    assert next_state('start') == 'running'
    assert next_state(' STOP ') == 'stopped'
    assert next_state('reset') == 'idle'
    with pytest.raises(ValueError):
        next_state('dance')


def test_velocity():
    assert velocity_for('running', 0.7) == (0.7, 0.2)
    assert velocity_for('idle', 0.7) == (0.0, 0.0)


def test_status_publisher(ros):
    node = StatusPublisher()
    assert node.publisher_.topic_name == '/robot/status'
    assert node.timer.timer_period_ns == 2 * 10**9
    node.publish_status()
    assert node.count == 1
    node.destroy_node()


def test_command_subscriber(ros):
    node = CommandSubscriber()
    assert node.subscription.topic_name == '/robot/command'
    node.on_command(String(data='start'))
    assert node.state == 'running'
    node.on_command(String(data='dance'))
    assert node.state == 'running'
    node.destroy_node()


def test_velocity_publisher(ros):
    node = VelocityPublisher()
    assert node.publisher_.topic_name == '/cmd_vel'
    node.on_state(String(data='running'))
    assert node.state == 'running'
    node.destroy_node()
"""

README_TEXT = """\
# Robot controller

A ROS 2 Jazzy package with three nodes for a small robot, written for week two by Mira Olsen.

## Set up

```bash
source /opt/ros/jazzy/setup.bash
cd robot_project_ws
colcon build
source install/setup.bash
```

## Run

All together:

```bash
ros2 launch robot_controller robot.launch.py
```

Or each in a terminal of its own, in which `source install/setup.bash` was run:

```bash
ros2 run robot_controller status_publisher
ros2 run robot_controller command_subscriber
ros2 run robot_controller velocity_publisher
```

Then tell the robot what to do:

```bash
ros2 topic pub --once /robot/command std_msgs/msg/String "{data: start}"
ros2 topic echo /robot/status
ros2 topic echo /cmd_vel
```

## Nodes

| node | topic | type |
|---|---|---|
| status_publisher | publishes `/robot/status`, every 2 s | `std_msgs/msg/String` |
| command_subscriber | subscribes to `/robot/command` | `std_msgs/msg/String` |
| velocity_publisher | publishes `/cmd_vel`, at 10 Hz | `geometry_msgs/msg/Twist` |

The commands are `start`, `stop` and `reset`; anything else is refused with a warning.
The robot drives after `start` and stands still after `stop` and `reset`.
"""

MODEL: Files = {
    README: README_TEXT,
    XML: XML_TEXT,
    SETUP: SETUP_TEXT,
    CFG: CFG_TEXT,
    MARKER: "",
    f"{M}__init__.py": "",
    STATUS: STATUS_TEXT,
    COMMAND: COMMAND_TEXT,
    VELOCITY: VELOCITY_TEXT,
    LAUNCH: LAUNCH_TEXT,
    YAML: YAML_TEXT,
    TESTS: TESTS_TEXT,
}
