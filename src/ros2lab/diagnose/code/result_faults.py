"""Values that a function makes and then loses: a message never sent, a result not kept or not returned."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.code.idle_statements import tried_statements
from ros2lab.diagnose.code.left_at_default import PURE, never_read
from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.sources.answered import ACCEPTED, plain_returns, unanswered
from ros2lab.diagnose.sources.filled import filled_in, kind_of
from ros2lab.diagnose.sources.liveness import base_of
from ros2lab.diagnose.sources.node_source import NodeClass, is_self_attribute
from ros2lab.diagnose.sources.own_functions import called_function
from ros2lab.diagnose.sources.python_source import (
    PAUSES,
    YIELDS,
    Function,
    PythonSource,
    assignments,
    names_bound,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import removal
from ros2lab.diagnose.sources.uses import State, Uses, own_stores

_OF_PYTHON = frozenset(("abs", "max", "min", "round", "sorted", "sum"))  # nobody calls them for an error


def result_faults(uses: Uses) -> Iterator[Finding]:
    """Yield values that functions compute, fill or set without effect."""
    for source in uses.sources.sources.values():
        tried = tried_statements(source)
        for owner, _, node in uses.sources.scoped(source):
            if isinstance(node, Function):
                yield from _lost_locals(uses, source, owner, node)
                yield from _nothing_returned(uses, source, owner, node)
            elif isinstance(node, ast.Call):
                yield from _no_answer(uses, source, owner, node)
            elif isinstance(node, ast.Expr) and id(node) not in tried:
                yield from _result_lost(uses, source, owner, node.value)


def _no_answer(
    uses: Uses, source: PythonSource, owner: NodeClass | None, call: ast.Call
) -> Iterator[Finding]:
    """Yield parameter callbacks that do not return whether they accept the new values."""
    if getattr(call.func, "attr", "") != "add_on_set_parameters_callback" or not call.args:
        return
    given = call.args[0]
    method = uses.sources.method(owner, given.attr) if owner and is_self_attribute(given) else None
    if not method or method.decorator_list:
        return
    if fix := unanswered(method, ACCEPTED):
        is_known = "SetParametersResult" in source.names
        more = "" if is_known else ", with `from rcl_interfaces.msg import SetParametersResult` at the top"
        said = [ast.unparse(node.value) if node.value else "nothing" for node in plain_returns(method)]
        returned = in_a_row([*dict.fromkeys(said)]) or "nothing"
        cause = f"{method.name}() returns {returned}, but must tell ROS with a SetParametersResult whether the new values are accepted, so every such change is rejected."
        yield Finding("value-none", cause, source.at(next(plain_returns(method), method)), f"{fix}{more}")


def _lost_locals(
    uses: Uses, source: PythonSource, owner: NodeClass | None, function: Function
) -> Iterator[Finding]:
    """Yield local variables that are set and never read, where a global or attribute of that name is read."""
    names = [node for node in walk(function) if isinstance(node, ast.Name)]
    of_file = names_bound(target for target, _ in assignments(source.tree.body))
    own = {id(node) for node in names}
    read_elsewhere = {
        node.id
        for node in source.nodes
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and id(node) not in own
    }
    kept = State(uses, owner).read & uses.sources.attributes(owner) if owner else frozenset()
    given = {id(n): part for to, value in assignments(walk(function)) for n, part in _parts(to, value)}
    # What it sets itself may be kept under this name as well.
    kept -= own_stores(function)
    for node in never_read(function):
        name, said = node.id, f"{function.name}() sets {node.id}, which is a local variable; "
        if name in kept and not _is_read_only(given.get(id(node)), f"self.{name}"):
            fix = f"write self.{name} instead of {name}"
            yield Finding("not-kept", f"{said}self.{name} does not change.", source.at(node), fix)
            return
        if name in of_file and name in read_elsewhere:
            fix = f"write `global {name}` as the first line of {function.name}()"
            yield Finding("not-kept", f"{said}the global {name} does not change.", source.at(node), fix)
            return


def _parts(target: ast.expr, value: ast.expr) -> Iterator[tuple[ast.expr, ast.expr]]:
    """Yield what a target binds, each with the part of the value that it gets, or with all of it."""
    inner, given = getattr(target, "elts", None), getattr(value, "elts", [])
    if inner is None:
        yield target, value
    for number, part in enumerate(inner or ()):
        yield from _parts(part, given[number] if len(given) == len(inner or ()) else value)


def _is_read_only(value: ast.expr | None, name: str) -> bool:
    """Return whether a value is made of an attribute's own without being its next one, such as one more or less."""
    match value:
        case ast.UnaryOp(operand=side) if dotted(side) == name:
            return False
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub(), right=right) if name in (
            dotted(left),
            dotted(right),
        ):
            return False
    return value is not None and any(dotted(inner) == name for inner in walk(value))


