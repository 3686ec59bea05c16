"""An executor in which a callback that raises does not end the others."""

from __future__ import annotations

import html
import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType

from rclpy.context import Context
from rclpy.exceptions import InvalidHandle
from rclpy.executors import ExternalShutdownException, ShutdownException, SingleThreadedExecutor
from rclpy.node import Node

ACTION_TIMEOUT = 5.0  # s


@dataclass(frozen=True)
class NodeError:
    """What a callback raised.

    Attributes:
        node_name: the node whose callback it was.
        exception: what was raised.
        traceback: the traceback as text, without the lab's own frames.
        time: when, in s of `time.monotonic()`.
    """

    node_name: str
    exception: BaseException
    traceback: str
    time: float

    @classmethod
    def of(cls, node: Node | None, exception: BaseException) -> NodeError:
        """Describe what a callback of `node` raised just now."""
        frames = traceback.format_exception(type(exception), exception, _own_frames(exception))
        return cls(node.get_name() if node else "a task", exception, "".join(frames), time.monotonic())

    @property
    def place(self) -> str:
        """File and line at which it was raised."""
        return self.traceback.rpartition('File "')[2].partition("\n")[0]

    @property
    def headline(self) -> str:
        """One sentence: which node, and what."""
        return f"A callback of {self.node_name} raised {type(self.exception).__name__}: {self.exception}"

    def __str__(self) -> str:
        return f"{self.headline}\n{self.traceback}"

    def _repr_html_(self) -> str:
        return (
            f'<div role="alert"><b>{html.escape(self.headline)}</b><br>The other nodes go on.'
            f"<pre>{html.escape(self.traceback)}</pre></div>"
        )


class IsolatingExecutor(SingleThreadedExecutor):
    """A single-threaded executor in which a callback that raises does not end the others."""

    def __init__(self, on_error: Callable[[Node | None, BaseException], None], *, context: Context) -> None:
        super().__init__(context=context)
        self._on_error = on_error
        self._thread_id: int | None = None
        self._is_to_end = False
        self._has_ended = threading.Event()

    def spin(self) -> None:
        """Run callbacks until the executor or the context is shut down."""
        self._thread_id = threading.get_ident()
        try:
            self._spin()
        finally:
            self._has_ended.set()

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop executing callbacks, and wait until the spinning thread has left; see `Executor.shutdown`.

        rclpy takes away what that thread waits for while it does, and then it fails or waits for ever.
        """
        self._is_to_end = True
        if self._thread_id not in (None, threading.get_ident()) and not self._has_ended.is_set():
            self.create_task(lambda: None)  # wakes it
            self._has_ended.wait(timeout_sec)
        return bool(super().shutdown(timeout_sec))

    def _spin(self) -> None:
        while self._context.ok() and not self._is_to_end:
            try:
                handler, _, node = self.wait_for_ready_callbacks()
            except (ShutdownException, ExternalShutdownException):
                return
            except InvalidHandle:  # another thread has destroyed what this one was about to wait for
                continue
            try:
                handler()
                exception = handler.exception()
            except SystemExit as ending:
                exception = ending
            if exception is not None:
                self._on_error(node, exception)

    def between_callbacks(self, action: Callable[[], object]) -> None:
        """Have `action` done by the spinning thread, and wait for it."""
        if threading.get_ident() == self._thread_id or not self._context.ok():
            action()
            return
        is_done = threading.Event()

        def act() -> None:
            try:
                action()
            finally:
                is_done.set()

        self.create_task(act)
        is_done.wait(ACTION_TIMEOUT)


def _own_frames(exception: BaseException) -> TracebackType | None:
    """Return the traceback from the first frame of the student's own code on."""
    trace = exception.__traceback__
    while trace and trace.tb_next and _is_plumbing(trace.tb_frame.f_globals.get("__name__", "")):
        trace = trace.tb_next
    return trace


def _is_plumbing(module: str) -> bool:
    return module.partition(".")[0] in ("rclpy", "ros2lab")
