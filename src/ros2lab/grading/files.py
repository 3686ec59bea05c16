"""What stands in a submission's files: facts by parsing, never by running or importing.

What is wrong with a package is found by `diagnose`, so that a lost point and the advice for it have one source.
Where a value is known only to whoever runs setup.py, the fact counts as true; the build tells whether it is.
"""

from __future__ import annotations

import ast
import contextlib
import importlib
import io
import itertools
import os
import re
import tokenize
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Any

from ros2lab import assignments
from ros2lab.assignments import Assignment
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.interfaces import PACKAGES, is_installed
from ros2lab.diagnose.look import Look, text_faults
from ros2lab.diagnose.manifest_faults import manifest_faults
from ros2lab.diagnose.node_source import NodeSources
from ros2lab.diagnose.package import SourcePackage
from ros2lab.diagnose.packaging_faults import packaging_faults
from ros2lab.diagnose.parameter_faults import declared_in
from ros2lab.diagnose.parameter_file import ParameterFileError, read_parameter_file
from ros2lab.diagnose.python_source import Function, PythonSource, read_source, read_text
from ros2lab.diagnose.setup_script import SetupScript, packages_in
from ros2lab.diagnose.spelling import is_near_miss
from ros2lab.diagnose.topic_faults import ends_of, timers_of
from ros2lab.grading.compared import compared
from ros2lab.grading.evidence import Files, Place, WrittenEnd
from ros2lab.grading.submission import MOST_SOURCE, FoundPackage, Submission
from ros2lab.handlers import is_by_name

LONGEST_README = 20_000  # characters
MOST_FINDINGS = 50
MOST_DECLARED = 50  # parameters
MOST_ENDS = 100
MOST_RECORDINGS = 10

# The facts of package.xml that a finding of `diagnose` makes false. `declares_<name>` for each that the
# assignment asks for, and whether description, license and maintainer are written, are asked of the file itself.
MANIFEST_FINDINGS: Mapping[str, frozenset[str]] = {
    "is_valid": frozenset(("manifest-invalid",)),
    "is_ament_python": frozenset(("build-type-missing", "build-type-unknown", "build-type-cmake")),
    "dependencies_exist": frozenset(("dependency-unknown", "dependency-not-ros")),
    "declares_all_imports": frozenset(("dependency-undeclared",)),
}
# Those of setup.py, setup.cfg and what they name. `name_agrees`, `marker_exists`, `manifest_is_installed` and
# `is_described` are asked of the files themselves.
SETUP_FINDINGS: Mapping[str, frozenset[str]] = {
    "is_valid": frozenset(("setup-syntax", "setup-missing", "setup-import", "name-undefined-in-setup")),
    "installs_modules": frozenset(("package-folder-missing", "package-not-listed", "init-file-missing")),
    "marker_is_installed": frozenset(("marker-not-installed",)),
    "data_files_exist": frozenset(("data-file-missing",)),
    "scripts_go_to_lib": frozenset(("setup-cfg-missing",)),
    "cfg_has_no_dashes": frozenset(("setup-cfg-dashes",)),
    "has_entry_points": frozenset(("entry-points-key", "entry-points-missing")),
    "entry_points_lead_to_functions": frozenset(
        (
            "entry-point-comma",
            "entry-point-spec",
            "entry-point-twice",
            "entry-point-module",
            "entry-point-no-function",
            "entry-point-function",
        )
    ),
}

# What a setup.py that cannot be read must hold, so that a fact about it may be true all the same.
_TRACES = {
    "installs_modules": "packages",
    "marker_is_installed": "resource_index/packages",
    "manifest_is_installed": "package.xml",
    "data_files_exist": "data_files",
    "has_entry_points": "console_scripts",
    "entry_points_lead_to_functions": "console_scripts",
    "name_agrees": "name",
    "is_described": "description",
}

