"""What a build or a test run came to, judged from what colcon did.

Nothing here runs anything: a record of colcon's run and what was printed go in, results come out.
"""

from __future__ import annotations

import contextlib
import html
import re
import signal
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, NamedTuple

from ros2lab.build_text import ends_traceback, find_warnings, first_error
from ros2lab.colcon_record import STOPPED, Job, Message, Record


@dataclass(frozen=True)
class Package:
    """A package as colcon finds it below a workspace.

    Attributes:
        name: the package's name.
        path: its folder.
        build_type: as in package.xml, such as `ament_python`; `python` if colcon sees no ROS package in it.
        problem: why its package.xml is not valid; None if it is, or if there is none.
    """

    name: str
    path: Path
    build_type: str
    problem: str | None = None


@dataclass(frozen=True)
class PackageResult:
    """How one package fared in a build.

    Attributes:
        name: the package's name.
        is_ok: whether colcon built it.
        seconds: how long it took, in s.
        warnings: what was noticed though colcon went on, one line each.
        error: why it was not built; None if it was.
    """

    name: str
    is_ok: bool
    seconds: float
    warnings: tuple[str, ...] = ()
    error: str | None = None


@dataclass(frozen=True, repr=False)
class BuildResult:
    """What a build came to.

    Attributes:
        is_ok: whether at least one package was built, and none failed.
        packages: one result for each package that was to be built, in colcon's order.
        first_error: the first real error, such as `error: can't copy 'resource/pk': ...`; None if is_ok.
        seconds: how long it took in all, in s.
        returncode: colcon's own; 0 does not mean that anything was built.
        warnings: those that belong to no package.
    """

    is_ok: bool
    packages: tuple[PackageResult, ...]
    first_error: str | None
    seconds: float
    returncode: int
    warnings: tuple[str, ...] = ()

    # Times stay out of both texts: a stored notebook is compared with a later run.
    def __repr__(self) -> str:
        return _as_text(self._summary, self.warnings, self._rows)

    def _repr_html_(self) -> str:
        return _as_html(self._summary, self.warnings, self._rows)

    @property
    def _summary(self) -> str:
        if not self.packages:
            return f"colcon build: {self.first_error}"
        built = sum(package.is_ok for package in self.packages)
        text = f"colcon build: {built} of {_counted(len(self.packages), 'package')} built"
        is_told = any(package.error == self.first_error for package in self.packages)
        return text if self.first_error is None or is_told else f"{text}. {self.first_error}"

    @property
    def _rows(self) -> list[_Row]:
        return [
            _Row(package.name, "built" if package.is_ok else "FAILED", package.error, package.warnings)
            for package in self.packages
        ]


@dataclass(frozen=True)
class PackageTests:
    """How the tests of one package fared.

    Attributes:
        name: the package's name.
        is_ok: whether tests ran and all passed.
        tests: how many ran, skipped ones included.
        skipped: how many of them were skipped.
        failed: name and reason of each that failed, one line each.
        seconds: how long they took, in s.
    """

    name: str
    is_ok: bool
    tests: int
    skipped: int
    failed: tuple[str, ...]
    seconds: float


@dataclass(frozen=True, repr=False)
class TestResult:
    """What a test run came to.

    Attributes:
        is_ok: whether tests ran in every package and all passed.
        packages: one result for each package that was tested, in colcon's order.
        first_error: the first thing that is wrong; None if is_ok.
        seconds: how long it took in all, in s.
        returncode: colcon's own; 0 does not mean that the tests passed.
    """

    __test__: ClassVar[bool] = False  # its name looks like a test's to pytest

    is_ok: bool
    packages: tuple[PackageTests, ...]
    first_error: str | None
    seconds: float
    returncode: int

    def __repr__(self) -> str:
        return _as_text(self._summary, (), self._rows)

    def _repr_html_(self) -> str:
        return _as_html(self._summary, (), self._rows)

    @property
    def _summary(self) -> str:
        if not self.packages:
            return f"colcon test: {self.first_error}"
        tests = sum(package.tests for package in self.packages)
        failed = sum(len(package.failed) for package in self.packages)
        text = f"colcon test: {_counted(tests, 'test')} run, {failed} failed"
        is_told = any(self.first_error in package.failed for package in self.packages)
        return text if self.first_error is None or is_told else f"{text}. {self.first_error}"

    @property
    def _rows(self) -> list[_Row]:
        return [
            _Row(package.name, "passed" if package.is_ok else "FAILED", "\n".join(package.failed) or None, ())
            for package in self.packages
        ]


