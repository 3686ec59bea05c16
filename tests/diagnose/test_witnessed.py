"""Programs that note what their conditions and loops come to: they do the same, and what was never true is told."""

from __future__ import annotations

import operator
import os
import subprocess
import sys
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.trial import witness
from ros2lab.trial.witnessed import environ_in, witnessed
from ros2lab.trial.witnessed import is_contradicted as judged

NAME = NAMES[0]
PROGRAM = """\
from __future__ import annotations

LINES = ['left\\n', 'jump\\n', 'Stop\\n']


class Dancer:
    def __init__(self):
        self.steps = MADE
        self.turns = []

    def tick(self, number, step):
        BODY

    def nearest(self, found):
        return min(found)


def main():
    dancer = Dancer()
    for number in range(5):
        dancer.tick(number, LINES[number % 3])
    print(dancer.turns)


main()
"""


def noted(
    body: str, folder: Path, made: str = "[1, 2, 3, 4]"
) -> tuple[str, str, list[Finding], list[Finding]]:
    """Return what a program prints by itself, and while it notes, and what it has noted."""
    files = Files.right(NAME)
    code = PROGRAM.replace("BODY", body.replace("\n", "\n        ")).replace("MADE", made)
    root = files.put("node", code).write(folder / "ws")
    module, notes = root / "src" / NAME.package, folder / "notes"
    notes.mkdir()
    printed = []
    for own in ({}, environ_in(notes, root, {})):
        environ = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"} | own
        command = [sys.executable, "-c", f"import {NAME.package}.{Path(files.path('node')).stem}"]
        done = subprocess.run(command, cwd=module, env=environ, capture_output=True, text=True, check=False)
        printed.append(done.stdout + done.stderr)
    found = witnessed(notes, Look(root))
    return *printed, found.wrong, [*found.never, *found.steady]  # type: ignore[return-value]


@pytest.mark.parametrize(
    ("body", "made", "code", "fix"),
    [
        ("if step == 'left': self.turns.append(1)\nelif step == 'jump': self.turns.append(2)", "[]", "never-equal", "write `step = step.strip()` above line 12"),
        ("if step.strip() == 'stop': self.turns.append(1)", "[]", "never-equal", ""),
        ("if sum([0.1] * number) == 0.3: self.turns.append(1)", "[]", "never-equal", "compare with `math.isclose(sum([0.1] * number), 0.3, abs_tol=1e-9)`"),
        ("for one in self.steps: self.turns.append(one)", "map(str, [1, 2])", "used-up", "write list(...) around the value given to self.steps"),
        ("for one in self.steps: self.turns.append(one)", "(n for n in (1, 2))", "used-up", "list(...)"),
        ("for one in self.steps: self.steps.remove(one)", "[1, 2, 3, 4]", "changed-in-loop", "write `in list(self.steps)`"),
    ],
)  # fmt: skip
def test_what_never_happens_is_told(tmp_path: Path, body: str, made: str, code: str, fix: str) -> None:
    alone, noting, wrong, never = noted(body, tmp_path, made)
    assert noting == alone
    found = [one for one in (*wrong, *never) if one.code == code]
    assert found, (alone, wrong, never)
    assert fix in found[0].fix


@pytest.mark.parametrize(
    ("body", "made"),
    [
        ("if step == 'left\\n': self.turns.append(1)", "[]"),
        ("for one in self.steps: self.turns.append(one)", "[1, 2]"),
        ("for one in list(self.steps): self.steps.remove(one)", "[1, 2, 3, 4]"),
        ("for one in self.steps:\n    self.turns.append(one)\n    if one > 1: break", "[1, 2, 3]"),
        ("while self.steps and self.steps.pop() != 3: self.turns.append(0)", "[1, 3, 2, 3]"),
        ("if number == 99 is None or not self.turns: self.turns.append(number)", "[]"),
        ("if self.steps is None or number in range(9): self.turns.append([s for s in self.steps if s > 1])", "[1, 2]"),
        ("self.turns.append('x' if number < 9 else 'y')", "[]"),
        ("match number > 9:\n    case True: self.turns.append(1)", "[]"),
        ("match (number == 9):\n    case True if number > 7: self.turns.append(1)", "[]"),
        ("match 0 < number < 9, number in self.steps:\n    case _, True: self.turns.append(1)", "[1]"),
        ("if 0 < number < 9: raise SystemExit(number)", "[]"),
        ("self.steps = self.steps ** 2\nif self.steps == 0 or self.steps == 1.0: self.turns.append(1)", "10 ** 400"),
    ],
)  # fmt: skip
def test_a_program_does_the_same_and_nothing_is_wrong(tmp_path: Path, body: str, made: str) -> None:
    alone, noting, wrong, _ = noted(body, tmp_path, made)
    assert noting == alone
    assert wrong == []