_TODO = re.compile(r"\bTODO\b|\bFIXME\b|\b[Tt]odo:")  # in Spanish `todo` is a word
_README = re.compile(
    r"(?:read[ _-]?me|liesmich|lies[ _-]mich|lis(?:ez)?[ _-]?moi|l[eé]a[ _-]?me|l[eé]eme|leia[ _-]?me|leggimi|"
    r"beni[ _-]?oku|czytaj|czytajto|przeczytaj|citiţi|прочти|читай|自述|说明|読んで)[^/]*",
    re.IGNORECASE,
)
_NOT_README = re.compile(r"(?:changelog|license|licence|contributing|todo|evidence)\b.*", re.IGNORECASE)
_RECORDINGS = re.compile(
    r".+\.(?:png|jpe?g|gif|webp|svg|mp4|webm|mkv|mov|cast|log|pdf)|.*(?:log|output|run|terminal|evidence).*\.txt",
    re.IGNORECASE,
)
_TEXTS = frozenset(("", ".md", ".markdown", ".mdown", ".rst", ".txt", ".adoc", ".org", ".html"))
_COMMENT = re.compile(r"(?:^|\s)#[^\n]*|<!--(?s:.*?)(?:-->|\Z)")  # of Python, YAML or XML
_STYLE_CHECKERS = re.compile(r"\bament_(?:copyright|flake8|pep257|xmllint|mypy)\b")


def look(root: Path, submission: Submission, assignment: Assignment | None = None) -> Files:
    """Collect the facts of a submission's files.

    Args:
        root: the folder into which it was received.
        submission: what was found there.
        assignment: for which it was handed in; None takes the course's own.

    Returns:
        The facts; those that a run must tell are left empty. Paths are relative to `root`.
    """
    found = submission.package
    paths = _paths(root)
    texts, recordings = _readmes(root, paths, submission), _recordings(paths)
    if found is None:
        loose = [read_source(root / name, PurePosixPath(name).stem, name) for name in submission.node_files]
        found_in = diagnosed(lambda: [finding for source in loose for finding in text_faults(source)])
        return Files(
            sources=_described(loose),
            readme=texts,
            recordings=recordings,
            handlers=_handlers(loose),
            compared=compared(loose),
            ends=_ends(NodeSources({source.name: source for source in loose})),
            findings=found_in,
        )
    package = Package(root / found.folder, root)
    packages = [package, *(Package(root / one.folder, root) for one in launching(root, submission))]
    names = {one.name for one in submission.packages if one.name}
    sources = package.own_sources
    tests, left_out = _tests(package)
    return Files(
        manifest=_manifest_facts(package, names, (assignment or assignments.load()).dependencies),
        setup=_setup_facts(package),
        sources=_described(sources),
        readme=texts,
        recordings=recordings,
        launch_files=[
            str(path.relative_to(root)) for path in launch_files([*packages, *around(package, root)])
        ],
        parameter_files={
            str(path.relative_to(root)): _parameters(read_text(path)) for path in _parameter_files(packages)
        },
        parameter_file_users=_parameter_file_users(root, packages),
        tests=tests,
        tests_left_out=[*left_out],
        handlers=_handlers(sources),
        compared=compared(sources),
        ends=_ends(NodeSources(package.sources)),
        declared=_declared(package),
        findings=_findings(root, submission, package),
        notes=[*package.notes, *left_out.values()],
    )


def launching(root: Path, submission: Submission) -> list[FoundPackage]:
    """Return the other packages whose launch files name the assignment's, such as a `robot_bringup`."""
    own = Package(root / submission.package.folder, root).name if submission.package else ""
    is_named = re.compile(rf"\b{re.escape(own)}\b").search
    return [
        one
        for one in submission.packages
        if own and one.name not in (None, own)
        if any(map(is_named, _uncommented([Package(root / one.folder, root)]).values()))
    ]


def written_modules(package: Path) -> Iterator[Path]:
    """Yield the Python files of a package's folder that are neither tests nor setup.py nor launch files."""
    for path in sorted(package.rglob("*.py")):
        below = path.relative_to(package)
        is_test = any(
            re.fullmatch(r"tests?|test_.*|.*_test", part.removesuffix(".py")) for part in below.parts
        )
        is_other = (
            below.name in ("setup.py", "conftest.py") or ".launch" in below.name or "launch" in below.parts
        )
        if path.is_file() and not path.is_symlink() and not is_test and not is_other:
            yield path


