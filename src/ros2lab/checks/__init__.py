"""Instant feedback on an exercise: one file a lesson, one function an exercise.

A check says that the answer is right, or raises `CheckError` with what was expected, what was found, and a hint.
"""

from __future__ import annotations

from typing import Any


class CheckError(Exception):
    """An answer is not right yet; the text says what was expected, what was found, and a hint."""

    def __init__(self, expected: str, found: str, hint: str) -> None:
        super().__init__(f"Not yet. Expected: {expected}. Found: {found}. Hint: {hint}")

    def _render_traceback_(self) -> list[str]:
        # IPython shows this in place of a traceback through the check's own code.
        return [str(self)]


def answer_of(function: Any, *arguments: Any, call: str) -> Any:
    """Call a student's function.

    Args:
        function: what the student wrote.
        arguments: what it is called with.
        call: the call as the student would write it.

    Raises:
        CheckError: if it cannot be called, or raises.
    """
    if not callable(function):
        raise CheckError(
            "a function", repr(function), "give the name of the function, without its parentheses."
        )
    try:
        return function(*arguments)
    except Exception as error:
        raise CheckError(
            f"{call} returns a value",
            f"it raised {type(error).__name__}: {error}",
            "run the cell that tries it, and read the last line of the traceback.",
        ) from error
