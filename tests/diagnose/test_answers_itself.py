"""A callback that publishes on the topic to which it listens, and so calls itself for ever."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace
from workspace_files import Files

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look

SEND = "        self.publisher_.publish(msg)\n"
LAUNCHED = "executable='command_subscriber'"


def listener(sent: str, topic: str = "/robot/command") -> Files:
    """Return a workspace whose subscriber to /robot/command publishes on a topic in its callback, as its lines say."""
    made = f"        self.publisher_ = self.create_publisher(String, '{topic}', 10)\n"
    files = right_workspace().change(
        "listener", "        self.state = 'idle'\n", f"        self.state = 'idle'\n{made}"
    )
    return files.change(
        "listener", "        self.get_logger().info(f'State", f"{sent}        self.get_logger().info(f'State"
    )


def found_in(files: Files, folder: Path) -> list[Finding]:
    return [one for one in Look(files.write(folder)).findings if one.code == "endless-loop"]


@pytest.mark.parametrize(
    "sent",
    [
        SEND,
        "        with self.lock:\n    " + SEND,
        "        try:\n    " + SEND + "        except ValueError:\n            pass\n",
        "        self.send(msg)\n",
    ],
)
def test_a_callback_answers_itself(tmp_path: Path, sent: str) -> None:
    files = listener(sent)
    files.change(
        "listener", "    def command_callback", f"    def send(self, msg):\n{SEND}\n    def command_callback"
    )
    (found,) = found_in(files, tmp_path)
    assert files.path("listener") in found.place
    assert "under a condition" in found.fix


@pytest.mark.parametrize(
    "files",
    [
        listener(SEND, "/robot/answer"),
        listener("        if msg.data != 'done':\n            msg.data = 'done'\n    " + SEND),
        listener("        if msg.data == 'done':\n            return\n" + SEND),
        listener("        if msg.data == 'done':\n            raise ValueError(msg.data)\n" + SEND),
        listener("        self.destroy_subscription(self.subscription)\n" + SEND),
        listener(SEND).change("launch/robot.launch.py", LAUNCHED, f"{LAUNCHED}, remappings=[('/robot/command', '/other')]"),
        listener(SEND, "robot/command"),
        listener(""),
    ],
)  # fmt: skip
def test_a_callback_that_does_not_answer_itself_is_not_told(tmp_path: Path, files: Files) -> None:
    assert not found_in(files, tmp_path)
