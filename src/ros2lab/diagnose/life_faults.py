"""How a node lives: init, spin and shutdown, and what stops it from being called."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.node_source import NODE_CLASSES, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.python_source import Function, PythonSource, own_nodes, walk
from ros2lab.diagnose.static_value import dotted

_SPINNING = frozenset(("spin", "spin_once", "spin_until_future_complete", "spin_once_until_future_complete"))
_HARMLESS = frozenset(("get_logger", "get_clock", "get_parameter", "get_name"))  # methods that change nothing
_THREADED = frozenset(
    ("Thread", "MultiThreadedExecutor", "EventsExecutor", "ReentrantCallbackGroup", "ThreadPoolExecutor")
)


def life_faults(sources: NodeSources, mains: list[str] | None) -> Iterator[Finding]:
    """Yield what is wrong with a program's course.

    Args:
        sources: the package's files.
        mains: the functions that its executables call, such as `pk.talk:main`; None takes every `main`.
    """
    for name in (
        mains if mains is not None else [name for name in sources.functions if name.endswith(".main")]
    ):
        if name in sources.functions:
            yield from _main_faults(sources, name)
    for source in sources.sources.values():
        yield from _spin_not_called(source)
    yield from _callback_faults(sources)


@dataclass
class _Course:
    """Everything that a function runs, as far as the package's own files tell."""

    calls: list[tuple[PythonSource, ast.Call, str, Function]] = field(default_factory=list)
    seen: set[int] = field(default_factory=set)
    has_loop: bool = False
    hands_on: bool = False
    makes_node: ast.Call | None = None


def _follow(sources: NodeSources, source: PythonSource, function: Function, course: _Course) -> None:
    if id(function) in course.seen or len(course.seen) > 500:
        return
    course.seen.add(id(function))
    for node in walk(function):
        if isinstance(node, ast.While):
            course.has_loop = True
        if isinstance(node, (ast.Name, ast.Attribute)) and isinstance(node.ctx, ast.Load):
            name = sources.resolve(source, node) or ""
            # A function or a class that is only named may be called by whoever is given it.
            if name in sources.functions:
                _follow(sources, *sources.functions[name], course)
            elif name in sources.classes:
                one = sources.classes[name]
                for inner in sources.lineage(one)[0]:
                    for method in inner.methods.values():
                        _follow(sources, inner.source, method, course)
        if isinstance(node, ast.Call):
            name = (
                sources.resolve(source, node.func) or dotted(node.func) or str(getattr(node.func, "attr", ""))
            )
            course.calls.append((source, node, name, function))
            is_class = name in sources.classes and sources.lineage(sources.classes[name])[1]
            if is_class or name in NODE_CLASSES or name == "rclpy.create_node":
                course.makes_node = course.makes_node or node
            if "import_module" in name or name in ("exec", "eval", "runpy.run_module"):
                course.hands_on = True
            top = name.partition(".")[0]
            is_foreign = top in {one.target.partition(".")[0] for one in source.imports} and top not in (
                "rclpy",
                "sys",
                "os",
                "time",
                "math",
                "random",
                "signal",
                "threading",
                "logging",
                "argparse",
            )
            if (
                is_foreign
                and name not in sources.functions
                and name not in sources.classes
                and function.name == "main"
            ):
                course.hands_on |= not name.endswith(("msg", "srv")) and ".msg." not in name


