"""What a function does in a single run, in which it takes one of several branches."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence

from ros2lab.diagnose.sources.python_source import Function, children
from ros2lab.diagnose.sources.static_value import dotted

_EXITS = frozenset(("exit", "quit", "sys.exit", "os._exit"))
_Calls = list[ast.Call]
_IsAsked = Callable[[ast.Call], bool]


def calls_in_one_run(function: Function, is_asked: _IsAsked) -> _Calls:
    """Return the calls of a kind that a function makes in the run that makes the most of them.

    Args:
        function: the function.
        is_asked: whether a call is of that kind.
    """
    goes_on, ended = _of_block(function.body, is_asked)
    return max(goes_on or [], ended, key=len)


def _of_block(block: Sequence[ast.stmt], is_asked: _IsAsked) -> tuple[_Calls | None, _Calls]:
    """Return the most calls of a run that reaches the end of a block (None: no run does), and of one that leaves the function."""
    goes_on: _Calls | None = []
    ended: _Calls = []
    for statement in block:
        if goes_on is None:
            break
        before = [*goes_on, *_asked_in(_heads(statement), is_asked)]
        goes_on = before if not _branches(statement) and not _leaves(statement) else None
        if _leaves(statement):
            ended = max(ended, before, key=len)
        for branch in _branches(statement):
            inner, left = _of_block(branch, is_asked)
            ended = max(ended, [*before, *left], key=len)
            if inner is not None:
                goes_on = max(goes_on or [], [*before, *inner], key=len)
    return goes_on, ended


def _branches(statement: ast.stmt) -> list[list[ast.stmt]]:
    """Return the blocks of a statement of which a run takes only one; empty if it has none."""
    match statement:
        case ast.If() | ast.For() | ast.AsyncFor() | ast.While():
            return [statement.body, statement.orelse]
        case ast.Match():
            return [*(case.body for case in statement.cases), []]
        case ast.Try():
            done = [*statement.body, *statement.orelse, *statement.finalbody]
            return [done, *([*handler.body, *statement.finalbody] for handler in statement.handlers)]
        case ast.With() | ast.AsyncWith():
            return [statement.body]
    return []


def _heads(statement: ast.stmt) -> Iterator[ast.expr]:
    """Yield the expressions that a statement evaluates itself, outside its blocks."""
    if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
        return
    items = [item.context_expr for item in getattr(statement, "items", [])]
    yield from (node for node in [*children(statement), *items] if isinstance(node, ast.expr))


def _asked_in(expressions: Iterator[ast.expr] | list[ast.expr], is_asked: _IsAsked) -> Iterator[ast.Call]:
    for expression in expressions:
        if isinstance(expression, ast.Call) and is_asked(expression):
            yield expression
        if isinstance(expression, ast.IfExp):
            ways = [[*_asked_in([way], is_asked)] for way in (expression.body, expression.orelse)]
            yield from max(ways, key=len)
        elif not isinstance(expression, ast.Lambda):
            inner = [node.value if isinstance(node, ast.keyword) else node for node in children(expression)]
            yield from _asked_in([node for node in inner if isinstance(node, ast.expr)], is_asked)


def _leaves(statement: ast.stmt) -> bool:
    """Return whether the function ends at a statement."""
    value = statement.value if isinstance(statement, ast.Expr) else None
    is_exit = isinstance(value, ast.Call) and dotted(value.func) in _EXITS
    return is_exit or isinstance(statement, (ast.Return, ast.Raise))
