"""What a function's parameters are given, where all its calls can be seen."""

from __future__ import annotations

import ast
from collections import Counter, defaultdict
from collections.abc import Collection
from functools import cached_property

from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import Function, is_generator


class Arguments:
    """The arguments of the calls in some files.

    Args:
        sources: the files.
        code: the code that runs; only calls in it count.
    """

    def __init__(self, sources: NodeSources, code: Collection[ast.AST]) -> None:
        self._sources = sources
        self._code = code

    def of(self, function: Function, name: str) -> list[ast.expr] | None:
        """Return what a parameter is given; None if something else may call the function."""
        calls = self._all_calls(function)
        if calls is None:
            return None
        found = [given_to(function, call, name) for call in calls]
        if any(given is None for given in found):
            return None
        return [given for call, given in zip(calls, found, strict=True) if given and call in self._code]

    def only_call(self, function: Function) -> ast.Call | None:
        """Return the call before whose end all of a function runs, if nothing else uses it; else None."""
        calls = self._all_calls(function) or []
        return calls[0] if len(calls) == 1 and not is_generator(function) else None

    def _all_calls(self, function: Function) -> list[ast.Call] | None:
        """Return the calls of a function; None if anything else may call it, too."""
        own, is_plain = function.name, isinstance(function, ast.FunctionDef) and not function.decorator_list
        is_plain &= not own.startswith("__")  # Python calls those, too
        calls = self._calls[own]
        is_all = is_plain and self._defined[own] == 1 and calls and self._named[own] == len(calls)
        return calls if is_all else None

    @cached_property
    def _nodes(self) -> list[ast.AST]:
        return [node for source in self._sources.sources.values() for node in source.nodes]

    @cached_property
    def _calls(self) -> dict[str, list[ast.Call]]:
        found: dict[str, list[ast.Call]] = defaultdict(list)
        for node in self._nodes:
            if isinstance(node, ast.Call):
                found[_name(node.func)].append(node)
        return found

    @cached_property
    def _named(self) -> Counter[str]:
        """How often each name is used; also in a text, by which something may be looked up."""
        texts = (str(node.value) for node in self._nodes if isinstance(node, ast.Constant))
        return Counter([*filter(None, map(_name, self._nodes)), *filter(str.isidentifier, texts)])

    @cached_property
    def _defined(self) -> Counter[str]:
        kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
        return Counter(node.name for node in self._nodes if isinstance(node, kinds))


def given_to(function: Function, call: ast.Call, name: str) -> ast.expr | None:
    """Return what a call gives to a parameter, or its default; None if that cannot be told."""
    takes = function.args
    named = {keyword.arg: keyword.value for keyword in call.keywords}
    if None in named or any(isinstance(argument, ast.Starred) for argument in call.args):
        return None
    places = [parameter.arg for parameter in (*takes.posonlyargs, *takes.args)]
    defaults = dict(zip(reversed(places), reversed(takes.defaults), strict=False))
    defaults |= {
        parameter.arg: value
        for parameter, value in zip(takes.kwonlyargs, takes.kw_defaults, strict=True)
        if value is not None
    }
    if places[:1] == ["self"]:
        places = places[1:]
    by_place = dict(zip(places, call.args, strict=False))
    return by_place.get(name) or named.get(name) or defaults.get(name)


def is_refused(function: Function, call: ast.Call) -> bool:
    """Return whether a function does not take the arguments of a call."""
    takes = function.args
    is_open = any(isinstance(argument, ast.Starred) for argument in call.args)
    if is_open or any(keyword.arg is None for keyword in call.keywords):
        return False
    places = [parameter.arg for parameter in (*takes.posonlyargs, *takes.args)]
    places = places[places[:1] == ["self"] :]
    only_named = [parameter.arg for parameter in takes.kwonlyargs]
    named = {keyword.arg for keyword in call.keywords}
    is_too_long = len(call.args) > len(places) and takes.vararg is None
    is_unknown = not named <= {*places, *only_named} and takes.kwarg is None
    needed = [
        *places,
        *(name for name, value in zip(only_named, takes.kw_defaults, strict=True) if value is None),
    ]
    return is_too_long or is_unknown or any(given_to(function, call, name) is None for name in needed)


def _name(node: ast.AST) -> str:
    match node:
        case ast.Name(id=name, ctx=ast.Load()) | ast.Attribute(attr=name, ctx=ast.Load()):
            return name
    return ""
