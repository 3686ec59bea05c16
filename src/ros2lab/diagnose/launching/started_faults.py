"""Compare what launch files start with the names, topics and parameters that the nodes use."""

from __future__ import annotations

import ast
import functools
import itertools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from ros2lab.diagnose.finding import Finding, at, in_a_row
from ros2lab.diagnose.launching.launch_arguments import sections_in
from ros2lab.diagnose.launching.launch_file import Launched, LaunchFile
from ros2lab.diagnose.nodes.partners import name_in
from ros2lab.diagnose.nodes.topic_faults import End, ends_of
from ros2lab.diagnose.sources.entrance import Entrance
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.one_run import calls_in_one_run
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.parameter_file import is_for, line_of
from ros2lab.diagnose.sources.python_source import PythonSource, last_name, read_text

Packages = Mapping[str, tuple[SourcePackage, NodeSources]]  # those of a workspace, each with its files


@dataclass(frozen=True)
class Started:
    """A node of the workspace as a launch file starts it."""

    launched: Launched
    package: SourcePackage
    sources: NodeSources
    module: str
    function: str

    @cached_property
    def name(self) -> str:
        """The node's name; empty if it is unknown or ambiguous."""
        if self.launched.name is not None:
            return self.launched.name if isinstance(self.launched.name, str) else ""
        return self.own_names[0] if len(self.own_names) == 1 else ""

    @property
    def entrance(self) -> Entrance | None:
        """What its executable runs; None if that is no function of its file, such as a partial call."""
        name = f"{self.module}.{self.function}"
        return Entrance(self.sources, name) if name in self.sources.functions else None

    @property
    def own_names(self) -> list[str]:
        """The names that its file gives to nodes."""
        named = self.sources.node_names.items()
        return [name for name, (source, _) in named if source.name == self.module]

    @property
    def namespace(self) -> str:
        """Its namespace with a leading slash and without a trailing one."""
        given = self.launched.namespace
        return f"/{given.strip('/')}".rstrip("/") if isinstance(given, str) else ""

    @property
    def full_name(self) -> str:
        """Its name with its namespace."""
        return f"{self.namespace}/{self.name}"

    @cached_property
    def runs_as(self) -> str:
        """Its full name, with the namespace from the code if launch gives none; empty if unknown."""
        names = [n for n in self.sources.full_names.values() if n.rpartition("/")[2] in self.own_names]
        of_code = names[0].rpartition("/")[0] if len(names) == 1 else ""
        return f"{self.namespace or of_code}/{self.name}" if self.name else ""

    @cached_property
    def ends(self) -> list[tuple[End, str, str]]:
        """The ends of topics in its file, each with its full name without and with the launch file."""
        found = []
        for end in filter(self._may_have, ends_of(self.sources)):
            written = self.sources.value(end.creation.source, end.creation.given("topic"))
            if isinstance(written, str):
                found.append((end, self.plain(written), self.resolved(written)))
        return found

    def _may_have(self, end: End) -> bool:
        """Return whether an end is of this node's file and, if that has several nodes, of its class."""
        owner = end.creation.owner
        is_own = end.creation.source.name == self.module
        return is_own and (self._named is None or owner is None or owner.name in self._named)

    @cached_property
    def _named(self) -> set[str] | None:
        """The node classes that its function names, with their bases; None if the file has only one."""
        source = self.sources.sources[self.module]
        classes = self.sources.classes.items()
        nodes = {name: node_class for name, node_class in classes if self.sources.lineage(node_class)[1]}
        if sum(node_class.source is source for node_class in nodes.values()) < 2:
            return None
        defined = [
            node
            for node in source.tree.body
            if getattr(node, "name", "") == self.function
            or self.function in map(ast.unparse, getattr(node, "targets", ()))
        ]
        named = {self.sources.resolve(source, inner) or "" for node in defined for inner in ast.walk(node)}
        return {base.name for name in named & nodes.keys() for base in self.sources.lineage(nodes[name])[0]}

    def plain(self, topic: str) -> str:
        """Return the full name that a topic has without any launch file."""
        return f"/{name_in(self.name, topic)}"

    def resolved(self, topic: str) -> str:
        """Return the full name of a topic as this node uses it."""
        found = self.resolved_alone(topic)
        for old, new in self.launched.remappings:
            if self.resolved_alone(old) == found:
                return self.resolved_alone(new) if isinstance(new, str) else ""
        return found

    def resolved_alone(self, topic: str) -> str:
        """Return the full name of a topic without remappings."""
        return f"/{name_in(self.full_name.lstrip('/'), topic)}"


