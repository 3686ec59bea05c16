"""Questions about a node that publishes: its rhythm, and the numbers in its messages."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from ros2lab.assignments import Part
from ros2lab.grading.evidence import GIVEN, Heard, Run
from ros2lab.grading.judging.excuses import sent_once
from ros2lab.grading.judging.periods import gaps_of, period_of, quiet_times
from ros2lab.grading.judging.player import Player, of_one_node
from ros2lab.grading.judging.players import Case
from ros2lab.grading.questions import nodes
from ros2lab.grading.questions.answer import Answer, last_word, question, shown
from ros2lab.grading.questions.commands import FLOOD
from ros2lab.grading.reading.deeds import READS, REPEATS, VARIES
from ros2lab.grading.senses import is_velocity, numbers_in, seen
from ros2lab.rhythm import between, distance, has_period, is_uneven, rounded

LONG_AFTER = 1.0  # s between two messages; a velocity that is published again and again comes more often
LEAST_TOLD = 0.001  # s between two messages; what is shorter is told as this
TINY = 1e-200  # an int in a float field becomes 5e-324 times the int


@question(
    "right begun close off far irregular growing once answered empty silent written missing",
    "period topic",
    nodes.CODES | frozenset(("period",)),
    ("publisher",),
    needs="period",
    mute="once silent",
    deeds=REPEATS,
    tells="right begun close",
)
def has_its_period(case: Case, part: Part) -> Answer:
    """Whether messages come with the period that is asked for, by the node itself or as launched."""
    everybody = of_one_node(case.players[part.name], case.main(part))
    end = case.written(part)
    is_written = end is not None and any(has_period(period, part.period) for period in end.periods)
    if not everybody:
        level = "written" if is_written else "missing"
        return Answer(level, {"period": "", "topic": ""}, ("runs", "files.ends"))
    heard = [player for player in everybody if player.is_heard]
    heard = [player for player in heard if player.run.setting != GIVEN] or heard
    players = [player for player in heard if case.counts(player) and not _is_other(case, player)]
    found = [(player, period) for player in players if (period := period_of(player)) is not None]
    if found:
        return _rhythm("empty", found[0][0]) if _is_empty(players) else _of_periods(case, part, found)
    first = (players or everybody)[0]
    level = _without_period(players, is_timed=bool(end and end.periods))
    # On the real clock, commands follow each other more quickly than messages that only they begin.
    is_late = level == "once" and not quiet_times(first) and first.run.clock == "real"
    is_begun = is_late and end is not None and is_written and REPEATS not in end.never
    return _rhythm("begun" if is_begun else level, first)


def _without_period(players: Sequence[Player], *, is_timed: bool) -> str:
    """Return the level of players of whose messages no period is known, by how many came."""
    total = max((sum(heard.count for heard in player.heard) for player in players), default=0)
    several = "irregular" if is_timed or not all(one.only_answers for one in players) else "answered"
    return "silent" if not total else "once" if total == 1 else several


def _is_empty(players: Sequence[Player]) -> bool:
    """Return whether all that was heard is texts in which nothing can be seen."""
    values = [value for player in players for heard in player.heard for value in heard.values]
    texts = [value.get("data") if value.keys() == {"data"} else None for value in values]
    return bool(texts) and all(isinstance(text, str) and not seen(text) for text in texts)


def _of_periods(case: Case, part: Part, found: Sequence[tuple[Player, float]]) -> Answer:
    """Answer from the periods that were seen: those of programs that ran alone come first."""
    alone = [pair for pair in found if pair[0].run.setting == "alone"] or found
    if growing := [player for player, _ in found if _is_growing(case, player)]:
        return _rhythm("growing", growing[0])
    if uneven := [player for player, _ in alone if is_uneven(quiet_times(player))]:
        return _rhythm("irregular", uneven[0])
    player, period = min(alone, key=lambda pair: _LEVELS.index(distance(pair[1], part.period)))
    if not has_period(period, part.period):
        player, period = next((pair for pair in found if _is_steady(pair[0])), (player, period))
    return _rhythm(distance(period, part.period), player, period)


def _rhythm(level: str, player: Player, period: float = -1.0) -> Answer:
    """Return an answer about a player's topic, and its period in s, if there is one."""
    wanted = player.part.period
    # One digit of what is much shorter, so that 0.05 is not told as 0.1.
    is_short = period < wanted / 10
    told = f"{max(period, LEAST_TOLD):.1g}" if is_short else str(rounded(period, wanted))
    seen = {"period": told if period >= 0 else "", "topic": shown(player.topic)}
    return Answer(level, seen, (player.quiet_key,), seen["topic"])


