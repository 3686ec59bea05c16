"""Read the folder of a package: package.xml, setup.py, setup.cfg and every Python file."""

from __future__ import annotations

import contextlib
import os
import re
import warnings
from collections.abc import Collection, Iterator, Mapping, Sequence
from configparser import RawConfigParser
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Any

from ros2lab.diagnose.finding import shown_path
from ros2lab.diagnose.sources.python_source import PythonSource, read_source, read_text
from ros2lab.diagnose.sources.setup_cfg import read_cfg
from ros2lab.diagnose.sources.setup_script import EntryPoint, SetupScript, read_setup
from ros2lab.diagnose.sources.static_value import is_known
from ros2lab.manifest_words import NOT_TAKEN, fault_of

_NOT_LOOKED_INTO = frozenset(("build", "install", "log", "node_modules", "__pycache__"))
_LAUNCH = re.compile(r"^(?:launch\s*:|\s*<launch\b|def generate_launch_description\b)", re.MULTILINE)
IGNORED_BY = ("COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE")
# The variables in a `condition` of package.xml, as a terminal with Jazzy has them.
_JAZZY = {"ROS_VERSION": "2", "ROS_DISTRO": "jazzy", "ROS_PYTHON_VERSION": "3"}
# Nobody writes a longer one by hand, and catkin_pkg would take minutes.
_LONGEST_MANIFEST = 30_000  # characters
_MOST_BRACKETS = 5  # in a condition
_LARGEST_WORKSPACE = 5000  # folders to search


