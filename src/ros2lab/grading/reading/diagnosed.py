"""What `diagnose` finds in a submission's files, and its form in the evidence."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from difflib import SequenceMatcher
from pathlib import Path

from ros2lab.diagnose import net
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.rules import text_faults
from ros2lab.diagnose.sources.python_source import PythonSource
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


LIKE = 0.7  # how similar what is to be written is to what stands there, at least
_WRITE = re.compile(
    r"write `?(?P<new>.+?)`?(?: instead of `?(?P<old>.+?)`?)?(?:, (?:or (?:define|import)|with) .*)?"
)


def all_corrected(sources: Sequence[PythonSource], findings: Iterable[Finding]) -> list[PythonSource]:
    """Return the sources with slips of typing corrected as some findings say; empty if there are none."""
    findings = [*findings]
    found = [corrected(source, findings) for source in sources]
    return found if found != [*sources] else []


def corrected(source: PythonSource, findings: Iterable[Finding]) -> PythonSource:
    """Return a file with the fixes of the findings about its lines; itself if none of them is a slip of typing.

    A slip is one of names, dots and commas, or a name of another API: a fix that brings another text or number changes what
    is meant.

    Args:
        source: a file that Python can read.
        findings: what `diagnose` found in it.
    """
    text = source.text
    for finding in findings:
        file, _, line = finding.place.rpartition(":")
        told = _WRITE.fullmatch(finding.fix)
        if file == source.shown and line.isdigit() and told:
            text = _written(text, int(line), told["new"], told["old"]) or text
    return source if text == source.text else replace(source, text=text)


def _written(text: str, line: int, new: str, said: str | None) -> str:
    """Return a text with other code in place of what is `said`, or nearly the same, on a line; empty if nothing is."""
    try:
        wanted, tree = ast.parse(new), ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ""
    lines = text.split("\n")
    row, best = lines[line - 1].encode(), (LIKE, 0, 0)
    for node in ast.walk(tree):
        if (
            isinstance(node, ast.expr | ast.ImportFrom | ast.Import | ast.Assign)
            and node.lineno == node.end_lineno == line
        ):
            begin, end = node.col_offset, node.end_col_offset or 0
            old = row[begin:end].decode()
            if old != new and _constants(wanted) <= _constants(node):
                like = (
                    SequenceMatcher(None, old, new).ratio()
                    if said is None
                    else float(ast.unparse(node) == said)
                )
                best = max(best, (like, begin, end))
    _, begin, end = best
    lines[line - 1] = (row[:begin] + new.encode() + row[end:]).decode()
    mended = "\n".join(lines)
    try:
        ast.parse(mended)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ""
    return mended if end else ""


def _constants(tree: ast.AST) -> set[str]:
    return {repr(node.value) for node in ast.walk(tree) if isinstance(node, ast.Constant)}
