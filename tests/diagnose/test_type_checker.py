"""What a type checker finds: mends that are applied, and right code that it must not touch."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from styles import MAIN
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text, of_workspace
from ros2lab.diagnose.checking import objections

TALK = "        self.count += 1\n"
FAULTS = [
    (
        "node",
        "msg = String()",
        "msg = String()\n        t = self.get_clock().now.nanoseconds",
        "attribute-missing",
    ),
    ("node", "'period').value", "'period').values", "attribute-missing"),
    ("node", "self.get_logger().info", "self.get_logger.info", "attribute-missing"),
    ("node", "rclpy.spin(node)", "rclpy.spinn(node)", "attribute-missing"),
    ("node", "node.destroy_node()", "node.destroy_nodes()", "attribute-missing"),
    (
        "driver",
        "x = 1.0",
        "x = 1.0\n        import math\n        msg.linear.y = math.pie",
        "attribute-missing",
    ),
    ("driver", "create_timer(0.1,", "create_timer('0.1',", "argument-type"),
    ("driver", "x = 1.0", "x = 1.0\n        import time\n        time.sleep('0.1')", "argument-type"),
    ("node", "rclpy.init(args=args)", "rclpy.init(argv=args)", "argument-unknown"),
    (
        "node",
        TALK,
        f"{TALK}        self.reset(1)\n\n    def reset(self):\n        pass\n",
        "argument-unknown",
    ),
    (
        "node",
        TALK,
        f"{TALK}        self.reset()\n\n    def reset(self, to):\n        pass\n",
        "argument-missing",
    ),
    ("node", TALK, f"{TALK}        x = self.count()\n", "not-callable"),
    ("node", TALK, f"{TALK}        other = Node()\n", "argument-missing"),
    ("node", "f'running {self.count}'", "'running ' + self.count", "operand-type"),
    ("launch/robot.launch.py", "executable='MODULE'", "executible='MODULE'", "argument-missing"),
    ("launch/robot.launch.py", "    return L", "    x = nope\n    return L", "name-undefined"),
]


# Of its code there is another one that is mended in the same way.
OF_A_KIND = {"'period').values", "node.destroy_nodes()"}


@pytest.mark.parametrize(
    "number",
    [
        pytest.param(n, marks=pytest.mark.thorough if fault[2] in OF_A_KIND else (), id=fault[2][:30])
        for n, fault in enumerate(FAULTS)
    ],
)
def test_a_fault_is_told_in_plain_words_and_mended(tmp_path: Path, number: int) -> None:
    name, old, new, code = FAULTS[number]
    files = Files.right(NAMES[1]).change(name, old, new)
    finding = of_workspace(files.write(tmp_path))[0]
    assert finding.code == code
    assert not re.search(r"`?Literal|Unknown|Self@|bound method", finding.cause)
    path, _, line = finding.place.rpartition(":")
    text = (tmp_path / path).read_text().splitlines()
    wrong = text[int(line) - 1]
    if replaced := re.fullmatch(r"write (\S+) instead of (\w+)", finding.fix):
        text[int(line) - 1] = re.sub(rf"\b{replaced[2]}\b", replaced[1], wrong)
    elif "without the quotes" in finding.fix:
        text[int(line) - 1] = re.sub(r"'([\d.]+)'", r"\1", wrong)
    elif "str(...)" in finding.fix:
        text[int(line) - 1] = wrong.replace("self.count", "str(self.count)")
    elif "remove the parentheses" in finding.fix:
        text[int(line) - 1] = wrong.replace("count()", "count")
    else:
        return
    (tmp_path / path).write_text("\n".join(text) + "\n")
    assert of_workspace(tmp_path) == []


def test_a_line_that_an_error_names_is_asked_for_more(tmp_path: Path) -> None:
    """What is None at first may well be set when it is used, until an error says that it is not."""
    files = Files.right(NAMES[1])
    files.change("node", "self.count = 0", "self.count = 0\n        self.last = None")
    files.change("node", TALK, f"{TALK}        self.last = self.last.data\n")
    root = files.write(tmp_path)
    assert of_workspace(root) == []
    text = (
        f'Traceback (most recent call last):\n  File "{root}/install/my_bot/lib/python3.12/site-packages/my_bot/talker.py", '
        "line 21, in tick\n    self.last = self.last.data\nAttributeError: 'NoneType' object has no attribute 'data'\n"
    )
    (finding,) = of_text(text, root)
    assert finding.code == "python-error"
    assert finding.place == "src/my_bot/my_bot/talker.py:21"


HEAD = "import rclpy\nfrom rclpy.node import Node\nfrom std_msgs.msg import String\n\n\nclass CLASS(Node):\n"
INIT = "    def __init__(self):\n        super().__init__('MODULE')\n"
UNUSUAL = {
    "declared in shapes": "        self.declare_parameters('', [('period', 1.0), ('b', 'x'), ('c',)])\n        self.b = self.get_parameter('period').value * 2\n",
    "attribute of a function": "        CLASS.tick.calls = 0\n\n    def tick(self):\n        CLASS.tick.calls += 1\n",
    "set later": "        self.last = None\n        self.create_subscription(String, 'robot/command', self.on, 10)\n\n    def on(self, msg):\n        if self.last:\n            self.last.data += msg.data\n        self.last = msg\n",
    "caught": "        try:\n            rclpy.is_new_here()\n        except AttributeError:\n            pass\n",
    "asked before": "        if hasattr(self, 'is_new_here'):\n            self.is_new_here()\n",
    "many": "        self.names = {}\n        self.names['a'] = self.names.get('a', 0) + 1\n        self.limit = max(self.names.values()) * 0.5\n",
    "logged": "        self.get_logger().info('x', throttle_duration_sec=1.0)\n        self.get_logger().warning(f'{self.get_clock().now().to_msg().sec}')\n",
    "future": "        self.pending = rclpy.task.Future()\n        self.pending.add_done_callback(lambda f: self.get_logger().info(str(f.result())))\n",
    "numpy": "        import numpy as np\n        m = String()\n        m.data = str(np.clip(3.0, -1.0, 1.0).item())\n",
    "class by name": "        kinds = {'text': String}\n        pub = self.create_publisher(kinds['text'], 'robot/status', 10)\n        self.create_timer(2.0, lambda: pub.publish(kinds['text'](data='x')))\n",
    "class that is given": "\n\ndef made(kind: type[Node]) -> Node:\n    return kind()\n",
    "class in a table": "\n\nKINDS: dict[str, type[Node]] = {'MODULE': CLASS}\n\n\ndef made(name: str) -> Node:\n    return KINDS[name]()\n",
    "class of a list": "\n\ndef all_of(kinds: list[type[Node]]) -> list[Node]:\n    return [kind() for kind in kinds]\n",
    "class kept": "        self.kind: type[Node] = CLASS\n\n    def another(self) -> Node:\n        return self.kind()\n",
    "attribute from elsewhere": "\n\ndef prepared() -> Node:\n    node = rclpy.create_node('b')\n    node.cups = 0\n    node.cups += 1\n    return node\n",
    "class itself": "\n    @classmethod\n    def again(cls) -> Node:\n        return cls()\n",
}  # fmt: skip


@pytest.mark.parametrize("name", UNUSUAL)
def test_right_and_unusual_nodes_raise_no_alarm(tmp_path: Path, name: str) -> None:
    files = Files.right(NAMES[1]).put("node", HEAD + INIT + UNUSUAL[name] + MAIN)
    assert of_workspace(files.write(tmp_path)) == []


def test_what_is_too_large_to_be_read_is_not_given_to_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file may have 2 GB and take no room on the disk; the type checker would take ten times as much memory."""
    root = Files.right(NAMES[0]).write(tmp_path)
    package = root / "src" / NAMES[0].package
    for folder in (NAMES[0].package, "launch"):
        with (package / folder / "big.launch.py").open("w") as file:
            file.truncate(100_000_000)
    given: list[str] = []
    monkeypatch.setattr(objections, "said_of", lambda files, **_: given.extend(files) or [])
    of_workspace(root)
    assert given
    assert not [path for path in given if "big" in path]


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("curses.initscr().keypad(0)", ""),
        ("curses.initscr().nodelay(1)", ""),
        ("self.names = sorted(['b', 'a'], reverse=1)", ""),
        ("Bool().data = 0", "write Bool().data = False"),
        ("self.on = Bool(data=0)", "write False"),
        ("self.on = Bool(data=1)", "write True"),
        ("self.on = Bool(data='false')", "write False"),
        ("self.on = Bool(data='off')", "write False"),
        ("self.on = Bool(data='yes')", "write True"),
    ],
)
def test_a_number_is_a_truth_but_not_in_a_message(tmp_path: Path, line: str, fix: str) -> None:
    files = Files.right(NAMES[1]).change("node", TALK, f"{TALK}        {line}\n")
    head = "import curses\n\nimport rclpy\nfrom std_msgs.msg import Bool\n"
    files.change("node", "import rclpy\n", head)
    codes = ("argument-type", "field-type")
    assert [f.fix for f in of_workspace(files.write(tmp_path)) if f.code in codes] == [fix] * bool(fix)


