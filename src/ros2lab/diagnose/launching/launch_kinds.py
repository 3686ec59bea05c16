"""Names, substitutions and conditions in a launch file: each given where another kind is wanted, and rewritten."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import PurePosixPath

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_arguments import (
    all_named,
    arguments_named,
    calls_of_launch,
    class_made,
)
from ros2lab.diagnose.sources.python_source import PythonSource, given_to
from ros2lab.diagnose.sources.signatures import heads_of, signature_of

_NAME, _SUBSTITUTION, _CONDITION = "a name in quotes", "a substitution", "a condition"
_CONDITIONS = "a list of conditions"
_WANTED = {
    **dict.fromkeys(("str", "Text"), _NAME),
    "SomeSubstitutionsType": _SUBSTITUTION,
    "Condition": _CONDITION,
}
_INCLUDED = {"Python": (".py",), "XML": (".xml",), "YAML": (".yaml", ".yml")}
_MADE = {"launch.substitutions": _SUBSTITUTION, "launch.conditions": _CONDITION}
READING = ("LaunchConfiguration", "LaunchConfigurationEquals", "LaunchConfigurationNotEquals")
_VAR = re.compile(r"^\$\(var (\w+)\)$")  # as XML writes it
_TRUTHS = frozenset(("true", "false", "1", "0"))
_IS_NAMED = frozenset(("package", "executable", "plugin", "name", "exec_name", "description"))


def kind_faults(source: PythonSource) -> Iterator[Finding]:
    """Yield arguments of launch's classes that are of the wrong kind, as far as the right one can be written."""
    for _, call in calls_of_launch(source):
        for wanted, value in _given(source, call):
            kind = _kind(source, value)
            new = _as(source, value, wanted) if kind and kind != wanted else ""
            if new:
                callee = ast.unparse(call.func)
                name = _class(source, value)
                what = f"`{ast.unparse(value)}` is {kind}" + f" ({name})" * bool(name)
                cause = f"{callee} needs {wanted} here, but {what}."
                fix = f"write {new} instead of {ast.unparse(value)}"
                yield Finding("launch-argument", cause, source.at(value), fix)
    yield from _plain_words(source)
    yield from _included_kinds(source)


def _included_kinds(source: PythonSource) -> Iterator[Finding]:
    """Yield launch files that are included by the class for files of another kind."""
    endings = {ending: kind for kind, known in _INCLUDED.items() for ending in known}
    for called, call in calls_of_launch(
        source, "launch"
    ):  # those of XML and YAML are in packages of their own
        name = called.rpartition(".")[2]
        kind = name.removesuffix("LaunchDescriptionSource")
        if kind not in _INCLUDED or kind == name:
            continue
        made = [source.written(value) for value in (*call.args[:1], *(k.value for k in call.keywords))]
        texts = [n.value for value in made for n in ast.walk(value) if isinstance(n, ast.Constant)]
        file = texts[-1] if texts and isinstance(texts[-1], str) else ""
        other = endings.get(PurePosixPath(file).suffix, kind)
        if other != kind:
            fix = f"write AnyLaunchDescriptionSource instead of {name}, with `from launch.launch_description_sources import AnyLaunchDescriptionSource` at the top"
            cause = f"{name} reads {kind}, but {file.rpartition('/')[2]} is {other}."
            yield Finding("launch-argument", cause, source.at(call), fix, (file.rpartition("/")[2],))


def named_arguments(source: PythonSource, call: ast.Call) -> list[tuple[str, ast.expr]]:
    """Return the arguments of a call with the names of their parameters, as far as they are known."""
    signature = signature_of(source, call)
    named = [
        parameter.name for parameter in (signature.parameters if signature else ()) if parameter.is_positional
    ]
    return [*zip(named, call.args, strict=False), *((k.arg or "", k.value) for k in call.keywords)]


def _given(source: PythonSource, call: ast.Call) -> Iterator[tuple[str, ast.expr]]:
    """Yield the arguments of a call, each with the kind that is wanted there, where that is only one kind."""
    for name, value in named_arguments(source, call):
        if kind := _wanted(source, call, name):
            yield kind, value


def _wanted(source: PythonSource, call: ast.Call, name: str) -> str:
    """Return the kind that a parameter wants; empty if it takes several, or others.

    Actions hand their `condition` on; a substitution may have a parameter of that name for something else.
    """
    wanted = _type(source, call, name) or "Condition" * (name == "condition")
    kinds = {_WANTED.get(head, "") for head in heads_of(wanted)}
    return kinds.pop() if len(kinds) == 1 else ""


def _type(source: PythonSource, call: ast.Call, name: str) -> str:
    signature = signature_of(source, call)
    named = signature.named(name) if signature else None
    return named.type if named else ""


