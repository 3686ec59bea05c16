"""The arguments of setup(): unknown keywords, and values of the wrong form."""

from __future__ import annotations

import ast
import functools
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import PurePosixPath
from shlex import quote
from typing import Any

from ros2lab.diagnose.finding import Finding, at, line_with
from ros2lab.diagnose.packaging import setup_child
from ros2lab.diagnose.packaging.file_patterns import folder_taken
from ros2lab.diagnose.sources.commented_out import without_comments
from ros2lab.diagnose.sources.lying import lies_elsewhere
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import read_text
from ros2lab.diagnose.sources.setup_script import SetupScript
from ros2lab.diagnose.sources.spelling import alike, differs, nearest, write_instead
from ros2lab.diagnose.sources.static_value import UNKNOWN, is_known

_LONGEST = 60.0  # s that setuptools may take on a busy machine; usually it takes less than 1 s
_VERSION = re.compile(r"\d+(?:\.\d+)*")

# Keywords that earlier releases of setuptools accepted, and that colcon or pytest may still read.
_FORMER = frozenset(
    ("tests_require", "test_suite", "test_loader", "use_2to3", "convert_2to3_doctests", "features")
)
# Keywords with rules of their own here, or with what `ros2 pkg create` writes: no need to ask setuptools.
_TOLD = frozenset(("name", "packages", "data_files", "entry_points", "console_scripts", "gui_scripts"))
_TEXTS = frozenset(
    ("maintainer", "maintainer_email", "author", "author_email", "description", "license", "url")
)
_AS_CREATED: dict[str, Any] = {
    "version": "0.0.0",
    "install_requires": ["setuptools"],
    "zip_safe": True,
    "extras_require": {"test": ["pytest"]},
    "tests_require": ["pytest"],
}


def shape_faults(package: SourcePackage, setup: SetupScript, *, is_for_ros: bool) -> Iterator[Finding]:
    """Yield the arguments of setup() whose form is not what setuptools accepts or ROS needs."""
    if is_for_ros:
        yield from _names(package, setup)
    yield from _keywords(setup)
    yield from _entry_points(setup)
    yield from _data_files(package, setup)
    packages = setup.keywords.get("packages")
    if isinstance(packages, str):
        yield _value(
            setup,
            "packages",
            f"packages is the string {packages!r} but must be a list",
            f"write packages=[{packages!r}]",
        )


def _value(setup: SetupScript, keyword: str, cause: str, fix: str) -> Finding:
    place = at(setup.source.shown, setup.line(keyword))
    return Finding("setup-value", f"In setup.py, {cause}.", place, fix, (keyword,))


def _names(package: SourcePackage, setup: SetupScript) -> Iterator[Finding]:
    name = setup.keywords.get("name")
    given = package.manifest.name if package.manifest else ""
    if "-" in package.name:
        better = package.name.replace("-", "_")
        cause = f"The name {package.name} has a hyphen, which a Python package name may not have; use an underscore."
        fix = f"create the package again with the name {better}, or write {better} in package.xml, setup.py and setup.cfg, and rename the folders"
        if there := _named(package, better):
            fix = f"touch {quote(package.shown('COLCON_IGNORE'))}, if {there} has replaced it, for that package is called {better}; otherwise give it another name, with underscores"
        yield Finding("package-name", cause, package.shown(""), fix)
    elif isinstance(name, str) and given and name.replace("-", "_") != given:
        if meant_name(package) == name:
            cause = f"package.xml names the package {given}, but its folder and setup.py name it {name}: colcon goes by package.xml."
            fix = f"write <name>{name}</name> in package.xml, then rm -r build install, build again, and source install/setup.bash in a new terminal"
            place = at(package.shown("package.xml"), manifest_line(package, given))
            yield Finding("package-name", cause, place, fix, (name,))
            return
        line = line_with(setup.source.text, name) or setup.line("name")
        cause = f"setup.py names the package {name}, but package.xml names it {given}."
        fix = f"write {given} instead of {name}"
        yield Finding("package-name", cause, at(setup.source.shown, line), fix)


def meant_name(package: SourcePackage) -> str:
    """Return the name that a package should have: that of setup.py, if its folder has it and only package.xml has another."""
    name, given = package.setup.keywords.get("name") if package.setup else None, package.name
    is_meant = isinstance(name, str) and name.replace("-", "_") != given and (package.folder / name).is_dir()
    return str(name) if is_meant and not (package.folder / given).is_dir() else given


def _named(package: SourcePackage, name: str) -> str:
    """Return the folder of the package beside this one that has a name; empty if the name is free."""
    others = (
        SourcePackage(path.parent, package.root) for path in sorted(package.beside.rglob("package.xml"))
    )
    return next((other.shown("").rstrip("/") for other in others if other.name == name), "")


