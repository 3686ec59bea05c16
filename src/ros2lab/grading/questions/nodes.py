"""What is asked of every node: its topic, the type, and whether it lives."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from ros2lab.assignments import Part
from ros2lab.diagnose.sources.spelling import is_near_topic
from ros2lab.grading.evidence import GIVEN, CommandSeen, Run
from ros2lab.grading.judging.by_type import may_end, owners_of
from ros2lab.grading.judging.excuses import unused
from ros2lab.grading.judging.player import PLAIN_SETTINGS, STAND_IN, Player, is_for_want, of_one_node, stamped
from ros2lab.grading.judging.players import Case
from ros2lab.grading.judging.sisters import lost_sister
from ros2lab.grading.questions.answer import Answer, ended, last_word, question, raised_at, shown, tells_error
from ros2lab.grading.sandbox.keeper import is_limit

# Findings that explain why a node does not run, or does not do what it should.
CODES = frozenset(
    (
        "node-syntax",
        "ros1-import",
        "import-wrong",
        "module-missing",
        "rclpy-init-missing",
        "rclpy-init-twice",
        "context-manager",
        "super-missing",
        "super-misspelt",
        "super-late",
        "node-name-invalid",
        "node-property",
        "topic-name-invalid",
        "dot-for-comma",
        "type-not-a-message",
        "argument-order",
        "queue-size",
        "qos-missing",
        "argument-missing",
        "callback-called",
        "callback-missing",
        "callback-arguments",
        "attribute-missing",
        "name-undefined",
        "parameter-undeclared",
        "parameter-type",
        "publisher-method",
        "publish-text",
        "publish-type",
        "message-field",
        "message-compared",
        "literal-comparison",
        "comparison-unused",
        "text-as-condition",
        "string-data-type",
        "field-type",
        "int-in-float",
        "logger-arguments",
        "spin-missing",
        "endless-loop",
        "rate-without-thread",
        "shutdown-in-callback",
        "timer-in-callback",
        "name-missing",
        "attribute-unknown",
    )
)
TOPIC_CODES = frozenset(("topic-near-miss",))
TYPE_CODES = frozenset(("topic-type", "type-not-a-message"))
LEAST_SILENT = 3  # words, after each of which twice the longest period passes
OF_TYPE = frozenset(("right", "stamped", "alike"))  # what tells a part's node if no other part has its type


@question(
    "right unused doubled apart near other strange written missing",
    "topic node why unused",
    CODES | TOPIC_CODES,
    tells="right unused doubled apart",
)
def has_its_topic(case: Case, part: Part) -> Answer:
    """Whether a node publishes on, or subscribes to, the topic of its part, and plays no other part."""
    player = case.at_once(part)
    if player is None:
        answer = missing(case, part)
        end = case.written(part)
        level = "written" if end and end.topic == part.topic else "missing"
        seen = {**answer.seen, "topic": "", "node": "", "unused": ""}
        return Answer(level, seen, answer.evidence, answer.place)
    seen = {"topic": shown(player.topic), "node": shown(player.node), "why": "", "unused": unused(case, part)}
    if part.is_publisher and not any(one.is_heard for one in case.players[part.name]):
        seen["verb"] = "has a publisher for"
    level = "other" if player.is_guessed else player.match
    if level == "other" and player.match != "misplaced" and not case.assignment.is_about(player.topic, part):
        level = "strange"
    seen["why"] = _owned(case, player)
    if player.match == "right" and case.is_apart(part):
        level = "apart"
    elif player.match == "right" and part.name in case.doubled:
        level = "doubled"
    elif level == "right" and seen["unused"]:
        level = "unused"
    return Answer(level, seen, (player.key,), seen["topic"])


def _owned(case: Case, player: Player) -> str:
    """Return a clause that says of which other part a node has the topic; empty if it has none of those."""
    if player.match != "misplaced":
        return ""
    owner = owners_of(case.assignment, player.topic)[0]
    kind = "" if owner.type_name in player.types else f", for {owner.type_name}"
    return f": that is the topic of {owner.name}{kind}"


@question(
    "right stamped alike wrong untold written missing",
    "type topic",
    CODES | TYPE_CODES,
    mute="untold",
    tells=" ".join(OF_TYPE),
)
def has_its_type(case: Case, part: Part) -> Answer:
    """Whether the topic has the type that is asked for, that type with a header, or one of its name elsewhere."""
    player = case.main(part)
    if player is None:
        end = case.written(part)
        level = "written" if end and end.type_name == part.type_name else "missing"
        return Answer(level, {"type": "", "topic": part.topic}, ("runs", "files.ends"))
    level, written = "right", part.type_name
    if part.type_name not in player.types:
        written = _written_type(case, player)
        is_alike = written.rpartition("/")[2] == part.short_type
        other = "stamped" if stamped(part.type_name) in player.types else "alike" if is_alike else "wrong"
        level = other if written else "untold"
    seen = {"type": shown(written), "topic": shown(player.topic)}
    return Answer(level, seen, (player.key,), seen["topic"])


def _written_type(case: Case, player: Player) -> str:
    """Return a topic's type; the one in the code if only that, or a stand-in, was seen; empty if it is no message's."""
    seen = "" if player.is_read else next(iter(player.types), "")
    ends = [end for end in case.evidence.files.ends if end.topic == player.topic and end.type_name]
    name = next((end.type_name for end in ends), seen) if seen in ("", STAND_IN) else seen
    return name if "/msg/" in name else ""


@question(
    "lives waits dies ends cut stops silent missing",
    "program last end topic after needed",
    CODES,
    mute="dies ends stops silent",
)
def goes_on(case: Case, part: Part) -> Answer:
    """Whether a node that publishes lives and goes on, whatever is said.

    An end by a command counts at the node whose commands are judged, if that is in the same program; an end by
    a request counts at the service.
    """
    player = case.whole(part)
    seen = {"program": "", "last": "", "end": "", "topic": "", "after": "a few messages", "needed": ""}
    if player is None:
        return Answer("missing", seen, ("runs",))
    seen |= {"program": shown(player.program or player.node), "topic": shown(player.topic)}
    key = (f"runs[{player.number}].ended",)
    its_own = of_one_node(case.players[part.name], player)
    alike = [candidate for candidate in its_own if candidate.match == player.match]
    for one in (player, *(one for one in alike if one.program == player.program and one.is_ended_by_command)):
        if one.end is not None and one.run.setting != GIVEN and not _dies_of_command(case, one):
            word = f"after {_said(one.last_command)}," if one.last_command else "by itself"
            seen |= {"last": last_word(one.end), "end": ended(one.end, f"{word} with", is_done=one.is_done)}
            is_error = "Error" in one.end or "Exception" in one.end
            level = "cut" if is_limit(one.end) else "dies" if is_error else "ends"
            return Answer(level, seen, (f"runs[{one.number}].ended",), raised_at(case, one.end, one.program))
    if any(candidate.topic in candidate.run.stalled for candidate in alike):
        return Answer("stops", seen, (f"runs[{player.number}].stalled",), shown(player.node))
    for one in alike:
        if (number := _silenced_at(one, case.assignment.commanded)) is not None:
            seen["after"] = _said(one.run.commands[number])
            return Answer("stops", seen, (f"runs[{one.number}].commands[{number}]",), shown(one.node))
    is_silent = not any(candidate.is_heard for candidate in its_own)
    seen["needed"] = _needed(case, part, player)
    level = "silent" if is_silent else "waits" if seen["needed"] else "lives"
    return Answer(level, seen, key, shown(player.node))


def _needed(case: Case, part: Part, player: Player) -> str:
    """Return what a part's node was silent without, and only the grader brings; empty if there is nothing of that kind."""
    program, commanded = case.executables.get(player.program), case.assignment.commanded
    if player.run.setting != GIVEN or program is None or program.absent or lost_sister(case, part):
        return ""
    alone = [run for run in case.evidence.runs if run.setting == "alone" and run.programs == [program.name]]
    own = {name for run in alone for name in (*run.waits, run.commanded)} - {commanded and commanded.topic}
    return shown(" and ".join(name for name in player.run.given if name in own))


