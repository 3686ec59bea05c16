"""A print as what the logger of its node says instead: one text of all that is printed."""

from __future__ import annotations

import ast

from ros2lab.diagnose.sources.python_source import PythonSource


def as_logged(call: ast.Call, source: PythonSource) -> str:
    """Return a call of the logger that says what a print says; empty where no node is at hand."""
    around = [
        node
        for node in source.nodes
        if isinstance(node, ast.FunctionDef) and node.lineno <= call.lineno <= (node.end_lineno or 0)
    ]
    if not any([one.arg for one in node.args.args][:1] == ["self"] for node in around):
        return ""
    text = _text_of(call)
    return f"self.get_logger().info({text})" if text else ""


def _text_of(call: ast.Call) -> str:
    """Return the one text that a print makes of its values; empty if it cannot be written as one."""
    between = next((one.value for one in call.keywords if one.arg == "sep"), ast.Constant(" "))
    if not isinstance(between, ast.Constant):
        return ""
    sign = between.value if isinstance(between.value, str) else " "
    if any(isinstance(one, ast.Starred) for one in call.args):
        given = f"[{', '.join(map(ast.unparse, call.args))}]"
        return f"{sign!r}.join(map(str, {given}))"
    parts: list[ast.expr] = []
    for number, value in enumerate(call.args):
        parts += [ast.Constant(sign)] if number else []
        parts += _parts_of(value)
    joined = ast.JoinedStr(parts)
    if all(isinstance(one, ast.Constant) for one in parts):
        return repr("".join(str(one.value) for one in parts if isinstance(one, ast.Constant)))
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
