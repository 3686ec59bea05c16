"""What a function does in a single run, in which it takes one of several branches, and which errors stop nothing in it."""

from __future__ import annotations

import ast
import builtins
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TypeVar

from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import (
    PAUSES,
    Function,
    PythonSource,
    children,
    is_generator,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import calls_in

_EXITS = frozenset(("exit", "quit", "sys.exit", "os._exit"))
_BLOCKS = dict.fromkeys((ast.If, ast.While, ast.For, ast.AsyncFor, ast.IfExp), ("body", "orelse"))
_SCOPES = dict.fromkeys((ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda), ("body",))
_MANY = dict.fromkeys(
    (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp), ("elt", "key", "value", "generators")
)
# The parts of a node that do not always run when the node does, or not just then.
_DECIDED: Mapping[type[ast.AST], tuple[str, ...]] = {
    **_BLOCKS,
    **_SCOPES,
    **_MANY,
    ast.Try: ("handlers", "orelse"),
    ast.Match: ("cases",),
}
_Calls = list[ast.Call]
_IsAsked = Callable[[ast.Call], bool]
_State = TypeVar("_State")


def calls_in_one_run(function: Function, is_asked: _IsAsked) -> _Calls:
    """Return the calls of a kind that a function makes in the run that makes the most of them."""

    def made(calls: _Calls, statement: ast.stmt) -> _Calls:
        return [*calls, *_asked_in(heads(statement), is_asked)]

    end, left = runs_of(function.body, list[ast.Call](), made, lambda ways: max(ways, key=len))
    return max([end or [], *left], key=len)


def is_always_reached(function: Function | ast.Module, node: ast.AST) -> bool:
    """Return whether every run of a function comes to a node: no branch, loop or earlier `return` decides."""
    return _comes_to(function.body, node)


def in_loops(function: ast.AST) -> set[int]:
    """Return the nodes of a function, by `id`, that stand in a loop."""
    loops = (n for n in walk(function) if isinstance(n, (ast.While, ast.For, ast.AsyncFor)))
    return {id(inner) for loop in loops for inner in walk(loop)}


def run_once(
    sources: NodeSources, owner: NodeClass | None, function: Function, files: Iterable[ast.AST]
) -> set[int]:
    """Return what runs once with a function, by `id`: itself, and the methods that nothing else in some files names, without loops."""
    repeated = in_loops(function)
    once = {id(node) for node in own_nodes(function)} - repeated
    named = Counter(node.attr for node in files if isinstance(node, ast.Attribute))
    for name, call in own_calls(function).items():
        method = sources.method(owner, name)
        if method and not is_generator(method) and named[name] == 1 and id(call) not in repeated:
            once |= {id(node) for node in own_nodes(method)} - in_loops(method)
    return once


def own_calls(function: Function) -> dict[str, ast.Call]:
    """Return the calls of a function on `self`, by the names of their methods."""
    return {node.func.attr: node for node in calls_in(own_nodes(function)) if is_self_attribute(node.func)}


def _comes_to(block: Sequence[ast.stmt], node: ast.AST) -> bool:
    for statement in block:
        if node in walk(statement):
            return _passes(statement, node)
        if may_end(statement):
            return False
    return False


def may_end(statement: ast.stmt) -> bool:
    """Return whether the function may end at a statement or in it."""
    return any(isinstance(node, ast.stmt) and leaves(node) for node in _own(statement))


def _passes(statement: ast.stmt, node: ast.AST) -> bool:
    """Return whether every run of a statement comes to a node in it."""
    if isinstance(statement, (ast.With, ast.AsyncWith, ast.Try)):
        blocks = [statement.body, getattr(statement, "finalbody", [])]
        if inside := [block for block in blocks if any(node in walk(inner) for inner in block)]:
            return _comes_to(inside[0], node)
    parts = (node for outer in walk(statement) for part in decided(outer) for node in walk(part))
    return all(inner is not node for inner in parts)


def decided(node: ast.AST) -> list[ast.AST]:
    """Return the parts of a node that do not always run when it does, or not just then."""
    if isinstance(node, ast.BoolOp):
        return [*node.values[1:]]
    found: list[ast.AST] = []
    for name in _DECIDED.get(type(node), ()):
        part = getattr(node, name, None)
        found += part if isinstance(part, list) else [part] if part is not None else []
    return found


def _own(statement: ast.stmt) -> tuple[ast.AST, ...]:
    is_scope = isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef))
    return () if is_scope else (statement, *own_nodes(statement))


def is_steady(expression: ast.expr) -> bool:
    """Return whether an expression gives the same value each time that it is evaluated in one condition."""
    return not any(
        isinstance(node, (ast.NamedExpr, *PAUSES)) or (isinstance(node, ast.Call) and not _only_counts(node))
        for node in walk(expression)
    )


def _only_counts(call: ast.Call) -> bool:
    name = dotted(call.func) or ""
    return name in ("abs", "len", "int", "float", "round", "str", "min", "max") or name.startswith("math.")


