"""Other packages in a submission that might have been part of the work but are not, such as a tutorial's."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace

from ros2lab.assignments import Assignment
from ros2lab.diagnose.sources.spelling import is_near_topic
from ros2lab.grading.evidence import Evidence, Run
from ros2lab.grading.judging.player import Player
from ros2lab.grading.judging.players import Case
from ros2lab.grading.receiving.submission import FoundPackage


def case_of(evidence: Evidence, assignment: Assignment) -> Case:
    """Return the case without packages that are no part of the work, so that these cost no points."""
    case = Case(evidence, assignment)
    left = [package for package in evidence.submission.also if not _is_at_work(case, package)]
    return Case(_without(evidence, left), assignment) if left and evidence.build else case


def _is_at_work(case: Case, package: FoundPackage) -> bool:
    """Return whether a program of a package plays a part, or clearly would if it were seen."""
    programs = [program for program in case.executables.values() if program.package == package.name]
    names = {program.name for program in programs}
    modules = {module for program in programs for module in (*program.modules, program.stem)} - {""}
    for part in case.assignment.parts.values():
        if any(player.program in ("", *names) for player in _telling(case, part.name)):
            return True
        if not case.players[part.name] and any(
            end.module in modules
            and end.is_publisher is part.is_publisher
            and (end.topic == part.topic or is_near_topic(end.topic, part.topic))
            for end in case.evidence.files.ends
        ):
            return True
    return False


def _telling(case: Case, name: str) -> Iterator[Player]:
    """Yield the players that a part may be judged by."""
    part = case.assignment.parts[name]
    yield from filter(None, (case.main(part), case.at_once(part), case.whole(part)))


def _without(evidence: Evidence, left: list[FoundPackage]) -> Evidence:
    """Return evidence as if packages had not been handed in; runs with other programs in them stay."""
    names, folders = {package.name for package in left}, tuple(f"{package.folder}/" for package in left)
    files, build, submission = evidence.files, evidence.build, evidence.submission
    assert build is not None
    counts = [files.sources_beside.get(package.name or "", {}) for package in left]
    said = f"Not graded, for none of its nodes plays a part: {', '.join(sorted(filter(None, names)))}."
    kept = [program for program in build.executables if program.package not in names]
    programs = {program.name for program in build.executables} - {program.name for program in kept}
    return replace(
        evidence,
        submission=replace(submission, also=[package for package in submission.also if package not in left]),
        files=replace(
            files,
            findings=[finding for finding in files.findings if not finding[2].startswith(folders)],
            sources={
                kind: [
                    number - sum(count.get(kind, [0, 0])[n] for count in counts)
                    for n, number in enumerate(pair)
                ]
                for kind, pair in files.sources.items()
            },
            notes=[*files.notes, said],
        ),
        build=replace(build, executables=kept),
        runs=[_less(run, programs) for run in evidence.runs],
    )


def _less(run: Run, programs: Collection[str]) -> Run:
    """Return a run as if some programs had not ended in it; an empty run if there were no others."""
    if {*run.programs} <= {*programs}:
        return Run(run.programs, run.setting, run.clock, [], {}, {}, {}, {}, {}, [], {}, {}, [])
    ended = {name: said for name, said in run.ended.items() if name not in programs}
    return replace(run, ended=ended, early=[name for name in run.early if name not in programs])
