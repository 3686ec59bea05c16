"""Check that the packages, executables and parameter files that launch files name exist."""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Collection, Iterator, Mapping, Sequence

from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.launching.launch_file import Launched, LaunchFile
from ros2lab.diagnose.launching.logged import as_logged
from ros2lab.diagnose.launching.unread_words import unread_words
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.lying import lies_elsewhere
from ros2lab.diagnose.sources.made_modules import programs_of
from ros2lab.diagnose.sources.other_names import by_another_name, meant_function
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.spelling import (
    has_other_words,
    is_near_miss,
    nearest,
    program_words,
    same_letters,
)


def launch_faults(
    launch_file: LaunchFile,
    packages: Mapping[str, SourcePackage],
    executables: Mapping[str, Collection[str] | None],
) -> Iterator[Finding]:
    """Yield what a launch file names that does not exist, and what it starts that stays hidden or unread.

    The executables of a package are None where they are not known.
    """
    yield from launch_file.faults
    declared = {name for package in packages.values() for name in package.declared}
    for node in (node for node in launch_file.nodes if node.is_listed):
        if isinstance(node.package, str) and node.package not in packages:
            yield from _package_fault(node, node.package, packages, executables, declared)
        elif "/" in str(node.executable):
            yield from _file_fault(node, packages)
        elif isinstance(node.package, str) and isinstance(node.executable, str):
            others = [name for name, there in executables.items() if node.executable in (there or ())]
            yield from _executable_fault(
                node, packages[node.package], node.executable, executables.get(node.package), others
            )
        yield from _parameter_files(node, packages)
        yield from unread_words(node, packages)


def _package_fault(
    node: Launched,
    name: str,
    packages: Mapping[str, SourcePackage],
    executables: Mapping[str, Collection[str] | None],
    declared: Collection[str],
) -> Iterator[Finding]:
    """Yield a package that is not in the workspace, where one with nearly its name has the executable."""
    if name in declared or name in interfaces.PACKAGES or interfaces.folder_of(name) is not None:
        return
    # A package with another name that is not installed here would have another executable.
    near = (
        other
        for other, package in packages.items()
        if is_near_miss(name, other) and _may_have(package, node, executables.get(other))
    )
    if wanted := next(near, None):
        cause = f"The launch file starts a node of the package {name}, but the package is called {wanted}."
        fix = f"write {wanted} instead of {name}"
        yield Finding("launch-package", cause, node.place, fix)


def _executable_fault(
    node: Launched,
    package: SourcePackage,
    executable: str,
    there: Collection[str] | None,
    others: Sequence[str],
) -> Iterator[Finding]:
    """Yield an executable that its package does not have, perhaps as others do, or what it prints and nobody sees."""
    if there is None:
        yield from _not_made(node, package, executable)
    elif executable in there:
        yield from _prints(package, node) if node.output is None and not node.is_wrapped else ()
    elif module := _uncalled(package, executable):
        yield _no_entry_point(package, node, executable, module)
    else:
        meant = by_another_name(package, executable)
        wanted = program_words(executable)
        same = (name for name in sorted(there) if program_words(name) == wanted)
        alike = next(same, "") or nearest(executable, there, 0.6) or ""
        if has_other_words(wanted, program_words(alike)) and not same_letters(executable, alike):
            alike = ""
        near = meant[0].name if meant else alike
        said = f" Did you mean {alike}?" if alike and not (meant or others) else ""
        said = f" {' and '.join(others)} {'has' if len(others) == 1 else 'have'} it." if others else said
        cause = f"The launch file starts {executable}, but {node.package} has no such executable; it has {', '.join(sorted(there)) or 'none'}.{said}"
        fix = f"remove this Node, or write the program {executable}, with its entry point in setup.py"
        if others:
            fix = f"write {' or '.join(others)} instead of {package.name} as its package"
        elif near:
            fix = f"write {near} instead of {executable}"
        yield Finding("launch-executable", cause, node.place, fix)


def _file_fault(node: Launched, packages: Mapping[str, SourcePackage]) -> Iterator[Finding]:
    """Yield a file below a share folder that cannot be started; launch takes a name with a slash as the path of a file."""
    match = re.match(r"(?:share:|/.*/share/)(?P<package>[\w.-]+)/(?P<path>.+)", str(node.executable))
    package = packages.get(match["package"]) if match else None
    file = _installed_at(package, match["path"]) if match and package else None
    if not match or not package or file is None or (file and os.access(package.folder / file, os.X_OK)):
        return
    path, shown = match["path"], package.shown(file)
    why = f"{shown} is not marked as executable" if file else "setup.py installs no such file"
    cause = f"The launch file starts the file {path} of {package.name}, but {why}."
    fix = f"add {package.row(path)} to data_files in setup.py, with the file in its place"
    fix = f"type `chmod +x {shown}`" if file else fix
    yield Finding("launch-executable", cause, node.place, f"{fix}, and build again")


