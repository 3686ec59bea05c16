"""Expressions that Python accepts but that do something other than intended."""

from __future__ import annotations

import ast
import itertools
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence

from ros2lab.diagnose.code.idle_statements import idle_statements
from ros2lab.diagnose.code.main_guards import main_guard_faults
from ros2lab.diagnose.code.misplaced_signs import sign_fault
from ros2lab.diagnose.code.placeholders import placeholder_faults, repeated
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.joined_texts import strings, text_of
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.one_run import blocks, is_steady, may_leave
from ros2lab.diagnose.sources.python_source import (
    PythonSource,
    children,
    given_to,
    last_name,
    names_read,
    own_nodes,
)
from ros2lab.diagnose.sources.spelling import nearest
from ros2lab.diagnose.sources.static_value import expression

_SHARES = frozenset(("get_package_share_directory", "FindPackageShare", "get_package_share_path"))
_CHANGES_CASE: dict[str, Callable[[str], str]] = {
    "lower": str.lower,
    "upper": str.upper,
    "strip": str.strip,
    "title": str.title,
}
# Literals, which nobody calls or subscripts on purpose.
_LONGEST = 60  # characters of a value that is shown whole
_LITERALS = (ast.Tuple, ast.List, ast.Dict, ast.Constant, ast.JoinedStr, ast.Set)
_SEVERAL = (ast.List, ast.Tuple, ast.Set, ast.Call)
_NEXT: dict[type[ast.AST], str] = {ast.Call: "a call of", ast.Subscript: "a part of"}


