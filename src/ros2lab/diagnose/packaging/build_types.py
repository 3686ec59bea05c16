"""Where a build type must be written in a package.xml, and with how much around it: that depends on what is there."""

from __future__ import annotations

import re

from ros2lab.diagnose.sources.commented_out import without_comments

_ELEMENT = re.compile(r"<build_type\b[^<>]*(?:/>|>[^<>]*</build_type\s*>)")
_EXPORT = re.compile(r"<export\b[^<>]*>")


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
        return (
            f"add `{element}` below <export>"
            if is_alone
            else f"write `{whole}{element}` instead of `{whole}`"
        )
    if "\n" in whole:
        return f"write `{element}` instead of lines {line} to {line + whole.count(chr(10))}"
    return f"write `{element}` instead of `{whole}`" if around.strip() else f"write `{element}`"
