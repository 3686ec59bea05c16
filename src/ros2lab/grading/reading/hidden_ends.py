"""The publishers and subscriptions that code may create without being seen by reading.

Whatever creates an end must be given the message's class. If a submission gives that class only to the plain
calls that are read, and looks up nothing by a computed name, it creates no other end of that type; else
nobody can tell.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Collection, Iterable, Iterator

from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.construction import looks_up
from ros2lab.diagnose.sources.python_source import PythonSource, last_name, walk
from ros2lab.grading.evidence import WrittenEnd

# What looks up a class whose name it is given.
_LOOKED_UP = frozenset(("import_module", "__import__", "get_message"))


def hidden_ends(sources: Collection[PythonSource], ends: Iterable[WrittenEnd]) -> Iterator[WrittenEnd]:
    """Yield a publisher and a subscription on an unknown topic for each type that code uses beyond `ends`."""
    handed = Counter(name for source in sources for name in _handed(source))
    handed.subtract(end.type_name for end in ends)
    types = [name for name, count in handed.items() if count > 0]
    if any(_is_looked_up(node) for source in sources for node in source.nodes):
        types.append("")
    for type_name in types:
        yield from (WrittenEnd("", type_name, is_publisher, []) for is_publisher in (True, False))


def _handed(source: PythonSource) -> Iterator[str]:
    """Yield a message's type wherever a module uses its class, except to create a message or to annotate."""
    own = {id(node) for part in source.nodes for node in _not_handed(part)}
    for node in source.nodes:
        if isinstance(node, (ast.Name, ast.Attribute)) and id(node) not in own:
            name = source.resolve(node) if isinstance(node.ctx, ast.Load) else None
            if name and interfaces.is_interface(name) and ".msg." in name:
                yield name.replace(".", "/")


def _not_handed(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes inside another one that it passes to nothing."""
    match node:
        case ast.Call(func=ast.Name(id="isinstance" | "issubclass"), args=[_, *kinds]):
            yield from (inner for kind in kinds for inner in walk(kind))
        case ast.Call(func=function):
            yield function
        case ast.Attribute(value=value):
            yield value
        case ast.AnnAssign(annotation=annotation) | ast.arg(annotation=ast.expr() as annotation):
            yield from walk(annotation)
        case (
            ast.FunctionDef(returns=ast.expr() as returns)
            | ast.AsyncFunctionDef(returns=ast.expr() as returns)
        ):
            yield from walk(returns)


def _is_looked_up(node: ast.AST) -> bool:
    """Return whether a node looks something up by a computed name."""
    return looks_up(node) or (isinstance(node, ast.Call) and last_name(node.func) in _LOOKED_UP)
