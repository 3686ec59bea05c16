"""What code can publish, by what its names may hold: whether anything that could come would open a gate."""

from __future__ import annotations

from pathlib import Path

import pytest
from ros2lab.grading.code.own_messages import own_messages

from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.grading.evidence import WrittenEnd
from ros2lab.grading.reading.written_ends import written_ends

SOURCE = """
from enum import Enum
import math
import threading
import time
import board
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Bool, Float64, String
from std_srvs.srv import SetBool


class Mode(Enum):
    IDLE = 0
    READY = 1


class Status(Node):
    def __init__(self):
        super().__init__("status")
        self.state = START
        self.count = 0
        self.board = board.Board(17)
        self.out = self.create_publisher(String, "/robot/status", 10)
        self.create_subscription(KIND, "/permission", self.permit, 10)
        self.timer = self.create_timer(2.0, self.tick)

    def permit(self, message):
        PERMIT

    def tick(self):
        GATE
        self.out.publish(String(data="well"))


def main():
    rclpy.init()
    node = Status()
    rclpy.spin(node)
    END
"""


def _status(text: str) -> WrittenEnd:
    source = PythonSource("status", "status.py", text)
    assert source.tree.body, source.fault
    return next(end for end in written_ends([source])[0] if end.topic == "/robot/status")


def _filled(gate: str, permit: str = "pass", start: str = "None", kind: str = "Bool", end: str = "") -> str:
    filled = SOURCE.replace("START", start).replace("KIND", kind).replace("PERMIT", permit)
    return filled.replace("GATE", gate).replace("END", end)


KEEPS = "self.state = message.data"
LEAVE = "\n            return\n        "


@pytest.mark.parametrize(
    ("gate", "permit", "start", "kind"),
    [
        ("if self.state: return", KEEPS, "True", "Bool"),
        ("if not self.state: return", KEEPS, "False", "Bool"),
        ("if self.state is None: return", "self.state = message", "None", "Bool"),
        ("if self.state is None or not self.state.data: return", "self.state = message", "None", "Bool"),
        ("if self.state != 'go': return", KEEPS, "''", "String"),
        ("if self.state not in ('go', 'on'): return", KEEPS, "''", "String"),
        ("if not 11.0 < self.state: return", KEEPS, "0.0", "Float64"),
        ("if self.state > 0 and self.state < 1: pass\n        else: return", KEEPS, "0.0", "Float64"),
        ("if self.state < 3: return", "self.state += 1", "0", "Bool"),
        ("if self.state < 3: return", "self.state = self.state + 1", "0", "Bool"),
        ("self.count += 1\n        if self.count % 5: return", "pass", "None", "Bool"),
        ("level = self.board.level()\n        if not (level > 5 and level < 10): return", "pass", "None", "Bool"),
        ("level = self.board.level()\n        if level != 'high' or level is None: return", "pass", "None", "Bool"),
        ("later = lambda: text_of(3)", "pass", "None", "Bool"),
        ("if self.board.voltage() < 11.0: return", "pass", "None", "Bool"),
        ("if self.state is not Mode.READY: return", "self.state = Mode.READY", "Mode.IDLE", "Bool"),
        ("if self.state != Mode.READY: return", "self.state = Mode(message.data)", "Mode.IDLE", "Float64"),
        ("if not self.get_parameter('on').value: return", "pass", "None", "Bool"),
        ("if not self.ready(): return", f"{KEEPS}\n    def ready(self): return self.state is True", "None", "Bool"),
        ("while not self.state: rclpy.spin_once(self)", KEEPS, "False", "Bool"),
        ("if self.state: return\n        self.wait()\n        if not self.state: return",
         f"{KEEPS}\n    def wait(self): self.state = self.board.read()", "False", "Bool"),
        ("if not self.state: return", "setattr(self, 'state', message.data)", "False", "Bool"),
        ("if not self.state: return", "helper.keep(self)", "False", "Bool"),
        ("try: self.board.read()\n        except board.Lost: return", "pass", "None", "Bool"),
        ("if len(self.state) < 2: return", "self.state.append(message)", "[]", "Bool"),
    ],
)  # fmt: skip
def test_a_gate_that_something_could_open_is_one(gate: str, permit: str, start: str, kind: str) -> None:
    text = _filled(gate, permit, start, kind).replace("import board\n", "import board\nimport helper\n")
    assert _status(text).does == ["publishes"]