@dataclass(eq=False)
class SourcePackage:
    """A package in its source folder.

    Attributes:
        root: the folder of the workspace, to which shown paths are relative.
        is_run: whether its setup.py may be run, up to its command line, in a process that can change nothing.
    """

    folder: Path
    root: Path | None = None
    is_run: bool = False

    @cached_property
    def name(self) -> str:
        """Its name in package.xml, else in setup.py, else the name of its folder."""
        if self.manifest is not None:
            return str(self.manifest.name)
        named = self.setup.keywords.get("name") if self.setup else None
        return named if isinstance(named, str) and named else self.folder.name

    @property
    def beside(self) -> Path:
        """The folder below which the workspace's packages are."""
        source = (self.root or self.folder.parent) / "src"
        return source if source.is_dir() else self.folder.parent

    @cached_property
    def _parsed(self) -> tuple[Any, str | None, int | None]:
        # A late import: it takes 0.1 s, and not every error text needs it.
        from catkin_pkg.package import InvalidPackage, parse_package_string

        if not self.has("package.xml"):
            return None, None, None
        text = read_text(self.folder / "package.xml")
        if len(text) > _LONGEST_MANIFEST:
            return None, f"it has more than {_LONGEST_MANIFEST} characters", None
        try:
            manifest = parse_package_string(text, filename=str(self.folder / "package.xml"), warnings=[])
            return _where_they_hold(manifest), None, None
        except (InvalidPackage, *NOT_TAKEN) as error:
            return None, fault_of(error, text), _line_in(str(error))

    @property
    def manifest(self) -> Any:
        """package.xml as catkin_pkg reads it; None if it is missing or invalid."""
        return self._parsed[0]

    @property
    def declared(self) -> set[str]:
        """The packages that package.xml says are needed to run it."""
        tags = (self.manifest.build_depends, self.manifest.exec_depends) if self.manifest else ()
        return {dependency.name for tag in tags for dependency in tag}

    @property
    def conditional(self) -> set[str]:
        """The packages that package.xml declares under a condition, which may hold elsewhere only."""
        text = read_text(self.folder / "package.xml") if self.manifest else ""
        return {*re.findall(r"<\w*depend\s[^<>]*\bcondition=[^<>]*>\s*([\w-]+)", text)}

    @property
    def manifest_fault(self) -> str | None:
        """Why package.xml is not valid; None if it is valid or missing."""
        return self._parsed[1]

    @property
    def manifest_line(self) -> int | None:
        """The line of package.xml with the fault; None if not known."""
        return self._parsed[2]

    @property
    def build_type(self) -> str | None:
        """The build type in package.xml; None if there is none or package.xml is not valid.

        A CMake package that names no other tool than catkin is built by it.
        """
        exports = (
            [export for export in self.manifest.exports if export.tagname == "build_type"]
            if self.manifest
            else []
        )
        if exports:
            return str(exports[0].content or "").strip()
        tools = [tool.name for tool in self.manifest.buildtool_depends] if self.manifest else []
        return "catkin" if tools == ["catkin"] and self.has("CMakeLists.txt") else None

    @property
    def kind(self) -> str:
        """The kind of package for colcon: `ros`, else `cmake` or `python`, in the order of its checks."""
        if self.has("package.xml"):
            return "ros"
        text = read_text(self.folder / "setup.py") if self.has("setup.py") else ""
        # Only with an empty setup() and a name in setup.cfg does colcon identify Python before CMake.
        if "setup()" in text and self.setup_cfg and self.setup_cfg.has_option("metadata", "name"):
            return "python"
        return "cmake" if self.has("CMakeLists.txt") else "python"

    @cached_property
    def setup(self) -> SetupScript | None:
        """Its setup.py; None if there is none, or if colcon does not read it."""
        return None if self.is_built_by_cmake else read_setup(self.folder, self.shown("setup.py"))

    @property
    def is_built_by_cmake(self) -> bool:
        """Whether colcon builds it with its CMakeLists.txt alone, also if there is a setup.py.

        A package.xml without a build type is one of catkin for colcon, whatever tool it names.
        """
        kind = self.build_type or ("catkin" if self.manifest else "")
        return kind in ("ament_cmake", "cmake", "catkin") and self.has("CMakeLists.txt")

    @property
    def is_of_ros_1(self) -> bool:
        """Whether it is built by catkin, the tool of ROS 1, and so follows none of the rules of ROS 2."""
        return self.build_type == "catkin" and self.has("CMakeLists.txt")

    @cached_property
    def cmake(self) -> str:
        """The text of its CMakeLists.txt without comments, on the same lines; empty if there is none."""
        return re.sub(r"#.*", "", read_text(self.folder / "CMakeLists.txt"))

    @cached_property
    def setup_cfg(self) -> RawConfigParser | None:
        """Its setup.cfg; None if it is missing or cannot be read."""
        parser, fault = read_cfg(read_text(self.folder / "setup.cfg"))
        return parser if self.has("setup.cfg") and fault is None else None

    @property
    def points(self) -> Sequence[EntryPoint]:
        """The entry points of its setup.py, as far as they are known."""
        return (self.setup.entry_points if self.setup else None) or ()

    @property
    def mains(self) -> list[str] | None:
        """The full names of the functions that its entry points call; None if none is known."""
        return [f"{point.module}.{point.function}" for point in self.points if point.module] or None

    @property
    def copied(self) -> list[str] | None:
        """The files that setup.py copies to where `ros2 run` looks for executables; None if not known."""
        setup = self.setup
        if setup and not setup.are_data_files_known and re.search(r"['\"]/?lib['\"/]", setup.source.text):
            return None
        rows = setup.data_files if setup else ()
        return [file for folder, files in rows if folder == f"lib/{self.name}" for file in files]

    @property
    def executables(self) -> list[str] | None:
        """The names of its executables; None if they are not known."""
        copied, points = self.copied, self.points
        is_known = bool(points) and all(point.module for point in points) and copied is not None
        if self.setup is None or not is_known or self.setup.keywords.get("scripts"):
            return None
        return [*(point.name for point in points), *(Path(path).name for path in copied or ())]

    @cached_property
    def sources(self) -> Mapping[str, PythonSource]:
        """The Python files in the folders that it installs, by the names under which they are imported."""
        found = {}
        for base, folder in self._import_folders():
            paths = sorted(folder.rglob("*.py"))
            marks = (path for path in [*paths, *folder.rglob("package.xml")] if path.parent != folder)
            inner = {path.parent for path in marks if _begins_package(path)}
            for path in paths:
                relative = path.relative_to(folder)
                if not inner.isdisjoint(path.parents):
                    continue
                if any(part in _NOT_LOOKED_INTO or part.startswith(".") for part in relative.parts):
                    continue
                parts = [base, *relative.with_suffix("").parts]
                name = ".".join(part for part in parts if part and part != "__init__")
                if name not in found:  # Python imports a folder before a file of its name
                    found[name] = self.read(path, name)
        return found

    def read(self, path: Path, name: str) -> PythonSource:
        """Return one of its Python files under its import name."""
        return read_source(path, name, self.shown(str(path.relative_to(self.folder))))

    def folder_of(self, name: str) -> Path:
        """Return the folder in which setup.py looks for a Python package, or for a module without its `.py`."""
        mapping, above, _, last = self.package_dirs, *name.rpartition(".")
        if name in mapping:
            return self.folder / mapping[name]
        return self.folder_of(above) / last if above else self.folder / mapping.get("", "") / name

    def _import_folders(self) -> Iterator[tuple[str, Path]]:
        """Yield the name and folder of each top-level Python package."""
        mapping = self.package_dirs
        names = self.packages
        tops = {name.partition(".")[0] for name in names} if names is not None else set()
        tops |= {self.name, *(name for name in mapping if "." in name)}
        for top in sorted(tops):
            folder = self.folder_of(top)
            # Not the folder itself, and nothing outside it, as with a name such as `/usr`.
            if folder.is_dir() and self.folder.resolve() in folder.resolve().parents:
                yield top, folder

    @property
    def package_dirs(self) -> Mapping[str, str]:
        """The `package_dir` of setup.py; empty if there is none, or if it is not known."""
        value = self.setup.keywords.get("package_dir") if self.setup else None
        if not isinstance(value, dict):
            return {}
        return value if all(isinstance(part, str) for pair in value.items() for part in pair) else {}

    @property
    def packages(self) -> list[str] | None:
        """The Python packages that setup.py installs, also those written as folders; None if they or their folders are not known."""
        given = self.setup.keywords if self.setup else {}
        value = given.get("packages", []) if given and is_known(given.get("package_dir")) else None
        if not isinstance(value, (list, tuple)) or not all(isinstance(name, str) for name in value):
            return None
        return [name.rstrip("/").replace("/", ".") if re.match(r"\w", name) else name for name in value]

    @cached_property
    def launch_files(self) -> list[Path]:
        """Its launch files in Python, XML or YAML, in any folder: recognized by their names or contents; none of ROS 1."""
        paths = () if self.is_of_ros_1 else self.own_files()
        return sorted(path for path in paths if _is_launch_file(path))

    @cached_property
    def parameter_files(self) -> list[Path]:
        """Its YAML files below `config` and `params`."""
        folders = ("config", "params", "param", "cfg")
        return sorted(
            p for name in folders for p in self._files(name) if p.suffix.lower() in (".yaml", ".yml")
        )

    @cached_property
    def yaml_files(self) -> list[Path]:
        """All its YAML files."""
        return sorted(path for path in self.own_files() if path.suffix.lower() in (".yaml", ".yml"))

    @cached_property
    def likely_files(self) -> list[Path]:
        """Its launch and parameter files, including parameter files in the launch folder."""
        others = [p for p in self._files("launch") if p.suffix.lower() in (".yaml", ".yml")]
        others = [path for path in others if "ros__parameters" in read_text(path)]
        return list(dict.fromkeys([*self.launch_files, *self.parameter_files, *others]))

    def places_of(self, name: str) -> list[str]:
        """Return the paths of its files with a name, relative to its folder, the shortest paths first."""
        paths = (path.relative_to(self.folder).as_posix() for path in self.own_files() if path.name == name)
        return sorted(paths, key=lambda path: (path.count("/"), path))

    def row(self, lies: str, inner: str = "") -> str:
        """Return the item of data_files that installs a file or folder in the share folder, there or as `inner`."""
        if (self.folder / lies).is_dir():
            files = f"[str(path) for path in Path({lies!r}).iterdir()]"
            return (
                f"('share/{self.name}/{inner or lies}', {files}), with `from pathlib import Path` at the top,"
            )
        return f"({str(PurePosixPath('share', self.name, inner or lies).parent)!r}, [{lies!r}])"

    def to_install(self, lies: str) -> str:
        """Return the further step of a fix that looks for a file in the share folder; empty if setup.py installs it."""
        is_known = self.setup is not None and self.setup.are_data_files_known
        rows = self.setup.data_files if self.setup and is_known else [("", [lies])]
        return (
            ""
            if any(lies in files for _, files in rows)
            else f" (and add {self.row(lies)} to data_files in setup.py)"
        )

    def link_into(self, prefix: Path) -> None:
        """Link its files into its share folder below a prefix: where setup.py installs them, and as they lie in its folder."""
        share = prefix / "share" / self.name
        share.mkdir()
        for path, (file, *_) in self.setup.copies(self.folder).items() if self.setup else ():
            if share in (there := prefix / path).parents and ".." not in there.parts:
                with contextlib.suppress(OSError):  # two that do not go together
                    there.parent.mkdir(parents=True, exist_ok=True)
                    there.symlink_to(self.folder / file)
        _link_beside(self.folder, share)

    def own_files(self) -> Iterator[Path]:
        """Yield its files, without tests, build folders, and other packages inside its folder."""
        for where, names, files in os.walk(self.folder):
            folder = Path(where)
            if folder != self.folder and not {"package.xml", "setup.py"}.isdisjoint(files):
                names.clear()
                continue
            passed_over = {*_NOT_LOOKED_INTO, "test", "tests"}
            names[:] = sorted(n for n in names if n not in passed_over and not n.startswith("."))
            yield from (folder / name for name in sorted(files))

    def _files(self, name: str) -> list[Path]:
        return sorted(path for path in (self.folder / name).rglob("*") if path.is_file())

    def has(self, name: str) -> bool:
        """Return whether its folder has a file at this path."""
        return (self.folder / name).is_file()

    def shown(self, name: str) -> str:
        """Return the path of one of its files as it is shown."""
        return shown_path(self.folder / name, self.root)


