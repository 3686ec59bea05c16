"""What a rubric can ask the evidence: functions from a `Case`, and sometimes a part, to an `Answer`."""

from __future__ import annotations

from ros2lab.grading.questions import (
    bonus,
    commands,
    documentation,
    launching,
    nodes,
    package,
    parameter_file,
    parameters,
    publisher,
    services,
    workspace,
)
from ros2lab.grading.questions.answer import QUESTIONS, Answer, Question

__all__ = ["QUESTIONS", "Answer", "Question"]

_MODULES = (
    workspace,
    package,
    nodes,
    publisher,
    commands,
    services,
    parameters,
    documentation,
    launching,
    parameter_file,
    bonus,
)  # importing them registers their questions
