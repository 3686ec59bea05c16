"""Whose program a command of a README starts."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import PurePosixPath
from typing import Literal

from ros2lab.diagnose.explaining.ros_1_tools import ROS_1_TOOLS
from ros2lab.diagnose.sources.interfaces import PACKAGES
from ros2lab.diagnose.sources.spelling import has_other_words, is_near_miss, words_of
from ros2lab.grading.evidence import Executable
from ros2lab.grading.receiving.submission import Submission

Owner = Literal["own", "neighbour", "tool", "unknown"]
# The commands of ROS 1, also the one that sets up its workspaces.
ROS_1 = rf"{'|'.join(ROS_1_TOOLS)}|source +\S*\bdevel/setup\.\w+"
_PLACEHOLDER = re.compile(r"[\[({<].*|.*\.\.|…|[A-Z][A-Z_]+")


def is_placeholder(word: str) -> bool:
    """Return whether a word of a command is a placeholder that its reader is to replace."""
    return _PLACEHOLDER.fullmatch(word) is not None


def is_of_ros_1(command: str) -> bool:
    """Return whether a command is of ROS 1, which no ROS 2 has."""
    return re.match(rf"(?:{ROS_1})(?!\S)", command) is not None


class Owners:
    """Tells whose program a command starts, the same for all who judge it.

    Args:
        submission: what was handed in.
        executables: the programs of the graded package.
        launch_files: paths of its launch files.
    """

    def __init__(
        self, submission: Submission, executables: Iterable[Executable], launch_files: Iterable[str]
    ) -> None:
        found = submission.package
        # If setup.py and package.xml differ, a README may use either name; the folder's is the likelier one.
        names = (found.name, PurePosixPath(found.folder).name) if found else ()
        self.own = {name for name in names if name}
        self._beside = {package.name for package in submission.packages if package.name} - self.own
        self.programs = {name for program in executables for name in (program.name, program.stem) if name}
        self._launches = {PurePosixPath(path).name for path in launch_files}

    def of(self, words: Sequence[str]) -> Owner | None:
        """Return whose program a command starts; None if it starts none, or leaves the package open.

        A package that is nowhere here is meant as the own one if it nearly has its name, or if the program is one of
        the own ones, with or without `.py`.
        """
        match words:
            case ["ros2", "run" | "launch", package, _, *_] if not is_placeholder(package):
                if package in self.own:
                    return "own"
                if package in self._beside:
                    return "neighbour"
                if package in PACKAGES:
                    return "tool"
                is_own = self.names_program(words) or any(_is_like(package, own) for own in self.own)
                return "own" if is_own else "unknown"
        return None

    def names_program(self, words: Sequence[str]) -> bool:
        """Return whether a command runs or launches what the graded package has, in whatever package."""
        match words:
            case ["ros2", "run", _, name, *_]:
                return not self.programs.isdisjoint((name, name.removesuffix(".py")))
            case ["ros2", "launch", _, name, *_]:
                return name in self._launches
        return False


def _is_like(package: str, own: str) -> bool:
    """Return whether a package's name is another one misspelt, or shortened in its words."""
    is_as_long = len(words_of(package)) == len(words_of(own)) > 1
    return is_near_miss(package, own) or (is_as_long and not has_other_words(package, own))
