"""Comparisons with a value of another type than the other side has, as the type checker tells it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.checking import compared_types
from ros2lab.diagnose.checking.checked_copies import Row
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.python_source import PythonSource


def told(condition: str, root: Path) -> list[Finding]:
    files = right_workspace().change("listener", "msg.data == 'start'", condition)
    return [one for one in of_workspace(files.write(root)) if one.code == "never-equal"]


@pytest.mark.parametrize(
    ("condition", "fix"),
    [
        ("msg.data.split(' ') == 'start'", "write `'start' in msg.data.split(' ')`"),
        ("msg.data.split() != 'start'", "write `'start' not in msg.data.split()`"),
        ("msg.data.encode() == 'start'", "write `msg.data.encode() == b'start'`"),
        ("self.get_name == 'robot'", "write self.get_name()"),
        ("msg.data.lower == 'start'", "write msg.data.lower() instead of"),
        ("len(msg.data) == '3'", "write `len(msg.data) == 3`"),
        ("msg.data.find('start') == 'start'", "write `str(msg.data.find('start')) == 'start'`"),
        ("msg.data[0] == 1", "write `msg.data[0] == '1'`"),
        ("1 == msg.data.split(',')[0]", "write `msg.data.split(',')[0] == '1'`"),
        ("self.declare_parameter('mode', 'slow') == 'fast'", ".value instead of"),
        ("self.get_clock().now() == '12:00'", "compare what is a string on both sides"),
        ("msg.data.partition(' ') == 'start'", "write `'start' in msg.data.partition(' ')`"),
        ("float(msg.data) in ('1', '2')", "write `float(msg.data) in (1, 2)`"),
        ("msg.data == 'a' or msg.data.split() == 'b' and len(msg.data) == '3'", "write `'b' in msg.data.split()`"),
    ],
)  # fmt: skip
def test_it_is_told_with_what_to_write(tmp_path: Path, condition: str, fix: str) -> None:
    found = told(condition, tmp_path)
    assert found, condition
    assert fix in found[0].fix


@pytest.mark.parametrize(
    "condition",
    [
        "msg.data.split(' ')[0] == 'start'",
        "msg.data.split(' ') == ['start']",
        "msg.data.strip() == 'start'",
        "len(msg.data) == 3.0",
        "len(msg.data) == True",
        "float(msg.data) == 1",
        "msg.data[0] in ('s', 't')",
        "msg.data[:2] in ('st', 1)",
        "self.declare_parameter('mode', 'slow').value == 'fast'",
        "getattr(self, 'mode', None) == 'fast'",
        "self.state == 'running'",
        "(msg.data or None) == 'start'",
        "msg.data.encode() == b'start'",
        "msg.data.isdigit() == True",
        "self.count_publishers('/robot/report') == 0",
        "any(word == 'start' for word in 'start stop'.strip().split())",
        "[*'start stop'.split()][0].upper() == 'START'",
    ],
)
def test_what_may_be_equal_is_left_alone(tmp_path: Path, condition: str) -> None:
    assert told(condition, tmp_path) == []


@pytest.mark.parametrize(
    ("declared", "condition", "fix"),
    [
        ("'on', True", "self.get_parameter('on').value == 'true'", "write `self.get_parameter('on').value` instead of"),
        ("'on', True", "self.get_parameter('on').value != 'True'", "write `not self.get_parameter('on').value` instead of"),
        ("'on', False", "self.get_parameter('on').value in ('no', 'off')", "write `not self.get_parameter('on').value` instead of"),
        ("'n', 3", "self.get_parameter('n').value == '3'", "write `self.get_parameter('n').value == 3`"),
        ("'n', 3", "self.get_parameter('n').value in ('1', '2')", "write `self.get_parameter('n').value in (1, 2)`"),
        ("'r', 0.5", "'0.5' == self.get_parameter('r').value", "write `self.get_parameter('r').value == 0.5`"),
        ("'mode', 'slow'", "self.get_parameter('mode').value == 1", "write `self.get_parameter('mode').value == '1'`"),
        ("'on', True", "self.get_parameter('on').value == True", ""),
        ("'on', True", "str(self.get_parameter('on').value) == 'True'", ""),
        ("'r', 0.5", "self.get_parameter('r').value == 1", ""),
        ("'mode', 'true'", "self.get_parameter('mode').value == 'true'", ""),
        ("'on', True", "self.get_parameter('on').value in (True, 'true')", ""),
    ],
)  # fmt: skip
def test_a_parameter_has_the_type_of_its_default(
    tmp_path: Path, declared: str, condition: str, fix: str
) -> None:
    files = right_workspace().change("listener", "msg.data == 'start'", condition)
    files = files.change(
        "listener", "        self.", f"        self.declare_parameter({declared})\n        self."
    )
    found = [one.fix for one in of_workspace(files.write(tmp_path)) if one.code == "never-equal"]
    assert [text.startswith(fix) for text in found] == [True] if fix else not found


MADE = """\
        super().__init__('command_subscriber')
        self.cli = self.create_client(Trigger, 'ask')
        self.late = None
