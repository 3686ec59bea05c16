"""Instant feedback on an exercise: one file a lesson, one function an exercise.

A check returns `Praise` for a right answer, or raises `CheckError` with what was expected, what was found, and a
hint; a notebook shows both as cards.
Checks look at behaviour and facts, so that every right solution passes.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable, Sequence
from typing import Any, ParamSpec

from ros2lab import edition, progress
from ros2lab.checks import card
from ros2lab.checks.card import Praise
from ros2lab.checks.choices import Prediction, Question, Quiz, praise_of, predict_of, questions_of

__all__ = [
    "CheckError",
    "Praise",
    "Prediction",
    "Question",
    "answer_of",
    "exercise",
    "graded",
    "predict_of",
    "questions_of",
    "quiz_of",
]

Asked = ParamSpec("Asked")

LEAST_TRIES = 3  # of one fault, before the worked solution is offered

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
        self.exercise: str | None = None  # `lesson.exercise`, once it is known
        self._is_shown = False

    def __str__(self) -> str:
        hint = self.hints[min(self.failures, len(self.hints)) - 1]
        return f"Not yet. Expected: {_ended(self.expected)} Found: {_ended(self.found)} Hint: {hint}"

    def _render_traceback_(self) -> list[str]:
        # IPython shows this instead of a traceback through the check's own code, and a notebook the card.
        if not self._is_shown:  # IPython asks twice
            self._is_shown = True
            _display_in_notebook({"text/plain": str(self), "text/html": self._repr_html_()})
        return [str(self)]

    def _repr_html_(self) -> str:
        return card.refusal(
            self.expected,
            self.found,
            self.hints,
            min(self.failures, len(self.hints)),
            self.solution(),
        )

    def solution(self) -> list[str]:
        """Return the cells of the worked solution, once all hints were told and the fault is still there."""
        if self.exercise is None or self.failures < max(LEAST_TRIES, len(self.hints) + 1):
            return []
        try:
            return edition.solution(*self.exercise.split("."))
        except (OSError, ValueError):  # the card is shown without the offer
            return []


def exercise(check: Callable[Asked, str]) -> Callable[Asked, Praise]:
    """Make a check an exercise of its lesson: its success is kept, and its hints come one after the other."""
    key = f"{check.__module__.rpartition('.')[2]}.{check.__name__}"

    @functools.wraps(check)
    def run(*args: Asked.args, **kwargs: Asked.kwargs) -> Praise:
        try:
            praise = check(*args, **kwargs)
        except CheckError as error:
            fault = error.expected, error.hints[0]
            before, count = _failures.get(key, (None, 0))
            error.failures = count + 1 if fault == before else 1
            error.exercise = key
            _failures[key] = fault, error.failures
            raise
        progress.keep(key)
        return Praise(praise)

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
            hint = question.wrong.get(chosen, f"the letters are {', '.join(question.letters)}.")
            raise CheckError(f"the right answer to question {number}", repr(letter), hint)
    return praise_of(questions)


def quiz_of(module: str, questions: Sequence[Question]) -> Callable[..., Praise | Quiz]:
    """Return the last exercise of a lesson: `quiz()`, which asks, or `quiz("b", "a", "c")`, which is told.

    Args:
        module: the `__name__` of the lesson's checks.
        questions: in the order of the lesson.
    """

    def told(*letters: str) -> str:
        return graded(questions, letters)

    told.__module__, told.__name__ = module, "quiz"
    check = exercise(told)

    def quiz(*letters: str) -> Praise | Quiz:
        """Ask the lesson's questions; or check the answers, a letter each: CheckError at the first wrong one."""
        return check(*letters) if letters else Quiz(f"{module.rpartition('.')[2]}.quiz", questions)

    quiz.__module__ = module
    return quiz


def _display_in_notebook(bundle: dict[str, str]) -> None:
    """Show something where a browser shows it; a terminal has the error's own text."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    if hasattr(shell, "kernel"):
        from IPython.display import display  # noqa: PLC0415 -- tests of the checks do without it

        display(bundle, raw=True)  # type: ignore[no-untyped-call]
