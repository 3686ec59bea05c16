"""What the course's grader says of one's own work, before it is handed in; the same as `ros2lab grade --self`."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from ros2lab import judge
from ros2lab.clean_build import differing, digests
from ros2lab.grading import rubric
from ros2lab.grading.collect import collect
from ros2lab.grading.evidence import Build, Executable
from ros2lab.grading.grade import Grade, Judgement
from ros2lab.grading.judging import readme
from ros2lab.grading.judging.players import Case
from ros2lab.grading.rubric import BONUS
from ros2lab.grading.sandbox.box import SandboxMissing
from ros2lab.grading.verdict import verdict
from ros2lab.hand_in import PACKAGE, Evidence
from ros2lab.table import Table
from ros2lab.workspace import Workspace

POINTS: Mapping[str, float] = rubric.load().components
NOT_RUN = "not run"
_KNOWN = (
    "submission",
    "files",
    "build",
)  # where the grader's evidence has what is known before anything runs


@dataclass(frozen=True)
class Assessment:
    """What the grader says.

    Attributes:
        root: the workspace's folder.
        grade: what it gives; without a sandbox, what is known from the files and the build.
        why_not_run: why the nodes were not watched; empty if they were.
        handed_in: digests of the files that were looked at, by their paths in the workspace.
    """

    root: Path
    grade: Grade
    why_not_run: str
    handed_in: Mapping[str, str] = field(repr=False)

    @property
    def outdated(self) -> list[str]:
        """The files that are not any more what was looked at."""
        return differing(digests(self.root, ""), self.handed_in)

    def points(self, component: str) -> float | None:
        """Return what a part is worth; None if not all of it is known."""
        of_it = [criterion for criterion in self.grade.criteria if criterion.component == component]
        return self.grade.components[component].points if all(map(self._is_known, of_it)) else None

    def lost(self, component: str) -> list[Judgement]:
        """Return what is not worth all of its points in a part, as far as that is known."""
        return [
            criterion
            for criterion in self.grade.criteria
            if criterion.component == component
            and criterion.points < criterion.max
            and self._is_known(criterion)
        ]

    def table(self, claims: Mapping[str, object]) -> Table:
        """Hold what somebody claims for each part against what the grader gives."""
        rows = []
        for part, most in POINTS.items():
            points = self.points(part)
            given = NOT_RUN if points is None else f"{points:g}"
            reasons = " ".join(f"{lost.title}: {lost.reason}" for lost in self.lost(part))
            rows.append((part, f"{most:g}", claims.get(part, "-"), given, reasons))
        rows += [
            (part, "-", claim, "-", "There is no such part.")
            for part, claim in claims.items()
            if part not in POINTS
        ]
        return Table(("part", "of", "claimed", "grader", "lost"), rows)

    def _is_known(self, criterion: Judgement) -> bool:
        return not self.why_not_run or (
            criterion.component != BONUS
            and all(key.partition(".")[0] in _KNOWN for key in criterion.evidence)
        )


def assess(workspace: Workspace, evidence: Evidence) -> Assessment:
    """Ask the grader what a workspace is worth, as `ros2lab grade --self` does; prints what it is doing.

    It takes some seconds, and longer the more tests the package has. Where there is no sandbox, nothing is run,
    and only what is known from the files and the build remains.

    Args:
        workspace: what is to be handed in.
        evidence: of its build and its nodes, for where there is no sandbox.

    Raises:
        SubmissionError: if there is nothing that could be graded.
        RuntimeError: if colcon or ROS cannot be used.
    """
    looked_at = digests(workspace.path, "")
    criteria = rubric.load()
    try:
        seen, why_not_run = collect(workspace.path, _show), ""
    except SandboxMissing as error:
        seen, why_not_run = _case(workspace, evidence).evidence, str(error)
        sys.stdout.write(f"The nodes were not run, because there is no sandbox: {why_not_run}\n")
    return Assessment(workspace.path, verdict(seen, criteria), why_not_run, looked_at)


def judged(workspace: Workspace, evidence: Evidence, component: str) -> list[Judgement]:
    """Return what the grader says of a part that rests on the files, and on what was seen of the nodes.

    Args:
        workspace: what is to be handed in.
        evidence: of its nodes.
        component: such as `documentation`.

    Raises:
        OSError: if a file cannot be read.
    """
    return judge.judged(_case(workspace, evidence), component)


def _show(step: str) -> None:
    sys.stdout.write(f"{step} ...\n")
    sys.stdout.flush()


def _case(workspace: Workspace, evidence: Evidence) -> Case:
    """Return what the grader knows of the files, and what was seen of the build and of the nodes."""
    submission, facts = judge.facts_of(workspace.path)
    programs = [
        Executable(name, "", "installed", ["ros2", "run", PACKAGE, name]) for name in evidence.programs
    ]
    built = Build(not evidence.fault, evidence.fault, [], [], programs, evidence.shared, {}, 0.0)
    runs = [evidence.run] if evidence.run else []
    commands = readme.commands(facts.readme, submission, built, runs)
    return judge.case_of(runs, replace(facts, readme_commands=commands), built, submission)
