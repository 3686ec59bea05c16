"""What keeps a node from calling its callbacks: loops, rates that never wake up, and imported files that never end."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from functools import lru_cache

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.spin_loops import is_endless
from ros2lab.diagnose.sources.entrance import SPINNING, Entrance, is_lasting
from ros2lab.diagnose.sources.node_source import CREATORS, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.one_run import goes_on_forever, is_always_reached, may_leave
from ros2lab.diagnose.sources.own_functions import called_function
from ros2lab.diagnose.sources.python_source import (
    PAUSES,
    Function,
    PythonSource,
    is_generator,
    last_name,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import calls_in, needed_by, removal, stores_in
from ros2lab.diagnose.sources.uses import is_log

HARMLESS = frozenset(("get_logger", "get_clock", "get_parameter", "get_name"))  # methods that change nothing
_THREADED = frozenset(
    ("Thread", "MultiThreadedExecutor", "EventsExecutor", "ReentrantCallbackGroup", "ThreadPoolExecutor")
)


def endless_loops(
    sources: NodeSources, source: PythonSource, owner: NodeClass | None, functions: list[Function], what: str
) -> Iterator[Finding]:
    """Yield endless loops in a callback or constructor, the first of `functions`, or in methods it calls."""
    if threads_of(sources, source) or isinstance(functions[0], ast.AsyncFunctionDef):
        return
    has_others = has_others_than(sources, owner, functions[0])
    is_late = what == "the constructor" and spins_on(sources, source)
    lost = "the node is never spun" if is_late else "it never returns"
    lost = "no other callback of the node is ever called" if has_others else lost
    for function in functions:
        for node in own_nodes(function):
            if not isinstance(node, ast.While) or (not has_others and not is_late and _does_something(node)):
                continue  # the only thing that the node does is done in this loop
            if _is_endless(sources, source, owner, node):
                fix = _moved(source, node, function, functions[0])
                cause = f"In {what}, a loop runs forever, so {lost}."
                yield Finding("endless-loop", cause, source.at(node), fix)


def _moved(source: PythonSource, loop: ast.While, function: Function, first: Function) -> str:
    """Say where a loop may run, called from the first function: in a timer callback, or in a thread if it needs what is around it."""
    around = [n for n in walk(function) if isinstance(n, (ast.Try, ast.With)) and loop in walk(n)]
    if any(isinstance(n, ast.With) or n.finalbody for n in around):
        name = function.name if function is not first else "METHOD"
        given = f"args=({', '.join(needed_by(function))},), " * bool(needed_by(function))
        call = f"`threading.Thread(target=self.{name}, {given}daemon=True).start()`"
        if function is first:
            return f"move it with what is around it into a method of its own, and write {call} here, with `import threading` at the top"
        return f"write {call} instead of the call of self.{name}(), with `import threading` at the top"
    fix = removal(source, loop, "the loop")
    if all(isinstance(statement, ast.Pass) for statement in loop.body):
        return fix
    more = ", with `return` instead of `continue`" * any(isinstance(n, ast.Continue) for n in walk(loop))
    return f"{fix}, and run its body in a timer callback{more}: create_timer(period, self.callback)"


def has_others_than(sources: NodeSources, owner: NodeClass | None, function: Function) -> bool:
    """Return whether a node has a callback other than a function."""
    family = sources.lineage(owner)[0] if owner else []
    return any(
        sources.function_of(creation, creation.given("callback")) is not function
        for creation in sources.creations
        if creation.owner in family and "callback" in CREATORS[creation.method]
    )


def _does_something(loop: ast.While) -> bool:
    """Return whether a loop publishes, asks or drives something: it calls more than what only logs."""
    calls = (node for statement in loop.body for node in calls_in(walk(statement)))
    return any(not is_log(call) and getattr(call.func, "attr", "") != "get_logger" for call in calls)


def _is_endless(sources: NodeSources, source: PythonSource, owner: NodeClass | None, node: ast.While) -> bool:
    inside = [inner for statement in node.body for inner in walk(statement)]
    called = [inner for method in _reached(sources, source, owner, inside) for inner in own_nodes(method)]
    spins = any(isinstance(n, ast.Attribute) and n.attr in SPINNING for n in (*inside, *called))
    is_ended = any(isinstance(n, ast.Raise) or _ends(n) for n in (*inside, *called))
    is_lasting = goes_on_forever(source, node) or (is_self_attribute(node.test) and _leaves_alone(node))
    return is_lasting and not spins and not is_ended and not may_leave([node], *PAUSES)


def _leaves_alone(loop: ast.While) -> bool:
    """Return whether a loop never changes the attribute that it tests, itself or by a method of the node."""
    name = ast.unparse(loop.test)
    inside = [node for node in walk(loop) if node is not loop.test]
    is_changed = name in map(ast.unparse, stores_in(inside))
    called = [node.func for node in calls_in(inside)]
    is_emptied = any(isinstance(call, ast.Attribute) and ast.unparse(call.value) == name for call in called)
    calls = [call for call in called if is_self_attribute(call)]
    return not is_changed and not is_emptied and all(call.attr in HARMLESS for call in calls)


def rate_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield rates whose sleep nothing ends: a sleep in a program without threads, in no loop that spins."""
    for source in sources.sources.values():
        is_ros = "rclpy" in {imported.target.partition(".")[0] for imported in source.imports}
        if not is_ros or any(threads_of(sources, file) for file in sources.sources.values()):
            continue
        spinning = {
            id(inner)
            for loop in source.nodes
            if isinstance(loop, (ast.While, ast.For)) and _turns(sources, source, loop)
            for inner in walk(loop)
        }
        for name, made in source.made:
            if getattr(made.func, "attr", "") != "create_rate":
                continue
            sleeps = [n for n in source.calls if ast.unparse(n.func) == f"{name}.sleep"]
            if any(id(sleep) not in spinning for sleep in sleeps):
                cause = "A rate can wake up only while the node is being spun, and nothing spins it during the sleep, so it hangs."
                fix = "use create_timer instead, or spin the node in a separate thread"
                yield Finding("rate-without-thread", cause, source.at(made), fix)
                break


