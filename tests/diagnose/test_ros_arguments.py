"""Programs that read what ROS adds to their arguments: as they complain, and with what they are told to write."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from one_file import printed_by
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

NAME = NAMES[1]
NODE = f"{NAME.package}/{NAME.module}.py"
BEGIN = "import argparse\nimport getopt\nimport sys\n\nimport rclpy\n\nparser = argparse.ArgumentParser()\nparser.add_argument('--fps', type=float, default=5.0)\nparser.add_argument('-r', type=int)\n"
READINGS = {
    "argparse": ("OPTIONS", "parser.parse_args()"),
    "with a parser in a call": ("OPTIONS", "argparse.ArgumentParser(allow_abbrev=False).parse_args()"),
    "getopt": ("getopt.getopt(OPTIONS, '', ['fps='])", "sys.argv[1:]"),
    "the first": ("int(OPTIONS)", "sys.argv[1]"),
    "the last": ("float(OPTIONS)", "sys.argv[-1]"),
}


@pytest.mark.parametrize("added", [["--ros-args"], ["--ros-args", "-p", "speed:=1.0"]])
@pytest.mark.parametrize(("reading", "whole"), READINGS.values(), ids=READINGS)
def test_what_reads_only_its_own_part_is_told(
    tmp_path: Path, reading: str, whole: str, added: list[str]
) -> None:
    main = f"def main():\n    {reading}\n    rclpy.init()\n"
    text = f"{BEGIN}\n\n{main}\n\nif __name__ == '__main__':\n    main()\n"
    root = Files.right(NAME).put(NODE, text.replace("OPTIONS", whole)).write(tmp_path)
    path = root / "src" / NAME.package / NODE
    (told, *_) = of_text(f"$ ros2 launch a b.launch.py\n{printed_by(path, *added)}", root)
    assert told.code == "argument-unknown"
    assert told.place.endswith(f"{path.name}:{text[: text.index('OPTIONS')].count(chr(10)) + 1}")
    path.write_text(text.replace("OPTIONS", told.fix.split("`")[1]))
    own = (
        []
        if "allow_abbrev" in whole
        else ["2"]
        if "[-1]" in whole or whole == "sys.argv[1]"
        else ["--fps", "2"]
    )
    assert "rror" not in printed_by(path, *own, *added)


COUNTED = {
    "on one line": ["print(float(ALL[1]) if len(ALL) > 1 else 1.5)"],
    "the last": ["print(float(ALL[-1]) if len(ALL) > 1 else 1.5)"],
    "on two lines": ["if len(ALL) >= 2:", "    print(float(ALL[1]))"],
    "in a loop": ["n = 1", "while n < len(ALL):", "    print(float(ALL[n]))", "    n += 1"],
    "two": ["if len(ALL) >= 3:", "    print(float(ALL[1]))", "    print(float(ALL[2]))", "elif len(ALL) >= 2:", "    print(float(ALL[-1]))"],
    "no count": ["try:", "    print(float(ALL[1]), float(ALL[2]))", "except IndexError:", "    print('none')"],
}  # fmt: skip


@pytest.mark.parametrize("own", [[], ["2"]])
@pytest.mark.parametrize("name", ["sys.argv", "argv"])
@pytest.mark.parametrize("rows", COUNTED.values(), ids=COUNTED)
def test_what_is_counted_is_what_is_taken(tmp_path: Path, rows: list[str], name: str, own: list[str]) -> None:
    """The told lines are written as they are told, and rclpy still gets all arguments."""
    body = [f"rclpy.init(args={name})", *(row.replace("ALL", name) for row in rows)]
    lines = ["import sys", "from sys import argv", "import rclpy", "", "", "def main():"]
    lines += [*(f"    {row}" for row in body), "", "", "main()"]
    root = Files.right(NAME).put(NODE, "\n".join(lines)).write(tmp_path)
    path, added = root / "src" / NAME.package / NODE, ["--ros-args", "-p", "speed:=1.0"]
    (told, *_) = of_text(f"$ ros2 launch a b.launch.py\n{printed_by(path, *added)}", root)
    assert told.code == "argument-unknown"
    _, once, _, short, _, whole, where = told.fix.split("`")
    numbers = [int(number) for number in re.findall(r"\d+", where)]
    for number in numbers:
        lines[number - 1] = lines[number - 1].replace(whole, short)
    assert sum("rclpy.init(args=" in lines[number - 1] for number in numbers) == 0
    lines.insert(int(re.search(r"above line (\d+)", told.fix)[1]) - 1, f"    {once}")  # type: ignore[index]
    path.write_text("\n".join(lines))
    assert "rror" not in printed_by(path, *own, *added)


def test_a_word_that_nobody_added_is_told_as_before(tmp_path: Path) -> None:
    root = Files.right(NAME).put(NODE, f"{BEGIN}\n\ndef main():\n    parser.parse_args()\n").write(tmp_path)
    found = of_text("talker: error: unrecognized arguments: --foldr a --ros-args", root)
    assert "argument-unknown" not in [one.code for one in found]
