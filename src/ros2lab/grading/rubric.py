"""The rubric: what each point is given for, as data that an instructor can read and change.

A criterion asks the evidence one question of `ros2lab.grading.questions`. The answer is the name of a level,
and the level says what share of the points it is worth, and why, in a sentence. The usual text of each level
stands once for all assignments, beside the questions; a rubric gives the points, and changes levels where it
differs.
"""

from __future__ import annotations

import math
import re
import string
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from pathlib import Path

import yaml

from ros2lab import assignments
from ros2lab.assignments import Assignment
from ros2lab.grading.questions import QUESTIONS, Question
from ros2lab.grading.questions.answer import asked
from ros2lab.located_yaml import QUICK, Reader

SCHEMA = 1
LEVELS = "levels.yaml"
TOTAL, MOST_BONUS = 100, 10
DOUBTED = 0.5
UNTRIED = 0.5
_FILE = re.compile(r"\w+[._/]\w")  # a file name at the beginning of a title keeps its case
BONUS = "bonus"


class RubricError(Exception):
    """A rubric that cannot be used; the message names the file, the line, and what to change."""


@dataclass(frozen=True)
class Level:
    """An answer to a question and what it is worth.

    Attributes:
        share: the share of the criterion's points, from 0 to 1.
        reason: one sentence; names in braces are replaced by what was seen.
        hint: what to change; empty where nothing is lost.
    """

    share: float
    reason: str
    hint: str = ""


@dataclass(frozen=True)
class Criterion:
    """What some of the points are given for.

    Attributes:
        id: `component.name`; overrides refer to it.
        component: the component to which it belongs.
        title: a few words.
        points: the most that it can give.
        question: the question that the evidence is asked.
        levels: the levels by their answers.
    """

    id: str
    component: str
    title: str
    points: float
    question: str
    levels: Mapping[str, Level]


@dataclass(frozen=True)
class Rubric:
    """All criteria of an assignment.

    Attributes:
        assignment: the assignment; a component with the name of one of its parts is about that part.
        components: the most points of each component, in the order of the report.
        criteria: in the order of the report.
        doubted: the share that counts of what any node does, where that by which the part's node is known has
            earned less than half.
        untried: the share that counts of what could not be tried for want of what is not where it is graded,
            where that is so with more than one node.
    """

    assignment: Assignment
    components: Mapping[str, float]
    criteria: tuple[Criterion, ...]
    doubted: float = DOUBTED
    untried: float = UNTRIED


def load(path: Path | None = None, assignment: Assignment | None = None) -> Rubric:
    """Read a rubric.

    Args:
        path: a YAML file; None takes the course's own.
        assignment: the assignment to which it belongs; None takes the course's own.

    Raises:
        RubricError: if it cannot be read, or is not a valid rubric.
    """
    try:
        text = (
            resources.files("ros2lab.assignments")
            .joinpath(f"{assignments.WEEK_2}/rubric.yaml")
            .read_text("utf-8")
            if path is None
            else path.read_text(encoding="utf-8")
        )
    except (OSError, UnicodeDecodeError) as error:
        raise RubricError(f"{path} cannot be read ({error}); give a YAML file.") from None
    reader = _RubricReader(str(path or "rubric.yaml"), RubricError)
    return reader.read(text, assignment or assignments.load())


