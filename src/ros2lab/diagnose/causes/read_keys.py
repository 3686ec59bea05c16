"""Keys that a program looks up in data from a file, compared with the keys that the file has."""

from __future__ import annotations

import ast
import configparser
import contextlib
import csv
import io
import json
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Any

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.file_texts import LARGEST_FILE, bytes_of, read_toml
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, last_name
from ros2lab.diagnose.sources.spelling import nearest, nothing_like

_READERS = ("DictReader", "load", "safe_load", "loads", "read")
_DATA = frozenset((".csv", ".tsv", ".json", ".yaml", ".yml", ".toml", ".ini", ".cfg", ".txt"))
_MARK = "\ufeff"
_MOST_PARTS = 2000  # nodes of a file's tree that are visited; a few lines of YAML can stand for millions
_SEPARATORS = ";,\t|"


@dataclass(frozen=True)
class _Read:
    """A file that a program reads, the call that reads it, and its keys, each with those above it."""

    path: Path
    shown: str
    package: SourcePackage
    call: ast.Call
    keys: tuple[tuple[str, ...], ...]


def of_read_key(key: str, asked: ast.Subscript, spot: Spot, look: Look) -> Finding | None:
    """Return how a missing key is called in the file that a program reads; None if that is not seen."""
    source = spot.file
    if any(isinstance(value, ast.Dict) for value in spot.assigned(ast.unparse(asked.value))):
        return None
    read = [*_files_read(source, look)]
    for file in read:
        if told := _other_name(key, asked, spot, file) or _deeper(key, asked, spot, file):
            return told
        if key in {row[-1] for row in file.keys}:
            return _stale(file, key, look)
    if len(read) == 1 and read[0].keys:
        file = read[0]
        names = ", ".join(repr(row[-1]) for row in file.keys[:8])
        cause = (
            f"{file.shown}, from which {ast.unparse(asked.value)} comes, has no key {key!r}; it has {names}."
        )
        return Finding(
            "python-error", cause, source.at(spot.line), nothing_like(repr(key), file.shown, is_own=True)
        )
    return None


def _other_name(key: str, asked: ast.Subscript, spot: Spot, read: _Read) -> Finding | None:
    """Return a finding about a key that the file spells differently, or has in an unsplit column."""
    names = [*dict.fromkeys(row[-1] for row in read.keys)]
    if _MARK + key in names and key not in names:
        return _marked(key, spot.file, read)
    joined = [
        (name, sign)
        for name in (names if key not in names else ())
        for sign in _SEPARATORS
        if sign in name and key in [part.strip().lstrip(_MARK) for part in name.split(sign)]
    ]
    for whole, sign in joined:
        cause = f"{read.shown} separates its columns with {sign!r}, but is read as if it had only one column, {whole!r}."
        given = [keyword for keyword in read.call.keywords if keyword.arg == "delimiter"]
        call = ast.unparse(read.call)
        new = f"delimiter={sign!r}"
        better = call.replace(ast.unparse(given[0]), new) if given else f"{call[:-1]}, {new})"
        return Finding("python-error", cause, spot.file.at(read.call), f"write {better} instead of {call}")
    near = nearest(key, names) if key not in names else None
    if near is None:
        return None
    cause = f"{read.shown} has no key {key!r}; its key is {near!r}."
    text = ast.unparse(asked.slice)
    fix = f"write {near!r} instead of {text}" if isinstance(asked.slice, ast.Constant) else ""
    if near.strip() == key:
        cause = f"{read.shown} has no key {key!r}; with the spaces around it, the key is {near!r}."
    fix = fix or f"write {key} instead of {near} in {read.shown}"
    return Finding("python-error", cause, spot.file.at(spot.line), fix)


def _marked(key: str, source: PythonSource, read: _Read) -> Finding:
    cause = (
        f"{read.shown} begins with a byte order mark, which Excel adds, so its first key is {_MARK + key!r}."
    )
    for node in source.nodes:
        if isinstance(node, ast.Call) and last_name(node.func) in ("open", "read_text"):
            given = next((keyword for keyword in node.keywords if keyword.arg == "encoding"), None)
            text = ast.unparse(node)
            if given is not None:
                fix = f"write encoding='utf-8-sig' instead of {ast.unparse(given)}"
            else:
                fix = f"write {text[:-1]}{', ' * (text[-2] != '(')}encoding='utf-8-sig') instead of {text}"
            return Finding("python-error", cause, source.at(node), fix)
    return Finding(
        "python-error", cause, source.at(read.call), f"save {read.shown} without it, and build again"
    )