def _class(source: PythonSource, value: ast.expr) -> str:
    """Return the class of the substitution or the condition that an expression makes; empty if it makes none."""
    return class_made(source, source.written(value), *_MADE)[1]


def _kind(source: PythonSource, value: ast.expr) -> str:
    if isinstance(value, ast.List) and value.elts and all(_kind(source, e) == _CONDITION for e in value.elts):
        return _CONDITIONS
    return _MADE.get(class_made(source, source.written(value), *_MADE)[0], "")


def _as(source: PythonSource, value: ast.expr, wanted: str) -> str:
    """Return an expression rewritten as another kind; empty if that is not known."""
    made, name = source.written(value), _class(source, value)
    kind = _kind(source, value)
    if wanted == _NAME and name == "LaunchConfiguration":
        return ast.unparse(_arguments(made)[0]) if _arguments(made) else ""
    if wanted == _SUBSTITUTION and kind == _CONDITION:
        return _as_substitution(source, made, name)
    if wanted == _CONDITION and kind == _SUBSTITUTION:
        return f"IfCondition({ast.unparse(value)})"
    if wanted == _CONDITION and isinstance(value, ast.List):
        parts = [_as(source, element, _SUBSTITUTION) for element in value.elts]
        joined = parts[0]
        for part in parts[1:]:
            joined = f"AndSubstitution({joined}, {part})"
        return f"IfCondition({joined})" if all(parts) else ""
    return ""


def _as_substitution(source: PythonSource, made: ast.expr, name: str) -> str:
    """Return a condition as a substitution that is true where the condition holds."""
    texts = [ast.unparse(argument) for argument in _arguments(made)]
    nested = _as(source, _arguments(made)[0], _SUBSTITUTION) if texts else ""
    match name, texts:
        case "LaunchConfigurationEquals" | "LaunchConfigurationNotEquals", [first, second]:
            sign = name.removeprefix("LaunchConfiguration")
            first = first if _class(source, _arguments(made)[0]) else f"LaunchConfiguration({first})"
            return f"{sign}Substitution({first}, {second})"
        case "IfCondition", [value]:
            return nested or value
        case "UnlessCondition", [value]:
            return f"NotSubstitution({nested or value})"
    return ""


def _arguments(call: ast.expr) -> list[ast.expr]:
    return given_to(call) if isinstance(call, ast.Call) else []


def _plain_words(source: PythonSource) -> Iterator[Finding]:
    """Yield texts that are only the name of a declared argument, where its value is meant."""
    declared = {name for name, _ in arguments_named(source, "DeclareLaunchArgument")}
    read = all_named(source, *READING)
    for called, call in calls_of_launch(source):
        for word, form in _words(source, called.rpartition(".")[2], call):
            name = _VAR.sub(r"\1", str(word.value))
            if name in declared and (form or name != word.value or (read is not None and name not in read)):
                new = f"LaunchConfiguration({name!r})"
                cause = f"{word.value!r} here is only the word; the value of the launch argument is {new}."
                fix = f"write {(form or '{}').format(new)} instead of {word.value!r}"
                yield Finding("launch-argument", cause, source.at(word), fix)


def _words(source: PythonSource, callee: str, call: ast.Call) -> Iterator[tuple[ast.Constant, str]]:
    """Yield the texts that a call of launch is given as values; where no text can be meant, with the form to write."""
    if callee == "DeclareLaunchArgument" or "LaunchConfiguration" in callee:
        return
    is_condition = callee in ("IfCondition", "UnlessCondition")
    given = [(keyword.arg or "", keyword.value) for keyword in call.keywords]
    given += [("", value) for value in call.args] if is_condition or callee == "PythonExpression" else []
    for name, value in given:
        is_wanted = name == "condition" and _wanted(source, call, name) == _CONDITION
        form = "IfCondition({})" if is_wanted else "{}" if is_condition else ""
        for node in _values(value) if name not in _IS_NAMED else ():
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value not in _TRUTHS:
                yield node, form


def _values(value: ast.expr) -> Iterator[ast.expr]:
    """Yield what stands as a value in an argument: itself, the items of a list, the values of a dict."""
    match value:
        case ast.List(elts=items):
            for item in items:
                yield from _values(item)
        case ast.Dict(keys=keys, values=values):
            yield from (v for key, v in zip(keys, values, strict=True) if key is not None)
        case ast.Call(func=ast.Attribute(value=ast.Dict() as inner, attr="items")):
            yield from _values(inner)
        case ast.Tuple(elts=[_, second]):
            yield from _values(second)
        case ast.Constant():
            yield value
