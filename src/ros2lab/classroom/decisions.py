"""What instructors decide instead of the machine, by hand or from a CSV."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from ros2lab.classroom.gradebook import Row
from ros2lab.classroom.handed_in import ClassError, named_by
from ros2lab.grading.rubric import Rubric

COLUMNS = ("student", "criterion", "points", "comment", "by")

Decided = tuple[str, str, float, str, str]  # student, criterion, points, comment, by


def read(path: Path, rows: Sequence[Row], rubric: Rubric) -> list[Decided]:
    """Read a CSV of decisions.

    Raises:
        ClassError: if it cannot be read, or a line does not fit the class or the rubric; the message names the line.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.DictReader(file)
            lines = [*reader]
            header = reader.fieldnames or []
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ClassError(f"{path} cannot be read ({error}); give a CSV in UTF-8.") from None
    missing = [name for name in COLUMNS if name not in header]
    if missing:
        raise ClassError(f"{path} has no column {', '.join(missing)}; it needs {', '.join(COLUMNS)}.")
    return [*_decided(path, lines, rows, rubric)]


def _decided(
    path: Path, lines: Iterable[dict[str, str]], rows: Sequence[Row], rubric: Rubric
) -> Iterator[Decided]:
    for number, line in enumerate(lines, start=2):
        cells = {name: (line[name] or "").strip() for name in COLUMNS}
        try:
            points = float(cells["points"])
        except ValueError:
            raise ClassError(
                f"{path}, line {number}: the points must be a number, and are {cells['points']!r}."
            ) from None
        try:
            row = row_of(cells["student"], rows)
            decided = (row.handed.key, cells["criterion"], points, cells["comment"], cells["by"])
            yield checked(decided, rubric)
        except ClassError as error:
            raise ClassError(f"{path}, line {number}: {error}") from None


def checked(decided: Decided, rubric: Rubric) -> Decided:
    """Return a decision that the rubric allows.

    Raises:
        ClassError: if there is no such criterion, it has fewer points, or nobody says why.
    """
    _, criterion, points, comment, by = decided
    most = {criterion.id: criterion.points for criterion in rubric.criteria}
    if criterion not in most:
        raise ClassError(f"There is no criterion {criterion!r}; there are {', '.join(most)}.")
    if not math.isfinite(points) or not 0 <= points <= most[criterion]:
        raise ClassError(f"{criterion} is worth 0 to {most[criterion]:g} points, and not {points:g}.")
    if not comment or not by:
        raise ClassError("A decision needs a comment and a name, for it stands in the report.")
    return decided


def row_of(word: str, rows: Sequence[Row]) -> Row:
    """Return the row of the student that a word names: by the key, which no other has, else as `named_by`.

    Raises:
        ClassError: if it names none, or more than one.
    """
    named = [row for row in rows if word == row.handed.key]
    if not named:
        meant = named_by(word, (row.handed for row in rows))
        named = [row for row in rows if row.handed in meant]
    if len(named) == 1:
        return named[0]
    if not named:
        raise ClassError(
            f"Nobody in this gradebook is called {word!r}; give a name, an id or an email address."
        )
    names = ", ".join(f"{row.handed.name} ({row.handed.key})" for row in named[:5])
    raise ClassError(f"{word!r} may be {names}; give the id in brackets.")