@pytest.mark.parametrize(
    ("gate", "permit", "start", "kind"),
    [
        ("if not self.state: return", "pass", "False", "Bool"),
        ("if not self.state or self.board.is_free(): return", "self.heard = message.data", "False", "Bool"),
        ("if self.state in (None, True, False): return", KEEPS, "None", "Bool"),
        ("if self.state is None: return\n        if self.state: return\n        if not self.state: return", KEEPS, "None", "Bool"),
        ("if self.state is None or self.state.data in (True, False): return", "self.state = message", "None", "Bool"),
        ("if not self.state: return", "self.state = message.data != message.data", "False", "Bool"),
        ("if not self.state: return", "if message.data is None: self.state = True", "False", "Bool"),
        ("if not self.state: return", "if self.state: self.state = True", "False", "Bool"),
        ("if self.state == 'go' and self.state == 'on': pass\n        else: return", KEEPS, "''", "String"),
        ("if not (self.state < 0 and self.state > 1): return", KEEPS, "0.0", "Float64"),
        ("if self.state < 3: return", "pass", "0", "Bool"),
        ("if self.state < 3: return", "self.state += 0", "0", "Bool"),
        ("if self.state is not Mode.READY: return", "pass", "Mode.IDLE", "Bool"),
        ("if not self.ready(): return", f"{KEEPS}\n    def ready(self): return False", "None", "Bool"),
        ("if not self.ready(): return", f"{KEEPS}\n    def ready(self): return self.state not in (None, True, False)", "None", "Bool"),
        ("level = self.board.level()\n        if not (level > 10 and level < 5): return", "pass", "None", "Bool"),
        ("level = self.board.level()\n        if level <= 10 or level >= 5: return", "pass", "None", "Bool"),
        ("self.state = text_of(3)", "pass", "None", "Bool"),
        ("self.out.publish(String(data=text_of(3)))\n        return", "pass", "None", "Bool"),
        ("while True: time.sleep(1.0)", KEEPS, "None", "Bool"),
        ("if not self.state: return", "pass\n    def never(self): self.state = True", "False", "Bool"),
    ],
)  # fmt: skip
def test_a_gate_that_nothing_could_open_is_none(gate: str, permit: str, start: str, kind: str) -> None:
    assert _status(_filled(gate, permit, start, kind)).does == []


WAITS = "if not self.board.is_free(): return\n        "


