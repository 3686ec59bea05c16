"""Callbacks that wait for what only another callback of the same thread gives."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.nodes.life_faults import life_faults

HEAD = """\
import queue
import threading
from concurrent.futures import Future

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger


class Printer(Node):
    def __init__(self):
        super().__init__('printer')
        self.flag = False
        self.held = MADE
        FIRST
        self.create_subscription(String, 'labels', self.on_label, 10)
        self.create_timer(1.0, self.tick)
        self.create_service(Trigger, 'go', self.serve)

    def on_label(self, msg):
        GIVEN

"""
TICK = "    def tick(self):\n{}\n\n    def serve(self, request, response):\n        return response\n"
SERVE = "    def tick(self):\n        pass\n\n    def serve(self, request, response):\n{}\n        return response\n"
TAIL = "\n    def step(self):\n        self.held.get()\n\n\ndef main():\n    rclpy.init()\n    rclpy.spin(Printer())\n"
QUEUE, PUT = "queue.Queue()", "self.held.put(msg.data)"
SOLE = "MutuallyExclusiveCallbackGroup()"


def told(body: str, made: str = QUEUE, given: str = PUT, first: str = "pass", more: str = TICK) -> str:
    text = HEAD.replace("MADE", made).replace("GIVEN", given).replace("FIRST", first)
    text += more.format(textwrap.indent(body, " " * 8)) + (
        TAIL if "step" in body else TAIL[TAIL.index("\n\ndef") :]
    )
    return text


def threaded(body: str, mine: str = "", other: str = "", **parts: str) -> str:
    """Return a node that several threads spin, with a callback group of one's own for either callback."""
    text = told(body, **parts).replace("self.tick)", f"self.tick{mine})").replace(", 10)", f", 10{other})")
    return text.replace("rclpy.spin(Printer())", "MultiThreadedExecutor().spin()")


def found(text: str, folder: Path) -> list[tuple[str, str]]:
    faults = life_faults(sources_of(text, folder), None)
    return [(one.cause, one.fix) for one in faults if "once it waits" in one.cause]


@pytest.mark.parametrize(
    ("text", "fix"),
    [
        (told("text = self.held.get()\nprint(text)"), "write `if self.held.empty(): return` above line 26"),
        (told("text = self.held.get(block=True)"), "write `if self.held.empty(): return`"),
        (told("self.step()"), "do the work that needs self.held in on_label()"),
        (told("self.held.wait()", "threading.Event()", "self.held.set()", more=SERVE), "do the work that needs self.held in on_label()"),
        (told("self.held.wait()\nself.held.clear()", "threading.Event()", "self.held.set()"), "write `if not self.held.is_set(): return`"),
        (told("self.held.acquire()", "threading.Semaphore(0)", "self.held.release()"), "do the work"),
        (told("print(self.held.result())", "Future()", "self.held.set_result(1)"), "write `if not self.held.done(): return`"),
        (told("with self.held:\n    self.held.wait()", "threading.Condition()", "with self.held: self.held.notify()"), "do the work"),
        (told("while not self.flag:\n    pass", given="self.flag = True"), "do the work that needs self.flag in on_label()"),
        (told("while not self.flag:\n    self.get_logger().info('no')", given="self.flag = True"), "do the work"),
        (told("while not self.held:\n    pass", "[]", "self.held.append(msg.data)"), "do the work that needs self.held in on_label()"),
        (told("while len(self.held) < 3:\n    pass", "[]", "self.held.append(msg.data)"), "do the work"),
        (told("while not self.held.is_set():\n    pass", "threading.Event()", "self.held.set()"), "do the work"),
        (threaded("while not self.flag:\n    pass", given="self.flag = True"), "write `self.create_timer(1.0, self.tick, callback_group=MutuallyExclusiveCallbackGroup())`"),
        (threaded("self.held.get()", ", self.own", ", callback_group=self.own", first=f"self.own = {SOLE}"), "write `self.create_timer(1.0, self.tick, callback_group=MutuallyExclusiveCallbackGroup())`"),
        (threaded("self.held.get()", ", self.default_callback_group"), "write `self.create_timer(1.0, self.tick, callback_group=MutuallyExclusiveCallbackGroup())`"),
        (threaded("self.held.wait()", made="threading.Event()", given="self.held.set()"), "write `self.create_timer("),
    ],
)  # fmt: skip
def test_what_only_another_callback_gives_is_waited_for_in_vain(tmp_path: Path, text: str, fix: str) -> None:
    ((cause, how),) = found(text, tmp_path)
    assert "which only on_label() changes" in cause
    assert how.startswith(fix)


@pytest.mark.parametrize(
    "text",
    [
        told("text = self.held.get_nowait()"),
        told("text = self.held.get(False)"),
        told("text = self.held.get(timeout=0.5)"),
        told("if self.held.empty():\n    return\ntext = self.held.get()"),
        told("if self.flag:\n    text = self.held.get()", given=f"self.flag = True; {PUT}"),
        told("text = self.held.get()", first="self.held.put('hello')"),
        told("text = self.held.get()", first="threading.Thread(target=self.read).start()"),
        told("text = self.held.get()", first="self.create_subscription(String, 'b', self.held.put, 10)"),
        told("self.held.put('tick')\ntext = self.held.get()"),
        told("self.held.wait(1.0)", "threading.Event()", "self.held.set()"),
        told("self.held.acquire()", "threading.Semaphore(1)", "self.held.release()"),
        told("text = self.held.get()", "{}", "self.held['a'] = msg.data"),
        threaded("while not self.flag:\n    pass", ", callback_group=self.own", given="self.flag = True"),
        threaded(
            "self.held.get()",
            ", callback_group=MutuallyExclusiveCallbackGroup()",
            ", callback_group=MutuallyExclusiveCallbackGroup()",
        ),
        threaded(
            "self.held.get()",
            ", callback_group=self.own",
            ", callback_group=self.own",
            first="self.own = ReentrantCallbackGroup()",
        ),
        threaded(
            "self.held.get()",
            first="self.create_subscription(String, 'b', self.on_label, 1, callback_group=self.own)",
        ),
        *(
            threaded("self.held.get()", f", {group}", f", callback_group={group}", first=first)
            for group, first in (
                ("groups[0]", f"groups = [{SOLE}]"),
                ("own", f"own = {SOLE}\n        if self.flag: own = {SOLE}"),
                ("own", "own = anything_parallel()"),
                ("self.own", f"for self.own in ({SOLE}, {SOLE}): pass"),
                ("other.default_callback_group", "other = self"),
            )
        ),
        threaded("self.held.get()", ", own", ", callback_group=own", first=f"own = {SOLE}").replace(
            "        self.create_timer(", f"        own = {SOLE}\n        self.create_timer("
        ),
        threaded("self.held.get()", other=", **self.options"),
        threaded("self.held.get()", first="self._default_callback_group = anything_parallel()"),
        threaded("self.held.get()").replace(
            "def on_label(", "def default_callback_group(self): return any_one()\n\n    def on_label("
        ),
        threaded("self.held.get()", first="threading.Thread(target=self.read).start()"),
        told(
            "while not self.held.is_set():\n    pass",
            "threading.Event()",
            "self.held.set()",
            first="self.start(self.held)",
        ),
        told("while not self.flag:\n    self.look()", given="self.flag = True"),
        told("while not self.flag:\n    if self.count > 3: break", given="self.flag = True"),
    ],
)
def test_what_may_be_there_already_or_come_otherwise_is_right(tmp_path: Path, text: str) -> None:
    assert found(text, tmp_path) == []
