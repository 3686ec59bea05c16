"""Compare what was installed with the sources and with the environment of a terminal."""

from __future__ import annotations

import configparser
import filecmp
import itertools
import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path, PurePosixPath
from shlex import quote

from ros2lab.diagnose.finding import Finding, in_a_row, shown_path
from ros2lab.diagnose.sources.interfaces import INDEX
from ros2lab.diagnose.sources.package import SourcePackage, discover
from ros2lab.diagnose.sources.python_source import PythonSource, read_text
from ros2lab.diagnose.sources.setup_script import SetupScript

_BUILD = "colcon build --packages-select"


def install_faults(root: Path, package: SourcePackage) -> Iterator[Finding]:
    """Yield the differences between a package's sources and what was installed from them."""
    prefix = prefix_of(root, package.name)
    if prefix is None:
        if links := [*_links(root, package, root / "install" / package.name)]:
            yield from links  # it was built, and its marker is one of the links
        elif (root / "install" / "setup.bash").is_file() and package.build_type == "ament_python":
            cause = f"The package {package.name} is in src but not in install: it was never built, or its build failed."
            fix = f"{_BUILD} {package.name}, and read what it says"
            yield Finding("not-built", cause, package.shown(""), fix)
        return
    by_hand = dict(edited(root, package))
    for shown, copy in by_hand.items():
        is_since = (root / shown).stat().st_mtime > _built_at(root)
        save = f"compare the two (diff {quote(shown)} {quote(str(copy))}), and copy into {shown} what you want to keep"
        cause = f"{copy} was edited by hand after the build and differs from src: the next build will overwrite it."
        fix = f"{save if is_since else f'cp {quote(str(copy))} {quote(shown)}'}, then {_BUILD} {package.name}, and edit only files in src"
        yield Finding("edited-in-install", cause, str(copy), fix)
    yield from _links(root, package, prefix)
    yield from _left_over(root, package, prefix)
    yield from _hides_new(root, package, prefix)
    changed = [shown for shown in _changed_files(prefix, package) if shown not in by_hand]
    missing = _new_executables(prefix, package)
    if changed or missing:
        what = (
            f"{changed[0]} is new or has changed"
            if changed
            else f"the entry point {missing[0]} was added or changed"
        )
        cause = f"Since the last build {what}, so what runs is not what is in src."
        fix = f"{_BUILD} {package.name} (with --symlink-install, edits to Python files need no rebuild)"
        place = changed[0] if changed else package.shown("setup.py")
        about = (*(PurePosixPath(shown).name for shown in changed), *missing)
        yield Finding("install-stale", cause, place, fix, about)


def to_build(root: Path, findings: Iterable[Finding]) -> str:
    """Return the command that makes changes of what findings are about take effect; empty if they do by themselves.

    What runs is a copy of a source unless it was built with links. A fix that tells of a build, or of what to type, needs
    no other, and no program runs what package.xml says.
    """
    others = re.compile(r"^type `|build|package\.xml")
    mended = (f for f in findings if f.fix and not others.search(f.fix))
    paths = {root / finding.place.partition(":")[0] for finding in mended}
    names = [p.name for p in discover(root)[0] if any(_is_copied(root, p, path) for path in paths)]
    return f"{_BUILD} {' '.join(names)}" if names else ""


def _is_copied(root: Path, package: SourcePackage, path: Path) -> bool:
    """Return whether a file is one of a package, and what runs is a copy of it."""
    prefix = prefix_of(root, package.name)
    is_own = path.is_file() and path.is_relative_to(package.folder) and path.name != "package.xml"
    if prefix is None or not is_own:
        return False
    copies = (copy for copy in prefix.rglob(path.name) if not copy.is_symlink())
    return path.name in ("setup.py", "setup.cfg") or any(copies)


def prefix_of(root: Path, name: str) -> Path | None:
    """Return the folder into which a package was installed; None if it was not."""
    prefixes = (root / "install" / name, root / "install")
    return next((prefix for prefix in prefixes if is_installed(prefix, name)), None)


def is_installed(prefix: Path, name: str) -> bool:
    """Return whether ROS or Python finds the package there; a failed build leaves a share folder, too."""
    return (prefix / INDEX / name).is_file() or bool(_metadata(prefix, name))