@pytest.mark.parametrize(
    "line",
    [
        "self.line = 'Report ' + 3",
        "self.line = 'Report ' + self.count; self.count += 1",
        "self.line = self.told(self.count)\n    def told(self, count): return 'Report ' + count",
        "self.line = 3 - 'three'",
        "self.line = -1 < 'three'",
        "self.line = [0.1, 0.2][2]",
        "words = ['a', 'b', 'c']; self.line = words[3]",
        "words = ('a', 'b', 'c'); self.line = words[-4]",
        "self.line = {'fine': 1}['good']",
        "table = {'fine': 1}; print(table); self.line = table['good']",
        "self.line = 'abc'[5]",
        "self.line = int('seven')",
        "import datetime; self.line = datetime.date(2026, 2, 30)",
        "from datetime import datetime as at; self.line = at.strptime('noon', format='%H')",
        "import uuid; self.line = str(uuid.UUID('robot'))",
        "import struct; self.line = len(struct.pack('B', 300))",
        "import json; self.line = json.loads('{')",
        "import re; self.line = re.compile('(')",
        "self.line = math.sqrt(-1)",
        "import queue; self.wheel = queue.Queue(); self.line = self.wheel.get()",
        "from queue import Queue; wheel = Queue(); print(wheel.get())",
        "self.ready = threading.Event(); self.ready.wait()",
        "from concurrent.futures import Future; self.line = Future(); print(self.line.result())",
        "self.line = None; self.line.append(1)",
        "self.line = None; self.line()",
        "message = None; message.data = 'well'",
        "self.line = self.told(1, 2)\n    def told(self, count): return count",
        "self.line = self.told()\n    def told(self, count): return count",
        "self.told()\n    def told(self): raise RuntimeError('not yet')",
        "for word in None: print(word)",
        "assert self.count > 5",
        "self.line = 1 / 0",
        "self.line = self.state.data.text",
        "self.line = self.state.text",
        "self.line = self.state + 1",
        "self.line = self.state.data + 1",
        "self.state.data.append(1)",
        "self.destroy_publisher(self.out)",
        "if self.count + 'a': pass",
        "return String(data='well' + 3)",
    ],
)
def test_nothing_comes_after_a_line_that_always_fails(line: str) -> None:
    """Whatever a node waits for: behind it, the line fails by its values."""
    text = _filled(WAITS + line, "pass", "String()", "String")
    method = text.find("\n    def told")
    if method > 0:  # what follows the gate stands in front of the other method
        end = text.index("\n        self.out.publish")
        text = text[:method] + text[end:].replace("\n\n\ndef main", text[method:end] + "\n\n\ndef main", 1)
    assert _status(text).does == [], text


ASKS = """self.client = self.create_client(SetBool, "/motors")
        request = SetBool.Request()
        future = self.client.call_async(request)
        LINE"""


@pytest.mark.parametrize(
    ("line", "does"),
    [
        ("self.client.call(request)", []),
        ("answer = self.client.call(request)", []),
        ("while not future.done(): pass", []),
        ("while rclpy.ok() and not future.done(): time.sleep(0.1)", []),
        ("self.client.call(request, timeout_sec=1.0)", ["publishes"]),
        ("while not future.done(): rclpy.spin_once(self)", ["publishes"]),
        ("while not future.done(): self.also()", ["publishes"]),
        ("while not future.done():\n            if self.count: break", ["publishes"]),
        ("from threading import Thread; self.client.call(request)", ["publishes"]),
        ("from rclpy.executors import MultiThreadedExecutor; self.client.call(request)", ["publishes"]),
        ("self.board.call(request)", ["publishes"]),
    ],
)
def test_who_waits_for_an_answer_in_the_only_thread_keeps_it_from_coming(line: str, does: list[str]) -> None:
    text = _filled(ASKS.replace("LINE", line)).replace("import threading\n", "")
    assert _status(text).does == does


