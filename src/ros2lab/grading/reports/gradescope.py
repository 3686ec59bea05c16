"""A grade as Gradescope's results.json.

Its form: https://gradescope-autograders.readthedocs.io/en/latest/specs/#output-format
"""

from __future__ import annotations

import json

from ros2lab.grading.grade import Fault, Grade, Judgement
from ros2lab.grading.reports.shown import disarmed, number, title, visible

MOST = 50  # faults and notes, each


def gradescope(grade: Grade) -> str:
    """Return a grade as results.json: a test for each criterion, and all texts as plain text."""
    result = {
        "score": round(grade.total, 4),
        "execution_time": round(grade.seconds.get("total", 0.0), 2),
        "output": disarmed(_summary(grade)),
        "output_format": "text",
        "test_output_format": "text",
        "test_name_format": "text",
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "tests": [_test(criterion) for criterion in grade.criteria],
    }
    return json.dumps(result, indent=1, allow_nan=False) + "\n"


def _summary(grade: Grade) -> str:
    lines = [
        f"{visible(grade.submission)}: {number(grade.total)} of {number(grade.max)} points (run {grade.run})"
    ]
    for kind, texts in (
        ("Fault", list(map(_fault, grade.faults))),
        ("Note", list(map(visible, grade.notes))),
    ):
        lines += [f"{kind}: {text}" for text in texts[:MOST]]
        if len(texts) > MOST:
            lines.append(f"{kind}: {len(texts) - MOST} more are not shown.")
    return "\n".join(lines)


def _fault(fault: Fault) -> str:
    place = f" ({visible(fault.place)})" if fault.place else ""
    fix = f" Fix: {visible(fault.fix, keeps_lines=True)}" if fault.fix else ""
    return f"{visible(fault.cause)}{place}{fix}"


def _test(criterion: Judgement) -> dict[str, object]:
    lines = [visible(criterion.reason)]
    if criterion.hint:
        lines.append(f"Hint: {visible(criterion.hint)}")
    if criterion.override:
        lines.append(
            f"Set by {visible(criterion.override.by)}: {visible(criterion.override.comment)} "
            f"(the machine gave {number(criterion.override.machine)})"
        )
    return {
        "name": disarmed(f"{title(visible(criterion.component))}: {visible(criterion.title)}"),
        "score": round(criterion.points, 4),
        "max_score": round(criterion.max, 4),
        "status": "passed" if criterion.points >= criterion.max else "failed",
        "output": disarmed("\n".join(lines)),
        "tags": [disarmed(visible(criterion.component))],
        "visibility": "visible",
    }
