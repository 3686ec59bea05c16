"""The types of a type checker in the words of a beginner."""

from __future__ import annotations

import ast
import re

from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.python_source import own_nodes


def of_class(said: dict[str, str], spot: Spot) -> tuple[str, str, str]:
    """Say that a class stands where an object of it belongs."""
    assert spot.source is not None
    name = re.sub(r"<class '(.+)'>", r"\1", said.get("given", ""))
    cause = (
        f"{name or 'The class'} is the class itself, not an instance: the parentheses after it are missing."
    )
    place = spot.source.at(spot.line)
    if made := _made_of(name, spot):
        return cause, place, f"write {made} instead of {name}"
    where = f", as in node = {name}()" if name else ""
    new = f"{name}()" if name else "() after the name of the class"
    return cause, place, f"write {new} where the instance is made{where}"


def _made_of(name: str, spot: Spot) -> str:
    """Return the name of the object that a function makes of a class; empty if it makes none."""
    for node in own_nodes(spot.function) if spot.function else ():
        match node:
            case ast.Assign(targets=[ast.Name(id=made)], value=ast.Call(func=ast.Name(id=called))):
                if called == name:
                    return made
    return ""


def plain(kind: str) -> str:  # noqa: PLR0911 -- a table
    """Return a type in words."""
    if text := re.fullmatch(r"Literal\[([\"'])(.*)\1\]", kind):
        return f"the string {text[2]!r}"
    kind = re.sub(r"^Self@\w+", "self", kind)
    kind = kind.replace("SupportsIndex | float*", "float").removesuffix("*")
    kind = re.sub(r"\[(?:Unknown|Any)[^\]]*\]", "", kind)
    if re.match(r"(?:Iterable|list|Sequence)\[.*\[", kind):
        return "a list of pairs, as in [('a', 'b')]" if "[tuple" in kind else "a list"
    kind = re.sub(r"Iterable\[str \| Substitution\] \| Substitution", "str", kind)  # what launch calls a text
    parts = [part for part in re.split(r" \| (?![^\[(]*[\])])", kind) if part != "None"]
    if len(parts) > 1 or kind.endswith(" | None"):
        return " or ".join(dict.fromkeys(map(plain, parts)))
    if inner := re.fullmatch(r"(?:Iterable|list|Sequence|List|Collection)\[(.+)\]", kind):
        return f"a list of {inner[1].rpartition('.')[2]}s, in brackets"
    if made := re.fullmatch(r"type\[(.+)\]|<class '(.+)'>", kind):
        return f"the class {made[1] or made[2]} itself"
    if kind.startswith(("(", "def ", "bound method", "Callable")):
        return "a function, not called"
    known = {
        "str": "a string",
        "int": "an integer",
        "float": "a float",
        "None": "None",
        "bool": "True or False",
    }
    return known.get(kind, re.sub(r"^Literal\[(.*)\]$", r"\1", kind))