@pytest.mark.parametrize(
    "line",
    [
        "self.line = 'Report ' + str(self.count)",
        "self.line = 'Report %d' % self.count",
        "self.line = 'Report ' * 3",
        "self.line = self.board.path() / 'file'",
        "self.line = self.told(self.count)\n    def told(self, count): return f'Report {count}'",
        "self.line = self.told('a')\n    def told(self, count, more=1): return 'Report ' + count",
        "self.line = self.told(3)\n    def told(self, count):\n        count = str(count)\n        return 'Report ' + count",
        "words = ['a', 'b', 'c']; words.append('d'); self.line = words[3]",
        "words = ['a', 'b', 'c']; self.board.fill(words); self.line = words[3]",
        "words = ['a', 'b', 'c']; self.line = words[self.count % len(words)]; self.count += 1",
        "words = ['a', 'b', 'c']; self.line = words[-3]",
        "words = ['a', 'b', 'c']; more = words; more += ['d']; self.line = words[3]",
        "table = {'fine': 1}; table['good'] = 2; self.line = table['good']",
        "table = {'fine': 1}; self.line = table.get('good')",
        "table = {'fine': 1}; table |= self.board.more(); self.line = table['good']",
        "try:\n            self.line = {'fine': 1}['good']\n        except KeyError:\n            self.line = None",
        "self.line = None; self.line = self.board.line(); self.line.append(1)",
        "self.state = None if self.state is None else self.state.data",
        "self.line = self.state and self.state.data",
        "message = None; message = String(); message.data = 'well'",
        "self.line = int('7')",
        "import datetime; self.line = datetime.date(2028, 2, 29)",
        "import datetime; self.line = datetime.date(self.board.year(), 2, 30)",
        "import datetime; self.line = datetime.date.of_another_python(2026, 2, 30)",
        "import datetime; self.line = datetime.sys.exit(3)",
        "import json; self.line = json.decoder.scanner.re.sys.exit(3)",
        "import time; self.line = time.sleep(0.5)",
        "import math; self.line = math.factorial(10 ** 9)",
        "import struct; self.line = len(struct.pack('999999999s', b''))",
        "import re; self.line = re.escape('(')",
        "import queue; self.wheel = queue.Queue(); self.wheel.put(3); self.line = self.wheel.get()",
        "import queue; self.wheel = queue.Queue(); self.board.on_turn(self.wheel.put); self.line = self.wheel.get()",
        "import queue; self.wheel = queue.Queue(); self.board.fill(self.wheel); self.line = self.wheel.get()",
        "import queue; self.wheel = queue.Queue(); self.board.attach(self); self.line = self.wheel.get()",
        "import queue; self.wheel = self.board.wheel(queue.Queue()); self.line = self.wheel.get()",
        "self.ready = threading.Event(); self.ready.wait(0.1)",
        "self.ready = threading.Event(); self.board.ready = self.ready; self.ready.wait()",
        "import contextlib; self.ready = {'a': 1}; self.line = self.ready.get('a')",
        "assert self.count >= 0",
        "self.line = 1 / self.board.count()",
        "self.line = self.state.data.upper()",
        "self.line = self.state.get_fields_and_field_types()",
        "self.destroy_publisher(self.out); self.out = self.create_publisher(String, '/robot/status', 10)",
        "self.told(3)\n    def told(self, count):\n        if count < 0: raise ValueError(count)",
        "self.line = [None, 1][1] + 1",
        "self.line = (lambda: 'a' + 1)",
        "for number in (1, 2): self.count = self.count + number",
    ],
)  # fmt: skip
def test_what_may_be_evaluated_fails_nowhere(line: str) -> None:
    text = _filled(WAITS + line, "pass", "String()", "String")
    method = text.find("\n    def told")
    if method > 0:
        end = text.index("\n        self.out.publish")
        text = text[:method] + text[end:].replace("\n\n\ndef main", text[method:end] + "\n\n\ndef main", 1)
    assert _status(text).does == ["publishes"], text


@pytest.mark.parametrize(
    ("files", "reads", "does"),
    [
        ({"msg/Permission.msg": "bool allowed  # or not\nfloat64[3] place\n"}, "allowed", ["publishes"]),
        ({"msg/Permission.msg": "bool allowed\nuint8 MOST=3\n"}, "MOST", ["publishes"]),
        ({"msg/Permission.msg": "bool allowed\n"}, "granted", []),
        ({"msg/Permission.msg": "string allowed\n"}, "allowed.granted", []),
        ({"msg/Permission.msg": "std_msgs/String allowed\n"}, "allowed.data", ["publishes"]),
        (
            {"msg/Permission.msg": "Inner allowed\n", "msg/Inner.msg": "bool yes\n"},
            "allowed.yes",
            ["publishes"],
        ),
        ({"msg/Permission.msg": "Inner allowed\n", "msg/Inner.msg": "bool yes\n"}, "allowed.no", []),
        ({"msg/Other.msg": "bool allowed\n"}, "allowed", []),
        ({}, "allowed", []),
        ({"idl/Permission.idl": "module x {};"}, "granted", ["publishes"]),
        ({"msg/Permission.msg.in": "bool @NAME@\n"}, "granted", ["publishes"]),
        ({"robot_interfaces/msg.py": "class Permission: ...\n"}, "granted", ["publishes"]),
    ],
)
def test_the_messages_of_a_hand_in_have_the_fields_that_it_gives_them(
    files: dict[str, str], reads: str, does: list[str], tmp_path: Path
) -> None:
    """They are not built here; what is wrong about them would be wrong anywhere."""
    for name, content in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(content)
    text = _filled("if not self.state: return", f"self.state = message.{reads}", "False", "Permission")
    text = text.replace("from std_msgs", "from robot_interfaces.msg import Permission\nfrom std_msgs")
    messages = own_messages([("robot_interfaces", tmp_path)])
    (end,) = [
        end
        for end in written_ends([PythonSource("status", "status.py", text)], messages=messages)[0]
        if end.topic == "/robot/status"
    ]
    assert end.does == does


