"""A sign on the wrong side of `=`."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.one_run import branches
from ros2lab.diagnose.sources.python_source import PythonSource, walk


def sign_fault(source: PythonSource, node: ast.Assign) -> Iterator[Finding]:
    """Yield `=+ ` and `=- `, where `+=` was meant, of what has a value that goes on.

    A sign that touches the number is the sign of a value, as in `x =+0.1` beside `x =-0.1`.
    """
    if not isinstance(node.value, ast.UnaryOp) or not isinstance(node.value.op, (ast.UAdd, ast.USub)):
        return
    sign, target = "+" if isinstance(node.value.op, ast.UAdd) else "-", ast.unparse(node.targets[0])
    line = source.text.encode().splitlines()[node.value.lineno - 1]
    before, after = line[: node.value.col_offset], line[node.value.col_offset :]
    is_apart = before.endswith(b"=") and after.startswith(f"{sign} ".encode())
    others = [value for value in source.stored.get(target, ()) if value is not node.value]
    # Only one sign is a slip: values that differ in their signs, or by the case, are values.
    plain = [target, *(ast.unparse(value) for value in others if value is not None)]
    is_value = ast.unparse(node.value.operand) in plain or any(isinstance(v, ast.UnaryOp) for v in others)
    is_value = is_value or _is_set_by_case(source, node, target)
    if is_apart and others and not is_value and _goes_on(source, node):
        cause = (
            f"`={sign}` sets {target} to {ast.unparse(node.value)} each time instead of changing it by that."
        )
        fix = f"write {target} {sign}= {ast.unparse(node.value.operand)}"
        yield Finding("no-effect", cause, source.at(node), fix)


def _goes_on(source: PythonSource, node: ast.Assign) -> bool:
    """Return whether a target still has its value when the assignment runs again."""
    target = node.targets[0]
    shared = {
        name
        for outer in source.nodes
        if isinstance(outer, (ast.Global, ast.Nonlocal))
        for name in outer.names
    }
    loops = (outer for outer in source.nodes if isinstance(outer, (ast.For, ast.AsyncFor, ast.While)))
    is_local = isinstance(target, ast.Name) and target.id not in shared
    return not is_local or any(node in walk(loop) for loop in loops)


def _is_set_by_case(source: PythonSource, node: ast.Assign, target: str) -> bool:
    """Return whether the branches beside an assignment assign to its target as well."""
    for outer in source.nodes:
        blocks = branches(outer) if isinstance(outer, ast.stmt) else []
        within = [[inner for statement in block for inner in walk(statement)] for block in blocks]
        others = [block for block in within if node not in block]
        if len(others) < len(within) and any(_is_assigned(target, block) for block in others):
            return True
    return False


def _is_assigned(target: str, nodes: Iterable[ast.AST]) -> bool:
    targets = (to for node in nodes if isinstance(node, ast.Assign) for to in node.targets)
    return any(ast.unparse(to) == target for to in targets)