def _not_made(node: Launched, package: SourcePackage, executable: str) -> Iterator[Finding]:
    """Yield a program that CMakeLists.txt surely does not make, or a script that it installs under the name of its file."""
    made = programs_of(package)
    if made is None or re.search(rf"\b{re.escape(executable)}\b(?!\.py)", package.cmake):
        return
    near = f"{executable}.py" if f"{executable}.py" in made else nearest(executable, made)
    cause = (
        f"The launch file starts {executable}, but CMakeLists.txt of {package.name} makes no such program."
    )
    fix = f"remove this Node, or write the program {executable}, and let CMakeLists.txt install it in lib/{package.name}"
    if near:
        has = "installs it as" if near == f"{executable}.py" else "has"
        cause = f"The launch file starts {executable}, but CMakeLists.txt of {package.name} {has} {near}."
        fix = f"write {near} instead of {executable}"
    yield Finding("launch-executable", cause, node.place, fix)


def _may_have(package: SourcePackage, node: Launched, there: Collection[str] | None) -> bool:
    """Return whether a package has an executable, as far as that is known."""
    if there is None:
        return str(node.executable) in package.cmake
    return node.executable in there


def _uncalled(package: SourcePackage, executable: str) -> str:
    """Return the module with the name of an executable if it has a program that no entry point calls; else empty."""
    points = package.points
    called = {point.module for point in points}
    stem = executable.removesuffix(".py")
    for name, source in package.sources.items():
        functions = [node.name for node in source.tree.body if isinstance(node, ast.FunctionDef)]
        is_program = meant_function(package, name) in functions
        if name.rpartition(".")[2] == stem and name not in called and is_program:
            return name
    return ""


def _no_entry_point(package: SourcePackage, node: Launched, executable: str, module: str) -> Finding:
    """Return a finding that a launch file starts a program for which setup.py has no entry point."""
    shown, setup = package.sources[module].shown, package.setup
    name = executable.removesuffix(".py")
    row = f"{name} = {module}:{meant_function(package, module)}"
    where = f"write `{row}` below console_scripts in {package.shown('setup.cfg')}"
    if setup and setup.line("entry_points"):
        place = at(package.shown("setup.py"), setup.line("entry_points"))
        # As the first one, it needs no comma that the last one may lack.
        where = f"write `'{row}',` as the first entry point in 'console_scripts' in {place}"
    other = f", write {name} instead of {executable} in {node.place}" if name != executable else ""
    cause = f"The launch file starts {executable}, which is {shown}, but no entry point in setup.py calls it, so it is not an executable."
    fix = f"{where}{other}, and build again"
    return Finding("launch-executable", cause, node.place, fix, (name,))


def _parameter_files(node: Launched, packages: Mapping[str, SourcePackage]) -> Iterator[Finding]:
    """Yield what is wrong with the parameter files that a launch file gives a node.

    An absolute path is reported elsewhere, and a file that is only in the source as not-in-data-files.
    """
    for name, path in node.files:
        package = packages.get(name)
        if package is None or path.startswith("/") or package.has(path) or _installed_at(package, path) != "":
            continue
        folder, file = (package.folder / path).parent, path.rpartition("/")[2]
        there = sorted(other.name for other in folder.glob("*.y*ml")) if folder.is_dir() else []
        cause = f"The launch file uses the parameter file {path} of {name}, but there is no such file"
        fix = f"create the file {path}, and add it to data_files in setup.py"
        end = ": the nodes keep their defaults."
        if elsewhere := lies_elsewhere(package, path):
            cause = f"The launch file gives the parameter file {path} of {name}, and the file lies in {elsewhere.folder}"
            fix = f"{elsewhere.command}, with {package.row(path)} in data_files of setup.py, and build again"
        elif wanted := nearest(file, there, 0.4) or (there[0] if len(there) == 1 else ""):
            end, fix = f"; there is {wanted}.", f"write {wanted} instead of {file} in the launch file"
        yield Finding("parameter-file-missing", cause + end, node.place, fix)


def _prints(package: SourcePackage, node: Launched) -> Iterator[Finding]:
    """Yield a node that only uses print(), whose output launch does not show."""
    points = package.points
    source = next(
        (package.sources.get(point.module) for point in points if point.name == node.executable), None
    )
    calls = [call for call in (source.nodes if source else ()) if isinstance(call, ast.Call)]
    # Output to another file, such as sys.stderr, is shown or hidden for other reasons.
    printing = (call for call in calls if getattr(call.func, "id", "") == "print")
    prints = [call for call in printing if "file" not in {keyword.arg for keyword in call.keywords}]
    if source and prints and not any(getattr(call.func, "attr", "") == "get_logger" for call in calls):
        logged = as_logged(prints[0], source)
        whole = f"write `{logged}` instead of `{ast.unparse(prints[0])}`" if logged else ""
        others = ", and likewise for the other prints" if whole and len(prints) > 1 else ""
        fix = f"{whole}{others}{'; or ' if whole else ''}{'' if whole else 'write '}output='screen' in its Node(...) of the launch file"
        cause = f"{node.executable} prints with print(), but launch shows only log messages unless output='screen' is given."
        yield Finding("never-shown", cause, source.at(prints[0]), fix)


def _installed_at(package: SourcePackage, path: str) -> str | None:
    """Return the file that setup.py installs at a path below the share folder; empty if none, None if that is not known."""
    if package.setup is None or not package.setup.are_data_files_known:
        return None
    rows = ((folder, file) for folder, files in package.setup.data_files for file in files)
    target = f"share/{package.name}/{path}"
    return next((file for folder, file in rows if f"{folder}/{file.rpartition('/')[2]}" == target), "")
