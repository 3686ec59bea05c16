"""What a print says, said by a logger: the text that is told is the text that was printed."""

from __future__ import annotations

import ast
import contextlib
import io
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.launching.logged import as_logged
from ros2lab.diagnose.sources.python_source import PythonSource

PRINTS = [
    "print('tic', self.n, flush=True)",
    "print('tic' if self.n % 2 else 'tac', self.n)",
    "print(self.n)",
    "print(f'{self.n:.2f} m')",
    "print(f'{self.n:.2f}', 'm', sep='')",
    "print('a', 1, {'b': 2}['b'], end='')",
    "print('braces {}', self.n)",
    "print(*self.rest, self.n, sep=', ')",
    "print('it' \"'s\", self.rest['x' == 'y'])",
    "print('done')",
]


class Node:
    """A node whose logger prints what it is given."""

    n, rest = 3, (1, 2)

    def get_logger(self) -> Node:
        return self

    def info(self, text: str) -> None:
        assert isinstance(text, str)
        print(text, end="")


@pytest.mark.parametrize("line", PRINTS)
def test_a_logger_says_what_was_printed(line: str) -> None:
    source = PythonSource("a", "a.py", f"class A:\n    def tic(self):\n        {line}\n")
    call = next(node for node in source.nodes if isinstance(node, ast.Call))
    said = []
    for text in (line, as_logged(call, source)):
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            exec(text, {"self": Node()})
        said.append(printed.getvalue().removesuffix("\n"))
    assert said[0] == said[1]


@pytest.mark.parametrize("text", ["'{} m'.format(self.n)", "'n ' + str(self.n)", "'%d m' % self.n"])
def test_a_text_that_is_put_together_stays_as_it_is(text: str) -> None:
    source = PythonSource("a", "a.py", f"class A:\n    def tic(self):\n        print({text})\n")
    assert as_logged(source.calls[0], source) == f"self.get_logger().info({text})"


def test_without_a_node_at_hand_nothing_is_logged() -> None:
    source = PythonSource("a", "a.py", "def main():\n    print('on')\n")
    assert as_logged(next(node for node in source.nodes if isinstance(node, ast.Call)), source) == ""


@pytest.mark.parametrize("more", ["", ", file=sys.stderr"])
def test_what_launch_does_not_show_is_told_as_it_is_to_be_written(tmp_path: Path, more: str) -> None:
    files = Files.right(NAMES[1])
    files.change("driver", "import rclpy\n", "import sys\nimport rclpy\n")
    files.change(
        "driver",
        "    def drive(self):\n",
        f"    def drive(self):\n        print('drive', 1, flush=True{more})\n",
    )
    found = [one for one in of_workspace(files.write(tmp_path)) if one.code == "never-shown"]
    if more:
        assert not found
    else:
        assert found[0].fix.startswith("write `self.get_logger().info(f'drive {1}')` instead of")
