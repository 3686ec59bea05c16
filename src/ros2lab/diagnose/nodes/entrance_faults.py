"""What is wrong in how a program initializes, spins and ends."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator

from ros2lab.diagnose.code.bound_names import unbound_names
from ros2lab.diagnose.finding import Finding, in_a_row, lines_in_words
from ros2lab.diagnose.nodes.endless_loops import import_work
from ros2lab.diagnose.nodes.executors import joined, joined_after, spun_together
from ros2lab.diagnose.nodes.spin_loops import CALLED_BACK, one_turn, rests, stands_still
from ros2lab.diagnose.sources.entrance import SPINNING, Call, Entrance
from ros2lab.diagnose.sources.node_source import NodeClass
from ros2lab.diagnose.sources.one_run import blocks, calls_in_one_run, is_always_reached, may_be_caught
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    given_to,
    last_name,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import calls_in, removal

# With these a program may last or wait without spinning.
_WAITING = frozenset(
    ("Thread", "run", "gather", "create_task", "create_rate", "wait", "join", "sleep", "input")
)
_SPINS_ITSELF = re.compile(r"spin|add_node|Executor|Thread")


def entrance_faults(entrance: Entrance, mains: Collection[str]) -> Iterator[Finding]:
    """Yield what is wrong in how a program initializes, spins and ends."""
    if entrance.node is None:
        yield from _left_aside(entrance, mains)
        return
    yield from import_work(entrance)
    yield from _init(entrance)
    for call in entrance.calls:
        is_rclpys = call.name == "rclpy.init" or (
            entrance.makes_node(call) and not _is_entered(entrance, call)
        )
        if is_rclpys and (statement := _with_of(call.call, call.function)):
            yield Finding(
                "context-manager",
                f"In ROS 2 Jazzy, {ast.unparse(call.call.func)}() cannot be used in a `with` statement; later releases allow it.",
                call.source.at(call.call),
                _without_with(statement, call.call),
            )
    if any(call.short in CALLED_BACK for call in entrance.calls):
        yield from _spin(entrance)
    yield from stands_still(entrance)
    yield from one_turn(entrance)


def _left_aside(entrance: Entrance, mains: Collection[str]) -> Iterator[Finding]:
    """Yield a function that makes a node but is never called, in the file of an entrance without a node."""
    source = entrance.source
    named = {last_name(node) for node in source.nodes}
    for name, (home, function) in entrance.sources.functions.items():
        if home is not source or entrance.may_do_more or function.name in named or name in mains:
            continue
        if Entrance(entrance.sources, name).node is not None:
            cause = f"`ros2 run` calls {entrance.function.name}(), which never calls {function.name}(), where the node is made."
            fix = f"write `{function.name}()` as the last line of {entrance.function.name}()"
            yield Finding(
                "never-made", cause, source.at(entrance.function), fix, never=(source.at(function),)
            )


def _init(entrance: Entrance) -> Iterator[Finding]:
    inits = [call for call in entrance.calls if call.name == "rclpy.init"]
    node = entrance.node
    assert node is not None
    given = {keyword.arg for call in entrance.calls for keyword in call.call.keywords}
    is_called = any(call.short == "init" for call in entrance.calls) or entrance.inits_at_import
    is_called |= "context" in given  # of which this says nothing
    if not entrance.may_do_more and not is_called:
        cause = "A node is made, but rclpy.init() is not called before it."
        yield Finding("rclpy-init-missing", cause, node.source.at(node.call), _init_written(entrance))
    sure = [
        init
        for init in inits
        if is_always_reached(init.function, init.call)
        and not may_be_caught(init.source, init.call.lineno, RuntimeError)
        and not any(keyword.arg == "context" for keyword in init.call.keywords)
    ]
    is_ended = entrance.spins and any(
        call.short.endswith("shutdown") and call.function not in {init.function for init in sure}
        for call in entrance.calls
    )
    is_in_one_run = len(sure) > 1 and not is_ended and _are_in_one_run(entrance, sure)
    if is_in_one_run and not _shutdown_between(sure[0].function, sure[0].call, sure[-1].call):
        kept = next((init for init in sure if init.function is entrance.function), sure[0])
        extra = next(init for init in reversed(sure) if init is not kept)
        cause = "rclpy.init() is called twice in one program."
        fix = f"{removal(extra.source, extra.call)} on line {extra.call.lineno}; the one in {kept.function.name}() stays"
        yield Finding("rclpy-init-twice", cause, extra.source.at(extra.call), fix)


def _are_in_one_run(entrance: Entrance, asked: list[Call]) -> bool:
    """Return whether two of some calls can be made in the same run of a program."""
    sources = entrance.sources
    leading, holders = {id(call.call) for call in asked}, {id(call.function) for call in asked}
    before = 0
    while before != len(leading):
        before = len(leading)
        for call in entrance.calls:
            _, function = sources.functions.get(call.name, (None, None))
            made = sources.classes.get(call.name)
            if id(function or (made and sources.method(made, "__init__"))) in holders:
                leading.add(id(call.call))
                holders.add(id(call.function))
    runs = (calls_in_one_run(function, lambda call: id(call) in leading) for function in entrance.functions)
    return any(len(calls) > 1 for calls in runs)


def _init_written(entrance: Entrance) -> str:
    """Return how to call rclpy.init in the function of an entrance, with the names that are known there."""
    names = [argument.arg for argument in entrance.function.args.args]
    is_imported = any(imported.local == "rclpy" for imported in entrance.source.imports)
    more = "" if is_imported else ", with `import rclpy` at the top"
    given = "args=args" if "args" in names else ""
    return f"write rclpy.init({given}) as the first line of {entrance.function.name}{more}"


def _spin(entrance: Entrance) -> Iterator[Finding]:
    """Yield why no callback is called, only one, or only those of some nodes."""
    node, name = entrance.node, entrance.function.name
    assert node is not None
    waits = entrance.may_do_more or any(call.short in _WAITING for call in entrance.calls)
    if not entrance.spins and not waits and not entrance.has_loop and not _names_spin(entrance):
        cause, fix = f"{name} makes a node but never spins it", _spin_of(entrance, node)
        guards = (
            n
            for n in entrance.source.tree.body
            if isinstance(n, ast.If) and "__name__" in ast.unparse(n.test)
        )
        calls = calls_in(inner for guard in guards for inner in walk(guard))
        if late := [call.lineno for call in calls if last_name(call.func) in SPINNING]:
            cause += f": `ros2 run` calls {name}() alone and never comes to line {late[0]}"
            fix += f", and remove line {late[0]}"
        cause += ", so the program ends at once and no callback is called."
        yield Finding("spin-missing", cause, node.source.at(node.call), fix)
    if not waits:
        yield from _one_turn(entrance)
    if not entrance.spins and not entrance.may_do_more and not _names_spin(entrance):
        yield from _unspun_loop(entrance)
    yield from rests(entrance)
    yield from _idle_executor(entrance)
    yield from left_out(entrance)
    yield from second_spins(entrance)


def second_spins(entrance: Entrance) -> Iterator[Finding]:
    """Yield spins that are never reached, because another one runs before them."""
    for inner, function, spins in _in_a_row(entrance):
        cause = "A spin runs until Ctrl-C, so the second spin is never reached and its node's callbacks are never called."
        yield Finding("spin-missing", cause, inner.at(spins[1]), joined(inner, function, spins))
    for spin in entrance.spins:
        loops = (node for node in own_nodes(spin.function) if isinstance(node, ast.For))
        for loop in loops if spin.is_lasting and spin.call.args else ():
            is_direct = any(isinstance(n, ast.Expr) and n.value is spin.call for n in loop.body)
            if is_direct and ast.unparse(loop.target) == ast.unparse(spin.call.args[0]):
                cause = "A spin runs until Ctrl-C, so the loop stays at its first node and no callback of the others is ever called."
                fix = joined_after(spin.source, loop, spin.call)
                yield Finding("spin-missing", cause, spin.source.at(spin.call), fix)


def _spin_of(entrance: Entrance, node: Call) -> str:
    """Say which node to spin, and where."""
    name = entrance.function.name
    for statement in own_nodes(node.function):
        match statement:
            case ast.Assign(targets=[ast.Name(id=variable)], value=value) if value is node.call:
                if node.function is entrance.function:
                    return f"write `rclpy.spin({variable})` below line {statement.end_lineno}"
            case ast.Expr(value=value) if value is node.call and node.function is entrance.function:
                return f"write `rclpy.spin({ast.unparse(value)})` instead of line {statement.lineno}"
    return f"write rclpy.spin(...) in {name}(), with the node in the parentheses, after the node is made"


def _unspun_loop(entrance: Entrance) -> Iterator[Finding]:
    """Yield a loop that sleeps without spinning."""
    node = entrance.node
    assert node is not None
    if any(call.short in _WAITING - {"sleep", "wait", "input"} for call in entrance.calls):
        return
    for call in entrance.calls:
        # A loop in a method of the node is reported as one that keeps callbacks waiting.
        if (
            call.name != "time.sleep"
            or not call.is_repeated
            or call.function is not node.function
            or not call.call.args
        ):
            continue
        name, length = node.source.name_of(node.call) or "node", ast.unparse(call.call.args[0])
        cause = f"This loop sleeps without spinning, so no callback of {name} is ever called."
        fix = f"write rclpy.spin_once({name}, timeout_sec={length}) instead of {ast.unparse(call.call)}"
        yield Finding("spin-missing", cause, call.source.at(call.call), fix)


def _one_turn(entrance: Entrance) -> Iterator[Finding]:
    """Yield a program that spins once and ends."""
    name = entrance.function.name
    once = [
        spin for spin in entrance.spins if spin.short == "spin_once" and _is_the_only_turn(entrance, spin)
    ]
    if once and len(once) == len(entrance.spins):
        given = ast.unparse(once[-1].call.args[0]) if once[-1].call.args else "node"
        cause = f"spin_once() calls at most one callback, and {name} does not call it in a loop, so the program then ends."
        fix = f"if it is to go on, write rclpy.spin({given}) instead of {ast.unparse(once[-1].call)}"
        yield Finding("spin-missing", cause, once[-1].source.at(once[-1].call), fix)


def _idle_executor(entrance: Entrance) -> Iterator[Finding]:
    """Yield an executor that is spun without any nodes."""
    named = {last_name(node) for function in entrance.functions for node in walk(function)}
    made = [
        call
        for call in entrance.calls
        if call.name.startswith("rclpy.executors.") and call.short.endswith("Executor")
    ]
    of_executor = [spin for spin in entrance.spins if spin.name != "rclpy.spin" and spin.is_lasting]
    if (
        made
        and of_executor
        and not {"add_node", "spin_once"} & named
        and len(of_executor) == len(entrance.spins)
    ):
        spin = of_executor[0]
        whole = ast.unparse(spin.call.func).removesuffix(".spin")
        cause = f"`{ast.unparse(spin.call)}` spins an executor that has no nodes, so no callback is called."
        assert entrance.node is not None
        name = entrance.node.source.name_of(entrance.node.call)
        is_here = name and entrance.node.function is spin.function
        fix = f"write `{whole}.add_node({name if is_here else ast.unparse(entrance.node.call)})` above this line"
        yield Finding("spin-missing", cause, spin.source.at(spin.call), fix)


def _is_the_only_turn(entrance: Entrance, turn: Call) -> bool:
    """Return whether a program spins once and ends: it neither repeats that nor uses the node afterwards."""
    node = ast.unparse(turn.call.args[0]) if turn.call.args else ""
    asked = {
        n.attr
        for n in own_nodes(turn.function)
        if isinstance(n, ast.Attribute) and ast.unparse(n.value) == node and n.lineno > turn.call.lineno
    }
    is_own = turn.function is entrance.function and turn.call in own_nodes(turn.function)
    return is_own and not turn.is_repeated and asked <= {"destroy_node"}


def left_out(entrance: Entrance, *, is_unspun: bool = False) -> Iterator[Finding]:
    """Yield a node that is made but never used, while others are spun; also one that is used, if it is known not to be spun."""
    for spin in entrance.spins:
        spun, added = _spun_by(spin)
        texts = [*dict.fromkeys(map(ast.unparse, spun))]
        if not texts or {*texts} & {*unbound_names(spin.source, spin.function)}:
            continue  # the node may be meant
        made = (entry for entry in _made_nodes(entrance, spin) if entry[1] not in texts)
        left = [
            (node, name, owner)
            for node, name, owner in made
            if is_unspun or (_needs_spin(entrance, owner) and not _is_used(spin, name))
        ]
        for node, name, owner in left:
            cause = f"{name} is made here but never spun: `{ast.unparse(spin.call)}` calls only the callbacks of {in_a_row(texts)}."
            code, fix = "spin-missing", ""
            if added:
                code, whole = "not-spinning", ast.unparse(added[-1].func)
                fix = f"write `{whole}({name})` below line {added[-1].lineno}, `{ast.unparse(added[-1])}`"
            elif entrance.sources.resolve(spin.source, spun[0]) == owner.name:
                cause = (
                    f"`{ast.unparse(spin.call)}` is given the class instead of {name}, the node made from it."
                )
                fix = f"write rclpy.spin({name})"
            fix = fix or spun_together(spin.source, spin.call, [other for _, other, _ in left])
            yield Finding(code, cause, spin.source.at(node), fix)


def _spun_by(spin: Call) -> tuple[list[ast.expr], list[ast.Call]]:
    """Return the nodes that a call spins, and the calls that add them to its executor."""
    if spin.name == "rclpy.spin":
        return spin.call.args[:1], []
    executor = ast.unparse(spin.call.func).rpartition(".")[0]
    added = [
        call
        for call in calls_in(own_nodes(spin.function))
        if ast.unparse(call.func) == f"{executor}.add_node"
    ]
    loops = [n for n in own_nodes(spin.function) if isinstance(n, ast.For) and {*added} & {*walk(n)}]
    spun = [node for call in added for node in given_to(call)]
    return [*spun, *(n for loop in loops for n in walk(loop.iter) if isinstance(n, ast.Name))], added


def _made_nodes(entrance: Entrance, spin: Call) -> Iterator[tuple[ast.Assign, str, NodeClass]]:
    """Yield the assignments of new nodes in the function that spins, each with its variable and the node's class."""
    for node in own_nodes(spin.function):
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call(func=made)):
                owner = entrance.sources.classes.get(entrance.sources.resolve(spin.source, made) or "")
                if owner is not None and entrance.sources.lineage(owner)[1]:
                    yield node, name, owner


