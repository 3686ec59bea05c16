"""The DDS participants of this machine: how many there are, and a way to make them announce themselves.

A participant is what a process with ROS nodes is to DDS. The kernel lists the UDP ports on which participants
listen, so one can be known before it was heard. Ports follow from the domain, as RTPS 2.3, section 9.6.1.1, says.
"""

from __future__ import annotations

import contextlib
import math
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
VERSION, VENDOR = b"\x02\x02", b"\x01\x0f"  # Fast DDS understands its own kind best
ACKNACK, HEARTBEAT, GAP, INFO_DST, DATA = 0x06, 0x07, 0x08, 0x0E, 0x15  # RTPS 2.3, section 9.4.5.1
WRITERS = b"\x00\x00\x03\xc2"  # who announces a participant's writers
READERS = b"\x00\x00\x04\xc2"
PREFIX_LENGTH = 12  # bytes of an endpoint's id that tell its participant
MOST_ASKED = 256  # as many announcements as one ACKNACK can name
MOST_NUMBERED = 65536  # announcements of one participant; a message that speaks of more is no honest one

# In an announcement: an IPv4 address and port where the participant hears of others.
_LOCATOR = re.compile(rb"\x32\x00\x18\x00\x01\x00\x00\x00(..)\x00\x00", re.DOTALL)
# And the id of the writer or reader that is announced.
_ENDPOINT = re.compile(rb"\x5a\x00\x10\x00(.{16})", re.DOTALL)


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
    """Return whether a participant of this process has memory that it shares, or whether that cannot be known."""
    try:
        return "/fastrtps_" in Path("/proc/self/maps").read_text()
    except OSError:
        return True


def is_running(listener: Listener) -> bool:
    """Return whether the process that listens has something to do, such as to read what has come.

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
    hear by now, and to a socket of ours. There the ghost also asks for what each participant has announced, so
    that it is known for which writers and readers our own participant is to wait.

    Args:
        domain: the domain's id.
        own: where our participant listens.
        reaches_out: whether participants of other machines shall answer, too.

    Attributes:
        answered: the ports on this machine from which an answer came.
        participants: of those that said they belong to ROS the ids and, on this machine, the ports.
        endpoints: the ids of the writers and readers of whoever has answered.
    """

    def __init__(self, domain: int, own: Listener, *, reaches_out: bool) -> None:
        self.answered = {own.port}
        self.participants: dict[bytes, int | None] = {}
        self.endpoints: set[bytes] = set()
        self._places: dict[bytes, tuple[str, int]] = {}  # where participants hear
        self._missing: dict[tuple[bytes, bytes], set[int]] = {}  # announcements, by who and of what
        self._told: dict[tuple[bytes, bytes], set[int]] = {}
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
        """Return whether it is known which endpoints a participant has."""
        return all(self._missing.get((participant, kind)) == set() for kind in (WRITERS, READERS))

    def listen(self) -> None:
        """Take the answers that have come."""
        with contextlib.suppress(BlockingIOError):
            while True:
                answer, (address, _) = self._socket.recvfrom(MAX_ANSWER)
                is_here = address in (LOCALHOST, self._address)
                ports = [int.from_bytes(port, "little") for port in _LOCATOR.findall(answer)]
                if is_here:
                    self.answered.update(ports)
                sender = answer[8:20]
                if ports:
                    self._places[sender] = (address, ports[0])
                if b"enclave=" in answer:  # so ROS marks its participants
                    self.participants[sender] = ports[0] if ports and is_here else None
                self._read(answer, sender)

    def close(self) -> None:
        """Stop listening."""
        self._socket.close()

    def _read(self, answer: bytes, sender: bytes) -> None:
        """Take from an answer what its sender has announced, and ask for what is missing."""
        ghost = b""
        for kind, body in _submessages(answer):
            if kind == INFO_DST:
                ghost = body[:PREFIX_LENGTH]
                continue
            place = 8 if kind == DATA else 4
            writer = body[place : place + 4]
            if writer not in (WRITERS, READERS):
                continue
            key = sender, writer
            told = self._told.setdefault(key, set())
            if kind == DATA:
                told.add(_number(body, 12))
                self.endpoints.update(_ENDPOINT.findall(body))
            elif kind == GAP:
                told |= _gap(body)
            elif kind == HEARTBEAT:
                self._missing[key] = _numbers(_number(body, 8), _number(body, 16) + 1)
            if key in self._missing:
                self._missing[key] -= told
            if kind == HEARTBEAT and self._missing[key] and ghost and sender in self._places:
                question = _request(ghost, sender, writer, self._missing[key])
                with contextlib.suppress(OSError):
                    self._socket.sendto(question, self._places[sender])

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
    prefix = VENDOR + os.urandom(10)
    parameters = [
        (0x0015, VERSION + b"\0\0"),
        (0x0016, VENDOR + b"\0\0"),
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
    return b"RTPS" + VERSION + VENDOR + prefix + struct.pack("<BBH", DATA, 0b101, len(data)) + data


def _request(ghost: bytes, participant: bytes, writer: bytes, numbers: set[int]) -> bytes:
    """Return an RTPS message in which a ghost asks for announcements (RTPS 2.3, section 8.3.7.1)."""
    base = min(numbers)
    count = min(max(numbers) - base + 1, MOST_ASKED)
    words = [0] * math.ceil(count / 32)
    for place in (number - base for number in numbers if number - base < count):
        words[place // 32] |= 1 << (31 - place % 32)
    reader = writer[:3] + b"\xc7"
    body = reader + writer + struct.pack("<iII", 0, base, count) + struct.pack(f"<{len(words)}I", *words)
    body += struct.pack("<I", 1)  # the first of the ghost's questions
    return (
        b"RTPS" + VERSION + VENDOR + ghost
        + struct.pack("<BBH", INFO_DST, 1, PREFIX_LENGTH) + participant
        + struct.pack("<BBH", ACKNACK, 1, len(body)) + body
    )  # fmt: skip


def _submessages(message: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield kind and content of what an RTPS message is made of; big-endian ones, which nobody sends, are left out."""
    place = 20
    while place + 4 <= len(message):
        kind, flags, length = struct.unpack_from("<BBH", message, place)
        place += 4
        end = place + length if length else len(message)  # 0: as long as the message
        if flags & 1 and len(message) >= end >= place + (PREFIX_LENGTH if kind == INFO_DST else 24):
            yield kind, message[place:end]
        place = end


def _number(body: bytes, place: int) -> int:
    high, low = struct.unpack_from("<iI", body, place)
    return int(high << 32 | low)


def _gap(body: bytes) -> set[int]:
    """Return the numbers of which a GAP says that nothing is to be had under them any more."""
    base = _number(body, 16)
    numbers = _numbers(_number(body, 8), base)
    if len(body) >= 28:
        (count,) = struct.unpack_from("<I", body, 24)
        words = struct.unpack_from(f"<{(len(body) - 28) // 4}I", body, 28)
        for place in range(min(count, 32 * len(words))):
            if words[place // 32] >> (31 - place % 32) & 1:
                numbers.add(base + place)
    return numbers


def _numbers(first: int, end: int) -> set[int]:
    return set(range(first, min(end, first + MOST_NUMBERED)))
