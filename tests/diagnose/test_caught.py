"""Tracebacks of what a program catches and prints itself are no fault; of what ends it they are."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

NAME = NAMES[1]
COUNT = "        self.count = 0\n"
PRINTS = "traceback.print_exc()"
READS = """
    def take(self, msg):
        try:
            self.speed = float(msg.data)
        except {handled}:
            {then}

    def count_on(self, msg):
        self.count += float(msg.data)
"""
AT_TAKE, AT_COUNT = "self.speed = float(msg.data)", "self.count += float(msg.data)"
END = "ValueError: could not convert string to float: 'fast'"


def printed(path: Path, *texts: str, end: str = END, head: str = "", process: str = "") -> str:
    """Return what Python prints of an exception that was raised in these lines of a file, the outermost first."""
    lines = path.read_text().splitlines()
    numbers = [next(n for n, line in enumerate(lines, 1) if line.strip() == text) for text in texts]
    frames = [f'  File "{path}", line {n}, in f\n    {text}' for n, text in zip(numbers, texts, strict=True)]
    whole = "\n".join([f"{head}Traceback (most recent call last):", *frames, end])
    return "\n".join(f"{process}{line}" for line in whole.splitlines()) + "\n"


def workspace(folder: Path, handled: str, then: str) -> tuple[Path, Path]:
    module = "PACKAGE/MODULE.py"
    files = Files.right(NAME).change(module, COUNT, COUNT + READS.format(handled=handled, then=then))
    files.change(module, "import rclpy\n", "import traceback\n\nimport rclpy\n")
    root = files.write(folder)
    return root, next(path for path in root.rglob("*.py") if "def take" in path.read_text())


def codes(text: str, root: Path) -> list[str]:
    return [one.code for one in of_text(text, root) if one.code != "never-called"]


def told(folder: Path, handled: str, then: str, *texts: str, **how: str) -> list[str]:
    root, path = workspace(folder, handled, then)
    return codes(printed(path, *texts, **how), root)


@pytest.mark.parametrize(
    ("handled", "then", "how", "is_caught"),
    [
        ("ValueError", PRINTS, {}, True),
        ("(KeyError, ValueError) as error", PRINTS, {}, True),
        ("ValueError", "self.get_logger().error(traceback.format_exc())", {"head": "[ERROR] [talker]: "}, True),
        ("Exception", PRINTS, {}, True),
        ("", PRINTS, {"process": "[talker-1] "}, True),
        ("ValueError", PRINTS, {"end": "json.decoder.JSONDecodeError: Expecting value: line 1 column 1 (char 0)"}, True),
        ("KeyError", PRINTS, {}, False),
        ("ValueError", "raise", {}, False),
        ("ValueError", "raise SystemExit(1)", {}, False),
        ("ValueError", "rclpy.shutdown()", {}, False),
        ("Exception", PRINTS, {"end": "NameError: name 'sped' is not defined"}, False),
        ("Exception", PRINTS, {"end": 'TypeError: can only concatenate str (not "int") to str'}, False),
        ("NameError", PRINTS, {"end": "NameError: name 'sped' is not defined"}, True),
    ],
)  # fmt: skip
def test_what_a_callback_catches_is_no_fault(
    tmp_path: Path, handled: str, then: str, how: dict[str, str], *, is_caught: bool
) -> None:
    assert bool(told(tmp_path, handled, then, AT_TAKE, **how)) is not is_caught


def test_what_nothing_catches_is_told(tmp_path: Path) -> None:
    """Also if it was raised where something catches another time, or passes through what runs the program."""
    assert told(tmp_path / "a", "ValueError", PRINTS, AT_COUNT)
    assert told(tmp_path / "b", "ValueError", PRINTS, "rclpy.spin(node)", AT_TAKE)
    assert told(tmp_path / "c", "ValueError", PRINTS, AT_COUNT, AT_TAKE)


def test_of_several_the_last_decides(tmp_path: Path) -> None:
    """What is handled when another one ends the program belongs to it; of two that are caught none is told."""
    during = "\nDuring handling of the above exception, another exception occurred:\n\n"
    for number, (last, is_told) in enumerate(((AT_COUNT, True), (AT_TAKE, False))):
        root, path = workspace(tmp_path / str(number), "ValueError", PRINTS)
        text = f"{printed(path, AT_TAKE)}{during}{printed(path, last)}"
        assert bool(codes(text, root)) == is_told
