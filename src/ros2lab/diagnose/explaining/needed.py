"""Selects the findings of a workspace that matter for the commands of a terminal."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.explaining.sections_read import sections_read
from ros2lab.diagnose.finding import SAID, Finding, is_about_life
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText, own_frames
from ros2lab.diagnose.printed.spots import place_of, spot_at, spot_of, statement_around
from ros2lab.diagnose.sources.package import SourcePackage

_NAME = re.compile(r"[A-Za-z_]\w{2,}")
_QUOTED = re.compile(r"`([^`(]{3,})(?:\(.*?)?`")  # code in a sentence, up to the arguments of a call
_BUILDS_ALL = re.compile(r"\bcolcon build\b(?!.*--packages-(?:select|up-to|start|end|ignore|skip))")


def of_needed(findings: Sequence[Finding], error: ErrorText, look: Look) -> list[Finding]:
    """Drop findings about unbuilt packages that no command needs or whose build is shown, and about files that were read all the same.

    A launch file that is started by its path need not be installed. If no command names a package of the workspace, or one builds them all, every package is needed.
    """
    _, served = sections_read(error, look)
    by_path = {word.rpartition("/")[2] for line in error.typed for word in line.split() if "/" in word}
    failed = re.findall(r"^Failed +<<< ([\w.-]+)", error.text, re.MULTILINE)
    tried = {package.shown("") for package in look.packages if package.name in failed}
    findings = [
        finding
        for finding in findings
        if not (finding.code == "not-built" and finding.place in tried)  # the text says why
        if not (finding.code == "parameter-file-node" and finding.place.partition(":")[0] in served)
        if not (finding.code == "not-in-data-files" and by_path.intersection(finding.about))
    ]
    by_name = {package.name: package for package in look.packages}
    said = error.decisive if error.is_clear else ""
    words = {word for line in (*error.typed, said) for word in re.findall(r"[\w-]+", line)}
    needed = words & by_name.keys()
    if not needed or any(map(_BUILDS_ALL.search, error.typed)):
        return findings
    new = set(needed)
    while new:
        new = {name for user in new for name in uses(by_name[user], look)} & by_name.keys() - needed
        needed |= new
    passed_over = {by_name[name].shown("") for name in by_name.keys() - needed}
    return [
        finding for finding in findings if finding.code != "not-built" or finding.place not in passed_over
    ]


def uses(package: SourcePackage, look: Look) -> Iterator[str]:
    """Yield the names of what a package depends on, imports, or starts in its launch files."""
    if package.manifest is not None:
        for kind in ("build_depends", "exec_depends", "buildtool_depends"):
            yield from (dependency.name for dependency in getattr(package.manifest, kind))
    for source in package.sources.values():
        yield from (imported.target.partition(".")[0] for imported in source.imports)
    own = {package.shown(str(path.relative_to(package.folder))) for path in package.launch_files}
    for file in look.launch_files:
        if file.shown in own:
            yield from (str(node.package) for node in file.nodes)


def is_refuted(finding: Finding, error: ErrorText, look: Look) -> bool:
    """Return whether a line that stopped by another error had all its names: one that lacks a name stops by that."""
    report = error.report
    if (
        finding.code != "name-undefined"
        or report is None
        or report.kind in ("NameError", "UnboundLocalError")
    ):
        return False
    return finding.place == place_of(own_frames(report.frames), look)


def seen_there(said: Finding, error: ErrorText, known: Sequence[Finding], look: Look) -> list[Finding]:
    """Return what is known of the line or file of a message that is only passed on, if both name the same thing there.

    A function in C that is called at a wrong time, or from a wrong place, seldom says so in its message.
    """
    if said.code != SAID or not said.place:
        return []
    message = error.report.message if error.report else said.cause
    names = {*_NAME.findall(message)} & {*_NAME.findall(spot_at(said.place, look).text)} - {*keyword.kwlist}
    about = [finding for finding in known if names & {*_NAME.findall(finding.cause)}]
    lines = statement_around(said.place, look)
    seen = {(f.code, f.place.partition(":")[0]) for f in about if f.place in lines}
    failed = (spot := spot_of(error.report, look)).part or spot.text
    here = (
        f for f in known if is_about_life(f) and f.place.partition(":")[0] == said.place.partition(":")[0]
    )
    early = [f for f in here if any(code in failed for code in _QUOTED.findall(f.cause))]
    return [f for f in about if (f.code, f.place.partition(":")[0]) in seen] or early
