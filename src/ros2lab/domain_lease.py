"""Lease a ROS domain of this machine; needs no ROS."""

from __future__ import annotations

import contextlib
import socket

# Above the domains whose ports Linux hands out to other programs. From the last one down: tests of packages
# that lease a domain in the same way begin at the first.
DOMAINS = range(232, 214, -1)


def leased(lease: socket.socket) -> int:
    """Return a domain that nobody else on this machine leases until the lease is closed.

    Args:
        lease: a Unix socket, which is bound to the domain's name.

    Raises:
        RuntimeError: if all of the domains that can be leased are leased.
    """
    for domain in DOMAINS:
        with contextlib.suppress(OSError):
            lease.bind(f"\0ros2lab-private-domain-{domain}")
            return domain
    raise RuntimeError(f"On this machine {len(DOMAINS)} checks run at once: wait for one of them to end.")
