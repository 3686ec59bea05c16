"""Small changes to a line and to the lines that made its values, for no mistake in particular.

A value is called, or not called, taken out of what holds it, asked of another object, passed by keyword, or
converted to another type.
"""

from __future__ import annotations

import ast
import builtins
import contextlib
import difflib
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from ros2lab.diagnose.checking.edits import Edit
from ros2lab.diagnose.checking.members import members
from ros2lab.diagnose.checking.operands import held_in
from ros2lab.diagnose.checking.trials import Trial
from ros2lab.diagnose.sources.calls import as_list, whole_call
from ros2lab.diagnose.sources.class_trees import launch_classes_below
from ros2lab.diagnose.sources.interfaces import fields_of, homes_of, launch_homes_of
from ros2lab.diagnose.sources.node_source import NodeClass, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, assigned_to
from ros2lab.diagnose.sources.signatures import LISTS, Signature, heads_of, signature_by_name, signature_of
from ros2lab.diagnose.sources.spelling import snake_case
from ros2lab.diagnose.sources.static_value import evaluate, is_known

_ALIKE = 0.6  # of two names, as difflib measures it


@dataclass(frozen=True)
class Change:
    """An edit that may be what was meant.

    Attributes:
        edit: what is changed.
        cost: how much it changes; of several that work, the cheapest is meant.
        is_one_of_many: whether all that speaks for it is that it works: it counts only if few others of its cost do.
    """

    edit: Edit
    cost: int
    is_one_of_many: bool = False


# What a change costs, from a typing error to another value.
_SLIP, _FORM, PLACE, _VALUE, LESS = 1, 2, 3, 4, 5
MOST = 150  # changes that are tried, about half a second
MOST_TOLD = 3  # changes that are equally likely


def changes_of(trial: Trial, said: str = "") -> Iterator[Change]:
    """Yield changes to a line and to the lines that made its values; what is said of it may name the wanted class."""
    yield from _as_said(trial, said)
    if isinstance(trial.statement, ast.FunctionDef):
        yield from _of_definition(trial.statement, trial)
    expressions = trial.expressions()
    called = {id(node.func): node for node in expressions if isinstance(node, ast.Call)}
    made = origins_of(expressions, trial)
    for node in expressions:
        if isinstance(getattr(node, "ctx", None), (ast.Store, ast.Del)):
            continue
        if ast.unparse(node) not in made and id(node) not in called:
            yield from _of_form(node, trial)
        yield from _of_separators(node)
        yield from _of_members(node, trial, called.get(id(node)))
        if id(node) not in called:
            yield from _of_what_it_holds(node, trial)
        if isinstance(node, ast.Call):
            yield from _of_arguments(node, trial)
        yield from _of_value(node, trial)
    for value in made.values():
        for change in [*_of_form(value, trial), *_of_value(value, trial)]:
            yield replace(change, cost=change.cost + 1)


def _as_said(trial: Trial, said: str) -> Iterator[Change]:
    """Yield a returned value put into a class that is named, and a string replaced by an allowed one."""
    wanted = [word for word in dict.fromkeys(re.findall(r"\b[A-Z]\w+", said)) if launch_homes_of(word)]
    value = trial.statement.value if isinstance(trial.statement, ast.Return) else None
    if value is not None:
        yield from (Change(Edit(value, f"{name}({ast.unparse(value)})"), _FORM) for name in wanted)
    choices = re.findall(r"[\"'](\w+)[\"']", said)
    for node in trial.expressions():
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value not in choices:
            near = difflib.get_close_matches(node.value, choices, n=1, cutoff=_ALIKE)
            yield from (Change(Edit(node, repr(choice)), _SLIP) for choice in near)


def _of_definition(function: ast.FunctionDef, trial: Trial) -> Iterator[Change]:
    """Yield a function with a parameter for the context that launch passes to it."""
    given = [keyword.value for n in trial.source.nodes if isinstance(n, ast.Call) for keyword in n.keywords]
    if not function.args.args and any(ast.unparse(value) == function.name for value in given):
        yield Change(Edit(_head(function), f"{function.name}(context)"), _FORM)


