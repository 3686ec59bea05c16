"""Faults in a JSON file that a program reads: the file, its line, and what to write there."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.python_source import read_text

_LARGEST = 1_000_000  # characters
_WORDS = {"True": "true", "False": "false", "None": "null", "undefined": "null"}
_NOT_LOOKED_INTO = frozenset(("build", "install", "log", "node_modules"))


@dataclass(frozen=True)
class Repair:
    """A change to a text: the range to replace, the new text, and why."""

    start: int
    end: int
    new: str
    why: str

    def applied(self, text: str) -> str:
        """Return the text with the change."""
        return f"{text[: self.start]}{self.new}{text[self.end :]}"


def of_data_file(kind: str, message: str, look: Look | None) -> Finding | None:
    """Return what is wrong in a JSON file of the workspace; None if no file fails with this message.

    Args:
        kind: the exception's class.
        message: what json says.
        look: the workspace.
    """
    if look is None or kind != "JSONDecodeError":
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
    for repair in _repairs(text, fault.pos):
        after = repair.applied(text)
        later = _fault_of(after)
        # An error further on may be another fault.
        if later is None or later.pos > fault.pos + len(repair.new):
            line = text.count("\n", 0, repair.start) + 1
            cause = f"json cannot read {name}: {repair.why}."
            fix = f"write `{after.splitlines()[line - 1].strip()}`, and build again"
            return Finding("python-error", cause, f"{shown}:{line}", fix)
    cause = f"This program reads {name}, but json cannot parse it: {fault.msg} (column {fault.colno})."
    return Finding(
        "python-error",
        cause,
        f"{shown}:{fault.lineno}",
        "compare this line and the one before it with a correct file",
    )


def _repairs(text: str, at: int) -> Iterator[Repair]:
    """Yield repairs that may be meant where json stops reading a text."""
    before, here = len(text[:at].rstrip()), text[at : at + 1]
    last = text[before - 1 : before]
    if here == "," and re.match(r",\s*[}\]]", text[at:]):  # where newer Pythons stop
        yield Repair(at, at + 1, "", "there is a comma after the last element, which JSON does not allow")
    if last == "," and here in ("}", "]"):
        yield Repair(
            before - 1, before, "", "there is a comma after the last element, which JSON does not allow"
        )
    if comment := re.match(r"(?:#|//).*", text[at:]):
        yield Repair(at, at + comment.end(), "", "it contains a comment, which JSON does not allow")
    if quoted := re.match(r"'([^'\"\n]*)'", text[at:]):
        yield Repair(at, at + quoted.end(), f'"{quoted[1]}"', "JSON needs double quotes around a string")
    if word := re.match(r"[A-Za-z_]\w*", text[at:]):
        new = _WORDS.get(word[0], f'"{word[0]}"')
        why = f"JSON needs {new} instead of {word[0]}"
        yield Repair(at, at + word.end(), new, why)
    if number := re.match(r"[+]?(\d*)\.(\d+)|[+](\d+)", text[at:]):
        new = number[3] or f"{number[1] or 0}.{number[2]}"
        yield Repair(at, at + number.end(), new, f"JSON needs {new} instead of the number {number[0]}")
    if before and last not in ",:{[":
        yield Repair(before, before, ",", "a comma is missing between two elements")
        yield Repair(before, before, ":", "a colon is missing after a name")
