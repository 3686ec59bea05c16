"""The node that takes commands: what follows each of them.

A command is processed if something follows it that does not follow any word: a log line of its own, another
velocity, another status, a parameter, a message where there was none. A node that only repeats the word in its log
has received it; if its source compares something with each of the words, it is believed to do more with them inside.
How a program moves the robot is nobody's business here.
"""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ros2lab.grading.evidence import CommandSeen, Heard, Run
from ros2lab.grading.questions import nodes
from ros2lab.grading.questions.answer import Answer, last_word, listed, question, raised_at, shown
from ros2lab.grading.questions.velocity import is_still
from ros2lab.grading.roles import COMMAND, STAMPED, TWIST, VELOCITY, Case, Part

WORDS = ("start", "stop", "reset")
UNKNOWN = ("dance", "")
VERY_MANY = "very many commands"

_REFUSAL = re.compile(
    r"unknown|invalid|unrecogni|not (?:an? )?(?:recogni|known|valid|support|\w*command)|no such|unsupported|undefined|refus|ignor|"
    r"unbekannt|ungültig|inconnu|invalide|desconocid|inválid|sconosciut|nieznan|onbekend|okänd|bilinmeyen|"
    r"неизвестн|未知|不明",
    re.IGNORECASE,
)
_RUNS = re.compile(r"\b(running|runs|start(ed|ing|s)|moving|moves|driving|drives|active)\b", re.IGNORECASE)
_STANDS = re.compile(r"\b(stopp(ed|ing)|stops|halt(ed|s)|stand(s|ing)|paused)\b", re.IGNORECASE)
_NEGATED = re.compile(r"\b(?:not|never|no longer|no more|was|were)\b|n't\b", re.IGNORECASE)


@question("right doubled near other missing", "topic node why", nodes.CODES | nodes.TOPIC_CODES)
def command_topic(case: Case) -> Answer:
    """Whether a node subscribes to /robot/command."""
    return nodes.topic(case, COMMAND)


@question("right wrong missing", "type topic", nodes.CODES | nodes.TYPE_CODES)
def command_type(case: Case) -> Answer:
    """Whether a command is a String."""
    answer = nodes.type_(case, COMMAND)
    return (
        Answer("wrong", answer.seen, answer.evidence, answer.place) if answer.level == "stamped" else answer
    )


@question(
    "all told_apart until_end two one echoed inverted capitals none untried missing",
    "unprocessed",
    nodes.CODES,
)
def commands_are_processed(case: Case) -> Answer:
    """Whether each of the three commands has an effect."""
    parts = case.parts[COMMAND]
    if not parts:
        return Answer("missing", {"unprocessed": ""}, ("runs",))
    runs = {part.number: part.run for part in parts if part.run.commands}
    telling = {id(part.run): part.run for part in _telling_parts(parts)}
    if not runs:
        return Answer("untried", {"unprocessed": ""}, (parts[0].key,), shown(parts[0].node))
    alone = _alone(case)
    effects = {number: _effects(run, alone, has_own_log=id(run) in telling) for number, run in runs.items()}
    processed = {word for found in effects.values() for word, how in found.items() if how == "processed"}
    echoed = {word for found in effects.values() for word, how in found.items() if how == "echoed"}
    processed |= _is_so_already(case, effects)
    unsent = _unsent(runs.values())
    believed = _believed(case, effects) - processed - unsent
    level = ("none", "one", "two", "all")[len(processed | unsent | believed)]
    if level == "all" and (unsent or believed):
        level = "told_apart" if believed else "until_end"
    elif not processed and echoed and not unsent and level != "two":
        level = "echoed"
    elif {"start", "stop"} <= processed and any(map(_is_inverted, telling.values())):
        level = "inverted"
    elif not processed and any(_obeys_capitals(run, alone) for run in runs.values()):
        level = "capitals"
    known = processed | unsent if level == "told_apart" else processed | unsent | believed
    rest = listed([word for word in WORDS if word not in known])
    best = max(effects, key=lambda number: sum(how == "processed" for how in effects[number].values()))
    keys = [
        f"runs[{best}].commands[{index}]"
        for index, one in enumerate(runs[best].commands)
        if one.text in WORDS
    ]
    return Answer(level, {"unprocessed": rest}, tuple(keys[:3]), shown(parts[0].node))


