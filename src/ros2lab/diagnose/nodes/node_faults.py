"""Faults in node classes and in what they create, such as publishers and timers."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator

from ros2lab.diagnose.code.bound_names import unbound_names
from ros2lab.diagnose.code.called_back import CALLED_WITH, accepted, executed, named_in_body
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.argument_order import EXAMPLES, order_fault
from ros2lab.diagnose.nodes.qos_written import misplaced_policies
from ros2lab.diagnose.nodes.super_order import SuperOrder, constructor_left_out
from ros2lab.diagnose.nodes.taken_names import hidden_method, hiding_methods, taken_attributes
from ros2lab.diagnose.nodes.unset_attributes import no_such_member
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.answered import plain_returns, response_fields, unanswered
from ros2lab.diagnose.sources.calls import meant_call
from ros2lab.diagnose.sources.construction import given_to_super, lost_constructor, super_call
from ros2lab.diagnose.sources.interfaces import fixed_node_properties, members_of, node_members
from ros2lab.diagnose.sources.node_source import (
    CREATORS,
    NODE_CLASSES,
    Creation,
    NodeClass,
    NodeSources,
    is_self_attribute,
)
from ros2lab.diagnose.sources.one_run import may_be_caught
from ros2lab.diagnose.sources.own_functions import as_function, gives_no_function, is_wrapped
from ros2lab.diagnose.sources.python_source import (
    YIELDS,
    Function,
    PythonSource,
    last_name,
    names_bound,
    names_read,
    own_nodes,
    parameters,
    walk,
)
from ros2lab.diagnose.sources.spelling import nearest
from ros2lab.diagnose.sources.syntax_parts import calls_in, removal

_NODE_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
TOPIC_NAME = re.compile(r"(~(?=/|$))?/?([A-Za-z_{][\w{}]*)(/[A-Za-z_{][\w{}]*)*|~", re.ASCII)
# What asks for, or sets, the attributes of an object by their names as strings.
_BY_TEXT = frozenset(("getattr", "setattr", "hasattr", "delattr", "vars", "attrgetter", "methodcaller"))
_BUILTIN_TYPES = frozenset(("str", "int", "float", "bool", "dict", "list", "tuple", "bytes"))


def node_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield faults in node classes and in what they create."""
    for owner in sources.nodes:
        yield from _constructor_faults(sources, owner)
        yield from _member_faults(sources, owner)
    for name, (source, node) in sources.node_names.items():
        if name and not _NODE_NAME.fullmatch(name):
            cause = f"{name!r} is not a valid node name: it may contain only letters, digits and _, and must not begin with a digit."
            fix = f"write {re.sub(r'[^A-Za-z0-9_]', '_', name).lstrip('0123456789') or 'a_name'!r}"
            yield Finding("node-name-invalid", cause, source.at(node), fix)
    for creation in sources.creations:
        if creation.arguments is not None:
            yield from _creation_faults(sources, creation)
    yield from _action_faults(sources)
    yield from misplaced_policies(sources)


def _constructor_faults(sources: NodeSources, owner: NodeClass) -> Iterator[Finding]:
    constructor = owner.methods.get("__init__")
    lost = None if constructor else lost_constructor(sources, owner)
    if lost is not None and any(base in NODE_CLASSES for base in owner.bases):
        cause = f"The method {lost.name} is not the constructor, which is __init__, with two underscores on each side of init."
        fix = f"write def __init__({ast.unparse(lost.args)}):"
        yield Finding("super-misspelt", cause, owner.source.at(lost), fix)
    function = constructor or lost
    calls = calls_in(walk(function)) if function else []
    for call in calls:
        if function is not None and _is_misspelt_super(owner.source, call.func):
            cause = f"`{ast.unparse(call.func)}` does not call the constructor of Node."
            fix = f"write {super_call(sources, owner, given_to_super(function))}"
            yield Finding("super-misspelt", cause, owner.source.at(call), fix)
            return
        if getattr(call.func, "attr", "") == "__init__":
            yield from _init_call_faults(sources, owner, call)
    if constructor is None:
        return
    order = SuperOrder(sources, owner, node_members())
    if not order.calls_init():
        cause = f"The constructor of {owner.definition.name} never calls super().__init__(), so there is no node when it is used."
        fix = f"write {super_call(sources, owner)} as the first line of __init__"
        yield Finding("super-missing", cause, owner.source.at(constructor), fix)
    elif fault := constructor_left_out(sources, owner):
        yield fault
    elif early := order.first_early():
        use, fix = early
        cause = f"`{ast.unparse(use)}` is used before super().__init__() is called."
        yield Finding("super-late", cause, owner.source.at(use), fix)


