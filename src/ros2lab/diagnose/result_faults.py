"""Values that a function makes and that get no further: a message never sent, a result not kept or not returned."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.interfaces import is_interface
from ros2lab.diagnose.node_source import NodeClass, is_self_attribute
from ros2lab.diagnose.python_source import Function, PythonSource, own_nodes, walk
from ros2lab.diagnose.static_value import dotted
from ros2lab.diagnose.uses import FUNCTIONS, Uses, is_log

_TEXT_METHODS = frozenset(("lower", "upper", "strip", "lstrip", "rstrip", "replace"))
# Builtins that only compute.
_PURE = frozenset(
    ("abs", "bool", "float", "int", "len", "max", "min", "pow", "round", "sorted", "str", "sum")
)


def result_faults(uses: Uses) -> Iterator[Finding]:
    """Yield what functions compute, fill or set in vain."""
    for source in uses.sources.sources.values():
        for owner, _, node in uses.sources.scoped(source):
            if isinstance(node, FUNCTIONS):
                yield from _never_sent(uses, source, owner, node)
                yield from _never_global(source, node)
                yield from _nothing_returned(source, owner, node)
            elif isinstance(node, ast.Expr):
                yield from _result_lost(uses, source, owner, node.value)


def _may_be_message(source: PythonSource, owner: NodeClass | None, given: ast.expr) -> bool:
    """Return whether what is published may be a message: what cannot be is told by `publish-text`."""
    if isinstance(given, ast.Name):
        return True
    made = [
        node.value
        for node in walk(owner.definition if owner else source.tree)
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == ast.unparse(given)
    ]
    return any(
        isinstance(value, ast.Call) and is_interface(source.resolve(value.func)) for value in (given, *made)
    )


def _never_sent(
    uses: Uses, source: PythonSource, owner: NodeClass | None, function: Function
) -> Iterator[Finding]:
    """Yield a message that a function makes and fills, and gives to nothing."""
    for node in own_nodes(function):
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call(func=made)):
                kind = source.resolve(made)
            case _:
                continue
        if not is_interface(kind):
            continue
        fills = [n for n in walk(function) if isinstance(n, ast.Attribute) and _is_fill(n, name)]
        if not fills or _is_used(function, name):
            continue
        calls = [
            n
            for n in own_nodes(function)
            if isinstance(n, ast.Call) and getattr(n.func, "attr", "") == "publish" and len(n.args) == 1
        ]
        cause = f"{function.name}() fills {name}, and sends it nowhere"
        if len(calls) == 1 and _may_be_message(source, owner, calls[0].args[0]):
            given = ast.unparse(calls[0].args[0])
            fix = f"write {ast.unparse(calls[0].func)}({name})"
            yield Finding("never-sent", f"{cause}: it publishes {given}.", source.at(calls[0]), fix)
        elif not calls and (publisher := _publisher(uses, owner, str(kind))):
            fix = f"write `{publisher}.publish({name})` as the last line of {function.name}()"
            yield Finding("never-sent", f"{cause}.", source.at(fills[-1]), fix)


def _is_used(function: Function, name: str) -> bool:
    """Return whether a function does something with what a name holds but to fill it and to log it."""
    bases = {id(n.value) for n in walk(function) if isinstance(n, ast.Attribute)}
    logged = {id(n) for call in own_nodes(function) if is_log(call) for n in walk(call)}
    whole = [n for n in walk(function) if isinstance(n, ast.Name) and n.id == name and id(n) not in bases]
    fields = [n for n in _fields(function, name) if id(n) not in logged]
    contexts = [*(n.ctx for n in whole), *(n.ctx for n in fields)]
    return any(isinstance(context, ast.Load) for context in contexts)


def _is_fill(node: ast.Attribute, name: str) -> bool:
    return isinstance(node.ctx, ast.Store) and (dotted(node) or "").startswith(f"{name}.")


def _fields(function: Function, name: str) -> list[ast.Attribute]:
    """Return the whole fields that are read or filled of what a name holds, such as `msg.linear.x`."""
    inner = {id(n.value) for n in walk(function) if isinstance(n, (ast.Attribute, ast.Subscript))}
    return [
        n
        for n in walk(function)
        if isinstance(n, ast.Attribute) and id(n) not in inner and (dotted(n) or "").startswith(f"{name}.")
    ]


def _publisher(uses: Uses, owner: NodeClass | None, kind: str) -> str:
    """Return the only attribute of a class that holds a publisher of a type."""
    found = set()
    for creation in uses.sources.creations:
        type_ = (creation.arguments or {}).get("msg_type")
        if (
            creation.owner is owner
            and creation.method == "create_publisher"
            and creation.function is not None
        ):
            values = {
                id(value): node
                for node in walk(creation.function)
                if isinstance(node, ast.Assign)
                for value in [node.value]
            }
            made = values.get(id(creation.call))
            if made is not None and creation.source.resolve(type_) == kind:
                found.add(ast.unparse(made.targets[0]))
    return found.pop() if len(found) == 1 else ""


def _never_global(source: PythonSource, function: Function) -> Iterator[Finding]:
    """Yield a global name to which a function gives a value of its own, which nothing reads."""
    declared = {
        n for node in own_nodes(function) if isinstance(node, (ast.Global, ast.Nonlocal)) for n in node.names
    }
    names = [node for node in walk(function) if isinstance(node, ast.Name)]
    read = {node.id for node in names if isinstance(node.ctx, ast.Load)} | declared
    own = {id(node) for node in names}
    read_elsewhere = {
        n.id
        for n in source.nodes
        if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load) and id(n) not in own
    }
    targets = [t for one in source.tree.body if isinstance(one, ast.Assign) for t in one.targets]
    made = {target.id for target in targets if isinstance(target, ast.Name)}
    for node in names:
        if not isinstance(node.ctx, ast.Store) or node.id in read:
            continue
        if node.id in made and node.id in read_elsewhere:
            cause = f"{function.name}() sets {node.id}, which is a local name of its own; the global {node.id} stays as it was."
            fix = f"write `global {node.id}` as the first line of {function.name}()"
            yield Finding("not-kept", cause, source.at(node), fix)
            return


def _result_lost(
    uses: Uses, source: PythonSource, owner: NodeClass | None, value: ast.expr
) -> Iterator[Finding]:
    """Yield a call of what only computes, where nothing is done with its result."""
    if not isinstance(value, ast.Call):
        return
    text, called = ast.unparse(value), value.func
    if is_self_attribute(called):
        function = uses.sources.method(owner, called.attr)
    else:
        function = uses.sources.functions.get(uses.sources.resolve(source, called) or "", (source, None))[1]
    if function is not None and _only_computes(function):
        target = next((ast.unparse(one) for one in value.args if dotted(one)), f"self.{function.name}_result")
    elif isinstance(called, ast.Attribute) and called.attr in _TEXT_METHODS and dotted(called.value):
        target = ast.unparse(called.value)
        if "." not in target or is_self_attribute(called):
            return  # only of a field or an attribute
    else:
        return
    cause = f"`{text}` computes a new value and changes nothing, and nothing is done with what it returns."
    yield Finding("no-effect", cause, source.at(value), f"write {target} = {text}")


def _nothing_returned(source: PythonSource, owner: NodeClass | None, function: Function) -> Iterator[Finding]:
    """Yield a function that computes something last and does not return it, though its callers use what it returns."""
    nodes = own_nodes(function)
    if isinstance(function, ast.AsyncFunctionDef) or any(
        isinstance(node, (ast.Return, ast.Yield, ast.YieldFrom, ast.Raise)) for node in nodes
    ):
        return
    match function.body[-1]:
        case ast.Assign(targets=[ast.Name(id=last)]):
            is_computed = True
        case ast.Expr(value=value):
            is_call = isinstance(value, ast.Call) and getattr(value.func, "id", "") in _PURE
            is_computed = is_call or isinstance(value, (ast.BinOp, ast.Compare, ast.JoinedStr))
            last = ast.unparse(value)
        case _:
            return
    users = [node for node in source.nodes if _uses_value(node, function.name, owner is not None)]
    if is_computed and users and sum(_defines(node, function.name) for node in source.nodes) == 1:
        cause = f"{function.name}() returns nothing, so `{ast.unparse(users[0]).splitlines()[0]}` uses None in place of {last}."
        fix = f"write `return {last}` as the last line of {function.name}()"
        yield Finding("value-none", cause, source.at(function.body[-1]), fix)


def _defines(node: ast.AST, name: str) -> bool:
    return isinstance(node, FUNCTIONS) and node.name == name


def _uses_value(node: ast.AST, name: str, is_method: bool) -> bool:
    """Return whether a part of a statement uses what a call of a function returns."""
    match node:
        case ast.Assign(value=value) | ast.AugAssign(value=value) | ast.FormattedValue(value=value):
            values = [value]
        case ast.BinOp(left=left, right=right):
            values = [left, right]
        case ast.Compare():
            values = [node.left, *node.comparators]
        case _:
            return False
    called = f"self.{name}" if is_method else name
    return any(isinstance(value, ast.Call) and dotted(value.func) == called for value in values)


def _only_computes(function: Function) -> bool:
    """Return whether a function gives back a value on each way and does nothing else."""
    nodes = own_nodes(function)
    is_returning = any(isinstance(node, ast.Return) and node.value is not None for node in nodes)
    for node in nodes:
        if isinstance(node, (ast.Attribute, ast.Subscript)) and isinstance(node.ctx, ast.Store):
            return False
        if isinstance(node, (ast.Global, ast.Nonlocal, ast.Raise, ast.Yield, ast.Await, ast.Assert)):
            return False
        if isinstance(node, ast.Call) and not (
            getattr(node.func, "id", "") in _PURE or (dotted(node.func) or "").startswith("math.")
        ):
            return False
    return is_returning
