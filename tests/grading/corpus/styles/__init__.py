"""Legitimate ways to solve the assignment and to hand it in, and what is hardly a solution at all."""

from __future__ import annotations

from corpus.case import Case
from corpus.styles.beside import BESIDE
from corpus.styles.elsewhere import ELSEWHERE
from corpus.styles.forms import EXTREMES, FORMS
from corpus.styles.nodes import WAYS_OF_WRITING

STYLES: tuple[Case, ...] = (*FORMS, *WAYS_OF_WRITING, *ELSEWHERE, *BESIDE)

__all__ = ["EXTREMES", "STYLES"]
