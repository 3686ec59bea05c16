"""Python files of libraries."""

from __future__ import annotations

import ast
import contextlib
import warnings
from functools import cached_property

from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.static_value import bound


class LibrarySource(PythonSource):
    """A Python file of a library, which works: its tree has no marks, and nothing is said of it."""

    @cached_property
    def tree(self) -> ast.Module:
        """The parsed file; empty if this Python cannot parse it."""
        with warnings.catch_warnings(), contextlib.suppress(SyntaxError, ValueError, RecursionError):
            warnings.simplefilter("ignore")
            tree = self.parsed()
            bound(tree)
            return tree
        return ast.Module([], [])
