"""Explains an error by its message alone, if nothing in the sources explains it."""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from ros2lab.diagnose.causes.init_order import shut_by
from ros2lab.diagnose.causes.python_says import of_error, of_function
from ros2lab.diagnose.causes.refused_value import published
from ros2lab.diagnose.causes.undeclared_arguments import default_of
from ros2lab.diagnose.checking.later_results import of_future
from ros2lab.diagnose.checking.members import in_place_of, without_like
from ros2lab.diagnose.code.bound_names import global_names
from ros2lab.diagnose.code.meant_names import meant, used_too_early
from ros2lab.diagnose.code.syntax_repairs import explained
from ros2lab.diagnose.explaining.meaning import Meaning
from ros2lab.diagnose.explaining.not_found import below_folders, no_module, wrong_import
from ros2lab.diagnose.explaining.not_set import as_written, not_set
from ros2lab.diagnose.explaining.typed_settings import substituted
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.message_faults import filling, set_field
from ros2lab.diagnose.nodes.parameter_faults import of_parameter_file
from ros2lab.diagnose.nodes.parameter_values import (
    given_at,
    retyped,
    type_in_words,
    value_in_words,
)
from ros2lab.diagnose.printed.error_text import ErrorReport, ErrorText, own_frames
from ros2lab.diagnose.printed.spots import Spot, is_setup, place_of, spot_at
from ros2lab.diagnose.sources.bindings import Import
from ros2lab.diagnose.sources.interfaces import homes_of, is_module, launch_homes_of


def said_of(
    meaning: Meaning, groups: Mapping[str, str], line: str, error: ErrorText, look: Look
) -> list[Finding]:
    """Explain an error by its message alone; empty if that says nothing."""
    place = place_of(own_frames(error.frames), look)
    told = None
    if meaning.codes[0] == "parameter-file-syntax":
        told = of_parameter_file(error.text, look)
    elif meaning.codes[0] == "import-wrong":
        told = wrong_import(spot_at(place, look), groups, look)
    elif meaning.codes[0] == "entry-point-module":
        told = below_folders(spot := spot_at(place, look), look) or wrong_import(spot, groups, look)
        told = told or no_module(groups["name"].removesuffix(".py").replace("/", "."), place, look)
    if told or meaning.cause:
        return [told or _in_words(meaning, groups, place, error, look)]
    report = error.report or ErrorReport("", "")
    near = "".join(re.findall(r"Did you mean: '(.+?)'", line)[:1])
    if report.kind in ("SyntaxError", "IndentationError", "TabError"):
        return [_of_syntax(report, look)]
    if report.kind == "NameError":
        homes_in = launch_homes_of if "Caught exception in launch" in error.text else homes_of
        homes = homes_in(groups.get("name", ""))
        return [_no_name(groups.get("name", ""), near, spot_at(place, look), place, homes)]
    if report.kind == "AttributeError" and "name" in groups:
        return [_no_attribute(groups, near, place, look)]
    return []


def _in_words(
    meaning: Meaning, groups: Mapping[str, str], place: str, error: ErrorText, look: Look
) -> Finding:
    """Return the finding of a meaning, with the names in the message filled in."""
    code, shown = meaning.codes[0], groups
    if code == "parameter-type" and groups.get("name"):
        shown = {
            **groups,
            "wanted": type_in_words(groups["wanted"]),
            "value": value_in_words(groups["value"], groups["kind"]),
        }
    cause = (
        shut_by(spot_at(place, look), error) if code == "shutdown-twice" else ""
    ) or meaning.cause.format(**shown).replace(" ()", "")
    if code == "launch-argument":
        default = default_of(groups["name"], look)
        groups = {**groups, "default": groups["name"] if default is None else default}
    do = meaning.fix.format(**groups) if isinstance(meaning.fix, str) else meaning.fix(**groups)
    if code == "parameter-type" and groups.get("name"):
        return _of_value(Finding(code, cause, place, do), groups, error, look)
    if code == "publish-text" and groups.get("given") and (sent := published(spot_at(place, look))):
        do = filling(f"{groups['package']}.msg.{groups['wanted']}", sent[0], groups["given"])
    elif "what" in groups and "name" in groups:
        do = _field_fix(spot_at(place, look), groups) or do
    return Finding(code, cause, place or meaning.place, do)


def _of_value(said: Finding, groups: Mapping[str, str], error: ErrorText, look: Look) -> Finding:
    """Return the finding of a parameter of another type where its value was given, with how to write it."""
    name, value, wanted = (groups[key] for key in ("name", "value", "wanted"))
    if fix := retyped(name, value, wanted, error.typed):
        return replace(said, place="", fix=fix)
    is_declared = wanted == "INTEGER" and not value.lstrip("-").isdigit()
    place = said.place if is_declared else given_at(name, look, error.typed) or said.place
    # What is written there may be mere text, and no value at all.
    unread = (f for f in look.findings if f.code == "launch-unused" and f.place == place)
    fix = substituted(name, value, wanted, spot_at(place, look)) or said.fix
    return next(unread, None) or replace(said, place=place, fix=fix)


def _of_syntax(report: ErrorReport, look: Look) -> Finding:
    place = place_of([*reversed(report.frames)], look)
    code = "setup-syntax" if is_setup(place) else "node-syntax"
    source = spot_at(place, look).source
    found = source.fault if source and source.tree else None
    fault = found or getattr(builtins, report.kind)(report.message)
    return explained(code, "Python cannot read the file", place, fault, source if found else None)


