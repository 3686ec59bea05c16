"""Lines read from a file that are compared with strings while they still have their line end."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.kinds import Kinds, Scope
from ros2lab.diagnose.sources.node_source import NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import YIELDS, own_nodes
from ros2lab.diagnose.sources.syntax_parts import equal_sides, stores_in

_FILE, _LINES, _LINE, _PARTS = "file", "lines", "line", "parts"  # what an expression may hold
_ITEM = {_FILE: _LINE, _LINES: _LINE}
_SAME = {kind: kind for kind in (_FILE, _LINES, _LINE, _PARTS)}
# What functions and methods return for each kind of argument or object.
_OF_FUNCTIONS = {
    **dict.fromkeys(("list", "sorted", "tuple", "reversed"), dict.fromkeys(_ITEM, _LINES)),
    "next": {_FILE: _LINE},
}
_OF_METHODS = {
    "readlines": {_FILE: _LINES},
    "readline": {_FILE: _LINE},
    "split": {_LINE: _PARTS},
    **{name: {_LINE: _LINE} for name in ("lower", "upper", "lstrip", "title", "capitalize")},
}
_DEEPEST = 12  # steps from a comparison to the file that was opened


def line_end_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield comparisons of an unstripped line with a string that has no line end: they are never equal."""
    for source in sources.sources.values():
        if not any(name in source.text for name in ("open(", "stdin", "readline")):
            continue
        told, kinds = set(), Kinds(sources)
        for owner, function, node in sources.scoped(source):
            if isinstance(node, ast.Compare) and len(node.ops) == 1:
                side = _Reader(Scope(kinds, source, owner, function)).unequal(node)
                text = ast.unparse(side) if side is not None else ""
                if side is not None and (id(function), text) not in told:  # one for all branches
                    told.add((id(function), text))
                    cause = f"A line read from a file ends with '\\n', so `{ast.unparse(node)[:70]}` is not true for it."
                    fix = f"write {text}.strip() instead of {text} in each comparison"
                    yield Finding("never-equal", cause, source.at(node), fix)


class _Reader:
    """Finds the expressions of a function that hold a file, its lines, a line or parts of a line."""

    def __init__(self, scope: Scope) -> None:
        self._scope, self._source, self._sources = scope, scope.source, scope.kinds.sources

    def unequal(self, node: ast.Compare) -> ast.expr | None:
        """Return the side of a comparison that is a line where the other cannot be; None if neither is."""
        for side, others, _ in equal_sides(node):
            if others and all(map(self._is_word, others)) and self.kind(side) == _LINE:
                return side
        return None

    def _is_word(self, node: ast.expr) -> bool:
        value = self._sources.value(self._source, node)
        return isinstance(value, str) and value != "" and not value.endswith(("\n", "\r"))

    def kind(self, node: ast.expr | None, depth: int = _DEEPEST) -> str:
        """Return the kind of an expression, such as `_LINE`; empty if it has none or is unknown."""
        found = ""
        if depth == 0:
            return found
        match node:
            case ast.Name(id=name):
                found = self._of_name(name, depth - 1)
            case ast.Attribute() if is_self_attribute(node):
                pairs = self._scope.assigned(node)
                found = _agreed([_Reader(scope).kind(value, depth - 1) for scope, value in pairs])
            case ast.Attribute() if self._source.resolve(node) == "sys.stdin":
                found = _FILE
            case ast.Call():
                found = self._of_call(node, depth - 1)
            case ast.Subscript(value=value, slice=index):
                inner = self.kind(value, depth - 1)
                if isinstance(index, ast.Slice):
                    found = inner if inner == _LINES else ""
                elif inner == _PARTS:
                    found = _LINE if ast.unparse(index) == "-1" else ""
                else:
                    found = _ITEM.get(inner, "") if inner == _LINES else ""
            case ast.ListComp(
                elt=ast.Name(id=name), generators=[ast.comprehension(target=ast.Name(id=taken), iter=given)]
            ) if name == taken and _ITEM.get(self.kind(given, depth - 1)):
                found = _LINES
        return found

    def _of_call(self, call: ast.Call, depth: int) -> str:
        match call.func, call.args:
            case ast.Name(id="open"), [*given]:
                mode = [*given[1:2], *(keyword.value for keyword in call.keywords if keyword.arg == "mode")]
                is_text = all(
                    isinstance(argument, ast.Constant) and "b" not in str(argument.value) for argument in mode
                )
                return _FILE if is_text else ""
            case ast.Name(id=name), [held] if name in _OF_FUNCTIONS:
                return _OF_FUNCTIONS[name].get(self.kind(held, depth), "")
            case ast.Attribute(value=held, attr=name), given if name in _OF_METHODS:
                is_meant = (
                    bool(given) == (name == "split") or name == "readlines"
                )  # split() takes the line end away
                return _OF_METHODS[name].get(self.kind(held, depth), "") if is_meant else ""
            case ast.Name() | ast.Attribute(), _:
                return self._of_own(call.func, depth)
        return ""

    def _of_own(self, called: ast.expr, depth: int) -> str:
        """Return the kind of what a function of the package returns; empty if it is not always the same."""
        if is_self_attribute(called):
            method = self._sources.method(self._scope.owner, called.attr)
            found = (self._source, method) if method is not None else None
        else:
            found = self._sources.functions.get(self._sources.resolve(self._source, called) or "")
        if found is None or found[1].decorator_list:
            return ""
        inner = _Reader(Scope(self._scope.kinds, found[0], self._scope.owner, found[1]))
        returned = [node for node in own_nodes(found[1]) if isinstance(node, (ast.Return, *YIELDS))]
        return _agreed(
            [inner.kind(node.value, depth) if isinstance(node, ast.Return) else "" for node in returned]
        )

    def _of_name(self, name: str, depth: int) -> str:
        """Return the kind of a variable; empty if not all its assignments agree."""
        nodes = own_nodes(self._scope.function or self._source.tree)
        if any(isinstance(n, ast.arg) and n.arg == name for n in nodes):
            return ""
        stores = [n for n in stores_in(nodes) if isinstance(n, ast.Name) and n.id == name]
        return _agreed([self._given(nodes, store, depth) for store in stores])

    def _given(self, nodes: tuple[ast.AST, ...], store: ast.Name, depth: int) -> str:
        """Return the kind of the value that a variable is given; empty if it is unknown."""
        for node in nodes:
            kinds = _SAME
            match node:
                case (
                    ast.Assign(targets=[target], value=value)
                    | ast.NamedExpr(target=target, value=value)
                    | ast.withitem(context_expr=value, optional_vars=target)
                ) if target is store:
                    pass
                case ast.Assign(targets=[ast.Tuple(elts=[*_, last])], value=value) if last is store:
                    kinds = {_PARTS: _LINE}
                case ast.For(target=target, iter=value) | ast.comprehension(target=target, iter=value) if (
                    target is store
                ):
                    kinds = _ITEM
                case ast.For(
                    target=ast.Tuple(elts=[_, target]),
                    iter=ast.Call(func=ast.Name(id="enumerate"), args=[value, *_]),
                ) if target is store:
                    kinds = _ITEM
                case _:
                    continue
            return kinds.get(self.kind(value, depth), "")
        return ""


def _agreed(kinds: list[str]) -> str:
    """Return the kind that all values have; empty if they differ or there are none."""
    return kinds[0] if len(set(kinds)) == 1 else ""
