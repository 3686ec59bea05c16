"""A fix reaches what it is for: the node's own parameters, the value's type, a line that runs; a guess is left out."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.nodes.parameter_values import of_its_type
from ros2lab.diagnose.rules import source_faults
from ros2lab.diagnose.sources.commented_out import disabled
from ros2lab.diagnose.sources.spelling import may_mean, nearest

HEAD = """\
import time

import cv2
import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.lifecycle import Node as Managed, TransitionCallbackReturn
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool


"""
END = "\n\ndef main():\n    rclpy.init()\n    rclpy.spin(Robot())\n"
GOAL = """\
class Goal(Node):
    def __init__(self):
        super().__init__('goal')
        self.declare_parameter('x', 0.0)
        self.create_timer(1.0, self.tick)

    def tick(self):
        self.get_logger().info(str(self.get_parameter('x').value))


"""


def robot(made: str, *methods: str, base: str = "Node", before: str = "") -> str:
    """Return a file with a node that has more lines in its constructor, and methods of some lines each."""
    lines = "".join(f"        {line}\n" for line in made.splitlines())
    bodies = "".join("\n" + "".join(f"    {line}\n" for line in method.splitlines()) for method in methods)
    head = f"class Robot({base}):\n    def __init__(self):\n        super().__init__('robot')\n"
    return f"{HEAD}{before}{head}{lines}{bodies}{END}"


def found(text: str, folder: Path, code: str) -> list[tuple[str, str]]:
    return [(f.cause, f.fix) for f in source_faults(sources_of(text, folder)) if f.code == code]


ASK = "`self.client = AsyncParameterClient(self, '{}')`"


@pytest.mark.parametrize(
    ("made", "asked", "fix"),
    [
        ("", "/goal/x", ASK.format("/goal")),
        ("", "/hall/other/speed", ASK.format("/hall/other")),
        ("", "goal.x", ASK.format("goal")),
        ("", "x", "`self.declare_parameter('x', '')`"),
        ("self.declare_parameter('speed', 'a')", "/robot/speed", "write 'speed', which is declared here"),
        ("self.declare_parameter('speed', 'a')", "sped", "write 'speed' if that is meant"),
        ("self.declare_parameter('speed', 'a')", "/speed", "write 'speed' if that is meant"),
        ("self.declare_parameter('goal.x', 'a')", "goal.y", "`self.declare_parameter('goal.y', '')`"),
    ],
)
def test_a_node_asks_another_one_for_its_parameters(tmp_path: Path, made: str, asked: str, fix: str) -> None:
    read = f"{made}\nself.get_logger().info(str(self.get_parameter({asked!r}).value))"
    ((cause, told),) = found(robot(read, before=GOAL), tmp_path, "parameter-undeclared")
    assert fix in told
    assert ("goal_" in cause, " x." in cause) == (False, False)  # of its own parameters only


@pytest.mark.parametrize(
    "text",
    [
        robot("self.declare_parameter('wheel.left', 'a')\nself.say = str(self.get_parameter('wheel.left').value)"),
        robot(
            "self.declare_parameter('x', 'a')",
            base="Base",
            before="class Base(Node):\n    def tick(self):\n        self.get_logger().info(str(self.get_parameter('x').value))\n\n\n",
        ),
    ],
)  # fmt: skip
def test_a_family_of_classes_shares_its_parameters(tmp_path: Path, text: str) -> None:
    assert found(text, tmp_path, "parameter-undeclared") == []


PUB = "self.pub = self.create_publisher(String, 'out', 10)"
SUB = f"{PUB}\nself.sub = self.create_subscription(String, 'in', self.hear, 10)"
HEAR = "def hear(self, msg):\n    self.get_logger().info(msg.data)"
SEND = "def {}(self):\n    self.pub.publish(String(data='on'))"
TIMER = "write `self.timer = self.create_timer(1.0, self.{})` in __init__"
CLIENT = "self.client = ActionClient(self, Fibonacci, 'go')\nself.client.send_goal_async(Fibonacci.Goal())"


@pytest.mark.parametrize(
    ("made", "method", "fix"),
    [
        (PUB, SEND.format("drive"), TIMER.format("drive")),
        (SUB, SEND.format("timer_callback"), TIMER.format("timer_callback")),
        (SUB, SEND.format("drive"), f"{TIMER.format('drive')} if it is to run every second; otherwise call it where it is needed, or remove it"),
        (f"{PUB}\n# self.create_timer(1.0, self.drive)", SEND.format("drive"), "remove the # from line 17, which uses it, or remove drive()"),
        (f'{PUB}\n"""\nself.create_timer(1.0, self.drive)\n"""', SEND.format("drive"), "take line 18 out of the quotes around it, which uses it, or remove drive()"),
        (CLIENT, "def feedback_callback(self, heard):\n    print(heard.feedback.sequence)", "write feedback_callback=self.feedback_callback in the send_goal_async(...) on line 17"),
        (CLIENT, "def done_callback(self, future):\n    print(future.result())", "pass self.done_callback to add_done_callback(...) of the future whose result it reads"),
        (CLIENT, "def done_callback(self, future):\n    print(future.result())\n\ndef end_callback(self, future):\n    print(future.result())", "pass self.end_callback to add_done_callback(...) of the future whose result it reads"),
        (f"{CLIENT}\nself.future = self.client.send_goal_async(Fibonacci.Goal())\nrclpy.spin_until_future_complete(self, self.future)\nprint(self.future.result())", "def done_callback(self, future):\n    print(future.result())", "pass self.done_callback to add_done_callback(...) of the future whose result it reads; or remove it, if line 20 reads that result already"),
    ],
)  # fmt: skip
def test_what_nothing_calls_is_begun_as_what_it_is(tmp_path: Path, made: str, method: str, fix: str) -> None:
    assert [told for _, told in found(robot(made, HEAR, method), tmp_path, "never-called")][-1] == fix


@pytest.mark.parametrize(
    ("body", "fix"),
    [
        ("if request.data:\n    return False\nresponse.success = True\nreturn response", "write `return response` instead of what line 20 returns, with `response.success = False` above it"),
        ("return True", "write `return response` instead of what line 19 returns, with `response.success = True` above it"),
        ("response.message = 'on'\nreturn 'off'", "write `return response` instead of what line 20 returns, with `response.message = 'off'` above it"),
        ("response.success = True\nreturn", "write `return response` instead of what line 20 returns"),
        ("response.success = True", "write `return response` as the last line of answer()"),
    ],
)  # fmt: skip
def test_what_a_service_says_stays_in_its_answer(tmp_path: Path, body: str, fix: str) -> None:
    method = "def answer(self, request, response):\n" + "\n".join(f"    {line}" for line in body.splitlines())
    text = robot("self.create_service(SetBool, 'a', self.answer)", method)
    assert [told for _, told in found(text, tmp_path, "callback-arguments")] == [fix]


@pytest.mark.parametrize(
    ("body", "where"),
    [
        ("return TransitionCallbackReturn.SUCCESS", "instead of line 19"),
        ("if not self.pub:\n    return TransitionCallbackReturn.FAILURE\nreturn TransitionCallbackReturn.SUCCESS", "instead of line 21"),
        ("if self.pub:\n    return TransitionCallbackReturn.SUCCESS\nprint('off')", "instead of line 20 and as its last line"),
        ("print('on')", "as its last line"),
    ],
)  # fmt: skip
def test_a_transition_calls_the_base_class_where_it_is_reached(tmp_path: Path, body: str, where: str) -> None:
    method = "def on_activate(self, state):\n" + "\n".join(f"    {line}" for line in body.splitlines())
    text = robot("self.pub = self.create_lifecycle_publisher(String, 'a', 10)", method, base="Managed")
    assert [told for _, told in found(text, tmp_path, "transition-wrong")] == [
        f"write `return super().on_activate(state)` {where}"
    ]


OTHER = "class Other(Node):\n    def __init__(self):\n        super().__init__('other')\n        # self.create_timer(1.0, self.drive)\n\n\n"


@pytest.mark.parametrize(
    ("made", "more", "way"),
    [
        (f"{PUB}\n# self.create_timer(1.0, self.drive)", "", "remove the # from line 23"),
        (PUB, "# self.create_timer(1.0, self.drive)", ""),
        (f"{PUB}\n# self.create_timer(\n#     1.0, self.drive)\n# self.create_timer(2.0, self.drive)", "", "remove the # from line 25"),
        (PUB, "def later(self):\n    # self.create_timer(1.0, self.drive)\n    self.later()", ""),
        (f"{PUB}\n# a timer calls self.drive() once more", "", ""),
        (f"{PUB}\n# self.other.drive()", "", ""),
        (f"{PUB}\n# if self.pub:\n#     self.drive()", "", ""),
    ],
)  # fmt: skip
def test_what_is_put_back_is_in_the_class_and_is_reached(
    tmp_path: Path, made: str, more: str, way: str
) -> None:
    text = robot(made, *[more] * bool(more), SEND.format("drive"), before=OTHER)
    ((_, fix),) = found(text, tmp_path, "never-called")
    assert fix == (f"{way}, which uses it, or remove drive()" if way else TIMER.format("drive"))


def test_the_methods_of_a_class_that_is_never_made_are_no_fault_of_their_own(tmp_path: Path) -> None:
    text = robot("self.create_timer(1.0, self.drive)", "def drive(self):\n    print(1)", before=OTHER)
    lost = f"{OTHER.strip()}\n        self.pub = 1\n\n    def drive(self):\n        self.pub.publish(String())\n\n\n"
    assert found(text.replace(OTHER, lost), tmp_path, "never-called") == []


@pytest.mark.parametrize(
    ("body", "fix"),
    [
        ("msg = String()\nmsg.data = 'on'\nfor _ in range(3):\n    time.sleep(0.1)", "write `self.pub.publish(msg)` as the first line of the loop on line 22"),
        ("msg = String()\nmsg.data = 'on'\nprint('sent')\nreturn", "write `self.pub.publish(msg)` above line 22"),
        ("msg = String()\nfor _ in range(3):\n    msg.data += 'on'\nprint('sent')", "write `self.pub.publish(msg)` below line 22, with the same indentation"),
        ("msg = String()\nmsg.data = 'on'", "write `self.pub.publish(msg)` as the last line of send()"),
        ("msg = String()\nmsg.data = 'on'\n# self.pub.publish(msg)", "remove the # from line 22"),
    ],
)  # fmt: skip
def test_a_message_is_sent_where_it_is_filled(tmp_path: Path, body: str, fix: str) -> None:
    method = "def send(self):\n" + "\n".join(f"    {line}" for line in body.splitlines())
    text = robot(f"{PUB}\nself.create_timer(1.0, self.send)", method)
    assert next(told for _, told in found(text, tmp_path, "never-sent")) == fix


MOTOR = "class Motor:\n    def stop_a(self):\n        self.on = 'a'\n\n    def stop_a(self):\n        self.on = 'b'\n\n\n"
HELD = "self.motor = Motor()\nself.create_timer(1.0, self.tick)"


@pytest.mark.parametrize(
    ("text", "code", "fix"),
    [
        (robot(HELD, "def tick(self):\n    self.motor.stop_b()", before=MOTOR), "replaced", "write `def stop_b` here, if it is the one that node.py:28 calls; otherwise remove one of the two"),
        (robot(HELD, "def tick(self):\n    self.motor.stop_a()", before=MOTOR), "replaced", "move the lines from line 14 on into this one, or remove this one"),
        (robot("a = 3\nself.pair = dict(a=a, b=b)"), "name-undefined", "write a line that gives b its value, above line 17"),
        (robot("self.pair = dict(a=a)"), "name-undefined", "write `def __init__(self, a=None):` on line 14"),
        (robot("self.view = cv2.undistort(image, 3)"), "name-undefined", "write a line above it that gives image its value"),
        (robot("self.client = self.create_client(FindPath, 'find')"), "name-undefined", "import or define FindPath above"),
        (robot("self.pub = self.create_publisher(msg_type=Pose2, topic='to', qos_profile=10)"), "name-undefined", "import or define Pose2 above"),
        (robot("import cv2\ncv2.circle(self.view, (wide, self.high), 3)"), "name-undefined", "write a line above it that gives wide its value"),
        (robot("self.speeds = [1.0, fast]"), "name-undefined", "write a line above it that gives fast its value"),
        (robot("self.words = ['slow', fast]"), "name-undefined", "write `self.words = ['slow', 'fast']` if it is meant as a string; otherwise import or define fast above"),
        (robot("self.sum = self.add(1, 2)", "def add(a, b):\n    return a + b"), "callback-arguments", "write `def add(self, a, b):`"),
        (robot("self.create_timer(1.0, self.tick)", "def tick(self):\n    self.destroy()"), "attribute-missing", "write self.destroy_node, or define self.destroy in __init__"),
        (robot("self.create_subscriber(String, 't', self.tick, 10)", "def tick(self, message):\n    pass"), "attribute-missing", "write self.create_subscription, or define self.create_subscriber in __init__"),
        (robot("self.create_sub(String, 't', self.tick, 10)", "def tick(self, message):\n    pass"), "attribute-missing", "write self.create_subscription, or define self.create_sub in __init__"),
        (robot("self.create_timer(1.0, self.tikc)", "def tick(self):\n    pass"), "attribute-missing", "write self.tick, or define tikc"),
        (robot("self.create_timer(1.0, self.tick)\nself.create_timer(1.0, callback=self.tikc)", "def tick(self):\n    pass"), "attribute-missing", "define tikc, or fix its spelling"),
        (robot("self.create_timer(self.period, self.tick)", "def tick(self):\n    pass"), "attribute-missing", "set self.period in __init__, or fix its spelling"),
    ],
)  # fmt: skip
def test_a_fix_does_not_make_another_fault(tmp_path: Path, text: str, code: str, fix: str) -> None:
    assert [told for _, told in found(text, tmp_path, code)] == [fix]


def test_a_name_is_no_guess_for_another_thing() -> None:
    assert nearest("requires_python", ("requires", "python_requires")) == "python_requires"
    assert not may_mean("goal_tolerance", "goal_delay", ("goal_delay", "max_x"))
    assert may_mean("max_speed", "speed", ("speed",))
    assert not may_mean("stop_b", "stop", ("stop", "stop_a"))


def test_a_value_is_said_in_the_type_of_its_parameter() -> None:
    assert of_its_type("a", [""]) == ", with a list of texts as its value"
    assert of_its_type(5, 0.5) == ", with a number with a decimal point as its value"
    assert (of_its_type("a", "b"), of_its_type(object(), 0.5)) == ("", "")


def test_code_out_of_use_is_found_with_the_way_back() -> None:
    code = 'def main():\n    """About run()."""\n    x = 1  # run()\n    # run()\n    """\n    run(2)\n    """\n    # run(\n    #     3\n    # )\n'
    main = ast.parse(code).body
    assert disabled(code, main, r"run\(\)") == (4, "remove the # from line 4")
    assert disabled(code, main, r"run\(2") == (6, "take line 6 out of the quotes around it")
    assert disabled(code, main, r"run\($") == (8, "remove the # from lines 8 to 10")
    assert disabled(code, main, "stop") == disabled("def (", main, "") == disabled(code, [], "run") == (0, "")
