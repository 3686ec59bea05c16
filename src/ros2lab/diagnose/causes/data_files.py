"""Faults in a JSON file that a program reads: the file, its line, and what to write there."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.python_source import read_text
from ros2lab.diagnose.sources.slips import ALL, USUAL, Slip, likeliest

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
