"""Fixes that a general sentence does not hold: they name the student's own line, names and values."""

from pathlib import Path

import pytest

from ros2lab.diagnose import of_text, of_workspace
from ros2lab.diagnose.finding import Finding

HEAD = "import rclpy\nfrom rclpy.node import Node\nfrom std_msgs.msg import String\nfrom std_srvs.srv import Trigger\n"
CLASS = "\n\nclass Talk(Node):\n    def __init__(self):\n        super().__init__('talk')\n"
MAIN = "\n\ndef main(args=None):\n    rclpy.init(args=args)\n    rclpy.spin(Talk())\n"
NOT_INIT = (
    "rclpy.exceptions.NotInitializedException: rclpy.init() has not been called. msg:cannot create node"
)
LIBRARY = "/opt/ros/jazzy/lib/python3.12/site-packages/rclpy"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    package = tmp_path / "src/pk"
    (package / "pk").mkdir(parents=True)
    (package / "pk/__init__.py").touch()
    (package / "package.xml").write_text(
        '<package format="3"><name>pk</name><version>0.0.1</version><description>A.</description>'
        '<maintainer email="a@b.example">A</maintainer><license>MIT</license><depend>rclpy</depend>'
        "<export><build_type>ament_python</build_type></export></package>"
    )
    return tmp_path


def told(
    root: Path, text: str, marks: list[str], error: str, inner: str = "node.py", *, code: str = ""
) -> Finding:
    """Return the first finding for a traceback through the lines with these marks and a line of rclpy."""
    path = root / "src/pk/pk/talk.py"
    path.write_text(text)
    lines = text.splitlines()
    frames = [
        f'  File "{path}", line {1 + next(n for n, t in enumerate(lines) if mark in t)}, in f\n'
        for mark in marks
    ]
    library = f'  File "{LIBRARY}/{inner}", line 9, in f\n    {code}\n' if inner else ""
    return of_text(f"Traceback (most recent call last):\n{''.join(frames)}{library}{error}\n", root)[0]


@pytest.mark.parametrize(
    ("text", "marks", "fix"),
    [
        (f"{HEAD}{CLASS}\n\ndef main(args=None):\n    node = Talk()\n    rclpy.init(args=args)\n    rclpy.spin(node)\n", ["node = Talk", "super()"], "move `rclpy.init(args=args)` from line 14 to a line of its own above line 13"),
        (f"{HEAD}{CLASS}\n\ndef main():\n    rclpy.spin(Talk())\n", ["spin(Talk", "super()"], "write `rclpy.init()` above line 13"),
        (f"{HEAD}\nnode = Node('talk')\nnode.get_logger()\n\n\ndef main():\n    rclpy.init()\n    rclpy.spin(node)\n", ["node = Node"], "move line 6 and 7 into main(), indented, right below `rclpy.init()` (line 11)"),
        (f"{HEAD}{CLASS}\n\ndef main(node=Talk()):\n    rclpy.init()\n    rclpy.spin(node)\n", ["node=Talk", "super()"], "write `rclpy.init()` above line 12, and remove `rclpy.init()` (line 13)"),
        (f"{HEAD}{CLASS}\n\nclass App:\n    node = Talk()\n{MAIN.replace('Talk()', 'App.node')}", ["node = Talk", "super()"], "write `rclpy.init()` above line 12, and remove `rclpy.init(args=args)` (line 17)"),
    ],
)  # fmt: skip
def test_where_init_belongs(root: Path, text: str, marks: list[str], fix: str) -> None:
    """Where init stands in main already, it is moved, or the node is."""
    finding = told(root, text, marks, NOT_INIT)
    assert (finding.code, finding.fix) == ("rclpy-init-missing", fix)


def test_an_executor_made_before_init(root: Path) -> None:
    """It fails in rclpy at a context that is None, which says nothing of init."""
    text = f"{HEAD}{CLASS}\n\ndef main():\n    executor = rclpy.executors.SingleThreadedExecutor()\n    rclpy.init()\n"
    error = "TypeError: 'NoneType' object does not support the context manager protocol"
    finding = told(root, text, ["executor ="], error, "guard_condition.py", code="with self._context.handle:")
    assert finding.fix == "move `rclpy.init()` from line 14 to a line of its own above line 13"


