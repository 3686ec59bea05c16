"""Literals of the wrong type that fail only elsewhere, where the value made of them is used."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.checking.edits import Edit
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import Spot, kind_in_words
from ros2lab.diagnose.sources.literals import Leaf, Literals
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.signatures import kind_of
from ros2lab.diagnose.sources.spelling import with_article

_FIELD = re.compile(
    r"The '(?P<field>\w+)' field must be .*?(?:of type|each value of type) '(?P<kind>int|float|str)'"
)
# What Python says of a number that must be whole, and of a string where a number belongs.
_WHOLE = re.compile(
    r"\bintegers?\b|non-int of type 'float'|operand type.*: '(?:int|float)' and '(?:int|float)'"
    r"|QoSProfile or int, .*'float'"
)
_OF_TEXT = re.compile(
    r"(?:operand type|between instances).*'str'|concatenate str|must be str, not (?:int|float)|number, not str"
    r"|'str' object cannot be interpreted|got '?str|not '?str'?$|QoSProfile or int, .*'str'"
)
_MOST = 3  # literals that are told


def of_wrong_literal(message: str, spot: Spot, given: Sequence[ast.expr], look: Look) -> Finding | None:
    """Return the finding about the literals that make a value of the wrong type; None if there are none.

    The value is that of one of the given expressions; without any, of the operands and arguments on the line.
    """
    source = spot.file
    sources = look.sources_with(source)
    field = _FIELD.search(message)
    if field is not None:
        path = (None,) if "sequence" in field[0] else ()
        found = [leaf for value in given for leaf in _wrong(sources, source, value, field["kind"], path)]
        if field["kind"] == "float" and any(_counts(source, value) for value in given):
            return None  # it is converted where it is sent
        what = f"The field {field['field']} holds {_in_words(field['kind'])}"
        return _told(found, field["kind"], what, spot) if found else None
    wanted = "number" if _OF_TEXT.search(message) else "int" if _WHOLE.search(message) else ""
    values = [*_operands(spot)] if wanted else []
    pairs = [(value, path) for value in values for path in ((), (None,))]
    found = [leaf for value, path in pairs for leaf in _wrong(sources, source, value, wanted, path)]
    return _told(found, wanted, f"`{spot.text}` needs {_in_words(wanted)}", spot) if found else None


def _counts(source: PythonSource, value: ast.expr) -> bool:
    """Return whether a file also uses a value as an index or for range(), where only whole numbers fit."""
    text = ast.unparse(value)
    for node in source.nodes:
        match node:
            case ast.Subscript(slice=index):
                parts = [index]
            case ast.Call(func=ast.Name(id="range"), args=args):
                parts = args
            case _:
                continue
        if any(
            isinstance(n, (ast.Name, ast.Attribute)) and ast.unparse(n) == text
            for p in parts
            for n in ast.walk(p)
        ):
            return True
    return False


def _wrong(
    sources: NodeSources, source: PythonSource, value: ast.expr, wanted: str, path: tuple[int | None, ...]
) -> Iterator[Leaf]:
    """Yield the literals behind a value whose type is not the wanted one, but nearly."""
    leaves = [*Literals(sources).behind(source, value, path)]
    is_float = any(isinstance(_value(node), float) or isinstance(node, ast.BinOp) for _, node in leaves)
    if wanted == "float" and is_float:
        # A sum with a float is a float: only strings are wrong then.
        leaves = [leaf for leaf in leaves if isinstance(_value(leaf[1]), str)]
    yield from (leaf for leaf in leaves if written_as(wanted, leaf[1]) or _is_swapped(leaf, wanted))


def _is_swapped(leaf: Leaf, wanted: str) -> bool:
    """Return whether a literal of quite another type has the place of its neighbour in a call."""
    is_text = isinstance(_value(leaf[1]), str)
    return is_text != (wanted == "str") and bool(_swapped([leaf]))


def _value(node: ast.expr) -> object:
    """Return the value of a literal, with its sign; None for a division."""
    match node:
        case ast.Constant(value=value):
            return value
        case ast.UnaryOp(op=sign, operand=ast.Constant(value=int() | float() as value)):
            return -value if isinstance(sign, ast.USub) else value
    return None


def written_as(wanted: str, node: ast.expr) -> str:
    """Return a literal written for another type; empty if it has that type, or cannot be written so."""
    if isinstance(node, ast.BinOp):
        is_division = wanted == "int" and isinstance(node.op, ast.Div)
        return f"{ast.unparse(node.left)} // {ast.unparse(node.right)}" if is_division else ""
    value = _value(node)
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    text = value.strip() if isinstance(value, str) else ""
    text = text if re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?", text) else ""
    whole = text if text.lstrip("+-").isdigit() else ""
    if isinstance(value, (int, float)) and is_number:
        whole = str(int(value)) if isinstance(value, float) and value.is_integer() else ""
        text = f"{value}.0" if isinstance(value, int) else ""
    elif text and wanted == "float" and not {".", "e"} & {*text}:
        text = f"{text}.0"
    by_kind = {"int": whole, "float": text, "number": "" if is_number else text}
    return by_kind.get(wanted, repr(ast.unparse(node)) if is_number else "")


def _told(found: Sequence[Leaf], wanted: str, what: str, spot: Spot) -> Finding | None:
    """Return the finding about some literals, each with the line that it should be in."""
    leaves = {(source.shown, node.lineno, node.col_offset): (source, node) for source, node in found}
    lines: dict[tuple[str, int], list[Leaf]] = {}
    for (shown, line, _), leaf in sorted(leaves.items()):
        lines.setdefault((shown, line), []).append(leaf)
    if not 0 < len(lines) <= _MOST:
        return None
    (source, node), *_ = next(iter(lines.values()))
    texts = [
        _line_with(_swapped(rows) or [(leaf, written_as(wanted, leaf[1])) for leaf in rows])
        for rows in lines.values()
    ]
    others = [
        f"on line {row[0][1].lineno} {text}"
        for row, text in zip([*lines.values()][1:], texts[1:], strict=True)
    ]
    kind = "the result of /, a float"
    if isinstance(node, ast.Constant):
        kind = kind_in_words(type(node.value).__name__)
    kind = "a float" if kind == "a number" else kind
    is_here = (source.shown, node.lineno) == (spot.file.shown, spot.line)
    cause = f"{what}, but `{ast.unparse(node)}` is {kind}."
    cause += "" if is_here else f" Line {spot.line} fails because of this one."
    return Finding("made-wrong", cause, source.at(node), f"write {'; '.join([texts[0], *others])}")


def _swapped(leaves: Sequence[Leaf]) -> list[tuple[Leaf, str]]:
    """Return a literal and its neighbour in a call, swapped as all other calls have them; empty if they are right."""
    source, node = leaves[0]
    calls = source.calls
    for call in (call for call in calls if node in call.args):
        others = [n for n in calls if ast.unparse(n.func) == ast.unparse(call.func) and n is not call]
        patterns = {tuple(map(kind_of, other.args)) for other in others}
        for other in call.args:
            places = {id(node): other, id(other): node}
            new = tuple(kind_of(places.get(id(value), value)) for value in call.args)
            if other is not node and patterns == {new} and kind_of(other):
                return [((source, node), ast.unparse(other)), ((source, other), ast.unparse(node))]
    return []


def _line_with(changes: Sequence[tuple[Leaf, str]]) -> str:
    """Return the line of some literals with the right ones in their places."""
    (source, first), text = changes[0]
    lines = source.text.encode().splitlines(keepends=True)
    for (_, node), new in sorted(changes, key=lambda change: -change[0][1].col_offset):
        lines = Edit(node, new).applied(lines)
    if (first.end_lineno or first.lineno) > first.lineno:
        return f"`{text}` instead of `{ast.unparse(first)}`"
    copied = PythonSource(source.name, source.shown, b"".join(lines).decode())
    return f"`{Spot(copied, first.lineno).text.partition('  #')[0]}`"


def _operands(spot: Spot) -> Iterator[ast.expr]:
    """Yield the values that are combined, compared or passed on a line, or in the part that Python marks."""
    marked = spot.marked
    nodes = [*ast.walk(marked)] if marked else [n for line in spot.lines for n in Spot(spot.file, line).nodes]
    for node in nodes:
        match node:
            case ast.BinOp(left=left, right=right):
                yield from (left, right)
            case ast.Compare(left=left, comparators=others):
                yield from (left, *others)
            case ast.AugAssign(target=ast.Name() | ast.Attribute() as target, value=value):
                yield from (target, value)
            case ast.Call(args=args, keywords=keywords) if marked is None or node is marked:
                yield from (*args, *(keyword.value for keyword in keywords))
            case ast.Subscript(slice=index):
                yield index
            case ast.UnaryOp(operand=operand):
                yield operand


def _in_words(kind: str) -> str:
    words = {"int": "a whole number", "float": "a float", "str": "a string", "number": "a number"}
    return words.get(kind) or with_article(kind)
