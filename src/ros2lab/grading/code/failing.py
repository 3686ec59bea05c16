"""Which statements fail, or wait for ever, whenever they are reached: no value that their names may hold lets them end.

Nothing that comes after such a statement is done, whatever it waits for.
"""

from __future__ import annotations

import ast
import builtins
import importlib
import itertools
import math
import operator
import re
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any

from ros2lab.diagnose.sources.interfaces import is_interface
from ros2lab.diagnose.sources.node_source import LOG_METHODS, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import (
    YIELDS,
    Function,
    PythonSource,
    children,
    given_to,
    is_generator,
    walk,
)
from ros2lab.diagnose.sources.static_value import COMPARISONS
from ros2lab.grading.code.arguments import is_refused
from ros2lab.grading.code.cases import ARITHMETIC, Given, range_within
from ros2lab.grading.code.possible import Possible
from ros2lab.grading.code.ranges import Numbers

_ORDERS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)  # the comparisons that have no result for some values
_OPERATORS: Mapping[type[ast.AST], Callable[[Any, Any], Any]] = {
    **ARITHMETIC,
    **{kind: COMPARISONS[kind] for kind in _ORDERS},
}
_LARGEST = 10**15  # the largest number, and the longest text, to compute with
_MOST = 10_000  # the largest number that a function of Python's is given here, and how often one is asked
# What of Python's only computes something from what it is given, whoever has chosen that.
_COMPUTES = re.compile(
    r"builtins\.(int|float)|datetime\.(date|time|datetime|timedelta)(\.[a-z]\w*)?|math\.\w+|struct\.(un)?pack"
    r"|ipaddress\.ip_[a-z]+|uuid\.UUID|json\.loads|re\.compile|decimal\.Decimal"
)
# What is made empty, by the method that waits for what others put into it.
_WAITS = {
    "get": re.compile(r"queue\.\w*Queue|multiprocessing\.Queue"),
    "wait": re.compile(r"(threading|multiprocessing)\.Event"),
    "result": re.compile(r"concurrent\.futures\.Future"),
}
# What waits until an answer has come, by what its object is made with; and what gives a future for one.
_CALLS = {"call": "create_client", "send_goal": "ActionClient"}
_FUTURES = frozenset(("call_async", "send_goal_async", "get_result_async"))
_PASTIMES = LOG_METHODS | {"sleep", "print", "get_logger"}
_MORE_THREADS = re.compile(
    r"\b(?:async|asyncio|concurrent|multiprocessing|threading|_thread|subprocess)\b|Thread|Executor\b"
)
_LOOKS = frozenset(
    (
        "len",
        "str",
        "repr",
        "print",
        "sorted",
        "sum",
        "min",
        "max",
        "any",
        "all",
        "enumerate",
        "zip",
        "list",
        "tuple",
    )
)  # functions that change nothing of what they are given
_READS = frozenset(("get", "items", "keys", "values", "index", "count"))
_COMPOUND = (ast.Try, ast.With, ast.AsyncWith, ast.Match)
_LEAVES = (ast.Return, ast.Break, ast.Continue, *YIELDS, ast.Raise)


class _Message:
    """Stands for a message, which has no operators and no items."""