def _said(command: CommandSeen) -> str:
    return f"{shown(command.text)!r} was said" if command.text else "an empty command"


def _silenced_at(player: Player, commanded: Part | None) -> int | None:
    """Return the number of the command from which on nothing came any more of what came again and again before.

    What is asked for by time goes on whatever is said. What is not may stop at a command, and if it has stopped at
    another word, any command may begin it again. What a word of the node's own does is its own.
    """
    run = player.run
    if commanded is None or player.topic in run.torn or not _is_heard_out(run, commanded):
        return None
    heard = [topics[player.topic].count if player.topic in topics else 0 for topics in run.stretches]
    number = max((number for number, count in enumerate(heard) if count), default=0) - len(run.calls)
    if number not in range(len(run.commands)) or max(heard) < 2:
        return None
    text, *after = (command.text for command in run.commands[number:])
    ours = (*commanded.commands, *commanded.unknown, *(word.upper() for word in commanded.commands))
    if number > 0 and text not in ours:  # the words that are said first are nobody's own
        return None
    if player.part.period:
        return number if len(after) + 1 >= LEAST_SILENT else None
    return number if text not in commanded.commands and {*commanded.commands} <= {*after} else None


def _is_heard_out(run: Run, commanded: Part) -> bool:
    """Return whether all commands were said and listened after, for as long as messages take.

    On the real clock, commands may follow each other more quickly than messages.
    """
    is_told = run.commanded == commanded.topic and run.clock == "stepped" and not run.given
    return is_told and run.setting in PLAIN_SETTINGS and not run.unfinished and not run.ended


