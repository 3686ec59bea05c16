"""How the checks read a student's package.xml."""

from __future__ import annotations

from pathlib import Path

from catkin_pkg.package import InvalidPackage, Package, parse_package

from ros2lab import course
from ros2lab.checks import CheckError
from ros2lab.manifest_words import NOT_TAKEN, fault_of


def manifest_of(folder: Path) -> Package:
    """Return what the package.xml in a folder says.

    Raises:
        CheckError: if there is none, or it is not valid; it says so in catkin_pkg's words.
    """
    file = folder / "package.xml"
    shown = course.shown_path(file)
    if not file.is_file():
        raise CheckError(
            shown, "no such file", "run the cell that makes the package; its folder lies in src."
        )
    try:
        return parse_package(str(file), warnings=[])
    except (InvalidPackage, OSError, *NOT_TAKEN) as error:
        raise CheckError(
            f"{shown} can be read",
            fault_of(error, file.read_text(encoding="utf-8", errors="replace")),
            "change what it says there: each tag that opens is closed by the same name, and name, version, "
            "description, maintainer (with an email) and license stand in each package.xml.",
        ) from error


def names_in_export(package: Package) -> set[str]:
    """Return the dependencies that stand in `<export>`, where no tool looks for them."""
    return {str(export.content) for export in package.exports if export.tagname.endswith("depend")}