def _needs_spin(entrance: Entrance, owner: NodeClass) -> bool:
    """Return whether a node has callbacks, which only a spin calls, and does not see to that itself."""
    family = (inner.definition for inner in entrance.sources.lineage(owner)[0])
    has_callbacks = any(
        made.owner is owner and made.method in CALLED_BACK for made in entrance.sources.creations
    )
    return has_callbacks and not any(_SPINS_ITSELF.search(ast.dump(definition)) for definition in family)


def _is_used(spin: Call, name: str) -> bool:
    """Return whether a function uses a node other than to destroy it after the spin.

    One that is destroyed before the spin is meant to be gone by then.
    """
    nodes = [*walk(spin.function)]
    destroyed = {
        id(n.value)
        for n in nodes
        if isinstance(n, ast.Attribute) and n.attr == "destroy_node" and n.lineno > spin.call.lineno
    }
    loads = (n for n in nodes if isinstance(n, ast.Name) and n.id == name and isinstance(n.ctx, ast.Load))
    return any(id(load) not in destroyed for load in loads)


def _in_a_row(entrance: Entrance) -> Iterator[tuple[PythonSource, Function, list[ast.Call]]]:
    """Yield several spins in the same block, with the function that has them."""
    spinning = {id(spin.call): spin.source for spin in entrance.spins if spin.is_lasting}
    for function in entrance.functions:
        for node in walk(function):
            for block in blocks(node):
                values = (statement.value for statement in block if isinstance(statement, ast.Expr))
                calls = [call for call in calls_in(values) if id(call) in spinning]
                if len(calls) > 1 and not _may_end(entrance, function, calls):
                    yield spinning[id(calls[1])], function, calls


