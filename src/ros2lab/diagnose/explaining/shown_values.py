"""Explains odd values that a program prints without an error: nan, with which every comparison is false."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, walk
from ros2lab.diagnose.sources.uses import is_log

_NAN = re.compile(r"(?<![\w.])-?nan(?![\w.])")
# Functions of many values whose result is nan if one value is; for min and max, its position matters.
_OF_MANY = frozenset(
    ("min", "max", "sum", "sorted", "mean", "average", "median", "amin", "amax", "std", "fmean")
)


def shown_values(error: ErrorText, look: Look) -> Iterator[Finding]:
    """Yield where a value that is printed as nan was computed from several values."""
    lines = [line for line in error.text.splitlines() if _NAN.search(line)]
    for package in look.packages if lines else ():
        sources = look.sources(package)
        for source in sources.sources.values():
            for _, function, node in sources.scoped(source):
                if function is None or not isinstance(node, ast.Call) or not is_log(node):
                    continue
                if any(_shows(node, line) for line in lines):
                    yield from _made_of(source, function, node)


def _shows(call: ast.Call, line: str) -> bool:
    """Return whether a line contains all fixed text of a logging call that also shows values."""
    texts = [n.value for n in walk(call) if isinstance(n, ast.Constant) and isinstance(n.value, str)]
    fixed = [part for text in texts for part in re.split(r"%[-+ #0]*[\d.]*[sdrfgeG]|\{[^{}]*\}", text)]
    has_values = any(
        isinstance(n, (ast.Name, ast.Attribute)) for argument in call.args for n in walk(argument)
    )
    # Format specifications are strings, too, but are not printed.
    shown = [
        part for part in fixed if len(part.strip()) > 1 and not re.fullmatch(r"[<>^+]?\d*\.?\d*[a-z%]?", part)
    ]
    return has_values and bool(shown) and all(part in line for part in shown)


def _made_of(source: PythonSource, function: Function, call: ast.Call) -> Iterator[Finding]:
    """Yield the calls that compute a value that is shown from many values."""
    names = {n.id for argument in call.args for n in walk(argument) if isinstance(n, ast.Name)}
    own = [node for node in own_nodes(function) if isinstance(node, ast.Assign)]
    values = [
        node.value for node in own if any(getattr(target, "id", "") in names for target in node.targets)
    ]
    made = [inner for value in (*call.args, *values) for inner in walk(value)]
    for node in made:
        match node:
            case ast.Call(func=how, args=[many]) if ast.unparse(how).rpartition(".")[2] in _OF_MANY:
                text, name = ast.unparse(many), ast.unparse(how)
                if "isnan" in text or "isfinite" in text:
                    continue
                cause = f"`{ast.unparse(node)}` comes out as nan: one of the values in {text} is nan, and every comparison with nan is false."
                fix = f"write {name}([v for v in {text} if math.isfinite(v)]), and `import math` at the top of the file; decide what to do when none is left"
                yield Finding("value-nan", cause, source.at(node), fix)
