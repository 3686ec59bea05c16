"""What a node stores and never reads, reads and never changes, defines and never calls: all of it without an error."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.interfaces import is_interface, members_of
from ros2lab.diagnose.node_source import LOG_METHODS, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.python_source import Function, PythonSource, own_nodes, parameters, walk
from ros2lab.diagnose.spelling import is_near_miss, nearest

_COMPARES: Mapping[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
}
_ENDS = frozenset(("cancel", "destroy"))


def data_flow_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield what the values and the methods of node classes show to be in vain."""
    if any(source.fault for source in sources.sources.values()):
        return  # what cannot be read may use anything
    called_back = {id(function) for _, function in sources.callbacks()}
    for owner in sources.nodes:
        flow = _Flow(sources, owner)
        yield from _never_read(flow)
        yield from _never_equal(flow)
        yield from _never_called(flow)
        yield from _never_started(flow)
        yield from _never_shown(flow)
        for method in owner.methods.values():
            yield from _lost_locals(flow, method)
            yield from _lost_fillings(flow.source, method)
            if id(method) in called_back:
                yield from _begun_anew(flow, method)
                yield from _never_passed(flow, method)


class _Flow:
    """What is stored in the attributes of a class, and what is read of anything, anywhere in the package."""

    def __init__(self, sources: NodeSources, owner: NodeClass) -> None:
        self.sources, self.owner, self.source = sources, owner, owner.source
        self.stores: dict[str, list[tuple[Function, ast.Attribute, ast.expr | None]]] = {}
        for method in owner.methods.values():
            values = _values(method)
            for node in walk(method):
                if is_self_attribute(node) and isinstance(node.ctx, ast.Store):
                    self.stores.setdefault(node.attr, []).append((method, node, values.get(id(node))))
        everything = [node for source in sources.sources.values() for node in source.nodes]
        attributes = [node for node in everything if isinstance(node, ast.Attribute)]
        # What another class reads of itself is not this one's.
        family = [
            node
            for one in sources.classes.values()
            if one is owner or owner in sources.lineage(one)[0] or one in sources.lineage(owner)[0]
            for node in walk(one.definition)
            if is_self_attribute(node)
        ]
        others = [node for node in attributes if not is_self_attribute(node)]
        self.bare = {
            n.id for n in walk(owner.definition) if isinstance(n, ast.Name)
        }  # without self.: told elsewhere
        self.read = {node.attr for node in [*family, *others] if isinstance(node.ctx, ast.Load)}
        asked = [
            n for n in everything if isinstance(n, ast.Call) and getattr(n.func, "id", "").endswith("attr")
        ]
        self.read |= {str(n.value) for call in asked for n in call.args if isinstance(n, ast.Constant)}
        self.added = {ast.unparse(n.target) for n in everything if isinstance(n, ast.AugAssign)}
        self.elsewhere = {
            node.attr
            for node in attributes
            if isinstance(node.ctx, ast.Store) and not is_self_attribute(node)
        }

    def initial(self, name: str) -> ast.Constant | None:
        """Return the constant that `__init__` gives an attribute, if it gives it one."""
        values = [value for method, _, value in self.stores.get(name, ()) if method.name == "__init__"]
        return values[0] if len(values) == 1 and isinstance(values[0], ast.Constant) else None


def _values(function: Function) -> dict[int, ast.expr]:
    """Return what is assigned to each target of a function, by the target's identity."""
    return {
        id(target): node.value
        for node in walk(function)
        if isinstance(node, (ast.Assign, ast.AnnAssign)) and node.value is not None
        for target in (node.targets if isinstance(node, ast.Assign) else [node.target])
    }


