"""Exceptions that the student's own code raises in a callback: what they end, and what to do instead."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ros2lab.diagnose.causes.later_calls import sources_around
from ros2lab.diagnose.finding import Finding, lines_in_words
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorReport, ErrorText, own_frames
from ros2lab.diagnose.printed.spots import Spot, place_of, spot_at
from ros2lab.diagnose.sources.interfaces import fields_of
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources
from ros2lab.diagnose.sources.python_source import Function, contains, last_name, parameters, walk
from ros2lab.diagnose.sources.static_value import dotted

# The kinds of callbacks, each by the call or the keyword that passes it to ROS.
_KINDS = {
    "create_service": "a service callback",
    "create_subscription": "a subscription callback",
    "create_timer": "a timer callback",
    "add_on_set_parameters_callback": "a parameter callback",
    "execute_callback": "an execute callback",
    "goal_callback": "a goal callback",
    "cancel_callback": "a cancel callback",
}
_ENDS = "ends the node"
_CONSEQUENCES = {
    "create_service": f"{_ENDS}, and the caller never gets a response",
    "add_on_set_parameters_callback": f"{_ENDS} instead of rejecting the value",
    "execute_callback": "aborts the goal, and the client is not told why",
    "goal_callback": f"{_ENDS} instead of rejecting the goal",
}
# What the answers of some kinds are made of: the module and the name.
_ANSWERED_WITH = {
    "add_on_set_parameters_callback": ("rcl_interfaces.msg", "SetParametersResult"),
    "goal_callback": ("rclpy.action", "GoalResponse"),
    "cancel_callback": ("rclpy.action", "CancelResponse"),
}
_NOT_WRITTEN_YET = "NotImplementedError"


@dataclass(frozen=True)
class _Callback:
    """A function that rclpy called, by which call and which kind of it, with the line that was running in it."""

    sources: NodeSources
    function: Function
    kind: str
    call: ast.Call
    owner: NodeClass | None
    spot: Spot

    @property
    def last(self) -> str:
        """The name of its last parameter."""
        return [parameter.arg for parameter in parameters(self.function)][-1]

    @property
    def tells(self) -> str:
        """The function that shows a text, such as `self.get_logger().warning`."""
        if self.owner is not None and self.sources.lineage(self.owner)[1]:
            return "self.get_logger().warning"
        maker = getattr(self.call.func, "value", None)
        text = ast.unparse(maker) if maker is not None and self.kind.startswith("create_") else ""
        return f"{text}.get_logger().warning" if text.startswith("self.") else "print"


def of_own_raise(error: ErrorText, look: Look) -> Finding | None:
    """Say what an exception ends that the student's own `raise` or `assert` lets out of a callback; None for others."""
    report = error.report
    if report is None or not report.frames or not own_frames(report.frames[-1:]):
        return None
    place = place_of([report.frames[-1]], look)
    spot = spot_at(place, look)
    raising = _raising(spot)
    if raising is None or report.kind == _NOT_WRITTEN_YET:
        return None
    callback = next(_called_by_rclpy(report, error, look), None)
    if callback is None or spot.function is None:
        return None
    is_direct = (
        callback.spot.file.shown == spot.file.shown and callback.function.lineno == spot.function.lineno
    )
    what = _KINDS.get(callback.kind, "a callback")
    raised = f"{spot.function.name}() raises {report.kind}"
    said = f" ({report.message.rstrip('.')})" if report.message else ""
    ends = _CONSEQUENCES.get(callback.kind, _ENDS)
    cause = f"{raised}{said}, but an exception that leaves {what} {ends}."
    fix = _instead(callback, raising) if is_direct else _caught(callback, raising)
    return Finding("raise-in-callback", cause, place, fix)


def _raising(spot: Spot) -> ast.Raise | ast.Assert | None:
    """Return the statement at a line that raises an exception itself; None if it only calls something."""
    around = spot.file.around(spot.line, ast.stmt)
    return next((n for n in around if isinstance(n, (ast.Raise, ast.Assert))), None)


def _called_by_rclpy(report: ErrorReport, error: ErrorText, look: Look) -> Iterator[_Callback]:
    """Yield the callbacks in a traceback, that which rclpy called itself first."""
    ours = {id(frame) for frame in own_frames(report.frames)}
    of_rclpy = [
        n for n, frame in enumerate(report.frames) if id(frame) not in ours and "/rclpy/" in frame.file
    ]
    every = sources_around(error, look) if of_rclpy else []
    for frame in report.frames[of_rclpy[-1] + 1 :] if of_rclpy else ():
        spot = spot_at(place_of([frame], look), look)
        shown = spot.file.shown
        for sources in every:
            if spot.function is not None and any(s.shown == shown for s in sources.sources.values()):
                yield from _passed_on(sources, shown, spot.function, spot)


def _passed_on(sources: NodeSources, shown: str, function: Function, spot: Spot) -> Iterator[_Callback]:
    """Yield a function of a file with each call that passes it on."""
    here = (node_class for node_class in sources.classes.values() if node_class.source.shown == shown)
    owner = next((found for found in here if function.lineno in {f.lineno for f in found.functions}), None)
    given = len(parameters(function)) - (owner is not None)
    for kind, call in _taking(sources, shown, function.name):
        # Whatever takes a function of two parameters by another name gives it a request and a response.
        is_service = given == 2 and kind not in _KINDS
        yield _Callback(sources, function, "create_service" if is_service else kind, call, owner, spot)