def started_in(file: LaunchFile, packages: Packages) -> list[Started]:
    """List the nodes of the workspace that a launch file starts."""
    found = []
    for node in file.nodes:
        package, sources = (
            packages.get(node.package, (None, None)) if isinstance(node.package, str) else (None, None)
        )
        points = package.points if package else ()
        point = next((point for point in points if point.name == node.executable), None)
        if package and sources and point and point.module in sources.sources:
            found.append(Started(node, package, sources, point.module, point.function))
    return found


def alternatives(files: Iterable[LaunchFile], packages: Iterable[SourcePackage]) -> set[frozenset[str]]:
    """Return the pairs of modules whose nodes launch files have, but never start together under one name."""
    points: dict[tuple[str | None, ...], str]
    points = {(package.name, point.name): point.module for package in packages for point in package.points}
    listed, met = set[frozenset[str]](), set[frozenset[str]]()
    for file in files:
        for number, choice in enumerate(file.choices):
            known = [(points[node[:2]], node[2:]) for node in choice if node[:2] in points]
            for (module, name), (other, same) in itertools.combinations(known, 2):
                (met if number > 0 and name == same else listed).add(frozenset((module, other)))
    return listed - met


def are_alone(files: Iterable[LaunchFile], packages: Packages) -> bool:
    """Return whether the nodes of a workspace work without any other program, such as a simulator.

    Texts are typed at a terminal, but other messages come from a program.
    """
    if any(package.setup is None for package, _ in packages.values()):
        return False
    for file in files:
        is_own = file.is_loaded and len(started_in(file, packages)) == len(file.nodes)
        if not is_own or any("sim" in name for name in {*(file.arguments or ())} - {"use_sim_time"}):
            return False
    ends = [end for _, sources in packages.values() for end in ends_of(sources, unnamed=True)]
    sent = {end.topic for end in ends if end.is_publisher}
    from_outside = {
        end.topic
        for end in ends
        if not end.is_publisher and not (end.type or "").startswith("std_msgs") and end.topic not in sent
    }
    return not from_outside and "clock" not in sent and "" not in sent


def started_faults(file: LaunchFile, packages: Packages, *, is_alone: bool) -> Iterator[Finding]:
    """Yield what keeps the nodes of a launch file from their parameters or from each other.

    They are alone if nothing but the workspace's own nodes is ever started with them.
    """
    nodes = started_in(file, packages)
    yield from filter(None, map(_renamed, nodes))
    if len(nodes) == len(file.nodes):  # otherwise another program may have the other end of a topic
        yield from _without_clock(file, nodes) if is_alone else ()
        yield from _started_twice(nodes)
        yield from _apart(nodes)


def _renamed(node: Started) -> Finding | None:
    """Return a name given to a program that makes several nodes, all of which get that name; else None."""
    name, source = node.launched.name, node.sources.sources[node.module]
    _, function = node.sources.functions.get(f"{node.module}.{node.function}", (None, None))
    calls = calls_in_one_run(function, functools.partial(_is_node, node.sources, source)) if function else []
    made = [ast.unparse(call.func) for call in _at_once(source, calls)]
    if not isinstance(name, str) or len(made) < 2 or "use_global_arguments" in source.text:
        return None
    cause = f"The launch file names {node.launched.executable} {name!r}, but that program makes {len(made)} nodes ({', '.join(made)}): name= renames every one of them, so they all have the same name."
    fix = f"remove name={name!r}, so that each node keeps the name from its code"
    return Finding("name-twice", cause, node.launched.place, fix, (str(node.launched.executable),))


def _at_once(source: PythonSource, calls: Sequence[ast.Call]) -> list[ast.Call]:
    """Return the most nodes that exist at one time: one that is destroyed above the next line is gone there."""
    ends = [call for call in source.calls if last_name(call.func) == "destroy_node"]
    gone = [(ast.unparse(end.func).rpartition(".")[0], end.lineno) for end in ends]
    alive, most = list[ast.Call](), list[ast.Call]()
    for call in calls:
        names = {c: source.name_of(c) for c in alive}
        alive = [c for c in alive if not any(n == names[c] and c.lineno < at < call.lineno for n, at in gone)]
        alive.append(call)
        most = max(most, [*alive], key=len)
    return most


def _is_node(sources: NodeSources, source: PythonSource, call: ast.Call) -> bool:
    return sources.is_node(sources.resolve(source, call.func))


