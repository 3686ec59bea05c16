"""What a notebook shows of an interrupt: one sentence, and no traceback through the lab's own code."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator


class Interrupted(KeyboardInterrupt):
    """The student has interrupted a call of the lab; the text says what was stopped, and what goes on."""

    def _render_traceback_(self) -> list[str]:
        # IPython shows this instead of a traceback.
        return [str(self)]


@contextlib.contextmanager
def interrupted_says(sentence: str) -> Iterator[None]:
    """Turn an interrupt into a sentence; the innermost one is kept.

    Args:
        sentence: what the interrupt means here.

    Raises:
        Interrupted: instead of a bare KeyboardInterrupt.
    """
    try:
        yield
    except Interrupted:
        raise
    except KeyboardInterrupt:
        raise Interrupted(f"Interrupted: {sentence}") from None
