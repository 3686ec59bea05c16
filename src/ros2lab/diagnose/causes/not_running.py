"""A line that needs rclpy while it is not running, before init(), after shutdown() or Ctrl-C, or what was destroyed."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator

from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.python_source import last_name, own_nodes

_ENDS = ("shutdown", "try_shutdown")


def shut_by(spot: Spot, error: ErrorText) -> str:
    """Say which other line of the file shuts rclpy down; empty after Ctrl-C, or unless there is just one."""
    lines = {*_lines(spot.file.nodes, _ENDS)} - {spot.line}
    if len(lines) != 1 or any("^C" in step.text for step in error.steps):
        return ""
    (line,) = lines
    function = Spot(spot.source, line).function
    where = f" (in {function.name}())" if function and function is not spot.function else ""
    return f"Line {line}{where} has already shut rclpy down, and this line does it again; this is harmless."


def not_running(_match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix of a line that was reached while rclpy was not running."""
    function = own_nodes(spot.function) if spot.function else ()
    inits, ends = _lines(function, ("init",)), _lines(function, _ENDS)
    before = [line for line in ends if line < spot.line]
    anywhere = _lines(spot.file.nodes, ("init",))
    what = f"rclpy is not running when `{spot.text}` is reached"
    if inits and min(inits) > spot.line:
        cause = f"{what}: rclpy.init() comes only on line {min(inits)}."
        fix = f"move line {min(inits)} up, above line {spot.line}"
        return cause, fix
    if before:
        cause = f"{what}: line {max(before)} has already shut it down."
        fix = f"move the line up, above line {max(before)}"
        return cause, fix
    if not anywhere:
        fix = "write rclpy.init() first in main, and rclpy.try_shutdown() last, after spin"
        return f"{what}: it was not initialized yet, or has already been shut down.", fix
    what = f"{what}: Ctrl-C has already shut it down"
    for loop in spot.file.around(spot.line, ast.While):
        test = ast.unparse(loop.test)
        ok = "rclpy.ok()" if isinstance(loop.test, ast.Constant) else f"rclpy.ok() and {test}"
        if "rclpy.ok()" not in test:
            return f"{what}, but the loop goes on.", f"write `while {ok}:` on line {loop.lineno}"
    return f"{what}.", _with_own_signals(spot, max(anywhere))


def destroyed(_match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix of a line that uses what was destroyed: where, if one line of the file shows it."""
    used = {ast.unparse(node) for node in spot.whole if isinstance(node, (ast.Name, ast.Attribute))}
    found = [(call, what) for call, what in _destructions(spot) if what in used]
    if len(found) != 1:
        text = f"`{spot.text}`" if spot.text else "This program"
        return f"{text} uses something that has already been destroyed.", "use it only before it is destroyed"
    ((call, what),) = found
    line, is_node = call.lineno, last_name(call.func) == "destroy_node"
    cause = f"`{spot.text}` uses {'the node' if is_node else what}, which line {line} has already destroyed."
    if spot.file.function_at(line) is spot.function:
        return cause, f"destroy it later: move line {line} below line {spot.line}"
    if is_node:
        return cause, f"remove line {line}, and destroy the node in main, after rclpy.spin()"
    if last_name(call.func) == "destroy_timer":
        return cause, f"write {what}.cancel() instead of {ast.unparse(call)}: reset() starts it again"
    fix = f"write `{what} = None` below line {line}, `if {what} is not None:` above line {spot.line}, and indent what is below it"
    return cause, fix


def _destructions(spot: Spot) -> Iterator[tuple[ast.Call, str]]:
    """Yield each call that may have destroyed something before a line is reached, with what it destroys."""
    file, function, around = spot.file, spot.function, spot.file.class_at(spot.line)
    for call in file.calls:
        is_here = file.function_at(call.lineno) is function
        if not isinstance(call.func, ast.Attribute) or (is_here and call.lineno >= spot.line):
            continue
        name = call.func.attr
        given = call.func.value if name in ("destroy", "destroy_node") else next(iter(call.args), None)
        what = ast.unparse(given).replace("super()", "self") if given and name.startswith("destroy") else ""
        is_same = file.class_at(call.lineno) is around if what.startswith("self") else is_here
        if what and is_same:
            yield call, what


def _with_own_signals(spot: Spot, line: int) -> str:
    """Say how rclpy goes on after Ctrl-C, until the program shuts it down itself."""
    nodes = spot.file.nodes
    init = next(n for n in nodes if isinstance(n, ast.Call) and n.lineno == line and _is(n, ("init",)))
    given = [
        *map(ast.unparse, (*init.args, *init.keywords)),
        "signal_handler_options=SignalHandlerOptions.NO",
    ]
    fix = (
        f"write `{ast.unparse(init.func)}({', '.join(given)})` on line {line}, with "
        "`from rclpy.signals import SignalHandlerOptions` at the top: then rclpy runs until it is shut down below"
    )
    has_timer = any(isinstance(n, ast.Attribute) and n.attr == "create_timer" for n in nodes)
    if has_timer:
        return fix
    return f"{fix}; and give the node a timer, because only a callback lets it notice Ctrl-C"


def _lines(nodes: Iterable[ast.AST], names: tuple[str, ...]) -> list[int]:
    """Return the lines of calls of these functions of rclpy."""
    return [node.lineno for node in nodes if isinstance(node, ast.Call) and _is(node, names)]


def _is(call: ast.Call, names: tuple[str, ...]) -> bool:
    return ast.unparse(call.func) in {f"rclpy.{name}" for name in names}
