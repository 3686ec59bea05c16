"""What there is beside the Python files of a package: what they may import, and what else may name their topics."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from ros2lab.diagnose.sources.file_texts import bytes_of
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, read_text


@dataclass(frozen=True)
class Beyond:
    """The modules that are not among a package's files.

    Attributes:
        modules: the files of all packages of the workspace, by the names of their modules.
        is_made: whether a module without a file is there once the package is built.
        written: the last parts of the names of the modules that the build is seen to write.
        is_cmake: whether the build can make modules of messages, once it is told to.
        packages: the names of all packages of the workspace, of which some bring only messages.
        interfaces: the names of the interfaces of the workspace, by their modules, such as `my_robot.srv`.
    """

    modules: Mapping[str, PythonSource] = field(default_factory=dict)
    is_made: Callable[[str], bool] = lambda _: False
    written: Callable[[], Collection[str]] = frozenset
    is_cmake: bool = False
    packages: Collection[str] = ()
    interfaces: Mapping[str, frozenset[str]] = field(default_factory=dict)


NOTHING = Beyond()


_LARGEST = 200_000  # bytes; a longer file is a mesh, a map or a recording
_MOST = 2000  # files
# Prose names everything, and what builds a package starts nothing.
_PROSE = frozenset((".md", ".rst", ".txt", ".msg", ".srv", ".action"))
_BUILDING = frozenset(("package.xml", "setup.py", "setup.cfg"))


class OtherFiles:
    """The files of some packages in which programs may name a topic or a service without being read.

    They are opened only when the first name is looked up.
    """

    def __init__(self, packages: Iterable[SourcePackage] = ()) -> None:
        self._packages = tuple(packages)

    def name(self, name: str, *, is_whole: bool = False) -> bool:
        """Return whether any of the files contains a name of a topic or a service, as a word of its own, or as a whole."""
        pattern = re.compile(rf"(?<![\w-]){re.escape(name.lstrip('~/'))}(?![\w-])")
        if is_whole:
            pattern = re.compile(rf"(?<![\w/-]){re.escape(name)}(?![\w/-])")
        return any(pattern.search(text) for text in self._texts)

    @cached_property
    def _texts(self) -> list[str]:
        found: list[str] = []
        for path in self._paths():
            if len(found) < _MOST and path.stat().st_size < _LARGEST and b"\0" not in bytes_of(path)[:1000]:
                found.append(read_text(path))
        return found

    def _paths(self) -> Iterator[Path]:
        for package in self._packages:
            read = {source.path for source in package.sources.values()}
            for path in package.own_files():
                is_prose = path.suffix.lower() in _PROSE or path.name in _BUILDING
                if path not in read and not is_prose and path.is_file():
                    yield path
