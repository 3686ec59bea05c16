"""What stands in a submission is read within limits, and what was read before one of them is kept."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from test_files import REFERENCE, Texts, right_package, write

from ros2lab import assignments
from ros2lab.diagnose.launching import launch_loaded
from ros2lab.grading.evidence_json import plain
from ros2lab.grading.reading import boxed, reader
from ros2lab.grading.reading.boxed import Reading
from ros2lab.grading.reading.unread import FACT, OF_CODE
from ros2lab.grading.receiving.clean_copy import SubmissionError
from ros2lab.grading.receiving.submission import Submission, copied
from ros2lab.grading.sandbox.worlds import World
from ros2lab.grading.watching.observe import SHOWN


@pytest.fixture
def read(tmp_path: Path) -> Callable[[Texts | Path], Reading]:
    """Have files read in a box; the grader itself must not work meanwhile."""

    def read(given: Texts | Path) -> Reading:
        root = tmp_path / "received"
        root.mkdir()
        received = copied(given if isinstance(given, Path) else write(tmp_path / "handed_in", given), root)
        with World(root, shown=SHOWN) as world:
            before = os.times()
            found = boxed.read(world, received, assignments.load())
            after = os.times()
        assert after.user + after.system - before.user - before.system < 2
        return found

    return read


def test_what_is_read_in_a_box_is_what_is_read_here(read: Callable[[Texts | Path], Reading]) -> None:
    found = read(REFERENCE)
    assert (found.submission.form, found.files.notes) == ("package", [])
    assert found.plan is not None
    assert found.plan.names == ["robot_controller"]
    assert len(found.files.ends) > 2
    assert all(found.files.manifest.values())


# A graph of names that each stand for two others, and lists in lists: small to write, endless to follow.
LAUGHTER = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{name}: &{name} [{', '.join([f'*{before}'] * 9)}]\n"
    for before, name in zip("abcdefgh", "bcdefghi", strict=True)
)
HEAVY = {
    "modules": {f"robot_controller/m{n}.py": "import rclpy\n" + "x = [1]\n" * 110_000 for n in range(6)},
    "aliases": {"config/robot.yaml": f"/**:\n  ros__parameters:\n    a: 1\n{LAUGHTER}"},
    "brackets": {"robot_controller/deep.py": "import rclpy\nx = " + "[" * 90_000 + "]" * 90_000},
    "powers": {"setup.py": "from setuptools import setup\nname = 'a' * 10 ** 10 ** 2\nsetup(name=name)\n"},
    "a README": {"README.md": "ros2 run " * 200_000 + "\n" + "`" * 400_000},
}  # fmt: skip


@pytest.mark.parametrize(
    "heavy", [pytest.param(name, marks=pytest.mark.thorough if name == "modules" else ()) for name in HEAVY]
)
def test_whatever_is_heavy_to_read_ends(read: Callable[[Texts | Path], Reading], heavy: str) -> None:
    """And costs no more than what it is: the package is there all the same."""
    found = read({**right_package(), **HEAVY[heavy]})
    assert found.submission.package is not None
    assert found.plan is not None


DEEP = f"COUNT = {' + '.join(['len(name)'] * 900)}\n"
SUMS = f"COUNT = {' + '.join(['1'] * 900)}\nIS_SO = {'not ' * 900}COUNT\n"


@pytest.mark.parametrize("file", ["robot_controller/status_publisher.py", "test/test_status.py"])
def test_numbers_that_are_nested_too_deeply_for_us_open_nothing(
    read: Callable[[Texts | Path], Reading], file: str
) -> None:
    """Nobody loses or gains anything by the other lines, nor by the other files."""
    found = read({**right_package(), file: f"{SUMS}\n\ndef test_count():\n    assert COUNT\n"}).files
    assert not found.unread
    assert not any("Not read" in note for note in found.notes)
    assert sum(found.tests.values()) == file.startswith("test/")


@pytest.mark.parametrize(
    "file",
    [
        "robot_controller/status_publisher.py",
        pytest.param("test/test_status.py", marks=pytest.mark.thorough),
    ],
)
def test_what_is_nested_too_deeply_for_us_is_not_read_and_that_is_said(
    read: Callable[[Texts | Path], Reading], file: str
) -> None:
    """Python runs it; what lies so deep is neither there nor missing, and what each of the other lines says is there."""
    found = read({**right_package(), file: f"{DEEP}\ndef test_count():\n    assert COUNT == 900\n"}).files
    assert {"tests", "handlers", "ends"} <= found.unread.keys()
    assert not {"manifest", "setup", "readme", "sources", "readme_names"} & found.unread.keys()
    (note,) = [note for note in found.notes if "Not read" in note]
    assert file in note
    assert "nested too deeply" in note


def test_what_was_read_before_a_limit_counts_and_the_rest_is_neither_there_nor_missing(
    read: Callable[[Texts | Path], Reading], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = boxed._ask

    def cut(*given: Any) -> tuple[dict[str, Any], str]:
        answers, _ = asked(*given)
        late = {"files", *(f"{FACT}{name}" for name in OF_CODE)}
        return {
            name: value for name, value in answers.items() if name not in late
        }, "It ran longer than 180 s."

    monkeypatch.setattr(boxed, "_ask", cut)
    found = read(REFERENCE).files
    assert "Not all of its files could be read: It ran longer than 180 s." in found.notes
    assert found.manifest["is_there"]
    assert found.setup["is_there"]
    assert found.readme
    assert found.launch_files
    assert found.unread.keys() == {*OF_CODE}


NAME = "long" * 80
LONG_NAMES = {
    "module": {"robot_controller/more.py": f"import rclpy\nimport {NAME}\n"},
    "share": {
        "launch/a.launch.py": "from ament_index_python.packages import get_package_share_directory\n"
        f"get_package_share_directory('{NAME}')\n"
    },
}


@pytest.mark.parametrize("where", LONG_NAMES)
def test_a_name_that_no_file_can_have_is_no_fault_of_the_grader(
    read: Callable[[Texts | Path], Reading], where: str
) -> None:
    found = read({**right_package(), **LONG_NAMES[where]})
    assert found.submission.package is not None
    assert "name is too long" in found.files.notes[-1]


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ({"cpu_s": 0.01}, "more than 0.01 s of CPU time"),
        ({"memory_bytes": 15_000_000}, "memory|MemoryError|It is too large"),
        ({"wall_s": 0.01}, "longer than 0.01 s"),
    ],
    ids=["time", "memory", "wall"],
)
def test_a_limit_is_told_in_a_sentence(
    read: Callable[[Texts | Path], Reading],
    monkeypatch: pytest.MonkeyPatch,
    limits: dict[str, float],
    words: str,
) -> None:
    monkeypatch.setattr(boxed, "LIMITS", replace(boxed.LIMITS, **limits))
    try:
        said = read(REFERENCE).files.notes[-1]
    except SubmissionError as error:
        said = str(error)
    assert re.match(f"(It cannot|Not all of its files could) be read: .*({words})", said), said


def test_no_launch_file_is_loaded_to_explain_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is a program, and would see the grader there."""
    loaded: list[object] = []
    monkeypatch.setattr(launch_loaded, "_run", lambda paths, _packages: loaded.extend(paths) or {})
    said = "[ERROR] [launch]: Caught exception in launch (see debug for traceback): 'x'"
    asked = {
        "submission": plain(Submission("nothing", None, [], None, [], []), ""),
        "texts": [said],
        "findings": [],
    }
    [(_, findings)] = reader.said(REFERENCE, asked)
    assert findings
    assert loaded == []


