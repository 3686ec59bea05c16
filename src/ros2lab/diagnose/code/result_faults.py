"""Values that a function makes and then loses: a message never sent, a result not kept or not returned."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.code.idle_statements import tried_statements
from ros2lab.diagnose.code.lost_fillings import is_shared, lost_fillings
from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.sources.answered import ACCEPTED, plain_returns, unanswered
from ros2lab.diagnose.sources.commented_out import disabled
from ros2lab.diagnose.sources.interfaces import is_interface
from ros2lab.diagnose.sources.node_source import NodeClass, is_self_attribute
from ros2lab.diagnose.sources.own_functions import called_function
from ros2lab.diagnose.sources.python_source import (
    PAUSES,
    YIELDS,
    Function,
    PythonSource,
    assigned_to,
    assignments,
    last_name,
    names_bound,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import calls_in, removal, stores_in
from ros2lab.diagnose.sources.uses import State, Uses, filled, is_log, own_stores, values_in

# Builtins that only compute.
_PURE = frozenset(
    ("abs", "bool", "float", "int", "len", "max", "min", "pow", "round", "sorted", "str", "sum")
)


def result_faults(uses: Uses) -> Iterator[Finding]:
    """Yield values that functions compute, fill or set without effect."""
    for source in uses.sources.sources.values():
        tried = tried_statements(source)
        for owner, _, node in uses.sources.scoped(source):
            if isinstance(node, Function):
                yield from _never_sent(uses, source, owner, node)
                yield from lost_fillings(source, node)
                yield from _lost_locals(uses, source, owner, node)
                yield from _nothing_returned(uses, source, owner, node)
            elif isinstance(node, ast.Call):
                yield from _no_answer(uses, source, owner, node)
            elif isinstance(node, ast.Expr) and id(node) not in tried:
                yield from _result_lost(uses, source, owner, node.value)


def _no_answer(
    uses: Uses, source: PythonSource, owner: NodeClass | None, call: ast.Call
) -> Iterator[Finding]:
    """Yield parameter callbacks that do not return whether they accept the new values."""
    if getattr(call.func, "attr", "") != "add_on_set_parameters_callback" or not call.args:
        return
    given = call.args[0]
    method = uses.sources.method(owner, given.attr) if owner and is_self_attribute(given) else None
    if not method or method.decorator_list:
        return
    if fix := unanswered(method, ACCEPTED):
        is_known = "SetParametersResult" in source.names
        more = "" if is_known else ", with `from rcl_interfaces.msg import SetParametersResult` at the top"
        said = [ast.unparse(node.value) if node.value else "nothing" for node in plain_returns(method)]
        returned = in_a_row([*dict.fromkeys(said)]) or "nothing"
        cause = f"{method.name}() returns {returned}, but must tell ROS with a SetParametersResult whether the new values are accepted, so every such change is rejected."
        yield Finding("value-none", cause, source.at(next(plain_returns(method), method)), f"{fix}{more}")


def _may_be_message(source: PythonSource, owner: NodeClass | None, given: ast.expr) -> bool:
    """Return whether an argument of publish() may be a message; `publish-text` reports those that cannot."""
    if isinstance(given, ast.Name):
        return True
    made = assigned_to(walk(owner.definition if owner else source.tree), ast.unparse(given))
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
        fills = [n for n in stores_in(walk(function)) if (dotted(n) or "").startswith(f"{name}.")]
        if not fills or _is_used(function, name) or not _is_alone(source, function, name):
            continue
        calls = [
            n
            for n in calls_in(own_nodes(function))
            if getattr(n.func, "attr", "") == "publish" and len(n.args) == 1
        ]
        cause = f"{function.name}() fills {name} but never sends it"
        if len(calls) == 1 and _may_be_message(source, owner, calls[0].args[0]):
            given = ast.unparse(calls[0].args[0])
            kept = _publisher(uses, owner, str(kind))
            is_filled = any(text.startswith(f"{given}.") for text, _ in filled(function))
            if is_filled or (kept and kept != ast.unparse(getattr(calls[0].func, "value", calls[0].func))):
                continue  # another message is sent, and this may be left over
            fix = f"write {ast.unparse(calls[0].func)}({name})"
            yield Finding("never-sent", f"{cause}: it publishes {given} instead.", source.at(calls[0]), fix)
        elif not calls and (publisher := _publisher(uses, owner, str(kind))):
            line, back = disabled(source.text, [function], rf"\.publish\({name}\)")
            where = _sending_place(function, node, fills[-1].lineno)
            fix = back if line else f"write `{publisher}.publish({name})` {where}"
            yield Finding("never-sent", f"{cause}.", source.at(fills[-1]), fix)


def _is_alone(source: PythonSource, function: Function, name: str) -> bool:
    """Return whether a variable only ever holds new messages or copies, for which no other name stands."""
    values = values_in(function)
    bound = [n for n in stores_in(walk(function)) if isinstance(n, ast.Name) and n.id == name]
    made = [getattr(values.get(id(node)), "func", None) for node in bound]
    kinds = [source.resolve(called) or "" if called else "" for called in made]
    return not is_shared(function, name) and all(is_interface(k) or k.startswith("copy.") for k in kinds)


def _sending_place(function: Function, made: ast.stmt, filled_at: int) -> str:
    """Say where a message is sent that is made in a function and filled up to a line: there, or in the loop that waits below."""
    body = function.body
    around = next((n for n in body if n.lineno <= filled_at <= (n.end_lineno or n.lineno)), body[-1])
    if made not in body or isinstance(around, (ast.For, ast.While)):
        return f"below line {filled_at}, with the same indentation"
    below = body[body.index(around) + 1 :]
    loops = [n for n in below if isinstance(n, (ast.For, ast.While))]
    if waiting := [n for n in loops if any("sleep" in last_name(call.func) for call in calls_in(walk(n)))]:
        return f"as the first line of the loop on line {waiting[0].lineno}"
    return f"above line {below[0].lineno}" if below else f"as the last line of {function.name}()"


def _is_used(function: Function, name: str) -> bool:
    """Return whether a function uses a variable for more than filling its fields and logging them."""
    bases = {id(n.value) for n in walk(function) if isinstance(n, ast.Attribute)}
    logged = {id(n) for call in own_nodes(function) if is_log(call) for n in walk(call)}
    whole = [n for n in walk(function) if isinstance(n, ast.Name) and n.id == name and id(n) not in bases]
    fields = [n for n in _fields(function, name) if id(n) not in logged]
    contexts = [*(n.ctx for n in whole), *(n.ctx for n in fields)]
    return any(isinstance(context, ast.Load) for context in contexts)


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
    found = {
        creation.kept
        for creation in uses.sources.creations
        if creation.owner is owner and creation.method == "create_publisher"
        if creation.source.resolve(creation.given("msg_type")) == kind
    } - {""}
    return found.pop() if len(found) == 1 else ""


def _lost_locals(
    uses: Uses, source: PythonSource, owner: NodeClass | None, function: Function
) -> Iterator[Finding]:
    """Yield local variables that are set and never read, where a global or attribute of that name is read.

    A value that is only fetched is reported, too, if the function sets a single field to the constant 0.
    """
    names = [node for node in walk(function) if isinstance(node, ast.Name)]
    of_file = names_bound(target for target, _ in assignments(source.tree.body))
    own = {id(node) for node in names}
    read_elsewhere = {
        node.id
        for node in source.nodes
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and id(node) not in own
    }
    kept = State(uses, owner).read & uses.sources.attributes(owner) if owner else frozenset()
    values = values_in(function)
    given = {id(n): part for to, value in assignments(walk(function)) for n, part in _parts(to, value)}
    # What it sets itself may be kept under this name as well.
    kept -= own_stores(function)
    for node in _never_read(function, names):
        name, said = node.id, f"{function.name}() sets {node.id}, which is a local variable; "
        if name in kept and not _is_read_only(given.get(id(node)), f"self.{name}"):
            fix = f"write self.{name} instead of {name}"
            yield Finding("not-kept", f"{said}self.{name} does not change.", source.at(node), fix)
            return
        if name in of_file and name in read_elsewhere:
            fix = f"write `global {name}` as the first line of {function.name}()"
            yield Finding("not-kept", f"{said}the global {name} does not change.", source.at(node), fix)
            return
        value = values.get(id(node))
        if owner is None or value is None or function.name == "__init__" or not _is_fetched(value):
            continue
        fills = [*filled(function)]
        zeros = [(t, v) for t, v in fills if isinstance(v, ast.Constant) and v.value == 0]
        # Nothing else is filled in: so the value was meant for it.
        if len(zeros) == 1 == len(fills):
            target, zero = zeros[0]
            cause = f"{function.name}() computes {name} but never uses it; {target} is always {ast.unparse(zero)}."
            yield Finding("never-read", cause, source.at(zero), f"write {target} = {name}")
            return


def _parts(target: ast.expr, value: ast.expr) -> Iterator[tuple[ast.expr, ast.expr]]:
    """Yield what a target binds, each with the part of the value that it gets, or with all of it."""
    inner, given = getattr(target, "elts", None), getattr(value, "elts", [])
    if inner is None:
        yield target, value
    for number, part in enumerate(inner or ()):
        yield from _parts(part, given[number] if len(given) == len(inner or ()) else value)


def _is_read_only(value: ast.expr | None, name: str) -> bool:
    """Return whether a value is made of an attribute's own without being its next one, such as one more or less."""
    match value:
        case ast.UnaryOp(operand=side) if dotted(side) == name:
            return False
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub(), right=right) if name in (
            dotted(left),
            dotted(right),
        ):
            return False
    return value is not None and any(dotted(inner) == name for inner in walk(value))


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
    calls = calls_in(walk(value))
    names = {last_name(call.func) for call in calls}
    return not isinstance(value, (ast.BinOp, ast.Constant)) and names <= _PURE | {"get_parameter"}


