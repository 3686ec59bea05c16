"""A callback waits for an answer: how it goes on without, depends on whether it owes one itself."""

from __future__ import annotations

import re
import textwrap

import pytest

from ros2lab.diagnose.code.deadlocks import deadlocks
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource

HEAD = """\
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node


class Asker(Node):
    def __init__(self):
        super().__init__('asker')
        self.cli = self.create_client(Trigger, 'level')
        self.act = ActionClient(self, Fibonacci, 'count')
"""
TAIL = "\n\ndef main():\n    node = Asker()\n    rclpy.spin(node)\n"
TIMER, SERVICE = "self.create_timer(1.0, self.ask)", "self.create_service(Trigger, 'ask', self.ask)"
THREADS = "self.executor = MultiThreadedExecutor()"
SPIN = "rclpy.spin_until_future_complete(self, {})"
LATER = [
    (f"answer = self.cli.call_async(self.req)\n{SPIN.format('answer')}\nprint(answer.result())", 1),
    ("reply = self.cli.call(self.req)\nprint(reply)", 1),
    ("answer = self.cli.call_async(self.req)\nwhile not answer.done():\n    pass\nprint(answer)", 1),
    (f"sent = self.act.send_goal_async(goal)\n{SPIN.format('sent')}\ngot = sent.result().get_result_async()\n{SPIN.format('got')}\nprint(got)", 2),
    (f"{SPIN.format('self.cli.call_async(self.req)')}\nprint(1)", 1),
]  # fmt: skip
OWED = [
    ("answer = self.cli.call(request)\nreturn answer", "answer = await self.cli.call_async(request)", "self.cli = "),
    ("total += self.cli.call(request)\nreturn total", "total += await self.cli.call_async(request)", "self.cli = "),
    ("return self.cli.call(request)", "return await self.cli.call_async(request)", "self.cli = "),
    (f"sent = self.act.send_goal_async(goal)\n{SPIN.format('sent')}\nreturn sent", "await sent", "self.act = "),
    ("future = self.cli.call_async(request)\nwhile rclpy.ok() and not future.done():\n    pass\nreturn future", "await future", "self.cli = "),
]  # fmt: skip
RIGHT = [
    (TIMER, "future = self.cli.call_async(self.req)\nfuture.add_done_callback(self.got)"),
    (TIMER, "rclpy.spin_until_future_complete(self.other, self.other_cli.call_async(self.req))"),
    (TIMER, "tmp = rclpy.create_node('tmp')\ncli = tmp.create_client(T, 't')\nrclpy.spin_until_future_complete(tmp, cli.call_async(1))"),
    (TIMER, "vision = Vision()\nwhile rclpy.ok():\n    rclpy.spin_once(vision)\n    if vision.future.done():\n        break"),
    (TIMER, "vision = Vision()\nwhile not vision.future.done():\n    rclpy.spin_once(vision)"),
    (TIMER, "while not answer.done():\n    executor.spin_once()"),
    (f"self.own = self.create_client(T, 't', callback_group=self.group)\n{TIMER}", SPIN.format("self.own.call_async(1)")),
    (f"self.group = MutuallyExclusiveCallbackGroup()\nself.create_subscription(T, 't', self.hear, 1, callback_group=self.group)\n{TIMER}", "while self.turns < 4:\n    rclpy.spin_once(self)"),
    (TIMER, "if self.future.done():\n    print(self.future.result())"),
    (TIMER, "self.table.call(self.req)"),
    ("self.button.add_command(command=self.ask)", "self.cli.call(self.req)"),
    (
        f"{THREADS}\nself.create_timer(1.0, self.ask, MutuallyExclusiveCallbackGroup())",
        "self.cli.call(self.req)",
    ),
    (f"{THREADS}\nself.create_timer(1.0, self.ask, callback_group=self.own)", "self.cli.call(self.req)"),
    (
        f"{THREADS}\n{TIMER}\nself.cli = self.create_client(Trigger, 'level', callback_group=self.own)",
        "self.cli.call(self.req)",
    ),
    (f"{THREADS}\n{TIMER}", "self.table.call(self.req)"),
    (
        f"{THREADS}\nself.create_timer(1.0, self.ask, groups[0])\nself.cli = self.create_client(Trigger, 'level', callback_group=groups[0])",
        "self.cli.call(self.req)",
    ),
    (f"{THREADS}\n{TIMER}\nself._default_callback_group = parallel()", "self.cli.call(self.req)"),
    (f"{THREADS}\n{TIMER}\nself.all = ReentrantCallbackGroup()", "self.cli.call(self.req)"),
    (
        f"{THREADS}\n{TIMER}",
        "done = threading.Event()\nself.button.add_done_callback(lambda _: done.set())\ndone.wait(1.0)",
    ),
    ("pass", "self.cli.call(self.req)"),
]  # fmt: skip


SERVER = "self.server = ActionServer(self, Fibonacci, 'mine', self.ask)"
GOALS = (
    "self.server = ActionServer(self, Fibonacci, 'mine', execute_callback=self.run, goal_callback=self.ask)"
)
DONE = "self.cli.call_async(self.req).add_done_callback(self.ask)"
TASK = "self.executor.create_task(self.ask)"
ASKED = "answer = self.cli.call_async(self.req)\n" + SPIN.format("answer")
# What rclpy runs as a task holds no callback group: a nested spin serves the node, and another thread may answer.
AS_TASKS = [
    (SERVER, ASKED, False),
    (SERVER, "while self.turns < 4:\n    rclpy.spin_once(self)", False),
    (SERVER, "answer = self.cli.call_async(1)\nwhile not answer.done():\n    rclpy.spin_once(self)", False),
    (SERVER, "self.cli.call(self.req)", True),
    (SERVER, "answer = self.cli.call_async(self.req)\nwhile not answer.done():\n    pass", True),
    (f"{THREADS}\n{SERVER}", "self.cli.call(self.req)", False),
    (GOALS, ASKED, True),
    (DONE, ASKED, False),
    (DONE, "self.cli.call(self.req)", True),
    (TASK, ASKED, False),
    (f"{SERVER}\n{TIMER}", ASKED, True),
]