def _head(function: ast.FunctionDef) -> ast.Name:
    """Return a node with the range of a function's name and empty parentheses."""
    begin = function.col_offset + len("def ")
    here = ast.Name(function.name, lineno=function.lineno, col_offset=begin)
    here.end_lineno, here.end_col_offset = function.lineno, begin + len(function.name) + len("()")
    return here


def _of_form(node: ast.expr, trial: Trial) -> Iterator[Change]:
    """Yield a call of a function; or the function itself, where the line does more than call it."""
    text = ast.unparse(node)
    if isinstance(node, (ast.Name, ast.Attribute)):
        yield Change(Edit(node, f"{text}()"), _FORM)
    if isinstance(node, ast.Name) and trial.owner and text == trial.owner.definition.name:
        yield Change(Edit(node, "self"), _SLIP)
    is_whole = isinstance(trial.statement, ast.Expr) and trial.statement.value is node
    if isinstance(node, ast.Call) and not is_whole and not node.args and not node.keywords:
        yield Change(Edit(node, ast.unparse(node.func)), _FORM)


def _of_separators(node: ast.expr) -> Iterator[Change]:
    """Yield two neighbours in a list joined by a dot, where the comma may be a typing error."""
    values = node.args if isinstance(node, ast.Call) else getattr(node, "elts", ())
    for left, right in pairwise(values):
        joined = f"{ast.unparse(left)}.{ast.unparse(right)}"
        if left.end_lineno == right.lineno and isinstance(_first_of(right), ast.Name):
            both = ast.Tuple([left, right], lineno=left.lineno, col_offset=left.col_offset)
            both.end_lineno, both.end_col_offset = right.end_lineno, right.end_col_offset
            yield Change(Edit(both, joined), _SLIP)


def _first_of(node: ast.expr) -> ast.expr:
    """Return the leftmost part of a chain of calls, attributes and subscripts."""
    while isinstance(node, (ast.Call, ast.Attribute, ast.Subscript)):
        node = node.func if isinstance(node, ast.Call) else node.value
    return node


def _of_members(node: ast.expr, trial: Trial, call: ast.Call | None) -> Iterator[Change]:
    """Yield another member of the same object, the member of another object, and an item instead."""
    if not isinstance(node, ast.Attribute):
        return
    before = ast.unparse(node.value)
    kind = trial.kind(before)
    known = members(_class_name(kind), trial.look)
    if "Self@" in kind and trial.owner:
        known |= members(trial.owner.definition.name, trial.look)
    yield from _of_the_same(node, known, trial, call)
    if kind.startswith("dict["):
        yield Change(Edit(node, f"{before}[{node.attr!r}]"), _FORM)
    if node.attr in known or kind.startswith("<module "):
        return  # a module's function is no method of another object
    for name in _never_read(trial.owner) if before == "self" and trial.owner else ():
        yield Change(Edit(node, f"self.{name}"), _SLIP, is_one_of_many=True)
    for holder in trial.names:
        if holder != before and node.attr in members(_class_name(trial.kind(holder)), trial.look):
            yield from _asked_of(holder, node, call)


def _of_the_same(
    node: ast.Attribute, known: Collection[str], trial: Trial, call: ast.Call | None
) -> Iterator[Change]:
    """Yield members with similar names; for a call whose value is unused, those that return nothing."""
    before = ast.unparse(node.value)
    if node.attr in known and any(row.rule == "missing-argument" for row in trial.objections):
        return  # it is the right one, with an argument too few
    for name in difflib.get_close_matches(node.attr, {*known} - {node.attr}, n=3, cutoff=_ALIKE):
        yield Change(Edit(node, f"{before}.{name}"), _SLIP)
        yield Change(Edit(node, f"{before}.{name}()"), _FORM)
    if call is not None and isinstance(trial.statement, ast.Expr) and trial.statement.value is call:
        for text, kind in trial.kinds_of([f"{before}.{name}" for name in sorted(known)]).items():
            if kind.endswith("-> None"):
                yield Change(Edit(node, text), PLACE, is_one_of_many=True)


