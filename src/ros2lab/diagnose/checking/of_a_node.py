"""What rclpy itself lacks because a node has it, such as timers, which a node makes with create_timer."""

from __future__ import annotations

import ast
from collections.abc import Mapping

from ros2lab.diagnose.checking.checked_copies import first_that_stands
from ros2lab.diagnose.code.at_hand import holders
from ros2lab.diagnose.code.unknown_names import Unknown
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.node_source import CREATORS, is_self_attribute
from ros2lab.diagnose.sources.python_source import PythonSource, walk
from ros2lab.diagnose.sources.signatures import signature_by_name
from ros2lab.diagnose.sources.spelling import has_other_words, nearest, snake_case
from ros2lab.diagnose.sources.syntax_parts import calls_in

_MAKERS: Mapping[str, tuple[str, ...]] = {**CREATORS, "create_rate": ("frequency",)}
_SUFFIXES = {"msg_type": ".msg.", "srv_type": ".srv."}
_QUEUE = "10"  # the length that a queue has where none is given
# The objects that a node gives, with their classes.
_GIVEN = {
    "get_clock()": ("rclpy.clock", "Clock"),
    "get_logger()": ("rclpy.impl.rcutils_logger", "RcutilsLogger"),
}
_LEAST_ALIKE = 0.6
_OF_NODES = (*CREATORS, "get_logger", "get_clock", "declare_parameter")  # methods that only a node has


def of_a_node(name: str, spot: Spot) -> tuple[str, str] | None:
    """Return the cause and the fix for a name that rclpy lacks, but a node offers; None if none does."""
    source = spot.source
    for used in spot.nodes:
        match used:
            case ast.Call(func=ast.Attribute(attr=method, value=ast.Attribute(attr=attr))) if attr == name:
                call, last = used, method  # rclpy.Time.now()
            case ast.Call(func=ast.Attribute(attr=attr)) if attr == name:
                call, last = used, name
            case _:
                continue
        if source is None or source.resolve(call.func) not in (f"rclpy.{name}", f"rclpy.{name}.{last}"):
            continue
        if name in _ASKED_OTHERWISE:
            return _otherwise(source, name, call)
        if written := _made(name, _NODE, call, source) or _asked(name, last, _NODE, call):
            return _of_a_node_at_hand(name, spot, call, written)
        homes = [home for home in interfaces.inner_homes_of(name) if home.startswith("rclpy.")]
        signature = signature_by_name(f"{homes[0]}.{name}") if homes else None
        if homes and last == name and (signature is None or signature.accepts(call)):
            made = f"{name}{ast.unparse(call).removeprefix(ast.unparse(call.func))}"
            cause = f"rclpy itself has no {name}: it is in {homes[0]}."
            return cause, f"write `{made}`, with `from {homes[0]} import {name}` at the top"
    return None


def _made(name: str, node: str, call: ast.Call, source: PythonSource) -> str:
    """Return the call with which the node makes an object of a class; empty if the arguments fit none."""
    kind = snake_case(name)
    found = {
        maker: given
        for maker in _MAKERS
        if name[:1].isupper() and (given := _sorted_into(maker, call, source))
    }
    only = [*found] if len(found) == 1 and len(call.args) + len(call.keywords) > 1 else []
    alike = nearest(kind, [maker.removeprefix("create_") for maker in found], _LEAST_ALIKE)
    likely = [f"create_{kind}", *([f"create_{alike}"] if alike else []), *only]
    maker = next((candidate for candidate in likely if candidate in found), "")
    return f"{node}.{maker}({', '.join(found[maker])})" if maker else ""


def _sorted_into(maker: str, call: ast.Call, source: PythonSource) -> list[str]:
    """Return the arguments of a call in the order of a node's method; empty if they do not fit."""
    left = [*call.args, *(keyword.value for keyword in call.keywords if keyword.arg != "latch")]
    found = []
    for parameter in _MAKERS[maker]:
        fitting = next((given for given in left if _fits(given, parameter, source)), None)
        if fitting is not None:
            left.remove(fitting)
            found.append(_as_number(fitting))
        elif parameter == "qos_profile":
            found.append(_QUEUE)
        else:
            return []
    return [] if left else found


def _fits(given: ast.expr, parameter: str, source: PythonSource) -> bool:
    """Return whether an argument may be meant for a parameter of one of a node's methods."""
    name = source.resolve(given) or ""
    is_name = isinstance(given, ast.Constant) and isinstance(given.value, str)
    is_number = isinstance(given, ast.Constant) and isinstance(given.value, (int, float))
    match parameter:
        case "msg_type" | "srv_type":
            return _SUFFIXES[parameter] in name
        case "topic" | "srv_name":
            return is_name
        case "callback":
            is_named = isinstance(given, (ast.Name, ast.Attribute)) and not interfaces.is_interface(name)
            return is_named or isinstance(given, ast.Lambda)
        case "qos_profile":
            return is_number or "QoSProfile" in ast.unparse(given)
    return is_number or isinstance(given, (ast.Call, ast.BinOp, ast.Name, ast.Attribute))


