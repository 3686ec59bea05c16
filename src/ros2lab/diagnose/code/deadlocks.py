"""Callbacks that wait for an answer which their executor can receive only after they have returned."""

from __future__ import annotations

import ast
import copy
import re
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ros2lab.diagnose.finding import Finding, lines_in_words
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.one_run import blocks, in_loops
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    argument,
    assigned_to,
    given_to,
    last_name,
    names_bound,
    own_nodes,
    returns_value,
)
from ros2lab.diagnose.sources.syntax_parts import calls_in, removal
from ros2lab.diagnose.sources.uses import own_changes

_SPINS = ("rclpy.spin_until_future_complete", "rclpy.spin_once")
GROUP_IMPORTED = "with `from rclpy.callback_groups import MutuallyExclusiveCallbackGroup` at the top"
_SOLE = "rclpy.callback_groups.MutuallyExclusiveCallbackGroup"
_SETS_DEFAULT = re.compile(
    r"\b(_|def )default_callback_group\b"
)  # sets the node's own group, as far as may be
_THREADS, _REENTRANT = "MultiThreadedExecutor", "ReentrantCallbackGroup"
# What rclpy runs as a task, in no callback group: what takes it, and its place and name among the arguments.
_TAKES_TASK = {
    "ActionServer": (3, "execute_callback"),
    "add_done_callback": (0, "fn"),
    "create_task": (0, "callback"),
}


@dataclass(frozen=True)
class _Wait:
    """A statement that waits for an answer.

    Attributes:
        node: the call or loop in it that waits.
        future: the future it waits for; None for a blocking call of the client, which returns the answer.
    """

    statement: ast.stmt
    node: ast.expr | ast.While
    future: ast.expr | None

    @property
    def client(self) -> ast.expr | None:
        """The client that sends the request; None if the statement does not name it."""
        return _client_of(self.node if self.future is None else self.future)

    @property
    def asked(self) -> ast.expr:
        """The expression that gives the future of the answer."""
        if self.future is not None:
            return self.future
        call = copy.deepcopy(self.node)
        call.func.attr += "_async"  # type: ignore[union-attr]
        return call  # type: ignore[return-value]

    def with_answer(self, written: str) -> str:
        """Return the statement with its blocking call replaced by other code; empty if it only waits."""
        if self.future is not None:
            return ""
        return ast.unparse(self.statement).replace(ast.unparse(self.node), written)


@dataclass(frozen=True)
class _Callback:
    """A function that an executor calls, or a method that such a function calls.

    Attributes:
        given: the call of rclpy that the callback was passed to.
        is_task: whether it holds no callback group, so that its node can be spun in it.
        is_direct: whether it is the callback itself, not a method that it calls.
    """

    source: PythonSource
    owner: NodeClass | None
    function: Function
    given: ast.Call
    is_task: bool
    is_direct: bool

    @property
    def owes(self) -> bool:
        """Whether its caller uses its return value, as for services, actions and parameter callbacks."""
        return returns_value(self.function)

    @property
    def may_be_async(self) -> bool:
        """Whether rclpy awaits it; a parameter callback has to answer at once."""
        return self.is_direct and not getattr(self.given.func, "attr", "").startswith("add_")


def deadlocks(sources: NodeSources) -> Iterator[Finding]:
    """Yield callbacks that wait for something only their own executor could deliver."""
    seen: set[int] = set()
    names = {source: {last_name(n) for n in source.nodes} for source in sources.sources.values()}
    has_threads = any(_THREADS in found for found in names.values())
    for callback in _callbacks(sources):
        source, function = callback.source, callback.function
        if id(function) in seen or _REENTRANT in names[source]:
            continue
        found = _waits(source, function)
        if waits := [wait for wait in found if _is_held(sources, callback, wait, has_threads=has_threads)]:
            seen.add(id(function))
            yield _told(callback, waits, sources, has_threads=has_threads)


def _is_held(sources: NodeSources, callback: _Callback, wait: _Wait, *, has_threads: bool) -> bool:
    """Return whether no other thread and no spin in a wait itself can bring the answer that a callback waits for.

    Both bring what belongs to another node or to another callback group than the running callback; a task has no group.
    """
    spun, own, made = _spun(wait), node_of(callback.given), _made_by(callback, wait)
    if callback.is_task:
        return not has_threads and not spun
    if not spun and not has_threads:
        return True
    if own in names_bound(own_nodes(callback.function)):
        return False  # there, the name stands for another node
    if made is None:
        return not has_threads and spun == {own} and "callback_group" not in callback.source.text
    groups = {group_of(sources, callback.source, call) for call in (made, callback.given)}
    return node_of(made) == own and len(groups) == 1


