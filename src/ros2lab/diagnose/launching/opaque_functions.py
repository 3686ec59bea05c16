"""Move what Python does too early with a value of launch into a function that launch calls when it runs."""

from __future__ import annotations

import ast
import sys
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ros2lab.diagnose.finding import lines_in_words
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import PythonSource, names_read, read_text

# Modules that only hold or pass on their arguments, whatever these are.
_HOLDING = frozenset(
    ("collections", "contextlib", "copy", "dataclasses", "functools", "itertools", "operator", "typing")
)
_JOIN = "os.path.join"
_FUNCTION = "launch_setup"


def runs_at_once(source: PythonSource, node: ast.AST) -> bool:
    """Return whether a node calls a function that knows nothing of launch, so needs its arguments at once."""
    if not isinstance(node, ast.Call):
        return False
    target = source.resolve(node.func) or ast.unparse(node.func)
    module = target.partition(".")[0]
    if target == "open":
        return "open" not in source.stored
    if module in sys.stdlib_module_names:
        return target != module and module not in _HOLDING
    return source.resolve(node.func) == target != module and not _knows_launch(target.rpartition(".")[0])


def _knows_launch(module: str) -> bool:
    """Return whether a module's file mentions launch; a module that is not installed is taken to."""
    package, *inner = module.split(".")
    folder = interfaces.folder_of(package)
    path = folder.joinpath(*inner) if folder else None
    texts = [read_text(file) for file in ((path / "__init__.py", path.with_suffix(".py")) if path else ())]
    return not any(texts) or package.startswith("launch") or any("launch" in text for text in texts)


def needed_at_once(source: PythonSource, node: ast.AST) -> bool:
    """Return whether a value, or a result of it, goes to a function that runs while the file is read."""
    body = _body(source, node)
    names: set[str] = set()
    for statement in body:
        if node in ast.walk(statement) or names_read(ast.walk(statement)) & names:
            names |= _stores(statement)
    calls = (inner for statement in body for inner in ast.walk(statement) if runs_at_once(source, inner))
    for call in calls:
        is_join = source.resolve(call.func) == _JOIN  # type: ignore[attr-defined]
        if not is_join and (node in ast.walk(call) or names_read(ast.walk(call)) & names):
            return True
    return False


@dataclass
class _Moved:
    """What moves into the function: statements, actions that it returns, and the lines of both."""

    names: set[str]
    statements: list[ast.stmt] = field(default_factory=list)
    actions: list[ast.expr] = field(default_factory=list)
    lines: set[int] = field(default_factory=set)
    adder: str = ""

    def take(self, statement: ast.stmt) -> None:
        """Take a statement; of a return or an add_action(), take only the actions."""
        match statement:
            case ast.Return(value=value):
                lists = [n for n in ast.walk(value or statement) if isinstance(n, ast.List)][:1]
                for action in (
                    action
                    for sequence in lists
                    for action in sequence.elts
                    if names_read(ast.walk(action)) & self.names
                ):
                    self.actions.append(action)
                    self.lines.update(_lines(action))
            case ast.Expr(value=ast.Call(func=ast.Attribute(attr="add_action") as adds, args=[action])):
                self.adder = ast.unparse(adds)
                self.actions.append(action)
                self.lines.update(_lines(statement))
            case _:
                self.statements.append(statement)
                self.names |= _stores(statement)
                self.lines.update(_lines(statement))


def as_opaque_function(source: PythonSource, node: ast.AST, early: Sequence[ast.expr]) -> str:
    """Return a fix that moves the lines that need a value into a function that launch calls when it runs."""
    texts = {ast.unparse(expression): _called(expression) for expression in early}
    body = _body(source, node)
    made = {
        ast.unparse(statement.targets[0]): statement.value
        for statement in body
        if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) in texts
    }
    moved = _Moved({*made})
    for statement in body:
        is_source = isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) in made
        if not is_source and (node in ast.walk(statement) or names_read(ast.walk(statement)) & moved.names):
            moved.take(statement)
    rows = [f"{name} = {_called(value)}" for name, value in made.items()]
    rows += [
        row
        for statement in moved.statements
        for row in _performed(
            statement, {text: new for text, new in texts.items() if text not in made}
        ).splitlines()
    ]
    rows.append(f"return [{', '.join(map(ast.unparse, moved.actions))}]")
    function = textwrap.indent(
        "\n".join([f"def {_FUNCTION}(context):", *(f"    {row}" for row in rows)]), "    "
    )
    call = f"OpaqueFunction(function={_FUNCTION})"
    here = (
        f"`{moved.adder}({call})` below it" if moved.adder else f"`{call}` into the list of LaunchDescription"
    )
    known = "OpaqueFunction" in source.names
    more = "" if known else ", with `from launch.actions import OpaqueFunction` at the top"
    return (
        f"let launch do it when it runs: put this function above the return, instead of {_in_words(moved.lines)}:\n"
        f"{function}\n  Then write {here}{more}{_plain_instead(source, made, node)}"
    )


def _plain_instead(source: PythonSource, made: dict[str, ast.expr], node: ast.AST) -> str:
    """Return how to write the argument's default instead of the value; empty if it has none."""
    for name, value in made.items():
        for call in source.calls:
            default = next(
                (keyword.value for keyword in call.keywords if keyword.arg == "default_value"), None
            )
            is_its = bool(call.args and isinstance(value, ast.Call) and value.args) and (
                ast.unparse(call.args[0]) == ast.unparse(value.args[0])  # type: ignore[attr-defined]
            )
            if default is not None and is_its:
                line = getattr(node, "lineno", 0)
                return f"; or, if no one needs to choose it, write `{ast.unparse(default)}` instead of `{name}` on line {line}"
    return ""


def _called(expression: ast.expr) -> str:
    """Return the call that gives the text of a launch value."""
    text = ast.unparse(expression)
    return f"{f'({text})' if isinstance(expression, ast.BinOp) else text}.perform(context)"


def _performed(statement: ast.stmt, texts: Mapping[str, str]) -> str:
    """Return a statement in which other texts stand for those of some expressions."""
    text = ast.unparse(statement)
    for expression, new in texts.items():
        text = text.replace(expression, new)
    return text


def _body(source: PythonSource, node: ast.AST) -> list[ast.stmt]:
    """Return the body of the innermost function around a node; empty if there is none."""
    around = [n for n in source.nodes if isinstance(n, ast.FunctionDef) and node in ast.walk(n)]
    return around[-1].body if around else []


def _lines(node: ast.stmt | ast.expr) -> range:
    return range(node.lineno, (node.end_lineno or node.lineno) + 1)


def _in_words(lines: set[int]) -> str:
    """Return line numbers in words, consecutive ones as a range."""
    firsts = sorted(line for line in lines if line - 1 not in lines)
    lasts = sorted(line for line in lines if line + 1 not in lines)
    return " and ".join(lines_in_words(first, last) for first, last in zip(firsts, lasts, strict=True))


def _stores(node: ast.AST) -> set[str]:
    """Return the names that a node assigns, or whose objects it changes, as `values['k'] = 1` does."""
    inner = [*ast.walk(node)]
    changed = [n for n in inner if isinstance(getattr(n, "ctx", None), ast.Store)]
    changed += [n.value.func for n in inner if isinstance(n, ast.Expr) and isinstance(n.value, ast.Call)]
    return {_owner(target).id for target in changed if isinstance(_owner(target), ast.Name)}  # type: ignore[attr-defined]


def _owner(node: ast.AST) -> ast.AST:
    while isinstance(node, (ast.Subscript, ast.Attribute)):
        node = node.value
    return node
