"""Files that programs open but that are not where they look, also for want of a slash in the path."""

from __future__ import annotations

import ast
import contextlib
import os
import re
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from shlex import quote

from ros2lab.diagnose.finding import SAID, Finding, at, line_with
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.spots import is_setup, spot_at
from ros2lab.diagnose.sources.lying import lies_elsewhere
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, given_to, last_name, read_source, read_text
from ros2lab.diagnose.sources.setup_script import SetupScript
from ros2lab.diagnose.sources.spelling import nearest

# Each import that a path in a share folder needs, and how a file that has it is recognized.
_IMPORTS = {
    "import os": r"^import os\b",
    "from ament_index_python.packages import get_package_share_directory": r"import.*get_package_share_directory",
}
_BUILD = "colcon build --packages-select"


def of_missing_file(path: str, place: str, look: Look) -> Finding | None:
    """Return why a file is not where a program opens it; None if the package has no such file."""
    if path.startswith("~"):
        return None
    return of_shared_file(path, look) if path.startswith("/") else _of_relative_file(path, place, look)


def of_shared_file(path: str, look: Look) -> Finding | None:
    """Return why a file is not in its package's share folder; None if it is looked for elsewhere."""
    for package in look.packages:
        _, is_shared, inner = path.partition(f"/share/{package.name}/")
        if is_shared and inner and package.setup is not None:
            return _not_shared(inner.rstrip("/"), package, package.setup)
    return None


def _not_shared(inner: str, package: SourcePackage, setup: SetupScript) -> Finding:
    name, target = PurePosixPath(inner).name, f"share/{package.name}/{PurePosixPath(inner).parent}"
    lies = inner if package.has(inner) else next(_called(name, package), "")
    if not lies and (elsewhere := lies_elsewhere(package, inner)):
        cause = f"The package {package.name} has no file {inner}: the file lies in {elsewhere.folder}."
        row = f"{package.row(inner)} in data_files"
        fix = f"{elsewhere.command}, with {row}, and build again; or name the package {elsewhere.package.name} where the file is looked for"
        return Finding("data-file-missing", cause, elsewhere.shown, fix, (name,))
    if not lies:
        there = [path.name for path in package.folder.rglob("*") if "__pycache__" not in path.parts]
        near = nearest(name, there)
        cause = f"The package {package.name} has no file {inner}{f'; there is {near}' if near else ''}."
        fix = f"write {near} instead of {name}" if near else f"create the file {package.shown(inner)}"
        return Finding("data-file-missing", cause, package.shown(""), fix, (name,))
    rows = setup.data_files
    folders = {to for to, files in rows if any(PurePosixPath(file).is_relative_to(lies) for file in files)}
    target = target.removesuffix("/.")
    if target in folders or f"{target}/{name}" in folders:
        cause = f"setup.py installs {lies} of the package {package.name}, but it has not been installed yet."
        fix = f"{_BUILD} {package.name}, and run the same command again"
        return Finding("install-stale", cause, package.shown(lies), fix, (name,))
    place = at(setup.source.shown, setup.line("data_files"))
    if folders:
        cause = f"setup.py installs {lies} into {min(folders)}, but the program looks for it in {target}."
        fix = f"write {target!r} instead of {min(folders)!r} in data_files, and build again"
        return Finding("installed-elsewhere", cause, place, fix, (name,))
    cause = f"{lies} is in the package {package.name}, but setup.py does not install it, so it is not in {target}, where the program looks."
    row = package.row(lies, inner)
    return Finding("not-in-data-files", cause, place, f"add {row} to data_files and build again", (name,))


