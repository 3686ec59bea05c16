"""What a name that nothing defines is meant for: an object at hand, or a text without its quotes."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from dataclasses import replace

from ros2lab.diagnose.code.unknown_names import Unknown, also_on, cause_of
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.construction import is_node_class
from ros2lab.diagnose.sources.node_source import is_self_attribute
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    last_name,
    own_nodes,
    parameters,
    walk,
)
from ros2lab.diagnose.sources.signatures import Parameter, kind_of, signature_of
from ros2lab.diagnose.sources.spelling import edits

_NEAR = 2  # letters that differ
_SPUN = ("rclpy.spin", "rclpy.spin_once", "rclpy.spin_until_future_complete")
# What the methods of a node make, by the modules and names of their classes.
_MADE = {
    "create_publisher": ("rclpy.publisher", "Publisher"),
    "create_client": ("rclpy.client", "Client"),
    "create_timer": ("rclpy.timer", "Timer"),
    "create_subscription": ("rclpy.subscription", "Subscription"),
    "create_node": ("rclpy.node", "Node"),
}


def as_at_hand(unknown: Unknown) -> tuple[str, str] | None:
    """Read the name as the only variable around it that holds what its uses ask for: `talker.destroy_node()`."""
    is_node = any(_is_spun(unknown, use) for use in unknown.uses)
    if not (unknown.attributes or is_node) or f"self.{unknown.name}" in unknown.source.stored:
        return None
    names = holders(unknown, unknown.attributes, is_node=is_node)
    if len(names) != 1 or (names[0] not in unknown.loaded and edits(names[0], unknown.name) <= _NEAR):
        return None  # it may be misspelt where it is assigned
    cause = f"{cause_of(unknown)} Did you mean {names[0]}?"
    return cause, unknown.with_text(unknown.node, names[0]) + also_on(unknown, names[0])


def as_method(unknown: Unknown) -> tuple[str, str] | None:
    """Read the name as a method of the only object around it that has it: `get_logger()` for `node.get_logger()`."""
    call, name = unknown.above(), unknown.name
    if not unknown.is_called or not isinstance(call, ast.Call) or f"self.{name}" in unknown.source.stored:
        return None
    names = holders(unknown, {name})
    if len(names) != 1 and not (names and name.startswith("get_")):
        return None
    whole = f"{names[0]}.{name}"
    signature = signature_of(
        unknown.source, ast.Call(ast.parse(whole, mode="eval").body, call.args, call.keywords)
    )
    if signature and not signature.accepts(call):
        return None
    cause = f"{name} is a method, so it is called with its object before it, which is {names[0]} here."
    return cause, unknown.with_text(unknown.node, whole)


def as_exception(unknown: Unknown) -> tuple[str, str] | None:
    """Read `e` in an `except` that gives the exception no name."""
    node = unknown.node
    while not isinstance(node, (ast.Module, Function, ast.ExceptHandler)):
        node = unknown.above(node)
    word = unknown.name.lower()
    is_exception = any(whole.startswith(word) for whole in ("error", "exception", "exc", "err"))
    if not isinstance(node, ast.ExceptHandler) or node.name or not is_exception:
        return None
    kind = ast.unparse(node.type) if node.type else "Exception"
    cause = f"{cause_of(unknown)} The `except` on line {node.lineno} gives the exception no name."
    return cause, f"write `except {kind} as {unknown.name}:` on line {node.lineno}"


def is_own_node(unknown: Unknown, name: str) -> bool:
    """Return whether a name is that of a node class of the file, or of Node itself."""
    return is_node_class(unknown.source, ast.Name(name))


def holders(unknown: Unknown, wanted: set[str], *, is_node: bool = False) -> list[str]:
    """Return the variables and attributes of `self` of the innermost scope that surely have the wanted members."""
    found = ([*dict.fromkeys(_held(unknown, scope, wanted, is_node=is_node))] for scope in unknown.scopes)
    return next(filter(None, found), [])


def _held(unknown: Unknown, scope: ast.AST, wanted: set[str], *, is_node: bool) -> Iterator[str]:
    line = getattr(unknown.node, "lineno", 0)
    for node in own_nodes(scope):
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call() as call) if node.lineno < line:
                if _fits(unknown, call, wanted, is_node=is_node):
                    yield name
    owner = unknown.above(scope)
    is_method = isinstance(owner, ast.ClassDef) and isinstance(scope, Function)
    if not (is_method and isinstance(scope, Function) and [p.arg for p in parameters(scope)][:1] == ["self"]):
        return
    assert isinstance(owner, ast.ClassDef)
    if is_own_node(unknown, owner.name) and wanted <= _members(unknown, owner.name):
        yield "self"
    for node in walk(owner):
        match node:
            case ast.Assign(
                targets=[ast.Attribute(value=ast.Name(id="self"), attr=name)], value=ast.Call() as call
            ) if _fits(unknown, call, wanted, is_node=is_node):
                yield f"self.{name}"


def _fits(unknown: Unknown, call: ast.Call, wanted: set[str], *, is_node: bool) -> bool:
    name = last_name(call.func)
    members = _members(unknown, name)
    is_made = is_own_node(unknown, name) or name == "create_node"
    return (is_made or not is_node) and bool(members) and wanted <= members


def _members(unknown: Unknown, name: str) -> set[str]:
    """Return what an object has that a class of the file, Node or a method of a node makes; empty if not known."""
    if name in _MADE:
        return {*interfaces.members_of(*_MADE[name])}
    if not is_own_node(unknown, name):
        return set()
    definition = unknown.source.classes.get(name)
    own = walk(definition) if definition else ()
    found = {
        getattr(n, "attr", getattr(n, "name", ""))
        for n in own
        if is_self_attribute(n) or isinstance(n, Function)
    }
    return found | {*interfaces.node_members()}


def _is_spun(unknown: Unknown, use: ast.Name) -> bool:
    around = unknown.above(use)
    if not (isinstance(around, ast.Call) and around.args[:1] == [use]):
        return False
    return unknown.source.resolve(around.func) in _SPUN or getattr(around.func, "attr", "") == "add_node"


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
