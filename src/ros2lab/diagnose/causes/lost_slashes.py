"""Paths that are put together from pieces without the slash between a folder and what is in it."""

from __future__ import annotations

import ast
import contextlib
import os
import re
from collections.abc import Iterator
from pathlib import Path

from ros2lab.diagnose.finding import Finding, at, line_with
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.sources.python_source import PythonSource, given_to, last_name, read_source, read_text

_PATH = re.compile(r"'(/[^'\n]+)'|(?<![\w.:/'])(/[^\s'\",:]+)")
_JOINS = frozenset(("join", "joinpath", "Path", "PathJoinSubstitution"))  # these write the slashes themselves


def of_lost_slash(error: ErrorText, look: Look) -> Finding | None:
    """Say where a slash is missing in a path that is not there, but would be with it; None if in none."""
    for path in dict.fromkeys(quoted or plain for quoted, plain in _PATH.findall(error.text)):
        for home, rest in _homes(path, look):
            cause = f"There is no {path}: the slash between the folder {Path(home).name} and {rest} is missing, because these pieces are put together as they are."
            fix = f"begin the second piece with a slash: /{rest}"
            place, written = max(_pieces(rest, look), key=lambda piece: len(piece[1]), default=("", ""))
            if written:
                fix = f"write {'/' + written!r} instead of {written!r}"
            return Finding("file-not-found", cause, place, fix)
    return None


def _homes(path: str, look: Look) -> Iterator[tuple[str, str]]:
    """Yield the folders, the longest names first, after which a slash makes a path right, each with what follows."""
    for package in sorted(look.packages, key=lambda package: -len(package.name)):
        before, found, rest = path.partition(f"/share/{package.name}")
        if found and rest and not rest.startswith("/") and package.has(rest):
            yield before + found, rest
    with contextlib.suppress(OSError):  # such as a name that is too long, or a folder of somebody else
        above = next((folder for folder in Path(path).parents if folder.is_dir()), Path("/"))
        following = path.removeprefix(str(above)).lstrip("/")
        names = sorted(os.listdir(above), key=len, reverse=True) if not Path(path).exists() else []  # noqa: PTH208
        for name in names:
            rest = following.removeprefix(name)
            if rest != following and rest and (above / name / rest).exists():
                yield str(above / name), rest


def _pieces(rest: str, look: Look) -> Iterator[tuple[str, str]]:
    """Yield the places of texts in the files of a workspace that begin what follows the folder, each with the text."""
    for package in look.packages:
        for path in dict.fromkeys(
            [*package.launch_files, *(s.path for s in package.sources.values() if s.path)]
        ):
            shown = package.shown(path.relative_to(package.folder).as_posix())
            if path.suffix == ".py":
                yield from _texts(rest, read_source(path, path.stem, shown))
            elif line := line_with(read_text(path), f"){rest}"):
                yield at(shown, line), rest


def _texts(rest: str, source: PythonSource) -> Iterator[tuple[str, str]]:
    joined = [call for call in source.calls if last_name(call.func) in _JOINS]
    given = [value for call in joined for value in given_to(call)]
    given += [value for row in given if isinstance(row, ast.List) for value in row.elts]
    for node in source.nodes:
        match node:
            case ast.Constant(value=str(text)) if text and rest.startswith(text) and node not in given:
                yield source.at(node), text
