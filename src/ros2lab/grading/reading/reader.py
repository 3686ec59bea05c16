"""Read a submission's files: the program of a box, which `reading` starts.

Whatever the files hold, reading them takes no more than the box may use and does no harm. Nothing of a
submission is run or imported. Each answer is a line of JSON, so that what was read before a limit is not
lost.
"""

from __future__ import annotations

import errno
import json
import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from ros2lab.assignments import Assignment
from ros2lab.diagnose import of_text
from ros2lab.grading.evidence_json import plain, restored, typed
from ros2lab.grading.reading import files
from ros2lab.grading.reading.build_plan import WORKSPACE, Plan, plan_for, plan_for_files
from ros2lab.grading.reading.diagnosed import diagnosed, in_evidence, of_evidence
from ros2lab.grading.reading.unread import FACT, told
from ros2lab.grading.receiving.submission import Received, Submission, found_in
from ros2lab.grading.sandbox.worlds import FILES

Answers = Iterator[tuple[str, Any]]


def look(root: Path, asked: Mapping[str, Any]) -> Answers:
    """Yield what a submission contains, its build plan, and the facts of its files; lay out the workspace."""
    assignment = Assignment.of_plain(asked["assignment"])
    submission = found_in(root, typed(asked["received"], Received, "received"), assignment)
    yield "submission", submission
    plan = (
        plan_for(root, submission, submission.package, asked["prefixes"])
        if submission.package
        else plan_for_files(root, submission)
    )
    yield "plan", plan
    facts = files.look(root, submission, assignment, _tell)
    yield "files", replace(facts, notes=[*facts.notes, *told(plan.unread)])
    plan.lay_out(root)


def _tell(name: str, value: Any) -> None:
    _say(f"{FACT}{name}", plain(value, name))


def lay_out(root: Path, asked: Mapping[str, Any]) -> Answers:
    """Lay out a plan's workspace; yield nothing."""
    typed(asked["plan"], Plan, "plan").lay_out(root)
    yield from ()


def said(root: Path, asked: Mapping[str, Any]) -> Answers:
    """Yield all findings, those about the errors of a build and of programs first, and the ends that are meant by them."""
    submission = typed(asked["submission"], Submission, "submission")
    folder = submission.package.folder if submission.package else ""
    texts = [as_written(text, root, folder) for text in asked["texts"]]
    found = diagnosed(lambda: [told for text in texts for told in of_text(text, root, loads=False)])
    every = [*found, *of_evidence(asked["findings"])]
    yield "findings", in_evidence(every)
    if found and submission.package:
        assignment = Assignment.of_plain(asked["assignment"])
        yield "ends_meant", files.ends_meant(root, submission, assignment, every)


def as_written(text: str, root: Path, folder: str) -> str:
    """Return a program's output, with installed files replaced by those that were handed in.

    Args:
        text: the output.
        root: the folder with the submission as received.
        folder: the package's folder below the root.
    """

    def written(match: re.Match[str]) -> str:
        places = (root / folder / below / match[1] for below in ("", "src"))
        return next((str(path) for path in places if path.is_file()), match[0])

    return re.sub(rf"{FILES}/{WORKSPACE}_*/install/.+?/(?:site|dist)-packages/([^\"\n]+)", written, text)


QUESTIONS: Mapping[str, Callable[[Path, Mapping[str, Any]], Answers]] = {
    "look": look,
    "lay out": lay_out,
    "said": said,
}


def main() -> None:
    """Answer the question in `argv` about the folder in `argv`; standard input has the rest, as JSON."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # Python's warnings quote the sources
    question, root = sys.argv[1:]
    try:
        asked = json.load(sys.stdin, object_hook=restored)
        for name, value in QUESTIONS[question](Path(root), asked):
            _say(name, plain(value, name))
    except Exception as error:
        # A file may mention a name that is too long for any file: that is only noticed when it is looked up.
        is_too_long = isinstance(error, OSError) and error.errno == errno.ENAMETOOLONG
        if is_too_long or isinstance(error, MemoryError | RecursionError):
            _say("gave up", "a name is too long" if is_too_long else type(error).__name__)
            return
        place = error.__traceback__
        while place and place.tb_next:
            place = place.tb_next
        file = Path(place.tb_frame.f_code.co_filename).name if place else ""
        line = place.tb_lineno if place else 0
        _say("failed", f"{type(error).__name__}: {error} ({file}, line {line})")


def _say(name: str, value: Any) -> None:
    sys.stdout.write(json.dumps([name, value], allow_nan=False) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
    os._exit(0)  # all has been written, and to take apart what was read takes a twentieth of the time
