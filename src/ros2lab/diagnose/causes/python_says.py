"""What Python's own errors mean, in the terms of the student's line that raised them."""

from __future__ import annotations

import ast
import builtins
import contextlib
import re
from collections.abc import Callable

from ros2lab.diagnose.causes.elements import beyond, no_key, none_left, numbered, subscripted
from ros2lab.diagnose.causes.init_order import destroyed, not_running
from ros2lab.diagnose.causes.nothing_given import head
from ros2lab.diagnose.causes.unfit_parameters import unset
from ros2lab.diagnose.checking.operands import held_in, unwrapped
from ros2lab.diagnose.code.hidden_names import fix_of, known_names
from ros2lab.diagnose.finding import SAID, Finding
from ros2lab.diagnose.printed.spots import Spot, kind_in_words
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.interfaces import node_members
from ros2lab.diagnose.sources.python_source import Function, names_read, walk
from ros2lab.diagnose.sources.syntax_parts import is_property


def by_zero(_match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for a division by zero: which divisor is 0, and where it was set."""
    for node in spot.nodes:
        match node:
            case ast.BinOp(op=ast.Div() | ast.FloorDiv() | ast.Mod(), right=divisor) if spot.function:
                values = spot.assigned(text := ast.unparse(divisor))
                zeros = [value for value in values if getattr(value, "value", None) in (0, 0.0)]
                if len(zeros) == 1 < len(values):
                    cause = f"{text} is still 0, as line {zeros[0].lineno} sets it, when {spot.function.name}() divides by it: nothing has set it to another value yet."
                    fix = f"write `if {text} == 0:` above this line, and below that, indented, `return`"
                    return cause, fix
    cause = f"`{spot.text}` divides by 0."
    return cause, "make sure the divisor is not 0; a period is 1.0 / rate, and both must be above 0"


def no_number(match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for a string that is no number of the wanted type."""
    text = match["name"].strip("'\"")
    with contextlib.suppress(ValueError):
        whole = int(float(text))
        calls = (n for n in spot.nodes if isinstance(n, ast.Call) and ast.unparse(n.func) == "int" and n.args)
        if (call := next(calls, None)) is not None:
            given = ast.unparse(call.args[0])
            cause = f"int() needs a string with a whole number, but {match['name']} is not one."
            fix = f"write float({given}) instead of int({given}); or, for {whole}, int(float({given}))"
            return cause, fix
    cause = f"The string {match['name']} is not a number, so `{spot.text}` cannot convert it."
    return cause, "write a number with a decimal point and without a unit, or catch ValueError around it"


def taken_apart(_match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for unpacking a wrong number of values, such as the keys of a dictionary."""
    for node in spot.nodes:
        match node:
            case ast.For(target=ast.Tuple(), iter=gone) if any(
                isinstance(value, (ast.Dict, ast.DictComp)) for value in spot.assigned(ast.unparse(gone))
            ):
                name = ast.unparse(gone)
                cause = (
                    f"Looping over the dictionary {name} gives only its keys, but here each one is unpacked."
                )
                return cause, f"write {name}.items() instead of {name}"
    cause = f"`{spot.text}` has a different number of names on the left than values on the right."
    return cause, "write as many names as there are values"


def too_few(match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for unpacking too few values: what only one branch needs is taken there, and else all or nothing."""
    wanted, function = match["wanted"], spot.function or ast.Module([], [])
    cause = f"`{spot.text}` needs {wanted} values but got {match['given']}."
    for node in spot.nodes:
        match node:
            case ast.Assign(targets=[ast.Tuple(elts=[ast.Name(id=first), *others])], value=value):
                given, names = ast.unparse(value), [*map(ast.unparse, others)]
                used = {n for n in walk(function) if getattr(n, "id", "") in names} - {*walk(node)}
                ifs = (
                    n for n in walk(function) if isinstance(n, ast.If) and first in names_read(walk(n.test))
                )
                inner = ((one, {n for part in one.body for n in walk(part)}) for one in ifs)
                where = next((ast.unparse(one.test) for one, body in inner if used and used <= body), "")
                if not where or match["given"] == "0":
                    return (
                        cause,
                        f"write `parts = {given}` and `if len(parts) == {wanted}:` above this line, and indent it, with `parts` instead of `{given}`, and what uses its names below that",
                    )
                rest = f"{', '.join(names)} = parts[1{':' * (len(names) > 1)}]"
                return (
                    cause,
                    f"write `parts = {given}` and `{first} = parts[0]` instead of this line, and `{rest}` first below `if {where}:`, where it is needed",
                )
    return (
        cause,
        f"store the result in one variable first, and check that it has {wanted} values before unpacking it",
    )


def operator(match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for an operator between two types that do not fit."""
    left, right = kind_in_words(match["left"]), kind_in_words(match["right"])
    if match["left"] == "sequence":
        cause = f"`{spot.text}` repeats a list or a string, which needs a whole number, but the number is {right}."
        return cause, "write int(...) around the number"
    is_text = "a string" in (left, right)
    fix = "convert both to the same type; a message's number is in one of its fields, such as msg.data"
    if is_text:
        fix = "write str(...) around what is not a string, or float(...) around the string if a number was meant"
    for kind in (match["left"], match["right"]):
        if members := interfaces.methods_of(kind):
            fix = f"use a number from the {kind}, which has {members}"
    sign = re.search(r"for ([^ :]+):|'(\S+)' not supported", match.string)
    fix = unwrapped(spot, (match["left"], match["right"]), (sign[1] or sign[2]) if sign else "") or fix
    does = "compares" if sign and sign[2] else "combines"
    why = "which Python cannot do"
    if ".from_msg(" in fix:
        why = "and at least one of them is a message, which has only sec and nanosec: it must become one of rclpy first"
    return f"`{spot.text}` {does} {left} with {right}, {why}.", fix


def unhashable(match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for a value that cannot be hashed, as rclpy does with nodes."""
    kind = match["kind"]
    for node in spot.file.nodes:
        if not isinstance(node, ast.ClassDef) or node.name != kind:
            continue
        made = next((text for text in map(ast.unparse, node.decorator_list) if "dataclass" in text), "")
        what = f"@{made} gives" if made else "__eq__ gives"
        cause = f"{what} the class {kind} its own comparison and removes its hash, which rclpy and Python use to tell objects apart."
        where = f"on line {node.lineno - 1}" if made else f"from the class on line {node.lineno}"
        lack = "set its fields in __init__" if made else "compare with another method"
        fix = f"remove @{made} {where}, and {lack}" if made else f"remove __eq__ {where}, and {lack}"
        return cause, fix
    cause = f"A value of type {kind} cannot be in a set or be the key of a dict: `{spot.text}`."
    return cause, "use a string or a tuple there; braces make a set, and brackets a list"


_PRINT = "print the values used on this line just above it, and see which one is not what you expected"


_Said = Callable[[re.Match[str], Spot], tuple[str, str]]
# A pattern, and a function that makes cause and fix of it, or both as texts, with its groups and the line filled in.
_Saying = tuple[str, _Said] | tuple[str, str, str]


def of_error(kind: str, message: str, place: str, spot: Spot) -> Finding | None:
    """Return what an error means at a place; None if nothing is known of it."""
    for saying in _SAYINGS if spot.text or not place else ():
        match = re.search(saying[0], f"{kind}: {message}")
        is_quoting = isinstance(saying[1], str) and "{text}" in saying[1]
        if match is not None and (spot.text or not is_quoting):
            cause, fix = _told(saying, match, spot)
            return Finding("python-error", cause, place, fix)
    known = getattr(builtins, kind, None)
    if not place or kind in ("CheckError", "TerminalError"):
        return None
    if not isinstance(known, type) or not issubclass(known, Exception):
        refusal = re.sub(r", at /\S+", "", message).rstrip(".")
        cause = f"`{spot.text}` fails: {refusal}."
        fix = "check each value on this line against what the message says"
        if "Couldn't parse" in refusal:  # by rcl, of what a command or a launch file gives
            cause, place = f"ROS refuses the arguments of the node: {refusal}.", ""
            fix = "correct them in the command or the launch file that starts it"
        return Finding(SAID, cause, place, fix) if spot.text and refusal else None
    if kind == "TypeError" and (taken := _taken_out(message, spot)):
        name, held = taken
        cause = f"{name} is {kind_in_words(held)}, but `{spot.text}` needs the value inside it."
        return Finding("python-error", cause, place, f"write {held_in(name, held)} instead of {name}")
    where = f"in `{spot.text}`" if spot.text else "at this line"
    return Finding(SAID, f"Python stops {where} with {kind}: {message}".removesuffix(": "), place, _PRINT)


def _told(saying: _Saying, match: re.Match[str], spot: Spot) -> tuple[str, str]:
    if len(saying) == 2:
        return saying[1](match, spot)
    groups = {**match.groupdict(default=""), "text": spot.text}
    return saying[1].format(**groups), saying[2].format(**groups)


def _taken_out(message: str, spot: Spot) -> tuple[str, str] | None:
    """Return the argument that holds the value that a function needs, and its type; None if none does."""
    kind = next((word for word in re.findall(r"[A-Z]\w+", message) if held_in("", word)), None)
    calls = spot.calls
    calls = [spot.marked] if isinstance(spot.marked, ast.Call) else calls
    given = [arg for call in calls for arg in call.args if isinstance(arg, (ast.Name, ast.Attribute))]
    return (ast.unparse(given[-1]), kind) if kind and given else None


def _other_class(_match: re.Match[str], spot: Spot) -> tuple[str, str]:
    cause = "super(...) is given a different class from the one it is used in."
    for node in spot.nodes:
        match node:
            case ast.Call(func=ast.Name(id="super"), args=[given, *_]):
                cause = f"super() is given {ast.unparse(given)}, which is not the class it is used in."
                fix = f"write super() instead of {ast.unparse(node)}"
                return cause, fix
    return cause, "write super() without arguments"


def _local(match: re.Match[str], spot: Spot) -> tuple[str, str]:
    name, function, source = match["name"], spot.function, spot.file
    where = f"{function.name}()" if function else "this function"
    cause = f"{where} assigns {name}, so {name} is a local variable everywhere in it, and here it has no value yet"
    if any(imported.local == name for imported in source.imports):
        cause = f"{cause}: it hides the imported {name}."
        fix = f"rename the variable, for example to {name.lower()}_"
        return cause, fix
    if function and name in (known := known_names(source)):
        return f"{cause}: it hides {known[name]}.", fix_of(name, function.name)
    at_top = [n for n in source.tree.body if isinstance(n, (ast.Assign, ast.AnnAssign))]
    if any(isinstance(i, ast.Name) and i.id == name for n in at_top for i in ast.walk(n)):
        cause = f"{cause}: it is not the global {name}."
        fix = f"write self.{name} everywhere, and set it in __init__; or write `global {name}` as the first line of {where}"
        return cause, fix
    cause = f"{cause}."
    fix = f"give {name} a value on the first line of {where}, in case no other line does"
    return cause, fix


def _called(match: re.Match[str], spot: Spot) -> tuple[str, str]:
    kind = match["kind"]
    if not spot.is_innermost:
        cause = f"What was passed to ROS as a callback is {kind_in_words(kind)}, not a function."
        fix = "pass each create_timer and create_subscription a method, such as self.callback, without quotes or parentheses"
        return cause, fix
    calls = spot.calls
    calls = [spot.marked] if isinstance(spot.marked, ast.Call) else calls
    fitting = [n for n in calls if isinstance(n.func, (ast.Attribute, ast.Subscript))] or calls
    what = ast.unparse(fitting[0].func) if len({ast.unparse(n.func) for n in fitting}) == 1 else ""
    if hasattr(builtins, what) and what not in spot.file.stored:
        cause = f"{what}() calls one of its arguments, which is {kind_in_words(kind)}, not a function."
        return cause, f"pass {what}() a function there, by name and without parentheses"
    is_set = len(fitting) == 1 and len(fitting[0].args) == 1 and isinstance(fitting[0].func, ast.Attribute)
    value = (
        f": a value is assigned with =, as in {what} = {ast.unparse(fitting[0].args[0])}" if is_set else ""
    )
    cause = f"{what or 'Something on this line'} is {kind_in_words(kind)}, not a function, so it cannot be called with parentheses."
    return cause, f"remove the parentheses after {what or 'it'}{value}"


def _none(match: re.Match[str], spot: Spot) -> tuple[str, str]:
    name = match["name"]
    owners = spot.holds(name)
    owner = owners[0] if owners else f"the object before .{name}"
    why, fix = "", f"set {owner} before this line is reached, and check its value"
    for value in spot.assigned(owner):
        if isinstance(value, ast.Constant) and value.value is None and not why:
            why, fix = (
                ": it was set to None and has no other value yet",
                f"write these two lines above line {head(spot, spot.function.body if spot.function else ())}: `if {owner} is None:`, and indented below it `return`",
            )
    return f"{owner} is None when .{name} is used{why}.", fix


def _base(_match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for a module that is used as a base class."""
    for node in spot.nodes:
        for base in node.bases if isinstance(node, ast.ClassDef) else ():
            name = ast.unparse(base)
            homes = interfaces.homes_of(name.rpartition(".")[2].capitalize())
            line = next((imported.line for imported in spot.file.imports if imported.local == name), 0)
            if homes and line:
                meant = name.rpartition(".")[2].capitalize()
                cause = f"{name} is the module here, not a class."
                fix = f"write `from {homes[0]} import {meant}` on line {line}"
                return cause, fix
    cause = f"In `{spot.text}` there is a module where a class should be."
    fix = "import the class from the module, and use it here"
    return cause, fix


def _without_end(_match: re.Match[str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix for a function that calls itself, or a property that uses itself."""
    function = spot.function
    if function is not None and is_property(function):
        own = f"self.{function.name}"
        used = {ast.unparse(n): n for n in spot.nodes if isinstance(n, ast.Attribute)}
        if own in used:
            what = "To set" if isinstance(used[own].ctx, ast.Store) else "Reading"
            cause = f"{what} {own} calls the property {function.name}() itself, endlessly."
            fix = f"write self._{function.name} instead of {own} here, and wherever the property stores its value"
            return cause, fix
    if (
        function is not None
        and (call := _own_call(spot, function))
        and (whose := _overridden(spot, function))
    ):
        cause = f"{function.name}() overrides the method of {whose}, and here it calls itself, endlessly."
        return cause, f"write super(){ast.unparse(call).removeprefix('self')} instead of {ast.unparse(call)}"
    cause = f"`{spot.text}` leads back to itself, endlessly."
    return cause, "call another function there, or end the calls with a condition that comes true"


def _own_call(spot: Spot, function: Function) -> ast.Call | None:
    """Return the call on a line of the method that it is in."""
    calls = spot.calls
    return next((call for call in calls if ast.unparse(call.func) == f"self.{function.name}"), None)


def _overridden(spot: Spot, function: Function) -> str:
    """Return which base class has the method that a method overrides; empty if none is known to."""
    classes = {n.name: n for n in (spot.file.nodes) if isinstance(n, ast.ClassDef)}
    owner = next((found for found in classes.values() if function in found.body), None)
    for base in map(ast.unparse, owner.bases if owner else ()):
        inner = classes[base].body if base in classes else ()
        is_own = any(isinstance(n, ast.FunctionDef) and n.name == function.name for n in inner)
        if is_own or (base.endswith("Node") and function.name in node_members()):
            return base
    return ""


# Python's own messages, and what they mean for a beginner; the first match counts.
_SAYINGS: tuple[_Saying, ...] = (
    (r"UnboundLocalError: .*variable '(?P<name>\w+)'", _local),
    (r"TypeError: '(?P<kind>\w+)' object is not callable", _called),
    (r"'NoneType' object has no attribute '(?P<name>\w+)'", _none),
    (r"can't multiply (?P<left>sequence) by non-int of type '(?P<right>\w+)'", operator),
    (r"unsupported operand .*: '(?P<left>\w+)' and '(?P<right>\w+)'", operator),
    (r"not supported between instances of '(?P<left>\w+)' and '(?P<right>\w+)'", operator),
    (r"can only concatenate (?P<left>\w+) \(not \"(?P<right>\w+)\"\)", operator),
    (r"super\(type, obj\): obj must be an instance", _other_class),
    (r"TypeError: module\(\) takes at most \d arguments", _base),
    (
        r"attempted relative import",
        "The file was started directly, so its relative import (with a dot) has no package to start from.",
        "start it with `ros2 run` and the names of the package and its executable",
    ),
    (
        r"partially initialized module '(?P<name>[\w.]+)'",
        "Two modules import each other, and {name} is asked for a name it has not defined yet.",
        "move what both need into a third module, or remove one of the two imports",
    ),
    (r"KeyError: (?P<name>.+)", no_key),
    (
        r"Replacement index \d+ out of range|not enough arguments for format|not all arguments converted",
        "In `{text}` the string does not have as many placeholders as there are values.",
        "write an f-string, with each value in its place: f'... {{value}}'",
    ),
    (
        r"(?:(?P<name>min|max|pop)\b.*)?\bempty(?: sequence| list| deque)?$|zero-size array|at least one data point",
        none_left,
    ),
    (r"IndexError: (?P<name>.+)", beyond),
    (r"TypeError: (?!string)\w+ indices must be integers", numbered),
    (r"ZeroDivisionError", by_zero),
    (
        r"ValueError: (?:could not convert string to float|invalid literal for int\(\).*): (?P<name>.+)",
        no_number,
    ),
    (
        r"cannot unpack non-iterable (?P<kind>\w+)",
        "`{text}` needs several values, but there is only one on the right, of type {kind}.",
        "give it as many values as there are names on the left, or keep only one name there",
    ),
    (
        r"not enough values to unpack \(expected (?:at least )?(?P<wanted>\d+), got (?P<given>\d+)",
        too_few,
    ),
    (r"too many values to unpack", taken_apart),
    (r"RecursionError", _without_end),
    (r"'(?P<kind>\w+)' object (?:is not subscriptable|does not support item assignment)", subscripted),
    (
        r"'(?P<kind>\w+)' object is not iterable|argument of type '(?P<kind2>\w+)' is not (?:iterable|a container)",
        "`{text}` needs a list or a string, but is given a value of type {kind}{kind2}.",
        "use its field that is a list or a string, such as msg.data",
    ),
    (
        r"'(?P<kind>\w+)' object cannot be interpreted as an integer",
        "`{text}` uses a value of type {kind} in a way that this type does not allow.",
        "convert it to a list, or with int(...), first",
    ),
    (r"unhashable type: '(?P<kind>\w+)'", unhashable),
    (
        r"UnicodeDecodeError",
        "A file is not saved as UTF-8, so Python cannot read one of its characters.",
        "save it again with the encoding UTF-8",
    ),
    (
        r"'generator' object|was never awaited|coroutine",
        "`{text}` makes a coroutine, which does nothing until it is awaited.",
        "write await before it, in an async function, or def instead of async def",
    ),
    (
        r"AttributeError: type object '(?P<kind>\w+)' has no attribute '(?P<name>\w+)'",
        "The class {kind} itself has no {name}.",
        "make an instance first, {kind}(), or fix the spelling of {name}",
    ),
    (r"InvalidHandle|destruction was requested|cannot use Destroyable", destroyed),
    (r"context is not valid|rcl_shutdown\(\) was called|context is invalid|NotInitialized", not_running),
    (
        r"ParameterAlreadyDeclaredException.*?\['?(?P<name>[\w.]+)",
        "The node already has the parameter {name} when `{text}` is reached.",
        "remove this line",
    ),
    (
        r"ParameterUninitializedException.*?(?P<name>[\w.]+)?$",
        unset,
    ),
)


def of_function(name: str, place: str, spot: Spot) -> Finding:
    """Return a finding about an attribute of a function, as in glob.glob after `from glob import glob`."""
    owners = spot.holds(name)
    owner = owners[0] if owners else "the object before the dot"
    code, cause = "attribute-unknown", f"{owner} is a function, so it has no {name}"
    imports = (i.target for i in spot.file.imports if i.local == owner and i.is_from)
    module = next(imports, "").rpartition(".")[0]
    if owner.rpartition(".")[2] == name:
        cause = f"{cause}: it was imported with `from {name} import {name}`, so it already is {owner}.{name}."
        return Finding(code, cause, place, f"write {owner}(...) instead of {owner}.{name}(...)")
    if module and interfaces.has_name(module, name):
        cause = (
            f"{cause}: it was imported with `from {module} import {owner}`, and {name} is in {module} itself."
        )
        return Finding(code, cause, place, f"write `import {module}` at the top, and {module}.{name} here")
    return Finding(
        code, f"{cause}: the parentheses that call it are missing.", place, f"write {owner}().{name}"
    )
