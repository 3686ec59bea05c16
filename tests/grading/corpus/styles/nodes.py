"""Ways to write a node: each is worth full marks for its three nodes."""

from __future__ import annotations

from corpus.case import ALL_BONUS, Case
from corpus.package import CFG, COMMAND, LAUNCH, MODEL, OBEY, README, SETUP, STATUS, VELOCITY, XML, YAML, M, P
from corpus.styles.making import PLAIN_LAUNCH, style
from corpus.tree import drop, edit, every, move, put

_SPIN = "        rclpy.spin(node)\n"
_STATE_LINE = """\
        if msg.data == 'start':
            self.state = 'running'
        elif msg.data == 'stop' or msg.data == 'reset':
            self.state = 'idle'
        self.get_logger().info(f'Received command: {msg.data}')
        self.get_logger().info(f'State is {self.state}')
"""
_STATE_INSIDE = """\
        self.get_logger().info(f'Received command: {msg.data}')
        if msg.data == 'start':
            self.moving = True
        elif msg.data == 'stop':
            self.moving = False
        elif msg.data == 'reset':
            self.moving = False
            self.distance = 0.0
"""

STATUS_BY_FUNCTION = """\
# Tells how the robot is, every two seconds.
import rclpy
from std_msgs.msg import String


def main(args=None):
    \"\"\"Make the node, a publisher and a timer, and spin.\"\"\"
    rclpy.init(args=args)
    node = rclpy.create_node('status_publisher')
    publisher = node.create_publisher(String, '/robot/status', 10)

    def tell():
        \"\"\"Publish the status.\"\"\"
        publisher.publish(String(data='the robot is fine'))

    node.create_timer(2.0, tell)
    rclpy.spin(node)
"""
COMMAND_BY_FUNCTION = """\
# Obeys start, stop and reset.
import rclpy
from std_msgs.msg import String

state = 'idle'


def main(args=None):
    \"\"\"Make the node and its subscription, and spin.\"\"\"
    rclpy.init(args=args)
    node = rclpy.create_node('command_subscriber')
    states = node.create_publisher(String, '/robot/state', 10)

    def hear(message):
        \"\"\"Change the state.\"\"\"
        global state
        new = {'start': 'running', 'stop': 'stopped', 'reset': 'idle'}.get(message.data.lower())
        if new is None:
            node.get_logger().warn('I do not know ' + message.data)
            return
        state = new
        node.get_logger().info('got ' + message.data + ', state is ' + state)
        states.publish(String(data=state))

    node.create_subscription(String, '/robot/command', hear, 10)
    rclpy.spin(node)
"""
VELOCITY_BY_FUNCTION = """\
# Drives forward while the state is running.
import rclpy
from geometry_msgs.msg import Twist
from std_msgs.msg import String

state = 'idle'


def hear(message):
    \"\"\"Remember the state.\"\"\"
    global state
    state = message.data


def main(args=None):
    \"\"\"Make the node, its topics and its timer, and spin.\"\"\"
    rclpy.init(args=args)
    node = rclpy.create_node('velocity_publisher')
    publisher = node.create_publisher(Twist, '/cmd_vel', 10)

    def drive():
        \"\"\"Publish the velocity.\"\"\"
        twist = Twist()
        twist.linear.x = 0.4 if state == 'running' else 0.0
        publisher.publish(twist)

    node.create_subscription(String, '/robot/state', hear, 10)
    node.create_timer(0.1, drive)
    rclpy.spin(node)
"""

