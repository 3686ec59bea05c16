"""Errors of commands that a launch file starts, traced to the words that it gives them."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ros2lab.diagnose.explaining.commands import as_meant, in_shell
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_commands import LaunchCommand, launch_commands
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.transcript import words_in

_DIED = re.compile(r"process has died \[pid \d+, exit code (?!-2\b)-?\d+, cmd '(?P<cmd>.*)'\]")
_QUOTED = re.compile(r"""(["'])(?P<inner>.*)\1""", re.DOTALL)
_OF_YAML = re.compile(r"[{\[]|\w:")  # what a message in quotes begins with, or has in it
_OF_SHELL = frozenset(("|", "||", "&&", ">", ">>", "<", ";", "2>&1"))
_EXPANDED = {"$": "os.path.expandvars", "~": "os.path.expanduser"}


def of_launched_command(error: ErrorText, look: Look) -> Finding | None:
    """Say which word of a launch file's command that failed is wrong; None if none is, or for an exception."""
    died = [match["cmd"] for match in _DIED.finditer(error.text)] if not error.reports else []
    files = look.launches if died else []
    commands = [command for file, path in files for command in launch_commands(path, file.shown)]
    for shown in died:
        for command in commands:
            words = command.told_as(shown)
            if words and (found := _fault(command, words, error, look)):
                return found
    return None


def _fault(command: LaunchCommand, words: list[str], error: ErrorText, look: Look) -> Finding | None:
    if not command.is_read_by_shell and command.is_python and (found := _without_shell(command, words)):
        return found
    bare = [_bare(word, error) if command.is_python else word for word in words]
    if command.is_read_by_shell:
        bare = words
        line = " ".join(words)
    else:
        line = " ".join(map(in_shell, bare))
    meant = as_meant(line, error, look)
    right = words_in(meant.line) if meant else [*bare]
    if command.is_read_by_shell and meant:
        return Finding("launch-argument", meant.why, command.place, f"write `cmd=[{meant.line!r}]`")
    if right == words:
        return None
    why = meant.why if meant else ""
    if bare != words:
        quoted = next(word for word, other in zip(words, bare, strict=True) if word != other)
        why = f"No shell reads cmd, so the quotes inside {quoted!r} are passed on as part of the text."
    return Finding("launch-argument", why, *_written(command, words, right))


def _bare(word: str, error: ErrorText) -> str:
    """Return a word without the quotes that only a shell would take away; as it is if they may be meant."""
    match = _QUOTED.fullmatch(word)
    if match is None:
        return word
    others = [line for line in error.text.splitlines() if not _DIED.search(line)]
    is_named = any(word in line for line in others)
    return match["inner"] if is_named or _OF_YAML.search(match["inner"]) else word


def _written(command: LaunchCommand, words: Sequence[str], right: Sequence[str]) -> tuple[str, str]:
    """Return where a command is to be changed, and what is to be written there."""
    if not command.is_python:
        line = " ".join(map(in_shell, right))
        return command.place, f"""write {line if '"' in line else f'"{line}"'} as its cmd"""
    rows = zip(command.words, words, right, strict=False) if len(words) == len(right) else ()
    pairs = [(word, new) for word, old, new in rows if old != new]
    if not pairs:
        return command.place, f"write `cmd={[*right]!r}`"
    fixes = [f"`{new!r}` instead of `{word.written}`" for word, new in pairs]
    return pairs[0][0].place, f"write {' and '.join(fixes)}"


def _without_shell(command: LaunchCommand, words: Sequence[str]) -> Finding | None:
    """Return what only a shell would do with a word; None if there is no such word."""
    for word, text in zip(command.words, words, strict=True):
        if text in _OF_SHELL:
            whole = " ".join(other if other in _OF_SHELL else in_shell(other) for other in words)
            cause = f"No shell reads cmd, so {text} is passed on as a word like the others."
            return Finding("launch-argument", cause, word.place, f"write `cmd=[{whole!r}], shell=True`")
        if (sign := re.match(r"\$(?=\w|\{)|~(?=/|$)", text)) and word.text is not None:
            cause = f"No shell reads cmd, so {text} is passed on as it is, and not as the path that it stands for."
            fix = f"write `{_EXPANDED[sign[0]]}({word.written})` instead of `{word.written}`, with `import os` at the top"
            return Finding("launch-argument", cause, word.place, fix)
    return None
