"""Submissions to the example of an assignment that is nothing but data; what each must get is in `lamp.yaml`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from corpus.case import Case
from corpus.tree import Files, as_folder, edit, made

ASSIGNMENT = Path(__file__).parents[3] / "docs/examples/lamp"
MODEL: Files = {
    str(path.relative_to(ASSIGNMENT / "solution")): path.read_text(encoding="utf-8")
    for path in sorted((ASSIGNMENT / "solution").rglob("*"))
    if path.is_file() and "__pycache__" not in path.parts
}
_ROWS: dict[str, Any] = yaml.load(
    Path(__file__).with_name("lamp.yaml").read_text(encoding="utf-8"),
    Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader),
)


def _case(name: str, about: str, files: Files, loses: list[str], says: str = "") -> Case:
    make = as_folder(files, "lamp_ws")
    return Case(f"lamp/{name}", about, make, assignment=ASSIGNMENT, criteria=frozenset(loses), cause=says)


def _fault(name: str, row: dict[str, Any]) -> Case:
    pairs = [(row["old"], row["new"]), *row.get("also", {}).items()]
    files = made(MODEL, *(edit(row["in"], old.rstrip("\n"), new.rstrip("\n")) for old, new in pairs))
    return _case(name, name.replace("_", " "), files, row["loses"], row["says"])


LAMP_STYLES = tuple(
    _case(name, row["about"], MODEL | row["files"], []) for name, row in _ROWS["styles"].items()
)
LAMP_FAULTS = tuple(_fault(name, row) for name, row in _ROWS["faults"].items())