def _metadata(prefix: Path, name: str) -> list[Path]:
    """Return the metadata folders of an installed package (`*.dist-info` and `*.egg-info`)."""
    return [
        path
        for folder in site_packages(prefix)
        for version in ("-*", "")  # not those of another package with the same prefix
        for path in sorted(folder.glob(f"{name}{version}.*-info"))
    ]


def _linked_metadata(prefix: Path, name: str) -> list[Path]:
    """Return the metadata folders of a package built with links; a failed build may leave them, too."""
    return [
        Path(read_text(link).partition("\n")[0]) / f"{name}.egg-info"
        for folder in site_packages(prefix)
        for link in sorted(folder.glob("*.egg-link"))
        if link.stem.replace("-", "_") == name
    ]


def site_packages(prefix: Path) -> list[Path]:
    """Return the folders of a prefix in which Python looks for modules."""
    homes = ("lib/python3*/site-packages", "local/lib/python3*/dist-packages")
    return [folder for home in homes for folder in sorted(prefix.glob(home))]


def changed_sources(prefix: Path, package: SourcePackage) -> Iterator[tuple[PythonSource, Path]]:
    """Yield the Python files that differ from their installed copies, each with its copy; links do not."""
    for source in package.sources.values():
        if source.path is None:
            continue
        for folder in site_packages(prefix):
            top = source.name.partition(".")[0]
            if not (folder / top).is_dir():
                continue  # linked, or never installed
            copy = folder.joinpath(*source.name.split("."))
            copy = copy / "__init__.py" if source.is_package else copy.with_suffix(".py")
            try:
                is_same = filecmp.cmp(copy, source.path, shallow=False)
            except OSError:
                # A folder with tests, or one that setup.py does not list, is not installed on purpose.
                is_same = copy.parent.is_dir() is False
            if not is_same:
                yield source, copy


def _changed_files(prefix: Path, package: SourcePackage) -> list[str]:
    """Return the files that differ from their installed copies, data files included."""
    found = [source.shown for source, _ in changed_sources(prefix, package)]
    setup = package.setup
    copies = setup.copies(package.folder) if setup and setup.are_data_files_known else {}
    for target, files in copies.items():
        copy = prefix / target
        if not (copy.is_file() and _is_one_of(copy, [package.folder / file for file in files])):
            found.append(package.shown(files[-1]))
    return found


def _is_one_of(copy: Path, originals: Iterable[Path]) -> bool:
    return any(filecmp.cmp(copy, original, shallow=False) for original in originals)


def _built_at(root: Path) -> float:
    """Return the time of the last build, in s since 1970; infinite if colcon left no log."""
    log = root / "log" / "latest_build" / "logger_all.log"
    return log.stat().st_mtime if log.is_file() else float("inf")


def _is_newer(path: Path, when: float) -> bool:
    return path.is_file() and path.stat().st_mtime > when


def edited(root: Path, package: SourcePackage) -> list[tuple[str, Path]]:
    """Return the files whose built or installed copy was changed after the build, each with that copy."""
    prefix, last = prefix_of(root, package.name), _built_at(root)
    # A copy of a workspace may have new times everywhere, which say nothing.
    if prefix is None or package.setup is None or _is_newer(prefix / INDEX / package.name, last):
        return []
    pairs = []
    for source in package.sources.values():
        inner = Path(*source.name.split("."), *(["__init__"] if source.is_package else [])).with_suffix(".py")
        folders = [*site_packages(prefix), root / "build" / package.name / "build" / "lib"]
        pairs += [(source.shown, [source.path], folder / inner) for folder in folders if source.path]
    for target, files in package.setup.copies(package.folder).items():
        pairs.append((package.shown(files[-1]), [package.folder / file for file in files], prefix / target))
    return [
        (shown, copy.relative_to(root) if copy.is_relative_to(root) else copy)
        for shown, paths, copy in pairs
        if _is_newer(copy, last) and not _is_one_of(copy, paths)
    ]