def _spun(wait: _Wait) -> set[str]:
    """Return what a wait itself spins, as written: nodes, or executors."""
    calls = [n for n in calls_in(ast.walk(wait.node)) if last_name(n.func).startswith("spin")]
    return {ast.unparse(argument(call, 0, "node") or call.func) for call in calls}


def node_of(call: ast.Call) -> str:
    """Return the node for which a call makes something, as written."""
    is_given = "Action" in last_name(call.func)
    return ast.unparse((argument(call, 0, "node") if is_given else getattr(call.func, "value", None)) or call)


def group_of(sources: NodeSources, source: PythonSource, call: ast.Call) -> int:
    """Return what tells the callback group of something of a node: a number, 0 for the node's own group.

    A group counts as one that nothing else has unless the files make it once, or it is the node's and they leave that as it is.
    """
    is_timer = getattr(call.func, "attr", "") == "create_timer"
    group = argument(call, 2 if is_timer else len(call.args), "callback_group")
    if any(keyword.arg is None for keyword in call.keywords):
        return id(call)
    if group is None or ast.unparse(group) in ("None", f"{node_of(call)}.default_callback_group"):
        return id(call) if any(_SETS_DEFAULT.search(file.text) for file in sources.sources.values()) else 0
    made = source.written(group)
    is_sole = isinstance(made, ast.Call) and source.resolve(made.func) == _SOLE
    return id(made if is_sole and id(made) not in in_loops(source.tree) else call)


def in_own_group(call: ast.Call) -> str:
    """Return a call that makes something of a node such that it has a callback group of its own."""
    kept = [keyword for keyword in call.keywords if keyword.arg != "callback_group"]
    group = ast.keyword("callback_group", ast.Call(ast.Name("MutuallyExclusiveCallbackGroup"), [], []))
    given = call.args[:2] if last_name(call.func) == "create_timer" else call.args
    return ast.unparse(ast.Call(call.func, given, [*kept, group]))


def _callbacks(sources: NodeSources) -> Iterator[_Callback]:
    """Yield the functions that are passed to rclpy as callbacks, and the methods that these call."""
    for source in sources.sources.values():
        for owner, _function, call in sources.scoped(source):
            if not isinstance(call, ast.Call) or not _is_of_ros(source, call):
                continue
            for given in given_to(call):
                name = given.attr if is_self_attribute(given) else ""
                function = sources.method(owner, name) if owner and name else None
                function = function or _plain(source, given)
                if function is None:
                    continue
                is_task = _is_task(call, given)
                yield _Callback(source, owner, function, call, is_task, is_direct=True)
                for node in own_nodes(function):
                    inner = node.func if isinstance(node, ast.Call) else None
                    called = sources.method(owner, inner.attr) if is_self_attribute(inner) else None
                    if called is not None:
                        yield _Callback(source, owner, called, call, is_task, is_direct=False)


def _is_task(call: ast.Call, given: ast.expr) -> bool:
    """Return whether rclpy runs a function that it is given as a task."""
    place, name = _TAKES_TASK.get(last_name(call.func), (0, ""))
    return bool(name) and argument(call, place, name) is given


def _plain(source: PythonSource, given: ast.expr) -> Function | None:
    name = given.id if isinstance(given, ast.Name) else ""
    return next((n for n in source.nodes if isinstance(n, Function) and n.name == name), None)


def _is_of_ros(source: PythonSource, call: ast.Call) -> bool:
    name = getattr(call.func, "attr", "")
    is_giving = name.startswith("create_") or (name.startswith("add_") and name.endswith("_callback"))
    return is_giving or (source.resolve(call.func) or "").startswith("rclpy.")


def _waits(source: PythonSource, function: Function) -> Iterator[_Wait]:
    """Yield the waits of a function: loops until a future is done, and calls that block until then."""
    clients = _clients(source)
    for statement in (n for n in own_nodes(function) if isinstance(n, ast.stmt)):
        if isinstance(statement, ast.While) and (future := _looped_for(statement)):
            yield _Wait(statement, statement, future)
        for call in _calls_in(statement):
            name = source.resolve(call.func) or ast.unparse(call.func)
            if name in _SPINS:
                future = argument(call, 1, "future") if name == _SPINS[0] else None
                yield _Wait(statement, call, future or ast.Constant(None))
            elif name.rpartition(".")[2] in ("call", "send_goal") and name.rpartition(".")[0] in clients:
                yield _Wait(statement, call, None)
            elif future := _future_that_sets(source, function, call):
                yield _Wait(statement, call, future)


