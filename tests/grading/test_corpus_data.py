"""Is the corpus what it says: are its cases different, is each change made, and does Python read what it should?"""

from __future__ import annotations

import contextlib
import os
import re
import socket
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest
from corpus import BONUS, CASES, COMPONENTS, EXTREMES, FAULTS, HINTS, HOSTILE, PAIRS, STYLES, Case
from corpus.case import Loss
from corpus.hostile.trap import SECRET, trap
from corpus.package import MODEL, SETUP
from corpus.tree import drop, edit, made, move, write

from ros2lab.grading.grade import Fault, Grade, Judgement, Points

MANY_BYTES = ("hostile/zip_bomb", "hostile/zip_many")  # slow to make; the test of `receive` makes the like


VALUES = {"PORT": "1", "DOMAIN": "231", "CANARY": "/canary", "SECRET_FILE": "/secret"}


def test_there_are_enough_and_no_two_have_one_name() -> None:
    names = [case.name for case in CASES]
    assert sorted(names) == sorted(set(names))
    assert len(STYLES) >= 30
    assert len(FAULTS) >= 90
    assert len(PAIRS) >= 24
    assert len(HOSTILE) >= 30
    assert len({hint.name for hint in HINTS}) >= 30
    of_components = {component for case in FAULTS for component in case.loses or {}}
    assert of_components == set(COMPONENTS)
    assert {item for case in FAULTS for item in case.lacks} == set(BONUS)


def test_expectations_can_be_met() -> None:
    """What is earned is not lacking, a loss is possible, every cause is a regular expression, and nothing is unexplained."""
    for case in CASES:
        assert case.about, case.name
        assert not case.earns & case.lacks, case.name
        assert case.earns | case.lacks <= set(BONUS), case.name
        assert case.is_refused <= (case.most == 0), case.name
        for component, loss in (case.loses or {}).items():
            assert 0 <= loss.least <= min(loss.most, COMPONENTS[component]), case.name
            re.compile(loss.cause)


def test_a_fault_costs_something_and_names_its_cause() -> None:
    for case in (*FAULTS, *PAIRS):
        losses = (case.loses or {}).values()
        assert losses or case.lacks, case.name
        assert all(loss.least > 0 and loss.cause for loss in losses), case.name
        assert bool(case.lacks) == bool(case.bonus_cause), case.name


def test_each_fault_changes_the_model_in_its_own_way(tmp_path: Path) -> None:
    write(MODEL, tmp_path / "model" / "robot_project_ws", {})
    seen = {contents(tmp_path / "model"): "the model"}
    for number, case in enumerate((*FAULTS, *PAIRS)):
        case.make(tmp_path / str(number), {})
        found = contents(tmp_path / str(number))
        assert found not in seen, f"{case.name} is {seen[found]}"
        seen[found] = case.name


@pytest.mark.filterwarnings("ignore::SyntaxWarning")  # of what is compared by `is`
@pytest.mark.parametrize(
    "cases",
    [
        pytest.param(STYLES, id="styles"),
        pytest.param(EXTREMES, id="extremes"),
        # Of the same files as the pairs, and the test above writes them, too.
        pytest.param(FAULTS, id="faults", marks=pytest.mark.thorough),
        pytest.param(PAIRS, id="pairs"),
        pytest.param(HOSTILE, id="hostile"),
    ],
)
def test_they_are_written_and_python_reads_what_it_should(cases: tuple[Case, ...], tmp_path: Path) -> None:
    """Nothing of them is run; what stands in an archive is read there."""
    for number, case in enumerate(one for one in cases if one.name not in MANY_BYTES):
        folder = tmp_path / str(number)
        folder.mkdir()
        path = case.make(folder, dict.fromkeys(("TOKEN", "SOCKET"), "token") | VALUES)
        assert path.is_relative_to(folder), case.name
        files = python_files(path)
        wrong = {name for name, data in files.items() if not is_python(data, name)}
        expected = {name for name in files if name.endswith(case.unreadable or ("/",))}
        assert wrong == expected, case.name
        assert bool(expected) == bool(case.unreadable), case.name


