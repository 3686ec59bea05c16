"""Runs the type checker on files, and on copies of them in which a call is rewritten."""

from __future__ import annotations

import ast
import os
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ros2lab.diagnose.checking.edits import Edit
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.checker import type_checker_says
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.signatures import fields_as_parameters, message_of
from ros2lab.scratch import scratch_folder

_ROW = re.compile(r"^(?P<file>.+?):(?P<line>\d+):(?P<column>\d+): \w+\[(?P<rule>[\w-]+)\] (?P<said>.*)$")
# The rules that are used, with patterns for their messages.
RULES = {
    "unresolved-reference": r"Name `(?P<name>\w+)` used when (?P<owner>)not defined",
    "missing-attribute": r"(?:Object of type|Module|Class) `(?P<owner>.+)` has no (?:attribute|member) `(?P<name>\w+)`"
    r"|Unresolved attribute `(?P<field>\w+)` on type `(?P<message>[A-Z]\w*)`",
    "missing-union-attribute": r"Attribute `(?P<name>\w+)` is not defined on `(?P<owner>None)` in (?P<both>union)",
    "missing-argument": r"required parameters? (?P<name>.+?) of (?:.*? )?`(?P<owner>[\w.]+)`",
    "too-many-positional-arguments": r"to (?P<what>.*?) ?`(?P<owner>[\w.]+)`: expected (?P<takes>\d+), got (?P<got>\d+)",
    "unknown-argument": r"Argument `(?P<name>\w+)` .* of (?:.*? )?`(?P<owner>[\w.]+)`",
    "not-callable": r"Object of type `(?P<owner>[^~].*)` is not callable",
    "unsupported-operator": r"Operator `(?P<name>.+?)` .*type `(?P<owner>.+?)`(?: and `(?P<given>.+)`)?$",
    "invalid-exception-caught": r"Object has type `(?P<owner><class '(?P<name>\w+)'>)`",
    "invalid-argument-type": r"Argument to (?:.*? )?`(?P<owner>[\w.]+)` is incorrect: Expected `(?P<wanted>.+)`, "
    r"found `(?P<given>.+)`",
}


def said_of(
    files: list[str], homes: Iterable[str] = (), packages: Sequence[Path] = ()
) -> list[re.Match[str]]:
    """Return the messages of the type checker about some files: file, line, column, rule and text.

    Empty if it is not installed or fails.
    """
    if not files:
        return []
    with scratch_folder() as folder:
        # It finds no modules below a folder whose name is no identifier.
        linked = {f"package_{number}": str(package) for number, package in enumerate(packages)}
        for name, package in linked.items():
            (folder / name).symlink_to(package)
        seen = [_linked(path, linked) for path in files]
        said = type_checker_says(folder, _options(seen, homes))
    places = {alias.lstrip("/"): path.lstrip("/") for alias, path in zip(seen, files, strict=True)}
    said = re.sub(r"\bLiteralString\b", "str", said)  # a str all the same
    told = [row for line in said.splitlines() if (row := _ROW.match(line)) is not None]
    placed = [(places.get(row["file"].lstrip("/"), row["file"]), row) for row in told]
    rows = filter(None, (_ROW.match(f"{place}{row.string[row.end('file') :]}") for place, row in placed))
    # A misspelled keyword argument is reported as missing, too; the misspelling says more.
    return sorted(rows, key=lambda row: row["rule"] == "missing-argument")


def _linked(path: str, packages: Mapping[str, str]) -> str:
    """Return the path of a file below the link to its package; unchanged if it is in none."""
    inside = [name for name, package in packages.items() if Path(path).is_relative_to(package)]
    home = max(inside, key=lambda name: len(packages[name]), default="")
    return f"{home}/{Path(path).relative_to(packages[home])}" if home else path


def _options(files: Sequence[str], homes: Iterable[str]) -> list[str]:
    """Return the files and the folders with modules, as the type checker is given them."""
    # It runs in another folder, so relative paths are made absolute.
    search = [Path(home).absolute() for home in os.environ.get("PYTHONPATH", "").split(os.pathsep) if home]
    places = [*homes, *filter(Path.is_dir, search)]
    return ["--python", sys.prefix, *files, *(f"--extra-search-path={home}" for home in places)]


def stands_trial(source: PythonSource, call: ast.Call, written: str) -> bool:
    """Return whether the type checker accepts a rewritten call in a copy of its file."""
    return first_that_stands(source, call, [written]) == written


