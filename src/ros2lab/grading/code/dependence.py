"""The texts that code compares with values from messages, if something depends on the result.

A comparison tells words apart only if the value may come from a message, and if what is done may depend on
the result. Values from messages are followed by name: through assignments, calls and attributes.
"""

from __future__ import annotations

import ast
from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Iterator
from functools import cache, cached_property

from ros2lab.diagnose.sources.python_source import PAUSES, PythonSource, children, walk
from ros2lab.grading.code.compared import LOOKS_FOR, compared
from ros2lab.grading.code.running import Code

Name = tuple[ast.AST | None, str]  # the function that a name is local to; None for a global or an attribute
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
_LOOKS_UP = frozenset(("get", "pop", "setdefault", "__getitem__"))


def depended_on(sources: Collection[PythonSource], code: Code) -> list[str]:
    """Return the texts that running code compares with values from messages, if something depends on it."""
    flow = Flow(sources, code)
    return compared(node for node in flow.code if flow.tells_apart(node))


class Flow:
    """Where values from messages go.

    Attributes:
        code: the nodes that run.
        parents: by node, the one around it.
        named: the functions that run, by name.
    """

    def __init__(self, sources: Collection[PythonSource], code: Code) -> None:
        self.code = {node for _, node in code}
        self.parents = {
            child: node for source in sources for node in source.nodes for child in children(node)
        }
        self._called = Counter(_name(node.func) for node in self.code if isinstance(node, ast.Call))
        self._loaded = Counter(
            _name(node) for node in self.code if isinstance(getattr(node, "ctx", None), ast.Load)
        )
        self._has_callbacks = "create_subscription" in self._called
        self._own_names = cache(_own_names)
        self.named = defaultdict[str, list[ast.AST]](list)
        for node in self.code:
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                self.named[node.name].append(node)

    def tells_apart(self, node: ast.AST) -> bool:
        """Return whether something depends on a comparison or look-up of a value from a message."""
        match node:
            case ast.Compare(left=left, comparators=others):
                return any(map(self._comes, (left, *others))) and self._matters(node)
            case ast.Call(func=ast.Attribute(value=owner, attr=name), args=given) if name in LOOKS_FOR:
                return any(map(self._comes, (owner, *given))) and self._matters(node)
            case ast.MatchValue():
                case, statement = self.above(node, ast.match_case), self.above(node, ast.Match)
                return (
                    isinstance(statement, ast.Match)
                    and isinstance(case, ast.match_case)
                    and self._comes(statement.subject)
                    and self._done(case.body) != self._done(_otherwise(statement))
                )
            case ast.Dict(values=values) if len(values) > 1 and len({*map(ast.dump, values)}) == 1:
                return False  # it tells no key from another
            case ast.Dict():
                is_handed_on = isinstance(self.parents.get(node), (ast.Call, ast.Return, ast.keyword))
                return is_handed_on or any(map(self._matters, self._look_ups(node)))
        return False

    def _look_ups(self, table: ast.Dict) -> Iterator[ast.AST]:
        """Yield the nodes in which a value from a message is looked up in a dictionary, or used beside it."""
        kept = {_name(target) for target in _targets(self.parents.get(table))}
        for node in self.code:
            parts: list[ast.AST] = []
            match node:
                case ast.Subscript(value=owner, slice=key):
                    parts = [owner, key]
                case ast.Compare(left=left, comparators=others):
                    parts = [left, *others]
                case ast.Call(func=function, args=given, keywords=named):
                    parts = [function, *given, *(keyword.value for keyword in named)]
            is_there = any(inner is table or _name(inner) in kept for part in parts for inner in walk(part))
            if is_there and any(map(self._comes, parts)):
                yield node

    def _matters(self, node: ast.AST) -> bool:
        """Return whether what is done may depend on the value of an expression."""
        above = self.parents.get(node)
        matters = above is not None
        match above:
            case ast.If(test=test) if test is node:
                matters = self._done(above.body) != self._done(_otherwise(above))
            case ast.IfExp(test=test, body=value, orelse=other) if test is node:
                matters = ast.dump(value) != ast.dump(other) and self._matters(above)
            case ast.While(test=test, body=body, orelse=orelse):
                matters = test is not node or bool(self._done((*body, *orelse)))
            case ast.Expr():
                matters = isinstance(node, (ast.Call, *PAUSES)) and not _is_look_up(node)
            case ast.Assert():
                matters = False
            case ast.Assign() | ast.AnnAssign() | ast.AugAssign():
                matters = self._is_read(above)
            case ast.NamedExpr():
                matters = self._is_read(above) or self._matters(above)
            case ast.Return():
                function = self.above(above, *_FUNCTIONS)
                matters = not isinstance(function, ast.FunctionDef) or self._called[function.name] > 0
            case ast.expr():
                matters = isinstance(above, ast.Lambda) or self._matters(above)
        return matters

    def _done(self, body: Iterable[ast.stmt]) -> list[str]:
        """Return the statements that do something: neither `pass` or a constant, nor a local value that nobody reads."""
        return [
            ast.dump(node)
            for node in body
            if not isinstance(node, ast.Pass)
            and not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant))
            and not (
                all(isinstance(t, ast.Name) for t in _targets(node) or [node]) and not self._is_read(node)
            )
        ]

    def _is_read(self, assignment: ast.AST) -> bool:
        return any(self._loaded[_name(target)] for target in _targets(assignment))

    def _comes(self, node: ast.AST) -> bool:
        """Return whether an expression may hold a value from a message."""
        return any(self._key(inner) in self._coming for inner in walk(node) if _name(inner))

    @cached_property
    def _coming(self) -> set[Name]:
        """The names that may hold values from messages."""
        coming: set[Name] = set()
        for function in self.code:
            if isinstance(function, _FUNCTIONS) and not self._is_called(function):
                coming |= {(function, name) for name in _given(function)}
        self._coming = coming  # those found so far, which `_handed_on` looks up
        before = -1
        while before < len(coming):
            before = len(coming)
            for node in self.code:
                coming.update(self._handed_on(node))
        return coming

    def _is_called(self, function: ast.AST) -> bool:
        """Return whether a function is only ever called by name, so that the calls show all its arguments."""
        name = getattr(function, "name", "")
        return bool(name) and self._called[name] > 0 and self._loaded[name] == self._called[name]

    def _handed_on(self, node: ast.AST) -> Iterator[Name]:
        """Yield the names to which a node gives a value from a message."""
        match node:
            case (
                ast.Assign(value=value)
                | ast.AnnAssign(value=ast.expr() as value)
                | ast.AugAssign(value=value)
            ):
                given = self._comes(value) or self._is_from_outside(value)
                yield from (self._key(name) for name in _targets(node) if given)
            case ast.NamedExpr(target=target, value=value):
                yield from [self._key(target)] if self._comes(value) else []
            case ast.For(target=target, iter=values) | ast.comprehension(target=target, iter=values):
                yield from (self._key(name) for name in _names(target) if self._comes(values))
            case ast.Match(subject=subject) if self._comes(subject):
                yield from (self._key(part) for case in node.cases for part in walk(case.pattern))
            case ast.Call(func=function, args=given, keywords=named):
                if any(map(self._comes, (*given, *(keyword.value for keyword in named)))):
                    yield from self._received(function)

    def _received(self, function: ast.expr) -> Iterator[Name]:
        """Yield the names that may get a call's arguments: parameters, and the object of a method."""
        name = _name(function)
        for called in (*self.named[name], *self.named["__init__"]):
            yield from ((called, given) for given in _given(called))
        if isinstance(function, ast.Attribute) and _name(function.value) not in ("", "self"):
            yield self._key(function.value)

    def _is_from_outside(self, value: ast.expr) -> bool:
        """Return whether a value may be input: it comes from a call, and no callback receives messages."""
        return not self._has_callbacks and any(isinstance(node, ast.Call) for node in walk(value))

    def _key(self, node: ast.AST) -> Name:
        """Return what a name refers to: a local, a global, or an attribute, which is the same everywhere."""
        name = _name(node)
        if isinstance(node, ast.Attribute):
            return (None, f".{name}")
        function = self.above(node, *_FUNCTIONS)
        while function is not None and name not in self._own_names(function):
            function = self.above(function, *_FUNCTIONS)
        return (function, name)

    def above(self, node: ast.AST, *kinds: type[ast.AST]) -> ast.AST | None:
        """Return the innermost node of some kinds around another one; None if there is none."""
        above = self.parents.get(node)
        while above is not None and not isinstance(above, kinds):
            above = self.parents.get(above)
        return above