def _of_relative_file(path: str, place: str, look: Look) -> Finding | None:
    package = next((candidate for candidate in look.packages if place.startswith(candidate.shown(""))), None)
    if package is None:
        return None
    inner = path.removeprefix(package.shown("")).lstrip("./")
    lies = inner if package.has(inner) else next(_called(Path(path).name, package), "")
    if is_setup(place) and (there := lies_elsewhere(package, inner)):
        cause = f"setup.py looks for {path} from its own folder on, and the file lies in {there.folder}."
        return Finding(SAID, cause, place, there.fix, (Path(path).name,))
    if not lies:
        names = (entry.name for entry in package.folder.iterdir())
        if alike := next((name for name in names if name.lower() == Path(path).name.lower()), ""):
            cause = f"There is no file {path}; there is {alike}, with different upper and lower case."
            return Finding(SAID, cause, place, f"write {alike!r} instead of {path!r}")
        cause = f"setup.py reads {path}, but there is no such file in the package."
        fix = f"touch {quote(package.shown(path))}, and fill it in; or remove the line that reads it"
        return Finding(SAID, cause, place, fix) if is_setup(place) else None
    parts = ", ".join(repr(part) for part in Path(lies).parts)
    share = f"os.path.join(get_package_share_directory({package.name!r}), {parts})"
    cause = f"{path} is looked for in the terminal's current folder, not in the package {package.name}."
    text = spot_at(place, look).file.text
    needs = [line for line, known in _IMPORTS.items() if not re.search(known, text, re.MULTILINE)]
    with_them = f", with `{'; '.join(needs)}` at the top" if needs else ""
    fix = f"write {share}{with_them}{package.to_install(lies)}"
    return Finding(SAID, cause, place, fix)


def _called(name: str, package: SourcePackage) -> Iterator[str]:
    """Yield the files and folders of a package that have this name."""
    return (
        path.relative_to(package.folder).as_posix()
        for path in sorted(package.folder.rglob("*"))
        if path.name == name
    )


_PATH = re.compile(r"'(/[^'\n]+)'|(?<![\w.:/'])(/[^\s'\",:]+)")
_JOINS = frozenset(("join", "joinpath", "Path", "PathJoinSubstitution"))  # these write the slashes themselves


def of_lost_slash(error: ErrorText, look: Look) -> Finding | None:
    """Say where a slash is missing in a path that is not there, but would be with it; None if in none."""
    for path in dict.fromkeys(quoted or plain for quoted, plain in _PATH.findall(error.text)):
        for home, rest in _homes(path, look):
            cause = f"There is no {path}: the slash between the folder {Path(home).name} and {rest} is missing, because these pieces are put together as they are."
            fix = f"begin the second piece with a slash: /{rest}"
            place, written = max(_pieces(rest, look), key=lambda piece: len(piece[1]), default=("", ""))
            if written:
                fix = f"write {'/' + written!r} instead of {written!r}"
            return Finding("file-not-found", cause, place, fix)
    return None


def _homes(path: str, look: Look) -> Iterator[tuple[str, str]]:
    """Yield the folders, the longest names first, after which a slash makes a path right, each with what follows."""
    for package in sorted(look.packages, key=lambda package: -len(package.name)):
        before, found, rest = path.partition(f"/share/{package.name}")
        if found and rest and not rest.startswith("/") and package.has(rest):
            yield before + found, rest
    with contextlib.suppress(OSError):  # such as a name that is too long, or a folder of somebody else
        above = next((folder for folder in Path(path).parents if folder.is_dir()), Path("/"))
        following = path.removeprefix(str(above)).lstrip("/")
        names = sorted(os.listdir(above), key=len, reverse=True) if not Path(path).exists() else []  # noqa: PTH208
        for name in names:
            rest = following.removeprefix(name)
            if rest != following and rest and (above / name / rest).exists():
                yield str(above / name), rest


def _pieces(rest: str, look: Look) -> Iterator[tuple[str, str]]:
    """Yield the places of texts in the files of a workspace that begin what follows the folder, each with the text."""
    for package in look.packages:
        for path in dict.fromkeys(
            [*package.launch_files, *(s.path for s in package.sources.values() if s.path)]
        ):
            shown = package.shown(path.relative_to(package.folder).as_posix())
            if path.suffix == ".py":
                yield from _texts(rest, read_source(path, path.stem, shown))
            elif line := line_with(read_text(path), f"){rest}"):
                yield at(shown, line), rest


def _texts(rest: str, source: PythonSource) -> Iterator[tuple[str, str]]:
    joined = [call for call in source.calls if last_name(call.func) in _JOINS]
    given = [value for call in joined for value in given_to(call)]
    given += [value for row in given if isinstance(row, ast.List) for value in row.elts]
    for node in source.nodes:
        match node:
            case ast.Constant(value=str(text)) if text and rest.startswith(text) and node not in given:
                yield source.at(node), text
