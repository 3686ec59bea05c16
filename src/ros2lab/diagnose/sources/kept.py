"""Keeps what is found of a syntax node with the node: rules ask often, and trees never change."""

from __future__ import annotations

import ast
from collections.abc import Callable
from functools import wraps
from typing import TypeVar

_Found = TypeVar("_Found")


def kept(find: Callable[[ast.AST], _Found]) -> Callable[[ast.AST], _Found]:
    """Decorate a function of a node such that it looks only once."""
    key = f"_{find.__name__}_found"

    @wraps(find)
    def asked(node: ast.AST) -> _Found:
        found: _Found | None = node.__dict__.get(key)
        if found is None:
            found = node.__dict__[key] = find(node)
        return found

    return asked
