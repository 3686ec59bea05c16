"""What is found of a syntax tree is looked for once, and no library is loaded only to be asked for a name."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from one_file import printed_by, sources_of
from workspace_files import NAMES, Files

from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.kept import kept
from ros2lab.diagnose.sources.python_source import PythonSource, children, walk

SLOW = ("launch", "launch_ros", "setuptools", "asyncio", "rclpy", "numpy")  # to load, or all of them
CODE = """\
import sys
from pathlib import Path
from ros2lab.diagnose import of_workspace
print([finding.code for finding in of_workspace(Path(sys.argv[1]))])
print([name for name in sys.argv[2:] if name in sys.modules])
"""
NODES = """\
from setuptools import find_packages as found


class Talker(Node):
    @property
    def speed(self, *, least=0.1): return [part for part in self.parts if part > least]


async def main(names=()):
    try:
        import launch
    except ImportError as error:
        print(f'{error!r:>{len(names)}}')
    match names:
        case [first, *_]: await (lambda: first)()
"""


def test_nodes_come_in_the_order_of_ast() -> None:
    """Of a file, of each of its nodes, and when they are asked again."""
    tree = ast.parse(NODES)
    for node in (*ast.walk(tree), *ast.walk(tree)):
        assert [*children(node)] == [*ast.iter_child_nodes(node)]
        assert [*walk(node)] == [*ast.walk(node)]


@pytest.mark.parametrize("found", [(), (1, 2), {}, 0, False, ""])
def test_a_node_is_looked_at_once(found: object) -> None:
    """Also where nothing is found."""
    asked = []

    @kept
    def find(node: ast.AST) -> object:
        asked.append(node)
        return found

    first, second = ast.parse("x"), ast.parse("x")
    assert [find(node) for node in (first, first, second, first)] == [found] * 4
    assert asked == [first, second]


def test_imports_are_found_wherever_a_statement_can_be() -> None:
    """In each kind of block; one that may not be run is known as such."""
    text = "\n".join(
        (
            "import a",
            "with a: import b",
            "for _ in a: import c",
            "else: import d",
            "try: import e",
            "except a: import f",
            "finally: import g",
            "match a:",
            "    case 1: import h",
            "class A:",
            "    def go(self): from . import i",
            "if a: import j",
        )
    )
    found = {imported.local: imported.is_guarded for imported in PythonSource("pk.m", "m.py", text).imports}
    assert found == {name: name in "efgj" for name in "abcdefghij"}


def test_what_a_file_gives_a_node_is_found_once(tmp_path: Path) -> None:
    """The names of its nodes, of which many rules ask."""
    sources = sources_of("import rclpy\n\nnode = rclpy.create_node('ears', namespace='hall')\n", tmp_path)
    assert sources.node_names.keys() == {"ears"}
    assert sources.full_names == {"ears": "/hall/ears"}
    assert sources.node_names is sources.node_names


@pytest.mark.parametrize("name", ["launch.actions.Node", "launch_ros.actions.SetParameter", "launch.Absent"])
def test_a_class_of_launch_is_no_module(name: str) -> None:
    """Although there is a module for it, in small letters."""
    assert not interfaces.is_module(name)
    assert interfaces.is_module("launch_ros.actions.set_parameter")


def test_libraries_are_read_and_not_loaded(tmp_path: Path) -> None:
    """Of a right workspace with a launch file and a setup.py: to load them takes longer than all rules."""
    root = Files.right(NAMES[0]).write(tmp_path / "ws")
    assert printed_by("-c", CODE, root, *SLOW).splitlines() == ["[]", "[]"]
