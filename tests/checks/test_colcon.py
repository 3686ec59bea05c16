"""The checks of the colcon lesson accept every right answer, and say what is wrong with the others."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from ros2lab import checks, environment
from ros2lab.checks import CheckError, programs
from ros2lab.checks import colcon as check
from ros2lab.pictures import package_graph

MANIFEST = """<package format="3"><name>{name}</name><version>1.0.0</version><description>A test</description>
<maintainer email="ada@example.org">Ada</maintainer><license>Apache-2.0</license>{lines}
<export><build_type>ament_python</build_type></export></package>"""
SETUP = """from setuptools import setup

setup(name="{name}", version="1.0.0", packages=["{name}"], zip_safe=True,
      data_files=[("share/ament_index/resource_index/packages", ["resource/{name}"]),
                  ("share/{name}", ["package.xml"])],
      extras_require={{"test": ["pytest"]}},
      entry_points={{"console_scripts": ["blow = {name}.blow:main"]}})
"""
SETUP_CFG = "[develop]\nscript_dir=$base/lib/{name}\n[install]\ninstall_scripts=$base/lib/{name}\n"
HARBOUR = {
    "crane_app": ("crane_driver", "harbour_map"),
    "crane_driver": ("load_model",),
    "harbour_map": (),
    "load_model": (),
    "ship_pilot": ("harbour_map",),
}
BLOW = 'def main():\n    print("{sound}")\n'
CHARGE = "def percent(volts):\n    {body}\n"
FAULTY = "return (volts - 10) / 2 * 100"
MENDED = f"return max(0, {FAULTY[7:]})"
TESTS = """from battery.charge import percent


def test_full(): assert percent(12.0) == 100


def test_half(): assert percent(11.0) == 50


{mark}
def test_less_than_empty(): assert percent(9.5) == {empty}
"""


def make_package(folder: Path, needs: tuple[str, ...] = ()) -> Path:
    """Make an ament_python package; return the folder of its modules."""
    name = folder.name
    lines = "".join(f"<depend>{need}</depend>" for need in needs)
    for path, text in (
        ("package.xml", MANIFEST.format(name=name, lines=lines)),
        ("setup.py", SETUP.format(name=name)),
        ("setup.cfg", SETUP_CFG.format(name=name)),
        (f"resource/{name}", ""),
        (f"{name}/__init__.py", ""),
    ):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    return folder / name


def colcon(workspace: Path, *arguments: str) -> None:
    """Run the real colcon, as a terminal of the lab would."""
    command = ["colcon", *arguments]
    finished = subprocess.run(
        command, cwd=workspace, env=environment.lab_environment(), capture_output=True, text=True, check=False
    )
    assert finished.returncode == 0, finished.stdout + finished.stderr


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the workshop once; each test works on a copy."""
    workspace = tmp_path_factory.mktemp("built") / "workshop_ws"
    blow = make_package(workspace / "src" / "horn") / "blow.py"
    blow.write_text(BLOW.format(sound=check.OLD_SOUND))
    charge = make_package(workspace / "src" / "battery") / "charge.py"
    charge.write_text(CHARGE.format(body=FAULTY))
    tests = workspace / "src" / "battery" / "test" / "test_charge.py"
    tests.parent.mkdir()
    tests.write_text(TESTS.format(mark="", empty=0))
    colcon(workspace, "build")
    blow.write_text(BLOW.format(sound="Honk."))
    return workspace


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give the test a student's folder."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path / "my work"))
    monkeypatch.setattr(checks, "_failures", Counter())  # each test gets the first hint
    (tmp_path / "my work").mkdir()
    return tmp_path / "my work"


@pytest.fixture
def harbour(home: Path) -> Path:
    for name, needs in HARBOUR.items():
        make_package(home / "harbour_ws" / "src" / name, needs)
    return home / "harbour_ws"


@pytest.fixture
def workshop(home: Path, built: Path) -> Path:
    return shutil.copytree(built, home / "workshop_ws", symlinks=True)