def _no_name(name: str, near: str, spot: Spot, place: str, homes: Sequence[str]) -> Finding:
    code = "setup-import" if is_setup(place) else "name-missing"
    used = (node for node in spot.nodes if isinstance(node, ast.Name) and node.id == name)
    if spot.source and (node := next(used, None)):
        # The name is bound somewhere, but not yet when this line runs, or the file is not part of a package.
        is_bound = name in global_names(spot.source)
        told = used_too_early(spot.source, name, node) if is_bound else meant(spot.source, name, node)
        if told:
            return Finding(code, told[0], place, told[1])
        near = "" if is_bound else near
    do = f"write {near}" if near else f"import {name} or define it above, or fix its spelling"
    do = f"write `from {homes[0]} import {name}` at the top" if homes else do
    return Finding(code, f"{name} is used before it is imported or defined.", place, do)


def _field_fix(spot: Spot, groups: Mapping[str, str]) -> str:
    """Say how to set a message field to the value on a line; empty if the line does not set it."""
    wanted = None if "sequence" in groups["what"] else re.search(r"type '(\w+)'", groups["what"])
    home = (homes_of(wanted[1]) if wanted and wanted[1][:1].isupper() else ()) or ("",)
    for node in spot.nodes:
        target = node.targets[0] if isinstance(node, ast.Assign) else None
        kind = f"{home[0]}.{wanted[1]}".lstrip(".") if wanted else ""
        if kind and isinstance(target, ast.Attribute) and target.attr == groups["name"]:
            return set_field(target, kind, node.value)  # type: ignore[attr-defined]
        elements = getattr(target, "elts", ())
        fields = [element for element in elements if getattr(element, "attr", "") == groups["name"]]
        if kind and fields:
            new = set_field(fields[0], kind, ast.Constant(0)).partition(" = ")[0]
            return f"{new} instead of {ast.unparse(fields[0])}, and likewise for what it is combined with"
    return ""


def _made_up(owner: str, place: str, spot: Spot) -> Finding | None:
    """Explain that `getattr` finds nothing by a name that the line computes; None if the line does not do that."""
    for call in (node for node in spot.whole if isinstance(node, ast.Call)):
        match call:
            case ast.Call(func=ast.Name("getattr"), args=[asked, name]) if not isinstance(name, ast.Constant):
                cause = f"getattr looks in {owner} for what `{ast.unparse(name)}` names, and {owner} has nothing of that name."
                new = f"getattr({ast.unparse(asked)}, {ast.unparse(name)}, None)"
                fix = f"write `{new}`, and go on only if that is not None"
                return Finding("attribute-unknown", cause, place, fix)
    return None


def _no_attribute(groups: Mapping[str, str], near: str, place: str, look: Look) -> Finding:
    name, owner = groups["name"], groups.get("owner") or groups.get("module") or "the object before the dot"
    homes = homes_of(name) if groups.get("module") else ()
    if owner == "NoneType":
        spot = spot_at(place, look)
        message = f"'NoneType' object has no attribute '{name}'"
        return of_error("AttributeError", message, place, spot) or Finding(
            "attribute-unknown", message, place
        )
    if groups.get("module") and (inner := _submodule(owner, name, spot_at(place, look), look)):
        above = max((imported.line for imported in _imports(owner, spot_at(place, look))), default=0)
        where = f"below line {above}" if above else "at the top"
        cause = f"{owner}.{name} is a module of its own: `import {owner}` alone does not import it."
        return Finding("import-wrong", cause, place, f"write `import {inner}` {where}")
    if homes:
        fix = f"write `from {homes[0]} import {name}` at the top, and {name} here"
        return Finding("import-wrong", f"{owner} itself has no {name}: it is in {homes[0]}.", place, fix)
    if owner in ("function", "method", "builtin_function_or_method"):
        return of_function(name, place, spot_at(place, look))
    spot = spot_at(place, look)
    name = as_written(name, spot)
    later = of_future(owner, name, spot, look)
    told = (
        Finding("attribute-missing", later[0], place, later[1]) if later else not_set(name, owner, spot, look)
    )
    if not told and spot.source and not re.search(rf"\b{name}\b", spot.source.text):
        fix = "compare what this line passes with what the function that it calls takes"
        asks = Finding("attribute-unknown", f"What this line calls asks {owner} for {name}.", place, fix)
        told = _made_up(owner, place, spot) or asks
    if told:
        return told
    near = (near if not near.startswith("_") else "") or in_place_of(name, owner, spot, look)
    cause, fix = without_like(name, owner, owner, look, spot)
    if near:
        cause, fix = f"{owner} has no {name}.", f"write {near}"
    return Finding("attribute-unknown", cause, place, fix, (owner,))


def _submodule(owner: str, name: str, spot: Spot, look: Look) -> str:
    """Return the submodule that a line uses and that its file does not import; empty if there is none.

    It may be nested more deeply than the missing attribute, as in `xml.etree.ElementTree`.
    """
    imports = spot.file.imports
    is_hidden = spot.source and spot.source.path and spot.source.path.with_name(f"{owner}.py").is_file()
    if is_hidden or any(f"{imported.target}.".startswith(f"{owner}.{name}.") for imported in imports):
        return ""
    own = {module for package in look.packages for module in package.sources}
    named = {imported.local: owner for imported in _imports(owner, spot)}
    asked = [ast.unparse(node).split(".") for node in spot.nodes if isinstance(node, ast.Attribute)]
    written = [".".join([named.get(first, first), *rest]) for first, *rest in asked]
    inner = {f"{owner}.{name}", *(module for module in written if module.startswith(f"{owner}.{name}."))}
    return max((module for module in inner if module in own or is_module(module)), key=len, default="")


def _imports(owner: str, spot: Spot) -> list[Import]:
    """Return the imports of a package in the file of a line, under any name."""
    return [imported for imported in spot.file.imports if owner in (imported.local, imported.target)]
