"""Parameters that are not declared where they are read, or are declared already: who is to declare them, and how."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text
from ros2lab.diagnose.finding import Finding

NAME = NAMES[1]
HEAD = """\
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter

RATE = 'rate'


class Base(Node):
    def __init__(self, name, **more):
        super().__init__(name, **more)
        self.declare_parameter('turn', 2.0)
    def first(self): return self.get_parameter(self.key).value

class Driver(Base):
"""
MAIN = """

def main():
    rclpy.init()
    rclpy.spin(Driver())
"""
PLAIN = "super().__init__('driver')\n"
OPTION = "automatically_declare_parameters_from_overrides"
BY_ITSELF = f"super().__init__('driver', {OPTION}=True)\n"


def first(init: str, methods: str, said: str, root: Path, *texts: str) -> Finding:
    """Explain an error that came through the lines with some texts, the innermost last."""
    body = f"    def __init__(self):\n{textwrap.indent(init, ' ' * 8)}\n{textwrap.indent(methods, ' ' * 4)}"
    source = f"{HEAD}{body}\n{MAIN}"
    files = Files.right(NAME)
    files.texts[files.path("driver")] = source
    files.write(root)
    path, rows = root / files.path("driver"), source.splitlines()
    numbers = [max(n for n, row in enumerate(rows, 1) if text in row) for text in texts]
    frames = "".join(f'  File "{path}", line {n}, in it\n    {rows[n - 1].strip()}\n' for n in numbers)
    inner = (
        '  File "/opt/ros/jazzy/lib/python3.12/site-packages/rclpy/node.py", line 690, in it\n    raise it\n'
    )
    return of_text(f"Traceback (most recent call last):\n{frames}{inner}rclpy.exceptions.{said}\n", root)[0]


UNKNOWN = "ParameterNotDeclaredException: Invalid access to undeclared parameter(s): {}"
HELPER = "def read(self, name, default):\n    value = self.get_parameter(name).value\n    return default if value is None else value\n"
LONE = "def read(self, name):\n    return self.get_parameter(name).value\n"


@pytest.mark.parametrize(
    ("init", "methods", "name", "texts", "cause", "fix"),
    [
        ("self.a = self.read('joints', [])\nself.b = self.read('speed', 1.0)", HELPER, "joints", ["'joints'", "get_parameter(name)"], "`self.read('joints', [])` (line", "write `self.declare_parameter(name, default)` above line"),
        ("self.a = self.read('joints')", LONE, "joints", ["'joints'", "get_parameter(name)"], "`self.read('joints')`", "write `self.declare_parameter(name, ...)` above line"),
        ("self.timer = self.create_timer(1.0, self.tick)", f"def tick(self):\n    print(self.read('speed'))\n\n{LONE}", "speed", ["'speed'", "get_parameter(name)"], "'speed'", "write `if not self.has_parameter(name):` above"),
        ("for one in ('kp', 'ki'):\n    print(self.get_parameter(one).value)", "", "kp", ["get_parameter(one)"], "'kp'", "write `self.declare_parameter(one, ...)` above"),
        ("for one, first in {'kp': 1.0}.items():\n    print(self.get_parameter(one).value)", "", "kp", ["get_parameter(one)"], "'kp'", "write `self.declare_parameter(one, first)` above"),
        ("self.rate = self.get_parameter(RATE).get_parameter_value().integer_value", "", "rate", ["get_parameter(RATE)"], "'rate'", "write `self.declare_parameter(RATE, 1)` above"),
        ("self.all = {one: self.get_parameter(one).value for one in ('kp', 'ki')}", "", "kp", ["self.all"], "'kp'", "write `for one in ('kp', 'ki'): self.declare_parameter(one, ...)` above"),
        ("self.key = 'rate'\nprint(self.first())", "", "rate", ["self.first()", "get_parameter(self.key)"], "'rate'", "write `self.declare_parameter(self.key, ...)` above"),
        ("held = Base\nheld.key = 'rate'\nprint(self.get_parameter(held.key).value)", "", "rate", ["get_parameter(held.key)"], "'rate'", "write `self.declare_parameter(held.key, ...)` above"),
        ("self.name = 'rate'\nprint(self.get_parameter(self.name).value)", "", "rate", ["get_parameter(self.name)"], "'rate'", "write `self.declare_parameter(self.name, ...)` above"),
        ("names = ['kp', 'ki']\nself.a, self.b = self.get_parameters(names)", "", "kp", ["get_parameters(names)"], "'kp'", "`self.declare_parameter('kp', ...)`, and `self.declare_parameter('ki', ...)` above"),
        ("self.a = self.gain('left')", "def gain(self, side):\n    return self.get_parameter(f'{side}.kp').value\n", "left.kp", ["'left'", ".kp"], "'left.kp'", "write `self.declare_parameter(f'{side}.kp', ...)` above"),
        ("self.timer = self.create_timer(self.get_parameter('cycle').value, self.tick)", "def tick(self):\n    pass\n", "cycle", ["'cycle'"], "'cycle'", "write `self.declare_parameter('cycle', 1.0)` above"),
        ("print(self.get_parameter('turns').value)", "", "turns", ["'turns'"], "Declared are: turn.", "write 'turn' if that is meant; else"),
        (f"{BY_ITSELF}self.a = self.get_parameter('speed').value", "", "speed", ["'speed'"], "(line 17) declares only what the node is given when it starts, and 'speed' was not given.", "or write `if not self.has_parameter('speed'):` above line 18, and `self.declare_parameter('speed', ...)` below it, indented"),
        (f"more = {{'{OPTION}': True}}\nsuper().__init__('driver', **more)\nself.a = self.get_parameter('speed').value", "", "speed", ["'speed'"], "(line 17) declares only what", "or write `if not self.has_parameter('speed'):`"),
        (f"super().__init__('driver', **dict({OPTION}=True))\nself.a = self.get_parameter('speed').value", "", "speed", ["'speed'"], "(line 17) declares only what", "or write `if not self.has_parameter('speed'):`"),
        (f"super().__init__('driver', {OPTION}=False)\nself.a = self.get_parameter('speed').value", "", "speed", ["'speed'"], "never declared", "write `self.declare_parameter('speed', ...)` above line 18"),
        ("self.set_parameters([Parameter('speed', value=2.0)])", "", "[]", ["set_parameters"], "'speed'", "write `self.declare_parameter('speed', "),
    ],
)  # fmt: skip
def test_a_parameter_is_declared_in_the_terms_of_the_line_that_reads_it(
    tmp_path: Path, *, init: str, methods: str, name: str, texts: list[str], cause: str, fix: str
) -> None:
    found = first(PLAIN + init, methods, UNKNOWN.format(name), tmp_path, *texts)
    assert found.code == "parameter-undeclared"
    assert cause in found.cause
    assert fix in found.fix


KNOWN = "ParameterAlreadyDeclaredException: Parameter(s) already declared: {}"
SPEED = "self.declare_parameter('speed', 1.0)"


@pytest.mark.parametrize(
    ("init", "methods", "names", "texts", "cause", "fix"),
    [
        (f"{BY_ITSELF}self.declare_parameters('', [\n    ('speed', 1.0),\n    ('name', 'a'),\n])", "", "['speed', 'name']", ["declare_parameters"], "declares speed and name again", "remove `automatically_declare_parameters_from_overrides=True` in line 16"),
        (f"{BY_ITSELF}{SPEED}", "", "['speed']", ["'speed'"], "automatically_declare_parameters_from_overrides (line 16)", "=True` in line 16"),
        (f"{BY_ITSELF}for name in ('speed', 'name'):\n    self.declare_parameter(name, 1.0)", "", "['speed']", ["parameter(name"], "declares speed again", "=True` in line 16"),
        (f"{PLAIN}self.declare_parameter('turn', 5.0)", "", "['turn']", ["'turn', 5"], "Base, the base class of Driver,", "remove this line, and change the default in line 11"),
        (f"{PLAIN}self.declare_parameter('use_sim_time', True)", "", "['use_sim_time']", ["use_sim_time"], "Every node declares use_sim_time", "remove this line"),
        (f"{PLAIN}self.a = self.declare_parameter('use_sim_time', True).value", "", "['use_sim_time']", ["use_sim_time"], "Every node", "write `self.get_parameter('use_sim_time')` instead of `self.declare_parameter('use_sim_time', True)`"),
        (f"{PLAIN}{SPEED}\nself.declare_parameter(\n    'speed',\n    2.0)", "", "['speed']", ["declare_parameter("], "Line 17 declares the parameter speed already", "remove lines 18 to 20"),
        (f"{PLAIN}self.a = self.read('speed', 1.0)\nself.b = self.read('speed', 2.0)", "def read(self, name, default):\n    return self.declare_parameter(name, default).value\n", "['speed']", ["'speed', 2", "parameter(name"], "Line 17 declares", "remove one of the two lines that ask for 'speed'"),
        (f"{PLAIN}for one in ('kp', 'ki', 'kp'):\n    self.declare_parameter(one, 1.0)", "", "['kp']", ["parameter(one"], "kp is twice in `('kp', 'ki', 'kp')`", "remove one 'kp' on line 17"),
        (f"{PLAIN}self.tick()\nself.tick()", f"def tick(self):\n    {SPEED}\n", "['speed']", ["self.tick()", "'speed'"], "tick() runs more than once", "move this line into __init__"),
    ],
)  # fmt: skip
def test_who_has_declared_a_parameter_before(
    tmp_path: Path, *, init: str, methods: str, names: str, texts: list[str], cause: str, fix: str
) -> None:
    found = first(init, methods, KNOWN.format(names), tmp_path, *texts)
    assert cause in found.cause
    assert fix in found.fix
