"""Slips of typing in Python, undone in every way: on one line, or in the indentation of a line and its block."""

from __future__ import annotations

import difflib
import itertools
import keyword
import re
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from ros2lab.diagnose.sources import interfaces

USUAL, SELDOM, RARE = 1.0, 1.5, 2.5  # costs


@dataclass(frozen=True)
class Repair:
    """A change of one line, or of the indentation of several, after which Python may read on.

    Attributes:
        new: its new text; empty if it is removed.
        why: what is wrong with it, as a clause.
        cost: the higher, the less likely the slip is that it undoes.
        below: the new texts of the lines below it that move along with it.
    """

    line: int
    new: str
    why: str
    cost: float = USUAL
    below: tuple[str, ...] = ()
    is_move: bool = False

    @property
    def last(self) -> int:
        """The number of the last line that changes."""
        return self.line + len(self.below)

    def applied(self, lines: Sequence[str]) -> list[str]:
        """Return the lines of a file with the change."""
        return [*lines[: self.line - 1], self.new, *self.below, *lines[self.last :]]


_TOKEN = re.compile(
    r"""(?P<comment>\#.*)|(?P<text>[rbfuRBFU]{0,2}(?:"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'))|(?P<word>[A-Za-z_]\w*)"""
    r"""|(?P<number>\d(?:[\w.]|(?<=e)[+-])*)|(?P<sign>->|:=|\*\*|//|<<|>>|[-+*/%&|^=!<>]=|\S)"""
)
_SIMILAR = 0.74  # of a word to the keyword that it misspells
_SHOWN = 60  # characters of code in a sentence
_NAMES = {
    ":": "a colon",
    ",": "a comma",
    ".": "a dot",
    "=": "a single =",
    "==": "==",
    "+": "a +",
    "(": "an opening bracket (",
    "[": "an opening bracket [",
    "{": "an opening brace {",
    ")": "a closing bracket )",
    "]": "a closing bracket ]",
    "}": "a closing brace }",
}
# What is inserted between two tokens: none after which a space belongs stands without it.
_INSERTED = {sign: {",": ", ", "+": " + ", "=": "="}.get(sign, sign) for sign in _NAMES if sign != "=="}
_CLOSERS, _OPENERS, _QUOTES = ")]}", "([{", "'\""
# What a line's end may lack.
_ENDS = (":", ",", ")", "]", "}", "))", "):", "),", "],", "},", ")),", ")]", "])")
_WORDS = (*keyword.kwlist, "match", "case")
# A line up to a place in an annotation: after an arrow, or after the colon of a parameter or a variable.
_IN_TYPE = re.compile(
    r"\s*(?:async\s+)?def\b.*(?:->[^:]*|[(,]\s*\*{0,2}\w+\s*:[^=]*)$|\s*(?!(?:else|finally|lambda|try)\b)[\w.]+\s*:[^=]*$"
)
_MOST_TOKENS = 80  # of a line that is edited everywhere


class _Line:
    """A line of a file, in tokens, even if Python cannot tell them apart."""

    def __init__(self, number: int, text: str) -> None:
        self.number, self.text = number, text
        self.tokens = [found for found in _TOKEN.finditer(text) if found.lastgroup != "comment"]
        self.end = self.tokens[-1].end() if self.tokens else len(text.rstrip())

    def spliced(self, start: int, end: int, new: str, why: str, cost: float = USUAL) -> Repair:
        return Repair(self.number, f"{self.text[:start]}{new}{self.text[end:]}", why, cost)

    def beside(self, at: int) -> str:
        """Say between which two tokens, or beside which, a place lies."""
        before = next((token[0] for token in reversed(self.tokens) if token.end() <= at), "")
        after = next((token[0] for token in self.tokens if token.start() >= at), "")
        if before and after:
            return f"between `{_short(before)}` and `{_short(after)}`"
        return f"before `{_short(after)}`" if after else f"at the end of `{self.to(self.end)}`"

    def to(self, at: int) -> str:
        """Return the code up to a place, short enough for a sentence."""
        return _short(self.text[:at].strip())


def _short(text: str) -> str:
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 3]}..."


