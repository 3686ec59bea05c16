"""What callbacks return to rclpy: all that it cannot use is told at once, and the fix leaves nothing of it."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.causes.answers import _answering, _of_function
from ros2lab.diagnose.code.result_faults import result_faults
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.node_faults import node_faults
from ros2lab.diagnose.sources.uses import uses_of

HEAD = """\
from rclpy.action import ActionServer
from rclpy.node import Node
from std_srvs.srv import SetBool


class Oven(Node):
    def __init__(self):
        super().__init__('oven')
        self.target = 1.0
        REGISTER

"""
PARAMETERS = "self.add_on_set_parameters_callback(self.check)", "def check(self, params):"
SERVICE = "self.create_service(SetBool, 'x', self.check)", "def check(self, request, response):"
GOAL = "ActionServer(self, SetBool, 'x', self.run, goal_callback=self.check)", "def check(self, goal):"
YES, NO = "SetParametersResult(successful=True)", "SetParametersResult(successful=False)"
WRONG = [
    (PARAMETERS, "for p in params:\n    if p.value > 3:\n        return True\nreturn False", [YES, NO]),
    (PARAMETERS, "if params:\n    self.target = 2.0\n    return\nreturn False", [YES, NO]),
    (PARAMETERS, "if params:\n    return True\nself.target = 2.0", [YES, YES]),
    (PARAMETERS, "if params:\n    return 'yes'\nelse:\n    return None", [YES, YES]),
    (PARAMETERS, "self.target = 2.0", [YES]),
    (SERVICE, "if request.data:\n    return response\nreturn", ["response"]),
    (SERVICE, "if request.data:\n    return True\nreturn False", ["response", "response"]),
    (SERVICE, "if request.data:\n    return\nresponse.success = True", ["response", "response"]),
]
RIGHT = [
    (PARAMETERS, f"if params:\n    return {YES}\nreturn {NO}"),
    (PARAMETERS, "return self.judged(params)"),
    (SERVICE, "if not request.data:\n    raise ValueError\nreturn response"),
    (SERVICE, "raise NotImplementedError"),
    (SERVICE, "while True:\n    if request.data:\n        return response"),
]


def told(folder: Path, kind: tuple[str, str], body: str) -> tuple[str, list[Finding | None], list[Finding]]:
    register, head = kind
    method = textwrap.indent(f"{head}\n{textwrap.indent(body, '    ')}\n", "    ")
    text = HEAD.replace("REGISTER", register) + method
    sources = sources_of(text, folder)
    found = [*result_faults(uses_of(sources)), *node_faults(sources)]
    codes = ("value-none", "callback-arguments")
    return (
        text,
        [_of_function(answering) for answering in _answering(sources)],
        [finding for finding in found if finding.code in codes],
    )


def applied(text: str, fix: str) -> tuple[str, list[str]]:
    lines, given = text.splitlines(), []
    for answer, numbers in re.findall(r"`return ([^`]+)` instead of what lines? ([\d, and]+) returns?", fix):
        for number in map(int, re.findall(r"\d+", numbers)):
            lines[number - 1] = re.sub(r"return\b.*", f"return {answer}", lines[number - 1])
            given.append(answer)
    for answer in re.findall(r"`return ([^`]+)` as the last line", fix):
        lines.append(f"        return {answer}")
        given.append(answer)
    return "\n".join(lines[len(HEAD.splitlines()) + 1 :]), given


@pytest.mark.parametrize(("kind", "body", "answers"), WRONG)
def test_each_return_gets_its_answer_at_once(
    tmp_path: Path, kind: tuple[str, str], body: str, answers: list[str]
) -> None:
    text, printed, silent = told(tmp_path, kind, body)
    for finding in (printed[0], silent[0]):
        assert finding is not None
        mended, given = applied(text, finding.fix)
        assert given == answers
        _, still, left = told(tmp_path, kind, textwrap.dedent(mended))
        assert ([*filter(None, still)], left) == ([], [])


@pytest.mark.parametrize(("kind", "body"), RIGHT)
def test_callbacks_that_answer_are_right(tmp_path: Path, kind: tuple[str, str], body: str) -> None:
    assert told(tmp_path, kind, body)[2] == []


def test_what_refuses_a_goal_still_refuses_it(tmp_path: Path) -> None:
    _, (finding, *_), _ = told(tmp_path, GOAL, "if goal.order > 3:\n    return False\nreturn True")
    assert finding is not None
    assert "`return GoalResponse.REJECT` instead of what line 14 returns" in finding.fix
    assert "`return GoalResponse.ACCEPT` instead of what line 15 returns" in finding.fix
