"""Read setup.py without running it."""

from __future__ import annotations

import ast
import glob
import os
import re
from collections.abc import Iterator
from configparser import RawConfigParser
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cached_property, partial
from pathlib import Path, PurePosixPath
from typing import Any

from ros2lab.diagnose.sources.python_source import PythonSource, read_source, read_text
from ros2lab.diagnose.sources.setup_cfg import read_cfg
from ros2lab.diagnose.sources.static_value import UNKNOWN, dotted, evaluate, is_known

_LARGEST_PACKAGE = 2000  # Python packages to find
_GLOBS = ("glob.glob", "glob.iglob")
_KEYWORDS = ("name", "packages", "entry_points", "data_files")  # that another file may set


@dataclass(frozen=True)
class EntryPoint:
    """A console script, `name = module:function`; `module` is empty if its text has another form, and `pk` for `pk.__init__`."""

    text: str
    line: int | None
    name: str = ""
    module: str = ""
    function: str = ""


@dataclass(frozen=True)
class Pattern:
    """A call of glob.

    Attributes:
        files: what it finds; empty if that is not known.
        is_dead: whether it is known to find nothing.
    """

    call: ast.Call
    text: str
    files: tuple[str, ...]
    is_dead: bool


@dataclass
class SetupScript:
    """A setup.py.

    Attributes:
        keywords: the keyword arguments of `setup()`; a value may be or contain `UNKNOWN`.
        targets: the expression of each folder in data_files.
        patterns: the calls of glob whose patterns are known.
        call: the call of `setup()`; None if there is none.
        beside: what the file has outside of its arguments under the name of one that it is not given.
    """

    source: PythonSource
    keywords: dict[str, Any] = field(default_factory=dict)
    lines: dict[str, int] = field(default_factory=dict)
    call: ast.Call | None = None
    beside: dict[str, tuple[ast.expr, Any]] = field(default_factory=dict)
    targets: dict[str, ast.expr] = field(default_factory=dict)
    patterns: list[Pattern] = field(default_factory=list)

    @property
    def groups(self) -> dict[str, Any] | None:
        """The entry points by group, as they are written; None if not known."""
        value = self.keywords.get("entry_points", {})
        if isinstance(value, str):
            return _groups_in(value)
        if not isinstance(value, dict) or UNKNOWN in value:
            return None
        return value

    @cached_property
    def entry_points(self) -> list[EntryPoint] | None:
        """The console scripts; None if not known."""
        groups = self.groups
        if groups is None:
            return None
        value = groups.get("console_scripts", [])
        texts = value.splitlines() if isinstance(value, str) else value
        if not isinstance(texts, (list, tuple, set)) or UNKNOWN in texts:
            return None
        texts = [text.strip() for text in texts if isinstance(text, str) and text.strip()]
        names = [_executable(text) for text in texts]
        return [
            self._entry_point(text, names[:index].count(names[index])) for index, text in enumerate(texts)
        ]

    @property
    def data_files(self) -> list[tuple[str, list[str]]]:
        """The folders into which files are installed, each with its files, as far as they are known."""
        value = self.keywords.get("data_files", [])
        return [
            (target.rstrip("/"), [file for file in files if isinstance(file, str)])
            for target, files in filter(_is_pair, value if isinstance(value, (list, tuple)) else ())
        ]

    def copies(self, folder: Path) -> dict[str, list[str]]:
        """Return each path that data_files installs, with the files of a package's folder that are installed as that path."""
        made: dict[str, list[str]] = {}
        for target, files in self.data_files:
            for file in (file for file in dict.fromkeys(files) if (folder / file).is_file()):
                made.setdefault(str(PurePosixPath(target, PurePosixPath(file).name)), []).append(file)
        return made

    @property
    def are_data_files_known(self) -> bool:
        """Whether all of `data_files` is known."""
        value = self.keywords.get("data_files", [])
        return isinstance(value, (list, tuple)) and all(_is_pair(pair) and is_known(pair) for pair in value)

    def written(self, target: str) -> tuple[str, int | None]:
        """Return the code of a folder in data_files, and its line."""
        node = self.targets.get(target)
        text = ast.get_source_segment(self.source.text, node) if node is not None else None
        return (text, node.lineno) if node is not None and text else (repr(target), self.line("data_files"))

    def given(self, keyword: str) -> ast.expr | None:
        """Return the expression of a keyword argument; None if it is not given."""
        nodes = (node for node in self.source.nodes if isinstance(node, ast.keyword))
        return next((node.value for node in nodes if node.arg == keyword), None)

    def line(self, keyword: str) -> int | None:
        """Return the line of a keyword argument; None if it is not given."""
        return self.lines.get(keyword)

    def _entry_point(self, text: str, earlier: int) -> EntryPoint:
        line = self._line_of(_executable(text), earlier)
        match = _ENTRY_POINT.fullmatch(text)
        return (
            EntryPoint(text, line, *(part or "" for part in match.groups()))
            if match
            else EntryPoint(text, line)
        )

    def _line_of(self, name: str, earlier: int) -> int | None:
        """Return the line of an entry point, before which there are `earlier` ones of the same name."""
        start = self.line("entry_points") or 1
        # Search from `entry_points` on: the same name may be above as that of the package.
        found = [
            number
            for number, line in enumerate(self.source.text.splitlines()[start - 1 :], start)
            if name and re.search(rf"(?<![\w.]){re.escape(name)}(?![\w.])", line.partition("#")[0])
        ]
        return found[min(earlier, len(found) - 1)] if found else self.line("entry_points")