def _turns(sources: NodeSources, source: PythonSource, loop: ast.While | ast.For) -> bool:
    """Return whether a loop spins, itself or by a function that it calls: it serves the rate's timer, too."""
    own = next((o for o in sources.classes.values() if loop in walk(o.definition)), None)
    inside = [*walk(loop)]
    nodes = [*inside, *(n for f in _reached(sources, source, own, inside) for n in own_nodes(f))]
    return any("spin" in last_name(node) for node in nodes)


def _reached(
    sources: NodeSources, source: PythonSource, owner: NodeClass | None, nodes: Sequence[ast.AST]
) -> list[Function]:
    """Return the methods and functions of the package that some nodes call, directly or indirectly."""
    found: list[Function] = []
    waiting = calls_in(nodes)
    while waiting:
        function = called_function(sources, source, owner, waiting.pop().func)
        if function is not None and function not in found:
            found.append(function)
            waiting += calls_in(own_nodes(function))
    return found


def _ends(node: ast.AST) -> bool:
    """Return whether a node ends the program, or rclpy."""
    name = last_name(node.func) if isinstance(node, ast.Call) else ""
    return name in ("exit", "_exit", "quit", "shutdown", "try_shutdown")


def spins_on(sources: NodeSources, source: PythonSource) -> bool:
    """Return whether a file, or what runs together with it, spins until something ends it."""
    names = sources.together(source.name)
    return any(getattr(node, "attr", "") == "spin" for name in names for node in sources.sources[name].nodes)


@lru_cache(maxsize=64)
def threads_of(sources: NodeSources, source: PythonSource) -> frozenset[str]:
    """Return the names of what calls something in several threads, in a file or what runs together with it."""
    nodes = (node for name in sources.together(source.name) for node in sources.sources[name].nodes)
    return _THREADED & {str(getattr(node, "id", None) or getattr(node, "attr", None)) for node in nodes}


_GUARD = "`if __name__ == '__main__':`"
_DEEPEST = 4  # functions that call each other


def import_work(entrance: Entrance) -> Iterator[Finding]:
    """Yield what runs until Ctrl-C in a file that a program imports before it calls its own function."""
    sources, own = entrance.sources, entrance.source
    at_top = {
        statement.lineno for statement in own.tree.body if isinstance(statement, (ast.Import, ast.ImportFrom))
    }
    told = {own.name}
    for imported in own.imports:
        target = imported.target if imported.target in sources.sources else imported.target.rpartition(".")[0]
        for name in sources.imported_by(target) if imported.line in at_top else ():
            source = sources.sources[name]
            work = _lasting(sources, source, source.tree, _DEEPEST) if name not in told else None
            told.add(name)
            if work is not None:
                yield _finding(entrance, source, work, imported.line)


def _lasting(
    sources: NodeSources, source: PythonSource, block: Function | ast.Module, depth: int
) -> ast.Call | ast.While | None:
    """Return what keeps every run of a function or a file from its end until Ctrl-C; None if nothing is known to."""
    for node in own_nodes(block):
        if not isinstance(node, (ast.Call, ast.While)) or not is_always_reached(block, node):
            continue
        if isinstance(node, ast.While):
            if is_endless(node, source):
                return node
            continue
        name = sources.resolve(source, node.func) or dotted(node.func) or ""
        home, function = sources.functions.get(name, (source, None))
        is_run = isinstance(function, ast.FunctionDef) and not is_generator(function) and depth > 0
        if is_lasting(name) or (is_run and function and _lasting(sources, home, function, depth - 1)):
            return node
    return None


def _finding(entrance: Entrance, source: PythonSource, work: ast.Call | ast.While, line: int) -> Finding:
    """Say that a line of a file runs when the file is imported, and how it runs only when it is started itself."""
    text = f"{ast.unparse(work)}, which" if isinstance(work, ast.Call) else "a loop that"
    name, own = source.name.rpartition(".")[2], entrance.source.name.rpartition(".")[2]
    cause = (
        f"Importing {name} runs {text} goes on until Ctrl-C: {own} imports it on line {line}, "
        f"so {entrance.function.name}() of {own} is not reached."
    )
    fix = f"write {_GUARD} above this line, and indent this line by four spaces"
    is_alone = any(isinstance(above, ast.Expr) and above.value is work for above in source.tree.body)
    if not is_alone or is_lasting(source.resolve(getattr(work, "func", None)) or ""):
        fix = f"move this, with the lines that prepare it, into a function, and call that below {_GUARD}"
    return Finding("never-called", cause, source.at(work), fix)
