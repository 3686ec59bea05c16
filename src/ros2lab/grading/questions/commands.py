"""The node that takes commands: what follows each command.

A command is processed if something follows it that does not follow just any word: a log line of its own,
another velocity or status, a parameter, a message where there was none. A node that only repeats the word in
its log has received it; if its source compares something with each of the words, we believe that it does more
with them. How a program moves the robot does not matter here.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace

from ros2lab.assignments import Part
from ros2lab.grading.code.branches import LAST, MUTE
from ros2lab.grading.evidence import CommandSeen, Heard, Run
from ros2lab.grading.judging import reactions
from ros2lab.grading.judging.commanded import (
    Told,
    compares_in_vain,
    moved_parts,
    telling_players,
    told_of,
    unprompted,
    unsent_by,
    words_of,
)
from ros2lab.grading.judging.player import Player, stamped
from ros2lab.grading.judging.players import Case
from ros2lab.grading.judging.told_again import taken_for_unknown, told_by_place
from ros2lab.grading.questions import nodes
from ros2lab.grading.questions.answer import Answer, ended, last_word, listed, question, raised_at, shown
from ros2lab.grading.reading.deeds import COMPARES, LOGS, READS
from ros2lab.grading.senses import is_still

VERY_MANY = "very many commands"
SLOW = "A node is slow to answer"  # the beginning of a run's note
FLOOD = " x "  # part of the observer's name for them

_SAID = dict.fromkeys(("unprocessed", "why", "so", "own", "besides", "fallback", "spelling"), "")


@question(
    "all mixed told_apart until_end two one own_words echoed inverted capitals none otherwise untried written missing",
    "unprocessed why so own besides fallback spelling",
    nodes.CODES,
    mute="none untried",
    deeds=COMPARES,
    tells="all mixed told_apart until_end two one own_words inverted capitals",
)
def commands_are_processed(case: Case, part: Part) -> Answer:
    """Whether each command has an effect; two of the node's own words count as one command."""
    players = case.players[part.name]
    if not players:
        is_written = case.written(part) and {*part.commands} <= {*case.evidence.files.depended_on}
        level = "written" if is_written else "missing"
        return Answer(level, _SAID, ("runs", "files.depended_on"))
    runs = {player.number: player.run for player in players if player.commands}
    if not runs:
        return _unsaid(case, players[0], COMPARES, _SAID)
    telling = [player.run for player in telling_players(players)]
    told = told_of(case, part)
    own = _own_words(part, runs.values(), {*map(id, telling)}, unprompted(case))
    level = _processed(case, part, [*runs.values()], told, own)
    mixed: dict[str, str] = {}
    if level == "all":
        mixed = next(filter(None, (taken_for_unknown(part, run) for run in telling)), mixed)
    level = "mixed" if mixed else level
    known = told.known - mixed.keys() - (told.believed if level == "told_apart" else set())
    so = f"; what {listed(sorted(told.already))} is to bring about is so already" if told.already else ""
    seen = _SAID | {
        "unprocessed": listed([word for word in part.commands if word not in known]),
        "so": so,
        "own": listed(own),
        "besides": f", but something does follow {listed(own)}" if own else "",
        "fallback": shown(next(iter(mixed.values()), "").replace("{}", "…")),
        "spelling": listed(_spelt_otherwise(part, own) or [part.commands[0].upper()]),
    }
    best = max(told.effects, key=lambda number: [*told.effects[number].values()].count("processed"))
    return Answer(level, seen, _keys_of(part, best, runs[best]), shown(players[0].node))


def _processed(case: Case, part: Part, runs: Sequence[Run], told: Told, own: Sequence[str]) -> str:
    """Return the level for how many commands are told from unknown words, and by what."""
    known = told.known
    count = len(known) + min(len(own), len(part.commands) - len(known)) // 2
    if count == len(part.commands) and (told.unsent or told.believed):
        return "told_apart" if told.believed else "until_end"
    if told.processed:
        return "inverted" if _is_inverted(case, part) else _level_of(count, part)
    if _spelt_otherwise(part, own) or any(_obeys_capitals(part, run, unprompted(case)) for run in runs):
        return "capitals"
    if own and not known:
        return "own_words"
    is_echo = not known and words_of(told.effects, "echoed") and not compares_in_vain(case)
    return "echoed" if is_echo else _level_of(count, part)


def _spelt_otherwise(part: Part, own: Iterable[str]) -> list[str]:
    """Return a node's own words that are commands but for their capitals and the spaces around them."""
    return [word for word in own if word.strip().lower() in part.commands]


