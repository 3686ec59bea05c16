"""The points lost, by component: what a student reads first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ros2lab.grading.grade import Fault, Grade, Judgement

BONUS = "bonus"  # the component that costs nothing if it is missed; as in the rubric


@dataclass(frozen=True)
class Loss:
    """What a component lost.

    Attributes:
        component: its name.
        points: how many points it lost.
        criteria: its criteria that lost points; those for one and the same reason are one.
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
            found.append(Loss(component, given.max - given.points, _joined(criteria), faults))
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


def _joined(criteria: Sequence[Judgement]) -> list[Judgement]:
    """Return criteria with those as one that lost their points for the same reason, such as a missing node.

    The reason may go on in some of them, as where the topic's criterion says why the node was not seen.
    """
    groups: dict[str, list[Judgement]] = {}
    for criterion in sorted(criteria, key=lambda criterion: len(criterion.reason)):
        reason = criterion.reason.rstrip(".")
        is_decided = criterion.override is not None
        shared = next((stem for stem in groups if reason.startswith(stem) and not is_decided), reason)
        groups.setdefault(f"{shared} ({criterion.id})" if is_decided else shared, []).append(criterion)
    order = {criterion.id: number for number, criterion in enumerate(criteria)}
    for alike in groups.values():
        alike.sort(key=lambda criterion: order[criterion.id])
    return [_one(alike) for alike in sorted(groups.values(), key=lambda alike: order[alike[0].id])]


def _one(alike: list[Judgement]) -> Judgement:
    """Return several criteria with one reason as one."""
    return replace(
        alike[0],
        title="; ".join(criterion.title for criterion in alike),
        points=round(sum(criterion.points for criterion in alike), 2),
        max=round(sum(criterion.max for criterion in alike), 2),
        reason=max((criterion.reason for criterion in alike), key=len),
        hint=" ".join(dict.fromkeys(criterion.hint for criterion in alike if criterion.hint)),
    )
