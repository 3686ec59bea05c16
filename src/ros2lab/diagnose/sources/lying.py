"""A file that is not where it is named, while one of its name lies elsewhere in the workspace."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePosixPath

from ros2lab.diagnose.sources.package import SourcePackage, find_packages


@dataclass(frozen=True)
class Elsewhere:
    """Where a file lies that a package names in another place.

    Attributes:
        package: in whose folder it lies.
        path: where it lies there.
        named: where it is named, as it is shown.
        is_own: whether the package that names it is the same one.
        has_folder: whether the folder is there in which it is named.
    """

    package: SourcePackage
    path: str
    named: str
    is_own: bool
    has_folder: bool

    @property
    def shown(self) -> str:
        """Where the file is, from the workspace on."""
        return self.package.shown(self.path)

    @property
    def folder(self) -> str:
        """The folder in which the file is, from the workspace on."""
        return f"{PurePosixPath(self.shown).parent}/"

    @property
    def command(self) -> str:
        """What brings it where it is named; what another package has may be in use there."""
        folder = PurePosixPath(self.named).parent
        make = "" if self.has_folder else f"mkdir -p {folder} && "
        return f"{make}{'mv' if self.is_own else 'cp'} {self.shown} {self.named}"

    @property
    def fix(self) -> str:
        """What helps: the file is moved, or named where it lies, which no other package can do."""
        longer = f"; or name it as {self.path!r} in this line" if self.is_own else ""
        return f"{self.command}{longer}; then build again"


def lies_elsewhere(package: SourcePackage, file: str) -> Elsewhere | None:
    """Return where a file lies that a package names and does not have there; None if it lies nowhere.

    In another package it has the same folder, too: nearly all have a README.md.
    """
    name = PurePosixPath(file).name
    others = find_packages(package.root) if package.root else []
    for home in (package, *(one for one in others if one.folder != package.folder)):
        for path in home.places_of(name):
            has_folder = (package.folder / file).parent.is_dir()
            is_own = home is package
            is_meant = path != file if is_own else "/" in file and f"/{path}".endswith(f"/{file}")
            if is_meant:
                return Elsewhere(home, path, package.shown(file), is_own, has_folder)
    return None