def first_that_stands(
    source: PythonSource,
    call: ast.expr,
    ways: Sequence[str],
    *,
    are_items_open: bool = False,
    settled: str = "",
) -> str:
    """Return the first form of an expression, such as a call, that the type checker accepts in a copy of the file; else empty.

    Args:
        source: the file.
        call: the expression in it.
        ways: the forms to try.
        are_items_open: whether a list may have items of other types than the annotation allows, which is often too
            narrow.
        settled: the only objection to the call that a form must remove; empty if it must remove all.
    """
    last = call.end_lineno or call.lineno
    texts = [Edit(call, written).with_imports(source, source.lines) for written in ways]
    now, *rows_of = checked(source, [source.text.encode(), *texts]) if texts else [[]]
    of_call = [row for row in now if call.lineno <= row.line <= last]
    left = {row.said for row in of_call if settled or row.rule not in RULES} - {settled}
    for written, rows in zip(ways, rows_of, strict=True):
        objections = [row for row in rows if row.line == call.lineno and row.said not in left]
        if are_items_open:
            objections = [row for row in objections if not _OF_ITEMS.search(row.said)]
        if not objections:
            return written
    return ""


_OF_ITEMS = re.compile(r"Expected `(?:\w+\.)*(?P<kind>\w+)\[.*`, found `(?P=kind)\[")


@dataclass(frozen=True)
class Row:
    """A message of the type checker: its line, rule and text."""

    line: int
    rule: str
    said: str


def checked(source: PythonSource, texts: Sequence[bytes]) -> list[list[Row]]:
    """Return the messages of the type checker about each copy of a file, in the order of the lines."""
    parts = source.name.count(".") + source.is_package
    # A test also imports from the folder above its own.
    home = [str(parent) for parent in [*source.path.parents][parts : parts + 2]] if source.path else []
    with scratch_folder() as folder:
        stubs = folder / "stubs"
        write_stubs(source.names.values(), stubs)
        found: dict[str, list[Row]] = {}
        for number, text in enumerate(texts):
            path = folder / f"copy_{number}.py"
            path.write_bytes(_with_whole_imports(source, text))
            found[str(path)] = []
        for row in said_of(list(found), [str(stubs), *home]):
            found[f"/{row['file'].lstrip('/')}"].append(Row(int(row["line"]), row["rule"], row["said"]))
    return [*found.values()]


def _with_whole_imports(source: PythonSource, text: bytes) -> bytes:
    """Return a copy of a file whose relative imports name their packages, because the copy lies in none."""
    home = source.name.split(".")[: None if source.is_package else -1]

    def whole(found: re.Match[bytes]) -> bytes:
        outer = ".".join(home[: len(home) + 1 - len(found[2])]).encode()
        return found[1] + (b".".join(filter(None, (outer, found[3]))) or found[2])

    return re.sub(rb"(?m)^([ \t]*from[ \t]+)(\.+)[ \t]*(?!import\b)(\w*)", whole, text)


_PLAIN = frozenset(("float", "int", "str", "bool", "list"))
# Other members of a package are not known here, so they may be anything.
_HEAD = "import typing\n\ndef __getattr__(name: str) -> typing.Any: ...\n"


def write_stubs(names: Iterable[str], folder: Path) -> None:
    """Write the stubs of those of some names that are messages, and of the messages in their fields, into a folder to search."""
    folder.mkdir(parents=True, exist_ok=True)
    modules: dict[str, list[str]] = {}
    for name in _held(names):
        modules.setdefault(name.rpartition(".")[0], []).append(_class(name))
    for module, classes in modules.items():
        path = folder.joinpath(*module.split("."))
        path.mkdir(parents=True, exist_ok=True)
        imported = {module_name.rpartition(".")[0] for module_name in modules} | set(modules)
        lines = [f"import {module_name}\n" for module_name in sorted(filter(None, imported))]
        path.joinpath("__init__.pyi").write_text("".join([*lines, _HEAD, *classes]))
        path.parent.joinpath("__init__.pyi").write_text(_HEAD)


def _held(names: Iterable[str]) -> Iterator[str]:
    """Yield messages and the messages in their fields, each once."""
    left, known = list(names), set[str]()
    while left:
        name = left.pop()
        if name not in known and ".msg." in name and interfaces.fields_of(name) is not None:
            known.add(name)
            yield name
            fields = interfaces.fields_of(name) or {}
            left += [held for field in fields_as_parameters(fields) if (held := message_of(field.type))]


def _class(name: str) -> str:
    """Return the stub of a message's class."""
    rows = [
        (field.name, _type(field.type)) for field in fields_as_parameters(interfaces.fields_of(name) or {})
    ]
    given = "".join(f", {field}: {kind} = ..." for field, kind in rows)
    # Properties, as in the real class: the class itself does not have their values.
    fields = "".join(
        f"    @property\n    def {field}(self) -> {kind}: ...\n"
        f"    @{field}.setter\n    def {field}(self, value: {kind}) -> None: ...\n"
        for field, kind in rows
    )
    made = f"    def __init__(self{', *' if given else ''}{given}) -> None: ...\n"
    known = "    @classmethod\n    def get_fields_and_field_types(cls) -> dict[str, str]: ...\n"
    return f"\nclass {name.rpartition('.')[2]}:\n{fields}{made}{known}"


def _type(kind: str) -> str:
    """Return how Python names the type of a field."""
    return message_of(kind) or (kind if kind in _PLAIN else "typing.Any")
