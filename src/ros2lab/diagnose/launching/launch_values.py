"""Values that launch knows only when it runs, used while the file is still being read."""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Collection, Iterator, Sequence

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_arguments import arguments_named, class_made
from ros2lab.diagnose.launching.opaque_functions import as_opaque_function, needed_at_once, runs_at_once
from ros2lab.diagnose.sources.class_trees import launch_classes_with
from ros2lab.diagnose.sources.python_source import PythonSource, assigned_to, given_to, own_nodes


def used_too_early(source: PythonSource) -> Iterator[Finding]:
    """Yield values that are known only when launch runs, but that Python compares or computes with before."""
    for node in source.nodes:
        used = _given_to_python(source, node)
        early = [value for value in used if _is_late(source, value)]
        if early and not (isinstance(node, ast.BinOp) and _class_of(source, node)):
            text = ast.unparse(early[0])
            cause = f"{text} gets its value only when launch runs; here, while the file is being read, it is not a string yet."
            if needed_at_once(source, node):
                fix = as_opaque_function(source, node, early)
            else:
                fix = choice_when_it_runs(source, node, {*map(ast.unparse, early)})
            fix = fix or _when_it_runs(source, node, used, early)
            yield Finding("launch-argument", cause, source.at(node), fix)


def declared_late(source: PythonSource) -> Iterator[Finding]:
    """Yield arguments that are declared in a list after the first action that uses them."""
    lists = (node.elts for node in source.nodes if isinstance(node, ast.List))
    for actions in lists:
        asked: set[str] = set()
        for action in actions:
            names = {name for name, _ in arguments_named(source, "LaunchConfiguration", within=action)}
            declared = [name for name, _ in arguments_named(source, "DeclareLaunchArgument", within=action)]
            for name in asked.intersection(declared[:1]):
                cause = f"The argument {name} is declared here, but an action above already uses it: launch goes through the list from top to bottom."
                fix = f"move DeclareLaunchArgument({name!r}, ...) above the action that uses it"
                yield Finding("launch-argument", cause, source.at(action), fix)
            asked |= names


def _given_to_python(source: PythonSource, node: ast.AST) -> list[ast.expr]:
    """Return the values that Python compares, computes with or puts into a text; empty if there are none."""
    match node:
        case ast.Compare(left=left, comparators=others):
            return [left, *others]
        case ast.If(test=test) | ast.IfExp(test=test):
            return [test.operand if isinstance(test, ast.UnaryOp) else test]
        case ast.BinOp(left=left, op=op, right=right):
            return [left, *(getattr(right, "elts", [right]) if isinstance(op, ast.Mod) else [right])]
        case (
            ast.FormattedValue(value=value)
            | ast.Call(func=ast.Name(id="int" | "float" | "str" | "bool"), args=[value])
        ):
            return [value]
        case ast.Call() if runs_at_once(source, node):
            given = given_to(node)
            return [inner for argument in given for inner in getattr(argument, "elts", [argument])]
    return []


def _when_it_runs(
    source: PythonSource, node: ast.AST, used: Sequence[ast.expr], early: Sequence[ast.expr]
) -> str:
    """Return a fix that lets launch do, when it runs, what Python does too early."""
    match node:
        case ast.Compare(ops=[ast.Eq() | ast.NotEq() as sign], comparators=[_]):
            kind = "EqualsSubstitution" if isinstance(sign, ast.Eq) else "NotEqualsSubstitution"
            made = f"{kind}({', '.join(map(ast.unparse, used))})"
            takers = (n for n in source.calls if node in n.args)
            is_condition = any(source.resolve(n.func) == "launch.conditions.IfCondition" for n in takers)
            do = f"write {made} here" if is_condition else f"{_WITHOUT_IF} condition=IfCondition({made})"
            more = "" if is_condition else "from launch.conditions import IfCondition; "
            return f"{do}, with `{more}from launch.substitutions import {kind}`"
        case ast.If() | ast.IfExp():
            condition = f"IfCondition({ast.unparse(early[0])})"
            return f"{_WITHOUT_IF} condition={condition}, with `from launch.conditions import IfCondition`"
        case ast.BinOp() | ast.Call() if (whole := _calculation(source, node, early)) is not None:
            made = f"PythonExpression([{', '.join(_parts(whole, early))}])"
            return f"write {made} instead of {ast.unparse(whole)}, with `from launch.substitutions import PythonExpression`"
        case ast.BinOp() | ast.FormattedValue() | ast.Call(func=ast.Attribute()):
            text = _whole_text(source, node)
            if made := _as_text(source, text):
                more = (
                    "" if made[0] == "[" else ", with `from launch.substitutions import PathJoinSubstitution`"
                )
                return f"write {made} instead of {ast.unparse(text)}{more}"
    return f"pass {ast.unparse(early[0])} itself to the action, or a list of strings and substitutions, which launch joins"