def _executable(text: str) -> str:
    """Return the name of the executable at the beginning of an entry point."""
    return re.split(r"[=:]", text)[0].strip()


def _is_pair(value: Any) -> bool:
    """Return whether a value is a pair of a folder and its files."""
    match value:
        case [str(), [*_]]:
            return True
    return False


_ENTRY_POINT = re.compile(
    r"([\w.-]+)\s*=\s*([A-Za-z_][\w.]*?)(?:\.__init__)?\s*(?::\s*([A-Za-z_][\w.]*))?\s*(?:\[[\w, ]*\])?"
)


def read_setup(folder: Path, shown: str) -> SetupScript | None:
    """Read the setup.py of a package; return None if there is none."""
    path = folder / "setup.py"
    if not path.is_file():
        return None
    source = read_source(path, "setup", shown)
    script = SetupScript(source)
    names: dict[str, Any] = {"os.sep": "/", "__file__": str(path), "__name__": "__main__"}
    calls = _calls(folder)
    known = {local: calls[target] for local, target in _spellings(source) if target in calls}
    for statement in _statements(source.tree.body):
        call = _setup_call(source, statement)
        if call is not None:
            _take_keywords(script, call, names, known)
            break
        _follow(statement, names, known)
    if script.call is None:
        # The call may be in a function or below a condition.
        for node in source.nodes:
            if isinstance(node, ast.Call) and _is_setup(source, node.func):
                _take_keywords(script, node, names, known)
                break
    _take_configuration(script, folder)
    for keyword, value in _named_values(source):
        if script.call and keyword in _KEYWORDS[1:] and keyword not in script.keywords:
            script.beside[keyword] = value, evaluate(value, names, known)
    return script


def _named_values(source: PythonSource) -> Iterator[tuple[str, ast.expr]]:
    """Yield the values of variables, dictionaries and arguments with their names; a comma at the end does not count."""
    for node in source.nodes:
        match node:
            case (
                ast.Assign(targets=[ast.Name(id=name)], value=ast.Tuple(elts=[value]) | value)
                | ast.keyword(arg=str(name), value=value)
            ):
                yield name, value
            case ast.Dict(keys=keys, values=values):
                pairs = zip(keys, values, strict=True)
                yield from ((str(key.value), value) for key, value in pairs if isinstance(key, ast.Constant))


