"""Imports of the workspace's modules by less, or more, than their names: without the package, or with folders above it."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Collection, Iterator, Mapping

from ros2lab.diagnose.code.bound_names import MODULE_NAMES, global_names
from ros2lab.diagnose.code.wrong_imports import used_on
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.bindings import Import
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, read_text


def bare_imports(package: SourcePackage, sources: NodeSources) -> Iterator[Finding]:
    """Yield imports without the package's name in the modules that the executables of a package import.

    Any other file may be run by hand, and then finds its neighbours.
    """
    own = sources.sources
    points = package.points
    waiting = [] if finds_more(package) else [point.module for point in points if point.module in own]
    seen: set[str] = set()
    while waiting:
        source = own[waiting.pop()]
        if source.name in seen:
            continue
        seen.add(source.name)
        for imported in source.imports:
            whole = bare_sibling(source, imported, own)
            if whole and not imported.is_guarded:
                name = whole.removeprefix(f"{source.name.rpartition('.')[0]}.")
                yield bare_import(whole, name, source.at(imported.line))
            further = by_folders(source, imported.line, {**sources.beyond.modules, **own})
            if further and not imported.is_guarded:
                yield further
            target = whole or imported.target
            waiting += [name for name in (target, target.rpartition(".")[0]) if name in own]


def finds_more(package: SourcePackage) -> bool:
    """Return whether a package changes where Python looks for modules."""
    own = package.sources.values()
    used = {
        source.resolve(n) for source in own for n in source.nodes if isinstance(n, (ast.Name, ast.Attribute))
    }
    is_extended = bool(used & {"sys.path", "site.addsitedir"})
    # The executables lie in lib/, so Python looks for modules there first.
    texts = (
        [node.value for node in package.setup.source.nodes if isinstance(node, ast.Constant)]
        if package.setup
        else []
    )
    is_beside = any(isinstance(text, str) and re.match(r"/?lib(/|$)", text) for text in texts)
    return is_extended or is_beside or any("PYTHONPATH" in read_text(path) for path in package.launch_files)


def bare_sibling(source: PythonSource, imported: Import, own_modules: Mapping[str, PythonSource]) -> str:
    """Return the full name of a sibling module that is imported without its package; empty if none is."""
    module = imported.target.rpartition(".")[0] if imported.is_from else imported.target
    package = source.name.rpartition(".")[0]
    whole, top = f"{package}.{module}", module.partition(".")[0]
    is_elsewhere = top in own_modules or top in sys.stdlib_module_names or interfaces.is_installed(top)
    is_there = bool(module) and package in own_modules and whole in own_modules and not is_elsewhere
    return whole if is_there and is_meant(source, module, whole, own_modules) else ""


def is_meant(source: PythonSource, module: str, whole: str, own: Mapping[str, PythonSource]) -> bool:
    """Return whether a module of the workspace has all that a file uses of one called so; else a library is meant."""
    targets = [imported.target for imported in source.imports]
    used = (source.resolve(n) for n in source.nodes if isinstance(n, (ast.Name, ast.Attribute)))
    start = f"{module}."
    asked = {t.removeprefix(start).partition(".")[0] for t in (*targets, *used) if t and t.startswith(start)}
    known = global_names(own[whole]) | MODULE_NAMES | {"*"}
    return own[whole] is not source and all(n in known or f"{whole}.{n}" in own for n in asked)


def bare_import(whole: str, name: str, place: str) -> Finding:
    """Say that a module of a package is imported without the package's name."""
    cause = f"{name} is a module of the package {whole.removesuffix(f'.{name}')} and must be imported by its full name."
    return Finding("import-wrong", cause, place, f"write {whole} instead of {name} there, and build again")


def by_folders(source: PythonSource, line: int, modules: Mapping[str, PythonSource]) -> Finding | None:
    """Return the finding about an import that begins with folders above a package of the workspace; else None."""
    for node in source.nodes:
        if not isinstance(node, (ast.Import, ast.ImportFrom)) or not node.lineno <= line <= (
            node.end_lineno or 0
        ):
            continue
        if isinstance(node, ast.ImportFrom):
            asked = {node.module or "": [alias.name for alias in node.names]} if not node.level else {}
        else:
            asked = {alias.name: [] for alias in node.names}
        for written, names in asked.items():
            if name := _below_folders(written, names, modules):
                return _without_folders(source, node, written, name)
    return None


def _below_folders(written: str, names: Collection[str], modules: Mapping[str, PythonSource]) -> str:
    """Return the module of the workspace that the end of a name is; empty if there is none, or the name is right."""
    top = written.partition(".")[0]
    if written in modules or top in interfaces.PACKAGES or top in sys.stdlib_module_names:
        return ""
    parts = written.split(".")
    for name in (".".join(parts[n:]) for n in range(1, len(parts))):
        # A last part alone may have the name of a package by chance.
        inner = [name] if "." in name else [f"{name}.{each}" for each in names]
        if name in modules and any(each in modules for each in inner):
            return name
    return ""


def _without_folders(
    source: PythonSource, node: ast.Import | ast.ImportFrom, written: str, name: str
) -> Finding:
    """Say that an import names the folders above a package, and how it is written without them."""
    line = ast.unparse(node).replace(written, name, 1)
    places = " and ".join(map(str, used_on(source, written)))
    more = f", and {name} instead of {written} on line {places}" if places else ""
    package = name.partition(".")[0]
    cause = f"This import begins with folders above the package {package}: Python imports {name} from where {package} is installed, and finds no {written} there."
    return Finding("import-wrong", cause, source.at(node), f"write `{line}`{more}, and build again")
