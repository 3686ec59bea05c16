"""What a rubric can ask the evidence: each question a function from a `Case` to an `Answer`."""

from __future__ import annotations

from collections.abc import Mapping

from ros2lab.grading.questions import bonus, command, documentation, package, status, velocity, workspace
from ros2lab.grading.questions.answer import QUESTIONS, Answer, Question

__all__ = ["ANSWERS", "NAMES", "QUESTIONS", "Answer", "Question"]

_MODULES = (workspace, package, status, command, velocity, documentation, bonus)  # enter their questions

ANSWERS: Mapping[str, frozenset[str]] = {name: one.answers for name, one in QUESTIONS.items()}
NAMES: Mapping[str, frozenset[str]] = {name: one.names for name, one in QUESTIONS.items()}
