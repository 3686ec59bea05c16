"""One cause is told once: what a run shows of it again is left out, and what the nodes did is told beside it."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace
from test_diagnose_verb import run
from test_trial import build

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.trial import try_out
from ros2lab.trial.retold import without_retold

MADE = "        self.publisher_ = self.create_publisher(String, '/robot/report', 10)\n"
TIMER = "        self.timer = self.create_timer(0.5, self.timer_callback)\n"


def line_of(root: Path, text: str) -> str:
    (path,) = root.glob("src/*/*/status_publisher.py")
    lines = path.read_text().splitlines()
    return f"{path.relative_to(root)}:{next(n for n, line in enumerate(lines, 1) if text in line)}"


@pytest.mark.parametrize(
    ("code", "at", "is_left"),
    [
        ("sent-early", "self.publisher_.publish", False),
        ("never-started", "create_timer", False),  # the timer calls what publishes
        ("never-called", "def timer_callback", False),
        ("never-equal", "msg = String()", False),  # in the method that publishes
        ("parameter-unread", "self.publisher_.publish", True),  # does not keep it from publishing
        ("never-equal", "self.other", True),  # has nothing to do with it
        ("spin-missing", "self.other", True),
    ],
)
def test_what_a_known_fault_explains_is_not_told_again(
    tmp_path: Path, code: str, at: str, is_left: bool
) -> None:
    other = "\n    def listen(self, msg):\n        self.other = msg\n\n    def timer_callback(self)"
    root = right_workspace().change("node", "\n    def timer_callback(self)", other).write(tmp_path)
    found = [Finding("publishes-nothing", "It published nothing.", line_of(root, "create_publisher"))]
    read = [Finding(code, "Something is wrong.", line_of(root, at))]
    assert [*without_retold(found, read, Look(root))] == found * is_left


def test_a_real_run_tells_a_cause_once_and_what_the_nodes_did(tmp_path: Path) -> None:
    files = right_workspace().change("node", TIMER, "")
    root = files.only("node").write(tmp_path)
    build(root)
    done = run("--run", folder=root)
    assert done.stdout.count("never-called:") == 1
    assert "publishes-nothing:" not in done.stdout
    assert "What the nodes did: " in done.stdout
    assert "status_publisher has a publisher on /robot/report, but published nothing there" in done.stdout


def test_what_ran_is_not_said_to_run_never(tmp_path: Path) -> None:
    """Of what reading has found, a real run takes back what it contradicts."""
    more = "        self.timer = self.create_timer(0.5, self.timer_callback)\n\n    def unused(self):\n        self.count = 0\n"
    root = right_workspace().only("node").change("node", TIMER, more).write(tmp_path)
    build(root)
    read = [
        Finding("never-called", f"{text} is never called.", place, "call it", never=(place,))
        for text in ("class StatusPublisher", "def timer_callback", "def unused")
        for place in [line_of(root, text)]
    ]
    assert [*try_out(root, read=read).read] == read[2:]
