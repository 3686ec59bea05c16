"""Words on the command topic that change nothing, although the code compares what it receives with them."""

from __future__ import annotations

import ast
import itertools
import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.topic_faults import word_sources
from ros2lab.diagnose.sources.bindings import bindings
from ros2lab.diagnose.sources.joined_texts import text_of
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, own_nodes, walk
from ros2lab.grading.code.compared import compared
from ros2lab.grading.code.running import running
from ros2lab.grading.evidence import CommandSeen, Run
from ros2lab.grading.senses import sense
from ros2lab.trial.contents import has_text, leaves_of, numbers_of
from ros2lab.trial.ends import UNKNOWN_WORD, made
from ros2lab.trial.record import Record

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen

LONGEST_WORD = 30  # letters
MORE = 1.6  # times as many messages are no chance
Leads = dict[str, list[tuple[PythonSource, list[ast.AST]]]]  # the code that a word leads to, with its file
_ON_STATE = (ast.If, ast.For, ast.While, ast.Match, ast.BoolOp)  # what may pass over what is in it


def own_words(look: Look) -> list[str]:
    """Return the words with which the code of a workspace compares texts."""
    files = (running(word_sources(look.sources(package))) for package in look.packages)
    words = dict.fromkeys(word for code in files for word in compared(node for _, node in code))
    return [word for word in words if word and not word.startswith("__")]


def untaken(seen: Seen, record: Record) -> set[str]:
    """Return the programs that were sent words of which it is not known whether they take any."""
    known = {*own_words(seen.look), *record.asked_beside(UNKNOWN_WORD)}
    sent = {run.programs[0]: {command.text for command in run.commands} for run in seen.alone}
    return {name for name, words in sent.items() if words and known.isdisjoint(words)}


def word_faults(seen: Seen) -> Iterator[Finding]:
    """Yield words that have the same effect as a word that no node can know.

    A word counts if any node reacts to it in any state. Where it was sent in one state only, that may be the state
    that it leads to: then it is no fault if the code that it leads to ran, or may pass over what is in it.
    """
    topic = seen.command_topic
    runs = [run for run in seen.alone if run.commands and topic in run.subscribes and not run.unasked]
    files = [word_sources(seen.look.sources(package)) for package in seen.look.packages]
    leads = _leading([pair for sources in files for pair in running(sources)])
    sent, alive = _sent(runs, leads), _alive(runs) | made(seen)
    dead = [word for word in sent if word not in alive and word != UNKNOWN_WORD]
    if not dead or (len(dead) < len(sent) and any(map(_heeds_any_word, runs))):
        return
    is_all = len(dead) == len(sent) > 1
    refuting = {word: () if is_all else _refuting(runs, leads, word) for word in dead}
    word, never = next(((word, found) for word, found in refuting.items() if found is not None), ("", ()))
    if not word:
        return
    ends = seen.ends(topic, is_publisher=False)
    asking = dict.fromkeys(end.creation.source for end in ends)
    named = (s.at(n) for s in asking for n in s.nodes if text_of(n).strip().lower() == word.lower())
    place = next(named, "") or seen.place(topic, is_publisher=False)
    cause, fix = _all_dead(topic, dead) if is_all else _one_dead(topic, word, leads)
    yield Finding("word-unanswered", cause, place, fix, never=never)


def _refuting(runs: Sequence[Run], leads: Leads, word: str) -> tuple[str, ...] | None:
    """Return the places of what would do something after a word if it ran; None if that cannot be told."""
    pairs = (pair for run in runs for pair in itertools.pairwise(run.commands))
    states = {_effect(before) for before, command in pairs if command.text == word}
    bodies = leads.get(word, []) if len(states) < 2 else []
    if any(isinstance(node, _ON_STATE) for _, body in bodies for node in body):
        return None
    return tuple(place for source, body in bodies for place in _changing(source, body))


def _leading(code: Iterable[tuple[PythonSource, ast.AST]]) -> Leads:
    """Return the words with which some code compares a whole text that it has received, and where they lead."""
    found: Leads = {}
    for source, node in code:
        around, body = source.above(node), list[ast.AST]()
        while isinstance(around, (ast.BoolOp, ast.MatchOr, ast.MatchAs)):
            body = [around] if isinstance(getattr(around, "op", None), ast.And) else body
            around = source.above(around)
        sides = list[ast.expr]()
        match node, around, source.above(around) if around else None:
            case ast.Compare(left=left, comparators=others), _, _:
                sides = [side for side in (left, *others) if not text_of(side)]
            case ast.MatchValue(), ast.match_case(), ast.Match(subject=subject):
                sides = [subject]
            case ast.Dict(keys=keys, values=values), _, _:
                for key, value in zip(keys, values, strict=True):
                    found.setdefault(text_of(key), []).append((source, [*walk(value)]))
        if isinstance(around, (ast.If, ast.match_case)):
            body += [inner for part in around.body for inner in walk(part)]
        for word in compared([node]) if sides and all(_is_whole(source, side) for side in sides) else ():
            found.setdefault(word, []).append((source, body))
    return found


