"""Which variables of a function something still reads after each of its statements."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ros2lab.diagnose.sources.one_run import branches, heads
from ros2lab.diagnose.sources.python_source import Function, walk
from ros2lab.diagnose.sources.uses import is_log

GROWS = frozenset(("append", "extend", "insert"))  # what a statement may call on a field to fill it
FILL, LOG = "fill ", "log "  # how a variable is named that is only filled, or only shown
_LOOPS = (ast.For, ast.AsyncFor, ast.While)
_Names = frozenset[str]
_NONE: _Names = frozenset()


def live_after(function: Function) -> Mapping[int, _Names]:
    """Return for each statement of a function, by its `id`, the variables that a run may still read after it.

    One whose fields are only set has `FILL` before its name, and one that is only logged has `LOG`.
    """
    found = dict[int, _Names]()
    _before(function.body, _NONE, found, _Around())
    return found


@dataclass(frozen=True)
class _Around:
    """What a run may read when it leaves a block: after an error or a `return`, and in or after the loop around."""

    caught: _Names = _NONE
    loop: _Names = _NONE


def _before(block: Sequence[ast.stmt], after: _Names, found: dict[int, _Names], around: _Around) -> _Names:
    """Return what is read from the beginning of a block on.

    Args:
        block: the statements.
        after: what is read after them.
        found: what is read after each statement, which is filled in.
        around: where else a run may go on.
    """
    for statement in reversed(block):
        found[id(statement)] = found.get(id(statement), _NONE) | after | around.caught
        own, caught = frozenset(_read_by(statement)), around.caught
        if isinstance(statement, (ast.Return, ast.Raise)):
            after = own | caught
        elif isinstance(statement, (ast.Break, ast.Continue)):
            after = around.loop | caught
        elif isinstance(statement, ast.Try):
            last = _before(statement.finalbody, after | caught, found, around)
            inner = replace(around, caught=caught | last)
            ways = [_before(handler.body, last, found, inner) for handler in statement.handlers]
            inner = replace(around, caught=caught | last.union(*ways))
            after = _before([*statement.body, *statement.orelse], last, found, inner)
        elif isinstance(statement, (ast.With, ast.AsyncWith)):  # which may go on below it after an error
            after = own | _before(statement.body, after, found, replace(around, caught=caught | after))
        elif isinstance(statement, _LOOPS):
            ahead = after | own | _before(statement.orelse, after, found, around)
            for _ in range(2):  # a turn may read what the one before it has set
                inner = replace(around, loop=after | ahead)
                ahead |= _before(statement.body, ahead, found, inner)
            after = ahead
        elif ways_on := branches(statement):
            after = own.union(*(_before(way, after, found, around) for way in ways_on))
        else:
            nodes = (n for n in walk(statement) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store))
            after = (after - {how + name.id for name in nodes for how in ("", FILL, LOG)}) | own
    return after


def _read_by(statement: ast.stmt) -> Iterator[str]:
    """Yield what a statement reads itself, outside its blocks; a function in it may read all that it names."""
    if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
        yield from (n.id for n in walk(statement) if isinstance(n, ast.Name))
        return
    is_block = bool(branches(statement))
    nodes = [n for part in heads(statement) for n in walk(part)] if is_block else [*walk(statement)]
    if isinstance(statement, ast.Match):
        nodes += [n for case in statement.cases if case.guard for n in walk(case.guard)]
    shown = {id(inner) for n in nodes if is_log(n) for inner in walk(n)}
    bases = {id(base_of(n)) for n in nodes if is_filled(n, statement)}
    for node in nodes:
        if isinstance(node, ast.Name) and (isinstance(node.ctx, ast.Load) or _is_added_to(node, statement)):
            yield (FILL if id(node) in bases else LOG if id(node) in shown else "") + node.id


def _is_added_to(name: ast.Name, statement: ast.stmt) -> bool:
    return isinstance(statement, ast.AugAssign) and statement.target is name


def is_filled(node: ast.AST, statement: ast.stmt) -> bool:
    """Return whether a statement sets an attribute or an item, or adds to it."""
    if isinstance(node, (ast.Attribute, ast.Subscript)) and isinstance(node.ctx, ast.Store):
        return True
    call = statement.value if isinstance(statement, ast.Expr) else None
    grows = call.func if isinstance(call, ast.Call) else None
    return isinstance(grows, ast.Attribute) and grows.attr in GROWS and node is grows.value


def base_of(node: ast.AST) -> ast.AST:
    """Return what an attribute or an item is a part of, such as `msg` for `msg.linear.x`."""
    while isinstance(node, (ast.Attribute, ast.Subscript)):
        node = node.value
    return node
