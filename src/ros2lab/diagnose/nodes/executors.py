"""Nodes that are added to two executors, of which the second takes them away, and how one executor spins several nodes."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Sequence

from ros2lab.diagnose.finding import Finding, in_a_row, lines_in_words
from ros2lab.diagnose.sources.entrance import Call, Entrance
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    given_to,
    last_name,
    names_bound,
    names_read,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.syntax_parts import calls_in, removal

# These spin with rclpy's own executor and then remove the node from it again.
_FOR_A_WHILE = frozenset(("rclpy.spin_once", "rclpy.spin_until_future_complete"))


def two_executors(entrance: Entrance) -> Iterator[Finding]:
    """Yield calls that take a node away from the executor that is meant to spin it."""
    additions = [reached for reached in entrance.calls if reached.short == "add_node" and reached.call.args]
    for added in additions:
        executor = _executor(added)
        if executor not in _spun(entrance):
            yield from _never_spun(entrance, added)
            continue
        for later in additions:
            is_same = later.function is added.function and _node(later) == _node(added)
            if is_same and executor != _executor(later) and later.call.lineno > added.call.lineno:
                cause = f"A node can be in only one executor: this line takes {_node(added)} away from {executor}, which then calls none of its callbacks."
                fix = f"{removal(later.source, later.call)}, or add another node there"
                yield Finding("not-spinning", cause, later.source.at(later.call), fix)
        for turn in entrance.calls:
            if turn.name not in _FOR_A_WHILE or not _has_no_executor(turn.call):
                continue
            if _comes_after(entrance, added, turn) and _is_spun_again(entrance, added, turn):
                yield _taken_away(added, turn, entrance)


def _never_spun(entrance: Entrance, added: Call) -> Iterator[Finding]:
    """Yield the spin of a node, or of others only, after the node was added to an executor that nothing spins."""
    executor, node, source = _executor(added), _node(added), added.source
    kinds = [source.resolve(made.func) or "" for text, made in source.made if text == executor]
    uses = [n for n in source.nodes if isinstance(n, ast.expr) and ast.unparse(n) == executor]
    around = [source.above(n) for n in uses if isinstance(getattr(n, "ctx", None), ast.Load)]
    is_own = len(kinds) == 1 and kinds[0].startswith("rclpy.executors.")
    if not is_own or any("spin" in last_name(n) or not isinstance(n, ast.Attribute) for n in around):
        return
    plain = [spin for spin in entrance.spins if spin.name == "rclpy.spin" and _has_no_executor(spin.call)]
    for spin in (spin for spin in plain if spin.function is added.function):
        text, to_it = ast.unparse(spin.call), f"{executor}, to which line {added.call.lineno} adds {node}"
        cause = f"`{text}` does not use {to_it}: it spins with rclpy's own executor, in one thread, so a callback that waits for another one waits forever."
        fix = f"write `{executor}.spin()` instead of `{text}`"
        if is_other := _node(spin) not in _nodes(added):
            cause = f"Nothing spins {to_it}: `{text}` spins only {_node(spin)}."
            fix = f"write `{executor}.add_node({_node(spin)})` and `{executor}.spin()` instead of `{text}`"
        # rclpy's own executor does the same as one with a single thread.
        if is_other or not kinds[0].endswith(".SingleThreadedExecutor"):
            yield Finding("not-spinning", cause, source.at(spin.call), fix)


def several_threads(entrance: Entrance) -> Iterator[Finding]:
    """Yield threads that call rclpy.spin() while another one does: only one can spin rclpy's executor."""
    threads = [call for call in entrance.calls if call.short == "Thread" and _spins_in_thread(call)]
    spins = [call for call in entrance.calls if call.name.startswith("rclpy.spin")]
    others = [spin for spin in spins if _has_no_executor(spin.call)]
    for thread in threads[:1]:
        makers = _made(entrance, thread)
        is_repeated = thread.is_repeated or len(makers) > 1 or any(_is_in_loop(entrance, n) for n in makers)
        if is_repeated or len(threads) > 1 or others:
            where = "" if is_repeated else f" while line {(threads[1:] or others)[0].call.lineno} does, too"
            cause = f"Several threads spin nodes with rclpy.spin(){where}, but all of these use one executor, which only one thread can spin."
            fix = _apart(thread, threads, others)
            yield Finding("not-spinning", cause, thread.source.at(thread.call), fix)


