"""Describes what a program did while it ran, for a student who sees nothing wrong in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from ros2lab.diagnose.finding import in_a_row
from ros2lab.diagnose.nodes.hidden_logs import hidden_logs
from ros2lab.diagnose.nodes.service_faults import service_ends
from ros2lab.diagnose.nodes.spin_loops import stands_still
from ros2lab.diagnose.sources.python_source import PythonSource, read_text
from ros2lab.every_node import HIDDEN_TOPICS, OF_MANAGED
from ros2lab.grading.evidence import Run
from ros2lab.grading.judging.player import finds_no_keyboard
from ros2lab.trial.ends import lacks_arguments, word_that_ended
from ros2lab.trial.spoken import LEAST_EVEN, Sent, content, counted, even_gap, rhythm, unstamped
from ros2lab.trial.unmade import unmade_notes

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen
    from ros2lab.trial.witnessed import Called

# What a program may wait for, besides messages.
_ASKS = frozenset(
    (
        "create_service",
        "create_client",
        "input",
        "stdin",
        "add_on_set_parameters_callback",
        "ActionServer",
        "ActionClient",
    )
)


def told_of(seen: Seen, run: Run, called: Called) -> str:
    """Describe in a sentence what a program published, received and did not receive, and whether it ended.

    Args:
        seen: all runs.
        run: the run of this program alone.
        called: the functions that were called in any run.
    """
    name, sent = run.programs[0], sent_by(seen, run)
    parts = [_published(seen, run, topic, found) for topic, found in sent.items()]
    publishes = own_ends(run, run.publishes, *(other.publishes for other in seen.together))
    silent = [topic for topic in publishes if topic not in sent and not topic.endswith(OF_MANAGED)]
    why = _unasked(seen, run)
    parts += [
        f"has a publisher on {topic}, but published nothing there{why} while it was watched"
        for topic in silent
    ]
    subscribes = own_ends(run, run.subscribes, *(other.subscribes for other in seen.together))
    parts += [f"subscribed to {topic}{_missed(seen, run, topic, called)}" for topic in subscribes]
    if run.ended:
        word = word_that_ended(run)
        alone = _ended(seen, run.ended.get(name) or "")
        parts.append(alone if word is None else f"ended when it was sent {word!r}")
    parts += _served(seen, seen.main(name))
    parts += [f"uses {topic}, which is not watched here" for topic in seen.unwatched(seen.main(name))]
    if run.log and not run.publishes and not run.subscribes:
        parts.append(f"printed {run.log[-1][1]!r}")
    parts = parts or ["neither published nor subscribed to anything"]
    shown = f"{name} {'; '.join([*parts, *unmade_notes(seen, run, called)])}."
    return " ".join([shown, *_standing(seen, run, called), *_unshown(seen, seen.main(name), called)])


def untried(seen: Seen) -> str:
    """Say what was not tried, and might show more."""
    ends = [end for package in seen.look.packages for end in service_ends(seen.look.sources(package))]
    goals = dict.fromkeys(
        f"goals for /{end.name.lstrip('/')}" for end in ends if end.is_action and end.is_server and end.name
    )
    is_asking = any(not seen.names(run).isdisjoint(("input", "stdin")) for run in seen.alone)
    parts = [*["a keyboard"] * is_asking, *goals, "what shows only later or on a robot"]
    return f"It has not tried {in_a_row(parts)}."


def _standing(seen: Seen, run: Run, called: Called) -> list[str]:
    """Return what is said of a loop that waits for messages, of a program that got none while it ran."""
    entrance, topics = seen.entrance(run.programs[0]), run.subscribes
    gets_nothing = bool(topics) and all(_missed(seen, run, topic, called) for topic in topics)
    if entrance is None or not gets_nothing or run.ended:
        return []
    return [
        f"{one.cause.rstrip('.')} ({one.place}): {one.fix}."
        for one in stands_still(entrance, gets_nothing=True)
    ]


def _ended(seen: Seen, said: str) -> str:
    """Describe how a program ended alone, by the last that it printed."""
    if finds_no_keyboard(said):
        return "asked the keyboard, where nobody types while it is watched"
    last = next(reversed(said.strip().splitlines()), "")
    printed = f"; the last that it printed is {last!r}" if last else ""
    without = ", run without the arguments that it reads" if lacks_arguments(seen, said) else ""
    return f"ended by itself{without}{printed}"


def _unshown(seen: Seen, file: str, called: Called) -> list[str]:
    """Return what is said of messages that the nodes of a file log when they run, and that nobody sees."""
    found = list[str]()
    if any("log-level" in read_text(path) for path in seen.look.launch_paths):
        return found
    for sources in map(seen.look.sources, seen.look.packages):
        for owner in (node for node in sources.nodes if node.source.shown == file):
            hidden = hidden_logs(sources, owner)
            if hidden and any(source == hidden.source for source, _ in called):
                place = hidden.source.at(hidden.calls[0])
                found.append(f"{hidden.why} ({place}): {hidden.fix}.")
    return found


def _served(seen: Seen, file: str) -> Iterator[str]:
    """Yield what is said of the services and actions that a file offers or calls."""
    ends = [end for package in seen.look.packages for end in service_ends(seen.look.sources(package))]
    served = {end.name for end in ends if end.is_server}
    own = (end for end in ends if end.name and end.creation.source.shown == file)
    for name, is_server in dict.fromkeys((end.name.lstrip("/"), end.is_server) for end in own):
        lone = ", which no program here offers" * (not {name, f"/{name}"} & served)
        yield f"offers /{name}" if is_server else f"calls /{name}{lone}"


def own_ends(run: Run, *ends: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return the topics that nodes of a program have among the ends in some runs."""
    nodes = {*run.nodes}
    return [
        *dict.fromkeys(topic for found in ends for topic, by in found.items() if not nodes.isdisjoint(by))
    ]


