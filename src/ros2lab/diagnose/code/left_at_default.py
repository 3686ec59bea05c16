"""Fields of what is sent that stay at their defaults, although the code makes a value for them that nothing reads."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Sequence

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.filled import Filled, Unset, kind_of, unset_in
from ros2lab.diagnose.sources.node_source import NodeClass
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, walk
from ros2lab.diagnose.sources.spelling import words_of
from ros2lab.diagnose.sources.syntax_parts import calls_in
from ros2lab.diagnose.sources.uses import State, filled, values_in

# Builtins that only compute.
PURE = frozenset(("abs", "bool", "float", "int", "len", "max", "min", "pow", "round", "sorted", "str", "sum"))
_TIME = "builtin_interfaces.msg.Time"
_NOTHING = ("0", "0.0", "False", "''", "None", "[]")


def left_at_default(
    source: PythonSource, owner: NodeClass | None, function: Function, unset: Sequence[Unset]
) -> Iterator[Finding]:
    """Yield variables that a function never reads, where a field that would take their value has its default.

    A value that is only fetched is reported, too, if the function sets a single field to the constant 0.
    """
    values = values_in(function)
    for node in never_read(function):
        value = values.get(id(node))
        if value is None or ast.unparse(value) in _NOTHING or kind_of(source, value):
            continue
        if found := _meant(node.id, value, unset):
            yield _told(f"{function.name}() sets {node.id}", node.id, value, found, source.at(node))
            return
        fills = [*filled(function)]
        zeros = [(t, v) for t, v in fills if isinstance(v, ast.Constant) and v.value == 0]
        # Nothing else is filled in: so the value was meant for it.
        is_callable = owner is not None and function.name != "__init__" and _is_fetched(value)
        if is_callable and len(zeros) == 1 == len(fills):
            target, zero = zeros[0]
            cause = f"{function.name}() computes {node.id} but never uses it; {target} is always {ast.unparse(zero)}."
            yield Finding("never-read", cause, source.at(zero), f"write {target} = {node.id}")
            return


def unread_attributes(state: State, objects: Sequence[Filled]) -> Iterator[Finding]:
    """Yield attributes of a class that nothing reads, where a field that would take their value has its default."""
    unset = [
        (own, path, of) for own, path, of in unset_in(objects) if not any(o.is_set(path) for o in objects)
    ]
    for text, stores in state.stores.items() if unset else ():
        name, (method, node, value) = text.removeprefix("self."), stores[-1]
        # One word may be kept for anything.
        if text.count(".") > 1 or name in state.read or len(words_of(name)) < 2 or value is None:
            continue
        found = _meant(name, value, unset) if ast.unparse(value) not in _NOTHING else None
        if found and not _is_now(value):
            yield _told(f"{method.name}() sets {text}", text, value, found, state.at(node))
            return


def _told(cause: str, name: str, value: ast.expr, unset: Unset, place: str) -> Finding:
    own, path, of = unset
    field, line = f"{own.name}.{path}", own.sent[0].lineno
    given = (
        f"{name}.to_msg()" if of == _TIME and last_name(getattr(value, "func", None)) != "to_msg" else name
    )
    is_whole = "." in of and of != _TIME
    fix = f"fill {field} with it" if is_whole else f"write `{field} = {given}`"
    cause = f"{cause}, which nothing reads, and {field} stays at its default in what is sent."
    return Finding("never-read", cause, place, f"{fix} above line {line}")


def _meant(name: str, value: ast.expr, unset: Sequence[Unset]) -> Unset | None:
    """Return the only field at its default that a value is meant for, by its type or its name; None if there is not just one."""
    if _is_now(value):
        found = [one for one in unset if one[2] == _TIME and one[1].count(".") < 2]
    else:
        found = [one for one in unset if _is_named_for(name, one) and _may_take(one[2], value)]
    paths = {one[1] for one in found}
    return found[0] if len(paths) == 1 and len({id(one[0]) for one in found}) == 1 else None


def _is_now(value: ast.expr) -> bool:
    """Return whether an expression is the present time of ROS, perhaps as a message."""
    called = value.func if isinstance(value, ast.Call) else None
    if isinstance(called, ast.Attribute) and called.attr == "to_msg":
        return _is_now(called.value)
    return isinstance(called, ast.Attribute) and called.attr == "now" and "clock" in ast.unparse(called.value)


def _is_named_for(name: str, unset: Unset) -> bool:
    """Return whether a name is made of the words of a field, and has all that the field itself is called."""
    own, path, _ = unset
    words = _singular(words_of(name))
    allowed = _singular([word for text in (path, own.kind, own.name) for word in words_of(text)])
    return words <= allowed and _singular(words_of(path.rpartition(".")[2])) <= words


def _singular(words: Iterable[str]) -> set[str]:
    return {word.removesuffix("s") for word in words}


def _may_take(of: str, value: ast.expr) -> bool:
    """Return whether a field of a type may take a value, as far as its form tells."""
    if isinstance(value, (ast.List, ast.ListComp, ast.Tuple)):
        return "[" in of or "<" in of
    if isinstance(value, ast.JoinedStr) or isinstance(getattr(value, "value", None), str):
        return of == "str"
    return not isinstance(value, (ast.Dict, ast.Set, ast.Lambda))


def never_read(function: Function) -> Iterator[ast.Name]:
    """Yield the assigned variables that a function never reads, nor anything that is bound together with them."""
    names = [node for node in walk(function) if isinstance(node, ast.Name)]
    read = {node.id for node in names if isinstance(node.ctx, ast.Load)}
    read |= {n for node in walk(function) if isinstance(node, (ast.Global, ast.Nonlocal)) for n in node.names}
    bound = _assigned_together(function)
    for node in names:
        is_lost = node.id not in read and not node.id.startswith("_")
        if is_lost and id(node) in bound and bound[id(node)].isdisjoint(read):
            yield node


def _assigned_together(function: Function) -> dict[int, set[str]]:
    """Return for each name that an assignment binds, by its `id`, all that the assignment binds.

    What a loop, a `with` or an import binds is left out: it is bound because of the statement, not to be kept.
    """
    found = dict[int, set[str]]()
    for node in walk(function):
        if isinstance(node, (ast.Assign, ast.AnnAssign, ast.AugAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names = [n for to in targets for n in walk(to) if isinstance(n, ast.Name)]
            together = {ast.unparse(n) for n in names}
            found |= {id(n): together for n in names if isinstance(n.ctx, ast.Store)}
    return found


def _is_fetched(value: ast.expr) -> bool:
    """Return whether an expression only fetches a value; a computed one may be a leftover."""
    calls = calls_in(walk(value))
    names = {last_name(call.func) for call in calls}
    return not isinstance(value, (ast.BinOp, ast.Constant)) and names <= PURE | {"get_parameter"}
