"""The commands of a CMakeLists.txt, and the programs that they make."""

from __future__ import annotations

import re

from portable_ros2.new_package import NewPackage
from ros2lab.diagnose.sources.package import SourcePackage

_COMMAND = re.compile(r"^\s*(\w+)\s*\(", re.MULTILINE)
# Those that make no program, or name it.
_PLAIN = re.compile(
    r"add_executable|add_library|install|ament_(?:target|export|python_install)_\w+|target_\w+|rosidl_generate_interfaces"
)


def commands_in(text: str) -> set[str]:
    """Return the commands of a CMakeLists.txt besides those that `ros2 pkg create` writes, which make nothing yet."""
    begun = NewPackage("new", "ament_cmake", 3, "", "", "", "", []).render("ament_cmake/CMakeLists.txt")
    return {*_COMMAND.findall(text.lower())} - {*_COMMAND.findall(begun)}


def programs_of(package: SourcePackage) -> list[str] | None:
    """Return the programs that a CMakeLists.txt makes or installs by their names; None if there may be others."""
    text = package.cmake
    taken = re.findall(r"\binstall\s*\(\s*PROGRAMS\b([^()]*?)DESTINATION", text)
    names = re.findall(r"\badd_executable\s*\(\s*(\S+)", text) + [
        name for row in taken for name in row.split()
    ]
    is_open = re.search(r"RENAME|SCRIPTS_DESTINATION|DIRECTORY[^()]*DESTINATION\s+lib", text)
    has_variable = any("$" in name.rpartition("/")[2] for name in names)
    if (
        is_open
        or has_variable
        or not package.is_built_by_cmake
        or not all(map(_PLAIN.fullmatch, commands_in(text)))
    ):
        return None
    return [name.strip('"').rpartition("/")[2] for name in names]
