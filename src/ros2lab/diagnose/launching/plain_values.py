"""Plain values in a launch file that do not do what they are meant for: truths of texts, times, and unused values."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_arguments import arguments_named, calls_of_launch
from ros2lab.diagnose.launching.launch_kinds import READING, named_arguments
from ros2lab.diagnose.sources.calls import missing_imports
from ros2lab.diagnose.sources.python_source import Function, PythonSource, names_read, read_text, walk
from ros2lab.diagnose.sources.static_value import UNKNOWN, evaluate

_TRUTHS = frozenset(("true", "false", "1", "0", "yes", "no", "on", "off"))
# What launch counts in seconds.
_SECONDS = frozenset(("period", "sigterm_timeout", "sigkill_timeout", "respawn_delay"))
_READER = "launch.substitutions.LaunchConfiguration"
_LONG, _HALF_HOUR = 1000, 1800  # s
_FILES = (".yaml", ".yml", ".rviz", ".urdf", ".xacro", ".sdf", ".world", ".lua", ".json")


def plain_value_faults(source: PythonSource) -> Iterator[Finding]:
    """Yield texts used as truth values, times in milliseconds, and values that are worked out but never used."""
    yield from _truths(source)
    yield from _times(source)
    yield from _unused(source)


def _truths(source: PythonSource) -> Iterator[Finding]:
    defaults = _defaults(source)
    names: dict[str, set[str]] = {}
    for node in source.nodes:
        if isinstance(node, ast.Assign):
            for target in node.targets:
                names.setdefault(ast.unparse(target), set()).add(_argument(source, node.value))
    for node in source.nodes:
        for tested, is_negated, text in _tests(node):
            known = names.get(ast.unparse(text), set()) if isinstance(text, ast.Name) else set()
            name = next(iter(known)) if len(known) == 1 else _argument(source, text)
            if not name or (isinstance(tested, ast.Compare) and defaults.get(name) is None):
                continue
            if defaults.get(name, "").lower() in _TRUTHS:
                written = ast.unparse(text)
                sign = "!=" if is_negated else "=="
                right = "1" if defaults[name] in "01" else "true"
                always = "counts as true, as every text that is not empty does"
                if isinstance(tested, ast.Compare):
                    always = "equals neither True nor False"
                cause = f"{written} is a text, such as 'false', which {always}."
                fix = f"write {written}.lower() {sign} {right!r} instead of {ast.unparse(tested)}"
                yield Finding("text-as-condition", cause, source.at(tested), fix)


def _defaults(source: PythonSource) -> dict[str, str]:
    """Return the default values of the launch arguments that a file declares."""
    given = [
        (name, evaluate(keyword.value, {}, {}))
        for name, call in arguments_named(source, "DeclareLaunchArgument")
        for keyword in call.keywords
        if keyword.arg == "default_value"
    ]
    return {name: default for name, default in given if isinstance(default, str)}


def _argument(source: PythonSource, node: ast.expr) -> str:
    """Return the launch argument whose text an expression gives in an OpaqueFunction; empty if it gives none."""
    match node:
        case ast.Call(func=ast.Attribute(attr="perform", value=value)):
            made = source.written(value)
            asked = arguments_named(source, "LaunchConfiguration", within=made)
            return next((name for name, call in asked if call is made), "")
        case ast.Subscript(
            value=ast.Attribute(attr="launch_configurations"), slice=ast.Constant(value=str(name))
        ):
            return name
        case ast.Call(
            func=ast.Attribute(attr="get", value=ast.Attribute(attr="launch_configurations")),
            args=[ast.Constant(value=str(name)), *_],
        ):
            return name
    return ""


def _tests(node: ast.AST) -> Iterator[tuple[ast.expr, bool, ast.expr]]:
    """Yield what is tested in a node, whether the test is negated, and the expression whose truth counts."""
    tests: list[ast.expr] = []
    match node:
        case ast.If(test=test) | ast.IfExp(test=test) | ast.While(test=test):
            tests = [test]
        case ast.BoolOp(values=values):
            tests = values
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            yield node, True, operand
        case ast.Call(func=ast.Name(id="bool"), args=[value]):
            yield node, False, value
        case ast.Compare(left=left, ops=[op], comparators=[ast.Constant(value=bool(value))]):
            yield node, isinstance(op, (ast.NotEq, ast.IsNot)) is value, left
    for test in tests:
        if (
            isinstance(test, (ast.Name, ast.Call, ast.Subscript))
            and getattr(getattr(test, "func", None), "id", "") != "bool"
        ):
            yield test, False, test


def _times(source: PythonSource) -> Iterator[Finding]:
    for _, call in calls_of_launch(source):
        for name, value in named_arguments(source, call):
            number = _number(source.written(value)) if name in _SECONDS else None
            if number and number >= _LONG and number % 100 == 0 and number % _HALF_HOUR:
                right = f"{number / 1000:g}" if number % 1000 else f"{number / 1000:.1f}"
                right = repr(right) if isinstance(evaluate(value, {}, {}), str) else right
                cause = f"{name} is in seconds, so {ast.unparse(value)} is {number / 60:.0f} minutes."
                fix = f"write {name}={right} if milliseconds were meant"
                yield Finding("unit-mixed", cause, source.at(value), fix)


def _number(node: ast.expr) -> float | None:
    value = evaluate(node, {}, {})
    if isinstance(value, str) and value.replace(".", "", 1).isdigit():
        return float(value)
    return float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else None


def _unused(source: PythonSource) -> Iterator[Finding]:
    read = names_read(source.nodes)
    inside = [statement for n in source.nodes if isinstance(n, Function) for statement in ast.walk(n)]
    for node in inside:
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Tuple(elts=[value]) | value) if (
                name not in read and not name.startswith("_")
            ):
                calls = _node_calls(source)
                is_late = any(call.lineno < node.lineno for call in calls)
                keyword, written = _place_for(source, ast.unparse(value) if is_late else name, value)
                if keyword:
                    free = [call for call in calls if keyword not in {k.arg for k in call.keywords}]
                    if len(free) > 1 or ".yaml" in ast.unparse(value):
                        free = [call for call in free if _is_offered(source, call, value)]
                    argument = _argument_of(source, value)
                    free = [call for call in free if not argument or call in takers(source, argument)]
                    lines = " or ".join(str(call.lineno) for call in free)
                    where = f"add {written} to the Node on line {lines}"
                    if keyword == "arguments" or not 0 < len(free) <= _MOST_NODES:
                        where = f"remove it, or give {name} to the Node that reads it"
                    cause = f"{name} is worked out here, but never used, so it changes nothing."
                    yield Finding("launch-unused", cause, source.at(node), where)


_MOST_NODES = 3  # that are offered to take a value


def passed_on(source: PythonSource, name: str) -> str:
    """Say how to give an argument to the nodes that may have a parameter of its name; empty if there are none."""
    nodes = takers(source, name)
    written = next((known for known, target in source.names.items() if target == _READER), "")
    homes = (known for known, target in source.names.items() if target == _READER.rpartition(".")[0])
    written = written or f"{next(homes, '')}.LaunchConfiguration".lstrip(".")
    value = f"{written}('{name}')"
    more = "".join(f", with `{line}` at the top" for line in missing_imports(source, value))
    row = f"{{'{name}': {value}}}"
    if len(nodes) != 1:
        return f"pass it to a node, as one of its parameters: {row}{more}" if nodes else ""
    where = f"the Node on line {nodes[0].lineno}"
    given = next((k.value for k in nodes[0].keywords if k.arg == "parameters"), None)
    for known in walk(source.written(given)) if given else ():
        for key, old in zip(getattr(known, "keys", ()), getattr(known, "values", ()), strict=False):
            if isinstance(key, ast.Constant) and key.value == name:
                return f"write {value} instead of {ast.unparse(old)} on line {old.lineno}{more}"
    fix = f"add {row} to the parameters of {where}" if given else f"pass it to {where}: parameters=[{row}]"
    return f"{fix}{more}"


def takers(source: PythonSource, name: str) -> list[ast.Call]:
    """Return the calls of a launch file that make nodes which may have a parameter of a name.

    Every node has `use_sim_time`; of the others it is known which the code of their packages declares.
    """
    calls = _node_calls(source)
    if name == "use_sim_time":
        return calls
    home = _home(source)
    declares = re.compile(rf"declare_parameters?\b.*?['\"]{re.escape(name)}['\"]", re.DOTALL)
    paths = (path for path in (home.parent.rglob("*.py") if home else ()) if declares.search(read_text(path)))
    homes = [folder for path in paths for folder in path.parents if (folder / "package.xml").is_file()]
    names = {
        text
        for folder in homes
        for text in re.findall(r"<name>\s*(\S+?)\s*<", read_text(folder / "package.xml"))
    }
    given = [next((k.value for k in call.keywords if k.arg == "package"), None) for call in calls]
    known = [evaluate(source.written(value), {}, {}) if value else UNKNOWN for value in given]
    return [c for c, package in zip(calls, known, strict=True) if names and package in {*names, UNKNOWN}]


def _home(source: PythonSource) -> Path | None:
    """Return the folder of the package that a launch file is in."""
    homes = source.path.parents if source.path else ()
    return next((folder for folder in homes if (folder / "package.xml").is_file()), None)


def _parameters_in(source: PythonSource, value: ast.expr) -> str | None:
    """Return the text of the parameter file that a value names; empty if it is of another kind; None if it names no file."""
    texts = [n.value for n in ast.walk(value) if isinstance(n, ast.Constant) and isinstance(n.value, str)]
    names = [PurePosixPath(text).name for text in texts if text.endswith((".yaml", ".yml"))]
    home = _home(source)
    if not names or home is None:
        return None
    found = (read_text(path) for name in names for path in sorted(home.parent.rglob(name)))
    return next((text for text in found if "ros__parameters" in text), "")


def _may_take(source: PythonSource, call: ast.Call, value: ast.expr) -> bool:
    """Return whether a node may be meant to get a value: one of a parameter file that has a section for it."""
    text = _parameters_in(source, value)
    if not text:
        return True
    given = {k.arg: evaluate(k.value, {}, {}) for k in call.keywords if k.arg in ("name", "executable")}
    sections = re.findall(r"(?:^|/)([\w*]+)[\"']?:\s*(?:#.*)?$", text, re.MULTILINE)
    return "**" in sections or not {*sections}.isdisjoint(map(str, given.values()))


def _is_offered(source: PythonSource, call: ast.Call, value: ast.expr) -> bool:
    """Return whether a node is likely to be meant: a file has a section for it, or it is the only node, and the workspace's own."""
    may_take = _may_take(source, call, value)
    home = _home(source)
    if not may_take or home is None or ".yaml" not in ast.unparse(value):
        return may_take
    if not _may_take(source, ast.Call(call.func, [], []), value):
        return True
    given = {k.arg: evaluate(source.written(k.value), {}, {}) for k in call.keywords}
    is_own = (home.parent / str(given.get("package", ""))).is_dir()
    return is_own and len(_node_calls(source)) == 1


