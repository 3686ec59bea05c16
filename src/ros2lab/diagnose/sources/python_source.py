"""A Python file as `ast` sees it; nothing in it is ever run."""

from __future__ import annotations

import ast
import importlib
import math
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from ros2lab.diagnose.finding import at
from ros2lab.diagnose.sources.static_value import bound, dotted

Function = ast.FunctionDef | ast.AsyncFunctionDef

DEEPEST = 200  # levels; what is deeper was not written by hand, and is passed over
MOST_FAULTS = 5  # that are looked behind in one file
LARGEST_FILE = 1_000_000  # bytes; nobody writes more by hand


@dataclass(frozen=True)
class Import:
    """A name that an import statement binds: `local` stands for `target`, such as `rclpy.node.Node`."""

    local: str
    target: str
    line: int
    is_from: bool
    is_guarded: bool


@dataclass(eq=False)
class PythonSource:
    """A Python file.

    Attributes:
        name: how it is imported, such as `robot_controller.status_publisher`.
        shown: its path as it is shown.
        text: what it says.
        is_package: whether it is an `__init__.py`.
        fault: why Python cannot read it, once `tree` was asked for.
        warned: what Python warns of in it, each with the line, once `tree` was asked for.
    """

    name: str
    shown: str
    text: str
    is_package: bool = False
    path: Path | None = None
    fault: SyntaxError | None = field(default=None, init=False)
    warned: list[tuple[int, str]] = field(default_factory=list, init=False)

    @cached_property
    def tree(self) -> ast.Module:
        """The parsed file; an empty one, and `fault` says why, if it cannot be parsed."""
        try:
            with warnings.catch_warnings(record=True) as warned:
                warnings.simplefilter("always")
                tree = ast.parse(self.text)
                if _depth(tree) >= DEEPEST:
                    return ast.Module([], [])
                compile(tree, self.shown, "exec", dont_inherit=True)  # which is not run, and warns of more
            self.warned = [(one.lineno, str(one.message)) for one in warned]
            bound(tree)
            _mark_functions(tree)
            return tree
        except SyntaxError as error:
            self.fault = error
        except (ValueError, RecursionError, MemoryError) as error:  # a null byte, thousands of brackets
            self.fault = SyntaxError(str(error) or "too deeply nested", (self.shown, 1, 1, ""))
        return ast.Module([], [])

    @property
    def readable_to(self) -> float:
        """The line at which Python gives up; infinite if it can read the file."""
        _ = self.tree
        return (self.fault.lineno or 1) if self.fault else math.inf

    def as_meant(self) -> PythonSource:
        """Return the file with the lines that Python cannot read closed or left out; itself if few of them do not do."""
        known = self
        for _ in range(MOST_FAULTS):
            line, lines = known.readable_to, known.text.split("\n")
            if line > len(lines):
                break
            at = int(line) - 1
            begin = lines[at][: -len(lines[at].lstrip()) or None]
            texts = (f"{lines[at]}:", f"{lines[at]})", "", f"{begin}pass", f"{begin}if True:")
            changed = ("\n".join([*lines[:at], text, *lines[at + 1 :]]) for text in texts)
            known = max((replace(known, text=text) for text in changed), key=lambda one: one.readable_to)
            if known.readable_to <= line:
                break
        return known if known.readable_to == math.inf else self

    def at(self, node: ast.AST | int | None) -> str:
        """Return the place of a node or a line."""
        return at(
            self.shown, node if isinstance(node, int) or node is None else getattr(node, "lineno", None)
        )

    @cached_property
    def nodes(self) -> tuple[ast.AST, ...]:
        """Everything in the file."""
        return tuple(walk(self.tree))

    @cached_property
    def stored(self) -> frozenset[str]:
        """Every name and attribute that something is assigned to, as it is written."""
        return frozenset(
            ast.unparse(node)
            for node in self.nodes
            if isinstance(node, (ast.Name, ast.Attribute)) and isinstance(node.ctx, ast.Store)
        )

    @property
    def assigned(self) -> frozenset[str]:
        """The global names that an assignment at its top binds."""
        targets = [to for one in self.tree.body if isinstance(one, ast.Assign) for to in one.targets]
        return frozenset(target.id for target in targets if isinstance(target, ast.Name))

    @cached_property
    def imports(self) -> tuple[Import, ...]:
        """What its import statements bind, anywhere in it."""
        return tuple(self._imports(self.tree, is_guarded=False))

    def _imports(self, parent: ast.AST, is_guarded: bool) -> Iterator[Import]:
        for node in children(parent):
            if isinstance(node, ast.Import):
                for alias in node.names:
                    target = alias.name if alias.asname else alias.name.partition(".")[0]
                    yield Import(alias.asname or target, alias.name, node.lineno, False, is_guarded)
            elif isinstance(node, ast.ImportFrom):
                module = self._absolute(node)
                for alias in node.names:
                    target = f"{module}.{alias.name}" if module else alias.name
                    yield Import(alias.asname or alias.name, target, node.lineno, True, is_guarded)
            else:
                # What stands in a `try` or below a condition is not always imported.
                yield from self._imports(node, is_guarded or isinstance(node, (ast.Try, ast.If)))

    def _absolute(self, node: ast.ImportFrom) -> str:
        if not node.level:
            return node.module or ""
        parts = self.name.split(".")
        parts = parts[: len(parts) - node.level + self.is_package]
        return ".".join([*parts, *([node.module] if node.module else [])])

    @cached_property
    def names(self) -> Mapping[str, str]:
        """What the file's global names stand for, by import or as an alias of another name."""
        found = {}
        for one in self.imports:
            if one.is_from or one.local != one.target.partition(".")[0]:
                found[one.local] = one.target
            else:
                found[one.local] = one.local
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
        """Return what a name stands for, such as `rclpy.node.Node` for `n.Node` after `import rclpy.node as n`.

        A string that is an annotation counts as the name in it.
        """
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.isidentifier():
            return self.names.get(node.value)
        name = dotted(node)
        if name is None:
            return None
        first, _, rest = name.partition(".")
        if first not in self.names:
            return name if first in _BUILTINS else None
        return f"{self.names[first]}.{rest}" if rest else self.names[first]

    @cached_property
    def constants(self) -> Mapping[str, object]:
        """The values of names that the file binds once, at its top, to a constant."""
        values: dict[str, object] = {}
        again: set[str] = set()
        for node in self.nodes:
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                if node.id in values:
                    again.add(node.id)
                values[node.id] = None
        found = {}
        for statement in self.tree.body:
            value = getattr(statement, "value", None)
            if isinstance(statement, (ast.Assign, ast.AnnAssign)) and isinstance(value, ast.Constant):
                targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
                found.update({to.id: value.value for to in targets if isinstance(to, ast.Name)})
        return {name: value for name, value in found.items() if name not in again}