# In one callback group, several threads run one callback after the other.
IN_ONE_GROUP = [
    (TIMER, "self.cli.call(self.req)"),
    (SERVICE, "return self.cli.call(self.req)"),
    (TIMER, "answer = self.cli.call_async(self.req)\nwhile not answer.done():\n    time.sleep(0.1)"),
    (TIMER, "done = threading.Event()\nanswer = self.cli.call_async(self.req)\nanswer.add_done_callback(lambda _: done.set())\ndone.wait()"),
    ("self.own = MutuallyExclusiveCallbackGroup()\nself.create_timer(1.0, self.ask, callback_group=self.own)\nself.cli = self.create_client(Trigger, 'level', callback_group=self.own)", "self.cli.call(self.req)"),
]  # fmt: skip


def told(init: str, body: str, parameters: str = "self", more: str = "") -> tuple[str, list[Finding]]:
    text = f"{HEAD}{textwrap.indent(init, ' ' * 8)}\n\n    def ask({parameters}):\n{textwrap.indent(body, ' ' * 8)}\n{more}{TAIL}"
    return text, found_in(text)


def found_in(text: str) -> list[Finding]:
    return [*deadlocks(NodeSources({"pk.ask": PythonSource("pk.ask", "ask.py", text)}))]


@pytest.mark.parametrize(("body", "count"), LATER)
def test_what_owes_nothing_goes_on_when_the_answer_has_come(body: str, count: int) -> None:
    text, (finding,) = told(TIMER, body)
    match = re.fullmatch(
        r"write these lines instead of lines? (\d+)(?: to (\d+))?:\n(.*)", finding.fix, re.DOTALL
    )
    assert match
    lines = text.splitlines()
    lines[int(match[1]) - 1 : int(match[2] or match[1])] = match[3].splitlines()
    after = "\n".join(lines)
    compile(after, "ask.py", "exec")
    assert found_in(after) == []
    assert after.count("add_done_callback(") == count
    assert "print(" in after


@pytest.mark.parametrize(("body", "awaited", "client"), OWED)
@pytest.mark.parametrize("init", [SERVICE, GOALS])
def test_what_owes_an_answer_awaits_another_one(init: str, body: str, awaited: str, client: str) -> None:
    _, (finding,) = told(init, body, "self, request, response")
    assert f"`{awaited}` on line" in finding.fix
    assert "`async def ask(self, request, response):` on line" in finding.fix
    assert re.search(rf"`{client}.*callback_group=MutuallyExclusiveCallbackGroup\(\)\)` on line", finding.fix)


def test_what_may_not_await_is_called_by_several_threads() -> None:
    init = "self.add_on_set_parameters_callback(self.ask)"
    _, (finding,) = told(init, "return self.cli.call(request)", "self, parameters")
    assert "`executor = MultiThreadedExecutor()`, `executor.add_node(node)`" in finding.fix
    assert "async" not in finding.fix


def test_a_method_that_a_callback_calls_waits_as_well() -> None:
    more = "\n    def inner(self):\n        return self.cli.call(self.req)\n"
    text, (finding,) = told(SERVICE, "return self.inner()", "self, request, response", more)
    assert finding.place == f"ask.py:{text.splitlines().index('        return self.cli.call(self.req)') + 1}"
    assert "MultiThreadedExecutor" in finding.fix


@pytest.mark.parametrize(("init", "body"), RIGHT)
def test_what_waits_for_nothing_is_right(init: str, body: str) -> None:
    assert told(init, body)[1] == []


@pytest.mark.parametrize("spun", ["tmp", "self.sub", "self"])
def test_no_spin_brings_what_the_running_callback_holds_back(spun: str) -> None:
    body = f"tmp = rclpy.create_node('tmp')\nanswer = self.cli.call_async(1)\nrclpy.spin_until_future_complete({spun}, answer)"
    assert len(told(TIMER, body)[1]) == 1


@pytest.mark.parametrize(("before", "is_told"), [("", True), ("    node = rclpy.create_node('b')\n", False)])
def test_a_function_spins_the_node_that_calls_it_back(before: str, *, is_told: bool) -> None:
    spin = "rclpy.spin_until_future_complete(node, reply)"
    asks = f"def ask(given):\n{before}    cli = node.create_client(T, 't')\n    reply = cli.call_async(1)\n    {spin}\n"
    text = f"import rclpy\n\n\n{asks}\n\nnode = rclpy.create_node('a')\nnode.create_timer(1.0, ask)\n"
    assert bool(found_in(text)) is is_told


@pytest.mark.parametrize(("init", "body", "is_told"), AS_TASKS)
def test_a_task_may_spin_its_node(init: str, body: str, *, is_told: bool) -> None:
    assert bool(told(init, body, "self, given")[1]) is is_told


@pytest.mark.parametrize(("init", "body"), IN_ONE_GROUP)
def test_several_threads_do_not_help_within_a_callback_group(init: str, body: str) -> None:
    """Wherever the executor is made: the client gets a group of its own."""
    for init_here, more in (
        (f"{THREADS}\n{init}", ""),
        (init, "\n\ndef several():\n    return MultiThreadedExecutor()\n"),
    ):
        _text, [finding] = told(init_here, body, more=more)
        assert "the same callback group" in finding.cause
        assert finding.fix.startswith(
            "write `self.cli = self.create_client(Trigger, 'level', callback_group=Mut"
        )
