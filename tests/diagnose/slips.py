"""Slips of typing in right Python: one sign, quote, letter or indentation wrong, wherever it may be."""

from __future__ import annotations

import ast
import io
import keyword
import random
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Slip:
    """A slip in a file.

    Attributes:
        kind: what has happened, such as `comma`.
        line: the number of the (first) line that is wrong.
        text: the file with it.
    """

    kind: str
    line: int
    text: str

    @property
    def is_readable(self) -> bool:
        """Whether Python reads the file all the same."""
        try:
            ast.parse(self.text)
        except SyntaxError:
            return False
        return True


def unreadable(text: str, count: int, seed: int) -> list[Slip]:
    """Return so many slips of all kinds after which Python cannot read a file, by chance but always the same."""
    chance, by_kind = random.Random(seed), dict[str, list[Slip]]()
    for slip in [*_of_signs(text), *_of_indentation(text)]:
        by_kind.setdefault(slip.kind, []).append(slip)
    for slips in by_kind.values():
        chance.shuffle(slips)
    found = list[Slip]()
    while len(found) < count and any(by_kind.values()):
        for slips in by_kind.values():
            while slips:
                if not (slip := slips.pop()).is_readable:
                    found.append(slip)
                    break
    return found[:count]


def _of_signs(text: str) -> Iterator[Slip]:
    lines = text.splitlines(keepends=True)
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        (row, begin), (last, end) = token.start, token.end
        word, line = token.string, lines[row - 1] if row <= len(lines) else ""
        if row != last or not word.strip():
            continue
        changed = dict[str, str]()
        if word in ("(", ")", "[", "]", "{", "}"):
            changed["bracket"] = ""
        elif word in (",", ".", ":"):
            changed[{",": "comma", ".": "dot", ":": "colon"}[word]] = ""
        elif word in ("=", "=="):
            changed["equals"] = {"=": "==", "==": "="}[word]
        elif token.type == tokenize.STRING and len(word) > 2 and word[0] in "'\"" and word[:3] != 3 * word[0]:
            changed |= {"closing quote": word[:-1], "opening quote": word[1:], "no quotes": word[1:-1]}
        elif keyword.iskeyword(word) and len(word) > 2:
            half = len(word) // 2
            changed["keyword"] = word[: half - 1] + word[half] + word[half - 1] + word[half + 1 :]
        for kind, new in changed.items():
            wrong = [*lines[: row - 1], f"{line[:begin]}{new}{line[end:]}", *lines[row:]]
            yield Slip(kind, row, "".join(wrong))


def _of_indentation(text: str) -> Iterator[Slip]:
    lines = text.splitlines(keepends=True)
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.stmt):
            continue
        first, last = node.lineno, node.end_lineno or node.lineno
        if first == last:
            yield Slip(
                "deeper", first, "".join([*lines[: first - 1], f"    {lines[first - 1]}", *lines[first:]])
            )
        is_method = isinstance(node, ast.FunctionDef) and node.col_offset > 0 and not node.decorator_list
        if lines[first - 1].startswith("    ") and (first == last or is_method):
            moved = [line.removeprefix("    ") for line in lines[first - 1 : last]]
            kind = "method moved out" if is_method else "less deep"
            yield Slip(kind, first, "".join([*lines[: first - 1], *moved, *lines[last:]]))
