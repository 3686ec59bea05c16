"""What all checks have in common."""

from __future__ import annotations

from ros2lab.checks import CheckError


def test_a_failed_check_shows_no_traceback() -> None:
    """In a notebook only the sentence is shown."""
    error = CheckError("a", "b", "c")
    assert error._render_traceback_() == [str(error)] == ["Not yet. Expected: a. Found: b. Hint: c"]


def test_a_sentence_has_one_full_stop() -> None:
    assert "Expected: 1, 2, ... Found: it is so. Hint" in str(CheckError("1, 2, ...", "it is so.", "c"))
