"""The DDS participants of this machine: how many there are, and a way to make them announce themselves.

A participant is what a process with ROS nodes is to DDS. The kernel lists the UDP ports on which participants
listen, so one can be known before it was heard. Ports follow from the domain, as RTPS 2.3, section 9.6.1.1, says.
"""

from __future__ import annotations

import contextlib
import os
import re
import socket
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

FIRST_PORT = 7400
PORTS_PER_DOMAIN = 250
LAST_DOMAIN = 232  # beyond it there are not enough ports
FIRST_UNICAST = 10  # two ports for each participant from here on: one for discovery, one for data
MULTICAST_GROUP = "239.255.0.1"
LOCALHOST = "127.0.0.1"
GHOST_LIFETIME = 1  # s
MAX_ANSWER = 65536  # bytes
HEARTBEAT = 0x07  # the kind of message that tells how much there is to be had
WRITERS = b"\x00\x00\x03\xc2"  # who announces a participant's writers
READERS = b"\x00\x00\x04\xc2"

# In an announcement: an IPv4 address and port where the participant hears of others.
_LOCATOR = re.compile(rb"\x32\x00\x18\x00\x01\x00\x00\x00(..)\x00\x00", re.DOTALL)


class Listener(NamedTuple):
    """A port on which a participant listens for others.

    Args:
        port: its number.
        inode: of the socket.
        is_read: whether everything that has arrived there has also been read.
    """

    port: int
    inode: str
    is_read: bool


def listeners(domain: int) -> list[Listener] | None:
    """Return where the participants of a domain listen on this machine, one entry each.

    None if the kernel does not tell.
    """
    try:
        lines = [line.split() for name in ("udp", "udp6") for line in _lines(Path("/proc/self/net", name))]
    except OSError:
        return None
    base = FIRST_PORT + PORTS_PER_DOMAIN * domain
    found = {}
    for words in lines:
        port = int(words[1].rpartition(":")[2], 16)
        if base + FIRST_UNICAST <= port < base + PORTS_PER_DOMAIN:
            found[port] = Listener(port, words[9], words[4].endswith(":00000000"))
    # A participant has both of its ports; another program may happen to have one of them.
    return [listener for port, listener in sorted(found.items()) if port % 2 == 0 and port + 1 in found]


def sockets(process: str | int = "self") -> set[str]:
    """Return the inodes of the sockets of a process; none if it is not there or not ours to see."""
    found = set()
    try:
        for file in Path("/proc", str(process), "fd").iterdir():
            target = str(file.readlink())
            if target.startswith("socket:["):
                found.add(target[8:-1])
    except OSError:
        pass  # it has ended, or belongs to somebody else
    return found


def shares_memory() -> bool:
    """Tell whether a participant of this process has memory that it shares, or whether that cannot be known."""
    try:
        return "/fastrtps_" in Path("/proc/self/maps").read_text()
    except OSError:
        return True


def is_running(listener: Listener) -> bool:
    """Tell whether the process that listens has something to do, such as to read what has come.

    One that was stopped, such as by Ctrl-Z, hangs or never reads has not.
    """
    for folder in Path("/proc").glob("[0-9]*"):
        if listener.inode in sockets(folder.name):
            return any(_state(thread) in "RD" for thread in folder.glob("task/*/stat"))
    return False


def _state(thread: Path) -> str:
    try:
        return thread.read_text().rpartition(")")[2].split()[0]
    except OSError:
        return "X"  # it has ended meanwhile


