"""How a module of launch finds what is not in it yet: where it is defined, or that only the real package has it."""

from __future__ import annotations

import functools
import importlib
from collections.abc import Callable, Collection, Mapping
from typing import Any, NoReturn

ABSENT: dict[str, frozenset[str]] = {}  # of each module, what only the real one has


def lookup(
    module: str, *, defined_in: Mapping[str, str] | None = None, absent: Collection[str] = ()
) -> Callable[[str], Any]:
    """Return a module's `__getattr__`, which imports what is asked for.

    A name that is in none of these is looked for among the modules below this one.

    Args:
        module: its name.
        defined_in: of each name, the module below this one that defines it.
        absent: what only the real package has; it may be imported, and says so when it is used.
    """
    ABSENT[module] = frozenset(absent)
    modules = defined_in or {}

    def getattr_of_module(name: str) -> Any:
        if name in modules:
            return getattr(importlib.import_module(f"{module}.{modules[name]}"), name)
        if name in absent:
            return _stand_in(module, name)
        if not name.startswith("_"):
            try:
                return importlib.import_module(f"{module}.{name}")
            except ModuleNotFoundError as error:
                if error.name != f"{module}.{name}":
                    raise
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