def _started_twice(nodes: Sequence[Started]) -> Iterator[Finding]:
    """Yield an executable that is started twice under the same name, while others of its package are never started."""
    started = [(node.package, node.launched.executable, node.name and node.full_name) for node in nodes]
    for number, (package, name, full_name) in enumerate(started):
        left = [p.name for p in package.points if (package, p.name) not in {row[:2] for row in started}]
        if full_name and started[number] in started[:number] and left:
            cause = (
                f"The launch file starts {name} twice under the same name and never starts {in_a_row(left)}."
            )
            fix = f"write {' or '.join(left)} instead of {name} here"
            yield Finding("launch-executable", cause, nodes[number].launched.place, fix)


def _without_clock(file: LaunchFile, nodes: Sequence[Started]) -> Iterator[Finding]:
    """Yield parameters that make a node wait for simulated time that nothing publishes."""
    cause = "use_sim_time makes the node wait for simulated time on /clock, which nothing here publishes, so its timers never fire."
    for node in nodes:
        if node.launched.values.get("use_sim_time") is True:
            is_argument = "use_sim_time" in (file.arguments or ()) and not file.faults
            fix = "make 'false' the default of the launch argument use_sim_time, or start it with use_sim_time:=false"
            fix = f"{fix if is_argument else 'set use_sim_time to False, or remove it'}, unless a simulator is running"
            yield Finding("period", cause, node.launched.place_of("use_sim_time"), fix)
    for home, path in dict.fromkeys(
        (node.package, path)
        for node in nodes
        for package, path in node.launched.files
        if package == node.package.name
    ):
        text = read_text(home.folder / path)
        if written := re.search(r"^\s*use_sim_time\s*:\s*[Tt]rue", text, re.MULTILINE):
            fix = "write use_sim_time: false, unless a simulator is running"
            place = at(home.shown(path), text.count("\n", 0, written.end()) + 1)
            yield Finding("period", cause, place, fix)


def sections_apart(started: Sequence[tuple[LaunchFile, list[Started]]]) -> Iterator[Finding]:
    """Yield the sections of parameter files that nodes do not take which are plainly meant for them.

    A parameter file is one for all starts of all launch files, so each section is told once.
    """
    given: dict[tuple[str, str], dict[str, list[Started]]] = {}
    for file, nodes in started:
        for node in nodes:
            for package, path in node.launched.files:
                if package == node.package.name:
                    given.setdefault((package, path), {}).setdefault(file.shown, []).append(node)
    for (_, path), starts in given.items():
        everyone = [*itertools.chain.from_iterable(starts.values())]
        home = everyone[0].package
        text = read_text(home.folder / path)
        keys = [key for key, _ in sections_in(text)]
        lost: dict[str, dict[str, tuple[str, Started]]] = {}
        for shown, takers in starts.items():
            for key, node in _lost(keys, takers):
                lost.setdefault(key, {}).setdefault(node.runs_as, (shown, node))
        for key, those in lost.items():
            files = " and ".join(dict.fromkeys(shown for shown, _ in those.values()))
            _, node = next(iter(those.values()))
            cause = (
                f"{home.shown(path)} sets parameters for {key}, but {node.launched.executable} is started as "
                f"{' and '.join(those)} ({files}), so it silently keeps its defaults."
            )
            every = {*those, *(node.runs_as for node in everyone if is_for(key, node.runs_as))}
            place = at(home.shown(path), line_of(key, text))
            yield Finding("parameter-file-node", cause, place, _section_for(sorted(every), key))


def _section_for(names: Sequence[str], key: str) -> str:
    """Say how to write the key of a section so that every node takes it that should."""
    last = {name.rpartition("/")[2] for name in names}
    if len(names) == 1:
        return f"write {names[0]}: instead of {key}:, or /**: for every node"
    if len(last) == 1:
        return f"write /**/{last.pop()}: instead of {key}:"
    return f"write {' and '.join(f'{name}:' for name in names)} instead of {key}:, each with what is below it"


def _lost(keys: Sequence[str], takers: Sequence[Started]) -> Iterator[tuple[str, Started]]:
    """Yield sections with the nodes of one launch file that they are meant for and that take none of the sections.

    A program that makes several nodes has no section of its own; what is told of its name mends that, too.
    """
    without = [n for n in takers if n.runs_as and not any(is_for(key, n.runs_as) for key in keys)]
    for key in keys:
        is_unused = all(n.runs_as and not is_for(key, n.runs_as) for n in takers)
        is_only_one = len(takers) == 1 and is_unused and len(keys) == 1
        meant = _meant(key, without) or (takers[0] if is_only_one else None)
        if meant and not _renamed(meant) and (is_unused or key == meant.name):
            yield from ((key, node) for node in without if node.module == meant.module)


