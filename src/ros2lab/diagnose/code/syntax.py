"""Files that Python cannot parse, explained by the changes of single lines that let Python read on."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence

from ros2lab.diagnose.code.line_edits import depth_of, in_words, level_of
from ros2lab.diagnose.code.merge_conflicts import conflict_in
from ros2lab.diagnose.code.repair import Repair
from ros2lab.diagnose.code.syntax_repairs import repairs_of
from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.sources.checker import Newer, newer_syntax
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.spelling import with_article

_SHOWN = 100  # characters of a line
_OF_ROS = (3, 12)  # the Python of ROS 2 Jazzy
_CODING = re.compile(r"\bcodec|\bencoding")  # in what Python says of a file that it cannot decode


def syntax_finding(code: str, source: PythonSource) -> Finding:
    """Explain why Python cannot read a file, by its `source.fault`."""
    fault = source.fault
    assert fault is not None
    return explained(
        code, f"Python cannot read {source.shown}", at(source.shown, fault.lineno), fault, source
    )


def explained(
    code: str, what: str, place: str, fault: SyntaxError, source: PythonSource | None = None
) -> Finding:
    """Explain a syntax error in a cause that begins with `what`; the source is None if only the error's text is known."""
    if conflict := conflict_in(source.text) if source else None:
        place = f"{place.rpartition(':')[0]}:{conflict.line}"
        return Finding(code, f"{what}: {conflict.why}.", place, conflict.told)
    repairs = repairs_of(source.text, fault) if source else []
    newer = newer_syntax(source.text) if source else None
    if source and newer and (newer.version <= _OF_ROS or not repairs):
        at_line = f"{place.rpartition(':')[0]}:{newer.line}"
        cause, fix = _of_later(what, newer, source, repairs)
        return Finding(code, cause, at_line, fix)
    if not repairs:
        return Finding(code, f"{what}: {_said(fault)}.", place, _fix(fault, source))
    first = repairs[0]
    cause = f"{what}: {first.why}."
    return Finding(code, cause, f"{place.rpartition(':')[0]}:{first.line}", _steps(repairs))


def _of_later(what: str, newer: Newer, source: PythonSource, repairs: Sequence[Repair]) -> tuple[str, str]:
    """Return cause and fix of what a later Python reads; where other quotes are enough, this one reads it, too."""
    here, later = (".".join(map(str, version)) for version in (sys.version_info[:2], newer.version))
    by = what.replace("Python", f"Python {here}, which runs here,", 1)
    said = re.sub("^Cannot", "it cannot", newer.what)
    cause = f"{by}: {said[:1].lower()}{said[1:]}. That is valid from Python {later} on."
    lines = source.text.split("\n")
    for repair in repairs:
        lines = repair.applied(lines)
    is_same = _without_quotes("\n".join(lines)) == _without_quotes(source.text)
    return cause, _steps(repairs) if repairs and is_same else f"write it without that, or use Python {later}"


def _without_quotes(text: str) -> str:
    return re.sub("['\"]", "", text)


def _steps(repairs: Sequence[Repair]) -> str:
    first, *more = repairs
    others = (_step(repair, "" if repair.is_move else f"on line {repair.line} ") for repair in more)
    return "; ".join((_step(first), *others))


def _step(repair: Repair, where: str = "") -> str:
    indent = repair.new[: depth_of(repair.new)]
    if repair.below:
        return f"indent lines {repair.line} to {repair.last} together, so that line {repair.line} begins with {in_words(indent)}"
    if repair.is_move:
        other = "space" if "\t" in indent else "tab"
        return f"begin line {repair.line} with {in_words(indent)} and no {other}"
    return (
        f"{where}write `{repair.new.strip()[:_SHOWN]}`" if repair.new.strip() else f"{where}remove the line"
    )


def _said(fault: SyntaxError) -> str:
    """Return Python's message about a syntax error in plain words."""
    said = fault.msg or "invalid syntax"
    if isinstance(fault, TabError):
        return "tabs and spaces are mixed in the indentation"
    if isinstance(fault, IndentationError):
        return f"the indentation is wrong ({said})"
    if _CODING.search(said):
        return f"it is not saved in the encoding in which Python reads it, UTF-8 if it declares no other ({said})"
    return said.removesuffix(".").removesuffix("?")


def _fix(fault: SyntaxError, source: PythonSource | None) -> str:
    """Say what to do about a syntax error for which no change of the line is known."""
    if isinstance(fault, IndentationError):
        level = level_of(source.text.splitlines()) if source else ""
        if level == "\t" and not isinstance(fault, TabError):
            return "indent what belongs to the line above by one tab more than that line"
        return "indent with four spaces everywhere, never with tabs"
    if _CODING.search(fault.msg or ""):
        return "save the file again with the encoding UTF-8, and declare no other in its first two lines"
    if "never closed" in (fault.msg or "") or "EOF" in (fault.msg or ""):
        return "close the bracket or the quote"
    if (fault.msg or "invalid syntax") == "invalid syntax":
        return (
            "look at this line and at the end of the one above for a missing comma, bracket, colon or quote"
        )
    return _fix_said(fault, source)


def _fix_said(fault: SyntaxError, source: PythonSource | None) -> str:
    """Say what to do about a syntax error that Python explains itself."""
    if twice := re.match(r"keyword argument repeated: (\w+)", fault.msg or ""):
        lines = enumerate(source.text.splitlines()[: fault.lineno or 1] if source else (), 1)
        given = [(n, sign) for n, line in lines for sign in re.findall(rf"\b{twice[1]}\s*=\s*(\S?)", line)]
        where = f" on line {given[-2][0]}" if given[1:] else ""
        if given and given[-1][1] in "[({":
            return f"move the contents of this one into the {twice[1]}{where}, and remove this one"
        return f"remove this one, or the {twice[1]}{where}"
    if outside := re.match(r"'(\w+)' outside (?:of )?(.+)", fault.msg or ""):
        return f"remove {outside[1]}, or put it inside {with_article(outside[2])}"
    return "fix this line as the message says"
