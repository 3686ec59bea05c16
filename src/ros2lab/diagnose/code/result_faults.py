"""Values that a function makes and then loses: a message never sent, a result not kept or not returned."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.interfaces import is_interface
from ros2lab.diagnose.sources.node_source import NodeClass, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, walk
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.uses import FUNCTIONS, State, Uses, filled, is_log, values_in

_TEXT_METHODS = frozenset(("lower", "upper", "strip", "lstrip", "rstrip", "replace"))
# Builtins that only compute.
_PURE = frozenset(
    ("abs", "bool", "float", "int", "len", "max", "min", "pow", "round", "sorted", "str", "sum")
)


def result_faults(uses: Uses) -> Iterator[Finding]:
    """Yield values that functions compute, fill or set without effect."""
    for source in uses.sources.sources.values():
        for owner, _, node in uses.sources.scoped(source):
            if isinstance(node, FUNCTIONS):
                yield from _never_sent(uses, source, owner, node)
                yield from _lost_fillings(source, node)
                yield from _lost_locals(uses, source, owner, node)
                yield from _nothing_returned(source, owner, node)
            elif isinstance(node, ast.Call):
                yield from _no_answer(uses, source, owner, node)
            elif isinstance(node, ast.Expr):
                yield from _result_lost(uses, source, owner, node.value)


def _no_answer(
    uses: Uses, source: PythonSource, owner: NodeClass | None, call: ast.Call
) -> Iterator[Finding]:
    """Yield parameter callbacks that do not return whether they accept the new values."""
    if getattr(call.func, "attr", "") != "add_on_set_parameters_callback" or not call.args:
        return
    given = call.args[0]
    method = uses.sources.method(owner, given.attr) if owner and is_self_attribute(given) else None
    if method and not any(isinstance(node, ast.Return) and node.value for node in own_nodes(method)):
        fix = (
            f"write `return SetParametersResult(successful=True)` as the last line of {method.name}(), "
            "with `from rcl_interfaces.msg import SetParametersResult` at the top"
        )
        cause = f"{method.name}() returns nothing, but must tell ROS whether the new values are accepted, so every change is rejected."
        yield Finding("value-none", cause, source.at(method), fix)


def _may_be_message(source: PythonSource, owner: NodeClass | None, given: ast.expr) -> bool:
    """Return whether an argument of publish() may be a message; `publish-text` reports those that cannot."""
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
    """Yield messages that a function creates and fills but never passes on."""
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
        cause = f"{function.name}() fills {name} but never sends it"
        if len(calls) == 1 and _may_be_message(source, owner, calls[0].args[0]):
            given = ast.unparse(calls[0].args[0])
            fix = f"write {ast.unparse(calls[0].func)}({name})"
            yield Finding("never-sent", f"{cause}: it publishes {given} instead.", source.at(calls[0]), fix)
        elif not calls and (publisher := _publisher(uses, owner, str(kind))):
            fix = f"write `{publisher}.publish({name})` as the last line of {function.name}()"
            yield Finding("never-sent", f"{cause}.", source.at(fills[-1]), fix)


def _is_used(function: Function, name: str) -> bool:
    """Return whether a function uses a variable for more than filling its fields and logging them."""
    bases = {id(n.value) for n in walk(function) if isinstance(n, ast.Attribute)}
    logged = {id(n) for call in own_nodes(function) if is_log(call) for n in walk(call)}
    whole = [n for n in walk(function) if isinstance(n, ast.Name) and n.id == name and id(n) not in bases]
    fields = [n for n in _fields(function, name) if id(n) not in logged]
    contexts = [*(n.ctx for n in whole), *(n.ctx for n in fields)]
    return any(isinstance(context, ast.Load) for context in contexts)


def _is_fill(node: ast.Attribute, name: str) -> bool:
    return isinstance(node.ctx, ast.Store) and (dotted(node) or "").startswith(f"{name}.")


def _fields(function: Function, name: str) -> list[ast.Attribute]:
    """Return the full attributes of a variable that are read or set, such as `msg.linear.x`."""
    inner = {id(n.value) for n in walk(function) if isinstance(n, (ast.Attribute, ast.Subscript))}
    return [
        n
        for n in walk(function)
        if isinstance(n, ast.Attribute) and id(n) not in inner and (dotted(n) or "").startswith(f"{name}.")
    ]


def _publisher(uses: Uses, owner: NodeClass | None, kind: str) -> str:
    """Return the only attribute of a class that holds a publisher of a type; empty if not just one."""
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


def _lost_locals(
    uses: Uses, source: PythonSource, owner: NodeClass | None, function: Function
) -> Iterator[Finding]:
    """Yield local variables that are set and never read, where a global or attribute of that name is read.

    A value that is only fetched is reported, too, if the function sets a single field to the constant 0.
    """
    names = [node for node in walk(function) if isinstance(node, ast.Name)]
    own = {id(node) for node in names}
    read_elsewhere = {
        node.id
        for node in source.nodes
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and id(node) not in own
    }
    kept = State(uses, owner).read & uses.sources.attributes(owner) if owner else frozenset()
    values = values_in(function)
    for node in _never_read(function, names):
        name, said = node.id, f"{function.name}() sets {node.id}, which is a local variable; "
        if name in kept:
            fix = f"write self.{name} instead of {name}"
            yield Finding("not-kept", f"{said}self.{name} does not change.", source.at(node), fix)
            return
        if name in source.assigned and name in read_elsewhere:
            fix = f"write `global {name}` as the first line of {function.name}()"
            yield Finding("not-kept", f"{said}the global {name} does not change.", source.at(node), fix)
            return
        value = values.get(id(node))
        if owner is None or value is None or function.name == "__init__" or not _is_fetched(value):
            continue
        zeros = [(t, v) for t, v in filled(function) if isinstance(v, ast.Constant) and v.value == 0]
        if len(zeros) == 1:
            target, zero = zeros[0]
            cause = f"{function.name}() computes {name} but never uses it; {target} is always {ast.unparse(zero)}."
            yield Finding("never-read", cause, source.at(zero), f"write {target} = {name}")
            return


def _never_read(function: Function, names: Sequence[ast.Name]) -> Iterator[ast.Name]:
    """Yield the assigned variables that a function never reads, nor anything that is bound together with them."""
    read = {node.id for node in names if isinstance(node.ctx, ast.Load)}
    read |= {n for node in walk(function) if isinstance(node, (ast.Global, ast.Nonlocal)) for n in node.names}
    bound = _assigned_together(function)
    for node in names:
        is_lost = node.id not in read and not node.id.startswith("_")
        if is_lost and id(node) in bound and bound[id(node)].isdisjoint(read):
            yield node


def _assigned_together(function: Function) -> dict[int, set[str]]:
    """Return for each name that an assignment binds, by its `id`, all that the assignment binds.

    What a loop, a `with` or an import binds is left out: it is bound because of the statement, not to be kept.
    """
    found = dict[int, set[str]]()
    for node in walk(function):
        if isinstance(node, (ast.Assign, ast.AnnAssign, ast.AugAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names = [n for to in targets for n in walk(to) if isinstance(n, ast.Name)]
            together = {ast.unparse(n) for n in names}
            found |= {id(n): together for n in names if isinstance(n.ctx, ast.Store)}
    return found


def _is_fetched(value: ast.expr) -> bool:
    """Return whether an expression only fetches a value; a computed one may be a leftover."""
    calls = [node for node in walk(value) if isinstance(node, ast.Call)]
    names = {getattr(call.func, "id", getattr(call.func, "attr", "")) for call in calls}
    return not isinstance(value, (ast.BinOp, ast.Constant)) and names <= _PURE | {"get_parameter"}


def _lost_fillings(source: PythonSource, method: Function) -> Iterator[Finding]:
    """Yield message fields that are filled after the message is sent, or before it is created again."""
    made = {
        target.id
        for node in own_nodes(method)
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call)
        if is_interface(source.resolve(node.value.func))
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    for name in made:
        pending: ast.stmt | None = None
        sent: ast.stmt | None = None
        for statement in method.body:
            fills, reads, binds = _changes_of(statement, name)
            if binds and pending is not None and not reads:
                cause = f"{name} is created again here, so what line {pending.lineno} filled in is lost."
                yield Finding("filling-lost", cause, source.at(statement), "remove this line")
                break
            if binds:
                pending, sent = None, None
            if reads:
                pending, sent = None, statement
            if fills and not reads:
                pending = pending or statement
        else:
            if pending is not None and sent is not None:
                last = ast.unparse(sent).splitlines()[0]
                cause = f"`{ast.unparse(pending).splitlines()[0]}` comes after `{last}`, so it is not in what was sent."
                yield Finding(
                    "filling-lost",
                    cause,
                    source.at(pending),
                    f"move `{last}` after the lines that fill {name}",
                )


def _changes_of(statement: ast.stmt, name: str) -> tuple[bool, bool, bool]:
    """Return whether a statement sets a field of a variable, reads it otherwise, and assigns to it."""
    bases: set[int] = set()
    for node in walk(statement):
        inner: ast.AST = node
        if isinstance(node, (ast.Attribute, ast.Subscript)) and isinstance(node.ctx, ast.Store):
            while isinstance(inner, (ast.Attribute, ast.Subscript)):
                inner = inner.value
            bases.add(id(inner))
    names = [node for node in walk(statement) if isinstance(node, ast.Name) and node.id == name]
    fills = any(id(node) in bases for node in names)
    reads = any(id(node) not in bases and isinstance(node.ctx, ast.Load) for node in names)
    return fills, reads, any(isinstance(node.ctx, ast.Store) for node in names)


def _result_lost(
    uses: Uses, source: PythonSource, owner: NodeClass | None, value: ast.expr
) -> Iterator[Finding]:
    """Yield calls of functions that only compute something, where the return value is not used."""
    if not isinstance(value, ast.Call):
        return
    text, called = ast.unparse(value), value.func
    if is_self_attribute(called):
        function = uses.sources.method(owner, called.attr)
    else:
        function = uses.sources.functions.get(uses.sources.resolve(source, called) or "", (source, None))[1]
    if function is not None and _only_computes(function):
        target = next(
            (ast.unparse(argument) for argument in value.args if dotted(argument)),
            f"self.{function.name}_result",
        )
    elif isinstance(called, ast.Attribute) and called.attr in _TEXT_METHODS and dotted(called.value):
        target = ast.unparse(called.value)
        if "." not in target or is_self_attribute(called):
            return  # only fields and attributes are reported
    else:
        return
    cause = f"`{text}` returns a new value and changes nothing, and the return value is not used."
    yield Finding("no-effect", cause, source.at(value), f"write {target} = {text}")


def _nothing_returned(source: PythonSource, owner: NodeClass | None, function: Function) -> Iterator[Finding]:
    """Yield functions that compute a value last but do not return it, though their callers use it."""
    nodes = own_nodes(function)
    if isinstance(function, ast.AsyncFunctionDef) or any(
        isinstance(node, (ast.Return, ast.Yield, ast.YieldFrom, ast.Raise)) for node in nodes
    ):
        return
    match function.body[-1]:
        case _ if shown_last(function.body):
            is_computed, last = True, ast.unparse(shown_last(function.body)[-1].args[0])
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
        cause = f"{function.name}() returns nothing, so `{ast.unparse(users[0]).splitlines()[0]}` uses None instead of {last}."
        fix = return_in_place(function) or f"write `return {last}` as the last line of {function.name}()"
        yield Finding("value-none", cause, source.at(function.body[-1]), fix)


def return_in_place(function: Function) -> str:
    """Return how to make a function return what it prints last; empty if it prints nothing last."""
    printed = shown_last(function.body)
    returns = [f"`return {ast.unparse(call.args[0])}` on line {call.lineno}" for call in printed]
    joined = f"{', '.join(returns[:-1])}, and {returns[-1]}" if len(returns) > 1 else "".join(returns)
    return f"write return instead of print: {joined}" if printed else ""


def shown_last(body: list[ast.stmt]) -> list[ast.Call]:
    """Return the print calls that end each path through a block; empty if a path ends otherwise."""
    match body[-1] if body else None:
        case ast.Expr(value=ast.Call(func=ast.Name(id="print"), args=[value], keywords=[]) as call) if (
            not isinstance(value, (ast.Starred, ast.JoinedStr))
        ):
            return [call]
        case ast.If(body=then, orelse=otherwise):
            shown = shown_last(then)
            return shown and (shown + shown_last(otherwise) if otherwise else shown)
    return []


def _defines(node: ast.AST, name: str) -> bool:
    return isinstance(node, FUNCTIONS) and node.name == name


def _uses_value(node: ast.AST, name: str, is_method: bool) -> bool:
    """Return whether a node uses the return value of a function."""
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
    """Return whether a function returns a value and does nothing else."""
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
