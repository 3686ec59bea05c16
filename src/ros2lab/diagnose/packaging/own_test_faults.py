"""Faults that keep the tests of a package from being run."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import lru_cache
from shlex import quote

from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, read_text

_FIXTURE = re.compile(
    r"^ {,4}@(?:pytest\.)?fixture\b.*\n(?: *@.*\n)* *def (\w+)",
    re.MULTILINE,  # as pytest's own sources write one
)


def own_test_faults(package: SourcePackage) -> Iterator[Finding]:
    """Yield files that pytest does not collect, tests that colcon runs without it, and missing fixtures."""
    paths = [path for name in ("test", "tests") for path in sorted((package.folder / name).glob("*.py"))]
    sources = [package.read(path, path.stem) for path in paths]
    looked_into = [
        source for source in sources if source.name.startswith("test_") or source.name.endswith("_test")
    ]
    for source in sources:
        if source in looked_into:
            yield from _called_otherwise(source)
        elif source.name != "conftest":
            yield from _not_looked_into(source)
    tests = [
        (source, function)
        for source in looked_into
        for function in source.tree.body
        if isinstance(function, ast.FunctionDef) and function.name.startswith("test")
    ]
    if tests:
        yield from _not_given_to_pytest(package, *tests[0])
    texts = " ".join(source.text for source in sources)
    if not [*package.folder.glob("conftest.py")] and not re.search(r"pytest_plugins|import \*", texts):
        own = {function.name for source in sources for function in _fixtures(source)}
        for source, function in tests:
            yield from _without_fixture(source, function, own)


def _not_looked_into(source: PythonSource) -> Iterator[Finding]:
    tests = _checks(source)
    if tests:
        new = f"test_{source.name.removesuffix('_tests').removesuffix('_checks')}.py"
        cause = (
            f"pytest looks only at files named test_*.py, so {tests[0]}() in {source.name}.py is never run."
        )
        others = [name for name in tests if not name.startswith("test")]
        more = f", and begin the names of its functions with test_ ({', '.join(others)})" if others else ""
        fix = f"mv {quote(source.shown)} {quote(source.shown.rpartition('/')[0] + '/' + new)}{more}"
        yield Finding("never-called", cause, source.shown, fix)


def _checks(source: PythonSource) -> list[str]:
    """Return the names of the functions that are named as tests or assert something."""
    functions = [n for n in source.nodes if isinstance(n, ast.FunctionDef)]
    return [
        function.name
        for function in functions
        if function.name.startswith("test") or any(isinstance(n, ast.Assert) for n in own_nodes(function))
    ]


def _called_otherwise(source: PythonSource) -> Iterator[Finding]:
    """Yield a function that asserts something but that pytest ignores, in a file without any test."""
    names = _checks(source)
    if names and not any(name.startswith("test") for name in names):
        cause = f"pytest runs only functions named test_..., so {names[0]}() is never run."
        yield Finding(
            "never-called",
            cause,
            source.shown,
            f"write test_{names[0].removeprefix('check_')} instead of {names[0]}",
        )


def _not_given_to_pytest(package: SourcePackage, source: PythonSource, test: Function) -> Iterator[Finding]:
    """Yield that setup.py does not name pytest: colcon then runs unittest, which finds no test functions."""
    setup = package.setup
    if setup is None or "pytest" in setup.source.text + read_text(package.folder / "setup.cfg"):
        return
    cause = f"setup.py does not name pytest, so `colcon test` uses unittest, which does not find {test.name}() in {source.shown}."
    above = next(
        (name for name in ("install_requires", "packages", *setup.lines) if name in setup.lines), None
    )
    if above is None:  # setup.cfg holds everything
        fix = "write [options.extras_require] at the end of setup.cfg, with test = pytest below it, then build again"
        yield Finding("tests-not-run", cause, package.shown("setup.cfg"), fix)
        return
    fix = f"write `extras_require={{'test': ['pytest']}},` on its own line above {above}=..., and build again"
    yield Finding("tests-not-run", cause, at(setup.source.shown, setup.line(above)), fix)


def _without_fixture(source: PythonSource, test: ast.FunctionDef, own: set[str]) -> Iterator[Finding]:
    """Yield the parameters of a test for which there is no fixture."""
    marks = [ast.unparse(decorator) for decorator in test.decorator_list]
    if not all(mark.startswith("pytest.mark.") for mark in marks):
        return
    named = set(re.findall(r"\w+", " ".join(mark for mark in marks if "parametrize" in mark)))
    functions = [function for function in source.tree.body if isinstance(function, ast.FunctionDef)]
    for name in (argument.arg for argument in test.args.args):
        if name in own | named | _built_in():
            continue
        same = next((function for function in functions if function.name == name), None)
        makes = next(
            (
                function
                for function in functions
                if function.name.endswith(f"_{name}") and not function.args.args
            ),
            None,
        )
        if same:
            fix = f"write @pytest.fixture above `def {name}` on line {same.lineno}, and import pytest at the top"
        elif makes:
            fix = f"write `def {test.name}():`, and {name} = {makes.name}() as its first line"
        else:
            fix = f"write above it @pytest.fixture and, below that, a function {name}() that returns what the test needs; import pytest at the top"
        cause = f"pytest must fill the argument {name} of {test.name}() from a fixture of that name, and there is none."
        yield Finding("test-fixture", cause, source.at(test), fix)


def _fixtures(source: PythonSource) -> Iterator[Function]:
    for node in source.nodes:
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and any(
            "fixture" in ast.unparse(decorator) for decorator in node.decorator_list
        ):
            yield node


@lru_cache(maxsize=1)
def _built_in() -> frozenset[str]:
    """Return the names of pytest's own fixtures, read from its sources."""
    folder = interfaces.folder_of("_pytest")
    texts = (read_text(path) for path in (folder.glob("*.py") if folder else ()))
    return frozenset({"request", *(name for text in texts for name in _FIXTURE.findall(text))})
