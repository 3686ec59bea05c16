"""Modules of the workspace that a launch file imports, although launch cannot find them there."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from pathlib import Path
from shlex import quote

from ros2lab.diagnose.code.listed_packages import not_built
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import read_text


def own_module(path: Path, name: str, packages: Sequence[SourcePackage]) -> tuple[str, str] | None:
    """Return why launch does not find a module that is in the workspace, and what to do; None if it is not there."""
    for package in packages:
        if found := not_built(package, name) or not_built(package, name.partition(".")[0]):
            return f"{found.cause[0].lower()}{found.cause[1:]}", found.fix
    home = next((package for package in packages if path.is_relative_to(package.folder)), None)
    top = name.partition(".")[0]
    beside = next((p for p in (path.parent / f"{top}.py", path.parent / top) if p.exists()), None)
    return _beside(path, beside, home) if home and beside else None


def _beside(path: Path, beside: Path, package: SourcePackage) -> tuple[str, str]:
    """Return why a module next to a launch file is not found, and where to put it."""
    shown = package.shown(beside.relative_to(package.folder).as_posix())
    cause = f"{shown} is next to it, but Python does not look for modules there."
    if not package.has(f"{package.name}/__init__.py"):
        line = "`sys.path.append(os.path.dirname(__file__))`"
        return cause, f"write {line} above the import, with `import os` and `import sys` at the top"
    new = quote(package.shown(f"{package.name}/{beside.name}"))
    lines = " and ".join(_imported_of(path, beside.stem, package.name))
    return cause, f"mv {quote(shown)} {new}, write {lines}, and build again"


def _imported_of(path: Path, top: str, package: str) -> Iterator[str]:
    """Yield the imports of a module in a file as they are written once it is in a package."""
    for node in ast.walk(ast.parse(read_text(path))):
        match node:
            case ast.ImportFrom(module=str() as module, names=names, level=0) if module.split(".")[0] == top:
                new = ast.unparse(ast.ImportFrom(f"{package}.{module}", names, 0))
            case ast.Import(names=[ast.alias(name=module, asname=alias)]) if module.split(".")[0] == top:
                new = f"import {package}.{module} as {alias}" if alias else f"from {package} import {top}"
            case _:
                continue
        yield f"`{new}` on line {node.lineno}"
