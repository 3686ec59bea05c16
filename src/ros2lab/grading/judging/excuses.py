"""Why what a node does could not be tried during grading, so that it costs fewer points, or none."""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Sequence
from pathlib import PurePosixPath
from typing import NamedTuple

from ros2lab.assignments import Part
from ros2lab.diagnose.finding import Finding
from ros2lab.grading.evidence import GIVEN, KEYBOARD, Executable, Run, WrittenEnd
from ros2lab.grading.judging.player import Player, is_for_want, lacked, of_one_node
from ros2lab.grading.judging.players import Case
from ros2lab.grading.reading.deeds import CLAUSES, PUBLISHES, READS, REPEATS
from ros2lab.observed_domain import TEXTS

# What fails, or does nothing, wherever it runs.
_FAILS = frozenset(
    (
        "attribute-missing",
        "callback-arguments",
        "field-type",
        "message-compared",
        "message-field",
        "name-undefined",
        "publish-text",
        "publish-type",
        "publisher-method",
    )
)
# The error of a value, at the end of what a program says: another value might have been right.
_OF_VALUES = re.compile(
    r"^(?:[\w.]*\.)?(?:ValueError|KeyError|IndexError|\w*Decode\w*Error|SyntaxError|ZeroDivisionError)\b",
    re.MULTILINE,
)
_RAISED = re.compile(r"^[\w.]+(?:Error|Exception|error)\b[^\n]*\Z", re.MULTILINE)


class Excuse(NamedTuple):
    """An excuse.

    Attributes:
        why: why something could not be tried here, in a clause; empty if it could.
        lack: why the code would not do it anywhere, so that the excuse does not count, in a clause; empty if it
            would.
    """

    why: str = ""
    lack: str = ""


def quoted(text: str) -> str:
    """Return what a program says in quotes of which it has none itself, so that it is not read as the grader's."""
    inner = re.sub("[“”]", "'", text)
    return f"“{inner}”"


def excuse(case: Case, part: Part, deeds: Collection[str] = ()) -> Excuse:
    """Return why what a part's node does could not be tried here, and why its code would not do it anywhere.

    Nothing excuses what no line of the code would do, or what a line keeps it from.

    Args:
        case: the evidence.
        part: the part of the assignment.
        deeds: what the code must do with the topic, besides publishing on it or reading its messages.
    """
    everybody = of_one_node(case.players[part.name], case.main(part))
    players = [player for player in everybody if player.run.setting != GIVEN]
    if not players:
        return Excuse(_unwatched(case, part))
    lack = (
        _left_out(case, players, (*_uses(part), *deeds)) or _broken(case, players) or _failed(case, players)
    )
    return _why(case, part, players)._replace(lack=lack)


def unused(case: Case, part: Part) -> str:
    """Return a clause if what a part's node has is silent, and no line of its code that runs uses it; else empty."""
    players = of_one_node(case.players[part.name], case.main(part))
    is_heard = any(player.is_heard for player in players)
    return "" if is_heard or not players else _left_out(case, players, _uses(part))


def sent_once(case: Case, part: Part) -> str:
    """Return a clause if code publishes with a part's publisher only once, or hangs with it; else empty."""
    players = of_one_node(case.players[part.name], case.main(part))
    ends = [end for player in players for end in _ends(case, player)]
    is_used = bool(ends) and all(PUBLISHES in (end.does or ()) for end in ends)
    if is_used and all(REPEATS in end.never for end in ends):
        return "the code publishes only once"
    hangs = all(player.end is None for player in players) and all(end.begins for end in ends)
    return "the code publishes at its start and hangs" if is_used and hangs else ""


def _uses(part: Part) -> tuple[str, ...]:
    """Return what code must do with the end of a part for it to be of any use."""
    return () if part.end == "service" else (PUBLISHES if part.is_publisher else READS,)


