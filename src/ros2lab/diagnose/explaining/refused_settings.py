"""Parameter values that a node refuses because its own declaration asks for that: no error, but its answer."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.explaining.usage import plain_words
from ros2lab.diagnose.finding import SAID, Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.transcript import step_with, words_in
from ros2lab.diagnose.sources.package import SourcePackage

_REFUSED = re.compile(r"^Set(?:ting)? parameter (?:(?P<name>\S+) )?failed: (?P<reason>.+)")
_READ_ONLY = re.compile(r"read[-_ ]only", re.IGNORECASE)


def refused_setting(error: ErrorText, look: Look) -> Finding | None:
    """Say that a node refuses a value because of how it declares the parameter; None if it does not."""
    match = _REFUSED.match(error.decisive)
    if match is None:
        return None
    name, value = _set_by(error)
    name = match["name"] or name
    for package, place, is_limited in _declarations(name, look):
        if is_limited:
            reason = match["reason"].rstrip(".")
            cause = f"The node refuses the new value of {name}, as its declaration asks: {reason}"
            if _READ_ONLY.search(reason):
                start = f"--ros-args -p {name}:={value}" if value else "its parameter file"
                cause = f"The parameter {name} is read-only, as its declaration asks: it gets its value only when the node of {package.name} starts, by {start}"
            return Finding(SAID, f"{cause}.", place)
    return None


def _set_by(error: ErrorText) -> tuple[str, str]:
    """Return the parameter and the value in the command that was refused; empty if they are not known."""
    step = step_with(error.decisive, error.steps)
    words = words_in(step.command)
    plain = plain_words(words, 2) if words[:3] == ["ros2", "param", "set"] else []
    return (plain[1], plain[2]) if len(plain) > 2 else ("", "")


def _declarations(name: str, look: Look) -> Iterator[tuple[SourcePackage, str, bool]]:
    """Yield where a parameter is declared, and whether the declaration says more than its default."""
    for package in look.packages:
        sources = look.sources(package)
        for source in sources.sources.values():
            for node in source.nodes:
                match node:
                    case ast.Call(func=ast.Attribute(attr="declare_parameter"), args=[given, *more]):
                        if sources.value(source, given) == name:
                            words = {keyword.arg for keyword in node.keywords}
                            yield package, source.at(node), len(more) > 1 or "descriptor" in words
