"""Questions about a node with a service: its name, its type, its answers, and whether it lives."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from ros2lab.assignments import End, Exchange, Part
from ros2lab.grading.evidence import ServiceCall
from ros2lab.grading.judging.player import Player
from ros2lab.grading.judging.players import Case
from ros2lab.grading.questions import nodes
from ros2lab.grading.questions.answer import Answer, ended, last_word, question, raised_at, shown

SERVICE: tuple[End, ...] = ("service",)
NEARLY = 1e-5  # relative error of a number that went through 32 bits


@question("right apart near other missing", "service node why", nodes.CODES, SERVICE, tells="right apart")
def service_is_offered(case: Case, part: Part) -> Answer:
    """Whether a node provides a service by the name that is asked for."""
    player = case.at_once(part)
    if player is None:
        answer = nodes.missing(case, part)
        return Answer("missing", {**answer.seen, "service": "", "node": ""}, answer.evidence, answer.place)
    seen = {"service": shown(player.topic), "node": shown(player.node), "why": ""}
    is_apart = player.match == "right" and case.is_apart(part)
    level = "apart" if is_apart else "other" if player.is_guessed else player.match
    return Answer(level, seen, (player.key,), seen["service"])


@question("right wrong missing", "type service", nodes.CODES | nodes.TYPE_CODES, SERVICE, tells="right")
def service_has_its_type(case: Case, part: Part) -> Answer:
    """Whether the service has the type that is asked for."""
    player = case.main(part)
    if player is None:
        return Answer("missing", {"type": "", "service": ""}, ("runs",))
    is_right = part.type_name in player.types
    seen = {"type": shown(part.type_name if is_right else player.types[0]), "service": shown(player.topic)}
    return Answer("right" if is_right else "wrong", seen, (player.key,), seen["service"])


@question(
    "right some none missing", "service fault", nodes.CODES, SERVICE, needs="requests", tells="right some"
)
def service_answers(case: Case, part: Part) -> Answer:
    """Whether each request gets its response in time; a request that ends the program counts elsewhere."""
    player = case.whole(part)
    if player is None:
        return Answer("missing", {"service": "", "fault": ""}, ("runs",))
    asked = [call for call in player.calls if not call.is_repeated]
    pairs = [pair for pair in zip(asked, part.requests, strict=False) if pair[0].is_alive]
    faults = [_fault(part, call, exchange) for call, exchange in pairs]
    wrong = [fault for fault in faults if fault]
    if not pairs:
        wrong = [_untried(part, player)]
    level = "right" if not wrong else "some" if len(wrong) < len(pairs) else "none"
    seen = {"service": shown(player.topic), "fault": wrong[0] if wrong else ""}
    return Answer(level, seen, (f"runs[{player.number}].calls",), seen["service"])


@question("lives dies deaf missing", "program service last end", nodes.CODES, SERVICE)
def service_goes_on(case: Case, part: Part) -> Answer:
    """Whether the program lives after all requests, and answers another one."""
    player = case.whole(part)
    if player is None:
        return Answer("missing", {"program": "", "service": "", "last": "", "end": ""}, ("runs",))
    seen = {"program": shown(player.program or player.node), "service": shown(player.topic)}
    seen |= {"last": "", "end": ""}
    if player.end is not None:
        seen |= {"last": last_word(player.end), "end": ended(player.end)}
        place = raised_at(case, player.end, player.program)
        return Answer("dies", seen, (f"runs[{player.number}].ended",), place)
    again = [call for call in player.calls if call.is_repeated]
    # A service of another type cannot be called; that counts at its type.
    is_deaf = bool(player.calls) and not (again and all(call.response is not None for call in again))
    return Answer("deaf" if is_deaf else "lives", seen, (f"runs[{player.number}].calls",), shown(player.node))


def _fault(part: Part, call: ServiceCall, exchange: Exchange) -> str:
    """Return what is wrong with the response to a request, as a clause; empty if nothing is."""
    request = _written(call.request)
    if call.response is None:
        return f"the request {request} was not answered"
    got, wanted = _differing(call.response, exchange.response)
    if wanted:
        return f"the request {request} was answered with {_written(got)}, not with {_written(wanted)}"
    if call.seconds > part.within:
        return f"the request {request} was answered after {call.seconds:g} s, not within {part.within:g} s"
    return ""


def _untried(part: Part, player: Player) -> str:
    if part.type_name not in player.types:
        return f"as a {shown(player.types[0])} it could not be called"
    return "the first request ended its program" if player.end is not None else "it could not be called"


def _differing(got: Mapping[str, Any], wanted: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the wrong fields of a response, with their values and with those that they should have."""
    names = [name for name, value in wanted.items() if not _is_same(got.get(name), value)]
    return {name: got.get(name) for name in names}, {name: wanted[name] for name in names}


def _is_same(got: Any, wanted: Any) -> bool:
    if isinstance(wanted, Mapping) and isinstance(got, Mapping):
        return all(_is_same(got.get(name), value) for name, value in wanted.items())
    if isinstance(wanted, (list, tuple)) and isinstance(got, (list, tuple)):
        return len(got) == len(wanted) and all(map(_is_same, got, wanted))
    if isinstance(wanted, (int, float)) and isinstance(got, (int, float)):
        return math.isclose(got, wanted, rel_tol=NEARLY, abs_tol=NEARLY)
    return bool(got == wanted)


def _written(fields: Mapping[str, Any]) -> str:
    """Return fields and values for use in a sentence."""
    return shown("{" + ", ".join(f"{name}: {json.dumps(value)}" for name, value in fields.items()) + "}")