def edits_of(number: int, text: str, known: Collection[str]) -> Iterator[Repair]:
    """Yield a line with one slip undone, wherever it may be."""
    line = _Line(number, text)
    if 0 < len(line.tokens) <= _MOST_TOKENS:
        yield from ends_of(number, text)
        for edits in (
            _with_quotes,
            _inserted,
            _removed,
            _exchanged,
            _quoted_through,
            _emptied,
            _other_quotes,
            _in_braces,
            _other_words,
        ):
            yield from edits(line)
        yield from _parted(line, known)
        yield from _joined(line, known)


def ends_of(number: int, text: str) -> Iterator[Repair]:
    """Yield a line with something added at its end, or with `=` instead of `==`: slips that Python sees only later."""
    line = _Line(number, text)
    for end in _ENDS if line.tokens else ():
        what = " and ".join(_NAMES[sign] for sign in end)
        why = f"{what} {'is' if len(end) == 1 else 'are'} missing {line.beside(line.end)}"
        yield line.spliced(line.end, line.end, end, why, USUAL + (len(end) - 1) / 4)
    if len(line.tokens) > 1 and line.tokens[-1][0] in (",", ":"):
        at = line.tokens[-1].start()
        for closer in _CLOSERS:
            yield line.spliced(at, at, closer, f"{_NAMES[closer]} is missing {line.beside(at)}")
    for token in line.tokens:
        if token[0] in ("==", ":"):
            why = f"there should be a single = instead of {token[0]} after `{line.to(token.start())}`"
            yield line.spliced(*token.span(), "=", why)


def _inserted(line: _Line) -> Iterator[Repair]:
    """Yield a line with a sign inserted between two tokens."""
    for at in dict.fromkeys(place for token in line.tokens for place in token.span()):
        before, after = line.text[:at].rstrip()[-1:], line.text[at:].lstrip()
        space = line.text[at : len(line.text) - len(after)]
        for sign, new in _INSERTED.items():
            is_empty = sign == "(" and after.startswith(")") and re.match(r"\w", before)
            cost = USUAL if _is_usual(sign, before, after) else RARE if before else SELDOM
            cost = SELDOM - 0.1 if is_empty else cost
            why = f"{_NAMES[sign]} is missing {line.beside(at)}"
            if space and sign in ".([{":
                yield line.spliced(at, at + len(space), sign, why, cost - 0.1)
            yield line.spliced(at, at, new.rstrip() if space or not after else new, why, cost)
        if joined := re.match(r"[\w.]+(?=\)*$)", after) if before in _QUOTES else None:
            end = at + len(space) + joined.end()
            why = f"a + is missing {line.beside(at)}"
            yield line.spliced(at, end, f" + str({joined[0]})", why, RARE - 0.1)


def _with_quotes(line: _Line) -> Iterator[Repair]:
    """Yield a line with a quote inserted at the edge of a word, if one is missing."""
    for quote in _QUOTES:
        if line.text.count(quote) % 2:
            for edge in re.finditer(r"\b|(?<=\S)(?=\s)|(?<=[^\w\s])(?=[^\w\s])", line.text[: line.end]):
                at = edge.start()
                before, after = line.text[at - 1 : at], line.text[at : at + 1]
                opens, closes = re.match(r"[\s(\[{=,:]", before or " "), re.match(r"[\s)\]},:]", after or " ")
                cost = USUAL if bool(opens) != bool(closes) else SELDOM
                yield line.spliced(at, at, quote, f"a quote {quote} is missing after `{line.to(at)}`", cost)
            for end in (")", "))", "),", "]", "],"):
                why = f"a quote {quote} and {_NAMES[end[0]]} are missing at the end of `{line.to(line.end)}`"
                yield line.spliced(line.end, line.end, f"{quote}{end}", why, USUAL + len(end) / 4)


def _is_usual(sign: str, before: str, after: str) -> bool:
    """Return whether a sign often stands between two others: a call's bracket after a name, a list's after a sign."""
    if sign == "(":
        return re.match(r"[\w\]]", before) is not None and not after.startswith("(")
    if sign in _OPENERS:
        return bool(before) and re.match(r"[\w)\]]", before) is None and (bool(after) or before in "=([{:")
    if sign in _CLOSERS:
        is_last = re.match(r"$|[^\w\s(\[{'\"]", after) is not None
        return is_last and (
            re.match(r"[\w)\]}'\"]", before) is not None or (before + sign == "()" and bool(after))
        )
    return sign not in "+=:"


