"""What `diagnose` finds in a submission's files, and its form in the evidence."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from ros2lab.diagnose import net
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.rules import text_faults
from ros2lab.grading.reading.graded_package import Package, has_code
from ros2lab.grading.receiving.submission import Submission

MOST_FINDINGS = 50


def diagnosed(find: Callable[[], Iterable[Finding]]) -> list[Finding]:
    """Return the first findings, without what could not be judged: it costs nothing."""
    try:
        return [finding for finding in find() if not isinstance(finding, net.Unjudged)][:MOST_FINDINGS]
    except RecursionError:
        return []


def in_evidence(findings: Iterable[Finding]) -> list[list[str]]:
    """Return findings in the form of the evidence."""
    return [[finding.code, finding.cause, finding.place, finding.fix, *finding.about] for finding in findings]


def of_evidence(told: Iterable[Sequence[str]]) -> list[Finding]:
    """Return findings that have the form of the evidence."""
    return [Finding(code, cause, place, fix, tuple(about)) for code, cause, place, fix, *about in told]


def findings_of(root: Path, submission: Submission, graded: Sequence[Package]) -> list[Finding]:
    """Return what `diagnose` finds in the files of the graded packages, the assignment's first."""
    look = Look(graded[0].folder)
    look.packages = [
        *graded,
        *(Package(root / found.folder, root) for found in submission.packages if found.name),
    ]
    look.packages = list({package.folder: package for package in reversed(look.packages)}.values())[::-1]
    # A prefix is empty for a package that was handed in alone.
    prefixes = tuple(package.shown("setup.py").removesuffix("setup.py") for package in graded)
    # Files that setup.py does not lead to.
    strays = [
        source
        for package in graded
        if not any(map(has_code, package.sources.values()))
        for source in package.own_sources
    ]
    return diagnosed(
        lambda: [
            *(
                finding
                for finding in look.findings
                if not finding.place or finding.place.startswith(prefixes)
            ),
            *(finding for source in strays for finding in text_faults(source)),
        ]
    )
