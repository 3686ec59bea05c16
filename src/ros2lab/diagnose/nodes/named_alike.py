"""Nodes of different programs that have the same name."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.made_unseen import may_run
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource


def named_alike(sources: NodeSources, alternatives: Collection[frozenset[str]]) -> Iterator[Finding]:
    """Yield node names that are used in two files which executables run; no launch file may start one of the two."""
    first: dict[str, tuple[PythonSource, ast.AST]] = {}
    for source in sources.sources.values():
        for owner, function, node in sources.scoped(source):
            if not isinstance(node, ast.Call) or not sources.makes_node(source, owner, function, node):
                continue
            if not may_run(sources, source, owner):
                continue
            name = sources.value(source, node.args[0] if node.args else None)
            before = first.setdefault(name, (source, node)) if isinstance(name, str) else (source, node)
            stems = [file.name.rpartition(".")[2] for file in (before[0], source)]
            # Interchangeable nodes have neither file's name, or one file adds a word, as in driver_sim.
            is_either = frozenset((before[0].name, source.name)) in alternatives
            if before[0] is not source and name in stems and not _is_variant(*stems) and not is_either:
                # The node whose file has a different name was copied.
                here, place = before if source.name.endswith(f".{name}") else (source, node)
                stem = here.name.rpartition(".")[2]
                cause = f"The nodes in {before[0].shown} and {source.shown} have the same name {name!r}, so if both run, they cannot be told apart."
                fix = f"write another name here, such as {stem if stem != name else f'{stem}_2'!r}"
                yield Finding("name-twice", cause, here.at(place), fix)


def _is_variant(stem: str, other: str) -> bool:
    """Return whether one name has all the words of the other and at least one more."""
    words, others = (set(re.findall("[A-Za-z]+", name)) for name in (stem, other))
    return words < others or others < words