def _result_lost(
    uses: Uses, source: PythonSource, owner: NodeClass | None, value: ast.expr
) -> Iterator[Finding]:
    """Yield calls of functions that only compute something, where the return value is not used."""
    if not isinstance(value, ast.Call):
        return
    called = value.func
    function = called_function(uses.sources, source, owner, called)
    is_other = is_self_attribute(called) and _is_overridden(uses, called.attr)
    is_pythons = isinstance(called, ast.Name) and called.id in _OF_PYTHON and not source.binders(called)[1]
    homes = (home for home in uses.sources.sources.values() if any(node is function for node in home.nodes))
    home = next(homes, None)
    if is_other or not (_only_computes(uses, home, function) if function and home else is_pythons):
        return
    text = ast.unparse(value)
    given = [ast.unparse(argument) for argument in value.args if dotted(argument) in source.stored]
    target = given[0] if len(given) == 1 == len(value.args) else ""
    cause = f"`{text}` returns a new value and changes nothing, and the return value is not used."
    fix = (
        f"write {target} = {text}"
        if target
        else f"use what it returns, or {removal(source, value, 'this line')}"
    )
    yield Finding("no-effect", cause, source.at(value), fix)


def _is_overridden(uses: Uses, name: str) -> bool:
    """Return whether several classes define a method, so that one may do more than another."""
    return sum(name in owner.methods for owner in uses.sources.classes.values()) > 1


def _nothing_returned(
    uses: Uses, source: PythonSource, owner: NodeClass | None, function: Function
) -> Iterator[Finding]:
    """Yield functions that compute a value last but do not return it, though their callers use it."""
    nodes = own_nodes(function)
    is_passed = function.decorator_list or (owner is not None and _is_overridden(uses, function.name))
    if (
        is_passed
        or isinstance(function, ast.AsyncFunctionDef)
        or any(isinstance(node, (ast.Return, *YIELDS, ast.Raise)) for node in nodes)
    ):
        return
    match function.body[-1]:
        case _ if shown_last(function.body):
            is_computed, last = True, ast.unparse(shown_last(function.body)[-1].args[0])
        case ast.Assign(targets=[ast.Name(id=last)]):
            is_computed = True
        case ast.Expr(value=value):
            is_call = isinstance(value, ast.Call) and getattr(value.func, "id", "") in PURE
            is_computed = is_call or isinstance(value, (ast.BinOp, ast.Compare, ast.JoinedStr))
            last = ast.unparse(value)
        case _:
            return
    scope = walk(owner.definition) if owner is not None else source.nodes
    users = [node for node in scope if _uses_value(node, function.name, owner is not None)]
    same = [n for n in source.nodes if isinstance(n, Function) and n.name == function.name]
    if is_computed and users and len(same) == 1:
        cause = f"{function.name}() returns nothing, so `{ast.unparse(users[0]).splitlines()[0]}` uses None instead of {last}."
        fix = return_in_place(function) or f"write `return {last}` as the last line of {function.name}()"
        yield Finding("value-none", cause, source.at(function.body[-1]), fix)


def return_in_place(function: Function) -> str:
    """Return how to make a function return what it prints last; empty if it prints nothing last."""
    printed = shown_last(function.body)
    returns = [f"`return {ast.unparse(call.args[0])}` on line {call.lineno}" for call in printed]
    joined = f"{', '.join(returns[:-1])}, and {returns[-1]}" if len(returns) > 1 else "".join(returns)
    return f"write return instead of print: {joined}" if printed else ""


def shown_last(body: list[ast.stmt]) -> list[ast.Call]:
    """Return the print calls that end each path through a block; empty if a path ends otherwise."""
    match body[-1] if body else None:
        case ast.Expr(value=ast.Call(func=ast.Name(id="print"), args=[value], keywords=[]) as call) if (
            not isinstance(value, (ast.Starred, ast.JoinedStr))
        ):
            return [call]
        case ast.If(body=then, orelse=otherwise):
            shown = shown_last(then)
            return shown and (shown + shown_last(otherwise) if otherwise else shown)
    return []


def _uses_value(node: ast.AST, name: str, is_method: bool) -> bool:
    """Return whether a node uses the return value of a function."""
    match node:
        case ast.Assign(value=value) | ast.AugAssign(value=value) | ast.FormattedValue(value=value):
            values = [value]
        case ast.BinOp(left=left, right=right):
            values = [left, right]
        case ast.Compare():
            values = [node.left, *node.comparators]
        case _:
            return False
    called = f"self.{name}" if is_method else name
    return any(isinstance(value, ast.Call) and dotted(value.func) == called for value in values)


def _only_computes(uses: Uses, source: PythonSource, function: Function) -> bool:
    """Return whether a function returns a value and does nothing else; it may fill a message that it makes."""
    nodes = own_nodes(function)
    own = [name for name, made in filled_in(uses, source, nodes).items() if not made.others]
    is_returning = any(isinstance(node, ast.Return) and node.value is not None for node in nodes)
    for node in nodes:
        is_set = isinstance(node, (ast.Attribute, ast.Subscript)) and isinstance(node.ctx, ast.Store)
        if is_set and getattr(base_of(node), "id", "") not in own:
            return False
        if isinstance(node, (ast.Global, ast.Nonlocal, ast.Raise, *PAUSES, ast.Assert)):
            return False
        if isinstance(node, ast.Call) and not (
            getattr(node.func, "id", "") in PURE
            or (dotted(node.func) or "").startswith("math.")
            or kind_of(source, node)
        ):
            return False
    return is_returning
