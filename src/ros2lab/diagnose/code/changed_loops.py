"""Collections that are changed while a loop iterates over them."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.one_run import blocks, may_leave
from ros2lab.diagnose.sources.python_source import PythonSource, walk
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import ADDS, TAKES_OUT, stores_in

_Path = list[tuple[list[ast.stmt], int, bool]]  # (block, index, whether a loop repeats it), outermost first


def changed_loops(sources: NodeSources) -> Iterator[Finding]:
    """Yield loops over a list, a dict or a set whose body changes it and then goes on looping."""
    for source in sources.sources.values():
        for owner, _, loop in sources.scoped(source):
            if isinstance(loop, ast.For):
                yield from _changes(sources, source, owner, loop)


def _walked(loop: ast.For) -> tuple[str, str] | None:
    """Return the name of what a loop iterates over, and of its index if it has one; None if unnamed."""
    places = ""
    match loop.iter:
        case ast.Call(func=ast.Name(id="enumerate"), args=[ast.Name() | ast.Attribute() as kept, *_]):
            pass
        case ast.Call(
            func=ast.Name(id="range"), args=[ast.Call(func=ast.Name(id="len"), args=[ast.expr() as kept])]
        ):
            places = loop.target.id if isinstance(loop.target, ast.Name) else ""
            if not places:
                return None
        case ast.Call(
            func=ast.Attribute(value=ast.Name() | ast.Attribute() as kept, attr="items" | "keys" | "values"),
            args=[],
        ):
            pass
        case ast.Name() | ast.Attribute() as kept:
            pass
        case _:
            return None
    name = dotted(kept)
    return (name, places) if name and name != "self" else None  # iterating over self calls its own __iter__


def _changes(
    sources: NodeSources, source: PythonSource, owner: NodeClass | None, loop: ast.For
) -> Iterator[Finding]:
    walked = _walked(loop)
    if walked is None:
        return
    name, places = walked
    bound = [node for statement in loop.body for node in stores_in(walk(statement))]
    if any(f"{name}.".startswith(f"{dotted(node)}.") for node in bound):
        return  # the name may refer to another collection by then
    for path in _paths(loop.body, []):
        block, index, _ = path[-1]
        statement = block[index]
        by, changed = _change(sources, owner, statement, name)
        if not by or _is_last(path):
            continue
        if places and not any(isinstance(n, ast.Name) and n.id == places for n in walk(changed)):
            continue
        if by in ADDS and (len(path) > 1 or may_leave(loop.body)):
            continue  # a conditional addition, as to a list of pending work, comes to an end
        how = f"line {statement.lineno} {'adds to' if by in ADDS else 'removes items from'} it"
        then = {
            True: "so the loop never ends",
            False: "so a list skips the item after each removed one, and a dict or a set raises an error",
        }[by in ADDS]
        if places:
            then = "so the item after each removed one is skipped, and the last indices no longer exist"
        cause = f"While the loop goes over {name}, {how}, {then}."
        whole = ast.unparse(loop.iter)
        copy = (
            f"range(len({name}) - 1, -1, -1)"
            if places
            else f"enumerate(list({name}))"
            if whole.startswith("enumerate(")
            else f"list({whole})"
        )
        if whole.startswith("enumerate(") and by == "pop":
            copy = f"reversed(list({whole}))"
        yield Finding("changed-in-loop", cause, source.at(loop), f"write {copy} instead of {whole} here")
        return


def _change(
    sources: NodeSources, owner: NodeClass | None, statement: ast.stmt, name: str
) -> tuple[str, ast.AST]:
    """Return the method, or `del`, by which a statement changes a collection, and the node; or empty."""
    for node in _heads(statement):
        match node:
            case ast.Call(func=ast.Attribute(value=holder, attr=attr)) if (
                attr in TAKES_OUT | ADDS and dotted(holder) == name
            ):
                return attr, node
            case ast.Subscript(value=holder, ctx=ast.Del()) if dotted(holder) == name:
                return "del", node
            case ast.Call(func=called) if is_self_attribute(called) and name.startswith("self."):
                method = sources.method(owner, called.attr)
                for inner in method.body if method else ():
                    by, _ = _change(sources, None, inner, name)
                    if by in TAKES_OUT | {"del"}:
                        return by, node
    return "", statement


def _heads(statement: ast.stmt) -> Iterator[ast.AST]:
    """Yield the nodes of a statement itself, without those of the statements nested in it."""
    blocks = [id(inner) for _, body in _bodies(statement) for inner in body]
    nodes = [statement]
    while nodes:
        node = nodes.pop()
        yield node
        if not isinstance(node, (ast.FunctionDef, ast.Lambda, ast.ClassDef, ast.AsyncFunctionDef)):
            nodes += [child for child in ast.iter_child_nodes(node) if id(child) not in blocks]  # type: ignore[misc]


def _bodies(statement: ast.AST) -> Iterator[tuple[bool, list[ast.stmt]]]:
    """Yield the blocks nested in a statement, each with whether the statement is a loop."""
    if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
        return
    is_loop = isinstance(statement, (ast.For, ast.While, ast.AsyncFor))
    for part in (statement, *getattr(statement, "handlers", ()), *getattr(statement, "cases", ())):
        yield from ((is_loop, body) for body in blocks(part))


def _paths(body: list[ast.stmt], above: _Path, *, is_loop: bool = False) -> Iterator[_Path]:
    """Yield the path to every statement of a block and of the blocks nested in it."""
    for index, statement in enumerate(body):
        path = [*above, (body, index, is_loop)]
        yield path
        for again, inner in _bodies(statement):
            yield from _paths(inner, path, is_loop=again)


def _is_last(path: _Path) -> bool:
    """Return whether the outer loop always ends after a statement."""
    is_left = False  # whether a break or continue has ended the pass of an inner loop
    for depth in range(len(path) - 1, -1, -1):
        block, index, is_loop = path[depth]
        is_inside = any(again for *_, again in path[: depth + 1])
        for statement in () if is_left else block[index:]:
            if isinstance(statement, (ast.Return, ast.Raise)):
                return True
            if isinstance(statement, (ast.Break, ast.Continue)):
                if not is_inside:
                    return isinstance(statement, ast.Break)
                is_left = True
                break
        is_left = is_left and not is_loop
    return False
