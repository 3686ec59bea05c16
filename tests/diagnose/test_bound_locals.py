"""Local names that an attribute shares by chance, and those with which the attribute was meant."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose.look import Look

BY_CHANCE = (
    "count, name = self.described()\n        msg.data = name",
    "(count, _), name = self.described()\n        msg.data = name",
    "count, *names = self.described()\n        msg.data = names[0]",
    "[name, count] = self.described()\n        msg.data = name",
    "for count, name in [(1, 'a')]:\n            msg.data = name",
    "for count in range(3):\n            self.publisher_.publish(msg)",
    "with open('a') as count:\n            pass",
    "self.name = count = 3",
    "names = [3 for count in range(3)]\n        msg.data = str(names)",
    "count = self.count",
    "count: int = int(self.count)",
    "count, limit = self.count, self.limit",
    "(count, _), limit = (self.count, 1), float(self.limit)",
    "count = self.count if self.limit else 0",
    "count = 2 * self.count",
)
MEANT = (
    "count = 7",
    "count: int = 7",
    "count, limit = self.described()",
    "count = limit = 7",
    "[count, limit] = 1, 2",
    "count = self.count + 1",
    "count = -self.count",
    "count, limit = self.limit, self.count",
    "count = self.limit",
)


def told(folder: Path, line: str) -> list[str]:
    files = right_workspace().change("node", "        self.count += 1\n", f"        {line}\n")
    begun = "        self.count = 0\n        self.limit = 9\n"
    files.change("node", "        self.count = 0\n", begun)
    files.change("node", "running: {self.count}", "running: {self.count} of {self.limit}")
    return [finding.code for finding in Look(files.write(folder)).findings]


@pytest.mark.parametrize("line", BY_CHANCE)
def test_a_local_name_may_be_that_of_an_attribute(tmp_path: Path, line: str) -> None:
    assert "not-kept" not in told(tmp_path, line)


@pytest.mark.parametrize("line", MEANT)
def test_a_value_that_nothing_reads_was_meant_for_the_attribute(tmp_path: Path, line: str) -> None:
    assert "not-kept" in told(tmp_path, line)