class Inquiry:
    """Asks participants to announce themselves, to us and to our own participant, and tells who has answered.

    Fast DDS answers a new participant once, at once, and loses an answer that arrives while it is still opening
    its own ports; whoever has answered too early is silent for seconds. So a ghost, which has nothing and is
    gone after a second, announces itself with our addresses: the answers come to our participant, which can
    hear by now, and to a socket of ours.

    Args:
        domain: the domain's id.
        own: where our participant listens.
        reaches_out: whether participants of other machines shall answer, too.

    Attributes:
        answered: the ports on this machine from which an answer came.
        participants: of those that said they belong to ROS the ids and, on this machine, the ports.
        endpoints: how many writers and readers they have had, by their ids and `WRITERS` or `READERS`.
    """

    def __init__(self, domain: int, own: Listener, *, reaches_out: bool) -> None:
        self.answered = {own.port}
        self.participants: dict[bytes, int | None] = {}
        self.endpoints: dict[tuple[bytes, bytes], int] = {}
        self._group = (MULTICAST_GROUP, FIRST_PORT + PORTS_PER_DOMAIN * domain)
        self._own = own
        self._address = _own_address(self._group) if reaches_out else None
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("", 0))
        self._socket.setblocking(False)

    def ask(self, present: list[Listener]) -> None:
        """Ask those who have not told everything yet; an answer may be lost."""
        greeting = self._greeting(LOCALHOST)
        incomplete = {port for who, port in self.participants.items() if not self.has_told(who)}
        for listener in present:
            if listener.port not in self.answered - incomplete:
                self._socket.sendto(greeting, (LOCALHOST, listener.port))
        if self._address:
            with contextlib.suppress(OSError):  # the network has gone
                self._socket.sendto(self._greeting(self._address), self._group)

    def has_told(self, participant: bytes) -> bool:
        """Tell whether it is known how many endpoints a participant has had."""
        return all((participant, kind) in self.endpoints for kind in (WRITERS, READERS))

    def listen(self) -> None:
        """Take the answers that have come."""
        with contextlib.suppress(BlockingIOError):
            while True:
                answer, (address, _) = self._socket.recvfrom(MAX_ANSWER)
                is_here = address in (LOCALHOST, self._address)
                ports = [int.from_bytes(port, "little") for port in _LOCATOR.findall(answer) if is_here]
                self.answered.update(ports)
                sender = answer[8:20]
                if b"enclave=" in answer:  # so ROS marks its participants
                    self.participants[sender] = ports[0] if ports else None
                if sender in self.participants:
                    self.endpoints.update(((sender, kind), n) for kind, n in _endpoint_counts(answer))

    def close(self) -> None:
        """Stop listening."""
        self._socket.close()

    def _greeting(self, address: str) -> bytes:
        ports = (self._own.port, self._socket.getsockname()[1])
        return _announcement([struct.pack("<iI12x4s", 1, port, socket.inet_aton(address)) for port in ports])


def _lines(path: Path) -> Iterator[str]:
    with path.open() as file:
        next(file)
        yield from file


def _own_address(target: tuple[str, int]) -> str | None:
    """Return the address from which this machine sends to another one, None if there is no network."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(target)
        except OSError:
            return None
        return str(probe.getsockname()[0])


def _announcement(locators: list[bytes]) -> bytes:
    """Return an RTPS message with which a new participant announces itself (RTPS 2.3, section 8.5.3)."""
    version, vendor = b"\x02\x02", b"\x01\x0f"  # Fast DDS understands its own kind best
    prefix = vendor + os.urandom(10)
    parameters = [
        (0x0015, version + b"\0\0"),
        (0x0016, vendor + b"\0\0"),
        (0x0050, prefix + b"\x00\x00\x01\xc1"),
        *((0x0032, locator) for locator in locators),  # where it hears about participants
        (0x0031, locators[0]),  # where it would receive data
        (0x0002, struct.pack("<iI", GHOST_LIFETIME, 0)),
        (0x0058, struct.pack("<I", 0b101011)),  # it hears of participants, writers and readers, and has none
        (0x0001, b""),
    ]
    payload = b"\x00\x03\x00\x00" + b"".join(
        struct.pack("<HH", kind, len(value)) + value for kind, value in parameters
    )
    reader, writer, number = b"\x00\x01\x00\xc7", b"\x00\x01\x00\xc2", struct.pack("<iI", 0, 1)
    data = struct.pack("<HH", 0, 16) + reader + writer + number + payload
    return b"RTPS" + version + vendor + prefix + struct.pack("<BBH", 0x15, 0b101, len(data)) + data


def _endpoint_counts(message: bytes) -> Iterator[tuple[bytes, int]]:
    """Yield `WRITERS` or `READERS` and how many of them the sender of an RTPS message says it has announced."""
    place = 20
    while place + 4 <= len(message):
        kind, flags, length = struct.unpack_from("<BBH", message, place)
        if kind == HEARTBEAT and length >= 28 and flags & 1:
            writer, last = message[place + 8 : place + 12], struct.unpack_from("<iI", message, place + 20)[1]
            if writer in (WRITERS, READERS):
                yield writer, last
        if not length:
            return
        place += 4 + length
