"""Follow a value back to the literals, or the names, that it may hold: through variables, attributes, loops and calls."""

from __future__ import annotations

import ast
import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.bindings import Path, bindings
from ros2lab.diagnose.sources.node_source import NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    last_name,
    names_bound,
    own_nodes,
    parameters,
    walk,
)
from ros2lab.diagnose.sources.static_value import evaluate
from ros2lab.diagnose.sources.syntax_parts import all_parameters, by_parameter, defaults_of
from ros2lab.diagnose.sources.uses import own_stores

_DEEPEST = 8  # variables and calls through which a value is followed
_MOST = 500  # expressions that are looked at
# Functions that return one of their arguments, or one of the values in them.
_PASSED_ON = frozenset(("max", "min", "abs", "round", "copy", "deepcopy"))
_TAKEN_OUT = frozenset(("next", "choice", "sum", "max", "min"))
_GONE_THROUGH = frozenset(
    ("list", "tuple", "sorted", "reversed", "iter", "count", "cycle", "repeat", "range", "set", "deque")
)
Leaf = tuple[PythonSource, ast.expr]


class Literals:
    """The literals behind values, in the files of a package."""

    def __init__(self, sources: NodeSources) -> None:
        self._sources = sources
        self._seen: set[tuple[int, Path]] = set()

    def behind(
        self, source: PythonSource, value: ast.expr, path: Path = (), depth: int = _DEEPEST
    ) -> Iterator[Leaf]:
        """Yield the constants of which a value, or the items at a path in it, may be made, and divisions, each with its file."""
        key = (id(value), path)
        if depth < 0 or key in self._seen or len(self._seen) > _MOST:
            return
        self._seen.add(key)
        for inner, inner_path in _parts(value, path):
            if inner is value and inner_path == path:
                yield source, value
            else:
                yield from self.behind(source, inner, inner_path, depth)
        if isinstance(value, (ast.Name, ast.Attribute)):
            for home, given, more in self._bound(source, value):
                yield from self.behind(home, given, (*more, *path), depth - 1)
        elif isinstance(value, ast.Call):
            for home, function in self._called(source, value):
                returned = [n.value for n in own_nodes(function) if isinstance(n, ast.Return) and n.value]
                for given in returned:
                    yield from self.behind(home, given, path, depth - 1)

    def _bound(
        self, source: PythonSource, name: ast.Name | ast.Attribute
    ) -> Iterator[tuple[PythonSource, ast.expr, Path]]:
        """Yield what a name or an attribute is bound to: a file, an expression, and which of its items."""
        if isinstance(name, ast.Name):
            function = source.function_at(name.lineno)
            rows = [*_bound_or_added(own_nodes(function), name.id)] if function else []
            rows = rows or [*_bound_or_added(own_nodes(source.tree), name.id)]
            yield from ((source, value, path) for value, path in rows)
            if function and name.id in [parameter.arg for parameter in all_parameters(function)]:
                yield from ((home, value, ()) for home, value in self._given(source, function, name.id))
            imported = (source.resolve(name) or "").rpartition(".") if not rows else ("", "", "")
            if home := self._sources.sources.get(imported[0]):
                rows = [*_bound_or_added(home.tree.body, imported[2])]
                yield from ((home, value, path) for value, path in rows)
        else:
            for home, owner in self._owners(source, name):
                of_self = _bound_or_added(tuple(walk(owner)), f"self.{name.attr}")
                of_class = _bound_or_added(owner.body, name.attr)
                yield from ((home, value, path) for value, path in (*of_self, *of_class))
                yield from ((home, value, ()) for home, value in self._of_fields(owner, name.attr))
            if not is_self_attribute(name):
                yield from ((home, value, ()) for home, value in self._of_namedtuple(name.attr))

    def _owners(
        self, source: PythonSource, name: ast.Attribute
    ) -> Iterator[tuple[PythonSource, ast.ClassDef]]:
        """Yield the classes that an attribute may belong to: the one around self, or the only one that has it."""
        if is_self_attribute(name) or ast.unparse(name.value) in ("cls", "type(self)"):
            if owner := source.class_at(name.lineno):
                yield source, owner
            return
        called = ast.unparse(name.value)
        known = [c for c in self._sources.classes.values() if name.attr in _attributes(c.definition)]
        named = [c for c in known if c.definition.name == called]
        fields = {field for i in source.imports for field in interfaces.fields_of(i.target) or ()}
        if named or (len(known) == 1 and name.attr not in fields):
            found = (named or known)[0]
            yield found.source, found.definition

    def _of_fields(self, owner: ast.ClassDef, name: str) -> Iterator[Leaf]:
        """Yield what the calls of a dataclass or a named tuple pass for one of its fields."""
        made = [ast.unparse(node) for node in (*owner.decorator_list, *owner.bases)]
        if not any(re.search(r"\b(?:dataclass|NamedTuple)\b", text) for text in made):
            return
        declared = [n.target for n in owner.body if isinstance(n, ast.AnnAssign)]
        yield from self._given_by_place(owner.name, [ast.unparse(target) for target in declared], name)

    def _of_namedtuple(self, name: str) -> Iterator[Leaf]:
        """Yield what is passed for a field of `Joint = namedtuple('Joint', 'name low high')`."""
        for node in (node for source in self._sources.sources.values() for node in source.tree.body):
            match node:
                case ast.Assign(
                    targets=[ast.Name(id=made)],
                    value=ast.Call(
                        func=ast.Name(id="namedtuple") | ast.Attribute(attr="namedtuple"), args=[_, fields]
                    ),
                ):
                    known = evaluate(fields, {}, {})
                    names = known.replace(",", " ").split() if isinstance(known, str) else known
                    if isinstance(names, (list, tuple)) and name in names:
                        yield from self._given_by_place(made, names, name)

    def _given_by_place(self, function: str, names: Sequence[str], name: str) -> Iterator[Leaf]:
        for source, call in self._calls(function):
            if (given := by_parameter(call, names).get(name)) is not None:
                yield source, given

    def _given(self, source: PythonSource, function: Function, name: str) -> Iterator[Leaf]:
        """Yield what callers pass for a parameter of a function, or its default."""
        owner = next((n for n in source.nodes if isinstance(n, ast.ClassDef) and function in n.body), None)
        is_made = owner is not None and function.name == "__init__"
        defaults = defaults_of(function)
        called = False
        for home, call in self._calls(owner.name if owner and is_made else function.name):
            given = argument_of(function, call, name) or defaults.get(name)
            called = True
            if given is not None:
                yield (source if given is defaults.get(name) else home), given
        if not called and name in defaults:
            yield source, defaults[name]

    def _calls(self, name: str) -> Iterator[tuple[PythonSource, ast.Call]]:
        """Yield the calls of a function or class, also those for which it is passed on: `submit(work, 3)`."""
        for source in self._sources.sources.values():
            calls = (call for node in source.calls for call in (node, *_passed_on(node)))
            yield from ((source, call) for call in calls if last_name(call.func) == name)

    def _called(self, source: PythonSource, call: ast.Call) -> Iterator[tuple[PythonSource, Function]]:
        """Yield the functions of the files that a call may mean."""
        name = last_name(call.func)
        if name == "result" and not call.args:
            submitted = [n for n in source.calls if last_name(n.func) == "submit"]
            for inner in (inner for node in submitted for inner in _passed_on(node)):
                yield from self._called(source, inner)
        known = self._sources.functions.get(self._sources.resolve(source, call.func) or "")
        if known:
            yield known
        elif isinstance(call.func, ast.Attribute):
            own = [c for c in self._sources.classes.values() if name in c.methods]
            yield from ((c.source, c.methods[name]) for c in own if len(own) == 1)