@pytest.mark.parametrize(
    "right",
    [
        lambda: ["load_model", "crane_driver", "harbour_map", "ship_pilot", "crane_app"],
        lambda: ("harbour_map", "ship_pilot", "load_model", "crane_driver", "crane_app"),
        lambda: iter(["harbour_map", "load_model", "crane_driver", "crane_app", "ship_pilot"]),
        lambda: dict.fromkeys(["load_model", "harbour_map", "ship_pilot", "crane_driver", "crane_app"]),
    ],
)
@pytest.mark.usefixtures("harbour")
def test_a_right_order(right: Callable[[], Any]) -> None:
    """Every order in which nothing comes before what it needs counts."""
    assert check.build_order(right).startswith("Right")


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda: None, "a list of 5 names"),
        (lambda: "load_model", "a list of 5 names"),
        (lambda: sorted(HARBOUR), "begin with a package that needs no other"),
        (lambda: ["load_model", "crane_driver", "crane_app", "harbour_map", "ship_pilot"], "comes later"),
        (lambda: ["load_model", "crane_driver", "harbour_map", "crane_app"], "each of"),
        (lambda: [*HARBOUR, "rover_app"], "each of"),
        (lambda: ["load_model", "load_model", "harbour_map", "ship_pilot", "crane_app"], "each of"),
        (lambda: HARBOUR["rover"], "it raised KeyError"),
        (["load_model"], "without its parentheses"),
    ],
)
@pytest.mark.usefixtures("harbour")
def test_a_wrong_order(wrong: Any, message: str) -> None:
    """What comes too early, is missing or is no list is told."""
    with pytest.raises(CheckError, match=message):
        check.build_order(wrong)


@pytest.mark.usefixtures("home")
def test_without_the_harbour() -> None:
    """A workspace that is not there is made by a cell."""
    with pytest.raises(CheckError, match="run the cells at the beginning"):
        check.build_order(list)


RIGHT_OPTIONS = (
    "--packages-up-to crane_app",
    "--packages-select crane_driver",
    "--packages-above load_model",
)


@pytest.mark.parametrize(
    "right",
    [
        RIGHT_OPTIONS,
        (
            "colcon build --packages-skip ship_pilot",
            "--symlink-install --packages-select crane_driver",
            "--packages-select load_model crane_driver crane_app",
        ),
        (
            "--packages-select crane_app crane_driver load_model harbour_map",
            "--packages-select-regex '^crane_d'",
            "--packages-skip harbour_map ship_pilot",
        ),
    ],
)
@pytest.mark.usefixtures("harbour")
def test_right_selections(right: tuple[str, ...]) -> None:
    """Any options that select the right packages count."""
    assert check.selections(*right).startswith("Right")


@pytest.mark.parametrize(
    ("number", "wrong", "message"),
    [
        (0, "--packages-select crane_app", "case 1 .* Found: crane_app. "),
        (0, "", "case 1 builds 4"),
        (0, "--packages-up-to crane_ap", "crane_ap. specified with --packages-up-to was not found"),
        (1, "--packages-select crane_drive", "no package"),
        (1, "--packages-up-to crane_driver", "case 2 builds 1 package,"),
        (1, "crane_driver", "options that colcon understands"),
        (2, "--packages-up-to load_model", "Look the other way"),
        (2, "--packages-above 'load_model", "is each quote closed"),
    ],
)
@pytest.mark.usefixtures("harbour")
def test_wrong_selections(number: int, wrong: str, message: str) -> None:
    """Too many, too few, and what colcon does not understand are told apart."""
    options = list(RIGHT_OPTIONS)
    options[number] = wrong
    with pytest.raises(CheckError, match=message):
        check.selections(*options)


@pytest.mark.usefixtures("harbour")
def test_too_few_selections() -> None:
    """An empty answer is asked for three."""
    with pytest.raises(CheckError, match="3 texts"):
        check.selections()


@pytest.mark.parametrize(
    "arguments",
    [
        ("--packages-select", "horn"),
        ("--symlink-install",),
        ("--packages-up-to", "horn", "--cmake-clean-cache"),
    ],
)
def test_an_edit_that_takes_effect(workshop: Path, arguments: tuple[str, ...]) -> None:
    """Any build does it."""
    colcon(workshop, "build", *arguments)
    assert check.edit_takes_effect().startswith("Right")


def test_another_edit_takes_effect_too(workshop: Path) -> None:
    """A merged, clean build with a sound of one's own."""
    for name in ("build", "install"):
        shutil.rmtree(workshop / name)
    (workshop / "src" / "horn" / "horn" / "blow.py").write_text(BLOW.format(sound="Tröt!"))
    colcon(workshop, "build", "--merge-install")
    assert check.edit_takes_effect().startswith("Right")


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda _: None, "the copy in install/"),
        (lambda workshop: shutil.rmtree(workshop / "install"), "install/setup.bash"),
        (lambda workshop: shutil.rmtree(workshop / "install" / "horn"), "as the source does"),
        (
            lambda workshop: (workshop / "src/horn/horn/blow.py").write_text(
                BLOW.format(sound=check.OLD_SOUND)
            ),
            "the edit must stay",
        ),
        (lambda workshop: (workshop / "src/horn/horn/blow.py").write_text("def main("), "SyntaxError"),
        (lambda workshop: shutil.rmtree(workshop / "src"), "run the cell that makes it"),
    ],
)
def test_an_edit_without_effect(workshop: Path, spoil: Callable[[Path], Any], message: str) -> None:
    """Not built, not installed, not edited, not Python, not there."""
    spoil(workshop)
    with pytest.raises(CheckError, match=message):
        check.edit_takes_effect()


