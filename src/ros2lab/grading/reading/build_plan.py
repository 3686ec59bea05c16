"""Plan a build before anything runs: what takes part, what it should install, and which settings count."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath

from ros2lab.diagnose.sources.python_source import read_source, read_text
from ros2lab.grading.reading import stand_in
from ros2lab.grading.reading.absent import (
    MARKERS,
    absent_modules,
    absent_packages,
    is_installed,
    named_places,
)
from ros2lab.grading.reading.graded_package import Package
from ros2lab.grading.reading.launch_files import around, launching
from ros2lab.grading.reading.modules import Module, module_of, modules_of
from ros2lab.grading.reading.unread import read_all
from ros2lab.grading.receiving.clean_copy import shown
from ros2lab.grading.receiving.submission import IGNORED, FoundPackage, Submission
from ros2lab.grading.sandbox.worlds import FILES

WORKSPACE = "graded_ws"  # beside the submission
_UNBUILT = "unbuilt"  # a folder of the workspace
_MODULES = "python"  # a folder in it, from which modules are imported
_STAND_IN = "#!/bin/sh\nexec sleep infinity\n"  # for a program that is not installed here

_NAMED_SCRIPT = re.compile(r"([\w.-]+)\s*=\s*([\w.{}]+)\s*:\s*(\w+)")


@dataclass(frozen=True)
class Point:
    """An entry point.

    Attributes:
        name: of the executable.
        module: its module.
        function: the function in that module.
    """

    name: str
    module: str
    function: str

    @property
    def target(self) -> str:
        """As setup.py writes it: `package.module:function`."""
        return f"{self.module}:{self.function}"


@dataclass(frozen=True)
class Plan:
    """What to build, and what is known about it.

    Attributes:
        found: the assignment's package; None if there are only files outside a package.
        name: the name of that package.
        folders: where each package of the new workspace lies in the submission, by its folder below src.
        names: the names of all these packages.
        modules: the Python files of the assignment's package, and of those in `also`.
        points: the entry points of the assignment's package.
        also: the entry points of the other packages whose nodes are part of the work, by package.
        workspace: the new workspace's folder below the World's.
        configured: sections and options in the setup.cfg of the assignment's package.
        shares: what the CMakeLists.txt of packages that need CMake seems to install: folders of the
            submission, by their later place below `share`.
        absent: the packages that launch files name and that are neither in the submission nor installed here,
            with the executables that launch files start from them.
        absent_modules: the modules that the code imports, of the same kind.
        places: folders that the code names by an absolute path.
        settings: sentences on the settings of colcon, Python and pytest in the submission, and how far they
            count.
        shared: the files of `shares`, by their place in the share folder of their package.
        unread: the attributes that are empty because our reader failed, and why it did.
    """

    found: FoundPackage | None
    name: str
    folders: dict[str, str]
    names: list[str]
    modules: list[Module]
    points: list[Point]
    also: dict[str, list[Point]]
    workspace: str
    configured: list[str] = field(default_factory=list)
    shares: dict[str, str] = field(default_factory=dict)
    absent: dict[str, list[str]] = field(default_factory=dict)
    absent_modules: list[str] = field(default_factory=list)
    places: list[str] = field(default_factory=list)
    settings: list[str] = field(default_factory=list)
    shared: list[str] = field(default_factory=list)
    unread: dict[str, str] = field(default_factory=dict)

    def source_of(self, package: str) -> str:
        """Return the folder in a box of a package of `names`; for "", that of the assignment's package."""
        folders = dict(zip(self.names, self.folders, strict=True))
        return f"{FILES}/{self.workspace}/src/{folders[package or self.name]}"

    @property
    def install(self) -> str:
        """The install folder in a box."""
        return f"{FILES}/{self.workspace}/install"

    @property
    def unbuilt(self) -> str:
        """The folder in a box that stands in for the install folder of absent and unbuilt packages."""
        return f"{FILES}/{self.workspace}/{_UNBUILT}"

    @property
    def needing_cmake(self) -> list[str]:
        """The names of the packages of `shares`."""
        return [*dict.fromkeys(PurePosixPath(place).parts[0] for place in self.shares)]

    @property
    def modules_unbuilt(self) -> str:
        """The folder in a box with stand-ins for absent modules."""
        return f"{self.unbuilt}/{_MODULES}"

    def not_installed(self, files: Container[str]) -> list[str]:
        """Return those of `needing_cmake` that a build has not installed, given the files below `install`."""
        return [name for name in self.needing_cmake if f"{name}/{MARKERS}/{name}" not in files]

    def lay_out(self, root: Path) -> None:
        """Link the packages into the src of a new workspace, which replaces one that was begun before."""
        shutil.rmtree(root / self.workspace, ignore_errors=True)
        for name, folder in self.folders.items():
            _link_tree(root, PurePosixPath(folder), root / self.workspace / "src" / name, self.workspace)
        unbuilt = root / self.workspace / _UNBUILT
        for name in {*self.needing_cmake, *self.absent}:
            (unbuilt / MARKERS).mkdir(parents=True, exist_ok=True)
            (unbuilt / MARKERS / name).touch()
            (unbuilt / "COLCON_IGNORE").touch()
        for name in self.absent_modules:
            module = unbuilt / _MODULES / name / "__init__.py"
            module.parent.mkdir(parents=True)
            module.write_text(Path(stand_in.__file__).read_text(encoding="utf-8"), encoding="utf-8")
            (unbuilt / "COLCON_IGNORE").touch()
        for package, executables in self.absent.items():
            for name in executables:
                program = unbuilt / "lib" / package / name
                program.parent.mkdir(parents=True, exist_ok=True)
                program.write_text(_STAND_IN)
                program.chmod(0o755)
        for place, folder in self.shares.items():
            _link_tree(root, PurePosixPath(folder), unbuilt / "share" / place, self.workspace)


