"""nbgrader's autograde, with the grader instead of a kernel: nothing that was handed in runs outside of its sandbox.

A course asks for it in its nbgrader_config.py:

    from ros2lab.classroom.autograde import configure

    configure(get_config())
"""

from __future__ import annotations

import os
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from nbconvert.filters.markdown_mistune import InvalidNotebook, IPythonRenderer, MarkdownWithMath
from nbconvert.preprocessors.sanitize import SanitizeHTML
from nbgrader.api import Gradebook, MissingEntry
from nbgrader.preprocessors import AssignLatePenalties, NbGraderPreprocessor
from traitlets import Unicode

from ros2lab import edition, environment
from ros2lab.classroom.discovery import project_in
from ros2lab.classroom.exports import GRADE_CELL, NOTEBOOK
from ros2lab.classroom.handed_in import ClassError
from ros2lab.classroom.judging import Judging
from ros2lab.classroom.one import graded_apart
from ros2lab.grading.evidence_json import read_evidence
from ros2lab.grading.grade import Grade, Judgement
from ros2lab.grading.reports.markdown import prose
from ros2lab.grading.reports.shown import number


def configure(config: Any, assignment: str = "", rubric: str = "") -> None:
    """Set what a course of this lab needs of nbgrader.

    Args:
        config: as `get_config()` returns it.
        assignment: the folder of an assignment of your own; the course's if it is empty.
        rubric: a rubric of your own; the assignment's if it is empty.
    """
    os.environ["PATH"] = environment.lab_environment()["PATH"]  # nbgrader runs alembic
    config.ClearSolutions.code_stub = {"python": edition.STUB}
    config.ClearSolutions.enforce_metadata = False
    config.Autograde.autograde_preprocessors = [AskTheGrader, AssignLatePenalties]
    config.AskTheGrader.assignment = assignment
    config.AskTheGrader.rubric = rubric


class AskTheGrader(NbGraderPreprocessor):
    """Give a submission its points: each criterion of the rubric is a grade cell.

    The points go into nbgrader's database whatever has become of the cells, or of their notebook; a point that was
    given by hand stays. Beside its points, each cell says why.
    """

    assignment = Unicode("", help="The folder of an assignment of your own.").tag(config=True)
    rubric = Unicode("", help="A rubric of your own.").tag(config=True)

    def preprocess(self, notebook: Any, resources: Any) -> tuple[Any, Any]:
        """Grade once for all notebooks of a submission, and take out of each what a page would run.

        Raises:
            CannotGrade: if this machine cannot grade.
            GradingFailed: if the grader itself has failed.
            ClassError: if the course was released with another rubric.
        """
        # Formgrader and feedback show what was handed in as a page that may do what its reader may.
        notebook.metadata.pop("widgets", None)
        notebook, resources = SanitizeHTML(enabled=True).preprocess(notebook, resources)
        for cell in notebook.cells:
            disarm(cell)
        converter = self.parent.parent  # of the exporter, which is the parent of each preprocessor
        names = [Path(path).stem for path in converter.notebooks]
        about = resources["nbgrader"]
        if about["notebook"] == (NOTEBOOK if NOTEBOOK in names else names[0]):
            directory = converter.coursedir.submitted_directory
            handed_in = converter.coursedir.format_path(directory, about["student"], about["assignment"])
            grade = self._grade(Path(handed_in), about["student"])
            _give(grade, about)
            judged = {criterion.id.translate(GRADE_CELL): criterion for criterion in grade.criteria}
            for cell in notebook.cells:
                criterion = judged.get(cell.metadata.get("nbgrader", {}).get("grade_id"))
                if criterion is not None and cell.cell_type == "code":
                    cell.outputs = [_shown(criterion)]
        return notebook, resources

    def _grade(self, folder: Path, student: str) -> Grade:
        own, rubric = (Path(path) if path else None for path in (self.assignment, self.rubric))
        seen = graded_apart([project_in(folder)], own, lambda step: self.log.info("%s: %s", student, step))
        return Judging.of(own, rubric, {}).grade(read_evidence(seen.evidence), student, student)


def _give(grade: Grade, about: Any) -> None:
    """Write the points into nbgrader's database."""
    with Gradebook(about["db_url"]) as book:
        for criterion in grade.criteria:
            try:
                given = book.find_grade(
                    criterion.id.translate(GRADE_CELL), NOTEBOOK, about["assignment"], about["student"]
                )
            except MissingEntry:
                raise ClassError(
                    f"nbgrader has no cell for {criterion.id}, so the rubric has changed since the release; put the "
                    f"{NOTEBOOK}.ipynb of a new `ros2lab course release` into its source, and generate it again."
                ) from None
            given.auto_score = criterion.points
            given.needs_manual_grade = given.manual_score is not None
        book.db.commit()


def _shown(criterion: Judgement) -> Any:
    """Return the points of a criterion as the result of its cell."""
    from nbformat import v4  # noqa: PLC0415

    said = f"{number(criterion.points)} of {number(criterion.max)}: {prose(criterion.reason)}"
    hint = f"\n\n{prose(criterion.hint)}" if criterion.hint else ""
    data = {"text/plain": number(criterion.points), "text/markdown": said + hint}
    return v4.new_output("execute_result", data, execution_count=None)


HARMLESS = frozenset(("", "http", "https", "mailto", "attachment"))
PICTURES = frozenset(("image/png", "image/jpeg", "image/gif"))
_LEADS_ON = re.compile(r"\\href\b")  # the one command by which MathJax makes a link
_PICTURE = re.compile(r"data:image/(png|jpeg|gif);base64,")
_BASE64 = re.compile(r"[A-Za-z0-9+/=\s]*")
_FENCE = re.compile("`+")


def disarm(cell: Any) -> None:
    """Show a cell of Markdown as text if a link of it leads to something else than a page; keep only its pictures."""
    if cell.cell_type != "markdown":
        return
    attachments = cell.get("attachments", {})
    for name, kinds in [*attachments.items()]:
        if not all(kind in PICTURES and _BASE64.fullmatch(str(data)) for kind, data in kinds.items()):
            del attachments[name]
    if _leads_elsewhere(cell.source, attachments):
        fence = "`" * (max(map(len, _FENCE.findall(cell.source)), default=2) + 3)
        cell.source = f"{fence}text\n{cell.source}\n{fence}"


def _leads_elsewhere(source: str, attachments: Any) -> bool:
    renderer = IPythonRenderer(escape=False, attachments=attachments)
    try:
        page = MarkdownWithMath(renderer=renderer).render(source)
    except InvalidNotebook:  # a picture is not there, and nbconvert would make no page of the notebook
        return True
    links = _Links()
    links.feed(page)
    links.close()
    return bool(_LEADS_ON.search(links.text)) or not links.schemes <= HARMLESS


class _Links(HTMLParser):
    """The schemes of what a page leads to or loads, and its text, of which MathJax makes formulas."""

    def __init__(self) -> None:
        super().__init__()
        self.schemes: set[str] = set()
        self.text = ""

    def handle_data(self, data: str) -> None:
        self.text += data

    def handle_starttag(self, _tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("href", "src") and not _PICTURE.match(value or ""):
                try:
                    self.schemes.add(urlsplit((value or "").strip()).scheme)
                except ValueError:  # no address at all
                    self.schemes.add("?")
