"""The Python files of a package and how they can be started, found by parsing, never by importing."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from ros2lab.diagnose.sources.python_source import PythonSource, read_source
from ros2lab.grading.reading.graded_package import Package

_OF_TERMINALS = frozenset(
    ("termios", "tty", "curses", "pynput", "keyboard", "sshkeyboard", "getkey", "readchar")
)
_LATE_IMPORTS = ("importlib", "runpy", "subprocess", "multiprocessing")


@dataclass(frozen=True)
class Module:
    """A Python file of the package, and how it can be started.

    Attributes:
        name: the name that it is imported by; empty for a file outside a Python package.
        file: its path below the package's folder.
        base: the folder below the package's that it is imported from.
        functions: the functions without required arguments that start it; "" is the file itself.
        defined: the names that it binds.
        imported: modules of the package that it imports.
        outside: the top-level modules that it imports.
        spins: whether anything in it spins.
        goes_on: whether anything in it may run for long: it spins, or has a `while` loop.
        asks_keyboard: whether anything in it reads the keyboard.
        package: the name of the other package that it lies in; empty for the graded one.
    """

    name: str
    file: str
    base: str
    functions: list[str]
    defined: list[str]
    imported: list[str]
    outside: list[str] = field(default_factory=list)
    spins: bool = True
    goes_on: bool = True
    asks_keyboard: bool = False
    package: str = ""

    @property
    def stem(self) -> str:
        """The name of its file, without .py."""
        return PurePosixPath(self.file).stem


def modules_of(package: Package) -> Iterator[Module]:
    """Yield the package's modules, then files that lie elsewhere in its folder and start a node."""
    own = set(package.sources)
    seen = set()
    for name, source in package.sources.items():
        assert source.path is not None
        seen.add(source.path)
        file = source.path.relative_to(package.folder)
        parts = file.parts[: -len(name.split(".")) - source.is_package]
        yield module_of(source, name, file, "/".join(parts), own)
    if package.notes:
        return
    for path in sorted(package.folder.rglob("*.py")):
        file = path.relative_to(package.folder)
        is_other = (
            path.name == "setup.py" or "launch" in path.name or {"test", "tests", "launch"} & {*file.parts}
        )
        if path in seen or is_other:
            continue
        module = module_of(read_source(path, path.stem, str(file)), "", file, "", own)
        if module.functions:
            yield module


def module_of(source: PythonSource, name: str, file: Path, base: str, own: Collection[str]) -> Module:
    """Return a module, as far as its source describes it.

    Args:
        source: the parsed file.
        name: the name that it is imported by; empty if it lies in no Python package.
        file: its path below the package's folder.
        base: the folder below the package's that it is imported from.
        own: the names of the package's modules.
    """
    targets = {found.target for found in source.imports}
    if any(target.startswith(_LATE_IMPORTS) for target in targets):
        targets |= _named_late(source, own)
    imported = sorted(m for m in own if any(t == m or t.startswith(f"{m}.") for t in targets))
    tops = {target.partition(".")[0] for target in targets}
    stored = {n.id for n in source.nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    functions = [*_starts(source)] if "rclpy" in tops or imported else []
    return Module(
        name,
        str(file),
        base,
        functions,
        sorted({*source.names} | stored),
        imported,
        sorted(tops),
        any(map(_spins, source.nodes)),
        any(isinstance(node, ast.While) or _spins(node) for node in source.nodes),
        bool(tops & _OF_TERMINALS) or any(map(_asks, source.nodes)),
    )


def _named_late(source: PythonSource, own: Collection[str]) -> set[str]:
    """Return the package's modules that are named in texts, for a module that imports others by name."""
    constants = (node.value for node in source.nodes if isinstance(node, ast.Constant))
    texts = {value.lstrip(".") for value in constants if isinstance(value, str)}
    return {name for name in own if {name, name.rpartition(".")[2]} & texts}


def _asks(node: ast.AST) -> bool:
    match node:
        case ast.Call(func=ast.Name(id="input")) | ast.Attribute(attr="stdin"):
            return True
    return False


def _spins(node: ast.AST) -> bool:
    match node:
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)):
            return name.startswith("spin")
    return False


def _starts(source: PythonSource) -> Iterator[str]:
    """Yield the functions that a file can be started by; "" is the file itself."""
    functions = [node for node in source.tree.body if isinstance(node, ast.FunctionDef) and _is_free(node)]
    starting = {node.name for node in functions if node.name == "main" or _inits(source, node)}
    if starting:
        yield from ["main"] if "main" in starting else sorted(starting)
    elif any(_starts_itself(source, statement) for statement in source.tree.body):
        yield ""


def _is_free(function: ast.FunctionDef) -> bool:
    """Return whether a function can be called without arguments."""
    given = function.args
    return len(given.args) <= len(given.defaults) and None not in given.kw_defaults


def _starts_itself(source: PythonSource, statement: ast.stmt) -> bool:
    """Return whether a statement of a module starts a node, or runs only under `__main__`."""
    if isinstance(statement, ast.If) and "__main__" in ast.dump(statement.test):
        return True
    is_definition = isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef))
    return not is_definition and _inits(source, statement)


def _inits(source: PythonSource, piece: ast.AST) -> bool:
    calls = (node for node in ast.walk(piece) if isinstance(node, ast.Call))
    return any(source.resolve(call.func) in ("rclpy.init", "rclpy.init.init") for call in calls)
