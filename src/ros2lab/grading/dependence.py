"""The texts on which something depends, of those with which code compares what a message may hold.

A comparison tells words apart only if what is compared may have come with a message, and if something is done, or may
be done, by its result. What may come with a message is followed by names: through assignments, calls and attributes.
"""

from __future__ import annotations

import ast
from collections import Counter, defaultdict
from collections.abc import Collection, Iterator
from functools import cache, cached_property

from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.grading.compared import compared
from ros2lab.grading.running import Code

Name = tuple[ast.AST | None, str]  # the function whose name it is; None for a module's, and for an attribute
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
_LOOKS_UP = frozenset(("get", "pop", "setdefault", "index", "count", "__getitem__", "__contains__"))


def depended_on(sources: Collection[PythonSource], code: Code) -> list[str]:
    """Return the texts with which code that runs compares what may come with a message, and on which something depends."""
    flow = _Flow(NodeSources({source.name: source for source in sources}), {node for _, node in code})
    return compared(node for node in flow.code if flow.tells_apart(node))


class _Flow:
    """Where what comes with a message goes.

    Attributes:
        code: that runs.
    """

    def __init__(self, sources: NodeSources, code: set[ast.AST]) -> None:
        self.code = code
        self._parents = {
            child: node
            for source in sources.sources.values()
            for node in source.nodes
            for child in ast.iter_child_nodes(node)
        }
        self._called = Counter(_name(node.func) for node in code if isinstance(node, ast.Call))
        self._loaded = Counter(
            _name(node) for node in code if isinstance(getattr(node, "ctx", None), ast.Load)
        )
        self._has_callbacks = "create_subscription" in self._called
        self._own_names = cache(_own_names)
        self._named = defaultdict[str, list[ast.AST]](list)  # functions
        for node in code:
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                self._named[node.name].append(node)

    def tells_apart(self, node: ast.AST) -> bool:
        """Return whether something depends on a comparison of what may come with a message, or on where it is looked up."""
        match node:
            case ast.Compare(left=left, comparators=others):
                return any(map(self._comes, (left, *others))) and self._matters(node)
            case ast.MatchValue():
                case, statement = self._above(node, ast.match_case), self._above(node, ast.Match)
                return (
                    isinstance(statement, ast.Match)
                    and isinstance(case, ast.match_case)
                    and self._comes(statement.subject)
                    and any(map(_does_something, case.body))
                )
            case ast.Dict():
                is_handed_on = isinstance(self._parents.get(node), (ast.Call, ast.Return, ast.keyword))
                return is_handed_on or any(map(self._matters, self._look_ups(node)))
        return False

    def _look_ups(self, table: ast.Dict) -> Iterator[ast.AST]:
        """Yield where what may come with a message is looked up in a dictionary, or meets it."""
        kept = {_name(one) for one in _targets(self._parents.get(table))}
        for node in self.code:
            parts: list[ast.AST] = []
            match node:
                case ast.Subscript(value=owner, slice=key):
                    parts = [owner, key]
                case ast.Compare(left=left, comparators=others):
                    parts = [left, *others]
                case ast.Call(func=function, args=given, keywords=named):
                    parts = [function, *given, *(one.value for one in named)]
            is_there = any(one is table or _name(one) in kept for part in parts for one in ast.walk(part))
            if is_there and any(map(self._comes, parts)):
                yield node

    def _matters(self, node: ast.AST) -> bool:
        """Return whether something is done, or may be done, by what an expression says."""
        above = self._parents.get(node)
        matters = above is not None
        match above:
            case ast.If(test=test, body=body, orelse=other) | ast.While(test=test, body=body, orelse=other):
                matters = test is not node or any(map(_does_something, (*body, *other)))
            case ast.Expr():
                matters = isinstance(node, (ast.Call, ast.Await, ast.Yield)) and not _is_look_up(node)
            case ast.Assert():
                matters = False
            case ast.Assign() | ast.AnnAssign() | ast.AugAssign():
                matters = self._is_read(above)
            case ast.NamedExpr():
                matters = self._is_read(above) or self._matters(above)
            case ast.Return():
                function = self._above(above, *_FUNCTIONS)
                matters = not isinstance(function, ast.FunctionDef) or self._called[function.name] > 0
            case ast.expr():
                matters = isinstance(above, ast.Lambda) or self._matters(above)
        return matters

    def _is_read(self, assignment: ast.AST) -> bool:
        return any(self._loaded[_name(target)] for target in _targets(assignment))

    def _comes(self, node: ast.AST) -> bool:
        """Return whether an expression may hold what comes with a message."""
        return any(self._key(one) in self._coming for one in ast.walk(node) if _name(one))

    @cached_property
    def _coming(self) -> set[Name]:
        """The names of what may come with a message."""
        coming: set[Name] = set()
        for function in self.code:
            if isinstance(function, _FUNCTIONS) and not self._is_called(function):
                coming |= {(function, name) for name in _given(function)}
        self._coming = coming  # what is found until now, for what looks it up
        before = -1
        while before < len(coming):
            before = len(coming)
            for node in self.code:
                coming.update(self._handed_on(node))
        return coming

    def _is_called(self, function: ast.AST) -> bool:
        """Return whether a function of the hand-in is only called by its name, so that its calls tell what it is given."""
        name = getattr(function, "name", "")
        return bool(name) and self._called[name] > 0 and self._loaded[name] == self._called[name]

    def _handed_on(self, node: ast.AST) -> Iterator[Name]:
        """Yield the names that get what may come with a message."""
        match node:
            case (
                ast.Assign(value=value)
                | ast.AnnAssign(value=ast.expr() as value)
                | ast.AugAssign(value=value)
            ):
                given = self._comes(value) or self._is_from_outside(value)
                yield from (self._key(one) for one in _targets(node) if given)
            case ast.NamedExpr(target=target, value=value):
                yield from [self._key(target)] if self._comes(value) else []
            case ast.For(target=target, iter=values) | ast.comprehension(target=target, iter=values):
                yield from (self._key(one) for one in _names(target) if self._comes(values))
            case ast.Match(subject=subject) if self._comes(subject):
                yield from (self._key(one) for case in node.cases for one in ast.walk(case.pattern))
            case ast.Call(func=function, args=given, keywords=named):
                if any(map(self._comes, (*given, *(one.value for one in named)))):
                    yield from self._received(function)

    def _received(self, function: ast.expr) -> Iterator[Name]:
        """Yield the names that get what a call is given: the parameters of what is called, or what keeps it."""
        name = _name(function)
        for one in (*self._named[name], *self._named["__init__"]):
            yield from ((one, given) for given in _given(one))
        if isinstance(function, ast.Attribute) and _name(function.value) not in ("", "self"):
            yield self._key(function.value)

    def _is_from_outside(self, value: ast.expr) -> bool:
        """Return whether a value may come from outside, where no callback is given what comes."""
        return not self._has_callbacks and any(isinstance(node, ast.Call) for node in ast.walk(value))

    def _key(self, node: ast.AST) -> Name:
        """Return what a name stands for: a function's own, or a module's; an attribute is one wherever it is used."""
        name = _name(node)
        if isinstance(node, ast.Attribute):
            return (None, f".{name}")
        function = self._above(node, *_FUNCTIONS)
        while function is not None and name not in self._own_names(function):
            function = self._above(function, *_FUNCTIONS)
        return (function, name)

    def _above(self, node: ast.AST, *kinds: type[ast.AST]) -> ast.AST | None:
        """Return the innermost of some kinds in which something stands."""
        above = self._parents.get(node)
        while above is not None and not isinstance(above, kinds):
            above = self._parents.get(above)
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
    """Return what a target gives values to."""
    match target:
        case ast.Tuple(elts=parts) | ast.List(elts=parts):
            return [name for part in parts for name in _names(part)]
        case ast.Starred(value=inner) | ast.Subscript(value=inner):
            return _names(inner)
    return [target] if _name(target) else []