ON_THE_CLASS = [
    ("CLASS.destroy_node()", "its instance here is node.", "write `node.destroy_node()`"),
    ("camera.stop()", "its instance here is eye.", "write `eye.stop()`"),
    ("kind.stop()", "kind is the class camera itself", "write `kind = camera()` instead of `kind = camera`"),
    ("lamp.glow()", "lamp is the class itself, not an instance: the parentheses", "write lamp() where the"),
    ("camera.stop(eye)", "", ""),
    ("camera.made()", "", ""),
    ("camera.twice(2)", "", ""),
]


@pytest.mark.parametrize(("line", "cause", "fix"), ON_THE_CLASS)
def test_a_method_that_is_called_on_its_class(tmp_path: Path, line: str, cause: str, fix: str) -> None:
    classes = """\
class camera:
    def stop(self):
        pass

    @classmethod
    def made(cls):
        return cls()

    @staticmethod
    def twice(x):
        return 2 * x


class lamp:
    def glow(self):
        pass


def main("""
    files = Files.right(NAMES[1]).change("node", "def main(", classes)
    init = "    rclpy.init(args=args)\n"
    files.change("node", init, f"{init}    eye = camera()\n    kind = camera\n    print(eye, kind)\n")
    files.change("node", "node.destroy_node()", line)
    found = [f for f in of_workspace(files.write(tmp_path)) if f.code == "argument-missing"]
    assert [(cause in f.cause, f.fix.startswith(fix)) for f in found] == [(True, True)] * bool(fix), found