def judge_build(
    returncode: int,
    seconds: float,
    packages: Sequence[Package],
    record: Record,
    *,
    reasons: Mapping[str, str] | None = None,
    noticed: Mapping[str, Sequence[str]] | None = None,
    last_words: Sequence[str] = (),
) -> BuildResult:
    """Judge a build.

    Args:
        returncode: colcon's; -n if signal n ended it.
        seconds: how long it took, in s.
        packages: those that colcon found below the workspace.
        record: what colcon did.
        reasons: what a package's own setup.py says, for those where colcon shows only itself.
        noticed: further warnings by package, from what was installed.
        last_words: the end of what colcon printed, for when it failed before it recorded anything.
    """
    jobs = record.jobs
    listed = {package.name: package for package in packages}
    names = [name for name, job in jobs.items() if job.is_selected]
    # What colcon does not know how to build is neither queued nor unselected.
    unknown = [name for name in listed if name not in jobs] if record.is_executing else []
    has_failed = any(job.has_failed for job in jobs.values())
    results = []
    for name in [*names, *unknown]:
        job, package = jobs.get(name), listed.get(name)
        is_ok = job is not None and job.returncode == 0
        warnings = [
            *([_invalid(package)] if package and package.problem else []),
            *(message.text for message in record.messages if _is_about(message, name)),
            *(find_warnings(job.errors) if job and is_ok else []),
            *(noticed or {}).get(name, ()),
        ]
        if is_ok:
            error = None
        elif job:
            error = (reasons or {}).get(name) or _why_not_built(job, has_failed)
        else:
            error = _unknown_type(listed[name])
        seconds_taken = job.seconds if job else 0.0
        results.append(PackageResult(name, is_ok, seconds_taken, tuple(dict.fromkeys(warnings)), error))
    is_ok = returncode == 0 and bool(results) and all(result.is_ok for result in results)
    about = [*names, *unknown]
    general = [
        _joined(message)
        for message in record.messages
        if not message.is_error
        and not message.text.startswith(_NO_TASK)
        and not any(_is_about(message, name) for name in about)
    ]
    return BuildResult(
        is_ok=is_ok,
        packages=tuple(results),
        first_error=None if is_ok else _first_of(results, record, returncode, last_words),
        seconds=seconds,
        returncode=returncode,
        warnings=tuple(dict.fromkeys(general)),
    )


def judge_package_tests(job: Job, reports: Sequence[str]) -> PackageTests:
    """Judge a package's tests.

    Args:
        job: the package's job in the test run.
        reports: the xUnit reports that the run has written; without any, unittest ran and printed.
    """
    counted, skipped, failed = 0, 0, list[str]()
    for report in reports:
        with contextlib.suppress(ValueError):
            more = read_tests(report)
            counted, skipped, failed = counted + more[0], skipped + more[1], failed + more[2]
    if not reports:
        counted, failed = read_unittest(job.errors)
    is_ok = job.returncode == 0 and counted > 0 and not failed
    return PackageTests(job.name, is_ok, counted, skipped, tuple(failed), job.seconds)


def judge_tests(
    returncode: int,
    seconds: float,
    packages: Sequence[PackageTests],
    record: Record,
    *,
    last_words: Sequence[str] = (),
) -> TestResult:
    """Judge a test run.

    Args:
        returncode: colcon's; -n if signal n ended it.
        seconds: how long it took, in s.
        packages: from `judge_package_tests`, in colcon's order.
        record: what colcon did.
        last_words: the end of what colcon printed, for when it failed before it recorded anything.
    """
    is_ok = returncode == 0 and bool(packages) and all(package.is_ok for package in packages)
    faults = [failed for package in packages for failed in package.failed]
    faults += [_joined(message) for message in record.messages if message.is_error]
    faults += _killed(returncode)
    for package in packages:
        if not package.is_ok and not package.failed:
            faults.append(f"{package.name}: {_why_untested(package, record.jobs[package.name])}")
    faults.append(_why_nothing("tested", record, returncode, last_words))
    return TestResult(is_ok, tuple(packages), None if is_ok else faults[0], seconds, returncode)


def read_tests(report: str) -> tuple[int, int, list[str]]:
    """Read an xUnit report: how many tests, how many of them skipped, and each that failed.

    Raises:
        ValueError: if the text is no xUnit report.
    """
    try:
        root = ET.fromstring(report)  # noqa: S314 -- written by pytest on this machine
    except ET.ParseError as error:
        raise ValueError(f"not XML: {error}") from error
    if root.tag not in ("testsuites", "testsuite"):
        raise ValueError(f"the outermost tag is {root.tag}")
    tests, skipped, failed = 0, 0, []
    for case in root.iter("testcase"):
        tests += 1
        skipped += case.find("skipped") is not None
        fault = case.find("failure") if case.find("failure") is not None else case.find("error")
        if fault is not None:
            lines = (fault.get("message") or fault.text or "failed").strip().splitlines()
            failed.append(f"{case.get('name')}: {lines[0]}")
    return tests, skipped, failed


