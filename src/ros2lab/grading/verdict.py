"""From evidence to a grade, by a rubric; nothing is run, and equal evidence always gives an equal grade."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Collection, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import PurePosixPath

from ros2lab.assignments import Part
from ros2lab.grading.evidence import GIVEN, NO_ENTRY_POINT, Build, Evidence, Run
from ros2lab.grading.grade import SCHEMA, Fault, Grade, Judgement, Override, Points
from ros2lab.grading.judging.excuses import wrong_line
from ros2lab.grading.judging.leftovers import case_of
from ros2lab.grading.judging.player import Player, deadly_in, is_for_want
from ros2lab.grading.judging.players import Case
from ros2lab.grading.overrides import Decision
from ros2lab.grading.owners import explains, is_about, owners_of
from ros2lab.grading.questions import QUESTIONS, Answer
from ros2lab.grading.questions.answer import ended, is_shut_down, last_word, listed, shown
from ros2lab.grading.questions.nodes import OF_TYPE, missing
from ros2lab.grading.reading.unread import NO_FAULT, as_far_as_possible
from ros2lab.grading.receiving.notes import first_of
from ros2lab.grading.rubric import BONUS, Rubric
from ros2lab.grading.watching import OWN_CLOCK

LONGEST_FAULT = 500  # characters of what a diagnosis says
NO_RECORDING = "no picture, film or log was handed in"
_LINK = re.compile(r"https?://[^\s<>()\[\]\"'`]+")
_OUTPUT = re.compile(r"\[INFO\] \[|^\s*data: |^\s*average rate: ", re.MULTILINE)
# Findings that are faults even where they cost nothing.
ALWAYS_WRONG = frozenset(
    ("message-compared", "literal-comparison", "comparison-unused", "text-as-condition", "timer-in-callback")
)
GONE = "Fix first why the node was not seen."
LONGEST_WHY = 200
NOT_TRIED = "This could not be tried here, costs nothing, and is left to the instructor: {}."
NOT_SEEN = "This could not be tried here, as with another node, so that {share:.0%} counts and the rest is left to the instructor: {}."
SHOW = "Show the instructor what it does where nothing is missing."
NOT_DONE = "This could not be tried here: {}. But {}."
DO = "Write what the node is to do, also where it cannot be tried."
DOUBTED = "Only {share:.0%} of it counts, because {why}."
OTHER_TYPE = "the node that is meant for {wanted} has another type than {wanted_type}"
OTHER_NODE = (
    "its topic is not {wanted}, and nothing that it does tells that it is meant for it, whatever it is called"
)
MEANT = "Use the topic {wanted} and the type {wanted_type}."
STRANGE, WRONG_TYPE = "strange", "wrong"  # answers about a node's topic, and its type
OTHER_TOPICS = ("near", "other", STRANGE)
MISSING = "missing"
ABSENT = (MISSING, "written")  # of a node that was not seen


def verdict(evidence: Evidence, rubric: Rubric, overrides: Mapping[str, Decision] | None = None) -> Grade:
    """Grade a submission.

    Args:
        evidence: what was seen of it.
        rubric: what the points are given for.
        overrides: an instructor's decisions, by criterion; see `overrides.read`.

    Raises:
        ValueError: if there is a decision about a criterion that the rubric does not have.
    """
    decisions = overrides or {}
    unknown = sorted(decisions.keys() - {criterion.id for criterion in rubric.criteria})
    if unknown:
        raise ValueError(f"The rubric has no criterion {unknown[0]}; decide about one that it has.")
    case = case_of(evidence, rubric.assignment)
    assignment = case.assignment
    answers = {
        criterion.id: QUESTIONS[criterion.question].ask(case, assignment.parts.get(criterion.component))
        for criterion in rubric.criteria
    }
    machine = [*_weighed(rubric, answers, [*_judged(rubric, answers, {*as_far_as_possible(_gone(case))})])]
    criteria = [_decided(judgement, decisions.get(judgement.id)) for judgement in machine]
    total = round(sum(criterion.points for criterion in criteria), 2)
    return Grade(
        schema=SCHEMA,
        submission=shown(evidence.name),
        total=total,
        max=round(sum(points for name, points in rubric.components.items() if name != BONUS), 2),
        components={
            name: Points(
                round(sum(criterion.points for criterion in criteria if criterion.component == name), 2), most
            )
            for name, most in rubric.components.items()
        },
        criteria=criteria,
        faults=[*as_far_as_possible(_faults(case, rubric, machine, answers))],
        notes=[*dict.fromkeys(as_far_as_possible(_notes(case)))],
        clock="stepped"
        if all(run.clock == "stepped" for run in evidence.runs if run.setting != "launched")
        else "real",
        sandbox=evidence.sandbox,
        seconds={part: evidence.seconds.get(part, 0.0) for part in ("unpack", "build", "observe", "total")},
        versions=dict(evidence.versions),
    )


def _gone(case: Case) -> Iterator[str]:
    """Yield the parts without a node of which a program is known that would have it, or a fault in one."""
    for name, part in case.assignment.parts.items():
        told = (finding for finding in case.evidence.files.told() if explains(case, finding, name))
        is_unseen = not case.players[name] and not case.is_foreign(part)
        if is_unseen and (missing(case, part).place or any(told)):
            yield name


def _judged(rubric: Rubric, answers: Mapping[str, Answer], gone: Container[str]) -> Iterator[Judgement]:
    wanting = {criterion.component for criterion in rubric.criteria if answers[criterion.id].is_for_want} & {
        *rubric.assignment.parts
    }
    for criterion in rubric.criteria:
        answer = answers[criterion.id]
        level = criterion.levels[answer.level]
        hint = GONE if answer.level in ABSENT and criterion.component in gone else level.hint
        share, reason = level.share, level.reason.format_map(answer.seen).strip()
        if answer.excuse and answer.lack:
            reason, hint = NOT_DONE.format(shown(answer.excuse, LONGEST_WHY), answer.lack), DO
        elif answer.is_for_want and len(wanting) > 1 and rubric.untried < 1:
            share, hint = max(share, rubric.untried), SHOW
            reason = NOT_SEEN.format(shown(answer.excuse, LONGEST_WHY), share=share)
        elif answer.excuse:
            # Nobody gets a bonus for what we failed to read.
            is_extra = criterion.component == BONUS and NO_FAULT in answer.excuse
            share, reason = share if is_extra else 1.0, NOT_TRIED.format(shown(answer.excuse, LONGEST_WHY))
        yield Judgement(
            id=criterion.id,
            component=criterion.component,
            title=criterion.title,
            points=round(share * criterion.points, 2),
            max=criterion.points,
            reason=reason,
            hint=hint.format_map(answer.seen) if share < 1 else "",
            evidence=list(answer.evidence),
        )


def _weighed(
    rubric: Rubric, answers: Mapping[str, Answer], judged: Sequence[Judgement]
) -> Iterator[Judgement]:
    """Yield the judgements; what any node does counts less where little tells that the part's node is meant.

    Where its topic has no word of the part's either, all that it does counts less once more.
    """
    telling = {criterion.id for criterion in rubric.criteria if QUESTIONS[criterion.question].tells}
    doubted = {name: why for name in rubric.assignment.parts if (why := _doubt(rubric, name, answers))}
    strange = {one.component: one.hint for one in judged if answers[one.id].level == STRANGE}
    for judgement in judged:
        name, is_telling = judgement.component, judgement.id in telling
        share = rubric.doubted ** ((not is_telling) + (name in strange)) if name in doubted else 1
        if share < 1 and judgement.points:
            seen = answers[judgement.id].seen
            why = doubted[name].format_map(seen)
            yield replace(
                judgement,
                points=round(judgement.points * share, 2),
                reason=f"{judgement.reason} {DOUBTED.format(share=share, why=why)}",
                hint=strange.get(name) or judgement.hint or MEANT.format_map(seen),
            )
        else:
            yield judgement


def _doubt(rubric: Rubric, name: str, answers: Mapping[str, Answer]) -> str:
    """Return a clause if a part's node has another type, or another topic and nothing else by which the part is known."""
    asked = [
        (question.tells, answers[criterion.id])
        for criterion in rubric.criteria
        if criterion.component == name and (question := QUESTIONS[criterion.question]).tells
    ]
    levels = {answer.level for _, answer in asked}
    if WRONG_TYPE in levels or levels.isdisjoint(OTHER_TOPICS):
        return OTHER_TYPE if WRONG_TYPE in levels else ""
    # A type that several parts have tells none of them.
    is_only = rubric.assignment.is_only(rubric.assignment.parts[name])
    own = [(tells, answer) for tells, answer in asked if is_only or tells != OF_TYPE]
    is_known = any(answer.level in tells or (answer.excuse and not answer.lack) for tells, answer in own)
    return OTHER_NODE if len(own) > 1 and not is_known else ""


