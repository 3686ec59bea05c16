"""The members of modules and classes, and which one was meant by a name that they lack."""

from __future__ import annotations

import ast
import builtins
import difflib
import re
import sys
from collections.abc import Sequence

from ros2lab.diagnose.checking.checked_copies import first_that_stands
from ros2lab.diagnose.finding import in_a_row
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.interfaces import field_kind
from ros2lab.diagnose.sources.spelling import may_mean, nearest, nothing_like
from ros2lab.diagnose.sources.syntax_parts import calls_in

_MOST_OFFERED = 6  # members of a class that are told


def members(owner: str, look: Look | None) -> set[str]:
    """Return the public members of a module or a class, including the workspace's own classes."""
    if owner in sys.stdlib_module_names:
        return {name for name in interfaces.importable_names(owner) or () if not name.startswith("_")}
    found = set(interfaces.names_in(owner, is_own=True) or ()) | set(dir(getattr(builtins, owner, object)))
    for home in _homes(owner):
        found |= interfaces.members_of(home, owner) or set(interfaces.fields_of(f"{home}.{owner}") or ())
    for sources in map(look.sources, look.packages) if look else ():
        for node_class in sources.classes.values():
            if node_class.name.endswith(f".{owner}"):
                found |= sources.members(node_class) or node_class.attributes
    return {name for name in found if not name.startswith("_")}


def in_place_of(name: str, owner: str, spot: Spot, look: Look | None, said: str = "") -> str:
    """Return what to write instead of a member that does not exist; empty if that is not known.

    It may be a field with a matching type name, the member with the most similar name, one with which an older name
    ends, as `RELIABLE` in `RELIABILITY_RELIABLE`, or a method with an option, as
    `info(..., throttle_duration_sec=2.0)` for `info_throttle(2.0, ...)`.

    Args:
        name: the member.
        owner: what lacks it.
        spot: the line that asks for it.
        look: the workspace.
        said: what the type checker says of the line, which must accept it with what is returned; empty if nothing.
    """
    known = members(owner, look) - {name}
    if option := _with_option(name, known, owner, spot):
        return option
    near = [*filter(None, [nearest(name, known)]), *difflib.get_close_matches(name, known, n=9, cutoff=0.6)]
    ends = sorted((member for member in known if name.endswith(f"_{member}")), key=len, reverse=True)
    meant = [_of_type(name, owner), *(member for member in near if may_mean(name, member, known)), *ends]
    meant = [*dict.fromkeys(filter(None, meant))]
    uses = [n for n in spot.nodes if isinstance(n, ast.Attribute) and n.attr == name]
    if any(call.func in uses for call in calls_in(spot.nodes)):  # no module can be called
        meant = [member for member in meant if not interfaces.is_module(f"{owner}.{member}")]
    if len(uses) == 1 and meant and said and spot.source:
        calls = (n for n in calls_in(spot.nodes) if n.func is uses[0])
        whole = next(calls, uses[0])
        rest = ast.unparse(whole).removeprefix(ast.unparse(uses[0]))
        ways = {f"{ast.unparse(uses[0].value)}.{member}{rest}": member for member in meant}
        meant = [ways.get(first_that_stands(spot.source, whole, list(ways), settled=said), "")]
    return next(iter(meant), "")


def without_like(name: str, owner: str, called: str, look: Look, spot: Spot) -> tuple[str, str]:
    """Return cause and fix of a member like none that its owner, as it is `called`, has; only a workspace's own can be defined."""
    short = owner.rpartition(".")[2]
    files = [source for package in look.packages for source in look.sources(package).sources.values()]
    own = {inner for file in (*files, spot.file) for inner in (file.name.rpartition(".")[2], *file.classes)}
    cause, is_own = f"{called} has no {name}", short in own
    if is_own and 0 < len(offers := members(short, look)) <= _MOST_OFFERED:
        cause += f"; it has {in_a_row(sorted(offers))}"
    elif not is_own and (owner.partition(".")[0] in interfaces.PACKAGES or _homes(short)):
        has = interfaces.methods_of(short)
        cause += f" in ROS 2 Jazzy{f'; it has {has}' if has else ''}"
    return f"{cause}.", nothing_like(name, called, is_own=is_own)


def _homes(owner: str) -> Sequence[str]:
    return interfaces.homes_of(owner) or interfaces.inner_homes_of(owner) or interfaces.launch_homes_of(owner)


def _of_type(name: str, owner: str) -> str:
    """Return the field whose Python type matches the name, as double_value for float_value; else empty."""
    first, _, rest = name.partition("_")
    for home in interfaces.homes_of(owner):
        for field, kind in (interfaces.fields_of(f"{home}.{owner}") or {}).items():
            if field_kind(kind) == first and field.partition("_")[2] == rest:
                return field
    return ""


def _with_option(name: str, known: set[str], owner: str, spot: Spot) -> str:
    """Return a call of the method whose name is a prefix of this name, with an option for the rest."""
    methods = [member for member in known if name.startswith(f"{member}_")]
    calls = [n for n in calls_in(spot.nodes) if getattr(n.func, "attr", "") == name]
    if not methods or len(calls) != 1:
        return ""
    method, call = max(methods, key=len), calls[0]
    for home in interfaces.inner_homes_of(owner):
        text = interfaces.text_of(home)
        option = re.search(rf"['\"]({re.escape(name[len(method) + 1 :])}\w*)['\"]", text)
        plain = (argument for argument in call.args if isinstance(argument, ast.Constant))
        numbers = [argument for argument in plain if not isinstance(argument.value, str)]
        if option and isinstance(call.func, ast.Attribute):
            value = ast.unparse(numbers[0]) if numbers else "True"
            rest = [ast.unparse(argument) for argument in call.args if argument not in numbers[:1]]
            return f"`{ast.unparse(call.func.value)}.{method}({', '.join([*rest, f'{option[1]}={value}'])})`"
    return ""
