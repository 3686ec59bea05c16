"""Names with two leading underscores, which are private to the class they are written in."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, walk
from ros2lab.diagnose.sources.uses import free_name


def private_name_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield private names of a base class that a class derived from it uses as if they were its own."""
    for owner in sources.classes.values():
        for base in sources.lineage(owner)[0]:
            if base is not owner and base.definition.name.lstrip("_") != owner.definition.name.lstrip("_"):
                yield from _taken_for_own(owner, base)


def _taken_for_own(owner: NodeClass, base: NodeClass) -> Iterator[Finding]:
    """Yield private names that a class reads but only its base sets, or sets but only its base reads."""
    of_base, of_owner = _Private(base), _Private(owner)
    for name, node in sorted(of_owner.read.items()):
        if name in of_base.made and name not in of_owner.made:
            yield _finding(owner, base, name, node, f"{base.definition.name} makes a different one")
    for name, node in sorted(of_owner.made.items()):
        if name not in of_owner.read and name in of_base.read and name in of_base.made:
            yield _finding(owner, base, name, node, f"{base.definition.name} keeps using its own")


def of_another(sources: NodeSources, owner: NodeClass, asked: str, node: ast.Attribute) -> Finding | None:
    """Explain a private name in a class that an object has only by another class, its base or its own; else None."""
    named = [other for other in sources.classes.values() if other.definition.name == asked]
    for other in (*sources.lineage(owner)[0], *named):
        if other is not owner and node.attr in _Private(other).made:
            return _finding(owner, other, node.attr, node, f"{other.definition.name} makes a different one")
    return None


def _finding(owner: NodeClass, base: NodeClass, name: str, node: ast.AST, then: str) -> Finding:
    short = owner.definition.name
    cause = f"A name that begins with two underscores is private to the class it is written in: in {short}, {name} means _{short.lstrip('_')}{name}, and {then}, _{base.definition.name.lstrip('_')}{name}."
    files = " and in ".join(dict.fromkeys((owner.source.shown, base.source.shown)))
    fix = f"write {free_name(base, name[1:])} instead of {name} everywhere in {files}"
    return Finding("private-name", cause, owner.source.at(node), fix)


class _Private:
    """The private names that a class sets and reads."""

    def __init__(self, owner: NodeClass) -> None:
        self.made: dict[str, ast.AST] = {}
        self.read: dict[str, ast.AST] = {}
        for function in owner.definition.body:
            if isinstance(function, Function) and _is_private(function.name):
                self.made[function.name] = function
        for node in walk(owner.definition):
            match node:
                case ast.Attribute(attr=name) if is_self_attribute(node) and _is_private(name):
                    where = self.read if isinstance(node.ctx, ast.Load) else self.made
                    where.setdefault(name, node)
                case ast.Name(id=name, ctx=ast.Store()) if _is_private(name):
                    self.made.setdefault(name, node)
                case ast.AugAssign(target=ast.Attribute(attr=name) as target) if _is_private(name):
                    if is_self_attribute(target):
                        self.read.setdefault(name, target)


def _is_private(name: str) -> bool:
    return re.fullmatch(r"__\w*[A-Za-z0-9]_?", name) is not None