def read_unittest(lines: Sequence[str]) -> tuple[int, list[str]]:
    """Read what Python's unittest wrote to standard error: how many tests ran, and each that failed."""
    counts = [int(match[1]) for line in lines if (match := _RAN.match(line))]
    failed = []
    for number, line in enumerate(lines):
        fault = _UNITTEST_FAULT.match(line)
        if fault:
            ends = (n for n in range(number + 2, len(lines)) if ends_traceback(lines, n))
            reason = next((lines[n].strip() for n in ends), "failed")
            failed.append(f"{fault[1]}: {reason}")
    return sum(counts), failed


_RAN = re.compile(r"Ran (\d+) tests? in ")
_UNITTEST_FAULT = re.compile(r"(?:FAIL|ERROR): (.+)")
_NO_TASK = "No task extension to"


class _Row(NamedTuple):
    """What is shown of one package."""

    name: str
    verdict: str
    error: str | None
    warnings: tuple[str, ...]


def _why_not_built(job: Job, has_any_failed: bool) -> str:
    """Say why a package was not built, knowing whether any has failed by itself."""
    if job.has_failed:
        return first_error(job.errors) or f"its build ended with code {job.returncode} and said nothing"
    if job.started is None:
        return f"colcon did not begin it because {'another package failed' if has_any_failed else 'it was stopped'}"
    if job.returncode is None or not has_any_failed:
        return "colcon was stopped while it built it"
    return "colcon stopped it because another package failed"


def _why_untested(package: PackageTests, job: Job) -> str:
    if job.returncode in (None, STOPPED):
        return "colcon was stopped before its tests had ended"
    has_run = job.returncode == 0 or any(_RAN.match(line) for line in job.errors)
    if package.tests == 0 and has_run:
        return (
            "no test ran; colcon runs pytest for a package whose setup.py says "
            "extras_require={'test': ['pytest']}"
        )
    return first_error(job.errors) or f"its tests ended with code {job.returncode} and said nothing"


def _unknown_type(package: Package) -> str:
    return (
        f"colcon knows no build type {package.build_type!r}; "
        f"write <build_type>ament_python</build_type> in {package.path.name}/package.xml"
    )


def _first_of(
    results: Sequence[PackageResult], record: Record, returncode: int, last_words: Sequence[str]
) -> str:
    """Return the error of the package that failed first, or else what colcon itself says."""
    errors = {result.name: result.error for result in results if result.error}
    failed = sorted((job for job in record.jobs.values() if job.has_failed), key=lambda job: job.ended or 0.0)
    candidates = [
        *(errors[job.name] for job in failed),
        *(_joined(message) for message in record.messages if message.is_error),
        *_killed(returncode),
        *errors.values(),
        _why_nothing("built", record, returncode, last_words),
    ]
    return candidates[0]


def _killed(returncode: int) -> list[str]:
    """Say that a signal ended colcon, if one did."""
    return [f"colcon was ended by {signal.Signals(-returncode).name}"] if returncode < 0 else []


def _why_nothing(what: str, record: Record, returncode: int, last_words: Sequence[str]) -> str:
    """Say why colcon has worked on no package."""
    if returncode:
        return first_error(last_words) or f"colcon ended with code {returncode} and said nothing"
    if record.packages is None:
        return f"it is unknown what was {what}: colcon left no record of it"
    return f"nothing was {what}: {'no package was chosen' if record.packages else 'colcon finds no package'}"


def _joined(message: Message) -> str:
    """Return a message as one line; of a traceback only what is above it."""
    text = message.text.partition("\nTraceback")[0].removeprefix("colcon build: ")
    return " ".join(line.strip(" -") for line in text.splitlines())


def _is_about(message: Message, name: str) -> bool:
    return not message.is_error and f"ackage '{name}'" in message.text


def _invalid(package: Package) -> str:
    return f"package.xml is not valid, so that colcon takes it for a plain Python package: {package.problem}"


def _counted(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def _as_text(summary: str, warnings: Sequence[str], rows: Sequence[_Row]) -> str:
    width = max((len(row.name) for row in rows), default=0)
    lines = [summary, *(f"  warning: {warning}" for warning in warnings)]
    for row in rows:
        lines.append(f"  {row.name:<{width}}  {row.verdict}")
        details = [*(row.error or "").splitlines(), *(f"warning: {warning}" for warning in row.warnings)]
        lines += [f"  {'':<{width}}  {detail}" for detail in details]
    return "\n".join(lines)


def _as_html(summary: str, warnings: Sequence[str], rows: Sequence[_Row]) -> str:
    def cell(lines: Sequence[str]) -> str:
        return "<br>".join(html.escape(line) for line in lines)

    body = "".join(
        f'<tr><th scope="row" style="text-align:left">{cell([row.name])}</th><td>{row.verdict}</td>'
        f'<td style="text-align:left">'
        f"{cell([*(row.error or '').splitlines(), *(f'warning: {text}' for text in row.warnings)])}</td></tr>"
        for row in rows
    )
    head = cell([summary, *(f"warning: {warning}" for warning in warnings)])
    return f"<p>{head}</p><table>{body}</table>"
