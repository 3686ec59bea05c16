"""Where a package is that nobody finds: in src, where colcon does not take it for one, or in another workspace."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from shlex import quote

from ros2lab.diagnose.finding import Finding, shown_path
from ros2lab.diagnose.packaging.installed import is_installed, site_packages
from ros2lab.diagnose.sources.python_source import read_text

# colcon writes a line for each prefix, the workspace's own last.
_CHAINED = re.compile(r'^COLCON_CURRENT_PREFIX="(?P<prefix>/[^"$]*)"$', re.M)
_DEEPEST = 4  # folders below src
_PUT = "put the package itself into {}, and build again"
_PACKED = tuple(ending for _, endings, _ in shutil.get_unpack_formats() for ending in endings)


def nowhere_seen(root: Path, name: str) -> Finding | None:
    """Say why colcon sees no package in what bears its name in src; None if nothing does."""
    for path in _below(root / "src"):
        if path.name == name or path.name in {f"{name}{ending}" for ending in _PACKED}:
            place = shown_path(path, root)
            why, fix = _why_unseen(path, place)
            cause = f"{place} {why}, so colcon sees no package {name}."
            return Finding("package-passed-over", cause, place, fix)
    return None


def _below(folder: Path) -> Iterator[Path]:
    """Yield what is in a folder and, as far as one would look, in the folders in it that are no packages."""
    for where, names, files in os.walk(folder):
        here = Path(where)
        if not {"package.xml", "setup.py"}.isdisjoint(files):
            names.clear()
            continue
        yield from (here / name for name in sorted([*names, *files]))
        is_deep = len(here.relative_to(folder).parts) >= _DEEPEST
        names[:] = [] if is_deep else [name for name in names if not name.startswith(".")]


def _why_unseen(path: Path, place: str) -> tuple[str, str]:
    """Return what keeps colcon from seeing a package in a file or a folder, and how to fix it."""
    if path.is_symlink() and not os.path.exists(path):  # noqa: PTH110 -- False where pathlib raises
        again = "put the package, or a link to where it is now, in its place, and build again"
        return f"is a link to {path.readlink()}, which is not there", f"rm {quote(place)}, {again}"
    if path.is_file():
        is_packed = path.name.endswith(_PACKED)
        unpack = f"unpack it into {quote(place.rpartition('/')[0])}, and build again"
        return ("is packed", unpack) if is_packed else ("is a file, not a folder", _PUT.format(place))
    if not os.access(path, os.R_OK | os.X_OK):
        return "cannot be read by you", f'sudo chown -R "$USER" {quote(place)}, and build again'
    return _why_empty(path, place)


def _why_empty(folder: Path, place: str) -> tuple[str, str]:
    """Return what a folder lacks to be a package, and how to fix it."""
    inside = sorted(entry.name for entry in folder.iterdir() if entry.name != ".git")
    if not inside:
        above = next((path for path in folder.parents if (path / ".gitmodules").is_file()), None)
        fetch = f"git -C {quote(str(above))} submodule update --init, and build again"
        return "is empty", fetch if above else _PUT.format(place)
    meant = next((name for name in inside if name.lower().startswith("package.xml")), "")
    if meant == "package.xml":
        return "has another name in its package.xml", "use that name, or write this one there"
    if meant:
        move = f"mv {quote(f'{place}/{meant}')} {quote(f'{place}/package.xml')}, and build again"
        return f"has a {meant}, but no package.xml", move
    return "has no package.xml", _PUT.format(place)


def in_another_workspace(root: Path, name: str) -> Finding | None:
    """Say that a package, or a Python module, is in a workspace that this terminal has not sourced; None if in none.

    First come the workspaces below this one, which its own setup.bash sources; then those beside it.
    """
    setup = quote(f"{root}/install/setup.bash")
    below = [Path(prefix) for prefix in _CHAINED.findall(read_text(root / "install/setup.sh"))]
    below = [prefix for prefix in below if prefix != root / "install"]
    if home := next((prefix for prefix in below if _holds(prefix, name)), None):
        cause = f"{name} is in {home}, which install/setup.bash sources, too; this terminal has sourced only install/local_setup.bash, or nothing."
        return Finding("not-sourced", cause, "", f"source {setup}")
    if gone := next((prefix for prefix in below if not os.access(prefix, os.R_OK | os.X_OK)), None):
        cause = f"{name} is neither in this workspace nor in ROS, and {gone}, on which the workspace was built, is not there any more, or closed to you."
        fix = f"source the setup.bash of that workspace where it is now, run colcon build again here, and source {setup}"
        return Finding("not-sourced", cause, "", fix)
    others = sorted(folder for folder in root.parent.glob("*") if folder != root)
    beside = (folder / "install" for folder in others if os.access(folder, os.R_OK | os.X_OK))
    if home := next((prefix for prefix in beside if _holds(prefix, name)), None):
        where = f"another workspace, {home.parent}, which this terminal has not sourced"
        fix = f"source {quote(f'{home}/setup.bash')}, run colcon build here, and source {setup}"
        return Finding("not-sourced", f"{name} is in {where}.", "", fix)
    return None


def _holds(prefix: Path, name: str) -> bool:
    """Return whether a package or a Python module is installed below a prefix, as far as that may be read."""
    if not os.access(prefix, os.R_OK | os.X_OK):
        return False
    homes = [prefix, *(folder for folder in prefix.glob("*") if folder.is_dir())]
    folders = [folder for home in homes for folder in site_packages(home)]
    is_module = any((folder / end).exists() for folder in folders for end in (name, f"{name}.py"))
    return is_module or is_installed(prefix, name) or is_installed(prefix / name, name)