def _future_that_sets(source: PythonSource, function: Function, call: ast.Call) -> ast.expr | None:
    """Return the future whose done callback sets the event that a call waits for without a limit."""
    if not isinstance(call.func, ast.Attribute) or call.func.attr != "wait" or call.args or call.keywords:
        return None
    event = ast.unparse(call.func.value)
    for node in own_nodes(function):
        match node:
            case ast.Call(func=ast.Attribute(value=future, attr="add_done_callback"), args=[given]):
                called = _plain(source, given) or given
                if any(
                    ast.unparse(n) == f"{event}.set" for n in ast.walk(called) if isinstance(n, ast.Attribute)
                ):
                    return future
    return None


def _looped_for(loop: ast.While) -> ast.expr | None:
    """Return the future that a loop waits for, as in `while not future.done():`; None if it awaits."""
    asked = (n for n in ast.walk(loop.test) if isinstance(n, ast.Attribute) and n.attr == "done")
    is_until = isinstance(loop.test, (ast.UnaryOp, ast.BoolOp))
    done = next(asked, None) if is_until else None
    is_awaited = any(isinstance(n, ast.Await) for n in ast.walk(loop))
    return None if done is None or is_awaited else done.value


def _calls_in(statement: ast.stmt) -> list[ast.Call]:
    """Return the calls of a statement itself, such as in the condition of an if, but not in nested blocks."""
    if not isinstance(statement, ast.If) and hasattr(statement, "body"):
        return []
    whole = statement.test if isinstance(statement, ast.If) else statement
    return calls_in(ast.walk(whole))


def _clients(source: PythonSource) -> dict[str, ast.Call]:
    """Return the calls that create a file's clients, by the clients' names, without those of other nodes kept by self."""
    kinds = ("create_client", "ActionClient")
    made = [(name, call) for name, call in source.made if last_name(call.func) in kinds]
    return {name: call for name, call in made if not is_self_attribute(getattr(call.func, "value", None))}


def _told(callback: _Callback, waits: Sequence[_Wait], sources: NodeSources, *, has_threads: bool) -> Finding:
    source, function, first = callback.source, callback.function, waits[0]
    text = ast.unparse(first.node.test if isinstance(first.node, ast.While) else first.node)
    cause = f"{function.name}() is called by the executor, and `{text}` in it waits for an answer that the executor cannot receive until {function.name}() has returned."
    if has_threads:
        cause = (
            f"{cause[:-1]}: both are in the same callback group, of which only one callback runs at a time."
        )
        return Finding("callback-waits", cause, source.at(first.node), f"write {_grouped(callback, waits)}")
    held = (block for node in (function, *own_nodes(function)) for block in blocks(node))
    block = next((statements for statements in held if first.statement in statements), function.body)
    is_whole = block is function.body and not any(isinstance(wait.future, ast.Constant) for wait in waits)
    if all(isinstance(wait.future, ast.Constant) for wait in waits):
        fix = _unspun(callback, first)
    elif callback.owes and callback.may_be_async:
        fix = _awaited(callback, waits)
    elif is_whole and not callback.owes:
        fix = _later(source, function, first)
    else:
        fix = _in_threads(callback, waits, sources)
    return Finding("callback-waits", cause, source.at(first.node), fix)


def _unspun(callback: _Callback, wait: _Wait) -> str:
    """Say what to do instead of spinning in a callback, such as in a loop until another callback has been called."""
    function = callback.function
    for loop in own_nodes(function):
        if isinstance(loop, ast.While) and wait.statement in own_nodes(loop):
            for name, setting in set_elsewhere(callback.owner, [function], loop):
                return where_set(name, setting[0])
    why = f"rclpy calls the callbacks it waits for once {function.name}() has returned"
    return f"{removal(callback.source, wait.node)}: {why}"


def set_elsewhere(
    owner: NodeClass | None, functions: Sequence[Function], loop: ast.While
) -> Iterator[tuple[str, list[Function]]]:
    """Yield the attributes that a loop waits for, each with the methods that set it, except those that run while the loop does."""
    asked = {n.attr for n in ast.walk(loop.test) if is_self_attribute(n)}
    for name in sorted(asked - own_changes(loop)):
        methods = owner.methods.values() if owner else ()
        free = (method for method in methods if method.name != "__init__" and method not in functions)
        if setting := [method for method in free if name in own_changes(method)]:
            yield name, setting


def where_set(name: str, method: Function) -> str:
    """Say what to do instead of waiting for an attribute that another callback sets."""
    return f"do the work that needs self.{name} in {method.name}(), once it has been set"


def _later(source: PythonSource, function: Function, first: _Wait) -> str:
    """Say how the lines after the wait become a function that is called when the answer arrives."""
    rows = _rows(source, function, function.body[function.body.index(first.statement) :])
    last = function.body[-1].end_lineno or function.body[-1].lineno
    return f"write these lines instead of {lines_in_words(first.statement.lineno, last)}:\n{textwrap.indent(chr(10).join(rows), '        ')}"


