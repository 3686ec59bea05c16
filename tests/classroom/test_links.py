"""Links in notebooks that were handed in, as formgrader and feedback show them."""

from __future__ import annotations

import pytest
from nbconvert.filters.markdown_mistune import markdown2html_mistune
from nbformat import v4

from ros2lab.classroom.autograde import disarm


@pytest.mark.parametrize(
    "source",
    [
        "[a](javascript:alert(1))",
        "[a](java&#115;cript:alert(1))",
        "<javascript:alert(1)>",
        "[a]\n\n[a]: JaVaScript:alert(1)",
        "![a](data:text/html;base64,AAAA)",
        "```\n[a](x)\n```\n\n[a](vbscript:x)\n````\n",
        "![a](attachment:is_not_there.png)",
        r"$\href{javascript:alert(1)}{a}$",
        r"&#36;&#92;href{javascript:alert(1)}{a}&#36;",
    ],
)
def test_a_link_that_could_run_something_is_shown_as_text(source: str) -> None:
    cell = v4.new_markdown_cell(source)
    disarm(cell)
    shown = markdown2html_mistune(cell.source)
    assert shown.lstrip().startswith("<pre>") or "highlight" in shown
    assert "<a " not in shown
    assert "<img " not in shown
    assert source.splitlines()[-1].strip("`") in cell.source


@pytest.mark.parametrize(
    "source",
    [
        "# Title\n\n[a](https://docs.ros.org/en/jazzy) and [b](04_first_node.ipynb#x)",
        "<me@x.org> `[a](javascript:alert(1))` $\\dot{x} = 1$",
        "",
    ],
)
def test_what_leads_to_pages_stays(source: str) -> None:
    cell = v4.new_markdown_cell(source)
    disarm(cell)
    assert cell.source == source


def test_only_pictures_stay_attached() -> None:
    cell = v4.new_markdown_cell("![a](attachment:a.png)")
    cell.attachments = {
        "a.png": {"image/png": "iVBORw0K"},
        "b.svg": {"image/svg+xml": "AAAA"},
        "c.png": {"image/png": "AAAA' onerror='alert(1)"},
    }
    disarm(cell)
    assert [*cell.attachments] == ["a.png"]
