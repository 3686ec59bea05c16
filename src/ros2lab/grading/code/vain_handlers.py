"""Handlers of errors that nothing raises: they handle nothing.

What comes from outside may fail: a message, a parameter, a file, an index, a number to divide by, any function that
is not known here. Constants, a node's own attributes and lines for the log do not.
"""

from __future__ import annotations

import ast
import builtins
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace

from ros2lab.diagnose.sources.node_source import LOG_METHODS
from ros2lab.diagnose.sources.python_source import Function, children, walk
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.handlers import ENDS, EVERY_ERROR, Handlers

_KNOWN = frozenset(
    ("get_logger", "get_clock", "now", "get_name", "get_namespace")
)  # never fail without arguments
_READS = frozenset(("get_parameter", "get_parameter_or", "has_parameter"))
_OF_A_NODE = frozenset(
    ("RuntimeError", "TypeError", *EVERY_ERROR)
)  # what Python's errors a node's making may raise

# What does not fail, and what does only if something in it does.
_FIRM = (
    ast.Constant, ast.Pass, ast.Break, ast.Continue, ast.Global, ast.Nonlocal, ast.Lambda, ast.FunctionDef,
    ast.AsyncFunctionDef, ast.expr_context, ast.boolop, ast.cmpop, ast.unaryop,
)  # fmt: skip
_OF_PARTS = (
    ast.Expr, ast.Assign, ast.AnnAssign, ast.NamedExpr, ast.Return, ast.If, ast.IfExp, ast.JoinedStr, ast.BoolOp,
    ast.UnaryOp, ast.Compare, ast.List, ast.Tuple, ast.Set, ast.Dict, ast.keyword,
)  # fmt: skip
# What raises these errors besides calls: https://docs.python.org/3/library/exceptions.html
_ONLY_BY: dict[str, tuple[type[ast.AST], ...]] = {
    "AssertionError": (ast.Assert,),
    "ImportError": (ast.Import, ast.ImportFrom),
    "ModuleNotFoundError": (ast.Import, ast.ImportFrom),
    **dict.fromkeys(("LookupError", "IndexError", "KeyError"), (ast.Subscript,)),
    "StopIteration": (),
    **dict.fromkeys(("UnicodeError", "UnicodeDecodeError", "UnicodeEncodeError"), ()),
    "ZeroDivisionError": (ast.Div, ast.FloorDiv, ast.Mod, ast.Pow),
}
# What raises such an error only by what is in it, unless it is named above.
_PLAIN = (
    ast.Attribute, ast.Subscript, ast.Slice, ast.BinOp, ast.AugAssign, ast.operator, ast.FormattedValue,
    ast.Name,
)  # fmt: skip
_SIZES = frozenset(("len", "bool", "str", "repr", "isinstance"))  # raise none of these errors
_NEVER_BY_PUBLISHING = _ONLY_BY.keys() - {
    "ImportError", "ModuleNotFoundError", "UnicodeError", "UnicodeDecodeError", "UnicodeEncodeError",
}  # fmt: skip
_FIRM_OPERATORS = (ast.Add, ast.Sub, ast.Mult)
# What is the same each time if its parts are, and where one looks for a part of it.
_SAME = (ast.BinOp, ast.BoolOp, ast.UnaryOp, ast.Compare, ast.Tuple, ast.List, ast.Set, ast.Dict, ast.Slice)
_HOLDERS = (ast.Name, ast.Attribute, ast.Constant, ast.Tuple, ast.List, ast.Dict)
_ASKS = frozenset(("get", "items", "keys", "values", "index", "count"))  # change nothing


