"""Slips of typing in YAML: a sign more, less or another, a misspelt word, or a line that begins at the wrong column."""

from __future__ import annotations

import collections
import difflib
import itertools
import re
from collections.abc import Callable, Iterator

import yaml

from ros2lab.diagnose.finding import lines_in_words
from ros2lab.diagnose.sources.slips import ALL, RARE, SELDOM, USUAL, Lines, Slip, Vocabulary, likeliest

_ALIKE = 0.7  # of a word to the one that it misspells
_ODD = 3.0  # the cost of what makes no sense
_LONGEST = 20_000  # characters
_FEW_WORDS = 3  # of a line that is no sentence
_NEAR = 3  # lines around a fault in which the slip may be
_PAIRS = {"'": "'", '"': '"', "[": "]", "{": "}"}
_SIGNS = (*"'\"[]{},:",)
# How comments of other languages begin and end; those without an end go to that of the line.
_COMMENTS = {'"""': '"""', "'''": "'''", "/*": "*/", "<!--": "-->", "//": ""}
_ENTRY = re.compile(
    r"(?P<indent>[ \t]*)(?P<dash>(?:-[ \t]*)*)(?P<key>[\w./*~-]*\w|/?\*+|'[^']+'|\"[^\"]+\")?(?P<rest>.*)"
)


# libyaml's loader is forty times as fast, but PyYAML may have been built without it.
class _Loader(getattr(yaml, "CBaseLoader", yaml.BaseLoader)):  # type: ignore[misc]
    """Reads what a text holds, without the types of its values, which take half the time."""

    def resolve(self, *_: object) -> str:
        return ""

    def descend_resolver(self, *_: object) -> None:
        pass

    ascend_resolver = descend_resolver


def yaml_repair(
    text: str, vocabulary: Vocabulary, check: Callable[[yaml.Node], object] = lambda _: None
) -> Slip | None:
    """Return the likeliest change after which a text is the YAML that it should be; None if no small one helps.

    Args:
        text: what is not.
        vocabulary: the keys that it may have.
        check: raises a `yaml.MarkedYAMLError` for YAML that should be other YAML.
    """
    if len(text) > _LONGEST:
        return None

    _, fault = _reach(text, check)
    is_yaml = _reach(text)[1] is None

    def reach(changed: str) -> float:
        stops, wrong = _reach(changed, check)
        # A change that makes of wrong YAML none at all only hides what is wrong.
        return 0 if is_yaml and wrong and _reach(changed)[1] else stops

    usual = _Usual(text, vocabulary)
    return likeliest(text, _slips(text, fault, usual), reach, usual.oddness) if fault else None


def _reach(
    text: str, check: Callable[[yaml.Node], object] = lambda _: None
) -> tuple[float, yaml.MarkedYAMLError | None]:
    """Return the line at which a text ceases to be right YAML, and why."""
    try:
        for node in yaml.compose_all(text, _Loader):
            check(node)
    except yaml.MarkedYAMLError as error:
        marks = [mark.line for mark in (error.context_mark, error.problem_mark) if mark]
        # What is opened and never closed is noticed at the end of the file.
        is_open = re.search(r"quoted scalar|simple key|flow (?:sequence|mapping)", error.context or "")
        return float(1 + (min if is_open else max)(marks, default=0)), error
    except (yaml.YAMLError, RecursionError):
        return 0, None
    return ALL, None


