"""Instant feedback on an exercise: one file a lesson, one function an exercise.

A check says that the answer is right, or raises `CheckError` with what was expected, what was found, and a hint.
Checks look at behaviour and facts, so that every right solution passes.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, ParamSpec

from ros2lab import progress

Asked = ParamSpec("Asked")

# By exercise: the fault that was told last, and how many times in a row.
_failures: dict[str, tuple[tuple[str, str], int]] = {}


class CheckError(Exception):
    """An answer is not right yet; the text says what was expected, what was found, and a hint.

    Args:
        expected: what a right answer does or is.
        found: what this one does or is.
        hints: the first is given when this fault is first found, the next one if it is found again at once; the
            last one stays.
    """

    def __init__(self, expected: str, found: str, *hints: str) -> None:
        super().__init__(expected, found, *hints)
        self.expected, self.found, self.hints = expected, found, hints
        self.failures = 1

    def __str__(self) -> str:
        hint = self.hints[min(self.failures, len(self.hints)) - 1]
        return f"Not yet. Expected: {_ended(self.expected)} Found: {_ended(self.found)} Hint: {hint}"

    def _render_traceback_(self) -> list[str]:
        # IPython shows this in place of a traceback through the check's own code.
        return [str(self)]


class Question(NamedTuple):
    """A question with answers to choose from.

    Args:
        right: the letter of the right answer.
        why: why it is right, in a sentence.
        wrong: what is said to somebody who chose another letter; a nudge, never the right letter.
    """

    right: str
    why: str
    wrong: Mapping[str, str]


def exercise(check: Callable[Asked, str]) -> Callable[Asked, str]:
    """Make a check an exercise of its lesson: its success is kept, and its hints come one after the other."""
    key = f"{check.__module__.rpartition('.')[2]}.{check.__name__}"

    @functools.wraps(check)
    def run(*args: Asked.args, **kwargs: Asked.kwargs) -> str:
        try:
            praise = check(*args, **kwargs)
        except CheckError as error:
            fault = error.expected, error.hints[0]
            before, count = _failures.get(key, (None, 0))
            error.failures = count + 1 if fault == before else 1
            _failures[key] = fault, error.failures
            raise
        progress.keep(key)
        return praise

    progress.register(key)
    return run


def _ended(text: str) -> str:
    return text if text.endswith(".") else f"{text}."


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


def graded(questions: Sequence[Question], letters: Sequence[str]) -> str:
    """Return the praise for right answers to a quiz.

    Args:
        questions: in the order of the lesson.
        letters: what was chosen, one a question.

    Raises:
        CheckError: at the first answer that is not right.
    """
    if len(letters) != len(questions):
        raise CheckError(
            f"{len(questions)} letters, one a question",
            f"{len(letters)}",
            'give them in their order, such as check.quiz("a", "b").',
        )
    for number, (question, letter) in enumerate(zip(questions, letters, strict=True), 1):
        chosen = str(letter).strip().lower()
        if chosen != question.right:
            hint = question.wrong.get(chosen, f"the letters are {', '.join(_letters(question))}.")
            raise CheckError(f"the right answer to question {number}", repr(letter), hint)
    return "Right. " + " ".join(f"({number}) {question.why}" for number, question in enumerate(questions, 1))


def quiz_of(module: str, questions: Sequence[Question]) -> Callable[..., str]:
    """Return the last exercise of a lesson: `quiz("b", "a", "c")`.

    Args:
        module: the `__name__` of the lesson's checks.
        questions: in the order of the lesson.
    """

    def quiz(*letters: str) -> str:
        """Check the answers to the lesson's questions, a letter each; CheckError at the first wrong one."""
        return graded(questions, letters)

    quiz.__module__ = module
    return exercise(quiz)


def _letters(question: Question) -> list[str]:
    return sorted({question.right, *question.wrong})