def _deeper(key: str, asked: ast.Subscript, spot: Spot, read: _Read) -> Finding | None:
    """Return a finding about a key that is below another key in the file; None if it is not."""
    if isinstance(asked.value, ast.Subscript) or any(row == (key,) for row in read.keys):
        return None
    below = [row for row in read.keys if row[-1] == key and len(row) > 1]
    if len(below) != 1 or not isinstance(asked.value, (ast.Name, ast.Attribute)):
        return None
    steps = "".join(f"[{step!r}]" for step in below[0])
    cause = f"In {read.shown}, {key!r} is below {below[0][-2]!r}."
    fix = f"write {ast.unparse(asked.value)}{steps} instead of {ast.unparse(asked)}"
    return Finding("python-error", cause, spot.file.at(spot.line), fix)


def _stale(read: _Read, key: str, look: Look) -> Finding | None:
    """Return a finding about an installed copy of a file that lacks a key; None if there is none."""
    install = look.root / "install" / read.package.name
    for path in sorted(install.rglob(read.path.name)):
        if path.is_symlink() or key in {row[-1] for row in _keys(path, read.call)}:
            continue
        cause = f"{read.shown} has the key {key!r}, but the installed copy that the program reads does not."
        fix = f"colcon build --packages-select {read.package.name}, and run the same command again"
        return Finding("install-stale", cause, read.shown, fix, (read.path.name,))
    return None


def _files_read(source: PythonSource, look: Look) -> Iterator[_Read]:
    """Yield the files of the packages that a program names and reads."""
    calls = [n for n in source.calls if last_name(n.func) in _READERS]
    names = {
        PurePath(n.value).name
        for n in source.nodes
        if isinstance(n, ast.Constant) and isinstance(n.value, str) and PurePath(n.value).suffix in _DATA
    }
    for package in look.packages if calls else ():
        for path in sorted(package.folder.rglob("*")):
            if path.name in names and path.is_file() and path.stat().st_size < LARGEST_FILE:
                shown = package.shown(path.relative_to(package.folder).as_posix())
                for call in calls:
                    if keys := _keys(path, call):
                        yield _Read(path, shown, package, call, keys)
                        break


def _keys(path: Path, call: ast.Call) -> tuple[tuple[str, ...], ...]:
    """Return the keys of a file as a call reads it; empty if it cannot be read that way."""
    with contextlib.suppress(OSError, ValueError, csv.Error, configparser.Error, RecursionError):
        text = bytes_of(path).decode("utf-8")
        if last_name(call.func) == "DictReader":
            given = {keyword.arg: keyword.value for keyword in call.keywords}
            sign = given.get("delimiter")
            delimiter = sign.value if isinstance(sign, ast.Constant) and isinstance(sign.value, str) else ","
            rows = csv.reader(io.StringIO(text), delimiter=delimiter)
            return tuple((name,) for name in next(rows, [])) if "fieldnames" not in given else ()
        return tuple(_below(_tree(path, text)))
    return ()


def _tree(path: Path, text: str) -> Any:
    text = text.removeprefix(_MARK)
    if path.suffix == ".json":
        return json.loads(text)
    if path.suffix in (".yaml", ".yml"):
        import yaml

        try:
            return yaml.safe_load(text)
        except yaml.YAMLError:
            return None
    if path.suffix == ".toml":
        return read_toml(text)
    parser = configparser.ConfigParser()
    parser.read_string(text)
    return {name: dict(parser[name]) for name in parser.sections()}


def _below(tree: Any) -> Iterator[tuple[str, ...]]:
    """Yield the keys in a tree of dictionaries and lists, each with those above it."""
    left = deque[tuple[tuple[str, ...], Any]]([((), tree)])
    for _ in range(_MOST_PARTS):
        if not left:
            return
        above, part = left.popleft()
        if isinstance(part, dict):
            inner = [((*above, key), value) for key, value in part.items() if isinstance(key, str)]
            yield from (path for path, _ in inner)
            left.extend(inner)
        elif isinstance(part, list):
            left.extend((above, value) for value in part[:_MOST_PARTS])
