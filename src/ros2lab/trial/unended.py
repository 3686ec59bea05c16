"""Explains why a program kept running after Ctrl-C: a thread, or a loop that catches KeyboardInterrupt."""

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
    """Yield what kept a program running that had to be killed after Ctrl-C, if its sources show it."""
    entrance = seen.entrance(name) if run.stopped.get(name, {}).get("killed") else None
    if entrance is None:
        return
    if found := next(_deaf_loops(entrance, name), None) or next(_keeping_threads(entrance, name), None):
        yield found


def _keeping_threads(entrance: Entrance, name: str) -> Iterator[Finding]:
    """Yield threads that Python waits for and that do not end."""
    marked = {
        ast.unparse(target.value)
        for function in entrance.functions
        for node in walk(function)
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Attribute) and target.attr == "daemon"
    }
    for call in entrance.calls:
        is_daemon = any(
            word.arg == "daemon" and ast.unparse(word.value) != "False" for word in call.call.keywords
        )
        if call.name not in _THREADS or is_daemon or _kept_as(call) in marked or _asks(entrance, call):
            continue
        kept = _kept_as(call)
        if call.short == "Thread":
            demon = copy.deepcopy(call.call)
            demon.keywords = [w for w in demon.keywords if w.arg != "daemon"]
            demon.keywords.append(ast.keyword("daemon", expression("True") or ast.Constant(True)))
            fix = f"write `{ast.unparse(demon)}`, or make its loop `while rclpy.ok():`"
        else:
            fix = (
                f"write `{kept or 'timer'}.daemon = True` before its start(), or use the node's create_timer"
            )
        cause = f"{name} did not end at Ctrl-C: Python waits for every thread that is not a daemon, and `{ast.unparse(call.call)}` keeps running."
        yield Finding("never-ends", cause, call.source.at(call.call), fix)


def _asks(entrance: Entrance, call: Call) -> bool:
    """Return whether all loops of the function that a thread runs end when ROS does: `while rclpy.ok()`."""
    given = [word.value for word in call.call.keywords if word.arg == "target"]
    names = {getattr(value, "attr", getattr(value, "id", "")) for value in given}
    run = [function for function in entrance.functions if function.name in names]
    loops = [node for function in run for node in walk(function) if isinstance(node, ast.While)]
    asked = [{getattr(n, "attr", "") for n in ast.walk(loop.test)} for loop in loops]
    return bool(asked) and all("ok" in names for names in asked)


def _kept_as(call: Call) -> str:
    """Return the name to which a thread is assigned; empty if it is not assigned."""
    for node in walk(call.function):
        if isinstance(node, ast.Assign) and node.value is call.call:
            return ast.unparse(node.targets[0])
    return ""


def _deaf_loops(entrance: Entrance, name: str) -> Iterator[Finding]:
    """Yield handlers in endless loops that catch Ctrl-C and go on."""
    sources = {id(call.function): call.source for call in entrance.calls}
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