def plan_for(root: Path, submission: Submission, found: FoundPackage, prefixes: Sequence[str] = ()) -> Plan:
    """Plan the build of a package.

    Args:
        root: the folder that holds the submission.
        submission: what was found there.
        found: the package.
        prefixes: the folders into which packages are installed here.
    """
    package = Package(root / found.folder, root)
    others = {
        other.name: other for other in submission.packages if other.name and other.folder != found.folder
    }
    also = [other for other in submission.also if other in others.values()]
    beside = [
        other for other in launching(root, submission) if other in others.values() and other not in also
    ]
    taken = _with_needed(root, package, [*also, *beside], others)
    # What cannot be built here would keep colcon from building what depends on it.
    has_cmake = is_installed("ament_cmake", prefixes)
    built = [other for other in taken if has_cmake or not needs_cmake(other)]
    shared = {str(other.name): Package(root / other.folder, root) for other in also}
    modules = [
        replace(module, package=name) for name, holder in shared.items() for module in modules_of(holder)
    ]
    sources = [source for holder in (package, *shared.values()) for source in holder.own_sources]
    launched = [package, *(Package(root / other.folder, root) for other in taken), *around(package, root)]
    own = {*others, package.name}
    unbuilt = {str(other.name) for other in taken} - {str(other.name) for other in built}
    plan = Plan(
        found=found,
        name=package.name,
        folders=_laid_out(package.name, [found, *built]),
        names=[package.name, *(str(other.name) for other in built)],
        modules=[*modules_of(package), *modules],
        points=_intended(package),
        also={name: _intended(holder) for name, holder in shared.items()},
        workspace=workspace_of(root),
    )
    found_too, unread = read_all(
        {
            "configured": lambda: _configured(package),
            "shares": lambda: dict(_shares(root, taken)),
            "absent": lambda: absent_packages(launched, own, prefixes),
            "absent_modules": lambda: sorted(absent_modules(root, sources, own, unbuilt)),
            "places": lambda: named_places(sources),
        }
    )
    plan = replace(plan, **found_too, unread=unread)
    return replace(plan, settings=_settings(root, plan), shared=[*_shared_sources(root, plan)])


