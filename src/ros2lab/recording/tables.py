"""What a recording or a recorder holds, as a table for the terminal or the notebook."""

from __future__ import annotations

import html
from collections.abc import Sequence


def counted(n: int, word: str) -> str:
    """Return a number with its noun, such as `2 topics`."""
    return f"{n:,} {word}" if n == 1 else f"{n:,} {word}s"


def size(n: float) -> str:
    """Return a number of bytes with a unit, such as `1.5 kB`."""
    for unit in ("bytes", "kB", "MB"):
        if n < 1000:
            return f"{n:.3g} {unit}"
        n /= 1000
    return f"{n:.3g} GB"


def text_table(headline: str, rows: Sequence[tuple[str, str, str]]) -> str:
    """Return a table of topics, types and numbers of messages as text."""
    table = [("topic", "type", "messages"), *rows]
    widths = [max(len(row[column]) for row in table) for column in range(3)]
    lines = [f"{name:<{widths[0]}}  {kind:<{widths[1]}}  {n:>{widths[2]}}" for name, kind, n in table]
    return "\n".join([headline, *lines])


def html_table(headline: str, rows: Sequence[tuple[str, str, str]]) -> str:
    """Return a table of topics, types and numbers of messages as HTML."""
    left, right = 'style="text-align:left"', 'style="text-align:right"'
    body = "".join(
        f'<tr><th scope="row" {left}>{html.escape(topic)}</th><td {left}>{html.escape(kind)}</td>'
        f"<td {right}>{n}</td></tr>"
        for topic, kind, n in rows
    )
    return (
        f'<table><caption {left}>{html.escape(headline)}</caption><thead><tr><th scope="col" {left}>topic</th>'
        f'<th scope="col" {left}>type</th><th scope="col" {right}>messages</th></tr></thead>'
        f"<tbody>{body}</tbody></table>"
    )
