"""What conditions compare with known values: names, attributes, and what is computed from them."""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Iterable
from typing import Any

from ros2lab.diagnose.sources.python_source import walk
from ros2lab.grading.code.cases import Given, leaves, text_of


class Comparisons:
    """What some conditions compare with known values, and use for nothing else.

    Args:
        expressions: the conditions.
        values: the values that an expression may have.
        is_computed: whether an expression is computed from what is not known, in a way of which something is.

    Attributes:
        constants: by source text, the values with which something is compared.
        computed: by source text, what of it is computed.
    """

    def __init__(
        self,
        expressions: Iterable[ast.expr],
        values: Callable[[ast.expr], Collection[Any]],
        is_computed: Callable[[ast.expr], bool],
    ) -> None:
        self._values = values
        self._is_computed = is_computed
        self.constants: dict[str, list[Any]] = {}
        self.computed: dict[str, ast.expr] = {}
        opaque = set[str]()
        waiting = [*expressions]
        while waiting:
            match waiting.pop():
                case ast.BoolOp(values=parts):
                    waiting += parts
                case ast.UnaryOp(op=ast.Not(), operand=inner):
                    waiting.append(inner)
                case ast.Name() | ast.Attribute() as leaf if not _calls(leaf):
                    self.constants.setdefault(text_of(leaf), [])
                case ast.Compare(left=left, comparators=[right]) as whole:
                    if not self._enter(left, right):
                        opaque |= {text_of(leaf) for leaf in leaves(whole)}
                case expression:
                    opaque |= {text_of(leaf) for leaf in leaves(expression)}
        for name in opaque & {*self.constants}:
            del self.constants[name]
        self.computed = {name: whole for name, whole in self.computed.items() if name in self.constants}

    def _enter(self, left: ast.expr, right: ast.expr) -> bool:
        """Enter a comparison; return whether it compares something with itself or with known values."""
        for operand, opposite in ((left, right), (right, left)):
            name = text_of(operand)
            if self._is_computed(operand):
                self.computed[name] = operand
            elif not isinstance(operand, (ast.Name, ast.Attribute)) or _calls(operand):
                continue
            if name == text_of(opposite):
                self.constants.setdefault(name, [])
                return True
            values = self._values(opposite)
            if not any(isinstance(value, Given) for value in values):
                self.constants.setdefault(name, []).extend(values)
                return True
        return not [*leaves(left), *leaves(right)]


def _calls(leaf: ast.expr) -> bool:
    """Return whether an expression contains a call."""
    return any(isinstance(node, ast.Call) for node in walk(leaf))
