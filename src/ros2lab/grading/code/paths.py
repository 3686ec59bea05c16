"""Which parts of a statement can be reached, by its constants."""

from __future__ import annotations

import ast
import builtins
import contextlib
from collections.abc import Collection, Iterator
from weakref import WeakKeyDictionary

from ros2lab.diagnose.code.bound_names import undefined_names
from ros2lab.diagnose.sources.python_source import PythonSource, children, walk

_LEAVES = (ast.Return, ast.Raise, ast.Continue, ast.Break)
_PLAIN = (ast.Pass, ast.Expr, ast.Assign, ast.Constant, ast.Name, ast.Attribute, ast.expr_context)
_EXITS = frozenset(("sys.exit", "os._exit", "exit", "quit"))
_UNDEFINED = WeakKeyDictionary[PythonSource, set[str]]()  # the results of `_undefined_in`


class Paths:
    """The paths through the code of some files: constants close a branch, and nothing follows a statement that leaves.

    Args:
        is_living: whether only what runs while a program lives counts: nothing after a spin, or a name that nothing
            defines.
        vain: the places of what does nothing.
    """

    def __init__(self, *, is_living: bool = False, vain: Collection[str] = ()) -> None:
        self._is_living = is_living
        self._vain = vain

    def reached(self, source: PythonSource, node: ast.AST) -> Iterator[ast.AST]:
        """Yield the parts of a node that are reached if the node is."""
        if isinstance(node, ast.expr) and not isinstance(node, (ast.BoolOp, ast.IfExp)):
            yield from children(node)
            return
        shut = set[str]()
        match node:
            case ast.If(test=test) | ast.IfExp(test=test):
                truth = _truth(test)
                shut = {"orelse"} if truth else {"body"} if truth is False else set()
            case ast.While(test=values) | ast.For(iter=values):
                shut = {"body"} if _truth(values) is False else set()
            case ast.Try(body=body):
                shut = {"handlers"} if all(map(_cannot_fail, body)) else set()
                if self._ends(source, body):
                    shut = {"handlers", "orelse", "finalbody"}
            case ast.BoolOp():
                yield from _joined(node)
                return
        for name, value in ast.iter_fields(node):
            if name not in shut:
                yield from self._until_left(source, value if isinstance(value, list) else [value])

    def is_vain(self, source: PythonSource, part: ast.AST) -> bool:
        """Return whether a definition or a statement begins at the place of what does nothing, or a simple statement holds it."""
        if not self._vain or not isinstance(part, ast.stmt):
            return False
        last = part.lineno if hasattr(part, "body") else part.end_lineno or part.lineno
        return any(source.at(line) in self._vain for line in range(part.lineno, last + 1))

    def _until_left(self, source: PythonSource, parts: list[object]) -> Iterator[ast.AST]:
        """Yield the statements of a block up to the first that leaves it."""
        for part in parts:
            if not isinstance(part, ast.AST) or self.is_vain(source, part):
                continue
            if self._is_living and _fails(source, part):
                return
            yield part
            if not isinstance(part, ast.stmt):
                continue
            is_endless = isinstance(part, ast.While) and _truth(part.test) is True and not _breaks(part)
            if _leaves(source, part) or self._ends(source, [part]) or (self._is_living and is_endless):
                return

    def _ends(self, source: PythonSource, body: list[ast.AST] | list[ast.stmt]) -> bool:
        """Return whether a program is over after some statements: it has spun, or shut rclpy down."""
        return self._is_living and any(_ends(source, part) for part in body)


def _joined(node: ast.BoolOp) -> Iterator[ast.AST]:
    yield node.op
    decides = isinstance(node.op, ast.Or)
    for operand in node.values:
        yield operand
        if _truth(operand) is decides:
            return


def _fails(source: PythonSource, part: ast.AST) -> bool:
    """Return whether a statement fails by an undefined name, so that nothing after it is reached."""
    is_plain = isinstance(part, (ast.Expr, ast.Assign, ast.AugAssign, ast.Return))
    if not is_plain or not (undefined := _undefined_in(source)):
        return False
    inside = [*walk(part)]
    return not any(isinstance(node, ast.Lambda) for node in inside) and any(
        isinstance(node, ast.Name) and node.id in undefined for node in inside
    )


def _undefined_in(source: PythonSource) -> set[str]:
    """Return the undefined names in a file; they are the same in each round."""
    if source not in _UNDEFINED:
        _UNDEFINED[source] = set()
        with contextlib.suppress(RecursionError):
            _UNDEFINED[source] = {name for name, _ in undefined_names(source)}
    return _UNDEFINED[source]


def _ends(source: PythonSource, part: ast.AST) -> bool:
    match part:
        case ast.Expr(value=ast.Call(func=ast.Attribute(attr="spin"))):
            return True
        case ast.Expr(value=ast.Call(func=function)):
            return source.resolve(function) in ("rclpy.spin", "rclpy.shutdown", "rclpy.try_shutdown")
        case ast.Try(body=body) | ast.With(body=body):
            return any(_ends(source, statement) for statement in body)
    return False


def _leaves(source: PythonSource, part: ast.AST) -> bool:
    match part:
        case ast.Expr(value=ast.Call(func=function)):
            return source.resolve(function) in _EXITS
    return isinstance(part, _LEAVES)


def ends_program(source: PythonSource, part: ast.AST) -> bool:
    """Return whether a statement ends its program, or never ends itself."""
    is_left = isinstance(part, ast.Raise) or (isinstance(part, ast.Expr) and _leaves(source, part))
    return is_left or _ends(source, part)


def _breaks(loop: ast.While) -> bool:
    return any(isinstance(node, ast.Break) for node in walk(loop))


def _truth(test: ast.expr) -> bool | None:
    """Return whether a condition of constants holds; None if it is not made of constants."""
    match test:
        case ast.Constant(value=value):
            return bool(value)
        case ast.List(elts=parts) | ast.Tuple(elts=parts) | ast.Dict(values=parts):
            return bool(parts)
        case ast.UnaryOp(op=ast.Not(), operand=inner):
            return None if (truth := _truth(inner)) is None else not truth
        case ast.BoolOp(op=sign, values=values):
            decides, truths = isinstance(sign, ast.Or), [*map(_truth, values)]
            return decides if decides in truths else None if None in truths else not decides
        case ast.Compare(left=ast.Constant(), comparators=[ast.Constant()]):
            with contextlib.suppress(TypeError):
                return bool(eval(compile(ast.Expression(test), "", "eval"), {}))  # noqa: S307 -- two constants
    return None


def _cannot_fail(statement: ast.stmt) -> bool:
    """Return whether a statement only assigns constants, what types make of constants, or other names."""
    made = [node for node in walk(statement) if is_made_of_constants(node)]
    return all(
        node in made
        or (
            isinstance(node, _PLAIN)
            and not (isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load))
        )
        for node in walk(statement)
    )


def is_made_of_constants(node: ast.AST) -> bool:
    """Return whether a node calls a built-in type with constants only, such as `float("2.0")`."""
    match node:
        case ast.Call(func=ast.Name(id=name), args=[*given], keywords=[]):
            is_type = isinstance(getattr(builtins, name, None), type)
            return is_type and all(isinstance(argument, ast.Constant) for argument in given)
    return False
