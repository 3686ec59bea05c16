"""What an assignment asks for, as data: a folder with `assignment.yaml` and `rubric.yaml`.

The lessons' checks, the demo and the grader read it here, so that a topic, a type or a period is written once.
"""

from ros2lab.assignments.assignment import (
    WEEK_2,
    AskedParameter,
    Assignment,
    AssignmentError,
    End,
    Exchange,
    Part,
    load,
)

__all__ = ["WEEK_2", "AskedParameter", "Assignment", "AssignmentError", "End", "Exchange", "Part", "load"]
