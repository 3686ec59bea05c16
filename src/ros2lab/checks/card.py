"""What a notebook shows of a check: a card that is green for right and amber for not yet, and says so in words.

The text beside it is for terminals, for screen readers and for whoever compares a run with another one.
"""

from __future__ import annotations

import html
import re
from collections.abc import Sequence

# Okabe and Ito's green and orange, which colour-blind people tell apart.
GREEN, ORANGE = "#009e73", "#e69f00"
# Each is for one release of MathJax, for which $base … $base is a formula.
NO_FORMULA = "mathjax_ignore tex2jax_ignore"
OUTPUT_CLASS = "ros2lab-refusal"

_RULE = "1px solid var(--jp-border-color2, #ddd)"
_MONO = "font-family:var(--jp-code-font-family, monospace);font-size:var(--jp-code-font-size, 13px)"
_BOX = f"border:{_RULE};border-radius:4px;background:var(--jp-layout-color1, transparent);padding:2px 8px"
_WRAP = "white-space:pre-wrap;overflow-wrap:anywhere;line-height:1.5"
_ASIDE = "margin:6px 0 0"
_OWN_KEYS = 'data-lm-suppress-shortcuts="true"'  # Enter opens it, and not JupyterLab's cell

# The error itself stays in the notebook for programs that read it; beside the card it would say all of it again.
_NO_ERROR_BELOW = (
    f"<style>.jp-OutputArea-child:has(.{OUTPUT_CLASS}) + .jp-OutputArea-child"
    ':has([data-mime-type="application/vnd.jupyter.stderr"]){display:none}</style>'
)


class Praise(str):
    """The praise for a right answer: a text, which a notebook shows as a green card."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        word, end, said = re.fullmatch(r"(Right)?([:.,]?)(.*)", self, re.DOTALL).groups()  # type: ignore[union-attr]
        head = _head(GREEN, "✔", f"{word or 'Right'}{end if word else ':'}")
        return _card(GREEN, f'<div style="{_WRAP}">{head}{inline(said if word else f" {said}")}</div>')


def refusal(expected: str, found: str, hints: Sequence[str], told: int, solution: Sequence[str]) -> str:
    """Return the amber card of an answer that is not right yet, as HTML.

    Args:
        expected: what a right answer does or is.
        found: what this one does or is.
        hints: in their order.
        told: how many of them are shown; a click shows each of the others.
        solution: the cells of the worked solution that a click shows; none if it is not offered.
    """
    names = [
        f"Hint {number} of {len(hints)}" if len(hints) > 1 else "Hint" for number in range(1, len(hints) + 1)
    ]
    rows = [("Expected", _prose(expected)), ("Found", _found(found))]
    rows += [(name, _prose(hint)) for name, hint in zip(names[:told], hints[:told], strict=True)]
    body = "".join(f"<b>{name}</b>{shown}" for name, shown in rows)
    grid = "display:grid;grid-template-columns:max-content minmax(0, 1fr);gap:4px 12px;align-items:baseline"
    head = _head(ORANGE, "↻", "Not yet")
    body = f'<div style="margin:0 0 4px">{head}</div><div style="{grid}">{body}</div>'
    body += _folded_hints(list(zip(names, hints, strict=True))[told:])
    if solution:
        body += _offer(solution)
    return f'<div class="{OUTPUT_CLASS}">{_NO_ERROR_BELOW}{_card(ORANGE, body)}</div>'


def inline(text: str) -> str:
    """Return a text as HTML, with what stands between backticks as code."""
    parts = html.escape(text).split("`")
    if len(parts) % 2 == 0:  # one of them belongs to nothing
        return html.escape(text)
    return "".join(
        f'<code style="{_MONO}">{part}</code>' if number % 2 else part for number, part in enumerate(parts)
    )


def _card(colour: str, body: str) -> str:
    style = (
        f"box-sizing:border-box;border:{_RULE};border-left:5px solid {colour};border-radius:6px;padding:8px 12px;margin:4px 0;"
        "max-width:56em;color:var(--jp-content-font-color1, inherit);background:var(--jp-layout-color0, transparent)"
    )
    return f'<div role="note" class="{NO_FORMULA}" style="{style}">{body}</div>'


def _head(colour: str, icon: str, word: str) -> str:
    style = (
        "display:inline-block;width:1.5em;height:1.5em;line-height:1.5em;border-radius:50%;margin-right:0.5em;"
        f"background:{colour};color:#000;text-align:center"
    )
    return f'<span aria-hidden="true" style="{style}">{icon}</span><b>{word}</b>'


def _prose(text: str) -> str:
    return f'<span style="{_WRAP}">{inline(text)}</span>'


def _found(text: str) -> str:
    """Return what was found in a box; what a program or a file says, in the letters of code."""
    is_code = "\n" in text or re.fullmatch(r"['\"(\[{<].*", text) is not None
    letters = f";{_MONO}" if is_code else ""
    return f'<div style="{_BOX};{_WRAP}{letters}">{html.escape(text) if is_code else inline(text)}</div>'


def _folded_hints(hints: Sequence[tuple[str, str]]) -> str:
    """Return each hint inside the one before it, so that a click shows one more."""
    folded = ""
    for name, hint in reversed(hints):
        folded = (
            f'<details style="{_ASIDE}"><summary {_OWN_KEYS}><b>{name}</b></summary>'
            f'<div style="padding-left:1.2em">{_prose(hint)}{folded}</div></details>'
        )
    return folded


def _offer(cells: Sequence[str]) -> str:
    """Return the worked solution, folded."""
    shown = "".join(
        f'<pre style="{_BOX};{_MONO};white-space:pre-wrap;margin:6px 0;padding:6px 8px">{html.escape(cell)}</pre>'
        for cell in cells
    )
    return (
        f'<details style="{_ASIDE}"><summary {_OWN_KEYS}><b>Show a worked solution</b> (you have seen all hints)</summary>'
        f'<div style="padding-left:1.2em">Compare it with yours, find the difference, and run the check again.'
        f"{shown}</div></details>"
    )