def _keywords(setup: SetupScript) -> Iterator[Finding]:
    asked = _asked(setup)
    start = setup.call.lineno if setup.call else 0
    for keyword, (node, _) in setup.beside.items():
        cause = f"In setup.py, {keyword} is written where it is no argument of setup(), so setuptools does not see it."
        fix = f"write `{keyword}={ast.unparse(node)},` behind `setup(` on line {start}, and remove it here"
        yield Finding("setup-value", cause, setup.source.at(node), fix, (keyword,))
    for keyword in _GROUPS:
        if line := setup.lines.get(keyword):
            cause = f"In setup.py, {keyword} is next to entry_points in setup(), but belongs inside it."
            fix = f"write entry_points={{'{keyword}': [...]}}, with the list as it is"
            yield Finding("setup-value", cause, at(setup.source.shown, line), fix)
    for keyword, (said, better) in _refused(repr(asked)).items() if asked else ():
        if said:
            # A message helps only if it is about the value itself, and not about the code of setuptools.
            is_clear = keyword in said or repr(asked[keyword]) in said
            why = f": {said.partition(chr(10))[0].rstrip('.:')}" if is_clear else ""
            cause = f"setuptools rejects {keyword}={asked[keyword]!r}{why}"
            new = _AS_CREATED.get(keyword) if better is None else better
            yield _value(setup, keyword, cause, f"write {keyword}={new!r}" if new else f"remove {keyword}")
        elif keyword not in _FORMER:
            wanted = nearest(keyword, better, 0.6)
            cause = f"setup() has no keyword argument {keyword} and ignores it"
            fix = write_instead(wanted, keyword, setup.lines) if wanted else f"remove {keyword}"
            yield _value(setup, keyword, cause, fix)


_GROUPS = ("console_scripts", "gui_scripts")


def _asked(setup: SetupScript) -> dict[str, Any]:
    """Return the arguments of setup() to ask setuptools about."""
    given = {keyword: setup.keywords.get(keyword) for keyword in setup.lines if keyword not in _GROUPS}
    return {key: value for key, value in given.items() if not _is_usual(key, value) and is_known(value)}


def as_meant(package: SourcePackage, setup: SetupScript) -> tuple[SourcePackage, SetupScript]:
    """Return a package as if the misspelt keywords of its setup() were spelt correctly."""
    asked = _asked(setup)
    refused = _refused(repr(asked)) if asked else {}
    unknown = ((key, better) for key, (said, better) in refused.items() if not said and key not in _FORMER)
    known = {key: nearest(key, better, 0.6) for key, better in unknown}
    names = {keyword: name for keyword, name in known.items() if name and name not in setup.keywords}
    keywords = {name: setup.keywords[keyword] for keyword, name in names.items()}
    lines = {name: setup.lines[keyword] for keyword, name in names.items()}
    groups = {group: setup.keywords[group] for group in _GROUPS if group in setup.lines}
    if groups and "entry_points" not in setup.keywords:
        keywords["entry_points"], lines["entry_points"] = groups, min(setup.lines[group] for group in groups)
    keywords |= {keyword: value for keyword, (_, value) in setup.beside.items()}
    lines |= {keyword: node.lineno for keyword, (node, _) in setup.beside.items()}
    if not keywords:
        return package, setup
    meant = SourcePackage(package.folder, package.root, package.is_run)
    meant.setup = replace(setup, keywords=setup.keywords | keywords, lines=setup.lines | lines)
    return meant, meant.setup


def _is_usual(keyword: str, value: Any) -> bool:
    """Return whether a value is known to be accepted, or is checked elsewhere."""
    is_text = isinstance(value, str) and (
        keyword in _TEXTS or (keyword == "version" and _VERSION.fullmatch(value))
    )
    return keyword in _TOLD or bool(is_text) or value == _AS_CREATED.get(keyword, UNKNOWN)


@functools.lru_cache(maxsize=64)
def _refused(given: str) -> Mapping[str, tuple[str, Any]]:
    """Return the arguments that setuptools rejects, and why; see `setup_child.refusals`."""
    try:
        # Isolated, so that no student's file shadows what it imports.
        said = subprocess.run(
            [sys.executable, "-I", setup_child.__file__],
            input=given,
            capture_output=True,
            text=True,
            timeout=_LONGEST,
            check=True,
        ).stdout
        refused: Mapping[str, tuple[str, Any]] = ast.literal_eval(said)
    except (OSError, ValueError, SyntaxError, subprocess.SubprocessError):
        return {}
    return refused


def _entry_points(setup: SetupScript) -> Iterator[Finding]:
    value = setup.keywords.get("entry_points")
    if isinstance(value, (list, tuple)):
        cause = "entry_points is a list but must be a dict that holds the list under 'console_scripts'"
        yield _value(
            setup,
            "entry_points",
            cause,
            "write entry_points={'console_scripts': [...]}, with the list as it is",
        )
    scripts = value.get("console_scripts") if isinstance(value, dict) else None
    if isinstance(scripts, dict):
        name, target = next(iter(scripts.items()), ("talk", "my_package.talk:main"))
        cause = "'console_scripts' holds a dict but must hold a list of strings"
        yield _value(setup, "entry_points", cause, f"write 'console_scripts': ['{name} = {target}']")


