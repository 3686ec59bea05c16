"""Names that hide another one, and attributes that Python does not find although a class sets them: private, or not yet set."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from ros2lab.diagnose.code.private_names import of_another
from ros2lab.diagnose.finding import Finding, in_a_row, these_lines
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText, own_frames
from ros2lab.diagnose.printed.spots import Spot, spot_of
from ros2lab.diagnose.sources.interfaces import node_members
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.one_run import own_calls
from ros2lab.diagnose.sources.python_source import Function, own_nodes, walk
from ros2lab.diagnose.sources.syntax_parts import calls_in, stores_in


def as_written(name: str, spot: Spot) -> str:
    """Return an attribute as the class around a line writes it: `__x` for the `_Robot__x` of a message."""
    around = spot.file.class_at(spot.line)
    private = name.removeprefix(f"_{around.name.lstrip('_')}") if around else name
    return private if private.startswith("__") else name


def not_set(name: str, asked: str, spot: Spot, look: Look) -> Finding | None:
    """Explain an attribute that the line asks for and that is set, but not for this object, or not yet; else None.

    Args:
        name: the attribute, as it is written.
        asked: the class of the object that lacks it.
        spot: the line.
        look: the workspace.
    """
    around = spot.file.class_at(spot.line)
    uses = [node for node in spot.nodes if isinstance(node, ast.Attribute) and node.attr == name]
    sources = look.sources_with(spot.file)
    owner = next((known for known in sources.classes.values() if known.definition is around), None)
    if owner is None or not uses:
        return None
    if name.startswith("__") and (told := of_another(sources, owner, asked, uses[0])):
        return told
    named = [known for known in sources.classes.values() if known.definition.name == asked]
    is_own = any(owner in sources.lineage(known)[0] for known in named)
    is_asked = is_own and any(map(is_self_attribute, uses))
    return _too_early(sources, owner, name, spot) if is_asked else None


def _too_early(sources: NodeSources, owner: NodeClass, name: str, spot: Spot) -> Finding | None:
    """Explain an attribute of self that other lines of its class set; None if none does, or if it is deleted."""
    around = owner.definition
    same = [node for node in walk(around) if is_self_attribute(node) and node.attr == name]
    stored = [node for node in same if isinstance(node.ctx, ast.Store)]
    if not stored or any(isinstance(node.ctx, ast.Del) for node in same):
        return None
    bare = {id(n.target) for n in walk(around) if isinstance(n, ast.AnnAssign) and n.value is None}
    lines = sorted({node.lineno for node in stored if id(node) not in bare} - {spot.line})
    functions = {line: getattr(spot.file.function_at(line), "name", "") for line in lines}
    reader = getattr(spot.function, "name", "")
    where = f", in {functions[lines[0]]}()" if len({*functions.values()}) == 1 else ""
    which = f": what sets it ({these_lines(lines)}{where}) has not run yet for this object" if lines else ""
    cause = f"self.{name} is used here before anything has set it{which}."
    later = [line for line in lines if functions[line] == "__init__"]
    if led := _led_to_early(sources, owner, name, spot, later):
        return led
    first = next((line for line in lines if functions[line] in ("__init__", reader)), None)
    begun = "above this line" if reader == "__init__" else "in __init__"
    fix = (
        f"make sure that line {first} runs before this line"
        if first
        else f"set self.{name} {begun}, to the value that it has at the beginning"
    )
    return Finding("attribute-missing", cause, spot.place, fix)


def _led_to_early(
    sources: NodeSources, owner: NodeClass, name: str, spot: Spot, later: Sequence[int]
) -> Finding | None:
    """Explain that a constructor calls what leads to the line, before the lines that set what it needs; else None."""
    made, reader = owner.methods.get("__init__"), spot.function
    call = _leading_to(sources, owner, made, reader, later[0]) if made and later else None
    if made is None or reader is None or call is None:
        return None
    set_at = {n.attr: n.lineno for n in stores_in(own_nodes(made)) if is_self_attribute(n)}
    read = [n.attr for n in own_nodes(reader) if is_self_attribute(n)]
    needed = [f"self.{one}" for one in dict.fromkeys([name, *read]) if set_at.get(one, 0) > call.lineno]
    cause = f"self.{name} is used here before line {later[0]} sets it: line {call.lineno}, `{ast.unparse(call)}`, leads to {reader.name}()."
    fix = f"set {in_a_row(needed)} above line {call.lineno}, to what {reader.name}() is to begin with"
    return Finding("attribute-missing", cause, spot.place, fix)


def _leading_to(
    sources: NodeSources, owner: NodeClass, made: Function, method: Function | None, before: int
) -> ast.Call | None:
    """Return the first call in a constructor, above a line, that leads to a method of the class; None if none does."""
    for call in sorted(calls_in(own_nodes(made)), key=lambda call: call.lineno):
        is_super = ast.unparse(call.func) == "super().__init__"
        first = call.func.attr if is_self_attribute(call.func) else ""
        bases = [inner.methods.get("__init__") for inner in sources.lineage(owner)[0][1:]] if is_super else []
        found = [function for function in (*bases, sources.method(owner, first)) if function]
        for function in found:  # grows
            inner = (sources.method(owner, name) for name in own_calls(function))
            found += [called for called in inner if called and called not in found]
        if call.lineno < before and method in found:
            return call
    return None


def taken_from_rclpy(error: ErrorText, known: list[Finding], look: Look) -> Finding | None:
    """Return the known finding that the file of an error hides a member of Node; None if there is none."""
    spot = spot_of(error.report, look)
    begin = f"{spot.file.shown}:"
    hidden = (found for found in known if found.code == "node-property" and found.place.startswith(begin))
    return next(hidden, None) if spot.line and not spot.is_innermost else None


def called_by_rclpy(error: ErrorText, look: Look) -> Finding | None:
    """Say that the failing method hides a method of Node that rclpy calls itself; None if it does not."""
    frames = error.report.frames if error.report else ()
    own = own_frames(frames)
    if len(own) < 2 or frames[max(0, frames.index(own[0]) - 1)] in own:  # they call each other directly
        return None
    spot = spot_of(error.report, look)
    name = spot.function.name if spot.function else ""
    if name.startswith("__") or name not in node_members():
        return None
    cause = f"Every node has a method {name}, which rclpy itself calls: this one hides it and is called too early."
    fix = f"rename it, for example to {name}_, also where it is used"
    return Finding("node-property", cause, spot.file.at(spot.function), fix)


def made_twice(error: ErrorText, known: list[Finding], look: Look) -> Finding | None:
    """Return the known finding that the failing function replaces one of the same name; else None."""
    spot = spot_of(error.report, look)
    if spot.function is None:
        return None
    place = spot.file.at(spot.function)
    return next((finding for finding in known if finding.code == "replaced" and finding.place == place), None)