def _removed(line: _Line) -> Iterator[Repair]:
    """Yield a line without one of its signs."""
    for token in line.tokens:
        if token.lastgroup == "sign":
            why = f"the character {token[0]} does not belong after `{line.to(token.start())}`"
            before, after = (
                line.text[token.start() - 1 : token.start()],
                line.text[token.end() : token.end() + 1],
            )
            is_joining = re.fullmatch(r"\w\w", before + after) is not None
            is_closing = token[0] in _CLOSERS and token is line.tokens[-1]
            cost = RARE if is_joining else SELDOM - 0.2 if is_closing else SELDOM
            yield line.spliced(*token.span(), "", why, cost)


def _exchanged(line: _Line) -> Iterator[Repair]:
    """Yield a line with one of its signs replaced by another."""
    for token in line.tokens:
        if token.lastgroup != "sign":
            continue
        groups = ([*_OPENERS], [*_CLOSERS], [":", ",", ".", "=", "=="])
        for sign in next((group for group in groups if token[0] in group), groups[-1]):
            if sign != token[0]:
                before = line.to(token.start())
                new = f"{sign} " if sign == "," and line.text[token.end() : token.end() + 1].strip() else sign
                why = f"there should be {_NAMES[sign]} instead of {token[0]} after `{before}`"
                yield line.spliced(*token.span(), new, why, SELDOM)


def _quoted_through(line: _Line) -> Iterator[Repair]:
    """Yield a line with quotes around a whole element, value or line."""
    pairs = [*itertools.pairwise(line.tokens)]
    begins = [
        line.tokens[0].start(),
        *(after.start() for before, after in pairs if before.lastgroup == "sign"),
    ]
    ends = [line.end, *(before.end() for before, after in pairs if after.lastgroup == "sign")]
    for begin, end in itertools.product(begins, ends):
        inner = line.text[begin:end]
        is_statement = begin == line.tokens[0].start() and keyword.iskeyword(line.tokens[0][0])
        is_text = not any(quote in inner for quote in _QUOTES) and not _IN_TYPE.match(line.text[:begin])
        if inner and not is_statement and is_text:
            why = f"there are no quotes around the text `{_short(inner)}`"
            # The shortest is meant: a value, and not what it is called.
            yield line.spliced(begin, end, f"'{inner}'", why, SELDOM + len(inner) / 1000)


def _emptied(line: _Line) -> Iterator[Repair]:
    """Yield a line without the empty brackets of a type or a variable, as in `list[]`, or with a gap in those of a value."""
    for found in re.finditer(r"([A-Za-z_]\w*)(\s*\[\s*\])(\s*=(?!=))?", line.text[: line.end]):
        new, why = "", f"the brackets after `{found[1]}` are empty"
        if not found[3] and not _IN_TYPE.match(line.text[: found.start()]):
            new, why = "[...]", f"{why}: an index belongs in them, or round ones if it is called"
        yield line.spliced(*found.span(2), new, why, USUAL - 0.1)


def _other_quotes(line: _Line) -> Iterator[Repair]:
    """Yield a line with other quotes around a string that contains the quote which ends it."""
    for quote, other in itertools.permutations(_QUOTES):
        places = [found.start() for found in re.finditer(rf"(?<!\\){quote}", line.text)]
        for first, last in itertools.combinations(places, 2):
            inner = line.text[first + 1 : last]
            if quote in inner and other not in inner:
                why = f"the string contains a {quote}, which ends it too early"
                yield line.spliced(first, last + 1, f"{other}{inner}{other}", why)
                yield line.spliced(first + 1, last, inner.replace(quote, other), why)


def _in_braces(line: _Line) -> Iterator[Repair]:
    """Yield a line with a brace more, or less, in a string."""
    for token in line.tokens:
        if token.lastgroup == "text" and "f" in token[0][:2].lower():
            for found in re.finditer(r"\{[^{}]*", token[0][:-1]):
                end = token.start() + found.end()
                yield line.spliced(end, end, "}", "a brace } is missing in the string")
            for found in re.finditer(r"[{}]", token[0]):
                at = token.start() + found.start()
                yield line.spliced(
                    at, at + 1, "", f"there is one brace {found[0]} too many in the string", SELDOM
                )