class _Usual:
    """What is usual in a file: its keys, its steps of indentation, its lines."""

    def __init__(self, text: str, vocabulary: Vocabulary) -> None:
        self.lines, self.inner = text.split("\n"), vocabulary.inner
        self.known = vocabulary.words
        entries = [_ENTRY.match(line) for line in self.lines]
        keys = [m["key"] for m in entries if m and m["key"] and re.match(r":(\s|$)", m["rest"])]
        self.words = {*self.known, *keys, *re.findall(r"[&*](\w+)", text)}
        self.dashes = sorted({match[0] for line in self.lines if (match := re.match(r"\s*- +", line))})
        steps = collections.Counter(_steps(self.lines)).most_common(1)
        self.step = steps[0][0] if steps else 2

    def oddness(self, text: str) -> float:
        """Return how little sense a text makes."""
        try:
            nodes = [*yaml.compose_all(text, _Loader)]
        except yaml.YAMLError:
            nodes = []
        odd = sum(self._oddness(node, "", {}) for node in nodes if node)
        return odd + sum(0.4 for step in _steps(text.split("\n")) if step != self.step)

    def _oddness(self, node: yaml.Node, above: str, seen: dict[int, float]) -> float:
        if id(node) in seen:
            return seen[id(node)]  # an alias
        seen[id(node)] = _ODD  # if it holds itself
        odd = self._of_node(node, above, seen)
        seen[id(node)] = 0
        return odd

    def _of_node(self, node: yaml.Node, above: str, seen: dict[int, float]) -> float:
        if isinstance(node, yaml.ScalarNode):
            return _of_scalar(node)
        if isinstance(node, yaml.SequenceNode):
            odd = sum(self._oddness(value, above, seen) for value in node.value)
            odd += _ODD * (len({*map(type, node.value)}) > 1)
            return odd + (0 if self.inner else _unlike(node.value))
        keys = [key.value if isinstance(key, yaml.ScalarNode) else None for key, _ in node.value]
        odd = sum(
            self._oddness(value, str(key), seen) for key, value in zip(keys, _values(node), strict=True)
        )
        known = self.inner.get(above)
        odd += sum(2 for key in keys if known is not None and key not in known)
        odd += _ODD * (len(keys) - len({*map(str, keys)}))
        odd += sum(_of_key(key) + 2 * (above != "" and str(key).startswith("/")) for key in keys)
        odd += bool(self.inner and known is None)
        return odd + (0 if self.inner else _unlike([*_values(node)]))


def _steps(lines: list[str]) -> Iterator[int]:
    """Yield how many spaces deeper than the key above it each line is that belongs to that key."""
    written = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    for above, line in itertools.pairwise(written):
        step = len(_indent(line)) - len(_indent(above))
        if step > 0 and not above.lstrip().startswith("-") and "\t" not in _indent(above) + _indent(line):
            yield step


def _values(node: yaml.Node) -> Iterator[yaml.Node]:
    yield from ((value for _, value in node.value) if isinstance(node, yaml.MappingNode) else node.value)


def _of_scalar(node: yaml.ScalarNode) -> float:
    if node.style in ("|", ">"):
        return 0
    odd = _ODD if node.start_mark.line != node.end_mark.line else 0.0
    if not node.style:
        odd += 2 * (not node.value)
        odd += 2 * bool(re.match(r"[\w./]+:(?!//)\S|-+[A-Za-z]|\w+ *= *\S", node.value))
        odd += 1 * bool(re.search(r"['\"\[\]{}]|[,;:]$", re.sub(r"\$\(.*?\)", "", node.value)))
    elif re.search(r"^[\[{]|[\]}]$", node.value):
        odd += 1
    elif re.search(r":\s|^\s|\s$", node.value):
        odd += 0.2
    return odd


def _of_key(key: str | None) -> float:
    if key is None:
        return _ODD
    return 2 * bool(re.search(r"[\s:='\"\[\]{},]|^-|\.$", key)) + _ODD * (not key)


def _unlike(nodes: list[yaml.Node]) -> float:
    """Return how much mappings that stand side by side differ in their keys, or in that some are none."""
    keys = [{str(key.value) for key, _ in node.value} for node in nodes if isinstance(node, yaml.MappingNode)]
    if len(keys) < 2 or len(keys) * 2 < len(nodes):
        return 0
    differ = 0.0
    usual, _ = collections.Counter(map(len, keys)).most_common(1)[0]
    for own in keys if max(map(len, keys)) > 1 else ():
        others = [other for other in keys if other is not own]
        differ += (
            abs(len(own) - usual) / 2
            + 1
            - max(len(own & other) / (len(own | other) or 1) for other in others)
        )
    return (len(nodes) - len(keys)) + differ / 4


