"""An attribute that hides a method, and a method that hides the one that it means to call; mended as is said."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text, of_workspace

NAME = NAMES[1]


def renamed(folder: Path, files: Files) -> Files:
    """Return the files with the fix of the only finding applied to the lines that it names."""
    (finding,) = (f for f in of_workspace(files.write(folder), None) if f.code == "callback-missing")
    new, old = re.match(r"write (\S+) instead of (\S+) on", finding.fix).groups()  # type: ignore[union-attr]
    path, _, first = finding.place.rpartition(":")
    lines = files.texts[path].split("\n")
    for number in map(
        int, (first, *re.findall(r"\d+", finding.fix.partition("line")[2].partition("line")[2]))
    ):
        lines[number - 1] = re.sub(rf"{old}\b", new, lines[number - 1])
    files.texts[path] = "\n".join(lines)
    return files


@pytest.mark.parametrize(
    ("made", "used"),
    [
        ("self.create_publisher(String, 'said', 10)", "self.say.publish(String(data=text))"),
        ("self.create_timer(1.0, self.CALLBACK)", "self.say.cancel()\n        print(text)"),
        ("0", "self.say += 1\n        print(text, self.say)"),
        ("None", "print(text)"),
    ],
)
def test_an_attribute_that_hides_a_method(tmp_path: Path, made: str, used: str) -> None:
    files = Files.right(NAME).change("node", "self.count = 0", f"self.count = 0\n        self.say = {made}")
    files.change("node", "        self.count += 1\n", "        self.count += 1\n        self.say('x')\n")
    files.change(
        "node", "    def CALLBACK(", f"    def say(self, text):\n        {used}\n\n    def CALLBACK("
    )
    assert "callback-missing" not in [
        f.code for f in of_workspace(renamed(tmp_path, files).write(tmp_path), None)
    ]


def test_one_that_takes_the_name_of_its_callback(tmp_path: Path) -> None:
    files = Files.right(NAME).change(
        "node",
        "self.count = 0",
        "self.count = 0\n        self.CALLBACK = self.create_timer(9.0, print)\n        self.create_timer(2.0, self.CALLBACK)",
    )
    assert of_workspace(renamed(tmp_path, files).write(tmp_path), None) == []


@pytest.mark.parametrize(
    "made",
    [
        "self.get_logger().info",
        "partial(self.say, 'more')",
        "lambda text: print(text)",
        "self.create_publisher(String, 'said', 10).publish",
        "self.create_timer(1.0, self.say)",
    ],
)
@pytest.mark.parametrize("kind", ["", ": object"])
def test_an_attribute_that_replaces_a_method_on_purpose(tmp_path: Path, made: str, kind: str) -> None:
    line = f"self.say{kind} = {made}"
    files = Files.right(NAME).change("node", "self.count = 0", f"self.count = 0\n        {line}")
    files.change("node", "import rclpy\n", "from functools import partial\nimport rclpy\n")
    files.change(
        "node", "    def CALLBACK(", "    def say(self, *text):\n        print(*text)\n\n    def CALLBACK("
    )
    assert "callback-missing" not in [f.code for f in of_workspace(files.write(tmp_path), None)]


@pytest.mark.parametrize(
    ("method", "call", "better"),
    [
        ("get_parameter(self, name)", "return self.get_parameter(name).value", "super().get_parameter(name)"),
        ("destroy_node(self)", "self.destroy_node()", "super().destroy_node()"),
        (
            "create_timer(self, period, callback)",
            "return self.create_timer(period / 2, callback)",
            "super().create_timer(period / 2, callback)",
        ),
    ],
)
def test_a_method_that_means_the_one_that_it_overrides(
    tmp_path: Path, method: str, call: str, better: str
) -> None:
    files = Files.right(NAME).change(
        "node", "    def CALLBACK(", f"    def {method}:\n        {call}\n\n    def CALLBACK("
    )
    root = files.write(tmp_path)
    path = next(path for path in root.rglob(f"{NAME.module}.py") if call in path.read_text())
    line = path.read_text().partition(call)[0].count("\n") + 1
    said = f'Traceback (most recent call last):\n  File "{path}", line {line}, in {method.partition("(")[0]}\n    {call}\n  [Previous line repeated 989 more times]\nRecursionError: maximum recursion depth exceeded\n'
    assert of_text(said, root)[0].fix.startswith(f"write {better} instead of self.")


def test_a_method_that_calls_itself_and_overrides_none(tmp_path: Path) -> None:
    files = Files.right(NAME).change(
        "node", "    def CALLBACK(", "    def more(self):\n        self.more()\n\n    def CALLBACK("
    )
    root = files.write(tmp_path)
    path = next(path for path in root.rglob(f"{NAME.module}.py") if "self.more" in path.read_text())
    line = path.read_text().partition("self.more")[0].count("\n") + 1
    said = f'Traceback (most recent call last):\n  File "{path}", line {line}, in more\n    self.more()\nRecursionError: maximum recursion depth exceeded\n'
    assert "super()" not in of_text(said, root)[0].fix


@pytest.mark.parametrize(
    ("methods", "calls", "begin"),
    [
        ("destroy_node(self):\n        print('off')\n        self.destroy_node()", "self.destroy_node()", "write super().destroy_node()"),
        ("get_logger(self):\n        print('off')\n        return self.get_logger()", "return self.get_logger()", "write super().get_logger()"),
        ("get_clock(self, *more):\n        print('off')\n        return self.get_clock(*more)", "return self.get_clock(*more)", "write super().get_clock(*more)"),
        ("more(self):\n        print('off')\n        self.less()\n\n    def less(self):\n        self.more()", "self.less();self.more()", "call another function"),
    ],
)  # fmt: skip
def test_where_calls_without_end_stop_at_last_is_no_cause(
    tmp_path: Path, methods: str, calls: str, begin: str
) -> None:
    files = Files.right(NAME).change("node", "    def CALLBACK(", f"    def {methods}\n\n    def CALLBACK(")
    root = files.write(tmp_path)
    path = next(path for path in root.rglob(f"{NAME.module}.py") if "print('off')" in path.read_text())
    rows = [line.strip() for line in path.read_text().splitlines()]
    frames = [
        f'  File "{path}", line {rows.index(call) + 1}, in it\n    {call}\n' for call in calls.split(";")
    ]
    off = "print('off')"
    last = f'  File "{path}", line {rows.index(off) + 1}, in it\n    {off}\n'
    said = f'Traceback (most recent call last):\n{"".join(frames * 3)}{last}  File "/usr/lib/python3.12/codecs.py", line 3, in it\n    look()\nRecursionError: maximum recursion depth exceeded\n'
    (found,) = of_text(said, root)
    assert found.place.endswith(f":{rows.index(calls.rsplit(';', maxsplit=1)[-1]) + 1}")
    assert found.fix.startswith(begin)


def test_only_the_calls_that_mean_the_hiding_method_are_renamed(tmp_path: Path) -> None:
    files = Files.right(NAME).change(
        "node",
        "    def CALLBACK",
        "    def create_timer(self):\n        self.more = self.create_timer(1.0, self.CALLBACK)\n\n    def CALLBACK",
    )
    files.change("node", "self.count = 0", "self.count = 0\n        self.create_timer()")
    finding, *others = [f for f in of_workspace(files.write(tmp_path), None) if "create_timer" in f.cause]
    assert others == []
    assert finding.cause.endswith("which needs at least 2 arguments, and which this one hides.")
    assert "its call on line 13, but not on lines 11 and 16, where the node's own is called" in finding.fix