def _laid_out(name: str, packages: Iterable[FoundPackage]) -> dict[str, str]:
    """Return the folder of each package by its new one in the workspace, which is `name` for the root."""
    folders: dict[str, str] = {}
    for package in packages:
        # A name from setup.py may be anything, even a path.
        folder = re.sub(r"[^\w-]", "_", PurePosixPath(package.folder).name or name)[:100]
        folders[free_name(folder, folders)] = package.folder
    return folders


def _configured(package: Package) -> list[str]:
    """Return the sections and options of a package's setup.cfg."""
    config = package.setup_cfg
    return [f"{section}.{key}" for section in config.sections() for key in config[section]] if config else []


def plan_for_files(root: Path, submission: Submission) -> Plan:
    """Plan how to start files outside a package: nothing is built, but absent modules get stand-ins."""
    sources = [read_source(root / name, PurePosixPath(name).stem, name) for name in submission.node_files]
    names = {source.name for source in sources}
    found, unread = read_all(
        {
            "absent_modules": lambda: sorted(absent_modules(root, sources, set(), set())),
            "places": lambda: named_places(sources),
        }
    )
    return Plan(
        found=None,
        name="",
        folders={},
        names=[],
        modules=[module_of(source, "", Path(source.shown), "", names) for source in sources],
        points=[],
        also={},
        workspace=workspace_of(root),
        **found,
        unread=unread,
    )


def workspace_of(root: Path) -> str:
    """Return a name for the new workspace that nothing in `root` has."""
    return free_name(WORKSPACE, {path.name for path in root.iterdir()})


def free_name(name: str, taken: Iterable[str]) -> str:
    """Return a name that is not taken: this one, or this one with underscores after it."""
    names = {*taken}
    while name in names:
        name += "_"
    return name


def _with_needed(
    root: Path, package: Package, beside: Iterable[FoundPackage], others: Mapping[str, FoundPackage]
) -> list[FoundPackage]:
    """Return the packages `beside` another one, and all those that any of them needs, even indirectly."""
    found = {str(other.name): other for other in beside}
    queue = [package, *(Package(root / other.folder, root) for other in found.values())]
    while queue:
        needing = queue.pop()
        manifest = needing.manifest
        wanted = {d.name for d in [*manifest.build_depends, *manifest.exec_depends]} if manifest else set()
        tops = {i.target.partition(".")[0] for source in needing.own_sources for i in source.imports}
        tops |= {point.module.partition(".")[0] for point in _intended(needing)}
        wanted |= {name for name, other in others.items() if not tops.isdisjoint(_tops_of(root, other))}
        for name in sorted(wanted & others.keys() - found.keys() - {package.name}):
            found[name] = others[name]
            queue.append(Package(root / others[name].folder, root))
    return [*found.values()]


def _tops_of(root: Path, other: FoundPackage) -> set[str]:
    """Return what can be imported of a package, by the first part of its name: its own name, and its folders of modules."""
    folder = root / other.folder
    return {str(other.name), *(path.parent.name for path in folder.glob("*/__init__.py"))} - {"test", "tests"}


def _shares(root: Path, packages: Iterable[FoundPackage]) -> Iterator[tuple[str, str]]:
    for package in packages:
        if not needs_cmake(package) or not re.fullmatch(r"[a-z]\w*", package.name or ""):
            continue
        script = re.sub(r"#.*", "", read_text(root / package.folder / "CMakeLists.txt"))
        for path in sorted((root / package.folder).iterdir()):
            if path.is_dir() and not path.is_symlink() and re.search(rf"\b{re.escape(path.name)}\b", script):
                yield f"{package.name}/{path.name}", str(path.relative_to(root))


def _shared_sources(root: Path, plan: Plan) -> Iterator[str]:
    for place, folder in plan.shares.items():
        for path in sorted((root / folder).rglob("*")):
            if path.is_file():
                yield str(PurePosixPath(PurePosixPath(place).name, path.relative_to(root / folder)))


