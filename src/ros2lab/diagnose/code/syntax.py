"""Files that Python cannot parse, explained by the changes of single lines that let Python read on."""

from __future__ import annotations

import ast
import io
import itertools
import keyword
import re
import tokenize
import warnings
from collections.abc import Iterator
from dataclasses import dataclass

from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.spelling import plain_signs, with_article

_LONGEST = 500  # characters that a line may have for changes to be tried
_MOST_REPAIRS = 4  # lines that are changed, one after the other
_MOST_READ = 60_000  # lines that are parsed in all, about half a second
_SHOWN = 100  # characters of a line
_END = 10**9  # stands for the line of the error in a file that has none
_CLOSERS = {"(": ")", "[": "]", "{": "}"}


@dataclass(frozen=True)
class Repair:
    """A change of one line after which Python reads on.

    Attributes:
        line: the number of the line.
        new: its new text; empty if it is removed.
        why: what is wrong with it, as a clause.
    """

    line: int
    new: str
    why: str


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
    """Explain a syntax error.

    Args:
        code: the code of the finding.
        what: how its cause begins, such as `Python cannot read setup.py`.
        place: where Python has stopped.
        fault: the error.
        source: the file; None if only the error's text is known.
    """
    repairs = repairs_of(source.text, fault) if source else []
    if not repairs:
        return Finding(code, f"{what}: {_said(fault)}.", place, _fix(fault, source))
    first, *more = repairs
    steps = [_step(first), *(f"on line {repair.line} {_step(repair)}" for repair in more)]
    cause = f"{what}: {first.why}."
    return Finding(code, cause, f"{place.rpartition(':')[0]}:{first.line}", "; ".join(steps))


def _step(repair: Repair) -> str:
    is_indented = re.search(r"indented further|spaces are|begins with \d", repair.why)
    if is_indented and not repair.new.endswith(" pass"):
        return f"begin line {repair.line} with {len(repair.new) - len(repair.new.lstrip())} spaces and no tab"
    return f"write `{repair.new.strip()[:_SHOWN]}`" if repair.new.strip() else "remove the line"


def repairs_of(text: str, fault: SyntaxError) -> list[Repair]:
    """Return the changes that let Python read a text, as many as can be found."""
    lines, found = text.splitlines(), []
    if max(map(len, lines), default=0) > _LONGEST or not fault.lineno or "codec" in (fault.msg or ""):
        return []
    reader = _Reader()
    for _ in range(_MOST_REPAIRS):
        number = reader.stops_at(lines)
        repair = _repair(lines, number, reader) if number < _END else None
        if repair is None:
            break
        lines[repair.line - 1] = repair.new
        found.append(repair)
    return found


class _Reader:
    """Parses texts, up to a total number of lines."""

    def __init__(self) -> None:
        self.left, self.said = _MOST_READ, ""

    def stops_at(self, lines: list[str]) -> int:
        """Return the line at which Python stops; `_END` if it reads all, 0 if that cannot be found out."""
        self.left -= len(lines)
        if self.left < 0:
            return 0
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                ast.parse("\n".join(lines) + "\n")
        except SyntaxError as error:
            self.said = error.msg or ""
            return error.lineno or 1
        except (ValueError, RecursionError, MemoryError):
            return 0
        return _END


def _repair(lines: list[str], number: int, reader: _Reader) -> Repair | None:
    """Return the change of a line, or the one above, that lets Python read furthest; None if none helps."""
    said, place = reader.said, min(number, len(lines))
    above = next((n for n in range(place - 1, 0, -1) if lines[n - 1].strip()), 0)
    ways = itertools.chain(
        _reindented(lines, place, above, said),
        _in_pythons_words(place, lines[place - 1]),
        _in_pythons_words(above, lines[above - 1]) if above else (),
        _completed(lines, place, above, said),
        _left_out(place, lines[place - 1]),
    )
    best, reached = None, max(place, 1)
    for repair in ways:
        if repair.new == lines[repair.line - 1]:
            continue
        reaches = reader.stops_at([*lines[: repair.line - 1], repair.new, *lines[repair.line :]])
        if reaches > max(reached, repair.line):
            best, reached = repair, reaches
        if reached == _END:
            break
    return best


