"""Follow the function that `ros2 run` calls: what it reaches, and which nodes are spun, and how."""

from __future__ import annotations

import ast
import builtins
import sys
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

from ros2lab.diagnose.sources.node_source import CREATORS, NodeSources
from ros2lab.diagnose.sources.one_run import in_loops
from ros2lab.diagnose.sources.python_source import Function, PythonSource, children, given_to, last_name, walk
from ros2lab.diagnose.sources.static_value import dotted, holds
from ros2lab.diagnose.sources.syntax_parts import calls_in

SPINNING = frozenset(("spin", "spin_once", "spin_until_future_complete", "spin_once_until_future_complete"))
_MOST_FUNCTIONS = 500


@dataclass(frozen=True)
class Call:
    """A call that a program reaches.

    Attributes:
        name: the name of the called function, as far as it is known, such as `rclpy.spin`.
    """

    source: PythonSource
    call: ast.Call
    name: str
    function: Function
    is_repeated: bool

    @property
    def short(self) -> str:
        """The last part of its name."""
        return self.name.rpartition(".")[2]

    @property
    def is_lasting(self) -> bool:
        """Whether it spins until Ctrl-C."""
        return is_lasting(self.name)


def is_lasting(name: str) -> bool:
    """Return whether a function of this name spins until Ctrl-C."""
    return name == "rclpy.spin" or name.endswith(("executor.spin", "Executor.spin"))


class Entrance:
    """A function that an executable calls, and everything that runs because of it in the package's own files.

    Attributes:
        node: the first call that makes a node; None if none does.
        may_do_more: whether code from outside the package is called that may spin.
    """

    def __init__(self, sources: NodeSources, name: str) -> None:
        self.sources = sources
        self.source, self.function = sources.functions[name]
        self.calls: list[Call] = []
        self.functions: list[Function] = []
        self.may_do_more = False
        self._seen: set[int] = set()
        self._follow(self.source, self.function)
        self.node = next((call for call in self.calls if self.makes_node(call)), None)
        self.spins = [call for call in self.calls if "spin" in call.short]
        self.has_loop = any(
            isinstance(node, ast.While) for function in self.functions for node in walk(function)
        )

    @cached_property
    def inits_at_import(self) -> bool:
        """Whether a module that runs before the function, because it is imported, calls rclpy.init."""
        for name in self.sources.imported_by(self.source.name):
            source = self.sources.sources[name]
            for call in (node for statement in source.tree.body for node in _run_at_import(statement, name)):
                called = self.sources.resolve(source, call.func) or dotted(call.func) or ""
                own = Entrance(self.sources, called).calls if called in self.sources.functions else ()
                if called == "rclpy.init" or any(inner.name == "rclpy.init" for inner in own):
                    return True
        return False

    @cached_property
    def has_callbacks(self) -> bool:
        """Whether a program gives a function, or to other libraries its node, to code that may call back in a spin."""
        node = {"self", self.node.source.name_of(self.node.call)} if self.node else {"self"}
        return any(self._may_call_back(call, node) for call in self.calls)

    def _may_call_back(self, call: Call, node: Collection[str]) -> bool:
        top, _, rest = call.name.partition(".")
        if "callback" in CREATORS.get(call.short, ()):
            return True
        if top in sys.stdlib_module_names or (not rest and top in dir(builtins)):
            return False  # such as a thread
        inner = [n for given in given_to(call.call) for n in walk(given)]
        called = {id(n.func) for n in calls_in(inner)}
        own = {method for owner in self.sources.classes.values() for method in owner.methods}
        own |= {name.rpartition(".")[2] for name in self.sources.functions}
        own |= {n.name for n in walk(call.function) if isinstance(n, Function)}
        is_given = any(
            isinstance(n, ast.Lambda) or (last_name(n) in own and id(n) not in called) for n in inner
        )
        is_foreign = top in {binding.target.partition(".")[0] for binding in call.source.imports} - {"rclpy"}
        is_foreign &= call.name not in self.sources.classes and call.name not in self.sources.functions
        return is_given or (is_foreign and any(ast.unparse(given) in node for given in given_to(call.call)))

    def makes_node(self, call: Call) -> bool:
        """Return whether a call makes a node."""
        return self.sources.is_node(call.name)

    def _follow(self, source: PythonSource, function: Function) -> None:
        if id(function) in self._seen or len(self._seen) > _MOST_FUNCTIONS:
            return
        self._seen.add(id(function))
        self.functions.append(function)
        repeated = in_loops(function)
        for node in walk(function):
            if isinstance(node, (ast.Name, ast.Attribute)) and isinstance(node.ctx, ast.Load):
                self._follow_name(self.sources.resolve(source, node) or "")
            if isinstance(node, ast.Call):
                name = self.sources.resolve(source, node.func) or dotted(node.func) or ""
                name = name or str(getattr(node.func, "attr", ""))
                if name.endswith(".spin") and (kind := _executor_of(source, node)):
                    name = f"{kind}.spin"
                self.calls.append(Call(source, node, name, function, id(node) in repeated))
                self.may_do_more |= self._is_handed_on(source, name, function)

    def _follow_name(self, name: str) -> None:
        # A function or a class that is only mentioned may be passed on and called elsewhere.
        if name in self.sources.functions:
            self._follow(*self.sources.functions[name])
        elif name in self.sources.classes:
            for inner in self.sources.lineage(self.sources.classes[name])[0]:
                for method in inner.methods.values():
                    self._follow(inner.source, method)

    def _is_handed_on(self, source: PythonSource, name: str, function: Function) -> bool:
        if "import_module" in name or name in ("exec", "eval", "runpy.run_module"):
            return True
        top = name.partition(".")[0]
        imported = {binding.target.partition(".")[0] for binding in source.imports}
        is_foreign = top in imported and top not in {"rclpy", *sys.stdlib_module_names}
        is_own = name in self.sources.functions or name in self.sources.classes
        is_interface = name.endswith(("msg", "srv")) or ".msg." in name or ".srv." in name
        return is_foreign and not is_own and not is_interface and function.name == "main"


def _executor_of(source: PythonSource, call: ast.Call) -> str:
    """Return the class of the executor whose method is called, by the file that makes it; empty if it is none."""
    owner = ast.unparse(call.func.value) if isinstance(call.func, ast.Attribute) else ""
    kinds = (source.resolve(made.func) or "" for text, made in source.made if text == owner)
    return next((kind for kind in kinds if kind.startswith("rclpy.executors.")), "")


def _run_at_import(statement: ast.AST, name: str) -> Iterator[ast.Call]:
    """Yield the calls that a statement makes when its file is imported by a name."""
    match statement:
        case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.Lambda():
            inner: Iterable[ast.AST] = statement.args.defaults
        case ast.If(test=test, orelse=otherwise) if holds(test, {"__name__": name}) is False:
            inner = otherwise
        case _:
            inner = children(statement)
    if isinstance(statement, ast.Call):
        yield statement
    for node in inner:
        yield from _run_at_import(node, name)
