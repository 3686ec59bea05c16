"""Queues that are too short for what one callback publishes at once."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.topic_faults import ends_of
from ros2lab.diagnose.sources.interfaces import is_interface
from ros2lab.diagnose.sources.known_values import definition
from ros2lab.diagnose.sources.node_source import Creation, NodeSources
from ros2lab.diagnose.sources.python_source import Function, last_name, own_nodes, walk
from ros2lab.diagnose.sources.qualities import policies_of
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import calls_in
from ros2lab.diagnose.sources.uses import is_log

# Methods of publishers, nodes and clocks, and of Python's texts and lists, and its functions, that take no time.
_FAST = {"publish", "get_logger", "get_clock", "now", "to_msg", *dir(str), *dir(list), *dir(builtins)} - {
    "input",
    "open",
}


def burst_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield subscriptions whose queue is shorter than what a callback of the package publishes at once."""
    ends = ends_of(sources)
    for end in ends:
        bursts = _bursts(sources, end.creation) if end.is_publisher and end.name else []
        for other in ends if bursts else ():
            depth = _depth(sources, other.creation)
            count, function = max(bursts, key=lambda burst: burst[0])
            is_reader = other.name == end.name and not other.is_publisher
            if is_reader and depth is not None and 0 < depth < count and _reads_all(sources, other.creation):
                where = _depth_node(other.creation)
                cause = f"{function.name}() publishes {count} messages on {end.name} at once, but this queue holds only {depth}: each new message pushes out an unread one."
                fix = f"give both ends of {end.name} a depth of {max(10, count)}, such as {max(10, count)} instead of {ast.unparse(where)}"
                yield Finding("queue-short", cause, other.creation.source.at(where), fix)


def _bursts(sources: NodeSources, creation: Creation) -> list[tuple[int, Function]]:
    """Return the functions that publish several messages in one call, each with how many it is."""
    kept = creation.kept
    found = []
    for function in creation.owner.functions if creation.owner and kept.startswith("self.") else ():
        if function.name == "__init__":
            continue  # nobody has subscribed yet
        nodes = own_nodes(function)
        is_fast = all(_is_fast(creation, node) for node in calls_in(nodes))
        calls = [node for node in calls_in(nodes) if dotted(node.func) == f"{kept}.publish" and is_fast]
        count = sum(_times(sources, creation, function, call) for call in calls)
        if count > 1:
            found.append((count, function))
    return found


def _is_fast(creation: Creation, call: ast.Call) -> bool:
    """Return whether a call is known to take no time: it makes, fills, logs or publishes a message."""
    is_made = is_interface(creation.source.resolve(call.func))
    return is_made or is_log(call) or last_name(call.func) in _FAST


def _times(sources: NodeSources, creation: Creation, function: Function, call: ast.Call) -> int:
    """Return how often a call runs per call of its function; 0 if a condition decides or it is unknown."""
    count = 1
    for node in own_nodes(function):
        if call not in walk(node) or isinstance(node, Function):
            continue
        if isinstance(node, (ast.If, ast.While, ast.Try, ast.IfExp, ast.Match, ast.BoolOp, ast.Lambda)):
            return 0
        if isinstance(node, (ast.For, ast.AsyncFor)):
            turns = _turns(sources, creation, node)
            leaves = any(isinstance(inner, (ast.Break, ast.Return, ast.Continue)) for inner in walk(node))
            count *= 0 if leaves else turns
    return count


def _turns(sources: NodeSources, creation: Creation, loop: ast.For | ast.AsyncFor) -> int:
    match creation.source.written(loop.iter):
        case ast.Call(func=ast.Name(id="range"), args=[end]):
            value = sources.value(creation.source, creation.source.written(end))
            return value if isinstance(value, int) else 0
        case ast.List(elts=elements) | ast.Tuple(elts=elements):
            return len(elements)
    return 0


def _depth_node(creation: Creation) -> ast.expr:
    """Return the expression for the queue depth, or the closest one around it."""
    given = creation.given("qos_profile") or creation.call
    return _depth_in(given) or given


def _depth_in(profile: ast.expr) -> ast.expr | None:
    """Return the depth that a profile is made with, or the depth itself; None if it is made with none."""
    if not isinstance(profile, ast.Call):
        return profile
    return next((keyword.value for keyword in profile.keywords if keyword.arg == "depth"), None)


def _depth(sources: NodeSources, creation: Creation) -> int | None:
    """Return the queue depth of a publisher or subscription; None if it is not known."""
    given = creation.given("qos_profile")
    found = definition(sources, creation, given)
    if found is None or policies_of(sources, creation).get("history") != "KEEP_LAST":
        return None
    source, written = found
    value = sources.value(source, _depth_in(written))
    return value if isinstance(value, int) and not isinstance(value, bool) else None


def _reads_all(sources: NodeSources, creation: Creation) -> bool:
    """Return whether a callback counts, collects or shows its messages, so that none may be lost."""
    function = sources.function_of(creation, creation.given("callback"))
    for node in walk(function) if function else ():
        match node:
            case ast.AugAssign():
                return True
            case ast.Call(func=ast.Attribute(attr="append" | "info" | "publish" | "write")):
                return True
    return False
