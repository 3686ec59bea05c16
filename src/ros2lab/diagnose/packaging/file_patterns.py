"""The patterns of setup.py that choose files to install: those that take a folder along, and those that match nothing."""

from __future__ import annotations

import ast
import os.path
from collections.abc import Iterator
from difflib import SequenceMatcher
from fnmatch import fnmatchcase
from pathlib import Path, PurePosixPath

from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.setup_script import Pattern, SetupScript

_ALIKE = 0.45  # how similar a pattern and the path of the file that it should match are, from 0 to 1


def folder_taken(package: SourcePackage, setup: SetupScript, folder: str) -> Finding:
    """Say that data_files holds a folder, where only files may be, and how to leave it out."""
    pattern = next((pattern for pattern in setup.patterns if folder in pattern.files), None)
    made = next((node for node in _made(setup) if _finds(node, pattern, folder)), None)
    node = made or (pattern.call if pattern else None)
    if node is None:
        return _folder_named(setup, folder)
    written = ast.unparse(node)
    narrower = _narrower(package, pattern) if pattern and node is pattern.call else ""
    fix = f"write {narrower or _only_files(node)} instead of {written}"
    if not narrower and "import os" not in setup.source.text:
        fix += ", with `import os` at the top"
    if row := _row_of(package, pattern, folder):
        fix += f"; if the files in {folder} are needed, add {row}"
    cause = f"`{written}` in setup.py also finds the folder {folder}, but only files can be installed."
    return Finding("setup-value", cause, at(setup.source.shown, node.lineno), fix, ("data_files",))


def _finds(node: ast.ListComp | ast.GeneratorExp, pattern: Pattern | None, folder: str) -> bool:
    """Return whether a comprehension is what finds a folder: by its pattern, or else by the folder's name."""
    if pattern:
        return pattern.call in ast.walk(node)
    return f"'{folder.partition('/')[0]}" in ast.unparse(node)


def _folder_named(setup: SetupScript, folder: str) -> Finding:
    """Say that data_files names a folder itself."""
    literal = (node for node in setup.source.nodes if isinstance(node, ast.Constant))
    line = next((node.lineno for node in literal if node.value == folder), setup.line("data_files"))
    cause = f"In setup.py, data_files names the folder {folder}, but only files can be installed."
    whole = _called(ast.Name("glob"), f"{folder}/*")
    fix = f"write {whole} instead of ['{folder}'], with `from glob import glob` at the top"
    return Finding("setup-value", cause, at(setup.source.shown, line), fix, ("data_files",))


def _row_of(package: SourcePackage, pattern: Pattern | None, folder: str) -> str:
    """Return the entry of data_files that installs a folder's own files; empty if it has none, or they are installed."""
    has_files = any(path.is_file() for path in (package.folder / folder).glob("*"))
    if not has_files or folder.endswith("__pycache__"):
        return ""
    if pattern and (
        pattern.text.rstrip("/") == folder or any(file.startswith(f"{folder}/") for file in pattern.files)
    ):
        return ""
    function = pattern.call.func if pattern else ast.Name("glob")
    return f"({f'share/{package.name}/{folder}'!r}, {_called(function, f'{folder}/*')})"


def _made(setup: SetupScript) -> Iterator[ast.ListComp | ast.GeneratorExp]:
    """Yield the comprehensions in data_files."""
    given = setup.given("data_files")
    for node in ast.walk(given) if given else ():
        if isinstance(node, (ast.ListComp, ast.GeneratorExp)) and not isinstance(node.elt, ast.Tuple):
            yield node


def _narrower(package: SourcePackage, pattern: Pattern) -> str:
    """Return the call of glob with the ending that all matched files share; empty if they share none."""
    files = [file for file in pattern.files if (package.folder / file).is_file()]
    names = [PurePosixPath(file).name[::-1] for file in files]
    ending = os.path.commonprefix(names)[::-1]  # noqa: RUF071 -- of letters, not of folders
    folder, _, last = pattern.text.rpartition("/")
    if pattern.text.rstrip("/") == "".join(pattern.files).rstrip("/"):  # it finds only the folder itself
        return _called(pattern.call.func, f"{pattern.text.rstrip('/')}/*")
    if "." not in ending or last != "*":
        return ""
    return _called(pattern.call.func, f"{folder}/*{ending[ending.index('.') :]}")


def _called(function: ast.expr, pattern: str) -> str:
    return f"{ast.unparse(function)}({pattern!r})"


def _only_files(node: ast.expr) -> str:
    """Return the expression of a list of paths without the folders."""
    if isinstance(node, (ast.ListComp, ast.GeneratorExp)):
        test = f"os.path.isfile({ast.unparse(node.elt)})"
        inner = ast.unparse(node)
        return f"{inner[:-1]} if {test}{inner[-1]}"
    return f"[path for path in {ast.unparse(node)} if os.path.isfile(path)]"


def dead_pattern(package: SourcePackage, setup: SetupScript, path: Path) -> Finding | None:
    """Say which pattern should match a file that is not installed, and matches none; None if there is none."""
    relative = path.relative_to(package.folder).as_posix()
    dead = [pattern for pattern in setup.patterns if pattern.is_dead]
    fits = {_likeness(pattern.text, relative): pattern for pattern in dead}
    if not fits or max(fits) < _ALIKE:
        return None
    pattern = fits[max(fits)]
    last = pattern.text.replace("\\", "/").rpartition("/")[2]
    ending = path.name[path.name.index(".") :]
    if last.lower() == f"*{ending}".lower() and last != f"*{ending}":
        return None  # if only the case differs, the name of the file is wrong
    last = last if "*" in last and fnmatchcase(path.name, last) else f"*{ending}"
    new = _called(pattern.call.func, f"{PurePosixPath(relative).parent}/{last}")
    written = ast.unparse(pattern.call)
    why = ": on Linux a path is written with /" if "\\" in pattern.text else ""
    cause = f"`{written}` in setup.py does not match {relative}, so that file is not installed{why}."
    fix = f"write {new} instead of {written}, and build again"
    return Finding("not-in-data-files", cause, at(setup.source.shown, pattern.call.lineno), fix, (path.name,))


def _likeness(pattern: str, relative: str) -> float:
    """Return how similar a pattern and a path are, from 0 to 1; where the name matches, only the folders count."""
    (wanted, _, last), (folder, _, name) = (
        text.rpartition("/") for text in (pattern.replace("\\", "/"), relative)
    )
    pairs = [(f"{wanted}/{last}", relative), *([(wanted, folder)] if fnmatchcase(name, last) else [])]
    return max(SequenceMatcher(None, first.lower(), second.lower()).ratio() for first, second in pairs)


def folder_copied(name: str, package: SourcePackage) -> Finding | None:
    """Say that what setuptools cannot copy is a folder; None if it is none."""
    setup = package.setup
    is_folder = name and not name.startswith("/") and (package.folder / name).is_dir()
    return folder_taken(package, setup, name) if setup and is_folder else None
