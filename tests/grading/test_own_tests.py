"""A submission's own tests are run, and run again with the package broken: those that test nothing do not notice."""

from __future__ import annotations

import marshal
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from ros2lab.diagnose.sources.python_source import read_source
from ros2lab.grading.building import own_tests, spoiler
from ros2lab.grading.building.own_tests import OwnTests
from ros2lab.grading.code.running import idle, running
from ros2lab.grading.evidence import Build
from ros2lab.grading.reading.build_plan import WORKSPACE
from ros2lab.grading.reading.graded_package import written_modules
from ros2lab.grading.sandbox.worlds import World, underlay
from ros2lab.grading.watching.observe import SHOWN

MODULE = '''"""Speeds."""

LIMIT = 1.5
NAMES = {"start": 1, "stop": 0}


class Robot:
    """A robot."""

    def __init__(self):
        self.speed = 0.0
        self.limit = LIMIT

    def obey(self, word):
        """Obey."""
        self.speed = LIMIT if NAMES[word.strip().lower()] else 0.0
        return self.speed


def clamp(speed):
    return max(-LIMIT, min(LIMIT, speed))


def same(value):
    """Hand it on."""
    return value


def main():
    print(Robot().obey(same("start")))
'''

OTHER = """from speeds import speeds

class Twice:
    def __init__(self):
        self.limit = speeds.LIMIT * 2
"""

# What stands in test/test_speeds.py, and whether it notices that the package is broken.
NOTICING = {
    "what an object is given of a constant": "def test_it():\n    assert Robot().limit == 1.5\n",
    "a constant as another module uses it": "from speeds.other import Twice\ndef test_it():\n    assert Twice().limit == 3\n",
    "a function": "def test_it():\n    assert clamp(9) == LIMIT\n",
    "a method": "def test_it():\n    assert Robot().obey(' START ') > 0\n",
    "a table": "def test_it():\n    assert [NAMES[n] for n in ('start', 'stop')] == [1, 0]\n",
    "a class of unittest": (
        "import unittest\nclass Test(unittest.TestCase):\n    def test_it(self):\n        self.assertEqual(clamp(0), 0)\n"
    ),
    "one that waits for ever": (
        "import time\ndef test_it():\n    while not Robot().obey('start'):\n        time.sleep(0.1)\n"
    ),
}
BLIND = {
    "a constant": "def test_it():\n    assert LIMIT == 1.5\n",
    "what gives back what it gets": "from speeds.speeds import same\ndef test_it():\n    assert same(3) == 3\n",
    "nothing": "def test_it():\n    assert True\n",
    "a name": "def test_it():\n    assert Robot is not None\n",
    "that it can be made": "def test_it():\n    Robot()\n",
    "a copy of the function": "def test_it():\n    assert max(-1, min(1, 9)) == 1\n",
    "what is caught": "def test_it():\n    try:\n        assert clamp(9) == LIMIT\n    except BaseException:\n        pass\n",
}
BEGIN = "from speeds.speeds import LIMIT, NAMES, Robot, clamp\n\n\n"


def some_of(tests: dict[str, str], *names: str) -> list[Any]:
    """Return the names of tests, those that are not named as thorough: they come the same way."""
    return [pytest.param(name, marks=() if name in names else pytest.mark.thorough) for name in tests]


def write(folder: Path, test: str) -> None:
    for name in ("speeds", "test"):
        (folder / name).mkdir(parents=True)
    (folder / "speeds/__init__.py").touch()
    (folder / "speeds/speeds.py").write_text(MODULE)
    (folder / "speeds/other.py").write_text(OTHER)
    (folder / "test/test_speeds.py").write_text(BEGIN + test)
    (folder / "setup.py").write_text("NAME = 'speeds'\n")


@pytest.fixture(scope="module")
def built() -> Iterator[Build]:
    with pytest.MonkeyPatch.context():
        yield Build(True, "", [], [], [], [], underlay(), 1.0)


def outcome(folder: Path, built: Build, left: dict[str, str] | None = None) -> dict[str, object]:
    """Run the tests of the package `pk` below a folder in the sandbox, after a build that has left these files."""
    with World(folder, shown=SHOWN) as world:
        for name, text in (left or {}).items():
            (world.folder / name).parent.mkdir(parents=True, exist_ok=True)
            (world.folder / name).write_text(text)
        return OwnTests(folder, "pk", ["pk/test/test_speeds.py"]).run(world, built)