class Package(SourcePackage):
    """A package whose author may mean harm.

    It has no entities, nothing outside its folder, and no more Python than somebody writes by hand. What setup.cfg
    and pyproject.toml say in the place of setup.py counts as setup.py's.
    """

    @property
    def notes(self) -> list[str]:
        """What was not looked at."""
        if self._is_too_much:
            return [f"The Python files were not looked at, because there are more than {MOST_SOURCE} bytes."]
        return []

    @cached_property
    def _is_too_much(self) -> bool:
        total = 0
        for path in self.folder.rglob("*.py"):
            total += path.lstat().st_size
            if total > MOST_SOURCE:
                return True
        return False

    @cached_property
    def _parsed(self) -> tuple[Any, str | None, int | None]:
        if "<!ENTITY" in read_text(self.folder / "package.xml"):
            return None, "it defines entities, which no package.xml needs", None
        return super()._parsed

    @cached_property
    def sources(self) -> Mapping[str, PythonSource]:
        """Its modules by name; none if there is too much."""
        return {} if self._is_too_much else super().sources

    @property
    def own_sources(self) -> list[PythonSource]:
        """Its modules; all of its Python files where setup.py leads to none that has code."""
        sources = [*self.sources.values()]
        if self._is_too_much or any(map(_has_code, sources)):
            return sources
        return [
            read_source(path, path.stem, self.shown(str(path.relative_to(self.folder))))
            for path in written_modules(self.folder)
        ]

    @property
    def package_dirs(self) -> Mapping[str, str]:
        """What is said in `package_dir`, as far as it does not lead out of the package."""
        return {name: where for name, where in super().package_dirs.items() if _is_inside(where)}

    @cached_property
    def setup(self) -> SetupScript | None:
        """Its setup.py, with what stands in setup.cfg and pyproject.toml instead."""
        script = super().setup
        if script is not None and script.is_called:
            for name, value in self._configured():
                if not script.keywords.get(name):
                    script.keywords[name] = value
        return script

    def _configured(self) -> Iterator[tuple[str, Any]]:
        """Yield what setup.cfg and pyproject.toml say, under the names of setup()'s arguments."""
        config = self.setup_cfg
        if config is not None:
            for section, key in (("metadata", "name"), ("metadata", "description"), ("metadata", "license")):
                if config.has_option(section, key):
                    yield key, config.get(section, key)
            if config.has_section("options.entry_points"):
                yield (
                    "entry_points",
                    {key: _lines(text) for key, text in config.items("options.entry_points")},
                )
            if config.has_section("options.data_files"):
                items = config.items("options.data_files")
                yield "data_files", [(key, self._globbed(_lines(text))) for key, text in items]
            directories = _lines(config.get("options", "package_dir", fallback=""))
            pairs = [one.partition("=") for one in directories]
            if pairs:
                yield "package_dir", {name.strip(): where.strip() for name, _, where in pairs}
            packages = config.get("options", "packages", fallback="").strip()
            if packages in ("find:", "find_namespace:"):
                where = config.get("options.packages.find", "where", fallback=".").strip()
                yield "packages", packages_in(self.folder / where) if _is_inside(where) else []
            elif packages:
                yield "packages", _lines(packages.replace(",", "\n"))
        toml = _toml(read_text(self.folder / "pyproject.toml"))
        packages = _inner(toml, "tool", "setuptools", "packages")
        if isinstance(packages, list):
            yield "packages", packages
        elif isinstance(packages, dict):
            where = _inner(packages, "find", "where")
            folders = where if isinstance(where, list) else ["."]
            yield (
                "packages",
                [name for one in folders if _is_inside(one) for name in packages_in(self.folder / one)],
            )
        project = toml.get("project")
        if isinstance(project, dict):
            yield from ((key, project[key]) for key in ("name", "description") if key in project)
            scripts = project.get("scripts")
            if isinstance(scripts, dict):
                yield (
                    "entry_points",
                    {"console_scripts": [f"{key} = {text}" for key, text in scripts.items()]},
                )

    def _globbed(self, patterns: Iterable[str]) -> list[str]:
        found: list[str] = []
        for pattern in patterns:
            is_looked_for = "*" in pattern and _is_inside(pattern)
            paths: list[Path] = []
            if is_looked_for:
                with contextlib.suppress(ValueError):  # no pattern
                    paths = sorted(self.folder.glob(pattern))
            found += [str(path.relative_to(self.folder)) for path in paths] or [pattern]
        return found


