"""Fields of messages that are compared with what they never equal, as they hold another type."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace
from workspace_files import Files

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look


def listener(kind: str, condition: str) -> Files:
    """Return a workspace with a subscriber to a type of std_msgs that asks a condition of a message."""
    files = right_workspace().change("listener", "import String", f"import {kind}")
    files.change("listener", "            String,", f"            {kind},").change(
        "listener", "command'", "switch'"
    )
    return files.change("listener", "msg.data == 'start'", condition)


def found_in(files: Files, folder: Path) -> list[Finding]:
    return [one for one in Look(files.write(folder)).findings if one.code == "never-equal"]


@pytest.mark.parametrize(
    ("kind", "condition", "fix"),
    [
        ("Bool", "msg.data == 'True'", "write `msg.data`"),
        ("Bool", "'False' == msg.data", "write `not msg.data`"),
        ("Bool", "msg.data != 'true'", "write `not msg.data`"),
        ("Bool", "msg.data in ('True', 'true')", "compare msg.data with a bool"),
        ("Int32", "msg.data == '1'", "write `msg.data == 1`"),
        ("Int32", "msg.data == 'one'", "compare msg.data with a number"),
        ("Float64", "msg.data == '0.5'", "write `msg.data == 0.5`"),
        ("String", "msg.data == 1", "write `msg.data == '1'`"),
        ("String", "msg.data == True", "write `msg.data == 'True'`"),
        ("String", "self.state and msg.data != 2", "write `msg.data != '2'`"),
    ],
)
def test_a_field_is_compared_with_another_type(tmp_path: Path, kind: str, condition: str, fix: str) -> None:
    files = listener(kind, condition)
    (found,) = found_in(files, tmp_path)
    assert files.path("listener") in found.place
    assert found.fix == fix


@pytest.mark.parametrize(
    ("condition", "fix"),
    [
        ("self.state == 'paused'", "remove this comparison, with what depends on it, or set self.state to 'paused' where that begins"),
        ("self.state != 'paused'", "remove this comparison, with what depends on it, or set self.state to 'paused' where that begins"),
        ("self.state in ('idle', 'paused')", "remove 'paused' here, or set self.state to 'paused' where that begins"),
        ("self.state == 'runing'", "write 'runing' instead of 'running' here"),
        ("self.state in ('idle', 'running')", ""),
    ],
)  # fmt: skip
def test_a_state_is_set_before_it_is_asked_for(tmp_path: Path, condition: str, fix: str) -> None:
    files = right_workspace().change("listener", "msg.data == 'start'", condition)
    assert [finding.fix for finding in found_in(files, tmp_path)] == [fix] * bool(fix)


@pytest.mark.parametrize(
    ("kind", "condition"),
    [
        ("Bool", "msg.data == True"),
        ("Bool", "msg.data == 1"),
        ("Bool", "str(msg.data) == 'True'"),
        ("Int32", "msg.data == 1.0"),
        ("Int32", "msg.data == True"),
        ("Int32", "msg.data in (1, 'one')"),
        ("String", "msg.data in ('1', 'start')"),
        ("String", "msg.data in 'start'"),
        ("String", "msg.data == self.state"),
        ("String", "int(msg.data) == 1"),
        ("String", "len(msg.data) == 1"),
    ],
)
def test_a_field_may_be_compared_with_its_own_type(tmp_path: Path, kind: str, condition: str) -> None:
    assert not found_in(listener(kind, condition), tmp_path)


def test_a_callback_may_take_messages_of_two_types(tmp_path: Path) -> None:
    files = listener("Bool", "msg.data == 'start'")
    files.change("listener", "import Bool", "import Bool, String")
    other = "        self.other = self.create_subscription(String, 'words', self.command_callback, 10)\n"
    files.change("listener", "        self.state = 'idle'\n", f"        self.state = 'idle'\n{other}")
    assert not found_in(files, tmp_path)


@pytest.mark.parametrize(
    ("kind", "condition"), [("Bool", "msg == True"), ("Int32", "msg == 1"), ("String", "msg == 'start'")]
)
def test_a_whole_message_is_compared(tmp_path: Path, kind: str, condition: str) -> None:
    findings = Look(listener(kind, condition).write(tmp_path)).findings
    assert [one.fix for one in findings if one.code == "message-compared"] == ["compare msg.data"]
