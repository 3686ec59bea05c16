"""Asks, for a message about what is not there, the rule that knows why."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ros2lab.diagnose.explaining.meaning import Meaning
from ros2lab.diagnose.explaining.not_found import no_executable, no_file, no_package, not_sourced
from ros2lab.diagnose.explaining.older_nodes import of_older_node
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