def _is_misspelt_super(source: PythonSource, called: ast.expr) -> bool:
    """Return whether what is called was meant as `super().__init__` or `Node.__init__`."""
    match called:
        case ast.Attribute(value=ast.Name(id="super")):
            return True
        case ast.Attribute(value=base, attr=name) if name != "__init__" and re.search(r"ini?t", name):
            of_super = isinstance(base, ast.Call) and getattr(base.func, "id", "") == "super"
            return of_super or source.resolve(base) in NODE_CLASSES
    return False


def _init_call_faults(sources: NodeSources, owner: NodeClass, call: ast.Call) -> Iterator[Finding]:
    """Yield calls of a base class's `__init__` without self or without the node's name."""
    match call:
        case ast.Call(func=ast.Attribute(value=ast.Call(func=ast.Name(id="super")))):
            if not call.args and not call.keywords and {*owner.bases} <= NODE_CLASSES:
                cause = "super().__init__() is called without the node's name."
                fix = f"write {super_call(sources, owner)}"
                yield Finding("argument-missing", cause, owner.source.at(call), fix)
        case ast.Call(args=[ast.Name(id="self"), *_]):
            pass
        case ast.Call(func=ast.Attribute(value=base)) if owner.source.resolve(base):
            cause = f"`{ast.unparse(call.func)}` is called on the class, so self must be the first argument."
            fix = f"write super().__init__({', '.join(map(ast.unparse, call.args))})"
            yield Finding("argument-missing", cause, owner.source.at(call), fix)


def _values_of(owner: NodeClass) -> frozenset[str]:
    """Return the names to which the body of a class gives values; one that is only annotated has none."""
    given = (node for node in owner.definition.body if getattr(node, "value", None))
    return frozenset(names_bound(inner for node in given for inner in walk(node)))


def _member_faults(sources: NodeSources, owner: NodeClass) -> Iterator[Finding]:
    properties = fixed_node_properties()
    members = sources.members(owner)
    lineage = sources.lineage(owner)[0]
    # A value of the class hides the property of Node, so it may be assigned like any other.
    own = {name for inner in lineage for name in (*inner.methods, *(_values_of(inner) & properties))}
    called = {id(node.func) for node in calls_in(walk(owner.definition))}
    told: set[str] = set()
    # A name that is also a string need not exist where attributes are asked for by strings.
    asks = any(isinstance(n, ast.Name) and n.id in _BY_TEXT for n in walk(owner.definition))
    texts = [n.value for n in walk(owner.definition) if isinstance(n, ast.Constant)]
    asked = set(map(str, texts)) if asks else set()
    taken = taken_attributes(owner)
    hiding = dict(hiding_methods(owner, properties))
    told |= set(hiding)
    yield from hiding.values()
    for node in walk(owner.definition):
        if not isinstance(node, ast.Attribute) or not is_self_attribute(node) or node.attr in told:
            continue
        found: Finding | None = None
        if not owner.source.gives(node) and members is not None and node.attr not in members | asked:
            what = "method" if id(node) in called else "attribute"
            found = no_such_member(owner, node, what, members)
        elif isinstance(node.ctx, ast.Store):
            found = _assigned(owner, node, properties)
            if node.attr in taken.keys() - own:
                cause, fix = taken[node.attr]
                found = found or Finding("node-property", cause, owner.source.at(node), fix)
        if found:
            told.add(node.attr)
            yield found


