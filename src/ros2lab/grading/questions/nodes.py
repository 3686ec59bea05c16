"""What is asked of every node: its topic, the type, and whether it lives."""

from __future__ import annotations

from ros2lab.grading.questions.answer import Answer, last_word, raised_at, shown
from ros2lab.grading.roles import COMMAND, HINTS, STAMPED, TOPICS, TYPES, Case, Part

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


def missing(case: Case, role: str) -> Answer:
    """Answer for a node that was not seen, with what is likely to be the reason."""
    why, keys, place = "", ["runs"], ""
    crashed = {
        name: (number, end)
        for number, run in enumerate(case.evidence.runs)
        if run.setting == "alone"
        and not any(one.run is run for parts in case.parts.values() for one in parts)
        for name, end in run.ended.items()
    }
    dead = {
        name: one.fault for name, one in case.executables.items() if not one.command and name not in crashed
    }
    hinted = [name for name in [*crashed, *dead] if HINTS[role].search(name)]
    others = [name for name in [*crashed, *dead] if not any(hint.search(name) for hint in HINTS.values())]
    for name in [*hinted, *others][:1]:
        place = shown(name)
        if name in crashed:
            number, end = crashed[name]
            why = f": {place} ended with {last_word(end)}"
            keys = [f"runs[{number}].ended.{place}"]
        else:
            why = f": {place} cannot be started ({shown(dead[name], 120).rstrip('.')})"
            keys = ["build.executables"]
    if role == COMMAND and not why:
        for number, run in enumerate(case.evidence.runs):
            for node in run.publishes.get(TOPICS[COMMAND], ()):
                keys, place = [f"runs[{number}].publishes"], shown(node)
                why = f": {place} publishes on it, where a subscription is needed"
    return Answer("missing", {"why": why}, tuple(keys), place)


def topic(case: Case, role: str) -> Answer:
    """Answer whether a node has the right topic: right, doubled (it plays another part, too), near, other or missing."""
    part = case.at_once(role)
    if part is None:
        answer = missing(case, role)
        return Answer("missing", {**answer.seen, "topic": "", "node": ""}, answer.evidence, answer.place)
    seen = {"topic": shown(part.topic), "node": shown(part.node), "why": ""}
    level = "doubled" if part.match == "right" and role in case.doubled else part.match
    return Answer(level, seen, (part.key,), seen["topic"])


def type_(case: Case, role: str) -> Answer:
    """Answer whether the topic has the right type: right, wrong or missing; stamped for a TwistStamped."""
    part = case.main(role)
    if part is None:
        return Answer("missing", {"type": "", "topic": TOPICS[role]}, ("runs",))
    wrong = [one for one in part.types if one != TYPES[role]]
    level = "right" if TYPES[role] in part.types else "stamped" if STAMPED in wrong else "wrong"
    seen = {"type": shown(wrong[0] if wrong else TYPES[role]), "topic": shown(part.topic)}
    return Answer(level, seen, (part.key,), seen["topic"])


def life(case: Case, role: str) -> Answer:
    """Answer whether a publishing node goes on: lives, dies, ends, stops, silent or missing.

    What dies of a command in the program that takes the commands is counted there.
    """
    part = case.whole(role)
    if part is None:
        return Answer("missing", {"program": "", "last": ""}, ("runs",))
    seen = {"program": shown(part.program or part.node), "last": ""}
    key = (f"runs[{part.number}].ended",)
    if part.end is not None and not _dies_of_command(case, part):
        seen["last"] = last_word(part.end)
        level = "dies" if "Error" in part.end or "Exception" in part.end else "ends"
        return Answer(level, seen, key, raised_at(part.end, part.program))
    if any(one.topic in one.run.stalled for one in case.parts[role]):
        return Answer("stops", seen, (f"runs[{part.number}].stalled",), shown(part.node))
    is_silent = not any(one.is_heard for one in case.parts[role])
    return Answer("silent" if is_silent else "lives", seen, key, shown(part.node))


def _dies_of_command(case: Case, part: Part) -> bool:
    if part.last_command is None:
        return False
    return any(
        one.program == part.program and one.number == part.number and one.match != "other"
        for one in case.parts[COMMAND]
    )
