"""Code that is never reached, runs in the wrong order or hides errors, none of which Python reports."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.code.deadlocks import deadlocks
from ros2lab.diagnose.code.summed_floats import summed_floats
from ros2lab.diagnose.finding import Finding, in_a_row, lines_in_words
from ros2lab.diagnose.sources.entrance import is_lasting
from ros2lab.diagnose.sources.node_source import CREATORS, Creation, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.one_run import blocks, is_steady
from ros2lab.diagnose.sources.python_source import (
    YIELDS,
    Function,
    PythonSource,
    given_to,
    last_name,
    names_bound,
    own_nodes,
    parameters,
    walk,
)
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import calls_in, stores_in

_LEAVES = (ast.Return, ast.Raise, ast.Continue, ast.Break)
_FREQUENCIES = frozenset(("hz", "rate", "freq", "frequency"))
_PERIODS = frozenset(("period", "interval", "time", "dt", "s", "sec", "secs", "seconds", "ms"))
_LONGEST_PERIOD = 100  # s; a longer literal that is not a whole number of minutes is probably in ms


def flow_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield faults in the control flow of a package, and others that raise no error."""
    for source in sources.sources.values():
        for _owner, function, node in sources.scoped(source):
            for block in blocks(node):
                yield from _unreachable(source, block, function or (getattr(node, "name", None) and node))
                yield from _disordered(sources, source, block)
        for loop in (node for node in source.nodes if isinstance(node, (ast.For, ast.While))):
            yield from _one_turn(source, loop)
        yield from _bound_late(source)
        yield from _never_true(source)
        yield from summed_floats(sources, source)
    yield from deadlocks(sources)
    for creation, function in sources.callbacks():
        yield from _hidden(creation, function)
    for owner in sources.nodes:
        yield from _never_started(sources, owner)
    for creation in sources.creations:
        yield from _period(sources, creation)
        yield from _frequency(sources, creation)


def _bound_late(source: PythonSource) -> Iterator[Finding]:
    """Yield lambdas passed to ROS in a loop that look up the loop variable only after the loop has ended."""
    for loop in source.nodes:
        if not isinstance(loop, ast.For) or _ends_or_spins(loop):
            continue
        names = {n.id for n in ast.walk(loop.target) if isinstance(n, ast.Name)}
        calls = calls_in(own_nodes(loop))
        made = [n for n in calls if getattr(n.func, "attr", "") in CREATORS]
        for given in (argument for call in made for argument in given_to(call)):
            if not isinstance(given, ast.Lambda):
                continue
            inner = [*walk(given)]
            asked = {n.id for n in ast.walk(given.body) if isinstance(n, ast.Name)}
            bound = {n.arg for n in inner if isinstance(n, ast.arg)}
            bound |= names_bound(inner)
            late = sorted(asked & names - bound)
            if late:
                takes = [*filter(None, [ast.unparse(given.args)]), *(f"{name}={name}" for name in late)]
                cause = f"This lambda looks up {late[0]} only when it is called, after the loop has ended, so every lambda gets the last {late[0]}."
                fix = f"write `lambda {', '.join(takes)}: {ast.unparse(given.body)}`"
                yield Finding("computed-once", cause, source.at(given), fix)


def _ends_or_spins(loop: ast.For) -> bool:
    """Return whether a loop may end early, so that its variable stays, or calls what it has passed on."""
    return any(
        isinstance(node, (ast.Break, ast.Return, ast.Raise)) or "spin" in getattr(node, "attr", "")
        for node in own_nodes(loop)
    )