def test_a_message_of_another_package_may_have_any_field() -> None:
    text = _filled("if not self.state: return", "self.state = message.granted", "False", "Permission")
    assert _status(text.replace("from std_msgs", "from acme.msg import Permission\nfrom std_msgs")).does == [
        "publishes"
    ]


OPENS = "if WHEN: self.state = True"
SHUT = "if not self.state: return"


@pytest.mark.parametrize(
    ("kind", "condition"),
    [
        ("Float64", "message.data * message.data < 0.0"),
        ("Float64", "message.data ** 2 < 0"),
        ("Float64", "abs(message.data) < 0"),
        ("Float64", "-abs(message.data) > 0"),
        ("Float64", "abs(message.data) + 1.0 < 0.5"),
        ("Float64", "math.sqrt(message.data) < 0"),
        ("Float64", "math.sin(message.data) > 1.5"),
        ("Float64", "math.hypot(message.data, 3.0) < 0"),
        ("Float64", "int(message.data) % 4 == 7"),
        ("Float64", "int(message.data) == 0.5"),
        ("Float64", "max(message.data, 3.0) < 2.0"),
        ("Float64", "message.data * message.data > 4 and message.data * message.data < 1"),
        ("UInt8", "message.data > 300"),
        ("UInt8", "message.data + 1 < 1"),
        ("Int8", "message.data == 200"),
        ("String", "len(message.data) < 0"),
        ("String", "len(message.data) == 2.5"),
        ("String", "len(message.data[:3]) > 3"),
        ("String", "message.data[:2] == 'long'"),
        ("String", "message.data.upper() == 'small'"),
        ("String", "message.data.lower() == 'Capital'"),
        ("String", "message.data.strip() == ' in blanks '"),
        ("String", "message.data.find('x') < -1"),
        ("String", "message.data.count('x') < 0"),
    ],
)
def test_a_condition_that_no_message_fulfils_opens_nothing(kind: str, condition: str) -> None:
    """Whatever comes, what is computed from it is never so."""
    for permit in (
        OPENS.replace("WHEN", condition),
        OPENS.replace("WHEN", f"{condition} and self.count == 0"),
        f"self.state = {condition}",
        f"held = message; self.state = {condition.replace('message', 'held')}",
    ):
        text = _filled(SHUT, permit, "False", kind).replace("Float64, String", f"Float64, String, {kind}")
        assert _status(text).does == [], condition


