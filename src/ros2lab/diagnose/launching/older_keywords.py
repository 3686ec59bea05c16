"""Keyword arguments of launch files that have a shorter name now, such as `node_executable`."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.signatures import signature_by_name


def older_keywords(source: PythonSource) -> Iterator[Finding]:
    """Yield the calls of nodes in a launch file with keywords that older versions of ROS had."""
    for call in source.nodes:
        name = (source.resolve(call.func) or "") if isinstance(call, ast.Call) else ""
        if not isinstance(call, ast.Call) or not name.startswith("launch_ros.actions."):
            continue
        signature = signature_by_name(name)
        taken = {parameter.name for parameter in signature.parameters} if signature else set()
        given = {keyword.arg for keyword in call.keywords}
        renamed = {
            keyword.arg: short
            for keyword in call.keywords
            if keyword.arg and keyword.arg not in taken
            if (short := keyword.arg.removeprefix("node_")) in taken - given and short != keyword.arg
        }
        if renamed:
            are = "are keywords" if len(renamed) > 1 else "is a keyword"
            now = "they are called" if len(renamed) > 1 else "it is called"
            cause = f"{' and '.join(renamed)} {are} of older versions of ROS; now {now} {' and '.join(renamed.values())}."
            old = [keyword for keyword in call.keywords if keyword.arg in renamed]
            fixes = [f"{renamed[k.arg]}= instead of {k.arg}= on line {k.value.lineno}" for k in old if k.arg]
            yield Finding("launch-argument", cause, source.at(old[0].value), f"write {', and '.join(fixes)}")
