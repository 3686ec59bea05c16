"""Follow a value back to the literals, or the names, that it may hold: through variables, attributes, loops and calls."""

from __future__ import annotations

import ast
import itertools
import re
from collections.abc import Iterator, Mapping, Sequence

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
_DEEPEST_NAME = 5  # and a name, of which each way is followed anew
_MOST = 500  # expressions that are looked at
# Functions that return one of their arguments, or one of the values in them.
_PASSED_ON = frozenset(("max", "min", "abs", "round", "copy", "deepcopy"))
_TAKEN_OUT = frozenset(("next", "choice", "sum", "max", "min"))
_GONE_THROUGH = frozenset(
    ("list", "tuple", "sorted", "reversed", "iter", "count", "cycle", "repeat", "range", "set", "deque")
)
Leaf = tuple[PythonSource, ast.expr]
Passed = tuple[PythonSource, ast.expr, ast.Call | None]
# Each name with its origin: the expression itself, or the call that passes it to the function.
Names = Mapping[str, Leaf]


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
            for home, given, _ in self._passed(source, value):
                yield from self.behind(home, given, path, depth - 1)
        elif isinstance(value, ast.Call):
            for home, function in self._called(source, value):
                returned = [n.value for n in own_nodes(function) if isinstance(n, ast.Return) and n.value]
                for given in returned:
                    yield from self.behind(home, given, path, depth - 1)

    def names(self, source: PythonSource, node: ast.expr, depth: int = _DEEPEST_NAME) -> Names:
        """Return the names that an expression may hold, as far as they are known; for a list, its items."""
        value = self._sources.value(source, node)
        found: dict[str, Leaf] = {}
        match node if depth else None:
            case _ if isinstance(value, (str, list, dict)):
                texts = first_texts([value] if isinstance(value, str) else value)
                found = dict.fromkeys(texts, (source, node))
            case ast.JoinedStr(values=parts):
                pieces = [part.value if isinstance(part, ast.FormattedValue) else part for part in parts]
                found = dict(self._joined(source, pieces, depth))
            case ast.BinOp(op=ast.Add(), left=left, right=right):
                found = dict(self._joined(source, [left, right], depth))
            case ast.List(elts=items) | ast.Tuple(elts=items):
                pairs = (isinstance(item, (ast.Tuple, ast.List)) and item.elts for item in items)
                for first in (pair[0] if pair else item for item, pair in zip(items, pairs, strict=True)):
                    found |= self.names(source, first, depth - 1)
            case ast.Name() | ast.Attribute() as name:
                for home, given, path in self._bound(source, name):
                    held, number = looped(given, path) if path else (None, 0)
                    items = self._sources.value(home, held)
                    found |= dict.fromkeys(first_texts(items, number) if held else (), (source, node))
                    found |= self.names(home, given, depth - 1) if not path else {}
                for home, given, call in self._passed(source, name):
                    inner = self.names(home, given, depth - 1)
                    found |= dict.fromkeys(inner, (home, call)) if call else inner
        return found

    def _joined(self, source: PythonSource, parts: list[ast.expr], depth: int) -> Iterator[tuple[str, Leaf]]:
        """Yield the texts that parts may form when joined, each with its origin, a call if there is one."""
        rows = [self.names(source, part, depth - 1).items() for part in parts]
        for way in itertools.islice(itertools.product(*rows), 100):
            given = [place for _, place in way]
            origin = next((p for p in given if isinstance(p[1], ast.Call)), given[0])
            yield "".join(text for text, _ in way), origin

    def _bound(
        self, source: PythonSource, name: ast.Name | ast.Attribute
    ) -> Iterator[tuple[PythonSource, ast.expr, Path]]:
        """Yield what a name or an attribute is bound to: a file, an expression, and which of its items."""
        if isinstance(name, ast.Name):
            function = source.function_at(name.lineno)
            rows = [*_bound_or_added(own_nodes(function), name.id)] if function else []
            rows = rows or [*_bound_or_added(own_nodes(source.tree), name.id)]
            yield from ((source, value, path) for value, path in rows)
            imported = (source.resolve(name) or "").rpartition(".") if not rows else ("", "", "")
            if home := self._sources.sources.get(imported[0]):
                rows = [*_bound_or_added(home.tree.body, imported[2])]
                yield from ((home, value, path) for value, path in rows)
        else:
            owners = [*self._owners(source, name)]
            for home, owner in owners:
                of_self = _bound_or_added(tuple(walk(owner)), f"self.{name.attr}")
                of_class = _bound_or_added(owner.body, name.attr)
                yield from ((home, value, path) for value, path in (*of_self, *of_class))
            if not owners:
                rows = [*_bound_or_added(source.nodes, ast.unparse(name))]
                yield from ((source, value, path) for value, path in rows)

    def _passed(
        self, source: PythonSource, name: ast.Name | ast.Attribute
    ) -> Iterator[tuple[PythonSource, ast.expr, ast.Call | None]]:
        """Yield what calls pass for a parameter, or for a field, each with its file; a default is in no call."""
        if isinstance(name, ast.Name):
            function = source.function_at(name.lineno)
            if function and name.id in [parameter.arg for parameter in all_parameters(function)]:
                yield from self._given(source, function, name.id)
            return
        for _, owner in self._owners(source, name):
            yield from self._of_fields(owner, name.attr)
        if not is_self_attribute(name):
            yield from self._of_namedtuple(name.attr)

    def _owners(
        self, source: PythonSource, name: ast.Attribute
    ) -> Iterator[tuple[PythonSource, ast.ClassDef]]:
        """Yield the classes that an attribute may belong to: those that the object may be of, or the only one that has it."""
        if is_self_attribute(name) or ast.unparse(name.value) in ("cls", "type(self)"):
            owner = source.class_at(name.lineno)
            own = self._sources.classes.get(f"{source.name}.{owner.name}") if owner else None
            chains = [self._sources.lineage(one)[0] for one in self._sources.classes.values()]
            family = dict.fromkeys(inner for chain in chains if own in chain for inner in chain)
            yield from ((inner.source, inner.definition) for inner in family)
            return
        called = ast.unparse(name.value)
        known = [c for c in self._sources.classes.values() if name.attr in _attributes(c.definition)]
        named = [c for c in known if c.definition.name == called]
        fields = {field for i in source.imports for field in interfaces.fields_of(i.target) or ()}
        if named or (len(known) == 1 and name.attr not in fields):
            found = (named or known)[0]
            yield found.source, found.definition

    def _of_fields(self, owner: ast.ClassDef, name: str) -> Iterator[Passed]:
        """Yield what the calls of a dataclass or a named tuple pass for one of its fields."""
        made = [ast.unparse(node) for node in (*owner.decorator_list, *owner.bases)]
        if not any(re.search(r"\b(?:dataclass|NamedTuple)\b", text) for text in made):
            return
        declared = [n.target for n in owner.body if isinstance(n, ast.AnnAssign)]
        yield from self._given_by_place(owner.name, [ast.unparse(target) for target in declared], name)

    def _of_namedtuple(self, name: str) -> Iterator[Passed]:
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

    def _given_by_place(self, function: str, names: Sequence[str], name: str) -> Iterator[Passed]:
        for source, call in self.calls(function):
            if (given := by_parameter(call, names).get(name)) is not None:
                yield source, given, call

    def _given(self, source: PythonSource, function: Function, name: str) -> Iterator[Passed]:
        """Yield what callers pass for a parameter of a function, or its default."""
        owner = next((n for n in source.nodes if isinstance(n, ast.ClassDef) and function in n.body), None)
        is_made = owner is not None and function.name == "__init__"
        default = defaults_of(function).get(name)
        calls = [*self.calls(owner.name if owner and is_made else function.name)]
        given = [(home, argument_of(function, call, name), call) for home, call in calls]
        if default is not None and (not calls or any(value is default for _, value, _ in given)):
            yield source, default, None
        yield from ((home, value, call) for home, value, call in given if value not in (None, default))

    def calls(self, name: str) -> Iterator[tuple[PythonSource, ast.Call]]:
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


def first_texts(items: object, number: int = 0) -> Iterator[str]:
    """Yield the strings among some items, and from each item that is a list the string at the given index."""
    for item in items if isinstance(items, (list, dict)) else ():
        if isinstance(item, list):
            yield from (text for text in item[number:][:1] if isinstance(text, str))
        elif isinstance(item, str) and not number:
            yield item


def looped(value: ast.expr, path: Path) -> tuple[ast.expr | None, int]:
    """Return what a loop over a value goes through, None if there is no loop, and which part of each item it takes."""
    match value:
        case _ if path[0] is not None:
            return None, 0
        case ast.Call(func=ast.Attribute(value=held, attr="items" | "keys")):
            value = held
    return value, (path[1:] or (0,))[0] or 0


def argument_of(function: Function, call: ast.Call, name: str) -> ast.expr | None:
    """Return what a call passes for a parameter of a function; the default if it passes nothing."""
    names = [parameter.arg for parameter in parameters(function)]
    is_method = bool(names) and names[0] in ("self", "cls")
    return by_parameter(call, names[is_method:]).get(name) or defaults_of(function).get(name)
