"""What the files of a package may import beside each other."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

from ros2lab.diagnose.sources.python_source import PythonSource


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
