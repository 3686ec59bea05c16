"""What a type checker says of files, and of copies of them in which a call is written anew; nothing where there is none."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ros2lab.diagnose.checking.stubs import write_stubs
from ros2lab.diagnose.sources.calls import missing_imports
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.scratch import scratch_folder

_LONGEST = 60.0  # s, on a busy machine; a workspace takes a quarter of one
_ROW = re.compile(r"^(?P<file>.+?):(?P<line>\d+):(?P<column>\d+): \w+\[(?P<rule>[\w-]+)\] (?P<said>.*)$")
# Each rule that is asked, with the words in what it says.
RULES = {
    "unresolved-reference": r"Name `(?P<name>\w+)` used when (?P<owner>)not defined",
    "missing-attribute": r"(?:Object of type|Module|Class) `(?P<owner>.+)` has no (?:attribute|member) `(?P<name>\w+)`"
    r"|Unresolved attribute `(?P<field>\w+)` on type `(?P<message>[A-Z]\w*)`",
    "missing-union-attribute": r"Attribute `(?P<name>\w+)` is not defined on `(?P<owner>None)` in (?P<both>union)",
    "missing-argument": r"required parameters? (?P<name>.+?) of (?:.*? )?`(?P<owner>[\w.]+)`",
    "too-many-positional-arguments": r"to (?P<what>.*?) ?`(?P<owner>[\w.]+)`: expected (?P<takes>\d+), got (?P<got>\d+)",
    "unknown-argument": r"Argument `(?P<name>\w+)` .* of (?:.*? )?`(?P<owner>[\w.]+)`",
    "not-callable": r"Object of type `(?P<owner>.+)` is not callable",
    "unsupported-operator": r"Operator `(?P<name>.+?)` .*type `(?P<owner>.+?)`(?: and `(?P<given>.+)`)?$",
    "invalid-argument-type": r"Argument to (?:.*? )?`(?P<owner>[\w.]+)` is incorrect: Expected `(?P<wanted>.+)`, "
    r"found `(?P<given>.+)`",
}


def said_of(files: list[str], homes: Iterable[str] = ()) -> list[re.Match[str]]:
    """Return each objection of the type checker to some files, with its file, line, column, rule and words.

    Args:
        files: their paths.
        homes: folders in which more is found that they import.
    """
    checker = shutil.which(
        "ty", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    )
    if checker is None or not files:
        return []
    # It runs elsewhere, and what is said from here would be looked for there.
    search = [Path(part).absolute() for part in os.environ.get("PYTHONPATH", "").split(os.pathsep) if part]
    environ = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [checker, "check", "--python", sys.prefix, "--output-format", "concise", "--exit-zero", *files]
    for part in [*homes, *filter(Path.is_dir, search)]:
        command += ["--extra-search-path", str(part)]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=_LONGEST, check=False, cwd="/", env=environ
        )
    except (OSError, subprocess.SubprocessError):
        return []
    rows = [row for line in done.stdout.splitlines() if (row := _ROW.match(line)) is not None]
    # What is named wrongly is missing, too; the wrong name says more.
    return sorted(rows, key=lambda row: row["rule"] == "missing-argument")


def stands_trial(source: PythonSource, call: ast.Call, written: str) -> bool:
    """Return whether a type checker finds nothing in the lines of a call that is written anew in a copy of its file."""
    return first_that_stands(source, call, [written]) == written


def first_that_stands(
    source: PythonSource,
    call: ast.Call,
    ways: Sequence[str],
    *,
    are_items_open: bool = False,
    settled: str = "",
) -> str:
    """Return the first way to write a call in which a type checker finds nothing, each in a copy of the file; empty if none is.

    Args:
        source: the file.
        call: the call in it.
        ways: how it may be written.
        are_items_open: whether a list may hold other items than the library's annotation says, which is often narrower
            than what it takes.
        settled: which of the objections to the call is to go, so that the others may stay; empty if all are.
    """
    lines = source.text.encode().splitlines(keepends=True)
    last = call.end_lineno or call.lineno
    before, after = lines[call.lineno - 1][: call.col_offset], lines[last - 1][call.end_col_offset :]
    texts = []
    for written in ways:
        changed = [*lines[: call.lineno - 1], before + written.encode() + after, *lines[last:]]
        changed += [f"\n{line}".encode() for line in missing_imports(source, written)]
        texts.append(b"".join(changed))
    now, *rows_of = checked(source, [source.text.encode(), *texts]) if texts else [[]]
    left = {row.said for row in now if settled and call.lineno <= row.line <= last} - {settled}
    for written, rows in zip(ways, rows_of, strict=True):
        objections = [r for r in rows if r.rule in RULES and r.line == call.lineno and r.said not in left]
        if are_items_open:
            objections = [row for row in objections if not _OF_ITEMS.search(row.said)]
        if not objections:
            return written
    return ""


_OF_ITEMS = re.compile(r"Expected `(?:\w+\.)*(?P<kind>\w+)\[.*`, found `(?P=kind)\[")


@dataclass(frozen=True)
class Row:
    """What the type checker says of a line: by which rule, and in which words."""

    line: int
    rule: str
    said: str


def checked(source: PythonSource, texts: Sequence[bytes]) -> list[list[Row]]:
    """Return what the type checker says of each of some copies of a file, in the order of their lines.

    Args:
        source: the file, beside which the copies find what it imports.
        texts: what the copies say.
    """
    parts = source.name.count(".") + source.is_package
    # A test imports from the folder above its own.
    home = [str(one) for one in [*source.path.parents][parts : parts + 2]] if source.path else []
    with scratch_folder() as folder:
        stubs = folder / "stubs"
        write_stubs(source.names.values(), stubs)
        found: dict[str, list[Row]] = {}
        for number, text in enumerate(texts):
            path = folder / f"copy_{number}.py"
            path.write_bytes(text)
            found[str(path)] = []
        for row in said_of(list(found), [str(stubs), *home]):
            found[f"/{row['file'].lstrip('/')}"].append(Row(int(row["line"]), row["rule"], row["said"]))
    return [*found.values()]
