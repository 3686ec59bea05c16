"""The publishers and subscriptions that code makes, as far as reading tells."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path, PurePosixPath

from ros2lab.diagnose.code.syntax_repairs import mended
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.topic_faults import ends_of, timers_of
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.construction import looks_up
from ros2lab.diagnose.sources.file_texts import LARGEST_FILE
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource, last_name, walk
from ros2lab.grading.code.running import running
from ros2lab.grading.evidence import WrittenEnd
from ros2lab.grading.reading.deeds import Deeds
from ros2lab.grading.reading.documents import is_prose

MOST_ENDS = 100
MOST_TRIED = 10  # findings, one by one
_MAKERS = {
    "create_publisher": True,
    "create_subscription": False,
}  # by method that makes an end, whether that publishes
_MAKER_OF = {is_publisher: name for name, is_publisher in _MAKERS.items()}
_NAMES_MAKER = re.compile(
    rb"\b(create)_(?:\w+_)?(publisher|subscription)\b"
)  # also `create_generic_publisher`


def written_ends(
    files: Iterable[PythonSource],
    entrances: Collection[str] | None = None,
    words: Collection[str] = (),
    vain: Collection[str] = (),
) -> tuple[list[WrittenEnd], list[WrittenEnd]]:
    """Return the publishers and subscriptions that some files make; an unknown topic is empty.

    Args:
        files: the modules.
        entrances: as for `running`.
        words: the commands of the assignment.
        vain: the places of what does nothing.

    Returns:
        The ends in code that runs, and those in other code.
    """
    sources = NodeSources({source.name: mended(source) for source in files})
    try:
        told = {end.creation.call: end for end in ends_of(sources)}
    except RecursionError:
        return [], []
    code = [*running([*sources.sources.values()], entrances)]
    alive = running([*sources.sources.values()], entrances, is_living=True, vain=vain)
    run, deeds = {node for _, node in code}, Deeds(sources, frozenset(node for _, node in alive), words)
    found: dict[bool, list[WrittenEnd]] = {True: [], False: []}
    for creation in sources.creations:
        if creation.method not in _MAKERS:
            continue
        end = told.get(creation.call)
        made = WrittenEnd("", "", _MAKERS[creation.method], [], creation.source.name.rpartition(".")[2])
        made = deeds.entered(made, creation)
        if end:
            type_name = (end.type or "").replace(".", "/")
            periods = [seconds for _, seconds in timers_of(end)]
            made = replace(made, topic=f"/{end.topic}", type_name=type_name, periods=periods)
        found[creation.call in run].append(made)
    # If there are too many, those with a known topic come first.
    live, dead = (sorted(found[key], key=lambda end: not end.topic)[:MOST_ENDS] for key in (True, False))
    return live, dead


def ends_left(
    ends: Sequence[WrittenEnd],
    findings: Iterable[Finding],
    without: Callable[[Collection[str]], Sequence[WrittenEnd]],
) -> list[WrittenEnd]:
    """Return ends without what is done with them in vain; empty if that is nothing.

    Args:
        ends: the ends.
        findings: what `diagnose` finds in the files.
        without: given the places of what does nothing, returns the same ends.
    """
    idle = [finding for finding in findings if finding.never]
    least = [*without([place for finding in idle for place in finding.never])] if idle else []
    if not any(map(_does_less, least, ends)):
        return []
    left, places = [*ends], list[str]()
    for number, finding in enumerate(idle, start=1):
        places += finding.never
        if number < MOST_TRIED or number == len(idle):
            now = least if number == len(idle) else without(places)
            left = [
                replace(one, vain=finding.place if _does_less(one, was) else was.vain)
                for was, one in zip(left, now, strict=True)
            ]
    return left


def _does_less(end: WrittenEnd, whole: WrittenEnd) -> bool:
    """Return whether less is done with an end than with the same one in more code."""
    return not ({*(whole.does or ())} <= {*(end.does or ())} and {*end.never} <= {*whole.never})


def ends_elsewhere(
    root: Path, paths: Iterable[PurePosixPath], sources: Collection[PythonSource], ends: Iterable[WrittenEnd]
) -> list[WrittenEnd]:
    """Return an end with an unknown topic for each kind that code may make besides the `ends` in `sources`.

    Anything that names the method may call it: a module in another way than by a plain call, or any file that
    is no prose. So may code that has the message's class; see `hidden_ends`.
    """
    ends = [*ends]
    known = {source.path for source in sources}
    named = Counter(name for source in sources for name in _makers_in(source))
    named.subtract(_MAKER_OF[end.is_publisher] for end in ends)
    unparsed = (path for path in paths if root / path not in known and not is_prose(path))
    named.update(name for path in unparsed for name in _named_makers(root / path))
    found = [
        WrittenEnd("", "", is_publisher, []) for name, is_publisher in _MAKERS.items() if named[name] > 0
    ]
    return [*found, *hidden_ends(sources, ends)]


def _makers_in(source: PythonSource) -> Iterator[str]:
    """Yield the name of a method that makes an end for each time that a module uses the name."""
    if not source.tree.body:  # what cannot be parsed, or is empty
        yield from _makers_named(source.text.encode(errors="replace"))
    for node in source.nodes:
        match node:
            case ast.Attribute(attr=name) | ast.Name(id=name) | ast.Constant(value=name):
                if name in _MAKERS:
                    yield str(name)


def _named_makers(path: Path) -> Iterable[str]:
    """Return the names in a file of methods that make an end; all for a Python file that is too large."""
    with path.open("rb") as file:
        data = file.read(LARGEST_FILE + 1)
    if len(data) > LARGEST_FILE and path.suffix == ".py":
        return _MAKERS
    return {*_makers_named(data)}


def _makers_named(data: bytes) -> list[str]:
    return [b"_".join(words).decode() for words in _NAMES_MAKER.findall(data)]


# What looks up a class whose name it is given.
_LOOKED_UP = frozenset(("import_module", "__import__", "get_message"))


def hidden_ends(sources: Collection[PythonSource], ends: Iterable[WrittenEnd]) -> Iterator[WrittenEnd]:
    """Yield a publisher and a subscription on an unknown topic for each type that code uses beyond `ends`."""
    handed = Counter(name for source in sources for name in _handed(source))
    handed.subtract(end.type_name for end in ends)
    types = [name for name, count in handed.items() if count > 0]
    if any(_is_looked_up(node) for source in sources for node in source.nodes):
        types.append("")
    for type_name in types:
        yield from (WrittenEnd("", type_name, is_publisher, []) for is_publisher in (True, False))


def _handed(source: PythonSource) -> Iterator[str]:
    """Yield a message's type wherever a module uses its class, except to create a message or to annotate."""
    own = {id(node) for part in source.nodes for node in _not_handed(part)}
    for node in source.nodes:
        if isinstance(node, (ast.Name, ast.Attribute)) and id(node) not in own:
            name = source.resolve(node) if isinstance(node.ctx, ast.Load) else None
            if name and interfaces.is_interface(name) and ".msg." in name:
                yield name.replace(".", "/")


def _not_handed(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes inside another one that it passes to nothing."""
    match node:
        case ast.Call(func=ast.Name(id="isinstance" | "issubclass"), args=[_, *kinds]):
            yield from (inner for kind in kinds for inner in walk(kind))
        case ast.Call(func=function):
            yield function
        case ast.Attribute(value=value):
            yield value
        case ast.AnnAssign(annotation=annotation) | ast.arg(annotation=ast.expr() as annotation):
            yield from walk(annotation)
        case (
            ast.FunctionDef(returns=ast.expr() as returns)
            | ast.AsyncFunctionDef(returns=ast.expr() as returns)
        ):
            yield from walk(returns)


def _is_looked_up(node: ast.AST) -> bool:
    """Return whether a node looks something up by a computed name."""
    return looks_up(node) or (isinstance(node, ast.Call) and last_name(node.func) in _LOOKED_UP)
