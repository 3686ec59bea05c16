"""Submissions made by code, and what each must get: what the grader is judged by before others judge it.

    with case.handed_in(folder) as path:
        grade = ...  # of what lies at `path`
    assert not case.problems(grade)

`STYLES` are legitimate, `FAULTS` have one fault each, `PAIRS` two, `HOSTILE` mean harm, and `EXTREMES` are hardly
submissions at all; `LAMP_STYLES` and `LAMP_FAULTS` are those of another assignment. `HINTS` are faults and what a report says of them, to be done. A case with `is_refused` has no grade, but a SubmissionError. Leaving `handed_in` raises
AssertionError if a hostile one has done harm.
"""

from corpus.case import BONUS, COMPONENTS, Case, Loss
from corpus.faults import FAULTS
from corpus.hints import HINTS
from corpus.hostile import HOSTILE
from corpus.lamp import LAMP_FAULTS, LAMP_STYLES
from corpus.pairs import PAIRS
from corpus.styles import EXTREMES, STYLES

CASES: tuple[Case, ...] = (*STYLES, *EXTREMES, *FAULTS, *PAIRS, *HOSTILE, *LAMP_STYLES, *LAMP_FAULTS)

__all__ = [
    "BONUS",
    "CASES",
    "COMPONENTS",
    "EXTREMES",
    "FAULTS",
    "HINTS",
    "HOSTILE",
    "LAMP_FAULTS",
    "LAMP_STYLES",
    "PAIRS",
    "STYLES",
    "Case",
    "Loss",
]
