"""The points lost, by component: what a student reads first."""

from __future__ import annotations

from dataclasses import dataclass

from ros2lab.grading.grade import Fault, Grade, Judgement

BONUS = "bonus"  # the component that costs nothing if it is missed; as in the rubric


@dataclass(frozen=True)
class Loss:
    """What a component lost.

    Attributes:
        component: its name.
        points: how many points it lost.
        criteria: its criteria that lost points.
        faults: its faults that the criteria do not mention.
    """

    component: str
    points: float
    criteria: list[Judgement]
    faults: list[Fault]


def losses(grade: Grade) -> list[Loss]:
    """Return the loss of each component, in the rubric's order, without the bonus, which costs nothing."""
    found = []
    for component, given in grade.components.items():
        criteria = [
            criterion
            for criterion in grade.criteria
            if criterion.component == component and criterion.points < criterion.max
        ]
        if criteria and component != BONUS:
            told = {criterion.reason for criterion in criteria}
            faults = [
                fault for fault in grade.faults if fault.component == component and fault.cause not in told
            ]
            found.append(Loss(component, given.max - given.points, criteria, faults))
    return found


def other_faults(grade: Grade) -> list[Fault]:
    """Return the faults of components without a loss that the criteria of the bonus do not mention."""
    lost = {loss.component for loss in losses(grade)}
    told = {criterion.reason for criterion in missed_bonus(grade)}
    return [fault for fault in grade.faults if fault.component not in lost and fault.cause not in told]


def missed_bonus(grade: Grade) -> list[Judgement]:
    """Return the bonus criteria that could give more points."""
    return [
        criterion
        for criterion in grade.criteria
        if criterion.component == BONUS and criterion.points < criterion.max
    ]
