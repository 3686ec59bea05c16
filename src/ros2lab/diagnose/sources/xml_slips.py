"""Slips of typing in XML: a sign more, less or another, a misspelt tag, or the line of a tag that is not there."""

from __future__ import annotations

import collections
import contextlib
import difflib
import re
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from xml.parsers import expat

from ros2lab.diagnose.sources.slips import ALL, RARE, SELDOM, USUAL, Lines, Slip, Vocabulary, likeliest

_SIGNS = ("<", ">", "/", '"', "=", "</")
_ALIKE = 0.6  # of a tag to the one that it misspells
_ODD = 3.0  # the cost of what makes no sense
_MOST_LINES = 60  # above a fault
_TAG = re.compile(r"(?<=<)/?[A-Za-z][\w-]*")
# How a character with a meaning in XML is written as plain text.
_WRITTEN = {"&": "&amp;", "<": "&lt;"}


@dataclass
class _Element:
    tag: str
    above: str
    line: int
    texts: list[str]
    attributes: int
    count: int = 0  # of the elements in it


class _Seen:
    """What a parser sees of a text, up to its end or a fault."""

    def __init__(self, text: str) -> None:
        self.elements: list[_Element] = []
        self.open: list[_Element] = []
        self.values: list[str] = []
        parser = self._parser = expat.ParserCreate("utf-8")
        parser.buffer_text = True
        parser.StartElementHandler = self._start
        parser.EndElementHandler = lambda _: self.open.pop()
        parser.CharacterDataHandler = lambda data: self.open[-1].texts.append(data) if self.open else None
        with contextlib.suppress(expat.ExpatError):
            parser.Parse(text.encode(errors="replace"), True)

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        above = self.open[-1] if self.open else None
        if above:
            above.count += 1
        element = _Element(
            tag, above.tag if above else "", self._parser.CurrentLineNumber, [], len(attributes)
        )
        self.elements.append(element)
        self.open.append(element)
        self.values += [*attributes.values()]


def xml_repair(
    text: str, vocabulary: Vocabulary, is_right: Callable[[str], bool] = lambda _: True
) -> Slip | None:
    """Return the likeliest change after which a text is XML, and right; None if no small one helps."""
    last = _reach(text)
    # What a document type declares may expand a thousandfold.
    if last == ALL or "<!DOCTYPE" in text or not text.strip():
        return None
    lines = {*text.split("\n")}
    words = "|".join(sorted(vocabulary.words, key=len, reverse=True))
    left_over = re.compile(rf"[<>/]\s*(?:{words})\b|\b(?:{words})\s*[<>/=]|>")

    def oddness(changed: str) -> float:
        seen = _Seen(changed)
        odd = sum(_oddness(element, vocabulary, left_over) for element in seen.elements)
        odd += sum(1 for value in seen.values if re.search(r"[<>=]", value) and "://" not in value)
        return odd + sum(_form(line) for line in changed.split("\n") if line not in lines)

    return likeliest(text, _slips(text, int(last), vocabulary), _reach, oddness, is_right)


def _reach(text: str) -> float:
    """Return the line at which a text ceases to be XML."""
    try:
        expat.ParserCreate("utf-8").Parse(text.encode(errors="replace"), True)
    except expat.ExpatError as error:
        return error.lineno
    return ALL


def _oddness(element: _Element, vocabulary: Vocabulary, left_over: re.Pattern[str]) -> float:
    """Return how little sense an element makes."""
    said = " ".join(element.texts).strip()
    odd = 0.0 if vocabulary.knows(element.tag, element.above) else _ODD
    if not (element.attributes or element.count or said) and element.tag in vocabulary.inner:
        odd += 2  # it holds nothing
    if element.tag in vocabulary.texts:
        odd += (_ODD if element.count else 0) + (0 if said else 1)
    elif said and element.tag in vocabulary.words:
        odd += _ODD
    return odd + (_ODD if left_over.search(said) else 0)


