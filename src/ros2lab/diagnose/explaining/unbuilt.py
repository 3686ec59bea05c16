"""Says why a package of the workspace is not built, or not since a file of it was changed."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from pathlib import Path

from ros2lab.diagnose.explaining.commands import corrected
from ros2lab.diagnose.explaining.needed import uses
from ros2lab.diagnose.finding import Finding, at, stops_build
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.packaging.build_order import BuildOrder
from ros2lab.diagnose.packaging.installed import changed_sources, prefix_of
from ros2lab.diagnose.packaging.manifest_faults import mentions
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.spots import place_of, spot_at
from ros2lab.diagnose.printed.transcript import Step
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, read_text

_COLCON = re.compile(r"(?:^|[;&|] *)colcon\b")
_BUILD = re.compile(r"\bcolcon build\b")
_FAILED = re.compile(
    r"^(?:Failed +<<< |usage: colcon|colcon(?: [\w-]+)?: error: |(?:\[[\d.]+s\] )?ERROR:colcon)|^\S*(?:: \S+)*: (?:colcon: )?command not found|^Summary: .*\n.*packages? failed",
    re.M,
)
# What is not found afterwards because a build has failed.
_CONSEQUENCE = re.compile(
    r"[Pp]ackage '[^']+' not found|No executable found|was not found in the share directory|install/(?:local_)?setup\.\w*sh'?: No such file|no such file or directory: \S*install/"
)
_SELECTED = re.compile(r"--packages-select((?: +[\w.-]+)+)")
_UP_TO = re.compile(r"--packages-up-to((?: +[\w.-]+)+)")


def failed_build(steps: Sequence[Step]) -> str:
    """Return what was printed up to a failed build if all that failed after it follows from it; else empty."""
    builds = [number for number, step in enumerate(steps) if _COLCON.search(step.command)]
    last = builds[-1] if builds else -1
    if last < 0 or not _FAILED.search(steps[last].text):
        return ""
    after = [step for step in steps[last + 1 :] if any(line.strip() for line in step.lines)]
    said = [line for step in after for line in step.lines if line.strip()]
    if not after or not all(_CONSEQUENCE.search(line) for line in said):
        return ""
    shown = [f"$ {step.command}\n{step.text}" if step.command else step.text for step in steps[: last + 1]]
    return "\n".join(shown)


def not_yet_built(package: SourcePackage, look: Look, error: ErrorText) -> Finding:
    """Say why a package in src is not built, judging by the last build that was typed."""
    name = package.name
    typed = next((line for line in reversed(error.typed) if _BUILD.search(line)), "")
    place = package.shown("")
    if typed and (better := corrected(typed, look)):
        return Finding("typed-wrong", better.why, "", f"type `{better.line}`, then source install/setup.bash")
    asked = {
        word for pattern in (_SELECTED, _UP_TO) for match in pattern.findall(typed) for word in match.split()
    }
    built = (user for user in look.packages if user.name in asked)
    users = [user for user in built if name in uses(user, look) or mentions(user, name)]
    for user in users if name not in asked else ():
        if name not in _declared(user) and not BuildOrder(look.packages).reaches(name, user.name):
            cause = f"{user.name} uses {name}, but its package.xml does not declare it, so colcon does not build {name} with it."
            again = typed if _UP_TO.search(typed) else _up_to(typed, [user.name])
            fix = f"add <exec_depend>{name}</exec_depend> to {user.shown('package.xml')}, then {again}, and source install/setup.bash"
            return Finding("dependency-undeclared", cause, user.shown("package.xml"), fix, (name,))
        if _SELECTED.search(typed):
            cause = f"{user.name} needs {name}, and --packages-select builds only the packages that it names."
            fix = f"{_up_to(typed, [user.name])}, then source install/setup.bash"
            return Finding("not-built", cause, place, fix, (name,))
    cause = f"The package {name} is in src but has not been built."
    fix = f"colcon build --packages-select {name}, then source install/setup.bash"
    return Finding("not-built", cause, place, fix)


def of_refused_files(error: ErrorText, look: Look) -> Finding | None:
    """Say which assertion of colcon the data_files of a package do not pass; None for any other error."""
    frame = error.report.frames[-1] if error.report and error.report.frames else None
    if frame is None or not frame.file.endswith("colcon_core/task/python/__init__.py"):
        return None
    failed = re.findall(r"^(?:Failed +<<<|--- stderr:) ([\w.-]+)", error.text, re.M)
    home = next((package for package in look.packages if package.name in failed), None)
    fix = next((right for asserted, right in _ASSERTED.items() if asserted in frame.text), "")
    if home is None or home.setup is None or not fix:
        return None
    shown = home.setup.source.shown
    stops = (one for one in look.findings if stops_build(one) and one.place.startswith(shown))
    place = at(shown, home.setup.line("data_files"))
    cause = f"colcon refuses data_files in setup.py: `{frame.text}` does not hold."
    return next(stops, None) or Finding("setup-value", cause, place, fix, ("data_files",))


# What colcon asserts of each entry, and what to write where that does not hold.
_ASSERTED = {
    "isabs(dest)": "write each folder as in os.path.join('share', package_name), with no slash, sys.prefix or home folder before it",
    "isabs(": "give each file by its path from the folder of setup.py, as in glob('launch/*.py'), without os.path.abspath or a folder before it",
    "isinstance(sources": "write [ and ] around the files of each folder, or list(...)",
    "len(": "write each entry as (folder, [files])",
}


def no_prerequisite(error: ErrorText, look: Look) -> Finding | None:
    """Say why colcon lacks what another package should have installed; None if it does not say that."""
    listed = re.search(r"packages have been built:\n((?:- .+\n?)+)", error.text)
    names = re.findall(r"- +([\w.-]+)", listed[1]) if listed else []
    if not names:
        return None
    failed = re.findall(r"Failed +<<< ([\w.-]+)", error.text)
    user, missing = failed[0] if failed else "The package", " and ".join(names)
    by_name = {package.name: package for package in look.packages}
    if not by_name.keys() >= {*names}:
        cause = f"{user} needs {missing}, which is neither in this workspace nor in one that this terminal has sourced."
        fix = f"source the install/setup.bash of the workspace in which {missing} is built, and build again"
        return Finding("not-built", cause, "", fix, (*names,))
    homes = tuple(by_name[name].shown("-").removesuffix("-") for name in names)
    stops = (found for found in look.findings if found.place.startswith(homes) and stops_build(found))
    return next(stops, None) or _left_out(user, failed, [by_name[name] for name in names], error, look)


def of_earlier(error: ErrorText, look: Look) -> Finding | None:
    """Say that an error comes from an installed copy of a file that has changed; None if it does not.

    It is the file of a frame, or one that this imports and that by now defines what the error is about.
    """
    frames = {place_of([frame], look): frame for frame in error.own if look}
    stale = [finding.about for finding in look.findings if finding.code == "install-stale"] if frames else []
    pairs = (
        (package, source, copy)
        for package in look.packages
        if stale and (prefix := prefix_of(look.root, package.name))
        for source, copy in changed_sources(prefix, package)
        if any(Path(source.shown).name in names for names in stale)
    )
    message = error.report.message if error.report else ""
    for (package, source, copy), (place, frame) in itertools.product(pairs, frames.items()):
        cause = f"{source.shown} has changed since the last build, and the error comes from the older build."
        fix = f"colcon build --packages-select {package.name}, then run the same command again"
        if source.shown == place.rpartition(":")[0] and "/install/" in frame.file:
            if frame.text and frame.text not in map(str.strip, source.text.splitlines()):
                cause = f"{cause.rstrip('.')}: `{frame.text}` is no longer in it."
            return Finding("install-stale", cause, place, fix)
        if _defines_now(source, copy, spot_at(place, look).file, message):
            return Finding("install-stale", cause, source.shown, fix)
    return None


def _defines_now(source: PythonSource, copy: Path, user: PythonSource, said: str) -> bool:
    """Return whether a file that another one imports defines what an error there is about, and its older copy does not."""
    home, old = f"{source.name}.", read_text(copy).splitlines()
    targets = [f"{imported.target}." for imported in user.imports]
    if not any(home.startswith(target) or target.startswith(home) for target in targets):
        return False
    new = "\n".join(line for line in source.text.splitlines() if line not in old)
    if called := re.findall(r"(\w+)\(\)", said):
        return any(re.search(rf"\bdef {name}\(", new) for name in called)
    names = {name.rpartition(".")[2] for name in re.findall(r"'([\w.]+)'", said) if name != source.name}
    made = [
        re.compile(rf"(?:def|class|import .*) \b{name}\b|^ *(?:self\.)?{name}\b[^=(]*=[^=]", re.M)
        for name in names
    ]
    return all(one.search(source.text) for one in made) and any(one.search(new) for one in made)


def _left_out(
    user: str, failed: Sequence[str], missing: Sequence[SourcePackage], error: ErrorText, look: Look
) -> Finding:
    """Say that a build left out packages that another one needs, and how to build them with it."""
    builds = [step for step in error.steps if "packages have been built:" in step.text]
    typed = builds[-1].command if builds else ""
    names = [package.name for package in missing]
    selected = [word for match in _SELECTED.findall(typed) for word in match.split()]
    is_gone = any(prefix_of(look.root, name) is None for name in names)
    if selected:
        why = "--packages-select builds only the packages that it names"
    elif is_gone and "--packages-skip" not in typed:
        why = f"{' and '.join(names)} is not in install"
    else:
        why = "this build leaves it out"
    cause = f"{user} needs {' and '.join(names)}, and {why}."
    fix = _up_to(typed, selected or failed or names)
    return Finding("not-built", cause, missing[0].shown(""), fix, (*names,))


def _declared(package: SourcePackage) -> set[str]:
    kinds = ("buildtool_depends", "build_depends", "build_export_depends", "exec_depends")
    return {tag.name for kind in kinds for tag in getattr(package.manifest, kind, ())}


def _up_to(typed: str, names: Sequence[str]) -> str:
    """Return the command that builds packages with all that they need, with the other options as typed."""
    kept = re.sub(r" +--packages-\S+(?: +[\w.-]+)*", "", typed) if _BUILD.search(typed) else "colcon build"
    return f"{kept} --packages-up-to {' '.join(names)}"