@question("all until_end some unspecific none untried missing", "silent", nodes.CODES | {"logger-arguments"})
def commands_are_logged(case: Case) -> Answer:
    """Whether a log line, or a printed one, tells of each command."""
    parts = case.parts[COMMAND]
    if not parts:
        return Answer("missing", {"silent": ""}, ("runs",))
    runs = _telling_parts(parts)
    if not runs:
        return Answer("untried", {"silent": ""}, (parts[0].key,), shown(parts[0].node))
    logged = {word for part in runs for word in WORDS if _telling(part.run, word)}
    has_any = any(_lines(one) - _by_itself(part.run) for part in runs for one in part.run.commands)
    level = "all" if len(logged) == len(WORDS) else "some" if logged else "unspecific" if has_any else "none"
    unsent = _unsent(part.run for part in runs)
    if level == "some" and logged | unsent == {*WORDS}:
        level = "until_end"
    silent = listed([word for word in WORDS if word not in logged | unsent])
    return Answer(level, {"silent": silent}, (f"runs[{runs[0].number}].commands",), shown(runs[0].node))


@question("lives moves deaf dies ends unseen untried missing", "command last program", nodes.CODES)
def commands_do_no_harm(case: Case) -> Answer:
    """Whether unknown and empty commands, and a thousand of them, leave the node alive and the robot at rest."""
    part = case.whole(COMMAND)
    seen = {"command": "", "last": "", "program": ""}
    if part is None:
        return Answer("missing", seen, ("runs",))
    seen["program"] = shown(part.program or part.node)
    key = f"runs[{part.number}].commands"
    if part.end is not None:
        return _end(part, seen)
    mover = next(filter(None, map(_mover, case.parts[COMMAND])), None)
    if not part.run.commands:
        level, key = "untried", part.key
    elif mover is not None:
        level, seen["command"] = "moves", _named(mover.text)
    elif not _is_answered(case):
        level = "unseen"
    elif _is_deaf(part.run):
        level, seen["command"] = "deaf", _last_answered(part.run)
    else:
        level = "lives"
    return Answer(level, seen, (key,), shown(part.node))


def _is_answered(case: Case) -> bool:
    """Return whether anything at all follows a command that does not come by itself."""
    parts, alone = case.parts[COMMAND], _alone(case)
    return any(
        _changes(part.run, one, alone) or one.parameters for part in parts for one in part.run.commands
    ) or any(
        _lines(one) - _by_itself(part.run) for part in _telling_parts(parts) for one in part.run.commands
    )


def _end(part: Part, seen: dict[str, str]) -> Answer:
    seen = seen | {"last": last_word(part.end or "")}
    deadly, place = part.last_command, raised_at(part.end or "", part.program)
    if deadly is None:
        return Answer("ends", seen, (f"runs[{part.number}].ended",), place)
    seen["command"] = _named(deadly.text)
    key = f"runs[{part.number}].commands[{part.run.commands.index(deadly)}]"
    return Answer("dies", seen, (key,), place)


# --- what followed ----------------------------------------------------------------------------------------


def _unsent(runs: Iterable[Run]) -> set[str]:
    """Return the words that could not be tried, because an earlier one was a node's end; that counts elsewhere."""
    sent = set()
    for run in runs:
        for one in run.commands:
            sent.add(one.text)
            if not one.is_alive:
                break
    return {*WORDS} - sent


def _telling_parts(parts: list[Part]) -> list[Part]:
    """Return the parts whose logs are the node's own: those where its program ran alone, if there are any."""
    tried = [part for part in parts if part.run.commands]
    return [part for part in tried if part.run.setting == "alone"] or tried


def _alone(case: Case) -> dict[str, Heard]:
    """Return what programs published on each topic while they were alone and had no command."""
    return {
        topic: heard
        for run in case.evidence.runs
        if run.setting == "alone"
        for topic, heard in run.quiet.items()
    }


def _effects(run: Run, alone: Mapping[str, Heard], *, has_own_log: bool) -> dict[str, str]:
    """Tell of each word whether it was `processed`, only `echoed`, or `shared` its line with unknown words alone.

    Of words that nothing follows it tells nothing.
    """
    found: dict[str, str] = {}
    by_text = {one.text: one for one in reversed(run.commands)}  # the first of each
    said = [_templates(by_text[word]) for word in WORDS if word in by_text]
    known = set().union(*said)
    unknown = _templates(by_text["dance"]) if "dance" in by_text else set()
    # What is said of an unknown word alone shows that the others are known.
    refuses = bool(unknown - known - _by_itself(run))
    for word in WORDS:
        one = by_text.get(word)
        if one is None:
            continue
        telling = _telling(run, word) if has_own_log else set()
        own = {_template(line, word) for line in telling}
        refused = {line for line in own & unknown if _REFUSAL.search(line)}
        if not one.is_alive and "dance" not in by_text:
            own -= set[str].intersection(known, *said)  # that it was heard, but not that it was obeyed
        heard_elsewhere = set().union(*(_templates(by_text[w]) for w in WORDS if w != word and w in by_text))
        # A line that this word shares with an unknown one, and with no other word, says that it is not known.
        is_refused = bool(refused or (own & unknown) - heard_elsewhere)
        if _changes(run, one, alone) or one.parameters or own - unknown or (own and refuses):
            found[word] = "processed"
        elif own:
            found[word] = "shared" if is_refused else "echoed"
    return found


