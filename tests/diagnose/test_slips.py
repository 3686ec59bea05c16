"""What Python cannot read is explained by the slip of typing that made it so, and mended as it was."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from slips import Slip, unreadable

from ros2lab.diagnose.code.syntax_repairs import repairs_of, syntax_finding
from ros2lab.diagnose.sources.python_source import PythonSource

PACKAGE = Path(__file__).parents[2] / "robot_controller"
LISTENER = """\
from functools import partial

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32, String


class Listener(Node):

    TOPICS = {"left": ("ear/left", Float32), "right": ("ear/right", Float32)}

    def __init__(self, name="listener"):
        super().__init__(name)
        self.level = self.declare_parameter("level", 0.5).value
        self.said = self.create_publisher(String, "said", 10)
        for side, (topic, kind) in self.TOPICS.items():
            self.create_subscription(kind, topic, partial(self.hear, side), 10)
        self.create_timer(1.0, self.tell)

    def hear(self, side, msg):
        if msg.data == 0.0 or side not in self.TOPICS:
            return None
        if abs(msg.data) > self.level:
            self.said.publish(String(data=f"{side}: {msg.data:.2f}"))
        else:
            self.get_logger().debug("quiet")

    def tell(self):
        self.get_logger().info("listening to " + ", ".join(self.TOPICS))


def main(args=None):
    rclpy.init(args=args)
    node = Listener()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()


if __name__ == "__main__":
    main()
"""
_SOME = 20  # slips of each file


def mended(slip: Slip) -> str:
    """Return a file as it is after the repairs that are told."""
    source = PythonSource("file", "file.py", slip.text, False, Path("file.py"))
    assert not source.tree.body
    assert source.fault is not None
    lines = slip.text.splitlines()
    for repair in repairs_of(slip.text, source.fault):
        lines = repair.applied(lines)
    return "\n".join(lines) + "\n"


def is_undone(slip: Slip, text: str) -> bool:
    try:
        return ast.dump(ast.parse(mended(slip))) == ast.dump(ast.parse(text))
    except SyntaxError:
        return False


@pytest.mark.parametrize(
    "name", ["LISTENER", "setup.py", "robot_controller/command_subscriber.py", "launch/robot.launch.py"]
)
def test_nine_of_ten_slips_of_typing_are_undone_to_the_letter(name: str) -> None:
    text = LISTENER if name == "LISTENER" else (PACKAGE / name).read_text()
    slips = unreadable(text, _SOME, seed=len(text))
    left = [(slip.kind, slip.line) for slip in slips if not is_undone(slip, text)]
    assert len(slips) == _SOME
    assert len(left) <= _SOME // 10, left


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("from rclpy.node import Node", "form rclpy.node import Node"),
        ("from rclpy.node import Node", "from rclpy.node imoprt Node"),
        ("from rclpy.node import Node", "from rclpy,node import Node"),
        ("import rclpy", "imoprt rclpy"),
        ("class Listener(Node):", "class Listener(Node)"),
        ("class Listener(Node):", "clas Listener(Node):"),
        ("    def tell(self):", "    edf tell(self):"),
        ("    def tell(self):", "    def tellself):"),
        ("    def hear(self, side, msg):", "    def hear(self side, msg):"),
        ("            return None", "            Return None"),
        ("        else:", "        esle:"),
        ("        else:", "        else"),
        (
            "        if msg.data == 0.0 or side not in self.TOPICS:",
            "        if msg.data = 0.0 or side not in self.TOPICS:",
        ),
        ("        super().__init__(name)", "        super()__init__(name)"),
        ("        super().__init__(name)", "        super().__init__(name"),
        ("        self.create_timer(1.0, self.tell)", "        self create_timer(1.0, self.tell)"),
        ("        self.create_timer(1.0, self.tell)", "        self.create_timer(1.0 self.tell)"),
        ("        self.create_timer(1.0, self.tell)", "        self.create_timer 1.0, self.tell)"),
        (
            '        self.said = self.create_publisher(String, "said", 10)',
            '        self.said = self.create_publisher(String, "said, 10)',
        ),
        (
            '        self.said = self.create_publisher(String, "said", 10)',
            '        self.said = self.create_publisherString, "said", 10)',
        ),
        (
            '            self.get_logger().debug("quiet")',
            '            self.get_logger(.debug("quiet")',
        ),
        (
            '            self.get_logger().debug("quiet")',
            '            self.get_logger().debug("quiet',
        ),
        ("    rclpy.init(args=args)", "    rclpy init(args=args)"),
        ('if __name__ == "__main__":', 'if __name__ = "__main__":'),
        ("    try:", "    rty:"),
        ("    except KeyboardInterrupt:", "    execpt KeyboardInterrupt:"),
        ("        pass", "    pass"),
    ],
)
def test_a_slip_in_a_node_is_undone(right: str, wrong: str) -> None:
    assert LISTENER.count(f"{right}\n") == 1
    line = LISTENER.splitlines().index(right) + 1
    text = LISTENER.replace(f"{right}\n", f"{wrong}\n")
    assert mended(Slip("", line, text)).splitlines()[line - 1] == right


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("version='0.0.1',", "version=0.0.1,"),
        ("description='a robot that obeys',", "description=a robot that obeys,"),
        ("('share/' + package_name, ['package.xml']),", "('share/ + package_name, ['package.xml']),"),
        ("('share/' + package_name, ['package.xml']),", "('share/' + package_name, ['package.xml]),"),
        ("('share/' + package_name, ['package.xml']),", "('share/' + package_name, ['package.xml'),"),
        ("'talker = robot.talker:main',", "talker = robot.talker:main,"),
        ("'console_scripts': [", "'console_scripts: ["),
    ],
)
def test_a_slip_in_a_setup_script_is_undone(right: str, wrong: str) -> None:
    text = """from setuptools import setup

