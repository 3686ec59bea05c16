"""A notebook of somebody else is opened: nothing in it runs before its reader says that it is trusted."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import anywidget
import nbformat
import pytest
from browsing import TIMEOUT_MS, Lab, Tab
from ipywidgets import Widget
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.long

RUN = "(window.ran = window.ran || []).push"
# What a saved output can hold, by its kind; each says who it is when it runs.
OUTPUTS = {
    "text/html": f"<script>{RUN}('script')</script><img src=x onerror=\"{RUN}('image')\">",
    "image/svg+xml": f"<svg xmlns='http://www.w3.org/2000/svg' onload=\"{RUN}('picture')\"><script>{RUN}('svg')</script></svg>",
    "application/javascript": f"{RUN}('javascript')",
    "text/markdown": f"<img src=x onerror=\"{RUN}('markdown')\"> <a href=\"javascript:{RUN}('link')\">link</a>",
}
SEEN = "the last output"
KINDS = {"script", "image", "javascript", "widget", "view"}  # what runs where it is trusted


@pytest.fixture
def widget_state() -> Iterator[dict[str, object]]:
    """Return what a notebook keeps of a widget that brings JavaScript of its own."""
    code = f"{RUN}('widget'); export default {{render() {{ {RUN}('view'); }}}};"
    widget = anywidget.AnyWidget(_esm=code)
    yield {"id": widget.model_id, "state": Widget.get_manager_state()}
    Widget.close_all()


@pytest.mark.thorough
def test_nothing_of_somebody_elses_notebook_runs_until_it_is_trusted(
    lab: Lab, open_tab: Callable[[str], Tab], widget_state: dict[str, object]
) -> None:
    """No script, no handler and no widget's code; once trusted, all of them run, so they would have been seen before."""
    path = lab.write("theirs.ipynb", ["1"])
    notebook = nbformat.read(path, as_version=4)
    view = {
        "application/vnd.jupyter.widget-view+json": {
            "model_id": widget_state["id"],
            "version_major": 2,
            "version_minor": 0,
        }
    }
    notebook.cells[0].outputs = [
        *(nbformat.v4.new_output("display_data", {kind: data}) for kind, data in OUTPUTS.items()),
        nbformat.v4.new_output("display_data", view),
        nbformat.v4.new_output("stream", text=SEEN),
    ]
    notebook.cells.append(nbformat.v4.new_markdown_cell(OUTPUTS["text/html"]))
    notebook.metadata["widgets"] = {"application/vnd.jupyter.widget-state+json": widget_state["state"]}
    nbformat.write(notebook, path)
    tab = open_tab(path.name)
    assert ran_in(tab.page) == set()
    trust(tab)
    tab.page.reload()
    tab.page.wait_for_function(
        "(kinds) => kinds.every((kind) => (window.ran || []).includes(kind))", arg=[*KINDS]
    )


def ran_in(page: Page) -> set[str]:
    """Return what has run by the time at which all outputs are seen and every image has been asked for."""
    expect(page.get_by_text(SEEN)).to_be_visible(timeout=TIMEOUT_MS)
    page.wait_for_function("[...document.images].every((image) => image.complete)")
    page.wait_for_load_state("networkidle")
    return set(page.evaluate("window.ran || []"))


def trust(tab: Tab) -> None:
    """Say that the notebook is trusted, as its reader does, and save that."""
    tab.page.keyboard.press("Control+Shift+C")
    tab.page.get_by_role("textbox", name="SEARCH").fill("Trust Notebook")
    tab.page.keyboard.press("Enter")
    tab.page.get_by_role("dialog").get_by_role("button", name="Trust").click()
    tab.save()
