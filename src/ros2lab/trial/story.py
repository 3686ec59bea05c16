"""Describes what a program did while it ran, for a student who sees nothing wrong in it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ros2lab.diagnose.nodes.hidden_logs import hidden_logs
from ros2lab.diagnose.nodes.service_faults import service_ends
from ros2lab.diagnose.nodes.spin_loops import stands_still
from ros2lab.diagnose.sources.python_source import PythonSource, read_text
from ros2lab.every_node import OF_MANAGED
from ros2lab.grading.evidence import Heard, Run
from ros2lab.grading.judging.player import finds_no_keyboard
from ros2lab.grading.watching.quiet import STEP
from ros2lab.rhythm import median_gap
from ros2lab.trial.ends import lacks_arguments, word_that_ended
from ros2lab.trial.unmade import unmade_notes

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen
    from ros2lab.trial.witnessed import Called


def told_of(seen: Seen, run: Run, called: Called) -> str:
    """Describe in a sentence what a program published, received and did not receive, and whether it ended.

    Args:
        seen: all runs.
        run: the run of this program alone.
        called: the functions that were called in any run.
    """
    name, heard = run.programs[0], seen.heard(run)
    parts = [_published(topic, stretches, run) for topic, stretches in heard.items()]
    silent = [topic for topic in run.publishes if topic not in heard and not topic.endswith(OF_MANAGED)]
    parts += [f"has a publisher on {topic}, but published nothing there" for topic in silent]
    parts += [f"subscribed to {topic}{_missed(seen, run, topic, called)}" for topic in run.subscribes]
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


def _published(topic: str, stretches: list[Heard], run: Run) -> str:
    count = sum(stretch.count for stretch in stretches)
    times = run.quiet[topic].times if topic in run.quiet else []
    gap, pace = median_gap(times), ""
    if gap:
        pace = f", one every {gap:.3g} s"
    if gap and run.clock != "real":
        # The clock steps from message to message: a single time between two is off by up to a step.
        mean = (times[-1] - times[0]) / (len(times) - 1)
        pace = (
            f", about one every {mean:.2g} s" if mean > 1.05 * STEP else f", one every {STEP} s or more often"
        )
    return f"published {count} message{'s' * (count != 1)} on {topic}{pace}"


def _missed(seen: Seen, run: Run, topic: str, called: Called) -> str:
    """Say who published on a topic, if that is known: this run itself, or nobody; or that no callback was called."""
    if topic not in (seen.command_topic, run.commanded) and not any(
        topic in seen.heard(other) for other in (*seen.alone, *seen.together)
    ):
        return ", on which nobody published"
    if not may_be_called(seen, topic, called):
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