@pytest.mark.parametrize(
    ("made", "cause", "fix"),
    [
        ("self.eye = Camera()", "its instance here is self.eye.", "write `self.eye.stop()`"),
        ("print(Camera())", "not an instance; line", "write the instance that line"),
    ],
)
def test_an_instance_is_looked_for_in_the_class_and_the_file(
    tmp_path: Path, made: str, cause: str, fix: str
) -> None:
    files = Files.right(NAMES[1]).change("node", "self.count = 0", f"self.count = 0\n        {made}")
    files.change("node", TALK, f"{TALK}        Camera.stop()\n")
    files.change("node", "class CLASS", "class Camera:\n    def stop(self):\n        pass\n\n\nclass CLASS")
    (found,) = [f for f in of_workspace(files.write(tmp_path)) if f.code == "argument-missing"]
    assert cause in found.cause
    assert found.fix.startswith(fix)


@pytest.mark.parametrize("home", [".plan", ".", "my_bot.plan"])
@pytest.mark.parametrize(
    ("takes", "given", "kept"), [("a", "1, 2, 3", "1"), ("", "1, 2", ""), ("a, b=1", "1, 2, 3, 4", "1, 2")]
)
def test_no_more_arguments_are_kept_than_are_taken(
    tmp_path: Path, home: str, takes: str, given: str, kept: str
) -> None:
    files = Files.right(NAMES[1]).put("my_bot/plan.py", f"def path({takes}):\n    return 3\n")
    name = "plan.path" if home == "." else "path"
    files.change("node", "import rclpy\n", f"import rclpy\nfrom {home} import {name.partition('.')[0]}\n")
    files.change("node", TALK, f"        self.count += {name}({given})\n")
    (told,) = [one for one in of_workspace(files.write(tmp_path)) if one.code == "argument-unknown"]
    assert told.fix == f"write `{name}({kept})`"
