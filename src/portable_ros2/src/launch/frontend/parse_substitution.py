r"""Texts with substitutions, such as `$(find-pkg-share demo)/config/$(var name).yaml`.

The arguments of a substitution are separated by one space each. An argument with spaces or parentheses
stands between quotes; a backslash takes a character as it is.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from launch import substitutions
from launch.frontend.expose import Parsed, expose_substitution, instantiate_substitution
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
    return _Reader(text).fragments(end="")


def parse_if_substitutions(value: Any) -> Any:
    """Return a value in which texts with substitutions, if there are any, are replaced by these.

    Raises:
        ValueError: if it is a list of several types.
    """
    if isinstance(value, list):
        items = [parse_if_substitutions(item) for item in value]
        if len({type(item) for item in items} - {list}) > 1:
            raise ValueError(f"The items of a list must be of one type, not {value}.")
        return items
    if not isinstance(value, str):
        return value
    subs = parse_substitution(value)
    return subs[0].text if len(subs) == 1 and isinstance(subs[0], TextSubstitution) else subs


def replace_escaped_characters(data: str) -> str:
    """Return a text without the backslashes before characters."""
    return re.sub(r"\\(.)", r"\1", data)


def expose(name: str, make: Callable[..., Substitution], least: int, most: int) -> None:
    """Let a substitution of this name be made by a class, of so many arguments at least and at most."""

    def parse(data: Iterable[Any]) -> Parsed:
        arguments = list(data)
        if not least <= len(arguments) <= most:
            raise TypeError(f"{name} substitution expects {_number(least, most)}, got {len(arguments)}")
        return partial(make, *arguments), {}

    expose_substitution(name)(parse)


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
        return instantiate_substitution(name.group(), arguments)

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
        return TextSubstitution(text=replace_escaped_characters(self.text[start : self.at]))

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
expose("all", substitutions.AllSubstitution, 0, MANY)
expose("and", substitutions.AndSubstitution, 2, 2)
expose("anon", substitutions.AnonName, 1, 1)
expose("any", substitutions.AnySubstitution, 0, MANY)
expose("command", _command, 1, 2)
expose("dirname", substitutions.ThisLaunchFileDir, 0, 0)
expose("env", _environment, 1, 2)
expose("equals", substitutions.EqualsSubstitution, 2, 2)
expose("eval", _expression, 1, 2)
expose("file-content", substitutions.FileContent, 1, 1)
expose("filename", substitutions.ThisLaunchFile, 0, 0)
expose("find-exec", substitutions.FindExecutable, 1, 1)
expose("if", substitutions.IfElseSubstitution, 2, 3)
expose("launch_log_dir", substitutions.LaunchLogDir, 0, 0)
expose("log_dir", substitutions.LaunchLogDir, 0, 0)
expose("not", substitutions.NotSubstitution, 1, 1)
expose("not-equals", substitutions.NotEqualsSubstitution, 2, 2)
expose("or", substitutions.OrSubstitution, 2, 2)
expose("var", _variable, 1, 2)
