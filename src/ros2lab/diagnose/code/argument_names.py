"""Arguments of calls that are in the wrong order by their names, or have names that the function does not take."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterator
from functools import lru_cache

from ros2lab.diagnose.code.unknown_names import as_code, written_with
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.own_functions import called_function
from ros2lab.diagnose.sources.python_source import Function, PythonSource, given_to, parameters, walk
from ros2lab.diagnose.sources.signatures import Signature, signature_of
from ros2lab.diagnose.sources.spelling import nearest, same_letters
from ros2lab.diagnose.sources.syntax_parts import calls_in


def argument_name_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield calls of the package's own functions in which two arguments are swapped."""
    calls = [
        (source, node, function, takes)
        for source in sources.sources.values()
        for owner, inside, node in sources.scoped(source)
        if isinstance(node, ast.Call) and len(node.args) > 1
        for function, takes in [_called(sources, source, owner, node)]
        if function not in (None, inside)
        and not any(isinstance(argument, ast.Starred) for argument in node.args)
    ]
    # A function that is also called in order, as `plan(start, goal)`, takes `plan(goal, start)` on purpose.
    both = {
        id(function)
        for _, node, function, takes in calls
        if sum(_name_of(argument) == name for argument, name in zip(node.args, takes, strict=False)) > 1
    }
    for source, node, function, takes in calls:
        right = _in_order(takes, node.args)
        if right is not None and function is not None and id(function) not in both:
            new = ", ".join([*map(ast.unparse, right), *(ast.unparse(keyword) for keyword in node.keywords)])
            given = {
                _name_of(argument): parameter for argument, parameter in zip(node.args, takes, strict=False)
            }
            moved = {name: parameter for name, parameter in given.items() if name in {*takes} - {parameter}}
            passed = " and ".join(f"{name} as {parameter}" for name, parameter in moved.items())
            cause = f"{function.name}() takes {', '.join(takes)} in this order, so `{ast.unparse(node)}` passes {passed}."
            fix = f"write `{ast.unparse(node.func)}({new})`"
            is_sure = len(moved) == 2  # one name alone may be meant for the other place
            yield Finding(
                "argument-order", cause, source.at(node), fix if is_sure else f"if that is not meant, {fix}"
            )


def _called(
    sources: NodeSources, source: PythonSource, owner: NodeClass | None, call: ast.Call
) -> tuple[Function | None, list[str]]:
    """Return the package's function that a call means, and its parameters' names; None if it is unknown."""
    made = sources.classes.get(sources.resolve(source, call.func) or "")
    function = called_function(sources, source, owner, call.func)
    function = sources.method(made, "__init__") if made else function
    is_method = made is not None or is_self_attribute(call.func)
    if function is None or (is_method and function.decorator_list):
        return None, []
    return function, [parameter.arg for parameter in parameters(function)[is_method:]]


def _in_order(takes: list[str], given: list[ast.expr]) -> list[ast.expr] | None:
    """Return arguments in the order of the parameters named like them; None if they are, or in doubt."""
    names = [_name_of(argument) for argument in given]
    strangers = [
        name for name, parameter in zip(names, takes, strict=False) if name in {*takes} - {parameter}
    ]
    if len(strangers) > 2:
        return None  # where several change places, as the coordinates of two points do, it is seldom a slip
    for first, name in enumerate(names[: len(takes)]):
        second = takes.index(name) if name in takes else first
        if second in (first, *range(len(given), len(takes))) or names[second] == takes[second]:
            continue
        # Each is named after the other's parameter; a number has no name, so that one alone must tell.
        is_number = isinstance(getattr(given[second], "operand", given[second]), ast.Constant)
        is_alone = is_number and _is_own_name(given[first]) and _is_strange(name, takes[first])
        if names[second] == takes[first] or is_alone:
            right = list(given)
            right[first], right[second] = right[second], right[first]
            return right
    return None


def _is_strange(name: str, parameter: str) -> bool:
    """Return whether an argument's name is another word than its parameter's, and not only another number of it."""
    words, known = ({*re.findall("[a-z]+", text.lower())} for text in (name, parameter))
    return not words <= known


def _is_own_name(node: ast.expr) -> bool:
    """Return whether an expression's name was given to it in this class, and is not that of a field of another."""
    return not isinstance(node, ast.Attribute) or is_self_attribute(node) or isinstance(node.value, ast.Call)