def _of_what_it_holds(node: ast.expr, trial: Trial) -> Iterator[Change]:
    """Yield what a value holds instead of the value itself."""
    text = ast.unparse(node)
    kind = trial.kind(text)
    name = _class_name(kind)
    if not name or hasattr(builtins, name):
        return
    is_whole = isinstance(node, (ast.Name, ast.Attribute, ast.Call))
    held = (
        f"{text}.value" if kind.startswith("Literal[") else held_in(text if is_whole else f"({text})", name)
    )
    if held:
        yield Change(Edit(node, held), _FORM)
    is_refused = any(
        re.search(rf"found `(?:[\w.]+\.)?{re.escape(name)}`", row.said) for row in trial.objections
    )
    for method in sorted(members(name, trial.look)) if is_whole and is_refused else ():
        yield Change(Edit(node, f"{text}.{method}()"), PLACE, is_one_of_many=True)
    for field in _fields(name) if not held else ():
        yield Change(Edit(node, f"{text}.{field}"), PLACE, is_one_of_many=True)


def _fields(message: str) -> Sequence[str]:
    """Return the fields of a message; empty for any other class."""
    fields = (fields_of(f"{home}.{message}") for home in homes_of(message))
    return [*next(filter(None, fields), {})]


def _never_read(owner: NodeClass) -> list[str]:
    """Return attributes that a class sets but never reads: it may read one by a wrong name."""
    own = [n for n in ast.walk(owner.definition) if is_self_attribute(n)]
    read = {n.attr for n in own if not isinstance(n.ctx, ast.Store)}
    return sorted({n.attr for n in own} - read)


def _asked_of(holder: str, node: ast.Attribute, call: ast.Call | None) -> Iterator[Change]:
    """Yield a member of another object, and its call with one argument less."""
    if call is None:
        yield Change(Edit(node, f"{holder}.{node.attr}"), PLACE, is_one_of_many=True)
        return
    texts = [*map(ast.unparse, call.args), *map(_keyword, call.keywords)]
    yield Change(Edit(call, f"{holder}.{node.attr}({', '.join(texts)})"), PLACE, is_one_of_many=True)
    for number in range(len(texts)):
        less = [*texts[:number], *texts[number + 1 :]]
        yield Change(Edit(call, f"{holder}.{node.attr}({', '.join(less)})"), _VALUE, is_one_of_many=True)


def _of_arguments(call: ast.Call, trial: Trial) -> Iterator[Change]:
    """Yield a call with arguments swapped, passed by keyword, put into a list, added or removed."""
    given, signature = [*map(ast.unparse, call.args)], signature_of(trial.source, call)
    for number in range(len(given) - 1):
        swapped = [*given[:number], given[number + 1], given[number], *given[number + 2 :]]
        yield Change(_written(call, *swapped), PLACE)
    yield from _by_keyword(call, signature)
    rules = {row.rule for row in trial.objections}
    if "missing-argument" in rules:
        yield from _with_one_more(call, trial)
    if len(given) > 1 and rules & {"too-many-positional-arguments", "invalid-argument-type"}:
        yield Change(_written(call, f"[{', '.join(given)}]"), PLACE)
    for number in range(len(given)) if "too-many-positional-arguments" in rules else ():
        yield Change(_written(call, *given[:number], *given[number + 1 :]), LESS, is_one_of_many=True)
    yield from _of_wanted(call, signature)
    if whole := whole_call(trial.source, call):
        yield Change(Edit(call, whole), PLACE)


def _written(call: ast.Call, *texts: str) -> Edit:
    """Return the edit that gives a call other positional arguments."""
    return Edit(call, f"{ast.unparse(call.func)}({', '.join([*texts, *map(_keyword, call.keywords)])})")


