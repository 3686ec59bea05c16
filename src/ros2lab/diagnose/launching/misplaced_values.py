"""Values that a launch file gives a node by the wrong keyword, as their form shows, or by one of older versions."""

from __future__ import annotations

import ast
import contextlib
import re
import shlex
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_arguments import calls_of_launch
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.signatures import signature_by_name, signature_of
from ros2lab.diagnose.sources.static_value import evaluate

_WORDS = ("arguments", "ros_arguments", "cmd")  # what takes a list of words
# Options that ROS reads only after --ros-args.
OPTIONS = frozenset(("-p", "--param", "-r", "--remap", "--params-file", "--log-level", "-e", "--enclave"))


def misplaced_values(source: PythonSource) -> Iterator[Finding]:
    """Yield keyword arguments of nodes whose value has a form that only another keyword takes."""
    for _, call in calls_of_launch(source, "launch_ros."):
        signature = signature_of(source, call)
        parameters = signature.parameters if signature and not signature.is_open else ()
        known = {parameter.name for parameter in parameters}
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
                fix = f"write {new} instead of {name}={ast.unparse(keyword.value)}"
                yield Finding("launch-argument", cause, source.at(keyword.value), fix)


def joined_words(source: PythonSource) -> Iterator[Finding]:
    """Yield items of a list of words that hold several: each item reaches the program as a single word."""
    for _, call in calls_of_launch(source, "launch"):
        has_shell = any(keyword.arg == "shell" for keyword in call.keywords)
        for keyword in call.keywords:
            items = keyword.value.elts if isinstance(keyword.value, ast.List) else []
            pairs = zip([None, *items], items, strict=False)
            for before, item in pairs if keyword.arg in _WORDS and not has_shell else ():
                words = _words(item, is_program=keyword.arg == "cmd" and item is items[0])
                if len(words) > 1 and not _may_be_value(before):
                    text = ast.literal_eval(item)
                    cause = f"Each item of {keyword.arg} is one word, so the program is given {text!r} as a single one."
                    fix = f"write {', '.join(map(repr, words))} instead of {text!r}"
                    yield Finding("launch-argument", cause, source.at(item), fix, (text,))


def older_keywords(source: PythonSource) -> Iterator[Finding]:
    """Yield the calls of nodes in a launch file with keywords that older versions of ROS had."""
    for name, call in calls_of_launch(source, "launch_ros.actions."):
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
            yield Finding("launch-argument", cause, source.at(call), f"write {', and '.join(fixes)}")


def _words(item: ast.expr, *, is_program: bool) -> list[str]:
    """Return the words of an item that begins with an option, or with a program; else none."""
    text = item.value if isinstance(item, ast.Constant) else None
    if not isinstance(text, str) or not (is_program or re.match(r"(-[a-z]|--[a-z-]+) ", text)):
        return []
    with contextlib.suppress(ValueError):
        return shlex.split(text)
    return []


def _may_be_value(before: ast.expr | None) -> bool:
    """Return whether what comes after an item may be the value of an option, such as words for another program."""
    text = before.value if isinstance(before, ast.Constant) else None
    return (
        isinstance(text, str) and text != "--ros-args" and re.fullmatch(r"--?[a-z][\w-]*", text) is not None
    )


def _form(value: ast.expr) -> tuple[str, str]:
    """Return the keyword that takes values of this form, and how they are written there; empty if unclear."""
    items = value.elts if isinstance(value, (ast.List, ast.Tuple)) else [value]
    if not items:
        return "", ""
    if all(isinstance(item, ast.Dict) for item in items):
        return "parameters", f"[{', '.join(map(ast.unparse, items))}]"
    texts = [evaluate(item, {}, {}) for item in items]
    words = [text for text in texts if isinstance(text, str) and ":=" in text and text not in OPTIONS]
    if len(words) == len(items):
        pairs = (word.partition(":=") for word in words)
        return "parameters", f"[{{{', '.join(f'{old!r}: {value_of(new)!r}' for old, _, new in pairs)}}}]"
    if all(isinstance(item, ast.Tuple) and len(item.elts) == 2 for item in items):
        pairs_of = [item.elts for item in items if isinstance(item, ast.Tuple)]
        values = ", ".join(f"{ast.unparse(old)}: {ast.unparse(new)}" for old, new in pairs_of)
        return ("remappings", ast.unparse(value)) if _are_names(items) else ("parameters", f"[{{{values}}}]")
    return "", ""


def _are_names(items: list[ast.expr]) -> bool:
    """Return whether all pairs may be names of topics or the like: strings, at least one with a slash."""
    texts = [evaluate(name, {}, {}) for pair in items if isinstance(pair, ast.Tuple) for name in pair.elts]
    return all(isinstance(text, str) for text in texts) and any("/" in text for text in texts)


def _takes(name: str, value: ast.expr) -> bool:
    """Return whether an existing keyword takes a value of this form."""
    items = value.elts if isinstance(value, (ast.List, ast.Tuple)) else []
    if not items:
        return True  # missing brackets are reported elsewhere
    if name == "parameters":
        return not all(
            isinstance(item, ast.Tuple) or ":=" in str(evaluate(item, {}, {})) for item in items
        ) or any(isinstance(item, ast.Dict) for item in items)
    if name == "ros_arguments":
        return not all(isinstance(item, ast.Constant) and ":=" in str(item.value) for item in items)
    return not any(isinstance(item, (ast.Dict, ast.Tuple)) for item in items)


def _options(value: ast.expr) -> str:
    """Return ros_arguments with the option -p in front of each of its words."""
    words = [str(evaluate(element, {}, {})) for element in getattr(value, "elts", [])]
    return f"ros_arguments={[part for word in words for part in ('-p', word)]!r}"


def value_of(text: str) -> object:
    """Return the value of a text as ROS reads it."""
    if text in ("true", "false"):
        return text == "true"
    try:
        value = ast.literal_eval(text)
    except (ValueError, SyntaxError):
        return text
    return value if isinstance(value, (int, float, str, list)) else text
