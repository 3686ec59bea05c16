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


def asked_for(meaning: Meaning, groups: _Groups, error: ErrorText, look: Look | None) -> Finding | None:
    """Say why a command did not find a package, an executable or a file; None for other errors."""
    if "file-not-found" in meaning.codes:
        return no_file(groups["name"], groups["package"], look)
    rule = _RULES.get(meaning.codes[0])
    return rule(groups, error, look) if rule else None


def _package(groups: _Groups, error: ErrorText, look: Look | None) -> Finding | None:
    return no_package(groups["name"] or groups["name2"], look, error)


def _executable(_: _Groups, error: ErrorText, look: Look | None) -> Finding | None:
    return no_executable(error.command, look, error.typed)


def _built(_: _Groups, error: ErrorText, look: Look | None) -> Finding | None:
    return no_prerequisite(error, look)


def _older(_: _Groups, error: ErrorText, look: Look | None) -> Finding | None:
    return of_older_node(error, look) if look else None


def _copied(groups: _Groups, _: ErrorText, look: Look | None) -> Finding | None:
    copied = (folder_copied(groups["name"], package) for package in (look.packages if look else ()))
    return next(filter(None, copied), None)


def _command(groups: _Groups, error: ErrorText, look: Look | None) -> Finding | None:
    reset = not_sourced(groups["name"], error.typed, error.text, look.root) if look else None
    return reset if reset and "removes" in reset.cause else None


def _metadata(groups: _Groups, error: ErrorText, look: Look | None) -> Finding | None:
    name = groups["name"].replace("-", "_")
    is_own = look is not None and any(package.name == name for package in look.packages)
    return not_sourced(name, error.typed, error.text, look.root) if look and is_own and error.typed else None


_RULES: Mapping[str, Callable[[_Groups, ErrorText, Look | None], Finding | None]] = {
    "package-not-found": _package,
    "executable-missing": _executable,
    "data-file-missing": _copied,
    "not-built": _built,
    "command-not-found": _command,
    "name-twice": _older,
    "not-sourced": _metadata,
}
