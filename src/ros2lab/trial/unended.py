"""Why a program went on after Ctrl-C: a thread that keeps it, or a loop that takes Ctrl-C for an error."""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.entrance import Call, Entrance
from ros2lab.diagnose.sources.python_source import walk
from ros2lab.diagnose.sources.static_value import expression
from ros2lab.grading.evidence import Run

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen

_THREADS = ("threading.Thread", "threading.Timer")
_LEAVES = (ast.Break, ast.Return, ast.Raise)


def unended_faults(seen: Seen, run: Run, name: str) -> Iterator[Finding]:
    """Yield what keeps a program that had to be killed after Ctrl-C, where its files tell it."""
    entrance = seen.entrance(name) if run.stopped.get(name, {}).get("killed") else None
    if entrance is None:
        return
    if found := next(_deaf_loops(entrance, name), None) or next(_keeping_threads(entrance, name), None):
        yield found


def _keeping_threads(entrance: Entrance, name: str) -> Iterator[Finding]:
    """Yield threads for whose end Python waits, and that do not end."""
    marked = {
        ast.unparse(target.value)
        for function in entrance.functions
        for node in walk(function)
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Attribute) and target.attr == "daemon"
    }
    for one in entrance.calls:
        is_daemon = any(
            word.arg == "daemon" and ast.unparse(word.value) != "False" for word in one.call.keywords
        )
        if one.name not in _THREADS or is_daemon or _kept_as(one) in marked or _asks(entrance, one):
            continue
        kept = _kept_as(one)
        if one.short == "Thread":
            demon = copy.deepcopy(one.call)
            demon.keywords = [w for w in demon.keywords if w.arg != "daemon"]
            demon.keywords.append(ast.keyword("daemon", expression("True") or ast.Constant(True)))
            fix = f"write `{ast.unparse(demon)}`, or make its loop `while rclpy.ok():`"
        else:
            fix = (
                f"write `{kept or 'timer'}.daemon = True` before its start(), or use the node's create_timer"
            )
        cause = f"{name} did not end at Ctrl-C: Python waits for every thread that is not a daemon, and `{ast.unparse(one.call)}` keeps running."
        yield Finding("never-ends", cause, one.source.at(one.call), fix)


def _asks(entrance: Entrance, one: Call) -> bool:
    """Return whether the loops of what a thread runs end with ROS: `while rclpy.ok()`."""
    given = [word.value for word in one.call.keywords if word.arg == "target"]
    names = {getattr(value, "attr", getattr(value, "id", "")) for value in given}
    run = [function for function in entrance.functions if function.name in names]
    loops = [node for function in run for node in walk(function) if isinstance(node, ast.While)]
    asked = [{getattr(n, "attr", "") for n in ast.walk(loop.test)} for loop in loops]
    return bool(asked) and all("ok" in names for names in asked)


def _kept_as(one: Call) -> str:
    """Return what a thread is kept in; empty if it is not kept."""
    for node in walk(one.function):
        if isinstance(node, ast.Assign) and node.value is one.call:
            return ast.unparse(node.targets[0])
    return ""


def _deaf_loops(entrance: Entrance, name: str) -> Iterator[Finding]:
    """Yield handlers in endless loops that catch Ctrl-C and go on."""
    sources = {id(one.function): one.source for one in entrance.calls}
    for function in entrance.functions:
        for loop in walk(function):
            if not isinstance(loop, ast.While) or not isinstance(loop.test, ast.Constant):
                continue
            handlers = [h for n in loop.body if isinstance(n, ast.Try) for h in n.handlers]
            for handler in handlers:
                caught = ast.unparse(handler.type) if handler.type else ""
                is_deaf = caught in ("", "BaseException") or "KeyboardInterrupt" in caught
                if is_deaf and not any(isinstance(n, _LEAVES) for n in ast.walk(handler)):
                    text = f"except {caught}:".replace(" :", ":")
                    cause = f"{name} did not end at Ctrl-C: `{text}` catches the KeyboardInterrupt, and the loop goes on."
                    fix = (
                        "write `break` in it"
                        if caught == "KeyboardInterrupt"
                        else f"write `except Exception:` instead of `{text}`"
                    )
                    yield Finding("never-ends", cause, sources[id(function)].at(handler), fix)
