"""What a condition is."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class Condition:
    """Something that holds or not, known only while launching."""

    def __init__(self, *, predicate: Callable[[LaunchContext], bool] | None = None) -> None:
        self._predicate = predicate

    def describe(self) -> str:
        """Return a text for people."""
        return repr(self)

    def evaluate(self, context: LaunchContext) -> bool:
        """Return whether it holds."""
        return self._predicate is not None and self._predicate(context)