def _period(sources: NodeSources, creation: Creation) -> Iterator[Finding]:
    """Yield timers whose period is zero or negative, or probably in milliseconds."""
    given = creation.source.written(creation.given("timer_period_sec"))
    period = sources.value(creation.source, given)
    if (
        given is not None
        and isinstance(period, (int, float))
        and period <= 0
        and not _runs_once(sources, creation)
    ):
        text = ast.unparse(given)
        is_cut = "//" in text
        why = " (// divides without a remainder)" if is_cut else ""
        cause = f"The period {text} is {period:g}{why}: this timer fires without a pause."
        fix = (
            f"write `{text.replace('//', '/')}`"
            if is_cut
            else "write a period above 0, in seconds, such as 0.1"
        )
        yield Finding("period", cause, creation.source.at(given), fix)
    if type(period) is int and period >= _LONGEST_PERIOD and period % 60:
        cause = f"This timer calls its callback every {period:g} s, because a period is given in seconds."
        fix = f"write {period / 1000:g}, if milliseconds were meant"
        yield Finding("period", cause, creation.source.at(creation.call), fix)


def _runs_once(sources: NodeSources, creation: Creation) -> bool:
    """Return whether a timer may be stopped in its callback, so that it runs only once, as soon as possible."""
    function = sources.function_of(creation, creation.given("callback"))
    nodes = [*walk(function)] if function else []
    ends = {getattr(node, "attr", "") for node in nodes} & {"shutdown", "try_shutdown", "exit"}
    is_left = bool(ends) or any(isinstance(node, ast.Raise) for node in nodes)
    words = {getattr(node, "attr", "") for node in creation.source.nodes}
    return function is None or is_left or bool(words & {"cancel", "destroy_timer"})


def _frequency(sources: NodeSources, creation: Creation) -> Iterator[Finding]:
    """Yield timers whose period is named like a frequency and is at least 1."""
    given = creation.given("timer_period_sec")
    text = dotted(given) or ""
    words = set(text.rpartition(".")[2].lower().split("_"))
    if given is None or not words & _FREQUENCIES or words & _PERIODS:
        return
    value = sources.value(creation.source, creation.source.written(given))
    if isinstance(value, (int, float)) and value > 1:
        cause = f"Judging by its name, {text} is a frequency, but a timer takes a period in seconds: this one fires every {value:g} s."
        yield Finding("period", cause, creation.source.at(given), f"write 1.0 / {text}")


def _unreachable(source: PythonSource, block: list[ast.stmt], function: object) -> Iterator[Finding]:
    for before, after in itertools.pairwise(n for n in block if not _is_idle(n)):
        if isinstance(before, _LEAVES):
            # An unreachable yield is how an empty generator is written.
            if any(isinstance(n, YIELDS) for n in ast.walk(after)):
                continue
            rest = block[block.index(before) + 1 :]
            never = lines_in_words(after.lineno, max(n.end_lineno or n.lineno for n in rest))
            cause = f"Python never reaches {never} (`{ast.unparse(after).splitlines()[0]}`), because of `{ast.unparse(before)}` on line {before.lineno}."
            kind = type(before).__name__.lower()
            fix = f"move the {kind} to the end, or below the condition it belongs to"
            done = {*map(ast.unparse, block[: block.index(before)])}
            is_bare = isinstance(before, ast.Return) and before.value is None
            is_whole = isinstance(function, Function) and block is function.body
            if all(isinstance(n, _LEAVES) or ast.unparse(n) in done for n in rest):
                fix = f"remove {never}"
            elif any(isinstance(n, _LEAVES) for n in rest) or (is_bare and is_whole):
                fix = f"remove line {before.lineno}, or what comes after it; or write the {kind} below the condition it belongs to"
            yield Finding("unreachable", cause, source.at(after), fix)


def _is_idle(statement: ast.stmt) -> bool:
    """Return whether a statement is `pass`, or only a value such as a text or `...`."""
    match statement:
        case ast.Pass() | ast.Expr(value=ast.Constant()):
            return True
    return False