def _form(line: str) -> float:
    """Return how unusual the form of a line is."""
    return (
        abs(line.count("<") - line.count(">"))
        + (line.lstrip()[:1] in (">", "/"))
        + any(odd in line for odd in ("<>", "</>", "></"))
    )


def _slips(text: str, stops: int, vocabulary: Vocabulary) -> Iterator[Slip]:
    lines, seen = Lines(text), _Seen(text)
    begin = text.find("<?xml ")
    if begin > 0:
        declaration, _, rest = text[begin:].partition("\n")
        told = f"move this line to the very beginning of the file: nothing may come before {declaration}"
        yield Slip(text.count("\n", 0, begin) + 1, told, f"{declaration}\n{text[:begin]}{rest}", USUAL)
    last = min(stops, len(text.rstrip().split("\n")))
    words = {*vocabulary.words, *(element.tag for element in seen.elements)}
    ends = collections.Counter(re.findall(r"</([\w-]+)>", text))
    ends.subtract(re.findall(r"<([\w-]+)", text))
    for number in range(last, max(last - _MOST_LINES, 0), -1):
        far = (last - number) / 1000  # a fault is noticed after its place, mostly shortly after
        for new, cost in _changes(lines[number], words):
            yield lines.written(number, new, cost=cost + far)
        if re.fullmatch(r"\s*(?:</?[^<>]*>?|[<>/]+)\s*", lines[number]):
            yield lines.removed(number, cost=RARE + far)
        for element in seen.open:
            yield lines.added(number, f"{_indent(lines[element.line])}</{element.tag}>", cost=SELDOM + far)
        for tag in (tag for tag, count in ends.items() if count > 0):
            opened = vocabulary.opened.get(tag, f"<{tag}>")
            yield lines.added(number, f"{_indent(lines[number])}{opened}", cost=SELDOM + far)


def _indent(line: str) -> str:
    return line[: len(line) - len(line.lstrip())]


def _changes(line: str, words: Collection[str]) -> Iterator[tuple[str, float]]:
    """Yield a line with one slip undone, and what that costs."""
    for match in re.finditer(r"<!--(.*?)-->", line):
        said = re.sub(r"-{2,}", "-", match[1]).strip(" -")
        yield f"{line[: match.start()]}<!-- {said} -->{line[match.end() :]}", USUAL
    for match in re.finditer(r"&(?!\w+;)|<(?![\w!/?<])", line):
        yield line[: match.start()] + _WRITTEN[match[0]] + line[match.end() :], USUAL
    for match in re.finditer(r"""(?<==)[^\s"'<>]+""", line):
        yield f'{line[: match.start()]}"{match[0]}"{line[match.end() :]}', USUAL
    if opened := re.search(r"<([\w-]+)[^>/]*>[^<]*$", line):
        yield f"{line.rstrip()}</{opened[1]}>", USUAL
    for match in _TAG.finditer(line):
        name = match[0].lstrip("/")
        for word in difflib.get_close_matches(name, words, n=4, cutoff=_ALIKE):
            cost = USUAL + 1 - difflib.SequenceMatcher(None, name, word).ratio()
            yield f"{line[: match.end() - len(name)]}{word}{line[match.end() :]}", cost
        for word in words if match[0][0] == "/" else ():
            yield f"{line[: match.start()]}/{word}{line[match.end() :]}", RARE
    for match in re.finditer(r"[^\w\s]", line):
        yield (
            line[: match.start()] + line[match.end() :],
            USUAL if match[0] == line[match.end() :][:1] else SELDOM,
        )
        for sign in _SIGNS:
            yield line[: match.start()] + sign + line[match.end() :], SELDOM
    edges = {edge for match in re.finditer(r"\w+|[^\w\s]", line) for edge in match.span()}
    glued = (match for word in words for match in re.finditer(word, line))
    for place in sorted({*edges, *(edge for match in glued for edge in match.span())}):
        for sign in _SIGNS:
            yield line[:place] + sign + line[place:], USUAL if len(sign) == 1 else SELDOM