def _may_end(entrance: Entrance, function: Function, spins: list[ast.Call]) -> bool:
    """Return whether the first of several spins may end before Ctrl-C: what it calls shuts something down."""
    between = range(spins[0].lineno, spins[1].lineno)
    is_begun_anew = any(
        call.short == "init" and call.function is function and call.call.lineno in between
        for call in entrance.calls
    )
    return is_begun_anew or any(
        call.short.endswith("shutdown") and call.function is not function for call in entrance.calls
    )


def _names_spin(entrance: Entrance) -> bool:
    """Return whether a spinning function is passed on, as in `Thread(target=executor.spin)`."""
    for function in entrance.functions:
        named = {id(n.func) for n in calls_in(walk(function))}
        named |= {id(n.value) for n in walk(function) if isinstance(n, ast.Expr)}
        names = (n for n in walk(function) if isinstance(n, (ast.Name, ast.Attribute)) and id(n) not in named)
        if any(last_name(n) in SPINNING for n in names):
            return True
    return False


def _with_of(call: ast.Call, function: Function) -> ast.With | None:
    """Return the `with` statement that enters what a call returns; None if there is none."""
    statements = (node for node in walk(function) if isinstance(node, ast.With))
    return next((n for n in statements if call in [item.context_expr for item in n.items]), None)


