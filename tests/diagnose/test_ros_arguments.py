"""Programs that read what ROS adds to their arguments: as they complain, and with what they are told to write."""

from __future__ import annotations

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


def test_a_word_that_nobody_added_is_told_as_before(tmp_path: Path) -> None:
    root = Files.right(NAME).put(NODE, f"{BEGIN}\n\ndef main():\n    parser.parse_args()\n").write(tmp_path)
    found = of_text("talker: error: unrecognized arguments: --foldr a --ros-args", root)
    assert "argument-unknown" not in [one.code for one in found]
