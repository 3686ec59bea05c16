"""Change what modules do, but not their source: the program of a box that `own_tests` starts.

It changes the compiled file, which Python runs when a module is imported; the source stays as received. So a
test that only reads the source sees no difference. The compiled code keeps its names and constants and has
one more branch in each copy, so inspecting it tells little, too.
It imports only the standard library: the box is shown nothing else of the grader.
"""

from __future__ import annotations

import ast
import contextlib
import importlib.util
import json
import marshal
import random
import sys
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import Any

Constants = dict[str, ast.Constant]
Spoiler = Callable[[ast.Module, Collection[int], Constants], ast.Module]

LARGEST = 1_000_000  # bytes of a module that is broken
HARMLESS = "harmless"
# The flags in a compiled file that tell Python not to compare it with its source (PEP 552).
_UNCHECKED = b"\1\0\0\0" + bytes(8)
_ENTRANCES = ("main",)  # functions that only start a node, which tests are not about


def spoil(files: Mapping[str, Collection[int]], kind: str) -> None:
    """Compile changed versions of modules that have not run yet.

    Args:
        files: by module, the first lines of code that stays unchanged because no program uses it.
        kind: one of `SPOILERS`, or `HARMLESS` for other code that does the same.
    """
    trees, constants = dict[Path, ast.Module](), Constants()
    for path in map(Path, files):
        if path.stat().st_size <= LARGEST:
            # A module that cannot be parsed stays unchanged: it is broken enough.
            with contextlib.suppress(SyntaxError, ValueError, RecursionError, MemoryError, OSError):
                trees[path] = ast.parse(path.read_bytes())
                constants |= _named(trees[path])
    for path, tree in trees.items():
        with contextlib.suppress(SyntaxError, ValueError, RecursionError, MemoryError, OSError):
            changed = KINDS[kind](tree, files[str(path)], constants)
            code = compile(ast.fix_missing_locations(changed), path, "exec", dont_inherit=True)
            compiled = Path(importlib.util.cache_from_source(path))
            compiled.parent.mkdir(exist_ok=True)
            compiled.write_bytes(importlib.util.MAGIC_NUMBER + _UNCHECKED + marshal.dumps(code))


def _true() -> ast.expr:
    """Return an expression that is true, which a compiler cannot know."""
    return ast.List([ast.Constant(random.randrange(1 << 30))], ast.Load())  # noqa: S311 -- no secret


def _end(tree: ast.Module, idle: Collection[int], is_ended: Callable[[], ast.expr]) -> ast.Module:
    """Insert an early return into functions, under the condition that `is_ended` makes.

    Special methods, `main`, generators, and functions that only give back a value are left unchanged.
    """
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            is_special = node.name.startswith("__") or node.name in _ENTRANCES
            is_generator = any(isinstance(inner, (ast.Yield, ast.YieldFrom)) for inner in ast.walk(node))
            is_to_end = not (is_special or is_generator or _hands_back(node))
            if is_to_end and node.lineno not in idle:
                at = 1 if ast.get_docstring(node) is not None else 0
                node.body.insert(at, ast.If(is_ended(), [ast.Return(ast.Constant(None))], []))
    return tree


def _hands_back(function: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    """Return whether a function only returns one of its arguments or an expression of constants."""
    given = {argument.arg for argument in ast.walk(function.args) if isinstance(argument, ast.arg)}
    match [statement for statement in function.body if not _is_text(statement)]:
        case [ast.Return(value=ast.Name(id=name))]:
            return name in given
        case [ast.Return(value=ast.expr() as value)]:
            return not any(isinstance(node, (ast.Name, ast.Call)) for node in ast.walk(value))
    return False


def _named(tree: ast.Module) -> Constants:
    """Return by name the constants that are assigned in the body of a module or a class."""
    bodies = [node.body for node in ast.walk(tree) if isinstance(node, (ast.Module, ast.ClassDef))]
    found = Constants()
    for statement in (statement for body in bodies for statement in body):
        match statement:
            case (
                ast.Assign(targets=[ast.Name(id=name)], value=ast.Constant() as value)
                | ast.AnnAssign(target=ast.Name(id=name), value=ast.Constant() as value)
            ):
                found[name] = value
    return found


def _is_text(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


def _empty(tree: ast.Module, idle: Collection[int], _constants: Constants) -> ast.Module:
    """Make the functions do nothing."""
    return _end(tree, idle, _true)


def _keep(tree: ast.Module, idle: Collection[int], _constants: Constants) -> ast.Module:
    """Give the functions other code that does the same."""
    return _end(tree, idle, lambda: ast.UnaryOp(ast.Not(), _true()))


class _Change(ast.NodeTransformer):
    """Change every text and number, except docstrings, patterns, and `"__main__"`.

    A constant that is named outside of functions changes only where a function uses it: a test of the name
    itself would only repeat it.
    """

    def __init__(self, tree: ast.Module, idle: Collection[int], constants: Constants) -> None:
        self._idle, self._constants = idle, constants
        self._kept = {*_named(tree).values()}
        self._depth = 0  # of nested functions

    def visit(self, node: ast.AST) -> Any:
        is_idle = isinstance(node, ast.stmt) and node.lineno in self._idle
        is_given_back = isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and _hands_back(node)
        if is_idle or is_given_back or node in self._kept:
            return node
        is_function = isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda))
        self._depth += is_function
        changed = super().visit(node)
        self._depth -= is_function
        return changed

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return self._changed(node, node.id)

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        self.generic_visit(node)
        return self._changed(node, node.attr)

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        return self._other(node, node)

    def _changed(self, node: ast.Name | ast.Attribute, name: str) -> ast.expr:
        """Return a changed value instead of a named constant, if a function uses it."""
        is_taken = self._depth > 0 and isinstance(node.ctx, ast.Load) and name in self._constants
        return self._other(node, self._constants[name]) if is_taken else node

    def _other(self, node: ast.expr, constant: ast.Constant) -> ast.expr:
        value = constant.value
        if isinstance(value, str) and value != "__main__":
            changed: str | float = f"{value}x"
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            changed = value + 1
        else:
            return node
        return ast.copy_location(ast.IfExp(_true(), ast.Constant(changed), node), node)

    def visit_Expr(self, node: ast.Expr) -> ast.Expr:
        return node if _is_text(node) else self.generic_visit(node)  # type: ignore[return-value]

    def visit_JoinedStr(self, node: ast.JoinedStr) -> ast.JoinedStr:
        return node

    def visit_MatchValue(self, node: ast.MatchValue) -> ast.MatchValue:
        return node

    def visit_MatchMapping(self, node: ast.MatchMapping) -> ast.MatchMapping:
        return node


def _change(tree: ast.Module, idle: Collection[int], constants: Constants) -> ast.Module:
    _Change(tree, idle, constants).visit(tree)
    return tree


SPOILERS: Mapping[str, Spoiler] = {"empty": _empty, "change": _change}
KINDS: Mapping[str, Spoiler] = {HARMLESS: _keep, **SPOILERS}


if __name__ == "__main__":
    spoil(json.load(sys.stdin), sys.argv[1])
