"""What a program gets from its terminal: environment variables, and the arguments that ROS adds to its own."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.finding import Finding, these_lines
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.sources.python_source import PythonSource, last_name
from ros2lab.diagnose.sources.spelling import nearest

_SET = re.compile(
    r"(?:^|[;&] *)(?P<export>export +|declare -x +|)(?P<name>[A-Za-z_]\w*)=(?P<value>\"[^\"]*\"|'[^']*'|[^\s;&]*)"
    r"(?= *(?:$|[;&]))"
)
_MISSET = re.compile(r"^(?:set +|setenv +|\$)?(?P<name>[A-Za-z_]\w*)(?: *= *| +)(?P<value>[^\s;&]+)$")
_KEPT = re.compile(r"export +(?P<name>[A-Za-z_]\w*)=(?P<value>[^\s'\";]*)['\"]? *>> *(?P<file>\S*\.\w+)")
_OTHER_TERMINAL = re.compile(r"(?i)\bterminal\b|\btab\b|\bwindow\b|\bfenster\b")


def of_variable(name: str, place: str, error: ErrorText) -> Finding:
    """Return a finding about why a program does not see a variable, and what to type so that it does."""
    # A student's note such as `# terminal 2` is no command, but tells where the next one was typed.
    shown = [line for step in error.steps for line in (step.command, *step.lines)]
    typed = _before_the_program([line for line in shown if line in error.typed or line.startswith("#")])
    for line in reversed(typed):
        if told := _of_line(line, name, typed):
            cause, command = told
            return Finding("typed-wrong", cause, "", f"type `{command}`, then start the program again")
    set_there = {
        match["name"]: match["value"] for line in typed for match in _SET.finditer(line) if match["export"]
    }
    if near := nearest(name, set_there, 0.7):
        cause = f"The program reads the variable {name}, but {near} was set: the names differ."
        command = f"export {name}={set_there[near]}"
        return Finding("typed-wrong", cause, place, f"type `{command}`, then start the program again")
    cause = f"The variable {name} is not set in the terminal where the program was started."
    fix = f"type `export {name}=...`, with its value, in that terminal, then start the program again"
    return Finding("typed-wrong", cause, place, fix)


def _before_the_program(typed: Sequence[str]) -> list[str]:
    """Return what was typed before the last program was started; everything if none was."""
    starts = [n for n, line in enumerate(typed) if re.search(r"\bros2 (?:run|launch)\b|\bpython3? \S", line)]
    return [*typed[: starts[-1] + 1]] if starts else [*typed]


def _of_line(line: str, name: str, typed: Sequence[str]) -> tuple[str, str] | None:
    """Return why a typed line does not set a variable, and the command that does; None if it is unrelated."""
    if re.match(rf"unset +(?:-v +)?{name}\b", line):
        return f"`{line}` removes the variable {name}.", f"export {name}=..."
    if (kept := _KEPT.search(line)) and kept["name"] == name:
        cause = f"`{line}` takes effect only in terminals opened from then on, not in this one."
        return cause, f"source {kept['file']}"
    for match in _SET.finditer(line):
        if match["name"] != name:
            continue
        command = f"export {name}={match['value']}"
        after = typed[len(typed) - 1 - [*reversed(typed)].index(line) :]
        if not match["export"]:
            cause = f"`{match[0].strip('; &')}` sets {name} only for the shell: the programs it starts see only exported variables."
            return cause, command
        if any(_OTHER_TERMINAL.search(later) for later in after):
            cause = f"`{command}` applies only to the terminal where it was typed, but the program was started in another one."
            return cause, command
    if (misset := _MISSET.match(line)) and misset["name"] == name:
        return f"`{line}` sets no variable of that name in this shell.", f"export {name}={misset['value']}"
    return None


# How argparse, click, getopt, and a conversion of an item of sys.argv complain.
_REFUSED = re.compile(
    r"(?:unrecognized arguments: |[Nn]o such option:? |\boption |invalid .+: '|could not convert .+: ')(?P<word>--ros-args|[\w/~]+:=)"
)
_OWN = "rclpy.utilities.remove_ros_args()"


def of_ros_arguments(error: ErrorText, look: Look) -> Finding | None:
    """Say how a program is to leave out what ROS adds to its arguments; None if it complains of something else."""
    refused = _REFUSED.search(error.text)
    named = {*re.findall(r"[\w.-]+", error.text)}
    points = [(package, point) for package in look.packages for point in package.points]
    for package, point in points if refused else ():
        source = package.sources.get(point.module)
        is_named = not named.isdisjoint((point.name, f"{point.module.rpartition('.')[2]}.py"))
        if is_named and source and (reading := next(_readings(source), None)):
            node, fix = reading
            more = "" if "rclpy" in source.names else ", with `import rclpy` at the top"
            cause = f"`{ast.unparse(node)}` also reads --ros-args and what follows it, which is meant for rclpy alone."
            return Finding("argument-unknown", cause, source.at(node), f"{fix[0]}{more}{fix[1]}")
    return None


def _readings(source: PythonSource) -> Iterator[tuple[ast.expr, tuple[str, str]]]:
    """Yield what reads the whole command line, each with how to read only the program's own part of it, and a hint."""
    for node in source.nodes:
        match node:
            case ast.Call(func=ast.Attribute(attr="parse_args") as called, args=[], keywords=[]):
                yield node, (f"write `{ast.unparse(called)}({_OWN}[1:])`", "")
            case ast.Subscript(value=ast.Attribute() | ast.Name() as whole) if _is_whole(source, whole):
                yield node, _read_once(source, node, ast.unparse(whole))


def _is_whole(source: PythonSource, node: ast.AST) -> bool:
    """Return whether an expression is the whole command line, and not given to rclpy, which is to read all of it."""
    around = [source.above(node)]
    around += [source.above(outer) for outer in around if isinstance(outer, (ast.keyword, ast.Subscript))]
    is_given = any(last_name(getattr(outer, "func", None)) == "init" for outer in around)
    return source.resolve(node) == "sys.argv" and not is_given


def _read_once(source: PythonSource, node: ast.Subscript, name: str) -> tuple[str, str]:
    """Return how to leave out ROS's arguments in all that a function reads of them: what it counts must be what it takes."""
    function = source.function_at(node.lineno)
    reads = [
        other
        for other in source.nodes
        if isinstance(other, (ast.Attribute, ast.Name))
        and _is_whole(source, other)
        and source.function_at(other.lineno) is function
    ]
    if len(reads) == 1:
        given = "; give its own arguments in the launch file, by arguments=[...]"
        return f"write `{ast.unparse(node).replace(name, _OWN)}`", given
    lines = sorted({other.lineno for other in reads})
    first: ast.AST = next(other for other in reads if other.lineno == lines[0])
    while (outer := source.above(first)) not in (None, function) and not isinstance(outer, ast.Module):
        first = outer
    above = f"above line {getattr(first, 'lineno', lines[0])}"
    return f"write `own = {_OWN}` {above}, and `own` instead of `{name}` in {these_lines(lines)}", ""