def _name(node: ast.AST | None) -> str:
    match node:
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return name
        case ast.MatchAs(name=str(name)) | ast.MatchStar(name=str(name)):
            return name
        case ast.Subscript(value=owner):
            return _name(owner)
    return ""


def _names(target: ast.AST) -> list[ast.AST]:
    """Return the names, attributes and containers that a target assigns to."""
    match target:
        case ast.Tuple(elts=parts) | ast.List(elts=parts):
            return [name for part in parts for name in _names(part)]
        case ast.Starred(value=inner) | ast.Subscript(value=inner):
            return _names(inner)
    return [target] if _name(target) else []


def _given(function: ast.AST) -> list[str]:
    """Return the names of a function's parameters except self."""
    args = (
        function.args if isinstance(function, _FUNCTIONS) else ast.arguments([], [], None, [], [], None, [])
    )
    every = [*args.posonlyargs, *args.args, *args.kwonlyargs, args.vararg, args.kwarg]
    return [parameter.arg for parameter in every if parameter and parameter.arg != "self"]


def _targets(node: ast.AST | None) -> list[ast.AST]:
    """Return the names, attributes and containers that an assignment assigns to."""
    match node:
        case ast.Assign(targets=targets):
            return [name for target in targets for name in _names(target)]
        case ast.AnnAssign(target=target) | ast.AugAssign(target=target) | ast.NamedExpr(target=target):
            return _names(target)
    return []


def _own_names(function: ast.AST) -> frozenset[str]:
    """Return the names that are local to a function: its parameters, and what it assigns to."""
    names = {*_given(function)}
    inner: list[ast.AST] = [function]
    while inner:
        for node in children(inner.pop()):
            is_given = not isinstance(getattr(node, "ctx", None), (ast.Load, type(None)))
            if is_given or isinstance(node, (ast.MatchAs, ast.MatchStar)):
                names.add(_name(node))
            if not isinstance(node, (*_FUNCTIONS, ast.ClassDef)):
                inner.append(node)
    return frozenset(names)


def _is_look_up(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and _name(node.func) in _LOOKS_UP | LOOKS_FOR


def _otherwise(node: ast.If | ast.Match) -> list[ast.stmt]:
    """Return what is done if none of the cases holds, also those of each `elif`."""
    if isinstance(node, ast.Match):
        last = node.cases[-1]
        is_for_all = isinstance(last.pattern, ast.MatchAs) and last.pattern.pattern is None and not last.guard
        return last.body if is_for_all else []
    while len(node.orelse) == 1 and isinstance(inner := node.orelse[0], ast.If):
        node = inner
    return node.orelse
