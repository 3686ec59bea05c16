"""Values that a list field refuses: what to put in brackets, or how to convert each element."""

from __future__ import annotations

import ast
import re

from ros2lab.diagnose.checking.trials import type_of
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.spots import Spot, kind_in_words
from ros2lab.diagnose.sources.calls import fitting
from ros2lab.diagnose.sources.own_functions import held_once
from ros2lab.diagnose.sources.python_source import PythonSource, last_name
from ros2lab.diagnose.sources.spelling import with_article

_SAYS = re.compile(
    r"a set or sequence(?: with length (?P<most><= )?(?P<length>\d+))? and each value of type '(?P<kind>\w+)'"
)
_ZERO = {"float": "0.0"}
_LISTS = frozenset(("list", "tuple", "set", "frozenset", "array", "deque", "range"))
_GONE_THROUGH = frozenset(
    ("map", "filter", "zip", "reversed", "dict_keys", "dict_values", "Generator", "dict")
)


def of_list(field: str, what: str, value: ast.expr, spot: Spot) -> Finding | None:
    """Return a finding about a wrong value for a field that holds several; None if nothing can be said."""
    said = _SAYS.match(what)
    if said is None:
        return None
    kind, source = said["kind"], spot.file
    is_fixed = said["length"] is not None and not said["most"]
    count = int(said["length"]) if is_fixed else None
    written, given = _as_list(value, kind, count, source)
    text = ast.unparse(value)
    if not written or ast.unparse(ast.parse(written, mode="eval")) in (text, f"[one for one in {text}]"):
        return None  # also where it would only be the same items again
    several = f"{count} values" if count else "a list"
    holds = f"The field {field} holds {several} of type {kind}"
    cause = f"{holds}, but `{ast.unparse(value)}` is {given}."
    return Finding("field-type", cause, source.at(value), _told(value, written, spot))


def _told(value: ast.expr, written: str, spot: Spot) -> str:
    """Return the fix: the whole statement if it only assigns this value, or else the value."""
    for node in spot.nodes:
        if isinstance(node, ast.Assign) and node.value is value:
            return f"write {' = '.join(map(ast.unparse, node.targets))} = {written}"
    return f"write {written} instead of {ast.unparse(value)}"


def _as_list(value: ast.expr, kind: str, count: int | None, source: PythonSource) -> tuple[str, str]:
    """Return a value as the wanted list, and what the value is in words; both empty if unknown."""
    home, made = held_once(source, value) or (source, value)
    made = made if home is source else value
    if isinstance(made, (ast.List, ast.Tuple)):
        return _of_literal(value, made, kind, count)
    name = _type_name(made, source)
    text = ast.unparse(value)
    if name in _LISTS or _is_several(made):
        return _of_several(text, kind, count)
    if name in _GONE_THROUGH:
        inner = text if name != "dict" else f"{text}.values()"
        return f"[{_made(kind, 'one')} for one in {inner}]", f"{with_article(name)}, which is not a list"
    if name == "ndarray":
        return f"{text}.tolist()", "a NumPy array of another size or type"
    if not name:
        return "", ""
    is_right = name == kind
    item = text if is_right else fitting(kind, value) or _made(kind, text)
    many = f" * {count}" if count and count > 1 else ""
    return f"[{item}]{many}", f"a single value, {kind_in_words(name)}"


def _of_several(text: str, kind: str, count: int | None) -> tuple[str, str]:
    """Return a list of unknown length converted as needed, and what is wrong with it."""
    items = f"[{_made(kind, 'one')} for one in {text}]"
    if count is None:
        return items, "a list with values of another type"
    filled = f"({items} + [{_ZERO.get(kind, '0')}] * {count})[:{count}]"
    return filled, "a list of another length, or with values of another type"


def _is_several(made: ast.expr) -> bool:
    """Return whether an expression has the form of a list: a comprehension, or a repeated list."""
    is_repeated = isinstance(made, ast.BinOp) and isinstance(made.left, ast.List)
    return is_repeated or isinstance(made, (ast.ListComp, ast.SetComp, ast.GeneratorExp))


def _of_literal(value: ast.expr, made: ast.List | ast.Tuple, kind: str, count: int | None) -> tuple[str, str]:
    """Return a list literal with values of the right type, and what was wrong with it."""
    if count is not None and len(made.elts) ** 2 == count > 1:
        row = f"for row, one in enumerate({ast.unparse(value)})"
        diagonal = f"[{_made(kind, 'one')} if row == column else {_ZERO.get(kind, '0')} {row} for column in range({len(made.elts)})]"
        return diagonal, f"a list of {len(made.elts)}: only the diagonal of {len(made.elts)} rows"
    if count is not None and len(made.elts) != count:
        more = [ast.unparse(element) for element in made.elts][:count]
        filled = ", ".join([*more, *[_ZERO.get(kind, "0")] * (count - len(more))])
        return f"[{filled}]", f"a list of {len(made.elts)}"
    right = [_item(element, kind) for element in made.elts]
    texts = map(ast.unparse, made.elts)
    wrong = [text for text, new in zip(texts, right, strict=True) if text != new]
    given = f"a list with {', '.join(wrong)} in it"
    if made is not value:
        return f"[{_made(kind, 'one')} for one in {ast.unparse(value)}]", given
    return f"[{', '.join(right)}]", given


def _item(element: ast.expr, kind: str) -> str:
    if isinstance(element, ast.Constant):
        is_right = type(element.value).__name__ == kind
        return ast.unparse(element) if is_right else fitting(kind, element) or ast.unparse(element)
    is_called = isinstance(element, ast.Call) and last_name(element.func) == kind
    is_text = isinstance(element, ast.JoinedStr) and kind == "str"
    return ast.unparse(element) if is_called or is_text else _made(kind, ast.unparse(element))


def _made(kind: str, text: str) -> str:
    """Return how to convert an expression to a plain type; unchanged for other types."""
    return f"{kind}({text})" if kind in ("float", "int", "str", "bool") else text


def _type_name(value: ast.expr, source: PythonSource) -> str:
    """Return the class name of a value; empty if it is unknown or ambiguous."""
    if isinstance(value, ast.Constant):
        return type(value.value).__name__
    if isinstance(value, ast.JoinedStr):
        return "str"
    kind = type_of(source, value)
    if re.match(r"Literal\b", kind):
        return "str" if re.search(r"['\"]", kind) else "int"
    return "" if re.search(r"Unknown|Any\b| \| |None", kind) else re.sub(r"\[.*", "", kind).rpartition(".")[2]
