"""Whatever stands in a student's files, it is looked at to the end: odd values and constructs, put in by chance."""

from __future__ import annotations

import ast
import random
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import net, of_text, of_workspace, rules
from ros2lab.diagnose.finding import UNKNOWN, Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.rules import text_faults
from ros2lab.diagnose.sources.calls import fitting
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.signatures import Parameter
from ros2lab.diagnose.sources.static_value import LARGEST, evaluate
from ros2lab.grading.evidence_json import plain
from ros2lab.grading.reading import files
from ros2lab.grading.reading.build_plan import plan_for
from ros2lab.grading.receiving.submission import Received, found_in

SEEDS = range(16)
VALUES = (
    f"0x{'f' * 5000}", f"1{'0' * 400}", f"-1{'0' * 400}", "10**400", "2**99999", "2j", "-2j", "1e999", "b'/robot/x'",
    "...", "None", "True", "not 1j", "~2", "-b'x'", "'\\ud800'", "''", "'\\0'", "'/' * 10**9", "f'{f\"{2j}\"!r:>{w}}'",
    "'%*d' % (1, 2)", "'{0.a}'.format(1)", "*[1, 2]", "*args", "**{'a': 1j}", "(y := 5)", "lambda *a, **k: 0", "{1: 2j}",
    "{*a}", "[*[], *()]", "x[1:2, ...]", "1 if 2 else 3j", "1 < 2 < 3j", "1 // 0", "'' % 1", "'a' @ b''", "Twist(linear=1j)",
    "String(data=b'x')", "String(1, 2)", "QoSProfile(depth=2j)", "(yield)", "'a'.b", "1()", "[][0]", "(" * 30 + "1" + ",)" * 30,
    "1" + " + 1" * 180, "x" + ".y" * 30, "x" + "()" * 30, "-" * 50 + "1", "[" * 300,
)  # fmt: skip
STATEMENTS = (
    "match x:\n    case {'a': 2j, **r}: pass\n    case [1, *_] | b'x' | None: pass\n    case String(data='a'): pass",
    "for *a, b in 2j: pass", "with a as (b, *c), d as e.f[0]: pass", "try: pass\nexcept (A, 1j) as e: pass", "x: 2j = b'a'",
    "try: pass\nexcept* ValueError: pass", "del x, y.z, a[0]", "from ... import *", "raise 1j from b''", "assert 2j, b''",
    "class A(A, metaclass=2j): pass", "class A(B): pass\nclass B(A): pass", "class Node(f()): pass", "a = b = c = a", "[a, *b] = 1",
    "@2j\ndef main(): pass", "def main(*, args): pass", "main = 5", "def f(a, /, *, b=1j, **c): pass", "a.b @= b''", "while 1j: break",
    "async def f():\n    async for x in await y: pass", "self.declare_parameters('', [(1j, 2), 3, (), ('a',), ('b', 10**400)])",
    "setup(entry_points=2j, data_files=[(1, 2j)], packages=5, **{'name': 1j})", "\x00", "\ud800", "x = '", "# coding: nope", "type X = 2",
)  # fmt: skip
TEXTS = (
    "2j", f"1{'0' * 5000}", f"0x{'f' * 5000}", "!!binary aGk=", "!!python/name:x", "&a [*a]", "? {a: b}\n: c", "2026-01-01",
    ".nan", "\x00", "\ud800", "[" * 200, "<<: *x", "&#0;", "&foo;", "<x/>", "]]>", "<!DOCTYPE a [<!ENTITY b 'c'>]>", "", "\t", "$(eval '2j')",
    "$(", "1_000", "~", "{}",
)  # fmt: skip
NODE = """import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String
SPEED = {0}
class Talker(Node):
    def __init__(self):
        super().__init__('talker', {0})
        self.declare_parameter('speed', {0})
        self.pub = self.create_publisher(String, {0}, 10)
        self.vel = self.create_publisher(Twist, '/cmd_vel', {0})
        self.sub = self.create_subscription(String, '/robot/command', {0}, 10)
        self.timer = self.create_timer({0}, self.tick)
    def tick(self, *args):
        message = Twist()
        message.linear.x = {0}
        if message == {0} or message.linear.x > {0} > 2:
            self.get_logger().info('%d', {0})
        self.pub.publish(String(data={0}))
        self.vel.publish({0})
        print([{0}][SPEED], {0} + 'm', {{{0}}})
        assert {0}
"""


def _spoilt(name: str, text: str, chance: random.Random) -> str:
    """Return a file of which one value was replaced by an odd one, or into which an odd statement was put."""
    if not name.endswith(".py"):
        start, end = chance.choice(
            [match.span() for match in re.finditer(r"[^\s:<>=\"']+", text)] or [(0, 0)]
        )
        return text[:start] + chance.choice(TEXTS) + text[end:]
    lines = text.split("\n")
    if chance.random() < 0.4:
        at = chance.randrange(len(lines))
        indent = lines[at][: -len(lines[at].lstrip()) or None]
        lines[at:at] = [indent + line for line in chance.choice(STATEMENTS).split("\n")]
        return "\n".join(lines)
    values = [
        node
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.expr) and node.lineno == node.end_lineno
    ]
    if values:
        value = chance.choice(values)
        line = lines[value.lineno - 1].encode()
        new = chance.choice(VALUES).encode("utf-8", "surrogatepass")
        lines[value.lineno - 1] = (line[: value.col_offset] + new + line[value.end_col_offset :]).decode(
            "utf-8", "surrogatepass"
        )
    return "\n".join(lines)


