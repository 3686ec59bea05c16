"""What a page shows of a text in Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from markdown_it import MarkdownIt
from markdown_it.token import Token

_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
# A tag without a value may be no tag: `ros2 run <package> <node>`.
_TAG = re.compile(r"<[^<>]*[=\"'/:!?][^<>]*>")
_PARSER = MarkdownIt("commonmark").enable("table")


def shown(text: str) -> str:
    """Return a text without what a page does not show: comments, values of tags, addresses and titles of links.

    Headlines, code and its fences stay marked as they are.
    """
    return "".join(_blocks(_PARSER.parse(text))).strip()


def _blocks(tokens: Iterable[Token]) -> Iterator[str]:
    for token in tokens:
        match token.type:
            case "heading_open":
                yield "# "
            case "inline":
                yield f"{''.join(_words(token.children or ()))}\n"
            case "fence" | "code_block":
                yield f"```\n{token.content}```\n"
            case "html_block":
                yield _without_tags(token.content)
            case "paragraph_close" | "heading_close":
                yield "\n"


def _words(tokens: Iterable[Token]) -> Iterator[str]:
    for token in tokens:
        match token.type:
            case "text":
                yield token.content
            case "code_inline":
                yield f"`{token.content}`"
            case "html_inline":
                yield _without_tags(token.content)
            case "softbreak" | "hardbreak":
                yield "\n"


def _without_tags(text: str) -> str:
    return _TAG.sub("", _COMMENT.sub("", text))
