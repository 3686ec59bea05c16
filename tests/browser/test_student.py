"""A student with a browser goes through lessons cell by cell, types the answers, and drives with the mouse."""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterator
from typing import Any

import nbformat
import pytest
from browsing import TIMEOUT_MS, Tab
from driving import press, see_state, see_trail
from playwright.sync_api import Browser, Locator, expect

from bare_student import Student
from ros2lab import course, edition

pytestmark = pytest.mark.long

LESSONS = ("00_welcome", "07_robot_controller", "08_drive_the_robot")
PICTURE = ".jp-RenderedMermaid svg, .jp-RenderedMermaid img"
MARKS = re.compile(r"^[ \t]*### (?:BEGIN|END) SOLUTION\n?", re.MULTILINE)


@pytest.fixture
def tab(browser: Browser, student: Student) -> Iterator[Tab]:
    """Open the address that `make lab` prints."""
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    tab = Tab(context.new_page())
    tab.page.goto(student.address)
    yield tab
    context.close()


@pytest.mark.thorough
@pytest.mark.timeout(900)
def test_a_student_answers_and_drives(tab: Tab) -> None:
    """The lab begins with the first lesson, and what is written in lesson 7 is what lesson 8 drives."""
    for lesson in LESSONS:
        if lesson != LESSONS[0]:
            side_bar = tab.page.get_by_role("navigation", name="Course progress")
            side_bar.get_by_role("link", name=lesson.replace("_", " "), exact=True).press("Enter")
            expect(side_bar.locator('[aria-current="page"]')).to_have_text(
                lesson.replace("_", " "), timeout=TIMEOUT_MS
            )
        go_through(tab, lesson)
    expect(tab.page.get_by_text("~/robot_project_ws: your own")).to_be_visible()
    assert tab.complaints == []


def go_through(tab: Tab, lesson: str) -> None:
    """Run each code cell with Shift+Enter, with its answer where it asks for one; each check says Right."""
    path = next(path for path in course.notebooks() if path.stem == lesson)
    worked = nbformat.read(path, as_version=4)
    pairs = zip(code_cells(worked), code_cells(edition.student_edition(worked)), strict=True)
    panel = tab.page.get_by_role("tabpanel", name=path.name)
    panel.locator(".jp-Toolbar").get_by_text("Python 3 (ipykernel)").wait_for(timeout=TIMEOUT_MS)
    tab.wait_until_ready()  # the indicator of the toolbar says idle also before the kernel has started
    shown = panel.locator(".jp-CodeCell")
    expect(shown).to_have_count(len(code_cells(worked)), timeout=TIMEOUT_MS)
    for number, (answered, delivered) in enumerate(pairs):
        cell = shown.nth(number)
        cell.locator(".cm-content").click(timeout=TIMEOUT_MS)
        assert text_in(cell) == delivered.source
        if answered.source != delivered.source:
            tab.page.keyboard.press("Control+a")
            tab.page.keyboard.insert_text(MARKS.sub("", answered.source).rstrip())
        run(cell, answered.source, lesson)
        if "node_graph(" in answered.source:
            expect(cell.locator(PICTURE).first).to_be_visible(timeout=TIMEOUT_MS)
        if "CommandPanel(" in answered.source:
            drive_with_the_mouse(tab)


def code_cells(notebook: Any) -> list[Any]:
    """Return the code cells of a notebook."""
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def text_in(cell: Locator) -> str:
    """Return what stands in a cell's editor."""
    return "\n".join(cell.locator(".cm-line").all_text_contents())


def run(cell: Locator, source: str, lesson: str) -> None:
    """Press Shift+Enter, wait until the cell has a number, and see that nothing in it is red."""
    # In the cell, whatever has taken the focus meanwhile: a page that has just opened may.
    cell.locator(".cm-content").press("Shift+Enter")
    expect(cell.locator(".jp-InputPrompt")).to_have_text(re.compile(r"\[\d+\]:"), timeout=TIMEOUT_MS)
    outputs = cell.locator(".jp-Cell-outputArea")
    # JupyterLab shows an error as it shows what is printed to stderr; these lessons print nothing there.
    errors = outputs.locator('[data-mime-type="application/vnd.jupyter.stderr"]').all_inner_texts()
    assert not errors, f"{source}\n\n{errors}"
    if source.startswith("check.predict("):
        outputs.get_by_role("radio").first.check(timeout=TIMEOUT_MS)
        outputs.get_by_role("button", name="Commit").click()
        expect(outputs).to_contain_text("What happens:", timeout=TIMEOUT_MS)
    elif source == "check.quiz()":
        answer_quiz(outputs, lesson)
    elif re.search(r"^check\.", source, re.MULTILINE):
        expect(outputs).to_contain_text("Right", timeout=TIMEOUT_MS)


def answer_quiz(outputs: Locator, lesson: str) -> None:
    """Answer question after question with clicks."""
    questions = importlib.import_module(f"ros2lab.checks.{lesson.partition('_')[2]}").QUIZ
    for number, question in enumerate(questions, 1):
        outputs.locator(f'input[value="{question.right}"]').check(timeout=TIMEOUT_MS)
        outputs.get_by_role("button", name="Answer").click()
        expect(outputs.locator("section")).to_have_count(number, timeout=TIMEOUT_MS)
    expect(outputs).to_contain_text(f"All {len(questions)} questions are answered", timeout=TIMEOUT_MS)


def drive_with_the_mouse(tab: Tab) -> None:
    """Click start, stop and reset: the state follows, and the robot leaves a trail."""
    press(tab, "start")
    see_state(tab, "running")
    see_trail(tab)
    press(tab, "stop")
    see_state(tab, "stopped")
    press(tab, "reset")
    see_state(tab, "idle")
