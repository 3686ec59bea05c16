"""Attributes that Python does not find although a class sets them: under a private name, or on a line that has not run."""

from __future__ import annotations

import ast

from ros2lab.diagnose.code.private_names import of_another
from ros2lab.diagnose.finding import Finding, these_lines
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.node_source import is_self_attribute
from ros2lab.diagnose.sources.python_source import walk


def as_written(name: str, spot: Spot) -> str:
    """Return an attribute as the class around a line writes it: `__x` for the `_Robot__x` of a message."""
    around = spot.file.class_at(spot.line)
    private = name.removeprefix(f"_{around.name.lstrip('_')}") if around else name
    return private if private.startswith("__") else name


def not_set(name: str, asked: str, spot: Spot, look: Look) -> Finding | None:
    """Explain an attribute that the line asks for and that is set, but not for this object, or not yet; else None.

    Args:
        name: the attribute, as it is written.
        asked: the class of the object that lacks it.
        spot: the line.
        look: the workspace.
    """
    around = spot.file.class_at(spot.line)
    uses = [node for node in spot.nodes if isinstance(node, ast.Attribute) and node.attr == name]
    sources = look.sources_with(spot.file)
    owner = next((known for known in sources.classes.values() if known.definition is around), None)
    if owner is None or not uses:
        return None
    if name.startswith("__") and (told := of_another(sources, owner, asked, uses[0])):
        return told
    named = [known for known in sources.classes.values() if known.definition.name == asked]
    is_own = any(owner in sources.lineage(known)[0] for known in named)
    is_asked = is_own and any(map(is_self_attribute, uses))
    return _too_early(owner.definition, name, spot) if is_asked else None


def _too_early(around: ast.ClassDef, name: str, spot: Spot) -> Finding | None:
    """Explain an attribute of self that other lines of its class set; None if none does, or if it is deleted."""
    same = [node for node in walk(around) if is_self_attribute(node) and node.attr == name]
    stored = [node for node in same if isinstance(node.ctx, ast.Store)]
    if not stored or any(isinstance(node.ctx, ast.Del) for node in same):
        return None
    bare = {id(n.target) for n in walk(around) if isinstance(n, ast.AnnAssign) and n.value is None}
    lines = sorted({node.lineno for node in stored if id(node) not in bare} - {spot.line})
    functions = {line: getattr(spot.file.function_at(line), "name", "") for line in lines}
    reader = getattr(spot.function, "name", "")
    where = f", in {functions[lines[0]]}()" if len({*functions.values()}) == 1 else ""
    which = f": what sets it ({these_lines(lines)}{where}) has not run yet for this object" if lines else ""
    cause = f"self.{name} is used here before anything has set it{which}."
    first = next((line for line in lines if functions[line] in ("__init__", reader)), None)
    begun = "above this line" if reader == "__init__" else "in __init__"
    fix = (
        f"make sure that line {first} runs before this line"
        if first
        else f"set self.{name} {begun}, to the value that it has at the beginning"
    )
    return Finding("attribute-missing", cause, spot.place, fix)
