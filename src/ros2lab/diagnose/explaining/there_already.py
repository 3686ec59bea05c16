"""Explains that a command, or a line of a program, does not make what exists already."""

from __future__ import annotations

import re
from pathlib import PurePath
from shlex import quote

from ros2lab.diagnose.explaining.own_words import is_own_log
from ros2lab.diagnose.finding import SAID, Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.transcript import Step, words_in

# As `ros2 bag record`, `git clone` and `mkdir` put it.
_SAYS = re.compile(r"['\u2018]([^'\u2019]+)['\u2019](?: already exists\b|: File exists$)")
_MAKES_FOLDER = re.compile(r"\b(?:mkdir|makedirs)\(")


def of_existing(line: str, step: Step, look: Look) -> Finding | None:
    """Say what to do about a path that a line calls existing already; None if it names no path that was to be made."""
    said = _SAYS.search(line)
    if said is None:
        return None
    path, words = said[1].removeprefix("./").rstrip("/"), words_in(step.command)
    # A program may say of anything that it exists.
    is_made = any(PurePath(path).name in (PurePath(word).name, PurePath(word).stem) for word in words)
    return _existing(path, step.command) if is_made or (not words and not is_own_log(line, look)) else None


def _existing(path: str, command: str) -> Finding:
    """Say how to keep what exists already at a path, and how to make another."""
    cause = f"{path} exists already, so {command.split(maxsplit=1)[0] if command else 'the command'} does not make it."
    other = re.sub(rf"(?<!\S){re.escape(path)}(?!\S)", f"{path}_2", command)
    another = f"type `{other}`, or first " if other != command else ""
    away = f"mv {quote(path)} {quote(f'{path}_old')}"
    fix = f"if the one that exists will do, go on with it; else {another}move it away with `{away}`"
    return Finding(SAID, cause, "", fix)


def existing_folder(path: str, text: str, place: str) -> Finding | None:
    """Say how a line of a program may make a folder that exists already; None if the line makes none."""
    if not _MAKES_FOLDER.search(text):
        return None
    cause = f"{path!r} exists already, and this line makes only what does not exist yet."
    fix = f"if it may exist, write os.makedirs({path!r}, exist_ok=True), or .mkdir(exist_ok=True) of a Path"
    return Finding(SAID, cause, place, fix)