def _is_inside(path: object) -> bool:
    return isinstance(path, str) and not path.startswith("/") and ".." not in path


def _lines(text: str) -> list[str]:
    return [line.strip() for line in text.splitlines() if line.strip()]


def _inner(table: Mapping[str, Any], *names: str) -> Any:
    """Return what a table holds under names of tables in tables; None if it is not there."""
    value: Any = table
    for name in names:
        value = value.get(name) if isinstance(value, dict) else None
    return value


def _toml(text: str) -> dict[str, Any]:
    for name in ("tomllib", "setuptools.compat.py310"):  # Python 3.10 has none of its own
        try:
            module = importlib.import_module(name)
        except ImportError:
            continue
        reader = getattr(module, "tomllib", module)
        try:
            return dict(reader.loads(text))
        except (ValueError, RecursionError):
            return {}
    return {}


# --- package.xml ------------------------------------------------------------------------------------------


def _manifest_facts(package: Package, names: Collection[str], required: Collection[str]) -> dict[str, bool]:
    if not package.has("package.xml"):
        return {"is_there": False}
    text = re.sub(r"<!--.*?(?:-->|\Z)", "", read_text(package.folder / "package.xml"), flags=re.DOTALL)
    # Also of a file that is not valid XML: its other lines may be right.
    tags = re.findall(r"<(\w+)\b[^<>]*>\s*([^<>]*)", text)
    declared = {
        value.strip() for tag, value in tags if tag in ("depend", "exec_depend", "run_depend", "build_depend")
    }
    findings = [*manifest_faults(package, names)]
    missing = [name for name in required if name not in declared]
    facts = {"is_there": True}
    for fact, codes in MANIFEST_FINDINGS.items():
        facts[fact] = not any(
            finding.code in codes and not _is_about(finding, missing, declared) for finding in findings
        )
    if not facts["is_valid"]:
        facts["is_ament_python"] = ("build_type", "ament_python") in [(t, v.strip()) for t, v in tags]
    facts |= {f"declares_{name}": name in declared for name in required}
    return facts | {f"{tag}_is_written": is_written for tag, is_written in own_words(text).items()}


def own_words(manifest: str) -> dict[str, bool]:
    """Return whether description, license and maintainer in the text of a package.xml are somebody's own words."""
    written = {tag: _between(manifest, tag) for tag in ("description", "license", "maintainer")}
    facts = {tag: bool(text) and not _TODO.search(text) for tag, text in written.items()}
    addresses = re.findall(r"<maintainer\b[^<>]*email\s*=\s*[\"']([^\"'<>]*)", manifest)
    facts["maintainer"] &= not any("todo" in address.lower() for address in addresses)
    return facts


def _is_about(finding: Finding, missing: Iterable[str], declared: Iterable[str]) -> bool:
    """Return whether a finding says only that one of the required packages is not declared, or misspelt."""
    for name in missing:
        if finding.code == "dependency-undeclared" and f"<depend>{name}</depend>" in finding.fix:
            return True
        misspelt = [one for one in declared if is_near_miss(one, name)]
        if finding.code == "dependency-unknown" and any(
            f"declares {one}," in finding.cause for one in misspelt
        ):
            return True
    return False


def _between(text: str, tag: str) -> str:
    """Return what stands in an element, without the elements in it."""
    match = re.search(rf"<{tag}\b[^<>]*>(?:((?s:.{{0,5000}}?))</{tag}\s*>|([^<]*))", text)
    inner = (match[1] or match[2] or "") if match else ""
    return re.sub(r"<!\[CDATA\[|\]\]>|<[^<>]*>", " ", inner).strip()


# --- setup.py ---------------------------------------------------------------------------------------------


def _setup_facts(package: Package) -> dict[str, bool]:
    setup = package.setup
    if setup is None:
        return {"is_there": False}
    facts = _packaging_facts(package, setup)
    name = setup.keywords.get("name")
    facts["name_agrees"] = not isinstance(name, str) or _normal(name) == _normal(package.name)
    if not facts["name_agrees"]:
        # One of the two names is the fault; all that agrees with the other is right.
        renamed = Package(package.folder, package.root)
        renamed.name = str(name)
        others = _packaging_facts(renamed, setup)
        facts |= others if sum(others.values()) > sum(facts.values()) else {}
    if not setup.is_called:
        text = "\n".join(read_text(package.folder / name) for name in ("setup.py", "setup.cfg"))
        facts |= {fact: word in text for fact, word in _TRACES.items()}
        facts["is_described"] &= not _TODO.search(text)
    return facts


