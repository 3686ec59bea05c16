"""Passes on the warnings of Python and its tools, with their hints and the lines that they are about."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ros2lab.diagnose.finding import SAID, Finding, these_lines
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import Frame, own_frames
from ros2lab.diagnose.printed.spots import Spot, place_of, spot_at
from ros2lab.diagnose.printed.transcript import WARNING
from ros2lab.diagnose.sources.python_source import Function

_TEST = re.compile(r"(?P<file>[\w./-]+\.py)::(?:(?P<owner>\w+)::)?(?P<name>\w+)")
_FROM = re.compile(r"'(?P<name>\w+)'.*\(from: (?P<file>\S+\.py)\)")
# The hint in a warning, as tools usually phrase one.
_SENTENCE = re.compile(
    r"(?:^|[.?!] +|[-;:,] )(?P<hint>(?:[Uu]se|Did you mean|[Yy]ou (?:can|should)|[Pp]lease|[Cc]onsider|[Tt]ry|[Rr]eplace)\b.+?)(?:[.?!](?= |$)| - |$)"
)
_QUOTED = r"(?:(?P<{0}q>[`'\"])(?P<{0}>.+?)(?P={0}q)|(?P<{0}2>[\w.]*\w))"
_INSTEAD = re.compile(f"use {_QUOTED.format('new')} instead of {_QUOTED.format('old')}", re.IGNORECASE)
_MEANT = re.compile(r"[\"'](?P<old>[^\"']+)[\"'].*Did you mean [\"'](?P<new>.+?)[\"']\?")
_SEE = re.compile(r"(?:\s*-\s*for details, )?[Ss]ee https?://\S+.*$|\(from: \S+\)")


@dataclass(frozen=True)
class _Warning:
    """A warning: the line that it comes from, and its whole text."""

    file: str
    line: int
    kind: str
    said: str


def of_warning(line: str, text: str, look: Look) -> Finding | None:
    """Pass on a warning with its place and its fix; None if the line is no warning."""
    head = WARNING.match(line)
    every = [*_warnings(text.splitlines())]
    same = [warning for warning in every if head and warning.kind == head["kind"]]
    first = next((w for w in same if head and w.said.startswith(head["message"].strip())), None)
    if first is None:
        return None
    places = [*dict.fromkeys(place for warning in same for place in _places(warning, look))]
    fix, place = _fix(first.said, places, look)
    cause = _SEE.sub("", first.said).strip().rstrip(".")
    return Finding(SAID, f"Python warns: {cause}{'' if cause[-1:] == '?' else '.'}", place, fix)


def _warnings(lines: Sequence[str]) -> Iterator[_Warning]:
    """Yield each warning, with its continuation lines."""
    for number, line in enumerate(lines):
        if head := WARNING.match(line):
            said = [head["message"].strip()]
            for more in lines[number + 1 : number + 6]:
                indent = more[: -len(more.lstrip()) or None] if more.strip() else None
                # The line of code that it is about is shown below, indented further.
                if indent != head["indent"] or WARNING.match(more) or not _is_said(more):
                    break
                said.append(more.strip())
            yield _Warning(head["file"], int(head["line"]), head["kind"], " ".join(said))


def _is_said(line: str) -> bool:
    """Return whether a line is a sentence, and not a rule, a prompt or the name of a test."""
    return re.match(r"\s*[A-Z`'\"].* .*[\w.?!`'\"]$", line) is not None and "::" not in line


def _places(warning: _Warning, look: Look) -> Iterator[str]:
    """Yield the student's lines that a warning is about: its own, or those of what it names."""
    frame = Frame(warning.file, warning.line)
    if own_frames([frame]):
        yield place_of([frame], look)
        return
    named = [*_TEST.finditer(warning.said), *_FROM.finditer(warning.said)]
    for match in named:
        file = place_of([Frame(match["file"], 1)], look)
        source = spot_at(file, look).source
        for node in source.nodes if source else ():
            if isinstance(node, (Function, ast.ClassDef)) and node.name == match["name"] and source:
                yield source.at(node)


def _fix(said: str, places: Sequence[str], look: Look) -> tuple[str, str]:
    """Return the fix that a warning hints at, and its place."""
    place = places[0] if places else ""
    if match := _INSTEAD.search(said) or _MEANT.search(said):
        groups = match.groupdict()
        old, new = (groups[key] or groups[f"{key}2"] for key in ("old", "new"))
        lines = [found for warned_place in places if (found := _line_with(old, spot_at(warned_place, look)))]
        if lines:
            first, text = lines[0]
            others = sorted(
                {int(place_and_text[0].rpartition(":")[2]) for place_and_text in lines[1:]}
                - {int(first.rpartition(":")[2])}
            )
            more = f"; and likewise on {these_lines(others)}" if others else ""
            return f"write `{_word(old).sub(lambda _: new, text, count=1)}`{more}", first
        return f"write {new} instead of {old}", place
    hint = _SENTENCE.search(_SEE.sub("", said))
    fix = hint["hint"].strip() if hint else ""
    return f"{fix[:1].lower()}{fix[1:]}", place


def _line_with(old: str, spot: Spot) -> tuple[str, str] | None:
    """Return the place and text of the first line of a statement or function with this word; else None."""
    source = spot.source
    if source is None:
        return None
    functions = [n for n in source.nodes if isinstance(n, Function) and n.lineno == spot.line]
    last = (functions[0].end_lineno or spot.line) if functions else spot.lines.stop - 1
    lines = source.text.splitlines()
    for number in range(spot.line, min(last, len(lines)) + 1):
        if _word(old).search(lines[number - 1]):
            return source.at(number), lines[number - 1].strip()
    return None


def _word(text: str) -> re.Pattern[str]:
    return re.compile(rf"(?<!\w){re.escape(text)}(?!\w)")