def _by_keyword(call: ast.Call, signature: Signature | None) -> Iterator[Change]:
    """Yield a call with its last positional argument passed by each keyword that takes it."""
    if not call.args:
        return
    *others, last = call.args
    free = {p.name: p for p in signature.parameters} if signature else {}
    for name in [n for n in free if n not in {keyword.arg for keyword in call.keywords}]:
        is_list = heads_of(free[name].type) <= LISTS
        text = ast.unparse(last) if free[name].takes(last) else as_list(last) if is_list else ""
        if text:
            yield Change(_written(call, *map(ast.unparse, others), f"{name}={text}"), PLACE)


def _with_one_more(call: ast.Call, trial: Trial) -> Iterator[Change]:
    """Yield a call with one argument more: a name in scope, or a name for what it makes."""
    given, made = [*map(ast.unparse, call.args)], ast.unparse(call.func)
    lacks = [row.said for row in trial.objections if row.rule == "missing-argument"]
    calls_back = any(re.search(r"`\w*callback`|`target`", row.said) for row in trial.objections)
    for name in trial.names:
        is_function = re.match(r"(?:bound method|def|\() ?", trial.kind(name)) is not None
        if name != "args" and (is_function or not calls_back):  # args is what main is given
            yield Change(_written(call, *given, name), PLACE, is_one_of_many=True)
    if made[:1].isupper() and len(lacks) == 1 and re.search(r"parameter `\w*name` of", lacks[0]):
        yield Change(_written(call, *given, repr(snake_case(made))), _FORM)


def _of_wanted(call: ast.Call, signature: Signature | None) -> Iterator[Change]:
    """Yield an argument converted to the class that a parameter asks for, or to a list."""
    rows = signature.parameters if signature else ()
    places = [row for row in rows if row.is_positional]
    named = {row.name: row for row in rows}
    pairs = [*zip(places, call.args, strict=False)]
    pairs += [(named[keyword.arg], keyword.value) for keyword in call.keywords if keyword.arg in named]
    for parameter, value in pairs:
        text, heads = ast.unparse(value), heads_of(parameter.type)
        if "Callable" in heads and isinstance(value, ast.Call):
            yield Change(Edit(value, ast.unparse(value.func)), _FORM)
        known = [name for head in sorted(heads) if head[:1].isupper() for name in launch_classes_below(head)]
        makers = filter(_takes_one, known)
        yield from (Change(Edit(value, f"{name}({text})"), _VALUE, is_one_of_many=True) for name in makers)
        if heads & LISTS:
            yield Change(Edit(value, as_list(value)), _VALUE)


def _takes_one(name: str) -> bool:
    """Return whether a class of launch can be instantiated with a single argument."""
    signature = signature_by_name(f"{launch_homes_of(name)[0]}.{name}")
    first, *others = signature.parameters if signature and signature.parameters else (None,)
    return first is not None and first.is_positional and all(parameter.default for parameter in others)


def _of_value(node: ast.expr, trial: Trial) -> Iterator[Change]:
    """Yield a value converted to another type, or with a default where it may be None."""
    text, kind = ast.unparse(node), trial.kind(ast.unparse(node))
    match node:
        case ast.List(elts=[ast.Name() | ast.Attribute() as only]):
            yield Change(Edit(node, ast.unparse(only)), _FORM)
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            yield Change(Edit(node, f"{ast.unparse(left)} // {ast.unparse(right)}"), _FORM)
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            kinds = [_class_name(trial.kind(ast.unparse(side))) for side in (left, right)]
            is_joined = any(map(launch_homes_of, kinds))  # as launch joins strings and substitutions
            cost = PLACE if is_joined else LESS
            yield Change(Edit(node, f"[{ast.unparse(left)}, {ast.unparse(right)}]"), cost)
    if kind.endswith("| None"):
        empty = _EMPTY.get(kind.removesuffix(" | None"), "...")
        yield Change(Edit(node, f"({text} or {empty})"), _VALUE)
    value = evaluate(node, {}, {}) if isinstance(node, (ast.Constant, ast.List, ast.Tuple)) else None
    literal = value if is_known(value) else None
    for made in _made_of(kind):
        if literal is None or made == "range({})":
            yield Change(Edit(node, made.format(text)), _VALUE)
    for converted in _as_others(literal) if literal is not None else ():
        yield Change(Edit(node, repr(converted)), _VALUE if isinstance(converted, str) else _FORM)


