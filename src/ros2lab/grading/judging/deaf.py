"""Which programs take the commands and do nothing of their own with them, while another program answers them."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from ros2lab.grading.judging.player import Player
from ros2lab.grading.judging.reactions import effects_of


def without_deaf(players: Sequence[Player]) -> list[Player]:
    """Return the players of a part that takes commands, without those of deaf programs.

    What counts for a part comes from the program that plays it: one that tells no word from another does not,
    if another program that takes the commands does.
    """
    own: dict[str, list[Player]] = {}
    for player in players:
        if player.run.setting == "alone" and player.commands:
            own.setdefault(player.program, []).append(player)
    hearing = {program for program, seen in own.items() if any(map(_tells_words_apart, seen))}
    deaf: Collection[str] = own.keys() - hearing if hearing else ()
    return [player for player in players if player.program not in deaf]


def _tells_words_apart(player: Player) -> bool:
    run = player.run
    return bool(effects_of(player.part, run, run.quiet, has_own_log=True))
