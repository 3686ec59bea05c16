"""What a page shows of a text in Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from markdown_it import MarkdownIt
from markdown_it.token import Token

_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
# A tag without a value may be no tag: `ros2 run <package> <node>`.
_TAG = re.compile(r"<[^<>]*[=\"'/:!?][^<>]*>")
_ELEMENT = re.compile(r"<(/?)([a-zA-Z][\w-]*)(\s[^<>]*)?/?>")
# Those with a text; https://html.spec.whatwg.org/multipage/rendering.html#hidden-elements
_NEVER_SHOWN = frozenset(
    ("datalist", "head", "noembed", "noframes", "rp", "script", "style", "template", "title")
)
_HIDDEN = re.compile(r"\shidden(?![\w-])|display\s*:\s*none", re.IGNORECASE)
_PARSER = MarkdownIt("commonmark").enable("table")


def shown(text: str) -> str:
    """Return a text without what a page does not show.

    These are comments, elements that are hidden, values of tags, addresses and titles of links.
    Colours, sizes and positions hide nothing: GitHub shows a text without them, and leaves out styles and `<font>`.

    Headlines, code and its fences stay marked as they are.
    """
    return "".join(_blocks(_PARSER.parse(text))).strip()


def _blocks(tokens: Iterable[Token]) -> Iterator[str]:
    hidden = list[str]()
    for token in tokens:
        if token.type == "html_block":
            yield _without_tags(_seen(_COMMENT.sub("", token.content), hidden))
        if hidden:
            continue
        match token.type:
            case "heading_open":
                yield "# "
            case "inline":
                yield f"{''.join(_words(token.children or ()))}\n"
            case "fence" | "code_block":
                yield f"```\n{token.content}```\n"
            case "paragraph_close" | "heading_close":
                yield "\n"


def _words(tokens: Iterable[Token]) -> Iterator[str]:
    tokens, hidden = [*tokens], list[str]()
    ended = {
        match[2].lower() for token in tokens if (match := _ELEMENT.fullmatch(token.content)) and match[1]
    }
    for token in tokens:
        if token.type == "html_inline":
            tag = _ELEMENT.fullmatch(token.content)
            # What has no end in its paragraph may be no tag: `--ros-args -r __node:=<title>`.
            is_tag = tag is not None and tag[2].lower() in ended
            yield _without_tags(_seen(token.content, hidden) if is_tag else token.content)
        if hidden:
            continue
        match token.type:
            case "text":
                yield token.content
            case "code_inline":
                yield f"`{token.content}`"
            case "softbreak" | "hardbreak":
                yield "\n"


def _seen(text: str, hidden: list[str]) -> str:
    """Return what some HTML shows.

    Args:
        text: of the page, in order.
        hidden: the names of the element that is open and not shown, and of those like it in it; is kept up to date.
    """
    seen, start = "", 0
    for tag in _ELEMENT.finditer(text):
        was_shown = not hidden
        is_end, name = bool(tag[1]), tag[2].lower()
        is_never_shown = name in _NEVER_SHOWN or bool(_HIDDEN.search(tag[3] or ""))
        if is_end and name in hidden:
            hidden.pop()
        elif not is_end and (name in hidden or (was_shown and is_never_shown)):
            hidden.append(name)
        if was_shown:
            seen += text[start : tag.start() if hidden else tag.end()]
        start = tag.end()
    return seen if hidden else seen + text[start:]


def _without_tags(text: str) -> str:
    return _TAG.sub("", _COMMENT.sub("", text))