_BUILTINS = frozenset(
    ("str", "int", "float", "bool", "dict", "list", "tuple", "bytes", "len", "round", "super")
)


def read_source(path: Path, name: str, shown: str) -> PythonSource:
    """Read a Python file; one that cannot be read counts as empty."""
    return PythonSource(name, shown, read_text(path), path.name == "__init__.py", path)


def read_toml(text: str) -> dict[str, Any]:
    """Return what a text in TOML says; nothing if it cannot be read."""
    for name in ("tomllib", "setuptools.compat.py310"):  # Python 3.10 has none of its own
        try:
            module = importlib.import_module(name)
        except ImportError:
            continue
        reader = getattr(module, "tomllib", module)
        try:
            return dict(reader.loads(text))
        except (ValueError, RecursionError):
            return {}
    return {}


def read_text(path: Path) -> str:
    """Return what a file says, nothing if it is missing, cannot be read or is too large."""
    try:
        # A device or a pipe has no end, and no beginning either.
        if not path.is_file() or path.stat().st_size > LARGEST_FILE:
            return ""
        return path.read_bytes().decode("utf-8-sig", errors="replace")
    except OSError:
        return ""


def _mark_functions(tree: ast.Module) -> None:
    """Note of each `self.name` and `name` that is a function of the file that it is one, in `is_function`."""
    nodes = [*walk(tree)]
    functions = {node.name for node in nodes if isinstance(node, Function) and not node.decorator_list}
    named = [node for node in nodes if isinstance(node, (ast.Name, ast.Attribute))]
    bound = {_last(node) for node in named if isinstance(node.ctx, ast.Store)}
    bound |= {node.arg for node in nodes if isinstance(node, ast.arg)}
    for node in named:
        owner = node.value if isinstance(node, ast.Attribute) else None
        is_own = owner is None or (isinstance(owner, ast.Name) and owner.id == "self")
        node.is_function = is_own and _last(node) in functions - bound  # type: ignore[union-attr]


