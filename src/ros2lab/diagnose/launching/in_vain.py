"""What a launch file sets or passes on, and nothing it starts gets."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ros2lab.diagnose.finding import Finding, at, in_a_row, line_with
from ros2lab.diagnose.launching.launch_arguments import all_named
from ros2lab.diagnose.launching.launch_file import entities_below, entities_in
from ros2lab.diagnose.launching.launch_kinds import READING
from ros2lab.diagnose.sources.python_source import read_source, read_text
from ros2lab.diagnose.sources.spelling import nearest, nothing_like


def set_late(
    path: Path, shown: str, late: Sequence[Mapping[str, Any]], files: Sequence[Path]
) -> Iterator[Finding]:
    """Yield actions that set something for the programs that are started after them, where none is."""
    text = read_text(path)
    is_included = any(path.name in read_text(other) for other in files if other != path)
    for found in late:
        if is_included and not found["is_group"]:
            continue  # what includes it may start more
        kind, line = _as_written(text, found["kind"]), found["line"]
        first = found["first"]["executable"] or "the first program"
        where = f" (line {found['first']['line']})" if found["first"]["line"] else ""
        whole = "its group" if found["is_group"] else "the launch description"
        cause = (
            f"{kind} acts only on what launch starts after it, and nothing is started after it in {whole}."
        )
        fix = f"put it before {first}{where} in {whole}, and build again"
        yield Finding("launch-lost", cause, at(shown, line or line_with(text, kind)), fix)


def _as_written(text: str, kind: str) -> str:
    """Return the name of an action's class as a file has it, which may be another name of the same class, or a tag."""
    letters = r"[-_]?".join(map(re.escape, kind))
    found = re.search(rf"\b{letters}\b", text, re.IGNORECASE)
    return found[0] if found else kind


def unknown_arguments(path: Path, shown: str, lost: Sequence[Mapping[str, Any]]) -> Iterator[Finding]:
    """Yield the arguments that a launch file gives one that it includes, and that this one neither has nor reads."""
    text = read_text(path)
    for found in lost:
        name, free, other = found["name"], found["free"], Path(found["path"])
        if _may_read(other, name):
            continue
        alike = [one for one in free if {*name.split("_")} & {*one.split("_")}]
        meant = nearest(name, free) or (alike[0] if len(alike) == 1 else "")
        has = in_a_row(free)
        cause = f"{other.name} has no argument {name}, so {name} is ignored; {other.name} has {has}."
        fix = f"write {meant!r} instead of {name!r}" if meant else nothing_like(name, other.name, is_own=True)
        place = _line_from(text, found["line"], name)
        yield Finding("launch-unused", cause, at(shown, place), f"{fix}, and build again")


def _may_read(path: Path, name: str) -> bool:
    """Return whether a launch file may read a launch argument, or hand it on to a file that it includes."""
    text, word = read_text(path), re.escape(name)
    if re.search(r"IncludeLaunchDescription\s*\(|<include\b|\binclude:", text):
        return True
    if path.suffix != ".py":
        return re.search(rf"\$\(var\s+['\"]?{word}\b", text) is not None
    read = all_named(read_source(path, path.stem, path.name), *READING)
    is_asked = "launch_configurations" in text and re.search(rf"['\"]{word}['\"]", text)
    return read is None or name in read or bool(is_asked)


def fixed(path: Path, shown: str) -> Iterator[Finding]:
    """Yield the arguments of a file in XML or YAML that nothing reads, where their default or mere text stands for them."""
    text, rows = read_text(path), [*entities_below("", entities_in(path), set())]
    for name, default in ((str(e.get("name")), e.get("default")) for kind, e in rows if kind == "arg"):
        others = [e for kind, e in rows if kind != "arg"]
        as_text = re.compile(
            rf"\$?[({{]? *(?:var|arg) +{re.escape(name)}\b *[)}}]?|\$\{{?{re.escape(name)}\b\}}?"
        )
        texts = (as_text.search(value) for e in others for value in e.values() if isinstance(value, str))
        only = next((found[0] for found in texts if found), "")
        has = any(default in (e.get(name), e.get("value") if e.get("name") == name else None) for e in others)
        is_read = re.search(rf"\$\([^)]*\b{re.escape(name)}\b", text) or "include" in dict(rows)
        if (only or (has and default)) and not is_read:
            line = max(n for n, line in enumerate(text.splitlines(), 1) if (only or name) in line)
            is_what = f"{only} is mere text" if only else f"a fixed {default} stands"
            cause = f"The launch argument {name} is declared but never used: {is_what} here in its place."
            fix = f'write "$(var {name})" instead of {only or default}, and build again'
            yield Finding("launch-unused", cause, at(shown, line), fix)


def never_begun(shown: str, waiting: Sequence[Mapping[str, Any]], told: Collection[str]) -> Iterator[Finding]:
    """Yield the event handlers that wait for an action which launch never begins; none of those told of already."""
    for found in waiting:
        kind, what, alike = found["kind"], found["waits_for"], found["alike"]
        if at(shown, found["made"]) in told:
            continue
        cause = f"{kind} waits for {what}, which launch is never given, so what is to follow never begins."
        if alike:
            cause = f"{kind} waits for another {what} than the one that launch is given: each call makes a new one, so what is to follow never begins."
        fix = "put what it waits for into the launch description, too"
        if alike:
            fix = f"make it once: keep it in a variable, and give that variable both to LaunchDescription and to {kind}"
        yield Finding("launch-lost", cause, at(shown, found["line"]), f"{fix}; then build again", (what,))


def shared(path: Path, shown: str, rows: Sequence[Mapping[str, Any]]) -> Iterator[Finding]:
    """Yield the included files that get what an earlier one has set."""
    text, group = read_text(path), "<group>" if path.suffix == ".xml" else "a group"
    group = "GroupAction([...])" if path.suffix == ".py" else group
    for found in rows:
        (first, file), name = found["files"], found["name"]
        line = found["line"] or line_with(text, file)
        cause = f"{file} does not get its default {found['alone']!r} for {name}: {first}, which is included before it, sets {name} to {found['value']!r}, and included files share what they set."
        fix = f"put each include into {group} of its own, or give this one {name}={found['alone']!r} as an argument"
        if name == "ros_namespace":  # where launch keeps it
            cause = f"{file} starts its programs in {found['value']}: {first}, which is included before it, leaves its namespace behind, as included files share what they set."
            fix = f"put each include into {group} of its own"
        yield Finding("launch-unused", cause, at(shown, line), f"{fix}; then build again", (name,))


def _line_from(text: str, first: int | None, name: str) -> int | None:
    """Return the line where a name is quoted, from a line on; that line if it is quoted nowhere below."""
    lines = text.splitlines()
    quoted = re.compile(rf"['\"]{re.escape(name)}['\"]|\bname: *{re.escape(name)}\b")
    numbers = (number for number, line in enumerate(lines, 1) if quoted.search(line))
    return next((number for number in numbers if number >= (first or 1)), first)
