"""The rubric: what each point rests on, as data that an instructor can read and change.

A criterion asks the evidence one question, of `ros2lab.grading.questions`. The answer is the name of a level, and
the level says which part of the points it is worth, and why in a sentence.
"""

from __future__ import annotations

import math
import string
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import yaml

from ros2lab.grading.located_yaml import Reader
from ros2lab.grading.questions import ANSWERS, NAMES

SCHEMA = 1
TOTAL, MOST_BONUS = 100, 10
BONUS = "bonus"


class RubricError(Exception):
    """A rubric that cannot be used; the message names the file, the line, and what to change."""


@dataclass(frozen=True)
class Level:
    """An answer to a question, and what it is worth.

    Attributes:
        share: of the criterion's points, from 0 to 1.
        reason: one sentence; names in braces are filled in with what was seen.
        hint: what to change; empty where nothing is lost.
    """

    share: float
    reason: str
    hint: str = ""


@dataclass(frozen=True)
class Criterion:
    """What a part of the points is given for.

    Attributes:
        id: `component.name`; overrides name it.
        component: the part of the assignment to which it belongs.
        title: a few words.
        points: at most.
        question: what the evidence is asked.
        levels: by the answers to it.
    """

    id: str
    component: str
    title: str
    points: float
    question: str
    levels: Mapping[str, Level]


@dataclass(frozen=True)
class Rubric:
    """All criteria.

    Attributes:
        components: the most points of each part, in the order of the report.
        criteria: in the order of the report.
    """

    components: Mapping[str, float]
    criteria: tuple[Criterion, ...]


def load(path: Path | None = None) -> Rubric:
    """Read a rubric.

    Args:
        path: a YAML file; None takes the course's own.

    Raises:
        RubricError: if it cannot be read, or does not say what a rubric says.
    """
    try:
        text = (
            resources.files("ros2lab.grading").joinpath("rubric.yaml").read_text(encoding="utf-8")
            if path is None
            else path.read_text(encoding="utf-8")
        )
    except (OSError, UnicodeDecodeError) as error:
        raise RubricError(f"{path} cannot be read ({error}); give a YAML file.") from None
    return _RubricReader(str(path or "rubric.yaml"), RubricError).read(text)


class _RubricReader(Reader):
    def read(self, text: str) -> Rubric:
        root = self.root(text)
        if root is None:
            raise RubricError(f"{self.name}: it is empty; see docs/grading.md for what a rubric holds.")
        parts = self.fields(root, "schema", "components", "criteria")
        if self.value(parts["schema"]) != SCHEMA:
            raise self.error(parts["schema"], f"the schema must be {SCHEMA}")
        components = {
            str(name.value): self.number(points, 0) for name, points in self.pairs(parts["components"])
        }
        self._check_total(parts["components"], components)
        criteria: list[Criterion] = []
        for node in self.items(parts["criteria"]):
            criterion = self._criterion(node, components)
            if any(other.id == criterion.id for other in criteria):
                raise self.error(node, f"there is another criterion {criterion.id}; ids must differ")
            criteria.append(criterion)
        for component, points in components.items():
            given = sum(one.points for one in criteria if one.component == component)
            if not math.isclose(given, points):
                raise self.error(
                    parts["criteria"], f"the criteria of {component} add up to {given:g}, not to {points:g}"
                )
        return Rubric(components, tuple(criteria))

    def _check_total(self, node: yaml.Node, components: Mapping[str, float]) -> None:
        total = sum(points for name, points in components.items() if name != BONUS)
        if not math.isclose(total, TOTAL):
            raise self.error(node, f"the components without {BONUS} add up to {total:g}, not to {TOTAL}")
        if components.get(BONUS, 0) > MOST_BONUS:
            raise self.error(node, f"{BONUS} must be at most {MOST_BONUS}")

    def _criterion(self, node: yaml.Node, components: Mapping[str, float]) -> Criterion:
        parts = self.fields(node, "id", "title", "points", "question", "levels")
        id_ = self.text(parts["id"])
        component, dot, name = id_.partition(".")
        if component not in components or not dot or not name:
            known = ", ".join(components)
            raise self.error(parts["id"], f"an id is component.name, with a component of {known}")
        question = self.text(parts["question"])
        if question not in ANSWERS:
            known = ", ".join(sorted(ANSWERS))
            raise self.error(parts["question"], f"there is no question {question}; there are {known}")
        levels = {
            str(answer.value): self._level(level, str(answer.value), NAMES[question])
            for answer, level in self.pairs(parts["levels"])
        }
        if levels.keys() != ANSWERS[question]:
            known = ", ".join(sorted(ANSWERS[question]))
            raise self.error(parts["levels"], f"the levels of {question} must be {known}")
        points = self.number(parts["points"], 0)
        return Criterion(id_, component, self.text(parts["title"]), points, question, levels)

    def _level(self, node: yaml.Node, answer: str, names: frozenset[str]) -> Level:
        parts = self.fields(node, "share", "reason", optional=("hint",))
        share = self.number(parts["share"], 0, 1)
        if share < 1 and "hint" not in parts:
            raise self.error(node, f"{answer} loses points and needs a hint")
        reason, hint = (self._filled(parts[key], names) if key in parts else "" for key in ("reason", "hint"))
        return Level(share, reason, hint)

    def _filled(self, node: yaml.Node, names: frozenset[str]) -> str:
        """Return a text in whose braces stands only what a question can fill in."""
        text = self.text(node)
        try:
            fields = [field[1:] for field in string.Formatter().parse(text) if field[1] is not None]
        except ValueError as error:
            raise self.error(node, f"the braces do not fit ({error})") from None
        for name, spec, conversion in fields:
            if name not in names or spec or conversion:
                known = ", ".join(sorted(names)) or "nothing"
                raise self.error(node, f"{{{name}}} cannot be filled in; what can is {known}")
        return text