def _passed_on(call: ast.Call) -> Iterator[ast.Call]:
    """Yield the calls that another call makes later: of a function that it is given, with the arguments after it."""
    if last_name(call.func).startswith(("create_", "add_")):
        return  # what follows a callback is not for it
    keywords = {keyword.arg: keyword.value for keyword in call.keywords}
    if isinstance(target := keywords.get("target"), (ast.Name, ast.Attribute)):
        yield ast.Call(target, list(getattr(keywords.get("args"), "elts", [])), [])
    for number, given in enumerate(call.args):
        if getattr(given, "is_function", False) or (isinstance(given, ast.Name) and given.id[:1].isupper()):
            yield ast.Call(given, call.args[number + 1 :], call.keywords)


def _parts(value: ast.expr, path: Path) -> Iterator[tuple[ast.expr, Path]]:
    """Yield the parts of which a value is made, with the items taken out of each; itself if it is a literal."""
    match value:
        case ast.Constant() | ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=ast.Constant()) if not path:
            yield value, path
        case ast.UnaryOp(operand=operand):
            yield operand, path
        case ast.BinOp(op=ast.Div()):
            yield value, path
        case ast.BinOp(left=left, op=ast.Mult(), right=right) if path:
            yield (right if isinstance(right, (ast.List, ast.Tuple)) else left), path
        case ast.BinOp(left=left, right=right):
            yield from ((left, path), (right, path))
        case ast.BoolOp(values=values):
            yield from ((part, path) for part in values)
        case ast.IfExp(body=body, orelse=orelse):
            yield from ((body, path), (orelse, path))
        case ast.NamedExpr(value=inner) | ast.Await(value=inner) | ast.Starred(value=inner):
            yield inner, path
        case ast.Subscript(value=inner, slice=index):
            number = index.value if isinstance(index, ast.Constant) and isinstance(index.value, int) else None
            yield inner, (path if isinstance(index, ast.Slice) else (number, *path))
        case ast.Call():
            yield from _of_call(value, path)
        case _ if path:
            yield from _of_items(value, path)


