"""Items of a list that a function is given and does not take, although it takes a list."""

from __future__ import annotations

import ast
import builtins
import keyword
import re
from collections.abc import Sequence

from ros2lab.diagnose.checking.checked_copies import checked
from ros2lab.diagnose.checking.edits import Edit
from ros2lab.diagnose.checking.trials import kinds_in
from ros2lab.diagnose.checking.type_words import plain
from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.printed.spots import Spot, kind_in_words
from ros2lab.diagnose.sources.python_source import PythonSource, given_to, names_bound, names_read, own_nodes
from ros2lab.diagnose.sources.spelling import with_article

_Several = ast.List | ast.Tuple
_MOST, _LONGEST = 20, 60  # items that are tried one by one; letters of each


def of_named_item(message: str, spot: Spot) -> Finding | None:
    """Return the item of the only list given on a line at the index that an error names; None if there is none."""
    # What is read past its end has an index, too, and there Python itself stops on this line.
    index = None if spot.is_innermost else re.search(r"\bindex (\d+)\b", message)
    given = [spot.file.written(value) for call in spot.calls for value in given_to(call)]
    lists = [value for value in given if isinstance(value, _Several)]
    if index is None or len(lists) != 1 or int(index[1]) >= len(lists[0].elts):
        return None
    return _told(spot.file, lists[0], int(index[1]), f": {message.rstrip('.')}")


def refused_items(spot: Spot, value: ast.expr, function: str, said: str) -> tuple[Finding | None, bool]:
    """Return the items for which a list is refused, each asked alone, and whether others of it are taken.

    It is None if the list is refused as a list, or is none.

    Args:
        spot: where the list is given.
        value: the list.
        function: what is called with it, in words.
        said: what the type checker says of the list.
    """
    source = spot.file
    if not isinstance(value, _Several) or len(value.elts) > _MOST:
        return None, False
    free = sorted(names_bound(own_nodes(spot.function or source.tree)) - names_read(source.nodes))
    alone = ["", *(f"reveal_type({ast.unparse(item)})" for item in value.elts), *free]
    least, *counts = _objections(source, value, alone, said)
    bad = [n for n, (count, _) in enumerate(counts[: len(value.elts)]) if count > least[0]]
    if not bad:
        return None, False
    is_odd = len(bad) < len(value.elts)
    if is_odd and (other := _told(source, value, bad[0])).fix:
        return other, True
    pythons = {*dir(builtins)} - {*keyword.kwlist, *source.names} - names_bound(source.nodes)
    kinds = {_short(value.elts[n]): _kind(counts[n][1]) for n in bad}
    fitting = [name for name, (n, _) in zip(free, counts[len(value.elts) :], strict=True) if n <= least[0]]
    told = [f"`{t}` is {f'the {t} of Python itself' if t in pythons else k}" for t, k in kinds.items()]
    names, (item, first) = " and ".join(kinds), next(iter(kinds.items()))
    fix = f"remove {names} from the list, or write what is meant instead"
    if len(kinds) == len(fitting) == 1:
        fix = f"write {fitting[0]} instead of {names}"
    elif first.startswith("the class"):
        fix = f"write {item}(...), with what it needs in the parentheses, instead of {item}"
    elif first == "a string":
        fix = f"remove {names} from the list; code that is to be left out is marked with # instead of quotes"
    cause = f"Not every item of this list is one that {function} takes: {in_a_row(told)}."
    return Finding("argument-type", cause, source.at(value.elts[bad[0]]), fix), is_odd


def _kind(said: str) -> str:
    kind = plain(said).removesuffix(", in brackets")
    return "a string" if kind.startswith("the string ") else kind


def _short(item: ast.expr) -> str:
    text = ast.unparse(item)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _objections(
    source: PythonSource, value: _Several, alone: Sequence[str], said: str
) -> list[tuple[int, str]]:
    """Return for a list with each of some items alone how often the type checker says the same of it, and the item's type."""
    whole = "[{}]" if isinstance(value, ast.List) else "({},)"
    edits = [Edit(value, whole.format(item) if item else whole[0] + whole[-1]) for item in alone]
    like = said.partition(": Expected")[0]
    return [
        (sum(row.said.startswith(like) for row in rows), "".join(kinds_in(rows)[:1]))
        for rows in checked(source, [edit.of(source) for edit in edits])
    ]


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
