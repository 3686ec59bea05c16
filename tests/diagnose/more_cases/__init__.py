"""Mistakes of beginners as data, each of which is made for real.

The keys of a case, of which those with a default may be left out:

    name, mistake, source: what it is called, what was done, and the thread in which it was met
    change: {file: [old, new]} or {file: [[old, new], ...]}, in the right workspace
    put: {file: text} that is added
    shell: what else breaks the workspace, as commands typed in it
    needs: root, for what only root can do
    typed: one command, or all of them; the build and the sourcing come before, unless one of them is a build
    build: whether they do (true)
    elsewhere: what runs in another terminal meanwhile
    seen: what is then on the screen
    quiet: whether nothing of that is an error (false)
    clear: whether the error itself says the cause so well that it may be passed on (false)
    cause: what the sentence of a right cause holds
    place: the file that must be named, or some of which one must be; none if there is none
    advice: what a sufficient fix holds, where it is not a command that can be typed
    vague: what holds a cause that is true and does not help
    wrong: what holds an answer that does harm
    fix: the commands that set it right; without them the right files are put back
    well: what is on the screen then (a status, where one is published)
    verdict: what was judged of the first answer by hand, when these mistakes were collected

All that is looked for is a regular expression; capitals count only within (?-i:...).
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml
from right_workspace import right_workspace
from student_terminal import runs_a_node
from workspace_files import Files

VERDICTS = ("right", "insufficient", "vague", "unknown", "nothing", "wrong")
BUILT = ["colcon build", "source install/setup.bash"]
_STATUS = re.compile(r"ros2 launch my_bot|ros2 run my_bot status_publisher$|status_publisher\.py")


@dataclass(frozen=True)
class Case:
    """A mistake; the attributes are the keys of the data."""

    name: str
    mistake: str
    typed: Sequence[str]
    seen: str
    cause: str
    advice: str
    verdict: str
    source: str = ""
    change: Mapping[str, Sequence[Any]] = field(default_factory=dict)
    put: Mapping[str, str] = field(default_factory=dict)
    shell: Sequence[str] = ()
    needs: str = ""
    elsewhere: str = ""
    quiet: bool = False
    clear: bool = False
    place: Sequence[str] = ()
    vague: str = ""
    wrong: str = ""
    fix: Sequence[str] = ()
    well: str = ""

    def files(self) -> Files:
        """Return the workspace with the mistake, as far as it is one of its texts."""
        files = right_workspace()
        for name, changes in self.change.items():
            pairs = [changes] if isinstance(changes[0], str) else changes
            for old, new in pairs:
                files.change(name, old, new)
        for name, text in self.put.items():
            files.put(name, text)
        return files

    def places(self) -> list[str]:
        """Return the paths of which the place of a right answer holds one."""
        files = right_workspace()
        named = ("node", "listener", "driver", "setup.py", "package.xml", "launch/robot.launch.py")
        return [
            files.path(place) if place in (*named, "config/robot.yaml") else place for place in self.place
        ]

    def typed_after(self, fix: Sequence[str]) -> list[str]:
        """Return what is typed again after a fix: what ran, or the build, unless the fix did just that."""
        if any(runs_a_node(command) for command in fix):
            return []
        runs = [number for number, command in enumerate(self.typed) if runs_a_node(command)]
        if runs:
            return [command for command in self.typed[runs[0] :] if not command.startswith(("cd ", "sed "))]
        has_built = any(command.startswith("colcon build") for command in fix)
        return [] if has_built else list(self.typed)

    def sign(self) -> str:
        """Return what shows that all is well as soon as it is seen; nothing if that must be waited for."""
        if self.well or not _STATUS.search(self.typed[-1]):
            return self.well
        # The nodes of a launch file start together: by then, each has done something.
        return "Robot is running: 4" if "launch" in self.typed[-1] else "Robot is running: 0"

    def is_solved(self, text: str) -> bool:
        """Return whether the mistake can no longer be seen on a screen."""
        if self.well:
            return bool(re.search(self.well, text, re.MULTILINE))
        has_status = bool(_STATUS.search(self.typed[-1]))
        is_well = "Robot is running: 0" in text if has_status else True
        return is_well and not self.is_seen(text)

    def is_seen(self, text: str) -> bool:
        """Return whether a screen shows what the case is about."""
        return bool(re.search(self.seen, text, re.MULTILINE))


def _case(row: dict[str, Any]) -> Case:
    typed = row["typed"]
    typed = [typed] if isinstance(typed, str) else typed
    if row.pop("build", True) and not any(command.startswith("colcon") for command in typed):
        typed = [*BUILT, *typed]
    place = row.get("place", ())
    return Case(**{**row, "typed": typed, "place": [place] if isinstance(place, str) else place})


CASES = [
    _case(row)
    for path in sorted(Path(__file__).parent.glob("*.yaml"))
    for row in yaml.load(
        path.read_text(encoding="utf-8"), Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    )
]
