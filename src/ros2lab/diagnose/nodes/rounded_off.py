"""Received integers that are divided without their decimals before they get into a field that holds a float."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.kinds import Scope
from ros2lab.diagnose.sources.node_source import is_self_attribute
from ros2lab.diagnose.sources.python_source import own_nodes, parameters

_DEEPEST = 4  # names that are followed
_KEEPS = frozenset(("float", "int", "round", "abs", "min", "max"))  # what gives a number in proportion


def rounded_off(scope: Scope, field: str, value: ast.expr) -> Iterator[Finding]:
    """Yield the first division that loses the decimals of what a float field is computed from."""
    for inner, node in _followed(scope, value):
        divided = _divided(node)
        if divided is None or not _is_received(inner, divided.left) or _is_of_steps(inner, divided):
            continue
        by = ast.unparse(divided.right)
        new = ast.unparse(ast.BinOp(divided.left, ast.Div(), divided.right))
        last = (
            f"{int(by) - 1}"
            if isinstance(node, ast.BinOp) or "int(" in ast.unparse(node)
            else f"{int(by) // 2}"
        )
        cause = f"`{ast.unparse(node)}` is a whole number, 0 for each value from 0 to {last}, so {field} gets none of what lies between."
        fix = f"write `{new}` instead of `{ast.unparse(node)}`; if whole steps are intended, leave it"
        yield Finding("rounded-off", cause, inner.source.at(node), fix)
        return


def _followed(scope: Scope, value: ast.expr, depth: int = _DEEPEST) -> Iterator[tuple[Scope, ast.expr]]:
    """Yield the parts of a computation, also through names and attributes that get one computed value only."""
    yield scope, value
    given: list[tuple[Scope, ast.expr | None]] = []
    match value:
        case ast.BinOp(left=left, right=right):
            given = [(scope, left), (scope, right)]
        case ast.UnaryOp(operand=inner):
            given = [(scope, inner)]
        case ast.Call(func=ast.Name(id=name), args=values) if name in _KEEPS:
            given = [(scope, inner) for inner in values]
        case ast.Name() | ast.Attribute() if depth:
            depth -= 1
            function = scope.function
            local = (
                scope.kinds.locals_of(function).get(value.id, ())
                if function and isinstance(value, ast.Name)
                else ()
            )
            given = [*scope.assigned(value), *((scope, each) for each in local)]
            given = [(inner, each) for inner, each in given if not isinstance(each, ast.Constant)]
            given = given if len(given) == 1 else []
    for inner_scope, each in given:
        if each is not None:
            yield from _followed(inner_scope, each, depth)


def _divided(node: ast.AST) -> ast.BinOp | None:
    """Return the division by a whole number whose decimals a node drops; None if it drops none."""
    match node:
        case ast.BinOp(op=ast.FloorDiv(), right=ast.Constant(value=int(by))) if by > 1:
            return node
        case ast.Call(
            func=ast.Name(id="int" | "round"),
            args=[ast.BinOp(op=ast.Div(), right=ast.Constant(value=int(by))) as inner],
        ) if by > 1:
            return inner
    return None


def _is_received(scope: Scope, value: ast.expr) -> bool:
    """Return whether a value is an integer field of a message that a callback is given."""
    root = value
    while isinstance(root, ast.Attribute):
        root = root.value
    names = [parameter.arg for parameter in parameters(scope.function)] if scope.function else []
    is_given = isinstance(value, ast.Attribute) and isinstance(root, ast.Name) and root.id in names
    return is_given and not is_self_attribute(value) and scope.kind(value) == "int"


def _is_of_steps(scope: Scope, divided: ast.BinOp) -> bool:
    """Return whether steps are meant: what is left over is used as well, or they are multiplied again."""
    pair = ast.unparse(divided.left), ast.unparse(divided.right)
    for node in own_nodes(scope.function) if scope.function else ():
        match node:
            case ast.BinOp(op=ast.Mod()) if (ast.unparse(node.left), ast.unparse(node.right)) == pair:
                return True
            case ast.BinOp(op=ast.Mult()) if any(
                isinstance(side, ast.Constant) and side.value == ast.literal_eval(divided.right)
                for side in (node.left, node.right)
            ):
                return True
    return False
