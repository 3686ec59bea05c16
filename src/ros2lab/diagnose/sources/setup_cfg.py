"""Read setup.cfg as setuptools does: all of it, or nothing and why."""

from __future__ import annotations

import configparser
import difflib
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ros2lab.diagnose.sources.slips import ALL, SELDOM, USUAL, Lines, Slip, likeliest

_SHOWN = 60  # characters of a line
_ALIKE = 0.6  # of a line to the one that was meant


@dataclass(frozen=True)
class CfgFault:
    """Why setuptools cannot read a setup.cfg.

    Attributes:
        said: what is wrong, as the rest of a sentence that begins with the name of the file.
    """

    said: str
    line: int
    fix: str


def read_cfg(text: str) -> tuple[configparser.RawConfigParser, CfgFault | None]:
    """Return the contents of a setup.cfg and None, or, if it cannot be read, no contents and why."""
    parser = _empty()
    try:
        parser.read_string(text)
    except configparser.Error as error:
        # The parser is left half-filled: its values are not strings yet.
        return _empty(), _fault(error, text.splitlines())
    return parser, None


def cfg_repair(text: str, wanted: Mapping[str, tuple[str, str]]) -> Slip | None:
    """Return the change of one line after which a setup.cfg has an option and its value in each wanted section; None if none does."""

    def reach(changed: str) -> float:
        config, fault = read_cfg(changed)
        is_right = all(
            config.get(section, key, fallback="").strip() == value for section, (key, value) in wanted.items()
        )
        return ALL if fault is None and is_right else 0

    return likeliest(text, _slips(text, wanted), reach)


def _slips(text: str, wanted: Mapping[str, tuple[str, str]]) -> Iterator[Slip]:
    lines = Lines(text)
    rows = [row for section, (key, value) in wanted.items() for row in (f"[{section}]", f"{key}={value}")]
    for number, line in enumerate(lines.all, 1):
        for row in rows:
            if (alike := difflib.SequenceMatcher(None, line.strip(), row).ratio()) > _ALIKE:
                yield lines.written(number, row, cost=USUAL + 1 - alike)
            yield lines.added(number - 1, row, cost=SELDOM + (re.match(r"\[|$", line) is None))
    for row in rows:
        yield lines.added(len(text.rstrip().split("\n")), row)


def _empty() -> configparser.RawConfigParser:
    parser = configparser.RawConfigParser()
    parser.optionxform = str  # type: ignore[assignment, method-assign]  # setuptools tells capitals apart
    return parser


def _fault(error: configparser.Error, lines: list[str]) -> CfgFault:
    match error:
        case configparser.DuplicateOptionError(section=section, option=option, lineno=int(line)):
            return CfgFault(
                f"has {option} twice in [{section}]",
                line,
                f"keep one {option} in [{section}], with everything that belongs to it, and remove the other",
            )
        case configparser.DuplicateSectionError(section=section, lineno=int(line)):
            return CfgFault(
                f"has the section [{section}] twice",
                line,
                f"keep one [{section}], with each of its options once, and remove the other",
            )
        case configparser.MissingSectionHeaderError(lineno=line):
            fix = "write the section it belongs to above it, such as [install], or remove the line"
            return CfgFault(f"has {_quoted(lines, line)} above its first section", line, fix)
        case configparser.ParsingError(errors=[(line, _), *_]):
            fix = "write the line as name=value, or remove it"
            return CfgFault(
                f"has {_quoted(lines, line)}, which is neither a section nor an option", line, fix
            )
    return CfgFault("cannot be read", 1, "write each line as [section] or name=value")


def _quoted(lines: list[str], number: int) -> str:
    """Return a line in quotes for a message, shortened if it is long."""
    text = lines[number - 1].strip() if 0 < number <= len(lines) else ""
    text = text if len(text) <= _SHOWN else f"{text[: _SHOWN - 1]}…"
    return f"the line {text!r}"