def missing(case: Case, part: Part) -> Answer:
    """Answer for a node that was not seen, or is not the submission's own, with the likely reason."""
    reasons = (_foreign, _shut_out, _lost, _turned, _hidden)
    answers = itertools.chain.from_iterable(why(case, part) for why in reasons)
    return next(answers, Answer("missing", {"why": ""}, ("runs",)))


def _foreign(case: Case, part: Part) -> Iterator[Answer]:
    """Yield an answer if a node is there that no code of the submission makes."""
    ends = "publishes" if part.is_publisher else "subscribes"
    for number, run in enumerate(case.evidence.runs if case.is_foreign(part) else ()):
        for node in getattr(run, ends).get(part.topic, ()):
            why = f", except {shown(node)}, which no code that was handed in makes"
            yield Answer("missing", {"why": why}, (f"runs[{number}].{ends}",), shown(node))


def _shut_out(case: Case, part: Part) -> Iterator[Answer]:
    """Yield an answer if the part's program runs only alone."""
    if lone := case.shut_out_of(part):
        how = ended(case.shut_out[lone], "ends with") if case.shut_out[lone] else "does nothing"
        why = f", for {shown(lone)} {how} beside the other programs"
        number = next(n for n, run in enumerate(case.evidence.runs) if run.setting == "together")
        yield Answer("missing", {"why": why}, (f"runs[{number}]",), shown(lone))


def _lost(case: Case, part: Part) -> Iterator[Answer]:
    """Yield an answer for each program that may have the node, and crashed or cannot be started."""
    playing = [player.run for players in case.players.values() for player in players]
    crashed = {
        name: (number, end)
        for number, run in enumerate(case.evidence.runs)
        if run.setting == "alone" and not any(played is run for played in playing)
        for name, end in run.ended.items()
        if not is_for_want(end, case.executables.get(name), case.evidence.files)
        if name not in run.done or tells_error(end) or _makes(case, name, part)
    }
    started = {one.stem for one in case.executables.values() if one.command} - {""}  # also by another way
    dead = [n for n, one in case.executables.items() if not one.command and one.stem not in started]
    lost = [name for name in (*crashed, *dead) if case.may_be(name, part)]
    for name in sorted(lost, key=lambda name: case.assignment.meant_by(name) is not part):
        place = shown(name)
        if name in crashed:
            number, end = crashed[name]
            is_done = name in case.evidence.runs[number].done
            why = f": {place} ended {ended(end, 'with', is_done=is_done)}"
            yield Answer("missing", {"why": why}, (f"runs[{number}].ended.{place}",), place)
        else:
            why = f": {place} cannot be started ({shown(case.executables[name].fault, 120).rstrip('.')})"
            yield Answer("missing", {"why": why}, ("build.executables",), place)


def _makes(case: Case, program: str, part: Part) -> bool:
    """Return whether a program's modules make an end on a part's topic, or nearly that one, or may do so."""
    executable = case.executables.get(program)
    modules = {*executable.modules, executable.stem} if executable else set[str]()
    ends = [end for end in case.evidence.files.ends if end.module in modules and may_end(end, part)]
    return any(end.topic in ("", part.topic) or is_near_topic(end.topic, part.topic) for end in ends)


def _turned(case: Case, part: Part) -> Iterator[Answer]:
    """Yield an answer for each node that publishes where it should subscribe."""
    for number, run in enumerate(case.evidence.runs if not part.is_publisher else ()):
        for node in run.publishes.get(part.topic, ()):
            why = f": {shown(node)} publishes on it, where a subscription is needed"
            yield Answer("missing", {"why": why}, (f"runs[{number}].publishes",), shown(node))


def _hidden(case: Case, part: Part) -> Iterator[Answer]:
    """Yield an answer if messages came on the topic, and ROS showed no node that publishes there."""
    for number, run in enumerate(case.evidence.runs if part.is_publisher else ()):
        if part.topic in run.quiet and part.topic not in run.publishes:
            why = ", although messages came on it: ROS shows no node to which they belong, as with `ros2 topic pub`"
            yield Answer("missing", {"why": why}, (f"runs[{number}].quiet.{part.topic}",))


def _dies_of_command(case: Case, player: Player) -> bool:
    """Return whether a player's program ended by a command that it takes, or by a request to its service."""
    if any(
        not call.is_alive and call.service == provider.topic and provider.program == player.program
        for part in case.assignment.services
        for provider in case.players[part.name]
        for call in provider.run.calls
        if provider.number == player.number
    ):
        return True
    commanded = case.assignment.commanded
    if player.last_command is None or commanded is None:
        return False
    if player.run.commanded != commanded.topic:
        return True  # the topic was only our guess for the one with the commands
    judged = case.whole(commanded)
    return any(
        taker.program == player.program and taker.number == player.number
        for taker in case.players[commanded.name]
        if judged and (taker.program == judged.program or player.run.setting == "launched")
    )
