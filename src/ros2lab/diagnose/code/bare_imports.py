"""Imports of a module of the same package without the package's name, where Python cannot find it so."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Collection, Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import Import, PythonSource, read_text


def bare_imports(package: SourcePackage, sources: NodeSources) -> Iterator[Finding]:
    """Yield imports without the package's name in the modules that the executables of a package import.

    Any other file may be run by hand, and then finds its neighbours.
    """
    own = sources.sources
    points = package.points
    waiting = (
        [] if _finds_more(package, sources) else [point.module for point in points if point.module in own]
    )
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
            target = whole or imported.target
            waiting += [name for name in (target, target.rpartition(".")[0]) if name in own]


def _finds_more(package: SourcePackage, sources: NodeSources) -> bool:
    """Return whether a package changes where Python looks for modules."""
    own = sources.sources.values()
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


def bare_sibling(source: PythonSource, imported: Import, own_modules: Collection[str]) -> str:
    """Return the full name of a sibling module that is imported without its package; empty if none is."""
    module = imported.target.rpartition(".")[0] if imported.is_from else imported.target
    package = source.name.rpartition(".")[0]
    whole, top = f"{package}.{module}", module.partition(".")[0]
    is_elsewhere = top in own_modules or top in sys.stdlib_module_names or interfaces.is_installed(top)
    return whole if module and package in own_modules and whole in own_modules and not is_elsewhere else ""


def bare_import(whole: str, name: str, place: str) -> Finding:
    """Say that a module of a package is imported without the package's name."""
    return Finding(
        "import-wrong",
        f"{name} is a module of the package {whole.removesuffix(f'.{name}')} and must be imported by its full name.",
        place,
        f"write {whole} instead of {name} there, and build again",
    )
