"""Nodes that need what is not there where they are graded: nothing of it is the student's fault.

Only what does nothing in the work as it was handed in, and no more than answer what nobody there brings, loses by it.
"""

from __future__ import annotations

from corpus.case import Case, Loss
from corpus.package import COMMAND, STATUS, VELOCITY, XML
from corpus.styles.making import style
from corpus.tree import edit, put

_MAIN = """

def main(args=None):
    \"\"\"Run the node until Ctrl-C.\"\"\"
    rclpy.init(args=args)
    try:
        rclpy.spin({name}())
    except KeyboardInterrupt:
        pass
"""
_DRIVES_BY_ODOMETRY = """\
\"\"\"Drives when it is enabled, and answers each odometry with a velocity.\"\"\"
import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_srvs.srv import SetBool


class VelocityPublisher(Node):
    \"\"\"Publishes a Twist on /cmd_vel.\"\"\"

    def __init__(self):
        super().__init__('velocity_publisher')
        self.is_enabled = False
        self.out = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_subscription(Odometry, '/odom', self.on_odometry, 10)
        self.create_service(SetBool, '/enable', self.on_enable)

    def on_enable(self, request, response):
        \"\"\"Let it drive, or not.\"\"\"
        self.is_enabled = request.data
        response.success = True
        return response

    def on_odometry(self, odometry):
        \"\"\"Go on until it is far enough.\"\"\"
        twist = Twist()
        twist.linear.x = 0.5 if odometry.pose.pose.position.x < 3.0 else 0.0
        if self.is_enabled:
            self.out.publish(twist)
""" + _MAIN.format(name="VelocityPublisher")  # fmt: skip
_TELLS_OF_A_BATTERY = """\
\"\"\"Tells every two seconds how full the robot's battery is.\"\"\"
import smbus2
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class StatusPublisher(Node):
    \"\"\"Publishes a String on /robot/status.\"\"\"

    def __init__(self):
        super().__init__('status_publisher')
        self.hat = smbus2.SMBus(1)
        self.out = self.create_publisher(String, '/robot/status', 10)
        self.create_timer(2.0, self.tell)

    def tell(self):
        \"\"\"Publish what the battery says.\"\"\"
        volts, amperes = self.hat.read_i2c_block_data(0x40, 0, 2)
        low = ', which is low' if volts < 11.0 else ''
        self.out.publish(String(data=f'{volts:.1f} V, {amperes:.2f} A{low}'))
""" + _MAIN.format(name="StatusPublisher")  # fmt: skip
_COMMANDS_AN_ARM = """\
\"\"\"Obeys start, stop and reset with an arm.\"\"\"
import rclpy
from arm_msgs.action import MoveArm
from rclpy.action import ActionClient
from rclpy.node import Node
from std_msgs.msg import String


class CommandSubscriber(Node):
    \"\"\"Takes commands from /robot/command.\"\"\"

    def __init__(self):
        super().__init__('command_subscriber')
        self.arm = ActionClient(self, MoveArm, 'move_arm')
        self.create_subscription(String, '/robot/command', self.on_command, 10)

    def on_command(self, msg):
        \"\"\"Log the command, and move the arm.\"\"\"
        self.get_logger().info(f'Received {msg.data}')
        if msg.data in ('start', 'stop', 'reset'):
            self.arm.send_goal_async(MoveArm.Goal(pose=msg.data))
""" + _MAIN.format(name="CommandSubscriber")  # fmt: skip

_DRIVES_BY_KEYS = """\
\"\"\"Drives as long as somebody presses w, and stands after each other key.\"\"\"
import sys
import termios
import tty

import rclpy
from geometry_msgs.msg import Twist


def main(args=None):
    \"\"\"Publish a Twist for each key until q.\"\"\"
    rclpy.init(args=args)
    node = rclpy.create_node('velocity_publisher')
    out = node.create_publisher(Twist, '/cmd_vel', 10)
    before = termios.tcgetattr(sys.stdin)
    try:
        tty.setcbreak(sys.stdin.fileno())
        while rclpy.ok() and (key := sys.stdin.read(1)) != 'q':
            twist = Twist()
            twist.linear.x = 0.5 if key == 'w' else 0.0
            out.publish(twist)
    except KeyboardInterrupt:
        pass
    finally:
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)
"""
_KEEPS_A_LOG = """\
\"\"\"Obeys start, stop and reset, and writes them down.\"\"\"
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class CommandSubscriber(Node):
    \"\"\"Takes commands from /robot/command.\"\"\"

    def __init__(self):
        super().__init__('command_subscriber')
        self.file = open('/home/ada/robot_logs/commands.txt', 'a')
        self.create_subscription(String, '/robot/command', self.on_command, 10)

    def on_command(self, msg):
        \"\"\"Log the command here and there.\"\"\"
        if msg.data in ('start', 'stop', 'reset'):
            self.get_logger().info(f'Obeying {msg.data}')
            self.file.write(f'{msg.data}\\n')
        else:
            self.get_logger().warning('This is no command.')
""" + _MAIN.format(name="CommandSubscriber")  # fmt: skip
_BRAIN = "from geometry_msgs.msg import Twist\n"

_NEEDS = edit(
    XML,
    "  <depend>std_msgs</depend>\n",
    "  <depend>std_msgs</depend>\n  <depend>std_srvs</depend>\n  <depend>nav_msgs</depend>\n  <depend>arm_msgs</depend>\n",
)

ELSEWHERE: tuple[Case, ...] = (
    style(
        "needs_what_is_elsewhere",
        "one waits for odometry and a service, one reads a library, and one has an action that are not installed here",
        put(VELOCITY, _DRIVES_BY_ODOMETRY),
        put(STATUS, _TELLS_OF_A_BATTERY),
        put(COMMAND, _COMMANDS_AN_ARM),
        _NEEDS,
        loses={"velocity_publisher": Loss(7, 7, r"only in answer[\s\S]*is given /\w+ and /\w+, which")},
    ),
    style(
        "reads_a_keyboard",
        "one drives as keys are pressed, and finds nobody who presses one; what it would do nobody can try",
        put(VELOCITY, _DRIVES_BY_KEYS),
    ),
    style(
        "keeps_a_log_in_a_home",
        "one writes into a folder of its author's home, which is on no other machine",
        put(COMMAND, _KEEPS_A_LOG),
    ),
    style(
        "left_a_module_out",
        "one imports a module that was not handed in, which a stand-in replaces; a note leaves it to the instructor",
        edit(VELOCITY, _BRAIN, f"{_BRAIN}from robot_brain import think  # noqa: F401\n"),
    ),
)
