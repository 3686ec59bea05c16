"""What launch would start, what an entrance reaches, and slips that Python reads: each as an error that nobody reports."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_text
from ros2lab.diagnose.look import Look

LAUNCH = "launch/robot.launch.py"
STATUS = "Node(package='my_bot', executable='status_publisher')"
SPIN = "        rclpy.spin(node)"
Changes = list[tuple[str, str, str]]

STARTED: list[tuple[Changes, str, str]] = [
    ([(LAUNCH, "    return", f"    more = {STATUS[:-1]}, name='more')\n    return")], "launch-lost", "more"),
    (
        [(LAUNCH, "executable='velocity_publisher'", "executable='velocity_publisher', name='driver'")],
        "parameter-file-node",
        "/driver:",
    ),
    (
        [
            ("node", "'/robot/report'", "'news'"),
            ("listener", "'/robot/command'", "'news'"),
            (LAUNCH, STATUS, f"{STATUS[:-1]}, namespace='one')"),
        ],
        "launch-apart",
        "/one",
    ),
    (
        [
            ("listener", "'/robot/command'", "'/robot/report'"),
            (LAUNCH, STATUS, f"{STATUS[:-1]}, remappings=[('/robot/report', '/other')])"),
        ],
        "launch-apart",
        "remappings",
    ),
    ([(LAUNCH, "executable='command_subscriber'", "executable='status_publisher'")], "launch-executable", "command_subscriber instead of"),
    ([(LAUNCH, "executable='command_subscriber'", "executable='status_publisher'"), (LAUNCH, "        Node(package='my_bot', executable='velocity_publisher', parameters=[config]),\n", "")], "launch-executable", "write command_subscriber or velocity_publisher instead of"),
    ([("config/robot.yaml", "    speed: 0.3\n", "    speed: 0.3\n    use_sim_time: true\n")], "period", "use_sim_time: false"),
    ([(LAUNCH, "launch_ros.actions import Node", "launch.actions import ExecuteProcess as Node")], "import-wrong", "launch_ros.actions"),
]  # fmt: skip

REACHED: list[tuple[Changes, str, str]] = [
    ([("node", SPIN, "        rclpy.spin_once(node)")], "spin-missing", "rclpy.spin(node)"),
    (
        [("node", SPIN, "        executor = rclpy.executors.SingleThreadedExecutor()\n        executor.spin()")],
        "spin-missing",
        "executor.add_node(node)",
    ),
    ([("node", "def main(args=None):\n", "def main(args=None):\n    pass\n\n\ndef start(args=None):\n")], "never-made", "start()"),
    ([("setup.py", "my_bot.command_subscriber:main", "my_bot.status_publisher:main")], "entry-point-function", "my_bot.command_subscriber:main"),
    (
        [
            ("node", "def main(args=None):\n    rclpy.init(args=args)", "if __name__ == '__main__':\n    rclpy.init()"),
            ("node", "\n\nif __name__ == '__main__':\n    main()\n", "\n"),
        ],
        "entry-point-function",
        "def main(args=None):",
    ),
]  # fmt: skip

SLIPS: list[tuple[Changes, str, str]] = [
    ([("setup.py", "['package.xml']),", "['package.xml'])")], "setup-syntax", "['package.xml']),`"),
    (
        [("listener", "        self.state = 'idle'", "        self.state = 'idle'\n        self.words = [('a', 1) ('b', 2)]")],
        "comma-missing",
        "('a', 1)",
    ),
    (
        [("listener", "'/robot/command', self.command_callback", "self.command_callback, '/robot/command'")],
        "argument-order",
        "(String, '/robot/command', self.command_callback, 10)",
    ),
    (
        [("driver", "        self.timer", "        self.rate_hz = 10.0\n        self.timer"), ("driver", "timer(0.1,", "timer(self.rate_hz,")],
        "period",
        "1.0 / self.rate_hz",
    ),
    (
        [
            ("driver", "msg.linear.x = self.get_parameter('speed').value", "msg.linear.x = clamp(0.6, self.get_parameter('speed').value)"),
            ("driver", "class VelocityPublisher", "def clamp(speed, limit):\n    return min(speed, limit)\n\n\nclass VelocityPublisher"),
        ],
        "argument-order",
        "clamp(self.get_parameter('speed').value, 0.6)",
    ),
]  # fmt: skip


@pytest.mark.parametrize("row", [*STARTED, *REACHED, *SLIPS])
def test_what_nobody_reports_is_found_with_what_to_write(
    tmp_path: Path, row: tuple[Changes, str, str]
) -> None:
    """Its code, in the first file that was changed or in the parameter file, and a fix that says what to write."""
    changes, code, fix = row
    files = right_workspace()
    for file, old, new in changes:
        files.change(file, old, new)
    findings = Look(files.write(tmp_path), loads=True).findings
    found = next((finding for finding in findings if finding.code == code), None)
    assert found is not None, findings
    assert fix in found.fix
    assert any(
        files.path(file) in found.place for file in (*(change[0] for change in changes), "config/robot.yaml")
    )


RIGHT: list[Changes] = [
    # Two robots, of which each has both ends of its topic.
    [
        ("node", "'/robot/report'", "'news'"),
        ("listener", "'/robot/command'", "'news'"),
        (
            LAUNCH,
            STATUS,
            ", ".join(
                f"Node(package='my_bot', executable='{name}', namespace='{space}')"
                for space in ("one", "two")
                for name in ("status_publisher", "command_subscriber")
            ),
        ),
        (LAUNCH, "        Node(package='my_bot', executable='command_subscriber'),\n", ""),
    ],
    # A node that another one's end, or a condition, brings in.
    [
        (LAUNCH, "from launch import", "from launch.actions import TimerAction\nfrom launch.conditions import IfCondition\nfrom launch import"),
        (LAUNCH, STATUS, f"TimerAction(period=2.0, actions=[{STATUS}]), {STATUS[:-1]}, condition=IfCondition('false'))"),
    ],
    [("config/robot.yaml", "velocity_publisher:", "/**:"), (LAUNCH, "parameters=[config]", "name='driver', namespace='one', parameters=[config]")],
    [("node", SPIN, "        while rclpy.ok():\n            rclpy.spin_once(node)")],
    [("node", SPIN, "        executor = rclpy.executors.SingleThreadedExecutor()\n        executor.add_node(node)\n        executor.spin()")],
    [("driver", "        self.timer", "        self.rate = 0.1\n        self.timer"), ("driver", "timer(0.1,", "timer(self.rate,")],
    # One of two that are made is started, and another one when it has ended.
    [
        (LAUNCH, "launch import LaunchDescription", "launch import LaunchDescription\nfrom launch.actions import RegisterEventHandler\nfrom launch.event_handlers import OnProcessExit"),
        (LAUNCH, "    return", f"    first, other, last = {STATUS}, 1, 2\n    other = {STATUS}\n    last = {STATUS}\n    return"),
        (LAUNCH, f"        {STATUS}", "        first if config else other, RegisterEventHandler(OnProcessExit(target_action=first, on_exit=lambda *_: [last]))"),
    ],
    # Programs of others stand between two nodes; a service gets another name.
    [
        ("node", "        self.count = 0", "        self.count = 0\n        self.create_service(Trigger, 'reports', self.answer)\n\n    def answer(self, request, response):\n        return response"),
        ("node", "from std_msgs", "from std_srvs.srv import Trigger\nfrom std_msgs"),
        ("package.xml", "  <depend>std_msgs", "  <depend>std_srvs</depend>\n  <depend>std_msgs"),
        ("listener", "'/robot/command'", "'/robot/report'"),
        (LAUNCH, STATUS, f"{STATUS[:-1]}, remappings=[('/robot/report', '/raw'), ('reports', 'more')]), Node(package='filters', executable='filter')"),
    ],
    # What is not on this machine is no fault of the file, and of its nodes nothing is known.
    [
        (LAUNCH, "    config =", "    get_package_share_directory('robot_of_others')\n    config ="),
        (LAUNCH, "parameters=[config]", "namespace='one', parameters=[config]"),
        ("config/robot.yaml", "velocity_publisher:", "/one/velocity_publisher:"),
    ],
    # A spin that is handed over, a turn whose result is used, a turn of a loop that is not Python's.
    [
        ("node", SPIN, "        with ThreadPoolExecutor(1) as pool:\n            pool.submit(rclpy.spin, node).result()"),
        ("node", "import rclpy\n", "from concurrent.futures import ThreadPoolExecutor\n\nimport rclpy\n"),
        ("listener", SPIN, "        rclpy.spin_once(node, timeout_sec=3.0)\n        print(node.state)"),
        ("driver", SPIN, "        root = tkinter.Tk()\n\n        def turn():\n            rclpy.spin_once(node, timeout_sec=0.0)\n            root.after(20, turn)\n\n        turn()\n        root.mainloop()"),
        ("driver", "import rclpy\n", "import tkinter\n\nimport rclpy\n"),
    ],
    # A flag for one more topic, a long period, a log for those who look for it, a call both ways, a node kept for waiting.
    [
        ("node", "        self.count = 0", "        self.count = 0\n        self.debug = False\n        self.more = self.create_publisher(String, 'more', 1)\n        self.saver = self.create_timer(600, self.save)\n\n    def save(self):\n        self.get_logger().debug(f'{difference(self.count, 3)}')"),
        ("node", "        self.count += 1", "        self.count += 1\n        if self.debug:\n            self.more.publish(msg)"),
        ("node", "class Status", "def difference(first, second):\n    return apart(second, first) + apart(first, second)\n\n\ndef apart(first, second):\n    return abs(first - second)\n\n\nclass Status"),
        ("listener", "        self.state = 'idle'", "        self.state = 'idle'\n        self.helper = rclpy.create_node('helper')\n        self.client = self.helper.create_client(Trigger, 'ring')"),
        ("listener", "            self.state = 'running'", "            self.state = 'running'\n            rclpy.spin_until_future_complete(self.helper, self.client.call_async(Trigger.Request()))"),
        ("listener", "from std_msgs", "from std_srvs.srv import Trigger\nfrom std_msgs"),
        ("package.xml", "  <depend>std_msgs", "  <depend>std_srvs</depend>\n  <depend>std_msgs"),
    ],
    # Two programs of one file; one program whose nodes have names that it is given.
    [
        ("node", "def __init__(self):\n        super().__init__('status_publisher')", "def __init__(self, name):\n        super().__init__(name)"),
        ("node", "StatusPublisher()", "StatusPublisher('status_publisher')"),
        ("node", "\n\nif __name__", "\n\ndef second():\n    rclpy.init()\n    rclpy.spin(StatusPublisher('second'))\n\n\nif __name__"),
        ("setup.py", "'status_publisher = ", "'second = my_bot.status_publisher:second',\n            'status_publisher = "),
        (LAUNCH, f"        {STATUS}", f"        {STATUS}, {STATUS.replace('status_publisher', 'second')}"),
        (LAUNCH, "        Node(package='my_bot', executable='command_subscriber'),\n", ""),
    ],
    [
        ("node", "super().__init__('status_publisher')", "super().__init__(sys.argv[1])"),
        ("node", "import rclpy\n", "import sys\n\nimport rclpy\n"),
        (LAUNCH, f"        {STATUS}", f"        {STATUS[:-1]}, arguments=['one']), {STATUS[:-1]}, arguments=['two'])"),
        (LAUNCH, "        Node(package='my_bot', executable='command_subscriber'),\n", ""),
    ],
    # A class that is there for the nodes of others, and a file that takes another one's place.
    [
        ("PACKAGE/base.py", "", "from rclpy.node import Node\nfrom std_msgs.msg import String\n\n\nclass Base(Node):\n    def __init__(self, name):\n        super().__init__(name)\n        self.mode = 'idle'\n        self.news = self.create_publisher(String, 'news', 10)\n\n    def command_callback(self, msg):\n        self.mode = msg.data\n\n    def tell(self):\n        self.news.publish(String(data=self.mode))\n"),
        ("PACKAGE/status_publisher_sim.py", "", "import rclpy\n\n\ndef main():\n    rclpy.init()\n    rclpy.spin(rclpy.create_node('status_publisher'))\n"),
    ],
]  # fmt: skip


@pytest.mark.parametrize("changes", RIGHT)
def test_what_is_unusual_and_right_raises_no_alarm(tmp_path: Path, changes: Changes) -> None:
    files = right_workspace()
    for file, old, new in changes:
        files.change(file, old, new) if old else files.put(file, new)
    assert Look(files.write(tmp_path), loads=True).findings == []


def test_what_fails_is_followed_to_where_it_was_made(tmp_path: Path) -> None:
    """The error names the line in which a value is used; the comma stands where it was made."""
    made = "self.create_publisher(Twist, '/cmd_vel', 10)"
    files = right_workspace().change("driver", made, f"{made},")
    root = files.write(tmp_path)
    path = root / files.path("driver")
    number = path.read_text().splitlines().index("        self.publisher_.publish(msg)") + 1
    text = (
        f'Traceback (most recent call last):\n  File "{path}", line {number}, in timer_callback\n'
        "    self.publisher_.publish(msg)\nAttributeError: 'tuple' object has no attribute 'publish'\n"
    )
    assert of_text(text, root)[0].code == "comma-tuple"


def test_a_fix_that_changes_nothing_for_the_better_is_not_proposed(tmp_path: Path) -> None:
    """What is given rightly is not taken away to make a call fit."""
    files = right_workspace().change(LAUNCH, STATUS, f"{STATUS[:-1]}, condition='true')")
    root = files.write(tmp_path)
    text = (
        "$ ros2 launch my_bot robot.launch.py\n[ERROR] [launch]: Caught exception in launch (see debug for traceback): "
        "'str' object has no attribute 'evaluate'\n"
    )
    assert all(
        one.fix != "write `Node(package='my_bot', executable='status_publisher')`"
        for one in of_text(text, root)
    )
