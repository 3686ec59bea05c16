"""The texts that a program compares its input with, or looks for in it.

It does so by `==`, by `case`, as a key of a dictionary, by `in`, or by a method of `str` or a function of `re`.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import Any

from ros2lab.diagnose.nodes.topic_faults import End, ends_of, word_sources
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource, last_name
from ros2lab.grading.code.running import running

LONGEST, MOST = 30, 100  # characters, texts

# What looks for a text in another one, in Python's library: of `str`, and of `re`.
_OF_STR = frozenset(("startswith", "endswith", "find", "rfind", "index", "rindex", "count", "__contains__"))
_OF_RE = frozenset(("match", "fullmatch", "search", "findall", "finditer"))
LOOKS_FOR = _OF_STR | _OF_RE
_NO_LETTERS = re.compile(
    r"\\.|\(\?\w*[:)]?"
)  # what a pattern has letters for that are no letters of the text
_WORD = re.compile(r"[^\W\d_][\w -]*")


def compared(code: Iterable[ast.AST]) -> list[str]:
    """Return the short texts that some code, such as all that runs, compares something with."""
    return sorted({text for node in code for text in _texts(node)})[:MOST]


def _texts(node: ast.AST) -> Iterator[str]:
    values: list[ast.expr | None] = []
    match node:
        case ast.Compare(left=left, ops=ops, comparators=others):
            if all(isinstance(operator, (ast.Eq, ast.NotEq)) for operator in ops):
                values = [left, *others]
            elif isinstance(ops[0], (ast.In, ast.NotIn)):
                values = [left]  # what is in a constant tuple is not told apart
        case ast.MatchValue(value=value):
            values = [value]
        case ast.Dict(keys=keys):
            values = keys
        case ast.Call(func=ast.Attribute(attr=name), args=[first, *_]) if name in LOOKS_FOR:
            values = [first]
    for expression in values:
        match expression:
            case ast.Constant(value=str(text)) if len(text) <= LONGEST:
                yield from [text] if not _is_pattern(node) else _words_of(text)


def _is_pattern(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in _OF_RE


def _words_of(pattern: str) -> list[str]:
    """Return the word in a pattern; none if there are several, which it does not tell apart."""
    words = _WORD.findall(_NO_LETTERS.sub("\0", pattern))
    return words if len(words) == 1 else []


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