def _assigned(owner: NodeClass, node: ast.Attribute, properties: Collection[str]) -> Finding | None:
    """Return the finding about an attribute that hides a method of the class; None if it hides none."""
    hidden = owner.methods.get(node.attr)
    is_hidden = hidden is not None and not hidden.decorator_list and node.attr not in properties
    return hidden_method(owner, node) if is_hidden else None


def _creation_faults(sources: NodeSources, creation: Creation) -> Iterator[Finding]:
    arguments, source = creation.arguments or {}, creation.source
    place = source.at(creation.call)
    fix = meant_call(source, creation.call) or f"write {EXAMPLES[creation.method]}"
    called = getattr(creation.call.func, "attr", creation.method)
    if "queue_size" in arguments:
        cause = "queue_size belongs to ROS 1; in ROS 2 the queue depth is the last argument."
        yield Finding("queue-size", cause, place, fix)
        return
    if fault := order_fault(sources, creation):
        yield fault
        return
    names = CREATORS[creation.method]
    missing = [name for name in names if name not in arguments]
    if missing:
        code = "qos-missing" if missing == ["qos_profile"] else "argument-missing"
        what = "the queue depth" if code == "qos-missing" else " and ".join(missing)
        if code == "qos-missing" and not meant_call(source, creation.call):
            fix = f"write `{ast.unparse(creation.call)[:-1]}, 10)`"
        yield Finding(code, f"{called} is missing {what}.", place, fix)
        return
    yield from _type_fault(sources, creation)
    yield from _topic_fault(sources, creation)
    if "callback" in arguments:
        yield from _callback_fault(sources, creation, arguments["callback"])


def _type_fault(sources: NodeSources, creation: Creation) -> Iterator[Finding]:
    value = creation.given("msg_type")
    if value is None:
        return
    name = sources.resolve(creation.source, value)
    is_text = isinstance(sources.value(creation.source, value), str)
    is_instance = isinstance(value, ast.Call) and interfaces.is_interface(
        sources.resolve(creation.source, value.func)
    )
    is_module = bool(name and re.fullmatch(r"\w+\.msg", name))
    if name in _BUILTIN_TYPES or is_text or is_instance or is_module:
        text = ast.unparse(value)
        better = text.removesuffix("()") if is_instance else "String"
        more = ", with `from std_msgs.msg import String` at the top" if better == "String" else ""
        cause = f"{creation.method} needs a message type such as String, and {text} is not one."
        yield Finding("type-not-a-message", cause, creation.source.at(value), f"write {better}{more}")


def _topic_fault(sources: NodeSources, creation: Creation) -> Iterator[Finding]:
    value = creation.given("topic", "srv_name")
    name = sources.value(creation.source, value)
    if isinstance(name, str) and not TOPIC_NAME.fullmatch(name):
        better = re.sub(r"[_/]*/[_/]*", "/", re.sub(r"[^A-Za-z0-9_~{}/]+", "_", name.strip())).rstrip("/_")
        better = re.sub(r"(^|/)(?=\d)", r"\1topic_", re.sub(r"(?<=[\w}])/(?=\d)", "_", better)) or "topic"
        cause = f"{name!r} is not a valid topic name: between slashes it may contain only letters, digits and _, and no part may begin with a digit."
        yield Finding("topic-name-invalid", cause, creation.source.at(value), f"write {better!r}")


