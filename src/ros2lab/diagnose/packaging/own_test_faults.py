"""Faults that keep the tests of a package from being run."""

from __future__ import annotations

import ast
import collections
import re
from collections.abc import Collection, Iterator
from fnmatch import fnmatchcase
from functools import lru_cache
from importlib.metadata import entry_points
from shlex import quote

from ros2lab.diagnose.code.main_guards import is_guard
from ros2lab.diagnose.finding import Finding, at, in_a_row, lines_in_words
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, read_text
from ros2lab.diagnose.sources.setup_script import SetupScript

_FIXTURE = re.compile(
    r"^ {,4}@(?:pytest\.)?fixture\b.*\n(?: *@.*\n)* *(?:async )?def (\w+)",
    re.MULTILINE,  # as pytest's own sources write one
)


def own_test_faults(package: SourcePackage) -> Iterator[Finding]:
    """Yield files that pytest does not collect, tests that colcon runs without it, and missing fixtures."""
    paths = [path for name in ("test", "tests") for path in sorted((package.folder / name).glob("*.py"))]
    sources = [package.read(path, path.stem) for path in paths]
    others = _others(package, sources) if sources else ""
    # A loop of CMake may give each file that a pattern finds to pytest by its name.
    chosen = _BY_CMAKE.findall(others) if package.is_built_by_cmake else ()
    for source in sources if not _CHOSEN.search(others) else ():
        texts = [others, *(other.text for other in sources if other is not source)]
        is_named = any(re.search(rf"\b{re.escape(source.name)}\b", text) for text in texts)
        if not is_named and not any(fnmatchcase(f"{source.name}.py", pattern) for pattern in chosen):
            yield from _not_run(source)
    tests = [
        (source, function)
        for source in filter(_is_looked_into, sources)
        for function in source.tree.body
        if isinstance(function, ast.FunctionDef) and function.name.startswith("test")
    ]
    if tests:
        yield from _not_given_to_pytest(package, *tests[0])
    texts = [others, *(source.text for source in sources)]
    if not _has_conftest(package) and not any(_GIVES_ANY.search(text) for text in texts):
        own = {name for source in sources for name in _fixtures(source)}
        for source, function in tests:
            yield from _without_fixture(source, function, own)


def _is_looked_into(source: PythonSource) -> bool:
    """Return whether pytest looks for tests in a file of this name."""
    return source.name.startswith("test_") or source.name.endswith("_test")


# Settings by which pytest looks for other names, and what gives tests arguments that are not seen here.
_CHOSEN = re.compile(r"\bpython_(?:files|functions|classes)\b|collect_file")
_BY_CMAKE = re.compile(r"(?i:\bfile\s*\(\s*GLOB)[^()]*?([\w*?.\[\]-]*\*[\w*?.\[\]-]*\.py)\b")
_COLLECTED = ("test", "generate_test")
_GIVES_ANY = re.compile(r"\bpytest(?:[-_][a-z]|11|mark)|launch_pytest|import \*")


def _others(package: SourcePackage, sources: Collection[PythonSource]) -> str:
    """Return the texts of the other files that may name a file of tests: code, launch files, settings and builds."""
    paths = {source.path for source in (*package.sources.values(), *sources) if source.path}
    known = {source.path for source in sources}
    endings = (".py", ".cfg", ".ini", ".toml", ".txt", ".xml", ".cmake")
    paths |= {path for path in package.folder.glob("*") if path.suffix in endings and path.is_file()}
    paths |= {path for path in package.launch_files if path.suffix in endings}
    inner = (path for name in ("test", "tests") for path in (package.folder / name).rglob("*"))
    inner = (path for path in inner if path.suffix in (".py", ".txt", ".cmake") and path.is_file())
    return "\n".join(map(read_text, sorted({*paths, *inner} - known)))


def _has_conftest(package: SourcePackage) -> bool:
    """Return whether a conftest.py above the tests may give them fixtures, also one for all packages."""
    root = package.root or package.folder
    inside = [folder for folder in package.folder.parents if folder.is_relative_to(root)]
    return any((folder / "conftest.py").is_file() for folder in (package.folder, *inside))


