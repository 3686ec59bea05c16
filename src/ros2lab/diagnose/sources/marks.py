"""What is noted on the nodes of a syntax tree when it is read."""

from __future__ import annotations

import ast
from collections.abc import Sequence

_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


def mark(nodes: Sequence[ast.AST]) -> None:
    """Set `is_function`, `is_wrapped` and `is_inner` on the nodes of a file."""
    _mark_functions(nodes)
    _mark_wrapped(nodes)
    _mark_inner(nodes)


def _mark_functions(nodes: Sequence[ast.AST]) -> None:
    """Set `is_function` on each `name` and `self.name`: whether it is a function of the file."""
    functions = {node.name for node in nodes if isinstance(node, _FUNCTIONS) and not node.decorator_list}
    named = [node for node in nodes if isinstance(node, (ast.Name, ast.Attribute))]
    bound = {_last(node) for node in named if isinstance(node.ctx, ast.Store)}
    bound |= {node.arg for node in nodes if isinstance(node, ast.arg)}
    for node in named:
        owner = node.value if isinstance(node, ast.Attribute) else None
        is_own = owner is None or (isinstance(owner, ast.Name) and owner.id == "self")
        node.is_function = is_own and _last(node) in functions - bound  # type: ignore[union-attr]


def _mark_wrapped(nodes: Sequence[ast.AST]) -> None:
    """Set `is_wrapped` on functions of which a decorator, also of the class, or an assignment may make something else."""
    bound = [n for n in nodes if isinstance(n, (ast.Name, ast.Attribute)) and isinstance(n.ctx, ast.Store)]
    names = {node.id for node in bound if isinstance(node, ast.Name)}
    for node in nodes:
        if isinstance(node, _FUNCTIONS):
            node.is_wrapped = bool(node.decorator_list) or node.name in names  # type: ignore[union-attr]
    attributes = {node.attr for node in bound if isinstance(node, ast.Attribute)}
    for owner in (node for node in nodes if isinstance(node, ast.ClassDef)):
        targets = [t for part in owner.body if isinstance(part, ast.Assign) for t in part.targets]
        names = attributes | {target.id for target in targets if isinstance(target, ast.Name)}
        for method in (part for part in owner.body if isinstance(part, _FUNCTIONS)):
            is_changed = bool(method.decorator_list or owner.decorator_list)
            method.is_wrapped = is_changed or method.name in names  # type: ignore[union-attr]


def _last(node: ast.Name | ast.Attribute) -> str:
    return node.id if isinstance(node, ast.Name) else node.attr


def _mark_inner(nodes: Sequence[ast.AST]) -> None:
    """Set `is_inner` on what lies in a class inside another one, or in a function with its own `self` inside a method.

    The `self` there is not that of a class at the top level of the file.
    """
    for outer in nodes:
        kinds = ast.ClassDef if isinstance(outer, ast.ClassDef) else (ast.ClassDef, *_FUNCTIONS)
        for inner in ast.walk(outer) if isinstance(outer, ast.ClassDef) or _has_self(outer) else ():
            if inner is not outer and isinstance(inner, kinds) and _is_owner(inner):
                for node in ast.walk(inner):
                    node.is_inner = True  # type: ignore[attr-defined]


def _is_owner(node: ast.AST) -> bool:
    """Return whether a node may give `self` another meaning inside it."""
    return isinstance(node, ast.ClassDef) or _has_self(node)


def _has_self(node: ast.AST) -> bool:
    return isinstance(node, _FUNCTIONS) and "self" in (
        p.arg for p in (*node.args.posonlyargs, *node.args.args)
    )