class VainHandlers:
    """What can be raised in the code of some files.

    Args:
        nodes: everything in the files.
    """

    def __init__(self, nodes: Iterable[ast.AST]) -> None:
        nodes = [*nodes]
        self._bases = {
            node.name: {_last(dotted(base) or "?") for base in node.bases}
            for node in nodes
            if isinstance(node, ast.ClassDef)
        }
        self._functions: dict[str, list[Function]] = {}
        for node in nodes:
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                self._functions.setdefault(node.name, []).append(node)
        self._messages = {
            alias.asname or alias.name
            for node in nodes
            if isinstance(node, ast.ImportFrom) and (node.module or "").endswith(".msg")
            for alias in node.names
        }
        self._set_by = {
            id(inner): attributes
            for node in nodes
            if isinstance(node, ast.ClassDef) and (attributes := _always_set(node))
            for inner in _after_making(node)
        }
        self._constants = _constants(nodes)
        used = [node.exc for node in nodes if isinstance(node, ast.Raise) and node.exc is not None]
        used += [node.func for node in nodes if isinstance(node, ast.Call)]
        self._made = {
            _last(dotted(name.func if isinstance(name, ast.Call) else name) or "?") for name in used
        }

    def of(self, node: ast.Try, known: Handlers) -> list[ast.ExceptHandler]:
        """Return the handlers of a `try` that never catch anything.

        Args:
            node: the `try`.
            known: what the names of its file stand for.
        """
        vain, before = list[ast.ExceptHandler](), set[str]()
        for handler in node.handlers:
            names = {_last(name) for name in known.caught(handler)}
            errors = names - ENDS  # Ctrl-C comes anywhere
            is_taken = all(self._is_among(name, before) for name in errors)
            is_vain = (
                is_taken
                or _changes_nothing(node, handler)
                or all(map(self._is_never_made, errors))
                or _Tried(
                    errors, self._functions, self._set_by.get(id(node), ()), self._messages, self._constants
                ).is_vain(node.body)
            )
            if errors and is_vain:
                vain.append(handler)
            before |= names
        return vain

    def _is_among(self, name: str, others: Collection[str]) -> bool:
        """Return whether an error of this name is also one of the others."""
        if not EVERY_ERROR.isdisjoint(others):
            return name not in EVERY_ERROR or name in others
        return any(other in self._family(name) for other in others)

    def _family(self, name: str) -> set[str]:
        """Return the names of an error and of all that it is derived from, as far as they are known."""
        found, waiting = set[str](), [name]
        while waiting:
            name = waiting.pop()
            if name not in found:
                found.add(name)
                kind = getattr(builtins, name, None)
                waiting += self._bases.get(name, ())
                waiting += [base.__name__ for base in kind.__mro__[:-1]] if isinstance(kind, type) else []
        return found

    def _is_never_made(self, name: str) -> bool:
        """Return whether an error is a class of the files, and neither it nor one derived from it is made or raised."""
        derived = {other for other in self._bases if name in self._family(other)}
        return name in self._bases and derived.isdisjoint(self._made)