def _apart(thread: Call, threads: Sequence[Call], others: Sequence[Call]) -> str:
    """Return how each thread spins its own node: with its own executor, as only a thread may spin one."""
    spun = [ast.unparse(node) for value in given_to(thread.call) for node in getattr(value, "elts", ())]
    same = [other for other in others if other.function is thread.function and [_node(other)] == spun]
    if same and same[0].call.args[1:]:
        return f"write `while not {ast.unparse(same[0].call.args[1])}.done(): time.sleep(0.01)` instead of `{ast.unparse(same[0].call)}`, with `import time` at the top: the thread on line {thread.call.lineno} already spins {spun[0]}"
    if same:
        return f"remove the thread on line {thread.call.lineno}: `{ast.unparse(same[0].call)}` on line {same[0].call.lineno} already spins {spun[0]}"
    of_file = [other.call for other in threads if other.source is thread.source]
    return (
        on_their_own(thread.source, of_file)
        or "give rclpy.spin in each thread an executor of its own, a SingleThreadedExecutor of rclpy.executors, as the second argument"
    )


def _spins_in_thread(thread: Call) -> bool:
    """Return whether a thread spins a node with rclpy's own executor, not with another that it is given."""
    given = given_to(thread.call)
    has_other = any(len(getattr(value, "elts", ())) > 1 for value in given) or any(
        keyword.arg == "kwargs" for keyword in thread.call.keywords
    )
    return not has_other and any(thread.source.resolve(value) == "rclpy.spin" for value in given)


def _made(entrance: Entrance, reached: Call) -> list[ast.Call]:
    """Return the calls that instantiate the class whose constructor contains a call; empty if none does."""
    names = (
        _names(reached.function, entrance) - {"__init__"} if reached.function.name == "__init__" else set()
    )
    nodes = (n for function in entrance.functions for n in walk(function))
    return [n for n in calls_in(nodes) if getattr(n.func, "id", "") in names]


def _is_in_loop(entrance: Entrance, made: ast.Call) -> bool:
    loops = (ast.For, ast.While, ast.ListComp, ast.GeneratorExp, ast.SetComp, ast.DictComp)
    nodes = (n for function in entrance.functions for n in walk(function) if isinstance(n, loops))
    return any(made is inner for loop in nodes for inner in walk(loop))


def _taken_away(added: Call, turn: Call, entrance: Entrance) -> Finding:
    """Say that rclpy's own executor takes a node away, and how to spin the node's executor instead."""
    node = ast.unparse(turn.call.args[0])
    rest = [*map(ast.unparse, turn.call.args[1:]), *map(ast.unparse, turn.call.keywords)]
    is_until = turn.name.endswith("complete")
    written = f"{node}.executor.{turn.short}({', '.join(rest)})"
    if turn.function is added.function:
        written = f"{_executor(added)}.{turn.short}({', '.join(rest)})"
    fix = f"write `{written}` instead of `{ast.unparse(turn.call)}`"
    if _begun_before(entrance, added):
        fix = f"{removal(turn.source, turn.call)}: {_executor(added)} already spins {node} in its thread"
        if is_until and rest:
            fix = f"write `while not {rest[0]}.done(): time.sleep(0.01)` instead of `{ast.unparse(turn.call)}`, because {_executor(added)} already spins {node} in its thread; with `import time` at the top"
    of_file = "" if added.source is turn.source else f" of {added.source.shown}"
    cause = f"{turn.name}() spins with its own executor, so it takes the node away from {_executor(added)}, where line {added.call.lineno}{of_file} added it: after this line {_executor(added)} no longer spins it."
    return Finding("not-spinning", cause, turn.source.at(turn.call), fix)


