"""Which parts of a statement can be reached, and under which conditions."""

from __future__ import annotations

import ast
import builtins
import contextlib
from collections.abc import Collection, Iterable, Iterator
from weakref import WeakKeyDictionary

from ros2lab.diagnose.code.bound_names import undefined_names
from ros2lab.diagnose.sources.python_source import PythonSource, children, walk
from ros2lab.grading.code.cases import leaves, text_of
from ros2lab.grading.code.failing import Failing
from ros2lab.grading.code.possible import Facts, Possible

_LEAVES = (ast.Return, ast.Raise, ast.Continue, ast.Break)
_PLAIN = (ast.Pass, ast.Expr, ast.Assign, ast.Constant, ast.Name, ast.Attribute, ast.expr_context)
_EXITS = frozenset(("sys.exit", "os._exit", "exit", "quit"))
_LETS_OTHERS = ("spin", "sleep", "wait")  # prefixes of functions that let callbacks or threads run
_BOTH = frozenset((True, False))
_UNDEFINED = WeakKeyDictionary[PythonSource, set[str]]()  # the results of `_undefined_in`


class Paths:
    """The paths through the code of some files.

    Args:
        sources: the files.
        possible: what names may hold in them; None lets only constants close a branch, and treats code after
            a spin like any other.
        failing: which statements fail whenever they are reached; None if only names that nothing defines are known.
        vain: the places of what does nothing.
    """

    def __init__(
        self,
        sources: Iterable[PythonSource],
        possible: Possible | None,
        failing: Failing | None = None,
        vain: Collection[str] = (),
    ) -> None:
        self._possible = possible
        self._failing = failing
        self._vain = vain
        self._own = {
            node.name
            for source in sources
            for node in source.nodes
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
        }

    def reached(self, source: PythonSource, node: ast.AST, facts: Facts) -> Iterator[tuple[ast.AST, Facts]]:
        """Yield the parts of a node that are reached if the node is, each with the facts that hold there."""
        if isinstance(node, ast.expr) and not isinstance(node, (ast.BoolOp, ast.IfExp)):
            yield from ((part, facts) for part in children(node))
            return
        shut, known = set[str](), dict[str, Facts]()
        match node:
            case ast.If(test=test) | ast.IfExp(test=test):
                truths = self._truths(test, facts)
                shut = {name for name, truth in (("body", True), ("orelse", False)) if truth not in truths}
                known = {"body": (*facts, (test, True)), "orelse": (*facts, (test, False))}
            case ast.While(test=test):
                facts = self._left(node, facts)
                shut = set() if True in self._truths(test, facts) else {"body"}
                known = {"body": (*facts, (test, True))}
            case ast.For(iter=values):
                facts = self._left(node, facts)
                shut = {"body"} if _truth(values) is False else set()
            case ast.Try(body=body):
                shut = {"handlers"} if all(map(_cannot_fail, body)) else set()
                if self._ends(source, body):
                    shut = {"handlers", "orelse", "finalbody"}
                after = self._left(node, facts)
                known = {"handlers": after, "finalbody": after}
            case ast.BoolOp():
                yield from self._joined(node, facts)
                return
        for name, value in ast.iter_fields(node):
            if name in shut:
                continue
            parts = value if isinstance(value, list) else [value]
            yield from self._until_left(source, parts, known.get(name, facts))

    def is_vain(self, source: PythonSource, part: ast.AST) -> bool:
        """Return whether a definition or a statement begins at the place of what does nothing, or a simple statement holds it."""
        if not self._vain or not isinstance(part, ast.stmt):
            return False
        last = part.lineno if hasattr(part, "body") else part.end_lineno or part.lineno
        return any(source.at(line) in self._vain for line in range(part.lineno, last + 1))

    def _joined(self, node: ast.BoolOp, facts: Facts) -> Iterator[tuple[ast.AST, Facts]]:
        yield node.op, facts
        decides = isinstance(node.op, ast.Or)
        for operand in node.values:
            yield operand, facts
            if self._truths(operand, facts) == {decides}:
                return
            facts = (*facts, (operand, not decides))

    def _until_left(
        self, source: PythonSource, parts: list[object], facts: Facts
    ) -> Iterator[tuple[ast.AST, Facts]]:
        """Yield the statements of a block up to the first that leaves it."""
        for part in parts:
            if not isinstance(part, ast.AST) or self.is_vain(source, part):
                continue
            if self._fails(source, part):
                return
            yield part, facts
            if not isinstance(part, ast.stmt):
                continue
            if _leaves(source, part) or self._ends(source, [part]):
                return
            if self._possible is None:
                continue
            truths: Collection[bool] = _BOTH
            if isinstance(part, ast.If):
                truths = self._passed(source, part, facts)
            elif isinstance(part, ast.While) and not _breaks(part):
                truths = self._truths(part.test, self._left(part, facts)) & {False}
            if not truths:
                return
            is_left = len(truths) == 1 and isinstance(part, (ast.If, ast.While))
            told = ((part.test, *truths),) if is_left else ()  # type: ignore[attr-defined]
            facts = (
                (*self._left(part, (*facts, *told)),)
                if isinstance(part, ast.If)
                else (*self._left(part, facts), *told)
            )

    def _fails(self, source: PythonSource, part: ast.AST) -> bool:
        """Return whether a statement fails, as by an undefined name, so that nothing after it is reached."""
        if self._failing is not None and self._failing.fails(source, part):
            return True
        if self._possible is None or not isinstance(part, (ast.Expr, ast.Assign, ast.AugAssign, ast.Return)):
            return False
        if not (undefined := _undefined_in(source)):
            return False
        inside = [*walk(part)]
        return not any(isinstance(node, ast.Lambda) for node in inside) and any(
            isinstance(node, ast.Name) and node.id in undefined for node in inside
        )

    def _passed(self, source: PythonSource, part: ast.If, facts: Facts) -> Collection[bool]:
        """Return the outcomes of an if statement's condition after which the next statement is reached."""
        truths = self._truths(part.test, facts)
        branches = {True: part.body, False: part.orelse}
        return {truth for truth in truths if not self._always_leaves(source, branches[truth])}

    def _always_leaves(self, source: PythonSource, body: list[ast.stmt]) -> bool:
        return any(
            _leaves(source, part)
            or self._ends(source, [part])
            or (
                isinstance(part, ast.If)
                and self._always_leaves(source, part.body)
                and self._always_leaves(source, part.orelse)
            )
            for part in body
        )

    def _truths(self, test: ast.expr, facts: Facts) -> frozenset[bool]:
        """Return the truth values that a condition may have."""
        truth = _truth(test)
        if truth is not None:
            return frozenset((truth,))
        return self._possible.outcomes(test, facts) if self._possible else _BOTH

    def _left(self, statement: ast.AST, facts: Facts) -> Facts:
        """Return the facts that still hold after a statement, which may have changed what they are about."""
        if not facts:
            return facts
        stored = set[str]()
        is_shared = False
        for node in walk(statement):
            match node:
                case ast.Name(ctx=ast.Store()) | ast.Attribute(ctx=ast.Store()):
                    stored.add(text_of(node))
                case ast.Call():
                    is_shared |= self._lets_others(node)
        return tuple(
            (test, truth)
            for test, truth in facts
            if not any(
                (is_shared and isinstance(leaf, ast.Attribute))
                or any(f"{text_of(leaf)}.".startswith(f"{name}.") for name in stored)
                for leaf in leaves(test)
            )
        )

    def _lets_others(self, call: ast.Call) -> bool:
        """Return whether a call may change attributes: it calls own code, waits, or is given the node."""
        name = getattr(call.func, "attr", getattr(call.func, "id", ""))
        is_given = any(
            isinstance(argument, ast.Name) and argument.id in ("self", "node") for argument in call.args
        )
        return name in self._own or name.startswith(_LETS_OTHERS) or is_given

    def _ends(self, source: PythonSource, body: list[ast.AST] | list[ast.stmt]) -> bool:
        """Return whether a program is over after some statements: it has spun, or shut rclpy down."""
        return self._possible is not None and any(_ends(source, part) for part in body)


