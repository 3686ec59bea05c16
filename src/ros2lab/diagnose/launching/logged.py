"""Rewrite a print as a call of the node's logger, with all that is printed in one text."""

from __future__ import annotations

import ast

from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.syntax_parts import makes_text


def as_logged(call: ast.Call, source: PythonSource) -> str:
    """Return the logger call that replaces a print; empty outside a method, where there is no node."""
    around = source.around(call.lineno, ast.FunctionDef)
    if not any([argument.arg for argument in node.args.args][:1] == ["self"] for node in around):
        return ""
    text = _text_of(call)
    return f"self.get_logger().info({text})" if text else ""


def _text_of(call: ast.Call) -> str:
    """Return the text that a print makes of its arguments; empty if no single expression can."""
    between = next((keyword.value for keyword in call.keywords if keyword.arg == "sep"), ast.Constant(" "))
    if not isinstance(between, ast.Constant):
        return ""
    sign = between.value if isinstance(between.value, str) else " "
    if any(isinstance(argument, ast.Starred) for argument in call.args):
        given = f"[{', '.join(map(ast.unparse, call.args))}]"
        return f"{sign!r}.join(map(str, {given}))"
    if len(call.args) == 1 and makes_text(call.args[0]):
        return ast.unparse(call.args[0])
    parts: list[ast.expr] = []
    for number, value in enumerate(call.args):
        parts += [ast.Constant(sign)] if number else []
        parts += _parts_of(value)
    joined = ast.JoinedStr(parts)
    if all(isinstance(part, ast.Constant) for part in parts):
        return repr("".join(str(part.value) for part in parts if isinstance(part, ast.Constant)))
    try:
        text = ast.unparse(joined)
        ast.parse(text, mode="eval")
    except (SyntaxError, ValueError):
        return ""
    return text


def _parts_of(value: ast.expr) -> list[ast.expr]:
    match value:
        case ast.Constant(value=str()):
            return [value]
        case ast.JoinedStr(values=values):
            return values
    return [ast.FormattedValue(value, -1)]
