"""Whom a word means in a decision: nobody is taken silently for somebody else."""

from __future__ import annotations

import pytest

from ros2lab.classroom.decisions import row_of
from ros2lab.classroom.gradebook import Row
from ros2lab.classroom.handed_in import ClassError, HandedIn

ROWS = [
    Row(HandedIn(key, name, student_id, email), "", "graded", "", None, 1, "", 1.0)
    for key, name, student_id, email in (
        ("1001", "Anna Maier", "1001", "anna@uni.de"),
        ("1002", "anna@uni.de", "1002", "eve@uni.de"),
        ("1003", "Ben Berg", "1003", ""),
        ("1004", "Cy Chen", "1004", "1003"),
        ("1005 (a.zip)", "Dora Dahl", "1005", ""),
        ("1005 (b.zip)", "Dora Dahl", "1005", ""),
        ("1006", "A\u0308nna  Ott", "1006", ""),
        ("1007", "\u00c4nna Ott\u200b", "1007", ""),
    )
]


@pytest.mark.parametrize(
    ("word", "keys"),
    [
        ("1001", ["1001"]),
        ("1003", ["1003"]),  # what an error shows in brackets is asked about no more
        ("Ben", ["1003"]),
        ("anna@uni.de", ["1001", "1002"]),
        ("1005", ["1005 (a.zip)", "1005 (b.zip)"]),
        ("1005 (b.zip)", ["1005 (b.zip)"]),
        ("Dora Dahl", ["1005 (a.zip)", "1005 (b.zip)"]),
        ("ANNA@UNI.DE", ["1001", "1002"]),
        (" anna@uni.de ", ["1001", "1002"]),
        ("Anna\u200b  maier", ["1001"]),
        ("\u00e4nna ott", ["1006", "1007"]),
        ("A\u0308nna  Ott", ["1006", "1007"]),
        ("\uff11\uff10\uff10\uff13", ["1003", "1004"]),
        ("\u200b", []),
        ("nobody", []),
        ("", []),
    ],
)
def test_a_word_means_one_student_or_is_asked_about(word: str, keys: list[str]) -> None:
    if len(keys) == 1:
        assert row_of(word, ROWS).handed.key == keys[0]
        return
    with pytest.raises(ClassError) as error:
        row_of(word, ROWS)
    assert [row.handed.key for row in ROWS if f"({row.handed.key})" in str(error.value)] == keys
