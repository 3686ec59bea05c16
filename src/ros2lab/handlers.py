"""Where exceptions are caught by name, and where every one is."""

from __future__ import annotations

import ast

from ros2lab.diagnose.static_value import dotted

_EVERY_ERROR = frozenset(("", "Exception", "BaseException"))


def is_by_name(handler: ast.ExceptHandler) -> bool:
    """Return whether an `except` names the errors that it expects, or tells of each and raises it again."""
    *tells, last = handler.body
    if tells and isinstance(last, ast.Raise) and last.exc is None:
        return True
    kinds = handler.type.elts if isinstance(handler.type, ast.Tuple) else [handler.type]
    return _EVERY_ERROR.isdisjoint({dotted(kind) or "?" if kind else "" for kind in kinds})
