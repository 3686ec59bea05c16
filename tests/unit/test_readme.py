"""README says what is there: its lessons, their minutes, its commands and its links."""

from __future__ import annotations

import re
from pathlib import Path

import nbformat
import pytest

from ros2lab import course

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_lesson_table_lists_every_notebook_with_its_minutes() -> None:
    rows = re.findall(
        r"^\| \[(\w+)\]\(notebooks/\1\.ipynb\) \| .+ \| (\d+) \| [a-z]* ?\|$", README, re.MULTILINE
    )
    titles = [nbformat.read(path, as_version=4).cells[0].source for path in course.notebooks()]
    minutes = [re.findall(r"\*\*Time:\*\* (\d+) minutes", title)[0] for title in titles]
    assert rows == list(zip([path.stem for path in course.notebooks()], minutes, strict=True))


def test_every_make_command_exists() -> None:
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    named = re.findall(r"make ([a-z-]+)", "\n".join(re.findall(r"`[^`]*`|^make .*$", README, re.MULTILINE)))
    assert named
    assert set(named) <= set(targets)


@pytest.mark.parametrize(
    "document", sorted({*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")}), ids=lambda p: p.name
)
def test_every_link_to_a_file_leads_somewhere(document: Path) -> None:
    for target in re.findall(r"\]\(([^)#:]+)\)", document.read_text(encoding="utf-8")):
        assert (document.parent / target).exists(), target