def _decided(judgement: Judgement, decision: Decision | None) -> Judgement:
    if decision is None:
        return judgement
    override = Override(decision.points, decision.comment, decision.by, judgement.points)
    changed = {**vars(judgement), "points": decision.points, "override": override}
    return Judgement(**changed)


# --- faults -----------------------------------------------------------------------------------------------


def _faults(
    case: Case, rubric: Rubric, judged: Iterable[Judgement], answers: Mapping[str, Answer]
) -> Iterator[Fault]:
    """Yield the faults: the findings that explain a lost criterion, else what was observed."""
    questions = {criterion.id: QUESTIONS[criterion.question] for criterion in rubric.criteria}
    lost = [
        judgement
        for judgement in judged
        if judgement.points < judgement.max and _is_fault(judgement, answers[judgement.id])
    ]
    explained: set[str] = set()
    told: set[tuple[str, ...]] = set()
    for finding in case.evidence.files.told():
        owners = [
            judgement
            for judgement in lost
            if wrong_line(finding) in judgement.reason
            or (finding.code in questions[judgement.id].codes and is_about(case, finding, judgement, lost))
        ]
        explained |= {judgement.id for judgement in owners}
        components = list(dict.fromkeys(judgement.component for judgement in owners))
        if not owners and finding.code in ALWAYS_WRONG:
            components = owners_of(case, finding)[:1]
        key = (finding.code, finding.cause.partition(" Did you mean")[0], finding.place)
        if components and key not in told:
            told.add(key)
            texts = (shown(text, LONGEST_FAULT) for text in (finding.cause, finding.place, finding.fix))
            yield Fault(finding.code, components[0], *texts)
    yield from _unexplained(case, [judgement for judgement in lost if judgement.id not in explained], answers)
    for criterion in rubric.criteria:
        answer, level = answers[criterion.id], criterion.levels[answers[criterion.id].level]
        if level.share == 1 and level.hint:  # it costs nothing, but is to be told
            code = re.sub(r"[._]", "-", f"{criterion.id}-{answer.level}")
            cause, hint = (text.format_map(answer.seen) for text in (level.reason, level.hint))
            yield Fault(code, criterion.component, cause, answer.place, hint)


