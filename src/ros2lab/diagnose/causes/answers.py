"""An exception inside rclpy that comes from what a callback of the student's returned to it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass

from ros2lab.diagnose.checking.trials import type_of
from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.sources.answered import ACCEPTED, answered, ends_open, response_fields
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.own_functions import own_function
from ros2lab.diagnose.sources.python_source import Function, PythonSource, names_bound, own_nodes, parameters
from ros2lab.diagnose.sources.static_value import dotted


@dataclass(frozen=True)
class _Kind:
    """What rclpy expects back from a kind of callback.

    Attributes:
        file: the file of rclpy that uses the answer.
        position: where the call that registers the callback takes it.
        keyword: the name of that argument.
        wanted: the class of the answer, as a regular expression.
        answer: an answer that is accepted; `{last}` is the last parameter of the callback.
        home: the module of the class that the answer names; empty if it needs no import.
    """

    file: str
    position: int
    keyword: str
    wanted: str
    answer: str
    home: str = ""


_TRANSITION = _Kind(
    "lifecycle", 0, "", "TransitionCallbackReturn", "TransitionCallbackReturn.SUCCESS", "rclpy.lifecycle"
)
_REGISTERED = {
    "create_service": _Kind("service.py", 2, "callback", r"\w*Response", "{last}"),
    "add_on_set_parameters_callback": _Kind(
        "node.py", 0, "callback", "SetParametersResult", ACCEPTED, "rcl_interfaces.msg"
    ),
    "add_pre_set_parameters_callback": _Kind("node.py", 0, "callback", r"list\b.*", "{last}"),
    "goal_callback": _Kind("action/server.py", 4, "", "GoalResponse", "GoalResponse.ACCEPT", "rclpy.action"),
    "cancel_callback": _Kind(
        "action/server.py", 6, "", "CancelResponse", "CancelResponse.ACCEPT", "rclpy.action"
    ),
}


_REJECTED = (
    "Callback returned an invalid type"  # what rclpy logs of a parameter callback, without an exception
)


@dataclass(frozen=True)
class _Answering:
    """A function whose return value rclpy uses."""

    source: PythonSource
    function: ast.FunctionDef
    kind: _Kind

    @property
    def answer(self) -> str:
        last = [parameter.arg for parameter in parameters(self.function)][-1:] or ["response"]
        return self.kind.answer.format(last=last[0])

    @property
    def more(self) -> str:
        """The import that the answer needs; empty if the file has it."""
        name = re.match(r"[A-Z]\w+", self.answer)
        is_known = name is None or name[0] in self.source.names
        return (
            "" if is_known or name is None else f", with `from {self.kind.home} import {name[0]}` at the top"
        )


def of_answer(error: ErrorText, look: Look) -> Finding | None:
    """Return the callback whose return value rclpy cannot use; None if the error is about something else."""
    report = error.report
    own = error.own
    files = "\n".join(frame.file for frame in report.frames if frame not in own) if report else ""
    if report and (not report.frames or report.frames[-1] in own):
        return None
    if _REJECTED in error.decisive:
        files = "rclpy/node.py"
    for package in look.packages:
        for answering in _answering(look.sources(package)):
            if f"rclpy/{answering.kind.file}" in files and (found := _of_function(answering)):
                return found
    return None


def _answering(sources: NodeSources) -> Iterator[_Answering]:
    """Yield the functions that rclpy calls and whose return value it uses."""
    for owner in filter(sources.is_managed, sources.nodes):
        for name, method in owner.methods.items():
            if re.fullmatch("on_(configure|activate|deactivate|cleanup|shutdown|error)", name):
                yield from _with(owner.source, method, _TRANSITION)
    for source in sources.sources.values():
        for node in source.nodes:
            if not isinstance(node, ast.Call):
                continue
            if kind := _REGISTERED.get((dotted(node.func) or "").rpartition(".")[2]):
                given = [keyword.value for keyword in node.keywords if keyword.arg == kind.keyword]
                given += node.args[kind.position : kind.position + 1]
                yield from _given(source, given, kind)
            for keyword in node.keywords:
                if keyword.arg in ("goal_callback", "cancel_callback"):
                    yield from _given(source, [keyword.value], _REGISTERED[keyword.arg])


def _given(source: PythonSource, given: list[ast.expr], kind: _Kind) -> Iterator[_Answering]:
    for value in given[:1]:
        if home := own_function(source, value):
            yield from _with(*home, kind)


def _with(source: PythonSource, function: Function, kind: _Kind) -> Iterator[_Answering]:
    if isinstance(function, ast.FunctionDef) and not function.decorator_list:
        yield _Answering(source, function, kind)


def _of_function(answering: _Answering) -> Finding | None:
    """Return what is wrong with all that a function returns; None if nothing is seen."""
    source, function, answer = answering.source, answering.function, answering.answer
    needed = f"`{answer}`" if answer.isidentifier() else f"a {re.split(r'[.(]', answer)[0]}"
    returns = [node for node in own_nodes(function) if isinstance(node, ast.Return)]
    refused = [(node, given) for node in returns if (given := _refused(answering, node))]
    if any(given == f"`{answer}`" for _, given in refused):
        return _replaced(answering)
    refused.sort(key=lambda pair: pair[0].lineno)
    is_open = ends_open(function)
    if not refused and not is_open:
        return None
    said = [f"`{ast.unparse(n.value)}`" if n.value and given == "bool" else given for n, given in refused]
    does = f"returns {in_a_row([*dict.fromkeys(said)])}" if said else "ends without a return"
    place = source.at(refused[0][0] if refused else function)
    plain = {node: given == "bool" for node, given in refused}
    fix = answered(function, plain, answer, is_open, response_fields(source, function))
    cause = f"{function.name}() {does}, but it must return {needed}."
    return Finding("made-wrong", cause, place, f"{fix}{answering.more}")


def _replaced(answering: _Answering) -> Finding | None:
    """Return the finding of a function that gives the name of its answer another value."""
    function, answer = answering.function, answering.answer
    for node in own_nodes(function):
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if name == answer:
                pairs = zip(value.keys, value.values, strict=True) if isinstance(value, ast.Dict) else ()
                fields = [
                    f"`{name}.{getattr(key, 'value', '')} = {ast.unparse(item)}`" for key, item in pairs
                ]
                written = (
                    " and ".join(fields)
                    or f"`{name}_ = {ast.unparse(value)}`, and set the fields of {name} with it,"
                )
                cause = f"Line {node.lineno} replaces {name}, which rclpy needs back from {function.name}() with its fields set."
                fix = f"write {written} instead of line {node.lineno}"
                return Finding("made-wrong", cause, answering.source.at(node), fix)
    return None


def _refused(answering: _Answering, node: ast.Return) -> str:
    """Return what a statement returns, in words, if rclpy cannot use it; else empty."""
    value, source = node.value, answering.source
    if value is None:
        return "nothing"
    text = ast.unparse(value)
    stored = names_bound(own_nodes(answering.function))
    is_answer = text == answering.answer and text not in stored
    if is_answer or isinstance(value, ast.Await) or "super()" in text:
        return ""
    if text in {parameter.arg for parameter in parameters(answering.function)} - stored:
        return f"`{text}`"  # what it was given, and not the answer
    kind = "bool" if isinstance(getattr(value, "value", None), bool) else type_of(source, value)
    is_known = bool(kind) and not re.search(r"Unknown|Any|\bobject\b", kind)
    if not is_known or re.search(answering.kind.wanted, kind):
        return ""
    return "bool" if kind == "bool" else f"`{text}`"
