"""A table, as a notebook and a terminal show it."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence


class Table:
    """Rows with a head, shown as a table in a notebook and as text elsewhere."""

    def __init__(self, head: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
        self.head = tuple(head)
        self.rows = [tuple(str(cell) for cell in row) for row in rows]

    def markdown(self) -> str:
        """Return it as Markdown."""
        lines = [self.head, tuple("---" for _ in self.head), *self.rows]
        return "\n".join(
            "| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines
        )

    def __repr__(self) -> str:
        widths = [max(map(len, column)) for column in zip(self.head, *self.rows, strict=True)]
        lines = ("  ".join(map(str.ljust, line, widths)).rstrip() for line in (self.head, *self.rows))
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        def line(cells: Sequence[str], kind: str) -> str:
            style = 'style="text-align: left"'
            return "<tr>" + "".join(f"<{kind} {style}>{html.escape(c)}</{kind}>" for c in cells) + "</tr>"

        return f"<table>{line(self.head, 'th')}{''.join(line(row, 'td') for row in self.rows)}</table>"
