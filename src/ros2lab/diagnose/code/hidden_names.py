"""Local variables that shadow a function or module which is still used under that name."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.bindings import bound_by
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, walk

_VALUES = (
    *(ast.Constant, ast.JoinedStr, ast.List, ast.Dict, ast.Set, ast.Tuple, ast.BinOp, ast.Compare),
    *(ast.ListComp, ast.DictComp, ast.SetComp),
)
_LOOPS = (ast.For, ast.While, ast.AsyncFor)


def hidden_names(sources: NodeSources) -> Iterator[Finding]:
    """Yield local variables that shadow a name which the same function calls or reads attributes of."""
    for source in sources.sources.values():
        for node in source.nodes:
            if isinstance(node, Function):
                yield from _hidden_in(source, node)


def _hidden_in(source: PythonSource, function: Function) -> Iterator[Finding]:
    nodes = own_nodes(function)
    # What is bound otherwise than by assignment, or in a comprehension.
    others = [inner for node in nodes if isinstance(node, ast.comprehension) for inner in walk(node.target)]
    others += [node for node in nodes if not isinstance(node, ast.Name)]
    outer, taken = known_names(source), {name for node in others for name in bound_by(node)}
    stores: dict[str, list[ast.Name]] = {}
    for node in nodes:
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and node.id in outer.keys() - taken:
            stores.setdefault(node.id, []).append(node)
    loops = [n for n in nodes if isinstance(n, _LOOPS)]
    for name, there in stores.items():
        used = _used(nodes, name)
        made = _first_statement(function, there)
        before = [use for use in used if made is not None and _comes_before(use, made, loops)]
        if before:
            cause = f"{name} is {outer[name]}, but this function makes a variable of that name (line {there[0].lineno}), so {name} has no value here yet."
        else:
            before = [use for use in used if _is_value_called(nodes, there, use)]
            cause = f"{name} is {outer[name]}, but line {there[0].lineno} makes a variable of that name, which cannot be called."
        if before:
            yield Finding("name-hidden", cause, source.at(before[0]), fix_of(name, function.name))


def known_names(source: PythonSource) -> dict[str, str]:
    """Return the builtin, imported and top-level function names of a file, each with a description."""
    found = {name: "one of Python's built-in functions" for name in dir(builtins) if name[:1].islower()}
    found |= {imported.local: "an imported name" for imported in source.imports}
    return found | dict.fromkeys(source.functions, "a function of this file")


def fix_of(name: str, function: str) -> str:
    """Return the instruction to rename a variable."""
    return f"rename the variable {name} everywhere in {function}(), for example to {name}_value, but leave {name} where the original is used"


def _used(nodes: tuple[ast.AST, ...], name: str) -> list[ast.AST]:
    """Return the calls of a name, and the attributes that are read from it."""
    found: list[ast.AST] = []
    for node in nodes:
        match node:
            case ast.Call(func=ast.Name(id=called)) if called == name:
                found.append(node)
            case ast.Attribute(value=ast.Name(id=owner, ctx=ast.Load())) if owner == name:
                found.append(node)
    return found


def _first_statement(function: Function, stores: list[ast.Name]) -> ast.stmt | None:
    """Return the statement that gives a variable its first value; None if it is of an unknown kind."""
    first = min(stores, key=lambda store: (store.lineno, store.col_offset))
    kinds = (ast.Assign, ast.AnnAssign, ast.AugAssign, *_LOOPS, ast.With)
    around = [n for n in own_nodes(function) if isinstance(n, kinds) and first in walk(n)]
    return max(around, key=lambda statement: statement.lineno, default=None)


def _comes_before(used: ast.AST, made: ast.stmt, loops: Sequence[ast.stmt]) -> bool:
    """Return whether a name is used before its function has given it a value."""
    line = getattr(used, "lineno", 0)
    is_in_it = isinstance(made, (ast.Assign, ast.AnnAssign)) and made.value and used in walk(made.value)
    is_in_it = is_in_it or (isinstance(made, ast.For) and used in walk(made.iter))
    if is_in_it:
        return True
    # In a loop, an earlier line may run again after the variable has been set.
    together = any(made in walk(loop) and used in walk(loop) and loop is not made for loop in loops)
    return line < made.lineno and not together


def _is_value_called(nodes: tuple[ast.AST, ...], stores: list[ast.Name], used: ast.AST) -> bool:
    """Return whether a use is the call of a variable that only ever holds values that cannot be called."""
    values = [n.value for n in nodes if isinstance(n, ast.Assign) and any(t in stores for t in n.targets)]
    is_all = len(values) == len(stores) and all(isinstance(value, _VALUES) for value in values)
    return isinstance(used, ast.Call) and is_all and used.lineno > min(store.lineno for store in stores)
