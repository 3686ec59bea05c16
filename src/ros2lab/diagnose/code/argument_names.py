"""Arguments in the wrong order, recognised by comparing their names with those of the parameters."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.own_functions import called_function
from ros2lab.diagnose.sources.python_source import Function, PythonSource, parameters, walk


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
