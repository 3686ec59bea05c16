"""Values that a launch file gives a node under another keyword than the one that takes values of their form."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.signatures import signature_of
from ros2lab.diagnose.sources.static_value import UNKNOWN, evaluate

_OPTIONS = frozenset(("-p", "--param", "-r", "--remap", "-e", "--log-level", "--params-file"))


def misplaced_values(source: PythonSource) -> Iterator[Finding]:
    """Yield keywords of nodes that do not take what they are given, where its form says which one does."""
    for call in source.nodes:
        if not isinstance(call, ast.Call) or not (source.resolve(call.func) or "").startswith("launch_ros."):
            continue
        signature = signature_of(source, call)
        known = {one.name for one in signature.parameters} if signature and not signature.is_open else set()
        given = {keyword.arg for keyword in call.keywords}
        if not {"parameters", "remappings", "arguments"} <= known:
            continue
        for keyword in call.keywords:
            form, written = _form(keyword.value)
            if keyword.arg is None or not form or (form in given and form != keyword.arg):
                continue
            name = keyword.arg
            is_other = name in ("arguments", "parameters", "ros_arguments") and not _takes(
                name, keyword.value
            )
            if name not in known or is_other:
                new = _options(keyword.value) if name == "ros_arguments" else f"{form}={written}"
                what = {
                    "parameters": "a dict of parameter values",
                    "remappings": "pairs of old and new names",
                }
                cause = f"{name} is given {what[form]}, which belong elsewhere."
                yield Finding(
                    "launch-argument",
                    cause,
                    source.at(keyword.value),
                    f"write {new} instead of {name}={ast.unparse(keyword.value)}",
                )


def _form(value: ast.expr) -> tuple[str, str]:
    """Return which keyword takes values of this form, and how they are written there; empty if that is open."""
    items = value.elts if isinstance(value, (ast.List, ast.Tuple)) else [value]
    if not items:
        return "", ""
    if all(isinstance(one, ast.Dict) for one in items):
        return "parameters", f"[{', '.join(map(ast.unparse, items))}]"
    texts = [evaluate(one, {}, {}) for one in items]
    words = [one for one in texts if isinstance(one, str) and ":=" in one and one not in _OPTIONS]
    if len(words) == len(items):
        pairs = (word.partition(":=") for word in words)
        return "parameters", f"[{{{', '.join(f'{old!r}: {_value(new)!r}' for old, _, new in pairs)}}}]"
    if all(isinstance(one, ast.Tuple) and len(one.elts) == 2 for one in items):
        pairs_of = [one.elts for one in items if isinstance(one, ast.Tuple)]
        values = ", ".join(f"{ast.unparse(old)}: {ast.unparse(new)}" for old, new in pairs_of)
        return ("remappings", ast.unparse(value)) if _are_names(items) else ("parameters", f"[{{{values}}}]")
    return "", ""


def _are_names(items: list[ast.expr]) -> bool:
    """Return whether all pairs may be names of topics or the like: texts, of which one has a slash."""
    texts = [evaluate(one, {}, {}) for pair in items if isinstance(pair, ast.Tuple) for one in pair.elts]
    return all(isinstance(one, str) for one in texts) and any("/" in one for one in texts)


def _takes(name: str, value: ast.expr) -> bool:
    """Return whether a keyword that there is takes a value of this form."""
    items = value.elts if isinstance(value, (ast.List, ast.Tuple)) else []
    if not items:
        return True  # that brackets are missing is told already
    if name == "parameters":
        return not all(
            isinstance(one, ast.Tuple) or ":=" in str(evaluate(one, {}, {})) for one in items
        ) or any(isinstance(one, ast.Dict) for one in items)
    if name == "ros_arguments":
        return not all(isinstance(one, ast.Constant) and ":=" in str(one.value) for one in items)
    return not any(isinstance(one, (ast.Dict, ast.Tuple)) for one in items)


def _options(value: ast.expr) -> str:
    """Write what ROS reads on its command line with the option in front of each of its parts."""
    words = [str(evaluate(one, {}, {})) for one in getattr(value, "elts", [])]
    return f"ros_arguments={[part for word in words for part in ('-p', word)]!r}"


def _value(text: str) -> object:
    """Return the value that a text stands for."""
    if text in ("true", "false"):
        return text == "true"
    found = UNKNOWN if text.isidentifier() else evaluate(_parsed(text), {}, {})
    return text if found is UNKNOWN else found


def _parsed(text: str) -> ast.expr | None:
    try:
        return ast.parse(text, mode="eval").body
    except SyntaxError:
        return None
