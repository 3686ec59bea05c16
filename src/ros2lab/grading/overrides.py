"""An instructor's decisions, which override the machine's: YAML with `criterion: {points, comment, by}`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ros2lab.grading.rubric import Rubric
from ros2lab.located_yaml import Reader


class OverridesError(Exception):
    """Overrides that cannot be used; the message names the file, the line, and what to change."""


@dataclass(frozen=True)
class Decision:
    """An instructor's decision about a criterion.

    Attributes:
        points: how many points it gets.
        comment: the reason.
        by: who decided.
    """

    points: float
    comment: str
    by: str


def read(path: Path, rubric: Rubric) -> dict[str, Decision]:
    """Read the decisions about a submission, by criterion; an empty file has none.

    Raises:
        OverridesError: if the file cannot be read, names a criterion that the rubric does not have, gives more
            points than the criterion has, or lacks the comment or the author.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise OverridesError(f"{path} cannot be read ({error}); give a YAML file.") from None
    reader = Reader(str(path), OverridesError)
    root = reader.root(text)
    if root is None:
        return {}
    most = {criterion.id: criterion.points for criterion in rubric.criteria}
    found = {}
    for name, node in reader.pairs(root):
        if name.value not in most:
            raise reader.error(name, f"there is no criterion {name.value!r}; there are {', '.join(most)}")
        parts = reader.fields(node, "points", "comment", "by")
        points = reader.number(parts["points"], 0, most[name.value])
        found[name.value] = Decision(points, reader.text(parts["comment"]), reader.text(parts["by"]))
    return found
