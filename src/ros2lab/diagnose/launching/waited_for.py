"""Note, while a launch file is loaded, the event handlers that wait for an action which launch never begins.

It runs in the process that loads launch files.
"""

from __future__ import annotations

import inspect
from collections.abc import Collection, Iterator
from types import FrameType
from typing import Any

_TARGETS = ("target_action", "target_lifecycle_node", "action_matcher")


class WaitedFor:
    """The event handlers that a file makes, each with the action that it waits for."""

    def __init__(self) -> None:
        self._targets: dict[int, tuple[Any, Any, int | None]] = {}
        self._functions: list[Any] = []
        self._registered: list[Any] = []

    def made(self, handler: Any, frame: FrameType | None, line: int | None) -> None:
        """Note what a handler is given: by the frames in which it is made."""
        from launch import Action

        while frame is not None and frame.f_locals.get("self") is handler:
            for name, value in frame.f_locals.items():
                if name in _TARGETS and isinstance(value, Action):
                    self._targets[id(handler)] = (handler, value, line)
                elif inspect.isfunction(value) or inspect.ismethod(value):
                    self._functions.append(value)
            frame = frame.f_back

    def registered(self, action: Any) -> None:
        """Note a handler that an action registers."""
        self._registered.append(getattr(action, "event_handler", None))

    def lost(self, reached: Collection[int]) -> Iterator[tuple[str, Any, int]]:
        """Yield the class, the action and the line of each handler whose action is not reached, and that no function may give to launch."""
        for handler in self._registered:
            _, target, line = self._targets.get(id(handler), (None, None, None))
            is_there = target is None or id(target) in reached
            if line and not is_there and not any(_may_give(given, target, []) for given in self._functions):
                yield type(handler).__name__, target, line


def _may_give(function: Any, target: Any, seen: list[Any]) -> bool:
    """Return whether a function knows an action, or what it knows is not to be told."""
    if function in seen:
        return False
    seen.append(function)
    try:
        known = inspect.getclosurevars(function)
    except (TypeError, ValueError):
        return True
    held = [
        *known.nonlocals.values(),
        *known.globals.values(),
        *(getattr(function, "__defaults__", ()) or ()),
    ]
    held += [item for value in held if isinstance(value, (list, tuple, set)) for item in value]
    held += [item for value in held if isinstance(value, dict) for item in value.values()]
    inner = (value for value in held if inspect.isfunction(value))
    return any(value is target for value in held) or any(_may_give(one, target, seen) for one in inner)