class _RubricReader(Reader):
    def read(self, text: str, assignment: Assignment) -> Rubric:
        root = self.root(text)
        if root is None:
            raise RubricError(f"{self.name}: it is empty; see docs/grading.md for what a rubric holds.")
        parts = self.fields(root, "schema", "components", "criteria", optional=("doubted", "untried"))
        if self.value(parts["schema"]) != SCHEMA:
            raise self.error(parts["schema"], f"the schema must be {SCHEMA}")
        components = {
            str(name.value): self.number(points, 0) for name, points in self.pairs(parts["components"])
        }
        self._check_total(parts["components"], components)
        criteria: list[Criterion] = []
        for node in self.items(parts["criteria"]):
            criterion = self._criterion(node, components, assignment)
            if any(earlier.id == criterion.id for earlier in criteria):
                raise self.error(node, f"there is another criterion {criterion.id}; ids must differ")
            criteria.append(criterion)
        for component, points in components.items():
            given = sum(criterion.points for criterion in criteria if criterion.component == component)
            if not math.isclose(given, points):
                raise self.error(
                    parts["criteria"], f"the criteria of {component} add up to {given:g}, not to {points:g}"
                )
        shares = {name: self.number(parts[name], 0, 1) for name in ("doubted", "untried") if name in parts}
        return Rubric(assignment, components, tuple(criteria), **shares)

    def _check_total(self, node: yaml.Node, components: Mapping[str, float]) -> None:
        total = sum(points for name, points in components.items() if name != BONUS)
        if not math.isclose(total, TOTAL):
            raise self.error(node, f"the components without {BONUS} add up to {total:g}, not to {TOTAL}")
        if components.get(BONUS, 0) > MOST_BONUS:
            raise self.error(node, f"{BONUS} must be at most {MOST_BONUS}")

    def _criterion(
        self, node: yaml.Node, components: Mapping[str, float], assignment: Assignment
    ) -> Criterion:
        parts = self.fields(node, "id", "points", "question", optional=("title", "levels"))
        id_ = self.text(parts["id"])
        component, dot, name = id_.partition(".")
        if component not in components or not dot or not name:
            known = ", ".join(components)
            raise self.error(parts["id"], f"an id is component.name, with a component of {known}")
        question = QUESTIONS.get(self.text(parts["question"]))
        if question is None:
            known = ", ".join(sorted(QUESTIONS))
            raise self.error(parts["question"], f"there is no such question; there are {known}")
        part = assignment.parts.get(component)
        if question.is_of_part and part is None:
            known = ", ".join(assignment.parts)
            raise self.error(
                parts["question"], f"{question.name} is asked of a part, and the parts are {known}"
            )
        if question.is_of_part and part is not None and part.end not in question.ends:
            raise self.error(
                parts["question"],
                f"{question.name} is asked of a {' or a '.join(question.ends)}, and {component} is a {part.end}",
            )
        if part is not None and question.needs and not getattr(part, question.needs):
            raise self.error(
                parts["question"],
                f"{question.name} is asked of a part with {question.needs}, and {component} has none",
            )
        points = self.number(parts["points"], 0)
        title, usual = _usual()[question.name]
        if "title" in parts:
            title = self.text(parts["title"])
        elif part is not None:
            title = title.format_map(asked(part))
        levels = dict(usual)
        for answer, level in self.pairs(parts["levels"]) if "levels" in parts else ():
            if answer.value not in usual:
                raise self.error(answer, f"the levels of {question.name} are {', '.join(question.answers)}")
            levels[answer.value] = self._changed(level, usual[answer.value], question)
        return Criterion(
            id_,
            component,
            title if _FILE.match(title) else title[:1].upper() + title[1:],
            points,
            question.name,
            levels,
        )

    def _changed(self, node: yaml.Node, usual: Level, question: Question) -> Level:
        """Return a level as the rubric changes it: its share only, or its share, reason and hint."""
        if isinstance(node, yaml.MappingNode):
            return self.level(node, question)
        share = self.number(node, 0, 1)
        if share < 1 and not usual.hint:
            raise self.error(node, "this level loses points and needs a share, a reason and a hint")
        return replace(usual, share=share)

    def level(self, node: yaml.Node, question: Question) -> Level:
        """Return a level that is written out in full."""
        parts = self.fields(node, "share", "reason", optional=("hint",))
        share = self.number(parts["share"], 0, 1)
        if share < 1 and "hint" not in parts:
            raise self.error(node, "this level loses points and needs a hint")
        reason, hint = (
            self._filled(parts[key], question.names) if key in parts else "" for key in ("reason", "hint")
        )
        return Level(share, reason, hint)

    def _filled(self, node: yaml.Node, names: frozenset[str]) -> str:
        """Return a text after a check that its braces hold only names that the question fills in."""
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


@cache
def _usual() -> Mapping[str, tuple[str, Mapping[str, Level]]]:
    """Return by question the usual title of its criterion, and the usual levels by answer."""
    text = resources.files("ros2lab.grading.questions").joinpath(LEVELS).read_text(encoding="utf-8")
    reader = _RubricReader(LEVELS, RubricError)
    root = reader.root(text, QUICK)
    found = {}
    for name, node in reader.pairs(root) if root is not None else ():
        question = QUESTIONS[name.value]
        parts = reader.fields(node, "title", "levels")
        levels = {
            answer.value: reader.level(level, question) for answer, level in reader.pairs(parts["levels"])
        }
        if (*levels,) != question.answers:
            raise reader.error(node, f"the levels of {question.name} are {', '.join(question.answers)}")
        found[question.name] = reader.text(parts["title"]), levels
    return found
