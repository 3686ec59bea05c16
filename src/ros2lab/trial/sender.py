"""Records inside a running program what it publishes; imports nothing of ros2lab.

`witness` imports it. At exit each process writes a file: who it is, and for each topic how many messages it
published, with the first and the last of them. From outside, two programs that publish on one topic cannot be told
apart.
"""

# Every program imports it first, so it must not import pathlib.
# ruff: noqa: PTH118, PTH123

import ast
import atexit
import builtins
import contextlib
import importlib.machinery
import json
import math
import os
import sys
import time
from collections import deque
from collections.abc import Iterable
from itertools import islice
from types import CodeType
from typing import Any

ENDING = ".sent"
_NAME, _MODULE, _METHOD = "ros2lab_sent", "rclpy.publisher", "publish"
_ITEMS, _DEPTH, _TEXT, _KEPT = 12, 6, 120, 500


class _Sent:
    """What was published on a topic: how often, and the first and last messages with their times."""

    def __init__(self) -> None:
        self.count = 0
        self.first: list[tuple[float, Any]] = []
        self.last: deque[tuple[float, Any]] = deque(maxlen=_KEPT)

    def note(self, message: Any) -> None:
        self.count += 1
        noted = time.monotonic(), _plain(message, _DEPTH)
        if len(self.first) < _KEPT:
            self.first.append(noted)
        else:
            self.last.append(noted)


def _plain(value: Any, depth: int) -> Any:
    """Return a message, or a field of one, as JSON data, shortened."""
    found = value
    if isinstance(value, float):
        found = value if math.isfinite(value) else str(value)
    elif isinstance(value, str):
        found = value if len(value) <= _TEXT else f"{value[:_TEXT]}..."
    elif isinstance(value, bytes) or depth == 0:
        found = None
    elif hasattr(value, "get_fields_and_field_types"):
        found = {name: _plain(getattr(value, name), depth - 1) for name in value.get_fields_and_field_types()}
    elif hasattr(value, "tolist"):
        found = value[:_ITEMS].tolist()
    elif isinstance(value, Iterable):
        found = [_plain(item, depth - 1) for item in islice(value, _ITEMS)]
    return found


def begin(folder: str) -> None:
    """Record what this process publishes from now on, and write it into a folder at exit."""
    sent: dict[str, _Sent] = {}

    def note(publisher: Any, message: Any) -> None:
        with contextlib.suppress(Exception):  # nothing of this may reach the program
            sent.setdefault(publisher.topic_name, _Sent()).note(message)

    def write() -> None:
        with contextlib.suppress(Exception):  # such as of a thread that still publishes
            found = {topic: [one.count, [*one.first, *one.last]] for topic, one in sent.items()}
            told = {"program": sys.argv[0], "domain": os.environ.get("ROS_DOMAIN_ID", ""), "sent": found}
            with open(os.path.join(folder, f"{os.getpid()}{ENDING}"), "w", encoding="utf-8") as file:
                json.dump(told, file)

    setattr(builtins, _NAME, note)
    atexit.register(write)
    loader = importlib.machinery.SourceFileLoader
    plain = loader.get_code

    def get_code(self: Any, name: str) -> CodeType | None:
        if name != _MODULE:
            return plain(self, name)
        try:
            path = self.get_filename(name)
            tree = ast.parse(self.get_data(path), path)
            for node in ast.walk(tree):
                if isinstance(node, ast.FunctionDef) and node.name == _METHOD:
                    own, message = (ast.Name(arg.arg, ast.Load()) for arg in node.args.args[:2])
                    call = ast.Expr(ast.Call(ast.Name(_NAME, ast.Load()), [own, message], []))
                    node.body.append(ast.copy_location(call, node.body[-1]))  # only what was sent
            code: CodeType = compile(ast.fix_missing_locations(tree), path, "exec", dont_inherit=True)
        except Exception:
            return plain(self, name)
        return code

    setattr(loader, "get_code", get_code)  # noqa: B010 -- a method of the standard library
