"""The page about a class is opened in a browser: it sorts, filters, and shows who has handed in the same."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from evidences import FAULTS, STYLES, nothing, right, untouched
from playwright.sync_api import Browser, Page, expect

from ros2lab.classroom import report
from ros2lab.classroom.gradebook import Seen, opened
from ros2lab.classroom.handed_in import HandedIn
from ros2lab.classroom.judging import Judging
from ros2lab.grading.evidence_json import evidence_json

NAMES = [
    "Ada Abel",
    "Bo Çelik",
    "Chiara Conti",
    "Dương Anh",
    "Emil Ek",
    "Fatma Demir",
    "Goran Ilić",
    "Hana Nováková",
    "Ines Sá",
    "Jörg Maier",
    "Kei Mori",
    "Lena Nowak",
    "Mira Olsen",
    "Noé Petit",
    "Ola Quist",
    "Pia Ruiz",
    "Qi Shen",
    "Rosa Toth",
    "Sami Uusi",
    "Tove Vik",
    "Uma Wolf",
    "Vera Xu",
    "Wim Ytsma",
    "Zoë Zorn",
]
DECIDED = [
    (student, "documentation.code", points, "Explained in the interview.", "I. Structor")
    for student, points in (("2", 2.25), ("5", 2.5))
]
COPIED = """
class Robot:
    def __init__(self, speed):
        self.speed, self.turns = speed, [angle * 0.5 for angle in range(7) if angle % 2]

    def obey(self, word):
        found = {"start": 1.5, "stop": 0.0}.get(word.strip().lower())
        if found is None:
            raise KeyError(f"{word} is not known")
        self.turns.append(found ** 2 + len(self.turns))
        return sorted(self.turns, reverse=True)[: len(word)]


def smoothed(values, weight):
    result = []
    for value in values:
        if result and abs(value - result[-1]) < 10 * weight:
            result.append(weight * value + (1 - weight) * result[-1])
        else:
            result.append(value)
    return result


def longest_pause(times):
    best, last = 0.0, None
    while times:
        now = times.pop(0)
        if last is not None and now - last > best:
            best = now - last
        last = now
    return {"pause": best, "end": last}
"""


def make_page(folder: Path) -> Path:
    """Write the page about a class of two dozen, most of whom lost points."""
    evidences = [make() for make in [*STYLES.values()][:6]]
    evidences += [change(right()) for _, change in [*FAULTS.values()][::3]]
    evidences[10], evidences[20] = nothing(), untouched()
    with opened(folder, is_new_allowed=True) as book:
        rows = [
            HandedIn(str(number), name, str(number), paths=(Path(name),), is_late=number % 9 == 4)
            for number, name in enumerate(NAMES)
        ]
        book.register([(row, row.key, 0) for row in rows])
        book.decide(DECIDED)
        by = Judging.of(None, None, book.decisions())
        for row, evidence in zip(rows, evidences[: len(rows)], strict=True):
            copy = COPIED.replace("speed", "pace").replace("obey", "hear").replace("result", "smooth")
            sources = {"3": {"robot/robot.py": COPIED}, "11": {"robot/moves.py": copy}}.get(row.key, {})
            text = evidence_json(replace(evidence, name=row.name))
            worth = by.worth(text, row.key, row.name)
            book.record(row.key, by.assignment_digest, "g", Seen(text, sources, "", 6), {row.key: worth})
        book.register([(replace(rows[-1], reason="It is broken or incomplete."), "", 0)])
        return report.write(book, by, folder / "class.html", [])


def shown(page: Page, cell: str) -> list[str]:
    """Return what stands in the cells of a column, of the rows that are shown."""
    found: Any = page.locator(f"#students tbody tr:visible {cell}")
    return [text.strip() for text in found.all_inner_texts()]


def test_the_page_about_a_class_sorts_filters_and_shows_pairs(
    browser: Browser, tmp_path: Path, pictures: Path | None
) -> None:
    """Points are sorted as numbers, and what was typed leaves only the rows that hold it; nothing is loaded."""
    make_page(tmp_path)
    context = browser.new_context(viewport={"width": 1100, "height": 1000})
    page = context.new_page()
    requests: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    page.goto((tmp_path / "class.html").as_uri())
    assert shown(page, "th") == sorted(NAMES, key=str.lower)
    page.get_by_role("button", name="Points").click()
    none, *points = shown(page, "td.points")
    assert not none.isdecimal()
    assert points == sorted(points, key=float)
    assert {"109.25", "109.5"} <= {*points}
    page.get_by_role("button", name="Points").click()
    assert shown(page, "td.points") == [*sorted(points, key=float, reverse=True), none]
    page.get_by_label("Show only rows that hold").fill("LATE")
    assert {*shown(page, "th")} == {NAMES[number] for number in (4, 13, 22)}
    expect(page.get_by_role("status")).to_have_text(f"3 of {len(NAMES)} shown")
    page.get_by_label("Show only rows that hold").fill("")
    page.get_by_role("button", name="Name").click()
    pair = page.locator("details")
    expect(pair).to_have_count(1)
    pair.locator("summary").click()
    assert "Dương Anh and Lena Nowak" in pair.inner_text()
    assert pair.locator(".alike").count() > 10
    if pictures:
        page.evaluate("scrollTo(0, 0)")
        page.screenshot(path=pictures / "class.png")
        pair.scroll_into_view_if_needed()
        page.screenshot(path=pictures / "class_alike.png")
    page.set_viewport_size({"width": 320, "height": 640})
    width = page.evaluate("document.documentElement.scrollWidth")
    assert width <= 320, "nothing sticks out on a phone"
    page.get_by_role("link", name="Ada Abel").click()
    expect(page.locator("body")).to_contain_text("Ada Abel")
    context.close()
    assert all(url.startswith("file:") for url in requests)
