"""Attributes of launch files in YAML whose values have the wrong shape: the ways in which each may be meant."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace

import yaml

from portable_ros2 import bounded_yaml
from ros2lab.diagnose.finding import in_a_row, lines_in_words
from ros2lab.diagnose.launching.entity_words import words_below
from ros2lab.diagnose.sources.slips import Slip

_SAID = re.compile(
    r"Attribute '(?P<name>[\w-]+)' of Entity '(?P<entity>\w+)' expected to be (?P<what>a list of|of type '<class 'str')"
    r"|Expected entity `(?P<parent>\w+)` to have children"
)
_Pair = tuple[yaml.ScalarNode, yaml.Node]


def shapes(said: str, text: str) -> Iterator[Slip]:
    """Yield the ways to write all that launch refuses for its shape, the likeliest first; none if it refuses something else."""
    match = _SAID.search(said)
    for number, way in enumerate(_ways(match, text) if match else ()):
        changed = way.text
        while match and (more := [*_ways(match, changed)][number : number + 1]):
            changed = more[0].text
        also = ", and likewise at the other places" * (changed != way.text)
        yield replace(way, text=changed, told=way.told + also)


def _ways(match: re.Match[str], text: str) -> Iterator[Slip]:
    """Yield the ways to write the first value that launch refuses for its shape."""
    try:
        bounded_yaml.load(text, yaml.BaseLoader, has_aliases=False)
        entries = [*_entries(yaml.compose(text, yaml.SafeLoader), "")]
    except yaml.YAMLError:
        return
    for above, key, value in entries:
        if match["parent"] == key.value and isinstance(value, yaml.MappingNode):
            ways = [_listed(text, value)]
        elif (match["entity"], match["name"]) != (above, key.value):
            continue
        elif match["what"] == "a list of":
            rows = [] if isinstance(value, yaml.SequenceNode) else _as_items(text, key.value, value)
            ways = [_written(text, (key, value), row) for row in rows]
        else:
            scalar = _as_text(text, value)
            ways = [_written(text, (key, value), [scalar], is_list=False)] if scalar else []
        if ways:
            yield from ways
            return


def _entries(node: yaml.Node | None, above: str) -> Iterator[tuple[str, yaml.ScalarNode, yaml.Node]]:
    """Yield the keys in a part of a file, each with the key above it and its value."""
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            yield above, key, value
            yield from _entries(value, key.value)
    for item in node.value if isinstance(node, yaml.SequenceNode) else ():
        yield from _entries(item, above)


def _as_items(text: str, name: str, value: yaml.Node) -> Iterator[list[str]]:
    """Yield what the items of a list may be that one mapping, or the path of a file, is written for."""
    first, second, *others = words_below(name)
    if isinstance(value, yaml.MappingNode):
        pairs = [(_raw(text, key), _raw(text, inner)) for key, inner in value.value]
        yield [f"{{{', '.join(f'{key}: {inner}' for key, inner in pairs)}}}"]
        yield [f"{{{first}: {key}, {second}: {inner}}}" for key, inner in pairs]
    elif "from" in others:
        yield [f"{{from: {_raw(text, value)}}}"]


def _as_text(text: str, value: yaml.Node) -> str:
    """Return a list of words as one text, and a number in quotes; empty for what is a text."""
    if isinstance(value, yaml.SequenceNode):
        return _on_a_line(" ".join(item.value for item in value.value if isinstance(item, yaml.ScalarNode)))
    is_text = isinstance(value, yaml.MappingNode) or value.tag.endswith(":str")
    return "" if is_text else f"'{_raw(text, value)}'"


def _raw(text: str, node: yaml.Node) -> str:
    """Return what is written of a part of a file, on one line."""
    written = text[node.start_mark.index : node.end_mark.index].rstrip()
    if "\n" not in written:
        return written
    built = yaml.safe_load(written if node.flow_style else " " * node.start_mark.column + written)
    return _on_a_line(built)


def _on_a_line(value: object) -> str:
    return str(yaml.safe_dump(value, default_flow_style=True, width=math.inf, sort_keys=False)).split("\n")[0]


def _written(text: str, pair: _Pair, rows: list[str], *, is_list: bool = True) -> Slip:
    """Return a key with another value: a list of some rows, or a text."""
    key, value = pair
    start, end = key.start_mark, len(text[: value.end_mark.index].rstrip())
    first, last = start.line + 1, text.count("\n", 0, end) + 1
    lines = [f"{key.value}:", *(f"- {row}" for row in rows)] if is_list else [f"{key.value}: {rows[0]}"]
    told = f"write {in_a_row([f'`{line}`' for line in lines])} instead of {lines_in_words(first, last)}"
    new = f"\n{' ' * start.column}".join(lines)
    if text[start.index - start.column : start.index].strip(" -"):  # inside brackets
        new = f"{key.value}: [{', '.join(rows)}]" if is_list else lines[0]
        told = f"write `{new}` instead of `{text[start.index : end]}`"
    return Slip(first, told, text[: start.index] + new + text[end:])


def _listed(text: str, value: yaml.MappingNode) -> Slip:
    """Return the keys of a mapping as the items of a list, each with a dash in the place of two spaces before it."""
    new, names = text, list[str]()
    for key, _ in reversed(value.value):
        start = key.start_mark.index
        new = f"{new[: start - 2]}- {new[start:]}"
        names.insert(0, f"`{key.value}:`")
    told = f"write `- ` in the place of the two spaces before {in_a_row(names)}"
    return Slip(value.start_mark.line + 1, told, new)