def _left_out(case: Case, players: Sequence[Player], needed: Collection[str]) -> str:
    """Return which deed the players' code never does, as a clause; empty if none is known."""
    known = [does for player in players if (does := _does(case, player, needed)) is not None]
    left = [deed for deed in needed if not any(deed in does for does in known)]
    if not left or len(known) < len(players):
        return ""
    lack = f"no line of the code that runs {CLAUSES[left[0]]}"
    vain = {end.vain for player in players for end in _ends(case, player)}
    told = (wrong_line(finding) for finding in case.evidence.files.told() if finding.place in vain)
    return ": ".join([lack, *itertools.islice(told, 1)])


def wrong_line(finding: Finding) -> str:
    """Return a clause that says what is wrong with a line."""
    file, _, line = finding.place.partition(":")
    return f"line {line} of {PurePosixPath(file).name} is wrong: {finding.cause.removesuffix('.')}"


def _broken(case: Case, players: Sequence[Player]) -> str:
    """Return which line of the players' own code fails or is in vain anywhere, as a clause; empty if none is known."""
    programs = [case.executables[player.program] for player in players if player.program in case.executables]
    modules = {module for program in programs for module in (*program.modules, program.stem)}
    for finding in case.evidence.files.told():
        if finding.code in _FAILS and PurePosixPath(finding.place.partition(":")[0]).stem in modules:
            return wrong_line(finding)
    return ""


def _failed(case: Case, players: Sequence[Player]) -> str:
    """Return with which error of its own a program ended where all that it lacks said yes, as a clause; empty if with none."""
    runs = [run for run in case.evidence.runs if run.setting == GIVEN]
    for program in {player.program for player in players if player.end is None}:
        executable = case.executables.get(program)
        said = next((run.ended[program] for run in runs if program in run.ended), "")
        is_its_own = _RAISED.search(said) and not is_for_want(said)
        if (
            executable
            and executable.absent
            and is_its_own
            and not any(_ended_by_text(case, run, players) for run in runs)
        ):
            return f"where what it lacks says yes, it ends with {quoted(said.strip().splitlines()[-1])}"
    return ""


def _why(case: Case, part: Part, players: Sequence[Player]) -> Excuse:
    """Return why what the players of a part do could not be tried; an empty excuse if it could.

    What the code itself shows comes first: a program in which nothing spins or loops would end anywhere, and
    one in which nothing spins would receive nothing anywhere.
    """
    # A program that ends with an error of its own, or does something, is not waiting for anything.
    is_mute = not any(player.is_heard for player in players)
    is_mute &= all(player.end is None or _is_for_want(player) for player in players)
    needs = (_needs(case, part, player, is_mute=is_mute) for player in players)
    if need := next(filter(None, needs), ""):
        return Excuse(need)
    late = [player.run.unfinished for player in players]
    if is_mute and late and all(late):
        return Excuse(late[0])
    return Excuse(_not_given(case, part, players) if is_mute and part.end != "service" else "")


def _not_given(case: Case, part: Part, players: Sequence[Player]) -> str:
    """Return a clause if what a part's node may wait for could not be given; empty if it was, or nobody waits."""
    runs = [run for run in case.evidence.runs if run.setting == GIVEN]
    everybody = of_one_node(case.players[part.name], case.main(part))
    if any(player.is_heard for player in everybody if player.run.setting == GIVEN):
        return ""
    missing = {name for run in runs for name in run.ungiven}
    if part.end == "subscription":  # it takes itself what opens it
        missing &= {topic for player in players for topic in _taken(player.run, {player.node})}
    if missing:
        return f"{players[0].node} waits for what nobody here brings on {', '.join(sorted(missing))}"
    ended = (_ended_by_text(case, run, players) for run in runs)
    late = (run.unfinished for run in runs if not run.nodes)
    return next(filter(None, (*ended, *late)), "")


