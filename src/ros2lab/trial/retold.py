"""Recognizes findings about a run that only show again what reading the files has found."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator

from ros2lab.diagnose.finding import Finding, keeps_from_working
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import Spot, spot_at
from ros2lab.diagnose.sources.node_source import is_self_attribute
from ros2lab.diagnose.sources.python_source import PythonSource

# What is seen of a publisher or a subscription when something else in its code is wrong.
_EFFECTS = frozenset(("publishes-nothing", "message-empty", "word-unanswered"))
_DEEPEST = 3  # methods that are followed from one to the next


def without_retold(found: Iterable[Finding], read: Iterable[Finding], look: Look) -> Iterator[Finding]:
    """Yield the findings about a run that no finding about the files explains.

    A publisher without messages is explained by what is wrong where it publishes, or with what calls that.

    Args:
        found: what was seen to be wrong.
        read: what reading has found.
        look: the workspace.
    """
    read = [*read]
    causes = [finding for finding in read if keeps_from_working(finding)]
    apart = {_file(known) for known in read if known.code == "environment-apart"}
    for finding in found:
        if finding.code == "no-node" and _file(finding) in apart:
            continue  # it is in another domain than the one that is watched
        if len(finding.about) > 1 and any({*finding.about} <= {*known.about} for known in read):
            continue  # two topics that do not meet, of which reading has said why
        there = [cause for cause in causes if _file(cause) == _file(finding)]
        if finding.code not in _EFFECTS or not any(_is_behind(cause, finding, look) for cause in there):
            yield finding


def _file(finding: Finding) -> str:
    return finding.place.partition(":")[0]


def _is_behind(cause: Finding, effect: Finding, look: Look) -> bool:
    """Return whether a fault is at a line that uses what an effect is about, or that leads there."""
    made, wrong = spot_at(effect.place, look), spot_at(cause.place, look)
    if made.source is None or wrong.source is None:
        return False
    # The line names the publisher, or the callback of the subscription.
    names = {node.attr for line in made.lines for node in _attributes(Spot(made.source, line).nodes)}
    named = {node.attr for line in wrong.lines for node in _attributes(Spot(wrong.source, line).nodes)}
    function = wrong.function
    if function is not None and function.name != "__init__":
        named |= {function.name, *(node.attr for node in _attributes(ast.walk(function)))}
    return not names.isdisjoint(_reached(named, wrong.source))


def _attributes(nodes: Iterable[ast.AST]) -> Iterator[ast.Attribute]:
    yield from (node for node in nodes if is_self_attribute(node) and not node.attr.startswith("create_"))


def _reached(names: set[str], source: PythonSource) -> set[str]:
    """Return the attributes that are named, with those that the named methods use."""
    methods = {node.name: node for node in source.nodes if isinstance(node, ast.FunctionDef)}
    for _ in range(_DEEPEST):
        inner = (methods[name] for name in names if name in methods)
        names = names.union(*({node.attr for node in _attributes(ast.walk(method))} for method in inner))
    return names
