"""One HTML page about a class, which needs nothing else and asks for nothing; beside it a report for each student."""

from __future__ import annotations

import base64
import functools
import hashlib
import re
import statistics
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path, PurePosixPath
from typing import Any

import jinja2
import yaml
from markupsafe import Markup

from ros2lab import course
from ros2lab.classroom.a_look import Looked, reasons
from ros2lab.classroom.gradebook import Gradebook, Row
from ros2lab.classroom.handed_in import called
from ros2lab.classroom.judging import Judging, read_grade
from ros2lab.classroom.similarity import Pair, Shared, most_alike, pairs, template_texts
from ros2lab.grading.evidence import Evidence
from ros2lab.grading.evidence_json import read_evidence
from ros2lab.grading.grade import Grade
from ros2lab.grading.reports.html import html
from ros2lab.grading.reports.shown import number, title, visible
from ros2lab.grading.rubric import Criterion

REPORTS = "reports"
_DEVICE = re.compile(r"con|prn|aux|nul|clock\$|conin\$|conout\$|(?:com|lpt)[\d¹²³]", re.IGNORECASE)
BIN = 10  # points of a bar of the distribution


@dataclass(frozen=True)
class Lost:
    """What a class has lost at a criterion.

    Attributes:
        criterion: of the rubric.
        mean: points, of those who were graded.
        losers: how many have lost some of it.
        reasons: the most frequent ones, with how many have them.
        lesson: in which it is taught; empty if none is known.
    """

    criterion: Criterion
    mean: float
    losers: int
    reasons: Sequence[tuple[str, int]]
    lesson: str


def write(book: Gradebook, judging: Judging, path: Path, template: Iterable[Path]) -> Path:
    """Write the page, and the report of each student below `reports` beside it.

    Args:
        book: the gradebook.
        judging: by what the class was judged.
        path: of the page.
        template: folders or files that all students were given.

    Raises:
        OSError: if something cannot be written; what was being written is then as it was.
    """
    rows = book.rows()
    grades = {row.handed.key: read_grade(row.worth.data) for row in rows if row.worth}
    looks: dict[str, list[str]] = {}
    sources, nodes, running = (
        _sources(book, rows),
        dict[str, Mapping[str, str]](),
        dict[str, Mapping[str, str]](),
    )
    links: dict[str, str] = {}
    for row in rows:
        looks[row.handed.key] = [*_of_the_row(row)]
        if not row.worth:
            continue
        evidence = read_evidence(book.evidence(row.grading))
        grade = grades[row.handed.key]
        if code := _of_nodes(sources.get(row.handed.key, {}), evidence):
            nodes[row.handed.key], running[row.handed.key] = code, _running(code, evidence)
        looks[row.handed.key] += reasons(Looked(row, grade, evidence, judging.rubric))
        links[row.handed.key] = f"{REPORTS}/{file_name(row)}.html"
        course.write_whole(path.parent / links[row.handed.key], html(grade, evidence).encode())
    too_long = "Its code takes too long to be read, and was compared with nobody else's."
    common, shared = list[str](), list[Shared]()
    alike = pairs(
        sources,
        template_texts(template),
        lambda student: looks[student].append(too_long),
        common.append,
        shared.append,
    )
    # What nobody runs hides nothing.
    alike = most_alike(
        [*alike, *pairs(nodes, template_texts(template)), *pairs(running, template_texts(template))]
    )
    text = page(
        rows,
        grades=grades,
        looks=looks,
        links=links,
        lost=[*_lost(judging, grades.values())],
        alike=alike,
        common=common,
        shared=shared,
    )
    course.write_whole(path, text.encode())
    return path


def file_name(row: Row) -> str:
    """Return what a student's files are called: the name as far as any system takes it, and what makes it unique."""
    readable = re.sub(r"[^\w.]+", "-", row.handed.name).strip("-.")[:60]
    readable = re.sub(r"\.", "-", readable) if is_device(readable) else readable
    return (
        f"{readable or 'student'}-{hashlib.sha256(row.handed.key.encode(errors='replace')).hexdigest()[:8]}"
    )


def is_device(name: str) -> bool:
    """Return whether Windows has a device of this name, and so no file."""
    return bool(_DEVICE.fullmatch(name.partition(".")[0].rstrip(" ")))


