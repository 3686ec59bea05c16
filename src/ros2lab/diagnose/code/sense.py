"""How little sense code makes: what Python can read after a repair, but nobody would have meant."""

from __future__ import annotations

import ast
import builtins
import itertools
import re
from collections.abc import Callable, Collection, Iterator

from ros2lab.diagnose.code.bound_names import MODULE_NAMES
from ros2lab.diagnose.sources.bindings import bound_by
from ros2lab.diagnose.sources.one_run import blocks
from ros2lab.diagnose.sources.python_source import Function

_PENALTY = 3.0  # of each oddity, in the cost of a repair
_TEXT = re.compile(r"""'(?:\\.|[^'\\])*'|"(?:\\.|[^"\\])*\"""")
_JOINED = re.compile(
    r"""(?<![\w'"])(?:'[^']*'|"[^"]*") *(?:'[^']*'|"[^"]*")"""
)  # two strings without a comma
_BUILTINS = frozenset(dir(builtins)) | MODULE_NAMES
_PLAIN = (ast.Constant, ast.JoinedStr, ast.List, ast.Dict, ast.Set, ast.Tuple)
_IDLE = (ast.Name, ast.Attribute, ast.Compare, ast.BinOp, ast.Subscript, ast.Lambda, *_PLAIN)


def nonsense(
    tree: ast.Module, first: int, last: int, before: str, after: str, *, is_move: bool = False
) -> float:
    """Return what the oddities of some repaired lines cost: unknown names, idle values, calls of plain values.

    Lines that are only indented in another way were odd in themselves before.
    """
    if is_move:
        return _PENALTY * sum(1 for _ in _out_of_place(tree, first, last))
    known = _bound(tree) | _BUILTINS
    near = [node for node in ast.walk(tree) if _is_within(node, first, last)]
    new = _texts(near) - {text[1:-1] for text in _TEXT.findall(before)}
    odd: float = sum(is_odd(node) for node in near for is_odd in _ODDITIES)
    odd += _unknown(tree, near, known, is_one_line=first == last) + sum(_is_code(text, known) for text in new)
    odd += sum(2 if new & _texts([node.value]) else 1 for node in _idle(tree, first, last, new))
    odd += sum(1 for _ in _lost(tree, first, last)) + _members(tree, near) / 10
    return _PENALTY * (odd + max(len(_JOINED.findall(after)) - len(_JOINED.findall(before)), 0))


def _out_of_place(tree: ast.Module, first: int, last: int) -> Iterator[ast.stmt]:
    """Yield moved statements, and those that were left behind below them, in a body in which they mean little."""
    around = (
        n for n in ast.walk(tree) if isinstance(n, Function) and n.lineno <= last <= (n.end_lineno or 0)
    )
    yield from filter(_holds_a_method, around)
    classes = (node for node in ast.walk(tree) if isinstance(node, ast.ClassDef))
    owners: Iterator[ast.Module | ast.ClassDef] = itertools.chain([tree], classes)
    for owner in owners:
        known = _bound_at_top(tree) | {name for node in owner.body for name in _names_of(node)}
        is_below = False
        for node in owner.body:
            is_left = is_below and (_is_method(node) or not isinstance(node, (Function, ast.ClassDef)))
            is_below = is_left or node.lineno <= last <= (node.end_lineno or 0)
            if (is_below or first <= node.lineno <= last) and _means_little(node, owner, known):
                yield node


def _means_little(node: ast.stmt, owner: ast.Module | ast.ClassDef, known: Collection[str]) -> bool:
    """Return whether a statement is a method outside a class, a call in a class's body, or reads what nothing binds."""
    is_value = isinstance(node, ast.Expr) and not isinstance(node.value, ast.Constant)
    if is_value and isinstance(owner, ast.ClassDef):
        return True
    if isinstance(node, (Function, ast.ClassDef)):
        return isinstance(owner, ast.Module) and _is_method(node)
    return any(isinstance(n, ast.Name) and n.id not in known for n in ast.walk(node))


def _bound_at_top(tree: ast.Module) -> set[str]:
    """Return the names that a file binds outside of its functions and classes, and those of Python."""
    return {name for node in tree.body for name in _names_of(node)} | _BUILTINS


def _names_of(node: ast.stmt) -> set[str]:
    """Return the names that a statement binds where it stands."""
    return {node.name} if isinstance(node, (Function, ast.ClassDef)) else _bound(node)


def _unknown(tree: ast.Module, near: list[ast.AST], known: set[str], *, is_one_line: bool) -> int:
    """Return how many names are read that nothing binds, or nothing but the very line."""
    names = [node for node in near if isinstance(node, ast.Name)]
    stored = {name.id for name in names if isinstance(name.ctx, ast.Store)} if is_one_line else set()
    own = stored - _bound(tree, near) if stored else stored
    return sum(isinstance(name.ctx, ast.Load) and (name.id in own or name.id not in known) for name in names)


def _members(tree: ast.Module, near: list[ast.AST]) -> int:
    """Return how many members are names that the file uses by themselves: `TOPIC.QOS` for `TOPIC, QOS`."""
    bare = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    return sum(isinstance(node, ast.Attribute) and node.attr in bare for node in near)


def _is_within(node: ast.AST, first: int, last: int) -> bool:
    """Return whether a statement begins on some lines, or an expression touches them."""
    line = getattr(node, "lineno", 0)
    is_begun = line >= first or isinstance(node, ast.expr)
    return is_begun and line <= last and getattr(node, "end_lineno", 0) >= first


def _bound(tree: ast.AST, but: Collection[ast.AST] = ()) -> set[str]:
    """Return the names that code binds anywhere, or anywhere but in some nodes."""
    left_out = {id(node) for node in but}
    return {name for node in ast.walk(tree) if id(node) not in left_out for name in bound_by(node)}


