"""Explains odd values that a program prints without an error: nan, with which every comparison is false."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.sources.joined_texts import text_pattern
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
                    yield from made_of_many(source, _behind(function, node))


def _shows(call: ast.Call, line: str) -> bool:
    """Return whether a line may be what a logging call shows: all of its fixed text is in it."""
    pattern = ".*".join(map(text_pattern, call.args))
    return re.search(r"\w", pattern) is not None and re.search(pattern, line) is not None


def _behind(function: Function, call: ast.Call) -> list[ast.expr]:
    """Return what a call is given, with what a function assigns to the names in that."""
    names = {n.id for argument in call.args for n in walk(argument) if isinstance(n, ast.Name)}
    own = [node for node in own_nodes(function) if isinstance(node, ast.Assign)]
    values = [
        node.value for node in own if any(getattr(target, "id", "") in names for target in node.targets)
    ]
    return [*call.args, *values]


def made_of_many(source: PythonSource, expressions: Iterable[ast.expr]) -> Iterator[Finding]:
    """Yield the calls in some expressions that come out as nan because they compute it from many values."""
    for node in (inner for expression in expressions for inner in walk(expression)):
        match node:
            case ast.Call(func=how, args=[many]) if ast.unparse(how).rpartition(".")[2] in _OF_MANY:
                text, name = ast.unparse(many), ast.unparse(how)
                if "isnan" in text or "isfinite" in text:
                    continue
                cause = f"`{ast.unparse(node)}` comes out as nan: one of the values in {text} is nan, and every comparison with nan is false."
                empty = {"min": ", default=math.inf", "max": ", default=-math.inf"}.get(name, "")
                fix = f"write {name}([v for v in {text} if math.isfinite(v)]{empty}), and `import math` at the top of the file{'' if empty else '; decide what to do when none is left'}"
                yield Finding("value-nan", cause, source.at(node), fix)