def _main_faults(sources: NodeSources, name: str) -> Iterator[Finding]:
    source, function = sources.functions[name]
    course = _Course()
    _follow(sources, source, function, course)
    if course.makes_node is None:
        return
    names = [called for _, _, called, _ in course.calls]
    last = {called.rpartition(".")[2] for called in names}
    inits = [one for one in course.calls if one[2] == "rclpy.init"]
    main_calls = [node for node in own_nodes(function) if isinstance(node, ast.Call)]
    if not inits and not course.hands_on and "init" not in last:
        yield Finding(
            "rclpy-init-missing",
            "A node is made, and rclpy.init() is called nowhere before it.",
            source.at(course.makes_node),
            f"write rclpy.init(args=args) as the first line of {function.name}",
        )
    yield from _init_twice(inits)
    for one, call, called, inside in course.calls:
        if called in ("rclpy.init", "rclpy.create_node") and _is_behind_with(call, inside):
            yield Finding(
                "context-manager",
                f"In ROS 2 Jazzy {called}() cannot stand behind `with`; later releases allow it.",
                one.at(call),
                "call it on a line of its own, and rclpy.try_shutdown() at the end of main",
            )
    waits = _SPINNING | {"Thread", "run", "gather", "create_task", "create_rate", "wait", "join", "sleep"}
    is_called_back = any(
        called in last for called in ("create_timer", "create_subscription", "create_service")
    )
    spins = (
        bool(waits & last) or any("spin" in called for called in last) or course.has_loop or course.hands_on
    )
    if is_called_back and not spins and not _names_spin(sources):
        line = main_calls[-1] if main_calls else function
        yield Finding(
            "spin-missing",
            f"{function.name} makes a node and never spins it, so the program ends at once and no callback is called.",
            source.at(course.makes_node or line),
            "write rclpy.spin(node) after the node is made",
        )
    for inner, later in _spins_in_a_row(course):
        yield Finding(
            "spin-missing",
            "A spin goes on until Ctrl-C, so a second one behind it is not reached, and no callback of its node is called.",
            inner.at(later),
            "add all nodes to one executor, and spin that: executor.add_node(node) for each, then executor.spin()",
        )


def _spins_in_a_row(course: _Course) -> Iterator[tuple[PythonSource, ast.Call]]:
    """Yield the first spin that stands behind another one in the same block."""
    spinning = {
        id(call): source
        for source, call, called, _ in course.calls
        if called == "rclpy.spin" or called.endswith("executor.spin")
    }
    for function in {id(inside): inside for *_, inside in course.calls}.values():
        for node in walk(function):
            for block in (getattr(node, "body", None), getattr(node, "orelse", None)):
                calls = [
                    one.value
                    for one in (block if isinstance(block, list) else ())
                    if isinstance(one, ast.Expr)
                    and isinstance(one.value, ast.Call)
                    and id(one.value) in spinning
                ]
                if len(calls) > 1:
                    yield spinning[id(calls[1])], calls[1]


def _names_spin(sources: NodeSources) -> bool:
    """Return whether something is told to spin without being called, as in `Thread(target=executor.spin)`."""
    statements = {
        id(node.value) for s in sources.sources.values() for node in s.nodes if isinstance(node, ast.Expr)
    }
    return any(
        isinstance(node, ast.Attribute) and node.attr in _SPINNING and id(node) not in statements
        for s in sources.sources.values()
        for node in s.nodes
    ) and any(
        isinstance(n, ast.keyword) and n.arg == "target" for s in sources.sources.values() for n in s.nodes
    )


def _is_behind_with(call: ast.Call, function: Function) -> bool:
    statements = (node for node in walk(function) if isinstance(node, (ast.With, ast.AsyncWith)))
    return any(item.context_expr is call for statement in statements for item in statement.items)


def _init_twice(inits: list[tuple[PythonSource, ast.Call, str, Function]]) -> Iterator[Finding]:
    sure = [
        (source, call, function)
        for source, call, _, function in inits
        if not _is_guarded(call, function) and not any(keyword.arg == "context" for keyword in call.keywords)
    ]
    if len(sure) < 2 or _shutdown_between(sure[0][2], sure[0][1], sure[-1][1]):
        return
    source, call, _ = sure[-1]
    yield Finding(
        "rclpy-init-twice",
        "rclpy.init() is called twice in one program, and only the first one is right.",
        source.at(call),
        "remove one of the two; it belongs into main",
    )


