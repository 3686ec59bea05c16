"""Misplaced files: packages that colcon does not see, builds in the wrong folder, another user's folders."""

from __future__ import annotations

import itertools
import os
import re
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from shlex import quote

from ros2lab.diagnose.code.syntax_repairs import syntax_finding
from ros2lab.diagnose.finding import Finding, in_a_row, shown_path
from ros2lab.diagnose.packaging.installed import edited, prefix_of
from ros2lab.diagnose.packaging.own_test_faults import own_test_faults
from ros2lab.diagnose.sources.package import PassedOver, SourcePackage, takes_for_package
from ros2lab.diagnose.sources.python_source import read_text

_LAYOUT = ".colcon_install_layout"  # which colcon writes into each install folder
_ASKING = frozenset((".py", ".xml", ".yaml", ".yml"))  # the endings of files that name packages


def layout_faults(
    root: Path, packages: Collection[SourcePackage], passed_over: Collection[PassedOver]
) -> Iterator[Finding]:
    """Yield what is where colcon or ROS does not look for it."""
    yield from _passed_over(root, packages, passed_over)
    if not packages and not passed_over:
        yield from outside(root)
    for package in packages:
        yield from own_test_faults(package)
    yield from _built_elsewhere(root, packages)
    yield from _renamed(
        root, packages, {package.name for package in [*packages, *(p.package for p in passed_over)]}
    )
    yield from _not_writable(root, packages)


def _passed_over(
    root: Path, packages: Collection[SourcePackage], passed_over: Collection[PassedOver]
) -> Iterator[Finding]:
    """Yield packages that colcon does not see though they are needed, and what keeps Python from reading them."""
    seen = {package.name for package in packages}
    manifests = [package.manifest for package in packages if package.manifest]
    wanted = {dependency.name for manifest in manifests for dependency in manifest.exec_depends}
    told: set[str] = set()
    for skipped in sorted(passed_over, key=lambda skipped: len(skipped.package.folder.parts)):
        # A package may be hidden on purpose, but not one that is needed, or the only one.
        name = skipped.package.name
        is_missed = name not in seen and (not packages or name in wanted or prefix_of(root, name))
        # One of ROS 1 may lie among the data of another, such as the model of a robot.
        is_built = skipped.package.has("setup.py") or (skipped.package.build_type or "").startswith("ament")
        if name not in told and (is_missed or (skipped.is_nested and name not in seen and is_built)):
            told.add(name)
            copies = [other for other in passed_over if other.package.name == name and other is not skipped]
            yield hidden(skipped, [other.package.shown("").rstrip("/") for other in copies])
            yield from _unreadable(skipped.package) if skipped.is_nested else ()


def _unreadable(package: SourcePackage) -> Iterator[Finding]:
    """Yield what keeps Python from reading the files of a package, which stops it wherever the package lies."""
    scripts = {"setup-syntax": [package.setup.source] if package.setup else []}
    for code, sources in ({"node-syntax": [*package.sources.values()]} | scripts).items():
        yield from (
            syntax_finding(code, source) for source in sources if source.tree is not None and source.fault
        )


def _renamed(root: Path, packages: Collection[SourcePackage], names: Collection[str]) -> Iterator[Finding]:
    """Yield a package that is still installed under its old name: a new one in src has its programs."""
    for folder in sorted((root / "install").glob("*/lib")):
        old = folder.parent.name
        programs = {path.name for path in (folder / old).glob("*") if path.is_file()}
        for package in packages if old not in names and prefix_of(root, old) else ():
            now = {point.name for point in package.points}
            if programs and programs <= now:
                yield _left_under(old, package, packages)


def _left_under(old: str, package: SourcePackage, packages: Collection[SourcePackage]) -> Finding:
    """Say that a package is installed under its old name, too, and who still asks for that one."""
    new, remove = package.name, f"rm -r build/{old} install/{old}"
    # A package may get another name, and its module keep the old one.
    is_module = any(name.partition(".")[0] == old for other in packages for name in other.sources)
    imports = "" if is_module else "import |from |"
    asks = re.compile(
        rf"(?:[Pp]ackage\w*\s*[=(]\s*|pkg\s*[=:]\s*|find-pkg-\w+ |{imports}depend>\s*)['\"]?{re.escape(old)}\b"
    )
    files = [(other, path) for other in packages for path in other.own_files() if path.suffix in _ASKING]
    places = [
        f"{other.shown(str(path.relative_to(other.folder)))}:{number}"
        for other, path in files
        for number, line in enumerate(read_text(path).splitlines(), 1)
        if asks.search(line)
    ]
    left = f"install/{old} is left over from a package no longer in src, and"
    if not places:
        cause = f"{left} `ros2 run {old}` still starts the old build; the package is now called {new}."
        return Finding("left-over", cause, f"install/{old}", f"{remove}, and type `ros2 run {new} ...`")
    cause = f"{left} {places[0].partition(':')[0]} still asks for {old}, so what runs is the old build; the package is now called {new}."
    fix = f"write {new} instead of {old} in {in_a_row(places)}, build again, and {remove}"
    return Finding("launch-package", cause, places[0], fix)


