"""What needs rclpy before rclpy.init(), after shutdown() or Ctrl-C, or when it was destroyed: where each belongs."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorReport, ErrorText, own_frames
from ros2lab.diagnose.printed.spots import Spot, place_of, spot_at, spot_of
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    contains,
    last_name,
    names_bound,
    own_nodes,
    parameters,
)
from ros2lab.diagnose.sources.syntax_parts import removal

_CODE = "rclpy-init-missing"


def of_init_order(error: ErrorText, look: Look) -> Finding | None:
    """Return where rclpy.init() must be called, for an error that says that it was not; None for any other."""
    report = error.report
    if report is None or not _is_before_init(report):
        return None
    frames = [*reversed(own_frames(report.frames))]
    spots = [spot_at(place_of([frame], look), look) for frame in frames]
    if not spots or not all(spot.file.tree.body for spot in spots):
        return None
    if any(_ends(spot) for spot in spots):
        return None
    for spot in spots:
        inits = [*_inits(_own_nodes(spot), spot.file)]
        if any(init.lineno < spot.lines[0] for init in inits):
            return None
        if inits:
            return _late(inits[0], spot)
    at_import = [spot for spot in spots if _function(spot) is None and not _is_started(spot)]
    return _on_import(at_import[-1], spots) if at_import else _without(spots)


def of_init_twice(error: ErrorText, look: Look) -> Finding | None:
    """Return which of two calls of rclpy.init() is one too many; None for any other error."""
    report = error.report
    own = error.own
    if report is None or "Context.init() must only be called once" not in report.message or not own:
        return None
    found: dict[str, tuple[PythonSource, ast.Call]] = {}
    for source in look.files:
        found |= {source.at(init): (source, init) for init in _inits(iter(source.nodes), source)}
    failed = spot_of(report, look)
    here = found.pop(_at(failed), None)
    if here is None or len(found) != 1 or failed.function is None:
        return None
    other, (source, init) = next(iter(found.items()))
    is_kept = failed.function.name == "main" or Spot(source, init.lineno).function is None
    place, removed = (other, (source, init)) if is_kept else (_at(failed), here)
    kept = _at(failed) if is_kept else other
    cause = f"rclpy.init() is called twice in one program: {other} and {_at(failed)}."
    fix = f"{removal(*removed)} here; the call at {kept} stays"
    return Finding("rclpy-init-twice", cause, place, fix)


def _is_before_init(report: ErrorReport) -> bool:
    """Return whether an error says that rclpy has no context yet, in its words or by the line that needs it."""
    if report.kind == "NotInitializedException":
        return "rclpy.init" in report.message
    needs = report.frames[-1].text if report.frames else ""
    return "'NoneType'" in report.message and needs.startswith("with") and needs.endswith("context.handle:")


def _function(spot: Spot) -> Function | None:
    """Return the function whose body contains a line; None for what runs when the file is imported."""
    function = spot.function
    return function if function and function.body[0].lineno <= spot.line else None


def _own_nodes(spot: Spot) -> Iterator[ast.AST]:
    """Yield the nodes of the function, or of the file's top level, that a line belongs to."""
    function = _function(spot)
    if function:
        yield from own_nodes(function)
        return
    for statement in spot.file.tree.body:
        if not isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            yield from ast.walk(statement)


def _inits(nodes: Iterator[ast.AST], source: PythonSource) -> Iterator[ast.Call]:
    calls = (node for node in nodes if isinstance(node, ast.Call))
    return (call for call in calls if source.resolve(call.func) == "rclpy.init")


def _ends(spot: Spot) -> bool:
    """Return whether rclpy may have been shut down before a line is reached."""
    calls = (node for node in _own_nodes(spot) if isinstance(node, ast.Call) and node.lineno < spot.line)
    return any(ast.unparse(call.func).endswith("shutdown") for call in calls)


def _is_started(spot: Spot) -> bool:
    """Return whether a line runs only where its file is started, below `if __name__ == "__main__":`."""
    statement = _statement(spot)
    return isinstance(statement, ast.If) and "__name__" in ast.unparse(statement.test)