@dataclass(frozen=True)
class PassedOver:
    """A package that colcon skips: because of a file such as COLCON_IGNORE, or inside another package.

    Attributes:
        by: the file that makes colcon skip it, or the folder of the outer package.
    """

    package: SourcePackage
    by: Path
    is_nested: bool


def _link_beside(folder: Path, share: Path) -> None:
    """Link what a folder holds into another one, beside what is there."""
    for entry in folder.iterdir():
        there = share / entry.name
        if not there.exists():
            there.symlink_to(entry)
        elif there.is_dir() and entry.is_dir():
            _link_beside(entry, there)


def find_packages(root: Path) -> list[SourcePackage]:
    """Find the packages of a workspace as colcon does."""
    return discover(root)[0]


def discover(root: Path) -> tuple[list[SourcePackage], list[PassedOver]]:
    """Find the packages of a workspace that colcon sees, and those that it skips."""
    found: list[SourcePackage] = []
    passed_over: list[PassedOver] = []
    hidden: dict[Path, Path] = {}  # each folder that colcon does not search, with the reason
    seen: set[str] = set()
    for where, names, files in os.walk(root, followlinks=True):
        real, folder = os.path.realpath(where), Path(where)
        ignored_by = next((folder / name for name in IGNORED_BY if name in files and folder != root), None)
        is_built = folder.name in _NOT_LOOKED_INTO
        if is_built or real in seen or len(seen) > _LARGEST_WORKSPACE:
            names.clear()
            continue
        seen.add(real)
        by = hidden.get(folder.parent) or ignored_by
        # Outside src, only a package.xml makes a folder a package: much else is there.
        is_below_src = root / "src" in (folder, *folder.parents) or not (root / "src").is_dir()
        is_package = "package.xml" in files or bool(takes_for_package(folder, root, files))
        is_package |= "setup.py" in files and is_below_src
        package = SourcePackage(folder, root)
        if is_package and by is None:
            found.append(package)
            by = folder
        elif is_package and "package.xml" in files and by is not None:
            passed_over.append(PassedOver(package, by, by.is_dir()))
        if by is not None:
            hidden[folder] = by
        is_deep = not is_below_src and len(folder.relative_to(root).parts) > 1
        hides = ("test", "tests", "templates", "resource") if by else ()
        names[:] = sorted(n for n in names if not (is_deep or n.startswith(".") or n in hides))
    return found, passed_over


