"""An item of a list that a function is given which has another form than the function takes."""

from __future__ import annotations

import ast
import re
from collections.abc import Sequence

from ros2lab.diagnose.checking.checked_copies import checked
from ros2lab.diagnose.checking.edits import Edit
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.spots import Spot, kind_in_words
from ros2lab.diagnose.sources.python_source import PythonSource, given_to
from ros2lab.diagnose.sources.spelling import with_article

_Several = ast.List | ast.Tuple
_MOST = 20  # items that are tried one by one


def of_named_item(message: str, spot: Spot) -> Finding | None:
    """Return the item of the only list given on a line at the index that an error names; None if there is none."""
    # What is read past its end has an index, too, and there Python itself stops on this line.
    index = None if spot.is_innermost else re.search(r"\bindex (\d+)\b", message)
    given = [spot.file.written(value) for call in spot.calls for value in given_to(call)]
    lists = [value for value in given if isinstance(value, _Several)]
    if index is None or len(lists) != 1 or int(index[1]) >= len(lists[0].elts):
        return None
    return _told(spot.file, lists[0], int(index[1]), f": {message.rstrip('.')}")


def of_other_item(source: PythonSource, given: ast.expr) -> Finding | None:
    """Return the first item of a list that a call is given to which the type checker objects, if not to all; else None."""
    if not isinstance(given, _Several) or not 1 < len(given.elts) <= _MOST:
        return None
    alone = [type(given)([item], ast.Load()) for item in given.elts]
    rows = checked(source, [Edit(given, ast.unparse(one)).of(source) for one in alone])
    bad = [n for n, said in enumerate(rows) if any(row.line == given.lineno for row in said)]
    return _told(source, given, bad[0]) if 0 < len(bad) < len(alone) else None


def _told(source: PythonSource, whole: _Several, index: int, said: str = "") -> Finding:
    item, others = whole.elts[index], [*whole.elts[:index], *whole.elts[index + 1 :]]
    text, like = ast.unparse(item), next((other for other in others if _form(other) != _form(item)), None)
    cause = f"`{text}`, item {index} of this list (the first one is item 0), is {_form(item)}"
    cause += f", but item {whole.elts.index(like)} is {_form(like)}." if like else f"{said}."
    sizes = [len(other.elts) for other in others if isinstance(other, ast.Tuple)]
    if isinstance(item, ast.Constant) and (sizes or not others):
        cause = f"{cause[:-1]}: a comma makes a tuple, and parentheses alone do not."
    fix = _in_form(item, like, max(sizes, key=sizes.count, default=1))
    fix = f"write `{fix}` instead of `{text}`" if fix else ""
    fix += ", with the value that belongs in place of ''" if "''" in fix and "''" not in text else ""
    return Finding("made-wrong", cause, source.at(item), fix)


def _in_form(item: ast.expr, like: ast.expr | None, size: int) -> str:
    """Return an item in the form of another one, with empty texts for what it lacks; empty if that form is not known."""
    values: Sequence[ast.expr] = item.elts if isinstance(item, ast.Tuple) else [item]
    texts = [*map(ast.unparse, values)]
    if isinstance(like, ast.Call) and isinstance(item, ast.Tuple):
        names = [*[""] * len(like.args), *(f"{keyword.arg}=" for keyword in like.keywords)]
        given = ", ".join(map("".join, zip(names, texts, strict=False)))
        return f"{ast.unparse(like.func)}({given})" if len(names) == len(texts) else ""
    if isinstance(like, ast.Tuple) or (like is None and isinstance(item, ast.Constant)):
        texts = [*texts, *["''"] * size][:size]
        return f"({', '.join(texts)}{',' * (size == 1)})"
    return ""


def _form(value: ast.expr) -> str:
    match value:
        case ast.Tuple(elts=items):
            return f"a tuple of {len(items)}"
        case ast.Constant(value=constant):
            return kind_in_words(type(constant).__name__)
        case ast.Call(func=function):
            return with_article(ast.unparse(function).rpartition(".")[2])
    return with_article(type(value).__name__.lower())
