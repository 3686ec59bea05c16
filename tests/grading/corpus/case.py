"""What a case of the corpus is: a submission made by code, and what it must get."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from ros2lab.grading.grade import Grade

# The most points of each component, and the items of the bonus: the criterion of each is `bonus.<item>`.
COMPONENTS: Mapping[str, float] = {
    "workspace": 15,
    "package": 15,
    "status_publisher": 20,
    "command_subscriber": 20,
    "velocity_publisher": 20,
    "documentation": 10,
}
BONUS = ("launch", "parameters", "parameter_file", "errors", "tests")
ALL_BONUS = frozenset(BONUS)
NOTHING: Mapping[str, str] = {}

Make = Callable[[Path, Mapping[str, str]], Path]
Trap = Callable[[Path], AbstractContextManager[Mapping[str, str]]]


@dataclass(frozen=True)
class Loss:
    """What a component must lose.

    Attributes:
        least: points, at least.
        most: points, at most.
        cause: a regular expression that is found in what the report says of the component: its reasons, hints,
            and faults with their codes and places. Empty asks only that something is said.
    """

    least: float = 0.5
    most: float = 20
    cause: str = ""


UNBUILT = Loss(3, 3, r"colcon build. finds \w+ and does not build it")


@dataclass(frozen=True)
class Case:
    """A submission, and what it must get.

    Attributes:
        name: unique in the corpus.
        about: what is special about it, and why it is worth that.
        make: writes it below an empty folder, with these values in place of `@NAME@`; see `handed_in`.
        loses: the components that lose points; every other one has all of them. None: only `most` counts.
        earns: items of the bonus that must be had in full.
        lacks: items of the bonus that must not be; nothing is said of the rest.
        bonus_cause: as `Loss.cause`, for what is lost of the bonus.
        most: points in all, at most.
        is_refused: whether nothing can be received, so that there is an error in place of a grade.
        unreadable: how those of its Python files end that are not Python, on purpose.
        forbidden: texts that must not stand in the report.
        trap: is set before it is written, and raises AssertionError at its end if harm was done; None if it means
            no harm.
        assignment: the folder of that for which it is handed in; None for the course's own.
        criteria: those that lose points, and no other, in place of `loses` and the bonus.
        cause: as `Loss.cause`, for what `criteria` have lost.
        builds: whether colcon builds the package; if not, that costs half of the build besides.
    """

    name: str
    about: str
    make: Make
    loses: Mapping[str, Loss] | None = field(default_factory=dict)
    earns: frozenset[str] = frozenset()
    lacks: frozenset[str] = frozenset()
    bonus_cause: str = ""
    most: float = 110
    is_refused: bool = False
    unreadable: tuple[str, ...] = ()
    forbidden: tuple[str, ...] = ()
    trap: Trap | None = None
    assignment: Path | None = None
    criteria: frozenset[str] | None = None
    cause: str = ""
    builds: bool = True

    @contextmanager
    def handed_in(self, folder: Path) -> Iterator[Path]:
        """Write it below an empty folder, and give the path to hand in: a folder, a zip, a tar.

        Raises:
            AssertionError: at the end, if harm was done meanwhile.
        """
        if self.trap is None:
            yield self.make(folder, NOTHING)
            return
        with self.trap(folder) as values:
            yield self.make(folder, values)

    def problems(self, grade: Grade) -> list[str]:
        """Return in what a grade is not what the case must get; a sentence each."""
        return [*self._problems(grade)]

    def _problems(self, grade: Grade) -> Iterator[str]:
        if grade.total > self.most + 1e-6:
            yield f"{grade.total:g} points were given, at most {self.most:g} are deserved."
        yield from (f"The report shows {text!r}." for text in self.forbidden if text in repr(grade))
        if self.criteria is not None:
            yield from self._criteria_problems(grade)
            return
        if self.loses is None:
            return
        for component, all_points in COMPONENTS.items():
            lost = all_points - grade.components[component].points
            unbuilt = UNBUILT if component == "workspace" and not self.builds else None
            loss = self.loses.get(component, unbuilt)
            if loss is None:
                if abs(lost) > 1e-6:
                    yield f"{component} lost {lost:g} points and must lose none: {said_of(grade, component)}"
            elif not loss.least - 1e-6 <= lost <= min(loss.most, all_points) + 1e-6:
                wanted = f"{loss.least:g} to {min(loss.most, all_points):g}"
                yield f"{component} lost {lost:g} points and must lose {wanted}."
            elif lost and not re.search(loss.cause or r"\w", said_of(grade, component), re.IGNORECASE):
                yield f"{component} must say {loss.cause!r}, and says: {said_of(grade, component)}"
        yield from self._bonus_problems(grade)

    def _criteria_problems(self, grade: Grade) -> Iterator[str]:
        lost = {one.id: f"{one.reason} {one.hint}" for one in grade.criteria if one.points < one.max}
        for name in sorted(lost.keys() ^ (self.criteria or frozenset())):
            yield (
                f"{name} lost points and must lose none: {lost[name]}"
                if name in lost
                else f"{name} must lose points."
            )
        said = " ".join(lost.values())
        if not re.search(self.cause, said, re.IGNORECASE):
            yield f"It must say {self.cause!r}, and says: {said}"

    def _bonus_problems(self, grade: Grade) -> Iterator[str]:
        criteria = {one.id: one for one in grade.criteria}
        for item in BONUS:
            one = criteria[f"bonus.{item}"]
            is_full = one.points >= one.max
            if item in self.earns and not is_full:
                yield f"The bonus for {item} is earned and was not given: {one.reason}"
            if item in self.lacks and is_full:
                yield f"The bonus for {item} is not earned and was given: {one.reason}"
        if self.bonus_cause and not re.search(self.bonus_cause, said_of(grade, "bonus"), re.IGNORECASE):
            yield f"The bonus must say {self.bonus_cause!r}, and says: {said_of(grade, 'bonus')}"


def said_of(grade: Grade, component: str) -> str:
    """Return all that a grade says of what a component has lost."""
    lost = [one for one in grade.criteria if one.component == component and one.points < one.max]
    faults = [one for one in grade.faults if one.component == component]
    return " ".join(
        [f"{one.reason} {one.hint}" for one in lost]
        + [f"{one.code} {one.cause} {one.place} {one.fix}" for one in faults]
    )
