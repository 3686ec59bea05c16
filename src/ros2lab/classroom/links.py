"""Links in a notebook that was handed in: one that could run something is shown as it was written.

nbconvert cleans what is HTML in a cell, and makes links of Markdown and of formulas only afterwards.
"""

from __future__ import annotations

import re
from html.parser import HTMLParser
from typing import Any
from urllib.parse import urlsplit

from nbconvert.filters.markdown_mistune import InvalidNotebook, IPythonRenderer, MarkdownWithMath

HARMLESS = frozenset(("", "http", "https", "mailto", "attachment"))
PICTURES = frozenset(("image/png", "image/jpeg", "image/gif"))
_LEADS_ON = re.compile(r"\\href\b")  # the one command by which MathJax makes a link
_PICTURE = re.compile(r"data:image/(png|jpeg|gif);base64,")
_BASE64 = re.compile(r"[A-Za-z0-9+/=\s]*")
_FENCE = re.compile("`+")


def disarm(cell: Any) -> None:
    """Show a cell of Markdown as text if a link of it leads to something else than a page; keep only its pictures."""
    if cell.cell_type != "markdown":
        return
    attachments = cell.get("attachments", {})
    for name, kinds in [*attachments.items()]:
        if not all(kind in PICTURES and _BASE64.fullmatch(str(data)) for kind, data in kinds.items()):
            del attachments[name]
    if _leads_elsewhere(cell.source, attachments):
        fence = "`" * (max(map(len, _FENCE.findall(cell.source)), default=2) + 3)
        cell.source = f"{fence}text\n{cell.source}\n{fence}"


def _leads_elsewhere(source: str, attachments: Any) -> bool:
    renderer = IPythonRenderer(escape=False, attachments=attachments)
    try:
        page = MarkdownWithMath(renderer=renderer).render(source)
    except InvalidNotebook:  # a picture is not there, and nbconvert would make no page of the notebook
        return True
    links = _Links()
    links.feed(page)
    links.close()
    return bool(_LEADS_ON.search(links.text)) or not links.schemes <= HARMLESS


class _Links(HTMLParser):
    """The schemes of what a page leads to or loads, and its text, of which MathJax makes formulas."""

    def __init__(self) -> None:
        super().__init__()
        self.schemes: set[str] = set()
        self.text = ""

    def handle_data(self, data: str) -> None:
        self.text += data

    def handle_starttag(self, _tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("href", "src") and not _PICTURE.match(value or ""):
                try:
                    self.schemes.add(urlsplit((value or "").strip()).scheme)
                except ValueError:  # no address at all
                    self.schemes.add("?")
