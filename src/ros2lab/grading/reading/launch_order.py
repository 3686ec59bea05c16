"""Which launch files are tried first: those that start most."""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path

from ros2lab.grading.reading.graded_package import Package

MOST = 100  # launch files that are put in order; nobody writes more
_DEEPEST = 5  # levels of launch files that include others


def programs_of(packages: Iterable[Package]) -> set[str]:
    """Return what launch files may start in packages: executables, or modules if these are not known."""
    found = set[str]()
    for package in packages:
        points = package.setup.entry_points if package.setup else None
        stems = (source.name.rpartition(".")[2] for source in package.own_sources)
        found |= {point.name for point in points} if points else {*stems} - {"__init__", "setup"}
    return found


def programs_named(texts: Mapping[Path, str], programs: Collection[str]) -> dict[Path, list[str]]:
    """Return the programs that launch files name, themselves or through what they include.

    Args:
        texts: the launch files, without comments.
        programs: what they may start.
    """
    some = dict(itertools.islice(texts.items(), MOST))
    own = {path: {program for program in programs if _names(text, program)} for path, text in some.items()}
    included = {path: [other for other in some if other.name in text] for path, text in some.items()}
    named = own
    for _ in range(_DEEPEST):
        named = {path: own[path].union(*(named[other] for other in included[path])) for path in some}
    return {path: sorted(found) for path, found in named.items()}


def those_that_start_most_first(
    texts: Mapping[Path, str], named: Mapping[Path, Collection[str]]
) -> dict[Path, str]:
    """Return launch files with their texts, those that name most programs first; equals keep their order."""
    order = sorted(named, key=lambda path: -len(named[path]))
    return {path: texts[path] for path in (*order, *texts)}


def _names(text: str, program: str) -> bool:
    return re.search(rf"(?<!\w){re.escape(program)}(?!\w)", text) is not None