def _whole_text(source: PythonSource, node: ast.AST) -> ast.AST:
    """Return the largest text or path that Python makes of the value of an expression."""
    above = source.above(node)
    inner = (
        source.above(above) if isinstance(above, ast.List) else above
    )  # only a path has its parts in a list
    is_path = isinstance(inner, ast.Call) and source.resolve(inner.func) == "os.path.join"
    is_text = isinstance(above, (ast.FormattedValue, ast.JoinedStr))
    is_text |= isinstance(above, ast.BinOp) and isinstance(above.op, (ast.Add, ast.Mod))
    return _whole_text(source, above) if above and (is_path or is_text) else node


def _as_text(source: PythonSource, node: ast.AST) -> str:
    """Return a text or a path as launch takes it, a list or a PathJoinSubstitution; empty if Python alone can make it."""
    match node:
        case ast.Call(func=func, args=args) if source.resolve(func) == "os.path.join":
            return f"PathJoinSubstitution([{', '.join(_as_text(source, one) or ast.unparse(one) for one in args)}])"
        case ast.JoinedStr(values=values) | ast.List(elts=values):
            parts = [
                getattr(value, "value", value) if isinstance(value, ast.FormattedValue) else value
                for value in values
            ]
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            parts = [left, right]
        case ast.BinOp(left=ast.Constant(value=str(text)), op=ast.Mod(), right=right):
            given = iter(right.elts if isinstance(right, ast.Tuple) else [right])
            pieces = [piece for piece in re.split(r"(%s)", text) if piece]
            parts = [next(given, right) if piece == "%s" else ast.Constant(piece) for piece in pieces]
        case _:
            return ""
    texts = [_as_text(source, part) or ast.unparse(part) for part in parts]
    return f"[{', '.join(text[1:-1] if text.startswith('[') else text for text in texts)}]"


_WITHOUT_IF = "remove the if, always put the action into the list, and give it"


def _calculation(source: PythonSource, node: ast.AST, early: Sequence[ast.expr]) -> ast.expr | None:
    """Return the largest expression around a value that computes with numbers only; None if there is none."""
    around = (n for n in source.nodes if isinstance(n, ast.expr) and node in ast.walk(n))
    able = [n for n in around if _is_of_numbers(n, early) and any(map(_counts, ast.walk(n)))]
    return max(able, key=lambda expression: sum(1 for _ in ast.walk(expression)), default=None)


def _is_of_numbers(node: ast.AST, early: Sequence[ast.expr]) -> bool:
    """Return whether an expression has only numbers, operators, builtins and the values in question."""
    if any(ast.unparse(node) == ast.unparse(value) for value in early):
        return True
    match node:
        case ast.Constant(value=int() | float()):
            return True
        case ast.BinOp(left=left, right=right):
            return _is_of_numbers(left, early) and _is_of_numbers(right, early)
        case ast.UnaryOp(operand=operand):
            return _is_of_numbers(operand, early)
        case ast.Call(func=ast.Name(id=name), args=[*values], keywords=[]):
            return hasattr(builtins, name) and all(_is_of_numbers(value, early) for value in values)
    return False


def _parts(whole: ast.expr, early: Sequence[ast.expr]) -> list[str]:
    """Return an expression as the list of texts and substitutions that launch joins."""
    texts = sorted({ast.unparse(value) for value in early}, key=len, reverse=True)
    pieces = re.split(rf"(?<![\w.])({'|'.join(map(re.escape, texts))})(?![\w.])", ast.unparse(whole))
    return [piece if piece in texts else repr(piece) for piece in pieces if piece]


def _counts(node: ast.AST) -> bool:
    """Return whether an operation is on numbers; otherwise + may join texts, and / paths."""
    if not isinstance(node, ast.BinOp):
        return False
    kinds = (int, float)
    has_number = any(
        (isinstance(side, ast.Constant) and isinstance(side.value, kinds))
        or (isinstance(side, ast.Call) and ast.unparse(side.func) in ("int", "float"))
        for side in (node.left, node.right)
    )
    return has_number or not isinstance(node.op, (ast.Add, ast.Div))


# The methods with which a class defines an operator.
_DEFINED_BY = {ast.Div: "__truediv__", ast.Add: "__add__"}


def _is_late(source: PythonSource, value: ast.expr) -> bool:
    """Return whether an expression makes a substitution, or is a name that is given nothing else where it is bound."""
    given = source.given(value) if isinstance(value, (ast.Name, ast.Attribute)) else [value]
    return bool(given) and all(made and _class_of(source, made) for made in given)


def _class_of(source: PythonSource, value: ast.expr) -> str:
    """Return the class of the substitution that an expression makes, also by an operator of it; empty if it makes none."""
    if isinstance(value, ast.BinOp):
        made = _class_of(source, source.written(value.left))
        method = _DEFINED_BY.get(type(value.op), "")
        return made if method and made in launch_classes_with(method) else ""
    return class_made(source, value, "launch.substitutions", "launch_ros.substitutions")[1]


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