def _is_fault(lost: Judgement, answer: Answer) -> bool:
    """Return whether a lost criterion shows a fault.

    What could not be tried has another cause; what was not asked for is no fault.
    """
    is_untried = answer.level in ("untried", "otherwise") or (answer.excuse and not answer.lack)
    return not is_untried and (lost.component != BONUS or answer.level not in (MISSING, "none", "of_an_end"))


def _unexplained(case: Case, lost: Iterable[Judgement], answers: Mapping[str, Answer]) -> Iterator[Fault]:
    """Yield faults from what was observed; a missing node is one fault, however many criteria it costs."""
    told: set[str] = set()
    for judgement in lost:
        answer = answers[judgement.id]
        is_absent = answer.level in ABSENT and judgement.component in case.assignment.parts
        subject = f"{judgement.component}-{MISSING}" if is_absent else f"{judgement.id}-{answer.level}"
        code = re.sub(r"[._]", "-", subject)
        if code not in told:
            told.add(code)
            yield Fault(code, judgement.component, judgement.reason, answer.place, judgement.hint)


# --- notes ------------------------------------------------------------------------------------------------


def _notes(case: Case) -> Iterator[str]:
    """Yield what was done differently than usual, or left out."""
    evidence = case.evidence
    for note in (*map(str, evidence.submission.notes), *evidence.files.notes):
        yield shown(note, LONGEST_FAULT)
    if also := [package.name or "" for package in evidence.submission.also]:
        yield f"Part of the work is in other packages, whose nodes are graded as well: {listed(also)}."
    if evidence.submission.form != "nothing":
        yield f"Evidence of running is left to the instructor: {_shown_running(evidence)}."
    if evidence.build:
        yield from _notes_of_build(evidence.build)
    if left := evidence.unwatched:
        yield f"Of so many programs those were watched that have a part by their code, or come first; not watched: {first_of([*map(shown, left)])}."
    yield from _notes_of_runs(case)
    yield from _not_launched(evidence)
    clocked = sorted({node for run in evidence.runs for node in run.clocked})
    if clocked and not any(OWN_CLOCK in run.notes for run in evidence.runs):
        yield f"The timers of {listed(clocked)} never fire: use_sim_time is set, and nobody publishes /clock."
    for player in filter(None, map(case.main, case.assignment.parts.values())):
        yield from _unheard(player)
        if besides := case.topics_besides(player):
            yield f"{shown(player.node)} was judged by {shown(player.topic)}, and not by {listed(besides)}."
        yield from _unwritten(case, player)


def _shown_running(evidence: Evidence) -> str:
    """Return what in the submission shows that it has run, as a clause."""
    if evidence.files.recordings:
        return listed(evidence.files.recordings)
    has_output = _OUTPUT.search(evidence.files.readme)
    shown_there = "the README shows lines as a terminal prints them" if has_output else NO_RECORDING
    links = [*dict.fromkeys(_LINK.findall(evidence.files.readme))]
    return f"{shown_there}, and no link was opened" + (f", such as {listed(links)}" if links else "")


