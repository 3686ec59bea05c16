"""A ROS 2 workspace: made, built and tested by the real colcon, with results as plain data."""

from __future__ import annotations

import importlib
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from catkin_pkg.package import InvalidPackage, parse_package

from ros2lab import environment
from ros2lab.build_report import (
    BuildResult,
    Package,
    PackageResult,
    PackageTests,
    TestResult,
    judge_build,
    judge_package_tests,
    judge_tests,
)
from ros2lab.build_text import condensed, first_error
from ros2lab.colcon_record import VARIABLE, FoundPackage, Record, read_record
from ros2lab.interrupts import interrupted_says
from ros2lab.manifest_words import NOT_TAKEN
from ros2lab.package_faults import last_error, manifest_fault, misplaced, setup_fault, text_of
from ros2lab.process_family import family_started
from ros2lab.scratch import scratch_folder

__all__ = [
    "BuildResult",
    "Executable",
    "Package",
    "PackageResult",
    "PackageTests",
    "TestResult",
    "Workspace",
    "WorkspaceError",
]

# In a path, colcon's setup.bash evaluates the first three, ':' separates paths, and setuptools fills in
# what stands in braces: the build then lands elsewhere, or bash runs a piece of the folder's name.
UNUSABLE_CHARACTERS = '"$`:{}'


class WorkspaceError(RuntimeError):
    """Something is wrong with the workspace itself; the text says what, where, and what to do."""


@dataclass(frozen=True)
class Executable:
    """A command that a built package has installed.

    Attributes:
        package: the package's name.
        name: the executable's name.
        path: its file.
    """

    package: str
    name: str
    path: Path


