"""Nodes that write at levels only that are not shown."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ros2lab.diagnose.sources.node_source import LOG_METHODS, NodeClass, NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource, walk

_LEVELS = {"debug": 10, "info": 20, "warn": 30, "warning": 30, "error": 40, "fatal": 50}
_SET = "set_level"
# What gives Python's own loggers a level or a place to write to, or a logger of ROS a level by its name.
_CONFIGURES = frozenset(
    ("basicConfig", "addHandler", "setLevel", "dictConfig", "fileConfig", "set_logger_level")
)


@dataclass(frozen=True)
class HiddenLogs:
    """The calls with which a node writes, all of them at a level that is not shown.

    Attributes:
        source: the file.
        calls: the calls.
        why: why they are not shown, as a sentence without its full stop.
        fix: what to write.
    """

    source: PythonSource
    calls: tuple[ast.Call, ...]
    why: str
    fix: str


def hidden_logs(sources: NodeSources, owner: NodeClass) -> HiddenLogs | None:
    """Return what a node writes if none of it is shown; None if some is, if it writes nothing, or if that is open."""
    source = owner.source
    words = {getattr(node, "attr", getattr(node, "id", "")) for node in source.nodes}
    if words & _CONFIGURES:
        return None
    calls = source.calls
    if any(getattr(call.func, "id", "") == "print" for call in calls):
        return None
    level, setting = _level_set(calls)
    written = [(call, *found) for call in calls if (found := _written(sources, source, call))]
    if (
        level is None
        or not written
        or not {id(call) for call, *_ in written} & {id(n) for n in walk(owner.definition)}
    ):
        return None
    if any(_LEVELS[how] >= (_LEVELS["warning"] if is_pythons else level) for _, how, is_pythons in written):
        return None
    first, how, is_pythons = written[0]
    text = ast.unparse(first.func)
    if is_pythons:
        why = f"What a logger of Python's logging writes with {how}() is not shown, because nothing sets its level"
        fix = f"write `self.get_logger().{how}(...)` instead of `{text}(...)`"
    elif setting is not None:
        name = next(name for name, number in _LEVELS.items() if number == level)
        why = f"Messages logged with {how}() are not shown, because line {setting.lineno} lets only {name}() and above be shown"
        fix = f"remove `{ast.unparse(setting)}`"
    else:
        why = f"Messages logged with {how}() are not shown: a terminal shows only info() and above"
        fix = f"write info instead of {how}; or start the node with --ros-args --log-level {how}"
    return HiddenLogs(source, tuple(call for call, *_ in written), why, fix)


def _level_set(calls: Sequence[ast.Call]) -> tuple[int | None, ast.Call | None]:
    """Return from which level on a file's node writes, None if that is open, and the call that sets it."""
    setting = [call for call in calls if getattr(call.func, "attr", "") == _SET]
    names = [ast.unparse(call.args[0]).rpartition(".")[2].lower() if call.args else "" for call in setting]
    if not setting:
        return _LEVELS["info"], None
    return (_LEVELS.get(names[0]), setting[0]) if len(setting) == 1 else (None, None)


def _written(sources: NodeSources, source: PythonSource, call: ast.Call) -> tuple[str, bool] | None:
    """Return the method of a call that logs, and whether the logger is one of Python's own; None for other calls."""
    if not isinstance(call.func, ast.Attribute) or call.func.attr not in LOG_METHODS or not call.args:
        return None
    for logger in _meant(source, call.func.value):
        named = sources.resolve(source, logger.func if isinstance(logger, ast.Call) else logger) or ""
        if named in ("logging", "logging.getLogger"):
            return call.func.attr, True
        made = logger.func if isinstance(logger, ast.Call) else None
        if getattr(made, "attr", getattr(made, "id", "")) == "get_logger":
            return call.func.attr, False
    return None


def _meant(source: PythonSource, logger: ast.expr) -> Iterator[ast.expr]:
    yield logger
    yield from (value for value in source.stored.get(ast.unparse(logger), ()) if value is not None)