package_name = 'robot'

setup(
    name=package_name,
    version='0.0.1',
    packages=[package_name],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
    ],
    description='a robot that obeys',
    entry_points={
        'console_scripts': [
            'talker = robot.talker:main',
        ],
    },
)
"""
    assert text.count(right) == 1
    line = next(number for number, told in enumerate(text.splitlines(), 1) if right in told)
    assert mended(Slip("", line, text.replace(right, wrong))).splitlines()[line - 1].strip() == right


def test_a_method_that_has_moved_out_is_moved_back_as_a_whole() -> None:
    right = LISTENER.replace(LISTENER.splitlines()[9] + "\n\n", "")
    made = next(
        n for n in ast.walk(ast.parse(right)) if isinstance(n, ast.FunctionDef) and n.name == "__init__"
    )
    first, last, lines = made.lineno - 1, made.end_lineno, right.splitlines()
    moved = [line.removeprefix("    ") for line in lines[first:last]]
    text = "\n".join([*lines[:first], *moved, *lines[last:], ""])
    source = PythonSource("ear", "ear.py", text, False, Path("ear.py"))
    assert not source.tree.body
    found = syntax_finding("node-syntax", source)
    assert found.place == f"ear.py:{first + 1}"
    assert f"lines {first + 1} to {last}" in found.fix
    assert "begins with 4 spaces" in found.fix


@pytest.mark.parametrize(
    "text",
    [
        "x = 1\nthis is no code at all, but a sentence, is it not?\n",
        "{{% if robot %}}\nimport rclpy\n{{% endif %}}\n",
    ],
)
def test_what_nothing_mends_is_not_explained_by_more_nonsense(text: str) -> None:
    source = PythonSource("file", "file.py", text, False, Path("file.py"))
    assert not source.tree.body
    assert "write `'" not in syntax_finding("node-syntax", source).fix


def test_of_several_slips_all_are_told_if_the_file_can_be_read_then() -> None:
    node = "        Node(\n            package='p',\n            executable='a',\n        )"
    text = f"def generate_launch_description():\n    return LaunchDescription([\n{node}\n{node}\n{node}\n    ])\n"
    source = PythonSource("a", "a.launch.py", text, False, Path("a.launch.py"))
    assert not source.tree.body
    found = syntax_finding("launch-syntax", source)
    assert (found.place, found.fix) == ("a.launch.py:6", "write `),`; on line 10 write `),`")


def test_what_does_not_let_python_read_even_the_function_is_not_told() -> None:
    text = "def main():\n    x = (1, 2\n    y = } 3 ] for ( if\n    z = = = 4 (( 'a\n"
    source = PythonSource("a", "a.py", text, False, Path("a.py"))
    assert not source.tree.body
    assert source.fault is not None
    assert repairs_of(text, source.fault) == []


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (
            "class A:\n    def f(self):\n        # to do\n\n    # next\n    def g(self):\n        return 1\n",
            2,
        ),
        ("def f(x):\n    # to do\n", 1),
        ("def f(x):\n    for y in x:\n        # to do\n\n\ndef g():\n    return 1\n", 2),
        (
            "def f():\n    # a\n\n\ndef g():\n    # b\n\n\ndef h():\n    # c\n\n\ndef k():\n    # d\n\n\nx = 1\n",
            1,
        ),
    ],
)
def test_a_block_that_is_only_a_comment_gets_pass(text: str, line: int) -> None:
    assert mended(Slip("", line, text)).splitlines()[line - 1].endswith(": pass")


def test_a_body_below_a_comment_is_indented() -> None:
    text = "def f(x):\n# the body\nreturn x + 1\n"
    assert mended(Slip("", 3, text)).splitlines()[2] == "    return x + 1"


@pytest.mark.parametrize(
    ("wrong", "mended_line"),
    [
        ("def tell(self, given: list[]):", "def tell(self, given: list):"),
        ("def tell(self, given: dict[str, list[ ]], *more: int):", "def tell(self, given: dict[str, list], *more: int):"),
        ("def tell(self) -> partial[]:", "def tell(self) -> partial:"),
        ("def tell(self, given: list[String):", "def tell(self, given: list[String]):"),
        ("def tell(self, given: str = well heard):", "def tell(self, given: str = 'well heard'):"),
    ],
)  # fmt: skip
def test_what_is_annotated_is_a_type_and_no_text(wrong: str, mended_line: str) -> None:
    text = LISTENER.replace("def tell(self):", wrong)
    assert mended(Slip("", 0, text)) == LISTENER.replace("def tell(self):", mended_line)


@pytest.mark.parametrize(
    ("wrong", "cause", "fix"),
    [
        ("words: list[] = []", "the brackets after `list` are empty.", "write `words: list = []`"),
        ("self.words[] = [1, 2]", "the brackets after `words` are empty.", "write `self.words = [1, 2]`"),
        ("words = self.TOPICS[]", "the brackets after `TOPICS` are empty: an index", "write `words = self.TOPICS[...]`"),
        ("self.get_logger[].info('on')", "or round ones if it is called.", "write `self.get_logger[...].info('on')`"),
    ],
)  # fmt: skip
def test_empty_brackets_are_no_text_and_no_list(wrong: str, cause: str, fix: str) -> None:
    text = LISTENER.replace("super().__init__(name)", wrong)
    source = PythonSource("file", "file.py", text, False, Path("file.py"))
    assert not source.tree.body
    told = syntax_finding("node-syntax", source)
    assert cause in told.cause
    assert told.fix == fix


@pytest.mark.parametrize(
    ("given", "again", "fix"),
    [
        ("maintainer='Ann'", "maintainer='Ann'", "remove this one, or the maintainer on line 3"),
        ("packages=['a']", "packages=['b']", "move the contents of this one into the packages on line 3, and remove this one"),
        ("name='a'", "name='b', zip_safe=True, name='b'", "remove this one, or the name on line 4"),
    ],
)  # fmt: skip
def test_only_what_holds_several_things_is_joined(given: str, again: str, fix: str) -> None:
    text = f"from setuptools import setup\nsetup(\n    {given},\n    {again},\n)\n"
    source = PythonSource("setup", "setup.py", text, False, Path("setup.py"))
    assert not source.tree.body
    assert syntax_finding("setup-syntax", source).fix == fix
