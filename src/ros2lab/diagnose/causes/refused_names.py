"""Names of topics, services, nodes and namespaces that ROS refuses: which text in the sources made them."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.spots import Spot, place_of, spot_at
from ros2lab.diagnose.sources.python_source import PythonSource, read_text

# As rclpy prints it: what is refused and why, then the name itself, and below it a mark at the first wrong letter.
_REFUSED = re.compile(
    r"(?P<kind>\w+)Exception: Invalid [\w ]+: [^\n]*\n[^\n]*?'(?P<name>[^'\n]*)'[ \t]*\n(?P<gap>[^\n^]*)\^"
)
_WRONG = re.compile(r"[^A-Za-z0-9_~{}/]+|(?:^|(?<=/))(?=\d)|__+|(?<=.)/+$|/{2,}")
_TAKEN_AT = {"InvalidTopicName": 1, "InvalidServiceName": 1, "InvalidNodeName": 0}  # positions of the name


def of_refused_name(error: ErrorText, look: Look) -> Finding | None:
    """Return the text that makes up a name that ROS refuses; None if the error is about something else."""
    report = error.report
    said = _REFUSED.search(error.text) if report and "Invalid" in report.kind else None
    own = error.own
    if said is None or not own:
        return None
    name = said["name"]
    code = (
        "topic-name-invalid"
        if said["kind"] in ("InvalidTopicName", "InvalidServiceName")
        else "node-name-invalid"
    )
    what = {"InvalidNodeName": "node name", "InvalidNamespace": "namespace"}.get(
        said["kind"], "topic or service name"
    )
    cause = f"{name!r} is not a valid {what}: it may contain only letters, digits and _"
    cause += (
        ", and must not begin with a digit."
        if what == "node name"
        else ", between slashes, and no part may begin with a digit."
    )
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