def _meant(key: str, nodes: Sequence[Started]) -> Started | None:
    """Return the node that a section was meant for, by its own name or its executable's; else None."""
    last = key.rstrip("/").rpartition("/")[2]
    for node in nodes:
        if last in (*node.own_names, node.launched.executable, node.name):
            return node
    return None


# A node's end, as `Started.ends` has it: the name in its code, and the one that it has when it is launched.
_End = tuple[Started, End, str, str]


def _apart(nodes: Sequence[Started]) -> Iterator[Finding]:
    """Yield two nodes that would share a topic if the launch file did not separate them.

    What one change mends is told once, with the names of all of its topics.
    """
    ends = [(node, *end) for node in nodes for end in node.ends]
    if any(not end.topic for node in nodes for end in ends_of(node.sources, unnamed=True)):
        return  # the other end may have a name that is only known when it runs
    found: dict[tuple[str, str], Finding] = {}
    for asking in ends:
        _, end, _, name = asking
        if end.is_publisher or not name or _others(ends, name, is_publisher=True):
            continue
        if told := next(_from_publishers(nodes, ends, asking), None):
            first = found.setdefault((told.place, told.fix), told)
            about = tuple(dict.fromkeys((*first.about, *told.about)))
            found[told.place, told.fix] = replace(first, about=about)
    yield from found.values()


def _from_publishers(nodes: Sequence[Started], ends: Sequence[_End], asking: _End) -> Iterator[Finding]:
    """Yield why a subscription does not meet a publisher whose code has the same name."""
    node, end, plain, name = asking
    for other, other_end, other_plain, other_name in ends:
        is_left = other_name and not _others(ends, other_name, is_publisher=False)
        are_alike = (
            other_end.is_publisher
            and other_plain == plain
            and (end.type or other_end.type) == (other_end.type or end.type)
        )
        if other is node or not (is_left and are_alike) or _are_of_two_groups(nodes, node, other):
            continue
        moved = [one for one in (other, node) if one.namespace or one.launched.remappings]
        if moved:
            meet = f"{other.launched.executable} publishes on {other_name}, but {node.launched.executable} subscribes to {name}"
            are_together = node.namespace == other.namespace
            told = _by_slash((other, other_end), (node, end), meet)
            told = told or _moved(moved[0], meet, plain, are_together=are_together)
            yield replace(told, about=(*told.about, other_name, name))


def _are_of_two_groups(nodes: Sequence[Started], node: Started, other: Started) -> bool:
    """Return whether two nodes are in different namespaces, and one of them has the other's like in its own."""
    started = {(beside.namespace, beside.launched.executable) for beside in nodes}
    likes = {(node.namespace, other.launched.executable), (other.namespace, node.launched.executable)}
    return node.namespace != other.namespace and not likes.isdisjoint(started)


def _by_slash(sender: tuple[Started, End], reader: tuple[Started, End], meet: str) -> Finding | None:
    """Return a finding about the only absolute name of two, which no namespace changes; None if there are none or two."""
    absolute, relative = sorted((sender, reader), key=lambda side: not side[1].is_absolute)
    is_plain = not any(node.launched.remappings for node, _ in (sender, reader))
    if not is_plain or not absolute[1].is_absolute or relative[1].is_absolute:
        return None
    are_together = absolute[0].namespace == relative[0].namespace
    changed = (absolute if are_together else relative)[1]
    texts = [
        repr(end.sources.value(end.creation.source, end.creation.given("topic")))
        for _, end in (absolute, relative)
    ]
    new, old = reversed(texts) if are_together else texts
    cause = (
        f"{meet}: a namespace is put before {texts[1]}, but not before {texts[0]}, which begins with a slash."
    )
    return Finding("launch-apart", cause, changed.place, f"write {new} instead of {old}")


def _moved(moved: Started, meet: str, plain: str, *, are_together: bool) -> Finding:
    """Return a finding about a node that a launch file separates from another one."""
    why = f"in the namespace {moved.namespace}" if moved.namespace else "with a topic remapped"
    way = f"start both in the namespace {moved.namespace}"
    if are_together:
        way = f"write {plain[1:]!r}, without a slash, in both"
    fix = f"give both the same remapping: remappings=[({plain!r}, ...)]"
    if moved.namespace:
        fix = f"{way}, or name the topic {plain!r}, with a slash, in both"
    cause = f"The launch file starts {moved.launched.executable} {why}: {meet}."
    place = moved.launched.place if moved.namespace else moved.launched.place_of(plain, "remappings")
    return Finding("launch-apart", cause, place, fix)


def _others(ends: Sequence[_End], name: str, *, is_publisher: bool) -> bool:
    return any(end.is_publisher is is_publisher and topic == name for _, end, _, topic in ends)
