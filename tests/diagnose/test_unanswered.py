"""A result that is None because nobody answered in time: who has to be started, and what waits for it."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text

NAME = NAMES[1]
CLIENT = """\
import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


def main(args=None):
    rclpy.init(args=args)
    node = Node('asker')
    client = node.create_client(Trigger, 'SERVICE')
    WAIT
    future = client.call_async(Trigger.Request())
    rclpy.spin_until_future_complete(node, futureLIMIT)
    answer = future.result()
    print(answer.message)
"""
COUNT = "        self.count = 0\n"
SERVER = "        self.create_service(Trigger, 'open_gate', self.go)\n\n    def go(self, request, response):\n        return response\n"


def told(
    root: Path, service: str = "open_gate", wait: str = "pass", limit: str = ", timeout_sec=3.0"
) -> Finding:
    code = CLIENT.replace("SERVICE", service).replace("WAIT", wait).replace("LIMIT", limit)
    files = Files.right(NAME).change("PACKAGE/MODULE.py", COUNT, COUNT + SERVER)
    files = files.change(
        "PACKAGE/MODULE.py", "import rclpy\n", "import rclpy\nfrom std_srvs.srv import Trigger\n"
    )
    files.put("PACKAGE/asker.py", code)
    path, line = files.path("PACKAGE/asker.py"), code.splitlines().index("    print(answer.message)") + 1
    text = (
        "$ ros2 run my_bot asker\nTraceback (most recent call last):\n"
        f'  File "{files.write(root) / path}", line {line}, in main\n    print(answer.message)\n'
        "AttributeError: 'NoneType' object has no attribute 'message'\n"
    )
    return of_text(text, root)[0]


def test_the_server_is_started_and_waited_for(tmp_path: Path) -> None:
    fix = told(tmp_path).fix
    assert "`ros2 run my_bot talker`" in fix
    assert "above line 11 `while not client.wait_for_service(timeout_sec=1.0):`" in fix
    assert "`node.get_logger().info('waiting for open_gate')`" in fix


def test_a_wait_whose_result_nothing_uses_becomes_a_loop(tmp_path: Path) -> None:
    assert "instead of line 10" in told(tmp_path, wait="client.wait_for_service(timeout_sec=5.0)").fix


def test_a_code_that_waits_well_only_needs_the_server(tmp_path: Path) -> None:
    wait = "while not client.wait_for_service(timeout_sec=1.0):\n        print('waiting')"
    fix = told(tmp_path, wait=wait).fix
    assert "`ros2 run my_bot talker`" in fix
    assert "write" not in fix


@pytest.mark.parametrize("service", ["open_gat", "gate/open", "start"])
def test_another_name_of_the_only_server_is_written(tmp_path: Path, service: str) -> None:
    assert told(tmp_path, service).fix == "write `node.create_client(Trigger, '/open_gate')`"


def test_without_a_limit_something_else_is_told(tmp_path: Path) -> None:
    assert "nothing answered" not in told(tmp_path, limit="").cause