def _believed(case: Case, effects: Mapping[int, Mapping[str, str]]) -> set[str]:
    """Return the words of which only a log tells, and never as of unknown ones, and with which the code compares."""
    files = case.evidence.files
    if any(code == "message-compared" for code, *_ in files.findings):
        return set()
    return {
        one.text
        for number, found in effects.items()
        for one in case.evidence.runs[number].commands
        if one.text in found.keys() & {*files.compared}
        and not any(map(_REFUSAL.search, _lines(one) - _by_itself(case.evidence.runs[number])))
    }


def _is_so_already(case: Case, effects: Mapping[int, Mapping[str, str]]) -> set[str]:
    """Return the words that were heard, and show by nothing what is so already.

    The robot stands when reset comes behind stop, and it may drive from the beginning on, and until stop.
    """
    runs = case.evidence.runs
    heard = {
        one.text
        for number, found in effects.items()
        for one in runs[number].commands
        if one.is_alive and found.get(one.text) == "echoed"
    }
    processed = {word for found in effects.values() for word, how in found.items() if how == "processed"}
    drives = any(
        _stands(part.run.quiet.get(part.topic)) is False
        and any(_stands(one.topics.get(part.topic)) for one in part.run.commands if one.text == "stop")
        for part in case.parts[VELOCITY]
    )
    so = {"start"} if drives else set()
    so |= {"reset"} if {"start", "stop"} <= processed | so else set()
    return so & heard


def _is_inverted(run: Run) -> bool:
    """Return whether all that follows start speaks of a robot that stands, and all that follows stop of one that runs."""
    said = {
        one.text: " ".join(
            text
            for text in (*_lines(one), *(str(v) for heard in one.topics.values() for v in heard.values))
            if not _NEGATED.search(text)
        )
        for one in reversed(run.commands)
    }
    start, stop = said.get("start", ""), said.get("stop", "")
    return bool(
        _STANDS.search(start) and not _RUNS.search(start) and _RUNS.search(stop) and not _STANDS.search(stop)
    )


def _obeys_capitals(run: Run, alone: Mapping[str, Heard]) -> bool:
    """Return whether something follows START that does not follow an unknown word, nor comes by itself."""
    by_text = {one.text: one for one in run.commands}
    if not {"START", "dance"} <= by_text.keys():
        return False
    one = by_text["START"]
    common = _templates(by_text["dance"]) | _by_itself(run)
    return bool(_changes(run, one, alone) or one.parameters or _templates(one) - common)


def _lines(one: CommandSeen) -> set[str]:
    """Return what was said after a command, without what a program prints when it dies of it."""
    return {_steady(text) for level, text in one.log if one.is_alive or level != "PRINT"}


def _telling(run: Run, word: str) -> set[str]:
    """Return the lines after a command that do not come whatever the command is.

    What came before any command, and comes after another one as well, comes by itself; but what was said once
    before, and follows no unknown word, tells of a state that a command brings back.
    """
    parts = {one.text: _lines(one) for one in reversed(run.commands) if one.text in (*WORDS, *UNKNOWN)}
    if word not in parts:
        return set()
    common = set.intersection(*(lines for text, lines in parts.items() if text)) if len(parts) > 1 else set()
    others = set().union(*(lines for text, lines in parts.items() if text != word))
    after_unknown = set().union(*(lines for text, lines in parts.items() if text in UNKNOWN))
    again = {line for line, count in Counter(_steady(text) for _, text in run.log).items() if count > 1}
    return parts[word] - common - (others & again) - (after_unknown & _by_itself(run))


def _by_itself(run: Run) -> set[str]:
    """Return the lines that came before any command."""
    return {_steady(text) for _, text in run.log}


def _steady(text: str) -> str:
    """Return a text without its numbers, which change by themselves."""
    return re.sub(r"\d+(?:\.\d+)?(?:e-?\d+)?", "#", text)