def python_files(path: Path) -> dict[str, bytes]:
    """Return the Python files of what was handed in, archives inside archives left out."""
    found: dict[str, bytes] = {}
    if path.is_dir():
        for parent, _, names in os.walk(path):
            for name in names:
                one = Path(parent, name)
                if name.endswith(".py") and one.is_file() and not one.is_symlink():
                    found[str(one)] = one.read_bytes()
    elif path.is_file() and tarfile.is_tarfile(path):
        with tarfile.open(path) as tar:
            for member in tar.getmembers():
                if member.isreg() and member.name.endswith(".py"):
                    data = tar.extractfile(member)
                    found[member.name] = data.read() if data else b""
    elif path.is_file() and zipfile.is_zipfile(path):
        with zipfile.ZipFile(path) as archive:
            for name in archive.namelist():
                if name.endswith(".py"):
                    found[name] = archive.read(name)
    return found


def is_python(data: bytes, name: str) -> bool:
    try:
        compile(data, name, "exec", dont_inherit=True)
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return False
    return True


def contents(folder: Path) -> tuple[tuple[str, bytes], ...]:
    return tuple(
        (str(path.relative_to(folder)), path.read_bytes() if path.is_file() else b"")
        for path in sorted(folder.rglob("*"))
    )


# --- the tools of which it is made ------------------------------------------------------------------------


def test_a_change_that_changes_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="exactly once"):
        made(MODEL, edit(SETUP, "no such text", ""))
    with pytest.raises(ValueError, match="exactly once"):
        made(MODEL, edit(SETUP, "package_name", "name"))  # it stands there several times
    with pytest.raises(ValueError, match="no nothing"):
        made(MODEL, drop("nothing"))
    with pytest.raises(ValueError, match="no nothing"):
        made(MODEL, move("nothing", "something"))


def a_grade(lost: Mapping[str, float], reason: str = "", bonus: frozenset[str] = frozenset(BONUS)) -> Grade:
    """Return a grade in which components have lost so much, for one reason."""
    points = {name: Points(most - lost.get(name, 0), most) for name, most in COMPONENTS.items()}
    points["bonus"] = Points(2 * len(bonus), 10)
    criteria = [
        Judgement(f"{name}.all", name, name, one.points, one.max, reason, "", [])
        for name, one in points.items()
        if name != "bonus"
    ] + [
        Judgement(f"bonus.{item}", "bonus", item, 2.0 * (item in bonus), 2, reason, "", []) for item in BONUS
    ]
    total = sum(one.points for one in points.values())
    return Grade(1, "work", total, 100, points, criteria, [], [], "stepped", "bubblewrap", {}, {})


def a_case(loses: dict[str, Loss] | None, **more: Any) -> Case:
    return Case(
        "case", "about", lambda folder, _: folder, None if loses is None else MappingProxyType(loses), **more
    )


def test_problems_are_found() -> None:
    """A grade that is not what a case must get is told, and one that is has no problems."""
    period = a_case(
        {"status_publisher": Loss(2, 8, r"2\.5 s")},
        earns=frozenset(("launch",)),
        lacks=frozenset(("tests",)),
        bonus_cause="tests fail",
    )
    all_but_tests = frozenset(BONUS) - {"tests"}
    right = "The period is 2.5 s; tests fail."
    assert period.problems(a_grade({"status_publisher": 4}, right, all_but_tests)) == []
    for lost, reason, bonus, part in (
        ({"status_publisher": 0}, right, all_but_tests, "must lose 2 to 8"),
        ({"status_publisher": 10}, right, all_but_tests, "must lose 2 to 8"),
        ({"status_publisher": 4, "package": 1}, right, all_but_tests, "package lost 1 points"),
        ({"status_publisher": 4}, "tests fail", all_but_tests, "must say"),
        ({"status_publisher": 4}, right, frozenset(), "for launch is earned"),
        ({"status_publisher": 4}, right, frozenset(BONUS), "for tests is not earned"),
        ({"status_publisher": 4}, "The period is 2.5 s.", all_but_tests, "The bonus must say"),
    ):
        assert any(part in problem for problem in period.problems(a_grade(lost, reason, bonus)))


