"""Iterators that are iterated over again after they have been used up."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources
from ros2lab.diagnose.sources.one_run import may_leave
from ros2lab.diagnose.sources.python_source import (
    PAUSES,
    Function,
    PythonSource,
    assignments,
    is_generator,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.uses import State, Uses, uses_of

_MAKERS = frozenset(
    ("map", "zip", "filter", "enumerate", "reversed", "iter", "open", "csv.reader", "csv.DictReader")
)
_TAKERS = frozenset(("list", "tuple", "set", "sorted", "sum", "max", "min", "dict", "frozenset"))
_LOOPS = (ast.For, ast.AsyncFor, ast.While)
_COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp)


def one_time_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield iterators that are iterated over a second time, when nothing is left in them."""
    if any(source.fault for source in sources.sources.values()):
        return
    uses = uses_of(sources)
    for owner in sources.classes.values():
        yield from _kept(uses, owner)
    for source in sources.sources.values():
        for node in source.nodes:
            if isinstance(node, Function):
                yield from _walked_twice(sources, source, node)


def _kept(uses: Uses, owner: NodeClass) -> Iterator[Finding]:
    """Yield iterators that `__init__` keeps and a callback iterates over each time it is called."""
    state = State(uses, owner)
    for text in state.stores:
        value = state.initial(text)
        if text.count(".") != 1 or value is None or not _is_once(uses.sources, owner.source, value):
            continue
        readers = state.loads.get(text, [])
        if any(not _is_all(method, node) for method, node in readers):
            continue
        for method, _ in readers:
            if id(method) in uses.callbacks and not _stops(method):
                yield _finding(
                    owner.source,
                    value,
                    text,
                    f"{method.name}() is called repeatedly: from the second call on",
                )
                break


def _walked_twice(sources: NodeSources, source: PythonSource, function: Function) -> Iterator[Finding]:
    """Yield iterators in a variable that are iterated over twice, or in every pass of a loop."""
    nodes = own_nodes(function)
    for made, value in assignments(nodes):
        if not isinstance(made, ast.Name) or not _is_once(sources, source, value):
            continue
        name = made.id
        others = [n for n in walk(function) if isinstance(n, ast.Name) and n.id == name and n is not made]
        if not others or not all(_is_all(function, other) for other in others):
            continue  # also where it is assigned twice
        loads = sorted(others, key=lambda load: (load.lineno, load.col_offset))
        first, loops = loads[0], [n for n in nodes if isinstance(n, _LOOPS) and made not in walk(n)]
        around = [n for n in loops if any(first in walk(s) for s in n.body)]
        if around and not may_leave(around[-1].body, *PAUSES):
            yield _finding(source, value, name, "this is inside a loop: from the second pass on")
        elif len(loads) > 1 and _is_sure(function, first, loads[1]):
            yield _finding(source, value, name, f"line {first.lineno} has used it up: here")


def _finding(source: PythonSource, value: ast.expr, name: str, then: str) -> Finding:
    written = ast.unparse(value)
    what = "A file" if written.startswith("open(") else f"The result of `{written[:60]}`"
    cause = f"{what} can be iterated over only once, and {then}, {name} has nothing left."
    if isinstance(value, ast.GeneratorExp):
        kept = f"[{written[1:-1]}]"
    else:
        kept = f"{written}.readlines()" if written.startswith("open(") else f"list({written})"
    return Finding("used-up", cause, source.at(value), f"write {name} = {kept}")


def _is_once(sources: NodeSources, source: PythonSource, value: ast.expr) -> bool:
    """Return whether an expression makes an iterator that can be used only once."""
    if isinstance(value, ast.GeneratorExp):
        return True
    if not isinstance(value, ast.Call):
        return False
    name = sources.resolve(source, value.func) or dotted(value.func) or ""
    if name in sources.functions:
        function = sources.functions[name][1]
        is_made = not function.decorator_list and isinstance(function, ast.FunctionDef)
        return is_made and is_generator(function)
    return name in _MAKERS and not (name == "iter" and len(value.args) > 1)


def _is_all(function: Function, load: ast.AST) -> bool:
    """Return whether an iterator is consumed completely where it is read."""
    for node in walk(function):
        match node:
            case ast.For(iter=given, body=body) if given is load:
                return not may_leave(body, *PAUSES)
            case ast.comprehension(iter=given) if given is load:
                return any(
                    node in comprehension.generators
                    for comprehension in walk(function)
                    if isinstance(comprehension, _COMPREHENSIONS)
                )
            case ast.Call(func=ast.Name(id=name), args=[given]) if given is load and name in _TAKERS:
                return True
            case ast.Call(func=ast.Attribute(attr="join"), args=[given]) if given is load:
                return True
            case ast.For(iter=ast.Call(func=ast.Name(id="enumerate"), args=[given, *_]), body=body) if (
                given is load
            ):
                return not may_leave(body, *PAUSES)
    return False


def _stops(function: Function) -> bool:
    """Return whether a callback may keep itself from being called again, or rewind the file."""
    names = {getattr(n, "attr", "") for n in walk(function)}
    return not names.isdisjoint(("cancel", "destroy_timer", "destroy_subscription", "shutdown", "seek"))


def _is_sure(function: Function, first: ast.AST, second: ast.AST) -> bool:
    """Return whether the first use is always reached, and finished before the second."""
    kinds = (*_LOOPS, ast.If, ast.Try, ast.IfExp, ast.BoolOp, Function, ast.Lambda, ast.Match)
    for node in walk(function):
        if not isinstance(node, kinds) or node is function or first not in walk(node):
            continue
        is_its_own = isinstance(node, ast.For) and first in walk(node.iter)
        if not is_its_own or second in walk(node):
            return False
    return True