def _callback_fault(sources: NodeSources, creation: Creation, given: ast.expr) -> Iterator[Finding]:
    place = creation.source.at(given)
    if isinstance(given, ast.Constant):
        cause = f"{ast.unparse(given)} is not a function that ROS could call."
        yield Finding("callback-missing", cause, place, "pass a method, such as self.callback")
        return
    if isinstance(given, ast.Call):
        inner = sources.function_of(creation, given.func)
        if inner is not None and gives_no_function(inner, given):
            clause, written = as_function(inner, given, CALLED_WITH.get(creation.method, ()))
            cause = f"`{ast.unparse(given)}` calls the function right here, {clause}, but ROS needs the function itself, to call it later."
            fix = f"write `{written}` instead of `{ast.unparse(given)}`"
            yield Finding("callback-called", cause, place, fix)
        return
    if isinstance(given, ast.Lambda):
        yield from _lambda_fault(creation, given)
        return
    function = sources.function_of(creation, given)
    if function is not None:
        yield from _parameter_fault(sources, creation, given, function)
        yield from _yield_fault(creation, function)
    if function is None or creation.method != "create_service" or len(parameters(function)) < 2:
        return
    what, answer = "a service callback", parameters(function)[-1].arg
    yield from _unanswered(creation.source, function, what, answer, "so the node crashes at a request")


def _unanswered(
    source: PythonSource, function: Function, what: str, answer: str, effect: str
) -> Iterator[Finding]:
    """Yield a callback that gives ROS no answer, or a plain value instead of one."""
    if fix := unanswered(function, answer, response_fields(source, function)):
        said = next(
            (f"{ast.unparse(n)[7:] or 'nothing'} on line {n.lineno}" for n in plain_returns(function)),
            "nothing",
        )
        cause = f"{function.name}() is {what} but returns {said}, {effect}."
        yield Finding("callback-arguments", cause, source.at(function), fix)


def _yield_fault(creation: Creation, function: Function) -> Iterator[Finding]:
    """Yield callbacks that a yield turns into generators, so that none of their code ever runs."""
    for node in own_nodes(function):
        if isinstance(node, YIELDS) and not is_wrapped(function):
            cause = f"The yield makes {function.name}() a generator: ROS calls it, but none of its code ever runs."
            fix = f"remove the yield: publish or return the value, or call the function, in {function.name}()"
            never = (creation.source.at(function),)
            yield Finding("never-called", cause, creation.source.at(node), fix, never=never)
            return


def _lambda_fault(creation: Creation, given: ast.Lambda) -> Iterator[Finding]:
    """Yield lambdas that take a different number of arguments from what they are called with."""
    if _fits(creation, accepted(given)):
        return
    wanted = CALLED_WITH[creation.method]
    what = f"with {' and '.join(wanted)}" if wanted else "without arguments"
    right = f"lambda {', '.join(wanted)}".strip()
    cause = f"The callback of {creation.method} is called {what}, but `{ast.unparse(given)}` takes {len(given.args.args) or 'none'}."
    yield Finding(
        "callback-arguments", cause, creation.source.at(given), f"write {right}: {ast.unparse(given.body)}"
    )


def _parameter_fault(
    sources: NodeSources, creation: Creation, given: ast.expr, function: Function
) -> Iterator[Finding]:
    names = [parameter.arg for parameter in parameters(function)]
    is_static = any(getattr(decorator, "id", "") == "staticmethod" for decorator in function.decorator_list)
    args = creation.call.args
    after = args[args.index(given) + 1 :] if given in args else []
    is_meant_for_it = any(isinstance(getattr(value, "value", None), str) for value in after)
    if is_meant_for_it or (is_wrapped(function) and not is_static):
        return
    is_method = isinstance(given, ast.Attribute) and not is_static
    if is_method and (not names or "self" in unbound_names(creation.source, function)):
        return  # told of every method that lacks self
    accepts = accepted(function, is_method=is_method)
    if _fits(creation, accepts) or "TimerInfo" in ast.dump(function.args):
        return
    wanted = CALLED_WITH[creation.method]
    rest = ", ".join(wanted)
    right = ", ".join(
        [*["self"] * is_method, *named_in_body(creation.source, function, wanted, is_method=is_method)]
    )
    called_with = "the message" if rest == "msg" else rest or "nothing"
    cause = f"{function.name} takes ({', '.join(names) or 'nothing'}), but the callback of {creation.method} is called with {called_with}."
    place, fix = (
        f"{creation.source.shown}:{function.lineno}",
        f"write {_def(function)} {function.name}({right}):",
    )
    used = names_read(own_nodes(function)) - names_bound(own_nodes(function)) - {*right.split(", ")}
    if lost := [name for name in names if name in used]:
        fix += f" and give {' and '.join(lost)} a value in its body, which uses it"
    if use := _right_use(sources, creation, function, accepts):
        place = creation.source.at(creation.call)
        fix = f"{removal(creation.source, creation.call, 'this line')}, or give it a method of its own: {function.name} is right for the {use}"
    yield Finding("callback-arguments", cause, place, fix)


