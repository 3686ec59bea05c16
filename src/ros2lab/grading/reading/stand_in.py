"""A stand-in for a module that is not installed on the grading machine: everything in it does nothing.

What it tells is empty, zero and false; where programs are given what they may wait for, it is one and true.

Its source is put into a box under the names of such modules; nothing else of the grader is there.
Every error that one of its objects causes names the class `NotInstalledHere`, so that nobody is blamed for
it.
"""

from __future__ import annotations

import abc
import dis
import functools
import importlib.abc
import importlib.machinery
import itertools
import os
import sys
import time
from collections.abc import Iterator, Sequence
from types import ModuleType
from typing import Any

_UNPACKS = {dis.opmap[name] for name in ("UNPACK_SEQUENCE", "UNPACK_EX")}  # the latter for `major, *rest`
# After this many calls, each takes some time, in s: a loop paced by a microphone or a camera would never
# rest.
_UNPACED, _PACE = 10_000, 0.001
_calls = itertools.count()
SAYS_YES = "ROS2LAB_STAND_IN_SAYS_YES"  # in the environment where it is one and true
_TOLD = int(SAYS_YES in os.environ)


class _Nothing:
    """The behaviour of everything in such a module, classes as well as objects."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(f"NotInstalledHere has no {name}")
        return _kind(name)

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def __iter__(self) -> Iterator[Any]:
        """Yield nothing, or one if it says yes, or as many values as it is unpacked into, as in `success, image = camera.read()`."""
        caller = sys._getframe(1)
        code, at = caller.f_code.co_code, caller.f_lasti
        return itertools.repeat(NotInstalledHere(), code[at + 1] if code[at] in _UNPACKS else _TOLD)

    def __len__(self) -> int:
        return _TOLD

    def __format__(self, _: str) -> str:
        return ""

    def __getitem__(self, _: Any) -> Any:
        return self

    def __setitem__(self, _: Any, __: Any) -> None:
        pass

    def __float__(self) -> float:
        return float(_TOLD)

    def __index__(self) -> int:
        return _TOLD

    def __abs__(self) -> Any:
        return self

    def __add__(self, _: Any) -> Any:
        return self

    def __radd__(self, before: Any) -> Any:
        """Return a text as it is, for the log takes nothing else."""
        return before if isinstance(before, str) else self

    def __lt__(self, _: Any) -> bool:
        return bool(_TOLD)

    @property
    def args(self) -> Any:
        """Another stand-in, not an exception's arguments: a parser's result may have `args`, too."""
        return _kind("args")

    __int__ = __index__
    __neg__ = __abs__
    __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __rtruediv__ = __pow__ = __mod__ = __add__
    __gt__ = __le__ = __ge__ = __lt__


class NotInstalledHereType(_Nothing, abc.ABCMeta):
    """The metaclass of such classes, which can be combined with any base class and called with anything."""

    def __new__(mcs, name: str, bases: tuple[type, ...], namespace: dict[str, Any]) -> NotInstalledHereType:
        """Make a class; without exceptions among its bases if these do not fit with the others."""
        try:
            return super().__new__(mcs, name, bases, namespace)
        except TypeError:
            plain = dict.fromkeys(_Nothing if isinstance(base, mcs) else base for base in bases)
            return super().__new__(mcs, name, (*plain,), namespace)

    def __call__(cls, *given: Any, **named: Any) -> Any:
        """Make an object; like `NotInstalledHere.__call__`, take a little time if called without end."""
        _rest()
        return super().__call__(*given, **named)

    @property
    def register(cls) -> Any:
        """A stand-in, not the method of abstract classes."""
        return _kind("register")


class NotInstalledHere(  # type: ignore[override]  # noqa: N818 -- it is much else than an error
    _Nothing, Exception, metaclass=NotInstalledHereType
):
    """Can be called, indexed, counted, unpacked, entered, subclassed, raised and caught."""

    def __init__(self, *_: Any, **__: Any) -> None:
        pass

    def __call__(self, *_: Any, **__: Any) -> NotInstalledHere:
        """Do nothing, and take a little time if called without end."""
        _rest()
        return self

    def __eq__(self, other: object) -> bool:
        return bool(_TOLD) or self is other

    def __hash__(self) -> int:
        return id(self)

    def __str__(self) -> str:
        """Return this class's name, also for exceptions that the submission derives from it."""
        return NotInstalledHere.__name__


@functools.cache
def _kind(_: str) -> Any:
    """Return the class for a name in such a module or object, always the same, so that it can be caught."""
    return NotInstalledHereType(NotInstalledHere.__name__, (NotInstalledHere,), {"__module__": __name__})


def _rest() -> None:
    if next(_calls) > _UNPACED:
        time.sleep(_PACE)


class _Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds everything that is imported from below a stand-in module."""

    def __init__(self, top: str) -> None:
        self._top = top

    def find_spec(
        self, name: str, _: Sequence[str] | None, __: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        if not name.startswith(f"{self._top}."):
            return None
        spec = importlib.machinery.ModuleSpec(name, self, origin=__file__, is_package=True)
        spec.has_location = True  # so that it has all that Python gives to a module
        return spec

    def exec_module(self, module: ModuleType) -> None:
        module.__dict__.update(__all__=[], __getattr__=lambda name: _named(module.__name__, name))


def _named(module: str, name: str) -> Any:
    """Return what a module has under a name that it was not given: an interface type in `msg` and `srv`, else a stand-in."""
    kind = module.rpartition(".")[2]
    if kind == "msg" and not name.startswith("__"):
        from std_msgs.msg import Empty  # noqa: PLC0415 -- only where ROS is there

        Empty.__getattr__ = _anything  # also for messages that are received
        return _tolerant(name, Empty)
    if kind == "srv" and not name.startswith("__"):
        from std_srvs.srv import Empty as Call  # noqa: PLC0415

        Call.Response.__getattr__ = Call.Request.__getattr__ = _anything
        inner = {part: _tolerant(f"{name}_{part}", getattr(Call, part)) for part in ("Request", "Response")}
        return type(Call)(name, (Call,), inner)
    return _kind(name)


def _tolerant(name: str, message: Any) -> Any:
    """Return a message type that has any field and constant that it is asked for."""
    meta = type(type(message).__name__, (type(message),), {"__getattr__": _anything})
    return meta(name, (message,), {"__init__": lambda self, **_: message.__init__(self)})


def _anything(_: object, name: str) -> Any:
    if name.startswith("_"):
        raise AttributeError(f"NotInstalledHere has no {name}")
    return _kind(name)


if __name__ != "ros2lab.grading.reading.stand_in":
    sys.meta_path.append(_Finder(__name__))
    __path__: list[str] = []
    __all__: list[str] = []

    def __getattr__(name: str) -> Any:
        return _named(__name__, name)
