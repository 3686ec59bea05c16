"""What rclpy needs back from a callback, written for each of its returns at once."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping

from ros2lab.diagnose.finding import in_a_row
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.own_functions import may_fall_through
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    argument,
    last_name,
    own_nodes,
    returns_value,
)

ACCEPTED = "SetParametersResult(successful=True)"
# What says no to what another answer accepts.
_REFUSALS = {
    "GoalResponse.ACCEPT": "GoalResponse.REJECT",
    "CancelResponse.ACCEPT": "CancelResponse.REJECT",
    "TransitionCallbackReturn.SUCCESS": "TransitionCallbackReturn.FAILURE",
}


def plain_returns(function: Function) -> Iterator[ast.Return]:
    """Yield the statements that return nothing or a plain value, which is no answer for rclpy."""
    for node in own_nodes(function):
        if isinstance(node, ast.Return) and (node.value is None or isinstance(node.value, ast.Constant)):
            yield node


def response_fields(source: PythonSource, function: Function) -> Mapping[str, str]:
    """Return the types of a response's fields, by the service for which a file registers a callback; empty if not known."""
    for call in source.calls:
        callback = argument(call, 2, "callback")
        if last_name(call.func) == "create_service" and last_name(callback) == function.name:
            return interfaces.fields_of(f"{source.resolve(argument(call, 0, 'srv_type'))}_Response") or {}
    return {}


def answered(
    function: Function,
    returns: Mapping[ast.Return, bool],
    answer: str,
    is_open: bool,
    fields: Mapping[str, str] = {},
) -> str:
    """Return what to write instead of each of some returns, by whether it says yes or no, and as the last line of an open end.

    The types of the answer's fields, as far as they are known, tell where a literal belongs.
    """
    lines = dict[str, list[int]]()
    for node in sorted(returns, key=lambda node: node.lineno):
        written = _as_answer(node.value, answer) if node.value and returns[node] else answer
        lines.setdefault(written, []).append(node.lineno)
    rows = []
    for written, numbers in lines.items():
        shown = in_a_row([str(number) for number in numbers])
        where = f"lines {shown} return" if numbers[1:] else f"line {shown} returns"
        rows.append(f"`return {written}` instead of what {where}")
        said = dict[str, ast.Return]()
        for node in returns if answer.isidentifier() else ():
            value = node.value
            if (
                node.lineno in numbers
                and value
                and not isinstance(value, ast.Name)
                and ast.unparse(value) != "None"
            ):
                said.setdefault(ast.unparse(value), node)
        for text, node in said.items():
            above = f"line {node.lineno}" if len(said) > 1 else "it"
            field = _field_for(function, answer, node.value, fields)
            rows[-1] += (
                f", with `{field} = {text}` above {above}"
                if field
                else f", with {text} in the field of {answer} for it"
            )
    if is_open:
        last = function.body[-1]
        like = f", indented like line {last.lineno}" if last.end_lineno != last.lineno else ""
        rows.append(f"`return {answer}` as the last line of {function.name}(){like}")
    return f"write {in_a_row(rows)}"


def _field_for(function: Function, answer: str, value: ast.expr | None, fields: Mapping[str, str]) -> str:
    """Return the only field of an answer for a literal of a value's kind, by its type or what a function sets; else empty."""
    kind = type(getattr(value, "value", None))
    set_to = {
        ast.unparse(n.targets[0])
        for n in own_nodes(function)
        if isinstance(n, ast.Assign) and isinstance(n.value, ast.Constant) and type(n.value.value) is kind
    }
    found = {text for text in set_to if text.startswith(f"{answer}.")}
    found = found or {
        f"{answer}.{f}" for f, of in fields.items() if interfaces.field_kind(of) == kind.__name__
    }
    return found.pop() if len(found) == 1 and isinstance(value, ast.Constant) else ""


def unanswered(function: Function, answer: str, fields: Mapping[str, str] = {}) -> str:
    """Return what to write where a callback surely gives no answer; empty if it always gives a value."""
    returns = {node: isinstance(getattr(node.value, "value", None), bool) for node in plain_returns(function)}
    is_open = ends_open(function)
    return (
        answered(function, returns, answer, is_open, fields)
        if returns or (is_open and not returns_value(function))
        else ""
    )


def ends_open(function: Function) -> bool:
    """Return whether a function may reach its end without a return."""
    return not isinstance(function.body[-1], (ast.Return, ast.Raise)) and may_fall_through(function)


def _as_answer(said: ast.expr, answer: str) -> str:
    """Return an answer that accepts where an expression is true."""
    text, refusal = ast.unparse(said), _REFUSALS.get(answer)
    if refusal is None:
        return answer.replace("True", text)
    return {"True": answer, "False": refusal}.get(text, f"{answer} if {text} else {refusal}")