@pytest.mark.parametrize("seed", SEEDS)
def test_no_odd_code_ends_a_diagnosis_or_the_reading_of_a_submission(seed: int, tmp_path: Path) -> None:
    chance = random.Random(seed)
    root = right_workspace().write(tmp_path)
    kinds = (".py", ".xml", ".yaml", ".cfg")
    path = chance.choice(sorted(path for path in root.rglob("*") if path.suffix in kinds))
    spoilt = _spoilt(path.name, path.read_text(), chance)
    path.write_bytes(spoilt.encode("utf-8", "surrogatepass"))
    assert not [one for one in Look(root).findings if isinstance(one, net.Unjudged)]
    submission = found_in(tmp_path, Received([], {}))
    if submission.package:
        plain(plan_for(tmp_path, submission, submission.package), "plan")
    facts = files.look(tmp_path, submission)
    assert not facts.unread
    plain(facts, "files")


@pytest.mark.parametrize("value", VALUES)
def test_no_value_ends_a_diagnosis(value: str) -> None:
    """It stands wherever a value may: as a period, a topic, a field, a default, in sums and comparisons."""
    findings = text_faults(PythonSource("talker", "talker.py", NODE.format(value)))
    assert not [one for one in findings if isinstance(one, net.Unjudged)]


@pytest.mark.parametrize("value", ["2j", "1e999", "b'x'", "None", "('a', 1)", f"0x{'f' * 5000}", "1", "..."])
def test_no_value_in_setup_ends_a_diagnosis(value: str, tmp_path: Path) -> None:
    """It stands for a name, a key, and whatever setuptools takes."""
    root = right_workspace().write(tmp_path)
    setup = next(root.rglob("setup.py"))
    text = setup.read_text().replace("'console_scripts'", value).replace('"console_scripts"', value)
    more = f"package_data={{{value}: {value}}}, extras_require={{{value}: [{value}]}}, data_files=[({value}, [{value}])]"
    for changed in (
        text,
        f"{text}\nsetup(name={value}, packages=[{value}], {more}, scripts={value}, version={value})\n",
    ):
        setup.write_text(changed)
        assert not [one for one in Look(root).findings if isinstance(one, net.Unjudged)]


@pytest.mark.parametrize(
    ("value", "wanted", "is_taken"),
    [
        ("b'/robot/x'", "str", False),
        ("2j", "float", False),
        ("-2j", "float | None", False),
        ("b'x'", "bytes", True),
        ("2j", "complex", True),
        ("2j", "Any", True),
        ("'/robot/x'", "str", True),
        ("f'/robot/{x}'", "str", True),
        ("2", "float", True),
        ("...", "str", True),  # nobody knows
    ],
)
def test_a_value_of_whatever_kind_is_taken_by_what_it_is_for(value: str, wanted: str, is_taken: bool) -> None:
    parameter = Parameter("one", wanted, "", is_positional=True)
    assert parameter.takes(ast.parse(value, mode="eval").body) is is_taken


def test_bytes_for_a_text_become_the_text_in_them() -> None:
    assert fitting("str", ast.parse("b'/robot/x'", mode="eval").body) == "'/robot/x'"


def test_numbers_stay_what_they_are_as_far_as_one_can_compute_with_them() -> None:
    for text in ("7", "2**62", "-5", str(2**1000), "True", "1.5"):
        node = PythonSource("a", "a.py", f"x = {text}").tree.body[0]
        assert isinstance(node, ast.Assign)
        if "**" not in text:
            assert evaluate(node.value, {}, {}) == ast.literal_eval(text)
    huge = PythonSource("a", "a.py", f"x = 0x{'f' * 5000}").constants["x"]
    assert huge == LARGEST
    assert float(LARGEST) > 1e300
    assert ast.unparse(ast.Constant(LARGEST))
    product = ast.parse(f"{LARGEST} * {LARGEST}", mode="eval").body
    assert evaluate(product, {}, {}) == LARGEST


def _failing(*_: object) -> Iterator[Finding]:
    yield Finding("period", "This was found before it failed.")
    raise KeyError("complex")


def test_a_rule_that_fails_costs_its_own_findings_and_no_others(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    root = right_workspace().change("node", "import rclpy\n", "import rclpyy\n").write(tmp_path)
    before = of_workspace(root)
    assert before
    monkeypatch.delenv(net.STRICT)
    monkeypatch.setattr(rules, "node_faults", _failing)
    after = of_workspace(root)
    said = [one for one in after if isinstance(one, net.Unjudged)]
    assert [one.code for one in said] == [UNKNOWN]
    assert "KeyError, test_odd_code.py" in said[0].cause
    assert "not the code's fault" in said[0].cause
    assert {one.code for one in before} <= {one.code for one in after}
    assert any(one.cause == "This was found before it failed." for one in after)


def test_the_tests_see_a_rule_that_fails(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    root = right_workspace().write(tmp_path)
    monkeypatch.setattr(rules, "node_faults", _failing)
    with pytest.raises(KeyError):
        of_workspace(root)


def test_an_explanation_that_fails_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(net.STRICT)
    monkeypatch.setattr("ros2lab.diagnose.explaining.explanation.read_error", _broken)
    (said,) = of_text("NameError: name 'x' is not defined")
    assert isinstance(said, net.Unjudged)


def _broken(_: str) -> None:
    raise ZeroDivisionError
