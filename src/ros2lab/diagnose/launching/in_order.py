"""Note, while launch visits the actions of a file in their order, what they set or pass on for nobody.

It runs in the process that loads launch files.
"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ros2lab import every_node

_LineOf = Callable[[Any], "int | None"]
# They open and close scopes, and set nothing of their own.
_OF_SCOPES = re.compile(r"(Push|Pop|Reset)(Environment|LaunchConfigurations)$")

_NAMESPACE = "ros_namespace"  # where launch keeps it


@dataclass
class _Scope:
    """What has happened in a group, or outside of all: the first program started, and what was set after the last use."""

    first: dict[str, Any] | None = None
    unused: list[Any] = field(default_factory=list)
    setters: dict[str, Any] = field(default_factory=dict)  # the include that has set a configuration


class InOrder:
    """What the actions of a file set that no later one can use, and the arguments that an included file does not have."""

    def __init__(self, line_of: _LineOf) -> None:
        self._line_of = line_of
        self._scopes = [_Scope()]
        self._late: list[dict[str, Any]] = []
        self._depth = 0  # of files that include each other
        self._is_known = True
        self.lost: list[dict[str, Any]] = []
        self._include: Any = None  # that of the file itself in which launch is
        self._starting: list[Any] = []  # the includes that start programs
        self._shared: list[dict[str, Any]] = []

    @property
    def shared(self) -> list[dict[str, Any]]:
        """The defaults and namespaces of included files that what an earlier one has set changes."""
        return self._shared if self._is_known else []

    @property
    def late(self) -> list[dict[str, Any]]:
        """What is set too late: in a group, or at the end of the file."""
        left = [*self._late, *self._set_late(self._scopes[0], is_group=False)]
        return left if self._is_known else []

    def visit(self, action: Any, context: Any) -> list[Any]:
        """Let launch do an action, and return what it is to do next."""
        from launch.actions import DeclareLaunchArgument, OpaqueFunction

        before = _state(context)
        following = list(action.visit(context) or [])
        kind = type(action).__name__
        if kind == "PushLaunchConfigurations":
            self._scopes.append(_Scope(setters={**self._scopes[-1].setters}))
        elif kind == "PopLaunchConfigurations":
            ended = self._scopes.pop() if len(self._scopes) > 1 else _Scope()
            self._late += self._set_late(ended, is_group=True)
        elif isinstance(action, OpaqueFunction) and self._line_of(action) is None:
            pass  # launch itself makes it at the end of an included file
        elif not _OF_SCOPES.match(kind):
            is_set = before != _state(context)
            with contextlib.suppress(Exception):  # a default may ask for anything
                self._note_shared(action, before[0], context)
            if not is_set or isinstance(action, (DeclareLaunchArgument, OpaqueFunction)):
                self.used()
            elif self._depth == 1:
                self._scopes[-1].unused.append(action)
        return following

    @contextlib.contextmanager
    def within(self, action: Any, following: Sequence[Any], context: Any) -> Any:
        """Hold while what follows an action is visited, which may include a file."""
        from launch.actions import IncludeLaunchDescription

        is_file = isinstance(action, IncludeLaunchDescription)
        if is_file and self._depth == 1:
            with contextlib.suppress(Exception):  # a source may be of any class
                self._compare(action, following, context)
            self._include = action
        self._depth += is_file
        yield
        self._depth -= is_file
        if self._depth == 1:
            self._include = None

    def used(self) -> None:
        """Note that an action may use all that is set so far."""
        for scope in self._scopes:
            scope.unused.clear()

    def started(self, executable: str | None, line: int | None) -> None:
        """Note that a program is started."""
        self.used()
        for scope in self._scopes:
            scope.first = scope.first or {"executable": executable, "line": line}
        self._starting.append(self._include)

    def waits(self) -> None:
        """Note that some actions run at another time, so that the order of the file is not theirs."""
        self._is_known = False

    def _note_shared(self, action: Any, before: dict[str, Any], context: Any) -> None:
        """Note whose values count from now on, and that an argument or a namespace is not what its file makes it alone."""
        from launch.actions import DeclareLaunchArgument
        from launch.utilities import perform_substitutions

        known, setters = context.launch_configurations, self._scopes[-1].setters
        for name in (name for name in known if before.get(name) != known[name]):
            if name == _NAMESPACE and str(known[name]).startswith(f"{before.get(name)}/"):
                self._share(name, "", known[name], setters.get(name))
            setters[name] = self._include
        name = action.name if isinstance(action, DeclareLaunchArgument) else ""
        is_plain = name in before and name not in every_node.PARAMETERS and action.condition is None
        if is_plain and action.default_value is not None:
            alone = perform_substitutions(context, action.default_value)
            if alone != before[name]:
                self._share(name, alone, before[name], setters.get(name))

    def _share(self, name: str, alone: str, value: str, setter: Any) -> None:
        own = self._include
        if self._depth == 2 and setter in self._starting and setter not in (own, None):
            files = [Path(one.launch_description_source.location).name for one in (setter, own)]
            row = {"name": name, "alone": alone, "value": value, "files": files, "line": self._line_of(own)}
            self._shared.append(row)

    def _set_late(self, scope: _Scope, *, is_group: bool) -> list[dict[str, Any]]:
        first = scope.first
        if self._depth > 1 or first is None:
            return []
        return [
            {
                "kind": type(action).__name__,
                "line": self._line_of(action),
                "first": first,
                "is_group": is_group,
            }
            for action in scope.unused
        ]

    def _compare(self, include: Any, following: Sequence[Any], context: Any) -> None:
        """Note the arguments that an included file is given and does not declare."""
        from launch import LaunchDescription
        from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions

        names = [
            perform_substitutions(context, normalize_to_list_of_substitutions(name))
            for name, _ in include.launch_arguments
        ]
        self._scopes[-1].setters |= dict.fromkeys(names, include)
        (description,) = (one for one in following if isinstance(one, LaunchDescription))
        path = Path(include.launch_description_source.location)
        takes = [argument.name for argument in description.get_launch_arguments()]
        free = sorted({*takes} - {*names})
        place = {"path": str(path.resolve()), "free": free, "line": self._line_of(include)}
        self.lost += [{"name": name, **place} for name in names if free and name not in takes]


def _state(context: Any) -> tuple[dict[str, Any], dict[str, str]]:
    """Return what actions set: launch configurations, some of them lists that grow, and environment variables."""
    known = context.launch_configurations.items()
    return {name: [*value] if isinstance(value, list) else value for name, value in known}, {
        **context.environment
    }
