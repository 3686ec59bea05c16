"""Messages on their way from the subscriptions to the disk."""

from __future__ import annotations

import threading
from typing import Any

from ros2lab.recording.track import Track


class Buffer:
    """Messages that were received and are not yet written, up to a number of bytes."""

    def __init__(self, most: int) -> None:
        self.dropped = 0
        self.wake = threading.Event()
        self._most = most
        self._lock = threading.Lock()
        self._bytes = 0
        self._items: list[tuple[Track, bytes, dict[str, Any]]] = []

    def put(self, track: Track, data: bytes, info: dict[str, Any]) -> None:
        """Add a message; if there is no space for it, it is dropped and counted."""
        with self._lock:
            if self._bytes + len(data) > self._most:
                self.dropped += 1
                return
            self._bytes += len(data)
            self._items.append((track, data, info))
        if 2 * self._bytes > self._most:
            self.wake.set()

    def take(self) -> list[tuple[Track, bytes, dict[str, Any]]]:
        """Remove and return all messages, in the order in which they were added."""
        with self._lock:
            items, self._items, self._bytes = self._items, [], 0
        return items

    def wait(self, timeout: float) -> None:
        """Wait until the buffer is half full, or the time is up."""
        self.wake.wait(timeout)
        self.wake.clear()