def _own_words(
    part: Part, runs: Iterable[Run], telling: Collection[int], alone: Mapping[str, Heard]
) -> list[str]:
    """Return the words in its code's comparisons that a node answers differently than unknown words."""
    found = set[str]()
    for run in runs:
        own = _with_own(part, run)
        effects = reactions.effects_of(own, run, alone, has_own_log=id(run) in telling)
        found |= {word for word, how in effects.items() if how == "processed"}
    return sorted(found)


def _with_own(part: Part, run: Run) -> Part:
    """Return a part whose commands are the node's own words that were tried in a run."""
    known = {*part.commands, *part.unknown, *(word.upper() for word in part.commands[:1])}
    said = itertools.dropwhile(lambda command: command.text not in part.commands, run.commands)
    texts = [command.text for command in said if command.text not in known and FLOOD not in command.text]
    return replace(part, commands=tuple(dict.fromkeys(texts)))


def _level_of(count: int, part: Part) -> str:
    return "all" if count == len(part.commands) else ("none", "one", "two")[min(count, 2)]


def _keys_of(part: Part, number: int, run: Run) -> tuple[str, ...]:
    """Return the evidence's keys for a run's commands."""
    known = [index for index, command in enumerate(run.commands) if command.text in part.commands]
    return tuple(f"runs[{number}].commands[{index}]" for index in known[:3])


@question(
    "all until_end some unspecific none otherwise untried missing",
    "silent told why line",
    nodes.CODES | {"logger-arguments"},
    mute="none untried",
    deeds=LOGS,
)
def commands_are_logged(case: Case, part: Part) -> Answer:
    """Whether a logged or printed line tells of each command, or of own words of the node instead."""
    seen = {"silent": "", "told": "each command", "why": "", "line": "A line in the log"}
    players = case.players[part.name]
    if not players:
        return Answer("missing", seen, ("runs",))
    telling = telling_players(players)
    if not telling:
        return _unsaid(case, players[0], LOGS, seen)
    runs = [player.run for player in telling]
    lines = [line for run in runs for command in run.commands for line in command.log]
    if all(level == "PRINT" for level, _ in lines):
        seen["line"] = "A printed line"
    logged = {word for run in runs for word in _logged(part, run)}
    every = [player.run for player in players if player.commands]
    logged -= told_by_place(part, every, unprompted(case))
    own = _own_words(part, runs, {id(run) for run in runs}, unprompted(case))
    own = [word for word in own if any(word in _logged(_with_own(part, run), run) for run in runs)]
    mute = {word for word, found in case.evidence.files.branches.items() if MUTE in found}
    unsent = unsent_by(case, part, runs, logged) - mute
    silent = [word for word in part.commands if word not in logged | unsent]
    seen["silent"] = listed(silent)
    if len(own) >= len(silent):
        level = "until_end" if unsent - logged else "all"
        if silent:
            seen["told"] = f"each word that the node knows: {listed([*sorted(logged), *own])}"
    elif {*silent} <= _shared(case, part, runs):
        level = "all"
        seen["told"] += f"; that of {listed(silent)} comes with unknown words, too, which counts above"
    elif logged or own:
        level = "some"
    else:
        level = "unspecific" if _says_anything(part, runs) else "none"
    return Answer(level, seen, (f"runs[{telling[0].number}].commands",), shown(telling[0].node))


def _logged(part: Part, run: Run) -> set[str]:
    """Return the commands with a line that does not also follow an unknown word."""
    unknown = reactions.lines_of_unknown(part, run)
    return {word for word, lines in reactions.telling_lines(part, run).items() if lines - unknown}


def _shared(case: Case, part: Part, runs: Iterable[Run]) -> set[str]:
    """Return the commands with a line that are not told from unknown words as others are, which counts there."""
    told = told_of(case, part)
    said = {word for run in runs for word, lines in reactions.telling_lines(part, run).items() if lines}
    return said - told.processed - told.believed if told.processed or told.believed else set()


