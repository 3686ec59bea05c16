"""Values computed once, when a function or class is defined, but meant to be new for each call or object."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    assignments,
    names_bound,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import changed_by, defaults_of

# Standard modules whose functions return a new value each time; capitalised names are classes.
_CHANGING = frozenset(("time", "random", "secrets", "uuid"))
_STEADY = frozenset(("strptime", "mktime", "strftime", "uuid3", "uuid5", "seed", "get_clock_info"))
_OF_CLASSES = frozenset(
    f"datetime.{name}" for name in ("datetime.now", "datetime.today", "datetime.utcnow", "date.today")
)
_LITERALS = (ast.List, ast.Dict, ast.Set)


def defined_once(sources: NodeSources) -> Iterator[Finding]:
    """Yield defaults and class fields that all calls or objects share, but each should have for itself."""
    for source in sources.sources.values():
        for owner, _, node in sources.scoped(source):
            if isinstance(node, Function):
                yield from _defaults(source, owner, node)
            elif isinstance(node, ast.ClassDef):
                yield from _fields(sources, source, node)


def _defaults(source: PythonSource, owner: NodeClass | None, function: Function) -> Iterator[Finding]:
    for name, default in defaults_of(function).items():
        first = f"write {name}=None here, and `if {name} is None: {name} = {ast.unparse(default)}` as the first line of {function.name}()"
        if call := _changing(source, default):
            cause = f"The default {ast.unparse(call)} is computed once, when {function.name}() is defined, so each call without {name} gets the same value."
            yield Finding("computed-once", cause, source.at(default), first)
        elif _is_literal(default) and (changed := _changed(owner, function, name)):
            cause = f"All calls of {function.name}() without {name} share one {ast.unparse(default)}, and line {changed} changes it for all of them."
            yield Finding("one-object", cause, source.at(default), first)


def _changing(source: PythonSource, value: ast.expr) -> ast.Call | None:
    """Return the first call in an expression that returns a new value each time; None if there is none."""
    for node in (value, *own_nodes(value)):
        if isinstance(node, ast.Call) and not isinstance(value, ast.Lambda):
            name = source.resolve(node.func) or ""
            module, _, short = name.partition(".")
            is_function = module in _CHANGING and short.isidentifier() and short[:1].islower()
            if (is_function and short not in _STEADY) or name in _OF_CLASSES:
                return node
    return None


def _is_literal(value: ast.expr) -> bool:
    is_call = isinstance(value, ast.Call) and dotted(value.func) in ("list", "dict", "set") and not value.args
    return isinstance(value, _LITERALS) or is_call


def _changed(owner: NodeClass | None, function: Function, name: str) -> int:
    """Return the line that changes a default in place, in the function or as an attribute; 0 if none does."""
    nodes = own_nodes(function)
    if name in names_bound(nodes):
        return 0  # the name may refer to another object by then
    # Setting items of a dict or a list by key is how a cache works.
    if line := _line_of_change([node for node in nodes if not isinstance(node, ast.Subscript)], name):
        return line
    pairs = assignments(nodes)
    targets = [dotted(target) or "" for target, value in pairs if getattr(value, "id", "") == name]
    kept = [target for target in targets if target.startswith("self.")]
    if owner is None or len(kept) != 1:
        return 0
    found = [node for method in owner.functions for node in walk(method)]
    is_sole = [dotted(n) for n in found if isinstance(getattr(n, "ctx", None), ast.Store)].count(kept[0]) == 1
    return _line_of_change(found, kept[0]) if is_sole else 0


def _line_of_change(nodes: Iterable[ast.AST], name: str) -> int:
    return next((getattr(node, "lineno", 0) for node in nodes if dotted(changed_by(node)) == name), 0)


def _fields(sources: NodeSources, source: PythonSource, definition: ast.ClassDef) -> Iterator[Finding]:
    """Yield class fields that are computed once, although each object reads them as its own."""
    decorators = [getattr(decorator, "func", decorator) for decorator in definition.decorator_list]
    is_data = "dataclasses.dataclass" in map(source.resolve, decorators)
    for statement in definition.body:
        if not isinstance(statement, (ast.Assign, ast.AnnAssign)) or statement.value is None:
            continue
        target = statement.target if isinstance(statement, ast.AnnAssign) else statement.targets[0]
        call = _changing(source, statement.value)
        is_field = is_data and isinstance(statement, ast.AnnAssign) and "ClassVar" not in ast.dump(statement)
        if call is None or not isinstance(target, ast.Name):
            continue
        name, value = target.id, ast.unparse(statement.value)
        cause = f"{value} is computed once, when the class {definition.name} is defined, so all its instances have the same {name}."
        if is_field:
            fix = f"write field(default_factory=lambda: {value}) instead of {value}, and `from dataclasses import field`"
            yield Finding("computed-once", cause, source.at(statement), fix)
        elif len(sources.calls_to(f"{source.name}.{definition.name}")) > 1 and _is_read(definition, name):
            fix = f"write `self.{name} = {value}` in __init__ instead"
            yield Finding("computed-once", cause, source.at(statement), fix)


def _is_read(definition: ast.ClassDef, name: str) -> bool:
    """Return whether the methods of a class read an attribute of self and none of them sets it."""
    found = [n for n in walk(definition) if isinstance(n, ast.Attribute) and dotted(n) == f"self.{name}"]
    return bool(found) and all(isinstance(attribute.ctx, ast.Load) for attribute in found)