def _statement(spot: Spot) -> ast.stmt | None:
    """Return the statement at the top level of the file that contains a line."""
    body = spot.file.tree.body
    return next((n for n in body if contains(n, spot.line)), None)


def _late(init: ast.Call, spot: Spot) -> Finding:
    cause = f"Line {spot.lines[0]} needs rclpy.init(), which is only called after it, on line {init.lineno}."
    fix = (
        f"move `{ast.unparse(init)}` from line {init.lineno} to a line of its own above line {spot.lines[0]}"
    )
    return Finding(_CODE, cause, _at(spot), fix)


def _on_import(spot: Spot, spots: list[Spot]) -> Finding:
    """Return the finding of a node that is made when Python imports the file."""
    source, statement = spot.file, _statement(spot)
    first = min(
        (n.lineno for n in [*getattr(statement, "decorator_list", ()), statement] if n), default=spot.line
    )
    sources = {s.file.shown: s.file for s in spots}
    inits = [(home, init) for home in sources.values() for init in _inits(iter(home.nodes), home)]
    imported = "" if "rclpy" in source.names else ", with `import rclpy` at the top"
    cause = "This line runs when Python imports the file, before any function is called"
    if len(inits) != 1:
        return Finding(_CODE, f"{cause}.", _at(spot), f"write `rclpy.init()` above line {first}{imported}")
    home, init = inits[0]
    function = Spot(home, init.lineno).function
    cause += f"; {function.name}() calls rclpy.init() only later." if function else "."
    written, where = ast.unparse(init), f"line {init.lineno}" if home.shown == source.shown else home.at(init)
    is_here = home.shown == source.shown
    if is_here and function and (lines := _movable(source, statement, function, init)):
        what = f"line {' and '.join(map(str, lines))}"
        fix = f"move {what} into {function.name}(), indented, right below `{written}` ({where})"
        return Finding(_CODE, cause, _at(spot), fix)
    fix = f"write `rclpy.init()` above line {first}{imported}, and remove `{written}` ({where})"
    return Finding(_CODE, cause, _at(spot), fix)


def _movable(
    source: PythonSource, statement: ast.stmt | None, function: Function, init: ast.Call
) -> list[int]:
    """Return the lines that can move into a function, because nothing else uses what they bind; else none."""
    if not isinstance(statement, ast.Assign):
        return []
    moved: list[ast.stmt] = []
    names: set[str] = set()
    for inner in source.tree.body:
        is_code = isinstance(inner, (ast.Assign, ast.Expr, ast.AugAssign))
        if inner is statement or (moved and is_code and _named(inner) & names):
            moved.append(inner)
            names |= names_bound(ast.walk(inner))
        elif moved and inner is not function and _named(inner) & names:
            return []
    used = [n.lineno for n in ast.walk(function) if isinstance(n, ast.Name) and n.id in names]
    is_used_later = bool(used) and min(used) > init.lineno
    lines = [line for n in moved for line in range(n.lineno, (n.end_lineno or n.lineno) + 1)]
    return lines if is_used_later and function in source.tree.body else []


def _named(node: ast.AST) -> set[str]:
    return {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}


def _without(spots: list[Spot]) -> Finding | None:
    """Return the finding of a program that calls rclpy.init() nowhere on its way to the node."""
    spot = next((spot for spot in spots if _function(spot)), None)
    function = _function(spot) if spot else None
    if spot is None or function is None:
        return None
    line, names = spot.lines[0], {parameter.arg for parameter in parameters(function)}
    written = "rclpy.init(args=args)" if "args" in names else "rclpy.init()"
    imported = "" if "rclpy" in spot.file.names else ", with `import rclpy` at the top"
    cause = f"{function.name}() makes a node before rclpy.init() is called."
    return Finding(_CODE, cause, _at(spot), f"write `{written}` above line {line}{imported}")


def _at(spot: Spot) -> str:
    return spot.file.at(spot.lines[0])


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
