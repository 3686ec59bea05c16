"""Compares what was typed with what the workspace has: topics, types, nodes, parameters and arguments."""

from __future__ import annotations

import ast
import itertools
import re
import shlex
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from ros2lab.diagnose.explaining.typed_message import as_message, misfit
from ros2lab.diagnose.explaining.usage import plain_words
from ros2lab.diagnose.finding import Finding, at, shown_path
from ros2lab.diagnose.launching.misplaced_values import OPTIONS
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.service_faults import ServiceEnd
from ros2lab.diagnose.nodes.stale_values import read_once
from ros2lab.diagnose.nodes.topic_faults import End
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.names_there import all_service_ends, declared_parameters, node_names, topic_ends
from ros2lab.diagnose.printed.transcript import Step, unsettled, words_in
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import read_text
from ros2lab.diagnose.sources.spelling import nearest, plain_signs
from ros2lab.diagnose.sources.uses import State, uses_of

# Codes of faults that keep a node from being found, or from publishing anything.
_SILENCE = frozenset(
    (
        *("spin-missing", "spin-inside", "endless-loop", "life-order", "callback-waits", "made-again"),
        *("never-started", "never-called", "never-passed", "never-read", "never-made", "never-sent"),
        *("no-effect", "filling-lost", "begun-anew", "replaced", "computed-once", "one-object", "unit-mixed"),
        *("lock-held", "transition-wrong", "changed-in-loop", "used-up", "private-name", "words-unread"),
        "queue-short",
    )
)
_NO_ONE = re.compile(
    r"Waiting for at least|does not appear to be published|Could not determine the type|Unknown topic|no publisher",
    re.IGNORECASE,
)


def typed_faults(error: ErrorText, look: Look) -> Iterator[Finding]:
    """Yield what is wrong with the commands in a text, the last one first.

    A node that answered a command is not reported as missing, even if it no longer runs.
    """
    for step in reversed(unsettled(error.steps)):
        line = step.command
        if (meant := as_keyed(line)) != line:
            strange = next(letter for letter in line if plain_signs(letter) != letter)
            cause = f"The command holds the letter {strange!r} (U+{ord(strange):04X}), which came from a web page or a word processor."
            yield Finding("typed-wrong", cause, "", f"type `{meant}`")
        try:
            words = shlex.split(line.rstrip("& "))
        except ValueError:
            quote = "'" if line.count("'") % 2 else '"'
            cause = f"The quote {quote} is opened but never closed, so the shell waits for the rest of the command with its prompt >."
            yield Finding("typed-wrong", cause, "", f"press Ctrl-C, and type `{line}{quote}`")
            continue
        while words and re.fullmatch(r"\w+=.*", words[0]):
            words = words[1:]
        match words:
            case ["ros2", "topic", verb, *_]:
                yield from _topic(verb, plain_words(words, 2), step, error, look)
            case ["ros2", "run", *rest]:
                yield from _run(rest, line)
            case ["ros2", ("service" | "action") as kind, "call" | "send_goal", *_] if look:
                yield from of_call(plain_words(words, 2), step, look, is_action=kind == "action")
            case ["ros2", "param", verb, *_] if step.lines:
                yield from _param(verb, plain_words(words, 2), step, look)
            case ["ros2", "node", "info", name, *_] if step.lines and not step.is_answered:
                yield from _node(name, line, look)


def as_keyed(line: str) -> str:
    """Replace typographic characters of a command by plain ones; a dash before a word becomes two hyphens."""
    return plain_signs(re.sub(r"(?<=\s)[\u2013\u2014](?=\w\w)", "--", line))


_BEGUN = re.compile(r"\[(?P<process>[\w.-]+)\]: process started with pid")