def _is_called_in_vain(node: ast.AST) -> bool:
    """Return whether a plain value, or what a call has just returned, is called."""
    return isinstance(node, ast.Call) and isinstance(node.func, (*_PLAIN, ast.Call))


def _has_no_such_member(node: ast.AST) -> bool:
    match node:
        case ast.Attribute(value=ast.Constant(value=value), attr=name):
            return not hasattr(value, name)
    return False


def _is_indexed_in_vain(node: ast.AST) -> bool:
    match node:
        case ast.Subscript(value=ast.Constant(value=int() | float()) | ast.Set()):
            return True
        case ast.Subscript(value=ast.List() | ast.Tuple() | ast.Constant(), slice=key):
            return isinstance(key, ast.Tuple) or (
                isinstance(key, ast.Constant) and isinstance(key.value, str)
            )
    return False


def _is_reckoned_in_vain(node: ast.AST) -> bool:
    """Return whether a sign stands before, or between, what it is not written for."""
    match node:
        case ast.UnaryOp(op=ast.UAdd()) | ast.UnaryOp(operand=ast.Constant(value=str())):
            return True
        case ast.BinOp(left=left, op=sign, right=right):
            literals = [side for side in (left, right) if isinstance(side, ast.Constant)]
            kinds = {type(side.value) for side in literals}
            if any(isinstance(side, ast.Name) and side.id in ("self", "rclpy") for side in (left, right)):
                return True
            if len(literals) == 2 and kinds == {float}:
                return True
            if str in kinds and isinstance(sign, ast.Add):
                return len(kinds) > 1
            usual = (ast.Mod, ast.Mult, *((ast.Div,) if literals == [right] else ()))  # a path may be divided
            return str in kinds and not isinstance(sign, usual)
    return False


def _is_made_in_vain(node: ast.AST) -> bool:
    """Return whether a dictionary or a set has members that cannot be in one."""
    match node:
        case ast.Dict(keys=keys):
            return any(isinstance(key, (ast.Tuple, ast.Compare)) for key in keys)
        case ast.Set(elts=values):
            is_key = isinstance(values[0], ast.Constant) and not all(
                isinstance(v, ast.Constant) for v in values
            )
            return is_key or any(
                isinstance(value, (ast.Dict, ast.List, ast.Set, ast.Compare)) for value in values
            )
    return False


def _is_listed_in_vain(node: ast.AST) -> bool:
    """Return whether a name is given several values, the first a string, where an operator was left out."""
    match node:
        case ast.Assign(
            targets=[ast.Name() | ast.Attribute()],
            value=ast.Tuple(elts=[ast.Constant(value=str()), *_]) as value,
        ):
            return value.col_offset == value.elts[0].col_offset  # no brackets
    return False


def _is_annotated_in_vain(node: ast.AST) -> bool:
    values = (ast.Tuple, ast.Compare, ast.Call, ast.List, ast.Dict)
    return isinstance(node, ast.AnnAssign) and isinstance(node.annotation, values)


def _holds_a_method(node: ast.AST) -> bool:
    """Return whether a function contains one with a parameter `self`, which was to be a method."""
    return isinstance(node, Function) and any(_is_method(n) for n in ast.walk(node) if n is not node)


def _is_method(node: ast.AST) -> bool:
    return isinstance(node, Function) and bool(node.args.args) and node.args.args[0].arg == "self"


_ODDITIES: tuple[Callable[[ast.AST], bool], ...] = (
    _is_called_in_vain,
    _has_no_such_member,
    _is_indexed_in_vain,
    _is_reckoned_in_vain,
    _is_made_in_vain,
    _is_listed_in_vain,
    _is_annotated_in_vain,
    _holds_a_method,
)


def _idle(tree: ast.Module, first: int, last: int, new: set[str]) -> Iterator[ast.Expr]:
    """Yield statements that only name a value, and calls in the body of a class; docstrings are none, if not new."""
    for owner in ast.walk(tree):
        for place, node in (pair for body in blocks(owner) for pair in enumerate(body)):
            if not isinstance(node, ast.Expr) or not _is_within(node, first, last):
                continue
            value = node.value.value if isinstance(node.value, ast.Constant) else None
            is_doc = value is ... or (isinstance(value, str) and place == 0 and value not in new)
            if not is_doc and (isinstance(owner, ast.ClassDef) or isinstance(node.value, _IDLE)):
                yield node


def _lost(tree: ast.Module, first: int, last: int) -> Iterator[str]:
    """Yield names in statements at the top of a file that only its functions bind."""
    at_top = [node for node in tree.body if not isinstance(node, (Function, ast.ClassDef))]
    bound = _bound_at_top(tree)
    for statement in at_top:
        if _is_within(statement, first, last):
            yield from (n.id for n in ast.walk(statement) if isinstance(n, ast.Name) and n.id not in bound)


def _texts(near: list[ast.AST]) -> set[str]:
    """Return the strings of at least two characters in some code."""
    values = (node.value for node in near if isinstance(node, ast.Constant))
    return {value for value in values if isinstance(value, str) and len(value) > 1}


def _is_code(text: str, known: set[str]) -> bool:
    """Return whether a string has swallowed code: a name beside a sign, a quote beside a comma, half a bracket."""
    named = re.findall(r"[+(]\s*(\w+)\b|\b(\w+)\s*(?:[+(]|\.\w)", text)
    names = {name for pair in named for name in pair if len(name) > 2}
    is_listed = re.search(r"""['"]\s*[,)\]]|[,(\[]\s*['"]""", text) is not None
    return (
        is_listed
        or re.search(r"==|\w\(", text) is not None
        or text.count("(") != text.count(")")
        or not names.isdisjoint(known - _BUILTINS)
    )
