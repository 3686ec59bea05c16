"""Lease a ROS domain of this machine, and say how far it reaches; needs no ROS."""

from __future__ import annotations

import contextlib
import os
import socket
import time
from collections.abc import Iterable, Iterator

# Above the domains whose ports Linux hands out to other programs. From the last one down: tests of packages
# that lease a domain in the same way begin at the first. Not the very last: a program may use the one above its own.
DOMAINS = range(231, 214, -1)
TURN = "\0ros2lab-private-domains"  # the address that is taken by who leases several
PATIENCE = (
    120.0  # s to wait for one, where all are leased: about as long as another check takes beside others
)


class NoDomainError(RuntimeError):
    """All of the domains that can be leased are leased."""


def leased(lease: socket.socket, until: float = 0.0) -> int:
    """Return a domain that nobody else on this machine leases until the lease is closed.

    Args:
        lease: a Unix socket, which is bound to the domain's name.
        until: how long to wait for one, by the monotonic clock in s; 0 waits for `PATIENCE`.

    Raises:
        NoDomainError: if all of the domains that can be leased are leased until then.
    """
    names = {f"\0ros2lab-private-domain-{domain}": domain for domain in DOMAINS}
    return names[_bound(lease, names, until or time.monotonic() + PATIENCE)]


@contextlib.contextmanager
def in_turn() -> Iterator[float]:
    """Let only one lease several domains at a time: two that have a half of them each would wait for each other.

    Yields:
        The time by the monotonic clock until which it may wait for all of them, in s.

    Raises:
        NoDomainError: if somebody else takes them for so long.
    """
    with socket.socket(socket.AF_UNIX) as turn:
        _bound(turn, (TURN,), time.monotonic() + 2 * PATIENCE)
        yield time.monotonic() + PATIENCE


def _bound(lease: socket.socket, names: Iterable[str], until: float) -> str:
    """Bind a socket to the first of some names that is free, until a time of the monotonic clock; return the name."""
    while True:
        for name in names:
            with contextlib.suppress(OSError):
                lease.bind(name)
                return name
        if time.monotonic() >= until:
            raise NoDomainError(
                f"The {len(DOMAINS)} ROS domains for checks on this machine are taken; wait for a running check to end, then try again."
            )
        time.sleep(0.1)


@contextlib.contextmanager
def discovery(reach: str) -> Iterator[None]:
    """Let the contexts that are made meanwhile look for others only so far.

    Args:
        reach: a value of `ROS_AUTOMATIC_DISCOVERY_RANGE`, such as `LOCALHOST` or `OFF`.
    """
    own = {"ROS_AUTOMATIC_DISCOVERY_RANGE": reach, "ROS_STATIC_PEERS": ""}
    before = {name: os.environ.get(name) for name in own}
    os.environ.update(own)
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name, None)
            if value is not None:
                os.environ[name] = value
