"""A grade as JSON, for programs; `schema.json` beside this file is its JSON Schema."""

from __future__ import annotations

import json
from dataclasses import asdict

from ros2lab.grading.grade import Grade, run_of


def as_json(grade: Grade) -> str:
    """Return a grade as JSON: ASCII only, so that nothing in it acts on a terminal.

    Raises:
        ValueError: if a number is not finite.
    """
    plain = asdict(grade)
    data = {"run": run_of(plain), **plain}
    for criterion in data["criteria"]:
        if criterion["override"] is None:
            del criterion["override"]
    return json.dumps(data, indent=1, allow_nan=False) + "\n"
