"""Folders and executables of packages, and parameters that all nodes have."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING, Any

from launch.lookup import lookup
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.substitutions import PathSubstitution, SubstitutionFailure, normalize_default
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions
from portable_ros2 import ament_index

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

__getattr__ = lookup(__name__)


class FindPackage(PathSubstitution):
    """A folder of a package."""

    def __init__(self, package: SomeSubstitutionsType) -> None:
        super().__init__(self)
        self.package = normalize_to_list_of_substitutions(package)

    def find(self, package_name: str) -> str:
        """Return the folder."""
        raise NotImplementedError

    def describe(self) -> str:
        """Return a text for people."""
        return f"{type(self).__name__}(pkg={_described(self.package)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the folder.

        Raises:
            SubstitutionFailure: if the package is not installed.
        """
        package = perform_substitutions(context, self.package)
        try:
            return self.find(package)
        except ament_index.PackageNotFoundError:
            searched = [str(prefix) for prefix in ament_index.prefixes()]
            raise SubstitutionFailure(f"\"package '{package}' not found, searching: {searched}\"") from None


class FindPackagePrefix(FindPackage):
    """The folder in which a package is installed."""

    def find(self, package_name: str) -> str:
        """Return the folder."""
        return str(ament_index.package_prefix(package_name))


class FindPackageShare(FindPackage):
    """The folder `share/<package>` of a package."""

    def find(self, package_name: str) -> str:
        """Return the folder."""
        return str(ament_index.share_folder(package_name))


class ExecutableInPackage(FindPackagePrefix):
    """The path of an executable of a package."""

    def __init__(self, executable: SomeSubstitutionsType, package: SomeSubstitutionsType) -> None:
        super().__init__(package)
        self.executable = normalize_to_list_of_substitutions(executable)

    def describe(self) -> str:
        """Return a text for people."""
        return f"ExecInPkg(pkg={_described(self.package)}, exec={_described(self.executable)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the path.

        Raises:
            SubstitutionFailure: if the package is not installed, or has no such executable.
        """
        prefix = super().perform(context)
        package = perform_substitutions(context, self.package)
        executable = perform_substitutions(context, self.executable)
        folder = f"{prefix}/lib/{package}"
        path = shutil.which(executable, path=folder)
        if path is None:
            raise SubstitutionFailure(
                f"executable '{executable}' not found on the libexec directory '{folder}' "
            )
        return path


class Parameter(Substitution):
    """The value of a parameter that all nodes have from `SetParameter`."""

    def __init__(self, name: SomeSubstitutionsType, *, default: Any = None) -> None:
        self.name = normalize_to_list_of_substitutions(name)
        self._default = normalize_default(default)

    def describe(self) -> str:
        """Return a text for people."""
        return f"Parameter(name={_described(self.name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the value.

        Raises:
            SubstitutionFailure: if there is neither a value nor a default.
        """
        name = perform_substitutions(context, self.name)
        for given in context.launch_configurations.get("global_params", []):
            if isinstance(given, tuple) and given[0] == name:
                return str(given[1])
        if self._default is None:
            raise SubstitutionFailure(f"parameter '{name}' not found")
        return perform_substitutions(context, self._default)


def _described(subs: list[Substitution]) -> str:
    return " + ".join(sub.describe() for sub in subs)