THREE_IN_ONE = """\
\"\"\"The whole robot: three nodes in one process.\"\"\"
import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException, EXECUTOR
from rclpy.node import Node
from std_msgs.msg import String

ROBOT = {'state': 'idle'}  # what the three nodes share


class Status(Node):
    \"\"\"Tells the state every two seconds.\"\"\"

    def __init__(self):
        super().__init__('status_publisher')
        self.out = self.create_publisher(String, '/robot/status', 10)
        self.create_timer(2.0, self.tell)

    def tell(self):
        \"\"\"Publish the state.\"\"\"
        self.out.publish(String(data='state: ' + ROBOT['state']))


class Command(Node):
    \"\"\"Obeys start, stop and reset.\"\"\"

    def __init__(self):
        super().__init__('command_subscriber')
        self.create_subscription(String, '/robot/command', self.hear, 10)

    def hear(self, msg):
        \"\"\"Change the state.\"\"\"
        states = {'start': 'running', 'stop': 'stopped', 'reset': 'idle'}
        word = msg.data.strip().lower()
        if word in states:
            ROBOT['state'] = states[word]
            self.get_logger().info(f'{word}: {ROBOT["state"]}')
        else:
            self.get_logger().warn(f'unknown command {word}')


class Velocity(Node):
    \"\"\"Drives while the state is running.\"\"\"

    def __init__(self):
        super().__init__('velocity_publisher')
        self.out = self.create_publisher(Twist, '/cmd_vel', 10)
        self.create_timer(0.1, self.drive)

    def drive(self):
        \"\"\"Publish the velocity.\"\"\"
        twist = Twist()
        twist.linear.x = 0.5 if ROBOT['state'] == 'running' else 0.0
        self.out.publish(twist)


def main(args=None):
    \"\"\"Run all three until Ctrl-C.\"\"\"
    rclpy.init(args=args)
    executor = EXECUTOR()
    for node in (Status(), Command(), Velocity()):
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
"""
_POINTS = """\
            'status_publisher = robot_controller.status_publisher:main',
            'command_subscriber = robot_controller.command_subscriber:main',
            'velocity_publisher = robot_controller.velocity_publisher:main',
"""
_RUN_THREE = """\
ros2 run robot_controller status_publisher
ros2 run robot_controller command_subscriber
ros2 run robot_controller velocity_publisher
"""
_LAUNCH_THREE = PLAIN_LAUNCH[PLAIN_LAUNCH.index("        Node(") : PLAIN_LAUNCH.index("    ])")]


def _three_in_one(name: str, executor: str, about: str) -> Case:
    return style(
        name,
        about,
        drop(STATUS, COMMAND, VELOCITY),
        put(f"{M}robot.py", THREE_IN_ONE.replace("EXECUTOR", executor)),
        edit(SETUP, _POINTS, "            'robot = robot_controller.robot:main',\n"),
        edit(LAUNCH, _LAUNCH_THREE, "        Node(package='robot_controller', executable='robot'),\n"),
        edit(
            README, "Or each in a terminal of its own, in which `source install/setup.bash` was run:", "Or:"
        ),
        edit(README, _RUN_THREE, "ros2 run robot_controller robot\n"),
    )


_WITH_RATE = """\
        import threading
        threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
        rate = node.create_rate(RATE)
        while rclpy.ok():
            node.PUBLISH()
            rate.sleep()
"""
_WITH_SLEEP = """\
        while rclpy.ok():
            node.PUBLISH()
            rclpy.spin_once(node, timeout_sec=0.0)
            time.sleep(PERIOD)
"""
_WITH_WAIT = """\
        while rclpy.ok():
            node.PUBLISH()
            rclpy.spin_once(node, timeout_sec=PERIOD)
"""
_STATUS_TIMER = """\
        self.declare_parameter('timer_period', 2.0)
        period = self.get_parameter('timer_period').value
        if period <= 0.0:
            self.get_logger().warning(f'timer_period cannot be {period}, I take 2.0')
            period = 2.0
"""
_STATUS_CREATE = "        self.timer = self.create_timer(period, self.publish_status)\n"
_VELOCITY_CREATE = """\
        self.timer = self.create_timer(
            self.get_parameter('timer_period').value, self.publish_velocity)
"""
_VELOCITY_DECLARE = "        self.declare_parameter('timer_period', 0.1)\n"


