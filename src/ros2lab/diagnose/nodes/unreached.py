"""Methods that only they themselves would have called: what registers them is never reached."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from functools import lru_cache

from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.sources.interfaces import members_of, node_members
from ros2lab.diagnose.sources.made_unseen import may_run
from ros2lab.diagnose.sources.node_source import Creation, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, own_nodes, walk
from ros2lab.diagnose.sources.syntax_parts import own_parameters
from ros2lab.diagnose.sources.uses import named


@lru_cache(maxsize=16)
def unreached(sources: NodeSources) -> Mapping[int, tuple[NodeClass, Function]]:
    """Return the methods of nodes, by `id`, that no other code names: only they themselves and each other do."""
    inherited = node_members() | members_of("rclpy.lifecycle", "LifecycleNode")
    alone = {
        id(method): (owner, method)
        for owner in sources.nodes
        if _is_seen_whole(sources, owner)
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
    elsewhere = _named_beyond(sources) if alone else frozenset()
    by: dict[int, set[int]] = {}
    for key, (owner, method) in alone.items():
        files = sources.together(owner.source.name)
        by[key] = {user for file in files for user in naming[file].get(method.name, ())}
        by[key] |= {0} if method.name in elsewhere else set()
    while reached := [key for key in alone if not by[key] <= alone.keys()]:
        for key in reached:
            del alone[key]
    return alone


def _is_seen_whole(sources: NodeSources, owner: NodeClass) -> bool:
    """Return whether only the package's own files decide which methods of a node are called."""
    families = (sources.lineage(other) for other in sources.classes.values() if other is not owner)
    is_base = any(owner in chain for chain, *_ in families)
    return (
        sources.lineage(owner)[2]
        and len(sources.lineage(owner)[0]) == 1
        and not is_base
        and not sources.is_managed(owner)
        and may_run(sources, owner.source, owner)
    )


def _named_beyond(sources: NodeSources) -> frozenset[str]:
    """Return the names that the files of other packages read which import something of these files."""
    own = {name.partition(".")[0] for name in sources.sources}
    files = (file for name, file in sources.beyond.modules.items() if name not in sources.sources)
    using = (f for f in files if any(i.target.partition(".")[0] in own for i in f.imports))
    return frozenset(name for file in using for node in file.nodes for name in named(node))


def unreached_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield what would register callbacks, in methods that are called by nothing or by these callbacks alone."""
    alone = unreached(sources)
    for owner in sources.nodes if alone else ():
        own = {key for key, (home, _) in alone.items() if home is owner}
        registered = [
            (creation, alone[key][1])
            for creation in sources.creations
            if id(creation.function) in own and (given := creation.given("callback"))
            for key in own
            if alone[key][1].name in {name for node in walk(given) for name in named(node)}
        ]
        if registered and "__init__" in owner.methods:
            yield _never_begun(owner, registered, [alone[key][1] for key in sorted(own)])


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
    number = f"line{'s' * (len(lines) > 1)} {in_a_row([*map(str, lines)])}"
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