def _slips(text: str, fault: yaml.MarkedYAMLError, usual: _Usual) -> Iterator[Slip]:
    lines = Lines(text)
    marks = [mark.line + 1 for mark in (fault.problem_mark, fault.context_mark) if mark]
    yield from _tabs(lines)
    yield from _foreign_comments(lines)
    near = [number for mark in marks for number in _around(lines, mark)]
    for number in dict.fromkeys([*near, *_apart(lines, near)]):
        far = min(abs(number - mark) for mark in marks) / 100
        for new, why, cost in _changes(lines[number], usual):
            yield lines.written(number, new, why, cost + far)
        yield from _moved(lines, number, usual.step, far)
        yield lines.removed(number, cost=far + RARE * (1 + bool(re.search(r"\w", lines[number]))))
        for rank, word in enumerate(usual.known if number in near[:3] else ()):
            for new in _heads(lines[number], word, usual):
                # The more words there are, the less speaks for any of them.
                cost = SELDOM - 0.1 + len(usual.known) / 50 + rank / 10_000 + far
                yield lines.added(number - 1, new, f"the line {word}: is missing", cost)
    yield from _entries(lines, near)


def _heads(line: str, word: str, usual: _Usual) -> Iterator[str]:
    """Yield what may stand on the line above another: a key, with or without a dash."""
    for column in dict.fromkeys((len(_indent(line)), max(len(_indent(line)) - usual.step, 0))):
        yield f"{' ' * column}{word}:"
    for dashed in usual.dashes:
        if len(dashed) < len(_indent(line)):
            yield f"{dashed}{word}:"


def _apart(lines: Lines, near: list[int]) -> Iterator[int]:
    """Yield lines far from a fault in which its slip may be: the first, those that name something, and those above."""
    written = [n for n, line in enumerate(lines.all, 1) if line.strip() and not line.lstrip().startswith("#")]
    yield from written[:1]
    yield from (n for n in written if re.search(r"&\w", lines[n]))
    depth = len(_indent(lines[near[0]])) if near else 0
    for number in (n for n in reversed(written) if near and n < near[0]):
        if len(_indent(lines[number])) <= depth:
            yield number
            depth = len(_indent(lines[number])) - 1


def _around(lines: Lines, number: int) -> Iterator[int]:
    """Yield the numbers of the lines with something on them around a line, the nearest first."""
    last = len(lines.all)
    written = [n for n in range(1, last + 1) if lines[n].strip() and not lines[n].lstrip().startswith("#")]
    above = [n for n in written if n <= number][-_NEAR - 1 :]
    yield from reversed(above)
    yield from [n for n in written if n > number][:_NEAR]


def _indent(line: str) -> str:
    return line[: len(line) - len(line.lstrip())]


def _tabs(lines: Lines) -> Iterator[Slip]:
    """Yield a text whose tabs at the beginnings of lines are spaces."""
    numbers = [n for n, line in enumerate(lines.all, 1) if "\t" in _indent(line)]
    if not numbers:
        return
    number, why = numbers[0], "there is a tab here, but YAML must be indented with spaces"
    indents = {len(_indent(line)) for line in lines.all if line.strip() and "\t" not in _indent(line)}
    for width in (2, 4):
        new = [
            _indent(line).expandtabs(width) + line.lstrip() if "\t" in _indent(line) else line
            for line in lines.all
        ]
        slip = lines.written(number, new[number - 1], why, USUAL - 0.2)
        told = f"{slip.told}{', and spaces instead of the tabs below it, too' if len(numbers) > 1 else ''}"
        yield Slip(number, told, "\n".join(new), slip.cost, why)
    beside = {
        len(_indent(lines[n]))
        for n in (number - 1, number + 1)
        if 0 < n <= len(lines.all) and lines[n].strip()
    }
    for indent in {*indents, *(indent + 2 for indent in indents)} if len(numbers) == 1 else ():
        cost = USUAL - 0.2 * (indent in beside)
        yield lines.written(number, " " * indent + lines[number].lstrip(), why, cost)