def _without_timers(name: str, about: str, loop: str, imports: str = "", pace: float = 0.1) -> Case:
    """Another loop in place of the timers; RATE, PERIOD and PUBLISH are filled in, velocities come every `pace` s."""

    def filled(rate: str, period: str, publish: str) -> str:
        return loop.replace("RATE", rate).replace("PERIOD", period).replace("PUBLISH", publish)

    return style(
        name,
        about,
        edit(STATUS, _STATUS_TIMER, ""),
        edit(STATUS, _STATUS_CREATE, ""),
        edit(STATUS, _SPIN, filled("0.5", "2.0", "publish_status")),
        edit(VELOCITY, _VELOCITY_DECLARE, ""),
        edit(VELOCITY, _VELOCITY_CREATE, ""),
        edit(VELOCITY, _SPIN, filled(str(1 / pace), str(pace), "publish_velocity")),
        *(
            edit(path, "\nimport rclpy\n", f"\n{imports}import rclpy\n")
            for path in (STATUS, VELOCITY)
            if imports
        ),
        lacks=frozenset(("parameter_file", "tests", "parameters")),
    )


_THREADING = """\
        def again():
            \"\"\"Publish, and start the next Timer: each fires once.\"\"\"
            if not rclpy.ok():
                return
            timer = threading.Timer(PERIOD, again)
            timer.daemon = True
            timer.start()
            node.PUBLISH()

        again()
        rclpy.spin(node)
"""
_ASYNCIO = """\
        async def tick():
            \"\"\"Publish again and again.\"\"\"
            while rclpy.ok():
                node.PUBLISH()
                await asyncio.sleep(PERIOD)

        async def listen():
            \"\"\"Take what has come.\"\"\"
            while rclpy.ok():
                rclpy.spin_once(node, timeout_sec=0.0)
                await asyncio.sleep(0.02)

        async def both():
            \"\"\"Do both at the same time.\"\"\"
            await asyncio.gather(tick(), listen())

        asyncio.run(both())
"""

_TWIST_EARLY = """\
        speed = self.get_parameter('speed').value
        forward, turn = velocity_for(self.state, speed)
"""
_ON_STATE = "        self.state = msg.data\n"

