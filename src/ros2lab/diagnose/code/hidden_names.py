"""Names that hide others: local variables that shadow what is still used under that name, and names imported twice."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.finding import Finding, these_lines
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.bindings import Import, bound_by
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, walk
from ros2lab.diagnose.sources.signatures import signature_by_name

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


_TYPES = {"msg_type": ".msg.", "srv_type": ".srv."}


def bound_twice(sources: NodeSources) -> Iterator[Finding]:
    """Yield the uses of a name that fit the import that another one replaced, and not the one that holds there."""
    typed = {
        id(value): _TYPES[name]
        for creation in sources.creations
        for name, value in (creation.arguments or {}).items()
        if name in _TYPES
    }
    for source in sources.sources.values():
        alike: dict[str, dict[str, Import]] = {}
        for imported in source.imports:
            alike.setdefault(imported.local, {}).setdefault(imported.target, imported)
        for name, known in alike.items():
            if len(known) == 2 and not source.fault:
                yield from _misused(source, name, [*known.values()], typed)


def _misused(
    source: PythonSource, name: str, known: Sequence[Import], typed: dict[int, str]
) -> Iterator[Finding]:
    """Yield the places at which a name must be the first of two imports, although the second holds."""
    first, last = known
    nodes = (node for node in source.nodes if isinstance(node, ast.Name) and node.id == name)
    held = [node for node in nodes if source.resolve(node) == last.target]
    fits = {use: [_fits(source, use, imported, typed) for imported in known] for use in held}
    wrong = [use for use in held if fits[use] == [True, False]]
    lines = sorted({use.lineno for use in held if fits[use][0] is not True or fits[use][1]})
    modules = [imported.target.rpartition(".")[0] for imported in known]
    kind = {"msg": "Msg", "srv": "Srv"}.get(modules[1].rpartition(".")[2])
    new = f"{name}{kind}" if kind else f"{modules[1].partition('.')[0].title().replace('_', '')}{name}"
    also = f", and {new} instead of {name} on {these_lines(lines)}" if lines else ""
    for use in wrong:
        cause = f"{name} is imported twice: this line needs the one of {modules[0]} (line {first.line}), but line {last.line} replaces it by that of {modules[1]}."
        fix = f"write `{name} as {new}` in the import on line {last.line}{also}"
        yield Finding("name-hidden", cause, source.at(use), fix)


def _fits(source: PythonSource, use: ast.Name, imported: Import, typed: dict[int, str]) -> bool | None:
    """Return whether what is imported can be used as a name is; None if that is not known."""
    target, around = imported.target, source.above(use)
    fields = interfaces.fields_of(target)
    match around:
        case ast.Call() if id(use) in typed:
            return typed[id(use)] in target
        case ast.Call(func=called) if called is use:
            signature = None if ".srv." in target else signature_by_name(target)
            return signature.accepts(around) if signature else None
        case ast.Attribute(attr=asked) if not asked.startswith("_"):
            members = interfaces.members_of(*target.rpartition(".")[::2])
            if fields is None:
                return asked in members if members else None
            return asked in fields or asked.isupper() or asked in ("Request", "Response")
        case ast.ExceptHandler() | ast.ClassDef():
            return not interfaces.is_interface(target)
    return None
