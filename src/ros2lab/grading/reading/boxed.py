"""Have a submission's files read in a box, within limits; `reader` is the program that runs in it."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from ros2lab.assignments import Assignment
from ros2lab.diagnose import net
from ros2lab.grading.evidence import Files, WrittenEnd
from ros2lab.grading.evidence_json import plain, restored, typed
from ros2lab.grading.reading.build_plan import Plan
from ros2lab.grading.reading.unread import FACT
from ros2lab.grading.receiving.clean_copy import HAND_IN, SubmissionError
from ros2lab.grading.receiving.submission import Received, Submission
from ros2lab.grading.sandbox.box import Limits
from ros2lab.grading.sandbox.bubblewrap import PACKAGE
from ros2lab.grading.sandbox.worlds import FILES, World, underlay

# A submission written by hand takes half a second of CPU time and 80 MB.
LIMITS = Limits(
    wall_s=180, cpu_s=40, memory_bytes=1_000_000_000, processes=64, output_bytes=50_000_000, open_files=256
)
_NOT_READ_HERE = ("notes", "unread", "readme_commands", "readme_misgiven")  # of `Files`
CRASHED = 128  # exit codes above this are those of signals


@dataclass(frozen=True)
class Reading:
    """What was read in a submission's files, before anything of it has run.

    Attributes:
        submission: what was found.
        files: the facts.
        plan: how it is built; its workspace is laid out in the World. None if no package could be read.
    """

    submission: Submission
    files: Files
    plan: Plan | None


def read(world: World, received: Received, assignment: Assignment) -> Reading:
    """Read a received submission, and lay out a workspace in which it can be built.

    Args:
        world: a copy of the submission that no box has used yet. It shows `environment.DDS_PROFILE`.
        received: what is known of the submission.
        assignment: the assignment for which it was handed in.

    Returns:
        What was read; if a limit ended the reading, a note in `files` says so, and unread facts are empty.

    Raises:
        SubmissionError: if a limit was met before it was known what the submission contains.
        RuntimeError: as for `underlay`.
        SandboxMissing: if a box cannot be made.
    """
    environ = underlay()
    prefixes = environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    asked = {
        "assignment": assignment.plain(),
        "received": plain(received, ""),
        "prefixes": prefixes,
    }
    answers, gave_up = _ask(world, "look", asked, environ)
    if "submission" not in answers:
        raise SubmissionError(f"It cannot be read: {gave_up} {HAND_IN[0].upper()}{HAND_IN[1:]}.")
    submission = typed(answers["submission"], Submission, "submission")
    plan = typed(answers["plan"], Plan, "plan") if answers.get("plan") else None
    facts = typed(answers.get("files", {}), Files, "files")
    if gave_up and "files" not in answers:
        names = [fact.name for fact in fields(Files) if fact.name not in _NOT_READ_HERE]
        known = {name: answers[FACT + name] for name in names if FACT + name in answers}
        unread = {name: gave_up for name in names if name not in known}
        facts = replace(typed(known, Files, "files"), unread=unread)
    if gave_up:
        facts = replace(facts, notes=[*facts.notes, f"Not all of its files could be read: {gave_up}"])
        if plan:
            _ask(world, "lay out", {"plan": plain(plan, "")}, environ)
    return Reading(submission, facts, plan)


def explained(
    world: World, reading: Reading, assignment: Assignment, texts: Iterable[str]
) -> tuple[list[list[str]], list[WrittenEnd]]:
    """Return `Files.findings` with those about the errors of a build and of programs first, and `Files.ends_meant` by all.

    Args:
        world: a copy of the submission.
        reading: what was read in it.
        assignment: the assignment for which it was handed in.
        texts: the output with the errors.

    Raises:
        SandboxMissing: if a box cannot be made.
    """
    asked = {
        "assignment": assignment.plain(),
        "submission": plain(reading.submission, ""),
        "findings": reading.files.findings,
        "texts": [*texts],
    }
    answers, _ = _ask(world, "said", asked, underlay())
    found = typed(answers.get("findings", reading.files.findings), list[list[str]], "findings")
    meant = answers.get("ends_meant", plain(reading.files.ends_meant, ""))
    return found, typed(meant, list[WrittenEnd], "ends_meant")


def _ask(
    world: World, question: str, asked: Mapping[str, Any], environ: Mapping[str, str]
) -> tuple[dict[str, Any], str]:
    """Return the answers to a question, and a sentence about the limit that cut them short, if any."""
    strict = {net.STRICT: "1"} if os.environ.get(net.STRICT) else {}
    paths = [str(PACKAGE.parent), environ.get("PYTHONPATH", "")]
    given = os.memfd_create("asked")
    try:
        with open(given, "wb", closefd=False) as file:
            file.write(json.dumps(asked).encode())
        os.lseek(given, 0, os.SEEK_SET)
        box = world.start(
            [sys.executable, "-B", "-m", "ros2lab.grading.reading.reader", question, FILES],
            files="write",
            environ={**environ, **strict, "PYTHONPATH": os.pathsep.join(filter(None, paths))},
            stdin=given,
            shown=[PACKAGE],
            limits=LIMITS,
        )
    finally:
        os.close(given)
    code = box.wait()
    # Nothing of the submission has run here, so all lines but the last one of a cut box are whole.
    lines = box.output.splitlines()
    whole = lines if code == 0 else lines[:-1] if not box.output.endswith("\n") else lines
    answers = dict(json.loads(line, object_hook=restored) for line in whole)
    if failed := answers.pop("failed", None):
        raise RuntimeError(
            f"The grader itself has failed, which is no fault of the submission: {failed}. Please report it."
        )
    gave_up = answers.pop("gave up", None)
    if box.cut:
        return answers, box.cut
    if gave_up or code > CRASHED:
        return (
            answers,
            f"It is too large or too entangled to be read ({gave_up or f'signal {code - CRASHED}'}).",
        )
    if code:
        raise RuntimeError(f"The program that reads a submission cannot start here (exit code {code}).")
    return answers, ""
