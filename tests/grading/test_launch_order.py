"""Which launch files are tried first, and what is said of the others."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import evidences
import pytest

from ros2lab.grading.evidence import Evidence
from ros2lab.grading.reading.launch_files import programs_named, those_that_start_most_first
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

PROGRAMS = ("status_publisher", "command_subscriber", "velocity_publisher")
SINGLE = {f"{name}.launch.py": f"Node(package='a', executable='{name}')" for name in PROGRAMS}
XML = "".join(f"<node pkg='a' exec='{name}'/>" for name in PROGRAMS)


@pytest.mark.parametrize(
    ("files", "first"),
    [
        ({**SINGLE, "whole_robot.launch.py": " ".join(SINGLE.values())}, "whole_robot.launch.py"),
        ({**SINGLE, "zz.launch.xml": XML}, "zz.launch.xml"),
        ({**SINGLE, "zz.launch.yaml": "".join(f"- node: {{exec: {one}}}\n" for one in PROGRAMS)}, "zz.launch.yaml"),
        ({**SINGLE, "zz.launch.py": f"for name in {PROGRAMS}: add(Node(executable=name))"}, "zz.launch.py"),
        ({**SINGLE, "zz.launch.py": " ".join(f"include('{name}')" for name in SINGLE)}, "zz.launch.py"),
        ({**SINGLE, "y.launch.py": XML, "zz.launch.py": "include('y.launch.py')"}, "y.launch.py"),
        ({**SINGLE, "zz.launch.py": "include('zz.launch.py')"}, "status_publisher.launch.py"),
        ({**SINGLE, "zz.launch.py": "exec='my_status_publisher_2', 'status_publisher2'"}, "status_publisher.launch.py"),
        (SINGLE, "status_publisher.launch.py"),
    ],
    ids=["Python", "XML", "YAML", "loop", "includes", "equals", "itself", "other names", "one each"],
)  # fmt: skip
def test_the_launch_file_that_starts_most_comes_first(files: dict[str, str], first: str) -> None:
    texts = {Path(name): text for name, text in files.items()}
    order = those_that_start_most_first(texts, programs_named(texts, PROGRAMS))
    assert next(iter(order)) == Path(first)
    assert {str(path): text for path, text in order.items()} == files


def test_what_was_not_tried_is_named() -> None:
    """Where none was tried, or all were, there is nothing to say of that."""
    right = evidences.right()
    others = [f"launch/{number}.launch.py" for number in range(2)]
    more = replace(right, files=replace(right.files, launch_files=[*right.files.launch_files, *others]))
    notes = [note for note in verdict(more, load()).notes if "not tried" in note]
    assert notes == [
        "Of the launch files those were tried that start most; not tried: launch/0.launch.py and launch/1.launch.py."
    ]
    assert not any("not tried" in note for note in verdict(right, load()).notes)


def _prefixed(said: list[str], named: list[str], *, is_started: bool = False) -> Evidence:
    """Return evidence in which a launch file starts no velocity publisher, and launch has said something."""
    alone = [evidences.status_run(), evidences.command_run(), evidences.velocity_run()]
    run = evidences.launched(alone if is_started else alone[:2])
    run = replace(run, log=[*run.log, *(["PRINT", line] for line in said)])
    given = evidences.right()
    facts = replace(given.files, launched_programs={given.files.launch_files[0]: named})
    runs = [one for one in given.runs if one.setting != "launched"]
    return replace(given, files=facts, runs=[*runs, run])


NOT_HERE = (
    "[ERROR] [{0}-3]: exception occurred while executing process: [Errno 2] No such file or directory: '{0}'"
)


@pytest.mark.parametrize(
    ("said", "named", "points"),
    [
        ([NOT_HERE.format("xterm")], PROGRAMS, 2),
        ([NOT_HERE.format("gnome-terminal")], PROGRAMS, 2),
        (["FileNotFoundError: [Errno 2] No such file or directory: 'valgrind'"], PROGRAMS, 2),
        ([], PROGRAMS, 1),
        ([NOT_HERE.format("xterm")], PROGRAMS[:2], 1),  # which it does not start at all
        ([NOT_HERE.format("velocity_publishr")], PROGRAMS, 1),
        ([NOT_HERE.format("pyton3")], PROGRAMS, 1),
        (["[status_publisher-1] " + NOT_HERE.format("xterm")], PROGRAMS, 1),
        ([NOT_HERE.format("/home/ada/bin/xterm")], PROGRAMS, 1),
    ],
    ids=["xterm", "terminal", "real launch", "nothing", "not named", "misspelt", "misspelt tool", "printed", "path"],
)  # fmt: skip
def test_a_prefix_that_is_not_here_costs_nothing(said: list[str], named: list[str], points: float) -> None:
    grade = verdict(_prefixed(said, [*named]), load())
    found = next(one for one in grade.criteria if one.id == "bonus.launch")
    assert found.points == points
    if points == 2:
        assert "not installed here" in found.reason
        assert "left to the instructor" in found.reason
