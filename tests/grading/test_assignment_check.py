"""`ros2lab assignment check`: what it says of an example, of rubrics that tell nothing apart, and of mistakes."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from evidences import right
from typer.testing import CliRunner

from ros2lab import assignments
from ros2lab.cli import app
from ros2lab.grading.collect import nothing
from ros2lab.grading.questions import QUESTIONS
from ros2lab.grading.rubric import load
from ros2lab.grading.told_apart import Comparison, sentences
from ros2lab.grading.verdict import verdict

LAMP = Path(__file__).parents[2] / "docs/examples/lamp"
FULL, NONE = verdict(right(), load()), verdict(nothing(Path("bare"), "empty"), load())


def test_the_example_is_sound() -> None:
    done = CliRunner().invoke(app, ["assignment", "check", str(LAMP)])
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    assert lines[0] == "The solution gets 100 of 100 points."
    assert lines[1].startswith("What `ros2 pkg create` makes gets ")
    assert [line.split()[0] for line in lines[3:]] == ["package.build"]


def test_what_the_guide_shows_is_an_assignment(tmp_path: Path) -> None:
    text = (LAMP.parents[1] / "assignments.md").read_text(encoding="utf-8")
    asked, service, parameters, rubric = re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)
    (tmp_path / "assignment.yaml").write_text(asked + parameters + service)
    (tmp_path / "rubric.yaml").write_text(rubric)
    read = load(tmp_path / "rubric.yaml", assignments.load(tmp_path))
    assert [*read.assignment.parts] == ["light", "switch"]
    named = set(re.findall(r"`(\w+)`", text)) & QUESTIONS.keys()
    assert {name for name, asked_of in QUESTIONS.items() if asked_of.is_of_part} <= named


@pytest.mark.parametrize(
    ("comparison", "is_sound", "words"),
    [
        (Comparison(FULL, NONE), True, ["110 of 100", "gets 0 of 100"]),
        (Comparison(NONE, NONE), False, ["status_publisher.topic loses 5 of 5: No node"]),
        (
            Comparison(FULL, FULL),
            False,
            ["more than half", "cannot tell", "workspace.layout gives both 6 of 6"],
        ),
    ],
)
def test_it_says_what_tells_nothing_apart(comparison: Comparison, is_sound: bool, words: list[str]) -> None:
    assert comparison.is_sound is is_sound
    text = "\n".join(sentences(comparison))
    assert [word for word in words if word not in text] == []


@pytest.mark.parametrize(
    ("file", "old", "new", "problem"),
    [
        ("assignment.yaml", "SetBool", "SetBol", "assignment.yaml:13: there is no std_srvs/srv/SetBol"),
        ("rubric.yaml", "service_goes_on", "service_lives", "rubric.yaml:13: there is no such question"),
        (
            "rubric.yaml",
            "package: 20",
            "package: 30",
            "rubric.yaml:3: the components without bonus add up to 110",
        ),
        ("solution", "", "", "solution; put a model solution there"),
        ("rubric.yaml", "", "", "cannot be read"),
    ],
)
def test_a_mistake_is_told_with_its_line(tmp_path: Path, file: str, old: str, new: str, problem: str) -> None:
    folder = tmp_path / "lamp"
    shutil.copytree(LAMP, folder)
    path = folder / file
    if old:
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new, 1))
    else:
        path.rename(tmp_path / "elsewhere")
    done = CliRunner().invoke(app, ["assignment", "check", str(folder)])
    assert done.exit_code == 2, done.output
    assert problem in done.stderr
    assert len(done.stderr.splitlines()) == 1