def page(
    rows: Sequence[Row],
    *,
    grades: Mapping[str, Grade],
    looks: Mapping[str, Sequence[str]],
    links: Mapping[str, str],
    lost: Sequence[Lost],
    alike: Sequence[Pair],
    common: Sequence[str] = (),
    shared: Sequence[Shared] = (),
) -> str:
    """Return the page.

    Args:
        rows: of the gradebook.
        grades: by the key of the student.
        looks: why a row needs a human look, by the same.
        links: to the reports, by the same.
        lost: by criterion.
        alike: pairs that are alike.
        common: the keys of those of whose code too little is left to be compared, without what many have.
        shared: pieces of what many have.
    """
    script = resources.files(__package__).joinpath("class.js").read_text(encoding="utf-8")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    totals = [grade.total for grade in grades.values()]
    return (
        _environment()
        .get_template("class.html.j2")
        .render(
            rows=rows,
            grades=grades,
            looks=looks,
            links=links,
            lost=sorted(lost, key=lambda loss: -loss.mean),
            pairs=alike,
            common=common,
            shared=shared,
            names=called(row.handed for row in rows),
            script=Markup(script),  # noqa: S704 -- a file of ours
            digest=digest,
            bars=_bars(totals),
            most=max((grade.max for grade in grades.values()), default=0),
            mean=statistics.fmean(totals) if totals else None,
            median=statistics.median(totals) if totals else None,
        )
    )


def _of_the_row(row: Row) -> Iterable[str]:
    if row.state != "graded":
        yield {
            "failed": f"It was not graded, for the grader has failed: {row.reason}",
            "unreadable": f"It cannot be graded: {row.reason}",
            "waiting": "It is not graded yet.",
        }[row.state]
    yield from row.handed.notes


def _sources(book: Gradebook, rows: Iterable[Row]) -> dict[str, Mapping[str, str]]:
    """Return the sources of each student; those of one grading, as of a group, only once."""
    by_paths: dict[tuple[Path, ...], Row] = {}
    for row in rows:
        if row.grading:
            by_paths.setdefault(row.handed.paths, row)
    return {row.handed.key: book.sources(row.grading) for row in by_paths.values()}


def _of_nodes(sources: Mapping[str, str], evidence: Evidence) -> dict[str, str]:
    """Return the files of programs and of nodes."""
    programs = evidence.build.executables if evidence.build else []
    modules = {name for program in programs for name in program.modules}
    modules |= {end.module for end in evidence.files.ends}
    return {path: text for path, text in sources.items() if PurePosixPath(path).stem in modules}


def _running(sources: Mapping[str, str], evidence: Evidence) -> dict[str, str]:
    """Return files without the lines that never run."""
    idle = {path: {*evidence.files.idle.get(path, ())} for path in sources}
    lines = {path: enumerate(text.split("\n"), start=1) for path, text in sources.items()}
    return {
        path: "\n".join(line for number, line in numbered if number not in idle[path])
        for path, numbered in lines.items()
    }


def _lost(judging: Judging, grades: Iterable[Grade]) -> Iterable[Lost]:
    grades = [*grades]
    taught = lessons()
    for criterion in judging.rubric.criteria:
        judged = [graded for grade in grades for graded in grade.criteria if graded.id == criterion.id]
        losers = [graded for graded in judged if graded.points < graded.max]
        mean = sum(graded.max - graded.points for graded in losers) / len(judged) if judged else 0.0
        common = Counter(graded.reason for graded in losers).most_common(3)
        yield Lost(criterion, mean, len(losers), common, taught.get(criterion.question, ""))


@functools.cache
def lessons() -> Mapping[str, str]:
    """Return the lesson in which is taught what a question asks for, by the question's name."""
    text = resources.files(__package__).joinpath("lessons.yaml").read_text(encoding="utf-8")
    return {question: lesson for lesson, questions in yaml.safe_load(text).items() for question in questions}


def _bars(totals: Sequence[float]) -> list[tuple[str, int]]:
    """Return how many have how many points: the name of each bar, and its height."""
    highest = max([100.0, *totals])
    starts = range(0, int(highest) + 1, BIN)
    counts = Counter(min(int(total), int(highest)) // BIN for total in totals)
    return [(f"{start} to {start + BIN - 1}", counts[start // BIN]) for start in starts]


@functools.cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("ros2lab.classroom", "."),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        finalize=lambda value: value if isinstance(value, Markup) else visible(value),
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(number=number, name=title, code=_code)
    return environment


def _code(text: Any) -> str:
    """Return a line of code as it stands, with its indentation."""
    return visible(text, 200, keeps_lines=True)