def _other_words(line: _Line) -> Iterator[Repair]:
    """Yield a line with a word replaced by the keyword of which it is a misspelling."""
    for token in line.tokens:
        if token.lastgroup != "word":
            continue
        close = difflib.get_close_matches(token[0], _WORDS, n=2, cutoff=_SIMILAR)
        turned = (word for word in sorted(_WORDS) if sorted(word) == sorted(token[0].lower()))
        for word in dict.fromkeys([*close, *turned]):
            if word != token[0]:
                why = f"`{token[0]}` should be `{word}`"
                yield line.spliced(*token.span(), word, why, USUAL - 0.1)


def _parted(line: _Line, known: Collection[str]) -> Iterator[Repair]:
    """Yield a line with a word parted in two of which its file knows one, with a sign or a space between them."""
    for token, after in itertools.pairwise([*line.tokens, None]):
        if token is None or token.lastgroup != "word" or token[0] in known:
            continue
        near = {*known, *(other[0] for other in line.tokens if other is not token)}
        is_before_text = after is not None and after[0][0] in _QUOTES and after.start() == token.end()
        for cut in range(1, len(token[0])):
            left, right = token[0][:cut], token[0][cut:]
            is_prefix = is_before_text and re.fullmatch("[rbfRBF]{1,2}", right) is not None
            count = (left in near) + (right in near) + 2 * is_prefix
            signs = (" ",) if keyword.iskeyword(left) or keyword.iskeyword(right) else ("(", "[", ".", ", ")
            for sign in signs if count else ():
                why = f"{_NAMES.get(sign.strip(), 'a space')} is missing between `{left}` and `{right}`"
                at = token.start() + cut
                yield line.spliced(at, at, sign, why, USUAL if count > 1 else SELDOM - 0.3)


def _joined(line: _Line, known: Collection[str]) -> Iterator[Repair]:
    """Yield a line with two words joined to a name that its file, or ROS, knows: `self.create timer(...)`."""
    for before, left, right in zip([None, *line.tokens], line.tokens, line.tokens[1:], strict=False):
        is_part = before is not None and before[0] == "."
        if left.lastgroup != "word" or right.lastgroup != "word" or keyword.iskeyword(right[0]):
            continue
        if keyword.iskeyword(left[0]) and not is_part:
            continue
        for name in (f"{left[0]}{right[0]}", f"{left[0]}_{right[0]}"):
            if name in known or name in _of_ros() or interfaces.homes_of(name):
                why = f"there is a space in the name `{name}`"
                yield line.spliced(left.start(), right.end(), name, why, USUAL - 0.2)


def _of_ros() -> Collection[str]:
    """Return the names of rclpy, and of what a node has."""
    return interfaces.node_members() | (interfaces.importable_names("rclpy") or frozenset())


_LEVELS = (" " * 4, "\t")  # what a file indents its levels by
_EACH, _MOST = 0.02, 0.3  # what each further line adds to a cost, and what all of them add at most
_CUT = 0.5  # what it costs to leave the next line behind
_DEFINITION = re.compile(r"\s*(?:(?:async )?def\b|class\b|@)")
_METHOD = re.compile(r"\s*(?:async )?def \w+\(\s*self\b")


def depth_of(line: str) -> int:
    """Return the number of spaces and tabs with which a line begins."""
    return len(line) - len(line.lstrip())


def is_code(line: str) -> bool:
    """Return whether a line has more than a comment."""
    return line.strip()[:1] not in ("", "#")


def is_definition(line: str) -> bool:
    """Return whether a line begins a function or a class."""
    return _DEFINITION.match(line) is not None


def level_of(lines: Sequence[str]) -> str:
    """Return what most lines of a file are indented by: a tab, or else four spaces."""
    indents = Counter(line[0] for line in lines if line.strip() and line[0] in " \t")
    return max(_LEVELS, key=lambda level: indents[level[0]])


def in_words(indent: str) -> str:
    """Return the beginning of a line in words, such as "8 spaces" or "1 tab"."""
    sign = "tab" if "\t" in indent else "space"
    return f"{len(indent)} {sign}" if len(indent) == 1 else f"{len(indent)} {sign}s"


