r"""Texts with substitutions, such as `$(find-pkg-share demo)/config/$(var name).yaml`.

The arguments of a substitution are separated by one space each. An argument with spaces or parentheses
stands between quotes; a backslash takes a character as it is.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

from launch import substitutions
from launch.frontend import load_extension
from launch.substitution import Substitution
from launch.substitutions import TextSubstitution

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")


def parse_substitution(text: str) -> list[Substitution]:
    """Return the substitutions in a text.

    Raises:
        ValueError: if a substitution is not complete.
        RuntimeError: if there is none of this name.
        TypeError: if it takes another number of arguments.
    """
    if not text:
        return [TextSubstitution(text="")]
    load_extension()
    return _Reader(text).fragments(end="")


def unescaped(text: str) -> str:
    """Return a text without the backslashes before characters."""
    return re.sub(r"\\(.)", r"\1", text)


class _Reader:
    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0

    def fragments(self, end: str) -> list[Substitution]:
        """Read texts and substitutions up to a quote, or to the end of all."""
        found: list[Substitution] = []
        while self.at < len(self.text) and not (end and self.text[self.at] == end):
            found.append(self.substitution() if self._is_substitution() else self._plain(end))
        if end:
            self._expect(end)
        return found

    def substitution(self) -> Substitution:
        """Read `$(name argument ...)`."""
        self.at += len("$(")
        name = _NAME.match(self.text, self.at)
        if name is None:
            raise self._error("a name")
        self.at = name.end()
        arguments = []
        while self._next() == " ":
            self.at += 1
            if self._next() not in (" ", ")"):
                arguments.append(self._argument())
        self._expect(")")
        return _made(name.group(), arguments)

    def _argument(self) -> list[Substitution]:
        quote = self._next()
        if quote in ("'", '"'):
            self.at += 1
            return self.fragments(end=quote) or [TextSubstitution(text="")]
        found: list[Substitution] = []
        while self._next() not in ("", " ", ")"):
            found.append(self.substitution() if self._is_substitution() else self._plain(" ()'\""))
        return found

    def _plain(self, ends: str) -> TextSubstitution:
        start = self.at
        while self.at < len(self.text) and self.text[self.at] not in ends and not self._is_substitution():
            self.at += 2 if self.text[self.at] == "\\" else 1
        if self.at == start:
            raise self._error("a ')'")
        self.at = min(self.at, len(self.text))
        return TextSubstitution(text=unescaped(self.text[start : self.at]))

    def _is_substitution(self) -> bool:
        return self.text.startswith("$(", self.at)

    def _next(self) -> str:
        return self.text[self.at : self.at + 1]

    def _expect(self, character: str) -> None:
        if self._next() != character:
            raise self._error(f"a {character!r}")
        self.at += 1

    def _error(self, expected: str) -> ValueError:
        rest = self.text[self.at :] or "its end"
        return ValueError(f"Expected {expected} in the text '{self.text}' before {rest!r}.")


def _made(name: str, arguments: list[list[Substitution]]) -> Substitution:
    if name not in SUBSTITUTIONS:
        raise RuntimeError(f"Unknown substitution: {name}")
    make, least, most = SUBSTITUTIONS[name]
    if not least <= len(arguments) <= most:
        raise TypeError(f"{name} substitution expects {_number(least, most)}, got {len(arguments)}")
    made: Substitution = make(*arguments)
    return made


def _number(least: int, most: int) -> str:
    if least == most:
        return "no arguments" if most == 0 else "1 argument" if most == 1 else f"{most} arguments"
    return f"{least} or {most} arguments" if most < MANY else f"{least} or more arguments"


def _variable(name: list[Substitution], default: list[Substitution] | None = None) -> Substitution:
    return substitutions.LaunchConfiguration(name, default=default)


def _environment(name: list[Substitution], default: list[Substitution] | None = None) -> Substitution:
    return substitutions.EnvironmentVariable(name, default_value=default)


def _command(command: list[Substitution], on_stderr: list[Substitution] | None = None) -> Substitution:
    return substitutions.Command(command, on_stderr=on_stderr or "fail")


def _expression(expression: list[Substitution], modules: list[Substitution] | None = None) -> Substitution:
    if modules is None:
        return substitutions.PythonExpression(expression)
    text = "".join(sub.text for sub in modules if isinstance(sub, TextSubstitution))
    return substitutions.PythonExpression(
        expression, [name.strip() for name in text.split(",") if name.strip()]
    )


MANY = 99
# How each is made, and how many arguments it takes at least and at most.
SUBSTITUTIONS: dict[str, tuple[Callable[..., Any], int, int]] = {
    "all": (substitutions.AllSubstitution, 0, MANY),
    "and": (substitutions.AndSubstitution, 2, 2),
    "anon": (substitutions.AnonName, 1, 1),
    "any": (substitutions.AnySubstitution, 0, MANY),
    "command": (_command, 1, 2),
    "dirname": (substitutions.ThisLaunchFileDir, 0, 0),
    "env": (_environment, 1, 2),
    "equals": (substitutions.EqualsSubstitution, 2, 2),
    "eval": (_expression, 1, 2),
    "file-content": (substitutions.FileContent, 1, 1),
    "filename": (substitutions.ThisLaunchFile, 0, 0),
    "find-exec": (substitutions.FindExecutable, 1, 1),
    "if": (substitutions.IfElseSubstitution, 2, 3),
    "launch_log_dir": (substitutions.LaunchLogDir, 0, 0),
    "log_dir": (substitutions.LaunchLogDir, 0, 0),
    "not": (substitutions.NotSubstitution, 1, 1),
    "not-equals": (substitutions.NotEqualsSubstitution, 2, 2),
    "or": (substitutions.OrSubstitution, 2, 2),
    "var": (_variable, 1, 2),
}
