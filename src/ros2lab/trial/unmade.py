"""Explains why what the code promises of a node was not there while it ran: its publishers, subscriptions, timers."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.entrance import Call, Entrance
from ros2lab.diagnose.sources.node_source import Creation, NodeClass
from ros2lab.diagnose.sources.python_source import PythonSource, read_source, read_text, walk
from ros2lab.every_node import OF_MANAGED
from ros2lab.grading.evidence import Run
from ros2lab.trial.starts import executable_of

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen
    from ros2lab.trial.witnessed import Called

_MADE = {
    "create_publisher": "publisher",
    "create_subscription": "subscription",
    "create_timer": "timer",
    "create_service": "service",
    "create_client": "client",
}


@dataclass(frozen=True)
class Unmade:
    """A publisher or a subscription that a program was to make, and did not.

    Attributes:
        name: what it is, with its topic.
        branch: the `if` that it is in.
        holds: whether the condition has to hold for it.
        parameter: the parameter that decides, with its value; empty if none does.
    """

    name: str
    creation: Creation
    branch: ast.If
    holds: bool
    parameter: tuple[str, Any] | tuple[()]

    @property
    def place(self) -> str:
        """Where the condition is."""
        return self.creation.source.at(self.branch)

    @property
    def told(self) -> str:
        """What was not made, and why, as a clause."""
        is_what = "is" if self.holds else "is not"
        test = ast.unparse(self.branch.test)
        given = f", and the parameter {self.parameter[0]} is {self.parameter[1]}" if self.parameter else ""
        return f"its {self.name} is made only if `{test}` {is_what} true{given}"


def unmade_faults(seen: Seen, run: Run, called: Called) -> Iterator[Finding]:
    """Yield why a program did nothing, or a managed node not all, of what its code promises.

    Args:
        seen: all runs.
        run: the run of the program alone.
        called: the functions that were called in any run.
    """
    entrance = seen.entrance(run.programs[0])
    if entrance is None or run.ended or not run.nodes:
        return
    for owner in _managed(entrance):
        if not are_by_hand(seen.look) and (found := _of_managed(seen, run, entrance, owner, called)):
            yield found
            return
    unmade = unmade_ends(seen, run, called)
    left = {(id(end.branch), end.holds) for end in unmade}
    branches = map(_branch_around, _promised(entrance))
    others = [branch for branch in branches if branch is None or (id(branch[0]), branch[1]) not in left]
    if unmade and not others and not _topics(run):
        cause = f"{run.programs[0]} neither published nor subscribed to anything: {unmade[0].told}."
        yield Finding("publishes-nothing", cause, unmade[0].place, _met(unmade[0], run.programs[0]))


def _met(end: Unmade, program: str) -> str:
    """Return how to start a program so that it makes something, or how to see why it does not."""
    test = end.branch.test
    wanted: object = None
    if end.parameter and isinstance(end.parameter[1], bool):
        wanted = str(not end.parameter[1]).lower()
    elif end.parameter and end.holds and isinstance(test, ast.Compare) and isinstance(test.ops[0], ast.Eq):
        sides = [side.value for side in (test.left, *test.comparators) if isinstance(side, ast.Constant)]
        wanted = next((side for side in sides if side != end.parameter[0]), None)
    if end.parameter and wanted is not None:
        package = end.creation.source.name.partition(".")[0]
        return f"start it with another value: `ros2 run {package} {program} --ros-args -p {end.parameter[0]}:={wanted}`"
    return f"write `print({ast.unparse(test)})` above line {end.branch.lineno}, and see why"


def unmade_notes(seen: Seen, run: Run, called: Called) -> list[str]:
    """Return what a program did not make although its code would under another condition, in clauses."""
    notes = [end.told for end in unmade_ends(seen, run, called)]
    entrance = seen.entrance(run.programs[0])
    waits = [*_managed(entrance)] if entrance and are_by_hand(seen.look) else []
    if waits and not run.ended and _not_called(waits[0], entrance, called):
        node = run.nodes[0] if run.nodes else "it"
        notes.append(f"waits to be configured and activated, as with `ros2 lifecycle set {node} configure`")
    return notes


def unmade_ends(seen: Seen, run: Run, called: Called) -> list[Unmade]:
    """Return the publishers and subscriptions that a program would make under a condition that did not come true."""
    entrance = seen.entrance(run.programs[0])
    moved = any(
        started.launched.remappings
        for (_, name), started in seen.look.launched.items()
        if name in map(executable_of, run.programs)
    )
    if entrance is None or run.ended or moved:
        return []
    found = []
    for creation in _promised(entrance):
        topic = entrance.sources.value(creation.source, creation.given("topic"))
        side = {"create_publisher": run.publishes, "create_subscription": run.subscribes}.get(creation.method)
        if side is None or not isinstance(topic, str) or _last(topic) in map(_last, side):
            continue
        is_called = creation.function is not None and (creation.source, creation.function.lineno) in called
        branch = _branch_around(creation) if is_called else None
        if branch is not None:
            name = f"{_MADE[creation.method]} on {topic}"
            found.append(Unmade(name, creation, *branch, _deciding(creation.source, branch[0].test, run)))
    return found


def _last(topic: str) -> str:
    return topic.rpartition("/")[2]


def _topics(run: Run) -> list[str]:
    return [topic for topic in (*run.publishes, *run.subscribes) if not topic.endswith(OF_MANAGED)]


def _promised(entrance: Entrance) -> list[Creation]:
    """Return what the functions that a program reaches would make."""
    reached = {id(function) for function in entrance.functions}
    return [creation for creation in entrance.sources.creations if id(creation.function) in reached]


def _branch_around(creation: Creation) -> tuple[ast.If, bool] | None:
    """Return the innermost `if` around a call, and whether its condition has to hold; None if there is none."""
    found = None
    for node in walk(creation.function) if creation.function else ():
        if isinstance(node, ast.If):
            for branch, holds in ((node.body, True), (node.orelse, False)):
                if any(creation.call in walk(statement) for statement in branch):
                    found = (node, holds)
    return found


def _deciding(source: PythonSource, test: ast.expr, run: Run) -> tuple[str, Any] | tuple[()]:
    """Return the parameter on which a condition depends, with its value in a run; empty if none is known."""
    values = {name: value for held in run.parameters.values() for name, value in held.items()}
    asked = [test]
    for node in walk(test):
        if isinstance(node, (ast.Name, ast.Attribute)):
            asked += [value for value in source.stored.get(ast.unparse(node), ()) if value is not None]
    for expression in asked:
        for node in walk(expression):
            if isinstance(node, ast.Constant) and node.value in values:
                return str(node.value), values[str(node.value)]
    return ()


def _managed(entrance: Entrance) -> Iterator[NodeClass]:
    """Yield the classes of managed nodes that a program makes."""
    names = dict.fromkeys(call.name for call in entrance.calls if call.name in entrance.sources.classes)
    yield from filter(entrance.sources.is_managed, (entrance.sources.classes[name] for name in names))


def _not_called(owner: NodeClass, entrance: Entrance | None, called: Called) -> list[str]:
    """Return the transitions whose methods a class has, and that were never called although its file ran."""
    ran = {source for source, _ in called}
    lineage = entrance.sources.lineage(owner)[0] if entrance else [owner]
    found = []
    for transition in TRANSITIONS:
        homes = [inner for inner in lineage if f"on_{transition}" in inner.methods]
        places = [(inner.source, inner.methods[f"on_{transition}"].lineno) for inner in homes[:1]]
        if any(source in ran and (source, line) not in called for source, line in places):
            found.append(transition)
    return found


def _of_managed(seen: Seen, run: Run, entrance: Entrance, owner: NodeClass, called: Called) -> Finding | None:
    """Return what a managed node lacks that nothing configures or activates; None if it lacks nothing."""
    missing = [transition for transition in TRANSITIONS if transition not in asked_for(seen.look)]
    never = _not_called(owner, entrance, called)
    silent = [*_silent(seen, run, entrance, owner)]
    if not missing or not (set(never) & set(missing) or silent):
        return None
    methods = " and ".join(f"on_{transition}()" for transition in missing)
    lost = [*_made_in(entrance, owner, {f"on_{transition}" for transition in never})]
    effect = (
        f"its {' and its '.join(lost)} {'are' if len(lost) > 1 else 'is'} never made"
        if lost
        else f"nothing is published on {silent[0]}"
        if silent
        else "nothing in them is done"
    )
    state = "unconfigured" if "configure" in missing else "inactive"
    cause = f"{run.programs[0]} is a managed (lifecycle) node and stays {state}: nothing calls {methods}, so {effect}."
    spins = [call for call in entrance.spins if call.is_lasting] or entrance.spins
    place = spins[0].source.at(spins[0].call) if spins else seen.main(run.programs[0])
    node = min((name for name in run.nodes), default=f"/{run.programs[0]}")
    typed = " and then ".join(f"`ros2 lifecycle set {node} {transition}`" for transition in missing)
    by_hand = f"type {typed} in another terminal while it runs"
    fix = f"{_triggered(entrance, spins[0], missing)}; or {by_hand}" if spins else by_hand
    return Finding("never-activated", cause, place, fix)


def _silent(seen: Seen, run: Run, entrance: Entrance, owner: NodeClass) -> Iterator[str]:
    """Yield the topics of lifecycle publishers that were made, and published nothing."""
    lineage = entrance.sources.lineage(owner)[0]
    published = {_last(topic) for other in (run, *seen.together) for topic in seen.published(other)}
    for creation in _promised(entrance):
        is_own = creation.owner in lineage and "lifecycle" in ast.unparse(creation.call.func)
        topic = entrance.sources.value(creation.source, creation.given("topic"))
        is_there = isinstance(topic, str) and _last(topic) in map(_last, run.publishes)
        if is_own and is_there and _last(topic) not in published:
            yield topic


def _made_in(entrance: Entrance, owner: NodeClass, methods: Collection[str]) -> Iterator[str]:
    """Yield the words for what some methods of a class make, each once."""
    lineage = entrance.sources.lineage(owner)[0]
    made = (
        _MADE[creation.method]
        for creation in _promised(entrance)
        if creation.owner in lineage and creation.function and creation.function.name in methods
    )
    yield from dict.fromkeys(made)


def _triggered(entrance: Entrance, spin: Call, missing: Sequence[str]) -> str:
    """Return what to write in main so that the node is configured and activated."""
    match spin.call.args:
        case [ast.Name(id=node), *_]:
            pass
        case [ast.Call() as made, *_]:
            steps = [f"`node = {ast.unparse(made)}`"]
            steps += [f"`node.trigger_{transition}()`" for transition in missing]
            whole = re.sub(re.escape(ast.unparse(made)), "node", ast.unparse(spin.call), count=1)
            return f"write {', '.join(steps)} and `{whole}` instead of line {spin.call.lineno}"
        case _:
            node = kept_as(entrance)
    steps = [f"`{node}.trigger_{transition}()`" for transition in missing]
    return f"write {' and '.join(steps)} above line {spin.call.lineno}, `{ast.unparse(spin.call)}`"


def kept_as(entrance: Entrance) -> str:
    """Return the variable of the first node that a program makes; "node" if there is none."""
    for statement in walk(entrance.node.function) if entrance.node else ():
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if (
                entrance.node and value is entrance.node.call
            ):
                return name
    return "node"


TRANSITIONS = ("configure", "activate")  # those that make a managed node work, in order
_BY_HAND = re.compile(r"\blifecycle set\b")
_READ = frozenset((".md", ".txt", ".rst", ".sh", ""))


def asked_for(look: Look) -> set[str]:
    """Return the transitions that the code or a launch file of a workspace may ask for."""
    sources = [source for package in look.packages for source in package.sources.values()]
    own = {n.name for source in sources for n in source.nodes if isinstance(n, ast.FunctionDef)}
    paths = [*zip(look.launch_paths, look.launch_files, strict=True)]
    launched = [read_source(path, "launch_file", file.shown) for path, file in paths if path.suffix == ".py"]
    names = {name for source in (*sources, *launched) for name in _names(source)} - own
    plain = [read_text(path) for path, _ in paths if path.suffix != ".py"]
    # A manager brings up every node that it is told of; what XML and YAML ask for is not read here.
    if any(_brings_up(name) for name in names) or any("lifecycle" in text for text in plain):
        return {*TRANSITIONS}
    words = {
        word for name in names if not name.startswith("on_") for word in re.findall("[a-z]+", name.lower())
    }
    found = words.intersection(TRANSITIONS)
    # Numbers may stand for transitions.
    return found or ({*TRANSITIONS} if "ChangeState" in names else set())


def are_by_hand(look: Look) -> bool:
    """Return whether a text of the workspace says how to bring up its nodes by hand."""
    folders = [look.root, *(package.folder for package in look.packages)]
    files = [path for folder in folders for path in sorted(folder.glob("*")) if path.suffix in _READ]
    texts = [read_text(path) for path in files if path.is_file()]
    texts += [source.text for package in look.packages for source in package.sources.values()]
    return any(_BY_HAND.search(text) for text in texts)


def _brings_up(name: str) -> bool:
    lower = name.lower()
    return lower == "autostart" or ("lifecycle" in lower and "manager" in lower)


def _names(source: PythonSource) -> Iterator[str]:
    """Yield the names that a file uses, and its strings that are a single word."""
    for node in source.nodes:
        match node:
            case ast.Name(id=name) | ast.Attribute(attr=name):
                yield name
            case ast.keyword(arg=str(name)):
                yield name
            case ast.Constant(value=str(name)) if re.fullmatch(r"[\w/]+", name):
                yield name