def _never_read(flow: _Flow) -> Iterator[Finding]:
    """Yield an attribute that a callback sets and nothing reads, beside one that is read and never changes."""
    for name, stores in flow.stores.items():
        method, node, value = stores[-1]
        if name in flow.read or method.name == "__init__" or isinstance(value, ast.Call):
            continue
        read = [one for one in flow.stores if one in flow.read and one != name]
        near = next((one for one in read if is_near_miss(name, one)), None)
        if near:
            cause = f"{method.name}() sets self.{name}, which nothing reads; what is read is self.{near}."
            yield Finding(
                "never-read", cause, flow.source.at(node), f"write self.{near} in place of self.{name}"
            )
            continue
        for target, other in _filled(method):
            if not is_self_attribute(other):
                continue
            initial = flow.initial(other.attr)
            is_same = len(flow.stores.get(other.attr, ())) == 1 and f"self.{other.attr}" not in flow.added
            if initial is not None and is_same and other.attr not in flow.elsewhere:
                cause = (
                    f"{method.name}() sets self.{name}, which nothing reads; {target} is filled with "
                    f"self.{other.attr}, which always stays {initial.value!r}."
                )
                fix = f"write {target} = self.{name}"
                yield Finding("never-read", cause, flow.source.at(other), fix)
                break


def _filled(method: Function) -> Iterator[tuple[str, ast.expr]]:
    """Yield the fields of messages that a function fills, each with what it is given."""
    for node in own_nodes(method):
        target = node.targets[0] if isinstance(node, ast.Assign) else None
        if isinstance(node, ast.Assign) and isinstance(target, ast.Attribute):
            text = ast.unparse(target)
            if not text.startswith("self."):
                yield text, node.value


def _never_equal(flow: _Flow) -> Iterator[Finding]:
    """Yield a text with which an attribute is compared and which it is never given."""
    for name, stores in flow.stores.items():
        given = {value.value: node for _, node, value in stores if isinstance(value, ast.Constant)}
        are_texts = len(given) > 1 and all(isinstance(text, (str, type(None))) for text in given)
        is_known = all(isinstance(value, ast.Constant) for *_, value in stores) and name not in flow.elsewhere
        if not (are_texts and is_known) or f"self.{name}" in flow.added:
            continue
        compared = {}
        for node in walk(flow.owner.definition):
            if isinstance(node, ast.Compare) and is_self_attribute(node.left) and node.left.attr == name:
                for other in node.comparators:
                    compared.update({one.value: one for one in walk(other) if isinstance(one, ast.Constant)})
        for text, node in compared.items():
            if not isinstance(text, str) or text in given:
                continue
            unused = [one for one in given if isinstance(one, str) and one not in compared]
            near = nearest(text, unused, 0.6)
            known = ", ".join(repr(one) for one in given)
            cause = f"self.{name} is compared with {text!r}, and is only ever set to {known}."
            if near:
                place = flow.source.at(given[near])
                yield Finding("never-equal", cause, place, f"write {text!r} in place of {near!r} here")
            else:
                yield Finding("never-equal", cause, flow.source.at(node), f"compare with one of {known}")


def _never_called(flow: _Flow) -> Iterator[Finding]:
    """Yield a callback that is given to nothing."""
    inherited = members_of("rclpy.node", "Node")[0]
    if any(base and "lifecycle" in base for one in flow.sources.lineage(flow.owner)[0] for base in one.bases):
        return  # its methods are called by their names
    for name, method in flow.owner.methods.items():
        if name in flow.read | flow.bare | inherited or name.startswith("__") or method.decorator_list:
            continue
        names = [one.arg for one in parameters(method)][1:]
        own = _publishers(method)
        others = {one for m in flow.owner.methods.values() if m is not method for one in _publishers(m)}
        made = {creation.method for creation in flow.sources.creations if creation.owner is flow.owner}
        # Beside others that do the same it may well be left over.
        is_alone = {
            0: bool(own - others),
            1: "create_subscription" not in made,
            2: "create_service" not in made,
        }
        is_callback = own or "callback" in name or names in (["msg"], ["request", "response"])
        is_other = len(names) == 2 and not names[0].startswith("req")
        if not is_callback or is_other or not is_alone.get(len(names)):
            continue
        how = {
            0: f"self.timer = self.create_timer(1.0, self.{name})",
            2: f"self.create_service(..., self.{name})",
        }
        begun = how.get(len(names), f"self.create_subscription(String, 'topic', self.{name}, 10)")
        yield Finding(
            "never-called",
            f"{name}() is defined, and nothing calls it: it is given to no timer, subscription or service.",
            flow.source.at(method),
            f"write `{begun}` in __init__",
        )


