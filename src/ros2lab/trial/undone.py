"""Finds what undoes itself: a state that ends in each call as it began, and a list that loses what it just got."""

from __future__ import annotations

import ast
import itertools
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.finding import Finding, in_a_row, these_lines
from ros2lab.diagnose.sources.node_source import LOG_METHODS
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, walk
from ros2lab.trial.record import ListSeen, Record, Spot, Steps, node_at

LEAST = 2  # calls
LEAST_HELD = 3  # times that a list holds the same object
_Step = tuple[int, Spot, str]
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
            calls = sum(count for _, count in paths)
            steps, _ = max(paths, key=lambda pair: pair[1])
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
    at = [_innermost(inside, line) for line in lines]
    if None in at or lines != sorted({*lines}) or not _is_bare(function, steps):
        return
    text = f"self.{name}" if _is_attribute(steps[0]) else name
    guards = [_guard(source, function, one, last, text) for last, one in itertools.pairwise(at)]
    way = [f"{value} (line {line})" for line, _, value in steps]
    cause = f"In each of {calls} calls of {function.name}(), {text} went from {before} to {in_a_row(way)}, so in the end nothing has changed"
    if guards and all(guards):
        firsts = [guard for guard in guards if guard]
        cause = f"{cause}: each `if` sees what the one above it has just set."
        fix = _with_elif(source, [_outer(source, function, at[0]), *firsts], text, name)
        yield Finding("no-effect", cause, source.at(firsts[0]), fix)
    elif len(steps) == 2 and _are_toggles(source, function, steps, at):
        cause = f"{cause}: it is reversed twice."
        yield Finding(
            "no-effect",
            cause,
            source.at(lines[1]),
            f"reverse {text} once: leave out line {lines[0]} or line {lines[1]}",
        )


def _innermost(statements: Sequence[ast.stmt], line: int) -> ast.stmt | None:
    around = [node for node in statements if node.lineno <= line <= (node.end_lineno or 0)]
    return max(around, key=lambda node: (node.lineno, node.col_offset), default=None)


def _is_attribute(step: _Step) -> bool:
    source, line, column, *_ = step[1]
    statement = next(
        (n for n in source.nodes if isinstance(n, ast.stmt) and (n.lineno, n.col_offset) == (line, column)),
        None,
    )
    targets = getattr(statement, "targets", [getattr(statement, "target", None)])
    return any(isinstance(node, ast.Attribute) for target in targets if target for node in ast.walk(target))


def _is_bare(function: Function, steps: Sequence[_Step]) -> bool:
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
    others = {name for name in calls - _QUIET if not name[:1].isupper()}
    return not others and (len(steps) == 2 or "publish" not in calls)


def _guard(
    source: PythonSource, function: Function, one: ast.stmt | None, last: ast.stmt | None, text: str
) -> ast.If | None:
    """Return the `if` after one statement that tests what that has set, and so leads to another one."""
    found: ast.AST | None = one
    while found is not None and found is not function:
        around = source.above(found)
        if isinstance(found, ast.If) and found.lineno > getattr(last, "lineno", 0):
            is_elif = isinstance(around, ast.If) and around.orelse == [found]
            if not is_elif and any(ast.unparse(n) == text for n in ast.walk(found.test)):
                return found
        found = around
    return None


def _outer(source: PythonSource, function: Function, statement: ast.stmt | None) -> ast.AST | None:
    """Return the outermost `if` around a statement."""
    found, outer = source.above(statement) if statement else None, None
    while found is not None and found is not function:
        outer = found if isinstance(found, ast.If) else outer
        found = source.above(found)
    return outer


def _with_elif(source: PythonSource, tests: Sequence[ast.AST | None], text: str, name: str) -> str:
    """Say how to let only one of some tests hold in a call."""
    first, *others = tests
    block = getattr(source.above(first), "body", []) if first else []
    places = [block.index(one) for one in tests if one in block]
    is_row = len(places) == len(tests) and places == [*range(places[0], places[0] + len(tests))]
    if is_row and not any(getattr(one, "orelse", ()) for one in tests[:-1]):
        return f"write `elif` instead of `if` on {these_lines([getattr(one, 'lineno', 0) for one in others])}"
    short = name.partition("[")[0]
    return (
        f"write `before = {text}` at the beginning, and test `before` instead of {text}"
        if short != "before"
        else "test the value that it had at the beginning"
    )


def _are_toggles(
    source: PythonSource, function: Function, steps: Sequence[_Step], at: Sequence[ast.stmt | None]
) -> bool:
    """Return whether two statements of one block each reverse a value, with nothing but logs between them."""
    stores = [_store(place) for _, place, _ in steps]
    if any(source.above(one) is not source.above(at[0]) for one in at if at[0] and one) or not all(
        map(_is_toggle, stores)
    ):
        return False
    first, second = steps[0][0], steps[1][0]
    called = {
        last_name(n.func) for n in walk(function) if isinstance(n, ast.Call) and first < n.lineno < second
    }
    return called <= _QUIET - {"publish"}


def _store(place: Spot) -> ast.stmt | None:
    source, *numbers = place
    found = (
        n
        for n in source.nodes
        if isinstance(n, ast.stmt) and [n.lineno, n.col_offset, n.end_lineno, n.end_col_offset] == numbers
    )
    return next(found, None)


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
    later = [
        n
        for n in walk(function)
        if isinstance(n, ast.stmt) and n.lineno > added.lineno and record.count(source, n)
    ]
    names = {
        last_name(n.func) for n in walk(function) if isinstance(n, ast.Call) and holder in ast.unparse(n)
    }
    taking = [(node, fix) for node in later if (fix := _other_end(node, holder, added))]
    if names & _SORTS or len(taking) != 1:
        return
    ((node, fix),) = taking
    if not _is_limit(source, function, node, holder):
        return
    cause = f"Line {node.lineno} takes away from {holder} what line {added.lineno} has just added: in {seen.same} calls of {function.name}(), it kept the same {seen.length} items, and got none of the new ones."
    yield Finding("no-effect", cause, source.at(node), fix)


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
