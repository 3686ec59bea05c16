"""`ros2 pkg create`."""

from __future__ import annotations

import argparse
import getpass
import keyword
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from portable_ros2 import ament_index
from portable_ros2.verb import Verb

if TYPE_CHECKING:
    from portable_ros2.new_package import NewPackage


class CreateVerb(Verb):
    """Create a new ROS 2 package."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument("package_name", help="The package name")
        parser.add_argument(
            "--package-format",
            "--package_format",
            type=int,
            default=3,
            choices=[2, 3],
            help="The package.xml format.",
        )
        parser.add_argument(
            "--description",
            default="TODO: Package description",
            help="The description given in the package.xml",
        )
        parser.add_argument(
            "--license",
            default="TODO: License declaration",
            help="The license of this package, any text; the known ones ('?' lists them) also get a LICENSE file",
        )
        parser.add_argument(
            "--destination-directory",
            default=os.curdir,
            help="Directory where to create the package directory",
        )
        parser.add_argument(
            "--build-type",
            default="ament_cmake",
            choices=["cmake", "ament_cmake", "ament_python"],
            help="The build type to process the package with",
        )
        parser.add_argument("--dependencies", nargs="+", default=[], help="list of dependencies")
        parser.add_argument("--maintainer-email", help="email address of the maintainer of this package")
        parser.add_argument("--maintainer-name", help="name of the maintainer of this package")
        parser.add_argument("--node-name", help="name of the empty executable")
        parser.add_argument("--library-name", help="name of the empty library")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        from portable_ros2.new_package import LICENSES, NewPackage

        if args.license == "?":
            print("Supported licenses:", *LICENSES, sep="\n")
            return None
        maintainer = _user() if args.maintainer_name is None else args.maintainer_name
        package = NewPackage(
            name=args.package_name,
            build_type=args.build_type,
            format=args.package_format,
            description=args.description,
            license=args.license,
            maintainer_name=maintainer,
            maintainer_email=args.maintainer_email or _git_email() or f"{maintainer}@todo.todo",
            dependencies=args.dependencies,
            node=_node_name(args.node_name, args.library_name),
            library=args.library_name or None,
        )
        folder = os.path.join(args.destination_directory, package.name)  # noqa: PTH118 -- keeps the "./" that is shown
        if args.build_type == "ament_python" and package.name == "test":
            # The folder of its modules would be that of its tests.
            return (
                "Aborted since 'ament_python' packages can't be named 'test'. "
                "Please choose a different package name."
            )
        if os.path.exists(folder):  # noqa: PTH110 -- Path's raises on a name that is too long
            return (
                f"\nAborted!\nThe directory already exists: {folder}\n"
                "Either remove the directory or choose a different destination directory or package name"
            )
        _describe(package, Path(args.destination_directory))
        try:
            _write(package, folder)
        except OSError as error:
            return f"unable to create the package: {error.filename}: {error.strerror}"
        for sentence in _cautions(package):
            print(f"[WARNING] {sentence}", file=sys.stderr)
        return None


def _user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # a user without a name, as in some containers
        return "user"


def _git_email() -> str:
    git = shutil.which("git")
    if git is None:
        return ""
    command = [git, "config", "user.email"]
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()


def _node_name(node: str | None, library: str | None) -> str | None:
    if not node or node != library:
        return node or None
    print("[WARNING] node name can not be equal to the library name", file=sys.stderr)
    print(f"[WARNING] renaming node to {node}_node", file=sys.stderr)
    return f"{node}_node"


def _describe(package: NewPackage, destination: Path) -> None:
    print("going to create a new package")
    print("package name:", package.name)
    print("destination directory:", destination.absolute())
    print("package format:", package.format)
    print("version: 0.0.0")
    print("description:", package.description)
    print("maintainer:", [f"{package.maintainer_name} <{package.maintainer_email}>"])
    print("licenses:", [package.license])
    print("build type:", package.build_type)
    print("dependencies:", package.dependencies)
    if package.node:
        print("node_name:", package.node)
    if package.library:
        print("library_name:", package.library)


def _write(package: NewPackage, folder: str) -> None:
    from portable_ros2.new_package import LICENSES, Folder, license_text

    for step in (Folder(""), *package.steps):
        if isinstance(step, str):
            print(step)
            continue
        path = f"{folder}/{step.path}" if step.path else folder
        if isinstance(step, Folder):
            print("creating folder", path)
            Path(path).mkdir(parents=True, exist_ok=True)
        else:
            print("creating", path)
            _write_new(Path(path), package.render(step.template))
    text = license_text(package.license)
    if text is None:
        print(
            f"\n[WARNING]: Unknown license '{package.license}'.  This has been set in the package.xml, but "
            "no LICENSE file has been created.\n"
            "It is recommended to use one of the ament license identifiers:",
            *LICENSES,
            sep="\n",
        )
    else:
        _write_new(Path(folder, "LICENSE"), text)


def _write_new(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("x", encoding="utf-8") as file:  # a name such as ../x must not overwrite what is there
        file.write(text)


def _cautions(package: NewPackage) -> Iterator[str]:
    """Yield a sentence about each thing that will not work, which the real command leaves to be found out."""
    if not re.fullmatch("[a-z][a-z0-9_]+", package.name) or keyword.iskeyword(package.name):
        yield (
            f"'{package.name}' is no good name for a package: it should start with a lower case letter, have "
            "two characters or more, and only lower case letters, digits and underscores."
        )
    for name, kind in package.targets:
        if not name.isidentifier() or keyword.iskeyword(name):
            yield f"'{name}' is no good name for a {kind}: use letters, digits and underscores."
    missing = list(_missing_tools(package.build_type))
    if missing:
        yield (
            f"This machine cannot build packages of the type {package.build_type}, only store their files: "
            f"{' and '.join(missing)} is missing."
        )


def _missing_tools(build_type: str) -> Iterator[str]:
    if build_type == "ament_python":
        return
    if shutil.which("cmake") is None:
        yield "cmake"
    if build_type == "ament_cmake" and "ament_cmake" not in ament_index.resources(ament_index.PACKAGES):
        yield "ament_cmake"
