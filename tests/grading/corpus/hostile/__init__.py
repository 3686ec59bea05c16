"""Submissions that mean harm, or lie for points: none does harm, and none gets more than it deserves. Never run these outside the sandbox."""

from __future__ import annotations

from corpus.case import Case
from corpus.hostile.archives import LEADING_OUT, TOO_MUCH, UNREADABLE
from corpus.hostile.gates import GATES
from corpus.hostile.programs import HARM, LIES, SPAM, WORDS

HOSTILE: tuple[Case, ...] = (*HARM, *SPAM, *LIES, *GATES, *WORDS, *LEADING_OUT, *TOO_MUCH, *UNREADABLE)
