"""Recognizes what is no error of ROS or Python: messages of the student's own code, and a value that a node refuses."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.causes.waited import waited_for
from ros2lab.diagnose.explaining.usage import plain_words
from ros2lab.diagnose.finding import SAID, Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.caught import without_caught
from ros2lab.diagnose.printed.error_text import ErrorText, Frame, own_frames
from ros2lab.diagnose.printed.spots import Spot, spot_at
from ros2lab.diagnose.printed.transcript import WARNING, step_with, words_in
from ros2lab.diagnose.sources.joined_texts import VALUE, text_of, text_pattern
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, read_source
from ros2lab.diagnose.sources.uses import is_log

_GIVES_ONE = re.compile(r"\s*(?:warnings\.)?warn\(")
_LOG_LINE = re.compile(
    r"\[(?P<level>DEBUG|INFO|WARN|ERROR|FATAL)\] (?:\[[\d.]+\] )?\[(?P<logger>[\w.]+)\]: (?P<text>.*)"
)
_SHORTEST = 8  # characters of a text that is recognized

_NO_MODULE = re.compile(r"No module named '?([\w.]+)")


def without_own(text: str, look: Look) -> str:
    """Remove what the student's own code says, and no error is: its warnings, and what it has caught."""
    text = without_caught(text, look)
    text = _without_warnings(text, look) if "Warning: " in text else text
    return _without_caught_imports(text, look) if "No module named" in text else text


def _without_warnings(text: str, look: Look) -> str:
    """Remove the warnings of the student's own code from a text, each with the line of code below it."""
    lines = text.splitlines()
    left, n = [], 0
    while n < len(lines):
        warning = WARNING.match(lines[n])
        below = lines[n + 1] if n + 1 < len(lines) else ""
        if warning and _is_own(warning, below, look):
            n += 1 + below.startswith("  ")
            continue
        left.append(lines[n])
        n += 1
    return text if len(left) == len(lines) else "\n".join(left)


def _without_caught_imports(text: str, look: Look) -> str:
    """Remove the lines in which a program says which import it has caught, from a text without such a traceback."""
    if re.search(r"^(?:ModuleNotFoundError|ImportError): ", text, re.MULTILINE):
        return text
    imports = [i for source in look.files for i in source.imports]
    caught = {i.target.partition(".")[0] for i in imports if i.is_guarded}
    caught -= {i.target.partition(".")[0] for i in imports if not i.is_guarded}
    said = ((line, _NO_MODULE.search(line)) for line in text.splitlines(keepends=True))
    return "".join(line for line, found in said if found is None or found[1].partition(".")[0] not in caught)


def own_words(error: ErrorText, look: Look) -> Finding | None:
    """Say where the student's code contains the text of an error's line, or asks for what it says; None if nowhere."""
    line = error.decisive
    logged = _LOG_LINE.search(line)
    spoken = logged["text"] if logged else line
    said = [*_logged(line, look)] or [
        (text, source.at(node)) for source in look.files for text, node in _texts(source) if text in spoken
    ]
    if not said:
        return refused_setting(error, look)
    text, place = max(said, key=lambda text_and_place: len(text_and_place[0]))
    cause = f"{text!r} is a message of your own code, not an error from ROS or Python."
    fix = "if it should not appear here, check the condition above this line and the value it receives"
    return Finding(SAID, cause, place, fix)


def is_own_log(line: str, look: Look) -> bool:
    """Return whether a logger of the student's own nodes wrote a line."""
    return any(_logged(line, look))


def still_waiting(text: str, look: Look) -> Finding | None:
    """Say for which server a program waits in vain, by the last that it logged, in the loop of the wait; None if it does not, or if the server may yet come."""
    line = next(reversed(re.sub(r"(?:\s|\^C)+\Z", "", text).splitlines()), "")
    for _, place in _logged(line, look) if look else ():
        spot = spot_at(place, look)
        for loop in spot.file.around(spot.line, ast.While):
            found = waited_for(look, Spot(spot.source, loop.lineno))
            if found and "offers it" not in found.cause:
                return found
    return None


