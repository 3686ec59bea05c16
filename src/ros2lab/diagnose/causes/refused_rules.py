"""Names that ROS refuses before a node's own code has any part in it: typed after --ros-args, or given by launch."""

from __future__ import annotations

import re
from collections.abc import Iterator

from ros2lab.diagnose.causes.refused_names import better_name
from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.sources.python_source import read_text

# A rule, as it is typed, as launch shows the command that died, and as rcl repeats it.
_RULE = re.compile(
    r"""(?P<around>['"])?(?:-r|--remap) +(?P<quote>['"])?(?P<from>[^\s'":]+(?::[^\s'":=]+)?):="""
    r"""(?P<to>(?(around)[^'"\n]*|(?(quote)[^'"\n]*|[^\s'"]*)))"""
)
_BY_LAUNCH = re.compile(
    r"Caught exception in launch[^\n]*: Invalid (?P<what>node name|namespace): [^\n]*\n\s*'(?P<name>[^'\n]+)'"
)
_RULES = {
    "namespace": "it begins with a slash and does not end with one, and between slashes it may contain only letters, digits and _, and no part may begin with a digit",
    "node name": "it may contain only letters, digits and _, and must not begin with a digit",
    "topic or service name": "between slashes it may contain only letters, digits and _, and no part may begin with a digit",
}
_KEYS = {
    "namespace": r"namespace|\bns\b",
    "node name": r"\bname\b",
    "topic or service name": r"remap|\bfrom\b|\bto\b",
}
_SPECIAL = {"__ns": "namespace", "__node": "node name", "__name": "node name"}


def of_refused_rule(error: ErrorText, look: Look) -> Finding | None:
    """Return which name of a command line or a launch file ROS refuses; None if the error is about something else."""
    if said := _BY_LAUNCH.search(error.text):
        return _in_launch(said["name"], said["what"], look)
    if error.report is None or not error.report.kind.endswith("RCLError"):
        return None
    for rule, name, what in _names("\n".join((error.text, *error.typed))):  # first that which rcl names
        better = allowed(name, what)
        typed = next((line for line in error.typed if rule in line), "")
        if better == name or not better:
            continue
        if not typed:
            return _in_launch(name, what, look)
        old, _, new = rule.partition(":=")
        right = typed.replace(
            rule, f"{old}:={better}" if new == name else f"{old.replace(name, better)}:={new}"
        )
        return Finding("typed-wrong", _cause(name, what), "", f"type `{right}`")
    return None


def _names(text: str) -> Iterator[tuple[str, str, str]]:
    """Yield the names in the rules of a text, each with its rule and with what it names."""
    for match in _RULE.finditer(text):
        old, new = match["from"], match["to"]
        rule = f"{old}:={new}"
        key = old.rpartition(":")[2]
        if key in _SPECIAL:
            yield rule, new, _SPECIAL[key]
        elif not key.startswith("__"):
            yield from ((rule, name, "topic or service name") for name in (key, new))


def allowed(name: str, what: str) -> str:
    """Return a name as ROS allows it; unchanged where it is, or where it has parts that only a rule may have."""
    if re.search(r"[*\\]|://", name):
        return name
    if what == "node name":
        return better_name(name.strip("/"), what)
    better = better_name(name, what)
    return f"/{better.strip('/')}" if what == "namespace" else better


def _cause(name: str, what: str) -> str:
    return f"{name!r} is not a valid {what}: {_RULES[what]}."


def _in_launch(name: str, what: str, look: Look) -> Finding | None:
    """Return where a launch file writes a name that is refused, a line that says what it is first; None if none does."""
    better = allowed(name, what)
    found = []
    for file, path in look.launches:
        for number, line in enumerate(read_text(path).splitlines(), 1):
            for written in (name, name.lstrip("/")):
                if re.search(rf"(?<![\w/-]){re.escape(written)}(?![\w/-])", line):
                    found.append((not re.search(_KEYS[what], line), at(file.shown, number), written))
                    break
    if not found or better == name:
        return None
    _, place, written = min(found, key=lambda spot: spot[0])
    new = better if written.startswith("/") or what != "namespace" else better.lstrip("/")
    code = "topic-name-invalid" if what.startswith("topic") else "node-name-invalid"
    return Finding(code, _cause(name, what), place, f"write {new!r} instead of {written!r} as the {what}")
