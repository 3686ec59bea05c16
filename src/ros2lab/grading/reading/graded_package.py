"""The package of a submission, whose files are read with care, never run or imported."""

from __future__ import annotations

import ast
import contextlib
import itertools
import re
from collections.abc import Iterable, Iterator, Mapping
from configparser import RawConfigParser
from functools import cached_property
from pathlib import Path
from typing import Any

from ros2lab.diagnose.sources.file_texts import read_toml
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, read_text
from ros2lab.diagnose.sources.setup_script import SetupScript, packages_in
from ros2lab.grading.receiving.clean_copy import shown
from ros2lab.grading.receiving.submission import MOST_SOURCE


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

    Entities in package.xml, files outside its folder, and more Python than a person writes are not read.
    Settings in setup.cfg and pyproject.toml count as those of setup.py.
    """

    @property
    def notes(self) -> list[str]:
        """Sentences on what was not looked at."""
        unread = [shown(self.shown(str(path.relative_to(self.folder)))) for path in self._unread]
        if unread:
            others = f" and {len(unread) - 1} others" if len(unread) > 1 else ""
            return [
                f"Of the Python files the smallest were looked at, {MOST_SOURCE} bytes in all, and not {unread[0]}{others}."
            ]
        return []

    @cached_property
    def _unread(self) -> list[Path]:
        """Its largest Python files, which exceed what is parsed of a package."""
        sizes = sorted((path.lstat().st_size, path) for path in self.folder.rglob("*.py"))
        totals = itertools.accumulate(size for size, _ in sizes)
        return [path for (_, path), total in zip(sizes, totals, strict=True) if total > MOST_SOURCE]

    @cached_property
    def _parsed(self) -> tuple[Any, str | None, int | None]:
        if "<!ENTITY" in read_text(self.folder / "package.xml"):
            return None, "it defines entities, which no package.xml needs", None
        return super()._parsed

    def read(self, path: Path, name: str) -> PythonSource:
        """Return one of its Python files; one of those that exceed the limit counts as empty."""
        if path not in self._unread:
            return super().read(path, name)
        return PythonSource(name, self.shown(str(path.relative_to(self.folder))), "", False, path)

    @property
    def own_sources(self) -> list[PythonSource]:
        """Its modules; all of its Python files if setup.py leads to none that has code."""
        sources = [*self.sources.values()]
        if any(map(has_code, sources)):
            return sources
        return [self.read(path, path.stem) for path in written_modules(self.folder)]

    @property
    def package_dirs(self) -> Mapping[str, str]:
        """The entries of `package_dir` that do not lead out of the package."""
        return {name: where for name, where in super().package_dirs.items() if _is_inside(where)}

    @property
    def is_built_by_cmake(self) -> bool:
        """Never: its setup.py is graded for what it says, and its build type for itself."""
        return False

    @cached_property
    def setup(self) -> SetupScript | None:
        """Its setup.py, with arguments from setup.cfg and pyproject.toml if it does not have them itself."""
        script = super().setup
        if script is not None and script.call:
            for name, value in self._configured():
                if not script.keywords.get(name):
                    script.keywords[name] = value
        return script

    def _configured(self) -> Iterator[tuple[str, Any]]:
        """Yield the settings of setup.cfg and pyproject.toml by the names of setup()'s arguments."""
        if self.setup_cfg is not None:
            yield from self._in_cfg(self.setup_cfg)
        toml = read_toml(read_text(self.folder / "pyproject.toml"))
        packages = _inner(toml, "tool", "setuptools", "packages")
        if isinstance(packages, list):
            yield "packages", packages
        elif isinstance(packages, dict):
            where = _inner(packages, "find", "where")
            folders = where if isinstance(where, list) else ["."]
            inside = [self.folder / folder for folder in folders if _is_inside(folder)]
            yield "packages", [name for folder in inside for name in packages_in(folder)]
        project = toml.get("project")
        if isinstance(project, dict):
            yield from ((key, project[key]) for key in ("name", "description") if key in project)
            scripts = project.get("scripts")
            if isinstance(scripts, dict):
                points = [f"{key} = {text}" for key, text in scripts.items()]
                yield "entry_points", {"console_scripts": points}

    def _in_cfg(self, config: RawConfigParser) -> Iterator[tuple[str, Any]]:
        for key in ("name", "description", "license"):
            if config.has_option("metadata", key):
                yield key, config.get("metadata", key)
        if config.has_section("options.entry_points"):
            items = config.items("options.entry_points")
            yield "entry_points", {key: _lines(text) for key, text in items}
        if config.has_section("options.data_files"):
            items = config.items("options.data_files")
            yield "data_files", [(key, self._globbed(_lines(text))) for key, text in items]
        directories = _lines(config.get("options", "package_dir", fallback=""))
        if directories:
            pairs = [line.partition("=") for line in directories]
            yield "package_dir", {name.strip(): where.strip() for name, _, where in pairs}
        packages = config.get("options", "packages", fallback="").strip()
        if packages in ("find:", "find_namespace:"):
            where = config.get("options.packages.find", "where", fallback=".").strip()
            yield "packages", packages_in(self.folder / where) if _is_inside(where) else []
        elif packages:
            yield "packages", _lines(packages.replace(",", "\n"))

    def _globbed(self, patterns: Iterable[str]) -> list[str]:
        found: list[str] = []
        for pattern in patterns:
            is_looked_for = "*" in pattern and _is_inside(pattern)
            paths: list[Path] = []
            if is_looked_for:
                with contextlib.suppress(ValueError):  # not a valid pattern
                    paths = sorted(self.folder.glob(pattern))
            found += [str(path.relative_to(self.folder)) for path in paths] or [pattern]
        return found


def _is_inside(path: object) -> bool:
    return isinstance(path, str) and not path.startswith("/") and ".." not in path


def _lines(text: str) -> list[str]:
    return [line.strip() for line in text.splitlines() if line.strip()]


def _inner(table: Mapping[str, Any], *names: str) -> Any:
    """Return the value in nested tables that a sequence of names leads to; None if it is not there."""
    value: Any = table
    for name in names:
        value = value.get(name) if isinstance(value, dict) else None
    return value


def has_code(source: PythonSource) -> bool:
    """Return whether a module has a class or a function."""
    return any(
        isinstance(node, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)) for node in source.nodes
    )
