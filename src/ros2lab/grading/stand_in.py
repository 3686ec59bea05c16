"""Stands in for a module that is not installed where a submission is graded: all that is in it does nothing.

Its text is put into a box under the names of such modules; nothing else of the grader is there.
"""

from __future__ import annotations

import importlib.abc
import importlib.machinery
import sys
from collections.abc import Iterator, Sequence
from types import ModuleType
from typing import Any


class Nothing:
    """Can be called, indexed, counted, entered and derived from; it is empty, zero and false."""

    def __init__(self, *_: Any, **__: Any) -> None:
        pass

    def __call__(self, *_: Any, **__: Any) -> Nothing:
        """Do nothing."""
        return self

    def __getattr__(self, name: str) -> Nothing:
        if name.startswith("__"):
            raise AttributeError(name)
        return Nothing()

    def __mro_entries__(self, _: tuple[Any, ...]) -> tuple[type, ...]:
        return (Nothing,)

    def __enter__(self) -> Nothing:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def __iter__(self) -> Iterator[Any]:
        return iter(())

    def __len__(self) -> int:
        return 0

    def __getitem__(self, _: Any) -> Nothing:
        return self

    def __setitem__(self, _: Any, __: Any) -> None:
        pass

    def __float__(self) -> float:
        return 0.0

    def __index__(self) -> int:
        return 0

    def __add__(self, _: Any) -> Nothing:
        return self

    def __lt__(self, _: Any) -> bool:
        return False

    __int__ = __index__
    __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __rtruediv__ = __add__
    __gt__ = __le__ = __ge__ = __lt__


class _Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds whatever is imported from below a module that stands in."""

    def __init__(self, top: str) -> None:
        self._top = top

    def find_spec(
        self, name: str, _: Sequence[str] | None, __: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        is_below = name.startswith(f"{self._top}.")
        return importlib.machinery.ModuleSpec(name, self, is_package=True) if is_below else None

    def exec_module(self, module: ModuleType) -> None:
        module.__dict__["__getattr__"] = lambda name: _named(module.__name__, name)


def _named(module: str, name: str) -> Any:
    """Return what a module has under a name: in one of messages a type that can be published, else nothing."""
    if name.startswith("__"):
        raise AttributeError(name)
    if module.rpartition(".")[2] == "msg":
        from std_msgs.msg import Empty  # noqa: PLC0415 -- only where ROS is there

        return type(name, (Empty,), {"__getattr__": lambda _, __: Nothing()})
    return Nothing()


if __name__ != "ros2lab.grading.stand_in":
    sys.meta_path.append(_Finder(__name__))
    __path__: list[str] = []

    def __getattr__(name: str) -> Any:
        return _named(__name__, name)