"""
METHODS = """\
    def is_idle(self):
        return True

    @property
    def is_open(self):
        return True

    def later(self):
        self.on_end = None

    def on_end(self):
        pass

"""


@pytest.mark.parametrize(
    ("condition", "fix"),
    [
        ("not self.cli.service_is_ready", "write self.cli.service_is_ready() instead of self.cli.service_is_ready"),
        ("self.cli.call_async(Trigger.Request()).done", "write self.cli.call_async(Trigger.Request()).done() instead of"),
        ("msg.data and rclpy.ok", "write rclpy.ok() instead of rclpy.ok"),
        ("msg.data.isdigit or self.late", "write msg.data.isdigit() instead of msg.data.isdigit"),
        ("self.is_idle", "write self.is_idle() instead of self.is_idle"),
        ("msg.data.startswith", "write msg.data.startswith(...), with what it needs in the parentheses, instead of"),
        ("self.cli.service_is_ready()", ""),
        ("self.cli.service_is_ready is not None", ""),
        ("self.late", ""),
        ("self.is_open", ""),
        ("self.on_end", ""),
        ("self.executor", ""),
        ("callable(self.is_idle)", ""),
        ("hasattr(self, 'more') and self.more", ""),
        ("hasattr(self, 'more') and self.more and self.more()", ""),
        ("msg", ""),
        ("getattr(self, 'mode', None)", ""),
        ("any(map(self.is_idle, [1]))", ""),
    ],
)  # fmt: skip
def test_a_function_is_no_condition(tmp_path: Path, condition: str, fix: str) -> None:
    files = right_workspace().change("listener", "msg.data == 'start'", condition)
    files.change("listener", "import rclpy\n", "import rclpy\nfrom std_srvs.srv import Trigger\n")
    files.change("listener", "        super().__init__('command_subscriber')\n", MADE)
    files.change("listener", "    def command_callback", f"{METHODS}    def command_callback")
    found = [one for one in of_workspace(files.write(tmp_path)) if one.code in ("no-effect", "not-callable")]
    assert [one.fix.partition(" instead of")[0] for one in found] == [fix.partition(" instead of")[0]] * bool(
        fix
    )


@pytest.mark.parametrize(
    ("lines", "fix"),
    [
        ("msg.data.strip()", "write msg.data = msg.data.strip()"),
        ("word = msg.data\n        word.strip().lower()", "write word = word.strip().lower()"),
        ("words = msg.data.split()\n        words[0].removeprefix('a')", "use what it returns"),
        ("for word in msg.data.split():\n            word.replace('a', 'b')", "write word = word.replace('a', 'b')"),
        ("text = f'{msg}'\n        text.zfill(3)", "write text = text.zfill(3)"),
        ("self.get_name().upper()", "use what it returns"),
        ("msg.data.encode()", ""),
        ("msg.data.index('a')", ""),
        ("try:\n            msg.data.format(1)\n        except IndexError:\n            pass", ""),
        ("words = [msg.data]\n        words.index('a')", ""),
        ("self.title = print\n        self.title()", ""),
        ("path = __import__('pathlib').Path('a')\n        path.replace('b')", ""),
    ],
)  # fmt: skip
def test_a_string_that_is_made_and_not_used(tmp_path: Path, lines: str, fix: str) -> None:
    files = right_workspace().change(
        "listener", "if msg.data == 'start'", f"{lines}\n        if msg.data == 'start'"
    )
    found = [one.fix for one in of_workspace(files.write(tmp_path)) if one.code == "no-effect"]
    assert len(found) == bool(fix)
    assert all(one.startswith(fix) for one in found)


@pytest.mark.parametrize(
    ("lines", "fix"),
    [
        ("self.on = 'a' if msg else 'b'", "write msg.data instead of msg"),
        ("self.on = not msg", "write msg.data instead of msg"),
        ("while not msg:\n            pass", "write msg.data instead of msg"),
        ("print(msg.data)\n        if msg:\n            self.on = 1\n        else:\n            self.on = 2", "write msg.data instead of msg"),
        ("self.declare_parameter('on', True)\n        if self.get_parameter('on'):\n            self.on = msg.data", "write self.get_parameter('on').value instead of"),
        ("on = self.get_parameter('on')\n        self.on = on and 'a'", "write on.value instead of on"),
        ("turn = Twist()\n        self.on = 1 if turn else msg.data", "write one of its fields, such as turn.linear, instead of turn"),
        ("later = self.create_rate(1)\n        self.on = 1 if later else msg.data", "ask what it has instead: "),
        ("if not msg:\n            return\n        self.on = msg.data", ""),
        ("self.on = msg and msg.data", ""),
        ("if msg:\n            self.on = msg.data\n        else:\n            self.on = ''", ""),
        ("later = None if msg.data else Twist()\n        self.on = 1 if later else 2", ""),
        ("if self.has_parameter('on') or self.get_name():\n            self.on = msg.data", ""),
        ("if msg:\n            self.on = 1", "write msg.data instead of msg"),
        ("if msg:\n            self.on = 1\n\n    def end(self):\n        self.command_callback(None)", ""),
        ("msg = msg.data\n        if msg:\n            self.on = 1", ""),
    ],
)  # fmt: skip
def test_a_whole_object_is_no_condition(tmp_path: Path, lines: str, fix: str) -> None:
    files = right_workspace().change(
        "listener",
        "        if msg.data == 'start'",
        f"        {lines}\n        if self.get_name() == 'start'",
    )
    files.change("listener", "import rclpy\n", "import rclpy\nfrom geometry_msgs.msg import Twist\n")
    files.change("listener", ': "{msg.data}"', "")
    found = [one for one in of_workspace(files.write(tmp_path)) if one.code == "message-compared"]
    assert [one.fix.startswith(fix) for one in found] == [True] * bool(fix)


@pytest.mark.parametrize(
    ("made", "lines", "fix"),
    [
        ("self.on = self.get_parameter('use_sim_time')", "if self.on: print(1)", "write self.on.value instead of self.on"),
        ("self.on = self.get_parameter('use_sim_time').value", "if self.on: print(1)", ""),
        ("self.on = String()", "if not self.on: print(1)\n        print(self.on.data)\n\n    def keep(self, msg):\n        self.on = msg", ""),
        ("self.on = String()", "if not self.on: print(1)\n        print(self.on.data)", "set self.on = None in __init__"),
        ("self.on = String()", "if not self.on:\n            return\n        print(self.on.data)", ""),
        ("self.on = None", "if not self.on: print(1)\n        self.on = String()", ""),
        ("self.create_service(SetBool, 'on', self.turn)", "pass\n\n    def turn(self, request, response):\n        if request: print(1)\n        return response", "write request.data instead of request"),
        ("self.create_service(SetBool, 'on', self.turn)", "pass\n\n    def turn(self, request, response):\n        if request.data: print(1)\n        return response", ""),
        ("self.create_service(SetBool, 'on', self.turn)", "pass\n\n    def turn(self, request, response):\n        if not response: print(1)\n        return None", "write response.success instead of response"),
    ],
)  # fmt: skip
def test_what_always_holds_an_object_is_no_condition(tmp_path: Path, made: str, lines: str, fix: str) -> None:
    files = right_workspace().change(
        "listener", "        self.subscription", f"        {made}\n        self.subscription"
    )
    files.change(
        "listener",
        "        if msg.data == 'start'",
        f"        {lines}\n\n    def last(self):\n        if 1 == 1",
    )
    files.change("listener", "import rclpy\n", "import rclpy\nfrom std_srvs.srv import SetBool\n")
    found = [one for one in of_workspace(files.write(tmp_path)) if one.code == "message-compared"]
    assert [one.fix for one in found] == [fix] * bool(fix)


def test_only_of_a_file_with_a_comparison_the_type_checker_is_asked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It takes longer than all else; the call of __init__ in each node is no reason to ask."""
    asked = list[str]()
    check = compared_types.checked

    def checked(source: PythonSource, texts: Sequence[bytes]) -> list[list[Row]]:
        asked.append(source.name.rpartition(".")[2])
        return check(source, texts)

    monkeypatch.setattr(compared_types, "checked", checked)
    assert of_workspace(right_workspace().write(tmp_path)) == []
    assert asked == ["command_subscriber"]
