"""Explains that a program waits for a service or an action that nobody offered while it ran."""

from __future__ import annotations

import ast

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.service_faults import ServiceEnd, server_for
from ros2lab.diagnose.printed.names_there import all_service_ends
from ros2lab.diagnose.printed.spots import Spot

_WAITS = frozenset(("wait_for_service", "wait_for_server"))


def waited_for(look: Look, spot: Spot) -> Finding | None:
    """Return the fault of a line in which a program waits for a server; None if the line does something else.

    Args:
        look: the workspace.
        spot: the line at which the program was stopped, or goes on waiting.
    """
    source = spot.source
    ends = all_service_ends(look)
    for call in spot.calls:
        func = call.func
        if source is None or not isinstance(func, ast.Attribute) or func.attr not in _WAITS:
            continue
        client = next((end for end in ends if not end.is_server and end.is_kept_as(func.value)), None)
        if client is not None and client.name:
            return _of_client(client, ends, source.at(spot.line))
    return None


def _of_client(client: ServiceEnd, ends: list[ServiceEnd], place: str) -> Finding:
    what = "action" if client.is_action else "service"
    waits = f"Line {place.rpartition(':')[2]} waits for the {what} /{client.name}"
    offered = [end for end in ends if end.is_server and end.is_action is client.is_action]
    if same := next((end for end in offered if end.name == client.name), None):
        cause = f"{waits}, and {same.creation.source.shown}, which offers it, did not answer during the run."
        return Finding(
            "not-spinning", cause, place, "see why that program does not run or does not spin its node"
        )
    server = server_for(client, ends, is_missed=True)
    if server is not None:
        cause = f"{waits}, but nobody offers that: {server.creation.source.shown} offers /{server.name}."
        fix = f"write `{client.renamed(f'/{server.name}')}` in {client.place}"
        return Finding("topic-near-miss", cause, client.place, fix)
    names = ", ".join(sorted({f"/{end.name}" for end in offered if end.name})) or "none"
    cause = (
        f"{waits}, which no program of this workspace offers (they offer {names}), so it waits forever here."
    )
    return Finding(
        "not-running",
        cause,
        place,
        f"start the node that offers /{client.name}, or write that service in a node",
    )
