"""Names that are already taken: by another package, a standard module, a member of every node or another program's node."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from shlex import quote

from ros2lab.diagnose.code.bound_names import global_names
from ros2lab.diagnose.finding import Finding, at, in_a_row, these_lines
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.construction import may_run
from ros2lab.diagnose.sources.interfaces import fixed_node_properties, method_of, node_members
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    assignments,
    given_to,
    last_name,
    walk,
)
from ros2lab.diagnose.sources.syntax_parts import calls_in, needed_by
from ros2lab.diagnose.sources.uses import free_name

_VALUES = (ast.Constant, ast.JoinedStr, ast.List, ast.Tuple, ast.Dict, ast.Set, ast.Compare, ast.BinOp)


def taken_packages(packages: Sequence[SourcePackage]) -> Iterator[Finding]:
    """Yield Python packages with the name of one in another package, or of a standard module."""
    yield from hidden_files(packages)
    yield from _same_modules(packages)
    yield from _hides_pythons(packages)


def _same_modules(packages: Sequence[SourcePackage]) -> Iterator[Finding]:
    """Yield Python packages that two packages of the workspace install: only the first in the path counts."""
    first: dict[str, SourcePackage] = {}
    for package in packages:
        for name in dict.fromkeys(module.partition(".")[0] for module in package.packages or ()):
            other = first.setdefault(name, package)
            if other is not package and other.name != package.name:
                cause = f"{other.name} and {package.name} both install a Python package {name}: Python finds only one of them, and the other one's modules are missing."
                fix = f"move {package.shown(name)} into {package.shown(package.name)}, take {name!r} out of packages in setup.py, and import it as {package.name}.{name}; it is best to do so in both"
                place = (
                    at(package.setup.source.shown, package.setup.line("packages")) if package.setup else ""
                )
                yield Finding("name-shadowed", cause, place, fix)


def _hides_pythons(packages: Sequence[SourcePackage]) -> Iterator[Finding]:
    """Yield Python packages with the name of a standard module, which imports then find instead of it."""
    for package in packages:
        for name in sorted(
            {module.partition(".")[0] for module in package.packages or ()}
            & sys.stdlib_module_names - interfaces.PROGRAMS
        ):
            cause = f"The Python package {name} has the same name as a standard-library module; libraries that import that get this one."
            fix = f"rename it, for example to my_{name}: the folder {package.shown(name)}, and every use in setup.py, setup.cfg, package.xml, resource and the imports"
            yield Finding("name-shadowed", cause, package.shown(name), fix)


def hidden_files(packages: Sequence[SourcePackage]) -> Iterator[Finding]:
    """Yield files that something asks for a name, although Python imports a folder of the same name instead."""
    asked = [
        (*imported.target.rpartition("."), source.at(imported.line))
        for package in packages
        for source in package.sources.values()
        for imported in source.imports
    ]
    for package in packages:
        shown = package.setup.source.shown if package.setup else ""
        asked += [(point.module, "", point.function, at(shown, point.line)) for point in package.points]
    for package in packages:
        for module, source in package.sources.items():
            if file := source.hidden:
                there = {name.removeprefix(f"{module}.") for name in package.sources}
                lost = global_names(package.read(file, module)) - global_names(source) - there
                uses = {place: name for home, _, name, place in asked if home == module and name in lost}
                if uses:
                    yield _hidden_file(package, file, module, uses)


def _hidden_file(package: SourcePackage, file: Path, module: str, uses: Mapping[str, str]) -> Finding:
    """Say that Python imports the folder beside a file, and how to give the file another name."""
    old, new = (package.shown(str(file.with_name(name))) for name in (file.name, f"{file.stem}_node.py"))
    name = next(iter(uses.values()))
    cause = f"{file.name} and the folder {file.stem} beside it are both {module} for Python, which imports the folder, and that has no {name}."
    fix = f"mv {quote(old)} {quote(new)}, write {module}_node instead of {module} in {in_a_row([*uses])}, and build again"
    return Finding("name-shadowed", cause, old, fix, (module, *uses.values()))


def hiding_methods(owner: NodeClass, properties: Collection[str]) -> Iterator[tuple[str, Finding]]:
    """Yield the name of each method that hides a member of every node, with the finding."""
    for method in owner.methods.values():
        if method.name in properties and not method.decorator_list:
            why = f"Every node already has `{method.name}`, which this method hides, so choose another name."
        elif least := _demanded_by_node(method):
            why = f"Every node has a method {method.name}, which needs at least {least} argument{'s' * (least != 1)}, and which this one hides."
        else:
            continue
        asked = [c for c in calls_in(walk(owner.definition)) if ast.unparse(c.func) == f"self.{method.name}"]
        own = [c.lineno for c in asked if len(given_to(c)) < len(method.args.args)]
        others = [c.lineno for c in asked if c.lineno not in own]
        also = f"and its call on {these_lines(own)}" if own else "also where it is used"
        also += f", but not on {these_lines(others)}, where the node's own is called" if others else ""
        fix = f"rename it, for example to {free_name(owner, method.name)}, {also}"
        yield method.name, Finding("node-property", why, owner.source.at(method), fix)


def hidden_method(owner: NodeClass, stored: ast.Attribute) -> Finding | None:
    """Say how to rename an attribute that hides a method of the same name, wherever it is meant.

    None where what is assigned may be called, or is a timer or the like and nothing uses the method from then on.
    """
    name, inner = stored.attr, [*walk(owner.definition)]
    own = [n for n in inner if is_self_attribute(n) and n.attr == name]
    made = next((value for target, value in assignments(inner) if target is stored), ast.Constant(None))
    maker = last_name(getattr(made, "func", None)).partition("create_")[2]
    if not (isinstance(made, _VALUES) or maker):
        return None
    # A method is called, or given to what calls it; everything else is the attribute.
    calls = calls_in(inner)
    creating = [call for call in calls if last_name(call.func).startswith("create_")]
    methods = {id(call.func) for call in calls} | {id(given) for call in creating for given in given_to(call)}
    first = [*walk(owner.methods.get("__init__", made))]
    before = [n for n in first if stored in first and getattr(n, "lineno", 0) <= stored.lineno]
    early = {id(n) for n in (*walk(made), *before)}
    if maker and not any(id(n) in methods - early for n in own):
        return None
    lines = sorted({n.lineno for n in own if id(n) not in methods} - {stored.lineno})
    better = free_name(owner, f"{name}_{maker.partition('_')[0] or 'value'}")
    also = f" and on {these_lines(lines)}" if lines else ""
    cause = f"self.{name} is assigned here, which hides the method {name}()."
    fix = f"write self.{better} instead of self.{name} on this line{also}"
    return Finding("callback-missing", cause, owner.source.at(stored), fix)


def taken_attributes(owner: NodeClass) -> dict[str, tuple[str, str]]:
    """Return cause and fix, by name, for attributes that a class sets although every node has them."""
    members, properties = node_members(), fixed_node_properties()
    found: dict[str, tuple[str, str]] = {}
    for node in walk(owner.definition):
        match node:
            case ast.Attribute(attr=name, ctx=ast.Store()) if is_self_attribute(node) and name in properties:
                uses = [
                    n
                    for n in walk(owner.definition)
                    if is_self_attribute(n) and n.attr == name and n is not node
                ]
                lines = sorted({n.lineno for n in uses} - {node.lineno})
                also = f" and on {these_lines(lines)}" if lines else ""
                cause = f"{name} is already a property of every node, and cannot be assigned."
                fix = f"write self.{free_name(owner, name)} instead of self.{name} here{also}"
                found.setdefault(name, (cause, fix))
            case ast.Assign(targets=[ast.Attribute(attr=name) as target], value=value) if is_self_attribute(
                target
            ):
                is_rclpys = name in members and re.match(r"_[a-z]", name)
                if is_rclpys and f".get{name}(" not in ast.unparse(value):
                    cause = f"rclpy itself uses self.{name} in every node, and this overwrites it."
                    found[name] = (
                        cause,
                        f"write self.{free_name(owner, name[1:])} instead, also where it is used",
                    )
    return found


def _demanded_by_node(method: Function) -> int:
    """Return how many arguments Node's method of the same name needs, if this one takes fewer; else 0."""
    of_node = method_of("rclpy.node", "Node", method.name)
    if of_node is None or method.name.startswith("__") or method.decorator_list or method.args.vararg:
        return 0
    least = len(needed_by(of_node))
    return least if len(method.args.args) - 1 < least else 0