class Failing:
    """The statements of some files that fail whenever they are reached.

    Args:
        sources: the files.
        code: all code that may run.
        possible: what names may hold there.
    """

    def __init__(self, sources: NodeSources, code: Collection[ast.AST], possible: Possible) -> None:
        self._sources = sources
        self._code = code
        self._possible = possible
        self._known: dict[ast.AST, bool] = {}

    def fails(self, source: PythonSource, statement: ast.AST) -> bool:
        """Return whether a statement fails each time; False, too, if that is not known."""
        if statement not in self._known:
            self._known[statement] = False  # if it calls itself
            self._known[statement] = self._is_failing(source, statement)
        return self._known[statement]

    def _is_failing(self, source: PythonSource, statement: ast.AST) -> bool:
        match statement:
            case ast.ImportFrom(module=str(module), names=names, level=0):
                return any(self._possible.messages.lacks(f"{module}.{alias.name}") for alias in names)
            case ast.Assert(test=test) if self._possible.outcomes(test) == {False}:
                return True
            case ast.While(test=test, body=body) if self._waits_in_vain(test, body):
                return True
            case ast.For(iter=values) if self._are(values, (int, float, bool, type(None), _Message)):
                return True
            case ast.AugAssign(target=target, op=op, value=value) if target in self._possible.scopes:
                held = self._possible.stored_in(target)
                if self._has_no_result(op, held, self._possible.values(value), is_in_place=True):
                    return True
        return any(self._raises(source, node) for head in _heads(statement) for node in _evaluated(head))

    def _raises(self, source: PythonSource, node: ast.AST) -> bool:
        values = self._possible.values
        match node:
            case ast.BinOp(left=left, op=op, right=right):
                return self._has_no_result(op, values(left), values(right))
            case ast.Compare(left=left, ops=[op, *_], comparators=[right, *_]):
                return self._has_no_result(op, values(left), values(right))
            case ast.Subscript(ctx=ast.Load(), value=owner, slice=index) if not isinstance(index, ast.Slice):
                return self._has_no_item(owner, index)
            case ast.Attribute(value=owner, attr=name) if node in self._possible.scopes:
                held = values(owner)
                return bool(held) and all(self._has_no_member(value, name) for value in held)
            case ast.Call():
                return self._cannot_be_called(source, node)
        return False

    def _has_no_result(
        self, op: ast.AST, left: Collection[Any], right: Collection[Any], *, is_in_place: bool = False
    ) -> bool:
        """Return whether an operator has no result for any of the values on its sides."""
        compute = _OPERATORS.get(type(op))
        pairs = [(one, two) for one in left for two in right]
        if compute is None or not pairs:
            return False
        for pair in pairs:
            first, second = map(_example, pair)
            are_lists = isinstance(first, tuple) and (isinstance(second, tuple) or is_in_place)
            is_filled = isinstance(op, ast.Mod) and isinstance(first, str)
            is_repeated = isinstance(op, ast.Mult) and not all(
                type(side) in (int, float) for side in (first, second)
            )
            if _UNKNOWN in (first, second) or are_lists or is_filled or _is_large(first, second):
                return False
            if is_repeated and any(isinstance(side, (int, bool)) for side in (first, second)):
                return False
            if not _fails(compute, first, second):
                return False
        return True

    def _has_no_item(self, owner: ast.expr, index: ast.expr) -> bool:
        indices = self._possible.values(index)
        if not indices or any(isinstance(value, Given) and range_within(value) is None for value in indices):
            return False
        match self._literal(owner):
            case ast.Dict(keys=keys):
                known = [key.value for key in keys if isinstance(key, ast.Constant)]
                are_known = len(known) == len(keys) and not any(isinstance(value, Given) for value in indices)
                return are_known and not any(value in known for value in indices)
            case ast.List(elts=items) | ast.Tuple(elts=items) if not any(
                isinstance(item, ast.Starred) for item in items
            ):
                return all(_is_outside(len(items), value) for value in indices)
            case ast.Constant(value=str(text)):
                return all(_is_outside(len(text), value) for value in indices)
        return self._are(owner, (int, float, bool, type(None), _Message))

    def _literal(self, owner: ast.expr) -> ast.expr | None:
        """Return the list, dict or text that an expression is, if nothing changes it; None if that is not known."""
        if not isinstance(owner, (ast.Name, ast.Attribute)) or owner not in self._possible.scopes:
            return owner
        stores = self._possible.stores_of(owner)
        values = [store.value for store in stores if not (store.path or store.is_change)]
        if len(values) != 1 or len(stores) != 1:
            return None
        name = _last(owner)
        is_kept = isinstance(values[0], (ast.Tuple, ast.Constant)) or not any(
            _last(node) == name and not _only_looks(file, node)
            for file in self._sources.sources.values()
            for node in file.nodes
        )
        return values[0] if is_kept else None

    def _are(self, expression: ast.expr, kinds: tuple[type, ...]) -> bool:
        """Return whether all that an expression may be is of some kinds."""
        held = self._possible.values(expression)
        return bool(held) and all(type(_example(value)) in kinds for value in held)

    def _has_no_member(self, value: Any, name: str) -> bool:
        """Return whether a value has no such attribute."""
        if isinstance(value, Given) and is_interface(value.kind):
            fields = self._possible.messages.fields_of(value.kind)
            return fields is not None and name not in fields and not name.startswith(("_", "get_", "SLOT"))
        example = _example(value)
        kinds = (tuple, list, set, frozenset) if isinstance(example, tuple) else (type(example),)
        return example is not _UNKNOWN and not any(hasattr(kind, name) for kind in kinds)

    def _cannot_be_called(self, source: PythonSource, call: ast.Call) -> bool:
        if self._waits_for_ever(source, call) or self._computes_nothing(source, call):
            return True
        function = self._called(source, call)
        if function is not None:
            return is_refused(function, call) or self._always_fails(source, function)
        is_named = isinstance(call.func, (ast.Name, ast.Attribute)) and call.func in self._possible.scopes
        return is_named and self._are(call.func, (int, float, bool, str, tuple, type(None)))

    def _computes_nothing(self, source: PythonSource, call: ast.Call) -> bool:
        """Return whether a function of Python's fails for all that it may be given, and nothing of that is unknown."""
        name = self._sources.resolve(source, call.func) or ""
        name = f"builtins.{name}" if hasattr(builtins, name) else name
        words = [key.arg for key in call.keywords if key.arg]
        if not _COMPUTES.fullmatch(name) or len(words) < len(call.keywords):
            return False
        given = [self._possible.values(value) for value in given_to(call)]
        if not given or not all(values and all(map(_is_plain, values)) for values in given):
            return False
        if math.prod(map(len, given)) > _MOST:
            return False
        module, _, rest = name.partition(".")
        try:
            compute = operator.attrgetter(rest)(importlib.import_module(module))
        except AttributeError:  # of another Python
            return False
        count = len(call.args)
        return all(
            _fails(lambda *one: compute(*one[:count], **dict(zip(words, one[count:], strict=True))), *one)
            for one in itertools.product(*given)
        )

    def _waits_in_vain(self, test: ast.expr, body: Sequence[ast.stmt]) -> bool:
        """Return whether a loop goes on until the future of a request is done, and lets nothing come meanwhile."""
        inside = [node for part in body for node in walk(part)]
        calls = {_last(node.func) for node in inside if isinstance(node, ast.Call)}
        if not self._is_single or not calls <= _PASTIMES or any(isinstance(node, _LEAVES) for node in inside):
            return False
        both = test.values if isinstance(test, ast.BoolOp) and isinstance(test.op, ast.And) else [test]
        waits = (
            part.operand for part in both if isinstance(part, ast.UnaryOp) and isinstance(part.op, ast.Not)
        )
        asked = (it.func for it in waits if isinstance(it, ast.Call) and _last(it.func) == "done")
        return any(isinstance(it, ast.Attribute) and self._is_made_by(it.value, _FUTURES) for it in asked)

    def _is_made_by(self, owner: ast.expr, names: Collection[str]) -> bool:
        """Return whether all that a name or an attribute may be comes from calls of functions with some names."""
        if not isinstance(owner, (ast.Name, ast.Attribute)) or owner not in self._possible.scopes:
            return False
        values = [store.value for store in self._possible.stores_of(owner)]
        return bool(values) and all(isinstance(it, ast.Call) and _last(it.func) in names for it in values)

    @cached_property
    def _is_single(self) -> bool:
        """Whether one thread does all: what waits in it for an answer keeps it from coming, wherever it stands."""
        return not any(_MORE_THREADS.search(source.text) for source in self._sources.sources.values())

    def _waits_for_ever(self, source: PythonSource, call: ast.Call) -> bool:
        """Return whether a call waits for what nobody brings: all that is done with its object is to wait like this.

        So does one for an answer, where the only thread waits.
        """
        match call:
            case ast.Call(func=ast.Attribute(value=owner, attr=method), args=[_], keywords=[]) if (
                method in _CALLS
            ):
                return self._is_single and self._is_made_by(owner, (_CALLS[method],))
            case ast.Call(func=ast.Attribute(value=owner, attr=method), args=[], keywords=[]) if (
                method in _WAITS
                and isinstance(owner, (ast.Name, ast.Attribute))
                and owner in self._possible.scopes
            ):
                home = self._possible.scopes[owner][1]
                if home is not None and not self._sources.lineage(home)[2]:
                    return False  # a class that is not known may bring it
                stores = [store.value for store in self._possible.stores_of(owner)]
                made = [
                    self._sources.resolve(source, it.func) or "" for it in stores if isinstance(it, ast.Call)
                ]
                is_empty = len(made) == 1 and _WAITS[method].fullmatch(made[0])
                return bool(is_empty) and not self._is_had_by_others(_last(owner), method)
        return False

    def _is_had_by_others(self, name: str, method: str) -> bool:
        """Return whether anything else than calling a method is done with what has a name, or with what it belongs to."""
        files = self._sources.sources.values()
        uses = ((file.above(node), node) for file in files for node in file.nodes if _last(node) == name)
        given = (argument for file in files for call in file.calls for argument in given_to(call))
        return (
            self._possible.is_open
            or any(isinstance(argument, ast.Name) and argument.id == "self" for argument in given)
            or any(
                isinstance(node.ctx, ast.Load) and getattr(used, "attr", "") != method
                for used, node in uses
                if isinstance(node, (ast.Name, ast.Attribute))
            )
        )

    def _called(self, source: PythonSource, call: ast.Call) -> Function | None:
        """Return the function of the files that a call means, if there is only one of its name."""
        owner: NodeClass | None = self._possible.scopes[call][1] if call in self._possible.scopes else None
        if is_self_attribute(call.func):
            found = self._sources.method(owner, call.func.attr)
        else:
            name = self._sources.resolve(source, call.func) or ""
            found = self._sources.functions.get(name, (source, None))[1]
        if not isinstance(found, ast.FunctionDef) or found.decorator_list:
            return None
        return found if self._defined[found.name] == 1 else None

    @cached_property
    def _defined(self) -> Counter[str]:
        kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
        return Counter(node.name for node in self._possible.scopes if isinstance(node, kinds))

    def _always_fails(self, source: PythonSource, function: Function) -> bool:
        """Return whether one of the statements that a function certainly reaches fails."""
        home = self._possible.scopes[function][0] if function in self._possible.scopes else source
        if is_generator(function):
            return False
        for statement in function.body:
            if isinstance(statement, ast.Raise) or self.fails(home, statement):
                return True
            if isinstance(statement, _COMPOUND) or any(isinstance(n, _LEAVES) for n in walk(statement)):
                return False
        return False


