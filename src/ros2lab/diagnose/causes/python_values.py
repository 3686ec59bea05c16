"""What Python's own errors mean for the values on a line: numbers, strings, operators, unpacking."""

from __future__ import annotations

import ast
import contextlib
import re

from ros2lab.diagnose.checking.operands import unwrapped
from ros2lab.diagnose.printed.spots import Spot, kind_in_words
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import names_read, walk


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