def _packaging_facts(package: Package, setup: SetupScript) -> dict[str, bool]:
    codes = {
        finding.code
        for finding in packaging_faults(package)
        # That there is no package.xml is a fact of its own.
        if package.has("package.xml") or not re.search(r"\bpackage\.xml\b", finding.cause)
    }
    facts = {"is_there": True}
    facts |= {fact: not codes & theirs for fact, theirs in SETUP_FINDINGS.items()}
    if facts["is_valid"] and setup.entry_points == [] and not setup.keywords.get("scripts"):
        facts["has_entry_points"] = False
    facts["marker_exists"] = package.has(f"resource/{package.name}")
    facts["manifest_is_installed"] = _installs_manifest(package, setup)
    words = [setup.keywords.get(key) for key in ("description", "license", "maintainer", "maintainer_email")]
    facts["is_described"] = not any(isinstance(word, str) and _TODO.search(word) for word in words)
    return facts


def _normal(name: str) -> str:
    """Return a name as Python's packaging compares it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def _installs_manifest(package: Package, setup: SetupScript) -> bool:
    known = setup.data_files
    if known is None or not getattr(setup, "are_data_files_known", True):
        return True
    target = f"share/{package.name}"
    return any(where == target and "package.xml" in map(os.path.normpath, files) for where, files in known)


# --- the rest ---------------------------------------------------------------------------------------------


def _paths(root: Path) -> list[PurePosixPath]:
    """Return all files below a folder, relative to it."""
    return [
        PurePosixPath(parent, name).relative_to(root.as_posix())
        for parent, _, names in os.walk(root)
        for name in names
    ]


def _recordings(paths: Iterable[PurePosixPath]) -> list[str]:
    """Return the pictures, films and logs, of which some may show the nodes running; not more than a few."""
    return sorted(str(path) for path in paths if _RECORDINGS.fullmatch(path.name))[:MOST_RECORDINGS]


def _readmes(root: Path, paths: Iterable[PurePosixPath], submission: Submission) -> str:
    """Return what the README says: the package's, the workspace's, those around them; else other notes there.

    Returns:
        The text, at most `LONGEST_README` characters; empty if there is none.
    """
    package = submission.package.folder if submission.package else None
    own = {folder for folder in (package, submission.workspace) if folder is not None}
    others = {one.folder for one in submission.packages} - own
    files = [
        file
        for file in paths
        if file.suffix.lower() in _TEXTS
        and not _NOT_README.fullmatch(file.name)
        and not others & {str(folder) for folder in file.parents if str(folder) != "."}
    ]
    named = [file for file in files if _README.fullmatch(file.name)]
    if not named:
        around = {".", "docs", "doc", *own} | {
            f"{folder}/{name}" for folder in own for name in ("docs", "doc")
        }
        named = [
            file for file in files if str(file.parent) in around and file.suffix.lower() not in ("", ".txt")
        ]
    named.sort(key=lambda file: (str(file.parent) != package, len(file.parts), str(file)))
    texts, length = [], 0
    for file in named:
        text = _any_text(root / file).strip()
        if text and text not in texts and length < LONGEST_README:
            texts.append(text)
            length += len(text)
    return "\n\n".join(texts)[:LONGEST_README]


def _any_text(path: Path) -> str:
    """Return the beginning of a file, whatever its encoding; nothing if it is no text."""
    try:
        with path.open("rb") as file:
            data = file.read(4 * LONGEST_README)
    except OSError:
        return ""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data.decode("utf-16", errors="replace")
    if b"\0" in data:
        return ""
    cut = data.decode("utf-8-sig", errors="replace")
    # A single character is replaced where the file was cut; more of them are another encoding.
    return cut if cut.count("�") <= 1 else data.decode("cp1252", errors="replace")


def _has_code(source: PythonSource) -> bool:
    return any(
        isinstance(node, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)) for node in source.nodes
    )


def _described(sources: Iterable[PythonSource]) -> dict[str, list[int]]:
    counts = {"modules": [0, 0], "classes": [0, 0], "functions": [0, 0]}
    for source in sources:
        comments = _comment_lines(source.text) if source.tree.body else set()
        for kind, is_described in _descriptions(source, comments):
            counts[kind][0] += is_described
            counts[kind][1] += 1
    return counts


def _descriptions(source: PythonSource, comments: set[int]) -> Iterator[tuple[str, bool]]:
    lines = source.text.splitlines()
    if source.tree.body:
        first = source.tree.body[0].lineno
        yield "modules", _has_docstring(source.tree) or any(line < first for line in comments)
    named = [n for n in source.nodes if isinstance(n, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef))]
    for node in named:
        start = min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])
        # A class is not described by what stands in its methods.
        is_class = isinstance(node, ast.ClassDef)
        end = node.body[0].lineno if is_class else node.end_lineno or node.lineno
        above = start - 1
        while above > 0 and not lines[above - 1].strip():
            above -= 1
        is_commented = any(above <= line <= end for line in comments)
        is_described = _has_docstring(node) or is_commented
        if is_described or not _says_itself(node, named):
            yield "classes" if is_class else "functions", is_described


def _says_itself(node: ast.ClassDef | Function, named: Sequence[ast.ClassDef | Function]) -> bool:
    """Return whether a function needs no words: `__init__`, `main` beside others, and what has one statement only."""
    is_short = len(node.body) == 1 and not {"body", "cases"} & {*node.body[0]._fields}
    is_known = re.fullmatch(r"__\w+__|setUp|tearDown", node.name) or (node.name == "main" and len(named) > 1)
    return is_short or bool(is_known)


def _has_docstring(node: ast.Module | ast.ClassDef | Function) -> bool:
    return bool((ast.get_docstring(node) or "").strip())


def _comment_lines(text: str) -> set[int]:
    """Return the lines with a comment that somebody wrote to be read."""
    found = set()
    try:
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            is_read = token.type == tokenize.COMMENT and re.search(r"[^\W\d_]{2}", token.string)
            if is_read and not re.match(
                r"#!|#.*(coding[:=]|copyright|licen[sc]e|noqa|type:)", token.string, re.I
            ):
                found.add(token.start[0])
    except (tokenize.TokenError, SyntaxError, RecursionError):
        pass
    return found


def _handlers(sources: Iterable[PythonSource]) -> dict[str, list[Place]]:
    places: dict[str, list[Place]] = {"by name": [], "wholesale": []}
    for source in sources:
        for node in source.nodes:
            if isinstance(node, ast.ExceptHandler):
                key = "by name" if is_by_name(node) else "wholesale"
                places[key].append(Place(source.shown, node.lineno))
    return places


def _tests(package: Package) -> tuple[dict[str, int], dict[str, str]]:
    """Count the test functions in each file of tests but those that `ros2 pkg create` writes.

    Returns:
        The counts by file; and notes on files that cannot be run here, for ROS packages that they import, by file.
    """
    found: dict[str, int] = {}
    left_out: dict[str, str] = {}
    if package.notes:
        return found, left_out
    for path in sorted(package.folder.rglob("*.py")):
        if not re.fullmatch(r"test_.*|.*_test|tests?", path.stem) or not path.is_file():
            continue
        source = read_source(path, path.stem, package.shown(str(path.relative_to(package.folder))))
        if _STYLE_CHECKERS.search(source.text):
            continue
        functions = (
            node for node in source.nodes if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
        )
        count = sum(node.name.startswith("test") for node in functions)
        tops = {one.target.partition(".")[0] for one in source.imports}
        absent = sorted(top for top in tops & PACKAGES if not is_installed(top))
        if count and absent:
            left_out[source.shown] = (
                f"{source.shown} was not run: {', '.join(absent)} cannot be imported here."
            )
        elif count:
            found[source.shown] = count
    return found, left_out


def around(package: Package, root: Path) -> list[Package]:
    """Return the folders around a package, such as the workspace, in which launch files may lie that nothing installs."""
    around = [folder for folder in package.folder.parents if folder == root or root in folder.parents]
    return [Package(folder, root) for folder in around]


def launch_files(packages: Iterable[Package]) -> list[Path]:
    """Return the launch files of packages."""
    return [*dict.fromkeys(path for package in packages for path in package.launch_files)]


def _uncommented(packages: Iterable[Package]) -> dict[Path, str]:
    """Return the texts of launch files without their comments."""
    return {path: _COMMENT.sub("", read_text(path)) for path in launch_files(packages)}


def _parameter_files(packages: Iterable[Package]) -> list[Path]:
    """Return what sets parameters, or lies where such a file is expected and may be meant to."""
    found: list[Path] = []
    for package in packages:
        paths = [path for path in package.folder.rglob("*.y*ml") if path.is_file()]
        found += sorted(
            {path for path in paths if "ros__parameters" in read_text(path)}.union(package.parameter_files)
        )
    return found


def _parameter_file_users(root: Path, packages: Sequence[Package]) -> dict[str, list[str]]:
    """Return for each parameter file the launch files that name it, and the modules that do and read YAML."""
    texts = {str(path.relative_to(root)): text for path, text in _uncommented(packages).items()}
    for source in packages[0].own_sources:
        if any(one.target.partition(".")[0] == "yaml" for one in source.imports):
            texts[source.shown] = _COMMENT.sub("", source.text)
    return {
        str(path.relative_to(root)): [name for name, text in texts.items() if path.name in text]
        for path in _parameter_files(packages)
    }


def _parameters(text: str) -> dict[str, dict[str, Any]]:
    """Return the parameters in a file, by node; nothing of one that cannot be read, or that repeats itself."""
    try:
        root = read_parameter_file(text)
    except ParameterFileError:
        return {}
    found: dict[str, dict[str, Any]] = {}
    queue = [("", root)]
    while queue:
        name, value = queue.pop()
        for key, inner in value.items() if isinstance(value, dict) else ():
            if key == "ros__parameters":
                found[name or "/"] = {str(one): each for one, each in _flat("", inner)}
            else:
                queue.append((f"{name}/{str(key).strip('/')}", inner))
    return found


def _flat(prefix: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Yield parameters with dots for their groups."""
    for key, inner in value.items() if isinstance(value, dict) else ():
        if isinstance(inner, dict):
            yield from _flat(f"{prefix}{key}.", inner)
        elif isinstance(inner, (str, bool, int, float)):
            yield f"{prefix}{key}", inner
        else:
            yield f"{prefix}{key}", str(inner)


