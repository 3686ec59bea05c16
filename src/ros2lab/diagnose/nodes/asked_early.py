"""What is asked, in the call that has just begun something, although it can only come after that call."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.endless_loops import threads_of
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.one_run import own_calls
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, own_nodes, walk
from ros2lab.diagnose.sources.uses import own_stores, uses_of

_LATER = frozenset(("call_async", "send_goal_async", "get_result_async", "cancel_goal_async"))
_BEGINS = _LATER | {"publish", "sleep", "create_timer"}
_TESTS = (ast.If, ast.IfExp, ast.Assert)
_LETS_OTHERS_RUN = (ast.Await, ast.Yield, ast.YieldFrom)
_DECIDES, _LEARNS = "add_on_set_parameters_callback", "add_post_set_parameters_callback"


def asked_early(
    sources: NodeSources, source: PythonSource, owner: NodeClass | None, functions: list[Function], what: str
) -> Iterator[Finding]:
    """Yield tests, in a callback or what it calls, of what only another callback of the same thread may change meanwhile."""
    calls = (node for function in functions for node in walk(function) if isinstance(node, ast.Call))
    if isinstance(functions[0], ast.AsyncFunctionDef) or any(map(_lets_others_run, calls)):
        return
    if threads_of(sources, source):
        return
    for function in functions:
        for node in own_nodes(function):
            if not isinstance(node, ast.Assign) or len(node.targets) != 1:
                continue
            name, value = ast.unparse(node.targets[0]), node.value
            if isinstance(value, ast.Call) and getattr(value.func, "attr", "") in _LATER:
                for test in _tests_after(source, node, name):
                    if asks := _asks_done(test, name):
                        yield _of_future(source, functions[0], node, asks, what)
                        break
            elif isinstance(value, ast.Constant) and is_self_attribute(node.targets[0]) and owner:
                yield from _of_flag(sources, source, owner, functions, node)


def _tests_after(source: PythonSource, node: ast.Assign, name: str) -> Iterator[ast.expr]:
    """Yield the tests below a statement, in its block, up to where what it set may change."""
    around = source.above(node)
    blocks = (getattr(around, field, None) for field in ("body", "orelse", "finalbody"))
    block = next((b for b in blocks if isinstance(b, list) and node in b), [])
    for statement in block[block.index(node) + 1 :] if block else ():
        nodes = _placed(statement)
        changing = [inner for inner in nodes if _may_change(inner, name)]
        is_loop = any(isinstance(inner, (ast.For, ast.While)) for inner in nodes)
        tests = (inner for inner in nodes if isinstance(inner, _TESTS))
        first = min((inner.lineno for inner in changing), default=None)
        yield from (t.test for t in tests if first is None or (t.lineno < first and not is_loop))
        if changing:
            return


def _may_change(node: ast.AST, name: str) -> bool:
    """Return whether a node sets something anew, or waits while other callbacks run."""
    is_set = not isinstance(getattr(node, "ctx", ast.Load()), ast.Load) and ast.unparse(node) == name
    return is_set or isinstance(node, _LETS_OTHERS_RUN)


def _lets_others_run(call: ast.Call) -> bool:
    return last_name(call.func).startswith("spin")


def _placed(node: ast.AST) -> list[ast.expr | ast.stmt]:
    return [inner for inner in (node, *own_nodes(node)) if isinstance(inner, (ast.expr, ast.stmt))]


def _asks_done(test: ast.expr, name: str) -> ast.expr | None:
    """Return the part of a test that asks whether a future is done."""
    calls = (inner for inner in walk(test) if isinstance(inner, ast.Call))
    return next((call for call in calls if ast.unparse(call.func) == f"{name}.done"), None)


def _of_future(source: PythonSource, first: Function, node: ast.Assign, asks: ast.expr, what: str) -> Finding:
    name, text = ast.unparse(node.targets[0]), ast.unparse(asks)
    cause = f"`{text}` is never true here: line {node.lineno} has only just asked, and rclpy takes in the answer after {what} has returned."
    short = last_name(node.targets[0])
    fix = f"write `{name}.add_done_callback(self.answered)` below line {node.lineno}, and use `{short}.result()` in a method `def answered(self, {short}):`"
    if name.startswith("self."):
        fix = f"{fix}; or ask `{text}` at the next call of {first.name}(), above line {node.lineno}"
    return Finding("callback-waits", cause, source.at(asks), fix)


def _of_flag(
    sources: NodeSources,
    source: PythonSource,
    owner: NodeClass,
    functions: Sequence[Function],
    node: ast.Assign,
) -> Iterator[Finding]:
    """Yield the test of an attribute that is reset above it, and that only other callbacks set."""
    uses, target = uses_of(sources), node.targets[0]
    name, text = last_name(target), ast.unparse(target)
    others = [
        method for method in owner.methods.values() if method not in functions and method.name != "__init__"
    ]
    setting = [method for method in others if name in own_stores(method)]
    own = [
        n
        for f in functions
        for n in walk(f)
        if is_self_attribute(n) and n.attr == name and isinstance(n.ctx, ast.Store)
    ]
    is_free = not setting or not all(id(method) in uses.callbacks for method in setting)
    if is_free or len(own) > 1 or name in uses.stored_of_others:
        return
    calls = [
        n for f in functions[:1] for n in walk(f) if isinstance(n, ast.Call) and last_name(n.func) in _BEGINS
    ]
    asking = (
        test
        for test in _tests_after(source, node, text)
        if any(ast.unparse(inner) == text for inner in walk(test))
        and any(node.lineno < call.lineno < test.lineno for call in calls)
    )
    for test in itertools.islice(asking, 1):
        value, setter, first = ast.unparse(node.value), setting[0].name, functions[0].name
        cause = f"`{ast.unparse(test)}` always finds {text} as line {node.lineno} has set it, {value}: only {setter}() changes it, which rclpy calls after {first}() has returned."
        later = f", or test it at the next call of {first}(), above line {node.lineno}"
        fix = f"do in {setter}() what needs {text}{later * (first != '__init__')}"
        yield Finding("callback-waits", cause, source.at(test), fix)


def old_parameters(sources: NodeSources) -> Iterator[Finding]:
    """Yield parameters that are read and kept while a callback decides on their new values, which it does not look at."""
    for source in sources.sources.values():
        for owner, _, node in sources.scoped(source) if _DECIDES in source.text else ():
            is_call = isinstance(node, ast.Call) and last_name(node.func) == _DECIDES
            given = node.args[0] if is_call and node.args else None  # type: ignore[attr-defined]
            first = sources.method(owner, given.attr) if owner and is_self_attribute(given) else None
            if first is None or _looks_at_new(first):
                continue
            called = (sources.method(owner, name) for name in own_calls(first))
            for function in (first, *called):
                for read in _kept(function) if function else ():
                    yield _of_old(source, first, ast.unparse(node), read)


def _looks_at_new(function: Function) -> bool:
    """Return whether a callback uses more of the parameters that it is given than their names, but to test them."""
    given = {parameter.arg for parameter in function.args.args if parameter.arg != "self"}
    for node in walk(function):
        if isinstance(node, (ast.For, ast.comprehension)) and given & _names(node.iter):
            given |= _names(node.target)
    inside = [*walk(function)]
    looped = [n.iter for n in inside if isinstance(n, (ast.For, ast.comprehension))]
    named = [n.value for n in inside if isinstance(n, ast.Attribute) and n.attr == "name"]
    tests = [
        n if isinstance(n, ast.Compare) else n.test for n in inside if isinstance(n, (ast.Compare, *_TESTS))
    ]
    plain = {id(n) for n in (*looped, *named, *(n for test in tests for n in walk(test)))}
    names = (n for n in inside if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load))
    return any(name.id in given and id(name) not in plain for name in names)


def _names(node: ast.AST) -> set[str]:
    return {inner.id for inner in walk(node) if isinstance(inner, ast.Name)}


def _kept(function: Function) -> Iterator[ast.Call]:
    """Yield the calls that read a parameter of the node whose value becomes part of an attribute."""
    stores = [node for node in own_nodes(function) if isinstance(node, ast.Assign)]
    for node in stores:
        reads = [n for n in walk(node.value) if isinstance(n, ast.Call) and _reads_own(n)]
        local = [target.id for target in node.targets if isinstance(target, ast.Name)]
        later = [other for other in stores if _names(other.value) & {*local}]
        kept = [target for one in (node, *later) for target in one.targets if is_self_attribute(target)]
        yield from reads if kept else ()


def _reads_own(call: ast.Call) -> bool:
    func = call.func
    return is_self_attribute(func) and func.attr.startswith("get_parameter") and bool(call.args)


def _of_old(source: PythonSource, first: Function, registered: str, read: ast.Call) -> Finding:
    text = ast.unparse(read)
    cause = f"`{text}` still gives the old value here: {first.name}() is called before the new one is stored, so the node is always one change behind."
    results = (node for node in walk(first) if isinstance(node, ast.keyword) and node.arg == "successful")
    may_refuse = any(ast.unparse(node.value) != "True" for node in results)
    fix = f"write `{registered.replace(_DECIDES, _LEARNS)}` instead of `{registered}`; {first.name}() then returns nothing"
    if may_refuse:
        fix = f"take the new value from what {first.name}() is given: `.value` of the parameter of that name"
    return Finding("callback-waits", cause, source.at(read), fix)