@question(
    "lives moves deaf dies ends leaves unseen untried missing",
    "command last end program tried",
    nodes.CODES,
    mute="dies ends unseen untried",
)
def commands_do_no_harm(case: Case, part: Part) -> Answer:
    """Whether unknown, empty and a thousand commands leave the node alive and the robot at rest."""
    player = case.whole(part)
    seen = {"command": "", "last": "", "end": "", "program": "", "tried": ""}
    if player is None:
        return Answer("missing", seen, ("runs",))
    seen |= {"tried": _tried(part, player.run), "program": shown(player.program or player.node)}
    key = f"runs[{player.number}].commands"
    tried = [one for one in case.players[part.name] if one.commands]
    alike = [player, *(one for one in tried if one.program == player.program and one.is_ended_by_command)]
    if dead := next((one for one in alike if one.end is not None), None):
        return _end(case, dead, seen)
    if restart := next(filter(None, (one.restarted_at for one in tried)), None):
        seen |= {"command": _named(restart.text), "end": "and began anew"}
        return Answer("dies", seen, (key,), shown(player.node))
    mover = next(filter(None, (_mover(case, candidate) for candidate in tried)), None)
    if not player.commands:
        level, key = "untried", player.key
    elif mover is not None:
        level, seen["command"] = "moves", _named(mover.text, "unknown command")
    elif not _is_answered(case, part):
        level = "unseen"
    elif leaves := _leaving(case, part, [one.run for one in tried]):
        level, key, seen["command"] = "leaves", "files.branches", _named(leaves)
    elif _is_deaf(part, player.run):
        level, seen["command"] = "deaf", _last_answered(part, player.run)
    else:
        level = "lives"
    return Answer(level, seen, (key,), shown(player.node))


def _leaving(case: Case, part: Part, runs: Iterable[Run]) -> str:
    """Return the first command that was not sent, and at which the code plainly ends the program; empty if there is none."""
    unsent, told = unsent_by(case, part, runs, set()), case.evidence.files.branches
    return next((word for word in part.commands if word in unsent and LAST in told.get(word, ())), "")


def _tried(part: Part, run: Run) -> str:
    """Return which kinds of commands were sent in a run, and which of the others were not, as the end of a sentence."""
    kinds = {"known": [*part.commands], "unknown": [*filter(None, part.unknown)], "empty": [""]}
    sent = {command.text for command in run.commands}
    tried = [kind for kind, words in kinds.items() if not sent.isdisjoint(words)]
    tried += ["very many"] if any(FLOOD in text for text in sent) else []
    open_to = [kind for kind in (*kinds, "very many") if kind != "empty" or "" in part.unknown]
    left = [kind for kind in open_to if kind not in tried]
    why = ", for it is slow to answer" if any(note.startswith(SLOW) for note in run.notes) else ""
    return f"{listed(tried)} commands" + (f"; not sent were {listed(left)} ones{why}" if left else "")


def _says_anything(part: Part, runs: Iterable[Run]) -> bool:
    """Return whether any line follows a command, as written or in capitals, that does not come without one."""
    capitals = {word.upper() for word in part.commands} - {*part.commands}
    return any(
        reactions.lines_of(run, command)
        - reactions.said_by_itself(run)
        - (reactions.lines_of_unknown(part, run) if command.text in capitals else set())
        for run in runs
        for command in run.commands
        if command.text in (*part.commands, *capitals)
    )


def _unsaid(case: Case, player: Player, deed: str, seen: Mapping[str, str]) -> Answer:
    """Answer where no command was said; if it takes another type, by what the README and the code say of that."""
    kind, readme = player.types[0].rpartition("/")[2], case.evidence.files.readme
    is_told = kind != player.part.short_type and kind in readme and player.topic in readme
    its_own = [end for end in case.evidence.files.ends if end.topic == player.topic and not end.is_publisher]
    is_told &= player.end is None and any({READS, deed} <= {*(end.does or ())} for end in its_own)
    level = "otherwise" if is_told else "untried"
    return Answer(level, {**seen, "why": _untried(player)}, (player.key,), shown(player.node))


def _untried(player: Player) -> str:
    """Return why no command was sent to a node, as a clause."""
    if player.end is not None:
        return f"{shown(player.program or player.node)} had ended by then {ended(player.end, 'with', is_done=player.is_done)}"
    if player.part.type_name not in player.types:
        return f"{shown(player.node)} takes {shown(player.types[0])}"
    return f"{shown(player.node)} was not reached on {shown(player.topic)}"


def _is_answered(case: Case, part: Part) -> bool:
    """Return whether anything follows a command that does not also come by itself."""
    players, alone = case.players[part.name], unprompted(case)
    telling = telling_players(players)
    tried = [player for player in players if player.commands]
    return any(reactions.is_followed(player.run, alone, has_own_log=player in telling) for player in tried)


def _end(case: Case, player: Player, seen: dict[str, str]) -> Answer:
    seen = seen | {
        "last": last_word(player.end or ""),
        "end": ended(player.end or "", is_done=player.is_done),
    }
    deadly, place = player.last_command, raised_at(case, player.end or "", player.program)
    if deadly is None:
        return Answer("ends", seen, (f"runs[{player.number}].ended",), place)
    seen["command"] = _named(deadly.text)
    key = f"runs[{player.number}].commands[{player.run.commands.index(deadly)}]"
    return Answer("dies", seen, (key,), place)


