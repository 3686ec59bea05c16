"""Namespaces in launch files that do not separate nodes, because the names in their code begin with a slash."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from ros2lab import every_node
from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.launching.launch_file import LaunchFile
from ros2lab.diagnose.launching.started_faults import Packages, Started
from ros2lab.diagnose.nodes.parameter_faults import flat
from ros2lab.diagnose.sources.node_source import Creation

_OTHER = {
    "create_publisher": "create_subscription",
    "create_subscription": "create_publisher",
    "create_service": "create_client",
    "create_client": "create_service",
}
_OF_BOTH_ENDS = frozenset(("create_publisher", "create_subscription"))  # all talk there, and all listen
# By the conventions of ROS, all robots share these: what is sent there says whose it is, or is true for all.
_FOR_ALL = every_node.HIDDEN_TOPICS | {"/tf", "/tf_static", "/diagnostics", "/map"}
# What tells a node which of several it is.
_TELLING = frozenset(("get_name", "get_namespace", "get_fully_qualified_name", "__ns", "__node"))
_IDENTITIES = (str, int)  # the types of parameters that may tell a node who it is


@dataclass(frozen=True)
class Name:
    """A name of a topic or a service, as code has it or as it was seen.

    Attributes:
        methods: those of a node that use it, such as `create_publisher`.
        places: where it is written; where its node is started, if it was only seen.
    """

    name: str
    methods: frozenset[str]
    places: tuple[str, ...]


@dataclass(frozen=True)
class SharedNames:
    """The nodes of a launch file, and what of the workspace tells which names they should share.

    Attributes:
        packages: all packages with their files.
        texts: of the files in which a name may be meant, such as `/red/pose`.
        is_elsewhere: whether a file that is not read has a name, so that other programs may use it.
        seen: the names that programs were seen to use, by their modules, where code does not tell.
    """

    file: LaunchFile
    nodes: Sequence[Started]
    packages: Packages
    texts: Sequence[str]
    is_elsewhere: Callable[[str], bool]
    seen: Mapping[str, Sequence[Name]] = field(default_factory=dict)

    def faults(self) -> Iterator[Finding]:
        """Yield each program that is started in namespaces which none of its names takes, although they should."""
        programs: dict[tuple[str, object], list[Started]] = {}
        for node in self.nodes:
            programs.setdefault((node.package.name, node.launched.executable), []).append(node)
        found: dict[tuple[str, ...], list[tuple[Started, list[Name]]]] = {}
        for those in programs.values():
            spaces = tuple(dict.fromkeys(node.namespace for node in those))
            if all(spaces) and self._are_together(those) and (names := self._in_vain(those, spaces)):
                found.setdefault(spaces, []).append((those[0], names))
        for spaces, rows in found.items():
            yield _told(self.file, spaces, rows)

    def _are_together(self, those: Sequence[Started]) -> bool:
        """Return whether several nodes of one program run at the same time, with some arguments at least."""
        key = (those[0].package.name, those[0].launched.executable)
        counts = [sum(node[:2] == key for node in choice) for choice in self.file.choices[1:]]
        return not counts or max(counts) >= len(those)

    def _in_vain(self, those: Sequence[Started], spaces: Sequence[str]) -> list[Name]:
        """Return the names of a program that should be other ones in each namespace, and are not."""
        names = self.seen.get(those[0].module) or _names(those[0])
        shared = [one for one in names or () if self._is_shared(one, those)]
        shared = [one for one in shared if not self._has_other_end(one, spaces)]
        meant = [one for one in shared if self._is_meant(one.name, spaces)]
        is_all = names is not None and len(shared) == len(names) and len(spaces) > 1
        return (self._mixed_up(shared, those) if is_all else []) or meant

    def _is_shared(self, one: Name, those: Sequence[Started]) -> bool:
        """Return whether a name stays the same in each namespace, and not on purpose."""
        if not one.name.startswith("/") or one.name in _FOR_ALL or one.methods >= _OF_BOTH_ENDS:
            return False
        is_inside = any(one.name.startswith(f"{node.namespace}/") for node in those)
        return not is_inside and all(node.resolved(one.name) == one.name for node in those)

    def _is_meant(self, name: str, spaces: Sequence[str]) -> bool:
        """Return whether a file of the workspace has a name with one of the namespaces before it."""
        whole = [re.compile(rf"(?<![\w/])/?{re.escape(space[1:] + name)}(?![\w/])") for space in spaces]
        return any(pattern.search(text) for pattern in whole for text in self.texts)

    def _has_other_end(self, one: Name, spaces: Sequence[str]) -> bool:
        """Return whether a program that is not in each of the namespaces as well has the other end of a name."""
        if self.is_elsewhere(one.name):
            return True
        wanted = {_OTHER[method] for method in one.methods}
        users = [own for own, other in self._absolute if other.name == one.name and wanted & other.methods]
        return any(not set(spaces) <= self._spaces.get(module, set()) for module in users)

    @cached_property
    def _spaces(self) -> Mapping[str, set[str]]:
        """The namespaces in which the nodes of each module are started."""
        found: dict[str, set[str]] = {}
        for node in self.nodes:
            found.setdefault(node.module, set()).add(node.namespace)
        return found

    @cached_property
    def _absolute(self) -> list[tuple[str, Name]]:
        """The names in code, each with the module that uses it."""
        found = (
            (creation, sources.value(creation.source, creation.given("topic", "srv_name")))
            for _, sources in self.packages.values()
            for creation in sources.creations
        )
        return [
            (creation.source.name, Name(name, frozenset((creation.method,)), ()))
            for creation, name in found
            if isinstance(name, str)
        ]

    def _mixed_up(self, shared: Sequence[Name], those: Sequence[Started]) -> list[Name]:
        """Return the names of a node that has no others, if what is sent there does not say whose it is."""
        node = those[0]
        given = [dict(flat(one.launched.values)) for one in those]
        different = [key for key in given[0] if len({str(values.get(key)) for values in given}) > 1]
        files = node.sources.around(node.module)
        texts = [source.text for source in files.sources.values()] if files else [*_TELLING]
        says_who = any(word in text for word in _TELLING for text in texts) or any(
            isinstance(given[0][key], _IDENTITIES) and not isinstance(given[0][key], bool)
            for key in different
        )
        offers = [one for one in shared if "create_service" in one.methods]
        sends = [one for one in shared if "create_publisher" in one.methods and not says_who]
        is_alike = not (different or says_who or node.launched.given or node.launched.arguments)
        return [*shared] if offers or sends or (is_alike and len(self.nodes) == len(self.file.nodes)) else []


def _names(node: Started) -> list[Name] | None:
    """Return the names of a program's topics and services, as they are written; None if any is not known."""
    files = node.sources.around(node.module)
    found: dict[str, list[Creation]] = {}
    for creation in files.creations if files else ():
        if creation.method == "create_timer":
            continue
        value = files.value(creation.source, creation.given("topic", "srv_name")) if files else None
        if not isinstance(value, str):
            return None
        found.setdefault(value, []).append(creation)
    return [
        Name(name, frozenset(one.method for one in those), tuple(dict.fromkeys(map(_place, those))))
        for name, those in found.items()
    ]


