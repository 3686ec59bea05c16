"""The files of a new package: which there are, and how they are made from the templates."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import jinja2

BUILD_TYPES = ["cmake", "ament_cmake", "ament_python"]
# As Jazzy names them and in its order; BSD-2.0 is ament's own name for an older text with three clauses.
LICENSES = [
    "Apache-2.0",
    "BSL-1.0",
    "BSD-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "GPL-3.0-only",
    "LGPL-3.0-only",
    "MIT",
    "MIT-0",
]
_TEMPLATES = Path(__file__).resolve().parent / "templates"
_LINTERS = {
    "cmake": [],
    "ament_cmake": ["ament_lint_auto", "ament_lint_common"],
    "ament_python": ["ament_copyright", "ament_flake8", "ament_pep257", "python3-pytest"],
}


class Folder(NamedTuple):
    """A folder to create; the path is relative to the package."""

    path: str


class File(NamedTuple):
    """A file to create from a template; the path is relative to the package."""

    path: str
    template: str


Step = Folder | File | str  # a text is only printed


@dataclass(frozen=True)
class NewPackage:
    """What is known of a package that is to be created."""

    name: str
    build_type: str
    format: int
    description: str
    license: str
    maintainer_name: str
    maintainer_email: str
    dependencies: list[str]
    node: str | None = None
    library: str | None = None

    @property
    def dependencies_by_tag(self) -> list[tuple[str, list[str]]]:
        """Return the packages in the order of package.xml, by their tag."""
        tool = "ament_cmake_ros" if self.library else "ament_cmake"
        return [
            ("buildtool_depend", [tool] if self.build_type == "ament_cmake" else []),
            ("depend", self.dependencies),
            ("test_depend", _LINTERS[self.build_type]),
        ]

    @property
    def targets(self) -> list[tuple[str, str]]:
        """Return what CMake builds, each with its kind."""
        return [(name, kind) for name, kind in ((self.library, "library"), (self.node, "node")) if name]

    @property
    def guard(self) -> str:
        """Return what the macros of the headers begin with."""
        return self.name.upper()

    @property
    def class_name(self) -> str:
        """Return the name of the class in the library."""
        return "".join((self.library or "").replace("_", " ").title().split())

    @property
    def steps(self) -> Iterator[Step]:
        """Yield what is to be done inside the package's folder, in Jazzy's order."""
        yield File("package.xml", "package.xml")
        yield from _ament_python(self) if self.build_type == "ament_python" else _cmake(self)

    def render(self, template: str) -> str:
        """Return the text of a file.

        Args:
            template: its path below `templates/`, without `.jinja`.
        """
        derived = ("dependencies_by_tag", "targets", "guard", "class_name")
        values = {name: getattr(self, name) for name in (*self.__dataclass_fields__, *derived)}
        return _environment().get_template(f"{template}.jinja").render(values)


def license_text(name: str) -> str | None:
    """Return what stands in the file LICENSE, None if the licence is not among `LICENSES`."""
    if name not in LICENSES:
        return None
    return (_TEMPLATES / "licenses" / f"{name}.txt").read_text(encoding="utf-8")


def _ament_python(package: NewPackage) -> Iterator[Step]:
    yield "creating source folder"
    yield Folder(package.name)
    yield File("setup.py", "ament_python/setup.py")
    yield File("setup.cfg", "ament_python/setup.cfg")
    yield Folder("resource")
    yield File(f"resource/{package.name}", "ament_python/empty")
    yield File(f"{package.name}/__init__.py", "ament_python/empty")
    yield Folder("test")
    for linter in ("copyright", "flake8", "pep257"):
        yield File(f"test/test_{linter}.py", f"ament_python/test_{linter}.py")
    if package.node:
        yield File(f"{package.name}/{package.node}.py", "ament_python/main.py")
    if package.library:
        yield Folder(f"{package.name}/{package.library}")
        yield File(f"{package.name}/{package.library}/__init__.py", "ament_python/empty")


def _cmake(package: NewPackage) -> Iterator[Step]:
    headers = f"include/{package.name}"
    yield "creating source and include folder"
    yield Folder("src")
    yield Folder(headers)
    yield File("CMakeLists.txt", f"{package.build_type}/CMakeLists.txt")
    if package.build_type == "cmake":
        yield File(f"{package.name}Config.cmake.in", "cmake/Config.cmake.in")
        yield File(f"{package.name}ConfigVersion.cmake.in", "cmake/ConfigVersion.cmake.in")
    if package.node:
        yield File(f"src/{package.node}.cpp", "cpp/main.cpp")
    if package.library:
        yield File(f"{headers}/{package.library}.hpp", "cpp/library.hpp")
        yield File(f"src/{package.library}.cpp", "cpp/library.cpp")
        yield File(f"{headers}/visibility_control.h", "cpp/visibility_control.h")


@cache
def _environment() -> jinja2.Environment:
    import jinja2

    # Only package.xml needs escapes, and asks for them.
    environment = jinja2.Environment(  # noqa: S701
        loader=jinja2.FileSystemLoader(_TEMPLATES),
        keep_trailing_newline=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters["literal"] = repr
    return environment
