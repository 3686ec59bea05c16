"""A grade as JUnit XML, for CI: a suite for each component, a case for each criterion."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from ros2lab.grading.grade import Grade, Judgement
from ros2lab.grading.reports.losses import BONUS
from ros2lab.grading.reports.shown import number, visible


def junit(grade: Grade) -> str:
    """Return a grade as JUnit XML.

    A criterion that lost points has failed; a bonus criterion was skipped.
    """
    seconds = number(grade.seconds.get("total", 0.0))
    root = ET.Element("testsuites", name=visible(grade.submission), id=grade.run, time=seconds)
    for component, given in grade.components.items():
        criteria = [criterion for criterion in grade.criteria if criterion.component == component]
        suite = ET.SubElement(root, "testsuite", name=visible(component), tests=str(len(criteria)))
        properties = ET.SubElement(suite, "properties")
        for name, value in (("points", given.points), ("max", given.max)):
            ET.SubElement(properties, "property", name=name, value=number(value))
        for criterion in criteria:
            _add(suite, criterion)
        _count(suite, suite.findall("testcase"))
    _count(root, root.findall("testsuite/testcase"))
    ET.indent(root, " ")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'


def _add(suite: ET.Element, criterion: Judgement) -> None:
    case = ET.SubElement(
        suite, "testcase", classname=visible(criterion.component), name=visible(criterion.title), time="0"
    )
    reason = f"{number(criterion.points)} of {number(criterion.max)} points: {visible(criterion.reason)}"
    if criterion.points < criterion.max:
        is_bonus = criterion.component == BONUS
        kind = {} if is_bonus else {"type": "LostPoints"}
        lost = ET.SubElement(case, "skipped" if is_bonus else "failure", {"message": reason, **kind})
        lost.text = visible(criterion.hint)
    said = reason
    if criterion.override:
        said += (
            f"\nSet by {visible(criterion.override.by)}: {visible(criterion.override.comment)} "
            f"(the machine gave {number(criterion.override.machine)})"
        )
    ET.SubElement(case, "system-out").text = said


def _count(element: ET.Element, cases: list[ET.Element]) -> None:
    element.set("tests", str(len(cases)))
    for name, tag in (("failures", "failure"), ("skipped", "skipped")):
        element.set(name, str(sum(case.find(tag) is not None for case in cases)))
    element.set("errors", "0")