def _of_items(value: ast.expr, path: Path) -> Iterator[tuple[ast.expr, Path]]:
    """Yield what is taken out of a list or the like that is written there."""
    match value:
        case ast.List(elts=items) | ast.Tuple(elts=items) | ast.Set(elts=items) if path:
            index = path[0]
            chosen = items if index is None else items[index : index + 1] if index >= 0 else items[index:][:1]
            yield from ((item, path[1:]) for item in chosen)
        case ast.Dict(values=values) if path:
            yield from ((item, path[1:]) for item in values)
        case ast.ListComp(elt=item) | ast.GeneratorExp(elt=item) | ast.SetComp(elt=item) if path:
            yield item, path[1:]
        case ast.DictComp(value=item) if path:
            yield item, path[1:]


def _of_call(call: ast.Call, path: Path) -> Iterator[tuple[ast.expr, Path]]:
    """Yield the arguments that a function of Python returns as they are, or takes its result out of."""
    name = last_name(call.func)
    is_single = len(call.args) == 1
    if name in _TAKEN_OUT and is_single:
        yield call.args[0], (None, *path)
    elif name in _PASSED_ON:
        yield from ((argument, path) for argument in call.args[: 1 if name == "round" else None])
    elif name in ("count", "range", "repeat") and path:
        yield from ((argument, path[1:]) for argument in call.args)
    elif name in _GONE_THROUGH:
        yield from ((argument, path) for argument in call.args[:1])
    elif name in ("values", "items") and path and isinstance(call.func, ast.Attribute):
        yield call.func.value, (None, *path[1 + (name == "items") :])
    elif name == "enumerate" and path[1:] and path[1] == 1:
        yield from ((argument, (None, *path[2:])) for argument in call.args[:1])
    elif name == "zip" and path[1:] and path[1] is not None:
        yield from ((argument, (None, *path[2:])) for argument in call.args[path[1] :][:1])


def _bound_or_added(nodes: Sequence[ast.AST], name: str) -> Iterator[tuple[ast.expr, Path]]:
    """Yield what statements bind to a name or to `self.name`, or add to it, and which of its items."""
    yield from bindings(nodes, name)
    yield from (
        (n.value, ()) for n in nodes if isinstance(n, ast.AugAssign) and ast.unparse(n.target) == name
    )


def _attributes(owner: ast.ClassDef) -> set[str]:
    fields = (s for s in owner.body if isinstance(s, (ast.Assign, ast.AnnAssign)))
    return own_stores(owner) | names_bound(n for s in fields for n in walk(s))


_DEEPEST_NAME = 5  # variables and calls through which a name is followed
# Each name with its origin: the expression itself, or the call that passes it to the function.
Names = Mapping[str, tuple[PythonSource, ast.expr]]


def names_given(
    sources: NodeSources,
    source: PythonSource,
    function: Function | None,
    node: ast.expr,
    depth: int = _DEEPEST_NAME,
) -> Names:
    """Return the names that an expression may hold, as far as they are known; for a list, its items."""
    value = sources.value(source, node)
    if isinstance(value, (str, list, dict)):
        return dict.fromkeys(first_texts([value] if isinstance(value, str) else value), (source, node))
    if depth == 0:
        return {}
    found: dict[str, tuple[PythonSource, ast.expr]] = {}
    match node:
        case ast.JoinedStr(values=parts):
            texts = [part.value if isinstance(part, ast.FormattedValue) else part for part in parts]
            found = dict(_joined(sources, source, function, texts, depth))
        case ast.BinOp(op=ast.Add(), left=left, right=right):
            found = dict(_joined(sources, source, function, [left, right], depth))
        case ast.List(elts=items) | ast.Tuple(elts=items):
            pairs = (isinstance(item, (ast.Tuple, ast.List)) and item.elts for item in items)
            for first in (pair[0] if pair else item for item, pair in zip(items, pairs, strict=True)):
                found |= names_given(sources, source, function, first, depth - 1)
        case ast.Attribute(attr=name):
            for given in _kept(sources, ast.unparse(node), name):
                found |= names_given(sources, source, function, given, depth - 1)
        case ast.Name():
            found = {**_of_variable(sources, source, function, node, depth)}
    return found


