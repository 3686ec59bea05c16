"""The words and numbers that code compares what comes with: at and around these, what it does may change."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import chain
from typing import Any

from ros2lab.diagnose.nodes.topic_faults import End, ends_of, word_sources
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource, last_name
from ros2lab.grading.code.compared import compared
from ros2lab.grading.code.running import running

MOST_WORDS, MOST_NUMBERS = 6, 6  # of those in the code that are given
LARGEST = 1e6
Values = Mapping[str, Sequence[Any]]  # the `words` and `numbers`
Contents = Mapping[str, Values]  # by the last part of a topic's name; under an empty name for any other


def contents_of(sources: Iterable[PythonSource]) -> dict[str, dict[str, list[Any]]]:
    """Return what the code of some packages compares, by the last part of the name of what it subscribes to."""
    every = NodeSources({source.name: source for source in sources})
    found = {"": _values([*every.sources.values()], [*every.sources.values()])}
    for end in ends_of(every, unnamed=True):
        if not end.is_publisher and end.topic:
            found.setdefault(end.topic.rpartition("/")[2], compared_by(end))
    return found


def compared_by(end: End) -> dict[str, list[Any]]:
    """Return the words that the package of a subscription compares, and the numbers in its file."""
    return _values(word_sources(end.sources), [end.creation.source])


def _values(worded: Collection[PythonSource], numbered: Iterable[PythonSource]) -> dict[str, list[Any]]:
    texts = compared(node for _, node in running(worded))
    words = [text for text in texts if text and not text.startswith("__")]
    numbers = dict.fromkeys(chain.from_iterable(map(_numbers, numbered)))
    return {"words": words[:MOST_WORDS], "numbers": [*numbers][:MOST_NUMBERS]}


def _numbers(source: PythonSource) -> list[float]:
    """Return the numbers in a file, first those in comparisons; without queue depths, periods and the like."""
    calls = [node for node in source.nodes if isinstance(node, ast.Call)]
    given = {id(arg) for call in calls if last_name(call.func).startswith("create_") for arg in call.args}
    compares = [node for node in source.nodes if isinstance(node, ast.Compare)]
    negated = {
        id(node.operand): -1
        for node in source.nodes
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub)
    }
    found = dict[float, None]()
    for node in chain(chain.from_iterable(map(ast.walk, compares)), source.nodes):
        match node:
            case ast.Constant(value=bool()):
                pass
            case ast.Constant(value=int() | float() as number) if (
                id(node) not in given and abs(number) < LARGEST
            ):
                found[negated.get(id(node), 1) * number] = None
    return [*found]