def _foreign_comments(lines: Lines) -> Iterator[Slip]:
    """Yield a text in which what other languages take for comments, such as a docstring of Python, is a comment."""
    new, blocks, number = lines.all.copy(), list[str](), 1
    while number <= len(new):
        body = lines[number].strip()
        begin = next((sign for sign in _COMMENTS if body.startswith(sign)), "")
        last = _end_of_comment(lines, number, begin) if begin else 0
        if last:
            blocks.append(lines_in_words(number, last))
            new[number - 1 : last] = [f"# {line}".rstrip() for line in lines.all[number - 1 : last]]
        number = max(number, last) + 1
    if blocks:
        first = int(blocks[0].split()[1])
        told = f"write # at the beginning of {' and of '.join(blocks)}"
        why = "YAML has no comments but those that begin with #"
        yield Slip(first, told, "\n".join(new), USUAL - 0.3, why)


def _end_of_comment(lines: Lines, number: int, begin: str) -> int:
    """Return the last line of a comment of another language; 0 if it does not end."""
    if not _COMMENTS[begin]:
        return number
    rest = lines[number].strip()[len(begin) :]
    texts = [rest, *lines.all[number:]]
    return next((number + n for n, text in enumerate(texts) if _COMMENTS[begin] in text), 0)


def _moved(lines: Lines, number: int, step: int, far: float) -> Iterator[Slip]:
    """Yield a text with a line, or it and those that belong to it, at another column."""
    line, was = lines[number], len(_indent(lines[number]))
    near = [lines[n] for n in _around(lines, number) if n != number]
    columns = {len(_indent(other)) for other in near}
    columns |= {len(other) - len(other.lstrip(" -")) for other in near}
    columns |= {column + step for column in columns} | {was - 2, was + 2, was - step, was + step, 0}
    below = number + 1
    while below <= len(lines.all) and (not lines[below].strip() or len(_indent(lines[below])) > was):
        below += 1
    why = "this line is not indented like the lines it belongs with"
    above = next((lines[n] for n in _around(lines, number) if n < number), "")
    usual = len(above) - len(above.lstrip(" -")) + step * above.rstrip().endswith(":")
    for column in sorted(column for column in columns if column >= 0 and column != was):
        new = " " * column + line.lstrip()
        cost = SELDOM - 0.3 + far + abs(column - was) / step / 20 - 0.1 * (column == usual)
        yield lines.written(number, new, why, cost)
        if any(other.strip() for other in lines.all[number : below - 1]):
            block = [
                " " * max(len(_indent(o)) + column - was, 0) + o.lstrip()
                for o in lines.all[number - 1 : below - 1]
            ]
            whole = "\n".join([*lines.all[: number - 1], *block, *lines.all[below - 1 :]])
            told = f"{lines.written(number, new).told}, and move the lines that belong to it likewise"
            yield Slip(number, told, whole, cost + 0.3, why)


_COLON = "the colon and the space after the name are missing"


def _entries(lines: Lines, near: list[int]) -> Iterator[Slip]:
    """Yield a text in which all of several lines side by side have the colon, or the space after it, that they lack."""
    first = [number for number in sorted(near) if _entry(lines[number])]
    for number in first:
        new = lines.all.copy()
        last = number
        while last <= len(lines.all) and (not lines[last].strip() or (entry := _entry(lines[last]))):
            new[last - 1] = entry if lines[last].strip() else ""
            last += 1
        if sum(1 for line in lines.all[number - 1 : last - 1] if line.strip()) > 1:
            slip = lines.written(number, new[number - 1])
            yield Slip(number, f"{slip.told}, and the lines below it likewise", "\n".join(new), USUAL, _COLON)


def _entry(line: str) -> str:
    """Return a line such as `p = 1` or `p:1` written as an entry; empty if it is one, or cannot be one."""
    match = re.match(r"(\s*(?:- *)?(?:[\w./]+|<<))(?:\s*=\s*|:|\s+)(?=\S)", line)
    return (
        "" if match is None or re.search(r":(\s|$)", line) else f"{match[1]}: {line[match.end() :].strip()}"
    )


