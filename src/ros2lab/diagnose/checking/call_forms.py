"""The call of which a type checker speaks, and the forms in which it may have been meant."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence

from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.calls import example_of, meant_call, one_each, whole_call
from ros2lab.diagnose.sources.own_functions import own_function
from ros2lab.diagnose.sources.python_source import PythonSource, parameters
from ros2lab.diagnose.sources.signatures import Parameter, kind_of

_NOTHING = "..."  # stands for a value that is left out


def as_it_was_meant(source: PythonSource, call: ast.Call) -> dict[str, str]:
    """Return a call as the library's signature has it, and one call for each item of a list, with how that is told."""
    each = one_each(call)
    ways = {each[0]: f"write one line for each: {'; '.join(each)}"} if each else {}
    return {whole_call(source, call): meant, **ways} if (meant := meant_call(source, call)) else ways


def rewritten(call: ast.Call, rule: str, said: dict[str, str]) -> dict[str, str]:
    """Return a call with what it lacks, under the name that it has there, without what is too much, or with other values."""
    given, named = [*map(ast.unparse, call.args)], _named(call, {})
    texts: list[str] = []
    if rule == "missing-argument":
        texts = [_call(call, [*given, said["name"].strip("`")], named)]
    elif rule == "too-many-positional-arguments":
        texts = [_call(call, given[:number], named) for number in range(len(given) - 1, -1, -1)]
    elif rule == "invalid-argument-type":
        changes = ("{}()", "{}.value", "{}.data", "float({})", "int({})")
        pairs = ((value, change.format(ast.unparse(value))) for value in call.args for change in changes)
        texts = [_with(call, {id(value): new}) for value, new in pairs]
    return {text: f"write `{text}`" for text in texts}


def given_another(source: PythonSource, call: ast.Call, value: ast.expr, wanted: str) -> dict[str, str]:
    """Return a call with an example of the type that is wanted instead of a value.

    The value is not lost where the call hands over a function that takes one more: that is told first.
    """
    example = example_of(Parameter("", wanted, "", is_positional=True))
    passed_on = {id(one): _called_with(source, one, value) for one in _values(call) if one is not value}
    ways = [{key: text} for key, text in passed_on.items() if text]
    # Of a text nothing is known but that it is one.
    texts = [_with(call, {**way, id(value): example}) for way in (*ways, {}) if example.strip("'")]
    if any(one.value is value for one in call.keywords):
        texts += [_with(call, {**way, id(value): _NOTHING}) for way in ways]
    return {text: f"write `{text}`" for text in texts}


def _called_with(source: PythonSource, function: ast.expr, value: ast.expr) -> str:
    """Return a function that calls another one with a value after its own; empty if that one takes no more values."""
    found = own_function(source, function) if isinstance(function, (ast.Name, ast.Attribute)) else None
    names = [one.arg for one in parameters(found[1]) if one.arg not in ("self", "cls")] if found else []
    more = (
        [*map(ast.unparse, value.elts)] if isinstance(value, (ast.Tuple, ast.List)) else [ast.unparse(value)]
    )
    if kind_of(value) == "None" or not 0 < len(more) < len(names):
        return ""
    own = ", ".join(names[: -len(more)])
    return f"lambda {own}: {ast.unparse(function)}({own}, {', '.join(more)})"


def argument_at(call: ast.Call, line: int, column: int) -> ast.expr | None:
    """Return the value that a call is given at a line and a column."""
    places = {(one.lineno, one.col_offset): one for one in call.args}
    places |= {(one.lineno, one.col_offset): one.value for one in call.keywords}
    return places.get((line, column))


def _values(call: ast.Call) -> list[ast.expr]:
    return [*call.args, *(one.value for one in call.keywords)]


def _with(call: ast.Call, new: Mapping[int, str]) -> str:
    """Return a call with other texts for some of its values, by their identity."""
    return _call(call, [new.get(id(one)) or ast.unparse(one) for one in call.args], _named(call, new))


def _named(call: ast.Call, new: Mapping[int, str]) -> list[str]:
    rows = ((one, new.get(id(one.value)) or ast.unparse(one.value)) for one in call.keywords)
    return [f"{one.arg}={text}" if one.arg else f"**{text}" for one, text in rows if text != _NOTHING]


def _call(call: ast.Call, given: Sequence[str], named: Sequence[str]) -> str:
    return f"{ast.unparse(call.func)}({', '.join([*given, *named])})"


def call_at(spot: Spot, column: int, rule: str) -> ast.Call | None:
    """Return the call about which a type checker speaks at a line and a column."""

    def begins(node: ast.AST) -> bool:
        return (getattr(node, "lineno", 0), getattr(node, "col_offset", -1)) == (spot.line, column)

    for node in spot.source.nodes if spot.source else ():
        if isinstance(node, ast.Call) and any(
            map(begins, [node] if rule == "missing-argument" else [*node.args, *node.keywords])
        ):
            return node
    return None