def _never_true(source: PythonSource) -> Iterator[Finding]:
    """Yield the conditions of an if/elif chain that are never reached because an earlier one covers them."""
    inner = {id(n.orelse[0]) for n in source.nodes if isinstance(n, ast.If) and _is_elif(n)}
    for first in (n for n in source.nodes if isinstance(n, ast.If) and id(n) not in inner):
        chain = [first]
        while _is_elif(chain[-1]):
            chain.append(chain[-1].orelse[0])  # type: ignore[arg-type]
        for number, later in enumerate(chain):
            taken = next(
                (earlier for earlier in chain[:number] if _takes_all(earlier.test, later.test)), None
            )
            if taken:
                cause = f"Whenever `{ast.unparse(later.test)}` is true, so is `{ast.unparse(taken.test)}` on line {taken.lineno}, so this is never reached."
                fix = f"check `{ast.unparse(later.test)}` first, and `{ast.unparse(taken.test)}` after it"
                yield Finding("unreachable", cause, source.at(later), fix)


def _one_turn(source: PythonSource, loop: ast.For | ast.While) -> Iterator[Finding]:
    """Yield a loop that always ends in its first turn, although something in it is decided or gathered turn by turn."""
    ends = _ends_of(loop.body)
    inside = own_nodes(loop)
    if not ends or loop.orelse or any(isinstance(n, (ast.Continue, *YIELDS)) for n in inside):
        return
    is_for, is_left = isinstance(loop, ast.For), any(isinstance(n, ast.Break) for n in ends)
    is_decided = len(ends) > 1 and (is_for or not is_left)
    is_gathered = is_for and any(isinstance(n, ast.AugAssign) for n in loop.body)
    if is_decided or is_gathered:
        over = f"over {ast.unparse(loop.iter)} " if isinstance(loop, ast.For) else ""
        lines = in_a_row([str(line) for line in sorted({end.lineno for end in ends})])
        cause = f"This loop {over}always ends in its first turn, on line {lines.replace(' and ', ' or ')}."
        last = f"`{ast.unparse(ends[-1])}`"
        fix = f"write {last} below the loop, to the left, instead of in it"
        if is_decided:
            fix = f"let only one way end the loop early, and write below it, to the left, what holds if none did, such as {last}"
        yield Finding("unreachable", cause, source.at(loop), fix)


def _ends_of(block: Sequence[ast.stmt]) -> list[ast.stmt]:
    """Return the statements with which a block leaves the loop around it, in order; empty if a run may come to its end."""
    ends: list[ast.stmt] = []
    for statement in block:
        if isinstance(statement, (ast.Return, ast.Raise, ast.Break)):
            return [*ends, statement]
        if isinstance(statement, ast.If):
            ways = [_ends_of(statement.body), _ends_of(statement.orelse)]
            ends += [*ways[0], *ways[1]]
            if all(ways):
                return ends
    return []


def _is_elif(node: ast.If) -> bool:
    return len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If)


def _takes_all(before: ast.expr, after: ast.expr) -> bool:
    """Return whether a comparison with a number is true whenever a later one of the same value is."""
    match before, after:
        case (
            ast.Compare(
                left=earlier_value, ops=[sign], comparators=[ast.Constant(value=int() | float() as limit)]
            ),
            ast.Compare(
                left=later_value,
                ops=[later_sign],
                comparators=[ast.Constant(value=int() | float() as number)],
            ),
        ) if ast.unparse(earlier_value) == ast.unparse(later_value) and is_steady(later_value):
            is_up = isinstance(sign, (ast.Gt, ast.GtE)) and isinstance(later_sign, (ast.Gt, ast.GtE))
            is_down = isinstance(sign, (ast.Lt, ast.LtE)) and isinstance(later_sign, (ast.Lt, ast.LtE))
            is_strict = isinstance(sign, (ast.Gt, ast.Lt)) and isinstance(later_sign, (ast.GtE, ast.LtE))
            if limit == number:
                return (is_up or is_down) and not is_strict
            return (is_up and limit < number) or (is_down and limit > number)
    return False


