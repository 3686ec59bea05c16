"""What the real launch has and this one has not may be imported, and says so in one sentence when it is used."""

from __future__ import annotations

import functools
from collections.abc import Callable, Collection
from typing import Any, NoReturn

NAMES: dict[str, frozenset[str]] = {}  # of each module, what only the real one has


def absent(module: str, names: Collection[str]) -> Callable[[str], Any]:
    """Return a module's `__getattr__` that gives a stand-in for each name that only the real package has."""
    NAMES[module] = frozenset(names)

    def getattr_of_module(name: str) -> Any:
        if name in names:
            return _stand_in(module, name)
        raise AttributeError(f"module '{module}' has no attribute '{name}'")

    return getattr_of_module


def refuse(module: str, name: str) -> NoReturn:
    """Say that something is not here, and where it is.

    Raises:
        NotImplementedError: always.
    """
    package = module.partition(".")[0]
    raise NotImplementedError(
        f"{module}.{name} is not in this small {package}: it needs the real package {package}, "
        f"which an installed ROS 2 brings (apt install ros-jazzy-{package.replace('_', '-')})."
    )


@functools.cache
def _stand_in(module: str, name: str) -> type:
    """Return a class that can be named and derived from, and not be called."""

    def new(*_: object, **__: object) -> NoReturn:
        refuse(module, name)

    return type(name, (), {"__module__": module, "__new__": new})