def _take_configuration(script: SetupScript, folder: Path) -> None:
    """Add what setuptools reads from setup.cfg and pyproject.toml for keywords that setup.py does not set."""
    parser, fault = read_cfg(read_text(folder / "setup.cfg"))
    given: dict[str, Any] = {}
    if parser.has_section("options.entry_points"):
        given["entry_points"] = {key: value.strip() for key, value in parser["options.entry_points"].items()}
    if parser.has_section("options.data_files"):
        pairs = parser["options.data_files"].items()
        given["data_files"] = [(target, value.split()) for target, value in pairs]
    options = parser["options"] if parser.has_section("options") else {}
    if "packages" in options:
        value = options["packages"].strip()
        given["packages"] = (
            _found_by_cfg(folder, parser, value.strip()) if value.startswith("find") else value.split()
        )
    if "package_dir" in options:
        rows = (row.split("=", 1) for row in re.split(r"[\n,]", options["package_dir"]) if "=" in row)
        given["package_dir"] = {name.strip(): where.strip() for name, where in rows}
    given |= dict.fromkeys({"py_modules", "scripts"} & {*options}, UNKNOWN)
    if parser.has_option("metadata", "name"):
        given["name"] = parser.get("metadata", "name")
    is_elsewhere = re.compile(r"^\[(?:project|tool\.setuptools)", re.MULTILINE).search
    if fault or script.call is None or is_elsewhere(read_text(folder / "pyproject.toml")):
        given = dict.fromkeys((*_KEYWORDS, "package_dir"), UNKNOWN) | given
    for keyword, value in given.items():
        script.keywords.setdefault(keyword, value)


def _found_by_cfg(folder: Path, parser: RawConfigParser, way: str) -> Any:
    """Return the packages that setuptools finds by a setup.cfg with `find:` or `find_namespace:`."""
    found = parser["options.packages.find"] if parser.has_section("options.packages.find") else {}
    kinds = [key for key in ("include", "exclude") if key in found]
    asked: dict[str, Any] = {key: re.split(r"[,\s]+", found[key].strip()) for key in kinds}
    return _found(folder, found.get("where", "."), **asked, is_namespace=way == "find_namespace:")


def _found(folder: Path, where: str = ".", exclude: Any = (), include: Any = ("*",), **form: bool) -> Any:
    """Return the packages below a folder, as `find_packages` takes its arguments; nothing outside is searched."""
    inner = (folder / where).resolve()
    if not inner.is_relative_to(folder.resolve()):
        return UNKNOWN
    return packages_in(inner, tuple(exclude), tuple(include), **form)


def _statements(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    for statement in body:
        if isinstance(statement, (ast.With, ast.Try)):
            yield statement
            yield from _statements(statement.body)
        elif isinstance(statement, ast.If) and "__main__" in ast.dump(statement.test):
            yield from _statements(statement.body)
        else:
            yield statement


def _spellings(source: PythonSource) -> Iterator[tuple[str, str]]:
    """Yield every dotted name in the file, with its full name."""
    for node in source.nodes:
        name = dotted(node) if isinstance(node, (ast.Name, ast.Attribute)) else None
        if name:
            yield name, source.resolve(node) or name


def _is_setup(source: PythonSource, node: ast.expr) -> bool:
    return source.resolve(node) in ("setuptools.setup", "distutils.core.setup") or dotted(node) == "setup"


def _setup_call(source: PythonSource, statement: ast.stmt) -> ast.Call | None:
    value = statement.value if isinstance(statement, (ast.Expr, ast.Assign)) else None
    return value if isinstance(value, ast.Call) and _is_setup(source, value.func) else None


def _take_keywords(script: SetupScript, call: ast.Call, names: dict[str, Any], calls: dict[str, Any]) -> None:
    script.call = call
    for node in script.source.nodes:
        if isinstance(node, (ast.Tuple, ast.List)) and len(node.elts) == 2:
            target = evaluate(node.elts[0], names, calls)
            if isinstance(target, str):
                script.targets.setdefault(target.rstrip("/"), node.elts[0])
        if isinstance(node, ast.Call) and script.source.resolve(node.func) in _GLOBS and node.args:
            text, files = evaluate(node.args[0], names, calls), evaluate(node, names, calls)
            if isinstance(text, str):
                found = tuple(files) if isinstance(files, list) and is_known(files) else ()
                script.patterns.append(Pattern(node, text, found, is_dead=files == []))
    for keyword in call.keywords:
        value = evaluate(keyword.value, names, calls)
        if keyword.arg is not None:
            script.keywords[keyword.arg] = value
            script.lines[keyword.arg] = keyword.value.lineno
        elif isinstance(value, dict):
            script.keywords.update(value)
        else:
            # The contents of the unpacked dict are not known.
            for name in ("name", "packages", "data_files", "entry_points", "package_dir", "py_modules"):
                script.keywords.setdefault(name, UNKNOWN)


def _follow(statement: ast.stmt, names: dict[str, Any], calls: dict[str, Any]) -> None:
    """Update the known names as a statement does, or forget the names that it may change."""
    if isinstance(statement, (ast.Assign, ast.AnnAssign)):
        value = evaluate(statement.value, names, calls)
        targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
        for target in targets:
            if isinstance(target, ast.Name):
                names[target.id] = value
            else:
                _forget(target, names)
        return
    if isinstance(statement, ast.AugAssign) and (name := dotted(statement.target)) in names:
        names[name] = evaluate(ast.BinOp(statement.target, statement.op, statement.value), names, calls)
        return
    call = statement.value if isinstance(statement, ast.Expr) else None
    if isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute) and len(call.args) == 1:
        owner = names.get(dotted(call.func.value) or "")
        value = evaluate(call.args[0], names, calls)
        if isinstance(owner, list) and call.func.attr == "append":
            owner.append(value)
            return
        if isinstance(owner, list) and call.func.attr == "extend" and isinstance(value, (list, tuple)):
            owner.extend(value)
            return
    if not isinstance(statement, (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.ClassDef)):
        _forget(statement, names)


