"""A node that was started before the last build and still runs, beside the one that was started after it."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

LISTED = "$ ros2 node list\nWARNING: Be aware that there are nodes in the graph that share an exact name, which can have unintended side effects.\n"
BUILT = "$ colcon build\nStarting >>> my_bot\nFinished <<< my_bot [1.7s]\n\nSummary: 1 package finished [1.9s]\n$ source install/setup.bash\n"
TWO = f"{LISTED}/talker\n/talker\n"
RUN = "# terminal 2\n$ ros2 run my_bot talker\n[INFO] [talker]: running 0\n^C\n"


def told(text: str, tmp_path: Path, files: Files | None = None) -> str:
    first = of_text(text, (files or Files.right(NAMES[1])).write(tmp_path))[0]
    assert first.code == "name-twice"
    return f"{first.cause} {first.fix}"


@pytest.mark.parametrize(
    "text",
    [
        f"{BUILT}{TWO}{RUN}",
        f"{RUN}{BUILT}{LISTED}/talker\n/talker\n/talker\n",
        f"{LISTED}/ears\n/talker\n/talker\n{RUN}",
        f"$ ros2 run my_bot ears\n^C\n{TWO}{RUN}",
    ],
)
def test_an_older_node_still_runs(text: str, tmp_path: Path) -> None:
    said = told(text, tmp_path)
    assert "an older one, with its old code, is still running" in said
    assert "ros2 run my_bot talker" in said


def test_the_text_of_the_older_one_is_named(tmp_path: Path) -> None:
    files = Files.right(NAMES[1]).change("node", "f'running {self.count}'", "'blink twice'")
    echo = "$ ros2 topic echo /robot/status\ndata: blink twice\n---\ndata: blink\n---\ndata: wink\n---\n^C\n"
    assert "Its text 'wink' is no longer in any file" in told(f"{BUILT}{echo}{TWO}{RUN}", tmp_path, files)


@pytest.mark.parametrize("text", [f"{RUN}{RUN}{TWO}", TWO])
def test_one_that_was_started_twice_may_be_meant(text: str, tmp_path: Path) -> None:
    assert "give each its own name" in told(text, tmp_path)


def test_two_programs_that_use_one_name(tmp_path: Path) -> None:
    files = Files.right(NAMES[1]).change("listener", "__init__('ears')", "__init__('talker')")
    text = f"$ ros2 run my_bot talker\n^C\n$ ros2 run my_bot ears\n^C\n{TWO}"
    assert "older" not in " ".join(one.cause for one in of_text(text, files.write(tmp_path)))
