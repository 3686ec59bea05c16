"""Slips in the tags of a manifest that is XML, but that catkin_pkg rejects."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from ros2lab.diagnose.finding import line_with
from ros2lab.diagnose.sources.slips import Lines, Slip

# What REP 149 knows: tags of a package, and those that stand in <export>.
_DEPENDS = (
    "depend",
    "exec_depend",
    "build_depend",
    "build_export_depend",
    "buildtool_depend",
    "buildtool_export_depend",
    "test_depend",
    "doc_depend",
)
_NEEDED = ("name", "version", "description", "maintainer", "license")
TAGS = (
    *_NEEDED,
    "author",
    "url",
    "export",
    "conflict",
    "replace",
    "member_of_group",
    "group_depend",
    *_DEPENDS,
)
IN_EXPORT = ("build_type", "architecture_independent", "deprecated", "metapackage", "message_generator")
_ELEMENT = re.compile(r"<(?P<tag>[\w-]+)(?P<attributes>(?: [^<>]*)?)>(?P<content>[^<>]*)</(?P=tag)>")
_EMAIL = re.compile(r"[\w.+-]+@[\w-]+(?:\.[\w-]+)+")
_ALIKE = 0.55  # how similar a tag and the right one are, from 0 to 1


def tag_slips(text: str, keywords: Mapping[str, Any]) -> Iterator[Slip]:
    """Yield a manifest with a change of one tag, the likeliest first; the keywords of setup() say some of the same."""
    for rank, slip in enumerate(_changes(Lines(text), keywords)):
        yield replace(slip, cost=rank / 1000)


def _changes(lines: Lines, keywords: Mapping[str, Any]) -> Iterator[Slip]:
    text = "\n".join(lines.all)
    begin = line_with(text, "<export>") or 0
    end = line_with(text, "</export>", start=begin or 1) or 0
    every = [(n, match) for n, line in enumerate(lines.all, 1) for match in _ELEMENT.finditer(line)]
    spots = [(n, match) for n, match in every if not begin <= n <= end]
    own = next((match["content"].strip() for _, match in spots if match["tag"] == "name"), "")
    for number, match in spots:
        if match["tag"] in IN_EXPORT:
            yield _into_export(lines, number, match[0], begin)
    for number, match in spots:
        yield from _rewritten(lines, number, match, keywords)
    yield from _of_package(lines)
    for number, match in spots:
        others = [n for n, other in spots if other["tag"] == match["tag"] and n < number]
        if others or match["tag"] in _DEPENDS or match["tag"] not in TAGS:
            why = f": line {others[0]} has a <{match['tag']}> too" if others else ""
            if match["tag"] in _DEPENDS:  # of which there may be several
                is_itself = match["content"].strip() == own
                why = ": a package does not depend on itself" if is_itself else ""
            slip = lines.removed(number)
            yield replace(slip, told=f"{slip.told}{why}")
    yield from _added(lines, {match["tag"]: number for number, match in spots}, keywords)


def _into_export(lines: Lines, number: int, element: str, begin: int) -> Slip:
    if not begin:
        return lines.written(number, f"<export>{element}</export>")
    moved = [*lines.all[:begin], element, *lines.all[begin:]]
    del moved[number if number > begin else number - 1]
    return Slip(number, f"move this line below <export> on line {begin}", "\n".join(moved))


def _rewritten(
    lines: Lines, number: int, match: re.Match[str], keywords: Mapping[str, Any]
) -> Iterator[Slip]:
    """Yield a line with another tag, other attributes or another content of its element."""
    tag, content, attributes = match["tag"], match["content"].strip(), match["attributes"]
    new: list[str] = []
    if tag not in TAGS:
        near = difflib.get_close_matches(tag, TAGS, n=3, cutoff=_ALIKE)
        wanted = ["exec_depend"] if tag == "run_depend" else near
        new += [f"<{better}{attributes}>{match['content']}</{better}>" for better in wanted]
    if tag == "maintainer":
        new.append(_maintainer(content, attributes, keywords))
    if tag == "version" and (digits := re.findall(r"\d+", content)):
        new.append(f"<version>{'.'.join([*digits, '0', '0'][:3])}</version>")
    if tag == "name":
        new.append(f"<name>{re.sub(r'[^a-z0-9_]+', '_', content.lower()).strip('_')}</name>")
    if attributes:
        new.append(f"<{tag}>{content}</{tag}>")
    yield from (lines.written(number, lines[number].replace(match[0], text)) for text in new)


def _maintainer(content: str, attributes: str, keywords: Mapping[str, Any]) -> str:
    """Return a maintainer with an address: the one that stands there, else that of setup.py."""
    told = [*_EMAIL.findall(f"{attributes} {content} {keywords.get('maintainer_email')}")]
    name = _EMAIL.sub("", content).strip(" <>(),") or str(keywords.get("maintainer") or "me")
    address = (
        told[0] if told else f"{re.sub(r'[^a-z0-9]+', '.', name.lower()).strip('.') or 'me'}@example.com"
    )
    return f'<maintainer email="{address}">{name}</maintainer>'


def _of_package(lines: Lines) -> Iterator[Slip]:
    """Yield the manifest with the right root tag and format."""
    for number, line in enumerate(lines.all, 1):
        if match := re.match(r"\s*<(?P<tag>[a-z]\w*)(?: [^<>]*)?>\s*$", line):
            new = '<package format="3">'
            ends = (n for n, text in enumerate(lines.all, 1) if f"</{match['tag']}>" in text)
            last = max(ends, default=number)
            below = [*lines.all[: number - 1], new, *lines.all[number:]]
            below[last - 1] = below[last - 1].replace(f"</{match['tag']}>", "</package>")
            more = f", and `</package>` on line {last}" if match["tag"] != "package" else ""
            yield Slip(number, f"write `{new}`{more}", "\n".join(below))
            return


def _added(lines: Lines, known: Mapping[str, int], keywords: Mapping[str, Any]) -> Iterator[Slip]:
    """Yield the manifest with one of the tags that every package needs, filled from setup.py if that says it."""
    for tag in (needed for needed in _NEEDED if needed not in known):
        given = keywords.get(tag) if isinstance(keywords.get(tag), str) else ""
        usual = {"version": "0.0.0", "license": "Apache-2.0"}.get(tag) or str(
            keywords.get("name") or "my package"
        )
        new = f"<{tag}>{given or usual}</{tag}>"
        if tag == "maintainer":
            new = _maintainer("", "", keywords)
        before = [known[other] for other in _NEEDED[: _NEEDED.index(tag)] if other in known]
        yield lines.added(max(before, default=line_with("\n".join(lines.all), "<package") or 1), new)
