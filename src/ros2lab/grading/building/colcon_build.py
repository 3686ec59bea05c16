"""Build with colcon in the sandbox, and judge what the build left, which may be anything."""

from __future__ import annotations

import configparser
import json
import os
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ros2lab.build_report import (
    BuildResult,
    judge_build,
)
from ros2lab.build_report import Package as ListedPackage
from ros2lab.build_text import first_error
from ros2lab.colcon_record import VARIABLE, Job, read_record
from ros2lab.grading.evidence import NO_WORD, OTHER_TYPE
from ros2lab.grading.reading.absent import MARKERS
from ros2lab.grading.reading.build_plan import Plan, Point, one_line
from ros2lab.grading.sandbox.box import Box
from ros2lab.grading.sandbox.bubblewrap import PACKAGE
from ros2lab.grading.sandbox.worlds import FILES, World

READ_TIME = 30.0  # s
EXTENSION = (
    PACKAGE / "__init__.py",
    PACKAGE / "colcon_extension.py",
)  # that records what colcon does; it needs nothing else
RECORD = "colcon.jsonl"  # what colcon did, in the workspace

# Prints what a build has left. It runs in a box, where no link can lead to the grader's files.
_READER = """
import json, os, stat, sys
def text(path, most):
    try:
        file = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        with open(file, 'rb') as data:
            is_file = stat.S_ISREG(os.fstat(file).st_mode)
            return data.read(most).decode(errors='replace') if is_file else ''
    except OSError:
        return ''
files, points, heads, room = {}, {}, {}, 500_000
for parent, folders, names in os.walk('install'):
    folders.sort()
    for name in sorted(names):
        path = os.path.join(parent, name)
        room -= len(path)
        if room > 0 and '__pycache__' not in path and os.path.isfile(path):
            files[path[len('install/'):]] = os.access(path, os.X_OK)
        if parent.count('/') == 3 and parent.split('/')[2] == 'lib' and len(heads) < 50:
            heads[path[len('install/'):]] = text(path, 100)
        if name == 'entry_points.txt' and len(points) < 10:
            points[path[len('install/'):]] = text(path, 20_000)
print(json.dumps({
    'files': files,
    'points': points,
    'heads': heads,
    'record': text(sys.argv[1], 5_000_000),
}))
"""


@dataclass(frozen=True)
class Outcome:
    """What a build has left.

    Attributes:
        files: everything below install, with whether it can be executed.
        points: the installed entry points.
        cut: which limit ended colcon; empty if it ended by itself.
        unbound: scripts that name no Python of this machine, because newer setuptools leave that to pip.
    """

    is_built: bool
    error: str
    warnings: list[str]
    files: dict[str, bool]
    points: list[Point]
    unbound: frozenset[str]
    seconds: float
    cut: str = ""


def run_colcon(world: World, plan: Plan, environ: Mapping[str, str]) -> Outcome:
    """Run `colcon build` in the workspace of a plan, which is laid out, and judge what it has left."""
    folder = f"{FILES}/{plan.workspace}"
    bases = ["--build-base", "build", "--install-base", "install"]
    handlers = ["--event-handlers", "desktop_notification-"]
    box = world.run(
        # The failure of another package must not end the build of this one.
        ["colcon", "--log-base", "log", "build", *bases, *handlers, "--continue-on-error"],
        files="write",
        environ={**environ, VARIABLE: RECORD},
        cwd=folder,
        shown=EXTENSION,
    )
    limits = replace(world.limits, wall_s=READ_TIME, cpu_s=READ_TIME, output_bytes=20_000_000)
    reader = [sys.executable, "-I", "-S", "-c", _READER, RECORD]
    left = read_left(world.run(reader, cwd=folder, limits=limits).output)
    record = read_record(left["record"])
    packages = record.packages or []
    asked = _ask_setup(world, plan, environ, record.jobs)
    result = judge_build(
        box.wait(),
        box.seconds,
        [ListedPackage(name, Path(path), kind.removeprefix("ros.")) for name, path, kind in packages],
        record,
        reasons={plan.name: reason} if asked and (reason := _reason(asked)) else {},
        last_words=box.output.splitlines()[-20:],
    )
    return judge(
        plan,
        result,
        {name: kind for name, _, kind in packages},
        box.cut or (asked.cut if asked else None),
        left,
    )


def read_left(printed: str) -> dict[str, Any]:
    """Parse the output of `_READER`; the result is empty for anything else."""
    try:
        return dict(json.loads(printed))
    except ValueError:
        return {"files": {}, "points": {}, "heads": {}, "record": ""}


