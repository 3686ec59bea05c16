"""Whether an assignment's rubric tells a right solution from an empty package."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ros2lab import environment
from ros2lab.assignments import Assignment
from ros2lab.grading.grade import Grade, Judgement
from ros2lab.grading.rubric import BONUS

MOST_OF_BARE = 0.5  # the largest share of all points that an empty package should get
CREATE_TIMEOUT = 60.0  # s


@dataclass(frozen=True)
class Comparison:
    """The grades of a model solution and of what `ros2 pkg create` makes, side by side.

    Attributes:
        solution: the grade of the model solution.
        bare: the grade of the package that `ros2 pkg create` makes.
    """

    solution: Grade
    bare: Grade

    @property
    def lost(self) -> list[Judgement]:
        """The criteria, except the bonus, on which the solution loses points."""
        return [
            criterion
            for criterion in self.solution.criteria
            if criterion.points < criterion.max and criterion.component != BONUS
        ]

    @property
    def alike(self) -> list[Judgement]:
        """The bare package's criteria that give it as many points as the solution."""
        pairs = zip(self.solution.criteria, self.bare.criteria, strict=True)
        return [bare for model, bare in pairs if bare.points >= model.points > 0]

    @property
    def is_low(self) -> bool:
        """Whether the bare package gets as few points as it should."""
        return self.bare.total <= MOST_OF_BARE * self.bare.max

    @property
    def is_sound(self) -> bool:
        """Whether the solution has all points, and the bare package few."""
        return not self.lost and self.is_low


def sentences(comparison: Comparison) -> Iterator[str]:
    """Yield the lines of a comparison's report."""
    solution, bare = comparison.solution, comparison.bare
    yield f"The solution gets {solution.total:g} of {solution.max:g} points."
    for criterion in comparison.lost:
        yield f"  {criterion.id} loses {criterion.max - criterion.points:g} of {criterion.max:g}: {criterion.reason} {criterion.hint}"
    yield f"What `ros2 pkg create` makes gets {bare.total:g} of {bare.max:g} points."
    if not comparison.is_low:
        yield "  That is more than half for nothing: give the criteria below fewer points."
    if comparison.alike:
        yield "Criteria that cannot tell the two apart:"
    for criterion in comparison.alike:
        yield f"  {criterion.id} gives both {criterion.points:g} of {criterion.max:g}: {criterion.reason}"


def create_bare(assignment: Assignment, folder: Path) -> Path:
    """Make a workspace with the package that `ros2 pkg create` makes for an assignment.

    Args:
        assignment: the assignment, which gives the package its name.
        folder: the folder in which the workspace is made.

    Returns:
        The workspace.

    Raises:
        RuntimeError: if there is no `ros2 pkg create`, or it fails.
    """
    source = folder / f"{assignment.package}_ws" / "src"
    source.mkdir(parents=True)
    words = ["ros2", "pkg", "create", assignment.package, "--build-type", "ament_python"]
    try:
        environ = environment.lab_environment()
        subprocess.run(
            words, cwd=source, env=environ, check=True, capture_output=True, text=True, timeout=CREATE_TIMEOUT
        )
    except subprocess.CalledProcessError as error:
        said = (error.stderr.strip() or error.stdout.strip() or "it said nothing").splitlines()[-1]
        raise RuntimeError(f"`{' '.join(words)}` failed: {said}") from None
    except (OSError, subprocess.TimeoutExpired) as error:
        raise RuntimeError(f"`{' '.join(words)}` cannot be run ({error}); try `ros2lab doctor`.") from None
    return source.parent
