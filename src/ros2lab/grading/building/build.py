"""Build a submission with colcon in the sandbox, and find out how to start each of its programs.

The build runs in a fresh workspace beside the submission, so that nothing around a package takes part in it.
What a build leaves may be anything: it is listed and read in a box, and the next box puts it to the test.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace

from ros2lab.grading.building.colcon_build import Outcome, overlay_of, run_colcon
from ros2lab.grading.building.programs import MOST_PROGRAMS, loose_script, of_modules, programs_of
from ros2lab.grading.evidence import Build, Executable
from ros2lab.grading.reading.build_plan import Plan, needs_cmake, one_line
from ros2lab.grading.receiving.notes import first_of
from ros2lab.grading.receiving.submission import Submission
from ros2lab.grading.sandbox.worlds import World, underlay

_OF_COLCON = re.compile(r"package\.(ba|z|)sh$|package\.(dsv|ps1|xml)$|hook/")


def build(world: World, submission: Submission, plan: Plan | None) -> Build:
    """Build the assignment's package, and the other packages that it needs or that launch it.

    Args:
        world: holds a copy of the submission, of which nothing has run yet; its limits hold for colcon. It
            shows `environment.DDS_PROFILE`.
        submission: what was found in that copy.
        plan: the plan of the build, laid out; None if there is no package, or none that could be read.

    Returns:
        The result; without a package it has only scripts.

    Raises:
        RuntimeError: as for `underlay`.
        SandboxMissing: if a box cannot be made.
    """
    environ = underlay()
    loose = [loose_script(name) for name in submission.node_files]
    if plan:
        world.folders.extend(plan.places)
    if plan is None or plan.found is None:
        return _unbuilt(submission, plan, loose, environ)
    outcome = run_colcon(world, plan, environ)
    overlay = overlay_of(plan, outcome.files, environ)
    programs = programs_of(world, plan, outcome, overlay)
    if not any(program.command for program in programs):
        programs += [replace(script, fault="It does not lie in the package.") for script in loose]
    shares = [f"{name}/share/{name}/" for name in plan.names]
    shared = [
        path.removeprefix(share) for share in shares for path in outcome.files if path.startswith(share)
    ]
    if plan.not_installed(outcome.files):
        shared += plan.shared
    return Build(
        outcome.is_built,
        outcome.error,
        outcome.warnings,
        [*plan.settings, *_notes(submission, plan, outcome)],
        programs[:MOST_PROGRAMS],
        sorted(path for path in shared if not _OF_COLCON.match(path)),
        overlay,
        outcome.seconds,
        sorted(plan.absent),
        outcome.cut,
    )


def _unbuilt(
    submission: Submission, plan: Plan | None, loose: Iterable[Executable], environ: dict[str, str]
) -> Build:
    """Return the result where nothing can be built: only files that are started as they are."""
    error = "The package could not be read." if submission.package else "There is no package to build."
    programs = [replace(script, fault="There is no package to which it belongs.") for script in loose][
        :MOST_PROGRAMS
    ]
    if plan is None:
        return Build(False, error, [], [], programs, [], environ, 0.0)
    programs = [of_modules(plan, program) for program in programs]
    environ = overlay_of(plan, (), environ)
    return Build(False, error, [], [*_stood_in(plan)], programs, [], environ, 0.0)


def _notes(submission: Submission, plan: Plan, outcome: Outcome) -> Iterator[str]:
    """Yield what was built or started differently than in a complete workspace with all its dependencies."""
    known = (*plan.names, *plan.needing_cmake)
    left = [str(one.name) for one in submission.packages if needs_cmake(one) and one.name not in known]
    if left:
        yield f"Not built, for they need CMake, and nothing of what is graded needs them: {one_line(first_of(left))}."
    if needing := plan.not_installed(outcome.files):
        yield f"Not built, for it needs CMake, but its files are found: {', '.join(needing)}."
    programs = [f"{name} of {package}" for package, found in plan.absent.items() for name in found]
    if programs:
        names = one_line(", ".join(programs))
        yield f"Not installed here, so that programs that do nothing were launched in their place: {names}."
    yield from _stood_in(plan)


def _stood_in(plan: Plan) -> Iterator[str]:
    if plan.absent_modules:
        names = one_line(", ".join(plan.absent_modules))
        yield f"Not installed here, so that modules that do nothing were imported in their place: {names}."