def _links_in(package: SourcePackage, build: Path, prefix: Path) -> Iterator[tuple[Path, Path]]:
    """Yield the links that a build has made, each with its target, but those to a file that setup.py asks for and that is missing."""
    walked = (entry for base in (prefix, build) for entry in sorted(os.walk(base)))
    paths = (Path(folder, name) for folder, names, files in walked for name in sorted([*names, *files]))
    links = {path: path.readlink() for path in paths if path.is_symlink()}
    for folder in site_packages(prefix):
        links |= {path: Path(read_text(path).partition("\n")[0]) for path in folder.glob("*.egg-link")}
    given = package.setup.data_files if package.setup else []
    asked = {package.folder / file for _, files in given for file in files}
    for path, target in links.items():
        whole = path.parent / target
        if whole not in asked or whole.exists():  # another build would make the same link to what is missing
            yield path, target


def _links(root: Path, package: SourcePackage, prefix: Path) -> Iterator[Finding]:
    """Yield a link of a build with --symlink-install that is broken or leads out of the workspace."""
    build = root / "build" / package.name
    own, first = (root, root.resolve()), _built_in(root)
    for path, target in _links_in(package, build, prefix):
        whole = path.parent / target
        is_within = any(target.is_relative_to(folder) for folder in own)
        is_first = first is not None and first not in own and target.is_relative_to(first)
        is_moved = target.is_absolute() and (is_first or not is_within)
        if whole.exists() and not (is_moved and package.name in target.parts):
            continue
        cause = f"{shown_path(path, root)} points to {target}, but that has since been moved or renamed."
        again = f"rm -r {quote(shown_path(build, root))} {quote(shown_path(prefix, root))}, then {_BUILD} {package.name} --symlink-install"
        if is_moved:  # and with it what each package needs of the others
            again = "rm -rf build install log, then colcon build --symlink-install"
            cause = f"The workspace was built in {first if is_first else 'another folder'} and has been moved or copied since, and its links lead to where it was."
        fix = f"{again}, then source install/setup.bash in a new terminal"
        yield Finding("link-stale", cause, shown_path(path, root), fix)
        return


def _built_in(root: Path) -> Path | None:
    """Return the workspace whose folder colcon wrote into what it installed; None if it wrote none."""
    text = read_text(root / "install" / "setup.sh")
    written = re.search(
        r"^_colcon_prefix_chain_sh_COLCON_CURRENT_PREFIX=[\"']?(/.+)/install[\"']?$", text, re.M
    )
    return Path(written[1]) if written else None


def _left_over(root: Path, package: SourcePackage, prefix: Path) -> Iterator[Finding]:
    """Yield what an earlier build installed and setup.py no longer names."""
    setup = package.setup
    if setup is None or not setup.entry_points:
        return
    names = {point.name for point in setup.entry_points}
    programs = _old_programs(package, prefix, names)
    listed = [*_metadata(prefix, package.name), *_linked_metadata(prefix, package.name)]
    texts = "\n".join(read_text(folder / "entry_points.txt") for folder in listed)
    for path in (*programs, *_old_files(setup, prefix / "share" / package.name, prefix)):
        shown, is_program = shown_path(path, root), path in programs
        now = f", which now has {in_a_row(sorted(names))}," if is_program else ""
        is_dead = is_program and texts.strip() and not re.search(rf"^{re.escape(path.name)}\s*=", texts, re.M)
        does = "ends in StopIteration when it is started" if is_dead else "can still be started or used"
        cause = (
            f"{shown} is left over from an earlier build: setup.py{now} no longer names it, and it {does}."
        )
        fix = f"rm {quote(shown)}; or name it in setup.py, if it is still wanted, and build again"
        yield Finding("left-over", cause, shown, fix)


def _old_programs(package: SourcePackage, prefix: Path, names: Collection[str]) -> list[Path]:
    """Return the start scripts of no entry point; what setuptools makes of one of another form depends on its version."""
    if not all(point.module for point in package.points):
        return []
    installed = sorted((prefix / "lib" / package.name).glob("*"))
    return [path for path in installed if path.name not in names and "console_scripts" in read_text(path)]


def _old_files(setup: SetupScript, share: Path, prefix: Path) -> list[Path]:
    """Return the files in the folders below a package's share that neither data_files nor colcon names; none if not known."""
    if not setup.are_data_files_known:
        return []
    wanted = {prefix / target / Path(file).name for target, files in setup.data_files for file in files}
    hooks = read_text(share / "package.dsv")  # what colcon itself has put into these folders
    folders = {path.parent for path in wanted if share in path.parents} - {share} | {share / "launch"}
    found = (path for folder in sorted(folders) for path in folder.glob("*.*"))
    left = (path for path in found if path not in wanted and path.is_file())
    return [path for path in left if str(path.relative_to(prefix)) not in hooks]