@pytest.mark.parametrize(
    ("body", "has_changed"),
    [
        ("if number % 3 > 9: self.turns.append(1)", True),
        ("if len(self.steps) > 9: self.turns.append(1)", False),
    ],
)
def test_a_condition_of_which_nothing_changed_may_wait_for_what_did_not_come(
    tmp_path: Path, body: str, *, has_changed: bool
) -> None:
    noted(body, tmp_path)
    found = witnessed(tmp_path / "notes", Look(tmp_path / "ws"))
    assert (len(found.never), len(found.steady), found.wrong) == (has_changed, not has_changed, [])


NAN = "nan, ranges = float('nan'), [float('nan'), 2.0, 0.3]\n"


@pytest.mark.parametrize(
    ("body", "fix"),
    [
        ("near = min(ranges)\nif near < 0.5: self.turns.append(1)", "write min([v for v in ranges if math.isfinite(v)], default=math.inf)"),
        ("self.far = max(ranges)\nif 1.0 < self.far < 9.0: self.turns.append(1)", "max([v for v in ranges if math.isfinite(v)], default=-math.inf)"),
        ("if sum(ranges) / 3 > 0.5 or number > 9: self.turns.append(1)", "sum([v for v in ranges"),
        ("near = self.nearest(ranges)\nwhile near < 0.5: near += 1", "min([v for v in found"),
        ("import statistics\nmiddle = statistics.fmean(ranges)\nself.turns += [1 if middle >= 1 else 2]", "statistics.fmean([v for"),
    ],
)  # fmt: skip
def test_what_makes_nan_of_many_values_is_wrong_if_it_is_compared(
    tmp_path: Path, body: str, fix: str
) -> None:
    alone, noting, wrong, never = noted(f"{NAN}{body}", tmp_path)
    assert (noting, never) == (alone, [])
    (found,) = wrong
    assert (found.code, fix in found.fix) == ("value-nan", True)
    assert "was nan in 5 of 5 checks" in found.cause


@pytest.mark.parametrize(
    "body",
    [
        "self.turns += [r for r in ranges if r > 0.5]",  # left out by this
        "for r in ranges:\n    if r < 0.5: self.turns.append(r)",
        "near = min(ranges)\nif near == near and near < 0.5: self.turns.append(1)",
        "near = min(ranges)\nif not near > 0.5: self.turns.append(1)",
        "near = min(r for r in ranges if r > 0)\nif near < 0.5: self.turns.append(near)",
        "self.last = nan\nif self.last > 0.5: self.turns.append(1)",  # nothing yet
        "far = max(ranges[1:])\nif far > 0.5: self.turns.append(far)",
    ],
)
def test_a_value_that_may_be_nan_is_not_wrong(tmp_path: Path, body: str) -> None:
    alone, noting, wrong, _ = noted(f"{NAN}{body}", tmp_path)
    assert noting == alone
    assert wrong == []


@pytest.mark.parametrize(
    ("body", "asked"),
    [
        ("found = 'hop' in {step.strip()}", {"hop"}),
        ("self.turns += [step.strip() == word for word in ('go', 'left')]", {"go"}),
        ("step.strip() in self.steps", {"fly", "run"}),
        ("word = 'wait' if number else 'rest'\nif number > 9 or word == step.strip(): pass", {"wait", "rest"}),
        ("step.strip() is 'no' or number == 4", set()),
    ],
)  # fmt: skip
def test_what_is_looked_for_where_a_text_is_is_known(tmp_path: Path, body: str, asked: set[str]) -> None:
    alone, noting, *_ = noted(body, tmp_path, "{'fly': 1, 'run': 2}")
    assert noting == alone
    record = witnessed(tmp_path / "notes", Look(tmp_path / "ws")).unreached.record
    assert record.asked_beside("left") - {"left", "jump", "Stop"} == asked


@pytest.mark.parametrize(
    ("body", "is_told"),
    [
        ("if number % 3 > 9: return\nself.turns.append(1)", False),
        ("if number % 3 > 9:\n    print('too many')\n    return", False),
        ("if number % 3 > 9 and self.turns: raise RuntimeError", False),
        ("if number % 3 > 9: print('many')", True),
        ("if not number % 3 > 9: return", True),
        ("if number % 3 > 9: return\nelse: self.turns.append(1)", True),
        ("self.at = number % 3\nif self.at > 9: return\nself.turns.append(1)", True),  # a state of its own
    ],
)
def test_a_guard_against_what_did_not_come_is_not_told(tmp_path: Path, body: str, *, is_told: bool) -> None:
    *_, never = noted(body, tmp_path)
    assert [one.code for one in never] == ["never-equal"] * is_told


def test_the_checks_of_two_runs_do_not_follow_each_other(tmp_path: Path) -> None:
    *_, never = noted("if number % 3 > 9: self.turns.append(1)", tmp_path)
    assert "in 5 checks" in never[0].cause
    (file,) = (tmp_path / "notes" / "noted").glob("*.json")
    file.with_name("2.json").write_text(file.read_text(encoding="utf-8"), encoding="utf-8")
    found = witnessed(tmp_path / "notes", Look(tmp_path / "ws"))
    assert [one.cause for one in found.never] == [never[0].cause]


