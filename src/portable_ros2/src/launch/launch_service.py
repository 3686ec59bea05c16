"""The loop that launches."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import signal
import threading
import traceback
from collections.abc import Callable, Coroutine, Iterable, Iterator
from typing import Any

import launch.logging
from launch import process
from launch.event import Event
from launch.event_handlers import OnIncludeLaunchDescription
from launch.events import IncludeLaunchDescription, Shutdown
from launch.launch_context import LaunchContext
from launch.launch_description import LaunchDescription
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.utilities import normalize_to_list_of_entities, visit_all_entities_and_collect_futures


class LaunchService:
    """Visits launch descriptions and stays until all that they started has ended.

    Args:
        argv: the arguments of the launch, for those who ask the context.
        noninteractive: there is no terminal that sends Ctrl-C to the processes, too.
        debug: write more.
    """

    def __init__(
        self, *, argv: Iterable[str] | None = None, noninteractive: bool = False, debug: bool = False
    ) -> None:
        launch.logging.launch_config.level = logging.DEBUG if debug else logging.INFO
        self.context = LaunchContext(argv=argv, noninteractive=noninteractive)
        self.context.register_event_handler(OnIncludeLaunchDescription())
        self.event_loop: asyncio.AbstractEventLoop | None = None
        self.task: asyncio.Task[Any] | None = None
        self._logger = launch.logging.get_logger("launch")
        self._futures: list[asyncio.Future[Any]] = []
        self._interrupts = 0
        self._terminations = 0
        self._return_code = 0

    def include_launch_description(self, launch_description: LaunchDescription) -> None:
        """Visit a launch description as soon as the loop runs."""
        self.emit_event(IncludeLaunchDescription(launch_description))

    def emit_event(self, event: Event) -> None:
        """Let an event happen, from any thread."""
        if self.event_loop is None:
            self.context.emit_event_sync(event)
        else:
            self.event_loop.call_soon_threadsafe(self.context.emit_event_sync, event)

    def run(self, *, shutdown_when_idle: bool = True) -> int:
        """Launch; return the exit code: 0, or 1 if launching itself failed."""
        return asyncio.run(self.run_async(shutdown_when_idle=shutdown_when_idle))

    def shutdown(self, force_sync: bool = False) -> Coroutine[Any, Any, None] | None:
        """End all that was started, and then the loop; from any thread.

        In the main thread, unless `force_sync` is given, it returns a coroutine to be awaited.
        """
        loop = self.event_loop
        if loop is None:
            return None
        loop.call_soon_threadsafe(self._shutdown, "LaunchService.shutdown() called")
        if force_sync or threading.current_thread() is not threading.main_thread():
            return None
        return asyncio.sleep(0)

    async def run_async(self, *, shutdown_when_idle: bool = True) -> int:
        """Launch; return the exit code: 0, or 1 if launching itself failed.

        Raises:
            RuntimeError: if this is not the main thread, or if it runs already.
        """
        if threading.current_thread() is not threading.main_thread():
            raise RuntimeError("LaunchService can only be run in the main thread.")
        if self.event_loop is not None:
            raise RuntimeError("LaunchService cannot be run multiple times concurrently.")
        self.task = asyncio.current_task()
        self._return_code = 0
        with self._running(asyncio.get_running_loop()):
            launch.logging.log_launch_config(logger=self._logger)
            try:
                await self._loop(shutdown_when_idle)
            except asyncio.CancelledError:
                self._logger.error("run task was canceled")
                return 1
        return self._return_code

    async def _loop(self, shutdown_when_idle: bool) -> None:
        context = self.context
        context.something_happened = asyncio.Event()
        while True:
            context.something_happened.clear()
            while (event := context.next_event()) is not None:
                self._guarded(self._process, event)
                await asyncio.sleep(0)  # signals and output come in between
            if self._is_busy():
                await context.something_happened.wait()
            elif context.is_shutdown:
                return
            elif shutdown_when_idle:
                self._shutdown("idle")
            else:
                await context.something_happened.wait()

    def _is_busy(self) -> bool:
        """Return whether something is under way; report what has failed."""
        futures = [*self._futures, *self.context.completion_futures]
        for future in futures:
            if future.done() and not future.cancelled() and future.exception() is not None:
                self._guarded(future.result)
        self._futures = [future for future in self._futures if not future.done()]
        self.context.completion_futures = [f for f in self.context.completion_futures if not f.done()]
        return bool(self._futures or self.context.completion_futures or self.context.has_events())

    def _guarded(self, function: Callable[..., object], *args: object) -> None:
        """Call a function; if it fails, say so and end all."""
        try:
            function(*args)
        except Exception as error:  # launch files may raise anything
            text = f"Caught exception in launch (see debug for traceback): {error}"
            self._logger.debug(traceback.format_exc())
            self._logger.error(text)
            self._return_code = 1
            self._shutdown(text)

    def _process(self, event: Event) -> None:
        self._logger.debug("processing event: '%s'", event)
        if isinstance(event, Shutdown):
            self.context.is_shutdown = True
        for handler in self.context.handlers_of(event):
            self.context._push_locals()
            try:
                for entity in normalize_to_list_of_entities(handler.handle(event, self.context)):
                    self._visit(entity)
            finally:
                self.context._pop_locals()

    def _visit(self, entity: LaunchDescriptionEntity) -> None:
        for _, future in visit_all_entities_and_collect_futures(entity, self.context):
            self._futures.append(future)
            future.add_done_callback(lambda _: self.context.wake())

    def _shutdown(self, reason: str, due_to_sigint: bool = False) -> None:
        if not self.context.is_shutdown:
            self.context.is_shutdown = True
            self.context.emit_event_sync(Shutdown(reason=reason, due_to_sigint=due_to_sigint))

    @contextlib.contextmanager
    def _running(self, loop: asyncio.AbstractEventLoop) -> Iterator[None]:
        signals = {
            signal.SIGINT: self._on_interrupt,
            signal.SIGTERM: lambda: self._on_termination(signal.SIGTERM),
            signal.SIGQUIT: lambda: self._on_termination(signal.SIGQUIT),
            signal.SIGCHLD: process.reap,
        }
        self.event_loop = self.context.asyncio_loop = loop
        before = {number: signal.getsignal(number) for number in signals}
        for number, function in signals.items():
            loop.add_signal_handler(number, function)
        launch.logging.launch_config.on_closed = lambda: self._shutdown("standard output is closed")
        try:
            yield
        finally:
            launch.logging.launch_config.on_closed = None
            for number, handler in before.items():
                loop.remove_signal_handler(number)
                signal.signal(number, handler)
            self.event_loop = self.context.asyncio_loop = self.context.something_happened = None
            self.context.is_shutdown = False
            launch.logging.launch_config.close()

    def _on_interrupt(self) -> None:
        text = "user interrupted with ctrl-c (SIGINT)"
        self._interrupts += 1
        if self._interrupts > 1:
            self._logger.warning(f"{text} again, ignoring...")
            return
        self._logger.warning(text)
        self._shutdown("ctrl-c (SIGINT)", due_to_sigint=True)

    def _on_termination(self, number: signal.Signals) -> None:
        """End in order; at the second time at once: the kernel ends the processes then."""
        self._logger.error(f"user interrupted with ctrl-\\ ({number.name}), terminating...")
        self._return_code = 1
        self._terminations += 1
        if self._terminations > 1 and self.task is not None:
            self.task.cancel()
        else:
            self._shutdown(number.name)
