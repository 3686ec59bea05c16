"""Repair an invalid manifest: try small changes until it is XML and catkin_pkg accepts it."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from typing import Any

from ros2lab.diagnose.packaging.tag_repairs import IN_EXPORT, TAGS, tag_slips
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
    """Return the number of a line and how to repair it; None if no small change makes the manifest better.

    The keywords are the arguments of setup(), which say some of the same.
    """
    if len(text) > _MOST or "<!DOCTYPE" in text:
        return None
    slip = xml_repair(text, _WORDS, _is_read) or likeliest(
        text, tag_slips(text, keywords), lambda changed: ALL if _is_read(changed) else 0
    )
    return (slip.line, slip.told) if slip else None


def _is_read(text: str) -> bool:
    """Return whether catkin_pkg accepts a manifest."""
    # A late import, as in `package`: few manifests need a repair.
    from catkin_pkg.package import InvalidPackage, parse_package_string

    try:
        ET.fromstring(text.encode())  # noqa: S314 -- a student's own file, without entities from elsewhere
        parse_package_string(text)
    except (ET.ParseError, InvalidPackage, *NOT_TAKEN):
        return False
    return True