def _undefined_in(source: PythonSource) -> set[str]:
    """Return the undefined names in a file; they are the same in each round."""
    if source not in _UNDEFINED:
        _UNDEFINED[source] = set()
        with contextlib.suppress(RecursionError):
            _UNDEFINED[source] = {name for name, _ in undefined_names(source)}
    return _UNDEFINED[source]


def _ends(source: PythonSource, part: ast.AST) -> bool:
    match part:
        case ast.Expr(value=ast.Call(func=ast.Attribute(attr="spin"))):
            return True
        case ast.Expr(value=ast.Call(func=function)):
            return source.resolve(function) in ("rclpy.spin", "rclpy.shutdown", "rclpy.try_shutdown")
        case ast.Try(body=body) | ast.With(body=body):
            return any(_ends(source, statement) for statement in body)
    return False


def _leaves(source: PythonSource, part: ast.AST) -> bool:
    match part:
        case ast.Expr(value=ast.Call(func=function)):
            return source.resolve(function) in _EXITS
    return isinstance(part, _LEAVES)


def ends_program(source: PythonSource, part: ast.AST) -> bool:
    """Return whether a statement ends its program, or never ends itself."""
    is_left = isinstance(part, ast.Raise) or (isinstance(part, ast.Expr) and _leaves(source, part))
    return is_left or _ends(source, part)


def _breaks(loop: ast.While) -> bool:
    return any(isinstance(node, ast.Break) for node in walk(loop))


def _truth(test: ast.expr) -> bool | None:
    """Return whether a condition of constants holds; None if it is not made of constants."""
    match test:
        case ast.Constant(value=value):
            return bool(value)
        case ast.List(elts=parts) | ast.Tuple(elts=parts) | ast.Dict(values=parts):
            return bool(parts)
        case ast.UnaryOp(op=ast.Not(), operand=inner):
            return None if (truth := _truth(inner)) is None else not truth
        case ast.BoolOp(op=sign, values=values):
            decides, truths = isinstance(sign, ast.Or), [*map(_truth, values)]
            return decides if decides in truths else None if None in truths else not decides
        case ast.Compare(left=ast.Constant(), comparators=[ast.Constant()]):
            with contextlib.suppress(TypeError):
                return bool(eval(compile(ast.Expression(test), "", "eval"), {}))  # noqa: S307 -- two constants
    return None


def _cannot_fail(statement: ast.stmt) -> bool:
    """Return whether a statement only assigns constants, what types make of constants, or other names."""
    made = [node for node in walk(statement) if is_made_of_constants(node)]
    return all(
        node in made
        or (
            isinstance(node, _PLAIN)
            and not (isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load))
        )
        for node in walk(statement)
    )


def is_made_of_constants(node: ast.AST) -> bool:
    """Return whether a node calls a built-in type with constants only, such as `float("2.0")`."""
    match node:
        case ast.Call(func=ast.Name(id=name), args=[*given], keywords=[]):
            is_type = isinstance(getattr(builtins, name, None), type)
            return is_type and all(isinstance(argument, ast.Constant) for argument in given)
    return False
