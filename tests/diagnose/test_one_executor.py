"""Several nodes of a program, of which only one is spun: the fix, applied as it is written, lets all of them run."""

from __future__ import annotations

import os
import re
import textwrap
from pathlib import Path

import pytest
from one_file import printed_by, sources_of

from ros2lab.diagnose.nodes.entrance_faults import entrance_faults
from ros2lab.diagnose.nodes.executors import several_threads
from ros2lab.diagnose.sources.entrance import Entrance

HEAD = """\
import os
import rclpy
import threading
from rclpy.node import Node
MORE

ticked = set()


class Singer(Node):
    def __init__(self, name):
        super().__init__(name)
        self.create_timer(0.05, self.tick)

    def tick(self):
        ticked.add(self.get_name())
        if len(ticked) > 1:
            print('both', flush=True)
            os._exit(0)


def main(args=None):
    rclpy.init(args=args)
LINES

if __name__ == '__main__':
    main()
"""
TWO = "alto = Singer('alto')\nbass = Singer('bass')\n"
MULTI = "from rclpy.executors import MultiThreadedExecutor"
SINGLE = "from rclpy.executors import SingleThreadedExecutor"
THREAD = "threading.Thread(target=rclpy.spin, args=({},)).start()\n"
WRONG = [
    ("", TWO + "rclpy.spin(alto)\nrclpy.spin(bass)"),
    (
        "",
        TWO + "try:\n    rclpy.spin(alto)\n    rclpy.spin(bass)\nfinally:\n    alto.destroy_node()",
    ),
    (
        "",
        "alto = Singer('alto')\nrclpy.spin(alto)\nalto.destroy_node()\nbass = Singer('bass')\nrclpy.spin(bass)",
    ),
    ("from rclpy import spin", TWO + "spin(alto)\nspin(bass)"),
    ("", "rclpy.spin(Singer('alto'))\nrclpy.spin(Singer('bass'))"),
    (MULTI, TWO + "ex = MultiThreadedExecutor()\nex.add_node(bass)\nrclpy.spin(alto)\nex.spin()"),
    (MULTI, TWO + "rclpy.spin(alto)\nex = MultiThreadedExecutor()\nex.add_node(bass)\nex.spin()"),
    (
        SINGLE,
        TWO
        + "e1 = SingleThreadedExecutor()\ne2 = SingleThreadedExecutor()\ne1.add_node(alto)\ne2.add_node(bass)\ne1.spin()\ne2.spin()",
    ),
    ("", "for singer in (Singer('alto'), Singer('bass')):\n    rclpy.spin(singer)"),
    ("", TWO + "rclpy.spin(alto)"),
    (SINGLE, TWO + "ex = SingleThreadedExecutor()\nex.add_node(alto)\nex.spin()"),
    (
        SINGLE,
        TWO
        + "ex = SingleThreadedExecutor()\nex.add_node(bass)\ntry:\n    while rclpy.ok():\n        ex.spin_once()\nfinally:\n    alto.destroy_node()",
    ),
    ("", TWO + THREAD.format("alto") + "rclpy.spin(bass)"),
    ("", TWO + THREAD.format("alto") + THREAD.format("bass")),
    ("", "for singer in (Singer('alto'), Singer('bass')):\n    " + THREAD.format("singer")),
]
RIGHT = [
    (SINGLE, TWO + "ex = SingleThreadedExecutor()\nex.add_node(alto)\nex.add_node(bass)\nex.spin()"),
    (
        SINGLE,
        TWO
        + "for singer in (alto, bass):\n    threading.Thread(target=rclpy.spin, args=(singer, SingleThreadedExecutor())).start()",
    ),
    (SINGLE, TWO + "ex = SingleThreadedExecutor()\nlist(map(ex.add_node, (alto, bass)))\nex.spin()"),
    (
        SINGLE,
        TWO
        + "ex = SingleThreadedExecutor()\nother = SingleThreadedExecutor()\nex.add_node(alto)\nother.add_node(bass)\nthreading.Thread(target=other.spin).start()\nex.spin()",
    ),
    (
        SINGLE,
        "ex = SingleThreadedExecutor()\nbass = Node('bass')\nalto = Singer('alto')\nex.add_node(alto)\nex.spin()\nbass.destroy_node()",
    ),
    ("", TWO + "while rclpy.ok():\n    for singer in (alto, bass):\n        rclpy.spin_once(singer)"),
]


def told(folder: Path, more: str, lines: str) -> tuple[str, list[str]]:
    text = HEAD.replace("MORE", more).replace("LINES", textwrap.indent(lines, "    "))
    entrance = Entrance(sources_of(text, folder), "pk.node.main")
    findings = [*entrance_faults(entrance, ()), *several_threads(entrance)]
    return text, [finding.fix for finding in findings if finding.code in ("spin-missing", "not-spinning")]


def applied(text: str, fix: str) -> str:
    """Do what a fix says, to the letter."""
    lines = dict(enumerate(text.splitlines(), 1))

    def indented(number: int, *rows: str) -> str:
        margin = " " * (len(lines[number]) - len(lines[number].lstrip()))
        return "\n".join(margin + row for row in rows)

    top = re.search(r"with `([^`]+)` at the top", fix)
    changed = dict(lines)
    for rows, how, first, last in re.findall(
        r"((?:`[^`]+`(?:, | and )?)+) (instead of|above|below|below the loop, after|on) lines? (\d+)(?: to (\d+))?",
        fix,
    ):
        written, number = re.findall("`([^`]+)`", rows), int(first)
        if how == "on":
            changed[number] = re.sub(r"args=\(.*,\)(?=\))", written[0], changed[number])
        elif how == "instead of":
            changed[number] = indented(number, *written)
            changed |= dict.fromkeys(range(number + 1, int(last or first) + 1), "")
        elif how == "above":
            changed[number] = f"{indented(number, *written)}\n{changed[number]}"
        else:
            depth = number if how == "below" else number - 1
            changed[number] = f"{changed[number]}\n{indented(depth, *written)}"
    for number in map(int, re.findall(r"remove line (\d+)", fix)):
        changed[number] = ""
    for number, below in re.findall(r"move line (\d+) below line (\d+)", fix):
        changed[int(below)] += f"\n{changed.pop(int(number))}"
    return "\n".join(([top[1]] if top else []) + [changed[number] for number in sorted(changed)]) + "\n"


@pytest.mark.parametrize(("more", "lines"), WRONG)
def test_what_is_written_to_the_letter_spins_all_nodes(more: str, lines: str, tmp_path: Path) -> None:
    text, fixes = told(tmp_path, more, lines)
    path = tmp_path / "mended.py"
    path.write_text(applied(text, fixes[0]), encoding="utf-8")
    here = {**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    assert printed_by(path, environ=here).splitlines() == ["both"], fixes[0]


@pytest.mark.parametrize(("more", "lines"), RIGHT)
def test_nodes_that_all_run_are_no_alarm(more: str, lines: str, tmp_path: Path) -> None:
    assert told(tmp_path, more, lines)[1] == []


def test_a_node_that_a_thread_spins_is_not_spun_again(tmp_path: Path) -> None:
    lines = "alto = Singer('alto')\n" + THREAD.format("alto") + "rclpy.spin(alto)"
    assert "remove the thread on line 25" in told(tmp_path, "", lines)[1][0]