def _template(line: str, word: str) -> str:
    return re.sub(re.escape(word), "{}", line, flags=re.IGNORECASE) if word else line


def _templates(one: CommandSeen) -> set[str]:
    return {_template(line, one.text) for line in _lines(one)}


def _changes(run: Run, one: CommandSeen, alone: Mapping[str, Heard]) -> bool:
    """Return whether a topic says something else after a command than before, or something where nothing came."""
    before = run.commands[: run.commands.index(one)]
    quiet = {**alone, **run.quiet}
    for topic, heard in one.topics.items():
        earlier = [part[topic] for part in (quiet, *(c.topics for c in before)) if topic in part]
        if not heard.values:
            continue
        sense = _sense(heard.values)
        if topic in quiet and sense in _by_turns(quiet[topic]):
            continue
        before_it = _sense(earlier[-1].values) if earlier and earlier[-1].values else ""
        # A ramp ends by itself.
        is_ramp = topic in quiet and quiet[topic].values and _sense(quiet[topic].values) == "varying"
        if before_it != sense and not (is_ramp and before_it and "still" not in (before_it, sense)):
            return True
        is_stream = topic in quiet or heard.count > 1 or earlier[-1].count > 1
        if not is_stream:
            return True
    return False


def _by_turns(quiet: Heard) -> set[str]:
    """Return what a topic says by turns before any command; nothing of one that changes once, or is a velocity."""
    senses = [_sense([value]) for value in quiet.values]
    return {*senses} if _turns(senses) > 1 and "still" not in senses else set()


def _turns(values: Sequence[object]) -> int:
    return sum(one != other for one, other in itertools.pairwise(values))


def _sense(values: list[Any]) -> str:
    """Return what messages say last, without what changes by itself."""
    last = values[-1]
    if not isinstance(last, dict) or "linear" not in str(last):
        return _steady(str(last))
    if is_still(last):
        return "still"
    is_steady = len(values) > 1 and values[-2] == last
    return str(last) if is_steady or len(values) == 1 else "varying"


def _mover(part: Part) -> CommandSeen | None:
    """Return the unknown command after which a robot moves that stood before it."""
    stands = True
    for topic in [
        t for t, nodes_ in part.run.publishes.items() if any({TWIST, STAMPED} & {*k} for k in nodes_.values())
    ]:
        quiet = part.run.quiet.get(topic)
        stands = not quiet or all(map(is_still, quiet.values))
        if quiet and _turns([*map(is_still, quiet.values)]) > 1:
            continue  # it moves and stands by itself
        for one in part.run.commands:
            heard = one.topics.get(topic)
            if heard and heard.values:
                if one.text in UNKNOWN and stands and not is_still(heard.values[-1]):
                    return one
                stands = is_still(heard.values[-1])
    return None


def _is_deaf(run: Run) -> bool:
    """Return whether a node that answered the first command answers none after the flood."""
    texts = [one.text for one in run.commands]
    if texts.count("start") < 2 or texts[-1] != "start" or not _telling(run, "start"):
        return False
    last = list(itertools.takewhile(lambda one: one.text == "start", reversed(run.commands)))
    return not any(_is_heeded(run, one) for one in last)


def _is_heeded(run: Run, one: CommandSeen) -> bool:
    """Return whether something follows a command that does not follow whatever comes.

    What follows an unknown word as well as stop or reset comes by itself, such as from a loop in which a node is caught.
    """
    unknown, others = (
        set[str]().union(*(_lines(one) for one in run.commands if one.text in texts))
        for texts in (UNKNOWN, WORDS[1:])
    )
    return bool(_lines(one) - _by_itself(run) - (unknown & others) or one.topics)


def _last_answered(run: Run) -> str:
    """Name what a deaf node answered last: the flood, or what came before a known word that it did not answer."""
    said = [*itertools.takewhile(lambda one: " x " not in one.text, run.commands)]
    last = max((number for number, one in enumerate(said) if _is_heeded(run, one)), default=0)
    return _named(said[last].text) if any(one.text in WORDS for one in said[last + 1 :]) else VERY_MANY


def _stands(heard: Heard | None) -> bool | None:
    """Return whether a robot stands by its last velocity; None if there is none."""
    return is_still(heard.values[-1]) if heard and heard.values else None


def _named(text: str) -> str:
    if " x " in text:  # the observer's name for the flood
        return VERY_MANY
    return f"the command {shown(text)!r}" if text else "an empty command"