def _left_out(place: int, line: str) -> Iterator[Repair]:
    """Yield the removal of a line that is not code: a git conflict marker, a code fence or a prompt."""
    if re.match(r"\s*(?:([<=>`~|-])\1{2,}|[$%] )", line):
        why = f"`{line.strip()[:_SHOWN]}` is not Python: it was left by git, a web page or a terminal"
        yield Repair(place, "", why)


def _reindented(lines: list[str], place: int, above: int, said: str) -> Iterator[Repair]:
    """Yield a line with each indentation that the lines around it suggest."""
    line = lines[place - 1]
    code = line.strip()
    if not re.search(r"indent|tab", said, re.IGNORECASE) or not above:
        return
    before = len(lines[above - 1]) - len(lines[above - 1].lstrip())
    deeper = before + 4
    if "expected an indented block" in said:
        why = f"the lines that belong to `{lines[above - 1].strip()}` must be indented further than it"
        if re.match(r"(def|class|@|else|elif|except|finally)\b", code):
            yield Repair(
                above, f"{lines[above - 1]} pass", f"there is nothing below `{lines[above - 1].strip()}`"
            )
        yield Repair(place, " " * deeper + code, why)
    depths = {len(earlier) - len(earlier.lstrip()) for earlier in lines[: place - 1] if earlier.strip()}
    now = len(line) - len(line.lstrip())
    for depth in sorted(depths, key=lambda depth: abs(depth - now)):
        why = f"`{code[:_SHOWN]}` begins with {now} spaces, but the lines it belongs with begin with {depth}"
        why = "tabs and spaces are mixed in the indentation" if "\t" in line else why
        yield Repair(place, " " * depth + code, why)


def _rule(pattern: str, new: str, why: str) -> tuple[re.Pattern[str], str, str]:
    return re.compile(pattern), new, why


