"""Finds the call that the type checker rejects, and forms in which it may have been meant."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.calls import example_of, fitting, meant_call, one_each, whole_call
from ros2lab.diagnose.sources.own_functions import own_function
from ros2lab.diagnose.sources.python_source import PythonSource, given_to
from ros2lab.diagnose.sources.signatures import Parameter, kind_of
from ros2lab.diagnose.sources.syntax_parts import LEFT_OUT, own_parameters, with_arguments


def as_it_was_meant(source: PythonSource, call: ast.Call) -> dict[str, str]:
    """Return corrected forms of a call with their fixes: by its signature, or one call per item of a list."""
    calls = one_each(call)
    ways = {calls[0]: f"write one line for each: {'; '.join(calls)}"} if calls else {}
    return {whole_call(source, call): meant, **ways} if (meant := meant_call(source, call)) else ways


def rewritten(call: ast.Call, rule: str, said: dict[str, str]) -> dict[str, str]:
    """Return forms of a call with their fixes: an argument added, extra ones removed or values converted."""
    given, named = [*map(ast.unparse, call.args)], [*map(ast.unparse, call.keywords)]
    texts: list[str] = []
    if rule == "missing-argument":
        texts = [call_with(call, [*given, said["name"].strip("`")], named)]
    elif rule == "too-many-positional-arguments":
        texts = [call_with(call, given[:number], named) for number in range(len(given) - 1, -1, -1)]
    elif rule == "invalid-argument-type":
        changes = ("{}()", "{}.value", "{}.data", "float({})", "int({})")
        pairs = ((value, change.format(ast.unparse(value))) for value in call.args for change in changes)
        texts = [with_arguments(call, {id(value): new}) for value, new in pairs]
    return {text: f"write `{text}`" for text in texts}


def given_another(source: PythonSource, call: ast.Call, value: ast.expr, wanted: str) -> dict[str, str]:
    """Return forms of a call with their fixes: an example of the wanted type replaces a value.

    Forms that pass the value on to a function among the other arguments come first.
    """
    meant = fitting(wanted, value) if isinstance(value, ast.Constant) else ""
    example = meant or example_of(Parameter("", wanted, "", is_positional=True))
    passed_on = {
        id(argument): _called_with(source, argument, value)
        for argument in given_to(call)
        if argument is not value
    }
    ways = [{key: text} for key, text in passed_on.items() if text]
    # An example of a string is not used: its content would be a guess.
    texts = [with_arguments(call, {**way, id(value): example}) for way in (*ways, {}) if example.strip("'")]
    if any(keyword.value is value for keyword in call.keywords):
        texts += [with_arguments(call, {**way, id(value): LEFT_OUT}) for way in ways]
    return {text: f"write `{text}`" for text in texts}


def _called_with(source: PythonSource, function: ast.expr, value: ast.expr) -> str:
    """Return a lambda that calls a function with a value as its last argument; empty if it takes none."""
    found = own_function(source, function) if isinstance(function, (ast.Name, ast.Attribute)) else None
    names = [parameter.arg for parameter in own_parameters(found[1])] if found else []
    more = (
        [*map(ast.unparse, value.elts)] if isinstance(value, (ast.Tuple, ast.List)) else [ast.unparse(value)]
    )
    if kind_of(value) == "None" or not 0 < len(more) < len(names):
        return ""
    own = ", ".join(names[: -len(more)])
    return f"lambda {own}: {ast.unparse(function)}({own}, {', '.join(more)})"


def argument_at(call: ast.Call, line: int, column: int) -> ast.expr | None:
    """Return the argument of a call that begins at a line and a column; None if there is none."""
    places = {(argument.lineno, argument.col_offset): argument for argument in call.args}
    places |= {(keyword.lineno, keyword.col_offset): keyword.value for keyword in call.keywords}
    return places.get((line, column))


def call_with(call: ast.Call, given: Sequence[str], named: Sequence[str]) -> str:
    """Return a call with other arguments, by position and by keyword."""
    return f"{ast.unparse(call.func)}({', '.join([*given, *named])})"


def call_at(spot: Spot, column: int, rule: str) -> ast.Call | None:
    """Return the call that the type checker rejects at a line and a column; None if there is none."""

    def begins(node: ast.AST) -> bool:
        return (getattr(node, "lineno", 0), getattr(node, "col_offset", -1)) == (spot.line, column)

    for call in spot.source.calls if spot.source else ():
        if any(map(begins, [call] if rule == "missing-argument" else [*call.args, *call.keywords])):
            return call
    return None
