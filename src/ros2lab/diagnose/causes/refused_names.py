"""Names that ROS refuses: which text in the sources, in a command or in a launch file made them."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.spots import Spot, place_of, spot_at
from ros2lab.diagnose.sources.python_source import PythonSource, read_text

_OF_TOPICS = "topic or service name"
_KINDS = {"InvalidNodeName": "node name", "InvalidNamespace": "namespace"}
# As rclpy prints it: what is refused and why, then the name itself, and below it a mark at the first wrong letter.
_REFUSED = re.compile(
    r"(?P<kind>\w+)Exception: Invalid [\w ]+: [^\n]*\n[^\n]*?'(?P<name>[^'\n]*)'[ \t]*\n(?P<gap>[^\n^]*)\^"
)
_WRONG = re.compile(r"[^A-Za-z0-9_~{}/]+|(?:^|(?<=/))(?=\d)|__+|(?<=.)/+$|/{2,}")
_TAKEN_AT = {"InvalidTopicName": 1, "InvalidServiceName": 1, "InvalidNodeName": 0}  # positions of the name
# A rule, as it is typed, as launch shows the command that died, and as rcl repeats it.
_RULE = re.compile(
    r"""(?P<around>['"])?(?:-r|--remap) +(?P<quote>['"])?(?P<from>[^\s'":]+(?::[^\s'":=]+)?):="""
    r"""(?P<to>(?(around)[^'"\n]*|(?(quote)[^'"\n]*|[^\s'"]*)))"""
)
_BY_LAUNCH = re.compile(
    r"Caught exception in launch[^\n]*: Invalid (?P<what>node name|namespace): [^\n]*\n\s*'(?P<name>[^'\n]+)'"
)
_RULES = {
    "namespace": "a namespace begins with a slash and does not end with one, and between slashes it may contain only letters, digits and _, and no part may begin with a digit",
    "node name": "it may contain only letters, digits and _, and must not begin with a digit",
    _OF_TOPICS: "between slashes it may contain only letters, digits and _, and no part may begin with a digit",
}
_KEYS = {
    "namespace": r"namespace|\bns\b",
    "node name": r"\bname\b",
    _OF_TOPICS: r"remap|\bfrom\b|\bto\b",
}
_SPECIAL = {"__ns": "namespace", "__node": "node name", "__name": "node name"}


def of_refused_name(error: ErrorText, look: Look) -> Finding | None:
    """Return the text that makes up a name that ROS refuses; None if the error is about something else."""
    report = error.report
    said = _REFUSED.search(error.text) if report and "Invalid" in report.kind else None
    own = error.own
    if said is None or not own:
        return None
    name, what = said["name"], _KINDS.get(said["kind"], _OF_TOPICS)
    code, cause = _code(what), _cause(name, what)
    spots = [spot_at(place_of([frame], look), look) for frame in own]
    place = spots[0].source.at(spots[0].lines[0]) if spots[0].source else ""
    wrong = _first_wrong(name, what)
    for source, node in _texts(spots, look):
        written = str(node.value)
        begin = name.find(written) if written else -1
        if begin >= 0 and begin <= wrong < begin + len(written):
            better = better_name(written, what, is_begin=begin == 0 or name[begin - 1] == "/")
            where = source.at(node)
            more = "" if where == place else f" Line {spots[0].line} uses this text."
            return Finding(code, cause + more, where, f"write {better!r} instead of {written!r}")
    if given := _in_files(name, wrong, look):
        where, written = given
        return Finding(code, cause, where, f"write {better_name(written, what)} instead of {written}")
    return Finding(code, cause, place, _at_use(spots[0], said["kind"], name, what))


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


def _first_wrong(name: str, what: str) -> int:
    found = re.search(r"[^A-Za-z0-9_]|^\d", name) if what == "node name" else _WRONG.search(name)
    return found.start() if found else 0


def better_name(text: str, what: str, *, is_begin: bool = True) -> str:
    """Return a text that is allowed in a name."""
    if what == "node name":
        better = re.sub(r"[^A-Za-z0-9_]+", "_", text)
        return _with_letter(better) if is_begin else better
    better = re.sub(r"[_/]*/[_/]*", "/", re.sub(r"[^A-Za-z0-9_~{}/]+", "_", text.strip()))
    better = re.sub(r"(?<=[^/])/$", "", re.sub(r"__+", "_", better))
    first, *others = better.split("/")
    return "/".join([_with_letter(first) if is_begin else first, *map(_with_letter, others)])


def _with_letter(part: str) -> str:
    """Return a part of a name that begins with a letter: one that begins with digits ends with them instead."""
    match = re.fullmatch(r"(\d[A-Za-z0-9]*)_([A-Za-z]\w*)|(\d+)([A-Za-z]\w*)", part)
    if match:
        return f"{match[2]}_{match[1]}" if match[1] else f"{match[4]}{match[3]}"
    return f"n{part}" if part[:1].isdigit() else part


def _texts(spots: list[Spot], look: Look) -> Iterator[tuple[PythonSource, ast.Constant]]:
    """Yield the strings of the student's files, those of the lines in the traceback first, the longest first."""
    own = [(spot.file, node) for spot in spots for node in spot.whole]
    rest = [(source, node) for source in look.files for node in source.nodes]
    for some in (own, rest):
        texts = [(s, n) for s, n in some if isinstance(n, ast.Constant) and isinstance(n.value, str)]
        yield from sorted(texts, key=lambda pair: -len(str(pair[1].value)))


def _in_files(name: str, wrong: int, look: Look) -> tuple[str, str] | None:
    """Return where a parameter file has the refused name as a value, and how it is written; None if none does."""
    for package in look.packages:
        for path in sorted(package.folder.glob("*/*.y*ml")):
            for number, line in enumerate(read_text(path).splitlines(), 1):
                value = line.partition(":")[2].strip().strip("'\"")
                begin = name.find(value) if value else -1
                if begin >= 0 and begin <= wrong < begin + len(value):
                    return f"{package.shown(str(path.relative_to(package.folder)))}:{number}", value
    return None


def _at_use(spot: Spot, kind: str, name: str, what: str) -> str:
    """Say how to change the expression of the name where it is used."""
    wrong = name[_first_wrong(name, what) :][:1]
    for node in spot.whole:
        if not isinstance(node, ast.Call) or not (node.args or node.keywords):
            continue
        given = [k.value for k in node.keywords if k.arg in ("node_name", "namespace", "topic", "srv_name")]
        given += node.args[(at := _TAKEN_AT.get(kind, 9)) : at + 1]
        if not given:
            continue
        text = ast.unparse(given[0])
        if wrong.isdigit():
            better = f"{text[:2]}n{text[2:]}" if isinstance(given[0], ast.JoinedStr) else f"'n' + {text}"
            return f"write `{better}` instead of `{text}`: the name then begins with a letter"
        return f"write `{text}.replace({wrong!r}, '_')` instead of `{text}`"
    return f"write {better_name(name, what)!r} where this name comes from"


def _names(text: str) -> Iterator[tuple[str, str, str]]:
    """Yield the names in the rules of a text, each with its rule and with what it names."""
    for match in _RULE.finditer(text):
        old, new = match["from"], match["to"]
        rule = f"{old}:={new}"
        key = old.rpartition(":")[2]
        if key in _SPECIAL:
            yield rule, new, _SPECIAL[key]
        elif not key.startswith("__"):
            yield from ((rule, name, _OF_TOPICS) for name in (key, new))


def allowed(name: str, what: str) -> str:
    """Return a name as ROS allows it; unchanged where it is, or where it has parts that only a rule may have."""
    if re.search(r"[*\\]|://", name):
        return name
    if what == "node name":
        return better_name(name.strip("/"), what)
    better = better_name(name, what)
    return f"/{better.strip('/')}" if what == "namespace" else better


def _cause(name: str, what: str) -> str:
    rule = _RULES[what]
    if what == "namespace" and allowed(name, what) == f"/{name}":
        rule = "a namespace begins with a slash, and this one does not"
    return f"{name!r} is not a valid {what}: {rule}."


def _code(what: str) -> str:
    return "topic-name-invalid" if what == _OF_TOPICS else "node-name-invalid"


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
    return Finding(
        _code(what), _cause(name, what), place, f"write {new!r} instead of {written!r} as the {what}"
    )