def _is_inverted(case: Case, part: Part) -> bool:
    """Return whether the robot stands after commands that should move it, and moves when it should stop."""
    wanted = dict(zip(part.commands, part.effects, strict=True))
    for moved in moved_parts(case):
        for player in case.players[moved.name]:
            seen = {
                (wanted[command.text], reactions.stands(command.topics.get(player.topic)))
                for command in player.run.commands
                if command.text in wanted
            }
            is_inverted = {("moving", True), ("still", False)} <= seen and ("moving", False) not in seen
            if is_inverted and reactions.tells(player.run, player.topic, unprompted(case)):
                return True
    return False


def _obeys_capitals(part: Part, run: Run, alone: Mapping[str, Heard]) -> bool:
    """Return whether the first command in capitals has an effect that unknown words do not have."""
    numbers = {command.text: number for number, command in enumerate(run.commands)}
    capitals, strange = part.commands[0].upper(), reactions.unknown_word(part)
    if not {capitals, strange} <= numbers.keys():
        return False
    others = [command for command in run.commands if command.text in part.unknown]
    common = set[str]().union(*(reactions.lines_of(run, other) for other in others))
    own = reactions.lines_of(run, run.commands[numbers[capitals]]) - common - reactions.said_by_itself(run)
    unknown = set[str]().union(*(reactions.templates(run, other) for other in others))
    own = {line for line in own if reactions.template(line, capitals) not in unknown}
    is_said = bool(own) and not reactions.logs_arbitrarily(part, run)
    return is_said or reactions.changing(part, run, alone)[numbers[capitals]]


def _mover(case: Case, player: Player) -> CommandSeen | None:
    """Return the unknown command after which a standing robot moves; None if there is none.

    A robot that has not moved yet after a command that should move it may still be about to: that is no
    effect of the unknown command.
    """
    wanted = dict(zip(player.part.commands, player.part.effects, strict=True))
    types = {name for part in moved_parts(case) for name in (part.type_name, stamped(part.type_name))}
    run = player.run
    for topic, ends in run.publishes.items():
        if not any(types & {*kinds} for kinds in ends.values()) or not reactions.tells(
            run, topic, unprompted(case)
        ):
            continue
        quiet = run.quiet.get(topic)
        stands = not quiet or all(map(is_still, quiet.values))
        if quiet and reactions.turns([*map(is_still, quiet.values)]) > 1:
            continue  # it moves and stands by itself
        is_about_to = False
        for command in run.commands:
            is_about_to = wanted.get(command.text) == "moving" or (is_about_to and command.text not in wanted)
            heard = command.topics.get(topic)
            if heard and heard.values:
                is_moved = stands and not is_still(heard.values[-1])
                if command.text in player.part.unknown and is_moved and not is_about_to:
                    return command
                stands = is_still(heard.values[-1])
                is_about_to &= stands
    return None


def _is_deaf(part: Part, run: Run) -> bool:
    """Return whether a node that answered the first command answers none after the flood."""
    texts, first = [command.text for command in run.commands], part.commands[0]
    if texts.count(first) < 2 or texts[-1] != first or not reactions.telling_lines(part, run)[first]:
        return False
    last = list(itertools.takewhile(lambda command: command.text == first, reversed(run.commands)))
    return not any(_is_heeded(part, run, command) for command in last)


def _is_heeded(part: Part, run: Run, command: CommandSeen) -> bool:
    """Return whether something follows a command that does not follow just any word.

    What follows both an unknown word and a later command comes by itself, such as from a loop in which a node
    is stuck.
    """
    unknown, known = (
        set[str]().union(*(reactions.lines_of(run, seen) for seen in run.commands if seen.text in texts))
        for texts in (part.unknown, part.commands[1:])
    )
    return bool(
        reactions.lines_of(run, command) - reactions.said_by_itself(run) - (unknown & known) or command.topics
    )


def _last_answered(part: Part, run: Run) -> str:
    """Name what came between the last answer of a deaf node and the command that it did not answer."""
    said = [*itertools.takewhile(lambda command: FLOOD not in command.text, run.commands)]
    last = max((number for number, command in enumerate(said) if _is_heeded(part, run, command)), default=0)
    later = [command.text for command in said[last + 1 :]]
    between = [*itertools.takewhile(lambda text: text not in part.commands, later)]
    if len(between) == len(later):
        return VERY_MANY
    return (
        f"the words {', '.join(map(repr, between))}"
        if between[1:]
        else _named((between or [said[last].text])[0])
    )


def _named(text: str, noun: str = "command") -> str:
    if FLOOD in text:
        return VERY_MANY
    return f"the {noun}{'s' * (', ' in text)} {shown(text)!r}" if text else "an empty command"