def moves_of(lines: Sequence[str], place: int, above: int, said: str) -> Iterator[Repair]:
    """Yield the line at which Python stops, or the one above, moved to each depth around it, alone or with its block."""
    if not re.search(r"indent|tab|expected '", said, re.IGNORECASE):
        return
    if above and re.search("expected an indented block", said):
        empty = [*_with_something_below(lines, place, above)]
        yield from empty
        if any(repair.cost == USUAL for repair in empty):
            return
    for number in (place, above):
        for depth in _depths(lines, number) if number else ():
            for last in _ends(lines, number):
                yield _moved(
                    lines, number, last, depth, above if "expected an" in said and number == place else 0
                )


def _with_something_below(lines: Sequence[str], place: int, above: int) -> Iterator[Repair]:
    """Yield `pass` for a block if what follows is no part of it; it costs less if a comment stands there, as in a template."""
    head, follows = lines[above - 1], lines[place - 1]
    comments = [line for line in lines[above:place] if line.strip() and not is_code(line)]
    has_comment = any(depth_of(line) > depth_of(head) for line in comments)
    is_end = place == above or not is_code(follows) or depth_of(follows) < depth_of(head)
    if is_end or re.match(r"(def|class|@|else|elif|except|finally)\b", follows.strip()):
        what, cost = ("only a comment", USUAL) if has_comment else ("nothing", RARE)
        yield Repair(above, f"{head.rstrip()} pass", f"there is {what} below `{head.strip()}`", cost)


def _depths(lines: Sequence[str], number: int) -> list[int]:
    """Return the depths that a line may have had, the nearest to its own first."""
    now, level = depth_of(lines[number - 1]), level_of(lines)
    found = {depth_of(line) for line in lines[: number - 1] if line.strip()}
    above = [line for line in lines[: number - 1] if is_code(line)]
    if above and above[-1].rstrip().endswith(":"):
        found.add(depth_of(above[-1]) + len(level))
    is_mixed = _is_mixed(lines[number - 1], level)
    return sorted((found | {0}) - (set() if is_mixed else {now}), key=lambda depth: abs(depth - now))


def _is_mixed(line: str, level: str) -> bool:
    """Return whether a line begins with other signs than its file."""
    return not {*line[: depth_of(line)]} <= {level[0]}


def _ends(lines: Sequence[str], number: int) -> Iterator[int]:
    """Yield the numbers of the last lines of what may move with a line: itself, and the block that it begins."""
    yield number
    now, end, seen = depth_of(lines[number - 1]), number, {number}
    for other in range(number + 1, len(lines) + 1):
        line = lines[other - 1]
        if not line.strip():
            continue
        # A block ends where its level does; a definition may be the next one of what the first belongs to.
        is_next = _DEFINITION.match(line) is not None
        if (depth_of(line) <= now or is_next) and end not in seen:
            seen.add(end)
            yield end
        is_top = re.match(r"(def|class|@|async def|if __name__)\b", line) and not _METHOD.match(line)
        if depth_of(line) < now or (depth_of(line) == now and is_top):
            return
        end = other
    if end not in seen:
        yield end


def _moved(lines: Sequence[str], first: int, last: int, depth: int, head: int) -> Repair:
    now, level = depth_of(lines[first - 1]), level_of(lines)
    signs = level[0] * depth
    below = [
        level[0] * max(depth_of(line) + depth - now, 0) + line.lstrip() if line.strip() else line
        for line in lines[first:last]
    ]
    code, new = lines[first - 1].strip(), signs + lines[first - 1].lstrip()
    is_mixed = _is_mixed(lines[first - 1], level)
    why = f"`{code[:_SHOWN]}` begins with {in_words(level[0] * now)}, but the lines it belongs with begin with {depth}"
    if is_mixed:
        why = "tabs and spaces are mixed in the indentation"
    elif head:
        why = (
            f"the lines that belong to `{lines[head - 1].strip()[:_SHOWN]}` must be indented further than it"
        )
    # The body of a definition goes on to an empty line at least.
    rest = lines[last] if head and last < len(lines) and _DEFINITION.match(lines[head - 1]) else ""
    is_cut = bool(rest.strip()) and depth_of(rest) == now and not _DEFINITION.match(rest)
    cost = USUAL + min(_EACH * (last - first), _MOST) + _CUT * is_cut
    return Repair(first, new, why, cost, tuple(below), is_move=True)