@pytest.mark.parametrize(
    ("kind", "condition"),
    [
        ("Float64", "message.data * message.data > 4.0"),
        ("Float64", "message.data * message.data <= 0.0"),
        ("Float64", "not message.data * message.data >= 0.0"),  # not-a-number is no number
        ("Float64", "message.data * self.board.read() < 0"),
        ("Float64", "abs(message.data) < 0.001"),
        ("Float64", "abs(message.data - 3.3) < 0.001"),
        ("Float64", "abs(message.data) - 1.0 < 0"),
        ("Float64", "math.sin(message.data) > 0.99"),
        ("Float64", "int(message.data) % 4 == 3"),
        ("Float64", "message.data % 1 == 0.5"),
        ("Float64", "min(message.data, 3.0) < 2.0"),
        ("Float64", "round(message.data) == -1"),
        ("Float64", "self.board.squared(message.data) < 0"),
        ("Float64", "self.board.read() > 5 and self.board.read() < 2"),
        ("UInt8", "message.data > 254"),
        ("Int32", "message.data > 0 and message.data < 3"),
        ("String", "len(message.data) > 99"),
        ("String", "message.data.upper() == 'GO'"),
        ("String", "message.data.strip() == 'go'"),
        ("String", "message.data.lower().upper() == 'GO'"),
        ("String", "message.data[:2] == 'go'"),
        ("String", "message.data[1:] == 'longer'"),
        ("String", "message.data + 'x' == 'gox'"),
        ("String", "'go' in message.data and 'on' in message.data"),
        ("String", "float(message.data) < 0"),
        ("String", "message.data.find('x') == -1"),
    ],
)
def test_a_condition_that_some_message_fulfils_opens_a_gate(kind: str, condition: str) -> None:
    permit = OPENS.replace("WHEN", condition)
    text = _filled(SHUT, permit, "False", kind).replace("Float64, String", f"Float64, String, {kind}")
    assert _status(text).does == ["publishes"], condition


@pytest.mark.parametrize(
    ("change", "gate", "does"),
    [
        ("self.count += 1", "if self.count < 0: return", ["publishes"]),
        ("self.count += 1", "if self.count >= 0: return", []),
        ("self.count += 1", "if self.count == 2.5: pass\n        else: return", []),
        ("self.count += 0.5", "if self.count == 2.5: pass\n        else: return", ["publishes"]),
        ("self.count -= 1", "if self.count >= 0: return", ["publishes"]),
        ("self.count = self.count + 1 if self.count < 9 else None", "if self.count is not None: return", ["publishes"]),
    ],
)  # fmt: skip
def test_a_number_that_is_counted_goes_where_it_is_counted(change: str, gate: str, does: list[str]) -> None:
    assert _status(_filled(f"{change}\n        {gate}")).does == does


def test_what_comes_behind_a_spin_is_no_work() -> None:
    """The program has had its life; what it says last is right beside what it has said before."""
    last = "node.out.publish(String())"
    assert _status(_filled("pass", end=last)).does == ["publishes"]
    assert _status(_filled("return", end=last)).does == []
    shut = _filled("return").replace("rclpy.spin(node)", f"rclpy.shutdown()\n    while True: {last}")
    assert _status(shut).does == []


@pytest.mark.parametrize(
    ("right", "other", "does"),
    [
        ('String(data="well")', '"well"', []),
        ('String(data="well")', 'f"well {self.count}"', []),
        ('String(data="well")', "Twist()", []),
        ('String(data="well")', "3", []),
        ('String(data="well")', "self.text()", ["publishes"]),
        ('String(data="well")', "board.text()", ["publishes"]),
        ("self.out = self", "out = self", []),
        ("self.out.publish", "print(self.out is None, self.timer.publish), self.count.publish", []),
        ("self.out.publish", "self.again = self.out; self.again.publish", ["publishes"]),
        ("self.out.publish", "self.again = self.out; print", []),
    ],
)
def test_what_is_published_and_on_what(right: str, other: str, does: list[str]) -> None:
    text = _filled("pass").replace(right, other, 1)
    text = text.replace("    def tick", "    def text(self): return self.made\n    def tick")
    text = text.replace('super().__init__("status")', 'super().__init__("status"); self.made = board.text()')
    assert _status(text).does == does