@question(
    "repeated changed once echoed answered silent written missing",
    "topic",
    nodes.CODES,
    ("publisher",),
    mute="once silent",
    deeds=REPEATS,
)
def comes_again(case: Case, part: Part) -> Answer:
    """Whether messages come repeatedly, or whenever something changes."""
    everybody = of_one_node(case.players[part.name], case.main(part))
    is_timed = bool((end := case.written(part)) and end.periods)
    if not everybody:
        return Answer("written" if is_timed else "missing", {"topic": ""}, ("runs", "files.ends"))
    players = [player for player in everybody if case.counts(player)] or everybody
    totals = [sum(heard.count for heard in player.heard) for player in players]
    most = max(totals)
    best = players[totals.index(most)]
    level = "once" if most else "silent"
    if most > 1:
        level = "answered" if best.only_answers and not is_timed else _repetition(case, everybody)
    keys = [key for key, _ in best.heard_at][:2]
    return Answer(level, {"topic": shown(best.topic)}, tuple(keys or [best.key]), shown(best.topic))


def _repetition(case: Case, players: Sequence[Player]) -> str:
    """Return how several messages came: again and again, at each change, or as an echo of whatever was said."""
    if any(_comes_by_itself(player) for player in players):
        return "repeated"
    is_echo = _is_echo(players) and not _may_change(case, players)
    return "echoed" if is_echo or any(_is_at_random(case, player) for player in players) else "changed"


def _comes_by_itself(player: Player) -> bool:
    """Return whether several messages came before any command or request, or after a single one."""
    run, topic = player.run, player.topic
    stretches = [run.quiet, run.meanwhile, *(call.topics for call in run.calls), *_after_words(run)]
    return any(topic in topics and topics[topic].count > 1 for topics in stretches)


def _after_words(run: Run) -> list[dict[str, Heard]]:
    """Return what came after each word that was said by itself, and before the many, after which some may come late."""
    said = itertools.takewhile(lambda command: FLOOD not in command.text, run.commands)
    return [command.topics for command in said if ", " not in command.text]


def _may_change(case: Case, players: Sequence[Player]) -> bool:
    """Return whether the code of some players may look at what comes, and say something else at other words than were said."""
    programs = [case.executables[player.program] for player in players if player.program in case.executables]
    modules = {module for program in programs for module in (*program.modules, program.stem)}
    ends = [end for end in case.evidence.files.ends if end.module in modules]
    taken = [end.does for end in ends if not end.is_publisher]
    said = [end.never for end in ends if end.is_publisher and end.topic in ("", players[0].topic)]
    may_listen = not taken or any(does is None or READS in does for does in taken)
    return may_listen and not (said and all(VARIES in never for never in said))


def _is_echo(players: Sequence[Player]) -> bool:
    """Return whether the same message came once after each word, whatever it was, and none while nothing was said.

    Words that follow each other quickly tell nothing: there may be no time for more than one message.
    """
    values = [value for player in players for heard in player.heard for value in heard.values]
    is_steady = all(value == values[0] for value in values)
    if not is_steady or any(player.run.calls or quiet_times(player) for player in players):
        return False
    after = [[topics.get(player.topic) for topics in _after_words(player.run)] for player in players]
    times = [[heard.times[0] for heard in stretches if heard and heard.times] for stretches in after]
    return any(
        1 < len(came) == len(stretches) and min(between(came)) > LONG_AFTER
        for came, stretches in zip(times, after, strict=True)
    )


def _is_at_random(case: Case, player: Player) -> bool:
    """Return whether a robot gets two new velocities or more by unknown words: a length, a count or a hash tells none apart.

    What keeps its velocity at such a word, stands still, or drives as at any other, knows none of them.
    """
    commanded = case.assignment.commanded
    unknown = commanded.unknown if commanded else ()
    new, before = set[str](), ""
    for command in player.run.commands:
        heard = command.topics.get(player.topic)
        if heard and heard.values and is_velocity(heard.values[-1]):
            says = heard.sense
            new |= {says} - {before, "still"} if command.text in unknown else set()
            before = says
    return len(new) > 1


