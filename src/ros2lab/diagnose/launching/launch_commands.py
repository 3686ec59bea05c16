"""The commands that launch files start: `ExecuteProcess` in Python, `executable` in XML and YAML."""

from __future__ import annotations

import ast
import contextlib
import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

from ros2lab.diagnose.finding import at, line_with
from ros2lab.diagnose.sources.python_source import PythonSource, read_source, read_text
from ros2lab.diagnose.sources.static_value import dotted, evaluate


@dataclass(frozen=True)
class Word:
    """A word of a command, as the file writes it; its text is None if it is known only when the file is loaded."""

    text: str | None
    written: str
    place: str


@dataclass(frozen=True)
class LaunchCommand:
    """A command that a launch file starts.

    Attributes:
        words: its words.
        is_read_by_shell: whether a shell takes it apart, so that quotes and variables mean something.
        is_python: whether it is a list of words in a Python file; otherwise it is one text, with quotes.
    """

    words: tuple[Word, ...]
    place: str
    is_read_by_shell: bool
    is_python: bool = True

    def told_as(self, shown: str) -> list[str] | None:
        """Return its words if launch shows this command, with its folder or without; None if it shows another one."""
        known = [re.escape(word.text) if word.text is not None else "(.+)" for word in self.words]
        match = re.fullmatch(rf"(?:\S*/)?{' '.join(known)} *", shown, re.DOTALL)
        if match is None:
            return None
        found = iter(match.groups())
        return [word.text if word.text is not None else next(found) for word in self.words]


def launch_commands(path: Path, shown: str) -> Iterator[LaunchCommand]:
    """Yield the commands that a launch file starts."""
    if path.suffix == ".py":
        source = read_source(path, "launch_file", shown)
        for call in source.calls:
            if (dotted(call.func) or "").endswith("ExecuteProcess"):
                yield from _of_call(source, call)
        return
    text = read_text(path)
    for written in _written(path, text):
        with contextlib.suppress(ValueError):
            place = at(shown, line_with(text, written[:20]))
            words = tuple(Word(word, word, place) for word in shlex.split(written))
            yield LaunchCommand(words, place, is_read_by_shell=False, is_python=False)


def _of_call(source: PythonSource, call: ast.Call) -> Iterator[LaunchCommand]:
    given = {keyword.arg: keyword.value for keyword in call.keywords}
    cmd = given.get("cmd")
    if isinstance(cmd, ast.Name) and len(source.stored.get(cmd.id, ())) == 1:
        cmd = source.stored[cmd.id][0]
    if isinstance(cmd, (ast.List, ast.Tuple)):
        words = tuple(Word(_text(source, item), ast.unparse(item), source.at(item)) for item in cmd.elts)
        is_shell = getattr(given.get("shell"), "value", False) is True
        yield LaunchCommand(words, source.at(cmd), is_read_by_shell=is_shell)


def _text(source: PythonSource, item: ast.expr) -> str | None:
    """Return the text of a word; None if only launch can tell it."""
    match item:
        case ast.List(elts=parts) | ast.Tuple(elts=parts):
            texts = [_text(source, part) for part in parts]
            return None if None in texts else "".join(text for text in texts if text is not None)
        case ast.Call(func=func, args=[], keywords=[ast.keyword(arg="name", value=name)]) if (
            dotted(func) or ""
        ).endswith("FindExecutable"):
            return _text(source, name)
    value = evaluate(item, source.constants, {})
    return value if isinstance(value, str) else None


def _written(path: Path, text: str) -> Iterator[str]:
    """Yield the commands as an XML or a YAML file writes them."""
    if path.suffix in (".yaml", ".yml"):
        yield from (
            match[2] for match in re.finditer(r"""^\s*-?\s*cmd:\s*(["']?)(.+?)\1\s*$""", text, re.MULTILINE)
        )
        return
    with contextlib.suppress(ElementTree.ParseError):
        # expat itself stops where entities would become too much.
        for node in ElementTree.fromstring(text).iter("executable"):  # noqa: S314
            yield node.get("cmd", "")
