"""Which classes of the installed packages of ROS are derived from which, read from their files."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from functools import lru_cache

from ros2lab.diagnose.sources.interfaces import folder_of, launch_homes_of
from ros2lab.diagnose.sources.python_source import read_text


@lru_cache(maxsize=8)
def _bases_in(*packages: str) -> Mapping[str, frozenset[str]]:
    """Return the names of the base classes of each class of some packages."""
    folders = [folder for folder in map(folder_of, packages) if folder]
    texts = (read_text(path) for folder in folders for path in sorted(folder.rglob("*.py")))
    found = (re.findall(r"^class (\w+)\(([\w., ]+)", text, re.MULTILINE) for text in texts)
    return {name: frozenset(re.findall(r"\w+(?=,|$)", above)) for rows in found for name, above in rows}


def classes_below(name: str, *packages: str) -> list[str]:
    """Return the classes of some packages that are derived from a class, itself included."""
    known, found = _bases_in(*packages), {name}
    while more := {class_name for class_name, above in known.items() if above & found} - found:
        found |= more
    return sorted(found)


@lru_cache(maxsize=16)
def launch_classes_with(method: str) -> frozenset[str]:
    """Return the classes of launch that define a method, themselves or by a base class."""
    folders = [folder for folder in map(folder_of, ("launch", "launch_ros")) if folder]
    texts = (
        text for folder in folders for path in folder.rglob("*.py") if method in (text := read_text(path))
    )
    classes = (n for text in texts for n in ast.walk(ast.parse(text)) if isinstance(n, ast.ClassDef))
    owners = (n.name for n in classes if method in (getattr(inner, "name", "") for inner in n.body))
    return frozenset(name for owner in owners for name in classes_below(owner, "launch", "launch_ros"))


def launch_classes_below(name: str) -> list[str]:
    """Return the classes for launch files that are derived from a class of launch, itself included."""
    return [below for below in classes_below(name, "launch", "launch_ros") if launch_homes_of(below)]
