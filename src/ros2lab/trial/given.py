"""What programs do with messages, requests and responses of made-up contents, where nothing in the workspace provides any."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import TYPE_CHECKING, Any

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.service_faults import service_ends
from ros2lab.diagnose.nodes.topic_faults import End, ends_of
from ros2lab.diagnose.printed.error_text import ErrorReport, read_error
from ros2lab.diagnose.printed.spots import spot_of
from ros2lab.every_node import HIDDEN_TOPICS
from ros2lab.grading.code.compared import Contents, Values, compared_by
from ros2lab.grading.evidence import Run, ServiceCall
from ros2lab.observed_domain import TEXTS
from ros2lab.trial.contents import leaves_of
from ros2lab.trial.effects import did_given
from ros2lab.trial.ends import explained
from ros2lab.trial.failing import is_of_code
from ros2lab.trial.set_values import Setting
from ros2lab.trial.spoken import MOST_SHOWN, Sent, fields_of, value_of
from ros2lab.trial.story import may_be_called

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen
    from ros2lab.trial.witnessed import Called


@dataclass(frozen=True)
class GivenRun:
    """A run of all programs in which they were given what they may wait for.

    Attributes:
        run: what was seen.
        fatal: what was given just before a program ended, for each in `run.ended`, by topic or service.
        called: the functions that were called in this run and all others.
        sent: what each program published by its own notes, by its name and the topic.
        when: when what was given, each with the topic or service.
        settings: what became of each parameter, if these were set.
    """

    run: Run
    fatal: Sequence[Mapping[str, Any]]
    called: Called
    sent: Mapping[str, Mapping[str, Sent]] = field(default_factory=dict)
    when: Sequence[tuple[float, str, Any]] = ()
    settings: Sequence[Setting] = ()


def open_contents(look: Look, commanded: str) -> Contents:
    """Return what the code compares, by the last part of the topic's name, for each end that nothing in a workspace serves.

    Args:
        look: the workspace.
        commanded: the topic on which texts are sent in the other runs.
    """
    renamed = {end.place: name for node in look.launched.values() for end, _, name in node.ends}
    every = [look.sources(package) for package in look.packages]
    ends = [end for sources in every for end in ends_of(sources, unnamed=True)]
    published = {_named(end, renamed) for end in ends if end.is_publisher}
    found: dict[str, Values] = {
        _named(end, renamed): compared_by(end)
        for end in ends
        if not end.is_publisher
        and _named(end, renamed) not in {*published, _last(commanded), *map(_last, HIDDEN_TOPICS)}
    }
    services = [end for sources in every for end in service_ends(sources) if not end.is_action]
    offered, called = (
        {_last(end.name) for end in services if end.is_server is side} for side in (True, False)
    )
    found |= {name: {} for name in offered ^ called}
    if found:  # what is sent to the command topic in other runs is given here, too
        found |= {
            _last(commanded): compared_by(end) for end in ends if _named(end, renamed) == _last(commanded)
        }
    return found


def _last(name: str) -> str:
    return name.rpartition("/")[2]


def _named(end: End, renamed: Mapping[str, str]) -> str:
    return _last(renamed.get(end.place) or end.topic)


def given_faults(seen: Seen, given: GivenRun) -> Iterator[Finding]:
    """Yield why programs ended that were given something, if their code fails whatever that is."""
    for name in given.run.ended:
        report = _ended_by(seen, given, name)
        nodes = {node for run in seen.alone if run.programs[0] == name for node in run.nodes}
        read = (given.run.subscribes.get(topic, {}) for topic in _just_given(given, name))
        texts = [kinds for by in read for node, kinds in by.items() if node in nodes and TEXTS in kinds]
        if (
            report is not None and is_of_code(*report.line.split(": ", 1)) and not texts
        ):  # a text may be read as anything
            yield from (found for found in explained(seen, given.run, name) if found.code != "program-ends")


def _just_given(given: GivenRun, name: str) -> Mapping[str, Any]:
    """Return what was given just before a program ended, by topic or service."""
    return dict(zip(given.run.ended, given.fatal, strict=False)).get(name, {})


def _ended_by(seen: Seen, given: GivenRun, name: str) -> ErrorReport | None:
    """Return the error that ended a program that was given something; None if it also ended without that."""
    others = (*seen.alone, *seen.together)
    report = read_error(given.run.ended.get(name) or "").report
    return None if any(name in run.ended for run in others) else report


def told_of_given(seen: Seen, run: Run, given: GivenRun | None) -> list[str]:
    """Describe in sentences what a program did with what it was given; empty if it was given nothing.

    Args:
        seen: all other runs.
        run: the run of this program alone.
        given: the run in which it was given something; None if there is none.
    """
    if given is None:
        return []
    name, among, nodes, home = run.programs[0], given.run, {*run.nodes}, seen.main(run.programs[0])
    ends = (end for package in seen.look.packages for end in service_ends(seen.look.sources(package)))
    own = {f"/{end.name}": end.is_server for end in ends if end.creation.source.shown == home}
    topics = _taken(seen, given, nodes)
    what = [f"messages on {topic} ({_kind(among.subscribes[topic])})" for topic in topics]
    what += [f"responses on {service}" for service in among.given if own.get(service) is False]
    calls = [call for call in among.calls if own.get(call.service)]
    if not what and not calls:
        return []
    ended = [*_ended(seen, given, name, {*topics, *own})]
    is_over = name in among.ended
    did = did_given(seen, run, given, [*topics, *own], is_over=is_over)
    when = f"Given made-up {' and '.join(what)}" if what else "Meanwhile"
    did = did or ["went on"] * (bool(what) and not is_over)
    told = [f"{when}, it {'; it '.join(did)}."] if did else []
    return [*_answered(calls, is_over=is_over), *told, *ended]


def _taken(seen: Seen, given: GivenRun, nodes: Collection[str]) -> list[str]:
    """Return the topics on which something was given to some nodes that may have taken it."""
    among = given.run
    topics = (topic for topic in among.given if not {*nodes}.isdisjoint(among.subscribes.get(topic, ())))
    return [topic for topic in topics if may_be_called(seen, topic, given.called)]


def _kind(nodes: Mapping[str, Sequence[str]]) -> str:
    return next(iter(nodes.values()))[0].replace("/msg/", "/")


def _answered(calls: Iterable[ServiceCall], *, is_over: bool) -> Iterator[str]:
    """Say what services answered to requests that differ."""
    for service, group in groupby(sorted(calls, key=lambda call: call.service), lambda call: call.service):
        made = [*group]
        texts = dict.fromkeys(
            f"called{f' with {fields_of(call.request)}' if call.request else ''}, {_response_of(call, is_over=is_over)}"
            for call in made
        )
        leaves = [leaf for call in made for _, leaf in leaves_of(call.response)]
        is_new = len(made) > 1 and bool(leaves) and not any(leaves)
        yield f"{service}, {'; '.join(texts)}{', as a response is before anything is filled in' * is_new}."


def _response_of(call: ServiceCall, *, is_over: bool) -> str:
    if call.response is None:
        return f"did not answer {'before the program ended' if is_over else f'within {call.seconds:.1f} s'}"
    return f"answered {fields_of(call.response)}"


def _ended(seen: Seen, given: GivenRun, name: str, own: Collection[str]) -> Iterator[str]:
    """Say with which error a program ended, and what of that which it was given its code reads there."""
    report = _ended_by(seen, given, name)
    if report is None:
        return
    spot = spot_of(report, seen.look)
    last = _just_given(given, name)
    leaves = [
        (field, f"{field} = {value_of(leaf)} on {topic}")
        for topic in last
        if topic in own
        for field, leaf in leaves_of(last[topic])
    ]
    read = {getattr(node, "attr", "") for node in ast.walk(spot.function or ast.Module([], []))}
    texts = [text for field, text in leaves if read.issuperset(re.findall(r"[a-z]\w*", field))] or [
        text for _, text in leaves
    ]
    when = f" soon after {', '.join(texts[:MOST_SHOWN])}" if texts else ""
    at = f" ({spot.place})" if spot.place else ""
    hedge = (
        "" if is_of_code(*report.line.split(": ", 1)) else "; that was made up, and may be what never comes"
    )
    yield f"It ended with {report.line!r}{at}{when}{hedge}."