def test_a_cause_may_stand_in_a_fault() -> None:
    grade = a_grade({"package": 5}, "It does not build.")
    case = a_case({"package": Loss(1, 15, "setup-syntax")})
    assert case.problems(grade)
    grade.faults.append(Fault("setup-syntax", "package", "A comma is missing.", "setup.py:8", "Write it."))
    assert case.problems(grade) == []


def test_too_many_points_and_a_secret_are_problems() -> None:
    lie = a_case(None, most=40, forbidden=(SECRET,))
    assert any("at most 40" in problem for problem in lie.problems(a_grade({})))
    shown = a_grade(dict(COMPONENTS), f"It says {SECRET}.", frozenset())
    assert [problem for problem in lie.problems(shown) if "shows" in problem]
    assert lie.problems(a_grade(dict(COMPONENTS), "Nothing.", frozenset())) == []


def test_the_extremes_get_little() -> None:
    assert all(case.most <= 10 for case in EXTREMES if case.loses is None)


# --- the trap ---------------------------------------------------------------------------------------------


def test_a_trap_that_nothing_enters_is_silent(tmp_path: Path) -> None:
    with trap(tmp_path / "work") as values:
        assert Path(values["CANARY"]).is_file()


def _change_report(values: Mapping[str, str]) -> None:
    Path(values["CANARY"]).write_text("110 points")


def _write_beside(values: Mapping[str, str]) -> None:
    Path(values["CANARY"]).with_name("more.txt").write_text("here")


def _change_secret(values: Mapping[str, str]) -> None:
    Path(values["SECRET_FILE"]).write_text("mine")


def _connect(values: Mapping[str, str]) -> None:
    with socket.create_connection(("127.0.0.1", int(values["PORT"]))):
        pass


def _connect_abstract(values: Mapping[str, str]) -> None:
    with socket.socket(socket.AF_UNIX) as out:
        out.connect("\0" + values["SOCKET"])


def _discover(values: Mapping[str, str]) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        out.sendto(b"RTPS", ("127.0.0.1", 7400 + 250 * int(values["DOMAIN"])))


@pytest.mark.parametrize(
    ("harm", "said"),
    [
        (_change_report, "changed a report"),
        (_write_beside, "written beside"),
        (_change_secret, "changed a file"),
        (_connect, "by tcp"),
        (_connect_abstract, "by unix"),
        (_discover, "by udp"),
    ],
)
def test_a_trap_tells_of_harm(tmp_path: Path, harm: Callable[[Mapping[str, str]], None], said: str) -> None:
    with pytest.raises(AssertionError, match=said), trap(tmp_path / "work") as values:
        harm(values)


def test_a_trap_tells_of_a_file_that_was_left(tmp_path: Path) -> None:
    left = contextlib.ExitStack()
    with left, pytest.raises(AssertionError, match="has left"), trap(tmp_path / "work") as values:
        _leave_file(left, Path(tempfile.gettempdir(), values["TOKEN"]))


def _leave_file(until: contextlib.ExitStack, path: Path) -> None:
    until.callback(path.unlink)
    path.touch()


def test_a_trap_tells_of_a_process_that_was_left(tmp_path: Path) -> None:
    with pytest.raises(AssertionError, match="still runs"), trap(tmp_path / "work") as values:
        left = subprocess.Popen([sys.executable, "-c", "input()", values["TOKEN"]], stdin=subprocess.PIPE)
    left.communicate()