def _rows(source: PythonSource, function: Function, rest: Sequence[ast.stmt]) -> list[str]:
    """Return the lines of statements, with everything after the first wait moved into a done callback."""
    waits = {wait.statement: wait for wait in _waits(source, function)}
    found = [n for n, statement in enumerate(rest) if statement in waits]
    if not found:
        return [row for statement in rest for row in ast.unparse(statement).splitlines()]
    before, first, after = rest[: found[0]], waits[rest[found[0]]], rest[found[0] + 1 :]
    rows = [row for statement in before for row in ast.unparse(statement).splitlines()]
    name = ast.unparse(first.future) if isinstance(first.future, ast.Name) else "future"
    called = f"when_{name}_is_done"
    inner = [*first.with_answer(f"{name}.result()").splitlines(), *_rows(source, function, after)] or ["pass"]
    if ast.unparse(first.asked) != name:
        rows.append(f"{name} = {ast.unparse(first.asked)}")
    return [
        *rows,
        f"def {called}({name}):",
        *(f"    {row}" for row in inner),
        f"{name}.add_done_callback({called})",
    ]


def _awaited(callback: _Callback, waits: Sequence[_Wait]) -> str:
    """Say how to await the answer, in an async callback and with a callback group for the client."""
    lines = callback.source.text.splitlines()
    head = lines[callback.function.lineno - 1].strip()
    edits = [] if head.startswith("async ") else [f"`async {head}` on line {callback.function.lineno}"]
    for wait in waits:
        awaited = f"await {ast.unparse(wait.asked)}"
        written = wait.with_answer(awaited) or awaited
        last = wait.statement.end_lineno or wait.statement.lineno
        edits.append(f"`{written}` on {lines_in_words(wait.statement.lineno, last)}")
    return f"write {', '.join(edits)}, and {_grouped(callback, waits)}"


def _in_threads(callback: _Callback, waits: Sequence[_Wait], sources: NodeSources) -> str:
    """Say how to receive the answer in another thread: a multi-threaded executor and a callback group."""
    edits = []
    for wait in waits:
        if wait.future is None or isinstance(wait.future, ast.Constant):
            continue
        last = wait.statement.end_lineno or wait.statement.lineno
        name = ast.unparse(wait.future) if isinstance(wait.future, ast.Name) else "future"
        made = "" if isinstance(wait.future, ast.Name) else f"{name} = {ast.unparse(wait.asked)}`, and `"
        edits.append(
            f"`{made}while not {name}.done(): time.sleep(0.01)` in {lines_in_words(wait.statement.lineno, last)}"
        )
    if edits and "time" not in callback.source.names:
        edits[-1] += ", with `import time` at the top"
    edits += spun_by_threads(sources, callback.source)
    return f"write {', '.join(edits)}, and {_grouped(callback, waits)}"


def spun_by_threads(sources: NodeSources, source: PythonSource) -> list[str]:
    """Return what to write for the first rclpy.spin(), of a file if it has one, so that several threads spin; empty without any."""
    homes = sorted(sources.sources.values(), key=lambda home: home is not source)
    calls = ((home, n) for home in homes for n in home.calls if n.args)
    home, spin = next(
        (pair for pair in calls if pair[0].resolve(pair[1].func) == "rclpy.spin"), (source, None)
    )
    if spin is None:
        return []
    node, where = ast.unparse(spin.args[0]), "" if home is source else f" of {home.shown}"
    added = f"`executor = MultiThreadedExecutor()`, `executor.add_node({node})` and `executor.spin()`"
    return [f"{added} on line {spin.lineno}{where}, with `from rclpy.executors import MultiThreadedExecutor`"]


def _grouped(callback: _Callback, waits: Sequence[_Wait]) -> str:
    """Say how to give the clients a callback group of their own, without the node's other callbacks."""
    name_of, made = callback.source.name_of, (_made_by(callback, wait) for wait in waits)
    calls = dict.fromkeys(filter(None, made))
    rows = [f"`{name_of(call)} = {in_own_group(call)}` on line {call.lineno}" for call in calls]
    written = " and ".join(rows) or "a callback group of its own for the client"
    return f"{written}, {GROUP_IMPORTED}"


def _made_by(callback: _Callback, wait: _Wait) -> ast.Call | None:
    """Return the call that makes the client whose answer is waited for; None if that is not seen."""
    given = assigned_to(own_nodes(callback.function), ast.unparse(wait.asked))
    client = wait.client or _client_of(given[-1] if given else None)
    return _clients(callback.source).get(ast.unparse(client)) if client else None


def _client_of(call: ast.AST | None) -> ast.expr | None:
    return call.func.value if isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute) else None