def _logged(line: str, look: Look) -> Iterator[tuple[str, str]]:
    """Yield the text of a line that a logger of the student's nodes wrote, with each call that may log it."""
    match = _LOG_LINE.search(line)
    if match is None:
        return
    for sources in map(look.sources, look.packages):
        names = sources.node_names
        if "" not in names and names.keys().isdisjoint(match["logger"].split(".")):
            continue
        for source in sources.sources.values():
            for call in source.nodes:
                if not (isinstance(call, ast.Call) and is_log(call) and call.args):
                    continue
                is_of_level = getattr(call.func, "attr", "")[:4] == match["level"].lower()[:4]
                if is_of_level and re.fullmatch(text_pattern(call.args[0]), match["text"], re.DOTALL):
                    yield match["text"], source.at(call)


def _is_own(warning: re.Match[str], below: str, look: Look) -> bool:
    if not own_frames([Frame(warning["file"], int(warning["line"]))]):
        return False
    if _GIVES_ONE.match(below):
        return True
    # With a stacklevel, a warning names the line of the caller.
    return any(
        text in warning["message"] for source in _files(warning["file"], look) for text, _ in _texts(source)
    )


def _files(file: str, look: Look) -> Iterator[PythonSource]:
    path = look.root / file
    if path.is_file():
        yield read_source(path, path.stem, file)
    yield from look.files


def _texts(source: PythonSource) -> Iterator[tuple[str, ast.AST]]:
    """Yield the longer strings of a file with their nodes; of format strings, the parts between values."""
    if source.tree is None or source.fault:
        return
    for node in source.nodes:
        for text in map(str.strip, VALUE.split(text_of(node))):
            if len(text) >= _SHORTEST:
                yield text, node


_REFUSED = re.compile(r"^Set(?:ting)? parameter (?:(?P<name>\S+) )?failed: (?P<reason>.+)")
_READ_ONLY = re.compile(r"read[-_ ]only", re.IGNORECASE)


def refused_setting(error: ErrorText, look: Look) -> Finding | None:
    """Say that a node refuses a value because of how it declares the parameter; None if it does not."""
    match = _REFUSED.match(error.decisive)
    if match is None:
        return None
    name, value = _set_by(error)
    name = match["name"] or name
    for package, place, is_limited in _declarations(name, look):
        if is_limited:
            reason = match["reason"].rstrip(".")
            cause = f"The node refuses the new value of {name}, as its declaration asks: {reason}"
            if _READ_ONLY.search(reason):
                start = f"--ros-args -p {name}:={value}" if value else "its parameter file"
                cause = f"The parameter {name} is read-only, as its declaration asks: it gets its value only when the node of {package.name} starts, by {start}"
            return Finding(SAID, f"{cause}.", place)
    return None


def _set_by(error: ErrorText) -> tuple[str, str]:
    """Return the parameter and the value in the command that was refused; empty if they are not known."""
    step = step_with(error.decisive, error.steps)
    words = words_in(step.command)
    plain = plain_words(words, 2) if words[:3] == ["ros2", "param", "set"] else []
    return (plain[1], plain[2]) if len(plain) > 2 else ("", "")


def _declarations(name: str, look: Look) -> Iterator[tuple[SourcePackage, str, bool]]:
    """Yield where a parameter is declared, and whether the declaration says more than its default."""
    for package in look.packages:
        sources = look.sources(package)
        for source in sources.sources.values():
            for node in source.nodes:
                match node:
                    case ast.Call(func=ast.Attribute(attr="declare_parameter"), args=[given, *more]):
                        if sources.value(source, given) == name:
                            words = {keyword.arg for keyword in node.keywords}
                            yield package, source.at(node), len(more) > 1 or "descriptor" in words
