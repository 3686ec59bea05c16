"""Data files that a program reads: faults in a JSON file, and keys that a file has under another name."""

from __future__ import annotations

import ast
import configparser
import contextlib
import csv
import io
import json
import re
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
from ros2lab.diagnose.sources.python_source import PythonSource, last_name, read_text
from ros2lab.diagnose.sources.slips import ALL, USUAL, Slip, likeliest
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


_LARGEST = 1_000_000  # characters
_WORDS = {"True": "true", "False": "false", "None": "null", "undefined": "null"}
_NOT_LOOKED_INTO = frozenset(("build", "install", "log", "node_modules"))


def of_data_file(kind: str, message: str, look: Look) -> Finding | None:
    """Return what is wrong in a JSON file of the workspace; None if no file fails with this message."""
    if kind != "JSONDecodeError":
        return None
    for package in look.packages:
        for path in sorted(package.folder.rglob("*.json")):
            if _NOT_LOOKED_INTO.isdisjoint(path.relative_to(package.folder).parts):
                text = read_text(path)
                fault = _fault_of(text)
                if fault is not None and str(fault) == message:
                    return _told(fault, text, package.shown(str(path.relative_to(package.folder))))
    return None


def _fault_of(text: str) -> json.JSONDecodeError | None:
    try:
        json.loads(text[:_LARGEST])
    except json.JSONDecodeError as fault:
        return fault
    except RecursionError:
        return None
    return None


def _told(fault: json.JSONDecodeError, text: str, shown: str) -> Finding:
    name = Path(shown).name
    slip = likeliest(text, _slips(text, fault.pos), _reach)
    if slip is not None:
        cause = f"json cannot read {name}: {slip.why}."
        return Finding("python-error", cause, f"{shown}:{slip.line}", f"{slip.told}, and build again")
    cause = f"This program reads {name}, but json cannot parse it: {fault.msg} (column {fault.colno})."
    fix = "compare this line and the one before it with a correct file"
    return Finding("python-error", cause, f"{shown}:{fault.lineno}", fix)


def _reach(text: str) -> float:
    """Return how far json reads a text: the less is left after the fault, the further."""
    fault = _fault_of(text)
    return _LARGEST - len(text) + fault.pos if fault else ALL


def _slips(text: str, at: int) -> Iterator[Slip]:
    """Yield what may be meant where json stops reading a text, the likeliest first."""
    for rank, (start, end, new, why) in enumerate(_changes(text, at)):
        changed = f"{text[:start]}{new}{text[end:]}"
        line = text.count("\n", 0, start) + 1
        told = f"write `{changed.splitlines()[line - 1].strip()}`"
        yield Slip(line, told, changed, USUAL + rank / 1000, why)


def _changes(text: str, at: int) -> Iterator[tuple[int, int, str, str]]:
    """Yield ranges of a text with what is to be there instead, and what was wrong."""
    before, here = len(text[:at].rstrip()), text[at : at + 1]
    last = text[before - 1 : before]
    ends_with_comma = "there is a comma after the last element, which JSON does not allow"
    if here == "," and re.match(r",\s*[}\]]", text[at:]):  # where newer Pythons stop
        yield at, at + 1, "", ends_with_comma
    if last == "," and here in ("}", "]"):
        yield before - 1, before, "", ends_with_comma
    if comment := re.match(r"(?:#|//).*", text[at:]):
        yield at, at + comment.end(), "", "it contains a comment, which JSON does not allow"
    if quoted := re.match(r"'([^'\"\n]*)'", text[at:]):
        yield at, at + quoted.end(), f'"{quoted[1]}"', "JSON needs double quotes around a string"
    if word := re.match(r"[A-Za-z_]\w*", text[at:]):
        new = _WORDS.get(word[0], f'"{word[0]}"')
        yield at, at + word.end(), new, f"JSON needs {new} instead of {word[0]}"
    if number := re.match(r"[+]?(\d*)\.(\d+)|[+](\d+)", text[at:]):
        new = number[3] or f"{number[1] or 0}.{number[2]}"
        yield at, at + number.end(), new, f"JSON needs {new} instead of the number {number[0]}"
    if before and last not in ",:{[":
        yield before, before, ",", "a comma is missing between two elements"
        yield before, before, ":", "a colon is missing after a name"