def of_processes(text: str, look: Look) -> Iterator[Finding]:
    """Yield a finding if launch restarts a program each time it ends normally."""
    begun = Counter(match["process"] for match in _BEGUN.finditer(text))
    ended = (name for name in begun if f"[{name}]: process has finished cleanly" in text)
    again = next((name for name in ended if begun[name] > 1), "")
    place = _respawned(look) if again else ""
    if place:
        cause = (
            f"{again.rpartition('-')[0]} ends normally, and respawn makes launch start it again each time."
        )
        yield Finding("launch-argument", cause, place, "remove respawn=True here")


def _respawned(look: Look) -> str:
    """Return the place of the first respawn=True in a launch file; empty if there is none."""
    for path in look.launch_paths:
        for number, line in enumerate(read_text(path).splitlines(), 1):
            if re.search(r"respawn\s*[=:]\s*[\"']?[Tt]rue", line):
                return at(shown_path(path, look.root), number)
    return ""


# A ! inside double quotes, or unquoted, that bash replaces with an earlier command.
_HISTORY = re.compile(r"^(?:[^'\"]|'[^']*')*(?:\"[^\"]*![^\s=\"(]|(?<!^)![^\s=\"'(])")


def of_history(typed: Sequence[str], text: str) -> Iterator[Finding]:
    """Yield a finding for the first command in which bash replaced `!`, as the printed line shows."""
    for line in typed:
        is_told = "event not found" in text or any(
            printed.startswith(f"{line.partition('!')[0]}") for printed in text.splitlines()
        )
        if _HISTORY.match(line) and is_told:
            quoted = line.replace("'", "").replace('"', "'")
            cause = "Inside double quotes, bash replaces ! and what follows it with an earlier command."
            yield Finding("typed-wrong", cause, "", f"type `{quoted}`")
            return


def own_shells(typed: Sequence[str]) -> Iterator[Finding]:
    """Yield a finding if a `!` line changes only its own shell, and the next one needs the change."""
    cells = [line for line in typed if line.startswith("!")]
    for first, later in itertools.pairwise(cells):
        word = first.lstrip("! ").partition(" ")[0]
        if word in ("source", ".", "cd", "export", "unset"):
            command = f"{first} && {later.lstrip('! ')}"
            cause = f"Each line with `!` runs in its own shell, so `{first}` has no effect on `{later}`."
            if word in ("source", "."):
                command = f"!bash -c '{first.lstrip('! ')} && {later.lstrip('! ')}'"  # sh knows no `source`
            yield Finding("typed-wrong", cause, "", f"type `{command}` on one line")
            return


def _topic(verb: str, plain: Sequence[str], step: Step, error: ErrorText, look: Look) -> Iterator[Finding]:
    line = step.command
    if not plain:
        return
    # `info` and `type` speak of both sides.
    ends = [
        end for end in topic_ends(look) if end.is_publisher is (verb != "pub") or verb in ("info", "type")
    ]
    there = {f"/{end.name or end.topic}": end for end in ends}
    does = "publishes on" if verb != "pub" else "subscribes to"
    end = there.get(f"/{plain[0].lstrip('/')}")
    if end is None:
        yield from _other_topic(plain[0], there, does, step)
    elif verb in ("echo", "pub") and (wrong := _other_type(plain, end, line)):
        yield from [wrong] if verb == "pub" or not step.is_answered else ()
    else:
        yield from _word(plain, end)
        if _NO_ONE.search(step.text) and not step.is_answered:
            yield from _not_met(plain[0], end, does, error, look)


def _other_topic(topic: str, there: Mapping[str, End], does: str, step: Step) -> Iterator[Finding]:
    """Yield which topic was meant if the workspace lacks the one that was typed."""
    absolute = next(
        (n for n, end in there.items() if end.is_absolute and topic.endswith(n) and topic != n), ""
    )
    if absolute:
        cause = f"The code names the topic {absolute} with a leading slash, so no namespace is put before it, and {topic} is a different topic."
        fix = f"write {absolute.lstrip('/')!r} there, so that the namespace applies; or type {absolute}"
        yield Finding("topic-near-miss", cause, there[absolute].place, fix)
    elif parts := _field_behind(topic, {name.lstrip("/"): str(end.type) for name, end in there.items()}):
        cause = f"A topic name does not include a field: {parts[1]} is a field of the messages on {parts[0]}."
        fix = f"type `{step.command.replace(topic, f'{parts[0]} --field {parts[1]}')}`"
        yield Finding("topic-near-miss", cause, "", fix)
    elif _NO_ONE.search(step.text) and not step.is_answered and there:
        yield _near_topic(topic, there, does, step.command)