def _as_others(literal: object) -> Iterator[object]:
    """Yield a literal converted to other types: a number, a string, each item of a list."""
    if isinstance(literal, bytes):
        yield literal.decode("latin-1")
        return
    items = [*literal] if isinstance(literal, (list, tuple)) else [literal]
    for kind in (int, float, str):
        made = [_as_one(kind, item) for item in items]
        if None not in made and [*map(type, made)] != [*map(type, items)]:
            yield made if isinstance(literal, (list, tuple)) else made[0]


def _as_one(kind: type[int | float | str], value: Any) -> object:
    """Return a value converted to another type; None if it cannot be, or loses something."""
    with contextlib.suppress(ValueError, TypeError, OverflowError):
        is_lost = kind is not str and (isinstance(value, bool) or kind(value) != float(value))
        return None if is_lost else kind(value)
    return None


def _made_of(kind: str) -> Sequence[str]:
    """Return templates that convert a value of a type to other types; for most types, to a string."""
    name = _class_name(kind)
    # What launch fills in later is not a string yet.
    is_no_text = not kind or _NO_TEXT.match(kind) or launch_homes_of(name)
    return _MADE_OF.get(name, () if is_no_text else ("str({})",))


_EMPTY = {"str": "''", "int": "0", "float": "0.0"}
# The types of functions, classes, modules and None.
_NO_TEXT = re.compile(r"None$|def |bound method|\(|<|type\[|Overload|Self@")
_MADE_OF: Mapping[str, Sequence[str]] = {
    "str": ("float({})", "int({})"),
    "int": ("range({})", "str({})"),
    "float": ("int({})", "str({})"),
    "bool": ("str({})",),
    "list": ("map(str, {})", "map(float, {})"),
    "tuple": ("list({})", "map(str, {})"),
    "set": ("list({})", "map(str, {})"),
    "dict": (),
    "bytes": ("{}.decode()",),
}


def origins_of(expressions: Iterable[ast.expr], trial: Trial) -> dict[str, ast.expr]:
    """Return the value of each name of a line that is assigned only once, and on another line."""
    texts = dict.fromkeys(ast.unparse(n) for n in expressions if isinstance(n, (ast.Name, ast.Attribute)))
    values: dict[str, list[ast.expr]] = {}
    scope: Function | ast.ClassDef | ast.Module
    for text in texts:
        is_own = text.startswith("self.") and trial.owner
        scope = trial.owner.definition if is_own and trial.owner else trial.spot.function or trial.source.tree
        values[text] = assigned_to(ast.walk(scope), text)
    once = {text: found[0] for text, found in values.items() if len(found) == 1}
    return {text: value for text, value in once.items() if value.lineno not in trial.spot.lines}


def _keyword(keyword: ast.keyword) -> str:
    return f"{keyword.arg}={ast.unparse(keyword.value)}" if keyword.arg else f"**{ast.unparse(keyword.value)}"


def _class_name(kind: str) -> str:
    """Return the class name of a type; for a literal, that of its value."""
    kind = kind.removesuffix(" | None")
    if literal := re.match(
        r"Literal\[(?:(?P<enum>[A-Z]\w*)\.\w|(?P<text>['\"])|(?P<bytes>b)|(?P<number>-?\d))", kind
    ):
        known = {"text": "str", "bytes": "bytes", "number": "int"}
        return literal["enum"] or known[literal.lastgroup or "number"]
    return re.sub(r"\[.*", "", kind).rpartition(".")[2]