def _publishers(method: Function) -> set[str]:
    """Return what a method publishes with, as it is written."""
    return {
        ast.unparse(n.value)
        for n in own_nodes(method)
        if isinstance(n, ast.Attribute) and n.attr == "publish"
    }


def _never_started(flow: _Flow) -> Iterator[Finding]:
    """Yield a timer that the constructor ends again, or that is never begun."""
    constructor = flow.owner.methods.get("__init__")
    if constructor is None or "reset" in flow.read:
        return
    made = {
        name
        for name, stores in flow.stores.items()
        for *_, value in stores
        if isinstance(value, ast.Call) and getattr(value.func, "attr", "").startswith("create_")
    }
    for statement in constructor.body:
        call = statement.value if isinstance(statement, ast.Expr) else None
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute)):
            continue
        given = call.args[0] if call.func.attr.startswith("destroy_") and call.args else call.func.value
        is_end = call.func.attr in _ENDS or call.func.attr.startswith("destroy_")
        if is_end and is_self_attribute(given) and given.attr in made:
            yield Finding(
                "never-started",
                f"`{ast.unparse(call)}` in __init__ ends self.{given.attr} before it is ever used.",
                flow.source.at(call),
                f"take the line `{ast.unparse(call)}` away, or move it to where self.{given.attr} is to end",
            )
    for node in walk(constructor):
        if isinstance(node, ast.keyword) and node.arg == "autostart" and ast.unparse(node.value) == "False":
            cause = "autostart=False makes a timer that waits for its reset(), which nothing calls."
            yield Finding("never-started", cause, flow.source.at(node.value), "take autostart=False away")


def _never_shown(flow: _Flow) -> Iterator[Finding]:
    """Yield a log of which all is of a level that is not shown."""
    calls = [
        node
        for node in walk(flow.owner.definition)
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr in LOG_METHODS
        and "logger" in ast.unparse(node.func.value)
    ]
    if (
        calls
        and all(getattr(call.func, "attr", "") == "debug" for call in calls)
        and "set_level" not in flow.read
    ):
        yield Finding(
            "never-shown",
            "What is logged with debug() is not shown: a terminal shows what is logged with info() or above.",
            flow.source.at(calls[0]),
            "write info in place of debug; or start the node with --ros-args --log-level debug",
        )


def _lost_locals(flow: _Flow, method: Function) -> Iterator[Finding]:
    """Yield a local name that is computed and never read."""
    names = [node for node in walk(method) if isinstance(node, ast.Name)]
    read = {node.id for node in names if isinstance(node.ctx, ast.Load)}
    read |= {n for node in walk(method) if isinstance(node, (ast.Global, ast.Nonlocal)) for n in node.names}
    values = _values(method)
    kept = flow.read & {name for one in flow.sources.lineage(flow.owner)[0] for name in one.attributes}
    for node in names:
        value = values.get(id(node))
        if not isinstance(node.ctx, ast.Store) or node.id in read or node.id.startswith("_"):
            continue
        if node.id in kept:
            cause = f"{method.name}() sets {node.id}, which is a local name of its own; self.{node.id} stays as it was."
            fix = f"write self.{node.id} in place of {node.id}"
            yield Finding("not-kept", cause, flow.source.at(node), fix)
            return
        if value is None or method.name == "__init__" or not _is_plain(value):
            continue
        zeros = [(t, v) for t, v in _filled(method) if isinstance(v, ast.Constant) and v.value == 0]
        if len(zeros) == 1:
            target, zero = zeros[0]
            cause = f"{method.name}() computes {node.id} and never uses it; {target} is always {ast.unparse(zero)}."
            yield Finding("never-read", cause, flow.source.at(zero), f"write {target} = {node.id}")
            return


