"""Methods that only they themselves would have called: what registers them is never reached."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from functools import lru_cache

from ros2lab.diagnose.finding import Finding, in_a_row, these_lines
from ros2lab.diagnose.sources.construction import looks_up, may_run
from ros2lab.diagnose.sources.interfaces import members_of, node_members
from ros2lab.diagnose.sources.node_source import Creation, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, last_name, own_nodes, walk
from ros2lab.diagnose.sources.syntax_parts import own_parameters
from ros2lab.diagnose.sources.uses import named


@lru_cache(maxsize=16)
def unreached(sources: NodeSources) -> Mapping[int, tuple[NodeClass, Function]]:
    """Return the methods of nodes, by `id`, that no other code names: only they themselves and each other do."""
    inherited = node_members() | members_of("rclpy.lifecycle", "LifecycleNode")
    alone = {
        id(method): (owner, method)
        for owner in sources.nodes
        if is_seen_whole(sources, owner) and len(sources.lineage(owner)[0]) == 1
        for name, method in owner.methods.items()
        if not name.startswith("__") and name not in inherited and not method.decorator_list
    }
    inside = {id(node): key for key, (_, method) in alone.items() for node in walk(method)}
    naming: dict[
        str, dict[str, set[int]]
    ] = {}  # by file and name: the methods that name it, 0 for other code
    for source in sources.sources.values() if alone else ():
        here = naming.setdefault(source.name, {})
        for node in source.nodes:
            for name in named(node):
                here.setdefault(name, set()).add(inside.get(id(node), 0))
    by: dict[int, set[int]] = {}
    for key, (owner, method) in alone.items():
        files = sources.together(owner.source.name)
        by[key] = {user for file in files for user in naming[file].get(method.name, ())}
    while reached := [key for key in alone if not by[key] <= alone.keys()]:
        for key in reached:
            del alone[key]
    return alone


def is_seen_whole(sources: NodeSources, owner: NodeClass) -> bool:
    """Return whether a node may run, and no base, subclass or user elsewhere decides which of its methods are called."""
    files = (sources.sources[name] for name in sources.together(owner.source.name))
    is_own = sources.lineage(owner)[2] and not sources.is_managed(owner)
    is_own &= not any(looks_up(node) for source in files for node in source.nodes)
    return is_own and may_run(sources, owner.source, owner) and not _is_for_others(sources, owner)


def _is_for_others(sources: NodeSources, owner: NodeClass) -> bool:
    """Return whether a class is there to be used: by a subclass, by another package, or with no program of its own.

    Subclasses and users are known by its name, because their import may be the fault.
    """
    module, name = owner.source.name, owner.definition.name
    files = {**sources.beyond.modules, **sources.sources}.values()
    bases = (base for file in files for definition in file.classes.values() for base in definition.bases)
    own = sources.sources if f"{module}.main" in sources.functions else {module}
    targets = (i.target for file in files if file.name not in own for i in file.imports)
    return name in map(last_name, bases) or any(
        target.endswith(f".{name}") or f"{target}.".startswith(f"{module}.") for target in targets
    )


def unreached_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield what would register callbacks, in methods that are called by nothing or by these callbacks alone."""
    alone = unreached(sources)
    for owner in sources.nodes if alone else ():
        own = [key for key, (home, _) in alone.items() if home is owner]
        registered = [
            (creation, alone[key][1])
            for creation in sources.creations
            if id(creation.function) in own and (given := creation.given("callback"))
            for key in own
            if alone[key][1].name in {name for node in walk(given) for name in named(node)}
        ]
        if registered and "__init__" in owner.methods:
            yield _never_begun(owner, registered, [alone[key][1] for key in own])


def _never_begun(
    owner: NodeClass, registered: list[tuple[Creation, Function]], methods: list[Function]
) -> Finding:
    functions = sorted({id(function): function for _, function in registered}.values(), key=_line)
    callbacks = [function.name for function in functions]
    makers = [*dict.fromkeys(creation.function.name for creation, _ in registered if creation.function)]
    lines = [creation.call.lineno for creation, _ in registered]
    what = in_a_row([*dict.fromkeys(creation.method.removeprefix("create_") for creation, _ in registered)])
    shown = in_a_row([f"{name}()" for name in callbacks])
    place = owner.source.at(lines[0])
    never = tuple(owner.source.at(method) for method in methods if method.name in callbacks)
    begins = [method for method in methods if method.name in makers and method.name not in callbacks]
    if begins:
        first = begins[0].name
        cause = f"Nothing calls {first}(), which makes the {what}, so {shown} never {'runs' if len(callbacks) == 1 else 'run'} either."
        given = own_parameters(begins[0])
        fix = f"write `self.{first}({', '.join(p.arg for p in given)})` at the end of __init__"
        return Finding("never-called", cause, owner.source.at(begins[0]), fix, never=never)
    inside = in_a_row([f"{name}()" for name in makers])
    itself = " itself" if makers == callbacks and len(makers) == 1 else ""
    number = these_lines(lines)
    cause = f"Nothing ever calls {shown}: the {what} that would call it is made inside {inside}{itself} ({number})."
    if len(registered) > 1:
        cause = f"Nothing ever calls {shown}: only {inside} would register them ({number})."
    fix = f"move {number} to the end of __init__"
    if any(_uses_locals(creation) for creation, _ in registered):
        fix = f"make the {what} in __init__"
    return Finding("never-called", cause, place, fix, never=never)


def _line(function: Function) -> int:
    return function.lineno


def _uses_locals(creation: Creation) -> bool:
    """Return whether a call uses what only its own function knows."""
    function = creation.function
    bound = {
        n.id
        for n in (own_nodes(function) if function else ())
        if isinstance(n, ast.Name) and not isinstance(n.ctx, ast.Load)
    }
    bound |= {parameter.arg for parameter in own_parameters(function)} if function else set()
    is_kept = any(is_self_attribute(node) for node in walk(creation.call))
    return not is_kept or any(isinstance(n, ast.Name) and n.id in bound for n in walk(creation.call))
