"""Names that a file imports twice from different modules, and uses as the first one, which is replaced."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.finding import Finding, these_lines
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.bindings import Import
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.signatures import signature_by_name

_TYPES = {"msg_type": ".msg.", "srv_type": ".srv."}


def bound_twice(sources: NodeSources) -> Iterator[Finding]:
    """Yield the uses of a name that fit the import that another one replaced, and not the one that holds there."""
    typed = {
        id(value): _TYPES[name]
        for creation in sources.creations
        for name, value in (creation.arguments or {}).items()
        if name in _TYPES
    }
    for source in sources.sources.values():
        alike: dict[str, dict[str, Import]] = {}
        for imported in source.imports:
            alike.setdefault(imported.local, {}).setdefault(imported.target, imported)
        for name, known in alike.items():
            if len(known) == 2 and not source.fault:
                yield from _misused(source, name, [*known.values()], typed)


def _misused(
    source: PythonSource, name: str, known: Sequence[Import], typed: dict[int, str]
) -> Iterator[Finding]:
    """Yield the places at which a name must be the first of two imports, although the second holds."""
    first, last = known
    nodes = (node for node in source.nodes if isinstance(node, ast.Name) and node.id == name)
    held = [node for node in nodes if source.resolve(node) == last.target]
    fits = {use: [_fits(source, use, imported, typed) for imported in known] for use in held}
    wrong = [use for use in held if fits[use] == [True, False]]
    lines = sorted({use.lineno for use in held if fits[use][0] is not True or fits[use][1]})
    modules = [imported.target.rpartition(".")[0] for imported in known]
    kind = {"msg": "Msg", "srv": "Srv"}.get(modules[1].rpartition(".")[2])
    new = f"{name}{kind}" if kind else f"{modules[1].partition('.')[0].title().replace('_', '')}{name}"
    also = f", and {new} instead of {name} on {these_lines(lines)}" if lines else ""
    for use in wrong:
        cause = f"{name} is imported twice: this line needs the one of {modules[0]} (line {first.line}), but line {last.line} replaces it by that of {modules[1]}."
        fix = f"write `{name} as {new}` in the import on line {last.line}{also}"
        yield Finding("name-hidden", cause, source.at(use), fix)


def _fits(source: PythonSource, use: ast.Name, imported: Import, typed: dict[int, str]) -> bool | None:
    """Return whether what is imported can be used as a name is; None if that is not known."""
    target, around = imported.target, source.above(use)
    fields = interfaces.fields_of(target)
    match around:
        case ast.Call() if id(use) in typed:
            return typed[id(use)] in target
        case ast.Call(func=called) if called is use:
            signature = None if ".srv." in target else signature_by_name(target)
            return signature.accepts(around) if signature else None
        case ast.Attribute(attr=asked) if not asked.startswith("_"):
            members = interfaces.members_of(*target.rpartition(".")[::2])
            if fields is None:
                return asked in members if members else None
            return asked in fields or asked.isupper() or asked in ("Request", "Response")
        case ast.ExceptHandler() | ast.ClassDef():
            return not interfaces.is_interface(target)
    return None