_SETUP_OF_LIBRARY = "from setuptools import setup\nsetup(name='robot_library', packages=['robot_tools'])\n"
_XML_OF_LIBRARY = """<package format="3"><name>robot_library</name><version>0.1.0</version><description>Tools</description>
<maintainer email="a@b.org">A</maintainer><license>MIT</license>
<export><build_type>ament_python</build_type></export></package>
"""


@pytest.mark.parametrize(
    ("old", "new", "is_needed"),
    [
        ("", "", False),
        ("import rclpy\n", "import rclpy\nimport robot_tools.numbers\n", True),
        ("import rclpy\n", "import rclpy\nfrom robot_tools import numbers\n", True),
        ("import rclpy\n", "import rclpy\nimport robot_tool\n", False),
        ("'console_scripts': [", "'console_scripts': ['count = robot_tools.numbers:main', ", True),
        ("<depend>rclpy</depend>", "<depend>rclpy</depend><depend>robot_library</depend>", True),
    ],
)
def test_a_library_beside_the_package_is_built_with_it_if_it_is_needed(
    read: Callable[[Texts | Path], Reading], old: str, new: str, is_needed: bool
) -> None:
    """By its modules, which need not have its name, by entry points that lead to them, or as a dependency."""
    texts = {
        f"src/robot_controller/{path}": text.replace(old, new, 1) if old and isinstance(text, str) else text
        for path, text in right_package().items()
    }
    library = {
        "package.xml": _XML_OF_LIBRARY,
        "setup.py": _SETUP_OF_LIBRARY,
        "resource/robot_library": "",
        "robot_tools/__init__.py": "",
        "robot_tools/numbers.py": "def main():\n    return 1\n",
        "test/__init__.py": "",
    }
    found = read(texts | {f"src/library/{path}": text for path, text in library.items()})
    assert found.plan is not None
    assert ("robot_library" in found.plan.names) is is_needed
