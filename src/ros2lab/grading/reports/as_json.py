"""A grade as JSON, for programs; `schema.json` beside this file is its JSON Schema."""

from __future__ import annotations

import json
from dataclasses import asdict

from ros2lab.grading.grade import Grade


def as_json(grade: Grade) -> str:
    """Return a grade as JSON: ASCII only, so that nothing in it acts on a terminal.

    Raises:
        ValueError: if a number is not finite.
    """
    data = {"run": grade.run, **asdict(grade)}
    for criterion in data["criteria"]:
        if criterion["override"] is None:
            del criterion["override"]
    return json.dumps(data, indent=1, allow_nan=False) + "\n"