def _is_guarded(call: ast.Call, function: Function) -> bool:
    branches = [node for node in walk(function) if isinstance(node, (ast.If, ast.ExceptHandler))]
    return any(call is inner for branch in branches for inner in walk(branch))


def _shutdown_between(function: Function, first: ast.Call, last: ast.Call) -> bool:
    ends = [
        node.lineno
        for node in walk(function)
        if isinstance(node, ast.Call) and (dotted(node.func) or "").endswith("shutdown")
    ]
    return any(first.lineno < line < last.lineno for line in ends)


def _spin_not_called(source: PythonSource) -> Iterator[Finding]:
    for node in source.nodes:
        if isinstance(node, ast.Expr) and source.resolve(node.value) in ("rclpy.spin", "rclpy.init"):
            text = ast.unparse(node.value)
            yield Finding(
                "spin-missing" if text.endswith("spin") else "rclpy-init-missing",
                f"`{text}` only names the function; without parentheses it is not called.",
                source.at(node),
                f"write {text}(node)" if text.endswith("spin") else f"write {text}()",
            )


def _callback_faults(sources: NodeSources) -> Iterator[Finding]:
    running: list[tuple[PythonSource, Function, NodeClass | None, str]] = []
    for creation, function in sources.callbacks():
        running.append((creation.source, function, creation.owner, f"the callback {function.name}"))
    for one in sources.nodes:
        if "__init__" in one.methods:
            running.append((one.source, one.methods["__init__"], one, "the constructor"))
    seen: set[int] = set()
    for source, function, owner, what in running:
        if id(function) in seen:
            continue
        seen.add(id(function))
        functions = [function, *_called_by(sources, owner, function)]
        yield from _loops(source, functions, what)
        yield from _waits(source, functions, what)
        if what == "the constructor":
            continue
        for node in own_nodes(function):
            if isinstance(node, ast.Call) and source.resolve(node.func) in (
                "rclpy.shutdown",
                "rclpy.try_shutdown",
            ):
                yield Finding(
                    "shutdown-in-callback",
                    f"{function.name} is called by spin() and calls rclpy.shutdown() itself, which may hang.",
                    source.at(node),
                    "take it away; where the program is to end, write `raise SystemExit`, and rclpy.try_shutdown() at the end of main",
                )
        yield from _more_timers(sources, source, functions)
    yield from _rates(sources)


def _more_timers(sources: NodeSources, source: PythonSource, functions: list[Function]) -> Iterator[Finding]:
    """Yield timers that a callback makes each time anew, where none is ever cancelled, and no condition asks for one."""
    words = {getattr(node, "attr", "") for one in sources.sources.values() for node in one.nodes}
    if words & {"cancel", "destroy_timer"}:
        return
    for one in functions:
        tests = [ast.unparse(node.test) for node in own_nodes(one) if isinstance(node, ast.If)]
        if any(re.search(r"timer|None|\bnot\b", test) for test in tests):
            continue
        for node in own_nodes(one):
            if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "create_timer":
                yield Finding(
                    "timer-in-callback",
                    f"{functions[0].name} is called again and again, and each time one more timer begins, while the others go on.",
                    source.at(node),
                    "make the timer once, in __init__, or cancel the old one before",
                )