def _as_number(given: ast.expr) -> str:
    """Return an argument as it is written, of a duration only its seconds."""
    match given:
        case ast.Call(
            func=ast.Name(id="Duration") | ast.Attribute(attr="Duration"), keywords=[keyword], args=[]
        ):
            return ast.unparse(keyword.value) if keyword.arg == "seconds" else ast.unparse(given)
        case ast.Call(
            func=ast.Name(id="Duration") | ast.Attribute(attr="Duration"), args=[seconds], keywords=[]
        ):
            return ast.unparse(seconds)
    return ast.unparse(given)


def _asked(name: str, last: str, node: str, call: ast.Call) -> str:
    """Return the call of a method of the node, its clock or its logger that a name means; else empty."""
    rest = ast.unparse(call).removeprefix(ast.unparse(call.func))
    for getter, home in _GIVEN.items():
        what = getter.removeprefix("get_").removesuffix("()")
        for member in sorted(interfaces.members_of(*home)):
            is_of_class = last != name and member == last  # Time.now of a clock
            is_of_class |= name == last == member  # rclpy.info()
            is_of_prefix = last == name and len(member) > 3 and name.endswith(member)
            prefix = name.removesuffix(member).rstrip("_")
            if is_of_class or (is_of_prefix and prefix and what.startswith(prefix)):
                return f"{node}.{getter}.{member}{rest}"
    methods = interfaces.node_members()
    known = [method for method in methods if method.startswith("get_") and not name[:1].isupper()]
    known = [method for method in known if not has_other_words(name, method)]
    method = nearest(name, known, 0.75) if last == name and name not in known else None
    value = ".value" if method == "get_parameter" else ""
    method = "declare_parameter" if value and len(call.args) > 1 else method  # with its default
    return f"{node}.{method}{rest}{value}" if method else ""


def _of_a_node_at_hand(name: str, spot: Spot, call: ast.Call, written: str) -> tuple[str, str]:
    """Return the cause and the fix with the first node that the type checker knows at a line; `written` asks any."""
    source, old = spot.source, ast.unparse(call)
    assert source is not None
    asked = {f"{node}.get_name()": node for node in _nodes(spot, call)}
    node = asked.get(first_that_stands(source, call, [*asked]))
    if node:
        cause = f"rclpy has no {name} in ROS 2; the node has it."
        return cause, f"write `{node}{written.removeprefix(_NODE)}` instead of `{old}`"
    owner = source.class_at(call.lineno)
    place = owner.name if owner else getattr(source.function_at(call.lineno), "name", "this file")
    cause = f"rclpy has no {name} in ROS 2; a node has it, and none is at hand here."
    return cause, f"hand a node to {place}, and write `{written}` on it instead of `{old}`"


def _otherwise(source: PythonSource, name: str, call: ast.Call) -> tuple[str, str]:
    """Return the cause and the fix for a question of ROS 1 that rclpy is asked the other way round."""
    right, around = _ASKED_OTHERWISE[name], source.above(call)
    whole = around if isinstance(around, ast.UnaryOp) and isinstance(around.op, ast.Not) else call
    written = right if whole is call else right.removeprefix("not ")
    cause = f"rclpy has no {name} in ROS 2; {right.removeprefix('not ')} tells the opposite."
    return cause, f"write `{written}` instead of `{ast.unparse(whole)}`"


_NODE = "node"  # stands for a node that is not at hand
_ASKED_OTHERWISE = {"is_shutdown": "not rclpy.ok()"}


def _nodes(spot: Spot, call: ast.Call) -> list[str]:
    """Return how a line may name a node: self, a variable that holds one, or what a node's methods are called on."""
    function, source = spot.function, spot.source
    assert source is not None
    is_method = function is not None and [argument.arg for argument in function.args.args[:1]] == ["self"]
    held = holders(Unknown(source, "", call), set(), is_node=True)
    asked = [c.func for c in calls_in(walk(source.class_at(call.lineno) or function or source.tree))]
    made = [f.value for f in asked if isinstance(f, ast.Attribute) and f.attr in _OF_NODES]
    texts = [ast.unparse(value) for value in made if is_self_attribute(value)]
    return [*dict.fromkeys([*["self"] * is_method, *held, *texts, _NODE])]
