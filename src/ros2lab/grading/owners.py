"""Whose a finding is: the node's that the module makes in which it lies."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from pathlib import PurePosixPath

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.spelling import is_near_topic
from ros2lab.grading.grade import Judgement
from ros2lab.grading.players import Case
from ros2lab.grading.questions.nodes import CODES as NODE_CODES
from ros2lab.grading.questions.nodes import missing


def is_about(case: Case, finding: Finding, criterion: Judgement, lost: Collection[Judgement]) -> bool:
    """Return whether a finding is about the node of a criterion, if it is about a node at all."""
    parts = case.assignment.parts
    if criterion.component not in parts:
        return True
    if ".launch." in finding.place or "launch/" in finding.place:
        return False  # it has no node of its own
    if owners := owners_of(case, finding):
        # A program that has one node may be meant to have those, too, of which no program is known.
        is_free = not _programs(case, criterion.component) and not {*owners} & {
            judgement.component for judgement in lost
        }
        return criterion.component in owners or is_free
    if named := _with_topic(case, finding, parts):
        return criterion.component in named
    # Nothing says whose it is: then the node that lost most, and only what its program can have died of.
    candidates = _with_type(case, finding, parts) or [*parts]
    losses = {
        name: sum(judgement.max - judgement.points for judgement in lost if judgement.component == name)
        for name in candidates
    }
    return finding.code in NODE_CODES and criterion.component == max(losses, key=lambda name: losses[name])


def owners_of(case: Case, finding: Finding) -> list[str]:
    """Return the parts whose nodes the module makes in which a finding lies.

    Where it makes none, these are the parts whose program it is, else those whose program imports it. Of several that
    one module makes, these are the ones of whose topic, or of whose messages, the finding is.
    """
    stem = PurePosixPath(re.sub(r":\d+$", "", finding.place)).stem
    for modules_of in (_makers, _programs, _imported):
        owners = [name for name in case.assignment.parts if stem and stem in modules_of(case, name)]
        if owners:
            return _with_topic(case, finding, owners) or _with_type(case, finding, owners) or owners
    return []


def _makers(case: Case, name: str) -> set[str]:
    """Return the modules that make what the node of a part has; its program's where reading does not tell."""
    part, players = case.assignment.parts[name], case.players[name]
    topics = {part.topic, *(player.topic for player in players)}
    ends = [end for end in case.evidence.files.ends if end.module and end.is_publisher is part.is_publisher]
    right = {end.module for end in ends if end.topic in topics}
    made = right or {end.module for end in ends if end.topic and is_near_topic(end.topic, part.topic)}
    of_program = _programs(case, name) | _imported(case, name)
    return made & of_program if made & of_program else _programs(case, name) or made


def _programs(case: Case, name: str) -> set[str]:
    """Return the programs that are likely to have the node of a part, and their own modules."""
    programs = {player.program for player in case.players[name]} - {""}
    programs = programs or {missing(case, case.assignment.parts[name]).place}
    own = {case.executables[program].stem for program in programs & case.executables.keys()}
    return (programs | own) - {""}


def _imported(case: Case, name: str) -> set[str]:
    """Return all modules of the programs that are likely to have the node of a part."""
    programs = _programs(case, name) & case.executables.keys()
    return {module for program in programs for module in case.executables[program].modules}


def _with_topic(case: Case, finding: Finding, names: Iterable[str]) -> list[str]:
    """Return the parts whose topic a finding is about."""
    topics = {name.strip("/") for name in finding.about}
    return [name for name in names if case.assignment.parts[name].topic.strip("/") in topics]


def _with_type(case: Case, finding: Finding, names: Iterable[str]) -> list[str]:
    """Return the parts of whose messages, or of what these hold, a finding is about the type."""
    types = {name.rpartition(".")[2] for name in finding.about}
    return [name for name in names if types & _types_in(case.assignment.parts[name].type_name)]


def _types_in(type_name: str) -> set[str]:
    """Return a message's type without its package, and those of the messages that it holds."""
    match = re.search(r"(\w+)/(?:\w+/)?(\w+)", type_name)
    if match is None:
        return set()
    fields = interfaces.fields_of(f"{match[1]}.msg.{match[2]}") or {}
    return {match[2]}.union(*map(_types_in, fields.values()))