def _comes_after(entrance: Entrance, added: Call, turn: Call) -> bool:
    """Return whether a spin runs after a node was added, and spins the same node as far as is known."""
    made = [reached for reached in entrance.calls if entrance.makes_node(reached)]
    node = ast.unparse(turn.call.args[0])
    several = {
        _node(reached) for reached in entrance.calls if reached.short == "add_node" and reached.call.args
    }
    is_only = len(made) == 1 == len(several) and isinstance(turn.call.args[0], ast.Name)
    if node not in _nodes(added) and not is_only:
        return False
    early = _called(n for n in walk(added.function) if getattr(n, "lineno", 0) < added.call.lineno)
    if added.function.name == "__init__" and node == _node(added) == "self" and turn.source is added.source:
        given = {getattr(arg, "attr", "") for reached in entrance.calls for arg in reached.call.args}
        return turn.function.name not in early | given  # what is passed on is called while they spin
    if turn.function is added.function:
        return turn.call.lineno > added.call.lineno
    return next(_leading_to(entrance, added, turn), None) is not None


def _is_spun_again(entrance: Entrance, added: Call, turn: Call) -> bool:
    """Return whether an executor spins after a node was taken from it, as far as the function that added it tells."""
    nodes = [*walk(added.function)]
    spins = [
        node
        for node in nodes
        if isinstance(node, ast.Attribute)
        and node.attr.startswith("spin")
        and ast.unparse(node.value) == _executor(added)
    ]
    if not spins or _begun_before(entrance, added):
        return True
    turns = [turn.call] if turn.function is added.function else [*_leading_to(entrance, added, turn)]
    removed = [
        node.lineno
        for node in nodes
        if isinstance(node, ast.Call)
        and last_name(node.func) == "remove_node"
        and node.lineno > added.call.lineno
    ]
    loops = [node for node in nodes if isinstance(node, (ast.While, ast.For))]
    pairs = [(call, spin) for call in turns for spin in spins if not any(n < call.lineno for n in removed)]
    return not turns or any(
        spin.lineno > call.lineno
        or any(loop.lineno <= spin.lineno <= call.lineno <= (loop.end_lineno or 0) for loop in loops)
        for call, spin in pairs
    )


def _leading_to(entrance: Entrance, added: Call, turn: Call) -> Iterator[ast.Call]:
    """Yield the calls in the function that added a node from which another function is reached."""
    for node in walk(added.function):
        if isinstance(node, ast.Call) and node.lineno > added.call.lineno:
            names, seen = _called([node]), set[str]()
            while new := [
                f for f in entrance.functions if _names(f, entrance) & names and f.name not in seen
            ]:
                if turn.function in new:
                    yield node
                    break
                seen |= {function.name for function in new}
                names = names.union(*(_called(own_nodes(function)) for function in new))


def _called(nodes: Iterable[ast.AST]) -> set[str]:
    """Return the names of the functions and methods that are called, without what is before the last dot."""
    calls = [n.func for n in calls_in(nodes)]
    return {last_name(function) for function in calls}


def _names(function: ast.AST, entrance: Entrance) -> set[str]:
    """Return the names by which a function is called; for a constructor, the names of its class."""
    name = str(getattr(function, "name", ""))
    if name != "__init__":
        return {name}
    classes = entrance.sources.classes.values()
    return {owner.definition.name for owner in classes if owner.methods.get("__init__") is function}


def _has_no_executor(call: ast.Call) -> bool:
    places = 3 if ast.unparse(call.func).endswith("complete") else 2
    return (
        bool(call.args)
        and len(call.args) < places
        and all(keyword.arg != "executor" for keyword in call.keywords)
    )


def _spun(entrance: Entrance) -> set[str]:
    """Return the objects whose spin methods a program calls or passes to a thread."""
    nodes = (n for function in entrance.functions for n in walk(function))
    spins = (n for n in nodes if isinstance(n, ast.Attribute) and n.attr.startswith("spin"))
    return {ast.unparse(spin.value) for spin in spins}