def _right_use(sources: NodeSources, creation: Creation, function: Function, accepts: range) -> str:
    """Return what else calls a callback with as many arguments as it accepts, in words; empty if nothing does."""
    for other, called in sources.callbacks():
        if called is function and other.method in CALLED_WITH and _fits(other, accepts):
            return f"{other.method} on line {other.call.lineno}"
    kind = type(creation.given("callback"))
    calls = (call for call in creation.source.calls if last_name(call.func) == function.name)
    fitting = (c for c in calls if isinstance(c.func, kind) and len(c.args) + len(c.keywords) in accepts)
    return next((f"call on line {call.lineno}" for call in fitting), "")


def _fits(creation: Creation, accepts: range) -> bool:
    """Return whether a callback that accepts so many arguments can be called by what is made, if that is known."""
    given = len(CALLED_WITH.get(creation.method, ()))
    is_known = creation.method in CALLED_WITH
    return not is_known or given in accepts or (creation.method == "create_subscription" and 2 in accepts)


def _action_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield callbacks of an action server that do not take the goal's handle, misuse it, or return no result."""
    for called in executed(sources):
        function = called.function
        if len(called.lacks) == 1:
            names = [parameter.arg for parameter in parameters(function)]
            cause = f"{function.name} takes ({', '.join(names) or 'nothing'}), but ActionServer calls it with {called.lacks[0]}."
            fix = f"write {_def(function)} {function.name}({', '.join([*names, *called.lacks])}):"
            yield Finding("callback-arguments", cause, called.source.at(function), fix)
        elif not function.decorator_list and len(parameters(function)) == 1 + called.is_bound:
            yield from _handle_faults(called.source, function, parameters(function)[-1].arg)
            if called.action and called.action.partition(".")[0] in called.source.names:
                what, answer = "the execute callback of an action", f"{called.action}.Result()"
                yield from _unanswered(called.source, function, what, answer, "so the client gets no result")


def _handle_faults(source: PythonSource, function: Function, handle: str) -> Iterator[Finding]:
    """Yield the methods that an execute callback asks of a goal's handle and that it does not have."""
    members = members_of("rclpy.action.server", "ServerGoalHandle")
    asked = [n for n in own_nodes(function) if isinstance(n, ast.Attribute)]
    asked = [n for n in asked if getattr(n.value, "id", "") == handle and n.attr not in members]
    is_open = handle in names_bound(own_nodes(function)) or not members
    set_on = {n.attr for n in source.nodes if isinstance(n, ast.Attribute) and isinstance(n.ctx, ast.Store)}
    for node in asked if not is_open else ():
        if node.attr in set_on | {*dir(object)} or may_be_caught(source, node.lineno, AttributeError):
            continue
        public = sorted(name for name in members if not name.startswith("_"))
        near = nearest(node.attr, public)
        fix = (
            f"write {handle}.{near}"
            if near
            else "write one of its methods: succeed(), abort() and canceled() end a goal"
        )
        cause = f"{handle}, the handle of a goal, has no {node.attr}."
        yield Finding("attribute-missing", cause, source.at(node), fix)


def _def(function: Function) -> str:
    return "async def" if isinstance(function, ast.AsyncFunctionDef) else "def"