def hidden(skipped: PassedOver, copies: Sequence[str] = ()) -> Finding:
    """Say why colcon does not see a package; of several copies only one is to be moved."""
    name, folder = skipped.package.name, skipped.package.shown("").rstrip("/")
    by = shown_path(skipped.by, skipped.package.root)
    root = skipped.package.root
    if skipped.is_nested and root and (file := takes_for_package(skipped.by, root)):
        where = shown_path(skipped.by / file, root)
        cause = f"colcon takes the folder {skipped.by} for a package because of {where}, so it does not look inside for {name}."
        fix = f"mv {quote(where)} {quote(where + '.away')}, and build again"
        return Finding("package-passed-over", cause, where, fix)
    if skipped.is_nested:
        outer = SourcePackage(skipped.by, root).name
        others = f"; leave its other copies where they are ({', '.join(copies)})" if copies else ""
        beside = skipped.by.parent
        is_free = not (beside / skipped.package.folder.name).exists()
        target = shown_path(beside, root) + "/" if is_free else shown_path(_free(beside / name), root)
        cause = f"The package {name} is inside the package {outer}, and colcon does not look inside packages."
        fix = f"mv {quote(folder)} {quote(target)}, and build again{others}"
        return Finding("package-passed-over", cause, folder, fix)
    cause = f"colcon skips the package {name} because of the file {by}."
    fix = f"rm {quote(by)}, and build again"
    return Finding("package-passed-over", cause, by, fix)


def _free(path: Path) -> Path:
    """Return a path that does not exist yet: this one, or it with a number."""
    numbered = (path.with_name(f"{path.name}_{number}") for number in itertools.count(2))
    return path if not path.exists() else next(other for other in numbered if not other.exists())


def outside(root: Path, name: str = "") -> Iterator[Finding]:
    """Yield packages beside a workspace instead of in it; only the one of this name, if it is given."""
    for file in sorted([*root.parent.glob("*/package.xml"), *root.parent.glob("src/*/package.xml")]):
        package = SourcePackage(file.parent)
        if root not in (file.parent, *file.parents) and name in ("", package.name):
            cause = f"The package {package.name} is in {file.parent}, outside the workspace {root}, so it is not built."
            fix = f"mv {quote(str(file.parent))} {quote(f'{root}/src/')}, and run colcon build in {root}"
            yield Finding("package-outside", cause, str(file.parent), fix)


def _built_elsewhere(root: Path, packages: Collection[SourcePackage]) -> Iterator[Finding]:
    """Yield builds that were run in `src`, in a package, or above the workspace."""
    folders = {folder for package in packages for folder in (package.folder, *package.folder.parents)}
    inside = {folder for folder in folders if root in folder.parents}
    names = [package.name for package in packages]
    is_above = not (root / "install").is_dir() and any(prefix_of(root.parent, name) for name in names)
    for folder in sorted(inside | ({root.parent} if is_above else set())):
        if not (folder / "install" / _LAYOUT).is_file():
            continue
        where = shown_path(folder, root)
        made = [name for name in ("build", "install", "log") if (folder / name / "COLCON_IGNORE").is_file()]
        own = [name for name in made if name != "log"]
        is_edited = any(edited(folder, package) for package in packages)
        remove = f"rm -r {' '.join(quote(f'{where}/{name}') for name in made or own)}, then "
        cause = f"colcon build was run in {where}, so what it built is there, not in {root}/install."
        fix = f"{'' if is_edited or folder == root.parent else remove}cd {root}, run colcon build there, and source install/setup.bash"
        yield Finding("build-elsewhere", cause, f"{where}/install", fix)


def _not_writable(root: Path, packages: Collection[SourcePackage]) -> Iterator[Finding]:
    made = [root / name for name in ("build", "install", "log")]
    inner = [folder / package.name for folder in made for package in packages]
    for path in [root, *made, *inner, *(package.folder for package in packages)]:
        if path.exists() and not os.access(path, os.W_OK):
            owner = path.stat().st_uid
            whose = "root, as after a build with sudo" if owner == 0 else f"the user {owner}"
            cause = f"{shown_path(path, root)} belongs to {whose}, so colcon cannot write there."
            fix = f'sudo chown -R "$USER" {quote(str(root))}, and build without sudo'
            yield Finding("not-writable", cause, shown_path(path, root), fix)
            return


def duplicate_faults(packages: list[SourcePackage]) -> Iterator[Finding]:
    """Yield a name that several packages have which colcon sees."""
    all_folders = {package.folder for package in packages}
    # colcon does not look inside packages.
    seen = [package for package in packages if not all_folders.intersection(package.folder.parents)]
    counts = Counter(package.name for package in seen)
    for name, count in counts.items():
        if count > 1:
            folders = [package.shown("") for package in seen if package.name == name]
            # A package usually lies in a folder of its name, and a copy of it beside that or deeper.
            kept = min(folders[::-1], key=lambda place: (Path(place).name != name, place.count("/")))
            others = [place for place in folders if place != kept]
            yield Finding(
                "package-duplicate",
                f"{count} packages are called {name}, so colcon builds nothing: {' and '.join(folders)}.",
                others[-1],
                f"keep one of them, such as {kept}, and hide the rest: touch {' '.join(quote(f'{place}/COLCON_IGNORE') for place in others)}",
            )
