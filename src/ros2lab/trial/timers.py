"""Finds timers that fire without a pause, and explains their periods with the parameters of the run."""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.topic_faults import publishing_timers
from ros2lab.diagnose.sources.node_source import Creation, NodeSources
from ros2lab.diagnose.sources.static_value import evaluate
from ros2lab.grading.evidence import Heard, Run

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen

SHORTEST_PERIOD = 0.001  # s; a Python node cannot keep a shorter one
QUICK = 0.1  # s; a slower topic has pauses, whatever its timer's period seems to be
MOST_NAMES = 10  # that refer to each other
UNPAUSED = 0.004  # s, between two messages of a timer whose period is not known
_CALLS: Mapping[str, Callable[..., Any]] = {
    "int": int,
    "float": float,
    "round": round,
    "abs": abs,
    "min": min,
    "max": max,
}


def pauseless(seen: Seen, run: Run, topic: str, heard: Heard) -> Finding | None:
    """Return the fault of a timer that publishes without a pause; None if there is none."""
    times = heard.times
    gap = (times[-1] - times[0]) / (len(times) - 1) if len(times) > 1 else QUICK
    if gap >= QUICK:
        return None
    given = {name: value for values in run.parameters.values() for name, value in values.items()}
    for end in seen.ends(topic, is_publisher=True):
        for timer in publishing_timers(end):
            period = Period(timer, end.sources, given)
            if period.is_told:
                continue
            is_known = isinstance(period.value, (int, float))
            # On a simulated clock, messages come without a pause even from a correct timer.
            is_short = period.value < SHORTEST_PERIOD if is_known else gap < UNPAUSED and run.clock == "real"
            if is_short:
                value = f"was {period.value:g} s in this run" if is_known else "is practically 0"
                cause = (
                    f"The period `{period.text}` {value}{period.why}: this timer fires without a pause, and "
                    f"{heard.count} messages came on {topic}."
                )
                return Finding("period", cause, timer.source.at(timer.call), period.fix)
    return None


class Period(ast.NodeTransformer):
    """Evaluates a timer's period: replaces names by their values, and parameters by those of the run."""

    def __init__(self, timer: Creation, sources: NodeSources, parameters: Mapping[str, Any]) -> None:
        self._source, self._parameters = timer.source, parameters
        self._depth = 0
        given = timer.given("timer_period_sec") or ast.Constant(None)
        self.text = ast.unparse(given)
        self._written: list[ast.expr] = [given]
        self.value = self._value(given)
        known = sources.value(timer.source, timer.source.written(given))
        # A period that is 0 in the sources is reported by the rules for sources.
        self.is_told = isinstance(known, (int, float)) and known <= 0
        self.why, self.fix = self._reason()

    def _reason(self) -> tuple[str, str]:
        for node in (node for expression in self._written for node in ast.walk(expression)):
            match node:
                case ast.BinOp(op=ast.FloorDiv(), left=left, right=right) if self._value(node) == 0:
                    whole = ast.unparse(ast.BinOp(left, ast.Div(), right))
                    return (
                        ", because // drops the fraction",
                        f"write `{whole}` instead of `{ast.unparse(node)}`",
                    )
                case ast.Call(func=ast.Name("int" | "round" as name), args=[whole]) if self._value(node) == 0:
                    why = f", because {name}() of a fraction of a second is 0"
                    return why, f"write `{ast.unparse(whole)}` instead of `{ast.unparse(node)}`"
        return "", "write a period above 0, in seconds: 1.0 / rate for a rate in Hz, or milliseconds / 1000"

    def _value(self, node: ast.expr) -> Any:
        return evaluate(self.visit(copy.deepcopy(node)), self._source.constants, _CALLS)

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """Replace a name by the expression that was assigned to it."""
        return self._given(node)

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        """Replace an attribute by the expression that was assigned to it, or by its parameter's value."""
        given = self._given(node)
        if given is not node:
            return given
        self.generic_visit(node)
        match node:
            case ast.Attribute(
                value=ast.Call(func=ast.Attribute(attr="get_parameter_value", value=ast.Call() as read))
            ):
                pass
            case ast.Attribute(attr="value", value=ast.Call() as read):
                pass
            case _:
                return node
        match read:
            case ast.Call(
                func=ast.Attribute(attr="get_parameter" | "declare_parameter"),
                args=[ast.Constant(value=str() as name), *_],
            ) if name in self._parameters:
                return ast.Constant(self._parameters[name])
        return node

    def _given(self, node: ast.Name | ast.Attribute) -> ast.expr:
        written = self._source.written(node)
        if written is node or self._depth > MOST_NAMES:
            return node
        if written not in self._written:
            self._written.append(written)
        self._depth += 1
        found: ast.expr = self.visit(copy.deepcopy(written))
        self._depth -= 1
        return found
