"""The visible text of a page in reStructuredText, as docutils renders it."""

from __future__ import annotations

from collections.abc import Iterator

from docutils import nodes
from docutils.core import publish_doctree

from ros2lab.grading.reading.markdown import shown_math

# The text has no side effects: no file is read, and no report is written.
_SETTINGS = {
    "_disable_config": True,
    "file_insertion_enabled": False,
    "raw_enabled": True,
    "halt_level": 5,
    "report_level": 5,
    "smart_quotes": False,
    "syntax_highlight": "none",
    "warning_stream": False,
}
_NOT_SHOWN = (nodes.Special, nodes.meta)  # but a target within a line is shown


def shown(text: str) -> str:
    """Return the visible part of a text, with headlines and code marked as in Markdown.

    A text that cannot be rendered is returned unchanged.
    """
    try:
        document = publish_doctree(text, settings_overrides=dict(_SETTINGS))
    except Exception:  # whatever a directive stumbles over
        return text
    return "".join(_shown(document)).strip()


def _shown(node: nodes.Node) -> Iterator[str]:
    match node:
        case nodes.Text():
            yield node.astext()
        case nodes.title() | nodes.subtitle():
            yield f"# {node.astext()}\n\n"
        case nodes.math() | nodes.math_block():
            yield shown_math(node.astext())
        case nodes.literal_block() | nodes.doctest_block():
            yield f"```\n{node.astext()}\n```\n\n"
        case nodes.literal():
            yield f"`{node.astext()}`"
        case nodes.Element() if isinstance(node, nodes.target) or not isinstance(node, _NOT_SHOWN):
            for child in node.children:
                yield from _shown(child)
            if isinstance(node, nodes.TextElement) and not isinstance(node, nodes.Inline):
                yield "\n\n"
