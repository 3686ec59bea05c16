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


def passed_on(source: PythonSource, call: ast.Call, value: ast.expr, example: str) -> dict[str, str]:
    """Return forms of a call with their fixes: a value is passed on to a function among the other arguments."""
    others = (argument for argument in given_to(call) if argument is not value)
    ways = [{id(other): text} for other in others if (text := _called_with(source, other, value))]
    # An example of a string is not used: its content would be a guess.
    left = [LEFT_OUT, example] if example.strip("'") else [LEFT_OUT]
    texts = [with_arguments(call, {**way, id(value): text}) for way in ways for text in left]
    return {text: f"write `{text}`" for text in texts}


def example_in_place_of(value: ast.expr, wanted: str) -> str:
    """Return an example of the wanted type, near a value that is not of it."""
    meant = fitting(wanted, value) if isinstance(value, ast.Constant) else ""
    return meant or example_of(Parameter("", wanted, "", is_positional=True))


def _called_with(source: PythonSource, function: ast.expr, value: ast.expr) -> str:
    """Return what calls a function with a value as its last argument; empty if it takes none."""
    found = own_function(source, function) if isinstance(function, (ast.Name, ast.Attribute)) else None
    names = [parameter.arg for parameter in own_parameters(found[1])] if found else []
    parts = value.elts if isinstance(value, (ast.Tuple, ast.List)) else [value]
    if kind_of(value) == "None" or not 0 < len(parts) <= len(names):
        return ""
    own, called = names[: -len(parts)], ast.unparse(function)
    if not own:  # partial, because a lambda in a loop would see the last value of its variable
        return f"functools.partial({', '.join(map(ast.unparse, [function, *parts]))})"
    return f"lambda {', '.join(own)}: {called}({', '.join([*own, *map(ast.unparse, parts)])})"


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
