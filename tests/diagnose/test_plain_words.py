"""Which words of a command are names, and which are options or their values: ros2's own parser tells."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_text
from ros2lab.diagnose.explaining.usage import plain_words


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("ros2 topic echo --once /scan --field ranges", ["/scan"]),
        ("ros2 topic echo /scan --qos-reliability best_effort --csv", ["/scan"]),
        ("ros2 topic echo --field=ranges /scan sensor_msgs/msg/LaserScan", ["/scan", "sensor_msgs/msg/LaserScan"]),
        ("ros2 topic hz --window 10 /scan", ["/scan"]),
        ("ros2 topic pub -r 2 /speed std_msgs/msg/Float64 '{data: 1.0}'", ["/speed", "std_msgs/msg/Float64", "{data: 1.0}"]),
        ("ros2 param set --timeout 3 /node speed -1.5", ["/node", "speed", "-1.5"]),
    ],
)  # fmt: skip
def test_options_and_their_values_are_no_names(line: str, words: list[str]) -> None:
    assert plain_words(shlex.split(line), 2) == words


@pytest.mark.parametrize(
    "options", ["--once --field data", "--qos-reliability reliable", "--csv --field data", "--timeout 5"]
)
def test_a_right_command_with_options_behind_the_topic_is_no_fault(tmp_path: Path, options: str) -> None:
    root = right_workspace().write(tmp_path)
    text = f"$ ros2 topic echo /robot/report {options}\ndata: running\n---\n"
    assert not [finding for finding in of_text(text, root) if finding.code == "topic-type"]


def test_another_type_is_still_told_beside_options(tmp_path: Path) -> None:
    root = right_workspace().write(tmp_path)
    typed = "ros2 topic pub --rate 2 /robot/command std_msgs/msg/Int32 '{data: 1}'"
    found = of_text(f"$ {typed}\npublisher: beginning loop\n", root)
    assert "std_msgs/msg/String" in found[0].fix
