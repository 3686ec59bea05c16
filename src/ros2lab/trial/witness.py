"""Records the tests, statements, exceptions and objects of some files inside a running program; imports nothing of ros2lab.

Programs import it in their `sitecustomize`. At exit each process writes a file: for each test, how often it was true and
false and what was compared; for each statement, how often it came to its end, and for each function how often it was
called, on objects of which classes; for each loop, how many iterations it had each time; which exceptions were
caught or ended the program, with the values in the line that failed; which short texts were compared with which others,
or looked for among them; and what `changes` notes. Nothing else changes.
"""

# Every program imports it first, so it must not import pathlib.
# ruff: noqa: PTH100, PTH118, PTH120, PTH123

import ast
import atexit
import builtins
import contextlib
import importlib.machinery
import itertools
import json
import math
import operator
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sized
from types import CodeType, FrameType, TracebackType
from typing import Any

from . import sender
from .changes import NAME as _CHANGES
from .changes import Changes, Noting
from .values import HOLDERS, LONGEST, NUMBERS, PLAIN, Words, shown, values_in

WATCHED = "ROS2LAB_WITNESS"  # holds the folder for the notes, and the folders of the files to watch
_TESTS, _LOOPS, _MARKS = "ros2lab_tests", "ros2lab_loops", "ros2lab_marks"
_OBJECTS, _CAUGHT, _TEXTS = "ros2lab_objects", "ros2lab_caught", "ros2lab_texts"
_FLOATS = frozenset(("float", "float64", "float32"))  # those of NumPy, too
_LARGEST = 1e300  # what is greater may be no float, or infinite
_EXITS = (ast.Return, ast.Continue, ast.Break, ast.Raise)
_DEFINED = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
_LONGEST_MESSAGE, _MOST_TIMES, _MOST_ERRORS = 200, 1000, 50
_LONGEST_TEXT, _MOST_TEXTS, _MOST_PAIRS, _MOST_MET = 30, 20, 200, 500
_SIGNS: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    **{ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Is: operator.is_, ast.IsNot: operator.is_not},
    **{ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge},
    ast.In: lambda left, right: left in right,
    ast.NotIn: lambda left, right: left not in right,
}


_LOOKS = (ast.Eq, ast.NotEq, ast.In, ast.NotIn)
_pairs: dict[tuple[str, tuple[str, ...]], None] = {}  # a text, and those that it was compared with at once


def _meet(left: str, right: Any) -> None:
    """Note texts that are compared."""
    if len(left) <= _LONGEST_TEXT and len(_pairs) < _MOST_PAIRS:
        others = (right,) if type(right) is str else right if type(right) in HOLDERS else ()
        with contextlib.suppress(RuntimeError):  # another thread changes it
            first = itertools.islice(others, _MOST_TEXTS)
            _pairs[left, tuple(t for t in first if type(t) is str and len(t) <= _LONGEST_TEXT)] = None