def _disordered(sources: NodeSources, source: PythonSource, block: list[ast.stmt]) -> Iterator[Finding]:
    """Yield calls that end a node before it spins, and calls that create something only after the spin."""
    calls = [_call_of(source, statement) for statement in block]
    names = [source.resolve(call.func) or ast.unparse(call.func) if call else "" for call in calls]
    first = next((number for number, name in enumerate(names) if is_lasting(name)), None)
    spin = calls[first] if first is not None else None
    if first is None or spin is None:
        return
    is_ended = _may_end(sources, block[first])
    for number, (name, call) in enumerate(zip(names, calls, strict=True)):
        between = block[number + 1 : first]
        if (
            number < first
            and call
            and _ends_what_spins(sources, source, call, (spin, *calls[:first]), between)
        ):
            cause = (
                f"`{ast.unparse(block[number])}` comes before the spin, which then has nothing left to spin."
            )
            fix = f"move it after `{ast.unparse(spin)}`, to the end of main"
            yield Finding("life-order", cause, source.at(block[number]), fix)
        is_late = number > first and name.rpartition(".")[2] in (*CREATORS, "add_node") and not is_ended
        if is_late and "rclpy.init" not in names[first:number]:
            cause = f"`{ast.unparse(block[number])}` comes after the spin, which runs until Ctrl-C, so it is not reached before then."
            fix = f"move it above line {spin.lineno}, `{ast.unparse(spin)}`"
            yield Finding("life-order", cause, source.at(block[number]), fix)


def _may_end(sources: NodeSources, spin: ast.stmt) -> bool:
    """Return whether a spin may end before Ctrl-C: by a callback's error that is caught, or by a shutdown."""
    caught = {
        last_name(inner)
        for handler in walk(spin)
        if isinstance(handler, ast.ExceptHandler)
        for inner in (walk(handler.type) if handler.type else [ast.Name("BaseException")])
    }
    is_shut = any(
        getattr(node, "attr", "").endswith("shutdown")
        for owner in sources.classes.values()
        for node in walk(owner.definition)
    )
    return is_shut or bool(
        caught - {"KeyboardInterrupt", "ExternalShutdownException", "rclpy", "executors", ""}
    )


def _ends_what_spins(
    sources: NodeSources,
    source: PythonSource,
    call: ast.Call,
    others: Sequence[ast.Call | None],
    between: list[ast.stmt],
) -> bool:
    """Return whether a call ends rclpy, or just the node or the executor that a later call spins."""
    owner, _, method = ast.unparse(call.func).rpartition(".")
    inner = [node for statement in between for node in walk(statement)]
    if source.resolve(call.func) in ("rclpy.shutdown", "rclpy.try_shutdown"):
        made = {source.resolve(node.func) or "" for node in calls_in(inner)}
        is_other = bool(call.args or call.keywords)  # another context
        return (
            not is_other and "rclpy.init" not in made and not any(name in sources.functions for name in made)
        )
    spin, *before = (other for other in others if other)  # the spin, and what comes before it
    executor = ast.unparse(spin.func).removesuffix(".spin")
    given = [spin, *(c for c in before if ast.unparse(c.func) == f"{executor}.add_node")]
    nodes = {ast.unparse(inner.args[0]) for inner in given if inner.args}
    ended = {"destroy_node": nodes, "shutdown": {executor}}.get(method, set())
    stored = {ast.unparse(node) for node in stores_in(inner)}
    return owner in ended and owner not in stored


def _call_of(source: PythonSource, statement: ast.stmt) -> ast.Call | None:
    """Return the call that a statement makes: in a `try` or a `with` the one that runs until Ctrl-C."""
    if isinstance(statement, (ast.Try, ast.With)):
        calls = filter(None, (_call_of(source, inner) for inner in statement.body))
        return next(
            (call for call in calls if is_lasting(source.resolve(call.func) or ast.unparse(call.func))), None
        )
    value = getattr(statement, "value", None)
    is_asked = isinstance(statement, (ast.Expr, ast.Assign)) and isinstance(value, ast.Call)
    return value if is_asked else None


