"""What the checks say of a build that is missing, or that is not of the present sources."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from ros2lab import course
from ros2lab.checks import CheckError
from ros2lab.diagnose.finding import Finding, stops_build
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.packaging.installed import changed_sources, installed_entry_points, prefix_of
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.workspace import Workspace


class BuiltExecutable(NamedTuple):
    """An executable that was built from the present source.

    Attributes:
        path: of the file that `ros2 run` starts.
        entry_point: what it calls, as `module:function`; empty if that is not known.
    """

    path: Path
    entry_point: str


def built_executable(workspace: Workspace, package: str, name: str) -> BuiltExecutable:
    """Return an executable that was installed from what the sources are now.

    Args:
        workspace: the student's.
        package: the package's name.
        name: the executable's.

    Raises:
        CheckError: if there is none, or the sources have changed since.
    """
    shown = course.shown_path(workspace.path)
    look = Look(workspace.path)
    source = next((known for known in look.packages if known.name == package), None)
    if source is None:
        raise CheckError(
            f"the package {package}",
            f"no package {package} in {shown}/src",
            f"Type `cd {shown}/src`, then `ros2 pkg create` with its options and the name {package}.",
        )
    fault = next(filter(stops_build, look.findings), None)
    if fault is not None:
        raise CheckError(
            f"a package {package} that colcon can build", fault.cause.rstrip("."), _advice(fault).strip()
        )
    paths = {known.name: known.path for known in workspace.executables(package)}
    build = f"Type `cd {shown}`, then `colcon build --packages-select {package}`, and read what it says."
    difference = _named_otherwise(workspace, source, name, name in paths, build) or _edited_since(
        workspace, source, build
    )
    if difference is not None:
        found, hint = difference
        if (workspace.path / "src" / "install").is_dir():
            found += f"; there is a build in {shown}/src, where ROS does not look for it"
        raise CheckError(f"an executable {name}, built from the present source", found, hint)
    return BuiltExecutable(paths[name], _points(source, workspace)[name])


def hint_of(finding: Finding) -> str:
    """Return what a diagnosis says, as a hint: the cause, the place and what to do."""
    return finding.cause + _advice(finding)


def _advice(finding: Finding) -> str:
    place = f" Look at {finding.place}." if finding.place else ""
    return place + (f" {finding.fix[0].upper()}{finding.fix[1:]}." if finding.fix else "")


def _named_otherwise(
    workspace: Workspace, source: SourcePackage, name: str, is_installed: bool, build: str
) -> tuple[str, str] | None:
    """Return what is wrong with an entry point, in setup.py or in what was installed of it, and a hint."""
    prefix = prefix_of(workspace.path, source.name)
    installed = installed_entry_points(prefix, source) if prefix else None
    points = _points(source, workspace)
    if name not in points:
        names = ", ".join(points) or "no executable"
        left_over = f", and the {name} in install/ is left over from an earlier build"
        line = f"'{name} = {source.name}.{name}:main',"
        return (
            f"setup.py names only {names}{left_over if is_installed else ''}",
            f"The entry points of setup.py make the executables: add the line {line} to console_scripts, and build.",
        )
    if prefix is None:
        return f"nothing is installed of {source.name}", build
    if not is_installed:
        return f"setup.py names {name}, and the last build did not install it", build
    if installed is not None and installed.get(name) != points[name]:
        return f"{name} was installed as {installed.get(name)}, and setup.py now says {points[name]}", build
    return None


def _edited_since(workspace: Workspace, source: SourcePackage, build: str) -> tuple[str, str] | None:
    """Return which file of a package is not what was installed, and a hint."""
    prefix = prefix_of(workspace.path, source.name)
    for module, copy in changed_sources(prefix, source) if prefix else ():
        if module.path and copy.is_file() and copy.stat().st_mtime > module.path.stat().st_mtime:
            return (
                f"{module.shown} is not what is installed: the copy in install/ was changed later",
                f"install/ belongs to colcon. Make the change in src/ and build. {build}",
            )
        return f"{module.shown} has changed since the last build", build
    return None


def _points(source: SourcePackage, workspace: Workspace) -> dict[str, str]:
    """Return what each executable calls by setup.py, or as it was installed where setup.py computes them."""
    listed = source.setup.entry_points if source.setup else []
    if listed is None:
        prefix = prefix_of(workspace.path, source.name)
        return (installed_entry_points(prefix, source) if prefix else None) or {}
    return {point.name: f"{point.module}:{point.function}" for point in listed}
