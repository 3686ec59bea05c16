"""A grade: points, the reason for each, and what would fix what was lost; plain data that every report shows."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass

from ros2lab.grading.evidence import Clock

SCHEMA = 1


@dataclass(frozen=True)
class Points:
    """What was given, of what there was to get."""

    points: float
    max: float


@dataclass(frozen=True)
class Override:
    """What an instructor says a criterion is worth, in place of the machine.

    Attributes:
        points: what it is worth now.
        comment: why.
        by: who says so.
        machine: the points that the machine gave.
    """

    points: float
    comment: str
    by: str
    machine: float


@dataclass(frozen=True)
class Judgement:
    """A criterion of the rubric, and what it was worth.

    Attributes:
        id: `component.name`.
        component: the part of the assignment to which it belongs.
        title: a few words.
        points: those that count, also after an override.
        max: the most that there was to get.
        reason: one sentence.
        hint: what to change; empty if nothing was lost.
        evidence: keys of the evidence on which it rests, such as `runs[0].commands[2]`.
        override: None if no instructor has spoken.
    """

    id: str
    component: str
    title: str
    points: float
    max: float
    reason: str
    hint: str
    evidence: list[str]
    override: Override | None = None


@dataclass(frozen=True)
class Fault:
    """What is wrong, where, and how to fix it; found by `ros2lab.diagnose` wherever it can be.

    Attributes:
        code: of the finding, such as `entry-point-module`.
        component: where its points are lost.
        cause: one sentence.
        place: `file:line`, or a topic or a node; empty if there is none.
        fix: what to type or to change.
    """

    code: str
    component: str
    cause: str
    place: str
    fix: str


@dataclass(frozen=True)
class Grade:
    """What a submission is worth, and why.

    Attributes:
        schema: the version of this form.
        submission: the name of what was handed in.
        total: all points, the bonus among them.
        max: the most without the bonus.
        components: by name, in the order of the rubric.
        criteria: in the order of the rubric.
        faults: the most telling first.
        notes: what was left out, or done in another way than usual.
        clock: `stepped` if all programs that were watched follow the ROS clock, else `real`.
        sandbox: how the submission was confined.
        seconds: `unpack`, `build`, `observe` and `total`.
        versions: of what graded.
    """

    schema: int
    submission: str
    total: float
    max: float
    components: dict[str, Points]
    criteria: list[Judgement]
    faults: list[Fault]
    notes: list[str]
    clock: Clock
    sandbox: str
    seconds: dict[str, float]
    versions: dict[str, str]

    @property
    def run(self) -> str:
        """By what the reports of one grade are known to belong together: a digest of all that it holds."""
        return hashlib.sha256(json.dumps(asdict(self), sort_keys=True).encode()).hexdigest()[:12]
