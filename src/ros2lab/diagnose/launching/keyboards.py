"""Programs that read the keyboard, which launch gives to none that it starts."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_file import LaunchFile
from ros2lab.diagnose.launching.started_faults import Started
from ros2lab.diagnose.sources.one_run import blocks, decided, may_be_caught, may_end
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, walk

_READ = frozenset(("input", "getpass.getpass", "sys.stdin", "curses.wrapper", "curses.initscr"))
_LOOPS = (ast.For, ast.AsyncFor, ast.While)
_ERRORS = (EOFError, OSError, RuntimeError)  # where one is caught, the program may well do without


def keyboard_faults(file: LaunchFile, nodes: Sequence[Started]) -> Iterator[Finding]:
    """Yield where programs that a launch file starts without a terminal of their own read the keyboard."""
    for node in nodes:
        if node.launched.is_wrapped or (entrance := node.entrance) is None:
            continue
        told = {
            id(function) for _, function in node.sources.callbacks()
        }  # a callback must not wait in any case
        owners = {id(inner): call.source for call in entrance.calls for inner in walk(call.function)}
        owners |= {id(inner): node.sources.sources[node.module] for inner in walk(entrance.function)}
        read = (
            (owners[id(inner)], inner)
            for function in entrance.functions
            if id(function) not in told
            for inner in walk(function)
            if id(inner) in owners and _reads(owners[id(inner)], inner)
        )
        if found := next(read, None):
            source, inner = found
            program, package = node.launched.executable, node.package.name
            cause = f"ros2 launch gives the programs that it starts no keyboard, but `{ast.unparse(inner)}` in {program} needs one."
            fix = f"take {program} out of {file.shown}, and start it in a terminal of its own: ros2 run {package} {program}"
            yield Finding("callback-waits", cause, source.at(inner), fix, (program,))


def _reads(source: PythonSource, node: ast.AST) -> bool:
    """Return whether a node always reads the keyboard where it stands."""
    called = node.func if isinstance(node, ast.Call) else node
    if not isinstance(called, (ast.Name, ast.Attribute)) or isinstance(node, ast.Name):
        return False
    name = source.resolve(called) or (ast.unparse(called) if isinstance(node, ast.Call) else "")
    function = source.function_at(called.lineno)
    named = (
        n for n in source.nodes if function and function.name != "main" and last_name(n) == function.name
    )
    return name in _READ and not any(_is_decided(source, each) for each in (node, *named))


def _is_decided(source: PythonSource, node: ast.AST) -> bool:
    """Return whether a condition, a statement before it, or an error that is caught decides about what a node does."""
    inner, above = node, source.above(node)
    while above is not None and not isinstance(inner, Function):
        # Such as isatty() asks whether there is a keyboard.
        is_asked = inner is getattr(above, "test", None) and not isinstance(node, ast.Call)
        if (is_asked or inner in decided(above)) and not isinstance(above, (*_LOOPS, Function)):
            return True
        block = next((block for block in blocks(above) if inner in block), [])
        number = next((n for n, statement in enumerate(block) if statement is inner), 0)
        if any(map(may_end, block[:number])):
            return True
        inner, above = above, source.above(above)
    return may_be_caught(source, getattr(node, "lineno", 0), *_ERRORS)
