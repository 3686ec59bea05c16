"""Expressions that Python takes, and which do something else than was meant."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.node_source import NodeSources
from ros2lab.diagnose.python_source import PythonSource


def expression_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield comparisons that stand where a value was to be set, or are none, and texts that stand for one."""
    for source in sources.sources.values():
        for node in source.nodes:
            match node:
                case ast.Expr(value=ast.Compare(left=left, ops=[ast.Eq()], comparators=[right])):
                    yield Finding(
                        "comparison-unused",
                        f"`{ast.unparse(node.value)}` only compares, and nothing is done with what comes of it.",
                        source.at(node),
                        f"write {ast.unparse(left)} = {ast.unparse(right)}",
                    )
                case ast.Compare(
                    left=left,
                    ops=[ast.Is() | ast.IsNot() as operator],
                    comparators=[ast.Constant(value=str()) as right],
                ):
                    sign = "==" if isinstance(operator, ast.Is) else "!="
                    yield Finding(
                        "literal-comparison",
                        f"`{ast.unparse(node)}` asks whether both are one object, which a text that was received never is.",
                        source.at(node),
                        f"write {ast.unparse(left)} {sign} {ast.unparse(right)}",
                    )
                case (
                    ast.If(test=ast.BoolOp() as test)
                    | ast.While(test=ast.BoolOp() as test)
                    | ast.IfExp(test=ast.BoolOp() as test)
                ):
                    yield from _texts(source, test)


def _texts(source: PythonSource, test: ast.BoolOp) -> Iterator[Finding]:
    match test.values:
        case [
            ast.Compare(left=left, ops=[ast.Eq()], comparators=[right]),
            *_,
            ast.Constant(value=str(text)) as other,
        ] if text:
            yield Finding(
                "text-as-condition",
                f"`{ast.unparse(test)}` does not compare {ast.unparse(other)}: a text by itself is always true.",
                source.at(test),
                f"write {ast.unparse(left)} in ({ast.unparse(right)}, {ast.unparse(other)})",
            )