def _changes(line: str, usual: _Usual) -> Iterator[tuple[str, str, float]]:
    """Yield a line with one slip undone, what was wrong, and what it costs."""
    body, indent = line.strip(), _indent(line)
    if re.fullmatch(r"[A-Za-z][^:=#\[\]{}]*", body) and len(body.split()) > _FEW_WORDS:
        yield f"{indent}# {body}", "a sentence needs a # before it", USUAL - 0.3
    if entry := _entry(line):
        yield entry, _COLON, USUAL
    for match in re.finditer(r"(?<=\w):(?=[^\s/])|^\s*-(?=[^\s-])|(?<=[^\s])(?<!:):(?=[&*'\"\[{])", line):
        yield (
            f"{line[: match.end()]} {line[match.end() :]}",
            f"the space after {match[0].strip()} is missing",
            USUAL,
        )
    yield f"{line.rstrip()}:", "the colon at the end is missing", USUAL
    for dashed in usual.dashes if not body.startswith("-") else ():
        cost = USUAL if abs(len(dashed) - len(indent)) <= 1 else RARE
        yield f"{dashed}{body}", "the dash of the list is missing", cost
    if body.startswith("- "):
        yield f"{indent}{body[2:].lstrip()}", "the dash does not belong here", RARE
    yield from _of_signs(line)
    yield from _quoted(line)
    for match in re.finditer(r"\w+|(?<!\S)[^\s:\w]+(?=:)", line):
        for word in difflib.get_close_matches(match[0], usual.words, n=2, cutoff=_ALIKE):
            if word != match[0]:
                new = line[: match.start()] + word + line[match.end() :]
                yield new, f"{match[0]} should be {word}", USUAL + 0.2


def _of_signs(line: str) -> Iterator[tuple[str, str, float]]:
    """Yield a line with a sign more, less or another."""
    for match in re.finditer(r"[^\w\s#]", line):
        begin, end = match.span()
        yield line[:begin] + line[end:], f"the sign {match[0]} does not belong here", SELDOM
        yield line[:end] + line[begin:], f"there should be two {match[0]}", USUAL + 0.3
        for sign in _SIGNS:
            if sign != match[0]:
                yield (
                    line[:begin] + sign + line[end:],
                    f"there should be {sign} instead of {match[0]}",
                    SELDOM + 0.2,
                )
    for place in sorted(
        {edge for match in re.finditer(r"[\w.]+|[^\w\s#]", line.partition(" #")[0]) for edge in match.span()}
    ):
        for sign in _SIGNS:
            if sign in _PAIRS or sign in _PAIRS.values():
                why = f"a {sign} is missing"
                yield line[:place] + sign + line[place:], why, USUAL + 0.2
            else:
                yield line[:place] + sign + line[place:], f"a {sign} is missing", SELDOM


def _quoted(line: str) -> Iterator[tuple[str, str, float]]:
    """Yield a line with quotes around its value, its key, or an item of its list."""
    why = "what has a special meaning in YAML needs quotes"
    for match in re.finditer(
        r"(?<=: )[^#]*[^#\s]|(?<=- )[^#:]*[^#:\s]|^[^\s:-][^:]*(?=:)|(?<=[\[,])\s*[^\[\],]+|(?<=\s)[^\s:]+(?=:)",
        line,
    ):
        value = match[0].strip()
        quote = "'" if "'" not in value else '"'
        if value and quote not in value:
            begin = match.start() + len(match[0]) - len(match[0].lstrip())
            yield f"{line[:begin]}{quote}{value}{quote}{line[begin + len(value) :]}", why, USUAL + 0.3
    for match in re.finditer(r"""(['"])(.*)\1""", line):
        other = "'" if match[1] == '"' else '"'
        if match[1] in match[2] and other not in match[2]:
            new = f"{line[: match.start()]}{other}{match[2]}{other}{line[match.end() :]}"
            yield new, f"the string contains a {match[1]}, which ends it too early", USUAL