def _notes_of_runs(case: Case) -> Iterator[str]:
    # A program that ends without a command when alone is not ended by a command to another program.
    runs, part = case.evidence.runs, case.assignment.commanded
    brief = {name for run in runs if run.setting == "alone" and not deadly_in(run) for name in run.ended}
    watched = defaultdict[str, list[str]](list)
    for run in runs:
        for note in run.notes:
            watched[note].append(f"{shown(', '.join(run.programs))}, {shown(run.setting)}")
    for note, those in watched.items():
        yield f"{'; '.join(dict.fromkeys(those))}: {shown(note, LONGEST_FAULT)}"
    for run in runs:
        yield from _notes_of(case, run, brief)
        for topic, types in run.torn.items():
            yield f"Nodes use {shown(topic)} with several types, {listed(types)}: what has one receives nothing from what has another."
        if part and run.commands and run.commanded != part.topic and run.commanded in run.subscribes:
            who = f"{shown(', '.join(run.programs))}, {shown(run.setting)}"
            yield f"{who}: commands were published on {shown(run.commanded)}, for nothing there subscribes to {part.topic}."


def _not_launched(evidence: Evidence) -> Iterator[str]:
    """Yield a note about the launch files that were not tried, if others were."""
    tried = {run.programs[0] for run in evidence.runs if run.setting == "launched"}
    left = [path for path in evidence.files.launch_files if PurePosixPath(path).name not in tried]
    if tried and left:
        yield (f"Of the launch files those were tried that start most; not tried: {listed(left)}.")


def _notes_of_build(build: Build) -> Iterator[str]:
    yield from (shown(note, LONGEST_FAULT) for note in build.notes)
    for executable in build.executables:
        if executable.fault:
            how = f"was run as a {executable.way}" if executable.command else "could not be run"
            is_left = executable.fault == NO_ENTRY_POINT and not build.is_built
            fault = (
                "No entry point of it is installed." if is_left else shown(executable.fault, LONGEST_FAULT)
            )
            yield f"{shown(executable.name)} {how}: {fault}"


def _unwritten(case: Case, player: Player) -> Iterator[str]:
    if not case.is_written(player.part):
        yield (
            f"Reading did not find the code that makes what {shown(player.node)} has on {shown(player.topic)}: "
            "look at its program, and at what that starts."
        )


def _notes_of(case: Case, run: Run, brief: Collection[str]) -> Iterator[str]:
    """Yield what was done differently than usual in a run.

    Args:
        case: the evidence.
        run: the run.
        brief: the programs that end by themselves.
    """
    who = shown(", ".join(run.programs))
    if run.refused:
        yield f"{who}, {shown(run.setting)}: it was watched as outside the lab, where {last_word(run.refused)} is no error."
    if run.unfinished:
        yield f"{who}, {shown(run.setting)}: not all could be tried, for {run.unfinished}."
    deadly = deadly_in(run)
    for name, end in run.ended.items() if run.setting != GIVEN else ():
        by_itself, after = ("by itself ", "")
        if run.setting == "together" and name in run.early and name not in brief:
            by_itself, after = ("", " before any command, and was not seen to end alone")
        elif deadly is not None and name not in brief:
            by_itself, after = ("", f" after {_published(deadly.text, case.assignment.commanded)}")
        how = (
            f"{by_itself}for want of what is not here"
            if is_for_want(end, case.executables.get(name), case.evidence.files)
            else ended(end, f"{by_itself}with", is_done=name in run.done)
        )
        if run.setting == "launched" and is_shut_down(end):
            how = "by itself: it shut down all that it had started"
        yield f"{shown(name)}, {shown(run.setting)}: it ended {how}{after}."
    if run.given:
        what = [f"{name} ({run.gave.get(name, '')})" for name in run.given]
        yield f"Messages, requests or responses of made-up contents were given, for nobody in the hand-in brings any: {listed(what)}."


def _published(text: str, part: Part | None) -> str:
    """Return what was published, as a clause that says so of words that the assignment does not name."""
    words = text.split(", ")
    is_made_up = part is not None and len(words) > 1 and {*words}.isdisjoint(part.commands)
    return f"made-up words were published: {shown(text)}" if is_made_up else f"{shown(text)!r} was published"


def _unheard(player: Player) -> Iterator[str]:
    """Yield a note if a node's QoS does not match nodes with the default QoS."""
    end, policy, effect = (
        ("subscriber", "transient_local", "hears only publishers that are transient local, too")
        if not player.part.is_publisher
        else ("publisher", "best_effort", "is not heard by subscriptions that are reliable")
    )
    ends = [words for words in map(str.split, player.run.qos.get(player.topic, [])) if words[0] == end]
    if ends and all(policy in words for words in ends):
        yield f"{shown(player.node)} {effect}, on {shown(player.topic)}."