# --- diagnosis --------------------------------------------------------------------------------------------


def diagnosed(find: Callable[[], Iterable[Finding]]) -> list[list[str]]:
    """Return findings as they stand in the evidence; none where a submission is too entangled to be followed."""
    try:
        return [[one.code, one.cause, one.place, one.fix] for one in find()][:MOST_FINDINGS]
    except RecursionError:
        return []


def _ends(sources: NodeSources) -> list[WrittenEnd]:
    """Return the publishers and subscriptions that some files make."""
    try:
        return [
            WrittenEnd(
                f"/{end.topic}",
                (end.type or "").replace(".", "/"),
                end.is_publisher,
                [seconds for _, seconds in timers_of(end)],
            )
            for end in ends_of(sources)
        ][:MOST_ENDS]
    except RecursionError:
        return []


def _declared(package: Package) -> dict[str, bool | float | str | None]:
    """Return the parameters that a package's nodes declare, as far as its code tells."""
    try:
        found = declared_in(NodeSources(package.sources)) or {}
    except RecursionError:
        return {}
    plain = {name: one if isinstance(one, (bool, int, float, str)) else None for name, one in found.items()}
    return dict(itertools.islice(plain.items(), MOST_DECLARED))


def _findings(root: Path, submission: Submission, package: Package) -> list[list[str]]:
    """Return what the diagnosis says of the package's files."""
    look = Look(package.folder)
    look.packages = [package, *(Package(root / one.folder, root) for one in submission.packages if one.name)]
    look.packages = list({one.folder: one for one in look.packages}.values())
    # Nothing stands before the names of a package that was handed in alone.
    prefix = package.shown("setup.py").removesuffix("setup.py")
    return diagnosed(lambda: [one for one in look.findings if not one.place or one.place.startswith(prefix)])