def takes_for_package(folder: Path, root: Path, files: Collection[str] = ()) -> str:
    """Return the file that makes colcon take a workspace, or its `src`, for a package; empty if none does."""
    if folder not in (root, root / "src") or not (root / "src").is_dir():
        return ""
    files = files or [path.name for path in folder.iterdir()]
    if "setup.py" in files and "setup(" in read_text(folder / "setup.py"):
        return "setup.py"
    is_cmake = "CMakeLists.txt" in files and "project" in read_text(folder / "CMakeLists.txt").lower()
    return "CMakeLists.txt" if is_cmake else "package.xml" if "package.xml" in files else ""


def _begins_package(path: Path) -> bool:
    """Return whether a file makes its folder a package of its own; one with modules belongs to the outer one."""
    is_script = path.name == "setup.py" and re.search(
        r"^(?:setuptools\.)?setup\(", read_text(path), re.MULTILINE
    )
    return (path.name == "package.xml" or bool(is_script)) and not (path.parent / "__init__.py").is_file()


def _where_they_hold(manifest: Any) -> Any:
    """Return a manifest without the tags whose `condition` is false, which colcon and rosdep ignore."""
    kinds = [tags for kind in manifest.__slots__ if isinstance(tags := getattr(manifest, kind), list)]
    for condition in (getattr(tag, "condition", None) or "" for tags in kinds for tag in tags):
        if condition.count("(") > _MOST_BRACKETS:
            raise ValueError(f"a condition has more than {_MOST_BRACKETS} brackets")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # catkin_pkg calls a deprecated function
        manifest.evaluate_conditions(_JAZZY)
    for tags in kinds:
        tags[:] = [tag for tag in tags if getattr(tag, "evaluated_condition", True)]
    return manifest


def _is_launch_file(path: Path) -> bool:
    is_named = path.name.endswith(("launch.py", "launch.xml", "launch.yaml", "launch.yml", ".launch"))
    may_be = path.suffix in (".py", ".xml", ".yaml", ".yml") and path.name not in ("package.xml", "setup.py")
    # A module may be called so, too: one of nodes that launch something, such as a rocket.
    is_named &= not (path.parent / "__init__.py").is_file() or "LaunchDescription" in read_text(path)
    return path.is_file() and (is_named or (may_be and _LAUNCH.search(read_text(path)) is not None))


def _line_in(text: str) -> int | None:
    match = re.search(r"line (\d+)", text)
    return int(match[1]) if match else None