def _begun_before(entrance: Entrance, added: Call) -> bool:
    """Return whether a thread already spins the executor, so that nothing else may."""
    wanted = f"{_executor(added)}.spin"
    calls = (reached.call for reached in entrance.calls if reached.short == "Thread")
    return any(wanted in map(ast.unparse, given_to(call)) for call in calls)


def _executor(added: Call) -> str:
    return ast.unparse(added.call.func).removesuffix(".add_node")


def _nodes(added: Call) -> set[str]:
    """Return the names of the nodes that a call adds; in a loop, also those that the loop iterates over."""
    loops = (
        n for n in walk(added.function) if isinstance(n, ast.For) and ast.unparse(n.target) == _node(added)
    )
    return {
        _node(added),
        *(ast.unparse(element) for loop in loops for element in getattr(loop.iter, "elts", ())),
    }


def _node(added: Call) -> str:
    return ast.unparse(added.call.args[0])


def joined(source: PythonSource, function: Function, spins: Sequence[ast.Call]) -> str:
    """Return how several spins of a block become a single spin of one executor."""
    nodes = [spin.args[0] for spin in spins if _is_rclpys(source, spin) and spin.args]
    kept, *others = [*dict.fromkeys(_spun_by(s) for s in spins if not _is_rclpys(source, s))] or [""]
    made, more = _with_class(source) if not kept else ([], "")
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
    made, more = _with_class(source)
    added = f"`executor.add_node({ast.unparse(spin.args[0])})` instead of line {spin.lineno}"
    spun = f"`executor.spin()` below the loop, after line {loop.end_lineno}"
    return f"write {made[0]} above line {loop.lineno}, {added} and {spun}{more}"


def spun_together(source: PythonSource, spin: ast.Call, names: Iterable[str]) -> str:
    """Return how a call of rclpy.spin becomes the spin of an executor that has other nodes, too."""
    made, more = _with_class(source)
    rows = [f"`executor.add_node({name})`" for name in dict.fromkeys((ast.unparse(spin.args[0]), *names))]
    return f"write {in_a_row([*made, *rows, '`executor.spin()`'])} instead of line {spin.lineno}{more}"


def on_their_own(source: PythonSource, threads: Sequence[ast.Call]) -> str:
    """Return how each thread spins its node with an executor of its own; empty if the node is not seen."""
    name, more = _class_here(source)
    given = [keyword.value for thread in threads for keyword in thread.keywords if keyword.arg == "args"]
    alone = [value.elts[0] for value in given if isinstance(value, ast.Tuple) and len(value.elts) == 1]
    if len(alone) != len(threads):
        return ""
    rows = [f"`args=({ast.unparse(node)}, {name}())` on line {node.lineno}" for node in alone]
    return f"write {in_a_row(rows)}{more}"


def _with_class(source: PythonSource) -> tuple[list[str], str]:
    """Return how an executor is made here, and what is to be imported for that."""
    name, more = _class_here(source)
    return [f"`executor = {name}()`"], more


def _class_here(source: PythonSource) -> tuple[str, str]:
    """Return an executor's class as the file knows it, and how to import it if the file knows none."""
    known = [name for name in sorted(source.names) if _names_executor(source, name)]
    name = known[0] if known else "SingleThreadedExecutor"
    return name, "" if known else f", with `from rclpy.executors import {name}` at the top"


def _names_executor(source: PythonSource, name: str) -> bool:
    meant = source.resolve(ast.Name(name)) or ""
    return meant.startswith("rclpy.executors.") and meant.endswith("ThreadedExecutor")


def _spun_by(spin: ast.Call) -> str:
    return ast.unparse(spin.func).removesuffix(".spin")


def _is_rclpys(source: PythonSource, call: ast.Call) -> bool:
    return source.resolve(call.func) == "rclpy.spin"


def _ends(function: Function, nodes: Sequence[ast.expr]) -> Iterator[ast.Call]:
    """Yield the calls that destroy one of some nodes."""
    wanted = {f"{ast.unparse(node)}.destroy_node" for node in nodes}
    for node in own_nodes(function):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in wanted:
            yield node
