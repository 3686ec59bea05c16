"""What of a class needs a human look, and why: each reason is a rule beside its sentence."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ros2lab.classroom.gradebook import Row
from ros2lab.grading.evidence import Evidence
from ros2lab.grading.grade import Grade
from ros2lab.grading.judging.leftovers import case_of
from ros2lab.grading.questions import QUESTIONS
from ros2lab.grading.questions.answer import shown
from ros2lab.grading.receiving.notes import Kind, first_of
from ros2lab.grading.reports.shown import number
from ros2lab.grading.rubric import Criterion, Rubric

UNTRIED = "untried"
DOUBTFUL = ("written", "near", "other", "doubled")  # given for what is likely to be meant
REFUSED: tuple[Kind, ...] = ("outside", "no file", "name taken", "unreadable", "too large")


@dataclass(frozen=True)
class Looked:
    """A submission with all that is known of it."""

    row: Row
    grade: Grade
    evidence: Evidence
    rubric: Rubric

    def criteria_with(self, *levels: str) -> list[Criterion]:
        """Return the criteria whose answer is one of some levels, and not the best that there is."""
        case = case_of(self.evidence, self.rubric.assignment)
        parts = self.rubric.assignment.parts
        found = []
        for criterion in self.rubric.criteria:
            question = QUESTIONS[criterion.question]
            answer = question.ask(case, parts.get(criterion.component))
            level = UNTRIED if answer.excuse else answer.level
            if level in levels and level != question.answers[0]:
                found.append(criterion)
        return found


Rule = Callable[[Looked], "str | None"]
RULES: list[Rule] = []


def rule(function: Rule) -> Rule:
    """Register a reason: a function from a submission to a sentence, or to None where there is nothing to look at."""
    RULES.append(function)
    return function


def reasons(looked: Looked) -> Iterator[str]:
    """Yield why a submission needs a human look, a sentence each."""
    for function in RULES:
        sentence = function(looked)
        if sentence:
            yield sentence


@rule
def _nothing_to_grade(looked: Looked) -> str | None:
    return f"There was nothing to grade: {looked.row.problem}" if looked.row.problem else None


@rule
def _real_clock(looked: Looked) -> str | None:
    if looked.grade.clock == "stepped":
        return None
    return "It was watched on the real clock, on which a period is known to a tenth of a second."


@rule
def _untried(looked: Looked) -> str | None:
    criteria = [
        criterion.id for criterion in looked.criteria_with(UNTRIED) if not criterion.id.startswith("bonus.")
    ]
    return f"This could not be tried: {', '.join(criteria)}." if criteria else None


@rule
def _low_certainty(looked: Looked) -> str | None:
    criteria = [criterion.id for criterion in looked.criteria_with(*DOUBTFUL)]
    return f"Points rest on what was likely meant: {', '.join(criteria)}." if criteria else None


@rule
def _refused_in_the_lab(looked: Looked) -> str | None:
    programs = sorted({name for run in looked.evidence.runs if run.refused for name in run.programs})
    if not programs:
        return None
    return (
        f"A field was given a value of another type, so it was watched a second time: {', '.join(programs)}."
    )


@rule
def _notes_of_the_sandbox(looked: Looked) -> str | None:
    notes = [*dict.fromkeys(note for run in looked.evidence.runs for note in run.notes)]
    said = "; ".join(note.rstrip(".") for note in notes[:3])
    return f"The sandbox notes: {said}." if notes else None


@rule
def _left_out(looked: Looked) -> str | None:
    paths = looked.evidence.submission.noted(*REFUSED)
    return f"Not everything could be received: {', '.join(paths[:5])}." if paths else None


@rule
def _not_read(looked: Looked) -> str | None:
    said = [*dict.fromkeys((*looked.evidence.files.unread.values(), *looked.evidence.submission.left_unread))]
    return f"Not all of it was read: {' '.join(said[:3])}" if said else None


@rule
def _code_not_found(looked: Looked) -> str | None:
    """Whether a copy would be seen is not known either where the code was not found."""
    if looked.evidence.files.ends_elsewhere is None:
        return None
    case = case_of(looked.evidence, looked.rubric.assignment)
    parts = [
        part.name for part in case.assignment.parts.values() if case.main(part) and not case.is_written(part)
    ]
    return f"Reading did not find the code of what runs: {', '.join(parts)}." if parts else None


@rule
def _not_watched(looked: Looked) -> str | None:
    unseen = (run for run in looked.evidence.runs if run.unfinished and not run.nodes)
    left = [*looked.evidence.unwatched, *(name for run in unseen for name in run.programs)]
    return f"Not all of its programs were watched: {first_of([*map(shown, left)])}." if left else None


@rule
def _from_elsewhere(looked: Looked) -> str | None:
    """Where submissions lie in an instructor's repository, that may be another student's."""
    paths = looked.evidence.submission.noted("from elsewhere")
    return (
        f"A part of it was taken from elsewhere in the repository: {', '.join(paths[:5])}." if paths else None
    )


@rule
def _no_sandbox(looked: Looked) -> str | None:
    is_boxed = looked.evidence.sandbox.startswith("bubblewrap") or not looked.evidence.runs
    return None if is_boxed else "It ran without the sandbox."


@rule
def _decided(looked: Looked) -> str | None:
    decided = [criterion for criterion in looked.grade.criteria if criterion.override]
    if not decided:
        return None
    said = "; ".join(
        f"{criterion.id} {number(criterion.points)} instead of {number(criterion.override.machine)}, by {criterion.override.by}"
        for criterion in decided
        if criterion.override
    )
    return f"An instructor has decided: {said}."
