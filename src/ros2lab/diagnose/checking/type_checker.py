"""Findings of the type checker in our own words; none if it is not installed."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from dataclasses import replace

from ros2lab.diagnose.checking.call_forms import (
    argument_at,
    as_it_was_meant,
    call_at,
    example_in_place_of,
    passed_on,
    rewritten,
)
from ros2lab.diagnose.checking.checked_copies import checked, first_that_stands
from ros2lab.diagnose.checking.items import refused_items
from ros2lab.diagnose.checking.later_results import of_future
from ros2lab.diagnose.checking.members import in_place_of, without_like
from ros2lab.diagnose.checking.objections import Doubts, objections_of, owner_and_name
from ros2lab.diagnose.checking.of_a_node import of_a_node
from ros2lab.diagnose.checking.operands import as_template, unwrapped
from ros2lab.diagnose.checking.type_words import not_taken, of_class, plain
from ros2lab.diagnose.checking.wrong_owners import of_another_owner, of_callback, of_class_method
from ros2lab.diagnose.code.argument_names import moved_keyword
from ros2lab.diagnose.code.wrong_imports import other_home
from ros2lab.diagnose.finding import SAID, Finding, stops_node
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.unset_attributes import unset
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.calls import missing_imports
from ros2lab.diagnose.sources.python_source import PythonSource, names_bound, own_nodes, parameters
from ros2lab.diagnose.sources.spelling import nearest, snake_case, write_instead
from ros2lab.diagnose.sources.syntax_parts import calls_in, with_arguments


def type_faults(
    look: Look, known: Iterable[Finding], named: Iterable[str] = (), message: str = ""
) -> Iterator[Finding]:
    """Yield what the type checker finds in a workspace's nodes and launch files.

    Args:
        look: the workspace.
        known: the findings so far; a line gets no second finding, unless the first is only passed on.
        named: the places that an error names; there, doubtful types are reported, too.
        message: the error message; of several objections to a line, the one whose types it names is reported.
    """
    lines, known = set(named), [*known]
    unread = {finding.place.partition(":")[0] for finding in known if finding.code.endswith("-syntax")}
    # A fault that does not stop the node is not why a named line failed.
    told = {
        finding.place
        for finding in known
        if stops_node(finding) or (finding.place not in lines and finding.code != SAID)
    }
    objections = objections_of(look, message)
    doubts = Doubts(look, known, objections)
    for objection in objections:
        if objection.place in told or objection.shown in unread or doubts.is_of_another_rule(objection):
            continue
        if objection.place in lines or doubts.is_certain(objection):
            told.add(objection.place)
            yield _finding(objection.row, objection.groups, Spot(objection.read(), objection.line), look)


def _finding(row: re.Match[str], said: dict[str, str], spot: Spot, look: Look) -> Finding:
    rule = row["rule"]
    owner, name = owner_and_name(said)
    assert spot.source is not None
    place = spot.source.at(spot.line)
    said["whole"] = row["said"]
    if found := _of_no_call(rule, name, said, spot, look):
        return found
    call = call_at(spot, int(row["column"]) - 1, rule)
    short = owner.rpartition(".")[2]
    at_fault = argument_at(call, spot.line, int(row["column"]) - 1) if call else None
    item, is_odd = None, False
    if call and at_fault:
        if rule == "invalid-argument-type":
            item, is_odd = refused_items(spot, at_fault, short, row["said"])
        if item and item.code == "made-wrong":  # the other items show how
            return replace(item, code="argument-type")
        said["value"] = _as_given(call, at_fault)
    code, cause, fix = _of_call(rule, short, name, said)
    if call is None or short == "object":
        return Finding(code, cause, place, fix)
    told = _of_known(rule, name, cause, call, spot=spot, look=look)
    if told:
        return Finding(code, told[0], place, told[1])
    if rule == "unknown-argument":
        fix = _nearer(name, call) or fix
    elif rule == "missing-argument":
        fix = _to_add(short, name.split(", "), spot)
    made = ast.unparse(call.func)
    own = {node.name for node in spot.source.nodes if isinstance(node, ast.ClassDef)}
    if code == "argument-missing" and made in own and made != short:
        cause, fix = _without_constructor(made, short, name)
    is_short = rule == "invalid-argument-type" and _lacks_one(spot.source, call)
    if is_short:
        code = "argument-missing"
        cause = f"{short} is called with one argument too few, so its arguments are in the wrong places."
    tried = "" if is_odd else _tried(spot.source, call, at_fault, said, row, is_short=is_short)
    return item if item and not tried else Finding(code, cause, place, tried or fix)


def _of_no_call(rule: str, name: str, said: dict[str, str], spot: Spot, look: Look) -> Finding | None:
    """Return a finding that is not about the arguments of a call; None if it is about those."""
    if rule in _OF_VALUES:
        return _of_member(rule, said, spot, look)
    if rule == "invalid-exception-caught":
        cause = f"{name} is no exception, so this `except` itself fails as soon as an error comes to it."
        fix = f"write Exception, or the error that is meant, instead of {name}"
        return Finding("argument-type", cause, spot.place, fix)
    if (rule == "missing-argument" and name == "self") or said.get("given", "").startswith("<class "):
        return Finding("argument-missing", *of_class(said, spot))
    return None


def _as_given(call: ast.Call, value: ast.expr) -> str:
    """Return an argument of a call as it is written, with its keyword if it has one."""
    named = (keyword for keyword in call.keywords if keyword.arg and keyword.value is value)
    return ast.unparse(next(named, value))


def _nearer(name: str, call: ast.Call) -> str:
    """Return which keyword of a call a name is to be written as; empty if none is near."""
    given = [keyword.arg for keyword in call.keywords]
    near = nearest(name, {*given} - {name})
    return write_instead(near, name, given) if near else ""


def _of_known(
    rule: str, name: str, cause: str, call: ast.Call, *, spot: Spot, look: Look
) -> tuple[str, str] | None:
    """Return cause and fix of a call of a callback, of a method on its class, or with a keyword of another call."""
    if rule == "missing-argument":
        return of_callback(call, name.replace(", ", " and "), spot, look) or of_class_method(call, spot)
    if rule == "unknown-argument" and spot.source and (moved := moved_keyword(spot.source, call, name)):
        return f"{cause} It is one of {moved[0]}().", moved[1]
    return None


def _tried(
    source: PythonSource,
    call: ast.Call,
    at_fault: ast.expr | None,
    said: dict[str, str],
    row: re.Match[str],
    *,
    is_short: bool,
) -> str:
    """Return what to write instead of a call, of what the type checker accepts; empty if it accepts nothing that is known."""
    ways = {**as_it_was_meant(source, call), **rewritten(call, row["rule"], said)}
    first, others = dict[str, str](), dict[str, str]()
    if at_fault and "wanted" in said:
        example = example_in_place_of(at_fault, said["wanted"])
        first = passed_on(source, call, at_fault, example)
        text = with_arguments(call, {id(at_fault): example}) if example.strip("'") else ""
        others = {text: f"write `{text}`"} if text else {}
    good = first_that_stands(source, call, [*first, *ways, *others])
    good = good or first_that_stands(source, call, [*first, *others], settled=row["said"])
    ways |= first | others
    if is_short:
        good = good or first_that_stands(source, call, list(ways), are_items_open=True)
    lines = missing_imports(source, good)
    more = f", with `{'; '.join(lines)}` at the top" if lines else ""
    return f"{ways[good]}{more}" if good else ""


def _to_add(short: str, names: list[str], spot: Spot) -> str:
    """Say which arguments to add to a call: variables of the same names, if there are any."""
    source, function = spot.source, spot.function
    assert source is not None
    own = own_nodes(function) if function else ()
    given = [parameter.arg for parameter in parameters(function)] if function else []
    known = {*names_bound((*own, *own_nodes(source.tree))), *given}
    is_method = given[:1] == ["self"]
    own_name = {name: f"self.{name}" for name in names if is_method and f"self.{name}" in source.stored}
    found = [name if name in known else own_name.get(name, "") for name in names]
    if all(found):
        return f"add {' and '.join(found)} in the parentheses of {short}(...)"
    lacking = [name for name, there in zip(names, found, strict=True) if not there]
    what = f"a value for {' and one for '.join(names)}"
    return f"add {what} in the parentheses of {short}(...): nothing here is called {' or '.join(lacking)}"


def _without_constructor(made: str, base: str, name: str) -> tuple[str, str]:
    """Return cause and fix of a class without a constructor that is called without what its base class needs."""
    cause = f"{made} has no __init__ of its own, so {made}() takes the same arguments as {base}(), but is called without {name}."
    example = f"'{snake_case(made)}'" if name == "node_name" else f"{name}=..."
    fix = f"write `{made}({example})`, or give {made} an __init__ that calls super().__init__({example})"
    return cause, fix


def _lacks_one(source: PythonSource, call: ast.Call) -> bool:
    """Return whether the type checker says that a call lacks an argument."""
    (rows,) = checked(source, [source.text.encode()])
    ends = range(call.lineno, (call.end_lineno or call.lineno) + 1)
    return any(row.rule == "missing-argument" and row.line in ends for row in rows)


def _of_member(rule: str, said: dict[str, str], spot: Spot, look: Look) -> Finding:
    """Return the finding of a member or an operation that a value lacks, with what was meant."""
    assert spot.source is not None
    owner, name = owner_and_name(said)
    code, cause, fix = _of_value(rule, said, spot, look)
    told = None
    if rule == "missing-attribute":
        told = of_a_node(name, spot) if owner == "rclpy" else of_future(owner, name, spot, look)
        told = told or of_another_owner(owner, name, spot)
    if told:
        cause, fix = told
    elif said.get("name") and said.get("given"):
        fix = unwrapped(spot, [said["owner"], said["given"]], said["name"]) or fix
    return Finding(code, cause, spot.source.at(spot.line), fix)


def _imported(owner: str, meant: str, spot: Spot) -> str:
    """Say which import a member needs if it is a submodule; empty if it needs none."""
    module = f"{owner}.{meant}"
    known = spot.source.imports if spot.source else ()
    needs = interfaces.is_module(module) and all(
        not f"{imported.target}.".startswith(f"{module}.") for imported in known
    )
    return f", with `import {module}` at the top" if needs else ""


# Rules about what a value lacks or cannot do; the other rules are about the arguments of a call.
_OF_VALUES = frozenset(
    ("missing-union-attribute", "missing-attribute", "not-callable", "unsupported-operator")
)


def _of_value(rule: str, said: dict[str, str], spot: Spot, look: Look) -> tuple[str, str, str]:
    """Return code, cause and fix of a member or an operation that a value lacks."""
    owner, name = owner_and_name(said)
    if rule == "missing-union-attribute":
        fix = (
            f"write `if ... is not None:` above this line, with the object before .{name}, or set it earlier"
        )
        return "value-none", f"The object before .{name} is still None when this runs.", fix
    if rule == "missing-attribute":
        if method := re.match(r"bound method (?:[\w@]+\.)?(\w+)", owner):
            cause = f"{method[1]} is a method and has no {name}: the parentheses that call it are missing."
            return "attribute-missing", cause, f"write {method[1]}() instead of {method[1]}"
        return "attribute-missing", *_no_attribute(owner, name, spot, look, said["whole"])
    if rule == "not-callable":
        if module := re.fullmatch(r"<module '([\w.]+)'>", owner):
            return rule, *_of_module_called(module[1], spot)
        fix = "remove the parentheses; or, if a method was meant, give the attribute a different name from the method"
        return rule, f"What comes before the parentheses is {plain(owner)}, not a function.", fix
    return "operand-type", *_of_operator(name, said, spot)


def _of_module_called(module: str, spot: Spot) -> tuple[str, str]:
    """Return cause and fix of a module that is called, perhaps instead of the function of that name in it."""
    assert spot.source is not None
    call = next((call for call in calls_in(spot.nodes) if spot.source.resolve(call.func) == module), None)
    text = ast.unparse(call.func) if call else module
    inner = f"{text}.{module.rpartition('.')[2]}"
    way = ast.unparse(call).replace(text, inner, 1) if call else ""
    fix = f"write {text}.NAME(...), with the name of the function in {module} that is meant"
    if call and first_that_stands(spot.source, call, [way]):
        fix = f"write {inner}(...) instead of {text}(...)"
    return f"{text} is a module here, and only the functions in it can be called.", fix


def _of_operator(name: str, said: dict[str, str], spot: Spot) -> tuple[str, str]:
    """Return cause and fix of an operator that cannot join two values."""
    left, right = (plain(said[key] or said["both"]) for key in ("owner", "given"))
    if call := as_template(spot):
        cause = f"{call.partition('(')[0]} is called as in C++, but in Python `<` and `>` only compare."
        return cause, f"write `{call}`"
    is_text = "string" in left + right
    fix = (
        "write str(...) around what is not a string, or an f-string"
        if is_text
        else "convert both to the same type"
    )
    return f"`{name}` cannot join {left} and {right}.", fix


def _of_call(rule: str, short: str, name: str, said: dict[str, str]) -> tuple[str, str, str]:
    """Return code, cause and fix of wrong arguments; the fix is general, for functions that are not known."""
    if short == "object":
        cause = "super().__init__() takes no arguments here, because the class has no base class."
        fix = "write the base class in parentheses after the class name, such as (Node)"
        return "argument-unknown", cause, fix
    if rule == "missing-argument":
        fix = f"add {name} in the parentheses of {short}(...)"
        return "argument-missing", f"{short} is called without {name}.", fix
    if rule == "unknown-argument":
        fix = f"fix the spelling of {name}, or remove it"
        return "argument-unknown", f"{short} has no argument called {name}.", fix
    if rule == "too-many-positional-arguments":
        is_method = "method" in said["what"] or said["owner"].endswith("__init__")
        takes, given = int(said["takes"]) - is_method, int(said["got"]) - is_method
        cause = f"{short} is called with {given} positional argument{'s' * (given != 1)} but takes {takes or 'none'}."
        fix = "remove the extra arguments, or pass them as keyword arguments, as in name=value"
        return "argument-unknown", cause, fix
    return "argument-type", *not_taken(short, said.get("value", ""), said["wanted"], said["given"])


def _no_attribute(owner: str, name: str, spot: Spot, look: Look, said: str) -> tuple[str, str]:
    cause = f"{plain(owner)} has no {name}."
    if elsewhere := _of_another_module(owner, name, spot):
        return elsewhere
    if close := in_place_of(name, owner, spot, look, said):
        if not close.isidentifier():
            return cause, f"write {close}"
        fix = f"write {close} instead of {name}{_imported(owner, close, spot)}"
        return f"{cause} Did you mean {close}?", fix
    if owner.startswith("Self@"):
        around = spot.source.class_at(spot.line) if spot.source else None
        if spot.source and around and (told := unset(spot.source, around, name)):
            return told
        cause = f"self.{name} is used here, but nothing in the class sets it."
        return cause, f"write self.{name} = ... in __init__, with its initial value"
    return without_like(name, owner, plain(owner), look, spot)


def _of_another_module(owner: str, name: str, spot: Spot) -> tuple[str, str] | None:
    """Return cause and fix of a name that one module is asked for and another has, as for an import of it."""
    source = spot.source if interfaces.is_module(owner) else None
    home = other_home(owner, name, source) if source else ""
    if not source or not home:
        return None
    whole = next((ast.unparse(n) for n in spot.nodes if getattr(n, "attr", "") == name), f"{owner}.{name}")
    known = [imported for imported in source.imports if not imported.is_from and imported.target == home]
    more = "" if known else f", with `import {home}` at the top"
    local = known[0].local if known and known[0].local != home.partition(".")[0] else home
    return f"{name} is not in {owner}; it is in {home}.", f"write {local}.{name} instead of {whole}{more}"
