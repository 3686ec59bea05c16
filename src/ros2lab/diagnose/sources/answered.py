"""What rclpy needs back from a callback, written for each of its returns at once."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping

from ros2lab.diagnose.finding import in_a_row
from ros2lab.diagnose.sources.own_functions import may_fall_through
from ros2lab.diagnose.sources.python_source import Function, own_nodes, returns_value

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


def answered(function: Function, returns: Mapping[ast.Return, bool], answer: str, is_open: bool) -> str:
    """Return what to write instead of each of some returns, by whether it says yes or no, and as the last line of an open end."""
    lines = dict[str, list[int]]()
    for node in sorted(returns, key=lambda node: node.lineno):
        written = _as_answer(node.value, answer) if node.value and returns[node] else answer
        lines.setdefault(written, []).append(node.lineno)
    rows = []
    for written, numbers in lines.items():
        shown = in_a_row([str(number) for number in numbers])
        where = f"lines {shown} return" if numbers[1:] else f"line {shown} returns"
        rows.append(f"`return {written}` instead of what {where}")
        values = [n.value for n in returns if n.lineno in numbers and answer.isidentifier()]
        said = {
            ast.unparse(v): v
            for v in values
            if v and not (isinstance(v, ast.Name) or ast.unparse(v) == "None")
        }
        for text, value in said.items():
            field = _field_for(function, answer, value)
            rows[-1] += (
                f", with `{field} = {text}` above it"
                if field
                else f", with {text} in the field of {answer} for it"
            )
    if is_open:
        last = function.body[-1]
        like = f", indented like line {last.lineno}" if last.end_lineno != last.lineno else ""
        rows.append(f"`return {answer}` as the last line of {function.name}(){like}")
    return f"write {in_a_row(rows)}"


def _field_for(function: Function, answer: str, value: ast.expr) -> str:
    """Return the only field of an answer that a function sets to a literal of a value's kind; empty if there is none."""
    kind = type(getattr(value, "value", None))
    set_to = {
        ast.unparse(n.targets[0])
        for n in own_nodes(function)
        if isinstance(n, ast.Assign) and isinstance(n.value, ast.Constant) and type(n.value.value) is kind
    }
    fields = {text for text in set_to if text.startswith(f"{answer}.")}
    return fields.pop() if len(fields) == 1 and isinstance(value, ast.Constant) else ""


def unanswered(function: Function, answer: str) -> str:
    """Return what to write where a callback surely gives no answer; empty if it always gives a value."""
    returns = {node: isinstance(getattr(node.value, "value", None), bool) for node in plain_returns(function)}
    is_open = ends_open(function)
    return (
        answered(function, returns, answer, is_open)
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