def _not_run(source: PythonSource) -> Iterator[Finding]:
    """Yield the tests of a file that no other names, if pytest passes over the file, or over all its functions.

    A file that is run, and one with classes or names from elsewhere, may hold what pytest finds.
    """
    if any(isinstance(node, ast.If) and is_guard(node) for node in source.nodes) or "import *" in source.text:
        return
    tests = [*_meant_as_tests(source)]
    if not tests or (_is_looked_into(source) and any(map(_is_collected, source.nodes))):
        return
    name, place = tests[0].name, source.at(tests[0])
    if _is_looked_into(source):
        cause = f"pytest runs only functions named test_..., so {name}() is never run."
        fix = f"write test_{name.removeprefix('check_')} instead of {name}"
        yield Finding("never-called", cause, place, fix)
    elif source.name != "conftest":
        new = f"test_{source.name.removesuffix('_tests').removesuffix('_checks')}.py"
        who = f"{name}()" if len(tests) == 1 else f"none of {in_a_row([f'{test.name}()' for test in tests])}"
        cause = f"pytest looks only at files named test_*.py or *_test.py, so {who} in {source.name}.py is {'never' if len(tests) == 1 else 'ever'} run."
        others = [test.name for test in tests if not test.name.startswith("test")]
        more = f", and begin the names of its functions with test_ ({', '.join(others)})" if others else ""
        fix = f"mv {quote(source.shown)} {quote(source.shown.rpartition('/')[0] + '/' + new)}{more}"
        yield Finding("never-called", cause, source.shown, fix)


def _meant_as_tests(source: PythonSource) -> Iterator[ast.FunctionDef]:
    """Yield the functions that nothing names, that need no more than fixtures, and that are called tests or assert something."""
    named = collections.Counter(re.findall(r"\w+", source.text))
    given = {*_fixtures(source)}
    for function in source.tree.body:
        if not isinstance(function, ast.FunctionDef) or named[function.name] > 1 or function.decorator_list:
            continue
        asserts = any(isinstance(node, ast.Assert) for node in own_nodes(function))
        takes = {argument.arg for argument in function.args.args}
        if takes <= given and (function.name.startswith("test") or asserts):
            yield function


def _is_collected(node: ast.AST) -> bool:
    """Return whether a node is a definition in which pytest may look for tests."""
    is_test = isinstance(node, Function) and node.name.startswith(_COLLECTED)
    return is_test or isinstance(node, ast.ClassDef)


def _not_given_to_pytest(package: SourcePackage, source: PythonSource, test: Function) -> Iterator[Finding]:
    """Yield that setup.py does not name pytest: colcon then runs unittest, which finds no test functions."""
    setup = None if (package.build_type or "").endswith("cmake") else package.setup
    if setup is None or "pytest" in setup.source.text + read_text(package.folder / "setup.cfg"):
        return
    cause = f"setup.py does not name pytest, so `colcon test` uses unittest, which does not find {test.name}() in {source.shown}."
    place, fix = _with_pytest(package, setup)
    yield Finding(
        "tests-not-run", cause, place, f"{fix}, {'then' if 'setup.cfg' in fix else 'and'} build again"
    )


def _with_pytest(package: SourcePackage, setup: SetupScript) -> tuple[str, str]:
    """Return where a package names what its tests need, and how to name pytest there; a keyword is given only once."""
    above = next(
        (name for name in ("install_requires", "packages", *setup.lines) if name in setup.lines), None
    )
    options = package.setup_cfg.sections() if package.setup_cfg else []
    if "options.extras_require" in options or above is None:
        return package.shown("setup.cfg"), _in_cfg(package)
    given = setup.given("extras_require")
    if given is None:
        row = "extras_require={'test': ['pytest']},"
        return at(setup.source.shown, setup.line(above)), f"write `{row}` on its own line above {above}=..."
    written = ast.get_source_segment(setup.source.text, given) or ""
    old = f"`extras_require={written}`"
    if given.end_lineno != given.lineno:
        old = lines_in_words(setup.line("extras_require") or given.lineno, given.end_lineno or given.lineno)
    place = at(setup.source.shown, setup.line("extras_require"))
    return place, f"write `extras_require={ast.unparse(_and_pytest(given))}` instead of {old}"


