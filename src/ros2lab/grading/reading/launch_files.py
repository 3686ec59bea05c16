"""The launch files of packages, what they name, and which of them are tried first: those that start most."""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path

from ros2lab.diagnose.launching.launch_file import read_launch_file
from ros2lab.diagnose.sources.python_source import read_text
from ros2lab.grading.reading.graded_package import Package
from ros2lab.grading.receiving.submission import FoundPackage, Submission

MOST = 50  # names or paths that are returned
_COMMENT = re.compile(r"(?:^|\s)#[^\n]*|<!--(?s:.*?)(?:-->|\Z)")  # of Python, YAML or XML
# How a launch file may look up the share folder of a package, in Python, XML or YAML.
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
        other
        for other in submission.packages
        if own and other.name not in (None, own)
        if any(map(is_named, uncommented([Package(root / other.folder, root)]).values()))
    ]


def around(package: Package, root: Path) -> list[Package]:
    """Return the folders around a package, such as the workspace, which may hold launch files, too."""
    around = [folder for folder in package.folder.parents if folder == root or root in folder.parents]
    return [Package(folder, root) for folder in around]


def launch_files(packages: Iterable[Package]) -> list[Path]:
    """Return the launch files of packages."""
    return [*dict.fromkeys(path for package in packages for path in package.launch_files)]


def packages_named(path: Path, text: str, own: Iterable[str]) -> set[str]:
    """Return the packages that a launch file names for nodes or share folders, or anywhere if in `own`."""
    nodes = read_launch_file(path, path.name).nodes
    return {
        *(node.package for node in nodes if isinstance(node.package, str)),
        *shares_named(text),
        *(name for name in own if re.search(rf"\b{re.escape(name)}\b", text)),
    }


def shares_named(text: str) -> list[str]:
    """Return the packages whose share folders a launch file looks up."""
    return ["".join(names) for names in _SHARE_OF.findall(text)]


def uncommented(packages: Iterable[Package]) -> dict[Path, str]:
    """Return the texts of launch files without their comments."""
    return {path: without_comments(read_text(path)) for path in launch_files(packages)}


def without_comments(text: str) -> str:
    """Return a text in Python, YAML or XML without its comments."""
    return _COMMENT.sub("", text)


def lacks(root: Path, readme: str, launches: Mapping[Path, str]) -> dict[str, list[str]]:
    """Return the names set by `name:=` in a README that each launch file lacks, if it includes no other."""
    given = sorted({*_GIVEN.findall(readme)})[:MOST]
    return {
        str(path.relative_to(root)): [name for name in given if not re.search(rf"\b{name}\b", text)]
        for path, text in launches.items()
        if "include" not in text.lower()
    }


def hard_coded(packages: Iterable[Package]) -> list[str]:
    """Return the absolute paths of files in launch files."""
    texts = uncommented(packages).values()
    return sorted({path for text in texts for path in _FROM_ROOT.findall(text)})[:MOST]


MOST_IN_ORDER = 100  # launch files that are put in order; nobody writes more
_DEEPEST = 5  # levels of launch files that include others


def programs_of(packages: Iterable[Package]) -> set[str]:
    """Return what launch files may start in packages: executables, or modules if these are not known."""
    found = set[str]()
    for package in packages:
        points = package.setup.entry_points if package.setup else None
        stems = (source.name.rpartition(".")[2] for source in package.own_sources)
        found |= {point.name for point in points} if points else {*stems} - {"__init__", "setup"}
    return found


def programs_named(texts: Mapping[Path, str], programs: Collection[str]) -> dict[Path, list[str]]:
    """Return the programs that launch files name, themselves or through what they include.

    Args:
        texts: the launch files, without comments.
        programs: what they may start.
    """
    some = dict(itertools.islice(texts.items(), MOST_IN_ORDER))
    own = {path: {program for program in programs if _names(text, program)} for path, text in some.items()}
    included = {path: [other for other in some if other.name in text] for path, text in some.items()}
    named = own
    for _ in range(_DEEPEST):
        named = {path: own[path].union(*(named[other] for other in included[path])) for path in some}
    return {path: sorted(found) for path, found in named.items()}


def those_that_start_most_first(
    texts: Mapping[Path, str], named: Mapping[Path, Collection[str]]
) -> dict[Path, str]:
    """Return launch files with their texts, those that name most programs first; equals keep their order."""
    order = sorted(named, key=lambda path: -len(named[path]))
    return {path: texts[path] for path in (*order, *texts)}


def _names(text: str, program: str) -> bool:
    return re.search(rf"(?<!\w){re.escape(program)}(?!\w)", text) is not None