def _forget(node: ast.AST, names: dict[str, Any]) -> None:
    for inner in ast.walk(node):
        if isinstance(inner, ast.Name) and inner.id in names and inner.id != "__file__":
            names[inner.id] = UNKNOWN


def _calls(folder: Path) -> dict[str, Any]:
    """Return stand-ins for the functions that a setup.py usually calls, working in the package's folder."""

    def found(pattern: str, **_: Any) -> Any:
        if pattern.startswith("/") or ".." in pattern:
            # Do not search outside the package.
            fixed = pattern.partition("*")[0].rpartition("/")[0]
            return UNKNOWN if (folder / fixed).exists() else []
        pattern = os.path.join(folder, pattern)  # noqa: PTH118 -- the pattern may be absolute
        return [os.path.relpath(path, folder) for path in sorted(glob.glob(pattern, recursive=True))]  # noqa: PTH207

    return {
        "os.path.join": os.path.join,
        "os.path.basename": os.path.basename,
        "os.path.dirname": os.path.dirname,
        "os.path.splitext": os.path.splitext,
        "os.path.abspath": str,
        "glob.glob": found,
        "glob.iglob": found,
        "setuptools.find_packages": partial(_found, folder),
        "setuptools.find_namespace_packages": partial(_found, folder, is_namespace=True),
        "catkin_pkg.python_setup.generate_distutils_setup": dict,
        "str": str,
        "list": list,
        "tuple": tuple,
        "sorted": sorted,
        "dict": dict,
        "zip": lambda *lists: list(zip(*lists, strict=False)),
        "enumerate": lambda items: list(enumerate(items)),
    }


def packages_in(
    folder: Path,
    exclude: tuple[str, ...] = (),
    include: tuple[str, ...] = ("*",),
    *,
    is_namespace: bool = False,
) -> list[str]:
    """Return what `find_packages` finds: folders with an `__init__.py`, and such folders in them.

    The name of such a folder may be any without a dot; `find_namespace_packages` needs no `__init__.py`.
    """
    found: list[str] = []
    queue = [(folder, "")]
    while queue and len(found) < _LARGEST_PACKAGE:
        parent, prefix = queue.pop()
        for path in sorted(parent.iterdir()) if parent.is_dir() else ():
            is_one = path.is_dir() and "." not in path.name
            if is_one and (is_namespace or (path / "__init__.py").is_file()):
                name = prefix + path.name
                queue.append((path, f"{name}."))
                is_wanted = any(fnmatchcase(name, pattern) for pattern in include)
                if is_wanted and not any(fnmatchcase(name, pattern) for pattern in exclude):
                    found.append(name)
    return found


def _groups_in(text: str) -> dict[str, Any]:
    groups: dict[str, Any] = {}
    lines: list[str] = []
    for line in text.splitlines():
        if match := re.fullmatch(r"\s*\[(.+)\]\s*", line):
            lines = groups.setdefault(match[1].strip(), [])
        elif line.strip():
            lines.append(line.strip())
    return groups