def _given(function: ast.AST) -> list[str]:
    """Return the names of what a function is given, but itself."""
    args = (
        function.args if isinstance(function, _FUNCTIONS) else ast.arguments([], [], None, [], [], None, [])
    )
    every = [*args.posonlyargs, *args.args, *args.kwonlyargs, args.vararg, args.kwarg]
    return [one.arg for one in every if one and one.arg != "self"]


def _targets(node: ast.AST | None) -> list[ast.AST]:
    """Return what an assignment gives values to."""
    match node:
        case ast.Assign(targets=targets):
            return [name for target in targets for name in _names(target)]
        case ast.AnnAssign(target=target) | ast.AugAssign(target=target) | ast.NamedExpr(target=target):
            return _names(target)
    return []


def _own_names(function: ast.AST) -> frozenset[str]:
    """Return the names that are a function's own: what it is given, and what it gives a value."""
    names = {*_given(function)}
    inner: list[ast.AST] = [function]
    while inner:
        for node in ast.iter_child_nodes(inner.pop()):
            is_given = not isinstance(getattr(node, "ctx", None), (ast.Load, type(None)))
            if is_given or isinstance(node, (ast.MatchAs, ast.MatchStar)):
                names.add(_name(node))
            if not isinstance(node, (*_FUNCTIONS, ast.ClassDef)):
                inner.append(node)
    return frozenset(names)


def _is_look_up(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and _name(node.func) in _LOOKS_UP


def _does_something(statement: ast.stmt) -> bool:
    """Return whether a statement is more than a place for one."""
    match statement:
        case ast.Pass() | ast.Expr(value=ast.Constant()):
            return False
    return True
