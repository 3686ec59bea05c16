"""A row is named so that it cannot be taken for somebody else's."""

from __future__ import annotations

from pathlib import Path

import pytest

from ros2lab.classroom import grading
from ros2lab.classroom.handed_in import HandedIn, as_one_name, called
from ros2lab.grading.senses import seen


@pytest.mark.parametrize(
    ("others", "name"),
    [
        ({"1002": "Bob"}, "Anna Maier"),
        ({"1002": "Anna Meier"}, "Anna Maier"),
        ({"1002": "Anna"}, "Anna Maier"),
        ({}, "Anna Maier"),
        ({"1002": "Anna Maier"}, "Anna Maier (1006)"),
        ({"1002": "anna maier"}, "Anna Maier (1006)"),
        ({"1002": "Anna  Maier"}, "Anna Maier (1006)"),
        ({"1002": "Anna\u200b Maier"}, "Anna Maier (1006)"),
        ({"1002": "Änna Maier", "1003": "Anna Maier"}, "Anna Maier (1006)"),
    ],
)
def test_a_name_that_two_have_is_shown_with_the_id(others: dict[str, str], name: str) -> None:
    rows = [HandedIn("1006", "Anna Maier"), *(HandedIn(key, other) for key, other in others.items())]
    names = called(rows)
    assert names["1006"] == name
    assert len({as_one_name(seen(shown)) for shown in names.values()}) == len(rows)


def test_nobody_gives_himself_the_id_of_another() -> None:
    names = called([HandedIn("1002", "Anna Maier"), HandedIn("1006", "Anna Maier (1002)")])
    assert names == {"1002": "Anna Maier", "1006": "Anna Maier (1002) (1006)"}


@pytest.mark.parametrize("other", ["a\u0308nna", "\xe4nna\u200b", "\xc4nna"])
def test_folders_that_look_alike_are_told_apart(other: str) -> None:
    """Their names are their keys."""
    names = called([HandedIn("\xe4nna", "\xe4nna"), HandedIn(other, other)])
    assert len({as_one_name(seen(shown)) for shown in names.values()}) == 2


@pytest.mark.parametrize("is_only", [True, False])
def test_a_note_accuses_nobody_by_a_name_that_two_have(tmp_path: Path, is_only: bool) -> None:
    """Also where only some of the class are graded."""
    rows = []
    for key, name, text in (
        ("1002", "Anna Maier", "her own"),
        ("1006", "Anna Maier", "x"),
        ("1007", "Oscar", "x"),
    ):
        path = tmp_path / key
        path.write_text(text)
        rows.append(HandedIn(key, name, key, paths=(path,)))
    found = {row.key: row.notes for row, *_ in grading.identified(rows[1:] if is_only else rows, rows)}
    assert found["1007"] == ("It is, byte for byte, what Anna Maier (1006) has handed in.",)
    assert found["1006"] == ("It is, byte for byte, what Oscar has handed in.",)
    assert not found.get("1002")
