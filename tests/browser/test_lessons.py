"""Lessons run from top to bottom in the browser, and their pictures are drawn there."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from browsing import Tab, number_of_code_cells
from playwright.sync_api import expect

PICTURE = ".jp-RenderedMermaid svg, .jp-RenderedMermaid img"


@pytest.mark.timeout(900)
@pytest.mark.parametrize(
    ("lesson", "has_picture"),
    [
        ("01_workspaces", True),
        ("04_first_node", False),
        ("07_robot_controller", False),
        ("09_troubleshooting", False),
    ],
)
def test_a_lesson_runs_from_top_to_bottom(
    open_tab: Callable[..., Tab], pictures: Path | None, lesson: str, has_picture: bool
) -> None:
    """Every cell is executed without an error, and the console does not complain."""
    tab = open_tab(f"{lesson}.ipynb")
    tab.run_all(number_of_code_cells(f"{lesson}.ipynb"))
    if has_picture:
        tab.scroll_to(PICTURE)
        expect(tab.page.locator(PICTURE).first).to_be_visible()
    if pictures:
        tab.page.screenshot(path=pictures / f"{lesson}.png")
    assert tab.complaints == []
