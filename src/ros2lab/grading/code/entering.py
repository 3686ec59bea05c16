"""Which conditions hold where a function begins: those that hold at its only call."""

from __future__ import annotations

import ast
import operator
from collections.abc import Mapping
from typing import Any

from ros2lab.diagnose.sources.node_source import is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, given_to, parameters
from ros2lab.grading.code import arguments
from ros2lab.grading.code.cases import leaves, text_of
from ros2lab.grading.code.possible import Fact, Facts, Possible


def entering(possible: Possible, function: Function, call: ast.Call, facts: Facts) -> Facts:
    """Return the facts of a call that are about what the function is given, by the names that it gives to that, or about self.

    Empty, if anything else may call the function, or if it runs later.
    """
    if not facts or possible.is_open or possible.arguments.only_call(function) is not call:
        return ()
    names = [parameter.arg for parameter in parameters(function)]
    own = {name: arguments.given_to(function, call, name) for name in names}
    renamed = {text_of(given): name for name, given in own.items() if given in given_to(call)}
    is_of_self = is_self_attribute(call.func) and names[:1] == ["self"]
    told = ((_renamed(test, renamed), truth) for test, truth in facts)
    return tuple(fact for fact in told if _is_known_inside(possible, fact, is_of_self=is_of_self))


def _is_known_inside(possible: Possible, fact: Fact, *, is_of_self: bool) -> bool:
    """Return whether a renamed fact is only about what a function is given, and self."""
    for leaf in leaves(fact[0]):
        root: ast.expr = leaf
        while isinstance(root, ast.Attribute):
            root = root.value
        is_given = isinstance(root, ast.Name) and root not in possible.scopes
        is_self = is_of_self and isinstance(leaf, ast.Attribute) and getattr(root, "id", "") == "self"
        if not (is_given or is_self):
            return False
    return True


def _renamed(part: Any, names: Mapping[str, str]) -> Any:
    """Return a node with other names for some of its parts; what has none of these stays the same node."""
    if isinstance(part, list):
        return [_renamed(item, names) for item in part]
    if not isinstance(part, ast.AST):
        return part
    if isinstance(part, (ast.Name, ast.Attribute)) and (name := names.get(text_of(part))):
        return ast.Name(name, ast.Load())
    fields = dict(ast.iter_fields(part))
    other = {field: _renamed(value, names) for field, value in fields.items()}
    is_same = all(
        value is other[field] or (isinstance(value, list) and all(map(operator.is_, value, other[field])))
        for field, value in fields.items()
    )
    return part if is_same else type(part)(**other)
