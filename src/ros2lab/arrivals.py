"""When the messages of a topic came, and the newest of them, however many they are."""

from __future__ import annotations

import itertools
import threading
from collections import deque
from dataclasses import dataclass

import numpy as np

WINDOW = 10.0  # s over which rate and jitter are taken
FEWEST = 10  # messages, of slower topics
MOST = 20_000  # messages; 10 s at 2 kHz


@dataclass(frozen=True)
class Rhythm:
    """How regularly messages come.

    Attributes:
        count: messages received in all.
        rate: mean rate in Hz, None for fewer than two messages.
        jitter: standard deviation of the gaps in s, None for fewer than three messages.
        age: how long ago the last one came, in s; None if there is none.
        patience: after this time in s without a message the topic is called silent.
    """

    count: int
    rate: float | None
    jitter: float | None
    age: float | None
    patience: float


class Arrivals:
    """Counts messages as they come, and keeps their times and the newest one.

    `add` is cheap, so that a topic with 1 kHz can call it; another thread reads.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._times: deque[float] = deque(maxlen=MOST)
        self._count = 0
        self._newest: bytes | None = None

    @property
    def count(self) -> int:
        """Messages received in all."""
        return self._count

    def add(self, time: float, message: bytes) -> None:
        """Take note of a message.

        Args:
            time: when it came, in s of a clock that never goes back.
            message: as it was sent.
        """
        with self._lock:
            self._times.append(time)
            self._count += 1
            self._newest = message

    def newest(self) -> tuple[int, bytes | None]:
        """Return how many messages have come, and the last one, None if there is none."""
        with self._lock:
            return self._count, self._newest

    def rhythm(self, now: float) -> Rhythm:
        """Return rate and jitter over the last `WINDOW` seconds, of slow topics over the last `FEWEST` messages.

        Args:
            now: in s, of the clock of `add`.
        """
        with self._lock:
            recent = list(itertools.takewhile(lambda time: time >= now - WINDOW, reversed(self._times)))
            if len(recent) < FEWEST:
                recent = list(itertools.islice(reversed(self._times), FEWEST))
            count = self._count
        if not recent:
            return Rhythm(count, None, None, None, 1.0)
        gaps = -np.diff(recent)  # the newest is first
        span = recent[0] - recent[-1]
        rate = len(gaps) / span if span > 0 else None
        jitter = float(np.std(gaps, ddof=1)) if len(gaps) > 1 else None
        return Rhythm(count, rate, jitter, now - recent[0], max(1.0, 4 / rate) if rate else 1.0)
