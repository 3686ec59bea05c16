"""Find a file that is not where a package names it but elsewhere in the workspace."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePosixPath

from ros2lab.diagnose.sources.package import SourcePackage, find_packages


@dataclass(frozen=True)
class Elsewhere:
    """Where a file is that a package names in another place.

    Attributes:
        named: the path where it should be, as it is shown.
        is_own: whether the package that names it also contains it.
        has_folder: whether the folder where it should be exists.
    """

    package: SourcePackage
    path: str
    named: str
    is_own: bool
    has_folder: bool

    @property
    def shown(self) -> str:
        """The path of the file, relative to the workspace."""
        return self.package.shown(self.path)

    @property
    def folder(self) -> str:
        """The folder of the file, relative to the workspace."""
        return f"{PurePosixPath(self.shown).parent}/"

    @property
    def command(self) -> str:
        """The command that moves it where it is named; a file of another package is copied."""
        folder = PurePosixPath(self.named).parent
        make = "" if self.has_folder else f"mkdir -p {folder} && "
        return f"{make}{'mv' if self.is_own else 'cp'} {self.shown} {self.named}"

    @property
    def fix(self) -> str:
        """How to fix it: move the file, or, in the same package, change the path that names it."""
        longer = f"; or name it as {self.path!r} in this line" if self.is_own else ""
        return f"{self.command}{longer}; then build again"


def lies_elsewhere(package: SourcePackage, file: str) -> Elsewhere | None:
    """Return where a file is that a package names in the wrong place; None if it is nowhere.

    In another package its folder must be the same, too: nearly all packages have a README.md.
    """
    name = PurePosixPath(file).name
    others = find_packages(package.root) if package.root else []
    for home in (package, *(other for other in others if other.folder != package.folder)):
        for path in home.places_of(name):
            has_folder = (package.folder / file).parent.is_dir()
            is_own = home is package
            is_meant = path != file if is_own else "/" in file and f"/{path}".endswith(f"/{file}")
            if is_meant:
                return Elsewhere(home, path, package.shown(file), is_own, has_folder)
    return None
