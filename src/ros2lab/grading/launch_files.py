"""The launch files of packages, and what they name."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from ros2lab.diagnose.launching.launch_file import read_launch_file
from ros2lab.diagnose.sources.python_source import read_text
from ros2lab.grading.documents import COMMENT
from ros2lab.grading.graded_package import Package
from ros2lab.grading.submission import FoundPackage, Submission

MOST = 50  # names that are told
# What a launch file may look up the share folder of a package with, in Python, XML or YAML.
_SHARE_OF = re.compile(
    r"(?:get_package_share\w*|FindPackageShare)\(\s*(?:package(?:_name)?=)?['\"](\w+)|find-pkg-share +(\w+)"
)
_GIVEN = re.compile(r"\b([a-z_]\w*):=")
_FROM_ROOT = re.compile(r"""["'](/[^"'\n]+/[^"'/\n]+\.\w+)["']""")


def launching(root: Path, submission: Submission) -> list[FoundPackage]:
    """Return the other packages whose launch files name the assignment's, such as a `robot_bringup`."""
    own = Package(root / submission.package.folder, root).name if submission.package else ""
    is_named = re.compile(rf"\b{re.escape(own)}\b").search
    return [
        one
        for one in submission.packages
        if own and one.name not in (None, own)
        if any(map(is_named, uncommented([Package(root / one.folder, root)]).values()))
    ]


def around(package: Package, root: Path) -> list[Package]:
    """Return the folders around a package, such as the workspace, in which launch files may lie that nothing installs."""
    around = [folder for folder in package.folder.parents if folder == root or root in folder.parents]
    return [Package(folder, root) for folder in around]


def launch_files(packages: Iterable[Package]) -> list[Path]:
    """Return the launch files of packages."""
    return [*dict.fromkeys(path for package in packages for path in package.launch_files)]


def packages_named(path: Path, text: str, own: Iterable[str]) -> set[str]:
    """Return the packages that a launch file names: of a node, for a share folder, or, of one's own, anywhere."""
    nodes = read_launch_file(path, path.name).nodes
    return {
        *(node.package for node in nodes if isinstance(node.package, str)),
        *shares_named(text),
        *(name for name in own if re.search(rf"\b{re.escape(name)}\b", text)),
    }


def shares_named(text: str) -> list[str]:
    """Return the packages whose share folders a launch file asks for."""
    return ["".join(names) for names in _SHARE_OF.findall(text)]


def uncommented(packages: Iterable[Package]) -> dict[Path, str]:
    """Return the texts of launch files without their comments."""
    return {path: without_comments(read_text(path)) for path in launch_files(packages)}


def without_comments(text: str) -> str:
    """Return a text in Python, YAML or XML without its comments."""
    return COMMENT.sub("", text)


def lacks(root: Path, readme: str, launches: Mapping[Path, str]) -> dict[str, list[str]]:
    """Return by launch file that includes no other one what a README gives by `name:=` and it does not name."""
    given = sorted({*_GIVEN.findall(readme)})[:MOST]
    return {
        str(path.relative_to(root)): [name for name in given if not re.search(rf"\b{name}\b", text)]
        for path, text in launches.items()
        if "include" not in text.lower()
    }


def hard_coded(packages: Iterable[Package]) -> list[str]:
    """Return the paths of files that launch files give from the root on."""
    texts = uncommented(packages).values()
    return sorted({path for text in texts for path in _FROM_ROOT.findall(text)})[:MOST]
