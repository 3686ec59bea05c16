"""A line between a browser and the lab that can be cut, as a network or a computer that sleeps cuts it."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections.abc import Iterator
from dataclasses import replace
from urllib.parse import urlsplit

from browsing import Lab

from deadlines import DEADLINE


class Line:
    """Passes on, both ways, what comes at a port of its own.

    Args:
        port: of 127.0.0.1, where it leads.

    Attributes:
        port: where it begins.
    """

    def __init__(self, port: int) -> None:
        self._target = "127.0.0.1", port
        self._entrance = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._entrance.getsockname()[1])
        self._lock = threading.Lock()
        self._pairs: set[tuple[socket.socket, socket.socket]] = set()
        self._threads = [threading.Thread(target=self._accept)]
        self._threads[0].start()

    def cut(self) -> None:
        """End what is connected; who connects anew gets through."""
        with self._lock:
            for pair in self._pairs:
                for end in pair:
                    _shut(end)

    def close(self) -> None:
        """End it. Closing twice does no harm."""
        _shut(self._entrance)
        self.cut()
        for thread in self._threads:
            thread.join(DEADLINE)
        self._entrance.close()

    def _accept(self) -> None:
        while True:
            try:
                near, _ = self._entrance.accept()
            except OSError:
                return
            thread = threading.Thread(target=self._connect, args=[near])
            self._threads.append(thread)
            thread.start()

    def _connect(self, near: socket.socket) -> None:
        with near, contextlib.suppress(OSError), socket.create_connection(self._target) as far:
            pair = near, far
            with self._lock:
                self._pairs.add(pair)
            back = threading.Thread(target=_pass_on, args=[far, near])
            back.start()
            _pass_on(near, far)
            back.join()
            with self._lock:
                self._pairs.remove(pair)


def _pass_on(source: socket.socket, target: socket.socket) -> None:
    """Pass on what comes until one of both ends, and end the other."""
    with contextlib.suppress(OSError):
        while data := source.recv(65536):
            target.sendall(data)
    _shut(source)
    _shut(target)


def _shut(end: socket.socket) -> None:
    with contextlib.suppress(OSError):
        end.shutdown(socket.SHUT_RDWR)


@contextlib.contextmanager
def line_to(lab: Lab) -> Iterator[tuple[Lab, Line]]:
    """Yield the lab as it is reached over a line that can be cut, and the line."""
    port = urlsplit(lab.address).port
    assert port is not None
    line = Line(port)
    try:
        yield replace(lab, address=lab.address.replace(f":{port}/", f":{line.port}/")), line
    finally:
        line.close()