def runs_of(
    block: Sequence[ast.stmt],
    state: _State,
    after: Callable[[_State, ast.stmt], _State],
    joined: Callable[[Sequence[_State]], _State],
    within: Callable[[_State, ast.stmt, int], _State] = lambda state, _statement, _number: state,
) -> tuple[_State | None, list[_State]]:
    """Follow every run through a block: what holds at its end (None: no run reaches it), and where runs leave the function.

    Args:
        block: the statements.
        state: what holds before them.
        after: what holds when a statement has evaluated what is outside its own blocks.
        joined: what holds after a statement, of what holds at the ends of those branches that have one.
        within: what holds at the beginning of a branch of a statement, by its number.
    """
    left: list[_State] = []
    for statement in block:
        state = after(state, statement)
        if leaves(statement):
            return None, [*left, state]
        if ways := branches(statement):
            ends: list[_State] = []
            for number, way in enumerate(ways):
                end, inner = runs_of(way, within(state, statement, number), after, joined, within)
                ends += [] if end is None else [end]
                left += inner
            if not ends or _is_endless(statement):
                return None, [*left, *ends]
            state = joined(ends)
    return state, left


def _is_endless(statement: ast.stmt) -> bool:
    """Return whether a statement is a loop after which nothing runs."""
    match statement:
        case ast.While(test=ast.Constant(value=value), body=body):
            return bool(value) and not _breaks(body)
    return False


def _breaks(block: Sequence[ast.stmt]) -> bool:
    """Return whether a block ends the loop around it with `break`."""
    loops = (ast.While, ast.For, ast.AsyncFor)
    inner = (way for statement in block if not isinstance(statement, loops) for way in branches(statement))
    return any(isinstance(statement, ast.Break) for statement in block) or any(map(_breaks, inner))


def reaches_end(block: Sequence[ast.stmt]) -> bool:
    """Return whether a run may reach the end of a block."""
    return runs_of(block, True, lambda state, _: state, all)[0] is not None


def blocks(node: ast.AST) -> list[list[ast.stmt]]:
    """Return the blocks that a node itself holds; those of its handlers and cases are theirs."""
    found = (getattr(node, name, None) for name in ("body", "orelse", "finalbody"))
    return [block for block in found if isinstance(block, list) and block]


def branches(statement: ast.stmt) -> list[list[ast.stmt]]:
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


def heads(statement: ast.stmt) -> Iterator[ast.expr]:
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


def goes_on_forever(source: PythonSource, loop: ast.While) -> bool:
    """Return whether the condition of a loop is always true, or true until rclpy is shut down."""
    is_ok = isinstance(loop.test, ast.Call) and source.resolve(loop.test.func) == "rclpy.ok"
    return is_ok or (isinstance(loop.test, ast.Constant) and bool(loop.test.value))


def leaves(statement: ast.stmt) -> bool:
    """Return whether the function ends at a statement."""
    value = statement.value if isinstance(statement, ast.Expr) else None
    is_exit = isinstance(value, ast.Call) and dotted(value.func) in _EXITS
    return is_exit or isinstance(statement, (ast.Return, ast.Raise))


def may_leave(body: Iterable[ast.stmt], *kinds: type[ast.AST]) -> bool:
    """Return whether statements may end the loop or the function around them, or contain some other kinds of nodes."""
    ends = (ast.Break, ast.Return, ast.Raise, *kinds)
    return any(isinstance(node, ends) for statement in body for node in (statement, *own_nodes(statement)))


# Exceptions of libraries that say that something else went wrong.
_OTHERS = frozenset(("ExternalShutdownException", "TransformException", "PackageNotFoundError"))


def may_be_caught(source: PythonSource, line: int, *errors: type[BaseException]) -> bool:
    """Return whether a `try` or `suppress` around a line catches one of some errors, as far as is known."""
    return any(_may_catch(name, errors) for name in _caught_around(source, line))


def may_be_caught_by_caller(source: PythonSource, function: Function, *errors: type[BaseException]) -> bool:
    """Return whether a file calls a function where one of some errors may be caught."""
    calls = source.calls
    named = (call for call in calls if (dotted(call.func) or "").rpartition(".")[2] == function.name)
    return any(may_be_caught(source, call.lineno, *errors) for call in named)


def _caught_around(source: PythonSource, line: int) -> Iterator[str]:
    """Yield the names of the exceptions that are caught around a line; empty for all."""
    for node in source.nodes:
        if not isinstance(node, (ast.Try, ast.With, ast.AsyncWith)):
            continue
        if not node.body[0].lineno <= line <= (node.body[-1].end_lineno or 0):
            continue
        if isinstance(node, ast.Try):
            for handler in node.handlers:
                yield from _named(handler.type)
            continue
        for item in node.items:
            call = item.context_expr
            if isinstance(call, ast.Call) and (dotted(call.func) or "").rpartition(".")[2] in (
                "suppress",
                "raises",
            ):
                for given in call.args:
                    yield from _named(given)


def _named(kinds: ast.expr | None) -> list[str]:
    if kinds is None:
        return [""]
    each = kinds.elts if isinstance(kinds, ast.Tuple) else [kinds]
    return [(dotted(kind) or "").rpartition(".")[2] for kind in each]


def _may_catch(name: str, errors: tuple[type[BaseException], ...]) -> bool:
    known = getattr(builtins, name, None) if name else BaseException
    if isinstance(known, type):
        return any(issubclass(error, known) for error in errors)
    return RuntimeError in errors and name not in _OTHERS  # as RCLError