def named_alike(sources: NodeSources, alternatives: Collection[frozenset[str]]) -> Iterator[Finding]:
    """Yield node names that are used in two files which executables run; no launch file may start one of the two."""
    first: dict[str, tuple[PythonSource, ast.AST]] = {}
    for source in sources.sources.values():
        for owner, function, node in sources.scoped(source):
            if not isinstance(node, ast.Call) or not sources.makes_node(source, owner, function, node):
                continue
            if not may_run(sources, source, owner):
                continue
            name = sources.value(source, node.args[0] if node.args else None)
            before = first.setdefault(name, (source, node)) if isinstance(name, str) else (source, node)
            stems = [file.name.rpartition(".")[2] for file in (before[0], source)]
            # Interchangeable nodes have neither file's name, or one file adds a word, as in driver_sim.
            is_either = frozenset((before[0].name, source.name)) in alternatives
            if before[0] is not source and name in stems and not _is_variant(*stems) and not is_either:
                # The node whose file has a different name was copied.
                here, place = before if source.name.endswith(f".{name}") else (source, node)
                stem = here.name.rpartition(".")[2]
                cause = f"The nodes in {before[0].shown} and {source.shown} have the same name {name!r}, so if both run, they cannot be told apart."
                fix = f"write another name here, such as {stem if stem != name else f'{stem}_2'!r}"
                yield Finding("name-twice", cause, here.at(place), fix)


def _is_variant(stem: str, other: str) -> bool:
    """Return whether one name has all the words of the other and at least one more."""
    words, others = (set(re.findall("[A-Za-z]+", name)) for name in (stem, other))
    return words < others or others < words
