"""Finds what undoes itself: a state that ends in each call as it began, and a list that loses what it just got."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.finding import Finding, in_a_row, these_lines
from ros2lab.diagnose.sources.node_source import LOG_METHODS
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, walk
from ros2lab.trial.record import ListSeen, Record, Spot, Steps, node_at, spot

LEAST = 2  # calls
LEAST_HELD = 3  # times that a list holds the same object
_LEAVES = (
    ast.Return,
    ast.Raise,
    ast.Break,
    ast.Continue,
    ast.Await,
    ast.Yield,
    ast.YieldFrom,
    ast.Try,
    ast.With,
)
_QUIET = LOG_METHODS | {"get_logger", "print", "publish", "format"}
_SORTS = frozenset(("sort", "reverse", "heapify", "heappush", "heappop", "insort", "remove", "rotate"))
_TAKES = frozenset(("pop", "popleft"))


def undone_faults(record: Record) -> Iterator[Finding]:
    """Yield states and lists on which the calls of a callback have no effect, and lists of one object.

    Code resets a state on purpose after something that may take place or fail meanwhile, whatever the value is. Here
    nothing but that value leads from one setting to the next.
    """
    for (root, name), paths in record.paths.items():
        source, function = root[0], _function(root)
        if function is not None and not _is_set_from_outside(record, name.partition("[")[0]):
            steps, calls = max(paths, key=lambda pair: pair[1])
            if calls >= LEAST:
                yield from _state(source, function, name, steps, calls)
    for place, seen in record.lists.items():
        node, function = node_at(place, ast.Call), _function(seen.root)
        if node is None:  # the statement has the place of its call
            continue
        if function is not None and seen.same >= LEAST:
            yield from _taken_back(record, place[0], function, node, seen)
        if seen.held >= LEAST_HELD and seen.contents > 1:
            yield _one_object(place[0], node, seen)


def _function(root: Spot) -> Function | None:
    source, line = root[:2]
    return next((node for node in source.nodes if isinstance(node, Function) and node.lineno == line), None)


def _is_set_from_outside(record: Record, name: str) -> bool:
    """Return whether code sets an attribute of something else than its own object, which is not noted."""
    nodes = (node for source in record.sources for node in source.nodes if isinstance(node, ast.Attribute))
    others = (n for n in nodes if n.attr == name and isinstance(n.ctx, ast.Store))
    return any(getattr(node.value, "id", "") != "self" for node in others)


def _state(source: PythonSource, function: Function, name: str, path: Steps, calls: int) -> Iterator[Finding]:
    before, steps = path
    inside = [node for node in walk(function) if isinstance(node, ast.stmt) and node is not function]
    lines = [line for line, *_ in steps]
    at = [*filter(None, (_innermost(inside, line) for line in lines))]
    stores = [_store(place) for _, place, _ in steps]
    if len(at) < len(steps) or lines != sorted({*lines}) or not _is_bare(function, steps):
        return
    set_in = [*ast.walk(stores[0])] if stores[0] else []
    names = {ast.unparse(node) for node in set_in if isinstance(node, ast.expr)}
    text = f"self.{name}" if f"self.{name}" in names else name
    guards = [
        _guard(source, one, last, text) or _guard(store[1][0], _store(store[1]), last and source.tree, text)
        for last, one, store in zip([None, *at], at, steps, strict=False)
    ]
    way = [f"{value} (line {line})" for line, _, value in steps]
    cause = f"In {calls} calls of {function.name}(), {text} went from {before} to {in_a_row(way)}, so in the end nothing has changed"
    tests = [guard for guard in guards if guard]
    if len(tests) == len(steps) > 1:
        cause = f"{cause}: each `if` sees what the one before it has just set."
        yield Finding("no-effect", cause, steps[1][1][0].at(tests[1]), _with_elif(source, tests, text))
    elif (
        len(steps) == 2
        and all(map(_is_toggle, stores))
        and _are_side_by_side(source, function, at, steps[1][1])
    ):
        cause = f"{cause}: it is reversed twice."
        fix = f"reverse {text} once: leave out line {lines[0]} or line {lines[1]}"
        yield Finding("no-effect", cause, source.at(lines[1]), fix)


def _innermost(statements: Sequence[ast.stmt], line: int) -> ast.stmt | None:
    around = [node for node in statements if node.lineno <= line <= (node.end_lineno or 0)]
    return max(around, key=lambda node: (node.lineno, node.col_offset), default=None)


def _is_bare(function: Function, steps: Sequence[tuple[int, Spot, str]]) -> bool:
    """Return whether nothing takes place from the first setting to the last but the settings, logs and messages.

    What is published says something only if there are two values, of which the later one contradicts.
    """
    lines = [line for line, *_ in steps]
    inside = [n for n in walk(function) if hasattr(n, "lineno") and lines[0] <= n.lineno <= lines[-1]]
    if any(isinstance(node, _LEAVES) for node in inside):
        return False
    calls = {
        last_name(node.func) for node in inside if isinstance(node, ast.Call) and node.lineno not in lines
    }
    for source, line, *_ in (place for _, place, _ in steps):
        setting = source.function_at(line)
        if setting is not None and setting is not function:
            calls |= {last_name(node.func) for node in walk(setting) if isinstance(node, ast.Call)}
    others = {name for name in calls - _QUIET if not name[:1].isupper()}
    return not others and (len(steps) == 2 or "publish" not in calls)


def _guard(source: PythonSource, one: ast.stmt | None, last: ast.AST | None, text: str) -> ast.If | None:
    """Return the `if` around a statement that tests a state: one after `last`, which tests nothing else; any without `last`."""
    found = source.above(one) if one else None
    if not isinstance(found, ast.If) or (last and found.lineno <= getattr(last, "lineno", 0)):
        return None
    if last and getattr(source.above(found), "orelse", None) == [
        found
    ]:  # an `elif`, of a row that began before
        return None
    inside = [*ast.walk(found.test)]
    asked = {
        id(part) for n in inside if isinstance(n, ast.expr) and ast.unparse(n) == text for part in ast.walk(n)
    }
    others = (last_name(n) for n in inside if isinstance(n, (ast.Name, ast.Attribute)) and id(n) not in asked)
    return found if asked and (last is None or all(name[:1].isupper() for name in others)) else None


def _with_elif(source: PythonSource, tests: Sequence[ast.If], text: str) -> str:
    """Say how to let only one of some tests hold in a call."""
    block = getattr(source.above(tests[0]), "body", [])
    places = [block.index(one) for one in tests if one in block]
    is_row = len(places) == len(tests) and places == [*range(places[0], places[0] + len(tests))]
    if is_row and not any(one.orelse for one in tests[:-1]):
        return f"write `elif` instead of `if` on {these_lines([one.lineno for one in tests[1:]])}"
    return f"let only one of these tests hold in a call: ask for the value that {text} had when it began"


def _are_side_by_side(source: PythonSource, function: Function, at: Sequence[ast.stmt], later: Spot) -> bool:
    """Return whether two statements are in one block, and nothing but logs takes place between what they set.

    Args:
        source: the file.
        function: the callback.
        at: its two statements.
        later: what the second one sets, itself or in a function that it calls.
    """
    first, last = at
    setting = later[0].function_at(later[1])
    inside = [n for n in walk(function) if hasattr(n, "lineno") and first.lineno < n.lineno < last.lineno]
    if setting is not None and setting is not function:
        inside += [n for n in walk(setting) if hasattr(n, "lineno") and n.lineno < later[1]]
    calls = {last_name(node.func) for node in inside if isinstance(node, ast.Call)}
    return source.above(first) is source.above(last) and calls <= _QUIET - {"publish"}


def _store(place: Spot) -> ast.stmt | None:
    """Return the statement at a place."""
    source, *numbers = place
    statements = (node for node in source.nodes if isinstance(node, ast.stmt))
    return next((node for node in statements if [*spot(source, node)[1:]] == numbers), None)


def _is_toggle(store: ast.stmt | None) -> bool:
    match store:
        case ast.Assign(targets=[target], value=ast.UnaryOp(op=ast.Not(), operand=value)):
            return ast.unparse(target) == ast.unparse(value)
    return False


def _taken_back(
    record: Record, source: PythonSource, function: Function, added: ast.expr, seen: ListSeen
) -> Iterator[Finding]:
    """Yield a list whose size is limited by taking away the newest item."""
    holder = ast.unparse(added.func.value)  # type: ignore[attr-defined]
    inside = [n for n in walk(function) if isinstance(n, ast.stmt) and record.count(source, n)]
    first = added.lineno if any(node.lineno == added.lineno for node in inside) else 0
    later = [node for node in inside if node.lineno > first]
    names = {
        last_name(n.func) for n in walk(function) if isinstance(n, ast.Call) and holder in ast.unparse(n)
    }
    taking = [(node, fix) for node in later if (fix := _other_end(node, holder, added))]
    if names & _SORTS or len(taking) != 1 or _is_taken_from(source, function, holder):
        return
    ((node, fix),) = taking
    if not _is_limit(source, function, node, holder):
        return
    cause = f"Line {node.lineno} takes away from {holder} what line {added.lineno} has just added: in {seen.same} calls of {function.name}(), it kept the same {seen.length} items, and got none of the new ones."
    yield Finding("no-effect", cause, source.at(node), fix)


def _is_taken_from(source: PythonSource, function: Function, holder: str) -> bool:
    """Return whether another function takes items from a list: then the newest may be turned away on purpose."""
    own = {*walk(function)}
    calls = (node for node in source.calls if isinstance(node.func, ast.Attribute) and node not in own)
    return any(call.func.attr in _TAKES and ast.unparse(call.func.value) == holder for call in calls)  # type: ignore[attr-defined]


def _other_end(node: ast.stmt, holder: str, added: ast.expr) -> str:
    """Return how to take away the oldest item where a statement takes the newest of a list; empty if it does something else."""
    is_at_end = added.func.attr == "append"  # type: ignore[attr-defined]
    for inner in walk(node) if not hasattr(node, "body") else ():
        match inner:
            case ast.Call(func=ast.Attribute(value=value, attr=attr), args=args) if (
                attr in _TAKES and ast.unparse(value) == holder
            ):
                first = attr == "popleft" or [*map(ast.unparse, args)] == ["0"]
                if first is is_at_end:
                    return ""
                right = (
                    f"`{holder}.pop(0)` (of a deque: `{holder}.popleft()`)"
                    if is_at_end
                    else f"`{holder}.pop()`"
                )
                return f"write {right} instead of `{ast.unparse(inner)}`"
    match node:
        case ast.Delete(targets=[ast.Subscript(value=value, slice=part) as target]) if (
            ast.unparse(value) == holder
        ):
            right = {"-1": "0", "0": "-1"}.get(ast.unparse(part), "")
            return f"write `del {holder}[{right}]` instead of `del {ast.unparse(target)}`" if right else ""
        case ast.Assign(
            targets=[target], value=ast.Subscript(value=value, slice=ast.Slice(lower=None, upper=upper))
        ) if is_at_end and upper is not None and ast.unparse(target) == ast.unparse(value) == holder:
            return f"write `{holder} = {holder}[-{ast.unparse(upper)}:]`, which keeps the newest"
    return ""


def _is_limit(source: PythonSource, function: Function, node: ast.stmt, holder: str) -> bool:
    """Return whether a statement takes items away only where there are too many."""
    found: ast.AST | None = node
    while found is not None and found is not function:
        if isinstance(found, (ast.If, ast.While)) and holder in ast.unparse(found.test):
            return True
        found = source.above(found)
    return isinstance(node, ast.Assign)


def _one_object(source: PythonSource, added: ast.expr, seen: ListSeen) -> Finding:
    holder, given = ast.unparse(added.func.value), ast.unparse(added.args[-1])  # type: ignore[attr-defined]
    cause = f"{holder} holds one and the same {seen.kind} {seen.held} times, since `{given}` is the same object each time: it was filled anew in between, so all items show the last contents."
    fix = f"make a new {seen.kind} each time before this line, or write copy.deepcopy({given}) instead of {given}, and `import copy` at the top of the file"
    return Finding("one-object", cause, source.at(added), fix)