def _result_lost(
    uses: Uses, source: PythonSource, owner: NodeClass | None, value: ast.expr
) -> Iterator[Finding]:
    """Yield calls of functions that only compute something, where the return value is not used."""
    if not isinstance(value, ast.Call):
        return
    called = value.func
    function = called_function(uses.sources, source, owner, called)
    is_other = is_self_attribute(called) and _is_overridden(uses, called.attr)
    if function is None or is_other or not _only_computes(function):
        return
    text = ast.unparse(value)
    given = [ast.unparse(argument) for argument in value.args if dotted(argument) in source.stored]
    target = given[0] if len(given) == 1 == len(value.args) else ""
    cause = f"`{text}` returns a new value and changes nothing, and the return value is not used."
    fix = (
        f"write {target} = {text}"
        if target
        else f"use what it returns, or {removal(source, value, 'this line')}"
    )
    yield Finding("no-effect", cause, source.at(value), fix)


def _is_overridden(uses: Uses, name: str) -> bool:
    """Return whether several classes define a method, so that one may do more than another."""
    return sum(name in owner.methods for owner in uses.sources.classes.values()) > 1


def _nothing_returned(
    uses: Uses, source: PythonSource, owner: NodeClass | None, function: Function
) -> Iterator[Finding]:
    """Yield functions that compute a value last but do not return it, though their callers use it."""
    nodes = own_nodes(function)
    is_passed = function.decorator_list or (owner is not None and _is_overridden(uses, function.name))
    if (
        is_passed
        or isinstance(function, ast.AsyncFunctionDef)
        or any(isinstance(node, (ast.Return, *YIELDS, ast.Raise)) for node in nodes)
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
    scope = walk(owner.definition) if owner is not None else source.nodes
    users = [node for node in scope if _uses_value(node, function.name, owner is not None)]
    same = [n for n in source.nodes if isinstance(n, Function) and n.name == function.name]
    if is_computed and users and len(same) == 1:
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
        if isinstance(node, (ast.Global, ast.Nonlocal, ast.Raise, *PAUSES, ast.Assert)):
            return False
        if isinstance(node, ast.Call) and not (
            getattr(node.func, "id", "") in _PURE or (dotted(node.func) or "").startswith("math.")
        ):
            return False
    return is_returning