def test_an_edit_without_end(workshop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A loop is told as any other fault."""
    monkeypatch.setattr(programs, "RUN_TIMEOUT", 2.0)
    (workshop / "src/horn/horn/blow.py").write_text("def main():\n    while True:\n        pass\n")
    with pytest.raises(CheckError, match=r"the source of horn ends\. Found: after 2 s it still runs"):
        check.edit_takes_effect()


def run_tests(workshop: Path, body: str, tests: str = TESTS.format(mark="", empty=0)) -> None:
    """Write the battery and its tests, and run them as colcon does."""
    package = workshop / "src" / "battery"
    (package / "battery" / "charge.py").write_text(CHARGE.format(body=body))
    (package / "test" / "test_charge.py").write_text(tests)
    results = workshop / "build" / "battery" / "pytest.xml"
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", f"--junit-xml={results}"]
    subprocess.run(command, cwd=package, capture_output=True, check=False)


def test_a_test_mended_with_colcon(workshop: Path) -> None:
    """As the lesson does it."""
    (workshop / "src/battery/battery/charge.py").write_text(CHARGE.format(body=MENDED))
    colcon(workshop, "test", "--packages-select", "battery")
    assert check.mended_test().startswith("Right")


@pytest.mark.parametrize(
    "body",
    [
        "return min(100.0, max(0.0, (volts - 10) * 50))",
        "if volts <= 10:\n        return 0\n    return (volts - 10) * 50",
        "empty, full = 10, 12\n    part = (volts - empty) / (full - empty)\n    return 0 if part < 0 else part * 100",
        "import numpy\n    return numpy.clip((volts - 10) * 50, 0, 100)",
    ],
)
def test_a_mended_function(workshop: Path, body: str) -> None:
    """Any way of computing it counts."""
    run_tests(workshop, body)
    assert check.mended_test().startswith("Right")


@pytest.mark.parametrize(
    ("body", "tests", "message"),
    [
        (FAULTY, TESTS.format(mark="", empty=0), r"percent\(9.5\) is 0. Found: -25.0"),
        (FAULTY, TESTS.format(mark="", empty=-25), r"percent\(9.5\) is 0"),
        ("pass", TESTS.format(mark="", empty=0), "needs a return"),
        (
            "return 0 if volts == 9.5 else (volts - 10) * 50",
            TESTS.format(mark="", empty=0),
            r"percent\(2.0\)",
        ),
        ("return abs(volts - 10) * 50", TESTS.format(mark="", empty=0), r"percent\(9.5\)"),
        ("return volt", TESTS.format(mark="", empty=0), "NameError"),
        (MENDED, "def test_full(): assert True\n", "1 that has"),
        (MENDED, TESTS.format(mark="import pytest\n@pytest.mark.skip", empty=0), "2 that have"),
        (MENDED, TESTS.format(mark="", empty=-25), "2 that have"),
    ],
)
def test_a_function_not_mended(workshop: Path, body: str, tests: str, message: str) -> None:
    """A test that was bent, skipped or taken away does not help."""
    run_tests(workshop, body, tests)
    with pytest.raises(CheckError, match=message):
        check.mended_test()


def test_tests_that_were_not_run_again(workshop: Path) -> None:
    """The function is mended, and its tests have not seen it."""
    run_tests(workshop, MENDED)
    results = workshop / "build" / "battery" / "pytest.xml"
    os.utime(results, (0, 0))
    with pytest.raises(CheckError, match="run colcon test again"):
        check.mended_test()
    results.unlink()
    with pytest.raises(CheckError, match="0 that have"):
        check.mended_test()


@pytest.mark.usefixtures("harbour")
def test_the_harbour_as_a_picture() -> None:
    """Who needs whom, in words and as arrows."""
    picture = package_graph("~/harbour_ws")
    assert repr(picture).splitlines() == [
        "crane_app needs crane_driver, harbour_map",
        "crane_driver needs load_model",
        "harbour_map needs no other",
        "load_model needs no other",
        "ship_pilot needs harbour_map",
    ]
    assert picture.mermaid.count("-- needs -->") == 4
    with pytest.raises(NotADirectoryError, match="no folder ~/rover_ws/src"):
        package_graph("~/rover_ws")