def _taking(sources: NodeSources, shown: str, name: str) -> Iterator[tuple[str, ast.Call]]:
    """Yield the calls that pass a function on, those in its own file first, each with its kind."""
    for source in sorted(sources.sources.values(), key=lambda source: source.shown != shown):
        for call in source.nodes:
            if not isinstance(call, ast.Call):
                continue
            short = (dotted(call.func) or "").rpartition(".")[2]
            named = [(keyword.arg or "", keyword.value) for keyword in call.keywords]
            for word, value in [("", value) for value in call.args] + named:
                if name in map(last_name, _handed(value)):
                    is_action = short.endswith("ActionServer") and not word
                    kind = "execute_callback" if is_action else word if word in _KINDS else short
                    yield kind, call


def _handed(value: ast.expr) -> Iterator[ast.AST]:
    """Yield what an argument hands on: itself, what a lambda calls, and what `partial` is given."""
    match value:
        case ast.Lambda(body=body):
            yield from walk(body)
        case ast.Call(func=func, args=[first, *_]) if (dotted(func) or "").endswith("partial"):
            yield first
        case _:
            yield value


def _instead(callback: _Callback, raising: ast.Raise | ast.Assert) -> str:
    """Return what to write in a callback instead of its own `raise` or `assert`."""
    answers = _joined(_answers(callback, _text(raising)))
    if isinstance(raising, ast.Assert):
        asked = ast.unparse(ast.UnaryOp(ast.Not(), raising.test))
        return f"write `if {asked}:` instead of the assert, and, indented below it, {answers}"
    return f"write {answers} instead of the raise{_imported(callback)}"


def _caught(callback: _Callback, raising: ast.Raise | ast.Assert) -> str:
    """Return how to catch an exception in the callback that calls the function that raises it."""
    kind = _kind_caught(callback, raising)
    first, last = _statement(callback)
    where = lines_in_words(first, last)
    answers = _joined(_answers(callback, "str(error)"))
    return (
        f"in {callback.function.name}(), indent {where} below a `try:`, and write `except {kind} as error:` after it, "
        f"with {answers} below that{_imported(callback)}"
    )


def _statement(callback: _Callback) -> tuple[int, int]:
    """Return the first and the last line of the statement that was running in a callback, with its body."""
    nodes = (node for node in walk(callback.function) if isinstance(node, ast.stmt))
    innermost = max((n for n in nodes if contains(n, callback.spot.line)), key=lambda node: node.lineno)
    return innermost.lineno, innermost.end_lineno or innermost.lineno


def _kind_caught(callback: _Callback, raising: ast.Raise | ast.Assert) -> str:
    """Return the name of the class to catch, as the callback's file knows it."""
    if isinstance(raising, ast.Assert):
        return "AssertionError"
    made = raising.exc.func if isinstance(raising.exc, ast.Call) else raising.exc
    name = ast.unparse(made) if made is not None else ""
    source = callback.spot.file
    classes = {n.name for n in source.nodes if isinstance(n, ast.ClassDef)}
    is_known = hasattr(builtins, name) or name in classes or name in source.names
    return name if is_known else "Exception"


def _text(raising: ast.Raise | ast.Assert) -> str:
    """Return the expression of the text with which an exception is raised; empty if it has none."""
    if isinstance(raising, ast.Assert):
        given = raising.msg
    else:
        is_made = isinstance(raising.exc, ast.Call)
        given = next(iter(raising.exc.args), None) if isinstance(raising.exc, ast.Call) else raising.exc
        if not is_made and isinstance(given, ast.Name) and given.id[:1].isupper():
            given = None  # a class without a text
    if given is None:
        return ""
    is_text = isinstance(given, (ast.JoinedStr, ast.BinOp)) or isinstance(getattr(given, "value", None), str)
    return ast.unparse(given) if is_text else f"str({ast.unparse(given)})"


def _answers(callback: _Callback, text: str) -> list[str]:
    """Return the statements with which a callback refuses what it is asked; the text is an expression that says why."""
    last = callback.last if parameters(callback.function) else ""
    shown = text or repr(f"{callback.function.name}: this is not possible now")
    told = f"{callback.tells}({shown})"
    given = ast.unparse(callback.call.args[1]) if len(callback.call.args) > 1 else ""
    match callback.kind:
        case "create_service":
            return [*(_filled(callback, text) or [told]), f"return {last}"]
        case "add_on_set_parameters_callback":
            return [f"return SetParametersResult(successful=False, reason={shown})"]
        case "execute_callback":
            return [told, f"{last}.abort()", f"return {given}.Result()" if given else "return"]
        case "goal_callback":
            return [told, "return GoalResponse.REJECT"]
        case "cancel_callback":
            return [told, "return CancelResponse.REJECT"]
    return [told, "return"]


def _filled(callback: _Callback, text: str) -> list[str]:
    """Return the statements that fill a response with a refusal; empty if it has no fields for that."""
    given = {keyword.arg: keyword.value for keyword in callback.call.keywords}
    kind = given.get("srv_type") or next(iter(callback.call.args), None)
    names = [callback.sources.resolve(s, kind) for s in callback.sources.sources.values() if kind in s.nodes]
    fields = fields_of(f"{names[0]}_Response") if names and names[0] else None
    flags = [name for name, field in (fields or {}).items() if field == "boolean"]
    texts = [name for name, field in (fields or {}).items() if field == "string"]
    return [f"{callback.last}.{name} = False" for name in flags[:1]] + [
        f"{callback.last}.{name} = {text}" for name in texts[:1] if text
    ]


def _imported(callback: _Callback) -> str:
    """Return which import the answer of a callback needs; empty if its file has it."""
    needed = _ANSWERED_WITH.get(callback.kind)
    source = callback.spot.file
    if needed is None or needed[1] in source.names:
        return ""
    return f", with `from {needed[0]} import {needed[1]}` at the top"


def _joined(statements: Sequence[str]) -> str:
    quoted = [f"`{statement}`" for statement in statements]
    return " and ".join(filter(None, (", ".join(quoted[:-1]), quoted[-1])))
