"""Finds calls that are written where a function is needed, and so run at once: `Thread(target=work())`."""

from __future__ import annotations

import ast
import builtins
import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass

from ros2lab.diagnose.checking.call_forms import call_with
from ros2lab.diagnose.checking.checked_copies import Row, checked, first_that_stands
from ros2lab.diagnose.checking.edits import Edit, revealing
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.interfaces import is_interface
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.own_functions import as_function, called_function, gives_no_function
from ros2lab.diagnose.sources.python_source import Function, PythonSource
from ros2lab.diagnose.sources.signatures import heads_of, signature_of
from ros2lab.diagnose.sources.uses import is_log

_NOTHING = re.compile(r"`(?:None|Never|NoReturn)`")
_FUNCTION = re.compile(r"Expected `(?:.*?\((?P<passed>[^.()]*), /\))?.*->.*`, found")


@dataclass(frozen=True)
class _Given:
    """A call that is an argument of another call.

    Attributes:
        name: the name of the keyword argument; empty if it is positional.
        function: the function of the workspace that it calls; None if it calls another.
        is_void: whether it calls a function of the workspace and so gets nothing that can be called later.
    """

    outer: ast.Call
    call: ast.Call
    name: str
    function: Function | None
    is_void: bool

    @property
    def is_coroutine(self) -> bool:
        """Whether the call makes a coroutine."""
        return isinstance(self.function, ast.AsyncFunctionDef)


def called_at_once(look: Look) -> Iterator[Finding]:
    """Yield each call that returns no function but is passed where one is needed that is called later.

    The type checker says what a parameter accepts and what a library function returns.
    """
    for package in look.packages:
        sources = look.sources(package)
        for source in sources.sources.values():
            found = [*_given_calls(sources, source)] if source.path and not source.fault else []
            yield from _called(source, found) if found else ()


def swapped_functions(look: Look) -> Iterator[Finding]:
    """Yield each call that is given a value where it needs a function, and the function in another place."""
    for package in look.packages:
        for source in look.sources(package).sources.values():
            (rows,) = checked(source, [source.text.encode()]) if source.path and not source.fault else ([],)
            for row in rows:
                if row.rule == "invalid-argument-type" and _FUNCTION.search(row.said):
                    yield from _swapped(source, row.line)


def _swapped(source: PythonSource, line: int) -> Iterator[Finding]:
    """Yield the call on a line that the type checker accepts with two arguments swapped."""
    for call in (node for node in source.calls if node.lineno == line):
        texts = [*map(ast.unparse, call.args)]
        named = [ast.unparse(keyword) for keyword in call.keywords]
        ways = []
        for first, second in itertools.combinations(range(len(texts)), 2):
            new = [*texts]
            new[first], new[second] = texts[second], texts[first]
            ways.append(call_with(call, new, named))
        early = [n for n, value in enumerate(call.args) if isinstance(value, ast.Call)]
        for number in early:
            inner = call.args[number]
            assert isinstance(inner, ast.Call)
            given = [ast.unparse(inner.func), *map(ast.unparse, (*inner.args, *inner.keywords))]
            ways.append(call_with(call, [*texts[:number], *given, *texts[number + 1 :]], named))
        if good := first_that_stands(source, call, ways):
            is_early = ways.index(good) >= len(ways) - len(early)
            why = "the function is called right here" if is_early else "its arguments are in the wrong order"
            cause = f"{ast.unparse(call.func)}() is given a value where it needs the function to call: {why}."
            yield Finding("argument-order", cause, source.at(call), f"write `{good}`")
            return


def _given_calls(sources: NodeSources, source: PythonSource) -> Iterator[_Given]:
    """Yield calls that are arguments, except instances of classes; rclpy creations and log calls are skipped."""
    made = {id(creation.call) for creation in sources.creations}
    for owner, _, node in sources.scoped(source):
        if not isinstance(node, ast.Call) or id(node) in made or is_log(node):
            continue
        values = [
            *(("", argument) for argument in node.args),
            *((keyword.arg or "", keyword.value) for keyword in node.keywords),
        ]
        for name, value in values:
            if isinstance(value, ast.Call) and not _is_class(sources, source, value):
                function = called_function(sources, source, owner, value.func)
                is_void = function is not None and gives_no_function(function, value)
                if function is None or is_void:
                    yield _Given(node, value, name, function, is_void)


def _is_class(sources: NodeSources, source: PythonSource, call: ast.Call) -> bool:
    """Return whether a call makes an instance of a class of the workspace, a message or a built-in type."""
    name = sources.resolve(source, call.func) or ""
    return name in sources.classes or is_interface(name) or hasattr(builtins, name)


def _called(source: PythonSource, given: list[_Given]) -> Iterator[Finding]:
    (revealed,) = checked(source, [revealing(source, [argument.call for argument in given])])
    void = [g for g in given if g.is_void or _has(revealed, "revealed-type", g.call, _NOTHING)]
    # A coroutine stays: it is no function, but some parameters take one as well.
    others = [Edit(g.call, ast.unparse(g.call) if g.is_coroutine else "object()").of(source) for g in void]
    for given_call, rows in zip(void, checked(source, others) if others else (), strict=True):
        refused = _has(rows, "invalid-argument-type", given_call.call, _FUNCTION)
        if refused:
            kinds = re.sub(r"\[.*?\]", "", refused["passed"] or "")
            yield _finding(source, given_call, len(re.findall(r"\w+(?: \| \w+)*", kinds)))
        elif _is_callback(source, given_call):
            yield _finding(source, given_call, 1)  # rclpy passes one value to those that have no types


def _is_callback(source: PythonSource, given: _Given) -> bool:
    """Return whether a parameter is a callback by its name, as those of action servers, which have no types."""
    outer = ast.unparse(given.outer.func).rpartition(".")[2]
    if outer.startswith("add_") and outer.endswith("_callback"):  # as a future has it
        return True
    signature = signature_of(source, given.outer)
    index = next((n for n, value in enumerate(given.outer.args) if value is given.call), -1)
    if signature is None or (index < 0 and not given.name):
        return given.name.endswith("callback") and not given.is_coroutine
    named = signature.named(given.name) if given.name else next(iter(signature.places[index:]), None)
    return named is not None and named.name.endswith("callback") and heads_of(named.type) <= {"Callable", ""}


def _has(rows: list[Row], rule: str, node: ast.expr, said: re.Pattern[str]) -> re.Match[str] | None:
    found = (said.search(row.said) for row in rows if row.line == node.lineno and row.rule == rule)
    return next(filter(None, found), None)


def _finding(source: PythonSource, given: _Given, passed: int) -> Finding:
    call, outer = given.call, ast.unparse(given.outer.func)
    text = ast.unparse(call)
    clause, written = as_function(given.function, call, ["value", "other", "third"][:passed])
    cause = f"`{text}` is called right here, {clause}, but {outer}() needs a function to call later."
    fix = f"write `{f'{given.name}=' if given.name else ''}{written}`"
    # Something else may await what a coroutine function returns.
    is_async = isinstance(given.function, ast.AsyncFunctionDef) and given.function in source.nodes
    never = (source.at(given.function),) if is_async else ()
    return Finding("callback-called", cause, source.at(call), fix, never=never)
