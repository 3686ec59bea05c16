"""Find the function of the student's files that a call means, and what it returns."""

from __future__ import annotations

import ast
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.one_run import reaches_end
from ros2lab.diagnose.sources.python_source import (
    YIELDS,
    Function,
    PythonSource,
    assigned_to,
    is_generator,
    last_name,
    own_nodes,
    parameters,
    read_source,
    returns_value,
)
from ros2lab.diagnose.sources.syntax_parts import by_parameter, needed_by, own_parameters

_Kind = TypeVar("_Kind", bound=ast.stmt)
_FUNCTIONS: tuple[type[Function], ...] = (ast.FunctionDef, ast.AsyncFunctionDef)
# Expressions whose values nothing can call.
_VALUES = (ast.Constant, ast.JoinedStr, ast.Compare, ast.List, ast.Tuple, ast.Dict, ast.Set)


def own_function(source: PythonSource, called: ast.AST) -> tuple[PythonSource, Function] | None:
    """Return the function that a name or `self.name` means, and its file: this one or another of its package.

    On an object of a class from these files, it is the method of that class. None if there is none.
    """
    if isinstance(called, ast.Attribute) and (method := _method(source, called)):
        return method
    name = last_name(called)
    if isinstance(called, ast.Name) or ast.unparse(called) == f"self.{name}":
        found = [node for node in source.nodes if isinstance(node, Function) and node.name == name]
        if len(found) == 1:
            return source, found[0]
    return _at_top(source, called, *_FUNCTIONS)


def called_function(
    sources: NodeSources, source: PythonSource, owner: NodeClass | None, called: ast.expr
) -> Function | None:
    """Return the function of a package that a call means: a method of the class around it, or one by its name."""
    if is_self_attribute(called):
        return sources.method(owner, called.attr)
    return sources.functions.get(sources.resolve(source, called) or "", (source, None))[1]


def _method(source: PythonSource, called: ast.Attribute) -> tuple[PythonSource, Function] | None:
    """Return the method of an object that is made once from a class in these files: `robot = Robot()`."""
    owner = ast.unparse(called.value)
    made = assigned_to(source.nodes, owner)
    if len({ast.unparse(value) for value in made}) != 1 or not isinstance(made[0], ast.Call):
        return None
    own = source.classes.get(ast.unparse(made[0].func))
    home = (source, own) if own else _at_top(source, made[0].func, ast.ClassDef)
    for node in home[1].body if home else ():
        if home and isinstance(node, Function) and node.name == called.attr:
            return home[0], node
    return None


def _at_top(source: PythonSource, named: ast.AST, *kinds: type[_Kind]) -> tuple[PythonSource, _Kind] | None:
    """Return the definition of a name imported from another file of the package, and that file."""
    module, _, name = (source.resolve(named) or "").rpartition(".")
    home = _file_of(source, module)
    top = home.tree.body if home else ()
    of_kind = (node for node in top if isinstance(node, kinds))
    found = next((node for node in of_kind if getattr(node, "name", "") == name), None)
    return (home, found) if home and found else None


def _file_of(source: PythonSource, module: str) -> PythonSource | None:
    """Return the file of a module in the package of another file; None if there is none."""
    above = source.path.parents[:3] if source.path else ()
    for folder in above if module else ():
        path = folder.joinpath(*module.split(".")).with_suffix(".py")
        if path.is_file():
            shown = os.path.normpath(Path(source.shown, os.path.relpath(path, source.path)))
            return read_source(path, module, shown)
    return None


def unused_function(source: PythonSource, line: int) -> str:
    """Return the only function that a line may pass on and that nothing uses, as `self.tick` or `tick`; else empty.

    The methods of the class around the line come first, then the functions beside it.
    """
    kinds = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    around = [n for n in source.nodes if isinstance(n, kinds) and n.lineno <= line <= (n.end_lineno or 0)]
    used = {last_name(node) for node in source.nodes}
    for scope in sorted(around, key=lambda node: not isinstance(node, ast.ClassDef)):
        functions = [n for n in scope.body if isinstance(n, ast.FunctionDef) and not n.decorator_list]
        free = [n.name for n in functions if n.name not in used and not n.name.startswith("__")]
        if free:
            before = "self." if isinstance(scope, ast.ClassDef) else ""
            return f"{before}{free[0]}" if len(free) == 1 else ""
    free = [
        n.name for n in source.tree.body if isinstance(n, ast.FunctionDef) and n.name not in {*used, "main"}
    ]
    return free[0] if len(free) == 1 else ""


