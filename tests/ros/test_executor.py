"""The session's executor, beside what the session's own tests show of it."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator

import pytest
import rclpy
from rclpy.context import Context

from deadlines import DEADLINE
from ros2lab.executor import IsolatingExecutor


@pytest.fixture
def hasty_threads() -> Iterator[None]:
    """Let threads take turns after each microsecond, so that all orders of two of them are met."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(interval)


@pytest.mark.usefixtures("hasty_threads")
def test_it_is_shut_down_at_any_moment_without_a_word(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever shuts it down takes away what the spinning thread is about to wait for."""
    raised: list[BaseException | None] = []
    monkeypatch.setattr(threading, "excepthook", lambda told: raised.append(told.exc_value))
    for _ in range(20):
        context = Context()
        rclpy.init(context=context)
        executor = IsolatingExecutor(lambda *_: None, context=context)
        node = rclpy.create_node("waiting", context=context)
        executor.add_node(node)
        spinning = threading.Thread(target=executor.spin)
        spinning.start()
        executor.shutdown(DEADLINE)
        spinning.join(DEADLINE)
        assert not spinning.is_alive()
        node.destroy_node()
        context.try_shutdown()
    assert raised == []
