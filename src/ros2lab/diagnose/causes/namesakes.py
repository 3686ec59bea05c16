"""Modules of one name that several packages install: Python imports the first it finds, whoever asks."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from pathlib import Path

from ros2lab.diagnose.causes.shadowed import module_and_name
from ros2lab.diagnose.code.bound_names import global_names
from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.packaging.installed import site_packages
from ros2lab.diagnose.printed.error_text import ErrorReport, ErrorText, own_frames
from ros2lab.diagnose.printed.spots import place_of
from ros2lab.diagnose.sources.interfaces import is_installed
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, read_source


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
