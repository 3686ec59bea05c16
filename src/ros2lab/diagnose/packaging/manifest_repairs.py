"""What to write into a manifest: the change by which catkin_pkg accepts it, or its build type."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from typing import Any

from ros2lab.diagnose.packaging.tag_repairs import IN_EXPORT, TAGS, tag_slips
from ros2lab.diagnose.sources.commented_out import without_comments
from ros2lab.diagnose.sources.slips import ALL, Vocabulary, likeliest
from ros2lab.diagnose.sources.xml_slips import xml_repair
from ros2lab.manifest_words import NOT_TAKEN

_MOST = 20_000  # characters of the longest manifest to repair
_WORDS = Vocabulary(
    TAGS,
    {"": ("package",), "export": IN_EXPORT},
    {*TAGS, *IN_EXPORT} - {"export"},
    {"package": '<package format="3">'},
)


def repaired(text: str, keywords: Mapping[str, Any]) -> tuple[int, str] | None:
    """Return a line and how to repair it, also from the arguments of setup(); None if no small change helps."""
    if len(text) > _MOST or "<!DOCTYPE" in text:
        return None
    slip = xml_repair(text, _WORDS, _is_read) or likeliest(
        text, tag_slips(text, keywords), lambda changed: ALL if _is_read(changed) else 0
    )
    return (slip.line, slip.told) if slip else None


def build_type_written(text: str, kind: str) -> tuple[int | None, str]:
    """Return the line at which a manifest gets a build type, and how; None for a manifest without an end."""
    bare, element = without_comments(text), f"<build_type>{kind}</build_type>"
    for pattern in (_ELEMENT, _EXPORT):
        if match := pattern.search(bare):
            line = bare.count("\n", 0, match.start()) + 1
            return line, _instead(match, bare, line, element)
    end = bare.rfind("</package")
    line_of_end = bare.count("\n", 0, end) + 1 if end >= 0 else None
    return line_of_end, f"add `<export>{element}</export>` above </package>"


def _is_read(text: str) -> bool:
    """Return whether catkin_pkg accepts a manifest."""
    # A late import, as in `package`: few manifests need a repair.
    from catkin_pkg.package import InvalidPackage, parse_package_string

    try:
        ET.fromstring(text)  # noqa: S314 -- a student's own file, without entities from elsewhere
        parse_package_string(text)
    except (ET.ParseError, InvalidPackage, *NOT_TAKEN):
        return False
    return True


_ELEMENT = re.compile(r"<build_type\b[^<>]*(?:/>|>[^<>]*</build_type\s*>)")
_EXPORT = re.compile(r"<export\b[^<>]*>")


def _instead(match: re.Match[str], bare: str, line: int, element: str) -> str:
    """Say how an element is written over the build type that is there, or into the export that lacks it."""
    whole = match[0]
    around = (
        bare[bare.rfind("\n", 0, match.start()) + 1 : match.start()] + bare[match.end() :].partition("\n")[0]
    )
    if whole.startswith("<export"):
        if whole.endswith("/>"):
            return f"write `<export>{element}</export>` instead of `{whole}`"
        is_alone = not around.strip()
        if is_alone:
            return f"add `{element}` below <export>"
        return f"write `{whole}{element}` instead of `{whole}`"
    if "\n" in whole:
        return f"write `{element}` instead of lines {line} to {line + whole.count(chr(10))}"
    return f"write `{element}` instead of `{whole}`" if around.strip() else f"write `{element}`"