@question(
    "right too_often silent missing",
    "topic why",
    nodes.CODES,
    ("publisher",),
    needs="when",
    mute="silent",
    tells="right",
)
def comes_when_it_should(case: Case, part: Part) -> Answer:
    """Whether a message comes only once, or only when a request or a command has changed something."""
    player = case.whole(part)
    if player is None:
        return Answer("missing", {"topic": "", "why": ""}, ("runs",))
    quiet = player.run.quiet.get(player.topic)
    before = quiet.count if quiet else 0
    total = sum(heard.count for heard in player.heard)
    values = [value for heard in player.heard for value in heard.values]
    seen, why = {"topic": shown(player.topic)}, ""
    if part.when == "once":
        level = "right" if total == 1 else "too_often" if total else "silent"
        why = f"{total} came"
    elif before > 1:
        level, why = "too_often", f"{before} came before anything had changed"
    elif any(later == earlier for earlier, later in itertools.pairwise(values)):
        level, why = "too_often", "one came that holds what the one before it holds"
    else:
        level = "right" if total > before else "silent"
    return Answer(level, {**seen, "why": why}, (player.quiet_key,), seen["topic"])


@question(
    "right relayed sent_once not_finite tiny refused no_numbers silent missing",
    "value field sent",
    nodes.CODES,
    ("publisher",),
    mute="sent_once no_numbers silent",
)
def has_finite_numbers(case: Case, part: Part) -> Answer:
    """Whether all numbers in the messages are finite, and none is an int in a float field.

    This covers all runs, before and after commands: one bad number is enough to stop a subscriber.
    """
    player = case.main(part)
    seen = {"value": "", "field": "", "sent": ""}
    if player is None:
        return Answer("missing", seen, ("runs",))
    if not player.is_heard:
        seen["sent"] = "" if player.run.refused else sent_once(case, part)
        level = "sent_once" if seen["sent"] else "silent"
        return Answer(level, seen, (player.key,), shown(player.topic))
    its_own = of_one_node(case.players[part.name], player)
    alike = [candidate for candidate in its_own if candidate.match == player.match]
    numbers = [
        (key, name, number)
        for candidate in alike
        for key, heard in candidate.heard_at
        for value in heard.values
        for name, number in numbers_in(value)
    ]
    level = "relayed" if player.only_answers and player.topic in player.run.handed_on else "right"
    level = level if numbers else "no_numbers"
    key = player.quiet_key if player.topic in player.run.quiet else player.key
    wrong = [entry for entry in numbers if not _is_usable(entry[-1])]
    # What comes of made-up numbers only now and then may never come.
    is_of_given = player.run.setting == GIVEN and 2 * len(wrong) < len(numbers)
    if wrong and not is_of_given:
        key, name, number = wrong[0]
        level = "tiny" if math.isfinite(number) else "not_finite"
        seen |= {"value": f"{number:.3g}", "field": shown(name)}
    if player.run.refused:
        level, seen["field"] = "refused", last_word(player.run.refused)
    return Answer(level, seen, (key,), shown(player.topic))


def _is_usable(number: float) -> bool:
    return math.isfinite(number) and not 0 < abs(number) < TINY


_LEVELS = ("right", "close", "off", "far")


def _is_other(case: Case, player: Player) -> bool:
    """Return whether a node has other parameters in its run than alone, which make its period wrong."""
    own = player.run.parameters.get(player.node)
    values = [
        candidate.run.parameters.get(candidate.node)
        for candidate in case.players[player.part.name]
        if candidate.run.setting == "alone" and player.program in ("", candidate.program)
    ]
    is_changed = bool(own) and any(value and value != own for value in values)
    return is_changed and not _is_steady(player)


def _is_growing(case: Case, player: Player) -> bool:
    """Return whether more and more messages come because the code makes another timer whenever one fires."""
    gaps = between(quiet_times(player))
    makes_more = any(code == "timer-in-callback" for code, *_ in case.evidence.files.findings)
    return makes_more and player.run.clock == "real" and bool(gaps) and min(gaps) < max(gaps) / 4


def _is_steady(player: Player) -> bool:
    """Return whether all gaps between messages in a run are right."""
    return all(has_period(gap, player.part.period) for gap in gaps_of(player))
