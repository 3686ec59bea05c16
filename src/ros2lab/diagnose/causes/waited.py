"""Requests that nobody answers: what a program waits for, and why the result of a request is None."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.service_faults import ServiceEnd, server_for
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.names_there import all_service_ends
from ros2lab.diagnose.printed.spots import Spot, spot_of
from ros2lab.diagnose.sources.own_functions import own_function, returned
from ros2lab.diagnose.sources.python_source import PythonSource, own_nodes

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


_OF_NONE = re.compile(r"'NoneType' object has no attribute '(?P<name>\w+)'")
_ASKS = {"call_async": "wait_for_service", "send_goal_async": "wait_for_server"}
_Request = tuple[ast.Call, ast.Call, PythonSource]  # the request, the wait for its response, and their file
_DEEPEST = 3  # functions followed that return the result


def of_unanswered(error: ErrorText, look: Look) -> Finding | None:
    """Say why a request got no response in the time that the code waits; None if that is not the error."""
    match = _OF_NONE.match(error.report.message) if error.report else None
    if match is None:
        return None
    spot = spot_of(error.report, look)
    for node in spot.nodes:
        if isinstance(node, ast.Attribute) and node.attr == match["name"]:
            for request, wait, source in _asked(node.value, spot):
                return _told(request, wait, source, ast.unparse(node.value), look)
    return None


def _asked(value: ast.expr, spot: Spot, depth: int = _DEEPEST) -> Iterator[_Request]:
    """Yield the request whose result a value is, with the call that waits for it for a limited time."""
    for result in [value] if isinstance(value, ast.Call) else spot.assigned(ast.unparse(value)):
        match result:
            case ast.Call(func=ast.Attribute(attr="result", value=future), args=[]):
                yield from _waited(future, spot)
            case ast.Call(func=func) if depth and (own := own_function(spot.file, func)):
                for node in returned(own[1]):
                    if isinstance(node, ast.Return) and node.value is not None:
                        yield from _asked(node.value, Spot(own[0], node.lineno), depth - 1)


def _waited(future: ast.expr, spot: Spot) -> Iterator[_Request]:
    """Yield the request that gave a future, with the calls that wait for it for a limited time."""
    made = [call for call in spot.assigned(ast.unparse(future)) if isinstance(call, ast.Call)]
    requests = [call for call in made if getattr(call.func, "attr", "") in _ASKS]
    for call in own_nodes(spot.function) if spot.function else ():
        if isinstance(call, ast.Call) and requests and spot.source:
            names = [ast.unparse(argument) for argument in call.args]
            is_limited = len(names) > 3 or any(keyword.arg == "timeout_sec" for keyword in call.keywords)
            is_wait = ast.unparse(call.func).endswith("spin_until_future_complete")
            if is_wait and is_limited and ast.unparse(future) in names[1:]:
                yield requests[0], call, spot.file


def _told(request: ast.Call, wait: ast.Call, source: PythonSource, value: str, look: Look) -> Finding | None:
    ends = all_service_ends(look)
    func = request.func
    assert isinstance(func, ast.Attribute)
    client = next((end for end in ends if not end.is_server and end.is_kept_as(func.value)), None)
    if client is None or not client.name:
        return None
    cause = f"{value} is None: nothing answered /{client.name} in the time that line {wait.lineno} waits."
    if server := server_for(client, ends, is_missed=True):
        cause = f"{cause} {server.creation.source.shown} offers /{server.name} instead."
        return Finding("made-wrong", cause, client.place, f"write `{client.renamed(f'/{server.name}')}`")
    starts = [
        start for end in ends if end.is_server and end.name == client.name for start in _starts(end, look)
    ]
    start = f"start the program that offers it first, in another terminal: `{starts[0]}`" if starts else ""
    waits = _with_wait(request, ast.unparse(wait.args[0]), client, source)
    if not start and not waits:
        return None
    return Finding("made-wrong", cause, source.at(request), "; and ".join(filter(None, (start, waits))))


def _with_wait(request: ast.Call, node: str, client: ServiceEnd, source: PythonSource) -> str:
    """Return how to wait for the server before a request; empty if the code does so already."""
    func = request.func
    assert isinstance(func, ast.Attribute)
    kept, method = ast.unparse(func.value), _ASKS[func.attr]
    loop = f"`while not {kept}.{method}(timeout_sec=1.0):`"
    body = f"and, indented below it, `{node}.get_logger().info('waiting for {client.name}')`"
    there = [n for n in source.calls if ast.unparse(n.func).endswith(f".{method}")]
    if not there:
        return f"write above line {request.lineno} {loop} {body}"
    bare = [n for n in source.nodes if isinstance(n, ast.Expr) and n.value in there]
    return f"write instead of line {bare[0].lineno}, whose result nothing uses, {loop} {body}" if bare else ""


def _starts(server: ServiceEnd, look: Look) -> Iterator[str]:
    """Yield the commands that start the program with a server."""
    for package in look.packages:
        for point in package.points:
            if point.module == server.creation.source.name:
                yield f"ros2 run {package.name} {point.name}"