def expression_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield statements without effect, comparisons never true, and strings with unfilled placeholders."""
    texts = Counter(map(text_of, (node for source in sources.sources.values() for node in source.nodes)))
    for source in sources.sources.values():
        yield from comma_faults(source)
        yield from _joined(source, texts)
        yield from path_faults(source)
        yield from placeholder_faults(source)
        yield from main_guard_faults(source)
        yield from idle_statements(source)
        for node in source.nodes:
            if isinstance(node, ast.Compare):
                yield from _never_equal(source, node)
            elif isinstance(node, (ast.If, ast.While, ast.IfExp)) and isinstance(node.test, ast.BoolOp):
                yield from _texts(source, node.test)
                yield from _always(source, node.test)
            elif isinstance(node, ast.Assign):
                yield from sign_fault(source, node)
            elif isinstance(node, ast.Call):
                yield from _named_in_lambda(source, node)
            elif isinstance(node, ast.BinOp):
                yield from repeated(source, node)
            elif isinstance(node, ast.ExceptHandler):
                yield from _caught_objects(source, node)


def _caught_objects(source: PythonSource, handler: ast.ExceptHandler) -> Iterator[Finding]:
    """Yield what an `except` calls to make an object of an exception, although it takes the class."""
    for given in handler.type.elts if isinstance(handler.type, ast.Tuple) else [handler.type]:
        if isinstance(given, ast.Call) and last_name(given.func)[:1].isupper() and not given.args:
            text, name = ast.unparse(given), ast.unparse(given.func)
            cause = f"`{text}` is an object, and `except` takes the class: whatever is raised here ends in a TypeError instead."
            yield Finding("argument-type", cause, source.at(given), f"write {name} instead of {text}")


def _named_in_lambda(source: PythonSource, call: ast.Call) -> Iterator[Finding]:
    """Yield lambdas passed to ROS that name a function instead of calling it."""
    is_kept = getattr(call.func, "attr", "").startswith(("create_", "add_done"))
    for given in given_to(call) if is_kept else ():
        if isinstance(given, ast.Lambda) and getattr(given.body, "is_function", False):
            text, whole = ast.unparse(given.body), ast.unparse(given)
            cause = f"`{whole}` returns {text} without ever calling it."
            yield Finding("no-effect", cause, source.at(given), f"write {text} instead of `{whole}`")


def comma_faults(source: PythonSource, missing: str = "comma-missing") -> Iterator[Finding]:
    """Yield trailing commas that turn a value into a tuple, and missing commas, which Python warns about."""
    lines = {line for line, said in source.warned if "missed a comma" in said}
    for node in source.nodes:
        before = node.func if isinstance(node, ast.Call) else getattr(node, "value", None)
        if (
            isinstance(node, (ast.Call, ast.Subscript))
            and node.lineno in lines
            and isinstance(before, _LITERALS)
        ):
            text = ast.unparse(before)
            if getattr(node, "keywords", ()):  # after a comma, nothing could read them
                yield from _not_callable(source, before)
                continue
            cause = f"A comma is missing after `{text[:60]}`, so Python takes what follows as {_NEXT[type(node)]} it."
            line = source.text.splitlines()[(before.end_lineno or 1) - 1]
            begun, rest = (
                line.encode()[: before.end_col_offset].decode(),
                line.encode()[before.end_col_offset :],
            )
            fix = f"write a comma after `{text[:60]}`" if rest.strip() else f"write `{begun.strip()},`"
            yield Finding(missing, cause, source.at(before.end_lineno), fix)
    yield from _tuple_faults(source)


def _joined(source: PythonSource, texts: Mapping[str, int]) -> Iterator[Finding]:
    """Yield texts side by side among several values, which Python joins, although only each alone is used elsewhere."""
    groups = [
        (*getattr(n, "elts", ()), *getattr(n, "args", ())) for n in source.nodes if isinstance(n, _SEVERAL)
    ]
    lines = {text_of(item): item.lineno for group in groups for item in group if text_of(item)}
    row: list[tuple[int, str]] = []
    for line, written, is_next in strings(source.text) if lines else ():
        row.append((line, written))
        if is_next:
            continue
        first, codes = row[0][0], [code for _, code in row]
        parts, row = [text_of(expression(code)) for code in codes], []
        whole = "".join(parts)
        is_one_item = texts[whole] == 1 and lines.get(whole) in (first, line)
        if len(parts) > 1 and is_one_item and all(texts[part] for part in parts):
            ways = [", ".join(codes)] if first == line else [f"{code}," for code in codes[:-1]]
            cause = f"A comma is missing after {codes[0]}, so Python joins it with what follows: {whole!r}."
            fix = f"write {' and '.join(f'`{way}`' for way in ways)}"
            yield Finding("comma-missing", cause, source.at(first), fix)


def _not_callable(source: PythonSource, called: ast.expr) -> Iterator[Finding]:
    """Yield a value that is called, if it is written like something that the file imports."""
    value = called.value if isinstance(called, ast.Constant) else None
    names = {imported.local for imported in source.imports if imported.local[:1].isupper()}
    meant = value if value in names else nearest(str(value), names, 0.6)
    if meant:
        what = ast.unparse(called)
        cause = f"`{what}` is called here, but it is neither a class nor a function."
        yield Finding("not-callable", cause, source.at(called), f"write {meant} instead of {what}")


def _tuple_faults(source: PythonSource) -> Iterator[Finding]:
    read = names_read(source.nodes)
    for node in source.nodes:
        made = node.value if isinstance(node, (ast.Assign, ast.Return)) else None
        match node:
            case ast.Assign(targets=[ast.Name(id=name)]) if name not in read and source.function_at(
                node.lineno
            ):
                continue  # nothing is made of it, with or without the comma
        if made is not None and is_by_comma(source, made) and not _is_taken_apart(source, node):
            yield tuple_by_comma(source, made)


def tuple_by_comma(source: PythonSource, made: ast.expr) -> Finding:
    """Say that the comma after a value turns it into a tuple."""
    line = made.end_lineno or made.lineno
    text = source.text.splitlines()[line - 1].partition("#")[0].strip().removesuffix(",")
    targets = [
        ast.unparse(n.targets[0]) for n in source.nodes if isinstance(n, ast.Assign) and n.value is made
    ]
    shown = ast.unparse(made.elts[0]) if isinstance(made, ast.Tuple) else ast.unparse(made)
    what = f"`{shown}`" if len(shown) <= _LONGEST else targets[0] if targets else "the returned value"
    cause = f"The comma at the end turns {what} into a tuple."
    fix = f"write `{text}`, with no comma at its end"
    fix = fix if made.lineno == line else "remove the comma at the end of this line"
    return Finding("comma-tuple", cause, source.at(line), fix)


def is_by_comma(source: PythonSource, value: ast.expr) -> bool:
    """Return whether a value is a one-element tuple only because of a trailing comma, without parentheses."""
    is_alone = isinstance(value, ast.Tuple) and len(value.elts) == 1
    return is_alone and (ast.get_source_segment(source.text, value) or "").endswith(",")


def _is_taken_apart(source: PythonSource, node: ast.AST) -> bool:
    """Return whether a one-element tuple may be meant, because its variable or its callers unpack it."""
    if isinstance(node, ast.Assign):
        names = set(map(ast.unparse, node.targets))
    else:
        around = [n for n in source.nodes if isinstance(n, ast.FunctionDef) and node in own_nodes(n)]
        calls = source.calls
        last = {function.name for function in around}
        names = {ast.unparse(n) for n in calls if last_name(n.func) in last}
        if not names and not any(isinstance(n, ast.Call) for n in children(node)):
            return True  # a library may call it and expect a tuple
    passed = (node.args for node in source.calls if _is_of_library(source, node))
    taken = (*map(_apart, source.nodes), *passed)
    return any(not names.isdisjoint(map(ast.unparse, values)) for values in taken)


def _is_of_library(source: PythonSource, call: ast.Call) -> bool:
    """Return whether a call is one of a library other than Python's and ROS's, which may expect a tuple."""
    top = (source.resolve(call.func) or "").partition(".")[0]
    is_known = top in interfaces.PACKAGES | sys.stdlib_module_names or top == source.name.partition(".")[0]
    return (
        bool(top)
        and not is_known
        and top in {imported.target.partition(".")[0] for imported in source.imports}
    )


def _apart(node: ast.AST) -> Sequence[ast.expr]:
    """Return the expressions that a node uses as a list or a tuple."""
    match node:
        case (
            ast.Subscript(value=value)
            | ast.Starred(value=value)
            | ast.For(iter=value)
            | ast.comprehension(iter=value)
            | ast.Assign(targets=[ast.Tuple() | ast.List()], value=value)
            | ast.Compare(ops=[ast.In() | ast.NotIn()], comparators=[value])
            | ast.keyword(value=value)
        ):
            return [value]
        case ast.Call(func=ast.Name(id="len" | "list" | "tuple" | "sorted" | "set")):
            return node.args
    return ()


def path_faults(source: PythonSource) -> Iterator[Finding]:
    """Yield parts of a joined path that begin with a slash: os.path.join drops everything before them."""
    for node in source.nodes:
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith(
            ("path.join", "PathJoinSubstitution")
        ):
            parts = (
                node.args[0].elts if len(node.args) == 1 and isinstance(node.args[0], ast.List) else node.args
            )
            yield from _shares_joined(source, node, parts)
            for part in parts[1:]:
                if (
                    isinstance(part, ast.Constant)
                    and isinstance(part.value, str)
                    and part.value.startswith("/")
                ):
                    cause = f"{part.value!r} begins with a slash, so os.path.join drops everything before it."
                    fix = f"write {part.value.lstrip('/')!r}"
                    yield Finding("path-absolute", cause, source.at(part), fix)


def _shares_joined(source: PythonSource, call: ast.Call, parts: Sequence[ast.expr]) -> Iterator[Finding]:
    """Yield a path that is joined from those of several packages, of which only the last is left."""
    made = (source.written(part) for part in parts)
    shares = [n for n, part in enumerate(made) if last_name(getattr(part, "func", None)) in _SHARES]
    if len(shares) < 2:
        return
    texts, starts = [ast.unparse(part) for part in parts], [0, *shares[1:], len(parts)]
    paths = [", ".join(texts[first:last]) for first, last in itertools.pairwise(starts)]
    ends = ("[", "]") if call.args and isinstance(call.args[0], ast.List) else ("", "")
    whole = ", ".join(f"{ast.unparse(call.func)}({ends[0]}{path}{ends[1]})" for path in paths)
    cause = f"The path of a package's share folder is absolute, so of these {len(shares)} only the last is left, with what is after it."
    yield Finding(
        "path-absolute", cause, source.at(parts[shares[-1]]), f"write {len(shares)} paths: `{whole}`"
    )


def _never_equal(source: PythonSource, node: ast.Compare) -> Iterator[Finding]:
    for left, operator, right in zip(
        [node.left, *node.comparators], node.ops, node.comparators, strict=False
    ):
        for side, other in ((left, right), (right, left)):
            texts = _texts_of(other)
            if (
                isinstance(operator, (ast.Is, ast.IsNot))
                and other is right
                and isinstance(right, ast.Constant)
                and texts
            ):
                sign = "==" if isinstance(operator, ast.Is) else "!="
                cause = f"`{ast.unparse(node)}` asks whether both are the same object, which is never true of a received string."
                fix = f"write {ast.unparse(side)} {sign} {ast.unparse(other)}"
                yield Finding("literal-comparison", cause, source.at(node), fix)
            elif (
                isinstance(side, ast.Call)
                and isinstance(side.func, ast.Attribute)
                and side.func.attr in _CHANGES_CASE
            ):
                change = _CHANGES_CASE[side.func.attr]
                is_compared = isinstance(operator, ast.Eq) or (
                    # A part of a text is looked for, or a text among others.
                    isinstance(operator, ast.In)
                    and (side.func.attr in ("lower", "upper") if side is right else len(texts) > 1)
                )
                for text in texts if is_compared and not side.args else ():
                    if text != change(text) and change(text) not in texts:
                        cause = f"`{ast.unparse(side)}` never equals {text!r}, because of {side.func.attr}()."
                        fix = f"write {change(text)!r} instead of {text!r}"
                        yield Finding("no-effect", cause, source.at(node), fix)


def _texts_of(value: ast.expr) -> list[str]:
    """Return the text that an expression is, or the texts in a list, a tuple or a set; empty for anything else."""
    items = value.elts if isinstance(value, (ast.List, ast.Tuple, ast.Set)) else [value]
    found = [item.value for item in items if isinstance(item, ast.Constant) and isinstance(item.value, str)]
    return found if len(found) == len(items) else []


def _texts(source: PythonSource, test: ast.BoolOp) -> Iterator[Finding]:
    match test.values:
        case [
            *before,
            ast.Compare(left=left, ops=[ast.Eq()], comparators=[right]),
            ast.Constant(value=str(text)) as constant,
        ] if text:
            only = f"{ast.unparse(left)} in ({ast.unparse(right)}, {ast.unparse(constant)})"
            cause = f"`{ast.unparse(test)}` does not compare {ast.unparse(constant)}: a string by itself is always true."
            fix = (
                f"write {ast.unparse(left)} == {ast.unparse(constant)} instead of {ast.unparse(constant)}"
                if before
                else f"write {only}"
            )
            yield Finding("text-as-condition", cause, source.at(test), fix)


def _always(source: PythonSource, test: ast.BoolOp) -> Iterator[Finding]:
    """Yield `x != 'a' or x != 'b'`, which is always true, and `x == 'a' and x == 'b'`, which never is."""
    wanted, holds, right = (
        (ast.NotEq, "always", "and") if isinstance(test.op, ast.Or) else (ast.Eq, "never", "or")
    )
    pairs = [
        (ast.unparse(comparison.left), comparison.comparators[0])
        for comparison in test.values
        if isinstance(comparison, ast.Compare)
        and len(comparison.ops) == 1
        and isinstance(comparison.ops[0], wanted)
    ]
    values = [value.value for _, value in pairs if isinstance(value, ast.Constant)]
    if (
        len(pairs) == len(test.values) == len(set(values)) == len(values)
        and len({left for left, _ in pairs}) == 1
        and is_steady(test)
    ):
        joint = " or " if isinstance(test.op, ast.Or) else " and "
        text = ast.unparse(test)
        fix = f"write `{text.replace(joint, f' {right} ')}`"
        yield Finding(
            "text-as-condition", f"`{text}` is {holds} true, whatever {pairs[0][0]} is.", source.at(test), fix
        )


def chain_faults(source: PythonSource) -> Iterator[Finding]:
    """Yield consecutive ifs on the same value where the else of the last undoes what the others did."""
    for block in (block for node in source.nodes for block in blocks(node)):
        for chain in _chains(block):
            last, rest = chain[-1], chain[-1].orelse
            while len(rest) == 1 and isinstance(rest[0], ast.If):
                rest = rest[0].orelse
            undone = [
                n
                for n, statement in enumerate(chain[:-1])
                if _stored(statement.body) & _stored(rest)
                and not may_leave(statement.body, ast.Continue)
                and not _stored(statement.body) & _read(last.test, *rest)
            ]
            if not undone:
                continue
            first = chain[undone[0]]
            name = min(_stored(first.body) & _stored(rest))
            cause = f"Even when `{ast.unparse(first.test)}` is true, the if on line {last.lineno} is checked too, and its else sets {name} again."
            *others, end = (str(statement.lineno) for statement in chain[undone[0] + 1 :])
            where = f" on lines {', '.join(others)} and {end}" if others else ""
            yield Finding(
                "replaced", cause, source.at(chain[undone[0] + 1]), f"write elif instead of if{where}"
            )


def _chains(block: list[ast.stmt]) -> Iterator[list[ast.If]]:
    """Yield runs of consecutive ifs that compare the same expression with ==; the last has an else."""
    chain: list[ast.If] = []
    asked = ""
    for statement in block:
        match statement:
            case ast.If(test=ast.Compare(left=left, ops=[ast.Eq()])):
                chain = [*(chain if ast.unparse(left) == asked else []), statement]
                asked = ast.unparse(left)
                if statement.orelse:
                    yield chain
                    chain = []
            case _:
                chain = []


def _read(*nodes: ast.AST) -> set[str]:
    return {
        ast.unparse(inner)
        for node in nodes
        for inner in ast.walk(node)
        if isinstance(inner, (ast.Name, ast.Attribute)) and isinstance(inner.ctx, ast.Load)
    }


def _stored(body: list[ast.stmt]) -> set[str]:
    assigned = (statement for statement in body if isinstance(statement, ast.Assign))
    return {ast.unparse(target) for statement in assigned for target in statement.targets}


def keys_twice(source: PythonSource) -> Iterator[Finding]:
    """Yield dictionary keys that are given more than once, with different values."""
    for node in source.nodes:
        given: dict[object, list[ast.expr]] = {}
        for key, value in zip(node.keys, node.values, strict=True) if isinstance(node, ast.Dict) else ():
            if isinstance(key, ast.Constant):
                given.setdefault(key.value, []).append(value)
        for name, values in given.items():
            if len({*map(ast.dump, values)}) > 1:
                yield _key_again(source, name, values)


def _key_again(source: PythonSource, key: object, values: list[ast.expr]) -> Finding:
    *others, last = (str(value.lineno) for value in values)
    is_pair = len(values) == 2
    often = {2: "twice", 3: "three times"}.get(len(values), f"{len(values)} times")
    lost = (
        f"the one on line {others[0]}"
        if is_pair
        else f"the ones on lines {', '.join(others[:-1])} and {others[-1]}"
    )
    cause = f"The dictionary has the key {key!r} {often}; the value on line {last} replaces {lost}."
    away = "this entry" if is_pair else "the others"
    fix = f"write another key instead of {key!r}, or remove {away}"
    if all(isinstance(value, ast.List) for value in values):
        lists = "both lists hold" if is_pair else "these lists hold"
        fix = f"put everything that {lists} into the one on line {others[0]}, and remove {away}"
    return Finding("replaced", cause, source.at(values[1]), fix)