SERVICE = "        self.create_service(Trigger, 'go', self.go)\n\n    def go(self, request, response):\n"
MANAGED = "from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn\n\n\nclass Talk(LifecycleNode):\n    def on_configure(self, state):\n"


@pytest.mark.parametrize(
    ("text", "error", "place", "fix"),
    [
        (f"{HEAD}{CLASS}{SERVICE}        response.success = True\n", "TypeError", "service.py:12", "write `return response` as the last line of go()"),
        (f"{HEAD}{CLASS}{SERVICE}        return 'done'\n", "TypeError", "service.py:13", "write `return response` instead of what line 13 returns, with `response.message = 'done'` above it"),
        (f"{HEAD}{CLASS}{SERVICE}        return request\n", "TypeError", "service.py:13", "write `return response` instead of what line 13 returns"),
        (f"{HEAD}{MANAGED}        self.get_logger().info('x')\n", "AttributeError: 'NoneType' object has no attribute 'to_label'", "lifecycle/node.py:9", "write `return TransitionCallbackReturn.SUCCESS` as the last line of on_configure()"),
        (f"{HEAD}{MANAGED}        return True\n", "AttributeError: 'bool' object has no attribute 'to_label'", "lifecycle/node.py:10", "write `return TransitionCallbackReturn.SUCCESS` instead of what line 10 returns"),
    ],
)  # fmt: skip
def test_what_a_callback_returned(root: Path, text: str, error: str, place: str, fix: str) -> None:
    """The place is the callback, and not the line that spins."""
    inner, _, line = place.partition(":")
    finding = told(root, f"{text}{MAIN}", ["rclpy.spin"], error, inner)
    assert (finding.place, finding.fix) == (f"src/pk/pk/talk.py:{line}", fix)


@pytest.mark.parametrize(
    ("made", "line", "said", "fix"),
    [
        ("name = '/robot 1/chat'\n        self.create_publisher(String, name, 10)", 10, ("TopicName", "topic name", "/robot 1/chat", 6), "write '/robot_1/chat' instead of '/robot 1/chat'"),
        ("for i in range(2):\n            self.create_publisher(String, f'{i}_chat', 10)", 11, ("TopicName", "topic name", "0_chat", 0), "write `f'n{i}_chat'` instead of `f'{i}_chat'`: the name then begins with a letter"),
        ("self.declare_parameter('topic', 'my-chat')\n        self.create_publisher(String, self.get_parameter('topic').value, 10)", 10, ("TopicName", "topic name", "my-chat", 2), "write 'my_chat' instead of 'my-chat'"),
        ("import socket\n        self.create_publisher(String, socket.gethostname(), 10)", 11, ("TopicName", "topic name", "lab-3", 3), "write `socket.gethostname().replace('-', '_')` instead of `socket.gethostname()`"),
    ],
)  # fmt: skip
def test_the_text_of_a_refused_name(
    root: Path, made: str, line: int, said: tuple[str, str, str, int], fix: str
) -> None:
    """The text is found wherever it is written; what is only computed is changed where it is used."""
    kind, what, name, at = said
    error = (
        f"rclpy.exceptions.Invalid{kind}Exception: Invalid {what}: it must not:\n  '{name}'\n   {' ' * at}^"
    )
    finding = told(root, f"{HEAD}{CLASS}        {made}\n{MAIN}", ["spin(", "create_publisher"], error)
    assert (finding.place, finding.fix) == (f"src/pk/pk/talk.py:{line}", fix)


