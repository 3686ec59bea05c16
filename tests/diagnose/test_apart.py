"""Names that a namespace separates: the line that decides is told, once, and groups that are apart on purpose are left."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.trial.retold import without_retold

LAUNCH = "launch/robot.launch.py"
STATUS = "        Node(package='my_bot', executable='status_publisher'),\n"
LISTENER = "        Node(package='my_bot', executable='command_subscriber'),\n"
Starts = dict[str, tuple[str, ...]]  # the namespaces of each executable


def told(folder: Path, sent: str, read: str, starts: Starts) -> list[Finding]:
    """Return the findings of a launch file that starts two nodes with these topics in some namespaces."""
    files = right_workspace().change("node", "'/robot/report'", repr(sent))
    files.change("listener", "'/robot/command'", repr(read))
    nodes = [
        f"        Node(package='my_bot', executable='{name}'{f', namespace={space!r}' * bool(space)}),\n"
        for name, spaces in starts.items()
        for space in spaces
    ]
    files.change(LAUNCH, STATUS, "".join(nodes)).change(LAUNCH, LISTENER, "")
    return [f for f in Look(files.write(folder), loads=True).findings if f.code == "launch-apart"]


def both(*spaces: str) -> Starts:
    return {"status_publisher": spaces, "command_subscriber": spaces}


@pytest.mark.parametrize(
    ("topics", "starts", "file", "fix"),
    [
        (("/news", "news"), both("red"), "status_publisher.py", "write 'news' instead of '/news'"),
        (("/news", "news"), both("red", "blue"), "status_publisher.py", "write 'news' instead of '/news'"),
        (("news", "/news"), both("a", "b", "c"), "command_subscriber.py", "write 'news' instead of '/news'"),
        (("/news", "news"), {"status_publisher": ("",), "command_subscriber": ("red", "blue")}, "command_subscriber.py", "write '/news' instead of 'news'"),
        (("news", "/news"), {"status_publisher": ("red",), "command_subscriber": ("blue",)}, "status_publisher.py", "write '/news' instead of 'news'"),
        (("news", "news"), {"status_publisher": ("red",), "command_subscriber": ("",)}, "robot.launch.py", "start both in the namespace /red"),
    ],
)  # fmt: skip
def test_the_line_that_decides_is_told_once(
    tmp_path: Path, topics: tuple[str, str], starts: Starts, file: str, fix: str
) -> None:
    (found,) = told(tmp_path / "before", *topics, starts)
    assert file in found.place
    assert fix in found.fix
    if fix.startswith("write "):
        new = fix.split("'")[1]
        side = {"status_publisher.py": (new, topics[1]), "command_subscriber.py": (topics[0], new)}[file]
        assert told(tmp_path / "after", *side, starts) == []


@pytest.mark.parametrize(
    ("sent", "read", "starts"),
    [
        ("news", "news", both("red", "blue")),
        ("/news", "/news", both("red", "blue")),
        ("news", "news", {"status_publisher": ("red", "blue", "green"), "command_subscriber": ("red", "blue")}),
        ("/news", "/news", {"status_publisher": ("red", "blue"), "command_subscriber": ("",)}),
        ("/red/news", "news", {"status_publisher": ("",), "command_subscriber": ("red",)}),
    ],
)  # fmt: skip
def test_what_is_apart_on_purpose_or_meets_is_right(
    tmp_path: Path, sent: str, read: str, starts: Starts
) -> None:
    assert told(tmp_path, sent, read, starts) == []


def test_two_topics_that_reading_has_told_apart_are_not_told_again(tmp_path: Path) -> None:
    look = Look(right_workspace().write(tmp_path))
    read = [Finding("launch-apart", "They do not meet.", about=("/news", "/red/news", "/blue/news"))]
    again = Finding("topic-near-miss", "They do not connect.", about=("/news", "/red/news"))
    other = Finding("topic-near-miss", "They do not connect.", about=("/news", "/new"))
    assert [*without_retold([again, other], read, look)] == [other]