# Syntax of other languages; a change is reported only if Python can read on after it.
_FOREIGN = (
    _rule(r"(?<!=)(?<![\w)\]])(\+\+|--)([\w.]+)\s*;?\s*$", r"\2 \1= 1", "Python has no `++` or `--`"),
    _rule(r"([\w.\]]+)\s*\+\+\s*;?\s*$", r"\1 += 1", "Python has no `++`"),
    _rule(r"([\w.\]]+)\s*--\s*;?\s*$", r"\1 -= 1", "Python has no `--`"),
    _rule(r"\s*&&\s*", " and ", "Python writes `and` where other languages write `&&`"),
    _rule(r"\s*\|\|\s*", " or ", "Python writes `or` where other languages write `||`"),
    _rule(r"!(?!=)\s*", "not ", "Python writes `not` where other languages write `!`"),
    _rule(r"([=!])==", r"\1=", "Python compares with == and !="),
    _rule(r"\(([\w, ]*)\)\s*=>\s*", r"lambda \1: ", "Python writes a short function with `lambda`"),
    _rule(
        r"(\w)\s*==\s*(?=[^()]*\)\s*(?:->.*)?:?\s*$)",
        r"\1=",
        "a default or a keyword argument is given with a single =",
    ),
    _rule(r"=([<>])(?!=)", r"\1=", "in a comparison the = comes last, as in >= and <="),
    _rule(r"<>", "!=", "Python writes != where other languages write <>"),
    _rule(r"^(\s*)\}?\s*(?:else\s+if|elseif|elsif)\b", r"\1elif", "Python writes `elif` for `else if`"),
    _rule(r"^(\s*)\}\s*(else|elif|except|finally)\b", r"\1\2", "Python has no braces around blocks"),
    _rule(r"\s*\{\s*$", ":", "Python begins a block with a colon, not with a brace"),
    _rule(r"^\s*[}]\s*;?\s*$", "", "Python ends a block by its indentation, not with a brace"),
    _rule(r"^\s*end\s*$", "", "Python ends a block by its indentation, not with `end`"),
    _rule(r"\s+(?:then|do)\s*:?\s*$", ":", "Python begins a block with a colon"),
    _rule(r"^(\s*)(?://|/\*|<!--)\s?(.*?)\s*(?:\*/|-->)?$", r"\1# \2", "a comment in Python begins with #"),
    _rule(r"\s*//\s*(?=[A-Za-z]).*$", "", "a comment in Python begins with #, not with //"),
    _rule(r"->|::", ".", "Python writes a dot where other languages write -> or ::"),
    _rule(r"\bnew\s+(?=[A-Z])", "", "Python creates an object without `new`"),
    _rule(
        r"^(\s*)catch\s*\(?\s*(\w+)(?:\s+(\w+))?\s*\)?\s*:?",
        r"\1except \2 as \3:",
        "Python writes `except` for `catch`",
    ),
    _rule(r"^(\s*)except\s+(\w+)\s*,\s*(\w+)\s*:", r"\1except \2 as \3:", "Python writes `as` here"),
    _rule(r"^(\s*)throw\s+(?:new\s+)?", r"\1raise ", "Python writes `raise` for `throw`"),
    _rule(
        r"^(\s*)(?:for|foreach)\s*\(\s*(?:\w+\s+)?(\w+)\s*=\s*(\w+)\s*;\s*\w+\s*<\s*([^;]+);.*?\)\s*[:{]?",
        r"\1for \2 in range(\3, \4):",
        "Python counts with `for ... in range(...)`",
    ),
    _rule(
        r"^(\s*)import\s+([\w, ]+?)\s+from\s+([\w.]+)\s*$",
        r"\1from \3 import \2",
        "the module is named first, and then what is imported from it",
    ),
    _rule(r"^(\s*)from\s+([\w.]+)\s+(?!import\b)(\w+)\s*$", r"\1from \2 import \3", "`import` is missing"),
    _rule(r"^(\s*)(print|exec)\s+([^=].*?);?\s*$", r"\1\2(\3)", "Python 3 calls a function with parentheses"),
    _rule(
        r"^(\s*)(?!def\b|class\b|async\b|if\b|elif\b|while\b|for\b|with\b|return\b)(?:[\w<>]+\s+)+(\w+)\s*(\(.*\))\s*[:{]?\s*$",
        r"\1def \2\3:",
        "a function begins with `def`, without a type in front of it",
    ),
    _rule(
        r"^(\s*)(?!if\b|elif\b|while\b|return\b|del\b)[A-Za-z_][\w.:<>]*[&*]?\s+(?:\w+\s+)?((?:self\.)?\w+\s*=(?!=).*?);?\s*$",
        r"\1\2",
        "a variable is created by giving it a value, without a type or a keyword in front of it",
    ),
    _rule(
        r"^(\s*(?:if|elif|while)\b[^=]*[^=!<>:])=(?!=)\s*",
        r"\1== ",
        "a single = assigns a value; == compares",
    ),
    _rule(r"\b0+(?=[1-9]\d*\b)", "", "an integer may not begin with 0"),
    _rule(r"^(\s*(?:def|class)\s+)(\d+)(\w+)", r"\1\3\2", "a name may not begin with a digit"),
    _rule(r"(?<!\w)(\d+)([A-Za-z_]\w+)(?=\s*[=.(])", r"\2\1", "a name may not begin with a digit"),
)


def _in_pythons_words(number: int, line: str) -> Iterator[Repair]:
    """Yield a line with typographic characters and the syntax of other languages replaced by Python's."""
    plain = plain_signs(line)
    if plain != line:
        strange = next(letter for letter in line if plain_signs(letter) != letter)
        why = f"the letter {strange!r} (U+{ord(strange):04X}) was copied from a web page or a document"
        yield Repair(number, plain, why)
    yield from _names(number, plain)
    versions = [(plain, "")]
    for _ in range(3):
        versions = [
            (changed, why or said)
            for text, why in versions
            for pattern, new, said in _FOREIGN
            if (changed := pattern.sub(new, text)) != text
        ][:30]
        yield from (Repair(number, text, why) for text, why in versions)


def _names(number: int, line: str) -> Iterator[Repair]:
    """Yield a line with an invalid name replaced by a valid one."""
    for word in {*re.findall(r"(?<=\.)[a-z]+\b|\b[a-z]+(?=\s*=[^=])|(?<=def )[a-z]+\b", line)}:
        if keyword.iskeyword(word):
            new = re.sub(rf"(?<![\w]){word}(?!\w)(?=\s*[=.(\[,)]|\s*$)", f"{word}_", line)
            yield Repair(number, new, f"{word} is a Python keyword and cannot be used as a name")
    for name in re.findall(r"[A-Za-z_]\w*(?:-[A-Za-z_]\w*)+", line):
        new = line.replace(name, name.replace("-", "_"))
        yield Repair(number, new, f"{name} contains a minus sign, which a name may not")


