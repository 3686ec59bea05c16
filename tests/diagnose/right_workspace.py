"""The right workspace in which each of `more_cases` makes its mistake: three small nodes as a beginner writes them."""

from __future__ import annotations

from workspace_files import Files, Names

_MAIN = """\


def main(args=None):
    rclpy.init(args=args)
    node = CLASS()
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

_STATUS = """\
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class StatusPublisher(Node):
    def __init__(self):
        super().__init__('status_publisher')
        self.publisher_ = self.create_publisher(String, '/robot/report', 10)
        self.timer = self.create_timer(0.5, self.timer_callback)
        self.count = 0

    def timer_callback(self):
        msg = String()
        msg.data = f'Robot is running: {self.count}'
        self.publisher_.publish(msg)
        self.get_logger().info(f'Publishing: "{msg.data}"')
        self.count += 1
"""

_COMMAND = """\
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class CommandSubscriber(Node):
    def __init__(self):
        super().__init__('command_subscriber')
        self.state = 'idle'
        self.subscription = self.create_subscription(
            String, '/robot/command', self.command_callback, 10)

    def command_callback(self, msg):
        self.get_logger().info(f'I heard: "{msg.data}"')
        if msg.data == 'start':
            self.state = 'running'
        self.get_logger().info(f'State: {self.state}')
"""

_VELOCITY = """\
import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class VelocityPublisher(Node):
    def __init__(self):
        super().__init__('velocity_publisher')
        self.declare_parameter('speed', 0.5)
        self.publisher_ = self.create_publisher(Twist, '/cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.timer_callback)

    def timer_callback(self):
        msg = Twist()
        msg.linear.x = self.get_parameter('speed').value
        msg.angular.z = 0.2
        self.publisher_.publish(msg)
"""

_LAUNCH = """\
import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    config = os.path.join(get_package_share_directory('my_bot'), 'config', 'robot.yaml')
    return LaunchDescription([
        Node(package='my_bot', executable='status_publisher'),
        Node(package='my_bot', executable='command_subscriber'),
        Node(package='my_bot', executable='velocity_publisher', parameters=[config]),
    ])
"""

# As `ros2 pkg create` writes it: without it colcon says nothing of a manifest that it cannot read.
_SCHEMA = (
    '<?xml-model href="http://download.ros.org/schema/package_format3.xsd" '
    'schematypens="http://www.w3.org/2001/XMLSchema"?>\n'
)

_PARAMETERS = "velocity_publisher:\n  ros__parameters:\n    speed: 0.3\n"


def right_workspace() -> Files:
    """Return the workspace with nothing wrong in it."""
    files = Files.right(Names(package="my_bot"))
    for name, text, node in (
        ("node", _STATUS, "StatusPublisher"),
        ("listener", _COMMAND, "CommandSubscriber"),
        ("driver", _VELOCITY, "VelocityPublisher"),
    ):
        files.put(name, text + _MAIN.replace("CLASS", node))
    files.change("package.xml", "<package ", f"{_SCHEMA}<package ")
    files.change(
        "package.xml", "  <depend>std_msgs", "  <depend>ament_index_python</depend>\n  <depend>std_msgs"
    )
    return files.put("launch/robot.launch.py", _LAUNCH).put("config/robot.yaml", _PARAMETERS)
