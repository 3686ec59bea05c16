"""Comparisons with a value of a type that the other side never has: the type checker is asked what that has."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from ros2lab.diagnose.checking.checked_copies import Row, checked
from ros2lab.diagnose.checking.trials import UNKNOWN_TYPE, Edit, message_annotations
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource

# How the type checker writes the types, and what each is in plain words; of what is written otherwise nothing is told.
_FAMILIES = (
    (
        "a number",
        re.compile(r"int|float|bool|Literal\[(?:True|False|-?[\d.]+)(?:, ?(?:True|False|-?[\d.]+))*\]"),
    ),
    ("a string", re.compile(r"str|Literal\[\".*\"\]")),
    ("bytes", re.compile(r"bytes|bytearray|Literal\[b\".*\"\]")),
    ("a list", re.compile(r"list\[.*\]")),
    ("a tuple", re.compile(r"tuple\[.*\]")),
    ("a dict", re.compile(r"dict\[.*\]")),
    ("a set", re.compile(r"set\[.*\]")),
    ("None", re.compile(r"None")),
    ("a function", re.compile(r"(?:def|bound method|<method-wrapper|<wrapper-descriptor) .*")),
)
_OBJECT = re.compile(r"[A-Z]\w*")
_NUMBER = re.compile(r"\s*[-+]?\d+(\.\d+)?\s*")


@dataclass(frozen=True)
class _Compared:
    """A side of a comparison, and the constants with which it is compared, all of one family.

    Attributes:
        node: the whole comparison.
        side: what is not a constant.
        constants: as above.
        is_equal: whether it asks for what is equal, and not for what is not.
    """

    node: ast.Compare
    side: ast.expr
    constants: Sequence[ast.Constant]
    is_equal: bool


def compared_types(look: Look, known: Collection[str]) -> Iterator[Finding]:
    """Yield comparisons that are always false, or always true, because of what is compared.

    Args:
        look: the workspace.
        known: places of which something is told already.
    """
    for package in look.packages:
        sources = look.sources(package)
        for source in sources.sources.values():
            asked = [*_comparisons(source)] if source.path and not source.fault else []
            asked = [one for one in asked if source.at(one.node) not in known]
            if asked:
                yield from _told(sources, source, asked, _kinds(source, asked, look))


def _comparisons(source: PythonSource) -> Iterator[_Compared]:
    for node in source.nodes:
        match node:
            case ast.Compare(left=left, ops=[ast.Eq() | ast.NotEq() as how], comparators=[right]):
                pairs = [(left, [right]), (right, [left])]
            case ast.Compare(
                left=left,
                ops=[ast.In() | ast.NotIn() as how],
                comparators=[ast.Tuple(elts=elts) | ast.List(elts=elts) | ast.Set(elts=elts)],
            ):
                pairs = [(left, elts)]
            case _:
                continue
        for side, others in pairs:
            constants = [one for one in others if isinstance(one, ast.Constant)]
            families = {_family_of(one.value) for one in constants}
            is_asked = len(constants) == len(others) and len(families) == 1 and "" not in families
            if is_asked and not isinstance(side, ast.Constant):
                yield _Compared(node, side, constants, isinstance(how, (ast.Eq, ast.In)))


def _kinds(source: PythonSource, asked: Sequence[_Compared], look: Look) -> list[str]:
    """Return of which types the sides are, as the type checker writes them; nothing where it does not tell."""
    lines = source.text.encode().splitlines(keepends=True)
    edits = [*message_annotations(source, look)]
    for one in asked:
        written = ast.get_source_segment(source.text, one.side) or ast.unparse(one.side)
        edits.append(Edit(one.side, f"reveal_type({written})"))
    for edit in sorted(edits, key=lambda one: (one.node.lineno, one.node.col_offset), reverse=True):
        lines = edit.applied(lines)
    rows: list[Row] = checked(source, [b"".join(lines)])[0]
    kinds = [re.sub(r"^.*?`(.*)`$", r"\1", row.said) for row in rows if row.rule == "revealed-type"]
    return kinds if len(kinds) == len(asked) else []


def _told(
    sources: NodeSources, source: PythonSource, asked: Sequence[_Compared], kinds: Sequence[str]
) -> Iterator[Finding]:
    own = {one.rpartition(".")[2] for one in sources.classes}
    in_order = sorted(asked, key=lambda one: (one.side.lineno, one.side.col_offset))
    for one, kind in zip(in_order, kinds, strict=False):
        parts = kind.replace("*", "").split(" | ")
        families = {_family(part, own) for part in parts}
        wanted = _family_of(one.constants[0].value)
        if "" in families or wanted in families:
            continue
        if wanted != "a string" and any(_OBJECT.fullmatch(part) for part in parts):
            continue  # an object may be equal to a number
        text = ast.unparse(one.side)
        cause = (
            f"`{text}` is {' or '.join(sorted(families))}, but {ast.unparse(one.constants[0])} is {wanted}, "
            f"so `{ast.unparse(one.node)}` is {'never' if one.is_equal else 'always'} true."
        )
        yield Finding("never-equal", cause, source.at(one.node), _fix(one, families, wanted))


def _family(kind: str, own: Collection[str]) -> str:
    """Return what a type is in plain words; empty if that is not known, or if its objects may be equal to anything."""
    if UNKNOWN_TYPE.search(kind):
        return ""
    found = next((name for name, pattern in _FAMILIES if pattern.fullmatch(kind)), "")
    return found or (
        f"an instance of the class {kind}" if _OBJECT.fullmatch(kind) and kind not in own else ""
    )


def _family_of(value: object) -> str:
    """Return what a constant is in plain words; empty for None and the like."""
    if isinstance(value, (bool, int, float)):
        return "a number"
    if isinstance(value, str):
        return "a string"
    return "bytes" if isinstance(value, bytes) else ""


def _fix(one: _Compared, families: Collection[str], wanted: str) -> str:
    """Say how the sides become comparable."""
    text, value = ast.unparse(one.side), one.constants[0].value
    if len(one.constants) > 1 or len(families) > 1:
        return f"compare what is {wanted} on both sides"
    sign, word = ("==", "in") if one.is_equal else ("!=", "not in")
    match (next(iter(families)), value):
        case "a function", _:
            fix = f"write {text}() instead of {text}"
        case "an instance of the class Parameter", _:
            fix = f"write {text}.value instead of {text}"
        case "a number", str() if _NUMBER.fullmatch(value):
            fix = f"write `{text} {sign} {value.strip()}`"
        case "a number", str():
            fix = f"write `str({text}) {sign} {value!r}`"
        case "a string", bytes():
            fix = f"write `{text} {sign} {value.decode(errors='replace')!r}`"
        case "a string", _:
            fix = f"write `{text} {sign} {str(value)!r}`"
        case "bytes", str():
            fix = f"write `{text} {sign} {value.encode()!r}`"
        case (("a list" | "a tuple" | "a set" | "a dict"), _):
            fix = f"write `{value!r} {word} {text}`, or compare one of its items"
        case _:
            fix = f"compare what is {wanted} on both sides"
    return fix