def _waits(source: PythonSource, functions: list[Function], what: str) -> Iterator[Finding]:
    """Yield a spin where rclpy itself is at work already or not yet, and what stops a callback for long."""
    for one in functions:
        for node in own_nodes(one):
            name = source.resolve(node.func) or dotted(node.func) or "" if isinstance(node, ast.Call) else ""
            seconds = node.args[0] if isinstance(node, ast.Call) and node.args else None
            if name == "rclpy.spin":
                yield Finding(
                    "spin-inside",
                    f"{what[0].upper()}{what[1:]} spins, so it never ends, and nothing behind it is reached.",
                    source.at(node),
                    "take it away here, and write rclpy.spin(node) in main, after the node is made",
                )
            elif what == "the constructor" or _uses_threads(source):
                continue
            elif name == "input" or (
                name == "time.sleep"
                and isinstance(seconds, ast.Constant)
                and isinstance(seconds.value, (int, float))
                and seconds.value >= 1
            ):
                yield Finding(
                    "callback-waits",
                    f"{what[0].upper()}{what[1:]} waits in {name}(), and until it goes on no other callback is called.",
                    source.at(node),
                    "let create_timer(period, self.callback) call the next step in place of waiting"
                    if name == "time.sleep"
                    else "ask in a thread of its own, and let the callback only use what it has got",
                )


def _uses_threads(source: PythonSource) -> bool:
    names = {getattr(node, "id", None) or getattr(node, "attr", None) for node in source.nodes}
    return bool(names & _THREADED)


def _called_by(sources: NodeSources, owner: NodeClass | None, function: Function) -> list[Function]:
    """List the methods that a method calls on itself, such as `self.run()`."""
    names = [
        node.func.attr
        for node in own_nodes(function)
        if isinstance(node, ast.Call) and is_self_attribute(node.func)
    ]
    return [method for name in names if (method := sources.method(owner, name)) is not None]


def _loops(source: PythonSource, functions: list[Function], what: str) -> Iterator[Finding]:
    """Yield the endless loops of a function that ROS or a constructor runs, the first one of `functions`."""
    may_wait = what != "the constructor" and _uses_threads(source)
    if may_wait or isinstance(functions[0], ast.AsyncFunctionDef):
        return
    for one in functions:
        for node in own_nodes(one):
            if isinstance(node, ast.While) and _is_endless(source, node):
                yield Finding(
                    "endless-loop",
                    f"In {what} a loop goes on for ever, so nothing else of the node is ever called.",
                    source.at(node),
                    "take the loop away, and let create_timer(period, self.callback) call its body",
                )


def _is_endless(source: PythonSource, node: ast.While) -> bool:
    is_constant = isinstance(node.test, ast.Constant) and bool(node.test.value)
    is_ok = isinstance(node.test, ast.Call) and source.resolve(node.test.func) == "rclpy.ok"
    leaves = (ast.Break, ast.Return, ast.Raise, ast.Yield, ast.Await)
    spins = any(
        isinstance(n, ast.Attribute) and n.attr in _SPINNING
        for statement in node.body
        for n in walk(statement)
    )
    is_lasting = is_constant or is_ok or (is_self_attribute(node.test) and _leaves_alone(node))
    return is_lasting and not spins and not any(isinstance(n, leaves) for n in own_nodes(node))


def _leaves_alone(loop: ast.While) -> bool:
    """Return whether a loop never changes the attribute that it asks for; a method of the node's own may."""
    name = ast.unparse(loop.test)
    inside = [node for node in walk(loop) if node is not loop.test]
    is_changed = any(
        isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store) and ast.unparse(node) == name
        for node in inside
    )
    calls = [node.func for node in inside if isinstance(node, ast.Call) and is_self_attribute(node.func)]
    return not is_changed and all(call.attr in _HARMLESS for call in calls)


def _rates(sources: NodeSources) -> Iterator[Finding]:
    for source in sources.sources.values():
        if _uses_threads(source):
            continue
        made = [
            n
            for n in source.nodes
            if isinstance(n, ast.Call) and getattr(n.func, "attr", "") == "create_rate"
        ]
        if (
            made
            and "rclpy" in {one.target.partition(".")[0] for one in source.imports}
            and not any(_uses_threads(other) for other in sources.sources.values())
        ):
            yield Finding(
                "rate-without-thread",
                "A rate sleeps until somebody spins the node, and here nobody does while it sleeps: it hangs.",
                source.at(made[0]),
                "use create_timer in its place, or spin the node in a thread of its own",
            )
