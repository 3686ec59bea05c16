"""Checks answer with cards, and quizzes and predictions are clicked, in a real JupyterLab."""

from __future__ import annotations

import json
import re
from collections.abc import Callable

import pytest
from browsing import TIMEOUT_MS, Lab, Tab
from playwright.sync_api import Locator, expect

from ros2lab import progress
from ros2lab.checks import welcome

pytestmark = pytest.mark.long

NAME = "choices.ipynb"
CELLS = [
    "from ros2lab.checks import CheckError, exercise, welcome as check",
    "check.quiz()",
    'check.predict("message_time")',
    '@exercise\ndef right(): return "Right: all of `it`."\n\nright()',
    '@exercise\ndef wrong(): raise CheckError("one", "two\\n$base and $base", "think", "look")\n\nwrong()',
    "print('not reached')",
]
ERROR = '[data-mime-type="application/vnd.jupyter.stderr"]'


def test_cards_are_shown_and_questions_are_clicked(lab: Lab, open_tab: Callable[[str], Tab]) -> None:
    """With the mouse and with the keyboard; what was chosen is kept."""
    lab.write(NAME, CELLS)
    tab = open_tab(NAME)
    tab.menu("Run", "Run All Cells")
    _, quiz, forecast, right, wrong, after = (
        tab.page.locator(".jp-CodeCell").nth(number).locator(".jp-Cell-outputArea") for number in range(6)
    )
    see_the_cards(right, wrong, after)
    answer_with_the_keyboard(tab, quiz)
    foresee(forecast)
    expect(forecast).to_contain_text(f"What happens: {welcome.PREDICTIONS['message_time'].explanation}")
    kept = json.loads((lab.work / progress.CHOICES).read_text())
    assert kept["welcome.message_time"] == {"chosen": "b", "is_right": False}
    assert "welcome.quiz" in json.loads((lab.work / progress.FILE).read_text())
    see_progress_in_the_side_bar(tab, lab)
    assert tab.complaints == []


@pytest.mark.thorough
def test_what_was_chosen_is_still_shown_without_the_kernel(lab: Lab, open_tab: Callable[[str], Tab]) -> None:
    lab.write(NAME, CELLS[:3])
    tab = open_tab(NAME)
    tab.menu("Run", "Run All Cells")
    quiz, forecast = (
        tab.page.locator(".jp-CodeCell").nth(number).locator(".jp-Cell-outputArea") for number in (1, 2)
    )
    answer_with_the_keyboard(tab, quiz)
    foresee(forecast)
    tab.save()
    lab.end_kernels()
    later = open_tab(NAME)
    later.see_saved(".ros2lab-choices >> nth=1")
    expect(later.page.locator(".ros2lab-choices").first).to_contain_text("All 3 questions are answered")
    expect(later.page.locator(".ros2lab-choices").nth(1)).to_contain_text(
        "You expected: about a tenth of a second"
    )
    assert tab.complaints == []


def see_progress_in_the_side_bar(tab: Tab, lab: Lab) -> None:
    """It is open, follows what is done, and a file that cannot be read counts as nothing."""
    bar = tab.page.get_by_role("navigation", name="Course progress")
    expect(bar.get_by_role("status")).to_have_text(
        re.compile(r"^1 of \d+ exercises is done\.$"), timeout=TIMEOUT_MS
    )
    expect(bar.get_by_role("listitem").first.get_by_role("img")).to_have_accessible_name(
        "1 of 2 exercises done"
    )
    expect(bar.get_by_role("listitem").get_by_role("link")).to_have_count(len(progress.lessons()))
    expect(bar.get_by_role("link", name="Next: 00 welcome")).to_be_visible()
    file = lab.work / progress.FILE
    kept = {f"welcome.{name}": "now" for name in progress.exercises("welcome")}
    file.write_text(json.dumps(kept))
    expect(bar.get_by_role("link", name="Next: 01 workspaces")).to_be_visible(timeout=TIMEOUT_MS)
    file.write_text("nonsense")
    expect(bar.get_by_role("status")).to_have_text("Nothing is done yet.", timeout=TIMEOUT_MS)


@pytest.mark.thorough
def test_a_question_of_a_saved_notebook_waits_for_its_kernel(
    lab: Lab, open_tab: Callable[[str], Tab]
) -> None:
    """It says what to do, and has no button that does nothing."""
    lab.write(NAME, CELLS[:2])
    tab = open_tab(NAME)
    tab.menu("Run", "Run All Cells")
    expect(tab.page.get_by_role("button", name="Answer")).to_be_visible(timeout=TIMEOUT_MS)
    tab.save()
    lab.end_kernels()
    later = open_tab(NAME)
    later.see_saved("text=Run this cell again to answer.")
    expect(later.page.get_by_role("button", name="Answer")).to_have_count(0)


def see_the_cards(right: Locator, wrong: Locator, after: Locator) -> None:
    """One card an answer, without a traceback; a hint is a click or a key away, and the next cell does not run."""
    expect(right.get_by_role("note")).to_contain_text("Right: all of it.", timeout=TIMEOUT_MS)
    card = wrong.get_by_role("note")
    expect(card).to_contain_text("Not yet", timeout=TIMEOUT_MS)
    expect(card).to_contain_text("$base and $base")
    expect(wrong.locator(ERROR)).to_have_count(1)
    expect(wrong.locator(ERROR)).to_be_hidden()
    hint = card.get_by_text("look")
    expect(hint).to_be_hidden()
    card.locator("summary").press("Enter")
    expect(hint).to_be_visible()
    expect(after).not_to_contain_text("not reached")


def foresee(forecast: Locator) -> None:
    """Choose a prediction with the mouse, and commit to it."""
    forecast.get_by_label("about a tenth of a second").check()
    forecast.get_by_role("button", name="Commit").click()
    expect(forecast).to_contain_text("You expected: about a tenth of a second", timeout=TIMEOUT_MS)


def answer_with_the_keyboard(tab: Tab, quiz: Locator) -> None:
    """Choose wrong first, which gets a nudge, and then right, by arrow keys and Enter alone."""
    keys = tab.page.keyboard
    quiz.locator("input").first.focus(timeout=TIMEOUT_MS)
    keys.press("Space")
    keys.press("Enter")
    expect(quiz.locator(".ros2lab-nudge")).to_contain_text(
        "Did you tell the log who publishes?", timeout=TIMEOUT_MS
    )
    for number, question in enumerate(welcome.QUIZ):
        right = quiz.locator(f'input[value="{question.right}"]')
        expect(quiz.locator("input:focus")).to_have_count(1, timeout=TIMEOUT_MS)
        keys.press("Space")
        for _ in range(3):
            if not right.is_checked():
                keys.press("ArrowDown")
        expect(right).to_be_checked()
        keys.press("Enter")
        expect(quiz.locator("section")).to_have_count(number + 1, timeout=TIMEOUT_MS)
        expect(quiz.locator("section").last).to_contain_text(question.why)
    expect(quiz).to_contain_text("All 3 questions are answered.")