def _shown(creation: Creation, function: Function) -> str:
    """Return how a callback shows an error: by its node's logger, if the name of the node is known in it."""
    made_by = creation.call.func.value if isinstance(creation.call.func, ast.Attribute) else None
    own = creation.function
    is_inside = own is not None and function is not own and function in walk(own)
    known = [parameter.arg for parameter in parameters(function)]
    known += [
        *names_bound(own_nodes(creation.source.tree)),
        *(names_bound(own_nodes(own)) if own and is_inside else ()),
    ]
    first = next((n.id for n in ast.walk(made_by) if isinstance(n, ast.Name)), "") if made_by else ""
    return (
        f"{ast.unparse(made_by)}.get_logger().error(str(error))"
        if made_by and first in known
        else "print(error)"
    )


def _hidden(creation: Creation, function: Function) -> Iterator[Finding]:
    """Yield except clauses that silently catch every error of a callback."""
    for node in own_nodes(function):
        if not isinstance(node, ast.ExceptHandler) or not all(
            isinstance(statement, (ast.Pass, ast.Return)) for statement in node.body
        ):
            continue
        if node.type is None or getattr(node.type, "id", "") in ("Exception", "BaseException"):
            cause = (
                f"{function.name}() catches every error without reporting it, so failures there stay silent."
            )
            shown = _shown(creation, function)
            fix = f"write `except ValueError as error:`, or whichever error you expect, and {shown} below it"
            yield Finding("errors-hidden", cause, creation.source.at(node), fix)


def _never_started(sources: NodeSources, owner: NodeClass) -> Iterator[Finding]:
    """Yield what the constructor creates and stops again, and timers that are never started."""
    constructor, source = owner.methods.get("__init__"), owner.source
    words = {getattr(node, "attr", "") for file in sources.sources.values() for node in file.nodes}
    if constructor is None or "reset" in words:
        return
    yield from _ended_at_once(source, constructor)
    for node in walk(constructor):
        if isinstance(node, ast.keyword) and node.arg == "autostart" and ast.unparse(node.value) == "False":
            cause = "autostart=False makes a timer that starts only when its reset() is called, and nothing calls it."
            place = source.at(node.value)
            yield Finding("never-started", cause, place, "remove autostart=False", never=(place,))


def _ended_at_once(source: PythonSource, constructor: Function) -> Iterator[Finding]:
    """Yield what a constructor creates and stops again."""
    made: dict[str, str] = {}
    for statement in constructor.body:
        if _may_use(statement):
            made.clear()
        if isinstance(statement, ast.Assign) and isinstance(statement.value, ast.Call):
            is_made = getattr(statement.value.func, "attr", "") in CREATORS
            kept = {to.attr for to in statement.targets if isinstance(to, ast.Attribute)}
            made |= dict.fromkeys(kept if is_made else (), source.at(statement))
        call = statement.value if isinstance(statement, ast.Expr) else None
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute)):
            continue
        given = call.args[0] if call.func.attr.startswith("destroy_") and call.args else call.func.value
        is_end = call.func.attr in ("cancel", "destroy") or call.func.attr.startswith("destroy_")
        if is_end and is_self_attribute(given) and given.attr in made:
            cause = f"`{ast.unparse(call)}` in __init__ stops self.{given.attr} before it is ever used."
            fix = f"remove the line `{ast.unparse(call)}`, or move it to where self.{given.attr} should stop"
            yield Finding("never-started", cause, source.at(call), fix, never=(made[given.attr],))


def _may_use(statement: ast.stmt) -> bool:
    """Return whether a statement may use what a constructor has made: it calls more than what makes and logs."""
    return isinstance(statement, (ast.While, ast.For)) or any(
        isinstance(node, ast.Call) and _is_own_or_spins(node.func) for node in walk(statement)
    )


def _is_own_or_spins(function: ast.expr) -> bool:
    name = getattr(function, "attr", "")
    is_nodes = name.startswith(("create_", "declare_", "get_", "destroy"))
    return "spin" in name or (is_self_attribute(function) and not is_nodes)