def _completed(lines: list[str], place: int, above: int, said: str) -> Iterator[Repair]:
    """Yield a line, or the one above, with a character added, removed or replaced."""
    for number in (place, above):
        if number:
            yield from _ended(number, lines[number - 1])
    yield from _quoted(place, lines[place - 1])
    for number in (place, above):
        if number and ("comma" in said or "invalid syntax" in said or "closed" in said):
            yield from _inserted(number, lines[number - 1])
        if number:
            yield from _exchanged(number, lines[number - 1])
    if wrong := re.search(r"does not match opening parenthesis '(.)'", said):
        closer = _CLOSERS[wrong[1]]
        why = f"a closing {closer} is missing before this line"
        yield Repair(place, re.sub(r"(?=[)\]}])", closer, lines[place - 1], count=1), why)
        if above_it := re.search(r"on line (\d+)", said):
            opened_at = int(above_it[1])
            line = lines[opened_at - 1].rstrip()
            why = f"the {wrong[1]} on line {opened_at} is never closed"
            yield Repair(opened_at, f"{line[:-1]}{closer}," if line.endswith(",") else f"{line}{closer}", why)
    if "never closed" in said:
        opened = said[1]
        closer = _CLOSERS.get(opened, ")")
        depth = len(lines[place - 1]) - len(lines[place - 1].lstrip())
        for number in range(place + 1, min(place + 40, len(lines)) + 1):
            line = lines[number - 1]
            if len(line) - len(line.lstrip()) <= depth or not line.strip():
                why = f"the {opened} on line {place} is never closed"
                last = max(n for n in range(place, number) if lines[n - 1].strip())
                yield Repair(last, f"{lines[last - 1]}{closer}", why)
                yield Repair(last, f"{lines[last - 1]}{closer},", why)
                yield Repair(number, f"{line[:depth]}{closer}{line.lstrip()}", why)
                yield Repair(number, f"{line}{closer}", why)


def _ended(number: int, line: str) -> Iterator[Repair]:
    """Yield a line with something added or removed at its end."""
    code, comment = _split(line)
    for end, what in (
        (":", "a colon is"),
        (")", "a closing bracket ) is"),
        ("]", "a closing bracket ] is"),
        ("}", "a closing brace } is"),
        (",", "a comma is"),
        ("),", "a closing bracket ) is"),
        ("],", "a closing bracket ] is"),
        ("},", "a closing brace } is"),
        ("))", "two closing brackets )) are"),
    ):
        yield Repair(
            number, f"{code}{end}{comment}", f"{what} missing at the end of `{code.strip()[:_SHOWN]}`"
        )
    if code.endswith(":"):
        yield Repair(number, f"{code[:-1]}):{comment}", "a closing bracket ) is missing before the colon")
        yield Repair(number, f"{code[:-1]}{comment}", "the colon at the end does not belong there")
    for closer in ")]}":
        if code.endswith((closer, f"{closer},")):
            cut = code.rstrip(",")[:-1] + "," * code.endswith(",")
            yield Repair(number, f"{cut}{comment}", f"there is one {closer} too many at the end")


def _split(line: str) -> tuple[str, str]:
    """Return a line's code and the comment after it."""
    found = re.search(r"\s*#[^'\"]*$", line)
    return (line[: found.start()], line[found.start() :]) if found else (line.rstrip(), "")


def _quoted(number: int, line: str) -> Iterator[Repair]:
    """Yield a line with a quote or brace added or removed, or with other quotes around a string."""
    yield Repair(
        number, re.sub(r"(\{[^{}'\"]*)(['\"])", r"\1}\2", line), "a brace } is missing in the string"
    )
    yield Repair(number, re.sub(r"(?<!\{)\}", "", line), "there is one brace } too many in the string")
    for quote, other in (("'", '"'), ('"', "'")):
        count = line.count(quote)
        first, last = line.find(quote), line.rfind(quote)
        if count >= 2:
            inner = line[first + 1 : last]
            if quote in inner and other not in inner:
                why = f"the string contains a {quote}, which ends it too early"
                yield Repair(number, f"{line[:first]}{other}{inner}{other}{line[last + 1 :]}", why)
                yield Repair(number, f"{line[: first + 1]}{inner.replace(quote, other)}{line[last:]}", why)
        if count % 2:
            why = f"the closing quote {quote} is missing"
            end = len(line.rstrip()) - len(re.search(r"[)\]},:]*\s*$", line)[0].rstrip())  # type: ignore[index]
            for cut in range(end, len(line.rstrip()) + 1):
                yield Repair(number, f"{line[:cut]}{quote}{line[cut:]}", why)
            begin = re.search(r"(?<=[(=,\[:])\s*(?=\w)", line)
            if begin:
                cut = begin.end()
                yield Repair(
                    number,
                    f"{line[:cut]}{quote}{line[cut:]}",
                    f"the opening quote {quote} is missing",
                )