def _is_whole(source: PythonSource, node: ast.expr, depth: int = 5) -> bool:
    """Return whether an expression may hold a whole text that was received, and not a part of it."""
    match node:
        case (
            ast.Call(func=ast.Name(id="str"), args=[inner])
            | ast.Call(
                func=ast.Attribute(attr="strip" | "lstrip" | "rstrip" | "lower" | "casefold", value=inner)
            )
            | ast.NamedExpr(value=inner)
        ):
            return _is_whole(source, inner, depth)
        case ast.Name(id=name) if depth:
            function = source.function_at(node.lineno)
            given = bindings(own_nodes(function), name) if function else ()
            return all(not path and _is_whole(source, value, depth - 1) for value, path in given)
    return isinstance(node, (ast.Attribute, ast.Name))


def _changing(source: PythonSource, body: Iterable[ast.AST]) -> Iterator[str]:
    """Yield the places of what changes a state: a function, a call, or what is assigned to a name that is read."""
    loaded = {(type(n), last_name(n)) for n in source.nodes if isinstance(getattr(n, "ctx", None), ast.Load)}
    for node in body:
        stored = {
            (type(n), last_name(n)) for n in walk(node) if isinstance(getattr(n, "ctx", None), ast.Store)
        }
        if isinstance(node, ast.Expr) or (isinstance(node, ast.stmt) and stored & loaded):
            yield source.at(node)
        yield from (
            source.at(n) for n in source.nodes if isinstance(n, Function) and n.name == last_name(node)
        )


def _all_dead(topic: str, words: Sequence[str]) -> tuple[str, str]:
    """Return cause and fix for words that all have the same effect as an unknown one."""
    cause = f"After each of the words {', '.join(words)} on {topic}, the nodes do the same as after {UNKNOWN_WORD!r}, which means nothing."
    fix = "let the callback change an attribute of self (self.state = ...), compare msg.data with ==, and after lower() compare only with lower-case words"
    return cause, fix


def _one_dead(topic: str, word: str, own: Iterable[str]) -> tuple[str, str]:
    """Return cause and fix for a word that changes nothing, beside others that do."""
    like = next((other for other in own if other.lower() == word.lower() and other != word), "")
    cause = (
        f"The word {word!r} on {topic} changes nothing{f'; the code compares with {like!r}' if like else ''}."
    )
    fix = f"compare msg.data.strip().lower() with {word.lower()!r}, in lower case"
    if not like and word == word.lower():
        fix = f"look at what comes before the comparison with {word!r}, such as a return, and at what it leads to"
    return cause, fix


def _sent(runs: Sequence[Run], own: Collection[str]) -> list[str]:
    """Return the commands that the code names, in any case; the others need not do anything."""
    named = {text.strip().lower() for text in own}
    sent = dict.fromkeys(command.text for run in runs for command in run.commands)
    return [
        word
        for word in sent
        if word.strip().lower() in named and len(word) < LONGEST_WORD and not word.isupper()
    ]


def _alive(runs: Sequence[Run]) -> set[str]:
    """Return the commands after which a node does something else than after the unknown one before."""
    return {
        command.text
        for run in runs
        for before, command in itertools.pairwise(run.commands)
        if before.text == UNKNOWN_WORD
        and (_effect(before) != _effect(command) or _has_other_pace(before, command))
    }


def _has_other_pace(before: CommandSeen, command: CommandSeen) -> bool:
    """Return whether much more or fewer messages came on a topic than after the command before."""
    counts = (
        sorted((heard.count, before.topics[topic].count))
        for topic, heard in command.topics.items()
        if topic in before.topics
    )
    return any(most > MORE * least and most - least > 1 for least, most in counts)


def _heeds_any_word(run: Run) -> bool:
    """Return whether an unknown word changes what is published, so that comparing with it says nothing."""
    return any(
        sense(before.topics[topic].values) != sense(heard.values)
        for before, command in itertools.pairwise(run.commands)
        if command.text == UNKNOWN_WORD
        for topic, heard in command.topics.items()
        if heard.values and topic in before.topics and before.topics[topic].values
    )


def _effect(command: CommandSeen) -> str:
    """Return what followed a command, without the word itself and without numbers in log messages."""
    texts = [re.sub(r"\d+", "#", text) for _, text in command.log]
    texts += [_said_last(heard.values) for heard in command.topics.values() if heard.values]
    bare = {text.replace(command.text, "WORD") if command.text else text for text in texts}
    return "\n".join(sorted([*bare, *map(str, command.parameters.items())]))


def _said_last(values: Sequence[Any]) -> str:
    """Describe the last message: its content, and for numbers whether they are zero, constant or varying."""
    last, numbers = values[-1], [number for _, number in numbers_of(values[-1])]
    if has_text(last) or not numbers:
        return sense([*values])
    states = [leaf for leaf in leaves_of(last) if isinstance(leaf[1], bool)]
    if not any(numbers):
        return f"still {states}"
    return str(last) if len(values) > 1 and values[-2] == last else f"varying {states}"
