"""Which commands a node tells from unknown words: by what follows them, and by what its code depends on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Set
from typing import NamedTuple

from ros2lab.assignments import Part
from ros2lab.grading.evidence import Heard, Run
from ros2lab.grading.judging import reactions
from ros2lab.grading.judging.player import Player
from ros2lab.grading.judging.players import Case
from ros2lab.grading.judging.told_again import told_by_place

# Findings about comparisons that are always or never true: they tell no words apart.
_VAIN = frozenset(("message-compared", "literal-comparison", "comparison-unused", "text-as-condition"))


def words_of(effects: Mapping[int, Mapping[str, str]], how: str) -> set[str]:
    """Return the words that have this effect in some run."""
    return {word for found in effects.values() for word, seen in found.items() if seen == how}


def unsent_by(case: Case, part: Part, runs: Iterable[Run], obeyed: Set[str]) -> set[str]:
    """Return the words that were not sent because an earlier one ended a node or kept it busy, which counts elsewhere.

    Where reading finds the words that were seen to be obeyed, it must find these in the code, too.
    """
    sent = set()
    for run in runs:
        for command in run.commands:
            sent.add(command.text)
            if not command.is_alive:
                break
    unsent, known = {*part.commands} - sent, _depended_on(case)
    return unsent & known if known and obeyed <= known else unsent


def telling_players(players: list[Player]) -> list[Player]:
    """Return the players whose log is the node's own: those that ran alone, else all with commands."""
    tried = [player for player in players if player.commands]
    return [player for player in tried if player.run.setting == "alone"] or tried


def unprompted(case: Case) -> dict[str, Heard]:
    """Return by topic what programs published alone and before any command."""
    return {
        topic: heard
        for run in case.evidence.runs
        if run.setting == "alone"
        for topic, heard in run.quiet.items()
    }


class Told(NamedTuple):
    """Which commands a part's node tells from unknown words.

    Attributes:
        effects: by the number of each run with commands what each word brought.
        processed: those that something of their own follows, and those whose effect holds already.
        already: those whose effect holds already.
        believed: those that only the log shows to have come, and on which the code depends.
        unsent: those that were not sent; see `unsent_by`.
    """

    effects: dict[int, dict[str, str]]
    processed: set[str]
    already: set[str]
    believed: set[str]
    unsent: set[str]

    @property
    def known(self) -> set[str]:
        """Those that are told apart, or were not sent."""
        return self.processed | self.believed | self.unsent


def told_of(case: Case, part: Part) -> Told:
    """Return which commands a part's node tells from unknown words, as it shows or as its code says."""
    players, quiet = case.players[part.name], unprompted(case)
    runs = {player.number: player.run for player in players if player.commands}
    telling = {id(player.run) for player in telling_players(players)}
    echoes = reactions.echoes(part, runs.values(), quiet)
    effects = {
        number: reactions.effects_of(part, run, quiet, has_own_log=id(run) in telling, echoes=echoes)
        for number, run in runs.items()
    }
    by_place = told_by_place(part, runs.values(), quiet)
    already = _is_so_already(case, part, effects)
    processed = (words_of(effects, "processed") | already) - by_place
    believed = words_of(effects, "echoed") & _depended_on(case)
    unsent = unsent_by(case, part, runs.values(), processed)
    return Told(effects, processed, already, believed - processed - unsent - by_place, unsent)


def _depended_on(case: Case) -> set[str]:
    return set() if compares_in_vain(case) else {*case.evidence.files.depended_on}


def compares_in_vain(case: Case) -> bool:
    """Return whether the code has comparisons that are always or never true."""
    return any(code in _VAIN for code, *_ in case.evidence.files.findings)


def _is_so_already(case: Case, part: Part, effects: Mapping[int, Mapping[str, str]]) -> set[str]:
    """Return the commands that were received and have no visible effect because their state holds already.

    If the robot drives from the start until a later command stops it, the first command changes nothing. If
    it was stopped before, the last command changes nothing. The code must depend on them; where reading misses a
    word that was seen to be obeyed, it may miss others, and one that is logged has come.
    """
    heard = {
        command.text
        for number, found in effects.items()
        for command in case.evidence.runs[number].commands
        if found and command.is_alive
    }
    processed, known = words_of(effects, "processed"), _depended_on(case)
    heard -= processed | words_of(effects, "refused")
    known |= set() if processed <= known else words_of(effects, "echoed")
    first, *later = part.commands
    drives = any(
        reactions.stands(player.run.quiet.get(player.topic)) is False
        and reactions.tells(player.run, player.topic, unprompted(case))
        and any(
            reactions.stands(command.topics.get(player.topic))
            for command in player.run.commands
            if command.text in later
        )
        for moved in moved_parts(case)
        for player in case.players[moved.name]
    )
    so = {first} & heard & known if drives else set()
    return so | ({part.commands[-1]} & heard & known if {*part.commands[:-1]} <= processed | so else set())


def moved_parts(case: Case) -> list[Part]:
    """Return the publishing parts without a period whose type no other part has, such as velocities."""
    parts = case.assignment.parts.values()
    return [part for part in parts if part.is_publisher and not part.period and case.assignment.is_only(part)]
