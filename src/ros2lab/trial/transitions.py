"""Which transitions of managed nodes anything in a workspace asks for: a program, a launch file, or a reader."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.python_source import PythonSource, read_source, read_text

TRANSITIONS = ("configure", "activate")  # those that make a managed node work, in order
_BY_HAND = re.compile(r"\blifecycle set\b")
_READ = frozenset((".md", ".txt", ".rst", ".sh", ""))


def asked_for(look: Look) -> set[str]:
    """Return the transitions that the code or a launch file of a workspace may ask for."""
    sources = [source for package in look.packages for source in package.sources.values()]
    own = {n.name for source in sources for n in source.nodes if isinstance(n, ast.FunctionDef)}
    paths = [*zip(look.launch_paths, look.launch_files, strict=True)]
    launched = [read_source(path, "launch_file", file.shown) for path, file in paths if path.suffix == ".py"]
    names = {name for source in (*sources, *launched) for name in _names(source)} - own
    plain = [read_text(path) for path, _ in paths if path.suffix != ".py"]
    # A manager brings up every node that it is told of; what XML and YAML ask for is not read here.
    if any(_brings_up(name) for name in names) or any("lifecycle" in text for text in plain):
        return {*TRANSITIONS}
    words = {
        word for name in names if not name.startswith("on_") for word in re.findall("[a-z]+", name.lower())
    }
    found = words.intersection(TRANSITIONS)
    # Numbers may stand for transitions.
    return found or ({*TRANSITIONS} if "ChangeState" in names else set())


def are_by_hand(look: Look) -> bool:
    """Return whether a text of the workspace says how to bring up its nodes by hand."""
    folders = [look.root, *(package.folder for package in look.packages)]
    files = [path for folder in folders for path in sorted(folder.glob("*")) if path.suffix in _READ]
    texts = [read_text(path) for path in files if path.is_file()]
    texts += [source.text for package in look.packages for source in package.sources.values()]
    return any(_BY_HAND.search(text) for text in texts)


def _brings_up(name: str) -> bool:
    lower = name.lower()
    return lower == "autostart" or ("lifecycle" in lower and "manager" in lower)


def _names(source: PythonSource) -> Iterator[str]:
    """Yield the names that a file uses, and its strings that are a single word."""
    for node in source.nodes:
        match node:
            case ast.Name(id=name) | ast.Attribute(attr=name):
                yield name
            case ast.keyword(arg=str(name)):
                yield name
            case ast.Constant(value=str(name)) if re.fullmatch(r"[\w/]+", name):
                yield name
