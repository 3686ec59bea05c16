"""The visible text of a page in AsciiDoc or Org, for which we keep no library: all that is not hidden.

Headlines, lists and code stay as written, which reads much like Markdown.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping

# AsciiDoc: https://docs.asciidoctor.org/asciidoc/latest; a block begins and ends with the same line.
_FENCE = re.compile(r"(?:-{4,}|={4,}|\*{4,}|_{4,}|\.{4,}|/{4,}|\+{4,}|--)$")
_VERBATIM = ("--", "..", "//", "++")  # fences of blocks in which no other markup has a meaning
_LEFT_OUT = ("[comment", "[pass", "[stem", "[latexmath", "[asciimath")  # blocks that are no text of the page
_ATTRIBUTE = re.compile(r":(!?[\w-]+!?):(?:\s+(.*))?$")
_CONDITION = re.compile(r"(ifn?def|ifeval)::([^\[]*)\[(.*)\]$")
_OF_THE_PAGE = re.compile(
    r"(?:env|backend|basebackend|doctype|safe-mode|asciidoctor)\b"
)  # set by the program that shows the page
_REFERENCE = re.compile(r"\{([\w-]+)\}")

# Org: https://orgmode.org/manual
_HEADLINE = re.compile(r"(\*+)[ \t]+(COMMENT\b)?.*?([ \t]+:[\w@:]*\b(?:noexport|ARCHIVE)\b[\w@:]*:[ \t]*)?$")
_BLOCK = re.compile(
    r"[ \t]*#\+begin_(comment|export)\b.*?(?:^[ \t]*#\+end_\1\b[^\n]*|\Z)", re.M | re.S | re.I
)
# Code, with what says of it, or of all code below, what is exported.
_CODE = re.compile(
    r"(?P<said>(?:^[ \t]*#\+headers?:.*\n)*^[ \t]*#\+begin_src\b.*$)(?s:.*?)(?:^[ \t]*#\+end_src\b.*$|\Z)"
    r"|src_\w+(?P<given>\[.*?\])\{.*?\}"
    r"|header-args\S*(?P<below>.*)",
    re.M | re.I,
)
_EXPORTS = re.compile(r":exports[ \t]+(\w+)", re.I)
_SNIPPET = re.compile(r"@@[\w-]+:(?s:.*?)@@")  # for one kind of page alone
_DRAWER = re.compile(r"^[ \t]*:[\w-]+:[ \t]*$.*?(?:^[ \t]*:end:[ \t]*$|\Z)", re.M | re.S | re.I)
_KEYWORD = re.compile(r"^[ \t]*#(?:\+(?!title:)\w+(?:\[.*\])?:.*|[ \t].*)?$", re.M | re.I)


def shown(text: str, kind: str) -> str:
    """Return the visible part of a text, by its suffix, such as `.org`; all of it for other formats."""
    lines = _READERS.get(kind, str.splitlines)(text)
    return "\n".join(lines).strip()


def _of_asciidoc(text: str) -> Iterator[str]:
    attributes, last = dict[str, str](), ""
    fence, is_left_out = "", False  # of the block that is open
    for line in _under_conditions(text, attributes):
        before, last = last, line
        if fence:
            is_end = line == fence
            if not is_left_out:
                yield line
            fence, is_left_out = ("", False) if is_end else (fence, is_left_out)
        elif (
            _FENCE.match(line)
            and (is_left_out or (line[:2] in _VERBATIM and line != "--"))
            and not _underlines(line, before)
        ):
            fence, is_left_out = line, is_left_out or line[0] in "/+"
            if not is_left_out:
                yield line
        elif given := _ATTRIBUTE.match(line):
            attributes[given[1]] = _with(attributes, given[2] or "")
        else:
            is_left_out = bool(line) and (is_left_out or line.startswith(_LEFT_OUT))
            if not is_left_out and not line.startswith("//"):
                yield _with(attributes, line)


def _with(attributes: Mapping[str, str], text: str) -> str:
    return _REFERENCE.sub(lambda match: attributes.get(match[1], match[0]), text)


def _under_conditions(text: str, attributes: Mapping[str, str]) -> Iterator[str]:
    """Yield the lines whose conditions all hold, as far as attributes are known at that line."""
    open_conditions = list[bool]()
    for line in map(str.rstrip, text.splitlines()):
        if condition := _CONDITION.match(line):
            name, word, inner = condition.groups()
            holds = name != "ifeval" and _holds(name, word, attributes)
            if name == "ifeval" or not inner:
                open_conditions.append(holds)
            elif holds and all(open_conditions):
                yield inner
        elif line.startswith("endif::"):
            del open_conditions[-1:]
        elif all(open_conditions):
            yield line


def _underlines(line: str, before: str) -> bool:
    """Return whether a line underlines the line before it as a headline."""
    return bool(before) and abs(len(line) - len(before)) < 2 and line[0] not in "/+"


def _holds(name: str, word: str, attributes: Mapping[str, str]) -> bool:
    is_set = any(
        attribute in attributes or _OF_THE_PAGE.match(attribute) for attribute in re.split("[,+]", word)
    )
    return is_set if name == "ifdef" else word not in attributes


def _of_org(text: str) -> Iterator[str]:
    hidden = 0  # the level of the headline below which nothing is shown
    shown = _KEYWORD.sub("", _DRAWER.sub("", _exported(_SNIPPET.sub("", _BLOCK.sub("", text)))))
    for line in shown.splitlines():
        if headline := _HEADLINE.match(line):
            level = len(headline[1])
            if not hidden or level <= hidden:
                hidden = level if headline[2] or headline[3] else 0
        if not hidden:
            yield line


def _exported(text: str) -> str:
    """Return a text in Org without the code that is not exported."""
    of_all = ""  # what was said last of all code below

    def left(code: re.Match[str]) -> str:
        nonlocal of_all
        of_all = code["below"] or of_all
        said = _EXPORTS.findall(f"{of_all} {code['said'] or code['given'] or ''}")
        return "" if code["below"] is None and said and said[-1].lower() in ("none", "results") else code[0]

    return _CODE.sub(left, text)


_READERS: Mapping[str, Callable[[str], Iterator[str] | list[str]]] = {
    ".adoc": _of_asciidoc,
    ".asciidoc": _of_asciidoc,
    ".org": _of_org,
}