@dataclass(frozen=True)
class _Tried:
    """What a `try` tries.

    Attributes:
        errors: the names of the errors that are caught.
        computed: all functions, by name, which may be what the files compute when an attribute is asked for.
        always_set: the attributes that the node has whenever it comes here.
        messages: the names of the classes of messages.
        constants: the names of what is the same whatever comes.
        entered: the names of the functions whose bodies are being looked at.
    """

    errors: AbstractSet[str]
    computed: Mapping[str, Sequence[Function]]
    always_set: Collection[str] = ()
    messages: Collection[str] = ()
    constants: Collection[str] = ()
    entered: frozenset[str] = frozenset()

    def is_vain(self, body: Sequence[ast.stmt]) -> bool:
        """Return whether nothing of a block can raise such an error, or it does so whatever comes."""
        *others, last = body
        is_raised = isinstance(last, ast.Raise) and not (last.exc and self._may_fail(last.exc))
        return not any(map(self._may_fail, others if is_raised else body))

    def _catches(self, *names: str) -> bool:
        return not {*names}.isdisjoint(self.errors)

    def _may_fail(self, node: ast.AST) -> bool:
        if isinstance(node, _FIRM) or self.is_the_same(node):
            return False
        if isinstance(node, _PLAIN) and self._is_by_others(node):
            return any(map(self._may_fail, children(node)))
        if isinstance(getattr(node, "ctx", None), ast.Store) and isinstance(node, (ast.Tuple, ast.List)):
            return True  # there may be more values, or fewer
        parts = children(node) if isinstance(node, _OF_PARTS) else self._parts(node)
        return parts is None or any(map(self._may_fail, parts))

    def is_the_same(self, node: ast.AST) -> bool:
        """Return whether a node computes the same, or fails, whatever comes."""
        parts: Iterable[ast.AST] = [part for part in children(node) if isinstance(part, ast.expr)]
        match node:
            case ast.Name(ctx=ast.Load()) | ast.Attribute(value=ast.Name(), ctx=ast.Load()):
                is_missing = self._catches("AttributeError", "NameError", "UnboundLocalError")
                return _name(node) in self.constants and not is_missing
            case ast.Subscript(ctx=ast.Load(), value=held):
                is_same = isinstance(held, _HOLDERS)  # what is within may be changed
            case ast.Call(func=ast.Name(id=name), args=parts, keywords=[]):
                is_type = isinstance(getattr(builtins, name, None), type)
                is_same = name not in self.computed and (is_type or name in _SIZES)
            case ast.Call(func=ast.Attribute(value=of, attr=name), args=given, keywords=[]):
                is_same, parts = isinstance(of, ast.Constant) or name in _ASKS, (of, *given)
            case _:
                is_same = isinstance(node, (ast.Constant, *_SAME))
        return is_same and all(map(self.is_the_same, parts))

    def _is_by_others(self, node: ast.AST) -> bool:
        """Return whether all of the errors are known to come from something else than such a node."""
        is_computed = isinstance(node, ast.Attribute) and node.attr in self.computed
        return not is_computed and all(
            name in _ONLY_BY and not isinstance(node, _ONLY_BY[name]) for name in self.errors
        )

    def _parts(self, node: ast.AST) -> Iterable[ast.AST] | None:
        """Return what may fail of a node; None if it may itself."""
        parts: Iterable[ast.AST] | None = None
        match node:
            case ast.Name():
                parts = None if self._catches("NameError", "UnboundLocalError") else ()
            case ast.Attribute(value=ast.Name(id="self")) | ast.Attribute(value=ast.Name(), ctx=ast.Store()):
                parts = None if self._is_computed(node) else ()
            case ast.Try():
                parts = _of_try(node)
            case (
                ast.FormattedValue(value=value, format_spec=None)
                | ast.Subscript(value=ast.Constant() | ast.Dict() | ast.List() as value, slice=ast.Constant())
            ):
                parts = (value,)
            case (
                ast.BinOp(left=left, op=sign, right=right) | ast.AugAssign(target=left, op=sign, value=right)
            ) if isinstance(sign, _FIRM_OPERATORS):
                parts = None if self._catches("TypeError") else (left, right)
            case ast.Call():
                parts = self._given(node)
        return parts

    def _is_computed(self, node: ast.Attribute) -> bool:
        """Return whether to ask for an attribute, or to set it, may raise such an error."""
        is_foreign = any(not hasattr(builtins, name) for name in self.errors)
        is_there = isinstance(node.ctx, ast.Store) or node.attr in self.always_set
        is_missing = self._catches("AttributeError") and not is_there
        return is_foreign or is_missing or self._catches("TypeError") or node.attr in self.computed

    def _given(self, call: ast.Call) -> Sequence[ast.AST] | None:
        """Return what is given to a call that does not fail by itself; None if it may."""
        given = [*call.args, *call.keywords]
        match call.func:
            case ast.Attribute(attr=name, value=of):
                parts = self._given_to_method(name, of, given)
            case ast.Name(id=name):
                parts = given if self._is_firm(name, given) else None
            case _:
                parts = None
        return parts

    def _given_to_method(self, name: str, of: ast.expr, given: Sequence[ast.AST]) -> Sequence[ast.AST] | None:
        match of:
            case logger if name in LOG_METHODS and _is_logger(logger):
                return given
            case ast.Call(func=ast.Name(id="super")) if name == "__init__":
                is_pythons = all(hasattr(builtins, name) for name in self.errors)
                return given if is_pythons and not self._catches(*_OF_A_NODE) else None
            case _ if name in _KNOWN and not given:
                return [of]
            case _ if name == "publish" and name not in self.computed and self.errors <= _NEVER_BY_PUBLISHING:
                return [of, *given]
        return None

    def _is_firm(self, name: str, given: Sequence[ast.AST]) -> bool:
        """Return whether a function or class raises no such error by itself."""
        if name in self.computed:
            return name not in self.entered and self._is_firm_inside(name)
        if name == "print":
            return not self._catches("OSError", "BrokenPipeError", "UnicodeEncodeError")
        return (name in self.messages and not given) or (name in _SIZES and self.errors <= {*_ONLY_BY})

    def _is_firm_inside(self, name: str) -> bool:
        """Return whether the only function of a name raises no such error, whatever it is given."""
        only, *others = self.computed[name]
        inside = replace(self, entered=self.entered | {name})
        is_plain = isinstance(only, ast.FunctionDef) and not others and not only.decorator_list
        return is_plain and inside.is_vain(only.body)


