"""A grade: points, the reason for each, and how to fix what lost some; plain data that every report shows."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass

from ros2lab.grading.evidence import Clock

SCHEMA = 1


@dataclass(frozen=True)
class Points:
    """Points, and the most that can be reached."""

    points: float
    max: float


@dataclass(frozen=True)
class Override:
    """An instructor's points for a criterion, instead of the machine's.

    Attributes:
        points: the points that count now.
        comment: the reason.
        by: the instructor.
        machine: the points that the machine gave.
    """

    points: float
    comment: str
    by: str
    machine: float


@dataclass(frozen=True)
class Judgement:
    """A criterion of the rubric, and the points for it.

    Attributes:
        id: `component.name`.
        component: the part of the assignment that it belongs to.
        title: a few words.
        points: the points that count, after any override.
        max: the most points that can be reached.
        reason: one sentence.
        hint: what to change; empty if no points were lost.
        evidence: keys of the evidence that it rests on, such as `runs[0].commands[2]`.
        override: None if no instructor has changed the points.
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
    """What is wrong, where, and how to fix it; found by `ros2lab.diagnose` if possible.

    Attributes:
        code: the code of the finding, such as `entry-point-module`.
        component: the component that loses points by it.
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
        schema: the version of this format.
        submission: the name of what was handed in.
        total: all points, including the bonus.
        max: the most points without the bonus.
        components: by name, in the order of the rubric.
        criteria: in the order of the rubric.
        faults: the most telling first.
        notes: what was left out, or done differently than usual.
        clock: `stepped` if all programs that were watched follow the ROS clock, else `real`.
        sandbox: how the submission was confined.
        seconds: `unpack`, `build`, `observe` and `total`.
        versions: the versions of the programs that graded it.
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
        """A digest of the whole grade, which shows that its reports belong together."""
        return run_of(asdict(self))


def run_of(plain: Mapping[str, object]) -> str:
    """Return the digest of a grade, as plain data."""
    return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()[:12]
