"""Where exceptions are caught by name, and where every one is."""

from __future__ import annotations

import ast
import builtins
from collections import defaultdict
from collections.abc import Iterable

from ros2lab.diagnose.sources.static_value import dotted


def _is_no_error(kind: type) -> bool:
    return issubclass(kind, BaseException) and not issubclass(kind, Exception) and kind is not BaseException


EVERY_ERROR = frozenset(("", "Exception", "BaseException"))
# By what a program is asked to end: rclpy's own, and all of Python's that are no errors.
ENDS = frozenset(
    (
        "ExternalShutdownException",
        *(name for name, value in vars(builtins).items() if isinstance(value, type) and _is_no_error(value)),
    )
)
_FARTHEST = 20  # names that stand for one another


class Handlers:
    """What the handlers of a file catch, whatever it calls the errors.

    Args:
        nodes: everything in the file.
    """

    def __init__(self, nodes: Iterable[ast.AST]) -> None:
        self._stands_for: dict[str, list[ast.expr]] = defaultdict(list)
        for node in nodes:
            for name, meant in _bound(node):
                self._stands_for[name].append(meant)

    def only_raises_again(self, handler: ast.ExceptHandler) -> bool:
        """Return whether an `except` does nothing but raise what it has caught, as if it was not there."""
        match handler.body:
            case [ast.Raise(exc=None)]:
                return True
            case [ast.Raise(exc=ast.Name(id=name), cause=None)]:
                return name == handler.name
        return False

    def is_by_name(self, handler: ast.ExceptHandler) -> bool:
        """Return whether an `except` names the errors that it expects, or tells of each and raises it again."""
        *tells, last = handler.body
        if tells and isinstance(last, ast.Raise) and last.exc is None:
            return True
        return EVERY_ERROR.isdisjoint(self.caught(handler))

    def is_of_an_end(self, handler: ast.ExceptHandler) -> bool:
        """Return whether an `except` catches nothing but that the program is asked to end, such as by Ctrl-C."""
        return {name.rpartition(".")[2] for name in self.caught(handler)} <= ENDS

    def caught(self, handler: ast.ExceptHandler) -> set[str]:
        """Return the names of the errors that an `except` catches; an empty one if it catches every one."""
        found, followed = set[str](), set[str]()
        waiting = [handler.type]
        while waiting:
            kind = waiting.pop()
            name = dotted(kind) or "?" if kind else ""
            if isinstance(kind, ast.Tuple):
                waiting += kind.elts
            elif isinstance(kind, ast.Starred):
                waiting.append(kind.value)
            elif isinstance(kind, ast.BinOp):
                waiting += [kind.left, kind.right]
            elif name not in self._stands_for or len(followed) == _FARTHEST:
                found.add(name)
            elif name not in followed:
                followed.add(name)
                waiting += self._stands_for[name]
        return found


def _bound(node: ast.AST) -> Iterable[tuple[str, ast.expr]]:
    """Yield the names that a statement binds to something else that has a name, each with that."""
    match node:
        case ast.Assign(targets=targets, value=value):
            yield from ((target.id, value) for target in targets if isinstance(target, ast.Name))
        case ast.AnnAssign(target=ast.Name(id=name), value=ast.expr() as value):
            yield name, value
        case ast.NamedExpr(target=ast.Name(id=name), value=value):
            yield name, value
        case ast.ImportFrom(names=aliases):
            yield from ((alias.asname, ast.Name(alias.name)) for alias in aliases if alias.asname)
        case ast.ClassDef(name=name, bases=[base]) if (dotted(base) or "").rpartition(".")[2] in ENDS:
            yield name, base