@pytest.mark.parametrize(
    ("body", "code", "is_contradicted"),
    [
        ("self.turns.append(number)", "argument-order", True),
        ("self.turns.append(\n    number\n)", "argument-type", True),
        ("self.turns.append(number)", "unreachable", True),
        ("self.turns.append(number)", "callback-called", False),  # it fails later
        ("self.turns.append(number)", "period", False),  # it fails nowhere
        ("if number > 99: self.turns.append(number)", "argument-order", False),
        ("self.turns.append(number > 99 and step.data)", "argument-order", False),
        ("self.later = lambda: step.data", "attribute-missing", False),
        (
            "try:\n    self.turns.append(number, number)\nexcept TypeError:\n    pass",
            "argument-unknown",
            False,
        ),
    ],
)
def test_a_line_that_came_to_its_end_does_not_fail(
    tmp_path: Path, body: str, code: str, *, is_contradicted: bool
) -> None:
    noted(body, tmp_path)
    look = Look(tmp_path / "ws")
    (source,) = (one for one in look.files if "class Dancer" in one.text)
    lines = source.text.splitlines()
    line = next(n for n, text in enumerate(lines, 1) if "self.turns.append" in text or "self.later" in text)
    found = Finding(code, "It fails.", source.at(line))
    assert judged(found, look, witnessed(tmp_path / "notes", look)) is is_contradicted


def test_a_name_that_an_imported_file_never_has_is_as_it_should_be(tmp_path: Path) -> None:
    *_, wrong, never = noted("if __name__ == '__main__': self.turns.append(1)", tmp_path)
    assert (wrong, never) == ([], [])


def test_what_is_long_is_not_shown(tmp_path: Path) -> None:
    """A message or a list may take longer to show than to compare."""
    *_, never = noted("if self.turns == [step] * 9_999: print('never')", tmp_path)
    (found,) = never
    assert "self.turns was an empty list and [step] * 9999 was a list of 9999" in found.cause


def test_an_error_names_the_line_that_it_names_without(tmp_path: Path) -> None:
    alone, noting, *_ = noted("if step.data == 'left': pass", tmp_path)
    assert "AttributeError" in alone
    assert [one for one in noting.splitlines() if "line" in one] == [
        one for one in alone.splitlines() if "line" in one
    ]


def test_which_functions_were_called_is_known(tmp_path: Path) -> None:
    noted("if number > 2: self.turns.append(number)", tmp_path)
    look = Look(tmp_path / "ws")
    called = witnessed(tmp_path / "notes", look).called
    lines = {line for source, line in called if source.path and "main" in source.text}
    text = (
        tmp_path / "ws" / "src" / NAME.package / Files.right(NAME).path("node").split("/", 2)[2]
    ).read_text()
    assert {text.splitlines()[line - 1].split("(")[0].split()[-1] for line in lines} >= {"main", "__init__"}


KINDS = """\
class Animal:
    def tell(self):
        print(type(self).__name__)


class Lion(Animal):
    pass


class Unicorn(Animal):
    pass


class Den:
    def __init__(self, type):
        self.type = type


Den([kind for kind in Animal.__subclasses__() if kind.__name__ != 'Unicorn'][0]().tell())
"""


def test_the_classes_of_the_objects_are_noted(tmp_path: Path) -> None:
    """Also of one without a method of its own, and whatever the parameters are called."""
    root = Files.right(NAME).put("PACKAGE/zoo.py", KINDS).write(tmp_path / "ws")
    module, notes = root / "src" / NAME.package, tmp_path / "notes"
    notes.mkdir()
    environ = {**os.environ, **environ_in(notes, root, {})}
    command = [sys.executable, "-c", f"import {NAME.package}.zoo"]
    done = subprocess.run(command, cwd=module, env=environ, capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("Lion\n", "")
    lines = KINDS.splitlines()
    ran = {
        lines[line - 1].partition("(")[0].partition(":")[0] for _, line in witnessed(notes, Look(root)).called
    }
    assert ran == {"    def tell", "class Lion", "    def __init__", "class Den"}


@pytest.mark.parametrize(
    ("pairs", "times", "most"),
    [
        ([("idle", "busy")], 2000, 1),
        ([("idle", "busy"), ("busy", "idle"), ("idle", "idle")], 2000, 3),
        ([(f"tick {number}", "stop") for number in range(2000)], 1, 1000),
        ([("idle", ["busy", "done"])], 2000, 1000),
        ([(1, 2), (1, "one"), (None, ["one"])], 2000, 0),
    ],
)
def test_texts_that_were_compared_before_cost_no_time(
    pairs: list[tuple[object, object]], times: int, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nor do those of a place where very many were compared."""
    met = list[object]()
    monkeypatch.setattr(witness, "_meet", lambda *pair: met.append(pair))
    looked = witness._looking(operator.eq)
    for pair in pairs * times:
        assert looked(*pair) == operator.eq(*pair)
    assert len(met) <= most
    assert {*map(repr, met)} == {*map(repr, pairs)} or most in (0, 1000)