def needs_cmake(found: FoundPackage) -> bool:
    """Return whether a package is built by CMake, by its type."""
    return (found.build_type or "").startswith(("ament_cmake", "cmake"))


def _link_tree(root: Path, folder: PurePosixPath, target: Path, left_out: str) -> None:
    """Copy the tree of `folder` below `root`, with hard links to its files and symbolic links to its links.

    Files that would hide the package from colcon are left out, because its nodes are graded all the same.
    """
    for parent, folders, files in os.walk(root / folder):
        inside = Path(parent).relative_to(root / folder)
        folders[:] = [name for name in folders if Path(parent, name) != root / left_out]
        (target / inside).mkdir(parents=True)
        for name in [*folders, *files]:
            original = Path(parent, name)
            if inside == Path() and name in IGNORED:
                continue
            if original.is_symlink():
                (target / inside / name).symlink_to(f"{FILES}/{original.relative_to(root)}")
            elif name in files:
                os.link(original, target / inside / name)
        folders[:] = [name for name in folders if not Path(parent, name).is_symlink()]


def _intended(package: Package) -> list[Point]:
    """Return the executables that setup.py names, or seems to name where it cannot be read."""
    points = package.setup.entry_points if package.setup and not package.setup.source.fault else None
    if points:
        return [Point(point.name, point.module, point.function) for point in points if point.function]
    text = "\n".join(read_text(package.folder / name) for name in ("setup.py", "setup.cfg", "pyproject.toml"))
    return [
        Point(name, re.sub(r"\{\w*\}", package.name, module), function)
        for name, module, function in _NAMED_SCRIPT.findall(text)
    ]


_ALL_IGNORED = re.compile(
    r"sitecustomize\.py|usercustomize\.py|.*\.pth|colcon\.meta|defaults\.yaml|COLCON_\w+"
)

_OF_BUILD = re.compile(r"(?:build|install|develop|egg_info|build_py|install_lib|easy_install)\.")
_EXPECTED = re.compile(r"develop\.script[_-]dir|install\.install[_-]scripts")


def _settings(root: Path, plan: Plan) -> list[str]:
    """Say which settings of colcon, Python and pytest a submission holds, and how far they count."""
    own = {PurePosixPath(folder) for folder in plan.folders.values()}
    inside: list[str] = []
    outside: list[str] = []
    for parent, _, names in os.walk(root):
        folder = PurePosixPath(Path(parent).relative_to(root).as_posix())
        is_own = bool(own & {folder, *folder.parents})
        found = [
            name for name in names if _is_setting(folder, name) and not (name == "conftest.py" and is_own)
        ]
        (inside if is_own else outside).extend(one_line(str(folder / name)) for name in found)
    options = [key for key in plan.configured if _OF_BUILD.match(key) and not _EXPECTED.fullmatch(key)]
    groups = [key for key in plan.configured if "entry_points.colcon" in key]
    notes = {
        "Without effect, because it lies outside the package: {}.": outside,
        "With effect on its own package only: {}.": inside,
        "With effect on its own package only: {} in setup.cfg.": options,
        "Without effect, because colcon runs without the submission: {}.": groups,
    }
    return [note.format(_listed(names)) for note, names in notes.items() if names]


def _is_setting(folder: PurePosixPath, name: str) -> bool:
    """Return whether a file configures colcon, Python or pytest; COLCON_IGNORE is noted elsewhere."""
    is_colcons = folder.name in (".colcon", "metadata") and name.endswith((".yaml", ".meta"))
    is_named = name in ("colcon.pkg", "conftest.py") or _ALL_IGNORED.fullmatch(name) is not None
    return name != "COLCON_IGNORE" and (is_named or is_colcons)


def _listed(names: Sequence[str]) -> str:
    return ", ".join(sorted(names)[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")


def one_line(text: str, longest: int = 400) -> str:
    """Return a text on one line, shortened, without the box's folder and without terminal codes."""
    return shown(re.sub(rf"{FILES}/{WORKSPACE}_*/", "", " ".join(text.split())), longest)
