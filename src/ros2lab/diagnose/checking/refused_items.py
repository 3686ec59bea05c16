"""Lists that a call takes, but for some of their items: the type checker is asked about each item alone."""

from __future__ import annotations

import ast
import builtins
import keyword

from ros2lab.diagnose.checking.checked_copies import checked
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
    free = sorted(names_bound(own_nodes(spot.function or source.tree)) - names_read(source.nodes))
    alone = ["", *(f"reveal_type({ast.unparse(item)})" for item in value.elts), *free]
    least, *counts = [
        (
            sum(row.said.startswith(said.partition(": Expected")[0]) for row in rows),
            "".join(kinds_in(rows)[:1]),
        )
        for rows in checked(source, [Edit(value, f"[{item}]").of(source) for item in alone])
    ]
    pythons = {*dir(builtins)} - {*keyword.kwlist, *source.names} - names_bound(source.nodes)
    kinds = {
        ast.unparse(item): plain(kind)
        for item, (n, kind) in zip(value.elts, counts, strict=False)
        if n > least[0]
    }
    if not kinds:
        return None
    fitting = [name for name, (n, _) in zip(free, counts[len(value.elts) :], strict=True) if n <= least[0]]
    told = [
        f"`{t}` is {f'the {t} of Python itself' if t in pythons else k.removesuffix(', in brackets')}"
        for t, k in kinds.items()
    ]
    names, (item, first) = " and ".join(kinds), next(iter(kinds.items()))
    fix = f"remove {names} from the list, or write what is meant instead"
    if len(kinds) == len(fitting) == 1:
        fix = f"write {fitting[0]} instead of {names}"
    elif first.startswith("the class"):
        fix = f"write {item}(...), with what it needs in the parentheses, instead of {item}"
    elif first.startswith("the string"):
        fix = f"remove {names} from the list; code that is to be left out is marked with # instead of quotes"
    return f"Not every item of this list is one that {function} takes: {in_a_row(told)}.", fix