def _of_variable(
    sources: NodeSources, source: PythonSource, function: Function | None, node: ast.Name, depth: int
) -> Names:
    """Return the names that a variable may hold: what it is bound to, and what callers pass for it."""
    found: dict[str, tuple[PythonSource, ast.expr]] = {}
    for number, given in bound_to(source, function, node.id):
        held = sources.value(source, given)
        firsts = first_texts(held, number) if isinstance(held, (list, dict)) else ()
        found |= dict.fromkeys(firsts, (source, node))
        if number is None:
            found |= names_given(sources, source, function, given, depth - 1)
    if function and node.id in [parameter.arg for parameter in parameters(function)]:
        found |= _of_callers(sources, function, node.id, depth)
    return found


def _kept(sources: NodeSources, text: str, name: str) -> Iterator[ast.expr]:
    """Yield the values assigned to an attribute such as `self.name`, also in the body of a class."""
    for node in (node for source in sources.sources.values() for node in source.nodes):
        match node:
            case ast.Assign(targets=[ast.Attribute() as target], value=value) if ast.unparse(target) == text:
                yield value
            case ast.ClassDef(body=body):
                yield from (
                    statement.value
                    for statement in body
                    if isinstance(statement, ast.Assign)
                    and [name] == [getattr(n, "id", "") for n in statement.targets]
                )


def first_texts(items: Any, number: int | None = 0) -> Iterator[str]:
    """Yield the strings among some items, and from each item that is a list the string at the given index."""
    for item in items:
        if isinstance(item, list):
            yield from (text for text in item[number or 0 :][:1] if isinstance(text, str))
        elif isinstance(item, str) and not number:
            yield item


def _joined(
    sources: NodeSources, source: PythonSource, function: Function | None, parts: list[ast.expr], depth: int
) -> Iterator[tuple[str, tuple[PythonSource, ast.expr]]]:
    """Yield the texts that parts may form when joined, each with its origin, a call if there is one."""
    rows = [names_given(sources, source, function, part, depth - 1).items() for part in parts]
    for way in itertools.islice(itertools.product(*rows), 100):
        given = [place for _, place in way]
        yield (
            "".join(text for text, _ in way),
            next((p for p in given if isinstance(p[1], ast.Call)), given[0]),
        )


def bound_to(
    source: PythonSource, function: Function | None, name: str
) -> Iterator[tuple[int | None, ast.expr]]:
    """Yield what a name is bound to: None and an expression, or an index into each item of an expression."""
    for value, path in bindings(own_nodes(function) if function else source.tree.body, name):
        match value:
            case _ if path == ():
                yield None, value
            case ast.Call(func=ast.Attribute(value=held, attr="items" | "keys")) if path[0] is None:
                yield (path[1:] or (0,))[0], held
            case _ if path[0] is None:
                yield (path[1:] or (0,))[0], value


def _of_callers(sources: NodeSources, function: Function, name: str, depth: int) -> Names:
    """Return the names that callers pass for a parameter of a function."""
    found: dict[str, tuple[PythonSource, ast.expr]] = {}
    for home, around, call in calls_of(sources, function):
        given = argument_of(function, call, name)
        texts = names_given(sources, home, around, given, depth - 1) if given is not None else ()
        found |= dict.fromkeys(texts, (home, call))
    return found


def calls_of(
    sources: NodeSources, function: Function
) -> Iterator[tuple[PythonSource, Function | None, ast.Call]]:
    """Yield the calls of a function, found by its name, each with its file and the function around it."""
    for source in sources.sources.values():
        for _, around, call in sources.scoped(source):
            called = call.func if isinstance(call, ast.Call) else None
            is_named = last_name(called) == function.name
            if isinstance(call, ast.Call) and is_named:
                yield source, around, call


def argument_of(function: Function, call: ast.Call, name: str) -> ast.expr | None:
    """Return what a call passes for a parameter of a function; the default if it passes nothing."""
    names = [parameter.arg for parameter in parameters(function)]
    is_method = bool(names) and names[0] in ("self", "cls")
    return by_parameter(call, names[is_method:]).get(name) or defaults_of(function).get(name)
