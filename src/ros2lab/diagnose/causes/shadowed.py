"""Modules that are hidden by others of the same name: by a file of the student, or by another package's module."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

from ros2lab.diagnose.code.bound_names import global_names
from ros2lab.diagnose.code.imports import bound_names
from ros2lab.diagnose.finding import Finding, in_a_row, shown_path
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.taken_names import hidden_files
from ros2lab.diagnose.packaging.installed import site_packages
from ros2lab.diagnose.printed.error_text import ErrorReport, ErrorText, Frame, own_frames
from ros2lab.diagnose.printed.spots import place_of
from ros2lab.diagnose.sources.bindings import Import
from ros2lab.diagnose.sources.interfaces import importable_names, is_installed, is_module
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, read_source
from ros2lab.diagnose.sources.spelling import snake_case

# What Python says when a module lacks a name, or has nothing inside because it is no package.
_LACKS = (
    re.compile(r"module '(?P<module>[\w.]+)' has no attribute '(?P<name>\w+)'"),
    re.compile(
        r"cannot import name '(?P<name>\w+)' from (?:partially initialized module )?'(?P<module>[\w.]+)'"
    ),
    re.compile(r"No module named '(?P<module>\w+)\.(?P<name>\w+)(?:\.\w+)*'"),
)
_PATH = re.compile(r"[('\"]((?:/|\w:)[^()'\"]+\.pyc?)\b")
_RUN_BY_FILE = re.compile(r"\bpython[\d.]* (?:-\w+ )*(?P<file>[^\s-]\S*\.py)\b")


def of_shadow(error: ErrorText, look: Look) -> Finding | None:
    """Say which file hides a module of a library; None if the module lacks what the error names even so.

    A name that is missing from a module which does have it shows that another module was imported, whoever asks for
    the name: the student's line or one of a library.
    """
    for report in reversed(error.reports):
        module, name = module_and_name(report)
        for finding in hidden_files(look.packages):
            if {module, name} <= {*finding.about}:
                return finding
        if not module or name not in _known(module, look):
            continue
        is_inner = is_module(f"{module}.{name}")  # the file may only have to import it
        folders = [*dict.fromkeys(_beside(report, look))]
        own = _own_files(module, look)
        for folder in folders[:1] if is_inner and report.kind == "AttributeError" else folders:
            for file in (folder / f"{module}.py", folder / module / "__init__.py"):
                if file.is_file() and file not in own and name not in _names_of(file, module):
                    return _hidden(module, file, error, look)
        if not is_inner and module in sys.stdlib_module_names:
            return _unseen(module, name, report, look)
    return None


def module_and_name(report: ErrorReport) -> tuple[str, str]:
    """Return the module that lacks something, and what it lacks; empty if an error says neither."""
    match = next((found for pattern in _LACKS if (found := pattern.search(report.message))), None)
    return (match["module"], match["name"]) if match else ("", "")


def _known(module: str, look: Look) -> frozenset[str]:
    """Return the names of a module of the workspace, of a library or of Python; empty if there is none."""
    found = importable_names(module) if module in sys.stdlib_module_names else None
    for package in look.packages if found is None else ():
        inner = (name.split(".")[1:2] for name in package.sources if name.startswith(f"{module}."))
        if module in package.sources:
            return frozenset(bound_names(package.sources[module])).union(*inner)
    return found or importable_names(module) or frozenset()


def _own_files(module: str, look: Look) -> list[Path | None]:
    """Return the files of the workspace that are the module itself; none for one of Python."""
    packages = look.packages if module not in sys.stdlib_module_names else ()
    return [package.sources[module].path for package in packages if module in package.sources]


def _names_of(file: Path, module: str) -> frozenset[str]:
    """Return the names that a file binds, other than by imports from a module of its own name."""
    source = read_source(file, module, file.name)
    return global_names(source) - {i.local for i in source.imports if i.target.startswith(f"{module}.")}


def _beside(report: ErrorReport, look: Look) -> Iterator[Path]:
    """Yield the folders in which Python may have found a module of the student, the likeliest first."""
    named = [Frame(path, 1) for path in _PATH.findall(report.message)]
    for frame in (*own_frames(named), *reversed(own_frames(report.frames))):
        shown = place_of([frame], look).rpartition(":")[0]
        path = look.root / shown
        yield path.parent.parent if path.name == "__init__.py" else path.parent
    if look:
        yield look.root
        for package in look.packages:
            yield package.folder
            yield package.folder / package.name


def _hidden(module: str, file: Path, error: ErrorText, look: Look) -> Finding:
    """Return the finding of a file that hides a module, with its other name and where else that must stand."""
    shown = shown_path(file, look.root).removesuffix("/__init__.py")
    what = "folder" if file.name == "__init__.py" else "file"
    of_python, of_package = module in sys.stdlib_module_names, any(_own_files(module, look))
    hidden = (
        f"Python's own {module}" if of_python else f"the {'package' if of_package else 'library'} {module}"
    )
    cause = f"The module {module} that Python imports here is your own {what} {shown}, so {hidden} is hidden."
    new = _other_name(module, file)
    fix = f"rename {shown.rpartition('/')[2]} to {new}{'.py' if what == 'file' else ''}"
    named, package, whole = _named(module, file, look)
    if package and file == package.folder / module / "__init__.py":
        fix = f"give the package another name, such as {new}: the folders {module}, the file resource/{module}, and {module} in package.xml, setup.py, setup.cfg and all imports; then `rm -r build/{module} install/{module}` and build again"
        return Finding("name-shadowed", cause, shown, fix, (module,))
    if named:
        written = f"{whole.removesuffix(module)}{new} instead of {whole}"
        fix += f", and write {written} in {' and '.join(named)}"
    if named and package:
        fix += f", then build again: `colcon build --packages-select {package.name}`"
    if started := _as_executable(error, look):
        fix += f"; or start it with `{started}`, where this {what} hides nothing"
    return Finding("name-shadowed", cause, shown, fix, (module,))


def _other_name(module: str, file: Path) -> str:
    """Return a free name for a file: that of its class if it has only one, else its own with `own_` before it."""
    classes = [*map(snake_case, read_source(file, module, file.name).classes)]
    is_free = len(classes) == 1 and classes[0] != module and not importable_names(classes[0])
    is_free = is_free and not file.with_name(f"{classes[0]}.py").exists() and file.name != "__init__.py"
    return classes[0] if is_free else f"own_{module}"


def _named(module: str, file: Path, look: Look) -> tuple[list[str], SourcePackage | None, str]:
    """Return where the workspace names a module, the package that has it, and under which name all these have it."""
    known = None if any(_own_files(module, look)) else _known(module, look)
    for package in look.packages:
        own = next((name for name, source in package.sources.items() if source.path == file), None)
        if own is None:
            continue
        lines = [
            (source, imported.line)
            for other in look.packages
            for source in other.sources.values()
            for imported in source.imports
            if f"{imported.target}.".startswith(f"{own}.") or _means(imported, module, known, source, file)
        ]
        for number, line in enumerate(package.setup.source.text.splitlines() if package.setup else (), 1):
            lines += [(package.setup.source, number)] if package.setup and f"{own}:" in line else []
        are_whole = all(own in source.text.splitlines()[line - 1] for source, line in lines)
        places = [*dict.fromkeys(source.at(line) for source, line in lines)]
        return places, package, own if are_whole else module
    return [], None, module


def _means(
    imported: Import, module: str, known: Collection[str] | None, source: PythonSource, file: Path
) -> bool:
    """Return whether `from queue import Waiting` beside the file asks for a name that only the file has."""
    first, name = [*imported.target.split("."), ""][:2]
    is_beside = source.path is not None and source.path.parent == file.parent
    return known is not None and is_beside and first == module and bool(name) and name not in known


def _as_executable(error: ErrorText, look: Look) -> str:
    """Return the `ros2 run` of a file that was started with python3; empty if it has no entry point."""
    typed = [match["file"] for line in error.typed if (match := _RUN_BY_FILE.search(line))]
    for package in look.packages if typed else ():
        for point in package.points:
            source = package.sources.get(point.module)
            if source and source.path and source.path.name == Path(typed[-1]).name and point.name:
                return f"ros2 run {package.name} {point.name}"
    return ""


def _unseen(module: str, name: str, report: ErrorReport, look: Look) -> Finding:
    """Return the finding of a module of Python that is hidden by a file which cannot be seen from here."""
    place = place_of(own_frames(report.frames), look)
    cause = f"Python's own {module} has {name}, so another module was imported: a file {module}.py, or a folder {module}, is found before it."
    fix = f"`python3 -c 'import {module}; print({module}.__file__)'`, typed in the folder of the file that you start, shows it; rename it, and what imports it"
    return Finding("name-shadowed", cause, place, fix, (module,))


def of_namesake(error: ErrorText, look: Look) -> Finding | None:
    """Say whose module Python imported instead of the one that the line means; None unless both are known.

    What the line asks for is in a module of its own package, and that module is installed; another package, or a
    library, has a module of the same name without it.
    """
    for report in reversed(error.reports) if look else ():
        whole, name = module_and_name(report)
        module = whole.partition(".")[0]
        asking = _package_of(report, look)
        if not module or asking is None or module == asking.name:
            continue
        if not _has(asking.folder, whole, name) or not _is_installed_with(asking, whole, name, look):
            continue
        others = [other for other in look.packages if other is not asking and _is_in(other.folder, module)]
        others.sort(key=lambda other: f"/{other.name}/" not in report.message)
        if lacking := [other for other in others if not _has(other.folder, whole, name)]:
            first = lacking[0].name
            names = in_a_row(sorted([asking.name, *(other.name for other in others)]))
            cause = f"{names} each install a Python module called {module}, and Python finds that of {first} first, which has no {name}."
            also = [other.name for other in others if other.name != first]
        elif not others and (is_installed(module) or "/install/" not in report.message):
            cause = f"A library of Python is called {module}, too, and Python finds it before the module {module} of {asking.name}."
            also = []
        else:
            continue
        places = [*_imports(asking, module)]
        own = [place_of([frame], look) for frame in own_frames(report.frames)]
        place = next((shown for shown in reversed(own) if shown in places), places[0] if places else "")
        return Finding("name-shadowed", cause, place, _moved(asking, module, also), (module,))
    return None


def _package_of(report: ErrorReport, look: Look) -> SourcePackage | None:
    """Return the package of the last own line of a traceback."""
    for frame in reversed(own_frames(report.frames)):
        shown = place_of([frame], look).rpartition(":")[0]
        for package in look.packages:
            if shown in {source.shown for source in package.sources.values()}:
                return package
    return None


def _file(folder: Path, module: str) -> Path | None:
    """Return the file of a module in a folder; None if there is none."""
    path = folder.joinpath(*module.split("."))
    files = (path.with_name(f"{path.name}.py"), path / "__init__.py")
    return next((file for file in files if file.is_file()), None)


def _is_in(folder: Path, module: str) -> bool:
    return _file(folder, module) is not None


def _has(folder: Path, module: str, name: str) -> bool:
    """Return whether a module in a folder binds a name, or has a module of that name in it."""
    file = _file(folder, module)
    if file is None:
        return False
    inner = file.parent if file.name == "__init__.py" else None
    return name in global_names(read_source(file, module, file.name)) or bool(
        inner and ((inner / f"{name}.py").is_file() or (inner / name).is_dir())
    )


def _is_installed_with(package: SourcePackage, module: str, name: str, look: Look) -> bool:
    """Return whether the installed copy of a module has a name, so that building again would change nothing."""
    prefixes = (look.root / "install" / package.name, look.root / "install")
    folders = (folder for prefix in prefixes for folder in site_packages(prefix))
    return any(_has(folder, module, name) for folder in (*folders, look.root / "build" / package.name))


def _imports(package: SourcePackage, module: str) -> Mapping[str, str]:
    """Return the imports of a module in a package by their places, as they must be once it is inside the package."""
    sources = package.sources.values()
    return {source.at(node): new for source in sources for node, new in _renamed(source, package, module)}


def _renamed(source: PythonSource, package: SourcePackage, module: str) -> Iterator[tuple[ast.stmt, str]]:
    """Yield the statements that import a module or what is in it, each with the one that imports it from its package."""
    for node in source.nodes:
        match node:
            case ast.ImportFrom(module=str(whole), level=0, names=names) if whole.partition(".")[0] == module:
                new = ast.ImportFrom(f"{package.name}.{whole}", names, 0)
            case ast.Import(names=[ast.alias(name=whole, asname=alias)]) if whole == module:
                new = ast.ImportFrom(package.name, [ast.alias(module, alias)], 0)
            case ast.Import(names=[ast.alias(name=whole, asname=str(alias))]) if whole.startswith(
                f"{module}."
            ):
                above, _, last = whole.rpartition(".")
                new = ast.ImportFrom(f"{package.name}.{above}", [ast.alias(last, alias)], 0)
            case _:
                continue
        yield node, ast.unparse(new)


def _moved(package: SourcePackage, module: str, also: list[str]) -> str:
    """Say how to move a module into its package, and what must be written otherwise then."""
    file = _file(package.folder, module)
    assert file is not None
    moved = file.name if file.name != "__init__.py" else module
    lines = [f"`{new}` in {place}" for place, new in _imports(package, module).items()]
    of_setup = ""
    if package.setup and package.setup.keywords.get("py_modules"):
        of_setup = f", remove '{module}' from py_modules in {package.shown('setup.py')}"
    elif package.setup and isinstance(package.setup.given("packages"), ast.List):
        of_setup = f", write '{package.name}.{module}' instead of '{module}' in packages of {package.shown('setup.py')}"
    again = f"; do the same in {in_a_row(also)}" if also else ""
    move = f"mv {package.shown(moved)} {package.shown(f'{package.name}/{moved}')}"
    return f"`{move}`, write {', '.join(lines)}{of_setup}, then colcon build --packages-select {package.name}{again}"
