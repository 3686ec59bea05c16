"""Asks, for a message about what is not there, the rule that knows why."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping

from ros2lab.diagnose.explaining.meaning import Meaning
from ros2lab.diagnose.explaining.not_found import no_executable, no_file, no_package, not_sourced
from ros2lab.diagnose.explaining.unbuilt import no_prerequisite
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.packaging.file_patterns import folder_copied
from ros2lab.diagnose.printed.error_text import ErrorText

_Groups = Mapping[str, str]


def asked_for(meaning: Meaning, groups: _Groups, error: ErrorText, look: Look) -> Finding | None:
    """Say why a command did not find a package, an executable or a file; None for other errors."""
    if "file-not-found" in meaning.codes:
        return no_file(groups["name"], groups["package"], look)
    rule = _RULES.get(meaning.codes[0])
    return rule(groups, error, look) if rule else None


def _copied(groups: _Groups, _: ErrorText, look: Look) -> Finding | None:
    copied = (folder_copied(groups["name"], package) for package in look.packages)
    return next(filter(None, copied), None)


def _command(groups: _Groups, error: ErrorText, look: Look) -> Finding | None:
    reset = not_sourced(groups["name"], error.typed, error.text, look.root)
    return reset if look and "removes" in reset.cause else None


def _metadata(groups: _Groups, error: ErrorText, look: Look) -> Finding | None:
    name = groups["name"].replace("-", "_")
    is_asked = look.package(name) is not None and error.typed
    return not_sourced(name, error.typed, error.text, look.root) if is_asked else None


_RULES: Mapping[str, Callable[[_Groups, ErrorText, Look], Finding | None]] = {
    "package-not-found": lambda groups, error, look: no_package(
        groups["name"] or groups["name2"], look, error
    ),
    "executable-missing": lambda _, error, look: no_executable(error.command, look, error.typed),
    "not-built": lambda _, error, look: no_prerequisite(error, look),
    "name-twice": lambda _, error, look: of_older_node(error, look),
    "data-file-missing": _copied,
    "command-not-found": _command,
    "not-sourced": _metadata,
}


_TWICE = "share an exact name"
_STARTED = re.compile(r"\bros2 run (?P<package>[\w.-]+) (?P<executable>[\w.-]+)")
_ECHOED = re.compile(r"data: '?(?P<text>[^\W\d][^'\n]*[^\W\d])'?$", re.MULTILINE)


def of_older_node(error: ErrorText, look: Look) -> Finding | None:
    """Say that a node of an earlier start still runs; None if the text shows no or all starts."""
    lines = (line for step in error.steps if _TWICE in step.text for line in step.lines)
    listed = Counter(line.strip() for line in lines if line.startswith("/"))
    for name, number in listed.items():
        makers = {*_makers(name.rpartition("/")[2], look)}
        starts = [match.groups() for line in error.typed for match in _STARTED.finditer(line)]
        begun = [start for start in starts if start in makers]
        is_launched = any(line.startswith("ros2 launch") for line in error.typed)
        if number > 1 and len(makers) == 1 and not is_launched and 0 < len(begun) < number:
            package, executable = begun[0]
            times = "once" if len(begun) == 1 else f"{len(begun)} times"
            cause = f"There are {number} nodes {name}, but it was started here only {times}: an older one, with its old code, is still running in another terminal or in the background.{_not_in_the_sources(error, look)}"
            fix = f"press Ctrl-C in the older one's terminal, or type `pkill -f lib/{package}/{executable}` to end them all; then start it once: ros2 run {package} {executable}"
            return Finding("name-twice", cause, "", fix)
    return None


def _makers(name: str, look: Look) -> Iterator[tuple[str, str]]:
    """Yield the package and executable of each file that contains this node name."""
    for package in look.packages:
        for point in package.points:
            source = package.sources.get(point.module)
            texts = (
                node.value for node in (source.nodes if source else ()) if isinstance(node, ast.Constant)
            )
            if name in texts:
                yield package.name, point.name


def _not_in_the_sources(error: ErrorText, look: Look) -> str:
    """Say which received text is in no source file any more; empty if all are, or if none is."""
    echoed = [*dict.fromkeys(match["text"] for step in error.steps for match in _ECHOED.finditer(step.text))]
    gone = [text for text in echoed if not any(text in source.text for source in look.files)]
    if len(gone) == len(echoed):
        return ""  # they are put together at run time
    return f" Its text {gone[0]!r} is no longer in any file." if gone else ""