def held_once(source: PythonSource, named: ast.expr) -> tuple[PythonSource, ast.expr] | None:
    """Return the only expression assigned to a name, also in a class's body, and its file: this one, or one it is imported from."""
    if not isinstance(named, (ast.Name, ast.Attribute)):
        return None
    module, _, name = (source.resolve(named) or "").rpartition(".")
    home = _file_of(source, module)
    text = name if home else ast.unparse(named)
    home = home or source
    values = assigned_to(home.nodes, text)
    if not values and isinstance(named, ast.Attribute):
        bodies = [node.body for node in home.nodes if isinstance(node, ast.ClassDef)]
        values = assigned_to((statement for body in bodies for statement in body), named.attr)
    return (home, values[0]) if len(values) == 1 else None


def returned(function: Function) -> list[ast.AST]:
    """Return the `return` statements with a value and the `yield` expressions of a function."""
    return [
        n
        for n in own_nodes(function)
        if isinstance(n, YIELDS) or (isinstance(n, ast.Return) and n.value is not None)
    ]


def is_wrapped(function: Function) -> bool:
    """Return whether a decorator or an assignment may make something else of a function than its body says."""
    return getattr(function, "is_wrapped", bool(function.decorator_list))


def gives_no_function(function: Function, call: ast.Call) -> bool:
    """Return whether a call of a function of these files fails, or returns what nothing can call later."""
    if is_wrapped(function):
        return False
    if isinstance(function, ast.AsyncFunctionDef) or not returns_value(function):
        return True
    values = [node.value for node in own_nodes(function) if isinstance(node, ast.Return)]
    if len(values) < len(returned(function)):
        return True  # it yields
    given = [value for value in values if value is not None]
    if lacking(function, call):
        return all(_is_data(function, value) for value in given)
    return all(isinstance(value, _VALUES) for value in given)


def _is_data(function: Function, value: ast.expr) -> bool:
    """Return whether a function returns data, as a callback does: a message, a parameter, a text, a number."""
    match value:
        case ast.Call(func=called):
            return ast.unparse(called).rpartition(".")[2][:1].isupper()
        case ast.Attribute(attr=name):
            return name.isupper()
        case ast.Name(id=name):
            made = [n for n in assigned_to(own_nodes(function), name) if not isinstance(n, ast.Name)]
            is_given = any(parameter.arg == name for parameter in parameters(function))
            return (is_given or bool(made)) and all(_is_data(function, inner) for inner in made)
    return isinstance(value, _VALUES)


def what_a_call_makes(function: Function) -> str:
    """Return what a call of a function makes instead of running it: a coroutine or a generator; empty if it runs it.

    What a wrapped function makes is not known.
    """
    is_async, yields = isinstance(function, ast.AsyncFunctionDef), is_generator(function)
    if is_wrapped(function) or is_async == yields:
        return ""
    return "coroutine" if is_async else "generator"


def lacking(function: Function, call: ast.Call) -> list[str]:
    """Return the parameters without defaults to which a call gives no value."""
    if any(isinstance(value, ast.Starred) for value in call.args) or None in {k.arg for k in call.keywords}:
        return []
    needed = needed_by(function)[len(call.args) :]
    return [name for name in needed if name not in {keyword.arg for keyword in call.keywords}]


def as_function(function: Function | None, call: ast.Call, passed: Sequence[str]) -> tuple[str, str]:
    """Return why a call that stands for a function is wrong, and what to write instead if that is called later with what is `passed`."""
    missing = lacking(function, call) if function else []
    clause = "so its return value, None, is passed on"
    if missing:
        clause = f"and without {' and '.join(missing)}"
    elif function and (returns_value(function) or isinstance(function, ast.AsyncFunctionDef)):
        clause = "so what it returns is passed on"
    is_bare, needed = not (call.args or call.keywords), needed_by(function) if function else []
    is_ready = is_bare if function is None or not passed else len(needed) == len(passed)
    if is_bare and function and len(needed) < len(passed):
        is_ready = bool(function.args.vararg) or len(own_parameters(function)) >= len(passed)
    if is_ready:
        return clause, ast.unparse(call.func)
    given = by_parameter(call, needed)
    named = [ast.unparse(given[n]) for n in needed if isinstance(given.get(n), ast.Name)][-len(passed) :]
    names = missing if len(missing) == len(passed) else named if len(named) == len(passed) else [*passed]
    called = ast.Call(call.func, [*call.args, *map(ast.Name, missing * (names is missing))], call.keywords)
    return clause, f"lambda {', '.join(names)}".strip() + f": {ast.unparse(called)}"


def may_fall_through(function: Function) -> bool:
    """Return whether a function may reach its end and return None."""
    if is_wrapped(function) or is_generator(function):
        return False
    return not returned(function) or reaches_end(function.body)
