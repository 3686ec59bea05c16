"""The value that a parameter is given: where it is given, and how it is written as another type."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Collection
from decimal import Decimal
from typing import Any

import yaml

from ros2lab.diagnose.finding import at
from ros2lab.diagnose.sources.parameter_file import kind_of
from ros2lab.diagnose.sources.python_source import read_text


def given_at(name: str, look: Any, typed: Collection[str]) -> str:
    """Return the place where a file sets a parameter; empty if a command sets it, or if none is found."""
    if any(re.search(rf"ros2 run .*-p {re.escape(name)}:=", line) for line in typed):
        return ""
    for package in look.packages if look else ():
        for path in [*package.launch_files, *package.parameter_files]:
            for number, line in enumerate(read_text(path).splitlines(), 1):
                short = re.escape(name.rpartition(".")[2])
                if re.search(rf"(?<![\w.])['\"]?{short}['\"]?\s*:|<param\b.*\bname=['\"]{short}['\"]", line):
                    return at(package.shown(str(path.relative_to(package.folder))), number)
    return ""


_KINDS = {
    "INTEGER": "a whole number",
    "DOUBLE": "a number with a decimal point",
    "STRING": "a text",
    "BOOL": "true or false",
    "BYTE_ARRAY": "a list of bytes",
    "INTEGER_ARRAY": "a list of whole numbers",
    "DOUBLE_ARRAY": "a list of numbers with decimal points",
    "STRING_ARRAY": "a list of texts",
    "BOOL_ARRAY": "a list of true and false",
}


def type_in_words(kind: str) -> str:
    """Return a type of parameters in words, such as `a whole number` for INTEGER."""
    return _KINDS.get(kind, kind)


def of_its_type(value: Any, default: Any) -> str:
    """Return what to add where a value is given to a parameter whose default has another type; empty if it fits."""
    given, wanted = kind_of(value), kind_of(default)
    return f", with {type_in_words(wanted)} as its value" if given and wanted and given != wanted else ""


def value_in_words(value: str, kind: str) -> str:
    """Return a value with its type as far as the value does not show it."""
    if kind == "STRING":
        return f"the text {value!r}"
    return value if kind in ("INTEGER", "DOUBLE", "BOOL") else f"{value}, {type_in_words(kind)}"


def retyped(name: str, value: str, wanted: str, typed: Collection[str]) -> str:
    """Return how to retype a command that gave a parameter a value of another type; empty if none did."""
    given = re.compile(rf"(?<!\w){re.escape(name)}:=(?P<value>\S+)")
    line = next(filter(given.search, typed), "")
    old = given.search(line)
    digits = re.fullmatch(r"[-+]?\d+([.,]\d*)?", value)
    right = ""
    if wanted == "DOUBLE" and digits:
        right = value.replace(",", ".") if digits[1] else f"{value}.0"
    elif wanted == "INTEGER" and digits:
        right = re.split(r"[.,]", value)[0]
    elif wanted == "STRING" and old:
        # The value as it was typed: the error shows it read as a number, which may have lost something.
        plain = old["value"].strip("\"'")
        if " launch " in line and _loses_quotes(plain):
            given_so = f"ros_arguments=['-p', [\"{name}:='\", LaunchConfiguration('{name}'), \"'\"]]"
            return f"write {given_so} in its Node(...) instead of {name} in parameters=[...]: launch would write the string {plain} without quotes, and ROS would read a number"
        right = f"\"'{plain}'\""
    return f"type `{line.replace(old[0], f'{name}:={right}')}`" if old and right else ""


def _loses_quotes(value: str) -> bool:
    """Return whether launch writes a text without quotes that ROS then reads as a number, such as `12E5`."""
    with contextlib.suppress(ValueError):
        return bool(float(value)) and yaml.safe_dump(value).split()[0] == value
    return False


def value_fix(name: str, value: str, kind: str, wanted: str) -> str:
    """Say how to write a value so that YAML reads it as the wanted type in a file."""
    plain = value.strip().strip("'\"").replace("_", "")
    digits = re.match(r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?", plain)  # a unit may follow
    number, is_number = f"{Decimal(digits[0].replace(',', '.')):f}" if digits else "", digits is not None
    point = number if "." in number else f"{number}.0"
    fixes = {
        "DOUBLE": f"write {name}: {point}, without quotes and with a decimal point" * is_number,
        "INTEGER": f"write {name}: {number.partition('.')[0]}, a whole number without a decimal point or quotes"
        * is_number,
        "STRING": f"put it in quotes, or YAML reads it as {kind.lower()}: {name}: '{value}'",
        "BOOL": f"write {name}: true or false, in lower case and without quotes",
    }
    if wanted == "INTEGER" and kind == "DOUBLE" and "." in number:
        return f"declare {name} with a default of type DOUBLE, such as declare_parameter('{name}', {number}): a parameter keeps the type of its default"
    if wanted == "BYTE_ARRAY" and kind.endswith("ARRAY"):
        return f"write declare_parameter('{name}', Parameter.Type.{kind}) in the node, with `from rclpy.parameter import Parameter`: an empty list as the default does not say what type its items have; such a parameter has no value until it is given one, and reading it before that fails"
    if wanted == "DOUBLE_ARRAY" and kind == "INTEGER_ARRAY":
        points = re.sub(r"-?\d+", lambda number: f"{number[0]}.0", value)
        return f"write each number with a decimal point: {name}: {points}"
    if wanted.endswith("ARRAY") and not kind.endswith("ARRAY"):
        return f"write a list: {name}: [{value}]"
    return (
        fixes.get(wanted)
        or f"give it a value of type {wanted}, or declare {name} with a default of type {kind}: a parameter keeps the type of its default"
    )
