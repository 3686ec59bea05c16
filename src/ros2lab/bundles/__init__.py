"""The course, packed for where it is to run: without a network, in Gradescope, in a repository's own CI."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from importlib import resources
from pathlib import Path
from string import Template

from packaging.requirements import Requirement

from ros2lab import environment
from ros2lab.scratch import scratch_folder

PYTHONS = tuple(f"3.{minor}" for minor in range(10, 15))
WHEELS = "wheels"  # where tools/bootstrap.py looks for them
OFFLINE_LOCKS = ("uv", "student", "ros")
NOT_PACKED = (
    ".*",
    "work",
    "nbgrader-course",
    "build",
    "install",
    "log",
    "dist",
    WHEELS,
    "*.egg-info",
    "__pycache__",
)
Progress = Callable[[str, int, int], None]


class BundleError(RuntimeError):
    """One sentence: what keeps a bundle from being made, and what to do."""


def offline(folder: Path, pythons: Sequence[str], progress: Progress) -> None:
    """Make a folder that holds the course and all of its packages, and that installs without a network.

    Args:
        folder: the new folder. It appears when it is whole.
        pythons: the versions of Python that the other machines have, such as `3.12`.
        progress: called with a version of Python, how many of its packages are fetched, and of how many.

    Raises:
        BundleError: if it cannot be made.
    """
    for python in pythons:
        if python not in PYTHONS:
            raise BundleError(
                f"The course has no packages for Python {python}; give one of {', '.join(PYTHONS)}."
            )
    with made_whole(folder) as unfinished:
        _pack_course(unfinished)
        for python in pythons:
            wanted = {line for name in OFFLINE_LOCKS for line in locked(name, python)}
            _fetch(wanted, python, unfinished / WHEELS, progress)
        _write_script(unfinished / "lab")


def gradescope(path: Path, assignment: Path | None) -> None:
    """Make the zip that Gradescope takes as an autograder.

    Args:
        path: the new zip.
        assignment: the folder of an assignment of your own; None for the course's.

    Raises:
        BundleError: if it cannot be made.
    """
    with made_whole(path) as unfinished, scratch_folder() as scratch:
        _pack_course(Path(scratch, "ros2lab"))
        if assignment:
            shutil.copytree(assignment, Path(scratch, "assignment"))
        for name in ("setup.sh", "run_autograder"):
            _write_script(Path(scratch, name))
        shutil.make_archive(str(unfinished.with_suffix("")), "zip", scratch)


def github(path: Path, source: str, python: str) -> None:
    """Write a workflow for GitHub Actions that builds, tests and grades the repository in which it lies.

    Args:
        path: the workflow's file.
        source: where the course is cloned from.
        python: the version of Python to use.

    Raises:
        BundleError: if the file is there already, and is another one.
    """
    text = Template(_text("workflow.yml")).substitute(source=source, python=python)
    if path.exists() and path.read_text(encoding="utf-8", errors="replace") != text:
        raise BundleError(f"{path} is there already; move it away, or name another file with --out.")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def locked(name: str, python: str) -> Iterator[str]:
    """Yield the requirements of a lock file that a version of Python has, each with its hashes.

    pip asks a marker of the Python that runs it, also where it fetches for another one.

    Args:
        name: of the lock file, such as `student`.
        python: a version, such as `3.12`.
    """
    version = {"python_version": python, "python_full_version": f"{python}.0"}
    lines = (_checkout() / "locks" / f"{name}.txt").read_text(encoding="utf-8").replace("\\\n", " ")
    for line in filter(None, map(str.strip, lines.splitlines())):
        requirement, *hashes = re.split(r"\s+(?=--hash=)", line)
        parsed = Requirement(requirement)
        if parsed.marker is None or parsed.marker.evaluate(version):
            yield " ".join((f"{parsed.name}{parsed.specifier}", *hashes))


def _checkout() -> Path:
    if not environment.IS_CHECKOUT:
        raise BundleError("A bundle is made from a checkout of the course: clone it, and run this there.")
    return Path(environment.__file__).parents[2]


def _pack_course(folder: Path) -> None:
    """Copy the course's sources, without anything that was built, installed or worked on."""
    shutil.copytree(
        _checkout(), folder, symlinks=True, ignore=shutil.ignore_patterns(*NOT_PACKED), dirs_exist_ok=True
    )


def _fetch(wanted: Collection[str], python: str, folder: Path, progress: Progress) -> None:
    """Fetch packages for a version of Python into a folder."""
    done = 0
    folder.mkdir(exist_ok=True)
    requirements = folder / "requirements.txt"
    requirements.write_text("\n".join(sorted(wanted)), encoding="utf-8")
    options = ["--no-deps", "--require-hashes", "--prefer-binary", "--python-version", python]
    files = ["-r", str(requirements.absolute()), "-d", str(folder.absolute())]
    command = [sys.executable, "-m", "pip", "download", *options, *files]
    said: list[str] = []
    progress(python, done, len(wanted))
    with subprocess.Popen(
        command, cwd="/", stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as pip:
        assert pip.stdout is not None
        for line in pip.stdout:
            said.append(line.strip())
            if line.startswith("Collecting "):
                done += 1
                progress(python, min(done, len(wanted)), len(wanted))
    requirements.unlink()
    if pip.returncode:
        reason = said[-1].removeprefix("ERROR: ").rstrip(".") if said else "it says nothing"
        raise BundleError(
            f"pip cannot fetch the packages ({reason}); connect this computer and run this again."
        )


@contextmanager
def made_whole(path: Path) -> Iterator[Path]:
    """Yield where a file or folder is to be made; it appears under its own name when it is whole."""
    if path.exists():
        raise BundleError(f"{path} is there already; move it away, or name another one with --out.")
    path.parent.mkdir(parents=True, exist_ok=True)
    with scratch_folder(path.parent) as scratch:
        unfinished = scratch / path.name
        yield unfinished
        unfinished.rename(path)


def _write_script(path: Path) -> None:
    path.write_text(_text(path.name), encoding="utf-8")
    path.chmod(0o755)


def _text(name: str) -> str:
    return resources.files(__name__).joinpath(name).read_text(encoding="utf-8")
