"""Corrects commands of colcon whose package names colcon does not accept as they were typed."""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Mapping, Sequence

from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.spelling import nearest

# The options of colcon that the names of packages follow.
_SELECTING = (
    "--packages-select",
    "--packages-up-to",
    "--packages-skip",
    "--packages-above",
    "--packages-start",
    "--packages-end",
    "--packages-ignore",
    "--allow-overriding",
)

_Better = tuple[str, str]  # the corrected command, and what was wrong with it


def of_colcon(line: str, words: Sequence[str], look: Look, said: str) -> _Better | None:
    """Return the command that was meant and why; None if no word is known to be wrong."""
    folders = {package.shown("").rstrip("/"): package.name for package in look.packages}
    names = {*folders.values()}
    return (
        _apart(line, words, names)
        or _without_option(line, words, folders, said)
        or _other_option(line, words, names)
        or _misspelt(line, words, names)
    )


def _apart(line: str, words: Sequence[str], names: Collection[str]) -> _Better | None:
    """Part package names that commas or semicolons join."""
    pairs = re.findall(r"([\w-]+)\s*[,;]\s*(?=([\w-]*))", line)
    joined = {name for pair in pairs for name in pair if name}
    if not joined or not joined <= {*names} or {*_SELECTING}.isdisjoint(words):
        return None
    return re.sub(r"\s*[,;]\s*", " ", line), "colcon separates package names by spaces alone."


def _without_option(line: str, words: Sequence[str], folders: Mapping[str, str], said: str) -> _Better | None:
    """Put an option before names, or folders, of packages that have none."""
    refused = re.search(r"unrecognized arguments:(.*)", said)
    bare = [*itertools.takewhile(lambda word: not word.startswith("-"), words[2:])]
    if not bare and refused and not refused[1].lstrip().startswith("-"):
        taken = {word for before, word in itertools.pairwise(words) if before in _SELECTING}
        bare = [word for word in refused[1].split() if word not in taken]
    meant = [folders.get(word.removeprefix("./").rstrip("/"), word) for word in bare]
    known = [name for name in meant if name in folders.values()]
    if not known:
        return None
    why = f"colcon {words[1]} accepts package names only after an option such as --packages-select."
    return line.replace(f" {' '.join(bare)}", f" --packages-select {' '.join(known)}", 1), why


def _other_option(line: str, words: Sequence[str], names: Collection[str]) -> _Better | None:
    """Correct an option before a package's name that takes no names."""
    for option, word in itertools.pairwise(words[1:]):
        if option.startswith("--") and word in names and option not in _SELECTING:
            begun = (known for known in _SELECTING if known.startswith(option))
            right = next(begun, None) or nearest(option, _SELECTING, 0.5) or "--packages-select"
            return line.replace(option, right, 1), f"colcon {words[1]} has no option {option}; it is {right}."
    return None


def _misspelt(line: str, words: Sequence[str], names: Collection[str]) -> _Better | None:
    """Correct a package's name after an option that takes names."""
    for option, word in itertools.pairwise(words[1:]):
        if option in _SELECTING and word not in names and (near := nearest(word, names, 0.6)):
            return line.replace(word, near), f"No package here is called {word}; there is {near}."
    return None
