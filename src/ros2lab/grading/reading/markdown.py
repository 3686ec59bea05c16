"""The part of a Markdown text that its page shows."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from markdown_it import MarkdownIt
from markdown_it.token import Token

_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
# A tag without a value may be no tag: `ros2 run <package> <node>`.
_TAG = re.compile(r"<[^<>]*[=\"'/:!?][^<>]*>")
_ELEMENT = re.compile(r"<(/?)([a-zA-Z][\w-]*)(\s[^<>]*)?/?>")
# Hidden elements with text: https://html.spec.whatwg.org/multipage/rendering.html#hidden-elements
_NEVER_SHOWN = frozenset(
    ("datalist", "head", "noembed", "noframes", "rp", "script", "style", "template", "title")
)
# The elements whose text every page shows: those that GitHub keeps, and those that divide a page. The text of
# others is shown in other ways, such as after a click, or where they are not supported.
_SHOWN = frozenset((
    "a", "abbr", "address", "article", "aside", "b", "bdo", "blockquote", "body", "br", "caption", "center",
    "cite", "code", "dd", "details", "dfn", "div", "dl", "dt", "em", "figcaption", "figure", "font", "footer",
    "h1", "h2", "h3", "h4", "h5", "h6", "header", "hr", "html", "i", "img", "ins", "kbd", "li", "main", "mark",
    "nav", "ol", "p", "picture", "pre", "q", "rb", "rt", "rtc", "ruby", "samp", "section", "small", "source",
    "span", "strong", "sub", "summary", "sup", "table", "tbody", "td", "tfoot", "th", "thead", "time", "tr",
    "tt", "u", "ul", "var", "wbr",
))  # fmt: skip
_FOOTNOTE = re.compile(r"\[\^([^\]\s]+)\]")
_NOTE = re.compile(r"^ {0,3}\[\^([^\]\s]+)\]:[ \t]*", re.MULTILINE)  # where one begins
_INDENT = re.compile(r"^(?: {1,4}|\t)")  # of what else belongs to one
_HIDDEN = re.compile(r"\shidden(?![\w-])|display\s*:\s*none", re.IGNORECASE)
# What TeX's commands and comments leave to be seen is not followed; math without them shows its letters.
_MATH = re.compile(r"(?<![\w$`])(?:\$\$.*?\$\$|\$`.*?`\$|\$(?=\S)[^$\n]*(?<=\S)\$)(?![\w$])", re.DOTALL)
_TEX = re.compile(r"\\[a-zA-Z]|%")
_DRAWN = ("geojson", "topojson", "stl")  # by GitHub, besides mermaid and math: a map or a solid, and no text
_PARSER = MarkdownIt("commonmark").enable(["table", "strikethrough"])
_PARAGRAPHS = MarkdownIt("commonmark").disable("reference")


def shown(text: str) -> str:
    """Return a text without what its page does not show.

    These are comments, hidden elements, what is struck out, attributes of tags, and the addresses and titles of links. Colours,
    sizes and positions hide nothing: GitHub shows a text without them, and leaves out styles and `<font>`.

    Headlines, code and code fences keep their marks.
    """
    return "".join(_blocks(_PARSER.parse(_with_notes_below(text)))).strip()


def _with_notes_below(text: str) -> str:
    """Return a text with its footnotes below, and without those that nothing refers to, as GitHub shows it.

    There, what refers to one may be a footnote, too, or itself.
    """
    inline = [token for token in _PARAGRAPHS.parse(text) if token.type == "inline"]
    used = {name for token in inline for name in _FOOTNOTE.findall(_NOTE.sub("", token.content))}
    rows = [range(*token.map) for token in inline if token.map]
    ends = {number: row.stop for row in rows for number in row}
    body, notes, own, end = list[str](), dict[str, list[str]](), list[str](), 0
    for number, line in enumerate(text.splitlines()):
        begun = _NOTE.match(line) if number in ends else None
        if begun:
            own, end = notes.setdefault(begun[1], []), ends[number]
            own += ["", line[begun.end() :]]
        elif end and (number < end or not line.strip() or _INDENT.match(line)):
            own.append(_INDENT.sub("", line))
        else:
            end = 0
            body.append(line)
    return "\n".join([*body, *(line for name in notes if name in used for line in notes[name])])


def _blocks(tokens: Iterable[Token]) -> Iterator[str]:
    tokens = [*tokens]
    page = _Page(
        inner.content for token in tokens for inner in (token, *(token.children or ())) if _is_html(inner)
    )
    for token in tokens:
        if token.type == "html_block":
            yield _without_tags(page.seen(_COMMENT.sub("", token.content)))
        elif token.type == "inline":
            words = _MATH.sub(lambda math: shown_math(math[0]), "".join(_words(token.children or (), page)))
            yield f"{words}\n"
        elif not page.is_hidden:
            match token.type:
                case "heading_open":
                    yield "# "
                case "fence" | "code_block":
                    yield _fenced(token.info.split()[:1], token.content)
                case "paragraph_close" | "heading_close":
                    yield "\n"


def _is_html(token: Token) -> bool:
    return token.type in ("html_block", "html_inline")


def _fenced(info: Sequence[str], content: str) -> str:
    """Return what a page shows of a fence: code, or what it draws."""
    match info:
        case ["mermaid"]:
            return "".join(line for line in content.splitlines(True) if "%%" not in line)
        case ["math"]:
            return shown_math(content)
        case [kind] if kind in _DRAWN:
            return ""
    return f"```\n{content}```\n"


def shown_math(text: str) -> str:
    """Return what a page shows of math, as far as that is known."""
    return "" if _TEX.search(text) else text


def _words(tokens: Iterable[Token], page: _Page) -> Iterator[str]:
    struck = 0
    for token in tokens:
        if token.type == "html_inline":
            tag = _ELEMENT.fullmatch(token.content)
            is_tag = tag is not None and page.is_element(tag)
            yield _without_tags(
                page.seen(token.content) if is_tag else "" if page.is_hidden else token.content
            )
        struck += {"s_open": 1, "s_close": -1}.get(token.type, 0)
        if page.is_hidden or struck:
            continue
        match token.type:
            case "text":
                yield token.content
            case "code_inline":
                yield f"`{token.content}`"
            case "softbreak" | "hardbreak":
                yield "\n"


class _Page:
    """Which of a page's elements are open, wherever they begin and end: a paragraph ends none of them.

    Args:
        texts: all HTML of the page.
    """

    def __init__(self, texts: Iterable[str]) -> None:
        # The name of the open element that is not shown, once per nested element of this name.
        self._hidden: list[str] = []
        self._ends = Counter(
            tag[2].lower() for text in texts for tag in _ELEMENT.finditer(_COMMENT.sub("", text)) if tag[1]
        )  # that are still to come

    @property
    def is_hidden(self) -> bool:
        """Whether what comes next is not shown."""
        return bool(self._hidden)

    def is_element(self, tag: re.Match[str]) -> bool:
        """Return whether a tag in a text begins or ends an element; else it may be none: `-r __node:=<title>`."""
        return self._ends[tag[2].lower()] > 0

    def seen(self, text: str) -> str:
        """Return what is shown of the page's next HTML."""
        seen, start = "", 0
        for tag in _ELEMENT.finditer(text):
            was_shown = not self._hidden
            is_end, name = bool(tag[1]), tag[2].lower()
            is_other = name not in _SHOWN and self.is_element(tag)
            is_never_shown = name in _NEVER_SHOWN or is_other or bool(_HIDDEN.search(tag[3] or ""))
            self._ends[name] -= is_end
            if is_end and name in self._hidden:
                self._hidden.pop()
            elif not is_end and (name in self._hidden or (was_shown and is_never_shown)):
                self._hidden.append(name)
            if was_shown:
                seen += text[start : tag.start() if self._hidden else tag.end()]
            start = tag.end()
        return seen if self._hidden else seen + text[start:]


def _without_tags(text: str) -> str:
    return _TAG.sub("", _COMMENT.sub("", text))
