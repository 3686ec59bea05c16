"""Single objects that are kept in several places and changed in place, where separate ones were meant."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass

from ros2lab.diagnose.finding import Finding, these_lines
from ros2lab.diagnose.sources.node_source import NodeClass, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, walk
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import CHANGES, TAKES_OUT
from ros2lab.diagnose.sources.uses import Uses

_ADDS = {"append": 0, "appendleft": 0, "add": 0, "insert": 1}  # the position of the added argument
_LITERALS = (ast.List, ast.Dict, ast.Set, ast.ListComp, ast.DictComp, ast.SetComp)
_Loop = ast.For | ast.While | ast.AsyncFor
_LOOPS = (ast.For, ast.While, ast.AsyncFor)


@dataclass(frozen=True)
class _Kept:
    """An object, as it is given, that a call or an assignment stores in a second place, its holder."""

    node: ast.AST
    holder: str
    given: ast.expr


def shared_objects(uses: Uses) -> Iterator[Finding]:
    """Yield objects that are shared by mistake, so that a later change also changes earlier values."""
    for source in uses.sources.sources.values():
        for node in source.nodes:
            if isinstance(node, Function):
                yield from _kept_in_loops(source, node)
            if isinstance(node, (ast.Assign, ast.AnnAssign)):
                yield from _repeated(source, node)
    for owner in uses.sources.classes.values():
        yield from _kept_by(uses, owner)
        yield from _of_the_class(uses, owner)


def _kept_in_loops(source: PythonSource, function: Function) -> Iterator[Finding]:
    """Yield objects made before a loop, changed in it and added there to a collection made before it, too."""
    for loop in (node for node in walk(function) if isinstance(node, _LOOPS)):
        if isinstance(loop.body[-1], (ast.Break, ast.Return)):
            continue  # it makes a single pass
        inside = [node for statement in loop.body for node in walk(statement)]
        bound = {dotted(target) for node in (loop, *inside) for target in _targets(node)}
        for kept in _additions(inside):
            name = dotted(kept.given) or ""
            made = _made_before(function, loop, name)
            changed = _first_change(inside, name)
            if made is None or changed is None or not bound.isdisjoint((name, kept.holder)):
                continue
            cause = f"{kept.holder} gets the same object each time through the loop, and {_line(changed)} changes it, so all its items show the last value."
            use = {n.lineno for n in own_nodes(function) if isinstance(n, ast.Name) and n.id == name}
            between = [line for line in sorted(use) if made.lineno < line < loop.lineno]
            more = f", and after it {these_lines(between)}" if between else ""
            fix = f"move `{ast.unparse(made)}` into the loop{more}"
            yield Finding("one-object", cause, source.at(kept.node), fix)


def _kept_by(uses: Uses, owner: NodeClass) -> Iterator[Finding]:
    """Yield attributes whose object is also stored elsewhere and changed in place later."""
    later = [node for method in owner.functions if method.name != "__init__" for node in walk(method)]
    bound = {dotted(target) or "" for node in later for target in _targets(node)}
    for method in owner.functions:
        candidates = [
            candidate for candidate in _remembered(own_nodes(method)) if _is_read(later, candidate.holder)
        ]
        if id(method) in uses.callbacks:
            candidates += [
                candidate
                for candidate in _additions(own_nodes(method))
                if _goes_on(candidate.holder, bound, later)
            ]
        for kept in candidates:
            name = dotted(kept.given) or ""
            changed = _first_change(later, name)
            if changed is None or name in bound or name == kept.holder or not _is_object(uses, owner, name):
                continue
            cause = (
                f"{kept.holder} gets the object {name} itself, not a copy, and {_line(changed)} changes it later, "
                "so the stored one changes too."
            )
            fix = f"write copy.deepcopy({name}) instead of {name} here, and `import copy` at the top of the file"
            yield Finding("one-object", cause, owner.source.at(kept.node), fix)


def _goes_on(holder: str, bound: Iterable[str], later: Iterable[ast.AST]) -> bool:
    """Return whether a collection keeps what was added earlier: nothing rebinds or empties it."""
    is_anew = any(name.startswith("self.") and f"{holder}.".startswith(f"{name}.") for name in bound)
    return not is_anew and not _first_change(later, holder, TAKES_OUT)


def _of_the_class(uses: Uses, owner: NodeClass) -> Iterator[Finding]:
    """Yield collections in the body of a class with several instances that its methods change."""
    if len(uses.sources.calls_to(owner.name)) < 2:
        return
    nodes = [node for method in owner.functions for node in walk(method)]
    own = {target.attr for node in nodes for target in _targets(node) if is_self_attribute(target)}
    # A list of all instances of the class is shared on purpose.
    own |= {kept.holder.removeprefix("self.") for kept in _additions(nodes) if dotted(kept.given) == "self"}
    for statement in owner.definition.body:
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if (
                isinstance(value, _LITERALS) and name not in own
            ):
                changed = _first_change(nodes, f"self.{name}")
            case _:
                continue
        if changed:
            cause = f"{name} is set in the class body, so all instances of {owner.definition.name} share it, and {_line(changed)} changes it for all of them."
            fix = f"write `self.{name} = {ast.unparse(value)}` in __init__ instead"
            yield Finding("one-object", cause, owner.source.at(statement), fix)


def _repeated(source: PythonSource, node: ast.Assign | ast.AnnAssign) -> Iterator[Finding]:
    """Yield lists and dicts that repeat a single list or object, where part of an item is changed later."""
    match node.value:
        case ast.BinOp(left=ast.List(elts=[item]), op=ast.Mult(), right=count):
            comprehension = f"[{ast.unparse(item)} for _ in range({ast.unparse(count)})]"
        case ast.Call(func=ast.Attribute(value=ast.Name(id="dict"), attr="fromkeys"), args=[keys, item]):
            comprehension = f"{{key: {ast.unparse(item)} for key in {ast.unparse(keys)}}}"
        case _:
            return
    is_list = (
        isinstance(item, ast.BinOp) and isinstance(item.op, ast.Mult) and isinstance(item.left, ast.List)
    )
    is_object = (
        is_list or isinstance(item, _LITERALS) or (isinstance(item, ast.Call) and _is_class(source, item))
    )
    for target in _targets(node):
        name = dotted(target)
        if is_object and name and (changed := _change_below(source.nodes, name)):
            cause = f"{name} holds the same object {ast.unparse(item)} several times, so {_line(changed)} changes all of them."
            yield Finding("one-object", cause, source.at(node), f"write {name} = {comprehension}")


def _additions(nodes: Iterable[ast.AST]) -> Iterator[_Kept]:
    """Yield objects that are added to a collection."""
    for node in nodes:
        match node:
            case ast.Call(func=ast.Attribute(value=holder, attr=attr), args=args) if (
                attr in _ADDS and len(args) == _ADDS[attr] + 1
            ):
                given = args[-1]
            case ast.Assign(targets=[ast.Subscript(value=holder, slice=key)], value=given) if not isinstance(
                key, ast.Constant
            ):
                pass
            case _:
                continue
        if name := dotted(holder):
            yield _Kept(node, name, given)


def _remembered(nodes: Iterable[ast.AST]) -> Iterator[_Kept]:
    """Yield attributes of self that are assigned to another attribute of self."""
    for node in nodes:
        match node:
            case ast.Assign(targets=[ast.Attribute() as target], value=ast.Attribute() as given) if (
                is_self_attribute(target) and is_self_attribute(given)
            ):
                yield _Kept(node, ast.unparse(target), given)


def _made_before(function: Function, loop: _Loop, name: str) -> ast.Assign | None:
    """Return the only statement that sets a variable, if it creates an object before a loop; else None."""
    stores = [
        node for node in own_nodes(function) if name in [getattr(to, "id", "") for to in _targets(node)]
    ]
    match stores:
        case [ast.Assign(value=ast.Call() | ast.List() | ast.Dict() | ast.Set()) as made] if (
            made.lineno < loop.lineno
        ):
            return made
    return None


def _is_object(uses: Uses, owner: NodeClass, name: str) -> bool:
    """Return whether `__init__` sets an attribute to a new object or collection."""
    constructor = owner.methods.get("__init__")
    values = [
        node.value
        for node in (own_nodes(constructor) if constructor else ())
        if isinstance(node, (ast.Assign, ast.AnnAssign)) and name in map(dotted, _targets(node))
    ]
    match values:
        case [ast.Call() as call]:
            return (
                _is_class(owner.source, call)
                or uses.sources.resolve(owner.source, call.func) in uses.sources.classes
            )
        case [value]:
            return isinstance(value, _LITERALS)
    return False


def _is_class(source: PythonSource, call: ast.Call) -> bool:
    """Return whether a call creates an object, judging by its name."""
    name = (source.resolve(call.func) or dotted(call.func) or "").rpartition(".")[2]
    return name[:1].isupper() or name in ("list", "dict", "set", "deque")


def _targets(node: ast.AST) -> list[ast.expr]:
    """Return the targets that a statement assigns to."""
    match node:
        case ast.Assign(targets=targets):
            return [
                element
                for expression in targets
                for element in (expression.elts if isinstance(expression, ast.Tuple) else [expression])
            ]
        case ast.AnnAssign(target=target) | ast.For(target=target) | ast.NamedExpr(target=target):
            return [target]
    return []


def _first_change(nodes: Iterable[ast.AST], name: str, by: Collection[str] = CHANGES) -> ast.AST | None:
    """Return the first node that sets part of an object, or calls one of some methods on it; or None."""
    for node in nodes:
        match node:
            case ast.Attribute(ctx=ast.Store()) | ast.Subscript(ctx=ast.Store()) if by is CHANGES:
                changed = [*_above(node)]
            case ast.Call(func=ast.Attribute(attr=attr, value=value)) if attr in by:
                changed = [ast.unparse(value), *_above(value)]
            case _:
                continue
        if name in changed:
            return node
    return None


def _change_below(nodes: Iterable[ast.AST], name: str) -> ast.AST | None:
    """Return the first node that changes part of an item; None if none does, or if items are replaced."""
    items = [node for node in nodes if isinstance(node, ast.Subscript) and ast.unparse(node.value) == name]
    if any(isinstance(item.ctx, ast.Store) for item in items):
        return None  # each item may be replaced by an object of its own
    return next(filter(None, (_first_change(nodes, ast.unparse(item)) for item in items)), None)


def _above(node: ast.expr) -> Iterator[str]:
    """Yield the expressions that an attribute or item is part of, the innermost first."""
    while isinstance(node, (ast.Attribute, ast.Subscript)):
        node = node.value
        yield ast.unparse(node)


def _is_read(nodes: Iterable[ast.AST], name: str) -> bool:
    """Return whether anything reads an attribute."""
    return any(isinstance(getattr(node, "ctx", None), ast.Load) and dotted(node) == name for node in nodes)


def _line(node: ast.AST) -> str:
    return f"line {getattr(node, 'lineno', 0)}"