def _near_topic(topic: str, there: Mapping[str, End], does: str, line: str) -> Finding:
    """Say which topics there are instead of the one that was typed."""
    last = topic.rpartition("/")[2]
    private = (name for name, end in there.items() if end.is_private and name.endswith(f"/{last}"))
    wanted = next(private, None) or nearest(topic, there, 0.6)
    if wanted and there[wanted].is_private:
        written = there[wanted].topic
        cause = f"~ stands for the node's own name, so {written!r} is {wanted}, not {topic}."
        fix = f"write {topic!r} instead of {written!r}"
        return Finding("topic-near-miss", cause, there[wanted].place, fix)
    cause = f"No node in the workspace {does} {topic}; the topics are {', '.join(sorted(there))}."
    return Finding("topic-near-miss", cause, "", _retyped(line, topic, wanted))


def _retyped(line: str, old: str, wanted: str | None, otherwise: str = "write one of these names") -> str:
    """Return a command with another name; what to do otherwise if none is like the one that was typed."""
    return f"type `{line.replace(old, wanted)}`" if wanted else otherwise


def _field_behind(name: str, types: Mapping[str, str]) -> tuple[str, str] | None:
    """Split a name such as `/scale/weight/data` into a topic and a field; None if it does not name a field."""
    parts = name.strip("/").split("/")
    for n in range(len(parts) - 1, 0, -1):
        topic = "/".join(parts[:n])
        if parts[n] in (interfaces.fields_of(types.get(topic)) or {}):
            return f"/{topic}", ".".join(parts[n:])
    return None


def _other_type(plain: Sequence[str], end: End, line: str) -> Finding | None:
    """Say that a command uses another type than the code; None if it does not."""
    given = plain[1] if len(plain) > 1 else ""
    if not given or not end.type or is_same_type(given, end.type):
        return None
    right = end.type.replace(".", "/")
    cause = f"The command uses the type {given}, but {end.creation.source.shown} uses {right} on {plain[0]}, so they never connect."
    return Finding("topic-type", cause, end.place, retyped(line, given, end.type))


def _not_met(topic: str, end: End, does: str, error: ErrorText, look: Look) -> Iterator[Finding]:
    """Yield why a topic of the workspace is not found: first faults that silence its node, then the rest."""
    file = end.creation.source.shown
    if any(typed.startswith("ros2 launch") for typed in error.typed):
        yield from (finding for finding in look.findings if finding.code == "launch-executable")
    yield from (
        finding
        for finding in look.findings
        if finding.place.startswith(f"{file}:") and finding.code in _SILENCE
    )
    cause = f"A node in the sources {does} {topic}, but none is found in this terminal's domain: it is not running, it uses another ROS_DOMAIN_ID, or it uses another topic name at run time."
    fix = "compare `echo $ROS_DOMAIN_ID` in both terminals, and `unset ROS_DOMAIN_ID` or set the same domain in both; then start the node again"
    yield Finding("not-running", cause, "", fix)


def _word(plain: Sequence[str], end: End) -> Iterator[Finding]:
    """Yield a finding if the word that is sent differs from one in the code only in case or spaces."""
    sent = re.search(r"data:\s*['\"]?([^'\"}]+)", " ".join(plain[2:]))
    if not sent or end.is_publisher:
        return
    word = sent[1].strip()
    for node in end.creation.source.nodes:
        text = getattr(node, "value", None)
        if isinstance(text, str) and text != word and text.strip().lower() == word.lower():
            cause = f"The command sends {word!r}, but the code compares with {text!r}: upper and lower case and spaces matter."
            fix = f"write {word!r} instead of {text!r}, or compare msg.data.strip().lower()"
            yield Finding("word-unanswered", cause, end.creation.source.at(node), fix)


