"""A comparison tells words apart if what comes with a message is compared, and something depends on it."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from ros2lab.diagnose.sources.python_source import PythonSource, read_source
from ros2lab.grading.code.dependence import depended_on
from ros2lab.grading.code.running import running

NODE = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

{before}

class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        {init}
        self.create_subscription(String, "/robot/command", {callback}, 10)

    def obey(self, message):
        {body}

{after}

def main(args=None):
    rclpy.init(args=args)
    node = Listener()
    {main}
    rclpy.spin(node)
"""


def source(tmp_path: Path, text: str) -> PythonSource:
    (tmp_path / "listener.py").write_text(text)
    return read_source(tmp_path / "listener.py", "pkg.listener", "listener.py")


def found(tmp_path: Path, **parts: str) -> list[str]:
    given = (
        dict.fromkeys(("before", "init", "after", "main", "body"), "pass") | {"callback": "self.obey"} | parts
    )
    lines = {
        name: text.replace("\n", "\n        ") if name in ("body", "init") else text
        for name, text in given.items()
    }
    one = source(tmp_path, NODE.format(**lines))
    ast.parse(one.text)
    return depended_on([one], [*running([one])])


RIGHT: dict[str, dict[str, str]] = {
    "an if": {"body": "if message.data == 'start':\n    self.state = 'moving'"},
    "by names": {"body": "word = message.data.strip().lower()\nif word == 'start' and word:\n    print(1)"},
    "a match": {"body": "match message.data:\n    case 'start' | 'go':\n        self.state = 1"},
    "a table of functions": {
        "init": "self.actions = {'start': self.go}",
        "body": "action = self.actions.get(message.data)\nif action:\n    action()",
        "after": "    def go(self):\n        print('go')",
    },
    "a table beside the class": {
        "before": "STATES = {'start': 'moving'}",
        "body": "if message.data in STATES:\n    self.state = STATES[message.data]\n    print(self.state)",
    },
    "a function of its own": {
        "before": "def state_after(word):\n    return 'moving' if word == 'start' else 'idle'",
        "body": "self.state = state_after(message.data)\nprint(self.state)",
    },
    "kept, and read by a timer": {
        "init": "self.word = ''\nself.create_timer(1.0, self.tick)",
        "body": "self.word = message.data",
        "after": "    def tick(self):\n        is_start = self.word == 'start'\n        print(is_start)",
    },
    "a queue": {
        "init": "self.words = []\nself.create_timer(1.0, self.tick)",
        "body": "self.words.append(message)",
        "after": "    def tick(self):\n        for one in self.words:\n            if one.data == 'start':\n                print('go')",
    },
    "a lambda": {"callback": "lambda given: self.act(given.data)", "after": "    def act(self, word):\n        if 'start' == word: print('go')"},
    "an else": {"body": "if message.data != 'start':\n    pass\nelse:\n    print('go')"},
    "the same as another, but not as the rest": {"body": "if message.data == 'start':\n    print('go')\nelif message.data == 'go':\n    print('go')\nelse:\n    print('what?')"},
    "another number in the same call": {"body": "if message.data == 'start':\n    self.drive(1)\nelse:\n    self.drive(0)"},
    "early return": {"body": "if message.data != 'start':\n    return\nprint('go')"},
    "a part of the text": {"body": "if 'start' in message.data:\n    self.state = 1"},
    "one of its words": {"body": "words = message.data.split()\nif 'start' in words:\n    print('go')"},
    "its beginning": {"body": "if message.data.lower().startswith('start'):\n    print('go')"},
    "its place": {"body": "if message.data.find('start') >= 0:\n    print('go')"},
    "a pattern": {"before": "import re", "body": "if re.search(r'\\bstart\\b', message.data):\n    print('go')"},
    "a table handed on": {"before": "from machines import Machine", "init": "self.machine = Machine({'start': 'moving'})", "body": "self.machine.on(message)"},
}  # fmt: skip

WRONG: dict[str, dict[str, str]] = {
    "a result that nobody reads": {"body": "self.is_start = message.data == 'start'"},
    "a colour legend": {
        "before": "COLOURS = {'start': 'green'}",
        "init": "for word in COLOURS:\n    print(COLOURS[word])",
        "body": "print(message.data)",
    },
    "an empty branch": {"body": "if message.data == 'start':\n    pass"},
    "an assert": {"body": "assert message.data != 'start'"},
    "an argument of the program": {"main": "import sys\n    if sys.argv[-1] == 'start': print('go')", "body": "print(message.data)"},
    "a parameter": {
        "init": "mode = self.declare_parameter('mode', 'start').value\nif mode == 'start':\n    print('go')",
        "body": "print(message.data)",
    },
    "a table that nobody asks": {"init": "self.table = {'start': 1}", "body": "print(message.data)"},
    "looked up for nothing": {"init": "self.table = {'start': 1}", "body": "self.table.get(message.data)"},
    "looked for, for nothing": {"body": "message.data.startswith('start')"},
    "looked for in something else": {"body": "if 'start' in self.get_name():\n    print(message.data)"},
    "looked for, and the same done": {"body": "if 'start' in message.data:\n    print('got')\nelse:\n    print('got')"},
    "a statement alone": {"body": "message.data == 'start'"},
    "a function that is only called with constants": {
        "before": "def known(word):\n    return word == 'start'",
        "init": "print(known('start'))",
        "body": "print(message.data)",
    },
    "each the same as the rest": {"body": "if message.data == 'start':\n    print(message.data)\nelif message.data == 'stop':\n    print(message.data)\nelse:\n    print(message.data)"},
    "the same but for what nobody reads": {"body": "if message.data == 'start':\n    a = 1\n    print('got')\nelse:\n    b = 2\n    print('got')"},
    "the same with other docstrings": {"body": "if message.data == 'start':\n    'starts'\n    print('got')\nelse:\n    pass\n    print('got')"},
    "a case that does what all do": {"body": "match message.data:\n    case 'start':\n        print('got')\n    case _:\n        print('got')"},
    "a table of one value": {
        "init": "self.table = {'start': 1, 'stop': 1, 'reset': 1}",
        "body": "if message.data in self.table:\n    print(self.table[message.data])",
    },
    "a choice of the same": {"body": "print('got' if message.data == 'start' else 'got')"},
    "a case that does nothing": {"body": "match message.data:\n    case 'start':\n        pass"},
}  # fmt: skip


@pytest.mark.parametrize("name", RIGHT)
def test_what_something_depends_on_is_found(tmp_path: Path, name: str) -> None:
    assert "start" in found(tmp_path, **RIGHT[name])


@pytest.mark.parametrize("name", WRONG)
def test_what_nothing_depends_on_is_not(tmp_path: Path, name: str) -> None:
    assert "start" not in found(tmp_path, **WRONG[name])


def test_what_comes_without_a_callback_may_be_a_message(tmp_path: Path) -> None:
    text = """
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import String

def main():
    while True:
        ok, message = wait_for_message(String, node, "/robot/command")
        if message.data == "start":
            print("go")
"""
    one = source(tmp_path, text)
    assert depended_on([one], [*running([one])]) == ["start"]
