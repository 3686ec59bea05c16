"""Locks that whoever holds them takes again, and such as may be taken again."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.locks import lock_faults
from ros2lab.diagnose.finding import Finding

NODE = """\
import threading
from threading import Lock
from rclpy.node import Node

GLOBAL = threading.Lock()


def report():
    with GLOBAL:
        print('here')


class Store(Node):
    def __init__(self):
        super().__init__('store')
        self.lock = MADE
        self.other = Lock()
        self.create_timer(0.5, self.arrives)

    def arrives(self):
        BODY

    def tell(self):
        with self.lock:
            print('told')

    def pass_on(self):
        self.tell()

    def free(self):
        print('free')
"""


def told(body: str, folder: Path, made: str = "threading.Lock()") -> list[Finding]:
    return [
        *lock_faults(
            sources_of(
                NODE.replace("BODY", body.replace("\n", "\n        ")).replace("MADE", made), folder, "store"
            )
        )
    ]


@pytest.mark.parametrize(
    ("body", "made"),
    [
        ("with self.lock:\n    self.tell()", "threading.Lock()"),
        ("with self.lock:\n    self.pass_on()", "Lock()"),
        ("with self.lock:\n    with self.lock:\n        self.free()", "threading.Lock()"),
        ("with self.lock:\n    self.lock.acquire()", "threading.Semaphore()"),
        ("with self.lock:\n    if self.other:\n        self.tell()", "threading.Semaphore(1)"),
        ("with self.other, self.lock:\n    for _ in range(3):\n        self.tell()", "threading.Lock()"),
        ("with GLOBAL:\n    report()", "threading.Lock()"),
    ],
)
def test_a_lock_that_is_taken_again_is_told(tmp_path: Path, body: str, made: str) -> None:
    (found,) = told(body, tmp_path, made)
    assert "waits forever" in found.cause
    assert "RLock" in found.fix


@pytest.mark.parametrize(
    ("body", "made"),
    [
        ("with self.lock:\n    self.tell()", "threading.RLock()"),
        ("with self.lock:\n    self.tell()", "threading.Condition()"),
        ("with self.lock:\n    self.tell()", "threading.Semaphore(2)"),
        ("with self.lock:\n    self.free()\nself.tell()", "threading.Lock()"),
        ("with self.other:\n    self.tell()", "threading.Lock()"),
        ("with self.lock:\n    self.create_timer(1.0, self.tell)", "threading.Lock()"),
        ("with self.lock:\n    self.later = lambda: self.tell()", "threading.Lock()"),
        ("with self.lock:\n    self.lock.acquire(blocking=False)", "threading.Lock()"),
        (
            "with self.lock:\n    self.lock.release()\n    self.tell()\n    self.lock.acquire()",
            "threading.Lock()",
        ),
        ("with self.lock:\n    report()", "threading.Lock()"),
    ],
)
def test_what_may_be_taken_is_left_alone(tmp_path: Path, body: str, made: str) -> None:
    assert told(body, tmp_path, made) == []