def _run(rest: Sequence[str], line: str) -> Iterator[Finding]:
    options = [word for word in rest if word in OPTIONS]
    if options and "--ros-args" not in rest:
        better = line.replace(options[0], f"--ros-args {options[0]}", 1)
        cause = f"There is no --ros-args before {options[0]}, so ROS does not read it and the node keeps its own values."
        yield Finding("typed-wrong", cause, "", f"type `{better.rstrip('& ')}`")


def _param(verb: str, plain: Sequence[str], step: Step, look: Look) -> Iterator[Finding]:
    line = step.command
    if step.is_answered:
        is_set = verb == "set" and len(plain) > 1 and "successful" in step.text
        yield from _read_once(plain[1], look) if is_set else ()
    elif plain and f"/{plain[0].rpartition('/')[2]}" not in node_names(look):
        yield from _node(plain[0], line, look)
    else:
        yield from _parameter(plain, line, look)


def _parameter(plain: Sequence[str], line: str, look: Look) -> Iterator[Finding]:
    declared = declared_parameters(look)
    if len(plain) > 1 and plain[1] not in declared and declared:
        wanted = nearest(plain[1], declared, 0.5)
        cause = f"No node here declares a parameter {plain[1]}; the declared ones are {', '.join(sorted(declared))}."
        yield Finding("parameter-name", cause, "", _retyped(line, plain[1], wanted))


def _read_once(name: str, look: Look) -> Iterator[Finding]:
    """Yield a finding if a parameter is read only in __init__."""
    for package in look.packages:
        sources = look.sources(package)
        states = (State(uses_of(sources), owner) for owner in sources.nodes)
        if found := [f for state in states for read, f in read_once(state) if read == name]:
            yield found[0]
            continue
        reads = [
            (function, source.at(node))
            for source in sources.sources.values()
            for _, function, node in sources.scoped(source)
            if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "get_parameter"
            if node.args and sources.value(source, node.args[0]) == name
        ]
        is_told = any("add_on_set_parameters_callback" in source.text for source in sources.sources.values())
        if reads and not is_told and all(function and function.name == "__init__" for function, _ in reads):
            cause = (
                f"The node reads the parameter {name} only in __init__, so setting it later changes nothing."
            )
            fix = f"write self.get_parameter('{name}').value in the callback, where the value is used"
            yield Finding("parameter-once", cause, reads[0][1], fix)


def _node(name: str, line: str, look: Look) -> Iterator[Finding]:
    nodes = {*node_names(look)}
    wanted = nearest(f"/{name.lstrip('/')}", nodes, 0.5)
    is_named = f"/{name.rpartition('/')[2]}" in nodes  # in any namespace
    if nodes and not is_named:
        cause = f"No node here is named {name}; the nodes are {', '.join(sorted(nodes))}."
        fix = _retyped(line, name, wanted, "write one of these names, as `ros2 node list` shows it")
        yield Finding("typed-wrong", cause, "", fix)
    elif nodes:
        cause = f"The node {name} is not running in this terminal's domain."
        fix = "start it in another terminal with the same ROS_DOMAIN_ID, and check `ros2 node list`"
        yield Finding("not-running", cause, "", fix)


_SENT = {"msg": "", "srv": "_Request", "action": "_Goal"}  # what a command sends of each kind of interface
_ZEROS = {"boolean": "true", "string": "''", "wstring": "''", "float": "0.0", "double": "0.0"}


