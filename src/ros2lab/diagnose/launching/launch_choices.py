"""Rewrite a choice made while a launch file is read as an expression that launch evaluates when it runs."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator

from ros2lab.diagnose.sources.python_source import PythonSource, assigned_to, own_nodes

# A piece of an expression as it is written in the file: plain text, or a substitution.
_Part = tuple[bool, str]  # whether it is a substitution, and its text


def choice_when_it_runs(source: PythonSource, node: ast.AST, early: Collection[str]) -> str:
    """Return a fix that lets launch choose between values when it runs; empty if the choice has another form."""
    for choice in source.nodes:
        if isinstance(choice, (ast.If, ast.IfExp)) and any(
            inner is node for inner in (choice, *ast.walk(choice.test))
        ):
            if isinstance(choice, ast.IfExp):
                made = _written(_chosen(choice, choice.body, choice.orelse, early))
                return f"write {made} instead of {ast.unparse(choice)}, {_IMPORT}" if made else ""
            made_of = {
                name: _written(_of_statement(choice, name, source, early)) for name in _assigned(choice)
            }
            rows = [f"{name} = {made}" for name, made in made_of.items()]
            is_known = bool(rows) and all(made_of.values())
            return f"write `{'`, and `'.join(rows)}` instead of the whole if, {_IMPORT}" if is_known else ""
    return ""


_IMPORT = "with `from launch.substitutions import PythonExpression`"


def _assigned(choice: ast.If) -> dict[str, ast.expr]:
    """Return the names that the first branch assigns, with their values; empty if it does anything else."""
    found: dict[str, ast.expr] = {}
    for statement in choice.body:
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                found[name] = value
            case _:
                return {}
    return found


def _of_statement(
    choice: ast.If, name: str, source: PythonSource, early: Collection[str]
) -> list[_Part] | None:
    """Return what an `if` with all its branches assigns to a name; None if that is not known."""
    value = _assigned(choice).get(name)
    match choice.orelse:
        case [ast.If() as inner]:
            otherwise = _of_statement(inner, name, source, early)
        case [ast.Assign(targets=[ast.Name(id=same)], value=there)] if same == name:
            return _chosen(choice, value, there, early)
        case []:
            before = _value_before(choice, name, source)
            return _chosen(choice, value, before, early)
        case [*several] if all(isinstance(statement, ast.Assign) for statement in several):
            last = _assigned(ast.If(choice.test, several, []))
            return _chosen(choice, value, last.get(name), early)
        case _:
            return None
    test = _test(choice.test, early)
    if otherwise is None or test is None or not isinstance(value, ast.Constant):
        return None
    return [(False, f"{value.value!r} if "), *test, (False, " else ("), *otherwise, (False, ")")]


def _value_before(choice: ast.If, name: str, source: PythonSource) -> ast.expr | None:
    """Return the last value assigned to a name above an `if`; None if there is none."""
    nodes = own_nodes(source.function_at(choice.lineno) or source.tree)
    values = [value for value in assigned_to(nodes, name) if value.lineno < choice.lineno]
    return values[-1] if values else None


def _chosen(
    choice: ast.If | ast.IfExp, value: ast.expr | None, otherwise: ast.expr | None, early: Collection[str]
) -> list[_Part] | None:
    test = _test(choice.test, early)
    if test is None or not isinstance(value, ast.Constant) or not isinstance(otherwise, ast.Constant):
        return None
    return [(False, f"{value.value!r} if "), *test, (False, f" else {otherwise.value!r}")]


def _test(test: ast.expr, early: Collection[str]) -> list[_Part] | None:
    """Return a condition, with substitutions quoted where texts are compared; None for any other form."""
    text = ast.unparse(test)
    match test:
        case _ if text in early:
            return [(False, "'"), (True, text), (False, "'.lower() in ('true', '1')")]
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            inner = _test(operand, early)
            return [(False, "not "), *inner] if inner else None
        case ast.Compare(left=left, ops=[sign], comparators=[right]):
            is_text = not any(type(getattr(side, "value", None)) in (int, float) for side in (left, right))
            sides = [_side(side, early, is_text=is_text) for side in (left, right)]
            if None in sides:
                return None
            between = ast.unparse(ast.Compare(ast.Name("a"), [sign], [ast.Name("b")]))[1:-1]
            return [*(sides[0] or ()), (False, between), *(sides[1] or ())]
    return None


def _side(side: ast.expr, early: Collection[str], *, is_text: bool) -> list[_Part] | None:
    text = ast.unparse(side)
    if text in early:
        quote = [(False, "'")] if is_text else []
        return [*quote, (True, text), *quote]
    is_plain = all(
        isinstance(inner, (ast.Constant, ast.List, ast.Tuple, ast.Set, ast.Load)) for inner in ast.walk(side)
    )
    return [(False, text)] if is_plain else None


def _written(parts: list[_Part] | None) -> str:
    """Return the expression as launch takes it: a list of texts and substitutions; empty if there is none."""
    return f"PythonExpression([{', '.join(_joined(parts))}])" if parts else ""


def _joined(parts: list[_Part]) -> Iterator[str]:
    text = ""
    for is_substitution, part in parts:
        if not is_substitution:
            text += part
            continue
        if text:
            yield repr(text)
        text = ""
        yield part
    if text:
        yield repr(text)