@pytest.mark.parametrize(
    ("lines", "error", "fix"),
    [
        ("r = self.get_parameter('rate').get_parameter_value()\n        x = 1.0 / r  # here", "TypeError: unsupported operand type(s) for /: 'float' and 'ParameterValue'", "write r = self.get_parameter('rate').value"),
        ("x = String()\n        x.data = self.get_parameter('rate').get_parameter_value()  # here", "AssertionError: The 'data' field must be of type 'str'", "write self.get_parameter('rate').value instead of self.get_parameter('rate').get_parameter_value()"),
        ("self.declare_parameter('rates', [1, 2.0])  # here", "TypeError: The given value is not a list of one of the allowed types '[1, 2.0]'.", "write [1.0, 2.0] instead of [1, 2.0]"),
        ("self.declare_parameter('rates', {'a': 1})  # here", "TypeError: The given value is not one of the allowed types '{'a': 1}'.", "write `self.declare_parameter('rates.a', 1)`: one parameter for each key"),
        ("self.declare_parameter('rates', [[0.0, 1.0], [2.0, 3.0]])  # here", "TypeError: The given value is not a list of one of the allowed types '[[0.0, 1.0], [2.0, 3.0]]'.", "write [0.0, 1.0, 2.0, 3.0] instead of [[0.0, 1.0], [2.0, 3.0]], and take 2 values at a time"),
        ("self.declare_parameter('rates', String())  # here", "TypeError: The given value is not one of the allowed types 'std_msgs.msg.String(data='')'.", "declare a parameter of its own for each number or text in String()"),
        ("self.declare_parameter('name', Parameter.Type.STRING)\n        self.get_parameter('name')  # here", "rclpy.exceptions.ParameterUninitializedException: The parameter 'name' is not initialized: name", "write a default of this type, such as 'a', instead of Parameter.Type.STRING"),
        ("self.declare_parameter('name', Parameter.Type.DOUBLE_ARRAY)\n        self.get_parameter('name')  # here", "rclpy.exceptions.ParameterUninitializedException: The parameter 'name' is not initialized: name", "write a default of this type, such as [0.5], instead of"),
        ("self.names = ['a'] * 6\n        x = self.names[6]  # here", "IndexError: list index out of range", "write self.names[5], or self.names[-1], for the last one"),
    ],
)  # fmt: skip
def test_values_of_parameters(root: Path, lines: str, error: str, fix: str) -> None:
    """A ParameterValue is not the value, and not every value can be one."""
    text = f"{HEAD}{CLASS}        self.declare_parameter('rate', 2.0)\n        {lines}\n{MAIN}"
    assert told(root, text, ["spin(", "# here"], error, inner="").fix.startswith(fix)


def test_a_function_that_a_library_calls_with_more(root: Path) -> None:
    """Where rclpy calls it, the definition is wrong, and not a call."""
    text = f"{HEAD}{CLASS}        self.future.add_done_callback(self.done)\n\n    def done(self):\n        pass\n{MAIN}"
    error = "TypeError: Talk.done() takes 1 positional argument but 2 were given"
    assert told(root, text, ["spin("], error, "task.py").fix == "write `def done(self, future):`"


@pytest.mark.parametrize(
    ("body", "fix"),
    [
        ("    with rclpy.init(args=args):\n        rclpy.spin(Talk())\n", "write `rclpy.init(args=args)` instead of line 13, and move line 14 to the left, below it"),
        ("    rclpy.init()\n    with Talk() as node:\n        rclpy.spin(node)\n        node.destroy_node()\n", "write `node = Talk()` instead of line 14, and move lines 15 to 16 to the left, below it"),
        ("    rclpy.init()\n    talker = Talk()\n    talker.create_timer(1.0, print)\n", "write `rclpy.spin(talker)` below line 14"),
    ],
)  # fmt: skip
def test_the_lines_of_main(root: Path, body: str, fix: str) -> None:
    """What to write, and in which lines, without any error text."""
    (root / "src/pk/setup.py").write_text(
        "from setuptools import setup\nsetup(name='pk', version='0.0.1', packages=['pk'],\n"
        "      entry_points={'console_scripts': ['talk = pk.talk:main']})\n"
    )
    (root / "src/pk/pk/talk.py").write_text(f"{HEAD}{CLASS}\n\ndef main(args=None):\n{body}")
    assert fix in {finding.fix for finding in of_workspace(root)}
