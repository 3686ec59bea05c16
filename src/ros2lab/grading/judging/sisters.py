"""What a silent node takes from another program of the same hand-in that never came up: that fault is paid there."""

from __future__ import annotations

from ros2lab.assignments import Part
from ros2lab.grading.evidence import GIVEN
from ros2lab.grading.judging.players import Case


def lost_sister(case: Case, part: Part) -> str:
    """Return a clause if a part's publisher lives and takes what only a program that was lost would send; else empty."""
    player, commanded = case.main(part), case.assignment.commanded
    if player is None or not part.is_publisher or player.end is not None:
        return ""
    program = case.executables.get(player.program)
    if program is None or program.never_spins:
        return ""
    taken = {topic for topic, nodes in player.run.subscribes.items() if player.node in nodes}
    taken -= {commanded.topic} if commanded else set()  # the grader says the commands itself
    # What it was given by the grader, and was silent all the same, it does not want for.
    given = (run for run in case.evidence.runs if player.run.setting != GIVEN and player.node in run.nodes)
    taken = taken.difference(*(run.given for run in given))
    for name in sorted(case.lost(case.players) & case.executables.keys()):
        modules = {*case.executables[name].modules, case.executables[name].stem}
        for end in case.evidence.files.ends:
            if end.is_publisher and end.module in modules and end.topic in taken:
                return f"{player.node} takes what {name} would send on {end.topic}, and that program does not go on"
    return ""