def _place(creation: Creation) -> str:
    """Return where a name is written."""
    return creation.source.at(creation.given("topic", "srv_name") or creation.call)


def _told(file: LaunchFile, spaces: Sequence[str], rows: Sequence[tuple[Started, Sequence[Name]]]) -> Finding:
    """Return the finding of the programs that a launch file starts in some namespaces in vain, with all of their names."""
    programs = in_a_row([str(node.launched.executable) for node, _ in rows])
    names = [*dict.fromkeys(one.name for _, those in rows for one in those)]
    verb = "is" if len(names) < 2 else "are"
    kept = f"{verb} the same in all of them" if len(spaces) > 1 else f"{verb} the same as without it"
    cause = f"{Path(file.shown).name} starts {programs} in the namespace{'s' * (len(spaces) > 1)} {in_a_row(spaces)}, but no namespace is put before a name that begins with a slash: {in_a_row(names)} {kept}."
    first, *more = dict.fromkeys(place for _, those in rows for one in those for place in one.places)
    home = f"{first.rpartition(':')[0]}:"
    others = [place.replace(home, "line ") for place in more]
    where = f" in the code of {programs}" if first == rows[0][0].launched.place else ""
    also = f" (also in {in_a_row(others)})" if others else ""
    fix = f"write {in_a_row([f'{name[1:]!r} instead of {name!r}' for name in names])}{where}{also}, and build again"
    return Finding("namespace-unused", cause, first, fix, tuple(names))