def _hides_new(root: Path, package: SourcePackage, prefix: Path) -> Iterator[Finding]:
    """Yield installed folders of an earlier build that Python imports instead of a file of the same name."""
    modules = (source for source in package.sources.values() if not source.is_package)
    for source, folder in itertools.product(modules, site_packages(prefix)):
        old = folder.joinpath(*source.name.split("."))
        if (old / "__init__.py").is_file():
            shown, build = shown_path(old, root), shown_path(root / "build" / package.name, root)
            cause = f"The folder {shown} is left over from an earlier build, and Python imports it instead of {source.shown}."
            fix = f"rm -r {quote(build)} {quote(shown)}, then {_BUILD} {package.name}"
            yield Finding("install-stale", cause, source.shown, fix, (source.name,))


def _last_built(prefix: Path, package: SourcePackage) -> Path | None:
    """Return the metadata folder of the last build: setuptools leaves that of each earlier version beside it.

    It has the version that setup.py names, or no version; where the version was changed since, it is the newest.
    """
    version = package.setup.keywords.get("version") if package.setup else None
    copied, linked = _metadata(prefix, package.name), _linked_metadata(prefix, package.name)
    fitting = [folder for folder in copied if re.search(rf"-{re.escape(str(version))}[-.]", folder.name)]
    folders = [folder for folder in [*(fitting or copied), *linked] if folder.is_dir()]

    def age(folder: Path) -> float:
        return max(path.stat().st_mtime for path in (folder, *folder.iterdir()))

    return max(folders, key=age, default=None)


def installed_entry_points(prefix: Path, package: SourcePackage) -> dict[str, str] | None:
    """Return the `module:function` with which each executable was installed; None if not known."""
    folder = _last_built(prefix, package)
    file = folder / "entry_points.txt" if folder else None
    if file is None or not file.is_file():
        return None
    parser = configparser.RawConfigParser(delimiters=("=",))
    parser.optionxform = str  # type: ignore[assignment, method-assign]
    try:
        parser.read_string(file.read_text(encoding="utf-8"))
    except (configparser.Error, OSError, UnicodeDecodeError):
        return None
    points = parser["console_scripts"] if parser.has_section("console_scripts") else {}
    return {name: re.sub(r"\s|\.__init__(?=\s*:)", "", point) for name, point in points.items()}


def _new_executables(prefix: Path, package: SourcePackage) -> list[str]:
    """Return the entry points of setup.py that are missing or different in the installed metadata."""
    points = package.setup.entry_points if package.setup else None
    installed = installed_entry_points(prefix, package)
    if points is None or installed is None:
        return []
    targets = {point.name: f"{point.module}:{point.function}" for point in points if point.function}
    return [name for name, target in targets.items() if installed.get(name) != target]


def environment_faults(root: Path, names: Collection[str], environ: Mapping[str, str]) -> Iterator[Finding]:
    """Yield why a terminal's environment hides packages of the workspace."""
    prefixes = [Path(part) for part in environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if part]
    missing = []
    for name in sorted(names):
        own = prefix_of(root, name)
        if own is None or not (own / INDEX / name).is_file():
            continue  # ROS does not look for a package without a marker, such as a Python library
        on_path = [p for p in prefixes if is_installed(p, name)]
        if not any(_same(prefix, own) for prefix in on_path):
            missing.append(name)
        elif not _same(on_path[0], own):
            cause = f"{on_path[0]} comes before this workspace in AMENT_PREFIX_PATH and also has a package {name}, so that one runs."
            fix = f"open a new terminal, then source the other workspace first and {root}/install/setup.bash last"
            yield Finding("overlay-order", cause, "", fix)
    if missing:
        is_earlier = any(prefix.is_relative_to(root / "install") for prefix in prefixes)
        has = f"sourced it before {', '.join(missing)} was built" if is_earlier else "not sourced it"
        cause = (
            f"The workspace is built but this terminal has {has}, so ROS does not find {', '.join(missing)}."
        )
        fix = f"source {quote(f'{root}/install/setup.bash')}"
        yield Finding("not-sourced", cause, "", fix)


def _same(first: Path, second: Path) -> bool:
    return os.path.realpath(first) == os.path.realpath(second)
