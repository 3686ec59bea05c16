"""A name that nothing defines, read as a text without its quotes."""

from __future__ import annotations

import ast
import re
import sys
from dataclasses import replace

from ros2lab.diagnose.code.unknown_names import Unknown, cause_of
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import PythonSource, last_name
from ros2lab.diagnose.sources.signatures import Parameter, kind_of, signature_of

_Reading = tuple[str, str]  # the cause, and the fix
IF_TEXT = " if it is meant as a string; otherwise "  # joins two fixes, of which the first is tried before it is told
_FILES = frozenset(("py", "xml", "yaml", "yml"))  # endings of file names, which look like attributes
_HOLDERS = (ast.List, ast.Tuple, ast.Dict, ast.Set)
_PATH_SIGNS = (ast.Div, ast.Sub, ast.MatMult)  # `/`, `-` and `@` in a string without quotes


def with_quotes(source: PythonSource, number: int, otherwise: str) -> PythonSource:
    """Return a file with quotes around the name that a fix of `as_text` says to define, on one of its lines."""
    name, lines = otherwise.split()[-2], source.text.split("\n")
    lines[number - 1] = re.sub(rf"(?<![\w.]){re.escape(name)}\b", repr(name), lines[number - 1])
    return replace(source, text="\n".join(lines))


def as_path(unknown: Unknown) -> _Reading | None:
    """A path, the name of a file or `__main__` without quotes: `launch/demo.launch.py`, or `share/ + package_name`."""
    if re.fullmatch(r"__\w+__", unknown.name):
        return f"The quotes around {unknown.name} are missing.", unknown.with_text(
            unknown.node, repr(unknown.name)
        )
    whole, text = _whole(unknown)
    if whole is unknown.node or not _may_be_text(unknown, whole):
        return None
    match whole:
        case ast.BinOp(right=ast.UnaryOp(op=ast.UAdd(), operand=rest)):  # a `/` ends it, and a `+` follows
            quoted = f"{text!r} + {ast.unparse(rest)}"
        case _:
            quoted = repr(text)
    return f"The quotes around {text} are missing.", unknown.with_text(whole, quoted)


def as_text(unknown: Unknown) -> _Reading | None:
    """A word without quotes, where a string makes sense and the name is used for nothing else."""
    if len(unknown.uses) > 1 or not _may_be_text(unknown, unknown.node):
        return None
    outer, call = unknown.node, unknown.above()
    while isinstance(call, _HOLDERS):
        outer, call = call, unknown.above(call)
    if isinstance(call, ast.Call):
        module = (unknown.source.resolve(call.func) or "").partition(".")[0]
        known = interfaces.PACKAGES | sys.stdlib_module_names | {unknown.source.name.partition(".")[0]}
        if module in {i.target.partition(".")[0] for i in unknown.source.imports} - known:
            return None  # what a library takes is not known
        if last_name(call.func) == "join" and call.args[0] is outer and len(call.args) > 1:
            return _as_share_folder(unknown)
    fix = unknown.with_text(unknown.node, repr(unknown.name))
    cause = cause_of(unknown)
    return cause, f"{fix}{IF_TEXT}import or define {unknown.name} above"


def _as_share_folder(unknown: Unknown) -> _Reading | None:
    """The name of the file's own package, as the first part of a path."""
    if not unknown.source.path or unknown.name not in unknown.source.path.parts:
        return None
    written = f"get_package_share_directory({unknown.name!r})"
    line = "from ament_index_python.packages import get_package_share_directory"
    more = "" if "get_package_share_directory" in unknown.source.names else f", with `{line}` at the top"
    cause = f"{unknown.name} is the name of the package, and not of a folder that Python knows."
    return cause, unknown.with_text(unknown.node, written) + more


def _may_be_text(unknown: Unknown, whole: ast.AST) -> bool:
    """Return whether an expression is an argument, an element or, if it looks like a path, any other value."""
    around = unknown.above(whole)
    if isinstance(around, ast.Call):
        given, signature = around.args, signature_of(unknown.source, around)
        wanted = signature.places[given.index(whole) :][:1] if signature and whole in given else []
        return whole in given and all(map(_takes_text, wanted))
    if isinstance(around, ast.keyword):
        call = unknown.above(around)
        signature = signature_of(unknown.source, call) if isinstance(call, ast.Call) else None
        named = signature.named(around.arg or "") if signature else None
        return named is None or _takes_text(named)
    if isinstance(around, (ast.List, ast.Tuple, ast.Set)) and {*map(kind_of, around.elts)} & {"int", "float"}:
        return False  # it lies beside a number
    is_joined = isinstance(around, ast.BinOp) and isinstance(around.op, ast.Add)
    is_value = isinstance(around, (*_HOLDERS, ast.Return, ast.Assign))
    return is_value or (is_joined and whole is not unknown.node)


def _takes_text(parameter: Parameter) -> bool:
    """Return whether a parameter accepts a string; rclpy annotates none of those that take a message's type."""
    return parameter.takes(ast.Constant("")) and not parameter.name.endswith("_type")


def _whole(unknown: Unknown) -> tuple[ast.AST, str]:
    """Return the expression that is the whole string without quotes, as `launch/demo.launch.py`; and the string."""
    node, text, source = unknown.node, unknown.name, unknown.source.text
    while isinstance(around := unknown.above(node), (ast.Attribute, ast.BinOp)):
        segment = ast.get_source_segment(source, around) or ""
        if isinstance(around, ast.BinOp):
            if not isinstance(around.op, _PATH_SIGNS):
                break
            if isinstance(around.right, ast.UnaryOp) and isinstance(around.right.op, ast.UAdd):
                return around, segment[: segment.index("+")].strip()
        if re.search(r"\s", segment):
            break
        node, text = around, segment
    is_file = text.rpartition(".")[2] in _FILES or isinstance(node, ast.BinOp)
    return (node, text) if is_file else (unknown.node, unknown.name)