def _and_pytest(given: ast.expr) -> ast.expr:
    """Return an expression of extras with pytest among what is for tests."""
    pytest = ast.Constant("pytest")
    if not isinstance(given, ast.Dict):
        return ast.Dict([None, ast.Constant("test")], [given, ast.List([pytest])])
    extras = {
        ast.unparse(key) if key else f"**{n}": (key, value)
        for n, (key, value) in enumerate(zip(given.keys, given.values, strict=True))
    }
    old = extras.get("'test'", (None, ast.List([])))[1]
    items = (
        old.elts
        if isinstance(old, (ast.List, ast.Tuple))
        else [old if isinstance(old, ast.Constant) else ast.Starred(old)]
    )
    extras["'test'"] = (ast.Constant("test"), ast.List([*items, pytest]))
    return ast.Dict([key for key, _ in extras.values()], [value for _, value in extras.values()])


def _in_cfg(package: SourcePackage) -> str:
    """Say how to name pytest in setup.cfg, in a section of which there may be only one."""
    section = "options.extras_require"
    options = package.setup_cfg
    if options is None or not options.has_section(section):
        return f"write [{section}] at the end of setup.cfg, with test = pytest below it"
    if not options.has_option(section, "test"):
        return f"write test = pytest below [{section}] in setup.cfg"
    named = ["", *options.get(section, "test").split(), "pytest"]
    return f"write test = below [{section}] in setup.cfg, with {', '.join(named[1:])} below it, each on an indented line of its own"


def _without_fixture(source: PythonSource, test: ast.FunctionDef, own: set[str]) -> Iterator[Finding]:
    """Yield the parameters of a test for which there is no fixture."""
    marks = [ast.unparse(decorator) for decorator in test.decorator_list]
    if not all(mark.startswith("pytest.mark.") for mark in marks):
        return
    known = own | source.names.keys() | _built_in()
    known |= {*re.findall(r"\w+", " ".join(mark for mark in marks if "parametrize" in mark))}
    if any(re.search(r"parametrize\((?!['\"(\[]|argnames=['\"(\[])", mark) for mark in marks):
        return  # the names are in a variable
    functions = [function for function in source.tree.body if isinstance(function, ast.FunctionDef)]
    required = test.args.args[: len(test.args.args) - len(test.args.defaults)]
    for name in (argument.arg for argument in required if argument.arg not in known):
        same = next((function for function in functions if function.name == name), None)
        makers = (function for function in functions if function.name.endswith(f"_{name}"))
        makes = next((function for function in makers if not function.args.args), None)
        if same:
            fix = f"write @pytest.fixture above `def {name}` on line {same.lineno}, and import pytest at the top"
        elif makes:
            fix = f"write `def {test.name}():`, and {name} = {makes.name}() as its first line"
        else:
            fix = f"write above it @pytest.fixture and, below that, a function {name}() that returns what the test needs; import pytest at the top"
        cause = f"pytest must fill the argument {name} of {test.name}() from a fixture of that name, and there is none."
        yield Finding("test-fixture", cause, source.at(test), fix)


def _fixtures(source: PythonSource) -> Iterator[str]:
    """Yield the names of the fixtures that a file defines."""
    for node in source.nodes:
        match node:
            case (
                ast.FunctionDef(name=name, decorator_list=marks)
                | ast.AsyncFunctionDef(name=name, decorator_list=marks)
            ):
                made = [mark for mark in marks if "fixture" in ast.unparse(mark)]
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call() as call):
                made = [call] if "fixture" in ast.unparse(call) else []
            case _:
                continue
        for mark in made:
            keywords = mark.keywords if isinstance(mark, ast.Call) else []
            named = [k.value.value for k in keywords if k.arg == "name" and isinstance(k.value, ast.Constant)]
            yield str(named[0]) if named else name


@lru_cache(maxsize=1)
def _built_in() -> frozenset[str]:
    """Return the names of the fixtures of pytest and its installed plugins, read from their sources."""
    plugins = {point.module.partition(".")[0] for point in entry_points(group="pytest11")}
    folders = [folder for name in ("_pytest", *sorted(plugins)) if (folder := interfaces.folder_of(name))]
    texts = (read_text(path) for folder in folders for path in folder.glob("*.py"))
    return frozenset({"request", *(name for text in texts for name in _FIXTURE.findall(text))})
