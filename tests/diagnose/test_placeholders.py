"""Texts that show the place of a value instead of the value, and such as are right."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from ros2lab.diagnose.code.placeholders import placeholder_faults, regrouped, repeated
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.python_source import read_source

NODE = """\
class Counter(Node):
    def other(self, place):
        for number in range(3):
            print(number, place)

    def tick(self, msg):
        self.count, name = 0, 'robot'
        LINE
"""


def told(line: str, folder: Path) -> list[Finding]:
    path = folder / "counter.py"
    path.write_text(NODE.replace("LINE", line), encoding="utf-8")
    return [*placeholder_faults(read_source(path, "pk.counter", "counter.py"))]


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("msg.data = 'at {self.count}'", "write f before the quote"),
        ("print('{name} is here')", "write f before the quote"),
        ("msg.data = f'at {{self.count}}'", "write {self.count} instead of {{self.count}}"),
        ("self.get_logger().info(f'{name}: {{msg.data}}')", "write {msg.data} instead of {{msg.data}}"),
        ("msg.data = f'{{name}} at {{self.count}}'", "write {name} instead of {{name}}"),
        ("print(f'{{self.count}} of {name}')", "write {self.count} instead of {{self.count}}"),
        ("msg.data = 'at {}'", "the value's name in braces instead of {}"),
        ("self.get_logger().info('at %d')", "instead of %d"),
        ("print('at {:.2f} m')", "instead of {:.2f}"),
        ("self.create_publisher(String, '/colony/{name}/at', 10)", "write f before the quote"),
        ("self.create_service(Trigger, '{self.count}_go', self.go)", "write f before the quote"),
        ("self.declare_parameter('{name}.speed', 1.0)", "write f before the quote"),
        ("Header(frame_id='{name}/base')", "write f before the quote"),
        ("self.pub.publish(String(data='speed: %.1f'))", "instead of %.1f"),
    ],
)
def test_a_place_that_nothing_fills_is_told(tmp_path: Path, line: str, fix: str) -> None:
    (found,) = told(line, tmp_path)
    assert found.code == "text-not-filled"
    assert fix in found.fix


@pytest.mark.parametrize(
    "line",
    [
        "msg.data = f'at {self.count}'",
        "msg.data = 'at {}'.format(self.count)",
        "msg.data = 'at %d' % self.count",
        "print('at %d' % self.count)",
        "print('100 % sure, 5%')",
        "msg.data = f'{{\"count\": {self.count}}}'",
        "print(f'{{literal}} {name}')",
        "print('{ }')",
        "node = self; self.create_publisher(String, '{node}/at', 10)",
        "ns = '/a'; topic = '/{ns}/at'",
        "self.create_publisher(String, f'/{name}/at', 10)",
        "run(['git', f'{name}^{{name}}'])",
        "self.text = 'HEAD^{name}'",
        "shell('echo ${name}')",
        "print('echo ${name}')",
        "self.text = r'\\frac{name}'",
        "fill('{name} is here')",
        "pattern = '%d'",
        "self.topic = 'robot_{}'",
        "msg.data = '{}' if name else ''",
        "print('set {1, 2}')",
        "msg.data = f'at {{place}}'",  # of another function
        "print('at {number}')",
        "self.page = f'https://{{name}}.org/{{z}}/{{place}}.png'",
        "self.page = f'.box {{color: {name}}} #{{name}}'",
        "self.page = f'{{name}} is {name}'",
        "self.text = f'{name}: {{name, msg}}'",
    ],
)
def test_what_is_filled_or_means_itself_is_left_alone(tmp_path: Path, line: str) -> None:
    assert told(line, tmp_path) == []


@pytest.mark.parametrize(
    ("written", "better"),
    [
        ("'at %i degrees' % 0.5 * n", "'at %i degrees' % (0.5 * n)"),
        ("'%s m' % d * 100", "'%s m' % (d * 100)"),
        ("'%d' % 5 * n", "'%d' % (5 * n)"),
        ("'%s' % '#' * n", ""),
        ("'%+d' % n * 2", ""),
        ("'beep %d ' % n * 3", ""),
        ("'at %d m' % (n * 3)", ""),
        ("'at %d, %d' % (n, m) * 2", ""),
    ],
)
def test_a_number_that_is_multiplied_after_it_was_put_in_a_text(
    tmp_path: Path, written: str, better: str
) -> None:
    path = tmp_path / "a.py"
    path.write_text(f"x = {written}\n", encoding="utf-8")
    source = read_source(path, "a", "a.py")
    found = [
        fault for node in source.nodes if isinstance(node, ast.BinOp) for fault in repeated(source, node)
    ]
    assert [fault.fix for fault in found] == ([f"write `{better}`"] if better else [])


@pytest.mark.parametrize(
    ("written", "better"),
    [
        ("'at %d' % n + 1", "'at %d' % (n + 1)"),
        ("'at %.1f' % n / 2 - k", "'at %.1f' % (n / 2 - k)"),
        ("'%d, %d' % n, m", "'%d, %d' % (n, m)"),
        ("log('%d, %d' % n, m)", "'%d, %d' % (n, m)"),
        ("'at %d' % n + ' m'", ""),
        ("'at %d' % n", ""),
        ("log('at %d' % n)", ""),
    ],
)
def test_what_was_meant_to_stand_in_a_text(written: str, better: str) -> None:
    assert regrouped(ast.parse(written, mode="eval").body) == better