def _is_entered(entrance: Entrance, call: Call) -> bool:
    """Return whether a class has an `__enter__` of its own."""
    classes = entrance.sources.classes
    lineage = entrance.sources.lineage(classes[call.name])[0] if call.name in classes else ()
    return any("__enter__" in inner.methods for inner in lineage)


def _without_with(statement: ast.With, call: ast.Call) -> str:
    """Say how to write a call on a line of its own instead of in a `with` statement."""
    item = next(item for item in statement.items if item.context_expr is call)
    alone = (
        f"{ast.unparse(item.optional_vars)} = {ast.unparse(call)}"
        if item.optional_vars
        else ast.unparse(call)
    )
    rest = [ast.unparse(other) for other in statement.items if other is not item]
    if rest:
        return f"write `{alone}` above line {statement.lineno}, and `with {', '.join(rest)}:` there"
    first, last = statement.body[0].lineno, statement.body[-1].end_lineno or statement.body[-1].lineno
    lines = lines_in_words(first, last)
    return f"write `{alone}` instead of line {statement.lineno}, and move {lines} to the left, below it"


def _shutdown_between(function: Function, first: ast.Call, last: ast.Call) -> bool:
    ends = [
        node.lineno for node in calls_in(walk(function)) if (dotted(node.func) or "").endswith("shutdown")
    ]
    return any(first.lineno < line < last.lineno for line in ends)
