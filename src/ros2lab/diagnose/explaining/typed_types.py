"""Compares the name and the type of a typed command with what the workspace's code offers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from ros2lab.diagnose.explaining.typed_message import as_message, misfit
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.service_faults import ServiceEnd
from ros2lab.diagnose.printed.names_there import all_service_ends
from ros2lab.diagnose.printed.transcript import Step, words_in
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.spelling import nearest

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
