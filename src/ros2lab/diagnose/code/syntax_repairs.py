"""Files that Python cannot parse, explained by the likeliest changes of single lines that let Python read on."""

from __future__ import annotations

import ast
import builtins
import math
import re
import sys
import warnings
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from ros2lab.diagnose.code.line_edits import (
    Repair,
    depth_of,
    edits_of,
    ends_of,
    in_words,
    is_code,
    is_definition,
    level_of,
    moves_of,
)
from ros2lab.diagnose.code.merge_conflicts import conflict_in
from ros2lab.diagnose.code.other_languages import in_pythons_words
from ros2lab.diagnose.code.sense import nonsense
from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.sources.checker import Newer, newer_syntax
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.spelling import with_article

_LONGEST = 500  # characters that a line may have for changes to be tried
_TRIED = (6, 3, 1, 1)  # changes that are tried for the first fault of a file, for the second, and so on
_MOST_READ = 100_000  # lines that are parsed in all, about half a second
_END = 10**9  # stands for the line of the error in a file that has none
_UNREAD = 100.0  # what a fault costs that stays
_NO_SENSE = 6.0  # what a repair costs that is worse than none
_MOST_BELOW = 40  # lines of a statement below the one that Python names
_SHOWN = 100  # characters of a line
_MOST_FAULTS = 5  # syntax errors to leave out of a file


def repairs_of(text: str, fault: SyntaxError) -> list[Repair]:
    """Return the changes that let Python read a text; if none do, the one that lets it read the function around a fault."""
    lines = text.splitlines()
    if max(map(len, lines), default=0) > _LONGEST or not fault.lineno or "codec" in (fault.msg or ""):
        return []
    cost, repairs = _cheapest(lines, _Reader(), _TRIED)
    if cost < _UNREAD or not repairs:
        return repairs
    reader = _Reader()
    part = _part(lines, min(reader.stops_at(lines), len(lines)), reader)
    return repairs[:1] if part and part.holds(repairs[0]) and part.is_mended_by(repairs[0], reader) else []


def mended(source: PythonSource) -> PythonSource:
    """Return a file with its slips of typing undone, and then with the lines left out that Python still cannot read."""
    if source.tree.body or source.fault is None:
        return source
    lines = source.text.split("\n")
    for repair in repairs_of(source.text, source.fault):
        lines = repair.applied(lines)
    return as_meant(replace(source, text="\n".join(lines)))


def _cheapest(lines: list[str], reader: _Reader, tried: Sequence[int]) -> tuple[float, list[Repair]]:
    """Return the changes that together mend a file at the least cost, and that; so many are tried at each step."""
    number = reader.stops_at(lines)
    if number == _END:
        return 0.0, []
    options = _options(lines, number, reader) if tried and number else []
    found = list[tuple[float, list[Repair]]]()
    for cost, repair in options[: tried[0] if tried else 0]:
        more, others = _cheapest(repair.applied(lines), reader, tried[1:])
        found.append((cost + more, [repair, *others]))
        if more == 0.0:  # it was the last fault: the others cost more
            break
    return min(found, key=lambda way: way[0], default=(_UNREAD, []))


class _Reader:
    """Parses texts, up to a total number of lines."""

    def __init__(self) -> None:
        self.left, self.said = _MOST_READ, ""
        self.tree: ast.Module | None = None
        self.reach = 0  # the last line of what Python does not understand

    def stops_at(self, lines: list[str]) -> int:
        """Return the line at which Python stops; `_END` if it reads all, 0 if that cannot be found out."""
        self.left -= len(lines)
        self.tree, self.reach = None, 0
        if self.left < 0:
            return 0
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                self.tree = ast.parse("\n".join(lines) + "\n")
        except SyntaxError as error:
            self.said = error.msg or ""
            self.reach = (error.end_lineno if "forgot a comma" in self.said else error.lineno) or 1
            return error.lineno or 1
        except (ValueError, RecursionError, MemoryError):
            return 0
        self.reach = _END
        return _END


@dataclass(frozen=True)
class _Part:
    """The function or statement around a fault: if a change does not mend it, the file need not be read."""

    lines: list[str]
    first: int

    def changed(self, repair: Repair) -> list[str]:
        """Return what Python is to read, with a change."""
        inner = replace(repair, line=repair.line - self.first + 1).applied(self.lines)
        return ["if True:", *inner] if depth_of(self.lines[0]) else inner

    def holds(self, repair: Repair) -> bool:
        """Return whether a change lies within it."""
        return self.first <= repair.line and repair.last < self.first + len(self.lines)

    def is_mended_by(self, repair: Repair, reader: _Reader) -> bool:
        """Return whether Python reads it with a change, or the change lies outside."""
        return not self.holds(repair) or reader.stops_at(self.changed(repair)) == _END


_BEGINS = re.compile(r"\s*(?:async def|def|class|@|import|from|if|for|while|try|with|match)\b|[A-Za-z_]\w*")


def _part(lines: list[str], place: int, reader: _Reader) -> _Part | None:
    """Return the function or statement around a line, by its indentation; None if it has another fault by itself."""
    empty = re.match(r"expected an indented block .* on line (\d+)", reader.said)
    if empty and is_definition(lines[place - 1]):
        below = f"{lines[place - 1][: depth_of(lines[place - 1])]}pass"
        return _Part([*lines[int(empty[1]) - 1 : place - 1], below], int(empty[1]))
    for pattern in (r"\s+(?:async )?def\b", r"\S"):
        above = (n for n in range(place, 0, -1) if _BEGINS.match(lines[n - 1]))
        begin = next((n for n in above if re.match(pattern, lines[n - 1])), 1)
        depth = depth_of(lines[begin - 1])
        ends = (n for n in range(place + 1, len(lines) + 1) if _BEGINS.match(lines[n - 1]))
        end = next((n for n in ends if depth_of(lines[n - 1]) <= depth), len(lines) + 1)
        part = _Part(lines[begin - 1 : end - 1], begin)
        offset = begin - 1 - (depth > 0)
        if reader.stops_at(part.changed(Repair(begin, lines[begin - 1], ""))) + offset == place:
            return part
    return None


