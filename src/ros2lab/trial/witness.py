"""Records the conditions, loops and objects of some files inside a running program; imports nothing of ros2lab.

Programs import it as `sitecustomize`. At exit each process writes a file: for each condition, how often it was
true and false and what was compared the last time; for each loop, how many iterations it had each time; which
functions were called, on objects of which classes; and which statements came to their end. Nothing else in the program changes, and a file that cannot be instrumented is left as it is.
"""

# Every program imports it first, so it must not import pathlib.
# ruff: noqa: PTH100, PTH118, PTH120, PTH123

import ast
import atexit
import builtins
import contextlib
import importlib.machinery
import json
import math
import operator
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sized
from types import CodeType
from typing import Any

WATCHED = "ROS2LAB_WITNESS"  # holds the folder for the notes, and the folders of the files to watch
_CONDITIONS, _LOOPS, _CALLS = "ros2lab_conditions", "ros2lab_loops", "ros2lab_calls"
_OBJECTS, _DONE = "ros2lab_objects", "ros2lab_done"
_SIMPLE = (ast.Expr, ast.Assign, ast.AnnAssign, ast.AugAssign, ast.Import, ast.ImportFrom, ast.Delete)
_LONGEST, _MOST_TIMES = 60, 1000
_SHORT = frozenset(
    ("rclpy.duration", "rclpy.time", "datetime", "enum")
)  # modules whose objects have a short repr
_SIGNS: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda left, right: left in right,
    ast.NotIn: lambda left, right: left not in right,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
}


def _shown(value: object) -> str:
    """Return a short repr of a value, quickly: a condition may be evaluated a thousand times a second."""
    try:
        if isinstance(value, (str, bytes)):
            return repr(value[:_LONGEST])
        is_short = value is None or isinstance(value, (int, float)) or type(value).__module__ in _SHORT
        return repr(value)[:_LONGEST] if is_short else f"a {type(value).__name__}"
    except Exception:
        return "?"


class _Condition:
    """How often a condition was true and false, the values of its sides the last time, and whether they changed.

    Of two floats that are not equal, also the values with which they nearly were.
    """

    def __init__(self, sign: Callable[[Any, Any], Any] = operator.eq) -> None:
        self.sign = sign
        self.held = self.failed = 0
        self.sides: list[str] = []
        self.near: list[str] = []
        self.has_changed = False

    def noted(self, result: Any, *sides: object) -> Any:
        try:
            holds = bool(result)
        except Exception:
            return result
        self.held, self.failed = self.held + holds, self.failed + (not holds)
        shown = [_shown(side) for side in sides]
        self.has_changed |= bool(self.sides) and shown != self.sides
        self.sides = shown
        kinds = {*map(type, sides)}
        if self.sign is operator.eq and not holds and float in kinds and kinds <= {float, int}:
            self.near = shown if math.isclose(*sides, rel_tol=1e-9, abs_tol=1e-9) else self.near  # type: ignore[arg-type]
        return result

    def compared(self, left: Any, right: Any) -> Any:
        return self.noted(self.sign(left, right), left, right)


class _Loop:
    """The runs of a loop: iterations, type and length of the iterable, and whether it ended early."""

    def __init__(self) -> None:
        self.turns: list[tuple[int, str, int | None, bool]] = []

    def over(self, values: Iterable[Any]) -> Iterator[Any]:
        least = None
        with contextlib.suppress(Exception):  # a class of the program may raise anything
            least = len(values) if isinstance(values, Sized) else None
        done, is_left = 0, True
        try:
            for value in values:
                done += 1
                yield value
            is_left = False
        finally:
            if len(self.turns) < _MOST_TIMES:
                self.turns.append((done, type(values).__name__, least, is_left))


def _stands_first(node: ast.stmt) -> bool:
    """Return whether a statement may have to be the first of its file: a docstring, or an import of the future."""
    is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    return is_text or (isinstance(node, ast.ImportFrom) and node.module == "__future__")


