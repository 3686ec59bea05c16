"""How the checks run a student's programs to their end, and read what they leave."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import subprocess
import tempfile
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from ros2lab import course, environment
from ros2lab.checks import CheckError
from ros2lab.diagnose import of_text, of_workspace
from ros2lab.node_process import last_line
from ros2lab.process_family import end_kept, kept
from ros2lab.scratch import scratch_folder
from ros2lab.workspace import Workspace, WorkspaceError

RUN_TIMEOUT = 30.0  # s, for a program that prints a line and ends
LARGEST_OUTPUT = 10_000_000  # bytes, so that a loop that prints does not fill the disk


def run(
    command: Sequence[str | Path],
    name: str,
    *,
    folder: Path | None = None,
    environ: Mapping[str, str] | None = None,
) -> subprocess.CompletedProcess[str]:
    """Run a command to its end, and end what it leaves running.

    Args:
        command: its words.
        name: what it is called to the student.
        folder: where it runs; None is here.
        environ: its environment; None is that of a terminal of the lab.

    Raises:
        CheckError: if it cannot be started, or does not end within `RUN_TIMEOUT`.
    """
    own = environment.lab_environment() if environ is None else environ
    program = shutil.which(command[0], path=own.get("PATH"))
    if program is None:
        reason = errno.EACCES if Path(command[0]).exists() else errno.ENOENT
        raise CheckError(f"{name} can be started", os.strerror(reason), "was it built, and is it there?")
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(
            kept(["/usr/bin/prlimit", f"--fsize={LARGEST_OUTPUT}", str(program), *map(str, command[1:])]),
            cwd=folder,
            env=own,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=errors,
            start_new_session=True,
        )
        try:
            process.wait(RUN_TIMEOUT)
        except subprocess.TimeoutExpired:
            raise CheckError(
                f"{name} ends", f"after {RUN_TIMEOUT:g} s it still runs", "which loop in it has no end?"
            ) from None
        finally:
            end_kept(process)
        texts = []
        for file in (output, errors):
            file.seek(0)
            texts.append(file.read().decode(errors="replace"))
    return subprocess.CompletedProcess(command, process.returncode, *texts)


def create_package(source: Path, name: str, files: Mapping[str, str], *options: str) -> Path:
    """Make a Python package with `ros2 pkg create`, and write its files; one that is there stays as it is.

    Args:
        source: the `src` of a workspace; it need not exist.
        name: of the package.
        files: texts by their paths inside the package.
        options: more of `ros2 pkg create`.

    Returns:
        The package's folder.

    Raises:
        OSError: if a file cannot be written.
        subprocess.CalledProcessError: if `ros2 pkg create` fails.
    """
    folder = source / name
    if not folder.exists():
        source.mkdir(parents=True, exist_ok=True)
        command = ["ros2", "pkg", "create", name, "--build-type", "ament_python", "--license", "Apache-2.0"]
        command += ["--maintainer-name", "Ada Lovelace", "--maintainer-email", "ada@example.org", *options]
        environ = environment.lab_environment()
        subprocess.run(command, cwd=source, env=environ, check=True, capture_output=True)
        for path, text in files.items():
            (folder / path).write_text(text, encoding="utf-8")
    return folder


def overlay_of(workspace: Workspace) -> dict[str, str]:
    """Return the environment of a terminal that has sourced a workspace.

    Raises:
        CheckError: if it is not built, or cannot be sourced.
    """
    try:
        return workspace.overlay
    except WorkspaceError as error:
        shown = course.shown_path(workspace.path)
        raise CheckError(
            f"{shown} is built",
            str(error).replace(str(workspace.path), shown),
            f"type `cd {shown}`, then `colcon build`.",
        ) from error


def check_last_build(workspace: Workspace) -> None:
    """Check that no package failed in its last build: a build that fails leaves the earlier install.

    Raises:
        CheckError: with the build's own words, if one did.
    """
    for package, said in workspace.failures().items():
        raise CheckError(
            f"the last build of {package} in {course.shown_path(workspace.path)} succeeded",
            f"it failed: {said}",
            "fix what the build names there, and build again; until then the earlier build runs.",
        )


def check_runs(workspace: Workspace, package: str, executable: str, words: str, *hints: str) -> None:
    """Check that `ros2 run` starts what the sources say now, and that the student has built that.

    The present sources are built in a folder apart first: nothing that an earlier build has left can pass for
    the present one.

    Args:
        workspace: the student's.
        package: its name.
        executable: the name of the executable.
        words: what it must print.
        hints: what is said where no cause is seen in the files; at least one.

    Raises:
        CheckError: if it is not built, cannot be started, or prints something else.
    """
    shown = course.shown_path(workspace.path)
    folder = _folder_of(workspace, package, *hints)
    expected = f"`ros2 run {package} {executable}` prints {words!r}"
    with _built_apart(workspace, package, folder, *hints) as apart:
        said, is_failed = _run_executable(apart, package, executable)
        found = f"built from what is in src now, it prints {_quoted(said)}"
        if is_failed:
            said = f"$ ros2 run {package} {executable}\n{said}"
            raise CheckError(expected, found, *(_causes(apart, folder, said) or hints))
        if words not in said:
            hint = f"it starts and ends well, but the function that it calls does not print {words!r}."
            raise CheckError(expected, found, hint, *hints)
    said, is_failed = _run_executable(workspace, package, executable)
    if is_failed or words not in said:
        raise CheckError(
            expected,
            f"what is in src is right, but what is installed prints {_quoted(said)}",
            f"build it as it is now: type `cd {shown}`, then `colcon build --packages-select {package}`.",
        )


def _folder_of(workspace: Workspace, package: str, *hints: str) -> str:
    """Return the folder in which colcon finds a ROS package, from the workspace on."""
    shown = course.shown_path(workspace.path)
    try:
        packages = {listed.name: listed for listed in workspace.packages()}
    except WorkspaceError as error:
        said = str(error).replace(str(workspace.path), shown)
        raise CheckError(
            f"packages in {shown}/src", said, f"colcon looks for them in {shown}/src."
        ) from error
    if package not in packages or not packages[package].path.is_relative_to(workspace.path / "src"):
        raise CheckError(
            f"colcon finds a package {package} in {shown}/src",
            f"it finds {', '.join(course.shown_path(listed.path) for listed in packages.values()) or 'none'}",
            f"a package is a folder in {shown}/src with a package.xml, and <name> in it says {package}.",
        )
    folder = str(packages[package].path.relative_to(workspace.path))
    if (problem := packages[package].problem) is not None:
        raise CheckError(
            f"colcon takes {package} for (ros.ament_python)",
            f"it takes it for (python), because of its package.xml: {problem}",
            *(_causes(workspace, folder, problem) or hints),
        )
    return folder


@contextlib.contextmanager
def _built_apart(workspace: Workspace, package: str, folder: str, *hints: str) -> Iterator[Workspace]:
    """Build a package, and what it needs of its workspace, from the present sources in a folder apart."""
    with scratch_folder() as temporary:
        apart = Workspace(temporary / workspace.path.name)
        shutil.copytree(workspace.path / "src", apart.path / "src", symlinks=True)
        result = apart.build(up_to=package, show=False)
        if not result.is_ok:
            shown = course.shown_path(workspace.path)
            said = str(result.first_error)
            raise CheckError(
                f"`colcon build --packages-up-to {package}` succeeds with what is in {shown}/src now",
                said.replace(str(apart.path), shown),
                *(_causes(apart, folder, str(result)) or hints),
            )
        yield apart


def _run_executable(workspace: Workspace, package: str, executable: str) -> tuple[str, bool]:
    """Return what `ros2 run` prints, and whether it fails."""
    command = ["ros2", "run", package, executable]
    finished = run(command, f"`{' '.join(command)}`", environ=overlay_of(workspace))
    return finished.stdout + finished.stderr, finished.returncode != 0


def _quoted(output: str) -> str:
    said = last_line(output)
    return repr(said) if said else "nothing"


def _causes(workspace: Workspace, folder: str, said: str) -> list[str]:
    """Return what in the files of a package explains what was said, or else all that is seen to be wrong there."""
    for findings in (of_text(said, workspace.path), of_workspace(workspace.path)):
        own = [finding for finding in dict.fromkeys(findings) if finding.place.startswith(folder)]
        if own:
            return [f"{finding.cause} To fix it: {finding.fix}." for finding in own]
    return []


class TestCase(NamedTuple):
    """A test in a report of pytest.

    Attributes:
        module: the name of its file, without the folder and the ending.
        name: of the function.
        outcome: `passed`, `failed` or `skipped`; a test that could not be started has failed.
        message: the first line of why it failed or was skipped.
    """

    module: str
    name: str
    outcome: str
    message: str


def read_tests(report: Path, *, except_of: Collection[str] = ()) -> list[TestCase] | None:
    """Return the tests in a report of pytest.

    Args:
        report: the `pytest.xml` that `colcon test` leaves in `build/<package>`.
        except_of: the modules whose tests do not count.

    Returns:
        None if there is no report, or it cannot be read.
    """
    try:
        cases = list(ET.parse(report).iter("testcase"))  # noqa: S314 -- the student's own pytest wrote it
    except (OSError, ET.ParseError):
        return None
    tests = (_test_of(case) for case in cases)
    return [test for test in tests if test.module not in except_of]


def count_tests(report: Path, *, except_of: Collection[str] = ()) -> Counter[str] | None:
    """Count the tests in a report of pytest: `passed`, `failed` and `skipped`; the arguments of `read_tests`."""
    tests = read_tests(report, except_of=except_of)
    return None if tests is None else Counter(test.outcome for test in tests)


def _test_of(case: ET.Element) -> TestCase:
    name = case.get("name", "")
    # A class comes after its module, and a module that cannot be imported is a case without either.
    path = (case.get("classname") or name).split(".")
    module = next((part for part in path if part.startswith("test_")), path[-1])
    for tag, outcome in (("failure", "failed"), ("error", "failed"), ("skipped", "skipped")):
        reason = case.find(tag)
        if reason is not None:
            # The message of an error only says where; pytest marks the lines of what was raised with E.
            marked = [line[1:].strip() for line in (reason.text or "").splitlines() if line.startswith("E ")]
            message = marked[-1] if tag == "error" and marked else reason.get("message", "")
            return TestCase(module, name, outcome, message.partition("\n")[0])
    return TestCase(module, name, "passed", "")