_UNKNOWN = object()


def _heads(statement: ast.AST) -> Iterator[ast.expr]:
    """Yield the expressions that a statement evaluates whenever it is reached."""
    match statement:
        case ast.Assign(targets=targets, value=value):
            yield value
            yield from (target for target in targets if isinstance(target, ast.Attribute))
        case (
            ast.Expr(value=value)
            | ast.AugAssign(value=value)
            | ast.AnnAssign(value=ast.expr() as value)
            | ast.Return(value=ast.expr() as value)
            | ast.If(test=value)
            | ast.While(test=value)
            | ast.Assert(test=value)
            | ast.For(iter=value)
        ):
            yield value


def _evaluated(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes that are evaluated whenever an expression is."""
    yield node
    parts: Sequence[ast.AST]
    match node:
        case ast.Lambda():
            parts = ()
        case (
            ast.ListComp(generators=[first, *_])
            | ast.SetComp(generators=[first, *_])
            | ast.DictComp(generators=[first, *_])
            | ast.GeneratorExp(generators=[first, *_])
        ):
            parts = (first.iter,)
        case ast.BoolOp(values=[first, *_]) | ast.IfExp(test=first):
            parts = (first,)
        case ast.Compare(left=left, comparators=[right, *_]):
            parts = (left, right)
        case _:
            parts = [*children(node)]
    for part in parts:
        yield from _evaluated(part)


def _is_plain(value: Any) -> bool:
    """Return whether a value is known, and so small that whatever is computed from it takes no time."""
    if isinstance(value, (str, bytes)):
        numbers = re.findall(r"\d+", value if isinstance(value, str) else value.decode("latin-1"))
        return len(value) <= _MOST // 50 and all(len(digits) < 6 for digits in numbers)
    return value is None or (isinstance(value, (int, float)) and not abs(value) > _MOST)


def _example(value: Any) -> Any:
    """Return a value of the type that a value has; `_UNKNOWN` if that is not known."""
    if not isinstance(value, Given):
        return value if type(value) in (int, float, bool, str, bytes, tuple, type(None)) else _UNKNOWN
    if value.kind == "boolean":
        return True
    if is_interface(value.kind):
        return _Message()
    within = range_within(value)
    if within is None:
        return _UNKNOWN
    return (1 if within.is_whole else 1.5) if isinstance(within, Numbers) else "a"


def _is_large(*sides: Any) -> bool:
    return any(
        (isinstance(side, (int, float)) and abs(side) > _LARGEST)
        or (isinstance(side, (str, bytes, tuple)) and len(side) > 1000)
        for side in sides
    )


def _is_outside(count: int, index: Any) -> bool:
    """Return whether a list of so many items has none at an index."""
    if isinstance(index, Given):
        return not isinstance(_example(index), int)
    return not (isinstance(index, int) and -count <= index < count)


def _fails(compute: Callable[..., Any], *given: Any) -> bool:
    try:
        compute(*given)
    except Exception:  # that is the question
        return True
    return False


def _last(node: ast.AST) -> str:
    return getattr(node, "attr", getattr(node, "id", ""))


def _only_looks(source: PythonSource, node: ast.AST) -> bool:
    """Return whether nothing is changed by how a list or dict is used here."""
    if not isinstance(getattr(node, "ctx", None), ast.Load):
        return isinstance(source.above(node), (ast.Assign, ast.AnnAssign))
    match source.above(node):
        case ast.Subscript(ctx=ast.Load(), value=value):
            return value is node
        case ast.Call(func=ast.Name(id=name)):
            return name in _LOOKS and hasattr(builtins, name)
        case ast.Attribute(attr=name):
            return name in _READS
        case ast.Compare() | ast.For() | ast.comprehension() | ast.FormattedValue():
            return True
    return False
