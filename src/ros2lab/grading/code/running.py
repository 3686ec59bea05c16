"""Which code of a package runs, as far as names and constants tell; only that code counts.

Code is taken to run unless something obvious prevents it: nothing names the function or the class, a constant
closes the branch, the statement before it leaves. Where names are made at run time, any function may be
called.

While a program lives, less of it runs: nothing follows a spin, or a line with a name that nothing defines.
"""

from __future__ import annotations

import ast
import itertools
from collections import defaultdict
from collections.abc import Collection, Iterator

from ros2lab.diagnose.sources.construction import looks_up
from ros2lab.diagnose.sources.interfaces import node_members
from ros2lab.diagnose.sources.kept import kept
from ros2lab.diagnose.sources.python_source import Function, PythonSource, children, walk
from ros2lab.grading.code.paths import Paths

# Expressions all of whose parts are evaluated, and what these are marked with.
_WHOLE = (
    ast.Name, ast.Attribute, ast.Constant, ast.Call, ast.BinOp, ast.UnaryOp, ast.Compare, ast.Subscript, ast.List,
    ast.Tuple, ast.JoinedStr, ast.FormattedValue, ast.expr_context, ast.operator, ast.unaryop, ast.cmpop,
)  # fmt: skip

Definition = Function | ast.ClassDef | ast.Dict
Code = Collection[tuple[PythonSource, ast.AST]]  # nodes of code that runs, each with its file


def running(
    sources: Collection[PythonSource],
    entrances: Collection[str] | None = None,
    *,
    is_living: bool = False,
    vain: Collection[str] = (),
) -> Iterator[tuple[PythonSource, ast.AST]]:
    """Yield the nodes of code that runs, each with its file.

    Args:
        sources: the modules of a package.
        entrances: the functions that its entry points name; None takes every module-level function that needs
            no arguments.
        is_living: whether only code that runs while a program lives is yielded.
        vain: the places of functions, classes and statements that do nothing.
    """
    paths = Paths(is_living=is_living, vain=vain)
    named = _definitions(sources)
    defined = [(source, n) for source in sources for n in source.nodes if isinstance(n, ast.ClassDef)]
    classes = {definition.name for _, definition in defined}
    waiting: list[tuple[PythonSource, ast.AST]] = [(source, source.tree) for source in sources]
    waiting += [
        (source, part)
        for source in sources
        for part in source.tree.body
        if _is_entrance(source, part, entrances)
    ]
    done = set[ast.AST]()
    while waiting:
        source, piece = waiting.pop()
        if piece in done or paths.is_vain(source, piece):
            continue
        done.add(piece)
        if isinstance(piece, ast.ClassDef):
            waiting += [(source, method) for method in _called_by_others(source, piece, classes)]
        for node in _pieces(paths, source, piece):
            yield source, node
            for name in _names_in(node):
                waiting += named.pop(name, ())
            if looks_up(node):
                waiting += [definition for found in named.values() for definition in found]
                named.clear()


def _definitions(sources: Collection[PythonSource]) -> dict[str, list[tuple[PythonSource, Definition]]]:
    """Return by name the functions, classes and dictionaries that run only if something names them."""
    named: dict[str, list[tuple[PythonSource, Definition]]] = defaultdict(list)
    for source in sources:
        for node in source.nodes:
            match node:
                case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
                    named[name].append((source, node))
                case ast.Assign(targets=[ast.Name(id=name)], value=ast.Dict() as table):
                    named[name].append((source, table))
    return named


def idle(sources: Collection[PythonSource], code: Code) -> dict[str, list[int]]:
    """Return by file the first lines of functions that never run and of assignments that are never read."""
    run = {node for _, node in code}
    read = {name for node in run for name in _names_in(node)}
    found: dict[str, list[int]] = defaultdict(list)
    for source in sources:
        for node in source.nodes:
            match node:
                case ast.FunctionDef() | ast.AsyncFunctionDef():
                    is_idle = node not in run
                case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
                    is_idle = name not in read
                case _:
                    continue
            if is_idle:
                found[source.shown].append(node.lineno)
    return dict(found)


def _is_entrance(source: PythonSource, statement: ast.stmt, entrances: Collection[str] | None) -> bool:
    """Return whether a statement of a module would run if the program were started right."""
    match statement:
        case ast.ClassDef(bases=bases):
            return bool(bases)  # the node was written, even if `main` was forgotten
        case ast.FunctionDef(name=name, args=arguments) | ast.AsyncFunctionDef(name=name, args=arguments):
            if len(arguments.args) > len(arguments.defaults):
                return False
            is_named = entrances is None or name in entrances or name == "main"
            return is_named or any(
                isinstance(node, ast.Call) and source.resolve(node.func) in ("rclpy.init", "rclpy.init.init")
                for node in walk(statement)
            )
    return False


def _pieces(paths: Paths, source: PythonSource, piece: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes that run with a piece of code; no undecorated definitions or named dictionaries."""
    waiting = [piece]
    while waiting:
        node = waiting.pop()
        if whole := _whole(node):
            yield from whole
            continue
        yield node
        for inner in paths.reached(source, node):
            match inner:
                case (
                    ast.FunctionDef(decorator_list=[])
                    | ast.AsyncFunctionDef(decorator_list=[])
                    | ast.ClassDef()
                ):
                    pass
                case ast.Assign(targets=[ast.Name()], value=ast.Dict()):
                    pass
                case _:
                    waiting.append(inner)


@kept
def _whole(node: ast.AST) -> tuple[ast.AST, ...]:
    """Return the nodes of an expression that is evaluated as a whole, or not at all; none if parts of it may be left out."""
    parts = [_whole(child) for child in reversed(children(node))] if isinstance(node, _WHOLE) else [()]
    return (node, *itertools.chain(*parts)) if all(parts) else ()


def _called_by_others(
    source: PythonSource, definition: ast.ClassDef, classes: Collection[str]
) -> Iterator[Function]:
    """Yield the methods of a class that Python calls, or a base class that is not among `classes`."""
    own = {*classes, "object", "Node"}
    is_open = any(
        base is None or base.rpartition(".")[2] not in own for base in map(source.resolve, definition.bases)
    )
    inherited = node_members() if definition.bases else frozenset()
    for method in definition.body:
        if not isinstance(method, (ast.FunctionDef, ast.AsyncFunctionDef)):
            continue
        if is_open or method.name.startswith("__") or method.name in inherited:
            yield method


def _names_in(node: ast.AST) -> Iterator[str]:
    """Yield the names by which a node may lead to a definition; a string may be a name that is looked up."""
    match node:
        case ast.Name(id=name, ctx=ast.Load()) | ast.Attribute(attr=name) | ast.Constant(value=str(name)):
            yield name
        case ast.alias(name=name, asname=str()):
            yield name.rpartition(".")[2]