def sent_by(seen: Seen, run: Run) -> dict[str, Sent]:
    """Return what a program published by itself, by topic: in the run of all programs, or else alone.

    A program that was sent words did most when it was alone. What is known of it beside others is what it noted, or
    else what only its own nodes publish.
    """
    alone = _sent_in(seen, run, run, seen.said.alone)
    found = [_sent_in(seen, run, other, seen.said.together) for other in seen.together]
    beside = found[0] if found else {}
    few = {topic for topic, sent in beside.items() if sent.count < LEAST_EVEN <= alone.get(topic, sent).count}
    first, second = (alone, beside) if run.commands else (beside, alone)
    return {**second, **first, **{topic: alone[topic] for topic in few}}


def _sent_in(seen: Seen, run: Run, where: Run, said: Mapping[str, Mapping[str, Sent]]) -> dict[str, Sent]:
    """Return what a program published in a run, by topic."""
    name, own = run.programs[0], {*run.nodes}
    noted = {
        topic: sent
        for topic, sent in said.get(name, {}).items()
        if sent.count and topic not in HIDDEN_TOPICS and not topic.endswith(OF_MANAGED)
    }
    heard = {
        t: Sent.of_heard(stretches)
        for t, stretches in seen.heard(where).items()
        if own.issuperset(where.publishes.get(t, ()))
    }
    return {**heard, **noted} if where is run or name not in where.ended else {}


def _unasked(seen: Seen, run: Run) -> str:
    """Say of a program that published nothing that it may have waited; empty if all that it waits for came."""
    published = set().union(*map(seen.published, (*seen.alone, *seen.together)))
    is_waiting = not published.issuperset(run.subscribes)
    return " by itself" if is_waiting or not seen.names(run).isdisjoint(_ASKS) else ""


def _published(seen: Seen, run: Run, topic: str, sent: Sent) -> str:
    """Say how many messages a program published on a topic, in which rhythm, and with which content."""
    pace, what = pace_of(seen, run, topic)[1], content(sent.values)[0]
    sources = [
        source for package in seen.look.packages for source in seen.look.sources(package).sources.values()
    ]
    return f"published {counted(sent.count)} on {topic}{pace}{what}{unstamped(sent.values, sources)}"


def pace_of(seen: Seen, run: Run, topic: str) -> tuple[float, str]:
    """Return the time between the messages of a program on a topic, and what is said of it; 0 if that is not known."""
    for where in (run, *seen.together):
        heard, own, is_stepped = where.quiet.get(topic), {*run.nodes}, where.clock != "real"
        if heard and topic not in where.stalled and own.issuperset(where.publishes.get(topic, ())):
            return even_gap(heard.times, is_stepped=is_stepped), rhythm(heard.times, is_stepped=is_stepped)
    return 0.0, ""


def _missed(seen: Seen, run: Run, topic: str, called: Called) -> str:
    """Say who published on a topic, if that is known: this run itself, or nobody; or that no callback was called."""
    speaking = [other for other in (*seen.alone, *seen.together) if topic in seen.published(other)]
    if topic not in (seen.command_topic, run.commanded) and not speaking:
        return ", on which nobody published"
    # One that ended may have spoken before this program was there.
    is_over = bool(speaking) and all(other.ended for other in speaking)
    if not is_over and not may_be_called(seen, topic, called):
        return ", but received nothing there"
    return (
        ", where it was also sent texts, to see what it does"
        if topic == run.commanded and run.commands
        else ""
    )


def may_be_called(seen: Seen, topic: str, called: Called) -> bool:
    """Return whether a callback of a topic was called, or it is not known which function that is."""
    callbacks = []
    for end in seen.ends(topic, is_publisher=False):
        function = end.sources.function_of(end.creation, end.creation.given("callback"))
        callbacks.append((end.creation.source, function.lineno if function else 0))
    ran: set[PythonSource] = {source for source, _ in called}
    is_known = bool(callbacks) and all(line and source in ran for source, line in callbacks)
    return not is_known or any(callback in called for callback in callbacks)