def of_call(plain: Sequence[str], step: Step, look: Look, *, is_action: bool) -> Iterator[Finding]:
    """Yield why a call waits: the code offers the service or the action by another name or with another type."""
    if not plain or step.is_answered:
        return
    servers = [end for end in all_service_ends(look) if end.is_server and end.is_action is is_action]
    what, name = "action" if is_action else "service", plain[0]
    there = [end for end in servers if _is_called(name, end)]
    if there:
        is_other = len(plain) > 1 and not any(is_same_type(plain[1], end.type) for end in there)
        if is_other:
            cause = f"The command calls {name} with the type {plain[1]}, but {there[0].creation.source.shown} offers it with {_shown(there[0].type)}, so it waits for what nobody offers."
            fix = retyped(step.command, plain[1], there[0].type)
            yield Finding("topic-type", cause, there[0].place, fix)
    elif "waiting for" in step.text.lower() and all(end.name for end in servers):
        yield _not_offered(plain, step.command, servers, what)


def _not_offered(plain: Sequence[str], line: str, servers: Sequence[ServiceEnd], what: str) -> Finding:
    """Say which services or actions the workspace has instead of the one that is called."""
    name, by_name = plain[0], {f"/{server.name}": server for server in servers}
    known = f"they offer {', '.join(by_name)}" if servers else "they offer none"
    makes = "ActionServer(self, ...)" if what == "action" else "self.create_service(...)"
    fix = "write one of these names" if servers else f"write {makes} in a node, then build and start it"
    last = f"/{name.strip('/')}"
    if wanted := next((full for full in by_name if full.endswith(last)), None) or nearest(last, by_name, 0.6):
        line = line.replace(name, wanted, 1)
        right = by_name[wanted].type
        is_other = len(plain) > 1 and not is_same_type(plain[1], right)
        fix = retyped(line, plain[1], right) if is_other else f"type `{line}`"
    return Finding("not-running", f"No node in the workspace offers the {what} {name}; {known}.", "", fix)


def _is_called(name: str, end: ServiceEnd) -> bool:
    """Return whether a typed name may be that of a server: a namespace may be given where its node is started."""
    typed, own = f"/{name.lstrip('/')}", f"/{end.name}"
    return bool(end.name) and (typed == own or (typed.endswith(own) and not end.written.startswith("/")))


def is_same_type(given: str, right: str) -> bool:
    """Return whether a typed type, such as `std_msgs/String`, may be one of the code, such as `std_msgs.msg.String`."""
    package, *middle, name = given.split("/") if "/" in given else ("", given)
    wanted = right.split(".")
    is_alike = [package, name] == [wanted[0], wanted[-1]] and middle in ([], wanted[1:-1])
    return is_alike or not interfaces.is_interface(right)


def retyped(line: str, given: str, right: str) -> str:
    """Say which command to type: with the type that it needs, and with a message of it unless that which was typed fits."""
    better = line.replace(given, _shown(right), 1)
    words = words_in(line)
    after = words[words.index(given) + 1 :] if given in words else []
    message = next((word for word in after if ":" in word or "{" in word), "")
    fields = interfaces.fields_of(f"{right}{_SENT.get(right.split('.')[1], '')}")
    if fields is None:
        show = f"; `ros2 interface show {_shown(right)}` lists its fields" if message else ""
        return f"type `{better}`{show}"
    fits = message and not misfit(message, fields) and as_message(message, fields) == message
    if fits or "echo" in words[:3]:
        return f"type `{better}`"
    for quoted in (f'"{message}"', f"'{message}'", message):
        if message and quoted in better:
            better = better.replace(quoted, "", 1).rstrip()
            break
    example = _example(fields)
    return f'type `{better} "{{{example}}}"`' if example else f"type `{better}`"


def _example(fields: Mapping[str, str]) -> str:
    """Return values for the fields of a message, as they are typed within braces."""
    parts = []
    for name, kind in fields.items():
        inner = interfaces.fields_of(kind.replace("/", ".msg."))
        is_empty = name in ("header", "structure_needs_at_least_one_member")
        value = f"{{{_example(inner)}}}" if inner else _ZEROS.get(kind, "[]" if kind[-1] in ">]" else "0")
        parts += [] if is_empty else [f"{name}: {value}"]
    return ", ".join(parts)


def _shown(kind: str) -> str:
    return kind.replace(".", "/")
