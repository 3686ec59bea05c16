"""Which parts of an assignment have no node of their own, because it already plays another part."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

Node = tuple[str, str, str]  # its program, its full name, and its part where two nodes have that name


def doubled(players: Mapping[str, Sequence[Node]], targets: Mapping[str, str]) -> frozenset[str]:
    """Return the parts that share their node with an earlier part.

    A node that plays several parts counts once, however many programs start it: it is known by its name, or
    by the function that its programs run, and one that plays all parts by that alone.

    Args:
        players: by part, the nodes that play it best.
        targets: by program, the `package.module:function` that it runs.
    """
    parts: dict[Node, list[str]] = {}
    for name, nodes in players.items():
        for node in nodes:
            parts.setdefault(node, []).append(name)
    is_whole = {node: len(players) > 2 and len(played) == len(players) for node, played in parts.items()}

    def first(node: Node) -> Node:
        """Return the first node that is the same one, started by whatever program."""
        played, target = parts[node], targets.get(node[0])
        if len(played) < 2:
            return node
        return next(
            other
            for other, its in parts.items()
            if its == played
            and (is_whole[node] or other[1] == node[1] or bool(target and target == targets.get(other[0])))
        )

    choices = [[*dict.fromkeys(map(first, nodes))] for nodes in players.values()]
    best = max(itertools.product(*choices), key=lambda nodes: len({*nodes}))
    return frozenset(name for number, name in enumerate(players) if best[number] in best[:number])
