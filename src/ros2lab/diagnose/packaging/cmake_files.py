"""What a CMakeLists.txt takes and makes, and the Python files that it leaves out."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from pathlib import Path

from ros2lab.diagnose.finding import Finding, at, line_with
from ros2lab.diagnose.sources.made_modules import commands_in
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import read_text
from ros2lab.diagnose.sources.spelling import nearest

_TAKES_FILES = re.compile(
    r"^[ \t]*(?:rosidl_generate_interfaces|add_executable|add_library|install)\s*\(([^()]*)\)", re.MULTILINE
)
_SOURCE = re.compile(r"(?<![\w./${}<:-])\w[\w./-]*/[\w.-]+\.(?:msg|srv|action|c|cc|cpp|py)(?![\w.])")


def named_by_cmake(package: SourcePackage) -> Iterator[Finding]:
    """Yield the files that a CMakeLists.txt takes under no condition, and that are not there."""
    text = package.cmake
    taking = [match for match in _TAKES_FILES.finditer(text) if match[1] and "OPTIONAL" not in match[1]]
    ifs = [(m.start(), -1 if m[1] else 1) for m in re.finditer(r"(?i)\b(end)?if\s*\(", text)]
    sure = [m for m in taking if sum(step for start, step in ifs if start < m.start()) == 0]
    named = dict.fromkeys(name for match in sure for name in _SOURCE.findall(match[1]))
    if lost := [name for name in named if not package.has(name)]:
        are, them = ("are", "them") if len(lost) > 1 else ("is", "it")
        cause = f"CMakeLists.txt takes {', '.join(lost)}, but there {are} no such file{'s' * (them == 'them')}, so the build stops."
        there = [path.relative_to(package.folder).as_posix() for path in package.own_files()]
        fix = f"create {them} in {package.shown('')}, or remove {them} from CMakeLists.txt"
        if near := nearest(
            lost[0], [path for path in there if Path(path).suffix == Path(lost[0]).suffix], 0.85
        ):
            fix = f"write {near} instead of {lost[0]}"
        yield Finding(
            "data-file-missing", cause, at(package.shown("CMakeLists.txt"), line_with(text, lost[0])), fix
        )


def launches_left(package: SourcePackage) -> Iterator[Finding]:
    """Yield the folders of launch files that a CMakeLists.txt surely does not install, with those that the files name."""
    text, files = package.cmake, [path for path in package.launch_files if path.parent != package.folder]
    paths = [path.relative_to(package.folder) for path in files]
    may_take = re.search(r"\b(?:include|add_subdirectory|foreach|function|macro)\s*\(", text, re.IGNORECASE)
    words = {*re.findall(r"[\w.-]+", text)}
    is_named = any(part in words for path in paths for part in path.parts)
    is_of_ament = "ament_package" in words
    if not files or not is_of_ament or may_take or is_named or _installs_by_folder(text, files, package):
        return
    folders = {path.parts[0] for path in paths}
    asked = {name for path in files for name in re.findall(r"(?<=['\"/])\w+(?=['\"/])", read_text(path))}
    folders |= {name for name in asked if (package.folder / name).is_dir() and name not in words}
    cause = f"CMakeLists.txt does not install {paths[0]}, so `ros2 launch` does not find it."
    fix = f"write `install(DIRECTORY {' '.join(sorted(folders))} DESTINATION share/${{PROJECT_NAME}})` above ament_package(), and build again"
    place = at(package.shown("CMakeLists.txt"), line_with(text, "ament_package"))
    yield Finding("not-in-data-files", cause, place, fix, tuple(path.name for path in files))


def python_alone(package: SourcePackage) -> list[str]:
    """Return the Python files that a CMake package does not install, those of one folder; none if it has, or names, anything to compile."""
    endings = ("cpp", "c", "cc", "msg", "srv", "action")
    compiled = [path for ending in endings for path in package.folder.rglob(f"*.{ending}")]
    folders = (
        package.folder / "src",
        package.folder / "scripts",
        package.folder / package.name,
        package.folder,
    )
    names = ("__init__.py", "setup.py")
    files = [path for folder in folders for path in sorted(folder.glob("*.py")) if path.name not in names]
    text = package.cmake
    makes = commands_in(text) - {"install"}
    groups = package.manifest.member_of_groups if package.manifest else ()
    if compiled or makes or groups or ".py" in text or _installs_by_folder(text, files, package):
        return []
    return [p.relative_to(package.folder).as_posix() for p in files if p.parent == files[0].parent]


def _installs_by_folder(text: str, files: Collection[Path], package: SourcePackage) -> bool:
    """Return whether a CMakeLists.txt may install files by the name of their folder, or by a variable."""
    for command in re.findall(r"\binstall\s*\(([^()]*)\)", text):
        taken = set(
            re.findall(r"[\w.-]+|\$\{", re.sub(r"\b(?:LIBRARY|RUNTIME)?\s*DESTINATION\s+\S+", "", command))
        )
        names = {part for path in files for part in path.relative_to(package.folder).with_suffix("").parts}
        if "${" in taken or "." in taken or names & taken:
            return True
    return False
