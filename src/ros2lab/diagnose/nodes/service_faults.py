"""Services and actions that do not meet: a client waits for a name that no server of the workspace offers."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.partners import Partners, made_in, name_in
from ros2lab.diagnose.sources.node_source import Creation, NodeSources
from ros2lab.diagnose.sources.python_source import last_name
from ros2lab.diagnose.sources.spelling import is_near_miss, words_of
from ros2lab.diagnose.sources.syntax_parts import with_arguments

_OFFERS, _CALLS = ("create_service", "ActionServer"), ("create_client", "ActionClient")
_OF_ACTIONS = ("node", "srv_type", "srv_name")  # the parameters of both classes of actions


@dataclass(frozen=True)
class ServiceEnd:
    """A server or a client of a service or an action, as the source has it."""

    creation: Creation
    sources: NodeSources

    @property
    def is_server(self) -> bool:
        """Whether it offers the service."""
        return self.creation.method in _OFFERS

    @property
    def is_action(self) -> bool:
        """Whether it is about an action."""
        return self.creation.method.startswith("Action")

    @property
    def place(self) -> str:
        """Where the name is written."""
        named = self.creation.given("srv_name")
        return self.creation.source.at(named or self.creation.call)

    @property
    def written(self) -> str:
        """The name as the code writes it; empty if it is not known."""
        named = self.creation.given("srv_name")
        value = self.sources.value(self.creation.source, named)
        return value if isinstance(value, str) else ""

    @cached_property
    def name(self) -> str:
        """The full name without the first slash; empty if it is not known."""
        return name_in(self.sources.node_name(self.creation), self.written) if self.written else ""

    @cached_property
    def type(self) -> str:
        """The full name of its type; empty if it is not known."""
        given = self.creation.given("srv_type")
        return self.sources.resolve(self.creation.source, given) or ""

    @property
    def package(self) -> str:
        """The name of the Python package that has it."""
        return self.creation.source.name.partition(".")[0]

    def is_kept_as(self, kept: ast.expr) -> bool:
        """Return whether it is assigned to a variable or an attribute of this name."""
        name = last_name(kept)
        return bool(name) and self.creation.kept.rpartition(".")[2] == name

    def renamed(self, name: str) -> str:
        """Return the call that creates it with another name, as it is written."""
        return with_arguments(self.creation.call, {id(self.creation.given("srv_name")): repr(name)})


def service_ends(sources: NodeSources) -> Iterator[ServiceEnd]:
    """Yield the servers and clients of services and actions of a package."""
    for creation in sources.creations:
        if creation.method in (*_OFFERS, *_CALLS):
            yield ServiceEnd(creation, sources)
    for source in sources.sources.values():
        for owner, function, node in sources.scoped(source):
            name = (sources.resolve(source, node.func) or "") if isinstance(node, ast.Call) else ""
            if (
                isinstance(node, ast.Call)
                and name.startswith("rclpy.action.")
                and name.endswith(("Client", "Server"))
            ):
                given = dict(zip(_OF_ACTIONS, node.args, strict=False))
                method = name.rpartition(".")[2]
                yield ServiceEnd(Creation(method, node, given, owner, function, source), sources)


def server_for(
    client: ServiceEnd,
    ends: Collection[ServiceEnd],
    own: Collection[str] = (),
    *,
    is_missed: bool = False,
    is_alone: bool = True,
) -> ServiceEnd | None:
    """Return the server that a client without one probably means; None if that is not plain.

    Args:
        client: the client.
        ends: all ends of the workspace.
        own: the packages of the workspace, whose types only they use.
        is_missed: whether it was seen that nobody answers the client.
        is_alone: whether no other program, such as a simulator, may offer a service.
    """
    served = {end.name for end in ends if end.is_server}
    if client.name in served or not client.name:
        return None
    of_kind = [end for end in ends if end.is_action is client.is_action]
    # A node seldom calls itself.
    lone = [
        end
        for end in _uncalled(ends)
        if end in of_kind and (is_missed or made_in(end) is not made_in(client))
    ]
    alike = [end for end in lone if not client.type or end.type in ("", client.type)]
    near = [end for end in alike if is_near_miss(client.name, end.name)]
    if not near and (server := _only_one_of_its_type(client, of_kind, lone, served)):
        is_own = is_missed or client.type.partition(".")[0] in own
        is_told = is_own or (is_alone and _are_of_one_name(client, server))
        near = [server] if is_told else []
    return next(iter(near), None)


def _uncalled(ends: Collection[ServiceEnd]) -> list[ServiceEnd]:
    """Return the servers that no client calls, as far as their names are known."""
    called = {end.name for end in ends if not end.is_server}
    return [end for end in ends if end.is_server and end.name and end.name not in called]


def _only_one_of_its_type(
    client: ServiceEnd, of_kind: Collection[ServiceEnd], lone: Collection[ServiceEnd], served: Collection[str]
) -> ServiceEnd | None:
    """Return the only server of a client's type, if the client is the only one of that type without a server."""
    alike = [server for server in lone if client.type and server.type == client.type]
    clients = {end.name for end in of_kind if end.type == client.type and not end.is_server}
    is_open = any(end.is_server and not end.name for end in of_kind)  # a server whose name is not known
    is_only = len({server.name for server in alike}) == 1 and len(clients.difference(served)) == 1
    return alike[0] if is_only and not is_open else None


def service_faults(
    files: Iterable[NodeSources],
    own: Collection[str],
    moved: Collection[str],
    partners: Partners | None = None,
    *,
    is_alone: bool = True,
) -> Iterator[Finding]:
    """Yield clients of a service that no node of the workspace offers, while another name is probably meant."""
    partners = partners or Partners()
    ends = [end for sources in files for end in service_ends(sources)]
    for client in ends:
        server = server_for(client, ends, own, is_alone=is_alone) if not client.is_server else None
        if server is None or not {client.package, server.package, client.name, server.name}.isdisjoint(moved):
            continue
        is_open = any(end.is_server and not end.name and end.type in ("", client.type) for end in ends)
        is_slip = is_near_miss(client.name, server.name)
        if is_open or not (is_slip or partners.are_together(client, server)):
            continue
        if partners.may_be_elsewhere(client.name) or partners.may_be_elsewhere(server.name):
            continue
        what = "action" if client.is_action else "service"
        name = f"/{server.name}"
        shown = [end.creation.source.shown.rpartition("/")[2] for end in (client, server)]
        who = shown if shown[0] != shown[1] else ["This node", "another one"]
        cause = (
            f"{who[0]} calls the {what} '/{client.name}', but {who[1]} offers {name!r}, so nothing responds."
        )
        other = server.renamed(f"/{client.name}")
        fix = f"write `{client.renamed(name)}` here, or `{other}` in {server.place}"
        yield Finding("topic-near-miss", cause, client.place, fix)


def _are_of_one_name(client: ServiceEnd, server: ServiceEnd) -> bool:
    """Return whether two names differ only in their namespaces, of which a `~` stands for the own node, or in the order of their words."""
    names = (client.name, server.name)
    if client.written.startswith("~") and len({name.rpartition("/")[2] for name in names}) == 1:
        return True
    shorter, longer = sorted(names, key=lambda text: len(words_of(text)))
    last, less, more = ({*words_of(text)} for text in (longer.rpartition("/")[2], shorter, longer))
    return last <= less <= more
