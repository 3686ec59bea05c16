"""A Python file parsed by `ast`; nothing in it is ever run."""

from __future__ import annotations

import ast
import itertools
import math
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TypeGuard, TypeVar

from ros2lab.diagnose.finding import at
from ros2lab.diagnose.sources.bindings import Import, bound_by, imports_in
from ros2lab.diagnose.sources.file_texts import bytes_of, decoded
from ros2lab.diagnose.sources.kept import kept
from ros2lab.diagnose.sources.marks import mark
from ros2lab.diagnose.sources.static_value import bound, dotted

_Kind = TypeVar("_Kind", bound=ast.stmt)
_Given = TypeVar("_Given", bound=ast.expr | None)
Function = ast.FunctionDef | ast.AsyncFunctionDef
_SCOPES = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef, ast.Module)
YIELDS = (ast.Yield, ast.YieldFrom)
PAUSES = (*YIELDS, ast.Await, ast.AsyncFor, ast.AsyncWith)  # where others may go on before the function does

DEEPEST = 200  # levels; a deeper tree was not written by hand, and is ignored


@dataclass(eq=False)
class PythonSource:
    """A Python file.

    Attributes:
        name: its import name, such as `robot_controller.status_publisher`.
        path: its path; None if it is not on disk.
        fault, warned, is_beyond: set by `tree`: why Python cannot parse it, its warnings, whether it is too deep for us.
    """

    name: str
    shown: str
    text: str
    is_package: bool = False
    path: Path | None = None
    fault: SyntaxError | None = field(default=None, init=False)
    is_beyond: bool = field(default=False, init=False)
    warned: list[tuple[int, str]] = field(default_factory=list, init=False)
    _resolved: dict[ast.AST, str | None] = field(default_factory=dict, init=False, repr=False)

    @cached_property
    def tree(self) -> ast.Module:
        """The parsed file; if it cannot be parsed, an empty module, and `fault` says why."""
        try:
            with warnings.catch_warnings(record=True) as warned:
                warnings.simplefilter("always")
                tree = self.parsed()
                self.is_beyond = _depth(tree) >= DEEPEST
                if self.is_beyond:
                    return ast.Module([], [])
                compile(tree, self.shown, "exec", dont_inherit=True)  # not run; it gives more warnings
            self.warned = [(warning.lineno, str(warning.message)) for warning in warned]
            bound(walk(tree))
            mark(walk(tree))
            return tree
        except SyntaxError as error:
            self.fault = error
        except (ValueError, RecursionError, MemoryError) as error:  # a null byte, thousands of brackets
            self.is_beyond = isinstance(error, RecursionError)
            self.fault = SyntaxError(str(error) or "too deeply nested", (self.shown, 1, 1, ""))
        return ast.Module([], [])

    def parsed(self) -> ast.Module:
        """Parse the text; the bytes of the file where they are not in the encoding that Python expects, so that it says so."""
        heading = itertools.takewhile(lambda line: line.lstrip()[:1] in (b"", b"#"), self.lines[:2])
        ast.parse(b"".join(heading))  # of a text, Python does not look at the encoding that it declares
        is_other = self.path is not None and "\ufffd" in self.text
        return ast.parse(bytes_of(self.path) if self.path and is_other else self.text)

    @property
    def readable_to(self) -> float:
        """The line at which Python stops with a syntax error; infinite if there is none."""
        _ = self.tree
        return (self.fault.lineno or 1) if self.fault else math.inf

    def at(self, node: ast.AST | int | None) -> str:
        """Return the place of a node or a line, such as `src/pk/pk/talk.py:12`."""
        return at(self.shown, node if isinstance(node, int) else getattr(node, "lineno", None))

    @cached_property
    def nodes(self) -> tuple[ast.AST, ...]:
        """All syntax nodes of the file."""
        return walk(self.tree)

    def around(self, line: int, kind: type[_Kind]) -> list[_Kind]:
        """Return the statements of a kind that contain a line, the outermost first."""
        return [n for n in self.nodes if isinstance(n, kind) and contains(n, line)]

    def function_at(self, line: int) -> Function | None:
        """Return the innermost function around a line."""
        found = [node for node in self.nodes if isinstance(node, Function) and contains(node, line)]
        return max(found, key=lambda node: node.lineno, default=None)

    def class_at(self, line: int) -> ast.ClassDef | None:
        """Return the innermost class around a line."""
        return next(reversed(self.around(line, ast.ClassDef)), None)

    def written(self, node: _Given) -> ast.expr | _Given:
        """Return the value of a name that the file assigns only once, and nothing hides; any other expression as it is."""
        if not isinstance(node, (ast.Name, ast.Attribute)):
            return node
        values = self.stored.get(ast.unparse(node), ())
        return (values[0] if len(values) == 1 and values[0] in self.given(node) else None) or node

    def given(self, node: ast.Name | ast.Attribute) -> Sequence[ast.expr | None]:
        """Return what a name is given where it is bound, or an attribute in the file; None for what is not assigned."""
        if isinstance(node, ast.Name) and (found := self.binders(node))[0] is not None:
            values = {id(target): value for target, value in assignments(own_nodes(found[0]))}
            return [values.get(id(binder)) for binder in found[1]]
        return self.stored.get(ast.unparse(node), ())

    def binders(self, name: ast.Name) -> tuple[ast.AST | None, Sequence[ast.AST], bool]:
        """Return the scope whose binding of a name holds at its place, what binds it there, and whether that is around it.

        A function around the name runs later than what is around the function. None and nothing if no scope binds it.
        """
        inner: ast.AST = name
        is_later = False
        while (scope := self.above(inner)) is not None:
            # Decorators, defaults, annotations and bases are evaluated in the scope around.
            is_inside = isinstance(inner, ast.stmt) or inner is getattr(scope, "body", None)
            is_class = isinstance(scope, ast.ClassDef)  # whose names its methods do not see
            if is_inside and isinstance(scope, _SCOPES) and not (is_later and is_class):
                if bound := _bound(scope).get(name.id):
                    return scope, bound, not is_later
                is_later |= not is_class
            inner = scope
        return None, (), False

    @cached_property
    def classes(self) -> Mapping[str, ast.ClassDef]:
        """The classes that the file defines at its top level, by their names."""
        return {node.name: node for node in self.tree.body if isinstance(node, ast.ClassDef)}

    @cached_property
    def functions(self) -> Mapping[str, Function]:
        """The functions that the file defines at its top level, by their names."""
        return {node.name: node for node in self.tree.body if isinstance(node, Function)}

    @cached_property
    def calls(self) -> tuple[ast.Call, ...]:
        """All calls of the file."""
        return tuple(node for node in self.nodes if isinstance(node, ast.Call))

    def above(self, node: ast.AST) -> ast.AST | None:
        """Return the syntax node around another one; None for the file itself."""
        return self._above.get(id(node))

    def is_called(self, node: ast.AST) -> bool:
        """Return whether an expression is called."""
        around = self.above(node)
        return isinstance(around, ast.Call) and around.func is node

    def gives(self, node: ast.AST) -> TypeGuard[ast.Attribute]:
        """Return whether a node is an attribute that is given a value, and not only changed, as by `+=`."""
        is_set = isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)
        return is_set and not isinstance(self.above(node), ast.AugAssign)

    @cached_property
    def _above(self) -> Mapping[int, ast.AST]:
        return {id(child): node for node in self.nodes for child in children(node)}

    @cached_property
    def lines(self) -> list[bytes]:
        """The lines of its text, with their ends."""
        return self.text.encode().splitlines(keepends=True)

    def segment(self, node: ast.expr | ast.keyword) -> str:
        """Return an expression as it is written in the file."""
        last = node.end_lineno or node.lineno
        lines = self.lines[node.lineno - 1 : last]
        if not lines:
            return ast.unparse(node)
        whole, after = b"".join(lines), len(lines[-1]) - (node.end_col_offset or 0)
        return whole[node.col_offset : len(whole) - after].decode(errors="replace")

    @cached_property
    def stored(self) -> Mapping[str, list[ast.expr | None]]:
        """The names and attributes that are assigned to, as they are written, with the values of plain assignments."""
        alone = [node for node in self.nodes if isinstance(node, ast.Assign) and len(node.targets) == 1]
        values = {id(node.targets[0]): node.value for node in alone}
        found: dict[str, list[ast.expr | None]] = {}
        for node in self.nodes:
            if isinstance(node, (ast.Name, ast.Attribute)) and isinstance(node.ctx, ast.Store):
                found.setdefault(ast.unparse(node), []).append(values.get(id(node)))
        return found

    @property
    def hidden(self) -> Path | None:
        """The file that Python never imports, because the folder of this one has its name; None if there is none."""
        file = self.path.parent.with_suffix(".py") if self.path and self.is_package else None
        return file if file and "." in self.name and file.is_file() else None

    @cached_property
    def made(self) -> tuple[tuple[str, ast.Call], ...]:
        """What is assigned the result of a call, each with the call."""
        pairs = assignments(self.nodes)
        return tuple((ast.unparse(target), value) for target, value in pairs if isinstance(value, ast.Call))

    def name_of(self, call: ast.Call | None) -> str:
        """Return what a call is assigned to, such as `self.timer`; empty if to nothing."""
        return next((name for name, made in self.made if made is call), "")

    @cached_property
    def imports(self) -> tuple[Import, ...]:
        """The names that its import statements bind, anywhere in the file."""
        return tuple(itertools.chain.from_iterable(self.imported.values()))

    @cached_property
    def imported(self) -> Mapping[ast.AST, list[Import]]:
        """The import statements anywhere in the file, each with the names that it binds."""
        return dict(imports_in(self.tree, self.absolute))

    def absolute(self, node: ast.ImportFrom) -> str:
        """Return the full name of the module from which a statement imports."""
        if not node.level:
            return node.module or ""
        parts = self.name.split(".")
        parts = parts[: len(parts) - node.level + self.is_package]
        return ".".join([*parts, *([node.module] if node.module else [])])

    @cached_property
    def names(self) -> Mapping[str, str]:
        """The full names of the file's global names: imports, definitions and aliases; an inner import where there is no other."""
        outer, found = {*own_nodes(self.tree)}, dict[str, str]()
        for statement in sorted(self.imported, key=outer.__contains__):
            found |= {i.local: i.meant for i in self.imported[statement]}
        for node in self.tree.body:
            if isinstance(node, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
                found[node.name] = f"{self.name}.{node.name}"
            elif isinstance(node, ast.Assign) and (target := dotted(node.value)):
                first, _, rest = target.partition(".")
                if first in found:
                    whole = f"{found[first]}.{rest}" if rest else found[first]
                    found.update({to.id: whole for to in node.targets if isinstance(to, ast.Name)})
        return found

    def resolve(self, node: ast.AST | None) -> str | None:
        """Return the full name of a name: `rclpy.node.Node` for `n.Node` after `import rclpy.node as n`.

        A string, as in an annotation, counts as the name in it. None if the name is not known.
        """
        if not isinstance(node, (ast.Name, ast.Attribute, ast.Constant)):
            return None
        if node not in self._resolved:  # which a hundred rules ask of each call
            self._resolved[node] = self._full_name(node)
        return self._resolved[node]

    def _full_name(self, node: ast.AST) -> str | None:
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.isidentifier():
            return self.names.get(node.value)
        name = dotted(node)
        if name is None:
            return None
        while isinstance(node, ast.Attribute):
            node = node.value
        assert isinstance(node, ast.Name)
        target = self._meaning(node)
        return f"{target}{name.removeprefix(node.id)}" if target else None

    def _meaning(self, name: ast.Name) -> str | None:
        """Return the full name of what a name means at its place; None if that is not known, or not always the same."""
        scope, binders, is_around = self.binders(name)
        is_local = scope not in (None, self.tree) and not any(isinstance(n, _OUTER) for n in binders)
        here = [i for n in binders for i in self.imported.get(n, ()) if i.local == name.id]
        if len(here) != len(binders) or not here:
            known = self.names.get(name.id, name.id if name.id in _BUILTINS else None)
            return None if is_local else known
        if len({i.target for i in here}) > 1 and any(i.is_guarded for i in here):
            return None
        before = [i for i in here if is_around and i.line <= name.lineno]
        return (before or here)[-1].meant

    @cached_property
    def constants(self) -> Mapping[str, object]:
        """The values of the names that the file binds only once, at its top level or in a class, to a constant.

        One in a class is called as in `Topics.STATUS`; a class with bases, such as an Enum, may make another value.
        """
        nodes = [n for n in self.nodes if isinstance(n, (ast.Name, ast.Attribute, ast.arg))]
        stored = [n for n in nodes if isinstance(n, ast.arg) or isinstance(n.ctx, ast.Store)]
        bound = Counter(n.arg if isinstance(n, ast.arg) else ast.unparse(n) for n in stored)
        owners = [n for n in self.tree.body if isinstance(n, ast.ClassDef)]
        inner = [(owner, *pair) for owner in owners for pair in _constants_in(owner.body)]
        bound.subtract(name for _, name, _ in inner)
        bound.update(f"{owner.name}.{name}" for owner, name, _ in inner)
        found = dict(_constants_in(self.tree.body))
        found |= {f"{owner.name}.{name}": value for owner, name, value in inner if not owner.bases}
        return {name: value for name, value in found.items() if bound[name] == 1}


def _constants_in(body: Sequence[ast.stmt]) -> Iterator[tuple[str, object]]:
    """Yield the names to which statements assign a constant, each with its value."""
    for target, value in assignments(body):
        if isinstance(target, ast.Name) and isinstance(value, ast.Constant):
            yield target.id, value.value


_OUTER = (ast.Global, ast.Nonlocal)
_BUILTINS = {"str", "int", "float", "bool", "dict", "list", "tuple", "bytes", "len", "round", "super"}


def read_source(path: Path, name: str, shown: str, kind: type[PythonSource] = PythonSource) -> PythonSource:
    """Read a Python file; one that cannot be read counts as empty."""
    return kind(name, shown, read_text(path), path.name == "__init__.py", path)


def read_text(path: Path) -> str:
    """Return the text of a file; empty if it is missing, cannot be read or is too large."""
    return decoded(bytes_of(path), path)


def _depth(tree: ast.AST) -> int:
    """Return the depth of a tree, at most `DEEPEST`."""
    level: list[ast.AST] = [tree]
    for depth in range(DEEPEST):
        level = [child for node in level for child in children(node)]
        if not level:
            return depth
    return DEEPEST


def contains(node: ast.stmt, line: int) -> bool:
    """Return whether a line is one of those of a statement."""
    return node.lineno <= line <= (node.end_lineno or node.lineno)


def assignments(nodes: Iterable[ast.AST]) -> Iterator[tuple[ast.expr, ast.expr]]:
    """Yield the targets of assignments, also of annotated ones, each with the value that it is given."""
    for node in nodes:
        if isinstance(node, (ast.Assign, ast.AnnAssign)) and node.value is not None:
            for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                yield target, node.value


def assigned_to(nodes: Iterable[ast.AST], text: str) -> list[ast.expr]:
    """Return the values that statements assign to a name or an attribute, as it is written."""
    return [value for target, value in assignments(nodes) if ast.unparse(target) == text]


def argument(call: ast.Call, place: int, name: str) -> ast.expr | None:
    """Return the argument for a parameter, by position or by keyword; None if there is none."""
    named = (keyword.value for keyword in call.keywords if keyword.arg == name)
    return next(named, call.args[place] if place < len(call.args) else None)


def given_to(call: ast.Call) -> list[ast.expr]:
    """Return the arguments of a call, also those by keyword."""
    return [*call.args, *(keyword.value for keyword in call.keywords)]


def names_read(nodes: Iterable[ast.AST]) -> set[str]:
    """Return the names whose values some nodes read."""
    return {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load)}