@pytest.mark.parametrize(
    "name",
    some_of(
        NOTICING,
        "what an object is given of a constant",
        "a function",
        "a class of unittest",
        "one that waits for ever",
    ),
)
def test_tests_that_test_something(
    tmp_path: Path, built: Build, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(own_tests, "PATIENCE", 2.0)
    write(tmp_path / "pk", NOTICING[name])
    found = outcome(tmp_path, built)
    assert (found["passed"], found["failed"], found["is_noticed"]) == (1, 0, True), found


def test_what_fails_at_once_is_not_kept_waiting_by_what_waits_in_vain(
    tmp_path: Path, built: Build, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a broken copy the quickest file comes first, whatever the order was on the whole one."""
    monkeypatch.setattr(own_tests, "PATIENCE", 60.0)
    write(tmp_path / "pk", NOTICING["a function"])
    waiting = BEGIN + "import time\n" + NOTICING["one that waits for ever"].partition("\n")[2]
    (tmp_path / "pk/test/test_a_wait.py").write_text(f"{waiting}    time.sleep(0.2)\n")
    with World(tmp_path, shown=SHOWN) as world:
        files = [f"pk/test/{name}.py" for name in ("test_a_wait", "test_speeds")]
        begin = time.monotonic()
        found = OwnTests(tmp_path, "pk", files).run(world, built)
    assert (found["passed"], found["failed"], found["is_noticed"]) == (2, 0, True), found
    assert time.monotonic() - begin < own_tests.PATIENCE


@pytest.mark.parametrize(
    "name", some_of(BLIND, "nothing", "what is caught", "a constant", "what gives back what it gets")
)
def test_tests_that_test_nothing(tmp_path: Path, built: Build, name: str) -> None:
    write(tmp_path / "pk", BLIND[name])
    found = outcome(tmp_path, built)
    assert (found["passed"], found["failed"], found["is_noticed"]) == (1, 0, False), found


# Ways in which a test can tell one text or code of the module `speeds` from another, and run none of it.
READING = {
    "bytes": "hashlib.sha256(path.read_bytes()).hexdigest()",
    "size": "path.stat().st_size",
    "syntax tree": "ast.dump(ast.parse(path.read_text()))",
    "tokens": "[token.string for token in tokenize.tokenize(io.BytesIO(path.read_bytes()).readline)]",
    "inspect": "inspect.getsource(module)",
    "one function": "inspect.getsource(module.clamp)",
    "docstrings": "[module.Robot.obey.__doc__, module.clamp.__doc__]",
    "compiled": "Path(py_compile.compile(str(path), '/tmp/own.pyc', 'x')).stat().st_size",
    "names in the code": "module.clamp.__code__.co_names",
    "constants in the code": "0.0 in module.Robot.obey.__code__.co_consts",
    "signature": "str(inspect.signature(module.clamp))",
    "git": "hashlib.sha1(b'blob %d' % path.stat().st_size + path.read_bytes()).hexdigest()",
}
MODULES = "import ast, hashlib, io, inspect, py_compile, tokenize\nfrom pathlib import Path\n"


def test_tests_that_read_how_a_module_is_written_notice_nothing(tmp_path: Path, built: Build) -> None:
    """They pass on every copy, whatever they read it with: each copy is written alike, and only what it does differs."""
    given = f"{MODULES}import importlib.util\nspec = importlib.util.spec_from_file_location('speeds', path)\n"
    given += "module = importlib.util.module_from_spec(spec)\nspec.loader.exec_module(module)\n"
    write(tmp_path / "as_written", "")
    names: dict[str, object] = {"path": tmp_path / "as_written/speeds/speeds.py"}
    exec(given, names)
    values = {name: eval(way, names) for name, way in READING.items()}
    tests = [
        f"def test_{number}():\n    assert ({way}) == {values[name]!r}, {name!r}\n"
        for number, (name, way) in enumerate(READING.items())
    ]
    begin = f"{MODULES}from speeds import speeds as module\npath = Path(module.__file__)\n"
    write(tmp_path / "pk", begin + "\n".join(tests))
    found = outcome(tmp_path, built)
    assert (found["passed"], found["failed"], found.get("is_noticed")) == (len(READING), 0, False), found


def test_tests_that_compare_how_code_looks_fail(tmp_path: Path, built: Build) -> None:
    """They would fail on every broken copy, and tell nothing of what it does."""
    write(tmp_path / "pk", "")
    code = compile(MODULE, "speeds.py", "exec")
    clamp = next(const for const in code.co_consts if getattr(const, "co_name", "") == "clamp")
    test = tmp_path / "pk/test/test_speeds.py"
    test.write_text(f"{BEGIN}def test_it():\n    assert clamp.__code__.co_code == {clamp.co_code!r}\n")
    found = outcome(tmp_path, built)
    assert (found["passed"], found["failed"]) == (0, 1), found


def test_tests_that_fail(tmp_path: Path, built: Build) -> None:
    write(tmp_path / "pk", "def test_it():\n    assert clamp(9) == 9\n")
    found = outcome(tmp_path, built)
    assert (found["passed"], found["failed"]) == (0, 1)
    assert found["error"].startswith("FAILED test/test_speeds.py::test_it"), found
    assert "is_noticed" not in found


def test_tests_that_are_skipped(tmp_path: Path, built: Build) -> None:
    write(tmp_path / "pk", "import pytest\ndef test_it():\n    pytest.skip('later')\n")
    assert outcome(tmp_path, built) == {"passed": 0, "failed": 0, "skipped": 1, "error": ""}


def test_tests_that_cannot_be_collected(tmp_path: Path, built: Build) -> None:
    write(tmp_path / "pk", "import nothing_of_this_name\n")
    found = outcome(tmp_path, built)
    assert not found["passed"]
    assert found["failed"] or found["error"]


TELLING = """
import pytest
@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    report = yield
    report.outcome = "passed" if "def obey" in open("speeds/speeds.py").read() else "failed"
    return report
"""


@pytest.mark.parametrize("name", ["pytest.py", "sitecustomize.py", "_pytest/__init__.py"])
def test_what_stands_in_for_pytest_is_not_run(tmp_path: Path, built: Build, name: str) -> None:
    write(tmp_path / "pk", NOTICING["a function"].replace("9", "1"))
    (tmp_path / "pk" / name).parent.mkdir(exist_ok=True)
    (tmp_path / "pk" / name).write_text("print('1 passed in 0.01s')\nimport os\nos._exit(0)\n")
    found = outcome(tmp_path, built)
    assert (found["passed"], found["failed"]) == (0, 1), found


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("pytest.ini", "[pytest]\naddopts = -p telling\n"),
        pytest.param("tox.ini", "[pytest]\naddopts = -p telling\n", marks=pytest.mark.thorough),
        ("pyproject.toml", '[tool.pytest.ini_options]\naddopts = "-p telling"\n'),
        pytest.param("setup.cfg", "[tool:pytest]\naddopts = -p telling\n", marks=pytest.mark.thorough),
    ],
)
def test_a_plugin_that_settings_name_tells_nothing(
    tmp_path: Path, built: Build, name: str, text: str
) -> None:
    write(tmp_path / "pk", BLIND["nothing"])
    (tmp_path / "pk" / name).write_text(text)
    (tmp_path / "pk" / "telling.py").write_text(TELLING)
    found = outcome(tmp_path, built)
    assert (found["passed"], found["failed"], found["is_noticed"]) == (1, 0, False), found


@pytest.mark.parametrize(
    "test",
    [
        "def test_it():\n    import os\n    assert 'broken' not in os.getcwd() + __file__ + Robot.__module__\n",
        "def test_it():\n    from pathlib import Path\n    assert not [*Path('/submission').glob('*/broken*')]\n",
    ],
)
def test_where_a_copy_lies_tells_nothing(tmp_path: Path, built: Build, test: str) -> None:
    write(tmp_path / "pk", test)
    assert outcome(tmp_path, built)["is_noticed"] is False


def test_what_is_printed_is_not_counted(tmp_path: Path, built: Build) -> None:
    end = "import atexit, os\natexit.register(lambda: os.write(1, b'9 passed in 0.01s\\n'))\n"
    write(tmp_path / "pk", f"{end}def test_it():\n    assert clamp(9) == 9\n")
    found = outcome(tmp_path, built)
    assert (found["passed"], found["failed"]) == (0, 1), found


def test_what_a_build_has_written_over_is_tested_as_it_was_received(tmp_path: Path, built: Build) -> None:
    write(tmp_path / "pk", NOTICING["a function"])
    assert outcome(tmp_path, built, {"pk/speeds/speeds.py": "raise SystemExit\n"})["is_noticed"] is True


def test_what_a_build_has_made_is_there(tmp_path: Path, built: Build) -> None:
    write(
        tmp_path / "pk",
        "def test_it():\n    assert open('/submission/graded_ws/install/made').read() == 'x'\n",
    )
    assert outcome(tmp_path, built, {f"{WORKSPACE}/install/made": "x"})["passed"] == 1


IDLE = """

TWO = 2


def two():
    return TWO


class Sum:
    def of(self):
        return 1 + 1
"""


@pytest.mark.parametrize("test", ["two() == 2", "TWO == 2", "Sum().of() == 2"])
def test_what_no_program_uses_is_not_what_tests_are_about(tmp_path: Path, built: Build, test: str) -> None:
    write(tmp_path / "pk", f"from speeds.speeds import Sum, TWO, two\n\ndef test_it():\n    assert {test}\n")
    module = tmp_path / "pk/speeds/speeds.py"
    module.write_text(MODULE + IDLE)
    sources = [read_source(module, "speeds.speeds", "pk/speeds/speeds.py")]
    unused = idle(sources, [*running(sources, ["main"])])
    with World(tmp_path, shown=SHOWN) as world:
        found = OwnTests(tmp_path, "pk", ["pk/test/test_speeds.py"], unused).run(world, built)
    assert (found["passed"], found["failed"], found["is_noticed"]) == (1, 0, False), found


def test_what_did_not_run_on_the_broken_copy_is_not_run_again(
    tmp_path: Path, built: Build, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The quickest file notices: the others, which may take minutes, have told all that they can."""
    write(tmp_path / "pk", NOTICING["a function"])
    (tmp_path / "pk/test/test_long.py").write_text("import time\n\ndef test_it():\n    time.sleep(1)\n")
    given, real = list[list[str]](), own_tests.OwnTests._try

    def noted(tests: OwnTests, *words: Any) -> Any:
        given.append([*words[2]])
        return real(tests, *words)

    monkeypatch.setattr(own_tests.OwnTests, "_try", noted)
    files = ["pk/test/test_long.py", "pk/test/test_speeds.py"]
    with World(tmp_path, shown=SHOWN) as world:
        found = OwnTests(tmp_path, "pk", files).run(world, built)
    assert (found["passed"], found["is_noticed"]) == (2, True), found
    both = ["test/test_speeds.py", "test/test_long.py"]
    assert given == [both[::-1], both, both[:1]]


def test_what_time_decides_is_not_noticed(
    tmp_path: Path, built: Build, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A test that passes while its file is young fails on a broken copy, and then on the whole package as well."""
    write(tmp_path / "pk", "import time\n\ndef test_it():\n    assert time.time() < UNTIL\n")
    test = tmp_path / "pk/test/test_speeds.py"
    test.write_text(test.read_text().replace("UNTIL", str(time.time() + 1000)))
    kinds, real = list[str](), own_tests.OwnTests._try

    def later(tests: OwnTests, *given: Any) -> Any:
        kinds.append(given[-1])
        if len(kinds) == 2:  # the time has come
            test.write_text(test.read_text().replace("time.time()", "1e12"))
        return real(tests, *given)

    monkeypatch.setattr(own_tests.OwnTests, "_try", later)
    found = outcome(tmp_path, built)
    assert (found["passed"], found["failed"], found["is_noticed"]) == (1, 0, False), found
    assert kinds == [spoiler.HARMLESS, "empty", spoiler.HARMLESS]


@pytest.mark.parametrize("folder", ["pk", "."])
def test_what_is_broken_and_what_is_not(tmp_path: Path, folder: str) -> None:
    """Tests, setup.py and launch files stay, and every source; a module's docstring, too."""
    package = tmp_path / folder
    write(package, NOTICING["a function"])
    (package / "launch").mkdir()
    (package / "launch/all.launch.py").write_text("X = 1\n")
    (package / "speeds/broken.py").write_text("def (:\n")
    before = {path: path.read_bytes() for path in package.rglob("*.py")}
    done = set()
    for kind in spoiler.KINDS:
        spoiler.spoil(dict.fromkeys(map(str, written_modules(package)), ()), kind)
        assert {path: path.read_bytes() for path in package.rglob("*.py")} == before
        compiled = [path for path in package.rglob("*.pyc") if path.name.startswith("speeds.")]
        assert {path.parent.parent for path in package.rglob("*.pyc")} == {package / "speeds"}
        names: dict[str, Any] = {"__name__": "speeds"}
        exec(marshal.loads(compiled[0].read_bytes()[16:]), names)
        assert names["__doc__"] == "Speeds."
        done.add((names["LIMIT"], names["clamp"](9.0)))
    assert done == {(1.5, 1.5), (1.5, None), (1.5, 2.5)}


def test_a_file_that_no_parser_can_read_is_left(tmp_path: Path) -> None:
    write(tmp_path, "")
    (tmp_path / "speeds/deep.py").write_text("(" * 10_000 + ")" * 10_000)
    (tmp_path / "speeds/nul.py").write_bytes(b"x = 1\0")
    for kind in spoiler.SPOILERS:
        spoiler.spoil(dict.fromkeys(map(str, written_modules(tmp_path)), ()), kind)
