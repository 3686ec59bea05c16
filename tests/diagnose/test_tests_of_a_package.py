"""Tests of a package that pytest never runs, and code beside them that it need not run."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

CHECK = "def wait_for(value):\n    assert value\n    return value\n"
USES = "from {} import wait_for\n\n\ndef test_it():\n    assert wait_for(1) == 1\n"
ONE = "def test_it():\n    assert 1\n"
RIGHT = {
    "helper that is named like a test": {"test_helpers.py": CHECK, "test_a.py": USES.format("test_helpers")},
    "helper in another file": {"helpers.py": CHECK, "test_a.py": USES.format("helpers")},
    "helper of conftest": {
        "checks.py": CHECK,
        "conftest.py": "import pytest\nimport checks\n\n\n@pytest.fixture\ndef waited():\n    return checks.wait_for\n",
        "test_a.py": "def test_it(waited):\n    assert waited(1)\n",
    },
    "hook": {"conftest.py": "def pytest_configure(config):\n    assert config\n", "test_a.py": ONE},
    "base class": {
        "base.py": "import unittest\n\n\nclass Base(unittest.TestCase):\n    def test_it(self):\n        assert self.name()\n",
        "test_a.py": "from base import Base\n\n\nclass TestA(Base):\n    def name(self):\n        return 'a'\n",
    },
    "script": {"try_robot.py": "def check_sum():\n    assert 1\n\n\nif __name__ == '__main__':\n    check_sum()\n"},
    "tests of another file": {"cases.py": ONE, "test_a.py": "from cases import *\n"},
    "called in its own file": {"test_a.py": "def check():\n    assert 1\n\n\ncheck()\n"},
    "names that setup.cfg chooses": {"check_a.py": "def check_sum():\n    assert 1\n", "../pytest.ini": "[pytest]\npython_files = check_*.py\npython_functions = check_*\n"},
    "named by CMake": {"sums.py": ONE, "../CMakeLists.txt": "ament_add_pytest_test(sums test/sums.py)\n"},
    "named by CMake in its folder": {"sums.py": ONE, "CMakeLists.txt": "ament_add_pytest_test(sums.py sums.py)\n"},
    "named in a list of CMake": {"sums.py": ONE, "tests.cmake": "set(tests sums)\n"},
    "fixture with another name": {"test_a.py": "import pytest\n\n\n@pytest.fixture(name='robot')\ndef _robot():\n    return 1\n\n\ndef test_it(robot):\n    assert robot\n"},
    "fixture that is assigned": {"test_a.py": "import pytest\n\n\ndef make():\n    return 1\n\n\nrobot = pytest.fixture(make)\n\n\ndef test_it(robot):\n    assert robot\n"},
    "fixture that is imported": {"given.py": "import pytest\n\n\n@pytest.fixture\ndef robot():\n    return 1\n", "test_a.py": "from given import robot\n\n\ndef test_it(robot):\n    assert robot\n"},
    "fixture for all packages": {"../../../conftest.py": "import pytest\n\n\n@pytest.fixture\ndef robot():\n    return 1\n", "test_a.py": "def test_it(robot):\n    assert robot\n"},
    "default": {"test_a.py": "def test_it(number=1):\n    assert number\n"},
    "names of the module's mark": {"test_a.py": "import pytest\n\npytestmark = pytest.mark.parametrize('a', [1])\n\n\ndef test_it(a):\n    assert a\n"},
    "names in a variable": {"test_a.py": "import pytest\n\nNAMES = 'a,b'\n\n\n@pytest.mark.parametrize(NAMES, [(1, 2)])\ndef test_it(a, b):\n    assert a < b\n"},
    "of launch": {"test_a.py": "import launch_pytest\nimport pytest\n\n\n@launch_pytest.fixture\ndef described():\n    return None\n\n\n@pytest.mark.launch(fixture=described)\ndef test_it(launch_context):\n    assert launch_context\n"},
}  # fmt: skip
WRONG = {
    "check": ({"test_a.py": "def check_sum():\n    assert 1\n"}, "never-called", "test_a.py:1"),
    "check with a fixture": ({"test_a.py": "import pytest\n\n\n@pytest.fixture\ndef a():\n    return 1\n\n\ndef is_sum(a):\n    assert a\n"}, "never-called", "test_a.py:9"),
    "file": ({"sums_tests.py": ONE}, "never-called", "sums_tests.py"),
    "file beside one that CMake names": ({"sums_tests.py": ONE, "cases.py": ONE, "CMakeLists.txt": "ament_add_pytest_test(x cases.py)\n"}, "never-called", "sums_tests.py"),
    "file in a folder that CMake names": ({"sums_tests.py": ONE, "../CMakeLists.txt": "ament_add_pytest_test(all test)\n"}, "never-called", "sums_tests.py"),
    "file beside another": ({"sums_tests.py": ONE, "test_a.py": ONE}, "never-called", "sums_tests.py"),
    "no fixture": ({"test_a.py": "def test_it(robot):\n    assert robot\n"}, "test-fixture", "test_a.py:1"),
    "maker": ({"test_a.py": "def make_robot():\n    return 1\n\n\ndef test_it(robot):\n    assert robot\n"}, "test-fixture", "test_a.py:5"),
}  # fmt: skip


def found(texts: dict[str, str], root: Path) -> list[tuple[str, str]]:
    Files.right(NAMES[1]).write(root)
    (setup,) = root.glob("src/*/setup.py")
    setup.write_text(
        setup.read_text().replace("    packages=", "    tests_require=['pytest'],\n    packages=")
    )
    (setup.parent / "test").mkdir(exist_ok=True)
    for name, text in texts.items():
        (setup.parent / "test" / name).write_text(text)
    codes = ("never-called", "test-fixture", "tests-not-run")
    return [(f.code, f.place.rpartition("/")[2]) for f in of_workspace(root) if f.code in codes]


@pytest.mark.parametrize("way", RIGHT)
def test_what_pytest_need_not_run_is_no_fault(tmp_path: Path, way: str) -> None:
    assert found(RIGHT[way], tmp_path) == []


@pytest.mark.parametrize(("pattern", "is_told"), [("test/*.py", False), ("test/test_*.py", True)])
def test_a_pattern_of_cmake_finds_tests_by_any_name(tmp_path: Path, pattern: str, is_told: bool) -> None:
    files = (
        Files.right(NAMES[1]).change("package.xml", "ament_python", "ament_cmake").put("test/sums.py", ONE)
    )
    files.put("CMakeLists.txt", f"file(GLOB tests RELATIVE ${{DIR}} {pattern})\n")
    assert [f.code for f in of_workspace(files.write(tmp_path)) if f.code == "never-called"] == [
        "never-called"
    ] * is_told


@pytest.mark.parametrize("way", WRONG)
def test_what_pytest_never_runs_is_told(tmp_path: Path, way: str) -> None:
    texts, *wanted = WRONG[way]
    assert found(texts, tmp_path) == [tuple(wanted)]


KEYWORDS = {
    "none": ("", ["pytest"]),
    "empty": ("extras_require={},", ["pytest"]),
    "empty list": ("extras_require={\n        'test': [],\n    },", ["pytest"]),
    "another one": ("extras_require={'dev': ['black']},", ["pytest"]),
    "others": ("extras_require={'test': ['flake8']},", ["flake8", "pytest"]),
    "as a text": ("extras_require={'test': 'flake8'},", ["flake8", "pytest"]),
    "a variable": ("extras_require=extras,", ["pytest"]),
    "a call": ("extras_require=dict(dev=['black']),", ["pytest"]),
    "on a line with others": ("zip_safe=True, extras_require={'dev': ['a']},", ["pytest"]),
}


@pytest.mark.parametrize("way", KEYWORDS)
def test_pytest_is_named_once_for_the_tests(tmp_path: Path, way: str) -> None:
    """The fix, applied, is a call of setup() that names it."""
    row, wanted = KEYWORDS[way]
    Files.right(NAMES[1]).write(tmp_path)
    (setup,) = tmp_path.glob("src/*/setup.py")
    text = re.sub(r" +(?:tests_require|extras_require|zip_safe)=.*\n", "", setup.read_text())
    text = text.replace("    packages=", f"    {row}\n    packages=").replace(
        "setup(\n", "extras = {}\nsetup(\n"
    )
    setup.write_text(text)
    (setup.parent / "test").mkdir(exist_ok=True)
    (setup.parent / "test/test_a.py").write_text(ONE)
    (finding,) = [f for f in of_workspace(tmp_path) if f.code == "tests-not-run"]
    new, _, old = re.split(r"write `([^`]+)`( on its own line above | instead of )", finding.fix)[1:]
    if old.startswith("`"):
        text = text.replace(old.split("`")[1], new)
    elif lines := re.findall(r"\d+", old):
        rows = text.split("\n")
        rows[int(lines[0]) - 1 : int(lines[-1])] = [f"    {new},"]
        text = "\n".join(rows)
    else:
        text = text.replace(f"    {old.split('=')[0]}=", f"    {new}\n    {old.split('=')[0]}=")
    calls = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
    (call,) = [node for node in calls if getattr(node.func, "id", "") == "setup"]
    (extras,) = [keyword.value for keyword in call.keywords if keyword.arg == "extras_require"]
    assert eval(ast.unparse(extras), {"extras": {}})["test"] == wanted


@pytest.mark.parametrize(
    ("section", "wanted"),
    [
        ("", "write `extras_require="),
        ("[options.extras_require]\ndev = black\n", "write test = pytest below [options.extras_require] in"),
        ("[options.extras_require]\ntest = flake8\n", "with flake8, pytest below it"),
    ],
)
def test_a_section_of_setup_cfg_is_written_once(tmp_path: Path, section: str, wanted: str) -> None:
    Files.right(NAMES[1]).write(tmp_path)
    (setup,) = tmp_path.glob("src/*/setup.py")
    setup.write_text(re.sub(r" +(?:tests_require|extras_require)=.*\n", "", setup.read_text()))
    with (setup.parent / "setup.cfg").open("a") as file:
        file.write(section)
    (setup.parent / "test").mkdir(exist_ok=True)
    (setup.parent / "test/test_a.py").write_text(ONE)
    (finding,) = [f for f in of_workspace(tmp_path) if f.code == "tests-not-run"]
    assert wanted in finding.fix