def _place_for(source: PythonSource, name: str, value: ast.expr) -> tuple[str, str]:
    """Return the keyword of a Node that takes a value, and how it is written there; empty if none is known."""
    texts = [n.value for n in ast.walk(value) if isinstance(n, ast.Constant) and isinstance(n.value, str)]
    items = value.elts if isinstance(value, ast.List) else []
    called = source.resolve(value.func) or "" if isinstance(value, ast.Call) else ""
    is_action = ".actions." in called  # it belongs in the description, and no Node takes it
    files = [
        text for text in texts if text.endswith(_FILES) and isinstance(value, ast.Call) and not is_action
    ]
    is_yaml = any(file.endswith((".yaml", ".yml")) for file in files)
    are_pairs = bool(items) and all(isinstance(item, ast.Tuple) and len(item.elts) == 2 for item in items)
    are_values = bool(items) and all(isinstance(item, ast.Dict) for item in items)
    is_argument = _argument_of(source, value) in _only_read_once(source)
    ways = (
        (are_pairs, "remappings", name),
        (are_values, "parameters", name),
        (isinstance(value, ast.Dict), "parameters", f"[{name}]"),
        (is_argument, "parameters", f"[{{{texts[0] if texts else ''!r}: {name}}}]"),
        (is_yaml and _parameters_in(source, value) != "", "parameters", f"[{name}]"),
        (bool(files), "arguments", f"[{name}]"),
    )
    return next(((keyword, f"{keyword}={written}") for is_so, keyword, written in ways if is_so), ("", ""))


def _argument_of(source: PythonSource, value: ast.expr) -> str:
    """Return the launch argument that an expression reads; empty for any other expression."""
    return next((name for name, call in arguments_named(source, *READING) if call is value), "")


def _only_read_once(source: PythonSource) -> set[str]:
    """Return the arguments that a file declares and reads in one place; none if an included file may read them."""
    if "IncludeLaunchDescription" in source.text:
        return set()
    read = [name for name, _ in arguments_named(source, *READING)]
    return {name for name in _defaults(source) if read.count(name) == 1}


def _node_calls(source: PythonSource) -> list[ast.Call]:
    made = calls_of_launch(source, "launch_ros.actions.")
    return [call for name, call in made if name.rpartition(".")[2] in ("Node", "LifecycleNode")]
