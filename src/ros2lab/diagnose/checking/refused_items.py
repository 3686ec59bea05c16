"""Lists that a call takes, but for some of their items: the type checker is asked about each item alone."""

from __future__ import annotations

import ast
import builtins
import keyword

from ros2lab.diagnose.checking.checked_copies import Row, checked
from ros2lab.diagnose.checking.edits import Edit
from ros2lab.diagnose.checking.trials import kinds_in
from ros2lab.diagnose.checking.type_words import plain
from ros2lab.diagnose.finding import in_a_row
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.python_source import names_bound, names_read, own_nodes


def refused_items(spot: Spot, value: ast.expr, function: str, said: str) -> tuple[str, str] | None:
    """Return cause and fix of the items for which a list is refused; None if it is refused as a list, or is none.

    Args:
        spot: where the list is given.
        value: the list.
        function: what is called with it, in words.
        said: what the type checker says of the list.
    """
    source = spot.file
    if not isinstance(value, ast.List):
        return None
    scope = own_nodes(spot.function or source.tree)
    free = sorted(names_bound(scope) - names_read(source.nodes))
    alone = ["", *(f"reveal_type({ast.unparse(item)})" for item in value.elts), *free]
    empty, *rows = checked(source, [Edit(value, f"[{item}]").of(source) for item in alone])
    least = _refusals(empty, said)
    refused = {
        ast.unparse(item): plain("".join(kinds_in(row)[:1])).removesuffix(", in brackets")
        for item, row in zip(value.elts, rows, strict=False)
        if _refusals(row, said) > least
    }
    if not refused or _refusals([*checked(source, [source.text.encode()])[0]], said) <= least:
        return None
    pythons = {*dir(builtins)} - {*keyword.kwlist, *source.names} - names_bound(source.nodes)
    words = {text: f"Python's own {text}" if text in pythons else kind for text, kind in refused.items()}
    kinds = [f"`{text}` is {kind}" for text, kind in words.items()]
    fitting = [
        name for name, row in zip(free, rows[len(value.elts) :], strict=True) if _refusals(row, said) <= least
    ]
    names = " and ".join(refused)
    fix = f"remove {names} from the list, or write what is meant instead"
    if len(refused) == 1 and "the class" in kinds[0]:
        fix = f"write {names}(...), with what it needs in the parentheses, instead of {names}"
    if len(refused) == len(fitting) == 1:
        fix = f"write {fitting[0]} instead of {names}"
    return f"Not every item of this list is one that {function} takes: {in_a_row(kinds)}.", fix


def _refusals(rows: list[Row], said: str) -> int:
    """Count the messages about the same argument of the same function."""
    argument = said.partition(": Expected")[0]
    return sum(row.said.startswith(argument) for row in rows)