def _last(node: ast.Name | ast.Attribute) -> str:
    return node.id if isinstance(node, ast.Name) else node.attr


def _depth(tree: ast.AST) -> int:
    """Return how many levels a tree has, as far as `DEEPEST`."""
    level: list[ast.AST] = [tree]
    for depth in range(DEEPEST):
        level = [child for node in level for child in children(node)]
        if not level:
            return depth
    return DEEPEST


def parameters(function: Function | ast.Lambda) -> list[ast.arg]:
    """Return a function's positional parameters."""
    return [*function.args.posonlyargs, *function.args.args]


def is_property(function: Function) -> bool:
    """Return whether an attribute has a function's value and not the function: `@property`, `@cached_property`, a setter."""
    names = [ast.unparse(one).rpartition(".")[2] for one in function.decorator_list]
    return any("property" in name or name in ("getter", "setter", "deleter") for name in names)


def children(node: ast.AST) -> tuple[ast.AST, ...]:
    """Return what is directly below a node; rules ask again and again, and a tree that was read never changes."""
    found: tuple[ast.AST, ...] | None = node.__dict__.get("_children")
    if found is None:
        found = node.__dict__["_children"] = tuple(ast.iter_child_nodes(node))
    return found


def walk(node: ast.AST) -> Iterator[ast.AST]:
    """Yield a node and everything below it, level by level, as `ast.walk` does."""
    level: list[ast.AST] = [node]
    while level:
        yield from level
        level = [child for parent in level for child in children(parent)]


def own_nodes(function: ast.AST) -> tuple[ast.AST, ...]:
    """Return what is in a function, without the functions and classes inside it.

    Its decorators, and the defaults of its parameters, are computed where it is defined, and so belong to what is
    around it.
    """
    found: tuple[ast.AST, ...] | None = function.__dict__.get("_own_nodes")
    if found is None:
        found = function.__dict__["_own_nodes"] = tuple(_own_nodes(function))
    return found


def _own_nodes(parent: ast.AST) -> Iterator[ast.AST]:
    outside = _outside(parent)
    for node in children(parent):
        if node in outside:
            continue
        yield node
        if isinstance(node, ast.arguments):
            yield from (one for one in walk(node) if isinstance(one, ast.arg))
        elif not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef)):
            yield from _own_nodes(node)
        for one in _outside(node):
            yield one
            yield from _own_nodes(one)


def _outside(node: ast.AST) -> list[ast.expr]:
    """Return what of a function or a class is computed where it is defined."""
    found: list[ast.expr | None] = [*getattr(node, "decorator_list", ()), *getattr(node, "bases", ())]
    if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
        found += [*node.args.defaults, *node.args.kw_defaults]
    return [one for one in found if one is not None]


def returns_value(function: Function) -> bool:
    """Return whether a function gives back more than None, as one that yields does."""
    kinds = (ast.Return, ast.Yield, ast.YieldFrom)
    return any(isinstance(node, kinds) and node.value is not None for node in own_nodes(function))