class _Noting(ast.NodeTransformer):
    """Instruments each condition, each loop, each function and each simple statement of a file."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.conditions: dict[str, _Condition] = {}
        self.loops: dict[str, _Loop] = {}

    def visit(self, node: ast.AST) -> Any:
        self.generic_visit(node)
        if isinstance(node, (ast.If, ast.While, ast.IfExp)):
            node.test = self._condition(node.test)
        elif isinstance(node, ast.For):
            self.loops[self._key(node.iter)] = _Loop()
            node.iter = self._call(node.iter, _LOOPS, "over", node.iter)
        elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            key = ast.Constant(self._key(node))
            noting = ast.Call(ast.Attribute(ast.Name(_CALLS, ast.Load()), "add", ast.Load()), [key], [])
            has_text = ast.get_docstring(node, clean=False) is not None
            node.body.insert(int(has_text), ast.copy_location(ast.Expr(noting), node.body[0]))
            if given := [*node.args.posonlyargs, *node.args.args][:1]:  # of a method, the object
                shown = ast.Call(ast.Name(_OBJECTS, ast.Load()), [ast.Name(given[0].arg, ast.Load())], [])
                node.body.insert(int(has_text), ast.copy_location(ast.Expr(shown), node.body[0]))
        elif isinstance(node, _SIMPLE) and not _stands_first(node):
            noting = ast.Call(ast.Name(_DONE, ast.Load()), [ast.Constant(self._key(node))], [])
            return [node, ast.copy_location(ast.Expr(noting), node)]
        return node

    def _condition(self, test: ast.expr) -> ast.expr:
        match test:
            case ast.BoolOp(values=values):
                test.values = [self._condition(value) for value in values]
            case ast.UnaryOp(op=ast.Not(), operand=inner):
                test.operand = self._condition(inner)
            case ast.Compare(left=left, ops=[sign], comparators=[right]):
                self.conditions[self._key(test)] = _Condition(_SIGNS[type(sign)])
                return self._call(test, _CONDITIONS, "compared", left, right)
        return test

    def _key(self, node: ast.expr | ast.stmt) -> str:
        return f"{self.path}:{node.lineno}:{node.col_offset}"

    def _call(self, node: ast.expr, holder: str, method: str, *given: ast.expr) -> ast.expr:
        found = ast.Subscript(ast.Name(holder, ast.Load()), ast.Constant(self._key(node)), ast.Load())
        return ast.copy_location(ast.Call(ast.Attribute(found, method, ast.Load()), [*given], []), node)


def _written(kind: type) -> tuple[str, str]:
    """Return the file in which a class is written, and its name there."""
    file = getattr(sys.modules.get(kind.__module__), "__file__", None)
    return os.path.realpath(file or ""), kind.__qualname__


def _watch(folders: tuple[str, ...], conditions: dict[str, _Condition], loops: dict[str, _Loop]) -> None:
    """Instrument the files in some folders when they are imported."""
    loader = importlib.machinery.SourceFileLoader
    plain = loader.get_code

    def get_code(self: Any, name: str) -> CodeType | None:
        path = os.path.realpath(self.get_filename(name))
        if not path.startswith(folders):
            return plain(self, name)
        try:
            noting = _Noting(path)
            tree = ast.fix_missing_locations(noting.visit(ast.parse(self.get_data(path), path)))
            code: CodeType = compile(tree, path, "exec", dont_inherit=True)
        except Exception:
            return plain(self, name)
        conditions.update(noting.conditions)
        loops.update(noting.loops)
        return code

    setattr(loader, "get_code", get_code)  # noqa: B010 -- a method of the standard library


def _begin() -> None:
    folder, *folders = os.environ.get(WATCHED, "").split(os.pathsep)
    if not folders:
        return
    conditions: dict[str, _Condition] = {}
    loops: dict[str, _Loop] = {}
    setattr(builtins, _CONDITIONS, conditions)
    setattr(builtins, _LOOPS, loops)
    calls: set[str] = set()
    setattr(builtins, _CALLS, calls)
    done: set[str] = set()
    setattr(builtins, _DONE, done.add)
    kinds: dict[int, type] = {}

    def note_object(found: object) -> None:
        kinds[id(type(found))] = type(found)

    setattr(builtins, _OBJECTS, note_object)

    def write() -> None:
        asked = {
            key: condition for key, condition in conditions.items() if condition.held or condition.failed
        }
        told = {
            "conditions": {
                key: [found.held, found.failed, found.sides, found.has_changed, found.near]
                for key, found in asked.items()
            },
            "calls": dict.fromkeys(calls),
            "done": dict.fromkeys(done),
            "classes": [*map(_written, kinds.values())],
            "loops": {key: loop.turns for key, loop in loops.items() if loop.turns},
        }
        with open(os.path.join(folder, f"{os.getpid()}.json"), "w", encoding="utf-8") as file:
            json.dump(told, file)

    atexit.register(write)
    _watch(tuple(os.path.realpath(watched) + os.sep for watched in folders), conditions, loops)


def _make_room() -> None:
    """Import another `sitecustomize` on the path, if there is one."""
    home = os.path.dirname(os.path.abspath(__file__))
    sys.path[:] = [folder for folder in sys.path if os.path.abspath(folder) != home]
    this = sys.modules.pop("sitecustomize")
    try:
        __import__("sitecustomize")
    except ImportError:
        sys.modules["sitecustomize"] = this


if __name__ == "sitecustomize":
    _begin()
    _make_room()
