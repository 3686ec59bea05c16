"""The `ros2` command: how long it takes, and whether it names everything on a graph that has just begun."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack

from place import own_place
from program import Program
from row import Quantity, Row

from ros2lab import environment

NODES = 10
COMMAND_TIMEOUT = 60.0  # s
BARE_NODE = "import rclpy; rclpy.init(); rclpy.create_node('bare'); rclpy.shutdown()"
SHORT_COMMAND = 0.25  # s
GRAPH_COMMAND = 0.5  # s
COMPLETED = "ros2 topic li"


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Time commands beside the Python that they run in, and look at ten nodes as soon as they are there."""
    times, rounds = (3, 2) if is_quick else (21, 100)
    with own_place() as place:
        python = _seconds([sys.executable, "-c", "pass"], place.environ, times)
        node = _seconds([sys.executable, "-c", BARE_NODE], place.environ, times)
        completing = {
            **place.environ,
            "_ARGCOMPLETE": "1",
            "_ARGCOMPLETE_STDOUT_FILENAME": str(place.folder / "offered"),
            "COMP_LINE": COMPLETED,
            "COMP_POINT": str(len(COMPLETED)),
        }
        bare = (python, "a Python that does nothing")
        rows = [
            _row("ros2 --help", place.environ, times, *bare),
            _row("ros2 pkg list", place.environ, times, *bare),
            _row("ros2", completing, times, *bare, title=f"completion of `{COMPLETED}`"),
            _row(
                "ros2 topic list", place.environ, times, node, "a node that does nothing", most=GRAPH_COMMAND
            ),
        ]
    seconds: list[float] = []
    missing: list[str] = []
    for number in range(rounds):
        for kind, absent, took in _look_at_new_nodes(number):
            seconds.append(took)
            if absent:
                missing.append(f"{kind} list: {' '.join(sorted(absent))}")
        advance((number + 1) / rounds)
    return [
        *rows,
        Row(
            f"`topic list` and `node list` on {NODES} nodes that began just before",
            Quantity(len(missing), "incomplete"),
            "asked, each kind half of them",
            Quantity(2 * rounds, "times"),
            {"value": 0},
            "; ".join([f"took {Quantity.of_samples(seconds, 's')}", *missing]),
        ),
    ]


def _row(
    line: str,
    environ: Mapping[str, str],
    times: int,
    peer: Sequence[float],
    peer_name: str,
    *,
    most: float = SHORT_COMMAND,
    title: str = "",
) -> Row:
    took = Quantity.of_samples(_seconds(line.split(), environ, times), "s")
    return Row(title or f"`{line}`", took, peer_name, Quantity.of_samples(peer, "s"), {"value": most})


def _seconds(command: Sequence[str], environ: Mapping[str, str], times: int) -> list[float]:
    """Return how long each of so many runs took."""
    return [_run(command, environ)[1] for _ in range(times)]


def _run(command: Sequence[str], environ: Mapping[str, str]) -> tuple[set[str], float]:
    """Return the lines that a command prints, and how long it took in s."""
    begin = time.perf_counter()
    done = subprocess.run(
        command, env=environ, capture_output=True, text=True, timeout=COMMAND_TIMEOUT, check=True
    )
    return set(done.stdout.splitlines()), time.perf_counter() - begin


def _look_at_new_nodes(number: int) -> Iterator[tuple[str, set[str], float]]:
    """Yield of two commands what each lists, the names that are missing, and how long it took in s.

    Args:
        number: of the round; each has another domain, so that none meets the nodes of the one before.
    """
    with ExitStack() as stack:
        place = stack.enter_context(own_place())
        domain = str(1 + (int(place.environ["ROS_DOMAIN_ID"]) + number) % environment.LARGEST_SAFE_DOMAIN)
        environ = {**place.environ, "ROS_DOMAIN_ID": domain}
        fleet = [
            stack.enter_context(Program("small_node.py", str(one), environ=environ)) for one in range(NODES)
        ]
        for node in fleet:
            node.hear()
        names = {
            "topic": {"/rosout", "/parameter_events"}
            | {f"/{kind}_{one}" for one in range(NODES) for kind in ("said", "heard")},
            "node": {f"/small_{one}" for one in range(NODES)},
        }
        for kind in sorted(names, reverse=bool(number % 2)):  # each is as often the first
            named, took = _run(["ros2", kind, "list"], environ)
            yield kind, names[kind] - named, took