def _data_files(package: SourcePackage, setup: SetupScript) -> Iterator[Finding]:
    value = setup.keywords.get("data_files")
    if isinstance(value, dict):
        cause = "data_files is a dict but must be a list of pairs of a folder and its files"
        yield _value(setup, "data_files", cause, f"write data_files={[*value.items()]!r}")
    given = setup.given("data_files")
    items = given.elts if isinstance(given, ast.List) else []
    lists = {number for number, item in enumerate(items) if isinstance(item, ast.List)}
    for number, entry in enumerate(value) if isinstance(value, (list, tuple)) else ():
        match entry:
            case [str() as target, str() as file] if "/" in target or target == "share":
                cause = f"the files for {target} are the string {file!r} but must be a list"
                yield _value(setup, "data_files", cause, f"write brackets around it: [{file!r}]")
            case str():
                cause = f"data_files holds the string {entry!r} where a pair of a folder and a list of files should be"
                yield _value(
                    setup, "data_files", cause, f"write (os.path.join('share', package_name), [{entry!r}])"
                )
            case [str() as target, [*files]]:
                yield from _files(package, setup, files)
                if target.startswith("/") and package.build_type == "ament_python":
                    yield _absolute(package, setup, target)
                if number in lists:
                    cause = f"the folder {entry[0]} and its files are in [ ], but colcon needs each such pair in ( )"
                    yield _value(
                        setup,
                        "data_files",
                        cause,
                        f"write ( instead of the [ before {entry[0]!r}, and ) instead of its ]",
                    )


def _absolute(package: SourcePackage, setup: SetupScript, target: str) -> Finding:
    """Say that a folder in data_files is an absolute path."""
    written, line = setup.written(target.rstrip("/"))
    better = re.sub(r"(^|[(,]\s*)(f?['\"])/+", r"\1\2", written).replace("'' + ", "")
    is_meant = target.lstrip("/").startswith(("share/", "lib/")) or better.startswith("os.path.join('share',")
    right = better if is_meant and better != written else f"'share/{package.name}', or a folder in it,"
    cause = f"data_files installs into {target}: that begins with a slash, so it is an absolute path, which colcon refuses with an AssertionError without a message."
    fix = f"write {right} instead of {written}: colcon puts it into the package's own install folder"
    return Finding("setup-value", cause, at(setup.source.shown, line), fix, ("data_files",))


def _files(package: SourcePackage, setup: SetupScript, files: list[Any]) -> Iterator[Finding]:
    for file in (item for item in files if isinstance(item, str) and item):
        path = package.folder / file
        if path.is_dir():
            yield folder_taken(package, setup, file)
            return  # the other folders that a pattern finds are left out with it
        elif not path.exists() and (pair := _two_files(package, file)):
            cause = f"setup.py installs {file}, which are two files: a comma is missing between them."
            place = at(setup.source.shown, setup.written(file)[1])
            yield Finding("data-file-missing", cause, place, f"write {pair[0]!r}, {pair[1]!r}")
        elif not path.exists() and (called := alike(package.folder, file)):
            shown, wanted = package.shown(called), package.shown(file)
            cause = f"setup.py installs {file}, but there is {called} instead: {differs(called, file)}."
            fix = f"mv {quote(shown)} {quote(wanted)}"
            yield Finding("data-file-missing", cause, at(setup.source.shown, setup.line("data_files")), fix)
        elif not path.exists() and (close := like(path)) and not lies_elsewhere(package, file):
            shown, wanted = package.shown(str(PurePosixPath(file).parent / close)), package.shown(file)
            cause = f"setup.py installs {file}, but there is no such file; there is {close}."
            fix = f"mv {quote(shown)} {quote(wanted)}"
            yield Finding("data-file-missing", cause, at(setup.source.shown, setup.line("data_files")), fix)


def _two_files(package: SourcePackage, joined: str) -> tuple[str, str] | None:
    """Return the two files whose paths a text joins; None if it does not."""
    pairs = ((joined[:n], joined[n:]) for n in range(1, len(joined)))
    return next((pair for pair in pairs if all((package.folder / file).is_file() for file in pair)), None)


def like(path: Any) -> str:
    """Return the name of a file in the same folder with a similar name; empty if there is none."""
    there = sorted(file.name for file in path.parent.glob("*") if file.is_file())

    def plain(name: str) -> str:
        return re.sub(r"[ _-]", "", name.partition(".")[0].lower())

    same = [name for name in there if plain(name) == plain(path.name)]
    same = [name for name in same if name != path.name and not name.endswith((".pyc", ".md"))]
    return same[0] if same else ""


def manifest_line(package: SourcePackage, word: str, *, after: str = "") -> int | None:
    """Return the line of package.xml in which a word is a tag or its content; None if there is none.

    Comments do not count; with `after`, only what follows the beginning of that tag does.
    """
    text = without_comments(read_text(package.folder / "package.xml"))
    start = re.search(rf"<{re.escape(after)}\b", text) if after else None
    pattern = rf">\s*{re.escape(word)}\s*<|<{re.escape(word)}\b"
    found = re.compile(pattern).search(text, start.end() if start else 0)
    return text.count("\n", 0, found.start() + found[0].index(word)) + 1 if found else None