def _changes_nothing(node: ast.Try, handler: ast.ExceptHandler) -> bool:
    """Return whether all goes on alike, with or without such an error: values are computed, and used by nobody."""
    is_nothing_done = all(
        isinstance(part, ast.Pass) or (isinstance(part, ast.Expr) and isinstance(part.value, ast.Constant))
        for part in handler.body
    )
    is_nothing_left = all(isinstance(part, ast.Expr) and _only_computes(part.value) for part in node.body)
    return is_nothing_done and is_nothing_left and not node.orelse


def _only_computes(value: ast.expr) -> bool:
    """Return whether an expression has no effect but its value, or its error."""
    calls = [part for part in walk(value) if isinstance(part, (ast.Call, ast.Await, ast.NamedExpr))]
    return all(isinstance(call, ast.Call) and _is_pure(call.func) for call in calls)


def _is_pure(function: ast.expr) -> bool:
    match function:
        case ast.Name(id=name):
            return name in _SIZES or (isinstance(getattr(builtins, name, None), type) and name != "type")
        case ast.Attribute(attr=name):
            return name in _KNOWN - {"get_logger"} or name in _READS
    return False


def _always_set(node: ast.ClassDef) -> set[str]:
    """Return the attributes that `__init__` sets whatever comes, and that nothing deletes."""
    made = [part for part in node.body if isinstance(part, ast.FunctionDef) and part.name == "__init__"]
    targets = [part for function in made for statement in function.body for part in _targets(statement)]
    deleted = {
        part.attr for part in walk(node) if isinstance(part, ast.Attribute) and isinstance(part.ctx, ast.Del)
    }
    return {part.attr for part in targets if isinstance(part, ast.Attribute) and _is_self(part)} - deleted


def _targets(statement: ast.stmt) -> list[ast.expr]:
    match statement:
        case ast.Assign(targets=targets):
            return targets
        case ast.AnnAssign(target=target, value=ast.expr()):
            return [target]
    return []


def _after_making(node: ast.ClassDef) -> Iterator[ast.Try]:
    """Yield each `try` of a class's methods, but for `__init__` and for what this calls itself."""
    methods = {part.name: part for part in node.body if isinstance(part, ast.FunctionDef)}
    made = [methods["__init__"]] if "__init__" in methods else []
    calls = {
        part.func.attr
        for function in made
        for part in walk(function)
        if isinstance(part, ast.Call) and isinstance(part.func, ast.Attribute)
    }
    for name, method in methods.items():
        if name not in {"__init__", *calls}:
            yield from (part for part in walk(method) if isinstance(part, ast.Try))


def _constants(nodes: Iterable[ast.AST]) -> set[str]:
    """Return the names that files bind once, to constants, and whose value is never given away, so that nobody changes it."""
    given, bound, used = dict[str, ast.expr](), Counter[str](), Counter[str]()
    for node in nodes:
        match node:
            case (
                ast.Assign(targets=[target], value=value)
                | ast.AnnAssign(target=target, value=ast.expr() as value)
            ):
                given[_name(target)] = value
            case ast.alias(name=name, asname=other):
                bound[other or name] += 1
            case ast.arg(arg=name) | ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                bound[name] += 1
            case ast.Subscript(value=held, ctx=ast.Load()) | ast.Compare(comparators=[held]):
                used[_name(held)] -= 1
            case ast.Call(func=ast.Name(id=name), args=[held]) if name in _SIZES:
                used[_name(held)] -= 1
        if isinstance(node, ast.Attribute) and node.attr in _ASKS:
            used[_name(node.value)] -= 1
        if isinstance(node, (ast.Name, ast.Attribute)):
            (used if isinstance(node.ctx, ast.Load) else bound)[_name(node)] += 1
    return {
        name
        for name, value in given.items()
        if name and bound[name] == 1 and (isinstance(value, ast.Constant) or not used[name])
        if _Tried(frozenset(), {}).is_the_same(value)
    }


def _name(node: ast.AST) -> str:
    """Return the name of something or of an attribute, whoever has it; empty if it is none."""
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""


def _is_self(node: ast.Attribute) -> bool:
    return isinstance(node.value, ast.Name) and node.value.id == "self"


def _is_logger(node: ast.AST) -> bool:
    return "log" in ast.unparse(node).lower()


def _last(name: str) -> str:
    return name.rpartition(".")[2]


def _of_try(node: ast.Try) -> list[ast.stmt]:
    """Return the statements of an inner `try` whose errors leave it."""
    is_open = not any(h.type is None or dotted(h.type) in EVERY_ERROR for h in node.handlers)
    after = [part for handler in node.handlers for part in handler.body]
    return [*(node.body if is_open else ()), *after, *node.orelse, *node.finalbody]