class Workspace:
    """A folder in which colcon builds the packages below `src`.

    Args:
        path: the workspace's folder; it need not exist yet.

    Raises:
        WorkspaceError: if the path holds a character that colcon's own scripts cannot live with.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path).expanduser().absolute()
        unusable = [character for character in UNUSABLE_CHARACTERS if character in str(self.path)]
        if unusable:
            raise WorkspaceError(
                f"The path {self.path} holds {' and '.join(unusable)}, which colcon's setup.bash cannot live "
                "with; choose a folder without it (letters, digits, spaces, - and _ are safe)."
            )

    def create(self) -> Workspace:
        """Make the folder and its `src`; what is there already stays as it is.

        Raises:
            WorkspaceError: if a file is in the way, or the folder cannot be written.
        """
        try:
            (self.path / "src").mkdir(parents=True, exist_ok=True)
        except (FileExistsError, NotADirectoryError):
            raise WorkspaceError(
                f"{self.path / 'src'} cannot be made because a file is in the way; "
                "remove it or choose another folder."
            ) from None
        except OSError as error:
            raise _unwritable(self.path, error) from None
        return self

    def packages(self) -> list[Package]:
        """List the packages that colcon finds, built or not, in the order of their names.

        Raises:
            WorkspaceError: if there is no workspace here, or colcon is missing or fails.
        """
        self._check()
        # A list should leave no log folder behind.
        run = self._run(["--log-base", os.devnull, "list"], lambda _: None)
        if run.returncode:
            raise WorkspaceError(f"colcon list failed in {self.path}: {first_error(run.last_words)}")
        if run.record.packages is None:
            raise WorkspaceError(
                f"The command {_colcon(_environment())} does not load ros2lab's extension, so that nobody knows "
                f"what it does; run `{environment.INSTALL}`, which installs both."
            )
        return [self._package(found) for found in run.record.packages]

    def build(
        self,
        packages: str | Iterable[str] | None = None,
        up_to: str | Iterable[str] | None = None,
        symlink: bool = False,
        *,
        show: bool = True,
    ) -> BuildResult:
        """Build with `colcon build`, as in a terminal.

        Ctrl-C (the stop button of a notebook) stops colcon and everything that it has started.

        Args:
            packages: only these; None builds all.
            up_to: these and everything that they depend on.
            symlink: link Python files instead of copying them, so that an edit needs no new build.
            show: whether colcon's output is printed while it comes.

        Raises:
            WorkspaceError: if there is no workspace here, it cannot be written, a named package is not
                in it, or colcon is missing. A package that does not build is a result, not an error.
        """
        self._check_writable()
        selection = [
            *self._option("--packages-select", packages),
            *self._option("--packages-up-to", up_to),
            *(["--symlink-install"] if symlink else []),
        ]
        run = self._work("build", selection, show)
        found = [self._package(package) for package in run.record.packages or ()]
        reasons = {
            package.name: reason
            for package in found
            if package.name in run.record.jobs and run.record.jobs[package.name].is_colcon_traceback
            if (reason := setup_fault(self.path, package))
        }
        return judge_build(
            run.returncode,
            run.seconds,
            found,
            run.record,
            reasons=reasons,
            noticed={package.name: misplaced(self.path, package) for package in found},
            last_words=run.last_words,
        )

    def test(self, packages: str | Iterable[str] | None = None, *, show: bool = True) -> TestResult:
        """Test with `colcon test`, and read what it has left for `colcon test-result`.

        Args:
            packages: only these; None tests all.
            show: whether colcon's output is printed while it comes.

        Raises:
            WorkspaceError: as for `build`, and if nothing has been built yet.
        """
        self._check_writable()
        if not self._setup_file.exists():
            raise WorkspaceError(f"Nothing is built in {self.path} yet; build it first.")
        selection = self._option("--packages-select", packages)
        started = time.time()
        run = self._work("test", selection, show)
        tested = [job for job in run.record.jobs.values() if job.is_selected]
        reports = self._reports(newer_than=started)
        results = [judge_package_tests(job, reports.get(job.name, [])) for job in tested]
        return judge_tests(run.returncode, run.seconds, results, run.record, last_words=run.last_words)

    def executables(self, package: str | None = None) -> list[Executable]:
        """List the executables that are installed, as `ros2 run` would find them.

        Args:
            package: only this package's; None lists all.
        """
        # isolated: install/<package>/lib/<package>; merged: install/lib/<package>
        folders = [*self.path.glob("install/*/lib/*"), *self.path.glob("install/lib/*")]
        found = [
            Executable(folder.name, path.name, path)
            for folder in folders
            if folder.parts[-3] in (folder.name, "install") and package in (None, folder.name)
            for path in folder.iterdir()
            if path.is_file() and os.access(path, os.X_OK)
        ]
        return sorted(found, key=lambda executable: (executable.package, executable.name))

    def failures(self) -> dict[str, str]:
        """Return what went wrong in the last build of each package whose last build failed, by package.

        It may have been run in any terminal. What an earlier build has installed is still there after one that
        failed.
        """
        # colcon keeps the exit code of each package's last build.
        codes = {
            file.parent.name: text_of(file).strip() for file in self.path.glob("build/*/colcon_build.rc")
        }
        if set(codes.values()) <= {"0"}:
            return {}
        return {
            package.name: last_error(self.path, package) or f"it ended with {codes[package.name]}"
            for package in self.packages()
            if codes.get(package.name, "0") != "0"
        }

    @property
    def overlay(self) -> dict[str, str]:
        """The environment in which the built packages are found: what bash has after `install/setup.bash`.

        Raises:
            WorkspaceError: if nothing has been built, or bash cannot source the file.
        """
        if not self._setup_file.is_file():
            raise WorkspaceError(f"{self._setup_file} is missing; build the workspace first.")
        before = _environment()
        # BASH_ENV would have bash read a file of the user's first.
        before.pop("BASH_ENV", None)
        try:
            finished = subprocess.run(
                [
                    "bash",
                    "--noprofile",
                    "--norc",
                    "-c",
                    'source "$1" >&2 && env -0',
                    "bash",
                    self._setup_file,
                ],
                env=before,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                check=False,
            )
        except FileNotFoundError:
            raise WorkspaceError("A workspace is sourced with bash, which is not installed.") from None
        if finished.returncode:
            said = " ".join(finished.stderr.decode(errors="replace").split())
            raise WorkspaceError(
                f"bash cannot source {self._setup_file} ({said}); "
                f"remove {self.path / 'install'} and build again."
            )
        after = environment.parse_environment(finished.stdout)
        # bash's own, which say nothing of the workspace.
        return {name: value for name, value in after.items() if name in before or name not in _BASH_VARIABLES}

    def source(self) -> None:
        """Do for this process what `source install/setup.bash` does for a shell.

        What was imported from an earlier build is forgotten, so that the next import takes the new one.

        Raises:
            WorkspaceError: as for `overlay`.
        """
        overlay = self.overlay
        os.environ.update(overlay)
        folders = [folder for folder in overlay.get("PYTHONPATH", "").split(os.pathsep) if folder]
        sys.path[:] = [*folders, *(folder for folder in sys.path if folder not in folders)]
        for name, module in list(sys.modules.items()):
            if self.path in Path(getattr(module, "__file__", None) or "/").parents:
                del sys.modules[name]
        importlib.invalidate_caches()

    @property
    def _setup_file(self) -> Path:
        return self.path / "install" / "setup.bash"

    def _check(self) -> None:
        if self.path.exists() and not self.path.is_dir():
            raise WorkspaceError(
                f"{self.path} is a file, not a folder; choose another path for the workspace."
            )
        if not (self.path / "src").is_dir():
            raise WorkspaceError(
                f"There is no src folder in {self.path}; is the path right? "
                "`create()` makes a new workspace there."
            )
        if sys.executable and any(character.isspace() for character in sys.executable):
            # Neither colcon's setup.bash nor the first line of an executable can name such a Python.
            raise WorkspaceError(
                f"This Python is at {sys.executable}, and what colcon builds cannot name a program whose "
                f"path has a space; move the course's folder to a path without spaces and run `{environment.INSTALL}`."
            )

    def _check_writable(self) -> None:
        self._check()
        for name in (".", "build", "install", "log"):
            folder = self.path / name
            if not folder.exists():
                continue
            try:
                with tempfile.TemporaryFile(dir=folder):
                    pass
            except OSError as error:
                raise _unwritable(folder, error) from None

    def _option(self, name: str, packages: str | Iterable[str] | None) -> list[str]:
        """Return a command-line option that chooses packages, all of which must be in this workspace."""
        if packages is None:
            return []
        wanted = [packages] if isinstance(packages, str) else list(packages)
        if not all(map(self._is_in_its_folder, wanted)):
            self._refuse_missing(wanted, self.packages())
        return [name, *wanted]

    def _is_in_its_folder(self, package: str) -> bool:
        """Return whether a package seems to be where most are, for which colcon need not be asked before it works."""
        try:
            return bool(parse_package(str(self.path / "src" / package), warnings=[]).name == package)
        except (InvalidPackage, OSError, *NOT_TAKEN):
            return False

    def _refuse_missing(
        self, wanted: Iterable[str], found: Iterable[Package] | Iterable[FoundPackage] | None
    ) -> None:
        """Raise an error if a package is not among those that colcon finds; nothing is known of None."""
        if found is None:
            return
        there = [package.name for package in found]
        for package in wanted:
            if package not in there:
                raise WorkspaceError(
                    f"There is no package {package!r} in {self.path}; "
                    f"colcon finds: {', '.join(there) or 'none'}."
                )

    def _package(self, found: FoundPackage) -> Package:
        """Describe a package that colcon has found."""
        path = self.path / found.path
        problem = manifest_fault(path) if found.kind == "python" else None
        return Package(found.name, path, found.kind.removeprefix("ros."), problem)

    def _work(self, verb: str, selection: Sequence[str], show: bool) -> _Run:
        """Run a verb of colcon that works on packages, and show what it prints."""

        def take(line: str) -> None:
            if show:
                sys.stdout.write(line)
                sys.stdout.flush()

        bases = ["--build-base", "build", "--install-base", "install"]
        # Whatever the user's defaults say: no window should pop up.
        handlers = ["--event-handlers", "desktop_notification-"]
        run = self._run(["--log-base", "log", verb, *bases, *handlers, *selection], take)
        if not run.record.is_begun:
            # It ended before it loaded the extension, or cannot: a list fails for the same reason, and says it.
            self.packages()
        chosen = [word for word in selection if not word.startswith("--")]
        self._refuse_missing(chosen, run.record.packages)
        return run

    def _run(self, arguments: Sequence[str], take: Callable[[str], None]) -> _Run:
        """Run colcon in the workspace, handing over its output line by line, and read what it has recorded."""
        child = _environment()
        last_words: deque[str] = deque(maxlen=20)
        with scratch_folder() as scratch:
            file = scratch / "record.jsonl"
            file.touch()
            child[VARIABLE] = str(file)
            started = time.monotonic()
            with (
                interrupted_says("colcon and what it had started were stopped."),
                family_started([_colcon(child), *arguments], self.path, child) as process,
            ):
                assert process.stdout is not None
                for line in condensed(process.stdout):
                    last_words.append(line)
                    take(line)
                returncode = process.wait()
            seconds = time.monotonic() - started
            record = read_record(file.read_text(encoding="utf-8"))
        return _Run(returncode, seconds, record, tuple(last_words))

    def _reports(self, newer_than: float) -> dict[str, list[str]]:
        """Return the text of each test report that was written since `newer_than` (s), by package."""
        paths: list[str] = []
        self._run(
            ["--log-base", os.devnull, "test-result", "--all", "--result-files-only"],
            lambda line: paths.append(line.rstrip("\n")),
        )
        reports: dict[str, list[str]] = {}
        for relative in paths:
            path = self.path / relative
            # A file's time may lag behind the clock by a tick.
            if path.is_file() and path.stat().st_mtime > newer_than - 0.1:
                reports.setdefault(Path(relative).parts[1], []).append(text_of(path))
        return reports

    def __repr__(self) -> str:
        return f"Workspace({str(self.path)!r})"


_BASH_VARIABLES = ("_", "OLDPWD", "PWD", "SHLVL")


@dataclass(frozen=True)
class _Run:
    """What a run of colcon came to, and the last lines that it printed."""

    returncode: int
    seconds: float
    record: Record
    last_words: tuple[str, ...]


def _environment() -> dict[str, str]:
    try:
        return environment.lab_environment()
    except RuntimeError as error:
        raise WorkspaceError(str(error)) from None


def _colcon(environ: Mapping[str, str]) -> str:
    """Return the path of the command colcon in an environment."""
    colcon = shutil.which("colcon", path=environ.get("PATH"))
    if colcon is None:
        raise WorkspaceError(f"The command colcon is not installed; run `{environment.INSTALL}`.")
    return colcon


def _unwritable(folder: Path, error: OSError) -> WorkspaceError:
    return WorkspaceError(
        f"{folder.resolve()} cannot be written ({error.strerror}); "
        "fix its permissions or choose a workspace below your home folder."
    )
