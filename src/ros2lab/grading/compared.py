"""The texts with which a program compares what it gets: by `==`, by `case`, or as a key of a dictionary."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterable, Iterator

from ros2lab.diagnose.python_source import PythonSource

LONGEST, MOST = 30, 100  # characters, texts


def compared(sources: Iterable[PythonSource]) -> list[str]:
    """Return the short texts with which something is compared in code that runs, as far as names tell.

    A function is taken to run if code that runs has its name, or if it needs no arguments, as what entry points name.
    A dictionary with a name of its own is taken to be used if code that runs has that name.
    """
    by_name: dict[str, list[ast.AST]] = defaultdict(list)
    waiting: list[ast.AST] = []
    for source in sources:
        waiting.append(source.tree)
        for node in source.nodes:
            match node:
                case (
                    ast.FunctionDef(name=name, args=arguments)
                    | ast.AsyncFunctionDef(name=name, args=arguments)
                ):
                    by_name[name].append(node)
                    if name.startswith("__") or len(arguments.args) == len(arguments.defaults):
                        waiting.append(node)
                case ast.Assign(targets=[ast.Name(id=name)], value=ast.Dict() as table):
                    by_name[name].append(table)
    texts, done = set[str](), set[ast.AST]()
    while waiting:
        piece = waiting.pop()
        if piece in done:
            continue
        done.add(piece)
        for node in _without_named(piece):
            texts.update(_texts(node))
            match node:
                case ast.Name(id=name, ctx=ast.Load()) | ast.Attribute(attr=name):
                    waiting += by_name.pop(name, ())
    return sorted(texts)[:MOST]


def _without_named(piece: ast.AST) -> Iterator[ast.AST]:
    """Yield a piece of code and what stands in it, but no functions and named dictionaries."""
    waiting = [piece]
    while waiting:
        node = waiting.pop()
        yield node
        for inner in ast.iter_child_nodes(node):
            match inner:
                case ast.FunctionDef() | ast.AsyncFunctionDef():
                    waiting += inner.decorator_list
                case ast.Assign(targets=[ast.Name()], value=ast.Dict()):
                    pass
                case _:
                    waiting.append(inner)


def _texts(node: ast.AST) -> Iterator[str]:
    values: list[ast.expr | None] = []
    match node:
        case ast.Compare(left=left, ops=ops, comparators=others):
            if all(isinstance(one, (ast.Eq, ast.NotEq)) for one in ops):
                values = [left, *others]
        case ast.MatchValue(value=value):
            values = [value]
        case ast.Dict(keys=keys):
            values = keys
    for one in values:
        match one:
            case ast.Constant(value=str(text)) if len(text) <= LONGEST:
                yield text