def _ended_by_text(case: Case, run: Run, players: Sequence[Player]) -> str:
    """Return a clause if a made-up text ended a player's program: a text may be read as anything."""
    for player in players:
        said = run.ended.get(player.program, "")
        alone = (run for run in case.evidence.runs if run.programs == [player.program])
        nodes = {player.node}.union(*(run.nodes for run in alone))
        texts = {topic for topic in _taken(run, nodes) if run.gave.get(topic) == TEXTS}
        if texts and _OF_VALUES.search(said):
            return f"{player.program} ended with a made-up text, and nobody here brings any other on {', '.join(sorted(texts))}"
    return ""


def _taken(run: Run, nodes: Collection[str]) -> set[str]:
    """Return the topics to which some nodes subscribe in a run."""
    return {topic for topic, by in run.subscribes.items() if not by.keys().isdisjoint(nodes)}


def _needs(case: Case, part: Part, player: Player, *, is_mute: bool) -> str:
    """Return a clause that says what a player's program needs and lacks; empty if it can do without."""
    program, said = case.executables.get(player.program), player.end or ""
    is_called_back = part.end != "publisher"
    if program is None or program.is_brief or (is_called_back and program.never_spins):
        return ""
    absent = [*_absent(case, program), *lacked(said, program, case.evidence.files)]
    if not absent or not (is_mute or _is_for_want(player)):  # a program may print anything
        return ""
    return f"{player.program} needs {', '.join(absent)}, not there where it is graded"


def _is_for_want(player: Player) -> bool:
    """Return whether a player's program ended for want of something that is not here.

    What only an unknown word makes it ask a machine for, it could do without.
    """
    said, known = player.end or "", player.part.commands
    is_unknown = player.last_command is not None and player.last_command.text not in known
    has_lived = any(command.is_alive and command.text in known for command in player.run.commands)
    return is_for_want(said) and not (is_unknown and has_lived and lacked(said))


def _unwatched(case: Case, part: Part) -> str:
    """Return a clause if there was no time to watch the program that may play a part; else empty."""
    runs = case.evidence.runs
    unseen = [run for run in runs if run.unfinished and not run.nodes]
    alone = [run for run in runs if run.setting == "alone"]
    watched = {name for run in alone for name in (run.ended if run.unfinished else run.programs)}
    # A launch file may start any of them.
    started = (case.executables if run.setting == "launched" else run.programs for run in unseen)
    names = {name for programs in started for name in programs} - watched
    return unseen[0].unfinished if any(case.may_be(name, part) for name in names) else ""


def _does(case: Case, player: Player, needed: Collection[str]) -> set[str] | None:
    """Return which of the deeds the code that may create a player's end does with it; None if not known."""
    ends = _ends(case, player)
    if not ends or any(end.does is None for end in ends):
        return None
    return {deed for end in ends for deed in _done_with(end, needed)}


def _ends(case: Case, player: Player) -> list[WrittenEnd]:
    """Return the ends of the code that may be a player's: those with its topic, else those with one that is not known."""
    program = case.executables.get(player.program)
    modules = {*program.modules, program.stem} - {""} if program else set()
    ends = [
        end
        for end in case.evidence.files.ends_left or case.evidence.files.ends
        if end.is_publisher is player.part.is_publisher
        and (not modules or not end.module or end.module in modules)
    ]
    return [end for end in ends if end.topic == player.topic] or [end for end in ends if not end.topic]


def _done_with(end: WrittenEnd, needed: Collection[str]) -> set[str]:
    """Return the deeds that code may do with an end: those that it does, and those needed that it may do."""
    does = {*(end.does or ())}
    if PUBLISHES not in does:
        return does
    return does | ({*needed} - {*end.never})


def _absent(case: Case, program: Executable) -> list[str]:
    """Return what a program lacks, except a keyboard if the grader typed for it."""
    is_typed = any(run.typed and program.name in run.programs for run in case.evidence.runs)
    return [name for name in program.absent if name != KEYBOARD or not is_typed]