def _name_of(node: ast.expr) -> str:
    """Return the name of an expression's variable, attribute or ROS parameter; empty if it says nothing."""
    for inner in walk(node):
        if isinstance(inner, ast.Call) and getattr(inner.func, "attr", "") == "get_parameter" and inner.args:
            return str(getattr(inner.args[0], "value", ""))
    name = node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""
    return name if len(name) > 1 else ""


def refused_keywords(source: PythonSource) -> Iterator[Finding]:
    """Yield the keyword arguments in a file that the called function of Python or setuptools refuses."""
    for call in source.nodes:
        if isinstance(call, ast.Call) and call.keywords:
            name = source.resolve(call.func) or ""
            taken = _taken(name)
            for keyword in call.keywords if taken is not None else ():
                if keyword.arg and keyword.arg not in (taken or ()):
                    yield _refused(source, call, keyword, name.rpartition(".")[2], taken or frozenset())


def _refused(
    source: PythonSource, call: ast.Call, keyword: ast.keyword, name: str, taken: frozenset[str]
) -> Finding:
    near = nearest(keyword.arg, taken - {other.arg for other in call.keywords})
    cause = f"{name}() has no argument called {keyword.arg}."
    value = ast.get_source_segment(source.text, keyword.value) or ast.unparse(keyword.value)
    fix = f"remove {keyword.arg}={value}; {name}() takes {', '.join(sorted(taken))}"
    if moved := moved_keyword(source, call, keyword.arg or ""):
        cause, fix = f"{cause} It is one of {moved[0]}().", moved[1]
    elif near:
        cause, fix = f"{cause} Did you mean {near}?", written_with(source, keyword, f"{near}={value}")
    return Finding("argument-unknown", cause, source.at(keyword), fix)


# To import setuptools takes longer than to check a workspace.
_OF_SETUPTOOLS = dict.fromkeys(
    ("setuptools.find_packages", "setuptools.find_namespace_packages"),
    frozenset(("where", "exclude", "include")),
)


@lru_cache(maxsize=64)
def _taken(name: str) -> frozenset[str] | None:
    """Return the names of the arguments of a function; None if it takes any, or if it is not known."""
    module, _, function = name.rpartition(".")
    home = interfaces.own_module(module)
    if home is None:
        return _OF_SETUPTOOLS.get(name)
    try:
        parameters = inspect.signature(getattr(home, function)).parameters.values()
    except (AttributeError, TypeError, ValueError):
        return None
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in parameters):
        return None
    return frozenset(p.name for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY))


def moved_keyword(source: PythonSource, call: ast.Call, name: str) -> tuple[str, str] | None:
    """Return the call that a keyword argument belongs to, and what to write; None if it is that of no call near by."""
    keyword = next((given for given in call.keywords if given.arg == name), None)
    if keyword is None:
        return None
    for other in _near(source, call):
        signature = signature_of(source, other)
        wanted = _parameter(signature, name) if signature else ""
        if wanted and wanted not in {given.arg for given in other.keywords}:
            owner = ast.unparse(other.func)
            value = f"{wanted}={source.segment(keyword.value)}"
            is_outer = call in ast.walk(other)
            whole = as_code(_moved(other if is_outer else call, call, keyword, other, wanted))
            where = f"the parentheses of {owner}() on line {other.lineno}"
            told = (
                f"write {whole}"
                if whole
                else f"write `{' '.join(value.split())}` in {where}, and remove it here"
            )
            return owner, told
    return None


def _near(source: PythonSource, call: ast.Call) -> Iterator[ast.Call]:
    """Yield the calls that a call is an argument of, the nearest first, and those that are its own arguments."""
    node: ast.AST | None = call
    while node is not None and not isinstance(node, ast.stmt):
        node = source.above(node)
        if isinstance(node, ast.Call):
            yield node
    for value in given_to(call):
        yield from calls_in(ast.walk(value))


def _parameter(signature: Signature, name: str) -> str:
    names = [parameter.name for parameter in signature.parameters]
    return name if name in names else next((known for known in names if same_letters(known, name)), "")


def _moved(outer: ast.Call, call: ast.Call, keyword: ast.keyword, other: ast.Call, wanted: str) -> str:
    """Return the outer of two calls as it is written when a keyword argument of one is given to the other."""
    place = call.keywords.index(keyword)
    call.keywords.remove(keyword)
    other.keywords.append(ast.keyword(wanted, keyword.value))
    try:
        return ast.unparse(outer)
    finally:
        other.keywords.pop()
        call.keywords.insert(place, keyword)
