"""Where exceptions are caught by name, and where every one is."""

from __future__ import annotations

import ast

from ros2lab.diagnose.static_value import dotted

_EVERY_ERROR = frozenset(("", "Exception", "BaseException"))
_ENDS = frozenset(("KeyboardInterrupt", "ExternalShutdownException", "SystemExit"))


def is_by_name(handler: ast.ExceptHandler) -> bool:
    """Return whether an `except` names the errors that it expects, or tells of each and raises it again."""
    *tells, last = handler.body
    if tells and isinstance(last, ast.Raise) and last.exc is None:
        return True
    return _EVERY_ERROR.isdisjoint(_names(handler))


def is_of_an_end(handler: ast.ExceptHandler) -> bool:
    """Return whether an `except` catches nothing but that the program is asked to end, such as by Ctrl-C."""
    return {name.rpartition(".")[2] for name in _names(handler)} <= _ENDS


def _names(handler: ast.ExceptHandler) -> set[str]:
    """Return the names of the errors that an `except` catches; an empty one if it catches every one."""
    kinds = handler.type.elts if isinstance(handler.type, ast.Tuple) else [handler.type]
    return {dotted(kind) or "?" if kind else "" for kind in kinds}