def _looking(sign: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    """Return a comparison at one place, which notes the texts of its first times; two that it has met cost no time."""
    met: set[tuple[str, str]] = set()
    room = _MOST_MET

    def looked(left: Any, right: Any) -> Any:
        nonlocal room
        if room and type(left) is str and (type(right) is not str or (left, right) not in met):
            room -= 1
            if type(right) is str:
                met.add((left, right))
            _meet(left, right)
        return sign(left, right)

    return looked


class _Side:
    """One side of a test: its last value, or words for what may change; whether it changed; of numbers also bounds, ways, and nans."""

    def __init__(self) -> None:
        self.last: Any = self  # no value yet
        self.low: Any = None
        self.high: Any = None
        self.has_changed = self.has_value = self.rose = self.fell = False
        self.nans = 0

    def note(self, value: Any) -> None:
        kind, last = type(value), self.last
        if kind.__name__ in _FLOATS and value != value:  # noqa: PLR0124 -- only a NaN is not equal to itself
            self.nans += 1
        if kind not in PLAIN:
            value = Words(shown(value))
        elif value is last:
            return
        elif kind in NUMBERS and value == value:  # noqa: PLR0124 -- a NaN is not, and has no bounds
            if self.low is None:
                self.low = self.high = value
            self.low, self.high = min(value, self.low), max(value, self.high)
            if type(last) not in NUMBERS or last != last:  # noqa: PLR0124
                self.rose = self.fell = self.rose or self.has_value
            else:
                self.rose, self.fell = self.rose or value > last, self.fell or value < last
            self.has_value = True
        elif kind is str or kind is bytes:
            value = value[:LONGEST]
        if last is not self and not self.has_changed:
            self.has_changed = last != value or type(last) is not type(value)
        self.last = value

    def told(self) -> list[Any]:
        last = self.last if isinstance(self.last, Words) else shown(self.last)
        are_numbers = self.low != self.high and self.low > -_LARGEST and self.high < _LARGEST
        bounds = [shown(self.low), shown(self.high)] if are_numbers else []
        return ["" if self.last is self else last, self.has_changed, bounds, self.rose - self.fell, self.nans]


class _Test:
    """How often a test was true and false, with its sides; of two floats, also the values with which they nearly were equal."""

    def __init__(self, sides: int, sign: Callable[[Any, Any], Any] | None = None) -> None:
        self.sign, self.is_equality = sign and _looking(sign), sign is operator.eq
        self.sides = tuple(_Side() for _ in range(sides))
        self.held = self.failed = 0
        self.near: list[str] = []

    def outcome(self, result: Any) -> Any:
        """Return the truth of a result; the result itself if it has none, so that the program fails as without."""
        try:
            holds = True if result else False  # noqa: SIM210 -- faster
        except Exception:
            return result
        self.held, self.failed = self.held + holds, self.failed + (not holds)
        return holds

    def seen(self, value: Any) -> Any:
        self.held += 1
        return self.side(0, value)

    def noted(self, value: Any) -> Any:
        self.sides[0].note(value)
        return self.outcome(value)

    def side(self, place: int, value: Any) -> Any:
        self.sides[place].note(value)
        return value

    def compared(self, left: Any, right: Any) -> Any:
        result = self.sign(left, right)  # type: ignore[misc]
        self.sides[0].note(left)
        self.sides[1].note(right)
        if self.is_equality and (type(left) is float or type(right) is float):
            kinds = {type(left), type(right)}
            with contextlib.suppress(OverflowError):  # of an int that is no float
                if kinds <= NUMBERS and not result and math.isclose(left, right, rel_tol=1e-9, abs_tol=1e-9):
                    self.near = [shown(left), shown(right)]
        return self.outcome(result)


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


def is_marked(node: ast.AST) -> bool:
    """Return whether a statement is counted: it is no definition, and need not be the first of its file."""
    is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    is_of_future = isinstance(node, ast.ImportFrom) and node.module == "__future__"
    return isinstance(node, ast.stmt) and not (is_text or is_of_future or isinstance(node, _DEFINED))


class _Noting(ast.NodeTransformer):
    """Instruments each test, each loop, each function, each `except` and each statement of a file."""

    def __init__(self, path: str, tree: ast.Module, changes: Changes) -> None:
        self.path, self.changes = path, Noting(tree, self._key, changes)
        self.tests: dict[str, _Test] = {}
        self.looks: dict[str, Callable[[Any, Any], Any]] = {}
        self.loops: dict[str, _Loop] = {}
        self.marks: dict[str, Callable[[], int]] = {}

    def visit(self, node: ast.AST) -> Any:
        self.generic_visit(node)
        if isinstance(node, (ast.If, ast.While, ast.IfExp, ast.Assert)):
            node.test = self._condition(node.test)
        elif isinstance(node, ast.Compare) and len(node.ops) == 1 and isinstance(node.ops[0], _LOOKS):
            self.looks[self._key(node)] = _looking(_SIGNS[type(node.ops[0])])
            looked = ast.Subscript(ast.Name(_TEXTS, ast.Load()), ast.Constant(self._key(node)), ast.Load())
            call = ast.copy_location(ast.Call(looked, [node.left, *node.comparators], []), node)
            call.compare = node  # type: ignore[attr-defined]
            return call
        elif isinstance(node, ast.comprehension):
            node.ifs = [*map(self._condition, node.ifs)]
        elif isinstance(node, (ast.For, ast.AsyncFor)):
            node.body.insert(0, self._mark(node.target, node.body[0]))
            if isinstance(node, ast.For):
                self.loops[self._key(node.iter)] = _Loop()
                node.iter = self._call(node.iter, _LOOPS, "over", node.iter)
        elif isinstance(node, ast.Match):
            node.subject = self._test(node, "seen", _Test(1), node.subject)  # it may be a test itself
        elif isinstance(node, ast.match_case):
            node.guard = node.guard and self._condition(node.guard)
            node.body.insert(0, self._mark(node.pattern, node.body[0]))
        elif isinstance(node, ast.ExceptHandler):
            node.body.insert(0, self._noting(_CAUGHT, node.body[0], ast.Constant(self._key(node))))
        elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            place, first = int(ast.get_docstring(node, clean=False) is not None), node.body[0]
            node.body.insert(place, self._mark(node, first))
            if given := [*node.args.posonlyargs, *node.args.args][:1]:  # of a method, the object
                node.body.insert(place, self._noting(_OBJECTS, first, ast.Name(given[0].arg, ast.Load())))
            node.body[place:place] = self._beside(first, self.changes.entered(node))
        if not is_marked(node):
            return node
        mark = self._mark(node, node)  # type: ignore[arg-type]
        after = self._beside(node, self.changes.after(node))
        return [mark, node] if isinstance(node, _EXITS) else [node, mark, *after]

    def _condition(self, test: ast.expr) -> ast.expr:
        test = getattr(test, "compare", test)
        match test:
            case ast.Constant():
                return test
            case ast.UnaryOp(op=ast.Not(), operand=inner):
                test.operand = self._condition(inner)
                return test
            case ast.BoolOp(values=values):
                test.values = [*map(self._condition, values)]
                return self._test(test, "outcome", _Test(0), test)
            case ast.Compare(left=left, ops=[sign], comparators=[right]):
                return self._test(test, "compared", _Test(2, _SIGNS[type(sign)]), left, right)
            case ast.Compare(left=left, comparators=others):
                noting, parts = _Test(1 + len(others)), [left, *others]
                test.left, *test.comparators = (
                    part
                    if isinstance(part, ast.Constant)
                    else self._test(test, "side", noting, ast.Constant(place), part)
                    for place, part in enumerate(parts)
                )
                return self._test(test, "outcome", noting, test)
        return self._test(test, "noted", _Test(1), test)

    def _test(self, node: ast.expr | ast.Match, method: str, noting: _Test, *given: ast.expr) -> ast.expr:
        self.tests[self._key(node)] = noting
        return self._call(node, _TESTS, method, *given)

    def _key(self, node: Any) -> str:
        return f"{self.path}:{node.lineno}:{node.col_offset}:{node.end_lineno}:{node.end_col_offset}"

    def _mark(self, node: ast.AST, beside: ast.stmt) -> ast.stmt:
        """Return a statement that counts how often it is reached, in the name of a node."""
        key = self._key(node)
        self.marks[key] = itertools.count().__next__
        found = ast.Subscript(ast.Name(_MARKS, ast.Load()), ast.Constant(key), ast.Load())
        return ast.copy_location(ast.Expr(ast.Call(found, [], [])), beside)

    def _beside(self, node: ast.AST, calls: Iterable[ast.expr]) -> list[ast.stmt]:
        return [ast.copy_location(ast.Expr(call), node) for call in calls]

    def _noting(self, name: str, beside: ast.stmt, given: ast.expr) -> ast.stmt:
        return ast.copy_location(ast.Expr(ast.Call(ast.Name(name, ast.Load()), [given], [])), beside)

    def _call(self, node: ast.expr | ast.Match, holder: str, method: str, *given: ast.expr) -> ast.expr:
        found = ast.Subscript(ast.Name(holder, ast.Load()), ast.Constant(self._key(node)), ast.Load())
        return ast.copy_location(ast.Call(ast.Attribute(found, method, ast.Load()), [*given], []), node)


class _Errors:
    """The exceptions that were caught, or that ended the program: where they were raised, and the values there."""

    def __init__(self, paths: Mapping[str, object]) -> None:
        self.paths = paths
        self.found: dict[tuple[str, str, str], list[Any]] = {}

    def caught(self, key: str) -> None:
        """Note the exception that is being handled, under the key of its `except`."""
        self.note(key, sys.exc_info()[1])

    def ended(self) -> None:
        """Note the exception that ended the program, with the one that it came from."""
        if error := getattr(sys, "last_value", None):
            self.note("", error)
            self.note("", error.__cause__ or error.__context__)

    def note(self, key: str, error: BaseException | None) -> None:
        if error is None:
            return
        message = "?"
        with contextlib.suppress(Exception):  # of the program's own __str__
            message = str(error)[:_LONGEST_MESSAGE]
        known = key, type(error).__name__, message
        if known not in self.found and len(self.found) < _MOST_ERRORS:
            frames, values = [*_frames(error.__traceback__, self.paths)], list[Any]()
            with contextlib.suppress(Exception):
                values = values_in(*frames[-1])
            lines = [f"{frame.f_code.co_filename}:{line}:0:{line}:0" for frame, line in frames]
            self.found[known] = [*known, 0, lines, values]
        if known in self.found:
            self.found[known][3] += 1


def _frames(trace: TracebackType | None, paths: Mapping[str, object]) -> Iterator[tuple[FrameType, int]]:
    """Yield the frames of a traceback that are in watched files, each with its line, the outermost first."""
    while trace is not None:
        if trace.tb_frame.f_code.co_filename in paths:
            yield trace.tb_frame, trace.tb_lineno
        trace = trace.tb_next


def _file_of(kind: type) -> str:
    return os.path.realpath(getattr(sys.modules.get(kind.__module__), "__file__", None) or "")


def _watch(folders: tuple[str, ...], changes: Changes, watched: Callable[[_Noting], None]) -> None:
    """Instrument the files in some folders when they are imported."""
    loader = importlib.machinery.SourceFileLoader
    plain = loader.get_code

    def get_code(self: Any, name: str) -> CodeType | None:
        path = os.path.realpath(self.get_filename(name))
        if not path.startswith(folders):
            return plain(self, name)
        try:
            tree = ast.parse(self.get_data(path), path)
            noting = _Noting(path, tree, changes)
            code: CodeType = compile(
                ast.fix_missing_locations(noting.visit(tree)), path, "exec", dont_inherit=True
            )
        except Exception:
            return plain(self, name)
        watched(noting)  # a file that cannot be instrumented is left as it is
        return code

    setattr(loader, "get_code", get_code)  # noqa: B010 -- a method of the standard library


def begin() -> None:
    """Watch the files in the folders that the environment names."""
    folder, *folders = os.environ.get(WATCHED, "").split(os.pathsep)
    if not folders:
        return
    sender.begin(folder)
    tests: dict[str, _Test] = {}
    looks: dict[str, Callable[[Any, Any], Any]] = {}
    loops: dict[str, _Loop] = {}
    marks: dict[str, Callable[[], int]] = {}
    kinds: dict[int, type] = {}
    paths: dict[str, None] = {}
    errors = _Errors(paths)
    changes = Changes(paths)

    def note_object(found: object) -> None:
        kinds[id(type(found))] = type(found)

    def watched(noting: _Noting) -> None:
        tests.update(noting.tests)
        looks.update(noting.looks)
        loops.update(noting.loops)
        marks.update(noting.marks)
        paths[noting.path] = None

    holders = (tests, loops, marks, note_object, errors.caught, changes.notes, looks)
    for name, holder in zip(
        (_TESTS, _LOOPS, _MARKS, _OBJECTS, _CAUGHT, _CHANGES, _TEXTS), holders, strict=True
    ):
        setattr(builtins, name, holder)

    def write() -> None:
        # A thread may still run, and nothing of this may be printed.
        with contextlib.suppress(Exception):
            errors.ended()
            told = {
                "tests": {
                    key: [test.held, test.failed, [side.told() for side in test.sides], test.near]
                    for key, test in tests.items()
                    if test.held or test.failed
                },
                "marks": {key: count for key, mark in marks.items() if (count := mark())},
                "errors": [*errors.found.values()],
                "classes": [(_file_of(kind), kind.__qualname__) for kind in kinds.values()],
                "texts": [*_pairs],
                "loops": {key: loop.turns for key, loop in loops.items() if loop.turns},
                "paths": [],
                "lists": [],
            }
            with contextlib.suppress(Exception):
                told |= changes.told()
            with open(os.path.join(folder, f"{os.getpid()}.json"), "w", encoding="utf-8") as file:
                json.dump(told, file)

    atexit.register(write)
    _watch(tuple(os.path.realpath(watched) + os.sep for watched in folders), changes, watched)


def make_room() -> None:
    """Import another `sitecustomize` on the path, if there is one."""
    home = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    sys.path[:] = [folder for folder in sys.path if os.path.abspath(folder) != home]
    this = sys.modules.pop("sitecustomize")
    try:
        __import__("sitecustomize")
    except ImportError:
        sys.modules["sitecustomize"] = this
