"""The page about a class: what it says, and that nothing in it does anything."""

from __future__ import annotations

import base64
import hashlib
import re
from functools import partial
from pathlib import Path

from ros2lab import course
from ros2lab.classroom import report
from ros2lab.classroom.gradebook import Row, Seen, opened
from ros2lab.classroom.handed_in import HandedIn
from ros2lab.classroom.judging import Judging
from ros2lab.classroom.similarity import Line, Shared
from ros2lab.grading.collect import nothing
from ros2lab.grading.evidence_json import evidence_json
from ros2lab.grading.questions import QUESTIONS

HOSTILE = "</td><script>alert(1)</script>\"'\u202e\x1b[2J"


def test_the_page_escapes_names_and_sources_and_runs_only_its_own_script(tmp_path: Path) -> None:
    source = "\n".join(
        f"def f{n}(a, b):\n    return [x ** {n} + b for x in a if x != {n}]  # </pre><script>"
        for n in range(40)
    )
    rows = [
        HandedIn("1", HOSTILE, HOSTILE, paths=(Path("a"),), is_late=True, notes=(HOSTILE,)),
        HandedIn("2", "Bob", "2", paths=(Path("b"),)),
        HandedIn("3", "Cy", "3", reason=f"It is empty. {HOSTILE}"),
    ]
    evidence = evidence_json(nothing(tmp_path / "a.zip", HOSTILE))
    with opened(tmp_path, is_new_allowed=True) as book:
        by = Judging.of(None, None, {})
        book.register([(row, f"d{row.key}", 0) for row in rows])
        for row in rows[:2]:
            seen = Seen(evidence, {f"{HOSTILE}.py": source}, HOSTILE, 1)
            book.record(
                f"d{row.key}",
                by.assignment_digest,
                "g",
                seen,
                {row.key: by.worth(evidence, row.key, row.name)},
            )
        path = report.write(book, by, tmp_path / "class.html", [])
    page = path.read_text(encoding="utf-8")
    scripts = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)
    assert len(scripts) == 1
    digest = base64.b64encode(hashlib.sha256(scripts[0].encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in page
    assert "default-src 'none'" in page
    assert "alert(1)</script>" not in page
    assert "\u202e" not in page
    assert "\x1b" not in page
    assert "unreadable" in page
    assert "<summary>" in page  # the two are alike
    links = re.findall(r'href="([^"]+)"', page)
    assert len(links) == 2
    assert len([*(tmp_path / "reports").iterdir()]) == 2


def test_who_shares_what_many_have_is_named_and_nobody_is_accused() -> None:
    rows = [
        Row(HandedIn(key, name), "", "waiting", "", None, 0, "", 0)
        for key, name in (("1", HOSTILE), ("2", "Bob"), ("3", "Cy"))
    ]
    page = partial(
        report.page, rows, grades={}, looks={row.handed.key: [] for row in rows}, links={}, lost=[], alike=[]
    )
    assert "Code that many have" not in page()
    shared = page(shared=[Shared(["1", "2"], {"a.py": [Line(7, "x = 1  # <script>", is_alike=True)]})])
    (summary,) = re.findall(r"<summary>(.*?)</summary>", shared, re.DOTALL)
    assert "2 hand-ins" in summary
    assert "Bob" in summary
    assert "Cy" not in summary
    assert "# &lt;script&gt;" in shared
    assert "It may be what all were given" in shared
    assert HOSTILE not in shared


def test_every_question_is_taught_in_a_lesson_that_there_is() -> None:
    assert report.lessons().keys() == QUESTIONS.keys()
    assert {*report.lessons().values()} <= {path.stem for path in course.notebooks()}


def test_files_of_students_have_names_of_their_own() -> None:
    names = [
        report.file_name(Row(HandedIn(key, name), "", "waiting", "", None, 0, "", 0))
        for key, name in (("1", "Ä/../b"), ("2", "Ä-b"), ("3", ""), ("4", "x" * 500), ("5", ".."))
    ]
    assert len({*names}) == len(names)
    assert not any("/" in name or name.startswith(".") or len(name) > 80 for name in names)
