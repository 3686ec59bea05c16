"""YAML whose every value knows its line, so that an error can name it."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from typing import Any

import yaml

# libyaml, where there is one, takes a tenth of the time. It is for files of our own: nothing keeps it from nesting too deeply.
QUICK = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

_LARGEST = sys.float_info.max


class Reader:
    """Reads what a person has written into a YAML file.

    Args:
        name: of the file, as errors show it.
        error: the exception that is raised, with one sentence, wherever the text is not what is wanted.
    """

    def __init__(self, name: str, error: type[Exception]) -> None:
        self.name = name
        self._error = error

    def root(self, text: str, loader: Any = yaml.SafeLoader) -> yaml.Node | None:
        """Return what the text holds, whose texts are all valid Unicode; None if it is empty."""
        try:
            node: yaml.Node | None = yaml.compose(text, loader)
        except RecursionError:
            raise self._error(f"{self.name}: it is nested too deeply; fix it there.") from None
        except yaml.YAMLError as error:
            mark = getattr(error, "problem_mark", None)
            line = f":{mark.line + 1}" if mark else ""
            reason = getattr(error, "problem", None) or getattr(error, "reason", None) or error
            raise self._error(f"{self.name}{line}: this is not YAML ({reason}); fix it there.") from None
        self._check_texts(node)
        return node

    def fields(self, node: yaml.Node, *names: str, optional: tuple[str, ...] = ()) -> dict[str, yaml.Node]:
        """Return the values of a mapping that has all of `names` and nothing else but `optional`."""
        found = {}
        for name, value in self.pairs(node):
            if name.value not in (*names, *optional):
                allowed = ", ".join((*names, *optional))
                raise self.error(name, f"{name.value!r} is not one of {allowed}")
            found[name.value] = value
        missing = [name for name in names if name not in found]
        if missing:
            raise self.error(node, f"{', '.join(missing)} is missing")
        return found

    def pairs(self, node: yaml.Node) -> Iterator[tuple[yaml.ScalarNode, yaml.Node]]:
        """Yield the names and values of a mapping, in which no name is there twice."""
        if not isinstance(node, yaml.MappingNode):
            raise self.error(node, "names with values are wanted here")
        seen = set()
        for name, value in node.value:
            if not isinstance(name, yaml.ScalarNode):
                raise self.error(name, "a name is wanted here")
            if name.value in seen:
                raise self.error(name, f"{name.value!r} is there twice")
            seen.add(name.value)
            yield name, value

    def items(self, node: yaml.Node) -> list[yaml.Node]:
        """Return the items of a list."""
        if not isinstance(node, yaml.SequenceNode):
            raise self.error(node, "a list is wanted here")
        return list(node.value)

    def number(self, node: yaml.Node, least: float, most: float = _LARGEST) -> float:
        """Return a finite number in a range, both ends included."""
        value = self.value(node)
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not is_number or not least <= value <= most:
            wanted = f"a number from {least:g}" + (f" to {most:g}" if most < _LARGEST else "")
            raise self.error(node, f"{wanted} is wanted here")
        return float(value)

    def text(self, node: yaml.Node) -> str:
        """Return a text that is not empty, on one line."""
        if not isinstance(node, yaml.ScalarNode) or not node.value.strip() or node.tag.endswith(":null"):
            raise self.error(node, "a text is wanted here")
        return " ".join(str(node.value).split())

    def any_text(self, node: yaml.Node) -> str:
        """Return a text as it is, also an empty one."""
        if not isinstance(node, yaml.ScalarNode) or node.tag.endswith(":null"):
            raise self.error(node, "a text is wanted here")
        return str(node.value)

    def matching(self, node: yaml.Node, pattern: re.Pattern[str], wanted: str) -> str:
        """Return a text that a pattern fits as a whole; an error says that `wanted` is."""
        text = self.text(node)
        if not pattern.fullmatch(text):
            raise self.error(node, f"{wanted} is wanted here, not {text!r}")
        return text

    def value(self, node: yaml.Node) -> Any:
        """Return a plain value."""
        try:
            return yaml.SafeLoader("").construct_object(node, deep=True)
        except (yaml.YAMLError, ValueError, RecursionError):
            raise self.error(node, "a plain value is wanted here") from None

    def _check_texts(self, root: yaml.Node | None) -> None:
        """Refuse half a character, which YAML can name and nothing can write or send."""
        nodes, seen = [root], set[int]()
        while nodes:
            node = nodes.pop()
            if id(node) in seen:  # by another name
                continue
            seen.add(id(node))
            if isinstance(node, yaml.MappingNode):
                nodes += (part for pair in node.value for part in pair)
            elif isinstance(node, yaml.SequenceNode):
                nodes += node.value
            elif isinstance(node, yaml.ScalarNode) and not node.value.isascii():
                try:
                    node.value.encode()
                except UnicodeEncodeError:
                    raise self.error(node, "a text of whole characters is wanted here") from None

    def error(self, node: yaml.Node, what: str) -> Exception:
        """Return the exception that names the line of a value."""
        return self._error(f"{self.name}:{node.start_mark.line + 1}: {what}.")