WAYS_OF_WRITING: tuple[Case, ...] = (
    style(
        "functions",
        "functions, closures and a global, and no class",
        put(STATUS, STATUS_BY_FUNCTION),
        put(COMMAND, COMMAND_BY_FUNCTION),
        put(VELOCITY, VELOCITY_BY_FUNCTION),
        lacks=frozenset(("parameter_file", "tests", "parameters")),
    ),
    _three_in_one("one_process", "SingleThreadedExecutor", "one executable with three nodes"),
    _three_in_one(
        "one_process_multithreaded",
        "MultiThreadedExecutor",
        "one executable with three nodes and several threads",
    ),
    style(
        "subpackages",
        "the modules lie in sub-packages",
        put(f"{M}telling/__init__.py", ""),
        put(f"{M}driving/__init__.py", ""),
        move(STATUS, f"{M}telling/status_publisher.py"),
        move(VELOCITY, f"{M}driving/velocity_publisher.py"),
        move(COMMAND, f"{M}driving/command_subscriber.py"),
        edit(SETUP, "from setuptools import setup", "from setuptools import find_packages, setup"),
        edit(SETUP, "[package_name],", "find_packages(),"),
        edit(SETUP, "robot_controller.status_publisher:", "robot_controller.telling.status_publisher:"),
        edit(SETUP, "robot_controller.velocity_publisher:", "robot_controller.driving.velocity_publisher:"),
        edit(SETUP, "robot_controller.command_subscriber:", "robot_controller.driving.command_subscriber:"),
    ),
    style(
        "other_names",
        "executables, nodes, modules and classes are named after a taste of one's own",
        every(
            lambda text: (
                text.replace("status_publisher", "reporter")
                .replace("StatusPublisher", "Reporter")
                .replace("command_subscriber", "boss")
                .replace("CommandSubscriber", "Boss")
                .replace("velocity_publisher", "driver")
                .replace("VelocityPublisher", "Driver")
            ),
            ".py",
            ".md",
        ),
        move(STATUS, f"{M}reporter.py"),
        move(COMMAND, f"{M}boss.py"),
        move(VELOCITY, f"{M}driver.py"),
    ),
    style(
        "relative_topics",
        "relative names lead to the same topics",
        edit(STATUS, "'/robot/status'", "'robot/status'"),
        edit(COMMAND, "'/robot/command'", "'robot/command'"),
        edit(COMMAND, "'/robot/state'", "'robot/state'"),
        edit(VELOCITY, "'/robot/state'", "'robot/state'"),
        edit(VELOCITY, "'/cmd_vel'", "'cmd_vel'"),
    ),
    style(
        "state_inside",
        "every word is logged alike, and what it changes stays inside the node",
        edit(COMMAND, OBEY, _STATE_INSIDE),
    ),
    style(
        "state_in_each_line",
        "each word is logged with the state that it brings, which an unknown one may share",
        edit(COMMAND, OBEY, _STATE_LINE),
    ),
    style(
        "namespace_by_launch",
        "status and command come below /robot through the launch file only",
        edit(STATUS, "'/robot/status'", "'status'"),
        edit(COMMAND, "'/robot/command'", "'command'"),
        edit(LAUNCH, "executable='status_publisher')", "executable='status_publisher', namespace='robot')"),
        edit(
            LAUNCH, "executable='command_subscriber')", "executable='command_subscriber', namespace='robot')"
        ),
        edit(
            README,
            "Or each in a terminal of its own, in which `source install/setup.bash` was run:",
            "Or each in a terminal of its own, where `--ros-args -r __ns:=/robot` gives the namespace:",
        ),
        edit(
            README,
            _RUN_THREE,
            "ros2 run robot_controller status_publisher --ros-args -r __ns:=/robot\n"
            "ros2 run robot_controller command_subscriber --ros-args -r __ns:=/robot\nros2 run robot_controller velocity_publisher\n",
        ),
    ),
    style(
        "remapped_by_launch",
        "the launch file gives the topics their names",
        edit(STATUS, "'/robot/status'", "'chatter'"),
        edit(
            LAUNCH,
            "executable='status_publisher')",
            "executable='status_publisher',\n             remappings=[('chatter', '/robot/status')])",
        ),
        edit(
            README,
            "ros2 run robot_controller status_publisher\n",
            "ros2 run robot_controller status_publisher --ros-args -r chatter:=/robot/status\n",
        ),
    ),
    style("timers", "the model without what is done for the bonus"),
    _without_timers(
        "rate_with_thread", "create_rate in the main thread, spinning in another one", _WITH_RATE
    ),
    _without_timers(
        "sleeping_loop", "while and time.sleep; the clock of ROS is not asked", _WITH_SLEEP, "import time\n\n"
    ),
    _without_timers(
        "slow_loop", "a loop that sleeps, also between velocities", _WITH_SLEEP, "import time\n\n", pace=1.0
    ),
    style(
        "never_spins",
        "the status comes from a loop that only sleeps: nobody can ask the node for its parameters",
        drop(f"{P}test/"),
        edit(STATUS, _STATUS_CREATE, "        self.period = period\n"),
        edit(
            STATUS,
            _SPIN,
            "        while rclpy.ok():\n            node.publish_status()\n            time.sleep(node.period)\n",
        ),
        edit(STATUS, "\nimport rclpy\n", "\nimport time\n\nimport rclpy\n"),
        base=MODEL,
        earns=frozenset(("launch", "parameters", "parameter_file")),
        lacks=frozenset(("tests",)),
    ),
    _without_timers("waiting_loop", "spin_once waits in place of sleeping", _WITH_WAIT, pace=0.5),
    _without_timers(
        "threading_timer", "a threading.Timer that starts its successor", _THREADING, "import threading\n\n"
    ),
    _without_timers(
        "asyncio", "coroutines, with rclpy.spin_once in one of them", _ASYNCIO, "import asyncio\n\n"
    ),
    style(
        "spin_once_loop",
        "spin_once in a loop in place of spin",
        *(
            edit(
                path, _SPIN, "        while rclpy.ok():\n            rclpy.spin_once(node, timeout_sec=0.5)\n"
            )
            for path in (STATUS, COMMAND, VELOCITY)
        ),
    ),
    style(
        "multithreaded",
        "each node has a MultiThreadedExecutor",
        *(
            edit(
                path,
                "import ExternalShutdownException\n",
                "import ExternalShutdownException, MultiThreadedExecutor\n",
            )
            for path in (STATUS, COMMAND, VELOCITY)
        ),
        *(
            edit(path, _SPIN, "        rclpy.spin(node, executor=MultiThreadedExecutor(num_threads=2))\n")
            for path in (STATUS, COMMAND, VELOCITY)
        ),
    ),
    style(
        "best_effort",
        "sensor data's quality of service",
        edit(
            STATUS,
            "from rclpy.node import Node\n",
            "from rclpy.node import Node\nfrom rclpy.qos import qos_profile_sensor_data\n",
        ),
        edit(STATUS, "'/robot/status', 10)", "'/robot/status', qos_profile_sensor_data)"),
        edit(
            VELOCITY,
            "from rclpy.node import Node\n",
            "from rclpy.node import Node\nfrom rclpy.qos import qos_profile_sensor_data\n",
        ),
        edit(VELOCITY, "'/cmd_vel', 10)", "'/cmd_vel', qos_profile_sensor_data)"),
    ),
    style(
        "best_effort_command",
        "commands are taken best effort",
        edit(
            COMMAND,
            "from rclpy.node import Node\n",
            "from rclpy.node import Node\nfrom rclpy.qos import QoSProfile, ReliabilityPolicy\n",
        ),
        edit(
            COMMAND,
            "self.on_command, 10)",
            "self.on_command,\n            QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT))",
        ),
    ),
    style(
        "transient_local",
        "late listeners get the last message; commands are expected so, too",
        *(
            edit(
                path,
                "from rclpy.node import Node\n",
                "from rclpy.node import Node\nfrom rclpy.qos import DurabilityPolicy, QoSProfile\n",
            )
            for path in (STATUS, COMMAND)
        ),
        edit(
            STATUS,
            "'/robot/status', 10)",
            "'/robot/status',\n            QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))",
        ),
        edit(
            COMMAND,
            "self.on_command, 10)",
            "self.on_command,\n            QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL))",
        ),
    ),
    style(
        "int_parameter",
        "the period is a whole number",
        edit(STATUS, "'timer_period', 2.0", "'timer_period', 2"),
        edit(STATUS, "create_timer(period,", "create_timer(float(period),"),
    ),
    style(
        "rate_parameter",
        "a parameter in Hz in place of a period",
        edit(VELOCITY, "'timer_period', 0.1", "'rate_hz', 10.0"),
        edit(
            VELOCITY,
            "self.get_parameter('timer_period').value,",
            "1.0 / self.get_parameter('rate_hz').value,",
        ),
    ),
    style(
        "no_parameters",
        "numbers stand in the code",
        edit(STATUS, _STATUS_TIMER, "        period = 2.0\n"),
        edit(VELOCITY, _VELOCITY_DECLARE, ""),
        edit(VELOCITY, "self.get_parameter('timer_period').value,", "0.1,"),
        edit(VELOCITY, "        self.declare_parameter('speed', 0.5)\n", ""),
        edit(VELOCITY, "self.get_parameter('speed').value", "0.5"),
        lacks=frozenset(("parameter_file", "tests", "parameters")),
    ),
    style(
        "capitals",
        "commands are compared in capitals, however they were written",
        edit(
            COMMAND,
            "{'start': 'running', 'stop': 'stopped', 'reset': 'idle'}",
            "{'START': 'running', 'STOP': 'stopped', 'RESET': 'idle'}",
        ),
        edit(COMMAND, ".lower()", ".upper()"),
    ),
    style(
        "case_sensitive",
        "start is obeyed, and START is refused with a warning",
        edit(COMMAND, "command.strip().lower()", "command"),
    ),
    style(
        "german",
        "log and status in German, with umlauts",
        edit(STATUS, "f'Robot is OK, message {count}'", "f'Dem Roboter geht es prächtig, Meldung {count}'"),
        edit(
            COMMAND,
            "f'Received {msg.data}: now {self.state}'",
            "f'Befehl {msg.data} ausgeführt, Zustand: {self.state}'",
        ),
        edit(COMMAND, "f'Unknown command: {command!r}'", "f'Den Befehl {command!r} kenne ich nicht'"),
    ),
    style(
        "chinese",
        "log and status in Chinese",
        edit(STATUS, "f'Robot is OK, message {count}'", "f'机器人正常 {count}'"),
        edit(COMMAND, "f'Received {msg.data}: now {self.state}'", "f'收到命令 {msg.data} 状态 {self.state}'"),
    ),
    style(
        "json_status",
        "the status is JSON",
        edit(STATUS, "\nimport rclpy\n", "\nimport json\n\nimport rclpy\n"),
        edit(
            STATUS,
            "f'Robot is OK, message {count}'",
            "json.dumps({'ok': True, 'count': count, 'battery': 0.87})",
        ),
    ),
    style(
        "print",
        "print in place of the logger",
        edit(
            COMMAND,
            "self.get_logger().info(f'Received {msg.data}: now {self.state}')",
            "print(f'Received {msg.data}: now {self.state}')",
        ),
        edit(COMMAND, "self.get_logger().warning(str(error))", "print(error)"),
    ),
    style(
        "log_in_words_of_its_own",
        "each command has a sentence of its own, which does not quote it",
        edit(
            COMMAND,
            "        self.get_logger().info(f'Received {msg.data}: now {self.state}')\n",
            "        if self.state == 'running':\n            self.get_logger().info('Off we go!')\n        elif self.state == 'stopped':\n"
            "            self.get_logger().info('Standing still.')\n        else:\n            self.get_logger().info('Everything anew.')\n",
        ),
    ),
    style(
        "unknown_is_ignored",
        "an unknown command is passed over in silence",
        edit(COMMAND, "            self.get_logger().warning(str(error))\n", "            del error\n"),
    ),
    style(
        "velocity_constant",
        "it drives for ever: only a Twist was asked for",
        edit(
            VELOCITY,
            "    if state == 'running':\n        return speed, 0.2\n    return 0.0, 0.0\n",
            "    return speed, 0.0\n",
        ),
    ),
    style(
        "velocity_sinusoid",
        "it sways, whatever is commanded",
        edit(VELOCITY, "\nimport rclpy\n", "\nimport math\n\nimport rclpy\n"),
        edit(
            VELOCITY,
            "    if state == 'running':\n        return speed, 0.2\n    return 0.0, 0.0\n",
            "    return speed, 0.5 * math.sin(PHASE[0])\n",
        ),
        edit(VELOCITY, "\n\ndef velocity_for", "\nPHASE = [0.0]  # rad\n\n\ndef velocity_for"),
        edit(VELOCITY, _TWIST_EARLY, _TWIST_EARLY + "        PHASE[0] += 0.1\n"),
    ),
    style(
        "velocity_slow",
        "a Twist every second is a Twist",
        edit(VELOCITY, "'timer_period', 0.1", "'timer_period', 1.0"),
    ),
    style(
        "velocity_on_change",
        "a Twist only when the state changes",
        edit(VELOCITY, _VELOCITY_CREATE, ""),
        edit(VELOCITY, _VELOCITY_DECLARE, ""),
        edit(VELOCITY, _ON_STATE, _ON_STATE + "        self.publish_velocity()\n"),
    ),
    style(
        "velocity_after_command",
        "nothing is published before the first start",
        edit(VELOCITY, _TWIST_EARLY, "        if self.state == 'idle':\n            return\n" + _TWIST_EARLY),
    ),
    style(
        "velocity_hears_commands",
        "the driver listens to the commands itself",
        edit(VELOCITY, "'/robot/state'", "'/robot/command'"),
        edit(
            VELOCITY,
            _ON_STATE,
            "        self.state = 'running' if msg.data.strip().lower() == 'start' else 'stopped'\n",
        ),
    ),
    style(
        "nodes_need_each_other",
        "the reporter reports only what the driver tells it",
        edit(
            VELOCITY,
            "        self.publisher_ = self",
            "        self.beats = self.create_publisher(String, '/robot/heartbeat', 10)\n        self.publisher_ = self",
        ),
        edit(
            VELOCITY,
            "        msg = Twist()\n",
            "        self.beats.publish(String(data=self.state))\n        msg = Twist()\n",
        ),
        edit(
            STATUS,
            _STATUS_CREATE,
            _STATUS_CREATE
            + "        self.heard = None\n        self.create_subscription(String, '/robot/heartbeat', self.on_beat, 10)\n",
        ),
        edit(
            STATUS,
            '    def publish_status(self):\n        """Publish the next message."""\n',
            "    def on_beat(self, msg):\n"
            '        """Remember what the driver told."""\n        self.heard = msg.data\n\n    def publish_status(self):\n'
            '        """Publish the next message, if there is something to tell."""\n        if self.heard is None:\n            return\n',
        ),
    ),
    style(
        "ends_with_traceback",
        "Ctrl-C ends it by an exception, as in most tutorials",
        *(
            edit(
                path,
                """\
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
""",
                "    rclpy.spin(node)\n    node.destroy_node()\n    rclpy.shutdown()\n",
            )
            for path in (STATUS, COMMAND, VELOCITY)
        ),
    ),
    style(
        "shutdown_twice",
        "rclpy.shutdown() after Ctrl-C raises in Jazzy",
        *(edit(path, "rclpy.try_shutdown()", "rclpy.shutdown()") for path in (STATUS, COMMAND, VELOCITY)),
    ),
    style(
        "base_class",
        "a base class of its own, in a module of its own",
        put(
            f"{M}base.py",
            '"""What the nodes have in common."""\nfrom rclpy.node import Node\n\n\n'
            'class RobotNode(Node):\n    """A node that says when it is there."""\n\n    def __init__(self, name):\n        super().__init__(name)\n'
            "        self.get_logger().info(f'{name} is there')\n",
        ),
        *(edit(path, "from rclpy.node import Node\n", "") for path in (STATUS, COMMAND, VELOCITY)),
        *(
            edit(path, "import String\n", "import String\n\nfrom robot_controller.base import RobotNode\n")
            for path in (STATUS, COMMAND, VELOCITY)
        ),
        *(
            every(lambda text: text.replace("(Node):", "(RobotNode):"), path)
            for path in (STATUS, COMMAND, VELOCITY)
        ),
    ),
    style(
        "declarative_setup",
        "setup.cfg says what setup.py usually says",
        put(SETUP, "from setuptools import setup\n\nsetup()\n"),
        put(
            CFG,
            """\
[metadata]
name = robot_controller
version = 0.1.0
description = Status, commands and velocity of a small robot, homework of week two.
maintainer = Mira Olsen
maintainer_email = mira.olsen@example.org
license = MIT

[options]
packages = find:
install_requires = setuptools

[options.packages.find]
exclude = test

[options.data_files]
share/ament_index/resource_index/packages = resource/robot_controller
share/robot_controller = package.xml
share/robot_controller/launch = launch/robot.launch.py

[options.entry_points]
console_scripts =
    status_publisher = robot_controller.status_publisher:main
    command_subscriber = robot_controller.command_subscriber:main
    velocity_publisher = robot_controller.velocity_publisher:main

[develop]
script_dir=$base/lib/robot_controller
[install]
install_scripts=$base/lib/robot_controller
""",
        ),
    ),
    style(
        "more_than_asked",
        "a fourth node with a topic of its own",
        put(
            f"{M}battery_publisher.py",
            STATUS_BY_FUNCTION.replace("status_publisher", "battery_publisher")
            .replace("/robot/status", "/robot/battery")
            .replace("the robot is fine", "87 %")
            .replace("2.0", "7.0"),
        ),
        edit(
            SETUP,
            _POINTS,
            _POINTS + "            'battery_publisher = robot_controller.battery_publisher:main',\n",
        ),
    ),
    style(
        "yaml_for_all",
        "the parameter file speaks to /**",
        put(YAML, "/**:\n  ros__parameters:\n    speed: 0.3\n"),
        base=MODEL,
        earns=ALL_BONUS,
        lacks=frozenset(),
    ),
    style(
        "run_depends",
        "build_depend and exec_depend in place of depend",
        *(
            edit(XML, f"  <depend>{name}</depend>\n", f"  <exec_depend>{name}</exec_depend>\n")
            for name in ("rclpy", "std_msgs", "geometry_msgs")
        ),
    ),
)
