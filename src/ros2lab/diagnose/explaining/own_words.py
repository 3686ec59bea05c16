"""Recognizes messages and warnings of the student's own code, which are no errors of ROS or Python."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.causes.waited import waited_for
from ros2lab.diagnose.explaining.refused_settings import refused_setting
from ros2lab.diagnose.finding import SAID, Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText, Frame, own_frames
from ros2lab.diagnose.printed.spots import Spot, spot_at
from ros2lab.diagnose.printed.transcript import WARNING
from ros2lab.diagnose.sources.joined_texts import VALUE, text_of, text_pattern
from ros2lab.diagnose.sources.python_source import PythonSource, read_source
from ros2lab.diagnose.sources.uses import is_log

_GIVES_ONE = re.compile(r"\s*(?:warnings\.)?warn\(")
_LOG_LINE = re.compile(
    r"\[(?P<level>DEBUG|INFO|WARN|ERROR|FATAL)\] (?:\[[\d.]+\] )?\[(?P<logger>[\w.]+)\]: (?P<text>.*)"
)
_SHORTEST = 8  # characters of a text that is recognized

_NO_MODULE = re.compile(r"No module named '?([\w.]+)")


def without_own(text: str, look: Look) -> str:
    """Remove what the student's own code says, and no error is: its warnings, and imports that it has caught."""
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
        names = sources.node_names()
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
