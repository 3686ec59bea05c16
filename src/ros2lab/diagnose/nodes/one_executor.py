"""How to spin several nodes with one executor, written with a file's own names and lines."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Sequence

from ros2lab.diagnose.finding import in_a_row, lines_in_words
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    names_bound,
    names_read,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.syntax_parts import calls_in


def joined(source: PythonSource, function: Function, spins: Sequence[ast.Call]) -> str:
    """Return how several spins of a block become a single spin of one executor."""
    nodes = [spin.args[0] for spin in spins if _is_rclpys(source, spin) and spin.args]
    kept, *others = [*dict.fromkeys(_executor(s) for s in spins if not _is_rclpys(source, s))] or [""]
    made, more = _made(source) if not kept else ([], "")
    kept = kept or "executor"
    calls = [n for n in calls_in(walk(function)) if n.args]
    moved = [call for call in calls if ast.unparse(call.func) in {f"{other}.add_node" for other in others}]
    edits = [f"write `{kept}.add_node({ast.unparse(c.args[0])})` instead of line {c.lineno}" for c in moved]
    rows = [f"`{kept}.add_node({text})`" for text in dict.fromkeys(map(ast.unparse, nodes))]
    where, gone = _in_place_of(function, spins, nodes)
    edits.append(f"write {in_a_row([*made, *rows, f'`{kept}.spin()`'])} instead of {where}")
    return f"{in_a_row([*edits, *gone])}{more}"


def _in_place_of(
    function: Function, spins: Sequence[ast.Call], nodes: Sequence[ast.expr]
) -> tuple[str, list[str]]:
    """Return the line, or lines, that a single spin replaces, and what is to be removed and moved besides."""
    lines = [spin.lineno for spin in spins]
    first, last = lines[0], lines[-1]
    if lines == [*range(first, last + 1)]:
        return lines_in_words(first, last), []
    # What is spun must be there: an object that is made between two spins is spun in the place of the last.
    needed = {*names_read(n for spin in spins for n in walk(spin))}
    made = names_bound(n for n in own_nodes(function) if first < getattr(n, "lineno", 0) < last)
    place = last if needed & made else first
    gone = [f"remove line {line}" for line in lines if line != place]
    ended = [call.lineno for call in _ends(function, nodes) if place == last and first < call.lineno < last]
    return f"line {place}", gone + [f"move line {line} below line {last}" for line in ended]


def joined_after(source: PythonSource, loop: ast.For, spin: ast.Call) -> str:
    """Return how a loop that spins each of its nodes adds them to an executor instead."""
    made, more = _made(source)
    added = f"`executor.add_node({ast.unparse(spin.args[0])})` instead of line {spin.lineno}"
    spun = f"`executor.spin()` below the loop, after line {loop.end_lineno}"
    return f"write {made[0]} above line {loop.lineno}, {added} and {spun}{more}"


def spun_together(source: PythonSource, spin: ast.Call, names: Iterable[str]) -> str:
    """Return how a call of rclpy.spin becomes the spin of an executor that has other nodes, too."""
    made, more = _made(source)
    rows = [f"`executor.add_node({name})`" for name in dict.fromkeys((ast.unparse(spin.args[0]), *names))]
    return f"write {in_a_row([*made, *rows, '`executor.spin()`'])} instead of line {spin.lineno}{more}"


def on_their_own(source: PythonSource, threads: Sequence[ast.Call]) -> str:
    """Return how each thread spins its node with an executor of its own; empty if the node is not seen."""
    name, more = _executor_class(source)
    given = [keyword.value for thread in threads for keyword in thread.keywords if keyword.arg == "args"]
    alone = [value.elts[0] for value in given if isinstance(value, ast.Tuple) and len(value.elts) == 1]
    if len(alone) != len(threads):
        return ""
    rows = [f"`args=({ast.unparse(node)}, {name}())` on line {node.lineno}" for node in alone]
    return f"write {in_a_row(rows)}{more}"


def _made(source: PythonSource) -> tuple[list[str], str]:
    """Return how an executor is made here, and what is to be imported for that."""
    name, more = _executor_class(source)
    return [f"`executor = {name}()`"], more


def _executor_class(source: PythonSource) -> tuple[str, str]:
    """Return an executor's class as the file knows it, and how to import it if the file knows none."""
    known = [name for name in sorted(source.names) if _names_executor(source, name)]
    name = known[0] if known else "SingleThreadedExecutor"
    return name, "" if known else f", with `from rclpy.executors import {name}` at the top"


def _names_executor(source: PythonSource, name: str) -> bool:
    meant = source.resolve(ast.Name(name)) or ""
    return meant.startswith("rclpy.executors.") and meant.endswith("ThreadedExecutor")


def _executor(spin: ast.Call) -> str:
    return ast.unparse(spin.func).removesuffix(".spin")


def _is_rclpys(source: PythonSource, call: ast.Call) -> bool:
    return source.resolve(call.func) == "rclpy.spin"


def _ends(function: Function, nodes: Sequence[ast.expr]) -> Iterator[ast.Call]:
    """Yield the calls that destroy one of some nodes."""
    wanted = {f"{ast.unparse(node)}.destroy_node" for node in nodes}
    for node in own_nodes(function):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in wanted:
            yield node
