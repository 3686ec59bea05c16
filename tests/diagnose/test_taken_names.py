"""Names that every node has, and the free names that are offered in their place."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace


@pytest.mark.parametrize(
    ("written", "fix"),
    [
        ("self._subscriptions = []", "write self.subscriptions_ instead,"),
        ("self._default_callback_group = None", "write self.default_callback_group_ instead,"),
        ("self._parameters = {}", "write self.parameters instead,"),
        ("self.parameters = []\n        self._parameters = {}", "write self.parameters_ instead,"),
        ("self.timers = []", "write self.timers_ instead of self.timers here"),
        ("self.timers_ = []\n        self.timers = []", "write self.timers__ instead of self.timers here"),
        ("self.count = 0\n\n    def clients(self):\n        pass", "rename it, for example to clients_,"),
        ("self.clients_ = 0\n\n    def clients(self):\n        pass", "rename it, for example to clients__,"),
    ],
)
def test_the_name_that_is_offered_is_free(tmp_path: Path, written: str, fix: str) -> None:
    files = Files.right(NAMES[0])
    path = files.path("node")
    files.texts[path] = files.texts[path].replace("self.count = 0", written)
    found = next(one for one in of_workspace(files.write(tmp_path)) if one.code == "node-property")
    assert found.fix.startswith(fix)