@pytest.mark.parametrize(
    ("timer", "never", "paces"),
    [
        ("self.create_timer(2.0, self.tick)", [], [2.0]),
        ("self.create_timer(timer_period_sec=7.0, callback=self.tick)", [], [7.0]),
        ("self.create_timer(7.0, lambda: self.tick())", [], [7.0]),
        ("self.create_timer(self.declare_parameter('period', 3.0).value * 2, self.tick)", [], [6.0]),
        ("self.create_timer(board.period(), self.tick)", [], []),
        ("board.every(2.0, self.tick)", [], []),
        ("self.tick()", ["repeats"], []),
        ("threading.Thread(target=self.tick).start()", ["repeats"], []),
        ("threading.Thread(target=self.loop).start()", [], []),
        ("board.ask().add_done_callback(self.tick)", ["repeats"], []),
        ("[self.tick() for _ in range(9)]", [], []),
    ],
)
def test_how_often_something_comes(timer: str, never: list[str], paces: list[float]) -> None:
    text = _filled("pass").replace("self.create_timer(2.0, self.tick)", timer)
    text = text.replace(
        "def tick(self)", "def loop(self):\n        while rclpy.ok(): self.tick()\n\n    def tick(self)"
    )
    told = _status(text)
    assert (told.does, told.never, told.paces) == (["publishes"], [*never, "varies"], paces)


@pytest.mark.parametrize(
    ("value", "never"),
    [
        ("0.5", ["varies"]),
        ("-0.5; twist.angular.z = 1.0", ["varies"]),
        ("0.5; self.twist = twist", []),
        ("0.5\n        if self.count: twist.linear.x = 0.1", []),
        ("0.5; twist = self.count or twist", []),
        ("0.5; self.out.publish(Twist())", []),
        ("board.speed()", []),
        ("float('nan')", ["finite"]),
        ("math.inf", ["finite"]),
        ("-math.inf", ["finite"]),
        ("1e999", ["finite", "varies"]),
        ("float('nan') if self.count else 0.5", []),
    ],
)
def test_what_a_message_holds(value: str, never: list[str]) -> None:
    text = _filled(f"twist = Twist(); twist.linear.x = {value}").replace(
        "create_publisher(String", "create_publisher(Twist"
    )
    assert _status(text.replace('String(data="well")', "twist")).never == never


@pytest.mark.parametrize(
    "gate",
    [
        f"if self.state == 1{'0' * 400}: return",
        f"if print(0x{'f' * 5000}): return",
        "if self.state == 2j: return",
        "if self.state == b'go': return",
        f"if {' and '.join(f'self.a{n} == self.b{n}' for n in range(40))}: return",
        f"if {'not ' * 40}self.state: return",
        "if self.state == self.board.state.state.state: return",
    ],
)
def test_whatever_a_condition_holds_is_read(gate: str) -> None:
    """Numbers without end, and more than can be tried, leave it open."""
    assert _status(_filled(gate, KEEPS, kind="String")).does == ["publishes"]


PLAIN = """
import rclpy
from std_msgs.msg import String


def hear(message):
    print(message.data)


def main():
    rclpy.init()
    node = rclpy.create_node("commands")
    taken = node.create_subscription(String, "/robot/command", hear, 10)
    THEN
    node.destroy_subscription(taken)
    node.destroy_node()
"""


@pytest.mark.parametrize(
    ("then", "does"),
    [
        ("pass", []),
        ("rclpy.spin(node)", ["reads", "logs"]),
        ("rclpy.spin_once(node)", ["reads", "logs"]),
        ("while rclpy.ok(): rclpy.spin_once(node)", ["reads", "logs"]),
        ("print('ready')", []),
        ("taken.topic", []),
    ],
)
def test_an_end_that_is_destroyed_at_once_is_not_used(then: str, does: list[str]) -> None:
    told = written_ends(
        [PythonSource("commands", "commands.py", PLAIN.replace("THEN", then))], words=("start",)
    )[0]
    assert [end.does for end in told] == [does]


@pytest.mark.parametrize(
    ("reads", "does"),
    [
        ("message.data", ["reads", "logs"]),
        ("message", ["reads", "logs"]),
        ("message.get_fields_and_field_types()", ["reads", "logs"]),
        ("message.text", []),
        ("message.data.text", []),
    ],
)
def test_what_no_message_has_is_not_read(reads: str, does: list[str]) -> None:
    text = PLAIN.replace("message.data", reads).replace("THEN", "rclpy.spin(node)")
    assert [
        end.does for end in written_ends([PythonSource("commands", "commands.py", text)], words=("start",))[0]
    ] == [does]