def _options(lines: list[str], number: int, reader: _Reader) -> list[tuple[float, Repair]]:
    """Return the changes after which Python reads all, or else further, with their costs, the cheapest first."""
    said, reach, place = reader.said, reader.reach, min(number, len(lines))
    changes = dict[tuple[int, str, tuple[str, ...]], Repair]()
    for repair in _changes(lines, place, said):
        same = changes.setdefault((repair.line, repair.new, repair.below), repair)
        if repair.cost < same.cost:
            changes[repair.line, repair.new, repair.below] = repair
    part = _part(lines, place, reader)
    some = [
        repair
        for repair in changes.values()
        if part is None or repair.is_move or part.is_mended_by(repair, reader)
    ]
    for repairs in (some, changes.values()):
        if found := _further(lines, max(reach, place), repairs, reader):
            return sorted(found, key=lambda option: option[0])
    return []


def _further(
    lines: list[str], before: int, repairs: Iterable[Repair], reader: _Reader
) -> list[tuple[float, Repair]]:
    """Return the changes after which Python reads all, or else further, and that make sense; with their costs."""
    whole, further = list[tuple[float, Repair]](), list[tuple[float, Repair]]()
    for repair in repairs:
        end = reader.stops_at(repair.applied(lines))
        # What moves along was not read before, and may have faults of its own.
        if reader.reach > max(before, repair.line if repair.is_move else repair.last):
            (whole if end == _END else further).append((_cost(repair, reader.tree, lines), repair))
    return [option for option in whole or further if option[0] < _NO_SENSE]


def _cost(repair: Repair, tree: ast.Module | None, lines: list[str]) -> float:
    before, after = "\n".join(lines[repair.line - 1 : repair.last]), "\n".join((repair.new, *repair.below))
    # Whoever leaves a bracket out leaves a line with more of one kind than of the other.
    more_open = max(_unpaired(after) - _unpaired(before), 0)
    lines_of, texts = (repair.line, repair.last), (before, after)
    odd = nonsense(tree, *lines_of, *texts, is_move=repair.is_move) if tree else 0.0
    return repair.cost + more_open / 5 + odd


def _unpaired(text: str) -> int:
    """Return by how many the opening and the closing brackets of a text differ."""
    return abs(sum(text.count(sign) for sign in "([{") - sum(text.count(sign) for sign in ")]}"))


def _changes(lines: list[str], place: int, said: str) -> Iterator[Repair]:
    """Yield the changes near a fault that may mend it."""
    above = next((n for n in range(place - 1, 0, -1) if is_code(lines[n - 1])), 0)
    yield from _left_out(place, lines[place - 1])
    yield from moves_of(lines, place, above, said)
    for number in dict.fromkeys((place, above, *map(int, re.findall(r"on line (\d+)", said)))):
        if number and not ("indent" in said and number != above):
            yield from in_pythons_words(number, lines[number - 1])
            yield from edits_of(number, lines[number - 1], _names(lines, number))
    for number in _around(lines, place):
        yield from ends_of(number, lines[number - 1])


def _names(lines: list[str], but: int) -> set[str]:
    """Return the names in all lines but the faulty one."""
    text = "\n".join(line for number, line in enumerate(lines, 1) if number != but)
    return {*re.findall(r"[A-Za-z_]\w*", text), *dir(builtins)}


def _around(lines: list[str], place: int) -> Iterator[int]:
    """Yield the lines of code of the statement around a line, which may have begun above and may end below."""
    depth = depth_of(lines[place - 1])
    for number in range(place - 1, max(place - _MOST_BELOW, 0), -1):
        line = lines[number - 1]
        if line.strip():
            yield number
            if depth_of(line) < depth or (
                depth_of(line) == depth and not re.match(r"\s*[)\]}]", lines[place - 1])
            ):
                break
    for number in range(place + 1, min(place + _MOST_BELOW, len(lines)) + 1):
        line = lines[number - 1]
        if line.strip() and depth_of(line) < depth:
            break
        if line.strip():
            yield number


def _left_out(place: int, line: str) -> Iterator[Repair]:
    """Yield the removal of a line that is not code: a code fence or a prompt."""
    if re.match(r"\s*(?:([<=>`~|-])\1{2,}|[$%] )", line):
        why = f"`{line.strip()[:_SHOWN]}` is not Python: it was left by a web page, a terminal or git"
        yield Repair(place, "", why)


def as_meant(source: PythonSource) -> PythonSource:
    """Return the file with lines of syntax errors closed or left out; itself if there are too many."""
    known = source
    for _ in range(_MOST_FAULTS):
        line, lines = known.readable_to, known.text.split("\n")
        if line > len(lines):
            break
        at = int(line) - 1
        begin = lines[at][: -len(lines[at].lstrip()) or None]
        texts = (f"{lines[at]}:", f"{lines[at]})", "", f"{begin}pass", f"{begin}if True:")
        changed = ("\n".join([*lines[:at], text, *lines[at + 1 :]]) for text in texts)
        known = max(
            (replace(known, text=text) for text in changed), key=lambda candidate: candidate.readable_to
        )
        if known.readable_to <= line:
            break
    return known if known.readable_to == math.inf else source


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