def names_bound(nodes: Iterable[ast.AST]) -> set[str]:
    """Return the names to which some nodes give values."""
    return {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}


def last_name(node: ast.AST | None) -> str:
    """Return a name, or the last part of one with dots; empty for any other node."""
    return str(getattr(node, "attr", getattr(node, "id", "")))


def parameters(function: Function | ast.Lambda) -> list[ast.arg]:
    """Return a function's positional parameters."""
    return [*function.args.posonlyargs, *function.args.args]


@kept
def children(node: ast.AST) -> tuple[ast.AST, ...]:
    """Return the children of a node."""
    return tuple(ast.iter_child_nodes(node))


@kept
def _below(node: ast.AST) -> tuple[ast.AST, ...]:
    found = [*children(node)]
    for inner in found:
        found += children(inner)
    return tuple(found)


def walk(node: ast.AST) -> tuple[ast.AST, ...]:
    """Return a node and all its descendants, level by level, as `ast.walk` does."""
    return (node, *_below(node))


@kept
def own_nodes(function: ast.AST) -> tuple[ast.AST, ...]:
    """Return the syntax nodes of a function; of functions and classes inside it only what is evaluated there."""
    return tuple(_own_nodes(function))


@kept
def _bound(scope: ast.AST) -> Mapping[str, list[ast.AST]]:
    """Return the names that a scope binds itself, each with the nodes that bind it."""
    found: dict[str, list[ast.AST]] = {}
    for node in own_nodes(scope):
        for name in bound_by(node):
            found.setdefault(name, []).append(node)
    return found


def _own_nodes(parent: ast.AST) -> Iterator[ast.AST]:
    outside = _outside(parent)
    for node in children(parent):
        if node in outside:
            continue
        yield node
        if isinstance(node, ast.arguments):
            yield from (argument for argument in walk(node) if isinstance(argument, ast.arg))
        elif not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef)):
            yield from _own_nodes(node)
        for expression in _outside(node):
            yield expression
            yield from _own_nodes(expression)


def _outside(node: ast.AST) -> list[ast.expr]:
    """Return the parts of a function or a class that are evaluated where it is defined."""
    found: list[ast.expr | None] = [*getattr(node, "decorator_list", ()), *getattr(node, "bases", ())]
    if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
        found += [*node.args.defaults, *node.args.kw_defaults]
    return [expression for expression in found if expression is not None]


def returns_value(function: Function) -> bool:
    """Return whether a function returns or yields a value."""
    kinds = (ast.Return, *YIELDS)
    return any(isinstance(node, kinds) and node.value is not None for node in own_nodes(function))


def is_generator(function: Function) -> bool:
    """Return whether a call of a function runs nothing of it yet, because it yields."""
    return any(isinstance(node, YIELDS) for node in own_nodes(function))