def _inserted(number: int, line: str) -> Iterator[Repair]:
    """Yield a line with a comma or plus inserted between two tokens, or with one of two operators removed."""
    try:
        tokens = [
            t for t in tokenize.generate_tokens(io.StringIO(line.strip() + "\n").readline) if t.string.strip()
        ]
    except (tokenize.TokenError, SyntaxError):
        return
    begin = len(line) - len(line.lstrip())
    for before, after in itertools.pairwise(tokens):
        cut, end = begin + before.end[1], begin + after.start[1]
        kinds = (tokenize.NAME, tokenize.NUMBER, tokenize.STRING)
        if (before.type in kinds or before.string in ")]}") and (
            after.type in kinds or after.string in "([{"
        ):
            inside = sum(t.string in "([{" for t in tokens if t.start < after.start) > sum(
                t.string in ")]}" for t in tokens if t.start < after.start
            )
            sign, name = (",", "comma") if inside or "=" not in line else (" +", "+")
            why = f"a {name} is missing between {before.string} and {after.string}"
            text = line[end:].strip()
            is_joined = sign == " +" and re.fullmatch(r"[\w.]+", text)
            yield Repair(number, f"{line[:cut]}{sign} {f'str({text})' if is_joined else line[end:]}", why)
    for before, token in itertools.pairwise(tokens):
        if token.type == before.type == tokenize.OP:
            new = f"{line[: begin + token.start[1]]}{line[begin + token.end[1] :]}"
            yield Repair(number, new, f"the character {token.string} does not belong there")


_SIGNS = {":": "a colon", ",": "a comma", "=": "a single =", ".": "a dot"}


def _exchanged(number: int, line: str) -> Iterator[Repair]:
    """Yield a line with one punctuation mark replaced by another."""
    code, comment = _split(line)
    for found in re.finditer(r"(?<![=!<>:+*/-])[=:;.,](?!=)", code):
        for sign, name in _SIGNS.items():
            if sign != found[0]:
                new = f"{code[: found.start()]}{sign}{code[found.end() :]}{comment}"
                yield Repair(
                    number, new, f"there should be {name} instead of {found[0]} in `{code.strip()[:_SHOWN]}`"
                )


def _said(fault: SyntaxError) -> str:
    """Return Python's message about a syntax error in plain words."""
    said = fault.msg or "invalid syntax"
    if isinstance(fault, TabError):
        return "tabs and spaces are mixed in the indentation"
    if isinstance(fault, IndentationError):
        return f"the indentation is wrong ({said})"
    if "codec" in said:
        return f"it is not saved as UTF-8, so an accented letter cannot be read ({said})"
    return said.removesuffix(".").removesuffix("?")


def _fix(fault: SyntaxError, source: PythonSource | None) -> str:
    """Say what to do about a syntax error for which no change of the line is known."""
    if isinstance(fault, IndentationError):
        return "indent with four spaces everywhere, never with tabs"
    if "codec" in (fault.msg or ""):
        return "save the file again with the encoding UTF-8"
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
        lines = enumerate(source.text.splitlines()[: (fault.lineno or 1) - 1] if source else (), 1)
        others = [number for number, line in lines if re.search(rf"\b{twice[1]}\s*=", line)]
        where = f" on line {others[-1]}" if others else ""
        return f"move the contents of this one into the {twice[1]}{where}, and remove this one"
    if outside := re.match(r"'(\w+)' outside (?:of )?(.+)", fault.msg or ""):
        return f"remove {outside[1]}, or put it inside {with_article(outside[2])}"
    return "fix this line as the message says"
