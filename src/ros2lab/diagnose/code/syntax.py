"""Files that Python cannot parse, explained by the changes of single lines that let Python read on."""

from __future__ import annotations

import ast
import io
import itertools
import re
import tokenize
import warnings
from collections.abc import Iterator

from ros2lab.diagnose.code.other_languages import in_pythons_words
from ros2lab.diagnose.code.repair import Repair
from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.spelling import with_article

_LONGEST = 500  # characters that a line may have for changes to be tried
_MOST_REPAIRS = 4  # lines that are changed, one after the other
_MOST_READ = 60_000  # lines that are parsed in all, about half a second
_SHOWN = 100  # characters of a line
_END = 10**9  # stands for the line of the error in a file that has none
_MOST_OF_ELEMENT = 40  # lines of an element of a list
_CLOSERS = {"(": ")", "[": "]", "{": "}"}
_OPENERS = {closer: opener for opener, closer in _CLOSERS.items()}


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
        in_pythons_words(place, lines[place - 1]),
        in_pythons_words(above, lines[above - 1]) if above else (),
        _completed(lines, place, above, said),
        _left_out(place, lines[place - 1]),
    )
    for repair in _after_element(lines, place) if "forgot a comma" in said else ():
        if reader.stops_at([*lines[: repair.line - 1], repair.new, *lines[repair.line :]]) > repair.line:
            return repair
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
        if above_it := re.search(r"on line (\d+)", said):
            yield from _closed_below(lines, int(above_it[1]), place, closer)
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


def _after_element(lines: list[str], place: int) -> Iterator[Repair]:
    """Yield each line on which an element that begins on a line may end, with a comma added."""
    for (number, line), (_, following) in _pairs(lines, place, place + _MOST_OF_ELEMENT):
        text, comment = _split(line)
        if re.search(r"[\w)\]}'\"]$", text) and re.match(r"\s*[\w(\[{'\"*]", following):
            begun = following.strip()[:_SHOWN]
            yield Repair(
                number, f"{text},{comment}", f"a comma is missing between two elements, before `{begun}`"
            )


def _closed_below(lines: list[str], opened_at: int, place: int, closer: str) -> Iterator[Repair]:
    """Yield each line after which the code is no longer indented below an open bracket, with that closed."""
    depth = _depth(lines[opened_at - 1])
    for (number, line), (_, following) in _pairs(lines, opened_at, place + 1):
        if _depth(following) <= depth:
            text, comment = _split(line)
            why = f"the {_OPENERS[closer]} on line {opened_at} is never closed"
            yield Repair(number, f"{text.rstrip(',')}{closer}{',' * text.endswith(',')}{comment}", why)


def _pairs(lines: list[str], start: int, end: int) -> Iterator[tuple[tuple[int, str], tuple[int, str]]]:
    """Yield each line of code from one number to before another, with its number and with the next such line."""
    code = enumerate(lines[start - 1 : end - 1], start)
    return itertools.pairwise((n, line) for n, line in code if line.strip() and line.strip()[0] != "#")


def _depth(line: str) -> int:
    return len(line) - len(line.lstrip())


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
