"""Strings with placeholders that nothing fills in, or only a part: a missing f, doubled braces, `'%d' % a * b`."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator

from ros2lab.diagnose.code.bound_names import bound_in, global_names
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.joined_texts import VALUE, text_of
from ros2lab.diagnose.sources.node_source import CREATORS, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, PythonSource, contains, given_to, walk
from ros2lab.diagnose.sources.uses import is_log

# Braces after `$`, `^` or a command of TeX belong to another language.
_FIELD = re.compile(r"(?:[$^]|\\\w+)\{|\{([A-Za-z_][\w.]*(?:\(\))?)(?:[:!][^{}]*)?\}")
# What ROS fills in itself, in a name without spaces.
_BY_ROS = re.compile(r"[\w/~{}]*\{(?:node|ns|namespace)\}[\w/~{}]*")
# The methods of a node that are given the name of something in ROS.
_NAMING = frozenset((*CREATORS, "create_rate", "declare_parameter", "get_parameter"))
_EMPTY = re.compile(r"\{(?:\d*|\d*:[^{}]*)\}|%[-+ 0]*\d*(?:\.\d+)?[dsif]\b")


def placeholder_faults(source: PythonSource) -> Iterator[Finding]:
    """Yield strings that show a placeholder where its value was meant."""
    filled = {id(n) for node in source.nodes for n in _filled_in(node)}
    is_formatted = any(getattr(n, "attr", "") in ("format", "format_map", "substitute") for n in source.nodes)
    read = {id(n) for node in source.nodes for n in _read_by_people(node)}
    for node in source.nodes if not is_formatted else ():
        if id(node) not in read:
            continue
        if isinstance(node, ast.JoinedStr):
            texts = [value.value for value in node.values if isinstance(value, ast.Constant)]
            given = {ast.unparse(v.value) for v in node.values if isinstance(v, ast.FormattedValue)}
            fields = _meant(source, node, "".join(map(str, texts)))
            # A text with the value itself as well shows its name on purpose.
            for name in fields[:1] if given.isdisjoint(fields) else ():
                cause = f"In an f-string, doubled braces mean literal braces, so {{{name}}} remains as it is and no value is filled in."
                fix = f"write {{{name}}} instead of {{{{{name}}}}}"
                yield Finding("text-not-filled", cause, source.at(node), fix)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in filled:
            for name in _meant(source, node, node.value)[:1]:
                cause = f"The f before the string is missing, so {{{name}}} remains as it is and no value is filled in."
                fix = f"write f before the quote: f{node.value[:40]!r}"
                yield Finding("text-not-filled", cause, source.at(node), fix)
    for text in _shown(source.nodes):
        if (found := _EMPTY.search(str(text.value))) and id(text) not in filled:
            cause = f"{found[0]} is shown as it is: nothing says which value belongs there."
            fix = f"write f before the quote, and the value's name in braces instead of {found[0]}"
            yield Finding("text-not-filled", cause, source.at(text), fix)


def repeated(source: PythonSource, node: ast.BinOp) -> Iterator[Finding]:
    """Yield a text that `*` repeats as a whole, although it tells of the number that was to be multiplied.

    It does if that is written there, or if the text has words and nothing that would part it from the next.
    """
    match node:
        case ast.BinOp(ast.BinOp(ast.Constant(value=str(text)), ast.Mod(), value), ast.Mult()):
            is_sentence = re.search(r"[^\W\d_]", VALUE.sub("", text)) and not re.search(r"[\s,;|]$", text)
            number = value.value if isinstance(value, ast.Constant) else 0 if is_sentence else ""
            if isinstance(number, (int, float)) and (better := regrouped(node)):
                cause = f"`%` comes before `*` here: it puts {ast.unparse(value)} in the text, and `*` repeats the whole text."
                yield Finding("text-not-filled", cause, source.at(node), f"write `{better}`")


def regrouped(node: ast.AST) -> str:
    """Return `'...' % (a * b)` for `'...' % a * b`, and for values behind a comma; empty where `%` gets all that is there."""
    given = getattr(node, "elts", None) or getattr(node, "args", None) or [node]
    if not isinstance(node, (ast.Tuple, ast.Call, ast.BinOp)) or (parts := _template(given[0])) is None:
        return ""
    text, value = parts
    if len(given) > 1:
        value = ast.Tuple([value, *given[1:]], ast.Load())
    elif given[0] is not node or value is getattr(node, "right", None):
        return ""
    return ast.unparse(ast.BinOp(text, ast.Mod(), value))


def _template(node: ast.expr) -> tuple[ast.expr, ast.expr] | None:
    """Return a text, and what was meant to be put there of all that is reckoned with it; None without a single value."""
    match node:
        case ast.BinOp(ast.Constant(value=str()) as text, ast.Mod(), value):
            return None if isinstance(value, (ast.Tuple, ast.Dict)) else (text, value)
        case ast.BinOp(left, operator, right) if not text_of(right) and not isinstance(right, ast.JoinedStr):
            return (parts[0], ast.BinOp(parts[1], operator, right)) if (parts := _template(left)) else None
    return None


def _meant(source: PythonSource, node: ast.expr, text: str) -> list[str]:
    """Return the names in braces in a string, if each is known where it stands; other braces mean themselves."""
    fields = [] if _BY_ROS.fullmatch(text) else _FIELD.findall(text)
    known = _names(source, node.lineno) if all(fields) else frozenset()
    are_known = all(known.intersection(_beginnings(name)) for name in fields)
    return fields if are_known and text.count("{") == len(fields) else []


def _beginnings(name: str) -> set[str]:
    """Return what must be known for a name such as `count` or `self.count.real`."""
    first, *others = name.replace("()", "").split(".")
    return {f"self.{others[0]}" if first == "self" and others else first}


def _names(source: PythonSource, line: int) -> frozenset[str]:
    """Return the names that are known on a line, such as `count` and `self.count`."""
    own = source.class_at(line)
    found = {f"self.{n.attr}" for n in walk(own) if is_self_attribute(n)} if own else set()
    functions = [node for node in source.nodes if isinstance(node, Function) and contains(node, line)]
    for function in functions:
        found |= bound_in(function) | {n.arg for n in ast.walk(function.args) if isinstance(n, ast.arg)}
    return global_names(source) | found


def _read_by_people(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes of texts that are logged, raised, kept under a name, or names in ROS; others may be for a program."""
    match node:
        case ast.Call() if is_log(node):
            yield from (inner for given in node.args for inner in ast.walk(given))
        case ast.Call(func=ast.Attribute(attr=method)) if method in _NAMING:
            yield from (inner for given in given_to(node) for inner in (given, *_joined(given)))
        case ast.Raise(exc=ast.Call() as made):
            yield from ast.walk(made)
        case (
            ast.Assign(value=value)
            | ast.keyword(arg="data" | "frame_id" | "namespace", value=value)
            | ast.Return(value=value)
        ) if value:
            yield from (inner for inner in (value, *_joined(value)))


def _joined(value: ast.expr) -> Iterator[ast.expr]:
    """Yield the texts that `+` joins."""
    if isinstance(value, ast.BinOp) and isinstance(value.op, ast.Add):
        for side in (value.left, value.right):
            yield from (side, *_joined(side))


def _shown(nodes: Iterable[ast.AST]) -> Iterator[ast.Constant]:
    """Yield the string literals that are logged or put into a message unchanged."""
    for node in nodes:
        match node:
            case ast.Call(args=[ast.Constant(value=str()) as text], keywords=[]) if is_log(node):
                yield text
            case ast.Assign(targets=[ast.Attribute(attr="data")], value=ast.Constant(value=str()) as text):
                yield text
            case ast.keyword(arg="data", value=ast.Constant(value=str()) as text):
                yield text


def _filled_in(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes of strings that format() or % fills in, and of docstrings and f-strings."""
    match node:
        case ast.Call(func=ast.Attribute(value=owner, attr="format" | "format_map" | "substitute")):
            yield from ast.walk(owner)
        case ast.BinOp(op=ast.Mod()):
            yield from ast.walk(node.left)
        case ast.Expr(value=ast.Constant()) | ast.JoinedStr():
            yield from ast.walk(node)