def _is_plain(value: ast.expr) -> bool:
    """Return whether an expression only fetches a value, which is in vain if nobody reads it."""
    if isinstance(value, ast.BinOp):
        return False  # what is computed may be left over; what is only fetched was meant to be used
    calls = [node for node in walk(value) if isinstance(node, ast.Call)]
    names = {getattr(call.func, "id", getattr(call.func, "attr", "")) for call in calls}
    return not isinstance(value, ast.Constant) and names <= {
        "get_parameter",
        "float",
        "int",
        "str",
        "round",
        "abs",
    }


def _lost_fillings(source: PythonSource, method: Function) -> Iterator[Finding]:
    """Yield fields of a message that are filled after it was sent, or before it is made anew."""
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
            fills, reads, binds = _uses(statement, name)
            if binds and pending is not None and not reads:
                cause = f"{name} is made anew here, so what was filled in line {pending.lineno} is lost."
                yield Finding("filling-lost", cause, source.at(statement), "take this line away")
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
                cause = f"`{ast.unparse(pending).splitlines()[0]}` stands behind `{last}`, so what was sent does not hold it."
                yield Finding(
                    "filling-lost",
                    cause,
                    source.at(pending),
                    f"move `{last}` behind the lines that fill {name}",
                )


def _uses(statement: ast.stmt, name: str) -> tuple[bool, bool, bool]:
    """Return whether a statement fills a field of what a name holds, reads it otherwise, and gives it another value."""
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


def _begun_anew(flow: _Flow, method: Function) -> Iterator[Finding]:
    """Yield a count that a callback sets back each time before it adds to it."""
    begun: dict[str, ast.stmt] = {}
    for statement in method.body:
        match statement:
            case ast.Assign(targets=[ast.Attribute(attr=name) as target], value=ast.Constant()) if (
                is_self_attribute(target)
            ):
                begun.setdefault(name, statement)
            case ast.AugAssign(target=ast.Attribute(attr=name) as target) if (
                is_self_attribute(target) and name in begun
            ):
                users = {one.name for one in flow.owner.methods.values() if _reads(one, name)} - {method.name}
                if not users - {"__init__"}:
                    yield Finding(
                        "begun-anew",
                        f"{method.name}() sets self.{name} back with `{ast.unparse(begun[name])}` each time, so it never grows.",
                        flow.source.at(begun[name]),
                        f"take the line `{ast.unparse(begun[name])}` away here; it belongs into __init__",
                    )


def _reads(method: Function, name: str) -> bool:
    return any(is_self_attribute(n) and n.attr == name and isinstance(n.ctx, ast.Load) for n in walk(method))


def _never_passed(flow: _Flow, method: Function) -> Iterator[Finding]:
    """Yield a condition with return that holds from the beginning and is changed only behind it."""
    for number, statement in enumerate(method.body):
        if not (isinstance(statement, ast.If) and isinstance(statement.body[-1], ast.Return)):
            continue
        names = {node.attr for node in walk(statement.test) if is_self_attribute(node)}
        if len(names) != 1 or statement.orelse:
            continue
        (name,) = names
        initial = flow.initial(name)
        behind = {id(node) for later in method.body[number + 1 :] for node in walk(later)}
        others = [node for where, node, _ in flow.stores.get(name, ()) if where.name != "__init__"]
        is_shut_in = all(id(node) in behind for node in others) and name not in flow.elsewhere
        if initial is not None and is_shut_in and others and _holds(statement.test, initial.value):
            yield Finding(
                "never-passed",
                f"`if {ast.unparse(statement.test)}:` holds from the beginning, and self.{name} is changed only behind "
                f"its return: nothing behind it is ever reached.",
                flow.source.at(statement),
                f"change self.{name} before this line, or ask for something else",
            )


def _holds(test: ast.expr, value: Any) -> bool:
    """Return whether a condition about one attribute holds for a value of it; False if that cannot be told."""
    match test:
        case ast.UnaryOp(op=ast.Not(), operand=inner) if is_self_attribute(inner):
            return not value
        case ast.Attribute():
            return bool(value)
        case ast.Compare(left=left, ops=[sign], comparators=[ast.Constant(value=other)]) if is_self_attribute(
            left
        ):
            compares = _COMPARES.get(type(sign))
            try:
                return compares is not None and compares(value, other)
            except TypeError:
                return False
    return False