def judge(
    plan: Plan, result: BuildResult, kinds: Mapping[str, str], cut: str | None, left: Mapping[str, Any]
) -> Outcome:
    """Judge how the build of the package went.

    Args:
        plan: what was built.
        result: the result of the build.
        kinds: the packages that colcon listed, with their types, such as `ros.ament_python`.
        cut: which limit ended the build.
        left: from `read_left`.
    """
    name, found = plan.name, plan.found
    mine = next((package for package in result.packages if package.name == name), None)
    files = dict(left["files"])
    is_installed = f"{name}/{MARKERS}/{name}" in files and any(
        re.match(rf"{re.escape(name)}/(local/)?lib/python3[^/]*/[^/]*-packages/[^/]*-info/", path)
        for path in files
    )
    is_built = kinds.get(name) == "ros.ament_python" and mine is not None and mine.is_ok and is_installed
    error = ""
    if not is_built:
        kind = kinds.get(name)
        reasons = [
            cut,
            mine.error if mine else None,
            found and found.error and f"{OTHER_TYPE[0]}: {found.error}",
            f"{OTHER_TYPE[1]}{kind}, not as ros.ament_python."
            if kind not in (None, "ros.ament_python")
            else None,
            result.first_error,
            f"colcon finds no package {name}." if kind is None else None,
            NO_WORD,
        ]
        error = next(reason for reason in reasons if reason)
    warnings = [*(mine.warnings if mine else ()), *result.warnings]
    return Outcome(
        is_built,
        one_line(error),
        [one_line(warning) for warning in warnings],
        files,
        [*points_in(left["points"], name)],
        frozenset(path for path, head in left["heads"].items() if head.startswith("#!python\n")),
        result.seconds,
        "" if is_built else cut or "",
    )


def points_in(texts: Mapping[str, str], name: str) -> Iterator[Point]:
    """Yield the console scripts in a package's installed metadata."""
    for path, text in texts.items():
        if not path.startswith(f"{name}/"):
            continue
        parser = configparser.RawConfigParser(delimiters=("=",), strict=False)
        parser.optionxform = str  # type: ignore[assignment, method-assign]
        try:
            parser.read_string(text)
        except configparser.Error:
            continue
        for script, target in (
            parser.items("console_scripts") if parser.has_section("console_scripts") else ()
        ):
            module, _, function = target.partition("[")[0].replace(" ", "").partition(":")
            yield Point(one_line(script), module, function)


def _ask_setup(world: World, plan: Plan, environ: Mapping[str, str], jobs: Mapping[str, Job]) -> Box | None:
    """Run setup.py itself to see what is wrong, if colcon shows only its own traceback; else return None."""
    job = jobs.get(plan.name)
    if job is None or not job.is_colcon_traceback:
        return None
    limits = replace(world.limits, wall_s=min(READ_TIME, world.limits.wall_s))
    return world.run(
        [sys.executable, "setup.py", "--name"], environ=environ, cwd=plan.source_of(""), limits=limits
    )


def _reason(asked: Box) -> str | None:
    return asked.cut or first_error(asked.output.splitlines()) if asked.code else None


def overlay_of(plan: Plan, files: Iterable[str], environ: Mapping[str, str]) -> dict[str, str]:
    """Return the environment after `source install/setup.bash` if there are no hooks but colcon's own."""
    result = dict(environ)
    paths = [*files]
    if plan.not_installed(paths) or plan.absent:
        _prepend(result, "AMENT_PREFIX_PATH", plan.unbuilt)
    for name in reversed(plan.names):
        own = [path.removeprefix(f"{name}/") for path in paths if path.startswith(f"{name}/")]
        prefix = f"{plan.install}/{name}"
        if f"share/{name}/hook/ament_prefix_path.dsv" in own:
            _prepend(result, "AMENT_PREFIX_PATH", prefix)
        for folder in sorted(
            {m[1] for path in own if (m := re.match(r"((?:local/)?lib/python3[^/]*/[^/]*-packages)/", path))}
        ):
            _prepend(result, "PYTHONPATH", f"{prefix}/{folder}")
        if any(path.startswith("bin/") for path in own):
            _prepend(result, "PATH", f"{prefix}/bin")
    if plan.absent_modules:
        result["PYTHONPATH"] = os.pathsep.join(filter(None, (result.get("PYTHONPATH"), plan.modules_unbuilt)))
    if paths:
        _prepend(result, "COLCON_PREFIX_PATH", plan.install)
    return result


def _prepend(environ: dict[str, str], name: str, folder: str) -> None:
    environ[name] = os.pathsep.join(filter(None, (folder, environ.get(name, ""))))
