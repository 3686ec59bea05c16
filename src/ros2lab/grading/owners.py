"""Which node a finding belongs to: the one that is made in the module where the finding lies."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from pathlib import PurePosixPath

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.spelling import is_near_topic
from ros2lab.grading.grade import Judgement
from ros2lab.grading.judging.players import Case
from ros2lab.grading.questions.nodes import CODES as NODE_CODES
from ros2lab.grading.questions.nodes import missing


def is_about(case: Case, finding: Finding, criterion: Judgement, lost: Collection[Judgement]) -> bool:
    """Return whether a finding is about a criterion's node; True for a criterion that has none."""
    parts = case.assignment.parts
    if criterion.component not in parts:
        return True
    if ".launch." in finding.place or "launch/" in finding.place:
        return False  # a launch file belongs to no node
    if owners := owners_of(case, finding):
        # A program with one node may also be meant to have the nodes whose program is not known.
        is_free = not _programs(case, criterion.component) and not {*owners} & {
            judgement.component for judgement in lost
        }
        return criterion.component in owners or is_free
    if named := _with_topic(case, finding, parts):
        return criterion.component in named
    if _goes_on(case, finding):
        return False
    # Nothing says whose it is: take the node that lost most, and only for faults that can end a program.
    candidates = (
        _with_type(case, finding, parts)
        or [name for name in parts if explains(case, finding, name)]
        or [*parts]
    )
    losses = {
        name: sum(judgement.max - judgement.points for judgement in lost if judgement.component == name)
        for name in candidates
    }
    return finding.code in NODE_CODES and criterion.component == max(losses, key=lambda name: losses[name])


def explains(case: Case, finding: Finding, name: str) -> bool:
    """Return whether a finding, in a module that is named for a part, tells why that part's node does not run."""
    part = case.assignment.meant_by(_stem(finding))
    is_its = part is not None and part.name == name
    return is_its and finding.code in NODE_CODES and not _goes_on(case, finding)


def owners_of(case: Case, finding: Finding) -> list[str]:
    """Return the parts whose nodes are made in the module of a finding.

    If it makes none, return the parts whose program it is, else those whose program imports it. Of several
    parts, prefer those whose topic, else those whose message type, the finding is about.
    """
    stem = _stem(finding)
    for modules_of in (_makers, _programs, _imported):
        owners = [name for name in case.assignment.parts if stem and stem in modules_of(case, name)]
        if owners:
            return _with_topic(case, finding, owners) or _with_type(case, finding, owners) or owners
    return []


def _stem(finding: Finding) -> str:
    return PurePosixPath(re.sub(r":\d+$", "", finding.place)).stem


def _goes_on(case: Case, finding: Finding) -> bool:
    """Return whether the programs with the module of a finding were all seen to go on, and play no part all the same."""
    programs = [program for program in case.executables.values() if _stem(finding) in program.modules]
    names = {program.name for program in programs}
    alone = [run for run in case.evidence.runs if run.setting == "alone" and run.programs[0] in names]
    return bool(alone) and all(run.nodes and not run.ended for run in alone)


def _makers(case: Case, name: str) -> set[str]:
    """Return the modules that make a part's publisher or subscription; its program's if no code tells."""
    part, players = case.assignment.parts[name], case.players[name]
    topics = {part.topic, *(player.topic for player in players)}
    ends = [end for end in case.evidence.files.ends if end.module and end.is_publisher is part.is_publisher]
    right = {end.module for end in ends if end.topic in topics}
    made = right or {end.module for end in ends if end.topic and is_near_topic(end.topic, part.topic)}
    of_program = _programs(case, name) | _imported(case, name)
    return made & of_program if made & of_program else _programs(case, name) or made


def _programs(case: Case, name: str) -> set[str]:
    """Return the programs that are likely to have a part's node, and their own modules."""
    programs = {player.program for player in case.players[name]} - {""}
    programs = programs or {missing(case, case.assignment.parts[name]).place}
    own = {case.executables[program].stem for program in programs & case.executables.keys()}
    return (programs | own) - {""}


def _imported(case: Case, name: str) -> set[str]:
    """Return all modules of the programs that are likely to have a part's node."""
    programs = _programs(case, name) & case.executables.keys()
    return {module for program in programs for module in case.executables[program].modules}


def _with_topic(case: Case, finding: Finding, names: Iterable[str]) -> list[str]:
    """Return the parts, among these names, whose topic a finding is about."""
    topics = {name.strip("/") for name in finding.about}
    return [name for name in names if case.assignment.parts[name].topic.strip("/") in topics]


def _with_type(case: Case, finding: Finding, names: Iterable[str]) -> list[str]:
    """Return the parts, among these names, whose message type, or a type inside it, a finding is about."""
    types = {name.rpartition(".")[2] for name in finding.about}
    return [name for name in names if types & _types_in(case.assignment.parts[name].type_name)]


def _types_in(type_name: str) -> set[str]:
    """Return the name of a message type without its package, and those of the messages nested in it."""
    match = re.search(r"(\w+)/(?:\w+/)?(\w+)", type_name)
    if match is None:
        return set()
    fields = interfaces.fields_of(f"{match[1]}.msg.{match[2]}") or {}
    return {match[2]}.union(*map(_types_in, fields.values()))
